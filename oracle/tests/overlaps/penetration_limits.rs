//! Depths at the limits of what f64 tells apart: pairs that a scene's search may leave out, directions that must be measured
//! exactly, and points on the surface of blocks that are not convex.

use crate::support::shapes::{block, cuboid, exact, notched_cube, number, plus_sign, point, step, tetrahedron, turned};
use num_rational::BigRational;
use rockproof_model::{Block, Number, Sign, Vec3};
use rockproof_oracle::penetration::{deepest, penetration};

/// The sign and the square of the gap, the same both ways round.
fn squared(a: &Block, b: &Block) -> (Sign, BigRational) {
    let [found, other] = [(a, b), (b, a)].map(|(a, b)| penetration(a, b).unwrap().gap);
    assert_eq!((other.sign, &other.squared), (found.sign, &found.squared), "{a:?}\n{b:?}");
    (found.sign, found.squared)
}

/// The square of the depth, the same both ways round.
fn depth_squared(a: &Block, b: &Block) -> BigRational {
    let (sign, square) = squared(a, b);
    assert_eq!(sign, Sign::Negative);
    square
}

fn mapped(block: &Block, map: impl Fn(&Vec3<Number>) -> Vec3<Number>) -> Block {
    block.with_vertices(block.vertices().iter().map(map).collect())
}

/// Turned about y by 45° and √2 times as large: depths' squares are twice as much.
fn on_edge(block: &Block) -> Block {
    mapped(block, |v| Vec3::new(v.x.plus(&v.z.negated()), v.y.clone(), v.x.plus(&v.z)))
}

fn halved(block: &Block) -> Block {
    mapped(block, |v| v.map(|c| c.times(&number("1/2"))))
}

fn power(base: i32, exponent: i32) -> BigRational {
    BigRational::from_integer(base.into()).pow(exponent)
}

/// The box from `x` to `end` along x and from 0 to `width` along y and z.
fn bar(x: &BigRational, end: &BigRational, width: &str) -> Block {
    let text = [x, end].map(BigRational::to_string);
    cuboid([&text[0], "0", "0"], [&text[1], width, width])
}

fn bar_of(x: &str, end: &str, width: &str) -> Block {
    bar(&exact(x), &exact(end), width)
}

#[test]
fn a_scene_leaves_no_pair_out_that_may_be_the_deepest() {
    let tiny = |x: &str, depth: &str| {
        let (x, depth, length) = (exact(x), exact(depth), exact("1/1000"));
        let other = &x + &length - depth;
        [bar(&x, &(&x + &length), "1/1000"), bar(&other, &(&other + &length), "1/1000")]
    };
    let large = [bar_of("0", "4", "4"), bar_of("2", "6", "4")];
    let scenes = [
        // All coordinates whole; all even, so that a lattice unit is longer than a metre.
        (vec![bar_of("0", "3", "3"), bar_of("1", "4", "3")], "2"),
        (large.to_vec(), "2"),
        // Beside a shallower pair.
        ([&large[..], &[bar_of("101", "105", "4"), bar_of("104", "108", "4")]].concat(), "2"),
        // By 1/10 and a little more, in large blocks, of which f64 knows less; and by 1/10.
        (
            vec![
                bar_of("0", "1000", "1000"),
                bar_of("99989999999/100000000", "2000", "1000"),
                bar_of("5000", "5001", "1"),
                bar_of("50009/10", "5002", "1"),
            ],
            "10000001/100000000",
        ),
        // The same far from the origin and near it.
        ([tiny("21000004/21", "10000001/100000000000"), tiny("8", "1/10000")].concat(), "10000001/100000000000"),
    ];
    for (k, (blocks, depth)) in scenes.into_iter().enumerate() {
        let square = exact(depth) * exact(depth);
        let (found, left_out) = deepest(&blocks.iter().collect::<Vec<_>>());
        let found = found.unwrap();
        assert_eq!((found.blocks, found.penetration.gap.squared, left_out), ([0, 1], square.clone(), 0), "scene {k}");
        assert_eq!(depth_squared(&blocks[0], &blocks[1]), square, "scene {k}");
    }
}

#[test]
fn blocks_without_faces_hide_no_other_pair() {
    let unit = bar_of("0", "1", "1");
    // Two cubes squeezed to one line, still convex: nothing is known of their depth.
    let line =
        |from: &str| mapped(&unit, |v| Vec3::new(v.x.clone(), v.x.clone(), v.x.clone()).map(|c| c.plus(&number(from))));
    let blocks = [line("0"), line("1/2"), bar_of("10", "11", "1"), bar_of("43/4", "12", "1")];
    let (found, left_out) = deepest(&blocks.each_ref());
    assert_eq!((found.map(|found| found.blocks), left_out), (Some([2, 3]), 1));
    // A step squeezed to a segment through both of two cubes; and to one that touches a cube along its side.
    let segment = |y: &str| mapped(&step(), |v| Vec3::new(v.x.clone(), number(y), number("1/2")));
    let blocks = [unit.clone(), bar_of("1/4", "2", "1"), segment("1/2")];
    let (found, left_out) = deepest(&blocks.each_ref());
    assert_eq!((found.map(|found| found.blocks), left_out), (Some([0, 1]), 2));
    assert_eq!(deepest(&[&unit, &segment("1")]), (None, 0));
}

#[test]
fn of_directions_that_floats_do_not_tell_apart_the_best_is_named() {
    let unit = bar_of("0", "1", "1");
    let little = |k: usize| exact("1/2") + BigRational::from_integer(k.into()) * power(10, -25);
    let expected = exact("1/2") - BigRational::from_integer(2.into()) * power(10, -25);
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let low = order.map(|k| little(k).to_string());
        let other = cuboid(low.each_ref().map(String::as_str), ["2"; 3]);
        assert_eq!(depth_squared(&turned(&unit), &turned(&other)), &expected * &expected, "{order:?}");
    }
    // Three ways out are equally long: A's first face, its top, is the one. It was turned to (0, −12/13, 5/13), and A
    // moves the other way.
    let found = penetration(&turned(&unit), &turned(&cuboid(["1/2"; 3], ["2"; 3]))).unwrap();
    assert_eq!(found.gap.squared, exact("1/4"));
    assert_eq!(found.direction.x, exact("0"));
    assert_eq!(&found.direction.y * exact("5"), -&found.direction.z * exact("12"));
    assert!(found.direction.y > exact("0"));
    // So little that no f64 is as small.
    let depth = power(3, -700);
    assert_eq!(depth_squared(&unit, &bar(&(exact("1") - &depth), &exact("2"), "1")), &depth * &depth);
    // In thin plates, almost parallel edges of which say little: out along x, not up.
    let thickness = power(2, -20).to_string();
    let (a, b) = ((exact("1") - power(2, -30)).to_string(), power(10, -40));
    let [low, high] = [b.clone(), exact("1") + b].map(|y| y.to_string());
    let plates = [cuboid(["0", "0", "0"], ["1", "1", &thickness]), cuboid([&a, &low, "0"], ["2", &high, &thickness])];
    assert_eq!(depth_squared(&plates[0], &plates[1]), power(2, -60));
}

#[test]
fn ridges_that_cross_at_a_small_angle_part_along_the_normal_of_both() {
    // One ridge along (1, 0, 0) at height h, the other, downwards, along (1, θ, 0) at 0, θ = 4·h. Tilted by t across a
    // ridge the depth would be (h + 2·θ·t)/√(1 + t²) at least: not less than h for any t.
    for digits in [3, 22, 30, 60, 200] {
        let theta = power(3, -digits);
        let h = &theta / BigRational::from_integer(4.into());
        let at = |x: i32, y: BigRational, z: BigRational| {
            Vec3::new(BigRational::from_integer(x.into()), y, z).map(|c| Number::from_rational(c.clone()))
        };
        let n = |n: i32| BigRational::from_integer(n.into());
        let faces: [&[u32]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]];
        let below =
            vec![at(-2, n(0), h.clone()), at(2, n(0), h.clone()), at(0, n(-2), &h - n(4)), at(0, n(2), &h - n(5))];
        let above =
            vec![at(2, &theta * n(2), n(0)), at(-3, &theta * n(-3), n(0)), at(0, n(-2), n(4)), at(0, n(2), n(5))];
        let (a, b) = (block(above, &faces), block(below, &faces));
        assert_eq!(depth_squared(&turned(&a), &turned(&b)), &h * &h, "3^-{digits}");
    }
}

#[test]
fn the_deepest_point_of_a_pair_is_found_however_it_is_placed() {
    let cases = [
        // A bar fills an arm of the plus sign: no edge passes through a face, and the middle of what they share is half the
        // thickness, 1/2, from the sides.
        (halved(&plus_sign()), halved(&cuboid(["1", "-1", "0"], ["2", "4", "1"])), "1/16"),
        // A tip 1 above the bottom of a step and √5/2 from its reflex edge; beside the wall's plane, not beside the wall.
        (step(), tetrahedron([["3/2", "0", "1"], ["3", "1", "-3"], ["2", "-1", "-3"], ["1", "1", "-3"]]), "1"),
        // Tips in a cube without a corner: 1 above its bottom and farther from the notch; √(1/4 + 1/4) from an edge of the
        // notch and 3/2 from the sides.
        (
            notched_cube(),
            tetrahedron([["3/2", "3/2", "1"], ["5/2", "3/2", "-3"], ["1/2", "1/2", "-3"], ["1/2", "5/2", "-3"]]),
            "1",
        ),
        (
            notched_cube(),
            tetrahedron([["3/2", "2", "3/2"], ["5/2", "2", "-5/2"], ["1/2", "1", "-5/2"], ["1/2", "3", "-5/2"]]),
            "1/2",
        ),
    ];
    for (k, (a, b, square)) in cases.into_iter().enumerate() {
        assert_eq!(depth_squared(&a, &b), exact(square), "case {k}");
        assert_eq!(depth_squared(&turned(&a), &turned(&b)), exact(square), "case {k} turned");
        assert_eq!(depth_squared(&on_edge(&a), &on_edge(&b)), exact(square) * exact("2"), "case {k} on edge");
    }
}

#[test]
fn a_point_on_a_triangle_of_an_uneven_face_is_not_inside() {
    // The tip (1, −3, 0) is on the triangle of vertices 1, 0 and 6 of the step's bottom, and below it nothing of the step is
    // near. The fourth corner of the bottom is lifted or lowered, so that the bottom's mean plane is not that triangle's.
    let below = tetrahedron([["1", "-3", "0"], ["2", "-3", "-3"], ["0", "-4", "-3"], ["0", "-2", "-3"]]);
    for height in ["1/1000", "-1/1000"] {
        let mut vertices = step().vertices().to_vec();
        vertices[7] = point(["4", "4", height]);
        let uneven = step().with_vertices(vertices);
        assert_eq!(squared(&uneven, &below), (Sign::Zero, exact("0")), "{height}");
        assert_eq!(squared(&turned(&uneven), &turned(&below)), (Sign::Zero, exact("0")), "{height} turned");
    }
}
