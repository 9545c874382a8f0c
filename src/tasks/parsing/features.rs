//! What a parser sees: the features of Zhang & Nivre (2011), words, tags, labels, distances and valencies of the words on top of the
//! stack, at the front of the buffer and of their outermost dependents, alone and combined.
//!
//! A feature is a hash of numbers, cut to [`BITS`] bits; no text is touched after a corpus has been read.

use super::state::{Configuration, NONE, Node, ROOT, Side};
use crate::corpus::hash;
use crate::read::conllu::Treebank;
use crate::space::NO_ROW;

/// Bits of a feature's slot.
pub(super) const BITS: u32 = 24;

/// What is known of a word, hashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Attributes {
    /// The form in lower case.
    word: u32,
    /// Both parts of speech.
    tag: u32,
    /// The morphological features.
    morph: u32,
    /// The universal part of speech alone.
    coarse: u32,
    /// How many verbs, marks of punctuation and conjunctions come before it in its sentence, ten bits each.
    before: u32,
}

/// What is known of no word.
const ABSENT: Attributes = Attributes { word: 1, tag: 2, morph: 3, coarse: 4, before: 0 };

impl Attributes {
    /// All words of `bank`.
    pub fn of(bank: &Treebank) -> Vec<Attributes> {
        let short = |text: &str| (hash(text) >> 32) as u32;
        let mut words = Vec::with_capacity(bank.words());
        for i in 0..bank.sentences() {
            let mut before = 0u32;
            for w in bank.sentence(i) {
                let form = bank.form(w);
                let plain = form.bytes().all(|b| b.is_ascii() && !b.is_ascii_uppercase());
                let word = if plain { short(form) } else { short(&form.to_lowercase()) };
                let coarse = short(bank.upos(w));
                let tag = coarse.rotate_left(7) ^ short(bank.xpos(w));
                words.push(Attributes { word, tag, morph: short(bank.feats(w)), coarse, before });
                // Very long sentences count on from the start: only the low bits of differences are looked at.
                before = before.wrapping_add(match bank.upos(w) {
                    "VERB" => 1,
                    "PUNCT" => 1 << 10,
                    "CCONJ" => 1 << 20,
                    _ => 0,
                });
            }
        }
        words
    }
}

/// How many verbs, marks of punctuation and conjunctions stand between two words, the left one included; three stands for more.
#[inline(always)]
fn between(a: &Attributes, b: &Attributes) -> u32 {
    if *a == ABSENT || *b == ABSENT {
        return 64;
    }
    let few = |count: u32| (count & 1023).min(3);
    let difference = a.before.max(b.before).wrapping_sub(a.before.min(b.before));
    few(difference) | few(difference >> 10) << 2 | few(difference >> 20) << 4
}

/// As many features as a configuration can have, the static ones left out.
const MOST: usize = 128;

/// Slots of features found so far. A feature's template is its place in the order of finding.
pub(super) struct Found {
    slots: [u32; MOST],
    count: usize,
    /// What keeps the features of different kinds of configurations apart.
    kind: u64,
}

impl Default for Found {
    fn default() -> Self {
        Found { slots: [0; MOST], count: 0, kind: 0 }
    }
}

impl Found {
    /// The slots.
    pub fn slots(&self) -> &[u32] {
        &self.slots[..self.count]
    }

    /// Finds the feature of the next template with these values.
    #[inline(always)]
    fn put(&mut self, a: u32, b: u32, c: u32, d: u32) {
        let template = (self.count as u64 + 1 + self.kind * MOST as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let pair = |x: u32, y: u32| u64::from(x) << 32 | u64::from(y);
        // One multiplication to 128 bits, folded: every bit of the upper half depends on all four values.
        let product =
            u128::from(pair(a, b) ^ template) * u128::from(pair(c, d) ^ 0x94d0_49bb_1331_11eb ^ (template >> 7));
        let folded = (product >> 64) as u64 ^ product as u64;
        self.slots[self.count] = (folded.wrapping_mul(0xbf58_476d_1ce4_e5b9) >> (64 - BITS)) as u32;
        self.count += 1;
    }

    #[inline(always)]
    fn one(&mut self, a: u32) {
        self.put(a, 0, 0, 0);
    }

    #[inline(always)]
    fn two(&mut self, a: u32, b: u32) {
        self.put(a, b, 0, 0);
    }

    #[inline(always)]
    fn three(&mut self, a: u32, b: u32, c: u32) {
        self.put(a, b, c, 0);
    }
}

/// A distance in words, in eight classes.
fn distance(a: u32, b: u32) -> u32 {
    if a == NONE || b == NONE || a == ROOT {
        return 0;
    }
    match a.abs_diff(b) {
        near @ 0..=4 => near,
        5..=6 => 5,
        7..=10 => 6,
        _ => 7,
    }
}

/// The features of one word that its place on stack or in buffer does not change, for row 2w (w is at the front of the buffer) and
/// row 2w+1 (w is to be labelled); `words` is its sentence.
pub(super) fn fixed(words: &[Attributes], w: usize, labelled: bool, found: &mut Found) {
    let at = |k: isize| w.checked_add_signed(k).and_then(|i| words.get(i)).unwrap_or(&ABSENT);
    let (here, before, after, third) = (at(0), at(-1), at(1), at(2));
    found.kind = 1 + u64::from(labelled);
    found.count = 0;
    found.one(here.word);
    found.one(here.tag);
    found.one(here.morph);
    found.two(here.word, here.tag);
    found.one(after.word);
    found.one(after.tag);
    found.two(here.tag, after.tag);
    found.two(here.word, after.tag);
    found.two(here.tag, after.word);
    found.three(here.tag, after.tag, third.tag);
    found.two(before.tag, here.tag);
    found.three(before.tag, here.tag, after.tag);
    if labelled {
        found.one(before.word);
        found.two(here.tag, here.morph);
        found.two(before.word, here.tag);
        found.two(at(-2).tag, before.tag);
    } else {
        found.one(third.tag);
        found.one(third.word);
    }
}

/// Finds the dynamic features of `state`, and returns its static row.
#[inline]
pub(super) fn of(state: &Configuration, words: &[Attributes], found: &mut Found) -> u32 {
    let look = Look { state, words };
    if state.pending == NONE {
        look.moves(found);
        match state.buffered(0) {
            NONE => NO_ROW,
            front => 2 * (state.first + front),
        }
    } else {
        look.label(found);
        2 * (state.first + state.pending) + 1
    }
}

struct Look<'a> {
    state: &'a Configuration,
    words: &'a [Attributes],
}

/// Nothing attached.
const BARE: Node =
    Node { head: NONE, label: NONE, left: [NONE; 2], right: [NONE; 2], valency: [0; 2], labels: [0; 2], open: 0 };

/// Labels on one side, or on both, in 32 bits.
#[inline(always)]
fn set(labels: u64) -> u32 {
    (labels.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as u32
}

impl Look<'_> {
    #[inline(always)]
    fn word(&self, w: u32) -> &Attributes {
        self.words.get(w as usize).unwrap_or(&ABSENT)
    }

    #[inline(always)]
    fn node(&self, w: u32) -> &Node {
        self.state.nodes.get(w as usize).unwrap_or(&BARE)
    }

    /// The word beside `w` in the sentence.
    #[inline(always)]
    fn beside(&self, w: u32, k: i32) -> &Attributes {
        if w >= ROOT { &ABSENT } else { self.word(w.wrapping_add_signed(k)) }
    }

    /// Where the next move is to be chosen.
    fn moves(&self, found: &mut Found) {
        let state = self.state;
        let places = [state.stacked(0), state.stacked(1), state.stacked(2), state.buffered(0), state.buffered(1)];
        let [s0, s1, s2, b0, b1] = places.map(|w| self.word(w));
        let [n0, n1, _, m0, _] = places.map(|w| self.node(w));
        let b2 = self.word(state.buffered(2));
        found.kind = 3;
        found.count = 0;
        for s in [s0, s1] {
            found.one(s.word);
            found.one(s.tag);
            found.one(s.morph);
            found.two(s.word, s.tag);
        }
        found.one(s2.tag);
        found.one(s2.word);
        // Pairs.
        found.put(s0.word, s0.tag, b0.word, b0.tag);
        found.three(s0.word, s0.tag, b0.word);
        found.three(s0.word, b0.word, b0.tag);
        found.three(s0.word, s0.tag, b0.tag);
        found.three(s0.tag, b0.word, b0.tag);
        found.two(s0.word, b0.word);
        found.two(s0.tag, b0.tag);
        found.put(s1.word, s1.tag, s0.word, s0.tag);
        found.three(s1.word, s1.tag, s0.tag);
        found.three(s1.tag, s0.word, s0.tag);
        found.two(s1.word, s0.word);
        found.two(s1.tag, s0.tag);
        found.two(s1.word, b0.word);
        found.two(s1.word, b0.tag);
        found.two(s1.tag, b0.word);
        found.two(s1.tag, b0.tag);
        found.two(s0.morph, b0.morph);
        found.two(s1.morph, s0.morph);
        // Triples and more.
        found.three(s0.coarse, b0.coarse, b1.coarse);
        found.put(s0.coarse, b0.coarse, b1.coarse, b2.coarse);
        found.three(s1.coarse, s0.coarse, b0.coarse);
        found.put(s1.coarse, s0.coarse, b0.coarse, b1.coarse);
        found.three(s2.coarse, s1.coarse, s0.coarse);
        found.put(s2.coarse, s1.coarse, s0.coarse, b0.coarse);
        found.three(s1.word, s0.coarse, b0.coarse);
        found.three(s1.coarse, s0.word, b0.coarse);
        found.three(s1.coarse, s0.coarse, b0.word);
        found.three(s0.tag, b0.tag, b1.tag);
        found.three(s1.tag, s0.tag, b0.tag);
        found.three(s1.morph, s0.morph, b0.coarse);
        self.dependents(found, [n0, n1, m0], [s0.coarse, s1.coarse, b0.coarse]);
        // Distances.
        let far = distance(places[0], places[3]);
        found.two(s0.word, far);
        found.two(s0.tag, far);
        found.two(b0.word, far);
        found.two(b0.tag, far);
        found.three(s0.coarse, b0.coarse, far);
        let apart = distance(places[1], places[0]);
        found.two(s1.word, apart);
        found.two(s0.word, apart);
        found.three(s1.coarse, s0.coarse, apart);
        found.put(s1.coarse, s0.coarse, b0.coarse, far << 4 | apart);
        let (near, under) = (between(s0, b0), between(s1, s0));
        found.three(s0.coarse, b0.coarse, near);
        found.put(s0.coarse, b0.coarse, near, far);
        found.three(s1.coarse, s0.coarse, under);
        found.put(s1.coarse, s0.coarse, under, apart);
        found.put(s1.coarse, s0.coarse, b0.coarse, under);
        // Valencies, and the labels that are taken.
        for (word, node) in [(s0, n0), (s1, n1), (b0, m0)] {
            let valency = node.valency[0].min(15) << 4 | node.valency[1].min(15);
            let (left, right) = (set(node.labels[0]), set(node.labels[1]));
            found.two(word.word, valency);
            found.two(word.tag, valency);
            found.two(word.coarse, left);
            found.two(word.coarse, right);
            found.three(word.word, left, right);
        }
        let order = u32::from(places[1] < places[0]);
        found.three(s1.tag, s0.tag, order);
    }

    /// The dependents of the top two of the stack and of the front of the buffer.
    #[inline(always)]
    fn dependents(&self, found: &mut Found, [n0, n1, m0]: [&Node; 3], [s0, s1, b0]: [u32; 3]) {
        for w in [n0.left[0], n0.right[0], n1.left[0], n1.right[0], m0.left[0]] {
            let (word, label) = (self.word(w), self.node(w).label);
            found.one(word.word);
            found.one(word.tag);
            found.one(label);
        }
        for (head, w) in [(s0, n0.left[1]), (s0, n0.right[1]), (b0, m0.left[1]), (s1, n1.right[1])] {
            let (word, label) = (self.word(w), self.node(w).label);
            found.three(head, word.coarse, label);
        }
        let tag = |w: u32| self.word(w).coarse;
        found.three(s0, tag(n0.left[0]), b0);
        found.three(s0, tag(n0.right[0]), b0);
        found.three(s0, b0, tag(m0.left[0]));
        found.three(s1, tag(n1.right[0]), s0);
        found.three(s1, tag(n1.left[0]), s0);
        found.three(s1, s0, tag(n0.left[0]));
        found.three(s1, s0, tag(n0.right[0]));
        found.three(s1, tag(n1.right[0]), b0);
        found.put(s0, tag(n0.right[0]), tag(n0.right[1]), b0);
        found.put(s0, tag(n0.left[0]), tag(n0.left[1]), b0);
        found.put(s0, b0, tag(m0.left[0]), tag(m0.left[1]));
    }

    /// Where the pending dependent is to be labelled.
    fn label(&self, found: &mut Found) {
        let state = self.state;
        let w = state.pending;
        let head = state.nodes[w as usize].head;
        let (d, h, below, above) = (self.word(w), self.word(head), self.node(w), self.node(head));
        let side = Side::of(head, w);
        found.kind = 4 + side as u64;
        found.count = 0;
        found.one(d.word);
        found.one(d.tag);
        found.two(d.tag, d.morph);
        found.one(h.word);
        found.one(h.tag);
        found.two(h.tag, h.morph);
        found.put(h.word, h.tag, d.word, d.tag);
        found.two(h.word, d.word);
        found.three(h.word, h.tag, d.tag);
        found.three(h.tag, d.word, d.tag);
        found.two(h.tag, d.tag);
        found.two(h.tag, d.word);
        found.two(h.word, d.tag);
        found.put(h.tag, d.tag, d.morph, 0);
        found.put(h.tag, d.tag, h.morph, 0);
        found.put(h.tag, d.tag, h.morph, d.morph);
        let far = distance(head, w);
        found.two(d.tag, far);
        found.three(h.tag, d.tag, far);
        // Beside them in the sentence.
        for (beside, own) in
            [(self.beside(w, -1), d), (self.beside(w, 1), d), (self.beside(head, -1), h), (self.beside(head, 1), h)]
        {
            found.two(own.tag, beside.tag);
            found.three(h.tag, d.tag, beside.tag);
            found.two(own.tag, beside.word);
        }
        // Below them.
        for child in [below.left[0], below.left[1], below.right[0]] {
            let (word, node) = (self.word(child), self.node(child));
            found.two(d.tag, word.word);
            found.two(node.label, word.tag);
            found.three(h.tag, d.tag, word.word);
            found.three(h.tag, d.tag, node.label);
            found.three(h.word, d.tag, word.word);
        }
        found.three(d.tag, set(below.labels[0]), set(below.labels[1]));
        found.put(h.tag, d.tag, set(below.labels[0]), 0);
        found.put(h.tag, d.tag, set(below.labels[0]), set(below.labels[1]));
        let (left, right) = (set(above.labels[0]), set(above.labels[1]));
        found.two(d.tag, left);
        found.two(d.tag, right);
        found.put(h.tag, d.tag, left, right);
        found.put(h.word, d.tag, left, right);
        let sibling = if side == Side::Left { above.left[1] } else { above.right[1] };
        let (word, label) = (self.word(sibling), self.node(sibling).label);
        found.three(h.tag, d.tag, word.tag);
        found.two(d.tag, label);
        found.put(h.tag, d.tag, word.tag, label);
        found.three(d.word, h.word, label);
    }
}
