//! Islands: blocks that closed contacts tie together. Each is a system of its own (SPEC section 5, `K d = F`).

use crate::stepper::dynamics::area::tangents;
use crate::stepper::dynamics::contact::Active;
use crate::stepper::dynamics::displacement::{Twelve, generalized};
use crate::stepper::dynamics::layout::{Layout, Layouts, Ties};
use crate::stepper::dynamics::solve::{Lower, Singular, Solve, dense};
use crate::stepper::dynamics::state::Mode;
use crate::stepper::real::Real;

/// What a block brings into its system, without contacts.
#[derive(Clone, Debug)]
pub(super) struct Alone<R> {
    /// 12, 6 or 0.
    pub(super) unknowns: usize,
    pub(super) stiffness: Packed<R>,
    pub(super) force: Twelve<R>,
}

/// Blocks, ascending, and the closed contacts between them and to fixed blocks.
#[derive(Clone, Debug, Default)]
pub(super) struct Island {
    pub(super) blocks: Vec<usize>,
    pub(super) contacts: Vec<usize>,
}

/// The islands, by their lowest block.
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
    let mut place = vec![usize::MAX; unknowns.len()];
    let mut all: Vec<Island> = Vec::new();
    for block in (0..unknowns.len()).filter(|&block| unknowns[block] > 0) {
        let lowest = find(&mut root, block);
        if lowest == block {
            place[block] = all.len();
            all.push(Island::default());
        }
        all[place[lowest]].blocks.push(block);
    }
    for (k, contact) in closed() {
        let [a, b] = contact.blocks.map(|block| block as usize);
        let moving = if unknowns[a] > 0 { a } else { b };
        all[place[find(&mut root, moving)]].contacts.push(k);
    }
    all
}

impl Island {
    /// The displacements of its blocks: twelve numbers each, zero where a block has no such unknown.
    pub(super) fn solve<R: Solve>(
        &self,
        alone: &[Alone<R>],
        contacts: &[Active<R>],
        layouts: &mut Layouts,
    ) -> Result<Vec<Twelve<R>>, Unsolved> {
        let first = Unsolved { block: self.blocks[0] };
        let layout = layouts.of(self.ties(alone, contacts)).ok_or(first)?;
        let mut system = System::new(&self.blocks, &layout, alone);
        for &k in &self.contacts {
            system.add(&contacts[k]);
        }
        let matrix = Lower { columns: &layout.columns, rows: &layout.rows, values: &system.values };
        let solved = match &layout.factor {
            None => dense(matrix, &mut system.force),
            Some(factor) => R::sparse(matrix, factor, &mut system.force),
        };
        solved.map_err(|Singular { unknown }| {
            let place = layout.place_of(unknown);
            let block = layout.places.iter().position(|&p| p as usize == place);
            Unsolved { block: self.blocks[block.unwrap_or(0)] }
        })?;
        Ok(system.by_block())
    }

    /// Which of its blocks contacts tie together.
    fn ties<R: Real>(&self, alone: &[Alone<R>], contacts: &[Active<R>]) -> Ties {
        let within = |block: u32| self.blocks.binary_search(&(block as usize)).ok();
        let pair = |&k: &usize| {
            let [a, b] = contacts[k].blocks.map(within);
            Some([a? as u32, b? as u32])
        };
        let mut pairs: Vec<[u32; 2]> = self.contacts.iter().filter_map(pair).collect();
        pairs.sort_unstable();
        pairs.dedup();
        Ties { unknowns: self.blocks.iter().map(|&block| alone[block].unknowns as u8).collect(), pairs }
    }
}

/// The block at which elimination failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unsolved {
    pub(super) block: usize,
}

struct System<'s, R> {
    blocks: &'s [usize],
    layout: &'s Layout,
    /// Of the lower triangle, as the layout has it.
    values: Vec<R>,
    force: Vec<R>,
}

impl<'s, R: Real> System<'s, R> {
    fn new(blocks: &'s [usize], layout: &'s Layout, alone: &[Alone<R>]) -> System<'s, R> {
        let mut system =
            System { blocks, layout, values: vec![R::ZERO; layout.rows.len()], force: vec![R::ZERO; layout.size()] };
        for (&block, &place) in blocks.iter().zip(&layout.places) {
            let (alone, place) = (&alone[block], place as usize);
            let unknowns = layout.unknowns(place);
            system.force[unknowns.clone()].copy_from_slice(&alone.force[..unknowns.len()]);
            for column in 0..unknowns.len() {
                let diagonal = layout.diagonal(place, column);
                for row in column..unknowns.len() {
                    system.values[diagonal + row - column] = alone.stiffness[packed(row, column)];
                }
            }
        }
        system
    }

    fn add(&mut self, contact: &Active<R>) {
        let place = |block: usize| self.blocks.binary_search(&block).ok().map(|k| self.layout.places[k] as usize);
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
                let force = contact.now.slip_force;
                for (place, arm, force) in [(i, contact.arms[0], -force), (j, contact.arms[1], force)] {
                    let Some(place) = place else { continue };
                    let share = generalized(arm, force);
                    for (total, share) in self.force[self.layout.unknowns(place)].iter_mut().zip(share) {
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
            self.own(i, e, stiffness);
            pull(&mut self.force[self.layout.unknowns(i)], e, -stiffness * before);
        }
        if let Some(j) = j {
            self.own(j, g, stiffness);
            pull(&mut self.force[self.layout.unknowns(j)], g, stiffness * before);
        }
        if let (Some(i), Some(j)) = (i, j) {
            // Rows belong to the later place.
            if i < j { self.beside([i, j], [e, g], -stiffness) } else { self.beside([j, i], [g, e], -stiffness) }
        }
    }

    /// Adds `factor·rows·rowsᵀ` to the diagonal part of a place.
    fn own(&mut self, place: usize, rows: &Twelve<R>, factor: R) {
        let count = self.layout.unknowns(place).len();
        let scaled = rows.map(|r| r * factor);
        for column in 0..count {
            let diagonal = self.layout.diagonal(place, column);
            let values = &mut self.values[diagonal..diagonal + count - column];
            for (value, &r) in values.iter_mut().zip(&scaled[column..]) {
                *value = *value + r * rows[column];
            }
        }
    }

    /// Adds `factor·later·earlierᵀ` to the part that ties two places together.
    fn beside(&mut self, [place, other]: [usize; 2], [earlier, later]: [&Twelve<R>; 2], factor: R) {
        let Some(behind) = self.layout.beside(place, other) else { return };
        let (own, count) = (self.layout.unknowns(place).len(), self.layout.unknowns(other).len());
        let scaled = later.map(|r| r * factor);
        for (column, &e) in earlier.iter().enumerate().take(own) {
            let begin = self.layout.diagonal(place, column) + own - column + behind;
            for (value, &r) in self.values[begin..begin + count].iter_mut().zip(&scaled) {
                *value = *value + r * e;
            }
        }
    }

    fn by_block(&self) -> Vec<Twelve<R>> {
        let of = |&place: &u32| {
            let unknowns = self.layout.unknowns(place as usize);
            let mut d = [R::ZERO; 12];
            d[..unknowns.len()].copy_from_slice(&self.force[unknowns]);
            d
        };
        self.layout.places.iter().map(of).collect()
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
