//! Blocks and tolerance sets for the stepper's tests.
#![allow(dead_code)] // each test file uses its own part

use rockproof_model::{Block, BlockOptions, Contact, Criteria, Number, ToleranceSet, Vec3};

pub(crate) fn exact() -> BlockOptions {
    BlockOptions { planarity: Number::ZERO }
}

/// A number from an f64.
pub(crate) fn n(value: f64) -> Number {
    Number::from_f64(value).unwrap()
}

/// A block from f64 coordinates; loops that run clockwise seen from outside are turned round.
pub(crate) fn block(vertices: &[[f64; 3]], faces: &[&[u32]]) -> Block {
    let sub = |a: u32, b: u32| [0, 1, 2].map(|k| vertices[a as usize][k] - vertices[b as usize][k]);
    let mut volume = 0.0;
    for face in faces {
        for k in 1..face.len() - 1 {
            let ([a, b, c], [d, e, f], [g, h, i]) = (sub(face[0], 0), sub(face[k], 0), sub(face[k + 1], 0));
            volume += a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
        }
    }
    let mut faces: Vec<Vec<u32>> = faces.iter().map(|f| f.to_vec()).collect();
    if volume < 0.0 {
        faces.iter_mut().for_each(|f| f.reverse());
    }
    let vertices = vertices.iter().map(|v| Vec3::new(n(v[0]), n(v[1]), n(v[2]))).collect();
    Block::new(vertices, faces, &exact()).unwrap()
}

pub(crate) const CUBOID_FACES: [&[u32]; 6] =
    [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];

/// An axis-aligned box. Vertices 0 to 3 run round the bottom, 4 to 7 round the top; faces: bottom, top, then −y, +x, +y, −x.
/// Edges: 0 0-1, 1 0-3, 2 0-4, 3 1-2, 4 1-5, 5 2-3, 6 2-6, 7 3-7, 8 4-5, 9 4-7, 10 5-6, 11 6-7.
pub(crate) fn cuboid(low: [f64; 3], high: [f64; 3]) -> Block {
    turned_cuboid(low, high, |v| v)
}

/// A box whose vertices a linear map has moved.
pub(crate) fn turned_cuboid(low: [f64; 3], high: [f64; 3], map: impl Fn([f64; 3]) -> [f64; 3]) -> Block {
    let corner = |x: bool, y: bool, z: bool| {
        let pick = |k: usize, up: bool| if up { high[k] } else { low[k] };
        map([pick(0, x), pick(1, y), pick(2, z)])
    };
    let ring = [(false, false), (true, false), (true, true), (false, true)];
    let vertices: Vec<_> = [false, true].iter().flat_map(|&z| ring.map(|(x, y)| corner(x, y, z))).collect();
    block(&vertices, &CUBOID_FACES)
}

/// A tetrahedron with a vertex 0 at `apex` pointing down and a level triangle above it.
pub(crate) fn spike(apex: [f64; 3], width: f64, height: f64) -> Block {
    let [x, y, z] = apex;
    let top = z + height;
    block(
        &[apex, [x + width, y, top], [x - width, y + width, top], [x - width, y - width, top]],
        &[&[1, 2, 3], &[0, 2, 1], &[0, 3, 2], &[0, 1, 3]],
    )
}

/// A tetrahedron with vertex 0 at `vertices[0]`.
pub(crate) fn tetrahedron(vertices: [[f64; 3]; 4]) -> Block {
    block(&vertices, &[&[0, 2, 1], &[0, 1, 3], &[0, 3, 2], &[1, 2, 3]])
}

/// A triangular prism: edge 0-1, and behind it the edges 3-2 and 5-4 of the back face.
pub(crate) fn prism(vertices: [[f64; 3]; 6]) -> Block {
    block(&vertices, &[&[0, 1, 2, 3], &[1, 0, 5, 4], &[3, 2, 4, 5], &[0, 3, 5], &[1, 4, 2]])
}

/// A prism whose edge 0-1 (number 0) along x points down at (1, 1, z).
pub(crate) fn keel(z: f64, half: f64) -> Block {
    let (low, high, top) = (1.0 - half, 1.0 + half, z + 0.5);
    prism([[low, 1.0, z], [high, 1.0, z], [high, 1.5, top], [low, 1.5, top], [high, 0.5, top], [low, 0.5, top]])
}

/// A prism whose edge 0-1 (number 0) along y points up at (1, 1, z).
pub(crate) fn ridge(z: f64) -> Block {
    let foot = z - 0.5;
    prism([[1.0, 0.5, z], [1.0, 1.5, z], [0.5, 1.5, foot], [0.5, 0.5, foot], [1.5, 1.5, foot], [1.5, 0.5, foot]])
}

/// A keel that begins exactly above the ridge at x = 1.
pub(crate) fn shifted_keel() -> Block {
    let z = 1.0625;
    prism([[1.0, 1.0, z], [2.0, 1.0, z], [2.0, 1.5, 1.5], [1.0, 1.5, 1.5], [2.0, 0.5, 1.5], [1.0, 0.5, 1.5]])
}

/// A ridge whose edge 0-1 (number 0) along y points up at x = 1, z = 1, from y = 0 to 4.
pub(crate) fn long_ridge() -> Block {
    prism([[1.0, 0.0, 1.0], [1.0, 4.0, 1.0], [0.5, 4.0, 0.5], [0.5, 0.0, 0.5], [1.5, 4.0, 0.5], [1.5, 0.0, 0.5]])
}

/// A thin prism 7/64 above the long ridge: edge 0-1 (number 0) along x at y = 1, `depth` behind it the edges 2-3 and 4-5
/// (number 8), `half` higher and lower.
pub(crate) fn blade(depth: f64, half: f64) -> Block {
    let (back, z) = (1.0 + depth, 1.109375);
    let (up, down) = (z + half, z - half);
    prism([[0.0, 1.0, z], [2.0, 1.0, z], [2.0, back, up], [0.0, back, up], [2.0, back, down], [0.0, back, down]])
}

/// A tetrahedron with these three edges at vertex 0.
pub(crate) fn cone(apex: [f64; 3], edges: [[f64; 3]; 3]) -> Block {
    let end = |edge: [f64; 3]| [0, 1, 2].map(|k| apex[k] + edge[k]);
    tetrahedron([apex, end(edges[0]), end(edges[1]), end(edges[2])])
}

/// A tetrahedron whose edges at vertex 0 rise and lead to +x: below a top and behind a side it overlaps both.
pub(crate) fn leaning(x: f64, y: f64, z: f64) -> Block {
    cone([x, y, z], [[0.5, 0.0, 0.125], [0.125, 0.25, 0.5], [0.125, -0.25, 0.5]])
}

/// A tetrahedron whose vertex 0 points to −x; its edges there rise little.
pub(crate) fn beak(apex: [f64; 3]) -> Block {
    cone(apex, [[0.5, 0.0, 0.0625], [0.5, 0.25, 0.25], [0.5, -0.25, 0.25]])
}

/// A tetrahedron with vertex 0 beside edge 10 of the box [0, 2]² × [0, 1], (2, y, 1): `dx` beyond the side (face 3) and `dz` above the top
/// (face 1). Of its edges one goes by `along`, the others rise from both faces. `along` runs with edge 10, so that the two
/// are nearly parallel, and the planes of the others with edge 10 cut the base: the two faces are the only candidates.
pub(crate) fn beside_edge(dx: f64, dz: f64, along: [f64; 3]) -> Block {
    cone([2.0 + dx, 1.0, 1.0 + dz], [along, [0.5, 0.0, 0.5], [0.25, -0.5, 0.5]])
}

/// Vertex 0 is 1/32 below the top and 1/64 behind the side; an edge of it goes 3/64 deeper behind the side, past vertex 6 of
/// that box. The plane it spans with the vertical edge 6 is 0.047 deep.
pub(crate) fn behind_side() -> Block {
    cone([1.984375, 1.0, 0.96875], [[-0.046875, 1.5, 0.0], [1.0, 0.0, 0.5], [0.25, -0.25, 0.5]])
}

/// The corner block with its face 3 sloping back below the edge at x = 4, z = 1.
pub(crate) fn undercut() -> Block {
    let with_foot = |v: [f64; 3]| if v[0] == 4.0 && v[2] == 0.0 { [3.5, v[1], v[2]] } else { v };
    moved_corner_block(with_foot)
}

/// An L-shaped prism over `[0, 4]² × [0, 1]` without `x > 1 and y > 1`: reflex edge 3-9 at (1, 1). Faces: bottom, top, then
/// y = 0, x = 4, y = 1 (inner), x = 1 (inner), y = 4, x = 0.
pub(crate) fn corner_block() -> Block {
    moved_corner_block(|v| v)
}

/// The outline of the corner block.
pub(crate) const L_OUTLINE: [[f64; 2]; 6] = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]];

fn moved_corner_block(map: impl Fn([f64; 3]) -> [f64; 3]) -> Block {
    moved_upright(&L_OUTLINE, map)
}

/// The prism over a polygon that runs counter-clockwise, from z = 0 to 1. Faces: bottom, top, then one an edge, in its order.
pub(crate) fn upright(outline: &[[f64; 2]]) -> Block {
    moved_upright(outline, |v| v)
}

fn moved_upright(outline: &[[f64; 2]], map: impl Fn([f64; 3]) -> [f64; 3]) -> Block {
    let n = outline.len() as u32;
    let vertices: Vec<_> =
        [0.0, 1.0].iter().flat_map(|&z| outline.iter().map(move |&[x, y]| [x, y, z])).map(map).collect();
    let sides = (0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]);
    let faces: Vec<Vec<u32>> = [(0..n).rev().collect(), (n..2 * n).collect()].into_iter().chain(sides).collect();
    block(&vertices, &faces.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

/// Tolerances exact in every precision: s = 1/8, r = 1/64, g = 1/16, so = sp = 3/64, ε = 2⁻²⁰, revised.
pub(crate) fn tolerances() -> ToleranceSet {
    ToleranceSet {
        search: n(0.125),
        territory: n(0.015625),
        penetration: n(0.0625),
        overlap_sine: n(0.046875),
        parallel_sine: n(0.046875),
        equal: n(f64::powi(2.0, -20)),
        ..ToleranceSet::ZERO
    }
}

/// The same, classic.
pub(crate) fn classic() -> ToleranceSet {
    ToleranceSet { criteria: Criteria::Classic, ..tolerances() }
}

/// `kind a b entrance entrance_a entrance_b sign`, to read and write expectations.
pub(crate) fn show(contact: &Contact) -> String {
    let ([a, b], [entrance_a, entrance_b]) = (contact.key.numbers(), contact.entrance.numbers());
    let (kind, entrance, gap) = (contact.kind(), contact.entrance.kind(), contact.gap.as_i8());
    format!("{kind} {a} {b} {entrance} {entrance_a} {entrance_b} {gap:+}")
}
