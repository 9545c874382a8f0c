//! Orders of labels: the expert knows the way back into them, no policy leaves them, and what breaks them is mended.

use crate::common::{Sentences, corpus, encoded, fixed, is_optimal, learners, template, trainers};
use proptest::collection::vec;
use proptest::prelude::*;
use rollin::Seed;
use rollin::corpus::Corpus;
use rollin::score::{Scheme, Score};
use rollin::tasks::About;
use rollin::tasks::tagging::{Encoding, Order, Settings, Tagger, illegal, repair};
use rollin::trainer::Run;

/// Spans of two types by their lengths, 0 for a token outside, spelled in BILOU or IOBES.
fn spelled(spans: &[Vec<(usize, usize)>], letters: [&str; 2]) -> Sentences {
    let sentence = |spans: &Vec<(usize, usize)>| {
        let mut tokens = Vec::new();
        for (n, (length, kind)) in spans.iter().enumerate() {
            let label = |at: usize| match (at, *length) {
                (_, 0) => "O".to_owned(),
                (_, 1) => format!("{}-{}", letters[1], ["X", "Y"][*kind]),
                (0, _) => format!("B-{}", ["X", "Y"][*kind]),
                (at, length) if at + 1 == length => format!("{}-{}", letters[0], ["X", "Y"][*kind]),
                _ => format!("I-{}", ["X", "Y"][*kind]),
            };
            tokens.extend((0..(*length).max(1)).map(|at| (format!("w{}", (n + at) % 3), label(at))));
        }
        tokens
    };
    spans.iter().map(sentence).collect()
}

fn spans(sentences: usize, most: usize) -> impl Strategy<Value = Vec<Vec<(usize, usize)>>> {
    vec(vec((0usize..=3, 0usize..2), 1..=most), 1..=sentences)
}

/// Labels of any kind in any order.
fn anything() -> impl Strategy<Value = Sentences> {
    let label = "O|[BI]-[XY]|[BILU]-[XY]|[BIES]-[XY]";
    vec(vec(("[ab]", label).prop_map(|(word, label)| (word, label)), 1..7), 1..5)
}

/// The spans of each sentence, by names.
fn found(corpus: &Corpus) -> Vec<Vec<(usize, usize, String)>> {
    let names: Vec<&str> = corpus.columns[1].values.iter().collect();
    let scheme = Scheme::new(&names);
    let sentence = |i| scheme.spans(&corpus.columns[1].cells[corpus.sentence(i)]);
    let named = |spans: Vec<(usize, usize, u32)>| {
        spans.into_iter().map(|(start, end, kind)| (start, end, scheme.kinds()[kind as usize].clone())).collect()
    };
    (0..corpus.sentences()).map(|i| named(sentence(i))).collect()
}

proptest! {
    #![proptest_config(fixed(60))]

    #[test]
    fn the_expert_is_optimal_by_bilou(spans in spans(2, 2), iobes in any::<bool>()) {
        let sentences = spelled(&spans, if iobes { ["E", "S"] } else { ["L", "U"] });
        let (encoding, problem) = encoded(&sentences);
        let units = sentences.iter().flatten().any(|(_, label)| label == "O" || label.starts_with(['U', 'S']));
        let names = sentences.iter().flatten().any(|(_, label)| label != "O");
        let expected = if units && names { Order::Bilou } else { Order::Free };
        prop_assert_eq!(encoding.transitions.order(), expected);
        if let Err(what) = is_optimal(&problem) {
            return Err(TestCaseError::fail(what));
        }
    }

    #[test]
    fn the_expert_is_optimal_by_iob2(spans in spans(2, 2)) {
        let mut sentences = spelled(&spans, ["I", "B"]);
        sentences[0].push(("w".into(), "B-X".into()));
        if let Err(what) = is_optimal(&encoded(&sentences).1) {
            return Err(TestCaseError::fail(what));
        }
    }

    /// Whoever trains and whatever is tagged: spans begin and end as they should.
    #[test]
    fn nobody_leaves_bilou(train in spans(12, 4), other in spans(6, 4), which in 0usize..15, kind in 0usize..7) {
        let mut train = spelled(&train, ["L", "U"]);
        train[0].extend([("w".to_owned(), "O".to_owned()), ("w".to_owned(), "U-X".to_owned())]);
        let (encoding, problem) = encoded(&train);
        prop_assert_eq!(encoding.transitions.order(), Order::Bilou);
        let policy = trainers()[which].train(&problem, &learners()[kind], &Run::new(3)).unwrap().policy;
        let tagger = Tagger::new(encoding, policy, About::default()).unwrap();
        let unknown = corpus(&spelled(&other, ["L", "U"]));
        let tags = tagger.tag(&unknown, Seed::new(1)).unwrap();
        let mut tagged = Corpus::new("tagged", 2);
        for i in 0..unknown.sentences() {
            for token in unknown.sentence(i) {
                tagged.push(&[unknown.word(0, token), &tagger.encoding.labels[tags[token] as usize]], 1);
            }
            tagged.end_sentence();
        }
        prop_assert_eq!(illegal(&tagged, 1, Some(Order::Bilou)).0, Vec::<usize>::new());
    }

    #[test]
    fn what_is_mended_is_legal_and_has_the_same_spans(sentences in anything(), bilou in any::<bool>()) {
        let broken = corpus(&sentences);
        let order = if bilou { Order::Bilou } else { Order::Bio };
        let mut mended = broken.clone();
        let (wrong, _) = illegal(&broken, 1, Some(order));
        let told = match repair(&mut mended, 1, Some(order)) {
            Ok(told) => told,
            Err(_) => {
                // All are O, and O is never wrong.
                return Err(TestCaseError::fail("refused"));
            }
        };
        prop_assert_eq!(told.is_empty(), wrong.is_empty());
        // IOB2 may leave an L or a U where nothing is wrong with it.
        let legal = illegal(&mended, 1, Some(order)).0;
        prop_assert!(legal.is_empty(), "{legal:?}");
        prop_assert_eq!(found(&mended), found(&broken));
        // What is told is what was changed.
        let changed = (0..broken.tokens()).filter(|t| broken.word(1, *t) != mended.word(1, *t));
        let changed: Vec<_> = changed.map(|t| (broken.lines[t], mended.word(1, t).to_owned())).collect();
        prop_assert_eq!(told.iter().map(|m| (m.place.line, m.is.clone())).collect::<Vec<_>>(), changed);
        let mut again = mended.clone();
        prop_assert!(repair(&mut again, 1, Some(order)).unwrap().is_empty() && again == mended);
        prop_assert_eq!(&broken.columns[0], &mended.columns[0]);
    }
}

#[test]
fn spans_are_scored_by_every_spelling() {
    let spell = |letters| spelled(&[vec![(3, 0), (0, 0), (1, 1), (2, 1)]], letters);
    for letters in [["L", "U"], ["E", "S"], ["I", "B"]] {
        let labels: Vec<String> = spell(letters)[0].iter().map(|(_, label)| label.clone()).collect();
        let scheme = Scheme::new(&labels);
        let ids: Vec<u32> = (0..labels.len() as u32).collect();
        assert_eq!(scheme.spans(&ids), [(0, 3, 1), (4, 5, 2), (5, 7, 2)]);
        let mut score = Score::new(scheme);
        score.add(&ids, &ids).unwrap();
        assert_eq!((score.chunks().correct, score.f1()), (3, 1.0));
    }
}

#[test]
fn what_breaks_an_order_is_refused_with_its_line() {
    let broken =
        corpus(&vec![spelled(&[vec![(1, 0), (2, 0)]], ["L", "U"])[0].clone(), vec![("w".into(), "B-X".into())]]);
    let learn = |order| Encoding::learn(&broken, Settings { order, ..template().into() });
    let error = learn(Some(Order::Bilou)).unwrap_err().to_string();
    assert_eq!(error, "random:5:3: label B-X; expected a label that may stand there by bilou, as --repair makes it");
    assert_eq!(learn(None).unwrap().0.transitions.order(), Order::Free);
    let mut mended = broken.clone();
    let told = repair(&mut mended, 1, None).unwrap();
    assert_eq!(told.iter().map(ToString::to_string).collect::<Vec<_>>(), ["random:5:3: B-X is now U-X"]);
    let (encoding, _) = Encoding::learn(&mended, template().into()).unwrap();
    assert_eq!((encoding.transitions.order(), encoding.labels.len()), (Order::Bilou, 3));
    // Only spans can be spelled anew.
    let mut other = corpus(&vec![vec![("a".into(), "I-X".into()), ("b".into(), "N".into())]]);
    let error = repair(&mut other, 1, Some(Order::Bio)).unwrap_err().to_string();
    assert!(error.starts_with("random:1:3: label I-X, and not all labels are those of spans; expected "), "{error}");
}
