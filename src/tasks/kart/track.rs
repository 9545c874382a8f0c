//! Tracks: passages of road strung together and closed to a loop.

use crate::error::{Error, Result};
use crate::grammar::Grammar;
use crate::read::grammar::Tree;
use crate::read::input;
use crate::read::track::{Section, sections};
use crate::seed::{Purpose, Seed};
use std::f64::consts::TAU;
use std::path::Path;

/// The grammar of the tracks that come with the crate: `grammars/tracks.grammar`.
pub const GRAMMAR: &str = include_str!("../../../grammars/tracks.grammar");

/// Half the width of the road, in metres.
pub const HALF_WIDTH: f64 = 2.5;

/// No bend of a closed track is tighter than this radius, in metres.
const TIGHTEST: f64 = 13.0;
/// Metres between nodes, about.
const SPACING: f64 = 2.0;
/// Nodes on either side over which a bend comes and goes.
const EASE: usize = 3;
/// The road keeps this distance, in metres, from itself where it is not just the same piece.
const APART: f64 = 2.0 * HALF_WIDTH + 4.0;
/// Roads that are drawn before a grammar is given up.
const TRIES: u64 = 400;

/// A source of tracks: a grammar whose words are pieces of a road.
#[derive(Clone, Debug)]
pub struct Tracks {
    grammar: Grammar,
    /// By the number of the word.
    sections: Vec<Section>,
}

/// A place on the centre line of a track, one every [`Track::spacing`] metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    /// Metres ahead and to the right of where the track starts, as seen there.
    pub at: [f64; 2],
    /// Metres above the start.
    pub height: f64,
    /// Where the road goes, in radians, clockwise; 0 at the start, 2 pi more or less after a lap.
    pub heading: f64,
    /// Curvature in 1/m, positive to the right.
    pub bend: f64,
    /// Metres up on each metre ahead.
    pub slope: f64,
}

/// A closed loop of road that floats in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    nodes: Vec<Node>,
    spacing: f64,
}

impl Tracks {
    /// The tracks of [`GRAMMAR`].
    ///
    /// # Errors
    /// None: the grammar that comes with the crate is one of tracks.
    pub fn standard() -> Result<Self> {
        Tracks::parse("grammars/tracks.grammar", GRAMMAR)
    }

    /// The tracks of the grammar in `text`, which came from `path`.
    ///
    /// # Errors
    /// With the exact place, where it is no [grammar](crate::grammar) or a word is no [piece of a road](crate::read::track).
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        let tree = Tree::parse(&path, text)?;
        let known = sections(&tree)?;
        let grammar = Grammar::parse(path, text)?;
        // All words of a grammar stand in its tree.
        let sections = grammar.words().iter().filter_map(|word| known.get(word.as_str()).copied()).collect();
        Ok(Tracks { grammar, sections })
    }

    /// The tracks of the grammar in the file `path`.
    ///
    /// # Errors
    /// When the file cannot be read, else as [`Tracks::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Tracks::parse(input::name(path), &input::text(path)?)
    }

    /// A track of `length` metres, which hangs below `seed`.
    ///
    /// Passages are drawn until the road is long enough and the last piece is cut. The road is then bent over its whole length by the least that
    /// closes it, and tilted until it ends as high as it starts. A road that would have to be bent too much, or that comes too near to itself, is
    /// not taken, and another drawn.
    ///
    /// # Errors
    /// When `length` is not from 200 to 10,000 m, or no road of many closes.
    pub fn draw(&self, length: f64, seed: Seed) -> Result<Track> {
        if !(200.0..=10_000.0).contains(&length) {
            return Err(Error::argument("length", length, "from 200 to 10000 metres"));
        }
        let tries = (0..TRIES).map(|i| seed.child(Purpose::Episode, i));
        tries.filter_map(|seed| Track::close(self.road(length, seed), length)).next().ok_or_else(|| {
            let expected =
                format!("tracks of which at least one of {TRIES} closes over {length} m without touching itself");
            Error::argument("grammar", "one whose roads do not close", expected)
        })
    }

    /// Pieces of road of `length` metres in all.
    fn road(&self, length: f64, seed: Seed) -> Vec<Section> {
        let mut road = Vec::new();
        let mut left = length;
        for passage in 0.. {
            for word in self.grammar.sentence(seed.child(Purpose::Sentence, passage)).words {
                let section = self.sections[word.0 as usize];
                let part = (left / section.length).min(1.0);
                road.push(Section { length: part * section.length, climb: part * section.climb, ..section });
                left -= section.length;
                if left <= 0.0 {
                    return road;
                }
            }
        }
        road
    }
}

impl Track {
    /// The loop that is nearest to `road`, if there is a fair one.
    fn close(road: Vec<Section>, length: f64) -> Option<Track> {
        // Bands of the road's surface take two nodes, and there are two kinds of them.
        let n = 4 * (length / (4.0 * SPACING)).ceil() as usize;
        let mut track = Track { nodes: vec![Node::default(); n], spacing: length / n as f64 };
        track.lay(&road);
        track.ease();
        track.bend()?;
        let tight = track.nodes.iter().any(|node| node.bend.abs() > 1.0 / TIGHTEST);
        if tight || track.touches() {
            return None;
        }
        track.lift();
        Some(track)
    }

    /// Gives each node the curvature and slope of the piece it lies on.
    fn lay(&mut self, road: &[Section]) {
        let (mut piece, mut end) = (0, road[0].length);
        for (i, node) in self.nodes.iter_mut().enumerate() {
            while i as f64 * self.spacing >= end && piece + 1 < road.len() {
                piece += 1;
                end += road[piece].length;
            }
            node.bend = road[piece].bend;
            node.slope = road[piece].climb / road[piece].length;
        }
    }

    /// Lets bends and slopes come and go over some metres, and takes the mean slope away.
    fn ease(&mut self) {
        let n = self.nodes.len();
        let raw = self.nodes.clone();
        let mean = raw.iter().map(|node| node.slope).sum::<f64>() / n as f64;
        for (i, node) in self.nodes.iter_mut().enumerate() {
            let near = || (0..=2 * EASE).map(|k| &raw[(i + n + k - EASE) % n]);
            let share = (2 * EASE + 1) as f64;
            node.bend = near().map(|node| node.bend).sum::<f64>() / share;
            node.slope = near().map(|node| node.slope).sum::<f64>() / share - mean;
        }
    }

    /// Bends the road until its end meets its start: one turn more or less in all, by a constant curvature; then by the first harmonics
    /// b cos + c sin over the lap, found with Newton's method for the two coordinates of the gap.
    fn bend(&mut self) -> Option<()> {
        let n = self.nodes.len();
        let turn: f64 = self.nodes.iter().map(|node| node.bend * self.spacing).sum();
        let more = (TAU.copysign(turn) - turn) / (n as f64 * self.spacing);
        self.nodes.iter_mut().for_each(|node| node.bend += more);
        let waves: Vec<[f64; 2]> = (0..n).map(|i| (TAU * i as f64 / n as f64).sin_cos()).map(|(s, c)| [c, s]).collect();
        for _ in 0..60 {
            let (gap, [by_b, by_c]) = self.trace(&waves);
            if gap[0].abs().max(gap[1].abs()) < 1e-8 {
                return Some(());
            }
            let determinant = by_b[0] * by_c[1] - by_b[1] * by_c[0];
            let step =
                [gap[0] * by_c[1] - gap[1] * by_c[0], by_b[0] * gap[1] - by_b[1] * gap[0]].map(|x| x / determinant);
            // Far from the end of the search a whole step would tie the road into a knot.
            let size = step[0].hypot(step[1]);
            let part = (0.002 / size).min(1.0);
            if !part.is_finite() {
                return None;
            }
            for (node, wave) in self.nodes.iter_mut().zip(&waves) {
                node.bend -= part * (step[0] * wave[0] + step[1] * wave[1]);
            }
        }
        None
    }

    /// Sets places and headings by the curvatures. Returns where the end lies as seen from the start, and how that moves with the weights of
    /// the two `waves` in the curvature.
    fn trace(&mut self, waves: &[[f64; 2]]) -> ([f64; 2], [[f64; 2]; 2]) {
        let n = self.nodes.len();
        let (mut at, mut heading) = ([0.0; 2], 0.0);
        let (mut turned, mut moved) = ([0.0; 2], [[0.0; 2]; 2]);
        for i in 0..n {
            let next = (i + 1) % n;
            (self.nodes[i].at, self.nodes[i].heading) = (at, heading);
            let step = 0.5 * (self.nodes[i].bend + self.nodes[next].bend) * self.spacing;
            let (sin, cos) = (heading + 0.5 * step).sin_cos();
            at = [at[0] + self.spacing * cos, at[1] + self.spacing * sin];
            heading += step;
            for k in 0..2 {
                let step = 0.5 * (waves[i][k] + waves[next][k]) * self.spacing;
                let turn = self.spacing * (turned[k] + 0.5 * step);
                moved[k] = [moved[k][0] - turn * sin, moved[k][1] + turn * cos];
                turned[k] += step;
            }
        }
        (at, moved)
    }

    /// Whether two pieces come too near to each other.
    fn touches(&self) -> bool {
        let n = self.nodes.len();
        // Along the tightest half turn, nodes that are as far apart as roads must be.
        let near = (APART / self.spacing * 2.0).ceil() as usize;
        (0..n).any(|i| {
            let others = (i + near).min(n)..(n + i + 1).saturating_sub(near).min(n);
            let [x, y] = self.nodes[i].at;
            self.nodes[others].iter().any(|node| (node.at[0] - x).powi(2) + (node.at[1] - y).powi(2) < APART * APART)
        })
    }

    /// Sets heights by the slopes.
    fn lift(&mut self) {
        let n = self.nodes.len();
        let mut height = 0.0;
        for i in 0..n {
            self.nodes[i].height = height;
            height += 0.5 * (self.nodes[i].slope + self.nodes[(i + 1) % n].slope) * self.spacing;
        }
    }

    /// The length of a lap, in metres along the centre line.
    pub fn length(&self) -> f64 {
        self.spacing * self.nodes.len() as f64
    }

    /// Metres of road from one node to the next.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The centre line; after the last node comes the first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The centre line `s` metres after the start, between the nodes on either side; any number of laps ahead or back.
    #[inline]
    pub fn at(&self, s: f64) -> Node {
        let n = self.nodes.len();
        let place = s / self.spacing;
        let floor = place.floor();
        let i = floor.rem_euclid(n as f64) as usize % n;
        let (a, b) = (&self.nodes[i], &self.nodes[if i + 1 < n { i + 1 } else { 0 }]);
        let part = place - floor;
        let mix = |a: f64, b: f64| a + part * (b - a);
        let turn = 0.5 * (a.bend + b.bend) * self.spacing;
        Node {
            at: [mix(a.at[0], b.at[0]), mix(a.at[1], b.at[1])],
            height: mix(a.height, b.height),
            heading: a.heading + part * turn,
            bend: mix(a.bend, b.bend),
            slope: mix(a.slope, b.slope),
        }
    }

    /// The same track seen in a mirror: left is right.
    pub fn mirrored(&self) -> Track {
        let mirror = |node: &Node| {
            let [ahead, right] = node.at;
            Node { at: [ahead, -right], heading: -node.heading, bend: -node.bend, ..*node }
        };
        Track { nodes: self.nodes.iter().map(mirror).collect(), spacing: self.spacing }
    }

    /// The left and the right edge of the road at each node, as [`Node::at`]: what a replay draws.
    pub fn outline(&self) -> Vec<[[f64; 2]; 2]> {
        self.nodes.iter().map(|node| [-HALF_WIDTH, HALF_WIDTH].map(|side| node.beside(side))).collect()
    }
}

impl Node {
    /// The place `side` metres to the right of the centre line.
    pub fn beside(&self, side: f64) -> [f64; 2] {
        let (sin, cos) = self.heading.sin_cos();
        [self.at[0] - side * sin, self.at[1] + side * cos]
    }
}
