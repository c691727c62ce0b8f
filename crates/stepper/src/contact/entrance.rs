//! Entrances: the planes through which two blocks enter one another, and which of them a contact takes.

#[cfg(test)]
mod tests;

use crate::contact::contact_rules::ContactRules;
use crate::contact::pair::Pair;
use crate::contact::trace::Observer;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{EdgeId, Entrance, EntranceKind, FaceId, VertexId};

/// A plane that passes the no-overlap check.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate<R> {
    pub(super) entrance: Entrance,
    /// Metres, positive apart.
    pub(super) gap: R,
    /// Unit, from B to A.
    pub(super) normal: Vector<R>,
    /// Whether it is a true exit, where that is known.
    pub(super) exits: Option<bool>,
}

/// What is known of a plane before it is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownPlane {
    /// Whether it is known to pass.
    pub(super) passes: bool,
    /// Whether it is a true exit, where that is known.
    pub(super) exits: Option<bool>,
}

/// A plane that may be an entrance: that of a face of the other block, entered by a vertex of `side`, or that of two edges, of A and of B.
#[derive(Clone, Copy, Debug)]
pub(super) enum Plane {
    VertexFace(Side, VertexId, FaceId),
    EdgeEdge(EdgeId, EdgeId),
}

impl<R: Real> Candidate<R> {
    pub(super) fn edge_edge(a: EdgeId, b: EdgeId, gap: R, normal: Vector<R>) -> Candidate<R> {
        Candidate { entrance: Entrance::EdgeEdge(a, b), gap, normal, exits: None }
    }
}

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// "Cone passes plane": no edge at vertex `v` of `side` dips below the plane of face `f` of the other block by more
    /// than the tolerance.
    #[inline(always)]
    pub(super) fn cone_passes(&mut self, side: Side, v: VertexId, f: FaceId) -> bool {
        let normal = self.prepared(side.other()).face(f).normal;
        let own = self.prepared(side);
        M::cone(own.edges_at(v)).iter().all(|&e| {
            let about = [Feature::Vertex(side, v), Feature::Face(side.other(), f), Feature::Edge(side, e)];
            let spoke = own.edge_at_vertex(v, e);
            self.ask(Predicate::ConePasses, &about, M::cone_passes(spoke.away.dot(normal), spoke.length, self.t))
        })
    }

    /// The plane of face `f` of the other block, entered by vertex `v` of `side`.
    pub(super) fn vertex_face_entrance(&self, side: Side, v: VertexId, f: FaceId) -> Candidate<R> {
        let face = self.prepared(side.other()).face(f);
        let gap = face.normal.dot(self.prepared(side).vertex(v).at - face.point);
        let (entrance, normal) = match side {
            Side::A => (Entrance::VertexFace(v, f), face.normal),
            Side::B => (Entrance::FaceVertex(f, v), M::normal_of_a(face.normal)),
        };
        Candidate { entrance, gap, normal, exits: None }
    }

    /// Makes a plane a candidate if it passes, or is known to.
    #[inline(always)]
    pub(super) fn offer(&mut self, plane: Plane, known: KnownPlane) {
        if R::is_given_up() {
            return;
        }
        match plane {
            Plane::VertexFace(side, v, f) => self.offer_vertex_face(side, v, f, known),
            Plane::EdgeEdge(e, f) => self.offer_edge_edge(e, f, known),
        }
    }

    /// Makes a face's plane a candidate if the vertex's cone passes it.
    fn offer_vertex_face(&mut self, side: Side, v: VertexId, f: FaceId, known: KnownPlane) {
        if known.passes || self.cone_passes(side, v, f) {
            self.candidates.push(Candidate { exits: known.exits, ..self.vertex_face_entrance(side, v, f) });
        }
    }

    /// Makes the plane of two edges a candidate if both take part, they are not nearly parallel, and their wedges pass.
    fn offer_edge_edge(&mut self, e: EdgeId, f: EdgeId, known: KnownPlane) {
        let (one, two) = (self.a.edge(e), self.b.edge(f));
        if !M::edge_takes_part(one.convex) || !M::edge_takes_part(two.convex) {
            return;
        }
        let Some(crossing) = self.crossing(e, f) else { return };
        let normal = self.normal(e, f, crossing);
        if known.passes || self.wedges_pass(e, f, normal) {
            let plane = Candidate::edge_edge(e, f, normal.dot(one.p - two.p), normal);
            self.candidates.push(Candidate { exits: known.exits, ..plane });
        }
    }

    /// Whether a plane is a true exit: its no-overlap check passes with the tolerance r/10 alone. `normal` points from B to A.
    pub(super) fn is_true_exit(&mut self, plane: Candidate<R>) -> bool {
        let exits = plane.exits.unwrap_or_else(|| match plane.entrance {
            Entrance::VertexFace(v, f) => self.cone_exits(Side::A, v, f),
            Entrance::FaceVertex(f, v) => self.cone_exits(Side::B, v, f),
            Entrance::EdgeEdge(e, f) => self.wedges_exit(e, f, plane.normal),
        });
        self.ask(Predicate::TrueExit, &plane.entrance.features(), exits)
    }

    fn cone_exits(&self, side: Side, v: VertexId, f: FaceId) -> bool {
        let normal = self.prepared(side.other()).face(f).normal;
        let own = self.prepared(side);
        M::cone(own.edges_at(v)).iter().all(|&e| {
            let spoke = own.edge_at_vertex(v, e);
            M::true_exit_of_cone(spoke.away.dot(normal), spoke.length, self.t)
        })
    }

    /// Asks which of `count` planes are true exits. Says whether any is; `true_exits` then holds the answers.
    pub(super) fn any_true_exit(&mut self, count: usize, plane: impl Fn(&Self, usize) -> Candidate<R>) -> bool {
        self.true_exits.clear();
        for k in 0..count {
            let plane = plane(self, k);
            let exits = self.is_true_exit(plane);
            self.true_exits.push(exits);
        }
        self.true_exits.contains(&true)
    }

    /// Of the candidates that are true exits, or of all if none is, the one with the largest gap; of those equal to it by
    /// Eq. (1) the first in order.
    pub(super) fn choose_entrance(&mut self, about: [Feature; 2]) -> Option<Candidate<R>> {
        let count = self.candidates.len();
        let choose = count > 1 && M::true_exits_before_others();
        let some_exit = choose && self.any_true_exit(count, |pair, k| pair.candidates[k]);
        let among = self.candidates.iter().enumerate().filter(|&(k, _)| !some_exit || self.true_exits[k]);
        let gaps = among.map(|(k, c)| (k, c.gap, key::<M>(c.entrance)));
        let chosen = first_of_the_best::<R, M, _>(gaps, self.t.equal)?;
        for (k, candidate) in self.candidates.iter().enumerate() {
            let [a, b] = candidate.entrance.features();
            self.seen.observe(Predicate::EntranceChoice, &[about[0], about[1], a, b], i8::from(k == chosen));
        }
        // Of `Wide` it is asked again, which counts what it cannot decide.
        let known = choose && R::IS_FLOAT;
        let exits = if known { Some(self.true_exits[chosen]) } else { self.candidates[chosen].exits };
        Some(Candidate { exits, ..self.candidates[chosen] })
    }
}

fn key<M: ContactRules>(entrance: Entrance) -> (EntranceKind, [u32; 2]) {
    (M::entrance_order(entrance.kind()), entrance.numbers())
}

/// Among gaps with a place and a key, the place of the one that Eq. (1) counts as equal to the largest and whose key is the
/// smallest.
pub(super) fn first_of_the_best<R: Real, M: ContactRules, K: Ord + Copy>(
    gaps: impl Iterator<Item = (usize, R, K)> + Clone,
    equal: R,
) -> Option<usize> {
    if R::DOUBTS_CHOICES {
        return first_of_any_best::<R, M, K>(gaps, equal);
    }
    let (mut best_at, mut best, mut chosen_key) = gaps.clone().next()?;
    for (k, gap, key) in gaps.clone() {
        if M::better(gap, best) {
            (best_at, best, chosen_key) = (k, gap, key);
        }
    }
    let mut chosen = best_at;
    for (k, gap, key) in gaps {
        // The largest is equal to itself; asking would leave that to rounding.
        if k != best_at && key < chosen_key && M::equals_best(gap, best, equal) {
            (chosen, chosen_key) = (k, key);
        }
    }
    Some(chosen)
}

/// The same in a scalar that may not tell which gap is the largest.
///
/// Each gap that may be the largest is taken for it in turn, and every gap compared with it by Eq. (1). Where these comparisons are settled and
/// say the same of all, the choice and its comparisons are those of [`first_of_the_best`] in `Wide`: it takes for the largest one that has the largest
/// middle there, so none that is surely below another, and makes some of these comparisons.
fn first_of_any_best<R: Real, M: ContactRules, K: Ord + Copy>(
    gaps: impl Iterator<Item = (usize, R, K)> + Clone,
    equal: R,
) -> Option<usize> {
    let larger = |best: R, (_, gap, _): (usize, R, K)| if best.surely_below_uncounted(gap) { gap } else { best };
    let (_, first, _) = gaps.clone().next()?;
    let large = gaps.clone().fold(first, larger);
    let mut chosen = None;
    for (best_at, best, best_key) in gaps.clone().filter(|&(_, gap, _)| !gap.surely_below_uncounted(large)) {
        let equals = gaps.clone().filter(|&(k, gap, _)| k == best_at || M::equals_best(gap, best, equal));
        let first = equals.fold((best_at, best_key), |first, (k, _, key)| if key < first.1 { (k, key) } else { first });
        if chosen.is_some_and(|chosen| chosen != first.0) {
            R::count_doubtful_choice();
        }
        chosen = Some(first.0);
    }
    chosen
}
