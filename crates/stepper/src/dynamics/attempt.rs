//! The open–close iteration of one attempt at a step, with one Δt (SPEC section 5).

use crate::dynamics::contact::StepContact;
use crate::dynamics::displacement::BlockVector;
use crate::dynamics::friction::FrictionMisfit;
use crate::dynamics::island::{BlockSystem, CachedFactor, FactorizationFailure, Memory, SolveContext, islands};
use crate::dynamics::layout::Layouts;
use crate::dynamics::report::{IterationTimes, ModeChange};
use crate::dynamics::setup::StepLimits;
use crate::dynamics::solve::Solve;
use crate::dynamics::state::Mode;
use crate::dynamics::step_rules::StepRules;
use crate::dynamics::system::CONTACTS_AT_ONCE;
use crate::dynamics::unchanged::UnchangedIslands;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::time::Instant;

/// What an iteration needs to know besides the contacts.
pub(super) struct OpenCloseIteration<'s, R> {
    pub(super) block_systems: &'s [BlockSystem<R>],
    pub(super) limits: &'s StepLimits<R>,
    pub(super) settling: bool,
    /// The modes of each solve and those after the last, where they are not to be judged.
    pub(super) prescribed: Option<&'s [Vec<Mode>]>,
    /// Islands of which the solution is known.
    pub(super) unchanged: Option<&'s UnchangedIslands<R>>,
}

/// How an iteration ended.
#[derive(Clone, Debug)]
pub(super) struct IterationResult<R> {
    /// The displacement of every block.
    pub(super) d: Vec<BlockVector<R>>,
    pub(super) iterations: u32,
    /// Whether the iteration ended by itself, not because modes went on changing.
    pub(super) converged: bool,
    /// See [`StepReport::friction_left`](crate::dynamics::report::StepReport::friction_left).
    pub(super) friction_left: f64,
    /// Contacts whose mode the last solve changed.
    pub(super) changing: Vec<ModeChange>,
    /// The modes of all contacts after each solve.
    pub(super) modes: Vec<Vec<Mode>>,
    /// Blocks of which a contact changed its mode, or slid.
    pub(super) touched: Vec<bool>,
}

/// What a solve says of a contact.
struct JudgedContact<R> {
    blocks: [u32; 2],
    /// Its mode in the solve.
    from: Mode,
    /// That for the next one.
    to: Mode,
    /// Whether its springs in the next solve are others.
    changed: bool,
    friction_misfit: FrictionMisfit<R>,
}

impl<R: Solve> OpenCloseIteration<'_, R> {
    /// Solves and judges until the iteration ends by itself, or modes have changed too often.
    pub(super) fn run<M: StepRules>(
        &self,
        contacts: &mut [StepContact<R>],
        layouts: &mut Layouts,
        spare: &mut Memory<R>,
        iteration_times: &mut IterationTimes,
    ) -> Result<IterationResult<R>, FactorizationFailure> {
        let (solves, mut unchanged) = (iteration_times.solves, self.unchanged);
        loop {
            if let Some(ended) = self.iterate::<M>(unchanged, contacts, layouts, spare, iteration_times)? {
                return Ok(ended);
            }
            (iteration_times.solves, unchanged) = (solves, None);
        }
    }

    /// `None` where a very large island that was taken as known has to be solved after all: its solution depends in last bits on the factors of
    /// the solves before, so the iteration must begin again without it.
    fn iterate<M: StepRules>(
        &self,
        unchanged: Option<&UnchangedIslands<R>>,
        contacts: &mut [StepContact<R>],
        layouts: &mut Layouts,
        spare: &mut Memory<R>,
        iteration_times: &mut IterationTimes,
    ) -> Result<Option<IterationResult<R>>, FactorizationFailure> {
        let unknowns: Vec<usize> = self.block_systems.iter().map(|block| block.unknowns).collect();
        let mut d = vec![[R::ZERO; 12]; unknowns.len()];
        // Blocks whose system is not the one solved before.
        let mut touched = vec![true; unknowns.len()];
        let mut ended = IterationResult {
            d: Vec::new(),
            iterations: 0,
            converged: false,
            friction_left: 0.0,
            changing: Vec::new(),
            modes: Vec::new(),
            touched: vec![false; unknowns.len()],
        };
        // Blocks of very large islands that were not solved.
        let mut known = HashSet::new();
        let prescribed = |solve: u32, contact: usize| self.prescribed?.get(solve as usize)?.get(contact).copied();
        for (k, contact) in contacts.iter_mut().enumerate() {
            contact.reset::<M>(prescribed(0, k).unwrap_or(contact.begins));
        }
        let blocks: Vec<[u32; 2]> = contacts.iter().map(|contact| contact.blocks).collect();
        let mut modes: Vec<Mode> = contacts.iter().map(|contact| contact.iterate.mode).collect();
        // What solving the islands left, by their lowest block, and contacts whose springs are not those of the solve before.
        let mut kept: HashMap<usize, CachedFactor<R>> = HashMap::new();
        let mut changed = vec![false; contacts.len()];
        // Solves that did not end the iteration by themselves: those in which no mode changed, and those in which one did.
        let (mut unchanging, mut changing) = (0, 0);
        loop {
            let mut before = std::mem::take(&mut kept);
            for island in islands(&unknowns, &blocks, &modes) {
                let lowest = island.lowest();
                let left = before.remove(&lowest);
                if !island.couplings.blocks.iter().any(|block| touched[*block as usize]) {
                    kept.extend(left.map(|left| (lowest, left)));
                    continue;
                }
                if let Some(unchanged) = unchanged.filter(|unchanged| ended.iterations == 0 && unchanged.has(&island)) {
                    for &block in &island.couplings.blocks {
                        d[block as usize] = unchanged.d[block as usize];
                    }
                    let layout = layouts.of(&island.couplings).ok_or(FactorizationFailure { block: lowest })?;
                    if layout.is_iterative() {
                        known.extend(island.couplings.blocks);
                    }
                    continue;
                }
                if island.couplings.blocks.iter().any(|block| known.contains(block)) {
                    Memory::of(kept.into_values().chain(before.into_values()), spare);
                    return Ok(None);
                }
                let mut work = SolveContext { block_systems: self.block_systems, layouts, spare, iteration_times };
                let (solved, left) = island.solve(contacts, &changed, left, &mut work)?;
                kept.insert(lowest, left);
                for (&block, found) in island.couplings.blocks.iter().zip(solved) {
                    d[block as usize] = found;
                }
            }
            Memory::of(before.into_values(), spare);
            let begun = Instant::now();
            iteration_times.solves += 1;
            ended.iterations += 1;
            ended.changing.clear();
            touched.fill(false);
            let mut opens_or_closes = false;
            let judged: Vec<JudgedContact<R>> = contacts
                .par_iter_mut()
                .enumerate()
                .with_min_len(CONTACTS_AT_ONCE)
                .map(|(k, contact)| {
                    let [i, j] = contact.entering();
                    let (from, stiff) = (contact.iterate.mode, contact.is_stiff_across());
                    let arms = contact.arms([i, j].map(|block| self.block_systems[block].centroid));
                    let prescribed = prescribed(ended.iterations, k);
                    let friction_misfit =
                        contact.decide_mode::<M>([&d[i], &d[j]], arms, self.limits, self.settling, prescribed);
                    let to = contact.iterate.mode;
                    let changed = from != to || stiff || contact.is_stiff_across();
                    JudgedContact { blocks: contact.blocks, from, to, changed, friction_misfit }
                })
                .collect();
            for (k, &JudgedContact { blocks, from, to, changed: new_springs, .. }) in judged.iter().enumerate() {
                changed[k] = new_springs;
                // The force of a sliding contact, and the spring across its slip, are those of the last solve: its system is a new one.
                if new_springs || to == Mode::Sliding {
                    for block in blocks.map(|block| block as usize) {
                        (touched[block], ended.touched[block]) = (true, true);
                    }
                }
                opens_or_closes |= M::opens_or_closes(from, to);
                if M::counts_as_change(from, to) {
                    ended.changing.push(ModeChange { blocks, contact: contacts[k].contact.key, from, to });
                }
            }
            modes = judged.iter().map(|judged| judged.to).collect();
            ended.modes.push(modes.clone());
            let settled = !opens_or_closes && self.friction_settled::<M>(&judged);
            ended.converged = settled || ended.changing.is_empty();
            if !settled {
                *(if ended.changing.is_empty() { &mut unchanging } else { &mut changing }) += 1;
            }
            iteration_times.judgement += begun.elapsed();
            let most = if opens_or_closes { M::changing_solves() } else { M::slipping_solves() };
            let ends = match self.prescribed {
                None => settled || unchanging >= M::unchanging_solves() || changing >= most,
                Some(modes) => ended.modes.len() + 1 >= modes.len(),
            };
            if ends {
                if ended.converged && !settled {
                    ended.friction_left = self.friction_left(&judged, contacts);
                }
                ended.d = d;
                Memory::of(kept.into_values(), spare);
                return Ok(Some(ended));
            }
        }
    }

    /// Whether friction has settled at every block that is not fixed.
    fn friction_settled<M: StepRules>(&self, contacts: &[JudgedContact<R>]) -> bool {
        let mut blocks = vec![FrictionMisfit::NONE; self.block_systems.len()];
        for contact in contacts {
            contact.blocks.iter().for_each(|&block| blocks[block as usize].add(contact.friction_misfit));
        }
        let free = blocks.iter().zip(self.block_systems).filter(|(_, block_systems)| block_systems.unknowns > 0);
        free.into_iter().all(|(block, _)| M::settled(block.misfit, block.pressing))
    }

    /// How far friction was from settling: of all blocks that are not fixed the largest share that Σ|Δf| is of the forces on the block, those that press and rub,
    /// or else its weight, loads and momentum over Δt, whichever are more.
    fn friction_left(&self, judged: &[JudgedContact<R>], contacts: &[StepContact<R>]) -> f64 {
        let mut blocks = vec![[0.0; 2]; self.block_systems.len()];
        for (judged, contact) in judged.iter().zip(contacts) {
            let FrictionMisfit { misfit, pressing } = judged.friction_misfit;
            let forces = pressing.to_f64() + contact.tangential_after(judged.to).length().to_f64();
            for block in judged.blocks.map(|block| block as usize) {
                blocks[block][0] += misfit.to_f64();
                blocks[block][1] += forces;
            }
        }
        let share = |([misfit, forces], system): (&[f64; 2], &BlockSystem<R>)| {
            let [x, y, z] = [system.force[0], system.force[1], system.force[2]].map(R::to_f64);
            let forces = forces.max((x * x + y * y + z * z).sqrt());
            if system.unknowns > 0 && *misfit > 0.0 { misfit / forces } else { 0.0 }
        };
        blocks.iter().zip(self.block_systems).map(share).fold(0.0, f64::max)
    }
}
