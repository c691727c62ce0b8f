//! The cheapest level: f64 balls. Each radius is formed from at most eight roundings, which [`INFLATION`] makes up for;
//! [`UNDERFLOW`] is added wherever a result may have fallen below the normal numbers.

use super::{Field, Halve, UpperBound, dyadic};
use crate::number::{Ball, INFLATION, SMALLEST_POSITIVE, UNDERFLOW, UNIT_ROUNDOFF, sum_is_exact};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::number::split_f64;
use rockproof_model::{Number, Precision, Sign};

/// The ball around a correctly rounded value, or everything where it overflowed.
fn around(rounded: Option<f64>) -> Ball {
    match rounded {
        Some(middle) => Ball { middle, radius: (middle.abs() * UNIT_ROUNDOFF) * INFLATION + UNDERFLOW },
        None => Ball { middle: 0.0, radius: f64::INFINITY },
    }
}

impl Halve for Ball {
    fn half(&self) -> Self {
        let radius = self.radius / 2.0;
        // Halving loses a bit only below the normal numbers.
        let safe = self.middle == 0.0 || self.middle.abs() > 4.0 * UNDERFLOW;
        // Half of the least radius rounds to zero, which would call the middle exact.
        let whole = safe && (self.radius == 0.0 || radius > 4.0 * UNDERFLOW);
        // Beside a large radius UNDERFLOW is lost.
        Ball { middle: self.middle / 2.0, radius: if whole { radius } else { radius * INFLATION + UNDERFLOW } }
    }
}

impl Field for Ball {
    fn of_rational(value: &BigRational, bits: u32) -> Self {
        Self::of_number(&Number::from_rational(value.clone()), bits)
    }

    fn of_number(value: &Number, _bits: u32) -> Self {
        match value.as_f64() {
            Some(middle) => Ball { middle, radius: 0.0 },
            None => around(value.rounded(Precision::F64)),
        }
    }

    fn of_difference(a: &Number, b: &Number, bits: u32) -> Self {
        match (a.as_f64(), b.as_f64()) {
            // A sum of two f64 is off by at most one roundoff of itself; it never underflows to something inexact.
            (Some(a), Some(b)) => {
                let middle = a - b;
                let exact = sum_is_exact(a, -b, middle);
                Ball { middle, radius: if exact { 0.0 } else { middle.abs() * UNIT_ROUNDOFF * INFLATION } }
            }
            _ => Self::of_number(&a.plus(&b.negated()), bits),
        }
    }

    fn over(&self, divisor: &Self) -> Option<Self> {
        let least = divisor.middle.abs() - divisor.radius;
        if least.is_nan() || least <= 0.0 {
            return None;
        }
        if self.middle == 0.0 && self.radius == 0.0 {
            return Some(*self);
        }
        // A power of two divides without rounding, but for underflow.
        let power = divisor.middle.to_bits() & ((1 << 52) - 1) == 0;
        if power && self.radius == 0.0 && divisor.radius == 0.0 {
            let middle = self.middle / divisor.middle;
            if middle.abs() > 4.0 * UNDERFLOW && middle.is_finite() {
                return Some(Ball { middle, radius: 0.0 });
            }
        }
        // |x/y − m/w| = |x·w − y·m| / |y·w| ≤ (r + |m/w|·ρ) / (|w| − ρ).
        let middle = self.middle / divisor.middle;
        // A product that is lost to underflow would be large again once it is divided by a small number.
        let carried = if divisor.radius == 0.0 { 0.0 } else { middle.abs() * divisor.radius + SMALLEST_POSITIVE };
        let spread = (self.radius + carried) / least;
        Some(Ball { middle, radius: (spread + middle.abs() * UNIT_ROUNDOFF) * INFLATION + UNDERFLOW })
    }

    fn root(&self) -> Option<Self> {
        if self.middle == 0.0 && self.radius == 0.0 {
            return Some(*self);
        }
        // |√x − √m| = |x − m| / (√x + √m) ≤ r / √m.
        if self.radius.is_nan() || !self.middle.is_finite() || self.middle <= self.radius {
            return None;
        }
        // No root is so small that something could be lost to underflow.
        let middle = self.middle.sqrt();
        Some(Ball { middle, radius: (self.radius / middle + middle * UNIT_ROUNDOFF) * INFLATION })
    }

    fn certain_sign(&self) -> Option<Sign> {
        Ball::certain_sign(*self)
    }

    fn middle(&self) -> BigRational {
        if !self.middle.is_finite() {
            return BigRational::zero();
        }
        let (significand, exponent) = split_f64(self.middle);
        dyadic(BigInt::from(significand), i64::from(exponent))
    }

    fn radius(&self) -> Option<UpperBound> {
        if self.middle.is_finite() { UpperBound::of_f64(self.radius) } else { None }
    }

    fn magnitude_bound(&self) -> Option<UpperBound> {
        Some(UpperBound::of_f64(self.middle.abs())?.plus(UpperBound::of_f64(self.radius)?))
    }

    fn within(size: UpperBound) -> Option<Self> {
        Some(Ball { middle: 0.0, radius: size.to_f64() })
    }

    fn nearby(&self) -> (f64, f64) {
        (self.middle, self.radius)
    }
}
