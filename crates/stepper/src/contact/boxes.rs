//! Boxes: which blocks are neighbours, and which features of two neighbours can be in a contact at all.

use crate::contact::classify::ClassificationRequest;
use crate::contact::contact_rules::ContactRules;
use crate::contact::prepared_block::PreparedBlock;
use crate::contact::tolerances::Tolerances;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::decision::Side;
use rockproof_model::{ContactKey, EdgeId, VertexId};

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds<R> {
    /// The corner with the smallest coordinates.
    pub low: Vector<R>,
    /// The corner with the largest coordinates.
    pub high: Vector<R>,
}

impl<R: Real> Bounds<R> {
    /// The box of one point.
    #[inline]
    pub fn of_point(at: Vector<R>) -> Bounds<R> {
        Bounds { low: at, high: at }
    }

    /// The box around two boxes.
    #[inline]
    pub fn joined(&self, other: &Bounds<R>) -> Bounds<R> {
        Bounds { low: self.low.smaller(other.low), high: self.high.larger(other.high) }
    }

    /// Along each axis, how far two boxes are apart; negative where they overlap.
    #[inline]
    pub fn apart(&self, other: &Bounds<R>) -> [R; 3] {
        let above = (self.low - other.high).components();
        let below = (other.low - self.high).components();
        [above[0].larger(below[0]), above[1].larger(below[1]), above[2].larger(below[2])]
    }

    /// Whether the boxes are farther apart than `reach` along some axis. For culling: not counted as a decision.
    #[inline]
    pub fn beyond(&self, other: &Bounds<R>, reach: R) -> bool {
        reach.below(self.low.x - other.high.x)
            || reach.below(other.low.x - self.high.x)
            || reach.below(self.low.y - other.high.y)
            || reach.below(other.low.y - self.high.y)
            || reach.below(self.low.z - other.high.z)
            || reach.below(other.low.z - self.high.z)
    }

    /// Whether a point is farther from the box than `reach` along some axis. For culling: not counted as a decision.
    #[inline]
    pub fn is_beyond(&self, point: Vector<R>, reach: R) -> bool {
        Bounds::of_point(point).beyond(self, reach)
    }
}

/// Rough phase: A's box grown by s meets B's. **Touching counts.**
pub fn neighbours<R: Real, M: ContactRules>(a: &PreparedBlock<R>, b: &PreparedBlock<R>, t: &Tolerances<R>) -> bool {
    a.bounds().apart(b.bounds()).into_iter().all(|apart| M::neighbours(apart, t.search))
}

/// How far apart the features of a contact of this pair may be: the tolerances' reach, or farther where the features of a
/// kept contact are. Those of v-v and v-e contacts are within s, kept or not.
pub(super) fn reach_of_kept<R: Real>(request: ClassificationRequest<'_, R>) -> R {
    let ClassificationRequest { a, b, tolerances, kept, .. } = request;
    let at = |prepared: &PreparedBlock<R>, v: VertexId| Bounds::of_point(prepared.vertex(v).at);
    kept.iter().fold(tolerances.reach, |reach, key| {
        let apart = match *key {
            ContactKey::VertexFace(v, _) => at(a, v).apart(b.bounds()),
            ContactKey::FaceVertex(_, v) => at(b, v).apart(a.bounds()),
            ContactKey::EdgeEdge(e, f) => a.edge(e).bounds().apart(&b.edge(f).bounds()),
            ContactKey::VertexVertex(..) | ContactKey::VertexEdge(..) | ContactKey::EdgeVertex(..) => return reach,
        };
        apart.into_iter().fold(reach, R::larger)
    })
}

/// How far from the box of a block a vertex may be that has a contact with a face of it. Its foot is in the face's plane, and above or
/// below the hull of the face's corners by their distance from that plane at most. A thirty-second of the reach is half of what it holds
/// for rounding: so planar faces, as rounding leaves them, change nothing.
fn reach_of_faces<R: Real>(prepared: &PreparedBlock<R>, reach: R) -> R {
    let bulge = prepared.bulge();
    if (reach * R::from_f64(0.03125)).below(bulge) { reach + bulge * R::from_f64(1.0625) } else { reach }
}

/// The features of two neighbours that are within reach of the other block's box.
#[derive(Debug)]
pub(super) struct NearFeatures<R> {
    vertices: [Vec<VertexId>; 2],
    edges: [Vec<(EdgeId, Bounds<R>)>; 2],
}

impl<R: Real> NearFeatures<R> {
    pub(super) fn new<M: ContactRules>(a: &PreparedBlock<R>, b: &PreparedBlock<R>, reach: R) -> NearFeatures<R> {
        NearFeatures {
            vertices: [
                near_vertices(a, b.bounds(), reach_of_faces(b, reach)),
                near_vertices(b, a.bounds(), reach_of_faces(a, reach)),
            ],
            edges: [near_edges::<R, M>(a, b.bounds(), reach), near_edges::<R, M>(b, a.bounds(), reach)],
        }
    }

    /// Vertices of the block on `side`, ascending.
    pub(super) fn vertices(&self, side: Side) -> &[VertexId] {
        &self.vertices[side as usize]
    }

    /// Edges of the block on `side` that take part in contacts, ascending, with their boxes.
    pub(super) fn edges(&self, side: Side) -> &[(EdgeId, Bounds<R>)] {
        &self.edges[side as usize]
    }
}

fn near_vertices<R: Real>(prepared: &PreparedBlock<R>, other: &Bounds<R>, reach: R) -> Vec<VertexId> {
    let mut near = Vec::with_capacity(prepared.vertices().len());
    near.extend(
        (0..).map(VertexId).zip(prepared.vertices()).filter(|(_, v)| !other.is_beyond(v.at, reach)).map(|(i, _)| i),
    );
    near
}

fn near_edges<R: Real, M: ContactRules>(
    prepared: &PreparedBlock<R>,
    other: &Bounds<R>,
    reach: R,
) -> Vec<(EdgeId, Bounds<R>)> {
    let mut near = Vec::with_capacity(prepared.edges().len());
    let takes_part = (0..).map(EdgeId).zip(prepared.edges()).filter(|(_, e)| M::edge_takes_part(e.convex));
    near.extend(takes_part.map(|(i, e)| (i, e.bounds())).filter(|(_, bounds)| !other.beyond(bounds, reach)));
    near
}
