//! Integers as significands: up to 256 bits in place, longer ones on the heap.

use crate::field::UpperBound;
use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive};
use rockproof_model::Sign;
use rockproof_model::ring::ExactRing;
use ruint::Uint;
use std::borrow::Cow;

/// An integer.
#[derive(Clone, Debug)]
pub(super) enum Significand {
    /// One of up to 128 bits; zero is not negative.
    Short { negative: bool, size: u128 },
    /// One of 129 to 256 bits.
    Middle { negative: bool, size: U256 },
    /// A longer one.
    Long(BigInt),
}

/// A sum or product before it is cut.
pub(super) enum Uncut {
    /// `±(high · 2¹²⁸ + low)`.
    Double { negative: bool, high: u128, low: u128 },
    /// One of up to 512 bits.
    Quadruple { negative: bool, size: U512 },
    /// One that may be longer.
    Long(BigInt),
}

type U256 = Uint<256, 4>;
type U512 = Uint<512, 8>;

const WIDTH: u32 = u128::BITS;

impl Significand {
    pub(super) const ZERO: Significand = Significand::Short { negative: false, size: 0 };

    fn short(negative: bool, size: u128) -> Significand {
        Significand::Short { negative: negative && size != 0, size }
    }

    /// A size of up to 256 bits in the form that it has.
    fn in_place(negative: bool, size: U256) -> Significand {
        match u128::try_from(size) {
            Ok(size) => Significand::short(negative, size),
            Err(_) => Significand::Middle { negative, size },
        }
    }

    /// As `num_bigint` has it.
    pub(super) fn integer(&self) -> Cow<'_, BigInt> {
        match self {
            Significand::Short { negative, size } => {
                let size = BigInt::from(*size);
                Cow::Owned(if *negative { -size } else { size })
            }
            Significand::Middle { negative, size } => Cow::Owned(integer(*negative, size.as_le_slice())),
            Significand::Long(value) => Cow::Borrowed(value),
        }
    }

    pub(super) fn is_zero(&self) -> bool {
        matches!(self, Significand::Short { size: 0, .. })
    }

    pub(super) fn sign(&self) -> Sign {
        match self {
            Significand::Short { size: 0, .. } => Sign::Zero,
            Significand::Short { negative: true, .. } => Sign::Negative,
            Significand::Short { .. } => Sign::Positive,
            Significand::Middle { negative, .. } => {
                if *negative {
                    Sign::Negative
                } else {
                    Sign::Positive
                }
            }
            Significand::Long(value) => ExactRing::sign(value),
        }
    }

    /// Bits of its size.
    pub(super) fn bits(&self) -> i64 {
        match self {
            Significand::Short { size, .. } => i64::from(WIDTH - size.leading_zeros()),
            Significand::Middle { size, .. } => size.bit_len() as i64,
            Significand::Long(value) => value.bits() as i64,
        }
    }

    pub(super) fn negated(&self) -> Significand {
        match self {
            Significand::Short { negative, size } => Significand::short(!negative, *size),
            Significand::Middle { negative, size } => Significand::Middle { negative: !negative, size: *size },
            Significand::Long(value) => Significand::Long(-value),
        }
    }

    /// It without its last bits, so many: less than a unit of what stays away. That must be less than 127 bits.
    pub(super) fn leading(&self, excess: i64) -> i128 {
        match self {
            Significand::Short { negative, size } => {
                let size = (size >> excess) as i128;
                if *negative { -size } else { size }
            }
            Significand::Middle { negative, size } => {
                let size = (*size >> excess as usize).wrapping_to::<u128>() as i128;
                if *negative { -size } else { size }
            }
            Significand::Long(value) => {
                debug_assert!(value.bits() as i64 - excess < 127, "too many bits stay");
                (value >> excess as usize).to_i128().unwrap_or(0)
            }
        }
    }

    /// At least its size times `2^exponent`.
    pub(super) fn upper_bound(&self, exponent: i64) -> UpperBound {
        match self {
            Significand::Short { size, .. } => UpperBound::of_short(*size, exponent),
            Significand::Middle { size, .. } => {
                let excess = size.bit_len() - WIDTH as usize;
                let is_cut = size.trailing_zeros() < excess;
                let leading = (*size >> excess).wrapping_to::<u128>() | u128::from(is_cut);
                UpperBound::of_short(leading, exponent + excess as i64)
            }
            Significand::Long(value) => UpperBound::of_integer(value, exponent),
        }
    }

    pub(super) fn times(&self, other: &Significand) -> Uncut {
        match (self, other) {
            (Significand::Short { negative: a, size: one }, Significand::Short { negative: b, size: two }) => {
                let [high, low] = product(*one, *two);
                Uncut::Double { negative: a != b, high, low }
            }
            (Significand::Long(_), _) | (_, Significand::Long(_)) => {
                Uncut::Long(self.integer().as_ref() * other.integer().as_ref())
            }
            _ => {
                let [(a, one), (b, two)] = [self, other].map(Significand::parts);
                Uncut::Quadruple { negative: a != b, size: one.widening_mul(two) }
            }
        }
    }

    /// The sign and size of one that is not long.
    fn parts(&self) -> (bool, U256) {
        match *self {
            Significand::Short { negative, size } => (negative, U256::from(size)),
            Significand::Middle { negative, size } => (negative, size),
            Significand::Long(_) => (false, U256::ZERO),
        }
    }

    /// `self · 2^shift ± other · 2^other_shift`; shifts of zeros may be anything, others are not negative.
    pub(super) fn sum(&self, shift: i64, other: &Significand, other_shift: i64, negate: bool) -> Uncut {
        if let (Some(one), Some(two)) = (self.moved(shift), other.moved(other_shift)) {
            return Uncut::sum(one, (two.0 != negate, two.1));
        }
        if let (Some(one), Some(two)) = (self.moved_far(shift), other.moved_far(other_shift)) {
            return Uncut::sum_of_quadruples(one, (two.0 != negate, two.1));
        }
        let moved = |value: &Significand, shift: i64| {
            let shift = if value.is_zero() { 0 } else { shift };
            value.integer().as_ref() << shift as usize
        };
        let (one, two) = (moved(self, shift), moved(other, other_shift));
        Uncut::Long(if negate { one - two } else { one + two })
    }

    /// Its sign, and its size times `2^shift` in two halves, where that is below 2²⁵⁵.
    fn moved(&self, shift: i64) -> Option<(bool, [u128; 2])> {
        match *self {
            Significand::Short { size: 0, .. } => Some((false, [0, 0])),
            Significand::Short { negative, size } if shift == 0 => Some((negative, [0, size])),
            Significand::Short { negative, size } if shift < i64::from(WIDTH) => {
                Some((negative, [size >> (i64::from(WIDTH) - shift), size << shift]))
            }
            _ => None,
        }
    }

    /// The same, where that is below 2⁵¹¹.
    fn moved_far(&self, shift: i64) -> Option<(bool, U512)> {
        if let Significand::Long(_) = self {
            return None;
        }
        let (negative, size) = self.parts();
        if size.is_zero() {
            return Some((false, U512::ZERO));
        }
        let fits = shift < i64::from(4 * WIDTH) - self.bits();
        fits.then(|| (negative, size.to::<U512>() << shift as usize))
    }
}

impl From<BigInt> for Significand {
    fn from(value: BigInt) -> Significand {
        match u128::try_from(value.magnitude()) {
            Ok(size) => Significand::short(value.is_negative(), size),
            Err(_) if value.bits() <= u64::from(2 * WIDTH) => {
                let mut limbs = [0; 4];
                limbs.iter_mut().zip(value.iter_u64_digits()).for_each(|(limb, digit)| *limb = digit);
                Significand::Middle { negative: value.is_negative(), size: U256::from_limbs(limbs) }
            }
            Err(_) => Significand::Long(value),
        }
    }
}

impl Uncut {
    /// Of two signed sizes below 2²⁵⁵.
    fn sum((a, one): (bool, [u128; 2]), (b, two): (bool, [u128; 2])) -> Uncut {
        if a == b {
            let (low, carry) = one[1].overflowing_add(two[1]);
            return Uncut::Double { negative: a, high: one[0] + two[0] + u128::from(carry), low };
        }
        let (negative, large, small) = if one >= two { (a, one, two) } else { (b, two, one) };
        let (low, borrow) = large[1].overflowing_sub(small[1]);
        Uncut::Double { negative, high: large[0] - small[0] - u128::from(borrow), low }
    }

    /// Of two signed sizes below 2⁵¹¹.
    fn sum_of_quadruples((a, one): (bool, U512), (b, two): (bool, U512)) -> Uncut {
        let (negative, size) = match (a == b, one >= two) {
            (true, _) => (a, one + two),
            (false, true) => (a, one - two),
            (false, false) => (b, two - one),
        };
        Uncut::Quadruple { negative, size }
    }

    /// Bits of its size.
    pub(super) fn bits(&self) -> i64 {
        match self {
            Uncut::Double { high: 0, low, .. } => i64::from(WIDTH - low.leading_zeros()),
            Uncut::Double { high, .. } => i64::from(2 * WIDTH - high.leading_zeros()),
            Uncut::Quadruple { size, .. } => size.bit_len() as i64,
            Uncut::Long(value) => value.bits() as i64,
        }
    }

    /// Whether the last bits, so many, are not all zero.
    pub(super) fn ends_in_ones(&self, bits: i64) -> bool {
        match *self {
            Uncut::Double { high: 0, low: 0, .. } => false,
            Uncut::Double { high, low: 0, .. } => i64::from(WIDTH + high.trailing_zeros()) < bits,
            Uncut::Double { low, .. } => i64::from(low.trailing_zeros()) < bits,
            Uncut::Quadruple { size, .. } => !size.is_zero() && (size.trailing_zeros() as i64) < bits,
            Uncut::Long(ref value) => value.trailing_zeros().is_some_and(|zeros| (zeros as i64) < bits),
        }
    }

    /// Without its last bits, so many: the largest integer not above its quotient.
    pub(super) fn without(self, bits: i64) -> Significand {
        let is_negative =
            matches!(self, Uncut::Double { negative: true, .. } | Uncut::Quadruple { negative: true, .. });
        let rounds_up = is_negative && self.ends_in_ones(bits);
        if let Uncut::Double { negative, high, low } = self {
            let [high, low] = match bits {
                0 => [high, low],
                1..128 => [high >> bits, (low >> bits) | (high << (128 - bits))],
                128..256 => [0, high >> (bits - 128)],
                _ => [0, 0],
            };
            if high == 0
                && let Some(size) = low.checked_add(u128::from(rounds_up))
            {
                return Significand::short(negative, size);
            }
            let size = (U256::from(high) << WIDTH as usize) | U256::from(low);
            // Below 2²⁵⁵ where it rounds up, as here.
            return Significand::in_place(negative, size + U256::from(u64::from(rounds_up)));
        }
        if let Uncut::Quadruple { negative, size } = self {
            let shifted = if bits < i64::from(4 * WIDTH) { size >> bits as usize } else { U512::ZERO };
            // At most 2⁵¹¹ where it rounds up: a bit or more is gone.
            let size = shifted + U512::from(u64::from(rounds_up));
            return match size.bit_len() {
                0..=256 => Significand::in_place(negative, size.wrapping_to()),
                _ => Significand::from(integer(negative, size.as_le_slice())),
            };
        }
        let Uncut::Long(value) = self else { return Significand::ZERO };
        Significand::from(value >> bits as usize)
    }
}

/// An integer by its sign and the bytes of its size, the last first.
fn integer(negative: bool, size: &[u8]) -> BigInt {
    BigInt::from_bytes_le(if negative { num_bigint::Sign::Minus } else { num_bigint::Sign::Plus }, size)
}

/// The product of two in two halves, the upper one first.
fn product(one: u128, two: u128) -> [u128; 2] {
    let halves = |value: u128| [value >> 64, value & u128::from(u64::MAX)];
    let ([a, b], [c, d]) = (halves(one), halves(two));
    let low = b * d;
    // Below 2¹²⁸: (2⁶⁴ − 1)² + 2·(2⁶⁴ − 1).
    let first = a * d + (low >> 64);
    let second = b * c + (first & u128::from(u64::MAX));
    [a * c + (first >> 64) + (second >> 64), (second << 64) | (low & u128::from(u64::MAX))]
}

#[cfg(test)]
mod tests;
