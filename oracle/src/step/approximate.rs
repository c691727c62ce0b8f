//! The f64 stiffness of a step and its factor: corrects approximate solutions, proves nothing.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use faer::Side;
use faer::linalg::solvers::Solve as _;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use std::cell::OnceCell;

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
    pattern: OnceCell<Option<Pattern>>,
}

/// The lower triangle by columns.
#[derive(Debug)]
struct Pattern {
    columns: Vec<u32>,
    rows: Vec<u32>,
    symbolic: SymbolicLlt<u32>,
}

impl Layout {
    /// The layout of moving blocks with these sizes, of which these pairs meet.
    pub(crate) fn new(sizes: &[usize], pairs: impl Iterator<Item = [usize; 2]>) -> Layout {
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
        Layout { starts, below, squares: pairs.len(), pattern: OnceCell::new() }
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

    fn pattern(&self) -> Option<&Pattern> {
        let make = || {
            let n = self.unknowns();
            let (mut columns, mut rows) = (vec![0u32; n + 1], Vec::new());
            self.entries(|row, column, _, _, _| {
                rows.push(row as u32);
                columns[column + 1] = rows.len() as u32;
            });
            let of = SymbolicSparseColMatRef::new_checked(n, n, &columns, None, &rows);
            let symbolic = SymbolicLlt::try_new(of, Side::Lower).ok()?;
            Some(Pattern { columns, rows, symbolic })
        };
        self.pattern.get_or_init(make).as_ref()
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
        // In the order of `entries`.
        let mut values: Vec<f64> = Vec::with_capacity(pattern.rows.len());
        for (column, below) in layout.below.iter().enumerate() {
            let size = layout.size(column);
            for c in 0..size {
                values.extend(self.diagonal[column][c..size].iter().map(|line| line[c]));
                for &(row, place) in below {
                    values.extend(self.beside[place][..layout.size(row)].iter().map(|line| line[c]));
                }
            }
        }
        let of = SymbolicSparseColMatRef::new_checked(n, n, &pattern.columns, None, &pattern.rows);
        let matrix = SparseColMatRef::new(of, &values);
        Llt::try_new_with_symbolic(pattern.symbolic.clone(), matrix, Side::Lower).ok().map(Approximate::Sparse)
    }
}

/// A factored stiffness.
#[derive(Debug)]
pub(crate) enum Approximate {
    Dense(Cholesky<f64, Dyn>),
    Sparse(Llt<u32, f64>),
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
            Approximate::Sparse(factor) => {
                factor.solve_in_place(faer::ColMut::from_slice_mut(&mut right).as_mat_mut());
                right
            }
        }
    }
}
