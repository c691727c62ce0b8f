//! Polynomials in integers of each width. What is the same for all polynomials of a pair is made once, and so is each sign of one polynomial.

use crate::number::{Bits, Int128};
use crate::pair::{FromUnits, Int256, Int512, Int1024, Pair};
use crate::predicate::Polynomial;
use crate::view::{BitsView, ExactPair, ExactView, LazyScales, Scales};
use num_bigint::BigInt;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Sign, ToleranceSet};
use std::cell::OnceCell;

/// The widths of integers on the stack, in bits.
pub(super) const WIDTHS: [u32; 4] = [128, 256, 512, 1024];

/// A pair and its tolerances in integers of one type.
struct InType<'s, T> {
    geometry: ExactPair<'s, T>,
    scales: OnceCell<Scales<T>>,
}

impl<'s, T: FromUnits> InType<'s, T> {
    fn new(pair: &Pair<'s>) -> InType<'s, T> {
        InType { geometry: pair.exact::<T>(), scales: OnceCell::new() }
    }

    fn value<P: Polynomial>(&self, exact: &Scales<BigInt>, p: &P) -> T {
        let scales = LazyScales { made: &self.scales, make: &|| exact.converted::<T>() };
        p.value(&ExactView { geometry: &self.geometry, scales })
    }
}

/// A pair and its tolerances in units of its lattice, in integers of every width.
pub(super) struct InIntegers<'p, 's> {
    pair: &'p Pair<'s>,
    scales: Scales<BigInt>,
    bits: OnceCell<Scales<Bits>>,
    heap: InType<'s, BigInt>,
    int128: OnceCell<InType<'s, Int128>>,
    int256: OnceCell<InType<'s, Int256>>,
    int512: OnceCell<InType<'s, Int512>>,
    int1024: OnceCell<InType<'s, Int1024>>,
}

impl<'p, 's> InIntegers<'p, 's> {
    pub(super) fn new(pair: &'p Pair<'s>, tolerances: &ToleranceSet) -> InIntegers<'p, 's> {
        InIntegers {
            pair,
            scales: Scales::exact(tolerances, &pair.grid().lattice),
            bits: OnceCell::new(),
            heap: InType::new(pair),
            int128: OnceCell::new(),
            int256: OnceCell::new(),
            int512: OnceCell::new(),
            int1024: OnceCell::new(),
        }
    }

    /// The bits that every intermediate value has at most.
    pub(super) fn bits<P: Polynomial>(&self, p: &P) -> Bits {
        p.value(&BitsView {
            a: &self.pair.a.block,
            b: &self.pair.b.block,
            coordinate: self.pair.grid().bits,
            scales: LazyScales { made: &self.bits, make: &|| self.scales.bits() },
        })
    }

    fn sign<P: Polynomial, T: FromUnits + ExactRing>(&self, made: &OnceCell<InType<'s, T>>, p: &P) -> Sign {
        ExactRing::sign(&made.get_or_init(|| InType::new(self.pair)).value(&self.scales, p))
    }
}

/// One polynomial: its value, the bits on the way there, and its sign in integers of each width, calculated when it is first asked for.
pub(super) struct PolynomialInIntegers<'i, 'p, 's, P> {
    integers: &'i InIntegers<'p, 's>,
    p: &'i P,
    pub(super) value: BigInt,
    pub(super) bits: Bits,
    signs: [OnceCell<Sign>; WIDTHS.len()],
}

impl<'i, 'p, 's, P: Polynomial> PolynomialInIntegers<'i, 'p, 's, P> {
    pub(super) fn new(integers: &'i InIntegers<'p, 's>, p: &'i P) -> PolynomialInIntegers<'i, 'p, 's, P> {
        let (value, bits) = (integers.heap.value(&integers.scales, p), integers.bits(p));
        PolynomialInIntegers { integers, p, value, bits, signs: Default::default() }
    }

    /// The sign of the value.
    pub(super) fn exact(&self) -> Sign {
        ExactRing::sign(&self.value)
    }

    /// The sign that integers of the width with this number find, whether or not they hold the value and what comes on the way.
    pub(super) fn sign(&self, width: usize) -> Sign {
        let (integers, p) = (self.integers, self.p);
        *self.signs[width].get_or_init(|| match WIDTHS[width] {
            128 => integers.sign(&integers.int128, p),
            256 => integers.sign(&integers.int256, p),
            512 => integers.sign(&integers.int512, p),
            _ => integers.sign(&integers.int1024, p),
        })
    }

    /// Holds that integers of every width that holds so many bits find this sign.
    pub(super) fn check_widths(&self, exact: Sign, about: &str) {
        for (number, width) in WIDTHS.into_iter().enumerate() {
            if self.bits < Bits(width) {
                let slot = P::FIRST_SLOT + self.p.variant();
                assert_eq!(self.sign(number), exact, "{width}-bit integers, slot {slot}, {about}");
            }
        }
    }
}

/// The sign of one polynomial of a pair, in integers on the heap.
pub(super) fn sign_of<P: Polynomial>(pair: &Pair<'_>, tolerances: &ToleranceSet, p: &P) -> Sign {
    ExactRing::sign(&value_of(pair, tolerances, p))
}

/// Its value.
pub(super) fn value_of<P: Polynomial>(pair: &Pair<'_>, tolerances: &ToleranceSet, p: &P) -> BigInt {
    InType::new(pair).value(&Scales::exact(tolerances, &pair.grid().lattice), p)
}
