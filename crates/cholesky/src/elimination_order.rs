//! In which order the blocks of an island are eliminated, so that its factor fills little.

use feral_amd::{CscPattern, amd_order};

/// Blocks that are tied together: a graph whose nodes have unknowns.
#[derive(Clone, Copy, Debug)]
pub struct Graph<'g> {
    /// The number of unknowns of each node, at least 1.
    pub unknowns: &'g [u8],
    /// Ties, ascending, the lower number first.
    pub pairs: &'g [[u32; 2]],
}

/// For each node the later ones of its column in the factor, ascending, where nodes are eliminated by number.
pub(super) type Columns = Vec<Vec<u32>>;

impl Graph<'_> {
    /// For each first number of the pairs where its second numbers begin and end, and these.
    fn lists(&self) -> (Vec<u32>, Vec<u32>) {
        let mut begins = vec![0; self.unknowns.len() + 1];
        for &[first, _] in self.pairs {
            begins[first as usize + 1] += 1;
        }
        for k in 1..begins.len() {
            begins[k] += begins[k - 1];
        }
        (begins, self.pairs.iter().map(|&[_, second]| second).collect())
    }

    /// The columns of the factor.
    pub(super) fn columns(&self) -> Columns {
        let (begins, seconds) = self.lists();
        let count = self.unknowns.len();
        let mut columns: Columns = Vec::with_capacity(count);
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); count];
        let mut seen = vec![u32::MAX; count];
        for node in 0..count {
            let mut column = Vec::new();
            seen[node] = node as u32;
            let own = &seconds[begins[node] as usize..begins[node + 1] as usize];
            let inherited = children[node].iter().flat_map(|&child| columns[child as usize].iter());
            for &other in own.iter().chain(inherited) {
                if std::mem::replace(&mut seen[other as usize], node as u32) != node as u32 {
                    column.push(other);
                }
            }
            column.sort_unstable();
            if let Some(&parent) = column.first() {
                children[parent as usize].push(node as u32);
            }
            columns.push(column);
        }
        columns
    }

    /// The multiplications that a factor of these columns takes, about.
    fn work(&self, columns: &Columns) -> u64 {
        let unknowns = |&node: &u32| u64::from(self.unknowns[node as usize]);
        let work = |(column, &own): (&Vec<u32>, &u8)| {
            let height = column.iter().map(unknowns).sum::<u64>() + u64::from(own);
            u64::from(own) * height * height
        };
        columns.iter().zip(self.unknowns).map(work).sum()
    }
}

/// A graph whose nodes are numbered anew.
pub struct Renumbered {
    unknowns: Vec<u8>,
    pairs: Vec<[u32; 2]>,
    /// The new number of each node.
    pub places: Vec<u32>,
}

impl Renumbered {
    /// By an order of elimination.
    pub fn new(graph: Graph<'_>, order: &[u32]) -> Renumbered {
        let mut places = vec![0; order.len()];
        for (place, &node) in (0..).zip(order) {
            places[node as usize] = place;
        }
        let placed = |&[a, b]: &[u32; 2]| {
            let (a, b) = (places[a as usize], places[b as usize]);
            [a.min(b), a.max(b)]
        };
        let mut pairs: Vec<[u32; 2]> = graph.pairs.iter().map(placed).collect();
        pairs.sort_unstable();
        Renumbered { unknowns: order.iter().map(|&node| graph.unknowns[node as usize]).collect(), pairs, places }
    }

    /// The graph with its new numbers.
    pub fn graph(&self) -> Graph<'_> {
        Graph { unknowns: &self.unknowns, pairs: &self.pairs }
    }
}

/// An order of elimination: that of least degree, or that of nested dissection, whichever takes less work. Children of the elimination
/// tree stand right before their parents. `at` says where the nodes are; it bears on the order only. `None` above 2³⁰ ties.
pub fn elimination_order(graph: Graph<'_>, at: &[[f64; 3]]) -> Option<Vec<u32>> {
    let mut best: Option<(u64, Vec<u32>)> = None;
    for order in [least_degree(graph)?, dissection(graph, at)] {
        let renumbered = Renumbered::new(graph, &order);
        let columns = renumbered.graph().columns();
        let work = renumbered.graph().work(&columns);
        if best.as_ref().is_none_or(|(least, _)| work < *least) {
            best = Some((work, postorder(&columns).into_iter().map(|place| order[place as usize]).collect()));
        }
    }
    best.map(|(_, order)| order)
}

/// Approximate minimum degree (Amestoy, Davis and Duff 1996).
fn least_degree(graph: Graph<'_>) -> Option<Vec<u32>> {
    let size = graph.unknowns.len();
    let mut both: Vec<[u32; 2]> = graph.pairs.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
    both.sort_unstable();
    i32::try_from(both.len()).ok()?;
    let mut begins = vec![0; size + 1];
    both.iter().for_each(|&[node, _]| begins[node as usize + 1] += 1);
    for k in 1..begins.len() {
        begins[k] += begins[k - 1];
    }
    let neighbours: Vec<i32> = both.iter().map(|&[_, neighbour]| neighbour as i32).collect();
    let order = amd_order(&CscPattern::new(size, &begins, &neighbours)?).ok()?;
    Some(order.into_iter().map(|node| node as u32).collect())
}

/// Nested dissection (George 1973) by place: the nodes are halved across the axis that cuts least; those of one half that are tied to the
/// other come last.
fn dissection(graph: Graph<'_>, at: &[[f64; 3]]) -> Vec<u32> {
    let count = graph.unknowns.len();
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); count];
    for &[a, b] in graph.pairs {
        neighbours[a as usize].push(b);
        neighbours[b as usize].push(a);
    }
    let mut cut = Dissection { neighbours, at, half: vec![0; count], halves: 0 };
    // From last to first: separators stand behind the parts that they separate.
    let mut order = Vec::with_capacity(count);
    let mut waiting = vec![(0..count as u32).collect::<Vec<u32>>()];
    while let Some(nodes) = waiting.pop() {
        match (nodes.len() > Dissection::MIN_NODES).then(|| cut.parts(&nodes)) {
            None => order.extend(nodes.into_iter().rev()),
            Some([one, other, between]) => {
                order.extend(between.into_iter().rev());
                waiting.extend([one, other]);
            }
        }
    }
    order.reverse();
    order
}

struct Dissection<'c> {
    neighbours: Vec<Vec<u32>>,
    at: &'c [[f64; 3]],
    /// The half of the last cut in which a node is: a number that is used once.
    half: Vec<u32>,
    halves: u32,
}

impl Dissection<'_> {
    /// Parts of so many nodes are not cut.
    const MIN_NODES: usize = 3;

    /// Two parts, and the nodes between them.
    fn parts(&mut self, nodes: &[u32]) -> [Vec<u32>; 3] {
        let mut best: Option<[Vec<u32>; 3]> = None;
        for axis in 0..3 {
            let mut along = nodes.to_vec();
            let key = |node: u32, k: usize| self.at[node as usize][(axis + k) % 3];
            let by = |k: usize, a: u32, b: u32| key(a, k).total_cmp(&key(b, k));
            along.sort_unstable_by(|&a, &b| by(0, a, b).then(by(1, a, b)).then(by(2, a, b)).then(a.cmp(&b)));
            let (one, other) = along.split_at(along.len() / 2);
            let marks = [self.halves + 1, self.halves + 2];
            self.halves += 2;
            for (half, mark) in [one, other].into_iter().zip(marks) {
                half.iter().for_each(|&node| self.half[node as usize] = mark);
            }
            let tied = |node: &u32, mark: u32| {
                self.neighbours[*node as usize].iter().any(|&other| self.half[other as usize] == mark)
            };
            let (low, one): (Vec<u32>, Vec<u32>) = one.iter().partition(|node| tied(node, marks[1]));
            let (high, other): (Vec<u32>, Vec<u32>) = other.iter().partition(|node| tied(node, marks[0]));
            let parts = if high.len() < low.len() {
                [[one, low].concat(), other, high]
            } else {
                [one, [other, high].concat(), low]
            };
            if best.as_ref().is_none_or(|[_, _, between]| parts[2].len() < between.len()) {
                best = Some(parts);
            }
        }
        best.unwrap_or_default()
    }
}

/// The nodes with the children of each right before it, of these the one with the longest column last.
fn postorder(columns: &Columns) -> Vec<u32> {
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); columns.len()];
    let mut roots = Vec::new();
    for (node, column) in (0..).zip(columns) {
        match column.first() {
            Some(&parent) => children[parent as usize].push(node),
            None => roots.push(node),
        }
    }
    // From last to first: a node, then its children from the last to the first.
    let mut order = Vec::with_capacity(columns.len());
    let mut waiting = roots;
    while let Some(node) = waiting.pop() {
        order.push(node);
        let mut mine = std::mem::take(&mut children[node as usize]);
        mine.sort_by_key(|&child| columns[child as usize].len());
        waiting.extend(mine);
    }
    order.reverse();
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid, whose corners go first, and a hub of 400 nodes, which goes last. Which order is found bears on last bits.
    #[test]
    fn orders_of_least_degree_are_the_ones_known() {
        let grid: Vec<[u32; 2]> = (0..9u32)
            .flat_map(|node| [(node % 3 < 2).then_some([node, node + 1]), (node < 6).then_some([node, node + 3])])
            .flatten()
            .collect();
        let order = least_degree(Graph { unknowns: &[6; 9], pairs: &grid }).expect("an order");
        assert_eq!(order, [2, 8, 0, 6, 3, 1, 5, 7, 4]);
        let hub: Vec<[u32; 2]> = (1..401).map(|node| [0, node]).collect();
        let order = least_degree(Graph { unknowns: &[6; 401], pairs: &hub }).expect("an order");
        assert_eq!(order.last(), Some(&0));
        assert_eq!(order.len(), 401);
    }
}
