//! A whole step: contacts, attempts with their cuts of Δt, and the new state (docs/step.md 9 to 11).

use super::attempt::{Attempt, Joint, force_at};
use super::ladder::{Ladder, NextMode, StepLevels, TooFar, TooTurned};
use super::state::{BlockState, Keep, Mode, State};
use super::strength;
use super::transfer::{Started, transfer};
use super::update::updated;
use crate::{LevelCounts, Pair, Solid, mass};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{CheckedDiv, Zero};
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

/// Makes one step from `state`, exactly.
///
/// # Errors
/// When the step cannot be made or its state not be kept as asked: see [`StepFailure`].
pub fn exact_step(model: &StepModel<'_>, state: &State, keep: Keep) -> Result<StepAnswer, StepFailure> {
    let blocks: Vec<Block> = model
        .shapes
        .iter()
        .zip(&state.blocks)
        .map(|(shape, block)| shape.with_vertices(block.vertices.clone()))
        .collect();
    let (contacts, contact_levels) = contacts(model, &blocks);
    let started = transfer(&contacts, &state.contacts);
    let joints = joints(model, &blocks, &started)?;
    let elasticity = model
        .bodies
        .iter()
        .map(|body| mass::elasticity(&model.simulation.materials[body.material]).ok_or(StepFailure::NoElasticity))
        .collect::<Result<Vec<_>, _>>()?;
    let fixed_stiffness = fixed_stiffness(model)?;
    let full = model.simulation.control.time_step.to_rational();
    let smallest = &full / BigInt::from(Control::SMALLEST);
    let (mut time_step, mut cuts, mut levels) = (full, Vec::new(), StepLevels::default());
    loop {
        let attempt =
            prepare(model, state, &blocks, &started, &joints, &elasticity, &fixed_stiffness, time_step.clone());
        let mut ladder = Ladder::new(&attempt, levels);
        let end = iterate(&mut ladder, &started, &attempt);
        levels = ladder.levels;
        let (why, block) = match end.cut {
            Some(found) => found,
            None => return finish(ladder, &attempt, end, cuts, contacts, contact_levels, keep),
        };
        let factor = match why {
            Cut::NotConverged => BigRational::new(Control::CUT.0.into(), Control::CUT.1.into()),
            _ => BigRational::new(1.into(), 2.into()),
        };
        let shorter = &time_step * factor;
        if shorter < smallest {
            if why != Cut::NotConverged {
                return Err(StepFailure::TooFast { block, limit: why });
            }
            if model.simulation.control.unconverged == Unconverged::Stop {
                return Err(StepFailure::NotConverged);
            }
            return finish(ladder, &attempt, end, cuts, contacts, contact_levels, keep);
        }
        cuts.push((std::mem::replace(&mut time_step, shorter), why));
    }
}

/// How an attempt ended.
struct End {
    /// The modes after the last solve.
    after: Vec<Mode>,
    cut: Option<(Cut, usize)>,
}

fn iterate(ladder: &mut Ladder<'_>, started: &[Started], attempt: &Attempt<'_>) -> End {
    let mut modes: Vec<Mode> = started
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
            let far = ladder.ask(&TooFar).flatten().map(|block| (Cut::Displacement, block));
            let cut = far.or_else(|| ladder.ask(&TooTurned).flatten().map(|block| (Cut::Rotation, block)));
            return End { after, cut };
        }
        modes = after;
    }
    End { after: modes, cut: Some((Cut::NotConverged, 0)) }
}

fn finish(
    mut ladder: Ladder<'_>,
    attempt: &Attempt<'_>,
    end: End,
    cuts: Vec<(BigRational, Cut)>,
    contacts: Vec<([usize; 2], Contact)>,
    contact_levels: LevelCounts,
    keep: Keep,
) -> Result<StepAnswer, StepFailure> {
    // The modes that the last solve was made with are those that are remembered.
    let last = ladder.history.last().cloned().unwrap_or_default();
    let state = match keep {
        Keep::Exact => ladder.exact().and_then(|chain| updated(attempt, chain, &last, keep)),
        Keep::Grid { exponent } => [512, 1024, 2048, 4096]
            .into_iter()
            .filter(|&bits| bits > exponent)
            .find_map(|bits| updated(attempt, &ladder.with_bits(bits)?, &last, keep)),
    };
    let levels = ladder.levels;
    let mut modes = std::mem::take(&mut ladder.history);
    let iterations = modes.len() as u32;
    let converged = end.after == last;
    modes.push(end.after);
    let time_step = attempt.time_step.clone();
    let state = state.ok_or(StepFailure::NotKept)?;
    Ok(StepAnswer { contacts, modes, iterations, converged, cuts, time_step, state, levels, contact_levels })
}

#[allow(clippy::too_many_arguments, reason = "a struct of its own would be Attempt again")]
fn prepare<'a>(
    model: &'a StepModel<'a>,
    state: &'a State,
    blocks: &'a [Block],
    started: &'a [Started],
    joints: &'a [Joint],
    elasticity: &'a [[[BigRational; 6]; 6]],
    fixed_stiffness: &'a [Number],
    time_step: BigRational,
) -> Attempt<'a> {
    let sizes: Vec<usize> = model.bodies.iter().map(|b| b.motion.unknowns()).filter(|&n| n > 0).collect();
    let mut next = 0..sizes.len();
    let rows = model.bodies.iter().map(|b| if b.is_fixed() { None } else { next.next() }).collect();
    let settling = state.settling > 0;
    let begin = state.time.to_rational();
    let time = if settling { begin } else { begin + &time_step };
    let loads = model.simulation.loads.iter().map(|load| (load.block, force_at(load, &time))).collect();
    Attempt {
        model,
        state,
        blocks,
        started,
        joints,
        elasticity,
        fixed_stiffness,
        sizes,
        rows,
        time_step,
        settling,
        loads,
    }
}

fn contacts(model: &StepModel<'_>, blocks: &[Block]) -> (Vec<([usize; 2], Contact)>, LevelCounts) {
    let solids: Vec<Solid> = blocks.iter().map(Solid::new).collect();
    let (mut found, mut levels) = (Vec::new(), LevelCounts::default());
    for i in 0..solids.len() {
        for j in i + 1..solids.len() {
            if model.bodies[i].is_fixed() && model.bodies[j].is_fixed() {
                continue;
            }
            let answer = Pair::new(&solids[i], &solids[j]).classify(model.tolerances);
            levels += answer.levels;
            found.extend(answer.contacts.into_iter().map(|contact| ([i, j], contact)));
        }
    }
    (found, levels)
}

/// The joint of each contact.
fn joints(model: &StepModel<'_>, blocks: &[Block], started: &[Started]) -> Result<Vec<Joint>, StepFailure> {
    let mut joints = Vec::new();
    for pair in started.chunk_by(|one, two| one.blocks == two.blocks) {
        let [i, j] = pair[0].blocks;
        let properties = model.simulation.joints.between(model.bodies[i].joint, model.bodies[j].joint);
        let normal = properties.normal_stiffness.as_ref().ok_or(StepFailure::NoStiffness)?.to_rational();
        let shear = &normal * properties.shear_ratio.to_rational();
        let (cohesion, tension) = (properties.cohesion.to_rational(), properties.tension.to_rational());
        let areas = if properties.cohesion.is_zero() && properties.tension.is_zero() {
            vec![BigRational::zero(); pair.len()]
        } else {
            let contacts: Vec<Contact> = pair.iter().map(|started| started.contact).collect();
            strength::shares([&blocks[i], &blocks[j]], &contacts, &model.tolerances.overlap_sine)
                .ok_or(StepFailure::Degenerate)?
        };
        for area in areas {
            joints.push(Joint {
                tensile: (&tension * &area).checked_div(&normal).unwrap_or_default(),
                cohesive: &cohesion * area,
                normal: normal.clone(),
                shear: shear.clone(),
                friction: properties.friction.to_rational(),
            });
        }
    }
    Ok(joints)
}

fn fixed_stiffness(model: &StepModel<'_>) -> Result<Vec<Number>, StepFailure> {
    let stiffest = model.simulation.joints.all().filter_map(|joint| joint.normal_stiffness.as_ref()).max();
    let fixed = model.simulation.fixed_points.iter();
    fixed.map(|f| f.stiffness.as_ref().or(stiffest).cloned().ok_or(StepFailure::NoStiffness)).collect()
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
