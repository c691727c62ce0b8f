//! Axis-parallel boxes: which meet, by a tree ([`BoxTree`]), and whether two blocks' boxes share more than their surfaces.

use crate::PreparedBlock;
use rockproof_model::{Block, Number, VertexId};

/// A box in f64 that certainly holds a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Box3 {
    low: [f64; 3],
    high: [f64; 3],
}

/// Boxes in a leaf of the tree.
const LEAF: usize = 8;

/// A part of the boxes, ordered so that it is a range of them.
struct Node {
    bounds: Box3,
    range: [usize; 2],
    /// The two halves; none of a leaf.
    halves: Option<[usize; 2]>,
}

/// Boxes in a tree, to find those that meet another without asking all.
pub(crate) struct BoxTree {
    boxes: Vec<Box3>,
    /// The numbers of the boxes, so ordered that those of a node are a range.
    order: Vec<usize>,
    /// The root is the last.
    nodes: Vec<Node>,
}

impl Box3 {
    /// The box between two ends of each axis.
    pub(crate) fn between(ends: [[f64; 2]; 3]) -> Box3 {
        Box3 { low: ends.map(|[low, _]| low), high: ends.map(|[_, high]| high) }
    }

    /// The box of a block, grown by `margin` to all sides and rounded outwards.
    pub(crate) fn around(prepared: &PreparedBlock, margin: f64) -> Box3 {
        // Once for coordinates rounded to f64, once for the difference.
        let low = prepared.box_min.map(|c| (c.next_down() - margin).next_down());
        let high = prepared.box_max.map(|c| (c.next_up() + margin).next_up());
        Box3 { low, high }
    }

    /// The box of points whose coordinates are these f64, exactly.
    pub(crate) fn of_points(points: &[[f64; 3]]) -> Box3 {
        let ends = |from: f64, pick: fn(f64, f64) -> f64| {
            std::array::from_fn(|k| points.iter().fold(from, |end, point| pick(end, point[k])))
        };
        Box3 { low: ends(f64::INFINITY, f64::min), high: ends(f64::NEG_INFINITY, f64::max) }
    }

    /// Whether the boxes share more than their surfaces. **Boxes that touch do not.**
    pub(crate) fn overlaps(&self, other: &Box3) -> bool {
        (0..3).all(|k| self.low[k] < other.high[k] && other.low[k] < self.high[k])
    }

    /// At least the distance of any two of its points.
    pub(crate) fn span(&self) -> f64 {
        // Two roundings of a length each; the sum of the sides is no shorter than the diagonal.
        (0..3).map(|k| self.high[k] - self.low[k]).sum::<f64>() * (1.0 + 8.0 * f64::EPSILON)
    }

    /// The box of blocks together, rounded outwards.
    pub(crate) fn of_blocks(blocks: [&Block; 2]) -> Box3 {
        let [one, two] = blocks.map(|block| {
            let bounds = block.bounds();
            let [low, high] = [bounds.min, bounds.max].map(|end| end.map(|c| c.approximate()));
            Box3 { low: [low.x, low.y, low.z].map(f64::next_down), high: [high.x, high.y, high.z].map(f64::next_up) }
        });
        one.with(&two)
    }

    /// Whether the boxes share a point, **touching included**.
    pub(crate) fn meets(&self, other: &Box3) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    fn with(&self, other: &Box3) -> Box3 {
        Box3 {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Twice the middle along an axis.
    fn middle(&self, axis: usize) -> f64 {
        self.low[axis] + self.high[axis]
    }
}

/// The pairs of boxes that meet, **touching included**, the lower number first, in no particular order.
pub(crate) fn meeting_pairs(boxes: &[Box3]) -> Vec<[usize; 2]> {
    let tree = BoxTree::new(boxes.to_vec());
    let mut found = Vec::new();
    if let Some(root) = tree.root() {
        visit(&tree, [root, root], &mut found);
    }
    found
}

impl BoxTree {
    pub(crate) fn new(boxes: Vec<Box3>) -> BoxTree {
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        let mut nodes = Vec::new();
        if !boxes.is_empty() {
            build(&boxes, &mut order, 0, &mut nodes);
        }
        BoxTree { boxes, order, nodes }
    }

    fn root(&self) -> Option<usize> {
        self.nodes.len().checked_sub(1)
    }

    /// The numbers of the boxes that meet one, **touching included**, in no particular order.
    pub(crate) fn meeting(&self, asked: &Box3) -> Vec<usize> {
        let (mut open, mut found) = (Vec::from_iter(self.root()), Vec::new());
        while let Some(node) = open.pop() {
            let node = &self.nodes[node];
            if !node.bounds.meets(asked) {
                continue;
            }
            match node.halves {
                Some(halves) => open.extend(halves),
                None => found.extend(node.members(self).iter().filter(|&&k| self.boxes[k].meets(asked))),
            }
        }
        found
    }
}

/// Makes the node of the boxes `order`, which begin at `start` of all, halved by their middles along the axis along which
/// these differ most.
fn build(boxes: &[Box3], order: &mut [usize], start: usize, nodes: &mut Vec<Node>) -> usize {
    let bounds = order[1..].iter().fold(boxes[order[0]], |all, &k| all.with(&boxes[k]));
    let halves = (order.len() > LEAF).then(|| {
        let spread = |axis: usize| {
            let middles = order.iter().map(|&k| boxes[k].middle(axis));
            let (low, high) = middles.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), m| (l.min(m), h.max(m)));
            high - low
        };
        let axis = (0..3).max_by(|&i, &j| spread(i).total_cmp(&spread(j))).unwrap_or(0);
        let half = order.len() / 2;
        order.select_nth_unstable_by(half, |&i, &j| {
            boxes[i].middle(axis).total_cmp(&boxes[j].middle(axis)).then(i.cmp(&j))
        });
        let (first, second) = order.split_at_mut(half);
        [build(boxes, first, start, nodes), build(boxes, second, start + half, nodes)]
    });
    nodes.push(Node { bounds, range: [start, start + order.len()], halves });
    nodes.len() - 1
}

/// Finds the pairs of one box of each of two nodes, which are the same node or share no box.
fn visit(tree: &BoxTree, [one, two]: [usize; 2], found: &mut Vec<[usize; 2]>) {
    let nodes = [one, two].map(|k| &tree.nodes[k]);
    if !nodes[0].bounds.meets(&nodes[1].bounds) {
        return;
    }
    match (nodes[0].halves, nodes[1].halves) {
        (Some([first, second]), _) if one == two => {
            for pair in [[first, first], [first, second], [second, second]] {
                visit(tree, pair, found);
            }
        }
        (Some(halves), _) if nodes[1].halves.is_none() || nodes[0].len() >= nodes[1].len() => {
            for half in halves {
                visit(tree, [half, two], found);
            }
        }
        (_, Some(halves)) => {
            for half in halves {
                visit(tree, [one, half], found);
            }
        }
        _ => {
            for (place, &i) in nodes[0].members(tree).iter().enumerate() {
                let others = nodes[1].members(tree);
                let others = if one == two { &others[place + 1..] } else { others };
                let meeting = others.iter().filter(|&&j| tree.boxes[i].meets(&tree.boxes[j]));
                found.extend(meeting.map(|&j| [i.min(j), i.max(j)]));
            }
        }
    }
}

impl Node {
    fn len(&self) -> usize {
        self.range[1] - self.range[0]
    }

    fn members<'t>(&self, tree: &'t BoxTree) -> &'t [usize] {
        &tree.order[self.range[0]..self.range[1]]
    }
}

/// Whether two blocks' boxes share no more than their surfaces, exactly: then the blocks do not overlap. **Boxes that
/// touch say yes.**
pub(crate) fn share_surfaces_at_most(a: &PreparedBlock, b: &PreparedBlock) -> bool {
    (0..3).any(|axis| ends_before(a, b, axis) || ends_before(b, a, axis))
}

/// Whether one block's greatest coordinate is at most the other's least. Rounding to nearest keeps the order of numbers,
/// so only equal f64 leave it open.
fn ends_before(one: &PreparedBlock, other: &PreparedBlock, axis: usize) -> bool {
    let (end, start) = (one.box_max[axis], other.box_min[axis]);
    let exactly = |prepared: &PreparedBlock, vertex: VertexId| -> Number {
        prepared.block().vertices()[vertex.index()].components()[axis].clone()
    };
    end < start || (end == start && exactly(one, one.extremes[axis].1) <= exactly(other, other.extremes[axis].0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_what_comparing_all_pairs_finds() {
        // Boxes of very different sizes, some touching, some equal.
        let mut state = 7u64;
        let mut below = |end: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % end) as f64
        };
        for count in [0, 1, 2, 9, 40, 300] {
            let boxes: Vec<Box3> = (0..count)
                .map(|_| {
                    let low = [below(20), below(20), below(4)];
                    let size = if below(10) == 0.0 { 12 } else { 3 };
                    Box3 { low, high: low.map(|c| c + below(size)) }
                })
                .collect();
            let mut found = meeting_pairs(&boxes);
            found.sort_unstable();
            let pairs = (0..count).flat_map(|i| (i + 1..count).map(move |j| [i, j]));
            let apart = |one: &Box3, two: &Box3| (0..3).any(|k| one.high[k] < two.low[k] || two.high[k] < one.low[k]);
            let expected: Vec<_> = pairs.filter(|&[i, j]| !apart(&boxes[i], &boxes[j])).collect();
            assert_eq!(found, expected);
            let tree = BoxTree::new(boxes.clone());
            for asked in &boxes {
                let mut found = tree.meeting(asked);
                found.sort_unstable();
                let expected: Vec<usize> = (0..count).filter(|&k| !apart(asked, &boxes[k])).collect();
                assert_eq!(found, expected);
            }
            assert!(count < 40 || !found.is_empty());
        }
    }
}
