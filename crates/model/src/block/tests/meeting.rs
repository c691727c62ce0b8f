//! Faces that meet outside common vertices and edges: one solid for every way to do so, and solids that come close.

use super::*;

pub(super) type Mesh = (Vec<Point>, Vec<Vec<u32>>);

pub(super) fn build((vertices, faces): Mesh) -> Result<Block, BlockError> {
    Block::new(vertices, faces, &exact())
}

/// The mesh turned by the rotation of the quaternion 1 + 2i + 3j + 5k: a fraction over 39, no multiple of 90°.
fn turned((vertices, faces): &Mesh) -> Mesh {
    let (w, x, y, z) = (1, 2, 3, 5);
    let rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ];
    let turn = |v: &Point| {
        let along = |row: [i64; 3]| {
            let terms = row.iter().zip(v.components()).map(|(&factor, c)| c.to_rational() * ratio(factor, 39));
            Number::from_rational(terms.fold(ratio(0, 1), |sum, term| sum + term))
        };
        Vec3::new(along(rows[0]), along(rows[1]), along(rows[2]))
    };
    (vertices.iter().map(turn).collect(), faces.clone())
}

/// Checks that the mesh, and the mesh turned, is refused for two faces that meet, and answers which.
fn meeting(mesh: Mesh) -> (usize, usize) {
    let found = |mesh: &Mesh| match build(mesh.clone()) {
        Err(BlockError::FacesMeet { first, second, .. }) => (first, second),
        other => panic!("{other:?}"),
    };
    let pair = found(&mesh);
    assert_eq!(found(&turned(&mesh)), pair);
    pair
}

/// Checks that the mesh, and the mesh turned, is a block, and answers it.
pub(super) fn accepted(mesh: Mesh) -> Block {
    build(turned(&mesh)).unwrap();
    build(mesh).unwrap()
}

/// The cube of side 4 with its top drawn in to an apex: a pit when below 4, through the floor when below 0.
fn cube_with_apex(apex: &str) -> Mesh {
    let mut vertices = points(&["0 0 0", "4 0 0", "4 4 0", "0 4 0", "0 0 4", "4 0 4", "4 4 4", "0 4 4"]);
    vertices.push(point(apex));
    let mut faces: Vec<Vec<u32>> = loops(&CUBE_FACES);
    faces.remove(1);
    faces.extend([[4, 5, 8], [5, 6, 8], [6, 7, 8], [7, 4, 8]].map(Vec::from));
    (vertices, faces)
}

#[test]
fn a_spike_through_the_opposite_wall_is_refused() {
    accepted(cube_with_apex("2 2 1"));
    accepted(cube_with_apex("2 2 1e-30"));
    assert_eq!(meeting(cube_with_apex("2 2 -1")), (5, 0));
    // Through a side, and off the middle of the floor by a hair.
    assert_eq!(meeting(cube_with_apex("5 2 1")), (5, 2));
    assert_eq!(meeting(cube_with_apex("1 3 -1e-30")), (5, 0));
}

#[test]
fn a_vertex_that_touches_a_face_or_an_edge_is_refused() {
    assert_eq!(meeting(cube_with_apex("2 2 0")), (5, 0));
    assert_eq!(meeting(cube_with_apex("1 3 0")), (5, 0));
    // Corners of a floor on the sides of a ceiling, and the other way round.
    meeting(cube_with_pits(["1", "2", "1", "2"], ["2", "3", "3/2", "3"], ["2", "2"]));
}

#[test]
fn the_error_says_what_meets_and_how_to_mend_it() {
    let error = build(cube_with_apex("2 2 -1")).unwrap_err();
    assert_eq!(error, BlockError::FacesMeet { first: 5, second: 0, p: 5, q: 8, diagonal: false });
    let text = error.to_string();
    assert!(text.contains("edge 5-8 of face 5 crosses or touches face 0"), "{text}");
    assert!(text.contains("may meet in vertices and edges of both only"), "{text}");
    assert!(text.contains("split the solid"), "{text}");
}

/// The cube of side 4 with a pit from above that ends in a ridge along x, and one from below with a ridge along y.
fn cube_with_ridges(upper: &str, lower: &str) -> Mesh {
    let mut vertices = cube_with_apex("0 0 9").0;
    vertices.pop();
    vertices.extend(points(&[&format!("1 2 {upper}"), &format!("3 2 {upper}")]));
    vertices.extend(points(&[&format!("2 1 {lower}"), &format!("2 3 {lower}")]));
    let mut faces = loops(&CUBE_FACES[2..]);
    faces.extend([vec![4, 5, 9, 8], vec![5, 6, 9], vec![6, 7, 8, 9], vec![7, 4, 8]]);
    faces.extend([vec![1, 0, 10], vec![2, 1, 10, 11], vec![3, 2, 11], vec![0, 3, 11, 10]]);
    (vertices, faces)
}

#[test]
fn an_edge_that_touches_another_in_its_middle_is_refused() {
    accepted(cube_with_ridges("5/2", "3/2"));
    accepted(cube_with_ridges("2000000001/1000000000", "2"));
    let pair = meeting(cube_with_ridges("2", "2"));
    assert_eq!(pair, (4, 9), "the ridges are sides of faces 4, 6 and 9, 11");
}

#[test]
fn an_edge_that_pierces_a_face_is_refused() {
    // No vertex touches anything: each ridge goes through both slopes of the other.
    assert_eq!(meeting(cube_with_ridges("2", "2000000001/1000000000")), (4, 9));
    assert_eq!(meeting(cube_with_ridges("3/2", "5/2")), (4, 9));
}

/// The cube of side 4 with a pit from above whose floor is the rectangle `upper` (x, X, y, Y) at the first height, and
/// one from below with the ceiling `lower` at the second.
fn cube_with_pits(upper: [&str; 4], lower: [&str; 4], heights: [&str; 2]) -> Mesh {
    let mut vertices = cube_with_apex("0 0 9").0;
    vertices.pop();
    for ([x, far_x, y, far_y], z) in [(upper, heights[0]), (lower, heights[1])] {
        let corners = [(x, y), (far_x, y), (far_x, far_y), (x, far_y)];
        vertices.extend(corners.map(|(x, y)| point(&format!("{x} {y} {z}"))));
    }
    let mut faces = loops(&CUBE_FACES[2..]);
    for k in 0..4 {
        let next = (k + 1) % 4;
        faces.push(vec![4 + k, 4 + next, 8 + next, 8 + k]);
        faces.push(vec![next, k, 12 + k, 12 + next]);
    }
    faces.extend([vec![8, 9, 10, 11], vec![15, 14, 13, 12]]);
    (vertices, faces)
}

#[test]
fn coplanar_faces_that_overlap_are_refused() {
    let pits =
        |lower: [&'static str; 4], heights: [&'static str; 2]| cube_with_pits(["1", "3", "1", "3"], lower, heights);
    let (within, across, beside) = (["3/2", "5/2", "3/2", "5/2"], ["2", "7/2", "2", "7/2"], ["2", "5/2", "1/2", "7/2"]);
    for lower in [within, across, beside] {
        accepted(pits(lower, ["3", "2"]));
        accepted(pits(lower, ["2.000000001", "2"]));
        meeting(pits(lower, ["2", "2"]));
        meeting(pits(lower, ["3/2", "2"]));
    }
    // Floor and ceiling one within the other: no edges touch, only the two faces.
    assert_eq!(meeting(pits(within, ["2", "2"])).1, 12);
    // In one plane and apart.
    let corner = ["1", "2", "1", "2"];
    accepted(cube_with_pits(corner, ["5/2", "7/2", "5/2", "7/2"], ["2", "2"]));
    accepted(cube_with_pits(corner, ["2.000000001", "3", "1", "3"], ["2", "2"]));
    // In one plane with one side on a part of another.
    meeting(cube_with_pits(corner, ["2", "3", "1/2", "3"], ["2", "2"]));
}

#[test]
fn shells_joined_at_a_vertex_or_an_edge_are_refused() {
    let tetrahedron = |[a, b, c, d]: [u32; 4]| [vec![a, c, b], vec![a, b, d], vec![b, c, d], vec![c, a, d]];
    let vertices = points(&["0 0 0", "1 0 0", "0 1 0", "0 0 1", "-1 0 0", "0 -1 0", "0 0 -1"]);
    let at_vertex = [tetrahedron([0, 1, 2, 3]), tetrahedron([0, 5, 4, 6])].concat();
    let error = build((vertices.clone(), at_vertex)).unwrap_err();
    assert_eq!(error, BlockError::Topology(TopologyError::NonManifoldVertex { vertex: 0 }));
    let at_edge = [tetrahedron([0, 1, 2, 3]), tetrahedron([0, 5, 4, 3])].concat();
    let error = build((vertices[..6].to_vec(), at_edge)).unwrap_err();
    assert!(matches!(error, BlockError::Topology(_)), "{error}");
}

/// A square ring of outer side 6 around a hole of side 2 whose rims are at these heights; outside it is 3 high.
pub(super) fn ring(upper: i32, lower: i32) -> Mesh {
    let square = |a: i32, b: i32, z: i32| [(a, a), (b, a), (b, b), (a, b)].map(|(x, y)| point(&format!("{x} {y} {z}")));
    let vertices = [square(0, 6, 0), square(0, 6, 3), square(2, 4, lower), square(2, 4, upper)].concat();
    let mut faces = Vec::new();
    for k in 0..4 {
        let next = (k + 1) % 4;
        faces.push(vec![k, next, 4 + next, 4 + k]);
        faces.push(vec![8 + next, 8 + k, 12 + k, 12 + next]);
        faces.push(vec![4 + k, 4 + next, 12 + next, 12 + k]);
        faces.push(vec![next, k, 8 + k, 8 + next]);
    }
    (vertices, faces)
}

#[test]
fn concave_thin_and_pierced_through_blocks_are_accepted() {
    accepted(prism(&L_SHAPE));
    // A notched block, a comb, and a U whose arms nearly close.
    accepted(prism(&[(0, 0), (6, 0), (6, 4), (4, 4), (3, 1), (2, 4), (0, 4)]));
    accepted(prism(&[(0, 0), (7, 0), (7, 3), (6, 3), (6, 1), (5, 1), (4, 3), (3, 1), (2, 1), (1, 3), (0, 3)]));
    accepted(prism(&[
        (0, 0),
        (99, 0),
        (99, 9),
        (50, 9),
        (50, 8),
        (98, 8),
        (98, 1),
        (1, 1),
        (1, 8),
        (49, 8),
        (49, 9),
        (0, 9),
    ]));
    // Straight angles, where a wall ends in the middle of another's edge.
    accepted(prism(&[(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]));
    let thin = Block::cuboid(&point("0 0 0"), &point("1 1 1e-40")).unwrap();
    let numbers = |face: &Vec<VertexId>| face.iter().map(|v| v.0).collect();
    accepted((thin.vertices().to_vec(), thin.topology().faces().iter().map(numbers).collect()));
    let torus = accepted(ring(4, -1));
    assert_eq!((torus.vertices().len(), torus.topology().edges().len(), torus.topology().faces().len()), (16, 32, 16));
    accepted(ring(2, 1));
    // Without thickness at the hole, and with the slopes through one another.
    assert!(matches!(build(ring(1, 1)), Err(BlockError::RepeatedVertex { .. })));
    meeting(ring(1, 2));
}

/// Two apexes over a five-pointed star: all edges are convex, and the Euler characteristic is that of a convex body.
#[test]
fn a_surface_that_winds_twice_is_refused() {
    let star = ["0 -10", "6 8", "-10 -3", "10 -3", "-6 8"];
    let mut vertices: Vec<Point> = star.iter().map(|at| point(&format!("{at} 0"))).collect();
    vertices.extend(points(&["0 0 5", "0 0 -5"]));
    let faces = (0..5).flat_map(|k| [vec![k, (k + 1) % 5, 5], vec![(k + 1) % 5, k, 6]]).collect();
    meeting((vertices, faces));
}

/// Rounded coordinates bend the faces of turned blocks; within the planarity allowed the answers stay.
#[test]
fn rounded_blocks_are_told_apart_alike() {
    let options = BlockOptions { planarity: number("1e-6") };
    let rounded = |mesh: Mesh| {
        let (mut vertices, faces) = turned(&mesh);
        for v in &mut vertices {
            *v = v.map(|c| Number::from_f64(c.rounded(Precision::F32).unwrap()).unwrap());
        }
        Block::new(vertices, faces, &options)
    };
    let [high, low] = ["2.001", "2"];
    let pits = |heights: [&'static str; 2]| cube_with_pits(["1", "3", "1", "3"], ["2", "7/2", "2", "7/2"], heights);
    for mesh in [ring(4, -1), ring(2, 1), prism(&L_SHAPE), cube_with_ridges(high, low), pits([high, low])] {
        let bent = rounded(mesh).unwrap();
        let exactly = Block::new(bent.vertices().to_vec(), bent.topology().faces().to_vec(), &exact());
        assert!(matches!(exactly, Err(BlockError::NotPlanar { .. })), "the test needs bent faces");
    }
    for mesh in [ring(1, 2), cube_with_apex("2 2 -1"), cube_with_ridges(low, high), pits([low, high])] {
        assert!(matches!(rounded(mesh), Err(BlockError::FacesMeet { .. })));
    }
}
