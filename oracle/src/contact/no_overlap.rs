//! The no-overlap checks, "cone passes plane" and "wedges pass", and with which tolerance they do: true exits (SPEC
//! section 4, "Building blocks").

use super::entrance::Candidate;
use crate::classification::{Classification, Observer};
use crate::number::Approx;
use crate::predicate::{
    DipLimit, Edge, EdgeAbovePlane, EdgeDipAngle, EdgeDipDepth, Face, InwardAcross, Orientation, ParallelAngle,
    ParallelReach, Polynomial, Vertex, WedgeDipAngle, WedgeDipDepth, across,
};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{EdgeId, Entrance, Sign, Vec3, VertexId};

/// The answer of a no-overlap check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Passes {
    /// A feature dips below the plane by more than the tolerance.
    No,
    /// Some dip, all of them within the tolerance.
    Dipping,
    /// None dips by more than a true exit allows.
    Clear,
}

impl Passes {
    fn new(passes: bool, dips: bool) -> Passes {
        match (passes, dips) {
            (false, _) => Passes::No,
            (true, true) => Passes::Dipping,
            (true, false) => Passes::Clear,
        }
    }
}

/// What dips within both leaves a plane that passes a true exit.
const LIMITS: [DipLimit; 2] = [DipLimit::Penetration, DipLimit::TrueExit];

impl<'p, O: Observer> Classification<'p, '_, O> {
    /// Whether every edge at a vertex stays above a face's plane or dips within tolerance; **a tie passes**.
    pub(crate) fn cone_passes(&mut self, vertex: Vertex, face: Face) -> Passes {
        let edges = self.pair.topology(vertex.0).vertex_edges(vertex.1);
        let mut dips = false;
        let passes = edges.iter().all(|&edge| {
            let features =
                [Feature::Vertex(vertex.0, vertex.1), Feature::Face(face.0, face.1), Feature::Edge(vertex.0, edge)];
            self.decide(
                || Decision::about(Predicate::ConePasses, &features),
                |run| {
                    if run.edge_passes_either_way(vertex, edge, face) {
                        return true;
                    }
                    let rises = run.edge_rises(vertex, edge, face);
                    dips |= !rises;
                    rises || run.edge_dip_passes((vertex.0, edge), face)
                },
            )
        });
        Passes::new(passes, dips)
    }

    /// Whether `e·N ≥ 0`; **a tie says yes**.
    #[inline(always)]
    fn edge_rises(&mut self, vertex: Vertex, edge: EdgeId, face: Face) -> bool {
        self.sign(&EdgeAbovePlane { vertex, edge, face }).is_at_least_zero()
    }

    /// Whether f64 leaves open if an edge dips, and proves that it does so, if at all, by no more than even a true exit allows.
    fn edge_passes_either_way(&self, vertex: Vertex, edge: EdgeId, face: Face) -> bool {
        let rising = EdgeAbovePlane { vertex, edge, face };
        if O::is_active() || !self.is_open(&rising, rising.value(&self.float_view()).0) {
            return false;
        }
        let edge = (vertex.0, edge);
        self.surely_positive(&EdgeDipAngle { edge, face })
            && (self.classic
                || LIMITS.into_iter().all(|limit| self.surely_positive(&EdgeDipDepth { edge, face, limit })))
    }

    /// Whether an edge that dips does so within the angle and, under revised, within g as well; **a tie says yes**.
    fn edge_dip_passes(&mut self, edge: Edge, face: Face) -> bool {
        self.sign(&EdgeDipAngle { edge, face }).is_at_least_zero()
            && (self.classic || self.edge_dips_within(edge, face, DipLimit::Penetration))
    }

    /// Whether `(e·N)² ≤ limit²|N|²`; **a tie says yes**.
    fn edge_dips_within(&mut self, edge: Edge, face: Face, limit: DipLimit) -> bool {
        self.sign(&EdgeDipDepth { edge, face, limit }).is_at_least_zero()
    }

    /// Whether two edges are nearly parallel: by angle and, under revised, by length as well; **a tie says yes**.
    pub(crate) fn nearly_parallel(&mut self, edge_a: EdgeId, edge_b: EdgeId) -> bool {
        self.decide(
            || about_edges(Predicate::NearlyParallel, edge_a, edge_b),
            |run| {
                run.sign(&ParallelAngle { edge_a, edge_b }).is_at_least_zero()
                    && (run.classic
                        || [Side::A, Side::B]
                            .into_iter()
                            .any(|longer| run.sign(&ParallelReach { edge_a, edge_b, longer }).is_at_least_zero()))
            },
        )
    }

    /// σ of two edges: the sign that turns `d₁ × d₂` from B to A; zero counts as +.
    pub(crate) fn orientation(&mut self, edge_a: EdgeId, edge_b: EdgeId) -> Sign {
        if self.sign(&Orientation { edge_a, edge_b }).is_negative() { Sign::Negative } else { Sign::Positive }
    }

    /// Whether the faces at two convex edges pass one another along `n = σ·(d₁ × d₂)`; **a tie passes**.
    pub(crate) fn wedges_pass(&mut self, edge_a: EdgeId, edge_b: EdgeId, sigma: Sign) -> Passes {
        let mut dips = false;
        let passes = self.decide(
            || about_edges(Predicate::WedgesPass, edge_a, edge_b),
            |run| {
                let across = across(&run.float_view(), edge_a, edge_b);
                inwards_across(edge_a, edge_b).into_iter().all(|inward| {
                    if run.wedge_face_passes_either_way(inward, &across) {
                        return true;
                    }
                    let rises = run.wedge_face_rises(&inward, &across, sigma);
                    dips |= !rises;
                    rises || run.wedge_dip_passes(inward)
                })
            },
        );
        Passes::new(passes, dips)
    }

    /// Whether a face at one of the edges stays on its own block's side: `n·m ≥ 0` for A's, `n·m ≤ 0` for B's;
    /// **a tie says yes**. `across` is `d₁ × d₂` in f64.
    #[inline]
    fn wedge_face_rises(&mut self, inward: &InwardAcross, across: &Vec3<Approx>, sigma: Sign) -> bool {
        let value = inward.value_along(&self.float_view(), across).0;
        let towards_a = self.sign_of_value(inward, value).times(sigma);
        let outwards = if inward.side == Side::A { towards_a } else { towards_a.reversed() };
        outwards.is_at_least_zero()
    }

    /// Whether f64 leaves open if a face dips, and proves that it does so, if at all, by no more than even a true exit allows.
    fn wedge_face_passes_either_way(&self, inward: InwardAcross, across: &Vec3<Approx>) -> bool {
        if O::is_active() || !self.is_open(&inward, inward.value_along(&self.float_view(), across).0) {
            return false;
        }
        let surely_within = |corner, limit| self.surely_positive(&WedgeDipDepth { inward, corner, limit });
        self.surely_positive(&WedgeDipAngle(inward))
            && (self.classic
                || self.far_corners(inward).all(|corner| LIMITS.into_iter().all(|limit| surely_within(corner, limit))))
    }

    /// Whether a face that dips does so within the angle and, under revised, within g as well; **a tie says yes**.
    fn wedge_dip_passes(&mut self, inward: InwardAcross) -> bool {
        self.sign(&WedgeDipAngle(inward)).is_at_least_zero()
            && (self.classic || self.wedge_dips_within(inward, DipLimit::Penetration))
    }

    /// Whether `(n·m)²w² ≤ limit²|n|²|m|²`; **a tie says yes**. w is the greatest distance of a corner from the edge's
    /// line: the dip is within the limit when it is at every corner.
    fn wedge_dips_within(&mut self, inward: InwardAcross, limit: DipLimit) -> bool {
        self.far_corners(inward).all(|corner| self.sign(&WedgeDipDepth { inward, corner, limit }).is_at_least_zero())
    }

    /// The corners of the face that are not ends of the edge.
    fn far_corners(&self, inward: InwardAcross) -> impl Iterator<Item = VertexId> + use<'p, O> {
        let InwardAcross { edge_a, edge_b, side, right } = inward;
        let topology = self.pair.topology(side);
        let edge = topology.edge(if side == Side::A { edge_a } else { edge_b });
        let corners = topology.face(if right { edge.right } else { edge.left });
        corners.iter().copied().filter(|&corner| corner != edge.p && corner != edge.q)
    }

    /// Whether a plane that passed is a true exit: what dips below it does so by at most r/10; **a tie says yes**. Asked under
    /// revised alone: under classic whatever passes is one.
    pub(crate) fn is_true_exit(&mut self, candidate: &Candidate) -> bool {
        if !O::is_active() && !candidate.may_dip {
            return true;
        }
        let entrance = candidate.entrance;
        self.decide(
            || Decision::about(Predicate::TrueExit, &entrance.features()),
            |run| match entrance {
                Entrance::VertexFace(vertex, face) => run.cone_leaves((Side::A, vertex), (Side::B, face)),
                Entrance::FaceVertex(face, vertex) => run.cone_leaves((Side::B, vertex), (Side::A, face)),
                Entrance::EdgeEdge(edge_a, edge_b) => {
                    let across = across(&run.float_view(), edge_a, edge_b);
                    inwards_across(edge_a, edge_b).into_iter().all(|inward| {
                        run.wedge_face_rises(&inward, &across, candidate.turn)
                            || run.wedge_dips_within(inward, DipLimit::TrueExit)
                    })
                }
            },
        )
    }

    fn cone_leaves(&mut self, vertex: Vertex, face: Face) -> bool {
        let edges = self.pair.topology(vertex.0).vertex_edges(vertex.1);
        edges.iter().all(|&edge| {
            self.edge_rises(vertex, edge, face) || self.edge_dips_within((vertex.0, edge), face, DipLimit::TrueExit)
        })
    }
}

/// The four inward directions at two edges.
fn inwards_across(edge_a: EdgeId, edge_b: EdgeId) -> [InwardAcross; 4] {
    [(Side::A, false), (Side::A, true), (Side::B, false), (Side::B, true)].map(|(side, right)| InwardAcross {
        edge_a,
        edge_b,
        side,
        right,
    })
}

pub(crate) fn about_edges(predicate: Predicate, edge_a: EdgeId, edge_b: EdgeId) -> Decision {
    Decision::about(predicate, &[Feature::Edge(Side::A, edge_a), Feature::Edge(Side::B, edge_b)])
}
