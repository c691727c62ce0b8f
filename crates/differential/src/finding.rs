//! A finding: one difference between neighbouring links of the chain of SPEC section 6, its cause and what decided it.

use super::compare::{AnswerChange, Difference};
use super::row::FindingRow;
use super::separation_state::{SeparationState, StateComparison};
use rockproof_model::decision::{Decision, Predicate};
use rockproof_model::{ContactKind, Precision};
use rockproof_results::bounded;
use std::fmt;
use std::sync::Arc;

rockproof_model::named_enum! {
    /// The link of SPEC section 6's chain at which an answer changed.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Cause: from_name, Display {
        /// From the ideal tolerances to the given ones, both exact.
        Tolerance = "tolerance",
        /// From the exact input to the rounded one, both classified exactly.
        Representation = "representation",
        /// From the exact to the engine's classification of the rounded input.
        Arithmetic = "arithmetic",
        /// As arithmetic, but the difference remains when the engine's code runs with a scalar of several hundred bits and
        /// no comparison there was close: a mistake in the code.
        Defect = "defect",
        /// From the exact to an external engine's answer for the rounded input: its arithmetic or its code. Nobody can tell
        /// which from outside, for a program cannot be run again with several hundred bits.
        Engine = "engine",
    }
}

/// Whom a finding is about, so that each is counted once: a tolerance changes the exact answer for everyone, rounding
/// the input changes it for every engine of a precision, arithmetic belongs to one engine.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FindingScope {
    /// Every engine of the campaign.
    Any,
    /// Every engine that rounds its input to this precision.
    Rounded(Precision),
    /// One engine, by name.
    Engine(Arc<str>),
}

impl FindingScope {
    /// What [`FindingScope`]'s text form stands for.
    pub fn from_name(name: &str) -> FindingScope {
        match name {
            "any" => FindingScope::Any,
            "f32" => FindingScope::Rounded(Precision::F32),
            "f64" => FindingScope::Rounded(Precision::F64),
            engine => FindingScope::Engine(engine.into()),
        }
    }
}

impl fmt::Display for FindingScope {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FindingScope::Any => f.pad("any"),
            FindingScope::Rounded(precision) => precision.fmt(f),
            FindingScope::Engine(name) => f.pad(name),
        }
    }
}

/// Beyond so many roundoffs from a tie, the rounding of a sound formula does not explain a wrong outcome.
pub const FAR_FROM_TIE: f64 = 1000.0;

/// The decision behind a difference: of those that came out differently on the two sides, the one nearest to a tie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecidingDecision {
    /// The decision.
    pub decision: Decision,
    /// Its outcome before and after.
    pub outcomes: [i8; 2],
    /// Its exact margin, value over the sum of the magnitudes of its terms; **0 is a tie**; `None` where it is not a
    /// comparison. Under tolerance and representation of the exact input, else of the rounded one.
    pub margin: Option<f64>,
    /// The margin in units of the engine's roundoff (half of eps); `None` for a tolerance finding.
    pub margin_ulps: Option<f64>,
}

impl DecidingDecision {
    /// The features of the decision, one after the other.
    pub fn features(&self) -> String {
        self.decision.features().iter().flatten().map(ToString::to_string).collect::<Vec<_>>().join(" ")
    }
}

/// One finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The pair's number in the campaign.
    pub index: u64,
    /// The pair's family.
    pub family: Arc<str>,
    /// The pair's form.
    pub form: Arc<str>,
    /// The tolerance set.
    pub set: Arc<str>,
    /// Whom it is about.
    pub scope: FindingScope,
    /// Why the answer changed.
    pub cause: Cause,
    /// What changed.
    pub difference: Difference,
    /// What decided it, where traces tell; under [`Cause::Engine`] no more than the decision of the oracle nearest to a tie around it.
    pub deciding: Option<DecidingDecision>,
    /// What was said and what is so, where the engine says only apart, touching or overlapping.
    pub comparison: Option<StateComparison>,
    /// What the engine said when it gave no answer.
    pub note: Option<String>,
    /// The check whose changed pair the engine gave no usable answer to, where it gave one to the pair as it stands.
    pub check: Option<AnswerChange>,
}

impl Finding {
    /// Whether metamorphic checks have to be made to see it.
    pub fn needs_checks(&self) -> bool {
        self.difference.change.is_metamorphic() || self.check.is_some()
    }

    /// The kind of the contact the finding is about: before the change, or else after it.
    pub fn kind(&self) -> Option<ContactKind> {
        self.difference.contact().map(|c| c.kind())
    }

    /// The predicate that decided it.
    pub fn predicate(&self) -> Option<Predicate> {
        self.deciding.map(|d| d.decision.predicate)
    }

    /// What makes two findings alike.
    pub fn fingerprint(&self) -> Fingerprint {
        Fingerprint {
            scope: self.scope.clone(),
            cause: self.cause,
            change: self.difference.change,
            predicate: self.predicate().filter(|_| tells_apart(self.cause)),
            kind: self.kind(),
            states: self.comparison.map(|m| [m.exact, m.reported.state]),
            family: Arc::clone(&self.family),
        }
    }

    /// The exact margin, if there is one: that of the deciding predicate, or of touching.
    pub fn margin(&self) -> Option<f64> {
        self.deciding.and_then(|d| d.margin).or(self.comparison.map(|m| m.margin))
    }

    /// The margin in units of the engine's roundoff, if there is one.
    pub fn margin_ulps(&self) -> Option<f64> {
        self.deciding.and_then(|d| d.margin_ulps).or(self.comparison.map(|m| m.margin_ulps))
    }

    /// The finding's row of `findings.csv`; `case` is its case file, empty where there is none.
    pub fn row(&self, case: String) -> FindingRow {
        let kind = |c: Option<rockproof_model::Contact>, state: Option<SeparationState>| {
            c.map_or(state.map_or("", SeparationState::name), |c| c.kind().name()).to_owned()
        };
        FindingRow {
            index: self.index,
            family: self.family.to_string(),
            form: self.form.to_string(),
            tolerances: self.set.to_string(),
            engine: self.scope.clone(),
            cause: self.cause,
            change: self.difference.change,
            kind_before: kind(self.difference.before, self.comparison.map(|m| m.exact)),
            kind_after: kind(self.difference.after, self.comparison.map(|m| m.reported.state)),
            predicate: self.predicate().map_or(String::new(), |p| p.to_string()),
            features: self.deciding.map_or(String::new(), |d| d.features()),
            margin: self.margin(),
            margin_ulps: self.margin_ulps(),
            case,
        }
    }
}

/// The columns of `findings.csv`.
pub const FINDING_COLUMNS: [&str; 14] = [
    "index",
    "family",
    "form",
    "tolerances",
    "engine",
    "cause",
    "change",
    "kind_before",
    "kind_after",
    "predicate",
    "features",
    "margin",
    "margin_ulps",
    "case",
];

/// What makes two findings alike: only the first few of each are shrunk and kept as case files.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Fingerprint {
    /// Whom it is about.
    pub scope: FindingScope,
    /// Why the answer changed.
    pub cause: Cause,
    /// What changed.
    pub change: AnswerChange,
    /// What decided it.
    pub predicate: Option<Predicate>,
    /// The contact's kind.
    pub kind: Option<ContactKind>,
    /// How the blocks lie, and how the engine says they do.
    pub states: Option<[SeparationState; 2]>,
    /// The family that showed it.
    pub family: Arc<str>,
}

/// Whether the predicate of a finding of this cause, or its family, tells it from others: an engine from outside tells no decisions, and what is nearest to a
/// tie there may have nothing to do with it.
fn tells_apart(cause: Cause) -> bool {
    cause != Cause::Engine
}

impl Fingerprint {
    /// The fingerprint of the finding that a row tells of.
    pub fn of_row(row: &FindingRow) -> Fingerprint {
        let either = row.kind_before.as_str();
        let either = if either.is_empty() { row.kind_after.as_str() } else { either };
        let states = SeparationState::from_name(&row.kind_before).zip(SeparationState::from_name(&row.kind_after));
        Fingerprint {
            scope: row.engine.clone(),
            cause: row.cause,
            change: row.change,
            predicate: Predicate::from_name(&row.predicate).filter(|_| tells_apart(row.cause)),
            kind: ContactKind::from_name(either),
            states: states.map(|(exact, said)| [exact, said]),
            family: row.family.as_str().into(),
        }
    }

    /// The fingerprint in one line: what decided it, or how the blocks lie and how the engine says they do. One mistake of an engine from
    /// outside shows in every family, so those of such engines are alike whatever the family.
    pub fn text(&self) -> String {
        let kind = self.kind.map_or("pair", ContactKind::name);
        let alike = format!("{kind} {} {} {} {}", self.cause, self.change, self.decided(), self.scope);
        if tells_apart(self.cause) { format!("{alike} {}", self.family) } else { alike }
    }

    fn decided(&self) -> String {
        match (self.predicate, self.states) {
            (Some(predicate), _) => predicate.name().to_owned(),
            (None, Some([exact, said])) => format!("{exact}-{said}"),
            (None, None) => "no-trace".to_owned(),
        }
    }

    /// `<kind>-<cause>-<slug>`, the stem of a case file; the pair's number makes it unique, and a long one ends with a digest.
    pub fn file_stem(&self, set: &str, index: u64) -> String {
        let decided = self.decided();
        let kind = self.kind.map_or("pair", ContactKind::name);
        let stem =
            format!("{kind}-{}-{}-{decided}-{}-{}-{set}-{index}", self.cause, self.change, self.scope, self.family);
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        bounded(&stem.chars().map(plain).collect::<String>())
    }
}
