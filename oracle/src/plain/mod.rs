//! The plain path: SPEC section 4 word for word, in exact rationals.
//!
//! No filter, no scaling to integers, no culling beyond the rough phase: vectors are not normalised, and every
//! comparison is made through squares and signs as the formulas of SPEC stand. It is here to be compared with, not to be
//! fast; it shares no predicate with the fast path.
//!
//! **Degenerate rounded blocks.** Rounding can make an edge zero long or a face's normal zero. Both keep defined
//! answers: the gap of a plane with zero normal is 0; nothing projects strictly inside its face; no foot lies strictly
//! inside an edge of length zero, whose line has distance 0 from every point (`width`), and which is nearly parallel to
//! every edge.
//!
//! **Ties.** Beside each decision the trace says whether it hung on an exact tie: whether the deciding value (the
//! smallest of the values that must all pass, the largest of those of which one must) was exactly zero.

mod classify;
mod edge_edge;
mod entrance;
mod exit;
mod pair;
mod predicate_answer;
mod rational_block;
mod territory;
mod vector;
mod vertex_edge;
mod vertex_face;
mod vertex_vertex;

use crate::rational::Rational;
use rockproof_model::decision::Decision;
use rockproof_model::{Block, Contact, ContactKey, Sign, ToleranceSet};

/// A contact and its exact gap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExactContact<Q> {
    /// The contact; the sign of its gap is `contact.gap`.
    pub contact: Contact,
    /// The square of the gap of the contact's entrance, in m².
    pub gap_squared: Q,
}

impl<Q: Rational> ExactContact<Q> {
    /// The gap in metres, positive apart, rounded to the nearest f64; `None` when it overflows.
    pub fn gap_m(&self) -> Option<f64> {
        let magnitude = self.gap_squared.sqrt_rounded()?;
        Some(if self.contact.gap == Sign::Negative { -magnitude } else { magnitude })
    }
}

/// A decision, its outcome (as described at [`Decision`]), and whether it hung on an exact tie.
pub type TracedDecision = (Decision, i8, bool);

/// The contacts of a pair of blocks, sorted by kind and features (SPEC section 4, "Result").
///
/// Coordinates and tolerances are taken as they are given: to see what an engine with rounded input should answer, pass
/// [`Block::rounded`] and [`ToleranceSet::rounded`].
///
/// ```
/// # use rockproof_model::{Block, BlockOptions, Number, Sign, ToleranceSet, Vec3};
/// # fn tetrahedron(apex: i32, base: i32) -> Block {
/// #     let at = |x, y, z| Vec3::new(Number::from_integer(x), Number::from_integer(y), Number::from_integer(z));
/// #     let base_up = base > apex;
/// #     let vertices = vec![at(0, 0, apex), at(6, 0, base), at(-3, 5, base), at(-3, -5, base)];
/// #     let mut faces = vec![vec![0, 1, 2], vec![0, 2, 3], vec![0, 3, 1], vec![1, 3, 2]];
/// #     if base_up { faces.iter_mut().for_each(|f| f.reverse()); }
/// #     Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).unwrap()
/// # }
/// # let tolerances = ToleranceSet {
/// #     search: Number::from_integer(2), penetration: Number::from_integer(1), ..ToleranceSet::ZERO
/// # };
/// use num_rational::BigRational;
/// // One tetrahedron on its tip above another that points up: tip to tip, one metre apart.
/// let (above, below) = (tetrahedron(1, 9), tetrahedron(0, -8));
/// let found = rockproof_oracle::plain::classify::<BigRational>(&above, &below, &tolerances);
/// assert_eq!(found.len(), 1);
/// assert_eq!((found[0].contact.kind().name(), found[0].contact.gap), ("v-v", Sign::Positive));
/// ```
pub fn classify<Q: Rational>(a: &Block, b: &Block, tolerances: &ToleranceSet) -> Vec<ExactContact<Q>> {
    classify_with_kept(a, b, tolerances, &[])
}

/// [`classify`] where the step before left the contacts `kept` of the pair closed, in any order: these may be deeper
/// than g. Every other condition holds for them too.
pub fn classify_with_kept<Q: Rational>(
    a: &Block,
    b: &Block,
    tolerances: &ToleranceSet,
    kept: &[ContactKey],
) -> Vec<ExactContact<Q>> {
    let pair = pair::Pair::new(a, b, tolerances, pair::DecisionLog::off()).with_kept(kept);
    classify::contacts(&pair).into_iter().map(pair::ContactWithPlane::published).collect()
}

/// Every decision that [`classify`] evaluates for the pair, each once, in the order of its first evaluation.
pub fn trace<Q: Rational>(a: &Block, b: &Block, tolerances: &ToleranceSet) -> Vec<TracedDecision> {
    trace_with_kept::<Q>(a, b, tolerances, &[])
}

/// Every decision that [`classify_with_kept`] evaluates, as [`trace`] gives them.
pub fn trace_with_kept<Q: Rational>(
    a: &Block,
    b: &Block,
    tolerances: &ToleranceSet,
    kept: &[ContactKey],
) -> Vec<TracedDecision> {
    let pair = pair::Pair::<Q>::new(a, b, tolerances, pair::DecisionLog::on()).with_kept(kept);
    classify::contacts(&pair);
    pair.into_trace()
}
