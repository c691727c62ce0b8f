//! The case of a passage or an unseen overlap in a run: its step made again on both sides, of as few blocks as show it, and its causes.

use crate::lockstep::attribution::ComparedLinks;
use crate::lockstep::case_file::{Expected, StepCase};
use crate::lockstep::cutout::cutout;
use crate::lockstep::intrusion::{CausedIntrusion, Intrusion};
use crate::lockstep::recorded::{run_difference, run_intrusion};
use crate::lockstep::run::{ComparedStep, Lockstep};
use rockproof_model::{Precision, Scene, ToleranceSet};
use rockproof_simulate::checkpoint::SavedState;
use rockproof_simulate::identity::with_tolerances;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Solve, State};
use std::collections::BTreeSet;

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

/// A scene of more blocks is not stepped as a whole to find causes: exact steps of it, of which there may be 250, take hours.
const MOST_BLOCKS: usize = 64;

/// The stepper's own step must show the intrusion with at least so much of its depth where blocks are left out.
const SAME_DEPTH: f64 = 0.5;

/// Finds the case of an intrusion in the step after a state: of its two blocks alone, of these and all that are in contact with them, or of the
/// whole scene, whichever is the first in which the stepper does it again. `None` where none of them is, or the oracle cannot make the step.
pub fn intrusion_case<R: Solve>(
    scene: &Scene,
    set: &ToleranceSet,
    precision: Precision,
    state: &State<R>,
    found: FoundIntrusion,
) -> Option<IntrusionCase> {
    let pair: BTreeSet<usize> = found.blocks.into();
    let touching = state.contacts.iter().map(|contact| contact.blocks.map(|block| block as usize));
    let touching = touching.filter(|blocks| blocks.iter().any(|block| pair.contains(block))).flatten();
    let neighbours: BTreeSet<usize> = pair.iter().copied().chain(touching).collect();
    let whole: BTreeSet<usize> = (0..scene.blocks.len()).collect();
    let mut choices = vec![pair, neighbours, whole];
    choices.dedup();
    choices.retain(|blocks| blocks.len() <= MOST_BLOCKS);
    choices.into_iter().find_map(|blocks| {
        let blocks: Vec<usize> = blocks.into_iter().collect();
        of_blocks(scene, set, precision, state, found, &blocks)
    })
}

fn of_blocks<R: Solve>(
    scene: &Scene,
    set: &ToleranceSet,
    precision: Precision,
    state: &State<R>,
    found: FoundIntrusion,
    blocks: &[usize],
) -> Option<IntrusionCase> {
    let (part, before) = cutout(scene, state, blocks);
    let lockstep = Lockstep::<R, SpecRules>::new(&part, set, precision, ComparedLinks::All).ok()?;
    let mut lockstep = lockstep.watching();
    lockstep.restore(before.clone()).ok()?;
    let compared = lockstep.step().1;
    let watched = compared.watched.as_ref()?;
    let place = |block: usize| blocks.iter().position(|&kept| kept == block);
    let pair = [place(found.blocks[0])?, place(found.blocks[1])?];
    let again = watched.stepper.between(found.kind, pair)?;
    if again.depth.unwrap_or(f64::INFINITY) < SAME_DEPTH * found.depth_m {
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

/// All that differs in a step, as a case of a run has it.
fn recorded(compared: &ComparedStep) -> Vec<String> {
    let intrusions = compared.watched.iter().flat_map(|watched| &watched.attributed).map(run_intrusion);
    compared.differences.iter().map(run_difference).chain(intrusions).collect()
}
