//! The brick wall of `rockproof bench --wall BRICKS --rigid` in rapier3d-f64, a rigid-body engine with warm-started impulses: what a step costs, and
//! how well the wall stands.
//!
//! `rockproof-rapier BRICKS STEPS`: two steps of settling, then the steps that are timed. Bricks never sleep, so that every step does the work of a
//! moving wall. All else is the engine's own choice, its four solver iterations among it.

use rapier3d_f64::prelude::*;
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

/// Of the wall in `rockproof bench`: the defaults of a scene.
const DENSITY: f64 = 2600.0;
const FRICTION: f64 = 0.6;
const GRAVITY: f64 = 9.81;
const TIME_STEP: f64 = 0.01;
const SETTLE: u32 = 2;

/// Bricks of 2 m × 1 m × 1 m in running bond on a fixed floor, about as many courses as bricks in a course; and the bricks, from below.
fn wall(bricks: u32) -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let mut world = PhysicsWorld {
        gravity: Vector::new(0.0, 0.0, -GRAVITY),
        integration_parameters: IntegrationParameters { dt: TIME_STEP, ..IntegrationParameters::default() },
        ..PhysicsWorld::default()
    };
    let per_course = (1..).find(|n| n * n >= bricks).unwrap_or(1);
    let cuboid = |low: [f64; 3], high: [f64; 3]| {
        let half = [0, 1, 2].map(|k| 0.5 * (high[k] - low[k]));
        let centre = Vector::new(0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2]));
        let collider = ColliderBuilder::cuboid(half[0], half[1], half[2]).density(DENSITY).friction(FRICTION);
        (centre, collider.build())
    };
    let (centre, floor) = cuboid([0.0; 3], [f64::from(2 * per_course + 1), 1.0, 1.0]);
    let body = world.bodies.insert(RigidBodyBuilder::fixed().translation(centre).build());
    world.colliders.insert_with_parent(floor, body, &mut world.bodies);
    let mut handles = Vec::new();
    for brick in 0..bricks {
        let (course, place) = (brick / per_course, brick % per_course);
        let (x, z) = (f64::from(2 * place + course % 2), f64::from(course + 1));
        let (centre, collider) = cuboid([x, 0.0, z], [x + 2.0, 1.0, z + 1.0]);
        let body = RigidBodyBuilder::dynamic().translation(centre).can_sleep(false).build();
        let body = world.bodies.insert(body);
        world.colliders.insert_with_parent(collider, body, &mut world.bodies);
        handles.push(body);
    }
    (world, handles)
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<u32> = arguments.iter().map_while(|text| text.parse().ok()).filter(|&number| number > 0).collect();
    let (&[bricks, steps], true) = (numbers.as_slice(), arguments.len() == 2) else {
        eprintln!("usage: rockproof-rapier BRICKS STEPS, both whole numbers from 1 on");
        return ExitCode::from(2);
    };
    let (mut world, handles) = wall(bricks);
    let laid: Vec<Vector> = handles.iter().map(|&brick| world.bodies[brick].translation()).collect();
    for _ in 0..SETTLE {
        world.step();
    }
    let begin = Instant::now();
    for _ in 0..steps {
        world.step();
    }
    let step = begin.elapsed().as_secs_f64() / f64::from(steps);
    let bodies = || handles.iter().map(|&brick| &world.bodies[brick]);
    let kinetic: f64 = bodies().map(RigidBody::kinetic_energy).sum();
    let weight = DENSITY * 2.0 * GRAVITY;
    let lost: f64 = bodies().zip(&laid).map(|(body, laid)| weight * (laid.z - body.translation().z)).sum();
    let sunk = bodies().zip(&laid).map(|(body, laid)| laid.z - body.translation().z).fold(0.0, f64::max);
    let moved = bodies().zip(&laid).map(|(body, laid)| (body.translation() - *laid).length()).fold(0.0, f64::max);
    let fastest = bodies().map(|body| body.linvel().length()).fold(0.0, f64::max);
    let report = format!(
        "{bricks} bricks, {steps} steps of {TIME_STEP} s: {:.3} ms a step by the clock\n\
         sunk by {sunk:.3e} m at most, moved by {moved:.3e} m at most, fastest brick {fastest:.3e} m/s\n\
         kinetic energy {kinetic:.3e} J, weight gave {lost:.3e} J\n",
        1e3 * step
    );
    // A reader that goes away early is no error.
    let _ = std::io::stdout().write_all(report.as_bytes());
    ExitCode::SUCCESS
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `rockproof bench --wall 10` lays it: courses of four, every second one moved by half a brick; 5,200 kg a brick; it stands.
    #[test]
    fn the_wall_is_the_one_of_the_bench_and_stands() {
        let (mut world, handles) = wall(10);
        let place = |world: &PhysicsWorld, brick: usize| world.bodies[handles[brick]].translation();
        assert_eq!(place(&world, 0), Vector::new(1.0, 0.5, 1.5));
        assert_eq!(place(&world, 4), Vector::new(2.0, 0.5, 2.5));
        for _ in 0..100 {
            world.step();
        }
        assert!((world.bodies[handles[9]].mass() - 5200.0).abs() < 1e-9);
        assert!((0..10).all(|brick| (place(&world, brick).z - [1.5, 2.5, 3.5][brick / 4]).abs() < 0.02));
    }
}
