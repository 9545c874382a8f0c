//! `rollin tag`

use super::explain::{self, Asked};
use super::options::{ReadingName, no_such_setting};
use super::stream::answered;
use super::tasks::{read_model, with_task};
use super::{Global, closed};
use crate::error::{Error, Result};
use crate::read::conll::{Block, Blocks};
use crate::read::input;
use crate::seed::Seed;
use crate::tasks::{Data, Model, Task, write_labels};
use clap::Args;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

/// Tag, parse, read or go through standard input. A tagger prints every line again with the label as a further last column; blank lines are kept.
///
/// Its input has one token a line, a blank line after each sentence, and the columns that the model was trained on. The column of labels
/// may be there or not. So does a segmenter, whose labels are those of IOB2. A parser reads CoNLL-U and prints it again with HEAD and DEPREL filled in; all else is kept. A reader of
/// handwriting prints every line again with the letter as a further last column; where the letter is not known, the input has `_`. So does a labeller of graphs with the lines of nodes. A traveller writes the
/// path behind each trip, a letter a step; a walker of a tabular problem one line an episode, `state:action` for each step.
#[derive(Args)]
#[command(after_help = super::help::tag())]
pub struct Tag {
    /// The model file
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// How to choose a label from a mixture of classifiers [default: as the model says]
    #[arg(long, value_enum, value_name = "NAME")]
    reading: Option<ReadingName>,
    /// Write how sure each label is as one more column: its probability, or that of the span it belongs to, as learned by `rollin train --calibrate`
    #[arg(long)]
    confidence: bool,
    /// Tell below each line why it got its label, in lines that begin with #: the scores of the label and of the next best, and what the features add to each. With --json one
    /// object a token in place of the lines, with all features in the order in which they are added up
    #[arg(long, conflicts_with = "confidence")]
    explain: bool,
}

/// Lines of a block, which one thread tags at a time.
const BLOCK: usize = 65_536;

/// In which form a block is answered.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Its lines with what the model says.
    Lines,
    /// The same with how sure it is, of which a model that was not calibrated says nothing.
    Confidence,
    /// The same with reasons below each line.
    Reasons,
    /// The reasons alone, a JSON object a token.
    Objects,
}

/// A block, its corpus if it is not blank, and how many sentences came before it.
pub type Read<T> = (Block, Option<<T as Task>::Data>, usize);

impl Tag {
    pub fn run(&self, global: &Global) -> Result<()> {
        if !self.explain {
            global.refuse_json("tag writes the lines it reads")?;
        }
        if self.model.as_os_str() == "-" {
            return Err(Error::argument("--model", "-", "a file: standard input has the lines to be tagged"));
        }
        let (bytes, task) = read_model(&self.model)?;
        with_task!(task, T => {
            let model = Model::<T>::from_bytes(&bytes, &self.model)?;
            drop(bytes);
            self.run_with(model, global)
        })
    }

    fn run_with<T: Task>(&self, mut model: Model<T>, global: &Global) -> Result<()> {
        if let Some(reading) = self.reading {
            model = model.read_as(reading.into());
        }
        if self.confidence {
            if !T::CONFIDENT {
                return Err(no_such_setting("--confidence", T::NAME));
            }
            if model.temperatures.is_empty() {
                let remedy = "train it with --calibrate, and with the --reading that it is used with";
                return Err(Error::file(&self.model, "a model that was not calibrated", remedy));
            }
        }
        if self.explain {
            if !T::NAMED {
                return Err(no_such_setting("--explain", T::NAME));
            }
            explain::check(&model, &self.model)?;
        }
        let form = match (self.explain, global.json) {
            (false, _) if self.confidence => Form::Confidence,
            (false, _) => Form::Lines,
            (true, false) => Form::Reasons,
            (true, true) => Form::Objects,
        };
        let path = input::name("-".as_ref());
        let (mut stream, mut sentences) = (T::Stream::default(), 0);
        let mut blocks = Blocks::new(input::open("-")?, BLOCK);
        let mut read = |block: Block| -> Result<Read<T>> {
            let data = model.encoding.parse_block(&block, path, &mut stream)?;
            let before = sentences;
            sentences += data.as_ref().map_or(0, Data::sentences);
            Ok((block, data, before))
        };
        let next = || Some(blocks.next()?.map_err(|error| Error::io("read", path, error)).and_then(&mut read));
        let seed = Seed::new(global.seed);
        let mut out = BufWriter::with_capacity(1 << 16, io::stdout());
        let write = |answer: Vec<u8>| out.write_all(&answer).map_err(closed);
        answered(next, |read| answer(&model, read, form, seed), write)?;
        out.flush().map_err(closed)
    }
}

/// What is written for a block.
pub fn answer<T: Task>(model: &Model<T>, (block, data, before): Read<T>, form: Form, seed: Seed) -> Result<Vec<u8>> {
    let mut actions = Vec::new();
    if let Some(data) = &data {
        let space = model.encoding.apply(data)?;
        actions = model.perform(space, data.sentences(), before, seed);
    }
    let mut text = Vec::with_capacity(2 * block.bytes.len());
    let answered = data.as_ref().map(|data| (data, &actions[..]));
    model.encoding.write(&block, answered, &mut text).map_err(closed)?;
    let Some(data) = &data else { return Ok(if form == Form::Objects { Vec::new() } else { text }) };
    let asked = Asked { data, actions: &actions, before, seed };
    match form {
        Form::Reasons => return explain::text(model, &asked, &Block { bytes: text, ..block }),
        Form::Objects => return explain::json(model, &asked),
        Form::Lines => return Ok(text),
        Form::Confidence => {}
    }
    let Some(sure) = model.sure(data, &actions, before, seed)? else { return Ok(text) };
    // What was written has the same lines: each of a token gets one column more.
    let lines = model.encoding.lines(data, &actions);
    let columns = lines.iter().map(|(line, action)| (*line, format!("{:.4}", sure[*action])));
    let mut more = Vec::with_capacity(2 * text.len());
    write_labels(&Block { bytes: text, ..block }, columns, &mut more).map_err(closed)?;
    Ok(more)
}
