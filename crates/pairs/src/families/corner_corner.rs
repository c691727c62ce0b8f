//! A corner of a block near a corner of another.

use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use crate::shapes::LatticeSolid;
use rockproof_model::{Block, ContactKind};

pub(super) const CORNER_CORNER: Drawn = Drawn {
    name: "corner_corner",
    about: "two convex corners a small exact vector apart: equal, along an axis, of whole Pythagorean length, or any",
    reaches: &[ContactKind::VertexVertex, ContactKind::VertexEdge, ContactKind::EdgeVertex],
    style: MotionStyle::Turning,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let diagonal = sampler.chance(20);
    let (mut a, mut b) = if diagonal {
        (on_diagonals(sampler), on_diagonals(sampler))
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

/// A block whose edges or normals run along the diagonals of cubes: sines between those are exactly a half.
fn on_diagonals(sampler: &mut PairSampler<'_>) -> LatticeSolid {
    let name = *sampler.pick(&["rhombus", "rhombus", "regular tetrahedron", "cuboctahedron"]);
    let sides = [sampler.length(8, 40); 3];
    sampler.shape(name, sides)
}
