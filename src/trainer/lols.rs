//! LOLS (Chang, Krishnamurthy, Agarwal, Daumé & Langford 2015, Algorithm 1).

use super::{Aggregate, Book, Keeper, Run, Shuffled, Trained, check_chance, check_rounds};
use crate::error::Result;
use crate::learner::{Examples, Learner, Online, Setting};
use crate::policy::{Greedy, Policy};
use crate::roll::{Actor, Costing, Mixed, Round, record_costs};
use crate::seed::Purpose;
use crate::space::{Action, Episode, Gather, Problem, StateOf, ViewOf};
use crate::worker::{Memo, Worker, all, sweep};
use serde::{Deserialize, Serialize};

/// Locally optimal learning to search: roll in with what is learned, try every action at every state, and roll out with the expert (the
/// reference) with probability `beta`, with what is learned otherwise. Competes with the reference where that is good, and with
/// its own one-step deviations where it is not: both regrets are reported round by round ([`Regret`]).
///
/// [`Lols::train`] fits anew on the aggregate after each round, and begins, like [`Dagger`](super::Dagger), with a round in which the expert rolls in.
/// [`Lols::train_online`] keeps one online learner going, which learns from an episode as soon as it is over; that is the paper's
/// listing. Within an episode the learner stands still, so static scores are computed once a row and roll-outs remember what they have seen.
///
/// ```
/// use rollin::learner::Csoaa;
/// use rollin::tasks::tagging;
/// use rollin::trainer::{Lols, Run};
///
/// let problem = tagging::doc::problem()?;
/// let trained = Lols { rounds: 3, ..Lols::default() }.train_online(&problem, &Csoaa::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.resets, trained.ledger.rollouts);
/// let regret = trained.rounds[2].regret.unwrap();
/// assert!(regret.reference.unwrap() >= 0.0 && regret.deviations.unwrap() >= 0.0);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Lols {
    /// The probability that the expert rolls out, in [0, 1].
    pub beta: f64,
    /// Rounds over the episodes.
    pub rounds: usize,
    /// Whether each round's classifier starts from the one before; an online learner always does.
    pub warm: bool,
}

impl Default for Lols {
    fn default() -> Self {
        Lols { beta: 0.5, rounds: 5, warm: false }
    }
}

/// By how much an episode of the learned policy could have been cheaper, as the roll-outs of one round show it: the sums, over the states that
/// it reached, of what its action cost more than the cheapest (Chang et al. 2015, Theorem 3, with the cheapest action of each
/// state for the best policy of the class, so the second term is an upper bound on theirs). Each state shows one of the two, which counts as much as
/// its roll-outs are rare; means over the episodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Regret {
    /// When the expert acts after: the regret to an expert that is optimal, and no less than that to any other. `None` when it never rolled out.
    pub reference: Option<f64>,
    /// When the policy acts after: what one-step deviations would gain. `None` when the policy never rolled out.
    pub deviations: Option<f64>,
}

/// What a round of roll-ins brought, with the sums of what could have been saved.
struct Haul<P: Problem> {
    round: Round<P>,
    reference: f64,
    deviations: f64,
}

impl<P: Problem> Default for Haul<P> {
    fn default() -> Self {
        Haul { round: Round::default(), reference: 0.0, deviations: 0.0 }
    }
}

impl<P: Problem> Gather for Haul<P> {
    fn absorb(&mut self, later: Self) {
        self.round.absorb(later.round);
        self.reference += later.reference;
        self.deviations += later.deviations;
    }
}

/// A thread's scratch: the policy's own, the roll-outs', and costs.
type Scratch<M, S> = (M, [Memo<S>; 2], Vec<f64>, Vec<f32>);

impl Lols {
    /// Trains on `problem` with `learner`, on the aggregate of all rounds so far.
    ///
    /// # Errors
    /// When beta is outside [0, 1], there are no rounds or the problem has no episodes.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, Aggregate<ViewOf<P>, L::Classifier>>>,
    ) -> Result<Trained<Greedy<L::Classifier>>>
    where
        StateOf<P>: Clone,
    {
        self.check()?;
        let mut book = Book::open(problem, run)?;
        let mut data = book.resume(Aggregate::default())?;
        while let Some(i) = book.next(self.rounds) {
            let seed = run.seed.child(Purpose::Round, i as u64);
            let policy = data.policy(0.0);
            let haul = book.bill(sweep(problem, &all(problem), seed, |worker, scratch, episode, haul| {
                self.episode(worker, &policy, episode, scratch, haul);
            }));
            let regret = data.learned.is_some().then(|| self.regret(&haul, problem.episodes()));
            data.examples.absorb(haul.round.examples);
            let warm = data.learned.as_ref().filter(|_| self.warm);
            let seed = seed.child(Purpose::Learner, 0);
            data.learned = Some(learner.fit(Setting::of(problem), &data.examples, warm, seed));
            book.round_with(self.rounds, (haul.round.cost, regret), &data)?;
        }
        Ok(book.close(data.finish()?))
    }

    /// Trains on `problem` with an online `learner`, which learns after every episode, in a new order each round, one after the other: more
    /// threads do not help.
    ///
    /// # Errors
    /// When beta is outside [0, 1], there are no rounds or the problem has no episodes.
    pub fn train_online<P: Problem, L: Online<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, L::Course>>,
    ) -> Result<Trained<Greedy<L::Classifier>>>
    where
        StateOf<P>: Clone,
    {
        self.check()?;
        let mut book = Book::open(problem, run)?;
        let setting = Setting::of(problem);
        let mut course = book.resume(learner.begin(setting, None))?;
        let mut episodes = Shuffled::after(book.done(), problem, run.seed);
        let (mut scratch, mut examples) = (Scratch::default(), Examples::default());
        while let Some(i) = book.next(self.rounds) {
            let seed = run.seed.child(Purpose::Round, i as u64);
            let (mut worker, mut sums) = (Worker::new(problem), Haul::<P>::default());
            for index in episodes.next() {
                let episode = Episode { index, seed: seed.child(Purpose::Episode, index as u64) };
                let mut haul = Haul { round: Round { examples, cost: 0.0 }, ..Haul::default() };
                self.episode(&mut worker, &Greedy(&course), episode, &mut scratch, &mut haul);
                examples = std::mem::take(&mut haul.round.examples);
                learner.study(&mut course, setting, &examples); // pihat_{i+1} <- Train(pihat_i, Gamma)
                examples.clear();
                sums.absorb(haul);
            }
            book.bill(((), worker.ledger()));
            let regret = self.regret(&sums, problem.episodes());
            book.round_with(self.rounds, (sums.round.cost, Some(regret)), &course)?;
        }
        Ok(book.close(Greedy(learner.finish(course))))
    }

    /// Rolls in with `policy` and finds at every state what each action costs when pi^out goes on.
    fn episode<P: Problem, D: Policy<P>>(
        &self,
        worker: &mut Worker<'_, P>,
        policy: &D,
        episode: Episode,
        (memory, memo, costs, shifted): &mut Scratch<D::Memory, StateOf<P>>,
        haul: &mut Haul<P>,
    ) where
        StateOf<P>: Clone,
    {
        let out = Mixed { expert: self.beta };
        let Haul { round, reference, deviations } = haul;
        round.cost += worker.episode(episode, |visit| {
            out.costs(visit, Actor { policy, memory, memo }, episode.seed, costs);
            record_costs(visit, costs, shifted, &mut round.examples);
            let action: Action = policy.act(visit, memory);
            let over = visit.legal().place(action).map_or(0.0, |place| f64::from(shifted[place]));
            *(if out.is_experts(visit) { &mut *reference } else { &mut *deviations }) += over;
            Some(action)
        });
    }

    fn regret<P: Problem>(&self, haul: &Haul<P>, episodes: usize) -> Regret {
        let mean = |sum: f64, share: f64| (share > 0.0).then(|| sum / share / episodes as f64);
        Regret { reference: mean(haul.reference, self.beta), deviations: mean(haul.deviations, 1.0 - self.beta) }
    }

    fn check(&self) -> Result<()> {
        check_chance("beta", self.beta)?;
        check_rounds(self.rounds)
    }
}
