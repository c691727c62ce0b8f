//! A lockstep as something that `simulate` runs: rows, counts and state files of every step.

use crate::finding::Cause;
use crate::lockstep::answer::StepDecisions;
use crate::lockstep::case_file::{Expected, StepCase};
use crate::lockstep::recorded::run_difference;
use crate::lockstep::run::{ComparedStep, Lockstep};
use crate::lockstep::table::{CAUSES, difference_rows, step_row};
use rockproof_simulate::checkpoint::SavedState;
use rockproof_simulate::record::RunTable;
use rockproof_simulate::run::{Ending, StepAnnotations, Stepping};
use rockproof_stepper::dynamics::{Solve, State, StepError, StepReport, StepRules};
use std::collections::BTreeMap;

/// A lockstep that annotates each step with what it finds.
#[derive(Debug)]
pub struct LockstepStepping<R, M> {
    lockstep: Lockstep<R, M>,
    /// What state files say of the scene.
    about: StateFileDescription,
    /// State files that may still be written, by cause.
    left: [u64; 4],
    last: Option<StepAnnotations>,
}

/// What a state file says of the run it is from.
#[derive(Clone, Debug)]
pub struct StateFileDescription {
    /// The scene as it was run ([`rockproof_simulate::identity::with_tolerances`]).
    pub scene: String,
    /// `f32` or `f64`.
    pub engine: String,
    /// State files for each cause at most.
    pub states: u64,
    /// Whether the run ends at the first step in which stepper and oracle differ.
    pub stop_at_first: bool,
}

/// The name of how many steps had no contact, by stepper or oracle.
pub const STEPS_WITHOUT_CONTACTS: &str = "steps_without_contacts";

/// The names of what adds up over a run, by cause: differences, and state files.
const COUNTS: [[&str; 2]; 4] = [
    ["tolerance", "states_tolerance"],
    ["representation", "states_representation"],
    ["arithmetic", "states_arithmetic"],
    ["defect", "states_defect"],
];

impl<R: Solve, M: StepRules> LockstepStepping<R, M> {
    /// A run; `counts` are those of the run it goes on with.
    pub fn new(
        lockstep: Lockstep<R, M>,
        about: StateFileDescription,
        counts: &BTreeMap<String, u64>,
    ) -> LockstepStepping<R, M> {
        let written = |name: &str| counts.get(name).copied().unwrap_or(0);
        let left = COUNTS.map(|[_, states]| about.states.saturating_sub(written(states)));
        LockstepStepping { lockstep, about, left, last: None }
    }

    /// The lockstep.
    pub fn lockstep(&mut self) -> &mut Lockstep<R, M> {
        &mut self.lockstep
    }

    fn annotate(&mut self, before: &State<R>, compared: &ComparedStep) -> StepAnnotations {
        let mut counts = vec![
            ("steps", 1),
            ("steps_differing", u64::from(compared.differs())),
            (STEPS_WITHOUT_CONTACTS, u64::from(compared.has_no_contacts())),
            ("undecided", compared.undecided),
            ("stepper_microseconds", compared.took[0].as_micros() as u64),
            ("oracle_microseconds", compared.took[1].as_micros() as u64),
        ];
        let mut wanted = false;
        for (k, cause) in CAUSES.into_iter().enumerate() {
            let found = compared.count(cause) as u64;
            counts.push((COUNTS[k][0], found));
            if found > 0 && self.left[k] > 0 {
                self.left[k] -= 1;
                counts.push((COUNTS[k][1], 1));
                wanted = true;
            }
        }
        let case =
            if wanted { compared.oracle.as_ref().and_then(|oracle| self.case(before, compared, oracle)) } else { None };
        let name = case.as_ref().map_or(String::new(), |(name, _)| name.clone());
        let end = match &compared.unproved {
            Some(failure) => Some(Ending::Unproved(failure.to_string())),
            None => (self.about.stop_at_first && compared.differs()).then_some(Ending::Diverged),
        };
        StepAnnotations {
            rows: vec![
                (RunTable::Lockstep, vec![step_row(compared)]),
                (RunTable::Differences, difference_rows(compared, &name)),
            ],
            states: case.into_iter().collect(),
            intrusions: None,
            counts,
            end,
        }
    }

    fn case(&self, before: &State<R>, compared: &ComparedStep, oracle: &StepDecisions) -> Option<(String, Vec<u8>)> {
        let case = StepCase {
            format: StepCase::FORMAT.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            engine: self.about.engine.clone(),
            step: compared.step,
            differences: compared.differences.iter().map(run_difference).collect(),
            scene: self.about.scene.clone(),
            state: SavedState::of(before),
            expected: Expected::of(oracle),
        };
        Some((StepCase::name_of(compared.step), case.text().ok()?))
    }
}

impl<R: Solve, M: StepRules> Stepping<R> for LockstepStepping<R, M> {
    fn step(&mut self) -> Result<StepReport, StepError> {
        let before = self.lockstep.state().clone();
        let (made, compared) = self.lockstep.step();
        self.last = Some(self.annotate(&before, &compared));
        made
    }

    fn state(&self) -> &State<R> {
        self.lockstep.state()
    }

    fn annotations(&mut self) -> Option<StepAnnotations> {
        self.last.take()
    }
}

/// How many differences of a cause a run has so far.
pub fn differences(counts: &BTreeMap<String, u64>, cause: Cause) -> u64 {
    let place = CAUSES.iter().position(|&c| c == cause);
    place.and_then(|k| counts.get(COUNTS[k][0])).copied().unwrap_or(0)
}
