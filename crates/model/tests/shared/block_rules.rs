//! What is a block and what is none (docs/spec.md, section 2): for every rule the smallest solids on its boundary and to either side of it, by hand.

use super::bent::{divided_box, loops, moves, points};
use num_rational::BigRational;
use num_traits::One;
use proptest::prelude::*;
use rockproof_model::{Block, BlockError, BlockOptions, Number, Point, TopologyError, Vec3};

type Solid = (Vec<Point>, Vec<Vec<u32>>);

fn number(text: &str) -> Number {
    Number::parse(text).expect("a number")
}

fn point(text: &str) -> Point {
    let mut parts = text.split(' ').map(number);
    let [x, y, z] = std::array::from_fn(|_| parts.next().expect("three coordinates"));
    Vec3::new(x, y, z)
}

fn solid<const N: usize>(vertices: &[&str], faces: [&[u32]; N]) -> Solid {
    (vertices.iter().map(|v| point(v)).collect(), faces.map(<[u32]>::to_vec).into())
}

const CUBE: [&[u32]; 6] = [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
const TETRAHEDRON: [&[u32]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];
const UNIT_CUBE: [&str; 8] = ["0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "1 0 1", "1 1 1", "0 1 1"];
const CORNER: [&str; 4] = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];

/// What is found, in the words of section 2; of a block, how many vertices and faces it has.
fn verdict((vertices, faces): Solid, planarity: &str) -> String {
    let error = match Block::new(vertices, faces, &BlockOptions { planarity: number(planarity) }) {
        Ok(block) => {
            return format!("block of {} and {}", block.vertices().len(), block.topology().faces().len());
        }
        Err(error) => error,
    };
    let word = match error {
        BlockError::Topology(TopologyError::TooFew { .. } | TopologyError::Open { .. }) => "open",
        BlockError::Topology(TopologyError::SameDirection { .. }) => "orientation",
        BlockError::Topology(TopologyError::NonManifoldVertex { .. }) => "manifold",
        BlockError::Topology(TopologyError::Disconnected { .. }) => "shells",
        BlockError::Topology(TopologyError::UnusedVertex { .. }) => "unused",
        BlockError::Topology(TopologyError::VertexTwice { .. } | TopologyError::ShortFace { .. }) => "no polygon",
        BlockError::RepeatedVertex { .. } => "repeated",
        BlockError::DegenerateFace { .. } => "no area",
        BlockError::NotPlanar { .. } => "planarity",
        BlockError::SelfIntersecting { .. } => "loop",
        BlockError::NotPositiveVolume { .. } => "volume",
        BlockError::FacesMeet { .. } | BlockError::FoldedEdge { .. } => "faces meet",
        BlockError::TwoEdgeVertex { .. } | BlockError::FaceWithHole { .. } => "not canonical",
        BlockError::Overflow { .. } => "overflow",
        _ => "other",
    };
    word.to_string()
}

/// The cube of side 4 with its top drawn to a point over the middle of the floor.
fn pit(z: &str) -> Solid {
    let faces: [&[u32]; 9] =
        [CUBE[0], CUBE[2], CUBE[3], CUBE[4], CUBE[5], &[4, 5, 8], &[5, 6, 8], &[6, 7, 8], &[7, 4, 8]];
    let apex = format!("2 2 {z}");
    solid(&["0 0 0", "4 0 0", "4 4 0", "0 4 0", "0 0 4", "4 0 4", "4 4 4", "0 4 4", &apex], faces)
}

/// A prism on a square with a notch from one side that ends at y.
fn notch(y: &str) -> Solid {
    let outline = ["0 0", "4 0", "4 4", &format!("2 {y}"), "0 4"];
    let vertices: Vec<String> =
        ["0", "1"].iter().flat_map(|z| outline.iter().map(move |p| format!("{p} {z}"))).collect();
    let vertices: Vec<&str> = vertices.iter().map(String::as_str).collect();
    let faces: [&[u32]; 7] =
        [&[4, 3, 2, 1, 0], &[5, 6, 7, 8, 9], &[0, 1, 6, 5], &[1, 2, 7, 6], &[2, 3, 8, 7], &[3, 4, 9, 8], &[4, 0, 5, 9]];
    solid(&vertices, faces)
}

/// A prism on a triangle, one of whose upright edges ends at z.
fn short_edge(z: &str) -> Solid {
    let top = format!("0 0 {z}");
    let faces: [&[u32]; 5] = [&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
    solid(&["0 0 0", "3 0 0", "0 4 0", &top, "3 0 1", "0 4 1"], faces)
}

fn tetrahedron(z: &str) -> Solid {
    let apex = format!("1 1 {z}");
    solid(&["0 0 0", "3 0 0", "0 3 0", &apex], TETRAHEDRON)
}

/// A tetrahedron, one of whose edges has a third vertex at its middle, off it by y, and a face between these three.
fn sliver(y: &str) -> Solid {
    let middle = format!("1/2 {y} 0");
    let vertices = [CORNER[0], CORNER[1], CORNER[2], CORNER[3], &middle];
    let faces: [&[u32]; 6] = [&[0, 2, 1], &[0, 4, 3], &[4, 1, 3], &[0, 1, 4], &[1, 2, 3], &[2, 0, 3]];
    solid(&vertices, faces)
}

/// A cube with a vertex at the middle of an edge of its top, off it by y.
fn vertex_of_two_edges(y: &str) -> Solid {
    let middle = format!("1/2 {y} 1");
    let vertices: Vec<&str> = UNIT_CUBE.into_iter().chain([middle.as_str()]).collect();
    solid(&vertices, [CUBE[0], &[4, 8, 5, 6, 7], &[0, 1, 5, 8, 4], CUBE[3], CUBE[4], CUBE[5]])
}

/// A box of 1 × 1 × side whose longest side has this length.
fn far(side: &str) -> Solid {
    let roof = ["0 0", "1 0", "1 1", "0 1"].map(|p| format!("{p} {side}"));
    let vertices: Vec<&str> = UNIT_CUBE[..4].iter().copied().chain(roof.iter().map(String::as_str)).collect();
    solid(&vertices, CUBE)
}

/// A family of solids and, by the number that makes its members, what each is.
type Family = (fn(&str) -> Solid, [(&'static str, &'static str); 3]);

/// With a planarity of a millionth. `1e-40` is further below any rounding than f64 could tell.
const FAMILIES: [Family; 7] = [
    // Above the floor, on it, through it.
    (pit, [("1e-40", "block of 9 and 9"), ("0", "faces meet"), ("-1e-40", "faces meet")]),
    // As high as the top: four faces in one plane, which merge; the apex goes.
    (pit, [("3.9", "block of 9 and 9"), ("4", "block of 8 and 6"), ("4.1", "block of 9 and 9")]),
    (notch, [("1e-40", "block of 10 and 7"), ("0", "loop"), ("-1e-40", "loop")]),
    (short_edge, [("1e-40", "block of 6 and 5"), ("0", "repeated"), ("-1e-40", "loop")]),
    // The middle outside the edge; on it; inside the face, so that two faces lie on one another.
    (sliver, [("-1e-40", "block of 5 and 5"), ("0", "no area"), ("1e-40", "faces meet")]),
    (vertex_of_two_edges, [("1e-40", "not canonical"), ("0", "block of 8 and 6"), ("-1e-40", "not canonical")]),
    // Between these decimals lies 2¹⁰²⁴ − 2⁹⁷⁰, from which on a number rounds to no f64.
    (
        far,
        [
            ("1", "block of 8 and 6"),
            ("1.7976931348623158079e308", "block of 8 and 6"),
            ("1.797693134862315808e308", "overflow"),
        ],
    ),
];

#[test]
fn solids_on_the_boundary_of_a_rule_and_beside_it() {
    for (number, (family, members)) in FAMILIES.into_iter().enumerate() {
        for (value, wanted) in members {
            assert_eq!(verdict(family(value), "1e-6"), wanted, "family {number}, {value}");
        }
    }
    assert_eq!(verdict(tetrahedron("1e-40"), "1e-6"), "block of 4 and 4");
    assert_eq!(verdict(tetrahedron("-1e-40"), "1e-6"), "volume");
    // Without a thickness it is refused; merging finds it first.
    assert!(!verdict(tetrahedron("0"), "1e-6").starts_with("block"));
}

#[test]
fn surfaces_that_do_not_close_or_hang_together() {
    let corner_at =
        |shift: i64| CORNER.map(|v| v.replace('1', &(shift + 1).to_string()).replace('0', &shift.to_string()));
    let two = |second: &[u32], vertices: Vec<String>| -> Solid {
        let vertices: Vec<&str> = vertices.iter().map(String::as_str).collect();
        let more = TETRAHEDRON.map(|face| face.iter().map(|&v| second[v as usize]).collect::<Vec<u32>>());
        let (vertices, mut faces) = solid(&vertices, TETRAHEDRON);
        faces.extend(more);
        (vertices, faces)
    };
    let with = |more: &[&str]| CORNER.iter().chain(more).map(|v| (*v).to_string()).collect::<Vec<String>>();
    let reversed = |faces: [&[u32]; 6]| faces.map(|f| f.iter().rev().copied().collect::<Vec<u32>>()).to_vec();
    let mut turned = solid(&UNIT_CUBE, CUBE);
    turned.1[1].reverse();
    let mut unused = solid(&UNIT_CUBE, CUBE);
    unused.0.push(point("1/2 1/2 1/2"));
    let inside_out = (solid(&UNIT_CUBE, CUBE).0, reversed(CUBE));
    // A cube with a hollow: the inner shell runs the other way round.
    let mut hollow = solid(&["0 0 0", "3 0 0", "3 3 0", "0 3 0", "0 0 3", "3 0 3", "3 3 3", "0 3 3"], CUBE);
    hollow.0.extend(UNIT_CUBE.map(|v| point(&v.replace('1', "2").replace('0', "1"))));
    hollow.1.extend(reversed(CUBE).into_iter().map(|face| face.into_iter().map(|v| v + 8).collect()));
    for (name, solid, wanted) in [
        ("a cube", solid(&UNIT_CUBE, CUBE), "block of 8 and 6"),
        ("a tetrahedron", solid(&CORNER, TETRAHEDRON), "block of 4 and 4"),
        ("a cube without its top", solid(&UNIT_CUBE, [CUBE[0], CUBE[2], CUBE[3], CUBE[4], CUBE[5]]), "open"),
        ("a tetrahedron without a face", solid(&CORNER, [TETRAHEDRON[0], TETRAHEDRON[1], TETRAHEDRON[2]]), "open"),
        ("one face turned", turned, "orientation"),
        ("all faces turned", inside_out, "volume"),
        ("a vertex without a face", unused, "unused"),
        ("two tetrahedra", two(&[4, 5, 6, 7], [with(&[]), corner_at(5).into()].concat()), "shells"),
        ("a hollow", hollow, "shells"),
        // The second has the vertex 1 of the first, and then its edge from 0 to 1, which four faces run along.
        ("two at a vertex", two(&[1, 4, 5, 6], with(&["2 0 0", "1 1 0", "1 0 1"])), "manifold"),
        ("two along an edge", two(&[0, 1, 4, 5], with(&["0 -1 0", "0 0 -1"])), "orientation"),
    ] {
        assert_eq!(verdict(solid, "1e-6"), wanted, "{name}");
    }
}

/// A ring of four bars, whose section is a square on its edge: a closed surface with a hole through it. With the lower edge drawn up into the plane
/// of the others the bars are triangular, and what is below them is a plane ring, which one loop cannot say.
fn ring(lower: &str) -> Solid {
    let square = |half: i64, z: &str| {
        [(-1, -1), (1, -1), (1, 1), (-1, 1)].map(|(x, y)| point(&format!("{} {} {z}", x * half, y * half)))
    };
    let vertices = [square(3, "0"), square(2, "1"), square(1, "0"), square(2, lower)].concat();
    // From the outer edge to the upper, the inner and the lower one, and round to the outer again.
    let bar = |k: u32, level: u32| {
        let (next, above) = ((k + 1) % 4, (level + 1) % 4);
        vec![4 * level + k, 4 * level + next, 4 * above + next, 4 * above + k]
    };
    let faces = (0..4).flat_map(|level| (0..4).map(move |k| bar(k, level))).collect();
    (vertices, faces)
}

#[test]
fn a_ring_is_a_block_unless_a_face_of_it_is_one() {
    assert_eq!(verdict(ring("-1"), "0"), "block of 16 and 16");
    assert_eq!(verdict(ring("-1e-40"), "0"), "block of 16 and 16");
    assert_eq!(verdict(ring("0"), "0"), "not canonical");
}

/// A box of 2 × 2 × 100 m, whose top goes up and down by h at its corners in turn: N is along z, the mean is level and each corner is h off.
fn saddle(h: &str) -> Solid {
    let (up, down) = (number(h), number(h).negated());
    let floor = up.plus(&number("-100"));
    let at = |x: &str, y: &str, z: &Number| Vec3::new(number(x), number(y), z.clone());
    let corners = [("-1", "-1"), ("1", "-1"), ("1", "1"), ("-1", "1")];
    let roof = [&up, &down, &up, &down];
    let vertices = corners.iter().map(|(x, y)| at(x, y, &floor));
    let vertices = vertices.chain(corners.iter().zip(roof).map(|((x, y), z)| at(x, y, z))).collect();
    (vertices, CUBE.map(<[u32]>::to_vec).into())
}

#[test]
fn planarity_is_a_share_of_the_longest_side_and_includes_its_edge() {
    // A thousandth of 100 m is 1/10 m.
    for (h, planarity, wanted) in [
        ("1/10", "1/1000", "block of 8 and 6"),
        ("0.0999999999999999999999999999999999999999", "1/1000", "block of 8 and 6"),
        ("0.1000000000000000000000000000000000000001", "1/1000", "planarity"),
        ("1e-40", "0", "planarity"),
        ("0", "0", "block of 8 and 6"),
    ] {
        assert_eq!(verdict(saddle(h), planarity), wanted, "{h}");
    }
    // The default is the f64 nearest to 1e-9, a little above it.
    let exact = Number::from_f64(1e-9).expect("finite").times(&number("100"));
    let beyond = exact.plus(&number("1e-60"));
    for (h, is_block) in [(exact, true), (beyond, false)] {
        let (vertices, faces) = saddle(&h.to_string());
        assert_eq!(Block::new(vertices, faces, &BlockOptions::default()).is_ok(), is_block);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(debug_assertions) { 40 } else { 300 }))]

    /// Of blocks whose faces are all bent: the greatest distance of a vertex from `N·(x − c) = 0`, c the mean of the loop, in fractions.
    #[test]
    fn planarity_is_that_of_the_worst_vertex_of_the_worst_face(moves in moves(), off in prop::sample::select(vec![-1_i64, 1])) {
        let surface = divided_box(&moves);
        let whole = |n: i128| BigRational::from_integer(n.into());
        // The mean times the number of corners, so that all is whole.
        let distance = |face: &Vec<usize>| {
            let (normal, n) = (surface.normal(face), face.len() as i128);
            let sum = [0, 1, 2].map(|axis| face.iter().map(|&v| surface.vertices[v][axis]).sum::<i128>());
            let off = |&v: &usize| (0..3).map(|k| normal[k] * (n * surface.vertices[v][k] - sum[k])).sum::<i128>();
            let squared = normal.iter().map(|c| c * c).sum::<i128>() * n * n;
            face.iter().map(|v| whole(off(v)) * whole(off(v)) / whole(squared)).max().expect("corners")
        };
        let extent = |axis: usize| {
            let along = || surface.vertices.iter().map(|v| v[axis]);
            along().max().zip(along().min()).map(|(high, low)| high - low).expect("vertices")
        };
        let side = whole((0..3).map(extent).max().expect("axes"));
        let share = surface.faces.iter().map(distance).max().expect("faces") / (&side * &side);
        let root = Number::from_rational(share.clone()).approximate().sqrt();
        let beside = BigRational::one() + BigRational::new(off.into(), (1_i64 << 50).into());
        let planarity = Number::from_f64(root).expect("finite").to_rational() * beside;
        let options = BlockOptions { planarity: Number::from_rational(planarity.clone()) };
        let found = Block::new(points(&surface.vertices), loops(&surface), &options);
        let refused = matches!(found, Err(BlockError::NotPlanar { .. }));
        prop_assert_eq!(refused, &planarity * &planarity < share);
    }
}
