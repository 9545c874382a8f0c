//! `rollin tag`

use super::options::ReadingName;
use super::{Global, closed};
use crate::error::{Error, Result};
use crate::read::conll::Blocks;
use crate::seed::{Purpose, Seed};
use crate::tasks::tagging::Tagger;
use clap::Args;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Tag standard input: every line is printed again with the label as a further last column; blank lines are kept.
#[derive(Args)]
pub struct Tag {
    /// The model
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Read a mixture in another way than the model says
    #[arg(long, value_enum, value_name = "NAME")]
    reading: Option<ReadingName>,
}

/// Lines tagged at a time: enough to keep all threads busy.
const BLOCK: usize = 16_384;

impl Tag {
    pub fn run(&self, global: &Global) -> Result<()> {
        let mut tagger = Tagger::load(&self.model)?;
        if let Some(reading) = self.reading {
            tagger.policy = tagger.policy.read_as(reading.into());
        }
        let path = Path::new("<stdin>");
        let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
        for (number, block) in Blocks::new(io::BufReader::with_capacity(1 << 16, io::stdin().lock()), BLOCK).enumerate()
        {
            let block = block.map_err(|error| Error::io("read", path, error))?;
            let labels = match block.corpus(path)? {
                Some(corpus) => tagger.tag(&corpus, Seed::new(global.seed).child(Purpose::Round, number as u64))?,
                None => Vec::new(),
            };
            let mut labels = labels.into_iter().map(|label| tagger.encoding.labels[label as usize].as_str());
            for line in block.lines() {
                write_line(&mut out, line.text, line.end, &mut labels).map_err(closed)?;
            }
        }
        out.flush().map_err(closed)
    }
}

/// Writes one line and, when it is a token's, the next label behind a separator like that of the line.
fn write_line<'a>(
    out: &mut impl Write,
    text: &[u8],
    end: &[u8],
    labels: &mut impl Iterator<Item = &'a str>,
) -> io::Result<()> {
    out.write_all(text)?;
    if !text.is_empty()
        && let Some(label) = labels.next()
    {
        out.write_all(if memchr::memchr(b'\t', text).is_some() { b"\t" } else { b" " })?;
        out.write_all(label.as_bytes())?;
    }
    out.write_all(end)?;
    if !end.ends_with(b"\n") {
        out.write_all(b"\n")?;
    }
    Ok(())
}
