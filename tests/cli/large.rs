//! Large inputs, which take seconds.

use super::Folder;

/// One sentence of `n` words.
fn sentence(n: usize) -> String {
    (0..n).map(|i| format!("w{} t{}\n", i * i % 4999, i * i % 4999 % 10)).collect()
}

#[test]
fn a_sentence_of_a_hundred_thousand_words() {
    let folder = Folder::new();
    folder.put("U.template", "U:%x[0,0]\nU-1:%x[-1,0]\nB\n");
    folder.put("long.txt", sentence(100_000));
    for (algorithm, least) in [("supervised", 99_000), ("dagger-online", 99_000), ("forward", 0)] {
        folder.run(&format!("train --data long.txt --model m --algorithm {algorithm} --template U.template"));
        let tagged = folder.run_on("tag --model m", folder.get("long.txt"));
        assert_eq!(tagged.lines().count(), 100_000);
        let right = tagged.lines().filter(|line| {
            let mut cells = line.split(' ').skip(1);
            cells.next() == cells.next()
        });
        assert!(right.count() > least, "{algorithm}");
    }
}

#[test]
fn a_word_of_a_megabyte() {
    let folder = Folder::new();
    let word = "b".repeat(1_000_000);
    let text = format!("a X\n{word} Y\n\nc X\n");
    folder.put("t.txt", &text);
    folder.run("train --data t.txt --model m");
    assert!(folder.run_on("tag --model m", text.as_str()) == format!("a X X\n{word} Y Y\n\nc X X\n"));
}

#[test]
fn five_thousand_labels() {
    let folder = Folder::new();
    let line = |i: usize| format!("w{i} L{i}\n{}", if i % 10 == 9 { "\n" } else { "" });
    let text: String = (0..5000).map(line).collect();
    folder.put("t.txt", &text);
    folder.put("U.template", "U:%x[0,0]\n");
    folder.run("train --data t.txt --model m --template U.template --learner perceptron");
    let score = folder.json("evaluate --model m --data t.txt --json");
    assert_eq!((&score["tokens"], &score["right"]), (&5000.into(), &5000.into()));
}

#[test]
fn twenty_columns() {
    let folder = Folder::new();
    let row =
        |i: usize| (0..19).map(|c| format!("c{c}v{} ", (i + c) % 3)).collect::<String>() + &format!("L{}\n", i % 3);
    folder.put("t.txt", (0..300).map(|i| row(i) + if i % 5 == 4 { "\n" } else { "" }).collect::<String>());
    folder.run("train --data t.txt --model m --algorithm dagger");
    assert_eq!(folder.json("evaluate --model m --data t.txt --json")["right"], 300);
}
