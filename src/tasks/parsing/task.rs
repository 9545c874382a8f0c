//! Parsing as a [`Task`]: what the program's verbs need of it.

use super::encoding::{Encoding, MOST_LABELS, Settings, Slots};
use super::oracle::GoldTree;
use super::score::Attachment;
use super::space::Parsing;
use super::state::{Configuration, System};
use crate::error::{Error, Result};
use crate::read::conll::Block;
use crate::read::conllu::{self, Arc, Treebank};
use crate::space::{Action, Imitation};
use crate::tasks::{Arrays, Data, Fact, Model, Task};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;

/// A trained parser: what turns a treebank into features, and the policy.
pub type Parser = Model<Encoding>;

/// What a model file says of a parser.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    system: System,
    labels: Vec<String>,
    /// See [`Encoding`].
    sides: Vec<u8>,
    features: usize,
}

impl Task for Encoding {
    const NAME: &'static str = "parsing";
    type Data = Treebank;
    type Settings = Settings;
    type Space = Parsing;
    type Expert = GoldTree;
    type Score = Attachment;
    type Header = Header;
    type Stream = ();

    fn parse(text: &[u8], path: &Path) -> Result<Treebank> {
        conllu::parse(text, path, 1)
    }

    fn parse_block(&self, block: &Block, path: &Path, (): &mut ()) -> Result<Option<Treebank>> {
        let bank = conllu::parse_block(&block.bytes, path, block.first_line)?;
        Ok((bank.sentences() > 0).then_some(bank))
    }

    fn learn(bank: &Treebank, settings: Settings) -> Result<(Self, Imitation<Parsing, GoldTree>)> {
        let (encoding, space) = Encoding::learn(bank, &settings)?;
        Ok((encoding, space.problem()))
    }

    fn extend(&self, bank: &Treebank) -> Result<(Self, Imitation<Parsing, GoldTree>, Vec<u32>)> {
        let (encoding, space, moved) = Encoding::extend(self, bank)?;
        Ok((encoding, space.problem(), moved))
    }

    fn apply(&self, bank: &Treebank) -> Result<Parsing> {
        Encoding::apply(self, bank)
    }

    fn write(&self, block: &Block, of: Option<(&Treebank, &[Action])>, out: &mut impl Write) -> io::Result<()> {
        let Some((bank, actions)) = of else { return out.write_all(&block.bytes) };
        let arcs = self.arcs(bank, actions);
        bank.write(out, |w| Arc { head: arcs[w].0, relation: self.relation(arcs[w].1) })
    }

    fn check(&self, bank: &Treebank) -> Result<()> {
        if let Some(w) = bank.first_unknown() {
            return Err(Error::data(
                bank.head_place(w),
                "no head",
                "a treebank to measure on: HEAD and DEPREL in every line",
            ));
        }
        let unseen = |w: &usize| self.labels.binary_search_by(|label| label.as_str().cmp(bank.relation(*w))).is_err();
        match (0..bank.words()).find(unseen) {
            Some(w) => {
                let problem = format!("relation {}, which was never seen in training", bank.relation(w));
                Err(Error::data(bank.relation_place(w), problem, format!("one of {}", self.labels.join(" "))))
            }
            None => Ok(()),
        }
    }

    fn score(&self, bank: &Treebank, actions: &[Action]) -> Result<Attachment> {
        self.check(bank)?;
        let mut score = Attachment::default();
        for (w, (head, label)) in self.arcs(bank, actions).into_iter().enumerate() {
            score.add(bank.upos(w), Some(head) == bank.head(w), self.relation(label) == bank.relation(w));
        }
        Ok(score)
    }

    /// The relations, wherever the heads are.
    fn answers(&self, bank: &Treebank, actions: &[Action], tell: &mut dyn FnMut(&str, &str)) -> Result<()> {
        self.check(bank)?;
        for (w, (_, label)) in self.arcs(bank, actions).into_iter().enumerate() {
            tell(bank.relation(w), self.relation(label));
        }
        Ok(())
    }

    fn features(&self) -> usize {
        Encoding::features(self)
    }

    fn actions(&self) -> usize {
        Encoding::actions(self)
    }

    fn keep(&mut self, used: &dyn Fn(u32) -> bool) -> Result<Vec<u32>> {
        let kept: Vec<u32> = (0..Encoding::features(self) as u32).filter(|feature| used(*feature)).collect();
        self.slots = self.slots.keep(&kept).into();
        Ok(kept)
    }

    fn header(&self) -> Header {
        Header {
            system: self.system,
            labels: self.labels.clone(),
            sides: self.sides.clone(),
            features: Encoding::features(self),
        }
    }

    /// Which slots are in use, as bits.
    fn arrays(&self) -> Vec<&[u64]> {
        vec![self.slots.bits()]
    }

    fn restore(header: Header, arrays: &mut Arrays<'_>, _: &Path) -> Result<Self, String> {
        let labels = header.labels;
        if labels.is_empty() || labels.len() > MOST_LABELS || !labels.is_sorted_by(|a, b| a < b) {
            return Err("its labels are not a sorted list of names".into());
        }
        if labels.iter().any(|label| label.is_empty() || label.contains(['\t', '\n', '\r'])) {
            return Err("one of its labels cannot stand in a column".into());
        }
        if header.sides.len() != labels.len() {
            return Err("its labels do not all have sides".into());
        }
        let bits = arrays.keys(Slots::WORDS).ok_or("it ends within the slots of its features")?;
        let slots = Slots::of(bits.collect());
        if slots.len() != header.features {
            return Err("it has not as many features as it says".into());
        }
        Ok(Encoding::of(header.system, labels, header.sides, slots))
    }

    fn facts(&self) -> Vec<Fact> {
        let system = serde_json::json!(self.system);
        vec![
            Fact { name: "system", text: system.as_str().unwrap_or_default().into(), value: system },
            Fact { name: "labels", text: self.labels.join(" "), value: self.labels.clone().into() },
        ]
    }
}

impl Encoding {
    /// The arcs that `actions`, those of all sentences of `bank`, make: for each word the number of its head in the sentence, from 1, or 0, and that
    /// of its label in [`Encoding::labels`].
    ///
    /// # Panics
    /// When they are not the actions of a whole run over `bank`.
    pub fn arcs(&self, bank: &Treebank, actions: &[Action]) -> Vec<(u32, u32)> {
        let mut arcs = Vec::with_capacity(bank.words());
        let mut actions = actions.iter();
        for i in 0..bank.sentences() {
            let mut state = Configuration::new(0, bank.sentence(i).len());
            while !state.finished() {
                let action = actions.next();
                assert!(action.is_some(), "actions end within a sentence");
                action.into_iter().for_each(|action| state.take(self.system, *action));
            }
            arcs.extend(state.arcs());
        }
        arcs
    }

    /// The name of a label.
    fn relation(&self, label: u32) -> &str {
        self.labels.get(label as usize).map_or("_", String::as_str)
    }
}

impl Data for Treebank {
    fn path(&self) -> &Path {
        &self.path
    }
    fn sentences(&self) -> usize {
        Treebank::sentences(self)
    }
    fn tokens(&self) -> usize {
        self.words()
    }
    fn truncate(&mut self, sentences: usize) {
        Treebank::truncate(self, sentences);
    }
    fn split_off(&mut self, sentences: usize) -> Self {
        Treebank::split_off(self, sentences)
    }
}
