//! Grid maps: drawn at random, and made into worlds.

use super::network::{Road, Site};
use super::{Legend, Trip, World};
use crate::error::{Error, Result};
use crate::read::grid::{Grid, MOST_TERRAINS};
use crate::seed::{Purpose, Seed};
use petgraph::graph::{DiGraph, NodeIndex};
use rand::RngExt;
use serde::{Deserialize, Serialize};

/// How far one sees on a grid: cells up to this many columns and rows away.
const SIGHT: isize = 2;

/// Maps of terrain with costs that only the expert knows.
///
/// A step to a cell costs what its terrain costs. Actions are up, right, down and left; an edge has one feature, the terrain that it leads to. What can be
/// seen from a cell is the terrain, or the wall, of each cell within two columns and rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Maps {
    /// Columns of a map that is drawn.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Patches of terrain: each cell has that of the nearest of so many centres.
    pub patches: usize,
    /// The probability that a cell is a wall, in [0, 1).
    pub walls: f64,
    /// What each class of terrain costs: the hidden weights.
    pub costs: Vec<f64>,
    /// In [0, 1): a cell costs up to this share more or less than its terrain, which nothing shows.
    pub rough: f64,
}

impl Default for Maps {
    fn default() -> Self {
        Maps { width: 16, height: 16, patches: 40, walls: 0.1, costs: vec![1.0, 2.0, 4.0, 8.0, 16.0], rough: 0.0 }
    }
}

impl Maps {
    fn check(&self) -> Result<()> {
        let cells = self.width.saturating_mul(self.height);
        if !(2..=1 << 24).contains(&cells) {
            return Err(Error::argument("cells", cells, "from 2 to 2^24"));
        }
        if !(1..=cells).contains(&self.patches) {
            return Err(Error::argument("patches", self.patches, "from 1 to the number of cells"));
        }
        if !(0.0..1.0).contains(&self.walls) {
            return Err(Error::argument("walls", self.walls, "at least 0 and below 1"));
        }
        if !(1..=MOST_TERRAINS).contains(&self.costs.len()) {
            return Err(Error::argument("costs", format!("{} numbers", self.costs.len()), "from 1 to 26 numbers"));
        }
        Ok(())
    }

    /// How everything on these maps is numbered.
    pub fn legend(&self) -> Legend {
        let seen = (2 * SIGHT + 1) * (2 * SIGHT + 1);
        Legend { actions: 4, roads: self.costs.len(), sites: seen as usize * (self.costs.len() + 1) }
    }

    /// Draws `count` maps with one trip each, between cells at least half as many steps apart as width and height have together, where
    /// there are such. Map i hangs below branch i of `seed` alone.
    ///
    /// # Errors
    /// When a setting is out of its range, or the walls leave no way to draw, as on a map of two cells.
    pub fn grids(&self, count: usize, seed: Seed) -> Result<Vec<Grid>> {
        self.check()?;
        (0..count).map(|i| self.grid(seed.child(Purpose::Episode, i as u64))).collect()
    }

    fn grid(&self, seed: Seed) -> Result<Grid> {
        let mut rng = seed.rng();
        let cells = self.width * self.height;
        let apart =
            |a: usize, b: usize| (a % self.width).abs_diff(b % self.width) + (a / self.width).abs_diff(b / self.width);
        // With walls all over there may be no way at all: then another map is drawn.
        for _ in 0..100 {
            let centres: Vec<(usize, u8)> = (0..self.patches)
                .map(|_| (rng.random_range(0..cells), rng.random_range(0..self.costs.len()) as u8))
                .collect();
            let nearest = |cell: usize| centres.iter().min_by_key(|(centre, _)| apart(cell, *centre)).map(|(_, t)| *t);
            let cells = (0..cells).map(|cell| if rng.random_bool(self.walls) { None } else { nearest(cell) }).collect();
            let mut grid = Grid { width: self.width, cells, trips: Vec::new() };
            let regions = grid.regions();
            for tries in 0..1000 {
                let [start, goal] = [0; 2].map(|_| rng.random_range(0..regions.len()));
                // After many tries in vain any way will do.
                let far = apart(start, goal) >= (self.width + self.height) / 2 || tries >= 500;
                if start != goal && regions[start] == regions[goal] && grid.cells[start].is_some() && far {
                    grid.trips.push([start, goal]);
                    return Ok(grid);
                }
            }
        }
        Err(Error::argument("walls", self.walls, "so few that there are two cells with a way between them"))
    }

    /// The world of `grids` and all their trips, at these costs. Where cells are rough, how much is below `seed`. A trip's horizon is twice its
    /// map's width and height together.
    ///
    /// # Errors
    /// When a setting is out of its range, a cell's terrain has no cost, or a trip has no way.
    pub fn world(&self, grids: &[Grid], seed: Seed) -> Result<World> {
        if !(0.0..1.0).contains(&self.rough) {
            return Err(Error::argument("rough", self.rough, "at least 0 and below 1"));
        }
        let mut graphs = Vec::new();
        let mut trips = Vec::new();
        for (map, grid) in grids.iter().enumerate() {
            if let Some(terrain) = grid.cells.iter().flatten().find(|terrain| **terrain as usize >= self.costs.len()) {
                return Err(Error::argument("terrain", terrain, format!("below {}", self.costs.len())));
            }
            graphs.push(self.graph(grid, seed.child(Purpose::Episode, map as u64)));
            let horizon = 2 * (grid.width + grid.height());
            trips.extend(grid.trips.iter().map(|[start, goal]| Trip { map, start: *start, goal: *goal, horizon }));
        }
        World::new(self.legend(), &graphs, &trips)
    }

    /// `grid` as a graph: node i is cell i, walls are nodes without edges.
    pub fn graph(&self, grid: &Grid, seed: Seed) -> DiGraph<Site, Road> {
        let mut graph = DiGraph::new();
        for cell in 0..grid.cells.len() {
            let at = [(cell % grid.width) as f64, (cell / grid.width) as f64];
            graph.add_node(Site { at, features: self.seen(grid, cell) });
        }
        for cell in (0..grid.cells.len()).filter(|cell| grid.cells[*cell].is_some()) {
            for (action, to) in grid.neighbours(cell).into_iter().enumerate() {
                let Some((to, terrain)) = to.and_then(|to| Some((to, grid.cells[to]?))) else { continue };
                let bump = 2.0 * seed.child(Purpose::Step, to as u64).unit() - 1.0;
                let cost = self.costs[terrain as usize] * (1.0 + self.rough * bump);
                let road = Road { action: action as u32, cost, features: vec![u32::from(terrain)] };
                graph.add_edge(NodeIndex::new(cell), NodeIndex::new(to), road);
            }
        }
        graph
    }

    /// What is seen from `cell`: the terrain of each cell in sight, and the wall beyond the edge of the map.
    fn seen(&self, grid: &Grid, cell: usize) -> Vec<u32> {
        let (column, row) = ((cell % grid.width) as isize, (cell / grid.width) as isize);
        let offsets = (-SIGHT..=SIGHT).flat_map(|down| (-SIGHT..=SIGHT).map(move |right| (right, down)));
        let terrain = |(right, down): (isize, isize)| {
            let column = usize::try_from(column + right).ok().filter(|column| *column < grid.width)?;
            *grid.cells.get(usize::try_from(row + down).ok()? * grid.width + column)?
        };
        let numbered = offsets.enumerate().map(|(place, offset)| {
            let terrain = terrain(offset).map_or(self.costs.len(), usize::from);
            (place * (self.costs.len() + 1) + terrain) as u32
        });
        numbered.collect()
    }
}
