// Longer than 400 lines: every polynomial is asked at every level in one walk.
//! Tests that no level of the cascade ever proves a wrong sign, on input made to tempt it: near-ties, ties, tiny and huge
//! coordinates, far origins, fractions.

use crate::field::Field;
use crate::levels::LevelCounts;
use crate::number::{Approx, Ball, Bound, INFLATION};
use crate::pair::Pair;
use crate::predicate::*;
use crate::prepared_block::PreparedBlock;
use crate::sign_cascade::SignCascade;
use crate::unit_bounds::unit_bounds_for;
use crate::view::{BallView, BoundView, ExactView, FloatView, LazyScales, Scales, View};
use in_integers::{InIntegers, PolynomialInIntegers};
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::decision::Side;
use rockproof_model::{
    Block, BlockOptions, EdgeId, Entrance, EntranceKind, FaceId, Number, Sign, ToleranceSet, Topology, Vec3, VertexId,
};
use std::cell::OnceCell;
use std::collections::BTreeMap;

mod definite;
mod edge_in_plane;
mod in_integers;
mod integer_width;
mod limits;
mod own_lattice;
mod parts;
mod places;
mod planes;
mod replayed;
mod sharp_planes;
mod ties;
mod vectors;

/// A small generator of its own (SplitMix64): the tests must not depend on a library's stream.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len() as u64) as usize]
    }
}

/// What kind of numbers the vertices are.
#[derive(Clone, Copy, Debug)]
enum Input {
    SmallIntegers,
    FullDoubles,
    NearTies,
    FarAway,
    Tiny,
    Huge,
    /// Products of two overflow.
    Overflowing,
    Underflowing,
    Fractions,
    /// Fractions beyond sixteen times their extent from the origin.
    FarFractions,
    /// Integers of so many binary digits: they bring polynomials to every width of integers.
    Digits(u32),
}

const INPUTS: [Input; 10] = [
    Input::SmallIntegers,
    Input::FullDoubles,
    Input::NearTies,
    Input::FarAway,
    Input::Tiny,
    Input::Huge,
    Input::Underflowing,
    Input::Fractions,
    Input::FarFractions,
    Input::Digits(0),
];

fn coordinate(dice: &mut Dice, corner: i32, input: Input) -> Number {
    let float = |x: f64| Number::from_f64(x).unwrap();
    let whole = f64::from(corner * 4) + dice.below(3) as f64 - 1.0;
    let fraction = dice.below(1 << 50) as f64 / (1u64 << 50) as f64;
    match input {
        Input::SmallIntegers => float(whole),
        Input::FullDoubles => float(whole + fraction),
        Input::NearTies => float(whole * (1.0 + f64::EPSILON * (dice.below(5) as f64 - 2.0))),
        Input::FarAway => float(1e8 + whole + fraction),
        Input::Tiny => float((whole + fraction) * 2f64.powi(-55)),
        Input::Huge => float((whole + fraction) * 2f64.powi(200)),
        Input::Overflowing => float((whole + fraction) * 2f64.powi(512)),
        Input::Underflowing => float((whole + fraction) * 2f64.powi(-250)),
        Input::Fractions => {
            Number::from_rational(BigRational::new((whole as i64 * 7 + dice.below(3) as i64).into(), 21.into()))
        }
        Input::FarFractions => Number::from_rational(BigRational::new(
            ((100_000 + whole as i64) * 7 + dice.below(3) as i64).into(),
            21.into(),
        )),
        Input::Digits(digits) => float((whole * 2f64.powi(digits as i32)).trunc() + dice.below(1 << digits) as f64),
    }
}

/// A prism over a polygon of so many corners, on a parabola.
fn prism(corners: i32) -> (Vec<[i32; 3]>, Vec<Vec<u32>>) {
    let n = corners as u32;
    let vertices = [0, 4].into_iter().flat_map(|z| (0..corners).map(move |k| [k, k * k, z])).collect();
    let sides = (0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]);
    (vertices, [(0..n).rev().collect(), (n..2 * n).collect()].into_iter().chain(sides).collect())
}

/// A tetrahedron, a hexahedron whose quadrilaterals need not be planar (predicates must hold for those too), or a prism.
fn block(dice: &mut Dice, input: Input, shift: i32) -> Option<Block> {
    if dice.below(16) == 0 {
        let (corners, faces) = prism([5, 8, 9, 33][dice.below(4) as usize]);
        let unit = coordinate(dice, 1, input);
        let vertices =
            corners.iter().map(|c| Vec3::new(c[0], c[1], c[2] + shift).map(|&c| unit.times(&Number::from_integer(c))));
        return Block::new(vertices.collect(), faces, &BlockOptions { planarity: Number::from_integer(1) }).ok();
    }
    let corners: Vec<[i32; 3]> = if dice.below(2) == 0 {
        vec![[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    } else {
        vec![[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    };
    let faces = if corners.len() == 4 {
        vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]]
    } else {
        vec![vec![0, 3, 2, 1], vec![4, 5, 6, 7], vec![0, 1, 5, 4], vec![1, 2, 6, 5], vec![2, 3, 7, 6], vec![3, 0, 4, 7]]
    };
    let vertices = corners
        .iter()
        .map(|&[x, y, z]| {
            Vec3::new(coordinate(dice, x, input), coordinate(dice, y, input), coordinate(dice, z + shift, input))
        })
        .collect();
    Block::new(vertices, faces, &BlockOptions { planarity: Number::from_integer(1) }).ok()
}

/// A set in which nothing may be apart, deep or askew, under `revised`.
pub(crate) fn without_tolerances() -> ToleranceSet {
    ToleranceSet::ZERO
}

fn tolerances(dice: &mut Dice, size: f64) -> ToleranceSet {
    let third = Number::from_rational(BigRational::new(1.into(), 3.into()));
    let length = |dice: &mut Dice| match dice.pick(&[0.0, 0.25, 1.0, 1.5, 0.1, 40.0, 1.0 / 3.0]) {
        part if part == 1.0 / 3.0 => Number::from_f64(size).unwrap().times(&third),
        part => Number::from_f64(size * part).unwrap(),
    };
    let sine = |dice: &mut Dice| dice.pick(&[(0, 1), (3, 64), (3, 5), (1, 3)]);
    let ratio = |(n, d): (i64, i64)| Number::from_rational(BigRational::new(n.into(), d.into()));
    ToleranceSet {
        search: length(dice),
        territory: length(dice),
        penetration: length(dice),
        overlap_sine: ratio(sine(dice)),
        parallel_sine: ratio(sine(dice)),
        equal: Number::from_f64(dice.pick(&[0.0, 1e-9, 0.5, 3.0])).unwrap(),
        ..without_tolerances()
    }
}

/// What was seen of one polynomial.
#[derive(Default)]
struct Seen {
    signs: [u64; 3],
    by_unit_bound: u64,
    by_pair_bound: u64,
    by_parts: u64,
    by_ball: u64,
    by_planes: u64,
    by_double: u64,
    enclosed: integer_width::Seen,
}

impl std::ops::AddAssign for Seen {
    fn add_assign(&mut self, other: Seen) {
        let Seen { signs, by_unit_bound, by_pair_bound, by_parts, by_ball, by_planes, by_double, enclosed } = other;
        self.signs.iter_mut().zip(signs).for_each(|(sum, count)| *sum += count);
        self.by_unit_bound += by_unit_bound;
        self.by_pair_bound += by_pair_bound;
        self.by_parts += by_parts;
        self.by_ball += by_ball;
        self.by_planes += by_planes;
        self.by_double += by_double;
        self.enclosed += enclosed;
    }
}

struct Checker<'p, 's> {
    pair: &'p Pair<'s>,
    run: SignCascade<'p, 's>,
    integers: InIntegers<'p, 's>,
    tolerances: &'p ToleranceSet,
    seen: &'p mut BTreeMap<usize, Seen>,
    /// What a slot holds for a pair: one bound, asked of whichever polynomial comes first.
    pair_bounds: BTreeMap<usize, f64>,
    /// What a slot holds for all pairs with loops as long and a bound on coordinates as large.
    unit_bounds: &'p mut BTreeMap<(usize, usize, u64), f64>,
    about: String,
}

/// All polynomials of a slot have one bound: it serves all of them.
fn expect_one_bound<K: Ord>(bounds: &mut BTreeMap<K, f64>, of: K, bound: f64, slot: usize, about: &str) {
    let first = *bounds.entry(of).or_insert(bound);
    assert_eq!(first.to_bits(), bound.to_bits(), "slot {slot} has the bounds {first:e} and {bound:e}, {about}");
}

/// Is shown polynomials.
trait Visitor {
    fn visit<P: Polynomial>(&mut self, p: &P);
}

impl Visitor for Checker<'_, '_> {
    fn visit<P: Polynomial>(&mut self, p: &P) {
        let (pair, t, about) = (self.pair, self.tolerances, &self.about);
        let slot = P::FIRST_SLOT + p.variant();
        assert!(p.variant() < P::VARIANTS && slot < SIGN_SLOTS);
        let in_integers = PolynomialInIntegers::new(&self.integers, p);
        let exact = in_integers.exact();
        self.seen.entry(slot).or_default().enclosed += integer_width::check(&self.run, p, &in_integers, about);
        assert_eq!(self.run.exact_sign(p), exact, "the width of integers chosen, slot {slot}, {about}");
        // Twice: the second time the bound for all pairs of the size is known.
        for time in 1..=2 {
            assert_eq!(self.run.sign(p), exact, "the cascade, slot {slot}, time {time}, {about}");
        }
        let certain = |value: f64, bound: f64| {
            if value > bound {
                Some(Sign::Positive)
            } else if value < -bound {
                Some(Sign::Negative)
            } else {
                None
            }
        };
        let floats: Scales<Approx> = Scales::approximate(t);
        let float_view = FloatView { a: pair.a, b: pair.b, scales: &floats };
        let value = p.value(&float_view).0;
        let seen = self.seen.entry(slot).or_default();
        seen.signs[(exact.as_i8() + 1) as usize] += 1;
        let (unit, powers) = unit_bounds_for(pair, &floats);
        let unit_bound =
            p.value(&BoundView::of_unit_size(pair.a, pair.b, unit.longest_loop, unit.coordinate)).error * INFLATION;
        let known = unit.get(slot);
        assert!(known.is_nan() || known == unit_bound, "{known:e} for {unit_bound:e}, slot {slot}, {about}");
        if let Some(sign) = certain(value, unit_bound * powers.of::<P>()) {
            assert_eq!(sign, exact, "unit bound, slot {slot}, {about}");
            seen.by_unit_bound += 1;
        }
        let pair_bound = p.value(&BoundView::of(pair.a, pair.b, Scales::<Bound>::bounds(t))).error;
        expect_one_bound(&mut self.pair_bounds, slot, pair_bound, slot, about);
        let alike = (slot, unit.longest_loop, unit.coordinate.to_bits());
        expect_one_bound(self.unit_bounds, alike, unit_bound, slot, about);
        // What holds for all pairs of a size holds for this one.
        let of_size = unit_bound * powers.of::<P>() * (1.0 + 1e-9);
        assert!(
            pair_bound <= of_size || !of_size.is_finite(),
            "{pair_bound:e} beyond {of_size:e}, slot {slot}, {about}"
        );
        if let Some(sign) = certain(value, pair_bound) {
            assert_eq!(sign, exact, "bound of the pair, slot {slot}, {about}");
            seen.by_pair_bound += 1;
        }
        if let Some(sign) = self.run.sign_by_parts(p, value) {
            assert_eq!(sign, exact, "sizes of parts, slot {slot}, {about}");
            seen.by_parts += 1;
        }
        let balls: OnceCell<Scales<Ball>> = OnceCell::new();
        let ball_view =
            BallView { floats: float_view, scales: LazyScales { made: &balls, make: &|| Scales::balls(t) } };
        if let Some(sign) = p.value(&ball_view).certain_sign() {
            assert_eq!(sign, exact, "ball, slot {slot}, {about}");
            seen.by_ball += 1;
        }
        if let Some(sign) = self.run.sign_by_sharp_planes(p, ball_view.scales()) {
            assert_eq!(sign, exact, "sharp planes, slot {slot}, {about}");
            seen.by_planes += 1;
        }
        if let Some(sign) = self.run.double_ball(p).certain_sign() {
            assert_eq!(sign, exact, "two f64, slot {slot}, {about}");
            seen.by_double += 1;
        }
        in_integers.check_widths(exact, about);
    }
}

/// Shows every polynomial, of features drawn at random.
fn show_all(pair: &Pair<'_>, dice: &mut Dice, visitor: &mut impl Visitor) {
    let any = |dice: &mut Dice, n: usize| dice.below(n as u64) as u32;
    let of = |side| pair.topology(side);
    let (ta, tb) = (of(Side::A), of(Side::B));
    let vertex_of = |dice: &mut Dice, t: &Topology| VertexId(any(dice, t.vertex_count()));
    let edge_of = |dice: &mut Dice, t: &Topology| EdgeId(any(dice, t.edges().len()));
    let face_of = |dice: &mut Dice, t: &Topology| FaceId(any(dice, t.faces().len()));
    let (va, vb) = (vertex_of(dice, ta), vertex_of(dice, tb));
    let (edge_a, edge_b) = (edge_of(dice, ta), edge_of(dice, tb));
    let (fa, fb) = (face_of(dice, ta), face_of(dice, tb));
    let axis = dice.below(3) as usize;
    let flip = dice.below(2) == 0;
    visitor.visit(&BoxesMeet { low: (Side::A, va), high: (Side::B, vb), axis });
    for limit in [LengthTolerance::Search, LengthTolerance::Territory, LengthTolerance::Penetration] {
        visitor.visit(&Near { a: va, b: vb, limit });
        for (vertex, edge) in [((Side::A, va), (Side::B, edge_b)), ((Side::B, vb), (Side::A, edge_a))] {
            visitor.visit(&NearLine { vertex, edge, limit });
        }
    }
    for (vertex, edge, face) in
        [((Side::A, va), (Side::B, edge_b), (Side::B, fb)), ((Side::B, vb), (Side::A, edge_a), (Side::A, fa))]
    {
        let own = if vertex.0 == Side::A { ta } else { tb };
        let other = if vertex.0 == Side::A { tb } else { ta };
        let at_vertex = own.vertex_edges(vertex.1)[0];
        let ends = *other.edge(edge.1);
        let far = other.faces()[if flip { ends.right } else { ends.left }.index()]
            .iter()
            .copied()
            .find(|&w| w != ends.p && w != ends.q)
            .unwrap();
        visitor.visit(&NearForEdge { a: va, b: vb, edge });
        visitor.visit(&BeyondVertex { point: vertex, at: (edge.0, ends.p), edge: edge.1 });
        visitor.visit(&FootAlong { vertex, edge, from_end: flip });
        visitor.visit(&NearLineForHeight { vertex, edge, height_at: far });
        visitor.visit(&InwardOf { vertex, edge, right: flip });
        visitor.visit(&FootBeyondVertex { vertex, edge, at_vertex });
        visitor.visit(&AbovePlane { vertex, face });
        visitor.visit(&PolygonHeight { vertex, corner: other.face(face.1)[0], face, axis });
        visitor.visit(&NormalComponent { face, axis });
        visitor.visit(&EdgeAbovePlane { vertex, edge: at_vertex, face });
        visitor.visit(&EdgeDipAngle { edge: (vertex.0, at_vertex), face });
        let inward = InwardAcross { edge_a, edge_b, side: edge.0, right: flip };
        for limit in [DipLimit::Penetration, DipLimit::TrueExit] {
            visitor.visit(&EdgeDipDepth { edge: (vertex.0, at_vertex), face, limit });
            visitor.visit(&WedgeDipDepth { inward, corner: far, limit });
        }
        visitor.visit(&ParallelReach { edge_a, edge_b, longer: vertex.0 });
        visitor.visit(&CommonFoot { edge_a, edge_b, on: vertex.0, from_end: flip });
        visitor.visit(&inward);
        visitor.visit(&WedgeDipAngle(inward));
        for edge in [(Side::A, edge_a), (Side::B, edge_b)] {
            visitor.visit(&EdgeAlongNormal { edge, face });
        }
    }
    visitor.visit(&ParallelAngle { edge_a, edge_b });
    visitor.visit(&Orientation { edge_a, edge_b });
    visitor.visit(&EdgesApart { edge_a, edge_b });
    let entrances = [Entrance::VertexFace(va, fb), Entrance::FaceVertex(fa, vb), Entrance::EdgeEdge(edge_a, edge_b)];
    let (wa, wb) = (vertex_of(dice, ta), vertex_of(dice, tb));
    let (da, db) = (edge_of(dice, ta), edge_of(dice, tb));
    let (ga, gb) = (face_of(dice, ta), face_of(dice, tb));
    let others = [Entrance::VertexFace(wa, gb), Entrance::FaceVertex(ga, wb), Entrance::EdgeEdge(da, db)];
    for first in entrances {
        for limit in [LengthTolerance::Search, LengthTolerance::Territory, LengthTolerance::Penetration] {
            visitor.visit(&GapWithin { entrance: first, limit });
        }
        for second in others {
            visitor.visit(&NormalsAgree { first, second });
            visitor.visit(&NormalsWithin { first, second });
            for factor in [Factor::One, Factor::OneMinusEqual, Factor::OnePlusEqual] {
                visitor.visit(&LargerGap { first, second, factor });
            }
        }
    }
}

impl Checker<'_, '_> {
    /// Asks every polynomial about features drawn at random; how many integers of each width that took.
    fn visit_all(mut self, dice: &mut Dice) -> LevelCounts {
        vectors::check(self.pair, self.tolerances, &self.about);
        show_all(self.pair, dice, &mut self);
        self.run.levels
    }
}

#[test]
fn no_level_proves_a_wrong_sign() {
    prove_no_wrong_sign(560);
}

#[test]
#[ignore = "half a minute; .ci/run runs it"]
fn no_level_proves_a_wrong_sign_at_full_size() {
    prove_no_wrong_sign(2_000);
}

fn walk(mut dice: Dice, rounds: usize) -> Walk {
    let Walk { mut seen, mut unit_bounds, mut levels } = Walk::default();
    for round in 0..rounds {
        let input = match INPUTS[round % INPUTS.len()] {
            Input::Digits(_) => Input::Digits(1 + dice.below(49) as u32),
            Input::Huge if dice.below(4) == 0 => Input::Overflowing,
            input => input,
        };
        // Below A's first vertex as well: then differences are longer than coordinates.
        let shift = dice.below(4) as i32 - 1;
        let (Some(a), Some(b)) = (block(&mut dice, input, 0), block(&mut dice, input, shift)) else { continue };
        let size = match input {
            Input::Tiny => 2f64.powi(-55),
            Input::Huge => 2f64.powi(200),
            Input::Overflowing => 2f64.powi(512),
            Input::Underflowing => 2f64.powi(-250),
            _ => 1.0,
        };
        let t = tolerances(&mut dice, size);
        let (a, b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
        let pair = Pair::new(&a, &b);
        let about = format!("round {round}, {input:?}");
        levels += Checker {
            pair: &pair,
            run: SignCascade::new(&pair, &t),
            integers: InIntegers::new(&pair, &t),
            tolerances: &t,
            seen: &mut seen,
            pair_bounds: BTreeMap::new(),
            unit_bounds: &mut unit_bounds,
            about,
        }
        .visit_all(&mut dice);
    }
    Walk { seen, unit_bounds, levels }
}

/// What a walk through random pairs came to.
#[derive(Default)]
struct Walk {
    seen: BTreeMap<usize, Seen>,
    unit_bounds: BTreeMap<(usize, usize, u64), f64>,
    levels: LevelCounts,
}

impl Walk {
    fn add(&mut self, other: Walk) {
        for (slot, seen) in other.seen {
            *self.seen.entry(slot).or_default() += seen;
        }
        for (of, bound) in other.unit_bounds {
            expect_one_bound(&mut self.unit_bounds, of, bound, of.0, "in another walk");
        }
        self.levels += other.levels;
    }
}

/// In two walks at a time, since it would else be the last test and leave a core idle.
fn prove_no_wrong_sign(rounds: usize) {
    let walks = std::thread::scope(|scope| {
        let both = [1, 2].map(|seed| scope.spawn(move || walk(Dice(seed), rounds / 2)));
        both.map(|thread| thread.join().unwrap_or_else(|failure| std::panic::resume_unwind(failure)))
    });
    let mut all = Walk::default();
    walks.into_iter().for_each(|walk| all.add(walk));
    let Walk { seen, levels, .. } = all;
    // The widths of integers are reached by what they are for.
    assert!(levels.fixed.into_iter().chain([levels.i128, levels.heap]).all(|count| count > 100), "{levels:?}");
    let sharp = |slot: &usize| (LargerGap::FIRST_SLOT..LargerGap::FIRST_SLOT + LargerGap::VARIANTS).contains(slot);
    for (slot, seen) in &seen {
        assert!(
            seen.by_unit_bound > 0 && seen.by_pair_bound > 0 && seen.by_ball > 0 && seen.by_double > 0,
            "slot {slot}: {} {} {} {} signs {:?}",
            seen.by_unit_bound,
            seen.by_pair_bound,
            seen.by_ball,
            seen.by_double,
            seen.signs
        );
        assert_eq!(seen.by_planes > 0, sharp(slot), "slot {slot}: {} by planes", seen.by_planes);
        assert!(seen.signs[0] > 0 && seen.signs[2] > 0, "slot {slot}: signs seen {:?}", seen.signs);
    }
    parts::check_use(&seen);
    let mut enclosed = integer_width::Seen::default();
    seen.values().for_each(|seen| enclosed += seen.enclosed);
    enclosed.check();
    let ties: u64 = seen.values().map(|s| s.signs[1]).sum();
    assert!(ties > 0);
    // Polynomials that share a slot by mistake would share its bound, which is too small for one of them.
    assert_eq!(seen.len(), SIGN_SLOTS);
}

#[test]
fn polynomials_have_the_degree_they_say() {
    struct Degree<'p> {
        once: &'p Pair<'p>,
        thrice: &'p Pair<'p>,
        t: ToleranceSet,
    }
    impl Degree<'_> {
        fn value<P: Polynomial>(&self, pair: &Pair<'_>, p: &P, factor: i32) -> BigInt {
            let mut t = self.t.clone();
            for length in [&mut t.search, &mut t.territory, &mut t.penetration] {
                *length = length.times(&Number::from_integer(factor));
            }
            let scales = LazyScales {
                made: &OnceCell::new(),
                make: &|| Scales::exact(&t, &rockproof_model::lattice::Lattice::unity()),
            };
            p.value(&ExactView { geometry: &pair.exact::<BigInt>(), scales })
        }

        fn check<P: Polynomial>(&self, p: &P) {
            let (once, thrice) = (self.value(self.once, p, 1), self.value(self.thrice, p, 3));
            assert_ne!(once, BigInt::ZERO);
            assert_eq!(once * BigInt::from(3).pow(P::DEGREE as u32), thrice, "slot {}", P::FIRST_SLOT);
        }
    }
    let vertices = [[0, 0, 0], [5, 1, 0], [1, 7, 2], [2, 1, 9]];
    let moved = [[3, 2, 1], [9, 5, 3], [4, 11, 2], [5, 4, 15]];
    let faces = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]];
    let build = |corners: &[[i32; 3]; 4], factor: i32| {
        let number = |n: i32| Number::from_integer(n * factor);
        let vertices = corners.iter().map(|&[x, y, z]| Vec3::new(number(x), number(y), number(z))).collect();
        PreparedBlock::new(&Block::new(vertices, faces.clone(), &BlockOptions { planarity: Number::ZERO }).unwrap())
    };
    let (a1, b1, a3, b3) = (build(&vertices, 1), build(&moved, 1), build(&vertices, 3), build(&moved, 3));
    // Three times an odd coordinate is odd: both pairs are on the lattice of the integers.
    let (once, thrice) = (Pair::new(&a1, &b1), Pair::new(&a3, &b3));
    let mut t = tolerances(&mut Dice(3), 1.0);
    t.search = Number::from_integer(3);
    t.territory = Number::from_integer(2);
    t.penetration = Number::from_integer(1);
    t.overlap_sine = Number::from_f64(0.5).unwrap();
    t.parallel_sine = Number::from_f64(0.25).unwrap();
    t.equal = Number::from_f64(0.125).unwrap();
    let degree = Degree { once: &once, thrice: &thrice, t };
    let (vertex, edge, face) = ((Side::A, VertexId(1)), (Side::B, EdgeId(2)), (Side::B, FaceId(3)));
    let entrance = |kind, a, b| Entrance::of_kind(kind, [a, b]);
    let (first, second) = (entrance(EntranceKind::VertexFace, 1, 2), entrance(EntranceKind::EdgeEdge, 1, 4));
    let inward = InwardAcross { edge_a: EdgeId(1), edge_b: EdgeId(4), side: Side::A, right: false };
    degree.check(&BoxesMeet { low: vertex, high: (Side::B, VertexId(2)), axis: 0 });
    degree.check(&Near { a: VertexId(1), b: VertexId(2), limit: LengthTolerance::Search });
    degree.check(&NearForEdge { a: VertexId(1), b: VertexId(2), edge });
    degree.check(&BeyondVertex { point: vertex, at: (Side::B, b1.block.topology().edges()[2].p), edge: EdgeId(2) });
    degree.check(&FootAlong { vertex, edge, from_end: true });
    degree.check(&NearLine { vertex, edge, limit: LengthTolerance::Territory });
    let ends = b1.block.topology().edges()[2];
    let far = (0..4).map(VertexId).find(|&v| v != ends.p && v != ends.q).unwrap();
    degree.check(&NearLineForHeight { vertex, edge, height_at: far });
    degree.check(&InwardOf { vertex, edge, right: true });
    degree.check(&FootBeyondVertex { vertex, edge, at_vertex: a1.block.topology().vertex_edges(VertexId(1))[0] });
    degree.check(&AbovePlane { vertex, face });
    degree.check(&GapWithin { entrance: second, limit: LengthTolerance::Penetration });
    degree.check(&GapWithin { entrance: first, limit: LengthTolerance::Search });
    degree.check(&PolygonHeight { vertex, corner: VertexId(1), face, axis: 1 });
    degree.check(&NormalComponent { face, axis: 0 });
    degree.check(&EdgeAbovePlane { vertex, edge: a1.block.topology().vertex_edges(VertexId(1))[0], face });
    degree.check(&EdgeDipAngle { edge: (Side::A, EdgeId(2)), face });
    degree.check(&ParallelAngle { edge_a: EdgeId(1), edge_b: EdgeId(4) });
    degree.check(&ParallelReach { edge_a: EdgeId(1), edge_b: EdgeId(4), longer: Side::B });
    degree.check(&CommonFoot { edge_a: EdgeId(1), edge_b: EdgeId(4), on: Side::B, from_end: true });
    degree.check(&Orientation { edge_a: EdgeId(1), edge_b: EdgeId(4) });
    degree.check(&inward);
    degree.check(&WedgeDipAngle(inward));
    let own = a1.block.topology().edges()[1];
    let corner = a1.block.topology().faces()[own.left.index()].iter().copied().find(|&w| w != own.p && w != own.q);
    for limit in [DipLimit::Penetration, DipLimit::TrueExit] {
        degree.check(&EdgeDipDepth { edge: (Side::A, EdgeId(2)), face, limit });
        degree.check(&WedgeDipDepth { inward, corner: corner.unwrap(), limit });
    }
    degree.check(&EdgesApart { edge_a: EdgeId(1), edge_b: EdgeId(4) });
    degree.check(&LargerGap { first, second, factor: Factor::OnePlusEqual });
    degree.check(&NormalsAgree { first, second });
    degree.check(&NormalsWithin { first, second });
    degree.check(&EdgeAlongNormal { edge: (Side::A, EdgeId(2)), face });
    degree.check(&PlaneSize { entrance: first });
    degree.check(&PlaneSize { entrance: second });
    degree.check(&WedgeSize(inward));
    degree.check(&EdgeSize { edge });
    degree.check(&CornerHeight { edge, corner: far });
}
