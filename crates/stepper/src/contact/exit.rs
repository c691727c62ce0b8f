//! Exits: which of several overlapping contacts stay (SPEC section 4, test 3 "shortest exit" and test 5 "one exit").

use crate::contact::contact_rules::ContactRules;
use crate::contact::entrance::first_of_the_best;
use crate::contact::pair::{ExitCandidate, Pair};
use crate::contact::trace::Observer;
use crate::real::Real;
use rockproof_model::decision::{Predicate, Side};
use rockproof_model::{Contact, Entrance, FaceId};

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// Shortest exit of the vertex whose v-f (f-v) contacts are the hits from `first` on: of faces it overlaps that hang
    /// together by convex edges, only the one with the largest gap stays.
    pub(super) fn shortest_exit(&mut self, side: Side, first: usize) {
        let of_vertex = self.hits.split_off(first);
        let (overlapping, apart): (Vec<_>, Vec<_>) = of_vertex.into_iter().partition(|hit| M::overlaps(hit.gap));
        self.hits.extend(apart);
        let overlapping: Vec<(ExitCandidate<R>, FaceId)> =
            overlapping.into_iter().filter_map(|hit| Some((hit, hit.contact.key.vertex_and_face()?.1))).collect();
        let faces: Vec<FaceId> = overlapping.iter().map(|&(_, face)| face).collect();
        let groups = self.groups(side.other(), &faces);
        for group in 0..groups.iter().map(|g| g + 1).max().unwrap_or(0) {
            let members: Vec<(ExitCandidate<R>, FaceId)> =
                overlapping.iter().zip(&groups).filter(|&(_, &g)| g == group).map(|(member, _)| *member).collect();
            let stays = first_of_the_best::<R, M, _>(
                members.iter().enumerate().map(|(k, (hit, face))| (k, hit.gap, *face)),
                self.t.equal,
            );
            for (k, (hit, _)) in members.iter().enumerate() {
                let about = hit.contact.key.features();
                let asked = if side == Side::A { about } else { [about[1], about[0]] };
                if self.ask(Predicate::ShortestExit, &asked, stays == Some(k)) {
                    self.hits.push(*hit);
                }
            }
        }
    }

    /// For each face the number of its group: faces joined, step by step, by convex edges within the set.
    fn groups(&self, side: Side, faces: &[FaceId]) -> Vec<usize> {
        let prepared = self.prepared(side);
        let joined = |f: FaceId, g: FaceId| {
            prepared.block().topology().face_edges(f).iter().any(|&e| {
                let ridge = prepared.edge(e);
                M::joins_exits(ridge.convex) && (ridge.edge.left == g || ridge.edge.right == g)
            })
        };
        let mut groups: Vec<usize> = (0..faces.len()).collect();
        for i in 0..faces.len() {
            for j in 0..i {
                if groups[i] != groups[j] && joined(faces[i], faces[j]) {
                    let (from, to) = (groups[i].max(groups[j]), groups[i].min(groups[j]));
                    groups.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
                }
            }
        }
        groups
    }

    /// One exit: an overlapping contact stays only if its normal is within the overlap angle of that of the contact with
    /// the largest gap, among those whose entrance is a true exit, or among all if none is. The hits must be sorted.
    pub(super) fn one_exit(&mut self) {
        if !self.hits.iter().any(|hit| M::overlaps(hit.gap)) {
            return;
        }
        let some_exit = M::one_exit_is_true() && self.any_true_exit(self.hits.len(), |pair, k| pair.hits[k].plane());
        let among = self.hits.iter().enumerate().filter(|&(k, _)| !some_exit || self.true_exits[k]);
        let gaps = among.map(|(k, hit)| (k, hit.gap, hit.contact));
        let Some(chosen) = first_of_the_best::<R, M, _>(gaps, self.t.equal) else { return };
        let way_out = self.hits[chosen];
        let mut kept = 0;
        for k in 0..self.hits.len() {
            let hit = self.hits[k];
            if !M::overlaps(hit.gap) || self.leaves_by(&hit, &way_out) {
                self.hits[kept] = hit;
                kept += 1;
            }
        }
        self.hits.truncate(kept);
    }

    fn leaves_by(&mut self, hit: &ExitCandidate<R>, way_out: &ExitCandidate<R>) -> bool {
        // One plane has one normal; comparing it with itself would leave so = 0 to rounding.
        let stays = same_plane(&hit.contact, &way_out.contact) || {
            let cosine = hit.normal.dot(way_out.normal);
            M::same_exit(cosine, hit.normal.cross(way_out.normal).length(), self.t.overlap_sine)
        };
        self.ask(Predicate::OneExit, &hit.contact.key.features(), stays)
    }
}

fn same_plane(one: &Contact, two: &Contact) -> bool {
    match (one.entrance, two.entrance) {
        (Entrance::VertexFace(_, f), Entrance::VertexFace(_, g)) => f == g,
        (Entrance::FaceVertex(f, _), Entrance::FaceVertex(g, _)) => f == g,
        (one, two) => one == two,
    }
}
