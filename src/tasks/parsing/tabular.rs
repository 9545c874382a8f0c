//! What arc-standard can still get right: a table over the stack and what the buffer comes down to.

use super::state::{Configuration, Move, NONE, ROOT};

/// Where a word is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Place {
    /// Attached.
    #[default]
    Gone,
    Stack,
    Buffer,
    /// In the buffer, and words on the stack belong below it.
    Waiting,
}

/// A word of the sentence.
#[derive(Clone, Copy, Debug, Default)]
struct Word {
    place: Place,
    /// Whether it is the right head of a word that is not attached.
    wanted: bool,
    /// Its number in the table, or [`NONE`].
    number: u32,
}

/// The tabular dynamic oracle for arc-standard of Goldberg, Sartorio & Satta (2014), with the root counted as a word's head: the least number of words that
/// get a wrong head in any way on from a line of words without swaps. It asks where words stand in the line, not for their numbers, so that words may have been
/// swapped, if they now stand in the order in which no arcs of the right tree cross.
///
/// All ways on make a binary tree over the line, each node joining two neighbouring spans, one word of each of which has not been attached, its head. The stack
/// restrains it: what ends below the top is one word. So a span that holds the top grows by the next word down the stack, or by a span of the buffer; and of those
/// it is enough to take words one by one, once every subtree that neither needs a word of the stack nor belongs to one has been made (section 4 there).
///
/// Filling the table takes (words of the stack)·(words the buffer comes down to)·(both) steps; buffers come down to few words.
#[derive(Debug, Default)]
pub(super) struct Table {
    /// The words not attached: the stack from its bottom, then the buffer.
    line: Vec<u32>,
    /// How many of them are on the stack.
    depth: usize,
    words: Vec<Word>,
    /// The words of the table: those of the stack from its top, then those of the buffer.
    numbered: Vec<u32>,
    /// Their right heads' numbers, [`NONE`] where these are not in the table.
    heads: Vec<u32>,
    /// `old[j,h]`: the fewest wrong heads in the span of so many words of the stack and the first `j` of the buffer, when `h` is its head.
    old: Vec<u32>,
    new: Vec<u32>,
}

/// More than all words of a sentence: what cannot be.
const NEVER: u32 = u32::MAX / 2;

/// No table is filled for more words, some four million steps: what they come to is not known. Words only become fewer, so that what is known stays known.
const MOST_WORDS: usize = 256;

impl Table {
    /// Puts the words that are left after the move `a`, if any but a swap, into line. `heads` are the right ones of all words.
    pub fn read(&mut self, heads: &[u32], state: &Configuration, a: Option<Move>) {
        let depth = state.stack.len();
        self.line.clear();
        self.line.extend_from_slice(&state.stack);
        self.line.extend(state.returned.iter().rev());
        self.line.extend(state.front..state.nodes.len() as u32);
        self.depth = match a {
            None | Some(Move::Swap) => depth,
            Some(Move::Shift) => depth + 1,
            Some(Move::Right) => {
                self.line.remove(depth - 1);
                depth - 1
            }
            Some(Move::Left) => {
                self.line.remove(depth - 2);
                depth - 1
            }
        };
        self.words.clear();
        self.words.resize(heads.len(), Word::default());
        for (i, &w) in self.line.iter().enumerate() {
            self.words[w as usize].place = if i < self.depth { Place::Stack } else { Place::Buffer };
            if let Some(head) = self.words.get_mut(heads[w as usize] as usize) {
                head.wanted = true;
            }
        }
    }

    /// How many words of the line have lost their right heads: no way on gets fewer wrong.
    pub fn lost(&self, heads: &[u32]) -> u32 {
        self.line.iter().filter(|w| self.above(heads, **w) == Some(Place::Gone)).count() as u32
    }

    /// The fewest words that get wrong heads, the last one's being [`ROOT`]. `None` where there are too many.
    pub fn least(&mut self, heads: &[u32]) -> Option<u32> {
        if self.line.len() > MOST_WORDS {
            return None;
        }
        let inert = self.reduce(heads);
        let on_stack = |w: &u32| self.words[*w as usize].place == Place::Stack;
        let left = self.numbered.iter().take_while(|w| on_stack(w)).count();
        let right = self.numbered.len() - left;
        // Where nothing is on the stack the buffer comes down to the right root, if to anything.
        Some(inert + if left == 0 { 0 } else { self.fill(left, right) })
    }

    /// Where the right head of `w` is, if it has one.
    fn above(&self, heads: &[u32], w: u32) -> Option<Place> {
        self.words.get(heads[w as usize] as usize).map(|head| head.place)
    }

    /// Numbers the words that the table is about. Returns how many others get wrong heads: those whose right heads are gone, and who are no word's right
    /// head themselves. Wherever they go nothing is lost with them, and they are in nobody's way.
    fn reduce(&mut self, heads: &[u32]) -> u32 {
        for &w in &self.line[..self.depth] {
            let mut head = heads[w as usize];
            while let Some(word) = self.words.get_mut(head as usize).filter(|word| word.place == Place::Buffer) {
                word.place = Place::Waiting;
                head = heads[head as usize];
            }
        }
        self.numbered.clear();
        let mut inert = 0;
        for i in (0..self.depth).rev().chain(self.depth..self.line.len()) {
            let w = self.line[i];
            let Word { place, wanted, .. } = self.words[w as usize];
            match (place, self.above(heads, w)) {
                (Place::Buffer, Some(Place::Buffer | Place::Waiting)) => continue,
                (Place::Stack, Some(Place::Gone)) if !wanted => inert += 1,
                (Place::Buffer, Some(Place::Gone)) => inert += 1,
                _ => {
                    self.words[w as usize].number = self.numbered.len() as u32;
                    self.numbered.push(w);
                }
            }
        }
        self.heads.clear();
        let number = |head: u32| match self.words.get(head as usize) {
            // Who is gone has no number.
            Some(word) if word.place != Place::Gone => word.number,
            Some(_) => NONE,
            None => ROOT,
        };
        self.heads.extend(self.numbered.iter().map(|w| number(heads[*w as usize])));
        inert
    }

    /// Fills the table and returns the least cost of all words under one root.
    fn fill(&mut self, left: usize, right: usize) -> u32 {
        let width = left + right;
        let Table { heads, old, new, .. } = self;
        for row in [&mut *old, &mut *new] {
            row.clear();
            row.resize((right + 1) * width, NEVER);
        }
        for i in 0..left {
            new.fill(NEVER);
            if i == 0 {
                new[0] = 0;
            }
            for j in 0..=right {
                let (before, from) = new.split_at_mut(j * width);
                if i > 0 {
                    join(&old[j * width..][..width], heads, i, from);
                }
                if j > 0 {
                    join(&before[(j - 1) * width..], heads, left + j - 1, from);
                }
            }
            std::mem::swap(old, new);
        }
        let whole = old[right * width..].iter().zip(heads).map(|(cost, head)| cost + u32::from(*head != ROOT));
        whole.min().unwrap_or(0)
    }
}

/// Joins `word` to a span whose costs by head are `span`: to its head, or that to the word. The costs in `joined` are lowered to what comes of it.
fn join(span: &[u32], heads: &[u32], word: usize, joined: &mut [u32]) {
    for (cost, before) in joined.iter_mut().zip(span) {
        *cost = (*cost).min(before + 1);
    }
    let head = heads[word] as usize;
    if head < span.len() {
        joined[head] = joined[head].min(span[head]);
    }
    let below = span.iter().zip(heads).map(|(cost, head)| cost + u32::from(*head != word as u32));
    joined[word] = joined[word].min(below.min().unwrap_or(NEVER));
}
