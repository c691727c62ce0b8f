//! Products of edges and normals on lattices of single blocks, against integers: on blocks of all widths, in fractions, near and far, whose edges are parallel
//! to faces and edges of one another or nearly so.

use super::edge_in_plane::FACES;
use super::in_integers::{sign_of, value_of};
use super::{Dice, Input, block, without_tolerances};
use crate::own_lattice::ProductAlongNormal;
use crate::pair::Pair;
use crate::predicate::{
    AsEdgeAlongNormal, Edge, EdgeAlongNormal, Face, InwardAcross, ParallelAngle, ParallelReach, Polynomial, across,
};
use crate::prepared_block::PreparedBlock;
use crate::sign_cascade::SignCascade;
use crate::view::{ExactView, LazyScales, Scales};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use rockproof_model::decision::Side;
use rockproof_model::{Block, BlockOptions, EdgeId, FaceId, Number, Sign, Vec3};
use std::cell::OnceCell;

type Span = [BigInt; 3];

/// The parallelepiped that these vectors span, times `unit`, from a corner; none where they do not go round to the right.
fn spanned(corner: &[BigRational; 3], spans: &[Span; 3], unit: &BigRational) -> Option<Block> {
    let vertices = (0..8).map(|k: usize| {
        let at = |axis: usize| {
            let along = (0..3).filter(|s| k >> s & 1 == 1).map(|s| &spans[s][axis]).sum::<BigInt>();
            Number::from_rational(&corner[axis] + BigRational::from_integer(along) * unit)
        };
        Vec3::new(at(0), at(1), at(2))
    });
    let faces = FACES.iter().map(|face| face.to_vec()).collect();
    Block::new(vertices.collect(), faces, &BlockOptions { planarity: Number::ZERO }).ok()
}

fn ratio(numerator: i64, denominator: u64, twos: u32) -> BigRational {
    BigRational::new(numerator.into(), BigInt::from(denominator) << twos)
}

/// An integer of at most so many binary digits.
fn integer(dice: &mut Dice, digits: u64) -> BigInt {
    let long = (BigInt::from(dice.next()) << 64u32) + BigInt::from(dice.next());
    let short: BigInt = long >> (128 - digits);
    if dice.below(2) == 0 { -short } else { short }
}

/// The sign of a product that is at most `size` in metres, and the bits that tell it.
fn told_by_lattices(pair: &Pair<'_>, edge: Edge, face: Face, own: Option<Edge>, size: f64) -> Option<(Sign, u32)> {
    let ends = |edge: Edge| pair.prepared(edge.0).edges[edge.1.index()].ends;
    let own_lattice = |side: Side| pair.prepared(side).own_lattice().expect("short enough");
    let product = ProductAlongNormal {
        edge: (own_lattice(edge.0), ends(edge)),
        face: (own_lattice(face.0), face.1, pair.topology(face.0).face(face.1)),
        own: own.map(ends),
    };
    product.sign(size)
}

/// Holds that edges count as parallel where they are, and says whether.
fn check_parallel(pair: &Pair<'_>, edge_a: EdgeId, edge_b: EdgeId, about: &str) -> bool {
    let n = direction_across(pair, edge_a, edge_b);
    let parallel = n.components().into_iter().all(|c| *c == BigInt::ZERO);
    let t = without_tolerances();
    let run = SignCascade::new(pair, &t);
    assert_eq!(run.edges_are_parallel(edge_a, edge_b), parallel, "{about}: edges {edge_a} and {edge_b}");
    parallel
}

/// In units of the lattice of the pair.
fn direction_across(pair: &Pair<'_>, edge_a: EdgeId, edge_b: EdgeId) -> Vec3<BigInt> {
    let no_scales = LazyScales { made: &OnceCell::new(), make: &Scales::none };
    across(&ExactView { geometry: pair.heap(), scales: no_scales }, edge_a, edge_b)
}

/// What was seen: products told by 128 and 256 bits and by none, those among them that are zero, and parallel edges.
#[derive(Debug, Default)]
struct Seen {
    narrow: usize,
    wide: usize,
    untold: usize,
    zeros: usize,
    crossed: usize,
    parallel: usize,
}

impl Seen {
    /// Holds that a product has the sign of a polynomial times `turn`, whether the size of that is known or not.
    fn check<P: Polynomial>(&mut self, pair: &Pair<'_>, p: &P, told: (Edge, Face, Option<Edge>, Sign), about: &str) {
        let (edge, face, own, turn) = told;
        let t = without_tolerances();
        let (exact, sign) = (value_of(pair, &t, p), sign_of(pair, &t, p));
        let (units, metres) = pair.grid().lattice.units_per_metre();
        let metres = BigRational::from_integer(exact) * BigRational::new(metres, units).pow(P::DEGREE as i32);
        // Hardly above it, so that one bit less than are needed is noticed.
        let size = metres.abs().to_f64().expect("moderate") * (1.0 + 1e-14);
        for size in [size, f64::INFINITY] {
            match told_by_lattices(pair, edge, face, own, size) {
                Some((told, bits)) => {
                    assert_eq!(told.times(turn), sign, "{about}: {edge:?}, {face:?}, {own:?}, {bits} bits");
                    *(if bits == 128 { &mut self.narrow } else { &mut self.wide }) += 1;
                }
                None => self.untold += 1,
            }
        }
        self.zeros += usize::from(sign.is_zero());
        self.crossed += usize::from(own.is_some());
    }

    fn check_pair(&mut self, dice: &mut Dice, a: &PreparedBlock, b: &PreparedBlock, about: &str) {
        let pair = Pair::new(a, b);
        let any = |dice: &mut Dice, n: usize| dice.below(n as u64) as u32;
        let faces = |side: Side| pair.topology(side).faces().len();
        for _ in 0..20 {
            let (edge_a, edge_b) = (EdgeId(any(dice, a.edges.len())), EdgeId(any(dice, b.edges.len())));
            for (of_edge, of_face) in [(Side::A, Side::B), (Side::B, Side::A), (Side::A, Side::A)] {
                let face = (of_face, FaceId(any(dice, faces(of_face))));
                let edge = (of_edge, if of_edge == Side::A { edge_a } else { edge_b });
                self.check(&pair, &EdgeAlongNormal { edge, face }, (edge, face, None, Sign::Positive), about);
            }
            let right = dice.below(2) == 0;
            for side in [Side::A, Side::B] {
                let inward = InwardAcross { edge_a, edge_b, side, right };
                let AsEdgeAlongNormal { edge, face, turn, in_plane } =
                    inward.as_edge_along_normal(&pair).expect("of all of these");
                self.check(&pair, &inward, (edge, face, in_plane, turn), about);
            }
            self.parallel += usize::from(check_parallel(&pair, edge_a, edge_b, about));
        }
    }
}

#[test]
fn lattices_of_single_blocks_tell_the_signs_of_integers() {
    let (mut dice, mut seen, mut pairs) = (Dice(51), Seen::default(), 0);
    for round in 0..160 {
        let digits = 1 + dice.below(56) + dice.below(56);
        let any = |dice: &mut Dice| [0; 3].map(|_: i64| integer(dice, digits));
        let spans = [any(&mut dice), any(&mut dice), any(&mut dice)];
        let sum = |one: &Span, other: &Span| [0, 1, 2].map(|k| &one[k] + &other[k]);
        let negated = |one: &Span| [0, 1, 2].map(|k| -&one[k]);
        let mut beside = sum(&spans[0], &spans[1]);
        beside[dice.below(3) as usize] += 1;
        let along = [spans[0].clone(), negated(&spans[1]), sum(&spans[0], &spans[1]), beside, any(&mut dice)];
        let pick = |dice: &mut Dice| along[dice.below(5) as usize].clone();
        let others = [pick(&mut dice), pick(&mut dice), any(&mut dice)];
        let mut unit = || ratio(1 + dice.below(6) as i64, [1, 1, 3, 7][dice.below(4) as usize], dice.below(90) as u32);
        let (unit_a, unit_b) = (unit(), unit());
        let mut place =
            |unit: &BigRational| [0; 3].map(|_: i64| unit * BigRational::from_integer(integer(&mut dice, 4)));
        let corners = [place(&unit_a), place(&ratio(1, 5, 3))];
        let (Some(a), Some(b)) = (spanned(&corners[0], &spans, &unit_a), spanned(&corners[1], &others, &unit_b)) else {
            continue;
        };
        let (a, b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
        if a.own_lattice().is_some() && b.own_lattice().is_some() {
            seen.check_pair(&mut dice, &a, &b, &format!("round {round}, {digits} digits"));
            pairs += 1;
        }
    }
    let Seen { narrow, wide, untold, zeros, crossed, parallel } = seen;
    assert!(pairs > 20 && narrow > 500 && wide > 500 && untold > 100, "{pairs} pairs, {seen:?}");
    assert!(zeros > 300 && crossed > 500 && parallel > 20, "{seen:?}");
}

/// Components of a cross product that are multiples of 2¹²⁸, of edges that are at right angles.
#[test]
fn edges_whose_product_is_zero_in_128_bits_are_not_parallel() {
    let whole = |spans: [[i128; 3]; 3]| {
        let zero = [0; 3].map(|_: i64| ratio(0, 1, 0));
        let block = spanned(&zero, &spans.map(|span| span.map(BigInt::from)), &ratio(1, 1, 0)).expect("a block");
        PreparedBlock::new(&block)
    };
    let a = whole([[1 << 64, 0, 0], [0, 1, 0], [0, 0, 1]]);
    let b = whole([[1, 0, 0], [0, 1 << 64, 0], [0, 0, 1]]);
    let (pair, t) = (Pair::new(&a, &b), without_tolerances());
    let mut run = SignCascade::new(&pair, &t);
    let mut asked = 0;
    for edge_a in a.block.topology().edge_ids() {
        for edge_b in b.block.topology().edge_ids() {
            let axis = |of: &PreparedBlock, edge: EdgeId| {
                of.edges[edge.index()].direction.components().into_iter().position(|c| c.0 != 0.0)
            };
            let parallel = axis(&a, edge_a) == axis(&b, edge_b);
            assert_eq!(run.edges_are_parallel(edge_a, edge_b), parallel, "edges {edge_a} and {edge_b}");
            let sign = if parallel { Sign::Zero } else { Sign::Negative };
            assert_eq!(run.sign(&ParallelAngle { edge_a, edge_b }), sign, "edges {edge_a} and {edge_b}");
            assert_eq!(run.sign(&ParallelReach { edge_a, edge_b, longer: Side::B }), sign);
            asked += 1;
        }
    }
    assert_eq!(asked, 144);
}

/// Where a tolerance is not zero, however small, parallel edges are within it.
#[test]
fn parallel_edges_are_zero_under_no_tolerance_only() {
    let at = |c: i32| Vec3::new(c, c, c).map(|&c| Number::from_integer(c));
    let cube = PreparedBlock::new(&Block::cuboid(&at(0), &at(1)).unwrap());
    let pair = Pair::new(&cube, &cube);
    let tiny = Number::from_f64(1e-30).unwrap();
    let (edge_a, edge_b) = (EdgeId(0), EdgeId(0));
    for (sine, reach) in [(false, false), (true, false), (false, true)] {
        let mut t = without_tolerances();
        if sine {
            t.parallel_sine = tiny.clone();
        }
        if reach {
            t.territory = tiny.clone();
        }
        let mut run = SignCascade::new(&pair, &t);
        let expected = |within: bool| if within { Sign::Positive } else { Sign::Zero };
        assert_eq!(run.sign(&ParallelAngle { edge_a, edge_b }), expected(sine));
        assert_eq!(run.sign(&ParallelReach { edge_a, edge_b, longer: Side::A }), expected(reach));
    }
}

/// Two cuboids: products that are `±2¹²⁷` and `±2²⁵⁵` on their lattices, and a little smaller ones, of which each is as large as it is said to be at most.
/// Long offsets make the lattices of the coordinates finer, but not those of the differences.
#[test]
fn products_at_the_end_of_a_width_take_the_next() {
    let power = |k: u32| BigInt::from(1) << k;
    let mut asked = 0;
    // Binary digits, those of the sides of the face, and whether an edge of its own along the first of them counts twice.
    for (width, y, z, twice) in [(128, 40, 40, false), (128, 20, 20, true), (256, 85, 85, false), (256, 52, 52, true)] {
        let long = width - 1 - (1 + y + z) - if twice { 2 * y } else { 0 };
        // An f64 holds either.
        for (length, held) in [(power(long), false), (power(long) - power(long - 40), true)] {
            for (twos_a, twos_b) in [(0, 0), (30, 0), (0, 30), (30, 30)] {
                for units in [[0, 0], [70, 3]] {
                    let block = |twos: u32, unit: u32, [x, y, z]: [BigInt; 3]| {
                        let zero = || BigInt::ZERO;
                        let spans = [[x, zero(), zero()], [zero(), y, zero()], [zero(), zero(), z]];
                        let place = if twos == 0 { ratio(0, 1, 0) } else { ratio(1, 1, twos + unit) };
                        let corner = [0; 3].map(|_: i32| place.clone());
                        PreparedBlock::new(&spanned(&corner, &spans, &ratio(1, 1, unit)).expect("a block"))
                    };
                    let a = block(twos_a, units[0], [length.clone(), power(0), power(0)]);
                    let b = block(twos_b, units[1], [power(0), power(y), power(z)]);
                    let (pair, t) = (Pair::new(&a, &b), without_tolerances());
                    let topology = b.block.topology();
                    let along_x = |edge: &EdgeId| a.edges[edge.index()].direction.x.0 != 0.0;
                    for edge in a.block.topology().edge_ids().filter(along_x).map(|edge| (Side::A, edge)) {
                        for face in (0..6).map(|face| (Side::B, FaceId(face))) {
                            let sign = sign_of(&pair, &t, &EdgeAlongNormal { edge, face });
                            let along_y = |own: &EdgeId| {
                                let ends = topology.edge(*own);
                                (ends.left == face.1 || ends.right == face.1)
                                    && b.edges[own.index()].direction.y.0 != 0.0
                            };
                            let own = twice.then(|| topology.edge_ids().find(along_y)).flatten();
                            if sign.is_zero() || own.is_none() == twice {
                                continue;
                            }
                            let steps = if held { power(width - 1) - power(width - 41) } else { power(width - 1) };
                            let metre = 2f64.powi(-(units[0] + units[1] * if twice { 4 } else { 2 }).cast_signed());
                            let size = steps.to_f64().expect("moderate") * metre;
                            let own = own.map(|own| (Side::B, own));
                            let told = told_by_lattices(&pair, edge, face, own, size);
                            let expected = if held { Some((sign, width)) } else { Some((sign, 256)) };
                            let about = format!("{width} bits, {twice}, {held}, {twos_a}, {twos_b}, {units:?}");
                            assert_eq!(told, expected.filter(|_| held || width < 256), "{about}");
                            asked += 1;
                        }
                    }
                }
            }
        }
    }
    // Four edges and two faces each.
    assert_eq!(asked, 4 * 2 * 4 * 2 * 8);
}

/// Pyramids seen from their tips, in the middle of the square that the base nearly fills: on its normal the bound has but three bits to spare.
#[test]
fn normals_of_128_bits_and_more_are_held() {
    let at = |c: i32| Vec3::new(c, c, c).map(|&c| Number::from_integer(c));
    let cube = PreparedBlock::new(&Block::cuboid(&at(0), &at(1)).unwrap());
    let mut seen = Seen::default();
    for digits in 56..=66 {
        let far = (BigInt::from(1) << digits) - 1;
        let whole = |c: &BigInt| Number::from_rational(BigRational::from_integer(c.clone()));
        let corner = |x: i32, y: i32| Vec3::new(whole(&(&far * x)), whole(&(&far * y)), Number::from_integer(-1));
        let vertices = vec![at(0), corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
        let faces = vec![vec![1u32, 4, 3, 2], vec![0, 1, 2], vec![0, 2, 3], vec![0, 3, 4], vec![0, 4, 1]];
        let block = Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).expect("a block");
        let pyramid = PreparedBlock::new(&block);
        let pair = Pair::new(&cube, &pyramid);
        for edge in cube.block.topology().edge_ids().map(|edge| (Side::A, edge)) {
            for face in (0..5).map(|face| (Side::B, FaceId(face))) {
                let about = format!("{digits} digits");
                seen.check(&pair, &EdgeAlongNormal { edge, face }, (edge, face, None, Sign::Positive), &about);
            }
        }
    }
    assert!(seen.narrow > 100 && seen.wide > 100, "{seen:?}");
}

/// Tetrahedra with an edge each whose ends are at both sides of the first vertex, so that it has one digit more than these. Of the edges
/// `(3·2⁶², 7·2⁶¹)` and `(−2⁶³, 3·2⁶²)` the product is 2¹²⁸.
#[test]
fn edges_of_a_digit_more_than_vertices_are_not_parallel() {
    let tetrahedron = |x: i64, y: i64, beside: [i64; 2]| {
        let point = |x: i64, y: i64, z: i64| Vec3::new(x, y, z).map(|&c| Number::from_rational(ratio(c, 1, 0)));
        let vertices = vec![point(0, 0, 1), point(-x, -y, 0), point(x, y, 0), point(beside[0], beside[1], 0)];
        let faces = vec![vec![1u32, 3, 2], vec![0, 1, 2], vec![0, 2, 3], vec![0, 3, 1]];
        let block = Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).expect("a block");
        PreparedBlock::new(&block)
    };
    let a = tetrahedron(3 << 61, 7 << 60, [-1, 1]);
    let b = tetrahedron(-(1 << 62), 3 << 61, [-1, -1]);
    let pair = Pair::new(&a, &b);
    let mut wrapped = 0;
    for edge_a in a.block.topology().edge_ids() {
        for edge_b in b.block.topology().edge_ids() {
            let parallel = check_parallel(&pair, edge_a, edge_b, "tetrahedra");
            let n = direction_across(&pair, edge_a, edge_b);
            let in_128_bits = (BigInt::from(1) << 128) - 1u32;
            wrapped += usize::from(!parallel && n.components().into_iter().all(|c| (c & &in_128_bits) == BigInt::ZERO));
        }
    }
    assert_eq!(wrapped, 1);
}

/// Blocks of all kinds of numbers, with faces that are bent and loops of many corners: there edges of a face are not at right angles to its normal.
#[test]
fn bent_and_long_faces_have_the_signs_of_integers() {
    let (mut dice, mut seen, mut pairs) = (Dice(52), Seen::default(), 0);
    for round in 0..150 {
        let mut input = || match dice.below(2) {
            0 => Input::Digits(1 + dice.below(48) as u32),
            _ => {
                dice.pick(&[Input::FullDoubles, Input::NearTies, Input::FarAway, Input::Fractions, Input::FarFractions])
            }
        };
        let (of_a, of_b) = (input(), input());
        let (Some(a), Some(b)) = (block(&mut dice, of_a, 0), block(&mut dice, of_b, 1)) else { continue };
        let (a, b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
        if a.own_lattice().is_none() || b.own_lattice().is_none() {
            continue;
        }
        seen.check_pair(&mut dice, &a, &b, &format!("round {round}, {of_a:?}, {of_b:?}"));
        pairs += 1;
    }
    assert!(pairs > 100 && seen.narrow > 1000 && seen.wide > 1000 && seen.crossed > 1000, "{pairs} pairs, {seen:?}");
}
