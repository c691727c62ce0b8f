//! Which contact of this step continues which of the step before (SPEC section 5).

use crate::dynamics::state::{ContactState, Mode};
use crate::real::Real;
use crate::vector::Vector;
use std::ops::Range;

/// What a contact takes over: mode and the anchors of A and B.
pub(super) type TransferredState<R> = (Mode, [Vector<R>; 2]);

/// The old contacts of one pair of blocks: a part of all, which are sorted by pair.
pub(super) fn of_pair<R>(old: &[ContactState<R>], pair: [u32; 2]) -> Range<usize> {
    old.partition_point(|c| c.blocks < pair)..old.partition_point(|c| c.blocks <= pair)
}

/// For each new contact of a pair, given by features and entrance, the old one it continues: first by kind and features, then
/// by entrance, each old one at most once.
pub(super) fn continued<R: Real>(
    new: &[rockproof_model::Contact],
    old: &[ContactState<R>],
) -> Vec<Option<TransferredState<R>>> {
    let memory = |place: usize| (old[place].mode, old[place].anchors);
    let mut taken = vec![false; old.len()];
    let mut found = vec![None; new.len()];
    for (contact, found) in new.iter().zip(&mut found) {
        let same = |c: &ContactState<R>| c.key() == contact.key;
        if let Some(place) = old.iter().position(same) {
            taken[place] = true;
            *found = Some(memory(place));
        }
    }
    for (contact, found) in new.iter().zip(&mut found).filter(|(_, found)| found.is_none()) {
        let free = old.iter().enumerate().position(|(k, c)| !taken[k] && c.entrance() == contact.entrance);
        if let Some(place) = free {
            taken[place] = true;
            *found = Some(memory(place));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{Contact, ContactKey, ContactKind, Entrance, FaceId, Sign, VertexId};

    fn contact(kind: ContactKind, a: u32, b: u32, face: u32) -> Contact {
        let entrance = Entrance::VertexFace(VertexId(7), FaceId(face));
        Contact { key: ContactKey::of_kind(kind, [a, b]), entrance, gap: Sign::Zero }
    }

    /// An old contact that is told by its anchors.
    fn old(blocks: [u32; 2], contact: Contact, number: f64) -> ContactState<f64> {
        let at = Vector::new(number, 0.0, 0.0);
        let (zero, mode) = (Vector::ZERO, Mode::Sliding);
        let (anchors, points) = ([at, at], [zero, zero]);
        ContactState { blocks, contact, mode, anchors, gap: 0.0, normal: zero, points, force: zero }
    }

    fn numbers(new: &[Contact], old: &[ContactState<f64>]) -> Vec<Option<f64>> {
        continued(new, old).into_iter().map(|memory| memory.map(|(_, anchors)| anchors[0].x)).collect()
    }

    #[test]
    fn the_same_features_come_first_whatever_the_entrance() {
        let before = [old([0, 1], contact(ContactKind::VertexVertex, 1, 1, 5), 1.0)];
        assert_eq!(numbers(&[contact(ContactKind::VertexVertex, 1, 1, 6)], &before), [Some(1.0)]);
        // Another kind continues it by the entrance only.
        assert_eq!(numbers(&[contact(ContactKind::VertexFace, 1, 5, 5)], &before), [Some(1.0)]);
        assert_eq!(numbers(&[contact(ContactKind::VertexFace, 1, 5, 6)], &before), [None]);
    }

    #[test]
    fn what_is_left_is_taken_in_order_and_once() {
        let before = [
            old([0, 1], contact(ContactKind::VertexVertex, 1, 1, 5), 1.0),
            old([0, 1], contact(ContactKind::VertexVertex, 2, 2, 5), 2.0),
            old([0, 1], contact(ContactKind::VertexEdge, 3, 3, 5), 3.0),
        ];
        // The last of the new ones has the features of the second old one, though the others come before it.
        let new = [
            contact(ContactKind::VertexFace, 1, 5, 5),
            contact(ContactKind::VertexFace, 2, 5, 5),
            contact(ContactKind::VertexFace, 3, 5, 5),
            contact(ContactKind::VertexVertex, 2, 2, 9),
        ];
        assert_eq!(numbers(&new, &before), [Some(1.0), Some(3.0), None, Some(2.0)]);
    }

    #[test]
    fn contacts_of_a_pair_are_found_among_all() {
        let of = |blocks| old(blocks, contact(ContactKind::VertexFace, 0, 0, 0), 0.0);
        let all = [of([0, 1]), of([0, 2]), of([0, 2]), of([1, 2])];
        assert_eq!([of_pair(&all, [0, 2]), of_pair(&all, [1, 2]), of_pair(&all, [1, 3])], [1..3, 3..4, 4..4]);
    }
}
