//! The decisions of a step, each asked of one number type (SPEC 5.9, 5.11 and 5.12): `None` where that cannot tell.

use super::attempt_values::{AttemptValues, JointIn};
use super::frame;
use super::friction::SlipForce;
use super::state::Mode;
use super::system::StepNumber;
use crate::field::Field;
use rockproof_model::simulation::Kinematics;
use rockproof_model::{Sign, Vec3};

/// A question that any level can be asked.
pub(crate) trait StepDecision {
    type Answer;
    fn ask<S: StepNumber>(&self, values: &AttemptValues<'_, S>) -> Option<Self::Answer>;
    /// The contact it is about, if it is about one.
    fn contact(&self) -> Option<usize> {
        None
    }
}

/// The mode of a contact after the last solve.
pub(crate) struct NextMode {
    pub(crate) contact: usize,
    pub(crate) mode: Mode,
}

impl StepDecision for NextMode {
    type Answer = Mode;
    fn contact(&self) -> Option<usize> {
        Some(self.contact)
    }
    fn ask<S: StepNumber>(&self, values: &AttemptValues<'_, S>) -> Option<Mode> {
        let k = self.contact;
        let (contact, joint, solve) = (values.contact(k)?, &values.joints[k], values.solves.last()?);
        let gap = values.gap(solve, k)?;
        // Homogeneous in |N|: squares are compared, so no root is taken.
        let square = gap.squared();
        let kept = square.minus(&values.limits.equal.times(&contact.gap.squared())).certain_sign()?.is_at_most_zero();
        // A gap of 0 that stays 0 bears no force, so that shear decides.
        if kept && !contact.gap.certain_sign()?.is_zero() {
            return Some(self.mode);
        }
        let beyond = |square: &S, limit: &S| {
            let limit = limit.times(&contact.square);
            Some(square.minus(&limit).certain_sign()?.is_positive())
        };
        let closed = match self.mode {
            Mode::Open => gap.certain_sign()?.is_negative() && beyond(&square, &values.limits.close)?,
            _ => {
                // h − tension·area/p_n beyond εo, times |N|.
                let stretched = gap.minus(&joint.tensile);
                !(stretched.certain_sign()?.is_positive() && beyond(&stretched.squared(), &values.limits.open)?)
            }
        };
        if !closed {
            return Some(Mode::Open);
        }
        if values.attempt.settling {
            return Some(Mode::Locked);
        }
        // p_s²|s|² ≤ τ², times |N|².
        let s = values.stretch(solve, k)?;
        let shear = joint.shear.squared().times(&s.norm_squared()).times(&contact.square);
        let excess = shear.minus(&values.strength(k, gap)?.squared());
        let held = excess.certain_sign().map(Sign::is_at_most_zero);
        let turned = values.slip_force(solve, k).and_then(|slip| slip.map_or(Some(false), |slip| has_turned(slip, s)));
        match (held, turned) {
            (Some(true), _) | (_, Some(true)) => Some(Mode::Locked),
            (Some(false), Some(false)) => Some(Mode::Sliding),
            _ => None,
        }
    }
}

/// Whether the slip of a contact that slid turned: `s·f < 0`, which is `s·s₁ < 0` where f is not zero. **A slip across the last one
/// has not turned.**
fn has_turned<S: Field>(slip: &SlipForce<S>, s: &Vec3<S>) -> Option<bool> {
    let (along, force) = (s.dot(&slip.last).certain_sign(), slip.secant.certain_sign());
    match (along.map(Sign::is_negative), force.map(Sign::is_positive)) {
        (Some(false), _) | (_, Some(false)) => Some(false),
        (Some(true), Some(true)) => Some(true),
        _ => None,
    }
}

/// Whether friction has settled in the last solve, in which no contact opened or closed: for each moving block,
/// `100·Σ|Δf| ≤ Σ p_n·max(0, −h)` over its closed contacts. **Equality has settled.**
pub(crate) struct FrictionSettled<'m> {
    /// The modes in the last solve, and those that followed from it.
    pub(crate) modes: [&'m [Mode]; 2],
}

/// So many times the change of friction at a block may be no more than what presses it.
pub(crate) const SETTLED: i32 = 100;

impl StepDecision for FrictionSettled<'_> {
    type Answer = bool;
    fn ask<S: StepNumber>(&self, values: &AttemptValues<'_, S>) -> Option<bool> {
        let solve = values.solves.last()?;
        let sums = values.force_changes(solve, self.modes)?;
        let pushes = |joint: &JointIn<S>| joint.normal.certain_sign().is_some_and(|sign| !sign.is_negative());
        // No sum of pressures is less than no change, however near to zero it is.
        let push = values.joints.iter().all(pushes);
        let changing = sums.iter().filter(|[change, _]| !(push && change.is_zero()));
        let excess = changing.map(|[change, pressure]| change.times(&S::from_i32(SETTLED)).minus(pressure));
        let signs: Vec<Option<Sign>> = excess.map(|excess| excess.certain_sign()).collect();
        if signs.iter().flatten().any(|sign| sign.is_positive()) {
            return Some(false);
        }
        signs.iter().all(Option::is_some).then_some(true)
    }
}

/// Which block moves a vertex beyond u.
pub(crate) struct DisplacementExceeded;

impl StepDecision for DisplacementExceeded {
    type Answer = Option<usize>;
    fn ask<S: StepNumber>(&self, values: &AttemptValues<'_, S>) -> Option<Option<usize>> {
        let solve = values.solves.last()?;
        for (block, _) in values.attempt.moving() {
            let (moments, d) = (values.moments(block)?, values.displacement(solve, block)?);
            for vertex in &moments.points {
                let moved = frame::displacement(&vertex.minus(&moments.centroid), d);
                if moved.norm_squared().minus(&values.limits.displacement).certain_sign()?.is_positive() {
                    return Some(Some(block));
                }
            }
        }
        Some(None)
    }
}

/// Which block turns beyond ω.
pub(crate) struct RotationExceeded;

impl StepDecision for RotationExceeded {
    type Answer = Option<usize>;
    fn ask<S: StepNumber>(&self, values: &AttemptValues<'_, S>) -> Option<Option<usize>> {
        let solve = values.solves.last()?;
        for (block, _) in values.attempt.moving() {
            let d = values.displacement(solve, block)?;
            let turn = Vec3::new(d[3].clone(), d[4].clone(), d[5].clone());
            if turn.norm_squared().minus(&values.limits.rotation).certain_sign()?.is_positive() {
                return Some(Some(block));
            }
        }
        Some(None)
    }
}

/// Which block the step leaves without a positive volume: the map of its points is affine, so its volume is multiplied by the determinant of
/// the linear part. **A volume of zero is not positive.**
pub(crate) struct Inverted;

impl StepDecision for Inverted {
    type Answer = Option<usize>;
    fn ask<S: StepNumber>(&self, values: &AttemptValues<'_, S>) -> Option<Option<usize>> {
        let solve = values.solves.last()?;
        let turns = values.attempt.model.simulation.control.kinematics == Kinematics::Linear;
        let [zero, one] = [0, 1].map(S::from_i32);
        let axes = [[&one, &zero, &zero], [&zero, &one, &zero], [&zero, &zero, &one]];
        for (block, _) in values.attempt.moving() {
            // Translations change no volume, and under `cayley` rotations are rotations.
            let mut d = values.displacement(solve, block)?.clone();
            d.iter_mut().take(if turns { 3 } else { 6 }).for_each(|value| *value = zero.clone());
            let [a, b, c] = axes.map(|[x, y, z]| {
                let axis = Vec3::new(x.clone(), y.clone(), z.clone());
                frame::displacement(&axis, &d).plus(&axis)
            });
            if a.dot(&b.cross(&c)).certain_sign()?.is_at_most_zero() {
                return Some(Some(block));
            }
        }
        Some(None)
    }
}
