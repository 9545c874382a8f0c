use super::*;
use crate::read::conll;
use proptest::prelude::*;
use std::collections::HashMap;

fn template(text: &str) -> Result<Template> {
    Template::parse(text, Path::new("t"))
}

fn corpus(text: &str) -> Corpus {
    conll::parse(text.as_bytes(), Path::new("c"), 1).expect("a corpus")
}

/// The observations of one token.
fn observed(text: &str, corpus: &Corpus, token: usize) -> Vec<u64> {
    let template = template(text).expect("a template");
    let mut features = Vec::new();
    let sentence =
        (0..corpus.sentences()).map(|i| corpus.sentence(i)).find(|s| s.contains(&token)).expect("its sentence");
    template.bind(corpus).expect("columns").observe(sentence, token, &mut features);
    features
}

#[test]
fn it_can_be_shared_between_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<Template>();
    shared::<Bound<'_>>();
}

#[test]
fn every_fault_has_its_place() {
    let cases = [
        ("", "t:1:1: no pattern; expected a line with U, B or *"),
        ("# only\n\n", "t:3:1: no pattern; expected a line with U, B or *"),
        ("X1:%x[0,0]", "t:1:1: \"X1:%x[0,0]\"; expected U, B, *, # or @pad at the start of the line"),
        ("U\n U", "t:2:1: \" U\"; expected U, B, *, # or @pad at the start of the line"),
        ("Ué%z[0,0]", "t:1:4: \"z[0,0]\"; expected x, t, m, s or y after %"),
        ("U%", "t:1:3: the line's end; expected x, t, m, s or y after %"),
        ("U%x(0,0)", "t:1:4: \"(0,0)\"; expected ["),
        ("U%x[a,0]", "t:1:5: \"a,0]\"; expected a row from -100 to 100, after @ if absolute"),
        ("U%x[101,0]", "t:1:5: \"101,0]\"; expected a row from -100 to 100, after @ if absolute"),
        ("U%x[99999999999,0]", "t:1:5: \"99999999999,\"...; expected a row from -100 to 100, after @ if absolute"),
        ("U%x[*1,0]", "t:1:5: \"*1,0]\"; expected a row from -100 to 100, after @ if absolute"),
        ("U%x[0]", "t:1:6: \"]\"; expected a comma and the column"),
        ("U%x[0,-1]", "t:1:7: \"-1]\"; expected the number of a column, from 0"),
        ("U%x[0,0", "t:1:8: the line's end; expected ]"),
        ("U%x[0,0,3]", "t:1:8: \",3]\"; expected ]"),
        ("U%t[0,0]", "t:1:8: \"]\"; expected a comma and a regular expression in quotes"),
        ("U%m[0,0,\"a\\\"]", "t:1:14: the line's end; expected a quote that ends the regular expression"),
        ("U%m[0,0,\"é**\"]", "t:1:12: \"*\\\"]\"; expected a character to repeat before * and ?, or a backslash"),
        ("U%s[0,0,0]", "t:1:9: \"0]\"; expected a number of characters, from 1"),
        ("U%y[-9]", "t:1:5: \"-9]\"; expected a label, from -8 to 8"),
        ("U%y[9]", "t:1:5: \"9]\"; expected a label, from -8 to 8"),
        ("B%y[-101]", "t:1:5: \"-101]\"; expected a label, from -8 to 8"),
        ("U%Y[-1]", "t:1:3: \"Y[-1]\"; expected x, t, m, s or y after %"),
        ("@pad <s>\nU", "t:1:9: the line's end; expected @pad and two words, for cells before and after the sentence"),
        ("@pad a b c\nU", "t:1:9: \" c\"; expected nothing after the two words of @pad"),
        ("@pad a b\nU\n@pad a b", "t:3:1: a second @pad; expected one for the whole template"),
    ];
    for (text, expected) in cases {
        assert_eq!(template(text).expect_err(text).to_string(), expected, "{text}");
    }
}

#[test]
fn a_missing_column_is_named_when_bound() {
    let two = corpus("a A\n");
    let error =
        template("U1:%x[0,1]\nBé:%x[0,0]%t[0,2,\"a\"]\n").expect("a template").bind(&two).expect_err("column 2");
    assert_eq!(error.to_string(), "t:2:16: column 2; expected a column of c, which has columns 0 to 1");
    assert_eq!(template("U%x[0,7]").expect("a template").columns(), 8);
    assert_eq!(template("U").expect("a template").columns(), 0);
}

#[test]
fn files_of_other_programs_parse() {
    // Comments, spaces in brackets, lower-case kinds, carriage returns, bare U and B.
    let text =
        "# Unigram\r\n*1:%x[-2,0]\r\n\r\n  # indented\nu2:%x[ 0, 0 ] # 100%\nU3:%t[0,0,\"# \\\"\"]#x\nU\nB\nb4\n";
    let template = template(text).expect("a template");
    assert_eq!(template.observations(), 4);
    assert_eq!(template.history().len(), 3);
    assert_eq!(template.text(), text);
}

#[test]
fn history_lines_name_their_labels() {
    let text = "U%y[-2]x%y[-1]\nB\nB%x[0,0]%y[-2]\n*%x[0,0]\n*%y[-3]\n";
    let template = template(text).expect("a template");
    let labels: Vec<_> = template.history().iter().map(|history| history.labels.clone()).collect();
    assert_eq!(labels, [vec![-2, -1], vec![-1], vec![-2, -1], vec![-1], vec![-3], vec![-3, -1]]);
    assert_eq!(template.observations(), 1);
    let corpus = corpus("a\n");
    let mut contexts = vec![7];
    template.bind(&corpus).expect("columns").contexts(0..1, 0, &mut contexts);
    assert_eq!(contexts.len(), 7);
    assert_eq!(contexts[0], 7, "appended");
    assert_eq!(contexts.iter().collect::<std::collections::HashSet<_>>().len(), 7);
}

/// Each pair: does the first feature at the first token equal the second at the second?
#[test]
fn equal_strings_are_equal_features() {
    let corpus = corpus("Ab1 x\nab1 _b-1\n_B-1 c\nÀ É\n_B+2 tRue\n");
    let same = |one: &str, a: usize, other: &str, b: usize| observed(one, &corpus, a) == observed(other, &corpus, b);
    // A bag of words: only the text and what is found count.
    assert!(same("U:%x[1,0]", 0, "U:%x[0,0]", 1));
    assert!(!same("U1:%x[1,0]", 0, "U2:%x[0,0]", 1));
    assert!(same("U:%X[0,0]", 0, "U:%x[0,0]", 1));
    assert!(!same("U:%x[0,0]", 0, "U:%x[0,0]", 1));
    // What lies outside reads as in CRF++, before a test or a fold.
    assert!(same("U:%x[-1,0]", 0, "U:%x[0,0]", 2));
    assert!(same("U:%X[-1,0]", 0, "U:%x[0,1]", 1));
    assert!(same("U:%x[3,1]", 3, "U:%x[0,0]", 4));
    assert!(same("U:%t[-1,0,\"^_B\"]", 0, "U:%X[0,1]", 4));
    assert!(same("@pad Ab1 _B+2\nU:%x[-9,0]", 2, "U:%x[0,0]", 0));
    assert!(same("U:%x[9,0]\n@pad Ab1 _B+2", 2, "U:%x[0,0]", 4));
    // Absolute rows count from 1, or back from the end.
    assert!(same("U:%x[@1,0]", 3, "U:%x[0,0]", 0));
    assert!(same("U:%x[@5,0]", 3, "U:%x[0,0]", 4));
    assert!(same("U:%x[@-1,0]", 3, "U:%x[0,0]", 4));
    assert!(same("U:%x[@-5,0]", 3, "U:%x[0,0]", 0));
    assert!(same("U:%x[@0,0]", 3, "U:%x[0,0]", 2));
    assert!(same("U:%x[@-6,0]", 3, "U:%x[0,0]", 2));
    assert!(same("U:%x[@7,0]", 3, "U:%x[0,0]", 4));
    // Shapes, matches, and the folding of what is not ASCII.
    assert!(same("U:%s[0,0]", 0, "@pad a Xxd\nU:%x[1,0]", 4));
    assert!(same("U:%s[0,0,2]", 0, "@pad a Xx\nU:%x[1,0]", 4));
    assert!(same("U:%S[0,0,2]", 0, "@pad a xx\nU:%x[1,0]", 4));
    assert!(same("U:%s[0,0]", 3, "U:%x[0,0]", 3));
    assert!(same("U:%X[0,1]", 3, "@pad a é\nU:%x[1,0]", 4));
    assert!(same("U:%M[0,0,\"\\u.\"]", 0, "@pad a ab\nU:%x[1,0]", 4));
    assert!(same("U:%m[0,0,\"z\"]", 0, "U:%m[0,0,\"\\s\"]", 1));
    // Text between two things keeps them apart, and so does their order.
    assert!(!same("U:%x[0,0]%x[1,0]", 0, "U:%x[1,0]%x[0,0]", 0));
    assert!(!same("U:%x[0,0]/%x[1,0]", 0, "U:%x[0,0]%x[1,0]/", 0));
}

#[test]
fn hashes_never_change() {
    // Model files depend on these numbers: a change of them is a change of the file format.
    let corpus = corpus("Haus NN\nist VB\n");
    let features = observed("U\nU1:%x[0,0]\nU2:%X[-1,0]/%m[0,1,\"^.\"]", &corpus, 0);
    assert_eq!(features, [15721589626398216619, 11378387771109367370, 2089082151028970006]);
}

#[test]
fn defaults_parse_and_fit() {
    for columns in 0..20 {
        let template = Template::default_for(columns);
        assert_eq!(template.columns(), columns.min(16));
        assert!(!template.history().is_empty());
    }
    assert!(Template::default_for(usize::MAX).columns() == 16);
}

/// A cell of a pattern: whether its row is absolute, the row, the column.
type Cell = (bool, i32, u32);

/// The word that CRF++ and Wapiti put in its place.
fn naive(corpus: &Corpus, sentence: std::ops::Range<usize>, token: usize, (absolute, row, column): Cell) -> String {
    let length = sentence.len() as i32;
    let at = match (absolute, row) {
        (false, _) => (token - sentence.start) as i32 + row,
        (true, row) if row < 0 => length + row,
        (true, row) => row - 1,
    };
    match at {
        at if at < 0 => format!("_B-{}", -at),
        at if at >= length => format!("_B+{}", at - length + 1),
        at => corpus.word(column as usize, sentence.start + at as usize).to_owned(),
    }
}

proptest! {
    #[test]
    fn no_text_panics(text in "[UB*#@%xtmsy\\[\\]0-9,\"\\\\.^$?\\- \n]{0,40}|\\PC{0,20}") {
        if let Ok(template) = template(&text) {
            let corpus = corpus("a A 1\nb B 2\n\nc C 3\n");
            if let Ok(bound) = template.bind(&corpus) {
                for token in 0..2 {
                    let mut out = Vec::new();
                    bound.observe(0..2, token, &mut out);
                    prop_assert_eq!(out.len(), template.observations());
                    bound.contexts(0..2, token, &mut out);
                    prop_assert_eq!(out.len(), template.observations() + template.history().len());
                }
            }
        }
    }

    /// Features are equal exactly when their text and the words in it are: over 64 bits, a collision among the few
    /// thousand features of a run has a probability below 1e-11.
    #[test]
    fn features_are_their_strings(
        lines in prop::collection::vec((0..3u8, prop::collection::vec((any::<bool>(), -4..5i32, 0..2u32), 0..4)), 1..8),
        lengths in prop::collection::vec(1..5usize, 1..4),
        words in prop::collection::vec("[ab]", 40),
    ) {
        let mut text = String::new();
        let mut words = words.iter().cycle();
        for length in lengths {
            for _ in 0..length {
                text += &format!("{} {}\n", words.next().expect("a cycle"), words.next().expect("a cycle"));
            }
            text.push('\n');
        }
        let corpus = corpus(&text);
        let mut source = String::new();
        for (name, cells) in &lines {
            source += &format!("U{name}");
            for (absolute, row, column) in cells {
                source += &format!("/%x[{}{row},{column}]", if *absolute { "@" } else { "" });
            }
            source.push('\n');
        }
        let template = template(&source).expect("a template");
        let bound = template.bind(&corpus).expect("columns");
        let (mut strings, mut hashes) = (HashMap::new(), HashMap::new());
        for sentence in (0..corpus.sentences()).map(|i| corpus.sentence(i)) {
            for token in sentence.clone() {
                let mut features = Vec::new();
                bound.observe(sentence.clone(), token, &mut features);
                prop_assert_eq!(features.len(), lines.len());
                for ((name, cells), feature) in lines.iter().zip(features) {
                    let words = cells.iter().map(|&cell| naive(&corpus, sentence.clone(), token, cell));
                    let found: Vec<_> = words.collect();
                    let string = format!("{name}/{}", found.join("/"));
                    prop_assert_eq!(&*strings.entry(feature).or_insert_with(|| string.clone()), &string);
                    prop_assert_eq!(*hashes.entry(string).or_insert(feature), feature);
                }
            }
        }
    }
}
