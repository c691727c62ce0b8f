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

/// The same of a matrix that is **known to be symmetric and definite**: unknowns that do not meet in it are solved apart, and those on which nothing
/// acts are zero.
pub(crate) fn solve_by_parts(rows: &[Vec<BigRational>], right: &[BigRational]) -> Option<Vec<BigRational>> {
    let mut solution = vec![BigRational::zero(); right.len()];
    let mut is_placed = vec![false; right.len()];
    for first in 0..right.len() {
        if is_placed[first] {
            continue;
        }
        let mut part = vec![first];
        is_placed[first] = true;
        let mut looked_at = 0;
        while let Some(&row) = part.get(looked_at) {
            for column in (0..right.len()).filter(|&column| !rows[row][column].is_zero()) {
                if !std::mem::replace(&mut is_placed[column], true) {
                    part.push(column);
                }
            }
            looked_at += 1;
        }
        if part.iter().all(|&row| right[row].is_zero()) {
            continue;
        }
        part.sort_unstable();
        let own: Vec<Vec<BigRational>> =
            part.iter().map(|&row| part.iter().map(|&column| rows[row][column].clone()).collect()).collect();
        let acting: Vec<BigRational> = part.iter().map(|&row| right[row].clone()).collect();
        for (&row, value) in part.iter().zip(solve(&own, &acting)?) {
            solution[row] = value;
        }
    }
    Some(solution)
}

/// A row and its right side times their common denominator.
fn integers(row: &[BigRational], right: &BigRational) -> Vec<BigInt> {
    let all = || row.iter().chain([right]);
    let common = all().fold(BigInt::one(), |common, value| common_multiple(&common, value.denom()));
    all().map(|value| value.numer() * (&common / value.denom())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unknowns 0 and 3 meet, 1 meets 4 and 4 meets 2, and 5 is alone.
    const MATRIX: [[i64; 6]; 6] = [
        [2, 0, 0, 1, 0, 0],
        [0, 3, 0, 0, 1, 0],
        [0, 0, 5, 0, -2, 0],
        [1, 0, 0, 5, 0, 0],
        [0, 1, -2, 0, 4, 0],
        [0, 0, 0, 0, 0, 7],
    ];

    fn whole(values: &[i64]) -> Vec<BigRational> {
        values.iter().map(|&value| BigRational::from_integer(value.into())).collect()
    }

    #[test]
    fn parts_that_do_not_meet_are_solved_as_the_whole_is() {
        let rows: Vec<Vec<BigRational>> = MATRIX.iter().map(|row| whole(row)).collect();
        // Something acts on the last unknown of a part, on its middle one, on two parts, on the one that is alone, on none, on all.
        for right in
            [[0, 0, 0, 4, 0, 0], [0, 0, 0, 0, 9, 0], [1, 0, 2, 0, 0, 0], [0, 0, 0, 0, 0, 1], [0; 6], [1, 2, 3, 4, 5, 6]]
        {
            let right = whole(&right);
            assert_eq!(solve_by_parts(&rows, &right), solve(&rows, &right), "{right:?}");
        }
        // 2a + d = 0 and a + 5d = 9.
        let parts = solve_by_parts(&rows, &whole(&[0, 0, 0, 9, 0, 14])).unwrap();
        assert_eq!(parts, whole(&[-1, 0, 0, 2, 0, 2]));
    }
}
