//! `rollin convert`

use super::options::{Mending, OrderName, read_template};
use super::{Global, closed};
use crate::corpus::{Corpus, Separator};
use crate::error::{Error, Result};
use crate::read::attributes::Items;
use crate::read::conll::{Block, Blocks};
use crate::read::template::Template;
use crate::read::{conllu, crfsuite, input, vw};
use crate::tasks::tagging::{Columns, LabelColumn, Order};
use clap::{Args, ValueEnum};
use std::io::{self, BufRead, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Convert a corpus from one format to another, from standard input to standard output.
///
/// From columns to attributes (crfsuite, vw) the --template says which: all its lines but those that look at labels, spelled out, which is what CRF++
/// prints. From attributes to columns, each attribute gets a column of its own, `_` where an item has fewer than others; this reads all input before it writes
/// anything. From conllu to conll all ten columns of the words are kept, and ten columns are what conllu is made of. A blank in a cell, and in vw also a
/// colon or a bar, is written as a per cent sign and its code (%20).
#[derive(Args)]
#[command(after_help = super::help::convert())]
pub struct Convert {
    /// The format that is read
    #[arg(long, value_enum, value_name = "FORMAT")]
    from: Format,
    /// The format that is written
    #[arg(long, value_enum, value_name = "FORMAT")]
    to: Format,
    /// What to read (- for standard input)
    #[arg(long, value_name = "FILE", default_value = "-")]
    data: PathBuf,
    /// The feature template that makes attributes of columns
    #[arg(long, value_name = "FILE")]
    template: Option<PathBuf>,
    /// The column the labels stand in, from 0, where attributes are made of columns or labels repaired [default: the last]
    #[arg(long, value_name = "N")]
    label_column: Option<usize>,
    /// Change labels that break the rule of --order to those of the spans that conlleval reads in them, and say so on standard error
    #[arg(long)]
    repair: bool,
    /// Which label may follow which [default: what the labels suggest; all input is then read before anything is written]
    #[arg(long, value_enum, value_name = "RULE", requires = "repair")]
    order: Option<OrderName>,
}

/// A format of corpora.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// One token a line, columns between spaces or tabs
    Conll,
    /// Treebanks of Universal Dependencies
    Conllu,
    /// A label and attributes between tabs
    Crfsuite,
    /// `label |namespace feature ...`, as for Vowpal Wabbit's --search_task sequence
    Vw,
}

impl Format {
    fn has_columns(self) -> bool {
        matches!(self, Format::Conll | Format::Conllu)
    }
}

/// A part of a corpus that was read.
enum Part {
    Columns(Corpus),
    Items(Items),
}

/// Lines that are converted at a time.
const BLOCK: usize = 65_536;

impl Convert {
    pub fn run(&self, global: &Global) -> Result<()> {
        global.refuse_json("convert writes a corpus")?;
        let making = self.from.has_columns() && !self.to.has_columns();
        if making && self.template.is_none() {
            return Err(Error::argument("--template", "left out", "given: it says what the attributes are"));
        }
        for (name, given) in [("--template", self.template.is_some()), ("--label-column", self.label_column.is_some())]
        {
            if given && !making {
                return Err(Error::argument(name, "given", "left out: it is for making attributes of columns"));
            }
        }
        self.convert(input::open(&self.data)?, input::name(&self.data))
    }

    fn convert(&self, input: impl BufRead, path: &Path) -> Result<()> {
        // How many columns there must be is known at the end only, and so is what all labels together suggest.
        let whole = !self.from.has_columns() && self.to.has_columns() || self.repair && self.order.is_none();
        let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
        let (mut columns, mut template, mut empty) = (Columns::default(), None, true);
        for block in Blocks::new(input, if whole { usize::MAX } else { BLOCK }) {
            let block = block.map_err(|error| Error::io("read", path, error))?;
            let Some(mut part) = self.read(&block, path, &mut columns)? else { continue };
            empty = false;
            if self.repair {
                self.mend(&mut part)?;
            }
            // Written where all of it can be, so that what is refused leaves no half.
            let mut text = Vec::new();
            self.write(part, &mut template, &mut text)?;
            out.write_all(&text).map_err(closed)?;
        }
        if empty {
            return Err(Error::file(path, "no sentence", "give it at least one"));
        }
        out.flush().map_err(closed)
    }

    /// What `block` says, if it is not blank.
    fn read(&self, block: &Block, path: &Path, columns: &mut Columns) -> Result<Option<Part>> {
        let (text, line) = (&block.bytes, block.first_line);
        let items = |items: Items| (!items.is_empty()).then_some(Part::Items(items));
        Ok(match self.from {
            Format::Conll => {
                let corpus = block.corpus(path)?;
                corpus.as_ref().map_or(Ok(()), |corpus| columns.check(corpus))?;
                corpus.map(Part::Columns)
            }
            Format::Conllu => {
                let bank = conllu::parse_block(text, path, line)?;
                (bank.sentences() > 0).then(|| Part::Columns(bank.columns()))
            }
            Format::Crfsuite => items(crfsuite::parse_block(text, path, line)?),
            Format::Vw => items(vw::parse_block(text, path, line)?),
        })
    }

    /// Mends the labels.
    fn mend(&self, part: &mut Part) -> Result<()> {
        let how = Mending { repair: true, otherwise: None, labels: self.labels(), order: self.order.map(Order::from) };
        match part {
            Part::Columns(corpus) => how.mend(corpus),
            Part::Items(items) => how.mend_column(&mut items.labels, 0),
        }
    }

    fn labels(&self) -> LabelColumn {
        self.label_column.map_or(LabelColumn::Last, LabelColumn::At)
    }

    fn write(&self, part: Part, template: &mut Option<Template>, out: &mut Vec<u8>) -> Result<()> {
        let written = match (part, self.to) {
            (Part::Columns(corpus), Format::Conll) => corpus.write(out, Separator::Tab),
            (Part::Items(items), Format::Conll) => items.columns()?.write(out, Separator::Tab),
            (Part::Columns(corpus), Format::Conllu) => conllu::write_columns(&corpus, out)?,
            (Part::Items(items), Format::Conllu) => conllu::write_columns(&items.columns()?, out)?,
            (Part::Columns(corpus), format) => write_items(&self.items(&corpus, template)?, format, out),
            (Part::Items(items), format) => write_items(&items, format, out),
        };
        written.map_err(|error| Error::io("write", "<stdout>", error))
    }

    /// The attributes that the template makes of `corpus`; it is read when it is needed first.
    fn items(&self, corpus: &Corpus, template: &mut Option<Template>) -> Result<Items> {
        let labels = self.labels().in_corpus(corpus)?;
        let template = match template {
            Some(template) => template,
            None => {
                let path = self.template.as_deref().unwrap_or(Path::new("<no template>"));
                let read = read_template(path, labels)?;
                if read.observations() == 0 {
                    let problem = "every pattern looks at labels, so that none makes an attribute";
                    return Err(Error::file(path, problem, "give one that looks at columns only"));
                }
                template.insert(read)
            }
        };
        Ok(Items::of(corpus, labels, &template.speller(corpus)?))
    }
}

fn write_items(items: &Items, format: Format, out: &mut Vec<u8>) -> io::Result<()> {
    match format {
        Format::Vw => vw::write(items, out),
        _ => crfsuite::write(items, out),
    }
}
