//! Solving `K d = F`: dense Cholesky for small systems, sparse for large ones.

use crate::stepper::real::Real;
use crate::stepper::wide::Wide;
use faer::Side;
use faer::linalg::solvers::Solve as _;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use std::collections::HashMap;

/// Systems of up to this many unknowns are solved as dense ones, by sums in an order of our own: the same bits on every machine.
/// Larger ones take the fastest kernels that the processor has, whose last bits may differ from machine to machine.
pub const DENSE: usize = 96;

/// The lower triangle of a symmetric matrix by columns; row numbers ascend within a column and begin with the diagonal.
#[derive(Clone, Debug)]
pub struct Lower<R> {
    /// Where each column begins in `rows`, and where the last ends.
    pub columns: Vec<u32>,
    /// Row numbers.
    pub rows: Vec<u32>,
    /// Values.
    pub values: Vec<R>,
}

impl<R> Lower<R> {
    /// The number of unknowns.
    pub fn size(&self) -> usize {
        self.columns.len().saturating_sub(1)
    }
}

/// Orderings and patterns of factors, kept from solve to solve while the pattern stays the same.
#[derive(Clone, Debug, Default)]
pub struct Patterns {
    known: HashMap<Vec<u32>, (SymbolicLlt<u32>, bool)>,
}

impl Patterns {
    /// Forgets patterns that were not used since the last call.
    pub fn forget_unused(&mut self) {
        self.known.retain(|_, (_, used)| std::mem::take(used));
    }

    fn of<R>(&mut self, matrix: &Lower<R>) -> Option<SymbolicLlt<u32>> {
        let mut key = Vec::with_capacity(matrix.columns.len() + matrix.rows.len());
        key.extend_from_slice(&matrix.columns);
        key.extend_from_slice(&matrix.rows);
        if let Some((symbolic, used)) = self.known.get_mut(&key) {
            *used = true;
            return Some(symbolic.clone());
        }
        let symbolic = SymbolicLlt::try_new(pattern(matrix), Side::Lower).ok()?;
        self.known.insert(key, (symbolic.clone(), true));
        Some(symbolic)
    }
}

fn pattern<R>(matrix: &Lower<R>) -> SymbolicSparseColMatRef<'_, u32> {
    SymbolicSparseColMatRef::new_checked(matrix.size(), matrix.size(), &matrix.columns, None, &matrix.rows)
}

/// A pivot that is not positive and finite: the system is singular, or became so by rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular {
    /// The unknown, where it is known.
    pub unknown: usize,
}

/// A scalar in which systems can be solved.
pub trait Solve: Real + Send + Sync {
    /// Solves in place a system too large for [`dense`].
    ///
    /// # Errors
    /// When the matrix is not positive definite in this precision.
    fn sparse(matrix: &Lower<Self>, rhs: &mut [Self], patterns: &mut Patterns) -> Result<(), Singular>;
}

macro_rules! solve_by_faer {
    ($type:ty) => {
        impl Solve for $type {
            fn sparse(matrix: &Lower<Self>, rhs: &mut [Self], patterns: &mut Patterns) -> Result<(), Singular> {
                let singular = Singular { unknown: 0 };
                let symbolic = patterns.of(matrix).ok_or(singular)?;
                let values = SparseColMatRef::new(pattern(matrix), &matrix.values);
                let factor = Llt::try_new_with_symbolic(symbolic, values, Side::Lower).map_err(|_| singular)?;
                factor.solve_in_place(faer::ColMut::from_slice_mut(rhs).as_mat_mut());
                Ok(())
            }
        }
    };
}

solve_by_faer!(f32);
solve_by_faer!(f64);

impl Solve for Wide {
    fn sparse(matrix: &Lower<Self>, rhs: &mut [Self], _: &mut Patterns) -> Result<(), Singular> {
        dense(matrix, rhs)
    }
}

/// Solves in place, by Cholesky's method without square roots (LDLᵀ), row by row.
///
/// # Errors
/// When a pivot is not positive and finite.
pub fn dense<R: Real>(matrix: &Lower<R>, rhs: &mut [R]) -> Result<(), Singular> {
    let n = matrix.size();
    let mut l = vec![R::ZERO; n * n];
    for column in 0..n {
        for k in matrix.columns[column] as usize..matrix.columns[column + 1] as usize {
            l[matrix.rows[k] as usize * n + column] = matrix.values[k];
        }
    }
    let mut scaled = vec![R::ZERO; n];
    let mut pivots: Vec<R> = Vec::with_capacity(n);
    for i in 0..n {
        let (above, own) = l.split_at_mut(i * n);
        for j in 0..i {
            let row = &above[j * n..j * n + j];
            // scaled[j] is l_ij·d_j.
            scaled[j] = row.iter().zip(&scaled[..j]).fold(own[j], |sum, (&l, &s)| sum - l * s);
        }
        let mut pivot = own[i];
        for j in 0..i {
            own[j] = scaled[j] / pivots[j];
            pivot = pivot - own[j] * scaled[j];
        }
        if !(R::ZERO.below(pivot) && pivot.is_finite()) {
            return Err(Singular { unknown: i });
        }
        pivots.push(pivot);
    }
    for i in 0..n {
        let sum = l[i * n..i * n + i].iter().zip(&rhs[..i]).fold(rhs[i], |sum, (&l, &x)| sum - l * x);
        rhs[i] = sum;
    }
    for i in 0..n {
        rhs[i] = rhs[i] / pivots[i];
    }
    for i in (0..n).rev() {
        let known = rhs[i];
        for (x, &l) in rhs[..i].iter_mut().zip(&l[i * n..i * n + i]) {
            *x = *x - l * known;
        }
    }
    Ok(())
}
