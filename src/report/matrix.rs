//! How often what was taken for what.

use super::markup::{clipped, escaped};
use super::table::Table;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// How often each right answer was given each answer: a confusion matrix. Only what occurred takes room.
///
/// ```
/// use rollin::report::Matrix;
///
/// let mut matrix = Matrix::default();
/// [("N", "N"), ("N", "V"), ("V", "V"), ("N", "N")].map(|(right, given)| matrix.add(right, given));
/// assert_eq!(matrix.count("N", "N"), 2);
/// assert_eq!(matrix.mistakes(), [("N", "V", 1)]);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Matrix {
    /// By right answer, then by given answer.
    counts: BTreeMap<String, BTreeMap<String, u64>>,
}

/// The most labels that are drawn; the rarest beyond are taken together.
const MOST: usize = 40;
/// The most kinds of mistakes that are told.
const MOST_TOLD: usize = 300;
/// What stands for those.
const OTHERS: &str = "(others)";

impl Matrix {
    /// Counts one answer.
    pub fn add(&mut self, right: &str, given: &str) {
        if !self.counts.contains_key(right) {
            self.counts.insert(right.to_owned(), BTreeMap::new());
        }
        let Some(row) = self.counts.get_mut(right) else { return };
        match row.get_mut(given) {
            Some(count) => *count += 1,
            None => drop(row.insert(given.to_owned(), 1)),
        }
    }

    /// Whether no answer was counted.
    pub fn is_empty(&self) -> bool {
        self.counts.is_empty()
    }

    /// How often `right` was answered with `given`.
    pub fn count(&self, right: &str, given: &str) -> u64 {
        self.counts.get(right).and_then(|row| row.get(given)).copied().unwrap_or(0)
    }

    /// All that was counted: right answer, given answer, how often; in the order of names.
    pub fn cells(&self) -> impl Iterator<Item = (&str, &str, u64)> {
        self.counts
            .iter()
            .flat_map(|(right, row)| row.iter().map(move |(given, count)| (right.as_str(), given.as_str(), *count)))
    }

    /// The wrong answers, the commonest first, of equals the first by name.
    pub fn mistakes(&self) -> Vec<(&str, &str, u64)> {
        let mut wrong: Vec<_> = self.cells().filter(|(right, given, _)| right != given).collect();
        wrong.sort_by_key(|(.., count)| std::cmp::Reverse(*count));
        wrong
    }

    /// The mistakes as a table; the rarest beyond 300 kinds together.
    pub fn table(&self) -> Table {
        let mut table = Table::new(["right", "given", "times", "of"]);
        let mistakes = self.mistakes();
        let (told, rest) = mistakes.split_at(mistakes.len().min(MOST_TOLD));
        for (right, given, count) in told {
            let of: u64 = self.counts[*right].values().sum();
            table.row([right.to_string(), given.to_string(), count.to_string(), of.to_string()]);
        }
        if !rest.is_empty() {
            let sum: u64 = rest.iter().map(|(.., count)| count).sum();
            table.row([OTHERS, OTHERS, &sum.to_string(), "-"]);
        }
        table
    }

    /// The labels that are drawn, by name, and the rest as one.
    fn drawn(&self) -> Vec<&str> {
        let mut sizes: BTreeMap<&str, u64> = BTreeMap::new();
        for (right, given, count) in self.cells() {
            *sizes.entry(right).or_default() += count;
            *sizes.entry(given).or_default() += count;
        }
        let mut labels: Vec<_> = sizes.into_iter().collect();
        if labels.len() <= MOST {
            return labels.into_iter().map(|(label, _)| label).collect();
        }
        labels.sort_by_key(|(_, size)| std::cmp::Reverse(*size));
        let mut labels: Vec<&str> = labels[..MOST - 1].iter().map(|(label, _)| *label).collect();
        labels.sort_unstable();
        labels.push(OTHERS);
        labels
    }

    /// The matrix as an SVG element: a row a right answer, a column a given one; a cell is the stronger, the larger its share of the row.
    pub fn svg(&self) -> String {
        let labels = self.drawn();
        let n = labels.len().max(1);
        let number: BTreeMap<&str, usize> = labels.iter().enumerate().map(|(i, label)| (*label, i)).collect();
        let at = |label: &str| number.get(label).copied().unwrap_or(n - 1);
        let mut cells: BTreeMap<(usize, usize), (u64, String)> = BTreeMap::new();
        let mut sums = vec![0; n];
        for (right, given, count) in self.cells() {
            let (row, column) = (at(right), at(given));
            sums[row] += count;
            let cell = cells.entry((row, column)).or_insert((0, String::new()));
            cell.0 += count;
            // Within the rest right and wrong are told apart in the table only.
            cell.1 = format!("{} given {}", labels[row], labels[column]);
        }
        let (left, top) = (96.0, 98.0);
        let side = (440.0 / n as f64).clamp(14.0, 44.0);
        let end = left + side * n as f64;
        let (wide, high) = (end.max(300.0) + 16.0, end - left + top + 14.0);
        let mut out = format!(
            "<svg class=\"chart matrix\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {wide} {high}\" role=\"img\" \
             aria-label=\"right answers, a row each, against given ones\" style=\"min-width:{}px\">\n",
            (0.8 * wide).round().max(300.0)
        );
        let _ = writeln!(
            out,
            "<text class=\"small\" x=\"4\" y=\"{}\">right ↓ given →</text><path class=\"frame\" d=\"M{left} {top}h{size}v{size}h-{size}z\"/>",
            top - 6.0,
            size = end - left
        );
        let small = if side < 20.0 { " class=\"small\"" } else { "" };
        for (i, label) in labels.iter().enumerate() {
            let (middle, label) = ((i as f64 + 0.5) * side, clipped(label, 11));
            let _ = writeln!(
                out,
                "<text{small} text-anchor=\"end\" x=\"{}\" y=\"{}\">{label}</text><text{small} transform=\"translate({} {}) rotate(-90)\">{label}</text>",
                left - 5.0,
                top + middle + 4.0,
                left + middle + 4.0,
                top - 5.0
            );
        }
        for ((row, column), (count, what)) in cells {
            let share = count as f64 / sums[row].max(1) as f64;
            let class = if row == column { "right" } else { "wrong" };
            let (x, y) = (left + column as f64 * side, top + row as f64 * side);
            let told = escaped(&format!("{what}: {count} of {} ({:.1}%)", sums[row], 100.0 * share));
            let _ = writeln!(
                out,
                "<rect class=\"cell {class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{side:.1}\" height=\"{side:.1}\" fill-opacity=\"{:.2}\"><title>{told}</title></rect>",
                // The root, so that rare mistakes are seen beside what is right.
                0.05 + 0.75 * share.sqrt()
            );
            if side >= 30.0 {
                let _ = writeln!(
                    out,
                    "<text class=\"count\" x=\"{:.1}\" y=\"{:.1}\">{count}</text>",
                    x + side / 2.0,
                    y + side / 2.0 + 4.0
                );
            }
        }
        out + "</svg>\n"
    }
}
