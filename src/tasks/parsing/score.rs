//! Attachment scores.

use crate::tasks::{Measure, Score};
use serde::{Serialize, Serializer};

/// Words whose head, and whose head and label, are right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Words counted.
    pub words: u64,
    /// Those on the right head.
    pub heads: u64,
    /// Those on the right head with the right label, subtype included.
    pub labelled: u64,
}

impl Counts {
    fn add(&mut self, head: bool, label: bool) {
        self.words += 1;
        self.heads += u64::from(head);
        self.labelled += u64::from(head && label);
    }

    /// The unlabelled attachment score, a share; 0 if there is no word.
    pub fn uas(&self) -> f64 {
        self.heads as f64 / self.words.max(1) as f64
    }

    /// The labelled attachment score, a share; 0 if there is no word.
    pub fn las(&self) -> f64 {
        self.labelled as f64 / self.words.max(1) as f64
    }
}

/// The attachment scores of parsed sentences: of all words, and of those that are no punctuation.
///
/// ```
/// use rollin::tasks::parsing::Attachment;
///
/// let mut score = Attachment::default();
/// score.add("NOUN", true, true);
/// score.add("VERB", true, false);
/// score.add("PUNCT", false, false);
/// assert_eq!((score.all.words, score.all.uas(), score.content.las()), (3, 2.0 / 3.0, 0.5));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attachment {
    /// All words.
    pub all: Counts,
    /// Those whose universal part of speech is not PUNCT.
    pub content: Counts,
}

impl Attachment {
    /// Counts a word of this universal part of speech, whether its head and whether its label is right.
    pub fn add(&mut self, upos: &str, head: bool, label: bool) {
        self.all.add(head, label);
        if upos != "PUNCT" {
            self.content.add(head, label);
        }
    }
}

impl Score for Attachment {
    fn text(&self) -> String {
        let line = |name: &str, counts: &Counts| {
            let (uas, las) = (100.0 * counts.uas(), 100.0 * counts.las());
            format!("{name}: {} words; UAS: {uas:6.2}%; LAS: {las:6.2}%\n", counts.words)
        };
        line("all", &self.all) + &line("without punctuation", &self.content)
    }

    fn loss(&self) -> f64 {
        (self.all.words - self.all.labelled) as f64
    }

    fn measures(&self) -> Vec<Measure> {
        let measure = |key, name, share: f64| Measure { key, name, percent: Some(100.0 * share) };
        vec![
            measure("uas", "UAS %", self.all.uas()),
            measure("las", "LAS %", self.all.las()),
            measure("uas_without_punctuation", "UAS % no punct.", self.content.uas()),
            measure("las_without_punctuation", "LAS % no punct.", self.content.las()),
        ]
    }
}

impl Serialize for Attachment {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Part {
            words: u64,
            heads: u64,
            labelled: u64,
            uas: f64,
            las: f64,
        }
        #[derive(Serialize)]
        struct Report {
            all: Part,
            without_punctuation: Part,
        }
        let part = |counts: &Counts| {
            let Counts { words, heads, labelled } = *counts;
            Part { words, heads, labelled, uas: counts.uas(), las: counts.las() }
        };
        Report { all: part(&self.all), without_punctuation: part(&self.content) }.serialize(serializer)
    }
}
