//! What makes blocks move (SPEC section 5): materials, joints, loads, and how a run is controlled. Plain data with exact
//! numbers; the oracle and the stepper each calculate with it in their own way.

mod control;
mod joint;
mod motion_energy;
mod skips;
mod stiffness;

pub use control::{Control, Kinematics, Solver, Unconverged, step_in_words};
pub use joint::{JointPair, JointProperties, Joints, tangent_of_degrees};
pub use motion_energy::motion_energy;
pub(crate) use motion_energy::spin_energy;
pub use skips::Skips;
pub use stiffness::derive_stiffness;
pub(crate) use stiffness::{MovingBlock, derive_stiffness_of, moving_blocks, smallest_face};

use crate::block::Point;
use crate::number::Number;
use crate::vector::Vec3;
use num_bigint::BigInt;
use num_rational::BigRational;

/// Everything of a scene that is not a block: how the world pulls, what blocks and joints are made of, how to step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Simulation {
    /// Acceleration of gravity in m/s².
    pub gravity: Vec3<Number>,
    /// How time is cut into steps.
    pub control: Control,
    /// What blocks are made of; never empty, and [`Body::material`] is a place in it.
    pub materials: Vec<Material>,
    /// What happens between two surfaces.
    pub joints: Joints,
    /// Forces on points of blocks.
    pub loads: Vec<PointLoad>,
    /// Points of blocks held by springs.
    pub fixed_points: Vec<FixedPoint>,
    /// Points of blocks whose motion is recorded.
    pub measured_points: Vec<MeasuredPoint>,
}

impl Default for Simulation {
    /// Gravity 9.81 m/s² downwards, one rock, one kind of joint, nothing loaded, held or measured.
    fn default() -> Simulation {
        let down = Number::from_f64(-9.81).unwrap_or(Number::ZERO);
        Simulation {
            gravity: Vec3::new(Number::ZERO, Number::ZERO, down),
            control: Control::default(),
            materials: vec![Material::default()],
            joints: Joints::default(),
            loads: Vec::new(),
            fixed_points: Vec::new(),
            measured_points: Vec::new(),
        }
    }
}

crate::named_enum! {
    /// The unknowns of a block.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Motion: from_name {
        /// Twelve unknowns: translation, rotation, six strains.
        #[default]
        Deformable = "deformable",
        /// Six unknowns: translation and rotation.
        Rigid = "rigid",
        /// No unknown: the block never moves.
        Fixed = "fixed",
    }
}

impl Motion {
    /// 12, 6 or 0.
    pub fn unknowns(self) -> usize {
        match self {
            Motion::Deformable => 12,
            Motion::Rigid => 6,
            Motion::Fixed => 0,
        }
    }
}

/// How one block moves, and in which state it starts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Body {
    /// Its unknowns.
    pub motion: Motion,
    /// What it is made of: a place in [`Simulation::materials`].
    pub material: usize,
    /// What its surface is made of: a place in [`Joints::names`].
    pub joint: usize,
    /// Velocity of the centroid in m/s.
    pub velocity: Vec3<Number>,
    /// Angular velocity in rad/s.
    pub spin: Vec3<Number>,
    /// Initial stress (σx, σy, σz, τyz, τzx, τxy) in Pa; tension is positive.
    pub stress: [Number; 6],
}

impl Default for Body {
    /// Deformable, of the first material and joint, at rest and free of stress.
    fn default() -> Body {
        Body {
            motion: Motion::default(),
            material: 0,
            joint: 0,
            velocity: Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO),
            spin: Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO),
            stress: std::array::from_fn(|_| Number::ZERO),
        }
    }
}

impl Body {
    /// Whether the block never moves.
    pub fn is_fixed(&self) -> bool {
        self.motion == Motion::Fixed
    }
}

/// What a block is made of: isotropic and elastic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// ρ in kg/m³, above 0.
    pub density: Number,
    /// Young's modulus E in Pa, above 0.
    pub young: Number,
    /// Poisson's ratio ν, above −1 and below 1/2.
    pub poisson: Number,
}

impl Default for Material {
    /// 2600 kg/m³, 10 GPa, 1/4.
    fn default() -> Material {
        let young = Number::from_f64(1e10).unwrap_or(Number::ZERO);
        let (density, poisson) = (Number::from_integer(2600), ratio(1, 4));
        Material { name: "rock".to_string(), density, young, poisson }
    }
}

/// A force on a point of a block; the point moves with the block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PointLoad {
    /// The block.
    pub block: usize,
    /// Where the point is when the run begins (m).
    pub at: Point,
    /// Times (s), strictly ascending and never empty, and the force (N) at each. Between two times the force is linear,
    /// before the first and after the last it is constant.
    pub table: Vec<(Number, Vec3<Number>)>,
}

impl PointLoad {
    /// The force when time begins (N), to the nearest f64.
    pub fn at_start(&self) -> [f64; 3] {
        self.force_at(&Number::ZERO)
    }

    /// The force at a time (N), to the nearest f64: linear between the times of its table, constant outside.
    pub fn force_at(&self, now: &Number) -> [f64; 3] {
        let near = |force: &Vec3<Number>| force.components().map(Number::approximate);
        match self.table.partition_point(|(time, _)| time <= now) {
            0 => near(&self.table[0].1),
            next if next == self.table.len() || self.table[next - 1].0 == *now => near(&self.table[next - 1].1),
            next => {
                let [(before, from), (then, to)] = [&self.table[next - 1], &self.table[next]];
                let [before, then, now] = [before, then, now].map(Number::approximate);
                let (from, to) = (near(from), near(to));
                std::array::from_fn(|k| from[k] + (to[k] - from[k]) * ((now - before) / (then - before)))
            }
        }
    }
}

/// A point of a block that a spring of equal stiffness in all directions holds where it was when the run began.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FixedPoint {
    /// The block.
    pub block: usize,
    /// Where the point is when the run begins (m).
    pub at: Point,
    /// Stiffness in N/m; `None` for that of the stiffest joint.
    pub stiffness: Option<Number>,
}

/// A point of a block whose motion is recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeasuredPoint {
    /// Its name in the file, or `point_` and its number.
    pub name: String,
    /// The block.
    pub block: usize,
    /// Where the point is when the run begins (m).
    pub at: Point,
}

/// A fraction as an exact number.
pub(crate) fn ratio(numerator: i64, denominator: i64) -> Number {
    Number::from_rational(BigRational::new(BigInt::from(numerator), BigInt::from(denominator)))
}
