//! Solving `K d = F`: dense Cholesky for small systems, sparse for large ones.

use crate::stepper::real::Real;
use crate::stepper::wide::Wide;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Par, Side};

/// Systems of up to this many unknowns are solved as dense ones, by sums in an order of our own: the same bits on every machine.
/// Larger ones take the fastest kernels that the processor has, whose last bits may differ from machine to machine.
pub const DENSE: usize = 96;

/// The lower triangle of a symmetric matrix by columns; row numbers ascend within a column and begin with the diagonal.
#[derive(Clone, Copy, Debug)]
pub struct Lower<'s, R> {
    /// Where each column begins in `rows`, and where the last ends.
    pub columns: &'s [u32],
    /// Row numbers.
    pub rows: &'s [u32],
    /// Values.
    pub values: &'s [R],
}

impl<R> Lower<'_, R> {
    /// The number of unknowns.
    pub fn size(&self) -> usize {
        self.columns.len().saturating_sub(1)
    }
}

/// The pattern of a sparse factor, for matrices of one pattern.
#[derive(Debug)]
pub struct Factor {
    symbolic: SymbolicCholesky<u32>,
}

impl Factor {
    /// The factor of matrices with this lower triangle, eliminated in the order of their unknowns. `None` when it exceeds memory.
    pub fn new(columns: &[u32], rows: &[u32]) -> Option<Factor> {
        // Without an ordering of its own, faer takes the upper triangle here.
        let (columns, rows) = transposed(columns, rows);
        let size = columns.len() - 1;
        let upper = SymbolicSparseColMatRef::new_checked(size, size, &columns, None, &rows);
        let ordering = SymmetricOrdering::Identity;
        let symbolic = factorize_symbolic_cholesky(upper, Side::Upper, ordering, Default::default()).ok()?;
        Some(Factor { symbolic })
    }

    /// The values that a factor has.
    pub fn values(&self) -> usize {
        self.symbolic.len_val()
    }
}

fn transposed(columns: &[u32], rows: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let size = columns.len() - 1;
    let mut begins = vec![0u32; size + 1];
    for &row in rows {
        begins[row as usize + 1] += 1;
    }
    for k in 0..size {
        begins[k + 1] += begins[k];
    }
    let (mut next, mut found) = (begins.clone(), vec![0u32; rows.len()]);
    for column in 0..size {
        for &row in &rows[columns[column] as usize..columns[column + 1] as usize] {
            found[next[row as usize] as usize] = column as u32;
            next[row as usize] += 1;
        }
    }
    (begins, found)
}

/// An order of elimination of a graph's nodes that fills little (approximate minimum degree, Amestoy, Davis and Duff 1996). The
/// graph is given as a lower triangle without its diagonal. `None` when it exceeds memory.
pub fn elimination_order(columns: &[u32], rows: &[u32]) -> Option<Vec<u32>> {
    let size = columns.len() - 1;
    let graph = SymbolicSparseColMatRef::new_checked(size, size, columns, None, rows);
    let mut buffer = MemBuffer::try_new(amd::order_scratch::<u32>(size, rows.len())).ok()?;
    let (mut order, mut inverse) = (vec![0u32; size], vec![0u32; size]);
    amd::order(&mut order, &mut inverse, graph, amd::Control::default(), MemStack::new(&mut buffer)).ok()?;
    Some(order)
}

/// A pivot that is not positive and finite: the system is singular, or became so by rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular {
    /// The unknown, where it is known.
    pub unknown: usize,
}

/// A scalar in which systems can be solved.
pub trait Solve: Real + Send + Sync {
    /// Solves in place a system too large for [`dense`], by the factor of its pattern.
    ///
    /// # Errors
    /// When the matrix is not positive definite in this precision.
    fn sparse(matrix: Lower<'_, Self>, factor: &Factor, rhs: &mut [Self]) -> Result<(), Singular>;
}

macro_rules! solve_by_faer {
    ($type:ty) => {
        impl Solve for $type {
            fn sparse(matrix: Lower<'_, Self>, factor: &Factor, rhs: &mut [Self]) -> Result<(), Singular> {
                let singular = Singular { unknown: 0 };
                let Factor { symbolic } = factor;
                let size = matrix.size();
                let pattern = SymbolicSparseColMatRef::new_checked(size, size, matrix.columns, None, matrix.rows);
                let lower = SparseColMatRef::new(pattern, matrix.values);
                let par = Par::Seq;
                let scratch = symbolic.factorize_numeric_llt_scratch::<$type>(par, Default::default());
                let scratch = scratch.or(symbolic.solve_in_place_scratch::<$type>(1, par));
                let mut buffer = MemBuffer::try_new(scratch).map_err(|_| singular)?;
                let stack = MemStack::new(&mut buffer);
                let mut values = vec![0.0; symbolic.len_val()];
                let (whole, spec) = (Default::default(), Default::default());
                symbolic
                    .factorize_numeric_llt(&mut values, lower, Side::Lower, whole, par, stack, spec)
                    .map_err(|_| singular)?;
                let solution = faer::ColMut::from_slice_mut(rhs).as_mat_mut();
                LltRef::new(symbolic, &values).solve_in_place_with_conj(Conj::No, solution, par, stack);
                Ok(())
            }
        }
    };
}

solve_by_faer!(f32);
solve_by_faer!(f64);

impl Solve for Wide {
    fn sparse(matrix: Lower<'_, Self>, _: &Factor, rhs: &mut [Self]) -> Result<(), Singular> {
        dense(matrix, rhs)
    }
}

/// Solves in place, by Cholesky's method without square roots (LDLᵀ), row by row.
///
/// # Errors
/// When a pivot is not positive and finite.
pub fn dense<R: Real>(matrix: Lower<'_, R>, rhs: &mut [R]) -> Result<(), Singular> {
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
