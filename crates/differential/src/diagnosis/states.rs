//! Hypotheses about engines that say how blocks lie: blocks near one another taken for touching, and numbers in few digits.

use super::hypothesis::{Hypothesis, HypothesisRange};
use super::question::{PreparedQuestion, Question};
use crate::separation_state::SeparationState::{Apart, Overlapping, Touching};
use crate::separation_state::{ReportedState, SeparationState};

/// What is said of blocks that do not quite touch, or how numbers are said.
#[derive(Clone, Copy, Debug)]
enum StateMistake {
    /// Blocks in the first state by no more than 10^−n m are said to be in the second.
    Within([SeparationState; 2], u8),
    /// Gap and normal in so many significant digits.
    Digits(usize),
    /// The gap in so many digits after the point.
    Decimals(usize),
}

/// The least and the greatest n of a tolerance of 10^−n m.
const EXPONENTS: std::ops::RangeInclusive<u8> = 1..=15;

/// The hypotheses about states.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let taken_for = [[Apart, Touching], [Overlapping, Touching], [Apart, Overlapping], [Overlapping, Apart]];
    let within = taken_for.into_iter().flat_map(|side| EXPONENTS.map(move |n| StateMistake::Within(side, n)));
    let digits = [6, 7, 4, 5].map(StateMistake::Digits).into_iter();
    let decimals = [6, 4, 3, 2].map(StateMistake::Decimals);
    within.chain(digits).chain(decimals).map(|mistake| Box::new(mistake) as Box<dyn Hypothesis>)
}

impl Hypothesis for StateMistake {
    fn name(&self) -> String {
        match self {
            StateMistake::Within([is, said], n) => format!("{is}-by-1e-{n}-is-{said}"),
            StateMistake::Digits(digits) => format!("gap-in-{digits}-digits"),
            StateMistake::Decimals(digits) => format!("gap-in-{digits}-decimals"),
        }
    }

    fn sentence(&self) -> String {
        match self {
            StateMistake::Within([is, said], n) => {
                format!("but for blocks {is} by up to 1e-{n} m, which are called {said}")
            }
            StateMistake::Digits(digits) => format!("with the gap printed in {digits} significant digits"),
            StateMistake::Decimals(digits) => format!("with the gap printed in {digits} digits after the point"),
        }
    }

    fn says_state(&self, asked: &PreparedQuestion<'_>, said: ReportedState) -> Option<bool> {
        let (wrong, comparison) = asked.compare_state(said, asked.question.accuracy)?;
        let exact = comparison.exact_gap_m;
        match self {
            StateMistake::Within([is, called], n) => {
                let limit = format!("1e-{n}").parse::<f64>().ok()?;
                let is_meant = comparison.exact == *is && exact.abs() <= limit;
                Some(if is_meant { said.state == *called } else { wrong.is_none() })
            }
            StateMistake::Digits(_) | StateMistake::Decimals(_) => {
                let gap_m = said.gap_m?;
                let meant = ReportedState { gap_m: None, ..said };
                let (wrong, _) = asked.compare_state(meant, self.accuracy(asked))?;
                Some(self.shortened(exact) == Some(gap_m) && wrong.is_none())
            }
        }
    }

    fn ladder(&self) -> Option<(String, usize)> {
        match self {
            StateMistake::Within([is, said], n) => Some((format!("{is}-is-{said}"), usize::from(*n))),
            StateMistake::Digits(_) | StateMistake::Decimals(_) => None,
        }
    }

    fn range_to(&self, last: usize) -> Option<HypothesisRange> {
        let StateMistake::Within([is, said], n) = self else { return None };
        Some(HypothesisRange {
            name: format!("{is}-by-1e-{last}-to-1e-{n}-is-{said}"),
            sentence: format!("but for blocks {is} by up to 1e-{last} to 1e-{n} m, which are called {said}"),
        })
    }
}

impl StateMistake {
    /// How far a normal may be off: in so many digits it is another one.
    fn accuracy(self, asked: &PreparedQuestion<'_>) -> u64 {
        let Question { precision, accuracy, .. } = *asked.question;
        let StateMistake::Digits(digits) = self else { return accuracy };
        accuracy.max((10.0 / 10f64.powi(digits as i32 - 1) / precision.epsilon()) as u64)
    }

    /// The number that a shorter text of it says.
    fn shortened(self, number: f64) -> Option<f64> {
        match self {
            StateMistake::Digits(digits) => format!("{number:.*e}", digits - 1).parse().ok(),
            StateMistake::Decimals(digits) => format!("{number:.digits$}").parse().ok(),
            StateMistake::Within(..) => None,
        }
    }
}
