//! Hypotheses about engines that say how blocks lie: blocks near one another taken for touching, and numbers in few digits.

use super::hypothesis::{Hypothesis, HypothesisRange};
use super::question::{PreparedQuestion, Question, Reply};
use crate::compare::AnswerChange;
use crate::separation_state::SeparationState::{Apart, Overlapping, Touching};
use crate::separation_state::{ReportedState, SeparationState, StateComparison};
use rockproof_model::Precision;

/// What is said of blocks that do not quite touch, or how numbers are said.
#[derive(Clone, Copy, Debug)]
enum StateMistake {
    /// Blocks in the first state by no more than 10^−n m are said to be in the second.
    Within([SeparationState; 2], u8),
    /// Blocks that overlap, however deep, are said to be in this state: the code measures distances alone.
    NeverOverlapping(SeparationState),
    /// Gap and normal in so many significant digits.
    Digits(usize),
    /// The gap in so many digits after the point.
    Decimals(usize),
    /// Input and results rounded to f32.
    InSingle,
}

/// So many times as near.
const FAR_NEARER: f64 = 16.0;

/// The least and the greatest n of a tolerance of 10^−n m.
const EXPONENTS: std::ops::RangeInclusive<u8> = 1..=15;

/// The hypotheses about states.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let taken_for = [[Apart, Touching], [Overlapping, Touching], [Apart, Overlapping], [Overlapping, Apart]];
    let within = taken_for.into_iter().flat_map(|side| EXPONENTS.map(move |n| StateMistake::Within(side, n)));
    let digits = [6, 7, 4, 5].map(StateMistake::Digits).into_iter();
    let decimals = [6, 4, 3, 2].map(StateMistake::Decimals);
    let never = [Touching, Apart].map(StateMistake::NeverOverlapping).into_iter();
    let all = never.chain(within).chain(digits).chain(decimals).chain([StateMistake::InSingle]);
    all.map(|mistake| Box::new(mistake) as Box<dyn Hypothesis>)
}

impl Hypothesis for StateMistake {
    fn name(&self) -> String {
        match self {
            StateMistake::Within([is, said], n) => format!("{is}-by-1e-{n}-is-{said}"),
            StateMistake::NeverOverlapping(said) => format!("overlapping-is-{said}"),
            StateMistake::Digits(digits) => format!("gap-in-{digits}-digits"),
            StateMistake::Decimals(digits) => format!("gap-in-{digits}-decimals"),
            StateMistake::InSingle => "state-in-f32".to_owned(),
        }
    }

    fn sentence(&self) -> String {
        match self {
            StateMistake::Within([is, said], n) => {
                format!("but for blocks {is} by up to 1e-{n} m, which are called {said}")
            }
            StateMistake::NeverOverlapping(said) => {
                format!("but for blocks that overlap, however deep, which are called {said}")
            }
            StateMistake::Digits(digits) => format!("with the gap printed in {digits} significant digits"),
            StateMistake::Decimals(digits) => format!("with the gap printed in {digits} digits after the point"),
            StateMistake::InSingle => "but for rounding to f32, of the input and of what is calculated".to_owned(),
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
            StateMistake::NeverOverlapping(called) => Some(match comparison.exact {
                Overlapping => said.state == *called,
                Apart | Touching => wrong.is_none(),
            }),
            StateMistake::Digits(_) | StateMistake::Decimals(_) => {
                let gap_m = said.gap_m?;
                let meant = ReportedState { gap_m: None, ..said };
                let (wrong, _) = asked.compare_state(meant, self.accuracy(asked))?;
                Some(self.shortened(exact) == Some(gap_m) && wrong.is_none())
            }
            StateMistake::InSingle => {
                let (wrong, _) = compare_in_single(asked, said)?;
                Some(wrong.is_none())
            }
        }
    }

    fn roundoffs_from_touching(&self, asked: &PreparedQuestion<'_>, said: ReportedState) -> Option<f64> {
        let StateMistake::InSingle = self else { return None };
        let (_, comparison) = compare_in_single(asked, said)?;
        Some(comparison.margin_ulps.abs())
    }

    /// The gap has more digits than numbers in f32, or is far nearer to that of the blocks as they are than to that of the blocks in f32, which is all that
    /// an engine in f32 knows of.
    fn is_too_accurate(&self, asked: &PreparedQuestion<'_>) -> bool {
        let StateMistake::InSingle = self else { return false };
        let Reply::State(said) = asked.question.reply else { return false };
        if said.gap_m.is_some_and(|gap| !is_said_in_single(gap)) {
            return true;
        }
        let gaps = || {
            let (_, given) = asked.compare_state(said, asked.question.accuracy)?;
            let (_, single) = compare_in_single(asked, said)?;
            Some((said.gap_m?, given.exact_gap_m, single.exact_gap_m))
        };
        gaps().is_some_and(|(said, given, single)| (said - given).abs() * FAR_NEARER < (said - single).abs())
    }

    fn is_refuted(&self, asked: &PreparedQuestion<'_>) -> bool {
        let Reply::State(said) = asked.question.reply else { return false };
        matches!(self, StateMistake::NeverOverlapping(_)) && said.state == Overlapping
    }

    fn leaves_open(&self) -> bool {
        matches!(self, StateMistake::InSingle | StateMistake::NeverOverlapping(_))
    }

    fn allows_for_more(&self) -> bool {
        matches!(self, StateMistake::InSingle)
    }

    fn ladder(&self) -> Option<(String, usize)> {
        match self {
            StateMistake::Within([is, said], n) => Some((format!("{is}-is-{said}"), usize::from(*n))),
            StateMistake::NeverOverlapping(_)
            | StateMistake::Digits(_)
            | StateMistake::Decimals(_)
            | StateMistake::InSingle => None,
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
            StateMistake::Within(..) | StateMistake::NeverOverlapping(_) | StateMistake::InSingle => None,
        }
    }
}

/// Whether a number in f32 may be printed so: as it is, or rounded to so many digits or decimals.
fn is_said_in_single(number: f64) -> bool {
    let single = number as f32;
    let in_digits = |places: usize| format!("{single:.places$e}").parse() == Ok(number);
    let in_decimals = |places: usize| format!("{single:.places$}").parse() == Ok(number);
    f64::from(single) == number || (0..=17).any(|places| in_digits(places) || in_decimals(places))
}

/// Whether most of these gaps, as said and as they are, differ by one length or by one factor, to what they are said in in f32. A difference no larger
/// than f32 has of any number says nothing.
pub(super) fn have_one_mistake(gaps: &[[f64; 2]]) -> bool {
    let middle = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let (length, factor) = (
        middle(gaps.iter().map(|[said, exact]| said - exact).collect()),
        middle(gaps.iter().filter(|[_, exact]| *exact != 0.0).map(|[said, exact]| said / exact).collect()),
    );
    let fitting = |meant: &dyn Fn(f64) -> f64| {
        let fits = |[said, exact]: &&[f64; 2]| {
            let unit = said.abs().max(exact.abs()) * Precision::F32.epsilon();
            (said - meant(*exact)).abs() <= 4.0 * unit && (meant(*exact) - exact).abs() > 16.0 * unit
        };
        gaps.iter().filter(fits).count()
    };
    let most = fitting(&|exact| exact + length).max(fitting(&|exact| exact * factor));
    most * 2 > gaps.len()
}

/// What is wrong with a state that an engine in f32 says, and the comparison; `None` where a coordinate overflows or a block is concave.
fn compare_in_single(
    asked: &PreparedQuestion<'_>,
    said: ReportedState,
) -> Option<(Option<AnswerChange>, StateComparison)> {
    let [a, b] = &asked.question.blocks;
    let blocks = [a.rounded(Precision::F32)?, b.rounded(Precision::F32)?];
    asked.compare_state_of(&blocks, Precision::F32, said)
}

#[cfg(test)]
mod tests {
    use super::is_said_in_single;

    #[test]
    fn numbers_in_f32_are_known_however_they_are_printed() {
        for number in [0.123_456_79_f32, -7.0e-7, 3.0e4 / 7.0, 0.5, 0.0] {
            for text in [format!("{number}"), format!("{number:.12}"), format!("{number:.3}"), format!("{number:.9e}")]
            {
                assert!(is_said_in_single(text.parse().expect("a number")), "{text}");
            }
        }
        for number in [1.0 / 3.0, 0.123_456_789_f64, 3.0e4 / 7.0] {
            assert!(!is_said_in_single(number), "{number}");
        }
    }
}
