//! The open–close iteration, its attempts and their Δt, and blocks that a step inverts (SPEC 5.10 to 5.12).

use super::answer::{FailedAttempt, IterationEnd, RetryReason, SLIPPING_SOLVES, StepFailure, UNCHANGED_SOLVES};
use super::attempt::Attempt;
use super::attempt_values::AttemptValues;
use super::cascade::{Cascade, StepLevelCounts};
use super::decisions::{DisplacementExceeded, FrictionSettled, Inverted, NextMode, RotationExceeded};
use super::prepare::PreparedStep;
use super::state::Mode;
use crate::number::Ball;
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::simulation::{Control, Unconverged};

/// How much longer than the last accepted Δt the next may begin: 3/2, as numerator and denominator.
const GROWTH: (i32, i32) = (3, 2);

/// The Δt with which a step begins: the full one, or 3/2 of the last that was accepted, whichever is less.
pub(super) fn first_time_step(prepared: &PreparedStep<'_>) -> BigRational {
    let growth = BigRational::new(GROWTH.0.into(), GROWTH.1.into());
    prepared.full_time_step().min(prepared.state.last_time_step.to_rational() * growth)
}

/// How an iteration ended.
pub(super) struct IterationResult {
    /// The modes after the last solve.
    pub(super) after: Vec<Mode>,
    pub(super) end: IterationEnd,
}

/// Tries until an attempt is good, or the last one allowed, and hands it on.
pub(super) fn attempts<T>(
    prepared: &PreparedStep<'_>,
    finish: impl FnOnce(Cascade<'_>, &Attempt<'_>, IterationResult, Vec<FailedAttempt>) -> Result<T, StepFailure>,
) -> Result<T, StepFailure> {
    let smallest = prepared.full_time_step() / BigInt::from(Control::SMALLEST);
    let (mut time_step, mut retries, mut levels) = (first_time_step(prepared), Vec::new(), StepLevelCounts::default());
    loop {
        let attempt = prepared.attempt(time_step.clone());
        let mut cascade = Cascade::new(&attempt, &prepared.layout, levels);
        let iterated = open_close_iteration(&mut cascade, &attempt);
        let beyond = if iterated.end.is_converged() {
            beyond_limits(&mut cascade)
        } else {
            Some((RetryReason::NotConverged, 0))
        };
        let Some((reason, block)) = beyond else {
            volumes_stay(&mut cascade)?;
            return finish(cascade, &attempt, iterated, retries);
        };
        let (numerator, denominator) = if reason == RetryReason::NotConverged { Control::CUT } else { (1, 2) };
        let shorter = &time_step * BigRational::new(numerator.into(), denominator.into());
        if shorter < smallest {
            return match (reason, prepared.model.simulation.control.unconverged) {
                (RetryReason::NotConverged, Unconverged::Accept) => {
                    volumes_stay(&mut cascade)?;
                    finish(cascade, &attempt, iterated, retries)
                }
                (RetryReason::NotConverged, Unconverged::Stop) => Err(StepFailure::NotConverged),
                (limit, _) => Err(StepFailure::TooFast { block, limit }),
            };
        }
        levels = cascade.levels;
        let solves = cascade.modes().len() as u32;
        let time_step = std::mem::replace(&mut time_step, shorter);
        retries.push(FailedAttempt { time_step, reason, solves, end: iterated.end });
    }
}

fn open_close_iteration(cascade: &mut Cascade<'_>, attempt: &Attempt<'_>) -> IterationResult {
    let mut modes = attempt.first_modes();
    let (mut unchanged, mut changing) = (0, 0);
    loop {
        cascade.solve(modes.clone());
        let next = |(contact, &mode)| cascade.ask(&NextMode { contact, mode }).unwrap_or(mode);
        let after: Vec<Mode> = modes.iter().enumerate().map(next).collect();
        // The last solve allowed without a change ends the iteration whether friction has settled or not.
        if after == modes && unchanged + 1 == UNCHANGED_SOLVES {
            return IterationResult { after, end: IterationEnd::Unchanged };
        }
        let stays_closed = modes.iter().zip(&after).all(|(mode, next)| (*mode == Mode::Open) == (*next == Mode::Open));
        if stays_closed && has_settled(cascade, [&modes, &after]) {
            return IterationResult { after, end: IterationEnd::Settled };
        }
        if after == modes {
            unchanged += 1;
        } else {
            changing += 1;
            if changing == SLIPPING_SOLVES || (changing >= Control::ITERATIONS && !stays_closed) {
                return IterationResult { after, end: IterationEnd::Changing };
            }
        }
        modes = after;
    }
}

/// Whether friction has settled in the last solve, in which no contact opened or closed. Where that stays undecided it counts as settled.
fn has_settled(cascade: &mut Cascade<'_>, modes: [&[Mode]; 2]) -> bool {
    // Only sliding contacts change their force.
    let slides = modes.iter().any(|modes| modes.contains(&Mode::Sliding));
    !slides || cascade.ask(&FrictionSettled { modes }).unwrap_or(true)
}

fn beyond_limits(cascade: &mut Cascade<'_>) -> Option<(RetryReason, usize)> {
    let far = cascade.ask(&DisplacementExceeded).flatten().map(|block| (RetryReason::Displacement, block));
    far.or_else(|| cascade.ask(&RotationExceeded).flatten().map(|block| (RetryReason::Rotation, block)))
}

/// A block of which the rotations and strains are together below this keeps its volume positive: the linear part of its map is I + E, a row of E
/// sums up to no more than they do, and I + t·E is singular for no t from 0 to 1.
const NO_INVERSION: f64 = 0.5;

/// That every block keeps a positive volume. Where that stays undecided it counts as kept.
fn volumes_stay(cascade: &mut Cascade<'_>) -> Result<(), StepFailure> {
    let bound = |d: &Vec<Ball>| d.iter().skip(3).map(|value| value.middle.abs() + value.radius).sum::<f64>();
    let is_small = |values: &AttemptValues<'_, Ball>| {
        let last = values.solves.last()?;
        let mut blocks = 0..values.attempt.blocks.len();
        Some(blocks.all(|block| values.displacement(last, block).is_some_and(|d| bound(d) < NO_INVERSION)))
    };
    if cascade.float().and_then(is_small) == Some(true) {
        return Ok(());
    }
    cascade.ask(&Inverted).flatten().map_or(Ok(()), |block| Err(StepFailure::Inverted { block }))
}
