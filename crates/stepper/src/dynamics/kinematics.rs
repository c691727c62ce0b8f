//! How a step's unknowns move the points of a block (SPEC section 5).

use crate::dynamics::displacement::{BlockVector, displacement};
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::simulation::Kinematics;

/// The affine map of one block and step.
#[derive(Clone, Debug)]
pub(super) struct AffineMotion<R> {
    centroid: Vector<R>,
    d: BlockVector<R>,
    /// The rotation of `cayley`, by rows; `None` for `linear`.
    turn: Option<[Vector<R>; 3]>,
}

impl<R: Real> AffineMotion<R> {
    pub(super) fn new(kinematics: Kinematics, centroid: Vector<R>, d: &BlockVector<R>) -> AffineMotion<R> {
        let turn = match kinematics {
            Kinematics::Linear => None,
            Kinematics::Cayley => Some(cayley(Vector::new(d[3], d[4], d[5]))),
        };
        AffineMotion { centroid, d: *d, turn }
    }

    /// Where a material point of the block goes.
    pub(super) fn of(&self, point: Vector<R>) -> Vector<R> {
        let arm = point - self.centroid;
        let Some([x, y, z]) = self.turn else { return point + displacement(arm, &self.d) };
        let mut strain = self.d;
        strain[..6].fill(R::ZERO);
        let stretched = arm + displacement(arm, &strain);
        let turned = Vector::new(x.dot(stretched), y.dot(stretched), z.dot(stretched));
        self.centroid + Vector::new(self.d[0], self.d[1], self.d[2]) + turned
    }
}

/// `(I − [r]/2)⁻¹(I + [r]/2)`, a rotation whatever r is: with q = r/2,
/// `((1 − q·q) I + 2 qqᵀ + 2 [q]) / (1 + q·q)`.
fn cayley<R: Real>(r: Vector<R>) -> [Vector<R>; 3] {
    let (one, two) = (R::from_f64(1.0), R::from_f64(2.0));
    let q = r / two;
    let square = q.dot(q);
    let (diagonal, scale) = (one - square, one + square);
    let row = |own: R, axis: Vector<R>, skew: Vector<R>| (axis * diagonal + q * (two * own) + skew * two) / scale;
    let zero = R::ZERO;
    [
        row(q.x, Vector::new(one, zero, zero), Vector::new(zero, -q.z, q.y)),
        row(q.y, Vector::new(zero, one, zero), Vector::new(q.z, zero, -q.x)),
        row(q.z, Vector::new(zero, zero, one), Vector::new(-q.y, q.x, zero)),
    ]
}
