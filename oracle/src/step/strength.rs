//! The areas on which cohesion and tensile strength act (SPEC 5.15), exactly: in integers, on the common lattice of both blocks.

use super::contact::Sides;
use crate::overlap::{Flat, common_area};
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
