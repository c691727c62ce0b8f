//! A state file made smaller for as long as its step shows the same difference: fewer blocks, a step from rest in place of a later one, less motion,
//! simpler blocks.

use super::finding::StepFinding;
use crate::shrink::{BlockQuestion, BlockShrinker, Refusals};
use rockproof_differential::collapse::collapsed_feature;
use rockproof_differential::lockstep::case_file::Expected;
use rockproof_differential::lockstep::cutout::cutout;
use rockproof_differential::lockstep::penetration::DepthDifference;
use rockproof_differential::lockstep::recorded::{pair_difference, pair_intrusion, run_difference, run_intrusion};
use rockproof_differential::lockstep::replay::recorded_depths;
use rockproof_differential::lockstep::{ComparedLinks, ComparedStep, Lockstep, ReplayError, StepCase};
use rockproof_model::simulation::Kinematics;
use rockproof_model::{Block, Motion, Number, Precision, Scene, ToleranceSet, Vec3};
use rockproof_simulate::checkpoint::SavedState;
use rockproof_simulate::identity::with_tolerances;
use rockproof_stepper::Real;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Solve, State};
use std::sync::atomic::{AtomicU64, Ordering};

/// Why a state file cannot be made smaller.
#[derive(Debug, thiserror::Error)]
pub enum StepShrinkError {
    /// Its step cannot be made.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// Its step shows nothing of what it records.
    #[error(
        "the step shows none of the differences that the file records ({0}); allowed are files of which it shows a passage, an unseen overlap or another decision"
    )]
    NotShown(String),
    /// The smaller file cannot be written.
    #[error("the smaller step cannot be recorded")]
    Unrecorded,
}

/// The smallest case found of the first passage or unseen overlap that a state file records and its step shows, else of the first other difference;
/// at most so many steps are made, and `made` counts them.
///
/// # Errors
/// When the step cannot be made, or shows nothing that the file records.
pub fn shrink(case: &StepCase, steps: u64, made: &AtomicU64) -> Result<StepCase, StepShrinkError> {
    let precision = case.precision().map_err(ReplayError::from)?;
    match precision {
        Precision::F32 => shrunk::<f32>(case, precision, (steps, made)),
        Precision::F64 => shrunk::<f64>(case, precision, (steps, made)),
    }
}

fn shrunk<R: Solve>(
    case: &StepCase,
    precision: Precision,
    (steps, made): (u64, &AtomicU64),
) -> Result<StepCase, StepShrinkError> {
    let (scene, set) = case.scene().map_err(ReplayError::from)?;
    let state = case.state.state::<R>().map_err(ReplayError::from)?;
    let watches = case.expected.intrusions.is_some();
    let measures = recorded_depths(case).next().is_some();
    let mut shrinker = StepShrinker {
        set,
        precision,
        watches,
        measures,
        wanted: WantedDifference::Words(String::new()),
        left: steps.max(1),
        made,
    };
    let not_shown = || StepShrinkError::NotShown(case.differences.join("; "));
    let first = shrinker.made(&scene, Some(&state)).ok_or_else(not_shown)?;
    let is_recorded =
        |both: [String; 2]| both.iter().any(|words| case.differences.contains(words)).then(|| both[0].clone());
    let intrusions = first.compared.watched.iter().flat_map(|watched| &watched.attributed);
    let intrusions = intrusions.filter_map(|one| is_recorded([pair_intrusion(one), run_intrusion(one)]));
    let decisions = first.compared.differences.iter();
    let decisions = decisions.filter_map(|one| is_recorded([pair_difference(one), run_difference(one)]));
    let depth = recorded_depths(case).find(|recorded| first.depth.is_some_and(|one| one.is_as(recorded)));
    // Only a case that is about depths records them.
    shrinker.wanted = match depth {
        Some(depth) => WantedDifference::Depth(depth),
        None => WantedDifference::Words(intrusions.chain(decisions).next().ok_or_else(not_shown)?),
    };
    let best = shrinker.smallest(first);
    shrinker.recorded(&best).ok_or(StepShrinkError::Unrecorded)
}

/// A step that was made.
struct MadeStep<R> {
    scene: Scene,
    before: State<R>,
    /// Whether the scene begins in that state.
    is_first: bool,
    compared: ComparedStep,
    /// How the depths after it differ, where the case records that they do.
    depth: Option<DepthDifference>,
}

/// The difference to be shown.
enum WantedDifference {
    /// In the words of a campaign's case.
    Words(String),
    /// Depths that differ by at least [`StepFinding::SHARE_OF_DEPTH`] of that.
    Depth(DepthDifference),
}

/// Makes one step smaller.
struct StepShrinker<'m> {
    set: ToleranceSet,
    precision: Precision,
    /// Whether passages and unseen overlaps are looked for.
    watches: bool,
    /// Whether depths are compared.
    measures: bool,
    wanted: WantedDifference,
    left: u64,
    /// Counts the steps that are made.
    made: &'m AtomicU64,
}

impl StepShrinker<'_> {
    fn made<R: Solve>(&mut self, scene: &Scene, state: Option<&State<R>>) -> Option<MadeStep<R>> {
        self.left = self.left.checked_sub(1)?;
        self.made.fetch_add(1, Ordering::Relaxed);
        let has_all =
            |block: &Block| block.rounded(self.precision).is_some_and(|block| collapsed_feature(&block).is_none());
        if !scene.shapes().into_iter().all(has_all) {
            return None;
        }
        let links = ComparedLinks::All;
        let mut lockstep = Lockstep::<R, SpecRules>::new(scene, &self.set, self.precision, links).ok()?;
        if self.watches {
            lockstep = lockstep.watching();
        }
        let begin = lockstep.state().clone();
        if let Some(state) = state {
            lockstep.restore(state.clone()).ok()?;
        }
        let before = lockstep.state().clone();
        let compared = lockstep.step().1;
        // Without the oracle's answer there is nothing to record.
        compared.oracle.as_ref()?;
        let mut depth = None;
        if self.measures {
            let drifts = lockstep.drift(&before, &compared).is_some();
            depth = DepthDifference::of(&scene.shapes(), self.precision, &compared, drifts);
        }
        Some(MadeStep { scene: scene.clone(), is_first: before == begin, before, compared, depth })
    }

    /// The blocks of the difference to be shown; none of one that is about no pair. `None` where the step does not show it.
    fn shown<R>(&self, made: &MadeStep<R>) -> Option<Option<[usize; 2]>> {
        let wanted = match &self.wanted {
            WantedDifference::Words(words) => words,
            WantedDifference::Depth(wanted) => {
                let is_shown = |one: &DepthDifference| {
                    one.cause == wanted.cause && one.deeper_by() / wanted.deeper_by() >= StepFinding::SHARE_OF_DEPTH
                };
                return made.depth.as_ref().is_some_and(is_shown).then_some(None);
            }
        };
        let compared = &made.compared;
        let mut intrusions = compared.watched.iter().flat_map(|watched| &watched.attributed);
        if let Some(one) = intrusions.find(|one| pair_intrusion(one) == *wanted) {
            return Some(Some(one.blocks));
        }
        let one = compared.differences.iter().find(|one| pair_difference(one) == *wanted)?;
        Some(one.difference.contact.map(|(blocks, _)| blocks.map(|block| block as usize)))
    }

    /// Replaces the best step by that of another scene and state, the scene's own where none is given, if it shows the difference.
    fn keep<R: Solve>(&mut self, best: &mut MadeStep<R>, scene: &Scene, state: Option<&State<R>>) -> bool {
        let made = self.made(scene, state).filter(|made| self.shown(made).is_some());
        made.map(|made| *best = made).is_some()
    }

    fn smallest<R: Solve>(&mut self, mut best: MadeStep<R>) -> MadeStep<R> {
        self.drop_blocks(&mut best);
        if !best.is_first
            && let Some(scene) = begun(&best.scene, &best.before)
        {
            self.keep(&mut best, &scene, None);
        }
        // A later step is made from a state that simpler motions, or other blocks, do not come to.
        if !best.is_first {
            return best;
        }
        for simpler in simplifications() {
            let mut scene = best.scene.clone();
            simpler(&mut scene);
            if scene != best.scene {
                self.keep(&mut best, &scene, None);
            }
        }
        if let [a, b] = &best.scene.blocks[..] {
            let mut blocks = [a.block.clone(), b.block.clone()];
            let mut shows = |asked: BlockQuestion<'_>| {
                let BlockQuestion::Now(blocks) = asked else {
                    self.left = self.left.checked_sub(1)?;
                    return Some(false);
                };
                let mut scene = best.scene.clone();
                for (of_scene, block) in scene.blocks.iter_mut().zip(blocks) {
                    of_scene.block = block.clone();
                }
                (self.left > 0).then(|| self.keep(&mut best, &scene, None))
            };
            let refusals = &mut Refusals::default();
            BlockShrinker { shows: &mut shows, is_spent: false, refusals }.shrink(&mut blocks);
        }
        best
    }

    /// Leaves out blocks: all but the two of the difference, or all but these and what is in contact with them.
    fn drop_blocks<R: Solve>(&mut self, best: &mut MadeStep<R>) {
        let Some(Some(pair)) = self.shown(best) else { return };
        let touching = best.before.contacts.iter().map(|contact| contact.blocks.map(|block| block as usize));
        let touching: Vec<[usize; 2]> =
            touching.filter(|blocks| blocks.iter().any(|block| pair.contains(block))).collect();
        let mut neighbours: Vec<usize> = touching.into_iter().flatten().chain(pair).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        for blocks in [&pair[..], &neighbours] {
            if blocks.len() < best.scene.blocks.len() {
                let (scene, state) = cutout(&best.scene, &best.before, blocks);
                if self.keep(best, &scene, Some(&state)) {
                    return;
                }
            }
        }
    }

    fn recorded<R: Real>(&self, best: &MadeStep<R>) -> Option<StepCase> {
        let compared = &best.compared;
        let intrusions = compared.watched.iter().flat_map(|watched| &watched.attributed).map(run_intrusion);
        let depth = best.depth.iter().map(DepthDifference::words);
        Some(StepCase {
            format: StepCase::FORMAT.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            engine: self.precision.to_string(),
            step: compared.step,
            differences: compared.differences.iter().map(run_difference).chain(intrusions).chain(depth).collect(),
            scene: with_tolerances(&best.scene, &self.set).ok()?,
            state: SavedState::of(&best.before),
            expected: Expected::of_step(compared)?,
        })
    }
}

/// A scene that begins where a state has its blocks, with their velocities and stresses; rates of strain, contacts and what acts on points of blocks are left
/// out. `None` where a number is not finite.
fn begun<R: Real>(scene: &Scene, state: &State<R>) -> Option<Scene> {
    let number = |value: R| Number::from_f64(value.to_f64()).ok();
    let mut begun = scene.clone();
    for (block, now) in begun.blocks.iter_mut().zip(&state.blocks) {
        let vertices = now.vertices.iter().map(|v| Some(Vec3::new(number(v.x)?, number(v.y)?, number(v.z)?)));
        block.block = block.block.with_vertices(vertices.collect::<Option<_>>()?);
        // Faces of blocks that moved are planar within rounding alone.
        block.planarity = Number::from_integer(1);
        let rate = |first: usize| {
            Some(Vec3::new(
                number(now.velocity[first])?,
                number(now.velocity[first + 1])?,
                number(now.velocity[first + 2])?,
            ))
        };
        (block.body.velocity, block.body.spin) = (rate(0)?, rate(3)?);
        for (stress, value) in block.body.stress.iter_mut().zip(now.stress) {
            *stress = number(value)?;
        }
    }
    let simulation = &mut begun.simulation;
    simulation.loads.clear();
    simulation.fixed_points.clear();
    simulation.measured_points.clear();
    simulation.control.settle = 0;
    Some(begun)
}

/// What may be left out of a scene, one after the other.
fn simplifications() -> [fn(&mut Scene); 9] {
    fn still() -> Vec3<Number> {
        Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO)
    }
    [
        |scene| scene.blocks.iter_mut().for_each(|block| block.body.spin = still()),
        |scene| scene.blocks.iter_mut().for_each(|block| block.body.velocity = still()),
        |scene| scene.blocks.iter_mut().for_each(|block| block.body.stress = [const { Number::ZERO }; 6]),
        |scene| scene.simulation.gravity = still(),
        |scene| scene.simulation.joints.all_mut().for_each(|joint| joint.cohesion = Number::ZERO),
        |scene| scene.simulation.joints.all_mut().for_each(|joint| joint.tension = Number::ZERO),
        |scene| scene.simulation.control.kinematics = Kinematics::Linear,
        |scene| scene.simulation.control.dynamic = Number::from_integer(1),
        |scene| {
            for block in scene.blocks.iter_mut().filter(|block| block.body.motion == Motion::Deformable) {
                block.body.motion = Motion::Rigid;
            }
        },
    ]
}
