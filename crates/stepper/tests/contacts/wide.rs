//! The wide scalar: its bound holds the exact result, exact results are known to be exact, and a comparison that is
//! settled is right.

// Longer than 400 lines: one scalar, in every length.

use crate::hand_worked::{base, check};
use crate::pairs::{spike, tolerances};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use rockproof_model::Number;
use rockproof_stepper::{Real, Wide, wide};
use std::cmp::Ordering;
use std::panic::{catch_unwind, resume_unwind};

fn rational(value: f64) -> BigRational {
    BigRational::from_float(value).unwrap()
}

/// Whether a comparison with this exact number is settled, and its outcome.
fn compare(value: Wide, exact: &BigRational) -> (Option<std::cmp::Ordering>, bool) {
    wide::in_bits(wide::BITS, || {
        let other = Wide::of_integer(exact.numer()) / Wide::of_integer(exact.denom());
        let (order, unsettled) = wide::count_unsettled(|| value.partial_cmp(&other));
        (order, unsettled == 0)
    })
}

/// `value` was calculated to be `exact`: a settled comparison says equal; and the two differ by no more than 2⁻⁴⁰⁰ of `scale`.
fn holds(value: Wide, exact: &BigRational, scale: &BigRational) {
    let (order, settled) = compare(value, exact);
    assert!(!settled || order == Some(std::cmp::Ordering::Equal), "{value:?} is not {exact}");
    let margin = scale.abs() / BigRational::from_integer(BigInt::from(1) << 400usize);
    if !margin.is_zero() {
        assert_eq!(compare(value, &(exact + &margin)), (Some(std::cmp::Ordering::Less), true));
        assert_eq!(compare(value, &(exact - &margin)), (Some(std::cmp::Ordering::Greater), true));
    }
}

/// The same of numbers of so many bits, to a few bits.
fn holds_in(value: Wide, exact: &BigRational, bits: u32) {
    let unit = exact.abs() / BigRational::from_integer(BigInt::from(1) << (bits - 6));
    for (other, expected) in
        [(exact.clone(), Ordering::Equal), (exact + &unit, Ordering::Less), (exact - &unit, Ordering::Greater)]
    {
        let (order, settled) = compare(value, &other);
        assert!((settled && order == Some(expected)) || (!settled && other == *exact), "{value:?} is not {exact}");
    }
}

fn ordinary() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1e6..1e6f64,
        (-1000i32..1000).prop_map(f64::from),
        (any::<i64>(), -200i32..200).prop_map(|(m, e)| (m >> 11) as f64 * 2f64.powi(e)),
    ]
}

/// Of up to 512 digits, all of them ones now and then, so that a sum carries.
fn integer() -> impl Strategy<Value = BigInt> {
    let digits = proptest::collection::vec(prop_oneof![any::<u32>(), Just(u32::MAX), Just(0)], 0..16);
    (digits, any::<bool>()).prop_map(|(digits, negative)| {
        let sign = if negative { num_bigint::Sign::Minus } else { num_bigint::Sign::Plus };
        BigInt::from_slice(sign, &digits)
    })
}

/// An integer of up to so many digits of 64 bits, which are the least or the largest now and then, so that quotients are estimated too large.
fn digits(count: usize) -> impl Strategy<Value = BigInt> {
    let extreme = prop_oneof![Just(0), Just(1), Just(u64::MAX), Just(u64::MAX - 1), Just(1 << 63), Just((1 << 63) - 1)];
    let digit = prop_oneof![any::<u64>(), extreme];
    (proptest::collection::vec(digit, 0..=count), any::<bool>()).prop_map(|(digits, negative)| {
        let sign = if negative { num_bigint::Sign::Minus } else { num_bigint::Sign::Plus };
        let bytes: Vec<u8> = digits.iter().flat_map(|digit| digit.to_le_bytes()).collect();
        BigInt::from_bytes_le(sign, &bytes)
    })
}

/// Of so many bits, the leading ones of a number.
fn truncated(exact: &BigRational, bits: i64) -> BigRational {
    if exact.is_zero() {
        return exact.clone();
    }
    let power = |exponent: i64| {
        let power = BigRational::from_integer(BigInt::from(1) << exponent.unsigned_abs());
        if exponent < 0 { power.recip() } else { power }
    };
    let about = exact.numer().bits() as i64 - exact.denom().bits() as i64;
    // 2^(exponent − 1) is not above the number, and 2^exponent is.
    let exponent = if exact.abs() < power(about) { about } else { about + 1 };
    let unit = power(exponent - bits);
    (exact / &unit).trunc() * unit
}

/// What was calculated is the leading bits of what is exact, is called exact if that is all, and is the only number that it can be told from neither
/// above nor below.
fn is_leading(found: Wide, exact: &BigRational, bits: u32) {
    let middle = found.middle().unwrap().to_rational();
    assert_eq!(middle, truncated(exact, i64::from(bits)), "{found:?}");
    assert_eq!(found.is_exact(), middle == *exact, "{found:?}");
    if exact.is_zero() {
        return;
    }
    let unit = exact.abs() / BigRational::from_integer(BigInt::from(1) << (bits - 6));
    for (other, expected) in
        [(exact.clone(), Ordering::Equal), (exact + &unit, Ordering::Less), (exact - &unit, Ordering::Greater)]
    {
        let (order, settled) = compare(found, &other);
        assert!(!settled || order == Some(expected), "{found:?}");
        assert!(settled || other == *exact, "{found:?}");
    }
}

/// Lengths to which results may be cut.
const LENGTHS: [u32; 4] = [128, 256, 384, 512];

proptest! {
    #[test]
    fn every_length_keeps_the_leading_bits_of_what_is_exact(
        length in proptest::sample::select(&LENGTHS),
        (x, y) in (digits(8), digits(8)),
        shift in 0u32..600,
    ) {
        // Operands that the length holds, and some that come from a longer one.
        for kept in [length, wide::BITS] {
            let of = |x: &BigInt| wide::in_bits(kept, || Wide::of_integer(x));
            let scaled = |value: Wide| (0..shift / 60).fold(value, |value, _| value * Wide::of_f64(2f64.powi(-60)));
            let (a, b) = (of(&x), scaled(of(&y)));
            let (x, y) = (a.middle().unwrap().to_rational(), b.middle().unwrap().to_rational());
            // The errors of the operands are not those of the operation.
            let exactly = |value: Wide| value.is_exact().then_some(value);
            let (Some(a), Some(b)) = (exactly(a), exactly(b)) else { continue };
            wide::in_bits(length, || {
                is_leading(a * b, &(&x * &y), length);
                if !y.is_zero() {
                    is_leading(a / b, &(&x / &y), length);
                }
                let bits = |x: &BigRational| x.numer().bits() as i64 - x.denom().bits() as i64;
                if x.is_zero() || y.is_zero() || (bits(&x) - bits(&y)).abs() < i64::from(length) - 2 {
                    if kept == length {
                        is_leading(a + b, &(&x + &y), length);
                        is_leading(a - b, &(&x - &y), length);
                    }
                } else {
                    holds_in(a + b, &(&x + &y), length);
                    holds_in(b - a, &(&y - &x), length);
                }
                let root = (a * a).sqrt();
                if (a * a).is_exact() {
                    is_leading(root, &x.abs(), length);
                }
                let root = a.abs().sqrt().middle().unwrap().to_rational();
                let unit = &root / BigRational::from_integer(BigInt::from(1) << (length - 1));
                assert!(&root * &root <= x.abs() && (x.is_zero() || (&root + &unit) * (&root + &unit) > x.abs()));
            });
        }
    }

    /// Whatever is made of rounded values, in any length, is still told right from numbers that it is not.
    #[test]
    fn every_length_encloses_what_follows_from_rounded_values(
        length in proptest::sample::select(&LENGTHS),
        values in proptest::collection::vec(ordinary(), 4),
        work in proptest::collection::vec((0u8..5, any::<proptest::sample::Index>(), any::<proptest::sample::Index>()), 1..12),
    ) {
        wide::in_bits(length, || {
            let mut found: Vec<Wide> = values.iter().map(|&x| Wide::of_f64(x) / Wide::of_f64(3.0)).collect();
            let three = BigRational::from_integer(3.into());
            let mut exact: Vec<BigRational> = values.iter().map(|&x| rational(x) / &three).collect();
            for (which, one, other) in work {
                let (i, j) = (one.index(found.len()), other.index(found.len()));
                let (a, b, x, y) = (found[i], found[j], exact[i].clone(), exact[j].clone());
                let (value, right) = match which {
                    0 => (a + b, x + y),
                    1 => (a - b, x - y),
                    2 => (a * b, x * y),
                    3 if !y.is_zero() && (a / b).is_known() => (a / b, x / y),
                    3 => continue,
                    _ => (a.larger(b), if x < y { y } else { x }),
                };
                let (order, settled) = compare(value, &right);
                assert!(!settled || order == Some(Ordering::Equal), "{value:?} is not {right}");
                // Another number is not found on the wrong side.
                let beside = &right + right.abs() / BigRational::from_integer(BigInt::from(1) << (length / 2));
                let (order, settled) = compare(value, &beside);
                assert!(!settled || order == Some(right.cmp(&beside)), "{value:?} is not {right}");
                if right.numer().bits() + right.denom().bits() < 20_000 {
                    found.push(value);
                    exact.push(right);
                }
            }
        });
    }

    #[test]
    fn sums_products_and_quotients_hold_the_exact_value(x in ordinary(), y in ordinary(), z in ordinary()) {
        let (a, b, c) = (Wide::of_f64(x), Wide::of_f64(y), Wide::of_f64(z));
        let (p, q, r) = (rational(x), rational(y), rational(z));
        let scale = p.abs() + q.abs() + r.abs() + (p.abs() + r.abs()) * (q.abs() + r.abs());
        prop_assert_eq!(a.to_f64(), x);
        holds(a + b, &(&p + &q), &scale);
        holds(a - b, &(&p - &q), &scale);
        holds((a - c) * (b - c), &((&p - &r) * (&q - &r)), &scale);
        prop_assert!((a * b).is_exact(), "106 bits fit");
        prop_assert_eq!((a * b).middle().map(|n| n.to_rational()), Some(&p * &q));
        prop_assert_eq!((a / Wide::of_f64(0.0)).middle(), None);
        if y != 0.0 {
            let quotient = a / b;
            holds(quotient, &(&p / &q), &(&p / &q));
            // Two errors that nearly cancel: the bound is that of what cancelled.
            holds(quotient * b - a, &BigRational::zero(), &p.abs());
            prop_assert!(quotient.is_exact() || !(quotient * b - a).is_exact());
        }
    }

    #[test]
    fn results_that_fit_are_exact_however_long_and_far_apart_the_operands_are(
        (x, y) in (integer(), integer()),
        shift in 0u32..600,
    ) {
        let (a, b) = (Wide::of_integer(&x), Wide::of_integer(&(&y << shift)));
        let y = y << shift;
        let fits = |exact: &BigInt| exact.bits() - exact.trailing_zeros().unwrap_or(0) <= u64::from(wide::BITS);
        prop_assert!(a.is_exact() && b.is_exact());
        for (found, exact) in [(a + b, &x + &y), (a - b, &x - &y), (b - a, &y - &x), (a * b, &x * &y)] {
            prop_assert!(!found.is_exact() || fits(&exact));
            // What is farther apart is not looked at digit by digit.
            let is_far = x.bits().abs_diff(y.bits()) >= 500 && exact != &x * &y;
            if fits(&exact) && !is_far {
                prop_assert!(found.is_exact());
                prop_assert_eq!(found.middle().map(|n| n.to_rational()), Some(BigRational::from_integer(exact)));
            }
        }
    }

    #[test]
    fn roots_hold_the_exact_value(x in ordinary()) {
        let a = Wide::of_f64(x);
        let square = (a * a).sqrt();
        prop_assert!(square.is_exact(), "the root of a square is exact");
        prop_assert_eq!(square.to_f64(), x.abs());
        let root = a.abs().sqrt();
        holds(root * root, &rational(x.abs()), &rational(x.abs()));
        let third = a.abs() / Wide::of_f64(3.0);
        let root = third.sqrt();
        holds(root * root * Wide::of_f64(3.0), &rational(x.abs()), &rational(x.abs()));
    }

    #[test]
    fn order_and_extremes_follow_the_values(x in ordinary(), y in ordinary()) {
        let (a, b) = (Wide::of_f64(x), Wide::of_f64(y));
        let (order, unsettled) = wide::count_unsettled(|| a.partial_cmp(&b));
        prop_assert_eq!(order, x.partial_cmp(&y));
        prop_assert_eq!(unsettled, 0);
        prop_assert_eq!(a.larger(b).to_f64(), x.max(y));
        prop_assert_eq!(a.smaller(b).to_f64(), x.min(y));
        prop_assert_eq!(a.below(b), x < y);
    }
}

/// Fewer bits are those of the work alone, and no choice is made there by a length of which rounding left nothing.
#[test]
fn fewer_bits_end_with_the_work_and_a_length_of_nothing_by_rounding_is_unsettled() {
    let fits = || (Wide::of_f64(1.0) + Wide::of_f64(2f64.powi(-200))).is_exact();
    assert!(fits() && !wide::in_bits(128, fits) && wide::in_bits(256, fits) && fits());
    assert!(catch_unwind(|| wide::in_bits(128, || resume_unwind(Box::new(())))).is_err());
    assert!(fits(), "a panic leaves no fewer bits behind");
    let (one, tiny) = (Wide::of_f64(1.0), Wide::of_f64(2f64.powi(-200)));
    let left = || (one + tiny - one).is_positive();
    assert_eq!(wide::count_unsettled(left), (true, 0));
    assert_eq!(wide::count_unsettled(|| wide::in_bits(128, left)), (false, 1));
    assert_eq!(wide::count_unsettled(|| wide::in_bits(128, || Wide::EXACT_ZERO.is_positive())), (false, 0));
}

/// A radius is counted in units of its number's size. That of zero has a size of its own: products of such numbers lose it neither by underflow nor by
/// overflow.
#[test]
fn what_rounding_left_of_nothing_has_a_radius_of_any_size() {
    let (one, half, third) = (Wide::of_f64(1.0), Wide::of_f64(0.5), Wide::of_f64(1.0) / Wide::of_f64(3.0));
    for length in LENGTHS {
        wide::in_bits(length, || {
            let third = third + third * Wide::of_f64(2f64.powi(-70));
            let nothing = third - third;
            assert!(!nothing.is_exact() && nothing.middle() == Some(Number::from_integer(0)));
            let power = (0..14).fold(nothing, |power, _| power * power);
            assert!(!power.is_exact() && power.is_known());
            for (sum, other, order) in [
                (one + power, half, Some(Ordering::Greater)),
                (power - one, half, Some(Ordering::Less)),
                (third * power, one, Some(Ordering::Less)),
            ] {
                assert_eq!(wide::count_unsettled(|| sum.partial_cmp(&other)), (order, 0), "{length} bits");
            }
            let same = [power + Wide::EXACT_ZERO, Wide::EXACT_ZERO - power, power / third, power.larger(power)];
            let (tiny, huge) = (Wide::of_f64(2f64.powi(-1000)), Wide::of_f64(2f64.powi(1000)));
            for power in same {
                assert!(!power.is_exact());
                let still_small = (0..4).fold(power, |power, _| power * huge);
                assert_eq!(wide::count_unsettled(|| still_small < half), (true, 0), "{length} bits");
            }
            let large = (0..4).fold(nothing, |large, _| large * huge);
            assert!(large.is_known() && !(one + large).is_exact() && (tiny + large).is_known());
            for sum in [one + large, large + one, tiny + large, large - tiny, (large + one) * (large + one)] {
                assert!(sum.is_known());
                assert_eq!(
                    wide::count_unsettled(|| sum.partial_cmp(&half)),
                    (Some(Ordering::Equal), 1),
                    "{length} bits"
                );
            }
            let back = (0..8).fold(large + one, |back, _| back * tiny);
            assert_eq!(wide::count_unsettled(|| back.partial_cmp(&half)), (Some(Ordering::Less), 0), "{length} bits");
        });
    }
}

#[test]
fn a_tie_of_rounded_values_is_unsettled_and_counted() {
    let third = Wide::of_number(&Number::from_rational(BigRational::new(1.into(), 3.into())));
    let one = Wide::of_f64(1.0);
    assert!(!third.is_exact() && one.is_exact());
    let (_, unsettled) = wide::count_unsettled(|| third + third + third >= one);
    assert_eq!(unsettled, 1);
    let (_, unsettled) = wide::count_unsettled(|| third * Wide::of_f64(3.0) - one <= Wide::EXACT_ZERO);
    assert_eq!(unsettled, 1, "what is left after cancelling is not compared by its own size");
    let (above, unsettled) = wide::count_unsettled(|| third > Wide::of_f64(1.0 / 3.0));
    assert_eq!((above, unsettled), (true, 0));
    let (least, unsettled) = wide::count_unsettled(|| (third + third + third).smaller(one));
    assert_eq!(unsettled, 0, "an extreme is no decision");
    assert!(!least.is_exact());
}

#[test]
fn whatever_follows_from_a_rounded_value_is_not_exact() {
    let (third, one) = (Wide::of_f64(1.0) / Wide::of_f64(3.0), Wide::of_f64(1.0));
    // Of the middle 0, or next to it.
    let (naught, nearly_zero) = (third - third, third * Wide::of_f64(3.0) - one);
    for value in [
        (third + third + third).larger(one),
        naught.sqrt(),
        nearly_zero.sqrt(),
        naught + one,
        one + naught,
        naught - one,
        third / one,
        one / third,
        third * one,
    ] {
        assert!(value.is_known() && !value.is_exact(), "{value:?}");
    }
    assert!(one == one && one != third);
}

#[test]
fn counting_nests_and_keeps_what_was_counted_outside() {
    let third = Wide::of_f64(1.0) / Wide::of_f64(3.0);
    let ((_, inner), outer) = wide::count_unsettled(|| {
        let before = third == third;
        let (after, inner) = wide::count_unsettled(|| third == third);
        ((before, after), inner)
    });
    assert_eq!((inner, outer), (1, 2));
}

/// A caller that catches a panic goes on working on the same thread.
#[test]
fn work_that_panics_leaves_neither_its_mode_nor_its_count_behind() {
    let third = Wide::of_f64(1.0) / Wide::of_f64(3.0);
    let unsettled = || third == third;
    // Unwinds as a panic does, without its message.
    let panics = || {
        assert!(unsettled());
        resume_unwind(Box::new(()))
    };
    let ((), outer) = wide::count_unsettled(|| {
        assert!(unsettled());
        let inner = catch_unwind(|| wide::count_unsettled(panics));
        assert!(inner.is_err() && unsettled());
    });
    assert_eq!(outer, 3, "one before, one within, one after");
    assert!(catch_unwind(|| wide::settled(panics)).is_err());
    // Where it was still so that one unsettled comparison spoils the answer, no contact would be looked for.
    let above = spike([1.0, 1.0, 1.0625], 0.25, 0.5);
    check("after a panic", &above, &base(), &tolerances(), &["v-f 0 1 v-f 0 1 +1"]);
}

#[test]
fn zero_and_its_negative_have_a_root() {
    for zero in [Wide::EXACT_ZERO, -Wide::EXACT_ZERO] {
        assert!(zero.sqrt().is_exact() && zero.sqrt() == Wide::EXACT_ZERO);
    }
}

#[test]
fn what_is_not_known_stays_unknown_and_never_panics() {
    let zero = Wide::EXACT_ZERO;
    let one = Wide::of_f64(1.0);
    let third = one / Wide::of_f64(3.0);
    let nearly_zero = third * Wide::of_f64(3.0) - one;
    for unknown in [one / zero, zero / zero, one / nearly_zero, Wide::of_f64(-1.0).sqrt(), Wide::of_f64(f64::NAN)] {
        for value in [unknown, unknown + one, one - unknown, unknown * zero, unknown / one, unknown.sqrt(), -unknown] {
            assert!(!value.is_known() && !value.is_finite() && value.to_f64().is_nan());
            let (order, unsettled) = wide::count_unsettled(|| value.partial_cmp(&zero));
            assert_eq!((order, unsettled), (None, 1));
            assert!(!value.larger(one).is_known() && !value.below(one));
        }
    }
    let root = nearly_zero.sqrt();
    assert!(root.is_known() && root.below(Wide::of_f64(1e-70)));
}

#[test]
fn range_is_wider_than_that_of_f64() {
    let tiny = Wide::of_f64(f64::from_bits(1));
    let huge = Wide::of_f64(f64::MAX);
    assert_eq!(tiny.to_f64(), f64::from_bits(1));
    assert_eq!(huge.to_f64(), f64::MAX);
    assert_eq!(huge.middle().map(|n| n.to_rational()), Some(rational(f64::MAX)));
    assert_eq!(Wide::EXACT_ZERO.middle(), Some(Number::ZERO));
    let product = tiny * tiny * tiny;
    assert!(product.is_exact() && Wide::EXACT_ZERO.below(product));
    assert_eq!((product * huge * huge * huge / (huge * huge * huge) / tiny / tiny).to_f64(), tiny.to_f64());
    let far = huge + tiny;
    assert!(!far.is_exact());
    assert_eq!(compare(far, &rational(f64::MAX)).0, Some(std::cmp::Ordering::Equal));
    let long = (BigInt::from(1) << 600usize) + 1;
    assert!(!Wide::of_integer(&long).is_exact());
    holds(Wide::of_integer(&long), &BigRational::from_integer(long.clone()), &BigRational::from_integer(long));
    holds(
        Wide::of_integer(&-(BigInt::from(7) << 700usize)),
        &BigRational::from_integer(-(BigInt::from(7) << 700usize)),
        &BigRational::zero(),
    );
}

/// Elimination in a system of 150 unknowns, as springs tie a chain of blocks, keeps its pivots certain and its solution narrow.
#[test]
fn the_radius_stays_small_through_a_long_elimination() {
    const SIZE: usize = 150;
    let stiff = Wide::of_f64(1e9) / Wide::of_f64(3.0);
    let soft = Wide::of_f64(1.0) / Wide::of_f64(7.0);
    let mut rows: Vec<Vec<Wide>> = (0..SIZE)
        .map(|i| {
            (0..SIZE)
                .map(|j| {
                    if i == j {
                        stiff + stiff + soft
                    } else if i.abs_diff(j) == 1 {
                        -stiff
                    } else {
                        soft / Wide::of_f64(SIZE as f64)
                    }
                })
                .collect()
        })
        .collect();
    let right: Vec<Wide> = (0..SIZE).map(|i| rows[i].iter().fold(Wide::EXACT_ZERO, |sum, &a| sum + a)).collect();
    let mut rhs = right;
    let (_, unsettled) = wide::count_unsettled(|| {
        for k in 0..SIZE {
            assert!(Wide::EXACT_ZERO < rows[k][k], "pivot {k}");
            let (above, below) = rows.split_at_mut(k + 1);
            let pivot = &above[k];
            for (i, row) in below.iter_mut().enumerate() {
                let share = row[k] / pivot[k];
                for (entry, &over) in row.iter_mut().zip(pivot).skip(k) {
                    *entry = *entry - share * over;
                }
                rhs[k + 1 + i] = rhs[k + 1 + i] - share * rhs[k];
            }
        }
    });
    assert_eq!(unsettled, 0);
    for k in (0..SIZE).rev() {
        for j in k + 1..SIZE {
            rhs[k] = rhs[k] - rows[k][j] * rhs[j];
        }
        rhs[k] = rhs[k] / rows[k][k];
        let (order, unsettled) = wide::count_unsettled(|| (rhs[k] - Wide::of_f64(1.0)).abs() < Wide::of_f64(1e-30));
        assert!(order && unsettled == 0, "unknown {k}: {:?}", rhs[k]);
    }
}
