//! The public face of the certified solver: a system of fractions, enclosures on demand, the exact solution on demand.

use super::{BlockSparseSystem, Factor, Solvable, fraction_free};
use crate::field::{Field, WideBall};
use crate::number::Ball;
use num_rational::BigRational;
use num_traits::Signed;
use std::fmt;

/// An unknown between `middle − radius` and `middle + radius`; both are dyadic fractions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Enclosed {
    /// The middle of the enclosure.
    pub middle: BigRational,
    /// At least the distance of the exact value from the middle.
    pub radius: BigRational,
}

impl Enclosed {
    /// Whether the enclosure holds `value`; **its ends belong to it**.
    pub fn holds(&self, value: &BigRational) -> bool {
        (value - &self.middle).abs() <= self.radius
    }
}

/// Why a system has no certified solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolveError {
    /// The matrix is not square, or the right side has another length.
    Shape,
    /// The matrix is not symmetric.
    NotSymmetric,
    /// The matrix is not positive definite: exactly so, or as far as the cap of bits could tell.
    NotPositiveDefinite,
    /// The enclosure is wider than asked for, although the cap of bits was reached.
    Bits {
        /// The cap.
        cap: u32,
    },
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SolveError::Shape => write!(f, "the matrix must be square, and the right side as long as it"),
            SolveError::NotSymmetric => write!(f, "the matrix is not symmetric"),
            SolveError::NotPositiveDefinite => write!(f, "the matrix is not positive definite"),
            SolveError::Bits { cap } => write!(f, "{cap} bits do not narrow the solution as far as asked"),
        }
    }
}

impl std::error::Error for SolveError {}

/// A symmetric positive definite system `K·x = F` of fractions.
///
/// ```
/// use num_rational::BigRational;
/// use rockproof_oracle::solve::SpdSystem;
/// let q = |n: i64, d: i64| BigRational::new(n.into(), d.into());
/// let system = SpdSystem::new(vec![vec![q(2, 1), q(1, 3)], vec![q(1, 3), q(1, 1)]], vec![q(1, 1), q(0, 1)]).unwrap();
/// let exact = system.exact().unwrap();
/// assert_eq!(exact, [q(9, 17), q(-3, 17)]);
/// let narrow = system.enclosure(200).unwrap();
/// assert!(narrow.iter().zip(&exact).all(|(x, exact)| x.holds(exact) && x.radius < q(1, 1 << 62)));
/// ```
#[derive(Debug)]
pub struct SpdSystem {
    exact: BlockSparseSystem<BigRational>,
}

impl SpdSystem {
    /// Most bits an enclosure is worked out with.
    pub const MAX_BITS: u32 = 16_384;

    /// The system with this matrix, row by row, and this right side.
    ///
    /// # Errors
    /// When the matrix is not square and symmetric, or the right side has another length.
    pub fn new(matrix: Vec<Vec<BigRational>>, right: Vec<BigRational>) -> Result<SpdSystem, SolveError> {
        let n = right.len();
        if matrix.len() != n || matrix.iter().any(|row| row.len() != n) {
            return Err(SolveError::Shape);
        }
        if (0..n).any(|i| (0..i).any(|j| matrix[i][j] != matrix[j][i])) {
            return Err(SolveError::NotSymmetric);
        }
        let mut exact = BlockSparseSystem::zero(&[n]);
        exact.add(0, 0, |row, column| matrix[row][column].clone());
        exact.right = right;
        Ok(SpdSystem { exact })
    }

    /// The enclosure that f64 alone gives; `None` where f64 cannot prove the matrix definite.
    pub fn float_enclosure(&self) -> Option<Vec<Enclosed>> {
        let system = self.rounded::<Ball>(53);
        let factor = Factor::new(&system)?;
        Ball::solve(&system, Some(&factor), 53)?.iter().map(enclosed).collect()
    }

    /// An enclosure whose radius is at most `2^−bits` of the largest unknown.
    ///
    /// # Errors
    /// When the matrix is not positive definite, or [`SpdSystem::MAX_BITS`] bits are not enough.
    pub fn enclosure(&self, bits: u32) -> Result<Vec<Enclosed>, SolveError> {
        let factor = Factor::new(&self.rounded::<Ball>(53));
        let mut working = bits + 64;
        let mut definite = factor.is_some();
        while working <= Self::MAX_BITS {
            if let Some(solution) = WideBall::solve(&self.rounded(working), factor.as_ref(), working) {
                definite = true;
                let largest = solution.iter().map(WideBall::size).max();
                let widest = solution.iter().map(WideBall::spread).max();
                if widest.zip(largest).is_none_or(|(widest, largest)| widest.shifted(i64::from(bits)) <= largest) {
                    return Ok(solution.iter().filter_map(enclosed).collect());
                }
            }
            working *= 2;
        }
        Err(if definite { SolveError::Bits { cap: Self::MAX_BITS } } else { SolveError::NotPositiveDefinite })
    }

    /// The exact solution.
    ///
    /// # Errors
    /// When the matrix is singular. (Whether it is definite plays no part here.)
    pub fn exact(&self) -> Result<Vec<BigRational>, SolveError> {
        fraction_free::solve(&self.exact.dense(), &self.exact.right).ok_or(SolveError::NotPositiveDefinite)
    }

    /// The system as a step assembles it.
    pub(crate) fn of_blocks(system: BlockSparseSystem<BigRational>) -> SpdSystem {
        let n = system.unknowns();
        let dense = system.dense();
        let mut exact = BlockSparseSystem::zero(&[n]);
        exact.add(0, 0, |row, column| dense[row][column].clone());
        exact.right = system.right;
        SpdSystem { exact }
    }

    /// The exact solution by Gaussian elimination in fractions, with no thought of speed: to compare with.
    ///
    /// # Errors
    /// When a pivot is not positive: the matrix is not definite.
    pub fn plainly(&self) -> Result<Vec<BigRational>, SolveError> {
        super::eliminate(&self.exact).ok_or(SolveError::NotPositiveDefinite)
    }

    fn rounded<S: Field>(&self, bits: u32) -> BlockSparseSystem<S> {
        let n = self.exact.unknowns();
        let dense = self.exact.dense();
        let mut system = BlockSparseSystem::zero(&[n]);
        system.add(0, 0, |row, column| {
            if Field::is_zero(&dense[row][column]) { S::from_i32(0) } else { S::of_rational(&dense[row][column], bits) }
        });
        system.right = self.exact.right.iter().map(|value| S::of_rational(value, bits)).collect();
        system
    }
}

fn enclosed<S: Field>(value: &S) -> Option<Enclosed> {
    Some(Enclosed { middle: value.middle(), radius: value.radius()?.to_rational() })
}
