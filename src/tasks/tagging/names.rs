//! The names of features. A model keeps their hashes only; what was hashed is spelled out from a text in which they occur.

use super::Encoding;
use crate::corpus::Corpus;
use crate::error::Result;
use crate::read::template::HOLE;
use crate::space::Action;
use crate::tasks::Names;

/// Notes `text` as the name of the thing with this number, if that has none yet.
fn note(names: &mut [Option<Box<str>>], number: Option<u32>, text: &str) {
    let Some(name) = number.and_then(|number| names.get_mut(number as usize)) else { return };
    name.get_or_insert_with(|| text.into());
}

/// `name` with its holes filled by `labels`.
fn filled(name: &str, labels: &[&str]) -> String {
    let mut parts = name.split(HOLE);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.zip(labels).fold(first, |name, (part, label)| name + label + part)
}

impl Encoding {
    /// What tells the names of the features that occur in `corpus`: observations as [`crate::read::template::Speller`] spells them, history features with the labels
    /// that they look at, as in `B:y[-1]=B-NP`; `_` where there is none. Of features that share a number none has a name.
    ///
    /// # Errors
    /// When `corpus` lacks a column that the template needs.
    pub fn feature_names(&self, corpus: &Corpus) -> Result<Names<'_>> {
        let (bound, speller) = (self.template.bind(corpus)?, self.template.speller(corpus)?);
        let mut fixed: Vec<Option<Box<str>>> = vec![None; self.features.len()];
        let mut contexts: Vec<Vec<Option<Box<str>>>> = self.contexts.iter().map(|d| vec![None; d.len()]).collect();
        let mut hashes = Vec::new();
        for sentence in (0..corpus.sentences()).map(|i| corpus.sentence(i)) {
            for token in sentence.clone() {
                hashes.clear();
                bound.observe(sentence.clone(), token, &mut hashes);
                let mut at = hashes.iter();
                speller.observe(&sentence, token, |text| {
                    note(&mut fixed, at.next().and_then(|hash| self.features.find(*hash)), text);
                });
                hashes.clear();
                bound.contexts(sentence.clone(), token, &mut hashes);
                let mut at = hashes.iter().zip(&self.contexts).zip(&mut contexts);
                speller.contexts(&sentence, token, |text| {
                    if let Some(((hash, known), names)) = at.next() {
                        note(names, known.find(*hash), text);
                    }
                });
            }
        }
        Ok(Box::new(move |number| match fixed.get(number as usize) {
            Some(name) => name.as_deref().map(str::to_owned),
            None => {
                let apart = |line: &super::HistoryLine| Some((line.line, line.apart(number, self.labels.len())?));
                let (line, (context, labels)) = self.history.iter().find_map(apart)?;
                let labels: Vec<&str> =
                    labels.iter().map(|label| label.map_or("_", |y| self.labels[y].as_str())).collect();
                Some(filled(contexts[line][context as usize].as_deref()?, &labels))
            }
        }))
    }

    /// The features that look at the label before and nothing else: that label, and the feature's number.
    pub(super) fn label_features(&self) -> Vec<(Option<Action>, u32)> {
        let plain = self.history.iter().find(|line| line.labels == [-1] && self.contexts[line.line].len() == 1);
        let Some(line) = plain else { return Vec::new() };
        let labels = self.labels.len() as u64;
        let feature = |y: u16| line.feature(0, labels, |_| y);
        let label = |y: u16| Some(Action(u32::from(y))).filter(|_| u64::from(y) < labels);
        (0..=labels as u16).map(|y| (label(y), feature(y))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::conll;
    use crate::read::template::Template;
    use crate::space::{Episode, Features, Space};
    use proptest::prelude::*;

    #[test]
    fn holes_are_filled_from_left_to_right() {
        assert_eq!(filled("U:y[-1]=\0/x/y[-2]=\0", &["A", "_"]), "U:y[-1]=A/x/y[-2]=_");
        assert_eq!(filled("U:x", &[]), "U:x");
    }

    proptest! {
        /// At each state the names of what is seen are those that the template's lines say, with the labels just given.
        #[test]
        fn names_are_what_the_template_says(words in prop::collection::vec("[ab]", 1..6), tags in prop::collection::vec("[XYZ]", 6)) {
            let lines: String = words.iter().zip(&tags).map(|(word, tag)| format!("{word} {tag}\n")).collect();
            let corpus = conll::parse(lines.as_bytes(), "c".as_ref(), 1)?;
            let text = "U0:%x[0,0]\nU1:%x[-1,0]\nB\n*2:%x[0,0]\nU3:%y[-2]/%x[0,0]/%y[-1]\n";
            let template = Template::parse(text, "t".as_ref())?;
            let (encoding, space) = Encoding::learn(&corpus, template.into())?;
            let names = encoding.feature_names(&corpus)?;
            let seed = crate::seed::Seed::new(1);
            let (mut state, mut view) = (space.start(Episode { index: 0, seed }), Features::default());
            for (t, word) in words.iter().enumerate() {
                space.look(&state, &mut view);
                let mut found: Vec<String> = space.shared().listed(view.row, view.key, &view.dynamic).iter()
                    .map(|feature| names(feature).expect("all occur")).collect();
                found.sort();
                let before = |k: usize| t.checked_sub(k).map_or("_", |at| tags[at].as_str());
                let pad = t.checked_sub(1).map_or("_B-1", |at| words[at].as_str());
                let mut expected = vec![
                    format!("U0:{word}"), format!("U1:{pad}"), format!("*2:{word}"), format!("B:y[-1]={}", before(1)),
                    format!("*2:{word}|y[-1]={}", before(1)), format!("U3:y[-2]={}/{word}/y[-1]={}", before(2), before(1)),
                ];
                expected.sort();
                prop_assert_eq!(found, expected);
                let label = encoding.labels.iter().position(|label| *label == tags[t]).expect("a label");
                space.step(&mut state, Action(label as u32), seed);
            }
            let plain: Vec<_> = encoding.label_features().into_iter().map(|(y, feature)| (y.map(|y| y.0), names(feature))).collect();
            let last = encoding.labels.len();
            prop_assert_eq!(plain.len(), last + 1);
            for (y, (label, name)) in plain.into_iter().enumerate() {
                prop_assert_eq!(label, (y < last).then_some(y as u32));
                let label = if y < last { encoding.labels[y].as_str() } else { "_" };
                prop_assert_eq!(name, Some(format!("B:y[-1]={label}")));
            }
        }
    }
}
