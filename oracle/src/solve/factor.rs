//! The f64 Cholesky factor: proves a lower bound of the smallest eigenvalue, and corrects approximate solutions.

use super::{BlockSparseSystem, Support};
use crate::field::Field;
use crate::number::{UNDERFLOW, UNIT_ROUNDOFF};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// The factor of `A = D·K̃·D`, K̃ the f64 matrix next to K and D a diagonal of powers of two.
pub(crate) struct Factor {
    /// D by its exponents.
    scale: Vec<i32>,
    cholesky: Cholesky<f64, Dyn>,
    /// Proved: the smallest eigenvalue of `D·K·D` is at least this, and above zero.
    least_eigenvalue: f64,
}

/// How often a smaller shift is tried.
const TRIES: i32 = 8;
/// Scaling exponents beyond this leave f64; such a matrix is not factored.
const LARGEST_EXPONENT: i32 = 400;

impl Factor {
    /// Factors the matrix and proves it positive definite; `None` where f64 cannot.
    pub(crate) fn new<S: Field>(system: &BlockSparseSystem<S>) -> Option<Factor> {
        let scaled = Scaled::new(system)?;
        let cholesky = Cholesky::new(scaled.matrix.clone())?;
        let mut shift = 0.5 * smallest_eigenvalue(&cholesky, scaled.matrix.nrows());
        for _ in 0..TRIES {
            let least = shift - scaled.doubt;
            if least.is_nan() || least <= 0.0 {
                return None;
            }
            let mut shifted = scaled.matrix.clone();
            for i in 0..shifted.nrows() {
                shifted[(i, i)] -= shift;
            }
            if Cholesky::new(shifted).is_some() {
                return Some(Factor { scale: scaled.scale, cholesky, least_eigenvalue: least });
            }
            shift /= 8.0;
        }
        None
    }
}

impl Support for Factor {
    fn scale(&self) -> &[i32] {
        &self.scale
    }

    fn least_eigenvalue(&self) -> f64 {
        self.least_eigenvalue
    }

    fn approximate(&self, right: Vec<f64>) -> Vec<f64> {
        let mut vector = DVector::from_vec(right);
        self.cholesky.solve_mut(&mut vector);
        vector.as_slice().to_vec()
    }
}

/// The scaled f64 matrix and everything that separates its shifted factorisation from the exact matrix.
struct Scaled {
    scale: Vec<i32>,
    matrix: DMatrix<f64>,
    /// If the floating-point factorisation of `matrix − α·I` runs to its end, the smallest eigenvalue of `D·K·D` is at
    /// least `α − doubt` (docs/certified_solve.md).
    doubt: f64,
}

impl Scaled {
    fn new<S: Field>(system: &BlockSparseSystem<S>) -> Option<Scaled> {
        let n = system.unknowns();
        let mut scale = vec![0; n];
        for (row, column, value) in system.lower() {
            if row == column {
                let (middle, radius) = value.nearby();
                if !(middle > radius && middle.is_finite()) {
                    return None;
                }
                // A's diagonal comes to lie between 1 and 4.
                let exponent = middle.log2().floor() as i32;
                scale[row] = -exponent.div_euclid(2);
                if scale[row].abs() > LARGEST_EXPONENT {
                    return None;
                }
            }
        }
        let mut matrix = DMatrix::zeros(n, n);
        let mut spread = vec![0.0; n];
        for (row, column, value) in system.lower() {
            let (middle, radius) = value.nearby();
            let factor = 2f64.powi(scale[row] + scale[column]);
            let entry = middle * factor;
            let doubt = radius * factor + UNDERFLOW;
            if !(entry.is_finite() && doubt.is_finite()) {
                return None;
            }
            matrix[(row, column)] = entry;
            matrix[(column, row)] = entry;
            spread[row] += doubt;
            if row != column {
                spread[column] += doubt;
            }
        }
        let spread = spread.into_iter().fold(0.0, f64::max);
        let trace: f64 = (0..n).map(|i| matrix[(i, i)]).sum();
        let many = (n + 4) as f64;
        let doubt = (2.0 * many * UNIT_ROUNDOFF * trace + spread + 8.0 * UNIT_ROUNDOFF)
            * (1.0 + 4.0 * many * f64::EPSILON)
            + many * many * UNDERFLOW;
        Some(Scaled { scale, matrix, doubt })
    }
}

/// The smallest eigenvalue as a few inverse iterations see it: a guess.
fn smallest_eigenvalue(cholesky: &Cholesky<f64, Dyn>, n: usize) -> f64 {
    // No symmetry of the model can make this orthogonal to what is sought for long.
    let mut vector = DVector::from_fn(n, |i, _| 1.0 + 0.37 * ((i * i + 3 * i) % 7) as f64);
    let mut guess = 0.0;
    for _ in 0..4 {
        vector /= vector.norm();
        cholesky.solve_mut(&mut vector);
        guess = 1.0 / vector.norm();
    }
    guess
}
