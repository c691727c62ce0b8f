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
        "a block in, on or through the notch of a concave one, in its chamfered corner, or over a concave face level with an edge of it"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &ContactKind::ALL
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut kit = Kit::new(rng);
        let a = kit.concave(16, 48);
        let size = 2 * kit.denominator();
        let concave = kit.chance(25);
        let (a, b) = match kit.below(6) {
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
            3 => level_with_an_edge(&mut kit, &a),
            4 => into_a_chain(&mut kit),
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

/// A block with a tip over a concave face of `a`, its foot on the line of one of the face's edges, mostly beyond an end.
/// Whether it is inside is then for the other edges to say.
fn level_with_an_edge(kit: &mut Kit<'_>, a: &Solid) -> (Solid, Solid) {
    let shape = a.shape();
    let faces = 0..shape.topology().faces().len() as u32;
    let concave: Vec<u32> = faces.filter(|&f| !shape.face_is_convex(f)).collect();
    let loop_ = &shape.topology().faces()[*kit.pick(&concave) as usize];
    let at = |k: usize| a.points()[loop_[k % loop_.len()] as usize];
    // Every concave face of the catalogue is square to an axis, at an end of the block.
    let axis = (0..3).find(|&i| (0..loop_.len()).all(|k| at(k)[i] == at(0)[i])).unwrap_or(2);
    let out = if at(0)[axis] == a.extent(axis).1 { 1 } else { -1 };
    let count = loop_.len();
    let (mut k, mut step) = (kit.below(count as u64) as usize, kit.between(-24, 40));
    if kit.chance(60) {
        // Beyond a reflex corner the line of an edge runs on inside the face.
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let turn = |k: usize| {
            let ([p, q], r) = ([at(k + count - 1), at(k)], at(k + 1));
            (q[i] - p[i]) * (r[j] - q[j]) - (q[j] - p[j]) * (r[i] - q[i])
        };
        let reflex: Vec<usize> = (0..count).filter(|&k| turn(k) * out < 0).collect();
        let (corner, beyond) = (*kit.pick(&reflex), kit.between(1, 12));
        (k, step) = if kit.chance(50) { (corner, -beyond) } else { (corner + count - 1, 16 + beyond) };
    }
    let foot = [0, 1, 2].map(|i| 2 * (16 * at(k)[i] + step * (at(k + 1)[i] - at(k)[i])));
    let b = kit.convex(4, 24);
    let b = if kit.chance(60) { kit.turned(&b) } else { kit.cube_turned(&b) };
    let mut down = [0; 3];
    down[axis] = -out;
    let tip = b.points()[b.furthest(down)].map(|c| 2 * c);
    let mut offset = [0; 3];
    offset[axis] = out * kit.gap(2 * kit.denominator());
    kit.point_to_point((&a.refined(16), foot), (&b, tip), offset)
}

/// A corner of a block pushed into the chamfer of a concave one: below the planes of three or four faces that follow
/// each other over convex edges.
fn into_a_chain(kit: &mut Kit<'_>) -> (Solid, Solid) {
    let name = *kit.pick(&["chamfered L", "chamfered L", "rounded L"]);
    let side = kit.length(8, 32);
    let sides = if kit.chance(60) { [side, side, kit.length(16, 48)] } else { kit.lengths(8, 32) };
    let a = kit.shape(name, sides);
    let b = match kit.below(3) {
        0 => kit.cuboid(8, 24),
        1 => {
            let equal = [kit.length(8, 24); 3];
            kit.shape("tetrahedron", equal)
        }
        _ => kit.convex(8, 24),
    };
    // The corner that points towards +x and +y, the chamfer's inside.
    let b = if kit.chance(40) { kit.turned_flat(&b) } else { b };
    // The corner furthest inwards from the chamfer.
    let tip = b.points()[b.furthest([8, 8, kit.between(-3, 3)])].map(|c| 2 * c);
    // In sixteenths of the template's units: from (1, 1), on the chamfer, to inside the block, at some height.
    let inward = 16 + kit.between(0, 24);
    let place = [inward, inward, 8 * kit.between(2, 14)];
    let target = [0, 1, 2].map(|i| 2 * place[i] * sides[i]);
    let offset = kit.small_vector(kit.denominator() / 2);
    kit.point_to_point((&a.refined(16), target), (&b, tip), offset)
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
