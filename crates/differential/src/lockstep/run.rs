//! Lockstep: every step of a stepper's run made exactly as well, from the state in which the stepper is.

// Longer than 400 lines: one step of both sides, what is compared of it and what is asked for causes.

use crate::finding::Cause;
use crate::lockstep::answer::{StepDecisions, StepDifference, compare};
use crate::lockstep::classified::ClassifiedBlocks;
use crate::lockstep::explain::{
    AttributedDifference, ComparedLinks, Explainer, LinkSide, measure_modes, stepper_trace,
};
use crate::lockstep::intrusion::{IntrusionCheck, WatchedStep};
use crate::lockstep::penetration::{StepPenetrations, penetration};
use crate::lockstep::scene::{ExactScene, NumberOverflow};
use crate::lockstep::state::{NotFinite, exact_state};
use crate::lockstep::state_errors::{anchor_error, displacement_error, velocity_error};
use crate::lockstep::wide::{WideDecisions, WideError, WideStepper};
use rockproof_model::{Block, ContactKey, Precision, Scene, ToleranceSet};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::step::{self as exact, CertifiedStep, KeptPrecision, KnownNeighbours, StepAnswer, StepFailure};
use rockproof_stepper::dynamics::{
    Dynamics, PrescribedAttempt, PrescribedStep, SetupError, Solve, State, StepError, StepReport, StepRules,
};
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// What the oracle keeps of coordinates after a step: far finer than any engine, and within reach of balls of two f64.
pub const KEPT_PRECISION: KeptPrecision = KeptPrecision::Grid { exponent: KEPT_EXPONENT };

/// Its grid is that of multiples of 2 to the power of minus this (m).
pub(super) const KEPT_EXPONENT: u32 = 80;

/// A step made on both sides.
#[derive(Clone, Debug)]
pub struct ComparedStep {
    /// Its number, from 1; settling steps before have the numbers −n + 1 to 0.
    pub step: i64,
    /// The time after it (s); before it, where the stepper cannot make it.
    pub time: f64,
    /// What the stepper decided, if it made the step.
    pub stepper: Option<StepDecisions>,
    /// What the oracle decided, if it made the step.
    pub oracle: Option<StepDecisions>,
    /// All differences, by link of the chain.
    pub differences: Vec<AttributedDifference>,
    /// The largest relative error of a block's displacement, and the block; nothing where nothing moves.
    pub displacement: Option<(f64, usize)>,
    /// The largest relative error of a block's velocity; nothing where nothing has one.
    pub velocity: Option<f64>,
    /// The largest error of an anchor of a closed contact (m).
    pub anchors: Option<f64>,
    /// The exact penetration after the stepper's step and after the oracle's (m).
    pub penetration: [Option<f64>; 2],
    /// Penetrations with the oracle's contacts and modes, where these differ.
    pub depths: Option<StepPenetrations>,
    /// Passages and unseen overlaps, where they are looked for ([`Lockstep::watching`]) and both sides made the step.
    pub watched: Option<WatchedStep>,
    /// Decisions that the oracle's cap left open.
    pub undecided: u64,
    /// Whether the wide scalar left a comparison unsettled; asked only where stepper and oracle differ.
    pub unsettled: Option<bool>,
    /// Why a side cannot make the step.
    pub failure: String,
    /// Why the oracle cannot make the step, if it cannot and the stepper can.
    pub unproved: Option<StepFailure>,
    /// Time that stepper and oracle took, each with all it did.
    pub took: [Duration; 2],
}

impl ComparedStep {
    /// Differences of one cause.
    pub fn count(&self, cause: Cause) -> usize {
        self.differences.iter().filter(|attributed| attributed.cause == cause).count()
    }

    /// Whether neither side found a contact, so that nothing but falling was compared. Of a step that no side made that is not known: it says no.
    pub fn has_no_contacts(&self) -> bool {
        StepDecisions::are_without_contacts([&self.stepper, &self.oracle])
    }

    /// Whether the stepper differs from its exact counterpart.
    pub fn differs(&self) -> bool {
        self.count(Cause::Arithmetic) + self.count(Cause::Defect) > 0
    }
}

/// The share of the largest displacement that a step may make below which a block is nearly at rest.
pub(super) const NEARLY_AT_REST: f64 = 1e-12;

/// Why a scene cannot be run in lockstep.
#[derive(Debug, thiserror::Error)]
pub enum LockstepError {
    /// The stepper cannot step it.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A number has no counterpart in the engine's precision.
    #[error(transparent)]
    Overflow(#[from] NumberOverflow),
    /// The wide scalar cannot step it.
    #[error(transparent)]
    Wide(#[from] WideError),
}

/// A stepper with the oracle beside it.
#[derive(Debug)]
pub struct Lockstep<R, M> {
    dynamics: Dynamics<R, M>,
    begin: State<R>,
    /// The scene as it is, with ideal tolerances, and as the engine has it.
    ideal: ExactScene,
    given: ExactScene,
    rounded: ExactScene,
    /// Whether rounding changes no number of the scene.
    same: bool,
    precision: Precision,
    links: ComparedLinks,
    /// Whether steps are looked through for passages and unseen overlaps.
    watches: bool,
    wide: Option<WideStepper<M>>,
    /// Pairs whose contacts differed in the last step by some cause: in the next one, in all likelihood, they do again.
    differing: BTreeSet<[u32; 2]>,
    /// What steps know of neighbours: of the scene as it is with ideal tolerances, with its own, and as the engine has it.
    known: [KnownNeighbours; 3],
}

/// What the oracle decided in a step, or why it cannot make it.
type OracleStep = Result<StepDecisions, StepFailure>;

/// A step that the oracle decided without the state after it, or why it cannot make it.
type CertifiedOutcome = Result<CertifiedStep, StepFailure>;

/// The step of the scene without rounding: with ideal tolerances, and with its own, where the engine has other numbers.
struct ExactLinks {
    ideal: CertifiedOutcome,
    given: Option<CertifiedOutcome>,
}

impl<R: Solve, M: StepRules> Lockstep<R, M> {
    /// A scene at its beginning, in the scalar R, which is that of `precision`.
    ///
    /// # Errors
    /// When a number overflows in it, or a block collapses.
    pub fn new(
        scene: &Scene,
        set: &ToleranceSet,
        precision: Precision,
        links: ComparedLinks,
    ) -> Result<Lockstep<R, M>, LockstepError> {
        let dynamics = Dynamics::with_rules(scene, set)?;
        let given = ExactScene::new(scene, set);
        let rounded = given.rounded(precision)?;
        let same = given.same_numbers(&rounded);
        let ideal = given.with_tolerances(set.ideal());
        let begin = dynamics.state().clone();
        let (watches, wide, differing) = (false, None, BTreeSet::new());
        let known = Default::default();
        Ok(Lockstep { dynamics, begin, ideal, given, rounded, same, precision, links, watches, wide, differing, known })
    }

    /// The same lockstep, which also looks for passages within its steps and for unseen overlaps after them.
    #[must_use]
    pub fn watching(self) -> Lockstep<R, M> {
        Lockstep { watches: true, ..self }
    }

    /// Goes on from another state.
    ///
    /// # Errors
    /// When the state does not fit the scene.
    pub fn restore(&mut self, state: State<R>) -> Result<(), SetupError> {
        self.dynamics.restore(state)
    }

    /// The state after the stepper's last step.
    pub fn state(&self) -> &State<R> {
        self.dynamics.state()
    }

    /// The scene as the engine has it.
    pub fn rounded(&self) -> &ExactScene {
        &self.rounded
    }

    /// The engine's precision.
    pub(super) fn precision(&self) -> Precision {
        self.precision
    }

    /// The scene as the engine has it, and the stepper's code in 512 bits, which is made when it is first asked.
    pub(super) fn rounded_and_wide(&mut self) -> (&ExactScene, &mut Option<WideStepper<M>>) {
        (&self.rounded, &mut self.wide)
    }

    /// One step on both sides. The state goes on with the stepper's.
    pub fn step(&mut self) -> (Result<StepReport, StepError>, ComparedStep) {
        let before = self.dynamics.state().clone();
        let settling = before.settling > 0;
        let number = if settling { 1 - i64::from(before.settling) } else { before.step as i64 + 1 };
        let begun = Instant::now();
        let made = self.dynamics.step();
        let mut compared = ComparedStep {
            step: number,
            time: self.dynamics.state().time.to_f64(),
            stepper: None,
            oracle: None,
            differences: Vec::new(),
            displacement: None,
            velocity: None,
            anchors: None,
            penetration: [None; 2],
            depths: None,
            watched: None,
            undecided: 0,
            unsettled: None,
            failure: String::new(),
            unproved: None,
            took: [begun.elapsed(), Duration::ZERO],
        };
        let begun = Instant::now();
        match exact_state(&before) {
            Err(NotFinite) => compared.failure = format!("oracle: {NotFinite}"),
            Ok(start) => self.compare(&before, &start, &made, &mut compared),
        }
        compared.took[1] = begun.elapsed();
        (made, compared)
    }

    fn compare(
        &mut self,
        before: &State<R>,
        start: &exact::State,
        made: &Result<StepReport, StepError>,
        compared: &mut ComparedStep,
    ) {
        let prepare = |blocks: &[Block]| -> Vec<PreparedBlock> { blocks.iter().map(PreparedBlock::new).collect() };
        let blocks = self.rounded.blocks_at(start);
        let prepared = prepare(&blocks);
        let here = ClassifiedBlocks::new(&blocks, &prepared);
        // The first step is made from the scene as it is; every later state is the engine's own, in which the blocks of both scenes are the same.
        let is_first = self.links == ComparedLinks::All && *before == self.begin;
        let begin = is_first.then(|| self.given.begin()).filter(|begin| begin != start);
        let begin_blocks = begin.as_ref().map_or(Vec::new(), |begin| self.given.blocks_at(begin));
        let begin_prepared = prepare(&begin_blocks);
        let there = ClassifiedBlocks::new(&begin_blocks, &begin_prepared);
        let unrounded = begin.as_ref().map_or((start, &here), |begin| (begin, &there));
        let mut known = std::mem::take(&mut self.known);
        let [of_ideal, of_given, of_rounded] = &mut known;
        let contacts = here.contacts(&self.rounded, start, &self.differing, of_rounded);
        let make = || self.rounded.step_with(start, KEPT_PRECISION, contacts);
        let (exact, links) = match self.links {
            ComparedLinks::Arithmetic => (make(), None),
            ComparedLinks::All => {
                let alike = self.same && begin.is_none();
                let (state, blocks) = unrounded;
                let found = |scene, known| blocks.contacts(scene, state, &self.differing, known);
                let (ideal, given) = (found(&self.ideal, of_ideal), (!alike).then(|| found(&self.given, of_given)));
                let decide = || ExactLinks {
                    ideal: self.ideal.decide_with(state, ideal),
                    given: given.map(|given| self.given.decide_with(state, given)),
                };
                let (exact, links) = beside_one_another(make, decide);
                (exact, Some(links))
            }
        };
        self.known = known;
        if let Some(links) = links {
            let decided = exact.as_ref().map(StepDecisions::of_oracle).map_err(Clone::clone);
            self.attribute_links(links, unrounded, (start, &here), &decided, compared);
        }
        let attempts = self.dynamics.modes();
        compared.stepper = made.as_ref().ok().map(|r| StepDecisions::of_stepper(r, attempts, self.dynamics.state()));
        compared.oracle = exact.as_ref().ok().map(StepDecisions::of_oracle);
        compared.undecided = exact.as_ref().map_or(0, |answer| answer.levels.undecided);
        match (&exact, made) {
            (Ok(exact), Ok(_)) => {
                self.engine_link(before, (start, &here), exact, compared);
                let after = exact_state(self.dynamics.state());
                if let Ok(after) = &after {
                    compared.displacement = displacement_error(start, after, &exact.state);
                    compared.velocity = velocity_error(after, &exact.state);
                    compared.anchors = anchor_error(after, &exact.state);
                    compared.watched = self.watches.then(|| self.watch(before, start, [&exact.state, after]));
                }
                let oracle = penetration(&self.rounded, &exact.state);
                let stepper = after.ok().and_then(|after| penetration(&self.rounded, &after));
                compared.penetration = [stepper, oracle];
                let decisive = |c: &AttributedDifference| c.difference.is_of_contacts() || c.difference.solve.is_some();
                let own = |c: &AttributedDifference| matches!(c.cause, Cause::Arithmetic | Cause::Defect);
                if compared.differences.iter().any(|c| own(c) && decisive(c)) {
                    compared.depths = stepper.zip(oracle).and_then(|ends| self.depths(before, exact, ends.into()));
                }
            }
            (Err(failure), Ok(_)) => {
                compared.failure = format!("oracle: {failure}");
                compared.unproved = Some(failure.clone());
            }
            (Ok(_), Err(stopped)) => {
                compared.failure = format!("stepper: {stopped}");
                let difference = StepDifference::stopped("", stopped);
                let cause = self.cause_of_stop(before, compared);
                compared.differences.push(AttributedDifference::new(cause, difference));
            }
            (Err(failure), Err(stopped)) => compared.failure = format!("stepper: {stopped}; oracle: {failure}"),
        }
        let differences = compared.differences.iter().map(|attributed| &attributed.difference);
        let pair = |difference: &StepDifference| difference.contact.map(|(pair, _)| pair);
        self.differing = differences.filter(|difference| difference.is_of_contacts()).filter_map(pair).collect();
    }

    /// Tolerance and representation: of the state as it is without rounding, and as the engine has it.
    fn attribute_links<'b>(
        &self,
        ExactLinks { ideal, given: given_step }: ExactLinks,
        (unrounded, unrounded_blocks): (&exact::State, &ClassifiedBlocks<'b>),
        (start, here): (&exact::State, &ClassifiedBlocks<'b>),
        rounded: &OracleStep,
        compared: &mut ComparedStep,
    ) {
        let decisions = |step: &CertifiedOutcome| -> OracleStep {
            step.as_ref().map(StepDecisions::of_certified).map_err(Clone::clone)
        };
        let ideal = decisions(&ideal);
        let own = given_step.as_ref().map(decisions);
        let given = own.as_ref().unwrap_or(rounded);
        let (ideal_side, given_side) = (self.ideal.tolerances(), self.given.tolerances());
        let side = |tolerances| LinkSide { blocks: unrounded_blocks, tolerances };
        let explainer =
            Explainer { before: side(ideal_side), after: side(given_side), roundoff: None, state: unrounded };
        let found = exact_differences(&ideal, given, &self.given.scene().shapes());
        compared.differences.extend(explainer.attribute(found, Cause::Tolerance, None));
        let Some(given_step) = given_step else { return };
        let after = LinkSide { blocks: here, tolerances: self.rounded.tolerances() };
        let explainer =
            Explainer { before: side(given_side), after, roundoff: Some(self.precision.epsilon() / 2.0), state: start };
        let found = exact_differences(given, rounded, &self.given.scene().shapes());
        let mut attributed = explainer.attribute(found, Cause::Representation, None);
        if let Ok(given) = &given_step {
            measure_modes(&mut attributed, given.into(), (&self.given, unrounded), self.precision.epsilon() / 2.0);
        }
        compared.differences.extend(attributed);
    }

    /// Arithmetic and defects.
    fn engine_link(
        &mut self,
        before: &State<R>,
        (start, here): (&exact::State, &ClassifiedBlocks<'_>),
        exact: &StepAnswer,
        compared: &mut ComparedStep,
    ) {
        let (Some(stepper), Some(oracle)) = (&compared.stepper, &compared.oracle) else { return };
        let shapes = self.rounded.scene().shapes();
        let found = compare(oracle, stepper, &shapes);
        if found.is_empty() {
            return;
        }
        let in_wide = match wide_stepper(&mut self.wide, &self.rounded) {
            Some(wide) => wide.decide(before).ok(),
            None => None,
        };
        compared.unsettled = in_wide.as_ref().map(WideDecisions::is_unsettled);
        let remaining = match &in_wide {
            Some(WideDecisions::Settled(Ok(answer))) => compare(oracle, answer, &shapes),
            _ => Vec::new(),
        };
        let side = LinkSide { blocks: here, tolerances: self.rounded.tolerances() };
        let explainer =
            Explainer { before: side, after: side, roundoff: Some(self.precision.epsilon() / 2.0), state: start };
        let set = self.rounded.tolerances();
        let trace = |a: &Block, b: &Block, kept: &[ContactKey]| stepper_trace::<R, M>([a, b], set, kept);
        let mut attributed = explainer.attribute(found, Cause::Arithmetic, Some(&trace));
        for attributed in attributed.iter_mut().filter(|c| remaining.contains(&c.difference)) {
            attributed.cause = Cause::Defect;
        }
        measure_modes(&mut attributed, exact.into(), (&self.rounded, start), self.precision.epsilon() / 2.0);
        compared.differences.extend(attributed);
    }

    fn cause_of_stop(&mut self, before: &State<R>, compared: &mut ComparedStep) -> Cause {
        let wide = wide_stepper(&mut self.wide, &self.rounded).and_then(|wide| wide.decide(before).ok());
        compared.unsettled = wide.as_ref().map(WideDecisions::is_unsettled);
        match wide {
            Some(WideDecisions::Settled(Err(_))) => Cause::Defect,
            _ => Cause::Arithmetic,
        }
    }

    /// Passages and unseen overlaps of a step that ended in the states `after`, the oracle's and the stepper's.
    fn watch(&mut self, before: &State<R>, start: &exact::State, after: [&exact::State; 2]) -> WatchedStep {
        let own_begin = (*before == self.begin).then(|| self.given.begin());
        let unrounded = own_begin.as_ref().unwrap_or(start);
        let (scenes, alike) = ([&self.ideal, &self.given, &self.rounded], self.same && unrounded == start);
        let step = IntrusionCheck { scenes, alike, before: [unrounded, start], after, precision: self.precision };
        let wide = &mut self.wide;
        step.examine(|| {
            let step = wide_stepper(wide, scenes[2])?.step(before).ok()?;
            let (_, after) = step.outcome.ok().filter(|_| step.unsettled == 0)?;
            Some(scenes[2].kept(exact_state(&after).ok()?))
        })
    }

    /// The same step with the oracle's contacts, and with its modes too.
    fn depths(&self, before: &State<R>, exact: &StepAnswer, [stepper, oracle]: [f64; 2]) -> Option<StepPenetrations> {
        let answer = StepDecisions::of_oracle(exact);
        let modes: Vec<Vec<_>> = exact
            .modes
            .iter()
            .map(|all| all.iter().map(|mode| crate::lockstep::state::float_mode(*mode)).collect())
            .collect();
        let attempt = PrescribedAttempt { time_step: answer.time_step, modes: &modes };
        let mut again = self.dynamics.clone();
        let mut step = |attempt| {
            again.restore(before.clone()).ok()?;
            let report = again.step_prescribed(&PrescribedStep { contacts: &answer.contacts, attempt }).ok()?;
            let is_same = report.time_step == R::from_f64(answer.time_step).to_f64()
                && modes.split_first().is_some_and(|(first, later)| {
                    *first == again.first_modes() && again.modes().last().is_some_and(|found| found == later)
                });
            Some((exact_state(again.state()).ok()?, is_same))
        };
        let depth = |state: &exact::State| penetration(&self.rounded, state);
        let (by_contacts, is_same) = step(None)?;
        let contacts = depth(&by_contacts)?;
        // Where the stepper comes to the oracle's modes and Δt by itself, blocks end in the same place.
        let modes = if is_same {
            contacts
        } else {
            match step(Some(attempt))?.0 {
                by_modes if by_modes == by_contacts => contacts,
                by_modes => depth(&by_modes)?,
            }
        };
        Some(StepPenetrations { stepper, contacts, modes, oracle })
    }
}

/// Does two pieces of work on two threads. On a thread of a pool, as in a campaign, one after the other: there all threads have work, and one that waits for
/// the second piece would begin another step in the midst of this one.
fn beside_one_another<A: Send, B: Send>(one: impl FnOnce() -> A + Send, other: impl FnOnce() -> B + Send) -> (A, B) {
    match rayon::current_thread_index() {
        None => rayon::join(one, other),
        Some(_) => (one(), other()),
    }
}

/// The wide stepper, made when first asked; `None` where it cannot be.
pub(super) fn wide_stepper<'w, M: StepRules>(
    wide: &'w mut Option<WideStepper<M>>,
    scene: &ExactScene,
) -> Option<&'w mut WideStepper<M>> {
    if wide.is_none() {
        *wide = WideStepper::new(scene).ok();
    }
    wide.as_mut()
}

fn exact_differences(before: &OracleStep, after: &OracleStep, shapes: &[&Block]) -> Vec<StepDifference> {
    match (before, after) {
        (Ok(before), Ok(after)) => compare(before, after, shapes),
        (Err(before), Ok(_)) => vec![StepDifference::stopped(before, "")],
        (Ok(_), Err(after)) => vec![StepDifference::stopped("", after)],
        (Err(_), Err(_)) => Vec::new(),
    }
}
