//! Where the unknowns of an island stand: found once, and kept while the same blocks touch one another.

use crate::dynamics::groups::Groups;
use crate::dynamics::solve::{CONJUGATE_GRADIENTS_FROM, DENSE};
use rockproof_cholesky::{Graph, Pattern, Renumbered, elimination_order};
use rockproof_model::simulation::Solver;
use std::collections::HashMap;
use std::sync::Arc;

/// The blocks of an island as nodes of the pattern of its matrix.
#[derive(Debug)]
pub(super) struct IslandLayout {
    /// The node of each block of the island.
    pub(super) places: Vec<u32>,
    pub(super) pattern: Pattern,
    /// Groups of its blocks, where conjugate gradients without a factor are tried.
    pub(super) groups: Option<Groups>,
    /// What solves it, unless it is solved as it always is in the scalar.
    pub(super) solver: Option<Solver>,
}

impl IslandLayout {
    /// Whether the system is solved as a dense one.
    pub(super) fn is_small(&self) -> bool {
        self.pattern.size() <= DENSE
    }

    /// Whether it is solved by conjugate gradients, with a factor in f32 or without one, so that the solution before bears on last bits.
    pub(super) fn is_iterative(&self) -> bool {
        self.groups.is_some() || self.solver.is_some() && is_very_large(&self.pattern)
    }
}

/// Whether a factor takes so much for its size that one in f32 is made, and the solution refined.
fn is_very_large(pattern: &Pattern) -> bool {
    pattern.work() >= CONJUGATE_GRADIENTS_FROM * pattern.values() as u64
}

/// What a layout follows from: the blocks of an island, ascending, the number of unknowns of each, and pairs of them that touch, by their
/// places in the list, ascending, the lower one first. Whether a contact is open makes no difference, so that modes may change.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Couplings {
    pub(super) blocks: Vec<u32>,
    pub(super) unknowns: Vec<u8>,
    pub(super) pairs: Vec<[u32; 2]>,
}

impl Couplings {
    fn size(&self) -> usize {
        self.unknowns.iter().map(|&n| usize::from(n)).sum()
    }

    fn layout(&self, at: &[[f64; 3]], solver: Option<Solver>) -> Option<IslandLayout> {
        let unknowns = &self.unknowns;
        if self.size() <= DENSE {
            let places = (0..unknowns.len() as u32).collect();
            return Some(IslandLayout { places, pattern: Pattern::whole(unknowns), groups: None, solver: None });
        }
        let graph = Graph { unknowns, pairs: &self.pairs };
        let at: Vec<[f64; 3]> = self.blocks.iter().map(|&block| at[block as usize]).collect();
        let renumbered = Renumbered::new(graph, &elimination_order(graph, &at)?);
        let pattern = Pattern::new(renumbered.graph());
        let grouped = match solver {
            None | Some(Solver::Factor) => false,
            Some(Solver::Auto) => is_very_large(&pattern),
            Some(Solver::ConjugateGradients) => true,
        };
        let groups = if grouped { Some(Groups::new(graph, &renumbered.places, &at)?) } else { None };
        Some(IslandLayout { places: renumbered.places, pattern, groups, solver })
    }
}

/// Layouts of large islands, kept from solve to solve.
#[derive(Clone, Debug)]
pub(super) struct Layouts {
    /// Where the blocks are when the scene begins (m). Not where they are now: a run that is resumed must find the same layouts.
    at: Vec<[f64; 3]>,
    /// What solves large systems, where the scalar leaves a choice.
    solver: Option<Solver>,
    known: HashMap<Couplings, (Arc<IslandLayout>, bool)>,
}

impl Layouts {
    pub(super) fn new(at: Vec<[f64; 3]>, solver: Option<Solver>) -> Layouts {
        Layouts { at, solver, known: HashMap::new() }
    }

    /// Forgets those that were not used since the last call.
    pub(super) fn forget_unused(&mut self) {
        self.known.retain(|_, (_, used)| std::mem::take(used));
    }

    /// The layout of an island. Small ones keep the order of the blocks. `None` above 2³⁰ ties.
    pub(super) fn of(&mut self, couplings: &Couplings) -> Option<Arc<IslandLayout>> {
        if let Some((layout, used)) = self.known.get_mut(couplings) {
            *used = true;
            return Some(layout.clone());
        }
        let layout = Arc::new(couplings.layout(&self.at, self.solver)?);
        if !layout.is_small() {
            self.known.insert(couplings.clone(), (layout.clone(), true));
        }
        Some(layout)
    }
}
