//! What the parts of training and tagging cost, each after its answer was asserted.
//!
//! `cargo bench --bench speed`. The corpus is the first 2,000 sentences of CoNLL-2000 where `ROLLIN_DATA` says where that is, and
//! as many generated ones otherwise; everything runs on one thread. Throughput is in tokens per second (load and save: bytes).

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group};
use rollin::corpus::Corpus;
use rollin::grammar::{Grammar, defaults};
use rollin::learner::{Logistic, Online, Setting};
use rollin::policy::{Classifier, Greedy, Linear, Policy};
use rollin::read::{conll, template::Template};
use rollin::roll::{self, Actor, Costing, RollOut};
use rollin::space::{Action, Episode, Features, Imitation, Sight, Silent, Space};
use rollin::tasks::tagging::{Encoding, Tagger, Tagging, TaggingProblem};
use rollin::tasks::{About, AnyClassifier, AnyLearner, Trainer};
use rollin::trainer::{Dagger, Forward, Run, Searn, Smile, Supervised};
use rollin::worker::{Ledger, Visit, Worker, all};
use rollin::{Purpose, Seed};
use std::collections::HashMap;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const SENTENCES: usize = 2000;

/// The text, the corpus and its problem, a tagger of it and the tagger's classifier.
struct Bench {
    text: Vec<u8>,
    corpus: Corpus,
    template: Template,
    encoding: Encoding,
    problem: TaggingProblem,
    tagger: Tagger,
    policy: Greedy<Linear>,
}

impl Bench {
    fn new() -> Self {
        let (mut corpus, template) = match std::env::var_os("ROLLIN_DATA").map(PathBuf::from) {
            Some(data) => {
                let corpus = conll::read_file(data.join("conll2000/train.txt")).expect("the corpus");
                let path = Path::new("grammars/chunking.template");
                let template = Template::parse(&std::fs::read_to_string(path).expect("a file"), path);
                (corpus, template.expect("the template"))
            }
            None => {
                eprintln!("ROLLIN_DATA is not set: the corpus is generated");
                let grammar = Grammar::parse("dialects", defaults::GRAMMAR).expect("the grammar");
                let mut text = Vec::new();
                grammar.write(&grammar.generate(SENTENCES, Seed::new(1)), &mut text).expect("memory");
                (conll::parse(&text, Path::new("generated"), 1).expect("the corpus"), Template::default_for(1))
            }
        };
        corpus.truncate(SENTENCES);
        let text = text_of(&corpus);
        let (encoding, space) = Encoding::learn(&corpus, template.clone().into()).expect("features");
        let problem = space.problem();
        let policy =
            Dagger::default().train_online(&problem, &Logistic::default(), &Run::new(1)).expect("a policy").policy;
        let tagger = Tagger::new(encoding.clone(), policy.clone(), About::default()).expect("a tagger");
        Bench { text, corpus, template, encoding, problem, tagger, policy }
    }

    fn tokens(&self) -> Throughput {
        Throughput::Elements(self.corpus.tokens() as u64)
    }
}

/// A corpus to be tagged.
type Unlabelled = Imitation<Tagging, Silent>;

fn unlabelled(encoding: &Encoding, corpus: &Corpus) -> Unlabelled {
    let space = encoding.apply(corpus).expect("features");
    let episodes = space.sentences();
    Imitation { space, expert: Silent, episodes }
}

fn text_of(corpus: &Corpus) -> Vec<u8> {
    let mut text = String::new();
    for i in 0..corpus.sentences() {
        for token in corpus.sentence(i) {
            let cells: Vec<_> = (0..corpus.columns.len()).map(|column| corpus.word(column, token)).collect();
            text += &(cells.join(" ") + "\n");
        }
        text.push('\n');
    }
    text.into_bytes()
}

/// Reading, and features against those that a map of hashes from the standard library would number.
fn featurise(c: &mut Criterion, bench: &Bench) {
    let mut group = c.benchmark_group("featurise");
    group.throughput(bench.tokens());
    let read = || conll::parse(&bench.text, Path::new("text"), 1).expect("a corpus");
    assert_eq!(read().columns, bench.corpus.columns);
    group.bench_function("read", |b| b.iter(read));

    let learn = || Encoding::learn(&bench.corpus, bench.template.clone().into()).expect("features").1;
    let naive = || {
        let bound = bench.template.bind(&bench.corpus).expect("columns");
        let (mut numbers, mut hashes, mut rows) = (HashMap::new(), Vec::new(), Vec::new());
        for i in 0..bench.corpus.sentences() {
            for token in bench.corpus.sentence(i) {
                hashes.clear();
                bound.observe(bench.corpus.sentence(i), token, &mut hashes);
                let mut number = |hash: &u64| {
                    let next = numbers.len() as u32;
                    *numbers.entry(*hash).or_insert(next)
                };
                rows.push(hashes.iter().map(&mut number).collect::<Vec<u32>>());
            }
        }
        rows
    };
    // Numbers are given in another order: what is the same in one is to be the same in the other.
    let (space, rows) = (learn(), naive());
    let mut pairs = HashMap::new();
    for (t, row) in rows.iter().enumerate() {
        assert_eq!(space.shared().row(t as u32).len(), row.len());
        for (ours, theirs) in space.shared().row(t as u32).iter().zip(row) {
            assert_eq!(pairs.entry(*ours).or_insert(*theirs), theirs);
        }
    }
    group.bench_function("learn", |b| b.iter(learn));
    group.bench_function("learn, standard map", |b| b.iter(naive));
    group.bench_function("apply", |b| b.iter(|| bench.encoding.apply(&bench.corpus).expect("features")));
    group.finish();
}

/// The rows of weights that `policy` adds up on its way, and what it did there.
fn path<'p>(problem: &Unlabelled, policy: &'p Greedy<Linear>) -> (Vec<Vec<&'p [f32]>>, Vec<Action>) {
    let weights = &policy.0.weights;
    let (done, _) = roll::perform(problem, policy, Seed::new(1));
    let mut rows = Vec::new();
    let mut actions = done.actions.iter();
    for index in all(problem) {
        Worker::new(problem).episode(Episode { index, seed: Seed::new(1) }, |visit| {
            let sight = visit.sight();
            rows.push(sight.listed().iter().filter_map(|feature| weights.row(feature)).collect());
            actions.next().copied()
        });
    }
    (rows, done.actions)
}

/// Adds up `rows` token by token, with the sums in registers. All of what was added is returned, or else most of it would not be done.
fn gather<const N: usize>(rows: &[Vec<&[f32]>]) -> [f32; N] {
    let mut totals = [0.0; N];
    for token in rows {
        let mut sums = [0.0; N];
        for row in token.iter().filter_map(|row| row.first_chunk::<N>()) {
            sums.iter_mut().zip(row).for_each(|(sum, w)| *sum += w);
        }
        totals.iter_mut().zip(sums).for_each(|(total, sum)| *total += sum);
    }
    totals
}

/// Tagging's inner loop, with the model as it is read from its file, beside one that only gathers and adds the same rows at the same addresses.
fn score(c: &mut Criterion, bench: &Bench) {
    let tagger = Tagger::from_bytes(&bench.tagger.to_bytes(), Path::new("model")).expect("a tagger");
    let problem = unlabelled(&tagger.encoding, &bench.corpus);
    let [AnyClassifier::Linear(linear)] = tagger.policy.classifiers()[..] else { panic!("one linear classifier") };
    let policy = Greedy(linear.clone());
    let (rows, actions) = path(&problem, &policy);
    let gather = || match policy.0.weights.stride() {
        8 => _ = black_box(gather::<8>(&rows)),
        24 => _ = black_box(gather::<24>(&rows)),
        stride => panic!("rows of {stride}: one more arm for them, please"),
    };
    let roll = || roll::perform(&problem, &policy, Seed::new(1)).0.actions;
    assert_eq!(roll(), actions);
    assert_eq!(naive_scores(&problem, &policy), actions);

    let mut group = c.benchmark_group("score");
    group.throughput(bench.tokens());
    group.bench_function("gather and add", |b| b.iter(gather));
    group.bench_function("tagging's inner loop", |b| b.iter(roll));
    group.bench_function("naive", |b| b.iter(|| naive_scores(&problem, &policy)));
    group.finish();

    let mut times: Vec<f64> = (0..31)
        .map(|_| {
            let clock = |job: &dyn Fn()| {
                let start = Instant::now();
                job();
                start.elapsed().as_secs_f64()
            };
            clock(&gather) / clock(&|| _ = black_box(roll()))
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("tagging's inner loop runs at {:.0} % of the speed of gathering and adding alone", 100.0 * times[15]);
}

/// What the policy does when every score is added up one after the other.
fn naive_scores(problem: &Unlabelled, policy: &Greedy<Linear>) -> Vec<Action> {
    struct Naive<'a>(&'a Linear);
    impl Classifier<Features> for Naive<'_> {
        type Memory = Vec<f32>;
        fn scores<'m>(&self, sight: &Sight<'_, Features>, sums: &'m mut Vec<f32>) -> &'m [f32] {
            sums.clear();
            sums.resize(self.0.actions, 0.0);
            for feature in sight.listed().iter() {
                if let Some(row) = self.0.weights.row(feature) {
                    sums.iter_mut().zip(row).for_each(|(sum, w)| *sum += w);
                }
            }
            sums
        }
    }
    roll::perform(problem, &Greedy(Naive(&policy.0)), Seed::new(1)).0.actions
}

/// Roll-outs of every action that remember nothing.
struct Forgetful;

impl<D: Policy<TaggingProblem>> Costing<TaggingProblem, D> for Forgetful {
    type Memo = ();
    fn costs(
        &self,
        visit: &mut Visit<'_, TaggingProblem>,
        actor: Actor<'_, D, D::Memory, ()>,
        run: Seed,
        costs: &mut Vec<f64>,
    ) {
        let Actor { policy, memory, .. } = actor;
        costs.clear();
        let run = run.child(Purpose::RollOut, 0);
        let legal = visit.legal();
        costs.extend(legal.iter().map(|action| visit.roll_out(action, run, |visit| policy.act(visit, memory))));
    }
}

fn rolls(c: &mut Criterion, bench: &Bench) {
    let (problem, policy, episodes) = (&bench.problem, &bench.policy, all(&bench.problem));
    let mut group = c.benchmark_group("roll");
    group.throughput(bench.tokens()).sample_size(10);
    let roll_in = || roll::labels(problem, policy, &episodes, Seed::new(1));
    assert_eq!(roll_in().1.labels, bench.corpus.tokens() as u64);
    group.bench_function("in", |b| b.iter(roll_in));

    let naive = || roll::costs(problem, policy, &Forgetful, &episodes, Seed::new(1));
    let memo = || roll::costs(problem, policy, &RollOut { samples: 1 }, &episodes, Seed::new(1));
    let ((a, bill), (b, other)) = (naive(), memo());
    assert_eq!(bill, other);
    assert!((0..a.examples.len()).all(|i| a.examples.target(i) == b.examples.target(i)));
    group.bench_function("out, every action", |b| b.iter(memo));
    group.bench_function("out, every action, naive", |b| b.iter(naive));
    group.finish();
    threads("roll-ins", || roll_in().1);
    // What takes ten milliseconds may be over before the system has given each thread a core.
    let rounds = episodes.repeat(8);
    threads("roll-ins of eight rounds", || roll::labels(problem, policy, &rounds, Seed::new(1)).1);
    threads("roll-outs", || memo().1);
}

/// How much faster two threads are than one, by the clock: medians of runs in turn.
fn threads(what: &str, job: impl Fn() -> Ledger + Sync) {
    let pools = [1, 2].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads"));
    let bills = pools.each_ref().map(|pool| pool.install(&job));
    assert_eq!(bills[0], bills[1]);
    let mut times: Vec<[f64; 2]> = (0..11)
        .map(|_| {
            pools.each_ref().map(|pool| {
                let start = Instant::now();
                _ = black_box(pool.install(&job));
                start.elapsed().as_secs_f64()
            })
        })
        .collect();
    times.sort_by(|a, b| (a[0] / a[1]).total_cmp(&(b[0] / b[1])));
    let [one, two] = times[times.len() / 2];
    println!("{what}: two threads are {:.2} times as fast as one", one / two);
}

fn train(c: &mut Criterion, bench: &Bench) {
    let mut group = c.benchmark_group("train, one round");
    group.throughput(bench.tokens()).sample_size(10);
    let trainers = [
        ("supervised", Trainer::Supervised(Supervised::default())),
        ("forward", Trainer::Forward(Forward::default())),
        ("smile", Trainer::Smile(Smile { rounds: 1, ..Smile::default() })),
        ("searn", Trainer::Searn(Searn { rounds: 1, ..Searn::default() })),
        ("searn-shortcut", Trainer::SearnShortcut(Searn { rounds: 1, ..Searn::default() })),
        ("dagger", Trainer::Dagger(Dagger { rounds: 1, ..Dagger::default() })),
        ("dagger-online", Trainer::DaggerOnline(Dagger { rounds: 1, ..Dagger::default() })),
    ];
    let learner = AnyLearner::Logistic(Logistic { passes: 1, ..Logistic::default() });
    for (name, trainer) in trainers {
        let job = || trainer.train(&bench.problem, &learner, &Run::new(1)).expect("a policy");
        let trained = job();
        assert!(trained.ledger.queries >= bench.corpus.tokens() as u64, "{name}");
        assert_eq!(trained.ledger, job().ledger);
        group.bench_function(name, |b| b.iter(job));
    }
    group.finish();
}

/// A step of learning on what is known already, and on what is not.
fn learn(c: &mut Criterion, bench: &Bench) {
    let mut group = c.benchmark_group("learn");
    group.throughput(bench.tokens()).sample_size(10);
    for tolerance in [0.0, 0.05, 0.2] {
        let learner = Logistic { tolerance, ..Logistic::default() };
        let dagger = Dagger { rounds: 3, ..Dagger::default() };
        let job = || dagger.train_online(&bench.problem, &learner, &Run::new(1)).expect("a policy");
        assert_eq!(job().ledger.labels, 3 * bench.corpus.tokens() as u64);
        group.bench_with_input(BenchmarkId::new("three rounds, tolerance", tolerance), &(), |b, ()| b.iter(job));
    }
    // A course that is begun and finished: what all passes share.
    let learner = Logistic::default();
    let setting = Setting::of(&bench.problem);
    let empty = || learner.finish(learner.begin(setting, Some(&bench.policy.0)));
    assert_eq!(empty().weights.features(), bench.policy.0.weights.features());
    group.bench_function("begin and finish", |b| b.iter(empty));
    group.finish();
}

fn tag(c: &mut Criterion, bench: &Bench) {
    let mut group = c.benchmark_group("tag");
    group.throughput(bench.tokens());
    let encoded = || unlabelled(&bench.encoding, &bench.corpus);
    let expected: Vec<u32> =
        roll::perform(&encoded(), &bench.policy, Seed::new(1)).0.actions.iter().map(|action| action.0).collect();
    let job = || {
        let corpus = conll::parse(&bench.text, Path::new("text"), 1).expect("a corpus");
        bench.tagger.tag(&corpus, Seed::new(1)).expect("labels")
    };
    assert_eq!(job(), expected);
    group.bench_function("from text", |b| b.iter(job));
    group.finish();

    let bytes = bench.tagger.to_bytes();
    let load = || Tagger::from_bytes(&bytes, Path::new("model")).expect("a tagger");
    assert_eq!(load().to_bytes(), bytes);
    let mut group = c.benchmark_group("model");
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    group.bench_function("save", |b| b.iter(|| bench.tagger.to_bytes()));
    group.bench_function("load", |b| b.iter(load));
    group.finish();
}

fn everything(c: &mut Criterion) {
    let bench = Bench::new();
    for part in [featurise, score, rolls, learn, train, tag] {
        part(c, &bench);
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    targets = everything
}

/// On one thread.
fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        benches();
        Criterion::default().configure_from_args().final_summary();
    });
}
