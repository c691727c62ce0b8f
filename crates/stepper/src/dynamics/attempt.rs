//! The open–close iteration of one attempt at a step, with one Δt (SPEC section 5).

use crate::dynamics::contact::Active;
use crate::dynamics::displacement::Twelve;
use crate::dynamics::island::{Alone, Kept, Unsolved, Work, islands};
use crate::dynamics::layout::Layouts;
use crate::dynamics::report::{Concerned, Spent};
use crate::dynamics::rules::StepRules;
use crate::dynamics::setup::Limits;
use crate::dynamics::solve::Solve;
use crate::dynamics::state::Mode;
use std::collections::HashMap;
use std::time::Instant;

/// What an iteration needs to know besides the contacts.
pub(super) struct Iteration<'s, R> {
    pub(super) alone: &'s [Alone<R>],
    pub(super) limits: &'s Limits<R>,
    pub(super) settling: bool,
    /// The modes of each solve and those after the last, where they are not to be judged.
    pub(super) given: Option<&'s [Vec<Mode>]>,
}

/// How an iteration ended.
#[derive(Clone, Debug)]
pub(super) struct Ended<R> {
    /// The displacement of every block.
    pub(super) d: Vec<Twelve<R>>,
    pub(super) iterations: u32,
    /// Contacts whose mode the last solve changed; none when converged.
    pub(super) changing: Vec<Concerned>,
    /// The modes of all contacts after each solve.
    pub(super) modes: Vec<Vec<Mode>>,
}

impl<R: Solve> Iteration<'_, R> {
    /// Solves and judges until no mode changes, or the solves are used up.
    pub(super) fn run<M: StepRules>(
        &self,
        contacts: &mut [Active<R>],
        layouts: &mut Layouts,
        spent: &mut Spent,
    ) -> Result<Ended<R>, Unsolved> {
        let unknowns: Vec<usize> = self.alone.iter().map(|block| block.unknowns).collect();
        let mut d = vec![[R::ZERO; 12]; unknowns.len()];
        // Blocks whose system is not the one solved before.
        let mut touched = vec![true; unknowns.len()];
        let mut ended = Ended { d: Vec::new(), iterations: 0, changing: Vec::new(), modes: Vec::new() };
        contacts.iter_mut().for_each(Active::reset);
        let given = |solve: u32, contact: usize| self.given?.get(solve as usize)?.get(contact).copied();
        for (k, contact) in contacts.iter_mut().enumerate() {
            contact.now.mode = given(0, k).unwrap_or(contact.now.mode);
        }
        // What solving the islands left, by their lowest block, and contacts whose mode is not that of the solve before.
        let mut kept: HashMap<usize, Kept<R>> = HashMap::new();
        let mut changed = vec![false; contacts.len()];
        let most = self.given.map_or(M::iterations(), |modes| (modes.len() as u32).saturating_sub(1));
        loop {
            let mut before = std::mem::take(&mut kept);
            for island in islands(&unknowns, contacts) {
                let lowest = island.lowest();
                let left = before.remove(&lowest);
                // The friction force of a sliding contact is that of the last solve, so its system is a new one.
                let slides = |k: &usize| contacts[*k].now.mode == Mode::Sliding;
                let touches = |block: &u32| touched[*block as usize];
                if !(island.ties.blocks.iter().any(touches) || island.contacts.iter().any(slides)) {
                    kept.extend(left.map(|left| (lowest, left)));
                    continue;
                }
                let mut work = Work { alone: self.alone, layouts, spent };
                let (solved, left) = island.solve(contacts, &changed, left, &mut work)?;
                kept.insert(lowest, left);
                for (&block, found) in island.ties.blocks.iter().zip(solved) {
                    d[block as usize] = found;
                }
            }
            drop(before);
            let begun = Instant::now();
            spent.solves += 1;
            ended.iterations += 1;
            ended.changing.clear();
            touched.fill(false);
            for (k, contact) in contacts.iter_mut().enumerate() {
                let [i, j] = contact.entering();
                let from = contact.now.mode;
                contact.judge::<M>([&d[i], &d[j]], self.limits, self.settling);
                if let Some(mode) = given(ended.iterations, k) {
                    contact.take::<M>(mode);
                }
                let to = contact.now.mode;
                changed[k] = from != to;
                if changed[k] {
                    (touched[i], touched[j]) = (true, true);
                }
                if M::counts_as_change(from, to) {
                    let (kind, features) = (contact.contact.kind, [contact.contact.a, contact.contact.b]);
                    ended.changing.push(Concerned { blocks: contact.blocks, kind, features, from, to });
                }
            }
            ended.modes.push(contacts.iter().map(|contact| contact.now.mode).collect());
            spent.judgement += begun.elapsed();
            let settled = ended.changing.is_empty() && self.given.is_none();
            if settled || ended.iterations >= most {
                ended.d = d;
                return Ok(ended);
            }
        }
    }
}
