//! Blocks that move more slowly than their coordinates can show: a step that is shorter than half of their last place leaves them where they are, though they have a
//! speed. In f32 that is 15 µm at 300 m from the origin.

use crate::exact_float::in_four_digits;
use crate::f64_vector::{dot, point};
use rockproof_model::Scene;
use rockproof_model::simulation::step_in_words;
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{Mode, State, StepReport};

/// So many last places of a coordinate must be missing before that is told: fewer are what rounding does to every sum of steps.
const MIN_PLACES: f64 = 16.0;

/// Looks after each step for blocks that stand still though they move.
///
/// The update `v' = k_d·(2d/Δt − v)` of a step gives back its displacement d of the centroid, Δt·(v'/k_d + v)/2. A block stands still along an axis where no vertex
/// changed and d is not 0 there. Of blocks that contacts or fixed points hold nothing is said: a spring whose force rounding leaves a little unbalanced asks for the
/// same tiny step again and again, and is none the longer for it. A contact that slides holds a block along its normal alone, so of d counts what lies across the
/// normals of all that slide.
pub struct StandstillWatch<R> {
    dynamic: f64,
    /// Last places as a share of a coordinate.
    epsilon: f64,
    is_held: Vec<bool>,
    before: Vec<([R; 12], Vec<[R; 3]>)>,
    /// Of each block and axis what is missing since it stands still.
    now: Vec<[Option<Missing>; 3]>,
    worst: Option<Standstill>,
    blocks: Vec<bool>,
}

/// What a block is behind along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Missing {
    /// The first step in which it stood still.
    since: i64,
    /// In m, with its sign.
    way: f64,
    /// The same, whatever the signs were.
    ways: f64,
    /// In s.
    time: f64,
}

/// A block that stood still though it had a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standstill {
    /// How many there are.
    pub blocks: usize,
    /// The block that is furthest behind.
    pub worst: usize,
    /// Along which axis, `x`, `y` or `z`; along the others it may have moved.
    pub axis: char,
    /// Its mean speed along that axis (m/s).
    pub speed: f64,
    /// The first step in which it stood still.
    pub since: i64,
    /// How far it is behind (m).
    pub missing: f64,
}

/// What keeps a block where it is.
#[derive(Clone, Debug, PartialEq)]
enum Held {
    /// Fixed points, its motion, or a contact that is locked.
    Fast,
    /// Contacts that slide, along these directions: unit vectors, each square to the others.
    Along(Vec<[f64; 3]>),
}

impl Held {
    /// The sine below which two normals are one.
    const SINE: f64 = 1e-3;

    /// Adds a closed contact with this unit normal.
    fn add(&mut self, mode: Mode, normal: [f64; 3]) {
        let Held::Along(known) = self else { return };
        if mode == Mode::Locked {
            *self = Held::Fast;
            return;
        }
        let rest = across(normal, known);
        let length = dot(rest, rest).sqrt();
        if length > Held::SINE {
            known.push(rest.map(|component| component / length));
        }
    }

    /// The part of a way that nothing keeps the block from going.
    fn free(&self, way: [f64; 3]) -> [f64; 3] {
        match self {
            Held::Fast => [0.0; 3],
            // What three directions leave is rounding.
            Held::Along(known) if known.len() == 3 => [0.0; 3],
            Held::Along(known) => across(way, known),
        }
    }
}

/// The part of a vector across unit vectors that are square to one another.
fn across(v: [f64; 3], units: &[[f64; 3]]) -> [f64; 3] {
    units.iter().fold(v, |v, unit| {
        let along = dot(v, *unit);
        std::array::from_fn(|k| v[k] - along * unit[k])
    })
}

impl<R: Real> StandstillWatch<R> {
    /// Watches a run from a state on; `epsilon` is the distance from 1 to the next number of its precision.
    pub fn new(scene: &Scene, epsilon: f64, state: &State<R>) -> StandstillWatch<R> {
        let is_point = |block: usize| scene.simulation.fixed_points.iter().any(|point| point.block == block);
        let blocks = scene.blocks.iter().enumerate();
        StandstillWatch {
            dynamic: scene.simulation.control.dynamic.approximate(),
            epsilon,
            is_held: blocks.map(|(number, block)| block.body.is_fixed() || is_point(number)).collect(),
            before: places(state),
            now: vec![[None; 3]; scene.blocks.len()],
            worst: None,
            blocks: vec![false; scene.blocks.len()],
        }
    }

    /// Looks at a step and the state after it.
    pub fn look(&mut self, report: &StepReport, state: &State<R>) {
        let after = places(state);
        if report.step > 0 && self.dynamic > 0.0 {
            let held = |&is_held: &bool| if is_held { Held::Fast } else { Held::Along(Vec::new()) };
            let mut all: Vec<Held> = self.is_held.iter().map(held).collect();
            for contact in state.contacts.iter().filter(|contact| contact.mode.is_closed()) {
                let normal = point(contact.normal);
                contact.blocks.iter().for_each(|&block| all[block as usize].add(contact.mode, normal));
            }
            for (block, held) in all.into_iter().enumerate() {
                self.look_at(block, &held, report, &after);
            }
        }
        self.before = after;
    }

    fn look_at(&mut self, block: usize, held: &Held, report: &StepReport, after: &[([R; 12], Vec<[R; 3]>)]) {
        let ((old, from), (new, to)) = (&self.before[block], &after[block]);
        let stands: [bool; 3] =
            std::array::from_fn(|axis| from.iter().zip(to).all(|(from, to)| from[axis] == to[axis]));
        // All of the way first: what a slope keeps the block from along one axis depends on how it moves along the others.
        let way = std::array::from_fn(|axis| {
            report.time_step * (new[axis].to_f64() / self.dynamic + old[axis].to_f64()) / 2.0
        });
        let free = held.free(way);
        for axis in 0..3 {
            let way = if stands[axis] { free[axis] } else { 0.0 };
            let largest = to.iter().fold(0.0, |most: f64, v| most.max(v[axis].to_f64().abs()));
            self.add((block, axis), way, report, largest);
        }
    }

    /// Adds a step in which a block went so far along an axis (m) and its coordinates, the largest of which is given, did not show it; 0 where they did.
    fn add(&mut self, (block, axis): (usize, usize), way: f64, report: &StepReport, largest: f64) {
        let now = &mut self.now[block][axis];
        if way == 0.0 {
            *now = None;
            return;
        }
        let known = now.unwrap_or(Missing { since: report.step, way: 0.0, ways: 0.0, time: 0.0 });
        let Missing { since, way, ways, time } = Missing {
            since: known.since,
            way: known.way + way,
            ways: known.ways + way.abs(),
            time: known.time + report.time_step,
        };
        *now = Some(Missing { since, way, ways, time });
        if way.abs() <= ways / 2.0 || way.abs() <= MIN_PLACES * self.epsilon * largest {
            return;
        }
        self.blocks[block] = true;
        if self.worst.is_none_or(|worst| way.abs() > worst.missing) {
            let speed = way.abs() / time;
            let axis = ['x', 'y', 'z'][axis];
            self.worst = Some(Standstill { blocks: 0, worst: block, axis, speed, since, missing: way.abs() });
        }
    }

    /// The block that was furthest behind, if any was.
    pub fn found(&self) -> Option<Standstill> {
        let blocks = self.blocks.iter().filter(|stood| **stood).count();
        self.worst.map(|worst| Standstill { blocks, ..worst })
    }
}

fn places<R: Real>(state: &State<R>) -> Vec<([R; 12], Vec<[R; 3]>)> {
    let place = |v: &rockproof_stepper::Vector<R>| [v.x, v.y, v.z];
    state.blocks.iter().map(|block| (block.velocity, block.vertices.iter().map(place).collect())).collect()
}

impl Standstill {
    /// The same in words, with the numbers that the run calculated in.
    pub fn sentence(&self, precision: &str) -> String {
        let Standstill { blocks, worst, axis, speed, since, missing } = self;
        let others = match blocks {
            1 => String::new(),
            _ => format!(" ({blocks} blocks did so)"),
        };
        format!(
            "block {worst} stood still along {axis} from {} on at a speed of {} m/s, and is {} m behind: {precision} has no numbers for such short steps there{others}",
            step_in_words(*since),
            in_four_digits(*speed),
            in_four_digits(*missing)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_holds_along_its_normal_alone() {
        let mut held = Held::Along(Vec::new());
        held.add(Mode::Sliding, [0.6, 0.0, 0.8]);
        let near =
            |found: [f64; 3], way: [f64; 3]| found.iter().zip(way).all(|(found, way)| (found - way).abs() < 1e-12);
        assert!(near(held.free([0.8, 0.0, -0.6]), [0.8, 0.0, -0.6]), "down the slope");
        assert!(near(held.free([0.6, 0.0, 0.8]), [0.0; 3]), "off it");
        held.add(Mode::Sliding, [0.6, 0.0, 0.8]);
        assert!(near(held.free([0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]), "one direction");
        held.add(Mode::Sliding, [0.0, 0.6, 0.8]);
        assert_eq!(held.free([0.0, 1.0, 0.0]).map(|way| way == 0.0), [false; 3], "along the line of both");
        let mut fast = held.clone();
        fast.add(Mode::Locked, [1.0, 0.0, 0.0]);
        held.add(Mode::Sliding, [1.0, 0.0, 0.0]);
        assert_eq!([held.free([1.0; 3]), fast.free([1.0; 3])], [[0.0; 3]; 2]);
    }
}
