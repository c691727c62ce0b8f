//! The audit of overlaps: ties, which are none, hand-worked blocks that are not convex, what contacts see, and random pairs
//! beside plain rational searches: of all directions for convex pairs, of pieces cut by hand for others.

// Longer than 400 lines: blocks worked out by hand and the plain searches that hold the audit for random ones.

use crate::support::project_file;
use crate::support::random_numbers::Random;
use crate::support::shapes::{
    block, cuboid, exact, number, plus_sign, point, revised, slab, step, tetrahedron, turned,
};
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rockproof_model::preset::{Preset, derive};
use rockproof_model::scene::Scene;
use rockproof_model::{Block, ContactKey, FaceId, Number, Precision, ToleranceSet, Vec3, VertexId};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::audit::{
    Audit, Auditor, Decider, Overlap, OverlapSeverity, OverlapVisibility, audit, rounding_depth,
};

type Place = Vec3<BigRational>;

/// s = 10, so that all pairs here are neighbours.
fn wide() -> ToleranceSet {
    revised(&[("search", "10")])
}

fn overlap_of(a: &Block, b: &Block, tolerances: &ToleranceSet) -> Option<Overlap> {
    let mut found = audit(&[a, b], tolerances);
    assert_eq!(found.counts.neighbours(), 1);
    found.overlaps.pop()
}

/// Whether the audit says that the interiors meet; both ways round, turned about the axes too.
fn overlaps(a: &Block, b: &Block) -> bool {
    let answer = overlap_of(a, b, &wide()).is_some();
    for (one, two) in [(b.clone(), a.clone()), (turned(a), turned(b)), (turned(b), turned(a))] {
        assert_eq!(overlap_of(&one, &two, &wide()).is_some(), answer, "{one:?}\n{two:?}");
    }
    answer
}

fn unit() -> Block {
    cuboid(["0", "0", "0"], ["1", "1", "1"])
}

#[test]
fn blocks_that_touch_do_not_overlap() {
    let touching = [
        // Face to face, whole and in part; edge to edge; corner to corner; an edge and a corner on a face.
        (unit(), cuboid(["1", "0", "0"], ["2", "1", "1"])),
        (unit(), cuboid(["1", "1/3", "1/7"], ["2", "2", "2"])),
        (unit(), cuboid(["1", "1", "0"], ["2", "2", "1"])),
        (unit(), cuboid(["1", "1", "1"], ["2", "2", "2"])),
        (slab(), tetrahedron([["-1", "0", "0"], ["1", "0", "0"], ["0", "1", "1"], ["0", "-1", "1"]])),
        (slab(), tetrahedron([["0", "0", "0"], ["1", "0", "1"], ["0", "1", "1"], ["-1", "-1", "1"]])),
        // Two ridges that cross in a point.
        (
            tetrahedron([["0", "-2", "0"], ["0", "2", "0"], ["-2", "0", "4"], ["2", "0", "4"]]),
            tetrahedron([["-2", "0", "0"], ["2", "0", "0"], ["0", "-2", "-4"], ["0", "2", "-4"]]),
        ),
        // In the notch of a step, on its floor and against its wall; two plus signs, one in the other's corner; a bar of
        // width 1 that fills the notch of a plus sign.
        (step(), cuboid(["2", "-1", "2"], ["4", "1", "4"])),
        (step(), cuboid(["2", "-9", "2"], ["9", "9", "3"])),
        (plus_sign(), plus_sign().translated(&point(["2", "1", "0"]))),
        (plus_sign(), cuboid(["2", "-1", "0"], ["3", "1", "1"])),
    ];
    for (k, (a, b)) in touching.into_iter().enumerate() {
        assert!(!overlaps(&a, &b), "case {k}");
        assert!(!brute_force(&a, &b), "case {k}");
        // Moved by a little towards each other along one of the diagonals, they do, also where no f64 tells.
        for little in ["1/1000000000", "1/10000000000000000000000000"].map(exact) {
            let shifts = (0..8).map(|bits: u32| {
                let sign = |bit: u32| if bits >> bit & 1 == 0 { little.clone() } else { -little.clone() };
                Vec3::new(sign(0), sign(1), sign(2)).map(|c| Number::from_rational(c.clone()))
            });
            assert!(shifts.map(|by| b.translated(&by)).any(|moved| overlaps(&a, &moved)), "case {k}, {little}");
        }
    }
}

#[test]
fn blocks_in_one_another_overlap_whatever_their_vertices_do() {
    let bar = cuboid(["1/2", "-6", "1/2"], ["3/2", "6", "3/2"]);
    let cases = [
        // One inside the other, either way round; equal; equal but for a turn by a quarter.
        (cuboid(["-9", "-9", "-9"], ["9", "9", "9"]), step()),
        (step(), cuboid(["1/2", "0", "1/2"], ["1", "1", "1"])),
        (unit(), unit()),
        (step(), step()),
        (plus_sign(), plus_sign()),
        // Boxes that cross: no vertex of either inside.
        (cuboid(["-2", "0", "0"], ["3", "1", "1"]), cuboid(["0", "-2", "0"], ["1", "3", "1"])),
        (step(), bar.clone()),
        // A plus sign and a bar that fills one of its arms; and another, upright, through its middle.
        (plus_sign(), cuboid(["1", "-1", "0"], ["2", "4", "1"])),
        (plus_sign(), cuboid(["1", "1", "-1"], ["2", "2", "2"])),
    ];
    for (k, (a, b)) in cases.into_iter().enumerate() {
        assert!(overlaps(&a, &b), "case {k}");
        let found = overlap_of(&a, &b, &wide()).unwrap();
        assert!(found.penetration.gap.sign.is_negative() && found.depth_squared().is_positive(), "case {k}");
        assert_eq!(found.depth_squared(), overlap_of(&b, &a, &wide()).unwrap().depth_squared(), "case {k}");
    }
    // No vertex of the step or the bar is inside the other. The bar's edges are, from y = −4 to 4; their middles are 1/2
    // from a side of the step but for (3/2, 0, 3/2), which is nearest to the reflex edge at (2, 2): √(1/4 + 1/4).
    let found = overlap_of(&step(), &bar, &wide()).unwrap();
    assert_eq!(found.depth_squared(), exact("1/2"));
    assert_eq!(found.penetration.direction.y, BigRational::zero());
    // The bar fills an arm of the plus sign: the edges of neither are inside, the middle of what they share is 1/2 from
    // the bottom and top of both.
    let found = overlap_of(&plus_sign(), &cuboid(["1", "-1", "0"], ["2", "4", "1"]), &wide()).unwrap();
    assert_eq!(found.depth_squared(), exact("1/4"));
    // Both four times as high: the middle is 1/2 from the bar's sides, and √(1/4 + 1/4) from the plus sign's reflex edges.
    let high = |block: &Block| {
        let vertices = block.vertices().iter().map(|v| Vec3::new(v.x.clone(), v.y.clone(), v.z.times(&number("4"))));
        block.with_vertices(vertices.collect())
    };
    let bar = cuboid(["1", "-1", "0"], ["2", "4", "1"]);
    assert_eq!(overlap_of(&high(&plus_sign()), &high(&bar), &wide()).unwrap().depth_squared(), exact("1/4"));
}

/// A box with its bottom at `depths` below z = 0, at x = 0 and at x = 1.
fn sheared(depths: [&str; 2]) -> Block {
    let [left, right] = depths.map(|depth| number(depth).negated());
    let corners = [(0, 0, &left), (1, 0, &right), (1, 1, &right), (0, 1, &left)];
    let at = |up: i32| {
        corners.map(|(x, y, z)| {
            Vec3::new(Number::from_integer(x), Number::from_integer(y), z.plus(&Number::from_integer(up)))
        })
    };
    let faces: [&[u32]; 6] = [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
    block(at(0).into_iter().chain(at(1)).collect(), &faces)
}

#[test]
fn contacts_see_half_of_the_depth_or_all_of_it_or_nothing() {
    // g = 1/20. The contacts of the left bottom vertices are 1/100 deep; those on the right too deep, or as deep as given.
    let tolerances = revised(&[("overlap_sine", "3/5")]);
    for (right, sight, is_deeper) in [
        ("1/100", OverlapVisibility::Seen, false),
        ("1/20", OverlapVisibility::Seen, false),
        ("501/10000", OverlapVisibility::Shallow, true),
        ("59/1000", OverlapVisibility::Shallow, true),
    ] {
        let found = overlap_of(&sheared(["1/100", right]), &slab(), &tolerances).unwrap();
        assert_eq!((found.sight, found.is_deeper_than_g), (sight, is_deeper), "{right}");
        assert_eq!(found.depth_squared(), exact(right) * exact(right));
    }
    // A contact with h = −1/20 on the left and 1/10 on the right: exactly half is seen; a little less is shallow.
    let tolerances = |g: &str| revised(&[("overlap_sine", "3/5"), ("penetration", g)]);
    let half = overlap_of(&sheared(["1/20", "1/10"]), &slab(), &tolerances("9/100")).unwrap();
    assert_eq!((half.sight, half.contact.unwrap().1.squared), (OverlapVisibility::Seen, exact("1/400")));
    let less = overlap_of(&sheared(["499/10000", "1/10"]), &slab(), &tolerances("9/100")).unwrap();
    assert_eq!((less.sight, less.is_deeper_than_g), (OverlapVisibility::Shallow, true));
    // On the floor of a step, which is not convex, the same contacts see the whole depth.
    let on_step = sheared(["1/100", "59/1000"]).translated(&point(["5/2", "0", "2"]));
    for (a, b) in [(&on_step, &step()), (&step(), &on_step)] {
        let found = overlap_of(a, b, &revised(&[("overlap_sine", "3/5")])).unwrap();
        assert_eq!(found.depth_squared(), exact("59/1000") * exact("59/1000"));
        assert_eq!((found.sight, found.is_deeper_than_g), (OverlapVisibility::Seen, true));
    }
}

#[test]
fn a_little_is_seen_and_five_centimetres_are_not() {
    let set = |g: &str| revised(&[("penetration", g)]);
    let on_slab = |depth: &str| cuboid(["-1", "-1", "0"], ["1", "1", "2"]).translated(&point(["0", "0", depth]));
    let found = overlap_of(&slab(), &on_slab("-1/1000000000"), &set("1/50")).unwrap();
    let (contact, gap) = found.contact.clone().unwrap();
    assert_eq!((found.sight, contact.key), (OverlapVisibility::Seen, ContactKey::FaceVertex(FaceId(1), VertexId(0))));
    assert_eq!(gap.squared, found.depth_squared());
    assert!(!found.is_deeper_than_g && !found.is_within_unevenness);
    // Exactly g is seen and not deeper.
    let found = overlap_of(&slab(), &on_slab("-1/50"), &set("1/50")).unwrap();
    assert_eq!((found.sight, found.is_deeper_than_g), (OverlapVisibility::Seen, false));
    let found = overlap_of(&slab(), &on_slab("-1/20"), &set("1/50")).unwrap();
    assert_eq!((found.sight, found.is_deeper_than_g, found.contact), (OverlapVisibility::Unseen, true, None));
    // Of blocks that are not convex any contact with h < 0 sees.
    let in_notch = cuboid(["2", "-1", "2"], ["3", "1", "3"]).translated(&point(["1/2", "0", "-1/100"]));
    assert_eq!(overlap_of(&step(), &in_notch, &wide()).unwrap().sight, OverlapVisibility::Seen);
}

#[test]
fn what_an_overlap_means_depends_on_depth_and_sight() {
    let on_slab = |depth: &str| cuboid(["-1", "-1", "0"], ["1", "1", "2"]).translated(&point(["0", "0", depth]));
    let found = |depth: &str| overlap_of(&slab(), &on_slab(depth), &revised(&[("penetration", "1/50")])).unwrap();
    let (seen, lost) = (found("-1/1000"), found("-1/20"));
    // Exactly as deep as rounding makes it is rounding.
    let severity = |overlap: &Overlap, rounding: &str| overlap.severity(&number(rounding));
    assert_eq!(severity(&seen, "1/1000"), OverlapSeverity::Rounding);
    assert_eq!(severity(&seen, "999/1000000"), OverlapSeverity::Held);
    assert!(severity(&lost, "1/1000") == OverlapSeverity::Lost && lost.is_unseen(&number("1/1000")));
    // As deep and seen, as a contact kept closed makes it: lost for a model, held in a run.
    let kept = Overlap { sight: OverlapVisibility::Seen, ..lost };
    assert!(severity(&kept, "1/1000") == OverlapSeverity::Lost && !kept.is_unseen(&number("1/1000")));
    let unseen = Overlap { sight: OverlapVisibility::Unseen, ..seen };
    assert!(severity(&unseen, "999/1000000") == OverlapSeverity::Lost && unseen.is_unseen(&number("999/1000000")));
    assert!(!unseen.is_unseen(&number("1/1000")));
    // 2⁸·2⁻⁵²·4 m
    assert_eq!(rounding_depth(&[&slab(), &unit()], Precision::F64), Number::from_f64(2f64.powi(-42)).unwrap());
    // The largest coordinate need not be the first.
    assert_eq!(rounding_depth(&[&unit(), &slab()], Precision::F64), Number::from_f64(2f64.powi(-42)).unwrap());
    assert_eq!(rounding_depth(&[&slab(), &unit()], Precision::F32), Number::from_f64(2f64.powi(-13)).unwrap());
}

#[test]
fn neighbours_rounded_to_f32_are_audited_as_they_came_out() {
    // A wall turned, then rounded: what overlaps is what plain rationals say, faces uneven or not.
    let bricks: Vec<Block> = (0..3)
        .flat_map(|x| (0..2).map(move |z| (x, z)))
        .map(|(x, z)| unit().translated(&Vec3::new(x, 0, z).map(|&c| Number::from_integer(c))))
        .map(|brick| turned(&brick).rounded(Precision::F32).unwrap())
        .collect();
    let found = audit(&bricks.iter().collect::<Vec<_>>(), &revised(&[]));
    let mut expected = Vec::new();
    for (i, a) in bricks.iter().enumerate() {
        expected.extend((i + 1..bricks.len()).filter(|&j| brute_force(a, &bricks[j])).map(|j| [i, j]));
    }
    assert_eq!(found.overlaps.iter().map(|o| o.blocks).collect::<Vec<_>>(), expected);
    assert!(expected.len() > 4 && found.counts.neighbours() >= 11);
    assert!(found.overlaps.iter().all(|o| o.penetration.depth_m().unwrap() < 1e-6));
    assert!(found.counts.of(Decider::Exact) + found.counts.of(Decider::Float) >= expected.len() as u64);
}

#[test]
fn blocks_without_an_inside_are_left_out() {
    // At a height that f64 rounds, and at one that it holds.
    for z in ["1/3", "1/2"] {
        let pressed = |v: &Vec3<Number>| Vec3::new(v.x.clone(), v.y.clone(), number(z));
        let flat = unit().with_vertices(unit().vertices().iter().map(pressed).collect());
        let found = audit(&[&unit(), &flat, &turned(&flat)], &wide());
        assert_eq!((found.overlaps.len(), found.counts.of(Decider::LeftOut)), (0, 3), "{z}");
    }
    // A plate so thin that no f64 tells its faces apart has an inside.
    let faces = [number("1/3"), number("1/3").plus(&number("1/10000000000000000000000000"))];
    let at = |v: &Vec3<Number>| Vec3::new(v.x.clone(), v.y.clone(), faces[usize::from(!v.z.is_zero())].clone());
    let thin = unit().with_vertices(unit().vertices().iter().map(at).collect());
    for (plate, cube) in [(thin.clone(), unit()), (turned(&thin), turned(&unit()))] {
        let found = audit(&[&plate, &cube], &wide());
        assert_eq!((found.overlaps.len(), found.counts.of(Decider::LeftOut)), (1, 0));
    }
}

#[test]
fn pairs_are_found_and_put_in_order_whoever_audits_them() {
    let mut random = Random(5);
    let blocks: Vec<Block> = (0..60)
        .map(|k| {
            let shape = if k % 9 == 0 { step() } else { random.tetrahedron() };
            let by = Vec3::new(random.below(30), random.below(30), random.below(9));
            shape.translated(&by.map(|&c| Number::from_integer(c as i32)))
        })
        .collect();
    let tolerances = revised(&[("search", "1")]);
    let prepared: Vec<PreparedBlock> = blocks.iter().map(PreparedBlock::new).collect();
    let auditor = Auditor::new(&prepared, &tolerances);
    let pairs = auditor.neighbours();
    let meets = |a: &Block, b: &Block| {
        let (a, b) = (a.bounds(), b.bounds());
        (0..3).all(|k| {
            let end = |n: &Number| n.to_rational();
            let apart =
                |low: &Vec3<&Number>, high: &Vec3<&Number>| end(low.components()[k]) - end(high.components()[k]);
            apart(&a.min, &b.max) <= exact("1") && apart(&b.min, &a.max) <= exact("1")
        })
    };
    let all = (0..60).flat_map(|i| (i + 1..60).map(move |j| [i, j]));
    let expected: Vec<_> = all.filter(|&[i, j]| meets(&blocks[i], &blocks[j])).collect();
    assert_eq!(pairs, expected);
    let backwards = Audit::of(pairs.iter().rev().map(|&pair| auditor.pair(pair)));
    let forwards = audit(&blocks.iter().collect::<Vec<_>>(), &tolerances);
    assert_eq!(backwards, forwards);
    assert!(!forwards.overlaps.is_empty());
    let deepest = forwards.deepest().unwrap();
    assert!(forwards.overlaps.iter().all(|o| o.depth_squared() <= deepest.depth_squared()));
}

#[test]
fn the_joints_of_a_slope_overlap_in_19_pairs() {
    let scene = Scene::load(project_file("cases/real/slope_joints.dda")).unwrap();
    let shapes = scene.shapes();
    let found = audit(&shapes, &derive(Preset::Auto, &shapes, Precision::F64).unwrap());
    let deep: Vec<_> = found.overlaps.iter().filter(|o| !o.is_within_unevenness).collect();
    assert_eq!(deep.len(), 19);
    assert!(deep.iter().all(|o| o.is_deeper_than_g && o.sight == OverlapVisibility::Unseen));
    let worst = found.deepest().unwrap();
    assert_eq!((worst.blocks, worst.penetration.depth_m()), ([2, 3], Some(1.169_429_902_352_878_5)));
}

#[test]
fn what_no_contact_sees_is_the_same_whether_depth_or_contacts_are_asked_first() {
    let scene = Scene::load(project_file("cases/real/slope_joints.dda")).unwrap();
    let shapes = scene.shapes();
    let slope: Vec<PreparedBlock> = shapes.iter().map(|block| PreparedBlock::new(block)).collect();
    // The first is 2 cm deep in the slab, less than g; the second 1/2, more than g.
    let on_slab = ["-1/50", "-1/2"].map(|depth| cuboid(["-1", "-1", depth], ["1", "1", "2"]));
    let on_slab: Vec<PreparedBlock> = [&slab(), &on_slab[0], &on_slab[1]].map(PreparedBlock::new).into();
    let (mut unseen, mut seen) = (0, 0);
    for (prepared, tolerances) in [(slope, derive(Preset::Auto, &shapes, Precision::F64).unwrap()), (on_slab, wide())] {
        let auditor = Auditor::new(&prepared, &tolerances);
        for pair in auditor.neighbours() {
            let audited = auditor.pair(pair).overlap;
            seen += usize::from(audited.as_ref().is_some_and(|o| o.sight != OverlapVisibility::Unseen));
            let expected = audited.filter(|overlap| overlap.sight == OverlapVisibility::Unseen);
            unseen += usize::from(expected.is_some());
            assert_eq!(auditor.unseen_with_kept(pair, &[]), expected, "{pair:?}");
        }
    }
    assert!(unseen >= 19 && seen > 0, "{unseen} unseen, {seen} seen");
}

impl Random {
    /// With corners on a coarse grid, so that pairs often touch exactly.
    fn tetrahedron(&mut self) -> Block {
        loop {
            let corners: [[i64; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| self.below(4)));
            let [o, a, b, c] =
                corners.map(|p| Vec3::new(p[0], p[1], p[2]).map(|&c| BigRational::from_integer(c.into())));
            if a.minus(&o).cross(&b.minus(&o)).dot(&c.minus(&o)).is_positive() {
                let text = corners.map(|p| p.map(|c| c.to_string()));
                return tetrahedron(std::array::from_fn(|k| std::array::from_fn(|i| text[k][i].as_str())));
            }
        }
    }

    fn offset(&mut self, end: u64, denominator: &str) -> Vec3<Number> {
        let mut along = || number(&format!("{}/{denominator}", self.below(2 * end + 1) - end as i64));
        Vec3::new(along(), along(), along())
    }
}

/// Whether the interiors of two convex hulls with volumes meet: unless a cross product of two differences of a point of A
/// and one of B, or its opposite, has all differences on one side. The directions that separate form a cone whose extreme
/// rays are such products, as the differences span space.
fn hulls_meet(a: &[Place], b: &[Place]) -> bool {
    let differences: Vec<Place> = a.iter().flat_map(|p| b.iter().map(move |q| p.minus(q))).collect();
    let separates = |n: &Place| {
        let mut signs = differences.iter().map(|d| n.dot(d));
        !n.norm_squared().is_zero() && signs.all(|value| !value.is_negative())
    };
    !differences.iter().enumerate().any(|(k, one)| {
        differences[..k].iter().any(|two| {
            let n = one.cross(two);
            separates(&n) || separates(&n.negated())
        })
    })
}

fn places(block: &Block) -> Vec<Place> {
    block.vertices().iter().map(|v| v.map(Number::to_rational)).collect()
}

/// The corners of the convex parts of a block: of steps and plus signs by the numbers of their vertices, cut by hand.
fn parts(block: &Block) -> Vec<Vec<Place>> {
    let all = places(block);
    let ends =
        |corners: [usize; 4], n: usize| corners.iter().flat_map(|&k| [all[k].clone(), all[k + n].clone()]).collect();
    match all.len() {
        // The L of [`step`], cut from its reflex edge 3 to the corner 0.
        12 => vec![ends([0, 1, 2, 3], 6), ends([0, 3, 4, 5], 6)],
        24 => vec![ends([0, 1, 6, 7], 12), ends([3, 4, 9, 10], 12)],
        _ => vec![all],
    }
}

fn brute_force(a: &Block, b: &Block) -> bool {
    parts(a).iter().any(|one| parts(b).iter().any(|two| hulls_meet(one, two)))
}

#[test]
fn random_tetrahedra_overlap_where_a_search_of_all_directions_says_so() {
    let mut random = Random(1);
    let (mut meeting, mut apart, mut deciders) = (0, 0, std::collections::BTreeMap::new());
    for _ in 0..250 {
        let (a, b) = (random.tetrahedron(), random.tetrahedron());
        let b = b.translated(&random.offset(2, "2"));
        let expected = brute_force(&a, &b);
        for (one, two) in [(&a, &b), (&turned(&a), &turned(&b))] {
            let prepared = [PreparedBlock::new(one), PreparedBlock::new(two)];
            let found = Auditor::new(&prepared, &wide()).pair([0, 1]);
            assert_eq!(found.overlap.is_some(), expected, "{one:?}\n{two:?}");
            *deciders.entry(found.decider).or_insert(0) += 1;
        }
        assert_eq!(overlaps(&a, &b), expected);
        *(if expected { &mut meeting } else { &mut apart }) += 1;
    }
    assert!(meeting > 50 && apart > 50, "{meeting} {apart}");
    let reached = [Decider::Boxes, Decider::FacePlane, Decider::ExactFacePlane, Decider::Float, Decider::Exact];
    assert!(reached.iter().all(|d| deciders.contains_key(d)), "{deciders:?}");
}

#[test]
fn random_blocks_with_notches_overlap_where_their_parts_cut_by_hand_do() {
    let mut random = Random(2);
    let (mut meeting, mut apart) = (0, 0);
    for k in 0..60 {
        let shapes = [step(), plus_sign(), unit()];
        let a = shapes[k % 2].clone();
        let b = shapes[k / 2 % 3].translated(&random.offset(8, "2"));
        // A third of them turned against each other.
        let b = if k % 3 == 0 { turned(&b) } else { b };
        let expected = brute_force(&a, &b);
        assert_eq!(overlap_of(&a, &b, &wide()).is_some(), expected, "{a:?}\n{b:?}");
        *(if expected { &mut meeting } else { &mut apart }) += 1;
    }
    assert!(meeting > 12 && apart > 12, "{meeting} {apart}");
}
