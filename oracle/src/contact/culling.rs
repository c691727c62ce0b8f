//! Culling: which features can take part in a contact at all.
//!
//! Everything a contact needs lies within `max(s, g, r)` of the other block: v-v and v-e ask for a distance ≤ s, and
//! the gap of a v-f or e-e contact is the distance of two points of the features. (For v-f, the foot lies in the
//! projected polygon, which is within the face's bulge of the face itself.) So a feature whose box, grown by that,
//! misses the other block's box is in no contact. The boxes are compared in f64 with slack for every rounding.
//!
//! A v-f or e-e contact that is kept may be deeper than g, and so be left out here: those are looked at by name.

use crate::classification::{Classification, Observer};
use crate::prepared_block::{PreparedBlock, PreparedEdge};
use rockproof_model::decision::Side;
use rockproof_model::{ContactKey, EdgeId, VertexId};
use smallvec::SmallVec;

/// The features of one block that can take part in a contact: vertices, and edges that are convex.
#[derive(Default)]
pub(crate) struct NearFeatures {
    pub(crate) vertices: SmallVec<[VertexId; 32]>,
    pub(crate) edges: SmallVec<[EdgeId; 32]>,
}

/// Distances (in units of the lattice) that features farther apart certainly exceed, slack included.
pub(crate) struct CullingDistances {
    /// Farther apart they are in no contact.
    pub(crate) contact: f64,
    /// Farther apart they are not in one another's territory.
    pub(crate) territory: f64,
}

/// A box, grown so that comparing with it errs only towards keeping a feature.
pub(crate) struct GrownBox {
    min: [f64; 3],
    max: [f64; 3],
}

impl GrownBox {
    /// Whether a box is certainly outside; NaN is never certain.
    #[inline(always)]
    fn misses(&self, min: &[f64; 3], max: &[f64; 3]) -> bool {
        along_some_axis(|k| (max[k] < self.min[k]) | (min[k] > self.max[k]))
    }
}

impl<O: Observer> Classification<'_, '_, O> {
    /// The distances beyond which features are left out.
    pub(crate) fn culling_distances(&self) -> CullingDistances {
        let (a, b) = (self.pair.a, self.pair.b);
        let scales = self.float_view().scales;
        let [search, territory, penetration] = [scales.search.0, scales.territory.0, scales.penetration.0];
        let coordinates = [a, b].into_iter().flat_map(|s| s.box_min.into_iter().chain(s.box_max));
        let magnitude = coordinates.map(f64::abs).fold(0.0, f64::max);
        // Eight roundings at most, each relative to the largest coordinate or to the distance itself.
        let with_slack = |length: f64| {
            (length + a.errors.coordinate + b.errors.coordinate) * (1.0 + 1e-12) + 8.0 * f64::EPSILON * magnitude
        };
        let largest = search.max(territory).max(penetration);
        CullingDistances {
            contact: with_slack(largest + a.bulge.max(b.bulge)),
            territory: with_slack(if self.classic { search } else { territory }),
        }
    }

    /// Adds the features of the block on `side` that come within `distance` of the other block's box.
    pub(crate) fn find_features_within(&self, side: Side, distance: f64, near: &mut NearFeatures) {
        let (prepared, other) = (self.pair.prepared(side), self.pair.prepared(side.other()));
        let grown = GrownBox { min: other.box_min.map(|c| c - distance), max: other.box_max.map(|c| c + distance) };
        for v in prepared.block.topology().vertex_ids() {
            let at = point(prepared, v);
            if !grown.misses(&at, &at) {
                near.vertices.push(v);
            }
        }
        for (e, PreparedEdge { bounds: [min, max], .. }) in (0..).map(EdgeId).zip(&prepared.edges) {
            // Reflex edges have no contacts of their own.
            if !grown.misses(min, max) && prepared.block.edge_is_convex(e) {
                near.edges.push(e);
            }
        }
    }

    /// The vertices of the block on `side` that are named by kept contacts with faces and not in `near`; each once.
    pub(crate) fn kept_vertices_beyond(&self, side: Side, near: &NearFeatures) -> SmallVec<[VertexId; 4]> {
        let mut beyond = SmallVec::new();
        let count = self.pair.topology(side).vertex_count();
        for vertex in self.kept.iter().filter_map(|contact| vertex_of_face_contact(side, *contact)) {
            if vertex.index() < count && !near.vertices.contains(&vertex) && !beyond.contains(&vertex) {
                beyond.push(vertex);
            }
        }
        beyond
    }

    /// The edge pairs named by kept contacts that `a`, `b` and `distance` leave out; each once.
    pub(crate) fn kept_edges_beyond(
        &self,
        a: &NearFeatures,
        b: &NearFeatures,
        distance: f64,
    ) -> SmallVec<[(EdgeId, EdgeId); 4]> {
        let mut beyond = SmallVec::new();
        let [count_a, count_b] = [Side::A, Side::B].map(|side| self.pair.topology(side).edges().len());
        for contact in self.kept {
            let ContactKey::EdgeEdge(edge_a, edge_b) = *contact else { continue };
            let exist = edge_a.index() < count_a && edge_b.index() < count_b;
            let looked_at = |run: &Self| {
                a.edges.contains(&edge_a)
                    && b.edges.contains(&edge_b)
                    && !run.edges_out_of_reach(edge_a, edge_b, distance)
            };
            if exist && !looked_at(self) && !beyond.contains(&(edge_a, edge_b)) {
                beyond.push((edge_a, edge_b));
            }
        }
        beyond
    }

    /// Whether two edges are certainly further apart than `distance`.
    #[inline(always)]
    pub(crate) fn edges_out_of_reach(&self, edge_a: EdgeId, edge_b: EdgeId, distance: f64) -> bool {
        let [min_a, max_a] = &self.pair.a.edges[edge_a.index()].bounds;
        let [min_b, max_b] = &self.pair.b.edges[edge_b.index()].bounds;
        along_some_axis(|k| (max_a[k] + distance < min_b[k]) | (min_a[k] - distance > max_b[k]))
    }

    /// Whether two vertices are certainly further apart than `distance` along some axis.
    #[inline(always)]
    pub(crate) fn vertices_out_of_reach(&self, a: VertexId, b: VertexId, distance: f64) -> bool {
        let (a, b) = (point(self.pair.a, a), point(self.pair.b, b));
        along_some_axis(|k| (a[k] - b[k]).abs() > distance)
    }

    /// Whether a vertex is certainly further than `distance` from an edge of the other block.
    #[inline(always)]
    pub(crate) fn vertex_out_of_reach_of_edge(&self, vertex: (Side, VertexId), edge: EdgeId, distance: f64) -> bool {
        let at = point(self.pair.prepared(vertex.0), vertex.1);
        let [min, max] = &self.pair.prepared(vertex.0.other()).edges[edge.index()].bounds;
        along_some_axis(|k| (at[k] + distance < min[k]) | (at[k] - distance > max[k]))
    }
}

/// Whether something holds along one axis or more. All are looked at: that is cheaper than to guess where to stop.
#[inline(always)]
fn along_some_axis(holds: impl Fn(usize) -> bool) -> bool {
    holds(0) | holds(1) | holds(2)
}

/// The vertex of the block on `side` that a contact with a face of the other block is about.
fn vertex_of_face_contact(side: Side, contact: ContactKey) -> Option<VertexId> {
    match (side, contact) {
        (Side::A, ContactKey::VertexFace(vertex, _)) | (Side::B, ContactKey::FaceVertex(_, vertex)) => Some(vertex),
        _ => None,
    }
}

#[inline(always)]
fn point(prepared: &PreparedBlock, vertex: VertexId) -> [f64; 3] {
    let v = &prepared.vertices[vertex.index()];
    [v.x.0, v.y.0, v.z.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::classification::Unobserved;
    use crate::pair::Pair;
    use crate::soundness::without_tolerances;
    use rockproof_model::{Block, FaceId, Number, Vec3};

    /// A cube of this size, from the origin on, in parts of 1/3.
    fn cube(thirds: i32) -> PreparedBlock {
        let third = Number::from_rational(num_rational::BigRational::new(1.into(), 3.into()));
        let at = |c: i32| Vec3::new(c, c, c).map(|&c| Number::from_integer(c).times(&third));
        PreparedBlock::new(&Block::cuboid(&at(0), &at(thirds)).unwrap())
    }

    /// A kept contact of edges is looked at by name unless both are in reach, and of one another.
    #[test]
    fn kept_edges_are_looked_at_once() {
        let (a, b) = (cube(3), cube(2));
        let (pair, t) = (Pair::new(&a, &b), without_tolerances());
        let kept = [ContactKey::EdgeEdge(EdgeId(0), EdgeId(1)), ContactKey::VertexFace(VertexId(0), FaceId(0))];
        let run = Classification::new(&pair, &t, Unobserved).with_kept(&kept);
        let near = |edges: &[u32]| NearFeatures {
            edges: edges.iter().copied().map(EdgeId).collect(),
            ..NearFeatures::default()
        };
        let beyond = |a: &[u32], b: &[u32], distance| run.kept_edges_beyond(&near(a), &near(b), distance).to_vec();
        let it = vec![(EdgeId(0), EdgeId(1))];
        assert_eq!(beyond(&[], &[], 1e9), it);
        assert_eq!(beyond(&[0], &[], 1e9), it);
        assert_eq!(beyond(&[], &[1], 1e9), it);
        assert_eq!(beyond(&[0], &[1], 1e9), []);
        assert_eq!(beyond(&[0], &[1], -1e9), it, "too far from one another");
    }

    /// The distances make up for coordinates that f64 does not hold and for the roundings in comparing.
    #[test]
    fn without_tolerances_the_distances_are_those_of_roundings() {
        let (a, b) = (cube(4), cube(2));
        let (pair, t) = (Pair::new(&a, &b), without_tolerances());
        let run = Classification::new(&pair, &t, Unobserved);
        let off = a.errors.coordinate + b.errors.coordinate;
        assert!(off > 0.0);
        let CullingDistances { contact, territory } = run.culling_distances();
        assert!(contact.min(territory) >= off + 8.0 * f64::EPSILON * 4.0 / 3.0, "{contact:e} {territory:e}");
    }
}
