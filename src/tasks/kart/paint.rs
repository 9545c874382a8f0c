//! Colours, and the points that are painted with them.

use super::camera::{COLUMNS, NUMBERS, Polygon, ROWS};

/// Points of a cell, each way.
const FINE: usize = 4;
const WIDE: usize = FINE * COLUMNS;
const HIGH: usize = FINE * ROWS;

/// A place in a picture, in points from the top left: right and down. Point i reaches from i to i + 1.
pub(super) type Point = [f32; 2];

/// The number of a colour.
pub(super) type Colour = u8;

/// Nothing below the horizon: further down and nearer to it; the sky from there to the top.
const VOID: [Colour; 2] = [0, 1];
const SKY: [Colour; 3] = [2, 3, 4];
/// Bodies in the sky.
pub(super) const STAR: Colour = 5;
pub(super) const PLANETS: [Colour; 4] = [6, 7, 8, 9];
/// The two bands of the road's kerbs, and its broken line.
pub(super) const KERB: [Colour; 2] = [10, 11];
pub(super) const LINE: Colour = 12;
/// The kart's own nose.
pub(super) const NOSE: Colour = 13;
/// The two bands of the road's surface, in its different colours.
pub(super) const ROADS: [[Colour; 2]; 5] = [[14, 15], [16, 17], [18, 19], [20, 21], [22, 23]];

/// Red, green and blue of each colour, in sRGB.
const PALETTE: [[u8; 3]; 24] = [
    [6, 6, 18],
    [14, 14, 40],
    [70, 48, 120],
    [40, 30, 88],
    [18, 14, 52],
    [230, 230, 200],
    [196, 128, 72],
    [88, 160, 184],
    [176, 80, 120],
    [120, 176, 96],
    [200, 40, 36],
    [226, 226, 226],
    [232, 208, 90],
    [40, 120, 200],
    [92, 92, 98],
    [112, 112, 118],
    [124, 84, 72],
    [142, 100, 86],
    [70, 96, 122],
    [88, 114, 140],
    [84, 108, 78],
    [100, 126, 92],
    [112, 84, 124],
    [130, 100, 142],
];

/// The colours as cells have them.
#[derive(Clone, Debug)]
pub(super) struct Paint {
    /// Red, green and blue in linear light, over the number of points of a cell.
    light: [[f32; 3]; PALETTE.len()],
    /// The three numbers of a cell that is all of one colour.
    whole: [[f32; 3]; PALETTE.len()],
    roots: Roots,
}

impl Default for Paint {
    fn default() -> Self {
        let linear = |c: u8| {
            let c = f32::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        let light = PALETTE.map(|colour| colour.map(linear));
        let roots = Roots::default();
        let whole = light.map(|colour| lab(colour, &roots));
        Paint { light: light.map(|colour| colour.map(|c| c / (FINE * FINE) as f32)), whole, roots }
    }
}

/// The function f of CIELAB, about the cube root, at equal distances from 0 to 1: between them, a line is off by less than 0.00001, and a cube root
/// takes as long as all the painting of a cell.
#[derive(Clone, Debug)]
struct Roots(Vec<f32>);

/// Distances between the places at which f is kept.
const PARTS: usize = 4096;

impl Default for Roots {
    fn default() -> Self {
        let f = |t: f64| if t > 216.0 / 24389.0 { t.cbrt() } else { (24389.0 / 27.0 * t + 16.0) / 116.0 };
        Roots((0..=PARTS + 1).map(|i| f(i as f64 / PARTS as f64) as f32).collect())
    }
}

impl Roots {
    /// f of a number from 0 to 1.
    #[inline]
    fn of(&self, t: f32) -> f32 {
        let place = t.clamp(0.0, 1.0) * PARTS as f32;
        let below = place as u32 as usize;
        self.0[below] + (place - below as f32) * (self.0[below + 1] - self.0[below])
    }
}

/// L/100, a/128 and b/128 of a colour in linear light, by the sRGB primaries and white D65 (IEC 61966-2-1, CIE 15).
fn lab([r, g, b]: [f32; 3], roots: &Roots) -> [f32; 3] {
    // Over the white's own X, Y and Z.
    let x = 0.433_953 * r + 0.376_220 * g + 0.189_828 * b;
    let y = 0.212_671 * r + 0.715_160 * g + 0.072_169 * b;
    let z = 0.017_758 * r + 0.109_477 * g + 0.872_765 * b;
    let [x, y, z] = [x, y, z].map(|t| roots.of(t));
    [1.16 * y - 0.16, 500.0 / 128.0 * (x - y), 200.0 / 128.0 * (y - z)]
}

/// Points before they are made into cells.
pub(super) struct Picture {
    points: [[Colour; WIDE]; HIGH],
    /// Scratch: where the polygon at hand begins and ends in each row.
    spans: [[f32; 2]; HIGH],
}

impl Picture {
    /// The sky down to `horizon`, in points from the top, and nothing below.
    pub(super) fn new(horizon: f32) -> Self {
        let mut points = [[0; WIDE]; HIGH];
        for (row, points) in points.iter_mut().enumerate() {
            let above = horizon - row as f32 - 0.5;
            let colour = match above {
                above if above > 20.0 => SKY[2],
                above if above > 8.0 => SKY[1],
                above if above > 0.0 => SKY[0],
                above if above > -8.0 => VOID[1],
                _ => VOID[0],
            };
            points.fill(colour);
        }
        Picture { points, spans: [[0.0; 2]; HIGH] }
    }

    /// Its middle.
    pub(super) fn middle() -> Point {
        [WIDE as f32 / 2.0, HIGH as f32 / 2.0]
    }

    /// Paints a disc.
    pub(super) fn disc(&mut self, [x, y]: Point, radius: f32, colour: Colour) {
        let (from, to) = (sample(y - radius, HIGH), sample(y + radius, HIGH));
        for (row, points) in self.points[..to].iter_mut().enumerate().skip(from) {
            let down = row as f32 + 0.5 - y;
            let half = (radius * radius - down * down).max(0.0).sqrt();
            points[sample(x - half, WIDE)..sample(x + half, WIDE)].fill(colour);
        }
    }

    /// Paints a convex polygon: all points whose middle is inside, if its front is seen.
    pub(super) fn fill(&mut self, polygon: &Polygon, colour: Colour) {
        let corners = polygon.corners();
        let (mut top, mut bottom, mut area) = (f32::INFINITY, f32::NEG_INFINITY, 0.0);
        let mut last = match corners.last() {
            Some(last) => *last,
            None => return,
        };
        for here in corners {
            top = top.min(here[1]);
            bottom = bottom.max(here[1]);
            area += last[0] * here[1] - here[0] * last[1];
            last = *here;
        }
        let (from, to) = (sample(top, HIGH), sample(bottom, HIGH));
        if from >= to || area >= 0.0 {
            return;
        }
        self.spans[from..to].fill([f32::INFINITY, f32::NEG_INFINITY]);
        for here in corners {
            let (upper, lower) = if last[1] < here[1] { (&last, here) } else { (here, &last) };
            let (first, end) = (sample(upper[1], HIGH), sample(lower[1], HIGH));
            let slant = (lower[0] - upper[0]) / (lower[1] - upper[1]);
            for (row, span) in self.spans[first..end.max(first)].iter_mut().enumerate() {
                let x = upper[0] + slant * ((first + row) as f32 + 0.5 - upper[1]);
                *span = [span[0].min(x), span[1].max(x)];
            }
            last = *here;
        }
        for (row, [left, right]) in self.points[from..to].iter_mut().zip(&self.spans[from..to]) {
            let (left, right) = (sample(*left, WIDE), sample(*right, WIDE));
            row[left..right.max(left)].fill(colour);
        }
    }
}

/// The first of `count` points whose middle is behind `place`.
#[inline]
fn sample(place: f32, count: usize) -> usize {
    ((place + 0.5).max(0.0) as i32 as usize).min(count)
}

impl Paint {
    /// Makes cells of points.
    pub(super) fn develop(&self, picture: &Picture, cells: &mut [f32; NUMBERS]) {
        for (row, cells) in cells.chunks_exact_mut(3 * COLUMNS).enumerate() {
            let points: &[[Colour; WIDE]] = &picture.points[FINE * row..FINE * (row + 1)];
            for (column, cell) in cells.chunks_exact_mut(3).enumerate() {
                let mut lines = [[0; FINE]; FINE];
                lines
                    .iter_mut()
                    .zip(points)
                    .for_each(|(line, row)| line.copy_from_slice(&row[FINE * column..][..FINE]));
                let first = lines[0][0];
                // Most cells are of one colour.
                let colour = if lines == [[first; FINE]; FINE] {
                    self.whole[usize::from(first)]
                } else {
                    let mut light = [0.0; 3];
                    for point in lines.as_flattened() {
                        let more = self.light[usize::from(*point)];
                        light = [light[0] + more[0], light[1] + more[1], light[2] + more[2]];
                    }
                    lab(light, &self.roots)
                };
                cell.copy_from_slice(&colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Colours whose CIELAB is known: white, black, and the three primaries of sRGB.
    #[test]
    fn colours_are_those_of_the_standard() {
        for (rgb, expected) in [
            ([1.0, 1.0, 1.0], [100.0, 0.0, 0.0]),
            ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
            ([1.0, 0.0, 0.0], [53.24, 80.09, 67.20]),
            ([0.0, 1.0, 0.0], [87.73, -86.18, 83.18]),
            ([0.0, 0.0, 1.0], [32.30, 79.19, -107.86]),
        ] {
            let [l, a, b] = lab(rgb, &Roots::default());
            for (found, expected) in [100.0 * l, 128.0 * a, 128.0 * b].iter().zip(expected) {
                assert!((found - expected).abs() < 0.05, "{rgb:?}: {found} and not {expected}");
            }
        }
    }

    #[test]
    fn kept_roots_are_near_the_true_ones() {
        let roots = Roots::default();
        for i in 0..=100_000 {
            let t = i as f32 / 100_000.0;
            let f = if t > 216.0 / 24389.0 { t.cbrt() } else { (24389.0 / 27.0 * t + 16.0) / 116.0 };
            assert!((roots.of(t) - f).abs() < 1e-5, "{t}");
        }
    }
}
