//! `rollin tag`

use super::options::ReadingName;
use super::tasks::{read_model, with_task};
use super::{Global, closed};
use crate::error::{Error, Result};
use crate::read::conll::Blocks;
use crate::seed::Seed;
use crate::tasks::{Data, Model, Task};
use clap::Args;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Tag, parse or read standard input. A tagger prints every line again with the label as a further last column; blank lines are kept.
///
/// Its input has one token a line, a blank line after each sentence, and the columns that the model was trained on. The column of labels
/// may be there or not. A parser reads CoNLL-U and prints it again with HEAD and DEPREL filled in; all else is kept. A reader of
/// handwriting prints every line again with the letter as a further last column; where the letter is not known, the input has `_`.
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
        let (bytes, task) = read_model(&self.model)?;
        with_task!(task, T => self.run_with(Model::<T>::from_bytes(&bytes, &self.model)?, global))
    }

    fn run_with<T: Task>(&self, mut model: Model<T>, global: &Global) -> Result<()> {
        if let Some(reading) = self.reading {
            model.policy = model.policy.read_as(reading.into());
        }
        let path = Path::new("<stdin>");
        let (mut stream, mut sentences) = (T::Stream::default(), 0);
        let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
        for block in Blocks::new(io::BufReader::with_capacity(1 << 16, io::stdin().lock()), BLOCK) {
            let block = block.map_err(|error| Error::io("read", path, error))?;
            let data = model.encoding.parse_block(&block, path, &mut stream)?;
            let mut actions = Vec::new();
            if let Some(data) = &data {
                let space = model.encoding.apply(data)?;
                actions = model.perform(space, data.sentences(), sentences, Seed::new(global.seed));
                sentences += data.sentences();
            }
            let answered = data.as_ref().map(|data| (data, &actions[..]));
            model.encoding.write(&block, answered, &mut out).map_err(closed)?;
        }
        out.flush().map_err(closed)
    }
}
