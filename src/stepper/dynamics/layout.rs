//! Where the unknowns of an island stand, and the pattern of its matrix: found once, and kept while the same blocks are tied together.

use crate::stepper::dynamics::solve::{DENSE, Factor, elimination_order};
use std::collections::HashMap;
use std::sync::Arc;

/// The blocks of an island in the order of elimination, and the lower triangle of its matrix by columns. Everything here counts
/// *places*: the first block eliminated has place 0.
#[derive(Debug)]
pub(super) struct Layout {
    /// The place of each block of the island.
    pub(super) places: Vec<u32>,
    /// Where the unknowns of each place begin, and where the last end.
    begins: Vec<u32>,
    /// The ties of each place begin here in `later`.
    ties: Vec<u32>,
    /// The later places to which each is tied, ascending; and how many rows of the earlier of them stand before theirs in a column.
    later: Vec<[u32; 2]>,
    /// As in [`crate::stepper::dynamics::solve::Lower`].
    pub(super) columns: Vec<u32>,
    pub(super) rows: Vec<u32>,
    /// Of systems too large for a dense solution.
    pub(super) factor: Option<Factor>,
}

/// What a layout follows from: for each block of an island the number of its unknowns, and pairs of blocks that are tied together, by
/// their numbers within the island, ascending, the lower number first.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Ties {
    pub(super) unknowns: Vec<u8>,
    pub(super) pairs: Vec<[u32; 2]>,
}

impl Ties {
    fn size(&self) -> usize {
        self.unknowns.iter().map(|&n| usize::from(n)).sum()
    }
}

/// Layouts of large islands, kept from solve to solve.
#[derive(Clone, Debug, Default)]
pub(super) struct Layouts {
    known: HashMap<Ties, (Arc<Layout>, bool)>,
}

impl Layouts {
    /// Forgets those that were not used since the last call.
    pub(super) fn forget_unused(&mut self) {
        self.known.retain(|_, (_, used)| std::mem::take(used));
    }

    /// The layout of an island. Small ones keep the order of the blocks. `None` when a pattern exceeds memory.
    pub(super) fn of(&mut self, ties: Ties) -> Option<Arc<Layout>> {
        if ties.size() <= DENSE {
            let order = (0..ties.unknowns.len() as u32).collect();
            return Some(Arc::new(Layout::new(&ties, order)));
        }
        if let Some((layout, used)) = self.known.get_mut(&ties) {
            *used = true;
            return Some(layout.clone());
        }
        let mut layout = Layout::new(&ties, block_order(&ties)?);
        layout.factor = Some(Factor::new(&layout.columns, &layout.rows)?);
        let layout = Arc::new(layout);
        self.known.insert(ties, (layout.clone(), true));
        Some(layout)
    }
}

/// The order of elimination of the blocks: all unknowns of a block follow one another, so this is found among blocks, of which there are
/// twelve times fewer.
fn block_order(ties: &Ties) -> Option<Vec<u32>> {
    let (columns, rows) = lists(ties.unknowns.len(), &ties.pairs);
    elimination_order(&columns, &rows)
}

/// For each first number of the pairs, which ascend, where its second numbers begin and end.
fn lists(count: usize, pairs: &[[u32; 2]]) -> (Vec<u32>, Vec<u32>) {
    let mut begins = vec![0; count + 1];
    for &[first, _] in pairs {
        begins[first as usize + 1] += 1;
    }
    for k in 0..count {
        begins[k + 1] += begins[k];
    }
    (begins, pairs.iter().map(|&[_, second]| second).collect())
}

impl Layout {
    fn new(ties: &Ties, order: Vec<u32>) -> Layout {
        let count = order.len();
        let mut places = vec![0; count];
        for (place, &block) in (0..).zip(&order) {
            places[block as usize] = place;
        }
        let unknowns = |place: u32| u32::from(ties.unknowns[order[place as usize] as usize]);
        let mut begins = vec![0];
        begins.extend((0..count as u32).scan(0, |end, place| {
            *end += unknowns(place);
            Some(*end)
        }));
        let placed = |[a, b]: [u32; 2]| [places[a as usize], places[b as usize]];
        let mut pairs: Vec<[u32; 2]> =
            ties.pairs.iter().map(|&pair| placed(pair)).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        pairs.sort_unstable();
        let (starts, seconds) = lists(count, &pairs);
        let mut later = Vec::with_capacity(seconds.len());
        let (mut columns, mut rows) = (vec![0], Vec::new());
        for place in 0..count {
            let tied = &seconds[starts[place] as usize..starts[place + 1] as usize];
            let mut before = 0;
            for &other in tied {
                later.push([other, before]);
                before += unknowns(other);
            }
            let (begin, end) = (begins[place], begins[place + 1]);
            for column in begin..end {
                rows.extend(column..end);
                rows.extend(tied.iter().flat_map(|&other| begins[other as usize]..begins[other as usize + 1]));
                columns.push(rows.len() as u32);
            }
        }
        Layout { places, begins, ties: starts, later, columns, rows, factor: None }
    }

    /// The number of unknowns.
    pub(super) fn size(&self) -> usize {
        self.columns.len() - 1
    }

    /// The unknowns of a place.
    pub(super) fn unknowns(&self, place: usize) -> std::ops::Range<usize> {
        self.begins[place] as usize..self.begins[place + 1] as usize
    }

    /// The place that holds an unknown.
    pub(super) fn place_of(&self, unknown: usize) -> usize {
        self.begins.partition_point(|&begin| begin as usize <= unknown).saturating_sub(1)
    }

    /// Where the value in the first row of a diagonal part stands, that is the diagonal of this column of the place.
    pub(super) fn diagonal(&self, place: usize, column: usize) -> usize {
        self.columns[self.begins[place] as usize + column] as usize
    }

    /// How far behind the end of the diagonal part of `place` the rows of `other`, a later place tied to it, begin in every column.
    pub(super) fn beside(&self, place: usize, other: usize) -> Option<usize> {
        let tied = &self.later[self.ties[place] as usize..self.ties[place + 1] as usize];
        let found = tied.binary_search_by_key(&(other as u32), |&[other, _]| other).ok()?;
        Some(tied[found][1] as usize)
    }
}
