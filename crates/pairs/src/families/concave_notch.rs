//! Blocks in the notches of others.

use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use crate::shapes::LatticeSolid;
use crate::shapes::lattice_solid::Units;
use rockproof_model::{Block, ContactKind, FaceId};

pub(super) const CONCAVE_NOTCH: Drawn = Drawn {
    name: "concave_notch",
    about: "a block in, on or through the notch of a concave one, in its chamfered corner, or over a concave face level with an edge of it",
    reaches: &ContactKind::ALL,
    style: MotionStyle::Any,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let a = sampler.concave(16, 48);
    let size = 2 * sampler.denominator();
    let concave = sampler.chance(25);
    let (a, b) = match sampler.below(6) {
        0 | 1 => {
            // A box whose corner goes into an inner corner, at a reflex edge's end or middle.
            let b = if concave { sampler.concave(8, 32) } else { sampler.cuboid(4, 24) };
            let b = if sampler.chance(25) { sampler.turned(&b) } else { sampler.cube_turned(&b) };
            let at = reflex_point(sampler, &a);
            let vb = sampler.below(b.points().len() as u64) as usize;
            let tip = b.points()[vb].map(|c| 2 * c);
            let offset = sampler.small_vector(size);
            sampler.point_to_point((&a, at), (&b, tip), offset)
        }
        2 => {
            let b = if concave { sampler.concave(8, 32) } else { sampler.convex(8, 32) };
            let b = sampler.cube_turned(&b);
            let out = sampler.direction();
            let (va, vb) = (a.furthest(out), b.furthest(out.map(|c| -c)));
            let offset = sampler.small_vector(size);
            sampler.vertex_to_vertex((&a, va), (&b, vb), offset)
        }
        3 => level_with_an_edge(sampler, &a),
        4 => into_a_chain(sampler),
        _ => {
            // On top of the notched outline, shifted.
            let b = if concave { sampler.concave(8, 32) } else { sampler.convex(8, 32) };
            let (top, sole) = (a.furthest([-1, -2, 64]), b.furthest([-1, -2, -64]));
            let offset = [sampler.length(0, 16), sampler.length(0, 16), sampler.gap(size)];
            sampler.vertex_to_vertex((&a, top), (&b, sole), offset)
        }
    };
    sampler.finish(a, b)
}

/// A block with a tip over a concave face of `a`, its foot on the line of one of the face's edges, mostly beyond an end.
/// Whether it is inside is then for the other edges to say.
fn level_with_an_edge(sampler: &mut PairSampler<'_>, a: &LatticeSolid) -> (LatticeSolid, LatticeSolid) {
    let shape = a.shape();
    let faces = shape.topology().face_ids();
    let concave: Vec<FaceId> = faces.filter(|&f| !shape.face_is_convex(f)).collect();
    let loop_ = shape.topology().face(*sampler.pick(&concave));
    let at = |k: usize| a.points()[loop_[k % loop_.len()].index()];
    // Every concave face of the catalogue is square to an axis, at an end of the block.
    let axis = (0..3).find(|&i| (0..loop_.len()).all(|k| at(k)[i] == at(0)[i])).unwrap_or(2);
    let out = if at(0)[axis] == a.extent(axis).1 { 1 } else { -1 };
    let count = loop_.len();
    let (mut k, mut step) = (sampler.below(count as u64) as usize, sampler.between(-24, 40));
    if sampler.chance(60) {
        // Beyond a reflex corner the line of an edge runs on inside the face.
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let turn = |k: usize| {
            let ([p, q], r) = ([at(k + count - 1), at(k)], at(k + 1));
            (q[i] - p[i]) * (r[j] - q[j]) - (q[j] - p[j]) * (r[i] - q[i])
        };
        let reflex: Vec<usize> = (0..count).filter(|&k| turn(k) * out < 0).collect();
        let (corner, beyond) = (*sampler.pick(&reflex), sampler.between(1, 12));
        (k, step) = if sampler.chance(50) { (corner, -beyond) } else { (corner + count - 1, 16 + beyond) };
    }
    let foot = [0, 1, 2].map(|i| 2 * (16 * at(k)[i] + step * (at(k + 1)[i] - at(k)[i])));
    let b = sampler.convex(4, 24);
    let b = if sampler.chance(60) { sampler.turned(&b) } else { sampler.cube_turned(&b) };
    let mut down = [0; 3];
    down[axis] = -out;
    let tip = b.points()[b.furthest(down)].map(|c| 2 * c);
    let mut offset = [0; 3];
    offset[axis] = out * sampler.gap(2 * sampler.denominator());
    sampler.point_to_point((&a.refined(16), foot), (&b, tip), offset)
}

/// A corner of a block pushed into the chamfer of a concave one: below the planes of three or four faces that follow
/// each other over convex edges.
fn into_a_chain(sampler: &mut PairSampler<'_>) -> (LatticeSolid, LatticeSolid) {
    let name = *sampler.pick(&["chamfered L", "chamfered L", "rounded L"]);
    let side = sampler.length(8, 32);
    let sides = if sampler.chance(60) { [side, side, sampler.length(16, 48)] } else { sampler.lengths(8, 32) };
    let a = sampler.shape(name, sides);
    let b = match sampler.below(3) {
        0 => sampler.cuboid(8, 24),
        1 => {
            let equal = [sampler.length(8, 24); 3];
            sampler.shape("tetrahedron", equal)
        }
        _ => sampler.convex(8, 24),
    };
    // The corner that points towards +x and +y, the chamfer's inside.
    let b = if sampler.chance(40) { sampler.turned_flat(&b) } else { b };
    // The corner furthest inwards from the chamfer.
    let tip = b.points()[b.furthest([8, 8, sampler.between(-3, 3)])].map(|c| 2 * c);
    // In sixteenths of the template's units: from (1, 1), on the chamfer, to inside the block, at some height.
    let inward = 16 + sampler.between(0, 24);
    let place = [inward, inward, 8 * sampler.between(2, 14)];
    let target = [0, 1, 2].map(|i| 2 * place[i] * sides[i]);
    let offset = sampler.small_vector(sampler.denominator() / 2);
    sampler.point_to_point((&a.refined(16), target), (&b, tip), offset)
}

/// Twice a point on a reflex edge: an end, or the middle.
fn reflex_point(sampler: &mut PairSampler<'_>, solid: &LatticeSolid) -> Units {
    let topology = solid.shape().topology();
    let reflex: Vec<_> =
        topology.edge_ids().filter(|&e| !solid.shape().edge_is_convex(e)).map(|e| topology.edge(e)).collect();
    let edge = sampler.pick(&reflex);
    let (p, q) = (solid.points()[edge.p.index()], solid.points()[edge.q.index()]);
    match sampler.below(3) {
        0 => p.map(|c| 2 * c),
        1 => q.map(|c| 2 * c),
        _ => [0, 1, 2].map(|i| p[i] + q[i]),
    }
}
