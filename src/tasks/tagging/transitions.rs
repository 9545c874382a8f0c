//! Which label may follow which.

use crate::space::{Action, Actions};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// A rule about the order of labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// Every label may follow every other.
    Free,
    /// IOB2: an I-X only after a B-X or an I-X.
    Bio,
    /// BILOU: a span is one U-X, or a B-X, any number of I-X and an L-X. S-X and E-X mean the same as U-X and L-X, so IOBES is this order, too.
    Bilou,
}

impl Order {
    /// Its name, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Order::Free => "free",
            Order::Bio => "iob2",
            Order::Bilou => "bilou",
        }
    }
}

/// The labels that may follow each label.
#[derive(Clone, Debug)]
pub struct Transitions {
    order: Order,
    labels: usize,
    /// What the order says, where there is one: inside a sentence, and for its last token.
    rows: Option<[Rows; 2]>,
    /// The span type of each label; labels of one type are kin.
    kinds: Vec<u32>,
    /// The labels of each type, in ascending order.
    alike: Vec<Vec<Action>>,
}

/// What may follow each label, in the order of their numbers, and last what may start a sentence.
#[derive(Clone, Debug)]
struct Rows {
    allowed: Vec<Vec<bool>>,
    /// The same as lists.
    lists: Vec<Box<[Action]>>,
    /// The labels that may follow every other, and come first.
    anywhere: Vec<bool>,
    /// Those, and the labels that may follow a label that may follow every other.
    near: Vec<bool>,
}

impl Rows {
    /// What is `allowed` after each label, which itself may follow those that `before` allows, or these.
    fn of(allowed: Vec<Vec<bool>>, before: Option<&Rows>) -> Self {
        let list = |row: &Vec<bool>| (0..).zip(row).filter(|(_, may)| **may).map(|(y, _)| Action(y)).collect();
        let labels = 0..allowed[0].len();
        let anywhere: Vec<bool> = labels.clone().map(|y| allowed.iter().all(|row| row[y])).collect();
        let open = before.map_or(&anywhere, |rows| &rows.anywhere);
        let near = labels.clone().map(|y| anywhere[y] || labels.clone().any(|x| open[x] && allowed[x][y])).collect();
        Rows { lists: allowed.iter().map(list).collect(), near, anywhere, allowed }
    }
}

/// A label's prefix and type: `("B", "NP")` for `B-NP`.
fn split(label: &str) -> (&str, &str) {
    label.split_once('-').unwrap_or((label, ""))
}

/// Whether a prefix says that a span goes on from the token before.
fn goes_on(prefix: &str) -> bool {
    matches!(prefix, "I" | "L" | "E")
}

impl Transitions {
    /// The transitions between labels of these names.
    pub fn new(order: Order, names: &[String]) -> Self {
        let (mut numbers, mut kinds, mut alike) = (HashMap::new(), Vec::new(), Vec::new());
        for (label, name) in (0..).zip(names) {
            let kind = *numbers.entry(split(name).1).or_insert(alike.len());
            alike.resize(alike.len().max(kind + 1), Vec::new());
            alike[kind].push(Action(label));
            kinds.push(kind as u32);
        }
        let closes = |name: &String, kind: &str| matches!(split(name), ("L" | "E", k) if k == kind);
        // The type of the span that is open after a label. In BILOU none is opened that could not be closed again.
        let open = |name: &str| {
            let (prefix, kind) = split(name);
            let opens = matches!(prefix, "B" | "I");
            (opens && (order != Order::Bilou || names.iter().any(|name| closes(name, kind)))).then_some(kind.to_owned())
        };
        let may_follow = |before: Option<&str>, after: &str, end: bool| {
            let (prefix, kind) = split(after);
            let inside = before.and_then(open);
            match order {
                Order::Free => true,
                Order::Bio => prefix != "I" || inside.as_deref() == Some(kind),
                Order::Bilou if matches!(prefix, "B" | "I") && (end || open(after).is_none()) => false,
                Order::Bilou => inside.as_deref() == goes_on(prefix).then_some(kind),
            }
        };
        let befores = names.iter().map(|name| Some(name.as_str())).chain([None]);
        let table = |end: bool, before: Option<&Rows>| {
            let row = |before: Option<&str>| names.iter().map(|name| may_follow(before, name, end)).collect();
            Rows::of(befores.clone().map(row).collect(), before)
        };
        let rows = (order != Order::Free).then(|| {
            let inside = table(false, None);
            let last = table(true, Some(&inside));
            [inside, last]
        });
        Transitions { order, labels: names.len(), rows, kinds, alike }
    }

    /// The same labels without any order.
    pub fn freed(&self) -> Self {
        Transitions { order: Order::Free, rows: None, ..self.clone() }
    }

    /// The order that labels of these names suggest, where every one is `O` or a prefix and a type: BILOU with at least one `L-X`, `U-X`, `E-X` or
    /// `S-X`, else IOB2 with at least one `I-X`.
    pub fn suggest(names: &[String]) -> Order {
        let prefix = |name: &String| name.split_once('-').map(|(prefix, _)| prefix.to_owned());
        let spans = |name: &String| name == "O" || prefix(name).is_some_and(|p| "BILEUS".contains(&p) && p.len() == 1);
        let any = |wanted: &str| names.iter().filter_map(prefix).any(|p| wanted.contains(&p));
        match names.iter().all(spans) {
            true if any("LEUS") => Order::Bilou,
            true if any("I") => Order::Bio,
            _ => Order::Free,
        }
    }

    /// The rule.
    pub fn order(&self) -> Order {
        self.order
    }

    /// What stands for "no label yet", before a sentence's first.
    pub fn begin(&self) -> u32 {
        self.labels as u32
    }

    /// The labels that may follow `previous` where `left` tokens are still without a label, the one that gets it counted; at least one.
    #[inline]
    pub fn after(&self, previous: u32, left: u32) -> Actions<'_> {
        self.rows(left).map_or(Actions::All(self.labels as u32), |rows| Actions::Only(&rows.lists[previous as usize]))
    }

    #[inline]
    fn rows(&self, left: u32) -> Option<&Rows> {
        self.rows.as_ref().map(|rows| &rows[usize::from(left == 1)])
    }

    /// Whether `label` may follow `previous` there.
    #[inline]
    pub fn allows(&self, previous: u32, label: u32, left: u32) -> bool {
        self.rows(left).is_none_or(|rows| rows.allowed[previous as usize][label as usize])
    }

    /// Whether `label` may follow whatever stands before it there.
    #[inline]
    pub fn allows_anywhere(&self, label: u32, left: u32) -> bool {
        self.rows(left).is_none_or(|rows| rows.anywhere[label as usize])
    }

    /// Whether `label` may follow whatever stands before it there, or may follow a label that may: from anywhere, it is at most one other label away.
    #[inline]
    pub fn is_near(&self, label: u32, left: u32) -> bool {
        self.rows(left).is_none_or(|rows| rows.near[label as usize])
    }

    /// Whether some label may follow every other, one may come first, and a sentence may end everywhere or in one label more: without that it could
    /// not be finished.
    pub fn go_on(&self) -> bool {
        (0..=self.begin()).all(|previous| (1..=2).all(|left| !self.after(previous, left).is_empty()))
    }

    /// Whether two labels differ in nothing but their prefix.
    pub fn kin(&self, a: u32, b: u32) -> bool {
        self.kinds[a as usize] == self.kinds[b as usize]
    }

    /// The labels of which that is so with this one, in ascending order, itself among them.
    pub(super) fn alike(&self, label: u32) -> &[Action] {
        &self.alike[self.kinds[label as usize] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    /// What may follow each label, and what may come first.
    fn follow(transitions: &Transitions, names: &[String], left: u32) -> Vec<String> {
        let after =
            |y| transitions.after(y, left).iter().map(|a| names[a.index()].as_str()).collect::<Vec<_>>().join(" ");
        (0..=transitions.begin()).map(after).collect()
    }

    #[test]
    fn bio() {
        let names = names(&["B-NP", "B-VP", "I-NP", "I-VP", "O"]);
        assert_eq!(Transitions::suggest(&names), Order::Bio);
        let transitions = Transitions::new(Order::Bio, &names);
        let (np, vp, out) = ("B-NP B-VP I-NP O", "B-NP B-VP I-VP O", "B-NP B-VP O");
        for left in [1, 2] {
            assert_eq!(follow(&transitions, &names, left), [np, vp, np, vp, out, out]);
        }
        assert!(transitions.go_on());
        assert!(transitions.kin(0, 2) && !transitions.kin(0, 1));
        assert_eq!(transitions.alike(2), [Action(0), Action(2)]);
    }

    #[test]
    fn bilou() {
        let names = names(&["B-A", "B-B", "I-A", "L-A", "O", "U-B"]);
        assert_eq!(Transitions::suggest(&names), Order::Bilou);
        let transitions = Transitions::new(Order::Bilou, &names);
        // No L-B was seen: a B-B could never be finished.
        let (out, inside) = ("B-A O U-B", "I-A L-A");
        assert_eq!(follow(&transitions, &names, 2), [inside, out, inside, out, out, out, out]);
        let (out, inside) = ("O U-B", "L-A");
        assert_eq!(follow(&transitions, &names, 1), [inside, out, inside, out, out, out, out]);
        assert!(transitions.go_on());
    }

    /// The same with other letters; and where there is nothing for a single token outside, sentences could not be finished.
    #[test]
    fn iobes() {
        let both = [names(&["B-A", "E-A", "I-A", "O", "S-A"]), names(&["B-A", "L-A", "I-A", "O", "U-A"])];
        let found = both.each_ref().map(|names| {
            assert_eq!(Transitions::suggest(names), Order::Bilou);
            let transitions = Transitions::new(Order::Bilou, names);
            [1, 2].map(|left| follow(&transitions, names, left).join("/").replace('E', "L").replace('S', "U"))
        });
        assert_eq!(found[0], found[1]);
        assert!(!Transitions::new(Order::Bilou, &names(&["B-A", "L-A"])).go_on());
    }

    #[test]
    fn other_names_are_free() {
        for other in [&["DET", "NOUN"][..], &["B-A", "O"], &["O"], &["B-A", "I-A", "X-A"], &["BI-A", "U-A"]] {
            assert_eq!(Transitions::suggest(&names(other)), Order::Free, "{other:?}");
        }
        assert_eq!(Transitions::new(Order::Free, &names(&["DET", "NOUN"])).after(0, 1).len(), 2);
    }
}
