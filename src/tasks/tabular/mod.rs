//! A tabular problem as a task: what theory evaluates exactly, every trainer can also run on by sampling.
//!
//! A [`Chart`] reads the instances of `rollin theory` ([`crate::theory::instance`]); a policy that is trained on one is worth an exact expected cost.

mod task;

pub use task::{Chart, EPISODES, Runs, Value, Walker};

use crate::error::{Error, Result};
use crate::policy::Classifier;
use crate::seed::{Purpose, Seed};
use crate::space::{
    Action, Actions, CostToGo, Episode, Expert, FeatureTable, Features, Imitation, NO_ROW, Sight, Space,
};
use crate::theory::{Mdp, Table, evaluate};
use ndarray::{Array3, ArrayView1, Axis};

/// A tabular problem as a space. A policy sees one feature: `view[s]` of the state it is in.
#[derive(Clone, Debug)]
pub struct Tabular {
    mdp: Mdp,
    view: Vec<u32>,
    table: FeatureTable,
    /// Where chance is drawn beforehand, what all draws hang below, and the number of the first episode there.
    drawn: Option<(Seed, usize)>,
    /// The expert's own `action_value[t,s,a]`.
    expert: Array3<f64>,
}

/// A step and a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct At {
    /// The step, from 0.
    pub t: usize,
    /// The state.
    pub s: usize,
    /// What this episode's draws hang below, where they are drawn beforehand.
    draws: Option<Seed>,
}

/// The expert of a tabular problem.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tabled;

impl Tabular {
    /// The space of `mdp`, in which a policy sees `view[s]` of state s.
    ///
    /// # Errors
    /// When there is not one view a state.
    pub fn new(mdp: Mdp, view: &[usize]) -> Result<Self> {
        if view.len() != mdp.states() {
            return Err(Error::argument("view", format!("{} numbers", view.len()), format!("{}", mdp.states())));
        }
        let expert = evaluate(&mdp, &mdp.star())?.action_value;
        let table = FeatureTable::new(view.iter().max().map_or(0, |most| most + 1));
        let view = view.iter().map(|seen| *seen as u32).collect();
        Ok(Tabular { mdp, view, table, drawn: None, expert })
    }

    /// The problem of imitating its expert on `episodes` episodes a round.
    pub fn problem(self, episodes: usize) -> Imitation<Tabular, Tabled> {
        Imitation { space: self, expert: Tabled, episodes }
    }

    /// The same problem with all that chance decides drawn beforehand, whoever runs it: its episodes have the numbers from `first` on in a series below `seed`.
    /// So what happened is known again from what was done.
    pub fn drawn(self, seed: Seed, first: usize) -> Self {
        Tabular { drawn: Some((seed, first)), ..self }
    }

    /// The tabular problem.
    pub fn mdp(&self) -> &Mdp {
        &self.mdp
    }

    /// What `classifier` does in each state, as a table.
    pub fn table_of<C: Classifier<Features>>(&self, classifier: &C) -> Table {
        let mut memory = C::Memory::default();
        self.tabulate(|sight| classifier.choose(sight, &mut memory))
    }

    /// What `choose` does in each state, as a table.
    fn tabulate(&self, mut choose: impl FnMut(&Sight<'_, Features>) -> Action) -> Table {
        let (actions, mut view) = (self.mdp.actions(), Features::default());
        let mut choice = |s: usize| {
            self.see(s, &mut view);
            choose(&Sight { shared: &self.table, view: &view, legal: Actions::All(actions as u32) }).index()
        };
        Table::sure(&(0..self.view.len()).map(&mut choice).collect::<Vec<_>>(), actions)
    }

    fn see(&self, s: usize, view: &mut Features) {
        view.row = NO_ROW;
        view.dynamic.clear();
        view.dynamic.push(self.view[s]);
    }
}

/// What falls to `unit` when every index is as long as its probability.
fn draw(probabilities: ArrayView1<'_, f64>, unit: f64) -> usize {
    let mut below = 0.0;
    let mut last = 0;
    for (i, p) in probabilities.iter().enumerate().filter(|(_, p)| **p > 0.0) {
        below += p;
        last = i;
        if unit < below {
            break;
        }
    }
    last
}

impl Space for Tabular {
    type State = At;
    type View = Features;

    fn start(&self, episode: Episode) -> At {
        let draws = self.drawn.map(|(seed, first)| seed.child(Purpose::Episode, (first + episode.index) as u64));
        let unit = draws.unwrap_or(episode.seed).child(Purpose::Episode, 0).unit();
        At { t: 0, s: draw(self.mdp.start().view(), unit), draws }
    }

    fn legal<'a>(&'a self, state: &'a At) -> Actions<'a> {
        if state.t < self.mdp.horizon() { Actions::All(self.mdp.actions() as u32) } else { Actions::NONE }
    }

    fn look(&self, state: &At, view: &mut Features) {
        self.see(state.s, view);
    }

    fn step(&self, state: &mut At, action: Action, seed: Seed) -> f64 {
        let (s, a) = (state.s, action.index());
        let next = self.mdp.next().index_axis(Axis(0), s).index_axis_move(Axis(0), a);
        let seed = state.draws.map_or(seed, |draws| draws.child(Purpose::Step, state.t as u64));
        *state = At { t: state.t + 1, s: draw(next, seed.child(Purpose::Step, 0).unit()), ..*state };
        self.mdp.cost()[[s, a]]
    }

    fn actions(&self) -> usize {
        self.mdp.actions()
    }

    fn horizon(&self, _: usize) -> Option<usize> {
        Some(self.mdp.horizon())
    }

    fn signature(&self, state: &At) -> Option<u64> {
        Some(state.s as u64)
    }

    fn shared(&self) -> &FeatureTable {
        &self.table
    }
}

impl Expert<Tabular> for Tabled {
    fn action(&self, space: &Tabular, state: &At) -> Option<Action> {
        Some(Action(space.mdp.expert()[state.s] as u32))
    }
}

impl CostToGo<Tabular> for Tabled {
    fn costs(&self, space: &Tabular, state: &At, costs: &mut Vec<f64>) {
        costs.clear();
        costs.extend(space.expert.index_axis(Axis(0), state.t).index_axis(Axis(0), state.s));
    }
}
