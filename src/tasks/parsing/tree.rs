//! The right trees: made projective where a system needs it, and in the order in which they have no crossing arcs.

use super::state::{NONE, ROOT};

/// A corpus's right trees. Words are numbered in their sentence, from 0; arrays lie sentence after sentence.
#[derive(Clone, Debug, Default)]
pub(super) struct Trees {
    /// The head of each word, or `ROOT`.
    pub heads: Vec<u32>,
    /// The label of each word.
    pub labels: Vec<u32>,
    /// Where each word stands when every subtree is one run of words: the inorder walk of Nivre (2009).
    pub order: Vec<u32>,
    /// Which part of the tree each word is in, of those that can be made without a swap and no larger: by the word that the others of it are below
    /// (the maximal projective components of Nivre, Kuhlmann & Hall 2009).
    pub parts: Vec<u32>,
    /// The dependents of word w are `dependents[starts[w]..starts[w+1]]`, ascending.
    starts: Vec<u32>,
    dependents: Vec<u32>,
}

impl Trees {
    /// Whether no tree is known.
    pub fn is_empty(&self) -> bool {
        self.heads.is_empty()
    }

    /// Appends a sentence.
    pub fn push(&mut self, heads: &[u32], labels: &[u32]) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        let base = self.dependents.len() as u32;
        let (starts, dependents, root) = dependents(heads);
        self.order.extend(inorder(&starts, &dependents, root));
        self.parts.extend(parts(heads, &starts));
        self.starts.extend(starts[1..].iter().map(|start| start + base));
        // The root is nobody's dependent: one number keeps the arrays of all sentences as long as their words.
        self.dependents.extend(dependents.into_iter().chain([NONE]));
        if let Some(last) = self.starts.last_mut() {
            *last += 1;
        }
        self.heads.extend_from_slice(heads);
        self.labels.extend_from_slice(labels);
    }

    /// The dependents of the corpus's word `w`, by their numbers in its sentence.
    #[inline]
    pub fn dependents(&self, w: usize) -> impl Iterator<Item = u32> + '_ {
        let own = &self.dependents[self.starts[w] as usize..self.starts[w + 1] as usize];
        own.iter().copied().filter(|dependent| *dependent != NONE)
    }
}

/// Every word's dependents, ascending, as starts and one list, and the root.
fn dependents(heads: &[u32]) -> (Vec<u32>, Vec<u32>, u32) {
    let mut starts = vec![0u32; heads.len() + 1];
    let mut root = 0;
    for (word, &head) in heads.iter().enumerate() {
        match head {
            ROOT => root = word as u32,
            head => starts[head as usize + 1] += 1,
        }
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut ends = starts.clone();
    let mut list = vec![0; starts[heads.len()] as usize];
    for (word, &head) in heads.iter().enumerate().filter(|(_, head)| **head != ROOT) {
        list[ends[head as usize] as usize] = word as u32;
        ends[head as usize] += 1;
    }
    (starts, list, root)
}

/// Where each word comes in the inorder walk: the subtrees of its left dependents, the word, those of its right ones.
fn inorder(starts: &[u32], list: &[u32], root: u32) -> Vec<u32> {
    let mut order = vec![0; starts.len() - 1];
    let mut place = 0;
    // A word with the dependents that are still to be walked; no recursion, for trees may be as deep as sentences are long.
    let mut path = vec![(root, starts[root as usize], false)];
    while let Some((word, next, placed)) = path.last_mut() {
        let dependent = (*next < starts[*word as usize + 1]).then(|| list[*next as usize]);
        match dependent {
            Some(dependent) if dependent < *word || *placed => {
                *next += 1;
                path.push((dependent, starts[dependent as usize], false));
            }
            _ if !*placed => {
                order[*word as usize] = place;
                place += 1;
                *placed = true;
            }
            _ => {
                path.pop();
            }
        }
    }
    order
}

/// The part that each word is in: what arcs between the two words on top of a stack join, when no words are swapped.
fn parts(heads: &[u32], starts: &[u32]) -> Vec<u32> {
    let mut open: Vec<u32> = starts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let (mut stack, mut above): (Vec<u32>, Vec<u32>) = (Vec::new(), (0..heads.len() as u32).collect());
    for word in 0..heads.len() as u32 {
        stack.push(word);
        while let [.., below, top] = stack[..] {
            let (head, dependent) = match (heads[below as usize] == top, heads[top as usize] == below) {
                (true, _) if open[below as usize] == 0 => (top, below),
                (_, true) if open[top as usize] == 0 => (below, top),
                _ => break,
            };
            stack.truncate(stack.len() - 2);
            stack.push(head);
            above[dependent as usize] = head;
            open[head as usize] -= 1;
        }
    }
    // Whoever was joined was joined to a word that may have been joined itself.
    let highest = |mut word: u32| {
        while above[word as usize] != word {
            let next = above[word as usize];
            // The next one who comes this way has half as far.
            above[word as usize] = above[next as usize];
            word = next;
        }
        word
    };
    (0..heads.len() as u32).map(highest).collect()
}

/// Lifts arcs until the tree is projective (Nivre & Nilsson 2005): the shortest arc that spans a word not below its head, the leftmost
/// of equals, goes to its head's head. Quadratic in the length of a sentence that needs it, linear in all others.
pub(super) fn projectivise(heads: &mut [u32]) {
    while !projective(heads) {
        let Some(word) = shortest_crossing(heads) else { return };
        heads[word] = heads[heads[word] as usize];
    }
}

/// Whether every subtree is one run of words.
pub(super) fn projective(heads: &[u32]) -> bool {
    let (starts, list, root) = dependents(heads);
    inorder(&starts, &list, root).is_sorted()
}

/// The dependent of the shortest arc that spans a word which is not below its head, where its head has one itself.
fn shortest_crossing(heads: &[u32]) -> Option<usize> {
    let below = |mut word: u32, head: u32| {
        while word != head && word != ROOT {
            word = heads[word as usize];
        }
        word == head
    };
    let span = |word: usize| {
        let head = heads[word] as usize;
        word.min(head) + 1..word.max(head)
    };
    let lifted = (0..heads.len()).filter(|word| heads[*word] != ROOT && heads[heads[*word] as usize] != ROOT);
    let crossing = |word: &usize| span(*word).any(|between| !below(between as u32, heads[*word]));
    lifted.filter(crossing).min_by_key(|word| span(*word).len())
}
