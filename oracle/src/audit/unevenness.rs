//! Whether an overlap is no more than uneven faces make of blocks whose planes touch.
//!
//! A face's vertices are off its plane by up to u, because their coordinates were rounded, and contacts ask for planes. So two blocks can overlap by
//! some u where no contact tells of it, at that face: one out of the other block's reach explains nothing.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rockproof_model::block::face_normal;
use rockproof_model::lattice::Lattice;
use rockproof_model::{Block, FaceId, Vec3, VertexId};

/// A face whose vertices do not lie in one plane.
pub(super) struct UnevenFace {
    face: FaceId,
    /// The square of the greatest distance of a vertex from the plane, in m².
    square: BigRational,
}

/// The uneven faces of a block, the most uneven first. Faces without an area have no plane.
pub(super) fn uneven_faces(block: &Block) -> Vec<UnevenFace> {
    let lattice = Lattice::covering(block.coordinates());
    let points: Vec<Vec3<BigInt>> = block.vertices().iter().map(|v| v.map(|c| lattice.units(c))).collect();
    let (units, metres) = lattice.units_per_metre();
    let uneven = |(number, face): (usize, &Vec<VertexId>)| {
        if face.len() == 3 {
            return None;
        }
        let n = face_normal(&points, face);
        // k times the distances times |N|, the plane being that through the mean of the k vertices.
        let k = BigInt::from(face.len());
        let sum = face.iter().fold(Vec3::zero(), |sum: Vec3<BigInt>, &v| sum.plus(&points[v.index()]));
        let middle = n.dot(&sum);
        let off = face.iter().map(|&v| (&k * n.dot(&points[v.index()]) - &middle).abs()).max().unwrap_or_default();
        let length = n.norm_squared();
        if Zero::is_zero(&length) || Zero::is_zero(&off) {
            return None;
        }
        let (off, scale) = (off * &metres, k * &units);
        Some(UnevenFace { face: FaceId::at(number), square: BigRational::new(&off * &off, length * &scale * &scale) })
    };
    let mut faces: Vec<UnevenFace> = block.topology().faces().iter().enumerate().filter_map(uneven).collect();
    faces.sort_by(|one, two| two.square.cmp(&one.square));
    faces
}

/// Whether an overlap of two blocks, as deep as the root of `square`, is no deeper than twice the unevenness of some face of either, **a tie
/// included**, that is in the reach of the other block: their boxes share a point.
pub(super) fn explains(blocks: [&Block; 2], faces: [&[UnevenFace]; 2], square: &BigRational) -> bool {
    let four = BigRational::from_integer(4.into());
    (0..2).any(|k| {
        let uneven_enough = faces[k].iter().take_while(|uneven| *square <= &four * &uneven.square);
        let mut corners = uneven_enough.map(|uneven| blocks[k].topology().face(uneven.face));
        corners.any(|corners| meets_box(blocks[k], corners, blocks[1 - k]))
    })
}

/// Whether the box of a face shares a point with that of another block, **touching included**.
fn meets_box(own: &Block, corners: &[VertexId], other: &Block) -> bool {
    let bounds = other.bounds();
    let ends = bounds.min.components().into_iter().zip(bounds.max.components());
    ends.enumerate().all(|(axis, (low, high))| {
        let along = || corners.iter().map(|v| own.vertices()[v.index()].components()[axis]);
        along().any(|c| c <= *high) && along().any(|c| c >= *low)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prepared_block::tests::bent_box;
    use rockproof_model::Number;

    #[test]
    fn unevenness_is_the_greatest_distance_from_a_face_s_own_plane() {
        // N of the top is (−3, −3, 18), its corners' n·p are 54 and 45 by turns, so 9/2 from their mean: (9/2)² / 342.
        let expected = BigRational::new(9.into(), 152.into());
        for (scale, square) in [("1", (1, 1)), ("1/7", (1, 49)), ("3/8", (9, 64)), ("5", (25, 1)), ("2", (4, 1))] {
            let square = BigRational::new(square.0.into(), square.1.into());
            let scale = Number::from_rational(scale.parse().expect("a fraction"));
            let faces = uneven_faces(&bent_box(&scale));
            // A corner raised along its sides leaves these plane.
            assert_eq!(faces.iter().map(|uneven| uneven.face).collect::<Vec<_>>(), [FaceId(1)]);
            assert_eq!(faces[0].square, &expected * square);
        }
    }
}
