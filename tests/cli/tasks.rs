//! Graphs, maps and tabular problems through all commands.

use super::Folder;
use serde_json::json;

/// Stars whose middle says what all are; a leaf sees nothing but the middle. The middle stands last.
pub fn stars(count: usize) -> String {
    let star = |i: usize| {
        let label = ["left", "right", "up"][i % 3];
        let leaves = 2 + i % 4;
        let nodes: String = (0..leaves).map(|leaf| format!("n{leaf} {label} leaf\n")).collect();
        let edges: String = (0..leaves).map(|leaf| format!("m -- n{leaf}\n")).collect();
        format!("{nodes}m {label} middle says-{label}\n{edges}\n")
    };
    (0..count).map(star).collect()
}

#[test]
fn from_graphs_to_a_labeller() {
    let folder = Folder::new();
    folder.put("t", stars(30));
    folder.put("n", stars(6));
    for visit in ["file", "bfs", "degree"] {
        let report = folder.run(&format!("train --task graph --data t --model m -q --visit {visit}"));
        assert!(
            report.starts_with(&format!("30 graphs, 133 nodes, 3 labels, visit {visit}, edges undirected\n")),
            "{report}"
        );
        let score = folder.run("evaluate --model m --data n");
        assert_eq!(score, "labelled 25 nodes in 6 graphs\nnodes: 100.00%\nwhole graphs: 100.00%\n");
        // Lines of nodes come back with their labels, whether these were known or not; all others as they were.
        let asked = stars(6).replace(" left ", " _ ").replace(" right ", " _ ").replace(" up ", " _ ");
        let answer = folder.run_on("tag --model m", asked.clone());
        for ((line, known), asked) in answer.lines().zip(stars(6).lines()).zip(asked.lines()) {
            match known.split(' ').nth(1).filter(|cell| *cell != "--") {
                Some(label) => assert_eq!(line, format!("{asked} {label}")),
                None => assert_eq!(line, asked),
            }
        }
        assert_eq!(answer.lines().count(), asked.lines().count());
    }
    let told = folder.json("inspect m --json");
    assert_eq!(
        (&told["labels"], &told["visit"], &told["edges"]),
        (&json!(["left", "right", "up"]), &"degree".into(), &"undirected".into())
    );
    let table = folder.run("compare --task graph --data t --test n --algorithms supervised,searn,early-update -q");
    assert!(table.contains("wrong/graph  graphs %  nodes %"), "{table}");
}

/// A leaf whose label differs from what everything shows is missed, and counted; so is a label that was never seen.
#[test]
fn wrong_nodes_are_counted() {
    let folder = Folder::new();
    folder.put("t", stars(30));
    folder.put("n", "m left middle says-left\na right leaf\nb left leaf\nm -- a\nm -- b\n\nm down middle says-up\n\nm up middle says-up new\n");
    folder.run("train --task graph --data t --model m -q --calibrate");
    let score = folder.json("evaluate --model m --data n --json");
    assert_eq!((&score["nodes"], &score["right_nodes"], &score["right_graphs"]), (&5.into(), &3.into(), &1.into()));
    let answer = folder.run_on("tag --model m --confidence", "m _ says-up\na _ leaf\nm -- a\n");
    let cells: Vec<Vec<&str>> = answer.lines().map(|line| line.split(' ').collect()).collect();
    assert_eq!((cells[0][3], cells[1][3], &cells[2]), ("up", "up", &vec!["m", "--", "a"]));
    assert!(
        (0..2).all(|node| cells[node][4].parse::<f64>().is_ok_and(|sure| sure > 1.0 / 3.0 && sure <= 1.0)),
        "{answer}"
    );
}

/// From the left to the right of maps with a wall of terrain b, which a detour of terrain a goes around at one end.
pub fn maps(first: usize, count: usize) -> String {
    let map = |i: usize| {
        let gap = i % 5;
        let rows: String = (0..5).map(|row| if row == gap { "aaaaa\n" } else { "aabaa\n" }).collect();
        format!("{rows}1,{} -> 5,{}\n5,{} -> 1,{}\n\n", 1 + i % 4, 1 + i % 3, 1 + i % 5, 1 + i % 2)
    };
    (first..first + count).map(map).collect()
}

#[test]
fn from_maps_to_a_traveller() {
    let folder = Folder::new();
    folder.put("t", maps(0, 60));
    let report = folder.run("train --task navigation --data t --model m -q --costs 1,9 --rounds 20");
    assert!(report.starts_with("120 trips, 1,500 cells, 2 costs\n"), "{report}");
    let score = folder.json("evaluate --model m --data t --json");
    assert_eq!((&score["trips"], &score["arrived"]), (&120.into(), &120.into()));
    assert_eq!((&score["cheapest"], &score["path_cost_ratio"]), (&120.into(), &1.0.into()));
    // Two steps over the wall cost 9 + 1, or 1 each where the gap is; every path is walked again here.
    let one = "aaa\naba\naaa\n1,2 -> 3,2\n\n";
    folder.put("one", one);
    let score = folder.json("evaluate --model m --data one --json");
    let answer = folder.run_on("tag --model m", [one, one].concat());
    let lines: Vec<&str> = answer.lines().collect();
    let path = lines[3].strip_prefix("1,2 -> 3,2 ").expect("a path");
    let (mut at, mut cost) = ((0i32, 1i32), 0);
    for step in path.chars() {
        let (right, down) = match step {
            'u' => (0, -1),
            'r' => (1, 0),
            'd' => (0, 1),
            'l' => (-1, 0),
            _ => panic!("{path}"),
        };
        at = (at.0 + right, at.1 + down);
        cost += if at == (1, 1) { 9 } else { 1 };
    }
    assert_eq!((at, f64::from(cost)), ((2, 1), score["cost"].as_f64().expect("a cost")), "{path}");
    assert_eq!(score["least"], 4.0);
    assert_eq!((lines[..3].join("\n"), lines[8]), ("aaa\naba\naaa".to_owned(), lines[3]));
    let table = folder.run("compare --task navigation --data t --costs 1,9 --algorithms supervised,smile -q");
    assert!(table.contains("cost/trip  cheapest %  path cost %"), "{table}");
    assert!(folder.run("inspect m").contains("\ncosts           1,9\n"));
}

/// States 0 and 1 in turn while action 0 is taken; action 1 leads to state 2, which costs 1 a step for ever. The expert takes action 0, and
/// pays for one step in two.
pub const INSTANCE: &str = r#"{"S": 3, "A": 2, "T": 4, "mu": [0.5, 0.5, 0],
"P": [[[0, 1, 0], [0, 0, 1]], [[1, 0, 0], [0, 0, 1]], [[0, 0, 1], [0, 0, 1]]],
"C": [[0.5, 0], [0, 0], [1, 1]], "expert": [0, 0, 0]}"#;

#[test]
fn from_an_instance_to_a_walker() {
    let folder = Folder::new();
    folder.put("i", INSTANCE);
    for algorithm in ["dagger-online", "smile", "forward"] {
        let report =
            folder.run(&format!("train --task tabular --data i --model m -q --algorithm {algorithm} --first 50"));
        assert!(report.starts_with("50 episodes, 200 steps, views 3, actions 2\n"), "{report}");
        let score = folder.json("evaluate --model m --data i --json");
        assert_eq!((&score["expected_cost"], &score["expert_cost"]), (&1.0.into(), &1.0.into()));
        assert_eq!((&score["episodes"], &score["agreed"]), (&1000.into(), &4000.into()));
        let answer = folder.run_on("tag --model m", INSTANCE);
        assert!(answer.lines().all(|line| line == "0:0 1:0 0:0 1:0" || line == "1:0 0:0 1:0 0:0"), "{answer}");
        assert_eq!(answer.lines().count(), 1000);
    }
    // What looks ahead is no table: then there is what happened.
    folder.run("train --task tabular --data i --model m -q --algorithm early-update");
    let score = folder.json("evaluate --model m --data i --json");
    assert_eq!((&score["expected_cost"], &score["sampled_cost"]), (&json!(null), &1.0.into()));
    assert!(folder.run("evaluate --model m --data i").contains("\nexpected cost: not known\n"));
    let table = folder.run("compare --task tabular --data i --algorithms supervised,searn -q");
    assert!(table.contains("cost/episode  as expert %  expert's cost %"), "{table}");
}

/// Where states 0 and 1 look alike and the expert differs, the exact cost of what was learned is that of one of two tables.
#[test]
fn exact_costs_are_those_of_tables() {
    let folder = Folder::new();
    folder.put(
        "i",
        r#"{"S": 2, "A": 2, "T": 3, "mu": [0.75, 0.25], "P": [[[1, 0], [1, 0]], [[0, 1], [0, 1]]], "C": [[0, 1], [1, 0]],
           "expert": [0, 1], "phi": [0, 0]}"#,
    );
    folder.run("train --task tabular --data i --model m -q");
    let score = folder.json("evaluate --model m --data i --json");
    // Action 0 in both states: a quarter of the episodes starts in state 1 and pays 1 for three steps.
    assert_eq!((&score["expected_cost"], &score["expert_cost"]), (&0.75.into(), &0.0.into()));
    let sampled = score["sampled_cost"].as_f64().expect("a number");
    // 1,000 episodes, drawn once for all: 3 times a binomial share of deviation 0.0137.
    assert!((sampled - 0.75).abs() < 0.2, "{sampled}");
}

#[test]
fn refusals() {
    let folder = Folder::new();
    folder.put("g", stars(5));
    folder.put("u", stars(5).replacen("n0 left leaf", "n0  _ leaf", 1));
    folder.put("arrows", stars(5).replace("--", "->"));
    folder.put("loop", "a X\na -- a\n");
    folder.put("maps", maps(0, 5));
    folder.put("empty", "aa\naa\n");
    folder.put("sea", "aac\naaa\n1,1 -> 2,2\n");
    folder.put("i", INSTANCE);
    folder.put("wide", INSTANCE.replace("}", ", \"phi\": [0, 1, 7]}"));
    folder.put("bad", INSTANCE.replace("[0.5, 0.5, 0]", "[0.5, 0.6, 0]"));
    folder.run("train --task graph --data g --model graph.m -q");
    folder.run("train --task navigation --data maps --model maps.m -q --costs 1,2");
    folder.run("train --task tabular --data i --model i.m -q");
    for (line, expected) in [
        (
            "train --task graph --data u --model x",
            "u:1:5: no label; expected graphs to learn from: a label for every node",
        ),
        ("evaluate --model graph.m --data u", "u:1:5: no label; expected graphs to measure on"),
        (
            "evaluate --model graph.m --data arrows",
            "arrows: edges with direction; the model was trained on edges without",
        ),
        ("train --task graph --data loop --model x", "loop:2:6: an edge back to its own node; expected another node"),
        ("train --task graph --data g --model x --visit random", "invalid value 'random' for '--visit <ORDER>'"),
        ("train --data g --model x --visit bfs", "--visit is given, but must be left out: tagging has no such setting"),
        ("train --task graph --data g --model x --order free", "--order is given, but must be left out: graph has no"),
        ("train --task graph --data empty --model x --calibrate", "empty:"),
        ("train --task navigation --data empty --model x", "empty: no trip; give maps with lines such as `1,1 -> 5,3`"),
        (
            "train --task navigation --data sea --model x --costs 1,2",
            "sea:1:3: terrain without a cost; expected terrain from a to b",
        ),
        ("evaluate --model maps.m --data sea", "sea:1:3: terrain without a cost"),
        ("train --task navigation --data maps --model x --costs 1,-2", "costs is -2, but must be from 0 to 1e12 each"),
        ("train --task navigation --data maps --model x --calibrate", "--calibrate is given, but must be left out"),
        ("train --task tabular --data bad --model x", "bad: mu: sums to 1.1; expected 1"),
        ("train --task tabular --data g --model x", "g:1:2: expected ident; expected one JSON object with S, A, T"),
        (
            "evaluate --model i.m --data wide",
            "wide: 8 views of states and 2 actions; the model knows 3 views and 2 actions",
        ),
        (
            "evaluate --model i.m --data i --label-column 1",
            "--label-column is given, but must be left out: tabular has no",
        ),
        ("compare --task graph", "--data is left out, but must be given: there is no corpus for graph in the program"),
    ] {
        let message = folder.refused(line);
        assert!(message.contains(expected), "{line}: {message}");
    }
    let message = folder.refused_on("tag --model graph.m", "a X\n\nb\n");
    assert!(message.contains("<stdin>:3:2: the line ends; expected a node's name"), "{message}");
    let message = folder.refused_on("tag --model maps.m", "aa\n1,1 -> 3,1\n");
    assert!(message.contains("<stdin>:2:8: 3,1 is not on the map"), "{message}");
}

/// A net is trained, kept, told of, and used like any other classifier.
#[test]
fn nets_from_the_command_line() {
    let folder = Folder::new();
    folder.put("t", stars(30));
    for algorithm in ["dagger-online", "smile", "forward", "stacked"] {
        folder.run(&format!(
            "train --task graph --data t --model m -q --learner net --units 8 --rate 0.05 --algorithm {algorithm}"
        ));
        let score = folder.json("evaluate --model m --data t --json");
        assert!(score["right_nodes"].as_u64().expect("a count") > 120, "{algorithm}: {score}");
        let told = folder.json("inspect m --json");
        assert!(told["about"]["learner"].as_str().expect("text").starts_with("{\"net\":{\"units\":8"), "{told}");
    }
    for (line, expected) in [
        ("--learner net --units 65537", "--units is 65537, but must be at most 65536"),
        ("--learner net --l2 0.1", "--l2 is given, but must be left out: net has no such setting"),
        ("--learner net --cost 1", "--cost is given"),
        ("--units 3", "--units is given, but must be left out: logistic has no such setting"),
        ("--learner net --passes 2", "--passes is given, but must be left out: dagger-online makes one pass a round"),
    ] {
        let message = folder.refused(&format!("train --task graph --data t --model x {line}"));
        assert!(message.contains(expected), "{line}: {message}");
    }
}

/// Flawed experts are told of, and tell in what is learned.
#[test]
fn experts_from_the_command_line() {
    let folder = Folder::new();
    folder.put("t", maps(0, 30));
    let train = "train --task navigation --data t --model m -q --costs 1,9";
    for expert in ["noisy:0.2", "suboptimal:0.2", "silent:0.5"] {
        let report = folder.json(&format!("{train} --json --expert {expert}"));
        assert_eq!(report["about"]["expert"], expert);
        assert!(folder.run("inspect m").contains(&format!("\nexpert          {expert}\n")));
    }
    folder.run(&format!("{train} --expert none"));
    assert!(!folder.run("inspect m").contains("\nexpert   "));
    // Half of the answers are missing, in episodes that are as long as before.
    folder.put("g", stars(30));
    let labels = |expert: &str| {
        let line = format!("train --task graph --data g --model m -q --json --algorithm dagger --expert {expert}");
        folder.json(&line)["about"]["ledger"]["labels"].as_f64().expect("a count")
    };
    let (all, half) = (labels("none"), labels("silent:0.5"));
    assert!(half > 0.3 * all && half < 0.7 * all, "{half} of {all}");
    let table = folder.json("compare --task navigation --data t --costs 1,9 -q --expert noisy:0.1 --json");
    assert_eq!(table["expert"], "noisy:0.1");
    for (line, expected) in [
        ("--expert drunk:0.1", "expert is drunk:0.1, but must be none, noisy:P, suboptimal:P or silent:P"),
        ("--expert noisy:2", "expert is 2, but must be from 0 to 1"),
        (
            "--expert noisy:0.1 --algorithm aggrevate",
            "--expert is given, but must be left out: aggrevate asks what actions cost",
        ),
    ] {
        let message = folder.refused(&format!("{train} {line}"));
        assert!(message.contains(expected), "{line}: {message}");
    }
    folder.put("g", stars(5));
    let message = folder.refused("train --task graph --data g --model x -q --expert suboptimal:0.1");
    assert!(message.contains("the states of this task have no signatures"), "{message}");
}
