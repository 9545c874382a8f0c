//! The systems and their experts against brute force over everything that can be done, on all trees of few words.

use super::state::{NONE, ROOT};
use super::tabular::Table;
use super::tree::{projective, projectivise};
use super::*;
use crate::learner::Logistic;
use crate::policy::{Greedy, Linear};
use crate::read::conllu;
use crate::roll::perform;
use crate::seed::Seed;
use crate::space::{Action, CostToGo, Episode, Expert, Imitation, Silent, Space};
use crate::trainer::{Dagger, Run};
use rayon::prelude::*;
use std::collections::HashMap;

/// The heads of all trees of `n` words with one root.
fn trees(n: usize) -> Vec<Vec<u32>> {
    let choices = n as u32 + 1;
    let all = (0..choices.pow(n as u32)).map(|code| {
        let head = |w: usize| code / choices.pow(w as u32) % choices;
        (0..n).map(|w| head(w).checked_sub(1).unwrap_or(ROOT)).collect::<Vec<u32>>()
    });
    all.filter(|heads| is_tree(heads)).collect()
}

/// Whether one word is the root and all others come to it from head to head.
fn is_tree(heads: &[u32]) -> bool {
    let ends = |mut w: u32| {
        for _ in 0..heads.len() {
            match heads[w as usize] {
                ROOT => return true,
                head => w = head,
            }
        }
        false
    };
    heads.iter().filter(|head| **head == ROOT).count() == 1 && (0..heads.len() as u32).all(ends)
}

/// Whether no two arcs cross, the root's from the left included: another definition than that of the crate.
fn crossing_free(heads: &[u32]) -> bool {
    let arcs: Vec<(usize, usize)> = heads
        .iter()
        .enumerate()
        .map(|(w, head)| {
            if *head == ROOT { (0, w + 1) } else { ((*head as usize + 1).min(w + 1), (*head as usize + 1).max(w + 1)) }
        })
        .collect();
    arcs.iter().all(|(a, b)| arcs.iter().all(|(c, d)| !(a < c && c < b && b < d)))
}

/// The trees as text that was read; word w has the label w modulo `labels`.
fn bank(trees: &[Vec<u32>], labels: usize) -> conllu::Treebank {
    let mut text = String::new();
    for heads in trees {
        for (w, head) in heads.iter().enumerate() {
            let (head, label) = if *head == ROOT { (0, "root".into()) } else { (head + 1, format!("l{}", w % labels)) };
            text += &format!("{}\tw{w}\t_\tX\tY\t_\t{head}\t{label}\t_\t_\n", w + 1);
        }
        text.push('\n');
    }
    conllu::parse(text.as_bytes(), "trees".as_ref(), 1).expect("trees")
}

/// The trees as a space of `system`.
fn space(trees: &[Vec<u32>], system: System, labels: usize) -> Parsing {
    Encoding::learn(&bank(trees, labels), &Settings { system, cutoff: 1 }).expect("a treebank").1
}

/// Finds the lowest cost from every configuration that can be reached, by trying everything.
struct Search<'a> {
    space: &'a Parsing,
    known: HashMap<Configuration, f64>,
    /// The lowest cost of ways on without swaps, where it was asked for.
    unswapped: HashMap<Configuration, f64>,
    /// Configurations in [disorder](disorder), or not in it, and those in which the expert's answer was not best.
    visited: [usize; 2],
    worse: [usize; 2],
}

impl Search<'_> {
    fn best(&mut self, state: &Configuration) -> f64 {
        if state.finished() {
            assert!(self.space.legal(state).is_empty());
            let arcs: Vec<u32> = state.arcs().map(|(head, _)| head.checked_sub(1).unwrap_or(ROOT)).collect();
            assert!(is_tree(&arcs), "{arcs:?}");
            return 0.0;
        }
        if let Some(known) = self.known.get(state) {
            return *known;
        }
        let space = self.space;
        let legal = space.legal(state);
        assert!(!legal.is_empty(), "a dead end: {state:?}");
        let costs = self.each(state, Self::best);
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        let answer = GoldTree.action(space, state).expect("the trees are known");
        let place = legal.place(answer).expect("the answer is legal");
        let which = usize::from(space.system == System::ArcStandardSwap && disorder(space, state));
        self.visited[which] += 1;
        self.worse[which] += usize::from(costs[place] > least);
        let mut found = Vec::new();
        let steps = GoldTree.foresee(space, state, &mut found);
        if space.system != System::ArcStandardSwap || state.nodes.len() < 5 {
            let mut tried = 0;
            let trials = self.each(state, |search, next| {
                let (actions, cost) = way(search.space, next.clone());
                tried += actions.len() as u64 + 1;
                cost
            });
            assert_eq!((&found, steps), (&trials, Some(tried)), "{state:?}");
        }
        if space.system != System::ArcStandardSwap {
            assert_eq!(found, costs, "{state:?}");
        } else if sorted(space, state) {
            let costs = self.each(state, Self::without_swaps);
            let exact = |i: &usize| legal.nth(*i) != SWAP;
            assert!((0..costs.len()).filter(exact).all(|i| found[i] == costs[i]), "{found:?} {costs:?} {state:?}");
        }
        self.known.insert(state.clone(), least);
        least
    }

    fn without_swaps(&mut self, state: &Configuration) -> f64 {
        if state.finished() {
            return 0.0;
        }
        if let Some(known) = self.unswapped.get(state) {
            return *known;
        }
        let costs = self.each(state, Self::without_swaps);
        let legal = self.space.legal(state);
        let others = costs.iter().zip(legal.iter()).filter(|(_, action)| *action != SWAP);
        let least = others.map(|(cost, _)| *cost).fold(f64::INFINITY, f64::min);
        self.unswapped.insert(state.clone(), least);
        least
    }

    /// What each legal action costs, if `rest` is the cost from then on.
    fn each(&mut self, state: &Configuration, mut rest: impl FnMut(&mut Self, &Configuration) -> f64) -> Vec<f64> {
        let space = self.space;
        let cost = |action| {
            let mut next = state.clone();
            let cost = space.step(&mut next, action, Seed::new(0));
            cost + rest(self, &next)
        };
        space.legal(state).iter().map(cost).collect()
    }
}

const SWAP: Action = Action(Move::Swap as u32);

/// The words without a head, those on the stack first.
fn line(state: &Configuration) -> Vec<u32> {
    let buffer = (0..).map(|k| state.buffered(k)).take_while(|w| *w != NONE);
    state.stack.iter().copied().chain(buffer).collect()
}

/// Whether no words that are left need to be swapped.
fn sorted(space: &Parsing, state: &Configuration) -> bool {
    line(state).is_sorted_by_key(|w| space.trees.order[(state.first + w) as usize])
}

/// Whether words have been swapped that stand in the right order, or something has been shifted onto two words that stand in the wrong one or
/// that should have been joined: neither can be undone.
fn disorder(space: &Parsing, state: &Configuration) -> bool {
    let order = |w: u32| space.trees.order[(state.first + w) as usize];
    let line = line(state);
    let buried = state.stack.len().saturating_sub(1);
    let misplaced = (0..line.len())
        .any(|i| (i + 1..line.len()).any(|j| order(line[i]) > order(line[j]) && (line[i] > line[j] || j < buried)));
    let head = |w: u32| space.ancestor(state, w);
    let complete = |w: u32| state.nodes[w as usize].open == 0;
    let due = |pair: &[u32]| {
        let (below, top) = (pair[0], pair[1]);
        let headless = head(below) == ROOT && head(top) == ROOT;
        head(below) == top && complete(below) || complete(top) && (head(top) == below || headless)
    };
    misplaced || state.stack[..buried].windows(2).any(due)
}

/// Configurations seen, in order and in disorder, and those of each in which the expert was not optimal.
fn search(trees: &[Vec<u32>], system: System, labels: usize) -> ([usize; 2], [usize; 2]) {
    let space = space(trees, system, labels);
    let one = |(index, heads): (usize, &Vec<u32>)| {
        let (known, unswapped) = (HashMap::new(), HashMap::new());
        let mut search = Search { space: &space, known, unswapped, worse: [0; 2], visited: [0; 2] };
        let start = space.start(Episode { index, seed: Seed::new(0) });
        assert_eq!(search.best(&start), 0.0, "{heads:?} cannot be made");
        (search.visited, search.worse)
    };
    let add = |a: [usize; 2], b: [usize; 2]| [a[0] + b[0], a[1] + b[1]];
    let none = || ([0; 2], [0; 2]);
    trees.par_iter().enumerate().map(one).reduce(none, |a, b| (add(a.0, b.0), add(a.1, b.1)))
}

#[test]
fn all_trees_are_counted() {
    // n^(n-1) rooted trees (Cayley), of which 1, 2, 7, 30, 143 are projective.
    let counts: Vec<(usize, usize)> =
        (1..=5).map(|n| (trees(n).len(), trees(n).iter().filter(|heads| projective(heads)).count())).collect();
    assert_eq!(counts, [(1, 1), (2, 2), (9, 7), (64, 30), (625, 143)]);
    assert!((1..=5).flat_map(trees).all(|heads| projective(&heads) == crossing_free(&heads)));
}

/// In every configuration that any moves and labels lead to, on every projective tree: costs-to-go are those of brute force, and so the
/// answer is optimal; every end is a tree with one root.
#[test]
fn the_projective_oracles_are_optimal_on_all_trees_of_five_words() {
    for (n, labels) in [(1, 1), (2, 2), (3, 2), (4, 1), (5, 1)] {
        let trees: Vec<_> = trees(n).into_iter().filter(|heads| projective(heads)).collect();
        for system in [System::ArcHybrid, System::ArcStandard] {
            let (visited, worse) = search(&trees, system, labels);
            println!("{n} words: {worse:?} of {visited:?}");
            assert_eq!((visited[1], worse), (0, [0; 2]), "{system:?}, {n} words");
        }
    }
}

/// The fast ways agree with the table, on trees too large to try everything: costs do in every configuration that noisy walks come through, and who follows
/// the answers pays what the table says.
#[test]
fn costs_are_those_of_the_table_on_random_trees() {
    let mut draws = 0;
    let mut draw = |n: usize| {
        draws += 1;
        (Seed::new(7).child(crate::seed::Purpose::Sentence, draws).unit() * n as f64) as usize
    };
    let trees: Vec<Vec<u32>> = (0..600).map(|_| random_tree(14, &mut draw)).collect();
    let space = space(&trees, System::ArcStandard, 1);
    let (mut table, mut found, mut astray) = (Table::default(), Vec::new(), 0);
    for (index, heads) in trees.iter().enumerate() {
        let mut state = space.start(Episode { index, seed: Seed::new(0) });
        while !state.finished() {
            let legal = space.legal(&state);
            table.read(heads, &state, None);
            let least = f64::from(table.least(heads).expect("a small table"));
            GoldTree.costs(&space, &state, &mut found);
            let answer = GoldTree.action(&space, &state).expect("the trees are known");
            assert_eq!(found.iter().copied().fold(f64::INFINITY, f64::min), least, "{state:?}");
            assert_eq!(found[legal.place(answer).expect("legal")], least, "{state:?}");
            astray += usize::from(state.astray);
            let action = if draw(10) < 7 { answer } else { legal.nth(draw(legal.len())) };
            space.step(&mut state, action, Seed::new(0));
        }
    }
    assert!(astray > 1000, "{astray}");
}

/// While too many words are left for a table the expert does without, and what is foreseen there are its trials all the same.
#[test]
fn long_ways_are_foreseen_as_they_go() {
    let mut draws = 0;
    let mut draw = |n: usize| {
        draws += 1;
        (Seed::new(8).child(crate::seed::Purpose::Sentence, draws).unit() * n as f64) as usize
    };
    let trees: Vec<Vec<u32>> = (0..3).map(|_| random_tree(300, &mut draw)).collect();
    let (mut table, mut found, mut beyond) = (Table::default(), Vec::new(), 0);
    for system in [System::ArcStandard, System::ArcStandardSwap] {
        let space = space(&trees, system, 1);
        for (index, heads) in trees.iter().enumerate() {
            let mut state = space.start(Episode { index, seed: Seed::new(0) });
            for step in 0..250 {
                let legal = space.legal(&state);
                if step % 50 == 49 {
                    let steps = GoldTree.foresee(&space, &state, &mut found);
                    let ways = legal.iter().map(|action| {
                        let mut next = state.clone();
                        let cost = space.step(&mut next, action, Seed::new(0));
                        let (actions, rest) = way(&space, next);
                        (cost + rest, actions.len() as u64 + 1)
                    });
                    let (costs, lengths): (Vec<f64>, Vec<u64>) = ways.unzip();
                    assert_eq!((&found, steps), (&costs, Some(lengths.iter().sum())));
                    table.read(heads, &state, None);
                    beyond += usize::from(state.astray && table.least(heads).is_none());
                }
                let answer = GoldTree.action(&space, &state).expect("the trees are known");
                let action = if draw(10) < 8 { answer } else { legal.nth(draw(legal.len())) };
                space.step(&mut state, action, Seed::new(0));
            }
        }
    }
    assert!(beyond > 3, "{beyond}");
}

/// Words joined two by two, neighbour to neighbour: every projective tree may come of it.
fn random_tree(n: usize, draw: &mut impl FnMut(usize) -> usize) -> Vec<u32> {
    let (mut heads, mut line) = (vec![ROOT; n], (0..n as u32).collect::<Vec<_>>());
    while line.len() > 1 {
        let i = draw(line.len() - 1);
        let (dependent, head) = if draw(2) == 0 { (i, i + 1) } else { (i + 1, i) };
        heads[line[dependent] as usize] = line[head];
        line.remove(dependent);
    }
    heads
}

/// With swaps the answer is optimal wherever there is no [disorder](disorder), on every tree of up to five words; and in nine of ten
/// configurations where there is.
#[test]
fn the_swap_oracle_is_optimal_where_there_is_no_disorder() {
    for n in 1..=5 {
        let (visited, worse) = search(&trees(n), System::ArcStandardSwap, 1);
        println!("{n} words: {worse:?} of {visited:?}");
        assert_eq!(worse[0], 0, "{n} words: {visited:?}");
        assert!(worse[1] * 10 <= visited[1], "{n} words: {worse:?} of {visited:?}");
    }
}

/// What the expert does from `state` on, and what that costs.
fn way(space: &Parsing, mut state: Configuration) -> (Vec<Action>, f64) {
    let (mut actions, mut cost) = (Vec::new(), 0.0);
    while !state.finished() {
        let answer = GoldTree.action(space, &state).expect("the trees are known");
        assert!(space.legal(&state).contains(answer));
        cost += space.step(&mut state, answer, Seed::new(0));
        actions.push(answer);
    }
    (actions, cost)
}

/// The same from the start of sentence `index`.
fn experts_way(space: &Parsing, index: usize) -> (Vec<Action>, f64) {
    way(space, space.start(Episode { index, seed: Seed::new(0) }))
}

/// From the start the static oracle without swaps makes every projective tree too.
#[test]
fn the_arc_standard_oracle_makes_all_projective_trees() {
    let trees: Vec<_> = (1..=5).flat_map(trees).filter(|heads| projective(heads)).collect();
    let space = space(&trees, System::ArcStandard, 2);
    for index in 0..trees.len() {
        let (actions, cost) = experts_way(&space, index);
        assert_eq!((cost, Some(actions.len())), (0.0, space.horizon(index)));
    }
}

/// With swaps it makes every tree, and swaps no two words of one part.
#[test]
fn the_swap_oracle_makes_all_trees() {
    let trees: Vec<_> = (1..=6).flat_map(trees).collect();
    let space = space(&trees, System::ArcStandardSwap, 2);
    for (index, heads) in trees.iter().enumerate() {
        let (actions, cost) = experts_way(&space, index);
        assert_eq!(cost, 0.0, "{heads:?}");
        assert_eq!(actions.contains(&SWAP), !projective(heads), "{heads:?}");
    }
}

/// Lifting leaves projective trees alone, makes all others projective, and only ever lifts.
#[test]
fn lifted_trees_are_projective() {
    for heads in (1..=5).flat_map(trees) {
        let mut lifted = heads.clone();
        projectivise(&mut lifted);
        assert!(is_tree(&lifted) && crossing_free(&lifted), "{heads:?} {lifted:?}");
        assert_eq!(lifted == heads, crossing_free(&heads));
        for (w, head) in lifted.iter().enumerate() {
            let mut above = heads[w];
            while above != *head {
                above = heads[above as usize];
            }
        }
    }
    // By hand: 1 <- 3 crosses 2 <- 4, both of length 2; the leftmost goes to the head of 3, which is 4.
    let mut heads = vec![2, 3, 3, ROOT];
    projectivise(&mut heads);
    assert_eq!(heads, [3, 3, 3, ROOT]);
}

/// Long sentences neither overflow nor take quadratic time where they are projective.
#[test]
fn long_sentences() {
    let n = 50_000;
    let chain: Vec<u32> = (0..n).map(|w| if w == 0 { ROOT } else { w - 1 }).collect();
    let turned: Vec<u32> = (0..n).map(|w| if w + 1 == n { ROOT } else { w + 1 }).collect();
    for system in [System::ArcHybrid, System::ArcStandard, System::ArcStandardSwap] {
        let space = space(&[chain.clone(), turned.clone()], system, 1);
        for index in 0..2 {
            let mut state = space.start(Episode { index, seed: Seed::new(0) });
            let mut cost = 0.0;
            while let Some(action) = GoldTree.action(&space, &state).filter(|_| !state.finished()) {
                cost += space.step(&mut state, action, Seed::new(0));
            }
            assert_eq!(cost, 0.0);
        }
    }
}

#[test]
fn what_is_absent_costs_nothing() {
    let mut space = space(&trees(3), System::ArcHybrid, 1);
    space.trees = Default::default();
    let mut state = space.start(Episode { index: 4, seed: Seed::new(0) });
    assert_eq!((GoldTree.action(&space, &state), state.pending), (None, NONE));
    let mut steps = 0;
    while !space.legal(&state).is_empty() {
        let action = space.legal(&state).nth(0);
        assert_eq!(space.step(&mut state, action, Seed::new(0)), 0.0);
        steps += 1;
    }
    assert_eq!(Some(steps), space.horizon(4));
}

/// Whatever the numbers are, what was learned does the same in any sentence.
#[test]
fn new_features_change_nothing_by_themselves() {
    let (first, more) = (bank(&trees(3), 2), bank(&trees(4), 2));
    let settings = Settings { system: System::ArcStandardSwap, cutoff: 1 };
    let (encoding, space) = Encoding::learn(&first, &settings).expect("a treebank");
    let trained = Dagger::default().train_online(&space.problem(), &Logistic::default(), &Run::new(1));
    let Greedy(before) = trained.expect("settings in range").policy;
    let (extended, space, moved) = encoding.extend(&more).expect("the same labels");
    assert!(extended.features() > encoding.features() && moved.len() == extended.features());
    assert_eq!(space.sentences(), more.sentences());
    let after = Linear { weights: before.weights.clone().renumber(&moved), ..before.clone() };
    for bank in [&first, &more] {
        let done = |encoding: &Encoding, linear: &Linear| {
            let space = encoding.apply(bank).expect("few words");
            perform(&Imitation { episodes: space.sentences(), space, expert: Silent }, &Greedy(linear), Seed::new(1))
                .0
                .actions
        };
        assert!(done(&encoding, &before) == done(&extended, &after));
    }
}
