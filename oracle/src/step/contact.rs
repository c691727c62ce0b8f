//! The geometry of a contact: points, normal, gap and start stretch, with nothing divided by a square root.

use super::frame;
use crate::field::{Field, Halve, LANES, Packed, packed_vector};
use crate::mass::{difference, over};
use rockproof_model::block::face_normal;
use rockproof_model::{Block, Contact, EdgeId, Entrance, FaceId, Point, Ring, Sign, Vec3, VertexId};

/// A contact in one number type. N is the normal, from B to A, not of unit length.
pub(crate) struct ContactGeometry<S> {
    /// `|N|²`.
    pub(crate) square: S,
    pub(crate) normal: Vec3<S>,
    /// `N·(P − Q)`: the gap h0 times |N|.
    pub(crate) gap: S,
    /// The point of A and the point of B, each relative to its centroid.
    pub(crate) points: [Vec3<S>; 2],
    /// `1/|N|²`.
    pub(crate) over_square: S,
    /// s0: the stretch of A against B when the step begins.
    pub(crate) stretch: Vec3<S>,
}

/// Both blocks of a contact, A first, in one number type.
pub(crate) struct Sides<'a, S> {
    pub(crate) blocks: [&'a Block; 2],
    /// Vertices, each relative to its block's vertex 0.
    pub(crate) points: [&'a [Vec3<S>]; 2],
    /// A's vertex 0 relative to B's.
    offset: Vec3<S>,
}

impl<'a, S: Field> Sides<'a, S> {
    /// Both sides; `points` are relative to the blocks' vertices 0.
    pub(crate) fn new(blocks: [&'a Block; 2], points: [&'a [Vec3<S>]; 2], bits: u32) -> Sides<'a, S> {
        let offset = difference(&blocks[0].vertices()[0], &blocks[1].vertices()[0], bits);
        Sides { blocks, points, offset }
    }

    /// The mean of a face's vertices.
    fn middle(&self, side: usize, face: FaceId) -> Option<Vec3<S>> {
        let boundary = self.blocks[side].topology().face(face);
        let sum = boundary.iter().fold(Vec3::zero(), |sum: Vec3<S>, &v| sum.plus(&self.points[side][v.index()]));
        let mean = over(&sum, &S::from_i32(boundary.len() as i32))?;
        Some(if side == 0 { mean.plus(&self.offset) } else { mean })
    }

    /// N of a contact, from B to A.
    pub(crate) fn normal(&self, contact: &Contact) -> Option<Vec3<S>> {
        self.normal_by(contact, S::certain_sign)
    }

    /// `N·(P − Q)`, from the features themselves: the feet would lose digits.
    fn gap(&self, contact: &Contact, normal: &Vec3<S>) -> Option<S> {
        let apart = match contact.entrance {
            Entrance::VertexFace(vertex, face) => self.point(0, vertex).minus(&self.middle(1, face)?),
            Entrance::FaceVertex(face, vertex) => self.middle(0, face)?.minus(&self.point(1, vertex)),
            Entrance::EdgeEdge(edge_a, edge_b) => self.edge(0, edge_a).1.minus(&self.edge(1, edge_b).1),
        };
        Some(normal.dot(&apart))
    }

    /// P on A and Q on B.
    fn feet(&self, contact: &Contact, normal: &Vec3<S>, over_square: &S) -> Option<[Vec3<S>; 2]> {
        let foot = |point: &Vec3<S>, middle: &Vec3<S>| {
            let share = normal.dot(&point.minus(middle)).times(over_square);
            point.minus(&normal.scaled(&share))
        };
        match contact.entrance {
            Entrance::VertexFace(vertex, face) => {
                let p = self.point(0, vertex);
                let q = foot(&p, &self.middle(1, face)?);
                Some([p, q])
            }
            Entrance::FaceVertex(face, vertex) => {
                let q = self.point(1, vertex);
                let p = foot(&q, &self.middle(0, face)?);
                Some([p, q])
            }
            Entrance::EdgeEdge(edge_a, edge_b) => {
                let ((d1, p1), (d2, p2)) = (self.edge(0, edge_a), self.edge(1, edge_b));
                let (cross, apart) = (d1.cross(&d2), p2.minus(&p1));
                // p1 + t·d1 and p2 + s·d2 with t = (apart × d2)·n/|n|², s = (apart × d1)·n/|n|².
                let t = apart.cross(&d2).dot(&cross).times(over_square);
                let s = apart.cross(&d1).dot(&cross).times(over_square);
                Some([p1.plus(&d1.scaled(&t)), p2.plus(&d2.scaled(&s))])
            }
        }
    }
}

impl<'a, S: Ring> Sides<'a, S> {
    /// Both sides; `points` are relative to the blocks' vertices 0, and `offset` is A's relative to B's.
    pub(crate) fn with_offset(blocks: [&'a Block; 2], points: [&'a [Vec3<S>]; 2], offset: Vec3<S>) -> Sides<'a, S> {
        Sides { blocks, points, offset }
    }

    /// A vertex relative to B's vertex 0.
    pub(crate) fn point(&self, side: usize, vertex: VertexId) -> Vec3<S> {
        let own = &self.points[side][vertex.index()];
        if side == 0 { own.plus(&self.offset) } else { own.clone() }
    }

    /// `N_f`.
    pub(crate) fn face_normal(&self, side: usize, face: FaceId) -> Vec3<S> {
        face_normal(self.points[side], self.blocks[side].topology().face(face))
    }

    /// An edge's direction and its first end.
    fn edge(&self, side: usize, edge: EdgeId) -> (Vec3<S>, Vec3<S>) {
        let ends = self.blocks[side].topology().edge(edge);
        let [p, q] = [ends.p, ends.q].map(|v| &self.points[side][v.index()]);
        (q.minus(p), self.point(side, ends.p))
    }

    /// `m_L + m_R` of an edge.
    fn lean(&self, side: usize, edge: EdgeId) -> Vec3<S> {
        let ends = self.blocks[side].topology().edge(edge);
        let (d, _) = self.edge(side, edge);
        self.face_normal(side, ends.left).cross(&d).plus(&self.face_normal(side, ends.right).cross(&d.negated()))
    }

    /// N of a contact, from B to A, in a type that says the sign of a number where it knows it.
    pub(crate) fn normal_by(&self, contact: &Contact, sign: impl Fn(&S) -> Option<Sign>) -> Option<Vec3<S>> {
        match contact.entrance {
            Entrance::VertexFace(_, face) => Some(self.face_normal(1, face)),
            Entrance::FaceVertex(face, _) => Some(self.face_normal(0, face).negated()),
            Entrance::EdgeEdge(edge_a, edge_b) => {
                let ((d1, p1), (d2, p2)) = (self.edge(0, edge_a), self.edge(1, edge_b));
                let cross = d1.cross(&d2);
                // σ is known from the sign of the gap that classification found, or, touching, from the wedges.
                let turned = if contact.gap.is_zero() {
                    let lean = cross.dot(&self.lean(0, edge_a)).minus(&cross.dot(&self.lean(1, edge_b)));
                    sign(&lean)?.is_negative()
                } else {
                    sign(&cross.dot(&p1.minus(&p2)))?.is_negative() != contact.gap.is_negative()
                };
                Some(if turned { cross.negated() } else { cross })
            }
        }
    }
}

impl<S: Field> ContactGeometry<S> {
    /// The geometry of a contact; `anchors` are those it keeps, `None` for a stretch of zero.
    pub(crate) fn new(
        sides: &Sides<'_, S>,
        centroids: [&Vec3<S>; 2],
        contact: &Contact,
        anchors: Option<&[Point; 2]>,
        bits: u32,
    ) -> Option<Self> {
        let normal = sides.normal(contact)?;
        let square = normal.norm_squared();
        let gap = sides.gap(contact, &normal)?;
        let over_square = S::from_i32(1).over(&square)?;
        let [p, q] = sides.feet(contact, &normal, &over_square)?;
        let points = [p.minus(&sides.offset).minus(centroids[0]), q.minus(centroids[1])];
        let mut geometry = ContactGeometry { square, over_square, normal, gap, points, stretch: Vec3::zero() };
        if let Some([own, other]) = anchors {
            let between = difference(own, other, bits);
            geometry.stretch = geometry.across(&between, &geometry.normal.dot(&between));
        }
        Some(geometry)
    }
}

impl<S: Halve> ContactGeometry<S> {
    /// How A's point moves against B's with these displacements.
    pub(crate) fn moved(&self, d: [&[S]; 2]) -> Vec3<S> {
        match [d[0].is_empty(), d[1].is_empty()] {
            [false, true] => frame::displacement(&self.points[0], d[0]),
            [true, false] => frame::displacement(&self.points[1], d[1]).negated(),
            _ => frame::displacement(&self.points[0], d[0]).minus(&frame::displacement(&self.points[1], d[1])),
        }
    }

    /// The part of a vector across N, `along` its product with N.
    pub(crate) fn across(&self, v: &Vec3<S>, along: &S) -> Vec3<S> {
        v.minus(&self.normal.scaled(&along.times(&self.over_square)))
    }
}

impl<P: Packed> ContactGeometry<P> {
    /// Four contacts together.
    pub(crate) fn packed(contacts: [&ContactGeometry<P::Single>; LANES]) -> ContactGeometry<P> {
        ContactGeometry {
            square: P::of(contacts.map(|contact| &contact.square)),
            normal: packed_vector(contacts.map(|contact| &contact.normal)),
            gap: P::of(contacts.map(|contact| &contact.gap)),
            points: [0, 1].map(|side: usize| packed_vector(contacts.map(|contact| &contact.points[side]))),
            over_square: P::of(contacts.map(|contact| &contact.over_square)),
            stretch: packed_vector(contacts.map(|contact| &contact.stretch)),
        }
    }

    /// How each of them moves with these displacements of its blocks.
    pub(crate) fn packed_moved(&self, d: [[&[P::Single]; 2]; LANES]) -> Vec3<P> {
        let zero = Ring::from_i32(0);
        let unknowns = [0, 1].map(|side: usize| {
            let of = d.map(|d| d[side]);
            let most = of.iter().map(|d| d.len()).max().unwrap_or(0);
            // What a block does not have is zero.
            (0..most).map(|k| P::of(of.map(|d| d.get(k).unwrap_or(&zero)))).collect::<Vec<P>>()
        });
        self.moved([&unknowns[0], &unknowns[1]])
    }
}
