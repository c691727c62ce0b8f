//! Who watches the decisions of a classification.

use rockproof_model::decision::{Decision, Feature, Predicate};

/// Is told every decision as it is made.
pub trait Observer {
    /// A predicate was asked of features, in the order of the table at [`Decision`]; `outcome` as there.
    fn observe(&mut self, predicate: Predicate, features: &[Feature], outcome: i8);
}

/// Watches nothing, at no cost.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    #[inline(always)]
    fn observe(&mut self, _: Predicate, _: &[Feature], _: i8) {}
}

/// Writes all decisions down, in the order in which they are made. A decision asked twice is written twice.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// The decisions and their outcomes.
    pub decisions: Vec<(Decision, i8)>,
}

impl Observer for Trace {
    fn observe(&mut self, predicate: Predicate, features: &[Feature], outcome: i8) {
        self.decisions.push((Decision::about(predicate, features), outcome));
    }
}
