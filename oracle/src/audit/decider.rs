//! What decided whether a pair overlaps, and how many each question decided.

use std::ops::AddAssign;

/// What decided whether a pair overlaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Decider {
    /// Boxes share no more than their surfaces.
    Boxes,
    /// The plane of a face separates the blocks, by f64 with a proved bound.
    FacePlane,
    /// The plane of a face separates the blocks, by sums of two f64 or by exact integers: they touch or nearly do.
    ExactFacePlane,
    /// The search for a separating plane, by f64 with proved bounds alone.
    Float,
    /// That search, with sums of two f64 or exact integers for at least one sign.
    Exact,
    /// The surfaces of blocks of which one is not convex.
    Surfaces,
    /// Nothing: the vertices of a block lie in one plane, so that it has no inside.
    LeftOut,
}

impl Decider {
    /// All, the cheapest first.
    pub const ALL: [Decider; 7] = [
        Decider::Boxes,
        Decider::FacePlane,
        Decider::ExactFacePlane,
        Decider::Float,
        Decider::Exact,
        Decider::Surfaces,
        Decider::LeftOut,
    ];
}

/// How many neighbouring pairs each question decided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AuditCounts([u64; Decider::ALL.len()]);

impl AuditCounts {
    /// Pairs that `decider` decided.
    pub fn of(&self, decider: Decider) -> u64 {
        self.0[decider as usize]
    }

    /// All neighbouring pairs.
    pub fn neighbours(&self) -> u64 {
        self.0.iter().sum()
    }
}

impl AddAssign<Decider> for AuditCounts {
    fn add_assign(&mut self, decider: Decider) {
        self.0[decider as usize] += 1;
    }
}

impl AddAssign for AuditCounts {
    fn add_assign(&mut self, other: AuditCounts) {
        self.0.iter_mut().zip(other.0).for_each(|(count, more)| *count += more);
    }
}
