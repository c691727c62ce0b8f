//! Solving `K d = F`: dense Cholesky for small systems, by panels for large ones.

use crate::dynamics::compiled::CompiledSteps;
use crate::dynamics::factor::factor;
use crate::dynamics::pattern::{Panel, Pattern};
use crate::real::Real;
use crate::wide::Wide;
use faer::traits::pulp::{Arch, Simd, WithSimd};

/// Systems of up to this many unknowns are solved as dense ones, by sums in an order of our own: the same bits on every machine.
/// Larger ones take the fastest kernels that the processor has, whose last bits may differ from machine to machine.
pub const DENSE: usize = 96;

/// Systems of which the factor takes so many multiplications or more, about, are very large: see [`Solve::REFINES`].
pub const COARSE: u64 = 1_500_000_000;

/// A pivot that is not positive and finite: the system is singular, or became so by rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular {
    /// The unknown.
    pub unknown: usize,
}

/// Adds the values of a matrix in a panel, given by number, to the panel's own.
pub type Fill<'f, R> = dyn Fn(usize, &mut [R]) + Sync + 'f;

/// A scalar in which systems can be solved.
pub trait Solve: CompiledSteps + Real + Send + Sync {
    /// Whether very large systems are solved by a factor in f32, and refined to this scalar's precision.
    const REFINES: bool;

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

    /// Solves in place by what [`Solve::factorize`] left.
    ///
    /// # Errors
    /// When the matrix is not positive definite in this precision.
    fn substitute(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular>;
}

macro_rules! solve_by_panels {
    ($type:ty, $refines:literal) => {
        impl Solve for $type {
            const REFINES: bool = $refines;

            fn factorize(
                pattern: &Pattern,
                values: &mut [Self],
                marked: &[bool],
                fill: &Fill<'_, Self>,
            ) -> Result<(), Singular> {
                factor(pattern, values, marked, fill)
            }

            fn substitute(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular> {
                Arch::new().dispatch(Substituting { pattern, values, rhs });
                Ok(())
            }
        }
    };
}

solve_by_panels!(f32, false);
solve_by_panels!(f64, true);

/// Its values stay those of the matrix.
impl Solve for Wide {
    const REFINES: bool = false;

    fn factorize(
        pattern: &Pattern,
        values: &mut [Self],
        marked: &[bool],
        fill: &Fill<'_, Self>,
    ) -> Result<(), Singular> {
        for panel in (0..marked.len()).filter(|&panel| marked[panel]) {
            let own = &mut values[pattern.range(panel)];
            own.fill(Wide::ZERO);
            fill(panel, own);
        }
        Ok(())
    }

    fn substitute(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular> {
        dense(pattern, values, rhs)
    }
}

/// Solving by a factor, by the widest instructions that the processor has. They change no bit: no sum is cut in other ways.
struct Substituting<'s, R> {
    pattern: &'s Pattern,
    values: &'s [R],
    rhs: &'s mut [R],
}

impl<R: Real> WithSimd for Substituting<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        substitute(self.pattern, self.values, self.rhs);
    }
}

/// Forth through the factor, and back through its transpose.
#[inline(always)]
fn substitute<R: Real>(pattern: &Pattern, values: &[R], rhs: &mut [R]) {
    let mut below: Vec<R> = Vec::new();
    for (k, panel) in pattern.panels().iter().enumerate() {
        below.clear();
        below.resize(panel.height - panel.width, R::ZERO);
        let own = &mut rhs[panel.begin..panel.begin + panel.width];
        for (four, columns) in values[pattern.range(k)].chunks(COLUMNS * panel.height).enumerate() {
            let begin = COLUMNS * four;
            let mut known = [R::ZERO; COLUMNS];
            for (c, column) in columns.chunks_exact(panel.height).enumerate() {
                let here = begin + c;
                known[c] = own[here] / column[here];
                own[here] = known[c];
                for (x, &l) in own[here + 1..].iter_mut().zip(&column[here + 1..panel.width]) {
                    *x = *x - l * known[c];
                }
            }
            add_columns(&mut below, columns, panel, &known);
        }
        for node in pattern.below(panel) {
            let unknowns = pattern.unknowns(node.node as usize);
            for (x, &sum) in rhs[unknowns].iter_mut().zip(&below[node.row as usize - panel.width..]) {
                *x = *x - sum;
            }
        }
    }
    for (k, panel) in pattern.panels().iter().enumerate().rev() {
        below.clear();
        for node in pattern.below(panel) {
            below.extend_from_slice(&rhs[pattern.unknowns(node.node as usize)]);
        }
        let own = &mut rhs[panel.begin..panel.begin + panel.width];
        for (here, column) in values[pattern.range(k)].chunks_exact(panel.height).enumerate().rev() {
            let (inner, outer) = column.split_at(panel.width);
            let sum = own[here] - dot(&inner[here + 1..], &own[here + 1..]) - dot(outer, &below);
            own[here] = sum / column[here];
        }
    }
}

/// So many columns are added at once, since the sums would be fetched and stored for each.
const COLUMNS: usize = 4;

/// Adds what lies below a panel's own rows in some columns, each times its factor.
#[inline(always)]
fn add_columns<R: Real>(sums: &mut [R], columns: &[R], panel: &Panel, factors: &[R; COLUMNS]) {
    let below = |c: usize| columns.get(c * panel.height + panel.width..(c + 1) * panel.height);
    if let (Some(a), Some(b), Some(c), Some(d)) = (below(0), below(1), below(2), below(3)) {
        let products = a.iter().zip(b).zip(c.iter().zip(d));
        for (sum, ((&a, &b), (&c, &d))) in sums.iter_mut().zip(products) {
            *sum = *sum + ((a * factors[0] + b * factors[1]) + (c * factors[2] + d * factors[3]));
        }
        return;
    }
    for (column, &factor) in columns.chunks_exact(panel.height).zip(factors) {
        for (sum, &l) in sums.iter_mut().zip(&column[panel.width..]) {
            *sum = *sum + l * factor;
        }
    }
}

/// A scalar product in eight strands, which do not wait for one another.
#[inline(always)]
fn dot<R: Real>(a: &[R], b: &[R]) -> R {
    let mut strands = [R::ZERO; 8];
    let (parts, others) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = parts.remainder().iter().zip(others.remainder()).fold(R::ZERO, |sum, (&a, &b)| sum + a * b);
    for (a, b) in parts.zip(others) {
        for (strand, (&a, &b)) in strands.iter_mut().zip(a.iter().zip(b)) {
            *strand = *strand + a * b;
        }
    }
    strands.into_iter().fold(rest, |sum, strand| sum + strand)
}

/// Solves in place, by Cholesky's method without square roots (LDLᵀ), row by row. The values are those of the matrix.
///
/// # Errors
/// When a pivot is not positive and finite.
pub fn dense<R: Real>(pattern: &Pattern, values: &[R], rhs: &mut [R]) -> Result<(), Singular> {
    let n = pattern.size();
    let mut l = pattern.square(values, R::ZERO);
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
