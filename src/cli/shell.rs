//! `rollin completions` and `rollin man`

use super::{Cli, Global, closed, print};
use crate::error::{Error, Result};
use crate::output::write_whole;
use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man as Page;
use clap_mangen::roff::{Roff, roman};
use std::io;
use std::path::PathBuf;

/// Write what a shell needs to complete commands, options and their values.
#[derive(Args)]
#[command(after_help = super::help::completions())]
pub struct Completions {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

impl Completions {
    pub fn run(&self, global: &Global) -> Result<()> {
        global.refuse_json("completions writes a script")?;
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "rollin", &mut script);
        print(&String::from_utf8_lossy(&script))
    }
}

/// Write manual pages: that of the program to standard output, or one for each command to a folder.
#[derive(Args)]
#[command(after_help = super::help::man())]
pub struct Man {
    /// The folder, which is made where there is none
    #[arg(value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

impl Man {
    pub fn run(&self, global: &Global) -> Result<()> {
        global.refuse_json("man writes manual pages")?;
        let mut program = Cli::command().disable_help_subcommand(true);
        program.build();
        let Some(folder) = &self.folder else {
            return print(&String::from_utf8_lossy(&page(program).map_err(closed)?.1));
        };
        std::fs::create_dir_all(folder).map_err(|source| Error::io("make", folder, source))?;
        let mut written = String::new();
        for command in all(&program) {
            let (name, text) = page(command.clone()).map_err(closed)?;
            let path = folder.join(name);
            write_whole(&path, &text)?;
            written += &format!("wrote {}\n", path.display());
        }
        print(&written)
    }
}

/// A command, and those below it.
fn all(command: &Command) -> Vec<&Command> {
    std::iter::once(command).chain(command.get_subcommands().flat_map(all)).collect()
}

/// The page of a command: the name of its file, and its text.
fn page(command: Command) -> io::Result<(String, Vec<u8>)> {
    let help = command.get_after_long_help().or(command.get_after_help()).map(ToString::to_string);
    let below = command.has_subcommands();
    let page = Page::new(command);
    let mut text = Vec::new();
    page.render_title(&mut text)?;
    page.render_name_section(&mut text)?;
    page.render_synopsis_section(&mut text)?;
    page.render_description_section(&mut text)?;
    page.render_options_section(&mut text)?;
    if below {
        page.render_subcommands_section(&mut text)?;
    }
    if let Some(help) = help {
        // What is to be typed stands in lines of its own, which no page may fill.
        let mut roff = Roff::new();
        roff.control("SH", ["EXAMPLES"]).control("nf", []);
        for line in help.lines() {
            roff.text([roman(line)]);
        }
        roff.control("fi", []);
        roff.to_writer(&mut text)?;
    }
    Ok((page.get_filename(), text))
}
