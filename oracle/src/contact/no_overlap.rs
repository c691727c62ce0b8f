//! The no-overlap checks: "cone passes plane" and "wedges pass" (SPEC section 4, "Building blocks").

use crate::predicate::{
    EdgeAbovePlane, EdgeDipAngle, EdgeDipDepth, Face, InwardAcross, Orientation, ParallelAngle, ParallelReach, Vertex,
    WedgeDipAngle, WedgeDipDepth,
};
use crate::run::{Observer, Run};
use rockproof_model::Sign;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};

impl<O: Observer> Run<'_, '_, O> {
    /// Whether every edge at a vertex stays above a face's plane or dips within tolerance; **a tie passes**.
    pub(crate) fn cone_passes(&mut self, vertex: Vertex, face: Face) -> bool {
        let edges = self.pair.topology(vertex.0).vertex_edges(vertex.1);
        edges.iter().all(|&edge| {
            let features =
                [Feature::Vertex(vertex.0, vertex.1), Feature::Face(face.0, face.1), Feature::Edge(vertex.0, edge)];
            self.decide(|| Decision::about(Predicate::ConePasses, &features), |run| run.edge_passes(vertex, edge, face))
        })
    }

    fn edge_passes(&mut self, vertex: Vertex, edge: u32, face: Face) -> bool {
        if self.sign(&EdgeAbovePlane { vertex, edge, face }).is_at_least_zero() {
            return true;
        }
        let edge = (vertex.0, edge);
        self.sign(&EdgeDipAngle { edge, face }).is_at_least_zero()
            || (!self.classic && self.sign(&EdgeDipDepth { edge, face }).is_at_least_zero())
    }

    /// Whether two edges are nearly parallel; **a tie says yes**.
    pub(crate) fn nearly_parallel(&mut self, edge_a: u32, edge_b: u32) -> bool {
        self.decide(
            || about_edges(Predicate::NearlyParallel, edge_a, edge_b),
            |run| {
                run.sign(&ParallelAngle { edge_a, edge_b }).is_at_least_zero()
                    || (!run.classic
                        && [Side::A, Side::B]
                            .into_iter()
                            .any(|longer| run.sign(&ParallelReach { edge_a, edge_b, longer }).is_at_least_zero()))
            },
        )
    }

    /// σ of two edges: the sign that turns `d₁ × d₂` from B to A; zero counts as +.
    pub(crate) fn orientation(&mut self, edge_a: u32, edge_b: u32) -> Sign {
        if self.sign(&Orientation { edge_a, edge_b }).is_negative() { Sign::Negative } else { Sign::Positive }
    }

    /// Whether the faces at two convex edges pass one another along `n = σ·(d₁ × d₂)`; **a tie passes**.
    pub(crate) fn wedges_pass(&mut self, edge_a: u32, edge_b: u32, sigma: Sign) -> bool {
        self.decide(
            || about_edges(Predicate::WedgesPass, edge_a, edge_b),
            |run| {
                [(Side::A, false), (Side::A, true), (Side::B, false), (Side::B, true)]
                    .into_iter()
                    .all(|(side, right)| run.wedge_face_passes(&InwardAcross { edge_a, edge_b, side, right }, sigma))
            },
        )
    }

    fn wedge_face_passes(&mut self, inward: &InwardAcross, sigma: Sign) -> bool {
        let InwardAcross { edge_a, edge_b, side, right } = *inward;
        let towards_a = self.sign(inward).times(sigma);
        let outwards = if side == Side::A { towards_a } else { towards_a.reversed() };
        if outwards.is_at_least_zero() {
            return true;
        }
        let again = || InwardAcross { edge_a, edge_b, side, right };
        if self.sign(&WedgeDipAngle(again())).is_at_least_zero() {
            return true;
        }
        if self.classic {
            return false;
        }
        let edge = self.pair.topology(side).edges()[if side == Side::A { edge_a } else { edge_b } as usize];
        let face = if right { edge.right } else { edge.left };
        // w is the greatest distance of a corner: the dip is within depth when it is at every corner.
        let corners = &self.pair.topology(side).faces()[face as usize];
        corners
            .iter()
            .filter(|&&corner| corner != edge.p && corner != edge.q)
            .all(|&corner| self.sign(&WedgeDipDepth { inward: again(), corner }).is_at_least_zero())
    }
}

pub(crate) fn about_edges(predicate: Predicate, edge_a: u32, edge_b: u32) -> Decision {
    Decision::about(predicate, &[Feature::Edge(Side::A, edge_a), Feature::Edge(Side::B, edge_b)])
}
