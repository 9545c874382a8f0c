//! A space written from scratch: sorting by swaps of neighbours, learned from an expert who swaps the first pair that is out of order.

use rollin::learner::Logistic;
use rollin::policy::Follow;
use rollin::roll::perform;
use rollin::space::{Action, Actions, CostToGo, Episode, Expert, FeatureTable, Features, Imitation, NO_ROW, Space};
use rollin::trainer::{Dagger, Run};
use rollin::{Purpose, Result, Seed};

/// Lists of so many numbers. Action i swaps the numbers at i and i+1, and costs 1; a sorted list ends the episode, and so
/// do many swaps in vain.
struct Sorting {
    length: usize,
    table: FeatureTable,
}

/// A list, and how often it was swapped.
#[derive(Clone)]
struct List {
    numbers: Vec<u32>,
    swaps: usize,
}

impl Sorting {
    fn new(length: usize) -> Self {
        // Feature i: the pair at i is out of order.
        Sorting { length, table: FeatureTable::new(length - 1) }
    }

    fn inversions(list: &List) -> usize {
        let later = |i: usize| list.numbers[i + 1..].iter().filter(|x| **x < list.numbers[i]).count();
        (0..list.numbers.len()).map(later).sum()
    }
}

impl Space for Sorting {
    type State = List;
    type View = Features;

    fn start(&self, episode: Episode) -> List {
        let mut keyed: Vec<(f64, u32)> =
            (0..self.length as u32).map(|i| (episode.seed.child(Purpose::Step, i.into()).unit(), i)).collect();
        keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
        List { numbers: keyed.into_iter().map(|(_, number)| number).collect(), swaps: 0 }
    }

    fn legal<'a>(&'a self, list: &'a List) -> Actions<'a> {
        let over = list.numbers.is_sorted() || list.swaps == self.length * self.length;
        if over { Actions::NONE } else { Actions::All(self.length as u32 - 1) }
    }

    fn look(&self, list: &List, view: &mut Features) {
        view.row = NO_ROW;
        view.dynamic.clear();
        view.dynamic.extend((0..self.length as u32 - 1).filter(|i| {
            let i = *i as usize;
            list.numbers[i] > list.numbers[i + 1]
        }));
    }

    fn step(&self, list: &mut List, action: Action, _: Seed) -> f64 {
        list.numbers.swap(action.index(), action.index() + 1);
        list.swaps += 1;
        1.0
    }

    fn actions(&self) -> usize {
        self.length - 1
    }

    fn shared(&self) -> &FeatureTable {
        &self.table
    }
}

/// Swaps the first pair that is out of order: as few swaps as can be, one for each inversion.
struct First;

impl Expert<Sorting> for First {
    fn action(&self, _: &Sorting, list: &List) -> Option<Action> {
        list.numbers.windows(2).position(|pair| pair[0] > pair[1]).map(|i| Action(i as u32))
    }
}

impl CostToGo<Sorting> for First {
    fn costs(&self, space: &Sorting, list: &List, costs: &mut Vec<f64>) {
        costs.clear();
        costs.extend((0..space.length - 1).map(|i| {
            let mut after = list.clone();
            after.numbers.swap(i, i + 1);
            1.0 + Sorting::inversions(&after) as f64
        }));
    }
}

/// Runs the example: learns on 100 lists, and sorts 200 others with as few swaps as the expert.
pub fn main() -> Result<()> {
    let problem = Imitation { space: Sorting::new(6), expert: First, episodes: 100 };
    let trained = Dagger::default().train(&problem, &Logistic::default(), &Run::new(1))?;
    let others = Imitation { episodes: 200, ..problem };
    let learned = perform(&others, &trained.policy, Seed::new(2)).0.costs;
    println!("{} swaps, {} labels", learned.iter().sum::<f64>(), trained.ledger.labels);
    assert_eq!(learned, perform(&others, &Follow, Seed::new(2)).0.costs);
    Ok(())
}

#[cfg(test)]
#[test]
fn each_swap_of_the_expert_is_the_cheapest() {
    let space = Sorting::new(5);
    let (mut list, mut costs) = (space.start(Episode { index: 0, seed: Seed::new(3) }), Vec::new());
    while let Some(action) = First.action(&space, &list) {
        First.costs(&space, &list, &mut costs);
        assert_eq!(costs[action.index()], Sorting::inversions(&list) as f64);
        assert!(costs.iter().all(|cost| *cost >= costs[action.index()]));
        space.step(&mut list, action, Seed::new(3));
    }
    assert!(space.legal(&list).is_empty() && list.swaps > 0);
}
