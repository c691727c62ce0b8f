//! A contact within a step: its springs, and what the last solve says of it (SPEC section 5).

use crate::dynamics::displacement::{BlockVector, displacement, dot, generalized};
use crate::dynamics::friction::{Friction, FrictionMisfit};
use crate::dynamics::material::JointSprings;
use crate::dynamics::plane::Plane;
use crate::dynamics::setup::StepLimits;
use crate::dynamics::state::{ContactState, Mode};
use crate::dynamics::step_rules::{StepRules, TangentialState};
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::Contact;

/// A contact of the step in work. What is called i and j is as in SPEC: i enters, j holds the entrance's face.
#[derive(Clone, Debug)]
pub(super) struct StepContact<R> {
    /// The blocks: A, B.
    pub(super) blocks: [u32; 2],
    pub(super) contact: Contact,
    pub(super) plane: Plane<R>,
    pub(super) joint: JointSprings<R>,
    /// Cohesion on the contact's area, in N.
    pub(super) cohesive: R,
    /// The gap that its tensile strength can stretch, in m.
    pub(super) tensile_gap: R,
    /// Material points of i and of j.
    pub(super) anchors: [Vector<R>; 2],
    /// The mode when the step begins.
    pub(super) begins: Mode,
    /// What the last solve says.
    pub(super) iterate: ContactIterate<R>,
}

/// What the last solve says of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactIterate<R> {
    /// The mode in which the next solve takes it; the last one's when the iteration is over.
    pub(super) mode: Mode,
    /// h in m.
    pub(super) gap: R,
    /// s in m.
    pub(super) stretch: Vector<R>,
    /// While sliding: what acts across the normal in the next solve.
    pub(super) friction: Friction<R>,
}

/// The springs of a contact in a solve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resistance<R> {
    mode: Mode,
    normal: Vector<R>,
    /// Along the normal, in N/m.
    pressing: R,
    /// Across it while locked, in N/m.
    shear: R,
    /// While sliding: across the last slip, in N/m.
    across: Vector<R>,
    spring: R,
}

impl<R: Real> Resistance<R> {
    /// The sum of what it resists with along three axes, in N/m.
    pub(super) fn trace(&self) -> R {
        match self.mode {
            Mode::Locked => self.pressing + self.shear + self.shear,
            Mode::Sliding => self.pressing + self.spring * self.across.dot(self.across),
            Mode::Open => R::ZERO,
        }
    }

    /// The force in N by which they resist when block i moves by `apart` against block j at the contact (m).
    #[inline(always)]
    pub(super) fn against(&self, apart: Vector<R>) -> Vector<R> {
        let along = self.normal.dot(apart);
        let pressing = self.normal * (self.pressing * along);
        match self.mode {
            Mode::Locked => pressing + (apart - self.normal * along) * self.shear,
            Mode::Sliding => pressing + self.across * (self.spring * apart.dot(self.across)),
            Mode::Open => Vector::ZERO,
        }
    }
}

impl<R: Real> StepContact<R> {
    /// Blocks i and j.
    pub(super) fn entering(&self) -> [usize; 2] {
        let [a, b] = self.blocks.map(|block| block as usize);
        if self.plane.a_enters { [a, b] } else { [b, a] }
    }

    /// P − x₀ of block i and Q − x₀ of block j, from their centroids. Not kept: there are many contacts.
    #[inline(always)]
    pub(super) fn arms(&self, [i, j]: [Vector<R>; 2]) -> [Vector<R>; 2] {
        [self.plane.p - i, self.plane.q - j]
    }

    /// s0: the stretch across the normal when the step begins, in m. Not kept either.
    #[inline(always)]
    pub(super) fn first_stretch(&self) -> Vector<R> {
        self.across(self.anchors[0] - self.anchors[1])
    }

    /// What its springs resist with in the next solve.
    pub(super) fn resistance(&self) -> Resistance<R> {
        let friction = &self.iterate.friction;
        let (normal, mode) = (self.plane.normal, self.iterate.mode);
        let (pressing, shear) = (self.joint.normal, self.joint.shear);
        Resistance { mode, normal, pressing, shear, across: friction.across, spring: friction.spring }
    }

    /// As it was when the step began, with the mode of the first solve. The last slip of a sliding contact is then s0, and f = p_s·s0: what the dragged
    /// anchor remembers.
    pub(super) fn reset<M: StepRules>(&mut self, mode: Mode) {
        let (shear, stretch) = (self.joint.shear, self.first_stretch());
        // Of others nobody asks it, and a stretch that is nothing but for rounding would leave open whether there is one.
        let friction = match mode {
            Mode::Sliding => Friction::along::<M>(stretch, shear, shear, self.plane.normal),
            Mode::Locked | Mode::Open => Friction::NONE,
        };
        self.iterate = ContactIterate { mode, gap: self.plane.gap, stretch, friction };
    }

    /// The part of a vector across the normal.
    pub(super) fn across(&self, v: Vector<R>) -> Vector<R> {
        v - self.plane.normal * self.plane.normal.dot(v)
    }

    /// Reads h and s of a solve, and takes the mode for the next that follows from them, or the one that is given. Says what it adds to the question
    /// whether friction has settled: nothing unless it was closed in the solve and is after it.
    pub(super) fn decide_mode<M: StepRules>(
        &mut self,
        d: [&BlockVector<R>; 2],
        arms: [Vector<R>; 2],
        limits: &StepLimits<R>,
        settling: bool,
        prescribed: Option<Mode>,
    ) -> FrictionMisfit<R> {
        let before = self.iterate.mode;
        // `T_iᵀn` and `T_jᵀn`.
        let [e, g] = arms.map(|arm| generalized(arm, self.plane.normal));
        let gap = self.plane.gap + dot(&e, d[0], 12) - dot(&g, d[1], 12);
        let moved = displacement(arms[0], d[0]) - displacement(arms[1], d[1]);
        let stretch = self.first_stretch() + self.across(moved);
        (self.iterate.gap, self.iterate.stretch) = (gap, stretch);
        let acted = self.tangential(before);
        let after = prescribed.unwrap_or_else(|| self.mode_after_solve::<M>(limits, settling));
        self.take::<M>(after);
        if before.is_closed() && after.is_closed() {
            let stuck = before == Mode::Locked && after == Mode::Locked;
            let misfit = if stuck { R::ZERO } else { (self.tangential_after(after) - acted).length() };
            FrictionMisfit { misfit, pressing: self.joint.normal * M::pressing(gap) }
        } else {
            FrictionMisfit::NONE
        }
    }

    /// The mode that follows from h and s of a solve in which it had the present one. While settling, what is closed is locked.
    fn mode_after_solve<M: StepRules>(&self, limits: &StepLimits<R>, settling: bool) -> Mode {
        let (before, gap) = (self.iterate.mode, self.iterate.gap);
        let kept = M::keeps_mode(gap, self.plane.gap, limits.equal);
        let closed = match before {
            _ if kept => before.is_closed(),
            Mode::Open => M::closes(gap, limits.close),
            _ => !M::opens(gap, limits.open, self.tensile_gap),
        };
        match closed {
            false => Mode::Open,
            true if settling => Mode::Locked,
            true => {
                let slides = if kept { before == Mode::Sliding } else { !self.locks::<M>(before) };
                if slides { Mode::Sliding } else { Mode::Locked }
            }
        }
    }

    /// Whether what is closed after a solve is locked: its spring holds, or it slid in this solve and its slip turned.
    fn locks<M: StepRules>(&self, before: Mode) -> bool {
        let turned = || M::slip_turned(self.iterate.stretch.dot(self.iterate.friction.force));
        M::holds(before, &self.slip::<M>()) || (before == Mode::Sliding && turned())
    }

    /// Whether a spring acts across its slip in the next solve.
    pub(super) fn is_stiff_across(&self) -> bool {
        self.iterate.mode == Mode::Sliding && self.iterate.friction.is_stiff()
    }

    /// Takes a mode for the next solve, with the gap and the stretch of the last one.
    fn take<M: StepRules>(&mut self, mode: Mode) {
        self.iterate.mode = mode;
        if mode == Mode::Sliding {
            let slip = self.iterate.stretch;
            let length = slip.length();
            self.iterate.friction = if length.is_positive() {
                let secant = self.strength::<M>() / length;
                Friction::along::<M>(slip, secant, self.joint.shear, self.plane.normal)
            } else {
                Friction::NONE
            };
        }
    }

    /// The tangential force in N that acted in the last solve, on block j.
    fn tangential(&self, mode: Mode) -> Vector<R> {
        match mode {
            Mode::Open => Vector::ZERO,
            Mode::Locked => self.iterate.stretch * self.joint.shear,
            Mode::Sliding => self.iterate.friction.at(self.iterate.stretch),
        }
    }

    /// The tangential force in N of the mode after the last solve, on block j: p_s·s, or τ·s/|s|.
    pub(super) fn tangential_after(&self, mode: Mode) -> Vector<R> {
        match mode {
            Mode::Open => Vector::ZERO,
            Mode::Locked => self.iterate.stretch * self.joint.shear,
            Mode::Sliding => self.iterate.friction.force,
        }
    }

    fn slip<M: StepRules>(&self) -> TangentialState<R> {
        TangentialState {
            normal: self.joint.normal,
            shear: self.joint.shear,
            stretch_squared: self.iterate.stretch.dot(self.iterate.stretch),
            friction: M::strength(self.joint.friction, self.joint.normal * M::pressing(self.iterate.gap), R::ZERO),
            strength: self.strength::<M>(),
        }
    }

    /// τ in N at the present gap.
    pub(super) fn strength<M: StepRules>(&self) -> R {
        let normal_force = self.joint.normal * M::pressing(self.iterate.gap);
        M::strength(self.joint.friction, normal_force, self.cohesive)
    }

    /// A length along the slip direction s/|s|; zero where nothing slipped.
    fn along_slip(&self, length: R) -> Vector<R> {
        let slip = self.iterate.stretch.length();
        if slip.is_positive() { self.iterate.stretch * (length / slip) } else { Vector::ZERO }
    }

    /// Whether its stiffness couples two blocks.
    pub(super) fn is_closed(&self) -> bool {
        self.iterate.mode.is_closed()
    }

    /// The force on block i in N, by the mode after the last solve.
    fn force(&self) -> Vector<R> {
        if self.iterate.mode == Mode::Open {
            return Vector::ZERO;
        }
        self.plane.normal * (-self.joint.normal * self.iterate.gap) - self.tangential_after(self.iterate.mode)
    }

    /// What is left of it after a step. `moved` moves a material point of i or of j.
    pub(super) fn state_after_step<M: StepRules>(
        &self,
        moved: impl Fn(usize, Vector<R>) -> Vector<R>,
    ) -> ContactState<R> {
        let [i, j] = self.entering();
        let mut anchors = [moved(i, self.anchors[0]), moved(j, self.anchors[1])];
        if self.iterate.mode == Mode::Sliding && M::drags_anchor() {
            let shear = self.joint.shear;
            let left = if R::ZERO.below(shear) { self.along_slip(self.strength::<M>() / shear) } else { Vector::ZERO };
            anchors[1] = anchors[0] - left;
        }
        let force = self.force();
        let (normal, mut points) = (self.plane.normal, [self.plane.p, self.plane.q]);
        if !self.plane.a_enters {
            anchors.reverse();
            points.reverse();
        }
        let on_a = |v: Vector<R>| if self.plane.a_enters { v } else { -v };
        ContactState {
            blocks: self.blocks,
            contact: self.contact,
            mode: self.iterate.mode,
            anchors,
            gap: self.iterate.gap,
            normal: on_a(normal),
            points,
            force: on_a(force),
        }
    }
}
