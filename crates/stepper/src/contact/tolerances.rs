//! The tolerances of a classification in the stepper's precision.

use crate::real::Real;
use rockproof_model::{Criteria, ToleranceSet};

/// The values of SPEC section 3 that classification uses. Lengths in metres, angles as sines.
#[derive(Clone, Copy, Debug)]
pub struct Tolerances<R> {
    /// s: largest gap at which a contact is recorded.
    pub search: R,
    /// r: radius of territories.
    pub territory: R,
    /// g: deepest overlap at which a contact is recorded.
    pub penetration: R,
    /// so: sine of the angle by which a solid angle may dip.
    pub overlap_sine: R,
    /// sp: sine of the angle below which edges count as parallel.
    pub parallel_sine: R,
    /// ε of Eq. (1).
    pub equal: R,
    /// Whether the revised criteria apply, not the classic ones.
    pub revised: bool,
    /// No contact that is not kept joins features farther apart than this: max(s, g), and a sixteenth more, so that rounding in
    /// culling never decides. Corners of a face that is not planar may be farther from what touches its plane.
    pub reach: R,
}

/// A tolerance that the precision cannot hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("tolerance {name} overflows in the stepper's precision")]
pub struct ToleranceOverflow {
    /// Its name in files.
    pub name: &'static str,
}

impl<R: Real> Tolerances<R> {
    /// The set rounded to nearest.
    ///
    /// # Errors
    /// When a value overflows (SPEC section 1).
    pub fn new(set: &ToleranceSet) -> Result<Tolerances<R>, ToleranceOverflow> {
        let near = |name, number| R::from_number(number).ok_or(ToleranceOverflow { name });
        let search = near("search", &set.search)?;
        let penetration = near("penetration", &set.penetration)?;
        Ok(Tolerances {
            search,
            territory: near("territory", &set.territory)?,
            penetration,
            overlap_sine: near("overlap_sine", &set.overlap_sine)?,
            parallel_sine: near("parallel_sine", &set.parallel_sine)?,
            equal: near("equal", &set.equal)?,
            revised: set.criteria == Criteria::Revised,
            reach: search.larger(penetration) * R::from_f64(1.0625),
        })
    }
}
