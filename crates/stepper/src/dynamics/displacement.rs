//! First-order displacement: `T(x)·d` and its transpose (SPEC section 5).

use crate::real::Real;
use crate::vector::Vector;

/// The unknowns of a block, or what is conjugate to them: (u, v, w, rx, ry, rz, εx, εy, εz, γyz, γzx, γxy).
pub type BlockVector<R> = [R; 12];

/// `T(x)·d`, the displacement of a point at `arm` from the centroid (m).
#[inline(always)]
pub fn displacement<R: Real>(arm: Vector<R>, d: &BlockVector<R>) -> Vector<R> {
    let half = R::from_f64(0.5);
    let (turn, strain) = (Vector::new(d[3], d[4], d[5]), Vector::new(d[6], d[7], d[8]));
    let (yz, zx, xy) = (d[9] * half, d[10] * half, d[11] * half);
    let stretch = Vector::new(
        strain.x * arm.x + xy * arm.y + zx * arm.z,
        xy * arm.x + strain.y * arm.y + yz * arm.z,
        zx * arm.x + yz * arm.y + strain.z * arm.z,
    );
    Vector::new(d[0], d[1], d[2]) + turn.cross(arm) + stretch
}

/// `T(x)ᵀ·f`, what a force at `arm` from the centroid does to the twelve unknowns.
#[inline(always)]
pub fn generalized<R: Real>(arm: Vector<R>, force: Vector<R>) -> BlockVector<R> {
    let half = R::from_f64(0.5);
    let moment = arm.cross(force);
    [
        force.x,
        force.y,
        force.z,
        moment.x,
        moment.y,
        moment.z,
        arm.x * force.x,
        arm.y * force.y,
        arm.z * force.z,
        (arm.z * force.y + arm.y * force.z) * half,
        (arm.z * force.x + arm.x * force.z) * half,
        (arm.y * force.x + arm.x * force.y) * half,
    ]
}

/// Adds to the unknowns of a block, 12 or 6, a vector times a factor if there is one. Of known lengths, so that the loops can be unrolled.
#[inline(always)]
pub(super) fn add<R: Real>(total: &mut [R], share: &BlockVector<R>, factor: Option<R>) {
    if let Some(total) = total.first_chunk_mut::<12>() {
        add_unknowns(total, share, factor);
    } else if let Some(total) = total.first_chunk_mut::<6>() {
        add_unknowns(total, share, factor);
    }
}

#[inline(always)]
fn add_unknowns<R: Real, const UNKNOWNS: usize>(total: &mut [R; UNKNOWNS], share: &BlockVector<R>, factor: Option<R>) {
    for (total, &share) in total.iter_mut().zip(share) {
        *total = *total + factor.map_or(share, |factor| share * factor);
    }
}

/// The dot product of the first `n` numbers.
pub(super) fn dot<R: Real>(a: &BlockVector<R>, b: &BlockVector<R>, n: usize) -> R {
    a[..n].iter().zip(&b[..n]).fold(R::ZERO, |sum, (&a, &b)| sum + a * b)
}
