//! What the certified solver calls definite, where entries are known to far less than f64 holds: every matrix within their radii is.

use crate::number::Ball;
use crate::solve::{BlockSparseSystem, Factor, Support};

/// The factor of two unknowns with ones on the diagonal and this entry beside it.
fn factor(beside: Ball) -> Option<Factor> {
    let mut system = BlockSparseSystem::zero(&[2]);
    system.add(0, 0, |row, column| if row == column { Ball { middle: 1.0, radius: 0.0 } } else { beside });
    Factor::new(&system)
}

#[test]
fn a_ball_that_holds_an_indefinite_matrix_is_not_called_definite() {
    // The eigenvalues are 1 ± the entry, which lies between 1 − 2⁻⁸ − 2⁻⁷ and 1 − 2⁻⁸ + 2⁻⁷.
    let middle = 1.0 - 2f64.powi(-8);
    assert!(factor(Ball { middle, radius: 2f64.powi(-7) }).is_none());
    for (radius, least) in [(0.0, 2f64.powi(-8)), (2f64.powi(-10), 2f64.powi(-8) - 2f64.powi(-10))] {
        let proved = factor(Ball { middle, radius }).expect("definite").least_eigenvalue();
        assert!(0.0 < proved && proved <= least, "{proved} for {least}");
    }
}
