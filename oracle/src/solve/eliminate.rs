//! Symmetric elimination in any number type: the way out where f64 cannot prove a matrix definite.

use super::BlockSparseSystem;
use crate::field::Field;
use rockproof_model::Sign;

/// The solution, by Gaussian elimination without pivoting; `None` where a pivot is not certainly above zero.
///
/// In balls every step encloses the exact step, so the result encloses the exact solution, and pivots above zero prove
/// the matrix positive definite (they are the quotients of its leading minors).
pub(crate) fn eliminate<S: Field>(system: &BlockSparseSystem<S>) -> Option<Vec<S>> {
    let n = system.unknowns();
    let (mut rows, mut right) = (system.dense(), system.right.clone());
    for pivot in 0..n {
        if rows[pivot][pivot].certain_sign() != Some(Sign::Positive) {
            return None;
        }
        for row in pivot + 1..n {
            if rows[pivot][row].is_zero() {
                continue;
            }
            let factor = rows[pivot][row].over(&rows[pivot][pivot])?;
            let (above, below) = rows.split_at_mut(row);
            for (entry, top) in below[0][row..].iter_mut().zip(&above[pivot][row..]) {
                *entry = entry.minus(&factor.times(top));
            }
            right[row] = right[row].minus(&factor.times(&right[pivot]));
        }
    }
    for row in (0..n).rev() {
        for column in row + 1..n {
            right[row] = right[row].minus(&rows[row][column].times(&right[column]));
        }
        right[row] = right[row].over(&rows[row][row])?;
    }
    Some(right)
}
