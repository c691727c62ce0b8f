mod plain;

use super::*;
use crate::convex_cells::cells;
use crate::point_in_surface::triangle_corners;
use num_rational::BigRational;
use rockproof_model::block::Point;
use rockproof_model::{BlockOptions, Number, Precision, VertexId};

/// Whether the convex cells of two blocks overlap, those of a block that is not convex being cut by all planes of its faces:
/// the slow way.
fn cells_meet(a: &Block, b: &Block) -> bool {
    let parts = |block: &Block| -> Vec<SeparablePoints> {
        if block.is_convex() {
            return vec![SeparablePoints::new(block.vertices().to_vec())];
        }
        let number = |c: &BigRational| Number::from_rational(c.clone());
        let points = |p: &Vec3<BigRational>| p.map(number);
        cells(block).iter().map(|cell| SeparablePoints::new(cell.vertices().iter().map(points).collect())).collect()
    };
    let (ones, twos) = (parts(a), parts(b));
    ones.iter().any(|one| twos.iter().any(|two| !separate(one.set(), two.set()).is_separated))
}

fn meet(a: &Block, b: &Block) -> bool {
    let points = |block: &Block| SeparablePoints::new(block.vertices().to_vec());
    match [a, b].map(Block::is_convex) {
        [true, true] => !separate(points(a).set(), points(b).set()).is_separated,
        [false, true] => meets_hull(a, points(b).set()),
        [true, false] => meets_hull(b, points(a).set()),
        [false, false] => surfaces_meet(a, b),
    }
}

/// A prism of height 2 over a polygon that goes round counter-clockwise.
fn prism(corners: &[[i32; 2]]) -> Block {
    let n = corners.len() as u32;
    let at = |z: i32| corners.iter().map(move |c| Vec3::new(c[0], c[1], z).map(|&c| Number::from_integer(c)));
    let sides = (0..n).map(|k| vec![k, (k + 1) % n, (k + 1) % n + n, k + n]);
    let faces = [(0..n).rev().collect(), (n..2 * n).collect()].into_iter().chain(sides).collect();
    Block::new(at(0).chain(at(2)).collect(), faces, &BlockOptions { planarity: Number::ZERO }).unwrap()
}

fn shapes() -> [Block; 4] {
    [
        // An L, first seen from its reflex corner, then not, so that triangles of its faces reach out of them; a V; a box.
        prism(&[[2, 2], [2, 4], [0, 4], [0, 0], [4, 0], [4, 2]]),
        prism(&[[0, 0], [4, 0], [4, 2], [2, 2], [2, 4], [0, 4]]),
        prism(&[[0, 4], [2, 0], [4, 4], [2, 1]]),
        prism(&[[0, 0], [3, 0], [3, 2], [0, 2]]),
    ]
}

/// SplitMix64: the same pairs everywhere.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> i32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % end) as i32
    }

    fn offset(&mut self) -> Point {
        let mut along = || number(self.below(17) - 8, 2);
        Vec3::new(along(), along(), along())
    }

    /// Each coordinate moved by up to two times `step` either way.
    fn bent(&mut self, block: &Block, step: &Number) -> Block {
        let mut along = |c: &Number| c.plus(&step.times(&Number::from_integer(self.below(5) - 2)));
        block.with_vertices(block.vertices().iter().map(|v| v.map(&mut along)).collect())
    }
}

fn number(n: i32, d: i32) -> Number {
    Number::from_rational(BigRational::new(n.into(), d.into()))
}

/// Turned about z by the angle of cosine 3/5, then about x by that of cosine 5/13, and scaled.
fn turned_exactly(block: &Block, by: &Number) -> Block {
    let turn = |a: &Number, b: &Number, c: Number, s: Number| {
        (a.times(&c).plus(&b.times(&s).negated()), a.times(&s).plus(&b.times(&c)))
    };
    let vertices = block.vertices().iter().map(|v| {
        let (x, y) = turn(&v.x, &v.y, number(3, 5), number(4, 5));
        let (y, z) = turn(&y, &v.z, number(5, 13), number(12, 13));
        Vec3::new(x, y, z).map(|c| c.times(by))
    });
    block.with_vertices(vertices.collect())
}

/// Turned and rounded to f32: neighbours' faces that were in one plane are bent by roundoffs.
fn turned(block: &Block) -> Block {
    turned_exactly(block, &number(1, 1)).rounded(Precision::F32).unwrap()
}

/// The answer for pairs of one sort, compared with that of the cells: how many meet and how many do not.
fn compared(pairs: impl IntoIterator<Item = (Block, Block)>) -> [usize; 2] {
    let mut counts = [0; 2];
    for (a, b) in pairs {
        let expected = cells_meet(&a, &b);
        assert_eq!(meet(&a, &b), expected, "{a:?}\n{b:?}");
        assert_eq!(meet(&b, &a), expected, "{b:?}\n{a:?}");
        counts[usize::from(expected)] += 1;
    }
    counts
}

/// Pairs of which one is not convex at least, B somewhere at A.
fn pairs(random: &mut Random, count: usize) -> Vec<(Block, Block)> {
    let shapes = shapes();
    let pick = |k: usize| shapes[k % shapes.len()].clone();
    (0..count).map(|k| (pick(k % 3), pick(k / 3).translated(&random.offset()))).collect()
}

/// Pairs with planar faces, and with bent ones; cells take long.
const PAIRS: [usize; 2] = if cfg!(debug_assertions) { [24, 3] } else { [120, 4] };

#[test]
fn surfaces_say_what_convex_cells_say_of_blocks_with_planar_faces() {
    let mut random = Random(1);
    let plain = pairs(&mut random, PAIRS[0]);
    let [apart, meeting] = compared(plain);
    assert!(apart > PAIRS[0] / 6 && meeting > PAIRS[0] / 6, "{apart} {meeting}");
}

#[test]
fn surfaces_say_what_convex_cells_say_of_blocks_bent_by_rounding() {
    compare_rounded(&mut Random(2), PAIRS[1]);
}

#[test]
fn surfaces_say_what_convex_cells_say_of_bent_blocks() {
    let mut random = Random(2);
    // As many numbers as the rounded blocks take, so that both tests have the pairs that one of full size has.
    pairs(&mut random, PAIRS[1]);
    compare_bent(&mut random, PAIRS[1]);
}

#[test]
#[ignore = "fifteen seconds; .ci/run runs it"]
fn surfaces_say_what_convex_cells_say_of_bent_blocks_at_full_size() {
    let mut random = Random(2);
    compare_rounded(&mut random, 12);
    compare_bent(&mut random, 12);
}

fn compare_rounded(random: &mut Random, count: usize) {
    let rounded: Vec<_> = pairs(random, count).iter().map(|(a, b)| (turned(a), turned(b))).collect();
    let [apart, meeting] = compared(rounded);
    assert!(cfg!(debug_assertions) || apart > 0 && meeting * 4 > count, "{apart} {meeting}");
}

/// Faces so bent that surfaces pass through themselves.
fn compare_bent(random: &mut Random, count: usize) {
    let bent = pairs(random, count);
    let bent: Vec<_> =
        bent.iter().map(|(a, b)| (random.bent(a, &number(1, 4)), random.bent(b, &number(1, 4)))).collect();
    let [apart, meeting] = compared(bent);
    assert!(cfg!(debug_assertions) || apart > 0 && meeting * 4 > count, "{apart} {meeting}");
}

#[test]
fn a_block_in_another_or_equal_to_it_meets_it_and_one_in_a_notch_does_not() {
    let [l, other, v, _] = shapes();
    let scaled = |block: &Block, by: i32| {
        let by = number(1, by);
        block.with_vertices(block.vertices().iter().map(|p| p.map(|c| c.times(&by).plus(&by))).collect())
    };
    let notch = prism(&[[2, 2], [3, 2], [3, 3], [2, 3]]);
    let cases = [
        (l.clone(), l.clone(), true),
        // Other triangles of the same faces.
        (l.clone(), other.clone(), true),
        (turned(&l), turned(&other), true),
        (v.clone(), v.clone(), true),
        (l.clone(), scaled(&v, 4), true),
        (other.clone(), scaled(&notch, 8), true),
        // Through the top alone, within a triangle of it that reaches over the notch and so is cut into pieces; most of it is outside.
        (l.clone(), scaled(&notch, 8).translated(&Vec3::new(number(19, 10), number(1, 10), number(9, 5))), true),
        (l.clone(), notch.clone(), false),
        (other.clone(), notch.clone(), false),
        (v, l.translated(&Vec3::new(number(4, 1), number(0, 1), number(0, 1))), false),
    ];
    for (k, (a, b, expected)) in cases.into_iter().enumerate() {
        assert_eq!([meet(&a, &b), meet(&b, &a)], [expected; 2], "case {k}");
    }
    // In the hull of the L alone, a little into the L, and far from the origin, where f64 decides little.
    for (by, expected) in [(number(1, 8), false), (number(-1, 1 << 30), true), (number(0, 1), false)] {
        let far = Vec3::new(number(1 << 30, 1), number(1 << 29, 3), number(0, 1));
        let moved = notch.translated(&Vec3::new(by.clone(), by, number(0, 1)));
        let (a, b) = (l.translated(&far), moved.translated(&far));
        assert_eq!([meet(&a, &b), meet(&b, &a)], [expected; 2]);
    }
    // In an L as large as 2⁶⁰ m, and so far from its first vertex that f64 does not tell a triangle of it from a line.
    let times = |factor: Number, add: Number| {
        let place = |c: &Number| c.times(&factor).plus(&add);
        other.with_vertices(other.vertices().iter().map(|p| p.map(place)).collect())
    };
    let large = Number::from_integer(1 << 30).times(&Number::from_integer(1 << 30));
    let a = times(large.clone(), Number::ZERO);
    let b = times(number(1, 3), large.plus(&number(1, 3)));
    assert_eq!([surfaces_meet(&a, &b), surfaces_meet(&b, &a)], [true; 2]);
}

/// The tetrahedron of four points with `(v1 − v0) × (v2 − v0) · (v3 − v0) > 0`.
fn tetrahedron(corners: [[i32; 3]; 4]) -> Block {
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]].map(|face| face.to_vec());
    let vertices = corners.map(|[x, y, z]| Vec3::new(x, y, z).map(|&c| Number::from_integer(c)));
    Block::new(vertices.to_vec(), faces.to_vec(), &BlockOptions { planarity: Number::ZERO }).unwrap()
}

/// A tetrahedron with corners from 0 to 4.
fn random_tetrahedron(random: &mut Random) -> Block {
    loop {
        let mut corner = || [random.below(5), random.below(5), random.below(5)];
        let corners = [corner(), corner(), corner(), corner()];
        let [origin, ends @ ..] = corners.map(|[x, y, z]| Vec3::new(x, y, z).map(|&c| BigInt::from(c)));
        let [d, e, f] = ends.map(|end| end.minus(&origin));
        if d.cross(&e).dot(&f) > BigInt::ZERO {
            return tetrahedron(corners);
        }
    }
}

/// Whether the insides meet, by both surfaces and by each block's surface with the other's hull, both ways round: all one.
fn meet_by_surfaces(a: &Block, b: &Block) -> bool {
    let points = |block: &Block| SeparablePoints::new(block.vertices().to_vec());
    let answer = surfaces_meet(a, b);
    assert_eq!(surfaces_meet(b, a), answer, "{a:?}\n{b:?}");
    if b.is_convex() {
        assert_eq!(meets_hull(a, points(b).set()), answer, "{a:?}\n{b:?}");
    }
    if a.is_convex() {
        assert_eq!(meets_hull(b, points(a).set()), answer, "{a:?}\n{b:?}");
    }
    answer
}

#[test]
fn surfaces_of_convex_blocks_say_the_opposite_of_a_plane_that_separates_them() {
    let mut random = Random(3);
    let mut counts = [0; 2];
    for _ in 0..if cfg!(debug_assertions) { 100 } else { 600 } {
        let [a, b] = [0, 1].map(|_| random_tetrahedron(&mut random));
        let [one, two] = [&a, &b].map(|block| SeparablePoints::new(block.vertices().to_vec()));
        let expected = !separate(one.set(), two.set()).is_separated;
        assert_eq!(meet_by_surfaces(&a, &b), expected, "{a:?}\n{b:?}");
        counts[usize::from(expected)] += 1;
    }
    assert!(counts.iter().all(|&count| count > 20), "{counts:?}");
}

#[test]
fn surfaces_meet_in_what_both_enclose() {
    // Both hold the tetrahedron (0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4), their faces in its planes but for one each.
    let one = tetrahedron([[0, 0, 0], [4, 0, 0], [-12, 16, 0], [0, 0, 16]]);
    let two = tetrahedron([[0, -12, 0], [16, 0, -12], [0, 4, 0], [0, 0, 4]]);
    assert!(meet_by_surfaces(&one, &two));
    let cuboid = |low: [Number; 3], high: [Number; 3]| {
        let unit = prism(&[[0, 0], [1, 0], [1, 1], [0, 1]]);
        let pick = |c: &Number, k: usize| if c.is_zero() { low[k].clone() } else { high[k].clone() };
        unit.with_vertices(
            unit.vertices().iter().map(|v| Vec3::new(pick(&v.x, 0), pick(&v.y, 1), pick(&v.z, 2))).collect(),
        )
    };
    // A box in the slot of a U, against its left prong and its floor: it shares faces' parts alone.
    let u = prism(&[[0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]]);
    let in_slot = cuboid([number(1, 1), number(1, 1), number(3, 2)], [number(3, 2), number(9, 4), number(5, 2)]);
    assert!(!meet_by_surfaces(&u, &in_slot));
    // A box a quarter into the top of an L's arm.
    let l = prism(&[[0, 4], [0, 0], [4, 0], [4, 2], [2, 2], [2, 4]]);
    let in_arm = cuboid([number(5, 2), number(5, 4), number(7, 4)], [number(13, 4), number(7, 4), number(5, 2)]);
    assert!(meet_by_surfaces(&l, &in_arm));
    // An L and the same beside it: they share a part of the plane x = 0.
    let l = prism(&[[0, 0], [4, 0], [4, 2], [2, 2], [2, 4], [0, 4]]);
    let beside = l.translated(&Vec3::new(number(-2, 1), number(-11, 4), number(-1, 1)));
    assert!(!meet_by_surfaces(&l, &beside));
}

#[test]
fn a_face_has_other_triangles_only_where_it_is_exactly_in_a_plane() {
    let [_, l, _, cuboid] = shapes();
    let are_of_fans = |block: &Block| {
        let surface = Surfaces::of(&[block]);
        surface.triangles().iter().map(|triangle| triangle.corners).eq(triangle_corners(block))
    };
    // The fan of the L's bottom from its first corner reaches out of it; the reflex corner is moved a little.
    let mut vertices = l.vertices().to_vec();
    vertices[3].z = number(1, 1 << 30).times(&number(1, 1 << 30));
    let uneven = l.with_vertices(vertices);
    let at_bottom = |corners: &[VertexId; 3]| corners.iter().all(|v| v.index() < 6);
    let bottom = |block: &Block| -> Vec<[VertexId; 3]> {
        let surface = Surfaces::of(&[block]);
        surface.triangles().iter().map(|triangle| triangle.corners).filter(at_bottom).collect()
    };
    let fan: Vec<_> = triangle_corners(&uneven).filter(at_bottom).collect();
    assert!(bottom(&uneven) == fan && bottom(&l) != fan);
    assert!(!are_of_fans(&l) && are_of_fans(&cuboid));
}

/// Of a square from 0 to 4 in the top of a box, an L that stands through it has what both have in common.
#[test]
fn parts_of_a_face_inside_a_block_are_as_large_as_what_passes_through_it() {
    let square = prism(&[[0, 0], [4, 0], [4, 4], [0, 4]]);
    let mut random = Random(7);
    for k in 0..if cfg!(debug_assertions) { 12 } else { 60 } {
        let l = &shapes()[k % 2];
        let [x, y] = [random.below(33) - 16, random.below(33) - 16];
        let l = l.translated(&Vec3::new(number(x, 4), number(y, 4), number(1, 1)));
        let surfaces = Surfaces::of(&[&square, &l]);
        let mut area = BigRational::from_integer(0.into());
        for base in (0..surfaces.triangles().len()).filter(|&base| {
            let triangle = &surfaces.triangles()[base];
            triangle.block == 0 && triangle.corners.iter().all(|v| v.index() >= 4)
        }) {
            let areas = std::cell::RefCell::new(Vec::new());
            let is_last = Plane::of(&surfaces, base).whole().any_part(1, |part| {
                if part.insides(1) == [true; 2] {
                    let corners: Vec<_> = part.corners().iter().map(|p| p.map(Number::to_rational)).collect();
                    let sum = (1..corners.len() - 1).fold(Vec3::zero(), |sum: Vec3<BigRational>, k| {
                        let [p, q] = [k, k + 1].map(|k| corners[k].minus(&corners[0]));
                        sum.plus(&p.cross(&q))
                    });
                    areas.borrow_mut().push(sum.z);
                }
                false
            });
            assert!(!is_last);
            area += areas.into_inner().iter().sum::<BigRational>();
        }
        // Twice the areas of the L's parts from 0 to 4 and 0 to 2, and 0 to 2 and 2 to 4; in quarters.
        let common = |from: i32, length: i32| ((from + length).min(16) - from.max(0)).max(0);
        let expected = common(x, 16) * common(y, 8) + common(x, 8) * common(y + 8, 8);
        assert_eq!(area, BigRational::new((2 * expected).into(), 16.into()), "{x} {y}");
    }
}

/// Two staircases that fill a cuboid together: faces touch, and both sides lie in two planes.
fn staircases(steps: i32) -> [Block; 2] {
    let lower = [[0, 0], [steps, 0]].into_iter().chain((0..steps).rev().flat_map(|k| [[k + 1, k + 1], [k, k + 1]]));
    let upper = [[steps, steps], [steps, steps + 1], [0, steps + 1]].into_iter();
    let upper = upper.chain((0..steps).flat_map(|k| [[k, k + 1], [k + 1, k + 1]])).take(2 * steps as usize + 2);
    [prism(&lower.collect::<Vec<_>>()), prism(&upper.collect::<Vec<_>>())]
}

/// Staircases one along the steps of the other or off them, and other shapes, on the lattice or off it.
#[test]
fn surfaces_say_what_the_plain_way_says() {
    let mut random = Random(5);
    let mut counts = [0; 2];
    let [l, _, v, cuboid] = shapes();
    for k in 0..24 {
        let [lower, upper] = staircases(2 + k % 2);
        let off = |random: &mut Random| match k % 4 {
            0 => number(random.below(3) - 1, 1),
            1 => number(random.below(5) - 2, 1 << 20),
            _ => number(random.below(9) - 4, 2),
        };
        let along = off(&mut random);
        let by = if k % 4 == 0 { [along.clone(), along] } else { [along, off(&mut random)] };
        let by = Vec3::new(by[0].clone(), by[1].clone(), number(random.below(3) - 1, 1));
        let two =
            [[lower.clone(), upper.clone()], [lower.clone(), l.clone()], [upper, v.clone()], [lower, cuboid.clone()]];
        let [a, b] = two[if k % 3 < 2 { 0 } else { (k / 3) as usize % 4 }].clone();
        let b = b.translated(&by);
        let [a, b] = match k % 5 {
            0 | 1 => [a, b],
            2 => [a, b].map(|block| turned_exactly(&block, &number(1, 3))),
            3 => [turned_exactly(&a, &number(7, 2)), b],
            _ => [random.bent(&a, &number(1, 8)), b],
        };
        let expected = plain::meet(&a, &b);
        assert_eq!([meet(&a, &b), surfaces_meet(&a, &b), surfaces_meet(&b, &a)], [expected; 3], "{k}: {a:?}\n{b:?}");
        counts[usize::from(expected)] += 1;
    }
    assert!(counts.iter().all(|&count| count > 3), "{counts:?}");
}

/// As many triangles as stand at each other with each step, and few that reach over all of them.
#[test]
fn staircases_of_many_steps_touch_and_meet_when_one_is_moved_into_the_other() {
    let [lower, upper] = staircases(60);
    assert!(!surfaces_meet(&lower, &upper));
    let little = number(-1, 1 << 30);
    let moved = |x: Number, y: Number, z: Number| upper.translated(&Vec3::new(x, y, z));
    assert!(!surfaces_meet(&lower, &moved(number(-1, 2), number(1, 2), number(1, 2))));
    assert!(!surfaces_meet(&lower, &moved(number(3, 1), number(3, 1), number(1, 2))));
    assert!(surfaces_meet(&lower, &moved(number(0, 1), little, number(1, 1))));
}
