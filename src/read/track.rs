//! Reader of track grammars: [grammars](super::grammar) whose words are pieces of a road.
//!
//! ```text
//! straight-60                # 60 m ahead
//! left-90-25                 # a bend to the left by 90 degrees, with a radius of 25 m
//! right-45-40-up-3           # to the right, climbing 3 m
//! straight-80-down-6         # falling 6 m
//! ```
//!
//! All numbers are whole. What a sentence of such words makes is told in [`kart`](crate::tasks::kart).

use super::grammar::{Item, Name, Tree, Weighted};
use crate::error::{Error, Result};
use nom::branch::alt;
use nom::bytes::complete::tag;
use nom::character::complete::digit1;
use nom::combinator::{eof, map_res, opt, value};
use nom::sequence::{preceded, terminated};
use nom::{IResult, Parser};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// A piece of a road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// How long it is, in metres.
    pub length: f64,
    /// Its curvature in 1/m: one over the radius, positive to the right, 0 for a straight.
    pub bend: f64,
    /// How many metres it climbs; negative when it falls.
    pub climb: f64,
}

/// Metres of a straight.
pub const LENGTHS: RangeInclusive<u32> = 1..=1000;
/// Degrees of a bend.
pub const ANGLES: RangeInclusive<u32> = 1..=180;
/// Metres of a bend's radius.
pub const RADII: RangeInclusive<u32> = 15..=1000;
/// Metres that a road climbs or falls at most on each metre of its length.
pub const STEEPEST: f64 = 0.15;

/// A word as it is written, before it is known to be a road that can be built.
struct Written<'a> {
    /// -1 for a bend to the left, 1 to the right, 0 for a straight.
    side: f64,
    /// A straight's length or a bend's angle, and where it stands.
    first: (&'a str, u32),
    radius: Option<(&'a str, u32)>,
    climb: Option<(&'a str, f64)>,
}

fn number(i: &str) -> IResult<&str, (&str, u32)> {
    let (rest, n) = preceded(tag("-"), map_res(digit1, str::parse)).parse(i)?;
    Ok((rest, (&i[1..], n)))
}

fn written(i: &str) -> IResult<&str, Written<'_>> {
    let (i, side) = alt((value(0.0, tag("straight")), value(-1.0, tag("left")), value(1.0, tag("right")))).parse(i)?;
    let (i, first) = number(i)?;
    let (i, radius) = if side == 0.0 { (i, None) } else { number(i).map(|(i, radius)| (i, Some(radius)))? };
    let (i, sign) = opt(alt((value(1.0, tag("-up")), value(-1.0, tag("-down"))))).parse(i)?;
    let (i, climb) = match sign {
        None => (i, None),
        Some(sign) => number(i).map(|(i, (at, n))| (i, Some((at, sign * f64::from(n)))))?,
    };
    Ok((i, Written { side, first, radius, climb }))
}

const FORM: &str = "a piece of a road such as `straight-60`, `left-90-25` or `right-45-40-up-3`: \
                    metres, or degrees and metres of radius, and metres up or down";

/// Where in a word the trouble is, what it is and what should be there.
type Trouble<'a> = (&'a str, String, String);

/// The piece of a road that `word` names.
fn section(word: &str) -> Result<Section, Trouble<'_>> {
    let (_, written) = terminated(written, eof).parse(word).map_err(|error| {
        let at = if let nom::Err::Error(e) | nom::Err::Failure(e) = error { e.input } else { word };
        let found = if at.is_empty() { format!("`{word}` ends") } else { format!("found `{at}` in `{word}`") };
        (at, found, FORM.to_owned())
    })?;
    let within = |(at, n), range: RangeInclusive<u32>, what: &str| match range.contains(&n) {
        true => Ok(f64::from(n)),
        false => Err((at, format!("{n} in `{word}`"), format!("from {} to {} {what}", range.start(), range.end()))),
    };
    let (length, bend) = match written.radius {
        None => (within(written.first, LENGTHS, "metres")?, 0.0),
        Some(radius) => {
            let angle = within(written.first, ANGLES, "degrees")?;
            let radius = within(radius, RADII, "metres of radius")?;
            (angle.to_radians() * radius, written.side / radius)
        }
    };
    let (at, climb) = written.climb.unwrap_or((word, 0.0));
    if climb.abs() > STEEPEST * length {
        let most = format!("at most {STEEPEST} m on a metre, here {:.1} m", STEEPEST * length);
        return Err((at, format!("{} m of slope in `{word}`", climb.abs()), most));
    }
    Ok(Section { length, bend, climb })
}

/// The pieces of a road that the words of a grammar name.
///
/// # Errors
/// With the exact place, at the first word that is none.
pub fn sections(tree: &Tree) -> Result<BTreeMap<&str, Section>> {
    let lists = tree.lists.iter().flat_map(|list| &list.items);
    let arms = tree.rules.iter().flat_map(|rule| &rule.arms).flat_map(|arm| &arm.item.words);
    let words = lists.chain(arms).filter_map(|Weighted { item, .. }| match item {
        Item::Word(name) => Some(name),
        Item::List(_) => None,
    });
    words.map(|name| Ok((&*name.text, section(&name.text).map_err(|trouble| refuse(tree, name, trouble))?))).collect()
}

fn refuse(tree: &Tree, name: &Name, (at, problem, expected): Trouble<'_>) -> Error {
    let quote = usize::from(tree.text[name.offset..].starts_with('"'));
    Error::data(tree.place(name.offset + quote + name.text.len() - at.len()), problem, expected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn words_are_pieces_of_a_road() {
        let straight = Section { length: 60.0, bend: 0.0, climb: -3.0 };
        assert_eq!(section("straight-60-down-3"), Ok(straight));
        let bend = section("left-90-20-up-4").expect("a bend");
        assert_eq!((bend.bend, bend.climb), (-0.05, 4.0));
        assert!((bend.length - 31.41592653589793).abs() < 1e-12);
        assert_eq!(section("right-180-15").expect("a bend").bend, 1.0 / 15.0);
    }

    #[test]
    fn every_error_tells_place_finding_and_expectation() {
        for (word, column, expected) in [
            ("strait-60", 1, "found `strait-60` in `strait-60`; expected a piece of a road such as"),
            ("straight", 9, "`straight` ends; expected"),
            ("straight-60-25", 12, "found `-25` in"),
            ("left-90", 8, "`left-90` ends"),
            ("left-90-20-up", 14, "`left-90-20-up` ends"),
            ("left-200-20", 6, "200 in `left-200-20`; expected from 1 to 180 degrees"),
            ("right-90-5", 10, "5 in `right-90-5`; expected from 15 to 1000 metres of radius"),
            ("straight-0", 10, "0 in `straight-0`; expected from 1 to 1000 metres"),
            (
                "straight-20-up-9",
                16,
                "9 m of slope in `straight-20-up-9`; expected at most 0.15 m on a metre, here 3.0 m",
            ),
            ("straight-99999999999", 10, "found `99999999999`"),
        ] {
            for quote in ["", "\""] {
                let text = format!("start A;\nA -> {quote}{word}{quote} end;");
                let tree = Tree::parse("t", &text).expect("a grammar");
                let error = sections(&tree).expect_err(word).to_string();
                let expected = format!("t:2:{}: {expected}", 5 + quote.len() + column);
                assert!(error.starts_with(&expected), "{error}\n  not {expected}");
            }
        }
    }

    proptest! {
        #[test]
        fn no_word_is_a_panic(word in "(straight|left|right)?(-[0-9]{0,4}|-up|-down|é){0,5}|\\PC{0,20}") {
            if let Ok(section) = section(&word) {
                prop_assert!(section.length >= 0.2 && section.climb.abs() <= STEEPEST * section.length);
            }
        }
    }
}
