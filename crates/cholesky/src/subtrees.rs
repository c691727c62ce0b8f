//! How threads share the work on panels: subtrees of the tree of elimination know nothing of one another.
//!
//! Where the work is cut depends on the matrix alone, and what is computed of a panel does not depend on where the cuts are: the same bits on
//! any number of threads.

use crate::pattern::Pattern;
use std::ops::Range;

/// Who shares the work. The bits are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threads {
    /// All threads of rayon's pool, where the work is worth it.
    Shared,
    /// The thread that asks, which begins no pool.
    One,
}

impl Threads {
    /// How much work is worth a thread.
    pub(super) fn worth(self, of_shared: u64) -> u64 {
        match self {
            Threads::Shared => of_shared,
            Threads::One => u64::MAX / 2,
        }
    }
}

/// The tree of elimination, and what the work on each panel costs.
pub(super) struct Subtrees<'s> {
    pattern: &'s Pattern,
    /// What all panels before each cost.
    before: Vec<u64>,
    /// Subtrees of less work than this are not worth another thread.
    worth_a_thread: u64,
}

/// How panels that follow one another, all of them with their subtrees, are worked on.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Division {
    /// One after another: they are little work.
    InTurn,
    /// From this panel on they depend on all before them, each on those before itself.
    Later(usize),
    /// Those before this panel and those from it on know nothing of one another; both are worth a thread.
    Halves(usize),
    /// The same, but the first of these two is little work.
    Little([Range<usize>; 2]),
}

impl<'s> Subtrees<'s> {
    /// `cost` tells what the work on a panel costs.
    pub(super) fn new(pattern: &'s Pattern, worth_a_thread: u64, cost: impl Fn(usize) -> u64) -> Subtrees<'s> {
        let mut before = vec![0];
        before.extend((0..pattern.panel_count()).scan(0, |sum, panel| {
            *sum += cost(panel);
            Some(*sum)
        }));
        Subtrees { pattern, before, worth_a_thread }
    }

    /// All panels.
    pub(super) fn all(&self) -> Range<usize> {
        0..self.before.len() - 1
    }

    fn cost(&self, panels: Range<usize>) -> u64 {
        self.before[panels.end] - self.before[panels.start]
    }

    /// How panels that follow one another, all of them with their subtrees, are worked on.
    pub(super) fn divide(&self, panels: Range<usize>) -> Division {
        if self.cost(panels.clone()) < 2 * self.worth_a_thread {
            return Division::InTurn;
        }
        let mut later = panels.end;
        while later > panels.start && self.pattern.subtree(later - 1) <= panels.start {
            later -= 1;
        }
        if later < panels.end {
            return Division::Later(later);
        }
        // Where the subtrees are halved best; where one side costs next to nothing, as many of these as there are.
        let mut best: Option<(u64, usize, Division)> = None;
        let mut cut = panels.end;
        loop {
            cut = self.pattern.subtree(cut - 1);
            if cut <= panels.start {
                return best.map_or(Division::InTurn, |(.., division)| division);
            }
            let mut sides = [panels.start..cut, cut..panels.end];
            // Stable, so of two as costly the earlier one comes first.
            sides.sort_by_key(|side| self.cost(side.clone()));
            let (cost, count) = (self.cost(sides[0].clone()), sides[0].len());
            if best.as_ref().is_none_or(|(most, longest, _)| (*most, *longest) < (cost, count)) {
                let worth = cost >= self.worth_a_thread;
                best = Some((cost, count, if worth { Division::Halves(cut) } else { Division::Little(sides) }));
            }
        }
    }
}
