//! What contacts should prevent and a step let happen: two blocks pass through one another within it, or overlap after it
//! where no contact sees it. Both sides of a step are looked through alike, the stepper's state taken as the exact numbers it is
//! (SPEC section 7), and what is found gets its cause.

use crate::finding::Cause;
use crate::lockstep::run::KEPT_PRECISION;
use crate::lockstep::scene::ExactScene;
use crate::lockstep::state::rounded_state;
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::{Block, ContactKey, Number, Precision, ToleranceSet};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::audit::{Auditor, Overlap, rounding_depth};
use rockproof_oracle::passage::{PassageAnswer, StraightMotion, passage, swept_neighbours};
use rockproof_oracle::step::{Mode, State};
use std::collections::BTreeSet;
use std::fmt;

/// A sort of intrusion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Intrusion {
    /// Two blocks are deeper in one another than g within the step, and at neither end of it.
    Passage,
    /// Two blocks overlap after the step, and no contact has h < 0; before it this was not so.
    Unseen,
}

impl Intrusion {
    /// Both.
    pub const ALL: [Intrusion; 2] = [Intrusion::Passage, Intrusion::Unseen];

    /// The name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Intrusion::Passage => "passage",
            Intrusion::Unseen => "unseen",
        }
    }
}

/// Why there is an intrusion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StepCause {
    /// A link of the chain of SPEC section 6: there is one on its one side and not on its other.
    Link(Cause),
    /// The exact step under ideal tolerances has it, and steps of a half, a quarter, … of its Δt over the same time do not.
    StepLength,
    /// Shorter steps have one too, or cannot be made: contacts do not hold the blocks at any Δt tried.
    NotHeld,
}

impl StepCause {
    /// The names of causes that only steps have.
    pub const NAMES: [&'static str; 2] = ["step-length", "not-held"];

    /// The name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            StepCause::Link(cause) => cause.name(),
            StepCause::StepLength => StepCause::NAMES[0],
            StepCause::NotHeld => StepCause::NAMES[1],
        }
    }

    /// The cause written `name`, if there is one.
    pub fn from_name(name: &str) -> Option<StepCause> {
        let own = [StepCause::StepLength, StepCause::NotHeld].into_iter().find(|cause| cause.name() == name);
        own.or_else(|| Cause::from_name(name).map(StepCause::Link))
    }
}

impl From<Cause> for StepCause {
    fn from(cause: Cause) -> StepCause {
        StepCause::Link(cause)
    }
}

impl fmt::Display for StepCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// One intrusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairIntrusion {
    /// The sort.
    pub kind: Intrusion,
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// When the blocks were seen in one another, in shares of the step: 1 for its end.
    pub time: f64,
    /// How deep they are then (m); `None` beyond f64.
    pub depth: Option<f64>,
}

impl PairIntrusion {
    fn key(&self) -> (Intrusion, [usize; 2]) {
        (self.kind, self.blocks)
    }
}

/// The intrusions of one step by one side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Intrusions {
    /// Passages, then overlaps, each by pair.
    pub found: Vec<PairIntrusion>,
    /// Pairs of which it stayed undecided whether they pass.
    pub undecided: Vec<[usize; 2]>,
}

impl Intrusions {
    /// Those of a step of a scene from one state to another. Overlaps within `rounding` m, or within the unevenness of a face, are
    /// none.
    pub fn of(scene: &ExactScene, before: &State, after: &State, rounding: &Number) -> Intrusions {
        let all: Vec<usize> = (0..scene.scene().blocks.len()).collect();
        Intrusions::among(&all, scene, [before, after], rounding)
    }

    /// The same, of some of the blocks alone, in ascending order.
    pub fn among(blocks: &[usize], scene: &ExactScene, states: [&State; 2], rounding: &Number) -> Intrusions {
        let ends = states.map(|state| blocks.iter().map(|&block| scene.block_at(state, block)).collect());
        let looked = LookedThrough { blocks, tolerances: scene.tolerances(), ends, states, rounding };
        let mut all = Intrusions::default();
        looked.find_passages(&mut all);
        looked.find_unseen(&mut all);
        all
    }

    /// Whether there is certainly none.
    pub fn are_none(&self) -> bool {
        self.found.is_empty() && self.undecided.is_empty()
    }

    /// How many there are of a sort.
    pub fn count(&self, kind: Intrusion) -> usize {
        self.found.iter().filter(|one| one.kind == kind).count()
    }

    /// That of a sort between two blocks, if there is one.
    pub fn between(&self, kind: Intrusion, blocks: [usize; 2]) -> Option<&PairIntrusion> {
        self.found.iter().find(|one| one.key() == (kind, blocks))
    }
}

/// Blocks of a step in which intrusions are looked for.
struct LookedThrough<'l> {
    /// Their numbers in the scene.
    blocks: &'l [usize],
    tolerances: &'l ToleranceSet,
    /// The blocks before the step and after it.
    ends: [Vec<Block>; 2],
    states: [&'l State; 2],
    rounding: &'l Number,
}

impl LookedThrough<'_> {
    /// The numbers in the scene of a pair, by its places among the blocks.
    fn numbers(&self, pair: [usize; 2]) -> [usize; 2] {
        pair.map(|place| self.blocks[place])
    }

    fn find_passages(&self, all: &mut Intrusions) {
        let [before, after] = &self.ends;
        let motions: Vec<_> = before.iter().zip(after).map(|(one, two)| StraightMotion::new(one, two)).collect();
        for pair in swept_neighbours(&motions) {
            let [a, b] = pair.map(|place| &motions[place]);
            let blocks = self.numbers(pair);
            match passage(a, b, &self.tolerances.penetration).answer {
                PassageAnswer::NoPassage | PassageAnswer::DeepAtEnd => {}
                PassageAnswer::Undecided => all.undecided.push(blocks),
                PassageAnswer::Passage { time, depth } => {
                    let time = Number::from_rational(time).approximate();
                    all.found.push(PairIntrusion { kind: Intrusion::Passage, blocks, time, depth: depth.depth_m() });
                }
            }
        }
    }

    fn find_unseen(&self, all: &mut Intrusions) {
        let prepare = |end: usize| -> Vec<PreparedBlock> { self.ends[end].iter().map(PreparedBlock::new).collect() };
        let after = prepare(1);
        let auditor = Auditor::new(&after, self.tolerances);
        let pairs = auditor.neighbours().into_iter();
        let unseen_after: Vec<_> = pairs.filter_map(|pair| Some((pair, self.unseen(&auditor, pair, 1)?))).collect();
        if unseen_after.is_empty() {
            return;
        }
        let before = prepare(0);
        let auditor = Auditor::new(&before, self.tolerances);
        for (pair, overlap) in unseen_after {
            if self.unseen(&auditor, pair, 0).is_none() {
                let (blocks, depth) = (self.numbers(pair), overlap.penetration.depth_m());
                all.found.push(PairIntrusion { kind: Intrusion::Unseen, blocks, time: 1.0, depth });
            }
        }
    }

    /// The overlap of a pair at an end of the step that no contact sees, those kept among them, and that is more than rounding.
    fn unseen(&self, auditor: &Auditor<'_>, pair: [usize; 2], end: usize) -> Option<Overlap> {
        let kept = kept(self.states[end], self.numbers(pair));
        auditor.unseen_with_kept(pair, &kept).filter(|overlap| !overlap.is_rounding(self.rounding))
    }
}

/// The contacts of a pair that a state keeps for the next classification.
fn kept(state: &State, blocks: [usize; 2]) -> Vec<ContactKey> {
    let closed = state.contacts.iter().filter(|contact| contact.blocks == blocks && contact.mode != Mode::Open);
    closed.map(|contact| contact.contact.key).collect()
}

/// An intrusion that one link of the chain has and its neighbour has not, or that the exact step itself has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CausedIntrusion {
    /// Why.
    pub cause: StepCause,
    /// The sort.
    pub kind: Intrusion,
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// Whether the link's second side has it; its first side then has not, and the other way round.
    pub appears: bool,
}

impl CausedIntrusion {
    /// What is before the link and behind it, in a word each.
    pub fn words(&self) -> [&'static str; 2] {
        if self.appears { ["none", self.kind.name()] } else { [self.kind.name(), "none"] }
    }
}

/// The intrusions of one step of both sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WatchedStep {
    /// Those of the stepper's step.
    pub stepper: Intrusions,
    /// Those of the oracle's from the same state.
    pub oracle: Intrusions,
    /// Their causes.
    pub attributed: Vec<CausedIntrusion>,
}

/// A step to be looked through.
pub(super) struct IntrusionCheck<'w> {
    /// The scene as it is with ideal tolerances, as it is, and as the engine has it.
    pub(super) scenes: [&'w ExactScene; 3],
    /// Whether rounding changes neither a number of the scene nor one of the state.
    pub(super) alike: bool,
    /// The state before the step, as the scene has it and as the engine has it.
    pub(super) before: [&'w State; 2],
    /// The state after the oracle's step and after the stepper's.
    pub(super) after: [&'w State; 2],
    pub(super) precision: Precision,
}

impl IntrusionCheck<'_> {
    /// Looks both sides through. Where either has an intrusion the other links are asked too. `wide` gives the state after the
    /// stepper's step in 512 bits, where no comparison stayed unsettled.
    pub(super) fn examine(&self, wide: impl FnOnce() -> Option<State>) -> WatchedStep {
        let [ideal, given, rounded] = self.scenes;
        let begins = rounded.blocks_at(self.before[1]);
        let rounding = rounding_depth(&begins.iter().collect::<Vec<_>>(), self.precision);
        let of = |after: &State| Intrusions::of(rounded, self.before[1], after, &rounding);
        let [oracle, stepper] = self.after.map(of);
        let mut step = WatchedStep { stepper, oracle, attributed: Vec::new() };
        let keys: BTreeSet<_> = step.oracle.found.iter().chain(&step.stepper.found).map(PairIntrusion::key).collect();
        if keys.is_empty() {
            return step;
        }
        // No link knows of a passage that it leaves undecided.
        let has = |side: &Intrusions, (kind, blocks): (Intrusion, [usize; 2])| {
            let unknown = kind == Intrusion::Passage && side.undecided.contains(&blocks);
            (!unknown).then(|| side.between(kind, blocks).is_some())
        };
        let exactly = |scene: &ExactScene| {
            let after = scene.step(self.before[0], KEPT_PRECISION).ok()?;
            Some((Intrusions::of(scene, self.before[0], &after.state, &rounding), after.time_step))
        };
        let asks_exact_links = !step.oracle.found.is_empty();
        let ideal = if asks_exact_links { exactly(ideal) } else { None };
        let given = if asks_exact_links && !self.alike { exactly(given).map(|(given, _)| given) } else { None };
        let mut wide = Some(wide);
        let mut in_wide: Option<Option<Intrusions>> = None;
        for key in keys {
            let mut tell = |cause, appears| {
                step.attributed.push(CausedIntrusion { cause, kind: key.0, blocks: key.1, appears });
            };
            let here = has(&step.oracle, key);
            if here == Some(true) {
                let there = ideal.as_ref().and_then(|(ideal, _)| has(ideal, key));
                let given = given.as_ref().map_or(here, |given| has(given, key));
                if let (Some(true), Some((_, time_step))) = (there, &ideal) {
                    tell(self.shorter_steps(key.1, time_step, &rounding), true);
                }
                for (cause, two) in [(Cause::Tolerance, [there, given]), (Cause::Representation, [given, here])] {
                    if let [Some(one), Some(other)] = two
                        && one != other
                    {
                        tell(cause.into(), other);
                    }
                }
            }
            let (Some(here), Some(float)) = (here, has(&step.stepper, key)) else { continue };
            if here != float {
                let wide = in_wide.get_or_insert_with(|| Some(of(&wide.take()?()?)));
                let remains = wide.as_ref().and_then(|wide| has(wide, key)) == Some(float);
                tell(if remains { Cause::Defect } else { Cause::Arithmetic }.into(), float);
            }
        }
        step
    }

    /// Whether shorter steps under ideal tolerances, over the time of the one that was made, keep two blocks from intruding. Each begins where
    /// the one before ended, rounded to f64 as an engine's steps are: the digits of exact states grow with every step.
    fn shorter_steps(&self, blocks: [usize; 2], time_step: &BigRational, rounding: &Number) -> StepCause {
        let prevents = |halvings: &u32| self.prevented(blocks, time_step, *halvings, rounding);
        if (1..=MAX_HALVINGS).any(|halvings| prevents(&halvings)) { StepCause::StepLength } else { StepCause::NotHeld }
    }

    fn prevented(&self, blocks: [usize; 2], time_step: &BigRational, halvings: u32, rounding: &Number) -> bool {
        let scene = self.scenes[0].with_time_step(Number::from_rational(time_step / BigInt::from(1u32 << halvings)));
        let mut state = self.before[0].clone();
        let end = state.time.to_rational() + time_step;
        for _ in 0..MAX_STEPS << halvings {
            let Ok(made) = scene.step(&state, KEPT_PRECISION) else { return false };
            let Some(after) = rounded_state(&made.state, Precision::F64) else { return false };
            if !Intrusions::among(&blocks, &scene, [&state, &after], rounding).are_none() {
                return false;
            }
            state = after;
            if state.time.to_rational() >= end {
                return true;
            }
        }
        false
    }
}

/// Halvings of Δt after which shorter steps are given up.
const MAX_HALVINGS: u32 = 6;

/// So many times the steps that a shorter Δt needs may be made, as some are cut.
const MAX_STEPS: u32 = 2;
