//! Islands: blocks that closed contacts tie together. Each is a system of its own (SPEC section 5, `K d = F`).

use crate::dynamics::area::tangents;
use crate::dynamics::contact::Active;
use crate::dynamics::displacement::{Twelve, generalized};
use crate::dynamics::layout::{Layout, Layouts, Ties};
use crate::dynamics::pattern::{Part, Pattern};
use crate::dynamics::report::Spent;
use crate::dynamics::solve::{Singular, Solve, dense};
use crate::dynamics::state::Mode;
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
    fn new(layout: Arc<Layout>) -> Kept<R> {
        let spare = Pattern::ALIGNED;
        let values = vec![R::ZERO; layout.pattern.values() + spare];
        let aligned = values.as_ptr().align_offset(64);
        Kept { layout, values, aligned: if aligned <= spare { aligned } else { 0 } }
    }
}

/// What a solution follows from besides the contacts of the island.
pub(super) struct Work<'s, R> {
    pub(super) alone: &'s [Alone<R>],
    pub(super) layouts: &'s mut Layouts,
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
                drop(other);
                let marked = vec![true; layout.pattern.panel_count()];
                (Kept::new(layout.clone()), marked)
            }
        };
        let aligned = kept.aligned;
        let values = &mut kept.values[aligned..];
        let mut system = System::new(&self.ties.blocks, &layout, values, &marked, work.alone);
        for &k in &self.contacts {
            system.add(&contacts[k]);
        }
        let mut force = system.force;
        work.spent.assembly += begun.elapsed();
        let solved = if layout.is_small() {
            let begun = Instant::now();
            let solved = dense(&layout.pattern, values, &mut force);
            work.spent.factor += begun.elapsed();
            solved
        } else {
            let begun = Instant::now();
            let factored = R::factorize(&layout.pattern, values, &marked);
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

struct System<'s, R> {
    blocks: &'s [u32],
    layout: &'s Layout,
    /// As the layout's pattern has them.
    values: &'s mut [R],
    /// The panels whose values are to be found; the others hold a factor.
    marked: &'s [bool],
    force: Vec<R>,
}

impl<'s, R: Real> System<'s, R> {
    fn new(
        blocks: &'s [u32],
        layout: &'s Layout,
        values: &'s mut [R],
        marked: &'s [bool],
        alone: &[Alone<R>],
    ) -> System<'s, R> {
        for (panel, _) in layout.pattern.panels().iter().zip(marked).filter(|(_, marked)| **marked) {
            values[panel.values..panel.values + panel.width * panel.height].fill(R::ZERO);
        }
        let force = vec![R::ZERO; layout.pattern.size()];
        let mut system = System { blocks, layout, values, marked, force };
        for (&block, &place) in blocks.iter().zip(&layout.places) {
            let (alone, place) = (&alone[block as usize], place as usize);
            let unknowns = layout.pattern.unknowns(place);
            system.force[unknowns.clone()].copy_from_slice(&alone.force[..unknowns.len()]);
            let Some(part) = system.part(place, place) else { continue };
            for column in 0..unknowns.len() {
                let values = &mut system.values[part.at + part.stride * column..][..unknowns.len()];
                for (row, value) in values.iter_mut().enumerate().skip(column) {
                    *value = alone.stiffness[packed(row, column)];
                }
            }
        }
        system
    }

    /// Where the rows of a place in the columns of one that is not later stand, if they are to be found.
    fn part(&self, row: usize, column: usize) -> Option<Part> {
        if !self.marked[self.layout.pattern.panel(column)] {
            return None;
        }
        self.layout.pattern.part(row, column)
    }

    fn add(&mut self, contact: &Active<R>) {
        let place =
            |block: usize| self.blocks.binary_search(&(block as u32)).ok().map(|k| self.layout.places[k] as usize);
        let [i, j] = contact.entering().map(place);
        let [e, g] = contact.rows();
        self.spring([i, j], [&e, &g], contact.joint.normal, contact.plane.gap);
        match contact.now.mode {
            Mode::Locked => {
                let (one, two) = tangents(contact.plane.normal);
                for along in [one, two] {
                    let rows = contact.arms.map(|arm| generalized(arm, along));
                    let stretch = contact.stretch.dot(along);
                    self.spring([i, j], [&rows[0], &rows[1]], contact.joint.shear, stretch);
                }
            }
            Mode::Sliding => {
                let friction = &contact.now.friction;
                if friction.is_stiff() {
                    let rows = contact.arms.map(|arm| generalized(arm, friction.across));
                    let stretch = contact.stretch.dot(friction.across);
                    self.spring([i, j], [&rows[0], &rows[1]], friction.spring, stretch);
                }
                let force = friction.force;
                for (place, arm, force) in [(i, contact.arms[0], -force), (j, contact.arms[1], force)] {
                    let Some(place) = place else { continue };
                    let share = generalized(arm, force);
                    for (total, share) in self.force[self.layout.pattern.unknowns(place)].iter_mut().zip(share) {
                        *total = *total + share;
                    }
                }
            }
            Mode::Open => {}
        }
    }

    /// A spring of length `before + e·d_i − g·d_j`.
    fn spring(&mut self, [i, j]: [Option<usize>; 2], [e, g]: [&Twelve<R>; 2], stiffness: R, before: R) {
        if let Some(i) = i {
            self.tie([i, i], [e, e], stiffness);
            pull(&mut self.force[self.layout.pattern.unknowns(i)], e, -stiffness * before);
        }
        if let Some(j) = j {
            self.tie([j, j], [g, g], stiffness);
            pull(&mut self.force[self.layout.pattern.unknowns(j)], g, stiffness * before);
        }
        if let (Some(i), Some(j)) = (i, j) {
            // Rows belong to the later place.
            if i < j { self.tie([i, j], [e, g], -stiffness) } else { self.tie([j, i], [g, e], -stiffness) }
        }
    }

    /// Adds `factor·later·earlierᵀ` to the part of two places, which may be one.
    fn tie(&mut self, [place, other]: [usize; 2], [earlier, later]: [&Twelve<R>; 2], factor: R) {
        let Some(Part { at, stride, .. }) = self.part(other, place) else { return };
        let unknowns = |place| self.layout.pattern.unknowns(place).len();
        let (own, count) = (unknowns(place), unknowns(other));
        let scaled = later.map(|r| r * factor);
        for (column, &e) in earlier[..own].iter().enumerate() {
            let begin = at + stride * column;
            let values = &mut self.values[begin..begin + count];
            // Of a known length, so that the loop can be unrolled.
            match <&mut Twelve<R>>::try_from(&mut *values) {
                Ok(values) => add(values, &scaled, e),
                Err(_) => add(values, &scaled, e),
            }
        }
    }
}

#[inline(always)]
fn add<R: Real>(values: &mut [R], row: &Twelve<R>, factor: R) {
    for (value, &r) in values.iter_mut().zip(row) {
        *value = *value + r * factor;
    }
}

fn pull<R: Real>(force: &mut [R], row: &Twelve<R>, factor: R) {
    for (total, &r) in force.iter_mut().zip(row) {
        *total = *total + r * factor;
    }
}

/// The lower triangle of a 12 × 12 matrix, row by row.
pub(super) type Packed<R> = [R; 78];

/// Where a row and a column, which is not greater, stand in it.
pub(super) fn packed(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}
