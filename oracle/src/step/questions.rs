//! The decisions of a step, each asked of one number type (docs/step.md 9 and 11): `None` where that cannot tell.

use super::chain::Chain;
use super::frame;
use super::state::Mode;
use crate::field::Field;
use rockproof_model::Vec3;

/// A question that any level can be asked.
pub(crate) trait Question {
    type Answer;
    fn ask<S: Field>(&self, chain: &Chain<'_, S>) -> Option<Self::Answer>;
}

/// The mode of a contact after the last solve.
pub(crate) struct NextMode {
    pub(crate) contact: usize,
    pub(crate) mode: Mode,
}

impl Question for NextMode {
    type Answer = Mode;
    fn ask<S: Field>(&self, chain: &Chain<'_, S>) -> Option<Mode> {
        let k = self.contact;
        let (contact, joint, iterate) = (&chain.contacts[k], &chain.joints[k], chain.iterates.last()?);
        let gap = &iterate.gaps[k];
        // Homogeneous in |N|: squares are compared, so no root is taken.
        let square = gap.squared();
        if square.minus(&chain.limits.equal.times(&contact.gap.squared())).certain_sign()?.is_at_most_zero() {
            return Some(self.mode);
        }
        let beyond = |square: &S, limit: &S| {
            let limit = limit.times(&contact.square);
            Some(square.minus(&limit).certain_sign()?.is_positive())
        };
        let closed = match self.mode {
            Mode::Open => gap.certain_sign()?.is_negative() && beyond(&square, &chain.limits.close)?,
            _ => {
                // h − tension·area/p_n beyond εo, times |N|.
                let stretched = gap.minus(&joint.tensile);
                !(stretched.certain_sign()?.is_positive() && beyond(&stretched.squared(), &chain.limits.open)?)
            }
        };
        if !closed {
            return Some(Mode::Open);
        }
        if chain.attempt.settling {
            return Some(Mode::Locked);
        }
        // p_s²|s|² ≤ τ², times |N|².
        let shear = joint.shear.squared().times(&iterate.stretches[k].norm_squared()).times(&contact.square);
        let excess = shear.minus(&chain.strength(k, gap)?.squared());
        Some(if excess.certain_sign()?.is_at_most_zero() { Mode::Locked } else { Mode::Sliding })
    }
}

/// Which block moves a vertex beyond u.
pub(crate) struct TooFar;

impl Question for TooFar {
    type Answer = Option<usize>;
    fn ask<S: Field>(&self, chain: &Chain<'_, S>) -> Option<Option<usize>> {
        let iterate = chain.iterates.last()?;
        for (block, _) in chain.attempt.moving() {
            let moments = &chain.moments[block];
            for vertex in &moments.points {
                let moved = frame::displacement(&vertex.minus(&moments.centroid), &iterate.d[block]);
                if moved.norm_squared().minus(&chain.limits.displacement).certain_sign()?.is_positive() {
                    return Some(Some(block));
                }
            }
        }
        Some(None)
    }
}

/// Which block turns beyond ω.
pub(crate) struct TooTurned;

impl Question for TooTurned {
    type Answer = Option<usize>;
    fn ask<S: Field>(&self, chain: &Chain<'_, S>) -> Option<Option<usize>> {
        let iterate = chain.iterates.last()?;
        for (block, _) in chain.attempt.moving() {
            let d = &iterate.d[block];
            let turn = Vec3::new(d[3].clone(), d[4].clone(), d[5].clone());
            if turn.norm_squared().minus(&chain.limits.rotation).certain_sign()?.is_positive() {
                return Some(Some(block));
            }
        }
        Some(None)
    }
}
