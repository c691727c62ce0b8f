//! The state between two steps: all that the next step needs, and all that a checkpoint keeps.

use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::{Contact, ContactKey, Entrance};

/// Everything that changes from step to step.
#[derive(Clone, Debug, PartialEq)]
pub struct State<R> {
    /// Steps done, settling not counted.
    pub step: u64,
    /// Time in s.
    pub time: R,
    /// Static steps of settling still to do.
    pub settling: u32,
    /// Δt of the last step, settling steps too (s); the full Δt before the first. The next step begins with at most 3/2 of it.
    pub last_time_step: R,
    /// One for each block of the scene.
    pub blocks: Vec<BlockState<R>>,
    /// Where the points of the loads are (m), in the order of the scene.
    pub load_points: Vec<Vector<R>>,
    /// Where the fixed points are (m), in the order of the scene.
    pub fixed_points: Vec<Vector<R>>,
    /// Where the measured points are (m), in the order of the scene.
    pub measured_points: Vec<Vector<R>>,
    /// The contacts of the last step, by pair and in SPEC order.
    pub contacts: Vec<ContactState<R>>,
}

impl<R: Real> State<R> {
    /// The state in another scalar: the numbers nearest to its own, which lose nothing where the scalar is a finer one.
    #[must_use]
    pub fn in_scalar<S: Real>(&self) -> State<S> {
        let scalar = |value: R| S::from_f64(value.to_f64());
        let vector = |v: Vector<R>| Vector::new(scalar(v.x), scalar(v.y), scalar(v.z));
        let vectors = |all: &[Vector<R>]| all.iter().map(|v| vector(*v)).collect();
        let block = |block: &BlockState<R>| BlockState {
            vertices: vectors(&block.vertices),
            velocity: block.velocity.map(scalar),
            stress: block.stress.map(scalar),
        };
        let contact = |c: &ContactState<R>| ContactState {
            blocks: c.blocks,
            contact: c.contact,
            mode: c.mode,
            anchors: c.anchors.map(vector),
            gap: scalar(c.gap),
            normal: vector(c.normal),
            points: c.points.map(vector),
            force: vector(c.force),
        };
        State {
            step: self.step,
            time: scalar(self.time),
            settling: self.settling,
            last_time_step: scalar(self.last_time_step),
            blocks: self.blocks.iter().map(block).collect(),
            load_points: vectors(&self.load_points),
            fixed_points: vectors(&self.fixed_points),
            measured_points: vectors(&self.measured_points),
            contacts: self.contacts.iter().map(contact).collect(),
        }
    }
}

/// The state of one block.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockState<R> {
    /// Where its vertices are (m).
    pub vertices: Vec<Vector<R>>,
    /// Rates of the twelve unknowns, at the centroid: m/s, rad/s, 1/s.
    pub velocity: [R; 12],
    /// (σx, σy, σz, τyz, τzx, τxy) in Pa, tension positive.
    pub stress: [R; 6],
}

/// Whether a contact bears a force, and which (SPEC section 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Mode {
    /// No spring.
    Open,
    /// Normal spring and the friction force.
    Sliding,
    /// Normal and shear spring.
    Locked,
}

impl Mode {
    /// All modes.
    pub const ALL: [Mode; 3] = [Mode::Open, Mode::Sliding, Mode::Locked];

    /// `open`, `sliding` or `locked`, as written in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Open => "open",
            Mode::Sliding => "sliding",
            Mode::Locked => "locked",
        }
    }

    /// The mode written `name`, if there is one.
    pub fn from_name(name: &str) -> Option<Mode> {
        Mode::ALL.into_iter().find(|mode| mode.name() == name)
    }

    /// Whether the normal spring acts.
    pub fn is_closed(self) -> bool {
        self != Mode::Open
    }
}

/// A contact after a step.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactState<R> {
    /// The blocks; the first has the lower number and is A of `contact`.
    pub blocks: [u32; 2],
    /// What touches, as it was classified when the step began.
    pub contact: Contact,
    /// The mode with which it goes on: that which follows from the last solve of the step.
    pub mode: Mode,
    /// The material points of A and of B from which the shear stretch is measured (m).
    pub anchors: [Vector<R>; 2],
    /// The gap h in m after the last solve, to first order; negative overlaps.
    pub gap: R,
    /// Unit normal of the step, from B to A.
    pub normal: Vector<R>,
    /// Where it acts on A and on B (m), at the start of the step.
    pub points: [Vector<R>; 2],
    /// The force in N that B exerts on A, by the mode with which it goes on.
    pub force: Vector<R>,
}

impl<R: Real> ContactState<R> {
    /// What makes two contacts of a pair the same: kind and features.
    pub fn key(&self) -> ContactKey {
        self.contact.key
    }

    /// The plane through which its blocks enter one another.
    pub fn entrance(&self) -> Entrance {
        self.contact.entrance
    }
}
