//! Laws of the theory on random small problems: every bound holds, every identity is one, fast recursions agree with
//! enumeration.
//!
//! Costs and probabilities are small fractions with many zeros, so that unreachable states, ties and deterministic
//! chains are common. Nothing here is a statistical test: a failure is a counterexample.

use ndarray::{Array1, Array2, Array3, Axis};
use proptest::collection::vec;
use proptest::prelude::*;
use rollin::theory::audit::audit;
use rollin::theory::bounds::{self, Bound};
use rollin::theory::closed;
use rollin::theory::counts::{Counts, Plan};
use rollin::theory::forward::Forward;
use rollin::theory::instance::Instance;
use rollin::theory::korder::{laws, orders};
use rollin::theory::mixing::{Mixing, Proposal, Smile};
use rollin::theory::population::Class;
use rollin::theory::reuse::Reuse;
use rollin::theory::{Evaluation, Mdp, Parts, Table, evaluate, instances};
use serde_json::{Value, json};

/// 2,000 random problems a law, or as many as PROPTEST_CASES says.
fn config() -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(2_000);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

/// Picked by hand: tiny, usual, with alpha T above 1, and the whole.
const RATES: [f64; 10] = [1e-6, 1.0 / 64.0, 0.0625, 0.1, 0.125, 0.25, 0.375, 0.5, 0.8, 1.0];

/// Integer weights as a distribution; all zeros are the first outcome.
fn normal(weights: &[u8]) -> Vec<f64> {
    let sum: u32 = weights.iter().map(|w| u32::from(*w)).sum();
    let one =
        |(i, w): (usize, &u8)| if sum == 0 { f64::from(u8::from(i == 0)) } else { f64::from(*w) / f64::from(sum) };
    weights.iter().enumerate().map(one).collect()
}

fn distribution(n: usize) -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![vec(0u8..5, n), vec(prop_oneof![3 => Just(0u8), 1 => Just(1u8)], n)]
        .prop_map(|weights| normal(&weights))
}

fn table(states: usize, actions: usize) -> impl Strategy<Value = Table> {
    let rows = vec(distribution(actions), states);
    rows.prop_map(move |rows| {
        let rows = Array2::from_shape_fn((states, actions), |(s, a)| rows[s][a]);
        Table::new("table", rows).expect("distributions")
    })
}

/// A problem of at most `most` = (S, A, T); its expert is random, the worst at every step or the best.
fn problem(most: (usize, usize, usize)) -> impl Strategy<Value = Mdp> {
    (1..=most.0, 1..=most.1, 1..=most.2).prop_flat_map(|(states, actions, horizon)| {
        let next = vec(distribution(states), states * actions);
        let cost =
            vec(prop_oneof![Just(0.0), Just(1.0), (0u8..=16).prop_map(|c| f64::from(c) / 16.0)], states * actions);
        let expert = vec(0..actions, states);
        (distribution(states), next, cost, expert, 0..3).prop_map(move |(start, next, cost, mut expert, kind)| {
            let at = |s: usize, a: usize| cost[s * actions + a];
            for (s, choice) in expert.iter_mut().enumerate() {
                let by_cost = |a: &usize, b: &usize| at(s, *a).total_cmp(&at(s, *b));
                match kind {
                    0 => *choice = (0..actions).max_by(by_cost).expect("an action"),
                    1 => *choice = (0..actions).min_by(by_cost).expect("an action"),
                    _ => {}
                }
            }
            let next = Array3::from_shape_fn((states, actions, states), |(s, a, to)| next[s * actions + a][to]);
            let cost = Array2::from_shape_fn((states, actions), |(s, a)| at(s, a));
            Mdp::new(Parts { horizon, start: Array1::from(start), next, cost, expert }).expect("a problem")
        })
    })
}

/// A problem and up to `tables` policies.
fn cast(
    most: (usize, usize, usize),
    tables: std::ops::RangeInclusive<usize>,
) -> impl Strategy<Value = (Mdp, Vec<Table>)> {
    problem(most).prop_flat_map(move |mdp| {
        let hats = vec(table(mdp.states(), mdp.actions()), tables.clone());
        (Just(mdp), hats)
    })
}

/// A problem and one policy a step.
fn ladder(most: (usize, usize, usize)) -> impl Strategy<Value = (Mdp, Vec<Table>)> {
    problem(most).prop_flat_map(|mdp| {
        let tables = vec(table(mdp.states(), mdp.actions()), mdp.horizon());
        (Just(mdp), tables)
    })
}

fn rate() -> impl Strategy<Value = f64> {
    proptest::sample::select(&RATES[..])
}

fn holds(bound: &Bound) -> Result<(), TestCaseError> {
    prop_assert!(bound.slack.is_finite() && bound.holds(), "{bound:?}");
    Ok(())
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs()).max(1.0)
}

fn close(a: &Array2<f64>, b: &Array2<f64>) -> bool {
    a.dim() == b.dim() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12)
}

/// The probability and cost of every trajectory, visited one by one: J and d^t with nothing shared between them.
fn enumerate(mdp: &Mdp, tables: &[&Table]) -> (f64, Array2<f64>) {
    fn walk(
        mdp: &Mdp,
        tables: &[&Table],
        (t, s): (usize, usize),
        (mass, cost): (f64, f64),
        out: &mut (f64, Array2<f64>),
    ) {
        if mass == 0.0 {
            return;
        }
        let Some(table) = tables.get(t) else {
            out.0 += mass * cost;
            return;
        };
        out.1[[t, s]] += mass;
        for (a, p) in table.rows().row(s).iter().enumerate() {
            for to in 0..mdp.states() {
                let mass = mass * p * mdp.next()[[s, a, to]];
                walk(mdp, tables, (t + 1, to), (mass, cost + mdp.cost()[[s, a]]), out);
            }
        }
    }
    let mut out = (0.0, Array2::zeros((tables.len(), mdp.states())));
    for (s, p) in mdp.start().iter().enumerate() {
        walk(mdp, tables, (0, s), (*p, 0.0), &mut out);
    }
    out
}

/// All subsets of 0..n as bit masks, by size.
fn subsets(n: usize, size: usize) -> Vec<u32> {
    (0..1u32 << n).filter(|mask| mask.count_ones() as usize == size).collect()
}

/// The state distributions of this choice of tables, one a step.
fn visits(mdp: &Mdp, tables: &[&Table]) -> Array2<f64> {
    evaluate(mdp, tables).expect("fitting tables").visits
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn theorem_2_1_holds((mdp, tables) in cast((5, 4, 8), 1..=1)) {
        let printed = bounds::theorem_2_1(&mdp, &tables[0]).unwrap();
        let sharp = bounds::theorem_2_1_sharp(&mdp, &tables[0]).unwrap();
        holds(&printed)?;
        holds(&sharp)?;
        prop_assert!(sharp.rhs <= printed.rhs + 1e-12 * printed.rhs.max(1.0));
    }

    #[test]
    fn forward_training_obeys_section_3((mdp, tables) in ladder((5, 4, 8))) {
        let forward = Forward::of(&mdp, &tables).unwrap();
        for bound in bounds::of_forward(&forward) {
            if bound.applies() {
                holds(&bound)?;
            }
        }
        prop_assert!(bounds::theorem_3_1(&forward).slack.abs() <= 1e-12 * mdp.horizon() as f64);
        prop_assert!(near(forward.last(), evaluate(&mdp, tables.as_slice()).unwrap().cost));
        // The imitation loss as cost: nothing is lost.
        let imitation = Forward::of(&mdp.imitation(), &tables).unwrap();
        prop_assert!(near(imitation.last(), imitation.errors.iter().sum()));
        prop_assert!(imitation.stakes.iter().all(|u| *u == 0.0 || *u == 1.0));
    }

    #[test]
    fn smile_obeys_section_4((mdp, hats) in cast((5, 4, 8), 1..=4), rate in rate()) {
        let smile = Smile::of(&mdp, &hats, rate).unwrap();
        for n in 1..=hats.len() {
            for k in 1..=mdp.horizon() {
                holds(&bounds::lemma_4_1(&smile.mixing, n, k))?;
            }
            holds(&bounds::lemma_4_2(&smile.mixing, n))?;
            holds(&bounds::lemma_4_2_half(&smile.mixing, n))?;
            holds(&bounds::lemma_4_2_sharp(&smile.mixing, n))?;
            holds(&bounds::theorem_4_1(&smile, n))?;
            holds(&bounds::coupling(&smile, n))?;
            holds(&bounds::difference(&smile, n))?;
            let (all, own) = (smile.bounds(n), smile.mixing.cost(n));
            for rhs in [all.B_paper_pi, all.B_coup_pi, all.B_coup_eps_pi, all.B_pdl_pi] {
                prop_assert!(own <= rhs + 1e-12 * rhs.abs().max(1.0));
            }
            prop_assert!(all.W_tilde <= (mdp.horizon() as f64).powi(2) * all.eps_tilde + 1e-12);
            prop_assert!(all.A_tilde.abs() <= mdp.horizon() as f64 * all.eps_tilde + 1e-12);
        }
    }

    #[test]
    fn searn_obeys_its_bounds((mdp, hats) in cast((5, 4, 8), 1..=4), rate in rate()) {
        let mixing = Mixing::of(&mdp, Proposal::Searn, &hats, rate).unwrap();
        for n in 1..=hats.len() {
            holds(&bounds::searn(&mixing, n))?;
            holds(&bounds::conservative(&mixing, n))?;
            holds(&bounds::lemma_4_2_sharp(&mixing, n))?;
            for k in 1..=mdp.horizon() {
                holds(&bounds::lemma_4_1(&mixing, n, k))?;
            }
        }
        // SEARN's weights are SMILe's, the other way round.
        let smile = Mixing::of(&mdp, Proposal::Smile, &hats, rate).unwrap();
        let mut mirrored = smile.weights(hats.len());
        mirrored[1..].reverse();
        prop_assert!(mixing.weights(hats.len()).iter().zip(&mirrored).all(|(a, b)| near(*a, *b)));
    }

    #[test]
    fn explicit_theorems_hold_at_their_rates((mdp, hats) in cast((3, 3, 4), 1..=3)) {
        let horizon = mdp.horizon();
        let square = 1.0 / (horizon * horizon) as f64;
        let printed = closed::alpha_printed(horizon);
        let ours = (square, closed::rounds_inverse_square(horizon));
        for (rate, rounds) in [ours, (printed, closed::rounds_printed(horizon))] {
            if rate > 1.0 {
                // The printed rate at T = 1.
                continue;
            }
            let n = rounds.ceil().max(1.0) as usize;
            let hats: Vec<Table> = hats.iter().cycle().take(n).cloned().collect();
            let smile = Smile::of(&mdp, &hats, rate).unwrap();
            let (ours, theirs) = (bounds::inverse_square(&smile, n), bounds::theorem_4_1_printed(&smile, n));
            if rate == square && horizon > 1 {
                prop_assert!(ours.applies());
                holds(&ours)?;
            }
            if rate == printed {
                prop_assert!(theirs.applies());
                holds(&theirs)?;
            }
        }
    }

    #[test]
    fn a_safe_step_improves((mdp, tables) in cast((4, 3, 6), 1..=1)) {
        let gain = orders(&mdp, &mdp.star(), &tables[0]).unwrap().disadvantages[1];
        let Some((step, promise)) = bounds::safe_step(gain, mdp.horizon()) else {
            prop_assert!(gain >= 0.0 || mdp.horizon() == 1);
            return Ok(());
        };
        if step > 1e-12 {
            let mixing = Mixing::of(&mdp, Proposal::Searn, &tables, step).unwrap();
            prop_assert!(mixing.cost(1) <= mixing.expert_cost() - promise + 1e-12);
        }
    }

    #[test]
    fn the_best_of_a_class_is_best(mdp in problem((3, 3, 4)), view in vec(0usize..3, 3), rate in rate()) {
        let view = &view[..mdp.states()];
        let class = Class::new(&mdp, view).unwrap();
        let (states, actions) = (mdp.states(), mdp.actions());
        let all: Vec<Table> = (0..actions.pow(3)).map(|code| {
            let choice: Vec<usize> = view.iter().map(|seen| code / actions.pow(*seen as u32) % actions).collect();
            Table::deterministic(&choice, actions).unwrap()
        }).collect();
        let miss = |table: &Table, visits: &Array1<f64>| -> f64 {
            (0..states).map(|s| visits[s] * (1.0 - table.rows()[[s, mdp.expert()[s]]])).sum()
        };
        let star = evaluate(&mdp, &mdp.star()).unwrap().mean();
        let supervised = class.supervised().unwrap().0;
        prop_assert!(all.iter().all(|other| miss(&supervised, &star) <= miss(other, &star) + 1e-11));
        // The second round of SEARN minimises Jbar_1 against the first round's mixture.
        let searn: Vec<Table> = class.searn(rate, 2).unwrap().into_iter().map(|(table, _)| table).collect();
        let mixing = Mixing::of(&mdp, Proposal::Searn, &searn, rate).unwrap();
        let deviate = |table| orders(&mdp, &mixing.policies[1], table).unwrap().costs[1];
        let best = deviate(&searn[1]);
        prop_assert!(all.iter().all(|other| best <= deviate(other) + 1e-11));
        // And of SMILe the 0-1 loss.
        let smile: Vec<Table> = class.smile(rate, 2).unwrap().into_iter().map(|(table, _)| table).collect();
        let mean = Mixing::of(&mdp, Proposal::Smile, &smile, rate).unwrap().evaluations[1].mean();
        prop_assert!(all.iter().all(|other| miss(&smile[1], &mean) <= miss(other, &mean) + 1e-11));
    }

    #[test]
    fn mixtures_are_sums_over_orders((mdp, tables) in cast((5, 4, 8), 2..=2), rate in rate()) {
        let orders = orders(&mdp, &tables[0], &tables[1]).unwrap();
        let mixture = Table::mixture(&[(1.0 - rate, &tables[0]), (rate, &tables[1])]).unwrap();
        let own = evaluate(&mdp, &mixture).unwrap();
        let mass = closed::binomial(mdp.horizon(), rate, 1.0 - rate);
        let sum: f64 = mass.iter().zip(&orders.costs).map(|(p, cost)| p * cost).sum();
        prop_assert!(near(own.cost, sum), "{} for {sum}", own.cost);
        prop_assert!(near(orders.costs[0], evaluate(&mdp, &tables[0]).unwrap().cost));
        prop_assert!(near(orders.costs[mdp.horizon()], evaluate(&mdp, &tables[1]).unwrap().cost));
        let laws = laws(&mdp, &tables[0], &tables[1]).unwrap();
        let mut sum = Array2::zeros((mdp.horizon(), mdp.states()));
        for (p, law) in mass.iter().zip(laws.outer_iter()) {
            sum.scaled_add(*p, &law);
        }
        prop_assert!(close(&sum, &own.visits));
        prop_assert!(close(&laws.mean_axis(Axis(1)).unwrap(), &orders.frequencies));
        // The printed recursion and the closed weights are the same policy.
        let smile = Smile::of(&mdp, &tables, rate).unwrap();
        for n in 1..=2 {
            let mixing = &smile.mixing;
            let recursion = mixing.policies[n - 1].rows() * (1.0 - rate) + mixing.proposals[n - 1].rows() * rate;
            prop_assert!(close(&recursion, mixing.policies[n].rows()));
            prop_assert!(near(mixing.orders[n - 1].disadvantages[1], mixing.kept[n - 1] * smile.given_expert[n - 1]));
        }
        // At k = T Lemma 4.1 is an equality.
        for n in 1..=2 {
            let slack = bounds::lemma_4_1(&smile.mixing, n, mdp.horizon()).slack;
            prop_assert!(slack.abs() <= 1e-12 * mdp.horizon() as f64);
        }
    }

    #[test]
    fn repaired_reuse_is_exact((mdp, hats) in cast((4, 3, 8), 1..=3), rate in rate()) {
        let smile = Smile::of(&mdp, &hats, rate).unwrap();
        let reuse = Reuse::of(&mdp, &smile.mixing, &hats).unwrap();
        for n in 1..=hats.len() {
            let keep = closed::kept(rate, mdp.horizon());
            let first = &reuse.truth[n - 1] * keep + &reuse.exact42[n - 1] * reuse.fresh42[n - 1];
            prop_assert!(close(&first, &reuse.truth[n]));
            let mut second = &reuse.truth[0] * reuse.split[n - 1][0];
            for k in 1..=mdp.horizon() {
                let beta = reuse.older[n - 1].powi(k as i32);
                let mut bucket = &reuse.exact43[n - 1].index_axis(Axis(0), k - 1) * (1.0 - beta);
                if n > 1 {
                    bucket.scaled_add(beta, &reuse.by_count[n - 2].index_axis(Axis(0), k));
                }
                prop_assert!(close(&bucket, &reuse.by_count[n - 1].index_axis(Axis(0), k).to_owned()));
                second.scaled_add(reuse.split[n - 1][k], &bucket);
            }
            prop_assert!(close(&second, &reuse.truth[n]));
            // How far the printed data sets can be off, at most: total variation of the labels.
            let worst = |law: &Array2<f64>| {
                let gaps = (law - &reuse.truth[n]).mapv(f64::abs);
                gaps.sum_axis(Axis(1)).iter().fold(0.0f64, |most, gap| most.max(gap / 2.0))
            };
            prop_assert!(worst(&reuse.chain42[n]) <= closed::drift42(mdp.horizon(), rate, n) + 1e-12);
            prop_assert!(worst(&reuse.chain43[n]) <= closed::drift43(mdp.horizon(), rate, n) + 1e-12);
            if n == 1 || mdp.horizon() == 1 {
                prop_assert!(close(&reuse.lemma43[n - 1], &reuse.truth[n]));
            }
        }
    }

    #[test]
    fn printed_reuse_is_wrong_where_it_should_be(horizon in 2usize..=8, rate in 0.001f64..0.999) {
        let (mdp, [stay, leave]) = instances::departure(horizon).unwrap();
        let law = |hats: &[Table]| {
            let smile = Smile::of(&mdp, hats, rate).unwrap();
            Reuse::of(&mdp, &smile.mixing, hats).unwrap()
        };
        let (once, twice) = (law(std::slice::from_ref(&leave)), law(&[stay, leave]));
        let excess = |found: &Array2<f64>, truth: &Array2<f64>| found[[1, 1]] - truth[[1, 1]];
        let (first, second) = (excess(&once.onestep42[0], &once.truth[1]), excess(&twice.lemma43[1], &twice.truth[2]));
        prop_assert!(first > 0.0 && second > 0.0);
        if horizon == 2 {
            prop_assert!(near(once.truth[1][[1, 1]], rate));
            prop_assert!(near(first, rate * rate * (1.0 - rate) / 2.0));
            prop_assert!(near(twice.truth[2][[1, 1]], rate * (1.0 - rate)));
            prop_assert!(near(second, (rate * (1.0 - rate)).powi(2) / (2.0 * (2.0 - rate))));
        }
        prop_assert!(closed::overuse42(horizon, rate) > 1.0 && closed::overuse42(horizon, rate) < 1.299);
    }

    #[test]
    fn evaluation_agrees_with_enumeration((mdp, tables) in ladder((3, 3, 4))) {
        let own = evaluate(&mdp, tables.as_slice()).unwrap();
        let (cost, visits) = enumerate(&mdp, &tables.iter().collect::<Vec<_>>());
        prop_assert!(near(own.cost, cost) && close(&own.visits, &visits));
        consistent(&mdp, &tables, &own)?;
    }

    #[test]
    fn orders_agree_with_enumeration((mdp, tables) in cast((3, 2, 4), 2..=2)) {
        let orders = orders(&mdp, &tables[0], &tables[1]).unwrap();
        let laws = laws(&mdp, &tables[0], &tables[1]).unwrap();
        let horizon = mdp.horizon();
        for k in 0..=horizon {
            let (mut cost, mut law) = (0.0, Array2::zeros((horizon, mdp.states())));
            let sites = subsets(horizon, k);
            for mask in &sites {
                let acting: Vec<&Table> = (0..horizon).map(|t| &tables[(mask >> t & 1) as usize]).collect();
                let one = enumerate(&mdp, &acting);
                cost += one.0 / sites.len() as f64;
                law.scaled_add(1.0 / sites.len() as f64, &one.1);
            }
            prop_assert!(near(orders.costs[k], cost));
            prop_assert!(close(&laws.index_axis(Axis(0), k).to_owned(), &law));
        }
    }

    #[test]
    fn reuse_agrees_with_enumeration((mdp, hats) in cast((3, 2, 4), 2..=2), rate in rate()) {
        let smile = Smile::of(&mdp, &hats, rate).unwrap();
        let reuse = Reuse::of(&mdp, &smile.mixing, &hats).unwrap();
        let (mixing, horizon) = (&smile.mixing, mdp.horizon());
        // Algorithm 4.2 at round 2: the step of the classifier, uniform or the first.
        let zeros = || Array2::zeros((horizon, mdp.states()));
        let (mut printed, mut exact) = (zeros(), zeros());
        let [old, hat, now] = [&mixing.policies[1], &mixing.proposals[1], &mixing.policies[2]];
        for tau in 0..horizon {
            let acting = |before| -> Vec<&Table> {
                (0..horizon).map(|t| if t < tau { before } else if t == tau { hat } else { now }).collect()
            };
            printed.scaled_add(1.0 / horizon as f64, &visits(&mdp, &acting(now)));
            let weight = rate * (1.0 - rate).powi(tau as i32) / closed::gone(rate, horizon);
            exact.scaled_add(weight, &visits(&mdp, &acting(old)));
        }
        prop_assert!(close(&printed, &reuse.printed42[1]) && close(&exact, &reuse.exact42[1]));
        // Algorithm 4.3 at round 2: every set of sites, every assignment of the newest classifier to some of them.
        let (star, old, new) = (&mixing.policies[0], &mixing.unsupervised[0], &mixing.unsupervised[1]);
        let beta = reuse.older[1];
        for k in 1..=horizon {
            let (mut printed, mut exact) = (zeros(), zeros());
            let sites = subsets(horizon, k);
            for mask in &sites {
                for newest in 1..1u32 << horizon {
                    if newest & !mask != 0 {
                        continue;
                    }
                    let acting = |other| {
                        let who = |t: usize| match (mask >> t & 1, newest >> t & 1) {
                            (0, _) => star,
                            (_, 0) => other,
                            _ => &hats[1],
                        };
                        (0..horizon).map(who).collect::<Vec<&Table>>()
                    };
                    let x = newest.count_ones() as i32;
                    if x == 1 {
                        printed.scaled_add(1.0 / (k * sites.len()) as f64, &visits(&mdp, &acting(new)));
                    }
                    let mass = (1.0 - beta).powi(x) * beta.powi(k as i32 - x) / (1.0 - beta.powi(k as i32));
                    // At a rate of 1 nobody draws the second classifier, and its law is a limit that has no formula.
                    if rate < 1.0 {
                        exact.scaled_add(mass / sites.len() as f64, &visits(&mdp, &acting(old)));
                    }
                }
            }
            prop_assert!(close(&printed, &reuse.printed43[1].index_axis(Axis(0), k - 1).to_owned()));
            if rate < 1.0 {
                prop_assert!(close(&exact, &reuse.exact43[1].index_axis(Axis(0), k - 1).to_owned()));
            }
        }
    }

    #[test]
    fn bills_are_in_order(
        (horizon, actions, rounds) in (1usize..50, 1usize..20, 1usize..60),
        (alpha, beta) in (rate(), rate()),
        rollouts in 0u64..5,
    ) {
        let counts = Counts::of(&Plan { horizon, actions, rounds, alpha, beta, samples: 100, rollouts });
        let at_most = |a: f64, b: f64| a <= b * (1.0 + 1e-12) + 1e-9;
        prop_assert!(at_most(counts.smile43_labels, counts.smile42_labels));
        prop_assert!(at_most(counts.smile42_labels, counts.smile_labels));
        prop_assert!(at_most(counts.smile42_labels, counts.smile42_bound));
        prop_assert!(at_most(counts.smile43_labels, counts.smile43_bound));
        prop_assert!(at_most(counts.flip_var.unwrap(), counts.smile43_var));
        prop_assert!(counts.flip_var.unwrap() >= -1e-9);
        prop_assert!(at_most(counts.searn_lazy, counts.searn_eager));
        prop_assert!(at_most(counts.searn_lazy_one_state, counts.searn_eager_one_state));
    }
}

/// All label sequences of `horizon` steps with labels 0, ..., n.
fn sequences(horizon: usize, n: usize) -> Vec<Vec<usize>> {
    (0..(n + 1).pow(horizon as u32))
        .map(|code| (0..horizon).map(|t| code / (n + 1).pow(t as u32) % (n + 1)).collect())
        .collect()
}

/// The accumulated total variation of the printed algorithms' label sequences, in closed form and label by label.
#[test]
fn drifts_agree_with_enumeration() {
    let rounds = 3;
    for (horizon, rate) in [(1, 0.3), (2, 0.1), (2, 0.5), (3, 0.1), (3, 0.375), (3, 0.9), (4, 0.2)] {
        let all = sequences(horizon, rounds);
        // Index 0 is the expert. Algorithm 4.2 with distinguishable labels is SEARN's mixture.
        let expert = |labels: &Vec<usize>| f64::from(u8::from(labels.iter().all(|label| *label == 0)));
        let mut chain42: Vec<f64> = all.iter().map(expert).collect();
        let mut chain43 = chain42.clone();
        for n in 1..=rounds {
            let (keep, p) = (closed::kept(rate, horizon), closed::kept(rate, n));
            let searn: Vec<f64> = (0..=rounds)
                .map(|j| {
                    if j == 0 {
                        p
                    } else if j > n {
                        0.0
                    } else {
                        rate * closed::kept(rate, n - j)
                    }
                })
                .collect();
            let smile: Vec<f64> = (0..=rounds)
                .map(|j| {
                    if j == 0 {
                        p
                    } else if j > n {
                        0.0
                    } else {
                        rate * closed::kept(rate, j - 1)
                    }
                })
                .collect();
            let (mut far42, mut far43) = (0.0, 0.0);
            for (i, labels) in all.iter().enumerate() {
                let product = |weights: &[f64]| labels.iter().map(|label| weights[*label]).product::<f64>();
                let newest: Vec<usize> = (0..horizon).filter(|t| labels[*t] == n).collect();
                // One uniform step is the newest, the others are drawn.
                let fresh42 = newest.len() as f64 * product(&searn) / searn[n] / horizon as f64;
                chain42[i] = keep * chain42[i] + (1.0 - keep) * fresh42;
                far42 += (chain42[i] - product(&searn)).abs() / 2.0;
                // Given the number k of classifiers: uniform sites, one of them the newest, the others drawn from
                // pitilde^n. Divided by c_{n,k}.
                let k = labels.iter().filter(|label| **label > 0).count();
                let sites = closed::choose(horizon, k);
                let drawn: f64 = labels.iter().filter(|l| **l > 0).map(|l| smile[*l] / (1.0 - p)).product();
                let own = smile[n] / (1.0 - p);
                let fresh43 = if k == 0 { 1.0 } else { newest.len() as f64 / k as f64 * drawn / own / sites };
                let reused = closed::older(rate, n).powi(k as i32);
                chain43[i] = reused * chain43[i] + (1.0 - reused) * fresh43;
                let mass = closed::binomial(horizon, 1.0 - p, p)[k];
                far43 += (mass * chain43[i] - product(&smile)).abs() / 2.0;
            }
            assert!(
                (far42 - closed::drift42(horizon, rate, n)).abs() < 1e-12,
                "4.2, T = {horizon}, alpha = {rate}, n = {n}"
            );
            assert!(
                (far43 - closed::drift43(horizon, rate, n)).abs() < 1e-12,
                "4.3, T = {horizon}, alpha = {rate}, n = {n}"
            );
        }
    }
}

/// Figures that the literature or arithmetic fixes.
#[test]
fn closed_forms_have_known_values() {
    let rounds: Vec<f64> = [10, 100, 1000].iter().map(|horizon| closed::rounds(0.1, *horizon)).collect();
    assert_eq!(rounds, [44.0, 88.0, 132.0]);
    assert_eq!(closed::rounds(0.5, 4), 4.0);
    let printed: Vec<f64> = [10, 100].iter().map(|horizon| closed::rounds_printed(*horizon).ceil()).collect();
    assert_eq!(printed, [699.0, 197_651.0]);
    let square: Vec<f64> = [10, 100].iter().map(|horizon| closed::rounds_inverse_square(*horizon).ceil()).collect();
    assert_eq!(square, [461.0, 92_104.0]);
    assert!((closed::alpha_printed(2) - 0.5201).abs() < 5e-5);
    assert!((closed::overuse42(10, 0.1) - 1.2375).abs() < 5e-5 && (closed::overuse42(20, 0.1) - 1.274).abs() < 5e-4);
    assert_eq!(closed::bias42(1, 0.3), 0.0);
}

/// Closed forms of the hard instances.
#[test]
fn hard_instances_are_as_hard_as_they_say() {
    let (mdp, hat) = instances::tight(8, 1.0 / 16.0, 0.25).unwrap();
    assert!(near(evaluate(&mdp, &hat).unwrap().cost, 0.5 * 2.0 + 64.0 / 16.0));
    assert!(near(bounds::theorem_2_1(&mdp, &hat).unwrap().slack, 0.5 * 2.0));
    let (mdp, hat) = instances::tight(8, 1.0 / 16.0, 0.0).unwrap();
    assert!(near(bounds::theorem_2_1(&mdp, &hat).unwrap().slack, 0.0));
    assert!(instances::tight(8, 0.25, 0.0).is_err());
    let (mdp, hat) = instances::cliff(3, 0.5, 0.5).unwrap();
    assert!(near(evaluate(&mdp, &hat).unwrap().cost, 3.0 - 0.5 * 0.875));
    let (mdp, hat) = instances::rescue(5).unwrap();
    let mixing = Mixing::of(&mdp, Proposal::Smile, &[hat], 0.75).unwrap();
    assert!(near(bounds::lemma_4_2_sharp(&mixing, 1).slack, 0.0));
}

/// Section 3's printed u_i, over the class of one stochastic policy, counts its errors twice: error 1/2, gap 1, and u =
/// 1/2.
#[test]
fn the_printed_stakes_fail_for_stochastic_policies() {
    let (mdp, _) = instances::cliff(1, 0.5, 0.0).unwrap();
    let half = Table::mixture(&[
        (0.5, &Table::deterministic(&[0, 0], 2).unwrap()),
        (0.5, &Table::deterministic(&[1, 1], 2).unwrap()),
    ])
    .unwrap();
    let forward = Forward::of(&mdp, &[half]).unwrap();
    let printed = bounds::forward_printed(&forward);
    assert!(!printed.applies() && !printed.holds());
    assert!(near(printed.slack, -0.25) && near(bounds::forward_stakes(&forward).slack, 0.0));
}

/// All k-th order costs of 200 states over 200 steps, within a minute.
#[test]
fn orders_scale() {
    let n = 200;
    let next = Array3::from_shape_fn((n, 2, n), |(s, a, to)| {
        // Two sparse chains, every row a distribution: a walk and a scramble.
        let home = if a == 0 { (s + 1) % n } else { (s * 7 + 3) % n };
        if to == home { 0.75 } else { 0.25 / (n - 1) as f64 }
    });
    let cost = Array2::from_shape_fn((n, 2), |(s, a)| ((s * 31 + a * 17) % 101) as f64 / 100.0);
    let start = Array1::from_elem(n, 1.0 / n as f64);
    let mdp = Mdp::new(Parts { horizon: n, start, next, cost, expert: vec![0; n] }).unwrap();
    let (star, other) = (mdp.star(), Table::deterministic(&vec![1; n], 2).unwrap());
    let clock = std::time::Instant::now();
    let orders = orders(&mdp, &star, &other).unwrap();
    let seconds = clock.elapsed().as_secs_f64();
    println!("{seconds:.2} s");
    let mixture = Table::mixture(&[(0.9, &star), (0.1, &other)]).unwrap();
    let mass = closed::binomial(n, 0.1, 0.9);
    let sum: f64 = mass.iter().zip(&orders.costs).map(|(p, cost)| p * cost).sum();
    assert!((evaluate(&mdp, &mixture).unwrap().cost - sum).abs() < 1e-8);
    assert!(seconds < 60.0, "{seconds} s");
}

/// The JSON pointers of everything within `value`.
fn pointers(value: &Value, at: String, all: &mut Vec<String>) {
    match value {
        Value::Array(list) => list.iter().enumerate().for_each(|(i, value)| pointers(value, format!("{at}/{i}"), all)),
        Value::Object(map) => map.iter().for_each(|(key, value)| pointers(value, format!("{at}/{key}"), all)),
        _ => {}
    }
    all.push(at);
}

/// What a broken writer of instances might put anywhere.
fn junk() -> impl Strategy<Value = Value> {
    prop::sample::select(vec![
        json!(null),
        json!(-1),
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(0.5),
        json!(1e308),
        json!(5e-324),
        json!(1e-15),
        json!(u64::MAX),
        json!("x"),
        json!([]),
        json!({}),
        json!([1]),
        json!([0.5, 0.5]),
        json!([[1, 0], [0, 1]]),
        json!([[[1, 0], [0, 1]]]),
    ])
}

proptest! {
    #![proptest_config(config())]

    /// An instance is refused or audited; what is audited has finite values, and bounds that hold where they apply.
    #[test]
    fn no_instance_panics(line in 0usize..6, changes in vec((any::<prop::sample::Index>(), junk()), 0..4)) {
        let line = include_str!("data/theory.jsonl").lines().nth(line).unwrap();
        let mut value: Value = serde_json::from_str(line).unwrap();
        for (index, junk) in changes {
            let mut all = Vec::new();
            pointers(&value, String::new(), &mut all);
            // The outermost is last; replacing it leaves nothing to test.
            all.pop();
            if !all.is_empty() {
                let at: &String = index.get(&all);
                *value.pointer_mut(at).unwrap() = junk;
            }
        }
        let Ok(instance) = Instance::parse("instance", value.to_string().as_bytes()) else {
            return Ok(());
        };
        let audit = audit(&instance).unwrap();
        for bound in &audit.theorems {
            prop_assert!(!bound.applies() || bound.holds(), "{bound:?}");
        }
    }

    #[test]
    fn no_text_panics(text in ".{0,200}", bytes in vec(any::<u8>(), 0..100)) {
        prop_assert!(Instance::parse("instance", text.as_bytes()).is_err());
        prop_assert!(Instance::parse("instance", &bytes).is_err());
    }
}

/// Values, action values, visits and advantages fit together.
fn consistent(mdp: &Mdp, tables: &[Table], own: &Evaluation) -> Result<(), TestCaseError> {
    prop_assert!(near(own.cost, mdp.start().dot(&own.value.row(0))));
    for (t, table) in tables.iter().enumerate() {
        prop_assert!(near(own.visits.row(t).sum(), 1.0));
        let gain = (&own.advantages().index_axis(Axis(0), t) * table.rows()).sum_axis(Axis(1));
        prop_assert!(gain.iter().all(|gain| gain.abs() <= 1e-12 * tables.len() as f64));
    }
    Ok(())
}
