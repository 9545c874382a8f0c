//! What is refused: with exit code 2, one message, nothing on standard output and no file left behind.

use super::{CHUNKS, Folder, TAGS, shipped};
use std::process::Stdio;

#[test]
fn corpora_that_are_none() {
    let folder = Folder::new();
    let cases: [(&[u8], &str); 9] = [
        (b"", "t:1:1: no sentence; expected lines of one token each"),
        (b"\n \n\t\n", "t:4:1: no sentence; expected lines of one token each"),
        (b"a\nb\n", "t:1:1: 1 column; expected words and a column of labels beside them"),
        (b"a X\n\nb\n", "t:3:2: 1 column; expected 2 columns as on line 1"),
        (b"a X\nb X Y\n", "t:2:5: 3 columns; expected 2 columns as on line 1"),
        (b"a X\nb\0 X\n", "t:2:2: a NUL byte; expected text in UTF-8, not a binary file"),
        (b"a X\nb \xff\n", "t:2:3: byte 0xff, which is not UTF-8; expected text in UTF-8"),
        // The stream ends within a character.
        (b"a X\nb \xe2\x82", "t:2:3: byte 0xe2, which is not UTF-8; expected text in UTF-8"),
        (b"\x7fELF\x02\x01\x01\0\0", "t:1:8: a NUL byte; expected text in UTF-8, not a binary file"),
    ];
    for (text, message) in cases {
        folder.put("t", text);
        folder.says("train --data t --model m", message);
        folder.says_on("train --data - --model m", text, &message.replacen("t:", "<stdin>:", 1));
        folder.says("compare --data t --algorithms supervised", message);
    }
}

#[test]
fn corpora_that_cannot_be_read() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    let missing = "cannot read no: No such file or directory (os error 2)";
    folder.says("train --data no --model m", missing);
    folder.says("compare --data no", missing);
    folder.says("compare --data t --test no", missing);
    folder.says("train --data t --model m --template no", missing);
    folder.says("train --data . --model m", "cannot read .: Is a directory (os error 21)");
    folder.says("generate --grammar . --count 1", "cannot read .: Is a directory (os error 21)");
    folder.put("four", "a X\n\na X\n\na X\n\na X\n");
    folder
        .says("compare --data four", "four: too few sentences to set some aside: 4; give at least 5, or a --test file");
}

#[test]
fn columns_that_are_not_there() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    folder.says(
        "train --data t --model m --label-column 2",
        "t:1:5: 2 columns, so their numbers end with 1; expected a column 2 with the labels",
    );
    folder.says(
        "train --data t --model m --label-column 0",
        "--label-column is 0, but must be above 0, or come with a --template: the default one looks at the columns before \
         the labels'",
    );
    folder.put("far.template", "U:%x[0,0]\n\nU:%x[0,7]\n");
    folder.says(
        "train --data t --model m --template far.template",
        "far.template:3:8: column 7; expected a column of t, which has columns 0 to 1",
    );
    folder.put("labels.template", "U:%x[0,0]/%x[-1,1]\n");
    folder.says(
        "train --data t --model m --template labels.template",
        "labels.template:1:17: column 1, that of the labels; expected another column",
    );

    folder.put("c", CHUNKS);
    folder.run("train --data c --model m");
    let needs = "1 column; expected at least 2 columns, because the model looks at column 1 (from 0)";
    folder.says_on("tag --model m", "\nthe\nman\n", &format!("<stdin>:2:1: {needs}"));
    folder.says_on("tag --model m", "the D\nman\n", "<stdin>:2:4: 1 column; expected 2 columns as on line 1");
    folder.put("two", "the D\n");
    folder.says(
        "evaluate --model m --data two",
        "two:1:5: 2 columns, so their numbers end with 1; expected a column 2 with the labels",
    );
    folder.says(
        "evaluate --model m --data c --label-column 3",
        "c:1:7: 3 columns, so their numbers end with 2; expected a column 3 with the labels",
    );
    folder.says(
        "compare --data c --test two",
        "two:1:5: 2 columns, so their numbers end with 1; expected a column 2 with the labels",
    );
    folder.put("one", "the\n");
    folder
        .says("evaluate --model m --data one", "one:1:1: 1 column; expected words and a column of labels beside them");
    folder.put("empty", "");
    folder.says("evaluate --model m --data empty", "empty:1:1: no sentence; expected lines of one token each");
}

#[test]
fn labels_out_of_order() {
    let folder = Folder::new();
    folder.put("c", "a O\nb I-X\n\na B-X\nb I-X\n");
    folder.says(
        "train --data c --model m --order iob2",
        "c:2:3: label I-X; expected a label that may stand there by iob2, as --repair makes it",
    );
    folder.told("train --data c --model m", "");
    assert_eq!(folder.json("inspect m --json")["order"], "free");
}

#[test]
fn a_stream_keeps_its_columns() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    folder.run("train --data t --model m");
    let sentence = "the D\nold A\n\n";
    let block = sentence.repeat(65_536 / 3);
    let lines = block.lines().count();
    for (line, columns) in [("a X Y", 3), ("a", 1)] {
        let output =
            folder.rollin("tag --model m").write_stdin(format!("\n{block}{line}\n")).output().expect("it runs");
        assert_eq!(output.status.code(), Some(2));
        let plural = if columns == 1 { "" } else { "s" };
        let place = format!("<stdin>:{}:{}", lines + 2, if columns == 1 { 2 } else { 5 });
        let message = format!("error: {place}: {columns} column{plural}; expected 2 columns as on line 2\n");
        assert_eq!(String::from_utf8_lossy(&output.stderr), message);
        // What came before is tagged.
        assert!(String::from_utf8_lossy(&output.stdout).lines().count() > lines);
    }
    let bad = [format!("{block}a b\0\n").into_bytes(), [block.as_bytes(), b"a b\xff\n"].concat()];
    for input in bad {
        let output = folder.rollin("tag --model m").write_stdin(input).output().expect("it runs");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.starts_with(&format!("error: <stdin>:{}:4: ", lines + 1)), "{message}");
    }
}

#[test]
fn templates_that_are_none() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    let cases = [
        ("", "p:1:1: "),
        ("# nothing\n", "p:2:1: "),
        ("U:%x[0,0]\nX:%x[0,0]\n", "p:2:1: "),
        ("U:%x[0,0\n", "p:1:9: "),
        ("U:%x[,0]\n", "p:1:6: "),
        ("U:%q[0,0]\n", "p:1:"),
        ("U:%x[0,-1]\n", "p:1:8: "),
        ("U:%x[999,0]\n", "p:1:6: "),
        ("U:%m[0,0,\"a]\n", "p:1:"),
        ("U:%m[0,0,\"*\"]\n", "p:1:"),
        ("U:%y[9]\n", "p:1:6: "),
        ("U:%x[*2,0]\n", "p:1:6: "),
        ("@pad a\nU:%x[0,0]\n", "p:1:"),
        ("@pad a b\n@pad a b\nU:%x[0,0]\n", "p:2:1: a second @pad; expected one for the whole template"),
    ];
    for (template, start) in cases {
        folder.put("p", template);
        let message = folder.refused("train --data t --model m --template p");
        assert!(message.starts_with(&format!("error: {start}")), "{template}: {message}");
        assert!(message.contains("; expected ") && message.lines().count() == 1, "{template}: {message}");
    }
    folder.put("p", b"U:%x[0,0]\nU\xff\n");
    folder.says("train --data t --model m --template p", "p:2:2: a byte that is not UTF-8; expected text in UTF-8");
    folder.put("p", "U:%y[-9]\n");
    folder.says("train --data t --model m --template p", "p:1:6: \"-9]\"; expected a label, from -8 to 8");
}

#[test]
fn grammars_that_are_none() {
    let folder = Folder::new();
    let cases = [
        ("", "g:1:1: "),
        ("start S\nS -> a {};\n", "g:2:"),
        ("start S;\nS -> a { S };\n", "g:2:"),
        ("start S;\nS -> \"a\" { T };\n", "g:2:"),
        ("S -> a { end };\n", "g:"),
        ("start S;\nS -> a*0 { end };\n", "g:2:"),
        ("start S;\nS -> a*-1 { end };\n", "g:2:"),
        ("start S;\nS -> @nothing { end };\n", "g:2:"),
    ];
    for (grammar, start) in cases {
        folder.put("g", grammar);
        let message = folder.refused("generate --grammar g --count 3");
        assert!(message.starts_with(&format!("error: {start}")), "{grammar}: {message}");
        assert!(message.contains("; expected ") && message.lines().count() == 1, "{grammar}: {message}");
    }
    folder.says("generate --grammar no --count 1", "cannot read no: No such file or directory (os error 2)");
    let one = folder.refused("generate --grammar g --count -1");
    assert!(one.contains("'-1'"), "{one}");
}

#[test]
fn settings_out_of_range() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    let cases = [
        ("smile --alpha 0", "--alpha is 0, but must be above 0 and at most 1"),
        ("smile --alpha -0.5", "--alpha is -0.5, but must be above 0 and at most 1"),
        ("smile --alpha 1.01", "--alpha is 1.01, but must be above 0 and at most 1"),
        ("smile --alpha NaN", "--alpha is NaN, but must be above 0 and at most 1"),
        ("searn --beta 0", "--beta is 0, but must be above 0 and at most 1"),
        ("searn --beta inf", "--beta is inf, but must be above 0 and at most 1"),
        ("searn-shortcut --beta nan", "--beta is NaN, but must be above 0 and at most 1"),
        ("searn --rollouts 0", "--rollouts is 0, but must be at least 1"),
        ("smile --rounds 0", "--rounds is 0, but must be at least 1"),
        ("dagger --rounds 0", "--rounds is 0, but must be at least 1"),
        ("dagger --passes 0", "--passes is 0, but must be at least 1"),
        ("dagger --rate -1", "--rate is -1, but must be above 0"),
        ("dagger --rate nan", "--rate is NaN, but must be above 0"),
        ("dagger --l2 -0.1", "--l2 is -0.1, but must be 0 or more"),
        ("dagger --l2 inf", "--l2 is inf, but must be 0 or more"),
        ("supervised --alpha 0.5", "--alpha is given, but must be left out: supervised has no such setting"),
        ("supervised --rounds 2", "--rounds is given, but must be left out: supervised has no such setting"),
        ("dagger-online --warm", "--warm is given, but must be left out: dagger-online has no such setting"),
        ("lols-online --warm", "--warm is given, but must be left out: lols-online has no such setting"),
        ("stacked --rounds 2", "--rounds is given, but must be left out: stacked has no such setting"),
        ("searn --schedule first", "--schedule is given, but must be left out: searn has no such setting"),
        ("searn --conservative", "--conservative is given, but must be left out: searn has no such setting"),
        ("cpi --reference 0.5", "--reference is given, but must be left out: cpi has no such setting"),
        ("cpi --beta 0", "--beta is 0, but must be above 0 and at most 1"),
        ("lols --reference 1.5", "--reference is 1.5, but must be from 0 to 1"),
        ("lols --reference nan", "--reference is NaN, but must be from 0 to 1"),
        ("stacked --folds 1", "--folds is 1, but must be at least 2"),
        ("stacked --window 65", "--window is 65, but must be from 0 to 64"),
        ("early-update --width 0", "--width is 0, but must be from 1 to 1024"),
        ("smile --beta 0.5", "--beta is given, but must be left out: smile has no such setting"),
        (
            "searn-shortcut --rollouts 2",
            "--rollouts is given, but must be left out: searn-shortcut has no such setting",
        ),
        ("dagger --learner perceptron --l2 1", "--l2 is given, but must be left out: perceptron has no such setting"),
    ];
    for (settings, message) in cases {
        folder.says(&format!("train --data t --model m --algorithm {settings}"), message);
        folder.says(&format!("compare --data t --algorithms {settings}"), message);
    }
    folder.says(
        "compare --data t --algorithms smile,dagger --beta 0.5",
        "--beta is given, but must be left out: smile, dagger have no such setting",
    );
    let schedule = folder.refused("train --data t --model m --algorithm dagger --schedule linear:0");
    assert!(schedule.contains("linear over 0 rounds, but must be at least 1 round"), "{schedule}");
    let both = folder.refused("train --data t --model m --algorithm cpi --conservative --beta 0.5");
    assert!(both.contains("cannot be used with"), "{both}");
    for command in ["tag --model m --json", "generate --grammar g --count 1 --json"] {
        let message = folder.refused(command);
        assert!(message.starts_with("error: --json is given, but must be left out: "), "{message}");
    }
}

#[test]
fn arguments_that_the_parser_refuses() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    let cases = [
        ("train --data t --model m --algorithm smil", "a similar value exists: 'smile'"),
        ("train --data t --model m --learner logistik", "a similar value exists: 'logistic'"),
        ("train --data t --model m --alfa 1", "a similar argument exists: '--alpha'"),
        ("train --data t --model m --first 0", "0 is not in 1.."),
        ("compare --first 0", "0 is not in 1.."),
        ("train --data t --model m --threads 0", "0 is not in 1..=1024"),
        ("train --data t --model m --threads 65535", "65535 is not in 1..=1024"),
        ("train --data t --model m --rounds x", "invalid digit found in string"),
        ("train --data t --model m --seed 99999999999999999999", "number too large"),
        ("train --data t", "--model <FILE>"),
        ("trian", "a similar subcommand exists: 'train'"),
        ("compare --test t", "--data <FILE>"),
    ];
    for (line, hint) in cases {
        let message = folder.refused(line);
        assert!(message.contains(hint), "{line}: {message}");
    }
}

#[test]
fn models_that_are_none() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    folder.run("train --data t --model good");
    let good = folder.get("good");
    let not = "m: not a rollin model; name a file that `rollin train --model` wrote";
    let check = |bytes: &[u8], message: &str| {
        folder.put("m", bytes);
        for line in ["tag --model m", "evaluate --model m --data t", "inspect m"] {
            let said = folder.refused_on(line, "the D\n");
            assert!(said.starts_with(&format!("error: {message}")) && said.lines().count() == 1, "{line}: {said}");
        }
    };
    check(b"", not);
    check(TAGS.as_bytes(), not);
    check(b"rollin model", not);
    check(&[0xff; 100], not);
    let version = "m: a model of format version 999, but this program reads version 1; train it again";
    check(&[b"rollin model 999\n", &good[15..]].concat(), version);
    check(&good[..15], "m: the model is damaged: its second line is missing");
    check(&good[..good.len() - 1], "m: the model is damaged: it has ");
    check(&good[..good.len() / 2], "m: the model is damaged: it has ");
    check(&[&good[..], b"x"].concat(), "m: the model is damaged: it has ");
    let mut flipped = good.clone();
    *flipped.last_mut().expect("a byte") ^= 1;
    check(&flipped, "m: the model is damaged: its checksum is wrong; copy or train it again");

    // Every byte of the first lines, and of the body every so many.
    for at in (0..200).chain((200..good.len()).step_by(61)) {
        for bit in [1, 0x20, 0x80] {
            let mut bytes = good.clone();
            bytes[at] ^= bit;
            let error = rollin::tasks::tagging::Tagger::from_bytes(&bytes, "m".as_ref()).expect_err("a damaged model");
            assert!(error.to_string().starts_with("m: "), "{at}: {error}");
        }
    }
    folder.says("inspect no", "cannot read no: No such file or directory (os error 2)");
    folder.says("tag --model .", "cannot read .: Is a directory (os error 21)");
}

/// A model file whose body was changed by someone who also mended length and checksum.
fn forged(good: &[u8], old: &str, new: &str) -> Vec<u8> {
    let start = good.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(1).expect("two lines").0 + 1;
    let json = start + good[start..].iter().position(|byte| *byte == b'\n').expect("a header");
    let header = std::str::from_utf8(&good[start..json]).expect("text");
    assert!(header.contains(old), "{header}");
    let body = [header.replacen(old, new, 1).as_bytes(), &good[json..]].concat();
    let sum = rapidhash::v3::rapidhash_v3(&body);
    [format!("rollin model 1\n{} bytes, checksum {sum:016x}\n", body.len()).as_bytes(), &body].concat()
}

#[test]
fn a_model_is_blamed_for_its_own_template() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    folder.put("p", "U:%x[0,0]\n");
    folder.run("train --data t --model good --template p");
    let good = folder.get("good");
    folder.put("m", forged(&good, "U:%x[0,0]", "U:%x[0,0"));
    let message = folder.refused_on("tag --model m", "the\n");
    let start = "error: m: the model is damaged: its body is no tagging model: <template in m>:1:9: ";
    assert!(message.starts_with(start) && message.ends_with("; copy or train it again\n"), "{message}");
    for (old, new) in [
        ("\"label_column\"", "\"unknown\""),
        ("\"features\":", "\"features\":9"),
        ("\"contexts\":[", "\"contexts\":[1"),
        ("\"rows\":[", "\"rows\":[18446744073709551615,"),
        ("\"rows\":[", "\"rows\":[-"),
        ("\"D\",\"N\"", "\"N\",\"D\""),
        ("\"weights\":[1.0]", "\"weights\":[0.5]"),
        ("\"weights\":[1.0]", "\"weights\":[]"),
        ("U:%x[0,0]\\n", "U:%x[0,0]\\nU:%y[-9]\\n"),
    ] {
        folder.put("m", forged(&good, old, new));
        let message = folder.refused_on("tag --model m", "the\n");
        assert!(message.starts_with("error: m: the model is damaged: "), "{new}: {message}");
    }
    folder.put("m", forged(&good, "\"tagging\"", "\"weaving\""));
    folder.says(
        "inspect m",
        "m: a model for weaving; this program knows tagging, segmenting, parsing, ocr, graph, navigation, tabular",
    );
}

#[test]
fn models_that_cannot_be_written() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    folder.says("train --data t --model no/m", "cannot write no/m: No such file or directory (os error 2)");
    std::fs::create_dir(folder.path("folder")).expect("a folder");
    folder.says("train --data t --model folder", "cannot write folder: is a directory");
    folder.says("train --data t --model t/m", "cannot write t/m: not a directory");
    // It is found out before anything else is read.
    folder.says("train --data no --model no/m", "cannot write no/m: No such file or directory (os error 2)");
    assert_eq!(std::fs::read_dir(folder.path("folder")).expect("a folder").count(), 0);
}

#[test]
fn a_model_in_place_stays_when_training_fails() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    folder.run("train --data t --model m");
    let before = folder.get("m");
    folder.put("bad", "a\n");
    folder.refused("train --data bad --model m");
    folder.refused("train --data t --model m --alpha 2");
    assert!(folder.get("m") == before);
}

/// Who closes a pipe early (`| head`) has what they wanted, and is told of no error.
#[test]
fn nobody_reads_the_output() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    folder.run("train --data t --model m");
    let grammar = shipped("grammars/dialects.grammar");
    for line in [
        "tag --model m".to_owned(),
        "inspect m".to_owned(),
        "evaluate --model m --data t --json".to_owned(),
        "compare --data t --algorithms supervised".to_owned(),
        format!("generate --grammar {grammar} --count 100000"),
    ] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_rollin"))
            .current_dir(folder.0.path())
            .args(line.split_whitespace())
            .stdin(Stdio::from(std::fs::File::open(folder.path("t")).expect("it is there")))
            .stdout(writer)
            .stderr(Stdio::piped())
            .output()
            .expect("the program runs");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), &message[..]), (Some(141), ""), "{line}");
    }
}

#[test]
fn what_would_be_lost_or_ignored_is_refused() {
    let folder = Folder::new();
    folder.put("t", TAGS);
    folder.says("train --data t --model ./t", "--model is ./t, but must be another file than --data");
    for algorithm in ["dagger-online", "searn-online"] {
        folder.says(
            &format!("train --data t --model m --algorithm {algorithm} --passes 3"),
            &format!("--passes is given, but must be left out: {algorithm} makes one pass a round; use --rounds"),
        );
    }
    folder.put("far.template", "U:%x[0,0]\nU:%y[-9]\n");
    folder.says(
        "train --data t --model m --template far.template",
        "far.template:2:6: \"-9]\"; expected a label, from -8 to 8",
    );
}
