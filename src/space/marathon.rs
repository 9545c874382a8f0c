//! Games played one after the other, for a given number of decisions.

use super::{Action, Actions, Episode, Expert, Space};
use crate::error::{Error, Result};
use crate::seed::{Purpose, Seed};

/// The space `S` with episodes of exactly so many decisions: where a game is over and decisions are left, the next one begins.
///
/// A round then has as many examples as was asked for, whoever drives and however soon each game ends, and horizons are known. Without a number
/// of decisions an episode is one game, as in `S`. Games after the first have the episode's number and seeds of their own below the episode's.
#[derive(Clone, Copy, Debug)]
pub struct Marathon<'a, S> {
    space: &'a S,
    decisions: Option<usize>,
}

/// Where a marathon stands.
#[derive(Clone, Debug)]
pub struct Running<T> {
    game: T,
    episode: Episode,
    games: u64,
    left: usize,
}

impl<T> Running<T> {
    /// The game at hand.
    pub fn game(&self) -> &T {
        &self.game
    }
}

impl<'a, S: Space> Marathon<'a, S> {
    /// Games of `space`, for so many `decisions` an episode, or one an episode.
    ///
    /// # Errors
    /// When there are to be no decisions.
    pub fn new(space: &'a S, decisions: Option<usize>) -> Result<Self> {
        match decisions {
            Some(0) => Err(Error::argument("decisions", 0, "at least 1")),
            _ => Ok(Marathon { space, decisions }),
        }
    }

    /// The space of one game.
    pub fn space(&self) -> &'a S {
        self.space
    }
}

impl<S: Space> Space for Marathon<'_, S> {
    type State = Running<S::State>;
    type View = S::View;

    fn start(&self, episode: Episode) -> Self::State {
        let left = self.decisions.unwrap_or(usize::MAX);
        Running { game: self.space.start(episode), episode, games: 1, left }
    }

    fn legal<'a>(&'a self, state: &'a Self::State) -> Actions<'a> {
        if state.left == 0 { Actions::NONE } else { self.space.legal(&state.game) }
    }

    fn look(&self, state: &Self::State, view: &mut S::View) {
        self.space.look(&state.game, view);
    }

    fn step(&self, state: &mut Self::State, action: Action, seed: Seed) -> f64 {
        let cost = self.space.step(&mut state.game, action, seed);
        state.left -= 1;
        if self.decisions.is_some() && state.left > 0 && self.space.legal(&state.game).is_empty() {
            let seed = state.episode.seed.child(Purpose::Episode, state.games);
            state.game = self.space.start(Episode { seed, ..state.episode });
            state.games += 1;
        }
        cost
    }

    fn actions(&self) -> usize {
        self.space.actions()
    }

    /// Known where decisions are counted, unless there is a game that is over before it begins.
    fn horizon(&self, index: usize) -> Option<usize> {
        self.decisions.or_else(|| self.space.horizon(index))
    }

    fn shared(&self) -> &<S::View as super::View>::Shared {
        self.space.shared()
    }
}

/// The expert of one game, who plays a [`Marathon`].
#[derive(Clone, Copy, Debug)]
pub struct Runner<'a, E>(pub &'a E);

impl<S: Space, E: Expert<S>> Expert<Marathon<'_, S>> for Runner<'_, E> {
    fn action(&self, space: &Marathon<'_, S>, state: &Running<S::State>) -> Option<Action> {
        self.0.action(space.space, &state.game)
    }

    fn answer(&self, space: &Marathon<'_, S>, state: &Running<S::State>, seed: Seed) -> Option<Action> {
        self.0.answer(space.space, &state.game, seed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::doc::{Follow, RealWorld};
    use crate::space::{Imitation, Problem};
    use crate::worker::Worker;

    /// The walker's world has games of ten steps, in which the expert never errs.
    #[test]
    fn games_follow_each_other() {
        let count = |decisions| {
            let space = Marathon::new(&RealWorld, decisions).expect("decisions");
            let problem = Imitation { space, expert: Runner(&Follow), episodes: 1 };
            let mut worker = Worker::new(&problem);
            let mut firsts = Vec::new();
            let cost = worker.episode(Episode { index: 0, seed: Seed::new(1) }, |visit| {
                let action = visit.expert();
                if visit.t() % 10 == 0 {
                    firsts.push(action);
                }
                Some(action)
            });
            assert_eq!((cost, problem.space().horizon(0)), (0.0, decisions.or(Some(10))));
            (worker.ledger().steps, firsts)
        };
        assert_eq!((count(Some(35)).0, count(Some(4)).0, count(None).0), (35, 4, 10));
        let starts = count(Some(400)).1;
        assert!(starts.iter().any(|start| *start != starts[0]), "each game is another");
        assert!(Marathon::new(&RealWorld, Some(0)).is_err());
    }
}
