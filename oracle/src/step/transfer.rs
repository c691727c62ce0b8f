//! Which contacts go on from the step before (SPEC 5.4 to 5.6).

use super::state::{ContactMemory, Mode};
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
            let free = |&k: &usize| !taken[k] && old[k].blocks == *blocks && same(contact, &old[k].contact);
            *place = (0..old.len()).find(free);
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
