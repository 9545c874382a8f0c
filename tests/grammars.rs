//! The embedded grammar and corpora: made again byte for byte, with every exact figure that `corpora/README.md` states.

use rollin::Seed;
use rollin::grammar::{Grammar, Sentence, defaults};

fn grammar() -> Grammar {
    Grammar::parse("grammars/dialects.grammar", defaults::GRAMMAR).expect("the embedded grammar is a grammar")
}

/// The training and the test corpus, made again.
fn made(grammar: &Grammar) -> [Vec<Sentence>; 2] {
    defaults::MADE.map(|(count, seed)| grammar.generate(count, Seed::new(seed)))
}

fn readme_has(text: &str) {
    let readme = include_str!("../corpora/README.md");
    assert!(readme.contains(text), "corpora/README.md does not say `{text}`");
}

#[test]
fn corpora_are_made_again_byte_for_byte() {
    let grammar = grammar();
    let corpora = made(&grammar);
    for (sentences, committed) in corpora.iter().zip([defaults::TRAIN, defaults::TEST]) {
        let mut text = Vec::new();
        grammar.write(sentences, &mut text).expect("a vector takes every byte");
        // Not assert_eq: half a megabyte is no message.
        assert!(text == committed.as_bytes(), "the corpus of {} sentences differs from its file", sentences.len());
        let words: usize = sentences.iter().map(|sentence| sentence.words.len()).sum();
        readme_has(&format!("{},{:03}", words / 1000, words % 1000));
    }
}

#[test]
fn figures_are_those_of_the_readme() {
    let grammar = grammar();
    readme_has(&format!("| {}, {} |", grammar.words().len(), grammar.tags().len()));
    readme_has(&format!("| {:.3} |", grammar.expected_length()));
    let single = grammar.single_word().accuracy;
    readme_has(&format!("| {:.2}% |", 100.0 * single));
    let [train, test] = made(&grammar);
    for sentences in [&train, &test] {
        let optimum = grammar.optimum(sentences).expect("the grammar made them");
        readme_has(&format!("| {:.2}% |", 100.0 * optimum));
        assert!((0.88..0.96).contains(&optimum), "the best possible tagger gets {optimum}");
        assert!(optimum > single + 0.05, "single words do nearly as well: {single} beside {optimum}");
    }
    let right: usize = test
        .iter()
        .map(|sentence| {
            let best = grammar.label(&sentence.words).expect("the grammar made it");
            best.iter().zip(&sentence.tags).filter(|(best, tag)| best == tag).count()
        })
        .sum();
    let words: usize = test.iter().map(|sentence| sentence.words.len()).sum();
    readme_has(&format!("it gets {:.2}%", 100.0 * right as f64 / words as f64));
}

#[test]
fn the_corpus_is_of_the_size_that_is_promised() {
    let grammar = grammar();
    assert!((150..=400).contains(&grammar.words().len()));
    assert!((8..=14).contains(&grammar.tags().len()));
    assert!((12.0..=20.0).contains(&grammar.expected_length()));
}

/// The grammar shown in the syntax section of `grammars/README.md` is one.
#[test]
fn the_example_of_the_readme_is_read() {
    let readme = include_str!("../grammars/README.md");
    let example: String =
        readme.lines().filter_map(|line| line.strip_prefix("    ")).map(|line| format!("{line}\n")).collect();
    let grammar = Grammar::parse("grammars/README.md", &example).expect("the example is a grammar");
    assert_eq!(grammar.tags(), ["Noun", "Verb"]);
    assert_eq!(grammar.words(), ["vel", "oru", "5th", "tam", "mor"]);
}
