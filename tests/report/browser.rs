//! The pages in a real browser: Chromium, driven by ChromeDriver (W3C WebDriver over HTTP). Skipped, and said so, where they are not installed.

use crate::Folder;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Command, Stdio};

/// A browser, which ends with this.
struct Browser {
    driver: Child,
    /// Kept open: a driver that cannot speak may end.
    _said: BufReader<ChildStdout>,
    port: u16,
    session: String,
}

impl Browser {
    /// A new browser, if there is one to be had.
    fn start() -> Option<Self> {
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

    fn open(&self, path: &std::path::Path) {
        let answer = self.post("/url", &json!({ "url": format!("file://{}", path.display()) }));
        assert!(answer.is_null(), "{answer}");
    }

    /// What a script returns.
    fn run(&self, script: &str) -> Value {
        let value = self.post("/execute/sync", &json!({ "script": script, "args": [] }));
        assert!(value.get("error").is_none(), "{script}: {value}");
        value
    }

    /// Whether what a script returns is true.
    fn holds(&self, script: &str) {
        assert_eq!(self.run(script), json!(true), "{script}");
    }

    /// What the console was told since it was last asked.
    fn console(&self) -> Value {
        self.post("/se/log", &json!({ "type": "browser" }))
    }

    fn wide(&self, pixels: u32) {
        let metrics = json!({ "width": pixels, "height": 900, "deviceScaleFactor": 1, "mobile": false });
        self.post("/goog/cdp/execute", &json!({ "cmd": "Emulation.setDeviceMetricsOverride", "params": metrics }));
    }

    fn dark(&self, value: &str) {
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

/// All marks that are seen have a place, within the figure.
const DRAWN: &str = "return [...document.querySelectorAll('figure svg')].every(svg => {
  const frame = svg.getBoundingClientRect();
  const shapes = [...svg.querySelectorAll('.mark:not(.off), .cell')].map(shape => shape.getBoundingClientRect());
  const within = box => box.width > 0 && box.left >= frame.left && box.right <= frame.right && box.top >= frame.top && box.bottom <= frame.bottom;
  return shapes.length > 0 && shapes.every(within);
});";

#[test]
fn pages_work_in_a_browser() {
    let Some(browser) = Browser::start() else {
        eprintln!("skipped: chromedriver and chromium are not installed");
        return;
    };
    let folder = Folder::new();
    for name in folder.pages().keys() {
        browser.open(&folder.path(&format!("{name}.html")));
        for (pixels, scheme, paper) in [(1400, "light", "rgb(255, 255, 255)"), (400, "dark", "rgb(21, 24, 28)")] {
            browser.wide(pixels);
            browser.dark(scheme);
            browser.holds(DRAWN);
            browser.holds(&format!("return getComputedStyle(document.body).backgroundColor === '{paper}'"));
            browser.holds("return document.documentElement.scrollWidth <= innerWidth");
        }
        axes(&browser, name);
        legend(&browser, name);
        tips(&browser);
        assert_eq!(browser.console(), json!([]), "{name}: nothing is told on the console");
    }
    // That the console is heard at all.
    browser.run("console.error('heard')");
    assert!(browser.console().to_string().contains("heard"));
}

/// Both axes of every plot go to the other scale and back: what is drawn moves, and stands again where it stood.
fn axes(browser: &Browser, name: &str) {
    let boxes = browser.run("return document.querySelectorAll('.controls input').length").as_u64().expect("a number");
    let shown = browser.run("return [...document.querySelectorAll('.controls')].every(controls => !controls.hidden)");
    assert_eq!(shown, json!(true));
    assert_eq!(boxes > 0, name != "evaluate", "{name}");
    let mut moved = 0;
    for i in 0..boxes {
        let state = format!(
            "const figure = document.querySelectorAll('.controls input')[{i}].closest('figure');
             return [...figure.querySelectorAll('.mark:not(.off), .axis:not(.off), .line, .interval')].map(part => ['class', 'transform', 'points', 'd'].map(name => part.getAttribute(name)).join()).join(';')"
        );
        let click =
            format!("const box = document.querySelectorAll('.controls input')[{i}]; box.click(); return box.disabled");
        let before = browser.run(&state);
        if browser.run(&click) == json!(true) {
            continue;
        }
        assert_ne!(browser.run(&state), before, "{name}: axis {i}");
        browser.holds(DRAWN);
        browser.run(&click);
        assert_eq!(browser.run(&state), before, "{name}: axis {i}");
        moved += 1;
    }
    assert!(boxes == 0 || moved > boxes / 2, "{name}: {moved} of {boxes} axes");
}

/// A key hides its series by mouse and by keyboard, and shows it again.
fn legend(browser: &Browser, name: &str) {
    let press = "const key = document.querySelector('.key'); if (!key) return null;
      const series = key.closest('svg').querySelector('.series');
      const seen = () => getComputedStyle(series).display !== 'none';
      const states = [seen()];
      key.dispatchEvent(new MouseEvent('click', { bubbles: true })); states.push(seen());
      key.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter', bubbles: true })); states.push(seen());
      return states;";
    let states = browser.run(press);
    assert_eq!(states, if name == "evaluate" { Value::Null } else { json!([true, false, true]) }, "{name}");
}

/// Pointing at a mark tells its numbers.
fn tips(browser: &Browser) {
    browser.holds(
        "const mark = document.querySelector('.mark:not(.off), .cell'), tip = document.getElementById('tip');
         mark.dispatchEvent(new PointerEvent('pointermove', { bubbles: true, clientX: 40, clientY: 40 }));
         const shown = !tip.hidden && tip.textContent === mark.dataset.tip && /[0-9]/.test(tip.textContent);
         mark.closest('svg').dispatchEvent(new PointerEvent('pointerleave'));
         return shown && tip.hidden;",
    );
}
