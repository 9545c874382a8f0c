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
//! assert_eq!(Accuracy::of(&problem.space, &done.costs), Accuracy { letters: 1.0, words: 1.0 });
//! # Ok::<(), rollin::Error>(())
//! ```

mod space;

pub use space::{LONGEST, Ocr, Scribe, Sightings, Spot};

use serde::Serialize;

/// How much was read right, as shares of 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    /// Of the letters.
    pub letters: f64,
    /// Of the words: all letters right.
    pub words: f64,
}

impl Accuracy {
    /// Of a run over all words of `space` that cost this much, word by word.
    pub fn of(space: &Ocr, costs: &[f64]) -> Self {
        let right = costs.iter().filter(|cost| **cost == 0.0).count();
        Accuracy {
            letters: 1.0 - costs.iter().sum::<f64>() / space.letters() as f64,
            words: right as f64 / costs.len() as f64,
        }
    }
}
