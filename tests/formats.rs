//! Attribute files and conversions: what is written is read back, and what is no such file is refused with its place.

use proptest::collection::vec;
use proptest::prelude::*;
use rollin::corpus::{Corpus, Separator};
use rollin::read::attributes::Items;
use rollin::read::template::Template;
use rollin::read::{conll, conllu, crfsuite, vw};
use std::collections::HashMap;
use std::path::Path;

fn path() -> &'static Path {
    Path::new("text")
}

fn read_crfsuite(text: &str) -> rollin::Result<Items> {
    crfsuite::parse(text.as_bytes(), path(), 1)
}

fn read_vw(text: &str) -> rollin::Result<Items> {
    vw::parse(text.as_bytes(), path(), 1)
}

fn write_crfsuite(items: &Items) -> String {
    let mut text = Vec::new();
    crfsuite::write(items, &mut text).expect("it can be read back");
    String::from_utf8(text).expect("UTF-8")
}

fn write_vw(items: &Items) -> String {
    let mut text = Vec::new();
    vw::write(items, &mut text).expect("it can be read back");
    String::from_utf8(text).expect("UTF-8")
}

/// Each item's label and attributes, sequence by sequence.
fn spelled(items: &Items) -> Vec<Vec<Vec<&str>>> {
    let item = |i: usize| {
        let names = items.attributes(i).iter().map(|id| items.names.get(*id));
        std::iter::once(items.labels.word(0, i)).chain(names).collect()
    };
    (0..items.labels.sentences()).map(|s| items.labels.sentence(s).map(item).collect()).collect()
}

#[test]
fn crfsuite_by_hand() {
    let text = "\u{feff}B\ta\tb:1\tc:1.0\td:\r\n_\t\\\\x\\:y\\z\t\t a \n\n\n \t\nI\n";
    let items = read_crfsuite(text).expect("items");
    let expected = [vec![vec!["B", "a", "b", "c", "d"], vec!["_", "\\x:y\\z", " a "]], vec![vec!["I"]]];
    assert_eq!(spelled(&items), expected);
    assert_eq!(items.labels.lines, [1, 2, 6]);
    assert_eq!(write_crfsuite(&items), "B\ta\tb\tc\td\n_\t\\\\x\\:y\\\\z\t a \n\nI\n\n");
    assert_eq!(write_vw(&items), "B | a b c d\n| \\x%3Ay\\z %20a%20\n\nI |\n\n");
}

#[test]
fn vw_by_hand() {
    let text = "6 | the:1 w=a\n7 1.0 |p DT |w:1 5%3A30 100%\n|\n\n \n B-NP |a^b c|d e\n";
    let items = read_vw(text).expect("items");
    let first = vec![vec!["6", "the", "w=a"], vec!["7", "p^DT", "w^5:30", "w^100%"], vec!["_"]];
    assert_eq!(spelled(&items), [first, vec![vec!["B-NP", "a^b^c", "d^e"]]]);
    assert_eq!(items.labels.lines, [1, 2, 3, 6]);
    assert_eq!(write_vw(&items), "6 | the w=a\n7 | p^DT w^5%3A30 w^100%\n|\n\nB-NP | a^b^c d^e\n\n");
}

#[test]
fn refusals_say_where_and_what() {
    let one = "expected 1 or no value at all: features are there or not";
    let crfsuite = [
        ("", "text:1:1: no item; expected lines of one item each".to_owned()),
        ("A\tb\n\nB\tä:0.5\tc", format!("text:3:5: the value \"0.5\"; {one}")),
        ("A\tb:x", format!("text:1:5: the value \"x\"; {one}")),
        ("A\tb:1:2", "text:1:6: a second colon; expected a tab, or \\: for a colon in a name".into()),
        ("A\t:1", "text:1:3: a value; expected the name of an attribute before it".into()),
        ("A:1\tb", "text:1:2: a colon; expected a tab after the label, or \\:".into()),
        ("A B\tb", "text:1:1: \"A B\"; expected a label without blanks".into()),
        ("A\n\tb", "text:2:1: \"\"; expected a label without blanks".into()),
        ("@weight:2\tA\tb", "text:1:8: a colon; expected a tab after the label, or \\:".into()),
        ("A\tb\nA\0", "text:2:2: a NUL byte; expected text in UTF-8, not a binary file".into()),
    ];
    for (text, message) in crfsuite {
        assert_eq!(read_crfsuite(text).expect_err(text).to_string(), message);
    }
    let vw = [
        ("\n", "text:2:1: no item; expected lines of one item each".to_owned()),
        ("1 | a\n2 | b c:0.5", format!("text:2:9: the value `0.5`; {one}")),
        ("1 |n:2 a", format!("text:1:6: the value `2`; {one}")),
        ("1 2 | a", "text:1:3: `2`; expected | or an importance of 1 after the label".into()),
        ("1 'x | a", "text:1:3: `'x`; expected | or an importance of 1 after the label".into()),
        ("'x | a", "text:1:1: a tag; expected a label, which no tag follows".into()),
        ("1 1 0 | a", "text:1:5: `0 | a`; expected | and the features".into()),
        ("1 a", "text:1:3: `a`; expected | or an importance of 1 after the label".into()),
        ("1", "text:1:2: the line's end; expected | and the features".into()),
        ("1 | a :1", "text:1:7: the value `1`; expected the name of a feature before it".into()),
    ];
    for (text, message) in vw {
        assert_eq!(read_vw(text).expect_err(text).to_string(), message);
    }
    // A block from the middle of a file.
    let error = vw::parse_block(b"1 | a\n2", path(), 11).expect_err("no bar");
    assert_eq!(error.to_string(), "text:12:2: the line's end; expected | and the features");
}

#[test]
fn what_cannot_be_read_back_is_not_written() {
    for (label, name) in [("A", ""), ("A B", "a"), ("", "a"), ("A", "a\tb"), ("A", "a\nb"), ("A", "a\r"), ("A", "\0")] {
        let mut items = Items::new(path());
        items.attribute(name);
        items.push(label, 1);
        items.end_sequence();
        let error = crfsuite::write(&items, &mut Vec::new()).expect_err(name);
        assert_eq!(error.kind(), std::io::ErrorKind::InvalidInput);
    }
    let items = read_crfsuite("A\t_\n").expect("items");
    let error = items.columns().expect_err("lost").to_string();
    assert_eq!(error, "text:1:1: the attribute `_`; expected another name: `_` stands in a column for no attribute");
}

/// Words with everything in them that is special somewhere.
fn names() -> impl Strategy<Value = String> {
    let piece = prop_oneof!["[ab%]", "[:|\\\\^' ]", "%[0-9A-C]{2}", "é|\u{a0}|=|_|\u{feff}"];
    vec(piece, 1..5).prop_map(|pieces| pieces.concat())
}

/// Sequences of labels and attributes.
fn sequences(name: impl Strategy<Value = String>) -> impl Strategy<Value = Items> {
    let item = ("[AB:|%'\\\\-]{1,3}|_", vec(name, 0..4));
    vec(vec(item, 1..4), 1..4).prop_map(|sequences| {
        let mut items = Items::new(path());
        let mut line = 0;
        for sequence in sequences {
            for (label, names) in sequence {
                line += 1;
                names.iter().for_each(|name| items.attribute(name));
                items.push(&label, line);
            }
            items.end_sequence();
            line += 1;
        }
        items
    })
}

proptest! {
    #[test]
    fn crfsuite_comes_back(items in sequences(names())) {
        prop_assert_eq!(read_crfsuite(&write_crfsuite(&items)).expect("items"), items);
    }

    #[test]
    fn vw_comes_back(items in sequences(names().prop_map(|name| name + "\t"))) {
        prop_assert_eq!(read_vw(&write_vw(&items)).expect("items"), items);
    }

    /// From one format to the other and back is the same text.
    #[test]
    fn conversions_lose_nothing(items in sequences(names())) {
        let (crfsuite, vw) = (write_crfsuite(&items), write_vw(&items));
        prop_assert_eq!(write_vw(&read_crfsuite(&crfsuite).expect("items")), vw.clone());
        prop_assert_eq!(write_crfsuite(&read_vw(&vw).expect("items")), crfsuite);
    }

    /// Columns have what the items have: in every row the attributes, then `_`, then the label.
    #[test]
    fn columns_lose_nothing(items in sequences(names())) {
        prop_assume!(items.names.find("_").is_none());
        let mut text = Vec::new();
        items.columns().expect("columns").write(&mut text, Separator::Tab).expect("they can be read back");
        let corpus = conll::parse(&text, path(), 1).expect("a corpus");
        prop_assert_eq!(corpus.sentences(), items.labels.sentences());
        let last = corpus.columns.len() - 1;
        for token in 0..corpus.tokens() {
            let cells = (0..last).map(|c| corpus.word(c, token)).filter(|cell| *cell != "_");
            let names: Vec<_> = cells.map(|cell| rollin::read::attributes::unescape(cell).into_owned()).collect();
            let expected: Vec<_> = items.attributes(token).iter().map(|id| items.names.get(*id)).collect();
            prop_assert_eq!(names, expected);
            prop_assert_eq!(corpus.word(last, token), items.labels.word(0, token));
        }
    }

    #[test]
    fn no_text_panics(text in "[ab1 :|'\\\\\t\n\r%^é_.]{0,40}", bytes in vec(any::<u8>(), 0..40)) {
        for text in [text.as_bytes(), &bytes] {
            for items in [crfsuite::parse(text, path(), 1), vw::parse(text, path(), 1)].into_iter().flatten() {
                // What was read can be written, unless CRFsuite has no way to say it, and is then the same again.
                let mut written = Vec::new();
                if crfsuite::write(&items, &mut written).is_ok() {
                    let again = crfsuite::parse(&written, path(), 1).expect("items");
                    prop_assert_eq!(spelled(&again), spelled(&items));
                }
                let again = read_vw(&write_vw(&items)).expect("items");
                prop_assert_eq!(spelled(&again), spelled(&items));
            }
        }
    }

    /// Blocks of a stream say what the whole says.
    #[test]
    fn blocks_are_the_whole(items in sequences(names()), size in 0..4usize) {
        let text = write_vw(&items);
        let mut found = Vec::new();
        for block in conll::Blocks::new(text.as_bytes(), size) {
            let block = block.expect("memory");
            let part = vw::parse_block(&block.bytes, path(), block.first_line).expect("items");
            found.extend(spelled(&part).into_iter().flatten().flatten().map(str::to_owned).collect::<Vec<_>>());
        }
        let all: Vec<_> = spelled(&items).into_iter().flatten().flatten().map(str::to_owned).collect();
        prop_assert_eq!(found, all);
    }

    /// Two features are spelled alike exactly when their hashes are the same, wherever a row may lie, and with every command.
    #[test]
    fn features_are_spelled_as_they_are_hashed(sentences in vec(vec("[aAé1-]{1,3}", 1..4), 1..4), padded in any::<bool>()) {
        let mut corpus = Corpus::new("words", 1);
        for sentence in &sentences {
            sentence.iter().for_each(|word| corpus.push(&[word], 1));
            corpus.end_sentence();
        }
        let mut text = "U0:%x[0,0]\nU1:%X[-2,0]|%X[3,0]\nUx%x[@-2,0]%x[@1,0]\nU3:%m[0,0,\"..$\"]/%M[-1,0,\"^.\"]\n\
                        U4:%s[1,0,2]%S[0,0]%t[-1,0,\"\\d\"]\n*5:%x[1,0]\nB\nU6:%y[-1]\n".to_owned();
        text += if padded { "@pad <S> </S>\n" } else { "" };
        let template = Template::parse(&text, path()).expect("a template");
        let (bound, speller) = (template.bind(&corpus).expect("columns"), template.speller(&corpus).expect("columns"));
        let (mut by_hash, mut by_name) = (HashMap::new(), HashMap::new());
        for i in 0..corpus.sentences() {
            let sentence = corpus.sentence(i);
            for token in sentence.clone() {
                let (mut hashes, mut names) = (Vec::new(), Vec::new());
                bound.observe(sentence.clone(), token, &mut hashes);
                speller.observe(&sentence, token, |name| names.push(name.to_owned()));
                prop_assert_eq!(hashes.len(), names.len());
                for (line, (hash, name)) in hashes.into_iter().zip(names).enumerate() {
                    prop_assert_eq!(by_hash.entry(hash).or_insert_with(|| name.clone()), &name);
                    // Two commands side by side may spell the same in two ways.
                    if line != 2 && line != 4 {
                        prop_assert_eq!(*by_name.entry(name).or_insert(hash), hash);
                    }
                }
            }
        }
    }
}

#[test]
fn treebanks_as_columns_and_back() {
    let text = "# a comment\n1-2\tdon't\t_\t_\t_\t_\t_\t_\t_\t_\n1\tdo\t_\tAUX\t_\t_\t0\troot\t_\t_\n2\tn't 1\t_\tPART\t_\t_\t1\tadvmod\t_\t100%\n\n";
    let bank = conllu::parse(text.as_bytes(), path(), 1).expect("a treebank");
    let columns = bank.columns();
    assert_eq!((columns.word(1, 1), columns.word(9, 1), &columns.lines[..]), ("n't%201", "100%", &[3, 4][..]));
    let mut written = Vec::new();
    conllu::write_columns(&columns, &mut written).expect("trees").expect("memory");
    let kept: String = text.split_inclusive('\n').skip(2).collect();
    assert_eq!(String::from_utf8_lossy(&written), kept);
    // Trees are checked, and blamed where they stand.
    let broken = "\n\n1 a _ _ _ _ 0 root _ _\n2 b _ _ _ _ 3 dep _ _\n";
    let corpus = conll::parse(broken.as_bytes(), path(), 1).expect("a corpus");
    let error = conllu::write_columns(&corpus, &mut Vec::new()).expect_err("no head 3").to_string();
    assert!(error.starts_with("text:4:"), "{error}");
    let corpus = conll::parse(b"a b\n", path(), 1).expect("a corpus");
    let error = conllu::write_columns(&corpus, &mut Vec::new()).expect_err("two columns").to_string();
    assert!(error.starts_with("text:1:1: 2 columns; expected 10: ID, FORM, "), "{error}");
}
