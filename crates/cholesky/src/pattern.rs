//! Where the values of an island's matrix and of its factor stand.

use crate::elimination_order::Graph;

/// Where the values of a symmetric matrix stand, and then those of its factor. Nodes are blocks, numbered as they are eliminated. Nodes
/// whose columns fill alike share a *panel*: the columns of their unknowns, each of the same rows, namely those of the panel's own nodes
/// and of later ones, the nodes below. What lies above the diagonal there means nothing.
#[derive(Debug)]
pub struct Pattern {
    /// Where the unknowns of each node begin, and where the last end.
    begins: Vec<u32>,
    /// The panel of each node.
    panel_of: Vec<u32>,
    panels: Vec<Panel>,
    /// For each panel the first one of its subtree: of those on which it depends, which follow one another and end with it.
    subtrees: Vec<u32>,
    /// The nodes below each panel, ascending, and the row in the panel where the unknowns of each begin.
    below: Vec<PanelRow>,
    /// What the factor of earlier panels takes from each.
    updates: Vec<PanelUpdate>,
    values: usize,
}

/// Columns with the same rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panel {
    /// The first unknown.
    pub(super) begin: usize,
    /// Rows, of which the first `width` are the panel's own unknowns.
    pub(super) height: usize,
    pub(super) width: usize,
    /// Where its values begin: column by column.
    pub(super) values: usize,
    /// How many rows below all panels before it have.
    pub(super) rows_below: usize,
    below: [u32; 2],
    updates: [u32; 2],
}

/// A node below a panel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PanelRow {
    pub(super) node: u32,
    pub(super) row: u32,
}

/// An earlier panel of which some nodes below stand in a panel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PanelUpdate {
    pub(super) from: u32,
    /// These of the nodes below it.
    pub(super) below: [u32; 2],
}

/// Where a part that belongs to two nodes stands: `at + row + stride·column`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockSlot {
    /// The panel.
    pub panel: usize,
    /// Where its first value stands.
    pub at: usize,
    /// From one column to the next.
    pub stride: usize,
}

/// An entry of the lower triangle: of two unknowns, of which the row's is not the earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatternEntry {
    /// The row.
    pub row: usize,
    /// The column.
    pub column: usize,
    /// Where its value stands.
    pub place: usize,
}

/// A panel on the way, and how many of its values are no zeros.
struct PanelDraft {
    nodes: [u32; 2],
    full: usize,
}

impl Pattern {
    /// Panels begin at multiples of so many values, so that they can be aligned, which makes them faster to read.
    pub const ALIGNED: usize = 16;

    /// Of all unknowns of the nodes, as one panel.
    pub fn whole(unknowns: &[u8]) -> Pattern {
        Pattern::of_panels(unknowns, &[[0, unknowns.len() as u32]], &[Vec::new()])
    }

    /// Of a graph whose nodes are numbered in an order of elimination, children right before their parents.
    pub fn new(graph: Graph<'_>) -> Pattern {
        let columns = graph.columns();
        let count = |node: u32| usize::from(graph.unknowns[node as usize]);
        let mut drafts: Vec<PanelDraft> = Vec::new();
        for (node, column) in (0..).zip(&columns) {
            let (mut width, rest) = (count(node), column.iter().map(|&n| count(n)).sum::<usize>());
            let mut draft = PanelDraft { nodes: [node, node + 1], full: width * (width + 1) / 2 + width * rest };
            while let Some(before) = drafts.last() {
                let parent = columns[before.nodes[1] as usize - 1].first();
                let wider = width + (before.nodes[0]..before.nodes[1]).map(count).sum::<usize>();
                let (full, all) = (draft.full + before.full, wider * (wider + 1) / 2 + wider * rest);
                if wider > WIDEST
                    || parent.is_none_or(|&parent| parent > node)
                    || all - full > allowed_zeros(wider, all)
                {
                    break;
                }
                draft = PanelDraft { nodes: [before.nodes[0], node + 1], full };
                width = wider;
                drafts.pop();
            }
            drafts.push(draft);
        }
        let nodes: Vec<[u32; 2]> = drafts.iter().map(|draft| draft.nodes).collect();
        let mut columns = columns;
        let below: Vec<Vec<u32>> =
            nodes.iter().map(|&[_, end]| std::mem::take(&mut columns[end as usize - 1])).collect();
        Pattern::of_panels(graph.unknowns, &nodes, &below)
    }

    fn of_panels(unknowns: &[u8], nodes: &[[u32; 2]], nodes_below: &[Vec<u32>]) -> Pattern {
        let mut begins = vec![0];
        begins.extend(unknowns.iter().scan(0, |end, &n| {
            *end += u32::from(n);
            Some(*end)
        }));
        let count = |node: u32| begins[node as usize + 1] - begins[node as usize];
        let mut pattern = Pattern {
            panel_of: vec![0; unknowns.len()],
            panels: Vec::with_capacity(nodes.len()),
            subtrees: (0..nodes.len() as u32).collect(),
            below: Vec::with_capacity(nodes_below.iter().map(Vec::len).sum()),
            updates: Vec::new(),
            values: 0,
            begins: Vec::new(),
        };
        for (panel, (&[first, end], later)) in (0..).zip(nodes.iter().zip(nodes_below)) {
            pattern.panel_of[first as usize..end as usize].fill(panel);
            let begin = begins[first as usize];
            let width = begins[end as usize] - begin;
            let mut height = width;
            let from = pattern.below.len() as u32;
            for &node in later {
                pattern.below.push(PanelRow { node, row: height });
                height += count(node);
            }
            let (width, height) = (width as usize, height as usize);
            let below = [from, pattern.below.len() as u32];
            let (begin, values, rows_below) = (begin as usize, pattern.values, pattern.rows_below());
            pattern.panels.push(Panel { begin, height, width, values, rows_below, below, updates: [0; 2] });
            pattern.values = (values + width * height).next_multiple_of(Pattern::ALIGNED);
        }
        pattern.begins = begins;
        for panel in 0..pattern.panels.len() {
            if let Some(parent) = pattern.parent(panel) {
                pattern.subtrees[parent] = pattern.subtrees[parent].min(pattern.subtrees[panel]);
            }
        }
        pattern.list_updates();
        pattern
    }

    fn list_updates(&mut self) {
        let mut all: Vec<(u32, PanelUpdate)> = Vec::new();
        for (from, panel) in (0..).zip(&self.panels) {
            let mut first = panel.below[0];
            while first < panel.below[1] {
                let of = self.panel_of[self.below[first as usize].node as usize];
                let rest = &self.below[first as usize..panel.below[1] as usize];
                let end = first + rest.partition_point(|below| self.panel_of[below.node as usize] == of) as u32;
                all.push((of, PanelUpdate { from, below: [first, end] }));
                first = end;
            }
        }
        all.sort_by_key(|&(of, _)| of);
        let mut begin = 0;
        for same in all.chunk_by(|one, other| one.0 == other.0) {
            let end = begin + same.len() as u32;
            self.panels[same[0].0 as usize].updates = [begin, end];
            begin = end;
        }
        self.updates = all.into_iter().map(|(_, update)| update).collect();
    }

    /// How many rows below all panels have.
    pub(super) fn rows_below(&self) -> usize {
        self.panels.last().map_or(0, |panel| panel.rows_below + panel.height - panel.width)
    }

    /// The multiplications that the factor takes, about; twice as many as there are at least.
    pub fn work(&self) -> u64 {
        self.panels.iter().map(|panel| (panel.width * panel.height * panel.height) as u64).sum()
    }

    /// The number of unknowns.
    pub fn size(&self) -> usize {
        self.begins.last().map_or(0, |&end| end as usize)
    }

    /// How many values there are.
    pub fn values(&self) -> usize {
        self.values
    }

    /// The unknowns of a node.
    pub fn unknowns(&self, node: usize) -> std::ops::Range<usize> {
        self.begins[node] as usize..self.begins[node + 1] as usize
    }

    /// The node that holds an unknown.
    pub fn node_of(&self, unknown: usize) -> usize {
        self.begins.partition_point(|&begin| begin as usize <= unknown).saturating_sub(1)
    }

    /// Where the rows of one node in the columns of another, which is not later, stand.
    pub fn part(&self, row: usize, column: usize) -> Option<BlockSlot> {
        let panel = self.panel(column);
        let (at, stride) = self.part_of(panel, row, column)?;
        Some(BlockSlot { panel, at: self.panels[panel].values + at, stride })
    }

    /// Where the rows of a node in the columns of another, which is one of the panel's own, begin among the panel's values, and how far it
    /// is from one column to the next.
    pub fn part_of(&self, panel: usize, row: usize, column: usize) -> Option<(usize, usize)> {
        let own = panel as u32;
        let panel = &self.panels[panel];
        let inner = self.begins[column] as usize - panel.begin;
        let row = if self.panel_of[row] == own {
            self.begins[row] as usize - panel.begin
        } else {
            let below = self.below(panel);
            let found = below.binary_search_by_key(&(row as u32), |below| below.node).ok()?;
            below[found].row as usize
        };
        Some((row + panel.height * inner, panel.height))
    }

    /// The nodes of a panel.
    pub fn nodes(&self, panel: usize) -> std::ops::Range<usize> {
        let Panel { begin, width, .. } = self.panels[panel];
        self.begins.partition_point(|&first| (first as usize) < begin)
            ..self.begins.partition_point(|&first| (first as usize) < begin + width)
    }

    pub(super) fn panels(&self) -> &[Panel] {
        &self.panels
    }

    pub(super) fn below(&self, panel: &Panel) -> &[PanelRow] {
        &self.below[panel.below[0] as usize..panel.below[1] as usize]
    }

    pub(super) fn updates(&self, panel: &Panel) -> &[PanelUpdate] {
        &self.updates[panel.updates[0] as usize..panel.updates[1] as usize]
    }

    /// Of an update: the nodes below the earlier panel that stand in the later one, and those after these.
    pub(super) fn updating(&self, update: PanelUpdate) -> (&[PanelRow], &[PanelRow]) {
        let end = self.panels[update.from as usize].below[1] as usize;
        let rest = &self.below[update.below[0] as usize..end];
        rest.split_at((update.below[1] - update.below[0]) as usize)
    }

    /// Where the values of a panel stand.
    pub fn range(&self, panel: usize) -> std::ops::Range<usize> {
        let panel = &self.panels[panel];
        panel.values..panel.values + panel.width * panel.height
    }

    /// Marks all panels of which the factor depends on one that is marked.
    pub fn mark_dependent(&self, marked: &mut [bool]) {
        for panel in 0..self.panels.len() {
            if let (true, Some(parent)) = (marked[panel], self.parent(panel)) {
                marked[parent] = true;
            }
        }
    }

    /// The first panel that depends on a panel.
    fn parent(&self, panel: usize) -> Option<usize> {
        let below = self.below(&self.panels[panel]).first()?;
        Some(self.panel_of[below.node as usize] as usize)
    }

    /// The first of the panels on which a panel depends; itself if there is none. They follow one another.
    pub(super) fn subtree(&self, panel: usize) -> usize {
        self.subtrees[panel] as usize
    }

    /// The panel that holds the columns of a node.
    pub fn panel(&self, node: usize) -> usize {
        self.panel_of[node] as usize
    }

    /// Of how many panels it is made.
    pub fn panel_count(&self) -> usize {
        self.panels.len()
    }

    /// The entries of the lower triangle that have a place among the values, panel by panel and column by column.
    pub fn entries(&self) -> impl Iterator<Item = PatternEntry> + '_ {
        let columns = self.panels.iter().flat_map(|panel| (0..panel.width).map(move |column| (panel, column)));
        columns.flat_map(|(panel, column)| {
            let own = (column..panel.width).map(|row| (row, panel.begin + row));
            let later = self.below(panel).iter().flat_map(|below| {
                let node = self.unknowns(below.node as usize);
                node.enumerate().map(|(k, unknown)| (below.row as usize + k, unknown))
            });
            own.chain(later).map(move |(row, unknown)| PatternEntry {
                row: unknown,
                column: panel.begin + column,
                place: panel.values + column * panel.height + row,
            })
        })
    }

    /// The values of the whole lower triangle, row by row.
    pub fn square<R: Copy>(&self, values: &[R], zero: R) -> Vec<R> {
        let size = self.size();
        let mut square = vec![zero; size * size];
        for PatternEntry { row, column, place } in self.entries() {
            square[row * size + column] = values[place];
        }
        square
    }
}

/// No panel has more columns: those of wider ones would be factored by one thread, and products on the way take much memory.
const WIDEST: usize = 192;

/// How many zeros a panel may hold for the sake of being wide, since products of narrow ones are slow: a tenth, and of wide ones less.
fn allowed_zeros(width: usize, all: usize) -> usize {
    all / if width <= 48 { 10 } else { 40 }
}
