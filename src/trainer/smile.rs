//! SMILe (Ross & Bagnell 2010, section 4, Algorithm 4.1).

use super::reuse::{Pool, Reuse, Slots};
use super::{Book, Keeper, Run, Trained, check_rate, check_rounds};
use crate::error::{Error, Result};
use crate::learner::{Learner, Setting};
use crate::policy::Mixture;
use crate::roll;
use crate::seed::Purpose;
use crate::space::{Problem, ViewOf};
use crate::worker::all;
use serde::{Deserialize, Serialize};

/// Stochastic Mixing Iterative Learning: round after round, a classifier that imitates the expert on the states of the current mixture takes
/// over the share `alpha` of what is still the expert's.
///
/// ```
/// use rollin::learner::Perceptron;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Run, Smile};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let smile = Smile { alpha: 0.5, rounds: 3, ..Smile::default() };
/// let trained = smile.train(&problem, &Perceptron::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.labels, 3 * 200);
/// let weights: Vec<f64> = trained.policy.members().iter().map(|(weight, _)| *weight).collect();
/// assert_eq!(weights, [4.0 / 7.0, 2.0 / 7.0, 1.0 / 7.0]); // 1/2, 1/4, 1/8 without the expert's 1/8
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Smile {
    /// The mixing rate, in (0, 1].
    pub alpha: f64,
    /// Rounds: N.
    pub rounds: usize,
    /// Whether each classifier starts from the one before.
    pub warm: bool,
    /// How trajectories of earlier rounds are reused.
    pub reuse: Reuse,
    /// T: after so many steps an episode is cut, and its pieces are what is kept or run anew; `None` where an episode is one piece. Pieces that are
    /// run anew follow each other in one run that begins where the episode does: nothing is put back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub piece: Option<usize>,
}

impl Default for Smile {
    fn default() -> Self {
        Smile { alpha: 0.2, rounds: 7, warm: false, reuse: Reuse::None, piece: None }
    }
}

impl Smile {
    /// Trains on `problem` with `learner`.
    ///
    /// # Errors
    /// When alpha is outside (0, 1], there are no rounds, a piece has no steps, the problem has no episodes, or they have no known horizons and the kind of reuse
    /// needs them.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, (Mixture<L::Classifier>, Slots<ViewOf<P>>)>>,
    ) -> Result<Trained<Mixture<L::Classifier>>> {
        check_rate("alpha", self.alpha)?;
        check_rounds(self.rounds)?;
        if self.piece == Some(0) {
            return Err(Error::argument("piece", 0, "at least 1 step"));
        }
        let mut book = Book::open(problem, run)?;
        let mut state = book.resume((Mixture::of_expert(), Slots::default()))?; // pi^0 <- pi*
        while let Some(i) = book.next(self.rounds) {
            let (policy, slots) = &mut state;
            let seed = run.seed.child(Purpose::Round, i as u64);
            // Execute pi^{i-1}.
            let round = book.bill(match self.reuse {
                Reuse::None => roll::labels(problem, policy, &all(problem), seed),
                how => Pool::new(how, self.alpha, self.piece, run.seed, slots).refresh(problem, policy, seed)?,
            });
            let warm = policy.members().last().map(|(_, classifier)| classifier).filter(|_| self.warm);
            let classifier = learner.fit(Setting::of(problem), &round.examples, warm, seed.child(Purpose::Learner, 0));
            policy.replace_expert(self.alpha, classifier); // pi^i = (1-alpha)^i pi* + alpha sum_j (1-alpha)^(j-1) pihat*^j
            book.round(self.rounds, round.cost, &state)?;
        }
        Ok(book.close(state.0.without_expert()))
    }
}
