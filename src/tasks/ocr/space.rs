//! Words of handwritten letters as a space: one letter after the other, left to right.

use crate::error::{Error, Result};
use crate::read::letters::{COLUMNS, LETTERS, Letters, PIXELS, ROWS, UNKNOWN};
use crate::seed::Seed;
use crate::space::{Action, Actions, CostToGo, Episode, Expert, FeatureTable, Features, Imitation, Space};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// What a policy sees of a letter. The default is the DAgger paper's (Ross, Gordon & Bagnell 2011, section 5.3): the pixels and
/// the letter before.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sightings {
    /// The side of the largest square patch of pixels, 1 to 3. With 1 a feature is a pixel that is on; with 2 also what every patch of
    /// 2 by 2 pixels shows, where it shows anything; with 3 also of 3 by 3.
    pub patch: usize,
    /// How many of the letters before are seen: the last one, the last two together, and so on, each length a feature of its own.
    pub history: usize,
    /// Whether each length of history is also seen together with the number of letters that are still to come.
    pub rest: bool,
    /// How often a word is gone over. From the second time on, what was last said of the letters ahead is seen too, as far as the
    /// letters behind; only what is said the last time counts.
    pub passes: usize,
}

impl Default for Sightings {
    fn default() -> Self {
        Sightings { patch: 1, history: 1, rest: false, passes: 1 }
    }
}

impl Sightings {
    /// Refuses settings out of their range.
    ///
    /// # Errors
    /// When the patch is not of 1 to 3 pixels, the history is longer than [`LONGEST`], or there are no passes or more than 8.
    pub fn validate(&self) -> Result<()> {
        if !(1..=3).contains(&self.patch) {
            return Err(Error::argument("patch", self.patch, "1 to 3"));
        }
        if self.history > LONGEST {
            return Err(Error::argument("history", self.history, format!("at most {LONGEST}")));
        }
        if !(1..=8).contains(&self.passes) {
            return Err(Error::argument("passes", self.passes, "1 to 8"));
        }
        Ok(())
    }
}

/// The longest word that fits into a state.
pub const LONGEST: usize = 25;
/// Bits a letter takes in a state.
const BITS: u32 = 5;
/// What stands where no letter is: before the first and after the last.
const NONE: u32 = LETTERS as u32;
/// The feature that is always there.
const BIAS: u32 = PIXELS as u32;
/// Histories longer than one letter share this many feature numbers by hash.
const HASHED: u32 = 1 << 16;

/// The words of a collection as episodes, a letter a step; every letter is legal everywhere.
#[derive(Clone, Debug)]
pub struct Ocr {
    table: FeatureTable,
    /// Word i is letters `starts[i]..starts[i+1]`.
    starts: Vec<u32>,
    gold: Vec<u32>,
    see: Sightings,
    /// The number of the first dynamic feature: the letter before is one of 27, then come the hashed.
    dynamic: u32,
}

/// A place in a word and what was said of its letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spot {
    /// The first letter of the word.
    first: u32,
    length: u32,
    at: u32,
    pass: u32,
    /// Letter i in bits 5 i to 5 i + 4.
    said: u128,
}

impl Spot {
    /// What was last said of letter `at`, [`NONE`] outside the word.
    fn said(&self, at: i64) -> u32 {
        if (0..i64::from(self.length)).contains(&at) { (self.said >> (BITS * at as u32)) as u32 & 31 } else { NONE }
    }
}

impl Ocr {
    /// The space of these words, seen as `see` says.
    ///
    /// # Errors
    /// When a setting is out of its range or a word is longer than [`LONGEST`].
    pub fn new(letters: &Letters, see: Sightings) -> Result<Self> {
        see.validate()?;
        let mut starts = vec![0];
        for i in 0..letters.words() {
            let word = letters.word(i);
            if word.len() > LONGEST {
                return Err(Error::argument(
                    "letters",
                    format!("{} in a word", word.len()),
                    format!("at most {LONGEST}"),
                ));
            }
            starts.push(word.end as u32);
        }
        let (mut rows, mut ids) = (vec![0], Vec::new());
        for image in letters.images() {
            see_image(*image, see.patch, &mut ids);
            rows.push(ids.len());
        }
        let table = FeatureTable::from_rows(features(&see), rows, ids);
        let dynamic = fixed(&see);
        Ok(Ocr { table, starts, gold: letters.labels().to_vec(), see, dynamic })
    }

    /// The problem of imitating [`Scribe`] on all words.
    pub fn problem(self) -> Imitation<Ocr, Scribe> {
        let episodes = self.starts.len() - 1;
        Imitation { space: self, expert: Scribe, episodes }
    }

    /// The numbers of the letters of word `i`.
    pub fn word(&self, i: usize) -> Range<usize> {
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    fn gold(&self, state: &Spot) -> u32 {
        self.gold[(state.first + state.at) as usize]
    }

    /// The features of `count` letters behind `state` and, from the second pass on, of those ahead.
    fn see_letters(&self, state: &Spot, dynamic: &mut Vec<u32>) {
        let at = i64::from(state.at);
        let left = state.length - state.at;
        let again = u64::from(state.pass > 0);
        if self.see.history > 0 && again == 0 {
            dynamic.push(self.dynamic + state.said(at - 1));
        }
        let hashed = self.dynamic + NONE + 1;
        let mut add = |kind: u64, code: u64| dynamic.push(hashed + scatter(code.wrapping_add(kind << 56)));
        let (mut behind, mut ahead) = (again, again);
        // A history that reaches beyond the first letter says no more when it is longer.
        for m in 1..=(self.see.history as i64).min(at + 1) {
            behind = extend(behind, state.said(at - m));
            if m > 1 || again == 1 {
                add(1, behind);
            }
            if self.see.rest {
                add(2, extend(behind, left));
            }
        }
        if again == 0 {
            return;
        }
        add(3, u64::from(state.said(at)));
        let mut around = 0;
        for m in 1..=(self.see.history as i64).min(i64::from(left)) {
            ahead = extend(ahead, state.said(at + m));
            around = extend(extend(around, state.said(at - m)), state.said(at + m));
            add(4, ahead);
            add(5, around);
        }
    }
}

/// A number for `code` with `letter` behind it.
fn extend(code: u64, letter: u32) -> u64 {
    (code ^ u64::from(letter + 1)).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(23)
}

/// One of [`HASHED`] numbers.
fn scatter(code: u64) -> u32 {
    let code = (code ^ code >> 31).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (code >> 40) as u32 % HASHED
}

/// How many features images have.
fn fixed(see: &Sightings) -> u32 {
    BIAS + 1 + (2..=see.patch).map(patches).sum::<u32>()
}

/// How many features there are, those of the letters said before included.
pub(super) fn features(see: &Sightings) -> usize {
    (fixed(see) + NONE + 1 + HASHED) as usize
}

/// How many features patches of `side` by `side` pixels make.
fn patches(side: usize) -> u32 {
    ((ROWS + 1 - side) * (COLUMNS + 1 - side)) as u32 * (1 << (side * side))
}

/// Appends the features of `image` to `ids`.
fn see_image(image: u128, patch: usize, ids: &mut Vec<u32>) {
    ids.extend((0..PIXELS as u32).filter(|pixel| image >> pixel & 1 == 1));
    ids.push(BIAS);
    let mut base = BIAS + 1;
    for side in 2..=patch {
        for r in 0..=ROWS - side {
            for c in 0..=COLUMNS - side {
                let row = |i: usize| (image >> ((r + i) * COLUMNS + c)) as u32 & ((1 << side) - 1);
                let shown = (0..side).fold(0, |shown, i| shown << side | row(i));
                if shown > 0 {
                    ids.push(base + ((r * (COLUMNS + 1 - side) + c) << (side * side)) as u32 + shown);
                }
            }
        }
        base += patches(side);
    }
}

impl Space for Ocr {
    type State = Spot;
    type View = Features;

    fn start(&self, episode: Episode) -> Spot {
        let (first, end) = (self.starts[episode.index], self.starts[episode.index + 1]);
        Spot { first, length: end - first, at: 0, pass: 0, said: 0 }
    }

    fn legal<'a>(&'a self, state: &'a Spot) -> Actions<'a> {
        if state.at == state.length { Actions::NONE } else { Actions::All(LETTERS as u32) }
    }

    fn look(&self, state: &Spot, view: &mut Features) {
        view.row = state.first + state.at;
        view.dynamic.clear();
        self.see_letters(state, &mut view.dynamic);
    }

    fn step(&self, state: &mut Spot, action: Action, _: Seed) -> f64 {
        let last = state.pass as usize + 1 == self.see.passes;
        let wrong = last && action.0 != self.gold(state);
        let place = BITS * state.at;
        state.said = state.said & !(31 << place) | u128::from(action.0 & 31) << place;
        state.at += 1;
        if state.at == state.length && !last {
            (state.at, state.pass) = (0, state.pass + 1);
        }
        f64::from(wrong)
    }

    fn actions(&self) -> usize {
        LETTERS
    }

    fn horizon(&self, index: usize) -> Option<usize> {
        Some((self.starts[index + 1] - self.starts[index]) as usize * self.see.passes)
    }

    /// The letters that can be seen, where they fit.
    fn signature(&self, state: &Spot) -> Option<u64> {
        let seen = self.see.history as u32;
        if self.see.passes == 1 && BITS * seen < 64 {
            let behind = (1..=i64::from(seen)).map(|m| u64::from(state.said(i64::from(state.at) - m)));
            return Some(behind.fold(0, |code, letter| code << BITS | letter));
        }
        (BITS * state.length < 64).then_some(state.said as u64)
    }

    fn shared(&self) -> &FeatureTable {
        &self.table
    }
}

/// The expert who can read: says what the letter at hand is, whatever was said before, and nothing where it is not known.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scribe;

impl Expert<Ocr> for Scribe {
    fn action(&self, space: &Ocr, state: &Spot) -> Option<Action> {
        Some(space.gold(state)).filter(|letter| *letter != UNKNOWN).map(Action)
    }
}

impl CostToGo<Ocr> for Scribe {
    fn costs(&self, space: &Ocr, state: &Spot, costs: &mut Vec<f64>) {
        let gold = space.gold(state);
        let counts = state.pass as usize + 1 == space.see.passes;
        costs.clear();
        costs.extend((0..LETTERS as u32).map(|letter| f64::from(counts && letter != gold)));
    }
}
