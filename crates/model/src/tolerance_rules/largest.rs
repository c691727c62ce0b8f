//! Which of many values may be the largest, by f64: only of those must anything be calculated exactly.

use crate::number::Number;

/// A value within so much of itself of the exact one: sixteen roundoffs.
const DOUBT: f64 = 8.0 * f64::EPSILON;

/// A factor above zero, or NaN where products and quotients of such factors might overflow or underflow.
pub(super) fn factor(value: f64) -> f64 {
    if (1e-60..1e60).contains(&value) { value } else { f64::NAN }
}

/// A factor of a term: zero where the number is, NaN where f64 knows less of it than to a roundoff or products might overflow or
/// underflow.
pub(super) fn signed_factor(number: &Number) -> f64 {
    let value = number.approximate();
    let is_known = number.as_f64() == Some(0.0) || (1e-60..1e60).contains(&value.abs());
    if is_known { value } else { f64::NAN }
}

/// The places of the values that may be the largest, where each is within sixteen roundoffs of itself of the exact one: quotients and
/// products of few [`factor`]s are. **Of equal ones all**; of NaN nothing is known.
pub(super) fn may_be_largest(values: &[f64]) -> impl Iterator<Item = usize> {
    let most = values.iter().copied().fold(0.0, f64::max);
    // Both may be wrong by `DOUBT`; half as much again makes up for rounding here.
    let limit = most * (1.0 - 2.5 * DOUBT);
    values.iter().enumerate().filter(move |&(_, &value)| value.is_nan() || value >= limit).map(|(place, _)| place)
}

/// The places of the values that may be the least, as [`may_be_largest`].
pub(super) fn may_be_least(values: &[f64]) -> impl Iterator<Item = usize> {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let limit = least * (1.0 + 2.5 * DOUBT);
    values.iter().enumerate().filter(move |&(_, &value)| value.is_nan() || value <= limit).map(|(place, _)| place)
}

/// The places of the sums that may be the least or the greatest, each given by three terms that are products of two
/// [`signed_factor`]s; of NaN nothing is known. Each term is within three roundoffs of itself of the exact one, their sum within two more.
pub(super) fn may_be_extreme(sums: &[[f64; 3]]) -> Vec<usize> {
    let bounds: Vec<Option<(f64, f64)>> = sums
        .iter()
        .map(|terms| {
            let [sum, size] = [terms.iter().sum::<f64>(), terms.iter().map(|term| term.abs()).sum::<f64>()];
            (!sum.is_nan()).then_some((sum - size * DOUBT, sum + size * DOUBT))
        })
        .collect();
    let known = || bounds.iter().flatten();
    // A sum that is certainly below another is not the greatest.
    let least = known().map(|(_, high)| *high).fold(f64::INFINITY, f64::min);
    let greatest = known().map(|(low, _)| *low).fold(f64::NEG_INFINITY, f64::max);
    let may_be = |bounds: &Option<(f64, f64)>| bounds.is_none_or(|(low, high)| low <= least || high >= greatest);
    bounds.iter().enumerate().filter(|(_, bounds)| may_be(bounds)).map(|(place, _)| place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;

    #[test]
    fn what_f64_cannot_tell_from_the_largest_may_be_it() {
        let last = 1.0 - f64::EPSILON;
        let places = |values: &[f64]| may_be_largest(values).collect::<Vec<_>>();
        assert_eq!(places(&[1.0, 0.5, last, 1.0 - 1e-9, 1.0]), [0, 2, 4]);
        assert_eq!(places(&[0.25, f64::NAN, 2.0]), [1, 2]);
        assert_eq!(places(&[f64::NAN, f64::NAN]), [0, 1]);
        assert!(places(&[]).is_empty());
        let places = |values: &[f64]| may_be_least(values).collect::<Vec<_>>();
        assert_eq!(places(&[1.0, 2.0, last, 1.0 + 1e-9, f64::NAN, 1.0]), [0, 2, 4, 5]);
        assert!(places(&[]).is_empty());
        assert!(factor(2.5) == 2.5 && [0.0, -1.0, 1e-61, 1e61, f64::INFINITY].iter().all(|&v| factor(v).is_nan()));
    }

    #[test]
    fn a_number_that_f64_takes_for_zero_is_not_known() {
        let number = |text: &str| Number::from_rational(text.parse::<BigRational>().expect("a fraction"));
        let tiny = Number::from_rational(BigRational::new(1.into(), num_bigint::BigInt::from(10).pow(400)));
        assert!(tiny.approximate() == 0.0 && signed_factor(&tiny).is_nan());
        assert_eq!([signed_factor(&Number::ZERO), signed_factor(&number("-1/2"))], [0.0, -0.5]);
        assert!(signed_factor(&number("1/3")) == 1.0 / 3.0);
    }

    #[test]
    fn what_f64_cannot_tell_from_an_end_may_be_it() {
        let sums = [[3.0, -1.0, 0.0], [5.0, 0.0, 0.0], [1.0, 0.0, 0.0], [5.0, 1e-16, 0.0], [4.0, 0.0, 0.0]];
        assert_eq!(may_be_extreme(&sums), [1, 2, 3]);
        // What cancels is known less well.
        assert_eq!(may_be_extreme(&[[1e6, -1e6, 1.0], [0.0, 0.0, 1.0 + 1e-12], [0.0, 0.0, 2.0]]), [0, 1, 2]);
        assert_eq!(
            may_be_extreme(&[[0.0, 0.0, f64::NAN], [2.0, 0.0, 0.0], [1.5, 0.0, 0.0], [f64::NAN; 3], [1.0; 3]]),
            [0, 2, 3, 4]
        );
    }
}
