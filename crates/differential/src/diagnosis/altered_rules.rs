//! Hypotheses about rules: `<` for `≤` and the other way round at exact ties, and rules that are not there.

use super::hypothesis::Hypothesis;
use super::question::PreparedQuestion;
use rockproof_model::decision::Predicate;
use rockproof_model::{Contact, Sign};
use rockproof_oracle::RuleVariant;

/// A rule that differs from that of SPEC.
#[derive(Clone, Copy, Debug)]
enum AlteredRule {
    /// A tie is taken for a value of this sign.
    Tie(Predicate, Sign),
    /// The question has this answer, whatever it is asked of.
    Always(Predicate, bool),
    /// Of several entrances that with the smallest gap is chosen.
    SmallestGap,
}

/// Where SPEC says no at a tie.
const STRICT: [Predicate; 3] = [Predicate::FootInside, Predicate::InsideFace, Predicate::FeetInside];

/// Rules that may not be there: the answer that stands for that.
const ABSENT: [(Predicate, bool); 16] = [
    (Predicate::OneExit, true),
    (Predicate::ShortestExit, true),
    (Predicate::TrueExit, true),
    (Predicate::VertexTerritory, false),
    (Predicate::EdgeTerritory, false),
    (Predicate::VertexRegion, true),
    (Predicate::EdgeRegion, true),
    (Predicate::FootRegion, true),
    (Predicate::FootInside, true),
    (Predicate::FeetInside, true),
    (Predicate::InsideFace, true),
    (Predicate::ConePasses, true),
    (Predicate::WedgesPass, true),
    (Predicate::NearlyParallel, false),
    (Predicate::VertexFaceDepth, true),
    (Predicate::EdgeEdgeDepth, true),
];

/// The hypotheses about rules.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let ties = Predicate::ALL.into_iter().filter(|predicate| *predicate != Predicate::GapSign).map(|predicate| {
        AlteredRule::Tie(predicate, if STRICT.contains(&predicate) { Sign::Positive } else { Sign::Negative })
    });
    let gaps = [Sign::Negative, Sign::Positive].map(|sign| AlteredRule::Tie(Predicate::GapSign, sign));
    let absent = ABSENT.map(|(predicate, answer)| AlteredRule::Always(predicate, answer));
    let smallest = std::iter::once(AlteredRule::SmallestGap);
    gaps.into_iter().chain(ties).chain(absent).chain(smallest).map(|rule| Box::new(rule) as Box<dyn Hypothesis>)
}

impl Hypothesis for AlteredRule {
    fn name(&self) -> String {
        match self {
            AlteredRule::Tie(Predicate::GapSign, Sign::Positive) => "gap-of-0-positive".to_owned(),
            AlteredRule::Tie(Predicate::GapSign, _) => "gap-of-0-negative".to_owned(),
            AlteredRule::Tie(predicate, _) => format!("{predicate}-turned-at-ties"),
            AlteredRule::Always(predicate, _) => format!("{predicate}-left-out"),
            AlteredRule::SmallestGap => "smallest-gap-for-entrance".to_owned(),
        }
    }

    fn sentence(&self) -> String {
        match self {
            AlteredRule::Tie(Predicate::GapSign, Sign::Positive) => {
                "but for gaps of exactly 0, which count as positive".to_owned()
            }
            AlteredRule::Tie(Predicate::GapSign, _) => "but for gaps of exactly 0, which count as negative".to_owned(),
            AlteredRule::Tie(predicate, Sign::Positive) => {
                format!("but for ties of {predicate}, which count as yes (≤ for <)")
            }
            AlteredRule::Tie(predicate, _) => format!("but for ties of {predicate}, which count as no (< for ≤)"),
            AlteredRule::Always(predicate, _) => format!("but for the rule {predicate}, which is left out"),
            AlteredRule::SmallestGap => {
                "but for entrances, of which that with the smallest gap is chosen instead of the largest".to_owned()
            }
        }
    }

    fn contacts(&self, asked: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        let variant = match *self {
            AlteredRule::Tie(predicate, taken) => RuleVariant::Tie(predicate, taken),
            AlteredRule::Always(predicate, answer) => RuleVariant::Always(predicate, answer),
            AlteredRule::SmallestGap => RuleVariant::SmallestGap,
        };
        Some(asked.pair.classify_with_variant(&asked.question.tolerances, variant))
    }

    fn is_about_ties(&self) -> bool {
        matches!(self, AlteredRule::Tie(..))
    }
}
