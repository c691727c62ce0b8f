//! The stiffness of a solve in balls of two f64: what a small correction of a solution in more bits does to its residual.

use super::{ClosedContact, System};
use crate::field::{DoubleBall, PackedDoubleBalls, WideBall};
use crate::solve::Residual;
use crate::step::attempt_values::{AttemptValues, Base};
use crate::step::contact::ContactGeometry;
use crate::step::friction::SlipForce;
use crate::step::state::Mode;
use rockproof_model::{Ring, Vec3};
use std::cell::OnceCell;

/// A system in long balls, and its stiffness in shorter ones once it is asked for.
pub(crate) struct Corrected<'s, 'c, 'a> {
    system: &'s System<'c, 'a, WideBall>,
    stiffness: OnceCell<RoundedStiffness<'a>>,
}

impl<'s, 'c, 'a> Corrected<'s, 'c, 'a> {
    pub(crate) fn new(system: &'s System<'c, 'a, WideBall>) -> Corrected<'s, 'c, 'a> {
        Corrected { system, stiffness: OnceCell::new() }
    }
}

impl Residual<WideBall> for Corrected<'_, '_, '_> {
    fn right(&self) -> Vec<WideBall> {
        self.system.residual_singly(None)
    }

    fn residual(&self, x: &[WideBall]) -> Vec<WideBall> {
        self.system.residual_singly(Some(x))
    }

    fn after_change(&self, residual: &[WideBall], [x, better]: [&[WideBall]; 2]) -> Option<Vec<WideBall>> {
        let change: Vec<WideBall> = better.iter().zip(x).map(|(after, before)| after.minus(before)).collect();
        // Numbers near 1: the low parts of others might be lost to underflow.
        let top = change.iter().filter_map(|value| value.size().top()).max()?;
        let near_one: Vec<DoubleBall> = change.iter().map(|value| value.in_double(-top)).collect();
        let stiffness = self.stiffness.get_or_init(|| RoundedStiffness::of(self.system));
        let forces = stiffness.forces(&near_one);
        let bits = self.system.values.bits;
        let after =
            |(residual, force): (&WideBall, &DoubleBall)| Some(residual.plus(&WideBall::of_double(force, top, bits)?));
        residual.iter().zip(&forces).map(after).collect()
    }
}

/// K alone: blocks and closed contacts that exert no force where nothing has moved.
struct RoundedStiffness<'a> {
    values: AttemptValues<'a, DoubleBall>,
    /// Of each block of the system what it brings.
    base: Vec<Base<DoubleBall>>,
    places: Vec<Option<usize>>,
    closed: Vec<RoundedContact>,
}

struct RoundedContact {
    place: usize,
    mode: Mode,
    geometry: ContactGeometry<DoubleBall>,
    slip: Option<SlipForce<DoubleBall>>,
}

impl<'a> RoundedStiffness<'a> {
    fn of(system: &System<'_, 'a, WideBall>) -> RoundedStiffness<'a> {
        let vector = |v: &Vec3<WideBall>| v.map(rounded);
        let nothing: Vec3<DoubleBall> = Vec3::zero();
        let base = |base: &&Base<WideBall>| Base {
            matrix: base.matrix.iter().map(|row| row.iter().map(rounded).collect()).collect(),
            right: vec![DoubleBall::from_i32(0); base.right.len()],
        };
        let closed = |closed: &ClosedContact<'_, WideBall>| {
            let ContactGeometry { square, normal, points, over_square, .. } = closed.geometry;
            let geometry = ContactGeometry {
                square: rounded(square),
                normal: vector(normal),
                gap: DoubleBall::from_i32(0),
                points: points.each_ref().map(vector),
                over_square: rounded(over_square),
                stretch: nothing,
            };
            // A force that does not depend on where the contact moves is none of the stiffness.
            let slip = closed.slip.map(|slip| SlipForce {
                across: vector(&slip.across),
                spring: rounded(&slip.spring),
                ..SlipForce::none(&nothing)
            });
            RoundedContact { place: closed.place, mode: closed.mode, geometry, slip }
        };
        RoundedStiffness {
            values: AttemptValues::new(system.values.attempt, DoubleBall::BITS),
            base: system.base.iter().map(base).collect(),
            places: system.places.clone(),
            closed: system.closed.iter().map(closed).collect(),
        }
    }

    /// `−K·x`.
    fn forces(&self, x: &[DoubleBall]) -> Vec<DoubleBall> {
        let closed = self.closed.iter().map(|contact| ClosedContact {
            place: contact.place,
            mode: contact.mode,
            geometry: &contact.geometry,
            slip: contact.slip.as_ref(),
        });
        let system = System {
            values: &self.values,
            base: self.base.iter().collect(),
            places: self.places.clone(),
            closed: closed.collect(),
        };
        system.residual_packed::<PackedDoubleBalls>(Some(x))
    }
}

fn rounded(value: &WideBall) -> DoubleBall {
    value.in_double(0)
}
