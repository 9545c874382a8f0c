//! `rollin generate`

use super::{Global, closed};
use crate::error::Result;
use crate::grammar::Grammar;
use crate::seed::Seed;
use clap::Args;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

/// Draw tagged sentences from a grammar: one token a line, word and tag, a blank line after each sentence.
#[derive(Args)]
pub struct Generate {
    /// The grammar
    #[arg(long, value_name = "FILE")]
    grammar: PathBuf,
    /// How many sentences
    #[arg(long, value_name = "N")]
    count: usize,
}

/// Sentences held at a time.
const BLOCK: usize = 1024;

impl Generate {
    pub fn run(&self, global: &Global) -> Result<()> {
        let grammar = Grammar::read(&self.grammar)?;
        let mut out = BufWriter::new(io::stdout().lock());
        todo!()
    }
}
