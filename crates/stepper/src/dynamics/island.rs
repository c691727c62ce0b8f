//! Islands: blocks that closed contacts tie together. Each is a system of its own (SPEC section 5, `K d = F`).

use crate::dynamics::assembly::System;
use crate::dynamics::contact::Active;
use crate::dynamics::displacement::Twelve;
use crate::dynamics::layout::{Layout, Layouts, Ties};
use crate::dynamics::pattern::Pattern;
use crate::dynamics::report::Spent;
use crate::dynamics::solve::{Singular, Solve, dense};
use crate::real::Real;
use std::sync::Arc;
use std::time::Instant;

/// What a block brings into its system, without contacts.
#[derive(Clone, Debug)]
pub(super) struct Alone<R> {
    /// 12, 6 or 0.
    pub(super) unknowns: usize,
    pub(super) stiffness: Packed<R>,
    pub(super) force: Twelve<R>,
}

/// Blocks that closed contacts tie together, what is tied within them, and the closed contacts between them and to fixed blocks.
#[derive(Clone, Debug, Default)]
pub(super) struct Island {
    pub(super) ties: Ties,
    pub(super) contacts: Vec<usize>,
}

/// The islands, by their lowest block. Contacts are sorted by pair.
pub(super) fn islands<R: Real>(unknowns: &[usize], contacts: &[Active<R>]) -> Vec<Island> {
    let mut root: Vec<usize> = (0..unknowns.len()).collect();
    fn find(root: &mut [usize], mut block: usize) -> usize {
        while root[block] != block {
            root[block] = root[root[block]];
            block = root[block];
        }
        block
    }
    let closed = || contacts.iter().enumerate().filter(|(_, c)| c.is_closed());
    for (_, contact) in closed() {
        let [a, b] = contact.blocks.map(|block| block as usize);
        if unknowns[a] > 0 && unknowns[b] > 0 {
            let (a, b) = (find(&mut root, a), find(&mut root, b));
            root[a.max(b)] = a.min(b);
        }
    }
    // The island of each block, and its place there.
    let mut place = vec![[u32::MAX; 2]; unknowns.len()];
    let mut all: Vec<Island> = Vec::new();
    for block in (0..unknowns.len()).filter(|&block| unknowns[block] > 0) {
        let lowest = find(&mut root, block);
        if lowest == block {
            place[block][0] = all.len() as u32;
            all.push(Island::default());
        }
        let ties = &mut all[place[lowest][0] as usize].ties;
        place[block] = [place[lowest][0], ties.blocks.len() as u32];
        ties.blocks.push(block as u32);
        ties.unknowns.push(unknowns[block] as u8);
    }
    for same in contacts.chunk_by(|one, other| one.blocks == other.blocks) {
        let [[a, first], [b, second]] = same[0].blocks.map(|block| place[block as usize]);
        if a == b && a != u32::MAX {
            all[a as usize].ties.pairs.push([first, second]);
        }
    }
    for (k, contact) in closed() {
        let [a, b] = contact.blocks.map(|block| block as usize);
        let moving = if unknowns[a] > 0 { a } else { b };
        all[place[moving][0] as usize].contacts.push(k);
    }
    all
}

/// What is left of an island's solution for the next one.
#[derive(Debug)]
pub(super) struct Kept<R> {
    layout: Arc<Layout>,
    /// The factor begins at `aligned`.
    values: Vec<R>,
    aligned: usize,
}

impl<R: Solve> Kept<R> {
    /// In memory that is there already, whatever it holds.
    fn new(layout: Arc<Layout>, mut values: Vec<R>) -> Kept<R> {
        let spare = Pattern::ALIGNED;
        let needed = layout.pattern.values() + spare;
        if values.len() < needed {
            // What it holds need not be copied.
            values = Vec::new();
            values.resize(needed, R::ZERO);
        }
        let aligned = values.as_ptr().align_offset(64);
        Kept { layout, values, aligned: if aligned <= spare { aligned } else { 0 } }
    }

    /// The memory of the largest of some factors, and of that which was there.
    pub(super) fn largest(all: impl Iterator<Item = Kept<R>>, spare: Vec<R>) -> Vec<R> {
        all.map(|kept| kept.values).fold(spare, |most, one| if most.len() < one.len() { one } else { most })
    }
}

/// What a solution follows from besides the contacts of the island.
pub(super) struct Work<'s, R> {
    pub(super) alone: &'s [Alone<R>],
    pub(super) layouts: &'s mut Layouts,
    /// Memory that no factor has now.
    pub(super) spare: &'s mut Vec<R>,
    pub(super) spent: &'s mut Spent,
}

impl Island {
    /// The lowest of its blocks.
    pub(super) fn lowest(&self) -> usize {
        self.ties.blocks.first().map_or(0, |&block| block as usize)
    }

    /// The displacements of its blocks: twelve numbers each, zero where a block has no such unknown. What the solution before left is
    /// that of the same blocks by the same contacts, of which those that `changed` says had other springs.
    pub(super) fn solve<R: Solve>(
        &self,
        contacts: &[Active<R>],
        changed: &[bool],
        before: Option<Kept<R>>,
        work: &mut Work<'_, R>,
    ) -> Result<(Vec<Twelve<R>>, Kept<R>), Unsolved> {
        let begun = Instant::now();
        let first = Unsolved { block: self.lowest() };
        let layout = work.layouts.of(&self.ties).ok_or(first)?;
        work.spent.order += begun.elapsed();
        let begun = Instant::now();
        let (mut kept, marked) = match before {
            Some(kept) if Arc::ptr_eq(&kept.layout, &layout) && !layout.is_small() => {
                let mut marked = vec![false; layout.pattern.panel_count()];
                let touched = contacts.iter().zip(changed).filter(|(_, changed)| **changed);
                for block in touched.flat_map(|(contact, _)| contact.blocks) {
                    if let Ok(place) = self.ties.blocks.binary_search(&block) {
                        marked[layout.pattern.panel(layout.places[place] as usize)] = true;
                    }
                }
                layout.pattern.mark_dependent(&mut marked);
                (kept, marked)
            }
            other => {
                let memory = other.map_or_else(|| std::mem::take(work.spare), |kept| kept.values);
                let marked = vec![true; layout.pattern.panel_count()];
                (Kept::new(layout.clone(), memory), marked)
            }
        };
        let aligned = kept.aligned;
        let values = &mut kept.values[aligned..];
        let system = System::new(&self.ties.blocks, &layout, &marked, work.alone, (contacts, &self.contacts));
        let mut force = system.force();
        work.spent.assembly += begun.elapsed();
        let fill = |panel: usize, values: &mut [R]| system.fill(panel, values);
        let begun = Instant::now();
        let solved = if layout.is_small() {
            values[..layout.pattern.values()].fill(R::ZERO);
            fill(0, values);
            let solved = dense(&layout.pattern, values, &mut force);
            work.spent.factor += begun.elapsed();
            solved
        } else {
            let factored = R::factorize(&layout.pattern, values, &marked, &fill);
            work.spent.factor += begun.elapsed();
            let begun = Instant::now();
            let solved = factored.and_then(|()| R::substitute(&layout.pattern, values, &mut force));
            work.spent.substitution += begun.elapsed();
            solved
        };
        solved.map_err(|Singular { unknown }| {
            let place = layout.pattern.node_of(unknown);
            let block = layout.places.iter().position(|&p| p as usize == place);
            Unsolved { block: self.ties.blocks[block.unwrap_or(0)] as usize }
        })?;
        Ok((by_block(&layout, &force), kept))
    }
}

/// The solution by blocks.
fn by_block<R: Real>(layout: &Layout, solution: &[R]) -> Vec<Twelve<R>> {
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
pub(super) struct Unsolved {
    pub(super) block: usize,
}

/// The lower triangle of a 12 × 12 matrix, row by row.
pub(super) type Packed<R> = [R; 78];

/// Where a row and a column, which is not greater, stand in it.
pub(super) fn packed(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}
