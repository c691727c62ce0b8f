//! Solving `K d = F`: dense Cholesky for small systems, by panels for large ones.

use crate::double::Double;
use crate::dynamics::compiled::CompiledSteps;
use crate::dynamics::enclosed_solve::solve_enclosed;
use crate::real::Real;
use crate::wide::Wide;
use rockproof_cholesky::{Fill, Pattern, Scalar, Singular, Threads};

/// Systems of up to this many unknowns are solved as dense ones, by sums in an order of our own: the same bits on every machine.
/// Larger ones take fused products where the processor has them (`rockproof_cholesky`), so last bits may differ between processors with and without.
pub const DENSE: usize = 96;

/// Systems of which the factor takes so many multiplications or more for each of its values, about, are very large: see
/// [`Solve::USES_CONJUGATE_GRADIENTS`]. A factor in f32 takes about half of the multiplications' time away, and brings two and a half substitutions more, which take time
/// by the values.
pub const CONJUGATE_GRADIENTS_FROM: u64 = 500;

/// A scalar in which systems can be solved.
pub trait Solve: CompiledSteps + Real + Send + Sync {
    /// Whether large systems can be solved by conjugate gradients to this scalar's precision: by a factor in f32, or without a factor.
    const USES_CONJUGATE_GRADIENTS: bool;

    /// Gives the panels that are marked the values of the factor. All others have them already, and depend on none that is marked. `fill`
    /// adds the values of the matrix to those of a panel, which are zero.
    ///
    /// # Errors
    /// When the matrix is not positive definite in this precision.
    fn factorize(
        pattern: &Pattern,
        values: &mut [Self],
        marked: &[bool],
        fill: &Fill<'_, Self>,
    ) -> Result<(), Singular>;

    /// Solves a small system in place. The values are those of the matrix, and stay.
    ///
    /// # Errors
    /// When the matrix is not positive definite in this precision.
    fn solve_small(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular> {
        dense(pattern, values, rhs)
    }

    /// Solves in place by what [`Solve::factorize`] left.
    ///
    /// # Errors
    /// When the matrix is not positive definite in this precision.
    fn substitute(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular>;
}

macro_rules! solve_by_panels {
    ($type:ty, $refines:literal) => {
        impl Solve for $type {
            const USES_CONJUGATE_GRADIENTS: bool = $refines;

            fn factorize(
                pattern: &Pattern,
                values: &mut [Self],
                marked: &[bool],
                fill: &Fill<'_, Self>,
            ) -> Result<(), Singular> {
                Scalar::factor(pattern, values, marked, fill, Threads::Shared)
            }

            fn substitute(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular> {
                Scalar::substitute(pattern, values, rhs, Threads::Shared);
                Ok(())
            }
        }
    };
}

solve_by_panels!(f32, false);
solve_by_panels!(f64, true);

/// Of a scalar with bounds on its errors: the values stay those of the matrix.
macro_rules! solve_without_zeros {
    ($type:ty) => {
        impl Solve for $type {
            const USES_CONJUGATE_GRADIENTS: bool = false;

            fn factorize(
                pattern: &Pattern,
                values: &mut [Self],
                marked: &[bool],
                fill: &Fill<'_, Self>,
            ) -> Result<(), Singular> {
                for panel in (0..marked.len()).filter(|&panel| marked[panel]) {
                    let own = &mut values[pattern.range(panel)];
                    own.fill(Self::ZERO);
                    fill(panel, own);
                }
                Ok(())
            }

            fn solve_small(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular> {
                dense_without(Self::is_exact_zero, pattern, values, rhs)
            }

            fn substitute(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular> {
                match solve_enclosed(pattern, values, rhs) {
                    Some(()) => Ok(()),
                    None => dense_without(Self::is_exact_zero, pattern, values, rhs),
                }
            }
        }
    };
}

solve_without_zeros!(Double);
solve_without_zeros!(Wide);

/// Solves in place, by Cholesky's method without square roots (LDLᵀ), row by row. The values are those of the matrix.
///
/// # Errors
/// When a pivot is not positive and finite.
pub fn dense<R: Real>(pattern: &Pattern, values: &[R], rhs: &mut [R]) -> Result<(), Singular> {
    dense_without(|_| false, pattern, values, rhs)
}

/// [`dense`], in which no product is formed with numbers that are left out. Where these are exact zeros, digits and radii are the same: such a product
/// adds neither to a middle nor to a radius. Blocks that do not touch leave many.
fn dense_without<R: Real>(
    is_left_out: impl Fn(R) -> bool,
    pattern: &Pattern,
    values: &[R],
    rhs: &mut [R],
) -> Result<(), Singular> {
    let n = pattern.size();
    let mut l = pattern.square(values, R::ZERO);
    let less = |sum: R, l: R, x: R| if is_left_out(l) || is_left_out(x) { sum } else { sum - l * x };
    // The first column of each row that is not left out.
    let firsts: Vec<usize> =
        (0..n).map(|i| l[i * n..i * n + i].iter().position(|&l| !is_left_out(l)).unwrap_or(i)).collect();
    let mut scaled = vec![R::ZERO; n];
    let mut pivots: Vec<R> = Vec::with_capacity(n);
    for i in 0..n {
        let (above, own) = l.split_at_mut(i * n);
        let first = firsts[i];
        for j in first..i {
            let from = first.max(firsts[j]);
            let row = &above[j * n + from..j * n + j];
            // scaled[j] is l_ij·d_j.
            scaled[j] = row.iter().zip(&scaled[from..j]).fold(own[j], |sum, (&l, &s)| less(sum, l, s));
        }
        let mut pivot = own[i];
        for j in first..i {
            if is_left_out(scaled[j]) {
                own[j] = R::ZERO;
            } else {
                own[j] = scaled[j] / pivots[j];
                pivot = pivot - own[j] * scaled[j];
            }
        }
        if !(R::ZERO.below(pivot) && pivot.is_finite()) {
            return Err(Singular { unknown: i });
        }
        pivots.push(pivot);
    }
    for i in 0..n {
        let row = l[i * n + firsts[i]..i * n + i].iter();
        rhs[i] = row.zip(&rhs[firsts[i]..i]).fold(rhs[i], |sum, (&l, &x)| less(sum, l, x));
    }
    for i in 0..n {
        rhs[i] = rhs[i] / pivots[i];
    }
    for i in (0..n).rev() {
        let known = rhs[i];
        for (x, &l) in rhs[firsts[i]..i].iter_mut().zip(&l[i * n + firsts[i]..i * n + i]) {
            *x = less(*x, l, known);
        }
    }
    Ok(())
}
