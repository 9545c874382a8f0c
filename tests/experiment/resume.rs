//! Going on after a kill, and files.

use crate::balance::{Balance, plan};
use crate::learnt;
use rollin::experiment::{Driver, Findings, Lab, Learnt, NetOf};
use rollin::space::{FeatureTable, Features};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

fn at(folder: &Path, names: &[&str]) -> rollin::Result<Learnt<Balance>> {
    let (plan, folder) = (plan(names), Some(folder.to_owned()));
    Lab { game: &Balance::default(), plan: &plan, folder, watch: &|_| {} }.run()
}

/// All files below a folder, and what is in them.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(files(&path));
        } else {
            all.insert(path.display().to_string(), fs::read(&path).unwrap());
        }
    }
    all
}

/// Whatever is missing when it was killed, what comes out and what is kept in the end are the same, to the byte.
#[test]
fn goes_on_from_wherever_it_was_killed() {
    let names = ["supervised", "smile", "ageing", "printed", "dagger", "searn"];
    let whole = learnt(&plan(&names)).findings;
    let folder = tempfile::tempdir().unwrap();
    let same = |found: Findings, what: &str| assert_eq!(found, whole, "{what}");
    same(at(folder.path(), &names).unwrap().findings, "with files");
    let kept = files(folder.path());
    assert!(kept.len() > names.len() * 8);
    same(at(folder.path(), &names).unwrap().findings, "all there");
    // Of every training all from a round on is lost: its answers or not, its classifiers, its points.
    for (first, answers) in [(0, true), (1, true), (2, false), (3, true)] {
        for path in kept.keys() {
            let name = path.rsplit('/').next().unwrap();
            let (kind, number) = name.split_once('-').unwrap_or((name, "0"));
            let number: usize = number.trim_end_matches(".json").parse().unwrap();
            let lost = match kind {
                "answers" => number >= first && answers,
                "classifier" => number >= first,
                "point" => true,
                _ => false,
            };
            if lost {
                fs::remove_file(path).unwrap();
            }
        }
        same(at(folder.path(), &names).unwrap().findings, "after a kill");
        assert!(files(folder.path()) == kept, "after a kill in round {first}");
    }
}

#[test]
fn refuses_the_folder_of_another_plan_and_damaged_files() {
    let folder = tempfile::tempdir().unwrap();
    at(folder.path(), &["smile"]).unwrap();
    let error = at(folder.path(), &["dagger"]).err().expect("another plan").to_string();
    assert!(error.contains("plan.json") && error.contains("another experiment"), "{error}");
    let classifier = folder.path().join("smile-0/classifier-2");
    let bytes = fs::read(&classifier).unwrap();
    fs::write(&classifier, &bytes[..bytes.len() - 1]).unwrap();
    let error = at(folder.path(), &["smile"]).err().expect("damaged").to_string();
    assert!(error.contains("classifier-2") && error.contains("damaged"), "{error}");
}

#[test]
fn model_files_come_back_and_others_are_refused() {
    let learnt = learnt(&plan(&["smile", "forward"]));
    let table = FeatureTable::new(21);
    let path = Path::new("some.model");
    for (name, driver) in &learnt.drivers {
        let bytes = driver.to_bytes::<Features>("balance", name);
        let (back, about) =
            Driver::<NetOf<Balance>>::from_bytes::<Features>(&bytes, path, ("balance", &table, 4)).unwrap();
        assert_eq!((&about, back.to_bytes::<Features>("balance", &about)), (name, bytes.clone()));
        let refused = |bytes: &[u8], task, actions| {
            let read = Driver::<NetOf<Balance>>::from_bytes::<Features>(bytes, path, (task, &table, actions));
            read.expect_err("it is refused").to_string()
        };
        assert!(refused(&bytes, "kart", 4).contains("a model for balance; a kart model is needed"));
        assert!(refused(&bytes, "balance", 5).contains("another game"));
        for end in [0, 10, bytes.len() / 2, bytes.len() - 1] {
            assert!(refused(&bytes[..end], "balance", 4).contains("some.model"));
        }
    }
}
