//! Solving by the factor of a large system: forth through it, and back through its transpose.
//!
//! Threads share the subtrees of the tree of elimination (`subtrees.rs`). Forth, a panel leaves what it takes from later unknowns in its own
//! rows below, and each later panel fetches it from there, from the first panel to the last; back, a panel gives its solution to the rows below of
//! all earlier panels that need it. So each subtree has its own numbers, and no sum depends on who adds it up.

#[cfg(test)]
mod tests;

use crate::pattern::{Panel, Pattern};
use crate::subtrees::{Division, Subtrees, Threads};
use num_traits::Float;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Subtrees of fewer values than this are not worth another thread.
const WORTH_A_THREAD: u64 = 100_000;

/// [`Scalar::substitute`](crate::Scalar::substitute), compiled for a scalar where this is called.
pub(crate) fn solve<R: Float + Send + Sync>(pattern: &Pattern, values: &[R], solution: &mut [R], threads: Threads) {
    let substitution = Substitution::new(pattern, values, threads.worth(WORTH_A_THREAD));
    substitution.forth(solution);
    substitution.back(solution);
}

/// [`Scalar::forward`](crate::Scalar::forward), likewise.
pub(crate) fn divide<R: Float + Send + Sync>(pattern: &Pattern, values: &[R], solution: &mut [R]) {
    Substitution::new(pattern, values, WORTH_A_THREAD).forth(solution);
}

/// [`Scalar::backward`](crate::Scalar::backward), likewise.
pub(crate) fn divide_transposed<R: Float + Send + Sync>(pattern: &Pattern, values: &[R], solution: &mut [R]) {
    Substitution::new(pattern, values, WORTH_A_THREAD).back(solution);
}

/// What is to be done, the same for all threads.
struct Substitution<'s, R> {
    pattern: &'s Pattern,
    values: &'s [R],
    subtrees: Subtrees<'s>,
}

/// Of panels that follow one another the unknowns, and a number for each row below.
struct Numbers<'n, R> {
    own: &'n mut [R],
    below: &'n mut [R],
}

impl<R> Numbers<'_, R> {
    fn reborrow(&mut self) -> Numbers<'_, R> {
        Numbers { own: self.own, below: self.below }
    }
}

impl<'s, R: Float + Send + Sync> Substitution<'s, R> {
    /// Subtrees of fewer values than `worth` are not worth another thread.
    fn new(pattern: &'s Pattern, values: &'s [R], worth: u64) -> Substitution<'s, R> {
        let panels = pattern.panels();
        let subtrees = Subtrees::new(pattern, worth, |panel| (panels[panel].width * panels[panel].height) as u64);
        Substitution { pattern, values, subtrees }
    }

    fn forth(&self, solution: &mut [R]) {
        let mut below = vec![R::zero(); self.pattern.rows_below()];
        self.forward(self.subtrees.all(), Numbers { own: solution, below: &mut below });
    }

    fn back(&self, solution: &mut [R]) {
        let mut below = vec![R::zero(); self.pattern.rows_below()];
        self.backward(self.subtrees.all(), Numbers { own: solution, below: &mut below });
    }

    /// The numbers of some panels, which belong to those that begin with `first`, before and after another panel.
    fn split<'n>(&self, numbers: Numbers<'n, R>, first: usize, at: usize) -> [Numbers<'n, R>; 2] {
        let [first, at] = [first, at].map(|panel| &self.pattern.panels()[panel]);
        let (own, other_own) = numbers.own.split_at_mut(at.begin - first.begin);
        let (below, other_below) = numbers.below.split_at_mut(at.rows_below - first.rows_below);
        [Numbers { own, below }, Numbers { own: other_own, below: other_below }]
    }

    /// Forth through panels that are complete subtrees, to which the numbers belong.
    fn forward(&self, all: Range<usize>, mut numbers: Numbers<'_, R>) {
        let (first, mut left) = (all.start, all);
        // Panels on which all before them bear, from the last.
        let mut later = Vec::new();
        loop {
            match self.subtrees.divide(left.clone()) {
                Division::InTurn => break self.forth_in_turn(first, left, numbers.reborrow()),
                Division::Later(panel) => {
                    later.push(panel..left.end);
                    left.end = panel;
                }
                Division::Little([little, rest]) => {
                    self.forth_in_turn(first, little, numbers.reborrow());
                    left = rest;
                }
                Division::Halves(cut) => {
                    let [_, numbers] = self.split(numbers.reborrow(), first, left.start);
                    let [one, other] = self.split(numbers, left.start, cut);
                    rayon::join(|| self.forward(left.start..cut, one), || self.forward(cut..left.end, other));
                    break;
                }
            }
        }
        later.into_iter().rev().for_each(|panels| self.forth_in_turn(first, panels, numbers.reborrow()));
    }

    /// Forth through some panels, one after another. The numbers are those of panels from `first` on, of all on which these depend among them.
    fn forth_in_turn(&self, first: usize, panels: Range<usize>, numbers: Numbers<'_, R>) {
        Arch::new().dispatch(Forth(Panels { substitution: self, first, panels, numbers }));
    }

    /// Back through panels that are complete subtrees, to which the numbers belong. Their rows below have the solution of all later panels.
    fn backward(&self, all: Range<usize>, mut numbers: Numbers<'_, R>) {
        let (first, mut left) = (all.start, all);
        loop {
            match self.subtrees.divide(left.clone()) {
                Division::InTurn => return self.back_in_turn(first, left, numbers),
                Division::Later(panel) => {
                    self.back_in_turn(first, panel..left.end, numbers.reborrow());
                    left.end = panel;
                }
                Division::Little([little, rest]) => {
                    self.back_in_turn(first, little, numbers.reborrow());
                    left = rest;
                }
                Division::Halves(cut) => {
                    let [_, numbers] = self.split(numbers, first, left.start);
                    let [one, other] = self.split(numbers, left.start, cut);
                    rayon::join(|| self.backward(left.start..cut, one), || self.backward(cut..left.end, other));
                    return;
                }
            }
        }
    }

    fn back_in_turn(&self, first: usize, panels: Range<usize>, numbers: Numbers<'_, R>) {
        Arch::new().dispatch(Back(Panels { substitution: self, first, panels, numbers }));
    }
}

/// Panels to go through one after another.
struct Panels<'p, 's, 'n, R> {
    substitution: &'p Substitution<'s, R>,
    /// The first panel to which the numbers belong.
    first: usize,
    panels: Range<usize>,
    numbers: Numbers<'n, R>,
}

/// Forth through panels, by the widest instructions that the processor has. They change no bit: no sum is cut in other ways.
struct Forth<'p, 's, 'n, R>(Panels<'p, 's, 'n, R>);

impl<R: Float> WithSimd for Forth<'_, '_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Panels { substitution: Substitution { pattern, values, .. }, first, panels, numbers } = self.0;
        let first = &pattern.panels()[first];
        for k in panels {
            let panel = &pattern.panels()[k];
            let own = &mut numbers.own[panel.begin - first.begin..][..panel.width];
            let (earlier, rest) = numbers.below.split_at_mut(panel.rows_below - first.rows_below);
            for &update in pattern.updates(panel) {
                let from = &pattern.panels()[update.from as usize];
                let sums = &earlier[from.rows_below - first.rows_below..];
                for node in pattern.updating(update).0 {
                    let unknowns = pattern.unknowns(node.node as usize);
                    let own = &mut own[unknowns.start - panel.begin..unknowns.end - panel.begin];
                    for (x, &sum) in own.iter_mut().zip(&sums[node.row as usize - from.width..]) {
                        *x = *x - sum;
                    }
                }
            }
            let below = &mut rest[..panel.height - panel.width];
            for (group, columns) in values[pattern.range(k)].chunks(COLUMNS * panel.height).enumerate() {
                let begin = COLUMNS * group;
                let mut known = [R::zero(); COLUMNS];
                for (c, column) in columns.chunks_exact(panel.height).enumerate() {
                    let here = begin + c;
                    known[c] = own[here] / column[here];
                    own[here] = known[c];
                    for (x, &l) in own[here + 1..].iter_mut().zip(&column[here + 1..panel.width]) {
                        *x = *x - l * known[c];
                    }
                }
                add_columns(below, columns, panel, &known);
            }
        }
    }
}

/// Back through panels, from the last, as [`Forth`].
struct Back<'p, 's, 'n, R>(Panels<'p, 's, 'n, R>);

impl<R: Float> WithSimd for Back<'_, '_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Panels { substitution: Substitution { pattern, values, .. }, first, panels, numbers } = self.0;
        let first = &pattern.panels()[first];
        for k in panels.rev() {
            let panel = &pattern.panels()[k];
            let own = &mut numbers.own[panel.begin - first.begin..][..panel.width];
            let (earlier, rest) = numbers.below.split_at_mut(panel.rows_below - first.rows_below);
            let below = &rest[..panel.height - panel.width];
            for (group, columns) in values[pattern.range(k)].chunks(COLUMNS * panel.height).enumerate().rev() {
                let outer = dots(columns, panel, below);
                for (c, column) in columns.chunks_exact(panel.height).enumerate().rev() {
                    let here = COLUMNS * group + c;
                    let sum = own[here] - dot(&column[here + 1..panel.width], &own[here + 1..]) - outer[c];
                    own[here] = sum / column[here];
                }
            }
            for &update in pattern.updates(panel) {
                let from = &pattern.panels()[update.from as usize];
                let given = &mut earlier[from.rows_below - first.rows_below..];
                for node in pattern.updating(update).0 {
                    let unknowns = pattern.unknowns(node.node as usize);
                    let own = &own[unknowns.start - panel.begin..unknowns.end - panel.begin];
                    for (given, &x) in given[node.row as usize - from.width..].iter_mut().zip(own) {
                        *given = x;
                    }
                }
            }
        }
    }
}

/// So many columns are taken at once, since what they meet would be fetched and stored for each.
const COLUMNS: usize = 4;

/// What lies below a panel's own rows in a group of columns, if there are so many.
#[inline(always)]
fn below_of<'c, R>(columns: &'c [R], panel: &Panel) -> Option<[&'c [R]; COLUMNS]> {
    let below = |c: usize| columns.get(c * panel.height + panel.width..(c + 1) * panel.height);
    Some([below(0)?, below(1)?, below(2)?, below(3)?])
}

/// Adds what lies below a panel's own rows in some columns, each times its factor.
#[inline(always)]
fn add_columns<R: Float>(sums: &mut [R], columns: &[R], panel: &Panel, factors: &[R; COLUMNS]) {
    if let Some([a, b, c, d]) = below_of(columns, panel) {
        let products = a.iter().zip(b).zip(c.iter().zip(d));
        for (sum, ((&a, &b), (&c, &d))) in sums.iter_mut().zip(products) {
            *sum = *sum + ((a * factors[0] + b * factors[1]) + (c * factors[2] + d * factors[3]));
        }
        return;
    }
    for (column, &factor) in columns.chunks_exact(panel.height).zip(factors) {
        for (sum, &l) in sums.iter_mut().zip(&column[panel.width..]) {
            *sum = *sum + l * factor;
        }
    }
}

/// Strands of a scalar product, which do not wait for one another.
const STRANDS: usize = 8;

/// Of some columns what lies below a panel's own rows times the numbers of these rows, each added up as by [`dot`].
#[inline(always)]
fn dots<R: Float>(columns: &[R], panel: &Panel, below: &[R]) -> [R; COLUMNS] {
    let Some(columns) = below_of(columns, panel) else {
        let mut sums = [R::zero(); COLUMNS];
        for (sum, column) in sums.iter_mut().zip(columns.chunks_exact(panel.height)) {
            *sum = dot(&column[panel.width..], below);
        }
        return sums;
    };
    let mut strands = [[R::zero(); STRANDS]; COLUMNS];
    let (parts, others) = below.as_chunks::<STRANDS>();
    let [a, b, c, d] = columns.map(|column| column.as_chunks::<STRANDS>());
    for (x, ((a, b), (c, d))) in parts.iter().zip(a.0.iter().zip(b.0).zip(c.0.iter().zip(d.0))) {
        for (strands, column) in strands.iter_mut().zip([a, b, c, d]) {
            for (strand, (&l, &x)) in strands.iter_mut().zip(column.iter().zip(x)) {
                *strand = *strand + l * x;
            }
        }
    }
    let mut sums = [R::zero(); COLUMNS];
    for ((sum, strands), rest) in sums.iter_mut().zip(strands).zip([a.1, b.1, c.1, d.1]) {
        let rest = rest.iter().zip(others).fold(R::zero(), |sum, (&l, &x)| sum + l * x);
        *sum = strands.into_iter().fold(rest, |sum, strand| sum + strand);
    }
    sums
}

/// A scalar product.
#[inline(always)]
fn dot<R: Float>(a: &[R], b: &[R]) -> R {
    let mut strands = [R::zero(); STRANDS];
    let ((a, rest), (b, other)) = (a.as_chunks::<STRANDS>(), b.as_chunks::<STRANDS>());
    let rest = rest.iter().zip(other).fold(R::zero(), |sum, (&a, &b)| sum + a * b);
    for (a, b) in a.iter().zip(b) {
        for (strand, (&a, &b)) in strands.iter_mut().zip(a.iter().zip(b)) {
            *strand = *strand + a * b;
        }
    }
    strands.into_iter().fold(rest, |sum, strand| sum + strand)
}
