//! Instances: a tabular problem with policies, classifiers and rates, read from JSON.
//!
//! | key | shape | meaning |
//! |---|---|---|
//! | S, A, T | | states, actions, horizon |
//! | mu | \[s\] | initial distribution |
//! | P | \[s\]\[a\]\[s'\] | transition probabilities |
//! | C | \[s\]\[a\] | immediate cost in \[0, 1\] |
//! | expert | \[s\] | the expert's action |
//! | pi | \[s\]\[a\] | optional: one stationary policy |
//! | pis | \[t\]\[s\]\[a\] | optional: one policy a step |
//! | hats | \[n\]\[s\]\[a\] | optional: the classifiers of rounds 1, ..., N |
//! | N | | optional: rounds; the number of hats if they are given |
//! | alpha | | optional: the mixing rate of SMILe and SEARN, from 1e-15 to 1 |
//! | phi | \[s\] | optional: what a classifier of the restricted class sees; it acts alike in states with equal phi |
//! | m, k_roll | | optional: state samples a round, roll-outs an action; also read from within an object `counts` |
//!
//! Other keys are ignored.

use super::closed::SLOWEST;
use super::mdp::{Mdp, Parts, same};
use super::table::Table;
use crate::error::{Error, Place, Result};
use crate::read::input;
use ndarray::{Array1, Array2, Array3};
use serde::Deserialize;
use std::io::Read;
use std::path::Path;

/// The largest file that is read, in bytes: an instance of a few hundred states fits many times over.
pub const LARGEST: u64 = 64 << 20;

/// The most rounds that an instance may have.
pub const MOST_ROUNDS: usize = 4_000;

/// The most samples a round, and roll-outs an action, that an instance may have.
pub const MOST_SAMPLES: u64 = 1_000_000_000;

/// A problem and what is to be audited on it. What is `None` or empty leaves its groups out of the audit.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The problem.
    pub mdp: Mdp,
    /// pi, one stationary policy.
    pub policy: Option<Table>,
    /// pi_1, ..., pi_T, one policy a step.
    pub ladder: Option<Vec<Table>>,
    /// The classifiers of rounds 1, ..., N.
    pub hats: Option<Vec<Table>>,
    /// N.
    pub rounds: Option<usize>,
    /// The mixing rate of SMILe (alpha) and of SEARN (beta), from 1e-15 to 1.
    pub rate: Option<f64>,
    /// `view[s]`, what a classifier of the restricted class sees of state s.
    pub view: Option<Vec<usize>>,
    /// m, state samples a round.
    pub samples: Option<u64>,
    /// k, roll-outs an action.
    pub rollouts: Option<u64>,
}

type Rows = Vec<Vec<f64>>;

#[derive(Deserialize)]
#[allow(non_snake_case)]
struct Raw {
    S: usize,
    A: usize,
    T: usize,
    mu: Vec<f64>,
    P: Vec<Rows>,
    C: Rows,
    expert: Vec<usize>,
    pi: Option<Rows>,
    pis: Option<Vec<Rows>>,
    hats: Option<Vec<Rows>>,
    N: Option<usize>,
    alpha: Option<f64>,
    phi: Option<Vec<usize>>,
    m: Option<u64>,
    k_roll: Option<u64>,
    counts: Option<RawCounts>,
}

#[derive(Deserialize)]
struct RawCounts {
    m: Option<u64>,
    k_roll: Option<u64>,
}

impl Instance {
    /// Reads an instance from the file at `path`, or from standard input if it is `-`.
    ///
    /// # Errors
    /// A file that cannot be read or is larger than [`LARGEST`]; text that is not JSON of the right types, with line
    /// and column; a value that cannot be, with its JSON path.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Instance::read_from(input::name(path), input::open(path)?)
    }

    /// Reads an instance from `input`, calling it `path` in errors.
    ///
    /// # Errors
    /// As for [`Instance::read`].
    pub fn read_from(path: impl AsRef<Path>, input: impl Read) -> Result<Self> {
        let path = path.as_ref();
        let mut text = Vec::new();
        input.take(LARGEST + 1).read_to_end(&mut text).map_err(|error| Error::io("read", path, error))?;
        if text.len() as u64 > LARGEST {
            let problem = format!("larger than {} MiB", LARGEST >> 20);
            return Err(Error::file(path, problem, "an instance must be smaller; leave out what is not needed"));
        }
        Instance::parse(path, &text)
    }

    /// Parses the JSON `text`, calling it `path` in errors.
    ///
    /// # Errors
    /// As for [`Instance::read`].
    pub fn parse(path: impl AsRef<Path>, text: &[u8]) -> Result<Self> {
        let path = path.as_ref();
        let raw: Raw = serde_json::from_slice(text).map_err(|error| {
            let place = Place { path: path.to_owned(), line: error.line().max(1), column: error.column().max(1) };
            let full = error.to_string();
            let what = full.rsplit_once(" at line ").map_or(full.as_str(), |(what, _)| what).to_owned();
            Error::data(place, what, "one JSON object with S, A, T, mu, P, C and expert")
        })?;
        Instance::check(raw).map_err(|error| error.within(path))
    }

    fn check(raw: Raw) -> Result<Self> {
        let (states, actions) = (raw.S, raw.A);
        let rows = |at: &str, rows: Rows| matrix(at, rows, states, actions);
        let tables = |at: &str, list: Vec<Rows>| -> Result<Vec<Table>> {
            let table = |(i, list)| {
                let at = format!("{at}[{i}]");
                Table::new(&at, rows(&at, list)?)
            };
            list.into_iter().enumerate().map(table).collect()
        };
        same("mu", "numbers", raw.mu.len(), states)?;
        same("P", "states", raw.P.len(), states)?;
        let mut next = Vec::new();
        for (s, list) in raw.P.into_iter().enumerate() {
            next.extend(matrix(&format!("P[{s}]"), list, actions, states)?);
        }
        let next = Array3::from_shape_vec((states, actions, states), next)
            .map_err(|error| Error::instance("P", error.to_string(), "a table"))?;
        let cost = rows("C", raw.C)?;
        let mdp = Mdp::new(Parts { horizon: raw.T, start: Array1::from(raw.mu), next, cost, expert: raw.expert })?;
        if let Some(pis) = &raw.pis {
            same("pis", "policies", pis.len(), raw.T)?;
        }
        let hats = raw.hats.map(|hats| tables("hats", hats)).transpose()?;
        let rounds = raw.N.or(hats.as_ref().map(Vec::len));
        if let Some(hats) = &hats {
            same("hats", "classifiers", hats.len(), rounds.unwrap_or(0))?;
        }
        range("N", rounds, 1, MOST_ROUNDS)?;
        if let Some(alpha) = raw.alpha.filter(|alpha| !(SLOWEST..=1.0).contains(alpha)) {
            return Err(Error::instance("alpha", alpha.to_string(), format!("a rate from {SLOWEST:e} to 1")));
        }
        if let Some(phi) = &raw.phi {
            same("phi", "numbers", phi.len(), states)?;
        }
        let counts = raw.counts.unwrap_or(RawCounts { m: None, k_roll: None });
        let (samples, rollouts) = (raw.m.or(counts.m), raw.k_roll.or(counts.k_roll));
        range("m", samples, 1, MOST_SAMPLES)?;
        range("k_roll", rollouts, 0, MOST_SAMPLES)?;
        Ok(Instance {
            policy: raw.pi.map(|pi| Table::new("pi", rows("pi", pi)?)).transpose()?,
            ladder: raw.pis.map(|pis| tables("pis", pis)).transpose()?,
            hats,
            rounds,
            rate: raw.alpha,
            view: raw.phi,
            samples,
            rollouts,
            mdp,
        })
    }
}

/// `list` as a matrix of this shape.
fn matrix(at: &str, list: Rows, rows: usize, columns: usize) -> Result<Array2<f64>> {
    same(at, "rows", list.len(), rows)?;
    let mut flat = Vec::new();
    for (i, row) in list.iter().enumerate() {
        same(&format!("{at}[{i}]"), "numbers", row.len(), columns)?;
        flat.extend_from_slice(row);
    }
    Array2::from_shape_vec((rows, columns), flat).map_err(|error| Error::instance(at, error.to_string(), "a table"))
}

/// An error unless `value` is absent or from `least` to `most`.
fn range<N: PartialOrd + std::fmt::Display>(at: &str, value: Option<N>, least: N, most: N) -> Result<()> {
    match value {
        Some(n) if n < least || n > most => Err(Error::instance(at, n.to_string(), format!("from {least} to {most}"))),
        _ => Ok(()),
    }
}
