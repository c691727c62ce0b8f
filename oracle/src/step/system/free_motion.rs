//! The force of a contact in a solve, and solves in which no contact bears one.

use super::System;
use crate::field::{Field, Halve};
use crate::solve::fraction_free_solve;
use crate::step::attempt_values::empty_cells;
use crate::step::contact::ContactGeometry;
use num_rational::BigRational;
use rockproof_model::Vec3;
use std::cell::OnceCell;

/// The force of the normal spring on B, and the stretch, of a closed contact whose point of A moves so against B's.
pub(super) fn pressed<S: Halve>(contact: &ContactGeometry<S>, normal: &S, moved: &Vec3<S>) -> (Vec3<S>, Vec3<S>) {
    let along = contact.normal.dot(moved);
    let push = normal.times(&contact.over_square).times(&contact.gap.plus(&along));
    let stretch = contact.stretch.plus(&contact.across(moved, &along));
    (contact.normal.scaled(&push), stretch)
}

impl<S: Field> System<'_, '_, S> {
    /// The force of a closed contact on B at displacements of its blocks.
    pub(super) fn force_on_b(&self, k: usize, contact: &ContactGeometry<S>, d: [&[S]; 2]) -> Vec3<S> {
        let joint = &self.values.joints[k];
        let moved = contact.moved(d);
        let (pressed, stretch) = pressed(contact, &joint.normal, &moved);
        let tangential = match &self.friction[k] {
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
    /// Blocks that fall together, touching, are most of what fractions are asked for. They need no matrix of all of them.
    pub(crate) fn free_motion(&self) -> Option<Vec<BigRational>> {
        if !self.values.is_definite {
            return None;
        }
        let alone: Vec<OnceCell<Option<Vec<BigRational>>>> = empty_cells(self.base.len());
        let moved = |block: usize| match self.places[block] {
            // Fixed: no unknowns.
            None => Some(&[][..]),
            Some(place) => {
                let base = self.base[place];
                alone[place].get_or_init(|| fraction_free_solve(&base.matrix, &base.right)).as_deref()
            }
        };
        for &(k, contact) in &self.closed {
            let [i, j] = self.values.attempt.started[k].blocks;
            let force = self.force_on_b(k, contact, [moved(i)?, moved(j)?]);
            if !force.components().into_iter().all(Field::is_zero) {
                return None;
            }
        }
        let blocks = self.values.attempt.moving().filter(|(block, _)| self.places[*block].is_some());
        Some(blocks.map(|(block, _)| moved(block)).collect::<Option<Vec<_>>>()?.concat())
    }
}
