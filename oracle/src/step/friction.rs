//! The tangential forces of contacts (SPEC 5.8 and 5.9): what friction does to a sliding one, and how far that is from what
//! its last solve asks for.

use super::attempt_solve::AttemptSolve;
use super::attempt_values::AttemptValues;
use super::state::Mode;
use super::system::StepNumber;
use crate::field::Field;
use rockproof_model::{Ring, Vec3};

/// What friction does to a sliding contact in one solve: a force f along the last slip, and a spring on the part of the stretch
/// across it.
#[derive(Clone)]
pub(crate) struct SlipForce<S> {
    /// s₁: the stretch of the last solve, or s0 in an attempt's first.
    pub(crate) last: Vec3<S>,
    /// `|f|/|s₁|`, never negative.
    pub(crate) secant: S,
    /// `N × s₁`, along b.
    pub(crate) across: Vec3<S>,
    /// `k/|N × s₁|²`, never negative.
    pub(crate) spring: S,
}

impl<S: Field> SlipForce<S> {
    /// No force where the slip was `last`.
    pub(crate) fn none(last: &Vec3<S>) -> SlipForce<S> {
        SlipForce { last: last.clone(), secant: S::from_i32(0), across: Vec3::zero(), spring: S::from_i32(0) }
    }

    /// `f + k(s·b)b` at the stretch s, on J.
    pub(crate) fn at(&self, s: &Vec3<S>) -> Vec3<S> {
        if self.spring.is_zero() {
            return self.constant();
        }
        self.with_spring(s)
    }
}

impl<S: Ring> SlipForce<S> {
    /// f, on J.
    pub(crate) fn constant(&self) -> Vec3<S> {
        self.last.scaled(&self.secant)
    }

    /// `f + k(s·b)b`, k zero or not.
    pub(crate) fn with_spring(&self, s: &Vec3<S>) -> Vec3<S> {
        self.constant().plus(&self.across.scaled(&self.spring.times(&s.dot(&self.across))))
    }
}

impl<S: StepNumber> AttemptValues<'_, S> {
    /// What friction does in the next solve to each contact that slides in these modes. `None` where this type has no such root, or
    /// cannot tell a slip from none.
    pub(crate) fn friction(&self, modes: &[Mode]) -> Option<Vec<Option<SlipForce<S>>>> {
        let of = |(k, mode): (usize, &Mode)| {
            if *mode == Mode::Sliding { self.slip(k, self.solves.last()).map(Some) } else { Some(None) }
        };
        modes.iter().enumerate().map(of).collect()
    }

    /// What friction does to a contact in the solve after `before`, or in the first.
    pub(crate) fn slip(&self, k: usize, before: Option<&AttemptSolve<S>>) -> Option<SlipForce<S>> {
        let (contact, joint) = (self.contact(k)?, &self.joints[k]);
        let (last, secant) = match before {
            None => (&contact.stretch, joint.shear.clone()),
            Some(solve) => (self.stretch(solve, k)?, self.secant(k, solve)?),
        };
        let square = last.norm_squared();
        if square.is_zero() || secant.is_zero() {
            return Some(SlipForce::none(last));
        }
        // |N × s₁|² = |N|²·|s₁|².
        let spring = secant.lesser(&joint.shear)?.over(&square.times(&contact.square))?;
        Some(SlipForce { last: last.clone(), secant, across: contact.normal.cross(last), spring })
    }

    /// `τ/|s|` of a contact after a solve: the force of sliding over the stretch; zero where s is zero.
    pub(crate) fn secant(&self, k: usize, solve: &AttemptSolve<S>) -> Option<S> {
        let (strength, square) = (self.strength(k, self.gap(solve, k)?)?, self.stretch(solve, k)?.norm_squared());
        if strength.is_zero() || square.is_zero() {
            return Some(S::from_i32(0));
        }
        // τ/|s|, both times |N|.
        strength.over(&square.times(&self.contact(k)?.square).root()?)
    }

    /// τ times |N| at a gap, that times |N| too: `tan φ·p_n·max(0, −h) + c·area`.
    pub(crate) fn strength(&self, k: usize, gap: &S) -> Option<S> {
        let joint = &self.joints[k];
        if joint.friction.is_zero() {
            return Some(joint.cohesive.clone());
        }
        Some(joint.cohesive.minus(&joint.friction.times(&gap.lesser(&S::from_i32(0))?)))
    }

    /// `p_n·max(0, −h)` after a solve.
    pub(crate) fn pressure(&self, k: usize, solve: &AttemptSolve<S>) -> Option<S> {
        let overlap = self.gap(solve, k)?.lesser(&S::from_i32(0))?;
        if overlap.is_zero() {
            return Some(overlap);
        }
        self.joints[k].normal.times(&overlap.negated()).over(&self.contact(k)?.square.root()?)
    }

    /// `|Δf|`: the tangential force of the mode after a solve less the one that acted in it, of a contact closed in both.
    pub(crate) fn force_change(&self, k: usize, solve: &AttemptSolve<S>, modes: [Mode; 2]) -> Option<S> {
        let (s, shear) = (self.stretch(solve, k)?, &self.joints[k].shear);
        let acted = match self.slip_force(solve, k)? {
            Some(slip) => slip.at(s),
            None => s.scaled(shear),
        };
        let next = match modes {
            [_, Mode::Sliding] => s.scaled(&self.secant(k, solve)?),
            [Mode::Sliding, _] => s.scaled(shear),
            _ => return Some(S::from_i32(0)),
        };
        next.minus(&acted).norm_squared().root_of_square()
    }

    /// `Σ|Δf|` and `Σ p_n·max(0, −h)` of each moving block, over its contacts closed both in a solve and after it.
    pub(crate) fn force_changes(&self, solve: &AttemptSolve<S>, modes: [&[Mode]; 2]) -> Option<Vec<[S; 2]>> {
        let mut sums = vec![[S::from_i32(0), S::from_i32(0)]; self.attempt.sizes.len()];
        for (k, started) in self.attempt.started.iter().enumerate() {
            let modes = modes.map(|modes| modes[k]);
            if modes.contains(&Mode::Open) {
                continue;
            }
            let more = [self.force_change(k, solve, modes)?, self.pressure(k, solve)?];
            for row in started.blocks.into_iter().filter_map(|block| self.attempt.rows[block]) {
                sums[row] = std::array::from_fn(|part| sums[row][part].plus(&more[part]));
            }
        }
        Some(sums)
    }

    /// `τ/p_s · s/|s|` of a contact that slid; zero without a shear spring.
    pub(crate) fn remembered_stretch(&self, k: usize) -> Option<Vec3<S>> {
        let (shear, last) = (&self.joints[k].shear, self.solves.last()?);
        if shear.is_zero() {
            return Some(Vec3::zero());
        }
        Some(self.stretch(last, k)?.scaled(&self.secant(k, last)?.over(shear)?))
    }
}
