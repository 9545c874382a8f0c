//! The command-line program: one file a command.
//!
//! What a command computes goes to standard output, progress and errors to standard error. Bad input ends with exit code 2 and one
//! message.

mod algorithms;
mod compare;
mod convert;
mod drive;
mod evaluate;
mod experiment;
mod explain;
mod generate;
mod help;
mod inspect;
mod long;
mod mistakes;
mod options;
mod progress;
mod report;
#[cfg(feature = "serve")]
mod serve;
mod shell;
mod stream;
mod tag;
mod tasks;
mod terminal;
mod theory;
mod train;
mod update;

#[cfg(feature = "serve")]
#[doc(hidden)]
pub use serve::Answerer;

use crate::error::{Error, Result};
use clap::{ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use std::io::{self, Write};
use std::process::ExitCode;

/// Structured prediction by learning to search: imitation learning as sequence labelling.
#[derive(Parser)]
#[command(name = "rollin", version, propagate_version = true, max_term_width = 110, styles = terminal::STYLES, after_help = help::program())]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    global: Global,
}

/// What every command understands.
#[derive(Args)]
struct Global {
    /// The number that all randomness starts from
    #[arg(long, global = true, default_value_t = 1, value_name = "N", help_heading = "Every command")]
    seed: u64,
    /// Threads; the results do not depend on it [default: one per core]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS),
          help_heading = "Every command")]
    threads: Option<u16>,
    /// No progress on standard error
    #[arg(long, short, global = true, help_heading = "Every command")]
    quiet: bool,
    /// One JSON object on standard output in place of text (for tag one a token, with --explain; not for convert, generate, completions and man)
    #[arg(long, global = true, help_heading = "Every command")]
    json: bool,
}

/// The exit code where standard output was closed before all was written: that of a program that the signal ended (128 + SIGPIPE).
const READER_GONE: u8 = 141;

/// More would only cost memory.
const MOST_THREADS: i64 = 1024;

impl Global {
    /// Refuses --json for a command that writes something else.
    fn refuse_json(&self, why: &str) -> Result<()> {
        if self.json { Err(Error::argument("--json", "given", format!("left out: {why}"))) } else { Ok(()) }
    }
}

#[derive(Subcommand)]
enum Command {
    /// Train a model for any of the tasks and write its file
    Train(train::Train),
    /// Go on training a model with more data
    Update(update::Update),
    /// Do a model's task on standard input: every line again, with what the model says
    Tag(tag::Tag),
    /// Compare a model's answers with the right ones
    Evaluate(evaluate::Evaluate),
    /// Train with several algorithms on the same data and compare accuracy with what the expert was asked
    Compare(compare::Compare),
    /// Convert a corpus from one format to another
    Convert(convert::Convert),
    /// Draw tagged sentences from a grammar
    Generate(generate::Generate),
    /// Tell what is in a model file
    Inspect(inspect::Inspect),
    /// Exact values, bounds and bills in advance
    Theory(theory::Theory),
    /// Run the experiments of Ross & Bagnell (2010) on two games
    Experiment(experiment::Experiment),
    /// Let what an experiment learned play a game, and write a page to watch it
    Drive(drive::Drive),
    /// Serve a model over HTTP
    #[cfg(feature = "serve")]
    Serve(serve::Serve),
    /// Write what a shell needs to complete what is typed
    Completions(shell::Completions),
    /// Write manual pages
    Man(shell::Man),
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    let mut command = Cli::command();
    command.build();
    let matches = command.get_matches_mut();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    match run(&cli, &Given::of(&command, &matches)) {
        Ok(code) => code,
        // Whoever reads no further has what they wanted.
        Err(Error::Io { source, .. }) if source.kind() == io::ErrorKind::BrokenPipe => ExitCode::from(READER_GONE),
        Err(error) => {
            terminal::tell("error", &error);
            ExitCode::from(2)
        }
    }
}

/// What was given on the command line, defaults included, by the name of the option.
struct Given(Vec<(String, String, String)>);

impl Given {
    fn of(command: &clap::Command, matches: &ArgMatches) -> Self {
        let Some((name, matches)) = matches.subcommand() else { return Given(Vec::new()) };
        let arguments = command.find_subcommand(name).into_iter().flat_map(clap::Command::get_arguments);
        let given = arguments.filter_map(|argument| {
            let id = argument.get_id().as_str();
            let values = matches.try_get_raw(id).ok()??;
            let values: Vec<String> = values.map(|value| value.to_string_lossy().into_owned()).collect();
            let name = argument.get_long().map_or_else(|| id.to_owned(), |long| format!("--{long}"));
            Some((id.to_owned(), name, values.join(",")))
        });
        Given(given.collect())
    }

    /// Names and values without those of these identifiers.
    fn without<'a>(&'a self, left_out: &'a [&str]) -> impl Iterator<Item = (&'a str, &'a str)> {
        let others = self.0.iter().filter(|(id, ..)| !left_out.contains(&id.as_str()));
        others.map(|(_, name, value)| (name.as_str(), value.as_str()))
    }
}

fn run(cli: &Cli, given: &Given) -> Result<ExitCode> {
    if let Some(threads) = cli.global.threads {
        let built = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
        built.map_err(|error| Error::argument("--threads", threads, format!("possible here ({error})")))?;
    }
    let done = match &cli.command {
        Command::Train(command) => return command.run(&cli.global, given),
        Command::Update(command) => command.run(&cli.global),
        Command::Tag(command) => command.run(&cli.global),
        Command::Evaluate(command) => command.run(&cli.global),
        Command::Compare(command) => command.run(&cli.global),
        Command::Convert(command) => command.run(&cli.global),
        Command::Generate(command) => command.run(&cli.global),
        Command::Inspect(command) => command.run(&cli.global),
        Command::Theory(command) => command.run(&cli.global),
        Command::Experiment(command) => command.run(&cli.global),
        Command::Drive(command) => command.run(&cli.global),
        #[cfg(feature = "serve")]
        Command::Serve(command) => command.run(&cli.global),
        Command::Completions(command) => command.run(&cli.global),
        Command::Man(command) => command.run(&cli.global),
    };
    done.map(|()| ExitCode::SUCCESS)
}

/// Standard output, whose closing is an error like any other. Colours get no further than to a terminal.
fn print(text: &str) -> Result<()> {
    let mut out = anstream::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(closed)
}

/// One JSON value on standard output.
fn print_json(value: &impl serde::Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|error| closed(error.into()))?;
    print(&(text + "\n"))
}

fn closed(error: io::Error) -> Error {
    Error::io("write", "<stdout>", error)
}
