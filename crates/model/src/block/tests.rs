//! Blocks with known answers, every error, and the filtered signs against plain fractions.

// Longer than 400 lines: every error of a block, one after another.

mod meeting;
mod random_surfaces;

use super::*;
use crate::TopologyError;
use crate::number_text::EXPONENT_LIMIT;
use crate::sign::Sign;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;

fn number(text: &str) -> Number {
    Number::parse(text).unwrap()
}

fn point(text: &str) -> Point {
    let parts: Vec<Number> = text.split_ascii_whitespace().map(number).collect();
    Vec3::new(parts[0].clone(), parts[1].clone(), parts[2].clone())
}

fn points(all: &[&str]) -> Vec<Point> {
    all.iter().map(|p| point(p)).collect()
}

fn exact() -> BlockOptions {
    BlockOptions { planarity: Number::ZERO }
}

const CUBE: [&str; 8] = ["0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "1 0 1", "1 1 1", "0 1 1"];
const CUBE_FACES: [&[u32]; 6] =
    [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];

fn loops(faces: &[&[u32]]) -> Vec<Vec<u32>> {
    faces.iter().map(|f| f.to_vec()).collect()
}

fn fan(faces: &[&[u32]]) -> Vec<Vec<u32>> {
    faces.iter().flat_map(|f| f[1..].windows(2).map(|w| vec![f[0], w[0], w[1]]).collect::<Vec<_>>()).collect()
}

/// A prism over a polygon given counter-clockwise, from z = 0 to z = 1.
fn prism(outline: &[(i32, i32)]) -> (Vec<Point>, Vec<Vec<u32>>) {
    let n = outline.len() as u32;
    let level = |z: i32| outline.iter().map(move |&(x, y)| point(&format!("{x} {y} {z}")));
    let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]));
    (level(0).chain(level(1)).collect(), faces)
}

const L_SHAPE: [(i32, i32); 6] = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)];

fn error(vertices: Vec<Point>, faces: Vec<Vec<u32>>) -> BlockError {
    Block::new(vertices, faces, &exact()).unwrap_err()
}

fn ratio(numerator: i64, denominator: i64) -> BigRational {
    BigRational::new(numerator.into(), denominator.into())
}

#[test]
fn a_cuboid_is_measured_exactly() {
    let block = Block::cuboid(&point("1/3 -1 0"), &point("2/3 1 0.1")).unwrap();
    assert!(block.is_convex());
    assert_eq!(block.topology().edges().len(), 12);
    assert_eq!(block.volume(), ratio(1, 15));
    assert_eq!(block.centroid(), Vec3::new(ratio(1, 2), ratio(0, 1), ratio(1, 20)));
    let bounds = block.bounds();
    assert_eq!((bounds.min.x, bounds.max.z), (&number("1/3"), &number("0.1")));
    assert!(matches!(Block::cuboid(&point("0 0 0"), &point("1 0 1")), Err(BlockError::RepeatedVertex { .. })));
    assert!(matches!(Block::cuboid(&point("0 0 0"), &point("1 1 -1")), Err(BlockError::NotPositiveVolume { .. })));
}

#[test]
fn an_l_shaped_prism_has_one_reflex_edge() {
    let (vertices, faces) = prism(&L_SHAPE);
    let block = Block::new(vertices, faces, &exact()).unwrap();
    let topology = block.topology();
    let reflex: Vec<_> = topology.edge_ids().filter(|&e| !block.edge_is_convex(e)).map(|e| topology.edge(e)).collect();
    assert_eq!(reflex.iter().map(|e| (e.p.0, e.q.0)).collect::<Vec<_>>(), [(3, 9)]);
    assert!(
        !block.vertex_is_convex(VertexId(3))
            && !block.vertex_is_convex(VertexId(9))
            && block.vertex_is_convex(VertexId(2))
    );
    assert!(!block.face_is_convex(FaceId(0)) && block.face_is_convex(FaceId(2)));
    assert_eq!(block.volume(), ratio(4, 1));
    // By halves: 3 × 1 around (3/2, 1/2) and 1 × 1 around (1/2, 3/2).
    assert_eq!(block.centroid(), Vec3::new(ratio(5, 4), ratio(3, 4), ratio(1, 2)));
}

#[test]
fn triangles_become_faces_again() {
    let (block, merged) = Block::merged(points(&CUBE), fan(&CUBE_FACES), &exact(), Merging::Exact).unwrap();
    assert_eq!(merged, Merged { faces: 6, vertices: 0 });
    assert_eq!(block.topology().faces().len(), 6);
    assert!(block.is_convex());

    // The caps of the L by hand: a fan would leave the concave polygon.
    let (vertices, faces) = prism(&L_SHAPE);
    let mut triangles: Vec<Vec<u32>> = vec![vec![0, 3, 1], vec![1, 3, 2], vec![0, 5, 3], vec![3, 5, 4]];
    triangles.extend([vec![6, 7, 9], vec![7, 8, 9], vec![6, 9, 11], vec![9, 10, 11]]);
    let sides: Vec<&[u32]> = faces[2..].iter().map(Vec::as_slice).collect();
    triangles.extend(fan(&sides));
    let (block, merged) = Block::merged(vertices.clone(), triangles, &exact(), Merging::Exact).unwrap();
    assert_eq!(merged, Merged { faces: 12, vertices: 0 });
    let whole = Block::new(vertices, faces, &exact()).unwrap();
    assert_eq!(block.volume(), whole.volume());
    let sorted = |block: &Block| {
        let mut faces = block.topology().faces().to_vec();
        for face in &mut faces {
            let least = (0..face.len()).min_by_key(|&i| face[i]).unwrap_or(0);
            face.rotate_left(least);
        }
        faces.sort();
        faces
    };
    assert_eq!(sorted(&block), sorted(&whole));
}

#[test]
fn vertices_inside_faces_and_edges_go() {
    // The cube with the centre of its bottom, and the middles of two edges: at the top front and of x = y = 0.
    let mut vertices = points(&CUBE);
    vertices.extend(points(&["1/2 1/2 0", "1/2 0 1", "0 0 1/3"]));
    let faces: [&[u32]; 9] = [
        &[8, 3, 2],
        &[8, 2, 1],
        &[8, 1, 0],
        &[8, 0, 3],
        &[4, 9, 5, 6, 7],
        &[0, 1, 5, 9, 4, 10],
        &[1, 2, 6, 5],
        &[2, 3, 7, 6],
        &[3, 0, 10, 4, 7],
    ];
    let (block, merged) = Block::merged(vertices, loops(&faces), &exact(), Merging::Exact).unwrap();
    assert_eq!(merged, Merged { faces: 3, vertices: 3 });
    assert_eq!(block.vertices(), points(&CUBE));
    assert_eq!((block.topology().edges().len(), block.topology().faces().len()), (12, 6));
    // The merged face stands where its first part stood, the others keep their order.
    assert_eq!(block.topology().faces()[5].len(), 4);
    assert!(block.topology().faces()[0].iter().all(|&v| v < VertexId(4)));
}

#[test]
fn near_flat_triangles_merge_only_when_asked() {
    let mut vertices = points(&CUBE);
    vertices[6] = point("1 1 1.0000000001");
    let options = BlockOptions { planarity: number("1e-9") };
    let (block, merged) = Block::merged(vertices.clone(), fan(&CUBE_FACES), &options, Merging::Exact).unwrap();
    // The four faces at the moved corner stay in plane along two axes; top is the only one bent.
    assert_eq!((block.topology().faces().len(), merged.faces), (7, 5));
    let (block, merged) =
        Block::merged(vertices.clone(), fan(&CUBE_FACES), &options, Merging::WithinPlanarity).unwrap();
    assert_eq!((block.topology().faces().len(), merged.faces), (6, 6));
    // Bent further than allowed, the two triangles remain.
    vertices[6] = point("1 1 1.00001");
    let (block, _) = Block::merged(vertices, fan(&CUBE_FACES), &options, Merging::WithinPlanarity).unwrap();
    assert_eq!(block.topology().faces().len(), 7);
}

/// The sides of a plate reach as far from the plane of its top as it is thick.
#[test]
fn faces_may_merge_within_just_the_distance_of_a_neighbour() {
    for (size, low, thickness) in [
        ("1", "0", "1e-3"),
        ("1", "1e6", "1/1024"),
        ("1e-20", "0", "1e-28"),
        ("1e20", "1e20", "1e18"),
        ("3/7", "1/3", "1/700"),
    ] {
        let [size, low, thickness] = [size, low, thickness].map(|text| number(text).to_rational());
        let corner = |side: &BigRational, height: &BigRational| {
            let [side, height] = [&low + side, &low + height].map(Number::from_rational);
            Vec3::new(side.clone(), side, height)
        };
        let zero = BigRational::zero();
        let plate = Block::cuboid(&corner(&zero, &zero), &corner(&size, &thickness)).unwrap();
        let may = |share: &str| {
            let planarity = &thickness / &size * number(share).to_rational();
            plate.may_merge_within(&Number::from_rational(planarity))
        };
        assert_eq!(
            (may("1"), may("1000001/1000000"), may("999/1000"), may("0")),
            (true, true, false, false),
            "{plate:?}"
        );
    }
}

#[test]
fn a_nearly_straight_edge_loses_its_vertex_only_when_asked() {
    let mut vertices = points(&CUBE);
    vertices.push(point("1/2 1e-12 1"));
    let faces: [&[u32]; 6] =
        [&[0, 3, 2, 1], &[4, 8, 5, 6, 7], &[0, 1, 5, 8, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
    let options = BlockOptions::default();
    let (block, merged) = Block::merged(vertices.clone(), loops(&faces), &options, Merging::WithinPlanarity).unwrap();
    assert_eq!((block.vertices().len(), merged.vertices), (8, 1));
    let error = Block::new(vertices, loops(&faces), &options).unwrap_err();
    assert_eq!(error, BlockError::TwoEdgeVertex { vertex: 8, before: 4, after: 5 });
}

#[test]
fn planarity_is_compared_exactly() {
    // The top's corners at heights 1, 1, 1 + 4t, 1: N is (−4t, −4t, 2) up to scale, the mean height 1 + t.
    let with = |t: &str| {
        let mut vertices = points(&CUBE);
        vertices[6] = point(&format!("1 1 {t}"));
        vertices
    };
    // Every corner is t/√(1 + 8t²) off the plane, over a size of 1 + 4t: with t = 1/16 about 1/20.31.
    let build = |height: &str, planarity: &str| {
        Block::new(with(height), loops(&CUBE_FACES), &BlockOptions { planarity: number(planarity) })
    };
    assert!(build("5/4", "100/2031").is_ok());
    let error = build("5/4", "100/2032").unwrap_err();
    assert!(matches!(error, BlockError::NotPlanar { face: 1, .. }), "{error}");
}

#[test]
fn a_tie_in_planarity_is_planar() {
    // A square face (±1, ±1, ±h) with opposite corners up and down: N is along z and every corner is h off the plane.
    let h = "1e-3";
    let vertices =
        points(&["-1 -1 -1", "1 -1 -1", "1 1 -1", "-1 1 -1", "-1 -1 1e-3", "1 -1 -1e-3", "1 1 1e-3", "-1 1 -1e-3"]);
    let build = |planarity: &str| {
        Block::new(vertices.clone(), loops(&CUBE_FACES), &BlockOptions { planarity: number(planarity) })
    };
    assert_eq!(number(h), number("1/1000"));
    // The box is 2 long.
    assert!(build("1/2000").is_ok());
    let error = build("1/2001").unwrap_err();
    let BlockError::NotPlanar { face: 1, vertices: furthest, .. } = &error else { panic!("{error}") };
    assert_eq!(*furthest, [4, 5, 6, 7], "none of four corners is further than the others");
    // Of five corners the one pulled up is.
    let mut five =
        points(&["0 0 0", "2 0 0", "3 1 0", "1 2 0", "0 1 0", "0 0 1", "2 0 1", "3 1 1", "1 2 1.1", "0 1 1"]);
    let prism: Vec<Vec<u32>> = vec![
        vec![4, 3, 2, 1, 0],
        vec![5, 6, 7, 8, 9],
        vec![0, 1, 6, 5],
        vec![1, 2, 7, 6],
        vec![2, 3, 8, 7],
        vec![3, 4, 9, 8],
        vec![4, 0, 5, 9],
    ];
    let said = Block::new(five.clone(), prism.clone(), &BlockOptions::default()).unwrap_err().to_string();
    assert!(said.starts_with("face 1 is not planar: vertex 8 is "), "{said}");
    five[8] = points(&["1 2 1"])[0].clone();
    assert!(Block::new(five, prism, &BlockOptions::default()).is_ok());
    // Of six corners, alike across the middle, four are equally far from the plane and two lie in it.
    let outline = ["2 0", "1 2", "-1 2", "-2 0", "-1 -2", "1 -2"];
    let top = ["1.1", "0.9", "1", "1.1", "0.9", "1"];
    let six: Vec<String> = outline.iter().map(|at| format!("{at} 0")).collect();
    let six = six.into_iter().chain(outline.iter().zip(top).map(|(at, z)| format!("{at} {z}")));
    let six: Vec<String> = six.collect();
    let six = points(&six.iter().map(String::as_str).collect::<Vec<_>>());
    let sides = (0..6).map(|i| vec![i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i]);
    let prism: Vec<Vec<u32>> =
        [(0..6).rev().collect(), (6..12).collect::<Vec<u32>>()].into_iter().chain(sides).collect();
    let said = Block::new(six, prism, &BlockOptions::default()).unwrap_err().to_string();
    assert!(said.starts_with("face 1 is not planar: vertices 6, 7, 9, 10 are "), "{said}");
    assert!(build("0").is_err());
}

#[test]
fn every_error_names_its_place() {
    let mut vertices = points(&CUBE);
    vertices.push(point("2 2 2"));
    assert!(matches!(
        error(vertices, loops(&CUBE_FACES)),
        BlockError::Topology(TopologyError::UnusedVertex { vertex: 8 })
    ));

    let mut vertices = points(&CUBE);
    vertices[5] = vertices[2].clone();
    assert!(matches!(error(vertices, loops(&CUBE_FACES)), BlockError::RepeatedVertex { first: 2, second: 5, .. }));

    let open = loops(&CUBE_FACES[..5]);
    assert!(matches!(error(points(&CUBE), open), BlockError::Topology(TopologyError::Open { .. })));

    let mut turned = loops(&CUBE_FACES);
    turned[1].reverse();
    assert!(matches!(error(points(&CUBE), turned), BlockError::Topology(TopologyError::SameDirection { .. })));

    let inside_out: Vec<Vec<u32>> = CUBE_FACES.iter().map(|f| f.iter().rev().copied().collect()).collect();
    assert_eq!(error(points(&CUBE), inside_out), BlockError::NotPositiveVolume { volume: -1.0 });

    let mut vertices = points(&CUBE);
    vertices[6].z = number("2");
    let crooked = error(vertices, loops(&CUBE_FACES));
    assert!(matches!(crooked, BlockError::NotPlanar { face: 1, .. }), "{crooked}");

    let mut vertices = points(&CUBE);
    vertices[0].x = number(&format!("1e{EXPONENT_LIMIT}"));
    assert_eq!(error(vertices, loops(&CUBE_FACES)), BlockError::Overflow { vertex: 0 });

    let mut far = points(&CUBE);
    far.extend(CUBE.iter().map(|p| point(&p.replace('0', "5").replace('1', "6"))));
    let shifted = CUBE_FACES.iter().map(|f| f.iter().map(|v| v + 8).collect());
    let faces: Vec<Vec<u32>> = loops(&CUBE_FACES).into_iter().chain(shifted).collect();
    assert!(matches!(error(far, faces), BlockError::Topology(TopologyError::Disconnected { face: 6 })));
}

#[test]
fn loops_that_cross_or_touch_themselves_are_no_faces() {
    // Twisted: the cap's loop crosses itself, with an area left over.
    let (vertices, faces) = prism(&[(0, 0), (4, 0), (4, 4), (2, -1), (0, 4)]);
    let crossing = error(vertices, faces);
    assert!(matches!(crossing, BlockError::SelfIntersecting { face: 0, .. }), "{crossing}");
    // A corner that touches the opposite side.
    let (vertices, faces) = prism(&[(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)]);
    let touching = error(vertices, faces);
    assert!(matches!(touching, BlockError::SelfIntersecting { face: 0, .. }), "{touching}");
    // A pentagram turns left everywhere.
    let (vertices, faces) = prism(&[(0, -10), (6, 8), (-10, -3), (10, -3), (-6, 8)]);
    let star = error(vertices, faces);
    assert!(matches!(star, BlockError::SelfIntersecting { face: 0, .. }), "{star}");
    // A spike of no width folds back along its own edge.
    let (vertices, faces) = prism(&[(0, 0), (4, 0), (6, 0), (4, 0)]);
    assert!(matches!(error(vertices, faces), BlockError::RepeatedVertex { .. }));
    let (vertices, faces) = prism(&[(0, 0), (6, 0), (4, 0), (4, 4)]);
    let spike = error(vertices, faces);
    assert!(matches!(spike, BlockError::SelfIntersecting { face: 0, .. }), "{spike}");
    // A long comb is simple.
    let mut comb: Vec<(i32, i32)> = (0..40).rev().map(|i| (i, if i % 2 == 0 { 9 } else { 1 })).collect();
    comb.insert(0, (39, 0));
    comb.insert(0, (0, 0));
    let (vertices, faces) = prism(&comb);
    assert!(Block::new(vertices, faces, &exact()).is_ok());
}

#[test]
fn flat_and_folded_surfaces_are_no_blocks() {
    // A tetrahedron with its tip in the base.
    let vertices = points(&["0 0 0", "4 0 0", "0 4 0", "1 1 0"]);
    let flat = error(vertices, vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]]);
    assert!(matches!(flat, BlockError::NotPositiveVolume { .. }), "{flat}");

    // A box with a fin of no thickness: a flap out and back.
    let mut vertices = points(&CUBE);
    vertices.extend(points(&["2 0 1/2"]));
    let faces: [&[u32]; 8] = [
        &[0, 3, 2, 1],
        &[4, 5, 6, 7],
        &[0, 1, 5, 4],
        &[1, 8, 5],
        &[1, 2, 6, 5],
        &[2, 3, 7, 6],
        &[3, 0, 4, 7],
        &[1, 5, 8],
    ];
    let folded = error(vertices, loops(&faces));
    assert!(matches!(folded, BlockError::Topology(_) | BlockError::FoldedEdge { .. }), "{folded}");
}

/// A square plate with a square pillar on it: the plate's top is a ring.
fn plate_with_pillar() -> (Vec<Point>, Vec<Vec<u32>>) {
    let square = |a: i32, b: i32, z: i32| [(a, a), (b, a), (b, b), (a, b)].map(|(x, y)| point(&format!("{x} {y} {z}")));
    let vertices = [square(0, 3, 0), square(0, 3, 1), square(1, 2, 1), square(1, 2, 2)].concat();
    let mut faces: Vec<Vec<u32>> = vec![vec![0, 3, 2, 1]];
    for low in [0, 8] {
        faces.extend((0..4).map(|i| vec![low + i, low + (i + 1) % 4, low + 4 + (i + 1) % 4, low + 4 + i]));
    }
    faces.push(vec![12, 13, 14, 15]);
    faces.extend((0..4).map(|i| vec![4 + i, 4 + (i + 1) % 4, 8 + (i + 1) % 4, 8 + i]));
    (vertices, faces)
}

#[test]
fn a_ring_is_not_a_face() {
    let (vertices, faces) = plate_with_pillar();
    assert_eq!(error(vertices, faces), BlockError::FaceWithHole { face: 10, count: 4 });
}

/// The great dodecahedron: every vertex of an icosahedron's five neighbours make a face; all edges are convex.
#[test]
fn a_convex_surface_that_runs_through_itself_is_no_block() {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut corners: Vec<[f64; 3]> = Vec::new();
    for (one, other) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        corners.extend([[0.0, one, other], [one, other, 0.0], [other, 0.0, one]]);
    }
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    // Neighbours are 2 apart, so their product is that of φ.
    let are_neighbours = |a: usize, b: usize| (dot(corners[a], corners[b]) - golden).abs() < 1e-6;
    let pentagon = |top: usize| {
        let ring: Vec<usize> = (0..12).filter(|&v| are_neighbours(top, v)).collect();
        let mut face = vec![ring[0]];
        while face.len() < 5 {
            let last = face[face.len() - 1];
            let follows =
                |&&v: &&usize| are_neighbours(last, v) && dot(cross(corners[last], corners[v]), corners[top]) > 0.0;
            face.push(*ring.iter().find(follows).unwrap());
        }
        face.into_iter().map(|v| v as u32).collect::<Vec<u32>>()
    };
    let faces: Vec<Vec<u32>> = (0..12).map(pentagon).collect();
    let float = |v: f64| Number::from_f64(v).unwrap();
    let vertices = corners.iter().map(|&[x, y, z]| Vec3::new(float(x), float(y), float(z))).collect();
    let error = Block::new(vertices, faces, &BlockOptions::default()).unwrap_err();
    assert_eq!(error, BlockError::RunsThroughItself { edges: 30, euler: -6 });
}

#[test]
fn moving_and_rounding_keep_the_flags() {
    let (vertices, faces) = prism(&L_SHAPE);
    let block = Block::new(vertices, faces, &exact()).unwrap();
    let moved = block.translated(&point("1/3 1e9 0"));
    assert_eq!(moved.volume(), block.volume());
    assert!(!moved.is_exact_in(Precision::F64));
    let rounded = moved.rounded(Precision::F32).unwrap();
    assert!(rounded.is_exact_in(Precision::F32));
    assert!((0..18).all(|e| rounded.edge_is_convex(EdgeId(e)) == block.edge_is_convex(EdgeId(e))));
}

/// κ in plain fractions, from SPEC section 2.
fn plain_kappa(block: &Block, edge: u32) -> BigRational {
    let points: Vec<Vec3<BigRational>> = block.vertices().iter().map(|v| v.map(Number::to_rational)).collect();
    let topology = block.topology();
    let e = topology.edges()[edge as usize];
    let normal = |f: u32| face_normal(&points, &topology.faces()[f as usize]);
    normal(e.left.0).cross(&normal(e.right.0)).dot(&points[e.q.index()].minus(&points[e.p.index()]))
}

/// Coordinates of every size the filter meets: small integers, full mantissas, far offsets, fractions, extremes.
fn coordinate() -> impl Strategy<Value = Number> {
    prop_oneof![
        (-4_i32..4).prop_map(Number::from_integer),
        (-1.0_f64..1.0).prop_map(|v| Number::from_f64(v).unwrap()),
        (-4_i32..4, -2_i32..2).prop_map(|(a, ulps)| {
            let near = f64::from(a) + 1.0;
            Number::from_f64(f64::from_bits((near.to_bits() as i64 + i64::from(ulps)) as u64)).unwrap_or(Number::ZERO)
        }),
        (-9_i64..9, 1_i64..9).prop_map(|(n, d)| Number::from_rational(ratio(n, d))),
        (-4_i32..4).prop_map(|v| Number::from_f64(f64::from(v) * 1e-40).unwrap()),
        (-4_i32..4).prop_map(|v| Number::from_f64(1e12 + f64::from(v)).unwrap()),
    ]
}

fn any_point() -> impl Strategy<Value = Point> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn a_tetrahedron_is_a_block_exactly_when_its_volume_is_positive(vertices in prop::collection::vec(any_point(), 4)) {
        let p: Vec<Vec3<BigRational>> = vertices.iter().map(|v| v.map(Number::to_rational)).collect();
        let edges = [1, 2, 3].map(|i: usize| p[i].minus(&p[0]));
        let six_volumes = edges[0].dot(&edges[1].cross(&edges[2]));
        let faces = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]];
        match Block::new(vertices, faces, &exact()) {
            Ok(block) => {
                prop_assert!(six_volumes.is_positive());
                prop_assert!(block.is_convex());
                prop_assert_eq!(block.volume() * BigRational::from_integer(6.into()), six_volumes);
            }
            Err(error) => prop_assert!(!six_volumes.is_positive(), "{error}"),
        }
    }

    /// An octahedron's twelve edges under any displacement of its vertices that leaves it a block.
    #[test]
    fn flags_are_the_signs_of_plain_fractions(nudges in prop::collection::vec(any_point(), 6), scale in 0_u32..60) {
        let shrink = Number::from_f64(1.0 / (1_u64 << scale) as f64).unwrap();
        let base = ["4 0 0", "-4 0 0", "0 4 0", "0 -4 0", "0 0 4", "0 0 -4"];
        let vertices: Vec<Point> = base.iter().zip(&nudges).map(|(b, n)| {
            let b = point(b);
            let add = |b: &Number, n: &Number| b.plus(&n.times(&shrink));
            Vec3::new(add(&b.x, &n.x), add(&b.y, &n.y), add(&b.z, &n.z))
        }).collect();
        let faces = vec![
            vec![0, 2, 4], vec![2, 1, 4], vec![1, 3, 4], vec![3, 0, 4],
            vec![2, 0, 5], vec![1, 2, 5], vec![3, 1, 5], vec![0, 3, 5],
        ];
        if let Ok((block, merged)) = Block::merged(vertices, faces, &exact(), Merging::Exact) {
            for edge in 0..block.topology().edges().len() as u32 {
                let kappa = plain_kappa(&block, edge);
                prop_assert!(!kappa.is_zero());
                prop_assert_eq!(block.edge_is_convex(EdgeId(edge)), kappa.is_positive());
            }
            prop_assert!(block.topology().faces().len() + merged.faces == 8);
        }
    }
}

/// The filter must be seen undecided, and both exact stages used, or the tests above show nothing.
#[test]
fn ties_and_near_ties_reach_the_exact_stages() {
    use certain_sign::{Coordinates, Surface};
    use polynomials::EdgeConvexity;
    let ask = |vertices: &[Point]| {
        let approximate: Vec<[f64; 3]> = vertices.iter().map(|v| v.components().map(|c| c.approximate())).collect();
        let coordinates = Coordinates::new(vertices, &approximate);
        let numbered = |face: Vec<u32>| face.into_iter().map(VertexId).collect();
        let faces: Vec<Vec<VertexId>> = fan(&CUBE_FACES).into_iter().map(numbered).collect();
        let surface = Surface::new(&coordinates, &faces);
        // Edge 4-6 splits the top.
        let kappa = EdgeConvexity { p: VertexId(6), q: VertexId(4), left: FaceId(2), right: FaceId(3) };
        (surface.estimate(&kappa).and_then(|k| k.sign()), surface.sign(&kappa))
    };
    assert_eq!(ask(&points(&CUBE)).1, Sign::Zero);
    let mut vertices = points(&CUBE);
    // A raised corner makes a valley of the diagonal, a lowered one a ridge.
    vertices[5] = point("1 0 0x1.0000000000001p0");
    assert_eq!(ask(&vertices), (None, Sign::Negative));
    vertices[5] = point("1 0 0x1.fffffffffffffp-1");
    assert_eq!(ask(&vertices), (None, Sign::Positive));
    vertices[5] = point("1 0 1.5");
    assert_eq!(ask(&vertices), (Some(Sign::Negative), Sign::Negative));
    // Beyond the filter's range.
    let mut tiny = points(&CUBE);
    tiny[5] = point("1 0 1e-200");
    assert_eq!(ask(&tiny), (None, Sign::Positive));
}
