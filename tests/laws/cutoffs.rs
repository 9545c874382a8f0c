//! What a cutoff leaves out, and that it leaves out nothing else.

use crate::common::{self, fixed, template};
use proptest::prelude::*;
use rollin::prelude::*;
use rollin::space::{Episode, Features, Space};
use rollin::tasks::tagging::Settings;
use std::collections::HashMap;

/// The names of the features of each token when the right labels are given: the static ones, and those of labels before.
fn seen(corpus: &Corpus, cutoff: u8) -> [Vec<Vec<String>>; 2] {
    let (encoding, space) =
        tagging::Encoding::learn(corpus, Settings { cutoff, ..template().into() }).expect("features");
    let names = encoding.feature_names(corpus).expect("the same columns");
    let name = |feature: &u32| names(*feature).expect("it occurs");
    let [mut fixed, mut dynamic] = [Vec::new(), Vec::new()];
    let mut view = Features::default();
    for (index, sentence) in (0..corpus.sentences()).map(|i| (i, corpus.sentence(i))) {
        let mut state = space.start(Episode { index, seed: rollin::Seed::new(1) });
        for token in sentence {
            space.look(&state, &mut view);
            fixed.push(space.shared().row(view.row).iter().map(name).collect::<Vec<_>>());
            let [_, (keyed, key), (rest, _)] = space.shared().listed(view.row, view.key, &view.dynamic).parts();
            let keyed: Vec<u32> = keyed.iter().map(|feature| feature + key).collect();
            dynamic.push(keyed.iter().chain(rest).map(name).collect());
            space.step(&mut state, Action(space.gold()[token]), rollin::Seed::new(1));
        }
    }
    [fixed, dynamic]
}

proptest! {
    #![proptest_config(fixed(60))]
    /// Features of the words that were seen often enough stand where they stood, the others are gone; those of labels before are as they were.
    #[test]
    fn what_is_seen_often_enough_stays(sentences in common::labels().prop_flat_map(|labels| common::corpora(labels, 6, 8)), cutoff in 0..5u8) {
        let corpus = common::corpus(&sentences);
        let [mut fixed, dynamic] = seen(&corpus, 0);
        let mut counts: HashMap<String, usize> = HashMap::new();
        fixed.iter().flatten().for_each(|name| *counts.entry(name.clone()).or_default() += 1);
        fixed.iter_mut().for_each(|row| row.retain(|name| counts[name] >= usize::from(cutoff)));
        prop_assert_eq!(seen(&corpus, cutoff), [fixed, dynamic]);
    }
}
