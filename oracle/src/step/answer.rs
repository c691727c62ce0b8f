//! What a step is told, and what it answers.

use super::cascade::{EXACT_UNKNOWNS, StepLevelCounts};
use super::state::{KeptPrecision, Mode, State};
use crate::LevelCounts;
use num_rational::BigRational;
use rockproof_model::simulation::{Body, Simulation};
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
pub enum RetryReason {
    /// Modes changed in too many solves (SPEC 5.10).
    NotConverged,
    /// A vertex moved beyond `max_displacement`.
    Displacement,
    /// A block turned beyond `max_rotation`.
    Rotation,
}

/// How the open–close iteration of an attempt ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IterationEnd {
    /// In its last solve no contact opened or closed, and friction had settled: converged.
    Settled,
    /// No mode changed in the last solve, for the [`UNCHANGED_SOLVES`]th time: converged, whether friction had settled or not.
    Unchanged,
    /// A mode changed in the last solve: for the [`rockproof_model::simulation::Control::ITERATIONS`]th time or a later one, by opening or
    /// closing, or for the [`SLIPPING_SOLVES`]th time. Not converged.
    Changing,
}

impl IterationEnd {
    /// Whether the iteration converged.
    pub fn is_converged(self) -> bool {
        self != IterationEnd::Changing
    }
}

/// Of the solves that do not end an iteration otherwise, so many without a change of mode end it.
pub const UNCHANGED_SOLVES: u32 = 7;

/// Of the solves that do not end an iteration otherwise, so many with a change of mode end the attempt, though contacts only lock or slide in the last.
pub const SLIPPING_SOLVES: u32 = 12;

/// An attempt at a step that was given up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedAttempt {
    /// Its Δt (s).
    pub time_step: BigRational,
    /// Why it was given up.
    pub reason: RetryReason,
    /// Its solves.
    pub solves: u32,
    /// How its iteration ended.
    pub end: IterationEnd,
}

/// The gap of a contact in m, each value within one unit of the grid on which the state is kept, or of 2⁻²⁰⁰ m with [`KeptPrecision::Exact`](super::KeptPrecision::Exact).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GapChange {
    /// h0, when the step begins.
    pub before: Number,
    /// h in the last solve.
    pub after: Number,
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
    /// How the iteration of the accepted attempt ended.
    pub end: IterationEnd,
    /// Whether that is converged.
    pub converged: bool,
    /// Attempts given up, in order.
    pub retries: Vec<FailedAttempt>,
    /// The Δt accepted (s).
    pub time_step: BigRational,
    /// The gap of each contact before the step and in the last solve.
    pub gaps: Vec<GapChange>,
    /// The state after the step.
    pub state: State,
    /// Which level settled how many decisions of all attempts.
    pub levels: StepLevelCounts,
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
        limit: RetryReason,
    },
    /// The step leaves a block without a positive volume.
    Inverted {
        /// The block.
        block: usize,
    },
    /// The new state cannot be kept as asked: as fractions, where a square root has none, or on the grid, within 4,096 bits.
    NotKept {
        /// How it should be kept.
        keep: KeptPrecision,
    },
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
            StepFailure::Inverted { block } => write!(f, "block {block} is inverted: its volume is not positive"),
            StepFailure::NotKept { keep: KeptPrecision::Exact } => write!(
                f,
                "the new positions cannot be had as fractions: the friction of a sliding contact is the square root of no square, or closed contacts that bear forces tie blocks of more than {EXACT_UNKNOWNS} unknowns together; without --fractions positions are kept on a grid"
            ),
            StepFailure::NotKept { keep: KeptPrecision::Grid { exponent } } => write!(
                f,
                "4,096 bits do not tell where the new positions are on a grid of 2^-{exponent} m: a coarser grid (a smaller --grid-exponent) may do, or stiffnesses and masses that are less far apart, whose system is less near to singular"
            ),
        }
    }
}

impl std::error::Error for StepFailure {}

/// What a step decides, without the state after it.
#[derive(Clone, Debug)]
pub struct CertifiedStep {
    /// Its contacts with their blocks, by pair and in SPEC order.
    pub contacts: Vec<([usize; 2], Contact)>,
    /// As in [`StepAnswer::modes`].
    pub modes: Vec<Vec<Mode>>,
    /// Solves of the accepted attempt.
    pub iterations: u32,
    /// How the iteration of the accepted attempt ended.
    pub end: IterationEnd,
    /// Whether that is converged.
    pub converged: bool,
    /// Attempts given up, in order.
    pub retries: Vec<FailedAttempt>,
    /// The Δt accepted (s).
    pub time_step: BigRational,
    /// Which level settled how many decisions of all attempts.
    pub levels: StepLevelCounts,
    /// The same of the classification.
    pub contact_levels: LevelCounts,
}

/// What a step decides, and how it moves the blocks.
#[derive(Clone, Debug)]
pub struct EnclosedStep {
    /// What it decides.
    pub decided: CertifiedStep,
    /// Of each block the unknowns that it has, each as an f64 and at least its distance from the exact value (m, rad, strain);
    /// `None` where neither balls of f64 nor of two f64 enclosed the last solve.
    pub displacements: Option<Vec<Vec<[f64; 2]>>>,
}
