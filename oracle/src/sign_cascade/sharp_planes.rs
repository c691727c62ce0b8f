//! Gaps compared by planes of which balls of f64 have nearly all digits.
//!
//! Where features nearly touch, f64 has few digits of P: it is a small difference of large products. In balls of two f64 it has more than a ball of f64
//! holds, so rounded to such it tells gaps apart that differ by a few roundoffs. One plane stands in many comparisons, and is worked out once.

use super::SignCascade;
use crate::number::Ball;
use crate::predicate::{Polynomial, sharp_plane};
use crate::view::{ExactView, LazyScales, Scales};
use rockproof_model::{Entrance, Sign};
use std::cell::OnceCell;

/// So many planes of a pair are remembered: each is looked for among all.
const MOST_REMEMBERED: usize = 64;

impl SignCascade<'_, '_> {
    /// The sign of a polynomial that compares planes, where these tell it.
    pub(crate) fn sign_by_sharp_planes<P: Polynomial>(&self, polynomial: &P, scales: &Scales<Ball>) -> Option<Sign> {
        polynomial.value_of_planes(|entrance| self.sharp_plane(entrance), scales)?.certain_sign()
    }

    fn sharp_plane(&self, entrance: &Entrance) -> (Ball, Ball) {
        let known = |(other, plane): &(Entrance, (Ball, Ball))| (other == entrance).then_some(*plane);
        if let Some(plane) = self.pair.planes.borrow().iter().rev().find_map(known) {
            return plane;
        }
        // Planes are made of vertices alone.
        let scales = LazyScales { made: &OnceCell::new(), make: &Scales::none };
        let plane = sharp_plane(&ExactView { geometry: self.pair.double(), scales }, entrance);
        let mut planes = self.pair.planes.borrow_mut();
        if planes.len() < MOST_REMEMBERED {
            planes.push((*entrance, plane));
        }
        plane
    }
}
