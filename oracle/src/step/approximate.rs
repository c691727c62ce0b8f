//! The f64 stiffness of a step and its factor: corrects approximate solutions, proves nothing.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rockproof_cholesky::{Graph, Pattern, Renumbered, Scalar, Threads, elimination_order};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// A square of a block's unknowns; those it does not have are left out.
pub(crate) type Square = [[f64; 12]; 12];

/// Systems of up to this many unknowns are factored whole.
const DENSE: usize = 72;

/// Which unknowns meet in a step: all of its contacts count, closed or not, so that one ordering serves all solves.
#[derive(Debug)]
pub(crate) struct Layout {
    /// The first unknown of each moving block, and the number of unknowns.
    starts: Vec<usize>,
    /// For each moving block the later ones that it meets, ascending, and the place of their matrix.
    below: Vec<Vec<(usize, usize)>>,
    squares: usize,
    /// Where each block is, about: bears on the order of elimination only.
    at: Vec<[f64; 3]>,
    pattern: OnceLock<Option<Arc<BlockPattern>>>,
}

/// Where the values of a factor stand.
#[derive(Debug)]
pub(crate) struct BlockPattern {
    pattern: Pattern,
    /// The block of each node, in the order of elimination.
    blocks: Vec<usize>,
    /// For each node the matrices of the later ones that it meets.
    columns: Vec<Vec<Coupling>>,
    /// The first unknown of each block.
    starts: Vec<usize>,
}

/// The matrix of two blocks that meet.
#[derive(Debug)]
struct Coupling {
    /// The node that is eliminated later.
    later: usize,
    /// The place of the matrix, whose rows are those of the block with the higher number.
    place: usize,
    /// Whether its rows are those of the node that is eliminated earlier.
    is_transposed: bool,
}

impl BlockPattern {
    /// `None` above 2³⁰ couplings.
    fn new(layout: &Layout) -> Option<BlockPattern> {
        let unknowns: Vec<u8> = (0..layout.below.len()).map(|block| layout.size(block) as u8).collect();
        let met = layout.below.iter().enumerate();
        let pairs: Vec<[u32; 2]> =
            met.flat_map(|(column, rows)| rows.iter().map(move |&(row, _)| [column as u32, row as u32])).collect();
        let graph = Graph { unknowns: &unknowns, pairs: &pairs };
        let order = elimination_order(graph, &layout.at)?;
        let renumbered = Renumbered::new(graph, &order);
        let mut columns: Vec<Vec<Coupling>> = order.iter().map(|_| Vec::new()).collect();
        for (column, rows) in layout.below.iter().enumerate() {
            for &(row, place) in rows {
                let [column, row] = [column, row].map(|block| renumbered.places[block] as usize);
                let (earlier, later) = (column.min(row), column.max(row));
                columns[earlier].push(Coupling { later, place, is_transposed: row == earlier });
            }
        }
        Some(BlockPattern {
            pattern: Pattern::new(renumbered.graph()),
            blocks: order.into_iter().map(|block| block as usize).collect(),
            columns,
            starts: layout.starts.clone(),
        })
    }

    /// The unknowns of each block as they stand in the factor, and as they stand outside.
    fn unknowns(&self) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        let of =
            |(node, &block): (usize, &usize)| (self.pattern.unknowns(node), self.starts[block]..self.starts[block + 1]);
        self.blocks.iter().enumerate().map(of)
    }
}

impl Layout {
    /// The layout of moving blocks with these sizes, of which these pairs meet, and which are at these places, about.
    pub(crate) fn new(sizes: &[usize], pairs: impl Iterator<Item = [usize; 2]>, at: Vec<[f64; 3]>) -> Layout {
        let mut starts = vec![0];
        for size in sizes {
            starts.push(starts[starts.len() - 1] + size);
        }
        let mut pairs: Vec<[usize; 2]> = pairs.map(|[i, j]| [i.min(j), i.max(j)]).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut below = vec![Vec::new(); sizes.len()];
        for (place, [column, row]) in pairs.iter().enumerate() {
            below[*column].push((*row, place));
        }
        Layout { starts, below, squares: pairs.len(), at, pattern: OnceLock::new() }
    }

    fn size(&self, block: usize) -> usize {
        self.starts[block + 1] - self.starts[block]
    }

    fn unknowns(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }

    /// Each entry of the lower triangle by columns, as (row, column, block of the row, place of the matrix or none for the
    /// diagonal, entry's row and column in it).
    fn entries(&self, mut visit: impl FnMut(usize, usize, Option<(usize, usize)>, usize, usize)) {
        for column in 0..self.below.len() {
            for c in 0..self.size(column) {
                for r in c..self.size(column) {
                    visit(self.starts[column] + r, self.starts[column] + c, None, r, c);
                }
                for &(row, place) in &self.below[column] {
                    for r in 0..self.size(row) {
                        visit(self.starts[row] + r, self.starts[column] + c, Some((row, place)), r, c);
                    }
                }
            }
        }
    }

    fn pattern(&self) -> Option<&Arc<BlockPattern>> {
        self.pattern.get_or_init(|| BlockPattern::new(self).map(Arc::new)).as_ref()
    }
}

/// A stiffness by blocks, in f64.
#[derive(Clone, Debug)]
pub(crate) struct Stiffness<'l> {
    layout: &'l Layout,
    pub(crate) diagonal: Vec<Square>,
    beside: Vec<Square>,
}

impl<'l> Stiffness<'l> {
    /// The stiffness of blocks that do not touch.
    pub(crate) fn new(layout: &'l Layout, diagonal: Vec<Square>) -> Stiffness<'l> {
        Stiffness { layout, diagonal, beside: vec![[[0.0; 12]; 12]; layout.squares] }
    }

    /// The matrix of the later block's rows and the earlier one's columns.
    pub(crate) fn coupling(&mut self, i: usize, j: usize) -> Option<&mut Square> {
        let (column, row) = (i.min(j), i.max(j));
        let of_column = &self.layout.below[column];
        let place = of_column.binary_search_by_key(&row, |&(row, _)| row).ok()?;
        Some(&mut self.beside[of_column[place].1])
    }

    /// The factor; `None` where f64 finds the matrix not definite.
    pub(crate) fn factor(&self) -> Option<Approximate> {
        let (n, layout) = (self.layout.unknowns(), self.layout);
        if n <= DENSE {
            let mut block = 0;
            let mut value = |column: usize, place: Option<(usize, usize)>, r: usize, c: usize| match place {
                Some((_, place)) => self.beside[place][r][c],
                None => {
                    while layout.starts[block + 1] <= column {
                        block += 1;
                    }
                    self.diagonal[block][r][c]
                }
            };
            let mut matrix = DMatrix::zeros(n, n);
            layout.entries(|row, column, place, r, c| {
                let entry = value(column, place, r, c);
                (matrix[(row, column)], matrix[(column, row)]) = (entry, entry);
            });
            return Cholesky::new(matrix).map(Approximate::Dense);
        }
        let pattern = layout.pattern()?;
        let mut values = vec![0.0; pattern.pattern.values()];
        let all = vec![true; pattern.pattern.panel_count()];
        let fill = |panel: usize, own: &mut [f64]| self.fill(pattern, panel, own);
        Scalar::factor(&pattern.pattern, &mut values, &all, &fill, Threads::One).ok()?;
        Some(Approximate::Sparse { pattern: pattern.clone(), values })
    }

    /// Adds the stiffness to the values of a panel.
    fn fill(&self, pattern: &BlockPattern, panel: usize, own: &mut [f64]) {
        for node in pattern.pattern.nodes(panel) {
            let block = pattern.blocks[node];
            let size = self.layout.size(block);
            if let Some((at, stride)) = pattern.pattern.part_of(panel, node, node) {
                for c in 0..size {
                    for (r, line) in self.diagonal[block].iter().enumerate().take(size).skip(c) {
                        own[at + stride * c + r] += line[c];
                    }
                }
            }
            for coupling in &pattern.columns[node] {
                let Some((at, stride)) = pattern.pattern.part_of(panel, coupling.later, node) else { continue };
                let (square, rows) = (&self.beside[coupling.place], self.layout.size(pattern.blocks[coupling.later]));
                for c in 0..size {
                    for (r, value) in own[at + stride * c..][..rows].iter_mut().enumerate() {
                        *value += if coupling.is_transposed { square[c][r] } else { square[r][c] };
                    }
                }
            }
        }
    }
}

/// A factored stiffness.
#[derive(Debug)]
pub(crate) enum Approximate {
    Dense(Cholesky<f64, Dyn>),
    Sparse { pattern: Arc<BlockPattern>, values: Vec<f64> },
}

impl Approximate {
    /// An approximate solution. Nothing is claimed about it.
    pub(crate) fn solve(&self, mut right: Vec<f64>) -> Vec<f64> {
        match self {
            Approximate::Dense(factor) => {
                let mut vector = DVector::from_vec(right);
                factor.solve_mut(&mut vector);
                vector.as_slice().to_vec()
            }
            Approximate::Sparse { pattern, values } => {
                let mut solution = vec![0.0; right.len()];
                for (inside, outside) in pattern.unknowns() {
                    solution[inside].copy_from_slice(&right[outside]);
                }
                Scalar::substitute(&pattern.pattern, values, &mut solution, Threads::One);
                for (inside, outside) in pattern.unknowns() {
                    right[outside].copy_from_slice(&solution[inside]);
                }
                right
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between -1 and 1.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 33) as f64 / f64::from(1u32 << 30) - 1.0
        }
    }

    /// Blocks of 6 and of 12 unknowns in a ring, each tied to two others as well, numbered so that many are eliminated in another order.
    #[test]
    fn a_sparse_solution_is_that_of_dense_elimination() {
        let sizes: Vec<usize> = (0..13).map(|block| if block % 3 == 1 { 6 } else { 12 }).collect();
        let count = sizes.len();
        let pairs = (0..count).flat_map(|i| [[i, (i + 1) % count], [(i + 4) % count, i]]);
        let at = (0..count).map(|block| [(block * 7 % count) as f64, (block * 5 % count) as f64, 0.0]).collect();
        let layout = Layout::new(&sizes, pairs.clone(), at);
        let n = layout.unknowns();
        assert!(n > DENSE);
        let mut numbers = Numbers(1);
        let mut square = |own: f64| -> Square {
            let mut square = [[0.0; 12]; 12];
            for (r, c) in (0..12).flat_map(|r| (0..=r).map(move |c| (r, c))) {
                let value = if r == c { own } else { numbers.next() };
                (square[r][c], square[c][r]) = (value, value);
            }
            square
        };
        let mut stiffness = Stiffness::new(&layout, sizes.iter().map(|_| square(80.0)).collect());
        let mut numbers = Numbers(2);
        for [i, j] in pairs {
            let coupling = stiffness.coupling(i, j).expect("a coupling");
            coupling.iter_mut().flatten().for_each(|value| *value = numbers.next());
        }
        let mut whole = DMatrix::zeros(n, n);
        layout.entries(|row, column, place, r, c| {
            let block = layout.starts.partition_point(|&start| start <= column) - 1;
            let entry = place.map_or(stiffness.diagonal[block][r][c], |(_, place)| stiffness.beside[place][r][c]);
            (whole[(row, column)], whole[(column, row)]) = (entry, entry);
        });
        let turned = layout.pattern().expect("a pattern").columns.iter().flatten();
        let turned: Vec<bool> = turned.map(|coupling| coupling.is_transposed).collect();
        assert!(turned.contains(&true) && turned.contains(&false));
        let right: Vec<f64> = (0..n).map(|_| numbers.next()).collect();
        let factor = stiffness.factor().expect("a factor");
        assert!(matches!(factor, Approximate::Sparse { .. }));
        let found = factor.solve(right.clone());
        let expected = whole.lu().solve(&DVector::from_vec(right)).expect("a solution");
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        }
    }
}
