//! The preconditioner of two levels against plain arithmetic, and its solutions against those of a factor in f64.

use super::bricks::bricks;
use super::*;
use crate::dynamics::conjugate_gradients::{ConjugateGradients, Patience};
use crate::dynamics::displacement::displacement;
use crate::dynamics::island::{BySingle, SingleFactor, islands};
use crate::dynamics::products::Products;
use crate::dynamics::system::System;
use crate::dynamics::two_level::TwoLevel;
use rockproof_cholesky::{Graph, Pattern, Renumbered, elimination_order};
use rockproof_model::Motion;
use rockproof_model::simulation::Solver;

/// Calls with the system of bricks of which some slide, and with their centroids by place (m).
fn with_system(size: [u32; 3], motion: Motion, check: impl Fn(&System<'_, f64>, &[Vector<f64>])) {
    with_system_of(size, motion, (Solver::ConjugateGradients, 0.01), check);
}

/// The same by a solver and with a Δt (s).
pub(super) fn with_system_of(
    size: [u32; 3],
    motion: Motion,
    (solver, time_step): (Solver, f64),
    check: impl Fn(&System<'_, f64>, &[Vector<f64>]),
) {
    let (mut scene, set) = bricks(size, false, motion);
    scene.simulation.control.solver = solver;
    let mut dynamics = Dynamics::<f64>::new(&scene, &set).expect("a scene");
    let mut contacts = dynamics.contacts();
    contacts.iter_mut().for_each(|contact| contact.reset::<SpecRules>(contact.begins));
    for contact in contacts.iter_mut().step_by(5) {
        let normal = contact.plane.normal;
        let slip = Vector::new(normal.y + 2.0 * normal.z, normal.z - normal.x, normal.x + normal.y) * 1e-6;
        contact.iterate.mode = Mode::Sliding;
        contact.iterate.friction = Friction::along::<SpecRules>(slip, 1e8, contact.joint.shear, normal);
    }
    let block_systems = dynamics.block_systems(time_step, false);
    let unknowns: Vec<usize> = block_systems.iter().map(|block| block.unknowns).collect();
    let pairs: Vec<[u32; 2]> = contacts.iter().map(|contact| contact.blocks).collect();
    let modes: Vec<Mode> = contacts.iter().map(|contact| contact.iterate.mode).collect();
    let all = islands(&unknowns, &pairs, &modes);
    let layout = dynamics.layouts.of(&all[0].couplings).expect("a layout");
    let closed = (&contacts[..], &all[0].contacts[..]);
    let system = System::new(&all[0].couplings.blocks, &layout, &block_systems, closed);
    let centroids: Vec<Vector<f64>> =
        system.blocks.iter().map(|&block| dynamics.moments[block as usize].centroid).collect();
    check(&system, &centroids);
}

/// Solves by elimination without pivoting.
fn eliminated(mut matrix: Vec<Vec<f64>>, mut x: Vec<f64>) -> Vec<f64> {
    let n = x.len();
    for k in 0..n {
        let (done, rest) = matrix.split_at_mut(k + 1);
        let pivot = &done[k];
        for (row, m) in rest.iter_mut().zip(k + 1..) {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(pivot).for_each(|(x, &above)| *x -= factor * above);
            x[m] -= factor * x[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|m| matrix[k][m] * x[m]).sum();
        x[k] = (x[k] - known) / matrix[k][k];
    }
    x
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn both_levels_are_those_of_plain_arithmetic() {
    for motion in [Motion::Deformable, Motion::Rigid] {
        with_system([3, 2, 4], motion, |system, centroids| {
            let products = Products::new(system);
            let size = system.layout.pattern.size();
            let unit = |k: usize| (0..size).map(|m| if m == k { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
            let matrix: Vec<Vec<f64>> = (0..size).map(|k| products.times(&unit(k))).collect();
            let force = system.force();
            // The fine level.
            let mut expected = vec![0.0; size];
            for place in 0..system.blocks.len() {
                let own = system.layout.pattern.unknowns(place);
                let square = own.clone().map(|k| matrix[k][own.clone()].to_vec()).collect();
                expected[own.clone()].copy_from_slice(&eliminated(square, force[own].to_vec()));
            }
            // The coarse one: what each motion of each group does to its blocks.
            let groups = system.layout.groups.as_ref().expect("groups");
            let each = if motion == Motion::Rigid { 6 } else { 12 };
            let count = groups.pattern.size() / each;
            assert!(count > 2, "{count} groups");
            let mut motions: Vec<Vec<f64>> = Vec::new();
            for group in 0..count {
                let places: Vec<usize> =
                    (0..system.blocks.len()).filter(|&place| groups.of_place[place] as usize == group).collect();
                assert!((1..=8).contains(&places.len()));
                let sum = places.iter().fold(Vector::ZERO, |sum, &place| sum + centroids[place]);
                let centre = sum / places.len() as f64;
                for k in 0..each {
                    let d: [f64; 12] = std::array::from_fn(|m| if m == k { 1.0 } else { 0.0 });
                    let mut motion = vec![0.0; size];
                    for &place in &places {
                        let mut own = d;
                        own[..3].copy_from_slice(&displacement(centroids[place] - centre, &d).components());
                        motion[system.layout.pattern.unknowns(place)].copy_from_slice(&own[..each]);
                    }
                    motions.push(motion);
                }
            }
            let pulled: Vec<Vec<f64>> = motions.iter().map(|motion| products.times(motion)).collect();
            let coarse = motions.iter().map(|one| pulled.iter().map(|other| dot(one, other)).collect()).collect();
            let found = eliminated(coarse, motions.iter().map(|motion| dot(motion, &force)).collect());
            for (motion, found) in motions.iter().zip(found) {
                expected.iter_mut().zip(motion).for_each(|(sum, x)| *sum += found * x);
            }
            let level = TwoLevel::new(&products).expect("a preconditioner");
            let applied = level.precondition(&force).expect("finite");
            let largest = expected.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let apart = applied.iter().zip(&expected).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(largest > 0.0 && apart < 1e-4 * largest, "{motion:?}: {apart} of {largest}");
        });
    }
}

#[test]
fn whether_products_can_suffice_follows_from_springs_and_inertia() {
    with_system([3, 2, 4], Motion::Rigid, |system, _| {
        let products = Products::new(system);
        let size = system.layout.pattern.size();
        let own = |k: usize| {
            let unit: Vec<f64> = (0..size).map(|m| if m == k { 1.0 } else { 0.0 }).collect();
            products.times(&unit)[k]
        };
        let (mut all, mut inertia) = (0.0, 0.0);
        for (place, &block) in system.blocks.iter().enumerate() {
            let begin = system.layout.pattern.unknowns(place).start;
            all += (begin..begin + 3).map(own).sum::<f64>();
            inertia += 3.0 * system.block_systems[block as usize].stiffness[0];
        }
        let (found, expected) = (products.springs_to_inertia(), all / inertia - 1.0);
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} for {expected}");
        let patience = Patience::instead_of_factor(&system.layout.pattern, system.sides.len());
        assert!(patience.can_suffice(1.0) && !patience.can_suffice(100.0));
        assert!(Patience::WITHOUT_FACTOR.can_suffice(1e9));
    });
}

/// Blocks of twelve unknowns in a box, tied to those beside them, and so many contacts a tie: whether products can suffice instead of a factor
/// wherever springs are stiff.
fn is_tried_by_stiff_springs([x, y, z]: [u32; 3], contacts: usize) -> bool {
    let place = |i: u32, j: u32, k: u32| i + x * (j + y * k);
    let (mut pairs, mut at) = (Vec::new(), Vec::new());
    for (k, j, i) in (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| (k, j, i)))) {
        at.push([i, j, k].map(f64::from));
        let later = [(i + 1 < x, place(i + 1, j, k)), (j + 1 < y, place(i, j + 1, k)), (k + 1 < z, place(i, j, k + 1))];
        pairs.extend(later.into_iter().filter(|(is_there, _)| *is_there).map(|(_, other)| [place(i, j, k), other]));
    }
    pairs.sort_unstable();
    let unknowns = vec![12; at.len()];
    let graph = Graph { unknowns: &unknowns, pairs: &pairs };
    let pattern = Pattern::new(Renumbered::new(graph, &elimination_order(graph, &at).expect("an order")).graph());
    Patience::instead_of_factor(&pattern, contacts * pairs.len()).can_suffice(1e9)
}

/// A mass in three dimensions fills its factor, a wall of more blocks does not.
#[test]
fn a_factor_that_takes_more_memory_than_all_else_is_the_last_resort() {
    assert!(is_tried_by_stiff_springs([12, 12, 12], 4));
    assert!(!is_tried_by_stiff_springs([60, 1, 60], 4));
    assert!(!is_tried_by_stiff_springs([5, 5, 5], 4));
}

/// The solution by a factor in f64.
pub(super) fn direct(system: &System<'_, f64>) -> Vec<f64> {
    let pattern = &system.layout.pattern;
    let all = vec![true; pattern.panel_count()];
    let bearing = system.bearing(&all);
    let (mut values, mut solution) = (vec![0.0; pattern.values()], system.force());
    f64::factorize(pattern, &mut values, &all, &|panel, own| system.fill(panel, &bearing, own)).expect("a factor");
    f64::substitute(pattern, &values, &mut solution).expect("a solution");
    solution
}

/// `auto` has no factor where Δt is short. Where it is long, and where an iteration is given up since it begins far from the solution, a factor in f32 is
/// made; either way the solution is that of a factor in f64.
#[test]
fn auto_takes_a_factor_where_products_do_not_suffice() {
    for (time_step, far, has_factor) in [(1e-5, false, false), (1e-2, false, true), (2e-4, true, true)] {
        with_system_of([6, 7, 8], Motion::Deformable, (Solver::Auto, time_step), |system, _| {
            let (products, force, expected) = (Products::new(system), system.force(), direct(system));
            let marked = vec![true; system.layout.pattern.panel_count()];
            let mut single = SingleFactor::none(marked.len(), true);
            single.before = far.then(|| expected.iter().zip(0..).map(|(_, k)| f64::from(k % 7) * 1e12).collect());
            let mut memory = Vec::new();
            let by_single = BySingle { products: &products, memory: &mut memory, force: &force };
            assert!(by_single.solve(&mut single, &marked, usize::MAX, &mut IterationTimes::default()));
            assert_eq!(!memory.is_empty(), has_factor, "Δt {time_step}");
            let found = single.before.expect("a solution");
            let largest = expected.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let apart = found.iter().zip(&expected).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(apart < 1e-10 * largest, "Δt {time_step}: {apart} of {largest}");
        });
    }
}

#[test]
fn solutions_without_a_factor_are_those_of_a_factor_in_f64() {
    for (size, motion) in
        [([5, 4, 6], Motion::Deformable), ([5, 5, 6], Motion::Rigid), ([14, 1, 12], Motion::Deformable)]
    {
        with_system(size, motion, |system, _| {
            let (products, force) = (Products::new(system), system.force());
            let direct = direct(system);
            let level = TwoLevel::new(&products).expect("a preconditioner");
            let gradients = ConjugateGradients { products: &products, preconditioner: &level };
            let near: Vec<f64> = direct.iter().map(|x| 1.001 * x).collect();
            for before in [None, Some(&near[..])] {
                let found = gradients.solve(&force, before, Patience::WITHOUT_FACTOR).expect("a solution");
                // In the norm of energy.
                let error: Vec<f64> = found.iter().zip(&direct).map(|(a, b)| a - b).collect();
                let apart = dot(&error, &products.times(&error)).sqrt();
                let whole = dot(&direct, &force).sqrt();
                assert!(whole > 0.0 && apart < 1e-13 * whole, "{size:?}: {apart} of {whole}");
            }
            // Eight products do not suffice, which the second can tell.
            assert!(gradients.solve(&force, None, Patience::OLD_FACTOR).is_none());
        });
    }
}
