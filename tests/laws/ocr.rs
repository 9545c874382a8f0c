//! Handwritten words: what is read, what is refused and where, and what a policy sees.

use rollin::Seed;
use rollin::learner::Logistic;
use rollin::read::letters::{Letters, parse, read_file};
use rollin::roll::perform;
use rollin::space::{Action, Episode, Features, Problem, Space};
use rollin::tasks::ocr::{Accuracy, Ocr, Sightings};
use rollin::trainer::{Dagger, Run, Searn, Smile, Supervised};

const HEAD: &str = "word_id\tposition\tfold\tletter\tbits\n";

/// 128 pixels of which those in `on` are on.
fn bits(on: &[usize]) -> String {
    (0..128).map(|pixel| if on.contains(&pixel) { '1' } else { '0' }).collect()
}

fn read(text: &str) -> rollin::Result<Letters> {
    parse(text.as_bytes(), "letters.tsv".as_ref())
}

#[test]
fn words_are_read() {
    let (a, b) = (bits(&[0, 9]), bits(&[127]));
    let text = format!("{HEAD}7\t1\t3\ta\t{a}\r\n7\t2\t3\tz\t{b}\n9\t1\t0\tm\t{a}");
    let letters = read(&text).unwrap();
    assert_eq!((letters.words(), letters.len()), (2, 3));
    assert_eq!((letters.word(0), letters.word(1)), (0..2, 2..3));
    assert_eq!((letters.fold(0), letters.fold(1)), (3, 0));
    assert_eq!(letters.labels(), [0, 25, 12]);
    assert_eq!(letters.images(), [1 | 1 << 9, 1 << 127, 1 | 1 << 9]);
    assert_eq!(letters.of_folds(|fold| fold == 0).labels(), [12]);
    let mut twice = letters.clone();
    twice.append(&letters.moved(1, 0));
    assert_eq!((twice.words(), twice.word(3)), (4, 5..6));
    assert_eq!(twice.images()[3], 1 << 8 | 1 << 17);
}

#[test]
fn what_is_not_of_that_form_is_refused_with_its_place() {
    let ok = bits(&[3]);
    let line = |fields: &str| format!("{HEAD}1\t1\t0\ta\t{ok}\n{fields}");
    let cases = [
        ("".to_owned(), "1:1: no word"),
        ("a\tb\n".to_owned(), "1:1: another first line"),
        (HEAD.to_owned(), "2:1: no word"),
        (line("x\t2\t0\ta\t1"), "3:1: `x`; expected a word's number"),
        (line(&format!("1\t3\t0\ta\t{ok}")), "3:3: `3`; expected position 2"),
        (line(&format!("2\t2\t0\ta\t{ok}")), "3:3: `2`; expected position 1"),
        (line(&format!("1\t2\t5\ta\t{ok}")), "3:5: `5`; expected fold 0"),
        (line(&format!("2\t1\t10\ta\t{ok}")), "3:5: `10`; expected the number of a fold"),
        (line(&format!("1\t2\t0\tA\t{ok}")), "3:7: `A`; expected a letter from a to z, or _"),
        (line(&format!("1\t2\t0\tab\t{ok}")), "3:7: `ab`; expected a letter"),
        (line(&format!("1\t2\t0\tb\t{}2", &ok[1..])), "3:136: `2`; expected pixel 128 of 128"),
        (line("1\t2\t0\tb\t01"), "3:11: nothing; expected pixel 3 of 128"),
        (line(&format!("1\t2\t0\tb\t{ok}0")), "3:137: `0`; expected the end of the line"),
        (line("\n"), "3:1: nothing; expected a word's number"),
        (line("99999999999999999999\t1"), "3:1: `99999999999999999999`; expected a word's number"),
    ];
    for (text, expected) in cases {
        let error = read(&text).unwrap_err().to_string();
        assert!(error.starts_with(&format!("letters.tsv:{expected}")), "{error} for {expected}");
    }
    assert!(parse(b"\xff\xfe", "x".as_ref()).is_err());
}

/// A word of `length` letters with empty images.
fn blank(length: u32) -> Letters {
    let mut letters = Letters::default();
    letters.begin(0);
    (0..length).for_each(|letter| letters.push(letter % 26, 0));
    letters
}

#[test]
fn settings_out_of_range_are_refused() {
    for see in [
        Sightings { patch: 0, ..Sightings::default() },
        Sightings { patch: 4, ..Sightings::default() },
        Sightings { passes: 0, ..Sightings::default() },
        Sightings { passes: 9, ..Sightings::default() },
    ] {
        assert!(Ocr::new(&blank(3), see).is_err());
    }
    assert!(Ocr::new(&blank(25), Sightings::default()).is_ok());
    let error = Ocr::new(&blank(26), Sightings::default()).unwrap_err().to_string();
    assert!(error.contains("26 in a word"), "{error}");
}

/// What is seen after these letters were said.
fn seen(space: &Ocr, said: &[u32]) -> Features {
    let mut state = space.start(Episode { index: 0, seed: Seed::new(1) });
    for letter in said {
        space.step(&mut state, Action(*letter), Seed::new(1));
    }
    let mut view = Features::default();
    space.look(&state, &mut view);
    view.dynamic.sort_unstable();
    view
}

#[test]
fn the_papers_features_by_hand() {
    let mut letters = blank(2);
    letters.begin(1);
    letters.push(4, 1 | 1 << 100);
    let space = Ocr::new(&letters, Sightings::default()).unwrap();
    // 128 pixels, one that is always on, and the letter before or the beginning of the word.
    assert_eq!(space.shared().row(2), [0, 100, 128]);
    assert_eq!(space.shared().row(0), [128]);
    assert_eq!(seen(&space, &[]).dynamic, [129 + 26]);
    assert_eq!(seen(&space, &[7]).dynamic, [129 + 7]);
    // One pixel in the corner is in one patch of each size, one within the frame in 4 and in 9.
    let mut letters = blank(0);
    letters.push(0, 1);
    letters.push(0, 1 << (8 * 8 + 4));
    let space = Ocr::new(&letters, Sightings { patch: 3, ..Sightings::default() }).unwrap();
    assert_eq!((space.shared().row(0).len(), space.shared().row(1).len()), (2 + 2, 2 + 4 + 9));
    // All contents of all patches have numbers of their own: the top left pixel of the patch is its lowest bit.
    assert_eq!(space.shared().row(0), [0, 128, 129 + 0b0100, 129 + 15 * 7 * 16 + 0b001_000_000]);
    assert!(space.shared().row(1).iter().all(|f| (*f as usize) < space.shared().features()));
}

/// A view depends on the letters that are within sight and no others, and so does the signature.
#[test]
fn histories_are_seen_as_far_as_they_go() {
    let space = |see| Ocr::new(&blank(5), see).unwrap();
    let one = space(Sightings::default());
    assert_eq!(seen(&one, &[1, 2, 3]).dynamic, seen(&one, &[9, 9, 3]).dynamic);
    let two = space(Sightings { history: 2, ..Sightings::default() });
    assert_ne!(seen(&two, &[1, 2, 3]).dynamic, seen(&two, &[1, 9, 3]).dynamic);
    assert_eq!(seen(&two, &[1, 2, 3]).dynamic, seen(&two, &[9, 2, 3]).dynamic);
    // The word is gone over twice: then letters ahead count, and what was said of this one.
    let twice = space(Sightings { history: 2, passes: 2, ..Sightings::default() });
    let second = |ahead: u32, own: u32| seen(&twice, &[0, 1, own, ahead, 4, 0, 1]).dynamic;
    assert_ne!(second(3, 2), second(8, 2));
    assert_ne!(second(3, 2), second(3, 7));
    // The second time counts, the first does not.
    let mut state = twice.start(Episode { index: 0, seed: Seed::new(1) });
    let costs: Vec<f64> = (0..10).map(|_| twice.step(&mut state, Action(0), Seed::new(1))).collect();
    assert_eq!(costs, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
    assert!(twice.legal(&state).is_empty());
    assert_eq!(twice.horizon(0), Some(10));
}

/// Words of three kinds of letters whose images are drawn, half of which say nothing: what the letter before was decides then.
fn made(words: u64) -> Letters {
    let mut letters = Letters::default();
    for word in 0..words {
        letters.begin((word % 10) as u8);
        let seed = Seed::new(word);
        let start = (seed.unit() * 3.0) as u32;
        for t in 0..6u32 {
            let letter = (start + t) % 3;
            let dull = t > 0 && seed.child(rollin::Purpose::Step, u64::from(t)).unit() < 0.5;
            letters.push(letter, if dull { 1 } else { 2 << letter });
        }
    }
    letters
}

/// Every kind of trainer learns it, and pays what it should.
#[test]
fn trainers_learn_it() {
    let see = [Sightings::default(), Sightings { history: 3, rest: true, passes: 2, ..Sightings::default() }];
    for see in see {
        let problem = Ocr::new(&made(40), see).unwrap().problem();
        let (run, logistic) = (Run::new(1), Logistic::default());
        let right = |costs: Vec<f64>| Accuracy::of(&problem.space, &costs).of_letters();
        let supervised = Supervised::default().train(&problem, &logistic, &run).unwrap().policy;
        let dagger = Dagger::default().train(&problem, &logistic, &run).unwrap();
        let smile = Smile::default().train(&problem, &logistic, &run).unwrap().policy;
        let searn = Searn { rounds: 3, ..Searn::default() };
        let searn = searn.train(&problem, &logistic, &run).unwrap().policy;
        let steps: u64 = (0..40).map(|i| problem.space().horizon(i).unwrap() as u64).sum();
        assert_eq!(dagger.ledger.labels, 5 * steps);
        let mut accuracies = Vec::new();
        for costs in [
            perform(&problem, &supervised, Seed::new(2)).0.costs,
            perform(&problem, &dagger.policy, Seed::new(2)).0.costs,
            perform(&problem, &smile, Seed::new(2)).0.costs,
            perform(&problem, &searn, Seed::new(2)).0.costs,
        ] {
            accuracies.push(right(costs));
        }
        // A mixture that is sampled is as good as its members are on the mean.
        assert!(
            accuracies[..2].iter().all(|a| *a > 0.95) && accuracies[2..].iter().all(|a| *a > 0.8),
            "{accuracies:?}"
        );
    }
}

/// The corpus itself, if it is there: its known counts, and a fold learned from another.
#[test]
fn the_words_of_kassel_and_taskar() {
    let Ok(data) = std::env::var("ROLLIN_DATA") else {
        return println!("skipped: ROLLIN_DATA does not say where ocr/letters.tsv is");
    };
    let letters = read_file(std::path::Path::new(&data).join("ocr/letters.tsv")).unwrap();
    assert_eq!((letters.words(), letters.len()), (6_877, 52_152));
    let fold = |n: u8| letters.of_folds(|fold| fold == n);
    let sizes: Vec<(usize, usize)> = (0..10).map(|n| (fold(n).words(), fold(n).len())).collect();
    assert_eq!(sizes[0], (626, 4617));
    assert_eq!(sizes[9], (675, 5142));
    let see = Sightings { patch: 3, history: 2, ..Sightings::default() };
    let problem = Ocr::new(&fold(0), see.clone()).unwrap().problem();
    let dagger = Dagger { rounds: 2, ..Dagger::default() };
    let trained = dagger.train_online(&problem, &Logistic::default(), &Run::new(1)).unwrap();
    let test = Ocr::new(&fold(1), see).unwrap().problem();
    let found = Accuracy::of(&test.space, &perform(&test, &trained.policy, Seed::new(2)).0.costs);
    assert!(found.of_letters() > 0.7 && found.of_words() > 0.15, "{found:?}");
}
