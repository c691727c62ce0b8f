//! The contacts of a step in 512 bits, found in f64 wherever that settles a comparison ([`crate::lazy_wide`]).

use crate::contact::{PreparedBlock, Tolerances, classify_with_kept};
use crate::dynamics::solve::Solve;
use crate::dynamics::step::Dynamics;
use crate::dynamics::step_rules::StepRules;
use crate::dynamics::transfer;
use crate::lazy_wide::{LazyWide, noted};
use crate::real::Real;
use crate::vector::Vector;
use crate::wide::{Wide, count_unsettled};
use rockproof_model::{Contact, ContactKey, ToleranceSet};

/// Contacts with their blocks, by pair and in SPEC order.
pub type BlockContacts = Vec<([u32; 2], Contact)>;

impl<M: StepRules> Dynamics<Wide, M> {
    /// The contacts that the next step finds in 512 bits by these tolerances, which are the scene's, and the number of comparisons that these leave
    /// unsettled in finding them. `None` where the state is not one of f64, as a step in 512 bits leaves it, or where there is too much to note of a pair.
    pub fn filtered_contacts(&mut self, set: &ToleranceSet) -> Option<(BlockContacts, u64)> {
        let is_f64 = |v: &Vector<Wide>| v.components().into_iter().all(Wide::is_f64);
        if !self.state.blocks.iter().flat_map(|block| &block.vertices).all(is_f64) {
            return None;
        }
        let pairs = self.neighbouring_pairs();
        let (found, unsettled) = self.contacts_in_wide(&pairs, set)?;
        let found = pairs.iter().zip(found);
        let contacts = found.flat_map(|(&pair, contacts)| contacts.into_iter().map(move |contact| (pair, contact)));
        Some((contacts.collect(), unsettled))
    }
}

impl<S: Solve, M: StepRules> Dynamics<S, M> {
    /// All pairs of blocks that may be neighbours.
    pub(super) fn neighbouring_pairs(&mut self) -> Vec<[u32; 2]> {
        let fixed: Vec<bool> = (0..self.prepared.len()).map(|block| self.is_fixed(block)).collect();
        self.neighbours.pairs(&self.prepared, &fixed, &self.setup.tolerances).0.to_vec()
    }

    /// The contacts of a pair that the step before left closed.
    pub(super) fn kept_contacts(&self, pair: [u32; 2]) -> Vec<ContactKey> {
        let old = &self.state.contacts[transfer::of_pair(&self.state.contacts, pair)];
        old.iter().filter(|c| M::leaves_kept(c.mode)).map(|c| c.contact.key).collect()
    }

    /// The contacts of each of these pairs in 512 bits, of a state of f64, and the number of comparisons that these leave unsettled in finding them: those
    /// about a block alone count once for each part in which the pairs are looked at. `None` where there is too much to note of one pair.
    pub(super) fn contacts_in_wide(&self, pairs: &[[u32; 2]], set: &ToleranceSet) -> Option<(Vec<Vec<Contact>>, u64)> {
        let part = |part: &[[u32; 2]]| noted(|| count_unsettled(|| self.contacts_of::<LazyWide>(part, set)));
        let (mut contacts, mut unsettled) = (Vec::with_capacity(pairs.len()), 0);
        for (found, besides) in in_parts(pairs, part)? {
            contacts.extend(found?);
            unsettled += besides;
        }
        Some((contacts, unsettled))
    }

    /// The contacts of each of these pairs, where the blocks are, in another scalar.
    fn contacts_of<R: Real>(&self, pairs: &[[u32; 2]], set: &ToleranceSet) -> Option<Vec<Vec<Contact>>> {
        let tolerances = Tolerances::<R>::new(set).ok()?;
        let mut prepared: Vec<Option<PreparedBlock<R>>> = vec![None; self.prepared.len()];
        for block in pairs.iter().flatten().map(|&block| block as usize) {
            if prepared[block].is_none() {
                let scalar = |v: &Vector<S>| {
                    let [x, y, z] = v.components().map(|value| R::from_f64(value.to_f64()));
                    Vector::new(x, y, z)
                };
                let points: Vec<Vector<R>> = self.state.blocks[block].vertices.iter().map(scalar).collect();
                let unprepared = PreparedBlock::unprepared(self.setup.blocks[block].clone());
                prepared[block] = Some(unprepared.with_points(&points).ok()?);
            }
        }
        let mut contacts = Vec::with_capacity(pairs.len());
        for &pair in pairs {
            let [Some(a), Some(b)] = pair.map(|block| prepared[block as usize].as_ref()) else { continue };
            let found = classify_with_kept::<R, M>(a, b, &tolerances, &self.kept_contacts(pair));
            contacts.push(found.into_iter().map(|found| found.contact).collect());
        }
        Some(contacts)
    }
}

/// What `work` gives for all of a list, part by part: half as long ones, from then on, where it gives nothing for a part. `None` where it gives nothing for a
/// single one.
fn in_parts<P, T>(all: &[P], mut work: impl FnMut(&[P]) -> Option<T>) -> Option<Vec<T>> {
    let (mut rest, mut longest, mut done) = (all, all.len(), Vec::new());
    while !rest.is_empty() {
        let (part, later) = rest.split_at(longest.min(rest.len()));
        match work(part) {
            Some(found) => {
                done.push(found);
                rest = later;
            }
            None if part.len() == 1 => return None,
            None => longest = part.len() / 2,
        }
    }
    Some(done)
}

#[cfg(test)]
mod tests {
    use super::in_parts;

    #[test]
    fn a_part_that_is_too_long_is_halved_and_nothing_is_lost() {
        let all: Vec<u32> = (0..21).collect();
        for (most, lengths) in [(21, vec![21]), (20, vec![10, 10, 1]), (5, vec![5, 5, 5, 5, 1]), (1, vec![1; 21])] {
            let mut asked = 0;
            let work = |part: &[u32]| {
                asked += 1;
                (part.len() <= most).then(|| part.to_vec())
            };
            let parts = in_parts(&all, work).expect("single ones are short enough");
            assert_eq!(parts.iter().map(Vec::len).collect::<Vec<_>>(), lengths);
            assert_eq!(parts.concat(), all);
            // Once too long is enough for each length.
            assert!(asked <= lengths.len() + 4, "{asked} for parts of {lengths:?}");
        }
        assert_eq!(in_parts(&all, |part| (!part.contains(&17)).then_some(())), None);
        assert_eq!(in_parts(&[0u32; 0], |_| None::<()>), Some(Vec::new()));
    }
}
