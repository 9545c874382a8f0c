//! Randomness that is keyed, never shared.
//!
//! A [`Seed`] is a node of a tree that is never stored: [`Seed::child`] names a branch by what it is for and by a number.
//! A draw is keyed by its purpose (this round, this episode, this step), never by who draws it or when, so the
//! same seed gives the same bits at any number of threads, and alternatives that are compared can share their randomness.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

/// What a branch of the seed tree is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Purpose {
    /// A trainer's round.
    Round = 1,
    /// An episode within a round.
    Episode = 2,
    /// A step within an episode: what the space does.
    Step = 3,
    /// Which member of a mixture acts at a step.
    Member = 4,
    /// A learner's own randomness: the order of its examples.
    Learner = 5,
    /// One roll-out.
    RollOut = 6,
    /// Sentences drawn from a grammar.
    Sentence = 7,
    /// The evaluation of a finished policy.
    Evaluation = 8,
    /// Which action a deviation tries, where it does not try them all.
    Deviation = 9,
    /// An expert's own randomness at a step.
    Expert = 10,
    /// Which of several readings of a sentence.
    Reading = 11,
}

/// A small copyable node of the seed tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Seed(u64);

impl Seed {
    /// The root that belongs to `number`.
    pub fn new(number: u64) -> Self {
        Seed(mix(number ^ 0x243f_6a88_85a3_08d3))
    }

    /// The branch for `purpose` with this `index`. Same node, purpose and index: same branch.
    #[inline]
    pub fn child(self, purpose: Purpose, index: u64) -> Self {
        Seed(mix(mix(self.0 ^ (purpose as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)) ^ index))
    }

    /// A number in [0, 1) that belongs to this node, one of 2^53 equally spaced values.
    #[inline]
    pub fn unit(self) -> f64 {
        (mix(self.0 ^ 0x1319_8a2e_0370_7344) >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// The number that tells this node apart from all others.
    pub(crate) fn number(self) -> u64 {
        self.0
    }

    /// The node with this number.
    pub(crate) fn of_number(number: u64) -> Self {
        Seed(number)
    }

    /// A generator that starts from this node, for longer streams: ChaCha8, portable and fixed for all time.
    pub fn rng(self) -> ChaCha8Rng {
        ChaCha8Rng::seed_from_u64(self.0)
    }
}

/// A bijection of 64 bits in which every input bit moves every output bit (the finaliser of SplitMix64, Steele,
/// Lea & Flood 2014).
#[inline]
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_uniform() {
        // 64 equal cells, 64,000 draws keyed by consecutive indices: chi-square with 63 degrees of freedom exceeds
        // 140 with probability below 1e-7; the draws are fixed, so the test either always passes or never does.
        let mut cells = [0f64; 64];
        for index in 0..64_000 {
            cells[(Seed::new(7).child(Purpose::Step, index).unit() * 64.0) as usize] += 1.0;
        }
        let chi: f64 = cells.iter().map(|n| (n - 1000.0).powi(2) / 1000.0).sum();
        assert!(chi < 140.0, "chi-square {chi}");
    }

    #[test]
    fn branches_differ() {
        let root = Seed::new(1);
        assert_ne!(root.child(Purpose::Step, 1), root.child(Purpose::Step, 2));
        assert_ne!(root.child(Purpose::Step, 1), root.child(Purpose::Round, 1));
        assert_eq!(root.child(Purpose::Step, 1), root.child(Purpose::Step, 1));
        assert_ne!(Seed::new(1), Seed::new(2));
    }
}
