//! The sparse solution against the dense one.

use crate::support::{cuboid, floor, near, run, scene};
use rockproof_cholesky::{Graph, Pattern, Singular, elimination_order};
use rockproof_model::Motion;
use rockproof_stepper::dynamics::solve::{DENSE, Solve, dense};
use rockproof_stepper::{Real, Wide};

/// A generator of whole numbers that needs no library: Knuth's multiplier.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self, below: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % below
    }
}

/// A matrix whose nodes have 1 to 12 unknowns, and whose diagonal exceeds the sum of each row.
struct Sample<R> {
    unknowns: Vec<u8>,
    pattern: Pattern,
    values: Vec<R>,
    right: Vec<R>,
}

impl<R: Solve> Sample<R> {
    /// About `ties` ties a node, numbered as found or in an order of elimination.
    fn new(nodes: usize, ties: u64, numbers: &mut Numbers) -> Sample<R> {
        let unknowns: Vec<u8> = (0..nodes).map(|_| 1 + numbers.next(12) as u8).collect();
        let mut pairs = Vec::new();
        for first in 0..nodes as u32 {
            pairs.extend((first + 1..nodes as u32).filter(|_| numbers.next(nodes as u64) < ties).map(|n| [first, n]));
        }
        let at: Vec<[f64; 3]> = (0..nodes).map(|_| [0; 3].map(|_| numbers.next(1000) as f64)).collect();
        let order = elimination_order(Graph { unknowns: &unknowns, pairs: &pairs }, &at).unwrap();
        Sample::of(unknowns, &pairs, &order, numbers)
    }

    /// Of nodes that are eliminated in an order.
    fn of(unknowns: Vec<u8>, pairs: &[[u32; 2]], order: &[u32], numbers: &mut Numbers) -> Sample<R> {
        let nodes = unknowns.len();
        let place = |node: u32| order.iter().position(|&n| n == node).unwrap() as u32;
        let mut pairs: Vec<[u32; 2]> = pairs.iter().map(|&[a, b]| [place(a), place(b)]).collect();
        pairs.iter_mut().for_each(|pair| pair.sort_unstable());
        pairs.sort_unstable();
        let unknowns: Vec<u8> = order.iter().map(|&node| unknowns[node as usize]).collect();
        let pattern = Pattern::new(Graph { unknowns: &unknowns, pairs: &pairs });
        let right = (0..pattern.size()).map(|_| R::from_f64(numbers.next(2001) as f64 - 1000.0)).collect();
        let mut sample = Sample { values: vec![R::ZERO; pattern.values()], pattern, unknowns, right };
        let mut sums = vec![1.0; sample.pattern.size()];
        for node in 0..nodes {
            sample.fill([node, node], &mut sums, numbers);
        }
        for [column, row] in pairs {
            sample.fill([row as usize, column as usize], &mut sums, numbers);
        }
        for node in 0..nodes {
            let part = sample.pattern.part(node, node).unwrap();
            for (k, unknown) in sample.pattern.unknowns(node).enumerate() {
                sample.values[part.at + (part.stride + 1) * k] = R::from_f64(sums[unknown]);
            }
        }
        sample
    }

    /// Random values in the rows of a node and the columns of another, below the diagonal.
    fn fill(&mut self, [row, column]: [usize; 2], sums: &mut [f64], numbers: &mut Numbers) {
        let part = self.pattern.part(row, column).unwrap();
        let [rows, columns] = [row, column].map(|node| self.pattern.unknowns(node));
        for (k, c) in columns.enumerate() {
            for (m, r) in rows.clone().enumerate().filter(|&(_, r)| r > c) {
                let value = numbers.next(2001) as f64 / 1000.0 - 1.0;
                self.values[part.at + part.stride * k + m] = R::from_f64(value);
                sums[r] += value.abs();
                sums[c] += value.abs();
            }
        }
    }

    /// The solution by the factor, and what is left of it.
    fn sparsely(&self) -> (Vec<R>, Vec<R>) {
        let (mut values, mut solution) = (vec![R::ZERO; self.values.len()], self.right.clone());
        self.factorize(&mut values, &vec![true; self.pattern.panel_count()]);
        R::substitute(&self.pattern, &values, &mut solution).unwrap();
        (solution, values)
    }

    fn factorize(&self, values: &mut [R], marked: &[bool]) {
        let fill = |panel: usize, own: &mut [R]| own.copy_from_slice(&self.values[self.pattern.range(panel)]);
        R::factorize(&self.pattern, values, marked, &fill).unwrap();
    }

    fn difference(&self) -> f64 {
        let mut one = self.right.clone();
        dense(&self.pattern, &self.values, &mut one).unwrap();
        let largest = one.iter().fold(0.0, |most: f64, x| most.max(x.to_f64().abs()));
        let apart = one.iter().zip(self.sparsely().0).map(|(a, b)| (a.to_f64() - b.to_f64()).abs());
        apart.fold(0.0, f64::max) / largest
    }
}

#[test]
fn sparse_and_dense_agree_on_random_systems() {
    let mut numbers = Numbers(1);
    for nodes in [1, 2, 7, 15, 40, 70] {
        for ties in [0, 2, 6, 1000] {
            let double = Sample::<f64>::new(nodes, ties, &mut numbers).difference();
            let single = Sample::<f32>::new(nodes, ties, &mut numbers).difference();
            assert!(double < 1e-13 && single < 1e-5, "{nodes} {ties}: {double} {single}");
        }
    }
}

/// All that a number of 512 bits knows, its radius among it.
fn all_of(numbers: &[Wide]) -> Vec<String> {
    numbers.iter().map(|number| format!("{number:?}")).collect()
}

#[test]
fn to_leave_out_zeros_changes_no_bit_and_no_radius() {
    let mut numbers = Numbers(5);
    let (mut whole, mut held) = (0, 0);
    for nodes in [1, 2, 7, 12] {
        for ties in [0, 2, 1000] {
            let mut sample = Sample::<Wide>::new(nodes, ties, &mut numbers);
            // Thirds have radii.
            let third = Wide::from_f64(1.0) / Wide::from_f64(3.0);
            sample.values.iter_mut().for_each(|value| *value = *value * third);
            let mut plain = sample.right.clone();
            dense(&sample.pattern, &sample.values, &mut plain).unwrap();
            let mut solution = sample.right.clone();
            Wide::solve_small(&sample.pattern, &sample.values, &mut solution).unwrap();
            assert_eq!(all_of(&solution), all_of(&plain), "{nodes} {ties}");
            // Large systems are not eliminated; their solutions have radii of their own.
            let mut enclosed = sample.right.clone();
            Wide::substitute(&sample.pattern, &sample.values, &mut enclosed).unwrap();
            let meet = |(one, other): (&Wide, &Wide)| !one.surely_below(*other) && !other.surely_below(*one);
            assert!(enclosed.iter().zip(&plain).all(meet), "{nodes} {ties}");
            // Of the smallest more is held than there is, since blocks are padded.
            whole += sample.pattern.size().pow(2);
            held += sample.pattern.values();
        }
    }
    assert!(whole > held + 10_000, "{held} of {whole}");
    // The product of the first row takes the second's entry away exactly.
    let pattern = Pattern::whole(&[3]);
    let values = [1.0, 1.0, 1.0, 0.0, 2.0, 1.0, 0.0, 0.0, 3.0].map(Wide::from_f64);
    let (mut plain, mut solution) = ([1.0, 2.0, 4.0].map(Wide::from_f64), [1.0, 2.0, 4.0].map(Wide::from_f64));
    dense(&pattern, &values, &mut plain).unwrap();
    Wide::solve_small(&pattern, &values, &mut solution).unwrap();
    assert_eq!(all_of(&solution), all_of(&plain));
}

#[test]
fn a_factor_that_is_renewed_in_part_is_bit_for_bit_a_new_one() {
    let mut numbers = Numbers(2);
    let mut spared = 0;
    for nodes in [3, 15, 40, 70] {
        let mut sample = Sample::<f64>::new(nodes, 2, &mut numbers);
        let (_, mut kept) = sample.sparsely();
        for _ in 0..5 {
            let node = numbers.next(nodes as u64) as usize;
            let part = sample.pattern.part(node, node).unwrap();
            for k in 0..usize::from(sample.unknowns[node]) {
                let place = part.at + (part.stride + 1) * k;
                sample.values[place] *= 1.25;
            }
            let mut marked = vec![false; sample.pattern.panel_count()];
            marked[part.panel] = true;
            sample.pattern.mark_dependent(&mut marked);
            sample.factorize(&mut kept, &marked);
            let mut solution = sample.right.clone();
            f64::substitute(&sample.pattern, &kept, &mut solution).unwrap();
            assert_eq!(sample.sparsely().0, solution);
            spared += marked.iter().filter(|marked| !**marked).count();
        }
    }
    assert!(spared > 100, "{spared}");
}

#[test]
fn a_factor_and_its_solution_are_the_same_bits_on_any_number_of_threads() {
    let (pairs, at) = grid(24);
    let unknowns = vec![12; 576];
    let order = elimination_order(Graph { unknowns: &unknowns, pairs: &pairs }, &at).unwrap();
    let sample = Sample::<f64>::of(unknowns, &pairs, &order, &mut Numbers(3));
    let by = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sample.sparsely())
    };
    let one = by(1);
    for threads in [2, 3, 4, 5] {
        assert!((0..3).all(|_| by(threads) == one), "{threads}");
    }
}

#[test]
fn what_is_not_positive_definite_is_refused_by_both() {
    // [1 2; 2 1] has the eigenvalue -1.
    let pattern = Pattern::whole(&[2]);
    let (given, mut right) = ([1.0, 2.0, 0.0, 1.0], [1.0, 1.0]);
    assert_eq!(dense::<f64>(&pattern, &given, &mut right), Err(Singular { unknown: 1 }));
    let fill = |_: usize, own: &mut [f64]| own.copy_from_slice(&given);
    assert_eq!(f64::factorize(&pattern, &mut [0.0; 4], &[true], &fill), Err(Singular { unknown: 1 }));
}

#[test]
fn an_order_of_elimination_is_a_permutation_that_spares_the_hub() {
    // A star: its middle, node 0, is tied to all others and goes last or last but one.
    let pairs: Vec<[u32; 2]> = (1..20).map(|k| [0, k]).collect();
    let order = elimination_order(Graph { unknowns: &[6; 20], pairs: &pairs }, &[[0.0; 3]; 20]).unwrap();
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, (0..20).collect::<Vec<u32>>());
    assert!(order[18..].contains(&0), "{order:?}");
}

/// A square grid in which each node is tied to its neighbours at sides and at two of four corners, like bricks in a wall.
fn grid(side: u32) -> (Vec<[u32; 2]>, Vec<[f64; 3]>) {
    let at: Vec<[f64; 3]> = (0..side * side).map(|n| [f64::from(n % side), 0.0, f64::from(n / side)]).collect();
    let near = |a: &[f64; 3], b: &[f64; 3]| {
        let (x, z) = (b[0] - a[0], b[2] - a[2]);
        x.abs() <= 1.0 && z.abs() <= 1.0 && x * z <= 0.0
    };
    let pairs = (0..side * side).flat_map(|a| (a + 1..side * side).map(move |b| [a, b]));
    (pairs.filter(|&[a, b]| near(&at[a as usize], &at[b as usize])).collect(), at)
}

#[test]
fn places_of_blocks_make_the_order_of_a_large_grid_a_better_one() {
    let (pairs, at) = grid(60);
    let unknowns = vec![12; 3600];
    let graph = Graph { unknowns: &unknowns, pairs: &pairs };
    // Without places there is least degree alone to choose from.
    let [known, unknown] = [at, vec![[0.0; 3]; 3600]].map(|at| fill(graph, &elimination_order(graph, &at).unwrap()));
    assert!(known < unknown, "{known} {unknown}");
}

fn fill(graph: Graph<'_>, order: &[u32]) -> usize {
    let mut places = vec![0; order.len()];
    (0..).zip(order).for_each(|(place, &node)| places[node as usize] = place);
    let placed = |&[a, b]: &[u32; 2]| [places[a as usize], places[b as usize]];
    let mut pairs: Vec<[u32; 2]> = graph.pairs.iter().map(placed).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    pairs.sort_unstable();
    Pattern::new(Graph { unknowns: graph.unknowns, pairs: &pairs }).values()
}

/// A settled stack of deformable blocks, more than a dense system holds: the normal force on each block from below is the weight above.
fn stack<R: Solve>(relative: f64) {
    let count = (DENSE / 12 + 1) as i32;
    let mut blocks = vec![floor()];
    for k in 0..count {
        let (low, high) = (k.to_string(), (k + 1).to_string());
        blocks.push(cuboid(&format!("block {k}"), ["0", "0", &low], ["1", "1", &high], Motion::Deformable));
    }
    let mut scene = scene(blocks);
    scene.simulation.control.settle = 400;
    let (dynamics, _) = run::<R>(&scene, 400);
    for k in 0..count {
        let pair = [k as u32, k as u32 + 1];
        let below = dynamics.state().contacts.iter().filter(|c| c.blocks == pair);
        let force: f64 = below.map(|c| -c.force.z.to_f64()).sum();
        let above = (k + 1..=count).map(|block| 20_000.0 * dynamics.volume(block as usize));
        near(force, above.sum(), relative);
    }
}

#[test]
fn a_stack_solved_sparsely_bears_its_weight() {
    stack::<f64>(1e-8);
    stack::<f32>(1e-2);
}
