//! The templates in `grammars/`, against features computed from strings in the plainest way.

use rollin::corpus::Corpus;
use rollin::read::{conll, template::Template};
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The features of `grammars/chunking.template`, spelt out.
fn chunking(corpus: &Corpus, sentence: Range<usize>, token: usize) -> Vec<String> {
    let cell = |column: usize, row: isize| -> &str {
        match token.checked_add_signed(row) {
            Some(at) if sentence.contains(&at) => corpus.word(column, at),
            _ if row < 0 => "<s>",
            _ => "</s>",
        }
    };
    let w = |row| cell(0, row).to_lowercase();
    let p = |row| cell(1, row);
    let mut features = Vec::new();
    for d in -2..=2 {
        features.push(format!("w{d}={}", w(d)));
        features.push(format!("p{d}={}", p(d)));
    }
    features.push(format!("w-1,0={}|{}", w(-1), w(0)));
    features.push(format!("w0,1={}|{}", w(0), w(1)));
    for a in -2..=1 {
        features.push(format!("p{a},{}={}|{}", a + 1, p(a), p(a + 1)));
    }
    for a in -2..=0 {
        features.push(format!("p3{a}={}|{}|{}", p(a), p(a + 1), p(a + 2)));
    }
    let characters: Vec<char> = cell(0, 0).chars().collect();
    for k in 1..=3 {
        let suffix: String = characters[characters.len().saturating_sub(k)..].iter().collect();
        features.push(format!("suf{k}={}", suffix.to_lowercase()));
    }
    for k in 1..=3 {
        let prefix: String = characters[..k.min(characters.len())].iter().collect();
        features.push(format!("pre{k}={}", prefix.to_lowercase()));
    }
    let class = |c: &char| match c {
        'A'..='Z' => 'X',
        'a'..='z' => 'x',
        '0'..='9' => 'd',
        other => *other,
    };
    features.push(format!("sh={}", characters.iter().map(class).take(8).collect::<String>()));
    features
}

/// Asserts that the template's features are the strings under other names: one hash a string, one string a hash.
/// Returns how many distinct ones there are. Two of a million 64-bit hashes collide with probability below 1e-7.
fn assert_bijection(corpus: &Corpus) -> usize {
    let template = Template::read_file(grammar("chunking.template")).expect("a template");
    let bound = template.bind(corpus).expect("two columns");
    let mut string_of: HashMap<u64, String> = HashMap::new();
    let mut hash_of: HashMap<String, u64> = HashMap::new();
    let mut hashes = Vec::new();
    for sentence in (0..corpus.sentences()).map(|i| corpus.sentence(i)) {
        for token in sentence.clone() {
            hashes.clear();
            bound.observe(sentence.clone(), token, &mut hashes);
            let strings = chunking(corpus, sentence.clone(), token);
            assert_eq!(hashes.len(), strings.len());
            for (&hash, string) in hashes.iter().zip(strings) {
                assert_eq!(*string_of.entry(hash).or_insert_with(|| string.clone()), string);
                assert_eq!(*hash_of.entry(string).or_insert(hash), hash);
            }
        }
    }
    hash_of.len()
}

fn grammar(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("grammars").join(name)
}

#[test]
fn chunking_features_are_the_plain_ones_on_a_few_words() {
    let text = "A DT B\nB2B-x JJ I\nÉté NN I\nI PRP B\n\nno UH O\n\n<s> SYM O\n</s> SYM O\n";
    let corpus = conll::parse(text.as_bytes(), Path::new("few"), 1).expect("a corpus");
    assert!(assert_bijection(&corpus) > 100);
}

#[test]
fn chunking_features_are_the_plain_ones_on_conll_2000() {
    let Some(data) = std::env::var_os("ROLLIN_DATA") else {
        println!("skipped: ROLLIN_DATA is not set");
        return;
    };
    for (name, sentences) in [("train.txt", 2000), ("test.txt", usize::MAX)] {
        let mut corpus = conll::read_file(Path::new(&data).join("conll2000").join(name)).expect("CoNLL-2000");
        corpus.truncate(sentences);
        assert!(assert_bijection(&corpus) > 100_000);
    }
}

#[test]
fn chunking_history_is_as_its_names_say() {
    let template = Template::read_file(grammar("chunking.template")).expect("a template");
    let labels: Vec<_> = template.history().iter().map(|history| history.labels.clone()).collect();
    assert_eq!(labels, [vec![-1], vec![-1, -2], vec![-1], vec![-1], vec![-1, -2], vec![-1]]);
    assert_eq!(template.columns(), 2);
    assert_eq!(template.observations(), 26);

    let corpus = conll::parse(b"The DT\nthe XX\nthe DT\nfew DT\n", Path::new("three"), 1).expect("a corpus");
    let bound = template.bind(&corpus).expect("two columns");
    let contexts = |token| {
        let mut out = Vec::new();
        bound.contexts(0..4, token, &mut out);
        out
    };
    let same = |a: usize, b: usize| contexts(a).iter().zip(contexts(b)).map(|(a, b)| *a == b).collect::<Vec<_>>();
    assert_eq!(same(0, 2), [true, true, true, true, true, false]);
    assert_eq!(same(0, 1), [true, true, true, false, false, false]);
    assert_eq!(same(2, 3), [true, true, false, true, true, false]);
}

#[test]
fn every_template_parses() {
    let mut count = 0;
    for entry in std::fs::read_dir(grammar("")).expect("grammars") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "template") {
            Template::read_file(&path).expect("a template");
            count += 1;
        }
    }
    assert!(count >= 2, "{count}");
}
