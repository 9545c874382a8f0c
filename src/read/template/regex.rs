//! What a template makes of a word: itself, its shape, or what a regular expression finds in it.

use crate::corpus::hash;
use regex_lite::Regex;

/// Something made of a word.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Transform {
    /// The word.
    Word { fold: bool },
    /// Whether the expression is found in it.
    Test { matcher: Matcher },
    /// What the expression matches.
    Match { matcher: Matcher, fold: bool },
    /// Its shape, or the first `most` characters of that.
    Shape { most: Option<usize>, fold: bool },
}

impl Transform {
    /// The hash of what is made of `word`; `scratch` may be overwritten.
    pub(super) fn hash(&self, word: &str, scratch: &mut String) -> u64 {
        match self {
            Transform::Word { fold } => folded(word, *fold, scratch),
            Transform::Test { matcher } => hash(if matcher.find(word).is_some() { "true" } else { "false" }),
            Transform::Match { matcher, fold } => folded(matcher.find(word).unwrap_or(""), *fold, scratch),
            Transform::Shape { most, fold } => {
                scratch.clear();
                scratch.extend(word.chars().take(most.unwrap_or(usize::MAX)).map(|c| shape(c, *fold)));
                hash(scratch)
            }
        }
    }

    /// What is made of `word`: the text that [`Transform::hash`] is the hash of.
    pub(super) fn text(&self, word: &str) -> String {
        let fold = |text: &str, fold: bool| if fold { text.to_lowercase() } else { text.to_owned() };
        match self {
            Transform::Word { fold: lower } => fold(word, *lower),
            Transform::Test { matcher } => matcher.find(word).is_some().to_string(),
            Transform::Match { matcher, fold: lower } => fold(matcher.find(word).unwrap_or(""), *lower),
            Transform::Shape { most, fold } => {
                word.chars().take(most.unwrap_or(usize::MAX)).map(|c| shape(c, *fold)).collect()
            }
        }
    }

    /// Whether the result is always the word as it is.
    pub(super) fn is_identity(&self) -> bool {
        *self == Transform::Word { fold: false }
    }
}

/// The hash of `text`, in lower case if `fold`.
fn folded(text: &str, fold: bool, scratch: &mut String) -> u64 {
    if !fold || text.bytes().all(|byte| byte.is_ascii() && !byte.is_ascii_uppercase()) {
        hash(text)
    } else if text.is_ascii() {
        scratch.clear();
        scratch.push_str(text);
        scratch.make_ascii_lowercase();
        hash(scratch)
    } else {
        hash(&text.to_lowercase())
    }
}

/// The class of a character in a shape.
fn shape(character: char, fold: bool) -> char {
    match character {
        'A'..='Z' if !fold => 'X',
        'A'..='Z' | 'a'..='z' => 'x',
        '0'..='9' => 'd',
        other if fold => other.to_lowercase().next().unwrap_or(other),
        other => other,
    }
}

/// A regular expression of Wapiti's kind.
#[derive(Clone, Debug)]
pub(super) struct Matcher {
    source: String,
    engine: Engine,
}

/// How it is matched.
#[derive(Clone, Debug)]
enum Engine {
    /// `^.?.?.` and the like: so many first characters.
    Prefix { least: usize, most: usize },
    /// `.?.?.$` and the like: so many last characters.
    Suffix { least: usize, most: usize },
    /// Anything else.
    General(Regex),
}

/// Two expressions are the same when they are written the same.
impl PartialEq for Matcher {
    fn eq(&self, other: &Self) -> bool {
        self.source == other.source
    }
}

impl Matcher {
    /// The expression written `source`. A fault is a byte of `source` and what should stand there.
    pub(super) fn new(source: &str) -> Result<Self, (usize, &'static str)> {
        let translated = translate(source)?;
        let engine = match affix(source) {
            Some(engine) => engine,
            None => Engine::General(Regex::new(&translated).map_err(|_| (0, "a smaller regular expression"))?),
        };
        Ok(Matcher { source: source.to_owned(), engine })
    }

    /// What it matches first in `word`.
    fn find<'w>(&self, word: &'w str) -> Option<&'w str> {
        match &self.engine {
            Engine::General(regex) => regex.find(word).map(|found| found.as_str()),
            // The characters are counted no further than the expression reaches.
            Engine::Prefix { least, most } => {
                let ends = word.char_indices().map(|(start, c)| start + c.len_utf8());
                let (count, end) = ends.take(*most).fold((0, 0), |(count, _), end| (count + 1, end));
                if count < *least { None } else { word.get(..end) }
            }
            Engine::Suffix { least, most } => {
                let starts = word.char_indices().rev().map(|(start, _)| start);
                let (count, start) = starts.take(*most).fold((0, word.len()), |(count, _), start| (count + 1, start));
                if count < *least { None } else { word.get(start..) }
            }
        }
    }
}

/// The engine for expressions that are a number of dots, some of them optional, at one end of the word.
fn affix(source: &str) -> Option<Engine> {
    let (dots, is_prefix) = match (source.strip_prefix('^'), source.strip_suffix('$')) {
        (Some(dots), None) => (dots, true),
        (None, Some(dots)) => (dots, false),
        _ => return None,
    };
    let optional = dots.matches(".?").count();
    let most = dots.matches('.').count();
    if most + optional != dots.len() {
        return None;
    }
    let least = most - optional;
    Some(if is_prefix { Engine::Prefix { least, most } } else { Engine::Suffix { least, most } })
}

/// `source` in the syntax of the regex crates.
fn translate(source: &str) -> Result<String, (usize, &'static str)> {
    let mut result = String::from("(?s)");
    let mut characters = source.char_indices().peekable();
    // Whether what was read last can be repeated.
    let mut single = false;
    while let Some((at, character)) = characters.next() {
        let is_last = characters.peek().is_none();
        match character {
            '^' if at == 0 => result.push('^'),
            '$' if is_last => result.push('$'),
            '*' | '?' if !single => return Err((at, "a character to repeat before * and ?, or a backslash")),
            '*' => result.push_str("*?"),
            '?' => result.push('?'),
            '.' => result.push('.'),
            '\\' => match characters.next() {
                Some((_, class)) => escape(class, &mut result),
                None => return Err((at, "a character after the backslash")),
            },
            other => literal(other, &mut result),
        }
        single = !(matches!(character, '*' | '?') || character == '^' && at == 0);
    }
    Ok(result)
}

/// What a backslash and `class` mean.
fn escape(class: char, result: &mut String) {
    let set = match class.to_ascii_lowercase() {
        'a' => "a-zA-Z",
        'd' => "0-9",
        'l' => "a-z",
        'p' => r"!-/:-@\[-`\{-~",
        's' => r"\t-\r\x20",
        'u' => "A-Z",
        'w' => "a-zA-Z0-9",
        _ => return literal(class, result),
    };
    result.push_str(if class.is_ascii_uppercase() { "[^" } else { "[" });
    result.push_str(set);
    result.push(']');
}

/// `character` itself.
fn literal(character: char, result: &mut String) {
    if character.is_ascii_punctuation() {
        result.push('\\');
    }
    result.push(character);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn find<'w>(source: &str, word: &'w str) -> Option<&'w str> {
        Matcher::new(source).expect("a good expression").find(word)
    }

    #[test]
    fn expressions_mean_what_wapiti_says() {
        let cases = [
            ("..$", "hello", Some("lo")),
            ("..$", "o", None),
            (".?.?.?$", "ab", Some("ab")),
            ("^.?.?.", "hello", Some("hel")),
            ("^.?.?.", "h", Some("h")),
            ("^", "x", Some("")),
            ("\\u", "aBc", Some("B")),
            ("^\\u\\u*$", "ABC", Some("ABC")),
            ("^\\u\\u*$", "ABc", None),
            // The star takes as little as it can.
            ("b\\d*", "ab12", Some("b")),
            ("\\d\\d*\\D", "ab12c", Some("12c")),
            ("\\p", "a-b", Some("-")),
            ("\\P\\w", "a-b", None),
            ("\\A", "é", Some("é")),
            ("\\.", "a.b", Some(".")),
            ("\\\"", "a\"b", Some("\"")),
            // These mean themselves in Wapiti.
            ("a$b", "a$b", Some("a$b")),
            ("a^", "a^", Some("a^")),
            ("(a|b)+[c]{2}", "(a|b)+[c]{2}", Some("(a|b)+[c]{2}")),
            ("", "x", Some("")),
        ];
        for (source, word, expected) in cases {
            assert_eq!(find(source, word), expected, "{source} in {word}");
        }
    }

    #[test]
    fn faults_have_a_place() {
        assert_eq!(Matcher::new("ab**").expect_err("a second star").0, 3);
        assert_eq!(Matcher::new("?").expect_err("nothing to repeat").0, 0);
        assert_eq!(Matcher::new("^*").expect_err("nothing to repeat").0, 1);
        assert_eq!(Matcher::new("é\\").expect_err("a lone backslash").0, 2);
    }

    proptest! {
        #[test]
        fn affixes_agree_with_the_general_engine(source in "\\^(\\.\\??){0,5}|(\\.\\??){0,5}\\$", word in "\\PC{0,7}") {
            let matcher = Matcher::new(&source).expect("dots");
            prop_assert!(!matches!(matcher.engine, Engine::General(_)));
            let general = Regex::new(&translate(&source).expect("dots")).expect("dots");
            prop_assert_eq!(matcher.find(&word), general.find(&word).map(|found| found.as_str()));
        }

        #[test]
        fn no_expression_panics(source in "[.*?^$\\\\dUab|(]{0,12}|\\PC{0,8}", word in "\\PC{0,8}") {
            if let Ok(matcher) = Matcher::new(&source) {
                let _ = matcher.find(&word);
            }
        }
    }
}
