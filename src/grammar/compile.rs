//! From syntax tree to checked, flat tables.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

use ndarray::{Array1, Array2};

use super::generate::{Wheel, Wheels};
use super::graph::Automaton;
use super::{Emitters, Grammar, Tag, Word, chain};
use crate::error::{Error, Result};
use crate::read::grammar::{Item, Name, Rule, Target, Tree, Weighted};

/// The most words that may be expected from any nonterminal.
pub const LONGEST: f64 = 1e6;

/// The most nonterminals a grammar may have: its tables grow with their square, the time to solve it with their cube.
pub const MOST: usize = 1000;

/// Words with their shares, by index; the shares sum to 1.
type Shares = BTreeMap<usize, f64>;

/// A tree, and numbers for the names in it.
struct Names<'a> {
    tree: &'a Tree,
    nonterminals: BTreeMap<&'a str, usize>,
    words: BTreeMap<&'a str, usize>,
    texts: Vec<&'a str>,
    tags: BTreeMap<&'a str, usize>,
    tag_names: Vec<&'a str>,
}

/// The number of `name`, which is the next one if it has none yet.
fn intern<'a>(numbers: &mut BTreeMap<&'a str, usize>, names: &mut Vec<&'a str>, name: &'a str) -> usize {
    *numbers.entry(name).or_insert_with(|| {
        names.push(name);
        names.len() - 1
    })
}

impl<'a> Names<'a> {
    fn refuse<T>(&self, name: &Name, problem: impl Into<String>, expected: impl Into<String>) -> Result<T> {
        Err(Error::data(self.tree.place(name.offset), problem, expected))
    }

    /// `choices` with the share of each; refuses a share that is nothing in floating point.
    fn shares<'t, T>(&self, choices: &'t [Weighted<T>], at: &Name) -> Result<Vec<(&'t T, f64)>> {
        let total: f64 = choices.iter().map(|choice| choice.weight).sum();
        let shares: Vec<_> = choices.iter().map(|choice| (&choice.item, choice.weight / total)).collect();
        if shares.iter().all(|&(_, share)| share > 0.0) { Ok(shares) } else { self.apart(at) }
    }

    fn apart<T>(&self, at: &Name) -> Result<T> {
        let problem = format!("in `{}` a weight is too small beside the others to count", at.text);
        self.refuse(at, problem, "shares above 1e-308 and a sum below 1e308")
    }

    /// The number of the nonterminal that `name` refers to.
    fn nonterminal(&self, name: &Name) -> Result<usize> {
        match self.nonterminals.get(name.text.as_str()) {
            Some(&a) => Ok(a),
            None => {
                let problem = format!("nonterminal `{}` is not defined", name.text);
                self.refuse(name, problem, format!("a rule `{} -> ...;` somewhere", name.text))
            }
        }
    }

    /// Adds `choice` with its share to a list, in which it must not stand already.
    fn once(&self, shares: &mut Shares, (choice, share): (usize, f64), name: &Name) -> Result<()> {
        match shares.insert(choice, share) {
            None => Ok(()),
            Some(_) => self.twice(name, &name.text),
        }
    }

    fn twice<T>(&self, name: &Name, choice: &str) -> Result<T> {
        self.refuse(name, format!("`{choice}` a second time in one list"), "one weight for each choice")
    }

    /// The words of a list, where `lists` are the shared ones so far.
    fn words(
        &mut self,
        items: &'a [Weighted<Item>],
        at: &Name,
        lists: &mut BTreeMap<&'a str, Shared<'a>>,
    ) -> Result<Shares> {
        let (mut own, mut seen, mut sum) = (Shares::new(), BTreeSet::new(), Shares::new());
        for (item, share) in self.shares(items, at)? {
            match item {
                Item::Word(word) => {
                    let w = intern(&mut self.words, &mut self.texts, &word.text);
                    self.once(&mut own, (w, share), word)?;
                }
                Item::List(name) => {
                    let Some(list) = lists.get_mut(name.text.as_str()) else {
                        let problem = format!("no list `{}` so far", name.text);
                        return self.refuse(name, problem, format!("`words {} = ...;` further up", name.text));
                    };
                    if !seen.insert(&name.text) {
                        return self.twice(name, &format!("@{}", name.text));
                    }
                    list.used = true;
                    for (&w, &part) in &list.shares {
                        *sum.entry(w).or_insert(0.0) += share * part;
                    }
                }
            }
        }
        for (w, share) in own {
            *sum.entry(w).or_insert(0.0) += share;
        }
        if sum.values().all(|&share| share > 0.0) { Ok(sum) } else { self.apart(at) }
    }
}

/// A shared list of words.
struct Shared<'a> {
    name: &'a Name,
    shares: Shares,
    used: bool,
}

/// All arms, in the order of the text, with numbers for names.
struct Arms {
    owner: Vec<usize>,
    share: Vec<f64>,
    words: Vec<Shares>,
    next: Vec<Shares>,
}

/// Checks a tree and freezes it.
pub(super) fn compile(tree: &Tree) -> Result<Grammar> {
    let mut names = define(tree)?;
    let arms = arms(&mut names)?;
    let start = start(&names)?;
    let tag_of = tree.rules.iter().map(|rule| Tag(names.tags[carried(rule)] as u32)).collect();

    let states = tree.rules.len();
    let mut next = Array2::zeros((arms.owner.len(), states + 1));
    let mut step = Array2::<f64>::zeros((states, states + 1));
    for (k, &a) in arms.owner.iter().enumerate() {
        for (&b, &chance) in &arms.next[k] {
            next[[k, b]] = chance;
            step[[a, b]] += arms.share[k] * chance;
            if step[[a, b]] <= 0.0 {
                return names.apart(&tree.rules[a].name);
            }
        }
    }
    let automaton = automaton(&names, &start, &step)?;
    let expected = chain::solve(&start, step.view());
    if let Some(a) = expected.length.iter().position(|&length| length.is_nan() || length > LONGEST) {
        let name = &tree.rules[a].name;
        let problem = format!("{:.3e} words are expected from `{}` on", expected.length[a], name.text);
        return names.refuse(name, problem, format!("at most {LONGEST:e}, with more weight on ways to the end"));
    }
    Ok(Grammar {
        words: names.texts.iter().map(|&text| text.to_owned()).collect(),
        index: names.words.iter().map(|(&text, &w)| (text.to_owned(), Word(w as u32))).collect(),
        tags: names.tag_names.iter().map(|&name| name.to_owned()).collect(),
        automaton,
        tag_of,
        emitters: emitters(&names, &arms)?,
        wheels: wheels(&start, &arms, states),
        owner: arms.owner,
        start,
        next,
        visits: expected.visits,
    })
}

/// The tag that a rule's nonterminal carries.
fn carried(rule: &Rule) -> &str {
    &rule.tag.as_ref().unwrap_or(&rule.name).text
}

/// Numbers the nonterminals and the tags; refuses a second definition.
fn define(tree: &Tree) -> Result<Names<'_>> {
    let mut names = Names {
        tree,
        nonterminals: BTreeMap::new(),
        words: BTreeMap::new(),
        texts: Vec::new(),
        tags: BTreeMap::new(),
        tag_names: Vec::new(),
    };
    if let Some(rule) = tree.rules.get(MOST) {
        return names.refuse(&rule.name, format!("one nonterminal more than {MOST}"), "fewer nonterminals");
    }
    for (a, rule) in tree.rules.iter().enumerate() {
        match names.nonterminals.entry(&rule.name.text) {
            Entry::Vacant(entry) => entry.insert(a),
            Entry::Occupied(entry) => {
                let line = tree.place(tree.rules[*entry.get()].name.offset).line;
                let problem = format!("a second rule for `{}`, which line {line} defines", rule.name.text);
                return names.refuse(&rule.name, problem, "one rule, with `|` between its alternatives");
            }
        };
        intern(&mut names.tags, &mut names.tag_names, carried(rule));
    }
    Ok(names)
}

fn start(names: &Names<'_>) -> Result<Array1<f64>> {
    let mut start = Shares::new();
    let at = Name { text: "start".into(), offset: names.tree.start.first().map_or(0, |first| first.item.offset) };
    for (name, share) in names.shares(&names.tree.start, &at)? {
        names.once(&mut start, (names.nonterminal(name)?, share), name)?;
    }
    Ok((0..names.tree.rules.len()).map(|a| start.get(&a).copied().unwrap_or(0.0)).collect())
}

/// The shared lists, then all arms; refuses a list that is never used.
fn arms(names: &mut Names<'_>) -> Result<Arms> {
    let tree = names.tree;
    let mut lists: BTreeMap<&str, Shared<'_>> = BTreeMap::new();
    for list in &tree.lists {
        let shares = names.words(&list.items, &list.name, &mut lists)?;
        if lists.insert(&list.name.text, Shared { name: &list.name, shares, used: false }).is_some() {
            return names.refuse(&list.name, format!("a second list `{}`", list.name.text), "one list of each name");
        }
    }
    let mut arms = Arms { owner: Vec::new(), share: Vec::new(), words: Vec::new(), next: Vec::new() };
    for (a, rule) in tree.rules.iter().enumerate() {
        for (arm, share) in names.shares(&rule.arms, &rule.name)? {
            let mut next = Shares::new();
            for (target, chance) in names.shares(&arm.next, &rule.name)? {
                match target {
                    Target::Nonterminal(name) => names.once(&mut next, (names.nonterminal(name)?, chance), name)?,
                    Target::End(name) => names.once(&mut next, (tree.rules.len(), chance), name)?,
                }
            }
            arms.owner.push(a);
            arms.share.push(share);
            arms.words.push(names.words(&arm.words, &rule.name, &mut lists)?);
            arms.next.push(next);
        }
    }
    match lists.values().find(|list| !list.used) {
        Some(list) => names.refuse(
            list.name,
            format!("list `{}` is never used", list.name.text),
            "a rule that draws from it, or no list",
        ),
        None => Ok(arms),
    }
}

/// The graph; refuses nonterminals that no sentence reaches or from which none ends.
fn automaton(names: &Names<'_>, start: &Array1<f64>, step: &Array2<f64>) -> Result<Automaton> {
    let rules = &names.tree.rules;
    let mut automaton = Automaton::new(rules.iter().map(|rule| rule.name.text.as_str()));
    for (a, &chance) in start.iter().enumerate().filter(|&(_, &chance)| chance > 0.0) {
        automaton.add_start(a, chance);
    }
    for ((a, b), &chance) in step.indexed_iter().filter(|&(_, &chance)| chance > 0.0) {
        automaton.add_step(a, b, chance);
    }
    if let Some(a) = automaton.unreachable() {
        let name = &rules[a].name;
        return names.refuse(
            name,
            format!("no sentence reaches nonterminal `{}`", name.text),
            "a way to it from `start`",
        );
    }
    if let Some(a) = automaton.endless() {
        let name = &rules[a].name;
        return names.refuse(
            name,
            format!("no sentence ends from nonterminal `{}` on", name.text),
            "a way from it to `end`",
        );
    }
    Ok(automaton)
}

fn emitters(names: &Names<'_>, arms: &Arms) -> Result<Emitters> {
    let mut rows = vec![Vec::new(); names.texts.len()];
    for (k, words) in arms.words.iter().enumerate() {
        for (&w, &share) in words {
            let share = arms.share[k] * share;
            if share <= 0.0 {
                return names.apart(&names.tree.rules[arms.owner[k]].name);
            }
            rows[w].push((k, share));
        }
    }
    let mut emitters = Emitters { offsets: vec![0], arms: Vec::new(), shares: Vec::new() };
    for row in rows {
        for (k, share) in row {
            emitters.arms.push(k);
            emitters.shares.push(share);
        }
        emitters.offsets.push(emitters.arms.len());
    }
    Ok(emitters)
}

fn wheels(start: &Array1<f64>, arms: &Arms, states: usize) -> Wheels {
    let mut wheels = Wheels { start: Wheel::new(), arm: Wheel::new(), word: Wheel::new(), next: Wheel::new() };
    wheels.start.push(start.iter().copied().enumerate());
    let mut k = 0;
    for a in 0..states {
        let first = k;
        while arms.owner.get(k) == Some(&a) {
            k += 1;
        }
        wheels.arm.push((first..k).map(|k| (k, arms.share[k])));
    }
    for (words, next) in arms.words.iter().zip(&arms.next) {
        wheels.word.push(words.iter().map(|(&w, &share)| (w, share)));
        wheels.next.push(next.iter().map(|(&b, &share)| (b, share)));
    }
    wheels
}
