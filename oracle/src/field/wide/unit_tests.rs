use super::*;
use crate::number::UNIT_ROUNDOFF;
use proptest::prelude::*;

/// Significands of up to 320 bits, and radii from far below their last bit to far above the first.
fn balls() -> impl Strategy<Value = WideBall> {
    let significand = (any::<[u64; 5]>(), 0usize..320, any::<bool>()).prop_map(|(digits, bits, negative)| {
        let size = digits.iter().fold(BigInt::zero(), |sum, digit| (sum << 64) + digit) >> bits;
        if negative { -size } else { size }
    });
    let radius = prop_oneof![Just(None), (-1_100i64..900).prop_map(Some)];
    (significand, -1_000i64..600, radius).prop_map(|(significand, exponent, radius)| {
        let exactly = WideBall::exactly(significand, exponent, 1_024);
        radius.map_or(exactly.clone(), |top| exactly.widened(UpperBound::power_of_two(top)))
    })
}

fn size_of(bound: UpperBound) -> BigRational {
    bound.to_rational()
}

/// What is cut of the middle is in the radius, where nothing else is.
#[test]
fn a_unit_that_is_cut_is_enclosed() {
    let power = |bits: u32| BigInt::from(1) << bits;
    let one = BigInt::from(1);
    for value in [power(125) + &one, power(200) + &one, power(300) + &one, power(300) - &one] {
        for value in [value.clone(), -value] {
            let ball = WideBall::exactly(value.clone(), 0, 1_024).in_double(0);
            let off = (Field::middle(&ball) - BigRational::from_integer(value.clone())).abs();
            assert!(off.is_positive() && off <= size_of(Field::radius(&ball).expect("finite")), "{value}: {ball:?}");
        }
    }
}

#[test]
fn a_ball_that_knows_nothing_is_refused() {
    let (nothing, infinite) = (f64::NAN, f64::INFINITY);
    for (high, low, radius) in
        [(1.0, 0.0, nothing), (1.0, 0.0, infinite), (infinite, nothing, 0.0), (nothing, 0.0, 0.0), (1.0, nothing, 0.0)]
    {
        let ball = DoubleBall { high, low, radius };
        assert!(WideBall::of_double(&ball, 0, 128).is_none(), "{ball:?}");
    }
    let beyond = WideBall::exactly(BigInt::from(1), REACH + 1, 128).in_double(0);
    assert!(WideBall::of_double(&beyond, 0, 128).is_none(), "{beyond:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn two_f64_enclose_what_a_ball_does_and_back(ball in balls(), shift in -300i64..300) {
        let double = ball.in_double(shift);
        let scale = dyadic(1.into(), shift);
        let (middle, radius) = (ball.middle() * &scale, size_of(ball.spread()) * &scale);
        prop_assert!(double.low.abs() <= double.high.abs() * UNIT_ROUNDOFF, "{double:?}");
        if let Some(of_double) = Field::radius(&double) {
            let apart = (Field::middle(&double) - &middle).abs();
            prop_assert!(apart.clone() + &radius <= size_of(of_double), "{ball:?} {shift} {double:?}");
            // And little more: 2^-100 of the middle, and what is below all f64.
            let below = dyadic(1.into(), LEADING_BITS + 1 - REACH);
            let most = &radius * dyadic(1_048_577.into(), -20) + middle.abs() * dyadic(1.into(), -100) + below;
            prop_assert!(size_of(of_double) <= most, "{ball:?} {shift} {double:?}");
            let back = WideBall::of_double(&double, -shift, 64).expect("finite");
            let apart = (back.middle() - Field::middle(&double) / &scale).abs();
            prop_assert!(apart + size_of(of_double) / &scale <= size_of(back.spread()), "{double:?} {shift} {back:?}");
        } else {
            prop_assert!(middle.abs().max(radius) > dyadic(1.into(), REACH), "{ball:?} {shift}");
            prop_assert!(WideBall::of_double(&double, -shift, 64).is_none());
        }
    }
}
