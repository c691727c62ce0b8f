//! How far numbers are off after a step: displacements, velocities, anchors. Both states are exact numbers; only the quotients are
//! rounded.

use rockproof_model::{Number, Point};
use rockproof_oracle::step::{Mode, State};

/// The distance of two numbers.
fn distance(a: &Number, b: &Number) -> f64 {
    a.plus(&b.negated()).approximate().abs()
}

/// The largest distance of two points of the same place in two lists (m).
pub fn largest_distance<'p>(pairs: impl IntoIterator<Item = (&'p Point, &'p Point)>) -> f64 {
    let distance = |(a, b): (&Point, &Point)| {
        let sides = a.components().into_iter().zip(b.components());
        sides.map(|(a, b)| distance(a, b)).fold(0.0, f64::hypot)
    };
    pairs.into_iter().map(distance).fold(0.0, f64::max)
}

/// The worst of all blocks, with its number; of equal ones the first.
fn worst(errors: impl Iterator<Item = (f64, usize)>) -> Option<(f64, usize)> {
    errors.reduce(|worst, next| if next.0 > worst.0 { next } else { worst })
}

/// The largest distance of a vertex from where it should be over the largest displacement of a vertex of its block, and that
/// block: the worst of all blocks that move.
pub fn displacement_error(before: &State, found: &State, right: &State) -> Option<(f64, usize)> {
    let blocks = before.blocks.iter().zip(&found.blocks).zip(&right.blocks).enumerate();
    worst(blocks.filter_map(|(block, ((before, found), right))| {
        let moved = largest_distance(right.vertices.iter().zip(&before.vertices));
        (moved > 0.0).then(|| (largest_distance(found.vertices.iter().zip(&right.vertices)) / moved, block))
    }))
}

/// The largest error of one of a block's twelve rates over the largest of them (m/s, rad/s and 1/s taken alike): the worst of all
/// blocks that have a velocity.
pub fn velocity_error(found: &State, right: &State) -> Option<f64> {
    let blocks = found.blocks.iter().zip(&right.blocks).enumerate();
    let errors = blocks.filter_map(|(block, (found, right))| {
        let most = right.velocity.iter().map(|v| v.approximate().abs()).fold(0.0, f64::max);
        let off = found.velocity.iter().zip(&right.velocity).map(|(a, b)| distance(a, b)).fold(0.0, f64::max);
        (most > 0.0).then_some((off / most, block))
    });
    worst(errors).map(|(error, _)| error)
}

/// The largest error of one of a block's twelve rates over the largest of them before and after the step, or over `floor` where they
/// are smaller: the worst of all blocks. What comes to rest, or nearly, does not make it large.
pub fn rate_error(before: &State, found: &State, right: &State, floor: f64) -> f64 {
    let blocks = before.blocks.iter().zip(&found.blocks).zip(&right.blocks);
    let errors = blocks.map(|((before, found), right)| {
        let rates = before.velocity.iter().chain(&right.velocity).map(|v| v.approximate().abs());
        let off = found.velocity.iter().zip(&right.velocity).map(|(a, b)| distance(a, b)).fold(0.0, f64::max);
        off / rates.fold(floor, f64::max)
    });
    errors.filter(|error| error.is_finite()).fold(0.0, f64::max)
}

/// The largest distance of an anchor from where it should be (m), over contacts that both states have and have closed.
pub fn anchor_error(found: &State, right: &State) -> Option<f64> {
    let mut most: Option<f64> = None;
    for own in right.contacts.iter().filter(|contact| contact.mode != Mode::Open) {
        let same =
            |c: &&rockproof_oracle::step::ContactMemory| c.blocks == own.blocks && c.contact.key == own.contact.key;
        if let Some(other) = found.contacts.iter().find(same).filter(|other| other.mode != Mode::Open) {
            let distance = largest_distance(own.anchors.iter().zip(&other.anchors));
            most = Some(most.map_or(distance, |most| most.max(distance)));
        }
    }
    most
}
