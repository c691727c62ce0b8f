//! Products of edges and normals on lattices of single blocks, against integers: on blocks of all widths, in fractions, near and far, whose edges are parallel
//! to faces and edges of one another or nearly so.

use super::edge_in_plane::FACES;
use super::{Dice, in_integers, value_in_integers, without_tolerances};
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
        let (exact, sign) = (value_in_integers::<_, BigInt>(pair, &t, p), in_integers::<_, BigInt>(pair, &t, p));
        let (units, metres) = pair.grid().lattice.units_per_metre();
        let metres = BigRational::from_integer(exact) * BigRational::new(metres, units).pow(P::DEGREE as i32);
        // Hardly above it, so that one bit less than are needed is noticed.
        let size = metres.abs().to_f64().expect("moderate") * (1.0 + 1e-14);
        let ends = |edge: Edge| pair.prepared(edge.0).edges[edge.1.index()].ends;
        let own_lattice = |side: Side| pair.prepared(side).own_lattice().expect("short enough");
        let product = ProductAlongNormal {
            edge: (own_lattice(edge.0), ends(edge)),
            face: (own_lattice(face.0), face.1, pair.topology(face.0).face(face.1)),
            own: own.map(ends),
        };
        for size in [size, f64::INFINITY] {
            match product.sign(size) {
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
        let any = |dice: &mut Dice, n: u64| dice.below(n) as u32;
        for _ in 0..20 {
            let (edge_a, edge_b) = (EdgeId(any(dice, 12)), EdgeId(any(dice, 12)));
            let face = FaceId(any(dice, 6));
            for (of_edge, of_face) in [(Side::A, Side::B), (Side::B, Side::A), (Side::A, Side::A)] {
                let (edge, face) = ((of_edge, if of_edge == Side::A { edge_a } else { edge_b }), (of_face, face));
                self.check(&pair, &EdgeAlongNormal { edge, face }, (edge, face, None, Sign::Positive), about);
            }
            let right = dice.below(2) == 0;
            for side in [Side::A, Side::B] {
                let inward = InwardAcross { edge_a, edge_b, side, right };
                let AsEdgeAlongNormal { edge, face, turn, in_plane } =
                    inward.as_edge_along_normal(&pair).expect("of all of these");
                self.check(&pair, &inward, (edge, face, in_plane, turn), about);
            }
            let no_scales = LazyScales { made: &OnceCell::new(), make: &Scales::none };
            let n = across(&ExactView { geometry: pair.heap(), scales: no_scales }, edge_a, edge_b);
            let parallel = n.components().into_iter().all(|c| *c == BigInt::ZERO);
            let run_t = without_tolerances();
            let run = SignCascade::new(&pair, &run_t);
            assert_eq!(run.edges_are_parallel(edge_a, edge_b), parallel, "{about}: edges {edge_a} and {edge_b}");
            self.parallel += usize::from(parallel);
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
