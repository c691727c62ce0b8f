//! How time is cut into steps.

use crate::number::Number;
use crate::simulation::{Skips, ratio};

/// The controls of a run (SPEC section 5).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Control {
    /// Δt of a full step in s, above 0.
    pub time_step: Number,
    /// k_d: the share of its velocity that a block keeps from step to step; 1 dynamic, 0 static.
    pub dynamic: Number,
    /// c in 1/s, 0 or more: viscous damping by mass. Unlike k_d it does the same over a time however many steps that has.
    pub damping: Number,
    /// Static steps with every closed contact locked, before time starts.
    pub settle: u32,
    /// How displacements move the geometry.
    pub kinematics: Kinematics,
    /// What follows when the open–close iteration does not converge at the smallest Δt.
    pub unconverged: Unconverged,
    /// How many steps to run, where the command line does not say.
    pub steps: Option<u64>,
    /// How long to run in s, where the command line does not say.
    pub duration: Option<Number>,
    /// What the stepper leaves out of a step where nothing can have changed.
    pub skips: Skips,
    /// How the stepper solves large systems in f64.
    pub solver: Solver,
}

impl Control {
    /// The solve in which a mode changes for the so many-th time, or a later one, ends the attempt if a contact opens or closes in it:
    /// the step starts again with a smaller Δt.
    pub const ITERATIONS: u32 = 6;
    /// How much smaller: 0.3, as numerator and denominator.
    pub const CUT: (i32, i32) = (3, 10);
    /// The smallest Δt is this many times smaller than the full one.
    pub const SMALLEST: i32 = 1000;
}

impl Default for Control {
    /// 10 ms, dynamic, not damped, not settled, `cayley`, stopping where the iteration fails; as long as the command line says, leaving out what it can, by
    /// the faster solver.
    fn default() -> Control {
        Control {
            time_step: ratio(1, 100),
            dynamic: Number::from_integer(1),
            damping: Number::ZERO,
            settle: 0,
            kinematics: Kinematics::Cayley,
            unconverged: Unconverged::Stop,
            steps: None,
            duration: None,
            skips: Skips::ALL,
            solver: Solver::Auto,
        }
    }
}

crate::named_enum! {
    /// How the displacement of a step moves a block.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Kinematics: from_name {
        /// x + T(x)·d: a block that turns swells by the square of the angle.
        Linear = "linear",
        /// Stretch, rational rotation `(I − [r]/2)⁻¹(I + [r]/2)`, translation: volume changes by strain alone.
        Cayley = "cayley",
    }
}

crate::named_enum! {
    /// What follows a step whose open–close iteration did not converge at the smallest Δt.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Unconverged: from_name {
        /// The run stops and says where.
        Stop = "stop",
        /// The step is accepted and marked.
        Accept = "accept",
    }
}

crate::named_enum! {
    /// How the stepper solves systems of more than 96 unknowns in f64. Smaller ones have a factor, as have all in f32. It bears on last bits, and so on
    /// decisions that these decide.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Solver: from_name {
        /// By a factor; of very large systems by conjugate gradients without one where these take few products.
        Auto = "auto",
        /// By a factor, which is in f32 for very large systems.
        Factor = "factor",
        /// By conjugate gradients without a factor: far less memory, and often more time.
        ConjugateGradients = "conjugate-gradients",
    }
}

/// A step in words: `step 5`; of settling, whose steps have the numbers −n + 1 to 0, `settling step -19 (the last is 0)`.
pub fn step_in_words(number: i64) -> String {
    if number > 0 { format!("step {number}") } else { format!("settling step {number} (the last is 0)") }
}
