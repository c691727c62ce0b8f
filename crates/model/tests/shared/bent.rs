//! Faces that are not planar: κ is that of the normals `N` of the loops, on the exact block, and rounding keeps what was decided.

use super::blocks::{Surface, Units, cross, dot, minus};
use proptest::prelude::*;
use rockproof_model::block::face_normal;
use rockproof_model::{Block, BlockOptions, EdgeId, FaceId, Number, Point, Precision, Vec3, VertexId};

fn number(text: &str) -> Number {
    Number::parse(text).expect("a number")
}

/// A box of 1000 × 1000 × 1000 whose top is divided by a ridge or a valley from front to back, each corner moved by a little.
pub(super) fn divided_box(moves: &[Units; 10]) -> Surface {
    let corners: [Units; 10] = [
        [0, 0, 0],
        [1000, 0, 0],
        [1000, 1000, 0],
        [0, 1000, 0],
        [0, 0, 1000],
        [500, 0, 1000],
        [1000, 0, 1000],
        [1000, 1000, 1000],
        [500, 1000, 1000],
        [0, 1000, 1000],
    ];
    let moved = |(corner, by): (&Units, &Units)| [0, 1, 2].map(|axis| corner[axis] + by[axis]);
    let faces = [
        vec![0, 3, 2, 1],
        vec![4, 5, 8, 9],
        vec![5, 6, 7, 8],
        vec![0, 1, 6, 5, 4],
        vec![1, 2, 7, 6],
        vec![2, 3, 9, 8, 7],
        vec![3, 0, 4, 9],
    ];
    Surface { vertices: corners.iter().zip(moves).map(moved).collect(), faces: faces.into() }
}

/// The edge between the two faces of the top, as the ends of its sorted pair.
const RIDGE: [usize; 2] = [5, 8];

pub(super) fn points(vertices: &[Units]) -> Vec<Point> {
    let coordinate = |n: i128| Number::from_integer(i32::try_from(n).expect("a small number"));
    vertices.iter().map(|v| Vec3::new(coordinate(v[0]), coordinate(v[1]), coordinate(v[2]))).collect()
}

pub(super) fn loops(surface: &Surface) -> Vec<Vec<u32>> {
    surface.faces.iter().map(|face| face.iter().map(|&v| v as u32).collect()).collect()
}

fn loose() -> BlockOptions {
    BlockOptions { planarity: number("1/10") }
}

/// The edge of a block with these ends.
fn edge(block: &Block, [p, q]: [usize; 2]) -> EdgeId {
    block.topology().edge_between(VertexId(p as u32), VertexId(q as u32)).expect("an edge")
}

pub(super) fn moves() -> impl Strategy<Value = [Units; 10]> {
    let along = || prop::array::uniform3(-20_i32..=20).prop_map(|by| by.map(i128::from));
    prop::collection::vec(along(), 10).prop_map(|all| all.try_into().expect("ten"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(debug_assertions) { 40 } else { 400 }))]

    /// Flags of blocks whose faces are all bent: κ from the normals of the loops, the turns of a face seen along its normal.
    #[test]
    fn convexity_of_bent_blocks_is_that_of_the_normals_of_their_loops(moves in moves()) {
        let surface = divided_box(&moves);
        let second = surface.second();
        prop_assume!(second.edges.iter().all(|(_, kappa)| *kappa != 0));
        let block = Block::new(points(&surface.vertices), loops(&surface), &loose()).expect("a block");
        prop_assert_eq!(block.topology().edges().len(), second.edges.len());
        for (k, (ends, kappa)) in second.edges.iter().enumerate() {
            prop_assert_eq!(block.edge_is_convex(EdgeId(k as u32)), *kappa > 0, "edge {:?}", ends);
        }
        for vertex in 0..10 {
            let convex = second.edges.iter().filter(|(ends, _)| ends.contains(&vertex)).all(|(_, kappa)| *kappa > 0);
            prop_assert_eq!(block.vertex_is_convex(VertexId(vertex as u32)), convex, "vertex {}", vertex);
        }
        prop_assert_eq!(block.is_convex(), second.edges.iter().all(|(_, kappa)| *kappa > 0));
        for (k, face) in surface.faces.iter().enumerate() {
            let (normal, n) = (surface.normal(face), face.len());
            let turns = |i: usize| {
                let [a, b, c] = [0, 1, 2].map(|j| surface.vertices[face[(i + j) % n]]);
                dot(cross(minus(b, a), minus(c, b)), normal)
            };
            prop_assert_eq!(block.face_is_convex(FaceId(k as u32)), (0..n).all(|i| turns(i) > 0), "face {}", k);
        }
    }

    /// N is the sum of `v_k × v_{k+1}` round the loop, from the origin: the same vector by another sum. The triangles of a face add up to it.
    #[test]
    fn normals_of_bent_faces_are_twice_the_area_vector(moves in moves()) {
        let surface = divided_box(&moves);
        let vertices = points(&surface.vertices);
        let vector = |v: Units| points(&[v]).remove(0).map(Number::to_rational);
        let exact: Vec<_> = vertices.iter().map(|v| v.map(Number::to_rational)).collect();
        let block = Block::new(vertices, loops(&surface), &loose());
        prop_assume!(block.is_ok());
        let triangles = block.expect("a block").triangles(&number("1/10"));
        for (face, ids) in surface.faces.iter().zip(loops(&surface)) {
            let ids: Vec<VertexId> = ids.into_iter().map(VertexId).collect();
            let round = face.iter().zip(face.iter().cycle().skip(1));
            let sum = |sum: Units, more: Units| [0, 1, 2].map(|axis| sum[axis] + more[axis]);
            let wanted = round.map(|(&p, &q)| cross(surface.vertices[p], surface.vertices[q])).fold([0; 3], sum);
            prop_assert_eq!(face_normal(&exact, &ids), vector(wanted));
            let own = triangles.iter().filter(|t| t.iter().all(|v| face.contains(&v.index())));
            let normals: Vec<Units> = own.map(|t| surface.normal(&t.map(|v| v.index()))).collect();
            prop_assert_eq!(normals.len(), face.len() - 2);
            prop_assert!(normals.iter().all(|n| dot(*n, wanted) > 0));
            prop_assert_eq!(normals.into_iter().fold([0; 3], sum), wanted);
        }
    }
}

/// What the corners of the top of a box are lifted by, and whether its middle edge is then convex. By hand: with the corners lifted by a, b, c
/// from left to right, the same at front and back, both halves are planar and the edge is convex where 2b > a + c. A half whose corners are
/// lifted by different amounts is bent, and `N` is that of its mean slopes: along the edge the means of front and back count.
const LIFTED: [([[i128; 3]; 2], bool); 8] = [
    ([[0, 10, 0], [0, 10, 0]], true),
    ([[0, -10, 0], [0, -10, 0]], false),
    ([[0, 6, 10], [0, 6, 10]], true),
    ([[0, 4, 10], [0, 4, 10]], false),
    // At the front a valley of 10, at the back a ridge of 12: on the mean a ridge, though the front alone says reflex.
    ([[0, -10, 0], [0, 12, 0]], true),
    ([[0, -12, 0], [0, 10, 0]], false),
    // The corners of one half alone, twisted: front down by 7 and back up by 9, then the other way round.
    ([[7, 0, 0], [-9, 0, 0]], true),
    ([[-7, 0, 0], [9, 0, 0]], false),
];

#[test]
fn a_bent_face_counts_by_its_mean_slope() {
    for (lifted, convex) in LIFTED {
        let [front, back] = lifted;
        let mut moves = [[0; 3]; 10];
        for (corner, lift) in [4, 5, 6, 9, 8, 7].into_iter().zip(front.into_iter().chain(back)) {
            moves[corner][2] = lift;
        }
        let surface = divided_box(&moves);
        let block = Block::new(points(&surface.vertices), loops(&surface), &loose()).expect("a block");
        assert_eq!(block.edge_is_convex(edge(&block, RIDGE)), convex, "{lifted:?}");
        assert_eq!(block.is_convex(), convex, "{lifted:?}");
    }
}

/// Heights over 1 of the left, middle and right corners of the top, in f32's units 2⁻²³, as tenths; and whether the middle edge is convex
/// exactly, and after rounding to f32 (None: flat).
const ROUNDED: [([i64; 3], bool, Option<bool>); 6] = [
    ([0, 4, 0], true, None),
    ([0, -2, 0], false, None),
    // 0, 0.6, 1.3 become 0, 1, 1.
    ([0, 6, 13], false, Some(true)),
    // 0, 0.4, 0.7 become 0, 0, 1.
    ([0, 4, 7], true, Some(false)),
    ([0, 30, 20], true, Some(true)),
    // 1.5 is a tie of rounding: to the even 2.
    ([0, 15, 31], false, Some(true)),
];

#[test]
fn rounding_keeps_the_flags_of_the_exact_block() {
    for (tenths, convex, after) in ROUNDED {
        let unit = number("0x1p-23");
        let lift = |n: i64| number("1").plus(&unit.times(&number(&format!("{n}/10"))));
        let surface = divided_box(&[[0; 3]; 10]);
        let mut vertices: Vec<Point> =
            points(&surface.vertices).iter().map(|v| v.map(|c| c.times(&number("1/1000")))).collect();
        for (corner, place) in [4, 5, 6, 9, 8, 7].into_iter().zip([0, 1, 2, 0, 1, 2]) {
            vertices[corner].z = lift(tenths[place]);
        }
        let block = Block::new(vertices, loops(&surface), &BlockOptions::default()).expect("a block");
        let ridge = edge(&block, RIDGE);
        assert_eq!((block.edge_is_convex(ridge), block.is_convex()), (convex, convex), "{tenths:?}");
        let rounded = block.rounded(Precision::F32).expect("no overflow");
        assert_eq!((rounded.edge_is_convex(ridge), rounded.is_convex()), (convex, convex), "{tenths:?} rounded");
        assert_eq!([5, 8].map(|v| rounded.vertex_is_convex(VertexId(v))), [convex; 2], "{tenths:?} rounded");
        let moved = rounded.translated(&Vec3::new(number("1/3"), number("7"), number("-1e9")));
        assert_eq!((moved.edge_is_convex(ridge), moved.is_convex()), (convex, convex), "{tenths:?} moved");
        // A block made anew of the rounded corners is another one: what rounding has done is no part of the flags above.
        let anew = Block::new(rounded.vertices().to_vec(), loops(&surface), &BlockOptions::default()).expect("a block");
        let found = (anew.vertices().len() == 10).then(|| anew.edge_is_convex(edge(&anew, RIDGE)));
        assert_eq!(found, after, "{tenths:?} anew");
    }
}
