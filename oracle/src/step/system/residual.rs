//! The residual of a solve, contact by contact: the force that each would bear is calculated from its gap and stretch. Neither loses digits to large
//! stiffnesses, as a product with the assembled matrix would.

use super::free_motion::pressed;
use super::{ClosedContact, StepNumber, System};
use crate::field::{Field, LANES, Packed, packed_vector};
use crate::solve::Residual;
use crate::step::contact::ContactGeometry;
use crate::step::frame;
use crate::step::friction::SlipForce;
use rockproof_model::Vec3;
use std::ops::Range;

impl<S: StepNumber> Residual<S> for System<'_, '_, S> {
    fn right(&self) -> Vec<S> {
        S::residual(self, None)
    }

    fn residual(&self, x: &[S]) -> Vec<S> {
        S::residual(self, Some(x))
    }
}

impl<S: Field> System<'_, '_, S> {
    /// The unknowns of each block of the system.
    fn ranges(&self) -> Vec<Range<usize>> {
        let mut end = 0;
        let range = |size| {
            let start = end;
            end += size;
            start..end
        };
        self.sizes().into_iter().map(range).collect()
    }

    /// `F − K·x`, or F, one number at a time.
    pub(crate) fn residual_singly(&self, x: Option<&[S]>) -> Vec<S> {
        let ranges = self.ranges();
        let mut residual = Vec::new();
        for (base, range) in self.base.iter().zip(&ranges) {
            let Some(x) = x else {
                residual.extend(base.right.iter().cloned());
                continue;
            };
            for (row, right) in base.matrix.iter().zip(&base.right) {
                let terms = row.iter().zip(&x[range.clone()]).filter(|(entry, x)| !entry.is_zero() && !x.is_zero());
                residual.push(terms.fold(right.clone(), |sum, (entry, x)| sum.minus(&entry.times(x))));
            }
        }
        for contact in &self.closed {
            let own = self.values.attempt.started[contact.place]
                .blocks
                .map(|block| self.places[block].map(|place| &ranges[place]));
            let of = |side: usize| own[side].and_then(|range| Some(&x?[range.clone()])).unwrap_or(&[]);
            let force = self.force_on_b(contact, [of(0), of(1)]);
            let forces = [force.negated(), force];
            for (side, force) in forces.iter().enumerate() {
                if let Some(range) = own[side] {
                    frame::add_pull(&mut residual[range.clone()], &contact.geometry.points[side], force);
                }
            }
        }
        residual
    }

    /// The same, with four rows and four contacts at a time. Middles are the same to the last bit.
    pub(crate) fn residual_packed<P: Packed<Single = S>>(&self, x: Option<&[S]>) -> Vec<S> {
        let ranges = self.ranges();
        let mut residual: Vec<S> = Vec::with_capacity(ranges.last().map_or(0, |range| range.end));
        for (base, range) in self.base.iter().zip(&ranges) {
            let Some(x) = x else {
                residual.extend(base.right.iter().cloned());
                continue;
            };
            for top in (0..base.right.len()).step_by(LANES) {
                let rows: [usize; LANES] = std::array::from_fn(|lane| (top + lane).min(base.right.len() - 1));
                let mut sum = P::of(rows.map(|row| &base.right[row]));
                for (column, x) in x[range.clone()].iter().enumerate() {
                    let entries = rows.map(|row| &base.matrix[row][column]);
                    if !entries.iter().all(|entry| entry.is_zero()) {
                        sum = sum.minus(&P::of(entries).times(&P::of([x; LANES])));
                    }
                }
                residual.extend((0..LANES.min(base.right.len() - top)).map(|lane| sum.single(lane)));
            }
        }
        for chunk in self.closed.chunks(LANES) {
            // The last chunk is filled up with its last contact, whose copies are not counted.
            let lanes: [&ClosedContact<'_, S>; LANES] = std::array::from_fn(|lane| &chunk[lane.min(chunk.len() - 1)]);
            let own = lanes.map(|contact| {
                let blocks = self.values.attempt.started[contact.place].blocks;
                blocks.map(|block| self.places[block].map(|place| &ranges[place]))
            });
            let contact = ContactGeometry::<P>::packed(lanes.map(|contact| contact.geometry));
            let unknowns =
                own.map(|ranges| ranges.map(|range| range.and_then(|range| Some(&x?[range.clone()])).unwrap_or(&[])));
            let moved = contact.packed_moved(unknowns);
            let force = self.packed_force(lanes, &contact, &moved);
            let forces = [force.negated(), force];
            let pulls = [0, 1].map(|side: usize| {
                let (point, force) = (contact.points[side].components(), forces[side].components());
                std::array::from_fn::<P, { frame::UNKNOWNS }, _>(|k| frame::pulled(point, force, k))
            });
            for (lane, sides) in own.iter().enumerate().take(chunk.len()) {
                for (pull, range) in pulls.iter().zip(sides) {
                    let Some(range) = range else { continue };
                    for (place, pull) in residual[(*range).clone()].iter_mut().zip(pull) {
                        *place = place.plus(&pull.single(lane));
                    }
                }
            }
        }
        residual
    }

    /// The forces of four closed contacts on B.
    fn packed_force<P: Packed<Single = S>>(
        &self,
        lanes: [&ClosedContact<'_, S>; LANES],
        contact: &ContactGeometry<P>,
        moved: &Vec3<P>,
    ) -> Vec3<P> {
        let joints = lanes.map(|closed| &self.values.joints[closed.place]);
        let (pressed, stretch) = pressed(contact, &P::of(joints.map(|joint| &joint.normal)), moved);
        let slips = lanes.map(|closed| closed.slip);
        let held = stretch.scaled(&P::of(joints.map(|joint| &joint.shear)));
        if slips.iter().all(Option::is_none) {
            return pressed.plus(&held);
        }
        let (zero, none) = (S::from_i32(0), Vec3::zero());
        let slip = SlipForce {
            last: packed_vector(slips.map(|slip| slip.map_or(&none, |slip| &slip.last))),
            secant: P::of(slips.map(|slip| slip.map_or(&zero, |slip| &slip.secant))),
            across: packed_vector(slips.map(|slip| slip.map_or(&none, |slip| &slip.across))),
            spring: P::of(slips.map(|slip| slip.map_or(&zero, |slip| &slip.spring))),
        };
        let slid = slip.with_spring(&stretch);
        let chosen = |slid: &P, held: &P| {
            let of: [S; LANES] =
                std::array::from_fn(|lane| if slips[lane].is_some() { slid.single(lane) } else { held.single(lane) });
            P::of(of.each_ref())
        };
        let tangential = Vec3::new(chosen(&slid.x, &held.x), chosen(&slid.y, &held.y), chosen(&slid.z, &held.z));
        pressed.plus(&tangential)
    }
}
