//! Handwritten words through all commands.

use super::Folder;

/// Words of up to five letters, each letter of an image of its own but for every third, whose image says nothing: the letter before does.
pub fn words(first: usize, count: usize) -> String {
    let mut text = "word_id\tposition\tfold\tletter\tbits\n".to_owned();
    for word in first..first + count {
        for t in 0..3 + word % 3 {
            let letter = (word + t) % 4;
            let on = if t % 3 == 2 { 127 } else { 9 * letter };
            let bits: String = (0..128).map(|pixel| if pixel == on { '1' } else { '0' }).collect();
            let name = char::from(b'a' + letter as u8);
            text += &format!("{word}\t{}\t{}\t{name}\t{bits}\n", t + 1, word % 10);
        }
    }
    text
}

/// The same with no letter known.
fn unknown(text: &str) -> String {
    ["a", "b", "c", "d"].iter().fold(text.to_owned(), |text, name| text.replace(&format!("\t{name}\t"), "\t_\t"))
}

#[test]
fn from_letters_to_a_reader() {
    let folder = Folder::new();
    folder.put("t.tsv", words(0, 40));
    folder.put("n.tsv", words(40, 12));
    for options in ["", "--patch 2 --history 3 --rest --times 2"] {
        let report = folder.run(&format!("train --task ocr --data t.tsv --model m -q {options}"));
        assert!(report.starts_with("40 sentences, 159 tokens, patch "), "{report}");
        let score = folder.run("evaluate --model m --data n.tsv");
        assert_eq!(score, "read 48 letters in 12 words\nletters: 100.00%\nwords: 100.00%\n");
        // Every line comes back, with the letter behind it, whether it was known or not.
        let (new, blank) = (words(40, 12), unknown(&words(40, 12)));
        let answer = folder.run_on("tag --model m", blank.clone());
        assert_eq!(answer.lines().next(), Some("word_id\tposition\tfold\tletter\tbits\tread"));
        for ((line, known), asked) in answer.lines().zip(new.lines()).zip(blank.lines()).skip(1) {
            assert_eq!(line, format!("{asked}\t{}", known.split('\t').nth(3).expect("a letter")));
        }
        assert_eq!(answer.lines().count(), new.lines().count());
    }
    let json = folder.json("evaluate --model m --data n.tsv --json");
    assert_eq!((&json["letters"], &json["right_words"]), (&48.into(), &12.into()));
    let told = folder.run("inspect m");
    assert!(
        told.contains("\npatch           2\nhistory         3\nrest            true\npasses          2\n"),
        "{told}"
    );
    let table = folder.run("compare --task ocr --data t.tsv --test n.tsv --algorithms supervised,stacked -q");
    assert!(table.contains("words %  letters %"), "{table}");
}

/// What cannot be known is missed, and counted.
#[test]
fn what_is_wrong_is_counted() {
    let folder = Folder::new();
    let line = |word: u32, letter: char| format!("{word}\t1\t0\t{letter}\t{}\n", "0".repeat(128));
    let head = "word_id\tposition\tfold\tletter\tbits\n";
    folder.put("t.tsv", [head.to_owned(), line(1, 'q'), line(2, 'q')].concat());
    folder.put("n.tsv", [head.to_owned(), line(1, 'q'), line(2, 'r')].concat());
    folder.run("train --task ocr --data t.tsv --model m -q");
    let score = folder.run("evaluate --model m --data n.tsv");
    assert_eq!(score, "read 2 letters in 2 words\nletters: 50.00%\nwords: 50.00%\n");
}

#[test]
fn refusals() {
    let folder = Folder::new();
    folder.put("t.tsv", words(0, 5));
    folder.put("u.tsv", words(0, 5).replacen("\tb\t", "\t_\t", 1));
    let long: String = (1..=26).map(|t| format!("7\t{t}\t0\ta\t{}\n", "0".repeat(128))).collect();
    folder.put("l.tsv", format!("word_id\tposition\tfold\tletter\tbits\n{long}"));
    folder.run("train --task ocr --data t.tsv --model m -q");
    for (line, expected) in [
        ("train --task ocr --data u.tsv --model x", "u.tsv:3:7: no letter; expected words to learn from"),
        ("evaluate --model m --data u.tsv", "u.tsv:3:7: no letter; expected words to measure on"),
        ("train --task ocr --data l.tsv --model x", "l.tsv:27:1: one more letter; expected words of at most 25"),
        (
            "train --task ocr --data t.tsv --model x --patch 4",
            "invalid value '4' for '--patch <PIXELS>': 4 is not in 1..=3",
        ),
        ("train --task ocr --data t.tsv --model x --times 0", "invalid value '0' for '--times <N>': 0 is not in 1..=8"),
        ("train --task ocr --data t.tsv --model x --order free", "--order is given, but must be left out: ocr has no"),
        ("train --data t.tsv --model x --rest", "--rest is given, but must be left out: tagging has no"),
        ("evaluate --model m --data t.tsv --label-column 3", "--label-column is given"),
        ("compare --task ocr", "--data is left out, but must be given"),
    ] {
        let message = folder.refused(line);
        assert!(message.contains(expected), "{line}: {message}");
    }
    let message = folder.refused_on("tag --model m", words(0, 2).replacen("\tb\t", "\tB\t", 1));
    assert!(message.contains("<stdin>:3:7: `B`; expected a letter from a to z, or _"), "{message}");
}
