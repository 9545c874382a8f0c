//! Navigation on grid maps as a [`Task`]: what the program's verbs need of it.

use super::{At, Cheapest, Legend, Maps, Navigation};
use crate::error::{self, Error, Result};
use crate::read::conll::Block;
use crate::read::grid::{self, Grid, MOST_TERRAINS};
use crate::seed::Seed;
use crate::space::{Action, Episode, Features, Imitation, Space};
use crate::tasks::{self, Arrays, Data, Fact, Measure, Model, Task, Units, write_labels};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A trained traveller: how many classes of terrain it knows and what they cost, and the policy.
pub type Traveller = Model<Guide>;

/// The maps of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Atlas {
    /// The maps and their trips.
    pub grids: Vec<Grid>,
    /// The line of the file on which each begins.
    lines: Vec<usize>,
    path: PathBuf,
}

/// An episode is a trip; cells have the place of tokens.
impl Data for Atlas {
    fn path(&self) -> &Path {
        &self.path
    }
    fn sentences(&self) -> usize {
        self.grids.iter().map(|grid| grid.trips.len()).sum()
    }
    fn tokens(&self) -> usize {
        self.grids.iter().map(|grid| grid.cells.len()).sum()
    }
    fn truncate(&mut self, trips: usize) {
        self.split_off(trips);
    }
    /// A map whose trips are parted stands on both sides.
    fn split_off(&mut self, trips: usize) -> Self {
        let mut rest = Atlas { grids: Vec::new(), lines: Vec::new(), path: self.path.clone() };
        let mut left = trips;
        for (grid, line) in self.grids.iter_mut().zip(&self.lines) {
            let here = grid.trips.len().min(left);
            left -= here;
            let later = grid.trips.split_off(here);
            if !later.is_empty() {
                rest.grids.push(Grid { trips: later, ..grid.clone() });
                rest.lines.push(*line);
            }
        }
        let kept: Vec<bool> = self.grids.iter().map(|grid| !grid.trips.is_empty()).collect();
        let mut of_grids = kept.iter();
        self.grids.retain(|_| of_grids.next() == Some(&true));
        let mut of_lines = kept.iter();
        self.lines.retain(|_| of_lines.next() == Some(&true));
        rest
    }
}

/// What turns maps into features: what each class of terrain costs, by which the expert goes and trips are measured. Learners do not see it.
#[derive(Clone, Debug, PartialEq)]
pub struct Guide {
    maps: Maps,
}

/// What a model file says of a guide.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    costs: Vec<f64>,
}

/// How long trips were against the cheapest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Journeys {
    /// Trips.
    pub trips: u64,
    /// Those that came to their goal within their horizon by themselves.
    pub arrived: u64,
    /// Those that took a cheapest way.
    pub cheapest: u64,
    /// What all cost together; a trip that is late is carried to its goal along the cheapest way.
    pub cost: f64,
    /// What the cheapest ways cost together.
    pub least: f64,
    /// The first over the second; none where the cheapest ways are free.
    pub path_cost_ratio: Option<f64>,
}

/// Costs that sum up to this much more are due to rounding.
const ROUNDING: f64 = 1e-9;

impl Guide {
    /// The guide by these costs of each class of terrain.
    ///
    /// # Errors
    /// When there are not 1 to 26 of them, or one is below 0 or above 1e12.
    pub fn new(costs: Vec<f64>) -> Result<Self> {
        if !(1..=MOST_TERRAINS).contains(&costs.len()) {
            return Err(Error::argument("costs", format!("{} numbers", costs.len()), "from 1 to 26 numbers"));
        }
        if let Some(cost) = costs.iter().find(|cost| !(0.0..=1e12).contains(*cost)) {
            return Err(Error::argument("costs", cost, "from 0 to 1e12 each"));
        }
        Ok(Guide { maps: Maps { costs, rough: 0.0, ..Maps::default() } })
    }

    fn legend(&self) -> Legend {
        self.maps.legend()
    }
}

/// One trip as it was made.
struct Walk<'a> {
    path: &'a [Action],
    cost: f64,
    end: At,
}

/// The trips of `space` by `actions`, those of all, one after the other.
fn walks<'a>(space: &Navigation<Features>, trips: usize, mut actions: &'a [Action]) -> Vec<Walk<'a>> {
    // Nothing is drawn on a map.
    let seed = Seed::new(0);
    let walk = |index| {
        let (mut state, mut cost, all) = (space.start(Episode { index, seed }), 0.0, actions);
        while let Some((action, rest)) = actions.split_first()
            && !space.legal(&state).is_empty()
        {
            cost += space.step(&mut state, *action, seed);
            actions = rest;
        }
        Walk { path: &all[..all.len() - actions.len()], cost, end: state }
    };
    (0..trips).map(walk).collect()
}

impl Task for Guide {
    const NAME: &'static str = "navigation";
    type Data = Atlas;
    /// What each class of terrain costs.
    type Settings = Vec<f64>;
    type Space = Navigation<Features>;
    type Expert = Cheapest;
    type Score = Journeys;
    type Header = Header;
    type Stream = ();

    const UNITS: Units = Units { episode: "trip", episodes: "trips", steps: "cells", loss: "cost" };

    fn parse(text: &[u8], path: &Path) -> Result<Atlas> {
        let (grids, lines) = grid::parse_block(text, path, 1)?;
        let atlas = Atlas { grids, lines, path: path.to_owned() };
        if atlas.sentences() == 0 {
            return Err(Error::file(path, "no trip", "give maps with lines such as `1,1 -> 5,3` below"));
        }
        Ok(atlas)
    }

    fn parse_block(&self, block: &Block, path: &Path, (): &mut ()) -> Result<Option<Atlas>> {
        let (grids, lines) = grid::parse_block(&block.bytes, path, block.first_line)?;
        let atlas = Atlas { grids, lines, path: path.to_owned() };
        Ok(Some(atlas).filter(|atlas| atlas.sentences() > 0))
    }

    fn learn(atlas: &Atlas, costs: Vec<f64>) -> Result<(Self, Imitation<Navigation<Features>, Cheapest>)> {
        let guide = Guide::new(costs)?;
        let space = guide.apply(atlas)?;
        Ok((guide, space.problem()))
    }

    fn apply(&self, atlas: &Atlas) -> Result<Navigation<Features>> {
        let known = self.maps.costs.len();
        for (grid, first) in atlas.grids.iter().zip(&atlas.lines) {
            let foreign = |cell: &Option<u8>| cell.is_some_and(|terrain| terrain as usize >= known);
            if let Some(cell) = grid.cells.iter().position(foreign) {
                let (line, column) = (first + cell / grid.width, 1 + cell % grid.width);
                let place = error::Place { path: atlas.path.clone(), line, column };
                let last = char::from(b'a' + known as u8 - 1);
                return Err(Error::data(place, "terrain without a cost", format!("terrain from a to {last}")));
            }
        }
        Ok(Navigation::new(self.maps.world(&atlas.grids, Seed::new(0))?))
    }

    /// The path becomes a second column in the lines of trips: u, r, d or l for each step up, right, down or left.
    fn write(&self, block: &Block, of: Option<(&Atlas, &[Action])>, out: &mut impl Write) -> io::Result<()> {
        let mut paths: Vec<String> = Vec::new();
        if let Some((atlas, actions)) = of {
            let space = self.apply(atlas).map_err(io::Error::other)?;
            let letter = |action: &Action| ['u', 'r', 'd', 'l'][action.index() % 4];
            let path = |walk: Walk<'_>| walk.path.iter().map(letter).collect::<String>();
            paths = walks(&space, atlas.sentences(), actions).into_iter().map(path).collect();
        }
        let lines = of.into_iter().flat_map(|(atlas, _)| {
            let below =
                |(grid, first): (&Grid, &usize)| first + grid.height()..first + grid.height() + grid.trips.len();
            atlas.grids.iter().zip(&atlas.lines).flat_map(below)
        });
        write_labels(block, lines.zip(paths), out)
    }

    fn check(&self, atlas: &Atlas) -> Result<()> {
        self.apply(atlas).map(|_| ())
    }

    fn score(&self, atlas: &Atlas, actions: &[Action]) -> Result<Journeys> {
        let space = self.apply(atlas)?;
        let world = space.world();
        let mut all = Journeys::default();
        let (mut costs, trips) = (Vec::new(), world.trips().len());
        for (trip, walk) in walks(&space, trips, actions).into_iter().enumerate() {
            let least = world.optimum(trip);
            all.trips += 1;
            all.arrived += u64::from(walk.end.node == world.target(world.goal(trip)).1);
            all.cheapest += u64::from(walk.cost <= least * (1.0 + ROUNDING));
            all.cost += walk.cost;
            all.least += least;
            costs.push(walk.cost);
        }
        all.path_cost_ratio = world.ratio(&costs);
        Ok(all)
    }

    fn features(&self) -> usize {
        self.legend().features()
    }

    fn actions(&self) -> usize {
        self.legend().actions
    }

    /// All: their numbers say what they are.
    fn keep(&mut self, _: &dyn Fn(u32) -> bool) -> Result<Vec<u32>> {
        Ok((0..self.features() as u32).collect())
    }

    fn header(&self) -> Header {
        Header { costs: self.maps.costs.clone() }
    }

    fn arrays(&self) -> Vec<&[u64]> {
        Vec::new()
    }

    fn restore(header: Header, _: &mut Arrays<'_>, _: &Path) -> Result<Self, String> {
        Guide::new(header.costs).map_err(|error| error.to_string())
    }

    fn facts(&self) -> Vec<Fact> {
        let costs: Vec<String> = self.maps.costs.iter().map(f64::to_string).collect();
        vec![Fact { name: "costs", text: costs.join(","), value: self.maps.costs.clone().into() }]
    }
}

impl Journeys {
    fn percent(part: u64, all: u64) -> f64 {
        if all == 0 { 0.0 } else { 100.0 * part as f64 / all as f64 }
    }
}

impl tasks::Score for Journeys {
    fn text(&self) -> String {
        let ratio = self.path_cost_ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.4}"));
        format!(
            "made {} trips, {} to the goal\ncheapest ways: {:.2}%\npath cost ratio: {ratio} ({} over {})\n",
            self.trips,
            self.arrived,
            Journeys::percent(self.cheapest, self.trips),
            self.cost,
            self.least,
        )
    }

    fn loss(&self) -> f64 {
        self.cost
    }

    fn measures(&self) -> Vec<Measure> {
        let ratio = self.path_cost_ratio.map(|ratio| 100.0 * ratio);
        vec![
            Measure {
                key: "cheapest",
                name: "cheapest %",
                percent: Some(Journeys::percent(self.cheapest, self.trips)),
            },
            Measure { key: "path_cost", name: "path cost %", percent: ratio },
        ]
    }
}
