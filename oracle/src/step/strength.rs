//! The areas on which cohesion and tensile strength act (SPEC 5.15), exactly: in integers, on the common lattice of both blocks.

use super::contact::Sides;
use crate::common_area::{Flat, common_area};
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rockproof_model::lattice::Lattice;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Contact, EdgeId, Entrance, FaceId, Number, Vec3, VertexId};
use std::cmp::Ordering;

type IntVector = Vec3<BigInt>;

/// For each contact of a pair its share of the overlap area of its two faces, **times |N|**, N the contact's normal: a
/// fraction even where the area is none.
pub(crate) fn shares(blocks: [&Block; 2], contacts: &[Contact], overlap_sine: &Number) -> Option<Vec<BigRational>> {
    let lattice = Lattice::covering(blocks.iter().flat_map(|block| block.coordinates()));
    let units = |v: &rockproof_model::block::Point| v.map(|c| lattice.units(c));
    let origins = blocks.map(|block| units(&block.vertices()[0]));
    let points: [Vec<IntVector>; 2] =
        [0, 1].map(|side| blocks[side].vertices().iter().map(|v| units(v).minus(&origins[side])).collect());
    let sides = Sides::with_offset(blocks, [&points[0], &points[1]], origins[0].minus(&origins[1]));
    let sine = overlap_sine.to_rational();
    let mut facing = Vec::new();
    for contact in contacts {
        let normal = sides.normal_by(contact, |value| Some(ExactRing::sign(value)))?;
        let faces = faces(&sides, contact, &normal, &sine);
        facing.push((normal, faces));
    }
    // Both an area and |N| are squares of lengths.
    let (per_metre, over) = lattice.units_per_metre();
    let fourth = BigRational::new_raw(over.pow(4), per_metre.pow(4));
    // Contacts of one face have one normal: their area is worked out once.
    let mut known: Vec<(&IntVector, [FaceId; 2], BigRational)> = Vec::new();
    let mut shares = Vec::new();
    for (normal, faces) in &facing {
        let Some(faces) = faces else {
            shares.push(BigRational::zero());
            continue;
        };
        let sharing = facing.iter().filter(|(_, other)| other.as_ref() == Some(faces)).count();
        let whole = match known.iter().find(|(n, f, _)| *n == normal && f == faces) {
            Some((_, _, area)) => area.clone(),
            None => {
                let area = area_times_length(&sides, *faces, normal) * &fourth;
                known.push((normal, *faces, area.clone()));
                area
            }
        };
        shares.push(whole / BigInt::from(sharing));
    }
    Some(shares)
}

/// The faces of A and of B that a contact joins, if they face each other within the overlap angle. `normal` points from
/// B to A.
fn faces(sides: &Sides<'_, BigInt>, contact: &Contact, normal: &IntVector, sine: &BigRational) -> Option<[FaceId; 2]> {
    let at_vertex = |side: usize, vertex: VertexId| sides.blocks[side].topology().vertex_faces(vertex).to_vec();
    let at_edge = |side: usize, edge: EdgeId| {
        let edge = sides.blocks[side].topology().edge(edge);
        vec![edge.left.min(edge.right), edge.left.max(edge.right)]
    };
    let candidates = match contact.entrance {
        Entrance::VertexFace(vertex, face) => [at_vertex(0, vertex), vec![face]],
        Entrance::FaceVertex(face, vertex) => [vec![face], at_vertex(1, vertex)],
        Entrance::EdgeEdge(edge_a, edge_b) => [at_edge(0, edge_a), at_edge(1, edge_b)],
    };
    let towards = [normal.negated(), normal.clone()];
    let (sine, one) = (sine.numer().pow(2), sine.denom().pow(2));
    let squarest = |side: usize| {
        let measured = |face: FaceId| {
            let outward = sides.face_normal(side, face);
            let cosine = outward.dot(&towards[side]);
            (face, cosine, outward)
        };
        let mut all = candidates[side].iter().map(|&face| measured(face));
        let first = all.next()?;
        let (face, cosine, outward) = all.fold(first, |best, next| {
            let squarer = by_cosine((&next.1, &next.2), (&best.1, &best.2)) == Ordering::Greater;
            if squarer { next } else { best }
        });
        let limit = &sine * outward.norm_squared() * normal.norm_squared();
        (cosine.is_positive() && &one * outward.cross(normal).norm_squared() <= limit).then_some(face)
    };
    Some([squarest(0)?, squarest(1)?])
}

/// Compares `c/|N|` of two faces, c their product with one direction.
fn by_cosine(one: (&BigInt, &IntVector), two: (&BigInt, &IntVector)) -> Ordering {
    let size = |cosine: &BigInt, by: &IntVector| cosine * cosine.abs() * by.norm_squared();
    size(one.0, two.1).cmp(&size(two.0, one.1))
}

/// The area in which two faces overlap, seen along N, times |N|, in lattice units.
///
/// Seen along N in the coordinate plane across axis k, lengths are not true, but areas are the true ones times
/// |N|/|N_k|. Multiplied by N_k, what is seen there of a point p is `p_a·N_k − N_a·p_k`.
fn area_times_length(sides: &Sides<'_, BigInt>, faces: [FaceId; 2], normal: &IntVector) -> BigRational {
    let n = normal.components();
    let axis = (0..3).max_by_key(|&k| n[k].abs()).unwrap_or(0);
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    if n[axis].is_zero() {
        return BigRational::zero();
    }
    // Any multiple of N gives the same picture: the one of the shortest numbers.
    let common = n[axis].gcd(n[others[0]]).gcd(n[others[1]]);
    let across = n[axis] / &common;
    let slopes = others.map(|k| n[k] / &common);
    let flat = |side: usize| -> Vec<Flat> {
        let corners = sides.blocks[side].topology().face(faces[side]);
        let seen = |&v: &VertexId| {
            let at = sides.point(side, v);
            let at = at.components();
            std::array::from_fn(|k| at[others[k]] * &across - at[axis] * &slopes[k])
        };
        corners.iter().map(seen).collect()
    };
    common_area(&flat(0), &flat(1)) * BigRational::new(common, across.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{BlockOptions, ContactKey, ContactKind, EntranceKind, Point, Sign};

    fn whole(value: i64) -> BigRational {
        BigRational::from_integer(value.into())
    }

    fn fraction(numerator: i64, denominator: i64) -> BigRational {
        BigRational::new(numerator.into(), denominator.into())
    }

    fn at(c: [i32; 3]) -> Point {
        Vec3::new(Number::from_integer(c[0]), Number::from_integer(c[1]), Number::from_integer(c[2]))
    }

    /// A slab of which face 1 lies at z = 0: 6 by 3, so that twice its area is 36.
    fn slab() -> Block {
        Block::cuboid(&at([-1, -1, -1]), &at([5, 2, 0])).unwrap()
    }

    /// The contacts of the slab's top with these vertices of the other block.
    fn on_top(vertices: &[u32]) -> Vec<Contact> {
        let contact = |&vertex: &u32| Contact {
            key: ContactKey::of_kind(ContactKind::FaceVertex, [1, vertex]),
            entrance: Entrance::of_kind(EntranceKind::FaceVertex, [1, vertex]),
            gap: Sign::Zero,
        };
        vertices.iter().map(contact).collect()
    }

    fn turned(block: &Block, axis: usize, [cosine, sine]: [&BigRational; 2]) -> Block {
        let (one, two) = ((axis + 1) % 3, (axis + 2) % 3);
        let turn = |v: &Point| {
            let old = v.components().map(Number::to_rational);
            let mut new = old.clone();
            new[one] = cosine * &old[one] - sine * &old[two];
            new[two] = sine * &old[one] + cosine * &old[two];
            let [x, y, z] = new.map(Number::from_rational);
            Vec3::new(x, y, z)
        };
        block.with_vertices(block.vertices().iter().map(turn).collect())
    }

    fn quarter(block: &Block) -> Block {
        block.with_vertices(block.vertices().iter().map(|v| Vec3::new(v.z.clone(), v.x.clone(), v.y.clone())).collect())
    }

    /// A table whose feet stand on z = 0, [0, 1] × [0, 1] and [2, 4] × [0, 1], and the vertices of both.
    fn table() -> (Block, Vec<u32>) {
        let corners = [[0, 0], [1, 0], [1, 1], [2, 1], [2, 0], [4, 0], [4, 2], [0, 2]];
        let vertices = [0, 1].iter().flat_map(|&y| corners.map(|[x, z]| at([x, y, z]))).collect();
        let sides = (0..8u32).map(|k| vec![(k + 1) % 8, k, k + 8, (k + 1) % 8 + 8]);
        let faces = [(0..8).collect(), (8..16).rev().collect()].into_iter().chain(sides).collect();
        let table = Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).unwrap();
        (table, vec![0, 1, 8, 9, 4, 5, 12, 13])
    }

    #[test]
    fn each_foot_of_a_table_shares_its_own_area_however_both_blocks_are_turned() {
        let (table, feet) = table();
        // Four contacts of each foot: areas 1 and 2, times twice the area of the slab's top.
        let expected = [9, 9, 9, 9, 18, 18, 18, 18].map(whole);
        let (plainly, other) = ([fraction(4, 5), fraction(3, 5)], [fraction(12, 13), fraction(5, 13)]);
        let turns: [&dyn Fn(&Block) -> Block; 8] = [
            &Block::clone,
            &|block| quarter(block),
            &|block| quarter(&quarter(block)),
            &|block| turned(block, 0, plainly.each_ref()),
            &|block| turned(&turned(block, 0, plainly.each_ref()), 1, other.each_ref()),
            &|block| turned(&turned(block, 0, other.each_ref()), 2, plainly.each_ref()),
            &|block| turned(&turned(block, 1, plainly.each_ref()), 2, other.each_ref()),
            &|block| quarter(&turned(&turned(block, 0, plainly.each_ref()), 1, other.each_ref())),
        ];
        for (k, turn) in turns.iter().enumerate() {
            let blocks = [turn(&slab()), turn(&table)];
            let found = shares(blocks.each_ref(), &on_top(&feet), &Number::ZERO).unwrap();
            assert_eq!(found, expected, "turn {k}");
        }
    }

    #[test]
    fn a_face_within_the_overlap_angle_counts_as_it_is_seen_along_the_normal() {
        // A unit cube turned about its lowest edge, y = z = 0, by the angle of sine 100/2501 and cosine 2499/2501: seen from
        // above its lowest face is that much narrower.
        let (cosine, sine) = (fraction(2499, 2501), fraction(100, 2501));
        let cube = turned(&Block::cuboid(&at([0, 0, 0]), &at([1, 1, 1])).unwrap(), 0, [&cosine, &sine]);
        let contacts = on_top(&[0, 1]);
        let little = fraction(1, 1_000_000_000_000);
        for (limit, counts) in [(sine.clone(), true), (&sine + &little, true), (&sine - &little, false)] {
            let share = if counts { &cosine * whole(18) } else { whole(0) };
            let found = shares([&slab(), &cube], &contacts, &Number::from_rational(limit)).unwrap();
            assert_eq!(found, [share.clone(), share], "{counts}");
        }
    }

    #[test]
    fn the_face_that_a_contact_joins_is_the_squarest_whatever_its_size() {
        // A frustum on its base of 4 by 4: its sides are larger, and face away from the slab.
        let base = [[0, -2, 0], [4, -2, 0], [4, 2, 0], [0, 2, 0]];
        let top = [[1, -1, 10], [3, -1, 10], [3, 1, 10], [1, 1, 10]];
        let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let faces = faces.map(|face: [u32; 4]| face.to_vec()).to_vec();
        let vertices = base.into_iter().chain(top).map(at).collect();
        let frustum = Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).unwrap();
        let slab = Block::cuboid(&at([-1, -3, -1]), &at([5, 3, 0])).unwrap();
        // 16 times twice the area of the slab's top, 72, for four contacts.
        let found = shares([&slab, &frustum], &on_top(&[0, 1, 2, 3]), &Number::ZERO).unwrap();
        assert_eq!(found, [(); 4].map(|()| whole(288)));
    }

    #[test]
    fn cosines_compare_by_the_angle_alone() {
        let vector = |x: i32, y: i32, z: i32| Vec3::new(BigInt::from(x), BigInt::from(y), BigInt::from(z));
        let compared = |one: (i32, IntVector), two: (i32, IntVector)| {
            let forwards = by_cosine((&one.0.into(), &one.1), (&two.0.into(), &two.1));
            assert_eq!(by_cosine((&two.0.into(), &two.1), (&one.0.into(), &one.1)), forwards.reverse());
            forwards
        };
        // 1 and 3/5, 3/5 and 1/√3, −1/√2 and 1/10√3, −3/5 and −4/5, 3/5 and 3/5.
        assert_eq!(compared((2, vector(0, 0, 2)), (30, vector(0, 30, 40))), Ordering::Greater);
        assert_eq!(compared((30, vector(0, 30, 40)), (1, vector(1, 1, 1))), Ordering::Greater);
        assert_eq!(compared((-30, vector(0, 30, -30)), (1, vector(10, 10, 10))), Ordering::Less);
        assert_eq!(compared((-30, vector(0, 40, -30)), (-4, vector(0, 3, -4))), Ordering::Greater);
        assert_eq!(compared((3, vector(0, 4, 3)), (30, vector(40, 0, 30))), Ordering::Equal);
    }
}
