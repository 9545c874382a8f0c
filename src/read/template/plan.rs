//! Patterns compiled to tables of hashes and the order in which to mix them.
//!
//! The hash of a feature is a chain: it starts from the pattern's seed, which stands for all its text, and takes in the
//! hash of each thing found at the token, from left to right, by a multiplication to 128 bits folded to 64 (the mixing
//! step of wyhash and rapidhash). Equal seeds and equal findings give equal hashes; all else differs but for chance.

use super::Template;
use super::pattern::{Part, Row};
use super::regex::Transform;
use crate::corpus::{Column, Corpus, hash};
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
    /// The column and its cells.
    column: u32,
    cells: &'a [u32],
    /// How many distinct words the column has, and how many things can be found here: those of the words, then the pads.
    words: usize,
    size: usize,
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
                let column = template.tables[atom.table].1;
                let Column { cells, values } = &corpus.columns[column as usize];
                let (words, size) = (values.len(), values.len() + row.unsigned_abs() as usize);
                let (base, row, pads) = (bases[atom.table], row as isize, atom.pads);
                Site { column, cells, words, size, base, anchor, row, pads }
            };
            Sites { plan, sites: plan.atoms.iter().map(site).collect() }
        };
        Bound { observe: sites(&template.observe), contexts: sites(&template.contexts), hashes }
    }

    /// The same features as numbers, once each of them is looked up.
    pub fn numbered(&self) -> Numbered<'_> {
        let (observe, contexts) = (Tables::of(&self.observe), Tables::of(&self.contexts));
        Numbered { hashes: &self.hashes, observe, contexts }
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
    /// Writes what is found at `token`, for each site: the number of a word, or behind all words that of a pad.
    #[inline]
    fn find(&self, sentence: &Range<usize>, token: usize, found: &mut [u64]) {
        let anchors = [token, sentence.start, sentence.end];
        for (site, found) in self.sites.iter().zip(found) {
            let at = anchors[site.anchor].wrapping_add_signed(site.row);
            *found = if sentence.contains(&at) {
                u64::from(site.cells[at])
            } else if site.row < 0 {
                (site.words + sentence.start.wrapping_sub(at) - 1) as u64
            } else {
                (site.words + at - sentence.end) as u64
            };
        }
    }

    /// The hash of the feature that `line` makes of what was found.
    #[inline]
    fn hash(&self, hashes: &[u64], line: &Line, found: &[u64]) -> u64 {
        self.atoms(line).iter().fold(line.seed, |state, &atom| {
            let (site, found) = (&self.sites[atom as usize], found[atom as usize] as usize);
            mix(
                state,
                match found.checked_sub(site.words) {
                    None => hashes[site.base + found],
                    Some(pad) => self.plan.pads[site.pads + pad],
                },
            )
        })
    }

    fn atoms(&self, line: &Line) -> &[u32] {
        &self.plan.order[line.atoms.clone()]
    }

    /// Appends the features of `token`.
    fn extend(&self, hashes: &[u64], sentence: Range<usize>, token: usize, out: &mut Vec<u64>) {
        let start = out.len();
        let count = self.plan.lines.len();
        // What is found at the token stands behind the features, and is dropped afterwards.
        out.resize(start + count + self.sites.len(), 0);
        let (features, found) = out[start..].split_at_mut(count);
        self.find(&sentence, token, found);
        for (line, feature) in self.plan.lines.iter().zip(features) {
            *feature = self.hash(hashes, line, found);
        }
        out.truncate(start + count);
    }
}

/// The number of a feature that has none.
pub const ABSENT: u32 = u32::MAX;

/// Stands in a table for a number that was not looked up yet.
const UNREAD: u32 = u32::MAX - 1;

/// A table may have as many places as the corpus has tokens, and in any case this many.
const PLACES: usize = 1 << 17;

/// The features of a corpus as numbers in place of hashes. Where few different things can be found by a line of the template, the
/// number of each is looked up when it is met first and read from a table ever after; it must then always be the same.
#[derive(Clone, Debug)]
pub struct Numbered<'b> {
    hashes: &'b [u64],
    observe: Tables<'b>,
    contexts: Tables<'b>,
}

/// The numbers of the features of a plan.
#[derive(Clone, Debug)]
struct Tables<'b> {
    sites: &'b Sites<'b>,
    groups: Vec<Group<'b>>,
    /// For each line its group and its place there.
    lines: Vec<(usize, usize)>,
    /// The tables of all groups.
    table: Vec<u32>,
    found: Vec<u64>,
    /// The numbers of a sentence, and those of them that are not known yet.
    numbers: Vec<u32>,
    unknown: Vec<Unknown>,
    /// For each group where the numbers are that belong to what was found.
    starts: Vec<usize>,
}

/// A number that is to be looked up: where it belongs among the numbers and in the table, and what by.
#[derive(Clone, Copy, Debug)]
struct Unknown {
    at: usize,
    line: usize,
    place: usize,
    hash: u64,
}

/// The lines that look at the same cells. For each combination of what these can be, their numbers lie side by side.
#[derive(Clone, Debug)]
struct Group<'b> {
    atoms: &'b [u32],
    /// How many lines.
    lines: usize,
    /// Where its table starts; [`NOWHERE`] when there are too many combinations for one.
    start: usize,
}

/// Beyond every table.
const NOWHERE: usize = usize::MAX / 2;

impl Numbered<'_> {
    /// As [`Bound::observe`] at all tokens of `sentence`, one after the other, with each line and hash looked up by `number`.
    pub fn observe(&mut self, sentence: &Range<usize>, number: impl FnMut(usize, u64) -> u32) -> &[u32] {
        self.observe.read(self.hashes, sentence, number)
    }

    /// As [`Bound::contexts`] at all tokens of `sentence`, one after the other, with each line and hash looked up by `number`.
    pub fn contexts(&mut self, sentence: &Range<usize>, number: impl FnMut(usize, u64) -> u32) -> &[u32] {
        self.contexts.read(self.hashes, sentence, number)
    }
}

impl<'b> Tables<'b> {
    fn of(sites: &'b Sites<'b>) -> Self {
        let cells = |atoms: &[u32]| -> Vec<_> {
            let cell = |atom: &u32| &sites.sites[*atom as usize];
            atoms.iter().map(cell).map(|site| (site.column, site.anchor, site.row)).collect()
        };
        let mut groups: Vec<Group<'b>> = Vec::new();
        let mut lines = Vec::new();
        for line in &sites.plan.lines {
            let atoms = sites.atoms(line);
            let known = groups.iter().position(|group| cells(group.atoms) == cells(atoms));
            let group = known.unwrap_or_else(|| {
                groups.push(Group { atoms, lines: 0, start: NOWHERE });
                groups.len() - 1
            });
            lines.push((group, groups[group].lines));
            groups[group].lines += 1;
        }
        let most = sites.sites.iter().map(|site| site.cells.len()).max().unwrap_or(0).max(PLACES);
        let mut end = 0;
        for group in &mut groups {
            let sizes = group.atoms.iter().map(|atom| sites.sites[*atom as usize].size);
            let places = sizes.clone().try_fold(1, usize::checked_mul);
            if let Some(places) = places.filter(|places| *places <= most) {
                group.start = end;
                end += places * group.lines;
            }
        }
        let (found, starts, table) = (vec![0; sites.sites.len()], vec![0; groups.len()], vec![UNREAD; end]);
        Tables { sites, groups, lines, table, found, numbers: Vec::new(), unknown: Vec::new(), starts }
    }

    /// The numbers of all lines at all tokens of `sentence`. What no table knows is looked up at the end, one after the other: looks into
    /// a large dictionary then wait for memory together.
    fn read(&mut self, hashes: &[u64], sentence: &Range<usize>, mut number: impl FnMut(usize, u64) -> u32) -> &[u32] {
        let sites = self.sites;
        self.numbers.clear();
        self.unknown.clear();
        for token in sentence.clone() {
            sites.find(sentence, token, &mut self.found);
            for (group, start) in self.groups.iter().zip(&mut self.starts) {
                *start = group.start;
                if group.start != NOWHERE {
                    let found = group.atoms.iter().map(|atom| *atom as usize);
                    let place = found.fold(0, |place, i| place * sites.sites[i].size + self.found[i] as usize);
                    *start += place * group.lines;
                }
            }
            for (line, (group, offset)) in self.lines.iter().enumerate() {
                let place = self.starts[*group] + offset;
                let known = self.table.get(place).copied().unwrap_or(UNREAD);
                if known == UNREAD {
                    let hash = sites.hash(hashes, &sites.plan.lines[line], &self.found);
                    self.unknown.push(Unknown { at: self.numbers.len(), line, place, hash });
                }
                self.numbers.push(known);
            }
        }
        for &Unknown { at, line, place, hash } in &self.unknown {
            let number = number(line, hash);
            self.numbers[at] = number;
            if let Some(known) = self.table.get_mut(place) {
                *known = number;
            }
        }
        &self.numbers
    }
}
