//! Feature templates: the pattern language of CRF++ and Wapiti, compiled to integer hashes.
//!
//! Each line of a template is one pattern, and each pattern makes one feature at each token. The first character says
//! what kind: `U` looks at the observed columns only, `B` also at the previous label, `*` stands for both lines at
//! once. The rest of the line is text in which these stand for what is found at the token:
//!
//! | command               | stands for                                                                             |
//! |-----------------------|----------------------------------------------------------------------------------------|
//! | `%x[row,col]`         | the word in column `col` (from 0), `row` tokens further on (before, if negative)       |
//! | `%t[row,col,"regex"]` | `true` if `regex` is found in that word, otherwise `false`                             |
//! | `%m[row,col,"regex"]` | what `regex` matches in that word first; nothing if it does not                        |
//! | `%s[row,col,n]`       | the first `n` characters of the word's shape: A-Z as `X`, a-z as `x`, 0-9 as `d`       |
//! | `%y[-k]`              | the label `k` tokens before                                                            |
//! | `%y[k]`               | what a first reading said of the token (`%y[0]`) or of the one `k` tokens further on   |
//!
//! An upper-case letter (`%X`, `%T`, `%M`, `%S`) folds the result to lower case. `@` makes a row absolute, as in
//! Wapiti: `%x[@1,0]` is the sentence's first word and `%x[@-1,0]` its last. Rows reach no further than 100
//! tokens, labels no further than 8. A cell before the sentence reads as `_B-1` next to the first token, `_B-2` before that, and so on; after the
//! sentence as `_B+1`, `_B+2`, ... .
//!
//! A `#` begins a comment at the start of a line, or after a space outside a command. Two lines that differ only in
//! rows and columns make the same features, a bag of words; a name such as `U01:` tells them apart.
//!
//! Regular expressions are Wapiti's: `.` any character; `\d` digit, `\a` letter, `\l` lower-case and `\u` upper-case
//! letter, `\w` letter or digit, `\p` punctuation, `\s` space (all ASCII), the upper-case letter for everything else;
//! `\` before any other character for that character; `?` for at most one (one, if possible) and `*` for any number
//! (the fewest possible) of what stands before it; `^` first and `$` last for the ends of the word. All else means
//! itself.
//!
//! # Extensions
//!
//! CRF++ and Wapiti know neither `%s` nor `%y`, nor the following.
//! - A pattern with `%y` is a history feature ([`Template::history`]). `B...` is the same as a `U...` line with one
//!   more `%y[-1]` at its end, and a bare `B` the previous label alone.
//! - With a `%y[k]` that is not negative in it, a template asks for two readings: the first goes through the sentence from its end, by
//!   all patterns without such a `%y`, and its `%y[-1]` is then the label of the token *after*; the second goes from the start and sees, beside the
//!   labels it has given itself, those of the first.
//! - The line `@pad <s> </s>` makes every cell before a sentence read as `<s>`, at any distance, and every cell after
//!   it as `</s>`.
//!
//! Of Wapiti's language, only rows that are read from a column (`%x[*2,0]`) are missing: they are refused.
//!
//! ```
//! use rollin::read::{conll, template::Template};
//!
//! let corpus = conll::parse(b"The DT\ncat NN\n", "pets".as_ref(), 1)?;
//! let template = Template::parse("U1:%X[-1,0]\nU2:%m[0,0,\"..$\"]/%x[0,1]\nB\n", "two.template".as_ref())?;
//! let bound = template.bind(&corpus)?;
//! let mut features = Vec::new();
//! bound.observe(corpus.sentence(0), 1, &mut features);
//! assert_eq!(features.len(), 2);
//! assert_eq!(template.history()[0].labels, [-1]);
//! # Ok::<(), rollin::Error>(())
//! ```

mod pattern;
mod plan;
mod regex;
mod spell;

pub use plan::{ABSENT, Bound, Numbered};
pub use spell::{HOLE, Speller};

use super::input;
use crate::corpus::{Corpus, MARK};
use crate::error::{Error, Place, Result};
use pattern::{Line, Part};
use plan::Plan;
use regex::Transform;
use std::path::Path;

/// How many tokens away a row may be.
const REACH: i32 = 100;
/// How many labels back or ahead a history feature may look.
pub const BACK: i32 = 8;

/// The template for one observed column.
const WORDS: &str = include_str!("../../grammars/words.template");

/// Which labels a history feature looks at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct History {
    /// How many tokens further on each label stands, in the order in which the pattern names them: `[-1, -2]` is the previous label and
    /// the one before it; from 0 on it is that of a first reading. Never empty.
    pub labels: Vec<i32>,
}

impl History {
    /// Whether it looks at what a first reading said.
    pub fn looks_ahead(&self) -> bool {
        self.labels.iter().any(|k| *k >= 0)
    }
}

/// A compiled feature template.
#[derive(Clone, Debug)]
pub struct Template {
    text: String,
    /// The distinct things that are made of a column's words.
    tables: Vec<(Transform, u32)>,
    /// Where each column that is referred to is referred to first.
    columns: Vec<(u32, Place)>,
    observe: Plan,
    contexts: Plan,
    history: Vec<History>,
}

impl Template {
    /// The template that is `text`, which was read from `path`.
    ///
    /// # Errors
    /// With its place, whatever is not of the language described in the [module's documentation](self), and when there
    /// is no pattern.
    pub fn parse(text: &str, path: &Path) -> Result<Template> {
        let mut template = Template {
            text: text.to_owned(),
            tables: Vec::new(),
            columns: Vec::new(),
            observe: Plan::default(),
            contexts: Plan::default(),
            history: Vec::new(),
        };
        let mut pad: Option<(String, String)> = None;
        let mut patterns = Vec::new();
        for (index, line) in text.strip_prefix(MARK).unwrap_or(text).split('\n').enumerate() {
            let line = line.trim_ascii_end();
            let place = |byte: usize| {
                let before = line.get(..byte).unwrap_or(line);
                Place { path: path.to_owned(), line: index + 1, column: before.chars().count() + 1 }
            };
            match pattern::line(line).map_err(|fault| fault.at(place(line.len() - fault.rest.len())))? {
                Line::Blank => {}
                Line::Pad { .. } if pad.is_some() => {
                    return Err(Error::data(place(0), "a second @pad", "one for the whole template"));
                }
                Line::Pad { before, after } => pad = Some((before, after)),
                Line::Pattern { kind, parts } => {
                    template.refer(&parts, place);
                    patterns.push((kind, parts));
                }
            }
        }
        if patterns.is_empty() {
            let place = Place::of(path, text.as_bytes(), text.len());
            return Err(Error::data(place, "no pattern", "a line with U, B or *"));
        }
        // Only now: a @pad counts for the lines above it too.
        let pad = pad.as_ref().map(|(before, after)| (before.as_str(), after.as_str()));
        for (kind, parts) in patterns {
            template.add(kind, parts, pad);
        }
        Ok(template)
    }

    /// Notes the places of the columns that a pattern is the first to refer to.
    fn refer(&mut self, parts: &[Part], place: impl Fn(usize) -> Place) {
        for part in parts {
            if let Part::Cell { column, at, .. } = part
                && !self.columns.iter().any(|(known, _)| known == column)
            {
                self.columns.push((*column, place(*at)));
            }
        }
    }

    /// Adds the features of one pattern.
    fn add(&mut self, kind: char, parts: Vec<Part>, pad: Option<(&str, &str)>) {
        for parts in pattern::features(kind, parts) {
            self.add_line(kind, &parts, pad);
        }
    }

    /// Adds one feature: a history feature if it looks at a label.
    fn add_line(&mut self, kind: char, parts: &[Part], pad: Option<(&str, &str)>) {
        let labels: Vec<i32> =
            parts.iter().filter_map(|p| if let Part::Label(k) = p { Some(*k) } else { None }).collect();
        let plan = if labels.is_empty() { &mut self.observe } else { &mut self.contexts };
        plan.add(kind, parts, pad, &mut self.tables);
        if !labels.is_empty() {
            self.history.push(History { labels });
        }
    }

    /// Reads the template in the file at `path`.
    ///
    /// # Errors
    /// As [`Template::parse`], and when the file cannot be read or is not UTF-8.
    pub fn read_file(path: impl AsRef<Path>) -> Result<Template> {
        let path = path.as_ref();
        Template::parse(&input::text(path)?, input::name(path))
    }

    /// A template for corpora of which `columns` columns are observed: words in the first, tags or classes of any kind
    /// in the others (at most 15 of which are looked at).
    pub fn default_for(columns: usize) -> Template {
        let mut text = if columns == 0 { "B\nU:%y[-1]%y[-2]\n".to_owned() } else { WORDS.to_owned() };
        for c in 1..columns.min(16) {
            text += &tags(c);
        }
        match Template::parse(&text, Path::new("<default template>")) {
            Ok(template) => template,
            Err(fault) => unreachable!("every default is tested to parse: {fault}"),
        }
    }

    /// The text it was parsed from.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// How many columns a corpus must have: one more than the last column referred to, 0 if there is none.
    pub fn columns(&self) -> usize {
        self.columns.iter().map(|(column, _)| *column as usize + 1).max().unwrap_or(0)
    }

    /// Where the template refers to `column` first, if it does.
    pub fn refers_to(&self, column: usize) -> Option<&Place> {
        self.columns.iter().find(|(known, _)| *known as usize == column).map(|(_, place)| place)
    }

    /// How many observation features each token has.
    pub fn observations(&self) -> usize {
        self.observe.lines()
    }

    /// The labels that each history feature looks at, in the order of the patterns.
    pub fn history(&self) -> &[History] {
        &self.history
    }

    /// Whether it asks for two readings.
    pub fn looks_ahead(&self) -> bool {
        self.history.iter().any(History::looks_ahead)
    }

    /// The template ready to be applied to `corpus`. Its cost is that of the corpus's distinct words.
    ///
    /// # Errors
    /// When the template refers to a column that the corpus does not have.
    pub fn bind<'a>(&'a self, corpus: &'a Corpus) -> Result<Bound<'a>> {
        self.check_columns(corpus)?;
        Ok(Bound::new(self, corpus))
    }

    /// The template ready to spell out its features for `corpus`, for other programs.
    ///
    /// # Errors
    /// When the template refers to a column that the corpus does not have.
    pub fn speller<'a>(&self, corpus: &'a Corpus) -> Result<Speller<'a>> {
        self.check_columns(corpus)?;
        Ok(Speller::new(&self.text, corpus))
    }

    /// Refuses a corpus that lacks a column the template refers to.
    fn check_columns(&self, corpus: &Corpus) -> Result<()> {
        let count = corpus.columns.len();
        if let Some((column, place)) = self.columns.iter().find(|(column, _)| *column as usize >= count) {
            let columns = match count {
                0 => "no column at all".to_owned(),
                1 => "column 0 only".to_owned(),
                _ => format!("columns 0 to {}", count - 1),
            };
            let expected = format!("a column of {}, which has {columns}", corpus.path.display());
            return Err(Error::data(place.clone(), format!("column {column}"), expected));
        }
        Ok(())
    }
}

/// The patterns for a further column `c`: windows, pairs, triples, and history.
fn tags(c: usize) -> String {
    let mut text = format!("\n# Column {c}: a window, its pairs and triples, and history.\n");
    for row in -2..=2 {
        text += &format!("U{c}a{row}:%x[{row},{c}]\n");
    }
    for row in -2..=1 {
        text += &format!("U{c}b{row}:%x[{row},{c}]/%x[{},{c}]\n", row + 1);
    }
    for row in -2..=0 {
        text += &format!("U{c}c{row}:%x[{row},{c}]/%x[{},{c}]/%x[{},{c}]\n", row + 1, row + 2);
    }
    text + &format!("U{c}d:%y[-1]/%x[0,{c}]\nU{c}e:%y[-1]/%y[-2]/%x[0,{c}]\nU{c}f:%y[-1]/%x[0,{c}]/%x[1,{c}]\n")
}

#[cfg(test)]
mod tests;
