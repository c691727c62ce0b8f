//! Which overlapping contacts stay: the shortest exit of test 3 and the one exit of test 5 (SPEC section 4).

use super::entrance::{first_of_the_largest, true_exits_or_all};
use super::pair::{ContactWithPlane, Pair};
use super::predicate_answer::PredicateAnswer;
use super::vector::{cross, dot, squared_length};
use super::vertex_face::vertex_and_face;
use crate::rational::Rational;
use rockproof_model::FaceId;
use rockproof_model::decision::{Predicate, Side};

/// **Shortest exit**, unless both blocks are convex: of the faces that one vertex of `side` overlaps and that convex
/// edges join (one after another, within that set), only the one with the largest gap stays; ties by Eq. (1), then the
/// lower face.
pub(super) fn shortest<Q: Rational>(
    pair: &Pair<'_, Q>,
    side: Side,
    contacts: Vec<ContactWithPlane<Q>>,
) -> Vec<ContactWithPlane<Q>> {
    if pair.a.block.is_convex() && pair.b.block.is_convex() {
        return contacts;
    }
    let overlaps = |contact: &ContactWithPlane<Q>| contact.plane.gap_sign().is_negative();
    let mut dropped = vec![false; contacts.len()];
    for vertex in pair.side(side).block.topology().vertex_ids() {
        // By face, ascending, so that the first of a group is its lowest face.
        let mut left: Vec<(FaceId, usize)> = contacts
            .iter()
            .enumerate()
            .filter(|(_, contact)| overlaps(contact))
            .filter_map(|(k, contact)| Some((contact.key.vertex_and_face()?, k)))
            .filter_map(|((own, face), k)| (own == vertex).then_some((face, k)))
            .collect();
        left.sort_unstable();
        while !left.is_empty() {
            let group = take_group(pair, side, &mut left);
            let planes: Vec<_> = group.iter().map(|&(_, k)| contacts[k].plane.clone()).collect();
            let Some(choice) = first_of_the_largest(&planes, &pair.limits.equal) else { continue };
            if group.len() == 1 {
                continue;
            }
            for (place, &(face, k)) in group.iter().enumerate() {
                let verdict = PredicateAnswer { yes: place == choice.index, tie: choice.ties[place] };
                let features = vertex_and_face(side, vertex, face);
                dropped[k] = !pair.decide(Predicate::ShortestExit, &features, verdict);
            }
        }
    }
    contacts.into_iter().zip(dropped).filter(|(_, dropped)| !dropped).map(|(contact, _)| contact).collect()
}

/// Takes from `left` the first entry and all whose faces convex edges join to its face, in their order.
fn take_group<Q: Rational>(pair: &Pair<'_, Q>, side: Side, left: &mut Vec<(FaceId, usize)>) -> Vec<(FaceId, usize)> {
    let block = pair.side(side.other()).block;
    let joined = |f: FaceId, g: FaceId| {
        block.topology().face_edges(f).iter().any(|&e| {
            let edge = block.topology().edge(e);
            block.edge_is_convex(e) && [edge.left, edge.right].contains(&g)
        })
    };
    let mut group = vec![left.remove(0)];
    while let Some(next) = left.iter().position(|&(f, _)| group.iter().any(|&(g, _)| joined(g, f))) {
        group.push(left.remove(next));
    }
    group.sort_unstable();
    group
}

/// **One exit**, for two convex blocks: with n* the normal of the contact with the largest gap among those whose entrance
/// is a true exit, or among all if none is (ties by Eq. (1), to the first in sorted order), a contact with h < 0 stays only
/// if `n·n* > 0` and `|n × n*|² ≤ so²·|n|²·|n*|²`. Expects the contacts sorted.
pub(super) fn one_exit<Q: Rational>(
    pair: &Pair<'_, Q>,
    contacts: Vec<ContactWithPlane<Q>>,
) -> Vec<ContactWithPlane<Q>> {
    if !pair.a.block.is_convex() || !pair.b.block.is_convex() {
        return contacts;
    }
    if !contacts.iter().any(|contact| contact.plane.gap_sign().is_negative()) {
        return contacts;
    }
    let all: Vec<_> = contacts.iter().map(|contact| contact.plane.clone()).collect();
    let preferred = true_exits_or_all(pair, &all);
    let places: Vec<usize> = (0..all.len()).filter(|&k| preferred[k]).collect();
    let planes: Vec<_> = places.iter().map(|&k| all[k].clone()).collect();
    let Some(choice) = first_of_the_largest(&planes, &pair.limits.equal) else { return contacts };
    let star = &planes[choice.index].normal;
    let within_overlap_angle = |contact: &ContactWithPlane<Q>| {
        let n = &contact.plane.normal;
        let limit = pair.limits.overlap_squared.times(&squared_length(n)).times(&squared_length(star));
        PredicateAnswer::above_zero(&dot(n, star))
            .and(|| PredicateAnswer::at_most(&squared_length(&cross(n, star)), &limit))
            .tied_if(choice.is_tied())
    };
    contacts
        .into_iter()
        .enumerate()
        .filter(|(k, contact)| {
            *k == places[choice.index]
                || !contact.plane.gap_sign().is_negative()
                || pair.decide(Predicate::OneExit, &contact.key.features(), within_overlap_angle(contact))
        })
        .map(|(_, contact)| contact)
        .collect()
}
