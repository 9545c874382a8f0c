//! Experts chosen at run time, with every trainer.

use crate::common::{Labels, learners, problem, sample, trainers};
use petgraph::graph::UnGraph;
use rollin::Seed;
use rollin::policy::Follow;
use rollin::roll::perform;
use rollin::space::experts::Flaw;
use rollin::tasks::Trainer;
use rollin::tasks::graph::{Labelling, Legend, Node};
use rollin::trainer::Run;

/// An expert without a flaw is the expert: the same bill, and classifiers that are equal.
#[test]
fn none_is_none() {
    let problem = problem(&sample(Labels::Spans(2), 10));
    let sound = Flaw::None.of(&problem, Seed::new(9)).expect("no flaw");
    for trainer in trainers() {
        let [plain, advised] = [
            trainer.train(&problem, &learners()[0], &Run::new(3)).expect("trains"),
            trainer.train(&sound, &learners()[0], &Run::new(3)).expect("trains"),
        ];
        assert_eq!(plain.ledger, advised.ledger, "{trainer:?}");
        assert_eq!(plain.policy.classifiers(), advised.policy.classifiers(), "{trainer:?}");
    }
}

/// Who is always silent is never billed; who always errs is wrong wherever there is another action; bad habits everywhere are wrong always in the same
/// way. Chances between change what is learned from run to run, and never with the seed alone.
#[test]
fn flaws_are_what_they_say() {
    let problem = problem(&sample(Labels::Free(4), 30));
    let cost = |flaw: Flaw, seed: u64| {
        let advised = flaw.of(&problem, Seed::new(4)).expect("a flaw");
        perform(&advised, &Follow, Seed::new(seed))
    };
    let tokens = problem.space.gold().len() as f64;
    let (silent, bill) = cost(Flaw::Silent(1.0), 1);
    assert_eq!((bill.labels, bill.expert_acts, bill.queries), (0, 0, 0));
    assert!(silent.actions.iter().all(|action| action.0 == 0));
    for flaw in [Flaw::Noisy(1.0), Flaw::Suboptimal(1.0)] {
        assert_eq!(cost(flaw, 1).0.costs.iter().sum::<f64>(), tokens, "{flaw:?}");
    }
    for flaw in [Flaw::Noisy(0.0), Flaw::Suboptimal(0.0), Flaw::Silent(0.0), Flaw::None] {
        assert_eq!(cost(flaw, 1).0.costs.iter().sum::<f64>(), 0.0, "{flaw:?}");
    }
    // Drawn anew in each run, and the same in the same one; habits stay.
    let half = |flaw: Flaw, seed| cost(flaw, seed).0.actions;
    assert_eq!(half(Flaw::Noisy(0.5), 1), half(Flaw::Noisy(0.5), 1));
    assert_ne!(half(Flaw::Noisy(0.5), 1), half(Flaw::Noisy(0.5), 2));
    assert_eq!(half(Flaw::Suboptimal(0.5), 1), half(Flaw::Suboptimal(0.5), 2));
}

/// Every trainer trains with every flaw; a silent expert's bill is no larger than a speaking one's.
#[test]
fn every_trainer_bears_them() {
    let problem = problem(&sample(Labels::Spans(2), 10));
    for trainer in trainers() {
        let full = trainer.train(&problem, &learners()[1], &Run::new(1)).expect("trains").ledger;
        for flaw in [Flaw::Noisy(0.3), Flaw::Suboptimal(0.3), Flaw::Silent(0.3)] {
            let advised = flaw.of(&problem, Seed::new(2)).expect("a flaw");
            let trained = trainer.train(&advised, &learners()[1], &Run::new(1)).expect("trains");
            let never_more =
                !matches!(trainer, Trainer::Cpi(_) | Trainer::Lols(_) | Trainer::LolsOnline(_) | Trainer::Searn(_));
            assert!(
                !never_more || trained.ledger.queries <= full.queries,
                "{trainer:?} {flaw:?}: {:?}",
                trained.ledger
            );
        }
    }
}

#[test]
fn names_are_read_and_odd_ones_refused() {
    assert_eq!(Flaw::parse("noisy:0.25").expect("a flaw"), Flaw::Noisy(0.25));
    assert_eq!(Flaw::parse("suboptimal:1").expect("a flaw"), Flaw::Suboptimal(1.0));
    assert_eq!(Flaw::parse("silent:0").expect("a flaw"), Flaw::Silent(0.0));
    assert_eq!(Flaw::parse("none").expect("a flaw"), Flaw::None);
    for text in ["", "noisy", "noisy:", "noisy:1.1", "noisy:-0.1", "noisy:NaN", "none:0.1", "bold:0.5", "silent:x"] {
        assert!(Flaw::parse(text).is_err(), "{text}");
    }
    // The states of graphs have no signatures.
    let mut graph = UnGraph::<Node, ()>::new_undirected();
    let node = graph.add_node(Node { features: vec![], label: 0 });
    let graphs = Labelling::new(Legend { labels: 1, features: 0 }, &[(graph, vec![node])]).expect("in order").problem();
    assert!(
        Flaw::Suboptimal(0.5).of(&graphs, Seed::new(1)).is_err() && Flaw::Noisy(0.5).of(&graphs, Seed::new(1)).is_ok()
    );
}
