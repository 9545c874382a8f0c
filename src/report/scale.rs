//! Linear and logarithmic scales.

/// Beyond this nothing is drawn: differences must stay finite.
const MOST: f64 = 1e200;

/// A range of numbers with its marks.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Where it begins and ends, as far along as a number is: itself, or its logarithm.
    ends: [f64; 2],
    log: bool,
    /// The numbers at its marks, ascending; the first and the last are its ends.
    pub marks: Vec<f64>,
}

impl Scale {
    /// A linear scale that holds all of `values`; those that are not finite count nothing.
    pub fn linear(values: impl Iterator<Item = f64>) -> Self {
        let mut whole = true;
        let drawn = values.filter(|x| x.abs() < MOST).inspect(|x| whole &= x.fract() == 0.0);
        let found = range(drawn);
        let (mut low, mut high) = found.unwrap_or((0.0, 1.0));
        let size = low.abs().max(high.abs());
        // Numbers that differ by rounding only are one.
        if high - low <= 1e-9 * size || size < 1.0 / MOST {
            let room = if size < 1.0 / MOST { 1.0 } else { size / 2.0 };
            (low, high) = (low - room, high + room);
        }
        let step = match nice((high - low) / 5.0) {
            // Half a round means nothing.
            step if whole && found.is_some() => {
                if step == 2.5 {
                    5.0
                } else {
                    step.max(1.0)
                }
            }
            step => step,
        };
        let (first, last) = ((low / step).floor(), (high / step).ceil());
        let marks: Vec<f64> = (0..=(last - first) as usize).map(|i| (first + i as f64) * step).collect();
        Scale { ends: [first * step, last * step], log: false, marks }
    }

    /// A logarithmic scale that holds those of `values` that are above 0, if there are any.
    pub fn log(values: impl Iterator<Item = f64>) -> Option<Self> {
        let (low, high) = range(values.filter(|x| (1.0 / MOST..MOST).contains(x)))?;
        let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
        let digits: &[f64] = match last - first {
            ..=2 => &[1.0, 2.0, 5.0],
            3 => &[1.0, 3.0],
            _ => &[1.0],
        };
        let all = (first..=last).flat_map(|power| digits.iter().map(move |digit| digit * 10f64.powi(power)));
        let all: Vec<f64> = all.collect();
        // Half a mark of room for numbers that were rounded.
        let start = all.iter().rposition(|mark| *mark <= low * (1.0 + 1e-12)).unwrap_or(0);
        let end = all.iter().position(|mark| *mark >= high * (1.0 - 1e-12)).unwrap_or(all.len() - 1);
        let (start, end) =
            if start < end { (start, end) } else { (start.saturating_sub(1), (end + 1).min(all.len() - 1)) };
        let every = (end - start).div_ceil(8).max(1);
        // Counted from the upper end, so that both ends are marks.
        let start = end - (end - start).div_ceil(every).min(end / every) * every;
        let marks: Vec<f64> = all[start..=end].iter().copied().step_by(every).collect();
        Some(Scale { ends: [marks[0].min(low).log10(), all[end].log10()], log: true, marks })
    }

    /// How far along `value` is, from 0 to 1 for what the scale holds; nothing where it has no place.
    pub fn place(&self, value: f64) -> Option<f64> {
        let along = if self.log { value.log10() } else { value };
        let place = (along - self.ends[0]) / (self.ends[1] - self.ends[0]);
        (place.is_finite() && (!self.log || value > 0.0)).then_some(place)
    }
}

fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let wider = |range: Option<(f64, f64)>, x: f64| Some(range.map_or((x, x), |(low, high)| (low.min(x), high.max(x))));
    values.fold(None, wider)
}

/// The least of 1, 2, 2.5, 5 times a power of ten that is not below `step`.
fn nice(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let digit = [1.0, 2.0, 2.5, 5.0].into_iter().find(|digit| digit * power >= step * (1.0 - 1e-9));
    digit.unwrap_or(10.0) * power
}

/// A mark's number in few characters: 0.05, 2500, 10k, 2.5M, 1e-6.
pub fn short(value: f64) -> String {
    let plain = |x: f64| {
        let text = format!("{x:.6}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    };
    match value.abs() {
        0.0 => "0".to_owned(),
        x if x < 1e-4 => format!("{value:.0e}"),
        x if x < 1e4 => plain(value),
        x if x < 1e6 => plain(value / 1e3) + "k",
        x if x < 1e9 => plain(value / 1e6) + "M",
        x if x < 1e12 => plain(value / 1e9) + "G",
        _ => format!("{value:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn marks_by_hand() {
        let marks = |values: &[f64]| Scale::linear(values.iter().copied()).marks;
        assert_eq!(marks(&[0.0, 10.0]), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(marks(&[3.0, 3.0]), [1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(marks(&[]), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        let log = |values: &[f64]| Scale::log(values.iter().copied()).expect("above 0").marks;
        assert_eq!(log(&[0.0, 1.0, 10.0]), [1.0, 2.0, 5.0, 10.0]);
        assert_eq!(log(&[7.0, 30_000.0]), [1.0, 10.0, 100.0, 1000.0, 10_000.0, 100_000.0]);
        assert_eq!(Scale::log([0.0, -1.0, f64::NAN].into_iter()), None);
        assert_eq!([0.05, 2500.0, 10_000.0, 2.5e6, 1e-6, 0.0].map(short), ["0.05", "2500", "10k", "2.5M", "1e-6", "0"]);
    }

    proptest! {
        /// Whatever there is to be drawn has its place, in its order, on a handful of marks.
        #[test]
        fn all_have_their_places(values in prop::collection::vec(prop_oneof![any::<f64>(), -1e3..1e3, 1e-9..1e-3], 1..20)) {
            let values: Vec<f64> = values.into_iter().filter(|x| x.abs() < 1e150 && (*x == 0.0 || x.abs() > 1e-150)).collect();
            let linear = Scale::linear(values.iter().copied());
            prop_assert!((2..=12).contains(&linear.marks.len()), "{linear:?}");
            for x in &values {
                let place = linear.place(*x).expect("finite");
                prop_assert!((-1e-6..=1.0 + 1e-6).contains(&place), "{x} at {place} of {linear:?}");
            }
            let above: Vec<f64> = values.iter().copied().filter(|x| *x > 0.0).collect();
            match Scale::log(values.iter().copied()) {
                None => prop_assert!(above.is_empty()),
                Some(log) => {
                    prop_assert!((2..=12).contains(&log.marks.len()), "{log:?}");
                    for x in above {
                        let place = log.place(x).expect("above 0");
                        prop_assert!((-1e-6..=1.0 + 1e-6).contains(&place), "{x} at {place} of {log:?}");
                    }
                    prop_assert_eq!(log.place(0.0), None);
                }
            }
        }
    }
}
