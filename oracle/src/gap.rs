//! The gap of an entrance, as exact as anyone wants it.

use crate::pair::Pair;
use crate::predicate::{Orientation, Polynomial, plane};
use crate::view::{ExactView, LazyScales, Scales};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Entrance, Sign};
use std::cell::OnceCell;

/// The gap h of an entrance plane: positive apart, negative overlapping.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gap {
    /// The sign of h.
    pub sign: Sign,
    /// h² in m², exactly.
    pub squared: BigRational,
}

impl Pair<'_> {
    /// The gap of an entrance (SPEC section 4, "gap"). A plane without area counts as touching.
    pub fn gap(&self, entrance: &Entrance) -> Gap {
        let geometry = self.heap();
        // No tolerance enters a gap.
        let no_scales = LazyScales { made: &OnceCell::new(), make: &Scales::none };
        let view = ExactView { geometry, scales: no_scales };
        let (p, q) = plane(&view, entrance);
        let mut sign = ExactRing::sign(&p);
        if let Entrance::EdgeEdge(edge_a, edge_b) = *entrance
            && ExactRing::sign(&Orientation { edge_a, edge_b }.value(&view)).is_negative()
        {
            sign = sign.reversed();
        }
        if q.is_zero() {
            return Gap { sign: Sign::Zero, squared: BigRational::zero() };
        }
        let (units, metres) = self.grid().lattice.units_per_metre();
        let numerator: BigInt = &p * &p * &metres * &metres;
        Gap { sign, squared: BigRational::new(numerator, q * &units * &units) }
    }
}
