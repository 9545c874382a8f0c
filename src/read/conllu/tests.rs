use super::*;
use proptest::prelude::*;

fn read(text: &str) -> Result<Treebank> {
    parse(text.as_bytes(), Path::new("text"), 1)
}

/// A line of ten columns, between single spaces here.
fn lines(text: &str) -> String {
    text.lines()
        .map(|line| if line.starts_with('#') { line.to_owned() } else { line.trim().replace(' ', "\t") } + "\n")
        .collect()
}

const PETS: &str = "# text = the cat's asleep
1 the the DET DT _ 2 det _ _
2-3 cat's _ _ _ _ _ _ _ SpaceAfter=No
2 cat cat NOUN NN Number=Sing 4 nsubj _ _
3 's be AUX VBZ _ 4 cop _ _
3.1 very very ADV RB _ _ _ 4:advmod _
4 asleep asleep ADJ JJ _ 0 root _ _

1 Meow meow INTJ UH _ 0 root _ _
";

#[test]
fn everything_there_is() {
    let bank = read(&lines(PETS)).expect("a treebank");
    assert_eq!((bank.sentences(), bank.words(), bank.sentence(1)), (2, 5, 4..5));
    assert_eq!((bank.form(2), bank.upos(2), bank.xpos(2), bank.feats(1)), ("'s", "AUX", "VBZ", "Number=Sing"));
    assert_eq!((bank.head(0), bank.relation(0), bank.head(3), bank.line(3)), (Some(2), "det", Some(0), 7));
    assert_eq!(bank.relation_place(1).to_string(), "text:4:33");
    assert_eq!(bank.first_unknown(), None);
}

#[test]
fn errors_say_where_and_what() {
    let cases = [
        ("1 a a X X _ 0 root _", "1:21: 9 columns; expected 10 columns, each followed by one tab but the last"),
        ("1 a a X X _ 0 root _ _ _", "1:24: 11 columns; expected 10 columns, each followed by one tab but the last"),
        ("1 a  X X _ 0 root _ _", "1:5: an empty column; expected _ where nothing is said"),
        (
            "1 a a X X _ 0 root _ _\n3 a a X X _ 1 x _ _",
            "2:1: id 3; expected 2, or 2-... for a multiword token, or 1.1",
        ),
        ("one a a X X _ 0 root _ _", "1:1: id one; expected 1, or 1-... for a multiword token, or 0.1"),
        ("1 a a X X _ 2 x _ _", "1:13: head 2; expected at most 1, the number of words"),
        ("1 a a X X _ 1 x _ _", "1:13: head 1; expected another word than this one"),
        ("1 a a X X _ -1 x _ _", "1:13: head -1; expected 0 or the number of a word"),
        ("1 a a X X _ 99999999999 x _ _", "1:13: head 99999999999; expected 0 or the number of a word"),
        (
            "1 a a X X _ 2 x _ _\n2 a a X X _ 1 x _ _\n3 a a X X _ 0 root _ _",
            "1:13: word 1 is its own ancestor; expected heads without circles",
        ),
        (
            "1 a a X X _ 2 x _ _\n2 a a X X _ 1 x _ _",
            "1:13: word 1 is its own ancestor; expected heads without circles",
        ),
        (
            "1 a a X X _ 0 root _ _\n2 a a X X _ 0 root _ _",
            "2:13: a second root: words 1 and 2; expected one head 0 in a sentence",
        ),
        ("1 a a X X _ 0 root _ _\n2 a a X X _ _ _ _ _", "2:13: no head; expected one, as the words before have"),
        ("1 a a X X _ _ _ _ _\n2 a a X X _ 1 x _ _", "2:13: a head; expected _, as the words before have"),
        ("1 a a X X _ 0 _ _ _", "1:15: a head without a relation; expected the relation to the head"),
        ("1 a a X X _ _ x _ _", "1:13: a relation without a head; expected the number of the head"),
        ("1-3 a _ _ _ _ _ _ _ _\n1 a a X X _ 0 root _ _", "1:1: a multiword token up to word 3; expected at most 1"),
        ("1 a a X X _ 0 root _ _\n# what", "2:1: a comment within a sentence; expected comments before its first word"),
        ("# what", "2:1: a sentence without words; expected lines of ten columns"),
        ("", "1:1: no sentence; expected CoNLL-U: ten columns between tabs"),
    ];
    for (text, expected) in cases {
        let error = read(&lines(text)).expect_err(expected);
        assert_eq!(error.to_string(), format!("text:{expected}"));
    }
    for (text, expected) in [
        (&b"1\ta\xff"[..], "text:1:4: byte 0xff, which is not UTF-8; expected text in UTF-8"),
        (b"\n1\ta\0", "text:2:4: a NUL byte; expected text in UTF-8"),
    ] {
        assert_eq!(parse(text, Path::new("text"), 1).expect_err(expected).to_string(), expected);
    }
}

#[test]
fn only_heads_and_relations_are_written_anew() {
    for end in ["\n", "\r\n"] {
        let text = "\n".to_owned() + &lines(PETS).replace('\n', end);
        let bank = read(&text).expect("a treebank");
        let mut same = Vec::new();
        bank.write(&mut same, |w| Arc { head: bank.head(w).expect("known"), relation: bank.relation(w) })
            .expect("memory");
        assert_eq!(String::from_utf8(same).expect("text"), text);
        let mut other = Vec::new();
        bank.write(&mut other, |_| Arc { head: 77, relation: "dep:x" }).expect("memory");
        let other = String::from_utf8(other).expect("text");
        assert_eq!(other.matches("\t77\tdep:x\t").count(), 5);
        assert_eq!(other.lines().count(), text.lines().count());
        assert!(other.contains("4:advmod") && other.contains("SpaceAfter=No"));
    }
}

#[test]
fn parts_keep_their_places() {
    let mut bank = read(&lines(PETS)).expect("a treebank");
    let later = bank.split_off(1);
    assert_eq!((bank.sentences(), bank.words(), later.sentences(), later.form(0)), (1, 4, 1, "Meow"));
    assert_eq!(later.head_place(0).to_string(), "text:9:23");
    let mut both = Vec::new();
    for part in [&bank, &later] {
        part.write(&mut both, |w| Arc { head: part.head(w).expect("known"), relation: part.relation(w) })
            .expect("memory");
    }
    assert_eq!(String::from_utf8(both).expect("text"), lines(PETS));
}

/// A random treebank as text: trees in which every word hangs on one that was drawn before it.
fn treebanks() -> impl Strategy<Value = String> {
    let word = ("[a-zé]{1,3}", any::<prop::sample::Index>(), prop::bool::weighted(0.1));
    let sentence = (prop::collection::vec(word, 1..8), prop::option::of("# [a-z]{0,4}"));
    prop::collection::vec(sentence, 1..5).prop_map(|sentences| {
        let mut text = String::new();
        for (words, comment) in sentences {
            text.extend(comment.map(|comment| comment + "\n"));
            for (i, (form, head, empty)) in words.iter().enumerate() {
                let (head, label) = if i == 0 { (0, "root") } else { (head.index(i) + 1, "dep") };
                text += &format!("{}\t{form}\t_\tX\tY\t_\t{head}\t{label}\t_\t_\n", i + 1);
                if *empty {
                    text += &format!("{}.1\t{form}\t_\tX\tY\t_\t_\t_\t0:root\t_\n", i + 1);
                }
            }
            text += "\n";
        }
        text
    })
}

proptest! {
    /// What is read is written back byte for byte, and no text makes the reader panic.
    #[test]
    fn round_trip(text in treebanks()) {
        let bank = read(&text).expect("a treebank");
        let mut same = Vec::new();
        bank.write(&mut same, |w| Arc { head: bank.head(w).expect("known"), relation: bank.relation(w) }).expect("memory");
        prop_assert_eq!(String::from_utf8(same).expect("text"), text);
    }

    #[test]
    fn no_damage_panics(text in treebanks(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = text.into_bytes();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        if let Err(error) = parse(&bytes, Path::new("text"), 1) {
            prop_assert!(error.to_string().starts_with("text:"), "{error}");
        }
    }
}
