//! Blocks side by side with faces in one plane.

use super::{Family, Kit};
use crate::steps::Manner;
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind};

#[derive(Debug)]
pub(super) struct CoplanarSlide;

impl Family for CoplanarSlide {
    fn name(&self) -> &'static str {
        "coplanar_slide"
    }

    fn describe(&self) -> &'static str {
        "blocks that share one, two or three planes exactly, one slid along the other to, near and past its edges"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &ContactKind::ALL
    }

    fn manner(&self) -> Manner {
        Manner::Sliding
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut kit = Kit::new(rng);
        let sides = kit.lengths(8, 48);
        // Often sides in common, so that edges and corners coincide as well.
        let [mut u, mut v, w] = kit.lengths(8, 48);
        if kit.chance(50) {
            u = sides[0];
        }
        if kit.chance(50) {
            v = sides[1];
        }
        let prisms = ["cuboid", "cuboid", "cuboid", "cuboid", "hexagon", "rhombus", "trapezoid"];
        let shape = *kit.pick(&prisms);
        let a = kit.shape(shape, sides);
        let shape = if kit.chance(70) { shape } else { *kit.pick(&prisms) };
        let b = kit.shape(shape, [u, v, w]);
        let unit = a.denominator() / kit.denominator();
        let size = 2 * kit.denominator();
        // On top; then each way: flush on either side, slid by a share of the block, or by about a tolerance.
        let mut offset = [0, 0, sides[2]];
        if kit.chance(30) {
            offset[2] += kit.gap(size);
        }
        for axis in 0..2 {
            let far = sides[axis] - if axis == 0 { u } else { v };
            offset[axis] = match kit.below(6) {
                0 | 1 => 0,
                2 => far,
                3 => kit.gap(size),
                4 => sides[axis],
                _ => kit.between(0, sides[axis]),
            };
        }
        kit.finish(a, b.moved(offset.map(|c| c * unit)))
    }
}
