//! The blocks the pictures show. Every coordinate is an f64, so every face is exactly planar.

use rockproof_model::{Block, BlockOptions, Number, Point, Vec3};

/// A point given in metres.
pub(super) type Metres = [f64; 3];

/// A number that an f64 holds.
pub(super) fn number(value: f64) -> Number {
    Number::from_f64(value).expect("pictures use finite numbers")
}

/// A block from its vertices and faces.
pub(super) fn block(vertices: &[Metres], faces: &[&[u32]]) -> Block {
    let vertices: Vec<Point> = vertices.iter().map(|[x, y, z]| Vec3::new(number(*x), number(*y), number(*z))).collect();
    let faces = faces.iter().map(|face| face.to_vec()).collect();
    Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).expect("pictures show canonical blocks")
}

/// The parallelepiped with one vertex (number 0) at `corner` and edges `u`, `v`, `w` from it, right-handed.
pub(super) fn parallelepiped(corner: Metres, u: Metres, v: Metres, w: Metres) -> Block {
    let at = |uses: [bool; 3]| {
        let mut point = corner;
        for (used, side) in uses.into_iter().zip([u, v, w]) {
            if used {
                for (c, s) in point.iter_mut().zip(side) {
                    *c += s;
                }
            }
        }
        point
    };
    let vertices: Vec<Metres> = (0..8).map(|k| at([k & 1 != 0, k & 2 != 0, k & 4 != 0])).collect();
    let faces: [&[u32]; 6] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
    block(&vertices, &faces)
}

/// The triangular prism with the ridge from `start` to `start + along` and the two other long edges at `left` and
/// `right` of it; `left`, `right`, `along` right-handed. The ridge joins vertices 0 and 1.
pub(super) fn prism(start: Metres, along: Metres, left: Metres, right: Metres) -> Block {
    let sum = |a: Metres, b: Metres| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let section = [start, sum(start, left), sum(start, right)];
    let vertices: Vec<Metres> = section.iter().flat_map(|&p| [p, sum(p, along)]).collect();
    // Even numbers at the start, odd ones at the end of `along`.
    block(&vertices, &[&[0, 4, 2], &[1, 3, 5], &[0, 2, 3, 1], &[2, 4, 5, 3], &[0, 1, 5, 4]])
}

/// The pyramid with vertex 0 at `tip` over a base whose corners, relative to the tip, run counter-clockwise seen from it.
pub(super) fn pyramid(tip: Metres, base: [Metres; 4]) -> Block {
    let mut vertices = vec![tip];
    vertices.extend(base.map(|[x, y, z]| [tip[0] + x, tip[1] + y, tip[2] + z]));
    block(&vertices, &[&[4, 3, 2, 1], &[0, 1, 2], &[0, 2, 3], &[0, 3, 4], &[0, 4, 1]])
}

/// A coordinate triple of a vertex, in f64.
pub(super) fn metres(point: &Point) -> Metres {
    [point.x.approximate(), point.y.approximate(), point.z.approximate()]
}
