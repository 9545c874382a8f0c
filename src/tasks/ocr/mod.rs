//! Reading handwritten words: one letter after the other, left to right, each image of 16 by 8 pixels.
//!
//! This is the task on which SEARN, SMILe and DAgger were compared (Ross, Gordon & Bagnell 2011, section 5.3), on the words
//! collected by Kassel and cut into letters by Taskar: 6,877 words in ten folds. [`crate::read::letters`] reads them.
//!
//! ```
//! use rollin::learner::Perceptron;
//! use rollin::read::letters::Letters;
//! use rollin::roll::perform;
//! use rollin::tasks::ocr::{Accuracy, Ocr, Sightings};
//! use rollin::trainer::{Dagger, Run};
//! use rollin::Seed;
//!
//! // Two words of two letters, `ab` and `ba`: an a is a bar, a b a dot.
//! let (bar, dot) = (0b1111 << 64, 1 << 64);
//! let mut letters = Letters::default();
//! for word in [[(0, bar), (1, dot)], [(1, dot), (0, bar)]] {
//!     letters.begin(0);
//!     word.into_iter().for_each(|(letter, image)| letters.push(letter, image));
//! }
//! let problem = Ocr::new(&letters, Sightings::default())?.problem();
//! let trained = Dagger::default().train(&problem, &Perceptron::default(), &Run::new(1))?;
//! let (done, _) = perform(&problem, &trained.policy, Seed::new(2));
//! assert_eq!(Accuracy::of(&problem.space, &done.costs).of_words(), 1.0);
//! # Ok::<(), rollin::Error>(())
//! ```

mod space;
mod task;

pub use space::{LONGEST, Ocr, Scribe, Sightings, Spot};
pub use task::{Page, Reader};

use serde::Serialize;

/// How much was read right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Accuracy {
    /// How many letters were read.
    pub letters: u64,
    /// How many of them right.
    pub right_letters: u64,
    /// How many words were read.
    pub words: u64,
    /// How many of them right: all letters.
    pub right_words: u64,
}

impl Accuracy {
    /// Of a run over all words of `space` that cost this much, word by word.
    pub fn of(space: &Ocr, costs: &[f64]) -> Self {
        let mut accuracy = Accuracy::default();
        for (i, cost) in costs.iter().enumerate() {
            accuracy.add(space.word(i).len() as u64, *cost as u64);
        }
        accuracy
    }

    /// Counts a word of `letters` letters, `wrong` of which were read wrong.
    pub fn add(&mut self, letters: u64, wrong: u64) {
        self.letters += letters;
        self.right_letters += letters.saturating_sub(wrong);
        self.words += 1;
        self.right_words += u64::from(wrong == 0);
    }

    /// The share of letters that were read right.
    pub fn of_letters(&self) -> f64 {
        self.right_letters as f64 / self.letters as f64
    }

    /// The share of words that were read right.
    pub fn of_words(&self) -> f64 {
        self.right_words as f64 / self.words as f64
    }
}
