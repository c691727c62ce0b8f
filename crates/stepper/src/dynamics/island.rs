//! Islands: blocks that closed contacts tie together. Each is a system of its own (SPEC section 5, `K d = F`).

use crate::dynamics::conjugate_gradients::{ConjugateGradients, FactorInF32, Patience};
use crate::dynamics::contact::StepContact;
use crate::dynamics::displacement::BlockVector;
use crate::dynamics::layout::{Couplings, IslandLayout, Layouts};
use crate::dynamics::products::Products;
use crate::dynamics::report::IterationTimes;
use crate::dynamics::solve::Solve;
use crate::dynamics::state::Mode;
use crate::dynamics::system::System;
use crate::dynamics::two_level::TwoLevel;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_cholesky::{Pattern, Singular};
use rockproof_model::simulation::Solver;
use std::sync::Arc;
use std::time::Instant;

/// What a block brings into its system, without contacts.
#[derive(Clone, Debug)]
pub(super) struct BlockSystem<R> {
    /// 12, 6 or 0.
    pub(super) unknowns: usize,
    pub(super) stiffness: PackedBlockMatrix<R>,
    pub(super) force: BlockVector<R>,
    /// In m.
    pub(super) centroid: Vector<R>,
}

/// Blocks that closed contacts tie together, what is tied within them, and the closed contacts between them and to fixed blocks.
#[derive(Clone, Debug, Default)]
pub(super) struct Island {
    pub(super) couplings: Couplings,
    pub(super) contacts: Vec<u32>,
}

/// Which of several numbered things are tied together, directly or through others.
pub(super) struct Ties {
    /// Of each a lower one that it is tied to; itself of the lowest.
    lower: Vec<u32>,
}

impl Ties {
    /// None among so many.
    pub(super) fn none(count: usize) -> Ties {
        Ties { lower: (0..count as u32).collect() }
    }

    /// Ties two.
    pub(super) fn tie(&mut self, a: u32, b: u32) {
        let (a, b) = (self.lowest(a), self.lowest(b));
        self.lower[a.max(b) as usize] = a.min(b);
    }

    /// The lowest that one is tied to; itself where there is none.
    pub(super) fn lowest(&mut self, mut one: u32) -> u32 {
        while self.lower[one as usize] != one {
            self.lower[one as usize] = self.lower[self.lower[one as usize] as usize];
            one = self.lower[one as usize];
        }
        one
    }
}

/// The islands, by their lowest block. Of contacts, sorted by pair, their blocks and modes.
pub(super) fn islands(unknowns: &[usize], blocks: &[[u32; 2]], modes: &[Mode]) -> Vec<Island> {
    let mut ties = Ties::none(unknowns.len());
    let closed = || blocks.iter().zip(modes).enumerate().filter(|(_, (_, mode))| mode.is_closed());
    let moves = |block: u32| unknowns[block as usize] > 0;
    for (_, (&[a, b], _)) in closed().filter(|&(_, (&[a, b], _))| moves(a) && moves(b)) {
        ties.tie(a, b);
    }
    // The island of each block, and its place there.
    let mut place = vec![[u32::MAX; 2]; unknowns.len()];
    let mut all: Vec<Island> = Vec::new();
    for block in (0..unknowns.len()).filter(|&block| unknowns[block] > 0) {
        let lowest = ties.lowest(block as u32) as usize;
        if lowest == block {
            place[block][0] = all.len() as u32;
            all.push(Island::default());
        }
        let couplings = &mut all[place[lowest][0] as usize].couplings;
        place[block] = [place[lowest][0], couplings.blocks.len() as u32];
        couplings.blocks.push(block as u32);
        couplings.unknowns.push(unknowns[block] as u8);
    }
    for same in blocks.chunk_by(|one, other| one == other) {
        let [[a, first], [b, second]] = same[0].map(|block| place[block as usize]);
        if a == b && a != u32::MAX {
            all[a as usize].couplings.pairs.push([first, second]);
        }
    }
    for (k, (&[a, b], _)) in closed() {
        let moving = if moves(a) { a } else { b };
        all[place[moving as usize][0] as usize].contacts.push(k as u32);
    }
    all
}

/// Memory for factors, used again and again: to fetch it anew costs time.
#[derive(Debug)]
pub(super) struct Memory<R> {
    own: Vec<R>,
    single: Vec<f32>,
}

impl<R> Memory<R> {
    pub(super) const NONE: Self = Memory { own: Vec::new(), single: Vec::new() };

    /// The larger of two, each scalar by itself.
    fn larger(self, other: Memory<R>) -> Memory<R> {
        Memory {
            own: if self.own.len() < other.own.len() { other.own } else { self.own },
            single: if self.single.len() < other.single.len() { other.single } else { self.single },
        }
    }

    /// The largest of that which some factors have had.
    pub(super) fn of(all: impl Iterator<Item = CachedFactor<R>>, spare: &mut Memory<R>) {
        let before = std::mem::replace(spare, Memory::NONE);
        *spare = all.map(|kept| kept.memory).fold(before, Memory::larger);
    }
}

/// Room for the values of a pattern, aligned, whatever it holds.
fn room<'r, R: Real>(memory: &'r mut Vec<R>, pattern: &Pattern) -> &'r mut [R] {
    let needed = pattern.values() + Pattern::ALIGNED;
    if memory.len() < needed {
        // What it holds need not be copied.
        *memory = Vec::new();
        memory.resize(needed, R::ZERO);
    }
    let aligned = memory.as_ptr().align_offset(64);
    let begin = if aligned <= Pattern::ALIGNED { aligned } else { 0 };
    &mut memory[begin..][..pattern.values()]
}

/// The layout and factor of an island's last solution, kept for the next one.
#[derive(Debug)]
pub(super) struct CachedFactor<R> {
    layout: Arc<IslandLayout>,
    memory: Memory<R>,
    /// Where conjugate gradients solve, what they go on from.
    single: Option<SingleFactor<R>>,
}

/// What is known of a system that conjugate gradients solve, and of its factor in f32 besides its values.
#[derive(Debug)]
pub(super) struct SingleFactor<R> {
    /// Whether the next solve tries to do without a factor; then there is none.
    tries_without: bool,
    /// Panels in which the matrix is no longer that of the factor, as far as springs have changed; all that depend on them are too.
    stale: Vec<bool>,
    /// The solution before.
    pub(super) before: Option<Vec<R>>,
    /// At how many contacts springs had changed when the factor was last of no use for the next solve.
    gave_up: usize,
}

impl<R> SingleFactor<R> {
    /// None so far, of so many panels.
    pub(super) fn none(panels: usize, tries_without: bool) -> SingleFactor<R> {
        SingleFactor { tries_without, stale: vec![true; panels], before: None, gave_up: usize::MAX }
    }
}

/// What a solution follows from besides the contacts of the island.
pub(super) struct SolveContext<'s, R> {
    pub(super) block_systems: &'s [BlockSystem<R>],
    pub(super) layouts: &'s mut Layouts,
    /// Memory that no factor has now.
    pub(super) spare: &'s mut Memory<R>,
    pub(super) iteration_times: &'s mut IterationTimes,
}

impl Island {
    /// The lowest of its blocks.
    pub(super) fn lowest(&self) -> usize {
        self.couplings.blocks.first().map_or(0, |&block| block as usize)
    }

    /// The displacements of its blocks: twelve numbers each, zero where a block has no such unknown. What the solution before left is
    /// that of the same blocks by the same contacts, of which those that `changed` says had other springs.
    pub(super) fn solve<R: Solve>(
        &self,
        contacts: &[StepContact<R>],
        changed: &[bool],
        before: Option<CachedFactor<R>>,
        work: &mut SolveContext<'_, R>,
    ) -> Result<(Vec<BlockVector<R>>, CachedFactor<R>), FactorizationFailure> {
        let begun = Instant::now();
        let first = FactorizationFailure { block: self.lowest() };
        let layout = work.layouts.of(&self.couplings).ok_or(first)?;
        work.iteration_times.order += begun.elapsed();
        let begun = Instant::now();
        // Contacts at its blocks whose springs changed.
        let mut news = 0;
        let (mut kept, mut marked) = match before {
            Some(kept) if Arc::ptr_eq(&kept.layout, &layout) && !layout.is_small() => {
                let mut marked = vec![false; layout.pattern.panel_count()];
                for (contact, _) in contacts.iter().zip(changed).filter(|(_, changed)| **changed) {
                    let places = contact.blocks.map(|block| self.couplings.blocks.binary_search(&block).ok());
                    for place in places.into_iter().flatten() {
                        marked[layout.pattern.panel(layout.places[place] as usize)] = true;
                    }
                    news += usize::from(places.into_iter().flatten().next().is_some());
                }
                layout.pattern.mark_dependent(&mut marked);
                (kept, marked)
            }
            other => {
                let memory = match other {
                    Some(kept) => kept.memory,
                    None if layout.is_small() => Memory::NONE,
                    None => std::mem::replace(work.spare, Memory::NONE),
                };
                let marked = vec![true; layout.pattern.panel_count()];
                let single = layout.is_iterative().then(|| SingleFactor::none(marked.len(), layout.groups.is_some()));
                (CachedFactor { layout: layout.clone(), memory, single }, marked)
            }
        };
        let parts = (contacts, &self.contacts[..]);
        let system = System::new(&self.couplings.blocks, &layout, work.block_systems, parts);
        let mut force = system.force();
        if let Some(mut single) = kept.single.take() {
            let products = Products::new(&system);
            work.iteration_times.assembly += begun.elapsed();
            let solving = BySingle { products: &products, memory: &mut kept.memory.single, force: &force };
            if solving.solve(&mut single, &marked, news, work.iteration_times) {
                let found = by_block(&layout, single.before.as_deref().unwrap_or_default());
                kept.single = Some(single);
                return Ok((found, kept));
            }
            kept.memory.single = Vec::new();
            marked.fill(true);
        } else {
            work.iteration_times.assembly += begun.elapsed();
        }
        let begun = Instant::now();
        let bearing = system.bearing(&marked);
        work.iteration_times.assembly += begun.elapsed();
        let values = room(&mut kept.memory.own, &layout.pattern);
        let fill = |panel: usize, values: &mut [R]| system.fill(panel, &bearing, values);
        let begun = Instant::now();
        let solved = if layout.is_small() {
            values.fill(R::ZERO);
            fill(0, values);
            let solved = R::solve_small(&layout.pattern, values, &mut force);
            work.iteration_times.factor += begun.elapsed();
            solved
        } else {
            let factored = R::factorize(&layout.pattern, values, &marked, &fill);
            work.iteration_times.factor += begun.elapsed();
            let begun = Instant::now();
            let solved = factored.and_then(|()| R::substitute(&layout.pattern, values, &mut force));
            work.iteration_times.substitution += begun.elapsed();
            solved
        };
        solved.map_err(|Singular { unknown }| {
            let place = layout.pattern.node_of(unknown);
            let block = layout.places.iter().position(|&p| p as usize == place);
            FactorizationFailure { block: self.couplings.blocks[block.unwrap_or(0)] as usize }
        })?;
        Ok((by_block(&layout, &force), kept))
    }
}

/// Solving by conjugate gradients: without a factor, or by one in f32.
pub(super) struct BySingle<'b, 'p, 's, R> {
    pub(super) products: &'b Products<'p, 's, R>,
    pub(super) memory: &'b mut Vec<f32>,
    pub(super) force: &'b [R],
}

impl<R: Solve> BySingle<'_, '_, '_, R> {
    /// Leaves the solution in `single`, if it converges. In the panels that are `marked` springs have changed since the
    /// solve before, at `news` contacts in all; the rest of what it says is as that left it.
    pub(super) fn solve(
        self,
        single: &mut SingleFactor<R>,
        marked: &[bool],
        news: usize,
        iteration_times: &mut IterationTimes,
    ) -> bool {
        let BySingle { products, memory, force } = self;
        let system = products.system;
        let pattern = &system.layout.pattern;
        if single.tries_without {
            let begun = Instant::now();
            let patience = match system.layout.solver {
                Some(Solver::ConjugateGradients) => Patience::WITHOUT_FACTOR,
                _ => Patience::instead_of_factor(pattern, system.sides.len()),
            };
            let may_suffice = patience.can_suffice(products.springs_to_inertia());
            let preconditioner = if may_suffice { TwoLevel::new(products) } else { None };
            iteration_times.factor += begun.elapsed();
            let begun = Instant::now();
            let before = single.before.take();
            single.before = preconditioner.and_then(|preconditioner| {
                let gradients = ConjugateGradients { products, preconditioner: &preconditioner };
                gradients.solve(force, before.as_deref(), patience)
            });
            iteration_times.substitution += begun.elapsed();
            if single.before.is_some() {
                return true;
            }
            single.tries_without = false;
        }
        let begun = Instant::now();
        let values = room(memory, pattern);
        single.stale.iter_mut().zip(marked).for_each(|(stale, &marked)| *stale |= marked);
        // Where the factor was of no use it is not tried again before much less changes.
        let before = single.before.take();
        if before.is_some() && news < single.gave_up / 2 {
            let preconditioner = FactorInF32 { pattern, values };
            let refining = ConjugateGradients { products, preconditioner: &preconditioner };
            single.before = refining.solve(force, before.as_deref(), Patience::old_factor(news));
            iteration_times.substitution += begun.elapsed();
            if single.before.is_some() {
                return true;
            }
            single.gave_up = news;
        }
        let begun = Instant::now();
        let bearing = system.bearing(&single.stale);
        let fill = |panel: usize, values: &mut [f32]| {
            let mut whole = vec![R::ZERO; values.len()];
            system.fill(panel, &bearing, &mut whole);
            values.iter_mut().zip(whole).for_each(|(value, whole)| *value = whole.to_f64() as f32);
        };
        let factored = f32::factorize(pattern, values, &single.stale, &fill);
        single.stale.fill(false);
        iteration_times.factor += begun.elapsed();
        let begun = Instant::now();
        let preconditioner = FactorInF32 { pattern, values };
        let refining = ConjugateGradients { products, preconditioner: &preconditioner };
        single.before = factored.ok().and_then(|()| refining.solve(force, before.as_deref(), Patience::NEW_FACTOR));
        iteration_times.substitution += begun.elapsed();
        single.before.is_some()
    }
}

/// The solution by blocks.
fn by_block<R: Real>(layout: &IslandLayout, solution: &[R]) -> Vec<BlockVector<R>> {
    let of = |&place: &u32| {
        let unknowns = layout.pattern.unknowns(place as usize);
        let mut d = [R::ZERO; 12];
        d[..unknowns.len()].copy_from_slice(&solution[unknowns]);
        d
    };
    layout.places.iter().map(of).collect()
}

/// The block at which elimination failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FactorizationFailure {
    pub(super) block: usize,
}

/// The lower triangle of a 12 × 12 matrix, row by row.
pub(super) type PackedBlockMatrix<R> = [R; 78];

/// Where a row and a column, which is not greater, stand in it.
pub(super) fn packed(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}
