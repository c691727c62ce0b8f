//! Ladders across the decisions about the way out: which planes are true exits, and which contacts one exit keeps.

use super::dip::{Dip, DipMeasure, cone_dip, cone_vertices, largest, wedge_dips_within};
use super::search::{CriticalDecision, NO_MOVE, both_edges};
use super::{CriticalSquare, LadderPair};
use crate::directed::exact::fraction;
use crate::directed::f64_view::{F64Vector, cross, length, minus, plus, times, unit};
use crate::directed::faces::{ridge_under_vertex, under_faces};
use crate::directed::vertices::DRAWS;
use crate::directed::{DirectedPair, side};
use crate::families::PairSampler;
use crate::tolerance_sets::size;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::tolerance::LAMBDA_INVERSE;
use rockproof_model::{EdgeId, FaceId, VertexId};

/// A true exit dips by at most this part of r: `r = 10·dip` is critical.
const EXIT_INVERSE: i32 = 10;

/// The plane of an entrance.
#[derive(Clone, Copy)]
enum EntrancePlane {
    /// A vertex of a side and a face of the other.
    Face((Side, VertexId), FaceId),
    /// An edge of A and one of B.
    Edges(EdgeId, EdgeId),
}

/// Where a plane is one of several that are asked.
#[derive(Clone, Copy)]
enum PlaneRole {
    /// A vertex in the territory of a vertex of the other block.
    Corner((Side, VertexId), VertexId),
    /// A vertex in the territory of an edge of the other block.
    Edge((Side, VertexId), EdgeId),
    /// A vertex under a face of the other block, both convex (test 5).
    Under((Side, VertexId), FaceId),
}

impl EntrancePlane {
    fn decision(self) -> Decision {
        let features = match self {
            EntrancePlane::Face((Side::A, v), f) => [Feature::Vertex(Side::A, v), Feature::Face(Side::B, f)],
            EntrancePlane::Face((Side::B, v), f) => [Feature::Face(Side::A, f), Feature::Vertex(Side::B, v)],
            EntrancePlane::Edges(a, b) => [Feature::Edge(Side::A, a), Feature::Edge(Side::B, b)],
        };
        Decision::about(Predicate::TrueExit, &features)
    }

    /// The square of the deepest dip (m²) of a plane that passes; `None` where it does not, or nothing dips.
    fn deepest(self, ladder: &LadderPair<'_>) -> CriticalSquare {
        let pair = &ladder.directed;
        let both = [DipMeasure::Angle, DipMeasure::Length];
        match self {
            EntrancePlane::Face(vertex, face) => ladder.of_face((vertex.0, vertex.1.index()), face, || {
                let exact = pair.exact(&cone_vertices(pair, vertex, face), NO_MOVE);
                let edges = pair.f64_view.block(vertex.0).topology().vertex_edges(vertex.1);
                let dips: Vec<Dip> = edges.iter().filter_map(|&edge| cone_dip(&exact, vertex, face, edge)).collect();
                let pass = dips.iter().all(|dip| both.iter().all(|&measure| dip.within(pair.set, measure)));
                pass.then(|| largest(dips, DipMeasure::Length))?
            }),
            EntrancePlane::Edges(a, b) => ladder.of_edges((a, b), || {
                let dips = wedge_dips_within(&both_edges(pair, (a, b), NO_MOVE), (a, b), (pair.set, &both))?;
                largest(dips, DipMeasure::Length)
            }),
        }
    }

    /// Whether something dips below the plane of a face, as far as f64 can tell.
    fn dips(self, pair: &DirectedPair<'_>) -> bool {
        match self {
            EntrancePlane::Face(vertex, face) => {
                let edges = pair.f64_view.block(vertex.0).topology().vertex_edges(vertex.1);
                edges.iter().any(|&edge| pair.dip(vertex, face, edge) > 0.0)
            }
            EntrancePlane::Edges(..) => true,
        }
    }
}

/// The territory `r` for which r/10 is the deepest dip below a plane that passes: the candidate for the entrance of a
/// v-v or v-e with several of them, or the plane of an overlap of convex blocks.
pub(super) fn true_exit(sampler: &mut PairSampler<'_>, ladder: &LadderPair<'_>) -> CriticalDecision {
    let pair = &ladder.directed;
    let (place, plane, squared) = (0..DRAWS).find_map(|_| {
        let (place, planes) = drawn(sampler, pair)?;
        let first = sampler.below(planes.len() as u64) as usize;
        let mut turn = (0..planes.len()).map(|i| planes[(first + i) % planes.len()]);
        let plane = turn.find(|plane| plane.dips(pair))?;
        let squared = BigRational::clone(&*plane.deepest(ladder)?) * BigInt::from(EXIT_INVERSE * EXIT_INVERSE);
        // No rule allows r > s.
        (squared <= pair.set.search.to_rational().pow(2)).then_some((place, plane, squared))
    })?;
    let shortest = size(pair.f64_view.a).0.min(size(pair.f64_view.b).0);
    let territory = squared.to_f64()?.sqrt().min(shortest / f64::from(LAMBDA_INVERSE));
    Some((plane.decision(), squared, place.reached(sampler, pair, territory)?))
}

/// A place and the planes asked there: at least two where they are candidates for an entrance.
fn drawn(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<(PlaneRole, Vec<EntrancePlane>)> {
    let convex = pair.f64_view.a.is_convex() && pair.f64_view.b.is_convex();
    let asked = side(sampler);
    let other = asked.other();
    let passes = |vertex: (Side, VertexId), face: FaceId| pair.cone_passes(vertex, face, None);
    match sampler.below(5) {
        0 if convex => {
            let (v, f) = pair.f64_view.vertex_face(sampler, asked);
            let plane = EntrancePlane::Face((asked, v), f);
            passes((asked, v), f).then(|| (PlaneRole::Under((asked, v), f), vec![plane]))
        }
        1 | 2 => {
            let (v, e) = pair.f64_view.vertex_edge(sampler, asked)?;
            let edge = pair.f64_view.block(other).topology().edge(e);
            let faces = [edge.left, edge.right].into_iter().filter(|&f| passes((asked, v), f));
            let mut planes: Vec<EntrancePlane> = faces.map(|f| EntrancePlane::Face((asked, v), f)).collect();
            let arms = pair.f64_view.block(asked).topology().vertex_edges(v).iter();
            planes.extend(arms.filter_map(|&arm| crossing(pair, (asked, arm), e)));
            (planes.len() >= 2).then_some((PlaneRole::Edge((asked, v), e), planes))
        }
        _ => {
            let (va, vb) = pair.f64_view.vertex_vertex(sampler)?;
            let at = |side: Side, v: VertexId| pair.f64_view.block(side).topology().vertex_edges(v).iter().copied();
            let faces = |side: Side, v: VertexId| pair.f64_view.block(side).topology().vertex_faces(v).iter().copied();
            let of_a = faces(Side::B, vb).map(|f| ((Side::A, va), f));
            let all = of_a.chain(faces(Side::A, va).map(|f| ((Side::B, vb), f)));
            let passing = all.filter(|&(vertex, f)| passes(vertex, f));
            let mut planes: Vec<EntrancePlane> = passing.map(|(vertex, f)| EntrancePlane::Face(vertex, f)).collect();
            planes.extend(
                at(Side::A, va).flat_map(|a| at(Side::B, vb).filter_map(move |b| crossing(pair, (Side::A, a), b))),
            );
            (planes.len() >= 2).then_some((PlaneRole::Corner((Side::A, va), vb), planes))
        }
    }
}

/// The plane of two convex edges whose angle alone says that they are not nearly parallel.
fn crossing(pair: &DirectedPair<'_>, (side, edge): (Side, EdgeId), other: EdgeId) -> Option<EntrancePlane> {
    let (a, b) = if side == Side::A { (edge, other) } else { (other, edge) };
    let ((_, d), (_, c)) = (pair.f64_view.edge(Side::A, a), pair.f64_view.edge(Side::B, b));
    let sine = length(cross(unit(d), unit(c)));
    let convex = pair.f64_view.a.edge_is_convex(a) && pair.f64_view.b.edge_is_convex(b);
    (convex && sine > pair.set.parallel_sine.approximate() * 1.001 + 1e-6).then_some(EntrancePlane::Edges(a, b))
}

impl PlaneRole {
    /// An offset of B with which the plane is asked at a territory of about `r` (m).
    fn reached(self, sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, r: f64) -> Option<F64Vector> {
        match self {
            PlaneRole::Corner((side, v), owner) => {
                let other = side.other();
                within(sampler, r, |x| {
                    let start = pair.offset_to((side, v), plus(pair.f64_view.vertex(other, owner), x));
                    let moved = pair.f64_view.moved(start);
                    (start, length(minus(moved.vertex(side, v), moved.vertex(other, owner))))
                })
            }
            PlaneRole::Edge((side, v), edge) => {
                let (p, d) = pair.f64_view.edge(side.other(), edge);
                let foot = plus(p, times(d, sampler.between(6, 10) as f64 / 16.0));
                within(sampler, r, |x| {
                    let start = pair.offset_to((side, v), plus(foot, x));
                    (start, pair.f64_view.moved(start).foot(side, v, edge).1)
                })
            }
            PlaneRole::Under((side, v), face) => {
                let other = side.other();
                let normal = pair.f64_view.normal(other, face);
                let depth = pair.penetration() * sampler.between(1, 60) as f64 / 64.0;
                let corners: Vec<VertexId> = pair.corners(other, face).map(|(_, c)| c).collect();
                let (c, corner) =
                    (pair.f64_view.centre(other, face), pair.f64_view.vertex(other, *sampler.pick(&corners)));
                let foot = plus(c, times(minus(corner, c), sampler.between(0, 6) as f64 / 16.0));
                let start = pair.offset_to((side, v), minus(foot, times(normal, depth)));
                let (gap, outside) = pair.f64_view.moved(start).above_face(side, v, face);
                (outside == 0.0 && gap < 0.0 && gap >= -pair.penetration()).then_some(start)
            }
        }
    }
}

/// The offset of B that `place` makes of a small vector such that the distance there is within territories of radius `r`
/// and the features' own.
fn within(sampler: &mut PairSampler<'_>, r: f64, place: impl Fn(F64Vector) -> (F64Vector, f64)) -> Option<F64Vector> {
    // Every rung of the ladder has to keep it inside.
    let radius = r * 0.8;
    (0..DRAWS).find_map(|n| {
        let reach = radius / f64::from(1 << n.min(4));
        let drawn = [(); 3].map(|()| reach * sampler.between(-64, 64) as f64 / 64.0);
        let (start, distance) = place(drawn);
        (distance <= radius).then_some(start)
    })
}

/// The sine between the two faces at a blunt edge of a convex block, and an offset of B that puts a vertex of the
/// other under both: one of the overlaps may be another way out than the other. The way out is the shallower one, or the
/// one that is a true exit alone.
pub(super) fn one_exit(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> CriticalDecision {
    if !(pair.f64_view.a.is_convex() && pair.f64_view.b.is_convex()) {
        return None;
    }
    let (low, high) = (pair.territory(), pair.penetration());
    if low >= 0.8 * high {
        return None;
    }
    let (asked, vertex, edge) = (0..DRAWS).find_map(|_| ridge_under_vertex(sampler, pair, true))?;
    let other = asked.other();
    let shallow = low + (high - low) / 16.0 * sampler.between(2, 8) as f64;
    let deep = shallow + (high - low) / 16.0 * sampler.between(1, 5) as f64;
    let left_is_deep = sampler.chance(50);
    let depths = if left_is_deep { [deep, shallow] } else { [shallow, deep] };
    let start = under_faces(sampler, pair, (asked, vertex, edge), depths)?;
    let exact = pair.exact(&pair.faces_at_edge(other, edge).collect::<Vec<_>>(), start);
    let e = exact.edge(other, edge);
    let (n, m) = (exact.normal(other, e.left), exact.normal(other, e.right));
    if !n.dot(m).is_positive() {
        return None;
    }
    let (deeper, shallower) = if left_is_deep { (e.left, e.right) } else { (e.right, e.left) };
    let leaves = |face: FaceId| pair.cone_leaves((asked, vertex), face);
    let kept_in = if leaves(deeper) && !leaves(shallower) { shallower } else { deeper };
    let both = [Feature::Vertex(asked, vertex), Feature::Face(other, kept_in)];
    let features = if asked == Side::A { both } else { [both[1], both[0]] };
    let sine = fraction(n.cross(m).norm_squared(), n.norm_squared() * m.norm_squared());
    Some((Decision::about(Predicate::OneExit, &features), sine, start))
}
