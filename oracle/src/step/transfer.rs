//! Which contacts go on from the step before (SPEC 5.4 to 5.6).

use super::state::{ContactMemory, ContactsByPair, Mode};
use rockproof_model::{Contact, EntranceKind, Point};

/// A contact of the step, with the mode it begins with and the anchors it keeps.
#[derive(Clone, Debug)]
pub(crate) struct StartingContact {
    pub(crate) blocks: [usize; 2],
    pub(crate) contact: Contact,
    pub(crate) mode: Mode,
    /// `None` for a contact that begins, or is open when the step begins: it is anchored where it is.
    pub(crate) anchors: Option<[Point; 2]>,
}

impl StartingContact {
    /// The side of block j, whose anchor is dragged: B but for f-v entrances (SPEC 5.3).
    pub(crate) fn other_side(&self) -> usize {
        usize::from(self.contact.entrance.kind() != EntranceKind::FaceVertex)
    }
}

/// Gives each contact its memory. `found` is ordered by pair and as SPEC sorts contacts.
pub(crate) fn transfer(found: &[([usize; 2], Contact)], old: &[ContactMemory]) -> Vec<StartingContact> {
    let by_pair = ContactsByPair::new(old);
    let mut taken = vec![false; old.len()];
    let mut from: Vec<Option<usize>> = vec![None; found.len()];
    let same_features = |one: &Contact, two: &Contact| one.key == two.key;
    let same_entrance = |one: &Contact, two: &Contact| one.entrance == two.entrance;
    let rules: [fn(&Contact, &Contact) -> bool; 2] = [same_features, same_entrance];
    for same in rules {
        for (place, (blocks, contact)) in from.iter_mut().zip(found) {
            if place.is_some() {
                continue;
            }
            let free = |&k: &usize| !taken[k] && same(contact, &old[k].contact);
            *place = by_pair.of(*blocks).find(free);
            if let Some(k) = *place {
                taken[k] = true;
            }
        }
    }
    let start = |((blocks, contact), from): (&([usize; 2], Contact), Option<usize>)| {
        let (mode, anchors) = match from.map(|k| &old[k]) {
            Some(memory) if memory.mode == Mode::Open => (Mode::Open, None),
            Some(memory) => (memory.mode, Some(memory.anchors.clone())),
            None if contact.gap.is_at_most_zero() => (Mode::Locked, None),
            None => (Mode::Open, None),
        };
        StartingContact { blocks: *blocks, contact: *contact, mode, anchors }
    };
    found.iter().zip(from).map(start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{ContactKey, ContactKind, Entrance, Number, Sign, Vec3};

    /// A contact of a vertex with a face through an entrance that need not be theirs.
    fn contact(vertex: u32, entrance: u32, gap: Sign) -> Contact {
        Contact {
            key: ContactKey::of_kind(ContactKind::VertexFace, [vertex, 0]),
            entrance: Entrance::of_kind(EntranceKind::VertexFace, [entrance, 0]),
            gap,
        }
    }

    fn anchors(at: i32) -> [Point; 2] {
        [at, at + 1].map(|x| Vec3::new(Number::from_integer(x), Number::ZERO, Number::ZERO))
    }

    fn memory(blocks: [usize; 2], contact: Contact, at: i32) -> ContactMemory {
        ContactMemory { blocks, contact, mode: Mode::Sliding, anchors: anchors(at) }
    }

    fn started(found: &[([usize; 2], Contact)], old: &[ContactMemory]) -> Vec<(Mode, Option<[Point; 2]>)> {
        transfer(found, old).into_iter().map(|contact| (contact.mode, contact.anchors)).collect()
    }

    #[test]
    fn a_contact_of_another_pair_has_no_memory() {
        let apart = contact(1, 1, Sign::Positive);
        let old = [memory([0, 1], apart, 0)];
        assert_eq!(started(&[([0, 2], apart)], &old), [(Mode::Open, None)]);
        let touching = contact(1, 1, Sign::Zero);
        assert_eq!(started(&[([0, 2], touching)], &old), [(Mode::Locked, None)]);
        assert_eq!(started(&[([0, 1], apart)], &old), [(Mode::Sliding, Some(anchors(0)))]);
    }

    #[test]
    fn contacts_of_a_pair_are_found_wherever_they_stand() {
        let touching = contact(1, 1, Sign::Zero);
        let open = |blocks| ContactMemory { mode: Mode::Open, ..memory(blocks, touching, 0) };
        let pairs = [[0, 2], [0, 1], [1, 2], [0, 1], [0, 2], [0, 1]];
        let mut old = pairs.map(|blocks| memory(blocks, touching, 0));
        old[3] = open([0, 1]);
        old[4] = open([0, 2]);
        let by_pair = ContactsByPair::new(&old);
        for (pair, places, kept) in [
            ([0, 1], vec![1, 3, 5], 2),
            ([0, 2], vec![0, 4], 1),
            ([1, 2], vec![2], 1),
            ([0, 3], vec![], 0),
            ([2, 3], vec![], 0),
        ] {
            assert_eq!(by_pair.of(pair).collect::<Vec<_>>(), places, "{pair:?}");
            assert_eq!(by_pair.kept(pair), vec![touching.key; kept], "{pair:?}");
        }
    }

    #[test]
    fn no_contact_is_continued_twice() {
        // Both have the entrance of the old one, which the first continues by its features.
        let (same, other) = (contact(1, 7, Sign::Positive), contact(2, 7, Sign::Positive));
        let old = [memory([0, 1], same, 0)];
        let (continued, begun) = ((Mode::Sliding, Some(anchors(0))), (Mode::Open, None));
        assert_eq!(started(&[([0, 1], same), ([0, 1], other)], &old), [continued.clone(), begun.clone()]);
        assert_eq!(started(&[([0, 1], other), ([0, 1], same)], &old), [begun, continued]);
    }

    #[test]
    fn features_go_before_entrances_and_the_first_memory_before_later_ones() {
        let old = [memory([0, 1], contact(1, 7, Sign::Zero), 0), memory([0, 1], contact(2, 7, Sign::Zero), 10)];
        // Vertex 3 is new; its entrance is that of both, of which vertex 2 is still there and continues its own.
        let found = [([0, 1], contact(2, 7, Sign::Zero)), ([0, 1], contact(3, 7, Sign::Zero))];
        assert_eq!(started(&found, &old), [10, 0].map(|at| (Mode::Sliding, Some(anchors(at)))));
        // Both are new: they continue the old ones in order.
        let found = [([0, 1], contact(4, 7, Sign::Zero)), ([0, 1], contact(5, 7, Sign::Zero))];
        assert_eq!(started(&found, &old), [0, 10].map(|at| (Mode::Sliding, Some(anchors(at)))));
    }
}
