//! Groups of blocks that stand together. Conjugate gradients without a factor take each as one body as well (`two_level.rs`), so that motions of
//! many blocks are found in few products.

use crate::dynamics::system::{Lists, NO_PLACE};
use rockproof_cholesky::{Graph, Pattern, Renumbered, elimination_order};

/// A group has so many blocks at most. Four or sixteen take longer (docs/performance_changes.md).
const BLOCKS: usize = 8;

/// Groups of the blocks of an island, and where the values of their own matrix stand.
#[derive(Debug)]
pub(super) struct Groups {
    /// The group of each place; the groups have the numbers of the pattern's nodes.
    pub(super) of_place: Vec<u32>,
    /// The places of each group.
    pub(super) places: Lists,
    pub(super) pattern: Pattern,
}

impl Groups {
    /// Of a graph of blocks whose places and centroids (m) are given. `None` above 2³⁰ ties.
    pub(super) fn new(graph: Graph<'_>, places: &[u32], at: &[[f64; 3]]) -> Option<Groups> {
        let mut nodes: Vec<u32> = (0..places.len() as u32).collect();
        let mut group_of = vec![0; places.len()];
        let mut count = 0;
        let mut waiting = vec![&mut nodes[..]];
        while let Some(nodes) = waiting.pop() {
            if nodes.len() <= BLOCKS {
                nodes.iter().for_each(|&node| group_of[node as usize] = count);
                count += 1;
            } else {
                waiting.extend(halves(nodes, at));
            }
        }
        let mut unknowns = vec![12; count as usize];
        for (&group, &own) in group_of.iter().zip(graph.unknowns) {
            // Where one block has no strains, its group has none.
            unknowns[group as usize] = own.min(unknowns[group as usize]);
        }
        let groups = |pair: &[u32; 2]| {
            let [a, b] = pair.map(|node| group_of[node as usize]);
            [a.min(b), a.max(b)]
        };
        let mut pairs: Vec<[u32; 2]> = graph.pairs.iter().map(groups).filter(|[a, b]| a != b).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut centres = vec![[0.0; 3]; count as usize];
        for (&group, at) in group_of.iter().zip(at) {
            centres[group as usize] = *at;
        }
        let graph = Graph { unknowns: &unknowns, pairs: &pairs };
        let renumbered = Renumbered::new(graph, &elimination_order(graph, &centres)?);
        let mut of_place = vec![0; places.len()];
        for (&place, &group) in places.iter().zip(&group_of) {
            of_place[place as usize] = renumbered.places[group as usize];
        }
        let members: Vec<[u32; 2]> = of_place.iter().map(|&group| [group, NO_PLACE]).collect();
        let places = Lists::of_both(count as usize, &members, |group| group);
        Some(Groups { of_place, places, pattern: Pattern::new(renumbered.graph()) })
    }
}

/// Nodes cut across the axis along which they reach farthest, so that each half fills whole groups as far as it can.
fn halves<'n>(nodes: &'n mut [u32], at: &[[f64; 3]]) -> [&'n mut [u32]; 2] {
    let extent = |axis: usize| {
        let along = nodes.iter().map(|&node| at[node as usize][axis]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    let axis = (0..3).max_by(|&one, &other| extent(one).total_cmp(&extent(other))).unwrap_or(0);
    nodes.sort_unstable_by(|&a, &b| at[a as usize][axis].total_cmp(&at[b as usize][axis]).then(a.cmp(&b)));
    let groups = nodes.len().div_ceil(BLOCKS);
    let (one, other) = nodes.split_at_mut(nodes.len() * (groups / 2) / groups);
    [one, other]
}
