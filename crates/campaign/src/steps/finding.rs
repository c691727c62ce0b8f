//! A finding about a step: one difference between neighbouring links of the chain of SPEC section 6, for a step instead of a
//! classification.

use rockproof_differential::compare;
use rockproof_differential::finding::{Cause, Deciding, Who};
use rockproof_differential::lockstep::Caused;
use rockproof_differential::lockstep::answer::Change;
use rockproof_model::{Contact, ContactKind};
use std::sync::Arc;

/// What differs between two steps, or between the states after them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StepChange {
    /// A decision.
    Decision(Change),
    /// The blocks overlap deeper after the stepper's step than after the oracle's.
    Deeper,
    /// They overlap less deep.
    Shallower,
    /// The same decisions and another state, in 512 bits too: `anchors`, `velocity` or `displacement`.
    State(&'static str),
}

impl StepChange {
    /// The names of changes that only steps have.
    pub const NAMES: [&'static str; 11] = [
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
    ];

    /// The name in tables and files.
    pub fn name(&self) -> &'static str {
        match self {
            StepChange::Decision(change) => change.name(),
            StepChange::Deeper => "deeper",
            StepChange::Shallower => "shallower",
            StepChange::State(what) => what,
        }
    }

    /// Whether a change of this name may be found in steps.
    pub fn is_known(name: &str) -> bool {
        StepChange::NAMES.contains(&name) || compare::Change::from_name(name).is_some()
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
    pub who: Who,
    /// The engine in whose steps it was seen.
    pub engine: Arc<str>,
    /// The step, from 1.
    pub step: i64,
    /// Why the step is another one.
    pub cause: Cause,
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
    pub deciding: Option<Deciding>,
    /// The exact margin of what decided a difference of contacts or of a mode, **0 at a tie**, and the same in roundoffs.
    pub margins: [Option<f64>; 2],
    /// The exact penetration after the stepper's step and after the oracle's (m).
    pub penetration: [Option<f64>; 2],
    /// What made the penetration another one.
    pub effect: &'static str,
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
    /// Takes over what a difference of two steps says.
    pub(super) fn tell(&mut self, caused: &Caused) {
        let difference = &caused.difference;
        self.change = StepChange::Decision(difference.change);
        self.contact = difference.contact.map(|(_, contact)| contact);
        self.solve = difference.solve;
        (self.before, self.after) = (difference.before.clone(), difference.after.clone());
        self.deciding = caused.deciding;
        self.margins = [caused.margin(), caused.margin_ulps()];
    }

    /// What makes two findings alike, in one line.
    pub fn fingerprint(&self) -> String {
        let kind = self.contact.map_or("pair", |contact| contact.kind.name());
        format!("{kind} {} {} {} {} {}", self.cause, self.change.name(), self.modes(), self.who, self.family)
    }

    fn modes(&self) -> String {
        match self.change {
            StepChange::Decision(Change::Mode) => format!("{}-{}", self.before, self.after),
            _ => "step".to_owned(),
        }
    }

    /// The name of its case file.
    pub fn file_name(&self) -> String {
        let kind = self.contact.map_or("pair", |contact| ContactKind::name(contact.kind));
        let (change, modes) = (self.change.name(), self.modes());
        let stem = format!(
            "step-{kind}-{}-{change}-{modes}-{}-{}-{}-{}-{}",
            self.cause, self.who, self.family, self.set, self.index, self.step
        );
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        format!("{}.json", stem.chars().map(plain).collect::<String>())
    }

    /// The finding's row of `step_findings.csv`, without the case file.
    pub fn row(&self) -> [String; STEP_FINDING_COLUMNS.len() - 1] {
        let number = |n: Option<f64>| n.map_or(String::new(), |n| format!("{n:e}"));
        let deciding = self.deciding.as_ref();
        let contact = |text: fn(&Contact) -> String| self.contact.as_ref().map_or(String::new(), text);
        [
            self.index.to_string(),
            self.family.to_string(),
            self.form.to_string(),
            self.set.to_string(),
            self.who.to_string(),
            self.step.to_string(),
            self.cause.to_string(),
            self.change.name().to_owned(),
            contact(|c| c.kind.name().to_owned()),
            contact(|c| c.a.to_string()),
            contact(|c| c.b.to_string()),
            self.solve.map_or(String::new(), |solve| solve.to_string()),
            self.before.clone(),
            self.after.clone(),
            deciding.map_or(String::new(), |d| d.decision.predicate.name().to_owned()),
            deciding.map_or(String::new(), Deciding::features),
            number(self.margins[0]),
            number(self.margins[1]),
            number(self.penetration[0]),
            number(self.penetration[1]),
            self.effect.to_owned(),
        ]
    }
}
