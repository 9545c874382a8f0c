//! Why a model says what it says, token by token: `rollin tag --explain`.

use crate::error::{Error, Result};
use crate::read::conll::{Block, Line};
use crate::seed::Seed;
use crate::space::Action;
use crate::tasks::{Model, Names, Reason, Share, Task};
use serde::Serialize;
use std::io::{self, Write};
use std::path::Path;

/// Refuses a model that decides by more than one sum of weights.
pub fn check<T: Task>(model: &Model<T>, path: &Path) -> Result<()> {
    match model.policy.sums() {
        Some(_) => Ok(()),
        None => {
            let problem = "a model that does not decide by one sum of weights, as nets, pairs and mixtures that vote or are drawn from";
            Err(Error::file(
                path,
                problem,
                "read a mixture by --reading mean, or train with a linear learner such as logistic",
            ))
        }
    }
}

/// What is to be explained: a block, its corpus, what was done in it, and how many sentences came before.
pub struct Asked<'a, T: Task> {
    pub data: &'a T::Data,
    pub actions: &'a [Action],
    pub before: usize,
    pub seed: Seed,
}

/// A token's line, the action that says what it is, and why that was taken.
type Answer = (usize, Reason);

/// Why each token of a block got its label.
fn answers<T: Task>(model: &Model<T>, asked: &Asked<'_, T>) -> Result<Vec<Answer>> {
    let reasons = model.reasons(asked.data, asked.actions, asked.before, asked.seed)?.unwrap_or_default();
    let lines = model.encoding.lines(asked.data, asked.actions);
    Ok(lines.into_iter().filter_map(|(line, action)| Some((line, reasons.get(action)?.clone()))).collect())
}

/// The lines of `written`, each of a token with its reasons below: lines that begin with `#`.
pub fn text<T: Task>(model: &Model<T>, asked: &Asked<'_, T>, written: &Block) -> Result<Vec<u8>> {
    let (answers, names) = (answers(model, asked)?, model.names(asked.data)?);
    let mut answers = answers.iter().peekable();
    let mut out = Vec::with_capacity(8 * written.bytes.len());
    for (Line { text, end }, number) in written.lines().zip(written.first_line..) {
        out.extend_from_slice(text);
        out.extend_from_slice(end);
        if let Some((_, reason)) = answers.next_if(|(line, _)| *line == number) {
            tell(model, reason, &names, &mut out).map_err(super::closed)?;
        }
    }
    Ok(out)
}

/// The most features that are told of a token, those first that make the greatest difference.
const TOLD: usize = 8;

/// What the features say, as lines.
fn tell<T: Task>(model: &Model<T>, reason: &Reason, names: &Names<'_>, out: &mut Vec<u8>) -> io::Result<()> {
    let label = |action: Action| model.encoding.label(action);
    let [high, low] = reason.scores;
    match reason.other {
        Some(other) => writeln!(out, "#  {} {high:.4}, then {} {low:.4}", label(reason.chosen), label(other))?,
        None => writeln!(out, "#  {} {high:.4}, which alone may stand here", label(reason.chosen))?,
    }
    let difference = |share: &Share| (share.chosen - share.other).abs();
    let mut shares: Vec<&Share> = reason.shares.iter().filter(|s| s.chosen != 0.0 || s.other != 0.0).collect();
    shares.sort_by(|a, b| difference(b).total_cmp(&difference(a)));
    let (told, rest) = shares.split_at(shares.len().min(TOLD));
    for share in told {
        writeln!(out, "#    {:+.4}  {:+.4}  {}", share.chosen, share.other, name(share.feature, names))?;
    }
    if !rest.is_empty() {
        let sum = |of: fn(&Share) -> f32| rest.iter().map(|share| of(share)).sum::<f32>();
        writeln!(out, "#    {:+.4}  {:+.4}  {} more", sum(|s| s.chosen), sum(|s| s.other), rest.len())?;
    }
    Ok(())
}

fn name(feature: u32, names: &Names<'_>) -> String {
    names(feature).unwrap_or_else(|| format!("feature {feature}"))
}

/// The same as one JSON object a token: all features in the order in which their weights are added up.
pub fn json<T: Task>(model: &Model<T>, asked: &Asked<'_, T>) -> Result<Vec<u8>> {
    #[derive(Serialize)]
    struct Token {
        line: usize,
        label: String,
        score: f32,
        other: Option<String>,
        other_score: Option<f32>,
        features: Vec<Part>,
    }
    #[derive(Serialize)]
    struct Part {
        feature: String,
        label: f32,
        other: f32,
    }
    let (answers, names) = (answers(model, asked)?, model.names(asked.data)?);
    let mut out = Vec::new();
    for (line, reason) in answers {
        let part =
            |share: &Share| Part { feature: name(share.feature, &names), label: share.chosen, other: share.other };
        let token = Token {
            line,
            label: model.encoding.label(reason.chosen),
            score: reason.scores[0],
            other: reason.other.map(|other| model.encoding.label(other)),
            other_score: reason.other.map(|_| reason.scores[1]),
            features: reason.shares.iter().map(part).collect(),
        };
        serde_json::to_writer(&mut out, &token).map_err(|error| super::closed(error.into()))?;
        out.push(b'\n');
    }
    Ok(out)
}
