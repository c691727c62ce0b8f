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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prepared_block::PreparedBlock;
    use rockproof_model::{Block, EdgeId, Number, Vec3, VertexId};

    /// Lengths twice as large, on a lattice of their own, make gaps twice as large.
    #[test]
    fn gaps_grow_with_the_blocks() {
        for exponent in -4..=4 {
            let scale = 2f64.powi(exponent);
            let at = |c: [f64; 3]| Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_f64(c * scale).unwrap());
            let above = Block::cuboid(&at([0.0, 0.0, 4.0]), &at([2.0, 2.0, 6.0])).unwrap();
            let below = Block::cuboid(&at([0.0, 0.0, 0.0]), &at([2.0, 2.0, 2.0])).unwrap();
            let (above, below) = (PreparedBlock::new(&above), PreparedBlock::new(&below));
            let pair = Pair::new(&above, &below);
            let top = below.block().topology().face_ids().find(|f| below.faces[f.index()].normal.z.0 > 0.0).unwrap();
            let bottom = above.block().topology().face_ids().find(|f| above.faces[f.index()].normal.z.0 < 0.0).unwrap();
            let two = BigRational::from_float(2.0 * scale).unwrap();
            let expected = Gap { sign: Sign::Positive, squared: &two * &two };
            let edge_along = |prepared: &PreparedBlock, axis: usize, z: f64| {
                let found = prepared.edges.iter().position(|e| {
                    let d = [e.direction.x.0, e.direction.y.0, e.direction.z.0];
                    d[axis] != 0.0 && e.bounds[0][2] == z * scale && e.bounds[1][2] == z * scale
                });
                EdgeId::at(found.unwrap())
            };
            let crossing = Entrance::EdgeEdge(edge_along(&above, 0, 4.0), edge_along(&below, 1, 2.0));
            let (lowest, highest): (VertexId, VertexId) = (above.extremes[2].0, below.extremes[2].1);
            let entrances = [
                ("v-f", Entrance::VertexFace(lowest, top)),
                ("f-v", Entrance::FaceVertex(bottom, highest)),
                ("e-e", crossing),
            ];
            for (name, entrance) in entrances {
                assert_eq!(pair.gap(&entrance), expected, "{name}, 2^{exponent}");
            }
        }
    }
}
