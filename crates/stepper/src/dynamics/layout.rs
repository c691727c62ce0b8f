//! Where the unknowns of an island stand: found once, and kept while the same blocks touch one another.

use crate::dynamics::elimination_order::{Graph, Renumbered, elimination_order};
use crate::dynamics::pattern::Pattern;
use crate::dynamics::solve::{CONJUGATE_GRADIENTS_FROM, DENSE};
use std::collections::HashMap;
use std::sync::Arc;

/// The blocks of an island as nodes of the pattern of its matrix.
#[derive(Debug)]
pub(super) struct IslandLayout {
    /// The node of each block of the island.
    pub(super) places: Vec<u32>,
    pub(super) pattern: Pattern,
}

impl IslandLayout {
    /// Whether the system is solved as a dense one.
    pub(super) fn is_small(&self) -> bool {
        self.pattern.size() <= DENSE
    }

    /// Whether its factor takes so much for its size that one in f32 is made, and the solution refined.
    pub(super) fn suits_conjugate_gradients(&self) -> bool {
        self.pattern.work() >= CONJUGATE_GRADIENTS_FROM * self.pattern.values() as u64
    }
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

    fn layout(&self, at: &[[f64; 3]]) -> Option<IslandLayout> {
        let unknowns = &self.unknowns;
        if self.size() <= DENSE {
            let places = (0..unknowns.len() as u32).collect();
            return Some(IslandLayout { places, pattern: Pattern::whole(unknowns) });
        }
        let graph = Graph { unknowns, pairs: &self.pairs };
        let at: Vec<[f64; 3]> = self.blocks.iter().map(|&block| at[block as usize]).collect();
        let renumbered = Renumbered::new(graph, &elimination_order(graph, &at)?);
        let pattern = Pattern::new(renumbered.graph());
        Some(IslandLayout { places: renumbered.places, pattern })
    }
}

/// Layouts of large islands, kept from solve to solve.
#[derive(Clone, Debug)]
pub(super) struct Layouts {
    /// Where the blocks are when the scene begins (m). Not where they are now: a run that is resumed must find the same layouts.
    at: Vec<[f64; 3]>,
    known: HashMap<Couplings, (Arc<IslandLayout>, bool)>,
}

impl Layouts {
    pub(super) fn new(at: Vec<[f64; 3]>) -> Layouts {
        Layouts { at, known: HashMap::new() }
    }

    /// Forgets those that were not used since the last call.
    pub(super) fn forget_unused(&mut self) {
        self.known.retain(|_, (_, used)| std::mem::take(used));
    }

    /// The layout of an island. Small ones keep the order of the blocks. `None` when a pattern exceeds memory.
    pub(super) fn of(&mut self, couplings: &Couplings) -> Option<Arc<IslandLayout>> {
        if let Some((layout, used)) = self.known.get_mut(couplings) {
            *used = true;
            return Some(layout.clone());
        }
        let layout = Arc::new(couplings.layout(&self.at)?);
        if !layout.is_small() {
            self.known.insert(couplings.clone(), (layout.clone(), true));
        }
        Some(layout)
    }
}
