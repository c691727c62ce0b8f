//! How far a solid angle dips below a plane: the two measures of the no-overlap checks, and ladders across each.

use super::search::{CriticalDecision, both_edges};
use crate::directed::edges::across;
use crate::directed::exact::{ExactPlacement, fraction};
use crate::directed::faces::over_face;
use crate::directed::vertices::DRAWS;
use crate::directed::{DirectedPair, side};
use crate::families::PairSampler;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Criteria, EdgeId, FaceId, ToleranceSet, Vec3, VertexId};

/// What a dip is measured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DipMeasure {
    /// The sine of its angle, compared with the overlap angle.
    Angle,
    /// The depth of its far end (m), compared with g; under `revised` only.
    Length,
}

/// One edge direction, or one face at an edge, that dips below a plane.
pub(super) struct Dip {
    /// The square of the sine of the angle.
    sine: BigRational,
    /// The square of the depth of the far end (m²).
    pub(super) depth: BigRational,
}

impl Dip {
    /// Whether one measure alone lets the dip pass; **a tie says yes**.
    fn within(&self, set: &ToleranceSet, measure: DipMeasure) -> bool {
        match measure {
            DipMeasure::Angle => self.sine <= set.overlap_sine.to_rational().pow(2),
            DipMeasure::Length => {
                set.criteria == Criteria::Classic || self.depth <= set.penetration.to_rational().pow(2)
            }
        }
    }

    /// Whether the dip passes: by both measures.
    pub(super) fn passes(&self, set: &ToleranceSet) -> bool {
        self.within(set, DipMeasure::Angle) && self.within(set, DipMeasure::Length)
    }

    /// The square of the tolerance at which the dip begins to pass. Both measures must hold, so one decides only where
    /// the other says yes; `None` elsewhere.
    fn critical(&self, set: &ToleranceSet, measure: DipMeasure) -> Option<&BigRational> {
        match measure {
            DipMeasure::Angle => self.within(set, DipMeasure::Length).then_some(&self.sine),
            DipMeasure::Length => self.within(set, DipMeasure::Angle).then_some(&self.depth),
        }
    }
}

/// The vertices that [`cone_dip`] needs on the lattice, for all edges at the vertex.
pub(super) fn cone_vertices(
    pair: &DirectedPair<'_>,
    (asked, vertex): (Side, VertexId),
    face: FaceId,
) -> Vec<(Side, VertexId)> {
    let topology = pair.f64_view.block(asked).topology();
    let ends = topology.vertex_edges(vertex).iter().map(|&e| (asked, topology.edge(e).other(vertex)));
    pair.corners(asked.other(), face).chain([(asked, vertex)]).chain(ends).collect()
}

/// The dip of one edge at a vertex below a face of the other block; `None` where it does not dip.
pub(super) fn cone_dip(
    exact: &ExactPlacement<'_>,
    (asked, vertex): (Side, VertexId),
    face: FaceId,
    edge: EdgeId,
) -> Option<Dip> {
    let n = exact.normal(asked.other(), face);
    let end = exact.edge(asked, edge).other(vertex);
    let e = exact.vertex(asked, end).minus(exact.vertex(asked, vertex));
    let rise = e.dot(n);
    let (squared, norms) = (&rise * &rise, n.norm_squared());
    rise.is_negative().then(|| Dip {
        sine: fraction(squared.clone(), &norms * e.norm_squared()),
        depth: exact.square_metres(&squared, &norms),
    })
}

/// The dips of the four faces at two edges, along their common perpendicular.
pub(super) fn wedge_dips(exact: &ExactPlacement<'_>, edges: (EdgeId, EdgeId)) -> Vec<Dip> {
    shallow_wedge_dips(exact, edges, None).unwrap_or_default()
}

/// The same; `None`, soon, where one of them is beyond a sine.
pub(super) fn shallow_wedge_dips(
    exact: &ExactPlacement<'_>,
    (ea, eb): (EdgeId, EdgeId),
    sine: Option<&BigRational>,
) -> Option<Vec<Dip>> {
    let n = exact.direction(Side::A, ea).cross(&exact.direction(Side::B, eb));
    let over_faces = [(Side::A, ea), (Side::B, eb)].map(|(side, edge)| {
        let e = exact.edge(side, edge);
        [e.left, e.right].map(|face| {
            let m = exact.inward(side, edge, face);
            (side, edge, face, n.dot(&m), m)
        })
    });
    // The common perpendicular is n or −n: σ of SPEC section 4.
    let [of_a, of_b] = over_faces.each_ref().map(|[(.., left, _), (.., right, _)]| left + right);
    let is_turned = of_a < of_b;
    let across = n.norm_squared();
    let mut dips = Vec::new();
    for (side, edge, face, rise, m) in over_faces.into_iter().flatten() {
        if rise.is_zero() || (rise.is_negative() != is_turned) == (side == Side::B) {
            continue;
        }
        let (squared, norms) = (&rise * &rise, &across * m.norm_squared());
        if sine.is_some_and(|sine| &squared * sine.denom().pow(2) > &norms * sine.numer().pow(2)) {
            return None;
        }
        let (width, over) = width_squared(exact, side, edge, face);
        let depth = exact.square_metres(&(&squared * width), &(&norms * over));
        dips.push(Dip { sine: fraction(squared, norms), depth });
    }
    Some(dips)
}

/// The square of the greatest distance of a face's vertices from the line of one of its edges: numerator, denominator.
fn width_squared(exact: &ExactPlacement<'_>, side: Side, edge: EdgeId, face: FaceId) -> (BigInt, BigInt) {
    let d = exact.direction(side, edge);
    let p = exact.vertex(side, exact.edge(side, edge).p);
    let corners = exact.block(side).topology().face(face);
    let far = corners.iter().map(|&v| exact.vertex(side, v).minus(p).cross(&d)).max_by_key(Vec3::norm_squared);
    (far.map_or(BigInt::zero(), |f| f.norm_squared()), d.norm_squared())
}

/// The one edge direction at a vertex that dips below a plane by one measure, while the other lets it pass. The vertex is
/// brought over the face.
pub(super) fn cone(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, by: DipMeasure) -> CriticalDecision {
    let (asked, v, f, edge) = (0..DRAWS).find_map(|_| {
        let asked = side(sampler);
        let (v, f) = pair.f64_view.vertex_face(sampler, asked);
        let edge = *sampler.pick(pair.f64_view.block(asked).topology().vertex_edges(v));
        // The decision matters only where the other edges pass.
        let dip = pair.dip((asked, v), f, edge);
        let alone = dip > 0.0 && pair.cone_passes((asked, v), f, Some(edge));
        let decides = by == DipMeasure::Length || pair.is_shallow(dip);
        (alone && decides).then_some((asked, v, f, edge))
    })?;
    let start = over_face(sampler, pair, (asked, v), f, None);
    let exact = pair.exact(&cone_vertices(pair, (asked, v), f), start);
    let dip = cone_dip(&exact, (asked, v), f, edge)?;
    let features = [Feature::Vertex(asked, v), Feature::Face(asked.other(), f), Feature::Edge(asked, edge)];
    Some((Decision::about(Predicate::ConePasses, &features), dip.critical(pair.set, by)?.clone(), start))
}

/// The worst of the faces at two crossing edges that dip by one measure, while the other lets all of them pass. The
/// edges are brought across each other.
pub(super) fn wedges(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, by: DipMeasure) -> CriticalDecision {
    let (ea, eb) = pair.f64_view.edge_edge(sampler)?;
    let start = across(sampler, pair, ea, eb)?;
    let dips = wedge_dips(&both_edges(pair, (ea, eb), start), (ea, eb));
    let critical = dips.iter().map(|dip| dip.critical(pair.set, by)).collect::<Option<Vec<_>>>()?;
    let worst = critical.into_iter().max()?.clone();
    let features = [Feature::Edge(Side::A, ea), Feature::Edge(Side::B, eb)];
    Some((Decision::about(Predicate::WedgesPass, &features), worst, start))
}
