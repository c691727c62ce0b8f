//! Which blocks of a scene show an intrusion: the stepper alone makes the step again, of some of the blocks, and the pair is looked at.

#[cfg(test)]
mod tests;

use crate::lockstep::cutout::cutout;
use crate::lockstep::intrusion::Intrusions;
use crate::lockstep::intrusion_case::{FoundIntrusion, MAX_BLOCKS};
use crate::lockstep::scene::ExactScene;
use crate::lockstep::state::exact_state;
use rockproof_model::{Motion, Precision, Scene, ToleranceSet};
use rockproof_oracle::audit::rounding_depth;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Dynamics, Solve, State};

/// A step in which there is an intrusion.
pub(super) struct ShowingStep<'s, R> {
    pub(super) scene: &'s Scene,
    pub(super) set: &'s ToleranceSet,
    pub(super) precision: Precision,
    /// The state before it.
    pub(super) state: &'s State<R>,
    pub(super) found: FoundIntrusion,
}

/// So many times blocks are left out to see whether the others still show an intrusion.
const MAX_TRIES: usize = 100;

impl<R: Solve> ShowingStep<'_, R> {
    /// Parts of the scene around the pair, each with all of the one before: the pair, the blocks within one contact, two, three and so on,
    /// the whole scene. Each by distance in contacts, then by number. Up to [`MAX_BLOCKS`] they grow by one contact at a time; beyond, each
    /// reaches twice as far as the one before. What is beside the pair is found out when the pair alone is not enough.
    pub(super) fn parts(&self) -> impl Iterator<Item = Vec<usize>> {
        let beyond = std::iter::once_with(|| self.parts_beyond_the_pair()).flatten();
        std::iter::once(self.found.blocks.to_vec()).chain(beyond)
    }

    fn parts_beyond_the_pair(&self) -> Vec<Vec<usize>> {
        let (order, rings) = self.by_distance();
        let (mut parts, mut contacts) = (Vec::new(), 1);
        let mut largest = self.found.blocks.len();
        while let Some(&size) = rings.get(contacts) {
            parts.push(order[..size].to_vec());
            largest = size;
            contacts = if size <= MAX_BLOCKS { contacts + 1 } else { 2 * contacts };
        }
        if largest < order.len() {
            parts.push(order);
        }
        parts
    }

    /// All blocks by distance in contacts from the pair, those that none joins to it last; and how many are within no contact, one, two, …
    /// Fixed blocks are reached, but what touches one of them is not near one another by that: they transmit nothing.
    fn by_distance(&self) -> (Vec<usize>, Vec<usize>) {
        let blocks = &self.scene.blocks;
        let mut beside = vec![Vec::new(); blocks.len()];
        // Contacts that the step itself found count as well.
        let after = self.stepped(self.scene, self.state);
        for contact in self.state.contacts.iter().chain(after.iter().flat_map(|after| &after.contacts)) {
            let [a, b] = contact.blocks.map(|block| block as usize);
            beside[a].push(b);
            beside[b].push(a);
        }
        let mut order = self.found.blocks.to_vec();
        let mut is_reached = vec![false; blocks.len()];
        order.iter().for_each(|&block| is_reached[block] = true);
        let (mut rings, mut begin) = (vec![order.len()], 0);
        loop {
            let last = begin..order.len();
            begin = last.end;
            let moving = order[last].iter().filter(|&&block| blocks[block].body.motion != Motion::Fixed);
            let mut next: Vec<usize> = moving.flat_map(|&block| &beside[block]).copied().collect();
            next.sort_unstable();
            next.dedup();
            next.retain(|&block| !std::mem::replace(&mut is_reached[block], true));
            if next.is_empty() {
                break;
            }
            order.extend(next);
            rings.push(order.len());
        }
        order.extend((0..blocks.len()).filter(|&block| !is_reached[block]));
        (order, rings)
    }

    /// Whether the stepper does it again with some blocks alone, the pair among them.
    pub(super) fn is_shown_by(&self, blocks: &[usize]) -> bool {
        let mut blocks = blocks.to_vec();
        blocks.sort_unstable();
        let (part, before) = cutout(self.scene, self.state, &blocks);
        let shown = self.stepped(&part, &before).and_then(|after| {
            let places = self.found.blocks.map(|block| blocks.partition_point(|&other| other < block));
            let (pair, before) = cutout(&part, &before, &places);
            let (_, after) = cutout(&part, &after, &places);
            let exactly = ExactScene::new(&pair, self.set).rounded(self.precision).ok()?;
            let (before, after) = (exact_state(&before).ok()?, exact_state(&after).ok()?);
            let begins = exactly.blocks_at(&before);
            let rounding = rounding_depth(&begins.iter().collect::<Vec<_>>(), self.precision);
            let all = Intrusions::of(&exactly, &before, &after, &rounding);
            Some(self.found.is_again(all.between(self.found.kind, [0, 1])?.depth))
        });
        shown == Some(true)
    }

    /// The state after the stepper's step of a part of the scene, if it can make one.
    fn stepped(&self, part: &Scene, before: &State<R>) -> Option<State<R>> {
        let mut dynamics = Dynamics::<R, SpecRules>::with_rules(part, self.set).ok()?;
        dynamics.restore(before.clone()).ok()?;
        dynamics.step().ok()?;
        Some(dynamics.state().clone())
    }

    /// Of blocks that show it as many as do so too, until there are `enough` or [`MAX_TRIES`] are made: halves are left out, quarters and so on,
    /// the last ones first. The pair comes first and stays.
    pub(super) fn with_fewer(&self, mut blocks: Vec<usize>, enough: usize) -> Vec<usize> {
        let pair = self.found.blocks.len();
        let (mut many, mut tries) = (blocks.len() / 2, 0);
        while many > 0 {
            let mut end = blocks.len();
            while end > pair {
                if blocks.len() <= enough || tries == MAX_TRIES {
                    return blocks;
                }
                tries += 1;
                let begin = end.saturating_sub(many).max(pair);
                let fewer = [&blocks[..begin], &blocks[end..]].concat();
                if self.is_shown_by(&fewer) {
                    blocks = fewer;
                }
                end = begin;
            }
            many /= 2;
        }
        blocks
    }
}
