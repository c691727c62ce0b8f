//! The shapes pairs are made of, each in the cube [0, 8]³ on integers. Stretched, turned and moved they become blocks.

use super::lattice_solid::{LatticeSolid, Units};
use super::round;
use rockproof_differential::hull::convex_hull;
use rockproof_model::{Block, BlockError, BlockOptions, Number, Point, Vec3};
use std::sync::OnceLock;

/// The side of the cube each shape fills.
pub const SIDE: i128 = 8;

/// A named shape.
#[derive(Clone, Debug)]
pub struct Template {
    /// What it is, in one or two words.
    pub name: &'static str,
    /// The shape in [0, 8]³.
    pub solid: LatticeSolid,
}

/// The convex shapes. The first is the cube.
pub fn convex() -> &'static [Template] {
    static SHAPES: OnceLock<Vec<Template>> = OnceLock::new();
    SHAPES.get_or_init(|| CONVEX.iter().filter_map(|&(name, points)| hull_template(name, points)).collect())
}

/// The concave shapes: reflex edges, and faces that are concave polygons.
pub fn concave() -> &'static [Template] {
    static SHAPES: OnceLock<Vec<Template>> = OnceLock::new();
    SHAPES.get_or_init(|| {
        let mut shapes: Vec<Template> =
            POLYGONS.iter().filter_map(|&(name, polygon)| prism_template(name, polygon)).collect();
        shapes.extend(loops_template("notched cube", NOTCHED_CUBE));
        shapes.extend(loops_template("notched ridge", NOTCHED_RIDGE));
        shapes
    })
}

/// Convex shapes of about 50 to 200 vertices, most of them corners of five to seven edges.
pub fn round() -> &'static [Template] {
    static SHAPES: OnceLock<Vec<Template>> = OnceLock::new();
    SHAPES.get_or_init(|| {
        let shapes = [("round 50", 50), ("round 80", 80), ("round 125", 125), ("round 200", 200)];
        let template = |(name, count)| Some(Template { name, solid: round::solid(count)? });
        shapes.into_iter().filter_map(template).collect()
    })
}

/// The convex shape of this name.
///
/// # Panics
/// When there is none: names are constants of the generators, and each is used by a test.
pub(crate) fn named(name: &str) -> &'static LatticeSolid {
    let found = convex().iter().chain(concave()).find(|t| t.name == name);
    &found.unwrap_or_else(|| panic!("no shape is called {name}")).solid
}

/// A solid from the convex hull of points in lattice units, at most 28 bits each; `None` when they are flat.
pub fn hull_of(points: &[Units], denominator: i128) -> Option<LatticeSolid> {
    let block = convex_hull(&points.iter().map(point_of).collect::<Vec<_>>()).ok()?;
    let kept = block.vertices().iter().map(units_of).collect();
    Some(LatticeSolid::new(block, kept, denominator))
}

fn hull_template(name: &'static str, points: &[[i8; 3]]) -> Option<Template> {
    let points: Vec<Units> = points.iter().map(|p| p.map(i128::from)).collect();
    Some(Template { name, solid: hull_of(&points, 1)? })
}

fn point_of(units: &Units) -> Point {
    let number = |c: i128| Number::from_integer(c as i32);
    Vec3::new(number(units[0]), number(units[1]), number(units[2]))
}

fn units_of(point: &Point) -> Units {
    point.components().map(|c| c.approximate() as i128)
}

/// The block of these faces over points in lattice units.
pub(super) fn solid_of(
    points: Vec<Units>,
    faces: Vec<Vec<u32>>,
    denominator: i128,
) -> Result<LatticeSolid, BlockError> {
    let vertices = points.iter().map(point_of).collect();
    let block = Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO })?;
    Ok(LatticeSolid::new(block, points, denominator))
}

/// A prism from z = 0 to z = 8 over a counter-clockwise polygon.
fn prism_template(name: &'static str, polygon: &[[i8; 2]]) -> Option<Template> {
    let n = polygon.len() as u32;
    let layer = |z: i128| polygon.iter().map(move |p| [i128::from(p[0]), i128::from(p[1]), z]);
    let points: Vec<Units> = layer(0).chain(layer(SIDE)).collect();
    let mut faces = vec![(0..n).rev().collect::<Vec<u32>>(), (n..2 * n).collect()];
    faces.extend((0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]));
    Some(Template { name, solid: solid_of(points, faces, 1).ok()? })
}

/// A block from its face loops written as points.
fn loops_template(name: &'static str, loops: &[&[[i8; 3]]]) -> Option<Template> {
    let mut points: Vec<[i8; 3]> = Vec::new();
    let mut faces = Vec::new();
    for corners in loops {
        let mut face = Vec::new();
        for corner in *corners {
            let known = points.iter().position(|p| p == corner).unwrap_or_else(|| {
                points.push(*corner);
                points.len() - 1
            });
            face.push(known as u32);
        }
        faces.push(face);
    }
    let points = points.iter().map(|p| p.map(i128::from)).collect();
    Some(Template { name, solid: solid_of(points, faces, 1).ok()? })
}

/// Corners of each convex shape.
const CONVEX: &[(&str, &[[i8; 3]])] = &[
    ("cuboid", &[[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [0, 0, 8], [8, 0, 8], [8, 8, 8], [0, 8, 8]]),
    ("tetrahedron", &[[0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8]]),
    ("centred tetrahedron", &[[0, 0, 0], [8, 0, 0], [4, 8, 0], [4, 4, 8]]),
    ("wedge", &[[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [8, 0, 8], [8, 8, 8]]),
    ("ridge", &[[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [0, 4, 8], [8, 4, 8]]),
    ("hipped ridge", &[[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [2, 4, 8], [6, 4, 8]]),
    ("pyramid", &[[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [4, 4, 8]]),
    ("frustum", &[[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [2, 2, 8], [6, 2, 8], [6, 6, 8], [2, 6, 8]]),
    (
        "pentagon",
        &[[0, 2, 0], [4, 0, 0], [8, 3, 0], [6, 8, 0], [1, 7, 0], [0, 2, 8], [4, 0, 8], [8, 3, 8], [6, 8, 8], [1, 7, 8]],
    ),
    (
        "hexagon",
        &[
            [2, 0, 0],
            [6, 0, 0],
            [8, 4, 0],
            [6, 8, 0],
            [2, 8, 0],
            [0, 4, 0],
            [2, 0, 8],
            [6, 0, 8],
            [8, 4, 8],
            [6, 8, 8],
            [2, 8, 8],
            [0, 4, 8],
        ],
    ),
    ("rhombus", &[[4, 0, 0], [8, 4, 0], [4, 8, 0], [0, 4, 0], [4, 0, 8], [8, 4, 8], [4, 8, 8], [0, 4, 8]]),
    (
        "cut corner",
        &[[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [0, 0, 8], [8, 0, 8], [0, 8, 8], [8, 8, 4], [8, 4, 8], [4, 8, 8]],
    ),
    // Angles of 3, 4 and 5.
    (
        "chamfer",
        &[[0, 0, 0], [8, 0, 0], [8, 4, 0], [5, 8, 0], [0, 8, 0], [0, 0, 8], [8, 0, 8], [8, 4, 8], [5, 8, 8], [0, 8, 8]],
    ),
    ("scarp", &[[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [6, 0, 8], [8, 0, 8], [6, 8, 8], [8, 8, 8]]),
    // Edges along face diagonals: with a rhombus, sines of exactly a half.
    ("regular tetrahedron", &[[0, 0, 0], [8, 8, 0], [8, 0, 8], [0, 8, 8]]),
    (
        "cuboctahedron",
        &[
            [4, 0, 0],
            [0, 4, 0],
            [8, 4, 0],
            [4, 8, 0],
            [0, 0, 4],
            [8, 0, 4],
            [0, 8, 4],
            [8, 8, 4],
            [4, 0, 8],
            [0, 4, 8],
            [8, 4, 8],
            [4, 8, 8],
        ],
    ),
    ("half octahedron", &[[4, 0, 0], [8, 4, 0], [4, 8, 0], [0, 4, 0], [4, 4, 4], [4, 4, 8]]),
    // Apexes of five and six edges.
    ("spire", &[[0, 2, 0], [4, 0, 0], [8, 3, 0], [6, 8, 0], [1, 7, 0], [4, 4, 8]]),
    ("tent", &[[2, 0, 0], [6, 0, 0], [8, 4, 0], [6, 8, 0], [2, 8, 0], [0, 4, 0], [4, 4, 8]]),
    ("trapezoid", &[[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [0, 3, 8], [8, 3, 8], [8, 5, 8], [0, 5, 8]]),
];

/// Counter-clockwise outlines of the concave prisms.
const POLYGONS: &[(&str, &[[i8; 2]])] = &[
    ("L", &[[0, 0], [8, 0], [8, 3], [3, 3], [3, 8], [0, 8]]),
    ("U", &[[0, 0], [8, 0], [8, 8], [6, 8], [6, 3], [2, 3], [2, 8], [0, 8]]),
    ("T", &[[3, 0], [5, 0], [5, 5], [8, 5], [8, 8], [0, 8], [0, 5], [3, 5]]),
    ("plus", &[[3, 0], [5, 0], [5, 3], [8, 3], [8, 5], [5, 5], [5, 8], [3, 8], [3, 5], [0, 5], [0, 3], [3, 3]]),
    ("arrow", &[[0, 0], [4, 3], [8, 0], [4, 8]]),
    ("V notch", &[[0, 0], [8, 0], [8, 8], [4, 2], [0, 8]]),
    // Three and four faces in a chain of convex edges.
    ("chamfered L", &[[0, 2], [2, 0], [8, 0], [8, 3], [3, 3], [3, 8], [0, 8]]),
    ("rounded L", &[[0, 3], [1, 1], [3, 0], [8, 0], [8, 4], [4, 4], [4, 8], [0, 8]]),
    ("stair", &[[0, 0], [8, 0], [8, 2], [5, 2], [5, 5], [2, 5], [2, 8], [0, 8]]),
];

/// A cube without one eighth: a corner where three reflex edges meet.
const NOTCHED_CUBE: &[&[[i8; 3]]] = &[
    &[[0, 0, 0], [0, 8, 0], [8, 8, 0], [8, 0, 0]],
    &[[0, 0, 0], [8, 0, 0], [8, 0, 8], [0, 0, 8]],
    &[[0, 0, 0], [0, 0, 8], [0, 8, 8], [0, 8, 0]],
    &[[8, 0, 0], [8, 8, 0], [8, 8, 4], [8, 4, 4], [8, 4, 8], [8, 0, 8]],
    &[[0, 8, 0], [0, 8, 8], [4, 8, 8], [4, 8, 4], [8, 8, 4], [8, 8, 0]],
    &[[0, 0, 8], [8, 0, 8], [8, 4, 8], [4, 4, 8], [4, 8, 8], [0, 8, 8]],
    &[[4, 4, 4], [4, 8, 4], [4, 8, 8], [4, 4, 8]],
    &[[4, 4, 4], [4, 4, 8], [8, 4, 8], [8, 4, 4]],
    &[[4, 4, 4], [8, 4, 4], [8, 8, 4], [4, 8, 4]],
];

/// A block with a valley along x in its top: one reflex edge between oblique faces.
const NOTCHED_RIDGE: &[&[[i8; 3]]] = &[
    &[[0, 0, 0], [0, 8, 0], [8, 8, 0], [8, 0, 0]],
    &[[0, 0, 0], [8, 0, 0], [8, 0, 8], [0, 0, 8]],
    &[[0, 8, 0], [0, 8, 8], [8, 8, 8], [8, 8, 0]],
    &[[8, 0, 0], [8, 8, 0], [8, 8, 8], [8, 4, 3], [8, 0, 8]],
    &[[0, 0, 0], [0, 0, 8], [0, 4, 3], [0, 8, 8], [0, 8, 0]],
    &[[0, 0, 8], [8, 0, 8], [8, 4, 3], [0, 4, 3]],
    &[[0, 4, 3], [8, 4, 3], [8, 8, 8], [0, 8, 8]],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_is_a_block_of_its_kind() {
        assert_eq!(convex().len(), CONVEX.len());
        assert_eq!(concave().len(), POLYGONS.len() + 2);
        assert!(convex().iter().all(|t| t.solid.shape().is_convex()));
        for Template { name, solid } in concave() {
            let block = solid.shape();
            let edges = || block.topology().edge_ids();
            assert!(edges().any(|e| !block.edge_is_convex(e)), "{name} has a reflex edge");
            assert!(edges().any(|e| block.edge_is_convex(e)), "{name} is not inside out");
        }
        let counts: Vec<usize> = round().iter().map(|t| t.solid.points().len()).collect();
        assert_eq!(counts, [50, 80, 125, 200]);
        for Template { name, solid } in round() {
            let topology = solid.shape().topology();
            let many = topology.vertex_ids().filter(|&v| topology.vertex_edges(v).len() >= 5).count();
            assert!(
                solid.shape().is_convex() && 2 * many > solid.points().len(),
                "{name}: {many} corners of five edges"
            );
            assert!((0..3).all(|axis| solid.extent(axis).1 <= SIDE * solid.denominator()), "{name}");
        }
        for Template { name, solid } in convex().iter().chain(concave()) {
            assert_eq!((solid.extent(2), solid.denominator()), ((0, SIDE), 1), "{name}");
        }
    }
}
