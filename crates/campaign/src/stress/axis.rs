//! The ways in which pairs are made extreme, and how far.

use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::Number;
use std::fmt;

/// One way to make a pair of blocks extreme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// Distance from the origin over the size of the pair.
    Offset,
    /// Units: every coordinate divided, as metres become kilometres and more.
    ScaleDown,
    /// Units: every coordinate multiplied, as metres become millimetres and more.
    ScaleUp,
    /// Size of one block over that of the other.
    Ratio,
    /// Thickness of one block over its length.
    Sliver,
    /// The angle between two edges, or between two faces (rad).
    Angle,
}

impl Axis {
    /// All axes.
    pub const ALL: [Axis; 6] = [Axis::Offset, Axis::ScaleDown, Axis::ScaleUp, Axis::Ratio, Axis::Sliver, Axis::Angle];

    /// The name in tables; a pair's family is this, a dash and its level.
    pub fn name(self) -> &'static str {
        match self {
            Axis::Offset => "offset",
            Axis::ScaleDown => "scale_down",
            Axis::ScaleUp => "scale_up",
            Axis::Ratio => "ratio",
            Axis::Sliver => "sliver",
            Axis::Angle => "angle",
        }
    }

    /// What a level counts.
    pub fn meaning(self) -> &'static str {
        match self {
            Axis::Offset => "distance from the origin over the size of the pair",
            Axis::ScaleDown | Axis::ScaleUp => "factor on every coordinate",
            Axis::Ratio => "size of one block over that of the other",
            Axis::Sliver => "thickness of a block over its length",
            Axis::Angle => "angle between two edges or two faces (rad)",
        }
    }

    /// The levels, from the mildest to the most extreme.
    pub fn levels(self) -> Vec<Level> {
        let powers = |exponents: &[i32]| exponents.iter().map(|&e| Level::Power(e)).collect();
        match self {
            Axis::Offset => std::iter::once(Level::None).chain((0..=8).map(Level::Power)).collect(),
            Axis::ScaleDown => powers(&[0, -1, -2, -3, -6]),
            Axis::ScaleUp => powers(&[0, 1, 2, 3, 6]),
            Axis::Ratio => (0..=6).map(Level::Power).collect(),
            Axis::Sliver | Axis::Angle => (1..=9).map(|e| Level::Power(-e)).collect(),
        }
    }
}

/// How far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Level {
    /// Not at all.
    None,
    /// A power of ten.
    Power(i32),
}

impl Level {
    /// The level, exactly.
    pub fn number(self) -> Number {
        match self {
            Level::None => Number::ZERO,
            Level::Power(exponent) => {
                let power = BigRational::from_integer(BigInt::from(10).pow(exponent.unsigned_abs()));
                Number::from_rational(if exponent < 0 { power.recip() } else { power })
            }
        }
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Level::None => f.pad("0"),
            Level::Power(exponent) => f.pad(&format!("1e{exponent}")),
        }
    }
}

/// Whether the pairs of a cell hold ties.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Form {
    /// Blocks in a grid, as drawn: faces flush, corners on edges. Most pairs hold exact ties.
    Aligned,
    /// Blocks turned and shifted by random amounts: no tie but by a rare accident.
    Generic,
}

impl Form {
    /// Both forms.
    pub const ALL: [Form; 2] = [Form::Aligned, Form::Generic];

    /// `aligned` or `generic`.
    pub fn name(self) -> &'static str {
        match self {
            Form::Aligned => "aligned",
            Form::Generic => "generic",
        }
    }
}

/// One row of the stress table: pairs of one form, extreme in one way, to one level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    /// In which way.
    pub axis: Axis,
    /// How far.
    pub level: Level,
    /// With or without ties.
    pub form: Form,
}

impl Cell {
    /// The family of its pairs in findings: `offset-1e4`.
    pub fn family(&self) -> String {
        format!("{}-{}", self.axis.name(), self.level)
    }
}

/// Every cell, axis by axis and level by level.
pub fn cells() -> Vec<Cell> {
    let mut all = Vec::new();
    for axis in Axis::ALL {
        for level in axis.levels() {
            all.extend(Form::ALL.map(|form| Cell { axis, level, form }));
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
        assert_eq!(Level::Power(-9).number(), Number::parse("1/1000000000").unwrap());
        assert_eq!(Level::Power(8).number(), Number::from_integer(100_000_000));
        assert_eq!(Level::None.number(), Number::ZERO);
    }
}
