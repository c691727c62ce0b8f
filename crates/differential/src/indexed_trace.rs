//! A trace in which decisions are found.

use super::engine::Trace;
use rockproof_model::decision::Decision;
use rockproof_model::decision_index::DecisionIndex;
use std::cell::OnceCell;

/// The decisions of one side, and where they are.
#[derive(Debug)]
pub struct IndexedTrace {
    decisions: Trace,
    /// The places of all decisions, of one taken more than once the last; made when first asked for.
    index: OnceCell<DecisionIndex>,
    /// Whether none is known to have been taken more than once.
    each_once: bool,
}

impl IndexedTrace {
    /// A trace of any side.
    pub fn of(decisions: Trace) -> IndexedTrace {
        IndexedTrace { decisions, index: OnceCell::new(), each_once: false }
    }

    /// A trace whose index is known, and which has each decision once.
    pub(crate) fn with_index(decisions: Trace, index: DecisionIndex) -> IndexedTrace {
        IndexedTrace { decisions, index: OnceCell::from(index), each_once: true }
    }

    /// The decisions with their outcomes, in the order they were taken.
    pub fn decisions(&self) -> &Trace {
        &self.decisions
    }

    /// Where a decision is, of one taken more than once the last place. Found at once where it is at `guess`.
    pub(crate) fn find(&self, decision: &Decision, guess: usize) -> Option<usize> {
        if self.each_once && self.decisions.get(guess).is_some_and(|(known, _)| known == decision) {
            return Some(guess);
        }
        let at = |place: usize| &self.decisions[place].0;
        let index = self.index.get_or_init(|| {
            let mut index = DecisionIndex::with_room(self.decisions.len());
            for (place, (decision, _)) in self.decisions.iter().enumerate().rev() {
                index.add(decision, place, at);
            }
            index
        });
        index.find(decision, at)
    }
}

#[cfg(test)]
mod tests {
    use super::IndexedTrace;
    use crate::builtin::BuiltinOracle;
    use crate::engine::Oracle;
    use rockproof_model::decision::{Decision, Feature, Predicate, Side};
    use rockproof_model::decision_index::DecisionIndex;
    use rockproof_model::{Block, Number, ToleranceSet, Vec3, VertexId};

    fn about(number: u32) -> Decision {
        Decision::about(Predicate::GapSign, &[Feature::Vertex(Side::A, VertexId(number))])
    }

    #[test]
    fn of_a_decision_taken_twice_the_last_counts_whatever_the_guess() {
        let trace = IndexedTrace::of([3, 5, 3, 7].map(|number| (about(number), 1)).to_vec());
        for guess in 0..5 {
            assert_eq!([3, 5, 7, 4].map(|number| trace.find(&about(number), guess)), [Some(2), Some(1), Some(3), None]);
        }
    }

    /// The oracle's index is of the very list that comes with it.
    #[test]
    fn what_the_oracle_decided_is_found_where_it_is() {
        let number = |value: f64| Number::from_f64(value).expect("a finite number");
        let cube = |low: [f64; 3]| {
            let at = |add: f64| Vec3::new(low[0] + add, low[1] + add, low[2] + add).map(|c| number(*c));
            Block::cuboid(&at(0.0), &at(2.0)).expect("a cube")
        };
        let (a, b) = (cube([0.0, 0.0, 0.0]), cube([1.0, 1.0, 2.0]));
        let tolerances = ToleranceSet { search: number(1.0), penetration: number(1.0), ..ToleranceSet::ZERO };
        let prepared = BuiltinOracle.prepare(&a, &b);
        let (plain, indexed) = (prepared.pair().trace(&tolerances), prepared.pair().indexed_trace(&tolerances));
        assert_eq!(indexed.decisions(), &plain);
        assert!(plain.len() > 100, "{} decisions", plain.len());
        for (place, (decision, _)) in plain.iter().enumerate() {
            assert_eq!(indexed.find(decision, usize::MAX), Some(place), "{decision}");
        }
    }

    #[test]
    fn a_wrong_guess_does_not_hide_a_decision() {
        let decisions: Vec<(Decision, i8)> = (0..40).map(|number| (about(number), 1)).collect();
        let mut index = DecisionIndex::with_room(decisions.len());
        for (place, (decision, _)) in decisions.iter().enumerate() {
            index.add(decision, place, |place| &decisions[place].0);
        }
        let trace = IndexedTrace::with_index(decisions, index);
        for number in 0..50 {
            for guess in 0..50 {
                let place = (number < 40).then_some(number as usize);
                assert_eq!(trace.find(&about(number), guess), place);
            }
        }
    }
}
