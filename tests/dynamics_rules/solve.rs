//! The sparse solution against the dense one.

use crate::support::{cuboid, floor, near, run, scene};
use rockproof::model::Motion;
use rockproof::stepper::dynamics::solve::{DENSE, Factor, Lower, Singular, Solve, dense, elimination_order};

/// A generator of whole numbers that needs no library: Knuth's multiplier.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self, below: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % below
    }
}

/// The lower triangle of a matrix of `size`, whose diagonal exceeds the sum of each row.
fn triangle(size: usize, numbers: &mut Numbers) -> (Vec<u32>, Vec<u32>, Vec<f64>) {
    let (mut columns, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    let mut sums = vec![1.0; size];
    for column in 0..size {
        let begin = rows.len();
        rows.push(column as u32);
        values.push(0.0);
        for row in column + 1..size {
            if numbers.next(size as u64) < 6 {
                let value = numbers.next(2001) as f64 / 1000.0 - 1.0;
                rows.push(row as u32);
                values.push(value);
                sums[row] += value.abs();
                sums[column] += value.abs();
            }
        }
        columns.push(rows.len() as u32);
        values[begin] = f64::from(column as u32);
    }
    for column in 0..size {
        values[columns[column] as usize] = sums[column];
    }
    (columns, rows, values)
}

fn both<R: Solve>(size: usize, numbers: &mut Numbers) -> f64 {
    let (columns, rows, values) = triangle(size, numbers);
    let values: Vec<R> = values.into_iter().map(R::from_f64).collect();
    let right: Vec<R> = (0..size).map(|_| R::from_f64(numbers.next(2001) as f64 - 1000.0)).collect();
    let matrix = Lower { columns: &columns, rows: &rows, values: &values };
    let (mut one, mut other) = (right.clone(), right);
    dense(matrix, &mut one).unwrap();
    R::sparse(matrix, &Factor::new(&columns, &rows).unwrap(), &mut other).unwrap();
    let largest = one.iter().fold(0.0, |most: f64, x| most.max(x.to_f64().abs()));
    one.iter().zip(&other).map(|(a, b)| (a.to_f64() - b.to_f64()).abs()).fold(0.0, f64::max) / largest
}

#[test]
fn sparse_and_dense_agree_on_random_systems() {
    let mut numbers = Numbers(1);
    for size in [1, 2, 7, 96, 97, 150, 300] {
        let (double, single) = (both::<f64>(size, &mut numbers), both::<f32>(size, &mut numbers));
        assert!(double < 1e-13 && single < 1e-5, "{size}: {double} {single}");
    }
}

#[test]
fn what_is_not_positive_definite_is_refused_by_both() {
    // [1 2; 2 1] has the eigenvalue -1.
    let (columns, rows, values) = ([0, 2, 3], [0, 1, 1], [1.0, 2.0, 1.0]);
    let matrix = Lower { columns: &columns, rows: &rows, values: &values };
    assert_eq!(dense::<f64>(matrix, &mut [1.0, 1.0]), Err(Singular { unknown: 1 }));
    assert!(f64::sparse(matrix, &Factor::new(&columns, &rows).unwrap(), &mut [1.0, 1.0]).is_err());
}

#[test]
fn an_order_of_elimination_is_a_permutation_that_spares_the_hub() {
    // A star: its middle, node 0, is tied to all others and goes last or last but one.
    let (columns, rows): (Vec<u32>, Vec<u32>) =
        ((0..=20).map(|k| if k == 0 { 0 } else { 19 }).collect(), (1..20).collect());
    let order = elimination_order(&columns, &rows).unwrap();
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, (0..20).collect::<Vec<u32>>());
    assert!(order[18..].contains(&0), "{order:?}");
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
