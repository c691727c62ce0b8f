//! Which deformable blocks are strained at the end of a run by more than small strains are, for which alone steps are right: shear leaves the volume as it was.

use crate::f64_vector::{Point, dot, minus, point};
use rockproof_model::Scene;
use rockproof_model::simulation::Motion;
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::State;

/// Lines that became longer or shorter by no more than this share are not told.
const MIN_SHARE: f64 = 0.01;

/// The deformable blocks of a run in which some line became longer or shorter by more than one in a hundred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// How many there are.
    pub blocks: usize,
    /// The block with the line that changed most, the first of several.
    pub worst: usize,
    /// The length of its line that became shortest, as a multiple of that at the beginning.
    pub least: f64,
    /// The same of the line that became longest.
    pub most: f64,
}

impl Stretch {
    /// What a run that began with one state and is in another has strained; `None` where no block is strained so much.
    pub fn of<R: Real>(scene: &Scene, begin: &State<R>, state: &State<R>) -> Option<Stretch> {
        let blocks = scene.blocks.iter().zip(begin.blocks.iter().zip(&state.blocks)).enumerate();
        let strained: Vec<(usize, [f64; 2])> = blocks
            .filter(|(_, (block, _))| block.body.motion == Motion::Deformable)
            .filter_map(|(number, (_, states))| {
                let [then, now] =
                    [states.0, states.1].map(|state| state.vertices.iter().map(|v| point(*v)).collect::<Vec<Point>>());
                Some((number, extreme_stretches(&then, &now)?))
            })
            .filter(|(_, ends)| change(*ends) > MIN_SHARE)
            .collect();
        let worst = strained.iter().rev().max_by(|one, other| change(one.1).total_cmp(&change(other.1)));
        worst.map(|&(worst, [least, most])| Stretch { blocks: strained.len(), worst, least, most })
    }

    /// The same in words.
    pub fn sentence(&self) -> String {
        let Stretch { blocks, worst, least, most } = self;
        let others = match blocks {
            1 => String::new(),
            _ => format!("; {blocks} blocks by more than 1 %"),
        };
        format!(
            "lines in block {worst} are {least:.3} to {most:.3} times as long as they began{others}: steps take strains for small"
        )
    }
}

/// By how much the line that changed most did, as a share of its length.
fn change([least, most]: [f64; 2]) -> f64 {
    (most - 1.0).max(1.0 - least)
}

/// The smallest and the largest factor by which an affine map of points makes lines longer; `None` where the points lie in a plane, or are not finite.
///
/// Steps move all points of a block by one affine map x ↦ F·x + c. With X and x the places of a vertex from that of the first before and after, F is
/// (Σ x·Xᵀ)(Σ X·Xᵀ)⁻¹, and the factors are the roots of the eigenvalues of FᵀF, whatever the block turned by.
fn extreme_stretches(then: &[Point], now: &[Point]) -> Option<[f64; 2]> {
    let (mut own, mut mixed) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    for (before, after) in then.iter().zip(now) {
        let (before, after) = (minus(*before, then[0]), minus(*after, now[0]));
        for row in 0..3 {
            for column in 0..3 {
                own[row][column] += before[row] * before[column];
                mixed[row][column] += after[row] * before[column];
            }
        }
    }
    let inverse = inverse(own)?;
    let gradient: [Point; 3] =
        std::array::from_fn(|row| std::array::from_fn(|column| dot(mixed[row], column_of(&inverse, column))));
    let product = |one, other| dot(column_of(&gradient, one), column_of(&gradient, other));
    let squares = extreme_eigenvalues(std::array::from_fn(|row| std::array::from_fn(|column| product(row, column))));
    let ends = squares.map(|square| square.max(0.0).sqrt());
    ends.iter().all(|end| end.is_finite()).then_some(ends)
}

fn column_of(matrix: &[Point; 3], column: usize) -> Point {
    matrix.map(|row| row[column])
}

/// The inverse of a symmetric matrix; `None` where it has none to speak of.
fn inverse(of: [Point; 3]) -> Option<[Point; 3]> {
    let size = of[0][0] + of[1][1] + of[2][2];
    let cofactor = |row: usize, column: usize| {
        let [a, b] = [(row + 1) % 3, (row + 2) % 3];
        let [c, d] = [(column + 1) % 3, (column + 2) % 3];
        of[a][c] * of[b][d] - of[a][d] * of[b][c]
    };
    let determinant: f64 = (0..3).map(|column| of[0][column] * cofactor(0, column)).sum();
    // Thinner than a millionth of its length: rounding may be as large as the thickness.
    let is_known = determinant.is_finite() && determinant > 1e-12 * size * size * size / 27.0;
    is_known.then(|| std::array::from_fn(|row| std::array::from_fn(|column| cofactor(column, row) / determinant)))
}

/// The smallest and the largest eigenvalue of a symmetric matrix, by the cosines that solve its cubic.
fn extreme_eigenvalues(of: [Point; 3]) -> [f64; 2] {
    let mean = (of[0][0] + of[1][1] + of[2][2]) / 3.0;
    let off = |row: usize, column: usize| if row == column { of[row][column] - mean } else { of[row][column] };
    let squares: f64 =
        (0..3).flat_map(|row| (0..3).map(move |column| (row, column))).map(|(r, c)| off(r, c).powi(2)).sum();
    let spread = (squares / 6.0).sqrt();
    if spread <= 1e-15 * mean.abs() {
        return [mean; 2];
    }
    let determinant = off(0, 0) * (off(1, 1) * off(2, 2) - off(1, 2) * off(2, 1))
        - off(0, 1) * (off(1, 0) * off(2, 2) - off(1, 2) * off(2, 0))
        + off(0, 2) * (off(1, 0) * off(2, 1) - off(1, 1) * off(2, 0));
    let angle = (determinant / (2.0 * spread.powi(3))).clamp(-1.0, 1.0).acos() / 3.0;
    let third = 2.0 * std::f64::consts::FRAC_PI_3;
    [mean + 2.0 * spread * (angle + third).cos(), mean + 2.0 * spread * angle.cos()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Vec<Point> {
        (0..8).map(|k| [0, 1, 2].map(|axis| f64::from(k >> axis & 1))).collect()
    }

    fn near(found: Option<[f64; 2]>, expected: [f64; 2]) -> bool {
        found.is_some_and(|found| (0..2).all(|k| (found[k] - expected[k]).abs() < 1e-12))
    }

    #[test]
    fn shear_is_found_though_the_volume_stays_and_turning_is_none() {
        let sheared: Vec<Point> = cube().iter().map(|[x, y, z]| [x + 0.8 * z, *y, *z]).collect();
        // The roots of 1 + γ²/2 ± γ·√(1 + γ²/4) with γ = 0.8.
        let ends = [1.32 - 0.8 * 1.16f64.sqrt(), 1.32 + 0.8 * 1.16f64.sqrt()].map(f64::sqrt);
        assert!(near(extreme_stretches(&cube(), &sheared), ends), "{:?}", extreme_stretches(&cube(), &sheared));
        let turned = |points: &[Point]| points.iter().map(|[x, y, z]| [7.0 - y, 5.0 + x, *z]).collect::<Vec<Point>>();
        assert!(near(extreme_stretches(&cube(), &turned(&cube())), [1.0, 1.0]));
        assert!(near(extreme_stretches(&cube(), &turned(&sheared)), ends));
        let longer: Vec<Point> = cube().iter().map(|[x, y, z]| [*x, 1.25 * y, 0.75 * z]).collect();
        assert!(near(extreme_stretches(&cube(), &longer), [0.75, 1.25]));
        let flat: Vec<Point> = cube().iter().map(|[x, y, _]| [*x, *y, 0.0]).collect();
        assert_eq!(extreme_stretches(&flat, &cube()), None);
    }

    #[test]
    fn the_sentence_names_the_worst_block() {
        let one = Stretch { blocks: 1, worst: 3, least: 0.75, most: 1.25 };
        let said = "lines in block 3 are 0.750 to 1.250 times as long as they began: steps take strains for small";
        assert_eq!(one.sentence(), said);
        let two = Stretch { blocks: 2, ..one };
        assert!(two.sentence().contains("began; 2 blocks by more than 1 %: steps"), "{}", two.sentence());
    }
}
