//! The displacement matrix T(x) and its transpose.

use crate::field::{Field, Halve};
use crate::mass::TURNS_AND_STRAINS;
use rockproof_model::Vec3;

/// Unknowns of a deformable block.
pub(crate) const UNKNOWNS: usize = 12;

/// `value · twice/2`, twice one of −2, 1 and 2.
fn part<S: Halve>(value: S, twice: i32) -> S {
    match twice {
        2 => value,
        -2 => value.negated(),
        _ => value.half(),
    }
}

/// Entry k of `T(x)ᵀ·n`.
pub(crate) fn pulled<S: Halve>(x: [&S; 3], n: [&S; 3], k: usize) -> S {
    if k < 3 {
        return n[k].clone();
    }
    let [first, rest @ ..] = TURNS_AND_STRAINS[k - 3] else { return S::from_i32(0) };
    let term = |&(row, axis, twice): &(usize, usize, i32)| part(n[row].times(x[axis]), twice);
    rest.iter().fold(term(first), |sum, next| sum.plus(&term(next)))
}

/// `T(x)ᵀ·n`, X relative to the centroid.
pub(crate) fn generalized<S: Field>(x: &Vec3<S>, n: &Vec3<S>) -> Vec<S> {
    (0..UNKNOWNS).map(|k| pulled(x.components(), n.components(), k)).collect()
}

/// Adds `T(x)ᵀ·n` to a block's forces, as many as it has.
pub(crate) fn add_pull<S: Field>(forces: &mut [S], x: &Vec3<S>, n: &Vec3<S>) {
    for (k, force) in forces.iter_mut().enumerate() {
        *force = force.plus(&pulled(x.components(), n.components(), k));
    }
}

/// `T(x)·d`, X relative to the centroid; unknowns that d does not have are zero.
pub(crate) fn displacement<S: Halve>(x: &Vec3<S>, d: &[S]) -> Vec3<S> {
    if d.is_empty() {
        return Vec3::zero();
    }
    let x = x.components();
    let mut sum = [d[0].clone(), d[1].clone(), d[2].clone()];
    for (k, value) in d.iter().enumerate().skip(3) {
        for &(row, axis, twice) in TURNS_AND_STRAINS[k - 3] {
            sum[row] = sum[row].plus(&part(value.times(x[axis]), twice));
        }
    }
    let [u, v, w] = sum;
    Vec3::new(u, v, w)
}

/// The three rows of T(x).
pub(crate) fn rows<S: Field>(x: &Vec3<S>) -> [Vec<S>; 3] {
    std::array::from_fn(|axis| {
        let [a, b, c] = std::array::from_fn(|k| S::from_i32(i32::from(k == axis)));
        generalized(x, &Vec3::new(a, b, c))
    })
}

/// The three rows of T(x) in f64.
pub(crate) fn float_rows(x: &Vec3<f64>) -> [[f64; 12]; 3] {
    let x = [x.x, x.y, x.z];
    let mut rows = [[0.0; 12]; 3];
    for (axis, row) in rows.iter_mut().enumerate() {
        row[axis] = 1.0;
    }
    for (k, terms) in TURNS_AND_STRAINS.iter().enumerate() {
        for &(row, axis, twice) in *terms {
            rows[row][3 + k] = x[axis] * f64::from(twice) * 0.5;
        }
    }
    rows
}

/// Entry (r, c) of `T_oneᵀ·T_two`, from their rows.
pub(crate) fn along<S: Field>(one: &[Vec<S>; 3], two: &[Vec<S>; 3], r: usize, c: usize) -> S {
    (0..3).fold(S::from_i32(0), |sum, axis| {
        if one[axis][r].is_zero() || two[axis][c].is_zero() {
            sum
        } else {
            sum.plus(&one[axis][r].times(&two[axis][c]))
        }
    })
}
