//! The expert of tagging against brute force over all legal completions.

use crate::common::{any_corpora, fixed, problem};
use proptest::prelude::*;
use rollin::Seed;
use rollin::space::{Action, CostToGo, Episode, Expert, Imitation, Space};
use rollin::tasks::tagging::{Encoding, Gold, Order, Position, Settings, Tagging};

/// Visits every state that any legal labels lead to, and returns the cost of the best completion.
fn best(space: &Tagging, state: &Position, each: &mut impl FnMut(&Position, &[f64])) -> f64 {
    let costs: Vec<f64> = space
        .legal(state)
        .iter()
        .map(|action| {
            let mut next = state.clone();
            space.step(&mut next, action, Seed::new(0)) + best(space, &next, each)
        })
        .collect();
    if costs.is_empty() {
        return 0.0;
    }
    each(state, &costs);
    costs.iter().copied().fold(f64::INFINITY, f64::min)
}

fn start(space: &Tagging, index: usize) -> Position {
    space.start(Episode { index, seed: Seed::new(0) })
}

proptest! {
    #![proptest_config(fixed(200))]

    /// In every reachable state of every sentence: costs-to-go are the minima over all completions, the answer is
    /// legal and starts an optimal one, it is the right label wherever that is legal, and else the B of the I that is
    /// not.
    #[test]
    fn answers_are_optimal(sentences in any_corpora(3, 5)) {
        let names: Vec<String> = {
            let mut names: Vec<String> = sentences.iter().flatten().map(|(_, label)| label.clone()).collect();
            names.sort();
            names.dedup();
            names
        };
        let Imitation { space, .. } = problem(&sentences);
        let mut found = Vec::new();
        let mut first = 0;
        for (i, sentence) in sentences.iter().enumerate() {
            let from = start(&space, i);
            let cheapest = best(&space, &from, &mut |state, costs| {
                let answer = Gold.action(&space, state).expect("the labels are known");
                let legal = space.legal(state);
                let place = legal.place(answer).expect("the answer is legal");
                assert!(costs.iter().all(|cost| costs[place] <= *cost), "{answer:?} of {costs:?} in {state:?}");
                Gold.costs(&space, state, &mut found);
                assert_eq!(found, costs, "in {state:?}");

                // A wrong label costs 1: which token this is shows in what its right label would cost.
                let mut next = state.clone();
                let right = (0..names.len() as u32).map(Action).find(|a| {
                    space.step(&mut { next.clone_from(state); next.clone() }, *a, Seed::new(0)) == 0.0
                });
                let right = right.expect("one label is right");
                if legal.contains(right) {
                    assert_eq!(answer, right);
                } else {
                    let (right, answer) = (&names[right.index()], &names[answer.index()]);
                    assert_eq!((&right[..2], &answer[..2], &right[2..]), ("I-", "B-", &answer[2..]));
                }
            });
            prop_assert_eq!(cheapest, 0.0, "the right labels are legal");
            first += sentence.len();
        }
        prop_assert_eq!(first, space.gold().len());
    }
}

/// After a learner's wrong O, a gold I-NP is answered with B-NP; after a wrong B-VP too; and after B-NP with itself.
#[test]
fn a_broken_span_is_begun_anew() {
    let text = "B-NP I-NP I-NP O B-VP I-VP";
    let sentences = vec![text.split(' ').map(|label| ("w".into(), label.into())).collect()];
    let space = problem(&sentences).space;
    let names = ["B-NP", "B-VP", "I-NP", "I-VP", "O"];
    let answer = |labels: &[&str]| {
        let mut state = start(&space, 0);
        for label in labels {
            let action = Action(names.iter().position(|n| n == label).unwrap() as u32);
            assert!(space.legal(&state).contains(action), "{label} is not legal");
            space.step(&mut state, action, Seed::new(0));
        }
        let mut costs = Vec::new();
        Gold.costs(&space, &state, &mut costs);
        let legal: Vec<&str> = space.legal(&state).iter().map(|a| names[a.index()]).collect();
        (names[Gold.action(&space, &state).unwrap().index()], legal, costs)
    };
    // O instead of B-NP: one label is lost now; after another O or a VP one more.
    assert_eq!(answer(&["O"]), ("B-NP", vec!["B-NP", "B-VP", "O"], vec![1.0, 2.0, 2.0]));
    assert_eq!(answer(&["B-VP"]), ("B-NP", vec!["B-NP", "B-VP", "I-VP", "O"], vec![1.0, 2.0, 2.0, 2.0]));
    assert_eq!(answer(&["B-NP"]), ("I-NP", vec!["B-NP", "B-VP", "I-NP", "O"], vec![1.0, 2.0, 0.0, 2.0]));
    // At the second I-NP nothing that follows depends on it: only its type speaks for B-NP.
    assert_eq!(answer(&["O", "O"]), ("B-NP", vec!["B-NP", "B-VP", "O"], vec![1.0, 1.0, 1.0]));
    // Last of all I-VP after O: B-VP for its type, though B-NP is lower and no worse.
    assert_eq!(answer(&["O"; 5]), ("B-VP", vec!["B-NP", "B-VP", "O"], vec![1.0; 3]));
}

/// Where every label may follow every other the answer is the right label, and every other costs 1.
#[test]
fn free_labels_cost_one_each() {
    let sentences = vec![vec![("a".into(), "I-NP".into()), ("b".into(), "O".into())]];
    let corpus = crate::common::corpus(&sentences);
    let learn = |order| {
        let settings = Settings { order: Some(order), ..crate::common::template().into() };
        Encoding::learn(&corpus, settings)
    };
    let (_, space) = learn(Order::Free).unwrap();
    let mut costs = Vec::new();
    Gold.costs(&space, &start(&space, 0), &mut costs);
    assert_eq!((Gold.action(&space, &start(&space, 0)), costs), (Some(Action(0)), vec![0.0, 1.0]));
    // Asked to hold such labels to IOB2, the encoding refuses.
    assert!(learn(Order::Bio).is_err());
}
