//! Blocks in the notches of others.

use super::{Family, Kit};
use crate::shapes::Solid;
use crate::shapes::solid::Units;
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind};

#[derive(Debug)]
pub(super) struct ConcaveNotch;

impl Family for ConcaveNotch {
    fn name(&self) -> &'static str {
        "concave_notch"
    }

    fn describe(&self) -> &'static str {
        "a block in, on or through the notch of a concave one, fitting exactly, loosely or overlapping"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &ContactKind::ALL
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut kit = Kit::new(rng);
        let a = kit.concave(16, 48);
        let size = 2 * kit.denominator();
        let concave = kit.chance(25);
        let (a, b) = match kit.below(4) {
            0 | 1 => {
                // A box whose corner goes into an inner corner, at a reflex edge's end or middle.
                let b = if concave { kit.concave(8, 32) } else { kit.cuboid(4, 24) };
                let b = if kit.chance(25) { kit.turned(&b) } else { kit.cube_turned(&b) };
                let at = reflex_point(&mut kit, &a);
                let vb = kit.below(b.points().len() as u64) as usize;
                let tip = b.points()[vb].map(|c| 2 * c);
                let offset = kit.small_vector(size);
                kit.point_to_point((&a, at), (&b, tip), offset)
            }
            2 => {
                let b = if concave { kit.concave(8, 32) } else { kit.convex(8, 32) };
                let b = kit.cube_turned(&b);
                let out = kit.direction();
                let (va, vb) = (a.furthest(out), b.furthest(out.map(|c| -c)));
                let offset = kit.small_vector(size);
                kit.vertex_to_vertex((&a, va), (&b, vb), offset)
            }
            _ => {
                // On top of the notched outline, shifted.
                let b = if concave { kit.concave(8, 32) } else { kit.convex(8, 32) };
                let (top, sole) = (a.furthest([-1, -2, 64]), b.furthest([-1, -2, -64]));
                let offset = [kit.length(0, 16), kit.length(0, 16), kit.gap(size)];
                kit.vertex_to_vertex((&a, top), (&b, sole), offset)
            }
        };
        kit.finish(a, b)
    }
}

/// Twice a point on a reflex edge: an end, or the middle.
fn reflex_point(kit: &mut Kit<'_>, solid: &Solid) -> Units {
    let edges = solid.shape().topology().edges();
    let reflex: Vec<_> =
        (0..edges.len()).filter(|&e| !solid.shape().edge_is_convex(e as u32)).map(|e| edges[e]).collect();
    let edge = kit.pick(&reflex);
    let (p, q) = (solid.points()[edge.p as usize], solid.points()[edge.q as usize]);
    match kit.below(3) {
        0 => p.map(|c| 2 * c),
        1 => q.map(|c| 2 * c),
        _ => [0, 1, 2].map(|i| p[i] + q[i]),
    }
}
