//! The force of a contact in a solve, and solves in which no contact bears one.

use super::{ClosedContact, System};
use crate::field::{Field, Halve};
use crate::solve::fraction_free_solve_by_parts;
use crate::step::attempt_values::AttemptValues;
use crate::step::contact::ContactGeometry;
use num_rational::BigRational;
use rockproof_model::Vec3;

/// The force of the normal spring on B, and the stretch, of a closed contact whose point of A moves so against B's.
pub(super) fn pressed<S: Halve>(contact: &ContactGeometry<S>, normal: &S, moved: &Vec3<S>) -> (Vec3<S>, Vec3<S>) {
    let along = contact.normal.dot(moved);
    let push = normal.times(&contact.over_square).times(&contact.gap.plus(&along));
    let stretch = contact.stretch.plus(&contact.across(moved, &along));
    (contact.normal.scaled(&push), stretch)
}

impl<S: Field> System<'_, '_, S> {
    /// The force of a closed contact on B at displacements of its blocks.
    pub(super) fn force_on_b(&self, closed: &ClosedContact<'_, S>, d: [&[S]; 2]) -> Vec3<S> {
        let joint = &self.values.joints[closed.place];
        let moved = closed.geometry.moved(d);
        let (pressed, stretch) = pressed(closed.geometry, &joint.normal, &moved);
        let tangential = match closed.slip {
            Some(slip) => slip.at(&stretch),
            None => stretch.scaled(&joint.shear),
        };
        pressed.plus(&tangential)
    }
}

impl System<'_, '_, BigRational> {
    /// The solution where no contact bears a force: each block as it moves by itself. `None` where one does, or where the system is not
    /// known to be definite, so that it may have other solutions or none.
    ///
    /// Blocks that fall together, touching, are most of what fractions are asked for. They need no matrix of all of them, however many they are.
    pub(crate) fn free_motion(&self) -> Option<Vec<BigRational>> {
        if !self.values.is_definite {
            return None;
        }
        let moved = |block: usize| match self.places[block] {
            // Fixed: no unknowns.
            None => Some(&[][..]),
            Some(_) => self.values.alone(block),
        };
        for closed in &self.closed {
            let [i, j] = self.values.attempt.started[closed.place].blocks;
            let force = self.force_on_b(closed, [moved(i)?, moved(j)?]);
            if !force.components().into_iter().all(Field::is_zero) {
                return None;
            }
        }
        let blocks = self.values.attempt.moving().filter(|(block, _)| self.places[*block].is_some());
        Some(blocks.map(|(block, _)| moved(block)).collect::<Option<Vec<_>>>()?.concat())
    }
}

impl AttemptValues<'_, BigRational> {
    /// The displacements of a moving block that no contact presses, of an attempt whose systems are definite. They are those of every solve.
    fn alone(&self, block: usize) -> Option<&[BigRational]> {
        let solved = || {
            let base = self.base(block)?;
            fraction_free_solve_by_parts(&base.matrix, &base.right)
        };
        self.alone[block].get_or_init(solved).as_deref()
    }
}
