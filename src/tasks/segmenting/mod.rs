//! Segmentation (semi-Markov: Sarawagi & Cohen 2004): a sentence is cut into spans, left to right, and an action is the length and the label of the next.
//!
//! Labels come and go as IOB2 (BILOU and IOBES are understood, too): tokens outside all spans are spans of one token with the label `O`. Spans in the
//! data are those of `conlleval.pl` ([`crate::score::Scheme::spans`]), so what is ill-formed there needs no repair.
//!
//! # What a policy sees
//! Every action has weights of its own, so a feature of the state at hand is a feature of each span that could begin there. A template's rows
//! therefore reach over the span: `%x[3,0]` is inside a span of four tokens and behind one of three, and `%x[0,1]/%x[1,1]/%x[2,1]` are the tags in one of
//! three. All that depends on the words alone is computed once per corpus and scored once per position, however long spans may be
//! ([`default_template`] writes such lines as far as the longest span and one token beyond). `%y[-1]` is the label of the span before, `%y[-2]` that of
//! the one before it.
//!
//! # What it costs
//! A span costs as many tokens as it gives a wrong IOB2 label. The cheapest way from a place to the end does not depend on how the place was reached, so costs-to-go
//! are exact, by dynamic programming over the places of a sentence: where a gold span is longer than any action, or was cut before, too.
//!
//! How many spans a sentence will be cut into is not known beforehand, so CPI, which draws one step of each episode, refuses this space.
//!
//! ```
//! use rollin::learner::Logistic;
//! use rollin::read::conll;
//! use rollin::tasks::segmenting::{Settings, Spans};
//! use rollin::tasks::tagging::LabelColumn;
//! use rollin::tasks::{About, Model, Task};
//! use rollin::trainer::{Dagger, Run};
//! use rollin::Seed;
//!
//! let text = b"in O\nNew B-LOC\nYork B-LOC\n\nin O\nNew B-LOC\nYork I-LOC\nCity I-LOC\n\nin O\nYork B-LOC\n";
//! let corpus = conll::parse(text, "cities".as_ref(), 1)?;
//! let (spans, problem) = Spans::learn(&corpus, Settings::default_for(&corpus, LabelColumn::Last, 8)?)?;
//! assert_eq!(spans.actions(), 1 + 3); // outside, and places of 1 to 3 words
//! let trained = Dagger { rounds: 20, ..Dagger::default() }.train_online(&problem, &Logistic::default(), &Run::new(1))?;
//! let model = Model::new(spans, trained.policy, About::default())?;
//! let actions = model.perform(model.encoding.apply(&corpus)?, 3, 0, Seed::new(1));
//! assert_eq!(model.encoding.score(&corpus, &actions)?.f1(), 1.0);
//! # Ok::<(), rollin::Error>(())
//! ```

mod space;
mod task;

pub use space::{Divider, Segment, Segmenting};
pub use task::{MOST_LENGTH, Segmenter, Settings, Spans, default_template};
