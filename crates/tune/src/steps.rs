//! What steps of the part come to under a set: the stepper by itself, and with the oracle beside it.

use super::TuneError;
use super::unseen_overlaps::{UnseenOverlaps, unseen_depths};
use rayon::prelude::*;
use rockproof_differential::lockstep::run::KEPT_PRECISION;
use rockproof_differential::lockstep::scene::ExactScene;
use rockproof_differential::lockstep::state::exact_state;
use rockproof_differential::lockstep::{StepAnswerChange, StepDecisions, compare};
use rockproof_model::simulation::Unconverged;
use rockproof_model::{Block, Number, Precision, Scene, ToleranceSet, Vec3};
use rockproof_oracle::penetration::penetration;
use rockproof_stepper::dynamics::{Dynamics, Solve, State, StepError};
use serde::{Deserialize, Serialize};

/// What steps under a set came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepMeasures {
    /// Settling steps made.
    pub settled: u64,
    /// Steps made, settling not counted.
    pub steps: u64,
    /// The exact overlaps.
    pub overlaps: Overlaps,
    /// Steps, settling too, after which a pair overlaps deeper than `penetration`, and deeper than in the scene as given.
    pub deep: u64,
    /// What of the overlaps no contact sees, without that which springs of other contacts explain.
    pub unseen: UnseenOverlaps,
    /// What these explain.
    pub explained: UnseenOverlaps,
    /// Steps accepted without converging.
    pub unconverged: u64,
    /// Those of them at which the scene says that a run stops: all or none.
    pub refused: u64,
    /// Attempts given up.
    pub retries: u64,
    /// Why the run stopped, if it did: the step that comes after those made cannot be made.
    pub stopped: Option<String>,
}

impl StepMeasures {
    /// Steps made, settling too.
    pub fn made(&self) -> u64 {
        self.settled + self.steps
    }
}

/// What the oracle said of the same steps, each made from the state in which the stepper was.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LockstepMeasures {
    /// Steps compared, settling too: those that one side made at least.
    pub steps: u64,
    /// Steps that differ in anything: contacts, modes, solves, retries, Δt.
    pub differ: u64,
    /// Contacts of the oracle in all of them.
    pub found: u64,
    /// Contacts that differ.
    pub contacts: u64,
    /// Contacts whose modes differ.
    pub modes: u64,
    /// Steps that one side made and the other could not.
    pub failed: u64,
    /// The exact depth of the deepest overlap after the oracle's last step (m); none where it could not make it.
    pub deepest: Option<f64>,
}

impl LockstepMeasures {
    /// What differs, of all contacts: contacts, modes, and steps that differ in something else. Zero only where nothing differs.
    pub fn share(&self) -> f64 {
        let differ = (self.contacts + self.modes).max(self.differ);
        if differ == 0 { 0.0 } else { differ as f64 / self.found.max(differ) as f64 }
    }
}

/// How deep blocks overlap, one of the two free to move (m).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Overlaps {
    /// The deepest after the last step.
    pub deepest: f64,
    /// The most by which some pair overlaps deeper after a step, settling too, than in the scene as given. After any step, since blocks that
    /// went through one another may have been thrown apart by the last. Zero where it is no more than 2⁸·eps times the largest coordinate.
    pub sunk: f64,
}

/// The overlaps of a part as it is given.
pub(super) struct InitialOverlaps {
    /// Pairs of which one can move, and how deep they overlap.
    pairs: Vec<([usize; 2], f64)>,
    /// Sinking that is none: 2⁸·eps times the largest coordinate (m), as for what a territory resolves.
    nothing: f64,
}

impl InitialOverlaps {
    pub(super) fn of(part: &Scene, precision: Precision) -> InitialOverlaps {
        let is_fixed = |block: usize| part.blocks[block].body.is_fixed();
        let count = part.blocks.len();
        let all: Vec<[usize; 2]> = (0..count).flat_map(|i| (i + 1..count).map(move |j| [i, j])).collect();
        let free = all.into_par_iter().filter(|[i, j]| !(is_fixed(*i) && is_fixed(*j)));
        let coordinates = part.blocks.iter().flat_map(|block| block.block.coordinates());
        let largest = coordinates.map(|c| c.approximate().abs()).fold(0.0, f64::max);
        InitialOverlaps {
            pairs: free.map(|pair| (pair, depth(pair.map(|k| &part.blocks[k].block)))).collect(),
            nothing: 256.0 * precision.epsilon() * largest,
        }
    }

    /// How deep the pairs overlap where the blocks are now.
    fn depths(&self, blocks: &[Block]) -> Vec<([usize; 2], f64)> {
        self.pairs.par_iter().map(|(pair, _)| (*pair, depth(pair.map(|k| &blocks[k])))).collect()
    }

    /// The overlaps, given those depths, and whether a pair that sank is deeper than `penetration`.
    fn overlaps(&self, depths: &[([usize; 2], f64)], penetration: f64) -> (Overlaps, bool) {
        let now = self.pairs.iter().zip(depths).map(|((_, before), &(_, deepest))| {
            let sunk = Some(deepest - before).filter(|sunk| *sunk > self.nothing).unwrap_or(0.0);
            (Overlaps { deepest, sunk }, sunk > 0.0 && deepest > penetration)
        });
        let worse = |(one, deep): (Overlaps, bool), (other, also): (Overlaps, bool)| {
            let [deepest, sunk] = [one.deepest.max(other.deepest), one.sunk.max(other.sunk)];
            (Overlaps { deepest, sunk }, deep || also)
        };
        now.fold((Overlaps::default(), false), worse)
    }
}

fn depth([a, b]: [&Block; 2]) -> f64 {
    if !boxes_overlap(a, b) {
        return 0.0;
    }
    penetration(a, b).and_then(|found| found.depth_m()).unwrap_or(0.0)
}

fn boxes_overlap(a: &Block, b: &Block) -> bool {
    let (a, b) = (a.bounds(), b.bounds());
    let below = |low: &Vec3<&Number>, high: &Vec3<&Number>| low.x < high.x && low.y < high.y && low.z < high.z;
    below(&a.min, &b.max) && below(&b.min, &a.max)
}

/// Steps a part and looks after each step how deep its blocks overlap, and whether contacts see it. `members` are the numbers that its blocks have in the whole scene;
/// `unconverged` is what the scene does where a step does not converge; here the part goes on.
pub(super) fn measure_steps<R: Solve>(
    (part, members): (&Scene, &[usize]),
    (set, precision): (&ToleranceSet, Precision),
    initial: &InitialOverlaps,
    steps: u64,
    unconverged: Unconverged,
) -> Result<StepMeasures, TuneError> {
    let mut dynamics = Dynamics::<R>::new(part, set)?;
    let mut found = StepMeasures::default();
    let (penetration, is_fixed) = (set.penetration.approximate(), part.fixed());
    while found.steps < steps && found.stopped.is_none() {
        match dynamics.step() {
            Ok(report) => {
                let blocks = placed(part, dynamics.state());
                let depths = initial.depths(&blocks);
                let (now, is_deep) = initial.overlaps(&depths, penetration);
                found.overlaps = Overlaps { deepest: now.deepest, sunk: now.sunk.max(found.overlaps.sunk) };
                found.deep += u64::from(is_deep);
                let unseen = unseen_depths((&blocks, &is_fixed), dynamics.state(), &depths, (set, precision));
                found.unseen.add(&unseen.beyond);
                found.explained.add(&unseen.explained);
                found.settled += u64::from(report.step <= 0);
                found.steps = dynamics.state().step;
                found.unconverged += u64::from(!report.converged);
                found.retries += report.retries.len() as u64;
            }
            Err(error) => found.stopped = Some(of_scene(error, members).to_string()),
        }
    }
    found.refused = if unconverged == Unconverged::Stop { found.unconverged } else { 0 };
    Ok(found)
}

/// An error of a part, with the numbers that its blocks have in the whole scene.
fn of_scene(mut error: StepError, members: &[usize]) -> StepError {
    match &mut error {
        StepError::TooFast { block, .. }
        | StepError::Inverted { block, .. }
        | StepError::Collapsed { block, .. }
        | StepError::NotFinite { block, .. }
        | StepError::Singular { block, .. } => *block = members[*block],
        StepError::NotConverged { contacts, .. } => {
            for change in contacts {
                change.blocks = change.blocks.map(|block| members[block as usize] as u32);
            }
        }
    }
    error
}

fn placed<R: Solve>(part: &Scene, state: &State<R>) -> Vec<Block> {
    let number = |value: R| Number::from_f64(value.to_f64()).unwrap_or(Number::ZERO);
    let blocks = part.blocks.iter().zip(&state.blocks);
    blocks
        .map(|(block, now)| {
            let points = now.vertices.iter().map(|v| Vec3::new(number(v.x), number(v.y), number(v.z)));
            block.block.with_vertices(points.collect())
        })
        .collect()
}

/// Makes the same steps with the oracle beside the stepper: each from the stepper's state, taken as exact.
pub(super) fn measure_lockstep<R: Solve>(
    part: &Scene,
    set: &ToleranceSet,
    precision: Precision,
    initial: &InitialOverlaps,
    steps: u64,
) -> Result<LockstepMeasures, TuneError> {
    let mut dynamics = Dynamics::<R>::new(part, set)?;
    let rounded = ExactScene::new(part, set)
        .rounded(precision)
        .map_err(|overflow| TuneError::Overflow { what: format!("`{}`", overflow.0), precision })?;
    let shapes = rounded.scene().shapes();
    let mut found = LockstepMeasures::default();
    while dynamics.state().step < steps {
        let is_last = dynamics.state().settling == 0 && dynamics.state().step + 1 == steps;
        let Ok(before) = exact_state(dynamics.state()) else {
            found.failed += 1;
            break;
        };
        let made = dynamics.step();
        let exact = if is_last {
            rounded.step(&before, KEPT_PRECISION).map(|step| {
                let depths = initial.depths(&rounded.blocks_at(&step.state));
                found.deepest = Some(depths.iter().fold(0.0, |most, (_, depth)| depth.max(most)));
                StepDecisions::of_oracle(&step)
            })
        } else {
            rounded.decide(&before).map(|step| StepDecisions::of_certified(&step))
        };
        if made.is_err() && exact.is_err() {
            break;
        }
        found.steps += 1;
        let (made, exact) = match (made, exact) {
            (Ok(made), Ok(exact)) => (made, exact),
            (Ok(_), Err(_)) => {
                found.failed += 1;
                continue;
            }
            (Err(_), _) => {
                found.failed += 1;
                break;
            }
        };
        let stepper = StepDecisions::of_stepper(&made, dynamics.modes(), dynamics.state());
        let differences = compare(&exact, &stepper, &shapes);
        found.found += exact.contacts.len() as u64;
        found.differ += u64::from(!differences.is_empty());
        found.contacts += differences.iter().filter(|difference| difference.is_of_contacts()).count() as u64;
        found.modes +=
            differences.iter().filter(|difference| difference.change == StepAnswerChange::Mode).count() as u64;
    }
    Ok(found)
}
