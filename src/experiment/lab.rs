//! Carrying out a plan.

use super::keep::{Answers, Keeping, Remembering};
use super::measure::outcomes;
use super::{Amount, Driver, Game, Goal, Interval, Length, Measured, Method, NetOf, Plan, Spread, Teaching};
use crate::error::{Error, Result};
use crate::output::write_whole;
use crate::policy::{Ladder, Mixture};
use crate::seed::{Purpose, Seed};
use crate::space::{Imitation, Marathon, Runner};
use crate::trainer::{Progress, Run};
use crate::worker::Ledger;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// What was measured after a round of a method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// The method's name.
    pub method: String,
    /// Which of its trainings, from 0.
    pub training: u64,
    /// The rounds done.
    pub round: usize,
    /// The bill so far.
    pub ledger: Ledger,
    /// What was measured, grade by grade.
    pub grades: Vec<Measured>,
}

/// What an experiment brought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// The plan.
    pub plan: Plan,
    /// What counts.
    pub goal: Goal,
    /// The names of the grades.
    pub grades: Vec<String>,
    /// All points: method by method, training by training, round by round.
    pub points: Vec<Point>,
}

impl Findings {
    /// The points of `method` after `round` rounds, one a training.
    pub fn of(&self, method: &str, round: usize) -> Vec<&Point> {
        self.points.iter().filter(|point| point.method == method && point.round == round).collect()
    }

    /// The rounds after which `method` was measured.
    pub fn rounds(&self, method: &str) -> Vec<usize> {
        let of = |point: &&Point| point.method == method && point.training == 0;
        self.points.iter().filter(of).map(|point| point.round).collect()
    }

    /// The mean of what `of` takes from each grade numbered in `grades`, all of equal weight, after `round` rounds of `method`; nothing where
    /// there is no such point.
    pub fn interval(
        &self,
        (method, round): (&str, usize),
        grades: std::ops::Range<usize>,
        of: impl Fn(&Measured) -> Spread,
    ) -> Option<Interval> {
        let spreads = |point: &&Point| point.grades.get(grades.clone()).map(|all| all.iter().map(&of).collect());
        let points: Vec<Vec<Spread>> = self.of(method, round).iter().map(spreads).collect::<Option<_>>()?;
        match &points[..] {
            [] => None,
            [one] => Some(Interval::stratified(one)),
            more => {
                let means: Vec<f64> = more.iter().map(|spreads| Interval::stratified(spreads).mean).collect();
                Some(Interval::repeated(&means))
            }
        }
    }

    /// The same of what counts, over all grades.
    pub fn main(&self, method: &str, round: usize) -> Option<Interval> {
        self.interval((method, round), 0..self.grades.len(), |measured| measured.goal(self.goal))
    }

    /// The mean bill after `round` rounds of `method` over its trainings, of what `of` takes from it.
    pub fn bill(&self, method: &str, round: usize, of: impl Fn(&Ledger) -> u64) -> f64 {
        let points = self.of(method, round);
        points.iter().map(|point| of(&point.ledger) as f64).sum::<f64>() / points.len() as f64
    }
}

/// How far an experiment has come.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// What has been done, about in proportion to time.
    pub done: u64,
    /// What is to be done in all.
    pub all: u64,
    /// What it was that was done last.
    pub what: String,
}

/// Who carries out a plan.
pub struct Lab<'a, G> {
    /// The game.
    pub game: &'a G,
    /// The plan.
    pub plan: &'a Plan,
    /// Where finished parts are kept, so that the experiment can go on after it was killed: an empty folder, one that is to be made, or that of the
    /// same plan.
    pub folder: Option<PathBuf>,
    /// Who is told of progress.
    pub watch: &'a (dyn Fn(&Tick) + Sync),
}

/// The findings, and what each method had learned at the end of its first training.
pub struct Learnt<G: Game> {
    /// The findings.
    pub findings: Findings,
    /// The methods' names and policies.
    pub drivers: Vec<(String, Driver<NetOf<G>>)>,
}

/// How much of the work a round of learning and one of measuring are.
const LEARNING: u64 = 3;

/// A training: its method, its number, its folder.
struct Trial<'a> {
    method: &'a Method,
    training: u64,
    folder: Option<PathBuf>,
}

impl<G: Game> Lab<'_, G> {
    /// Carries out the plan.
    ///
    /// # Errors
    /// When the plan cannot be followed or is another game's, or the folder is that of another plan, or cannot be read or written.
    pub fn run(&self) -> Result<Learnt<G>> {
        self.plan.validate()?;
        if self.plan.game != G::NAME {
            return Err(Error::argument("game", &self.plan.game, G::NAME));
        }
        self.open()?;
        let trials: Vec<(&Method, u64)> =
            self.plan.methods.iter().flat_map(|method| (0..self.plan.trainings).map(move |k| (method, k))).collect();
        let work = |method: &Method| {
            let rounds = method.teaching.rounds();
            let learning: u64 = (1..=rounds).map(|i| self.weight(method, i)).sum();
            learning + (method.teaching.first()..=rounds).count() as u64
        };
        let done =
            Mutex::new(Tick { done: 0, all: trials.iter().map(|(method, _)| work(method)).sum(), what: String::new() });
        let tick = |weight: u64, what: String| {
            let mut tick = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            tick.done += weight;
            tick.what = what;
            (self.watch)(&tick);
        };
        let one = |(method, training): &(&Method, u64)| {
            let folder = self.folder.as_ref().map(|folder| folder.join(format!("{}-{training}", method.name)));
            self.trial(&Trial { method, training: *training, folder }, &tick)
        };
        // One after the other: what learns is parallel in itself, and what is finished is whole.
        let trials: Vec<_> = trials.iter().map(one).collect::<Result<_>>()?;
        let mut points = Vec::new();
        let mut drivers = Vec::new();
        for (own, driver) in trials {
            if let Some(Point { method, training: 0, .. }) = own.first() {
                drivers.push((method.clone(), driver));
            }
            points.extend(own);
        }
        let findings = Findings { plan: self.plan.clone(), goal: G::GOAL, grades: self.game.grades(), points };
        Ok(Learnt { findings, drivers })
    }

    /// Makes the folder, or sees that it is that of the same plan.
    fn open(&self) -> Result<()> {
        let Some(folder) = &self.folder else { return Ok(()) };
        let make = |folder: &Path| std::fs::create_dir_all(folder).map_err(|source| Error::io("make", folder, source));
        make(folder)?;
        let path = folder.join("plan.json");
        match read::<Plan>(&path)? {
            Some(plan) if plan != *self.plan => {
                return Err(Error::file(&path, "the plan of another experiment", "name another folder, or delete it"));
            }
            Some(_) => {}
            None => write(&path, self.plan)?,
        }
        self.plan.methods.iter().try_for_each(|method| {
            (0..self.plan.trainings).try_for_each(|k| make(&folder.join(format!("{}-{k}", method.name))))
        })
    }

    /// How much work it is to learn in round `i` from 1.
    fn weight(&self, method: &Method, i: usize) -> u64 {
        if method.teaching.aggregates() { LEARNING * i as u64 } else { LEARNING }
    }

    /// Trains once and measures after each round.
    fn trial(&self, trial: &Trial<'_>, tick: &dyn Ticking) -> Result<(Vec<Point>, Driver<NetOf<G>>)> {
        let Trial { method, training, folder } = trial;
        let rounds = method.teaching.rounds();
        let seed = Seed::new(self.plan.seed).child(Purpose::Round, *training);
        let answers = Answers::open(folder.as_deref(), rounds)?;
        let told = |i: usize| {
            let what = format!("{} {training}: learned {} of {rounds}", method.name, i + 1);
            tick.tick(self.weight(method, i + 1), what);
        };
        let (nets, ledgers) = self.train(method, &answers, seed, &told)?;
        let point = |round: usize| {
            let path = folder.as_ref().map(|folder| folder.join(format!("point-{round}.json")));
            let point = match path.as_deref().map(read::<Point>).transpose()?.flatten() {
                Some(point) => point,
                None => {
                    let driver = policy(&method.teaching, nets[..round].iter().collect());
                    let grades = self.measure(&driver, *training)?;
                    let (ledger, method) = (ledgers[round - 1], method.name.clone());
                    let point = Point { method, training: *training, round, ledger, grades };
                    path.as_deref().map_or(Ok(()), |path| write(path, &point))?;
                    point
                }
            };
            tick.tick(1, format!("{} {training}: measured {round} of {rounds}", method.name));
            Ok(point)
        };
        // Forward training ends with the longest game, which may be shorter than what it was to learn.
        let first = method.teaching.first().min(nets.len()).max(1);
        let points = (first..=nets.len()).map(point).collect::<Result<_>>()?;
        Ok((points, policy(&method.teaching, nets.iter().collect()).map(Clone::clone)))
    }

    /// All nets of a training, and the bill after each.
    fn train(
        &self,
        method: &Method,
        answers: &Answers,
        seed: Seed,
        watch: &(dyn Fn(usize) + Sync),
    ) -> Result<(Vec<NetOf<G>>, Vec<Ledger>)> {
        let Amount { episodes, length } = method.amount;
        // A roll-out's seeds are shared by many states: its answers cannot be kept.
        let kept = Some(answers).filter(|_| !matches!(method.teaching, Teaching::Searn(_)));
        let runner = Runner(self.game.expert());
        let (short, decisions) = match length {
            Length::Game => (None, None),
            Length::Marathon(decisions) => (None, Some(decisions)),
            Length::Short(decisions) => (Some(self.game.short(decisions)?), None),
        };
        let problem = Imitation {
            space: Marathon::new(short.as_ref().unwrap_or(self.game.space()), decisions)?,
            expert: Remembering::new(&runner, kept),
            episodes: episodes * self.game.grades().len(),
        };
        let learner = Keeping::<G::View>::new(&method.learner, answers, watch);
        let run = Run { seed, ..Run::new(0) };
        let rounds = match &method.teaching {
            Teaching::Supervised(trainer) => trainer.train(&problem, &learner, &run)?.rounds,
            Teaching::Forward(trainer) => trainer.train(&problem, &learner, &run)?.rounds,
            Teaching::Smile(trainer) => trainer.train(&problem, &learner, &run)?.rounds,
            Teaching::Searn(trainer) => trainer.train(&problem, &learner, &run)?.rounds,
            Teaching::Dagger(trainer) => trainer.train(&problem, &learner, &run)?.rounds,
        };
        Ok((learner.finish()?, rounds.iter().map(|Progress { ledger, .. }| *ledger).collect()))
    }

    /// Plays games of all grades that nobody trained on: the same in all rounds of all methods.
    fn measure(&self, driver: &Driver<&NetOf<G>>, training: u64) -> Result<Vec<Measured>> {
        let grades = self.game.grades().len();
        let space = Marathon::new(self.game.space(), None)?;
        let problem = Imitation { space, expert: Runner(self.game.expert()), episodes: self.plan.games * grades };
        let seed = Seed::new(self.plan.seed).child(Purpose::Evaluation, training);
        let outcomes = outcomes(&problem, driver, seed, |end| self.game.outcome(end.game()));
        let mut measured = vec![Measured::default(); grades];
        outcomes.iter().enumerate().for_each(|(i, outcome)| measured[i % grades].add(*outcome));
        Ok(measured)
    }
}

/// Who counts work that is done.
trait Ticking: Sync {
    fn tick(&self, weight: u64, what: String);
}

impl<F: Fn(u64, String) + Sync> Ticking for F {
    fn tick(&self, weight: u64, what: String) {
        self(weight, what);
    }
}

/// What the trainer would have returned had it stopped after these classifiers.
fn policy<C>(teaching: &Teaching, mut nets: Vec<C>) -> Driver<C> {
    match teaching {
        Teaching::Forward(_) => Driver::Ladder(Ladder::of(nets)),
        Teaching::Supervised(_) | Teaching::Dagger(_) => {
            Driver::Mixture(nets.pop().map_or_else(Mixture::of_expert, Mixture::of_one))
        }
        Teaching::Smile(smile) => {
            let mut mixture = Mixture::of_expert();
            nets.into_iter().for_each(|net| mixture.replace_expert(smile.alpha, net));
            Driver::Mixture(mixture.without_expert())
        }
        Teaching::Searn(searn) => {
            let mut mixture = Mixture::of_expert();
            nets.into_iter().for_each(|net| mixture.blend(searn.beta, net));
            Driver::Mixture(mixture.without_expert())
        }
    }
}

/// What stands in the JSON file at `path`, if there is one.
fn read<T: DeserializeOwned>(path: &Path) -> Result<Option<T>> {
    if !path.exists() {
        return Ok(None);
    }
    let bytes = std::fs::read(path).map_err(|source| Error::io("read", path, source))?;
    let parsed = serde_json::from_slice(&bytes);
    parsed.map(Some).map_err(|error| Error::file(path, error.to_string(), "delete it: it will be made again"))
}

/// Writes `value` as JSON.
fn write(path: &Path, value: &impl Serialize) -> Result<()> {
    write_whole(path, &serde_json::to_vec(value).unwrap_or_default())
}
