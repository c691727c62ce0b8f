//! The factor of a large system, panel by panel along the tree of elimination.
//!
//! Subtrees know nothing of one another, of wide panels the columns are gathered by parts, and of high ones the rows below are divided by
//! parts, so threads can share the work. What is computed of a panel does not depend on who computes it, nor on how many there are: the same bits on
//! any number of threads.

use crate::kernels::{Columns, Packed, RowProducts, divide_rows, factor_square};
use crate::pattern::{Panel, PanelRow, Pattern};
use crate::subtrees::{Division, Subtrees, Threads};
use num_traits::Float;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::ops::Range;

/// A pivot that is not positive and finite: the system is singular, or became so by rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular {
    /// The unknown.
    pub unknown: usize,
}

/// Adds the values of a matrix in a panel, given by number, to the panel's own.
pub type Fill<'f, R> = dyn Fn(usize, &mut [R]) + Sync + 'f;

/// Subtrees of less work than this, in multiplications, are not worth another thread.
const WORTH_A_THREAD: u64 = 1_000_000;

/// The columns of a panel that is wider than this are gathered by parts of about so many.
const PART: usize = 48;

/// So many rows of products are worked out, and so many rows below a panel's square divided by its factor, at a time.
const ROWS: usize = 96;

/// [`Scalar::factor`](crate::Scalar::factor), compiled for a scalar where this is called.
pub(crate) fn factor_panels<R: Float + Send + Sync>(
    pattern: &Pattern,
    values: &mut [R],
    marked: &[bool],
    fill: &Fill<'_, R>,
    threads: Threads,
) -> Result<(), Singular> {
    let cost = |panel: usize| {
        let Panel { width, height, .. } = pattern.panels()[panel];
        if marked[panel] { (width * height * height) as u64 } else { 0 }
    };
    let work = Work { pattern, marked, fill, subtrees: Subtrees::new(pattern, threads.worth(WORTH_A_THREAD), cost) };
    work.forest(work.subtrees.all(), Values { numbers: values, base: 0 }).map_or(Ok(()), Err)
}

/// What is to be done, the same for all threads.
struct Work<'w, R> {
    pattern: &'w Pattern,
    marked: &'w [bool],
    fill: &'w Fill<'w, R>,
    subtrees: Subtrees<'w>,
}

/// The values of panels that follow one another.
struct Values<'v, R> {
    numbers: &'v mut [R],
    /// The place of the first among the values of all panels.
    base: usize,
}

impl<R: Float + Send + Sync> Work<'_, R> {
    /// Does panels that are complete subtrees. Tells the first that failed.
    fn forest(&self, all: Range<usize>, values: Values<'_, R>) -> Option<Singular> {
        let mut left = all;
        // Panels on which all before them bear, from the last.
        let mut later = Vec::new();
        let mut failed = None;
        let Values { numbers, base } = values;
        loop {
            let (found, ended) = match self.subtrees.divide(left.clone()) {
                Division::InTurn => (self.in_turn(left.clone(), numbers, base, false), true),
                Division::Later(panel) => {
                    later.push(panel..left.end);
                    left.end = panel;
                    continue;
                }
                Division::Little([little, rest]) => {
                    left = rest;
                    (self.in_turn(little, numbers, base, false), false)
                }
                Division::Halves(cut) => {
                    let at = |panel: usize| self.pattern.range(panel).start - base;
                    let (one, other) = numbers[..self.pattern.range(left.end - 1).end - base].split_at_mut(at(cut));
                    let one = Values { numbers: one, base };
                    let other = Values { numbers: other, base: at(cut) + base };
                    let (one, other) =
                        rayon::join(|| self.forest(left.start..cut, one), || self.forest(cut..left.end, other));
                    (earlier(one, other), true)
                }
            };
            failed = earlier(failed, found);
            if ended {
                break;
            }
        }
        failed.or_else(|| self.in_turn(later.into_iter().rev().flatten(), numbers, base, true))
    }

    /// Does panels one after another. `shared` says whether threads may share a wide one.
    fn in_turn(
        &self,
        panels: impl Iterator<Item = usize>,
        numbers: &mut [R],
        base: usize,
        shared: bool,
    ) -> Option<Singular> {
        let mut room = Room::default();
        panels
            .filter(|&panel| self.marked[panel])
            .find_map(|panel| self.panel(panel, numbers, base, shared, &mut room).err())
    }

    fn panel(
        &self,
        number: usize,
        numbers: &mut [R],
        base: usize,
        shared: bool,
        room: &mut Room<R>,
    ) -> Result<(), Singular> {
        let panel = &self.pattern.panels()[number];
        let (earlier, rest) = numbers.split_at_mut(panel.values - base);
        let own = &mut rest[..panel.height * panel.width];
        own.fill(R::zero());
        (self.fill)(number, own);
        let parts = parts(self.pattern, panel);
        let take = |columns: &mut [R], part: &Range<usize>, room: &mut Room<R>| {
            Taking { pattern: self.pattern, panel, part: part.clone(), earlier, base }.take(columns, room);
        };
        if parts.len() > 1 {
            let mut rest = &mut own[..];
            let mut all = Vec::with_capacity(parts.len());
            for part in &parts {
                let (columns, other) = std::mem::take(&mut rest).split_at_mut(panel.height * part.len());
                all.push((columns, part));
                rest = other;
            }
            if shared {
                all.into_par_iter().for_each(|(columns, part)| take(columns, part, &mut Room::default()));
            } else {
                all.into_iter().for_each(|(columns, part)| take(columns, part, room));
            }
        } else {
            take(own, &(0..panel.width), room);
        }
        self.factor_panel(panel, own, shared).map_err(|unknown| Singular { unknown: panel.begin + unknown })
    }

    /// Factors the square of a panel and divides the rows below by the factor, some rows at a time. Tells the first pivot that is not positive and finite.
    fn factor_panel(&self, panel: &Panel, own: &mut [R], shared: bool) -> Result<(), usize> {
        let count = (panel.height - panel.width).div_ceil(ROWS);
        let mut square = Vec::with_capacity(panel.width);
        let mut below: Vec<Vec<&mut [R]>> = (0..count).map(|_| Vec::with_capacity(panel.width)).collect();
        for column in own.chunks_exact_mut(panel.height) {
            let (inner, outer) = column.split_at_mut(panel.width);
            square.push(inner);
            below.iter_mut().zip(outer.chunks_mut(ROWS)).for_each(|(rows, part)| rows.push(part));
        }
        factor_square(&mut square)?;
        let square: Vec<&[R]> = square.iter().map(|column| &**column).collect();
        if shared {
            below.par_iter_mut().for_each(|rows| divide_rows(&square, rows));
        } else {
            below.iter_mut().for_each(|rows| divide_rows(&square, rows));
        }
        Ok(())
    }
}

/// Of two that failed the earlier one.
fn earlier(one: Option<Singular>, other: Option<Singular>) -> Option<Singular> {
    one.into_iter().chain(other).min_by_key(|failed| failed.unknown)
}

/// The columns of a panel by parts, each of whole nodes.
fn parts(pattern: &Pattern, panel: &Panel) -> Vec<Range<usize>> {
    let (mut parts, mut begin, mut end) = (Vec::new(), 0, 0);
    let mut node = pattern.node_of(panel.begin);
    while end < panel.width {
        end += pattern.unknowns(node).len();
        node += 1;
        if end - begin >= PART || end >= panel.width {
            parts.push(begin..end);
            begin = end;
        }
    }
    parts
}

/// Memory for products, used again and again.
struct Room<R> {
    products: Vec<R>,
    packed: Packed<R>,
    columns: Vec<Run>,
    rows: Vec<Run>,
    /// Those of the rows of which the products are worked out.
    part: Vec<Run>,
}

impl<R> Default for Room<R> {
    fn default() -> Room<R> {
        Room {
            products: Vec::new(),
            packed: Packed::default(),
            columns: Vec::new(),
            rows: Vec::new(),
            part: Vec::new(),
        }
    }
}

/// Subtracting `L Lᵀ` of the earlier panels from columns of a panel.
struct Taking<'t, R> {
    pattern: &'t Pattern,
    panel: &'t Panel,
    /// The columns.
    part: Range<usize>,
    earlier: &'t [R],
    /// Where the values of the earlier panels begin among all.
    base: usize,
}

impl<R: Float> Taking<'_, R> {
    fn take(&self, columns: &mut [R], room: &mut Room<R>) {
        for &update in self.pattern.updates(self.panel) {
            let from = &self.pattern.panels()[update.from as usize];
            let (inside, after) = self.pattern.updating(update);
            let column = |below: &PanelRow| self.pattern.unknowns(below.node as usize).start - self.panel.begin;
            let begin = inside.partition_point(|below| column(below) < self.part.start);
            let end = inside.partition_point(|below| column(below) < self.part.end);
            if begin < end {
                self.take_from(from, [&inside[begin..end], &inside[end..], after], columns, room);
            }
        }
    }

    /// Of an earlier panel: its rows in these columns, in later ones of the same panel, and in later panels. Products are worked out and
    /// subtracted some rows at a time: they, and what the kernels pack for them, stay in the cache and take little memory.
    fn take_from(
        &self,
        from: &Panel,
        [inside, beside, after]: [&[PanelRow]; 3],
        columns: &mut [R],
        room: &mut Room<R>,
    ) {
        let (pattern, panel) = (self.pattern, self.panel);
        let first = inside[0].row as usize;
        let end = beside.first().or(after.first()).map_or(from.height, |below| below.row as usize);
        let (height, width) = (from.height - first, end - first);
        let Room { products, packed, columns: across, rows, part } = room;
        across.clear();
        rows.clear();
        let column = |below: &PanelRow| pattern.unknowns(below.node as usize).start - panel.begin;
        let count = |below: &PanelRow| pattern.unknowns(below.node as usize).len();
        for below in inside {
            add_run(across, below.row as usize - first, column(below) - self.part.start, count(below));
        }
        let own = inside.iter().chain(beside).map(|below| (below, column(below)));
        let mut below = pattern.below(panel).iter();
        let later = after.iter().filter_map(|node| {
            let found = below.find(|below| below.node == node.node)?;
            Some((node, found.row as usize))
        });
        for (node, row) in own.chain(later) {
            add_run(rows, node.row as usize - first, row, count(node));
        }
        let values = from.values - self.base;
        let values = &self.earlier[values..values + from.height * from.width];
        let factor = Columns { values, height: from.height };
        packed.pack_across(factor, first..first + width);
        let mut begin = 0;
        while begin < height {
            let end = height.min(begin + ROWS);
            // What lies above the diagonal means nothing.
            let (count, width) = (end - begin, width.min(end));
            if products.len() < count * width {
                products.resize(count * width, R::zero());
            }
            let products = &mut products[..count * width];
            RowProducts {
                columns: factor,
                rows: first + begin..first + end,
                across: first..first + width,
                into: &mut *products,
                packed,
            }
            .calculate();
            part.clear();
            part.extend(rows.iter().filter_map(|run| run.within(begin, end)));
            Arch::new().dispatch(Subtracting {
                from: products,
                height: count,
                into: columns,
                into_height: panel.height,
                columns: across,
                rows: part,
            });
            begin = end;
        }
    }
}

/// Rows or columns that follow one another both in products and where they are subtracted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Run {
    /// The first in the products.
    here: usize,
    /// Where it is subtracted.
    there: usize,
    count: usize,
}

impl Run {
    /// What stands between two rows of the products, numbered from the first of these.
    fn within(self, begin: usize, end: usize) -> Option<Run> {
        let (first, last) = (self.here.max(begin), (self.here + self.count).min(end));
        (first < last).then(|| Run {
            here: first - begin,
            there: self.there + (first - self.here),
            count: last - first,
        })
    }
}

/// Adds rows or columns to those before them.
fn add_run(runs: &mut Vec<Run>, here: usize, there: usize, count: usize) {
    match runs.last_mut() {
        Some(last) if last.here + last.count == here && last.there + last.count == there => last.count += count,
        _ => runs.push(Run { here, there, count }),
    }
}

/// Subtracting products from columns of a panel.
struct Subtracting<'s, R> {
    from: &'s [R],
    height: usize,
    into: &'s mut [R],
    into_height: usize,
    columns: &'s [Run],
    rows: &'s [Run],
}

impl<R: Float> WithSimd for Subtracting<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for columns in self.columns {
            let from = self.from.chunks_exact(self.height).skip(columns.here).take(columns.count);
            let into = self.into.chunks_exact_mut(self.into_height).skip(columns.there);
            for (from, into) in from.zip(into) {
                for &Run { here, there, count } in self.rows {
                    // What lies above the diagonal means nothing.
                    for (value, &product) in into[there..there + count].iter_mut().zip(&from[here..here + count]) {
                        *value = *value - product;
                    }
                }
            }
        }
    }
}
