//! Reading handwritten words as a [`Task`]: what the program's verbs need of it.

use super::space::{LONGEST, Ocr, Scribe, Sightings};
use super::{Accuracy, space};
use crate::error::{Error, Place, Result};
use crate::read::conll::Block;
use crate::read::letters::{self, LETTERS, Letters, UNKNOWN};
use crate::space::{Action, Imitation};
use crate::tasks::{Arrays, Data, Fact, Measure, Model, Score, Task, write_line};
use memchr::memchr_iter;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A trained reader of handwritten words: how it sees them, and the policy.
pub type Reader = Model<Sightings>;

/// Words of handwritten letters from a file, not all of which need be known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Page {
    /// The words.
    pub letters: Letters,
    path: PathBuf,
    /// The letters that are not known, and where they stand, in order.
    unknown: Vec<(usize, Place)>,
}

impl Page {
    /// The page that is `text`, which comes from `path`.
    ///
    /// # Errors
    /// With the exact place, as [`letters::parse`], and when a word is longer than [`LONGEST`].
    pub fn parse(text: &[u8], path: &Path) -> Result<Page> {
        let letters = letters::parse(text, path)?;
        // The first line has no letter, every other has one.
        let lines: Vec<usize> = memchr_iter(b'\n', text).map(|at| at + 1).collect();
        for i in 0..letters.words() {
            let word = letters.word(i);
            if word.len() > LONGEST {
                let place = Place::of(path, text, lines[word.start + LONGEST]);
                return Err(Error::data(place, "one more letter", format!("words of at most {LONGEST}")));
            }
        }
        let mut unknown = Vec::new();
        for (at, _) in letters.labels().iter().enumerate().filter(|(_, label)| **label == UNKNOWN) {
            let before = memchr_iter(b'\t', &text[lines[at]..]).nth(2).unwrap_or(0);
            unknown.push((at, Place::of(path, text, lines[at] + before + 1)));
        }
        Ok(Page { letters, path: path.to_owned(), unknown })
    }

    /// Refuses a page on which not every letter is known.
    fn all_known(&self, what: &str) -> Result<()> {
        match self.unknown.first() {
            Some((_, place)) => {
                Err(Error::data(place.clone(), "no letter", format!("words {what}: a letter in every line")))
            }
            None => Ok(()),
        }
    }
}

impl Data for Page {
    fn path(&self) -> &Path {
        &self.path
    }
    fn sentences(&self) -> usize {
        self.letters.words()
    }
    fn tokens(&self) -> usize {
        self.letters.len()
    }
    fn truncate(&mut self, words: usize) {
        self.letters.truncate(words);
        self.unknown.retain(|(at, _)| *at < self.letters.len());
    }
    fn split_off(&mut self, words: usize) -> Self {
        let letters = self.letters.split_off(words);
        let kept = self.letters.len();
        let first = self.unknown.partition_point(|(at, _)| *at < kept);
        let unknown = self.unknown.split_off(first).into_iter().map(|(at, place)| (at - kept, place)).collect();
        Page { letters, path: self.path.clone(), unknown }
    }
}

impl Task for Sightings {
    const NAME: &'static str = "ocr";
    type Data = Page;
    type Settings = Sightings;
    type Space = Ocr;
    type Expert = Scribe;
    type Score = Accuracy;
    type Header = Sightings;
    type Stream = ();

    fn parse(text: &[u8], path: &Path) -> Result<Page> {
        Page::parse(text, path)
    }

    /// A page has no blank lines, at which a stream is cut: the first block is all of it.
    fn parse_block(&self, block: &Block, path: &Path, (): &mut ()) -> Result<Option<Page>> {
        Page::parse(&block.bytes, path).map(Some)
    }

    fn learn(page: &Page, see: Sightings) -> Result<(Self, Imitation<Ocr, Scribe>)> {
        page.all_known("to learn from")?;
        let space = see.apply(page)?;
        Ok((see, space.problem()))
    }

    fn apply(&self, page: &Page) -> Result<Ocr> {
        Ocr::new(&page.letters, self.clone())
    }

    /// The letters become a further last column, `read`.
    fn write(&self, block: &Block, of: Option<(&Page, &[Action])>, out: &mut impl Write) -> io::Result<()> {
        let read: Vec<u32> = of.map_or(Vec::new(), |(page, actions)| self.words(page, actions).concat());
        let mut lines = block.lines();
        if let Some(head) = lines.next() {
            write_line(out, head, Some("read"))?;
        }
        let mut read = read.iter().map(|letter| char::from(b'a' + *letter as u8));
        let mut name = [0; 4];
        lines.try_for_each(|line| write_line(out, line, read.next().map(|letter| &*letter.encode_utf8(&mut name))))
    }

    fn check(&self, page: &Page) -> Result<()> {
        page.all_known("to measure on")
    }

    fn score(&self, page: &Page, actions: &[Action]) -> Result<Accuracy> {
        self.check(page)?;
        let mut accuracy = Accuracy::default();
        for (i, read) in self.words(page, actions).into_iter().enumerate() {
            let wrong = page.letters.labels()[page.letters.word(i)].iter().zip(&read).filter(|(a, b)| a != b).count();
            accuracy.add(read.len() as u64, wrong as u64);
        }
        Ok(accuracy)
    }

    fn answers(&self, page: &Page, actions: &[Action], tell: &mut dyn FnMut(&str, &str)) -> Result<()> {
        self.check(page)?;
        let (mut right, mut given) = ([0; 4], [0; 4]);
        for (letter, read) in page.letters.labels().iter().zip(self.words(page, actions).concat()) {
            let [letter, read] = [*letter, read].map(|number| char::from(b'a' + number as u8));
            tell(letter.encode_utf8(&mut right), read.encode_utf8(&mut given));
        }
        Ok(())
    }

    fn features(&self) -> usize {
        space::features(self)
    }

    fn actions(&self) -> usize {
        LETTERS
    }

    /// All: their numbers say what they are.
    fn keep(&mut self, _: &dyn Fn(u32) -> bool) -> Result<Vec<u32>> {
        Ok((0..space::features(self) as u32).collect())
    }

    fn header(&self) -> Sightings {
        self.clone()
    }

    fn arrays(&self) -> Vec<&[u64]> {
        Vec::new()
    }

    fn restore(see: Sightings, _: &mut Arrays<'_>, _: &Path) -> Result<Self, String> {
        see.validate().map_err(|error| error.to_string())?;
        Ok(see)
    }

    fn facts(&self) -> Vec<Fact> {
        let fact = |name, value: serde_json::Value| Fact { name, text: value.to_string(), value };
        vec![
            fact("patch", self.patch.into()),
            fact("history", self.history.into()),
            fact("rest", self.rest.into()),
            fact("passes", self.passes.into()),
        ]
    }
}

impl Sightings {
    /// What `actions`, those of all words of `page`, say of each: what was said last.
    fn words(&self, page: &Page, actions: &[Action]) -> Vec<Vec<u32>> {
        let word = |i: usize| {
            let word = page.letters.word(i);
            let last = word.start * self.passes + word.len() * (self.passes - 1);
            actions[last..last + word.len()].iter().map(|action| action.0).collect()
        };
        (0..page.letters.words()).map(word).collect()
    }
}

impl Score for Accuracy {
    fn text(&self) -> String {
        format!(
            "read {} letters in {} words\nletters: {:.2}%\nwords: {:.2}%\n",
            self.letters,
            self.words,
            100.0 * self.of_letters(),
            100.0 * self.of_words(),
        )
    }

    fn loss(&self) -> f64 {
        (self.letters - self.right_letters) as f64
    }

    fn measures(&self) -> Vec<Measure> {
        vec![
            Measure { key: "words", name: "words %", percent: Some(100.0 * self.of_words()) },
            Measure { key: "letters", name: "letters %", percent: Some(100.0 * self.of_letters()) },
        ]
    }
}
