//! The server, asked as its clients ask it.
#![cfg(all(feature = "serve", unix))]

#[path = "../common/chromium.rs"]
mod chromium;
mod client;

use chromium::Browser;
use client::{Server, receive, send};
use serde_json::{Value, json};
use std::io::{BufReader, Write};
use std::path::Path;
use std::process::Command;
use std::time::Duration;
use tempfile::TempDir;

const SENTENCES: &str = "the D\nold A\nman N\nsleeps V\n\na D\nboat N\nsinks V\n\n";

fn rollin(folder: &Path, line: &str) {
    let run = Command::new(env!("CARGO_BIN_EXE_rollin")).args(line.split_whitespace()).current_dir(folder).output();
    let run = run.expect("the program runs");
    assert!(run.status.success(), "{line}: {}", String::from_utf8_lossy(&run.stderr));
}

/// A folder with a calibrated model in it.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("t.txt"), SENTENCES.repeat(10)).expect("a file");
    rollin(folder.path(), "train --data t.txt --model m --calibrate");
    folder
}

/// Sends a server a signal.
fn signal(server: &Server, name: &str) {
    let id = server.process.id().to_string();
    assert!(Command::new("kill").args(["-s", name, &id]).status().expect("kill runs").success());
}

fn json_of((status, body): (u16, String)) -> (u16, Value) {
    (status, serde_json::from_str(&body).unwrap_or_else(|error| panic!("{error}: {body}")))
}

const JSON: &str = "POST /tag\nContent-Type: application/json";

#[test]
fn text_and_json_are_answered() {
    let folder = folder();
    let server = Server::start(folder.path(), "--model m");
    let ask = |head: &str, body: &str| server.ask(head, body.as_bytes());
    assert_eq!(ask("POST /tag", "the\nboat\n\na\nman\n"), (200, "the D\nboat N\n\na D\nman N\n".to_owned()));
    assert_eq!(ask("POST /tag", ""), (200, String::new()));
    let (status, sure) = ask("POST /tag?confidence", "the\nboat\n");
    assert_eq!((status, sure.lines().all(|line| line.split(' ').count() == 3)), (200, true), "{sure}");

    let words = json!({"sentences": [["the", "boat"], [["a", "X"], ["man", "Y"], ["sinks", "Z"]]]});
    // The first sentence has words only: two columns here, one there.
    let (status, refused) = json_of(ask(JSON, &words.to_string()));
    assert_eq!((status, &refused["error"]), (400, &json!("<request>:4:3: 2 columns; expected 1 column as on line 1")));
    let words = json!({"sentences": [["the", "boat"], ["a"]]});
    let expected = json!({"sentences": [{"labels": ["D", "N"]}, {"labels": ["D"]}]});
    assert_eq!(json_of(ask(JSON, &words.to_string())), (200, expected));
    let words = json!({"sentences": [[["the", "X"], ["boat", "Y"]]], "confidence": true});
    let (status, answer) = json_of(ask(JSON, &words.to_string()));
    let sentence = &answer["sentences"][0];
    assert_eq!((status, &sentence["labels"]), (200, &json!(["D", "N"])));
    assert!(
        sentence["confidence"].as_array().expect("two").iter().all(|p| (0.0..=1.0).contains(&p.as_f64().expect("p")))
    );

    let why = json!({"sentences": [["the", "boat"]], "explain": true, "confidence": true});
    let (status, answer) = json_of(ask(JSON, &why.to_string()));
    let reason = &answer["sentences"][0]["reasons"][1];
    assert_eq!((status, &reason["label"]), (200, &json!("N")), "{answer}");
    let sum: f64 =
        reason["features"].as_array().expect("parts").iter().map(|part| part["label"].as_f64().expect("p")).sum();
    assert!((sum - reason["score"].as_f64().expect("a score")).abs() < 1e-4, "{reason}");
    assert!(ask("POST /tag?explain", "the\nboat\n").1.starts_with("the D\n#  D "));

    let (status, health) = json_of(ask("GET /health", ""));
    assert_eq!((status, &health["task"], &health["calibrated"]), (200, &json!("tagging"), &json!(true)));
    let (_, counts) = ask("GET /metrics", "");
    for line in ["rollin_requests_total{path=\"/tag\",status=\"200\"} 7", "rollin_tokens_total 15", "rollin_waiting 0"]
    {
        assert!(counts.lines().any(|there| there == line), "{line} is not in {counts}");
    }
    let (status, page) = ask("GET /", "");
    assert!(status == 200 && page.contains("<textarea") && !page.contains("http://") && !page.contains("https://"));
}

#[test]
fn what_is_wrong_is_said() {
    let folder = folder();
    let server = Server::start(folder.path(), "--model m --body-limit 1000 --time-limit 1 --idle-limit 1");
    let error = |head: &str, body: &[u8]| {
        let (status, answer) = json_of(server.ask(head, body));
        (status, answer["error"].as_str().unwrap_or_default().to_owned())
    };
    for (body, expected) in [
        (&b"the X\nboat\n"[..], "<request>:2:5: 1 column; expected 2 columns as on line 1"),
        (b"\xff\n", "<request>:1:1: byte 0xff, which is not UTF-8; expected text in UTF-8"),
        (b"a\0\n", "<request>:1:2: a NUL byte; expected text in UTF-8, not a binary file"),
    ] {
        assert_eq!(error("POST /tag", body), (400, expected.to_owned()));
    }
    for (body, expected) in [
        (&b"{"[..], "<request>:1:1: EOF while parsing an object; expected {\"sentences\""),
        (b"{\"sentences\": [], \"sure\": 1}", "unknown field `sure`"),
        (b"{\"sentences\": [[]]}", "<request>: sentences[0]: no token; expected at least one"),
        (b"{\"sentences\": [[\"a b\"]]}", "sentences[0][0]: [\"a b\"]; expected words that are not empty"),
        (b"{\"sentences\": [[[]]]}", "sentences[0][0]: []; expected words"),
    ] {
        let (status, why) = error(JSON, body);
        assert!(status == 400 && why.contains(expected), "{status} {why}");
    }
    assert_eq!(error("POST /tag?sure=1", b"").0, 400);
    assert_eq!(error("GET /nowhere", b"").0, 404);
    assert_eq!(server.ask("GET /tag", b"").0, 405);
    assert_eq!(server.ask("POST /tag", &[b'a'; 1001]).0, 413);

    // A body that does not come, and a head that does not.
    let mut slow = server.connect();
    slow.write_all(b"POST /tag HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\n\r\nthe").expect("it takes that");
    assert_eq!(receive(&mut BufReader::new(slow)).expect("an answer").0, 408);
    let mut slow = server.connect();
    slow.write_all(b"POST /tag HT").expect("it takes that");
    assert!(receive(&mut BufReader::new(slow)).is_none_or(|(status, _)| status == 408));
    assert_eq!(server.ask("GET /health", b"").0, 200);
}

#[test]
fn strangers_need_a_token() {
    let folder = folder();
    std::fs::write(folder.path().join("token"), "correct-horse-battery\n").expect("a file");
    let server = Server::start(folder.path(), "--model m --token-file token");
    for head in ["POST /tag", "POST /tag\nAuthorization: Bearer correct-horse-batterx", "POST /reload", "GET /metrics"]
    {
        assert_eq!(server.ask(head, b"a\n").0, 401, "{head}");
    }
    assert_eq!(server.ask("POST /tag\nAuthorization: Bearer correct-horse-battery", b"a\n").0, 200);
    assert_eq!(server.ask("GET /health", b"").0, 200);

    let refused = |options: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rollin"));
        let output =
            command.arg("serve").args(options.split(' ')).current_dir(folder.path()).output().expect("it runs");
        assert_eq!(output.status.code(), Some(2), "{options}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(refused("--model m --listen 0.0.0.0:0").contains("--listen is 0.0.0.0:0, but must be a loopback address"));
    std::fs::write(folder.path().join("short"), "secret\n").expect("a file");
    assert!(refused("--model m --token-file short").contains("short: no token"));
    assert!(refused("--model t.txt").contains("t.txt"));
}

#[test]
fn models_are_read_again_and_requests_go_on() {
    let folder = folder();
    let server = Server::start(folder.path(), "--model m");
    let text = SENTENCES.repeat(500);
    let expected = server.ask("POST /tag", text.as_bytes());
    std::thread::scope(|scope| {
        let asking = scope.spawn(|| (0..20).map(|_| server.ask("POST /tag", text.as_bytes())).collect::<Vec<_>>());
        for _ in 0..10 {
            assert_eq!(server.ask("POST /reload", b"").0, 200);
        }
        assert!(asking.join().expect("answers").iter().all(|answer| *answer == expected));
    });
    // Another model, and then none.
    std::fs::write(folder.path().join("u.txt"), "the X\nold X\n\n".repeat(10)).expect("a file");
    rollin(folder.path(), "train --data u.txt --model m");
    signal(&server, "HUP");
    // The signal is answered at some time, not at once.
    let changed = || server.ask("POST /tag", b"the\n").1 == "the X\n";
    assert!((0..500).any(|_| changed() || {
        std::thread::sleep(Duration::from_millis(20));
        false
    }));
    std::fs::write(folder.path().join("m"), "no model").expect("a file");
    let (status, why) = json_of(server.ask("POST /reload", b""));
    assert!(status == 500 && why["error"].as_str().expect("text").ends_with("the model stays as it was"), "{why}");
    assert!(changed());
}

#[test]
fn too_many_requests_are_turned_away() {
    let folder = folder();
    let server = Server::start(folder.path(), "--model m --queue 1 --threads 1 --body-limit 20000000");
    let text = SENTENCES.repeat(50_000);
    let answers: Vec<u16> = std::thread::scope(|scope| {
        let ask = || server.ask("POST /tag", text.as_bytes()).0;
        let asking: Vec<_> = (0..8).map(|_| scope.spawn(ask)).collect();
        asking.into_iter().map(|thread| thread.join().expect("an answer")).collect()
    });
    assert!(answers.iter().all(|status| [200, 503].contains(status)), "{answers:?}");
    assert!(answers.contains(&200), "{answers:?}");
}

#[test]
fn what_has_come_is_answered_before_the_end() {
    let folder = folder();
    let mut server = Server::start(folder.path(), "--model m --body-limit 20000000");
    let text = SENTENCES.repeat(50_000);
    let mut stream = server.connect();
    send(&mut stream, "POST /tag", text.as_bytes());
    signal(&server, "TERM");
    let (status, tagged) = receive(&mut BufReader::new(stream)).expect("an answer");
    assert_eq!((status, tagged.lines().count()), (200, text.lines().count()));
    assert!(server.process.wait().expect("it ends").success());
}

#[test]
fn signals_are_heard_as_soon_as_the_address_is_known() {
    let folder = folder();
    for _ in 0..5 {
        let mut server = Server::start(folder.path(), "--model m");
        signal(&server, "HUP");
        signal(&server, "TERM");
        assert!(server.process.wait().expect("it ends").success());
    }
}

/// A sentence is typed, its labels come, and a click tells why.
#[test]
fn the_page_works_in_a_browser() {
    let Some(browser) = Browser::start() else {
        eprintln!("skipped: chromedriver and chromium are not installed");
        return;
    };
    let folder = folder();
    let server = Server::start(folder.path(), "--model m");
    browser.visit(&format!("http://{}/", server.address));
    browser.until("return document.getElementById('about').textContent.includes('tagging')");
    browser
        .run("document.getElementById('text').value = 'the boat sinks'; document.querySelector('form button').click()");
    browser.until("return document.querySelectorAll('.token').length === 3");
    browser.looks("return [...document.querySelectorAll('.token')].map(token => token.children[1].textContent).join() === 'D,N,V'");
    browser.holds(
        "return [...document.querySelectorAll('.token')].every(token => token.children[2].textContent.endsWith('%'))",
    );
    browser.run("document.querySelectorAll('.token')[1].click()");
    browser.holds("return document.querySelector('h2').textContent === 'Why boat is N' && document.querySelectorAll('tr').length > 3");
    browser.run("document.getElementById('text').value = 'a b\\nc'; document.querySelector('form button').click()");
    browser.until("return document.getElementById('error').textContent.includes('2:2')");
    // The refusal is on the console, too, as the browser sees to it; nothing else is.
    let told = browser.console();
    assert!(told.as_array().is_some_and(|told| told.len() == 1) && told.to_string().contains("400"), "{told}");
}
