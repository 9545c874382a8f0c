//! `rollin tag`

use super::options::{ReadingName, check_columns, columns};
use super::{Global, closed};
use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::read::conll::{Blocks, Line};
use crate::seed::Seed;
use crate::tasks::tagging::Tagger;
use clap::Args;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Tag standard input: every line is printed again with the label as a further last column; blank lines are kept.
///
/// The input has one token a line, a blank line after each sentence, and the columns that the model was trained on. The column of labels
/// may be there or not.
#[derive(Args)]
pub struct Tag {
    /// The model file
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// How to choose a label from a mixture of classifiers [default: as the model says]
    #[arg(long, value_enum, value_name = "NAME")]
    reading: Option<ReadingName>,
}

/// Lines tagged at a time: enough to keep all threads busy.
const BLOCK: usize = 65_536;

impl Tag {
    pub fn run(&self, global: &Global) -> Result<()> {
        global.refuse_json("tag writes the lines it reads")?;
        let mut tagger = Tagger::load(&self.model)?;
        if let Some(reading) = self.reading {
            tagger.policy = tagger.policy.read_as(reading.into());
        }
        let path = Path::new("<stdin>");
        let (mut first, mut sentences) = (None, 0);
        let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
        for block in Blocks::new(io::BufReader::with_capacity(1 << 16, io::stdin().lock()), BLOCK) {
            let block = block.map_err(|error| Error::io("read", path, error))?;
            let mut tagged = Vec::new();
            if let Some(corpus) = block.corpus(path)? {
                check_columns(&tagger.encoding, &corpus)?;
                even(*first.get_or_insert((corpus.columns.len(), corpus.lines[0])), &corpus)?;
                let labels = tagger.tag_from(&corpus, sentences, Seed::new(global.seed))?;
                sentences += corpus.sentences();
                tagged.extend(corpus.lines.into_iter().zip(labels));
            }
            let mut tagged = tagged.into_iter().peekable();
            for (line, number) in block.lines().zip(block.first_line..) {
                let label = tagged.next_if(|(at, _)| *at == number);
                let label = label.map(|(_, label)| tagger.encoding.labels[label as usize].as_str());
                write_line(&mut out, line, label).map_err(closed)?;
            }
        }
        out.flush().map_err(closed)
    }
}

/// Refuses a block whose lines have another number of columns than those of the blocks before, the first of which stands on
/// line `line`.
fn even((expected, line): (usize, usize), block: &Corpus) -> Result<()> {
    let found = block.columns.len();
    if found == expected {
        return Ok(());
    }
    let mut place = block.place(0, found.min(expected));
    if found < expected {
        // A word is missing where the line ends, not a separator further on.
        place.column -= 1;
    }
    Err(Error::data(place, columns(found), format!("{} as on line {line}", columns(expected))))
}

/// Writes one line and, when it is a token's, its label behind a separator like that of the line.
fn write_line(out: &mut impl Write, Line { text, end }: Line<'_>, label: Option<&str>) -> io::Result<()> {
    out.write_all(text)?;
    if let Some(label) = label {
        out.write_all(if memchr::memchr(b'\t', text).is_some() { b"\t" } else { b" " })?;
        out.write_all(label.as_bytes())?;
    }
    out.write_all(end)?;
    if !end.ends_with(b"\n") {
        out.write_all(b"\n")?;
    }
    Ok(())
}
