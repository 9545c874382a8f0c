//! What a model knows, why it says what it says, and what it gets wrong.

use super::{CHUNKS, Folder, TAGS};
use rollin::Seed;
use rollin::policy::Reading;
use rollin::read::{conll, template::Template};
use rollin::tasks::tagging::{Encoding, Tagger};
use rollin::tasks::{About, AnyLearner, Learned, Model, Task, Trainer};
use rollin::trainer::{Keeping, Run};
use serde_json::Value;

/// A tagger for [`TAGS`].
fn tagger(template: &str, trainer: &str, learner: &str) -> Tagger {
    let corpus = conll::parse(TAGS.as_bytes(), "tags".as_ref(), 1).expect("a corpus");
    let template = Template::parse(template, "template".as_ref()).expect("a template");
    let trainer: Trainer = serde_json::from_str(trainer).expect("a trainer");
    let learner: AnyLearner = serde_json::from_str(learner).expect("a learner");
    let (encoding, space) = Encoding::learn(&corpus, template.into()).expect("learned");
    let train = |problem: &_, run: &Run<'_, Keeping>| trainer.train(problem, &learner, run);
    let trained = Encoding::train(&space.problem(), &Run::new(1).kept(None), &train).expect("trained");
    Model::new(encoding, trained.policy.read_as(Reading::Mean), About::default()).expect("few features")
}

const WORDS: &str = "U0:%x[0,0]\nU1:%x[-1,0]/%x[0,0]\nB\n*2:%x[0,0]\nU3:%y[-2]/%y[-1]\n";

/// Whatever decides by one sum of weights: the weights add up to the score, bit for bit.
#[test]
fn reasons_add_up() {
    let corpus = conll::parse(TAGS.as_bytes(), "tags".as_ref(), 1).expect("a corpus");
    let ahead = format!("{WORDS}U4:%y[1]/%x[0,0]\n");
    let logistic = r#"{"logistic":{}}"#;
    for (template, trainer, greedy) in [
        (WORDS, r#"{"dagger":{}}"#, true),
        (WORDS, r#"{"smile":{"rounds":3}}"#, true),
        (WORDS, r#"{"forward":{}}"#, true),
        (WORDS, r#"{"stacked":{"folds":2}}"#, true),
        (WORDS, r#"{"early-update":{"width":4}}"#, false),
        (&ahead, r#"{"dagger-online":{}}"#, true),
    ] {
        let model = tagger(template, trainer, logistic);
        let space = model.encoding.apply(&corpus).expect("the same columns");
        let seed = Seed::new(1);
        let actions = model.perform(space, corpus.sentences(), 0, seed);
        let reasons = model.reasons(&corpus, &actions, 0, seed).expect("the same columns").expect("a sum");
        let names = model.names(&corpus).expect("the same columns");
        assert_eq!(reasons.len(), corpus.tokens(), "{trainer}");
        for (reason, action) in reasons.iter().zip(&actions) {
            assert_eq!(reason.chosen, *action, "{trainer}");
            let sums = reason.shares.iter().fold([0f32; 2], |[high, low], s| [high + s.chosen, low + s.other]);
            assert_eq!(sums.map(f32::to_bits), reason.scores.map(f32::to_bits), "{trainer}");
            assert!(!greedy || reason.other.is_none() || reason.scores[0] >= reason.scores[1], "{trainer}");
            assert!(reason.shares.iter().all(|share| names(share.feature).is_some()), "{trainer}");
        }
    }
    // What is drawn, or decides by pairs, is no sum.
    for (trainer, learner) in [(r#"{"smile":{}}"#, r#"{"wap":{}}"#), (r#"{"dagger":{}}"#, r#"{"net":{"units":2}}"#)] {
        let model = tagger(WORDS, trainer, learner);
        assert!(model.policy.sums().is_none() && model.reasons(&corpus, &[], 0, Seed::new(1)).expect("fine").is_none());
    }
    let model = tagger(WORDS, r#"{"smile":{"rounds":3}}"#, logistic);
    assert!(matches!(&model.policy, Learned::Mixture(mixture) if mixture.members().len() == 1));
}

#[test]
fn a_tagger_explains_itself() {
    let folder = Folder::new();
    folder.put("c", CHUNKS);
    folder.run("train --data c --model m -q --rounds 20");
    let plain = folder.run_on("tag --model m", CHUNKS);
    let told = folder.run_on("tag --model m --explain", CHUNKS);
    // But for comments the answer is the same.
    let kept: String = told.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n")).collect();
    assert_eq!(kept, plain);
    let heads: Vec<&str> = told.lines().filter(|line| line.starts_with("#  ") && !line.starts_with("#   ")).collect();
    assert_eq!(heads.len(), 10);
    assert!(heads[0].starts_with("#  B-NP ") && heads[0].contains(", then "), "{}", heads[0]);
    assert!(told.lines().any(|line| line.starts_with("#    ") && line.ends_with(" more")), "{told}");

    let tokens: Vec<Value> = (folder.run_on("tag --model m --explain --json", CHUNKS).lines())
        .map(|line| serde_json::from_str(line).expect("an object a line"))
        .collect();
    assert_eq!(tokens.len(), 10);
    for (token, line) in tokens.iter().zip(CHUNKS.lines().zip(1..).filter(|(line, _)| !line.is_empty())) {
        assert_eq!((&token["line"], token["label"].as_str()), (&line.1.into(), line.0.split(' ').nth(2)));
        for (score, part) in [("score", "label"), ("other_score", "other")] {
            let parts = token["features"].as_array().expect("features").iter();
            let sum = parts.fold(0f32, |sum, feature| sum + feature[part].as_f64().expect("a number") as f32);
            assert_eq!(sum, token[score].as_f64().expect("a number") as f32, "{token}");
        }
        let word = line.0.split(' ').next().expect("a word");
        assert!(
            token["features"]
                .as_array()
                .expect("features")
                .iter()
                .any(|f| f["feature"].as_str().is_some_and(|f| f.contains(word)))
        );
    }
    assert_eq!(folder.run_on("tag --model m --explain --json", "\n\n"), "");

    folder.run("train --data c --model s -q --algorithm smile --reading sampled");
    let message = folder.refused_on("tag --model s --explain", CHUNKS);
    assert!(
        message.contains("does not decide by one sum of weights") && message.contains("--reading mean"),
        "{message}"
    );
    assert!(folder.run_on("tag --model s --explain --reading mean", CHUNKS).contains("\n#  B-NP "));
    let json = "--json is given, but must be left out: tag writes the lines it reads";
    folder.says_on("tag --model m --json", CHUNKS, json);
}

#[test]
fn a_model_tells_what_it_knows() {
    let folder = Folder::new();
    folder.put("c", CHUNKS);
    folder.put("t", "U:%x[0,0]\nB\n");
    folder.run("train --data c --template t --model m -q --rounds 20");
    let told = folder.run("inspect m");
    assert!(told.contains("names of features from c\n") && told.contains("\nwhat follows what"), "{told}");
    assert!(
        told.contains("\nexpert queries") && told.contains("\nroll-outs") && told.contains("\ndictionaries"),
        "{told}"
    );
    let json = folder.json("inspect m --json --top 3");
    let labels = json["top"]["labels"].as_array().expect("labels");
    assert_eq!(labels.len(), 4);
    // `sleeps` and `sees` are the words of verbs, and nothing else says so in this corpus but what stands before.
    let verbs = &labels[1];
    assert_eq!(verbs["label"], "B-VP");
    let best: Vec<&str> = verbs["for"].as_array().expect("some").iter().filter_map(|f| f["feature"].as_str()).collect();
    assert!(best.contains(&"U:sleeps") && best.contains(&"U:sees"), "{best:?}");
    for told in labels {
        for (side, sign) in [("for", 1.0), ("against", -1.0)] {
            let weights: Vec<f64> =
                told[side].as_array().expect("a list").iter().filter_map(|f| f["weight"].as_f64()).collect();
            assert!(weights.len() <= 3 && weights.iter().all(|w| sign * w > 0.0), "{told}");
            assert!(weights.is_sorted_by(|a, b| sign * a >= sign * b), "{told}");
        }
    }
    let steps = json["top"]["transitions"].as_array().expect("steps");
    assert_eq!(steps.len(), 6);
    assert!(steps.iter().any(|step| step["before"].is_null() || step["before"].is_string()));
    let size = &json["size"];
    let all: u64 =
        ["header", "dictionaries", "features", "weights"].iter().filter_map(|part| size[part].as_u64()).sum();
    assert_eq!(all, folder.get("m").len() as u64);
    // 8 words, and the context of B.
    assert_eq!(size["dictionaries"], 8 * 9);

    let one = folder.json("inspect m --json --label O");
    assert_eq!(one["top"]["labels"].as_array().map(Vec::len), Some(1));
    folder.says(
        "inspect m --label B-NPP",
        "--label is B-NPP, but must be one of B-NP, B-VP, I-NP, O; did you mean B-NP?",
    );
    std::fs::remove_file(folder.path("c")).expect("it is there");
    assert!(folder.run("inspect m").contains("no names of features"));
    folder.put("elsewhere", CHUNKS);
    let named = folder.json("inspect m --json --top 3 --data elsewhere");
    assert_eq!(named["top"]["labels"], json["top"]["labels"]);
    assert_eq!(folder.json("inspect m --json --top 0")["top"], Value::Null);
    folder.says("inspect m --data none", "cannot read none: No such file or directory (os error 2)");
}

#[test]
fn mistakes_are_told() {
    let folder = Folder::new();
    folder.put("c", CHUNKS);
    folder.run("train --data c --model m -q --rounds 20");
    // The model knows the corpus by heart: what is changed here is what it gets wrong.
    let changed =
        CHUNKS.replace("sees V B-VP", "sees V O").replace("boats N B-NP", "boats N O").replacen("B-VP", "O", 1);
    folder.put("n", &changed);
    let json = folder.json("evaluate --model m --data n --errors --json");
    let errors = &json["errors"];
    assert_eq!((&errors["wrong"], &errors["sentences_with_mistakes"]), (&3.into(), &2.into()));
    let sentences = errors["sentences"].as_array().expect("sentences");
    assert_eq!((sentences[0]["place"].as_str(), &sentences[0]["wrong"]), (Some("n:7"), &2.into()));
    assert_eq!((sentences[1]["place"].as_str(), &sentences[1]["wrong"]), (Some("n:1"), &1.into()));
    let word = &sentences[0]["words"][3];
    assert_eq!(*word, serde_json::json!({"line": 10, "word": "boats", "right": "O", "given": "B-NP"}));
    let common = &errors["confusions"][0];
    assert_eq!(
        (common["right"].as_str(), common["given"].as_str(), &common["count"]),
        (Some("O"), Some("B-VP"), &2.into())
    );
    assert!((common["share"].as_f64().expect("a number") - 2.0 / 3.0).abs() < 1e-12);

    let text = folder.run("evaluate --model m --data n --errors 1 --html page.html");
    let expected = "
right  given  times  % of all mistakes
O       B-VP      2               66.7

The worst sentences: 1 of 2 with mistakes

n:7: 2 of 5 wrong
word   right  given
a       B-NP   B-NP
man     I-NP   I-NP
sees       O   B-VP  wrong
boats      O   B-NP  wrong
.          O      O
";
    assert!(text.contains(expected), "{text}");
    let page = String::from_utf8(folder.get("page.html")).expect("text");
    assert!(page.contains("Commonest confusions") && page.contains("n:7: 2 of 5 wrong"));
    assert!(!folder.run("evaluate --model m --data n").contains("worst"));
    let right = folder.run("evaluate --model m --data c --errors");
    assert!(right.ends_with("right  given  times  % of all mistakes\n"), "{right}");
}
