//! Depths worked by hand, ties included, and what turning, scaling and moving the blocks may not change; and random pairs
//! beside plain searches: of all directions, of all vertices, of all pairs.

use crate::support::random_numbers::Random;
use crate::support::shapes::{block, cuboid, exact, number, point, step, tetrahedron, turn};
use num_rational::BigRational;
use rockproof_model::{Block, Number, Sign, Vec3};
use rockproof_oracle::penetration::{deepest, penetration};

fn squared(a: &Block, b: &Block) -> (Sign, BigRational) {
    let found = penetration(a, b).unwrap();
    (found.gap.sign, found.gap.squared)
}

/// Turned about z by the angle of cosine 3/5, about x by that of cosine 5/13, and scaled.
fn moved(block: &Block, scale: &str) -> Block {
    let n = |t: &str| number(t);
    let vertices = block.vertices().iter().map(|v| {
        let (x, y) = turn(&v.x, &v.y, ["3/5", "4/5"]);
        let (y, z) = turn(&y, &v.z, ["5/13", "12/13"]);
        Vec3::new(x.times(&n(scale)).plus(&n("1/7")), y.times(&n(scale)), z.times(&n(scale)))
    });
    block.with_vertices(vertices.collect())
}

/// Pairs with the sign and the square of their gap.
fn cases() -> Vec<(Block, Block, Sign, BigRational)> {
    let unit = || cuboid(["0", "0", "0"], ["1", "1", "1"]);
    // The tip of a tetrahedron with right angles, (0, 0, 0), pushed into a corner cut along x + y + z = s.
    let corner = |at: &str| {
        tetrahedron([["0", "0", "0"], ["3", "0", "0"], ["0", "3", "0"], ["0", "0", "3"]]).translated(&point([at; 3]))
    };
    // Two wedges' ridges crossing at right angles, 1/4 deep.
    let ridge = |z: &str| tetrahedron([["-2", "0", z], ["2", "0", z], ["0", "-2", "-4"], ["0", "2", "-4"]]);
    let hanging = tetrahedron([["0", "-2", "0"], ["0", "2", "0"], ["-2", "0", "4"], ["2", "0", "4"]]);
    vec![
        // Overlap 1/4 × 1/2 × 1: the least is 1/4.
        (unit(), cuboid(["3/4", "1/2", "0"], ["2", "2", "1"]), Sign::Negative, exact("1/16")),
        // A tie of three directions.
        (unit(), cuboid(["1/2", "1/2", "1/2"], ["2", "2", "2"]), Sign::Negative, exact("1/4")),
        // One inside the other: out through the nearest side, whole width included.
        (
            cuboid(["0", "0", "0"], ["8", "8", "8"]),
            cuboid(["1", "3", "3"], ["2", "5", "5"]),
            Sign::Negative,
            exact("4"),
        ),
        // Touching.
        (unit(), cuboid(["1", "0", "0"], ["2", "1", "1"]), Sign::Zero, exact("0")),
        (unit(), cuboid(["1", "1", "1"], ["2", "2", "2"]), Sign::Zero, exact("0")),
        // Apart by 1/3.
        (unit(), cuboid(["4/3", "0", "0"], ["2", "1", "1"]), Sign::Positive, exact("1/9")),
        // The corner (1,1,1) of the cube through the slanted face x + y + z = 3 of a tetrahedron moved by −1/2: the plane
        // is x + y + z = 3/2 then, and the cube's corner at 0 lies 3/2 below: (3/2)²/3.
        (corner("-1/2"), unit(), Sign::Negative, exact("3/4")),
        // Edge to edge: the ridge at 1/4 against the one at 0, normal z.
        (hanging, ridge("1/4"), Sign::Negative, exact("1/16")),
    ]
}

#[test]
fn hand_worked_depths_come_out_moved_turned_and_scaled() {
    for (k, (a, b, sign, square)) in cases().into_iter().enumerate() {
        assert_eq!(squared(&a, &b), (sign, square.clone()), "case {k}");
        assert_eq!(squared(&b, &a), (sign, square.clone()), "case {k} exchanged");
        let (c, d) = (moved(&a, "3/2"), moved(&b, "3/2"));
        assert_eq!(squared(&c, &d), (sign, square * exact("9/4")), "case {k} moved");
    }
}

#[test]
fn the_translation_it_names_parts_the_blocks_and_less_does_not() {
    for (k, (a, b, sign, square)) in cases().into_iter().enumerate() {
        if sign != Sign::Negative {
            continue;
        }
        let found = penetration(&a, &b).unwrap();
        let length = found.direction.norm_squared();
        // Where depth over length is a fraction, the translation itself is one.
        let share: BigRational = square / length;
        let root = BigRational::new(share.numer().sqrt(), share.denom().sqrt());
        if &root * &root != share {
            continue;
        }
        for (factor, expected) in [("1", Sign::Zero), ("999/1000", Sign::Negative), ("1001/1000", Sign::Positive)] {
            let by = found.direction.map(|c| rockproof_model::Number::from_rational(c * &root * exact(factor)));
            assert_eq!(squared(&a.translated(&by), &b).0, expected, "case {k}, {factor}");
        }
    }
}

#[test]
fn a_depth_is_rounded_to_the_nearest_float() {
    let slanted = tetrahedron([["0", "0", "0"], ["3", "0", "0"], ["0", "3", "0"], ["0", "0", "3"]]);
    let found = penetration(&slanted, &cuboid(["9/10", "9/10", "9/10"], ["4", "4", "4"])).unwrap();
    assert_eq!(found.gap.squared, exact("3/100"));
    assert_eq!(found.depth_m(), Some(0.173_205_080_756_887_73));
}

#[test]
fn a_scene_names_its_deepest_pair() {
    let blocks = [
        cuboid(["0", "0", "0"], ["1", "1", "1"]),
        cuboid(["7/8", "0", "0"], ["2", "1", "1"]),
        cuboid(["0", "3/4", "0"], ["1/2", "2", "1"]),
        cuboid(["5", "5", "5"], ["6", "6", "6"]),
        step().translated(&point(["5", "5", "5"])),
    ];
    // The first three overlap by 1/8 and 1/4 as convex pairs; the cube's vertices at z = 5 and 6 are on the step's surface
    // and 1 deep inside it.
    let (found, left_out) = deepest(&blocks.iter().collect::<Vec<_>>());
    let found = found.unwrap();
    assert_eq!((found.blocks, found.penetration.depth_m(), left_out), ([3, 4], Some(1.0), 0));
    let (found, _) = deepest(&blocks[..3].iter().collect::<Vec<_>>());
    let found = found.unwrap();
    assert_eq!((found.blocks, found.penetration.depth_m()), ([0, 2], Some(0.25)));
    assert_eq!(deepest(&[&blocks[0], &blocks[3]]), (None, 0));
}

#[test]
fn a_scene_names_the_first_of_equal_pairs_and_none_that_miss() {
    let cube = |x: &str| cuboid(["0", "0", "0"], ["1", "1", "1"]).translated(&point([x, "0", "0"]));
    let row = [cube("0"), cube("7/8"), cube("14/8")];
    let (found, left_out) = deepest(&row.iter().collect::<Vec<_>>());
    assert_eq!((found.map(|found| found.blocks), left_out), (Some([0, 1]), 0));
    // Their boxes overlap, they do not; nor do those that touch along a slope.
    let corner = |z: &str| tetrahedron([["0", "0", "0"], ["4", "0", "0"], ["0", "4", "0"], ["0", "0", z]]);
    for far in ["4", "3", "2"] {
        let other = tetrahedron([[far, far, far], [far, "0", far], ["0", far, far], [far, far, "0"]]);
        let apart = [corner("4"), other];
        let touches = squared(&apart[0], &apart[1]).0;
        assert_eq!((deepest(&apart.each_ref()).0, touches.is_negative()), (None, false), "{far}");
    }
    // Squeezed to a segment a concave block has no face that a depth could be measured from.
    let squeezed = step().vertices().iter().map(|v| Vec3::new(v.x.clone(), number("1/2"), number("1/2"))).collect();
    let segment = step().with_vertices(squeezed);
    assert_eq!(deepest(&[&row[1], &segment]), (None, 1));
    assert_eq!(deepest(&[&row[1], &segment, &segment]).1, 2);
}

#[test]
fn a_scene_names_its_deepest_pair_where_floats_see_none() {
    // By 1e-30 m, which no f64 beside 1 m holds, along each axis; the second pair touches exactly, the third is deeper by as little.
    for axis in 0..3 {
        let at = |start: &str| {
            let mut low = ["0"; 3];
            low[axis] = start;
            cuboid(["0", "0", "0"], ["1", "1", "1"]).translated(&point(low))
        };
        let just_below = "999999999999999999999999999999/1000000000000000000000000000000";
        let blocks =
            [at("0"), at(just_below), at("-1"), at("-1999999999999999999999999999998/1000000000000000000000000000000")];
        let two = |k: usize, n: usize| deepest(&[&blocks[k], &blocks[n]]).0;
        let depth = |n: &str| exact(n) * exact(n);
        let found = two(0, 1).unwrap();
        assert_eq!(found.penetration.gap.squared, depth("1/1000000000000000000000000000000"), "axis {axis}");
        assert_eq!(two(0, 2), None, "axis {axis}");
        let (found, _) = deepest(&blocks.iter().collect::<Vec<_>>());
        let found = found.unwrap();
        assert_eq!(found.blocks, [2, 3], "axis {axis}");
        assert_eq!(found.penetration.gap.squared, depth("2/1000000000000000000000000000000"), "axis {axis}");
    }
}

impl Random {
    fn fraction(&mut self, end: u64, denominator: i64) -> BigRational {
        BigRational::new(self.below(end).into(), denominator.into())
    }
}

/// A tetrahedron or a box with random corners near the origin, some of them turned, some far too thin.
fn convex(random: &mut Random) -> Block {
    let corner = |random: &mut Random| [0; 3].map(|_| random.fraction(33, 8) - exact("2"));
    if random.below(3) > 0 {
        loop {
            let points = [0; 4].map(|_| corner(random));
            let at = points.map(|[x, y, z]| Vec3::new(x, y, z));
            let [a, b, c] = [1, 2, 3].map(|k| at[k].minus(&at[0]));
            let vertices = |order: [usize; 4]| order.map(|k| at[k].map(|c| Number::from_rational(c.clone()))).to_vec();
            let volume = a.cross(&b).dot(&c);
            let faces: [&[u32]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]];
            if volume > exact("0") {
                return block(vertices([0, 1, 2, 3]), &faces);
            } else if volume < exact("0") {
                return block(vertices([0, 2, 1, 3]), &faces);
            }
        }
    }
    let low = corner(random);
    let at = |c: [BigRational; 3]| {
        Vec3::new(c[0].clone(), c[1].clone(), c[2].clone()).map(|c| Number::from_rational(c.clone()))
    };
    let high = low.clone().map(|c| c + exact("1/16") + random.fraction(24, 8));
    let cuboid = Block::cuboid(&at(low), &at(high)).unwrap();
    if random.below(2) == 0 { cuboid } else { moved(&cuboid, "1") }
}

/// The largest gap over the faces' normals (from B to A) and products of edges, in plain fractions: its sign and square.
fn over_all_directions(a: &Block, b: &Block) -> (Sign, BigRational) {
    let points = [a, b].map(|block| block.vertices().iter().map(|v| v.map(Number::to_rational)).collect::<Vec<_>>());
    let mut directions = Vec::new();
    let along = |side: usize, block: &Block| -> Vec<Vec3<BigRational>> {
        let ends = block.topology().edges().iter().map(|e| (e.p.index(), e.q.index()));
        ends.map(|(p, q)| points[side][q].minus(&points[side][p])).collect()
    };
    for (side, block) in [a, b].into_iter().enumerate() {
        for face in block.topology().faces() {
            let [p, q, r] = [face[0], face[1], face[2]].map(|v| &points[side][v.index()]);
            let outward = q.minus(p).cross(&r.minus(p));
            directions.push(if side == 0 { outward.negated() } else { outward });
        }
    }
    for one in along(0, a) {
        directions.extend(along(1, b).iter().flat_map(|other| [one.cross(other), other.cross(&one)]));
    }
    let zero = exact("0");
    let mut best: Option<BigRational> = None;
    for n in directions {
        let square = n.norm_squared();
        if square == zero {
            continue;
        }
        let low = points[0].iter().map(|p| n.dot(p)).min().unwrap();
        let high = points[1].iter().map(|p| n.dot(p)).max().unwrap();
        let gap = low - high;
        let signed = if gap < zero { -(&gap * &gap) } else { &gap * &gap } / square;
        best = Some(best.map_or(signed.clone(), |best| best.max(signed)));
    }
    let best = best.unwrap();
    match best.cmp(&zero) {
        std::cmp::Ordering::Less => (Sign::Negative, -best),
        std::cmp::Ordering::Equal => (Sign::Zero, best),
        std::cmp::Ordering::Greater => (Sign::Positive, best),
    }
}

#[test]
fn convex_depths_are_those_of_all_directions() {
    let mut random = Random(7);
    let mut signs = [0; 3];
    for k in 0..150 {
        let (a, b) = (convex(&mut random), convex(&mut random));
        let found = squared(&a, &b);
        assert_eq!(found, over_all_directions(&a, &b), "pair {k}");
        signs[if found.0.is_negative() { 0 } else { 1 + usize::from(found.0.is_zero()) }] += 1;
    }
    assert!(signs[0] > 30 && signs[1] > 10, "{signs:?}");
}

#[test]
fn the_deepest_of_a_scene_is_that_of_all_pairs() {
    let mut random = Random(11);
    for _ in 0..6 {
        let mut blocks: Vec<Block> = (0..6).map(|_| convex(&mut random)).collect();
        blocks.push(step().translated(&point(["-2", "0", "-1"])));
        let all: Vec<&Block> = blocks.iter().collect();
        let mut best: Option<([usize; 2], BigRational)> = None;
        for i in 0..all.len() {
            for j in i + 1..all.len() {
                let (sign, square) = squared(all[i], all[j]);
                if sign.is_negative() && best.as_ref().is_none_or(|(_, other)| square > *other) {
                    best = Some(([i, j], square));
                }
            }
        }
        let (found, left_out) = deepest(&all);
        assert_eq!(found.map(|d| (d.blocks, d.penetration.gap.squared)), best);
        assert_eq!(left_out, 0);
    }
}

/// The surface of [`step`] as rectangles along the axes, least and greatest corners, and its inside as two boxes.
const STEP_RECTANGLES: [[[i64; 3]; 2]; 10] = [
    [[0, -4, 0], [4, 4, 0]],
    [[4, -4, 0], [4, 4, 2]],
    [[2, -4, 2], [4, 4, 2]],
    [[2, -4, 2], [2, 4, 4]],
    [[0, -4, 4], [2, 4, 4]],
    [[0, -4, 0], [0, 4, 4]],
    [[0, -4, 0], [4, -4, 2]],
    [[0, -4, 2], [2, -4, 4]],
    [[0, 4, 0], [4, 4, 2]],
    [[0, 4, 2], [2, 4, 4]],
];
const STEP_BOXES: [[[i64; 3]; 2]; 2] = [[[0, -4, 0], [4, 4, 2]], [[0, -4, 0], [2, 4, 4]]];

fn beyond(value: &BigRational, low: i64, high: i64) -> BigRational {
    let [low, high] = [low, high].map(|end| BigRational::from_integer(end.into()));
    (low - value).max(value - high).max(exact("0"))
}

/// The squared distance of a point inside the step from its surface; zero outside.
fn depth_in_step(at: &Vec3<BigRational>) -> BigRational {
    let distance = |[low, high]: &[[i64; 3]; 2]| -> BigRational {
        (0..3).map(|k| beyond(at.components()[k], low[k], high[k])).map(|d| &d * &d).sum()
    };
    if STEP_BOXES.iter().all(|inside| distance(inside) > exact("0")) {
        return exact("0");
    }
    STEP_RECTANGLES.iter().map(distance).min().unwrap()
}

#[test]
fn concave_depths_are_those_of_all_vertices() {
    let mut random = Random(3);
    let (mut deep, mut none) = (0, 0);
    for k in 0..60 {
        let (l, other) = (step(), convex(&mut random).translated(&point(["2", "1", "2"])));
        let of_other = other.vertices().iter().map(|v| depth_in_step(&v.map(Number::to_rational))).max().unwrap();
        // The step's vertices inside the other block, convex: inside all planes, the nearest plane the nearest point.
        let points: Vec<_> = other.vertices().iter().map(|v| v.map(Number::to_rational)).collect();
        let of_step = l.vertices().iter().map(|v| {
            let v = v.map(Number::to_rational);
            let depths = other.topology().faces().iter().map(|face| {
                let [p, q, r] = [face[0], face[1], face[2]].map(|v| &points[v.index()]);
                let n = q.minus(p).cross(&r.minus(p));
                let off = n.dot(&p.minus(&v));
                if off > exact("0") { &off * &off / n.norm_squared() } else { exact("0") }
            });
            depths.min().unwrap()
        });
        let expected = of_other.max(of_step.max().unwrap());
        let sign = if expected > exact("0") { Sign::Negative } else { Sign::Zero };
        assert_eq!(squared(&l, &other), (sign, expected.clone()), "pair {k}");
        assert_eq!(squared(&other, &l), (sign, expected.clone()), "pair {k} exchanged");
        let square = &expected * exact("4");
        assert_eq!(squared(&moved(&l, "2"), &moved(&other, "2")), (sign, square), "pair {k} moved");
        if expected > exact("0") { deep += 1 } else { none += 1 }
    }
    assert!(deep > 20 && none > 2, "{deep} deep, {none} not");
}

#[test]
fn the_way_out_of_a_concave_block_leads_to_its_surface() {
    // A cube's corner (3/2, −2, 1) is 1 inside the step, whose bottom is the nearest. Its other corners are no deeper.
    let cube = cuboid(["3/2", "-2", "-2"], ["3", "3", "1"]);
    for (a, b, down) in [(cube.clone(), step(), true), (step(), cube, false)] {
        let found = penetration(&a, &b).unwrap();
        assert_eq!((found.gap.sign, found.gap.squared.clone()), (Sign::Negative, exact("1")));
        assert_eq!(found.direction.z < exact("0"), down);
        assert!(found.direction.x == exact("0") && found.direction.y == exact("0"));
    }
}
