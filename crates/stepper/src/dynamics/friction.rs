//! Friction within an open–close iteration (SPEC section 5): what acts across the normal of a sliding contact, and whether it has settled.

use crate::dynamics::step_rules::StepRules;
use crate::real::Real;
use crate::vector::Vector;

/// What acts across the normal of a sliding contact in one solve: a force against the last slip, and a spring on the part of the stretch
/// that lies across the last slip. Together they are the tangent of τ s/|s| at the last slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction<R> {
    /// f in N, on block j at Q; −f acts on block i at P.
    pub(super) force: Vector<R>,
    /// k in N/m.
    pub(super) spring: R,
    /// b, a unit vector across the normal and across the last slip; zero where nothing slipped.
    pub(super) across: Vector<R>,
}

impl<R: Real> Friction<R> {
    /// No force and no spring: the last slip is zero.
    pub(super) const NONE: Self = Friction { force: Vector::ZERO, spring: R::ZERO, across: Vector::ZERO };

    /// Of the last slip s₁ (m) and the secant stiffness |f|/|s₁| (N/m). `shear` is p_s in N/m, `normal` the unit normal.
    pub(super) fn along<M: StepRules>(slip: Vector<R>, secant: R, shear: R, normal: Vector<R>) -> Self {
        let length = slip.length();
        if !length.is_positive() {
            return Friction::NONE;
        }
        Friction { force: slip * secant, spring: M::spring_across(secant, shear), across: normal.cross(slip / length) }
    }

    /// Whether the spring bears on the matrix.
    pub(super) fn is_stiff(&self) -> bool {
        self.spring.is_positive()
    }

    /// The whole force at a stretch, `f + k(s·b)b` in N.
    pub(super) fn at(&self, stretch: Vector<R>) -> Vector<R> {
        self.force + self.across * (self.spring * stretch.dot(self.across))
    }
}

/// What one block's contacts that stay closed add up to in a solve.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrictionMisfit<R> {
    /// Σ|Δf| in N: by how much the tangential forces of the new modes differ from those that acted.
    pub(super) misfit: R,
    /// Σ p_n·max(0, −h) in N.
    pub(super) pressing: R,
}

impl<R: Real> FrictionMisfit<R> {
    /// Of no contact.
    pub(super) const NONE: Self = FrictionMisfit { misfit: R::ZERO, pressing: R::ZERO };

    /// Adds the share of one contact.
    pub(super) fn add(&mut self, share: FrictionMisfit<R>) {
        self.misfit = self.misfit + share.misfit;
        self.pressing = self.pressing + share.pressing;
    }
}
