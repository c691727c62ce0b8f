//! A symmetric system in blocks: which unknowns meet is known from which blocks touch.

use crate::field::Field;
use std::collections::BTreeMap;

/// The lower triangle of a symmetric matrix by blocks, and a right side.
#[derive(Clone, Debug)]
pub(crate) struct BlockSparseSystem<S> {
    /// The first unknown of each block, and the number of unknowns at the end.
    starts: Vec<usize>,
    /// The block of rows i and columns j, `i ≥ j`, row by row; those on the diagonal are whole squares.
    blocks: BTreeMap<(usize, usize), Vec<S>>,
    /// The right side.
    pub(crate) right: Vec<S>,
}

impl<S: Field> BlockSparseSystem<S> {
    /// The system of zeros with blocks of these sizes.
    pub(crate) fn zero(sizes: &[usize]) -> BlockSparseSystem<S> {
        let mut starts = vec![0];
        for size in sizes {
            starts.push(starts[starts.len() - 1] + size);
        }
        let right = vec![S::from_i32(0); starts[sizes.len()]];
        BlockSparseSystem { starts, blocks: BTreeMap::new(), right }
    }

    /// Number of unknowns.
    pub(crate) fn unknowns(&self) -> usize {
        self.right.len()
    }

    /// Unknowns of a block.
    pub(crate) fn size(&self, block: usize) -> usize {
        self.starts[block + 1] - self.starts[block]
    }

    /// Adds `value(row, column)` to the block of rows i and columns j. For `i < j` the transposed block is meant.
    pub(crate) fn add(&mut self, i: usize, j: usize, value: impl Fn(usize, usize) -> S) {
        let turned = i < j;
        let (i, j) = if turned { (j, i) } else { (i, j) };
        let (rows, columns) = (self.size(i), self.size(j));
        let block = self.blocks.entry((i, j)).or_insert_with(|| vec![S::from_i32(0); rows * columns]);
        for row in 0..rows {
            for column in 0..columns {
                let place = &mut block[row * columns + column];
                *place = place.plus(&if turned { value(column, row) } else { value(row, column) });
            }
        }
    }

    /// Adds to the right side of a block.
    pub(crate) fn add_right(&mut self, block: usize, value: impl Fn(usize) -> S) {
        let start = self.starts[block];
        for row in 0..self.size(block) {
            self.right[start + row] = self.right[start + row].plus(&value(row));
        }
    }

    /// Every entry of the lower triangle that a block covers, as (row, column, value).
    pub(crate) fn lower(&self) -> impl Iterator<Item = (usize, usize, &S)> + '_ {
        self.blocks.iter().flat_map(move |(&(i, j), block)| {
            let columns = self.size(j);
            let (top, left) = (self.starts[i], self.starts[j]);
            block.iter().enumerate().filter_map(move |(k, value)| {
                let (row, column) = (top + k / columns, left + k % columns);
                (row >= column).then_some((row, column, value))
            })
        })
    }

    /// `right − K·x`.
    pub(crate) fn residual(&self, x: &[S]) -> Vec<S> {
        let mut residual = self.right.clone();
        let zero: Vec<bool> = x.iter().map(Field::is_zero).collect();
        for (row, column, value) in self.lower() {
            if !zero[column] {
                residual[row] = residual[row].minus(&value.times(&x[column]));
            }
            if row != column && !zero[row] {
                residual[column] = residual[column].minus(&value.times(&x[row]));
            }
        }
        residual
    }

    /// The whole matrix, row by row.
    pub(crate) fn dense(&self) -> Vec<Vec<S>> {
        let n = self.unknowns();
        let mut rows = vec![vec![S::from_i32(0); n]; n];
        for (row, column, value) in self.lower() {
            rows[row][column] = value.clone();
            rows[column][row] = value.clone();
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::fraction_free_solve;
    use num_rational::BigRational;

    fn fraction(numerator: i64, denominator: i64) -> BigRational {
        BigRational::new(numerator.into(), denominator.into())
    }

    fn whole(value: i64) -> BigRational {
        fraction(value, 1)
    }

    #[test]
    fn the_solution_of_the_whole_leaves_nothing() {
        // Blocks of 1, 2 and 1 unknowns, of which the first and the last meet: 2a + d = 1, 3b = 2, 4c = 3, a + 5d = 4.
        let mut system = BlockSparseSystem::zero(&[1, 2, 1]);
        let middle = [[3, 0], [0, 4]];
        system.add(0, 0, |_, _| whole(2));
        system.add(1, 1, |row, column| whole(middle[row][column]));
        system.add(2, 2, |_, _| whole(5));
        system.add(2, 0, |_, _| whole(1));
        let right = [&[1][..], &[2, 3], &[4]];
        for (block, right) in right.iter().enumerate() {
            system.add_right(block, |row| whole(right[row]));
        }
        let solution = [fraction(1, 9), fraction(2, 3), fraction(3, 4), fraction(7, 9)];
        assert_eq!(fraction_free_solve(&system.dense(), &system.right).unwrap(), solution);
        assert!(system.residual(&solution).iter().all(Field::is_zero));
    }

    #[test]
    fn a_block_above_the_diagonal_is_kept_as_its_transpose() {
        let mut above = BlockSparseSystem::zero(&[1, 2]);
        let line = [[7, 8]];
        above.add(0, 1, |row, column| whole(line[row][column]));
        let mut below = BlockSparseSystem::zero(&[1, 2]);
        let upright = [[7], [8]];
        below.add(1, 0, |row, column| whole(upright[row][column]));
        let expected = [[0, 7, 8], [7, 0, 0], [8, 0, 0]].map(|row| row.map(whole).to_vec());
        assert_eq!(above.dense(), expected);
        assert_eq!(below.dense(), expected);
    }
}
