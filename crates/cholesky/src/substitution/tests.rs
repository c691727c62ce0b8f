use super::*;
use crate::elimination_order::{Graph, elimination_order};

/// The pattern of a square grid of nodes with 5 unknowns each, tied to their neighbours at sides; and far from it a star and loose nodes.
fn pattern(side: u32) -> Pattern {
    let grid = side * side;
    let mut pairs = Vec::new();
    for node in 0..grid {
        pairs.extend((node % side + 1 < side).then_some([node, node + 1]));
        pairs.extend((node + side < grid).then_some([node, node + side]));
    }
    pairs.extend((1..9).map(|k| [grid, grid + k]));
    let count = grid + 12;
    let at: Vec<[f64; 3]> = (0..count).map(|node| [f64::from(node % side), 0.0, f64::from(node / side)]).collect();
    let unknowns = vec![5; count as usize];
    let order = elimination_order(Graph { unknowns: &unknowns, pairs: &pairs }, &at).expect("an order");
    let mut places = vec![0; order.len()];
    (0..).zip(&order).for_each(|(place, &node)| places[node as usize] = place);
    let mut pairs: Vec<[u32; 2]> = pairs.iter().map(|pair| pair.map(|node| places[node as usize])).collect();
    pairs.iter_mut().for_each(|pair| pair.sort_unstable());
    pairs.sort_unstable();
    Pattern::new(Graph { unknowns: &unknowns, pairs: &pairs })
}

/// Numbers between -1 and 1 that no sum leaves exact.
fn numbers(count: usize) -> Vec<f64> {
    (1..=count).map(|k| (k as f64).sin()).collect()
}

/// By one thread, panel by panel: forth each takes its sums from the later unknowns at once, back each fetches these.
fn plainly(pattern: &Pattern, values: &[f64], solution: &mut [f64]) {
    for (k, panel) in pattern.panels().iter().enumerate() {
        let mut below = vec![0.0; panel.height - panel.width];
        for (group, columns) in values[pattern.range(k)].chunks(COLUMNS * panel.height).enumerate() {
            let mut known = [0.0; COLUMNS];
            for (c, column) in columns.chunks_exact(panel.height).enumerate() {
                let here = COLUMNS * group + c;
                known[c] = solution[panel.begin + here] / column[here];
                solution[panel.begin + here] = known[c];
                for row in here + 1..panel.width {
                    solution[panel.begin + row] -= column[row] * known[c];
                }
            }
            add_columns(&mut below, columns, panel, &known);
        }
        for node in pattern.below(panel) {
            for (m, unknown) in pattern.unknowns(node.node as usize).enumerate() {
                solution[unknown] -= below[node.row as usize - panel.width + m];
            }
        }
    }
    for (k, panel) in pattern.panels().iter().enumerate().rev() {
        let nodes = pattern.below(panel).iter().flat_map(|node| pattern.unknowns(node.node as usize));
        let below: Vec<f64> = nodes.map(|unknown| solution[unknown]).collect();
        let own = &mut solution[panel.begin..panel.begin + panel.width];
        for (here, column) in values[pattern.range(k)].chunks_exact(panel.height).enumerate().rev() {
            let (inner, outer) = column.split_at(panel.width);
            own[here] = (own[here] - dot(&inner[here + 1..], &own[here + 1..]) - dot(outer, &below)) / column[here];
        }
    }
}

#[test]
fn a_solution_is_the_same_bits_however_it_is_shared() {
    for side in [2, 5, 40] {
        let pattern = pattern(side);
        let mut values = numbers(pattern.values());
        for panel in pattern.panels() {
            for column in 0..panel.width {
                values[panel.values + column * (panel.height + 1)] += 30.0;
            }
        }
        let mut expected = numbers(pattern.size());
        plainly(&pattern, &values, &mut expected);
        assert!(expected.iter().all(|x| x.is_finite() && *x != 0.0));
        for threads in [1, 2, 3, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            for worth in [1, 100, 3000, u64::MAX / 2] {
                let mut solution = numbers(pattern.size());
                pool.install(|| {
                    let substitution = Substitution::new(&pattern, &values, worth);
                    substitution.forth(&mut solution);
                    substitution.back(&mut solution);
                });
                assert!(solution == expected, "{side}, {threads} threads, {worth}");
            }
        }
    }
}

/// Which panels are worked on when, as [`Substitution::forth`] goes through them. What stands on both sides of a cut must know nothing of each other.
fn visited(pattern: &Pattern, subtrees: &Subtrees<'_>, panels: Range<usize>, order: &mut Vec<usize>) {
    let apart = |cut: usize| (cut..panels.end).all(|panel| pattern.subtree(panel) >= cut);
    match subtrees.divide(panels.clone()) {
        Division::InTurn => order.extend(panels),
        Division::Later(panel) => {
            assert!(panel < panels.end);
            visited(pattern, subtrees, panels.start..panel, order);
            order.extend(panel..panels.end);
        }
        Division::Little([little, rest]) => {
            assert!(!little.is_empty() && !rest.is_empty());
            let [one, other] = if little.start < rest.start { [&little, &rest] } else { [&rest, &little] };
            assert!([one.start, one.end, other.end] == [panels.start, other.start, panels.end] && apart(one.end));
            order.extend(little.clone());
            visited(pattern, subtrees, rest, order);
        }
        Division::Halves(cut) => {
            assert!(panels.contains(&cut) && cut > panels.start && apart(cut));
            visited(pattern, subtrees, panels.start..cut, order);
            visited(pattern, subtrees, cut..panels.end, order);
        }
    }
}

#[test]
fn panels_are_divided_by_whole_subtrees() {
    let pattern = pattern(40);
    let count = pattern.panel_count();
    let costs: [fn(usize) -> u64; 4] =
        [|_| 1, |panel| (panel % 7 == 3).into(), |panel| (panel == 5).into(), |panel| panel as u64 * panel as u64];
    for cost in costs {
        for worth in [1, 10, 1000] {
            let subtrees = Subtrees::new(&pattern, worth, cost);
            let mut order = Vec::new();
            visited(&pattern, &subtrees, subtrees.all(), &mut order);
            let mut when = vec![usize::MAX; count];
            order.iter().enumerate().for_each(|(k, &panel)| when[panel] = k);
            assert!(order.len() == count && when.iter().all(|&k| k < count), "each once");
            for panel in 0..count {
                assert!((pattern.subtree(panel)..panel).all(|earlier| when[earlier] < when[panel]), "{panel}");
            }
        }
    }
    let halves = Subtrees::new(&pattern, 1, |_| 1);
    assert!((0..count).any(|end| matches!(halves.divide(pattern.subtree(end)..end), Division::Halves(_))));
}
