//! How close a polynomial is to zero.

use super::ScalesCache;
use crate::field::DoubleBall;
use crate::number::{Int128, Magnitude};
use crate::pair::{FromUnits, Int256, Int512, Pair};
use crate::predicate::Polynomial;
use crate::view::{ExactPair, ExactView, LazyScales, Scales};
use num_bigint::BigInt;
use rockproof_model::{Sign, ToleranceSet};
use std::cell::OnceCell;

/// Tolerances for margins.
#[derive(Default)]
pub(super) struct MarginScales {
    double: OnceCell<Scales<Magnitude<DoubleBall>>>,
    small: OnceCell<Scales<Magnitude<Int128>>>,
    int256: OnceCell<Scales<Magnitude<Int256>>>,
    int512: OnceCell<Scales<Magnitude<Int512>>>,
    heap: OnceCell<Scales<Magnitude<BigInt>>>,
}

/// Works out how close polynomials are to zero.
pub(crate) struct Margins<'m, 's> {
    pub(super) pair: &'m Pair<'s>,
    pub(super) tolerances: &'m ToleranceSet,
    pub(super) scales: &'m ScalesCache,
}

impl Margins<'_, '_> {
    /// The sign of a polynomial, and its size over that of its terms, rounded once.
    pub(crate) fn of<P: Polynomial>(&self, polynomial: &P) -> (Sign, f64) {
        self.of_balls(polynomial).unwrap_or_else(|| self.of_integers(polynomial))
    }

    /// The same in balls of two f64, where these tell.
    pub(crate) fn of_balls<P: Polynomial>(&self, polynomial: &P) -> Option<(Sign, f64)> {
        let (pair, scales) = (self.pair, self.scales);
        let geometry = pair.magnitudes().double.get_or_init(|| Box::new(pair.in_double(Magnitude::of_ball)));
        let made = &scales.margins.get_or_init(Box::default).double;
        let make =
            || scales.exact(pair, self.tolerances).double(pair.grid().bits).map(|ball| Magnitude::of_ball(*ball));
        polynomial.value(&ExactView { geometry, scales: LazyScales { made, make: &make } }).certain_relative()
    }

    /// The same in integers of the least width that holds both.
    pub(crate) fn of_integers<P: Polynomial>(&self, polynomial: &P) -> (Sign, f64) {
        let (pair, known) = (self.pair, self.pair.magnitudes());
        let exact = self.scales.exact(pair, self.tolerances);
        let made = self.scales.margins.get_or_init(Box::default);
        match self.scales.bits_of(polynomial, pair, self.tolerances).0 {
            ..128 => relative_size(polynomial, known.small.get_or_init(|| Box::new(pair.exact())), &made.small, exact),
            128..256 => {
                relative_size(polynomial, known.int256.get_or_init(|| Box::new(pair.exact())), &made.int256, exact)
            }
            256..512 => {
                relative_size(polynomial, known.int512.get_or_init(|| Box::new(pair.exact())), &made.int512, exact)
            }
            _ => relative_size(polynomial, known.heap.get_or_init(|| Box::new(pair.exact())), &made.heap, exact),
        }
    }
}

fn relative_size<P: Polynomial, T: FromUnits + Into<BigInt>>(
    polynomial: &P,
    geometry: &ExactPair<'_, Magnitude<T>>,
    made: &OnceCell<Scales<Magnitude<T>>>,
    exact: &Scales<BigInt>,
) -> (Sign, f64) {
    let scales = LazyScales { made, make: &|| exact.converted() };
    polynomial.value(&ExactView { geometry, scales }).relative()
}
