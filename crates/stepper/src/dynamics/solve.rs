//! Solving `K d = F`: dense Cholesky for small systems, by panels for large ones.

use crate::dynamics::compiled::CompiledSteps;
use crate::dynamics::pattern::{Panel, Pattern};
use crate::real::Real;
use crate::wide::Wide;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::BlockStructure;
use faer::linalg::matmul::{matmul, triangular};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::traits::RealField;
use faer::{Accum, MatMut, MatRef, Par};

/// Systems of up to this many unknowns are solved as dense ones, by sums in an order of our own: the same bits on every machine.
/// Larger ones take the fastest kernels that the processor has, whose last bits may differ from machine to machine.
pub const DENSE: usize = 96;

/// A pivot that is not positive and finite: the system is singular, or became so by rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular {
    /// The unknown.
    pub unknown: usize,
}

/// A scalar in which systems can be solved.
pub trait Solve: CompiledSteps + Real + Send + Sync {
    /// Replaces the values of the panels that are marked, which are those of the matrix, by those of its factor. All others are so
    /// already, and depend on none that is marked.
    ///
    /// # Errors
    /// When the matrix is not positive definite in this precision.
    fn factorize(pattern: &Pattern, values: &mut [Self], marked: &[bool]) -> Result<(), Singular>;

    /// Solves in place by what [`Solve::factorize`] left.
    ///
    /// # Errors
    /// When the matrix is not positive definite in this precision.
    fn substitute(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular>;
}

macro_rules! solve_by_panels {
    ($type:ty) => {
        impl Solve for $type {
            fn factorize(pattern: &Pattern, values: &mut [Self], marked: &[bool]) -> Result<(), Singular> {
                factor(pattern, values, marked)
            }

            fn substitute(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular> {
                substitute(pattern, values, rhs);
                Ok(())
            }
        }
    };
}

solve_by_panels!(f32);
solve_by_panels!(f64);

/// Its values stay those of the matrix.
impl Solve for Wide {
    fn factorize(_: &Pattern, _: &mut [Self], _: &[bool]) -> Result<(), Singular> {
        Ok(())
    }

    fn substitute(pattern: &Pattern, values: &[Self], rhs: &mut [Self]) -> Result<(), Singular> {
        dense(pattern, values, rhs)
    }
}

/// Cholesky's method, left-looking: each panel gathers what the earlier ones take from it, then is factored as a dense one.
fn factor<R: Real + RealField>(pattern: &Pattern, values: &mut [R], marked: &[bool]) -> Result<(), Singular> {
    let widest = pattern.panels().iter().map(|panel| panel.width).max().unwrap_or(0);
    let scratch = cholesky_in_place_scratch::<R>(widest, Par::Seq, Default::default());
    let mut buffer = MemBuffer::try_new(scratch).map_err(|_| Singular { unknown: 0 })?;
    let mut taken = Vec::new();
    for (panel, _) in pattern.panels().iter().zip(marked).filter(|(_, marked)| **marked) {
        let (earlier, rest) = values.split_at_mut(panel.values);
        let values = &mut rest[..panel.height * panel.width];
        take_updates(pattern, panel, earlier, values, &mut taken);
        let whole = MatMut::from_column_major_slice_mut(values, panel.height, panel.width);
        let (mut own, below) = whole.split_at_row_mut(panel.width);
        let stack = MemStack::new(&mut buffer);
        let (whole, spec) = (Default::default(), Default::default());
        cholesky_in_place(own.as_mut(), whole, Par::Seq, stack, spec)
            .map_err(|LltError::NonPositivePivot { index }| Singular { unknown: panel.begin + index })?;
        solve_lower_triangular_in_place(own.as_ref(), below.transpose_mut(), Par::Seq);
    }
    Ok(())
}

/// Subtracts `L Lᵀ` of the earlier panels from a panel.
fn take_updates<R: Real + RealField>(
    pattern: &Pattern,
    panel: &Panel,
    earlier: &[R],
    values: &mut [R],
    taken: &mut Vec<R>,
) {
    let one = R::from_f64(1.0);
    let mut runs: Vec<[usize; 3]> = Vec::new();
    for &update in pattern.updates(panel) {
        let from = &pattern.panels()[update.from as usize];
        let (inside, after) = pattern.updating(update);
        let first = inside[0].row as usize;
        let end = after.first().map_or(from.height, |below| below.row as usize);
        let (height, width) = (from.height - first, end - first);
        if taken.len() < height * width {
            taken.resize(height * width, R::ZERO);
        }
        let factor = MatRef::from_column_major_slice(
            &earlier[from.values..from.values + from.height * from.width],
            from.height,
            from.width,
        );
        let rows = factor.subrows(first, height);
        let across = factor.subrows(first, width).transpose();
        let into = MatMut::from_column_major_slice_mut(&mut taken[..height * width], height, width);
        // Half of a wide square is not needed.
        if width > WIDE {
            let (square, rest) = into.split_at_row_mut(width);
            let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
            triangular::matmul(
                square,
                lower,
                Accum::Replace,
                rows.subrows(0, width),
                full,
                across,
                full,
                one,
                Par::Seq,
            );
            matmul(rest, Accum::Replace, rows.subrows(width, height - width), across, one, Par::Seq);
        } else {
            matmul(into, Accum::Replace, rows, across, one, Par::Seq);
        }
        // Rows that follow one another in both: where they begin here and there, and how many they are.
        runs.clear();
        let own = inside.iter().map(|below| (below, pattern.unknowns(below.node as usize).start - panel.begin));
        let mut below = pattern.below(panel).iter();
        let later = after.iter().filter_map(|node| {
            let found = below.find(|below| below.node == node.node)?;
            Some((node, found.row as usize))
        });
        for (node, row) in own.chain(later) {
            let (here, count) = (node.row as usize - first, pattern.unknowns(node.node as usize).len());
            match runs.last_mut() {
                Some([from, to, length]) if *from + *length == here && *to + *length == row => *length += count,
                _ => runs.push([here, row, count]),
            }
        }
        let columns = inside.iter().flat_map(|below| {
            let unknowns = pattern.unknowns(below.node as usize);
            (0..unknowns.len()).map(move |k| (below.row as usize - first + k, unknowns.start - panel.begin + k))
        });
        for (here, there) in columns {
            let source = &taken[here * height..(here + 1) * height];
            let target = &mut values[there * panel.height..(there + 1) * panel.height];
            for &[from, to, length] in &runs {
                for (value, &taken) in target[to..to + length].iter_mut().zip(&source[from..from + length]) {
                    *value -= taken;
                }
            }
        }
    }
}

/// Of updates that are wider than this, the square is worked out by half.
const WIDE: usize = 36;

/// Forth through the factor, and back through its transpose.
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
