//! The polynomials whose signs decide everything in SPEC section 4, each written once.
//!
//! `value` is evaluated in f64, in error bounds, in balls and in integers; the integer value has the sign of the exact
//! one because every polynomial is homogeneous in length. A vertex is `(side, number)`; an edge or face lies on the
//! side its field says.

mod cone;
mod exit;
mod gap;
mod near;
mod region;
mod wedge;

pub(crate) use cone::*;
pub(crate) use exit::*;
pub(crate) use gap::*;
pub(crate) use near::*;
pub(crate) use region::*;
pub(crate) use wedge::*;

use crate::pair::Pair;
use crate::sign_cascade::Parts;
use crate::view::{Scales, View};
use rockproof_model::decision::Side;
use rockproof_model::tolerance::LAMBDA_INVERSE;
use rockproof_model::{EdgeId, Entrance, EntranceKind, FaceId, Ring, ToleranceSet, Vec3, VertexId};

/// A vertex of one of the blocks.
pub(crate) type Vertex = (Side, VertexId);
/// An edge of one of the blocks.
pub(crate) type Edge = (Side, EdgeId);
/// A face of one of the blocks.
pub(crate) type Face = (Side, FaceId);

/// A polynomial in the coordinates and tolerances.
pub(crate) trait Polynomial {
    /// Where its static bounds are kept: one slot for each variant, all polynomials in a row.
    const FIRST_SLOT: usize;
    /// How many sets of magnitudes it can draw on: sides, limits, kinds of entrance.
    const VARIANTS: usize;
    /// Degree in length: coordinates and length tolerances doubled make the value `2^DEGREE` times as large.
    const DEGREE: usize;
    /// Whether it is made of vectors within one block or the other alone: then how far the blocks are apart does not make it less sure.
    const WITHIN_BLOCKS: bool = false;
    /// Whether balls are asked: not where they hardly ever tell more than what is asked before.
    const IN_BALLS: bool = true;
    /// Whether it compares planes, which are asked before balls of two f64 ([`Polynomial::value_of_planes`]).
    const IN_PLANES: bool = false;
    /// Whether balls of two f64 are asked before integers: where values near zero are near-ties more often than ties, and integers long.
    const IN_DOUBLE: bool = false;
    /// What the value in lattice units is multiplied by besides, since tolerances are integers over a denominator there.
    const DENOMINATOR: Denominator = Denominator::None;
    /// Which of the sets this one draws on, below `VARIANTS`.
    fn variant(&self) -> usize;
    /// The value; only its sign means anything.
    fn value<V: View>(&self, view: &V) -> V::T;
    /// An edge of A and one of B whose being parallel makes the value zero under these tolerances, if there are any.
    fn zero_where_parallel(&self, _tolerances: &ToleranceSet) -> Option<(EdgeId, EdgeId)> {
        None
    }
    /// The product of an edge and a normal that tells this sign, if there is one.
    fn as_edge_along_normal(&self, _pair: &Pair<'_>) -> Option<AsEdgeAlongNormal> {
        None
    }
    /// What proves the value to be zero with fewer digits, if anything may.
    fn ties_with(&self, _tolerances: &ToleranceSet) -> Option<EqualGaps> {
        None
    }
    /// The value from the planes that it compares, as [`plane`] has them; `None` where it compares none.
    fn value_of_planes<T: Ring>(&self, _plane: impl Fn(&Entrance) -> (T, T), _scales: &Scales<T>) -> Option<T> {
        None
    }
    /// What the value in f64 is off by at most, from the sizes that its parts have; `None` where these tell no more than a bound known beforehand.
    fn error_by_parts(&self, _parts: &Parts<'_, '_, '_>) -> Option<f64> {
        None
    }
}

/// A power of a denominator of tolerances ([`crate::view::Scales`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Denominator {
    None,
    Unit,
    UnitSquared,
    OneSquared,
    WholeSquared,
}

/// Number of slots of polynomials by whose signs something is decided.
pub(crate) const SIGN_SLOTS: usize = after::<EdgeAlongNormal>();

/// Number of slots for static bounds: with those of parts.
pub(crate) const SLOTS: usize = after::<CornerHeight>();

/// The largest degree of all.
pub(crate) const LARGEST_DEGREE: usize = WedgeDipDepth::DEGREE;

const fn after<P: Polynomial>() -> usize {
    P::FIRST_SLOT + P::VARIANTS
}

/// A length tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LengthTolerance {
    Search,
    Territory,
    Penetration,
}

impl LengthTolerance {
    /// The tolerance in a view's number type.
    #[inline(always)]
    pub(crate) fn of<V: View>(self, view: &V) -> V::T {
        match self {
            LengthTolerance::Search => view.scales().search.clone(),
            LengthTolerance::Territory => view.scales().territory.clone(),
            LengthTolerance::Penetration => view.scales().penetration.clone(),
        }
    }
}

/// A true exit dips by no more than r over this (SPEC section 4).
const TRUE_EXIT_INVERSE: i32 = 10;

/// How far features may dip below a plane and pass a no-overlap check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DipLimit {
    /// g: the plane passes.
    Penetration,
    /// r/10: the plane is a true exit.
    TrueExit,
}

impl DipLimit {
    /// The square of the limit over the square of the unit it is counted in.
    #[inline(always)]
    fn squared<T: Ring>(self, scales: &Scales<T>) -> (T, T) {
        match self {
            DipLimit::Penetration => (scales.penetration.squared(), scales.unit.squared()),
            DipLimit::TrueExit => {
                let tenths = scales.unit.times(&T::from_i32(TRUE_EXIT_INVERSE));
                (scales.territory.squared(), tenths.squared())
            }
        }
    }
}

#[inline(always)]
fn side_of(side: Side) -> usize {
    match side {
        Side::A => 0,
        Side::B => 1,
    }
}

#[inline(always)]
fn start<V: View>(view: &V, edge: Edge) -> Vertex {
    (edge.0, view.ends(edge.0, edge.1).0)
}

#[inline(always)]
fn end<V: View>(view: &V, edge: Edge) -> Vertex {
    (edge.0, view.ends(edge.0, edge.1).1)
}

/// The direction of an edge away from one of its ends.
#[inline(always)]
fn away<V: View>(view: &V, edge: Edge, from: VertexId) -> Vec3<V::T> {
    let d = view.direction(edge.0, edge.1);
    if view.ends(edge.0, edge.1).0 == from { d } else { d.negated() }
}

#[inline(always)]
fn lambda_squared_inverse<V: View>() -> V::T {
    V::T::from_i32(LAMBDA_INVERSE * LAMBDA_INVERSE)
}

#[inline(always)]
pub(crate) fn across<V: View>(view: &V, edge_a: EdgeId, edge_b: EdgeId) -> Vec3<V::T> {
    view.direction(Side::A, edge_a).cross(&view.direction(Side::B, edge_b))
}

#[inline(always)]
fn kind_of(entrance: &Entrance) -> usize {
    entrance.kind() as usize
}
