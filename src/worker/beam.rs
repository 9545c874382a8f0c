//! Beam search: several ways through one episode at a time.

use super::{Kind, Visit, Worker};
use crate::space::{Action, Episode, Problem, Space, StateOf};

/// A way from the start of an episode.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    /// The actions taken.
    pub actions: Vec<Action>,
    /// The sum of their scores.
    pub score: f64,
    /// The sum of their costs.
    pub cost: f64,
}

impl<P: Problem> Worker<'_, P>
where
    StateOf<P>: Clone,
{
    /// Goes through `episode` in all directions and keeps, after each step, the `width` paths with the highest scores; of equals that whose
    /// beginning stood higher before, then that of the lowest action. `score` writes one score for each legal action in order. After
    /// each step `watch` is shown the paths, the best first, and may stop the search. Returns them as they are then.
    ///
    /// Every path's step is billed, and, where there may be more than one path, as many resets: the system is put back to where that path stood.
    pub fn beam(
        &mut self,
        episode: Episode,
        width: usize,
        mut score: impl FnMut(&mut Visit<'_, P>, &mut Vec<f32>),
        mut watch: impl FnMut(&[Path]) -> bool,
    ) -> Vec<Path> {
        let space = self.problem.space();
        let (mut states, mut paths) = (vec![space.start(episode)], vec![Path::default()]);
        let mut scores = Vec::new();
        let mut next: Vec<(f64, usize, Option<Action>)> = Vec::new();
        for t in 0.. {
            next.clear();
            for (from, (state, path)) in states.iter().zip(&paths).enumerate() {
                let (ledger, looks) = (&mut self.ledger, &mut self.looks);
                let mut visit = Visit::new(self.problem, state, ledger, looks, Kind::RollIn, t, episode.seed);
                visit.spent = path.cost;
                let legal = visit.legal();
                if legal.is_empty() {
                    next.push((path.score, from, None));
                    continue;
                }
                scores.clear();
                score(&mut visit, &mut scores);
                let steps = legal.iter().zip(&scores);
                next.extend(steps.map(|(action, s)| (path.score + f64::from(*s), from, Some(action))));
            }
            if next.iter().all(|(_, _, action)| action.is_none()) {
                break;
            }
            next.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| (a.1, a.2).cmp(&(b.1, b.2))));
            next.truncate(width.max(1));
            let seed = episode.seed.child(crate::seed::Purpose::Step, t as u64);
            let kept = next.iter().map(|&(score, from, action)| {
                let (mut state, mut path) = (states[from].clone(), paths[from].clone());
                path.score = score;
                if let Some(action) = action {
                    self.ledger.steps += 1;
                    self.ledger.resets += u64::from(width > 1);
                    path.cost += space.step(&mut state, action, seed);
                    path.actions.push(action);
                }
                (state, path)
            });
            (states, paths) = kept.unzip();
            if !watch(&paths) {
                break;
            }
        }
        paths
    }
}
