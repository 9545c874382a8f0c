//! The worst sentences and the commonest confusions: `rollin evaluate --errors`.

use super::terminal::{headed, heading};
use crate::error::Result;
use crate::report::{Matrix, Table};
use crate::space::Action;
use crate::tasks::{Data, Task};
use serde::Serialize;

/// What a model gets wrong.
#[derive(Serialize)]
pub struct Mistakes {
    /// How many answers are wrong, in how many sentences, where there are any.
    wrong: u64,
    sentences_with_mistakes: usize,
    /// Those with the most wrong words, the first of equals first.
    sentences: Vec<Sentence>,
    /// What was taken for what, the commonest first.
    confusions: Vec<Confusion>,
}

/// A sentence with mistakes.
#[derive(Serialize)]
struct Sentence {
    /// Where it begins.
    place: String,
    wrong: usize,
    words: Vec<Word>,
}

#[derive(Default, Serialize)]
struct Word {
    line: usize,
    word: String,
    right: String,
    given: String,
}

#[derive(Serialize)]
struct Confusion {
    right: String,
    given: String,
    count: u64,
    /// The part of all wrong answers.
    share: f64,
}

impl Mistakes {
    /// The `most` worst sentences and commonest confusions among `actions`, those of all episodes of `data`, whose answers were counted in `answers`.
    pub fn of<T: Task>(task: &T, data: &T::Data, actions: &[Action], answers: &Matrix, most: usize) -> Result<Self> {
        let lengths: Vec<usize> = (0..data.sentences()).map(|i| task.words(data, i).len()).collect();
        // A place for each answer: its sentence.
        let mut at = lengths.iter().enumerate().flat_map(|(i, length)| std::iter::repeat_n(i, *length));
        let mut wrong = vec![0; lengths.len()];
        task.answers(data, actions, &mut |right, given| {
            if let Some(i) = at.next() {
                wrong[i] += usize::from(right != given);
            }
        })?;
        let mut worst: Vec<usize> = (0..lengths.len()).filter(|i| wrong[*i] > 0).collect();
        let sentences_with_mistakes = worst.len();
        worst.sort_by_key(|i| std::cmp::Reverse(wrong[*i]));
        worst.truncate(most);
        let starts: Vec<usize> =
            lengths.iter().scan(0, |end, length| Some(std::mem::replace(end, *end + length))).collect();
        let mut sentences: Vec<Sentence> = worst.iter().map(|i| Sentence::of(task, data, *i, wrong[*i])).collect();
        let mut token = 0usize;
        task.answers(data, actions, &mut |right, given| {
            for (i, sentence) in worst.iter().zip(&mut sentences) {
                if let Some(word) = token.checked_sub(starts[*i]).and_then(|t| sentence.words.get_mut(t)) {
                    (word.right, word.given) = (right.to_owned(), given.to_owned());
                }
            }
            token += 1;
        })?;
        let mistakes = answers.mistakes();
        let all: u64 = mistakes.iter().map(|(.., count)| count).sum();
        let confusion = |(right, given, count): &(&str, &str, u64)| Confusion {
            right: (*right).to_owned(),
            given: (*given).to_owned(),
            count: *count,
            share: *count as f64 / all as f64,
        };
        let confusions = mistakes.iter().take(most).map(confusion).collect();
        Ok(Mistakes { wrong: all, sentences_with_mistakes, sentences, confusions })
    }

    /// For a person.
    pub fn text(&self) -> String {
        let mut text = format!("\n{}", headed(&self.confused()));
        if !self.sentences.is_empty() {
            let (told, all) = (self.sentences.len(), self.sentences_with_mistakes);
            text += &format!("\n{}\n", heading(&format!("The worst sentences: {told} of {all} with mistakes")));
        }
        for sentence in &self.sentences {
            text += &format!("\n{}: {} of {} wrong\n", sentence.place, sentence.wrong, sentence.words.len());
            text += &sentence.table().to_string();
        }
        text
    }

    /// Tables for a page: headings, and what stands below.
    pub fn tables(&self) -> Vec<(String, Table)> {
        let mut tables = vec![("Commonest confusions".to_owned(), self.confused())];
        tables.extend(self.sentences.iter().map(|sentence| {
            (format!("{}: {} of {} wrong", sentence.place, sentence.wrong, sentence.words.len()), sentence.table())
        }));
        tables
    }

    /// What was taken for what.
    fn confused(&self) -> Table {
        let mut table = Table::new(["right", "given", "times", "% of all mistakes"]);
        for confusion in &self.confusions {
            let (count, share) = (confusion.count.to_string(), format!("{:.1}", 100.0 * confusion.share));
            table.row([confusion.right.clone(), confusion.given.clone(), count, share]);
        }
        table
    }
}

/// As many right words are told before and behind a mistake.
const AROUND: usize = 2;

impl Sentence {
    /// The words of sentence `i`, without answers.
    fn of<T: Task>(task: &T, data: &T::Data, i: usize, wrong: usize) -> Self {
        let words = task.words(data, i);
        let line = words.first().map_or(0, |(line, _)| *line);
        let place = format!("{}:{line}", data.path().display());
        let word = |(line, word): (usize, &str)| Word { line, word: word.to_owned(), ..Word::default() };
        Sentence { place, wrong, words: words.into_iter().map(word).collect() }
    }

    /// Right and given answers side by side, without what is further from any mistake than [`AROUND`].
    fn table(&self) -> Table {
        let mut table = Table::new(["word", "right", "given", ""]);
        let wrong = |word: &Word| word.right != word.given;
        let mut left_out = false;
        for (i, word) in self.words.iter().enumerate() {
            let around = i.saturating_sub(AROUND)..(i + AROUND + 1).min(self.words.len());
            let told = self.words[around].iter().any(wrong);
            if told {
                let mark = if wrong(word) { "wrong" } else { "" };
                table.row([&word.word, &word.right, &word.given, mark].map(str::to_owned));
            } else if !left_out {
                table.row(["...", "", "", ""]);
            }
            left_out = !told;
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_far_from_mistakes_is_left_out() {
        let word = |i: usize| Word {
            line: i,
            word: i.to_string(),
            right: "A".to_owned(),
            given: if i == 5 || i == 15 { "B" } else { "A" }.to_owned(),
        };
        let sentence = Sentence { place: "here:1".to_owned(), wrong: 2, words: (0..18).map(word).collect() };
        let first = |row: &Vec<String>| row[0].clone();
        let told: Vec<String> = sentence.table().rows()[1..].iter().map(first).collect();
        assert_eq!(told.join(" "), "... 3 4 5 6 7 ... 13 14 15 16 17");
    }
}
