//! `rollin experiment` and `rollin drive`.

use crate::balance;
use crate::chromium::Browser;
use assert_cmd::Command;
use rollin::experiment::{Amount, Length, Plan, Platforming, Racing, Scale};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

fn run(folder: &TempDir, line: &str) -> (bool, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rollin"));
    let output = command.current_dir(folder.path()).args(line.split_whitespace()).output().expect("the program runs");
    let ok = output.status.success();
    assert!(ok || output.status.code() == Some(2), "{line}: {:?}", output.status);
    (ok, String::from_utf8(if ok { output.stdout } else { output.stderr }).expect("text"))
}

fn good(folder: &TempDir, line: &str) -> String {
    let (ok, text) = run(folder, line);
    assert!(ok, "{line}: {text}");
    text
}

fn bad(folder: &TempDir, line: &str, expected: &str) {
    let (ok, text) = run(folder, line);
    assert!(!ok && text.contains(expected), "{line}: {text}");
}

/// The first two methods of a plan, in their smallest form.
fn small(mut plan: Plan, length: Length, path: &Path) {
    plan.methods.truncate(2);
    (plan.games, plan.trainings) = (2, 1);
    for method in &mut plan.methods {
        method.amount = Amount { episodes: 1, length };
        (method.learner.folds, method.learner.most) = (0, 1);
        match &mut method.teaching {
            rollin::experiment::Teaching::Supervised(supervised) => supervised.rounds = 2,
            rollin::experiment::Teaching::Smile(smile) => smile.rounds = 2,
            other => panic!("{other:?} is not among the first"),
        }
    }
    std::fs::write(path, serde_json::to_vec(&plan).expect("a plan is data")).expect("the folder takes files");
}

/// The data in a page.
fn data(page: &str) -> Value {
    let start = page.find("const data = ").expect("the data") + "const data = ".len();
    let mut read = serde_json::Deserializer::from_str(&page[start..]).into_iter::<Value>();
    read.next().expect("something").expect("JSON")
}

/// The report and the replay of both games, in a browser: something is drawn, and it moves.
fn watch(folder: &tempfile::TempDir) {
    let Some(browser) = Browser::start() else {
        eprintln!("skipped: chromedriver and chromium are not installed");
        return;
    };
    for game in ["platformer", "kart"] {
        let page = |name: &str| format!("file://{}", folder.path().join(format!("{name}{game}.html")).display());
        browser.visit(&page("report-"));
        browser.looks("return document.querySelectorAll('figure svg .mark').length > 0");
        assert_eq!(browser.console(), serde_json::json!([]), "{game}");
        browser.visit(&page(""));
        let colours = "const canvas = document.querySelector('canvas');
            const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
            return new Set(new Uint32Array(pixels.buffer)).size > 2";
        browser.looks("return document.querySelector('canvas').clientWidth > 300");
        browser.holds(colours);
        browser
            .holds("const seek = document.getElementById('seek'); return seek.value === '0' && Number(seek.max) > 5");
        browser.run("document.getElementById('play').click()");
        browser.until("return document.getElementById('seek').value !== '0'");
        browser.holds("document.getElementById('seek').value = 3; document.getElementById('seek').oninput({target: document.getElementById('seek')});
            return document.querySelectorAll('tr').length === 4");
        assert_eq!(browser.console(), serde_json::json!([]), "{game}");
    }
}

#[test]
fn from_a_plan_to_a_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    small(Platforming::plan(Scale::Quick, 1).expect("a plan"), Length::Marathon(20), &path("platformer.json"));
    small(Racing::plan(Scale::Quick, 1).expect("a plan"), Length::Short(60), &path("kart.json"));
    for (game, most) in [("platformer", 750), ("kart", 3000)] {
        let line = format!("experiment {game} --plan {game}.json --resume kept-{game} --models models-{game}");
        let (first, json) = (good(&folder, &line), good(&folder, &format!("{line} --json")));
        good(&folder, &format!("{line} --html report-{game}.html"));
        assert!(first.contains("supervised") && first.contains("the bill") && first.contains("claim"), "{first}");
        assert_eq!(first, good(&folder, &line), "a second time from what was kept");
        let found: Value = serde_json::from_str(&json).expect("JSON");
        assert_eq!(found["findings"]["points"].as_array().map(Vec::len), Some(4));
        assert!(found["claims"].as_array().is_some_and(|claims| !claims.is_empty()));

        let models = format!("--model models-{game}/smile-0.1.model --against models-{game}/supervised.model");
        let told = good(&folder, &format!("drive --task {game} {models} --html {game}.html"));
        assert!(told.contains("decisions differ"), "{told}");
        let page = std::fs::read_to_string(path(&format!("{game}.html"))).expect("the page");
        assert!(!page.contains("http"), "the page needs nothing else");
        let data = data(&page);
        let rides = data["rides"].as_array().expect("rides");
        assert_eq!((data["task"].as_str(), rides.len()), (Some(game), 2));
        for ride in rides {
            let count = |what: &str| ride[what].as_array().map_or(0, Vec::len);
            assert!(count("choices") > 0 && count("choices") <= most && count("starts") == count("choices"), "{game}");
            assert!(count("film") > count("starts") && !ride["scene"].is_null());
        }
    }
    watch(&folder);
    bad(&folder, "drive --task kart --model models-platformer/smile-0.1.model --html x.html", "a kart model is needed");
    bad(&folder, "drive --task kart --model kart.json --html x.html", "not a rollin model");
    bad(&folder, "tag --model models-kart/smile-0.1.model", "a model for kart");
    bad(&folder, "experiment kart --plan platformer.json", "game is platformer");
    bad(&folder, "experiment kart --plan kart.html", "kart.html");
    bad(&folder, "experiment kart --scale 2", "above 0 and at most 1");
    bad(&folder, "experiment kart --levels x", "left out");
    bad(&folder, "experiment platformer --methods nobody", "supervised, smile-0.1");
    bad(&folder, "experiment platformer --resume kept-platformer --quick", "another experiment");
    assert!(!path("x.html").exists());
    assert!(balance::plan(&["smile"]).validate().is_ok());
}

/// Asserts that all claims of an experiment that begin like one of `those` came out, and that there is one that begins like each.
fn came_out(found: &Value, those: &[&str]) {
    let claims = found["claims"].as_array().expect("claims");
    for claim in those {
        let made: Vec<&Value> =
            claims.iter().filter(|made| made["text"].as_str().is_some_and(|text| text.starts_with(claim))).collect();
        assert!(!made.is_empty() && made.iter().all(|made| made["holds"] == true), "{claim}: {made:?}");
    }
}

/// What comes out on the platform game at either size.
const ANY_SIZE: [&str; 6] = [
    "DAgger's mean distance is better than SMILe's",
    "with nets that start from the one before, SMILe's mean distance is better than supervised imitation's",
    "supervised imitation does better on the three easiest difficulties",
    "with reuse by Algorithm 4.3 SMILe is not behind SMILe without",
    "with reuse by ageing SMILe is not behind SMILe without",
    "it is better than SMILe without for as many labels",
];

/// What a user runs first, whole, by the program that was built for users: `.ci/run` runs both in some minutes and names the folder with their JSON in ROLLIN_QUICK. The
/// seed is fixed, so that what came out once comes out again; the claims asserted are those that do at this size.
#[test]
fn quick_experiments_run_through() {
    let Some(folder) = std::env::var_os("ROLLIN_QUICK") else {
        eprintln!("skipped: ROLLIN_QUICK is not set");
        return;
    };
    for (game, claims) in [("platformer", &ANY_SIZE[..]), ("kart", &["DAgger's falls a lap is better than SMILe's"])] {
        let path = std::path::Path::new(&folder).join(format!("{game}.json"));
        let text = std::fs::read_to_string(&path).expect("the experiment was run");
        let found: Value = serde_json::from_str(&text).expect("JSON");
        let methods = found["findings"]["plan"]["methods"].as_array().expect("methods").len();
        assert!(found["findings"]["points"].as_array().is_some_and(|points| points.len() > 8 * methods), "{game}");
        came_out(&found, claims);
    }
}

/// Figure 4 of Ross & Bagnell (2010) with a tenth of its examples, which takes half an hour: `cargo test --release --test experiment -- --ignored figure_4`.
#[test]
#[ignore = "takes half an hour"]
fn figure_4_comes_out() {
    let folder = TempDir::new().expect("a folder");
    let methods = "supervised,smile-0.1,smile-warm,smile-4.3,smile-ageing,dagger";
    let found = good(&folder, &format!("experiment platformer --json -q --methods {methods}"));
    let found = serde_json::from_str(&found).expect("JSON");
    came_out(&found, &ANY_SIZE);
    came_out(
        &found,
        &["SMILe's mean distance is better than supervised imitation's", "the same on the harder half of the levels"],
    );
}
