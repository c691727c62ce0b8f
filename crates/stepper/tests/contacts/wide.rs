//! The wide scalar: its bound holds the exact result, exact results are known to be exact, and a comparison that is
//! settled is right.

use crate::hand_worked::{base, check};
use crate::pairs::{spike, tolerances};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use rockproof_model::Number;
use rockproof_stepper::{Real, Wide, wide};
use std::panic::{catch_unwind, resume_unwind};

fn rational(value: f64) -> BigRational {
    BigRational::from_float(value).unwrap()
}

/// Whether a comparison with this exact number is settled, and its outcome.
fn compare(value: Wide, exact: &BigRational) -> (Option<std::cmp::Ordering>, bool) {
    let other = Wide::of_integer(exact.numer()) / Wide::of_integer(exact.denom());
    let (order, unsettled) = wide::count_unsettled(|| value.partial_cmp(&other));
    (order, unsettled == 0)
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

proptest! {
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
