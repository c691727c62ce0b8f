//! Wedges of a few degrees.

use super::edge_cross::{crossing, middle};
use super::{Family, Kit};
use crate::shapes::Solid;
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind};

#[derive(Debug)]
pub(super) struct SharpWedge;

impl Family for SharpWedge {
    fn name(&self) -> &'static str {
        "sharp_wedge"
    }

    fn describe(&self) -> &'static str {
        "a wedge of some degrees, lying on, entering, pointing at or flat across another wedge or block"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &[ContactKind::VertexVertex, ContactKind::VertexFace, ContactKind::FaceVertex]
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut kit = Kit::new(rng);
        if kit.chance(15) {
            return blades(&mut kit);
        }
        let a = sharp(&mut kit);
        let other = if kit.chance(60) { sharp(&mut kit) } else { kit.convex(16, 64) };
        let b = kit.cube_turned(&other);
        let b = if kit.chance(30) { kit.turned_flat(&b) } else { b };
        let size = 2 * kit.denominator();
        // The tip of the wedge against a vertex, or its sole against whatever of B comes first.
        let (a, b) = if kit.chance(50) {
            let tips: Vec<usize> = (0..a.points().len()).filter(|&v| a.points()[v][0] == 0).collect();
            let tip = *kit.pick(&tips);
            let vb = kit.below(b.points().len() as u64) as usize;
            let offset = kit.small_vector(size);
            kit.vertex_to_vertex((&a, tip), (&b, vb), offset)
        } else {
            let vb = b.furthest([kit.between(-1, 1), kit.between(-1, 1), 4]);
            let sole = a.furthest([1, 1, -16]);
            let offset = [-kit.length(0, 40), -kit.length(0, 8), -kit.gap(size)];
            kit.vertex_to_vertex((&a, sole), (&b, vb), offset)
        };
        kit.finish(a, b)
    }
}

/// Two blades that lie flat, one's edge across the other's. Each opens to both sides of its edge alike, so neither leans
/// more to one side of the plane of both edges than the other: σ ties.
fn blades(kit: &mut Kit<'_>) -> (Block, Block) {
    let (a, b) = (blade(kit), blade(kit).mapped(&[[0, -1, 0], [1, 0, 0], [0, 0, 1]], 1));
    let (edge_a, edge_b) = (middle(&a, 0, a.extent(0).0), middle(&b, 1, b.extent(1).0));
    let (a, b) = crossing(kit, (&a, edge_a), (&b, edge_b));
    kit.finish(a, b)
}

/// A blade with its edge along y, that opens along x as `sharp` does.
fn blade(kit: &mut Kit<'_>) -> Solid {
    let length = kit.length(32, 64);
    let thickness = (length / kit.between(12, 100)).max(8);
    let width = kit.length(16, 48);
    kit.shape("ridge", [width, thickness, length]).mapped(&[[0, 0, -1], [1, 0, 0], [0, -1, 0]], 1)
}

/// A wedge or point along x, its tip at x = 0 and its thickness a twelfth to a hundredth of its length.
fn sharp(kit: &mut Kit<'_>) -> Solid {
    let length = kit.length(32, 64);
    let thickness = (length / kit.between(12, 100)).max(8);
    let width = kit.length(16, 48);
    match kit.below(3) {
        0 => kit
            .shape("tetrahedron", [thickness, width, length])
            .mapped(&[[0, 0, -1], [0, 1, 0], [1, 0, 0]], 1)
            .moved([0; 3]),
        1 => kit.shape("pyramid", [width, thickness, length]).mapped(&[[0, 0, -1], [1, 0, 0], [0, -1, 0]], 1),
        _ => kit.shape("wedge", [length, width, thickness]),
    }
}
