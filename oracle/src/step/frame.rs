//! The displacement matrix T(x) and its transpose.

use crate::field::Field;
use crate::mass::TURNS_AND_STRAINS;
use rockproof_model::Vec3;

/// Unknowns of a deformable block.
pub(crate) const UNKNOWNS: usize = 12;

/// `T(x)ᵀ·n`, X relative to the centroid.
pub(crate) fn pull<S: Field>(x: &Vec3<S>, n: &Vec3<S>) -> Vec<S> {
    let (x, n) = (x.components(), n.components());
    let turned = TURNS_AND_STRAINS.iter().map(|terms| {
        let sum = terms.iter().fold(S::from_i32(0), |sum, &(row, axis, twice)| {
            sum.plus(&n[row].times(x[axis]).times(&S::from_i32(twice)))
        });
        sum.half()
    });
    n.into_iter().cloned().chain(turned).collect()
}

/// `T(x)·d`, X relative to the centroid; unknowns that d does not have are zero.
pub(crate) fn displacement<S: Field>(x: &Vec3<S>, d: &[S]) -> Vec3<S> {
    if d.is_empty() {
        return Vec3::zero();
    }
    let x = x.components();
    let mut sum = [d[0].clone(), d[1].clone(), d[2].clone()];
    for (k, value) in d.iter().enumerate().skip(3) {
        for &(row, axis, twice) in TURNS_AND_STRAINS[k - 3] {
            let part = value.times(x[axis]);
            let part = match twice {
                2 => part,
                -2 => part.negated(),
                _ => part.half(),
            };
            sum[row] = sum[row].plus(&part);
        }
    }
    let [u, v, w] = sum;
    Vec3::new(u, v, w)
}
