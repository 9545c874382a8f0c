//! A game to be watched: one page that needs nothing else.

use super::{Driver, Game, NetOf};
use crate::error::Result;
use crate::policy::Policy;
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Episode, Imitation, Marathon, Problem, Runner, Space};
use crate::worker::Worker;
use serde::Serialize;
use serde_json::{Value, json};

/// The page: its data go where `DATA` stands.
const PAGE: &str = include_str!("replay.html");

/// A game that can be drawn.
pub trait Filmed: Game {
    /// What does not change from the game that starts in `start` on.
    fn scene(&self, start: &<Self::Space as Space>::State) -> Value;

    /// The pictures from `state` up to the next decision, when `action` is taken; at least one, as many for each action.
    fn film(&self, state: &<Self::Space as Space>::State, action: Action) -> Vec<Value>;

    /// An action in words.
    fn action(&self, action: Action) -> String;

    /// Pictures a second.
    fn rate(&self) -> f64;

    /// How the game stands, in words.
    fn tell(&self, state: &<Self::Space as Space>::State) -> String;
}

/// One policy's game.
#[derive(Clone, Debug, Serialize)]
pub struct Ride {
    /// Whose.
    pub name: String,
    /// How it ended.
    pub end: String,
    /// Decisions that were not the expert's.
    pub different: usize,
    /// Decisions.
    pub decisions: usize,
    /// For each decision what the policy did and what the expert would have done, numbers of `actions`.
    choices: Vec<[u32; 2]>,
    /// The pictures, all decisions' one after the other.
    film: Vec<Value>,
    /// The picture at which each decision is made.
    starts: Vec<usize>,
    scene: Value,
}

/// Lets each of the `drivers` play the episode numbered `index` below `seed`, beside the expert. Returns their rides and the page that shows them.
///
/// # Errors
/// None: marathons of one game always begin.
pub fn replay<G: Filmed>(
    game: &G,
    drivers: &[(String, Driver<NetOf<G>>)],
    index: usize,
    seed: Seed,
) -> Result<(Vec<Ride>, String)> {
    let rides =
        drivers.iter().map(|(name, driver)| ride(game, name, driver, index, seed)).collect::<Result<Vec<_>>>()?;
    let actions: Vec<String> = (0..game.space().actions() as u32).map(|a| game.action(Action(a))).collect();
    let data = json!({ "task": G::NAME, "rate": game.rate(), "actions": actions, "rides": rides });
    // Nothing in the data may end the script that it stands in.
    let data = data.to_string().replace('<', "\\u003c");
    Ok((rides, PAGE.replace("/*DATA*/", &data)))
}

fn ride<G: Filmed>(game: &G, name: &str, driver: &Driver<NetOf<G>>, index: usize, seed: Seed) -> Result<Ride> {
    let space = Marathon::new(game.space(), None)?;
    let problem = Imitation { space, expert: Runner(game.expert()), episodes: 1 };
    let episode = Episode { index, seed: seed.child(Purpose::Evaluation, index as u64) };
    let mut ride = Ride {
        name: name.to_owned(),
        end: String::new(),
        different: 0,
        decisions: 0,
        choices: Vec::new(),
        film: Vec::new(),
        starts: Vec::new(),
        scene: game.scene(problem.space().start(episode).game()),
    };
    let mut memory = Default::default();
    let (_, end) = Worker::new(&problem).run(episode, |visit| {
        let action = driver.act(visit, &mut memory);
        let expert = visit.label().unwrap_or(action);
        ride.choices.push([action.0, expert.0]);
        ride.starts.push(ride.film.len());
        ride.film.extend(game.film(visit.state().game(), action));
        Some(action)
    });
    ride.film.extend(game.film(end.game(), Action(0)).into_iter().take(1));
    ride.end = game.tell(end.game());
    ride.decisions = ride.choices.len();
    ride.different = ride.choices.iter().filter(|[own, expert]| own != expert).count();
    Ok(ride)
}
