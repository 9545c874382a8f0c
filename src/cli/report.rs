//! Reports: what a command found as a page, and its figures as files.

use super::train::{same_file, to_json};
use super::{Global, print};
use crate::error::{Error, Result};
use crate::output::{check_writable, write_whole};
use crate::read::input;
use crate::report::{Axis, Dot, Figure, Page, Plot, Series, evenly};
use clap::Args;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Where a report goes.
#[derive(Args)]
pub struct ReportOptions {
    /// Write a page with charts and tables to this file; it needs no network
    #[arg(long, value_name = "FILE", help_heading = "Report")]
    html: Option<PathBuf>,
    /// Write each chart to this folder, as NAME.svg
    #[arg(long, value_name = "FOLDER", help_heading = "Report")]
    svg: Option<PathBuf>,
}

/// Settings as they are read aloud: `logistic (passes 5, rate 0.1)`.
pub(super) fn spoken(settings: &impl serde::Serialize) -> String {
    spoken_json(&to_json(settings))
}

/// The same for settings that a model file has as JSON.
pub(super) fn spoken_json(settings: &str) -> String {
    fn say(value: &Value) -> String {
        match value {
            Value::Null => "none".to_owned(),
            Value::String(text) => text.clone(),
            Value::Array(values) => values.iter().map(say).collect::<Vec<_>>().join(" "),
            Value::Object(fields) => {
                let field = |(name, value): (&String, &Value)| match value {
                    Value::Object(inner) if inner.is_empty() => name.clone(),
                    Value::Object(_) => format!("{name} ({})", say(value)),
                    _ => format!("{name} {}", say(value)),
                };
                fields.iter().map(field).collect::<Vec<_>>().join(", ")
            }
            other => other.to_string(),
        }
    }
    serde_json::from_str(settings).map_or_else(|_| settings.to_owned(), |value| say(&value))
}

/// What was read, by what it is for.
#[derive(Default)]
pub struct Sources<'a> {
    /// Files.
    pub files: &'a [(&'a str, &'a Path)],
    /// Texts that are part of the program.
    pub texts: &'a [(&'a str, &'a str)],
}

/// The sum of a text that was read.
pub(super) fn sha256(bytes: &[u8]) -> String {
    let hex: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    format!("SHA-256 {hex}, {} bytes", bytes.len())
}

impl ReportOptions {
    /// Refuses what cannot be written, or would overwrite one of `inputs`; what takes long asks first.
    pub fn check(&self, inputs: &[&Path]) -> Result<()> {
        if let Some(path) = &self.html {
            if inputs.iter().any(|input| same_file(path, input)) {
                return Err(Error::argument("--html", path.display(), "another file than those that are read"));
            }
            check_writable(path)?;
        }
        if let Some(folder) = &self.svg {
            std::fs::create_dir_all(folder).map_err(|source| Error::io("make", folder, source))?;
            check_writable(&folder.join("chart.svg"))?;
        }
        Ok(())
    }

    /// Writes what was asked for: `page`, with how it came to be, and its figures.
    pub fn write(&self, page: impl FnOnce() -> Page, global: &Global, read: &Sources<'_>) -> Result<()> {
        if self.html.is_none() && self.svg.is_none() {
            return Ok(());
        }
        let mut page = page();
        page.fact("command", command());
        page.fact("version", concat!("rollin ", env!("CARGO_PKG_VERSION")));
        page.fact("seed", global.seed.to_string());
        for (what, path) in read.files {
            let sum = match path.to_str() {
                Some("-") => "standard input, which is not kept: no checksum".to_owned(),
                _ => sha256(&input::raw(path)?),
            };
            page.fact(what, format!("{}: {sum}", path.display()));
        }
        for (what, text) in read.texts {
            page.fact(what, format!("in the program: {}", sha256(text.as_bytes())));
        }
        let mut written = Vec::new();
        if let Some(folder) = &self.svg {
            for figure in &page.figures {
                let path = folder.join(format!("{}.svg", figure.name));
                write_whole(&path, figure.file().as_bytes())?;
                written.push(path);
            }
        }
        if let Some(path) = &self.html {
            write_whole(path, page.html().as_bytes())?;
            written.push(path.clone());
        }
        if global.json {
            return Ok(());
        }
        print(&written.iter().map(|path| format!("wrote {}\n", path.display())).collect::<String>())
    }
}

/// The command as it can be given to a shell again.
fn command() -> String {
    let words = std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()));
    std::iter::once("rollin".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// A word as a shell takes it for one.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// The weights of a mixture's members after each round, `weights[n]` those of pi^n, the expert's first.
pub fn mixture(name: &str, whose: &str, weights: &[Vec<f64>]) -> Figure {
    let members = weights.iter().map(Vec::len).max().unwrap_or(0);
    // A line more would say nothing.
    let series = evenly(members, 12).into_iter().map(|member| {
        let title = if member == 0 { "expert".to_owned() } else { format!("classifier {member}") };
        let dot =
            |(n, weights): (usize, &Vec<f64>)| Some(Dot { x: n as f64, y: *weights.get(member)?, ..Dot::default() });
        Series::Line(title, weights.iter().enumerate().filter_map(dot).collect())
    });
    let plot = Plot { x: Axis::linear("rounds"), y: Axis::linear("weight"), series: series.collect() };
    let note = "Who acts with which probability at a step: the expert and the classifiers of each round. On a logarithmic axis a share that shrinks by \
                the same factor each round is a straight line.";
    Figure::plot(name, &format!("{whose}: the mixture after each round"), note, &plot)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learner::Logistic;
    use crate::tasks::{AnyLearner, Trainer};
    use crate::trainer::EarlyUpdate;

    #[test]
    fn sums_and_words() {
        // From FIPS 180-2, appendix B.1.
        let sum = "SHA-256 ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad, 3 bytes";
        assert_eq!(sha256(b"abc"), sum);
        assert_eq!(["a.txt", "it's", "", "a b"].map(quoted), ["a.txt", "'it'\\''s'", "''", "'a b'"]);
    }

    #[test]
    fn settings_are_read_aloud() {
        let learner = AnyLearner::Logistic(Logistic::default());
        assert_eq!(spoken(&learner), "logistic (l2 0.0, outputs actions, passes 5, rate 0.1, tolerance 0.01)");
        assert_eq!(
            spoken(&Trainer::EarlyUpdate(EarlyUpdate { width: 8, rounds: 3 })),
            "early-update (rounds 3, width 8)"
        );
        assert_eq!((spoken_json("none"), spoken_json("\"free\"")), ("none".to_owned(), "free".to_owned()));
    }
}
