//! Blocks that move more slowly than their coordinates can show: a step that is shorter than half of their last place leaves them where they are, though they have a
//! speed. In f32 that is 15 µm at 300 m from the origin.

use crate::audit::in_four_digits;
use rockproof_model::Scene;
use rockproof_model::simulation::step_in_words;
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{State, StepReport};

/// So many last places of a coordinate must be missing before that is told: fewer are what rounding does to every sum of steps.
const MIN_PLACES: f64 = 16.0;

/// Looks after each step for blocks that stand still though they move.
///
/// The update `v' = k_d·(2d/Δt − v)` of a step gives back its displacement d of the centroid, Δt·(v'/k_d + v)/2. A block stands still along an axis where no vertex
/// changed and d is not 0 there. Blocks that contacts or fixed points hold are left out: a spring whose force rounding leaves a little unbalanced asks for the same
/// tiny step again and again, and is none the longer for it.
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
            let mut is_held = self.is_held.clone();
            for contact in state.contacts.iter().filter(|contact| contact.mode.is_closed()) {
                contact.blocks.iter().for_each(|&block| is_held[block as usize] = true);
            }
            for (block, is_held) in is_held.into_iter().enumerate() {
                for axis in 0..3 {
                    self.look_at((block, axis), is_held, report, &after);
                }
            }
        }
        self.before = after;
    }

    fn look_at(
        &mut self,
        (block, axis): (usize, usize),
        is_held: bool,
        report: &StepReport,
        after: &[([R; 12], Vec<[R; 3]>)],
    ) {
        let ((old, from), (new, to)) = (&self.before[block], &after[block]);
        let way = report.time_step * (new[axis].to_f64() / self.dynamic + old[axis].to_f64()) / 2.0;
        let now = &mut self.now[block][axis];
        if is_held || way == 0.0 || from.iter().zip(to).any(|(from, to)| from[axis] != to[axis]) {
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
        let largest = to.iter().fold(0.0, |most: f64, v| most.max(v[axis].to_f64().abs()));
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
