//! Tests of what is proved of a block before any pair is looked at: faces called convex, bulges, errors of vectors.

use super::*;
use crate::soundness::Dice;
use num_rational::BigRational;
use num_traits::Signed;
use rockproof_model::{BlockOptions, Number};

/// A box 3 wide whose top and two sides are bent by one corner raised, all of it `scale` times as large.
pub(crate) fn bent_box(scale: &Number) -> Block {
    let corners = [[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0], [0, 0, 3], [3, 0, 3], [3, 3, 4], [0, 3, 3]];
    let at = |c: i32| Number::from_integer(c).times(scale);
    let vertices = corners.map(|[x, y, z]| Vec3::new(at(x), at(y), at(z))).to_vec();
    let faces =
        [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]].map(|f| f.to_vec());
    Block::new(vertices, faces.to_vec(), &BlockOptions { planarity: Number::from_integer(1) }).unwrap()
}

#[test]
fn the_bulge_of_a_bent_face_is_bounded_whatever_the_size() {
    // N is (−3, −3, 18) and a corner is 18/4 above the mean: 4.5/√342.
    let bulge = 4.5 / 342f64.sqrt();
    let (mut known, mut unknown) = (0, 0);
    for exponent in -300..300 {
        let unit = 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
        let bound = PreparedBlock::new(&bent_box(&Number::from_f64(unit).unwrap())).bulge;
        let least = bulge * (1.0 - 1e-9) * 2f64.powi(exponent);
        assert!(bound >= least, "2^{exponent}: {bound:e} for {least:e}");
        if bound.is_finite() {
            known += 1;
            assert!(bound <= bulge * (1.0 + 1e-9) * 2f64.powi(exponent), "2^{exponent}: {bound:e}");
        } else {
            unknown += 1;
        }
    }
    assert!(known > 450 && unknown > 20, "{known} known, {unknown} unknown");
}

fn float(value: f64) -> Number {
    Number::from_f64(value).unwrap()
}

fn exactly(value: f64) -> BigRational {
    BigRational::from_float(value).expect("finite")
}

/// A block between two loops of the same length, one above the other, each counter-clockwise seen from above: face 0 is the
/// lower one, face 1 the upper one. Faces may be bent a little.
fn between(lower: &[[f64; 3]], upper: &[[f64; 3]], scale: f64) -> Block {
    let n = lower.len() as u32;
    let vertices = lower.iter().chain(upper).map(|&[x, y, z]| Vec3::new(x, y, z).map(|&c| float(c * scale))).collect();
    let sides = (0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]);
    let faces = [(0..n).rev().collect(), (n..2 * n).collect()].into_iter().chain(sides).collect();
    Block::new(vertices, faces, &BlockOptions { planarity: Number::from_integer(1) }).unwrap()
}

/// A polygon at a height, its corners numbered from the one at `first`.
fn polygon(corners: &[[f64; 2]], first: usize, height: f64) -> Vec<[f64; 3]> {
    (0..corners.len()).map(|k| corners[(first + k) % corners.len()]).map(|[x, y]| [x, y, height]).collect()
}

fn prism(corners: &[[f64; 2]], height: f64) -> Block {
    between(&polygon(corners, 0, 0.0), &polygon(corners, 0, height), 1.0)
}

fn surely_convex(block: &Block) -> Vec<bool> {
    PreparedBlock::new(block).faces.iter().map(|face| face.surely_convex).collect()
}

const L: [[f64; 2]; 6] = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 2.0], [2.0, 4.0], [0.0, 4.0]];

#[test]
fn faces_of_convex_polygons_are_surely_convex() {
    let pentagon = [[0.0, 0.0], [4.0, 0.0], [5.0, 3.0], [2.0, 6.0], [-1.0, 3.0]];
    let square = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]];
    for first in 0..5 {
        for lean in [-0.25, 0.0, 0.25] {
            // Every corner moved towards the middle or away from it: sides lean inwards or outwards.
            let lower = polygon(&pentagon, first, 0.0);
            let upper: Vec<_> =
                lower.iter().map(|[x, y, _]| [x - lean * (x - 2.0), y - lean * (y - 2.5), 2.0]).collect();
            assert_eq!(surely_convex(&between(&lower, &upper, 1.0)), [true; 7], "from {first}, {lean}");
        }
    }
    assert_eq!(surely_convex(&prism(&square, 3.0)), [true; 6]);
}

/// Whichever corner comes first: the order of the corners' numbers is the direction of the edges.
#[test]
fn faces_with_a_reflex_corner_are_not_surely_convex() {
    for first in 0..6 {
        let found = surely_convex(&between(&polygon(&L, first, 0.0), &polygon(&L, first, 3.0), 1.0));
        assert_eq!(found[..2], [false, false], "from corner {first}");
        assert_eq!(found[2..], [true; 6], "from corner {first}");
    }
}

/// Sides that lean make the inward direction of one face at an edge differ much from that of the other.
#[test]
fn leaning_sides_make_no_reflex_corner_convex() {
    // Which way each side of the L leans: how far its upper edge is from the lower one, inwards.
    for outwards in 0..7 {
        let lean = |side: usize| if side == outwards { -0.25 } else { 0.25 };
        let [south, east, top, notch, north, west] =
            [lean(0), 4.0 - lean(1), 2.0 - lean(2), 2.0 - lean(3), 4.0 - lean(4), lean(5)];
        let upper = [[west, south], [east, south], [east, top], [notch, top], [notch, north], [west, north]];
        for first in 0..6 {
            let block = between(&polygon(&L, first, 0.0), &polygon(&upper, first, 1.0), 1.0);
            assert_eq!(
                surely_convex(&block)[..2],
                [false, false],
                "side {outwards} leans outwards, from corner {first}"
            );
        }
    }
}

#[test]
fn a_bent_dart_is_not_surely_convex_whatever_its_size() {
    let dart = [[0.0, 4.0], [-3.0, -3.0], [0.0, -1.0], [3.0, -3.0]];
    let upper = [[0.0, 4.0, 4.0], [-3.0, -3.0, 4.0], [0.0, -1.0, 4.0], [3.0, -3.0, 5.0]];
    for exponent in -300..300 {
        let scale = 2f64.powi(exponent);
        let found = surely_convex(&between(&polygon(&dart, 0, 0.0), &upper, scale));
        assert_eq!(found[..2], [false, false], "2^{exponent}");
    }
}

/// All turns of this face are infinite in f64, and so is their bound: that proves nothing.
#[test]
fn turns_that_overflow_prove_no_convexity() {
    let corners: [[i64; 3]; 4] = [[0, 0, 0], [26, 7, -19], [16, -5, 2], [-1, -27, 39]];
    let minus = |a: [i64; 3], b: [i64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross =
        |a: [i64; 3], b: [i64; 3]| [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
    let dot = |a: [i64; 3], b: [i64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let edge = |k: usize| minus(corners[(k + 1) % 4], corners[k % 4]);
    let parts = [1, 2].map(|k| cross(minus(corners[k], corners[0]), minus(corners[k + 1], corners[0])));
    let n = [0, 1, 2].map(|k| parts[0][k] + parts[1][k]);
    let turns = [0, 1, 2, 3].map(|k| dot(cross(n, edge(k)), edge(k + 1)));
    assert!(turns.iter().any(|&turn| turn < 0), "{turns:?}: a reflex corner");
    let scale = 78.0 * 2f64.powi(245);
    let at = |corner: [i64; 3]| Vec3::new(corner[0], corner[1], corner[2]).map(|&c| float(c as f64 * scale));
    let bent = bent_box(&float(scale));
    let mut vertices = bent.vertices().to_vec();
    for (place, corner) in vertices[4..].iter_mut().zip(corners) {
        *place = at(corner);
    }
    assert!(!surely_convex(&bent.with_vertices(vertices))[1]);
}

/// The greatest distance of a corner from its face's plane, squared: `(N·(k(v − v₀) − C))²/(k²|N|²)`.
fn largest_bulge_squared(block: &Block) -> BigRational {
    let vertices: Vec<Vec3<BigRational>> = block.vertices().iter().map(|v| v.map(Number::to_rational)).collect();
    let mut largest = exactly(0.0);
    for face in block.topology().faces().iter().filter(|face| face.len() > 3) {
        let (n, centre) = (face_normal(&vertices, face), centre_sum(&vertices, face));
        let count = BigRational::from_integer(face.len().into());
        for &v in face {
            let from_first = vertices[v.index()].minus(&vertices[face[0].index()]);
            let value = n.dot(&from_first.scaled(&count).minus(&centre));
            largest = largest.max(&value * &value / (&count * &count * n.norm_squared()));
        }
    }
    largest
}

#[test]
fn the_bulge_bounds_what_is_bent_by_hardly_more_than_roundings() {
    let mut dice = Dice(31);
    let mut part = || dice.below(1 << 52) as f64 / (1u64 << 52) as f64;
    let (mut bent, mut known) = (0, 0);
    for round in 0..200 {
        // A quadrilateral in one plane but for its roundings and a little.
        let mut corner = || [part(), part(), 2.0 + part()];
        let [p, q, s] = [corner(), corner(), corner()];
        let at = |u: f64, v: f64| std::array::from_fn::<f64, 3, _>(|k| p[k] + u * (q[k] - p[k]) + v * (s[k] - p[k]));
        let mut base = [p, q, at(1.0, 0.9), at(0.1, 1.0)];
        // Bent by a little more, the roundings in calculating how much are still far larger than any slack for them.
        base[3][2] += 2f64.powi(-28 - round % 30);
        if round == 0 {
            // In f64 no corner of this one is off its plane.
            base = [
                [1.742936953102772, 1.0455226301517002, 1.1856584237241816],
                [1.0878998679953438, 0.882949780600351, 1.9235584750337869],
                [1.080181897124372, 0.8900667524647349, 1.9274487551503368],
                [1.7352189822318003, 1.0526396020160842, 1.1895487038407315],
            ];
        }
        let block = pyramid_on(base);
        let (bulge, least) = (PreparedBlock::new(&block).bulge, largest_bulge_squared(&block));
        // A base that were bent more would hide what is looked for.
        assert!(least <= exactly(2f64.powi(-40)), "round {round}");
        bent += usize::from(least.is_positive());
        known += usize::from(bulge.is_finite());
        assert!(bulge.is_infinite() || exactly(bulge).pow(2) >= least, "round {round}: {bulge:e}");
    }
    assert!(bent > 100 && known > 100, "{bent} bent, {known} known");
}

/// A pyramid with the tip at the origin, whose base, face 0, is a quadrilateral that may be bent; its other faces are
/// triangles, and flat. Those of a box would not do: two that make up a flat side are one face of the block.
fn pyramid_on(base: [[f64; 3]; 4]) -> Block {
    let vertices = |base: [[f64; 3]; 4]| -> Vec<Vec3<Number>> {
        base.iter().chain([&[0.0; 3]]).map(|&[x, y, z]| Vec3::new(x, y, z).map(|&c| float(c))).collect()
    };
    let mut faces = vec![vec![0, 1, 2, 3]];
    faces.extend((0..4).map(|k| vec![(k + 1) % 4, k, 4]));
    let flat = vertices([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]]);
    let pyramid = Block::new(flat, faces, &BlockOptions { planarity: Number::ZERO }).unwrap();
    assert_eq!(pyramid.topology().faces().iter().map(Vec::len).collect::<Vec<_>>(), [4, 3, 3, 3, 3]);
    pyramid.with_vertices(vertices(base))
}

#[test]
fn a_folded_sliver_has_no_small_bulge() {
    let (mut known, mut unknown) = (0, 0);
    for exponent in 10..=200 {
        // N is (0, 0, 2 width), so the plane is z = 13/4 and corners are 1/4 above and below it. Of the narrow ones N is far
        // below its error: f64 does not know where the plane is.
        let width = 2f64.powi(-exponent);
        let block = pyramid_on([[0.0, 0.0, 3.0], [1.0, 0.0, 3.5], [2.0, 0.0, 3.0], [1.0, width, 3.5]]);
        assert_eq!(largest_bulge_squared(&block), BigRational::new(1.into(), 16.into()));
        let bulge = PreparedBlock::new(&block).bulge;
        assert!(bulge >= 0.25, "width 2^-{exponent}: {bulge:e}");
        known += usize::from(bulge.is_finite());
        unknown += usize::from(bulge.is_infinite());
    }
    assert!(known > 20 && unknown > 100, "{known} known, {unknown} unknown");
}

/// Every vector of a block is within its error of the exact one, and one that f64 cannot hold has no finite error.
fn vectors_are_within_their_errors(block: &Block, about: &str) {
    let prepared = PreparedBlock::new(block);
    let exact: Vec<Vec3<BigRational>> = block.vertices().iter().map(|v| v.map(Number::to_rational)).collect();
    let check = |name: &str, approximate: &Vec3<Approx>, exact: &Vec3<BigRational>, error: f64| {
        assert!(error >= 0.0 || error.is_nan(), "{name}, {about}: {error:e}");
        for (near, exact) in approximate.components().into_iter().zip(exact.components()) {
            if near.0.is_finite() && error.is_finite() {
                assert!((exactly(near.0) - exact).abs() <= exactly(error), "{name}, {about}: {:e}, {error:e}", near.0);
            } else {
                assert!(!error.is_finite(), "{name}, {about}: {:e} without an error", near.0);
            }
        }
    };
    let errors = &prepared.errors;
    for (near, exact) in prepared.vertices.iter().zip(&exact) {
        check("vertex", near, exact, errors.coordinate);
    }
    let topology = block.topology();
    let normals: Vec<_> = topology.faces().iter().map(|face| face_normal(&exact, face)).collect();
    for ((face, near), normal) in topology.faces().iter().zip(&prepared.faces).zip(&normals) {
        check("normal", &near.normal, normal, errors.normal.error);
        check("centre", &near.centre, &centre_sum(&exact, face), errors.centre.error);
    }
    for (edge, near) in topology.edges().iter().zip(&prepared.edges) {
        let direction = exact[edge.q.index()].minus(&exact[edge.p.index()]);
        check("direction", &near.direction, &direction, errors.direction.error);
        let left = normals[edge.left.index()].cross(&direction);
        let right = normals[edge.right.index()].cross(&direction.negated());
        check("inwards, left", &near.inwards[0], &left, errors.inward.error);
        check("inwards, right", &near.inwards[1], &right, errors.inward.error);
    }
}

/// Where f64 holds every sum, errors are zero; these are the first ones that it does not hold.
#[test]
fn sums_with_a_digit_too_many_have_an_error() {
    let large = 2f64.powi(52) - 1.0;
    let (half, step) = (2f64.powi(50), 2f64.powi(40));
    vectors_are_within_their_errors(
        &prism(&[[0.0, 0.0], [large, 0.0], [large, half], [large - 2.0, 2.0 * half]], 1.0),
        "a centre of 55 digits",
    );
    let n = 2f64.powi(51) - 1.0;
    let fan = [-2.0f64, -1.0, 0.0, 1.0, 2.0].map(|k| [n - k * k, k * step]);
    let corners: Vec<_> = [[0.0, 0.0]].into_iter().chain(fan).collect();
    vectors_are_within_their_errors(&prism(&corners, 1.0), "a centre of six corners");
    let octagon = [
        [44_739_242.0, 0.0],
        [89_478_485.0, 0.0],
        [134_217_727.0, 44_739_243.0],
        [134_217_727.0, 89_478_485.0],
        [89_478_485.0, 134_217_727.0],
        [44_739_244.0, 134_217_727.0],
        [0.0, 89_478_485.0],
        [0.0, 44_739_242.0],
    ];
    vectors_are_within_their_errors(&prism(&octagon, 1.0), "a normal of more than 53 digits");
}

#[test]
fn vectors_of_integers_are_within_their_errors_however_many_digits() {
    for digits in (12..=54).step_by(2).chain([17, 25, 27, 49, 51, 53]) {
        let radius = (2f64.powi(digits) - 1.0) / 2.0;
        for corners in [3, 4, 5, 7, 8, 15, 16] {
            let at = |k: usize| {
                let (sine, cosine) = (0.3 + std::f64::consts::TAU * k as f64 / corners as f64).sin_cos();
                [(radius * (1.0 + cosine)).round(), (radius * (1.0 + sine)).round()]
            };
            let corners: Vec<_> = (0..corners).map(at).collect();
            vectors_are_within_their_errors(
                &prism(&corners, 1.0),
                &format!("{digits} digits, {} corners", corners.len()),
            );
        }
    }
}

#[test]
fn vectors_are_within_their_errors_whatever_the_size() {
    let third = Number::from_rational(BigRational::new(1.into(), 3.into()));
    let slanted = |scale: &Number| {
        let at = |[x, y, z]: [i32; 3]| Vec3::new(x, y, z).map(|&c| Number::from_integer(c).times(scale));
        Block::cuboid(&at([0, 0, 0]), &at([1, 2, 3])).unwrap()
    };
    for exponent in (-1000..=500).step_by(25) {
        let scale = float(2f64.powi(exponent));
        for (name, block) in
            [("bent", bent_box(&scale)), ("straight", slanted(&scale)), ("thirds", bent_box(&scale.times(&third)))]
        {
            vectors_are_within_their_errors(&block, &format!("{name}, 2^{exponent}"));
        }
    }
}

#[test]
fn the_worst_normal_is_that_of_all_triangles_of_a_loop() {
    let triangle = VectorErrors::worst(1.0, 0.0, 3).normal;
    for corners in 3..=40 {
        let normal = VectorErrors::worst(1.0, 0.0, corners).normal;
        let triangles = (corners - 2) as f64;
        // Each triangle's cross product has components of two products of sides, which are at most 1.
        assert!(normal.magnitude >= 2.0 * triangles, "{corners} corners: {normal:?}");
        assert!(normal.error >= triangles * triangle.error * (1.0 - 1e-9), "{corners} corners: {normal:?}");
    }
}
