//! One classifier per step.

use super::{Classifier, Policy};
use crate::space::{Action, Problem, ViewOf};
use crate::worker::Visit;

/// The non-stationary policy of forward training (Ross & Bagnell 2010, section 3): one classifier per step.
#[derive(Clone, Debug)]
pub struct Ladder<C> {
    steps: Vec<C>,
    expert: bool,
}

impl<C> Ladder<C> {
    /// Steps that are all still the expert's.
    pub fn new() -> Self {
        Ladder { steps: Vec::new(), expert: true }
    }

    /// A ladder of these classifiers, which asks no expert; without any it takes the lowest legal action.
    pub fn of(steps: Vec<C>) -> Self {
        Ladder { steps, expert: false }
    }

    /// The classifiers, that of step 0 first.
    pub fn steps(&self) -> &[C] {
        &self.steps
    }

    /// The same ladder with every classifier replaced by what `change` makes of it.
    pub fn map<D>(self, change: impl FnMut(C) -> D) -> Ladder<D> {
        Ladder { steps: self.steps.into_iter().map(change).collect(), expert: self.expert }
    }

    /// Takes the first step that is still the expert's away from it.
    pub fn push(&mut self, classifier: C) {
        self.steps.push(classifier);
    }

    /// The ladder without the expert: steps beyond the last classifier are that classifier's.
    pub fn without_expert(self) -> Self {
        Ladder { expert: false, ..self }
    }
}

impl<C> Default for Ladder<C> {
    fn default() -> Self {
        Ladder::new()
    }
}

impl<P: Problem, C: Classifier<ViewOf<P>>> Policy<P> for Ladder<C> {
    type Memory = Vec<C::Memory>;

    fn act(&self, visit: &mut Visit<'_, P>, memory: &mut Self::Memory) -> Action {
        let step = match self.steps.len() {
            n if visit.t() < n => visit.t(),
            _ if self.expert => return visit.expert(),
            0 => return visit.legal().nth(0),
            n => n - 1,
        };
        memory.resize_with(memory.len().max(step + 1), Default::default);
        self.steps[step].choose(&visit.sight(), &mut memory[step])
    }
}
