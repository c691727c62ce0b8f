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

impl ReportedState {
    /// What a text says that is exactly as [`ReportedState`] is shown, all numbers finite; `None` of any other.
    pub fn from_text(text: &str) -> Option<ReportedState> {
        let number = |text: &str| text.parse().ok().filter(|number: &f64| number.is_finite());
        let (rest, normal) = match text.split_once(" along ") {
            Some((rest, normal)) => {
                let parts = normal.strip_prefix('(')?.strip_suffix(')')?.split(", ").map(number);
                (rest, Some(<[f64; 3]>::try_from(parts.collect::<Option<Vec<_>>>()?).ok()?))
            }
            None => (text, None),
        };
        let (state, gap_m) = match rest.split_once(' ') {
            Some((state, gap)) => (state, Some(number(gap.strip_suffix(" m")?)?)),
            None => (rest, None),
        };
        let said = ReportedState { state: SeparationState::from_name(state)?, gap_m, normal };
        (said.to_string() == text).then_some(said)
    }
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

#[cfg(test)]
mod tests {
    use super::{ReportedState, SeparationState};

    #[test]
    fn what_is_shown_is_read_and_nothing_else() {
        for state in SeparationState::ALL {
            for gap_m in [None, Some(0.0), Some(-0.0), Some(-1.0 / 3.0), Some(5e-324), Some(1e300)] {
                for normal in [None, Some([0.0, -1.0, 1e-7])] {
                    let said = ReportedState { state, gap_m, normal };
                    assert_eq!(
                        ReportedState::from_text(&said.to_string()).map(|read| read.to_string()),
                        Some(said.to_string())
                    );
                }
            }
        }
        for text in [
            "",
            "near",
            "Apart",
            "apart ",
            " apart",
            "apart 1 m",
            "apart 1.0",
            "apart 1.0 mm",
            "apart 1.00 m",
            "apart NaN m",
            "apart inf m",
            "apart 1e400 m",
            "apart along (0.0, 0.0)",
            "apart along (0.0, 0.0, 1.0, 0.0)",
            "apart along (0.0,0.0,1.0)",
            "apart along 0.0, 0.0, 1.0",
            "apart along (0.0, 0.0, inf)",
            "apart 1.0 m along (0.0, 0.0, 1.0) ",
            "apart 1.0 m, said apart",
        ] {
            assert_eq!(ReportedState::from_text(text), None, "{text}");
        }
    }
}
