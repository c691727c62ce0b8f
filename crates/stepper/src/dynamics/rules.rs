//! Every comparison of the open–close iteration and of step control (SPEC section 5), one small method each.
//!
//! As in [`crate::contact::rules`], the trait exists so that a test can plant one deliberate mistake at a time.

use crate::contact::{Rules, Spec};
use crate::dynamics::state::Mode;
use crate::real::Real;
use rockproof_model::simulation::Control;

/// What a closed contact bears across its normal.
#[derive(Clone, Copy, Debug)]
pub struct Slip<R> {
    /// p_n in N/m.
    pub normal: R,
    /// p_s in N/m.
    pub shear: R,
    /// |s|² in m².
    pub stretch_squared: R,
    /// tan φ·p_n·max(0, −h) in N.
    pub friction: R,
    /// τ in N.
    pub strength: R,
}

/// The rules of SPEC section 5 as the step asks them. The defaults are SPEC's.
pub trait StepRules: Rules {
    /// Mode of a contact that continues none: locked when its gap is at most 0. **A tie locks.**
    fn begins<R: Real>(gap: R) -> Mode {
        if gap <= R::ZERO { Mode::Locked } else { Mode::Open }
    }

    /// Eq. (1): the gap after the solve is too small against the one before to judge by. **A tie keeps the mode.**
    fn keeps_mode<R: Real>(gap: R, gap_before: R, equal: R) -> bool {
        gap.abs() <= equal * gap_before.abs()
    }

    /// An open contact closes. **A tie stays open.**
    fn closes<R: Real>(gap: R, close: R) -> bool {
        gap < -close
    }

    /// A closed contact opens: the gap is beyond εo and what its tensile strength can stretch. **A tie stays closed.**
    fn opens<R: Real>(gap: R, open: R, tensile_gap: R) -> bool {
        gap > open + tensile_gap
    }

    /// The overlap that presses: max(0, −h).
    fn pressing<R: Real>(gap: R) -> R {
        (-gap).larger(R::ZERO)
    }

    /// τ in N: tan φ·p_n·max(0, −h) + cohesion on the contact's area.
    fn strength<R: Real>(friction: R, normal_force: R, cohesive_force: R) -> R {
        friction * normal_force + cohesive_force
    }

    /// A closed contact is locked: the spring's force is at most τ. Both squared. **A tie locks.**
    fn locks<R: Real>(force_squared: R, strength_squared: R) -> bool {
        force_squared <= strength_squared
    }

    /// Whether a closed contact is locked, with its mode in this solve, which plays no part.
    fn holds<R: Real>(_before: Mode, slip: &Slip<R>) -> bool {
        let spring = slip.shear * slip.shear * slip.stretch_squared;
        Self::locks(spring, slip.strength * slip.strength)
    }

    /// Which changes of mode count against convergence: all of them.
    fn counts_as_change(before: Mode, after: Mode) -> bool {
        before != after
    }

    /// Solves before Δt is cut.
    fn iterations() -> u32 {
        Control::ITERATIONS
    }

    /// The Δt that follows one at which the iteration did not converge.
    fn cut<R: Real>(time_step: R) -> R {
        time_step * R::from_f64(f64::from(Control::CUT.0)) / R::from_f64(f64::from(Control::CUT.1))
    }

    /// The smallest Δt allowed. A tie is allowed.
    fn smallest<R: Real>(time_step: R) -> R {
        time_step / R::from_f64(f64::from(Control::SMALLEST))
    }

    /// A vertex moved too far; both squared. **A tie is allowed.**
    fn too_far<R: Real>(distance_squared: R, limit_squared: R) -> bool {
        distance_squared > limit_squared
    }

    /// A block turned too far; both squared. **A tie is allowed.**
    fn turned_too_far<R: Real>(angle_squared: R, limit_squared: R) -> bool {
        angle_squared > limit_squared
    }

    /// Whether a sliding contact's anchor is dragged behind after the step.
    fn drags_anchor() -> bool {
        true
    }

    /// Whether a contact that continues another keeps its mode and anchors.
    fn transfers() -> bool {
        true
    }

    /// The rate after a step: k_d·((2/Δt)·d − v).
    fn rate<R: Real>(dynamic: R, twice_mean: R, before: R) -> R {
        dynamic * (twice_mean - before)
    }
}

impl StepRules for Spec {}
