//! The geometry of a contact: points, normal, gap and start stretch, with nothing divided by a square root.

use super::frame;
use crate::field::Field;
use crate::mass::{Moments, difference, over};
use rockproof_model::block::face_normal;
use rockproof_model::{Block, Contact, EntranceKind, Point, Vec3};

/// A contact in one number type. N is the normal, from B to A, not of unit length.
pub(crate) struct ContactGeometry<S> {
    /// `|N|²`.
    pub(crate) square: S,
    pub(crate) normal: Vec3<S>,
    /// `N·(P − Q)`: the gap h0 times |N|.
    pub(crate) gap: S,
    /// The point of A and the point of B, each relative to its centroid.
    pub(crate) points: [Vec3<S>; 2],
    /// `T(P)ᵀN` and `T(Q)ᵀN`.
    pub(crate) pulls: [Vec<S>; 2],
    /// s0: the stretch of A against B when the step begins.
    pub(crate) stretch: Vec3<S>,
}

/// Both blocks of a contact, A first.
pub(crate) struct Both<'a, S> {
    pub(crate) blocks: [&'a Block; 2],
    pub(crate) moments: [&'a Moments<S>; 2],
    pub(crate) bits: u32,
}

impl<S: Field> Both<'_, S> {
    /// Vertices of a block relative to B's vertex 0.
    fn points(&self, side: usize) -> Vec<Vec3<S>> {
        let origin = &self.blocks[1].vertices()[0];
        self.blocks[side].vertices().iter().map(|v| difference(v, origin, self.bits)).collect()
    }

    /// A face's normal and its vertices' mean.
    fn plane(&self, side: usize, face: u32) -> Option<(Vec3<S>, Vec3<S>)> {
        let points = self.points(side);
        let boundary = &self.blocks[side].topology().faces()[face as usize];
        let sum = boundary.iter().fold(Vec3::zero(), |sum: Vec3<S>, &v| sum.plus(&points[v as usize]));
        Some((face_normal(&points, boundary), over(&sum, &S::from_i32(boundary.len() as i32))?))
    }

    fn edge(&self, side: usize, edge: u32) -> (Vec3<S>, Vec3<S>) {
        let ends = &self.blocks[side].topology().edges()[edge as usize];
        let points = self.points(side);
        let start = points[ends.p as usize].clone();
        (points[ends.q as usize].minus(&start), start)
    }
}

impl<S: Field> ContactGeometry<S> {
    /// The geometry of a contact; `anchors` are those it keeps, `None` for a stretch of zero.
    pub(crate) fn new(both: &Both<'_, S>, contact: &Contact, anchors: Option<&[Point; 2]>) -> Option<Self> {
        let entrance = contact.entrance;
        let [normal, p, q] = match entrance.kind {
            EntranceKind::VertexFace => {
                let (normal, middle) = both.plane(1, entrance.b)?;
                let p = both.points(0)[entrance.a as usize].clone();
                let share = normal.dot(&p.minus(&middle)).over(&normal.norm_squared())?;
                let q = p.minus(&normal.scaled(&share));
                [normal, p, q]
            }
            EntranceKind::FaceVertex => {
                let (outward, middle) = both.plane(0, entrance.a)?;
                let q = both.points(1)[entrance.b as usize].clone();
                let share = outward.dot(&q.minus(&middle)).over(&outward.norm_squared())?;
                let p = q.minus(&outward.scaled(&share));
                [outward.negated(), p, q]
            }
            EntranceKind::EdgeEdge => edges(both, entrance.a, entrance.b, contact)?,
        };
        let square = normal.norm_squared();
        let gap = normal.dot(&p.minus(&q));
        let [a, b] = both.blocks.map(|block| &block.vertices()[0]);
        let a_from_b: Vec3<S> = difference(a, b, both.bits);
        let points = [p.minus(&a_from_b).minus(&both.moments[0].centroid), q.minus(&both.moments[1].centroid)];
        let pulls = [frame::pull(&points[0], &normal), frame::pull(&points[1], &normal)];
        let stretch = match anchors {
            None => Vec3::zero(),
            Some([own, other]) => tangential(&difference(own, other, both.bits), &normal, &square)?,
        };
        Some(ContactGeometry { square, normal, gap, points, pulls, stretch })
    }

    /// The part of a vector across N.
    pub(crate) fn across(&self, v: &Vec3<S>) -> Option<Vec3<S>> {
        tangential(v, &self.normal, &self.square)
    }
}

fn tangential<S: Field>(v: &Vec3<S>, normal: &Vec3<S>, square: &S) -> Option<Vec3<S>> {
    Some(v.minus(&normal.scaled(&v.dot(normal).over(square)?)))
}

/// Normal and feet of two edges' lines. σ is known from the sign of the gap that classification found, or, touching or
/// degenerate, from the wedges (SPEC section 4).
fn edges<S: Field>(both: &Both<'_, S>, a: u32, b: u32, contact: &Contact) -> Option<[Vec3<S>; 3]> {
    let ((d1, p1), (d2, p2)) = (both.edge(0, a), both.edge(1, b));
    let cross = d1.cross(&d2);
    let square = cross.norm_squared();
    let apart = p2.minus(&p1);
    // p1 + t·d1 and p2 + s·d2 with t = (apart × d2)·n/|n|², s = (apart × d1)·n/|n|².
    let t = apart.cross(&d2).dot(&cross).over(&square)?;
    let s = apart.cross(&d1).dot(&cross).over(&square)?;
    let (p, q) = (p1.plus(&d1.scaled(&t)), p2.plus(&d2.scaled(&s)));
    let value = if contact.gap.is_zero() {
        let inward = |side: usize, edge: u32, d: &Vec3<S>| -> Option<Vec3<S>> {
            let ends = &both.blocks[side].topology().edges()[edge as usize];
            let left = both.plane(side, ends.left)?.0.cross(d);
            Some(left.plus(&both.plane(side, ends.right)?.0.cross(&d.negated())))
        };
        cross.dot(&inward(0, a, &d1)?).minus(&cross.dot(&inward(1, b, &d2)?)).certain_sign()?.is_negative()
    } else {
        let raw = cross.dot(&p1.minus(&p2)).certain_sign()?;
        raw.is_negative() != contact.gap.is_negative()
    };
    Some([if value { cross.negated() } else { cross }, p, q])
}
