//! Whether an aim is worth taking: at the root, the other decisions of the same test must not settle it first.

use super::f64_view::{dot, length, minus};
use super::{Aim, DirectedPair};
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{EdgeId, FaceId, VertexId};

/// The share of a feature's length that a foot keeps from its ends, and a vertex from the other sides of a face.
const MARGIN: f64 = 1.0 / 64.0;

/// The aim, with its reach; `None` where it would not be asked.
pub(super) fn checked(pair: &DirectedPair<'_>, mut aim: Aim) -> Option<Aim> {
    let f64_view = pair.f64_view.moved(aim.approximate_root());
    let search = pair.search() * 1.001;
    let inside = |t: f64| (MARGIN..1.0 - MARGIN).contains(&t);
    let radial = |from: [f64; 3]| from[aim.axis].abs();
    aim.reach = match (aim.decision.predicate, aim.decision.features()) {
        (Predicate::Neighbours, _) => extent(pair, aim.axis) * MARGIN,
        (
            predicate @ (Predicate::VertexVertexNear | Predicate::VertexTerritory | Predicate::VertexRegion),
            [Some(Feature::Vertex(side, v)), Some(Feature::Vertex(_, w)), ..],
        ) => {
            let apart = minus(f64_view.vertex(side, v), f64_view.vertex(side.other(), w));
            if length(apart) > search {
                return None;
            }
            if predicate == Predicate::VertexRegion { f64::INFINITY } else { radial(apart) }
        }
        (
            predicate @ (Predicate::FootInside
            | Predicate::VertexEdgeNear
            | Predicate::EdgeTerritory
            | Predicate::EdgeRegion
            | Predicate::FootRegion),
            [Some(Feature::Vertex(side, v)), Some(Feature::Edge(_, e)), ..],
        ) => {
            let (along, distance) = f64_view.foot(side, v, e);
            if distance > search || (predicate != Predicate::FootInside && !inside(along)) {
                return None;
            }
            let (p, d) = f64_view.edge(side.other(), e);
            match predicate {
                Predicate::FootInside => length(d) * MARGIN,
                Predicate::EdgeRegion | Predicate::FootRegion => f64::INFINITY,
                _ => {
                    let x = minus(f64_view.vertex(side, v), p);
                    radial(minus(x, d.map(|c| c * dot(x, d) / dot(d, d))))
                }
            }
        }
        (Predicate::InsideFace, [Some(Feature::Vertex(side, v)), Some(Feature::Face(_, f)), ..]) => {
            let (gap, _) = f64_view.above_face(side, v, f);
            if gap > search || gap < -pair.penetration() * 1.001 {
                return None;
            }
            inner_reach(&f64_view, side, v, f)?
        }
        (
            Predicate::VertexFaceNear | Predicate::VertexFaceDepth | Predicate::ShortestExit,
            [Some(Feature::Vertex(side, v)), Some(Feature::Face(_, f)), ..],
        )
        | (Predicate::GapSign, [Some(Feature::Vertex(side, v)), Some(Feature::Face(_, f)), ..])
        | (Predicate::GapSign, [Some(Feature::Face(_, f)), Some(Feature::Vertex(side, v)), ..]) => {
            let (gap, outside) = f64_view.above_face(side, v, f);
            if outside > 0.0 || (aim.decision.predicate == Predicate::ShortestExit && gap >= 0.0) {
                return None;
            }
            f64::INFINITY
        }
        (predicate, [Some(Feature::Edge(Side::A, e)), Some(Feature::Edge(_, f)), ..]) => {
            let (s, t, apart) = f64_view.feet(e, f)?;
            let shorter = length(f64_view.edge(Side::A, e).1).min(length(f64_view.edge(Side::B, f).1));
            if predicate != Predicate::FeetInside {
                if !(inside(s) && inside(t)) {
                    return None;
                }
                f64::INFINITY
            } else {
                if apart > search || !(inside(s) || inside(t)) {
                    return None;
                }
                // The gradient of a foot grows as the edges become parallel.
                shorter * MARGIN * sine(&f64_view, e, f)
            }
        }
        (
            Predicate::EntranceDepth | Predicate::EntranceChoice,
            [Some(Feature::Vertex(_, v)), Some(Feature::Vertex(_, w)), ..],
        ) => {
            if length(minus(f64_view.vertex(Side::A, v), f64_view.vertex(Side::B, w))) > search {
                return None;
            }
            f64::INFINITY
        }
        _ => return None,
    };
    Some(aim)
}

/// The shorter of the two blocks' sides along an axis.
fn extent(pair: &DirectedPair<'_>, axis: usize) -> f64 {
    let side = |side: Side| {
        let all = pair.f64_view.block(side).topology();
        let along = || all.vertex_ids().map(|v| pair.f64_view.vertex(side, v)[axis]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    side(Side::A).min(side(Side::B))
}

/// How far a vertex on one side of a convex face is from the face's other sides; `None` when it is outside one, or the
/// face is not convex.
fn inner_reach(f64_view: &super::f64_view::F64View<'_>, side: Side, vertex: VertexId, face: FaceId) -> Option<f64> {
    let other = side.other();
    if !f64_view.block(other).face_is_convex(face) {
        return None;
    }
    let count = f64_view.block(other).topology().faces()[face.index()].len();
    let x = f64_view.vertex(side, vertex);
    let mut distances: Vec<f64> = (0..count).map(|k| f64_view.inside_side(x, other, face, k)).collect();
    distances.sort_by(f64::total_cmp);
    // The first is the side aimed at, about zero; the second must be well inside.
    let size = distances.last()?;
    (distances[1] > size * MARGIN && distances[0].abs() < distances[1] * MARGIN).then(|| distances[1] * MARGIN)
}

fn sine(f64_view: &super::f64_view::F64View<'_>, e: EdgeId, f: EdgeId) -> f64 {
    let (d, c) = (f64_view.edge(Side::A, e).1, f64_view.edge(Side::B, f).1);
    length(super::f64_view::cross(d, c)) / (length(d) * length(c))
}
