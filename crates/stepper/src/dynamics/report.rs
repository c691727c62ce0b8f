//! What a step says of itself.

use crate::dynamics::state::Mode;
use rockproof_model::simulation::step_in_words;
use rockproof_model::{ContactKey, ContactKind};
use std::time::Duration;

/// One accepted step. Numbers in SI units, as f64 whatever the stepper's scalar.
#[derive(Clone, Debug, PartialEq)]
pub struct StepReport {
    /// Its number from 1; settling steps have the numbers −n + 1 to 0.
    pub step: i64,
    /// The time after it (s).
    pub time: f64,
    /// The Δt that was accepted (s).
    pub time_step: f64,
    /// Solves of the accepted attempt.
    pub iterations: u32,
    /// Whether the iteration converged, as SPEC section 5 has it; if not, the attempt was the last one and its last solve was taken.
    pub converged: bool,
    /// 0 where friction had settled. Where the seventh solve without a change of mode ended the iteration all the same (SPEC section 5), the share of the
    /// forces on a block by which its tangential forces were still off, of the block with the largest. The forces are those that press and rub on it, or its
    /// weight, loads and momentum over Δt, whichever are more.
    pub friction_left: f64,
    /// Attempts given up, in order.
    pub retries: Vec<Retry>,
    /// Contacts by kind and mode: `contacts[kind as usize][mode as usize]`.
    pub contacts: [[u32; 3]; 6],
    /// The deepest overlap of a contact after the step, to first order (m); 0 when none overlaps.
    pub max_penetration: f64,
    /// The largest displacement of a vertex (m), to first order.
    pub max_displacement: f64,
    /// ½ vᵀM v of all blocks (J).
    pub kinetic: f64,
    /// Of gravity: −Σ m g·x₀ (J).
    pub gravitational: f64,
    /// Of strain: ½ V σᵀE⁻¹σ of all deformable blocks (J).
    pub elastic: f64,
    /// Of springs in contacts and fixed points: ½ p_n h² + ½ p_s s² (J).
    pub springs: f64,
}

impl StepReport {
    /// How many contacts have this kind and mode.
    pub fn count(&self, kind: ContactKind, mode: Mode) -> u32 {
        self.contacts[kind as usize][mode as usize]
    }

    /// All energy that is not kinetic (J).
    pub fn potential(&self) -> f64 {
        self.gravitational + self.elastic + self.springs
    }
}

/// Where the time of the open–close iteration went, over all steps so far, those of attempts given up included.
#[derive(Clone, Copy, Debug, Default)]
pub struct IterationTimes {
    /// Finding orders of elimination and the patterns of factors.
    pub order: Duration,
    /// Adding up forces, and finding where matrices will stand.
    pub assembly: Duration,
    /// Adding up matrices and factoring them; of small systems, their whole solution.
    pub factor: Duration,
    /// Solving by the factors, with the iteration of very large systems.
    pub substitution: Duration,
    /// Reading the solution at the contacts, and deciding their modes.
    pub judgement: Duration,
    /// Solves of all blocks.
    pub solves: u64,
}

/// An attempt at a step that was given up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Retry {
    /// Its Δt (s).
    pub time_step: f64,
    /// Why.
    pub why: RetryReason,
}

/// Why an attempt at a step was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RetryReason {
    /// Modes changed in too many solves (SPEC 5.10).
    NotConverged,
    /// A vertex moved beyond `max_displacement`.
    Displacement,
    /// A block turned beyond `max_rotation`.
    Rotation,
}

impl RetryReason {
    /// `not-converged`, `displacement` or `rotation`, as written in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            RetryReason::NotConverged => "not-converged",
            RetryReason::Displacement => "displacement",
            RetryReason::Rotation => "rotation",
        }
    }
}

/// Why a run cannot go on. The state is as it was before the step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The open–close iteration does not converge at the smallest Δt.
    #[error(
        "{}: the open–close iteration does not converge at the smallest time step, {time_step} s; still changing: {}",
        step_in_words(*step), list(contacts)
    )]
    NotConverged {
        /// The step.
        step: i64,
        /// Δt of the last attempt (s).
        time_step: f64,
        /// The contacts whose mode changed in the last solve.
        contacts: Vec<ModeChange>,
    },
    /// Motion exceeds the limits at the smallest Δt.
    #[error("{}: block {block} exceeds the limit of {} at the smallest time step, {time_step} s", step_in_words(*step), why.name())]
    TooFast {
        /// The step.
        step: i64,
        /// Δt of the last attempt (s).
        time_step: f64,
        /// The block.
        block: usize,
        /// Which limit.
        why: RetryReason,
    },
    /// A block turned inside out.
    #[error("{}: block {block} is inverted: its volume is {volume} m³", step_in_words(*step))]
    Inverted {
        /// The step.
        step: i64,
        /// The block.
        block: usize,
        /// Its volume (m³).
        volume: f64,
    },
    /// A block lost a feature: an edge without length, a face without area.
    #[error("{}: block {block}: {what}", step_in_words(*step))]
    Collapsed {
        /// The step.
        step: i64,
        /// The block.
        block: usize,
        /// The feature.
        what: crate::contact::Collapsed,
    },
    /// A number overflowed or is none.
    #[error("{}: a number of block {block} is not finite", step_in_words(*step))]
    NotFinite {
        /// The step.
        step: i64,
        /// The block.
        block: usize,
    },
    /// The system of equations has no solution in this precision.
    #[error("{}: the system of block {block} cannot be solved: a pivot is not positive", step_in_words(*step))]
    Singular {
        /// The step.
        step: i64,
        /// A block of the system.
        block: usize,
    },
}

/// A contact named in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModeChange {
    /// Its blocks.
    pub blocks: [u32; 2],
    /// Its kind and features.
    pub contact: ContactKey,
    /// Its mode before the last solve.
    pub from: Mode,
    /// Its mode after it.
    pub to: Mode,
}

fn list(contacts: &[ModeChange]) -> String {
    let mut text: Vec<String> = contacts
        .iter()
        .take(8)
        .map(|c| {
            let ([i, j], [a, b]) = (c.blocks, c.contact.numbers());
            format!("{} {a},{b} of blocks {i},{j} ({} to {})", c.contact.kind(), c.from.name(), c.to.name())
        })
        .collect();
    if contacts.len() > text.len() {
        text.push(format!("and {} more", contacts.len() - text.len()));
    }
    text.join("; ")
}
