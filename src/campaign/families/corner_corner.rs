//! A corner of a block near a corner of another.

use super::{Family, Kit};
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind};

#[derive(Debug)]
pub(super) struct CornerCorner;

impl Family for CornerCorner {
    fn name(&self) -> &'static str {
        "corner_corner"
    }

    fn describe(&self) -> &'static str {
        "two convex corners a small exact vector apart: equal, along an axis, of whole Pythagorean length, or any"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &[ContactKind::VertexVertex, ContactKind::VertexEdge, ContactKind::EdgeVertex]
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut kit = Kit::new(rng);
        let mut a = kit.convex(8, 40);
        let mut b = kit.convex(8, 40);
        if kit.chance(25) {
            a = kit.turned(&a);
        }
        if kit.chance(35) {
            b = kit.turned(&b);
        } else {
            b = kit.cube_turned(&b);
        }
        let out = kit.direction();
        let (va, vb) = (a.furthest(out), b.furthest(out.map(|c| -c)));
        let offset = kit.small_vector(2 * kit.denominator());
        let (a, b) = kit.vertex_to_vertex((&a, va), (&b, vb), offset);
        kit.finish(a, b)
    }
}
