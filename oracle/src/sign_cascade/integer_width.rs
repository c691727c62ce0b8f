//! How few bits tell an integer that is enclosed, and what proves two gaps equal in few bits.
//!
//! A ball that leaves a sign open says how large the value is at most. On the lattice the value is an integer; one of less than 2^k in
//! size is known by its residue modulo 2^(k+1), and that is the polynomial of the residues of coordinates and tolerances. So integers of
//! k + 1 bits that wrap around suffice, where f64 has cancelled most of the bits that intermediate values have.

use super::{ScalesCache, SignCascade};
use crate::field::DoubleBall;
use crate::number::{Ball, Bits};
use crate::pair::Pair;
use crate::predicate::{Denominator, EqualGaps, Polynomial};
use crate::view::{BallView, ExactView, LazyScales};
use num_bigint::BigInt;
use rockproof_model::number::exact_log2;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Sign, ToleranceSet};

impl ScalesCache {
    /// The k such that a polynomial's value on the lattice is at most `2^k` times that in metres.
    ///
    /// A polynomial is homogeneous in length, so this is the number of units per metre to the power of its degree, times the
    /// denominator that its tolerances have on the lattice ([`Polynomial::DENOMINATOR`]).
    pub(crate) fn bits_per_metre<P: Polynomial>(&self, pair: &Pair<'_>, tolerances: &ToleranceSet) -> i64 {
        let scales = || self.exact(pair, tolerances);
        let denominator = match P::DENOMINATOR {
            Denominator::None => 0,
            Denominator::Unit => ceiling_log2(&scales().unit),
            Denominator::UnitSquared => 2 * ceiling_log2(&scales().unit),
            Denominator::OneSquared => 2 * ceiling_log2(&scales().one),
            Denominator::WholeSquared => 2 * ceiling_log2(&scales().whole),
        };
        P::DEGREE as i64 * pair.grid().lattice.metre_bits() + denominator
    }
}

impl SignCascade<'_, '_> {
    /// The bits that a polynomial's value on the lattice has at most, if this ball encloses that in metres; `None` where f64 cannot
    /// tell.
    pub(crate) fn bits_of_ball<P: Polynomial>(&self, ball: Ball) -> Option<Bits> {
        let cache = self.exact_scales();
        bits_within(ball.size(), cache.bits_per_metre::<P>(self.pair, self.tolerances))
    }

    /// The value in balls of two f64.
    pub(crate) fn double_ball<P: Polynomial>(&self, polynomial: &P) -> DoubleBall {
        let (pair, tolerances) = (self.pair, self.tolerances);
        let cache = self.exact_scales();
        let make = || cache.exact(pair, tolerances).double(pair.grid().bits);
        let scales = LazyScales { made: &cache.double, make: &make };
        polynomial.value(&ExactView { geometry: pair.double(), scales })
    }

    /// The bits that a polynomial's value on the lattice has at most, if this is its [`SignCascade::double_ball`].
    pub(crate) fn bits_of_double<P: Polynomial>(&self, ball: &DoubleBall) -> Option<Bits> {
        bits_within(ball.size(), P::DEGREE as i64 * i64::from(self.pair.grid().bits.0))
    }

    /// Whether two gaps are proved to be the same.
    pub(crate) fn are_equal(&self, gaps: &EqualGaps, balls: &BallView<'_>) -> bool {
        let (pair, tolerances) = (self.pair, self.tolerances);
        let (across, along) = gaps.values(balls);
        let may_be_zero = |ball: &Ball| ball.certain_sign().is_none_or(Sign::is_zero);
        let Some(k) = along.iter().position(may_be_zero).filter(|_| across.iter().all(may_be_zero)) else {
            return false;
        };
        let (metre, degree) = (pair.grid().lattice.metre_bits(), EqualGaps::DEGREE as i64);
        let held = |ball: &Ball, degree| bits_within(ball.size(), degree * metre).is_some_and(|bits| bits.0 < 256);
        if !(across.iter().all(|ball| held(ball, degree)) && held(&along[k], degree - 1)) {
            return false;
        }
        let cache = self.exact_scales();
        let scales = LazyScales { made: &cache.int256, make: &|| cache.exact(pair, tolerances).converted() };
        let (across, along) = gaps.values(&ExactView { geometry: pair.int256(), scales });
        across.iter().chain([&along[k]]).all(|value| value.sign().is_zero())
    }
}

/// The bits of an integer whose size is at most `size · 2^shift`, for a size of zero or more; `None` where f64 does not hold it.
pub(crate) fn bits_within(size: f64, shift: i64) -> Option<Bits> {
    // size < 2^exponent
    let exponent = (size.to_bits() >> (f64::MANTISSA_DIGITS - 1)) as i64 - 1022;
    Some(Bits(u32::try_from((exponent + shift).max(0)).ok()?)).filter(|_| size.is_finite())
}

/// A k such that `integer ≤ 2^k`, for a positive integer.
fn ceiling_log2(integer: &BigInt) -> i64 {
    exact_log2(integer).unwrap_or(integer.bits()) as i64
}
