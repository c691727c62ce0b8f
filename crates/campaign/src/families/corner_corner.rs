//! A corner of a block near a corner of another.

use super::{Family, PairSampler};
use crate::shapes::LatticeSolid;
use crate::steps::MotionStyle;
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

    fn motion_style(&self) -> MotionStyle {
        MotionStyle::Turning
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut sampler = PairSampler::new(rng);
        let diagonal = sampler.chance(20);
        let (mut a, mut b) = if diagonal {
            (on_diagonals(&mut sampler), on_diagonals(&mut sampler))
        } else {
            (sampler.convex(8, 40), sampler.convex(8, 40))
        };
        if !diagonal && sampler.chance(25) {
            a = sampler.turned(&a);
        }
        if !diagonal && sampler.chance(35) {
            b = sampler.turned(&b);
        } else {
            b = sampler.cube_turned(&b);
            if sampler.chance(40) {
                b = sampler.tipped(&b);
            }
        }
        let out = sampler.direction();
        let (va, vb) = (a.furthest(out), b.furthest(out.map(|c| -c)));
        let offset = sampler.small_vector(2 * sampler.denominator());
        let (a, b) = sampler.vertex_to_vertex((&a, va), (&b, vb), offset);
        sampler.finish(a, b)
    }
}

/// A block whose edges or normals run along the diagonals of cubes: sines between those are exactly a half.
fn on_diagonals(sampler: &mut PairSampler<'_>) -> LatticeSolid {
    let name = *sampler.pick(&["rhombus", "rhombus", "regular tetrahedron", "cuboctahedron"]);
    let sides = [sampler.length(8, 40); 3];
    sampler.shape(name, sides)
}
