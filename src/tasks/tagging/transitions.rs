//! Which label may follow which.

use crate::space::{Action, Actions};
use serde::{Deserialize, Serialize};

/// A rule about the order of labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// Every label may follow every other.
    Free,
    /// IOB2: an I-X only after a B-X or an I-X.
    Bio,
}

/// The labels that may follow each label.
#[derive(Clone, Debug)]
pub struct Transitions {
    order: Order,
    labels: usize,
    /// For [`Order::Bio`]: `after[y]`, and last what may start a sentence.
    after: Vec<Box<[Action]>>,
    /// For [`Order::Bio`]: whether label y may follow x, at `x * labels + y`; x is the number of labels at the start of a sentence.
    allowed: Vec<bool>,
    /// The span type of each label; labels of one type are kin.
    kinds: Vec<u32>,
}

/// A label's prefix and type: `("B", "NP")` for `B-NP`.
fn split(label: &str) -> (&str, &str) {
    label.split_once('-').unwrap_or((label, ""))
}

impl Transitions {
    /// The transitions between labels of these names.
    pub fn new(order: Order, names: &[String]) -> Self {
        let kinds = names
            .iter()
            .map(|name| names.iter().position(|other| split(other).1 == split(name).1).unwrap_or(0) as u32)
            .collect();
        let rule = |before: Option<&str>, after: &str| {
            let (prefix, kind) = split(after);
            prefix != "I" || before.map(split).is_some_and(|(p, k)| k == kind && (p == "B" || p == "I"))
        };
        let befores = names.iter().map(|name| Some(name.as_str())).chain([None]);
        let allowed: Vec<bool> = match order {
            Order::Free => Vec::new(),
            Order::Bio => befores.flat_map(|before| names.iter().map(move |name| rule(before, name))).collect(),
        };
        let list = |row: &[bool]| (0..).zip(row).filter(|(_, may)| **may).map(|(y, _)| Action(y)).collect();
        let after = allowed.chunks(names.len().max(1)).map(list).collect();
        Transitions { order, labels: names.len(), after, allowed, kinds }
    }

    /// The same labels without any order.
    pub fn freed(&self) -> Self {
        Transitions { order: Order::Free, after: Vec::new(), allowed: Vec::new(), ..self.clone() }
    }

    /// The order that labels of these names suggest: IOB2 where every name is `O`, `B-X` or `I-X`, with at least one `I-X`.
    pub fn suggest(names: &[String]) -> Order {
        let spans = names.iter().all(|name| name == "O" || name.starts_with("B-") || name.starts_with("I-"));
        if spans && names.iter().any(|name| name.starts_with("I-")) { Order::Bio } else { Order::Free }
    }

    /// The rule.
    pub fn order(&self) -> Order {
        self.order
    }

    /// What stands for "no label yet", before a sentence's first.
    pub fn begin(&self) -> u32 {
        self.labels as u32
    }

    /// The labels that may follow `previous`.
    #[inline]
    pub fn after(&self, previous: u32) -> Actions<'_> {
        match self.order {
            Order::Free => Actions::All(self.labels as u32),
            Order::Bio => Actions::Only(&self.after[previous as usize]),
        }
    }

    /// Whether `label` may follow `previous`.
    #[inline]
    pub fn allows(&self, previous: u32, label: u32) -> bool {
        match self.order {
            Order::Free => true,
            Order::Bio => self.allowed[previous as usize * self.labels + label as usize],
        }
    }

    /// Whether some label may follow every other, and one may come first: without that a sentence could not be finished.
    pub fn go_on(&self) -> bool {
        (0..=self.begin()).all(|previous| !self.after(previous).is_empty())
    }

    /// Whether two labels differ in nothing but their prefix.
    pub fn kin(&self, a: u32, b: u32) -> bool {
        self.kinds[a as usize] == self.kinds[b as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bio() {
        let names: Vec<String> = ["B-NP", "B-VP", "I-NP", "I-VP", "O"].map(String::from).into();
        assert_eq!(Transitions::suggest(&names), Order::Bio);
        let transitions = Transitions::new(Order::Bio, &names);
        let after = |y| transitions.after(y).iter().map(|a| names[a.index()].as_str()).collect::<Vec<_>>();
        assert_eq!(after(0), ["B-NP", "B-VP", "I-NP", "O"]);
        assert_eq!(after(3), ["B-NP", "B-VP", "I-VP", "O"]);
        assert_eq!(after(4), ["B-NP", "B-VP", "O"]);
        assert_eq!(after(transitions.begin()), ["B-NP", "B-VP", "O"]);
        assert!(transitions.kin(0, 2) && !transitions.kin(0, 1));
    }

    #[test]
    fn other_names_are_free() {
        let names: Vec<String> = ["DET", "NOUN"].map(String::from).into();
        assert_eq!(Transitions::suggest(&names), Order::Free);
        assert_eq!(Transitions::new(Order::Free, &names).after(0).len(), 2);
    }
}
