//! The whole classification of a pair: rough phase, the four tests with both roles, one exit.

use super::certified_reject::CertainPlace;
use super::culling::{CullingDistances, NearFeatures};
use super::entrance::{Candidate, Planes};
use super::exit::ExitCandidate;
use crate::classification::{Classification, Observer, Unobserved};
use crate::levels::LevelCounts;
use crate::pair::Pair;
use crate::predicate::{BoxesMeet, Vertex};
use rockproof_model::decision::{Decision, Predicate, Side};
use rockproof_model::{Contact, ContactKey, FaceId, ToleranceSet};
use smallvec::SmallVec;

/// What the oracle says of a pair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// The contacts in the order of SPEC: by kind, then by features.
    pub contacts: Vec<Contact>,
    /// How the signs were decided.
    pub levels: LevelCounts,
}

impl Pair<'_> {
    /// The contacts of the pair under a tolerance set (SPEC section 4), exactly.
    ///
    /// Block coordinates count as they stand: for the oracle on rounded input, give it rounded blocks and tolerances.
    pub fn classify(&self, tolerances: &ToleranceSet) -> Answer {
        self.classify_with_kept(tolerances, &[])
    }

    /// The contacts of the pair where the step before left the contacts `kept` of it closed: these may be deeper than g;
    /// every other condition holds for them as for all. Order and repetitions do not matter.
    pub fn classify_with_kept(&self, tolerances: &ToleranceSet, kept: &[ContactKey]) -> Answer {
        let mut run = Classification::new(self, tolerances, Unobserved);
        run.kept = kept;
        let contacts = run.classify();
        Answer { contacts, levels: run.cascade.levels }
    }

    /// Whether the pair passes the rough phase: A's box grown by s meets B's; **touching says yes**.
    pub fn are_neighbours(&self, tolerances: &ToleranceSet) -> bool {
        Classification::new(self, tolerances, Unobserved).neighbours()
    }
}

impl<O: Observer> Classification<'_, '_, O> {
    pub(crate) fn classify(&mut self) -> Vec<Contact> {
        if !self.neighbours() {
            return Vec::new();
        }
        let CullingDistances { contact: distance, territory } = self.culling_distances();
        self.territory_distance = territory;
        let (mut a, mut b) = (NearFeatures::default(), NearFeatures::default());
        self.find_features_within(Side::A, distance, &mut a);
        self.find_features_within(Side::B, distance, &mut b);
        let mut found = Vec::new();
        self.vertex_vertex_contacts(&a, &b, distance, &mut found);
        self.vertex_edge_contacts(Side::A, &a, &b, distance, &mut found);
        self.vertex_edge_contacts(Side::B, &b, &a, distance, &mut found);
        self.vertex_face_contacts(Side::A, &a, &mut found);
        self.vertex_face_contacts(Side::B, &b, &mut found);
        self.edge_edge_contacts(&a, &b, distance, &mut found);
        self.finish(found)
    }

    /// What stays of the contacts found, in the order of SPEC.
    pub(super) fn finish(&mut self, mut found: Vec<ExitCandidate>) -> Vec<Contact> {
        if O::is_active() {
            found.retain(|f| !self.observer.leaves_out(&f.contact));
        }
        found.sort_unstable_by_key(|f| f.contact);
        if self.pair.a.block.is_convex() && self.pair.b.block.is_convex() {
            self.keep_one_exit(&mut found);
        }
        found.into_iter().map(|f| f.contact).collect()
    }

    pub(super) fn neighbours(&mut self) -> bool {
        if self.surely_neighbours() {
            return true;
        }
        self.decide(
            || Decision::about(Predicate::Neighbours, &[]),
            |run| {
                (0..3).all(|axis| {
                    [(Side::A, Side::B), (Side::B, Side::A)].into_iter().all(|(low, high)| {
                        let low = (low, run.pair.prepared(low).extremes[axis].0);
                        let high = (high, run.pair.prepared(high).extremes[axis].1);
                        run.sign(&BoxesMeet { low, high, axis }).is_at_least_zero()
                    })
                })
            },
        )
    }

    fn vertex_vertex_contacts(
        &mut self,
        a: &NearFeatures,
        b: &NearFeatures,
        distance: f64,
        found: &mut Vec<ExitCandidate>,
    ) {
        for &i in &a.vertices {
            for &j in &b.vertices {
                if !self.vertices_out_of_reach(i, j, distance)
                    && let Some(candidate) = self.vertex_vertex(i, j, Planes::ALL)
                {
                    found.push(exit_candidate(ContactKey::VertexVertex(i, j), candidate));
                }
            }
        }
    }

    /// v-e for vertices of A, e-v for vertices of B.
    fn vertex_edge_contacts(
        &mut self,
        side: Side,
        own: &NearFeatures,
        other: &NearFeatures,
        distance: f64,
        found: &mut Vec<ExitCandidate>,
    ) {
        for &v in &own.vertices {
            for &e in &other.edges {
                if !self.vertex_out_of_reach_of_edge((side, v), e, distance)
                    && let Some(candidate) = self.vertex_edge((side, v), (side.other(), e), Planes::ALL)
                {
                    found.push(match side {
                        Side::A => exit_candidate(ContactKey::VertexEdge(v, e), candidate),
                        Side::B => exit_candidate(ContactKey::EdgeVertex(e, v), candidate),
                    });
                }
            }
        }
    }

    /// v-f for vertices of A, f-v for vertices of B.
    fn vertex_face_contacts(&mut self, side: Side, own: &NearFeatures, found: &mut Vec<ExitCandidate>) {
        let mut faces = SmallVec::new();
        self.find_face_rejects(side.other(), &mut faces);
        let prepared = self.pair.prepared(side);
        let beyond = self.kept_vertices_beyond(side, own);
        for &v in own.vertices.iter().chain(&beyond) {
            let at = &prepared.vertices[v.index()];
            let mut near: SmallVec<[FaceId; 8]> = SmallVec::new();
            for reject in &faces {
                if !self.certainly_fails(reject, at, (side, v)) {
                    near.push(reject.face);
                }
            }
            if !near.is_empty() {
                self.vertex_and_faces((side, v), near.into_iter(), found);
            }
        }
    }

    /// v-f or f-v of one vertex and these faces, ascending.
    pub(super) fn vertex_and_faces(
        &mut self,
        vertex: Vertex,
        faces: impl Iterator<Item = FaceId>,
        found: &mut Vec<ExitCandidate>,
    ) {
        let (side, v) = vertex;
        let mut touched: Vec<(FaceId, Candidate)> = Vec::new();
        for face in faces {
            if let Some(candidate) = self.vertex_face(vertex, (side.other(), face)) {
                touched.push((face, candidate));
            }
        }
        if !(self.pair.a.block.is_convex() && self.pair.b.block.is_convex()) {
            self.keep_shortest_exit(vertex, &mut touched);
        }
        found.extend(touched.into_iter().map(|(face, candidate)| match side {
            Side::A => exit_candidate(ContactKey::VertexFace(v, face), candidate),
            Side::B => exit_candidate(ContactKey::FaceVertex(face, v), candidate),
        }));
    }

    fn edge_edge_contacts(
        &mut self,
        a: &NearFeatures,
        b: &NearFeatures,
        distance: f64,
        found: &mut Vec<ExitCandidate>,
    ) {
        let reject = self.edges_reject();
        for &i in &a.edges {
            for &j in &b.edges {
                if self.edges_out_of_reach(i, j, distance) {
                    continue;
                }
                let feet = self.edges_certainly_fail(&reject, i, j);
                if feet != CertainPlace::Outside
                    && let Some(candidate) = self.edge_edge(i, j, feet)
                {
                    found.push(exit_candidate(ContactKey::EdgeEdge(i, j), candidate));
                }
            }
        }
        for (i, j) in self.kept_edges_beyond(a, b, distance) {
            let candidate = self.edge_edge(i, j, CertainPlace::Unknown);
            found.extend(candidate.map(|candidate| exit_candidate(ContactKey::EdgeEdge(i, j), candidate)));
        }
    }
}

pub(super) fn exit_candidate(key: ContactKey, candidate: Candidate) -> ExitCandidate {
    ExitCandidate { contact: Contact { key, entrance: candidate.entrance, gap: candidate.gap }, candidate }
}
