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
//! Decisions about directions alone (cone-passes, wedges-pass, nearly-parallel, one-exit) do not depend on where B is;
//! [`ladder`](super::ladder) changes the tolerance they are compared with instead.

mod check;
mod edges;
pub(crate) mod exact;
mod faces;
pub(crate) mod shadow;
mod vertices;

use super::families::Kit;
use exact::Affine;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::decision::{Decision, Predicate, Side};
use rockproof_model::number::{power_of_two, round_rational};
use rockproof_model::{Block, Number, Precision, Sign, ToleranceSet};
use shadow::{Shadow, quantum};

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
pub const CHOSEN: [Predicate; 2] = [Predicate::EntranceChoice, Predicate::ShortestExit];

/// Chooses features of the pair and finds where B has to be for `predicate` to be on its boundary under `set`.
/// `None` where the pair has no suitable features, or the predicate does not depend on where B is.
/// Where other decisions of the same test would keep this one from being asked, or from mattering, the answer is
/// `None` too: try again.
pub fn aim(kit: &mut Kit<'_>, (a, b): (&Block, &Block), set: &ToleranceSet, predicate: Predicate) -> Option<Aim> {
    let shadow = Shadow::of(a, b);
    let pair = Pair {
        shadow: &shadow,
        set,
        precision: if a.is_exact_in(Precision::F32) && b.is_exact_in(Precision::F32) {
            Precision::F32
        } else {
            Precision::F64
        },
    };
    let aim = match predicate {
        Predicate::Neighbours => vertices::neighbours(kit, &pair),
        Predicate::VertexVertexNear | Predicate::VertexTerritory => vertices::distance(kit, &pair, predicate),
        Predicate::VertexRegion => vertices::region(kit, &pair),
        Predicate::FootInside | Predicate::EdgeRegion | Predicate::FootRegion => {
            edges::vertex_edge(kit, &pair, predicate)
        }
        Predicate::VertexEdgeNear | Predicate::EdgeTerritory => edges::distance(kit, &pair, predicate),
        Predicate::VertexFaceNear | Predicate::VertexFaceDepth | Predicate::InsideFace => {
            faces::vertex_face(kit, &pair, predicate)
        }
        Predicate::GapSign if kit.chance(60) => faces::vertex_face(kit, &pair, predicate),
        Predicate::GapSign | Predicate::FeetInside | Predicate::EdgeEdgeNear | Predicate::EdgeEdgeDepth => {
            edges::edge_edge(kit, &pair, predicate)
        }
        Predicate::EntranceDepth => faces::entrance_depth(kit, &pair),
        Predicate::EntranceChoice => faces::entrance_choice(kit, &pair),
        Predicate::ShortestExit => faces::shortest_exit(kit, &pair),
        Predicate::ConePasses | Predicate::NearlyParallel | Predicate::WedgesPass | Predicate::OneExit => None,
    }?;
    check::checked(&pair, aim)
}

/// What every aim needs to know of the pair.
struct Pair<'p> {
    shadow: &'p Shadow<'p>,
    set: &'p ToleranceSet,
    /// The coarsest precision that holds the pair: offsets are kept to its spacing where they can be.
    precision: Precision,
}

impl Pair<'_> {
    fn blocks(&self) -> (&Block, &Block) {
        (self.shadow.a, self.shadow.b)
    }

    fn search(&self) -> f64 {
        self.set.search.approximate()
    }

    fn penetration(&self) -> f64 {
        self.set.penetration.approximate()
    }

    /// A random vector of at most about `reach` in each component, on the grid.
    fn jitter(&self, kit: &mut Kit<'_>, reach: f64) -> shadow::V {
        let part = |kit: &mut Kit<'_>| reach * kit.between(-64, 64) as f64 / 64.0;
        self.shadow.on_grid([part(kit), part(kit), part(kit)], self.precision)
    }
}

/// The aim at the zero of an affine margin, by a move along one axis (mostly the one that matters most).
fn linear(kit: &mut Kit<'_>, exact: &exact::Exact<'_>, decision: Decision, margin: &Affine) -> Option<Aim> {
    let slopes = margin.gradient.components();
    let weight = |i: &usize| slopes[*i].magnitude().clone();
    let steepest = (0..3).max_by_key(weight)?;
    let other = kit.below(3) as usize;
    let axis = if slopes[other].magnitude() * 8u32 >= *slopes[steepest].magnitude() { other } else { steepest };
    if slopes[axis].is_zero() {
        return None;
    }
    let units = BigRational::new(-&margin.constant, slopes[axis].clone());
    Some(Aim {
        decision,
        root: exact.offset(axis, &units),
        exact: margin.exact,
        axis,
        rising: slopes[axis].sign() == num_bigint::Sign::Plus,
        reach: f64::INFINITY,
    })
}

/// A decision about features of the two sides.
fn about(predicate: Predicate, features: &[rockproof_model::decision::Feature]) -> Decision {
    Decision::about(predicate, features)
}

/// One of the two sides.
fn side(kit: &mut Kit<'_>) -> Side {
    if kit.chance(50) { Side::A } else { Side::B }
}

/// An offset of B, and the sign the margin has there if that is certain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
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
    pub fn step(&self, rung: Rung, magnitude: f64, tolerance: f64) -> Option<Step> {
        let (spacing, steps) = match rung {
            Rung::Exact => {
                let zero = Step { offset: self.root.clone().map(Number::from_rational), margin: Some(Sign::Zero) };
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
        Some(Step { margin: self.sign_at(&offset, spacing), offset })
    }

    /// The root in f64; infinite where that overflows.
    pub(super) fn approximate_root(&self) -> [f64; 3] {
        self.root.each_ref().map(|c| round_rational(c, Precision::F64).unwrap_or(f64::INFINITY))
    }

    fn sign_at(&self, offset: &[Number; 3], spacing: f64) -> Option<Sign> {
        let beyond: Vec<BigRational> = offset.iter().zip(&self.root).map(|(o, r)| o.to_rational() - r).collect();
        let others_fit = (0..3).all(|i| i == self.axis || beyond[i].is_zero());
        let along = &beyond[self.axis];
        let small = Number::from_f64(spacing * power_of_two(-20)).ok()?.to_rational();
        let certain = if others_fit {
            self.exact || *along > small || -along > small
        } else {
            // Rounding the other coordinates moves them by half a step at most; four along a steep axis outdo that.
            let four = Number::from_f64(4.0 * spacing).ok()?.to_rational();
            *along > four || -along > four
        };
        let certain = certain && round_rational(along, Precision::F64)?.abs() < self.reach;
        let sign = rockproof_model::ring::ExactRing::sign(along);
        certain.then_some(if self.rising { sign } else { sign.reversed() })
    }
}

/// The largest magnitude among the pair's coordinates (m).
pub(crate) fn magnitude(a: &Block, b: &Block) -> f64 {
    a.coordinates().chain(b.coordinates()).fold(0.0f64, |m, c| m.max(c.approximate().abs()))
}
