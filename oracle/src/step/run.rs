//! A whole step, and the state after it (SPEC 5.9 to 5.12).

use super::answer::{CertifiedStep, EnclosedStep, GapChange, StepAnswer, StepFailure, StepModel};
use super::attempt::Attempt;
use super::attempt_values::AttemptValues;
use super::cascade::Cascade;
use super::open_close_iteration::{attempts, first_time_step};
use super::prepare::PreparedStep;
use super::state::{BlockState, KeptPrecision, Mode, State};
use super::system::StepNumber;
use super::update::{gap_changes, updated};
use crate::solve::SpdSystem;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::simulation::Body;
use rockproof_model::{Contact, Number};

/// Decides one step from `state`, exactly: all that [`exact_step`] does but for the state after it.
///
/// # Errors
/// When the step cannot be made: see [`StepFailure`].
pub fn certified_step(model: &StepModel<'_>, state: &State) -> Result<CertifiedStep, StepFailure> {
    certified_and(PreparedStep::new(model, state)?, |_| ()).map(|(decided, ())| decided)
}

/// The same where the contacts are known: those that [`crate::Pair::classify_with_kept`] finds of the pairs of [`super::neighbours`], by pair and in
/// SPEC order, with the contacts kept that [`State::kept_contacts`] says.
///
/// # Errors
/// When the step cannot be made: see [`StepFailure`].
pub fn certified_step_with(
    model: &StepModel<'_>,
    state: &State,
    contacts: Vec<([usize; 2], Contact)>,
) -> Result<CertifiedStep, StepFailure> {
    certified_and(PreparedStep::with_contacts(model, state, Some(contacts))?, |_| ()).map(|(decided, ())| decided)
}

/// The same, and encloses how the step moves the blocks: balls of two f64 are asked where those of f64 know it badly.
///
/// # Errors
/// When the step cannot be made: see [`StepFailure`].
pub fn enclosed_step(model: &StepModel<'_>, state: &State) -> Result<EnclosedStep, StepFailure> {
    let enclosed = |cascade: &mut Cascade<'_>| {
        let float = cascade.float().and_then(displacements).filter(|d| are_narrow(d));
        float.or_else(|| cascade.double().and_then(displacements))
    };
    certified_and(PreparedStep::new(model, state)?, enclosed)
        .map(|(decided, displacements)| EnclosedStep { decided, displacements })
}

/// Decides one step, and asks something of its last solve.
fn certified_and<T>(
    prepared: PreparedStep<'_>,
    ask: impl FnOnce(&mut Cascade<'_>) -> T,
) -> Result<(CertifiedStep, T), StepFailure> {
    let (mut certified, asked) = attempts(&prepared, |mut cascade, attempt, iterated, retries| {
        let asked = ask(&mut cascade);
        let certified = CertifiedStep {
            contacts: Vec::new(),
            iterations: cascade.modes().len() as u32,
            end: iterated.end,
            converged: iterated.end.is_converged(),
            modes: modes(&cascade, iterated.after),
            retries,
            time_step: attempt.time_step.clone(),
            levels: cascade.levels,
            contact_levels: prepared.contact_levels,
        };
        Ok((certified, asked))
    })?;
    certified.contacts = prepared.contacts;
    Ok((certified, asked))
}

/// The unknowns of each block after the last solve, each as an f64 and at least its distance from the exact value.
fn displacements<S: StepNumber>(values: &AttemptValues<'_, S>) -> Option<Vec<Vec<[f64; 2]>>> {
    let last = values.solves.last()?;
    let pairs = |block| {
        let d = values.displacement(last, block)?;
        Some(d.iter().map(|value| value.nearby().into()).collect())
    };
    (0..values.attempt.blocks.len()).map(pairs).collect()
}

/// Displacements known to no more than this share of the largest are asked of balls of two f64.
const WIDEST_DISPLACEMENT: f64 = 1e-9;

fn are_narrow(displacements: &[Vec<[f64; 2]>]) -> bool {
    let most = |part: usize| displacements.iter().flatten().map(|pair| pair[part].abs()).fold(0.0, f64::max);
    most(1) <= WIDEST_DISPLACEMENT * most(0)
}

/// The system of the first solve of a step, exactly; `None` where the step cannot be made.
pub fn first_system(model: &StepModel<'_>, state: &State) -> Option<SpdSystem> {
    let prepared = PreparedStep::new(model, state).ok()?;
    let attempt = prepared.attempt(first_time_step(&prepared));
    let values: AttemptValues<'_, BigRational> = AttemptValues::new(&attempt, 0);
    Some(SpdSystem::of_blocks(values.assembled(&attempt.first_modes())?))
}

/// Makes one step from `state`, exactly.
///
/// # Errors
/// When the step cannot be made or its state not be kept as asked: see [`StepFailure`].
pub fn exact_step(model: &StepModel<'_>, state: &State, keep: KeptPrecision) -> Result<StepAnswer, StepFailure> {
    made(PreparedStep::new(model, state)?, keep)
}

/// The same where the contacts are known, as for [`certified_step_with`].
///
/// # Errors
/// When the step cannot be made or its state not be kept as asked: see [`StepFailure`].
pub fn exact_step_with(
    model: &StepModel<'_>,
    state: &State,
    keep: KeptPrecision,
    contacts: Vec<([usize; 2], Contact)>,
) -> Result<StepAnswer, StepFailure> {
    made(PreparedStep::with_contacts(model, state, Some(contacts))?, keep)
}

fn made(prepared: PreparedStep<'_>, keep: KeptPrecision) -> Result<StepAnswer, StepFailure> {
    let mut answer = attempts(&prepared, |mut cascade, attempt, iterated, retries| {
        let (state, gaps) = kept(&mut cascade, attempt, &iterated.after, keep).ok_or(StepFailure::NotKept { keep })?;
        Ok(StepAnswer {
            contacts: Vec::new(),
            iterations: cascade.modes().len() as u32,
            end: iterated.end,
            converged: iterated.end.is_converged(),
            modes: modes(&cascade, iterated.after),
            retries,
            time_step: attempt.time_step.clone(),
            gaps,
            state,
            levels: cascade.levels,
            contact_levels: prepared.contact_levels,
        })
    })?;
    answer.contacts = prepared.contacts;
    Ok(answer)
}

/// The modes of each solve, and those after the last.
fn modes(cascade: &Cascade<'_>, after: Vec<Mode>) -> Vec<Vec<Mode>> {
    let mut modes = cascade.modes().to_vec();
    modes.push(after);
    modes
}

/// Grids up to this exponent may be reached by balls of two f64.
const DOUBLE_GRID: u32 = 96;

/// The state after the last solve, and the gaps. The modes that followed from it are those that are remembered.
fn kept(
    cascade: &mut Cascade<'_>,
    attempt: &Attempt<'_>,
    after: &[Mode],
    keep: KeptPrecision,
) -> Option<(State, Vec<GapChange>)> {
    let KeptPrecision::Grid { exponent } = keep else {
        return cascade.exact_of_all().and_then(|values| kept_by(attempt, values, after, keep));
    };
    if exponent <= DOUBLE_GRID
        && let Some(kept) = cascade.double().and_then(|values| kept_by(attempt, values, after, keep))
    {
        return Some(kept);
    }
    let enough = [128, 256, 512, 1024, 2048, 4096].into_iter().filter(|&bits| bits > exponent);
    enough.into_iter().find_map(|bits| kept_by(attempt, &*cascade.with_bits(bits)?, after, keep))
}

fn kept_by<S: StepNumber>(
    attempt: &Attempt<'_>,
    values: &AttemptValues<'_, S>,
    after: &[Mode],
    keep: KeptPrecision,
) -> Option<(State, Vec<GapChange>)> {
    Some((updated(attempt, values, after, keep)?, gap_changes(values, keep)?))
}

/// The velocity that the scene gives a block.
pub(crate) fn initial_rates(body: &Body) -> [Number; 12] {
    let mut velocity = std::array::from_fn(|_| Number::ZERO);
    if !body.is_fixed() {
        let rates = [&body.velocity, &body.spin].into_iter().flat_map(|v| v.components());
        velocity.iter_mut().zip(rates).for_each(|(place, rate)| *place = rate.clone());
    }
    velocity
}

impl State {
    /// The state a scene begins with. Velocities are those of the bodies; they count from the first step that is not settling.
    pub fn initial(model: &StepModel<'_>) -> State {
        let blocks = model.shapes.iter().zip(model.bodies).map(|(shape, b)| {
            let settled = model.simulation.control.settle == 0;
            let velocity = if settled { initial_rates(b) } else { std::array::from_fn(|_| Number::ZERO) };
            BlockState { vertices: shape.vertices().to_vec(), velocity, stress: b.stress.clone() }
        });
        State {
            time: Number::from_rational(BigRational::zero()),
            settling: model.simulation.control.settle,
            last_time_step: model.simulation.control.time_step.clone(),
            blocks: blocks.collect(),
            load_points: model.simulation.loads.iter().map(|load| load.at.clone()).collect(),
            fixed_points: model.simulation.fixed_points.iter().map(|fixed| fixed.at.clone()).collect(),
            contacts: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::are_narrow;

    #[test]
    fn displacements_are_narrow_by_the_largest_of_them() {
        assert!(are_narrow(&[vec![[1.0, 1e-9]]]));
        assert!(!are_narrow(&[vec![[1.0, 1e-8]]]));
        assert!(!are_narrow(&[vec![[1e-6, 1e-9]]]));
        // The largest may be another one, of another block, and negative; so may the widest.
        assert!(are_narrow(&[vec![[1e-6, 1e-9]], vec![[0.0, 0.0], [-1.0, 0.0]]]));
        assert!(!are_narrow(&[vec![[-1.0, 0.0]], vec![[0.0, 2e-9]]]));
        assert!(!are_narrow(&[vec![[0.0, f64::MIN_POSITIVE]]]));
        assert!(are_narrow(&[vec![[0.0, 0.0]]]));
    }
}
