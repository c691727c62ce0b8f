//! Which block and edge a rule names, where lengths differ by the last bits of coordinates or not at all, against fractions of every length.

use num_rational::BigRational;
use num_traits::Zero;
use proptest::prelude::*;
use rockproof_model::tolerance_rules::check;
use rockproof_model::{Block, BlockOptions, Criteria, Number, Precision, Rule, ToleranceSet, Vec3, VertexId};

/// A tetrahedron near `at` (m) with edges of about a metre; `bits` are last bits that its coordinates are off by, and a fraction that f64 does not hold where
/// one is above all.
fn tetrahedron(at: f64, bits: [[i8; 3]; 4]) -> Block {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.2], [0.1, 1.0, 0.2], [0.3, 0.2, 1.0]];
    let coordinate = |value: f64, bits: i8| match bits {
        3 => {
            Number::from_rational(BigRational::new(1.into(), 3.into()) + Number::from_f64(value).unwrap().to_rational())
        }
        bits => Number::from_f64(f64::from_bits((at + value).to_bits().wrapping_add_signed(i64::from(bits)))).unwrap(),
    };
    let vertex = |(corner, bits): ([f64; 3], [i8; 3])| {
        let [x, y, z] = [0, 1, 2].map(|axis| coordinate(1.0 + corner[axis], bits[axis]));
        Vec3::new(x, y, z)
    };
    let vertices = corners.into_iter().zip(bits).map(vertex).collect();
    let faces: Vec<Vec<u32>> = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(Vec::from).into();
    Block::new(vertices, faces, &BlockOptions::default()).expect("a block")
}

fn blocks() -> impl Strategy<Value = Vec<Block>> {
    // One block in sixteen has thirds; most are off by a bit or none, so that lengths are often equal.
    let bits = prop_oneof![
        15 => prop::array::uniform4(prop::array::uniform3(-1_i8..2)),
        1 => Just([[3; 3]; 4])
    ];
    let at = prop_oneof![Just(0.0), Just(64.0), Just(1e5)];
    (at, prop::collection::vec(bits, 1..12)).prop_map(|(at, all)| all.into_iter().map(|b| tetrahedron(at, b)).collect())
}

/// The number of a block, and the ends of an edge of it where the length is one.
type Place = (usize, Option<(VertexId, VertexId)>);

/// The first of the places with the least length, or with the greatest.
fn first(lengths: &[(BigRational, Place)], greatest: bool) -> Place {
    let better = |a: &BigRational, b: &BigRational| if greatest { a > b } else { a < b };
    let best = lengths.iter().reduce(|best, next| if better(&next.0, &best.0) { next } else { best });
    best.expect("a length").1
}

fn squared_distance(p: &Vec3<BigRational>, q: &Vec3<BigRational>) -> BigRational {
    p.minus(q).norm_squared()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_rule_names_the_first_of_equal_lengths_and_none_that_is_a_bit_off(blocks in blocks()) {
        let (mut edges, mut radii, mut coordinates) = (Vec::new(), Vec::new(), Vec::new());
        for (number, block) in blocks.iter().enumerate() {
            let points: Vec<_> = block.vertices().iter().map(|v| v.map(Number::to_rational)).collect();
            for edge in block.topology().edges() {
                let squared = squared_distance(&points[edge.p.index()], &points[edge.q.index()]);
                edges.push((squared, (number, Some((edge.p, edge.q)))));
            }
            let centroid = block.centroid();
            radii.extend(points.iter().map(|p| (squared_distance(p, &centroid), (number, None))));
            coordinates.extend(points.into_iter().flat_map(|p| [p.x, p.y, p.z]).map(|c| (c, (number, None))));
        }
        let number = |value: f64| Number::from_f64(value).unwrap();
        let broken = ToleranceSet {
            territory: number(1.0),
            penetration: number(1e-3),
            overlap_sine: number(0.9),
            parallel_sine: number(0.99),
            max_displacement: number(9.0),
            max_rotation: number(0.9),
            search: number(9.0),
            criteria: Criteria::Classic,
            ..ToleranceSet::ZERO
        };
        let unresolved = ToleranceSet { territory: Number::ZERO, ..broken.clone() };
        let shapes: Vec<&Block> = blocks.iter().collect();
        let place = |set: &ToleranceSet, rule: Rule| {
            let found = check(set, &shapes, Precision::F64).into_iter().find(|violation| violation.rule == rule);
            found.and_then(|violation| violation.place).map(|place| (place.block, place.edge))
        };
        prop_assert!(coordinates.iter().all(|(c, _)| *c >= BigRational::zero()));
        prop_assert_eq!(place(&broken, Rule::TerritoryOnEdge), Some(first(&edges, false)));
        prop_assert_eq!(place(&broken, Rule::Displacement), Some(first(&edges, false)));
        prop_assert_eq!(place(&unresolved, Rule::ParallelEdges).or(place(&broken, Rule::Overlap)), Some(first(&edges, true)));
        prop_assert_eq!(place(&broken, Rule::Rotation), Some(first(&radii, true)));
        prop_assert_eq!(place(&unresolved, Rule::TerritoryResolved), Some(first(&coordinates, true)));
    }
}
