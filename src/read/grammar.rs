//! Reader of grammars: text to syntax tree.
//!
//! A grammar is a list of statements, each closed by `;`. A `#` starts a comment that runs to the end of its line.
//!
//! ```text
//! start Noun*3 Verb;                        # where sentences start, with weights; a weight left out is 1
//! words kin = vel*3 oru "5th";              # a shared list of words with weights
//! words all = @kin*2 tam;                   # two parts a word of kin, one part tam
//! Noun -> { @kin tam*0.5 } { Verb*4 end }   # a word of the first braces, then one of the second
//!       | mor Noun *2;                      # another way, twice as likely: the one word mor, then Noun
//! Verb -> @all { Noun Late end };           # braces around a single choice can be left out
//! Late : Noun -> tam end;                   # a nonterminal that carries another tag than its own name
//! ```
//!
//! Names and bare words start with a letter or `_` and go on with letters, digits, `_`, `'` and inner hyphens; any
//! other word, and any other tag after `:`, stands in double quotes, with `\"` and `\\` for a quote and a backslash,
//! and holds no white space. `start` and `words` begin their statements and `end` ends a sentence, so no nonterminal
//! has one of these three names.
//!
//! The grammar of a game's levels is read for one difficulty d ([`Tree::parse_at`]). Its weights may depend on it: `*(2+d)`, `*(5d-10)`, a sum of numbers
//! and of multiples of `d`; what has no weight above 0 at some difficulty is left out there. What the tree means, and what else is refused, is told in [`grammar`](crate::grammar).

use std::path::{Path, PathBuf};

use nom::branch::alt;
use nom::bytes::complete::{tag, take_while, take_while1};
use nom::character::complete::{char, digit0, digit1, none_of, one_of, satisfy};
use nom::combinator::{cut, map, map_opt, not, opt, recognize, value, verify};
use nom::error::{ErrorKind, ParseError};
use nom::multi::{fold_many0, fold_many1, many0, many0_count, many1};
use nom::sequence::{delimited, pair, preceded, terminated};
use nom::{IResult, Parser};

use crate::error::{Error, Place, Result};

/// A name, a word or a tag, and the byte where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// The name itself, without quotes.
    pub text: String,
    /// The byte of the source at which it starts.
    pub offset: usize,
}

/// Something with a weight: one of several choices.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighted<T> {
    /// What may be chosen.
    pub item: T,
    /// Its weight beside the other choices: positive and finite.
    pub weight: f64,
}

/// A choice in a list of words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Item {
    /// One word.
    Word(Name),
    /// Any word of a shared list: `@name`.
    List(Name),
}

/// A choice of what follows a word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// The nonterminal that goes on.
    Nonterminal(Name),
    /// The end of the sentence; the name's text is `end`.
    End(Name),
}

/// A shared list of words: `words name = ...;`
#[derive(Clone, Debug, PartialEq)]
pub struct List {
    /// The list's name.
    pub name: Name,
    /// Its choices.
    pub items: Vec<Weighted<Item>>,
}

/// One alternative of a rule: a word of `words`, then one of `next`.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// The choices of the word.
    pub words: Vec<Weighted<Item>>,
    /// The choices of what follows it.
    pub next: Vec<Weighted<Target>>,
}

/// All that one nonterminal may do: `name : tag -> arm | arm;`
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// The nonterminal.
    pub name: Name,
    /// Its tag, where it is not the nonterminal's own name.
    pub tag: Option<Name>,
    /// Its alternatives.
    pub arms: Vec<Weighted<Arm>>,
}

/// A grammar as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// The file the text came from, for errors.
    pub path: PathBuf,
    /// The text itself, for errors.
    pub text: String,
    /// Where sentences may start.
    pub start: Vec<Weighted<Name>>,
    /// The shared lists, in the order of the text.
    pub lists: Vec<List>,
    /// The rules, in the order of the text.
    pub rules: Vec<Rule>,
}

impl Tree {
    /// Reads `text`, which came from `path`.
    ///
    /// # Errors
    ///
    /// [`Error::Data`] where the text is not of the form above, and where it has no `start` or a second one.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        Self::of(path.as_ref(), Source { text, difficulty: None })
    }

    /// Reads `text`, which came from `path` and whose weights may depend on the `difficulty`.
    ///
    /// # Errors
    ///
    /// As [`Tree::parse`], and where of a list of choices none has a weight above 0.
    pub fn parse_at(path: impl AsRef<Path>, text: &str, difficulty: f64) -> Result<Self> {
        Self::of(path.as_ref(), Source { text, difficulty: Some(difficulty) })
    }

    fn of(path: &Path, source: Source<'_>) -> Result<Self> {
        let text = source.text;
        let refuse = |at: &str, found: String, expected: &str| {
            Error::data(Place::of(path, text.as_bytes(), source.offset(at)), found, expected)
        };
        let statements = match source.statements(text) {
            Ok((_, statements)) => statements,
            Err(nom::Err::Error(stop) | nom::Err::Failure(stop)) => {
                return Err(refuse(stop.at, found(stop.at), stop.expected));
            }
            Err(nom::Err::Incomplete(_)) => return Err(refuse("", found(""), STATEMENT)),
        };
        let mut tree = Tree {
            path: path.to_owned(),
            text: text.to_owned(),
            start: Vec::new(),
            lists: Vec::new(),
            rules: Vec::new(),
        };
        for statement in statements {
            match statement {
                Statement::Start(at, _) if !tree.start.is_empty() => {
                    return Err(refuse(
                        at,
                        "a second `start`".into(),
                        "one `start` that lists every first nonterminal",
                    ));
                }
                Statement::Start(_, start) => tree.start = start,
                Statement::List(list) => tree.lists.push(list),
                Statement::Rule(rule) => tree.rules.push(rule),
            }
        }
        if tree.start.is_empty() {
            return Err(refuse(
                "",
                "no `start` up to the end of the text".into(),
                "`start` and a nonterminal, such as `start S;`",
            ));
        }
        Ok(tree)
    }

    /// The place of the byte `offset` of the text.
    pub fn place(&self, offset: usize) -> Place {
        Place::of(&self.path, self.text.as_bytes(), offset)
    }
}

const STATEMENT: &str = "`start`, `words` or a rule such as `Noun -> word Verb;`";
const RESERVED: [&str; 3] = ["start", "words", "end"];

enum Statement<'a> {
    Start(&'a str, Vec<Weighted<Name>>),
    List(List),
    Rule(Rule),
}

/// Where reading stopped and what would have let it go on.
struct Stop<'a> {
    at: &'a str,
    expected: &'static str,
}

impl<'a> ParseError<&'a str> for Stop<'a> {
    fn from_error_kind(at: &'a str, _: ErrorKind) -> Self {
        Stop { at, expected: STATEMENT }
    }

    fn append(_: &'a str, _: ErrorKind, other: Self) -> Self {
        other
    }
}

type Read<'a, O> = IResult<&'a str, O, Stop<'a>>;

/// What stands at the start of `at`, for an error: up to twenty characters without white space.
fn found(at: &str) -> String {
    match at.split_whitespace().next() {
        None => "the text ends".into(),
        Some(token) => format!("found `{}`", token.chars().take(20).collect::<String>()),
    }
}

/// White space and comments.
fn blank(i: &str) -> Read<'_, ()> {
    let comment = pair(char('#'), take_while(|c| c != '\n'));
    value((), many0_count(alt((value((), take_while1(char::is_whitespace)), value((), comment))))).parse(i)
}

/// `parser`, then white space and comments.
fn token<'a, O>(
    parser: impl Parser<&'a str, Output = O, Error = Stop<'a>>,
) -> impl Parser<&'a str, Output = O, Error = Stop<'a>> {
    terminated(parser, blank)
}

/// `parser`, which alone can stand here: if it does not, reading ends with what was `expected`.
fn must<'a, O>(
    expected: &'static str,
    mut parser: impl Parser<&'a str, Output = O, Error = Stop<'a>>,
) -> impl FnMut(&'a str) -> Read<'a, O> {
    move |i| match parser.parse(i) {
        Err(nom::Err::Error(_)) => Err(nom::Err::Failure(Stop { at: i, expected })),
        other => other,
    }
}

fn bare(i: &str) -> Read<'_, &str> {
    let letter = satisfy(|c| c.is_alphabetic() || c == '_');
    let inner = |c: char| c.is_alphanumeric() || c == '_' || c == '\'';
    let tail = many0_count(pair(char('-'), take_while1(inner)));
    recognize((letter, take_while(inner), tail)).parse(i)
}

fn quoted(i: &str) -> Read<'_, String> {
    let plain = verify(none_of("\"\\"), |c: &char| !c.is_whitespace() && !c.is_control());
    let escaped = preceded(char('\\'), must("`\\\"` or `\\\\`", one_of("\"\\")));
    let inside = fold_many1(alt((plain, escaped)), String::new, |mut word, c| {
        word.push(c);
        word
    });
    let close = must("`\"` to close the word, which holds no white space", char('"'));
    delimited(char('"'), must("at least one character, none of them white space", inside), close).parse(i)
}

/// A number without a sign.
fn digits(i: &str) -> Read<'_, &str> {
    let exponent = || opt((one_of("eE"), opt(one_of("+-")), digit1));
    let whole = recognize((digit1, opt(pair(char('.'), digit0)), exponent()));
    let fraction = recognize((char('.'), digit1, exponent()));
    alt((whole, fraction)).parse(i)
}

/// A number, or a multiple of `d`: a digit that went straight on with another letter would be a name that lost its `*` or a unit.
fn term(difficulty: f64, i: &str) -> Read<'_, f64> {
    let number = || map(digits, |text| text.parse().unwrap_or(f64::INFINITY));
    let multiple = map(terminated(opt(number()), char('d')), move |times| times.unwrap_or(1.0) * difficulty);
    token(terminated(alt((multiple, number())), not(satisfy(|c| c.is_alphanumeric() || c == '.' || c == '_')))).parse(i)
}

/// `2+3d-1`: nothing, where it is below 0.
fn sum(difficulty: f64, i: &str) -> Read<'_, f64> {
    const TERM: &str = "a number, `d` or a multiple such as `5d`";
    let one = move |i| term(difficulty, i);
    let (i, first) = must(TERM, one).parse(i)?;
    let others = fold_many0(
        (token(one_of("+-")), must(TERM, one)),
        move || first,
        |sum, (sign, term)| if sign == '-' { sum - term } else { sum + term },
    );
    map(verify(others, |sum: &f64| sum.is_finite()), |sum| sum.max(0.0)).parse(i)
}

fn one<T>(item: T) -> Vec<Weighted<T>> {
    vec![Weighted { item, weight: 1.0 }]
}

/// The whole text, against which offsets are counted.
#[derive(Clone, Copy)]
struct Source<'a> {
    text: &'a str,
    /// On which weights may depend; none where they may not.
    difficulty: Option<f64>,
}

impl<'a> Source<'a> {
    /// The byte at which `rest`, a tail of the text, starts.
    fn offset(self, rest: &str) -> usize {
        self.text.len() - rest.len()
    }

    fn at<O: Into<String>>(
        self,
        mut parser: impl Parser<&'a str, Output = O, Error = Stop<'a>>,
    ) -> impl FnMut(&'a str) -> Read<'a, Name> {
        move |i| {
            let (rest, text) = parser.parse(i)?;
            Ok((blank(rest)?.0, Name { text: text.into(), offset: self.offset(i) }))
        }
    }

    /// The weight after `*`, or 1.
    fn weight(self, i: &'a str) -> Read<'a, f64> {
        const WEIGHT: &str = "a weight: a positive finite number such as 3 or 0.5";
        let Ok((i, _)) = token(char('*')).parse(i) else { return Ok((i, 1.0)) };
        if let Some(difficulty) = self.difficulty.filter(|_| i.starts_with('(')) {
            let close = must("`+` or `-` and another term, or `)`", token(char(')')));
            return delimited(token(char('(')), must("a finite sum", move |i| sum(difficulty, i)), close).parse(i);
        }
        // A digit that went straight on with a letter would be a name that lost its `*` or a unit: neither is a weight.
        let number = terminated(digits, not(satisfy(|c| c.is_alphanumeric() || c == '.' || c == '_')));
        let positive = |text: &str| text.parse::<f64>().ok().filter(|w| w.is_finite() && *w > 0.0);
        must(WEIGHT, token(map_opt(number, positive))).parse(i)
    }

    fn weighted<O>(
        self,
        parser: impl Parser<&'a str, Output = O, Error = Stop<'a>>,
    ) -> impl Parser<&'a str, Output = Weighted<O>, Error = Stop<'a>> {
        map(pair(parser, move |i| self.weight(i)), |(item, weight)| Weighted { item, weight })
    }

    /// Without the choices that have no weight at this difficulty.
    fn kept<O>(
        self,
        mut parser: impl Parser<&'a str, Output = Vec<Weighted<O>>, Error = Stop<'a>>,
    ) -> impl FnMut(&'a str) -> Read<'a, Vec<Weighted<O>>> {
        move |i| {
            let (rest, mut choices) = parser.parse(i)?;
            choices.retain(|choice| choice.weight > 0.0);
            if choices.is_empty() {
                return Err(nom::Err::Failure(Stop { at: i, expected: "at every difficulty a weight above 0" }));
            }
            Ok((rest, choices))
        }
    }

    fn nonterminal(self, i: &'a str) -> Read<'a, Name> {
        self.at(verify(bare, |name: &str| !RESERVED.contains(&name))).parse(i)
    }

    fn word(self, i: &'a str) -> Read<'a, Name> {
        alt((self.at(bare), self.at(quoted))).parse(i)
    }

    fn item(self, i: &'a str) -> Read<'a, Item> {
        let list = preceded(char('@'), must("the name of a list straight after `@`", self.at(bare)));
        // A reference stands where its `@` does.
        let list = map(list, |name| Item::List(Name { offset: self.offset(i), ..name }));
        alt((list, map(|i| self.word(i), Item::Word))).parse(i)
    }

    fn target(self, i: &'a str) -> Read<'a, Target> {
        let end = self.at(verify(bare, |name: &str| name == "end"));
        alt((map(end, Target::End), map(|i| self.nonterminal(i), Target::Nonterminal))).parse(i)
    }

    fn braces<O>(
        self,
        expected: &'static str,
        close: &'static str,
        item: impl Fn(&'a str) -> Read<'a, O> + Copy,
    ) -> impl Parser<&'a str, Output = Vec<Weighted<O>>, Error = Stop<'a>> {
        let inside = must(expected, self.kept(many1(self.weighted(item))));
        delimited(token(char('{')), inside, must(close, token(char('}'))))
    }

    fn arm(self, i: &'a str) -> Read<'a, Arm> {
        let words = self.braces(
            "a word or `@` and the name of a list",
            "a word, `@` and the name of a list, `*` and a weight, or `}`",
            move |i| self.item(i),
        );
        let next = self.braces("a nonterminal or `end`", "a nonterminal, `end`, `*` and a weight, or `}`", move |i| {
            self.target(i)
        });
        let words = alt((words, map(|i| self.item(i), one)));
        let next = alt((next, map(|i| self.target(i), one)));
        let (i, words) = must("a word, `@` and the name of a list, or `{`", words).parse(i)?;
        let (i, next) = must("the nonterminal that follows the word, `end` or `{`", next).parse(i)?;
        Ok((i, Arm { words, next }))
    }

    fn start(self, i: &'a str) -> Read<'a, Statement<'a>> {
        let keyword = terminated(tag("start"), not(satisfy(|c| c.is_alphanumeric() || "_'-".contains(c))));
        let (rest, _) = token(keyword).parse(i)?;
        let names = self.kept(many1(self.weighted(|i| self.nonterminal(i))));
        let (rest, start) = must("a nonterminal at which sentences start", names).parse(rest)?;
        let (rest, _) = must("a nonterminal, `*` and a weight, or `;`", token(char(';'))).parse(rest)?;
        Ok((rest, Statement::Start(i, start)))
    }

    fn list(self, i: &'a str) -> Read<'a, Statement<'a>> {
        let keyword = terminated(tag("words"), not(satisfy(|c| c.is_alphanumeric() || "_'-".contains(c))));
        let (i, _) = token(keyword).parse(i)?;
        let (i, name) = must("the name of the list", self.at(bare)).parse(i)?;
        let (i, _) = must("`=`", token(char('='))).parse(i)?;
        let items = self.kept(many1(self.weighted(|i| self.item(i))));
        let (i, items) = must("a word or `@` and the name of a list", items).parse(i)?;
        let (i, _) = must("a word, `@` and the name of a list, `*` and a weight, or `;`", token(char(';'))).parse(i)?;
        Ok((i, Statement::List(List { name, items })))
    }

    fn rule(self, i: &'a str) -> Read<'a, Statement<'a>> {
        let (i, name) = self.nonterminal(i)?;
        let (i, tag_name) =
            opt(preceded(token(char(':')), must("the tag that the nonterminal carries", |i| self.word(i)))).parse(i)?;
        let (i, _) = must("`->`, or `:` and a tag", token(tag("->"))).parse(i)?;
        let arms = |i| {
            let (i, first) = self.weighted(|i| self.arm(i)).parse(i)?;
            fold_many0(
                preceded(token(char('|')), cut(self.weighted(|i| self.arm(i)))),
                || vec![first.clone()],
                |mut arms, arm| {
                    arms.push(arm);
                    arms
                },
            )
            .parse(i)
        };
        let (i, arms) = self.kept(arms).parse(i)?;
        let (i, _) = must("`|`, `*` and a weight, or `;`", token(char(';'))).parse(i)?;
        Ok((i, Statement::Rule(Rule { name, tag: tag_name, arms })))
    }

    fn statements(self, i: &'a str) -> Read<'a, Vec<Statement<'a>>> {
        let (i, _) = blank(i)?;
        let (i, statements) = many0(alt((|i| self.start(i), |i| self.list(i), |i| self.rule(i)))).parse(i)?;
        if i.is_empty() { Ok((i, statements)) } else { Err(nom::Err::Failure(Stop { at: i, expected: STATEMENT })) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const WHOLE: &str = "# a comment\nstart A*2 B; words kin = vel*3 oru \"5\\\"th\";\nA -> { @kin tam*.5 } { B*4e0 end }\
                         | mor A *2;\n\
                         B-x : \",\" -> @kin end; B->oru B-x;#end";

    fn refused(text: &str) -> String {
        Tree::parse("g", text).expect_err(text).to_string()
    }

    #[test]
    fn a_whole_grammar() {
        let tree = Tree::parse("g", WHOLE).expect("well formed");
        assert_eq!(
            tree.start.iter().map(|s| (s.item.text.as_str(), s.weight)).collect::<Vec<_>>(),
            [("A", 2.0), ("B", 1.0)]
        );
        assert_eq!(tree.lists.len(), 1);
        assert_eq!(tree.lists[0].items[0].weight, 3.0);
        let Item::Word(word) = &tree.lists[0].items[2].item else { panic!("a word") };
        assert_eq!((word.text.as_str(), tree.place(word.offset).to_string()), ("5\"th", "g:2:36".to_string()));
        assert_eq!(tree.rules.iter().map(|rule| rule.arms.len()).collect::<Vec<_>>(), [2, 1, 1]);
        let arms = &tree.rules[0].arms;
        assert_eq!((arms[0].weight, arms[1].weight), (1.0, 2.0));
        assert_eq!((arms[0].item.words[1].weight, arms[0].item.next[0].weight), (0.5, 4.0));
        assert!(matches!(&arms[0].item.next[1].item, Target::End(_)));
        assert_eq!(tree.rules[1].name.text, "B-x");
        assert_eq!(tree.rules[1].tag.as_ref().map(|tag| tag.text.as_str()), Some(","));
    }

    #[test]
    fn every_error_tells_place_finding_and_expectation() {
        let cases = [
            ("", "g:1:1: no `start` up to the end of the text; expected `start` and a nonterminal, such as `start S;`"),
            ("A -> a end;", "g:1:12: no `start` up"),
            ("start A; start B;", "g:1:10: a second `start`; expected one `start`"),
            ("= 3", "g:1:1: found `=`; expected `start`, `words` or a rule"),
            ("start ;", "g:1:7: found `;`; expected a nonterminal at which sentences start"),
            ("start end;", "g:1:7: found `end;`; expected a nonterminal at which"),
            ("start A", "g:1:8: the text ends; expected a nonterminal, `*` and a weight, or `;`"),
            ("start A*;", "g:1:9: found `;`; expected a weight: a positive finite number"),
            ("start A*0;", "g:1:9: found `0;`; expected a weight"),
            ("start A*-1;", "g:1:9: found `-1;`; expected a weight"),
            ("start A*1e999;", "g:1:9: found `1e999;`; expected a weight"),
            ("start A*1e-999;", "g:1:9: found `1e-999;`; expected a weight"),
            ("start A*nan;", "g:1:9: found `nan;`; expected a weight"),
            ("start A*2x;", "g:1:9: found `2x;`; expected a weight"),
            ("words = a;", "g:1:7: found `=`; expected the name of the list"),
            ("words w a;", "g:1:9: found `a;`; expected `=`"),
            ("words w = ;", "g:1:11: found `;`; expected a word or `@`"),
            ("words w = a, b;", "g:1:12: found `,`; expected a word, `@`"),
            ("words w = @ ;", "g:1:12: the text ends"),
            ("A a end;", "g:1:3: found `a`; expected `->`, or `:` and a tag"),
            ("A : -> a end;", "g:1:5: found `->`; expected the tag"),
            ("end -> a end;", "g:1:1: found `end`; expected `start`, `words` or a rule"),
            ("A -> ;", "g:1:6: found `;`; expected a word, `@` and the name of a list, or `{`"),
            ("A -> a;", "g:1:7: found `;`; expected the nonterminal that follows the word, `end` or `{`"),
            ("A -> a*2 A;", "g:1:7: found `*2`; expected the nonterminal that follows"),
            ("A -> { } A;", "g:1:8: found `}`; expected a word or `@` and the name of a list"),
            (
                "A -> { a -> end;",
                "g:1:10: found `->`; expected a word, `@` and the name of a list, `*` and a weight, or `}`",
            ),
            ("A -> a { };", "g:1:10: found `};`; expected a nonterminal or `end`"),
            ("A -> a { A \"b\" };", "g:1:12: found `\"b\"`; expected a nonterminal, `end`"),
            ("A -> a A B;", "g:1:10: found `B;`; expected `|`, `*` and a weight, or `;`"),
            ("A -> a A |;", "g:1:11: found `;`; expected a word"),
            ("A -> \"\" A;", "g:1:7: found `\"`; expected at least one character"),
            ("A -> \"a b\" A;", "g:1:8: found `b\"`; expected `\"` to close the word"),
            ("A -> \"a\\n\" A;", "g:1:9: found `n\"`; expected `\\\"` or `\\\\`"),
            ("# é\nA -> é \"ü\" *", "g:2:8: found `\"ü\"`; expected the nonterminal that follows"),
        ];
        for (text, expected) in cases {
            let error = refused(text);
            assert!(
                error.starts_with(expected.trim_end_matches("the text ends")),
                "{text:?}: {error}\n  not {expected}"
            );
            assert!(error.contains("; expected "), "{error}");
        }
    }

    proptest! {
        #[test]
        fn no_text_is_a_panic(text in "[A-c0-9 *@{}|:;>\"\\\\#.\n-]{0,60}|\\PC{0,40}") {
            let _ = Tree::parse("g", &text);
        }

        /// A whole grammar with one character replaced is read or refused with a place inside the text.
        #[test]
        fn no_slip_is_a_panic(at in 0..WHOLE.len(), slip in "[A-c0-9 *@{}|:;>\"\\\\#.\n-]?") {
            let mut text = WHOLE.to_owned();
            text.replace_range(at..at + 1, &slip);
            if let Err(Error::Data { place, .. }) = Tree::parse("g", &text) {
                prop_assert!(place.line <= text.lines().count().max(1) + 1);
            }
        }
    }
}
