//! The inverses of blocks' own matrices, in f32.
//!
//! Each is kept as L⁻¹ of Cholesky's factor, and applied as (L⁻¹)ᵀL⁻¹: positive definite whatever f32 rounds, as conjugate gradients demand. A whole
//! inverse in f32 need not be once springs are 10⁷ times as stiff as inertia: its least eigenvalues are then below what its entries are rounded by.

use crate::real::Real;

/// So many rows and columns make a tile.
const SIDE: usize = 4;

/// A part of L⁻¹, row by row.
type Tile = [[f32; SIDE]; SIDE];

/// L⁻¹ by tiles of its lower triangle, row by row of tiles; zeros above the diagonal and where a block has no such unknown.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockInverse([Tile; 6]);

impl BlockInverse {
    /// Of the first rows and columns; none where they are not positive definite, or f32 cannot hold the diagonal of L⁻¹.
    #[inline(always)]
    pub(super) fn of<R: Real>(square: &[[R; 12]; 12], unknowns: usize) -> Option<BlockInverse> {
        let (mut l, mut lower) = ([[R::ZERO; 12]; 12], [[R::ZERO; 12]; 12]);
        let mut tiles = [[[0.0; SIDE]; SIDE]; 6];
        for row in 0..unknowns {
            for column in 0..row {
                let sum = (0..column).fold(square[row][column], |sum, k| sum - l[row][k] * l[column][k]);
                l[row][column] = sum * lower[column][column];
            }
            let pivot = (0..row).fold(square[row][row], |sum, k| sum - l[row][k] * l[row][k]);
            lower[row][row] = R::from_f64(1.0) / pivot.sqrt();
            let diagonal = lower[row][row].to_f64() as f32;
            if !(R::ZERO.below(pivot) && diagonal.is_normal()) {
                return None;
            }
            for column in 0..row {
                let sum = (column..row).fold(R::ZERO, |sum, k| sum - l[row][k] * lower[k][column]);
                lower[row][column] = sum * lower[row][row];
            }
            for column in 0..=row {
                let tile = &mut tiles[first_tile(row / SIDE) + column / SIDE];
                tile[row % SIDE][column % SIDE] = lower[row][column].to_f64() as f32;
            }
        }
        Some(BlockInverse(tiles))
    }

    /// The inverse times a vector.
    #[inline(always)]
    pub(super) fn times<R: Real>(&self, force: &[R]) -> [f32; 12] {
        let mut single = [[0.0; SIDE]; 3];
        single.as_flattened_mut().iter_mut().zip(force).for_each(|(single, x)| *single = x.to_f64() as f32);
        let mut product = [[0.0; SIDE]; 3];
        for row in 0..force.len().div_ceil(SIDE) {
            let tiles = &self.0[first_tile(row)..][..=row];
            let mut terms = [[0.0; SIDE]; SIDE];
            for (tile, force) in tiles.iter().zip(&single) {
                for (terms, values) in terms.iter_mut().zip(tile) {
                    terms.iter_mut().zip(values.iter().zip(force)).for_each(|(term, (value, x))| *term += value * x);
                }
            }
            let half = terms.map(|[a, b, c, d]| (a + c) + (b + d));
            for (tile, product) in tiles.iter().zip(&mut product) {
                for (values, half) in tile.iter().zip(half) {
                    product.iter_mut().zip(values).for_each(|(sum, value)| *sum += value * half);
                }
            }
        }
        std::array::from_fn(|k| product[k / SIDE][k % SIDE])
    }
}

/// The first tile of a row of tiles.
fn first_tile(row: usize) -> usize {
    row * (row + 1) / 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::displacement::generalized;
    use crate::vector::Vector;

    /// Numbers between −1 and 1.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self) -> Vector<f64> {
            Vector::new(self.next(), self.next(), self.next())
        }
    }

    /// A block with inertia of 1 for each displacement and four oblique springs: its matrix, and what the springs pull it by.
    fn sprung(numbers: &mut Numbers, stiffness: f64) -> ([[f64; 12]; 12], [[f64; 12]; 4]) {
        let pulls: [[f64; 12]; 4] = std::array::from_fn(|_| generalized(numbers.vector(), numbers.vector()));
        let square = std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let springs: f64 = pulls.iter().map(|pull| pull[row] * pull[column]).sum();
                stiffness * springs + if row == column { 1.0 } else { 0.0 }
            })
        });
        (square, pulls)
    }

    fn dot(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// Forces are mostly those of the springs, to which a block yields least: what f32 rounds must not outweigh that.
    #[test]
    fn inverses_of_blocks_with_stiff_springs_are_positive_definite() {
        let mut numbers = Numbers(7);
        for stiffness in [1e3, 1e7, 1e8, 1e12f64] {
            let mut apart = 0.0f64;
            for unknowns in [12, 6] {
                for _ in 0..100 {
                    let (square, pulls) = sprung(&mut numbers, stiffness);
                    let inverse = BlockInverse::of(&square, unknowns).expect("positive definite");
                    for k in 0..100 {
                        let moved: [f64; 12] = std::array::from_fn(|_| numbers.next());
                        let forces = [0; 4].map(|_| numbers.next());
                        let force: [f64; 12] = match k % 3 {
                            0 => moved,
                            1 => std::array::from_fn(|row| dot(&square[row][..unknowns], &moved[..unknowns])),
                            _ => std::array::from_fn(|row| (0..4).map(|pull| pulls[pull][row] * forces[pull]).sum()),
                        };
                        let force = &force[..unknowns];
                        let work = dot(force, &inverse.times(force).map(f64::from));
                        assert!(work > 0.0, "{stiffness:e}, {unknowns} unknowns: {work}");
                        if k % 3 == 1 {
                            let expected = dot(force, &moved);
                            apart = apart.max((work / expected - 1.0).abs());
                        }
                    }
                }
            }
            // L⁻¹ is rounded, so the root of the condition counts.
            let most = 2.0 * f64::from(f32::EPSILON) * stiffness.sqrt();
            assert!(apart < most, "{stiffness:e}: {apart}");
        }
    }

    #[test]
    fn there_is_none_of_what_is_not_positive_definite_or_leaves_f32() {
        let with = |k: usize, value: f64| {
            let mut square: [[f64; 12]; 12] = std::array::from_fn(|_| [0.0; 12]);
            (0..12).for_each(|row| square[row][row] = if row == k { value } else { 2.0 });
            square
        };
        assert!(BlockInverse::of(&with(5, 2.0), 12).is_some());
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e80, 1e-80] {
            assert!(BlockInverse::of(&with(5, value), 12).is_none(), "{value}");
            assert!(BlockInverse::of(&with(6, value), 6).is_some(), "{value}");
        }
    }
}
