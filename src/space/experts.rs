//! Experts that are less than perfect, made of one that is: wrong now and then ([`Noisy`]), wrong always in the same places
//! ([`Suboptimal`]), silent at some states ([`Partly`]); a function ([`By`]), and a [`Person`] who is asked.
//!
//! An expert's chance is keyed like all others: [`Expert::answer`] is given the node of the step at hand, so the same seed
//! brings the same answers at any number of threads, and roll-outs that share their randomness share the expert's mistakes, too. Which of them it is to be
//! can also be chosen at run time ([`Flaw`]).
//!
//! ```
//! use rollin::learner::Perceptron;
//! use rollin::space::{Imitation, doc::{Follow, RealWorld}, experts::Noisy};
//! use rollin::trainer::{Dagger, Run};
//!
//! let problem = Imitation { space: RealWorld, expert: Noisy::new(Follow, 0.1)?, episodes: 20 };
//! let trained = Dagger::default().train(&problem, &Perceptron::default(), &Run::new(1))?;
//! assert_eq!(trained.ledger.labels, 5 * 200); // a wrong answer costs as much as a right one
//! # Ok::<(), rollin::Error>(())
//! ```

use super::{Action, CostToGo, Episode, Expert, Problem, Space};
use crate::error::{Error, Result};
use crate::seed::{Purpose, Seed};
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Write};
use std::sync::{Mutex, PoisonError};

/// Refuses what is no probability.
fn check_chance(name: &'static str, chance: f64) -> Result<f64> {
    if (0.0..=1.0).contains(&chance) { Ok(chance) } else { Err(Error::argument(name, chance, "from 0 to 1")) }
}

/// A legal action other than `right`, each with the same chance; `right` where there is no other.
fn other<S: Space>(space: &S, state: &S::State, right: Action, seed: Seed) -> Action {
    let legal = space.legal(state);
    let Some(place) = legal.place(right).filter(|_| legal.len() > 1) else { return right };
    let drawn = (seed.unit() * (legal.len() - 1) as f64) as usize;
    legal.nth(if drawn < place { drawn } else { drawn + 1 })
}

/// A plain function as an expert: what it says is best, or nothing.
///
/// ```
/// use rollin::prelude::*;
/// use rollin::space::{doc::{Follow, Moment, RealWorld}, experts::By};
///
/// let expert = By(|world: &RealWorld, moment: &Moment| Follow.action(world, moment));
/// let problem = Imitation { space: RealWorld, expert, episodes: 20 };
/// assert_eq!(Smile::default().train(&problem, &Perceptron::default(), &Run::new(1))?.ledger.labels, 7 * 200);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct By<F>(pub F);

impl<S: Space, F: Fn(&S, &S::State) -> Option<Action> + Sync> Expert<S> for By<F> {
    fn action(&self, space: &S, state: &S::State) -> Option<Action> {
        (self.0)(space, state)
    }
}

/// An expert whose answer is wrong with probability `wrong`, and then any other legal action. It errs anew at every visit: asked again
/// about the same state in another round, it may say something else.
#[derive(Clone, Copy, Debug)]
pub struct Noisy<E> {
    expert: E,
    wrong: f64,
}

impl<E> Noisy<E> {
    /// `expert`, wrong with probability `wrong`.
    ///
    /// # Errors
    /// When `wrong` is outside [0, 1].
    pub fn new(expert: E, wrong: f64) -> Result<Self> {
        Ok(Noisy { expert, wrong: check_chance("wrong", wrong)? })
    }
}

impl<S: Space, E: Expert<S>> Expert<S> for Noisy<E> {
    /// What it would say if it did not err.
    fn action(&self, space: &S, state: &S::State) -> Option<Action> {
        self.expert.action(space, state)
    }

    fn answer(&self, space: &S, state: &S::State, seed: Seed) -> Option<Action> {
        let right = self.expert.answer(space, state, seed)?;
        let errs = seed.child(Purpose::Expert, 1).unit() < self.wrong;
        Some(if errs { other(space, state, right, seed.child(Purpose::Expert, 2)) } else { right })
    }
}

/// An expert with fixed bad habits: where a state's [signature](Space::signature) falls into a share `bad` of all, it always takes the same
/// other legal action. What it gets wrong can be learned from it, and only a trainer that looks at costs can do better. States
/// without signatures it takes for good ones.
#[derive(Clone, Copy, Debug)]
pub struct Suboptimal<E> {
    expert: E,
    bad: f64,
    habits: Seed,
}

impl<E> Suboptimal<E> {
    /// `expert`, with bad habits in a share `bad` of the signatures, which ones and what it does there hanging below `habits`.
    ///
    /// # Errors
    /// When `bad` is outside [0, 1].
    pub fn new(expert: E, bad: f64, habits: Seed) -> Result<Self> {
        Ok(Suboptimal { expert, bad: check_chance("bad", bad)?, habits })
    }

    fn bend<S: Space>(&self, space: &S, state: &S::State, right: Action) -> Action {
        let Some(signature) = space.signature(state) else { return right };
        let habit = self.habits.child(Purpose::Expert, signature);
        if habit.unit() < self.bad { other(space, state, right, habit.child(Purpose::Expert, 0)) } else { right }
    }
}

impl<S: Space, E: Expert<S>> Expert<S> for Suboptimal<E> {
    fn action(&self, space: &S, state: &S::State) -> Option<Action> {
        Some(self.bend(space, state, self.expert.action(space, state)?))
    }

    fn answer(&self, space: &S, state: &S::State, seed: Seed) -> Option<Action> {
        Some(self.bend(space, state, self.expert.answer(space, state, seed)?))
    }
}

/// An expert who has nothing to say with probability `silent`, drawn anew at every visit. Where it is to drive and is silent, the lowest
/// legal action is taken ([`Visit::expert`](crate::worker::Visit::expert)).
#[derive(Clone, Copy, Debug)]
pub struct Partly<E> {
    expert: E,
    silent: f64,
}

impl<E> Partly<E> {
    /// `expert`, silent with probability `silent`.
    ///
    /// # Errors
    /// When `silent` is outside [0, 1].
    pub fn new(expert: E, silent: f64) -> Result<Self> {
        Ok(Partly { expert, silent: check_chance("silent", silent)? })
    }
}

impl<S: Space, E: Expert<S>> Expert<S> for Partly<E> {
    /// What it would say if it spoke.
    fn action(&self, space: &S, state: &S::State) -> Option<Action> {
        self.expert.action(space, state)
    }

    fn answer(&self, space: &S, state: &S::State, seed: Seed) -> Option<Action> {
        if seed.child(Purpose::Expert, 3).unit() < self.silent {
            return None;
        }
        self.expert.answer(space, state, seed)
    }
}

impl<S: Space, E: CostToGo<S>> CostToGo<S> for Partly<E> {
    /// The costs of the one it is made of: those of an expert who never falls silent.
    fn costs(&self, space: &S, state: &S::State, costs: &mut Vec<f64>) {
        self.expert.costs(space, state, costs);
    }
}

/// How an expert falls short: by what is chosen at run time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Flaw {
    /// Not at all.
    #[default]
    None,
    /// As [`Noisy`], with this probability of an error.
    Noisy(f64),
    /// As [`Suboptimal`], with bad habits in this share of the signatures.
    Suboptimal(f64),
    /// As [`Partly`], with this probability of silence.
    Silent(f64),
}

impl Flaw {
    /// Reads `none`, `noisy:P`, `suboptimal:P` or `silent:P`.
    ///
    /// # Errors
    /// When it is none of these, or P is outside [0, 1].
    pub fn parse(text: &str) -> Result<Self> {
        let unknown = || Error::argument("expert", text, "none, noisy:P, suboptimal:P or silent:P");
        let chance = |p: &str| check_chance("expert", p.parse().map_err(|_| unknown())?);
        match text.split_once(':') {
            None if text == "none" => Ok(Flaw::None),
            Some(("noisy", p)) => Ok(Flaw::Noisy(chance(p)?)),
            Some(("suboptimal", p)) => Ok(Flaw::Suboptimal(chance(p)?)),
            Some(("silent", p)) => Ok(Flaw::Silent(chance(p)?)),
            _ => Err(unknown()),
        }
    }

    /// `problem` with an expert who has this flaw; bad habits hang below `habits`.
    ///
    /// # Errors
    /// When a probability is outside [0, 1], or bad habits are asked for though no episode starts in a state with a signature to tell it by.
    pub fn of<P: Problem>(self, problem: &P, habits: Seed) -> Result<Advised<'_, P, Flawed<P::Expert>>>
    where
        P::Expert: Clone,
    {
        let perfect = problem.expert().clone();
        let expert = match self {
            Flaw::None => Flawed::None(perfect),
            Flaw::Noisy(wrong) => Flawed::Noisy(Noisy::new(perfect, wrong)?),
            Flaw::Silent(silent) => Flawed::Silent(Partly::new(perfect, silent)?),
            Flaw::Suboptimal(bad) => {
                let start = |index| problem.space().start(Episode { index, seed: habits });
                if (0..problem.episodes()).all(|index| problem.space().signature(&start(index)).is_none()) {
                    return Err(Error::argument(
                        "expert",
                        "suboptimal",
                        "another one: the states of this task have no signatures, by which bad ones are known again",
                    ));
                }
                Flawed::Suboptimal(Suboptimal::new(perfect, bad, habits)?)
            }
        };
        Ok(Advised { problem, expert })
    }
}

/// A problem with another expert.
#[derive(Clone, Copy, Debug)]
pub struct Advised<'a, P, E> {
    /// The problem.
    pub problem: &'a P,
    /// Its expert from now on.
    pub expert: E,
}

impl<P: Problem, E: Expert<P::Space>> Problem for Advised<'_, P, E> {
    type Space = P::Space;
    type Expert = E;
    fn space(&self) -> &P::Space {
        self.problem.space()
    }
    fn expert(&self) -> &E {
        &self.expert
    }
    fn episodes(&self) -> usize {
        self.problem.episodes()
    }
}

/// An expert with a [`Flaw`].
#[derive(Clone, Copy, Debug)]
pub enum Flawed<E> {
    /// One without.
    None(E),
    /// One who errs now and then.
    Noisy(Noisy<E>),
    /// One with bad habits.
    Suboptimal(Suboptimal<E>),
    /// One who is silent now and then.
    Silent(Partly<E>),
}

impl<S: Space, E: Expert<S>> Expert<S> for Flawed<E> {
    #[inline]
    fn action(&self, space: &S, state: &S::State) -> Option<Action> {
        match self {
            Flawed::None(expert) => expert.action(space, state),
            Flawed::Noisy(expert) => expert.action(space, state),
            Flawed::Suboptimal(expert) => expert.action(space, state),
            Flawed::Silent(expert) => expert.action(space, state),
        }
    }

    #[inline]
    fn answer(&self, space: &S, state: &S::State, seed: Seed) -> Option<Action> {
        match self {
            Flawed::None(expert) => expert.answer(space, state, seed),
            Flawed::Noisy(expert) => expert.answer(space, state, seed),
            Flawed::Suboptimal(expert) => expert.answer(space, state, seed),
            Flawed::Silent(expert) => expert.answer(space, state, seed),
        }
    }

    #[inline]
    fn foresee(&self, space: &S, state: &S::State, costs: &mut Vec<f64>) -> Option<u64> {
        match self {
            Flawed::None(expert) => expert.foresee(space, state, costs),
            _ => None,
        }
    }
}

impl<S: Space, E: CostToGo<S>> CostToGo<S> for Flawed<E> {
    /// Those of the expert without the flaw, who acts well ever after; so whoever asks for costs and not for answers learns nothing of errors and bad habits.
    fn costs(&self, space: &S, state: &S::State, costs: &mut Vec<f64>) {
        match self {
            Flawed::None(expert) => expert.costs(space, state, costs),
            Flawed::Noisy(Noisy { expert, .. }) => expert.costs(space, state, costs),
            Flawed::Suboptimal(Suboptimal { expert, .. }) => expert.costs(space, state, costs),
            Flawed::Silent(expert) => expert.costs(space, state, costs),
        }
    }
}

/// A person, who is shown a state with its legal actions and answers with the number of one of them. An empty line is silence,
/// and so is everything after the end of the input; what is no number of a legal action is asked again.
///
/// Questions come in the order of the episodes on one thread only.
///
/// ```
/// use rollin::space::{Episode, Expert, Space, doc::{Moment, RealWorld}, experts::Person};
///
/// let mut screen = Vec::new();
/// let person = Person::new(&b"7\n2\n"[..], &mut screen, |_: &RealWorld, moment: &Moment| format!("{moment:?}"));
/// let moment = RealWorld.start(Episode { index: 0, seed: rollin::Seed::new(1) });
/// assert_eq!(person.action(&RealWorld, &moment), Some(rollin::space::Action(2)));
/// person.finish()?;
/// assert!(String::from_utf8_lossy(&screen).contains("7 is not legal here"));
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct Person<R, W, F> {
    talk: Mutex<Talk<R, W>>,
    show: F,
}

struct Talk<R, W> {
    from: R,
    to: W,
    broken: Option<std::io::Error>,
}

impl<R: BufRead, W: Write, F> Person<R, W, F> {
    /// The person who reads `to` and writes `from`; `show` puts a state in words.
    pub fn new(from: R, to: W, show: F) -> Self {
        Person { talk: Mutex::new(Talk { from, to, broken: None }), show }
    }

    /// Ends the talk.
    ///
    /// # Errors
    /// When reading or writing failed: the person was taken for silent since.
    pub fn finish(self) -> std::io::Result<()> {
        self.talk.into_inner().unwrap_or_else(PoisonError::into_inner).broken.map_or(Ok(()), Err)
    }
}

impl<R: BufRead, W: Write> Talk<R, W> {
    /// One question, asked until it is answered.
    fn ask<S: Space>(&mut self, space: &S, state: &S::State, shown: &str) -> std::io::Result<Option<Action>> {
        let legal = space.legal(state);
        let mut names = legal.iter().map(|action| action.0.to_string()).collect::<Vec<_>>();
        if names.len() > 20 {
            names.truncate(19);
            names.push("...".to_owned());
        }
        writeln!(self.to, "{shown}")?;
        loop {
            write!(self.to, "which action ({})? ", names.join(" "))?;
            self.to.flush()?;
            let mut line = String::new();
            if self.from.read_line(&mut line)? == 0 || line.trim().is_empty() {
                return Ok(None);
            }
            match line.trim().parse().map(Action) {
                Ok(action) if legal.contains(action) => return Ok(Some(action)),
                _ => writeln!(self.to, "{} is not legal here", line.trim())?,
            }
        }
    }
}

impl<S, R, W, F> Expert<S> for Person<R, W, F>
where
    S: Space,
    R: BufRead + Send,
    W: Write + Send,
    F: Fn(&S, &S::State) -> String + Sync,
{
    fn action(&self, space: &S, state: &S::State) -> Option<Action> {
        let mut talk = self.talk.lock().unwrap_or_else(PoisonError::into_inner);
        if talk.broken.is_some() {
            return None;
        }
        let answer = talk.ask(space, state, &(self.show)(space, state));
        answer.unwrap_or_else(|error| {
            talk.broken = Some(error);
            None
        })
    }
}
