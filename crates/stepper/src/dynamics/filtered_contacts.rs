//! The contacts of a step in 512 bits, found in f64 wherever that settles a comparison ([`crate::lazy_wide`]).

use crate::contact::{PreparedBlock, Tolerances, classify_with_kept};
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
    /// unsettled in finding them. `None` where the state is not one of f64, as a step in 512 bits leaves it, or where there is too much to note.
    pub fn filtered_contacts(&mut self, set: &ToleranceSet) -> Option<(BlockContacts, u64)> {
        let is_f64 = |v: &Vector<Wide>| v.components().into_iter().all(Wide::is_f64);
        if !self.state.blocks.iter().flat_map(|block| &block.vertices).all(is_f64) {
            return None;
        }
        let fixed: Vec<bool> = (0..self.prepared.len()).map(|block| self.is_fixed(block)).collect();
        let pairs = self.neighbours.pairs(&self.prepared, &fixed, &self.setup.tolerances).0.to_vec();
        let (contacts, unsettled) = noted(|| count_unsettled(|| self.contacts_of::<LazyWide>(&pairs, set)))?;
        Some((contacts?, unsettled))
    }

    /// The contacts of these pairs, where the blocks are, in another scalar.
    fn contacts_of<R: Real>(&self, pairs: &[[u32; 2]], set: &ToleranceSet) -> Option<BlockContacts> {
        let tolerances = Tolerances::<R>::new(set).ok()?;
        let prepare = |(block, state): (_, &crate::dynamics::BlockState<Wide>)| {
            let scalar = |v: &Vector<Wide>| {
                let [x, y, z] = v.components().map(|value| R::from_f64(value.nearest_f64()));
                Vector::new(x, y, z)
            };
            let points: Vec<Vector<R>> = state.vertices.iter().map(scalar).collect();
            PreparedBlock::unprepared(Clone::clone(block)).with_points(&points).ok()
        };
        let prepared: Vec<PreparedBlock<R>> =
            self.setup.blocks.iter().zip(&self.state.blocks).map(prepare).collect::<Option<_>>()?;
        let mut contacts = Vec::with_capacity(self.state.contacts.len());
        for &pair in pairs {
            let [a, b] = pair.map(|block| &prepared[block as usize]);
            let old = &self.state.contacts[transfer::of_pair(&self.state.contacts, pair)];
            let kept: Vec<ContactKey> = old.iter().filter(|c| M::leaves_kept(c.mode)).map(|c| c.contact.key).collect();
            let found = classify_with_kept::<R, M>(a, b, &tolerances, &kept);
            contacts.extend(found.into_iter().map(|found| (pair, found.contact)));
        }
        Some(contacts)
    }
}
