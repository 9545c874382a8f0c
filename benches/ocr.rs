//! Handwritten words, ten folds: every algorithm with the features and the learner of the DAgger paper, and what other features and learners
//! bring. Asserts what is claimed of the results, then prints them as tables.
//!
//! `ROLLIN_DATA=... cargo bench --bench ocr -- paper` or `-- ours`; `$ROLLIN_DATA/ocr/letters.tsv` has the words. Large is to learn from nine folds
//! and measure on the tenth, small to learn from one and measure on nine; results are means over the folds.

use rayon::prelude::*;
use rollin::Seed;
use rollin::learner::{CostTree, CrammerSinger, Examples, Learner, Logistic, Net, Setting, Svm};
use rollin::policy::{Linear, Policy, Reading};
use rollin::read::letters::{self, Letters};
use rollin::roll::{Shortcut, perform};
use rollin::space::{Features, Imitation};
use rollin::tasks::ocr::{Accuracy, Ocr, Scribe, Sightings};
use rollin::trainer::{Dagger, Forward, Run, Searn, Smile, Supervised, Trained};
use std::time::Instant;

type Reader = Imitation<Ocr, Scribe>;

/// How words are cut and seen.
#[derive(Clone)]
struct Setup {
    small: bool,
    see: Sightings,
    /// By how many pixels images are also moved to learn from, in each of eight directions.
    shifts: i32,
}

/// What ten folds brought: accuracies in percent.
struct Row {
    letters: Vec<f64>,
    words: f64,
    labels: u64,
    seconds: f64,
}

impl Row {
    fn mean(&self) -> f64 {
        self.letters.iter().sum::<f64>() / self.letters.len() as f64
    }

    /// The mean difference to `other` over the folds and its standard error.
    fn above(&self, other: &Row) -> (f64, f64) {
        let n = self.letters.len() as f64;
        let gaps: Vec<f64> = self.letters.iter().zip(&other.letters).map(|(a, b)| a - b).collect();
        let mean = gaps.iter().sum::<f64>() / n;
        let variance = gaps.iter().map(|gap| (gap - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (mean, (variance / n).sqrt())
    }
}

/// Trains and measures on every fold.
fn folds<D: Policy<Reader>>(data: &Letters, setup: &Setup, train: impl Fn(&Reader) -> Trained<D> + Sync) -> Row {
    let start = Instant::now();
    let space = |letters: &Letters| Ocr::new(letters, setup.see.clone()).expect("valid settings").problem();
    let found: Vec<(Accuracy, u64)> = (0..10u8)
        .into_par_iter()
        .map(|fold| {
            let learn = data.of_folds(|other| (other == fold) == setup.small);
            let mut moved = learn.clone();
            let by = [-setup.shifts, 0, setup.shifts];
            let moves = by.iter().flat_map(|down| by.map(|right| (*down, right)));
            moves.filter(|by| *by != (0, 0)).for_each(|(down, right)| moved.append(&learn.moved(down, right)));
            let trained = train(&space(&moved));
            let test = space(&data.of_folds(|other| (other == fold) != setup.small));
            let (done, _) = perform(&test, &trained.policy, Seed::new(2));
            (Accuracy::of(&test.space, &done.costs), trained.ledger.labels)
        })
        .collect();
    Row {
        letters: found.iter().map(|(accuracy, _)| 100.0 * accuracy.of_letters()).collect(),
        words: found.iter().map(|(accuracy, _)| 100.0 * accuracy.of_words()).sum::<f64>() / 10.0,
        labels: found.iter().map(|(_, labels)| labels).sum::<u64>() / 10,
        seconds: start.elapsed().as_secs_f64(),
    }
}

fn show(name: &str, row: &Row, beside: Option<&Row>) {
    let gap = beside.map_or("-".to_owned(), |other| {
        let (mean, error) = row.above(other);
        format!("{mean:+.2} ± {error:.2}")
    });
    println!("| {name} | {:.2} | {:.1} | {gap} | {} | {:.0} |", row.mean(), row.words, row.labels, row.seconds);
}

const HEAD: &str =
    "| | letters % | words % | above the row named | labels a fold | seconds |\n|---|--:|--:|--:|--:|--:|";

fn fit<D>(trained: rollin::Result<Trained<D>>) -> Trained<D> {
    trained.expect("valid settings")
}

/// Support vector machines whose C is for as many examples as one round has. The more rounds are learned from at once, the less each example counts: so
/// what is minimised is a round's regularised loss, or the mean of several rounds', and every trainer is regularised alike.
struct Alike(f32);

/// The letters of nine folds, about.
const ROUND: f32 = 46_937.0;

impl Learner<Features> for Alike {
    type Classifier = Linear;

    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        warm: Option<&Linear>,
        seed: Seed,
    ) -> Linear {
        let cost = self.0 * ROUND / examples.len() as f32;
        Svm { cost, ..Svm::default() }.fit(setting, examples, warm, seed)
    }
}

/// The DAgger paper's figure: 128 pixels and the letter before, a linear support vector machine for all pairs, 20 iterations.
fn paper(data: &Letters, cost: f32) {
    let svm = Alike(cost);
    let large = Setup { small: false, see: Sightings::default(), shifts: 0 };
    let alone = Setup { see: Sightings { history: 0, ..Sightings::default() }, ..large.clone() };
    let run = || Run::new(1);
    println!("\nLarge, pixels and the letter before, all-pairs SVM with C = {cost}, 20 iterations\n\n{HEAD}");
    let none = folds(data, &alone, |p| fit(Supervised::default().train(p, &svm, &run())));
    show("no structure", &none, None);
    let supervised = folds(data, &large, |p| fit(Supervised::default().train(p, &svm, &run())));
    show("supervised (above no structure)", &supervised, Some(&none));
    let dagger = Dagger { rounds: 20, ..Dagger::default() };
    let dagger = folds(data, &large, |p| fit(dagger.train(p, &svm, &run())));
    show("DAgger (above supervised)", &dagger, Some(&supervised));
    let smile = Smile { alpha: 0.1, rounds: 20, ..Smile::default() };
    let smile = folds(data, &large, |p| fit(smile.train(p, &svm, &run())));
    show("SMILe 0.1 (above DAgger)", &smile, Some(&dagger));
    let searn = |beta| {
        let searn = Searn { beta, rounds: 20, ..Searn::default() };
        folds(data, &large, |p| fit(searn.train_by(p, &svm, &Shortcut, &run())))
    };
    let (slow, fast, whole) = (searn(0.1), searn(0.8), searn(1.0));
    show("SEARN 0.1 (above DAgger)", &slow, Some(&dagger));
    show("SEARN 0.8 (above DAgger)", &fast, Some(&dagger));
    show("SEARN 1 (above DAgger)", &whole, Some(&dagger));
    assert!(dagger.mean() >= 85.5, "{}", dagger.mean());
    // The paper's order, each by more than two standard errors.
    let order = [
        (&supervised, &none),
        (&dagger, &supervised),
        (&dagger, &smile),
        (&dagger, &slow),
        (&whole, &smile),
        (&whole, &slow),
    ];
    for (better, worse) in order {
        let (mean, error) = better.above(worse);
        println!("\n{:.2} above {:.2}: {mean:+.2} ± {error:.2}", better.mean(), worse.mean());
    }
    for (better, worse) in order {
        let (mean, error) = better.above(worse);
        assert!(mean > 2.0 * error, "{mean} ± {error}");
    }
}

/// Logistic regression that leaves hardly any example alone, as the results were measured: gone over a second time, a word that was
/// just learned is almost certain, and little would be learned from it.
fn thorough() -> Logistic {
    Logistic { tolerance: 1e-4, ..Logistic::default() }
}

/// Other features, one after the other, with one learner and one trainer; then other learners and trainers.
fn ours(data: &Letters) {
    let logistic = thorough();
    let online = Dagger { rounds: 5, ..Dagger::default() };
    let run = || Run::new(1);
    let patches = Sightings { patch: 3, history: 2, ..Sightings::default() };
    let whole = Sightings { history: 14, rest: true, ..patches.clone() };
    let twice = Sightings { passes: 2, ..whole.clone() };
    let steps = [
        ("pixels, 1 letter before", Sightings::default(), 0),
        ("patches to 3 by 3, 2 letters before", patches.clone(), 0),
        ("all letters before and how many are left", whole.clone(), 0),
        ("the word gone over twice", twice.clone(), 0),
        ("images moved by a pixel, too", twice.clone(), 1),
    ];
    for small in [false, true] {
        println!(
            "\n{}: DAgger, online, 5 rounds, logistic regression\n\n{HEAD}",
            if small { "Small" } else { "Large" }
        );
        let mut before: Option<Row> = None;
        for (name, see, shifts) in &steps {
            let setup = Setup { small, see: see.clone(), shifts: *shifts };
            let row = folds(data, &setup, |p| fit(online.train_online(p, &logistic, &run())));
            show(name, &row, before.as_ref());
            before = Some(row);
        }
        let (mean, goal) = (before.map_or(0.0, |row| row.mean()), if small { 85.0 } else { 95.5 });
        assert!(mean >= goal, "{mean} of {goal}");
    }
}

/// Every trainer, and every learner that the task needs to be tried with, on the small set.
fn all(data: &Letters) {
    let setup = Setup { small: true, see: Sightings::default(), shifts: 0 };
    let (run, logistic) = (|| Run::new(1), thorough());
    println!("\nSmall, pixels and the letter before: trainers, with logistic regression\n\n{HEAD}");
    let dagger = Dagger::default();
    show("supervised", &folds(data, &setup, |p| fit(Supervised::default().train(p, &logistic, &run()))), None);
    show("forward", &folds(data, &setup, |p| fit(Forward::default().train(p, &logistic, &run()))), None);
    let smile = |p: &Reader| fit(Smile::default().train(p, &logistic, &run())).map(|m| m.read_as(Reading::Mean));
    show("SMILe, mean", &folds(data, &setup, smile), None);
    let searn = |p: &Reader| fit(Searn::default().train(p, &logistic, &run())).map(|m| m.read_as(Reading::Mean));
    show("SEARN, mean", &folds(data, &setup, searn), None);
    show("DAgger", &folds(data, &setup, |p| fit(dagger.train(p, &logistic, &run()))), None);
    show("DAgger, online", &folds(data, &setup, |p| fit(dagger.train_online(p, &logistic, &run()))), None);
    println!("\nSmall, pixels and the letter before: learners, with DAgger, 5 rounds\n\n{HEAD}");
    let svm = Svm { cost: 0.03, ..Svm::default() };
    show("all-pairs SVM, C = 0.03", &folds(data, &setup, |p| fit(dagger.train(p, &svm, &run()))), None);
    let crammer = CrammerSinger { cost: 0.03, ..CrammerSinger::default() };
    show("Crammer-Singer, C = 0.03", &folds(data, &setup, |p| fit(dagger.train(p, &crammer, &run()))), None);
    let net = Net { units: 128, ..Net::default() };
    show("net of 128 units", &folds(data, &setup, |p| fit(dagger.train(p, &net, &run()))), None);
    let tree = CostTree::default();
    show("cost-sensitive tree", &folds(data, &setup, |p| fit(dagger.train(p, &tree, &run()))), None);
}

fn main() {
    let Ok(path) = std::env::var("ROLLIN_DATA") else {
        println!("skipped: ROLLIN_DATA does not say where ocr/letters.tsv is");
        return;
    };
    let data = letters::read_file(std::path::Path::new(&path).join("ocr/letters.tsv")).expect("the words");
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    match arguments.first().map(String::as_str) {
        Some("paper") => {
            let cost = arguments.get(1).map_or(Ok(0.3), |cost| cost.parse()).expect("a number for C");
            paper(&data, cost);
        }
        Some("ours") => ours(&data),
        Some("all") => all(&data),
        _ => println!("say which: paper [C], ours or all"),
    }
}
