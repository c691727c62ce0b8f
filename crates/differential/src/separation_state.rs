//! How two blocks lie to one another, as a collision code tells it and as it is.

use std::fmt;

rockproof_model::named_enum! {
    /// How two blocks lie to one another.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum SeparationState: from_name, Display {
        /// There is room between them.
        Apart = "apart",
        /// They have points in common, but none inside both.
        Touching = "touching",
        /// They have points inside both.
        Overlapping = "overlapping",
    }
}

/// What an engine says about a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportedState {
    /// How the blocks lie.
    pub state: SeparationState,
    /// The distance, or minus the depth (m), if the engine tells.
    pub gap_m: Option<f64>,
    /// The direction in which A leaves B, of any length, if the engine tells.
    pub normal: Option<[f64; 3]>,
}

/// What an engine said, beside what is so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateComparison {
    /// How the blocks lie.
    pub exact: SeparationState,
    /// The distance, or minus the depth, to the nearest f64 (m).
    pub exact_gap_m: f64,
    /// What the engine said.
    pub reported: ReportedState,
    /// The exact gap over the largest coordinate: how near to touching. **0 is a tie.**
    pub margin: f64,
    /// The margin in units of the engine's roundoff.
    pub margin_ulps: f64,
}

impl fmt::Display for StateComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?} m, said {}", self.exact, self.exact_gap_m, self.reported)
    }
}

impl fmt::Display for ReportedState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.state)?;
        if let Some(gap) = self.gap_m {
            write!(f, " {gap:?} m")?;
        }
        if let Some([x, y, z]) = self.normal {
            write!(f, " along ({x:?}, {y:?}, {z:?})")?;
        }
        Ok(())
    }
}
