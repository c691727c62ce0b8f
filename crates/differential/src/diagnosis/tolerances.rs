//! Hypotheses about tolerances: one times a factor, left out, in another unit, another one's, or that of another preset.

use super::hypothesis::{Hypothesis, HypothesisRange};
use super::question::{PreparedQuestion, Question};
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::preset::{self, Preset};
use rockproof_model::{Contact, Criteria, Number, ToleranceSet};

/// The tolerances that classification uses.
const USED: [&str; 6] = ["search", "territory", "penetration", "overlap_sine", "parallel_sine", "equal"];

/// Of these, the lengths.
const LENGTHS: [&str; 3] = ["search", "territory", "penetration"];

/// Of these, the sines.
const SINES: [&str; 2] = ["overlap_sine", "parallel_sine"];

/// What they may be multiplied by, in thousandths, and how that is said: a little, halves and doubles, a wrong digit, a wrong unit.
const FACTORS: [(i64, &str); 17] = [
    (0, "0"),
    (990, "0.99"),
    (1010, "1.01"),
    (950, "0.95"),
    (1050, "1.05"),
    (900, "0.9"),
    (1100, "1.1"),
    (500, "0.5"),
    (2000, "2"),
    (200, "0.2"),
    (5000, "5"),
    (100, "0.1"),
    (10_000, "10"),
    (10, "0.01"),
    (100_000, "100"),
    (1_000_000, "1000"),
    (1, "0.001"),
];

/// What all lengths may be multiplied by.
const LENGTH_FACTORS: [(i64, &str); 6] =
    [(1_000_000, "1000"), (1, "0.001"), (10_000, "10"), (100, "0.1"), (100_000, "100"), (10, "0.01")];

/// What became of the tolerances.
#[derive(Clone, Copy, Debug)]
enum Tolerances {
    /// One times so many thousandths.
    Times(&'static str, i64, &'static str),
    /// All lengths times so many thousandths.
    LengthsTimes(i64, &'static str),
    /// A sine taken for an angle in degrees.
    Degrees(&'static str),
    /// A sine taken for the cosine's.
    Cosine(&'static str),
    /// The first has the value of the second.
    For(&'static str, &'static str),
    /// One as the preset has it.
    OfPreset(&'static str, Preset),
    /// All as the preset has them.
    Preset(Preset),
    /// The other criteria.
    Criteria(Criteria),
}

/// The hypotheses about tolerances.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let times = USED.into_iter().flat_map(|name| FACTORS.map(|(factor, text)| Tolerances::Times(name, factor, text)));
    let units = LENGTH_FACTORS.map(|(factor, text)| Tolerances::LengthsTimes(factor, text));
    let angles = SINES.into_iter().flat_map(|name| [Tolerances::Degrees(name), Tolerances::Cosine(name)]);
    let others = [LENGTHS.as_slice(), &SINES].into_iter().flat_map(|group| {
        group.iter().flat_map(move |&one| {
            group.iter().filter(move |&&other| other != one).map(move |&other| Tolerances::For(one, other))
        })
    });
    let presets = [Preset::Auto, Preset::Shi, Preset::Zero].into_iter().flat_map(|preset| {
        let each = USED.into_iter().map(move |name| Tolerances::OfPreset(name, preset));
        std::iter::once(Tolerances::Preset(preset)).chain(each)
    });
    let criteria = [Criteria::Classic, Criteria::Revised].map(Tolerances::Criteria);
    let all = times.chain(units).chain(angles).chain(criteria).chain(others).chain(presets);
    all.map(|tolerances| Box::new(tolerances) as Box<dyn Hypothesis>)
}

impl Hypothesis for Tolerances {
    fn name(&self) -> String {
        match self {
            Tolerances::Times(name, 0, _) => format!("{name}-ignored"),
            Tolerances::Times(name, _, factor) => format!("{name}-times-{factor}"),
            Tolerances::LengthsTimes(_, factor) => format!("lengths-times-{factor}"),
            Tolerances::Degrees(name) => format!("{name}-in-degrees"),
            Tolerances::Cosine(name) => format!("{name}-for-cosine"),
            Tolerances::For(one, other) => format!("{other}-for-{one}"),
            Tolerances::OfPreset(name, preset) => format!("{name}-of-{}", preset.name()),
            Tolerances::Preset(preset) => format!("preset-{}", preset.name()),
            Tolerances::Criteria(criteria) => format!("criteria-{}", criteria.name()),
        }
    }

    fn sentence(&self) -> String {
        match self {
            Tolerances::Times(name, 0, _) => format!("with {name} ignored (0)"),
            Tolerances::Times(name, _, factor) => format!("with {name} times {factor}"),
            Tolerances::LengthsTimes(1, _) => "with all tolerance lengths a thousandth of what they are".to_owned(),
            Tolerances::LengthsTimes(1_000_000, _) => {
                "with all tolerance lengths a thousand times what they are".to_owned()
            }
            Tolerances::LengthsTimes(_, factor) => format!("with all tolerance lengths times {factor}"),
            Tolerances::Degrees(name) => format!("with {name} taken for an angle in degrees"),
            Tolerances::Cosine(name) => format!("with the cosine in place of {name}"),
            Tolerances::For(one, other) => format!("with {other} in place of {one}"),
            Tolerances::OfPreset(name, preset) => format!("with {name} of the preset {}", preset.name()),
            Tolerances::Preset(preset) => format!("with all tolerances of the preset {}", preset.name()),
            Tolerances::Criteria(criteria) => format!("under the {} criteria", criteria.name()),
        }
    }

    fn factor(&self) -> Option<(&'static str, i64)> {
        match *self {
            Tolerances::Times(name, factor, _) => Some((name, factor)),
            _ => None,
        }
    }

    fn contacts(&self, asked: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        Some(asked.contacts(&self.tolerances(asked.question)?).to_vec())
    }

    fn tolerances(&self, question: &Question) -> Option<ToleranceSet> {
        let preset = |preset| {
            let [a, b] = &question.blocks;
            preset::derive(preset, &[a, b], question.precision).ok()
        };
        self.changed(&question.tolerances, preset)
    }
}

impl Tolerances {
    fn changed(self, given: &ToleranceSet, preset: impl Fn(Preset) -> Option<ToleranceSet>) -> Option<ToleranceSet> {
        let mut set = given.clone();
        match self {
            Tolerances::Times(name, factor, _) => *number_mut(&mut set, name)? = times(value(given, name)?, factor),
            Tolerances::LengthsTimes(factor, _) => {
                for name in LENGTHS {
                    *number_mut(&mut set, name)? = times(value(given, name)?, factor);
                }
            }
            Tolerances::Degrees(name) => {
                let sine = preset::sine_of_degrees(value(given, name)?.approximate());
                *number_mut(&mut set, name)? = Number::from_f64(sine).ok()?;
            }
            Tolerances::Cosine(name) => {
                let sine = value(given, name)?.approximate();
                *number_mut(&mut set, name)? = Number::from_f64((1.0 - sine * sine).max(0.0).sqrt()).ok()?;
            }
            Tolerances::For(one, other) => *number_mut(&mut set, one)? = value(given, other)?.clone(),
            Tolerances::OfPreset(name, of) => *number_mut(&mut set, name)? = value(&preset(of)?, name)?.clone(),
            Tolerances::Preset(of) => set = preset(of)?,
            Tolerances::Criteria(criteria) => set.criteria = criteria,
        }
        Some(set)
    }
}

fn number_mut<'s>(set: &'s mut ToleranceSet, name: &str) -> Option<&'s mut Number> {
    set.numbers_mut().into_iter().find(|(known, _)| *known == name).map(|(_, number)| number)
}

fn value<'s>(set: &'s ToleranceSet, name: &str) -> Option<&'s Number> {
    set.numbers().into_iter().find(|(known, _)| *known == name).map(|(_, number)| number)
}

/// Times so many thousandths, exactly.
fn times(number: &Number, thousandths: i64) -> Number {
    number.times(&Number::from_rational(BigRational::new(BigInt::from(thousandths), BigInt::from(1000))))
}

/// The range of some factors, all above 1 or all below; none of one factor, and where a factor between two of them is not among them.
pub(super) fn range_of_factors(name: &str, factors: &[i64]) -> Option<HypothesisRange> {
    let text = |factor: i64| FACTORS.iter().find(|(known, _)| *known == factor).map(|(_, text)| *text);
    let [least, most] = [factors.iter().min()?, factors.iter().max()?].map(|factor| *factor);
    let has_gaps = FACTORS.iter().any(|(known, _)| (least..most).contains(known) && !factors.contains(known));
    if least == most || has_gaps {
        return None;
    }
    let (least_text, most_text) = (text(least)?, text(most)?);
    let range = if FACTORS.iter().all(|(known, _)| *known <= most) {
        format!("{least_text} or more")
    } else if least == 0 {
        format!("{most_text} or less")
    } else {
        format!("{least_text} to {most_text}")
    };
    let name_range = range.replace(' ', "-");
    Some(HypothesisRange { name: format!("{name}-times-{name_range}"), sentence: format!("with {name} times {range}") })
}

/// Factors that questions are asked with once more where hypotheses about tolerances are alike, in thousandths.
const PROBES: [i64; 8] = [970, 1030, 930, 1070, 500, 2000, 100, 10_000];

/// The set with one tolerance changed a little, for each of them: what tells hypotheses apart that explain the same answers.
pub(super) fn probes(given: &ToleranceSet) -> Vec<ToleranceSet> {
    let all = USED.into_iter().flat_map(|name| PROBES.map(|factor| Tolerances::Times(name, factor, "")));
    all.filter_map(|change| change.changed(given, |_| None)).collect()
}
