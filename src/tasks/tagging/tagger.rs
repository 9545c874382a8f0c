//! Taggers, as a program uses them.

use super::encoding::Encoding;
use super::space::Tagging;
use super::task::{Settings, columns};
use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::seed::Seed;
use crate::tasks::{Model, Recipe};

/// A trained tagger: what turns words into features, and the policy.
pub type Tagger = Model<Encoding>;

impl Tagger {
    /// The tagger that `rollin train` makes of `corpus`, whose last column has the labels, where nothing else is asked for: trained by DAgger online with
    /// logistic regression. A [`Recipe`] asks for something else.
    ///
    /// ```
    /// use rollin::prelude::*;
    ///
    /// let corpus = Corpus::parse("the DT\ncat NN\n\nthe DT\ndog NN\n")?;
    /// let tagger = Tagger::train(&corpus)?;
    /// assert_eq!(tagger.label(&[["the"], ["dog"]])?, ["DT", "NN"]);
    /// # Ok::<(), rollin::Error>(())
    /// ```
    ///
    /// # Errors
    /// When `corpus` has no sentence or no column beside the labels.
    pub fn train(corpus: &Corpus) -> Result<Tagger> {
        Recipe::default().train(corpus, Settings::default())
    }

    /// The labels of one sentence, given as the columns of each token; the labels' own column may be missing where it is the last.
    /// Of a mixture that is sampled, always the same members are drawn.
    ///
    /// # Errors
    /// When tokens differ in their number of columns, or lack one that the template needs.
    pub fn label<'t>(&self, tokens: &[impl AsRef<[&'t str]>]) -> Result<Vec<&str>> {
        let mut corpus = Corpus::new("<sentence>", tokens.first().map_or(0, |token| token.as_ref().len()));
        for (i, token) in tokens.iter().map(AsRef::as_ref).enumerate() {
            if token.len() != corpus.columns.len() {
                let expected = format!("{} as the first token has", columns(corpus.columns.len()));
                return Err(Error::data(corpus.place(i, 0), columns(token.len()), expected));
            }
            corpus.push(token, i + 1);
        }
        corpus.end_sentence();
        if tokens.is_empty() {
            return Ok(Vec::new());
        }
        self.encoding.check_columns(&corpus)?;
        let labels = self.tag(&corpus, Seed::new(1))?;
        Ok(labels.into_iter().map(|label| self.encoding.labels[label as usize].as_str()).collect())
    }

    /// The labels of all tokens of `corpus`, as numbers into [`Encoding::labels`]. Only a mixture that is sampled draws from `seed`.
    ///
    /// # Errors
    /// When `corpus` lacks a column that the template needs.
    pub fn tag(&self, corpus: &Corpus, seed: Seed) -> Result<Vec<u32>> {
        self.tag_from(corpus, 0, seed)
    }

    /// The same for a part of a longer text: its first sentence has the number `first`, from 0. What is drawn is what would be drawn if
    /// the whole text were tagged at once.
    ///
    /// # Errors
    /// When `corpus` lacks a column that the template needs.
    pub fn tag_from(&self, corpus: &Corpus, first: usize, seed: Seed) -> Result<Vec<u32>> {
        Ok(self.tag_encoded(self.encoding.apply(corpus)?, first, seed))
    }

    /// The labels of all tokens of sentences that are encoded already, the first of which has the number `first`.
    pub fn tag_encoded(&self, space: Tagging, first: usize, seed: Seed) -> Vec<u32> {
        let sentences = space.sentences();
        self.perform(space, sentences, first, seed).into_iter().map(|action| action.0).collect()
    }
}
