//! What the help says can be typed, and what shells and manuals are told.

use super::ocr::words;
use super::tasks::{INSTANCE, maps, stars};
use super::{CHUNKS, Folder, shipped};
use flate2::{Compression, write::GzEncoder};
use rollin::experiment::{Amount, Length, Plan, Platforming, Racing, Scale, Teaching};
use std::io::Write;
use std::process::Command;

/// All commands, as their names are typed.
const COMMANDS: [&str; 18] = [
    "",
    "train",
    "tag",
    "evaluate",
    "compare",
    "convert",
    "generate",
    "inspect",
    "theory",
    "theory audit",
    "theory bounds",
    "theory plan",
    "experiment",
    "drive",
    "completions",
    "man",
    "serve",
    "update",
];

/// The examples in a help: lines set in by two, in which the program is run.
fn examples(help: &str) -> Vec<&str> {
    let lines = help.lines().filter_map(|line| line.strip_prefix("  ")).filter(|line| !line.starts_with(' '));
    lines.filter(|line| line.starts_with("rollin ") || line.contains("| rollin ")).collect()
}

/// The first two methods of a plan, in their smallest form: what `--quick` stands for here, which takes minutes.
fn tiny(mut plan: Plan, length: Length) -> Vec<u8> {
    plan.methods.truncate(2);
    (plan.games, plan.trainings) = (2, 1);
    for method in &mut plan.methods {
        method.amount = Amount { episodes: 1, length };
        (method.learner.folds, method.learner.most) = (0, 1);
        match &mut method.teaching {
            Teaching::Supervised(supervised) => supervised.rounds = 1,
            Teaching::Smile(smile) => smile.rounds = 1,
            other => panic!("{other:?} is not among the first"),
        }
    }
    serde_json::to_vec(&plan).expect("a plan is data")
}

/// Everything that examples read, under the names that they give it.
fn furnished() -> Folder {
    let folder = Folder::new();
    let chunks = format!("{CHUNKS}\n").repeat(12);
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(chunks.as_bytes()).expect("memory");
    folder.put("train.txt.gz", packer.finish().expect("memory"));
    let new = "the D\nold A\nboats N\n\na D\nman N\nsleeps V\n";
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(new.as_bytes()).expect("memory");
    folder.put("new.txt.gz", packer.finish().expect("memory"));
    folder.put("train.txt", chunks);
    folder.put("test.txt", CHUNKS);
    folder.put("new.txt", new);
    let tree = "1\told\t_\tADJ\t_\t_\t2\tamod\t_\t_\n2\tboats\t_\tNOUN\t_\t_\t3\tnsubj\t_\t_\n3\tsink\t_\tVERB\t_\t_\t0\troot\t_\t_\n\n";
    folder.put("train.conllu", tree.repeat(12));
    folder.put("new.conllu", tree);
    folder.put("letters.tsv", words(0, 20));
    folder.put("graphs.txt", stars(9));
    folder.put("maps.txt", maps(0, 9));
    folder.put("problem.json", INSTANCE);
    std::fs::create_dir(folder.path("grammars")).expect("a folder");
    for (from, to) in [("dialects.grammar", "grammars/dialects.grammar"), ("words.template", "words.template")] {
        folder.put(to, std::fs::read(shipped(&format!("grammars/{from}"))).expect("shipped"));
    }
    folder.put("kart.plan", tiny(Racing::plan(Scale::Quick, 1).expect("a plan"), Length::Short(60)));
    folder.put("platformer.plan", tiny(Platforming::plan(Scale::Quick, 1).expect("a plan"), Length::Marathon(20)));
    folder
}

/// Runs a line as a shell does.
#[cfg(unix)]
fn typed(folder: &Folder, line: &str) {
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_rollin"));
    let others = std::env::var_os("PATH").unwrap_or_default();
    let folders = program.parent().map(|own| own.to_path_buf()).into_iter().chain(std::env::split_paths(&others));
    let path = std::env::join_paths(folders).expect("a path");
    let output = Command::new("sh")
        .arg("-ec")
        .arg(line)
        .current_dir(folder.path(""))
        .env("PATH", path)
        .output()
        .expect("a shell");
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
}

/// The examples of all helps, in their order, each once: what one of them makes, others read.
#[cfg(unix)]
#[test]
fn examples_can_be_typed() {
    let folder = furnished();
    let mut done: Vec<String> = Vec::new();
    for command in COMMANDS {
        let (short, long) = (folder.run(&format!("{command} -h")), folder.run(&format!("{command} --help")));
        assert!(!examples(&short).is_empty(), "{command}: no example");
        for shown in examples(&short).into_iter().chain(examples(&long)) {
            if !done.iter().any(|before| before == shown) {
                let game = shown.split(' ').nth(2).unwrap_or_default();
                let line = shown.replace("--quick", &format!("--plan {game}.plan"));
                // A server goes on until it is asked to end; the port of the example may be taken.
                let served = "timeout --preserve-status -s TERM 1 rollin serve --listen 127.0.0.1:0";
                typed(&folder, &line.replace("rollin serve", served));
                done.push(shown.to_owned());
            }
        }
    }
    assert!(done.len() > 50, "{}", done.len());
}

/// Each algorithm has its recipe.
#[test]
fn every_algorithm_has_a_recipe() {
    let folder = Folder::new();
    let help = folder.run("train --help");
    let lines = examples(&help);
    for algorithm in super::good::ALGORITHMS {
        let typed = format!("--algorithm {algorithm}");
        assert!(lines.iter().any(|line| line.ends_with(&typed) || line.contains(&format!("{typed} "))), "{algorithm}");
    }
    let headings = [
        "DAgger:",
        "Supervised:",
        "Forward:",
        "SMILe:",
        "SEARN:",
        "CPI:",
        "AggreVaTe:",
        "LOLS:",
        "Stacked:",
        "Early update:",
    ];
    for heading in headings {
        assert!(help.lines().any(|line| line.starts_with(heading)), "{heading}");
    }
}

/// The long options that a help lists.
fn options(help: &str) -> Vec<String> {
    let words = help.lines().filter(|line| line.trim_start().starts_with('-')).flat_map(str::split_whitespace);
    let long = words.filter_map(|word| word.trim_end_matches(',').strip_prefix("--"));
    long.filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

#[test]
fn pages_tell_every_option() {
    let folder = Folder::new();
    let written = folder.run("man pages/man1");
    for command in COMMANDS {
        let name = std::iter::once("rollin").chain(command.split_whitespace()).collect::<Vec<_>>().join("-");
        let path = format!("pages/man1/{name}.1");
        assert!(written.contains(&format!("wrote {path}\n")), "{path}");
        let page = String::from_utf8(folder.get(&path)).expect("text").replace("\\-", "-").replace("\\*(Aq", "'");
        let help = folder.run(&format!("{command} --help"));
        let options = options(&help);
        assert!(options.len() >= 5, "{command}: {options:?}");
        for option in options {
            assert!(page.contains(&format!("--{option}")), "{command}: {option}");
        }
        for example in examples(&help) {
            assert!(page.lines().any(|line| line.trim_start() == example), "{command}: {example}");
        }
    }
    assert_eq!(written.lines().count(), COMMANDS.len());
    assert_eq!(folder.run("man").into_bytes(), folder.get("pages/man1/rollin.1"));
    // Where there is one, the formatter has nothing against them.
    let all: Vec<_> = written.lines().filter_map(|line| line.strip_prefix("wrote ")).collect();
    for page in all {
        let Ok(output) =
            Command::new("groff").args(["-man", "-Tutf8", "-ww", "-z", page]).current_dir(folder.path("")).output()
        else {
            println!("skipped: no groff");
            return;
        };
        assert!(
            output.status.success() && output.stderr.is_empty(),
            "{page}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}

#[test]
fn shells_are_told_every_command() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = folder.run(&format!("completions {shell}"));
        for word in ["train", "completions", "bounds", "calibrate", "dagger-online", "crammer-singer"] {
            // Shells that are told no values of options still know the commands.
            let known = script.contains(word) || matches!(shell, "powershell" | "elvish") && word.contains('-');
            assert!(known, "{shell}: {word}");
        }
        folder.put(shell, script);
    }
    for shell in ["bash", "zsh", "fish"] {
        match Command::new(shell).args(["-n", shell]).current_dir(folder.path("")).output() {
            Ok(output) => assert!(output.status.success(), "{shell}: {}", String::from_utf8_lossy(&output.stderr)),
            Err(_) => println!("skipped: no {shell}"),
        }
    }
    let message = folder.refused("completions bush");
    assert!(message.contains("a similar value exists: 'bash'"), "{message}");
}

/// Every option with values of its own says which one was perhaps meant.
#[test]
fn misspelt_words_are_recognised() {
    let folder = Folder::new();
    for (line, meant) in [
        ("trian", "'train'"),
        ("train --modle m", "'--model'"),
        ("train --task taging", "'tagging'"),
        ("train --algorithm dager", "'dagger'"),
        ("train --learner logistc", "'logistic'"),
        ("train --reading votes", "'vote'"),
        ("train --order billou", "'bilou'"),
        ("train --visit degre", "'degree'"),
        ("train --system arc-hybird", "'arc-hybrid'"),
        ("train --reuse ageeing", "'ageing'"),
        ("convert --from conl", "'conll'"),
        ("experiment cart", "'kart'"),
        ("drive --task platfomer", "'platformer'"),
    ] {
        let message = folder.refused(line);
        assert!(message.contains("similar") && message.contains(meant), "{line}: {message}");
    }
    let message = folder.refused("experiment kart --quick --methods supervized");
    assert!(message.ends_with("; did you mean supervised?\n"), "{message}");
}

/// A pipe gets no colours unless it is forced to, and a terminal's wish for none is heard.
#[test]
fn colours_are_for_terminals() {
    let folder = Folder::new();
    folder.put("c.txt", CHUNKS);
    folder.run("train --data c.txt --model m -q");
    for (line, ok) in
        [("train --data none --model m", false), ("train --task x", false), ("--help", true), ("inspect m", true)]
    {
        let coloured = |forced: bool| {
            let mut command = folder.rollin(line);
            command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
            if forced {
                command.env("CLICOLOR_FORCE", "1");
            }
            let output = command.output().expect("it runs");
            assert_eq!(output.status.success(), ok, "{line}");
            [output.stdout, output.stderr].concat().contains(&0x1b)
        };
        assert!(!coloured(false) && coloured(true), "{line}");
        let silent = folder.rollin(line).env("NO_COLOR", "1").env_remove("CLICOLOR_FORCE").output().expect("it runs");
        assert!(![silent.stdout, silent.stderr].concat().contains(&0x1b), "{line}");
    }
}
