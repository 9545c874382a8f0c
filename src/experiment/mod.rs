//! The two experiments of Ross & Bagnell (2010, section 5) on games: who learns to play from how many of the expert's answers.
//!
//! A [`Game`] is a space with an expert and something to measure. A [`Plan`] says which methods learn it, from how much in a round and for how many
//! rounds; a [`Lab`] carries it out, measures what was learned after every round on games that nobody trained on, and can go on with an
//! experiment that was killed. [`Findings`] hold every point with its bill, [`claims`] what is to be seen in them.
//!
//! Everything random is keyed: the same plan gives the same findings, to the bit, at any number of threads and however often it was killed.

mod claims;
mod driver;
mod games;
mod keep;
mod lab;
mod measure;
mod plan;
mod replay;
mod report;

pub use claims::{Claim, claims};
pub use driver::Driver;
pub(crate) use driver::Stored;
pub use games::{Platforming, Racing, Scale};
#[cfg(feature = "cli")]
pub(crate) use lab::Tick;
pub use lab::{Findings, Lab, Learnt, Point};
pub(crate) use measure::Spread;
pub use measure::{Interval, Measured, Outcome};
pub use plan::{Amount, Length, Method, Plan, Teaching};
pub use replay::{Filmed, Ride, replay};
pub use report::{page, text};

use crate::error::Result;
use crate::learner::Sensed;
use crate::policy::Neural;
use crate::space::{Expert, Space};
use serde::{Deserialize, Serialize};

/// What is measured first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Goal {
    /// Distance: more is better.
    Distance,
    /// Falls: fewer are better.
    Falls,
}

/// A game to be learned.
pub trait Game: Sync {
    /// What is seen of it.
    type View: Sensed<Layer: Stored<Self::View>>;
    /// The game itself. States can be cloned, because SEARN is to be shown beside those who do not need that.
    type Space: Space<View = Self::View, State: Clone>;
    /// Who is to be imitated.
    type Expert: Expert<Self::Space>;

    /// Its name, on the command line and in files.
    const NAME: &'static str;
    /// What counts.
    const GOAL: Goal;

    /// The game.
    fn space(&self) -> &Self::Space;

    /// The same game, over after so many decisions, with what it costs by then.
    ///
    /// # Errors
    /// When there are to be none.
    fn short(&self, decisions: usize) -> Result<Self::Space>;

    /// Its expert.
    fn expert(&self) -> &Self::Expert;

    /// The names of its grades of difficulty, the easiest first: at least one. Episode i is of grade i modulo their number.
    fn grades(&self) -> Vec<String>;

    /// How the game that ended in `state` went.
    fn outcome(&self, state: &<Self::Space as Space>::State) -> Outcome;
}

/// The input layer of a game's nets.
pub type LayerOf<G> = <<G as Game>::View as Sensed>::Layer;
/// The nets that play a game.
pub type NetOf<G> = Neural<LayerOf<G>>;
