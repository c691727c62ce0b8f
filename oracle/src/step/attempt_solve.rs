//! One solve of an attempt in one number type, and what is asked of it: displacements, gaps and stretches, each calculated when first asked for.

use super::attempt_values::{AttemptValues, empty_cells};
use super::cascade::EXACT_UNKNOWNS;
use super::contact::ContactGeometry;
use super::friction::SlipForce;
use super::islands::islands_up_to;
use super::state::Mode;
use super::system::{StepNumber, StepSupport, System};
use crate::field::{LANES, Packed, single_vector};
use rockproof_model::{Ring, Vec3};
use std::cell::OnceCell;

/// What a solve left.
pub(crate) struct AttemptSolve<S> {
    modes: Vec<Mode>,
    /// What friction did to each contact that slid in it.
    pub(crate) friction: Vec<Option<SlipForce<S>>>,
    /// Blocks that are solved together; none where all were.
    islands: Vec<Vec<usize>>,
    /// d of each block, empty for a fixed one; `None` where an island has no solution.
    displacements: Vec<OnceCell<Option<Vec<S>>>>,
    motions: Vec<OnceCell<Option<ContactMotion<S>>>>,
    stretches: Vec<OnceCell<Option<Vec3<S>>>>,
}

/// How a contact moved.
struct ContactMotion<S> {
    /// A's point against B's.
    moved: Vec3<S>,
    /// Its product with N.
    along: S,
    /// h·|N|.
    gap: S,
}

impl<S: Ring> ContactMotion<S> {
    fn new(contact: &ContactGeometry<S>, moved: Vec3<S>) -> ContactMotion<S> {
        let along = contact.normal.dot(&moved);
        let gap = contact.gap.plus(&along);
        ContactMotion { moved, along, gap }
    }
}

impl<S> AttemptSolve<S> {
    /// The unknowns of all moving blocks that are solved.
    pub(crate) fn solution(&self) -> impl Iterator<Item = &S> {
        self.displacements.iter().filter_map(OnceCell::get).flatten().flatten()
    }
}

impl<S: StepNumber> AttemptValues<'_, S> {
    /// Solves once more, with these modes; `None` where this type cannot. `start` is what a cheaper type has found, without radius.
    pub(crate) fn advance(
        &mut self,
        modes: &[Mode],
        support: Option<&StepSupport<'_>>,
        start: Option<Vec<S>>,
    ) -> Option<()> {
        let friction = self.friction(modes)?;
        let solve = AttemptSolve {
            modes: modes.to_vec(),
            friction,
            islands: if S::BY_ISLAND { self.islands(modes)? } else { Vec::new() },
            displacements: empty_cells(self.attempt.blocks.len()),
            motions: empty_cells(modes.len()),
            stretches: empty_cells(modes.len()),
        };
        if !S::BY_ISLAND {
            let system = System::of(self, modes, &solve.friction, None)?;
            let moving: Vec<usize> = self.attempt.moving().map(|(block, _)| block).collect();
            self.keep(&solve, &moving, Some(S::solve(&system, support, start)?));
        }
        self.solves.push(solve);
        Some(())
    }

    /// The moving blocks that closed contacts tie together; `None` where they have more than [`EXACT_UNKNOWNS`] unknowns.
    fn islands(&self, modes: &[Mode]) -> Option<Vec<Vec<usize>>> {
        let attempt = self.attempt;
        let closed = attempt.started.iter().zip(modes).filter(|(_, mode)| **mode != Mode::Open);
        let tied = closed.map(|(started, _)| started.blocks);
        let sizes: Vec<usize> = attempt.rows.iter().map(|row| row.map_or(0, |row| attempt.sizes[row])).collect();
        islands_up_to(EXACT_UNKNOWNS, &sizes, tied)
    }

    /// Of each block whether, after the last solve, it is in an island in which no closed contact certainly has a gap: only then may none bear
    /// a force. `None` where an island is too large for fractions.
    pub(crate) fn blocks_without_force(&self) -> Option<Vec<bool>> {
        let solve = self.solves.last()?;
        let islands = self.islands(&solve.modes)?;
        let mut place = vec![None; self.attempt.blocks.len()];
        for (number, island) in islands.iter().enumerate() {
            island.iter().for_each(|&block| place[block] = Some(number));
        }
        let mut free = vec![true; islands.len()];
        for (k, started) in self.attempt.started.iter().enumerate().filter(|(k, _)| solve.modes[*k] != Mode::Open) {
            let presses = self.gap(solve, k)?.certain_sign().is_some_and(|sign| !sign.is_zero());
            started.blocks.iter().filter_map(|&block| place[block]).for_each(|number| free[number] &= !presses);
        }
        Some(place.into_iter().map(|number| number.is_some_and(|number| free[number])).collect())
    }

    /// Keeps the solution of some blocks, one after another.
    fn keep(&self, solve: &AttemptSolve<S>, blocks: &[usize], solution: Option<Vec<S>>) {
        let mut rest = solution.map(Vec::into_iter);
        for &block in blocks {
            let size = self.attempt.rows[block].map_or(0, |row| self.attempt.sizes[row]);
            let own = rest.as_mut().map(|rest| rest.take(size).collect());
            solve.displacements[block].get_or_init(|| own);
        }
    }

    /// d of a block after a solve, empty for a fixed one; `None` where there is no solution.
    pub(crate) fn displacement<'i>(&self, solve: &'i AttemptSolve<S>, block: usize) -> Option<&'i Vec<S>> {
        if solve.displacements[block].get().is_none() {
            if self.attempt.rows[block].is_none() {
                self.keep(solve, &[block], Some(Vec::new()));
            } else if let Some(island) = solve.islands.iter().find(|island| island.contains(&block)) {
                let system = System::of(self, &solve.modes, &solve.friction, Some(island));
                self.keep(solve, island, system.and_then(|system| S::solve(&system, None, None)));
            }
        }
        solve.displacements[block].get()?.as_ref()
    }

    /// How a contact moved in a solve.
    fn motion<'i>(&self, solve: &'i AttemptSolve<S>, k: usize) -> Option<&'i ContactMotion<S>> {
        if solve.motions[k].get().is_none() {
            S::keep_motions(self, solve, k);
        }
        solve.motions[k].get()?.as_ref()
    }

    /// Keeps how a contact moved.
    pub(crate) fn keep_motion(&self, solve: &AttemptSolve<S>, k: usize) {
        let make = || {
            let [i, j] = self.attempt.started[k].blocks;
            let contact = self.contact(k)?;
            let moved = contact.moved([self.displacement(solve, i)?, self.displacement(solve, j)?]);
            Some(ContactMotion::new(contact, moved))
        };
        solve.motions[k].get_or_init(make);
    }

    /// Keeps how a contact and those beside it moved, four together.
    pub(crate) fn keep_packed_motions<P: Packed<Single = S>>(&self, solve: &AttemptSolve<S>, k: usize) {
        let (first, last) = (k / LANES * LANES, self.attempt.started.len() - 1);
        let lanes: [usize; LANES] = std::array::from_fn(|lane| (first + lane).min(last));
        let known = |k: usize| {
            let [i, j] = self.attempt.started[k].blocks;
            Some((self.contact(k)?, [self.displacement(solve, i)?.as_slice(), self.displacement(solve, j)?.as_slice()]))
        };
        let [Some(a), Some(b), Some(c), Some(d)] = lanes.map(known) else { return self.keep_motion(solve, k) };
        let known = [a, b, c, d];
        let contact = ContactGeometry::<P>::packed(known.map(|(contact, _)| contact));
        let motion = ContactMotion::new(&contact, contact.packed_moved(known.map(|(_, displacements)| displacements)));
        for (lane, &k) in lanes.iter().enumerate() {
            let single = || {
                Some(ContactMotion {
                    moved: single_vector(&motion.moved, lane),
                    along: motion.along.single(lane),
                    gap: motion.gap.single(lane),
                })
            };
            solve.motions[k].get_or_init(single);
        }
    }

    /// h·|N| of a contact after a solve.
    pub(crate) fn gap<'i>(&self, solve: &'i AttemptSolve<S>, k: usize) -> Option<&'i S> {
        Some(&self.motion(solve, k)?.gap)
    }

    /// The trial stretch of a contact after a solve.
    pub(crate) fn stretch<'i>(&self, solve: &'i AttemptSolve<S>, k: usize) -> Option<&'i Vec3<S>> {
        let make = || {
            let (contact, motion) = (self.contact(k)?, self.motion(solve, k)?);
            Some(contact.stretch.plus(&contact.across(&motion.moved, &motion.along)))
        };
        solve.stretches[k].get_or_init(make).as_ref()
    }
}
