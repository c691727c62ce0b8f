//! Bounds on errors, in units of the power of two that a number has for its exponent, as f64 that are always rounded up. Nothing is the bound of a value
//! without error, infinity that of a value of which nothing is known. The oracle's balls have bounds of another kind; neither side uses the other's arithmetic.

/// Makes up for the roundings of a few operations, each of which is off by at most 2⁻⁵³ of what it gives.
const MORE: f64 = 1.0 + 16.0 * f64::EPSILON;
/// Likewise, downwards.
const LESS: f64 = 1.0 - 16.0 * f64::EPSILON;
/// More than underflow takes away in a few operations.
const UNDERFLOW: f64 = f64::MIN_POSITIVE;

/// The bound of a value without error.
pub(super) const EXACT: f64 = 0.0;
/// The bound of a value of which nothing is known.
pub(super) const UNKNOWN: f64 = f64::INFINITY;
/// No number has a radius above this, but one of which nothing is known: so products and shifted sums do not overflow.
pub(super) const LARGEST: f64 = f64::from_bits((1023 + 400) << 52);

/// 2^exponent; the least normal number where it is below that, and infinity where it is above all.
pub(super) fn power(exponent: i64) -> f64 {
    match exponent {
        ..=-1022 => UNDERFLOW,
        -1021..=1023 => f64::from_bits(((exponent + 1023) as u64) << 52),
        1024.. => f64::INFINITY,
    }
}

/// Not below a sum or product of bounds that was calculated in a few operations; nothing if that is nothing.
pub(super) fn rounded_up(calculated: f64) -> f64 {
    if calculated == EXACT { EXACT } else { calculated * MORE + UNDERFLOW }
}

/// Not above a positive number that was calculated in a few operations without underflow.
pub(super) fn rounded_down(calculated: f64) -> f64 {
    calculated * LESS
}

/// Not below the bound times 2^exponent; nothing if it is nothing.
pub(super) fn shifted(bound: f64, exponent: i64) -> f64 {
    if bound == EXACT { EXACT } else { bound * power(exponent) + UNDERFLOW }
}

/// A bound that is more than nothing as one from 1 to below 2, and the power of two that it was multiplied by.
pub(super) fn split(bound: f64) -> (f64, i64) {
    let bits = bound.max(UNDERFLOW).to_bits();
    (f64::from_bits(bits & ((1 << 52) - 1) | 1023 << 52), (bits >> 52) as i64 - 1023)
}

/// Not below the leading digit of a fraction with whatever follows it.
pub(super) fn at_most(leading: u64) -> f64 {
    if leading == 0 { 0.0 } else { ((leading >> 11) + 1) as f64 * UNIT }
}

/// Not above it.
pub(super) fn at_least(leading: u64) -> f64 {
    (leading >> 11) as f64 * UNIT
}

/// 2⁻⁵³, what the last of the leading 53 bits of a fraction stands for.
const UNIT: f64 = f64::EPSILON / 2.0;

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use num_rational::BigRational;
    use proptest::prelude::*;

    fn exactly(value: f64) -> BigRational {
        BigRational::from_float(value).expect("a number")
    }

    fn power_of_two(exponent: i64) -> BigRational {
        let power = BigRational::from_integer(BigInt::from(1) << exponent.unsigned_abs());
        if exponent < 0 { power.recip() } else { power }
    }

    fn bounds() -> impl Strategy<Value = f64> {
        let any = (0u64..1 << 52, -1022i64..400)
            .prop_map(|(digits, exponent)| (1.0 + digits as f64 * f64::EPSILON) * power(exponent));
        prop_oneof![Just(EXACT), Just(UNDERFLOW), Just(LARGEST), any]
    }

    proptest! {
        #[test]
        fn every_bound_rounds_up(a in bounds(), b in bounds(), c in bounds(), exponent in -2000i64..600) {
            let (x, y, z) = (exactly(a), exactly(b), exactly(c));
            prop_assert!(exactly(rounded_up(a + b + c)) >= &x + &y + &z);
            if a * b + b * c > 0.0 || a * b + b * c == 0.0 && (b == 0.0 || a == 0.0 && c == 0.0) {
                prop_assert!(exactly(rounded_up(a * b + b * c)) >= &x * &y + &y * &z);
            }
            prop_assert!(exactly(shifted(a, exponent)) >= &x * power_of_two(exponent));
            if a > EXACT {
                let (one, up) = split(a);
                prop_assert!((1.0..2.0).contains(&one) && exactly(one) * power_of_two(up) == x);
            }
            prop_assert!((a == EXACT) == (shifted(a, exponent) == EXACT) && (a == EXACT) == (rounded_up(a) == EXACT));
            // By little, where nothing underflows.
            if a > 1e-200 {
                let little = &x * (exactly(1.0) + power_of_two(-40));
                prop_assert!(exactly(rounded_up(a)) <= little && exactly(shifted(a, 7)) <= little * power_of_two(7));
            }
            prop_assert!(power(exponent) >= UNDERFLOW && (exponent < -1022 || exactly(power(exponent)) == power_of_two(exponent)));
        }

        #[test]
        fn leading_digits_lie_between_their_bounds(digit in prop_oneof![any::<u64>(), Just(u64::MAX), Just(1 << 63), Just(0)]) {
            let unit = power_of_two(-64);
            let (low, high) = (exactly(at_least(digit)), exactly(at_most(digit)));
            let digit = BigRational::from_integer(digit.into());
            prop_assert!(low <= &digit * &unit);
            prop_assert!(high >= (&digit + exactly(1.0)) * &unit || high == exactly(0.0) && digit == exactly(0.0));
        }
    }

    #[test]
    fn what_is_rounded_down_is_below_a_calculated_difference() {
        for (one, other) in [(1.0, 0.1), (0.3, 0.1), (1.0, f64::EPSILON / 4.0)] {
            let found: f64 = rounded_down(one - other);
            assert!(exactly(found) <= exactly(one) - exactly(other) && found > 0.99 * (one - other));
        }
    }
}
