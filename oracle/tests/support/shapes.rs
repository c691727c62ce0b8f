//! The blocks of the hand-worked cases: few, with round numbers and slopes of 3-4-5.

use num_rational::BigRational;
use rockproof_model::{Block, BlockOptions, Criteria, Number, Point, ToleranceSet, Vec3};

/// The number written as an integer or a fraction.
pub(crate) fn number(text: &str) -> Number {
    Number::from_rational(exact(text))
}

/// The fraction written as an integer or a fraction.
pub(crate) fn exact(text: &str) -> BigRational {
    text.parse().unwrap()
}

/// The number times 1 − 2⁻⁴⁰, written as a fraction.
pub(crate) fn just_below(text: &str) -> String {
    let little = BigRational::new(1.into(), (1u64 << 40).into());
    (exact(text) * (exact("1") - little)).to_string()
}

/// The point with these coordinates.
pub(crate) fn point([x, y, z]: [&str; 3]) -> Point {
    Vec3::new(number(x), number(y), number(z))
}

/// The block with these vertices and faces.
pub(crate) fn block(vertices: Vec<Point>, faces: &[&[u32]]) -> Block {
    let faces = faces.iter().map(|f| f.to_vec()).collect();
    Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).unwrap()
}

/// The box between two corners.
///
/// Vertices: 0 to 3 are the bottom (x0,y0), (x1,y0), (x1,y1), (x0,y1), 4 to 7 the top above them.
/// Faces: 0 bottom, 1 top, 2 at y0, 3 at x1, 4 at y1, 5 at x0.
/// Edges: 0 = 0-1, 1 = 0-3, 2 = 0-4, 3 = 1-2, 4 = 1-5, 5 = 2-3, 6 = 2-6, 7 = 3-7, 8 = 4-5, 9 = 4-7, 10 = 5-6, 11 = 6-7.
pub(crate) fn cuboid([x0, y0, z0]: [&str; 3], [x1, y1, z1]: [&str; 3]) -> Block {
    let corners = [
        [x0, y0, z0],
        [x1, y0, z0],
        [x1, y1, z0],
        [x0, y1, z0],
        [x0, y0, z1],
        [x1, y0, z1],
        [x1, y1, z1],
        [x0, y1, z1],
    ];
    block(
        corners.into_iter().map(point).collect(),
        &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
    )
}

/// A slab 8 by 8 and 4 thick below z = 0, numbered like every box: face 1 is its top; its top edges are 8 (y = −4),
/// 9 (x = −4), 10 (x = 4) and 11 (y = 4); vertex 6 is the corner (4, 4, 0).
pub(crate) fn slab() -> Block {
    cuboid(["-4", "-4", "-4"], ["4", "4", "0"])
}

/// The faces of a pyramid with tip 0 and base 1 to 4, numbered as in [`spike`].
pub(crate) const PYRAMID_FACES: [&[u32]; 5] = [&[1, 2, 3, 4], &[0, 2, 1], &[0, 3, 2], &[0, 4, 3], &[0, 1, 4]];

/// A pyramid on its tip.
///
/// Vertex 0 is the tip; 1 to 4 the base's corners (+,+), (−,+), (−,−), (+,−), at `tip + (±3, ±3, 4)`.
/// Faces: 0 base (upwards), 1 towards y+ (`N = (0, 24, −18)`), 2 towards x− (`(−24, 0, −18)`), 3 towards y−
/// (`(0, −24, −18)`), 4 towards x+ (`(24, 0, −18)`). Edges: 0 to 3 from the tip to 1 to 4, then 4 = 1-2, 5 = 1-4, 6 = 2-3,
/// 7 = 3-4.
pub(crate) fn spike(tip: [&str; 3]) -> Block {
    pyramid(tip, [[3, 3], [-3, 3], [-3, -3], [3, -3]], "1", "4")
}

/// A pyramid on its tip that leans towards x+: base corners at `tip + (2 or 1, ±1/2, 1)`, numbered as in [`spike`].
pub(crate) fn leaning_spike(tip: [&str; 3]) -> Block {
    pyramid(tip, [[4, 1], [2, 1], [2, -1], [4, -1]], "1/2", "1")
}

fn pyramid(tip: [&str; 3], base: [[i32; 2]; 4], unit: &str, height: &str) -> Block {
    let tip = point(tip);
    let (unit, height) = (number(unit), number(height));
    let corner = |[x, y]: [i32; 2]| {
        let along = |steps: i32| Number::from_integer(steps).times(&unit);
        Vec3::new(tip.x.plus(&along(x)), tip.y.plus(&along(y)), tip.z.plus(&height))
    };
    let vertices = std::iter::once(tip.clone()).chain(base.into_iter().map(corner)).collect();
    block(vertices, &PYRAMID_FACES)
}

/// A flat wedge-shaped corner: from vertex 0, the origin, edges 4 long to (0, 4, 0), (4, 0, 0), (4, 0, −1/25) and (0, 4, −1/25),
/// vertices 1 to 4. Face 1 is its top; edges 0 (0-1, along y) and 1 (0-2, along x) bound it, each beside a face only 1/25 wide.
/// Numbered as in [`spike`].
pub(crate) fn flat_corner() -> Block {
    block(flat_corner_vertices(), &PYRAMID_FACES)
}

/// The flat corner upside down, (y, x, −z), moved by `offset`: edge 1 is along y.
pub(crate) fn flat_corner_upside_down(offset: [&str; 3]) -> Block {
    let vertices = flat_corner_vertices().into_iter().map(|v| Vec3::new(v.y, v.x, v.z.negated())).collect();
    block(vertices, &PYRAMID_FACES).translated(&point(offset))
}

fn flat_corner_vertices() -> Vec<Point> {
    [["0", "0", "0"], ["0", "4", "0"], ["4", "0", "0"], ["4", "0", "-1/25"], ["0", "4", "-1/25"]].map(point).to_vec()
}

/// The tetrahedron of four points with `(v1 − v0) × (v2 − v0) · (v3 − v0) > 0`.
///
/// Faces: 0 = 0,2,1; 1 = 0,1,3; 2 = 1,2,3; 3 = 0,3,2. Edges: 0 = 0-1, 1 = 0-2, 2 = 0-3, 3 = 1-2, 4 = 1-3, 5 = 2-3.
pub(crate) fn tetrahedron(vertices: [[&str; 3]; 4]) -> Block {
    block(vertices.into_iter().map(point).collect(), &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]])
}

/// A prism whose ridge runs along x from −`half` to `half` and whose section, in the plane (y, z), is the triangle of
/// the ridge, `p` and `q`, counter-clockwise. It is moved by `offset` at the end.
///
/// Vertices: 0, 1 the ridge (x−, x+); 2, 3 the edge at p (x+, x−); 4, 5 the edge at q (x+, x−).
/// Faces: 0 opposite the ridge, 1 from the ridge to p, 2 from the ridge to q, 3 the end x+, 4 the end x−.
/// Edges: 0 = 0-1 the ridge, 1 = 0-3, 2 = 0-5, 3 = 1-2, 4 = 1-4, 5 = 2-3, 6 = 2-4, 7 = 3-5, 8 = 4-5.
#[derive(Clone, Copy)]
pub(crate) struct Prism<'t> {
    pub(crate) half: &'t str,
    pub(crate) p: [&'t str; 2],
    pub(crate) q: [&'t str; 2],
    pub(crate) offset: [&'t str; 3],
}

/// A wedge on its ridge, 4 long, slopes 4/3: `n` of face 1 is (0, 4, −3)/5, of face 2 (0, −4, −3)/5.
pub(crate) const WEDGE: Prism<'static> = Prism { half: "2", p: ["3", "4"], q: ["-3", "4"], offset: ["0", "0", "0"] };

impl Prism<'_> {
    /// The prism as described.
    pub(crate) fn along_x(self) -> Block {
        self.mapped(|v| v)
    }

    /// Turned upside down about the x axis, before it is moved: (x, −y, −z).
    pub(crate) fn upside_down_along_x(self) -> Block {
        self.mapped(|v| Vec3::new(v.x, v.y.negated(), v.z.negated()))
    }

    /// Turned upside down with its ridge along y, before it is moved: (y, x, −z). Vertex 0 is the end y−.
    pub(crate) fn upside_down_along_y(self) -> Block {
        self.mapped(|v| Vec3::new(v.y, v.x, v.z.negated()))
    }

    /// Turned about z by the angle with cosine 4/5 and sine 3/5, before it is moved.
    pub(crate) fn turned(self) -> Block {
        self.mapped(|v| {
            let (x, y) = turn(&v.x, &v.y, ["4/5", "3/5"]);
            Vec3::new(x, y, v.z)
        })
    }

    fn mapped(self, map: impl Fn(Point) -> Point) -> Block {
        let half = number(self.half);
        let at = |x: &Number, [y, z]: [&str; 2]| map(Vec3::new(x.clone(), number(y), number(z)));
        let (low, high) = (half.negated(), half);
        let ridge = ["0", "0"];
        let vertices = vec![
            at(&low, ridge),
            at(&high, ridge),
            at(&high, self.p),
            at(&low, self.p),
            at(&high, self.q),
            at(&low, self.q),
        ];
        let faces: [&[u32]; 5] = [&[2, 3, 5, 4], &[0, 3, 2, 1], &[0, 1, 4, 5], &[1, 2, 4], &[0, 5, 3]];
        block(vertices, &faces).translated(&point(self.offset))
    }
}

/// Two coordinates turned by the angle of this cosine and sine.
pub(crate) fn turn(a: &Number, b: &Number, angle: [&str; 2]) -> (Number, Number) {
    let [c, s] = angle.map(number);
    (a.times(&c).plus(&b.times(&s).negated()), a.times(&s).plus(&b.times(&c)))
}

/// The block turned by the angles of cosine 3/5 about z and 5/13 about x, and moved by a seventh.
pub(crate) fn turned(block: &Block) -> Block {
    let vertices = block.vertices().iter().map(|v| {
        let (x, y) = turn(&v.x, &v.y, ["3/5", "4/5"]);
        let (y, z) = turn(&y, &v.z, ["5/13", "12/13"]);
        Vec3::new(x.plus(&number("1/7")), y, z)
    });
    block.with_vertices(vertices.collect())
}

/// A step: the L with corners (0,0), (4,0), (4,2), (2,2), (2,4), (0,4) in the plane (x, z), from y = −4 to y = 4.
///
/// Vertices: 0 to 5 these corners at y = −4, 6 to 11 at y = 4.
/// Faces: 0 front (y = −4), 1 back, 2 bottom, 3 at x = 4, 4 the step's floor (z = 2), 5 its wall (x = 2), 6 top, 7 at x = 0.
/// Edges: 0 = 0-1, 1 = 0-5, 2 = 0-6, 3 = 1-2, 4 = 1-7, 5 = 2-3, 6 = 2-8, 7 = 3-4, 8 = 3-9 (the only reflex one),
/// 9 = 4-5, 10 = 4-10, 11 = 5-11, 12 = 6-7, 13 = 6-11, 14 = 7-8, 15 = 8-9, 16 = 9-10, 17 = 10-11.
pub(crate) fn step() -> Block {
    step_between("-4", "4")
}

/// A step from y = `front` to y = `back`, numbered as in [`step`].
pub(crate) fn step_between(front: &str, back: &str) -> Block {
    extruded(&[["0", "0"], ["4", "0"], ["4", "2"], ["2", "2"], ["2", "4"], ["0", "4"]], front, back)
}

/// A plus sign in the plane (x, y), arms 1 wide and 3 long, from z = 0 to z = 1.
pub(crate) fn plus_sign() -> Block {
    let corners = [[1, 0], [2, 0], [2, 1], [3, 1], [3, 2], [2, 2], [2, 3], [1, 3], [1, 2], [0, 2], [0, 1], [1, 1]];
    let at = |z: i32| corners.map(|[x, y]| Vec3::new(x, y, z).map(|&c| Number::from_integer(c)));
    let n = corners.len() as u32;
    let sides = (0..n).map(|k| vec![k, (k + 1) % n, (k + 1) % n + n, k + n]);
    let faces: Vec<Vec<u32>> = [(0..n).rev().collect(), (n..2 * n).collect()].into_iter().chain(sides).collect();
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    block(at(0).into_iter().chain(at(1)).collect(), &faces)
}

/// A cube of edge 4 from the origin without the cube of edge 2 at its corner (4, 4, 4); vertex 13 is that cube's corner (2, 2, 2).
pub(crate) fn notched_cube() -> Block {
    let corners = [
        [0, 0, 0],
        [4, 0, 0],
        [4, 4, 0],
        [0, 4, 0],
        [0, 0, 4],
        [4, 0, 4],
        [0, 4, 4],
        [4, 4, 2],
        [4, 2, 2],
        [4, 2, 4],
        [2, 2, 4],
        [2, 4, 4],
        [2, 4, 2],
        [2, 2, 2],
    ];
    let faces: [&[u32]; 9] = [
        &[0, 3, 2, 1],
        &[0, 1, 5, 4],
        &[0, 4, 6, 3],
        &[1, 2, 7, 8, 9, 5],
        &[2, 3, 6, 11, 12, 7],
        &[4, 5, 9, 10, 11, 6],
        &[13, 8, 7, 12],
        &[13, 12, 11, 10],
        &[13, 10, 9, 8],
    ];
    let vertices = corners.map(|[x, y, z]| Vec3::new(x, y, z).map(|&c| Number::from_integer(c)));
    block(vertices.to_vec(), &faces)
}

/// A slab with a gable: top at z = 0 for x < 0 (face 5), from x = 0 a slope down with normal (3, 0, 4)/5 (face 4);
/// edge 8 is the gable's, along y through the origin. From y = −4 to y = 4.
pub(crate) fn gable() -> Block {
    extruded(&[["-4", "-4"], ["4", "-4"], ["4", "-3"], ["0", "0"], ["-4", "0"]], "-4", "4")
}

/// The polygon of the plane (x, z), counter-clockwise with x to the right and z up, from y = `front` to y = `back`.
/// Face 0 is the front, face 1 the back, face 2 + k joins corners k and k + 1.
pub(crate) fn extruded(corners: &[[&str; 2]], front: &str, back: &str) -> Block {
    let n = corners.len() as u32;
    let at = |y| corners.iter().map(move |[x, z]| point([x, y, z]));
    let sides = (0..n).map(|k| vec![(k + 1) % n, k, k + n, (k + 1) % n + n]);
    let faces: Vec<Vec<u32>> = [(0..n).collect(), (n..2 * n).rev().collect()].into_iter().chain(sides).collect();
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    block(at(front).chain(at(back)).collect(), &faces)
}

/// s = 1/10, r = 1/50, g = 1/20, no angle, ε = 0, `revised`, with some values changed by name.
pub(crate) fn revised(changes: &[(&str, &str)]) -> ToleranceSet {
    tolerances(Criteria::Revised, changes)
}

/// As [`revised`], under `classic`.
pub(crate) fn classic(changes: &[(&str, &str)]) -> ToleranceSet {
    tolerances(Criteria::Classic, changes)
}

fn tolerances(criteria: Criteria, changes: &[(&str, &str)]) -> ToleranceSet {
    let mut set = ToleranceSet {
        search: number("1/10"),
        territory: number("1/50"),
        penetration: number("1/20"),
        criteria,
        ..ToleranceSet::ZERO
    };
    for (name, value) in changes {
        let mut numbers = set.numbers_mut();
        let (_, place) = numbers.iter_mut().find(|(known, _)| known == name).unwrap();
        **place = number(value);
    }
    set
}
