//! Models that go on learning.

use super::{About, AnyLearner, Data, Learned, Model, Task};
use crate::error::{Error, Result};
use crate::trainer::{Dagger, Run, Trained};

impl<T: Task> Model<T> {
    /// The model after more training, on other `data` alone, by DAgger online with the learner that trained it: it starts from the weights, and features that
    /// it has not seen before come in beside the others. It is not calibrated any more.
    ///
    /// A model keeps what it decides by and no more, so that AdaGrad's sums and the like begin anew: steps are as large as at the first
    /// training's beginning, and what it knew gives way faster than it came. Give it some of the old data, too, if that is to stay.
    ///
    /// ```
    /// use rollin::prelude::*;
    ///
    /// let tagger = Tagger::train(&Corpus::parse("the D\ncat N\n\nthe D\ndog N\n")?)?;
    /// let more = Corpus::parse("a D\nbird N\n\na D\nfish N\n")?;
    /// let (tagger, trained) = tagger.update(&more, &Dagger::default(), &Run::new(1))?;
    /// assert_eq!(tagger.label(&[["a"], ["cat"]])?, ["D", "N"]);
    /// assert_eq!((tagger.about.tokens, trained.len()), (4 + 4, 5));
    /// # Ok::<(), rollin::Error>(())
    /// ```
    ///
    /// # Errors
    /// When it is not one classifier of a learner, its task does not go on ([`Task::extend`]), or `data` has actions that it does not know.
    pub fn update(
        &self,
        data: &T::Data,
        dagger: &Dagger,
        run: &Run<'_>,
    ) -> Result<(Self, Vec<crate::trainer::Progress>)> {
        let classifier = match &self.policy {
            Learned::Mixture(mixture) => match mixture.members() {
                [(_, one)] => Some(one),
                _ => None,
            },
            _ => None,
        };
        let learner: Option<AnyLearner> = serde_json::from_str(&self.about.learner).ok();
        let (Some(classifier), Some(learner)) = (classifier, learner) else {
            return Err(Error::argument("model", "not one classifier of a learner", "one, as most trainers make"));
        };
        let (encoding, problem, before) = self.encoding.extend(data)?;
        let warm = classifier.clone().map_weights(|weights| weights.renumber(&before));
        let Trained { policy, ledger, rounds, .. } = dagger.go_on_online(&problem, (&learner, Some(&warm)), run)?;
        let about = About {
            data: format!("{}, then {}", self.about.data, data.path().display()),
            sentences: self.about.sentences + data.sentences(),
            tokens: self.about.tokens + data.tokens(),
            ledger: self.about.ledger + ledger,
            ..self.about.clone()
        };
        Ok((Model::new(encoding, policy, about)?, rounds))
    }
}
