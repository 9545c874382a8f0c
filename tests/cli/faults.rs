//! Standard streams that break, stutter, or are none.

use super::{Folder, TAGS, shipped};
use std::io::{Read, Write};
use std::process::{Command, Stdio};

/// A folder with a model of `TAGS`.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("t", TAGS);
    folder.put("T", "U:%x[0,0]\n");
    folder.run("train --data t --model m -q");
    folder
}

fn start(folder: &Folder, line: &str, output: Stdio) -> std::process::Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rollin"));
    command.current_dir(folder.path(".")).args(line.split(' '));
    command.stdin(Stdio::piped()).stdout(output).stderr(Stdio::piped()).spawn().expect("the program starts")
}

#[test]
fn a_byte_at_a_time_in_and_out() {
    let folder = folder();
    let whole = folder.run_on("tag --model m", TAGS);
    let mut child = start(&folder, "tag --model m", Stdio::piped());
    let (mut input, mut output) = (child.stdin.take().expect("piped"), child.stdout.take().expect("piped"));
    let reader = std::thread::spawn(move || {
        let (mut text, mut byte) = (Vec::new(), [0]);
        while output.read(&mut byte).expect("it can be read") > 0 {
            text.push(byte[0]);
        }
        text
    });
    for byte in TAGS.as_bytes() {
        input.write_all(&[*byte]).expect("it is read");
        input.flush().expect("it is read");
    }
    drop(input);
    assert!(child.wait().expect("it ends").success());
    assert_eq!(String::from_utf8(reader.join().expect("no panic")).expect("text"), whole);
}

/// Whatever writes to standard output tells when that is full: success means that all was written.
#[test]
#[cfg(target_os = "linux")]
fn a_full_device_is_told() {
    let folder = folder();
    let generate = format!("generate --grammar {} --count 9", shipped("grammars/dialects.grammar"));
    let lines = ["tag --model m", "evaluate --model m --data t", &generate, "inspect m", "inspect m --json"];
    let more = [
        "convert --from conll --to crfsuite --template T",
        "completions bash",
        "theory bounds --horizon 10 --alpha 0.1",
    ];
    for line in lines.into_iter().chain(more) {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
        let mut child = start(&folder, line, Stdio::from(full));
        // Some of these read nothing.
        let _ = child.stdin.take().expect("piped").write_all(TAGS.as_bytes());
        let output = child.wait_with_output().expect("it ends");
        let message = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{line}: {message}");
        assert!(message.contains("cannot write <stdout>") && message.contains("No space left"), "{line}: {message}");
    }
}

/// A folder can be opened and not read.
#[test]
#[cfg(unix)]
fn an_input_that_cannot_be_read_is_told() {
    let folder = folder();
    let here = std::fs::File::open(folder.path(".")).expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_rollin"));
    let output = command.current_dir(folder.path(".")).args(["tag", "--model", "m"]).stdin(here).output();
    let output = output.expect("it ends");
    let message = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("cannot read <stdin>"), "{message}");
}
