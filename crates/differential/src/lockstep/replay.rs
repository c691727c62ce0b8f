//! The step of a state file, made again on both sides.

use crate::lockstep::case_file::{Expected, StepCase, StepCaseError};
use crate::lockstep::drift::Drift;
use crate::lockstep::explain::ComparedLinks;
use crate::lockstep::intrusion::{StepCause, WatchedStep};
use crate::lockstep::penetration::DepthDifference;
use crate::lockstep::recorded::{pair_difference, pair_intrusion, run_difference, run_intrusion};
use crate::lockstep::run::{ComparedStep, Lockstep, LockstepError};
use rockproof_model::Precision;
use rockproof_simulate::checkpoint::InvalidState;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{SetupError, Solve};
use std::collections::BTreeSet;

/// The step of a state file, made again.
#[derive(Clone, Debug)]
pub struct ReplayedStep {
    /// What both sides did.
    pub compared: ComparedStep,
    /// What of the state after it deviates by more than rounding, all decisions being the same.
    pub drift: Option<Drift>,
    /// How the depths differ, where the case records that they do.
    pub depth: Option<DepthDifference>,
}

/// Why the step of a state file cannot be made again.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// It is no state file.
    #[error(transparent)]
    Case(#[from] StepCaseError),
    /// Its scene cannot be stepped.
    #[error(transparent)]
    Lockstep(#[from] LockstepError),
    /// Its state is none.
    #[error(transparent)]
    State(#[from] InvalidState),
    /// Its state does not fit its scene.
    #[error(transparent)]
    Setup(#[from] SetupError),
}

/// A difference of a step: its cause, and how a case records it, in the words of a campaign and in those of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedDifference {
    /// Why.
    pub cause: StepCause,
    words: [String; 2],
    depth: Option<DepthDifference>,
}

impl RecordedDifference {
    /// Whether a case records it; of depths, whether it records that they differ as much.
    pub fn is_in(&self, case: &StepCase) -> bool {
        let as_deep = |depth: &DepthDifference| recorded_depths(case).any(|recorded| depth.is_as(&recorded));
        self.words.iter().any(|words| case.differences.contains(words)) || self.depth.as_ref().is_some_and(as_deep)
    }

    /// The difference with its blocks.
    pub fn words(&self) -> &str {
        &self.words[1]
    }

    fn is(&self, recorded: &str) -> bool {
        self.words.iter().any(|words| words == recorded)
    }
}

impl ReplayedStep {
    /// Makes the step of a case again. Passages and unseen overlaps are looked for where the case says which there are.
    ///
    /// # Errors
    /// When the state does not fit the scene, or a number overflows in the engine's precision.
    pub fn of(case: &StepCase) -> Result<ReplayedStep, ReplayError> {
        match case.precision()? {
            Precision::F32 => made::<f32>(case),
            Precision::F64 => made::<f64>(case),
        }
    }

    /// Whether there is anything to be told of it: a difference, a side that cannot make it, a passage or an unseen overlap, a state that
    /// deviates, depths that differ where the case records that. A passage that stayed undecided is nothing that was found.
    pub fn recurs(&self) -> bool {
        let intrusions =
            |watched: &WatchedStep| [&watched.oracle, &watched.stepper].into_iter().any(|side| !side.found.is_empty());
        let step = &self.compared;
        self.drift.is_some()
            || self.depth.is_some()
            || !step.differences.is_empty()
            || !step.failure.is_empty()
            || step.watched.as_ref().is_some_and(intrusions)
    }

    /// That nothing was found, but it stayed undecided whether some blocks pass through one another, so nobody knows whether there is anything.
    pub fn undecided(&self) -> Option<String> {
        let watched = self.compared.watched.as_ref().filter(|_| !self.recurs())?;
        let pairs = watched.oracle.undecided.iter().chain(&watched.stepper.undecided);
        let pairs: BTreeSet<String> = pairs.map(|[a, b]| format!("{a} and {b}")).collect();
        let pairs: Vec<String> = pairs.into_iter().collect();
        (!pairs.is_empty()).then(|| format!("whether {} pass through one another stayed undecided", pairs.join(", ")))
    }

    /// Whether the oracle answers what a case records.
    pub fn is_expected(&self, case: &StepCase) -> bool {
        Expected::of_step(&self.compared).as_ref() == Some(&case.expected)
    }

    /// What differs between the links of the chain, passages, unseen overlaps and recorded depths among it.
    pub fn differences(&self) -> Vec<RecordedDifference> {
        let decisions = self.compared.differences.iter().map(|one| RecordedDifference {
            cause: one.cause.into(),
            words: [pair_difference(one), run_difference(one)],
            depth: None,
        });
        let watched = self.compared.watched.iter().flat_map(|watched| &watched.attributed);
        let intrusions = watched.map(|one| RecordedDifference {
            cause: one.cause,
            words: [pair_intrusion(one), run_intrusion(one)],
            depth: None,
        });
        let depth = self.depth.iter().map(|one| RecordedDifference {
            cause: one.cause.into(),
            words: [one.words(), one.words()],
            depth: Some(*one),
        });
        decisions.chain(intrusions).chain(depth).collect()
    }

    /// The first difference with an exact cause that a case records and the step has no more. What an engine's arithmetic does may come to be
    /// right; tolerances, rounding of the input and the length of the step do the same for ever.
    pub fn missing<'c>(&self, case: &'c StepCase) -> Option<&'c str> {
        let found = self.differences();
        let is_exact = |words: &str| EXACT.iter().any(|cause| words.split(' ').next() == Some(cause));
        let recorded = case.differences.iter().map(String::as_str).filter(|words| is_exact(words));
        recorded.into_iter().find(|words| !found.iter().any(|one| one.is(words)))
    }
}

/// The names of causes in which no engine takes part.
const EXACT: [&str; 4] = ["tolerance", "representation", StepCause::NAMES[0], StepCause::NAMES[1]];

/// How depths differ by what a case records.
pub fn recorded_depths(case: &StepCase) -> impl Iterator<Item = DepthDifference> + '_ {
    case.differences.iter().filter_map(|words| DepthDifference::recorded(words))
}

fn made<R: Solve>(case: &StepCase) -> Result<ReplayedStep, ReplayError> {
    let (scene, set) = case.scene()?;
    let mut lockstep = Lockstep::<R, SpecRules>::new(&scene, &set, case.precision()?, ComparedLinks::All)?;
    if case.expected.intrusions.is_some() {
        lockstep = lockstep.watching();
    }
    lockstep.restore(case.state.state()?)?;
    let before = lockstep.state().clone();
    let compared = lockstep.step().1;
    let drift = lockstep.drift(&before, &compared);
    let depth = || DepthDifference::of(&scene.shapes(), case.precision().ok()?, &compared, drift.is_some());
    let depth = recorded_depths(case).next().and_then(|_| depth());
    Ok(ReplayedStep { compared, drift, depth })
}
