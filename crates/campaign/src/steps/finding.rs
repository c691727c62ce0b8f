//! A finding about a step: one difference between neighbouring links of the chain of SPEC section 6, for a step instead of a
//! classification.

use rockproof_differential::compare;
use rockproof_differential::finding::{DecidingDecision, FindingScope};
use rockproof_differential::lockstep::answer::StepAnswerChange;
use rockproof_differential::lockstep::penetration::DepthDifference;
use rockproof_differential::lockstep::{AttributedDifference, DriftQuantity, Intrusion, StepCause};
use rockproof_differential::row;
use rockproof_model::Contact;
use rockproof_results::bounded;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use std::sync::Arc;

/// What differs between two steps, or between the states after them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StepChange {
    /// A decision.
    Decision(StepAnswerChange),
    /// The blocks overlap deeper after the stepper's step than after the oracle's.
    Deeper,
    /// They overlap less deep.
    Shallower,
    /// The same decisions and another state, in 512 bits too.
    State(DriftQuantity),
    /// The blocks pass through one another, or overlap where no contact sees it.
    Intrusion(Intrusion),
}

impl StepChange {
    /// The names of changes that only steps have.
    pub const NAMES: [&'static str; 13] = [
        "mode",
        "iterations",
        "converged",
        "retries",
        "time-step",
        "stopped",
        "deeper",
        "shallower",
        "anchors",
        "velocity",
        "displacement",
        "passage",
        "unseen",
    ];

    /// What a difference of depths is called.
    pub(super) fn of_depth(depth: &DepthDifference) -> StepChange {
        if depth.deeper_by() > 0.0 { StepChange::Deeper } else { StepChange::Shallower }
    }

    /// The name in tables and files.
    pub fn name(&self) -> &'static str {
        match self {
            StepChange::Decision(change) => change.name(),
            StepChange::Deeper => "deeper",
            StepChange::Shallower => "shallower",
            StepChange::State(what) => what.name(),
            StepChange::Intrusion(kind) => kind.name(),
        }
    }

    /// Whether a change of this name may be found in steps.
    pub fn is_known(name: &str) -> bool {
        StepChange::NAMES.contains(&name) || compare::AnswerChange::from_name(name).is_some()
    }
}

/// One finding.
#[derive(Clone, Debug, PartialEq)]
pub struct StepFinding {
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
    /// The engine in whose steps it was seen.
    pub engine: Arc<str>,
    /// The step, from 1.
    pub step: i64,
    /// Why the step is another one.
    pub cause: StepCause,
    /// What differs.
    pub change: StepChange,
    /// The contact it is about, if it is about one.
    pub contact: Option<Contact>,
    /// Of a mode: the first solve, from 1, after which it differs.
    pub solve: Option<usize>,
    /// What the earlier link has.
    pub before: String,
    /// What the later link has.
    pub after: String,
    /// What decided a difference of contacts.
    pub deciding: Option<DecidingDecision>,
    /// The exact margin of what decided a difference of contacts or of a mode, **0 at a tie**, and the same in roundoffs.
    pub margins: [Option<f64>; 2],
    /// The exact penetration after the stepper's step and after the oracle's (m).
    pub penetration: [Option<f64>; 2],
    /// What made the penetration another one.
    pub effect: &'static str,
}

/// One finding as `step_findings.csv` has it. The fields are its columns and mean what those of [`StepFinding`] do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "the fields are those of StepFinding")]
pub struct StepFindingRow {
    pub index: u64,
    pub family: String,
    pub form: String,
    pub tolerances: String,
    #[serde(serialize_with = "row::text", deserialize_with = "row::deserialize_scope")]
    pub engine: FindingScope,
    pub step: i64,
    #[serde(serialize_with = "row::text", deserialize_with = "cause")]
    pub cause: StepCause,
    pub change: String,
    pub kind: String,
    pub feature_a: Option<u32>,
    pub feature_b: Option<u32>,
    pub solve: Option<usize>,
    pub before: String,
    pub after: String,
    pub predicate: String,
    pub features: String,
    #[serde(serialize_with = "row::exponential", deserialize_with = "row::finite")]
    pub margin: Option<f64>,
    #[serde(serialize_with = "row::exponential", deserialize_with = "row::finite")]
    pub margin_ulps: Option<f64>,
    #[serde(serialize_with = "row::exponential", deserialize_with = "row::finite")]
    pub penetration_stepper_m: Option<f64>,
    #[serde(serialize_with = "row::exponential", deserialize_with = "row::finite")]
    pub penetration_oracle_m: Option<f64>,
    pub effect: String,
    pub case: String,
}

/// A cause by its name.
fn cause<'d, D: Deserializer<'d>>(deserializer: D) -> Result<StepCause, D::Error> {
    let text = String::deserialize(deserializer)?;
    StepCause::from_name(&text).ok_or_else(|| D::Error::custom(format!("\"{text}\" is no cause")))
}

/// The columns of `step_findings.csv`.
pub const STEP_FINDING_COLUMNS: [&str; 22] = [
    "index",
    "family",
    "form",
    "tolerances",
    "engine",
    "step",
    "cause",
    "change",
    "kind",
    "feature_a",
    "feature_b",
    "solve",
    "before",
    "after",
    "predicate",
    "features",
    "margin",
    "margin_ulps",
    "penetration_stepper_m",
    "penetration_oracle_m",
    "effect",
    "case",
];

impl StepFinding {
    /// A smaller step shows a difference of depths by at least this share of it.
    pub(super) const SHARE_OF_DEPTH: f64 = 0.5;

    /// Takes over what a difference of two steps says.
    pub(super) fn take_difference(&mut self, attributed: &AttributedDifference) {
        let difference = &attributed.difference;
        self.change = StepChange::Decision(difference.change);
        self.contact = difference.contact.map(|(_, contact)| contact);
        self.solve = difference.solve;
        (self.before, self.after) = (difference.before.clone(), difference.after.clone());
        self.deciding = attributed.deciding;
        self.margins = [attributed.margin(), attributed.margin_ulps()];
    }

    /// The finding's row of `step_findings.csv`; `case` is its case file, empty where there is none.
    pub fn row(&self, case: String) -> StepFindingRow {
        let deciding = self.deciding.as_ref();
        StepFindingRow {
            index: self.index,
            family: self.family.to_string(),
            form: self.form.to_string(),
            tolerances: self.set.to_string(),
            engine: self.scope.clone(),
            step: self.step,
            cause: self.cause,
            change: self.change.name().to_owned(),
            kind: self.contact.map_or(String::new(), |c| c.kind().name().to_owned()),
            feature_a: self.contact.map(|c| c.key.numbers()[0]),
            feature_b: self.contact.map(|c| c.key.numbers()[1]),
            solve: self.solve,
            before: self.before.clone(),
            after: self.after.clone(),
            predicate: deciding.map_or(String::new(), |d| d.decision.predicate.name().to_owned()),
            features: deciding.map_or(String::new(), DecidingDecision::features),
            margin: self.margins[0],
            margin_ulps: self.margins[1],
            penetration_stepper_m: self.penetration[0],
            penetration_oracle_m: self.penetration[1],
            effect: self.effect.to_owned(),
            case,
        }
    }
}

impl StepFindingRow {
    /// What makes two findings alike, in one line.
    pub fn fingerprint(&self) -> String {
        let StepFindingRow { cause, change, engine, family, .. } = self;
        format!("{} {cause} {change} {} {engine} {family}", self.kind(), self.modes())
    }

    /// The name of the finding's case file.
    pub fn file_name(&self) -> String {
        let StepFindingRow { index, family, tolerances, engine, step, cause, change, .. } = self;
        let (kind, modes) = (self.kind(), self.modes());
        let stem = format!("step-{kind}-{cause}-{change}-{modes}-{engine}-{family}-{tolerances}-{index}-{step}");
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        format!("{}.json", bounded(&stem.chars().map(plain).collect::<String>()))
    }

    fn kind(&self) -> &str {
        if self.kind.is_empty() { "pair" } else { &self.kind }
    }

    fn modes(&self) -> String {
        match self.change == StepAnswerChange::Mode.name() {
            true => format!("{}-{}", self.before, self.after),
            false => "step".to_owned(),
        }
    }
}
