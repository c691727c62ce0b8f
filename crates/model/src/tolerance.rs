//! The tolerance set (SPEC section 3).

use crate::number::{Number, Precision};
use serde::{Deserialize, Serialize};

/// Which criteria of SPEC section 4 apply.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Criteria {
    /// One radius `s` for every territory, and angles alone.
    Classic,
    /// Territories bounded by the features they belong to, and lengths beside angles.
    Revised,
}

impl Criteria {
    /// `classic` or `revised`, as written in files.
    pub fn name(self) -> &'static str {
        match self {
            Criteria::Classic => "classic",
            Criteria::Revised => "revised",
        }
    }
}

/// Every tolerance of SPEC section 3. Lengths in metres, angles as sines, `max_rotation` in radians; none negative.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToleranceSet {
    /// s: largest gap at which a contact is recorded.
    pub search: Number,
    /// r: radius of the zones around vertices and edges that belong to them.
    pub territory: Number,
    /// g: deepest overlap at which a contact is recorded.
    pub penetration: Number,
    /// so: sine of the angle by which a solid angle may dip below a plane.
    pub overlap_sine: Number,
    /// sp: sine of the angle below which edges count as parallel.
    pub parallel_sine: Number,
    /// ε of Eq. (1): relative equality.
    pub equal: Number,
    /// εo: gap beyond which a closed contact opens.
    pub open: Number,
    /// εc: overlap beyond which an open contact closes.
    pub close: Number,
    /// u: largest vertex displacement in one step.
    pub max_displacement: Number,
    /// ω: largest rotation in one step (rad).
    pub max_rotation: Number,
    /// Classic or revised criteria.
    pub criteria: Criteria,
}

/// λ of SPEC sections 3 and 4, as a denominator: λ = 1/4.
pub const LAMBDA_INVERSE: i32 = 4;

impl ToleranceSet {
    /// Every number 0, under the revised criteria.
    pub const ZERO: ToleranceSet = ToleranceSet {
        search: Number::ZERO,
        territory: Number::ZERO,
        penetration: Number::ZERO,
        overlap_sine: Number::ZERO,
        parallel_sine: Number::ZERO,
        equal: Number::ZERO,
        open: Number::ZERO,
        close: Number::ZERO,
        max_displacement: Number::ZERO,
        max_rotation: Number::ZERO,
        criteria: Criteria::Revised,
    };

    /// `ideal(T)`: the set with r, so, sp and ε at 0 and the revised criteria. Types by nearest features alone.
    #[must_use]
    pub fn ideal(&self) -> ToleranceSet {
        ToleranceSet {
            territory: Number::ZERO,
            overlap_sine: Number::ZERO,
            parallel_sine: Number::ZERO,
            equal: Number::ZERO,
            criteria: Criteria::Revised,
            ..self.clone()
        }
    }

    /// The ten numbers by their names in files, in the order of SPEC.
    pub fn numbers(&self) -> [(&'static str, &Number); 10] {
        [
            ("search", &self.search),
            ("territory", &self.territory),
            ("penetration", &self.penetration),
            ("overlap_sine", &self.overlap_sine),
            ("parallel_sine", &self.parallel_sine),
            ("equal", &self.equal),
            ("open", &self.open),
            ("close", &self.close),
            ("max_displacement", &self.max_displacement),
            ("max_rotation", &self.max_rotation),
        ]
    }

    /// The same numbers, to change one by name.
    pub fn numbers_mut(&mut self) -> [(&'static str, &mut Number); 10] {
        [
            ("search", &mut self.search),
            ("territory", &mut self.territory),
            ("penetration", &mut self.penetration),
            ("overlap_sine", &mut self.overlap_sine),
            ("parallel_sine", &mut self.parallel_sine),
            ("equal", &mut self.equal),
            ("open", &mut self.open),
            ("close", &mut self.close),
            ("max_displacement", &mut self.max_displacement),
            ("max_rotation", &mut self.max_rotation),
        ]
    }

    /// The set as an engine of the given precision sees it, or the name of a value that overflows.
    ///
    /// # Errors
    /// The name of the tolerance whose rounding overflows.
    pub fn rounded(&self, precision: Precision) -> Result<ToleranceSet, &'static str> {
        let mut rounded = self.clone();
        for (name, number) in rounded.numbers_mut() {
            let near = number.rounded(precision).ok_or(name)?;
            *number = Number::from_f64(near).map_err(|_| name)?;
        }
        Ok(rounded)
    }
}
