//! The common lattice of a set of numbers.
//!
//! Every predicate of SPEC is homogeneous in length, so multiplying all coordinates and lengths by one positive
//! factor changes no sign. The factor chosen here makes every one of them an integer; on that lattice exact arithmetic
//! needs integers only.

use crate::number::{Number, split_f64};
use crate::vector::Vec3;
use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, ToPrimitive};

/// A factor `odd · 2^exponent` that turns every number it was made for into an integer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lattice {
    exponent: i32,
    odd: BigInt,
    /// `odd` once more, where 64 bits hold it.
    small_odd: Option<u64>,
}

impl Lattice {
    /// The coarsest lattice that holds all `numbers`.
    pub fn covering<'a>(numbers: impl IntoIterator<Item = &'a Number>) -> Lattice {
        let mut exponent = i32::MIN;
        let mut odd = BigInt::one();
        for number in numbers {
            if let Some(value) = number.as_f64() {
                if value != 0.0 {
                    exponent = exponent.max(-split_f64(value).1);
                }
            } else if let Some(ratio) = number.as_ratio() {
                let twos = ratio.denom().trailing_zeros().unwrap_or(0);
                exponent = exponent.max(twos as i32);
                let odd_part = ratio.denom() >> twos;
                if !odd_part.is_one() && !odd.is_multiple_of(&odd_part) {
                    odd = odd.lcm(&odd_part);
                }
            }
        }
        let small_odd = odd.to_u64();
        Lattice { exponent: if exponent == i32::MIN { 0 } else { exponent }, odd, small_odd }
    }

    /// [`Lattice::covering`] of the coordinates of points, and these in its units, where each has at most `bits` bits there (at most 126) and all have
    /// few digits.
    pub fn covering_points<'a>(
        points: impl Iterator<Item = &'a Vec3<Number>> + Clone,
        bits: u32,
    ) -> Option<(Lattice, Vec<Vec3<i128>>)> {
        let (mut exponent, mut odd) = (i32::MIN, 1u64);
        let count = points.size_hint().0;
        let mut fractions = Vec::new();
        for point in points.clone() {
            for number in point.components() {
                if let Some(value) = number.as_f64() {
                    if value != 0.0 {
                        exponent = exponent.max(-split_f64(value).1);
                    }
                    continue;
                }
                let (p, m, k) = number.small_fraction()?;
                exponent = exponent.max(-k);
                if m != odd && !odd.is_multiple_of(m) {
                    odd = (odd / odd.gcd(&m)).checked_mul(m)?;
                }
                // Where one is a fraction most are.
                if fractions.is_empty() {
                    fractions.reserve(3 * count);
                }
                fractions.push((p, m, k));
            }
        }
        let exponent = if exponent == i32::MIN { 0 } else { exponent };
        let mut fractions = fractions.into_iter();
        let mut unit = |number: &Number| {
            let (whole, k) = if let Some(value) = number.as_f64() {
                let (p, k) = split_f64(value);
                // Less than 2⁵³ times 2⁶⁴.
                (i128::from(p) * i128::from(odd), k)
            } else {
                let (p, m, k) = fractions.next()?;
                let factor = if m == odd { 1 } else { odd / m };
                match i64::try_from(p) {
                    Ok(short) => (i128::from(short) * i128::from(factor), k),
                    Err(_) => (p.checked_mul(i128::from(factor))?, k),
                }
            };
            let (width, shift) = (i128::BITS - whole.unsigned_abs().leading_zeros(), k + exponent);
            let held = whole == 0 || i64::from(width) + i64::from(shift) <= i64::from(bits);
            held.then(|| whole << shift.clamp(0, 126))
        };
        let mut units = Vec::with_capacity(count);
        for point in points {
            units.push(Vec3::new(unit(&point.x)?, unit(&point.y)?, unit(&point.z)?));
        }
        Some((Lattice { exponent, odd: odd.into(), small_odd: Some(odd) }, units))
    }

    /// The coarsest lattice that holds what either of two holds, and how many units of it one of each of these is, where the odd factors have at most 64
    /// bits and these numbers at most `bits` (at most 126).
    pub fn common(lattices: [&Lattice; 2], bits: u32) -> Option<(Lattice, [i128; 2])> {
        let [Some((odd, _)), Some((other, _))] = lattices.map(Lattice::small_factor) else { return None };
        let odd = if odd == other { odd } else { (odd / odd.gcd(&other)).checked_mul(other)? };
        let exponent = lattices[0].exponent.max(lattices[1].exponent);
        let [one, two] = lattices.map(|lattice| {
            let (factor, shift) = (i128::from(odd / lattice.small_odd?), (exponent - lattice.exponent) as u32);
            (i128::BITS - factor.leading_zeros() + shift <= bits).then(|| factor << shift)
        });
        Some((Lattice { exponent, odd: odd.into(), small_odd: Some(odd) }, [one?, two?]))
    }

    /// The lattice of the integers.
    pub fn unity() -> Lattice {
        Lattice::of_power_of_two(0)
    }

    /// The lattice with `2^exponent` units per metre.
    pub fn of_power_of_two(exponent: i32) -> Lattice {
        Lattice { exponent, odd: BigInt::one(), small_odd: Some(1) }
    }

    /// The odd p and the k of a lattice with `p · 2^k` units per metre; `None` where p is 2⁶⁴ or more.
    pub fn small_factor(&self) -> Option<(u64, i32)> {
        Some((self.small_odd?, self.exponent))
    }

    /// A k such that there are at most `2^k` units per metre.
    pub fn metre_bits(&self) -> i64 {
        i64::from(self.exponent) + if self.small_odd == Some(1) { 0 } else { self.odd.bits() as i64 }
    }

    /// `number` in lattice units. The number must be one of those the lattice was made for.
    pub fn units(&self, number: &Number) -> BigInt {
        if let Some(value) = number.as_f64() {
            let (significand, exponent) = split_f64(value);
            let shift = exponent + self.exponent;
            let scaled = BigInt::from(significand) * &self.odd;
            if significand == 0 || shift >= 0 { scaled << shift.max(0) as usize } else { scaled >> (-shift) as usize }
        } else if let Some(ratio) = number.as_ratio() {
            ((ratio.numer() * &self.odd) << self.exponent.max(0) as usize) / ratio.denom()
        } else {
            BigInt::ZERO
        }
    }

    /// `number` in lattice units if that has at most `bits` bits (at most 126).
    pub fn small_units(&self, number: &Number, bits: u32) -> Option<i128> {
        let units = match (number.as_f64(), self.small_odd) {
            (Some(value), Some(1)) => {
                let (significand, exponent) = split_f64(value);
                let shift = exponent + self.exponent;
                let width = 64 - significand.unsigned_abs().leading_zeros() as i32;
                if significand != 0 && shift + width > bits as i32 {
                    return None;
                }
                i128::from(significand) << shift.clamp(0, 126)
            }
            _ => self.units(number).to_i128()?,
        };
        (128 - units.unsigned_abs().leading_zeros() <= bits).then_some(units)
    }

    /// Lattice units per metre, as a fraction `(numerator, denominator)`.
    pub fn units_per_metre(&self) -> (BigInt, BigInt) {
        if self.exponent >= 0 {
            (&self.odd << self.exponent as usize, BigInt::one())
        } else {
            (self.odd.clone(), BigInt::one() << (-self.exponent) as usize)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;

    #[test]
    fn makes_every_number_an_integer() {
        let ratio = |n: i64, d: i64| Number::from_rational(BigRational::new(n.into(), d.into()));
        let numbers = [ratio(1, 3), ratio(-5, 14), ratio(3, 8), ratio(0, 1), ratio(1 << 40, 1)];
        let lattice = Lattice::covering(&numbers);
        let (numerator, denominator) = lattice.units_per_metre();
        for number in &numbers {
            let expected = number.to_rational() * BigRational::new(numerator.clone(), denominator.clone());
            assert!(expected.is_integer());
            assert_eq!(lattice.units(number), expected.to_integer());
            assert_eq!(lattice.small_units(number, 120).map(BigInt::from), Some(expected.to_integer()));
        }
        let above = lattice.metre_bits() as usize;
        assert!(numerator <= &denominator << above && numerator > &denominator << (above - 1));
        let covering = |numbers: &[Number], bits| {
            let points = numbers.iter().map(|n| Vec3::new(n.clone(), Number::ZERO, n.negated())).collect::<Vec<_>>();
            let (lattice, units) = Lattice::covering_points(points.iter(), bits)?;
            assert!(units.iter().all(|v| v.y == 0 && v.z == -v.x), "{units:?}");
            Some((lattice, units.iter().map(|v| v.x).collect::<Vec<i128>>()))
        };
        let units = numbers.iter().map(|number| lattice.small_units(number, 120)).collect::<Option<Vec<_>>>();
        let widest = units.iter().flatten().map(|u| 128 - u.unsigned_abs().leading_zeros()).max().unwrap();
        assert_eq!(covering(&numbers, widest), units.map(|units| (lattice, units)));
        assert_eq!(covering(&numbers, widest - 1), None);
        let coarse = [ratio(1 << 40, 1), ratio(3 << 41, 1)];
        let lattice = Lattice::covering(&coarse);
        assert_eq!(lattice.small_units(&coarse[1], 4), Some(6));
        assert_eq!(lattice.small_units(&coarse[1], 2), None);
        assert_eq!(covering(&coarse, 3), Some((lattice, vec![1, 6])));
        let (numbers, lattice) = ([ratio(0, 1), ratio(-3, 8)], Lattice::covering(&[ratio(3, 8)]));
        assert_eq!(covering(&numbers, 2), Some((lattice, vec![0, -3])));
        assert_eq!(covering(&numbers[..1], 2), Some((Lattice::unity(), vec![0])));
        assert_eq!(covering(&[ratio(1, (1 << 62) - 1), ratio(1, (1 << 61) - 1)], 126), None);
    }

    #[test]
    fn the_common_lattice_holds_what_either_holds() {
        let ratio = |n: i64, d: i64| Number::from_rational(BigRational::new(n.into(), d.into()));
        let numbers = [ratio(1, 3), ratio(5, 6), ratio(-1, 15), ratio(3, 8), ratio(1 << 40, 1), ratio(1, 1 << 40)];
        for one in &numbers {
            for other in &numbers {
                let [of_one, of_other] = [one, other].map(|number| Lattice::covering([number]));
                let (common, [factor, other_factor]) = Lattice::common([&of_one, &of_other], 120).unwrap();
                assert_eq!(common, Lattice::covering([one, other]));
                assert_eq!(common.units(one), of_one.units(one) * factor);
                assert_eq!(common.units(other), of_other.units(other) * other_factor);
            }
        }
        let [fine, coarse] = [&numbers[5], &numbers[4]].map(|number| Lattice::covering([number]));
        assert_eq!(Lattice::common([&fine, &coarse], 81).map(|found| found.1), Some([1, 1 << 80]));
        assert_eq!(Lattice::common([&fine, &coarse], 80), None);
        let [long, longer] = [61, 62].map(|digits| Lattice::covering([&ratio(1, (1 << digits) - 1)]));
        assert_eq!(Lattice::common([&long, &longer], 120), None);
    }
}
