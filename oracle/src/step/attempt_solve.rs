//! One solve of an attempt in one number type, and what is asked of it: displacements, gaps and stretches, each calculated when first asked for.

use super::attempt_values::{AttemptValues, empty_cells};
use super::cascade::EXACT_UNKNOWNS;
use super::contact::ContactGeometry;
use super::friction::SlipForce;
use super::islands::{Island, Islands};
use super::state::Mode;
use super::system::{StepNumber, StepSupport, System};
use crate::field::{LANES, Packed, single_vector};
use num_rational::BigRational;
use rockproof_model::{Ring, Vec3};
use std::cell::OnceCell;

/// What a solve left.
pub(crate) struct AttemptSolve<S> {
    /// Its place among the solves of the attempt.
    number: usize,
    modes: Vec<Mode>,
    /// What friction did to each contact that slid in it; `None` where this type cannot tell.
    slips: Vec<OnceCell<Option<SlipForce<S>>>>,
    /// Blocks that are solved together; none where all were.
    islands: Islands,
    /// Of each island whether its contacts are known to bear no force, where that was asked.
    are_free: Vec<OnceCell<bool>>,
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

impl<'a, S: StepNumber> AttemptValues<'a, S> {
    /// Solves once more, with these modes; `None` where this type cannot. `start` is what a cheaper type has found, without radius.
    pub(crate) fn advance(
        &mut self,
        modes: &[Mode],
        support: Option<&StepSupport<'_>>,
        start: Option<Vec<S>>,
    ) -> Option<()> {
        let islands = if S::BY_ISLAND { self.islands(modes) } else { Islands::default() };
        let solve = AttemptSolve {
            number: self.solves.len(),
            modes: modes.to_vec(),
            slips: empty_cells(modes.len()),
            are_free: empty_cells(islands.all.len()),
            islands,
            displacements: empty_cells(self.attempt.blocks.len()),
            motions: empty_cells(modes.len()),
            stretches: empty_cells(modes.len()),
        };
        if !S::BY_ISLAND {
            let system = System::of(self, modes, |k| self.slip_force(&solve, k), None)?;
            let moving: Vec<usize> = self.attempt.moving().map(|(block, _)| block).collect();
            self.keep(&solve, &moving, Some(S::solve(&system, support, start)?));
        }
        self.solves.push(solve);
        Some(())
    }

    /// The moving blocks that closed contacts tie together.
    fn islands(&self, modes: &[Mode]) -> Islands {
        let attempt = self.attempt;
        let moves: Vec<bool> = attempt.rows.iter().map(Option::is_some).collect();
        let started = attempt.started.iter().zip(modes).enumerate().filter(|(_, (_, mode))| **mode != Mode::Open);
        let closed: Vec<(usize, [usize; 2])> = started.map(|(k, (started, _))| (k, started.blocks)).collect();
        Islands::new(&moves, &closed)
    }

    /// Of each block whether, after the last solve, it is in an island in which no closed contact certainly has a gap or slides on as another solve
    /// left it: only then may none bear a force that fractions can tell.
    pub(crate) fn blocks_without_force(&self) -> Option<Vec<bool>> {
        let solve = self.solves.last()?;
        let mut free = vec![false; self.attempt.blocks.len()];
        for island in &self.islands(&solve.modes).all {
            let mut may_be = true;
            for &k in &island.contacts {
                let presses = self.gap(solve, k)?.certain_sign().is_some_and(|sign| !sign.is_zero());
                // Friction on a slip that a solve left has a root, which is hardly ever a fraction.
                may_be &= !presses && (solve.number == 0 || solve.modes[k] != Mode::Sliding);
            }
            island.blocks.iter().for_each(|&block| free[block] = may_be);
        }
        Some(free)
    }

    /// Whether every island of the last solve that is solved only if its contacts bear no force has its solution. Others are known to have one
    /// only when they are solved.
    pub(crate) fn large_islands_are_solved(&self) -> bool {
        let Some(solve) = self.solves.last() else { return true };
        let unknowns = |block: &usize| self.attempt.rows[*block].map_or(0, |row| self.attempt.sizes[row]);
        let is_large = |island: &&Island| island.blocks.iter().map(unknowns).sum::<usize>() > EXACT_UNKNOWNS;
        let mut large = solve.islands.all.iter().filter(is_large);
        large.all(|island| self.displacement(solve, island.blocks[0]).is_some())
    }

    /// What friction did to a contact in a solve, if it slid in it; `None` where this type cannot tell.
    pub(crate) fn slip_force<'i>(&self, solve: &'i AttemptSolve<S>, k: usize) -> Option<Option<&'i SlipForce<S>>> {
        if solve.modes[k] != Mode::Sliding {
            return Some(None);
        }
        let before = solve.number.checked_sub(1).map(|number| &self.solves[number]);
        solve.slips[k].get_or_init(|| self.slip(k, before)).as_ref().map(Some)
    }

    /// The system of an island in a solve.
    fn system<'s>(&'s self, solve: &'s AttemptSolve<S>, island: &Island) -> Option<System<'s, 'a, S>> {
        System::of(self, &solve.modes, |k| self.slip_force(solve, k), Some(island))
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
            } else if let Some(place) = solve.islands.of(block) {
                let island = &solve.islands.all[place];
                let solution = self.system(solve, island).and_then(|system| S::solve(&system, None, None));
                self.keep(solve, &island.blocks, solution);
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

impl AttemptValues<'_, BigRational> {
    /// Whether no contact bears a force, in the last solve, of the islands in which the blocks of a contact are. No matrix is made to tell.
    pub(crate) fn moves_freely(&self, k: usize) -> bool {
        let Some(solve) = self.solves.last() else { return false };
        let is_free = |place: usize| {
            let island = &solve.islands.all[place];
            let motion = self.system(solve, island).and_then(|system| system.free_motion());
            let is_free = motion.is_some();
            if is_free {
                self.keep(solve, &island.blocks, motion);
            }
            is_free
        };
        let mut places = self.attempt.started[k].blocks.iter().filter_map(|&block| solve.islands.of(block));
        places.all(|place| *solve.are_free[place].get_or_init(|| is_free(place)))
    }
}
