//! Signs of `d·N` of edges of one block and faces of the other that are known: they depend on no tolerance, so they serve all classifications of a pair.

use crate::predicate::{Edge, Face};
use rockproof_model::Sign;
use rockproof_model::decision::Side;
use std::cell::{Cell, OnceCell};

/// By the side of the edge, then by edge and face of the other block.
#[derive(Default)]
pub(crate) struct EdgeProducts([OnceCell<Box<[Cell<u8>]>>; 2]);

/// Of more products than this nothing is remembered: their table would take longer to clear than they.
const LARGEST: usize = 1 << 14;
/// Not yet known; else one more than three times the level that decided it, and 0, 1 or 2 for the sign.
const UNKNOWN: u8 = 0;

impl EdgeProducts {
    /// Where the sign of an edge's product with the normal of a face of the other block is kept, of so many edges and faces; `None` where none is.
    #[inline]
    pub(crate) fn of(&self, edge: Edge, face: Face, edges: usize, faces: usize) -> Option<&Cell<u8>> {
        if edge.0 == face.0 || edges * faces > LARGEST {
            return None;
        }
        let table = self.0[usize::from(edge.0 == Side::B)]
            .get_or_init(|| vec![Cell::new(UNKNOWN); edges * faces].into_boxed_slice());
        table.get(edge.1.index() * faces + face.1.index())
    }
}

/// What is remembered of a sign that this level decided, the levels counted from the cheapest.
pub(crate) fn remembered(sign: Sign, level: usize) -> u8 {
    1 + 3 * level as u8 + (sign.as_i8() + 1) as u8
}

/// The sign and the level that decided it, if they are known.
#[inline]
pub(crate) fn recalled(known: u8) -> Option<(Sign, usize)> {
    let known = known.checked_sub(1)?;
    Some((Sign::of_ordering((known % 3).cmp(&1)), usize::from(known / 3)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{EdgeId, FaceId};

    #[test]
    fn each_product_has_a_place_of_its_own() {
        let products = EdgeProducts::default();
        let (edges, faces) = (5, 3);
        let all = || {
            let sides = [(Side::A, Side::B), (Side::B, Side::A)].into_iter();
            sides.flat_map(|(e, f)| (0..5).flat_map(move |k| (0..3).map(move |j| ((e, EdgeId(k)), (f, FaceId(j))))))
        };
        for (number, (edge, face)) in all().enumerate() {
            let place = products.of(edge, face, edges, faces).expect("a small table");
            assert_eq!(recalled(place.get()), None, "{edge:?}, {face:?}");
            place.set(number as u8 + 1);
        }
        for (number, (edge, face)) in all().enumerate() {
            assert_eq!(products.of(edge, face, edges, faces).map(Cell::get), Some(number as u8 + 1));
        }
        assert!(products.of((Side::A, EdgeId(0)), (Side::A, FaceId(0)), edges, faces).is_none(), "one block");
        assert!(products.of((Side::A, EdgeId(0)), (Side::B, FaceId(0)), LARGEST + 1, 1).is_none(), "too many");
    }

    #[test]
    fn signs_and_levels_are_recalled() {
        for sign in [Sign::Negative, Sign::Zero, Sign::Positive] {
            for level in 0..7 {
                assert_eq!(recalled(remembered(sign, level)), Some((sign, level)));
            }
        }
    }
}
