//! What a step starts from and ends with.

use rockproof_model::{Contact, ContactKey, Number, Point};

/// Whether a contact bears a force, and which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Mode {
    /// No spring.
    Open,
    /// Normal spring and the friction force.
    Sliding,
    /// Normal and shear spring.
    Locked,
}

/// Everything that changes from step to step, exactly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// Time in s.
    pub time: Number,
    /// Static steps of settling still to do.
    pub settling: u32,
    /// The Δt accepted last, in s; before the first step the full Δt. The next step begins with the lesser of the full Δt and 3/2 of it.
    pub last_time_step: Number,
    /// One for each block of the scene.
    pub blocks: Vec<BlockState>,
    /// Where the points of the loads are (m), in the order of the scene.
    pub load_points: Vec<Point>,
    /// Where the fixed points are (m), in the order of the scene.
    pub fixed_points: Vec<Point>,
    /// The contacts of the last step, by pair and in SPEC order.
    pub contacts: Vec<ContactMemory>,
}

impl State {
    /// The contacts of a pair that the step before left closed.
    pub fn kept_contacts(&self, pair: [usize; 2]) -> Vec<ContactKey> {
        kept(self.contacts.iter().filter(|memory| memory.blocks == pair))
    }
}

/// The state of one block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockState {
    /// Where its vertices are (m).
    pub vertices: Vec<Point>,
    /// Rates of the twelve unknowns: m/s, rad/s, 1/s.
    pub velocity: [Number; 12],
    /// (σx, σy, σz, τyz, τzx, τxy) in Pa, tension positive.
    pub stress: [Number; 6],
}

/// What the next step is told of a contact.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContactMemory {
    /// The blocks; the first has the lower number and is A of `contact`.
    pub blocks: [usize; 2],
    /// What touches, as it was classified when the step began.
    pub contact: Contact,
    /// Its mode as it followed from the last solve of the step.
    pub mode: Mode,
    /// The material points of A and of B from which the shear stretch is measured (m).
    pub anchors: [Point; 2],
}

/// Those that are closed.
fn kept<'s>(contacts: impl Iterator<Item = &'s ContactMemory>) -> Vec<ContactKey> {
    contacts.filter(|memory| memory.mode != Mode::Open).map(|memory| memory.contact.key).collect()
}

/// Contacts of a step before, found by their blocks.
pub(crate) struct ContactsByPair<'s> {
    contacts: &'s [ContactMemory],
    /// Their places, by pair.
    order: Vec<usize>,
}

impl<'s> ContactsByPair<'s> {
    pub(crate) fn new(contacts: &'s [ContactMemory]) -> ContactsByPair<'s> {
        let mut order: Vec<usize> = (0..contacts.len()).collect();
        order.sort_by_key(|&k| contacts[k].blocks);
        ContactsByPair { contacts, order }
    }

    /// The places of the contacts of a pair, ascending.
    pub(crate) fn of(&self, pair: [usize; 2]) -> impl Iterator<Item = usize> {
        let blocks = |k: &usize| self.contacts[*k].blocks;
        let first = self.order.partition_point(|k| blocks(k) < pair);
        let own = &self.order[first..];
        own[..own.partition_point(|k| blocks(k) == pair)].iter().copied()
    }

    /// What [`State::kept_contacts`] says of a pair.
    pub(crate) fn kept(&self, pair: [usize; 2]) -> Vec<ContactKey> {
        kept(self.of(pair).map(|k| &self.contacts[k]))
    }
}

/// How coordinates are kept after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptPrecision {
    /// As the fractions they are. Impossible where a friction force was irrational.
    Exact,
    /// As multiples of `2^−exponent` m, each within one such unit of the exact value; velocities and stresses as binary
    /// numbers of 256 bits.
    Grid {
        /// The exponent.
        exponent: u32,
    },
}
