//! How close the decisions about modes were.

use super::answer::{CertifiedStep, StepAnswer, StepFailure, StepModel};
use super::attempt_values::AttemptValues;
use super::cascade::{Cascade, StepLevelCounts};
use super::decisions::SETTLED;
use super::open_close_iteration::attempts;
use super::prepare::PreparedStep;
use super::state::{Mode, State};
use super::system::StepNumber;
use crate::field::Field;
use num_rational::BigRational;
use rockproof_model::Contact;

/// How far the quantities behind a contact's mode were from deciding otherwise, after one solve: value over the sum of the
/// magnitudes of its terms, **0 at a tie**. `None` where all terms are zero, or where balls of two f64 do not reach.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModeMargin {
    /// Of Eq. (1), h² against ε²·h0²; at most zero keeps the mode. `None` of a gap of 0 that stays 0: it keeps none.
    pub equal: Option<f64>,
    /// Of the gap against the distance at which an open contact closes, or a closed one opens; positive is further open. The gap's terms
    /// are the one before the step and its change.
    pub gap: Option<f64>,
    /// Of Mohr–Coulomb, p_s²·|s|² against τ²; positive slides.
    pub slip: Option<f64>,
    /// Of the turn of a contact that slid, s·s₁; negative locks. `None` also for other contacts.
    pub turn: Option<f64>,
}

/// The accepted attempt of a step that is decided.
#[derive(Clone, Copy, Debug)]
pub struct DecidedAttempt<'d> {
    /// The contacts of the step with their blocks, by pair and in SPEC order.
    pub contacts: &'d [([usize; 2], Contact)],
    /// Its Δt (s).
    pub time_step: &'d BigRational,
    /// As in [`StepAnswer::modes`].
    pub modes: &'d [Vec<Mode>],
}

impl<'d> From<&'d StepAnswer> for DecidedAttempt<'d> {
    fn from(StepAnswer { contacts, time_step, modes, .. }: &'d StepAnswer) -> DecidedAttempt<'d> {
        DecidedAttempt { contacts, time_step, modes }
    }
}

impl<'d> From<&'d CertifiedStep> for DecidedAttempt<'d> {
    fn from(CertifiedStep { contacts, time_step, modes, .. }: &'d CertifiedStep) -> DecidedAttempt<'d> {
        DecidedAttempt { contacts, time_step, modes }
    }
}

/// The margins of the attempt that was accepted of a step from `state`, solve by solve and contact by contact, nearly exact: of balls of two f64. Its
/// solves are made again, and nothing is decided. Empty where these balls do not enclose the step.
///
/// # Errors
/// When the step cannot be made: see [`StepFailure`].
pub fn mode_margins(
    model: &StepModel<'_>,
    state: &State,
    decided: DecidedAttempt<'_>,
) -> Result<Vec<Vec<ModeMargin>>, StepFailure> {
    let prepared = PreparedStep::with_contacts(model, state, Some(decided.contacts.to_vec()))?;
    let attempt = prepared.attempt(decided.time_step.clone());
    let mut cascade = Cascade::new(&attempt, &prepared.layout, StepLevelCounts::default());
    let solves = decided.modes.split_last().map_or(&[][..], |(_, solves)| solves);
    solves.iter().for_each(|modes| cascade.solve(modes.clone()));
    // Balls of two f64 begin with what those of f64 have found.
    cascade.float();
    let Some(values) = cascade.double() else { return Ok(Vec::new()) };
    let of_solve = |(solve, modes): (usize, &Vec<Mode>)| {
        modes.iter().enumerate().map(|(contact, mode)| margin(values, solve, contact, *mode)).collect()
    };
    Ok(solves.iter().enumerate().map(of_solve).collect())
}

/// How far friction was from deciding otherwise whether it has settled, after each solve of the accepted attempt of a step: the largest
/// over all moving blocks of `100·Σ|Δf| − Σ p_n·max(0, −h)` over the sum of both, **0 at a tie**, which has settled; positive has not.
/// `None` where nothing is closed both in and after a solve, or where balls of two f64 do not reach.
///
/// # Errors
/// When the step cannot be made: see [`StepFailure`].
pub fn friction_margins(model: &StepModel<'_>, state: &State) -> Result<Vec<Option<f64>>, StepFailure> {
    let prepared = PreparedStep::new(model, state)?;
    attempts(&prepared, |mut cascade, _, iterated, _| {
        let mut modes = cascade.modes().to_vec();
        modes.push(iterated.after);
        let Some(values) = cascade.double() else { return Ok(vec![None; modes.len() - 1]) };
        let of_solve = |(solve, modes): (usize, &[Vec<Mode>])| {
            let sums = values.force_changes(values.solves.get(solve)?, [&modes[0], &modes[1]])?;
            let of_block = |[change, pressure]: &[_; 2]| {
                let (change, pressure) = (near(change) * f64::from(SETTLED), near(pressure));
                share(change - pressure, change + pressure)
            };
            sums.iter().filter_map(of_block).reduce(f64::max)
        };
        Ok(modes.windows(2).enumerate().map(of_solve).collect())
    })
}

fn margin<S: StepNumber>(values: &AttemptValues<'_, S>, solve: usize, k: usize, mode: Mode) -> ModeMargin {
    ModeMargin {
        equal: equal(values, solve, k),
        gap: gap(values, solve, k, mode),
        slip: slip(values, solve, k),
        turn: turn(values, solve, k),
    }
}

fn near<S: Field>(value: &S) -> f64 {
    value.nearby().0
}

fn share(value: f64, terms: f64) -> Option<f64> {
    let share = value / terms;
    share.is_finite().then_some(share)
}

fn equal<S: StepNumber>(values: &AttemptValues<'_, S>, solve: usize, k: usize) -> Option<f64> {
    let square = values.gap(values.solves.get(solve)?, k)?.squared();
    let limit = values.limits.equal.times(&values.contact(k)?.gap.squared());
    share(near(&square.minus(&limit)), near(&square).abs() + near(&limit).abs())
}

fn gap<S: StepNumber>(values: &AttemptValues<'_, S>, solve: usize, k: usize, mode: Mode) -> Option<f64> {
    let (contact, joint) = (values.contact(k)?, &values.joints[k]);
    let gap = values.gap(values.solves.get(solve)?, k)?;
    let length = |square: &S| match square.is_zero() {
        true => Some(square.clone()),
        false => Some(square.root()?.times(&contact.square.root()?)),
    };
    let (value, limit) = match mode {
        Mode::Open => {
            let limit = length(&values.limits.close)?;
            (gap.plus(&limit), limit)
        }
        _ => {
            let limit = length(&values.limits.open)?.plus(&joint.tensile);
            (gap.minus(&limit), limit)
        }
    };
    let change = gap.minus(&contact.gap);
    share(near(&value), near(&contact.gap).abs() + near(&change).abs() + near(&limit).abs())
}

fn slip<S: StepNumber>(values: &AttemptValues<'_, S>, solve: usize, k: usize) -> Option<f64> {
    let (contact, joint, solve) = (values.contact(k)?, &values.joints[k], values.solves.get(solve)?);
    let shear = joint.shear.squared().times(&values.stretch(solve, k)?.norm_squared()).times(&contact.square);
    let strength = values.strength(k, values.gap(solve, k)?)?.squared();
    share(near(&shear.minus(&strength)), near(&shear).abs() + near(&strength).abs())
}

fn turn<S: StepNumber>(values: &AttemptValues<'_, S>, solve: usize, k: usize) -> Option<f64> {
    let solve = values.solves.get(solve)?;
    let (s, last) = (values.stretch(solve, k)?, &values.slip_force(solve, k)??.last);
    let terms = s.components().into_iter().zip(last.components()).map(|(a, b)| near(&a.times(b)).abs());
    share(near(&s.dot(last)), terms.sum())
}
