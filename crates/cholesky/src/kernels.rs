//! Dense work on columns: products of rows, Cholesky's method, and rows divided by a factor.
//!
//! Every number is a sum in an order of its own, from the first column to the last, and is calculated alike whatever other rows there are: the same
//! bits however rows are cut, and on any number of threads. Products with columns of earlier groups of four are added without being rounded
//! where the processor has vectors with such instructions (x86-64-v3: AVX2, FMA and what goes with them; 64-bit ARM): all such processors find the same
//! bits, and all others the same as one another.

#[cfg(test)]
mod tests;

use num_traits::Float;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// So many columns are calculated at once, where there are so many.
const ACROSS: usize = 4;

/// What is done to some rows at a time.
trait ByRows {
    fn rows<const ROWS: usize>(&mut self, row: usize, addition: Addition);
}

/// So many rows at a time fill the registers.
#[inline(always)]
const fn tile_rows<R>() -> usize {
    if size_of::<R>() < size_of::<f64>() { 16 } else { 8 }
}

/// Does it to all of these rows, as many at once as fit the registers.
#[inline(always)]
fn for_rows<R>(work: &mut impl ByRows, rows: Range<usize>, addition: Addition) {
    let mut row = rows.start;
    while row + tile_rows::<R>() <= rows.end {
        if tile_rows::<R>() == 16 {
            work.rows::<16>(row, addition)
        } else {
            work.rows::<8>(row, addition)
        }
        row += tile_rows::<R>();
    }
    while row + 4 <= rows.end {
        work.rows::<4>(row, addition);
        row += 4;
    }
    while row < rows.end {
        work.rows::<1>(row, addition);
        row += 1;
    }
}

/// What is done to some columns at a time.
trait ByColumns {
    type Error;

    fn columns<const COLUMNS: usize>(&mut self, column: usize, addition: Addition) -> Result<(), Self::Error>;
}

/// Does it to all of so many columns.
#[inline(always)]
fn for_columns<W: ByColumns>(work: &mut W, count: usize, addition: Addition) -> Result<(), W::Error> {
    let mut column = 0;
    while column + ACROSS <= count {
        work.columns::<ACROSS>(column, addition)?;
        column += ACROSS;
    }
    while column < count {
        work.columns::<1>(column, addition)?;
        column += 1;
    }
    Ok(())
}

/// How a product is added to a sum.
#[derive(Clone, Copy)]
enum Addition {
    /// Without being rounded itself.
    Fused,
    /// Rounded first: what fuses them in software would take a hundred times as long.
    Separate,
}

impl Addition {
    /// What these vectors offer. Known while compiling, so it costs nothing.
    #[inline(always)]
    fn of<S: Simd>() -> Addition {
        if size_of::<S::f64s>() > size_of::<f64>() { Addition::Fused } else { Addition::Separate }
    }

    /// Sums over columns of the products of some numbers with others.
    #[inline(always)]
    fn products<'p, R: Float + 'p, const ROWS: usize, const COLUMNS: usize>(
        self,
        columns: impl Iterator<Item = (&'p [R; ROWS], &'p [R; COLUMNS])>,
    ) -> [[R; ROWS]; COLUMNS] {
        let mut sums = [[R::zero(); ROWS]; COLUMNS];
        for (rows, across) in columns {
            for (sums, &factor) in sums.iter_mut().zip(across) {
                for (sum, &value) in sums.iter_mut().zip(rows) {
                    *sum = match self {
                        Addition::Fused => value.mul_add(factor, *sum),
                        Addition::Separate => *sum + value * factor,
                    };
                }
            }
        }
        sums
    }

    /// The same of the first numbers of each.
    #[inline(always)]
    fn first_products<'p, R: Float + 'p, const ROWS: usize, const COLUMNS: usize>(
        self,
        columns: impl Iterator<Item = (&'p [R], &'p [R])>,
    ) -> [[R; ROWS]; COLUMNS] {
        self.products(columns.map_while(|(rows, across)| Some((rows.first_chunk()?, across.first_chunk()?))))
    }
}

/// A matrix, column by column.
#[derive(Clone, Copy)]
pub(crate) struct Columns<'c, R> {
    pub(crate) values: &'c [R],
    /// The number of rows.
    pub(crate) height: usize,
}

impl<'c, R> Columns<'c, R> {
    /// How many there are.
    #[inline(always)]
    fn count(self) -> usize {
        self.values.len() / self.height
    }

    #[inline(always)]
    fn all(self) -> impl Iterator<Item = &'c [R]> {
        self.values.chunks_exact(self.height)
    }
}

/// Rows of a matrix, some of which stand together as they are used: read as they are, they would be fetched line by line.
pub(crate) struct Packed<R> {
    rows: Vec<R>,
    across: Vec<R>,
}

impl<R> Default for Packed<R> {
    fn default() -> Packed<R> {
        Packed { rows: Vec::new(), across: Vec::new() }
    }
}

impl<R: Float> Packed<R> {
    /// Packs the rows by which others are multiplied.
    pub(crate) fn pack_across(&mut self, columns: Columns<'_, R>, across: Range<usize>) {
        pack(columns, across, ACROSS, &mut self.across);
    }
}

/// Products of rows of a matrix, summed over all columns: of some rows with some others.
pub(crate) struct RowProducts<'p, R> {
    pub(crate) columns: Columns<'p, R>,
    /// These rows...
    pub(crate) rows: Range<usize>,
    /// ... with each of these, which are packed: rows and columns of the result.
    pub(crate) across: Range<usize>,
    /// The result, column by column.
    pub(crate) into: &'p mut [R],
    pub(crate) packed: &'p mut Packed<R>,
}

impl<R: Float> RowProducts<'_, R> {
    /// Calculates them.
    pub(crate) fn calculate(self) {
        Arch::new().dispatch(self);
    }
}

/// Copies rows, so many together; those left over are not copied.
#[inline(always)]
fn pack<R: Float>(columns: Columns<'_, R>, rows: Range<usize>, together: usize, into: &mut Vec<R>) {
    let (count, depth) = (rows.len() / together * together, columns.count());
    if into.len() < count * depth {
        into.resize(count * depth, R::zero());
    }
    for (k, column) in columns.all().enumerate() {
        let column = &column[rows.start..rows.start + count];
        for (from, into) in column.chunks_exact(together).zip(into.chunks_exact_mut(together * depth)) {
            into[together * k..together * (k + 1)].copy_from_slice(from);
        }
    }
}

impl<R: Float> WithSimd for RowProducts<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        pack(self.columns, self.rows.clone(), tile_rows::<R>(), &mut self.packed.rows);
        let rows = self.rows.len();
        for_rows::<R>(&mut self, 0..rows, Addition::of::<S>());
    }
}

impl<R: Float> ByRows for RowProducts<'_, R> {
    #[inline(always)]
    fn rows<const ROWS: usize>(&mut self, row: usize, addition: Addition) {
        let columns = self.across.len();
        let Ok(()) = for_columns(&mut ProductsOfRows::<R, ROWS> { all: self, row }, columns, addition);
    }
}

/// Products of some of the rows.
struct ProductsOfRows<'r, 'p, R, const ROWS: usize> {
    all: &'r mut RowProducts<'p, R>,
    row: usize,
}

impl<R: Float, const ROWS: usize> ByColumns for ProductsOfRows<'_, '_, R, ROWS> {
    type Error = std::convert::Infallible;

    #[inline(always)]
    fn columns<const COLUMNS: usize>(&mut self, column: usize, addition: Addition) -> Result<(), Self::Error> {
        let (all, row) = (&mut *self.all, self.row);
        let depth = all.columns.count();
        let (first, across) = (all.rows.start + row, all.across.start + column);
        let sums = if ROWS == tile_rows::<R>() && COLUMNS == ACROSS {
            let rows = all.packed.rows[row * depth..][..ROWS * depth].as_chunks::<ROWS>().0;
            let across = all.packed.across[column * depth..][..COLUMNS * depth].as_chunks::<COLUMNS>().0;
            addition.products(rows.iter().zip(across))
        } else {
            addition.first_products::<R, ROWS, COLUMNS>(
                all.columns.all().map(|column| (&column[first..], &column[across..])),
            )
        };
        let count = all.rows.len();
        for (sums, into) in sums.iter().zip(all.into.chunks_exact_mut(count).skip(column)) {
            into[row..row + ROWS].copy_from_slice(sums);
        }
        Ok(())
    }
}

/// Factors a symmetric matrix in place, of which each column holds all rows; what lies above the diagonal means nothing. Tells the first
/// unknown whose pivot is not positive and finite.
pub(crate) fn factor_square<R: Float>(columns: &mut [&mut [R]]) -> Result<(), usize> {
    Arch::new().dispatch(Square(columns))
}

struct Square<'s, 'c, R>(&'s mut [&'c mut [R]]);

impl<R: Float> WithSimd for Square<'_, '_, R> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> Result<(), usize> {
        let size = self.0.len();
        for_columns(&mut self, size, Addition::of::<S>())
    }
}

impl<R: Float> ByColumns for Square<'_, '_, R> {
    type Error = usize;

    #[inline(always)]
    fn columns<const COLUMNS: usize>(&mut self, begin: usize, addition: Addition) -> Result<(), usize> {
        let (done, rest) = self.0.split_at_mut(begin);
        let Some(own) = rest.first_chunk_mut::<COLUMNS>() else { return Ok(()) };
        let triangle = triangle(done, own, addition)?;
        for (c, column) in own.iter_mut().enumerate() {
            column[begin + c..begin + COLUMNS].copy_from_slice(&triangle[c][c..]);
        }
        let rows = begin + COLUMNS..own[0].len();
        for_rows::<R>(&mut BelowTriangle { done, own, triangle }, rows, addition);
        Ok(())
    }
}

/// The factor of some columns in their own rows, column by column.
#[inline(always)]
fn triangle<R: Float, const COLUMNS: usize>(
    done: &[&mut [R]],
    own: &[&mut [R]; COLUMNS],
    addition: Addition,
) -> Result<[[R; COLUMNS]; COLUMNS], usize> {
    let begin = done.len();
    let mut triangle = [[R::zero(); COLUMNS]; COLUMNS];
    let sums =
        addition.first_products::<R, COLUMNS, COLUMNS>(done.iter().map(|column| (&column[begin..], &column[begin..])));
    for c in 0..COLUMNS {
        for r in c..COLUMNS {
            let value = own[c][begin + r] - sums[c][r];
            triangle[c][r] = (0..c).fold(value, |value, k| value - triangle[k][r] * triangle[k][c]);
        }
        let pivot = triangle[c][c];
        if !(pivot > R::zero() && pivot.is_finite()) {
            return Err(begin + c);
        }
        triangle[c][c] = pivot.sqrt();
        for r in c + 1..COLUMNS {
            triangle[c][r] = triangle[c][r] / triangle[c][c];
        }
    }
    Ok(triangle)
}

/// The rows of some columns of a square below their own.
struct BelowTriangle<'b, 'c, R, const COLUMNS: usize> {
    done: &'b [&'c mut [R]],
    own: &'b mut [&'c mut [R]; COLUMNS],
    triangle: [[R; COLUMNS]; COLUMNS],
}

impl<R: Float, const COLUMNS: usize> ByRows for BelowTriangle<'_, '_, R, COLUMNS> {
    #[inline(always)]
    fn rows<const ROWS: usize>(&mut self, row: usize, addition: Addition) {
        let begin = self.done.len();
        let columns = self.done.iter().map(|column| (&column[row..], &column[begin..]));
        let sums = addition.first_products::<R, ROWS, COLUMNS>(columns);
        divide(self.own, row, &sums, &self.triangle);
    }
}

/// Takes sums off some rows and divides these by a triangle.
#[inline(always)]
fn divide<R: Float, const ROWS: usize, const COLUMNS: usize>(
    own: &mut [&mut [R]; COLUMNS],
    row: usize,
    sums: &[[R; ROWS]; COLUMNS],
    triangle: &[[R; COLUMNS]; COLUMNS],
) {
    let mut quotients = [[R::zero(); ROWS]; COLUMNS];
    for c in 0..COLUMNS {
        let Some(values) = own[c][row..].first_chunk_mut::<ROWS>() else { return };
        for r in 0..ROWS {
            let value = values[r] - sums[c][r];
            let value = (0..c).fold(value, |value, k| value - quotients[k][r] * triangle[k][c]);
            quotients[c][r] = value / triangle[c][c];
        }
        *values = quotients[c];
    }
}

/// Divides rows, given by columns, by a factor: `B L⁻ᵀ` in place of B.
pub(crate) fn divide_rows<R: Float>(square: &[&[R]], rows: &mut [&mut [R]]) {
    Arch::new().dispatch(Division { square, rows });
}

struct Division<'d, 'c, R> {
    square: &'d [&'d [R]],
    rows: &'d mut [&'c mut [R]],
}

impl<R: Float> WithSimd for Division<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        let count = self.rows.first().map_or(0, |column| column.len());
        for_rows::<R>(&mut self, 0..count, Addition::of::<S>());
    }
}

impl<R: Float> ByRows for Division<'_, '_, R> {
    #[inline(always)]
    fn rows<const ROWS: usize>(&mut self, row: usize, addition: Addition) {
        let columns = self.square.len();
        let Ok(()) = for_columns(&mut DivisionOfRows::<R, ROWS> { all: self, row }, columns, addition);
    }
}

/// Some of the rows.
struct DivisionOfRows<'r, 'd, 'c, R, const ROWS: usize> {
    all: &'r mut Division<'d, 'c, R>,
    row: usize,
}

impl<R: Float, const ROWS: usize> ByColumns for DivisionOfRows<'_, '_, '_, R, ROWS> {
    type Error = std::convert::Infallible;

    #[inline(always)]
    fn columns<const COLUMNS: usize>(&mut self, begin: usize, addition: Addition) -> Result<(), Self::Error> {
        let (square, row) = (self.all.square, self.row);
        let (done, rest) = self.all.rows.split_at_mut(begin);
        let Some(own) = rest.first_chunk_mut::<COLUMNS>() else { return Ok(()) };
        let columns = done.iter().zip(square).map(|(rows, across)| (&rows[row..], &across[begin..]));
        let sums = addition.first_products::<R, ROWS, COLUMNS>(columns);
        let mut triangle = [[R::zero(); COLUMNS]; COLUMNS];
        for (column, values) in triangle.iter_mut().zip(&square[begin..]) {
            column.copy_from_slice(&values[begin..begin + COLUMNS]);
        }
        divide(own, row, &sums, &triangle);
        Ok(())
    }
}
