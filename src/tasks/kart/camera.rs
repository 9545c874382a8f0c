//! What is seen from a kart: a small picture, drawn in software.
//!
//! The eye is above the kart and looks where its nose points, a little down. It sees the road ahead with its kerbs and its broken line, stars
//! and a sky over nothing, and at the bottom the nose of the kart, which swings with the wheels. Surfaces are painted from far to near in 96 by 72
//! points; the mean of 4 by 4 of them, in linear light, is a cell, and a cell's colour is given in CIELAB (white D65), as in footnote 3 of Ross &
//! Bagnell (2010): [`ROWS`] rows of [`COLUMNS`] cells from the top left, of each L/100, a/128 and b/128. L/100 is in [0, 1], the others in [-1, 1].

use super::car::Car;
use super::paint::{Colour, KERB, LINE, NOSE, PLANETS, Paint, Picture, Point, ROADS, STAR};
use super::track::{HALF_WIDTH, Node, Track};
use crate::space::Width;

/// Rows of cells.
pub const ROWS: usize = 18;
/// Cells of a row.
pub const COLUMNS: usize = 24;
/// Numbers of an image.
pub const NUMBERS: usize = 3 * ROWS * COLUMNS;
/// What views of the kart's space share.
pub(super) const WIDTH: Width = Width(NUMBERS);

/// Metres of the eye above the road.
const EYE: f64 = 1.8;
/// How far the eye looks down, in radians.
const DOWN: f64 = 0.12;
/// The distance of the picture, in points: half of it is 48 points wide, which makes 77 degrees in all.
const FOCUS: f32 = 60.0;
/// Nodes behind the kart that are drawn; how many ahead are drawn one by one, and how many at all.
const BEHIND: usize = 4;
const NEAR: usize = 20;
const FAR: usize = 60;
/// Metres of a kerb, and half of the broken line.
const KERB_WIDTH: f32 = 0.6;
const LINE_SIDE: f32 = 0.25;
/// Bodies in the sky, all around: which is what, its height above the horizon in radians, and its radius in points.
const BODIES: [(Colour, f32, f32); 16] = [
    (PLANETS[0], 0.30, 9.0),
    (STAR, 0.40, 1.6),
    (STAR, 0.12, 1.2),
    (PLANETS[1], 0.16, 5.0),
    (STAR, 0.25, 1.6),
    (PLANETS[2], 0.34, 7.0),
    (STAR, 0.10, 1.6),
    (STAR, 0.45, 1.2),
    (PLANETS[3], 0.22, 11.0),
    (STAR, 0.38, 1.6),
    (PLANETS[0], 0.12, 4.0),
    (STAR, 0.28, 1.6),
    (PLANETS[1], 0.40, 8.0),
    (STAR, 0.14, 1.2),
    (PLANETS[2], 0.20, 6.0),
    (STAR, 0.42, 1.6),
];
/// Nodes over which the road keeps its colours.
const PATCH: usize = 12;
/// Points that the tip of the nose swings to either side at full lock.
const SWING: f32 = 14.0;

/// Takes pictures.
#[derive(Clone, Debug, Default)]
pub struct Camera {
    paint: Paint,
}

/// A place as the eye sees it: how far ahead, to the right and above.
type Seen = [f32; 3];

/// A cross-section of the road: its middle, and a metre to the right.
#[derive(Clone, Copy, Default)]
struct Section {
    middle: Seen,
    right: Seen,
}

impl Section {
    fn at(&self, side: f32) -> Seen {
        [0, 1, 2].map(|k| self.middle[k] + side * self.right[k])
    }
}

/// Where the eye is and looks.
struct Eye {
    at: [f64; 2],
    height: f64,
    heading: f64,
    /// Sine and cosine of the heading and of the angle that it looks up.
    turn: (f64, f64),
    pitch: (f64, f64),
}

impl Eye {
    fn of(track: &Track, car: &Car) -> Self {
        let road = track.at(car.distance);
        let heading = road.heading + car.nose;
        let up = (road.slope * car.nose.cos()).atan() - DOWN;
        let height = road.height + EYE;
        Eye { at: road.beside(car.side), height, heading, turn: heading.sin_cos(), pitch: up.sin_cos() }
    }

    fn sees(&self, [x, y, up]: [f64; 3]) -> Seen {
        let ((sin, cos), (tilt, level)) = (self.turn, self.pitch);
        let ahead = x * cos + y * sin;
        [(ahead * level + up * tilt) as f32, (y * cos - x * sin) as f32, (up * level - ahead * tilt) as f32]
    }

    fn section(&self, node: &Node) -> Section {
        let (sin, cos) = node.heading.sin_cos();
        let [x, y] = [node.at[0] - self.at[0], node.at[1] - self.at[1]];
        Section { middle: self.sees([x, y, node.height - self.height]), right: self.sees([-sin, cos, 0.0]) }
    }
}

impl Camera {
    /// Writes the picture of what is seen from `car` into `cells`.
    pub fn shoot(&self, track: &Track, car: &Car, cells: &mut [f32; NUMBERS]) {
        let eye = Eye::of(track, car);
        let mut picture = Picture::new(Picture::middle()[1] + FOCUS * (eye.pitch.0 / eye.pitch.1) as f32);
        sky(&mut picture, &eye);
        road(&mut picture, &eye, track, car.distance);
        nose(&mut picture, car.wheel as f32);
        self.paint.develop(&picture, cells);
    }
}

/// Bodies stand at equal distances from where the start looks to its back, alike to the left and to the right.
fn sky(picture: &mut Picture, eye: &Eye) {
    let [x, y] = Picture::middle();
    let (tilt, level) = (eye.pitch.0 as f32, eye.pitch.1 as f32);
    for (i, (colour, up, radius)) in BODIES.into_iter().enumerate() {
        let bearing = std::f64::consts::PI * i as f64 / BODIES.len() as f64;
        for bearing in [bearing, -bearing] {
            let (sin, cos) = (bearing - eye.heading).sin_cos();
            let (sin, cos) = (sin as f32, cos as f32);
            let depth = cos * level + up * tilt;
            if depth > 0.5 {
                let at = [x + FOCUS * sin / depth, y - FOCUS * (up * level - cos * tilt) / depth];
                picture.disc(at, radius, colour);
            }
        }
    }
}

fn road(picture: &mut Picture, eye: &Eye, track: &Track, distance: f64) {
    let (n, nodes) = (track.nodes().len(), track.nodes());
    let here = (distance / track.spacing()).floor().rem_euclid(n as f64) as usize;
    let (behind, near, far) = (here + n - BEHIND, (here + n + NEAR).next_multiple_of(2), here + n + FAR);
    let section = |i: usize| eye.section(&nodes[i % n]);
    let mut beyond = section(far.next_multiple_of(2));
    // Far away the two nodes of a band are painted as one.
    for i in (near..far).rev().filter(|i| i % 2 == 0).chain((behind..near).rev()) {
        let before = section(i);
        strip(picture, [before, beyond], i % n);
        beyond = before;
    }
}

/// The road from the cross-section at `node` to the next.
fn strip(picture: &mut Picture, [near, far]: [Section; 2], node: usize) {
    let mut surface = |left: f32, right: f32, colour| {
        let corners = [near.at(left), near.at(right), far.at(right), far.at(left)];
        picture.fill(&clip(&corners), colour);
    };
    let (edge, band) = (HALF_WIDTH as f32, node / 2 % 2);
    let road = ROADS[2 * (node / PATCH) % ROADS.len()];
    surface(-edge, edge, KERB[band]);
    surface(KERB_WIDTH - edge, edge - KERB_WIDTH, road[band]);
    if band == 0 {
        surface(-LINE_SIDE, LINE_SIDE, LINE);
    }
}

/// A polygon in the picture: four corners, and at most two more where something of it is cut off.
#[derive(Default)]
pub(super) struct Polygon {
    corners: [Point; 6],
    count: usize,
}

impl Polygon {
    pub(super) fn corners(&self) -> &[Point] {
        &self.corners[..self.count]
    }

    fn push(&mut self, [depth, right, up]: Seen) {
        let [x, y] = Picture::middle();
        self.corners[self.count] = [x + FOCUS * right / depth, y - FOCUS * up / depth];
        self.count += 1;
    }
}

/// What of a convex quadrangle is ahead of the eye, in the picture.
fn clip(corners: &[Seen; 4]) -> Polygon {
    const FRONT: f32 = 0.4;
    let mut polygon = Polygon::default();
    for (i, here) in corners.iter().enumerate() {
        let next = &corners[(i + 1) % 4];
        if here[0] >= FRONT {
            polygon.push(*here);
        }
        if (here[0] >= FRONT) != (next[0] >= FRONT) {
            let part = (FRONT - here[0]) / (next[0] - here[0]);
            polygon.push([FRONT, here[1] + part * (next[1] - here[1]), here[2] + part * (next[2] - here[2])]);
        }
    }
    polygon
}

fn nose(picture: &mut Picture, wheel: f32) {
    let [x, bottom] = [Picture::middle()[0], 2.0 * Picture::middle()[1]];
    let tip = x + SWING * wheel;
    let top = bottom - 10.0;
    let corners = [[x - 16.0, bottom], [x + 16.0, bottom], [tip + 5.0, top], [tip - 5.0, top], [0.0; 2], [0.0; 2]];
    picture.fill(&Polygon { corners, count: 4 }, NOSE);
}
