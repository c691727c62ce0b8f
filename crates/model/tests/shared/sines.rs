//! Sines and tangents of degrees against their series, summed in whole numbers.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rockproof_model::Number;
use rockproof_model::preset::sine_of_degrees;
use rockproof_model::simulation::tangent_of_degrees;

/// π to 60 decimals, without the point.
const PI: &str = "3141592653589793238462643383279502884197169399375105820974944";
/// Sums are made in units of 2⁻¹⁹⁰, which π's decimals reach.
const BITS: u32 = 190;

/// An angle of so many eighths of a degree in radians.
fn radians(eighths: u32) -> BigInt {
    let pi: BigInt = PI.parse().expect("digits");
    ((pi * eighths) << BITS) / (BigInt::from(10).pow(60) * (8 * 180))
}

/// A number of units as a fraction.
fn fraction(units: BigInt) -> BigRational {
    BigRational::new(units, BigInt::one() << BITS)
}

/// sin x and cos x by their series; what 60 terms leave out, and their rounding, is below 2⁻¹⁸⁰ for x up to π/2.
fn sine_and_cosine(x: &BigInt) -> [BigRational; 2] {
    let (mut term, mut sums) = (BigInt::one() << BITS, [BigInt::zero(), BigInt::zero()]);
    for k in 0..60_u32 {
        // 1, x, −x²/2, −x³/6, …: the even ones are the cosine's.
        let sum = &mut sums[usize::from(k % 2 == 0)];
        *sum += if k / 2 % 2 == 0 { term.clone() } else { -term.clone() };
        term = ((term * x) >> BITS) / (k + 1);
    }
    sums.map(fraction)
}

/// How far a value is from an exact one, in steps of f64 at the value.
fn steps(value: f64, exact: &BigRational) -> f64 {
    let of = |v: f64| BigRational::from_float(v).expect("finite");
    let off = (of(value) - exact).abs() / (of(value.next_up()) - of(value));
    Number::from_rational(off).approximate()
}

#[test]
fn sines_are_those_of_the_series() {
    for eighths in 1..=720 {
        let [sine, _] = sine_and_cosine(&radians(eighths));
        let found = sine_of_degrees(f64::from(eighths) / 8.0);
        // One step for the sine, and one and a half for the rounded angle.
        assert!(steps(found, &sine) < 2.5, "sin of {} degrees is {found:e}", f64::from(eighths) / 8.0);
    }
    assert_eq!([sine_of_degrees(0.0), sine_of_degrees(90.0)], [0.0, 1.0]);
    // The sine of 3° that presets take, by its decimals.
    assert!(
        steps(
            sine_of_degrees(3.0),
            &"5233595624294383272211862960907841873/100000000000000000000000000000000000000".parse().unwrap()
        ) < 1.0
    );
}

#[test]
fn tangents_are_those_of_the_series() {
    for eighths in 1..=712 {
        let x = radians(eighths);
        let [sine, cosine] = sine_and_cosine(&x);
        let degrees = Number::from_f64(f64::from(eighths) / 8.0).expect("finite");
        let found = tangent_of_degrees(&degrees).as_f64().expect("an f64");
        // What a relative error of the angle becomes: x / (sin x · cos x) times as much.
        let amplified = Number::from_rational(fraction(x) / (&sine * &cosine)).approximate();
        assert!(steps(found, &(sine / cosine)) < 1.5 + 1.5 * amplified, "tan of {degrees} degrees is {found:e}");
    }
    assert_eq!(tangent_of_degrees(&Number::from_integer(45)).as_f64(), Some(1.0));
    assert_eq!(tangent_of_degrees(&Number::ZERO).as_f64(), Some(0.0));
}
