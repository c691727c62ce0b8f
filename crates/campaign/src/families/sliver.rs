//! Thin plates, needles and short edges.

use super::{Family, Kit};
use crate::shapes::Solid;
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind};

#[derive(Debug)]
pub(super) struct Sliver;

impl Family for Sliver {
    fn name(&self) -> &'static str {
        "sliver"
    }

    fn describe(&self) -> &'static str {
        "a plate, a needle or a block with a sliver face against another block"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &[ContactKind::VertexFace, ContactKind::FaceVertex, ContactKind::EdgeEdge]
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut kit = Kit::new(rng);
        let thin = thin(&mut kit);
        let a = kit.cube_turned(&thin);
        let a = if kit.chance(25) { kit.turned(&a) } else { a };
        let b = if kit.chance(20) { self::thin(&mut kit) } else { kit.convex(8, 48) };
        let (va, vb) = if kit.chance(50) {
            let out = kit.direction();
            (a.furthest(out), b.furthest(out.map(|c| -c)))
        } else {
            (a.furthest([1, 2, 4]), b.furthest([1, 2, -4]))
        };
        let size = 2 * kit.denominator();
        let offset = if kit.chance(50) {
            kit.small_vector(size)
        } else {
            [-kit.length(0, 16), -kit.length(0, 16), kit.gap(size)]
        };
        let (a, b) = kit.vertex_to_vertex((&a, va), (&b, vb), offset);
        kit.finish(a, b)
    }
}

fn thin(kit: &mut Kit<'_>) -> Solid {
    let [x, y, z] = kit.lengths(16, 48);
    let thin = (z / (1 << kit.between(4, 9))).max(8);
    match kit.below(6) {
        0 => kit.shape("cuboid", [x, thin, thin]),
        1 => kit.shape("tetrahedron", [x, y, thin]),
        2 => kit.shape("hexagon", [x, thin, y]),
        3 => kit.shape("trapezoid", [x, thin, z]),
        4 => kit.shape("cut corner", [x, y, thin]),
        _ => kit.shape("cuboid", [x, y, thin]),
    }
}
