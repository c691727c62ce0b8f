//! Everything exact that an attempt at a step starts from.

use super::answer::StepModel;
use super::state::{Mode, State};
use super::transfer::StartingContact;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::simulation::{JointProperties, Material, PointLoad};
use rockproof_model::{Block, Number, Vec3};

/// The joint of a contact.
pub(crate) struct Joint<'a> {
    pub(crate) properties: &'a JointProperties,
    /// p_n in N/m.
    pub(crate) normal: &'a Number,
    /// Cohesion on the contact's area, in N, times |N|; `None` for none.
    pub(crate) cohesive: Option<BigRational>,
    /// The gap that its tensile strength can stretch, in m, times |N|; `None` for none.
    pub(crate) tensile: Option<BigRational>,
}

/// One Δt tried.
pub(crate) struct Attempt<'a> {
    pub(crate) model: &'a StepModel<'a>,
    pub(crate) state: &'a State,
    pub(crate) blocks: &'a [Block],
    pub(crate) started: &'a [StartingContact],
    pub(crate) joints: &'a [Joint<'a>],
    pub(crate) fixed_stiffness: &'a [Number],
    /// Unknowns of each moving block.
    pub(crate) sizes: &'a [usize],
    /// The place of each block among the moving ones.
    pub(crate) rows: &'a [Option<usize>],
    pub(crate) time_step: BigRational,
    /// 2/Δt.
    pub(crate) rate: BigRational,
    pub(crate) settling: bool,
    /// Block and force (N) of each point load.
    pub(crate) loads: Vec<(usize, Vec3<BigRational>)>,
}

impl Attempt<'_> {
    /// The moving blocks and their places in the system.
    pub(crate) fn moving(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.rows.iter().enumerate().filter_map(|(block, row)| row.map(|row| (block, row)))
    }

    /// The modes of the first solve. While settling, what is closed is locked.
    pub(crate) fn first_modes(&self) -> Vec<Mode> {
        let lock = |mode| if self.settling && mode == Mode::Sliding { Mode::Locked } else { mode };
        self.started.iter().map(|started| lock(started.mode)).collect()
    }

    pub(crate) fn material(&self, block: usize) -> &Material {
        &self.model.simulation.materials[self.model.bodies[block].material]
    }
}

/// The force of a load at a time: linear between two entries of its table, constant outside.
pub(crate) fn force_at(load: &PointLoad, time: &BigRational) -> Vec3<BigRational> {
    let entry = |k: usize| (load.table[k].0.to_rational(), load.table[k].1.map(Number::to_rational));
    let after = load.table.iter().position(|(t, _)| t.to_rational() > *time);
    match after {
        Some(0) => entry(0).1,
        None => load.table.last().map_or(Vec3::zero(), |(_, force)| force.map(Number::to_rational)),
        Some(k) => {
            let ((t0, f0), (t1, f1)) = (entry(k - 1), entry(k));
            let span = &t1 - &t0;
            let share = if span.is_zero() { BigRational::zero() } else { (time - t0) / span };
            let mix = |a: &BigRational, b: &BigRational| a + (b - a) * &share;
            Vec3::new(mix(&f0.x, &f1.x), mix(&f0.y, &f1.y), mix(&f0.z, &f1.z))
        }
    }
}
