//! The case of a passage or an unseen overlap in a run: its step made again on both sides, of as few blocks as show it, and its causes.
//! Which blocks show it, the stepper alone says (`intrusion_part.rs`).

use crate::lockstep::case_file::{Expected, StepCase};
use crate::lockstep::cutout::cutout;
use crate::lockstep::explain::ComparedLinks;
use crate::lockstep::intrusion::{CausedIntrusion, Intrusion};
use crate::lockstep::intrusion_part::ShowingStep;
use crate::lockstep::recorded::{run_difference, run_intrusion};
use crate::lockstep::run::{ComparedStep, Lockstep};
use rockproof_model::{Precision, Scene, ToleranceSet};
use rockproof_simulate::checkpoint::SavedState;
use rockproof_simulate::identity::with_tolerances;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Solve, State};

/// A passage or an unseen overlap that an audit found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundIntrusion {
    /// The sort.
    pub kind: Intrusion,
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// How deep (m).
    pub depth_m: f64,
}

impl FoundIntrusion {
    /// Whether an intrusion so deep (m; none beyond f64) is this one again where blocks are left out.
    pub(super) fn is_again(&self, depth: Option<f64>) -> bool {
        depth.unwrap_or(f64::INFINITY) >= SAME_DEPTH * self.depth_m
    }
}

/// Its case and its causes.
#[derive(Clone, Debug, PartialEq)]
pub struct IntrusionCase {
    /// The case; its blocks have numbers of their own, in the order of the scene.
    pub case: StepCase,
    /// How many blocks it has.
    pub blocks: usize,
    /// The causes, by link of the chain.
    pub causes: Vec<CausedIntrusion>,
}

/// Why an intrusion has no case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoCase {
    /// The stepper's step does not show it again, not even of the whole scene.
    NotShown,
    /// Of the blocks that show it, at most [`MAX_BLOCKS`], a step cannot be made exactly.
    Unproved,
    /// So many blocks show it, and no fewer were found that do: more than [`MAX_BLOCKS`].
    TooMany(usize),
}

/// Parts of more blocks are not stepped exactly to find causes: for one intrusion there may be 250 such steps, each of some milliseconds a
/// block where it is simple, and far more where it is full of ties.
pub const MAX_BLOCKS: usize = 64;

/// Where blocks are left out of a part that has more than [`MAX_BLOCKS`], so few are enough: exact steps of them take little time.
const FEW_BLOCKS: usize = 16;

/// The stepper's own step must show the intrusion with at least so much of its depth where blocks are left out.
const SAME_DEPTH: f64 = 0.5;

/// Finds the case of an intrusion in the step after a state: of its two blocks alone, of these and all within one contact of them, within two,
/// three and so on, of the whole scene at last, whichever is the first in which the stepper does it again. Of more than [`MAX_BLOCKS`]
/// blocks, others than those that it needs for that are left out.
///
/// # Errors
/// Why there is no case.
pub fn intrusion_case<R: Solve>(
    scene: &Scene,
    set: &ToleranceSet,
    precision: Precision,
    state: &State<R>,
    found: FoundIntrusion,
) -> Result<IntrusionCase, NoCase> {
    let step = ShowingStep { scene, set, precision, state, found };
    let mut missing = NoCase::NotShown;
    for part in step.parts() {
        if !step.is_shown_by(&part) {
            continue;
        }
        let mut part = if part.len() > MAX_BLOCKS { step.with_fewer(part, FEW_BLOCKS) } else { part };
        if part.len() > MAX_BLOCKS {
            return Err(if missing == NoCase::NotShown { NoCase::TooMany(part.len()) } else { missing });
        }
        part.sort_unstable();
        if let Some(case) = step.case_of(&part) {
            return Ok(case);
        }
        missing = NoCase::Unproved;
    }
    Err(missing)
}

impl<R: Solve> ShowingStep<'_, R> {
    /// The case of some blocks, in ascending order; `None` where the step of them cannot be made exactly or does not show the intrusion.
    fn case_of(&self, blocks: &[usize]) -> Option<IntrusionCase> {
        let ShowingStep { scene, set, precision, state, found } = *self;
        let (part, before) = cutout(scene, state, blocks);
        let lockstep = Lockstep::<R, SpecRules>::new(&part, set, precision, ComparedLinks::All).ok()?;
        let mut lockstep = lockstep.watching();
        lockstep.restore(before.clone()).ok()?;
        let compared = lockstep.step().1;
        let watched = compared.watched.as_ref()?;
        let place = |block: usize| blocks.iter().position(|&kept| kept == block);
        let pair = [place(found.blocks[0])?, place(found.blocks[1])?];
        let again = watched.stepper.between(found.kind, pair)?;
        if !found.is_again(again.depth) {
            return None;
        }
        let of_pair = watched.attributed.iter().filter(|one| (one.kind, one.blocks) == (found.kind, pair));
        let causes = of_pair.copied().collect();
        let case = StepCase {
            format: StepCase::FORMAT.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            engine: precision.to_string(),
            step: compared.step,
            differences: recorded(&compared),
            scene: with_tolerances(&part, set).ok()?,
            state: SavedState::of(&before),
            expected: Expected::of_step(&compared)?,
        };
        Some(IntrusionCase { case, blocks: blocks.len(), causes })
    }
}

/// All that differs in a step, as a case of a run has it.
fn recorded(compared: &ComparedStep) -> Vec<String> {
    let intrusions = compared.watched.iter().flat_map(|watched| &watched.attributed).map(run_intrusion);
    compared.differences.iter().map(run_difference).chain(intrusions).collect()
}
