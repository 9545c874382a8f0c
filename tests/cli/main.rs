//! The command-line program, run as its users run it.
#![cfg(feature = "cli")]

mod convert;
mod explain;
mod faults;
mod good;
mod help;
mod large;
mod long;
mod ocr;
mod packed;
mod refusals;
mod spans;
mod tasks;
mod update;

use assert_cmd::Command;
use serde_json::Value;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder of its own for one test.
struct Folder(TempDir);

/// Three sentences, words and parts of speech.
const TAGS: &str = "the D\nold A\nman N\nsleeps V\n\nthe D\nold N\nman V\nthe D\nboats N\n\na D\nman N\nboats V\n\nold A\nboats N\nsink V\n\na D\nboat N\nsinks V\n";

/// Words, parts of speech and chunks.
const CHUNKS: &str = "the D B-NP\nold A I-NP\nman N I-NP\nsleeps V B-VP\n. . O\n\na D B-NP\nman N I-NP\nsees V B-VP\nboats N B-NP\n. . O\n";

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file.
    fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).expect("the folder takes files");
        path
    }

    fn get(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect("the file is there")
    }

    /// The names of all files, hidden ones too.
    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("the folder is there");
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("an entry").file_name();
        let mut names: Vec<String> = entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The program, in this folder.
    fn rollin(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rollin"));
        command.current_dir(self.0.path()).args(line.split_whitespace());
        command
    }

    /// What a run that succeeds without a word on standard error prints.
    fn run(&self, line: &str) -> String {
        self.run_on(line, "")
    }

    /// The same with something on standard input.
    fn run_on(&self, line: &str, input: impl Into<Vec<u8>>) -> String {
        let output = self.rollin(line).write_stdin(input).output().expect("the program runs");
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && errors.is_empty(), "{line}: {:?} {errors}", output.status);
        String::from_utf8(output.stdout).expect("text")
    }

    /// What a run that succeeds prints, and what it says on standard error.
    fn told(&self, line: &str, input: impl Into<Vec<u8>>) -> [String; 2] {
        let output = self.rollin(line).write_stdin(input).output().expect("the program runs");
        assert!(output.status.success(), "{line}: {:?}", output.status);
        [output.stdout, output.stderr].map(|text| String::from_utf8(text).expect("text"))
    }

    fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.run(line)).expect("JSON")
    }

    /// The one message of a run that is refused: exit code 2, nothing on standard output, and no file made or left over.
    fn refused(&self, line: &str) -> String {
        self.refused_on(line, "")
    }

    fn refused_on(&self, line: &str, input: impl Into<Vec<u8>>) -> String {
        let before = self.names();
        let output = self.rollin(line).write_stdin(input).output().expect("the program runs");
        let message = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{line}: {message}");
        assert!(output.stdout.is_empty(), "{line}: {}", String::from_utf8_lossy(&output.stdout));
        assert_eq!(message.matches("error:").count(), 1, "{line}: {message}");
        assert!(message.starts_with("error: ") && message.ends_with('\n'), "{line}: {message}");
        assert!(!message.contains("panicked"), "{line}: {message}");
        assert_eq!(self.names(), before, "{line}");
        message
    }

    /// Asserts that a run is refused with exactly this message, of one line.
    fn says(&self, line: &str, message: &str) {
        assert_eq!(self.refused(line), format!("error: {message}\n"), "{line}");
    }

    fn says_on(&self, line: &str, input: impl Into<Vec<u8>>, message: &str) {
        assert_eq!(self.refused_on(line, input), format!("error: {message}\n"), "{line}");
    }
}

/// A file of the repository.
fn shipped(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name).display().to_string()
}
