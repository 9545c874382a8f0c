//! What is documented as a limit (the guide's chapter on limits) holds: there all is well, and one beyond it is refused, or nothing ends there.

use rollin::Seed;
use rollin::corpus::Corpus;
use rollin::policy::{Columns, Greedy, Linear, Weights};
use rollin::read::{conllu, template::Template};
use rollin::tasks::parsing;
use rollin::tasks::tagging::{Encoding, MOST_LABELS, Tagger};
use rollin::tasks::{About, Model};
use std::fmt::Write;

/// A word, and so many labels.
fn labels(count: usize) -> Corpus {
    let mut text = String::new();
    for i in 0..count {
        writeln!(text, "w L{i}").expect("memory");
    }
    Corpus::parse(text).expect("a corpus")
}

fn words() -> Template {
    Template::parse("U:%x[0,0]\n", "template".as_ref()).expect("a template")
}

/// All that a model says of its last label is right, also when it was saved.
#[test]
fn as_many_labels_as_can_be() {
    let (encoding, space) = Encoding::learn(&labels(MOST_LABELS), words().into()).expect("not one too many");
    drop(space);
    let last = encoding.labels.last().expect("there are some").clone();
    let mut weights = Weights::new(1, MOST_LABELS);
    weights.row_mut(0)[MOST_LABELS - 1] = 1.0;
    let linear = Linear { actions: MOST_LABELS, columns: Columns::Actions, weights };
    let tagger = Tagger::new(encoding, Greedy(linear), About::default()).expect("few features");
    let again = Tagger::from_bytes(&tagger.to_bytes(), "model".as_ref()).expect("what was written can be read");
    for tagger in [tagger, again] {
        assert_eq!(tagger.label(&[["w"], ["v"]]).expect("two words")[0], last);
    }
}

#[test]
fn one_label_more_is_refused_with_its_place() {
    let corpus = labels(MOST_LABELS + 1);
    let error = Encoding::learn(&corpus, words().into()).expect_err("one too many");
    assert_eq!(error.to_string(), "<text>:65535:3: one more label, \"L65534\"; expected at most 65534 different ones");
}

/// A sentence a word, each with a relation of its own.
fn relations(count: usize) -> conllu::Treebank {
    let mut text = String::new();
    for i in 0..count {
        writeln!(text, "1\tw\tw\tX\t_\t_\t0\tr{i}\t_\t_\n").expect("memory");
    }
    conllu::parse(text.as_bytes(), "bank".as_ref(), 1).expect("a treebank")
}

#[test]
fn as_many_relations_as_can_be_and_one_more() {
    let learn = |count| parsing::Encoding::learn(&relations(count), &parsing::Settings::default());
    learn(parsing::MOST_LABELS).expect("not one too many");
    let error = learn(parsing::MOST_LABELS + 1).map(drop).expect_err("one too many");
    let message = "bank:131071:15: one more relation, \"r65535\"; expected at most 65535 different ones";
    assert_eq!(error.to_string(), message);
}

/// Nothing counts a sentence's tokens in fewer bits than there are: the millionth is labelled as it would be in a short one.
#[test]
fn a_sentence_of_a_million_tokens() {
    let corpus = Corpus::parse("a X\nb Y\nb Z\n\nb Y\na X\nb Z\n\n").expect("a corpus");
    let tagger = Tagger::train(&corpus).expect("it learns");
    // What a label depends on lies within a few tokens: pieces of a long text are labelled as they are in a short one of the same beginning.
    let text = "a\nb\nb\na\nb\na\na\nb\n".repeat(125_000);
    let tags = |text: &str| -> Vec<u32> {
        let corpus = Corpus::parse(text).expect("a corpus");
        tagger.tag(&corpus, Seed::new(1)).expect("a word a line")
    };
    let (long, short) = (tags(&text), tags(&text[..16 * 60]));
    assert_eq!(long.len(), 1_000_000);
    // From some point on the labels repeat as the text does, up to where its end is seen.
    let period = &short[400..408];
    assert!(long[400..999_984].chunks_exact(8).all(|labels| labels == period));
}

/// A line of any length is one line; a model's text may be long, too.
#[test]
fn a_word_of_ten_megabytes() {
    let word = "b".repeat(10_000_000);
    let corpus = Corpus::parse(format!("a X\n{word} Y\n")).expect("a corpus");
    let tagger: Model<_> = Tagger::train(&corpus).expect("it learns");
    assert_eq!(tagger.label(&[["a"], [&word[..]]]).expect("two words"), ["X", "Y"]);
}
