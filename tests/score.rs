//! Scores against cases worked by hand, against an independent program, and against a slower way to count chunks.

use proptest::prelude::*;
use rollin::score::{Chunks, Scheme, Score};

/// The score of sentences given as text, sentences separated by `|`.
fn score(gold: &str, predicted: &str) -> Score {
    let mut scheme = Scheme::new(&[] as &[&str]);
    let mut read = |text: &str| -> Vec<Vec<u32>> {
        text.split('|').map(|sentence| sentence.split_whitespace().map(|label| scheme.id(label)).collect()).collect()
    };
    let (gold, predicted) = (read(gold), read(predicted));
    assert_eq!(gold.len(), predicted.len());
    let mut score = Score::new(scheme);
    for (gold, predicted) in gold.iter().zip(&predicted) {
        score.add(gold, predicted).unwrap();
    }
    score
}

/// Chunks gold, predicted and correct.
fn chunks(gold: &str, predicted: &str) -> [u64; 3] {
    let Chunks { gold, predicted, correct } = score(gold, predicted).chunks();
    [gold, predicted, correct]
}

/// How many chunks a sequence spells.
fn count(labels: &str) -> u64 {
    let [gold, predicted, correct] = chunks(labels, labels);
    assert_eq!((gold, gold), (predicted, correct), "{labels}");
    gold
}

#[test]
fn chunks_are_counted_by_hand() {
    // IOB2: every chunk begins with B.
    assert_eq!(count("B-NP I-NP O B-VP B-NP B-NP I-NP"), 4);
    // IOB1: B only between neighbours of one type.
    assert_eq!(count("I-NP I-NP B-NP I-NP O I-VP"), 3);
    // IOE1 and IOE2: E closes.
    assert_eq!(count("I-NP E-NP I-NP O E-NP E-NP"), 4);
    // IOBES, where every chunk says where it begins and ends.
    assert_eq!(count("S-NP B-NP I-NP E-NP S-VP S-VP B-NP E-NP B-NP E-NP O S-NP"), 7);
    // The type changes inside I-: two chunks.
    assert_eq!(count("B-NP I-NP I-VP I-VP"), 2);
    // I- after O starts a chunk.
    assert_eq!(count("O I-NP I-NP O I-NP"), 2);
    // A chunk ends with its sentence.
    assert_eq!(count("B-NP I-NP | I-NP I-NP | I-NP"), 3);
    assert_eq!(count("B-NP I-NP I-NP I-NP I-NP"), 1);
    // B then E, or I then E, are one chunk; E after O is a chunk.
    assert_eq!(count("B-NP E-NP O E-NP"), 2);
    // Brackets are chunks of one token, and what follows of their type is outside.
    assert_eq!(count("[-NP ]-NP [-NP I-NP O"), 3);
    // Labels without a type: a chunk whose type is empty.
    assert_eq!(count("B I O I O B B"), 4);
    // Types may have hyphens; these are three types.
    assert_eq!(count("B-A I-A-B I-A-C I-A-C"), 3);
    // Parts of speech spell no chunks.
    assert_eq!(count("DT NN VBZ ."), 0);
    assert_eq!(count("O O | O"), 0);
    assert_eq!(count(""), 0);
}

#[test]
fn a_chunk_is_correct_only_as_a_whole() {
    assert_eq!(chunks("B-NP I-NP O", "B-NP I-NP O"), [1, 1, 1]);
    // Too short, too long, begun too late, of another type, missed, invented.
    assert_eq!(chunks("B-NP I-NP O", "B-NP O O"), [1, 1, 0]);
    assert_eq!(chunks("B-NP I-NP O", "B-NP I-NP I-NP"), [1, 1, 0]);
    assert_eq!(chunks("B-NP I-NP O", "O I-NP O"), [1, 1, 0]);
    assert_eq!(chunks("B-NP I-NP O", "B-VP I-VP O"), [1, 1, 0]);
    assert_eq!(chunks("B-NP I-NP O", "O O O"), [1, 0, 0]);
    assert_eq!(chunks("O O O", "O B-NP O"), [0, 1, 0]);
    // Split in two, joined to one; at the end of a sentence too.
    assert_eq!(chunks("B-NP I-NP", "B-NP B-NP"), [1, 2, 0]);
    assert_eq!(chunks("B-NP B-NP", "B-NP I-NP"), [2, 1, 0]);
    assert_eq!(chunks("B-NP | I-NP", "B-NP | O"), [2, 1, 1]);
    // The script lets a chunk of another prefix, here NN, run on over a full stop until the types part.
    assert_eq!(chunks("B-X NN . B-X", "B-X NN . NN"), [3, 2, 1]);
    // Another spelling of the same chunk is correct as a chunk, though its tokens are wrong.
    assert_eq!(chunks("O B-NP E-NP S-NP", "O I-NP I-NP B-NP"), [2, 2, 2]);
    assert_eq!(score("O B-NP E-NP S-NP", "O I-NP I-NP B-NP").right(), 1);
}

#[test]
fn measures_follow_from_the_counts() {
    let score = score("B-NP I-NP O B-VP | B-NP O", "B-NP I-NP B-NP B-NP | B-NP B-PP");
    assert_eq!((score.tokens(), score.right()), (6, 3));
    assert_eq!(score.chunks(), Chunks { gold: 3, predicted: 5, correct: 2 });
    assert_eq!((score.accuracy(), score.precision(), score.f1()), (0.5, 0.4, 0.5));
    assert_eq!(score.recall(), 2.0 / 3.0);
    let types = [
        ("NP", Chunks { gold: 2, predicted: 4, correct: 2 }),
        ("PP", Chunks { gold: 0, predicted: 1, correct: 0 }),
        ("VP", Chunks { gold: 1, predicted: 0, correct: 0 }),
    ];
    assert_eq!(score.types(), types);
}

/// The text is what Perl's `printf` makes of the formats and expressions in conlleval.pl.
#[test]
fn the_table_is_conllevals() {
    let some = score("B-NP I-NP O B-VP | B-NP O", "B-NP I-NP B-NP B-NP | B-NP B-PP");
    let table = "\
processed 6 tokens with 3 phrases; found: 5 phrases; correct: 2.
accuracy:  50.00%; precision:  40.00%; recall:  66.67%; FB1:  50.00
               NP: precision:  50.00%; recall: 100.00%; FB1:  66.67  4
               PP: precision:   0.00%; recall:   0.00%; FB1:   0.00  1
               VP: precision:   0.00%; recall:   0.00%; FB1:   0.00  0
";
    assert_eq!(some.to_string(), table);
    // 1 of 32 is exactly halfway between 3.12 and 3.13; Perl rounds to even.
    let gold = format!("B-X{}", " B-X".repeat(31));
    let halfway = score(&gold, &format!("B-X{}", " O".repeat(31))).to_string();
    assert!(halfway.contains("accuracy:   3.12%; precision: 100.00%; recall:   3.12%; FB1:   6.06\n"), "{halfway}");
    let nothing = "processed 0 tokens with 0 phrases; found: 0 phrases; correct: 0.\n";
    assert_eq!(score("", "").to_string(), nothing);
}

#[test]
fn empty_denominators_give_zero() {
    for score in [score("", ""), score("O", "NN"), score("B-NP", "O"), score("O", "B-NP")] {
        let measures = [score.accuracy(), score.precision(), score.recall(), score.f1()];
        assert_eq!(measures, [0.0; 4], "{score}");
    }
}

#[test]
fn a_gold_label_that_the_model_does_not_know_is_an_error() {
    let mut scheme = Scheme::new(&["B-NP", "I-NP", "O"]);
    let gold = ["B-NP", "B-UCP", "I-UCP", "O"].map(|label| scheme.id(label));
    assert_eq!(gold, [0, 3, 4, 2]);
    let mut score = Score::new(scheme);
    for predicted in [[0, 0, 1, 2], [0, 1, 1, 2], [0, 2, 2, 2]] {
        score.add(&gold, &predicted).unwrap();
    }
    assert_eq!((score.tokens(), score.right()), (12, 6));
    let ucp = Chunks { gold: 3, predicted: 0, correct: 0 };
    assert_eq!(score.types(), [("NP", Chunks { gold: 3, predicted: 4, correct: 2 }), ("UCP", ucp)]);
}

#[test]
fn spans_are_recognised_by_their_labels() {
    assert!(Scheme::new(&["O", "B-NP", "I-NP"]).is_spans());
    assert!(Scheme::new(&["S-X", "E-X"]).is_spans());
    assert!(!Scheme::new(&["O"]).is_spans());
    assert!(!Scheme::new(&[] as &[&str]).is_spans());
    assert!(!Scheme::new(&["B-NP", "O", "NN"]).is_spans());
    assert!(!Scheme::new(&["DT", "NN", "."]).is_spans());
    assert!(!Scheme::new(&["B", "I", "O"]).is_spans());
    // A stray gold label does not change what the model's labels are.
    let mut scheme = Scheme::new(&["O", "B-NP"]);
    assert_eq!((scheme.id("NN"), scheme.is_spans()), (2, true));
}

#[test]
fn labels_with_the_same_prefix_and_type_are_the_same() {
    let mut scheme = Scheme::new(&["X", "X-", "X"]);
    assert_eq!(["X", "X-", "Y"].map(|label| scheme.id(label)), [0, 0, 3]);
    let mut score = Score::new(scheme);
    score.add(&[0, 1, 2, 3], &[1, 2, 0, 0]).unwrap();
    assert_eq!(score.right(), 3);
}

#[test]
fn what_cannot_be_counted_is_refused_and_counts_nothing() {
    let mut score = Score::new(Scheme::new(&["O", "B-NP"]));
    let error = score.add(&[0, 1], &[0]).unwrap_err();
    assert_eq!(error.to_string(), "predicted is 1 labels, but must be as long as gold, 2 labels");
    let error = score.add(&[0, 2], &[0, 1]).unwrap_err();
    assert_eq!(error.to_string(), "gold is label id 2, but must be below 2");
    let error = score.add(&[0, 0], &[0, u32::MAX]).unwrap_err();
    assert_eq!(error.to_string(), "predicted is label id 4294967295, but must be below 2");
    let error = score.merge(&Score::new(Scheme::new(&["O"]))).unwrap_err();
    assert_eq!(
        error.to_string(),
        "other is a score over 1 labels, but must be over the same 2 labels in the same order"
    );
    assert_eq!(score, Score::new(Scheme::new(&["O", "B-NP"])));
}

#[test]
fn as_data_it_has_counts_and_measures() {
    let json = serde_json::to_value(score("B-NP O", "B-NP B-VP")).unwrap();
    let expected = serde_json::json!({
        "tokens": 2, "right": 1, "accuracy": 0.5,
        "chunks": { "gold": 1, "predicted": 2, "correct": 1, "precision": 0.5, "recall": 1.0, "f1": 2.0 / 3.0 },
        "types": [
            { "type": "NP", "gold": 1, "predicted": 1, "correct": 1, "precision": 1.0, "recall": 1.0, "f1": 1.0 },
            { "type": "VP", "gold": 0, "predicted": 1, "correct": 0, "precision": 0.0, "recall": 0.0, "f1": 0.0 },
        ],
    });
    assert_eq!(json, expected);
}

#[test]
fn an_independent_program_counts_the_same() {
    let mut cases = 0;
    for line in include_str!("data/chunks.tsv").lines().filter(|line| !line.starts_with('#')) {
        let columns: Vec<&str> = line.split('\t').collect();
        let [_, gold, predicted, tokens, right, g, p, correct, types] = columns[..] else { panic!("columns: {line}") };
        let number = |text: &str| text.parse::<u64>().unwrap();
        let score = score(gold, predicted);
        assert_eq!((score.tokens(), score.right()), (number(tokens), number(right)), "{line}");
        assert_eq!(chunks(gold, predicted), [g, p, correct].map(number), "{line}");
        let found = score.types().into_iter().map(|(name, Chunks { gold, predicted, correct })| {
            format!("{}:{gold}/{predicted}/{correct}", if name.is_empty() { "_" } else { name })
        });
        assert_eq!(found.collect::<Vec<_>>().join(" "), types, "{line}");
        cases += 1;
    }
    assert_eq!(cases, 160);
}

const LABELS: [&str; 10] = ["O", "B-X", "I-X", "E-X", "S-X", "B-Y", "I-Y", "E-Y", "S-Y", "O"];

/// The chunks of one sentence as (first token, token after the last, type), told apart by where they can begin: a second way
/// to count, for labels of IOBES only.
fn spans(labels: &[u32]) -> Vec<(usize, usize, &'static str)> {
    let label = |i: usize| LABELS[labels[i] as usize];
    let kind = |i: usize| label(i).get(2..).unwrap_or("");
    let continues = |i: usize| {
        let joins = matches!(&label(i)[..1], "I" | "E") && matches!(&label(i - 1)[..1], "B" | "I");
        joins && kind(i) == kind(i - 1)
    };
    let begins = (0..labels.len()).filter(|&i| label(i) != "O" && (i == 0 || !continues(i)));
    let end =
        |first: usize| (first + 1..labels.len()).find(|&i| label(i) == "O" || !continues(i)).unwrap_or(labels.len());
    begins.map(|first| (first, end(first), kind(first))).collect()
}

/// Pairs of sentences of the same length, the second mostly equal to the first.
fn sentences() -> impl Strategy<Value = Vec<Vec<(u32, u32)>>> {
    let token = (0..10u32, 0..10u32, 0..4u8).prop_map(|(g, p, other)| (g, if other == 0 { p } else { g }));
    prop::collection::vec(prop::collection::vec(token, 0..12), 0..6)
}

fn count_all(sentences: &[Vec<(u32, u32)>], swap: bool) -> Score {
    let mut score = Score::new(Scheme::new(&LABELS));
    for sentence in sentences {
        let (gold, predicted): (Vec<u32>, Vec<u32>) = sentence.iter().copied().unzip();
        if swap { score.add(&predicted, &gold) } else { score.add(&gold, &predicted) }.unwrap();
    }
    score
}

proptest! {
    #[test]
    fn counts_agree_with_sets_of_spans(sentences in sentences()) {
        let mut expected = Chunks::default();
        for sentence in &sentences {
            let (gold, predicted): (Vec<u32>, Vec<u32>) = sentence.iter().copied().unzip();
            let (gold, predicted) = (spans(&gold), spans(&predicted));
            expected.gold += gold.len() as u64;
            expected.predicted += predicted.len() as u64;
            expected.correct += predicted.iter().filter(|span| gold.contains(span)).count() as u64;
        }
        prop_assert_eq!(count_all(&sentences, false).chunks(), expected);
    }

    #[test]
    fn counts_are_consistent(sentences in sentences()) {
        let score = count_all(&sentences, false);
        prop_assert_eq!(score.tokens(), sentences.iter().map(|sentence| sentence.len() as u64).sum::<u64>());
        prop_assert!(score.right() <= score.tokens());
        for (name, chunks) in score.types() {
            prop_assert!(chunks.correct <= chunks.gold.min(chunks.predicted), "{name}: {chunks:?}");
        }
        let low = score.precision().min(score.recall()) - 1e-12;
        let high = score.precision().max(score.recall()) + 1e-12;
        prop_assert!((low..=high).contains(&score.f1()));
        let swapped = count_all(&sentences, true);
        prop_assert_eq!((score.right(), score.precision(), score.recall(), score.f1()),
            (swapped.right(), swapped.recall(), swapped.precision(), swapped.f1()));
    }

    #[test]
    fn parts_add_up_to_the_whole(sentences in sentences(), cut in any::<prop::sample::Index>()) {
        let cut = cut.index(sentences.len() + 1);
        let mut score = count_all(&sentences[..cut], false);
        score.merge(&count_all(&sentences[cut..], false)).unwrap();
        prop_assert_eq!(score, count_all(&sentences, false));
    }
}
