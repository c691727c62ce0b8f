//! Blocks that fall together, touching: told from others, solved without a matrix, and decided by fractions before balls of many bits.

mod corrections;
mod islands;

use super::super::answer::StepModel;
use super::super::decisions::{FrictionSettled, NextMode};
use super::super::islands::Island;
use super::super::open_close_iteration::first_time_step;
use super::super::prepare::PreparedStep;
use super::super::state::{ContactMemory, State};
use super::super::system::System;
use super::super::transfer::StartingContact;
use super::*;
use crate::field::{Field, Halve, LANES, Packed, PackedBalls, PackedDoubleBalls, UpperBound};
use crate::solve::{Correctable, fraction_free_solve};
use num_traits::Signed;
use rockproof_model::simulation::{Body, JointProperties, Motion, Simulation};
use rockproof_model::{Block, Number, Precision, Ring, ToleranceSpec, Vec3};
use std::marker::PhantomData;

/// The islands: what falls, what is pressed, what parts.
const FALLING: [usize; 2] = [1, 2];
const PRESSED: [usize; 1] = [3];
const PARTING: [usize; 2] = [4, 5];

/// A fixed floor; two cubes that fall together, one deformable; a cube that the floor presses; two cubes that touch, with other velocities.
fn with_cascade(look: impl FnOnce(&Attempt<'_>, Cascade<'_>)) {
    let cube = |x: i32, z: Number, top: i32| cuboid([Number::from_integer(x), Number::ZERO, z], [x + 1, 1, top]);
    let blocks = [
        cuboid([0, 0, -1].map(Number::from_integer), [20, 1, 0]),
        cube(0, number(5, 1), 6),
        cube(0, number(6, 1), 7),
        cube(5, number(-1, 1000), 1),
        cube(10, number(5, 1), 6),
        cube(10, number(6, 1), 7),
    ];
    let motions = [Motion::Fixed, Motion::Rigid, Motion::Deformable, Motion::Rigid, Motion::Rigid, Motion::Deformable];
    let rate = |n| Vec3::new(number(n, 3), Number::ZERO, number(-1, 7));
    let velocities = [rate(0), rate(1), rate(1), rate(0), rate(1), rate(2)];
    let bodies: Vec<Body> = motions.into_iter().zip(velocities).map(body).collect();
    with_blocks(&blocks, &bodies, look);
}

fn number(n: i64, d: i64) -> Number {
    Number::from_rational(BigRational::new(n.into(), d.into()))
}

fn cuboid(low: [Number; 3], high: [i32; 3]) -> Block {
    let ([a, b, c], [x, y, z]) = (low, high.map(Number::from_integer));
    Block::cuboid(&Vec3::new(a, b, c), &Vec3::new(x, y, z)).unwrap()
}

fn body((motion, velocity): (Motion, Vec3<Number>)) -> Body {
    Body { motion, velocity, ..Body::default() }
}

/// The first solve of these blocks under 10 m/s², with joints of 10⁹ N/m.
fn with_blocks(blocks: &[Block], bodies: &[Body], look: impl FnOnce(&Attempt<'_>, Cascade<'_>)) {
    with_joints(1_000_000_000, blocks, bodies, look);
}

/// The same with joints of this stiffness in N/m.
fn with_joints(normal: i64, blocks: &[Block], bodies: &[Body], look: impl FnOnce(&Attempt<'_>, Cascade<'_>)) {
    with_properties(|joint| joint.normal_stiffness = Some(number(normal, 1)), blocks, bodies, look);
}

/// The same with joints that are changed so.
fn with_properties(
    change: impl FnOnce(&mut JointProperties),
    blocks: &[Block],
    bodies: &[Body],
    look: impl FnOnce(&Attempt<'_>, Cascade<'_>),
) {
    with_memory(change, blocks, bodies, |_| None, look);
}

/// The same where a step before left something of contacts.
fn with_memory(
    change: impl FnOnce(&mut JointProperties),
    blocks: &[Block],
    bodies: &[Body],
    memory: impl Fn(&StartingContact) -> Option<ContactMemory>,
    look: impl FnOnce(&Attempt<'_>, Cascade<'_>),
) {
    let mut simulation =
        Simulation { gravity: Vec3::new(Number::ZERO, Number::ZERO, number(-10, 1)), ..Simulation::default() };
    simulation.joints.other.normal_stiffness = Some(number(1_000_000_000, 1));
    change(&mut simulation.joints.other);
    let shapes: Vec<&Block> = blocks.iter().collect();
    let tolerances = ToleranceSpec::default().derive(&shapes, Precision::F64).unwrap();
    let model = StepModel { shapes: &shapes, bodies, simulation: &simulation, tolerances: &tolerances };
    let mut state = State::initial(&model);
    let first = PreparedStep::new(&model, &state).unwrap();
    state.contacts = first.attempt(first_time_step(&first)).started.iter().filter_map(memory).collect();
    let prepared = PreparedStep::new(&model, &state).unwrap();
    let attempt = prepared.attempt(first_time_step(&prepared));
    let mut cascade = Cascade::new(&attempt, &prepared.layout, StepLevelCounts::default());
    cascade.solve(attempt.first_modes());
    look(&attempt, cascade);
}

/// A contact between two blocks.
fn contact(attempt: &Attempt<'_>, blocks: [usize; 2]) -> usize {
    attempt.started.iter().position(|started| started.blocks == blocks).expect("they touch")
}

#[test]
fn only_blocks_whose_contacts_bear_no_force_are_solved_without_a_matrix() {
    with_cascade(|attempt, _| {
        let mut values: AttemptValues<'_, BigRational> = AttemptValues::new(attempt, 0);
        let modes = attempt.first_modes();
        let friction = values.friction(&modes).unwrap();
        for is_definite in [true, false] {
            values.is_definite = is_definite;
            for (blocks, is_free) in [(&FALLING[..], true), (&PRESSED, false), (&PARTING, false)] {
                let contacts = (0..modes.len()).filter(|&k| {
                    modes[k] != Mode::Open && attempt.started[k].blocks.iter().any(|b| blocks.contains(b))
                });
                let island = Island { blocks: blocks.to_vec(), contacts: contacts.collect() };
                let slip = |k: usize| Some(friction[k].as_ref());
                let system = System::of(&values, &modes, slip, Some(&island)).unwrap();
                let solved = BigRational::solve(&system, None, None);
                let free = system.free_motion();
                assert_eq!(free.is_some(), is_free && is_definite, "{blocks:?}");
                assert!(free.is_none() || free == solved);
                let moving: Vec<usize> = attempt.moving().map(|(block, _)| block).collect();
                let whole = values.assembled(&modes).unwrap();
                let all = fraction_free_solve(&whole.dense(), &whole.right).unwrap();
                let mut rest = all.into_iter();
                let plain = moving.iter().flat_map(|block| {
                    let own: Vec<BigRational> =
                        rest.by_ref().take(attempt.sizes[attempt.rows[*block].unwrap()]).collect();
                    if blocks.contains(block) { own } else { Vec::new() }
                });
                assert_eq!(solved, Some(plain.collect()), "{blocks:?}");
            }
        }
    });
}

#[test]
fn balls_tell_which_blocks_may_be_free() {
    with_cascade(|_, mut cascade| {
        let free = cascade.double().unwrap().blocks_without_force().unwrap();
        assert_eq!(free, [false, true, true, false, false, false]);
    });
}

#[test]
fn a_tie_of_blocks_that_fall_together_needs_no_balls_of_many_bits() {
    with_cascade(|attempt, mut cascade| {
        let tie = contact(attempt, FALLING);
        assert_eq!(cascade.ask(&NextMode { contact: tie, mode: Mode::Locked }), Some(Mode::Locked));
        assert_eq!((cascade.levels.exact, cascade.levels.wide), (1, [0; 4]));
        assert!(cascade.wide.iter().all(|level| matches!(level, Level::Unused)));
        // The others bear forces, which balls tell.
        let pressed = contact(attempt, [0, PRESSED[0]]);
        assert_eq!(cascade.ask(&NextMode { contact: pressed, mode: Mode::Locked }), Some(Mode::Locked));
        assert!(!cascade.may_move_freely(pressed) && !cascade.may_move_freely(contact(attempt, PARTING)));
        assert_eq!((cascade.levels.exact, cascade.levels.undecided), (1, 0));
    });
}

/// An operation on f64 rounds by 2⁻⁵³ of its result, one on two of them by 2⁻¹⁰¹. No entry of a residual is further than 64 operations from what enters
/// it, and what is rounded on the way is at most as large as the sizes of the terms that the entry is made of.
const BY_F64: i64 = 6 - 53;
const BY_TWO_F64: i64 = 6 - 101;

/// The sizes of numbers in place of their values, so that nothing cancels: a residual of these is the sum of the sizes of its terms.
#[derive(Clone, Copy)]
struct Sizes<S>([f64; LANES], PhantomData<S>);

impl<S> Sizes<S> {
    fn with(self, other: &Self, of: impl Fn(f64, f64) -> f64) -> Self {
        Sizes(std::array::from_fn(|lane| of(self.0[lane], other.0[lane])), PhantomData)
    }
}

impl<S: Copy> Ring for Sizes<S> {
    fn from_i32(value: i32) -> Self {
        Sizes([f64::from(value).abs(); LANES], PhantomData)
    }
    fn plus(&self, other: &Self) -> Self {
        self.with(other, |a, b| a + b)
    }
    fn minus(&self, other: &Self) -> Self {
        self.plus(other)
    }
    fn times(&self, other: &Self) -> Self {
        self.with(other, |a, b| a * b)
    }
    fn negated(&self) -> Self {
        *self
    }
}

impl<S: Copy> Halve for Sizes<S> {
    fn half(&self) -> Self {
        self.with(self, |size, _| size / 2.0)
    }
}

impl<S: StepNumber + Copy> Packed for Sizes<S> {
    type Single = S;
    fn of(singles: [&S; LANES]) -> Self {
        Sizes(singles.map(|single| single.nearby().0.abs()), PhantomData)
    }
    fn single(&self, lane: usize) -> S {
        S::of_number(&Number::from_f64(self.0[lane]).unwrap(), 106)
    }
}

/// What must fail: numbers that claim to be of two f64 and are calculated in one.
#[derive(Clone, Copy)]
struct OneF64(PackedBalls);

impl Ring for OneF64 {
    fn from_i32(value: i32) -> Self {
        OneF64(PackedBalls::from_i32(value))
    }
    fn plus(&self, other: &Self) -> Self {
        OneF64(self.0.plus(&other.0))
    }
    fn minus(&self, other: &Self) -> Self {
        OneF64(self.0.minus(&other.0))
    }
    fn times(&self, other: &Self) -> Self {
        OneF64(self.0.times(&other.0))
    }
    fn negated(&self) -> Self {
        OneF64(self.0.negated())
    }
}

impl Halve for OneF64 {
    fn half(&self) -> Self {
        OneF64(self.0.half())
    }
}

impl Packed for OneF64 {
    type Single = DoubleBall;
    fn of(singles: [&DoubleBall; LANES]) -> Self {
        let near = singles.map(|single| single.nearby()).map(|(middle, radius)| Ball { middle, radius });
        OneF64(PackedBalls::of(near.each_ref()))
    }
    fn single(&self, lane: usize) -> DoubleBall {
        let Ball { middle, radius } = self.0.single(lane);
        DoubleBall { radius, ..DoubleBall::exactly(middle, 0.0) }
    }
}

/// The most that the radii of a residual calculated four at a time may be: what those of single ones are, a share of the sizes of the terms, and what is
/// lost below the least f64, times stiffness.
fn largest_radii<S: StepNumber + Copy>(system: &System<'_, '_, S>, x: Option<&[S]>, share: i64) -> Vec<UpperBound> {
    let single = system.residual_singly(x);
    let zeros = vec![S::from_i32(0); single.len()];
    let sizes = system.residual_packed::<Sizes<S>>(Some(x.unwrap_or(&zeros)));
    let most = |(single, size): (&S, &S)| {
        let own = single.radius().unwrap();
        let rounded = UpperBound::of_f64(size.nearby().0).unwrap().shifted(share);
        own.plus(own.shifted(-20)).plus(rounded).plus(UpperBound::power_of_two(-900))
    };
    single.iter().zip(&sizes).map(most).collect()
}

/// Holds residuals and motions of four contacts at a time against those of one, at the solution of the last solve and at another vector.
fn hold_packed<P: Packed<Single = S>, S: StepNumber + Correctable + Copy + std::fmt::Debug>(
    attempt: &Attempt<'_>,
    values: &AttemptValues<'_, S>,
    modes: &[Mode],
    share: i64,
) {
    let friction = values.friction(modes).unwrap();
    let system = System::of(values, modes, |k| Some(friction[k].as_ref()), None).unwrap();
    let solved: Vec<S> = values.solves[0].solution().map(|x| x.corrected(0.0, 0, 106)).collect();
    let other: Vec<S> =
        (0..solved.len()).map(|k| S::of_rational(&BigRational::new((k as i64 - 9).into(), 7000.into()), 106)).collect();
    for x in [None, Some(&solved[..]), Some(&other[..])] {
        let (packed, single) = (system.residual_packed::<P>(x), system.residual_singly(x));
        assert_eq!(packed.len(), single.len());
        for ((packed, single), most) in packed.iter().zip(&single).zip(largest_radii(&system, x, share)) {
            assert_eq!(packed.middle(), single.middle(), "{packed:?} {single:?}");
            assert!(packed.radius().unwrap() >= single.radius().unwrap(), "{packed:?} {single:?}");
            assert!(packed.radius().unwrap() <= most, "{packed:?} {single:?} {most:?}");
        }
    }
    for k in 0..attempt.started.len() {
        let (contact, solve) = (values.contact(k).unwrap(), &values.solves[0]);
        let [a, b] = attempt.started[k].blocks.map(|block| values.displacement(solve, block).unwrap());
        let moved = contact.moved([a, b]);
        let along = contact.normal.dot(&moved);
        let stretch = contact.stretch.plus(&contact.across(&moved, &along));
        assert_eq!(values.gap(solve, k).unwrap().middle(), contact.gap.plus(&along).middle());
        assert_eq!(values.stretch(solve, k).unwrap().map(Field::middle), stretch.map(Field::middle));
        assert!(values.gap(solve, k).unwrap().radius() >= contact.gap.plus(&along).radius());
    }
}

#[test]
fn four_contacts_at_a_time_have_the_middles_of_single_ones() {
    with_cascade(|attempt, mut cascade| {
        let mut modes = attempt.first_modes();
        let slides = contact(attempt, PARTING);
        let float = cascade.float().unwrap();
        hold_packed::<PackedBalls, Ball>(attempt, float, &modes, BY_F64);
        let double = cascade.double().unwrap();
        hold_packed::<PackedDoubleBalls, DoubleBall>(attempt, double, &modes, BY_TWO_F64);
        // One that slides beside others that do not, and a last group that is not full.
        modes[slides] = Mode::Sliding;
        for open in 0..5 {
            modes[open] = Mode::Open;
            assert!(double.friction(&modes).unwrap()[slides].as_ref().is_some_and(|slip| !slip.spring.is_zero()));
            hold_packed::<PackedDoubleBalls, DoubleBall>(attempt, double, &modes, BY_TWO_F64);
        }
    });
}

#[test]
fn a_residual_of_four_contacts_at_a_time_holds_the_exact_one() {
    with_cascade(|attempt, mut cascade| {
        let modes = attempt.first_modes();
        let exact: AttemptValues<'_, BigRational> = AttemptValues::new(attempt, 0);
        let exact = System::of(&exact, &modes, |_| Some(None), None).unwrap();
        let values = cascade.double().unwrap();
        let x: Vec<BigRational> = (0..exact.residual_singly(None).len())
            .map(|k| BigRational::new((k as i64 - 9).into(), 1024.into()))
            .collect();
        let balls: Vec<DoubleBall> = x.iter().map(|x| DoubleBall::of_rational(x, 106)).collect();
        let system = System::of(values, &modes, |_| Some(None), None).unwrap();
        let residual = system.residual_packed::<PackedDoubleBalls>(Some(&balls));
        let in_one = system.residual_packed::<OneF64>(Some(&balls));
        let largest = largest_radii(&system, Some(&balls), BY_TWO_F64);
        for (k, value) in exact.residual_singly(Some(&x)).into_iter().enumerate() {
            for ball in [&residual[k], &in_one[k]] {
                assert!((ball.middle() - &value).abs() <= ball.radius().unwrap().to_rational());
            }
            assert!(residual[k].radius().unwrap() <= largest[k], "{:?}", residual[k]);
            // What is calculated in one f64 is told from that.
            assert!(in_one[k].radius().unwrap() > largest[k], "{:?}", in_one[k]);
        }
    });
}
