//! Formats, and labels that are mended.

use super::{CHUNKS, Folder};

const TEMPLATE: &str = "@pad <s> </s>\nU0:%x[0,0]\nU1:%x[-1,1]|%x[0,1]\nB\nU2:%y[-1]\n";

#[test]
fn columns_become_attributes() {
    let folder = Folder::new();
    folder.put("c.txt", CHUNKS);
    folder.put("t", TEMPLATE);
    let crfsuite = folder.run("convert --from conll --to crfsuite --template t --data c.txt");
    let first = "B-NP\tU0\\:the\tU1\\:<s>|D\nI-NP\tU0\\:old\tU1\\:D|A\n";
    assert!(crfsuite.starts_with(first), "{crfsuite}");
    let vw = folder.run_on("convert --from conll --to vw --template t --label-column 2", CHUNKS);
    assert!(vw.starts_with("B-NP | U0%3Athe U1%3A<s>%7CD\nI-NP | U0%3Aold U1%3AD%7CA\n"), "{vw}");
    // There and back.
    assert_eq!(folder.run_on("convert --from crfsuite --to vw", crfsuite.as_str()), vw);
    assert_eq!(folder.run_on("convert --from vw --to crfsuite", vw.as_str()), crfsuite);
    let columns = folder.run_on("convert --from vw --to conll", "1 | a b%3Ac\n2 | d\n\n");
    assert_eq!(columns, "a\tb:c\t1\nd\t_\t2\n\n");
    // Many blocks.
    let long = vw.repeat(20_000);
    assert!(folder.run_on("convert --from vw --to crfsuite", long) == crfsuite.repeat(20_000));
    // Columns as they are, but for what separates them.
    assert_eq!(folder.run_on("convert --from conll --to conll", "a  b \r\n\n\nc\td"), "a\tb\n\nc\td\n\n");
    // An attribute file trains a tagger by way of columns.
    folder.put("a.txt", folder.run_on("convert --from crfsuite --to conll", crfsuite));
    folder.run("train --data a.txt --model m --rounds 20");
    assert_eq!(folder.json("evaluate --model m --data a.txt --json")["right"], 10);
}

#[test]
fn treebanks_become_columns() {
    let folder = Folder::new();
    let text = "# text\n1\ta b\t_\tX\t_\t_\t0\troot\t_\t_\n\n";
    let columns = folder.run_on("convert --from conllu --to conll", text);
    assert_eq!(columns, "1\ta%20b\t_\tX\t_\t_\t0\troot\t_\t_\n\n");
    assert_eq!(folder.run_on("convert --from conll --to conllu", columns), text.replace("# text\n", ""));
    folder.put("t", "U:%x[0,1]\n");
    let vw = folder.run_on("convert --from conllu --to vw --template t --label-column 3", text);
    assert_eq!(vw, "X | U%3Aa%2520b\n\n");
}

#[test]
fn what_cannot_be_converted_is_refused() {
    let folder = Folder::new();
    folder.put("t", TEMPLATE);
    folder.put("b", "B\n");
    let template = "--template is left out, but must be given: it says what the attributes are";
    folder.says_on("convert --from conll --to vw", "a b\n", template);
    for line in ["--from vw --to conll --template t", "--from conll --to conll --template t"] {
        let message = "--template is given, but must be left out: it is for making attributes of columns";
        folder.says_on(&format!("convert {line}"), "1 | a\n", message);
    }
    let value = "<stdin>:3:5: the value `0.5`; expected 1 or no value at all: features are there or not";
    folder.says_on("convert --from vw --to crfsuite", "1 | a\n\n| a:0.5\n", value);
    folder.says_on("convert --from vw --to crfsuite", "\n", "<stdin>: no sentence; give it at least one");
    let json = "--json is given, but must be left out: convert writes a corpus";
    folder.says_on("convert --json --from vw --to crfsuite", "1 | a\n", json);
    let labels =
        "b: every pattern looks at labels, so that none makes an attribute; give one that looks at columns only";
    folder.says_on("convert --from conll --to vw --template b", "a b\n", labels);
    let uneven = format!("{}c\n", "a b\n\n".repeat(40_000));
    let output = folder.rollin("convert --from conll --to conll").write_stdin(uneven).output().expect("it runs");
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(message, "error: <stdin>:80001:2: 1 column; expected 2 columns as on line 65537\n");
}

/// Two spans that begin with I-.
const BROKEN: &str = "a x B-X\nb y I-X\nc z O\nd x I-X\n\nb y I-Y\nb y I-Y\n";

#[test]
fn labels_are_mended_and_it_is_said() {
    let folder = Folder::new();
    folder.put("c.txt", BROKEN);
    let [_, errors] = folder.told("train --data c.txt --model m", "");
    assert_eq!(
        errors,
        "note: c.txt:4:5: label I-X and 1 more may not stand there by iob2, so any label may follow any; --repair mends this, \
         --order free wants it so\n"
    );
    assert_eq!(folder.json("inspect m --json")["order"], "free");
    let [_, errors] = folder.told("train --data c.txt --model m --order free", "");
    assert_eq!(errors, "");
    let mended = "note: c.txt:4:5: I-X is now B-X\nnote: c.txt:6:5: I-Y is now B-Y\n";
    for line in ["train --data c.txt --model m --repair", "train --data c.txt --model m --repair --order iob2"] {
        let [_, errors] = folder.told(line, "");
        assert_eq!(errors, mended);
        assert_eq!(folder.json("inspect m --json")["order"], "iob2");
    }
    let [_, errors] = folder.told("evaluate --model m --data c.txt", "");
    assert_eq!(
        errors,
        "note: c.txt:4:5: label I-X and 1 more may not stand there by iob2, so that the model, which keeps to that, is wrong there; \
         --repair mends this\n"
    );
    let [score, errors] = folder.told("evaluate --model m --data c.txt --repair --json", "");
    assert_eq!(errors, mended);
    let score: serde_json::Value = serde_json::from_str(&score).expect("JSON");
    assert_eq!((&score["tokens"], &score["chunks"]["gold"]), (&6.into(), &3.into()));

    let [text, errors] = folder.told("convert --from conll --to conll --repair --order bilou", BROKEN);
    assert_eq!(text, "a\tx\tB-X\nb\ty\tL-X\nc\tz\tO\nd\tx\tU-X\n\nb\ty\tB-Y\nb\ty\tL-Y\n\n");
    assert_eq!(errors.lines().count(), 4);
    let many = "b y I-Y\n\n".repeat(9);
    let [_, errors] = folder.told("convert --from conll --to conll --repair", many);
    assert_eq!(errors.lines().count(), 6);
    assert!(errors.ends_with("note: <stdin>: 4 more labels were changed\n"), "{errors}");
    let [text, _] = folder.told("convert --from crfsuite --to vw --repair", "I-X\ta\nI-X\ta\n");
    assert_eq!(text, "B-X | a\nI-X | a\n\n");

    // And BILOU trains.
    folder.put("u.txt", folder.told("convert --from conll --to conll --repair --order bilou", BROKEN)[0].clone());
    folder.run("train --data u.txt --model m --rounds 20");
    assert_eq!(folder.json("inspect m --json")["order"], "bilou");
    let score = folder.json("evaluate --model m --data u.txt --json");
    assert_eq!((&score["right"], &score["chunks"]["correct"]), (&6.into(), &3.into()));
}
