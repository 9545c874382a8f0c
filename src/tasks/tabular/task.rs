//! Tabular problems as a [`Task`]: what the program's verbs need of it.

use super::{Tabled, Tabular};
use crate::error::{Error, Place, Result};
use crate::policy::{MixtureMemory, Reading};
use crate::read::conll::Block;
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Episode, Imitation, Space};
use crate::tasks::{self, Arrays, Data, Fact, Learned, Measure, Model, Task, Units};
use crate::theory::instance::Instance;
use crate::theory::{Table, evaluate};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A trained walker of tabular problems.
pub type Walker = Model<Chart>;

/// How many episodes an instance counts for.
pub const EPISODES: usize = 1_000;

/// Episodes of the instance in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Runs {
    instance: Arc<Instance>,
    /// The number of the first, and how many there are.
    first: usize,
    episodes: usize,
    path: PathBuf,
}

impl Data for Runs {
    fn path(&self) -> &Path {
        &self.path
    }
    fn sentences(&self) -> usize {
        self.episodes
    }
    fn tokens(&self) -> usize {
        self.episodes * self.instance.mdp.horizon()
    }
    fn truncate(&mut self, episodes: usize) {
        self.episodes = self.episodes.min(episodes);
    }
    fn split_off(&mut self, episodes: usize) -> Self {
        let (kept, all) = (self.episodes.min(episodes), self.episodes);
        self.episodes = kept;
        Runs { first: self.first + kept, episodes: all - kept, ..self.clone() }
    }
}

/// How many different views there are of states (the instance's phi, or else the states themselves), and how many actions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chart {
    views: usize,
    choices: usize,
}

/// What a policy costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Value {
    /// Episodes that were run.
    pub episodes: u64,
    /// Steps in them.
    pub steps: u64,
    /// Steps at which the expert would have done the same.
    pub agreed: u64,
    /// What the episodes cost on average.
    pub sampled_cost: f64,
    /// J, what an episode is expected to cost, exactly; none for a policy that is no table of probabilities at each step: one that searches with a beam, or
    /// sees what another did.
    pub expected_cost: Option<f64>,
    /// J of the expert.
    pub expert_cost: f64,
}

/// Below what all that happens in evaluation is drawn, the same for every policy.
const DRAWN: u64 = 2010;

impl Chart {
    fn of(instance: &Instance) -> Self {
        let views = view(instance).into_iter().max().map_or(0, |most| most + 1);
        Chart { views, choices: instance.mdp.actions() }
    }
}

/// What is seen of each state.
fn view(instance: &Instance) -> Vec<usize> {
    instance.view.clone().unwrap_or_else(|| (0..instance.mdp.states()).collect())
}

/// What `policy` does in `space` at each step, exactly, where that depends on the step and the state alone.
fn tables(space: &Tabular, policy: &Learned) -> Result<Option<Vec<Table>>> {
    let horizon = space.mdp().horizon();
    Ok(match policy {
        Learned::Mixture(mixture) if mixture.reading() == Reading::Sampled => {
            let members: Vec<(f64, Table)> =
                mixture.members().iter().map(|(weight, member)| (*weight, space.table_of(member))).collect();
            let members: Vec<(f64, &Table)> = members.iter().map(|(weight, table)| (*weight, table)).collect();
            Some(vec![Table::mixture(&members)?; horizon])
        }
        Learned::Mixture(mixture) => {
            let mut memory = MixtureMemory::default();
            Some(vec![space.tabulate(|sight| mixture.decide(sight, &mut memory)); horizon])
        }
        Learned::Ladder(ladder) => {
            let mut tables: Vec<Table> = ladder.steps().iter().take(horizon).map(|step| space.table_of(step)).collect();
            if let Some(last) = tables.last().cloned() {
                tables.resize(horizon, last);
            }
            Some(tables)
        }
        Learned::Beam(_) | Learned::Stacked(_) | Learned::Readings { .. } => None,
    })
}

impl Task for Chart {
    const NAME: &'static str = "tabular";
    type Data = Runs;
    type Settings = ();
    type Space = Tabular;
    type Expert = Tabled;
    type Score = Value;
    type Header = Chart;
    type Stream = ();

    const UNITS: Units = Units { episode: "episode", episodes: "episodes", steps: "steps", loss: "cost" };

    fn parse(text: &[u8], path: &Path) -> Result<Runs> {
        let instance = Arc::new(Instance::parse(path, text)?);
        Ok(Runs { instance, first: 0, episodes: EPISODES, path: path.to_owned() })
    }

    /// The first block is all there may be.
    fn parse_block(&self, block: &Block, path: &Path, (): &mut ()) -> Result<Option<Runs>> {
        if block.bytes.trim_ascii().is_empty() {
            return Ok(None);
        }
        if block.first_line > 1 {
            let place = Place { path: path.to_owned(), line: block.first_line, column: 1 };
            return Err(Error::data(place, "more text", "one instance, of fewer lines or without blank ones"));
        }
        Chart::parse(&block.bytes, path).map(Some)
    }

    fn learn(runs: &Runs, (): ()) -> Result<(Self, Imitation<Tabular, Tabled>)> {
        let space = Tabular::new(runs.instance.mdp.clone(), &view(&runs.instance))?;
        Ok((Chart::of(&runs.instance), space.problem(runs.episodes)))
    }

    /// What chance decides is drawn beforehand, for every policy alike.
    fn apply(&self, runs: &Runs) -> Result<Tabular> {
        let found = Chart::of(&runs.instance);
        if found.views > self.views || found.choices != self.choices {
            let problem = format!("{} views of states and {} actions", found.views, found.choices);
            let remedy = format!("the model knows {} views and {} actions", self.views, self.choices);
            return Err(Error::file(&runs.path, problem, remedy));
        }
        let space = Tabular::new(runs.instance.mdp.clone(), &view(&runs.instance))?;
        Ok(space.drawn(Seed::new(DRAWN).child(Purpose::Evaluation, 0), runs.first))
    }

    /// A line for each episode: its states and actions, `s:a`.
    fn write(&self, _: &Block, of: Option<(&Runs, &[Action])>, out: &mut impl Write) -> io::Result<()> {
        let Some((runs, actions)) = of else { return Ok(()) };
        let space = self.apply(runs).map_err(io::Error::other)?;
        let mut lines = vec![Vec::new(); runs.episodes];
        walk(&space, runs.episodes, actions, |index, s, action, _| lines[index].push(format!("{s}:{}", action.0)));
        lines.iter().try_for_each(|line| writeln!(out, "{}", line.join(" ")))
    }

    fn check(&self, runs: &Runs) -> Result<()> {
        self.apply(runs).map(|_| ())
    }

    /// By what happened; [`Task::judge`] adds the exact value.
    fn score(&self, runs: &Runs, actions: &[Action]) -> Result<Value> {
        let space = self.apply(runs)?;
        let expert = evaluate(space.mdp(), &space.mdp().star())?.cost;
        let mut value = Value { episodes: runs.episodes as u64, expert_cost: expert, ..Value::default() };
        walk(&space, runs.episodes, actions, |_, s, action, cost| {
            value.steps += 1;
            value.agreed += u64::from(space.mdp().expert()[s] == action.index());
            value.sampled_cost += cost;
        });
        value.sampled_cost /= runs.episodes.max(1) as f64;
        Ok(value)
    }

    fn judge(&self, policy: &Learned, runs: &Runs, actions: &[Action]) -> Result<Value> {
        let space = self.apply(runs)?;
        let exact = match tables(&space, policy)? {
            Some(tables) => Some(evaluate(space.mdp(), &tables[..])?.cost),
            None => None,
        };
        Ok(Value { expected_cost: exact, ..self.score(runs, actions)? })
    }

    fn features(&self) -> usize {
        self.views
    }

    fn actions(&self) -> usize {
        self.choices
    }

    /// All: their numbers say what they are.
    fn keep(&mut self, _: &dyn Fn(u32) -> bool) -> Result<Vec<u32>> {
        Ok((0..self.views as u32).collect())
    }

    fn header(&self) -> Chart {
        self.clone()
    }

    fn arrays(&self) -> Vec<&[u64]> {
        Vec::new()
    }

    fn restore(chart: Chart, _: &mut Arrays<'_>, _: &Path) -> Result<Self, String> {
        let most = u32::MAX as usize;
        let fine = (1..most).contains(&chart.views) && (1..most).contains(&chart.choices);
        if fine { Ok(chart) } else { Err("it has no views or no actions, or too many".into()) }
    }

    fn facts(&self) -> Vec<Fact> {
        let fact = |name, value: usize| Fact { name, text: value.to_string(), value: value.into() };
        vec![fact("views", self.views), fact("actions", self.choices)]
    }
}

/// Goes through all episodes of `space` by `actions` and shows each step: episode, state, action and what it cost.
fn walk(space: &Tabular, episodes: usize, actions: &[Action], mut show: impl FnMut(usize, usize, Action, f64)) {
    let mut actions = actions.iter();
    // All draws were made beforehand.
    let seed = Seed::new(0);
    for index in 0..episodes {
        let mut state = space.start(Episode { index, seed });
        while !space.legal(&state).is_empty()
            && let Some(action) = actions.next()
        {
            let s = state.s;
            let cost = space.step(&mut state, *action, seed);
            show(index, s, *action, cost);
        }
    }
}

impl Value {
    /// The exact cost where there is one, else what was sampled.
    fn cost(&self) -> f64 {
        self.expected_cost.unwrap_or(self.sampled_cost)
    }
}

impl tasks::Score for Value {
    fn text(&self) -> String {
        let exact = self.expected_cost.map_or("not known".to_owned(), |cost| format!("{cost:.6}"));
        format!(
            "ran {} episodes, {} steps\nas the expert: {:.2}% of the steps\ncost of an episode: {:.6}\nexpected cost: {exact}\n\
             expected cost of the expert: {:.6}\n",
            self.episodes,
            self.steps,
            100.0 * self.agreed as f64 / self.steps.max(1) as f64,
            self.sampled_cost,
            self.expert_cost,
        )
    }

    fn loss(&self) -> f64 {
        self.cost() * self.episodes as f64
    }

    fn measures(&self) -> Vec<Measure> {
        let agreed = 100.0 * self.agreed as f64 / self.steps.max(1) as f64;
        let ratio = (self.expert_cost > 0.0).then(|| 100.0 * self.cost() / self.expert_cost);
        vec![
            Measure { key: "agreement", name: "as expert %", percent: Some(agreed) },
            Measure { key: "expert_cost", name: "expert's cost %", percent: ratio },
        ]
    }
}
