//! How far along each axis of the stress set an engine is safe, in words: for the verdict and the section alike.

use super::stress::StressLimit;
use super::table::{grouped, percent};
use rockproof_campaign::stress::table::Proof;
use rockproof_campaign::stress::{PairAlignment, StressAxis};

/// `1e-6` as a reader likes it: 10⁻⁶.
pub(crate) fn power(level: &str) -> String {
    let raised = |digit| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + (digit as u32 - '0' as u32)).unwrap_or(digit),
    };
    match level.strip_prefix("1e") {
        Some("0") => "1".to_owned(),
        Some("1") => "10".to_owned(),
        Some("-1") => "0.1".to_owned(),
        Some(exponent) if exponent.chars().all(|c| c == '-' || c.is_ascii_digit()) => {
            format!("10{}", exponent.chars().map(raised).collect::<String>())
        }
        _ => level.to_owned(),
    }
}

/// Up to a level, in words.
pub(crate) fn up_to(axis: StressAxis, level: &str) -> String {
    let level = power(level);
    match axis {
        StressAxis::Offset if level == "0" => "at the origin".to_owned(),
        StressAxis::Offset => format!("to {level} times the pair's size from the origin"),
        StressAxis::ScaleDown | StressAxis::ScaleUp => format!("with all coordinates times {level}"),
        StressAxis::Ratio => format!("with one block {level} times as large as the other"),
        StressAxis::Sliver => format!("with blocks of thickness {level} of their length"),
        StressAxis::Angle => format!("at angles down to {level} rad"),
    }
}

/// An axis in short, for captions.
pub(crate) fn noun(axis: StressAxis) -> &'static str {
    match axis {
        StressAxis::Offset => "Far from the origin",
        StressAxis::ScaleDown => "Smaller units",
        StressAxis::ScaleUp => "Larger units",
        StressAxis::Ratio => "A small block at a large one",
        StressAxis::Sliver => "Thin blocks",
        StressAxis::Angle => "Small angles",
    }
}

/// With or without ties.
pub(crate) fn alignment_words(form: PairAlignment) -> &'static str {
    match form {
        PairAlignment::Aligned => "with ties",
        PairAlignment::Generic => "without ties",
    }
}

/// Along which axes an engine is safe.
#[derive(Default)]
pub(crate) struct SafeLevels {
    /// Where, and how far, in words.
    pub(crate) safe: Vec<String>,
    /// Where not even at the mildest level.
    pub(crate) never: Vec<String>,
    /// Where there are too few pairs to tell at the mildest level, and how many would be needed there.
    pub(crate) untold: Vec<String>,
}

/// Along which axes an engine is safe, and how far, in words.
pub(crate) fn safe_levels<'r>(limits: impl Iterator<Item = &'r StressLimit>) -> SafeLevels {
    let mut found = SafeLevels::default();
    for limit in limits {
        let what = || noun(limit.curve.axis).to_lowercase();
        match (&limit.safe_to, &limit.beyond, limit.proof) {
            (Some(level), ..) => found.safe.push(up_to(limit.curve.axis, level)),
            (None, Some(_), Proof::TooFew { needed }) => {
                let needed = needed.map_or(String::new(), |n| format!(" ({} a level would do)", grouped(n)));
                found.untold.push(format!("{}{needed}", what()));
            }
            (None, Some((level, share)), _) => {
                found.never.push(format!("{} ({} differ at {})", what(), percent(*share), power(level)));
            }
            (None, None, _) => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{StressAxis, power, up_to};

    #[test]
    fn levels_are_told_as_a_reader_likes_them() {
        assert_eq!(
            ["0", "1e0", "1e1", "1e-1", "1e8", "1e-9", "x"].map(power),
            ["0", "1", "10", "0.1", "10⁸", "10⁻⁹", "x"]
        );
        assert_eq!(up_to(StressAxis::Offset, "0"), "at the origin");
        assert_eq!(up_to(StressAxis::Angle, "1e-3"), "at angles down to 10⁻³ rad");
    }
}
