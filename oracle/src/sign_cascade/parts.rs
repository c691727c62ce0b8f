//! A sharper bound on what a value in f64 is off by, from the sizes that its parts have.
//!
//! A bound known beforehand takes every part to be as large as the pair allows. Where a value is a difference of products of parts that are small, as squares
//! of gaps and of dips are, that bound is far too large. The parts themselves, with the bounds known beforehand of each, give one that follows their sizes:
//! a tenth of the work of balls, which follow every operation.

use super::{SignCascade, sign_beyond};
use crate::number::Bound;
use crate::predicate::Polynomial;
use crate::view::Scales;
use rockproof_model::Sign;

/// The parts of a value of one pair, under bounds known beforehand.
pub(crate) struct Parts<'c, 'p, 's>(&'c SignCascade<'p, 's>);

impl<'c, 'p, 's> Parts<'c, 'p, 's> {
    pub(crate) fn new(cascade: &'c SignCascade<'p, 's>) -> Self {
        Parts(cascade)
    }

    /// What a part is, exactly and in f64.
    #[inline]
    pub(crate) fn of<P: Polynomial>(&self, part: &P) -> Bound {
        let cascade = self.0;
        Bound::around(part.value(&cascade.float_view()).0, cascade.known_bound(part))
    }

    /// What the tolerances are.
    #[inline(always)]
    pub(crate) fn scales(&self) -> Scales<Bound> {
        Scales::<Bound>::around(&self.0.floats)
    }
}

impl SignCascade<'_, '_> {
    /// The sign of a polynomial that has this value in f64, where the sizes of its parts tell.
    #[inline(always)]
    pub(crate) fn sign_by_parts<P: Polynomial>(&self, polynomial: &P, value: f64) -> Option<Sign> {
        sign_beyond(value, polynomial.error_by_parts(&Parts::new(self))?)
    }
}
