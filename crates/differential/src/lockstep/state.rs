//! A stepper's state as the oracle's, and back. Only numbers and names pass: no arithmetic is shared.

use rockproof_model::{Number, Point, Precision, Vec3};
use rockproof_oracle::step as exact;
use rockproof_stepper::dynamics::{BlockState, ContactState, Mode, State};
use rockproof_stepper::{Real, Vector};

/// A state with a number that is infinite or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the state holds a number that is not finite")]
pub struct NotFinite;

/// The oracle's name of a mode.
pub fn exact_mode(mode: Mode) -> exact::Mode {
    match mode {
        Mode::Open => exact::Mode::Open,
        Mode::Sliding => exact::Mode::Sliding,
        Mode::Locked => exact::Mode::Locked,
    }
}

/// The stepper's name of a mode.
pub fn float_mode(mode: exact::Mode) -> Mode {
    match mode {
        exact::Mode::Open => Mode::Open,
        exact::Mode::Sliding => Mode::Sliding,
        exact::Mode::Locked => Mode::Locked,
    }
}

fn number<R: Real>(value: R) -> Result<Number, NotFinite> {
    value.to_number().ok_or(NotFinite)
}

fn point<R: Real>(v: Vector<R>) -> Result<Point, NotFinite> {
    Ok(Vec3::new(number(v.x)?, number(v.y)?, number(v.z)?))
}

fn points<R: Real>(all: &[Vector<R>]) -> Result<Vec<Point>, NotFinite> {
    all.iter().map(|v| point(*v)).collect()
}

fn numbers<R: Real, const N: usize>(values: &[R; N]) -> Result<[Number; N], NotFinite> {
    let mut all = std::array::from_fn(|_| Number::ZERO);
    for (place, value) in all.iter_mut().zip(values) {
        *place = number(*value)?;
    }
    Ok(all)
}

/// The oracle's state of a stepper's: every number as the exact one it is, of `Wide` the middle.
///
/// # Errors
/// When a number is not finite.
pub fn exact_state<R: Real>(state: &State<R>) -> Result<exact::State, NotFinite> {
    let block = |block: &BlockState<R>| {
        let (velocity, stress) = (numbers(&block.velocity)?, numbers(&block.stress)?);
        Ok(exact::BlockState { vertices: points(&block.vertices)?, velocity, stress })
    };
    let contact = |c: &ContactState<R>| {
        let anchors = [point(c.anchors[0])?, point(c.anchors[1])?];
        let blocks = c.blocks.map(|block| block as usize);
        Ok(exact::ContactMemory { blocks, contact: c.contact, mode: exact_mode(c.mode), anchors })
    };
    Ok(exact::State {
        time: number(state.time)?,
        settling: state.settling,
        last_time_step: number(state.last_time_step)?,
        blocks: state.blocks.iter().map(block).collect::<Result<_, NotFinite>>()?,
        load_points: points(&state.load_points)?,
        fixed_points: points(&state.fixed_points)?,
        contacts: state.contacts.iter().map(contact).collect::<Result<_, NotFinite>>()?,
    })
}

/// [`exact_state`] of the stepper in f64, compiled here: a caller with less optimisation of its own would compile it several times as slow.
///
/// # Errors
/// When a number is not finite.
pub fn exact_state_of_f64(state: &State<f64>) -> Result<exact::State, NotFinite> {
    exact_state(state)
}

/// The state whose numbers are those of `state` rounded to nearest; times stay as they are. `None` where a number is beyond the precision.
pub fn rounded_state(state: &exact::State, precision: Precision) -> Option<exact::State> {
    let number = |value: &Number| Number::from_f64(value.rounded(precision)?).ok();
    let point = |p: &Point| Some(Vec3::new(number(&p.x)?, number(&p.y)?, number(&p.z)?));
    let points = |all: &[Point]| all.iter().map(point).collect::<Option<Vec<_>>>();
    let mut rounded = state.clone();
    for block in &mut rounded.blocks {
        block.vertices = points(&block.vertices)?;
        for value in block.velocity.iter_mut().chain(&mut block.stress) {
            *value = number(value)?;
        }
    }
    rounded.load_points = points(&rounded.load_points)?;
    rounded.fixed_points = points(&rounded.fixed_points)?;
    for anchor in rounded.contacts.iter_mut().flat_map(|contact| &mut contact.anchors) {
        *anchor = point(anchor)?;
    }
    Some(rounded)
}
