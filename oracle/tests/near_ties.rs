//! The fast path against the plain one at ties and beside them: the hand-worked pairs, most of which are ties, scaled by an odd fraction
//! and moved, once as fractions (the ties stay, f64 sees noise) and once rounded to f64 (each tie is off by some last places).
//!
//! Caught so far: nothing; it is here for the bounds of the f64 path, which most other pairs never come near.

mod support;

use num_rational::BigRational;
use rockproof_model::{Block, ContactKind, Number, Point, Precision, ToleranceSet, Vec3};
use rockproof_oracle::{LevelCounts, Pair, PreparedBlock, plain};
use support::handworked;
use support::shapes::{block, cuboid, number, point, revised};

const ROUNDS: u64 = 2;
const FULL_ROUNDS: u64 = 8;

/// SplitMix64: the same pairs everywhere.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % n
    }

    fn fraction(&mut self) -> Number {
        let (numerator, denominator) = (self.below(2_001) as i64 - 1_000, 2 * self.below(500) as i64 + 1);
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

fn draw(case: &handworked::Case, round: u64, dice: &mut Dice) -> Option<Drawn> {
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
    let mut dice = Dice(11);
    let (mut levels, mut pairs, mut touching, mut neighbours) = (LevelCounts::default(), 0u64, 0u64, [0, 0]);
    for case in handworked::cases() {
        for round in 0..rounds {
            let Some(Drawn { a, b, tolerances, about }) = draw(&case, round, &mut dice) else { continue };
            let (solid_a, solid_b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
            let pair = Pair::new(&solid_a, &solid_b);
            let kept = if round % 2 == 0 { case.kept.as_slice() } else { &[] };
            let answer = pair.classify_keeping(&tolerances, kept);
            let plainly: Vec<_> = plain::classify_keeping::<BigRational>(&a, &b, &tolerances, kept)
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
    let mut dice = Dice(5);
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
