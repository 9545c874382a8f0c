//! From a treebank to the numbers of a [`Parsing`] space, and what makes the same numbers of another treebank.

use super::features::{self, Attributes, BITS, Found};
use super::oracle::{GoldTree, side};
use super::space::{Legal, Parsing};
use super::state::{MOVES, ROOT, System};
use super::tree::{Trees, projectivise};
use crate::error::{Error, Result};
use crate::read::conllu::Treebank;
use crate::seed::Seed;
use crate::space::{Episode, Expert, FeatureTable, Space};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::sync::Arc;

/// Labels are counted in 16 bits.
pub const MOST_LABELS: usize = u16::MAX as usize;

/// Which slots of hashed features are in use, and their numbers: a slot's number is how many slots in use come before it. Few bytes, so
/// that features without weights are dropped before any memory far away is touched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Slots {
    bits: Box<[u64]>,
    /// How many slots in use come before each word of `bits`.
    ranks: Box<[u32]>,
}

impl Slots {
    /// The words of bits.
    pub const WORDS: usize = 1 << (BITS - 6);

    /// The slots whose bits are set.
    pub fn of(bits: Box<[u64]>) -> Self {
        let before = bits.iter().scan(0, |sum, word| Some(std::mem::replace(sum, *sum + word.count_ones())));
        Slots { ranks: before.collect(), bits }
    }

    /// The words of bits, bit i of word j standing for slot 64j + i.
    pub fn bits(&self) -> &[u64] {
        &self.bits
    }

    /// How many are in use.
    pub fn len(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Appends the numbers of those of `slots` that are in use.
    #[inline]
    pub fn number(&self, slots: &[u32], numbers: &mut Vec<u32>) {
        // Written first and kept if in use: whether a slot is, cannot be predicted.
        let start = numbers.len();
        numbers.resize(start + slots.len(), 0);
        let mut end = start;
        for &slot in slots {
            let (word, bit) = (slot as usize / 64, slot % 64);
            let bits = self.bits[word];
            numbers[end] = self.ranks[word] + (bits & ((1 << bit) - 1)).count_ones();
            end += (bits >> bit & 1) as usize;
        }
        numbers.truncate(end);
    }

    /// Those in use here or in `other`, and for each the number that it has here, or `u32::MAX`.
    fn with(&self, other: &Self) -> (Self, Vec<u32>) {
        let both: Box<[u64]> = self.bits.iter().zip(&other.bits).map(|(a, b)| a | b).collect();
        let (mut moved, mut next) = (Vec::new(), 0);
        for (all, own) in both.iter().zip(&self.bits) {
            let mut rest = *all;
            while rest != 0 {
                let lowest = rest & rest.wrapping_neg();
                let is_own = own & lowest != 0;
                moved.push(if is_own { next } else { u32::MAX });
                next += u32::from(is_own);
                rest ^= lowest;
            }
        }
        (Slots::of(both), moved)
    }

    /// Of those in use only the ones whose numbers are `kept`, ascending.
    pub fn keep(&self, kept: &[u32]) -> Self {
        let mut bits = self.bits.clone();
        let mut kept = kept.iter().copied().peekable();
        let mut number = 0;
        for word in &mut bits {
            let mut rest = *word;
            while rest != 0 {
                let lowest = rest & rest.wrapping_neg();
                if kept.next_if_eq(&number).is_none() {
                    *word ^= lowest;
                }
                rest ^= lowest;
                number += 1;
            }
        }
        Slots::of(bits)
    }
}

/// How a parser is set up.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The transition system.
    pub system: System,
    /// Features seen fewer times along the right trees are left out.
    pub cutoff: u8,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { system: System::ArcHybrid, cutoff: 2 }
    }
}

/// What turns a treebank into features and actions: the system, the labels, and which features were seen in training.
#[derive(Clone, Debug)]
pub struct Encoding {
    /// The transition system.
    pub system: System,
    /// The labels' names, sorted; a label's action is its place behind the moves.
    pub labels: Vec<String>,
    /// On which sides each label was seen, as bits: 1 left of its head, 2 right of it, 4 root.
    pub(super) sides: Vec<u8>,
    pub(super) slots: Arc<Slots>,
    pub(super) legal: Arc<Legal>,
}

impl Encoding {
    /// Learns the labels and features of `bank`, and gives it as a space with right trees. For a system that makes projective trees
    /// only, crossing arcs are lifted (Nivre & Nilsson 2005).
    ///
    /// # Errors
    /// When a sentence has no tree, or there are too many labels.
    pub fn learn(bank: &Treebank, settings: &Settings) -> Result<(Encoding, Parsing)> {
        check_heads(bank)?;
        let mut labels: Vec<String> = (0..bank.words()).map(|w| bank.relation(w).to_owned()).collect();
        labels.sort_unstable();
        labels.dedup();
        if labels.len() > MOST_LABELS {
            let mut seen = HashSet::new();
            let is_more = |w: &usize| seen.insert(bank.relation(*w)) && seen.len() > MOST_LABELS;
            let w = (0..bank.words()).find(is_more).unwrap_or(0);
            let problem = format!("one more relation, {:?}", bank.relation(w));
            let expected = format!("at most {MOST_LABELS} different ones");
            return Err(Error::data(bank.relation_place(w), problem, expected));
        }
        let mut sides = vec![0; labels.len()];
        let trees = trees(bank, &labels, settings.system, &mut sides);
        let none = Slots::of(vec![0; Slots::WORDS].into());
        let mut encoding = Encoding::of(settings.system, labels, sides, none);
        let mut space = Parsing { trees, ..encoding.apply(bank)? };
        encoding.slots = Arc::new(seen(&space, settings.cutoff.max(1)));
        space = Parsing { trees: std::mem::take(&mut space.trees), ..encoding.apply(bank)? };
        Ok((encoding, space))
    }

    /// What [`Encoding::learn`] gives of another treebank with these labels, for those who go on learning: features of `bank` that are not known here come
    /// in beside the others, and so do the sides on which a label stands. For each feature there is then the number that it has here, or `u32::MAX` if it is new.
    ///
    /// # Errors
    /// With the exact place, when a sentence has no tree or a relation is none of these labels.
    pub fn extend(&self, bank: &Treebank) -> Result<(Encoding, Parsing, Vec<u32>)> {
        check_heads(bank)?;
        let known = |w: &usize| self.labels.binary_search_by(|label| label.as_str().cmp(bank.relation(*w))).is_ok();
        if let Some(w) = (0..bank.words()).find(|w| !known(w)) {
            let expected = format!("one of the model's: {}", self.labels.join(" "));
            return Err(Error::data(bank.relation_place(w), format!("relation {}", bank.relation(w)), expected));
        }
        let mut sides = self.sides.clone();
        let trees = trees(bank, &self.labels, self.system, &mut sides);
        let mut encoding = Encoding::of(self.system, self.labels.clone(), sides, (*self.slots).clone());
        let mut space = Parsing { trees, ..encoding.apply(bank)? };
        let (slots, moved) = self.slots.with(&seen(&space, 1));
        encoding.slots = Arc::new(slots);
        space = Parsing { trees: std::mem::take(&mut space.trees), ..encoding.apply(bank)? };
        Ok((encoding, space, moved))
    }

    pub(super) fn of(system: System, labels: Vec<String>, sides: Vec<u8>, slots: Slots) -> Self {
        let legal = Arc::new(Legal::new(&sides));
        Encoding { system, labels, sides, slots: Arc::new(slots), legal }
    }

    /// A treebank as something to be parsed: features never seen in training are left out, and no right trees are known.
    ///
    /// # Errors
    /// When it has too many words to be numbered.
    pub fn apply(&self, bank: &Treebank) -> Result<Parsing> {
        if bank.words() >= u32::MAX as usize / 2 {
            return Err(Error::argument("words", bank.words(), format!("below {}", u32::MAX / 2)));
        }
        let words = Attributes::of(bank);
        let (mut starts, mut ids) = (vec![0], Vec::new());
        let mut found = Found::default();
        for i in 0..bank.sentences() {
            let sentence = &words[bank.sentence(i)];
            for w in 0..sentence.len() {
                for labelled in [false, true] {
                    features::fixed(sentence, w, labelled, &mut found);
                    self.slots.number(found.slots(), &mut ids);
                    starts.push(ids.len());
                }
            }
        }
        Ok(Parsing {
            system: self.system,
            starts: bank.starts().to_vec(),
            words,
            table: FeatureTable::from_rows(self.features(), starts, ids),
            slots: self.slots.clone(),
            legal: self.legal.clone(),
            labels: self.labels.len(),
            trees: Trees::default(),
        })
    }

    /// How many features there are.
    pub fn features(&self) -> usize {
        self.slots.len()
    }

    /// How many actions there are.
    pub fn actions(&self) -> usize {
        MOVES as usize + self.labels.len()
    }
}

/// Refuses a treebank in which a head is missing.
fn check_heads(bank: &Treebank) -> Result<()> {
    bank.first_unknown().map_or(Ok(()), |w| {
        let expected = "a treebank to learn from: HEAD and DEPREL in every line";
        Err(Error::data(bank.head_place(w), "no head", expected))
    })
}

/// All right trees; the sides on which a label stands are added to `sides`.
fn trees(bank: &Treebank, labels: &[String], system: System, sides: &mut [u8]) -> Trees {
    let mut trees = Trees::default();
    for i in 0..bank.sentences() {
        let (heads, numbers) = tree(bank, i, labels, system);
        for (w, label) in numbers.iter().enumerate() {
            sides[*label as usize] |= 1 << side(&heads, w) as u8;
        }
        trees.push(&heads, &numbers);
    }
    trees
}

/// Heads and labels of sentence `i`, in the numbers of a space.
fn tree(bank: &Treebank, i: usize, labels: &[String], system: System) -> (Vec<u32>, Vec<u32>) {
    let head = |w: usize| match bank.head(w) {
        Some(head) if head > 0 => head - 1,
        _ => ROOT,
    };
    let mut heads: Vec<u32> = bank.sentence(i).map(head).collect();
    if system != System::ArcStandardSwap {
        projectivise(&mut heads);
    }
    let label = |w: usize| labels.partition_point(|name| name.as_str() < bank.relation(w)) as u32;
    (heads, bank.sentence(i).map(label).collect())
}

/// The slots that are found `cutoff` times or more along the expert's own way through the right trees.
fn seen(space: &Parsing, cutoff: u8) -> Slots {
    let mut counts = vec![0u8; 64 * Slots::WORDS];
    let mut found = Found::default();
    let nothing = Seed::new(0);
    for index in 0..space.sentences() {
        let mut state = space.start(Episode { index, seed: nothing });
        let words = &space.words[space.starts[index] as usize..space.starts[index + 1] as usize];
        while !space.legal(&state).is_empty() {
            features::of(&state, words, &mut found);
            count(&mut counts, found.slots());
            let Some(action) = GoldTree.action(space, &state) else { break };
            space.step(&mut state, action, nothing);
        }
        for w in 0..words.len() {
            for labelled in [false, true] {
                features::fixed(words, w, labelled, &mut found);
                count(&mut counts, found.slots());
            }
        }
    }
    let word = |slots: &[u8]| slots.iter().rev().fold(0, |bits, n| bits << 1 | u64::from(*n >= cutoff));
    Slots::of(counts.chunks(64).map(word).collect())
}

fn count(counts: &mut [u8], slots: &[u32]) {
    for slot in slots {
        let n = &mut counts[*slot as usize];
        *n = n.saturating_add(1);
    }
}
