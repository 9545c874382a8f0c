//! Conservative policy iteration (Kakade & Langford 2002), begun from the expert as Ross & Bagnell (2010, section 4) read it.

use super::{Book, Keeper, Run, Trained, check_rate, check_rounds};
use crate::error::{Error, Result};
use crate::learner::{Learner, Setting};
use crate::policy::{Classifier, Mixture, Policy};
use crate::roll::{self, Costing, RollOut};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Problem, StateOf, ViewOf};
use crate::worker::{Ledger, Visit, all, sweep};
use serde::{Deserialize, Serialize};

/// Conservative policy iteration: in every round a classifier learns what is cheapest when the current mixture goes on, and takes
/// over a share of everything.
///
/// It is SEARN ([`Searn`](super::Searn)) but for three things:
/// - *What is sampled.* SEARN looks at every state of every roll-in; CPI draws states from the mixture's own distribution: one state an
///   episode, at a step drawn uniformly, where all actions are rolled out.
/// - *The step.* SEARN's rate is given. CPI's may be ([`Rate::Fixed`]), but its guarantee is that of a rate found from how much
///   better the classifier is than the mixture ([`Rate::Advantage`]): small enough that the mixture cannot get worse.
/// - *The end.* By that rate it ends as soon as the classifier is no better. From an expert that nobody can improve on that is at once: CPI
///   improves a policy and does not care whose it is, where SEARN moves away from the expert whatever it costs.
///
/// Like SEARN it hands over the mixture without the expert. Where it ends while the expert is all there is, the classifier of that
/// round stands in.
///
/// ```
/// use rollin::learner::Csoaa;
/// use rollin::tasks::tagging;
/// use rollin::trainer::{Cpi, Rate, Run};
///
/// let problem = tagging::doc::problem()?;
/// let cpi = Cpi { rate: Rate::Fixed(0.5), rounds: 3, ..Cpi::default() };
/// let trained = cpi.train(&problem, &Csoaa::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.examples, 3 * 4); // one for each of four sentences
/// let careful = Cpi { rate: Rate::Advantage, ..cpi };
/// assert_eq!(careful.train(&problem, &Csoaa::default(), &Run::new(1))?.rounds.len(), 1); // the labels are right: nothing to gain
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Cpi {
    /// The mixing rate.
    pub rate: Rate,
    /// Rounds at most.
    pub rounds: usize,
    /// Roll-outs per action: k.
    pub samples: usize,
    /// Whether each classifier starts from the one before.
    pub warm: bool,
}

/// How large a share a new classifier takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Rate {
    /// This, in (0, 1].
    Fixed(f64),
    /// b* = -3 A_1 / (2 (T^2-1)), at most 1, where T is the longest episode's length and A_1 by how much an episode costs more when the classifier takes one
    /// uniformly drawn step of it: the step that makes the bound b T A_1 + b^2 T(T^2-1)/3 on the change of the total cost least, for
    /// costs of a step in [0, 1] ([`safe_step`](crate::theory::bounds::safe_step)). A_1 is measured on fresh episodes, each run twice
    /// under the same randomness. Nothing is taken, and training ends, where A_1 is not below 0.
    Advantage,
}

impl Default for Cpi {
    fn default() -> Self {
        Cpi { rate: Rate::Fixed(0.3), rounds: 5, samples: 1, warm: false }
    }
}

impl Cpi {
    /// Trains on `problem` with `learner`, rolling out with the current mixture.
    ///
    /// # Errors
    /// When the rate is outside (0, 1], there are no rounds or roll-outs, or the problem has no episodes.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, (Mixture<L::Classifier>, bool)>>,
    ) -> Result<Trained<Mixture<L::Classifier>>>
    where
        StateOf<P>: Clone,
    {
        if self.samples == 0 {
            return Err(Error::argument("samples", 0, "at least 1"));
        }
        self.train_by(problem, learner, &RollOut { samples: self.samples }, run)
    }

    /// Trains with another way of finding costs. `samples` is not used.
    ///
    /// # Errors
    /// When the rate is outside (0, 1], there are no rounds, or the problem has no episodes.
    pub fn train_by<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        costing: &impl Costing<P, Mixture<L::Classifier>>,
        run: &Run<'_, impl Keeper<ViewOf<P>, (Mixture<L::Classifier>, bool)>>,
    ) -> Result<Trained<Mixture<L::Classifier>>> {
        if let Rate::Fixed(rate) = self.rate {
            check_rate("rate", rate)?;
        }
        check_rounds(self.rounds)?;
        let mut book = Book::open(problem, run)?;
        // The mixture, and whether nothing is to be gained any more.
        let mut state = book.resume((Mixture::of_expert(), false))?;
        while !state.1
            && let Some(i) = book.next(self.rounds)
        {
            let (policy, ends) = &mut state;
            let seed = run.seed.child(Purpose::Round, i as u64);
            let examples = book.bill(roll::costs_once(problem, policy, costing, seed));
            let warm = policy.members().last().map(|(_, classifier)| classifier).filter(|_| self.warm);
            let chosen = learner.fit(Setting::of(problem), &examples, warm, seed.child(Purpose::Learner, 0));
            let (step, cost) = match self.rate {
                Rate::Fixed(rate) => (rate, f64::NAN),
                Rate::Advantage => {
                    let Advantage { with, without, longest } = book.bill(advantage(problem, policy, &chosen, seed));
                    (safe_step((with - without) / problem.episodes() as f64, longest), without)
                }
            };
            *ends = step <= 0.0;
            if !*ends {
                policy.blend(step, chosen); // pi <- (1-b) pi + b pi'
            } else if policy.members().is_empty() {
                *policy = Mixture::of_one(chosen);
            }
            book.round(self.rounds, cost, &state)?;
        }
        Ok(book.close(state.0.without_expert()))
    }
}

/// b*, or 0 where nothing is gained.
fn safe_step(disadvantage: f64, longest: usize) -> f64 {
    let longest = longest as f64;
    match disadvantage < 0.0 {
        true if longest > 1.0 => (-1.5 * disadvantage / (longest * longest - 1.0)).min(1.0),
        true => 1.0,
        false => 0.0,
    }
}

/// What the episodes cost in sum.
struct Advantage {
    /// When the classifier takes one step of each, uniformly drawn.
    with: f64,
    /// When the policy takes them all.
    without: f64,
    /// The longest episode has so many steps then.
    longest: usize,
}

/// What it brings when `chosen` takes one step of each episode.
fn advantage<P: Problem, C: Classifier<ViewOf<P>>>(
    problem: &P,
    policy: &Mixture<C>,
    chosen: &C,
    seed: Seed,
) -> (Advantage, Ledger) {
    let seed = seed.child(Purpose::Evaluation, 0);
    let run = |lengths: Option<&[usize]>| {
        sweep(problem, &all(problem), seed, |worker, scratch, episode, done: &mut Vec<(f64, usize)>| {
            let (memory, own): &mut (<Mixture<C> as Policy<P>>::Memory, C::Memory) = scratch;
            let at = lengths.map(|lengths| roll::step_of(episode, lengths[episode.index]));
            let mut steps = 0;
            let cost = worker.episode(episode, |visit: &mut Visit<'_, P>| {
                steps += 1;
                let action: Action = match at == Some(visit.t()) {
                    true => chosen.choose(&visit.sight(), own),
                    false => policy.act(visit, memory),
                };
                Some(action)
            });
            done.push((cost, steps));
        })
    };
    let sum = |done: &[(f64, usize)]| done.iter().map(|(cost, _)| cost).sum::<f64>();
    let (without, bill) = run(None);
    let lengths: Vec<usize> = without.iter().map(|(_, steps)| *steps).collect();
    let (with, with_bill) = run(Some(&lengths));
    let longest = lengths.into_iter().max().unwrap_or(1);
    (Advantage { with: sum(&with), without: sum(&without), longest }, with_bill + bill)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::bounds;

    /// The step is the one whose improvement theory proves.
    #[test]
    fn the_step_is_theorys() {
        for disadvantage in [-1e-9, -0.2, -1.0, -15.9, -16.1, -100.0] {
            let (step, _) = bounds::safe_step(disadvantage, 5).expect("a gain");
            assert_eq!(safe_step(disadvantage, 5), step);
        }
        assert_eq!((safe_step(0.0, 5), safe_step(0.1, 5), safe_step(f64::NAN, 5)), (0.0, 0.0, 0.0));
    }
}
