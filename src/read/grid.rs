//! Reader of grid maps.
//!
//! A map is a block of rows of the same length, one character a cell: a letter from `a` is a class of terrain, `#` a wall. Below the rows stand the
//! trips to be made, one a line: column and row, counted from 1 at the top left, of start and goal. Blank lines stand between maps.
//!
//! ```text
//! aabbc
//! a##bc
//! aaacc
//! 1,1 -> 5,3
//! 5,1 -> 1,3
//! ```
//!
//! One steps up, right, down and left, so what can be reached from one cell is what it can be reached from.

use super::conll::Source;
use crate::error::{Error, Result};
use nom::bytes::complete::{tag, take_while1};
use nom::character::complete::{digit1, space0};
use nom::combinator::{all_consuming, map_res};
use nom::sequence::{delimited, separated_pair};
use nom::{IResult, Parser};
use std::fmt;
use std::path::Path;

/// The classes of terrain that there are letters for.
pub const MOST_TERRAINS: usize = 26;

/// A map of cells, row by row: cell number row * width + column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Grid {
    /// The length of a row.
    pub width: usize,
    /// The terrain of each cell; none where there is a wall.
    pub cells: Vec<Option<u8>>,
    /// Trips: start and goal, two cells between which there is a way.
    pub trips: Vec<[usize; 2]>,
}

impl Grid {
    /// How many rows there are.
    pub fn height(&self) -> usize {
        self.cells.len().checked_div(self.width).unwrap_or(0)
    }

    /// The cells that a step leads to from `cell`: up, right, down, left; none out of the map or into a wall.
    pub fn neighbours(&self, cell: usize) -> [Option<usize>; 4] {
        let (column, width) = (cell % self.width, self.width);
        let [up, right] = [cell.checked_sub(width), (column + 1 < width).then_some(cell + 1)];
        let [down, left] = [Some(cell + width), (column > 0).then(|| cell - 1)];
        let open = |cell: &usize| self.cells.get(*cell).is_some_and(|terrain| terrain.is_some());
        [up, right, down, left].map(|to| to.filter(open))
    }

    /// For each cell a number that it shares with those that can be reached from it.
    pub fn regions(&self) -> Vec<usize> {
        let mut regions = vec![usize::MAX; self.cells.len()];
        let mut open = Vec::new();
        for cell in 0..self.cells.len() {
            if regions[cell] != usize::MAX {
                continue;
            }
            open.push(cell);
            regions[cell] = cell;
            while let Some(here) = open.pop().filter(|here| self.cells[*here].is_some()) {
                for next in self.neighbours(here).into_iter().flatten() {
                    if regions[next] == usize::MAX {
                        regions[next] = cell;
                        open.push(next);
                    }
                }
            }
        }
        regions
    }
}

/// As it is read.
impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in self.cells.chunks(self.width.max(1)) {
            let letter = |cell: &Option<u8>| cell.map_or('#', |terrain| char::from(b'a' + terrain % 26));
            writeln!(f, "{}", row.iter().map(letter).collect::<String>())?;
        }
        let name = |cell: usize| format!("{},{}", cell % self.width.max(1) + 1, cell / self.width.max(1) + 1);
        self.trips.iter().try_for_each(|[start, goal]| writeln!(f, "{} -> {}", name(*start), name(*goal)))
    }
}

/// The maps in `text`, which was read from `path`, with `terrains` classes of terrain, 1 to 26.
///
/// # Errors
/// With the exact place: rows of different lengths, terrain that there is none of, a trip that is none, that leaves the map or ends at a wall or
/// where it starts, or to whose goal there is no way. Where there are not 1 to 26 classes, or no map.
pub fn parse(text: &str, path: impl AsRef<Path>, terrains: usize) -> Result<Vec<Grid>> {
    if !(1..=MOST_TERRAINS).contains(&terrains) {
        return Err(Error::argument("terrains", terrains, "from 1 to 26"));
    }
    let source = Source { text: text.as_bytes(), path: path.as_ref(), first_line: 1 };
    let reader = Reader::read(text, &source, terrains)?;
    if reader.grids.is_empty() {
        return Err(reader.refuse(&text[text.len()..], "the text ends without a map", reader.row()));
    }
    Ok(reader.grids)
}

/// The maps in `text`, of `path`, whose first line has the number `first_line` there, with all classes of terrain; and the line on which each begins.
///
/// # Errors
/// As [`parse`], and when `text` is not UTF-8 or has a NUL in it. That there is no map is none.
pub fn parse_block(text: &[u8], path: &Path, first_line: usize) -> Result<(Vec<Grid>, Vec<usize>)> {
    let source = Source { text, path, first_line };
    let reader = Reader::read(source.characters()?, &source, MOST_TERRAINS)?;
    Ok((reader.grids, reader.lines))
}

struct Reader<'a> {
    text: &'a str,
    source: &'a Source<'a>,
    terrains: usize,
    grids: Vec<Grid>,
    /// The line on which each begins.
    lines: Vec<usize>,
    /// The regions of the last map, once it has trips; none of them when a blank line ended it.
    open: Option<Vec<usize>>,
}

/// `2,7` as column and row.
fn corner(i: &str) -> IResult<&str, (usize, usize)> {
    let number = || map_res(digit1, str::parse);
    separated_pair(number(), delimited(space0, tag(","), space0), number()).parse(i)
}

/// A corner, and where it is written.
type Written<'a> = (&'a str, (usize, usize));

fn trip(i: &str) -> IResult<&str, [Written<'_>; 2]> {
    let (goal, start) = corner(i)?;
    let (goal, _) = delimited(space0, tag("->"), space0).parse(goal)?;
    let (_, end) = all_consuming(nom::sequence::terminated(corner, space0)).parse(goal)?;
    Ok(("", [(i, start), (goal, end)]))
}

const TRIP: &str = "a trip such as `1,1 -> 5,3`: column and row of start and goal";

impl<'a> Reader<'a> {
    fn read(text: &'a str, source: &'a Source<'a>, terrains: usize) -> Result<Self> {
        let mut reader = Reader { text, source, terrains, grids: Vec::new(), lines: Vec::new(), open: None };
        for (line, number) in text.split_inclusive('\n').zip(source.first_line..) {
            reader.line(line.trim_end_matches(['\n', '\r']))?;
            if reader.lines.len() < reader.grids.len() {
                reader.lines.push(number);
            }
        }
        reader.open = None;
        Ok(reader)
    }

    fn refuse(&self, at: &str, problem: impl Into<String>, expected: impl Into<String>) -> Error {
        let offset = at.as_ptr() as usize - self.text.as_ptr() as usize;
        Error::data(self.source.place(offset), problem, expected)
    }

    fn row(&self) -> String {
        format!("a row of letters from a to {} and #", char::from(b'a' + self.terrains as u8 - 1))
    }

    fn line(&mut self, line: &'a str) -> Result<()> {
        if line.trim().is_empty() {
            self.open = None;
            return Ok(());
        }
        if line.starts_with(|c: char| c.is_ascii_digit()) { self.trip(line) } else { self.cells(line) }
    }

    fn cells(&mut self, line: &'a str) -> Result<()> {
        let terrain = |c: char| c.is_ascii_lowercase() && ((c as u8 - b'a') as usize) < self.terrains;
        let read: IResult<&str, &str> = take_while1(|c| terrain(c) || c == '#')(line);
        let rest = read.as_ref().map_or(line, |(rest, _)| rest);
        if let Some(found) = rest.chars().next() {
            return Err(self.refuse(rest, format!("found `{found}`"), self.row()));
        }
        let cells = line.bytes().map(|c| (c != b'#').then(|| c - b'a'));
        match self.grids.last_mut().filter(|_| self.open.is_some()) {
            None => {
                self.grids.push(Grid { width: line.len(), cells: cells.collect(), trips: Vec::new() });
                self.open = Some(Vec::new());
            }
            Some(grid) if !grid.trips.is_empty() => {
                return Err(self.refuse(line, "a row below a trip", "a trip, or a blank line before the next map"));
            }
            Some(grid) if grid.width == line.len() => grid.cells.extend(cells),
            Some(grid) => {
                let (width, at) = (grid.width, &line[grid.width.min(line.len())..]);
                return Err(self.refuse(at, format!("a row of {} cells", line.len()), format!("{width}, as above")));
            }
        }
        Ok(())
    }

    fn trip(&mut self, line: &'a str) -> Result<()> {
        let (_, [(from, start), (to, goal)]) = trip(line).map_err(|error| {
            let at = if let nom::Err::Error(e) | nom::Err::Failure(e) = error { e.input } else { line };
            let found = at.split_whitespace().next().map_or("the line ends".into(), |token| format!("found `{token}`"));
            self.refuse(at, found, TRIP)
        })?;
        let Some(grid) = self.grids.last().filter(|_| self.open.is_some()) else {
            return Err(self.refuse(line, "a trip without a map", self.row()));
        };
        let cell = |at, (column, row): (usize, usize)| {
            let inside = (1..=grid.width).contains(&column) && (1..=grid.height()).contains(&row);
            let allowed = || format!("a column from 1 to {} and a row from 1 to {}", grid.width, grid.height());
            let cell = inside.then(|| (row - 1) * grid.width + column - 1);
            let cell = cell.ok_or_else(|| self.refuse(at, format!("{column},{row} is not on the map"), allowed()))?;
            let wall = grid.cells[cell].is_none();
            if wall { Err(self.refuse(at, "a wall", "a cell with terrain")) } else { Ok(cell) }
        };
        let (start, goal) = (cell(from, start)?, cell(to, goal)?);
        if start == goal {
            return Err(self.refuse(to, "the goal is the start", "another cell"));
        }
        let regions = self.open.take().filter(|regions| !regions.is_empty()).unwrap_or_else(|| grid.regions());
        if regions[start] != regions[goal] {
            return Err(self.refuse(to, "there is no way from the start to this goal", "a goal that can be reached"));
        }
        self.open = Some(regions);
        if let Some(grid) = self.grids.last_mut() {
            grid.trips.push([start, goal]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_whole_text() {
        let text = "ab\n#b\n1,1 -> 2,2\n\n\naaa\r\n3 , 1->1,1\r\n1,1 -> 2,1\n";
        let grids = parse(text, "m", 2).expect("well formed");
        assert_eq!(grids[0], Grid { width: 2, cells: vec![Some(0), Some(1), None, Some(1)], trips: vec![[0, 3]] });
        assert_eq!((grids.len(), grids[1].width, &grids[1].trips[..]), (2, 3, &[[2, 0], [0, 1]][..]));
    }

    #[test]
    fn every_error_tells_place_finding_and_expectation() {
        for (text, expected) in [
            ("", "m:1:1: the text ends without a map; expected a row of letters from a to c and #"),
            ("aa\nad\n", "m:2:2: found `d`; expected a row of letters from a to c"),
            ("aa\naA\n", "m:2:2: found `A`"),
            ("aa\né\n", "m:2:1: found `é`"),
            ("aa\na\n", "m:2:2: a row of 1 cells; expected 2, as above"),
            ("aa\naaa\n", "m:2:3: a row of 3 cells"),
            ("aa\n1,1 -> 2,1\naa\n", "m:3:1: a row below a trip; expected a trip, or a blank line"),
            ("\n1,1 -> 2,1\n", "m:2:1: a trip without a map"),
            ("aa\n\n1,1 -> 2,1\n", "m:3:1: a trip without a map"),
            ("aa\n1,1 2,1\n", "m:2:5: found `2,1`; expected a trip such as"),
            ("aa\n1 -> 2,1\n", "m:2:3: found `->`"),
            ("aa\n1,1 ->\n", "m:2:7: the line ends"),
            ("aa\n1,1 -> 2,1 x\n", "m:2:12: found `x`"),
            ("aa\n99999999999999999999,1 -> 2,1\n", "m:2:1: found `99999999999999999999,1`"),
            ("aa\n1,1 -> 3,1\n", "m:2:8: 3,1 is not on the map; expected a column from 1 to 2 and a row from 1 to 1"),
            ("aa\n0,1 -> 2,1\n", "m:2:1: 0,1 is not on the map"),
            ("a#\n1,1 -> 2,1\n", "m:2:8: a wall; expected a cell with terrain"),
            ("aa\n1,1 -> 1,1\n", "m:2:8: the goal is the start"),
            ("a#a\n1,1 -> 3,1\n", "m:2:8: there is no way from the start to this goal"),
        ] {
            let error = parse(text, "m", 3).expect_err(text).to_string();
            assert!(error.starts_with(expected), "{text:?}: {error}\n  not {expected}");
        }
        assert!(parse("a", "m", 0).is_err() && parse("a", "m", 27).is_err());
    }

    proptest! {
        #[test]
        fn no_text_is_a_panic(text in "[abc#0-9,> \n-]{0,40}|\\PC{0,30}") {
            for grid in parse(&text, "m", 2).into_iter().flatten() {
                prop_assert_eq!(parse(&grid.to_string(), "m", 2).expect("it was read before"), vec![grid]);
            }
        }
    }
}
