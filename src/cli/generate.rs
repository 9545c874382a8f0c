//! `rollin generate`

use super::{Global, closed};
use crate::error::Result;
use crate::grammar::{Grammar, Sentence};
use crate::seed::{Purpose, Seed};
use clap::Args;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

/// Draw tagged sentences from a grammar: one token a line, word and tag, a blank line after each sentence.
#[derive(Args)]
#[command(after_help = super::help::generate())]
pub struct Generate {
    /// The grammar file (- for standard input)
    #[arg(long, value_name = "FILE")]
    grammar: PathBuf,
    /// How many sentences
    #[arg(long, value_name = "N")]
    count: usize,
}

/// The node that sentence `i` hangs below: that of [`Grammar::generate`].
fn sentence_seed(seed: u64, i: usize) -> Seed {
    Seed::new(seed).child(Purpose::Sentence, i as u64)
}

/// Sentences held at a time.
const BLOCK: usize = 1024;

impl Generate {
    pub fn run(&self, global: &Global) -> Result<()> {
        global.refuse_json("generate writes a corpus")?;
        let grammar = Grammar::read(&self.grammar)?;
        let mut out = BufWriter::new(io::stdout().lock());
        let mut left = 0..self.count;
        while !left.is_empty() {
            let block = left.start..self.count.min(left.start + BLOCK);
            left.start = block.end;
            let sentences: Vec<Sentence> = block.map(|i| grammar.sentence(sentence_seed(global.seed, i))).collect();
            grammar.write(&sentences, &mut out).map_err(closed)?;
        }
        out.flush().map_err(closed)
    }
}
