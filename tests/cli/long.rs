//! Runs that are killed, interrupted, out of room or out of time.

use super::{Folder, shipped};
use rollin::{Purpose, Seed};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// A training of some rounds, each of them kept.
const LINE: &str =
    "train --data data --model MODEL --algorithm lols-online --learner csoaa --reference 0.5 --rounds 12 --seed 5";

fn folder(sentences: usize) -> Folder {
    let folder = Folder::new();
    let grammar = shipped("grammars/dialects.grammar");
    folder.put("data", folder.run(&format!("generate --grammar {grammar} --count {sentences}")));
    folder
}

fn line(model: &str, more: &str) -> String {
    format!("{} {more}", LINE.replace("MODEL", model))
}

/// The same with so many rounds.
fn rounds(count: u64, model: &str, more: &str) -> String {
    line(model, more).replace("--rounds 12", &format!("--rounds {count}"))
}

impl Folder {
    /// The program, running.
    fn start(&self, line: &str) -> Child {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rollin"));
        command.current_dir(self.path(".")).args(line.split_whitespace());
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
    }

    /// Waits until the file has so many lines.
    fn wait(&self, name: &str, lines: usize) {
        while std::fs::read_to_string(self.path(name)).unwrap_or_default().lines().count() < lines {
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// The rounds in a log.
    fn logged(&self, name: &str) -> Vec<u64> {
        let text = String::from_utf8(self.get(name)).expect("text");
        let lines = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("a line of JSON"));
        lines.filter_map(|line| line["round"].as_u64()).collect()
    }
}

/// Kills a training of `count` rounds `kills` times, each time after a random time of which all together are about what all of it takes, and lets it
/// end; the model must be that of training that was left alone.
fn killed(count: u64, kills: u64) {
    let folder = folder(60);
    let start = Instant::now();
    folder.run(&rounds(count, "whole", ""));
    let each = start.elapsed().mul_f64(2.0 / kills as f64);
    let line = rounds(count, "pieces", "--checkpoint kept --resume --log log");
    let mut during = 0;
    for kill in 0..kills {
        let mut child = folder.start(&line);
        std::thread::sleep(each.mul_f64(Seed::new(9).child(Purpose::Step, kill).unit()));
        during += usize::from(child.try_wait().expect("a process").is_none());
        child.kill().expect("it may be killed");
        child.wait().expect("it ends");
    }
    let known = folder.logged_so_far("log");
    folder.told(&line, "");
    println!("{kills} kills, {during} of them in the middle, the last after round {known} of {count}");
    assert!(folder.get("whole") == folder.get("pieces"));
    assert_eq!(folder.logged("log"), (1..=count).collect::<Vec<u64>>());
    assert_eq!(std::fs::read_dir(folder.path("kept")).expect("a folder").count(), 2, "nothing is left over");
}

impl Folder {
    /// The last round in a log whose last line may be half written.
    fn logged_so_far(&self, name: &str) -> usize {
        let text = std::fs::read_to_string(self.path(name)).unwrap_or_default();
        text.lines().filter(|line| line.starts_with("{\"round\"")).count()
    }
}

#[test]
fn killed_a_few_times() {
    killed(12, 4);
}

/// `cargo test --test cli killed_fifty_times -- --ignored --nocapture`
#[test]
#[ignore = "takes minutes"]
fn killed_fifty_times() {
    killed(2000, 50);
}

/// Waits for a child: its exit status, standard output and standard error.
fn end(child: Child) -> (ExitStatus, String, String) {
    let output = child.wait_with_output().expect("it ends");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (output.status, text(output.stdout), text(output.stderr))
}

#[test]
#[cfg(unix)]
fn an_interrupt_ends_the_round() {
    let folder = folder(40);
    let long = |model: &str, more: &str| rounds(150, model, more);
    folder.run(&long("whole", ""));
    for signal in ["INT", "TERM"] {
        let child = folder.start(&long(signal, &format!("--checkpoint kept-{signal} --log log-{signal}")));
        folder.wait(&format!("log-{signal}"), 3);
        let kill = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
        assert!(kill.expect("there is such a program").success());
        let (status, out, errors) = end(child);
        let round = *folder.logged(&format!("log-{signal}")).last().expect("two rounds");
        assert_eq!(status.code(), Some(130), "{errors}");
        assert!(
            round < 150 && out.contains(&format!("stopped after round {round}: go on with --resume\nwrote {signal}\n")),
            "{out}"
        );
        assert_eq!(errors, "note: interrupted: the model is written after this round; once more to stop at once\n");
        let told = folder.run(&format!("inspect {signal}"));
        assert!(told.contains(&format!("before its end, after round {round}\n")), "{told}");
        folder.run(&long(signal, &format!("--checkpoint kept-{signal} --resume --log log-{signal}")));
        assert!(folder.get(signal) == folder.get("whole"));
        assert_eq!(folder.logged(&format!("log-{signal}")), (1..=150).collect::<Vec<u64>>());
    }
}

#[test]
#[cfg(unix)]
fn the_second_interrupt_ends_the_program() {
    let folder = folder(40);
    let child = folder.start(&rounds(1_000_000_000, "model", "--log log"));
    folder.wait("log", 2);
    let kill = || Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    // Until it is gone: a second signal that comes before the first was taken counts as one.
    kill().expect("there is such a program");
    let _ = kill();
    let (status, ..) = end(child);
    assert_eq!(status.code(), Some(130));
}

#[test]
fn time_limits() {
    let folder = folder(20);
    let out = folder.run(&line("model", "--time-limit 0s --checkpoint kept"));
    assert!(out.ends_with("stopped after round 1: go on with --resume\nwrote model\n"), "{out}");
    assert_eq!(folder.json("inspect model --json")["about"]["stopped"], 1);
    folder.run(&line("model", "--time-limit 24h --checkpoint kept --resume"));
    folder.run(&line("whole", ""));
    assert!(folder.get("model") == folder.get("whole"));
    assert!(folder.json("inspect model --json")["about"].get("stopped").is_none());
}

/// The room for one file is limited, twice.
#[test]
#[cfg(unix)]
fn a_full_disk_loses_nothing() {
    let folder = folder(60);
    let smile = |model: &str, more: &str| {
        format!("train --data data --model {model} --algorithm smile --rounds 6 --learner perceptron --passes 2 {more}")
    };
    folder.run(&smile("whole", "--checkpoint measured"));
    let size = std::fs::metadata(folder.path("measured/training.checkpoint")).expect("a checkpoint").len();
    // One member more a round, so about a sixth of the last size each.
    for (share, resume) in [(2, ""), (4, "--resume")] {
        let (blocks, line) = (share * size / 6 / 512 + 1, smile("pieces", &format!("--checkpoint kept {resume}")));
        // A write beyond the limit is an error, not a signal.
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec {} {line}", env!("CARGO_BIN_EXE_rollin"));
        let output = Command::new("sh").args(["-c", &script]).current_dir(folder.path(".")).output().expect("a shell");
        let errors = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains("cannot be written: File too large"), "{errors}");
        assert!(errors.contains("is whole: make room, then go on with --resume"), "{errors}");
    }
    folder.run(&smile("pieces", "--checkpoint kept --resume"));
    assert!(folder.get("whole") == folder.get("pieces"));
}

#[test]
fn what_does_not_go_together_is_refused() {
    let folder = folder(20);
    let train = |more: &str| line("model", &format!("--checkpoint kept {more}"));
    let [_, note] = folder.told(&train("--resume"), "");
    assert_eq!(note, "note: kept: no checkpoint there: training begins at the beginning\n");
    folder.says(
        &train(""),
        "kept: a checkpoint of a training lies there already; go on from it with --resume, or name another folder",
    );
    let refused = |more: &str, what: &str| {
        let message = folder.refused(&train(&format!("--resume {more}")));
        assert!(
            message.starts_with("error: kept/training.checkpoint: the checkpoint of another training: "),
            "{message}"
        );
        assert!(message.contains(what), "{message}");
    };
    refused("--calibrate", "--calibrate was false and is true; go on as it was begun");
    refused("--first 10", "--first was not given and is 10, ");
    refused("--rate 0.2", "--rate was not given and is 0.2");
    folder.says(&format!("{} --resume --log .", train("")), "cannot write .: Is a directory (os error 21)");
    folder.put("data", [folder.get("data"), b"a D\n\n".to_vec()].concat());
    refused("", "the corpus was SHA-256 ");
    folder.says_on(
        &train("").replace("--data data", "--data -"),
        "a D\n",
        "--data is -, but must be a file for --checkpoint: a resumed run reads it again",
    );
    for log in ["data", "./model", "model"] {
        let message = format!("--log is {log}, but must be another file than --data and --model");
        folder.says(&line("model", &format!("--log {log}")), &message);
    }
    assert!(folder.refused(&line("model", "--resume")).contains("--checkpoint <FOLDER>"));
    assert!(folder.refused(&line("model", "--time-limit 5")).contains("a number and s, m or h"));
}

/// A log is appended to; what a killed run left half written is cut off when the run goes on, and nothing else is.
#[test]
fn logs_have_each_round_once() {
    let folder = folder(20);
    folder.run(&line("model", "--time-limit 0s --checkpoint kept --log log"));
    assert_eq!(folder.logged("log"), [1]);
    folder.put("log", [folder.get("log"), b"{\"round\":2,\"rou".to_vec()].concat());
    folder.run(&line("model", "--checkpoint kept --resume --log log"));
    assert_eq!(folder.logged("log"), (1..=12).collect::<Vec<u64>>());
    folder.run(&line("model", "--time-limit 0s --log log"));
    assert_eq!(folder.logged("log"), (1..=12).chain([1]).collect::<Vec<u64>>());
    folder.put("log", "half");
    let message = folder.refused(&line("model", "--log log"));
    assert!(message.contains("log: its last line is not whole"), "{message}");
}
