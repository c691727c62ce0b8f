//! Rounding to f32 and f64, to nearest and ties to even, against the parser and the casts of the standard library, and by its definition.

use num_bigint::BigInt;
use num_rational::BigRational;
use proptest::prelude::*;
use rockproof_model::{Number, Precision};

/// What rounding gives, for the standard library's answer: nothing beyond the range, and no minus zero.
fn expected(value: f64) -> Option<f64> {
    value.is_finite().then_some(value + 0.0)
}

fn same(found: Option<f64>, wanted: Option<f64>) -> bool {
    found.map(f64::to_bits) == wanted.map(f64::to_bits)
}

fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).expect("a finite number")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(debug_assertions) { 200 } else { 3000 }))]

    /// Decimals of up to 30 digits, beyond both ends of both precisions.
    #[test]
    fn decimals_round_as_the_standard_library_parses(
        digits in "[0-9]{1,30}", point in 0_usize..30, exponent in -360_i32..340, negative: bool,
    ) {
        let at = point.min(digits.len());
        let sign = if negative { "-" } else { "" };
        let text = format!("{sign}{}.{}e{exponent}", &digits[..at], &digits[at..]);
        let text = text.replace("-.", "-0.");
        let text = if text.starts_with('.') { format!("0{text}") } else { text };
        let number = Number::parse(&text).expect("a decimal");
        let (double, single) = (text.parse::<f64>().expect("f64"), text.parse::<f32>().expect("f32"));
        prop_assert!(same(number.rounded(Precision::F64), expected(double)), "{} {:?}", text, number.rounded(Precision::F64));
        prop_assert!(same(number.rounded(Precision::F32), expected(f64::from(single))), "{} {:?}", text, number.rounded(Precision::F32));
    }

    /// Exponents about those of f32, its smallest numbers included.
    #[test]
    fn decimals_round_to_small_and_large_f32(digits in "[1-9][0-9]{0,20}", exponent in -65_i32..22) {
        let text = format!("{digits}e{exponent}");
        let single = text.parse::<f32>().expect("f32");
        let found = Number::parse(&text).expect("a decimal").rounded(Precision::F32);
        prop_assert!(same(found, expected(f64::from(single))), "{} {:?} {}", text, found, single);
    }

    /// Any f64 becomes the f32 that the processor makes of it.
    #[test]
    fn doubles_round_to_singles_as_the_processor_does(bits: u64) {
        let value = f64::from_bits(bits);
        prop_assume!(value.is_finite());
        let found = Number::from_f64(value).expect("finite").rounded(Precision::F32);
        prop_assert!(same(found, expected(f64::from(value as f32))), "{value:e} {found:?}");
    }

    /// Halfway between two neighbours the even one; anything beside it, however little, the near one.
    #[test]
    fn ties_go_to_even_and_beside_them_to_the_near_one(bits in 0_u64..0x7FEF_FFFF_FFFF_FFFF, thirds: bool) {
        let (low, high) = (f64::from_bits(bits), f64::from_bits(bits + 1));
        let middle = (exact(low) + exact(high)) / exact(2.0);
        let even = if bits % 2 == 0 { low } else { high };
        let rounded = |value: BigRational| Number::from_rational(value).rounded(Precision::F64);
        prop_assert!(same(rounded(middle.clone()), Some(even)), "between {low:e} and {high:e}");
        let scale = exact(high) - exact(low);
        let little = scale / BigRational::from_integer(BigInt::from(if thirds { 3 } else { 1 }) << 200_u32);
        prop_assert!(same(rounded(&middle + &little), Some(high)), "above the middle of {low:e} and {high:e}");
        prop_assert!(same(rounded(&middle - &little), Some(low)), "below the middle of {low:e} and {high:e}");
    }

    /// The same of f32, whose middles are f64.
    #[test]
    fn ties_of_singles_go_to_even(bits in 0_u32..0x7F7F_FFFE) {
        let (low, high) = (f32::from_bits(bits), f32::from_bits(bits + 1));
        let middle = (f64::from(low) + f64::from(high)) / 2.0;
        let even = f64::from(if bits % 2 == 0 { low } else { high });
        for number in [Number::from_f64(middle).expect("finite"), Number::from_rational(exact(middle))] {
            prop_assert!(same(number.rounded(Precision::F32), Some(even)), "between {low:e} and {high:e}");
        }
        let third = exact(middle) + exact(f64::from(high) - f64::from(low)) / exact(3.0e9);
        prop_assert!(same(Number::from_rational(third).rounded(Precision::F32), Some(f64::from(high))));
    }
}

#[test]
fn what_rounds_beyond_the_range_is_none() {
    // The largest number of each precision, and the middle between it and the next that would be.
    for (text, precision, wanted) in [
        ("0x1.fffffffffffffp1023", Precision::F64, Some(f64::MAX)),
        ("0x1.fffffffffffff7p1023", Precision::F64, Some(f64::MAX)),
        ("0x1.fffffffffffff8p1023", Precision::F64, None),
        ("0x1.fffffep127", Precision::F32, Some(f64::from(f32::MAX))),
        ("0x1.fffffefffffffp127", Precision::F32, Some(f64::from(f32::MAX))),
        ("0x1.ffffffp127", Precision::F32, None),
        // Half of the smallest is a tie with zero; a little more is not.
        ("0x1p-1075", Precision::F64, Some(0.0)),
        ("0x1.0000000000001p-1075", Precision::F64, Some(f64::from_bits(1))),
        ("-0x1p-1075", Precision::F64, Some(0.0)),
        ("0x1p-150", Precision::F32, Some(0.0)),
        ("0x1.8p-149", Precision::F32, Some(f64::from(f32::from_bits(2)))),
    ] {
        let found = Number::parse(text).expect("a number").rounded(precision);
        assert!(same(found, wanted), "{text} in {precision}: {found:?}, not {wanted:?}");
    }
}
