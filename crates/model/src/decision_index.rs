//! Where decisions stand in a list of them, found without a comparison of all.

use crate::decision::Decision;

/// An index of a list of decisions, each of them once. The list itself is elsewhere: whoever asks says what stands at a place of it. Places are
/// below 2³² − 1.
#[derive(Clone, Debug)]
pub struct DecisionIndex {
    /// Half of a decision's hash above its place, counted from 1; 0 where there is none. A power of two of them, at least one empty.
    slots: Vec<u64>,
    len: usize,
}

impl DecisionIndex {
    /// An empty index with room for so many decisions before it grows.
    pub fn with_room(decisions: usize) -> DecisionIndex {
        DecisionIndex { slots: vec![0; (2 * decisions).next_power_of_two().max(8)], len: 0 }
    }

    /// The place of a decision.
    #[inline]
    pub fn find<'d>(&self, decision: &Decision, at: impl Fn(usize) -> &'d Decision) -> Option<usize> {
        self.slot(decision, at).ok()
    }

    /// Adds a decision that is to be found at a place, unless it is at another already: then that is the answer.
    #[inline]
    pub fn add<'d>(&mut self, decision: &Decision, place: usize, at: impl Fn(usize) -> &'d Decision) -> Option<usize> {
        let (slot, hash) = match self.slot(decision, at) {
            Ok(known) => return Some(known),
            Err(empty) => empty,
        };
        self.len += 1;
        self.slots[slot] = hash << 32 | (place as u64 + 1);
        if 2 * self.len > self.slots.len() {
            self.grow();
        }
        None
    }

    /// The place of a decision, or the slot where it is to go with the lower half of its hash.
    #[inline]
    fn slot<'d>(&self, decision: &Decision, at: impl Fn(usize) -> &'d Decision) -> Result<usize, (usize, u64)> {
        let hash = decision.hash_bits() & u64::from(u32::MAX);
        let last = self.slots.len() - 1;
        let mut slot = hash as usize & last;
        loop {
            let held = self.slots[slot];
            if held == 0 {
                return Err((slot, hash));
            }
            let place = (held & u64::from(u32::MAX)) as usize - 1;
            if held >> 32 == hash && at(place) == decision {
                return Ok(place);
            }
            slot = (slot + 1) & last;
        }
    }

    fn grow(&mut self) {
        let larger = vec![0; 2 * self.slots.len()];
        let slots = std::mem::replace(&mut self.slots, larger);
        let last = self.slots.len() - 1;
        for held in slots.into_iter().filter(|held| *held != 0) {
            let mut slot = (held >> 32) as usize & last;
            while self.slots[slot] != 0 {
                slot = (slot + 1) & last;
            }
            self.slots[slot] = held;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decision::{Feature, LARGEST, Predicate, Side};
    use crate::topology::{EdgeId, FaceId, VertexId};

    /// Decisions of all predicates about few features, many of them alike but for one part, and some about features of large numbers.
    fn decisions() -> Vec<Decision> {
        let number = |k: u32| if k.is_multiple_of(7) { LARGEST - k } else { k };
        let features = |k: u32| {
            let side = if k.is_multiple_of(2) { Side::A } else { Side::B };
            [
                Feature::Vertex(side, VertexId(number(k / 2))),
                Feature::Edge(side, EdgeId(number(k / 2))),
                Feature::Face(side, FaceId(number(k / 2))),
            ]
        };
        let mut all = Vec::new();
        for predicate in Predicate::ALL {
            all.push(Decision::about(predicate, &[]));
            for k in 0..12 {
                for one in features(k) {
                    all.push(Decision::about(predicate, &[one]));
                    for other in features(k / 3 + 5) {
                        all.push(Decision::about(predicate, &[one, other]));
                        all.push(Decision::about(predicate, &[one, other, one, other]));
                        all.push(Decision::about(predicate, &[other, other, other, one]));
                    }
                }
            }
        }
        all
    }

    /// What a decision was asked of comes back, and decisions order as their features do.
    #[test]
    fn features_are_kept_in_words() {
        let (all, plain) = (decisions(), |decision: &Decision| (decision.predicate, decision.features()));
        for (decision, other) in all.iter().zip(all.iter().cycle().skip(17)) {
            let features: Vec<Feature> = decision.features().into_iter().flatten().collect();
            assert_eq!(Decision::about(decision.predicate, &features), *decision);
            assert_eq!(decision.cmp(other), plain(decision).cmp(&plain(other)));
        }
        let [one, two] = [LARGEST, LARGEST - 1].map(|number| Feature::Face(Side::B, FaceId(number)));
        let about = |features: &[Feature]| Decision::about(Predicate::OneExit, features);
        assert_eq!(about(&[one, two]).features(), [Some(one), Some(two), None, None]);
        assert_ne!(about(&[one]), about(&[two]));
        assert_eq!(about(&[one]), about(&[Feature::Face(Side::B, FaceId(u32::MAX))]));
    }

    #[test]
    fn each_decision_is_found_where_it_came_first() {
        let all = decisions();
        for room in [0, 100, all.len()] {
            let mut index = DecisionIndex::with_room(room);
            let mut list: Vec<Decision> = Vec::new();
            for decision in all.iter().chain(all.iter().rev()) {
                let plain = list.iter().position(|known| known == decision);
                assert_eq!(index.find(decision, |place| &list[place]), plain);
                assert_eq!(index.add(decision, list.len(), |place| &list[place]), plain);
                if plain.is_none() {
                    list.push(*decision);
                }
            }
        }
    }

    /// Should all hash alike, nothing would be wrong but slow.
    #[test]
    fn few_decisions_share_a_hash() {
        let mut all = decisions();
        all.sort_unstable();
        all.dedup();
        let mut hashes: Vec<u64> = all.iter().map(|decision| decision.hash_bits() & u64::from(u32::MAX)).collect();
        hashes.sort_unstable();
        hashes.dedup();
        assert!(hashes.len() + 4 > all.len(), "{} hashes of {} decisions", hashes.len(), all.len());
    }
}
