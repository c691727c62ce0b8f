//! Islands in fractions: each is solved by itself, so that what one cannot have does not keep another from it.

use super::*;

const FLOOR: usize = 0;
const LOCKED: Mode = Mode::Locked;

/// A fixed floor, and towers of rigid cubes of 1 m on or above it.
#[derive(Default)]
struct Scene {
    blocks: Vec<Block>,
    bodies: Vec<Body>,
}

impl Scene {
    fn with_floor() -> Scene {
        let floor = cuboid([0, 0, -1].map(Number::from_integer), [100, 1, 0]);
        Scene {
            blocks: vec![floor],
            bodies: vec![body((Motion::Fixed, Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO)))],
        }
    }

    /// Adds a tower at x from a height up, its lowest cube longer by `lower` at its foot, and says which blocks it is.
    fn tower(&mut self, x: i32, from: i32, cubes: usize, lower: Number, velocity: &Vec3<Number>) -> Vec<usize> {
        let first = self.blocks.len();
        for k in 0..cubes {
            let bottom = from + k as i32;
            let z = Number::from_integer(bottom);
            let z = if k == 0 { z.plus(&lower.negated()) } else { z };
            self.blocks.push(cuboid([Number::from_integer(x), Number::ZERO, z], [x + 1, 1, bottom + 1]));
            self.bodies.push(body((Motion::Rigid, velocity.clone())));
        }
        (first..self.blocks.len()).collect()
    }

    fn look(&self, look: impl FnOnce(&Attempt<'_>, Cascade<'_>)) {
        with_blocks(&self.blocks, &self.bodies, look);
    }
}

fn rate(x: Number, y: Number) -> Vec3<Number> {
    Vec3::new(x, y, number(-1, 7))
}

/// The displacement of a block in the last solve, in fractions.
fn displacement(cascade: &mut Cascade<'_>, block: usize) -> Option<Vec<BigRational>> {
    let values = cascade.exact().unwrap();
    values.displacement(values.solves.last().unwrap(), block).cloned()
}

/// How many unknowns fractions have solved in the last solve.
fn solved(cascade: &mut Cascade<'_>) -> usize {
    cascade.exact().unwrap().solves.last().unwrap().solution().count()
}

#[test]
fn an_island_that_falls_may_have_any_size_and_one_that_is_pressed_48_unknowns() {
    let (velocity, rests) = (rate(number(1, 3), Number::ZERO), rate(Number::ZERO, Number::ZERO));
    let mut scene = Scene::with_floor();
    // 9 cubes have 54 unknowns, 8 have 48.
    let falling = scene.tower(0, 5, 9, Number::ZERO, &velocity);
    let large = scene.tower(10, 0, 9, number(1, 1000), &rests);
    let small = scene.tower(20, 0, 8, number(1, 1000), &rests);
    scene.look(|attempt, mut cascade| {
        let tie = contact(attempt, [falling[3], falling[4]]);
        assert_eq!(cascade.ask(&NextMode { contact: tie, mode: LOCKED }), Some(LOCKED));
        assert_eq!((cascade.levels.exact, cascade.levels.wide, cascade.levels.undecided), (1, [0; 4], 0));
        // It falls as each cube alone: d = Δt·v + Δt²·g/2.
        let t = &attempt.time_step;
        let fall = |rate: BigRational, pull: i64| rate * t + t * t * BigRational::new(pull.into(), 2.into());
        let part = |n: i64, d: i64| BigRational::new(n.into(), d.into());
        let d = [fall(part(1, 3), 0), part(0, 1), fall(part(-1, 7), -10), part(0, 1), part(0, 1), part(0, 1)];
        for &block in &falling {
            assert_eq!(displacement(&mut cascade, block).as_deref(), Some(&d[..]), "{block}");
        }
        // Nothing of all blocks is asked of fractions, and nothing solved for it.
        assert!(cascade.exact_of_all().is_none());
        assert_eq!(solved(&mut cascade), 54);
        assert_eq!(displacement(&mut cascade, large[0]), None);
        assert!(displacement(&mut cascade, small[7]).is_some());
        assert_eq!(solved(&mut cascade), 54 + 48);
    });
}

#[test]
fn friction_without_a_fraction_keeps_only_its_own_island_from_fractions() {
    let mut scene = Scene::with_floor();
    let falling = scene.tower(0, 5, 2, Number::ZERO, &rate(number(1, 3), Number::ZERO));
    // It slides by √5 times a fraction.
    let sliding = scene.tower(10, 0, 1, number(1, 1000), &rate(number(1, 1), number(2, 1)));
    scene.look(|attempt, mut cascade| {
        let (tie, slides) = (contact(attempt, [falling[0], falling[1]]), [FLOOR, sliding[0]]);
        let mode = |started: &StartingContact| if started.blocks == slides { Mode::Sliding } else { started.mode };
        cascade.solve(attempt.started.iter().map(mode).collect());
        assert_eq!(cascade.ask(&NextMode { contact: tie, mode: LOCKED }), Some(LOCKED));
        assert_eq!((cascade.levels.exact, cascade.levels.wide, cascade.levels.undecided), (1, [0; 4], 0));
        assert!(displacement(&mut cascade, falling[0]).is_some());
        assert_eq!(displacement(&mut cascade, sliding[0]), None);
        assert!(cascade.exact_of_all().is_some_and(|values| values.solves.len() == 2));
    });
}

#[test]
fn balls_of_128_bits_tell_what_may_be_free_where_those_of_two_f64_know_no_slip() {
    let mut scene = Scene::with_floor();
    let falling = scene.tower(0, 5, 2, Number::ZERO, &rate(number(1, 3), Number::ZERO));
    // Pressed against one another, and hardly moving along: a slip that two f64 cannot tell from none.
    let slow = Number::from_rational(BigRational::new(1.into(), num_bigint::BigInt::from(1) << 92));
    let below = scene.tower(10, 5, 1, Number::ZERO, &rate(Number::ZERO, Number::ZERO))[0];
    let above = scene.tower(10, 6, 1, number(1, 1000), &rate(slow, Number::ZERO))[0];
    scene.look(|attempt, mut cascade| {
        let (tie, slides) = (contact(attempt, [falling[0], falling[1]]), [below, above]);
        let mode = |started: &StartingContact| if started.blocks == slides { Mode::Sliding } else { started.mode };
        cascade.solve(attempt.started.iter().map(mode).collect());
        assert!(cascade.double().is_none());
        assert_eq!(cascade.ask(&NextMode { contact: tie, mode: LOCKED }), Some(LOCKED));
        assert_eq!((cascade.levels.exact, cascade.levels.wide, cascade.levels.undecided), (1, [0; 4], 0));
        // Nobody asked 256 bits for this solve.
        let solves = |level: &Level<'_, WideBall>| level.ready().map_or(0, |values| values.solves.len());
        assert!(solves(&cascade.wide[0]) == 2 && solves(&cascade.wide[1]) < 2);
    });
}

#[test]
fn a_force_too_small_for_balls_of_two_f64_is_left_to_wider_balls() {
    let mut scene = Scene::with_floor();
    let velocity = rate(number(1, 3), Number::ZERO);
    let below = scene.tower(0, 5, 1, Number::ZERO, &velocity)[0];
    let little = Number::from_rational(BigRational::new(1.into(), num_bigint::BigInt::from(1) << 150));
    let above = scene.tower(0, 6, 1, little, &velocity)[0];
    scene.look(|attempt, mut cascade| {
        let pressed = contact(attempt, [below, above]);
        assert_eq!(cascade.ask(&NextMode { contact: pressed, mode: LOCKED }), Some(LOCKED));
        assert!(cascade.may_move_freely(pressed) && !cascade.exact().unwrap().moves_freely(pressed));
        assert_eq!((cascade.levels.wide, cascade.levels.exact), ([0, 1, 0, 0], 0));
        assert_eq!(solved(&mut cascade), 0);
    });
}

#[test]
fn where_no_force_changes_friction_has_settled_however_little_presses() {
    let mut scene = Scene::with_floor();
    // Nothing presses these, which no ball can tell.
    scene.tower(0, 5, 2, Number::ZERO, &rate(number(1, 3), Number::ZERO));
    scene.look(|attempt, mut cascade| {
        let modes = attempt.first_modes();
        assert_eq!(cascade.ask(&FrictionSettled { modes: [&modes, &modes] }), Some(true));
        assert_eq!((cascade.levels.float, cascade.levels.undecided), (1, 0));
    });
    // The same with springs that pull: 0 for 0, an equality that only fractions tell.
    with_joints(-1000, &scene.blocks, &scene.bodies, |attempt, mut cascade| {
        let modes = attempt.first_modes();
        assert_eq!(cascade.ask(&FrictionSettled { modes: [&modes, &modes] }), Some(true));
        assert_eq!((cascade.levels.exact, cascade.levels.undecided), (1, 0));
    });
    // Where blocks overlap these "press" by less than nothing: 0 is more.
    scene.tower(10, 0, 1, number(1, 1000), &rate(Number::ZERO, Number::ZERO));
    with_joints(-1000, &scene.blocks, &scene.bodies, |attempt, mut cascade| {
        let modes = attempt.first_modes();
        assert_eq!(cascade.ask(&FrictionSettled { modes: [&modes, &modes] }), Some(false));
    });
}

#[test]
fn a_system_whose_springs_may_pull_is_not_known_to_be_definite() {
    let mut scene = Scene::with_floor();
    scene.tower(0, 0, 2, number(1, 1000), &rate(Number::ZERO, Number::ZERO));
    let is_definite = |change: &dyn Fn(&mut JointProperties)| {
        let mut definite = None;
        with_properties(change, &scene.blocks, &scene.bodies, |_, mut cascade| {
            definite = cascade.exact().map(|values| values.is_definite);
            assert_eq!(definite, Some(cascade.history.bound.is_some()));
        });
        definite
    };
    let minus = number(-1, 2);
    assert_eq!(is_definite(&|_| ()), Some(true));
    assert_eq!(is_definite(&|joint| (joint.friction, joint.cohesion) = (Number::ZERO, Number::ZERO)), Some(true));
    assert_eq!(is_definite(&|joint| joint.normal_stiffness = Some(minus.clone())), Some(false));
    assert_eq!(is_definite(&|joint| joint.shear_ratio = minus.clone()), Some(false));
    assert_eq!(is_definite(&|joint| joint.friction = minus.clone()), Some(false));
    assert_eq!(is_definite(&|joint| joint.cohesion = minus.clone()), Some(false));
}
