//! Which contacts of overlapping blocks stay: shortest exit (test 3) and one exit (test 5).

use super::entrance::{Candidate, Candidates};
use crate::classification::{Classification, Observer};
use crate::predicate::{NormalsAgree, NormalsWithin};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Contact, EdgeId, FaceId, VertexId};

/// A contact with what its later tests need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExitCandidate {
    pub(crate) contact: Contact,
    pub(crate) candidate: Candidate,
}

impl<O: Observer> Classification<'_, '_, O> {
    /// Shortest exit: of the faces that one vertex overlaps and that convex edges join, only the one with the largest
    /// gap stays; gaps equal by Eq. (1) leave the lower face. `found` are the contacts of the vertex, by face.
    pub(crate) fn keep_shortest_exit(&mut self, vertex: (Side, VertexId), found: &mut Vec<(FaceId, Candidate)>) {
        let side = vertex.0.other();
        let overlapping: Vec<(FaceId, Candidate)> =
            found.iter().copied().filter(|(_, c)| c.gap.is_negative()).collect();
        if overlapping.len() < 2 {
            return;
        }
        let groups = self.groups(side, &overlapping.iter().map(|&(face, _)| face).collect::<Vec<_>>());
        let mut dropped = Vec::new();
        for group in 0..overlapping.len() {
            let members: Vec<_> =
                overlapping.iter().zip(&groups).filter(|&(_, &g)| g == group).map(|(&member, _)| member).collect();
            if members.len() < 2 {
                continue;
            }
            let gaps: Vec<Candidate> = members.iter().map(|&(_, candidate)| candidate).collect();
            let Some(best) = self.largest_gap(&gaps) else { continue };
            let mut stays = None;
            for (k, &(face, candidate)) in members.iter().enumerate() {
                let features = [Feature::Vertex(vertex.0, vertex.1), Feature::Face(side, face)];
                let stay = self.decide(
                    || Decision::about(Predicate::ShortestExit, &features),
                    |run| (k == best || run.equals_best(&candidate, &gaps[best])) && k <= best && stays.is_none(),
                );
                if stay {
                    stays = Some(face);
                } else {
                    dropped.push(face);
                }
            }
        }
        found.retain(|(face, _)| !dropped.contains(face));
    }

    /// Numbers the groups of faces that convex edges join, each by the place of its first face.
    fn groups(&self, side: Side, faces: &[FaceId]) -> Vec<usize> {
        let topology = self.pair.topology(side);
        let mut group: Vec<usize> = (0..faces.len()).collect();
        for (e, edge) in topology.edges().iter().enumerate() {
            let at = |face: FaceId| faces.iter().position(|&f| f == face);
            if let (Some(left), Some(right)) = (at(edge.left), at(edge.right))
                && self.edge_is_convex(side, EdgeId::at(e))
            {
                let (low, high) = (group[left].min(group[right]), group[left].max(group[right]));
                group.iter_mut().filter(|g| **g == high).for_each(|g| *g = low);
            }
        }
        group
    }

    /// One exit, for two convex blocks: with n* the normal of the largest gap found among true exits, or among all
    /// contacts if none is one, an overlapping contact stays only if its normal is within the overlap angle of n*;
    /// **a tie stays**. `found` is sorted. Where something overlaps, every contact is asked whether it is a true exit.
    pub(crate) fn keep_one_exit(&mut self, found: &mut Vec<ExitCandidate>) {
        if !found.iter().any(|f| f.candidate.gap.is_negative()) {
            return;
        }
        let mut candidates: Candidates = found.iter().map(|f| f.candidate).collect();
        self.prefer_true_exits(&mut candidates);
        // Which is the largest matters to the record alone.
        let best = if O::is_active() { self.largest_gap(&candidates) } else { None };
        let reference = match best {
            Some(best) => Some(self.first_equal_to(best, &candidates)),
            None => self.first_equal_to_largest(&candidates),
        };
        let Some(reference) = reference else { return };
        let way_out = candidates[reference];
        found.retain(|f| {
            if !f.candidate.gap.is_negative() {
                return true;
            }
            self.decide(
                || Decision::about(Predicate::OneExit, &f.contact.key.features()),
                |run| {
                    // Whether a contact stays rests on which way out was chosen, too: its record holds how near that choice was.
                    if let Some(best) = best {
                        for other in candidates[..best].iter().chain(&candidates[best + 1..]) {
                            run.equals_best(other, &candidates[best]);
                        }
                    }
                    run.same_way_out(&f.candidate, &way_out)
                },
            )
        });
    }

    /// `n·n* > 0` and `|n × n*|² ≤ so²|n|²|n*|²`.
    fn same_way_out(&mut self, one: &Candidate, other: &Candidate) -> bool {
        let (first, second) = (one.entrance, other.entrance);
        let turned = one.turn.times(other.turn);
        // The angle of a normal with itself needs no measuring.
        self.sign(&NormalsAgree { first, second }).times(turned).is_positive()
            && (first == second || self.sign(&NormalsWithin { first, second }).is_at_least_zero())
    }
}
