//! Numbers against numbers.

use super::markup::{clipped, escaped, width};
use super::scale::{Scale, short};
use super::table::Table;
use std::fmt::Write;

/// The style of all figures, in pages and in files of their own.
pub(super) const STYLE: &str = include_str!("chart.css");

/// An axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// What stands along it, and in which unit.
    pub name: String,
    /// Whether it is logarithmic at first, where anything is above 0.
    pub log: bool,
}

impl Axis {
    /// A linear axis.
    pub fn linear(name: impl Into<String>) -> Self {
        Axis { name: name.into(), log: false }
    }

    /// A logarithmic axis.
    pub fn log(name: impl Into<String>) -> Self {
        Axis { name: name.into(), log: true }
    }
}

/// One pair of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dot {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical axis.
    pub y: f64,
    /// The ends of y's interval, where one is known.
    pub interval: Option<[f64; 2]>,
    /// What it is, beyond its series; may be empty.
    pub name: String,
}

/// Pairs of numbers that belong together.
#[derive(Clone, Debug, PartialEq)]
pub enum Series {
    /// Marks only.
    Dots(String, Vec<Dot>),
    /// Marks, one joined to the next.
    Line(String, Vec<Dot>),
    /// A dashed line without marks, to hold the others against: `y = x`, or a number that cannot be passed. It has no row in the table.
    Level(String, Vec<Dot>),
}

impl Series {
    fn parts(&self) -> (&str, &[Dot]) {
        match self {
            Series::Dots(name, dots) | Series::Line(name, dots) | Series::Level(name, dots) => (name, dots),
        }
    }

    /// The line `y = x` from the least to the largest x of what `series` hold.
    pub fn diagonal(name: &str, series: &[Series]) -> Self {
        let all = || series.iter().flat_map(|one| one.parts().1).map(|dot| dot.x).filter(|x| x.is_finite());
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let least = all().filter(|x| *x > 0.0).fold(f64::INFINITY, f64::min);
        let mut ends: Vec<f64> = [low, high].into_iter().filter(|x| x.is_finite()).collect();
        if least.is_finite() && least > 0.0 {
            // Straight on two linear axes and on two logarithmic ones; on one of each it is a curve, through these.
            ends.extend((1..=32).map(|i| least * (high / least).powf(f64::from(i) / 32.0)).chain([least]));
        }
        ends.sort_by(f64::total_cmp);
        Series::Level(name.to_owned(), ends.into_iter().map(|x| Dot { x, y: x, ..Dot::default() }).collect())
    }

    /// The line at height `y` over what `series` hold.
    pub fn level(name: &str, y: f64, series: &[Series]) -> Self {
        let all = || series.iter().flat_map(|one| one.parts().1).map(|dot| dot.x).filter(|x| x.is_finite());
        let least = all().filter(|x| *x > 0.0).fold(f64::INFINITY, f64::min);
        let ends = [all().fold(f64::INFINITY, f64::min), least, all().fold(f64::NEG_INFINITY, f64::max)];
        let dots = ends.into_iter().filter(|x| x.is_finite()).map(|x| Dot { x, y, ..Dot::default() });
        Series::Level(name.to_owned(), dots.collect())
    }
}

/// A plot of series over two axes, each of which can be linear or logarithmic: numbers that are not above 0 have no place on the latter, numbers that
/// are not finite nowhere.
///
/// ```
/// use rollin::report::{Axis, Dot, Plot, Series};
///
/// let dots = (1..4).map(|n| Dot { x: n as f64, y: (n * n) as f64, ..Dot::default() }).collect();
/// let plot = Plot { x: Axis::linear("n"), y: Axis::log("n squared"), series: vec![Series::Line("squares".into(), dots)] };
/// assert!(plot.svg().contains("<title>squares: n 3, n squared 9</title>"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn.
    pub series: Vec<Series>,
}

/// The figure's width, and where its frame begins and ends, in the figure's units.
const WIDTH: f64 = 560.0;
const LEFT: f64 = 76.0;
const RIGHT: f64 = 536.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 316.0;
/// The height of a row of the legend, and where the first one stands.
const ROW: f64 = 22.0;
const LEGEND: f64 = BOTTOM + 66.0;

/// How many colours and shapes of marks there are.
const COLOURS: usize = 10;
const SHAPES: [&str; 5] = [
    "M-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0-9 0",
    "M-4-4h8v8h-8z",
    "M0-5.5L5 4H-5z",
    "M0-5.8L5.8 0L0 5.8L-5.8 0z",
    "M0 5.5L5-4H-5z",
];

/// An axis with both its scales.
struct Ruler {
    /// Linear, and logarithmic where there is anything above 0.
    scales: [Option<Scale>; 2],
    /// The one that is seen at first.
    first: usize,
    /// From where to where it reaches.
    ends: [f64; 2],
}

impl Ruler {
    fn new(axis: &Axis, values: &[f64], ends: [f64; 2]) -> Self {
        let scales = [Some(Scale::linear(values.iter().copied())), Scale::log(values.iter().copied())];
        let first = usize::from(axis.log && scales[1].is_some());
        Ruler { scales, first, ends }
    }

    /// Where `value` stands on the linear and on the logarithmic scale.
    fn places(&self, value: f64) -> [Option<f64>; 2] {
        let [from, to] = self.ends;
        let at = |scale: &Option<Scale>| Some(from + (to - from) * scale.as_ref()?.place(value)?);
        [at(&self.scales[0]), at(&self.scales[1])].map(|place| place.map(|p| (10.0 * p).round() / 10.0))
    }

    /// The same, but what lies below a scale stands at its lower end.
    fn low(&self, value: f64) -> [Option<f64>; 2] {
        self.places(value).map(|place| Some(place.unwrap_or(self.ends[0])))
    }
}

/// Places on both scales as lists for the script: `-` for none.
fn lists(out: &mut String, name: &str, places: &[[Option<f64>; 2]]) {
    for scale in 0..2 {
        let text = |place: &[Option<f64>; 2]| place[scale].map_or("-".to_owned(), |p| p.to_string());
        let all: Vec<String> = places.iter().map(text).collect();
        let _ = write!(out, " data-{name}{scale}=\"{}\"", all.join(" "));
    }
}

impl Plot {
    /// The plot as an SVG element with a legend. Each group `series` has its dots' places on both scales in `data-x0`, `data-x1` and so on.
    pub fn svg(&self) -> String {
        let dots = || self.series.iter().flat_map(|series| series.parts().1);
        let across: Vec<f64> = dots().map(|dot| dot.x).collect();
        let up: Vec<f64> =
            dots().flat_map(|dot| [dot.y].into_iter().chain(dot.interval.into_iter().flatten())).collect();
        let (x, y) = (Ruler::new(&self.x, &across, [LEFT, RIGHT]), Ruler::new(&self.y, &up, [BOTTOM, TOP]));
        let keys = self.keys();
        let height = keys.last().map_or(LEGEND, |(_, _, y)| y + ROW) - ROW / 2.0;
        let mut out = format!(
            "<svg class=\"chart plot\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" \
             aria-label=\"{} against {}\" data-x=\"{}\" data-y=\"{}\" data-bottom=\"{BOTTOM}\">\n",
            escaped(&self.y.name),
            escaped(&self.x.name),
            x.first,
            y.first
        );
        axes(&mut out, &x, &y);
        let (middle, centre) = ((LEFT + RIGHT) / 2.0, (TOP + BOTTOM) / 2.0);
        let _ = writeln!(
            out,
            "<text class=\"title\" x=\"{middle}\" y=\"{}\">{}</text>\n<text class=\"title\" transform=\"translate(14 {centre}) rotate(-90)\">{}</text>",
            BOTTOM + 41.0,
            clipped(&self.x.name, 60),
            clipped(&self.y.name, 38)
        );
        for (i, series) in self.series.iter().enumerate() {
            self.draw(&mut out, i, series, (&x, &y));
        }
        for (i, (series, (name, left, top))) in self.series.iter().zip(&keys).enumerate() {
            let _ = write!(
                out,
                "<g class=\"key {}\" data-series=\"{i}\" transform=\"translate({left} {top})\">",
                class(i, series)
            );
            let _ = match series {
                Series::Level(..) => write!(out, "<path class=\"line\" d=\"M-8 -4h16\"/>"),
                _ => write!(
                    out,
                    "<path class=\"swatch\" transform=\"translate(0 -4)\" d=\"{}\"/>",
                    SHAPES[i % SHAPES.len()]
                ),
            };
            let _ = writeln!(out, "<text x=\"12\">{name}</text></g>");
        }
        out + "</svg>\n"
    }

    /// The names in the legend, cut to what fits, and where they stand.
    fn keys(&self) -> Vec<(String, f64, f64)> {
        let (mut left, mut top) = (16.0, LEGEND);
        let mut place = |series: &Series| {
            let name: String = series.parts().0.chars().take(64).collect();
            let wide = width(&name) + 34.0;
            if left + wide > WIDTH && left > 16.0 {
                (left, top) = (16.0, top + ROW);
            }
            let key = (clipped(series.parts().0, 64), left, top);
            left += wide;
            key
        };
        self.series.iter().map(&mut place).collect()
    }

    /// Draws one series as it is seen at first.
    fn draw(&self, out: &mut String, i: usize, series: &Series, (x, y): (&Ruler, &Ruler)) {
        let (name, dots) = series.parts();
        let xs: Vec<_> = dots.iter().map(|dot| x.places(dot.x)).collect();
        let ys: Vec<_> = dots.iter().map(|dot| y.places(dot.y)).collect();
        let _ = write!(out, "<g class=\"series {}\" data-series=\"{i}\"", class(i, series));
        lists(out, "x", &xs);
        lists(out, "y", &ys);
        let intervals = dots.iter().any(|dot| dot.interval.is_some());
        let end = |e: usize| {
            dots.iter().map(move |dot| dot.interval.map_or([None; 2], |ends| y.low(ends[e]))).collect::<Vec<_>>()
        };
        let (lows, highs) = (end(0), end(1));
        if intervals {
            lists(out, "low", &lows);
            lists(out, "high", &highs);
        }
        out.push_str(">\n");
        let at = |d: usize| Some((xs[d][x.first]?, ys[d][y.first]?));
        if !matches!(series, Series::Dots(..)) {
            let line: Vec<String> = (0..dots.len()).filter_map(at).map(|(x, y)| format!("{x},{y}")).collect();
            let _ = writeln!(out, "<polyline class=\"line\" points=\"{}\"/>", line.join(" "));
        }
        if intervals {
            let stroke = |d: usize| Some(format!("M{} {}V{}", at(d)?.0, lows[d][y.first]?, highs[d][y.first]?));
            let strokes: String = (0..dots.len()).filter_map(stroke).collect();
            let _ = writeln!(out, "<path class=\"interval\" d=\"{strokes}\"/>");
        }
        if !matches!(series, Series::Level(..)) {
            for (d, dot) in dots.iter().enumerate() {
                let place = at(d).map_or("class=\"mark off\"".to_owned(), |(x, y)| {
                    format!("class=\"mark\" transform=\"translate({x} {y})\"")
                });
                let told = escaped(&self.told(name, dot));
                let _ = writeln!(out, "<path {place} d=\"{}\"><title>{told}</title></path>", SHAPES[i % SHAPES.len()]);
            }
        }
        out.push_str("</g>\n");
    }

    /// A dot in words.
    fn told(&self, series: &str, dot: &Dot) -> String {
        let name = if dot.name.is_empty() { String::new() } else { format!(", {}", dot.name) };
        let interval = dot.interval.map_or(String::new(), |[low, high]| format!(" ({low} to {high})"));
        format!("{series}{name}: {} {}, {} {}{interval}", self.x.name, dot.x, self.y.name, dot.y)
    }

    /// All numbers, a row a dot.
    pub fn table(&self) -> Table {
        let drawn = || self.series.iter().filter(|series| !matches!(series, Series::Level(..))).map(Series::parts);
        let any = |of: &dyn Fn(&Dot) -> bool| drawn().any(|(_, dots)| dots.iter().any(of));
        let (named, sure) = (any(&|dot| !dot.name.is_empty()), any(&|dot| dot.interval.is_some()));
        let mut headings = vec!["series".to_owned()];
        headings.extend(named.then(String::new));
        headings.extend([self.x.name.clone(), self.y.name.clone()]);
        headings.extend(sure.then(|| ["from", "to"].map(str::to_owned)).into_iter().flatten());
        let mut table = Table::new(headings);
        for (name, dot) in drawn().flat_map(|(name, dots)| dots.iter().map(move |dot| (name, dot))) {
            let mut cells = vec![name.to_owned()];
            cells.extend(named.then(|| dot.name.clone()));
            cells.extend([dot.x, dot.y].map(|x| x.to_string()));
            let ends = dot.interval.map_or(["-".to_owned(), "-".to_owned()], |ends| ends.map(|x| x.to_string()));
            cells.extend(sure.then_some(ends).into_iter().flatten());
            table.row(cells);
        }
        table
    }
}

impl Plot {
    /// The same with at most about so many dots, those of each series evenly, its first and its last among them; nothing if there are not more.
    pub(super) fn thinned(&self, most: usize) -> Option<Plot> {
        let count: usize = self.series.iter().map(|series| series.parts().1.len()).sum();
        if count <= most {
            return None;
        }
        let each = (most / self.series.len().max(1)).max(2);
        let thin = |dots: &[Dot]| evenly(dots.len(), each).into_iter().map(|i| dots[i].clone()).collect();
        let series = self.series.iter().map(|series| match series {
            Series::Dots(name, dots) => Series::Dots(name.clone(), thin(dots)),
            Series::Line(name, dots) => Series::Line(name.clone(), thin(dots)),
            level => level.clone(),
        });
        Some(Plot { series: series.collect(), ..self.clone() })
    }
}

/// At most `most` of the numbers below `count`, evenly: the first and the last among them, if `most` is at least 2.
pub fn evenly(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let steps = most.saturating_sub(1).max(1);
    (0..most).map(|i| (i * (count - 1) + steps / 2) / steps).collect()
}

/// A series' colour.
fn class(i: usize, series: &Series) -> String {
    if let Series::Level(..) = series { "level".to_owned() } else { format!("s{}", i % COLOURS) }
}

/// The frame, and the marks of both scales of both axes, of which one each is seen.
fn axes(out: &mut String, x: &Ruler, y: &Ruler) {
    for (name, ruler) in [("x", x), ("y", y)] {
        for (kind, scale) in ruler.scales.iter().enumerate() {
            let Some(scale) = scale else { continue };
            let off = if kind == ruler.first { "" } else { " off" };
            let _ = writeln!(out, "<g class=\"axis {name}{off}\" data-scale=\"{kind}\">");
            for mark in &scale.marks {
                let Some(at) = ruler.places(*mark)[kind] else { continue };
                let (grid, text) = match name {
                    "x" => (format!("M{at} {TOP}V{BOTTOM}"), format!("x=\"{at}\" y=\"{}\"", BOTTOM + 18.0)),
                    _ => (format!("M{LEFT} {at}H{RIGHT}"), format!("x=\"{}\" y=\"{}\"", LEFT - 7.0, at + 5.0)),
                };
                let _ = writeln!(out, "<path class=\"grid\" d=\"{grid}\"/><text {text}>{}</text>", short(*mark));
            }
            out.push_str("</g>\n");
        }
    }
    let _ = writeln!(out, "<path class=\"frame\" d=\"M{LEFT} {TOP}V{BOTTOM}H{RIGHT}\"/>");
}
