//! Faces that meet outside common vertices and edges: one solid for every way to do so, and solids that come close.

use super::*;

type Mesh = (Vec<Point>, Vec<Vec<u32>>);

fn build((vertices, faces): Mesh) -> Result<Block, BlockError> {
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
fn accepted(mesh: Mesh) -> Block {
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
fn ring(upper: i32, lower: i32) -> Mesh {
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
    accepted((thin.vertices().to_vec(), thin.topology().faces().to_vec()));
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

/// An octahedron whose faces are cut into `parts²` triangles: directions, and loops.
fn octahedron(parts: i32) -> (Vec<[i32; 3]>, Vec<Vec<u32>>) {
    let mut numbers = std::collections::BTreeMap::new();
    let mut faces = Vec::new();
    for signs in 0..8 {
        let [sx, sy, sz] = [1, 2, 4].map(|bit| if signs & bit == 0 { 1 } else { -1 });
        let mut at = |i: i32, j: i32| {
            let next = numbers.len() as u32;
            *numbers.entry([sx * i, sy * j, sz * (parts - i - j)]).or_insert(next)
        };
        for i in 0..parts {
            for j in 0..parts - i {
                let mut triangles = vec![vec![at(i, j), at(i + 1, j), at(i, j + 1)]];
                if i + j + 2 <= parts {
                    triangles.push(vec![at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
                if sx * sy * sz < 0 {
                    triangles.iter_mut().for_each(|t| t.reverse());
                }
                faces.extend(triangles);
            }
        }
    }
    let mut directions = vec![[0; 3]; numbers.len()];
    numbers.into_iter().for_each(|(direction, number)| directions[number as usize] = direction);
    (directions, faces)
}

/// The corners of the common part of two triangles, by clipping one with the planes of the other, in fractions.
fn common_part(triangle: &[Vec3<BigRational>], other: &[Vec3<BigRational>]) -> Vec<Vec3<BigRational>> {
    let normal = other[1].minus(&other[0]).cross(&other[2].minus(&other[0]));
    let mut planes = vec![(normal.clone(), 0), (normal.negated(), 0)];
    planes.extend((0..3).map(|k| (normal.cross(&other[(k + 1) % 3].minus(&other[k])), k)));
    let mut part = triangle.to_vec();
    for (inward, k) in planes {
        let height = |v: &Vec3<BigRational>| inward.dot(&v.minus(&other[k]));
        let mut clipped = Vec::new();
        for (i, v) in part.iter().enumerate() {
            let w = &part[(i + 1) % part.len()];
            let (at_v, at_w) = (height(v), height(w));
            if !at_v.is_negative() {
                clipped.push(v.clone());
            }
            if at_v.is_positive() && at_w.is_negative() || at_v.is_negative() && at_w.is_positive() {
                clipped.push(v.plus(&w.minus(v).scaled(&(&at_v / (&at_v - &at_w)))));
            }
        }
        part = clipped;
    }
    part
}

/// Whether the triangles have common points other than those of their common corners and of the line between two.
fn runs_through_itself((vertices, faces): &Mesh) -> bool {
    let places: Vec<Vec3<BigRational>> = vertices.iter().map(|v| v.map(Number::to_rational)).collect();
    let corners = |face: &Vec<u32>| face.iter().map(|&v| places[v as usize].clone()).collect::<Vec<_>>();
    let is_allowed = |place: &Vec3<BigRational>, shared: &[&Vec3<BigRational>]| match shared {
        [a] => place == *a,
        [a, b] => {
            let (to_a, to_b) = (a.minus(place), b.minus(place));
            to_a.cross(&to_b).norm_squared().is_zero() && !to_a.dot(&to_b).is_positive()
        }
        _ => false,
    };
    faces.iter().enumerate().any(|(i, f)| {
        faces[..i].iter().any(|g| {
            let shared: Vec<_> = f.iter().filter(|v| g.contains(v)).map(|&v| &places[v as usize]).collect();
            common_part(&corners(f), &corners(g)).iter().any(|place| !is_allowed(place, &shared))
        })
    })
}

#[test]
fn small_grids_agree_with_clipping() {
    // Octahedra with corners on a grid of 4³ points are full of ties; both answers must be frequent.
    let mut seed = 7_u64;
    let mut random = |below: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % below
    };
    let faces = octahedron(1).1;
    let (mut whole, mut pierced) = (0, 0);
    for _ in 0..20_000 {
        let vertices: Vec<Point> = (0..6)
            .map(|_| Vec3::new(random(4), random(4), random(4)).map(|&c| Number::from_integer(c as i32)))
            .collect();
        let mesh = (vertices, faces.clone());
        let expected = match build(mesh.clone()) {
            Ok(_) => false,
            Err(BlockError::FacesMeet { .. }) => true,
            Err(_) => continue,
        };
        *(if expected { &mut pierced } else { &mut whole }) += 1;
        assert_eq!(runs_through_itself(&mesh), expected, "{mesh:?}");
    }
    assert!(whole > 200 && pierced > 200, "{whole} blocks, {pierced} refused");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Every surface that each ray from the origin meets once is accepted, however jagged.
    #[test]
    fn star_shaped_blocks_are_accepted(radii in prop::collection::vec(1_i32..1_000_000, 38)) {
        let (directions, faces) = octahedron(3);
        prop_assert_eq!(directions.len(), 38);
        let vertices = directions.iter().zip(&radii).map(|(direction, &radius)| {
            let [x, y, z] = direction.map(|c| Number::from_integer(c * radius));
            Vec3::new(x, y, z)
        });
        let block = accepted((vertices.collect(), faces));
        prop_assert!(block.topology().faces().len() > 60);
    }
}

/// Prints how long it takes to build blocks of 12, 200 and 2,000 faces: `cargo test -- --ignored --nocapture times`.
#[test]
#[ignore = "a measurement"]
fn building_times() {
    let jagged = |parts: i32, spread: u64| {
        let (directions, faces) = octahedron(parts);
        let place = |(k, d): (usize, &[i32; 3])| {
            let length = d.iter().map(|&c| f64::from(c * c)).sum::<f64>().sqrt();
            let radius = 1.0 + ((k as u64 * 7919) % 1000 * spread) as f64 * 1e-4;
            let [x, y, z] = d.map(|c| Number::from_f64(f64::from(c) / length * radius).unwrap());
            Vec3::new(x, y, z)
        };
        (directions.iter().enumerate().map(place).collect::<Vec<Point>>(), faces)
    };
    let round = |sides: i32| {
        let corner = |k: i32| {
            let angle = f64::from(k) / f64::from(sides) * std::f64::consts::TAU;
            (angle.cos(), angle.sin())
        };
        let level = |z: f64| {
            let at = move |v: f64| Number::from_f64(v).unwrap();
            (0..sides).map(move |k| Vec3::new(at(corner(k).0), at(corner(k).1), at(z)))
        };
        let faces = prism(&vec![(0, 0); sides as usize]).1;
        (level(0.0).chain(level(1.0)).collect::<Vec<Point>>(), faces)
    };
    let cuboid = cuboid_mesh(&point("0.1 0.2 0.3"), &point("1.7 1/3 0.7"));
    let meshes = [
        ("cuboid", cuboid),
        ("prism of 12 faces", round(10)),
        ("prism of 200 faces", round(198)),
        ("prism of 2000 faces", round(1998)),
        ("jagged, 8 faces", jagged(1, 2)),
        ("convex, 200 faces", jagged(5, 0)),
        ("jagged, 200 faces", jagged(5, 2)),
        ("convex, 2048 faces", jagged(16, 0)),
        ("jagged, 2048 faces", jagged(16, 2)),
        ("notched", prism(&[(0, 0), (6, 0), (6, 4), (4, 4), (3, 1), (2, 4), (0, 4)])),
        ("comb of 202 faces", prism(&comb(100))),
        ("torus", ring(4, -1)),
    ];
    for (name, mesh) in meshes {
        let faces = mesh.1.len();
        let repeats = (4000 / faces).max(3);
        let start = std::time::Instant::now();
        for _ in 0..repeats {
            Block::new(mesh.0.clone(), mesh.1.clone(), &BlockOptions::default()).unwrap();
        }
        println!("{name:20} {faces:5} faces {:9.3} ms", start.elapsed().as_secs_f64() * 1e3 / repeats as f64);
    }
}

/// A polygon of `teeth` teeth.
fn comb(teeth: i32) -> Vec<(i32, i32)> {
    let mut outline = vec![(0, 0), (2 * teeth - 1, 0)];
    outline.extend((0..2 * teeth).rev().map(|x| (x, if x % 2 == 0 { 9 } else { 1 })));
    outline
}
