//! A whole step: attempts with their cuts of Δt, and the new state (docs/step.md 9 to 12).

use super::attempt::Attempt;
use super::chain::Chain;
use super::ladder::{Ladder, StepLevels};
use super::prepare::Begun;
use super::questions::{NextMode, TooFar, TooTurned};
use super::state::{BlockState, Keep, Mode, State};
use super::update::updated;
use crate::LevelCounts;
use crate::solve::SpdSystem;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::simulation::{Body, Control, Simulation, Unconverged};
use rockproof_model::{Block, Contact, Number, ToleranceSet};
use std::fmt;

/// What does not change from step to step.
#[derive(Clone, Copy, Debug)]
pub struct StepModel<'a> {
    /// The blocks; only their shapes are used, the coordinates are those of the [`State`].
    pub shapes: &'a [&'a Block],
    /// How each moves.
    pub bodies: &'a [Body],
    /// Materials, joints, loads, control. Every joint in use must name its normal stiffness.
    pub simulation: &'a Simulation,
    /// The tolerances.
    pub tolerances: &'a ToleranceSet,
}

/// Why an attempt was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// Modes still changed after [`Control::ITERATIONS`] solves.
    NotConverged,
    /// A vertex moved beyond `max_displacement`.
    Displacement,
    /// A block turned beyond `max_rotation`.
    Rotation,
}

/// What a step did.
#[derive(Clone, Debug)]
pub struct StepAnswer {
    /// Its contacts with their blocks, by pair and in SPEC order.
    pub contacts: Vec<([usize; 2], Contact)>,
    /// The modes of the accepted attempt: those of each solve, and at last those after the last solve.
    pub modes: Vec<Vec<Mode>>,
    /// Solves of the accepted attempt.
    pub iterations: u32,
    /// Whether no mode changed in the last of them.
    pub converged: bool,
    /// Attempts given up, each with its Δt (s) and why.
    pub cuts: Vec<(BigRational, Cut)>,
    /// The Δt accepted (s).
    pub time_step: BigRational,
    /// The state after the step.
    pub state: State,
    /// Which level settled how many decisions of all attempts.
    pub levels: StepLevels,
    /// The same of the classification.
    pub contact_levels: LevelCounts,
}

/// Why a step cannot be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StepFailure {
    /// A block's volume is zero, or a contact's plane has no area.
    Degenerate,
    /// A joint without a normal stiffness, or a fixed point for which no joint gives one.
    NoStiffness,
    /// A Poisson's ratio of −1 or 1/2.
    NoElasticity,
    /// The iteration does not converge at the smallest Δt, and the scene wants to stop there.
    NotConverged,
    /// A block moves beyond the limits at the smallest Δt.
    TooFast {
        /// The block.
        block: usize,
        /// Which limit.
        limit: Cut,
    },
    /// The new state cannot be kept as asked: not in fractions, or not to the grid within 4,096 bits.
    NotKept,
}

impl fmt::Display for StepFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StepFailure::Degenerate => write!(f, "a block has no volume, or a contact's plane no area"),
            StepFailure::NoStiffness => write!(f, "a joint has no normal stiffness"),
            StepFailure::NoElasticity => write!(f, "a Poisson's ratio leaves no elasticity"),
            StepFailure::NotConverged => {
                write!(f, "the open–close iteration does not converge at the smallest time step")
            }
            StepFailure::TooFast { block, .. } => write!(f, "block {block} exceeds a limit at the smallest time step"),
            StepFailure::NotKept => write!(f, "the new state cannot be kept as asked"),
        }
    }
}

impl std::error::Error for StepFailure {}

/// What a step decides, and how it moves the blocks, without the state after it.
#[derive(Clone, Debug)]
pub struct CertifiedStep {
    /// Its contacts with their blocks, by pair and in SPEC order.
    pub contacts: Vec<([usize; 2], Contact)>,
    /// As in [`StepAnswer::modes`].
    pub modes: Vec<Vec<Mode>>,
    /// Whether no mode changed in the last solve.
    pub converged: bool,
    /// Attempts given up, each with its Δt (s) and why.
    pub cuts: Vec<(BigRational, Cut)>,
    /// The Δt accepted (s).
    pub time_step: BigRational,
    /// Of each block the unknowns that it has, each as an f64 and at least its distance from the exact value (m, rad, strain);
    /// `None` where f64 did not enclose the last solve.
    pub displacements: Option<Vec<Vec<[f64; 2]>>>,
    /// Which level settled how many decisions of all attempts.
    pub levels: StepLevels,
    /// The same of the classification.
    pub contact_levels: LevelCounts,
}

/// Decides one step from `state`, exactly: all that [`exact_step`] does but for the state after it.
///
/// # Errors
/// When the step cannot be made: see [`StepFailure`].
pub fn certified_step(model: &StepModel<'_>, state: &State) -> Result<CertifiedStep, StepFailure> {
    let begun = Begun::new(model, state)?;
    let mut certified = attempts(&begun, |mut ladder, attempt, end, cuts| {
        let displacements = ladder.float().and_then(|chain| chain.iterates.last()).map(|last| {
            let pairs = |d: &Vec<crate::number::Ball>| d.iter().map(|ball| [ball.middle, ball.radius]).collect();
            last.d.iter().map(pairs).collect()
        });
        let modes = modes(&ladder, &end);
        Ok(CertifiedStep {
            contacts: Vec::new(),
            converged: end.cut.is_none(),
            modes,
            cuts,
            time_step: attempt.time_step.clone(),
            displacements,
            levels: ladder.levels,
            contact_levels: begun.contact_levels,
        })
    })?;
    certified.contacts = begun.contacts;
    Ok(certified)
}

/// The system of the first solve of a step, exactly; `None` where the step cannot be made.
pub fn first_system(model: &StepModel<'_>, state: &State) -> Option<SpdSystem> {
    let begun = Begun::new(model, state).ok()?;
    let attempt = begun.attempt(model.simulation.control.time_step.to_rational());
    let modes: Vec<Mode> = attempt.started.iter().map(|started| started.mode).collect();
    let chain: Chain<'_, BigRational> = Chain::new(&attempt, 0)?;
    Some(SpdSystem::of_blocks(chain.assembled(&modes)?))
}

/// Makes one step from `state`, exactly.
///
/// # Errors
/// When the step cannot be made or its state not be kept as asked: see [`StepFailure`].
pub fn exact_step(model: &StepModel<'_>, state: &State, keep: Keep) -> Result<StepAnswer, StepFailure> {
    let begun = Begun::new(model, state)?;
    let mut answer = attempts(&begun, |mut ladder, attempt, end, cuts| {
        let state = kept(&mut ladder, attempt, &end.after, keep).ok_or(StepFailure::NotKept)?;
        let modes = modes(&ladder, &end);
        Ok(StepAnswer {
            contacts: Vec::new(),
            iterations: modes.len() as u32 - 1,
            converged: end.cut.is_none(),
            modes,
            cuts,
            time_step: attempt.time_step.clone(),
            state,
            levels: ladder.levels,
            contact_levels: begun.contact_levels,
        })
    })?;
    answer.contacts = begun.contacts;
    Ok(answer)
}

/// Tries until an attempt is good, or the last one allowed (docs/step.md 10 and 11), and hands it on.
pub(super) fn attempts<T>(
    begun: &Begun<'_>,
    finish: impl FnOnce(Ladder<'_>, &Attempt<'_>, End, Vec<(BigRational, Cut)>) -> Result<T, StepFailure>,
) -> Result<T, StepFailure> {
    let control = &begun.model.simulation.control;
    let full = control.time_step.to_rational();
    let smallest = &full / BigInt::from(Control::SMALLEST);
    let (mut time_step, mut cuts, mut levels) = (full, Vec::new(), StepLevels::default());
    loop {
        let attempt = begun.attempt(time_step.clone());
        let mut ladder = Ladder::new(&attempt, &begun.layout, levels);
        let end = iterate(&mut ladder, &attempt);
        levels = ladder.levels;
        let Some((why, block)) = end.cut else { return finish(ladder, &attempt, end, cuts) };
        let factor = match why {
            Cut::NotConverged => BigRational::new(Control::CUT.0.into(), Control::CUT.1.into()),
            _ => BigRational::new(1.into(), 2.into()),
        };
        let shorter = &time_step * factor;
        if shorter < smallest {
            if why != Cut::NotConverged {
                return Err(StepFailure::TooFast { block, limit: why });
            }
            if control.unconverged == Unconverged::Stop {
                return Err(StepFailure::NotConverged);
            }
            // The last attempt is taken, if it keeps the limits.
            let Some((limit, block)) = beyond_limits(&mut ladder) else { return finish(ladder, &attempt, end, cuts) };
            levels = ladder.levels;
            let half = &time_step / BigInt::from(2);
            if half < smallest {
                return Err(StepFailure::TooFast { block, limit });
            }
            cuts.push((std::mem::replace(&mut time_step, half), limit));
            continue;
        }
        cuts.push((std::mem::replace(&mut time_step, shorter), why));
    }
}

/// How an attempt ended.
pub(super) struct End {
    /// The modes after the last solve.
    after: Vec<Mode>,
    cut: Option<(Cut, usize)>,
}

fn iterate(ladder: &mut Ladder<'_>, attempt: &Attempt<'_>) -> End {
    let mut modes: Vec<Mode> = attempt
        .started
        .iter()
        .map(|s| if attempt.settling && s.mode == Mode::Sliding { Mode::Locked } else { s.mode })
        .collect();
    for _ in 0..Control::ITERATIONS {
        ladder.solve(modes.clone());
        let after: Vec<Mode> = modes
            .iter()
            .enumerate()
            .map(|(contact, &mode)| ladder.ask(&NextMode { contact, mode }).unwrap_or(mode))
            .collect();
        if after == modes {
            return End { after, cut: beyond_limits(ladder) };
        }
        modes = after;
    }
    End { after: modes, cut: Some((Cut::NotConverged, 0)) }
}

fn beyond_limits(ladder: &mut Ladder<'_>) -> Option<(Cut, usize)> {
    let far = ladder.ask(&TooFar).flatten().map(|block| (Cut::Displacement, block));
    far.or_else(|| ladder.ask(&TooTurned).flatten().map(|block| (Cut::Rotation, block)))
}

/// The modes of each solve, and those after the last.
fn modes(ladder: &Ladder<'_>, end: &End) -> Vec<Vec<Mode>> {
    let mut modes = ladder.modes().to_vec();
    modes.push(end.after.clone());
    modes
}

/// Grids up to this exponent may be reached by balls of two f64.
const DOUBLE_GRID: u32 = 96;

/// The state after the last solve. The modes that followed from it are those that are remembered.
fn kept(ladder: &mut Ladder<'_>, attempt: &Attempt<'_>, after: &[Mode], keep: Keep) -> Option<State> {
    let Keep::Grid { exponent } = keep else {
        return ladder.exact().and_then(|chain| updated(attempt, chain, after, keep));
    };
    if exponent <= DOUBLE_GRID
        && let Some(state) = ladder.double().and_then(|chain| updated(attempt, chain, after, keep))
    {
        return Some(state);
    }
    let enough = [128, 256, 512, 1024, 2048, 4096].into_iter().filter(|&bits| bits > exponent);
    enough.into_iter().find_map(|bits| updated(attempt, &*ladder.with_bits(bits)?, after, keep))
}

/// The velocity that the scene gives a block.
pub(crate) fn initial_rates(body: &Body) -> [Number; 12] {
    let mut velocity = std::array::from_fn(|_| Number::ZERO);
    if !body.is_fixed() {
        let rates = [&body.velocity, &body.spin].into_iter().flat_map(|v| v.components());
        velocity.iter_mut().zip(rates).for_each(|(place, rate)| *place = rate.clone());
    }
    velocity
}

impl State {
    /// The state a scene begins with. Velocities are those of the bodies; they count from the first step that is not settling.
    pub fn initial(model: &StepModel<'_>) -> State {
        let blocks = model.shapes.iter().zip(model.bodies).map(|(shape, b)| {
            let settled = model.simulation.control.settle == 0;
            let velocity = if settled { initial_rates(b) } else { std::array::from_fn(|_| Number::ZERO) };
            BlockState { vertices: shape.vertices().to_vec(), velocity, stress: b.stress.clone() }
        });
        State {
            time: Number::from_rational(BigRational::zero()),
            settling: model.simulation.control.settle,
            blocks: blocks.collect(),
            load_points: model.simulation.loads.iter().map(|load| load.at.clone()).collect(),
            fixed_points: model.simulation.fixed_points.iter().map(|fixed| fixed.at.clone()).collect(),
            contacts: Vec::new(),
        }
    }
}
