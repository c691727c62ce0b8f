//! A corner of a block near a corner of another.

use super::{Family, Kit};
use crate::shapes::Solid;
use crate::steps::Manner;
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

    fn manner(&self) -> Manner {
        Manner::Turning
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut kit = Kit::new(rng);
        let diagonal = kit.chance(20);
        let (mut a, mut b) = if diagonal {
            (on_diagonals(&mut kit), on_diagonals(&mut kit))
        } else {
            (kit.convex(8, 40), kit.convex(8, 40))
        };
        if !diagonal && kit.chance(25) {
            a = kit.turned(&a);
        }
        if !diagonal && kit.chance(35) {
            b = kit.turned(&b);
        } else {
            b = kit.cube_turned(&b);
            if kit.chance(40) {
                b = kit.tipped(&b);
            }
        }
        let out = kit.direction();
        let (va, vb) = (a.furthest(out), b.furthest(out.map(|c| -c)));
        let offset = kit.small_vector(2 * kit.denominator());
        let (a, b) = kit.vertex_to_vertex((&a, va), (&b, vb), offset);
        kit.finish(a, b)
    }
}

/// A block whose edges or normals run along the diagonals of cubes: sines between those are exactly a half.
fn on_diagonals(kit: &mut Kit<'_>) -> Solid {
    let name = *kit.pick(&["rhombus", "rhombus", "regular tetrahedron", "cuboctahedron"]);
    let sides = [kit.length(8, 40); 3];
    kit.shape(name, sides)
}
