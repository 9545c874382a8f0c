//! A real browser: Chromium, driven by ChromeDriver (W3C WebDriver over HTTP), where they are installed.
// Not every test that opens pages does everything with them.
#![allow(dead_code)]

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Command, Stdio};

/// A browser, which ends with this.
pub struct Browser {
    driver: Child,
    /// Kept open: a driver that cannot speak may end.
    _said: BufReader<ChildStdout>,
    port: u16,
    session: String,
}

impl Browser {
    /// A new browser, if there is one to be had.
    pub fn start() -> Option<Self> {
        let mut driver =
            Command::new("chromedriver").arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?;
        let mut said = BufReader::new(driver.stdout.take()?);
        let (mut line, mut port) = (String::new(), None);
        while port.is_none() && said.read_line(&mut line).is_ok_and(|n| n > 0) {
            port = line.rsplit_once("on port ").and_then(|(_, rest)| rest.trim().trim_end_matches('.').parse().ok());
            // First it says what it was asked for, which was any.
            port = port.filter(|port| *port != 0);
            line.clear();
        }
        let mut browser = Browser { driver, _said: said, port: port?, session: String::new() };
        let args = [
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--disable-dev-shm-usage",
        ];
        let wanted = json!({ "goog:chromeOptions": { "args": args }, "goog:loggingPrefs": { "browser": "ALL" } });
        let made = browser.post("/session", &json!({ "capabilities": { "alwaysMatch": wanted } }));
        browser.session = format!("/session/{}", made["sessionId"].as_str()?);
        Some(browser)
    }

    /// One request; what is answered is its `value`.
    fn ask(&self, method: &str, path: &str, body: &str) -> Value {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("the driver listens");
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: {}\r\n\r\n",
            body.len()
        );
        stream.write_all((head + body).as_bytes()).expect("the driver reads");
        let mut reader = BufReader::new(stream);
        let (mut line, mut length) = (String::new(), 0);
        while reader.read_line(&mut line).expect("the driver answers") > 2 {
            if let Some((name, value)) = line.split_once(':')
                && name.eq_ignore_ascii_case("content-length")
            {
                length = value.trim().parse().expect("a length");
            }
            line.clear();
        }
        let mut answer = vec![0; length];
        reader.read_exact(&mut answer).expect("the driver answers");
        serde_json::from_slice::<Value>(&answer).expect("JSON")["value"].take()
    }

    fn post(&self, path: &str, body: &Value) -> Value {
        self.ask("POST", &format!("{}{path}", self.session), &body.to_string())
    }

    /// Goes to a page.
    pub fn visit(&self, address: &str) {
        let answer = self.post("/url", &json!({ "url": address }));
        assert!(answer.is_null(), "{answer}");
    }

    /// What a script returns.
    pub fn run(&self, script: &str) -> Value {
        let value = self.post("/execute/sync", &json!({ "script": script, "args": [] }));
        assert!(value.get("error").is_none(), "{script}: {value}");
        value
    }

    /// Whether what a script returns is true.
    pub fn holds(&self, script: &str) {
        assert_eq!(self.run(script), json!(true), "{script}");
    }

    /// What the console was told since it was last asked.
    pub fn console(&self) -> Value {
        self.post("/se/log", &json!({ "type": "browser" }))
    }

    /// How wide the window is.
    pub fn wide(&self, pixels: u32) {
        let metrics = json!({ "width": pixels, "height": 900, "deviceScaleFactor": 1, "mobile": false });
        self.post("/goog/cdp/execute", &json!({ "cmd": "Emulation.setDeviceMetricsOverride", "params": metrics }));
    }

    /// Which colours are preferred.
    pub fn dark(&self, value: &str) {
        let features = json!({ "features": [{ "name": "prefers-color-scheme", "value": value }] });
        self.post("/goog/cdp/execute", &json!({ "cmd": "Emulation.setEmulatedMedia", "params": features }));
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() {
            self.ask("DELETE", &self.session, "");
        }
        // It may have ended by itself.
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

impl Browser {
    /// Tries the page that it is on, wide and narrow, light and dark: `holds` is true, the page is no wider than the window, and the paper is light or dark.
    pub fn looks(&self, holds: &str) {
        for (pixels, scheme) in [(1400, "light"), (400, "dark")] {
            self.wide(pixels);
            self.dark(scheme);
            self.holds(holds);
            self.holds("return document.documentElement.scrollWidth <= innerWidth");
            let paper = "const paper = getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g).map(Number)";
            self.holds(&format!("{paper}; return (paper[0] + paper[1] + paper[2] < 384) === ('{scheme}' === 'dark')"));
        }
    }

    /// Waits, at most ten seconds, until a script returns true.
    pub fn until(&self, script: &str) {
        let patience = (0..200).any(|_| {
            self.run(script) == json!(true) || {
                std::thread::sleep(std::time::Duration::from_millis(50));
                false
            }
        });
        assert!(patience, "{script}");
    }
}
