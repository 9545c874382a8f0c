//! Patterns compiled to tables of hashes and the order in which to mix them.
//!
//! The hash of a feature is a chain: it starts from the pattern's seed, which stands for all its text, and takes in the
//! hash of each thing found at the token, from left to right, by a multiplication to 128 bits folded to 64 (the mixing
//! step of wyhash and rapidhash). Equal seeds and equal findings give equal hashes; all else differs but for chance.

use super::Template;
use super::pattern::{Part, Row};
use super::regex::Transform;
use crate::corpus::{Corpus, hash};
use std::ops::Range;

/// An odd constant without structure: the fractional digits of pi (as the multiplier of every mixing step).
const MULTIPLIER: u64 = 0x243f_6a88_85a3_08d3;
/// Where the chain of a pattern's own text starts.
const START: u64 = 0x1319_8a2e_0370_7344;
/// Stands in a pattern's text for something found at a token.
const CELL: u64 = 0xa409_3822_299f_31d0;
/// Stands in a pattern's text for a label.
const LABEL: u64 = 0x082e_fa98_ec4e_6c89;

/// `state` after taking in `value`.
#[inline]
fn mix(state: u64, value: u64) -> u64 {
    let product = u128::from(state ^ value) * u128::from(MULTIPLIER);
    product as u64 ^ (product >> 64) as u64
}

/// Features of one kind.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    atoms: Vec<Atom>,
    lines: Vec<Line>,
    /// The atoms of all lines, one line after the other.
    order: Vec<u32>,
    /// What atoms read outside the sentence: for each atom, nearest first.
    pads: Vec<u64>,
}

/// One distinct thing found at a token.
#[derive(Clone, Debug)]
struct Atom {
    table: usize,
    row: Row,
    /// Where its pads start.
    pads: usize,
}

/// One feature.
#[derive(Clone, Debug)]
struct Line {
    seed: u64,
    /// Its atoms, in `order`.
    atoms: Range<usize>,
}

impl Plan {
    /// Adds a feature. What it makes of which column is looked up in `tables`, or added there.
    pub(super) fn add(
        &mut self,
        kind: char,
        parts: &[Part],
        pad: Option<(&str, &str)>,
        tables: &mut Vec<(Transform, u32)>,
    ) {
        let mut seed = mix(START, hash(kind.encode_utf8(&mut [0; 4])));
        let first = self.order.len();
        for part in parts {
            seed = mix(
                seed,
                match part {
                    Part::Text(text) => hash(text),
                    Part::Cell { .. } => CELL,
                    Part::Label(_) => LABEL,
                },
            );
            if let Part::Cell { transform, row, column, .. } = part {
                let known = tables.iter().position(|(t, c)| t == transform && c == column);
                let table = known.unwrap_or_else(|| {
                    tables.push((transform.clone(), *column));
                    tables.len() - 1
                });
                let atom = self.atom(table, *row, |word| transform.hash(word, &mut String::new()), pad);
                self.order.push(atom);
            }
        }
        self.lines.push(Line { seed, atoms: first..self.order.len() });
    }

    /// The number of the atom that reads `table` at `row`.
    fn atom(&mut self, table: usize, row: Row, hash: impl Fn(&str) -> u64, pad: Option<(&str, &str)>) -> u32 {
        let known = self.atoms.iter().position(|atom| atom.table == table && atom.row == row);
        let index = known.unwrap_or_else(|| {
            self.atoms.push(Atom { table, row, pads: self.pads.len() });
            // A sentence has at least one token, so this row never lies further outside than that.
            let (is_before, furthest) = match row {
                Row::Relative(n) | Row::First(n) | Row::End(n) => (n < 0, n.unsigned_abs()),
            };
            self.pads.extend((1..=furthest).map(|distance| match (pad, is_before) {
                (Some((before, _)), true) => hash(before),
                (Some((_, after)), false) => hash(after),
                (None, true) => hash(&format!("_B-{distance}")),
                (None, false) => hash(&format!("_B+{distance}")),
            }));
            self.atoms.len() - 1
        });
        index as u32
    }

    /// How many features there are.
    pub(super) fn lines(&self) -> usize {
        self.lines.len()
    }
}

/// A template applied to a corpus.
#[derive(Clone, Debug)]
pub struct Bound<'a> {
    /// For each table one after the other, the hash of what it makes of each word.
    hashes: Vec<u64>,
    observe: Sites<'a>,
    contexts: Sites<'a>,
}

/// A plan applied to a corpus.
#[derive(Clone, Debug)]
struct Sites<'a> {
    plan: &'a Plan,
    sites: Vec<Site<'a>>,
}

/// An atom applied to a corpus.
#[derive(Clone, Debug)]
struct Site<'a> {
    /// The column's cells.
    cells: &'a [u32],
    /// Where the table's hashes start.
    base: usize,
    /// 0: rows count from the token, 1: from the sentence's start, 2: from its end.
    anchor: usize,
    row: isize,
    pads: usize,
}

impl<'a> Bound<'a> {
    /// `template` applied to `corpus`, which has all the columns that are referred to.
    pub(super) fn new(template: &'a Template, corpus: &'a Corpus) -> Self {
        let mut hashes = Vec::new();
        let mut scratch = String::new();
        let mut bases = Vec::with_capacity(template.tables.len());
        for (transform, column) in &template.tables {
            let values = &corpus.columns[*column as usize].values;
            bases.push(hashes.len());
            if transform.is_identity() {
                hashes.extend_from_slice(values.hashes());
            } else {
                hashes.extend(values.iter().map(|word| transform.hash(word, &mut scratch)));
            }
        }
        let sites = |plan: &'a Plan| {
            let site = |atom: &Atom| {
                let (anchor, row) = match atom.row {
                    Row::Relative(n) => (0, n),
                    Row::First(n) => (1, n),
                    Row::End(n) => (2, n),
                };
                let cells = &corpus.columns[template.tables[atom.table].1 as usize].cells;
                Site { cells, base: bases[atom.table], anchor, row: row as isize, pads: atom.pads }
            };
            Sites { plan, sites: plan.atoms.iter().map(site).collect() }
        };
        Bound { observe: sites(&template.observe), contexts: sites(&template.contexts), hashes }
    }

    /// Appends the observation features of `token`, one for each line without a label, in the template's order.
    ///
    /// # Panics
    /// When `sentence` is no sentence of the corpus, or `token` no token of `sentence`.
    #[inline]
    pub fn observe(&self, sentence: Range<usize>, token: usize, out: &mut Vec<u64>) {
        self.observe.extend(&self.hashes, sentence, token, out);
    }

    /// Appends the contexts of `token`, one for each history feature: the hash of everything in it but the labels.
    ///
    /// # Panics
    /// As [`Bound::observe`].
    #[inline]
    pub fn contexts(&self, sentence: Range<usize>, token: usize, out: &mut Vec<u64>) {
        self.contexts.extend(&self.hashes, sentence, token, out);
    }
}

impl Sites<'_> {
    /// Appends the features of `token`.
    fn extend(&self, hashes: &[u64], sentence: Range<usize>, token: usize, out: &mut Vec<u64>) {
        let start = out.len();
        let count = self.plan.lines.len();
        // What is found at the token is looked up once each, behind the features, and dropped afterwards.
        out.resize(start + count + self.sites.len(), 0);
        let (features, found) = out[start..].split_at_mut(count);
        let anchors = [token, sentence.start, sentence.end];
        for (site, found) in self.sites.iter().zip(found.iter_mut()) {
            let at = anchors[site.anchor].wrapping_add_signed(site.row);
            *found = if sentence.contains(&at) {
                hashes[site.base + site.cells[at] as usize]
            } else if site.row < 0 {
                self.plan.pads[site.pads + sentence.start.wrapping_sub(at) - 1]
            } else {
                self.plan.pads[site.pads + at - sentence.end]
            };
        }
        for (line, feature) in self.plan.lines.iter().zip(features) {
            let atoms = &self.plan.order[line.atoms.clone()];
            *feature = atoms.iter().fold(line.seed, |state, &atom| mix(state, found[atom as usize]));
        }
        out.truncate(start + count);
    }
}
