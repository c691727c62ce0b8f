//! The ways in which pairs are made extreme, and how far.

use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::Number;
use std::fmt;

rockproof_model::named_enum! {
    /// One way to make a pair of blocks extreme. The family of a pair is its name, a dash and the level.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum StressAxis {
        /// Distance from the origin over the size of the pair.
        Offset = "offset",
        /// Units: every coordinate divided, as metres become kilometres and more.
        ScaleDown = "scale_down",
        /// Units: every coordinate multiplied, as metres become millimetres and more.
        ScaleUp = "scale_up",
        /// Size of one block over that of the other.
        Ratio = "ratio",
        /// Thickness of one block over its length.
        Sliver = "sliver",
        /// The angle between two edges, or between two faces (rad).
        Angle = "angle",
    }
}

impl StressAxis {
    /// What a level counts.
    pub fn description(self) -> &'static str {
        match self {
            StressAxis::Offset => "distance from the origin over the size of the pair",
            StressAxis::ScaleDown | StressAxis::ScaleUp => "factor on every coordinate",
            StressAxis::Ratio => "size of one block over that of the other",
            StressAxis::Sliver => "thickness of a block over its length",
            StressAxis::Angle => "angle between two edges or two faces (rad)",
        }
    }

    /// The levels, from the mildest to the most extreme.
    pub fn levels(self) -> Vec<StressLevel> {
        let powers = |exponents: &[i32]| exponents.iter().map(|&e| StressLevel::Power(e)).collect();
        match self {
            StressAxis::Offset => std::iter::once(StressLevel::None).chain((0..=8).map(StressLevel::Power)).collect(),
            StressAxis::ScaleDown => powers(&[0, -1, -2, -3, -6]),
            StressAxis::ScaleUp => powers(&[0, 1, 2, 3, 6]),
            StressAxis::Ratio => (0..=6).map(StressLevel::Power).collect(),
            StressAxis::Sliver | StressAxis::Angle => (1..=9).map(|e| StressLevel::Power(-e)).collect(),
        }
    }
}

/// How far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StressLevel {
    /// Not at all.
    None,
    /// A power of ten.
    Power(i32),
}

impl StressLevel {
    /// The level, exactly.
    pub fn number(self) -> Number {
        match self {
            StressLevel::None => Number::ZERO,
            StressLevel::Power(exponent) => {
                let power = BigRational::from_integer(BigInt::from(10).pow(exponent.unsigned_abs()));
                Number::from_rational(if exponent < 0 { power.recip() } else { power })
            }
        }
    }
}

impl fmt::Display for StressLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StressLevel::None => f.pad("0"),
            StressLevel::Power(exponent) => f.pad(&format!("1e{exponent}")),
        }
    }
}

rockproof_model::named_enum! {
    /// Whether the pairs of a cell hold ties.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum PairAlignment {
        /// Blocks in a grid, as drawn: faces flush, corners on edges. Most pairs hold exact ties.
        Aligned = "aligned",
        /// Blocks turned and shifted by random amounts: no tie but by a rare accident.
        Generic = "generic",
    }
}

/// One row of the stress table: pairs of one form, extreme in one way, to one level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellKey {
    /// In which way.
    pub axis: StressAxis,
    /// How far.
    pub level: StressLevel,
    /// With or without ties.
    pub form: PairAlignment,
}

impl CellKey {
    /// The family of its pairs in findings: `offset-1e4`.
    pub fn family(&self) -> String {
        format!("{}-{}", self.axis.name(), self.level)
    }
}

/// Every cell, axis by axis and level by level.
pub fn cells() -> Vec<CellKey> {
    let mut all = Vec::new();
    for axis in StressAxis::ALL {
        for level in axis.levels() {
            all.extend(PairAlignment::ALL.map(|form| CellKey { axis, level, form }));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn cells_are_all_different_and_reach_what_is_asked() {
        let all = cells();
        let named: BTreeSet<_> = all.iter().map(|cell| (cell.family(), cell.form)).collect();
        assert_eq!(named.len(), all.len());
        for family in
            ["offset-0", "offset-1e8", "scale_down-1e-3", "scale_up-1e3", "ratio-1e6", "sliver-1e-9", "angle-1e-9"]
        {
            assert!(all.iter().any(|cell| cell.family() == family), "{family}");
        }
    }

    #[test]
    fn levels_are_exact() {
        assert_eq!(StressLevel::Power(-9).number(), Number::parse("1/1000000000").unwrap());
        assert_eq!(StressLevel::Power(8).number(), Number::from_integer(100_000_000));
        assert_eq!(StressLevel::None.number(), Number::ZERO);
    }
}
