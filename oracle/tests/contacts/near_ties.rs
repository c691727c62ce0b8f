//! The fast path against the plain one at ties and beside them: the hand-worked pairs, most of which are ties, scaled by an odd fraction
//! and moved, once as fractions (the ties stay, f64 sees noise) and once rounded to f64 (each tie is off by some last places).
//!
//! Caught so far: nothing; it is here for the bounds of the f64 path, which most other pairs never come near.

use crate::support::hand_worked;
use crate::support::random_numbers::Random;
use crate::support::shapes::{block, cuboid, number, point, revised, slab, spike};
use num_rational::BigRational;
use rockproof_model::{Block, ContactKind, Number, Point, Precision, Sign, ToleranceSet, Vec3};
use rockproof_oracle::{LevelCounts, Pair, PreparedBlock, plain};

const ROUNDS: u64 = 1;
const FULL_ROUNDS: u64 = 8;

impl Random {
    fn fraction(&mut self) -> Number {
        let (numerator, denominator) = (self.below(2_001) - 1_000, 2 * self.below(500) + 1);
        Number::from_rational(BigRational::new(numerator.into(), denominator.into()))
    }

    fn pick(&mut self, of: &[&str]) -> Number {
        number(of[self.below(of.len() as u64) as usize])
    }
}

/// Which numbers are rounded to f64.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rounded {
    Nothing,
    Tolerances,
    OneBlock,
    Blocks,
    All,
}

struct Drawn {
    a: Block,
    b: Block,
    tolerances: ToleranceSet,
    about: String,
}

fn mapped(block: &Block, factor: &Number, offset: &Point) -> Block {
    block.with_vertices(block.vertices().iter().map(|v| v.map(|c| c.times(factor))).collect()).translated(offset)
}

fn draw(case: &hand_worked::Case, round: u64, dice: &mut Random) -> Option<Drawn> {
    let size = match round % 4 {
        // Beyond the sizes that have bounds of their own.
        3 => dice.pick(&["1/1267650600228229401496703205376", "1267650600228229401496703205376"]),
        _ => number("1"),
    };
    let factor = dice.pick(&["1/3", "1/7", "10/7", "3/10", "1/1000", "97/89"]).times(&size);
    let far = dice.pick(&["0", "1", "1", "100003"]).times(&size);
    let offset = Vec3::new(dice.fraction(), dice.fraction(), dice.fraction()).map(|c| c.times(&far));
    let rounded = [Rounded::Blocks, Rounded::All, Rounded::Nothing, Rounded::Tolerances, Rounded::OneBlock]
        [dice.below(5) as usize];
    let mut tolerances = case.tolerances.clone();
    for length in [&mut tolerances.search, &mut tolerances.territory, &mut tolerances.penetration] {
        *length = length.times(&factor);
    }
    if dice.below(3) == 0 {
        tolerances.equal = dice.pick(&["1/3", "3/2", "5/2"]);
    }
    let (mut a, mut b) = (mapped(&case.a, &factor, &offset), mapped(&case.b, &factor, &offset));
    if matches!(rounded, Rounded::Tolerances | Rounded::All) {
        tolerances = tolerances.rounded(Precision::F64).ok()?;
    }
    if matches!(rounded, Rounded::Blocks | Rounded::All) {
        (a, b) = (a.rounded(Precision::F64)?, b.rounded(Precision::F64)?);
    }
    if rounded == Rounded::OneBlock {
        let one = if dice.below(2) == 0 { &mut a } else { &mut b };
        *one = one.rounded(Precision::F64)?;
    }
    let about = format!("{}, round {round}, {rounded:?}", case.name);
    Some(Drawn { a, b, tolerances, about })
}

/// A's box grown by s meets B's.
fn boxes_meet(a: &Block, b: &Block, search: &Number) -> bool {
    let ends = |block: &Block, axis: usize| {
        let along: Vec<Number> = block.vertices().iter().map(|v| v.components()[axis].clone()).collect();
        (along.iter().min().unwrap().clone(), along.iter().max().unwrap().clone())
    };
    (0..3).all(|axis| {
        let ((low_a, high_a), (low_b, high_b)) = (ends(a, axis), ends(b, axis));
        low_b <= high_a.plus(search) && low_a <= high_b.plus(search)
    })
}

#[test]
fn beside_every_tie_the_paths_agree() {
    agree_beside_ties(ROUNDS);
}

#[test]
#[ignore = "half a minute; .ci/run runs it"]
fn beside_every_tie_the_paths_agree_at_full_size() {
    agree_beside_ties(FULL_ROUNDS);
}

fn agree_beside_ties(rounds: u64) {
    let mut dice = Random(11);
    let (mut levels, mut pairs, mut touching, mut neighbours) = (LevelCounts::default(), 0u64, 0u64, [0, 0]);
    for (number, case) in (0..).zip(hand_worked::cases()) {
        for round in 0..rounds {
            let Some(Drawn { a, b, tolerances, about }) = draw(&case, round, &mut dice) else { continue };
            let (prepared_a, prepared_b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
            let pair = Pair::new(&prepared_a, &prepared_b);
            let kept = if (number + round) % 2 == 0 { case.kept.as_slice() } else { &[] };
            let answer = pair.classify_with_kept(&tolerances, kept);
            let plainly: Vec<_> = plain::classify_with_kept::<BigRational>(&a, &b, &tolerances, kept)
                .into_iter()
                .map(|found| found.contact)
                .collect();
            assert_eq!(answer.contacts, plainly, "{about}: fast (left), plain (right)");
            let meet = boxes_meet(&a, &b, &tolerances.search);
            assert_eq!(pair.are_neighbours(&tolerances), meet, "{about}");
            neighbours[usize::from(meet)] += 1;
            levels += answer.levels;
            pairs += 1;
            touching += u64::from(!answer.contacts.is_empty());
        }
    }
    println!("{pairs} pairs, {touching} with contacts, neighbours {neighbours:?}, {levels:?}");
    assert!(pairs > 100 * rounds && touching * 4 > pairs, "{touching} of {pairs} pairs have contacts");
    assert!(
        neighbours[0] > 0 && levels.ball > 0 && levels.i128 > 0 && levels.fixed.iter().all(|&n| n > 0),
        "{levels:?}"
    );
}

#[test]
fn boxes_apart_by_a_hair_more_than_s_are_no_neighbours() {
    let hair = "1/18014398509481984";
    let a = cuboid(["-1", "0", "0"], ["0", "1", "1"]).translated(&point([&format!("-{hair}"), "0", "0"]));
    let b = cuboid(["1", "0", "0"], ["2", "1", "1"]);
    // Twice: the bound of the f64 path is known from the second time on.
    for (first, second) in [(&a, &b), (&b, &a), (&a, &b), (&b, &a)] {
        let (first, second) = (PreparedBlock::new(first), PreparedBlock::new(second));
        let pair = Pair::new(&first, &second);
        // f64 makes 1 of 1 + 2⁻⁵⁴.
        assert!(!pair.are_neighbours(&revised(&[("search", "1")])));
        assert!(pair.are_neighbours(&revised(&[("search", "4503599627370497/4503599627370496")])));
    }
}

/// Edges that cross where one of them ends, exactly before they are rounded: after that the foot is a few last places inside or outside.
#[test]
fn edges_that_cross_at_an_end_have_the_feet_that_fractions_find() {
    let mut dice = Random(5);
    let (mut crossing, mut others) = (0u64, 0u64);
    for round in 0..40 * ROUNDS {
        let mut vector = || Vec3::new(0, 0, 0).map(|_: &i32| dice.below(19) as i32 - 9);
        let (d, e) = (vector().map(|&c| Number::from_integer(c)), vector().map(|&c| Number::from_integer(c)));
        let cross = |k: usize| {
            let (d, e) = (d.components(), e.components());
            let [i, j] = [(k + 1) % 3, (k + 2) % 3];
            d[i].times(e[j]).plus(&d[j].times(e[i]).negated())
        };
        let n = Vec3::new(cross(0), cross(1), cross(2));
        if n.components().into_iter().all(Number::is_zero) {
            continue;
        }
        let seventh = number("1/7");
        // Corners as sums of parts of d, e and n.
        let corner = |parts: [&str; 3]| {
            let [of_d, of_e, of_n] = parts.map(number);
            let along = |k: usize| {
                let part = |v: &Point, share: &Number| v.components()[k].times(share);
                part(&d, &of_d).plus(&part(&e, &of_e)).plus(&part(&n, &of_n)).times(&seventh)
            };
            Vec3::new(along(0), along(1), along(2))
        };
        let tetrahedron = |corners: [[&str; 3]; 4]| block(corners.map(corner).to_vec(), &TETRAHEDRON);
        let lower = tetrahedron([["-1", "0", "0"], ["1", "0", "0"], ["0", "-1", "-1"], ["0", "1", "-1"]]);
        let h = "1/1000";
        let upper = tetrahedron([["1/3", "0", h], ["1/3", "1", h], ["-2/3", "1/2", "1"], ["4/3", "1/2", "1"]]);
        let (Some(a), Some(b)) = (upper.rounded(Precision::F64), lower.rounded(Precision::F64)) else { continue };
        let t = revised(&[("search", "1"), ("territory", "0")]);
        let plainly: Vec<_> =
            plain::classify::<BigRational>(&a, &b, &t).into_iter().map(|found| found.contact).collect();
        let fast = Pair::new(&PreparedBlock::new(&a), &PreparedBlock::new(&b)).classify(&t).contacts;
        assert_eq!(fast, plainly, "round {round}: fast (left), plain (right)");
        *if fast.iter().any(|c| c.kind() == ContactKind::EdgeEdge) { &mut crossing } else { &mut others } += 1;
    }
    assert!(crossing > 5 * ROUNDS && others > 5 * ROUNDS, "{crossing} cross, {others} do not");
}

const TETRAHEDRON: [&[u32]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]];

#[test]
fn boxes_apart_along_every_axis_are_no_neighbours() {
    let a = cuboid(["-10", "-10", "-10"], ["-9", "-9", "-9"]);
    let b = cuboid(["-7", "-7", "-7"], ["-6", "-6", "-6"]);
    // More than once: the bound of the f64 path is known from the second time on.
    for (first, second) in [(&a, &b), (&b, &a), (&a, &b), (&b, &a)] {
        let (first, second) = (PreparedBlock::new(first), PreparedBlock::new(second));
        let pair = Pair::new(&first, &second);
        assert!(!pair.are_neighbours(&revised(&[("search", "1")])));
        assert!(pair.are_neighbours(&revised(&[("search", "2")])));
    }
}

/// The tetrahedron of integer points times a length; corners 2 and 3 are exchanged where that turns it right way out.
fn tetrahedron_of(corners: [[i64; 3]; 4], length: &Number) -> Block {
    let [p, q, r, s] = corners;
    let from_p = |v: [i64; 3]| [0, 1, 2].map(|k| i128::from(v[k]) - i128::from(p[k]));
    let [d, e, f] = [q, r, s].map(from_p);
    let volume = |k: usize| (d[(k + 1) % 3] * e[(k + 2) % 3] - d[(k + 2) % 3] * e[(k + 1) % 3]) as f64 * f[k] as f64;
    let turned = if (0..3).map(volume).sum::<f64>() > 0.0 { [p, q, r, s] } else { [p, q, s, r] };
    let scaled = |c: i64| Number::from_rational(BigRational::from_integer(c.into())).times(length);
    block(turned.map(|[x, y, z]| Vec3::new(scaled(x), scaled(y), scaled(z))).to_vec(), &TETRAHEDRON)
}

fn power_of_two(exponent: i32) -> Number {
    Number::from_rational(BigRational::from_integer(2.into()).pow(exponent))
}

/// Both paths find this one contact, of an e-e with this h², also when the fast one is asked again.
fn touch_in(about: &str, [a, b]: [&Block; 2], t: &ToleranceSet, kind: ContactKind, gap_squared: &BigRational) {
    let plainly = plain::classify::<BigRational>(a, b, t);
    let found: Vec<_> = plainly.iter().map(|f| (f.contact.kind(), f.contact.key.numbers())).collect();
    assert_eq!(found, [(kind, [0, 0])], "{about}");
    if kind == ContactKind::EdgeEdge {
        assert_eq!(&plainly[0].gap_squared, gap_squared, "{about}");
    }
    let contacts = [plainly[0].contact];
    for time in 0..2 {
        let fast = Pair::new(&PreparedBlock::new(a), &PreparedBlock::new(b)).classify(t).contacts;
        assert_eq!(fast, contacts, "{about}, time {time}: fast (left), plain (right)");
    }
}

fn lengths(unit: &Number, [search, territory, penetration]: [&str; 3]) -> ToleranceSet {
    let mut t = revised(&[("search", search), ("territory", territory), ("penetration", penetration)]);
    for length in [&mut t.search, &mut t.territory, &mut t.penetration] {
        *length = length.times(unit);
    }
    t
}

fn square(value: &Number) -> BigRational {
    value.to_rational().pow(2)
}

/// Where products overflow every bound of the f64 path is infinite, and so may a value be: that proves nothing.
#[test]
fn feet_whose_values_overflow_are_not_rejected() {
    let unit = power_of_two(254);
    let a = tetrahedron_of([[3, 1, 3], [-3, -1, -3], [-9, 3, 4], [-3, 9, 4]], &unit);
    let b = tetrahedron_of([[4, -2, -2], [2, -4, -2], [3, -11, -12], [15, -7, 0]], &unit);
    // d₁ = −2(3, 1, 3) and d₂ = −2(1, 1, 0): d₁ × d₂ ∥ (−3, 3, 2), and p_A − p_B = (−1, 3, 5): h = 22/√22.
    let h_squared = BigRational::from_integer(22.into()) * square(&unit);
    touch_in("feet", [&a, &b], &lengths(&unit, ["5", "0", "1"]), ContactKind::EdgeEdge, &h_squared);
}

#[test]
fn gaps_whose_squares_overflow_are_not_rejected() {
    let metre = number("1");
    // Edges that cross 1/32 apart and overlapping, in units of 1/32 m: they make the bounds of such gaps known.
    let small = power_of_two(-5);
    let ridge = |z: i64| tetrahedron_of([[-64, 0, z], [64, 0, z], [0, 64, 64 + z], [0, -64, 64 + z]], &small);
    let lower = tetrahedron_of([[0, -64, 0], [0, 64, 0], [64, 0, -64], [-64, 0, -64]], &small);
    for z in [1, -1] {
        touch_in("small", [&ridge(z), &lower], &revised(&[]), ContactKind::EdgeEdge, &square(&small));
    }
    // Edges that cross in the origin, exactly; in f64 their plane's value is noise of 1e165 m³, whose square is infinite.
    let d = [354_895_485_115_210, 548_345_363_464_445, 545_631_947_218_857];
    let e = [-389_417_101_237_555, -549_637_915_451_607, 412_034_039_467_077];
    let u = [525_836_961_204_471, -358_707_431_549_218, 18_471_047_275_466];
    let sum = |of_d: i64, of_e: i64, of_u: i64| [0, 1, 2].map(|k| of_d * d[k] + of_e * e[k] + of_u * u[k]);
    let unit = power_of_two(150);
    let a = tetrahedron_of([sum(-3, 0, 0), sum(5, 0, 0), sum(0, 4, 3), sum(0, -4, 3)], &unit);
    let b = tetrahedron_of([sum(0, -2, 0), sum(0, 4, 0), sum(4, 0, -3), sum(-4, 0, -3)], &unit);
    let nothing = BigRational::from_integer(0.into());
    touch_in("large", [&a, &b], &lengths(&metre, ["1", "0", "1"]), ContactKind::EdgeEdge, &nothing);
}

/// Below the least normal f64 the slack of culling rounds to nothing: what is left is the distance itself.
#[test]
fn in_units_of_the_least_f64_what_is_exactly_s_apart_touches() {
    let unit = power_of_two(-1074);
    let ridge_above = [[-40, 0, 10], [40, 0, 10], [0, 30, 60], [0, -30, 60]];
    let ridge_below = [[0, -40, 0], [0, 40, 0], [30, 0, -50], [-30, 0, -50]];
    let tip_above = [[0, 0, 10], [40, 0, 60], [-20, 30, 60], [-20, -30, 60]];
    let tip_below = [[0, 0, 0], [40, 0, -50], [-20, 30, -50], [-20, -30, -50]];
    let t = lengths(&unit, ["10", "0", "0"]);
    let h_squared = square(&unit) * BigRational::from_integer(100.into());
    for (above, below, kind, back) in [
        (ridge_above, ridge_below, ContactKind::EdgeEdge, ContactKind::EdgeEdge),
        (tip_above, tip_below, ContactKind::VertexVertex, ContactKind::VertexVertex),
        (tip_above, ridge_below, ContactKind::VertexEdge, ContactKind::EdgeVertex),
    ] {
        // Upside down as well, so that the lower ends are met and the upper ones.
        for way in [1, -1] {
            let [above, below] =
                [above, below].map(|corners| tetrahedron_of(corners.map(|c| c.map(|x: i64| way * x)), &unit));
            touch_in("above and below", [&above, &below], &t, kind, &h_squared);
            touch_in("below and above", [&below, &above], &t, back, &h_squared);
        }
    }
    // Lengths that are no f64s: 2/5, 53/5 and 51/5 of the unit are seen as 0, 11 and 10.
    let fifth = unit.times(&number("1/5"));
    let raised =
        |corners: [[i64; 3]; 4], by: i64| tetrahedron_of(corners.map(|[x, y, z]| [5 * x, 5 * y, 5 * z + by]), &fifth);
    let (above, below) = (raised(tip_above, 3), raised(tip_below, 2));
    let h_squared = square(&unit.times(&number("51/5")));
    let t = lengths(&unit, ["51/5", "0", "0"]);
    touch_in("fifths", [&above, &below], &t, ContactKind::VertexVertex, &h_squared);
    touch_in("fifths", [&below, &above], &t, ContactKind::VertexVertex, &h_squared);
}

/// With no tolerance nothing but rounding is left of the reach: less than none would lose what touches.
#[test]
fn without_tolerances_a_tip_on_a_face_touches() {
    let nothing = [("search", "0"), ("territory", "0"), ("penetration", "0")];
    for at in ["0", "1/3", "1000003/7"] {
        let offset = point(["0", "0", at]);
        let (a, b) = (spike(["0", "0", "0"]).translated(&offset), slab().translated(&offset));
        let found = Pair::new(&PreparedBlock::new(&a), &PreparedBlock::new(&b)).classify(&revised(&nothing)).contacts;
        let found: Vec<_> = found.iter().map(|c| (c.kind(), c.key.numbers(), c.gap)).collect();
        assert_eq!(found, [(ContactKind::VertexFace, [0, 1], Sign::Zero)], "{at}");
    }
}
