//! The comparisons of the open–close iteration and of step control (SPEC section 5), one small method each; areas of joints (5.15) and the smallest
//! Δt are compared where they are used.
//!
//! As in [`crate::contact::contact_rules`], the trait exists so that a test can plant one deliberate mistake at a time.

use crate::contact::{ContactRules, SpecRules};
use crate::dynamics::compiled::CompiledSteps;
use crate::dynamics::decided::DecidedStep;
use crate::dynamics::prescribed::PrescribedStep;
use crate::dynamics::report::{StepError, StepReport};
use crate::dynamics::setup::SetupError;
use crate::dynamics::solve::Solve;
use crate::dynamics::state::{Mode, State};
use crate::dynamics::step::Dynamics;
use crate::real::Real;
use rockproof_model::simulation::Control;
use rockproof_model::{Contact, Scene, ToleranceSet};

/// What a closed contact bears across its normal.
#[derive(Clone, Copy, Debug)]
pub struct TangentialState<R> {
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
pub trait StepRules: ContactRules {
    /// Mode of a contact that continues none: locked when its gap is at most 0. **A tie locks.**
    fn begins<R: Real>(gap: R) -> Mode {
        if gap <= R::ZERO { Mode::Locked } else { Mode::Open }
    }

    /// Eq. (1): the gap after the solve is too small against the one before to judge by. **A tie keeps the mode**, but not of a gap of 0 that stays 0:
    /// blocks that touch without a force would hold one another by any shear (docs/decisions.md).
    fn keeps_mode<R: Real>(gap: R, gap_before: R, equal: R) -> bool {
        gap_before.abs() > R::ZERO && gap.abs() <= equal * gap_before.abs()
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

    /// A closed contact is locked: the force of its spring is at most τ. Both squared. **A tie locks.**
    fn locks<R: Real>(force_squared: R, strength_squared: R) -> bool {
        force_squared <= strength_squared
    }

    /// Whether the spring of a closed contact holds, with its mode in this solve, which plays no part.
    fn holds<R: Real>(_before: Mode, slip: &TangentialState<R>) -> bool {
        let spring = slip.shear * slip.shear * slip.stretch_squared;
        Self::locks(spring, slip.strength * slip.strength)
    }

    /// The slip of a contact that slid in this solve turned: `s·f`, in N·m, is below 0. **A tie has not turned.**
    fn slip_turned<R: Real>(along: R) -> bool {
        along < R::ZERO
    }

    /// The stiffness k across the last slip in N/m: the lesser of |f|/|s₁| and p_s.
    fn spring_across<R: Real>(secant: R, shear: R) -> R {
        secant.smaller(shear)
    }

    /// Friction of a block has settled: 100·Σ|Δf| is at most Σ p_n·max(0, −h). Both in N. **A tie has settled.**
    fn settled<R: Real>(misfit: R, pressing: R) -> bool {
        R::from_f64(100.0) * misfit <= pressing
    }

    /// Which changes of mode keep a solve from ending the iteration by itself: those that open or close. Locked or sliding counts by
    /// force alone.
    fn opens_or_closes(before: Mode, after: Mode) -> bool {
        before.is_closed() != after.is_closed()
    }

    /// Which changes of mode make a solve one in which a mode changes: all of them.
    fn counts_as_change(before: Mode, after: Mode) -> bool {
        before != after
    }

    /// Of the solves that do not end the iteration by themselves, the so many-th in which a mode changes ends the attempt if a contact opens or
    /// closes in it; so does any later one.
    fn changing_solves() -> u32 {
        Control::ITERATIONS
    }

    /// The so many-th of these ends the attempt also where contacts only lock or slide in it (docs/decisions.md).
    fn slipping_solves() -> u32 {
        12
    }

    /// The so many-th solve in which no mode changes, and which does not end the iteration by itself, ends it, converged.
    fn unchanging_solves() -> u32 {
        7
    }

    /// The Δt with which a step begins: the lesser of the full Δt and 3/2 of the last one accepted.
    fn first_time_step<R: Real>(full: R, last: R) -> R {
        full.smaller(last * R::from_f64(1.5))
    }

    /// Which contacts of the step before the classification keeps, by the mode with which they go on: those that are closed.
    fn leaves_kept(mode: Mode) -> bool {
        mode.is_closed()
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

    /// By how much of the mass matrix damping stiffens the system of an attempt (1/s²): c/Δt, with the Δt of the attempt, not the full one.
    fn drag<R: Real>(damping: R, time_step: R, _full: R) -> R {
        damping / time_step
    }

    /// The rate after a step: k_d·((2/Δt)·d − v).
    fn rate<R: Real>(dynamic: R, twice_mean: R, before: R) -> R {
        dynamic * (twice_mean - before)
    }

    /// Begins a scene by these rules: [`Dynamics::with_rules`]. [`SpecRules`] takes the code compiled in this crate.
    #[doc(hidden)]
    fn begin_dynamics<R: Solve>(scene: &Scene, set: &ToleranceSet) -> Result<Dynamics<R, Self>, SetupError>
    where
        Self: Sized,
    {
        Dynamics::begin(scene, set)
    }

    /// Goes on from another state by these rules: [`Dynamics::restore`].
    #[doc(hidden)]
    fn restore_dynamics<R: Solve>(dynamics: &mut Dynamics<R, Self>, state: State<R>) -> Result<(), SetupError>
    where
        Self: Sized,
    {
        dynamics.continue_from(state)
    }

    /// Makes a step by these rules: [`Dynamics::step`], or [`Dynamics::step_prescribed`].
    #[doc(hidden)]
    fn step_dynamics<R: Solve>(
        dynamics: &mut Dynamics<R, Self>,
        prescribed: Option<&PrescribedStep<'_>>,
    ) -> Result<StepReport, StepError>
    where
        Self: Sized,
    {
        dynamics.make_step(prescribed)
    }

    /// Makes the decisions of a step by these rules: [`Dynamics::decide_prescribed`].
    #[doc(hidden)]
    fn decide_step<R: Solve>(
        dynamics: &mut Dynamics<R, Self>,
        contacts: &[([u32; 2], Contact)],
    ) -> Result<DecidedStep, StepError>
    where
        Self: Sized,
    {
        dynamics.make_decisions(contacts)
    }
}

impl StepRules for SpecRules {
    fn begin_dynamics<R: Solve>(scene: &Scene, set: &ToleranceSet) -> Result<Dynamics<R, SpecRules>, SetupError> {
        <R as CompiledSteps>::begin(scene, set)
    }

    fn restore_dynamics<R: Solve>(dynamics: &mut Dynamics<R, SpecRules>, state: State<R>) -> Result<(), SetupError> {
        <R as CompiledSteps>::restore(dynamics, state)
    }

    fn step_dynamics<R: Solve>(
        dynamics: &mut Dynamics<R, SpecRules>,
        prescribed: Option<&PrescribedStep<'_>>,
    ) -> Result<StepReport, StepError> {
        <R as CompiledSteps>::step(dynamics, prescribed)
    }

    fn decide_step<R: Solve>(
        dynamics: &mut Dynamics<R, SpecRules>,
        contacts: &[([u32; 2], Contact)],
    ) -> Result<DecidedStep, StepError> {
        <R as CompiledSteps>::decide(dynamics, contacts)
    }
}
