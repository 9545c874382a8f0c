//! Reports: pages that are well formed, hold the numbers of `--json`, and work in a browser.
#![cfg(feature = "cli")]

mod browser;
#[path = "../common/chromium.rs"]
mod chromium;
mod pages;

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::{Command, Output};
use tempfile::TempDir;

/// Words and tags that would end a tag, an attribute or a script if they were let.
const TRAIN: &str = "<b> D\n\"old\" A\nman N&N\n</script> <b>\n\nthe D\nold N&N\nman <b>\nthe D\nboats N&N\n\na D\nman N&N\nboats <b>\n\nold A\nboats N&N\nsink <b>\n\na D\nboat N&N\nsinks <b>\n\nthe D\nsink N&N\nsinks <b>\n";
/// Other sentences, in which not all is as before.
const TEST: &str = "the D\nold A\nboat N&N\nsinks <b>\n\na A\nman <b>\n]]> N&N\n";

/// A folder with the two corpora and what is written beside them.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Folder(tempfile::tempdir().expect("a folder"));
        for (name, text) in [("a<b>&'.txt", TRAIN), ("test.txt", TEST)] {
            std::fs::write(folder.path(name), text).expect("the folder takes files");
        }
        let line = include_str!("../data/theory.jsonl").lines().last().expect("six lines");
        std::fs::write(folder.path("instance.json"), line).expect("the folder takes files");
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn output(&self, line: &str) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rollin"));
        command.current_dir(self.0.path()).args(line.split_whitespace()).output().expect("the program runs")
    }

    /// What a run prints that succeeds.
    fn run(&self, line: &str) -> String {
        let output = self.output(line);
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("text")
    }

    fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.run(&format!("{line} --json"))).expect("JSON")
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).expect("the file is there")
    }

    /// The pages of all commands, by name, and what each said beside as JSON.
    fn pages(&self) -> BTreeMap<&'static str, Value> {
        self.run("train --data a<b>&'.txt --model m.model --quiet");
        let lines = [
            (
                "compare",
                "compare --data a<b>&'.txt --test test.txt --algorithms supervised,smile,searn,dagger --seed 3 -q",
            ),
            ("evaluate", "evaluate --model m.model --data test.txt"),
            ("audit", "theory audit instance.json"),
            ("bounds", "theory bounds --horizon 20 --alpha 0.05"),
        ];
        let page = |(name, line)| (name, self.json(&format!("{line} --html {name}.html --svg {name}-svg")));
        lines.map(page).into_iter().collect()
    }
}
