//! What sets a pair in motion: velocities, materials, joints, gravity and Δt, drawn for the pair alone, so that its blocks and
//! tolerance sets stay what they are.

use crate::directed::f64_view::{F64Vector, times};
use crate::families::{CoordinateStyle, MotionStyle, PairSampler};
use crate::tolerance_sets::{binary_below, number, size};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof_differential::motion::PairMotion;
use rockproof_model::simulation::{Kinematics, Simulation, Unconverged};
use rockproof_model::{Block, Body, Motion, Number, Vec3};

/// The generator of one pair's motion: the seed is the key, the pair the stream.
pub fn generator(seed: u64, index: u64) -> ChaCha8Rng {
    keyed(*b"rockproof steps, version 2......", seed, index)
}

/// A generator whose key is a name of 24 bytes and the seed, and whose stream is the pair.
pub(crate) fn keyed(mut key: [u8; 32], seed: u64, index: u64) -> ChaCha8Rng {
    key[24..].copy_from_slice(&seed.to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(index);
    rng
}

/// Whether a pair is among the share that moves: one in `every`, none for 0.
pub fn moves(rng: &mut ChaCha8Rng, every: u64) -> bool {
    every > 0 && PairSampler::with_style(rng, CoordinateStyle::Grid).below(every) == 0
}

/// A motion for two blocks. Lengths are shares of what `auto` allows a vertex to move in a step, so that most steps are accepted
/// and some are cut.
pub fn drawn(rng: &mut ChaCha8Rng, manner: MotionStyle, a: &Block, b: &Block, steps: u32) -> PairMotion {
    let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
    let draw = MotionSampler::new(&mut sampler, a, b);
    draw.motion(manner, steps)
}

/// The sides of a block's box: least and greatest coordinate on each axis (m).
fn sides(block: &Block) -> [[f64; 2]; 3] {
    let points: Vec<F64Vector> = block.vertices().iter().map(|v| v.components().map(|c| c.approximate())).collect();
    [0, 1, 2].map(|axis| {
        let along = || points.iter().map(|p| p[axis]);
        [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
    })
}

/// The share of motions in which soft contacts sink until they are deeper than g, and are kept, in percent.
const SINKING_PERCENT: u64 = 15;

/// What a motion is drawn from.
struct MotionSampler<'k, 'r> {
    sampler: &'k mut PairSampler<'r>,
    blocks: [&'k Block; 2],
    /// The axis along which the boxes are furthest apart, and on which side of A block B is there.
    axis: usize,
    side: f64,
    /// How far a vertex may move in a step (m); a power of two.
    reach: f64,
    /// Half the longest side (m); a power of two at most.
    half: f64,
    /// The same of each block.
    halves: [f64; 2],
    /// Makes numbers that f32 does not hold; 1 where they are to stay short.
    long: f64,
}

impl<'k, 'r> MotionSampler<'k, 'r> {
    fn new(sampler: &'k mut PairSampler<'r>, a: &'k Block, b: &'k Block) -> MotionSampler<'k, 'r> {
        let ((edge_a, side_a), (edge_b, side_b)) = (size(a), size(b));
        let half = side_a.max(side_b) / 2.0;
        let reach = binary_below((edge_a.min(edge_b) / 16.0).min(half / 100.0));
        let (in_a, in_b) = (sides(a), sides(b));
        let apart = |axis: usize| {
            let (above, below) = (in_b[axis][0] - in_a[axis][1], in_a[axis][0] - in_b[axis][1]);
            if above >= below { (above, 1.0) } else { (below, -1.0) }
        };
        let (axis, side) = (1..3).fold((0, apart(0)), |best, axis| {
            let next = apart(axis);
            if next.0 > best.1.0 { (axis, next) } else { best }
        });
        let long = if sampler.chance(30) { 1.0 + sampler.between(1, 999) as f64 / 65_537.0 } else { 1.0 };
        let (half, halves) = (binary_below(half), [side_a, side_b].map(|side| binary_below(side / 2.0)));
        MotionSampler { sampler, blocks: [a, b], axis, side: side.1, reach, half, halves, long }
    }

    /// A number, short or long.
    fn number(&self, value: f64) -> Number {
        number(value * self.long)
    }

    fn vector(&self, v: F64Vector) -> Vec3<Number> {
        let [x, y, z] = v.map(|c| self.number(c));
        Vec3::new(x, y, z)
    }

    /// `normal` from A towards B, `along` on another axis.
    fn direction(&mut self, normal: f64, along: f64) -> F64Vector {
        let mut v = [0.0; 3];
        v[self.axis] = self.side * normal;
        let other = (self.axis + 1 + self.sampler.below(2) as usize) % 3;
        v[other] = along * self.sampler.sign() as f64;
        if self.sampler.chance(25) {
            let last = 3 - self.axis - other;
            v[last] = along * 0.75 * self.sampler.sign() as f64;
        }
        v
    }

    fn pick(&mut self, options: &[f64]) -> f64 {
        *self.sampler.pick(options)
    }

    fn motion(mut self, manner: MotionStyle, steps: u32) -> PairMotion {
        // Who moves: mostly B on a fixed A; both where they fly at each other.
        let fixed = *self.sampler.pick(&[Some(0), Some(0), Some(0), Some(1), None]);
        let mut simulation = self.simulation(fixed);
        let time_step = simulation.control.time_step.approximate();
        let speed = self.reach / time_step;
        let sinks = self.sampler.chance(SINKING_PERCENT);
        let mut bodies = [Body::default(), Body::default()];
        for (number, body) in bodies.iter_mut().enumerate() {
            if fixed == Some(number) {
                body.motion = Motion::Fixed;
                continue;
            }
            body.motion = if self.sampler.chance(60) { Motion::Rigid } else { Motion::Deformable };
            // A moves towards B along the axis, B against it.
            let towards = if number == 0 { 1.0 } else { -1.0 };
            let (velocity, spin) = if sinks { self.sinking() } else { self.velocity(manner) };
            let toward = |v: F64Vector| {
                let mut v = v;
                v[self.axis] *= towards;
                v
            };
            body.velocity = self.vector(times(toward(velocity), speed));
            body.spin = self.vector(times(spin, speed / self.halves[number]));
        }
        self.joint(&mut simulation, &bodies, sinks);
        PairMotion { bodies, simulation, steps }
    }

    /// Velocity and spin, as shares of what moves a vertex by the reach in one step.
    fn velocity(&mut self, manner: MotionStyle) -> (F64Vector, F64Vector) {
        const NORMAL: [f64; 8] = [0.0, 0.0, 0.015625, 0.125, 0.5, -0.0625, -0.5, 1.5];
        const ALONG: [f64; 6] = [0.0, 0.0, 0.0009765625, 0.0625, 0.5, 0.75];
        const SPIN: [f64; 6] = [0.0, 0.0, 0.015625, 0.25, 0.75, 2.0];
        let (normal, along, spin) = match manner {
            MotionStyle::Any => (self.pick(&NORMAL), self.pick(&ALONG), self.pick(&SPIN)),
            MotionStyle::Sliding => (self.pick(&NORMAL[..4]), self.pick(&ALONG[2..]), self.pick(&SPIN[..3])),
            MotionStyle::Pressing => (self.pick(&NORMAL[2..5]), self.pick(&ALONG), self.pick(&SPIN[..4])),
            MotionStyle::Turning => (self.pick(&NORMAL), self.pick(&ALONG[..4]), self.pick(&SPIN[2..])),
        };
        let velocity = self.direction(normal, along);
        let axis = self.sampler.below(3) as usize;
        let mut turning = [0.0; 3];
        turning[axis] = spin * self.sampler.sign() as f64;
        if self.sampler.chance(40) {
            turning[(axis + 1) % 3] = spin * 0.5;
        }
        // A whole turn in a step is more than any limit allows at any Δt.
        let wild = if self.sampler.chance(1) { 4096.0 } else { 1.0 };
        (times(velocity, wild), turning)
    }

    /// Velocity towards the other block, with which a soft contact sinks through g within some steps, and spin.
    fn sinking(&mut self) -> (F64Vector, F64Vector) {
        let (normal, along) = (self.pick(&[0.5, 0.625, 0.75]), self.pick(&[0.0, 0.0, 0.015625, 0.25]));
        (self.direction(normal, along), [0.0; 3])
    }

    /// Gravity, material and control.
    fn simulation(&mut self, fixed: Option<usize>) -> Simulation {
        let mut simulation = Simulation::default();
        // Δt in which free fall goes some share of the reach.
        let share = self.pick(&[1.0 / 256.0, 1.0 / 16.0, 1.0 / 4.0, 0.5]);
        let time_step = binary_below((2.0 * self.reach * share / 9.81).sqrt());
        let control = &mut simulation.control;
        control.time_step = number(time_step * self.long);
        control.dynamic = number(self.sampler.pick(&[1.0, 1.0, 1.0, 0.0]).to_owned());
        control.kinematics = *self.sampler.pick(&[Kinematics::Cayley, Kinematics::Cayley, Kinematics::Linear]);
        control.unconverged = *self.sampler.pick(&[Unconverged::Accept, Unconverged::Stop]);
        // A free pair falls together; a block on a fixed one is pulled onto it, along it, or off.
        let pull = self.pick(&[0.0, 8.0, 9.81, 10.0]);
        let (normal, along) = *self.sampler.pick(&[(1.0, 0.0), (0.8, 0.6), (0.5, 0.875), (0.6, 0.8), (-0.25, 0.5)]);
        let towards = if fixed == Some(1) { 1.0 } else { -1.0 };
        let gravity = self.direction(towards * normal * pull, along * pull);
        simulation.gravity = self.vector(gravity);
        let material = &mut simulation.materials[0];
        material.density = number(self.sampler.pick(&[2048.0, 2600.0, 1024.0]).to_owned());
        material.young = number(self.sampler.pick(&[1e7, 1e9, 1e10, 5e10]).to_owned());
        material.poisson = number(self.sampler.pick(&[0.0, 0.25, 0.3]).to_owned());
        simulation
    }

    /// Springs, friction and strength, measured by the inertia of the lighter block; soft springs where it `sinks`.
    fn joint(&mut self, simulation: &mut Simulation, bodies: &[Body; 2], sinks: bool) {
        let density = simulation.materials[0].density.approximate();
        let time_step = simulation.control.time_step.approximate();
        let masses = self.blocks.iter().zip(bodies).filter(|(_, body)| !body.is_fixed());
        let masses = masses.map(|(block, _)| density * Number::from_rational(block.volume()).approximate());
        let mass = masses.fold(f64::INFINITY, f64::min);
        let inertia = 2.0 * mass / (time_step * time_step);
        let stress = inertia * self.reach / (self.half * self.half);
        const SOFT: [f64; 3] = [0.00390625, 0.015625, 0.0625];
        const ANY: [f64; 7] = [0.0, 0.0, 0.0625, 1.0, 64.0, 4096.0, 1_048_576.0];
        let stiff = self.pick(if sinks { &SOFT } else { &ANY });
        let strong = |sampler: &mut PairSampler<'_>| {
            if sampler.chance(35) { *sampler.pick(&[0.0009765625, 0.0625, 1.0]) } else { 0.0 }
        };
        let (cohesion, tension) = (strong(self.sampler), strong(self.sampler));
        let (ratio, friction) = (self.pick(&[0.4, 0.5, 1.0]), self.pick(&[0.0, 0.25, 0.6, 1.0]));
        let (cohesion, tension) =
            (self.number(binary_below(stress) * cohesion), self.number(binary_below(stress) * tension));
        let joint = &mut simulation.joints.other;
        joint.normal_stiffness = (stiff > 0.0).then(|| number(binary_below(inertia) * stiff));
        (joint.shear_ratio, joint.friction) = (number(ratio), number(friction));
        (joint.cohesion, joint.tension) = (cohesion, tension);
    }
}
