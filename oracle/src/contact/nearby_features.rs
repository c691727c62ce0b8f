//! Which pairs of features can be in a contact while two blocks stay near where they are.
//!
//! Of most pairs of features SPEC section 4 refuses a contact, and would still do so if every vertex moved a little. [`Pair::nearby_features`] finds the
//! others (`nearby_feature_search.rs`), and [`Pair::classify_nearby`] puts only these through the tests, once it has proved that the blocks are still near.

#[cfg(test)]
mod tests;

use super::certified_reject::CertainPlace;
use super::classify::{Answer, exit_candidate};
use super::entrance::Planes;
use super::exit::ExitCandidate;
use crate::classification::{Classification, Observer, Unobserved};
use crate::number::Approx;
use crate::pair::Pair;
use crate::prepared_block::PreparedBlock;
use crate::view::Scales;
use rockproof_model::decision::Side;
use rockproof_model::{Block, Contact, ContactKey, FaceId, ToleranceSet, Vec3, VertexId};
use smallvec::SmallVec;

/// The pairs of features of two blocks that can be in a contact while no vertex of either moves further than a margin.
#[derive(Clone, Debug)]
pub struct NearbyFeatures {
    /// The blocks, A and B, where they were when the pairs were found.
    blocks: [PlacedBlock; 2],
    /// How far each coordinate of each vertex may be from there (m), but for a translation of both blocks alike.
    margin: f64,
    /// The lengths and sines of the tolerance set as f64 has them, and whether its criteria are classic.
    tolerances: ([f64; 6], bool),
    /// In the order in which they are looked at: by kind, and those of v-f and f-v by vertex.
    pairs: Box<[NearbyPair]>,
}

/// A block and its vertices in f64.
#[derive(Clone, Debug)]
struct PlacedBlock {
    block: Block,
    vertices: Box<[Vec3<Approx>]>,
}

/// A pair of features.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearbyPair {
    pub(super) key: ContactKey,
    /// The entrances that may pass their no-overlap checks; of v-f and e-e there is one, which is asked anyway.
    pub(super) planes: Planes,
}

impl NearbyFeatures {
    /// How many they are.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Whether there are none: then there is no contact.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Whether they are all that matters for a pair under these tolerances: it is the same pair, and no vertex is further than the margin from where it
    /// was. **Who is in doubt says no.**
    fn cover<O: Observer>(&self, run: &Classification<'_, '_, O>) -> bool {
        let pair = run.pair;
        let blocks = [pair.a, pair.b];
        let same = || blocks.into_iter().zip(&self.blocks).all(|(now, then)| now.block.has_shape_of(&then.block));
        if self.tolerances != approximate_tolerances(run) || !same() {
            return false;
        }
        // Both blocks moved alike change nothing.
        let [first, was] = [&pair.a.vertices[0], &self.blocks[0].vertices[0]];
        let common = first.minus(was);
        blocks.into_iter().zip(&self.blocks).all(|(now, then)| {
            // Of a coordinate that f64 does not hold what it is off by counts as a motion.
            let off = now.errors.coordinate + pair.a.errors.coordinate;
            now.vertices.iter().zip(&then.vertices).all(|(now, then)| {
                let moved = now.minus(then);
                let near = |moved: Approx, common: Approx| {
                    // Three roundings, each of numbers no larger than these.
                    let rounding = 2.0 * f64::EPSILON * (moved.0.abs() + common.0.abs());
                    (moved.0 - common.0).abs() + rounding + off <= self.margin
                };
                near(moved.x, common.x) & near(moved.y, common.y) & near(moved.z, common.z)
            })
        })
    }
}

/// The tolerances of SPEC section 4, rounded: what is found holds for all sets that round to the same.
fn approximate_tolerances<O: Observer>(run: &Classification<'_, '_, O>) -> ([f64; 6], bool) {
    let Scales { search, territory, penetration, overlap, parallel, equal, .. } = *run.float_view().scales;
    ([search, territory, penetration, overlap, parallel, equal].map(|number| number.0), run.classic)
}

impl Pair<'_> {
    /// The pairs of features that can be in a contact while each coordinate of each vertex stays within `margin` (m) of where it is, but for a translation
    /// that both blocks make alike. `None` where `margin` is no positive number.
    ///
    /// To find them costs as much as some ten classifications or more.
    pub fn nearby_features(&self, tolerances: &ToleranceSet, margin: f64) -> Option<NearbyFeatures> {
        if !(margin > 0.0 && margin.is_finite()) {
            return None;
        }
        let place = |prepared: &PreparedBlock| PlacedBlock {
            block: prepared.block.clone(),
            vertices: prepared.vertices.iter().copied().collect(),
        };
        let mut run = Classification::new(self, tolerances, Unobserved);
        let pairs = run.find_nearby_features(margin);
        Some(NearbyFeatures {
            blocks: [place(self.a), place(self.b)],
            margin,
            tolerances: approximate_tolerances(&run),
            pairs: pairs.into_boxed_slice(),
        })
    }

    /// As [`Pair::classify_with_kept`]: only the pairs of features `nearby` are looked at if the blocks are proved to be near where these were found, and all if
    /// not. The contacts are the same.
    pub fn classify_nearby(&self, tolerances: &ToleranceSet, nearby: &NearbyFeatures, kept: &[ContactKey]) -> Answer {
        self.classify_if_near(tolerances, nearby, kept).unwrap_or_else(|| self.classify_with_kept(tolerances, kept))
    }

    /// The same where the blocks are proved to be near; `None` where they are not.
    pub fn classify_if_near(
        &self,
        tolerances: &ToleranceSet,
        nearby: &NearbyFeatures,
        kept: &[ContactKey],
    ) -> Option<Answer> {
        let mut run = Classification::new(self, tolerances, Unobserved);
        run.kept = kept;
        if !nearby.cover(&run) {
            return None;
        }
        let contacts = run.classify_among(&nearby.pairs);
        Some(Answer { contacts, levels: run.cascade.levels })
    }
}

impl<O: Observer> Classification<'_, '_, O> {
    /// The contacts of these pairs of features and of those that are kept.
    fn classify_among(&mut self, nearby: &[NearbyPair]) -> Vec<Contact> {
        if !self.neighbours() {
            return Vec::new();
        }
        self.territory_distance = self.culling_distances().territory;
        let mut found = Vec::new();
        // By vertex, for the shortest exit.
        let mut faces: SmallVec<[(Side, VertexId, FaceId); 16]> = SmallVec::new();
        for &NearbyPair { key, planes } in nearby {
            let candidate = match key {
                ContactKey::VertexVertex(a, b) => self.vertex_vertex(a, b, planes),
                ContactKey::VertexEdge(v, e) => self.vertex_edge((Side::A, v), (Side::B, e), planes),
                ContactKey::EdgeVertex(e, v) => self.vertex_edge((Side::B, v), (Side::A, e), planes),
                ContactKey::EdgeEdge(a, b) => self.edge_edge(a, b, CertainPlace::Unknown),
                ContactKey::VertexFace(v, f) => {
                    faces.push((Side::A, v, f));
                    None
                }
                ContactKey::FaceVertex(f, v) => {
                    faces.push((Side::B, v, f));
                    None
                }
            };
            found.extend(candidate.map(|candidate| exit_candidate(key, candidate)));
        }
        self.add_kept(nearby, &mut faces, &mut found);
        for of_vertex in faces.chunk_by(|one, two| (one.0, one.1) == (two.0, two.1)) {
            let vertex = (of_vertex[0].0, of_vertex[0].1);
            let faces = of_vertex.iter().map(|&(_, _, face)| face);
            self.vertex_and_faces(vertex, faces, &mut found);
        }
        self.finish(found)
    }

    /// Those that are kept may be deeper than all that is nearby.
    fn add_kept(
        &mut self,
        nearby: &[NearbyPair],
        faces: &mut SmallVec<[(Side, VertexId, FaceId); 16]>,
        found: &mut Vec<ExitCandidate>,
    ) {
        let listed = |key: ContactKey| nearby.iter().any(|pair| pair.key == key);
        let exists = |side: Side, vertex: VertexId, face: FaceId| {
            vertex.index() < self.pair.topology(side).vertex_count()
                && face.index() < self.pair.topology(side.other()).faces().len()
        };
        let known = faces.len();
        let mut edges: SmallVec<[ContactKey; 4]> = SmallVec::new();
        for &key in self.kept {
            match key {
                ContactKey::VertexFace(v, f) if exists(Side::A, v, f) && !listed(key) => faces.push((Side::A, v, f)),
                ContactKey::FaceVertex(f, v) if exists(Side::B, v, f) && !listed(key) => faces.push((Side::B, v, f)),
                ContactKey::EdgeEdge(a, b)
                    if a.index() < self.pair.a.edges.len()
                        && b.index() < self.pair.b.edges.len()
                        && !listed(key)
                        && !edges.contains(&key) =>
                {
                    edges.push(key);
                }
                _ => {}
            }
        }
        if faces.len() > known {
            faces.sort_unstable_by_key(|&(side, vertex, face)| (side as u8, vertex, face));
            faces.dedup();
        }
        for key in edges {
            if let ContactKey::EdgeEdge(a, b) = key {
                found.extend(
                    self.edge_edge(a, b, CertainPlace::Unknown).map(|candidate| exit_candidate(key, candidate)),
                );
            }
        }
    }
}
