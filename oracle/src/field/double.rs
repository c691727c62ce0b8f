//! The second level: balls around the unevaluated sum of two f64, some 100 bits. Sums and products are those of M. Joldes,
//! J.-M. Muller and V. Popescu, *Tight and rigorous error bounds for basic building blocks of double-word arithmetic* (2017),
//! theorems 3.1, 5.1 and 6.2: off by at most 3u², 7u² and 15u² of themselves, and a little; the root is that of V. Lefèvre and others
//! (2022), 25/8·u². [`ROUNDING`] covers all.

use super::{Field, Halve, UpperBound, dyadic};
use crate::number::{Ball, INFLATION, SMALLEST_POSITIVE, UNDERFLOW, UNIT_ROUNDOFF};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
use rockproof_model::number::{power_of_two, split_f64};
use rockproof_model::{Number, Precision, Ring, Sign};

/// All values within `radius` of `high + low`, `|low|` at most a roundoff of `high`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoubleBall {
    pub(crate) high: f64,
    pub(crate) low: f64,
    pub(crate) radius: f64,
}

/// 32u²: above the relative error of every operation.
pub(super) const ROUNDING: f64 = 32.0 * UNIT_ROUNDOFF * UNIT_ROUNDOFF;
/// Below, the low part of a product may be lost to underflow.
const SAFE: f64 = f64::MIN_POSITIVE * (1u64 << 60) as f64;

/// `a + b` and what the rounding lost, exactly (Knuth).
#[inline]
pub(super) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// The same where |a| ≥ |b| or a is zero (Dekker).
#[inline]
pub(super) fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// `a · b` and what the rounding lost, exactly above [`SAFE`] (Dekker, Veltkamp).
#[inline]
pub(super) fn two_product(a: f64, b: f64) -> (f64, f64) {
    const SPLIT: f64 = 134_217_729.0;
    let split = |x: f64| {
        let wide = SPLIT * x;
        let high = wide - (wide - x);
        (high, x - high)
    };
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

impl DoubleBall {
    /// The bits of both parts.
    pub(crate) const BITS: u32 = 106;

    /// The value itself, `|low|` at most a roundoff of `high`.
    pub(crate) fn exactly(high: f64, low: f64) -> DoubleBall {
        DoubleBall { high, low, radius: 0.0 }
    }

    /// `value · 2^exponent`.
    pub(crate) fn of_integer(value: &BigInt, exponent: i64) -> DoubleBall {
        match value.to_i128() {
            Some(small) if small.unsigned_abs() >> 120 == 0 && (-128..=0).contains(&exponent) => {
                DoubleBall::of_units(small, power_of_two(exponent as i32))
            }
            _ => DoubleBall::of_rational(&dyadic(value.clone(), exponent), DoubleBall::BITS),
        }
    }

    /// `value · scale`, for a value below 2¹²⁰ and a power of two of at least 2⁻¹²⁸ and at most 1.
    pub(crate) fn of_units(value: i128, scale: f64) -> DoubleBall {
        if let Ok(short) = i64::try_from(value)
            && short.unsigned_abs() < 1 << 62
        {
            let high = short as f64;
            // Less than half of what 53 digits leave of 62.
            let low = (short - high as i64) as f64;
            return DoubleBall::exactly(high * scale, low * scale);
        }
        let high = value as f64;
        let rest = value.wrapping_sub(high as i128);
        let low = rest as f64;
        let radius = if low as i128 == rest { 0.0 } else { low.abs() * UNIT_ROUNDOFF };
        DoubleBall { high: high * scale, low: low * scale, radius: radius * scale }
    }

    /// At least the size of every value enclosed.
    pub(crate) fn size(&self) -> f64 {
        (self.high.abs() + self.low.abs() + self.radius) * INFLATION
    }

    /// A ball of f64 around all values enclosed.
    pub(crate) fn as_ball(&self) -> Ball {
        Ball { middle: self.high, radius: (self.low.abs() + self.radius) * INFLATION }
    }

    /// The f64 nearest to every value enclosed, if that is the same for all.
    pub(crate) fn certain_rounding(&self) -> Option<f64> {
        // More than the radius by what the sums below may lose before their last rounding.
        let spread = (self.radius + self.low.abs() * f64::EPSILON) * INFLATION + UNDERFLOW;
        let [least, most] = [self.high + (self.low - spread), self.high + (self.low + spread)];
        (least == most).then_some(least)
    }

    fn is_exact_zero(&self) -> bool {
        self.high == 0.0 && self.radius == 0.0
    }

    /// The ball of a result one rounding away from something off by `error`.
    fn rounded(high: f64, low: f64, error: f64) -> DoubleBall {
        DoubleBall { high, low, radius: (error + high.abs() * ROUNDING) * INFLATION }
    }

    /// A result of which only the f64 is known to a few roundoffs.
    fn coarse(high: f64, error: f64) -> DoubleBall {
        DoubleBall { high, low: 0.0, radius: (error + high.abs() * 8.0 * UNIT_ROUNDOFF) * INFLATION + UNDERFLOW }
    }
}

impl Ring for DoubleBall {
    fn from_i32(value: i32) -> Self {
        DoubleBall::exactly(f64::from(value), 0.0)
    }

    fn plus(&self, other: &Self) -> Self {
        let (high, rest) = two_sum(self.high, other.high);
        let error = self.radius + other.radius;
        if self.low == 0.0 && other.low == 0.0 {
            // An overflow leaves no number in `rest`.
            let radius = if rest.is_finite() { error * INFLATION } else { f64::INFINITY };
            return DoubleBall { high, low: rest, radius };
        }
        let (lows, lost) = two_sum(self.low, other.low);
        let (middle, first) = two_sum(rest, lows);
        let (high, low) = fast_two_sum(high, middle);
        let (last, second) = two_sum(lost, low);
        let (high, low) = fast_two_sum(high, last);
        if first == 0.0 && second == 0.0 {
            return DoubleBall { high, low, radius: error * INFLATION };
        }
        DoubleBall::rounded(high, low, error)
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }

    fn times(&self, other: &Self) -> Self {
        if self.is_exact_zero() || other.is_exact_zero() {
            return DoubleBall::exactly(0.0, 0.0);
        }
        let (product, rest) = two_product(self.high, other.high);
        // An overflow, of the product or of its parts, leaves no number in `rest`.
        let safe = product.abs() >= SAFE && rest.is_finite();
        if self.low == 0.0 && other.low == 0.0 && self.radius == 0.0 && other.radius == 0.0 && safe {
            return DoubleBall::exactly(product, rest);
        }
        let (high, low) = fast_two_sum(product, rest + (self.high * other.low + self.low * other.high));
        let error = self.high.abs() * other.radius + other.high.abs() * self.radius + self.radius * other.radius;
        // |high| falls short of |high + low| by a roundoff; ROUNDING of the radius' own terms is far above that.
        let ball = DoubleBall::rounded(high, low, error * (1.0 + 4.0 * f64::EPSILON));
        DoubleBall { radius: ball.radius + UNDERFLOW, ..ball }
    }

    fn negated(&self) -> Self {
        DoubleBall { high: -self.high, low: -self.low, radius: self.radius }
    }
}

impl Halve for DoubleBall {
    fn half(&self) -> Self {
        let tiny = |part: f64| part != 0.0 && part.abs() <= 4.0 * UNDERFLOW;
        let rounded = tiny(self.high) || tiny(self.low) || tiny(self.radius);
        let radius = self.radius / 2.0;
        // Beside a large radius UNDERFLOW is lost.
        let radius = if rounded { radius * INFLATION + UNDERFLOW } else { radius };
        DoubleBall { high: self.high / 2.0, low: self.low / 2.0, radius }
    }
}

impl Field for DoubleBall {
    fn of_rational(value: &BigRational, bits: u32) -> Self {
        Self::of_number(&Number::from_rational(value.clone()), bits)
    }

    fn of_number(value: &Number, _bits: u32) -> Self {
        if let Some(float) = value.as_f64() {
            return DoubleBall::exactly(float, 0.0);
        }
        let unknown = DoubleBall { high: 0.0, low: 0.0, radius: f64::INFINITY };
        let Some(high) = value.rounded(Precision::F64) else { return unknown };
        let Ok(first) = Number::from_f64(high) else { return unknown };
        let Some(low) = value.plus(&first.negated()).rounded(Precision::F64) else { return unknown };
        DoubleBall { high, low, radius: low.abs() * UNIT_ROUNDOFF * INFLATION + UNDERFLOW }
    }

    fn of_difference(a: &Number, b: &Number, bits: u32) -> Self {
        match (a.as_f64(), b.as_f64()) {
            (Some(a), Some(b)) => {
                let (high, low) = two_sum(a, -b);
                DoubleBall { high, low, radius: if low.is_finite() { 0.0 } else { f64::INFINITY } }
            }
            _ => Self::of_number(&a.plus(&b.negated()), bits),
        }
    }

    fn over(&self, divisor: &Self) -> Option<Self> {
        let least = divisor.high.abs() * (1.0 - 4.0 * f64::EPSILON) - divisor.radius;
        if least.is_nan() || least <= 0.0 {
            return None;
        }
        if self.is_exact_zero() {
            return Some(*self);
        }
        let first = self.high / divisor.high;
        // |x/y − m/w| ≤ (r + |m/w|·ρ) / (|w| − ρ).
        // A product that is lost to underflow would be large again once it is divided by a small number.
        let carried = if divisor.radius == 0.0 { 0.0 } else { first.abs() * divisor.radius + SMALLEST_POSITIVE };
        let spread = (self.radius + carried) / least * (1.0 + 8.0 * f64::EPSILON);
        if self.high.abs() < SAFE || first.abs() < SAFE || divisor.high.abs() < SAFE {
            return Some(DoubleBall::coarse(first, spread));
        }
        let (product, rest) = two_product(divisor.high, first);
        let (high, low) = fast_two_sum(product, divisor.low * first);
        let (high, low) = fast_two_sum(high, low + rest);
        let (high, low) = fast_two_sum(first, ((self.high - high) + (self.low - low)) / divisor.high);
        let ball = DoubleBall::rounded(high, low, spread);
        Some(DoubleBall { radius: ball.radius + UNDERFLOW, ..ball })
    }

    fn root(&self) -> Option<Self> {
        if self.is_exact_zero() {
            return Some(*self);
        }
        if self.radius.is_nan() || !self.high.is_finite() || self.high * (1.0 - 4.0 * f64::EPSILON) <= self.radius {
            return None;
        }
        let first = self.high.sqrt();
        let spread = self.radius / first * (1.0 + 8.0 * f64::EPSILON);
        if self.high < SAFE {
            return Some(DoubleBall::coarse(first, spread));
        }
        let (square, rest) = two_product(first, first);
        let left = ((self.high - square) - rest) + self.low;
        let (high, low) = fast_two_sum(first, left / (2.0 * first));
        if left == 0.0 && self.radius == 0.0 && self.low == 0.0 {
            return Some(DoubleBall::exactly(first, 0.0));
        }
        // The root of a number above SAFE is far above what underflow may take from its radius.
        Some(DoubleBall::rounded(high, low, spread))
    }

    fn certain_sign(&self) -> Option<Sign> {
        let least = self.high.abs() * (1.0 - 4.0 * f64::EPSILON);
        if least > self.radius {
            Some(if self.high > 0.0 { Sign::Positive } else { Sign::Negative })
        } else if self.is_exact_zero() {
            Some(Sign::Zero)
        } else {
            None
        }
    }

    fn middle(&self) -> BigRational {
        let part = |value: f64| if value.is_finite() { split_f64(value) } else { (0, 0) };
        let parts =
            [part(self.high), part(self.low)].map(|(significand, exponent)| (BigInt::from(significand), exponent));
        // A zero has no place of its own.
        let lowest =
            parts.iter().filter(|(significand, _)| !significand.is_zero()).map(|part| part.1).min().unwrap_or(0);
        let in_lowest = |(significand, exponent): &(BigInt, i32)| significand << (exponent - lowest).max(0);
        dyadic(in_lowest(&parts[0]) + in_lowest(&parts[1]), i64::from(lowest))
    }

    fn radius(&self) -> Option<UpperBound> {
        if self.high.is_finite() && self.low.is_finite() { UpperBound::of_f64(self.radius) } else { None }
    }

    fn magnitude_bound(&self) -> Option<UpperBound> {
        let part = |value: f64| UpperBound::of_f64(value.abs());
        Some(part(self.high)?.plus(part(self.low)?).plus(part(self.radius)?))
    }

    fn within(size: UpperBound) -> Option<Self> {
        Some(DoubleBall { high: 0.0, low: 0.0, radius: size.to_f64() })
    }

    fn nearby(&self) -> (f64, f64) {
        (self.high, (self.radius + self.low.abs()) * INFLATION)
    }
}

#[cfg(test)]
mod unit_tests {
    use super::*;

    /// What one and two f64 hold is exact, up to either end of what 64 bits hold.
    #[test]
    fn units_are_held_exactly_or_within_their_radius() {
        let scale = power_of_two(-64);
        let (mut exact, mut rounded) = (0, 0);
        for power in [0, 31, 52, 53, 54, 61, 62, 63, 64, 100, 106, 107, 119] {
            for beside in [0, 1, -1, 1 << 9, (1 << 9) - 1, -(1 << 8) - 1, 1 << 40, (1 << 65) + 1] {
                for value in [(1i128 << power) + beside, -(1i128 << power) - beside] {
                    let ball = DoubleBall::of_units(value, scale);
                    let part = |part: f64| BigRational::from_float(part).expect("finite");
                    let value = BigRational::new(value.into(), BigInt::from(1) << 64u32);
                    let off = value - part(ball.high) - part(ball.low);
                    assert!(off <= part(ball.radius) && -off <= part(ball.radius), "2^{power} + {beside}: {ball:?}");
                    assert!(ball.low.abs() <= ball.high.abs() * UNIT_ROUNDOFF, "2^{power} + {beside}: {ball:?}");
                    *(if ball.radius == 0.0 { &mut exact } else { &mut rounded }) += 1;
                }
            }
        }
        assert!(exact > 100 && rounded > 1, "{exact} exact, {rounded} rounded");
    }
}
