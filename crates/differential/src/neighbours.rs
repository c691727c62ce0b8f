//! Which blocks of a model may touch.

use rockproof_model::{Block, ToleranceSet};

/// Pairs of blocks whose boxes, grown by `search`, may meet, in order: a sort along x and a sweep. Boxes are those of the
/// nearest f64, widened by more than rounding can have taken, so no neighbours are lost; the engine decides.
pub fn neighbours(blocks: &[&Block], tolerances: &ToleranceSet) -> Vec<(usize, usize)> {
    let search = tolerances.search.approximate();
    let range = |block: &Block, axis: usize| {
        let values = || block.vertices().iter().map(|v| v.components()[axis].approximate());
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        (low.next_down(), (high + search).next_up().next_up().next_up())
    };
    let boxes: Vec<[(f64, f64); 3]> = blocks.iter().map(|b| [range(b, 0), range(b, 1), range(b, 2)]).collect();
    let mut order: Vec<usize> = (0..blocks.len()).collect();
    order.sort_by(|&i, &j| boxes[i][0].0.total_cmp(&boxes[j][0].0));
    let mut pairs = Vec::new();
    let mut active: Vec<usize> = Vec::new();
    for &i in &order {
        active.retain(|&j| boxes[j][0].1 >= boxes[i][0].0);
        for &j in &active {
            if (1..3).all(|k| boxes[i][k].0 <= boxes[j][k].1 && boxes[j][k].0 <= boxes[i][k].1) {
                pairs.push((i.min(j), i.max(j)));
            }
        }
        active.push(i);
    }
    pairs.sort_unstable();
    pairs
}
