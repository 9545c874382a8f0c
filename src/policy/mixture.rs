//! Stochastic mixtures of classifiers and the expert.

use super::{Classifier, Policy, choose_at};
use crate::error::Error;
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Front, Problem, Sight, View, ViewOf};
use crate::worker::Visit;
use serde::{Deserialize, Serialize};

/// How a mixture is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reading {
    /// One member is drawn at each step, with probability its weight: the policy that the paper analyses.
    #[default]
    Sampled,
    /// The action with the largest total weight of the members that choose it; the lowest of equals.
    Vote,
    /// The action with the highest mean score, weighted; the lowest of equals.
    Mean,
}

/// A member of a mixture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Member {
    /// The expert.
    Expert,
    /// The classifier with this number, from 0.
    Classifier(usize),
}

/// A stochastic mixture: at every step the expert acts with probability [`Mixture::expert`], classifier i with its weight. Weights
/// are not negative and sum to 1.
#[derive(Clone, Debug)]
pub struct Mixture<C> {
    expert: f64,
    members: Vec<(f64, C)>,
    reading: Reading,
}

impl<C> Mixture<C> {
    /// The mixture that is all expert: pi^0.
    pub fn of_expert() -> Self {
        Mixture { expert: 1.0, members: Vec::new(), reading: Reading::Sampled }
    }

    /// One classifier and nothing else.
    pub fn of_one(classifier: C) -> Self {
        Mixture { expert: 0.0, members: vec![(1.0, classifier)], reading: Reading::Sampled }
    }

    /// The expert with probability `expert`, in [0, 1], and `classifier` otherwise: DAgger's pi_i.
    pub(crate) fn shared(expert: f64, classifier: C) -> Self {
        Mixture { expert, members: vec![(1.0 - expert, classifier)], reading: Reading::Sampled }
    }

    /// A mixture of the expert with this weight and these classifiers with theirs.
    pub(crate) fn of_parts(expert: f64, members: Vec<(f64, C)>, reading: Reading) -> Self {
        Mixture { expert, members, reading }
    }

    /// A mixture without expert of these weights and classifiers, read as `reading`. The weights are taken as they are.
    ///
    /// # Errors
    /// When there is no member, a weight is negative or not a number, or they do not sum to 1 within 1e-9.
    pub fn of(members: Vec<(f64, C)>, reading: Reading) -> crate::Result<Self> {
        let sum: f64 = members.iter().map(|(weight, _)| weight).sum();
        if members.is_empty() || members.iter().any(|(weight, _)| weight.is_nan() || *weight < 0.0) {
            return Err(Error::argument("weights", members.len(), "at least one, none of them negative"));
        }
        if (sum - 1.0).abs() > 1e-9 {
            return Err(Error::argument("weights", format!("{sum} in sum"), "1 in sum"));
        }
        Ok(Mixture { expert: 0.0, members, reading })
    }

    /// The expert's weight: p_n.
    pub fn expert(&self) -> f64 {
        self.expert
    }

    /// The classifiers and their weights, the oldest first.
    pub fn members(&self) -> &[(f64, C)] {
        &self.members
    }

    /// How the mixture is read.
    pub fn reading(&self) -> Reading {
        self.reading
    }

    /// The same mixture, read as `reading`.
    pub fn read_as(mut self, reading: Reading) -> Self {
        self.reading = reading;
        self
    }

    /// SMILe's update: `classifier` takes the share `alpha` of what is still the *expert's*; all others keep their weights. After n
    /// calls classifier i has alpha (1-alpha)^(i-1) and the expert (1-alpha)^n (Algorithm 4.1).
    pub fn replace_expert(&mut self, alpha: f64, classifier: C) {
        self.members.push((alpha * self.expert, classifier));
        self.expert *= 1.0 - alpha;
    }

    /// SEARN's and CPI's update: `classifier` takes the share `beta` of *everything*. After n calls classifier i has
    /// beta (1-beta)^(n-i) and the expert (1-beta)^n.
    pub fn blend(&mut self, beta: f64, classifier: C) {
        self.expert *= 1.0 - beta;
        for (weight, _) in &mut self.members {
            *weight *= 1.0 - beta;
        }
        self.members.push((beta, classifier));
    }

    /// The mixture without the expert, renormalised: pi-tilde^n. All expert stays all expert, having nobody else.
    pub fn without_expert(mut self) -> Self {
        let rest: f64 = self.members.iter().map(|(weight, _)| weight).sum();
        if rest > 0.0 {
            self.expert = 0.0;
            for (weight, _) in &mut self.members {
                *weight /= rest;
            }
        }
        self
    }

    /// The member that `unit`, a number in [0, 1), falls to: the classifiers first, the oldest of them first, each as long as its weight;
    /// then the expert. So when SMILe's n-th classifier takes over a part of the expert's share, the draws that change their member
    /// are those that fall into that part.
    pub fn draw(&self, unit: f64) -> Member {
        self.draw_first(self.members.len(), unit)
    }

    /// The same for the mixture of SMILe's first `count` classifiers, whose expert still had what the later ones took from it.
    pub(crate) fn draw_first(&self, count: usize, unit: f64) -> Member {
        let rest = if count == self.members.len() { self.expert } else { 1.0 };
        self.walk(count, unit).unwrap_or_else(|last| match last {
            Some(last) if rest == 0.0 => Member::Classifier(last),
            _ => Member::Expert,
        })
    }

    /// The member that `unit` falls to when the first `count` classifiers share it in proportion to their weights, without the expert.
    pub(crate) fn draw_taught(&self, count: usize, unit: f64) -> Member {
        let sum: f64 = self.members[..count].iter().map(|(weight, _)| weight).sum();
        self.walk(count, unit * sum).unwrap_or_else(|last| last.map_or(Member::Expert, Member::Classifier))
    }

    /// The classifier among the first `count` that `unit` falls to, or, where it falls beyond them, the last one that has weight.
    fn walk(&self, count: usize, unit: f64) -> Result<Member, Option<usize>> {
        let (mut below, mut last) = (0.0, None);
        for (i, (weight, _)) in self.members[..count].iter().enumerate() {
            if *weight > 0.0 {
                below += weight;
                last = Some(i);
                if unit < below {
                    return Ok(Member::Classifier(i));
                }
            }
        }
        Err(last)
    }

    /// The same mixture with every classifier replaced by what `change` makes of it.
    pub fn map<D>(self, mut change: impl FnMut(C) -> D) -> Mixture<D> {
        let members = self.members.into_iter().map(|(weight, classifier)| (weight, change(classifier))).collect();
        Mixture { expert: self.expert, members, reading: self.reading }
    }
}

impl<C> Mixture<C> {
    /// The member that acts at the step of this seed.
    fn drawn<M>(&self, seed: Seed, memory: &mut MixtureMemory<M>) -> Member {
        if self.members.len() == 1 && self.expert == 0.0 {
            return self.draw(0.0);
        }
        let place = &mut memory.units[seed.number() as usize % UNITS];
        self.draw(match place {
            Some((known, unit)) if *known == seed => *unit,
            _ => place.insert((seed, seed.child(Purpose::Member, 0).unit())).1,
        })
    }

    /// What `member` does at `visit`.
    pub(crate) fn act_as<P: Problem>(
        &self,
        member: Member,
        visit: &mut Visit<'_, P>,
        memory: &mut MixtureMemory<C::Memory>,
    ) -> Action
    where
        C: Classifier<ViewOf<P>>,
    {
        memory.members.resize_with(self.members.len(), Default::default);
        match member {
            Member::Expert => visit.expert(),
            Member::Classifier(i) => choose_at(&self.members[i].1, visit, &mut memory.members[i]),
        }
    }

    /// What all members together say, where they are not drawn from: by their votes, or by their mean score.
    pub(crate) fn decide<V: View>(&self, sight: &Sight<'_, V>, memory: &mut MixtureMemory<C::Memory>) -> Action
    where
        C: Classifier<V>,
    {
        memory.members.resize_with(self.members.len(), Default::default);
        memory.sums.clear();
        match self.reading {
            Reading::Sampled | Reading::Vote => {
                for ((weight, classifier), scratch) in self.members.iter().zip(&mut memory.members) {
                    let choice = classifier.choose(sight, scratch).index();
                    memory.sums.resize(memory.sums.len().max(choice + 1), 0.0);
                    memory.sums[choice] += *weight as f32;
                }
                let most = sight.legal.iter().last().map_or(0, |action| action.index() + 1);
                memory.sums.resize(memory.sums.len().max(most), 0.0);
                sight.legal.best(&memory.sums)
            }
            Reading::Mean => {
                for ((weight, classifier), scratch) in self.members.iter().zip(&mut memory.members) {
                    let scores = classifier.scores(sight, scratch);
                    memory.sums.resize(scores.len(), 0.0);
                    for (sum, score) in memory.sums.iter_mut().zip(scores) {
                        *sum += *weight as f32 * score;
                    }
                }
                sight.legal.best(&memory.sums)
            }
        }
    }
}

/// A thread's scratch for a mixture.
#[derive(Default)]
pub struct MixtureMemory<M> {
    members: Vec<M>,
    sums: Vec<f32>,
    /// What members are drawn by, at steps not long ago: roll-outs that are compared come to them one after the other, and so do those from the next states.
    units: [Option<(Seed, f64)>; UNITS],
}

/// How many steps' numbers a thread remembers.
const UNITS: usize = 32;

impl<P: Problem, C: Classifier<ViewOf<P>>> Policy<P> for Mixture<C> {
    type Memory = MixtureMemory<C::Memory>;

    fn is_expert(&self) -> bool {
        self.members.is_empty()
    }

    fn act(&self, visit: &mut Visit<'_, P>, memory: &mut Self::Memory) -> Action {
        match self.reading {
            Reading::Sampled => {
                let member = self.drawn(visit.seed(), memory);
                self.act_as(member, visit, memory)
            }
            Reading::Vote | Reading::Mean => self.decide(&visit.sight(), memory),
        }
    }

    fn leaves_to_expert(&self, step: Seed, memory: &mut Self::Memory) -> bool {
        self.members.is_empty() || self.reading == Reading::Sampled && self.drawn(step, memory) == Member::Expert
    }

    fn act_at_once(&self, front: &Front<'_, ViewOf<P>>, memory: &mut Self::Memory, actions: &mut [Option<Action>]) {
        if self.reading == Reading::Sampled
            && let Member::Classifier(i) = self.drawn(front.seed, memory)
        {
            memory.members.resize_with(self.members.len(), Default::default);
            self.members[i].1.choose_all_at_once(front, &mut memory.members[i], actions);
        }
    }
}
