//! Solving in a scalar with bounds on its errors: an approximate solution by a factor in f64, corrected in the scalar, and a proved bound of what it is off by.
//!
//! Elimination in the scalar itself takes some n³/6 products, this takes as many as the matrix has entries, a few times over. With a scaling D by powers of
//! two and `r = F − K·x̂`, `|x_i − x̂_i| ≤ D_ii·‖D·r‖₂/λ`, where λ is not above the smallest eigenvalue of `D·K·D`. That one is proved by a factor in f64 (S. M. Rump,
//! *Verification of positive definiteness*, BIT 46, 2006): where Cholesky's method runs to its end on a matrix B of n unknowns, in whichever order its sums
//! are taken, B has no eigenvalue below `−γ·tr B`, γ a little above (n + 1)·2⁻⁵³. Of each part of the system that nothing ties to others the norm is its own.

#[cfg(test)]
mod tests;

use crate::dynamics::island::Ties;
use crate::real::Real;
use rockproof_cholesky::{Pattern, PatternEntry, Scalar, Threads};

/// A scalar that is a middle and a radius.
pub(crate) trait Enclosing: Real {
    /// Not below the radius.
    fn radius_bound(self) -> f64;

    /// The middle, with another radius.
    #[must_use]
    fn with_radius(self, radius: f64) -> Self;

    /// Whether it is zero, and no operation that led here rounded.
    fn is_exact_zero(self) -> bool;
}

const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
/// Makes up for the roundings of a few operations with bounds.
const MORE: f64 = 1.0 + 16.0 * f64::EPSILON;
/// Likewise, downwards.
const LESS: f64 = 1.0 - 16.0 * f64::EPSILON;
/// More than underflow takes away in a few operations.
const UNDERFLOW: f64 = f64::MIN_POSITIVE;
/// Scalings beyond these are not tried.
const LARGEST_EXPONENT: i32 = 400;
/// A pass gains some 40 bits of the 512 that there are at most; where it gains less than one it is the last.
const PASSES: usize = 64;

/// Encloses the solution, in place. The values are those of the matrix. `None` where f64 does not prove that it is positive definite; then the right side is
/// as it was.
pub(super) fn solve_enclosed<R: Enclosing>(pattern: &Pattern, values: &[R], rhs: &mut [R]) -> Option<()> {
    if !rhs.iter().all(|force| force.is_finite()) {
        return None;
    }
    let system = FloatSystem::new(pattern, values)?;
    let scale = |i: usize| 2f64.powi(system.scale[i]);
    let entries: Vec<(PatternEntry, R)> = pattern
        .entries()
        .map(|entry| (entry, values[entry.place]))
        .filter(|(_, value)| !value.is_exact_zero())
        .collect();
    let residual = |x: &[R]| {
        let mut left = rhs.to_vec();
        for &(PatternEntry { row, column, .. }, value) in &entries {
            left[row] = left[row] - value * x[column];
            if row != column {
                left[column] = left[column] - value * x[row];
            }
        }
        left
    };
    let mut x = vec![R::ZERO; rhs.len()];
    let mut left = rhs.to_vec();
    let mut size = ScaledNorm::of(&left, scale);
    for _ in 0..PASSES {
        if size.middle <= size.radius || !size.middle.is_finite() {
            break;
        }
        let unit = 2f64.powi(size.middle.log2().floor() as i32);
        let mut correction: Vec<f64> = left.iter().enumerate().map(|(i, r)| r.to_f64() * scale(i) / unit).collect();
        Scalar::substitute(pattern, &system.factor, &mut correction, Threads::One);
        let corrected = |(i, (x, y)): (usize, (&R, &f64))| {
            let by = y * scale(i) * unit;
            by.is_finite().then(|| (*x + R::from_f64(by)).with_radius(0.0))
        };
        let next: Vec<R> = x.iter().zip(&correction).enumerate().map(corrected).collect::<Option<_>>()?;
        let next_left = residual(&next);
        let next_size = ScaledNorm::of(&next_left, scale);
        let helps = next_size.middle <= size.middle / 2.0;
        if next_size.bound() < size.bound() {
            (x, left, size) = (next, next_left, next_size);
        }
        if !helps {
            break;
        }
    }
    // Parts that nothing ties together are systems of their own. One on which no force acts does not move, exactly.
    let mut parts = vec![Vec::new(); rhs.len()];
    let mut ties = Ties::none(rhs.len());
    entries.iter().for_each(|(entry, _)| ties.tie(entry.row as u32, entry.column as u32));
    for unknown in 0..rhs.len() {
        parts[ties.lowest(unknown as u32) as usize].push(unknown);
    }
    let mut solution = vec![R::ZERO; rhs.len()];
    for part in parts.into_iter().filter(|part| !part.iter().all(|&i| rhs[i].is_exact_zero())) {
        let own: Vec<R> = part.iter().map(|&i| left[i]).collect();
        let bound = ScaledNorm::of(&own, |k| scale(part[k])).bound() / system.least * MORE;
        if !bound.is_finite() {
            return None;
        }
        for i in part {
            solution[i] = x[i].with_radius(bound * scale(i) * MORE + UNDERFLOW);
        }
    }
    rhs.copy_from_slice(&solution);
    Some(())
}

/// Not below the norm of the middles and of the radii of a vector, scaled.
#[derive(Clone, Copy)]
struct ScaledNorm {
    middle: f64,
    radius: f64,
}

impl ScaledNorm {
    fn of<R: Enclosing>(vector: &[R], scale: impl Fn(usize) -> f64) -> ScaledNorm {
        let sized = |size: &dyn Fn(R) -> f64| {
            let all = || vector.iter().enumerate().map(|(i, &value)| size(value) * scale(i) * MORE + UNDERFLOW);
            // What is far below f64's least number when squared must not be lost.
            let unit = all().fold(UNDERFLOW, |most: f64, size| if size <= most { most } else { size });
            let sum: f64 = all().map(|size| (size / unit) * (size / unit)).sum();
            unit * sum.sqrt() * (1.0 + (vector.len() + 16) as f64 * f64::EPSILON)
        };
        // The nearest f64 is within a unit in the last place, and the scaling may be large where that is next to nothing.
        let middle = |value: R| if value.is_exact_zero() { 0.0 } else { value.to_f64().abs() * MORE + UNDERFLOW };
        ScaledNorm { middle: sized(&middle), radius: sized(&R::radius_bound) }
    }

    fn bound(self) -> f64 {
        (self.middle + self.radius) * MORE
    }
}

/// What f64 knows of a matrix.
struct FloatSystem {
    /// The exponents of D: the diagonal of `A`, the matrix `D·K·D` in f64, lies between 1 and 4.
    scale: Vec<i32>,
    /// The factor of A.
    factor: Vec<f64>,
    /// Not above the smallest eigenvalue of `D·K·D`, and above zero.
    least: f64,
}

impl FloatSystem {
    /// `None` where no bound above zero is proved.
    fn new<R: Enclosing>(pattern: &Pattern, values: &[R]) -> Option<FloatSystem> {
        let n = pattern.size();
        let mut scale = vec![0i32; n];
        for PatternEntry { row, place, .. } in pattern.entries().filter(|entry| entry.row == entry.column) {
            let value = values[place].to_f64();
            if !(value > 0.0 && value.is_finite()) {
                return None;
            }
            scale[row] = -(value.log2().floor() as i32).div_euclid(2);
            if scale[row].abs() > LARGEST_EXPONENT {
                return None;
            }
        }
        let mut matrix = vec![0.0; values.len()];
        // By row, how far the entries of A may be from those of D·K·D.
        let mut doubts = vec![0.0; n];
        let mut trace = 0.0;
        for PatternEntry { row, column, place } in pattern.entries() {
            let value = values[place];
            let factor = 2f64.powi(scale[row] + scale[column]);
            let entry = value.to_f64() * factor;
            let doubt = (entry.abs() * f64::EPSILON + value.radius_bound() * factor) * MORE + UNDERFLOW;
            matrix[place] = entry;
            doubts[row] += doubt;
            if row == column {
                trace += entry;
            } else {
                doubts[column] += doubt;
            }
        }
        if !doubts.iter().all(|doubt: &f64| doubt.is_finite()) {
            return None;
        }
        let many = (n + 4) as f64;
        let doubt = doubts.into_iter().fold(0.0, f64::max);
        let doubt = (2.0 * many * UNIT_ROUNDOFF * trace + doubt + 8.0 * UNIT_ROUNDOFF)
            * (1.0 + 4.0 * many * f64::EPSILON)
            + many * many * UNDERFLOW;
        let factor = factored(pattern, &matrix)?;
        let guess = smallest_eigenvalue(pattern, &factor, n);
        let mut shift = guess / 2.0;
        while shift > 2.0 * doubt {
            let mut shifted = matrix.clone();
            for PatternEntry { place, .. } in pattern.entries().filter(|entry| entry.row == entry.column) {
                shifted[place] -= shift;
            }
            if factored(pattern, &shifted).is_some() {
                return Some(FloatSystem { scale, factor, least: (shift - doubt) * LESS });
            }
            shift /= 8.0;
        }
        None
    }
}

/// The factor of a matrix; `None` where Cholesky's method does not run to its end.
fn factored(pattern: &Pattern, matrix: &[f64]) -> Option<Vec<f64>> {
    let mut values = vec![0.0; matrix.len()];
    let fill = |panel: usize, own: &mut [f64]| own.copy_from_slice(&matrix[pattern.range(panel)]);
    Scalar::factor(pattern, &mut values, &vec![true; pattern.panel_count()], &fill, Threads::One).ok()?;
    Some(values)
}

/// The smallest eigenvalue as a few inverse iterations see it: a guess.
fn smallest_eigenvalue(pattern: &Pattern, factor: &[f64], n: usize) -> f64 {
    // No symmetry of a model can make this orthogonal to what is sought for long.
    let mut vector: Vec<f64> = (0..n).map(|i| 1.0 + 0.37 * ((i * i + 3 * i) % 7) as f64).collect();
    let mut guess = 0.0;
    for _ in 0..4 {
        let norm = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        vector.iter_mut().for_each(|x| *x /= norm);
        Scalar::substitute(pattern, factor, &mut vector, Threads::One);
        guess = 1.0 / vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    }
    guess
}
