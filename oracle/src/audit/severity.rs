//! How grave an overlap is for a run (SPEC section 7): what contacts cannot undo, what they hold, and what is rounding.

use super::{Overlap, OverlapVisibility};
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::{Block, Number, Precision};

/// How grave an overlap is for a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum OverlapSeverity {
    /// Deeper than g, or seen by no contact though more than rounding: the blocks will pass through one another.
    Lost,
    /// Seen by a contact that can push the blocks apart.
    Held,
    /// No more than rounded coordinates and uneven faces make of blocks that touch.
    Rounding,
}

impl OverlapSeverity {
    /// All, the gravest first.
    pub const ALL: [OverlapSeverity; 3] = [OverlapSeverity::Lost, OverlapSeverity::Held, OverlapSeverity::Rounding];

    /// `lost`, `held` or `rounding`.
    pub fn name(self) -> &'static str {
        match self {
            OverlapSeverity::Lost => "lost",
            OverlapSeverity::Held => "held",
            OverlapSeverity::Rounding => "rounding",
        }
    }
}

impl Overlap {
    /// How grave the overlap is. `rounding` (m) is the depth that rounded coordinates alone can make ([`rounding_depth`]);
    /// **exactly so deep is rounding**.
    pub fn severity(&self, rounding: &Number) -> OverlapSeverity {
        if self.is_deeper_than_g {
            return OverlapSeverity::Lost;
        }
        match (self.is_rounding(rounding), self.sight) {
            (true, _) => OverlapSeverity::Rounding,
            (false, OverlapVisibility::Unseen) => OverlapSeverity::Lost,
            (false, _) => OverlapSeverity::Held,
        }
    }

    /// Whether the overlap is no more than rounding makes of blocks that touch, whatever the tolerances.
    pub fn is_rounding(&self, rounding: &Number) -> bool {
        self.is_within_unevenness || self.depth_squared() <= rounding.times(rounding).to_rational()
    }

    /// Whether no contact sees the overlap and it is more than rounding, however deep it is. After a step this is the
    /// question, not [`OverlapSeverity::Lost`]: a contact kept closed holds blocks that overlap deeper than g.
    pub fn is_unseen(&self, rounding: &Number) -> bool {
        self.sight == OverlapVisibility::Unseen && self.severity(rounding) == OverlapSeverity::Lost
    }
}

/// The depth in m below which rounding decides whether blocks overlap: 2⁸·eps·M, M the largest coordinate magnitude, as
/// SPEC section 3 has it for `territory`.
pub fn rounding_depth(blocks: &[&Block], precision: Precision) -> Number {
    let coordinates = blocks.iter().flat_map(|block| block.coordinates());
    let sizes = coordinates.map(|c| if c.is_negative() { c.negated() } else { c.clone() });
    let largest = sizes.reduce(|most, c| if c > most { c } else { most }).unwrap_or(Number::ZERO);
    rounding_depth_of_size(&largest, precision)
}

/// The same for blocks whose largest coordinate has this magnitude (m).
pub fn rounding_depth_of_size(largest: &Number, precision: Precision) -> Number {
    // eps is 2 to the power of 1 less the digits of the precision.
    let share = BigRational::new(BigInt::from(1 << 8), BigInt::from(1) << (precision.digits() - 1));
    largest.times(&Number::from_rational(share))
}
