//! A model of any task, as a server knows it.

use crate::cli::report::spoken_json;
use crate::cli::tag::{self, Form};
use crate::cli::tasks::{read_model, with_task};
use crate::error::{Error, Place, Result};
use crate::read::conll::Block;
use crate::seed::Seed;
use crate::tasks::{Data, Model, Task};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A model that is being served, and where it came from.
pub struct Served {
    path: PathBuf,
    seed: u64,
    tagger: Box<dyn Tags>,
    /// What it is, for /health.
    pub about: Value,
    /// Whether its actions are labels of tokens, so that JSON can be asked for and how sure it is.
    pub labels: bool,
    /// Whether it was calibrated.
    calibrated: bool,
    /// Whether it decides by sums of weights that can be told one by one.
    explains: bool,
}

/// What is asked for beside the labels.
#[derive(Clone, Copy, Default)]
pub struct Wishes {
    /// How sure each is.
    pub confidence: bool,
    /// Why it was set.
    pub explain: bool,
}

impl Wishes {
    /// The form of lines that has how sure each label is, or not.
    fn lines(self) -> Form {
        if self.confidence { Form::Confidence } else { Form::Lines }
    }
}

/// Does what `rollin tag` does.
trait Tags: Send + Sync {
    /// What the model says of `text` in this form; and how many tokens there were.
    fn tag(&self, text: Vec<u8>, form: Form, seed: u64) -> Result<(Vec<u8>, usize)>;
}

impl<T: Task> Tags for Model<T> {
    fn tag(&self, text: Vec<u8>, form: Form, seed: u64) -> Result<(Vec<u8>, usize)> {
        let block = Block { bytes: text, first_line: 1 };
        let data = self.encoding.parse_block(&block, "<request>".as_ref(), &mut T::Stream::default())?;
        let tokens = data.as_ref().map_or(0, Data::tokens);
        Ok((tag::answer(self, (block, data, 0), form, Seed::new(seed))?, tokens))
    }
}

impl Served {
    /// The model in the file at `path`.
    pub fn load(path: &Path, seed: u64) -> Result<Self> {
        let (bytes, task) = read_model(path)?;
        with_task!(task, T => {
            let model = Model::<T>::from_bytes(&bytes, path)?;
            let (labels, calibrated) = (T::CONFIDENT, !model.temperatures.is_empty());
            let explains = T::NAMED && model.policy.sums().is_some();
            let about = json!({
                "status": "ok",
                "model": path,
                "task": T::NAME,
                "features": model.encoding.features(),
                "trainer": spoken_json(&model.about.trainer),
                "learner": spoken_json(&model.about.learner),
                "trained_on": model.about.data,
                "calibrated": calibrated,
                "explains": explains,
            });
            let tagger = Box::new(model);
            Ok(Served { path: path.to_owned(), seed, tagger, about, labels, calibrated, explains })
        })
    }

    /// The same file, read again.
    pub fn again(&self) -> Result<Self> {
        Served::load(&self.path, self.seed)
    }

    /// Refuses what it cannot tell.
    fn check(&self, wishes: Wishes) -> Result<()> {
        let refused = |name, why: &str| Err(Error::argument(name, "asked for", format!("left out: {why}")));
        if wishes.confidence && !self.calibrated {
            return refused("confidence", "the model was not calibrated");
        }
        if wishes.explain && !self.explains {
            return refused("explain", "the model does not decide by one sum of weights whose features have names");
        }
        Ok(())
    }

    /// What `rollin tag` writes for `text`, and how many tokens there were.
    pub fn text(&self, text: Vec<u8>, wishes: Wishes) -> Result<(Vec<u8>, usize)> {
        self.check(wishes)?;
        if wishes.explain && wishes.confidence {
            return Err(Error::argument(
                "confidence",
                "asked for",
                "left out of text that explains; JSON can have both",
            ));
        }
        let form = if wishes.explain { Form::Reasons } else { wishes.lines() };
        self.tagger.tag(text, form, self.seed)
    }

    /// The labels of the sentences in a body of JSON, and how many tokens there were.
    pub fn json(&self, body: &[u8], mut wishes: Wishes) -> Result<(Answer, usize)> {
        let request: Request = serde_json::from_slice(body).map_err(|error| {
            let place = Place { path: "<request>".into(), line: error.line(), column: error.column() };
            let text = error.to_string();
            let what = text.split(" at line ").next().unwrap_or(&text).to_owned();
            let words = r#"{"sentences": [["word", ...], ...]}"#;
            Error::data(place, what, format!(r#"{words} or {{"sentences": [[["word", "column", ...], ...], ...]}}"#))
        })?;
        wishes.confidence |= request.confidence;
        wishes.explain |= request.explain;
        self.sentences(&request, wishes)
    }

    /// The labels of sentences, and how many tokens there were.
    fn sentences(&self, request: &Request, wishes: Wishes) -> Result<(Answer, usize)> {
        if !self.labels {
            let expected = "text/plain: the model's actions are not labels of tokens";
            return Err(Error::argument("content type", "application/json", expected));
        }
        self.check(wishes)?;
        let text = request.text()?;
        let mut reasons = Vec::new();
        if wishes.explain {
            reasons = self.tagger.tag(text.clone(), Form::Objects, self.seed)?.0;
        }
        let mut reasons = reasons.split(|byte| *byte == b'\n');
        let (tagged, tokens) = self.tagger.tag(text, wishes.lines(), self.seed)?;
        let tagged = String::from_utf8_lossy(&tagged);
        let mut lines = tagged.lines();
        let sentences = request.sentences.iter().map(|sentence| {
            let mut labelled = Labelled::default();
            for line in lines.by_ref().take(sentence.len()) {
                let mut cells = line.rsplit(['\t', ' ']);
                if wishes.confidence {
                    labelled.confidence.extend(cells.next().and_then(|cell| cell.parse::<f64>().ok()));
                }
                labelled.labels.extend(cells.next().map(str::to_owned));
                if wishes.explain {
                    labelled.reasons.extend(reasons.next().and_then(|reason| serde_json::from_slice(reason).ok()));
                }
            }
            lines.next(); // the blank one
            labelled
        });
        Ok((Answer { sentences: sentences.collect() }, tokens))
    }
}

/// What is asked for as JSON.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    sentences: Vec<Vec<Token>>,
    #[serde(default)]
    confidence: bool,
    #[serde(default)]
    explain: bool,
}

/// A token: its word where there is one column, or its columns.
#[derive(Deserialize)]
#[serde(untagged)]
enum Token {
    Word(String),
    Columns(Vec<String>),
}

impl Token {
    fn columns(&self) -> &[String] {
        match self {
            Token::Word(word) => std::slice::from_ref(word),
            Token::Columns(columns) => columns,
        }
    }
}

impl Request {
    /// The sentences as lines of columns between tabs.
    fn text(&self) -> Result<Vec<u8>> {
        let mut text = String::new();
        for (s, sentence) in self.sentences.iter().enumerate() {
            if sentence.is_empty() {
                return Err(Error::instance(format!("sentences[{s}]"), "no token", "at least one").within("<request>"));
            }
            for (t, token) in sentence.iter().enumerate() {
                let columns = token.columns();
                let fit = |word: &String| !word.is_empty() && !word.contains([' ', '\t', '\n', '\r', '\0']);
                if columns.is_empty() || !columns.iter().all(fit) {
                    let at = format!("sentences[{s}][{t}]");
                    let expected = "words that are not empty and have no space, tab, line's end or NUL in them";
                    return Err(Error::instance(at, format!("{columns:?}"), expected).within("<request>"));
                }
                text.push_str(&columns.join("\t"));
                text.push('\n');
            }
            text.push('\n');
        }
        Ok(text.into_bytes())
    }
}

/// What is answered as JSON.
#[derive(Serialize)]
pub struct Answer {
    sentences: Vec<Labelled>,
}

/// A sentence's labels, and how sure and why each is where that was asked for: reasons as `rollin tag --explain --json` writes them.
#[derive(Default, Serialize)]
struct Labelled {
    labels: Vec<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    confidence: Vec<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    reasons: Vec<Value>,
}
