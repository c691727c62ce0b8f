//! The case file of a finding about a step: the scene, the state before the step, and the oracle's answer, for `replay`.

use super::engine::{ComparedPairStep, StepEngine};
use super::finding::{StepChange, StepFinding};
use crate::shrink::{BlockQuestion, BlockShrinker, Refusals};
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::StepCase;
use rockproof_differential::lockstep::case_file::Expected;
use rockproof_differential::lockstep::penetration::DepthDifference;
use rockproof_differential::lockstep::recorded::{pair_difference, pair_intrusion};
use rockproof_differential::motion::PairMotion;
use rockproof_differential::subject::{NamedSet, Subject};
use rockproof_model::simulation::Kinematics;
use rockproof_model::{Body, Motion, Number, Precision, Vec3};
use rockproof_simulate::identity::with_tolerances;

/// Makes the case of a finding: its step alone, from the state before it, with as little motion as still shows it; of a passage or an
/// unseen overlap the blocks are made smaller too, for which at most a share of `evaluations` steps are made. `None` where
/// the engine does not take part, or the step cannot be made exactly. It is made on a thread of its own ([`super::examine_all`]).
pub fn of(
    finding: &StepFinding,
    subject: &Subject,
    motion: &PairMotion,
    engines: &[Box<dyn StepEngine>],
    evaluations: u64,
) -> Option<StepCase> {
    let case = || made(finding, subject, motion, engines, evaluations / STEP_EVALUATIONS);
    std::thread::scope(|scope| match scope.spawn(case).join() {
        Ok(case) => case,
        Err(panic) => std::panic::resume_unwind(panic),
    })
}

/// A step takes about so many times as long as the examination of a pair.
pub const STEP_EVALUATIONS: u64 = 6;

/// Whether a finding can have a case, without making it small where that is not needed to know: `false` only if [`of`] gives `None`.
pub fn is_possible(
    finding: &StepFinding,
    subject: &Subject,
    motion: &PairMotion,
    engines: &[Box<dyn StepEngine>],
) -> bool {
    let possible = || {
        let Some(made) = shown_again(finding, subject, motion, engines) else { return false };
        // Another motion may let the oracle's step come to its end.
        made.compared.oracle.is_some() || self::made(finding, subject, motion, engines, 0).is_some()
    };
    std::thread::scope(|scope| match scope.spawn(possible).join() {
        Ok(possible) => possible,
        Err(panic) => std::panic::resume_unwind(panic),
    })
}

/// The step of a finding, made once more under a motion, if it shows the finding.
fn shown_again(
    finding: &StepFinding,
    subject: &Subject,
    motion: &PairMotion,
    engines: &[Box<dyn StepEngine>],
) -> Option<ComparedPairStep> {
    let set = subject.sets.iter().find(|set| set.name == finding.set)?;
    let engine = engines.iter().find(|engine| engine.name() == &*finding.engine)?;
    let steps = engine.steps(subject, set, motion).ok()?;
    steps.into_iter().find(|made| made.compared.step == finding.step).filter(|made| reproduces(made, finding))
}

fn made(
    finding: &StepFinding,
    subject: &Subject,
    motion: &PairMotion,
    engines: &[Box<dyn StepEngine>],
    evaluations: u64,
) -> Option<StepCase> {
    let set = subject.sets.iter().find(|set| set.name == finding.set)?;
    let engine = &**engines.iter().find(|engine| engine.name() == &*finding.engine)?;
    let again = |subject: &Subject, motion: &PairMotion| shown_again(finding, subject, motion, engines);
    let mut best = ShownStep { subject: subject.clone(), motion: motion.clone(), made: again(subject, motion)? };
    // A later step is made from a state that simpler motions, or other blocks, do not come to.
    if finding.step == 1 {
        for simpler in simplifications() {
            let tried = simpler(&best.motion);
            if tried != best.motion
                && let Some(made) = again(&best.subject, &tried)
            {
                (best.motion, best.made) = (tried, made);
            }
        }
        if matches!(finding.change, StepChange::Intrusion(_)) {
            best.shrink_blocks(again, evaluations);
        }
    }
    written(finding, set, engine.precision(), &best)
}

/// A step that shows a finding.
struct ShownStep {
    subject: Subject,
    motion: PairMotion,
    made: ComparedPairStep,
}

impl ShownStep {
    /// How the depths after it differ.
    fn depth(&self, precision: Precision) -> Option<DepthDifference> {
        self.made.depth_difference(&self.subject, precision)
    }

    /// Makes the blocks smaller for as long as `again` makes a step that shows the finding; at most so many are made.
    fn shrink_blocks(
        &mut self,
        again: impl Fn(&Subject, &PairMotion) -> Option<ComparedPairStep>,
        mut evaluations: u64,
    ) {
        let mut blocks = [self.subject.a.clone(), self.subject.b.clone()];
        let mut shows = |asked: BlockQuestion<'_>| {
            evaluations = evaluations.checked_sub(1)?;
            let BlockQuestion::Now([a, b]) = asked else { return Some(false) };
            let subject = Subject { a: a.clone(), b: b.clone(), ..self.subject.clone() };
            let made = again(&subject, &self.motion);
            let is_shown = made.is_some();
            if let Some(made) = made {
                (self.subject, self.made) = (subject, made);
            }
            Some(is_shown)
        };
        let refusals = &mut Refusals::default();
        BlockShrinker { shows: &mut shows, is_spent: false, refusals }.shrink(&mut blocks);
    }
}

fn written(finding: &StepFinding, set: &NamedSet, precision: Precision, shown: &ShownStep) -> Option<StepCase> {
    let ShownStep { subject, motion, made } = shown;
    let tolerances = set.of(precision);
    let scene = motion.scene(&subject.a, &subject.b, tolerances);
    let mut differences: Vec<String> = made.compared.differences.iter().map(pair_difference).collect();
    match finding.change {
        StepChange::Decision(_) => {}
        // All of them, so that who replays the case knows which are new.
        StepChange::Intrusion(_) => {
            let watched = made.compared.watched.iter().flat_map(|watched| &watched.attributed);
            differences.extend(watched.map(pair_intrusion));
        }
        // That of this step, whose motion is simpler than the finding's.
        StepChange::Deeper | StepChange::Shallower => differences.push(shown.depth(precision)?.words()),
        StepChange::State(_) => {
            let StepFinding { cause, change, before, after, .. } = finding;
            differences.push(format!("{cause} {}: {before} → {after}", change.name()));
        }
    }
    let about_intrusion = matches!(finding.change, StepChange::Intrusion(_));
    let expected = if about_intrusion {
        Expected::of_step(&made.compared)
    } else {
        made.compared.oracle.as_ref().map(Expected::of)
    };
    Some(StepCase {
        format: StepCase::FORMAT.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        engine: precision.to_string(),
        step: finding.step,
        differences,
        scene: with_tolerances(&scene, tolerances).ok()?,
        state: made.before.clone(),
        expected: expected?,
    })
}

/// Whether a step shows what a finding says.
fn reproduces(made: &ComparedPairStep, finding: &StepFinding) -> bool {
    let compared = &made.compared;
    match finding.change {
        StepChange::Decision(change) => compared.differences.iter().any(|c| {
            let d = &c.difference;
            let same = (c.cause.into(), d.change, d.contact.map(|(_, contact)| contact))
                == (finding.cause, change, finding.contact);
            same && d.before == finding.before && d.after == finding.after
        }),
        StepChange::State(what) => made.drift == Some(what),
        StepChange::Intrusion(kind) => {
            compared.watched.iter().flat_map(|watched| &watched.attributed).any(|attributed| {
                (attributed.kind, attributed.cause, attributed.words()[1]) == (kind, finding.cause, &*finding.after)
            })
        }
        StepChange::Deeper | StepChange::Shallower => {
            let [Some(stepper), Some(oracle)] = compared.penetration else { return false };
            let [Some(was), Some(right)] = finding.penetration else { return false };
            let same_cause = (compared.count(Cause::Defect) > 0) == (finding.cause == Cause::Defect.into());
            // As much of a difference as was found, in the same direction.
            same_cause
                && (stepper - oracle) * (was - right).signum() >= StepFinding::SHARE_OF_DEPTH * (was - right).abs()
        }
    }
}

type Simplification = fn(&PairMotion) -> PairMotion;

/// What may be left out of a motion, one after the other.
fn simplifications() -> [Simplification; 9] {
    fn still() -> Vec3<Number> {
        Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO)
    }
    fn bodies(motion: &PairMotion, change: impl Fn(&mut Body)) -> PairMotion {
        let mut motion = motion.clone();
        motion.bodies.iter_mut().for_each(change);
        motion
    }
    fn simulation(motion: &PairMotion, change: impl Fn(&mut rockproof_model::simulation::Simulation)) -> PairMotion {
        let mut motion = motion.clone();
        change(&mut motion.simulation);
        motion
    }
    [
        |motion| PairMotion { steps: 1, ..motion.clone() },
        |motion| bodies(motion, |body| body.spin = still()),
        |motion| bodies(motion, |body| body.velocity = still()),
        |motion| simulation(motion, |simulation| simulation.gravity = still()),
        |motion| simulation(motion, |simulation| simulation.joints.other.cohesion = Number::ZERO),
        |motion| simulation(motion, |simulation| simulation.joints.other.tension = Number::ZERO),
        |motion| simulation(motion, |simulation| simulation.control.kinematics = Kinematics::Linear),
        |motion| simulation(motion, |simulation| simulation.control.dynamic = Number::from_integer(1)),
        |motion| {
            bodies(motion, |body| {
                if body.motion == Motion::Deformable {
                    body.motion = Motion::Rigid;
                }
            })
        },
    ]
}
