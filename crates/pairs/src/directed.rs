//! Pairs moved to the boundary of one decision: B is put where the decision's margin is exactly zero, or a few steps of
//! the number format to either side.
//!
//! The **margin** of a decision is positive where the answer is yes, negative where it is no, and zero on the boundary:
//!
//! | predicate | margin |
//! | --- | --- |
//! | neighbours | least over the axes and sides of `max_A + s − min_B`, `max_B + s − min_A` |
//! | vertex-vertex-near, vertex-territory | radius² − `|a−b|²` |
//! | vertex-region, edge-region, foot-region | `−(a−b)·e`, `−(a−p)·m`, `−(f−a)·e` |
//! | foot-inside, feet-inside | distance of the foot from the nearer end, negative beyond it |
//! | vertex-edge-near, edge-territory | radius² − distance² |
//! | vertex-face-near, edge-edge-near | s − h |
//! | vertex-face-depth, edge-edge-depth, entrance-depth | h + g |
//! | inside-face | distance from the nearest side of the polygon, negative outside |
//! | gap-sign | h |
//! | entrance-choice, shortest-exit | gap of the first face − gap of the second (− its ε share) |
//!
//! Decisions about directions alone do not depend on where B is; [`ladder`](super::ladder) changes the tolerance they are
//! compared with instead. Under `revised` the margin of the first three is the lesser of their two measures, so that one
//! tolerance decides only where the other says yes:
//!
//! | predicate | margin | tolerances |
//! | --- | --- | --- |
//! | cone-passes | so − the sine of the dip; g − its depth | overlap_sine, penetration |
//! | wedges-pass | so − the largest sine of a dip; g − the largest depth | overlap_sine, penetration |
//! | nearly-parallel | sp − the sine; r − the drift over the longer edge's length | parallel_sine, territory |
//! | true-exit | r/10 − the largest depth of a dip | territory |
//! | one-exit | so − the sine between the normals | overlap_sine |

mod check;
pub(crate) mod edges;
pub(crate) mod exact;
pub(crate) mod f64_view;
pub(crate) mod faces;
pub(crate) mod remembered;
pub(crate) mod vertices;

use self::remembered::Remembered;
use super::families::PairSampler;
use exact::{AffineMargin, ExactPlacement};
use f64_view::{F64Vector, F64View, dot, length, minus, quantum, times};
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::number::{exact_log2, power_of_two, round_rational};
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Criteria, EdgeId, FaceId, Number, Precision, Sign, ToleranceSet, VertexId};
use std::rc::Rc;

/// Where B has to be for a decision to be on its boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Aim {
    /// The decision aimed at.
    pub decision: Decision,
    /// How far B has to be moved (m). Where `exact` is false, rounded to far below the spacing of f64.
    pub root: [BigRational; 3],
    /// Whether the margin is exactly zero there. Otherwise the root is irrational.
    pub exact: bool,
    /// The axis along which rungs step.
    pub axis: usize,
    /// Whether the margin rises when B moves along the axis; it falls otherwise.
    pub rising: bool,
    /// How far along the axis the margin keeps its sign, at least (m): beyond, another end of the edge or another side
    /// of the face may decide.
    pub reach: f64,
}

/// A place on the ladder around a root or a critical value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rung {
    /// The exact value.
    Exact,
    /// The value rounded to the precision's spacing, and this many steps from there.
    Steps(Precision, i64),
    /// A share of the tolerance away, in thousandths.
    Permille(i32),
}

impl Rung {
    /// The rung as far to the other side.
    pub(crate) fn mirrored(self) -> Rung {
        match self {
            Rung::Exact => Rung::Exact,
            Rung::Steps(precision, steps) => Rung::Steps(precision, -steps),
            Rung::Permille(share) => Rung::Permille(-share),
        }
    }
}

/// The share of r by which a true exit may dip.
const TRUE_EXIT: f64 = 0.1;

/// The predicates that depend on where B is.
pub const MOVED: [Predicate; 17] = [
    Predicate::Neighbours,
    Predicate::VertexVertexNear,
    Predicate::VertexTerritory,
    Predicate::VertexRegion,
    Predicate::FootInside,
    Predicate::VertexEdgeNear,
    Predicate::EdgeTerritory,
    Predicate::EdgeRegion,
    Predicate::FootRegion,
    Predicate::VertexFaceNear,
    Predicate::VertexFaceDepth,
    Predicate::InsideFace,
    Predicate::FeetInside,
    Predicate::EdgeEdgeNear,
    Predicate::EdgeEdgeDepth,
    Predicate::GapSign,
    Predicate::EntranceDepth,
];

/// The predicates that choose between two faces; they depend on where B is as well.
pub const FACE_CHOICES: [Predicate; 2] = [Predicate::EntranceChoice, Predicate::ShortestExit];

/// Chooses features of the pair and finds where B has to be for `predicate` to be on its boundary under `set`.
/// `None` where the pair has no suitable features, or the predicate does not depend on where B is.
/// Where other decisions of the same test would keep this one from being asked, or from mattering, the answer is
/// `None` too: try again.
pub(crate) fn aim(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, predicate: Predicate) -> Option<Aim> {
    let aim = match predicate {
        Predicate::Neighbours => vertices::neighbours(sampler, pair),
        Predicate::VertexVertexNear | Predicate::VertexTerritory => vertices::distance(sampler, pair, predicate),
        Predicate::VertexRegion => vertices::region(sampler, pair),
        Predicate::FootInside => edges::foot_inside(sampler, pair),
        Predicate::EdgeRegion => edges::edge_region(sampler, pair),
        Predicate::FootRegion => edges::foot_region(sampler, pair),
        Predicate::VertexEdgeNear | Predicate::EdgeTerritory => edges::distance(sampler, pair, predicate),
        Predicate::VertexFaceNear | Predicate::VertexFaceDepth | Predicate::InsideFace => {
            faces::vertex_face(sampler, pair, predicate)
        }
        Predicate::GapSign if sampler.chance(60) => faces::vertex_face(sampler, pair, predicate),
        Predicate::GapSign | Predicate::FeetInside | Predicate::EdgeEdgeNear | Predicate::EdgeEdgeDepth => {
            edges::edge_edge(sampler, pair, predicate)
        }
        Predicate::EntranceDepth => faces::entrance_depth(sampler, pair),
        Predicate::EntranceChoice => faces::entrance_choice(sampler, pair),
        Predicate::ShortestExit => faces::shortest_exit(sampler, pair),
        Predicate::ConePasses
        | Predicate::NearlyParallel
        | Predicate::WedgesPass
        | Predicate::TrueExit
        | Predicate::OneExit => None,
    }?;
    check::checked(pair, aim)
}

/// What every aim needs to know of the pair.
pub(crate) struct DirectedPair<'p> {
    pub(crate) f64_view: F64View<'p>,
    pub(crate) set: &'p ToleranceSet,
    /// The coarsest precision that holds the pair: offsets are kept to its spacing where they can be.
    precision: Precision,
    /// Of a vertex of each side and one of the other: see [`DirectedPair::ways_in`].
    ways_in: [Remembered<Rc<[FaceId]>>; 2],
}

impl<'p> DirectedPair<'p> {
    pub(crate) fn new(a: &'p Block, b: &'p Block, set: &'p ToleranceSet) -> DirectedPair<'p> {
        let held = a.is_exact_in(Precision::F32) && b.is_exact_in(Precision::F32);
        let precision = if held { Precision::F32 } else { Precision::F64 };
        let [of_a, of_b] = [a, b].map(|block| block.vertices().len());
        let ways_in = [Remembered::new(of_a, of_b), Remembered::new(of_b, of_a)];
        DirectedPair { f64_view: F64View::of(a, b), set, precision, ways_in }
    }

    fn blocks(&self) -> (&'p Block, &'p Block) {
        (self.f64_view.a, self.f64_view.b)
    }

    /// The lattice of these vertices with B moved by `start`.
    pub(crate) fn exact(&self, vertices: &[(Side, VertexId)], start: F64Vector) -> ExactPlacement<'p> {
        ExactPlacement::new(self.blocks(), vertices, start, self.set)
    }

    fn search(&self) -> f64 {
        self.set.search.approximate()
    }

    pub(crate) fn penetration(&self) -> f64 {
        self.set.penetration.approximate()
    }

    /// An upper bound of the territory radii.
    pub(crate) fn territory(&self) -> f64 {
        match self.set.criteria {
            Criteria::Classic => self.search(),
            Criteria::Revised => self.set.territory.approximate(),
        }
    }

    /// A random vector of at most about `reach` in each component, on the grid.
    fn jitter(&self, sampler: &mut PairSampler<'_>, reach: f64) -> F64Vector {
        let part = |sampler: &mut PairSampler<'_>| reach * sampler.between(-64, 64) as f64 / 64.0;
        self.on_grid([part(sampler), part(sampler), part(sampler)])
    }

    fn on_grid(&self, vector: F64Vector) -> F64Vector {
        self.f64_view.on_grid(vector, self.precision)
    }

    /// The offset of B, on the grid, that brings a vertex to `target` (where the other block's features are now).
    pub(crate) fn offset_to(&self, (side, vertex): (Side, VertexId), target: F64Vector) -> F64Vector {
        let way = minus(target, self.f64_view.vertex(side, vertex));
        self.on_grid(if side == Side::B { way } else { times(way, -1.0) })
    }

    pub(crate) fn corners(&self, side: Side, face: FaceId) -> impl Iterator<Item = (Side, VertexId)> + use<'p> {
        self.f64_view.block(side).topology().faces()[face.index()].iter().map(move |&v| (side, v))
    }

    /// The vertices of the two faces at an edge, its ends among them.
    pub(crate) fn faces_at_edge(&self, side: Side, edge: EdgeId) -> impl Iterator<Item = (Side, VertexId)> + use<'p> {
        let e = self.f64_view.block(side).topology().edge(edge);
        self.corners(side, e.left).chain(self.corners(side, e.right))
    }

    /// How far the end of an edge at a vertex dips below the direction of a face's plane (m), in f64.
    pub(crate) fn dip(&self, (side, vertex): (Side, VertexId), face: FaceId, edge: EdgeId) -> f64 {
        let end = self.f64_view.block(side).topology().edge(edge).other(vertex);
        let arm = minus(self.f64_view.vertex(side, end), self.f64_view.vertex(side, vertex));
        -dot(arm, self.f64_view.normal(side.other(), face))
    }

    /// Whether the cone at a vertex passes a face plane, as far as f64 can tell; `but` one edge.
    pub(crate) fn cone_passes(&self, (side, vertex): (Side, VertexId), face: FaceId, but: Option<EdgeId>) -> bool {
        let edges = self.f64_view.block(side).topology().vertex_edges(vertex).iter();
        let sine = self.set.overlap_sine.approximate();
        edges.filter(|e| Some(**e) != but).all(|&e| {
            let dip = self.dip((side, vertex), face, e);
            let long = length(self.f64_view.edge(side, e).1);
            let slack = f64::EPSILON * 64.0 * long;
            dip <= sine * long + slack && self.is_shallow(dip - slack)
        })
    }

    /// The faces at a vertex of the other block, `owner`, that the cone at a vertex passes: the true exits, or all if none is.
    pub(crate) fn ways_in(&self, (side, vertex): (Side, VertexId), owner: VertexId) -> Rc<[FaceId]> {
        self.ways_in[side as usize].get(vertex.index(), owner.index(), || {
            let all = self.f64_view.block(side.other()).topology().vertex_faces(owner).iter().copied();
            let passed: Vec<FaceId> = all.filter(|&f| self.cone_passes((side, vertex), f, None)).collect();
            let exits: Vec<FaceId> = passed.iter().copied().filter(|&f| self.cone_leaves((side, vertex), f)).collect();
            // The choice is among the true exits, where there is one.
            Rc::from(if exits.is_empty() { passed } else { exits })
        })
    }

    /// Whether the length of a dip (m) lets it pass: always under `classic`.
    pub(crate) fn is_shallow(&self, dip: f64) -> bool {
        self.set.criteria == Criteria::Classic || dip <= self.penetration()
    }

    /// Whether a face plane that the cone at a vertex passes is a true exit, as far as f64 can tell.
    pub(crate) fn cone_leaves(&self, (side, vertex): (Side, VertexId), face: FaceId) -> bool {
        let edges = self.f64_view.block(side).topology().vertex_edges(vertex).iter();
        let limit = self.set.territory.approximate() * TRUE_EXIT;
        self.set.criteria == Criteria::Classic
            || edges.copied().all(|e| {
                let slack = f64::EPSILON * 64.0 * length(self.f64_view.edge(side, e).1);
                self.dip((side, vertex), face, e) <= limit + slack
            })
    }
}

/// The aim at the zero of an affine margin, by a move along one axis: one that matters, and mostly one along which the
/// place is binary if there is such, so that the tie survives in a float.
fn linear(
    sampler: &mut PairSampler<'_>,
    exact: &ExactPlacement<'_>,
    decision: Decision,
    margin: &AffineMargin,
) -> Option<Aim> {
    let slopes = margin.gradient.components();
    let steepest = slopes.iter().map(|c| c.magnitude()).max()?;
    if steepest.is_zero() {
        return None;
    }
    let first = sampler.below(3) as usize;
    let axes = (0..3).map(|i| (first + i) % 3).filter(|&i| slopes[i].magnitude() * 8u32 >= *steepest);
    let places = axes.map(|i| (i, exact.metres(&-&margin.constant, slopes[i])));
    let mut places: Vec<(usize, BigRational)> = places.collect();
    let binary = |(_, place): &(usize, BigRational)| exact_log2(place.denom()).is_some();
    let wanted = if sampler.chance(75) { places.iter().position(binary).unwrap_or(0) } else { 0 };
    let (axis, place) = places.swap_remove(wanted);
    Some(Aim {
        decision,
        root: exact.offset(axis, place),
        exact: margin.exact,
        axis,
        rising: slopes[axis].sign() == num_bigint::Sign::Plus,
        reach: f64::INFINITY,
    })
}

/// A decision about features of the two sides.
fn about(predicate: Predicate, features: &[Feature]) -> Decision {
    Decision::about(predicate, features)
}

/// One of the two sides.
pub(crate) fn side(sampler: &mut PairSampler<'_>) -> Side {
    if sampler.chance(50) { Side::A } else { Side::B }
}

/// An offset of B, and the sign the margin has there if that is certain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OffsetStep {
    /// How far B moves (m).
    pub offset: [Number; 3],
    /// The sign of the margin there; `None` where rounding the root may have crossed it.
    pub margin: Option<Sign>,
}

impl Aim {
    /// Whether the root's numbers are short enough to be worth carrying exactly (a few words each).
    pub fn is_short(&self) -> bool {
        self.root.iter().all(|c| c.denom().bits() <= 160)
    }

    /// Where B goes for `rung`. `magnitude` is the largest coordinate of the pair (m), which says what a step is;
    /// `tolerance` (m) what a thousandth is of. `None` where the rung asks for an exact zero and there is none.
    pub fn step(&self, rung: Rung, magnitude: f64, tolerance: f64) -> Option<OffsetStep> {
        let (spacing, steps) = match rung {
            Rung::Exact => {
                let zero =
                    OffsetStep { offset: self.root.clone().map(Number::from_rational), margin: Some(Sign::Zero) };
                return self.exact.then_some(zero);
            }
            Rung::Steps(precision, steps) => (quantum(magnitude, precision), steps as f64),
            Rung::Permille(share) => {
                let spacing = quantum(magnitude, Precision::F64);
                (spacing, (tolerance * f64::from(share) / 1000.0 / spacing).round())
            }
        };
        let mut offset = self.approximate_root().map(|c| (c / spacing).round() * spacing);
        offset[self.axis] += steps * spacing;
        let offset = offset.map(|c| Number::from_f64(c).unwrap_or(Number::ZERO));
        Some(OffsetStep { margin: self.sign_at(&offset, spacing), offset })
    }

    /// The root in f64; infinite where that overflows.
    pub(super) fn approximate_root(&self) -> [f64; 3] {
        self.root.each_ref().map(|c| round_rational(c, Precision::F64).unwrap_or(f64::INFINITY))
    }

    fn sign_at(&self, offset: &[Number; 3], spacing: f64) -> Option<Sign> {
        let offset = offset.each_ref().map(Number::to_rational);
        let others_fit = (0..3).all(|i| i == self.axis || offset[i] == self.root[i]);
        // Beyond the root by `beyond / over`; no fraction is reduced for a sign.
        let (at, root) = (&offset[self.axis], &self.root[self.axis]);
        let beyond = at.numer() * root.denom() - root.numer() * at.denom();
        let over = at.denom() * root.denom();
        let further_than = |metres: f64| {
            let limit = Number::from_f64(metres).unwrap_or(Number::ZERO).to_rational();
            beyond.magnitude() * limit.denom().magnitude() > limit.numer().magnitude() * over.magnitude()
        };
        // Rounding the other coordinates moves them by half a step at most; four along a steep axis outdo that.
        let certain = match (others_fit, self.exact) {
            (true, true) => true,
            (true, false) => further_than(spacing * power_of_two(-20)),
            (false, _) => further_than(4.0 * spacing),
        };
        let within = self.reach == f64::INFINITY || !further_than(self.reach);
        let sign = ExactRing::sign(&beyond);
        (certain && within).then_some(if self.rising { sign } else { sign.reversed() })
    }
}

/// The largest magnitude among the pair's coordinates (m).
pub(crate) fn magnitude(a: &Block, b: &Block) -> f64 {
    a.coordinates().chain(b.coordinates()).fold(0.0f64, |m, c| m.max(c.approximate().abs()))
}
