//! Vectors of exact rationals.

use crate::rational::Rational;
use rockproof_model::Vec3;

/// `u + v`.
pub(super) fn sum<Q: Rational>(u: &Vec3<Q>, v: &Vec3<Q>) -> Vec3<Q> {
    Vec3::new(u.x.plus(&v.x), u.y.plus(&v.y), u.z.plus(&v.z))
}

/// `u − v`.
pub(super) fn difference<Q: Rational>(u: &Vec3<Q>, v: &Vec3<Q>) -> Vec3<Q> {
    Vec3::new(u.x.minus(&v.x), u.y.minus(&v.y), u.z.minus(&v.z))
}

/// `−u`.
pub(super) fn opposite<Q: Rational>(u: &Vec3<Q>) -> Vec3<Q> {
    u.map(Q::negated)
}

/// `factor · u`.
pub(super) fn multiple<Q: Rational>(factor: &Q, u: &Vec3<Q>) -> Vec3<Q> {
    u.map(|c| c.times(factor))
}

/// `u · v`.
pub(super) fn dot<Q: Rational>(u: &Vec3<Q>, v: &Vec3<Q>) -> Q {
    u.x.times(&v.x).plus(&u.y.times(&v.y)).plus(&u.z.times(&v.z))
}

/// `u × v`.
pub(super) fn cross<Q: Rational>(u: &Vec3<Q>, v: &Vec3<Q>) -> Vec3<Q> {
    Vec3::new(
        u.y.times(&v.z).minus(&u.z.times(&v.y)),
        u.z.times(&v.x).minus(&u.x.times(&v.z)),
        u.x.times(&v.y).minus(&u.y.times(&v.x)),
    )
}

/// `|u|²`.
pub(super) fn squared_length<Q: Rational>(u: &Vec3<Q>) -> Q {
    dot(u, u)
}
