//! What a person at a terminal sees: colours where there is a terminal, and what was perhaps meant.
//!
//! Whether there are colours is decided as for the help: on a terminal, unless `NO_COLOR` is set; always with `CLICOLOR_FORCE`.

use crate::report::Table;
use clap::builder::Styles;
use clap::builder::styling::AnsiColor;
use std::fmt::Display;
use std::io::Write;

/// How the program looks.
pub const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

/// A message on standard error behind the word for what it is: `error`, or `note`.
pub fn tell(word: &str, message: &dyn Display) {
    let style = if word == "error" { STYLES.get_error() } else { STYLES.get_header() };
    // Nobody may be left to read it.
    let _ = writeln!(anstream::stderr(), "{style}{word}:{style:#} {message}");
}

/// A heading, for [`print`](super::print).
pub fn heading(text: &str) -> String {
    let style = STYLES.get_header();
    format!("{style}{text}{style:#}")
}

/// A table whose first row are headings.
pub fn headed(table: &Table) -> String {
    let text = table.to_string();
    text.split_once('\n').map_or_else(String::new, |(first, rest)| format!("{}\n{rest}", heading(first)))
}

/// Lines of help, those headings that end with a colon and are not set in.
pub fn help(text: &str) -> clap::builder::StyledStr {
    let line = |line: &str| match line.ends_with(':') && !line.starts_with(' ') {
        true => heading(line),
        false => line.to_owned(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n").into()
}

/// More names than this are not told.
const TOLD: usize = 20;

/// The names that are `known` where `value` is none of them, and of these perhaps the one that is spelled nearly so.
pub fn names(value: &str, known: &[&str]) -> String {
    let names = known.iter().take(TOLD).copied().collect::<Vec<_>>().join(", ");
    let more = known.len().checked_sub(TOLD).filter(|more| *more > 0);
    let more = more.map_or_else(String::new, |more| format!(" and {more} more"));
    let meant = perhaps(value, known).map_or_else(String::new, |name| format!("; did you mean {name}?"));
    format!("{names}{more}{meant}")
}

/// The likeness, from 0 to 1, from which on a name may have been meant.
const LIKE: f64 = 0.8;

/// The first of the names that are most like `value`, if it is like enough.
fn perhaps<'a>(value: &str, known: &[&'a str]) -> Option<&'a str> {
    let value = value.to_lowercase();
    let like = |name: &str| strsim::jaro(&value, &name.to_lowercase());
    let best = known.iter().rev().max_by(|a, b| like(a).total_cmp(&like(b)))?;
    (like(best) > LIKE).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_perhaps_meant() {
        let labels = ["B-NP", "B-VP", "I-NP", "O"];
        assert_eq!(names("B-NPP", &labels), "B-NP, B-VP, I-NP, O; did you mean B-NP?");
        assert_eq!(names("i-np", &labels), "B-NP, B-VP, I-NP, O; did you mean I-NP?");
        assert_eq!(names("sentence", &labels), "B-NP, B-VP, I-NP, O");
        assert_eq!(names("weaving", &["tagging", "parsing"]), "tagging, parsing");
        assert_eq!(names("taging", &["tagging", "parsing"]), "tagging, parsing; did you mean tagging?");
        let many: Vec<String> = (0..23).map(|i| i.to_string()).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert!(names("x", &many).ends_with("18, 19 and 3 more"));
        assert_eq!(names("x", &[]), "");
    }
}
