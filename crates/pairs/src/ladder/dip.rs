//! How far a solid angle dips below a plane: the two measures of the no-overlap checks, and ladders across each.

use super::LadderPair;
use super::search::{CriticalDecision, NO_MOVE, both_edges};
use crate::directed::edges::across;
use crate::directed::exact::{ExactPlacement, at_most, fraction};
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

impl DipMeasure {
    fn other(self) -> DipMeasure {
        match self {
            DipMeasure::Angle => DipMeasure::Length,
            DipMeasure::Length => DipMeasure::Angle,
        }
    }
}

/// One edge direction, or one face at an edge, that dips below a plane. Quotients, not in lowest terms.
pub(super) struct Dip {
    /// The square of the sine of the angle.
    sine: (BigInt, BigInt),
    /// The square of the depth of the far end (m²).
    depth: (BigInt, BigInt),
}

impl Dip {
    fn by(&self, measure: DipMeasure) -> &(BigInt, BigInt) {
        match measure {
            DipMeasure::Angle => &self.sine,
            DipMeasure::Length => &self.depth,
        }
    }

    /// Whether one measure alone lets the dip pass; **a tie says yes**.
    pub(super) fn within(&self, set: &ToleranceSet, measure: DipMeasure) -> bool {
        lets_pass(self.by(measure), set, measure)
    }
}

fn lets_pass(dip: &(BigInt, BigInt), set: &ToleranceSet, measure: DipMeasure) -> bool {
    match measure {
        DipMeasure::Angle => at_most(dip, &set.overlap_sine),
        DipMeasure::Length => set.criteria == Criteria::Classic || at_most(dip, &set.penetration),
    }
}

/// The square of the largest of some dips.
pub(super) fn largest(dips: Vec<Dip>, measure: DipMeasure) -> Option<BigRational> {
    let order = |one: &Dip, other: &Dip| {
        let ((n, d), (m, e)) = (one.by(measure), other.by(measure));
        (n * e).cmp(&(m * d))
    };
    let (numerator, denominator) = dips.iter().max_by(|one, other| order(one, other))?.by(measure);
    Some(fraction(numerator.clone(), denominator.clone()))
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
        sine: (squared.clone(), &norms * e.norm_squared()),
        depth: exact.in_square_metres(squared, norms),
    })
}

/// The dips of the four faces at two edges, along their common perpendicular; `None`, soon, where not all of these measures let one of them pass.
pub(super) fn wedge_dips_within(
    exact: &ExactPlacement<'_>,
    (ea, eb): (EdgeId, EdgeId),
    (set, measures): (&ToleranceSet, &[DipMeasure]),
) -> Option<Vec<Dip>> {
    let fails = |dip: &(BigInt, BigInt), measure| measures.contains(&measure) && !lets_pass(dip, set, measure);
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
        let sine = (&rise * &rise, &across * m.norm_squared());
        if fails(&sine, DipMeasure::Angle) {
            return None;
        }
        let (width, over) = width_squared(exact, side, edge, face);
        let depth = exact.in_square_metres(&sine.0 * width, &sine.1 * over);
        if fails(&depth, DipMeasure::Length) {
            return None;
        }
        dips.push(Dip { sine, depth });
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
pub(super) fn cone(sampler: &mut PairSampler<'_>, ladder: &LadderPair<'_>, by: DipMeasure) -> CriticalDecision {
    let pair = &ladder.directed;
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
    // The vertex is not part of the key: only one end of an edge dips below a face, and f64, which negates exactly, finds the same end.
    let squared = ladder.of_face((asked, edge.index()), f, || {
        let exact = pair.exact(&cone_vertices(pair, (asked, v), f), NO_MOVE);
        // Both measures must hold, so one decides only where the other says yes.
        let dip = cone_dip(&exact, (asked, v), f, edge).filter(|dip| dip.within(pair.set, by.other()))?;
        largest(vec![dip], by)
    })?;
    let features = [Feature::Vertex(asked, v), Feature::Face(asked.other(), f), Feature::Edge(asked, edge)];
    Some((Decision::about(Predicate::ConePasses, &features), BigRational::clone(&squared), start))
}

/// The worst of the faces at two crossing edges that dip by one measure, while the other lets all of them pass. The
/// edges are brought across each other.
pub(super) fn wedges(sampler: &mut PairSampler<'_>, ladder: &LadderPair<'_>, by: DipMeasure) -> CriticalDecision {
    let pair = &ladder.directed;
    let (ea, eb) = pair.f64_view.edge_edge(sampler)?;
    let start = across(sampler, pair, ea, eb)?;
    let worst = ladder.of_edges((ea, eb), || {
        let exact = both_edges(pair, (ea, eb), NO_MOVE);
        largest(wedge_dips_within(&exact, (ea, eb), (pair.set, &[by.other()]))?, by)
    })?;
    let features = [Feature::Edge(Side::A, ea), Feature::Edge(Side::B, eb)];
    Some((Decision::about(Predicate::WedgesPass, &features), BigRational::clone(&worst), start))
}
