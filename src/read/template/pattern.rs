//! The syntax of one line of a template.

use super::regex::{Matcher, Transform};
use super::{BACK, REACH};
use crate::error::{Error, Place};
use nom::branch::alt;
use nom::bytes::complete::{tag, take_while, take_while1};
use nom::character::complete::{anychar, char, digit1, none_of, one_of};
use nom::combinator::{map_opt, opt, recognize, rest, verify};
use nom::error::{ErrorKind, ParseError};
use nom::multi::{many0, many0_count};
use nom::sequence::{delimited, preceded};
use nom::{IResult, Parser};

/// What a line says.
#[derive(Debug, PartialEq)]
pub(super) enum Line {
    /// Nothing.
    Blank,
    /// How cells outside the sentence read.
    Pad { before: String, after: String },
    /// What kind of feature, `U`, `B` or `*`, and what it is made of.
    Pattern { kind: char, parts: Vec<Part> },
}

/// A part of a pattern.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Part {
    /// Itself.
    Text(String),
    /// Something made of a cell; the column's number stands at byte `at` of the line.
    Cell { transform: Transform, row: Row, column: u32, at: usize },
    /// The label so many tokens further on.
    Label(i32),
}

/// What the features of a pattern are made of: it says so itself, or one looks at the label before as well, or there are both.
pub(super) fn features(kind: char, parts: Vec<Part>) -> Vec<Vec<Part>> {
    let further = (kind != 'U').then(|| [&parts[..], &[Part::Label(-1)]].concat());
    (kind != 'B').then_some(parts).into_iter().chain(further).collect()
}

/// Whether one of them is a label.
pub(super) fn looks_back(parts: &[Part]) -> bool {
    parts.iter().any(|part| matches!(part, Part::Label(_)))
}

/// Which token of the sentence a cell belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Row {
    /// So many after the token at hand.
    Relative(i32),
    /// So many after the first one.
    First(i32),
    /// So many after the end: -1 is the last one.
    End(i32),
}

/// What is wrong with a line.
#[derive(Debug, PartialEq)]
pub(super) struct Fault<'a> {
    /// The line from the fault on.
    pub(super) rest: &'a str,
    expected: &'static str,
}

impl Fault<'_> {
    /// The fault as an error at `place`.
    pub(super) fn at(&self, place: Place) -> Error {
        let found: String = self.rest.chars().take(12).collect();
        let problem = match self.rest.len() {
            0 => "the line's end".to_owned(),
            length if length > found.len() => format!("{found:?}..."),
            _ => format!("{found:?}"),
        };
        Error::data(place, problem, self.expected)
    }
}

impl<'a> ParseError<&'a str> for Fault<'a> {
    fn from_error_kind(rest: &'a str, _: ErrorKind) -> Self {
        Fault { rest, expected: "a pattern" }
    }

    fn append(_: &'a str, _: ErrorKind, other: Self) -> Self {
        other
    }
}

type Parsed<'a, T> = IResult<&'a str, T, Fault<'a>>;

/// `parser`, whose failure is a fault where it began: `expected` should stand there.
fn want<'a, T>(
    expected: &'static str,
    mut parser: impl Parser<&'a str, Output = T, Error = Fault<'a>>,
) -> impl FnMut(&'a str) -> Parsed<'a, T> {
    move |input| parser.parse(input).map_err(|_| nom::Err::Failure(Fault { rest: input, expected }))
}

/// A whole line, without its end.
pub(super) fn line(input: &str) -> Result<Line, Fault<'_>> {
    if matches!(input.trim_ascii_start().chars().next(), None | Some('#')) {
        return Ok(Line::Blank);
    }
    let parsed = alt((pad, |i| pattern(input, i))).parse(input);
    match parsed {
        Ok((_, line)) => Ok(line),
        Err(nom::Err::Failure(fault)) => Err(fault),
        Err(_) => Err(Fault { rest: input, expected: "U, B, *, # or @pad at the start of the line" }),
    }
}

/// `@pad <s> </s>`.
fn pad(input: &str) -> Parsed<'_, Line> {
    let (input, _) = tag("@pad").parse(input)?;
    let mut word = want(
        "@pad and two words, for cells before and after the sentence",
        preceded(take_while1(is_space), take_while1(|c| !is_space(c))),
    );
    let (input, before) = word(input)?;
    let (input, after) = word(input)?;
    let (input, _) = want("nothing after the two words of @pad", verify(rest, str::is_empty)).parse(input)?;
    Ok((input, Line::Pad { before: before.to_owned(), after: after.to_owned() }))
}

/// A feature. `whole` is the line, to count characters in.
fn pattern<'a>(whole: &'a str, input: &'a str) -> Parsed<'a, Line> {
    let (input, kind) = one_of("UuBb*").parse(input)?;
    let (input, parts) = many0(alt((|i| command(whole, i), text))).parse(input)?;
    let (input, _) = comment(input)?;
    Ok((input, Line::Pattern { kind: kind.to_ascii_uppercase(), parts }))
}

/// Text up to the next command or comment.
fn text(input: &str) -> Parsed<'_, Part> {
    let end = input.find('%').unwrap_or(input.len());
    let end = comment_start(&input[..end]).unwrap_or(end);
    if end == 0 {
        return Err(nom::Err::Error(Fault::from_error_kind(input, ErrorKind::TakeTill1)));
    }
    Ok((&input[end..], Part::Text(input[..end].to_owned())))
}

/// A comment at the end of a line, or the end itself.
fn comment(input: &str) -> Parsed<'_, &str> {
    verify(rest, |rest: &str| rest.is_empty() || comment_start(rest) == Some(0)).parse(input)
}

/// Where a comment and the space before it start in `text`.
fn comment_start(text: &str) -> Option<usize> {
    let mut hashes = text.match_indices('#').map(|(at, _)| text[..at].trim_ascii_end().len()..at);
    hashes.find(|gap| !gap.is_empty()).map(|gap| gap.start)
}

/// `%x[0,0]` and its like.
fn command<'a>(whole: &'a str, input: &'a str) -> Parsed<'a, Part> {
    let (input, _) = char('%').parse(input)?;
    let (input, letter) = want("x, t, m, s or y after %", one_of("xXtTmMsSy")).parse(input)?;
    let (input, _) = want("[", char('[')).parse(input)?;
    if letter == 'y' {
        let (input, k) = want("a label, from -8 to 8", integer(-BACK, BACK)).parse(input)?;
        let (input, _) = want("]", close).parse(input)?;
        return Ok((input, Part::Label(k)));
    }
    let (input, row) = row(input)?;
    let (input, _) = want("a comma and the column", comma).parse(input)?;
    let at = whole.len() - input.len();
    let (input, column) = want("the number of a column, from 0", integer(0, i32::MAX)).parse(input)?;
    let fold = letter.is_ascii_uppercase();
    let (input, transform) = match letter.to_ascii_lowercase() {
        't' => expression(input).map(|(input, matcher)| (input, Transform::Test { matcher }))?,
        'm' => expression(input).map(|(input, matcher)| (input, Transform::Match { matcher, fold }))?,
        's' => shape(input).map(|(input, most)| (input, Transform::Shape { most, fold }))?,
        _ => (input, Transform::Word { fold }),
    };
    let (input, _) = want("]", close).parse(input)?;
    Ok((input, Part::Cell { transform, row, column: column.unsigned_abs(), at }))
}

/// `-1`, `@1` or `@-1`. Wapiti counts absolute rows from 1: `@0` is the place before the first token.
fn row(input: &str) -> Parsed<'_, Row> {
    let (input, absolute) = opt(preceded(spaces, char('@'))).parse(input)?;
    let (input, number) = want("a row from -100 to 100, after @ if absolute", integer(-REACH, REACH)).parse(input)?;
    let row = match absolute {
        None => Row::Relative(number),
        Some(_) if number < 0 => Row::End(number),
        Some(_) => Row::First(number - 1),
    };
    Ok((input, row))
}

/// The regular expression of `%t` and `%m`, after the column.
fn expression(input: &str) -> Parsed<'_, Matcher> {
    let (input, _) = want("a comma and a regular expression in quotes", (comma, spaces, char('"'))).parse(input)?;
    let characters = many0_count(alt((preceded(char('\\'), anychar), none_of("\\\""))));
    let (after, source) = recognize(characters).parse(input)?;
    let (after, _) = want("a quote that ends the regular expression", char('"')).parse(after)?;
    match Matcher::new(source) {
        Ok(matcher) => Ok((after, matcher)),
        Err((offset, expected)) => Err(nom::Err::Failure(Fault { rest: &input[offset..], expected })),
    }
}

/// The length of `%s`, after the column; all of the word where it is left out.
fn shape(input: &str) -> Parsed<'_, Option<usize>> {
    let length = want("a number of characters, from 1", integer(1, i32::MAX));
    let (input, length) = opt(preceded(comma, length)).parse(input)?;
    Ok((input, length.map(|n| n.unsigned_abs() as usize)))
}

/// A number from `least` to `most`, with or without a sign, after spaces.
fn integer<'a>(least: i32, most: i32) -> impl Parser<&'a str, Output = i32, Error = Fault<'a>> {
    let number = map_opt(recognize((opt(one_of("+-")), digit1)), |digits: &str| digits.parse().ok());
    preceded(spaces, verify(number, move |n| (least..=most).contains(n)))
}

fn comma(input: &str) -> Parsed<'_, char> {
    preceded(spaces, char(',')).parse(input)
}

fn close(input: &str) -> Parsed<'_, char> {
    delimited(spaces, char(']'), nom::combinator::success(())).parse(input)
}

fn spaces(input: &str) -> Parsed<'_, &str> {
    take_while(is_space).parse(input)
}

fn is_space(character: char) -> bool {
    character.is_ascii_whitespace()
}
