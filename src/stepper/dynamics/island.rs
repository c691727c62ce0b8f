//! Islands: blocks that closed contacts tie together. Each is a system of its own (SPEC section 5, `K d = F`).

use crate::stepper::dynamics::area::tangents;
use crate::stepper::dynamics::contact::Active;
use crate::stepper::dynamics::displacement::{Twelve, generalized};
use crate::stepper::dynamics::moments::Matrix;
use crate::stepper::dynamics::solve::{DENSE, Lower, Patterns, Singular, Solve, dense};
use crate::stepper::dynamics::state::Mode;
use crate::stepper::real::Real;
use std::collections::BTreeMap;

/// What a block brings into its system, without contacts.
#[derive(Clone, Debug)]
pub(super) struct Alone<R> {
    /// 12, 6 or 0.
    pub(super) unknowns: usize,
    pub(super) stiffness: Matrix<R>,
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
        patterns: &mut Patterns,
    ) -> Result<Vec<Twelve<R>>, Unsolved> {
        let mut system = System::new(&self.blocks, alone);
        for &k in &self.contacts {
            system.add(&contacts[k]);
        }
        let matrix = system.lower();
        let mut unknowns = system.right_side();
        let solved = if matrix.size() <= DENSE {
            dense(&matrix, &mut unknowns)
        } else {
            R::sparse(&matrix, &mut unknowns, patterns)
        };
        solved.map_err(|Singular { unknown }| Unsolved { block: system.block_of(unknown) })?;
        Ok(system.by_block(&unknowns))
    }
}

/// The block at which elimination failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unsolved {
    pub(super) block: usize,
}

struct System<'s, R> {
    blocks: &'s [usize],
    /// Where the unknowns of each block begin, and where the last end.
    begins: Vec<usize>,
    diagonal: Vec<Matrix<R>>,
    /// By (column, row) of the blocks' places, column < row.
    beside: BTreeMap<(usize, usize), Matrix<R>>,
    force: Vec<Twelve<R>>,
}

impl<'s, R: Real> System<'s, R> {
    fn new(blocks: &'s [usize], alone: &[Alone<R>]) -> System<'s, R> {
        let mut begins = vec![0];
        for &block in blocks {
            begins.push(begins[begins.len() - 1] + alone[block].unknowns);
        }
        System {
            blocks,
            begins,
            diagonal: blocks.iter().map(|&block| alone[block].stiffness).collect(),
            beside: BTreeMap::new(),
            force: blocks.iter().map(|&block| alone[block].force).collect(),
        }
    }

    fn add(&mut self, contact: &Active<R>) {
        let [i, j] = contact.entering().map(|block| self.blocks.binary_search(&block).ok());
        let [e, g] = contact.rows;
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
                    for (total, share) in self.force[place].iter_mut().zip(generalized(arm, force)) {
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
            product(&mut self.diagonal[i], e, e, stiffness);
            pull(&mut self.force[i], e, -stiffness * before);
        }
        if let Some(j) = j {
            product(&mut self.diagonal[j], g, g, stiffness);
            pull(&mut self.force[j], g, stiffness * before);
        }
        if let (Some(i), Some(j)) = (i, j) {
            // Rows belong to the later block.
            let (column, row, (of_row, of_column)) = if i < j { (i, j, (g, e)) } else { (j, i, (e, g)) };
            let beside = self.beside.entry((column, row)).or_insert([[R::ZERO; 12]; 12]);
            product(beside, of_row, of_column, -stiffness);
        }
    }

    fn unknowns(&self, place: usize) -> usize {
        self.begins[place + 1] - self.begins[place]
    }

    fn lower(&self) -> Lower<R> {
        let mut lower = Lower { columns: vec![0], rows: Vec::new(), values: Vec::new() };
        for place in 0..self.blocks.len() {
            let below: Vec<_> = self.beside.range((place, 0)..(place + 1, 0)).collect();
            for column in 0..self.unknowns(place) {
                for row in column..self.unknowns(place) {
                    lower.rows.push((self.begins[place] + row) as u32);
                    lower.values.push(self.diagonal[place][row][column]);
                }
                for ((_, other), matrix) in &below {
                    for (row, values) in matrix.iter().enumerate().take(self.unknowns(*other)) {
                        lower.rows.push((self.begins[*other] + row) as u32);
                        lower.values.push(values[column]);
                    }
                }
                lower.columns.push(lower.rows.len() as u32);
            }
        }
        lower
    }

    fn right_side(&self) -> Vec<R> {
        let of = |place: usize| self.force[place][..self.unknowns(place)].to_vec();
        (0..self.blocks.len()).flat_map(of).collect()
    }

    fn by_block(&self, unknowns: &[R]) -> Vec<Twelve<R>> {
        let of = |place: usize| {
            let mut d = [R::ZERO; 12];
            d[..self.unknowns(place)].copy_from_slice(&unknowns[self.begins[place]..self.begins[place + 1]]);
            d
        };
        (0..self.blocks.len()).map(of).collect()
    }

    fn block_of(&self, unknown: usize) -> usize {
        let place = self.begins.partition_point(|&begin| begin <= unknown).saturating_sub(1);
        self.blocks[place.min(self.blocks.len() - 1)]
    }
}

/// `K += factor·rows·columnsᵀ`
fn product<R: Real>(matrix: &mut Matrix<R>, rows: &Twelve<R>, columns: &Twelve<R>, factor: R) {
    for (line, &r) in matrix.iter_mut().zip(rows) {
        let scaled = r * factor;
        for (value, &c) in line.iter_mut().zip(columns) {
            *value = *value + scaled * c;
        }
    }
}

fn pull<R: Real>(force: &mut Twelve<R>, row: &Twelve<R>, factor: R) {
    for (total, &r) in force.iter_mut().zip(row) {
        *total = *total + r * factor;
    }
}
