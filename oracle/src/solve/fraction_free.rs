//! The exact solution by elimination without fractions (E. H. Bareiss, 1968).

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};
use rockproof_model::fraction::{common_multiple, lowest};

/// The exact solution of `rows · x = right`; `None` where the matrix is singular.
///
/// Each row is first multiplied by the common denominator of its entries. In Bareiss's elimination every division is
/// without remainder, and every intermediate value is a minor of the matrix, so numbers grow no faster than
/// determinants do, and no greatest common divisor is taken before the end.
pub(crate) fn solve(rows: &[Vec<BigRational>], right: &[BigRational]) -> Option<Vec<BigRational>> {
    let n = right.len();
    let mut a: Vec<Vec<BigInt>> = rows.iter().zip(right).map(|(row, right)| integers(row, right)).collect();
    let mut previous = BigInt::one();
    for pivot in 0..n {
        let found = (pivot..n).find(|&row| !a[row][pivot].is_zero())?;
        a.swap(pivot, found);
        let (above, below) = a.split_at_mut(pivot + 1);
        let top = &above[pivot];
        for row in below {
            for column in pivot + 1..=n {
                let cross = &row[pivot] * &top[column];
                row[column] = (&row[column] * &top[pivot] - cross) / &previous;
            }
            row[pivot] = BigInt::zero();
        }
        previous = a[pivot][pivot].clone();
    }
    // Cramer's numerators over one determinant: x_i = y_i / det, all y_i integers.
    let determinant = previous;
    let mut y = vec![BigInt::zero(); n];
    for row in (0..n).rev() {
        let mut sum = &a[row][n] * &determinant;
        for column in row + 1..n {
            if !a[row][column].is_zero() {
                sum -= &a[row][column] * &y[column];
            }
        }
        y[row] = sum / &a[row][row];
    }
    Some(y.into_iter().map(|y| lowest(y, determinant.clone())).collect())
}

/// A row and its right side times their common denominator.
fn integers(row: &[BigRational], right: &BigRational) -> Vec<BigInt> {
    let all = || row.iter().chain([right]);
    let common = all().fold(BigInt::one(), |common, value| common_multiple(&common, value.denom()));
    all().map(|value| value.numer() * (&common / value.denom())).collect()
}
