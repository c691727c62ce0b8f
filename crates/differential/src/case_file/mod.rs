//! Findings as files that stand for themselves: both blocks, every tolerance, what was expected and what was said.

mod changed;
mod contact_row;
mod description;
mod file;

pub use changed::{ChangedAnswer, ChangedAnswers};
pub use contact_row::{ContactRow, contact_rows};
pub use description::CaseDescription;
pub use file::CaseError;

use super::attribution::{EnginePanel, WantedFindings, findings_wanted};
use super::compare::AnswerChange;
use super::engine::{Answer, catch_panic};
use super::external::protocol::completed;
use super::finding::{Cause, Finding, FindingScope};
use super::separation_state::ReportedState;
use super::subject::{NamedSet, Subject};
use rockproof_model::decision::Predicate;
use rockproof_model::{Block, Contact, Precision, ToleranceSet};

/// A finding that can be replayed without the campaign it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What was found, and where it came from.
    pub about: CaseDescription,
    /// The first block, exact.
    pub a: Block,
    /// The second block, exact.
    pub b: Block,
    /// The tolerance set, exact.
    pub tolerances: ToleranceSet,
}

impl Case {
    /// The case of a finding about one of `subject`'s sets. `expected` and `found` are worked out anew.
    ///
    /// Returns `None` when the finding names a set the subject does not have.
    pub fn of(finding: &Finding, subject: &Subject, seed: u64, panel: &EnginePanel) -> Option<Case> {
        let set = subject.sets.iter().find(|s| s.name == finding.set)?;
        let tolerances = set.of(precision_of(&finding.scope, panel)).clone();
        let origin =
            format!("{} {} under {}, seed {seed}, index {}", finding.family, finding.form, finding.set, finding.index);
        let mut case = Case {
            about: CaseDescription {
                engine: finding.scope.to_string(),
                cause: finding.cause.to_string(),
                change: finding.difference.change.to_string(),
                kind: finding.difference.kinds(),
                predicate: String::new(),
                features: String::new(),
                margin: None,
                margin_ulps: None,
                origin,
                note: None,
                check: None,
                states: None,
                found_state: None,
                expected: Vec::new(),
                found: Vec::new(),
                changed: None,
            },
            a: subject.a.clone(),
            b: subject.b.clone(),
            tolerances,
        };
        case.describe(finding, panel);
        Some(case)
    }

    /// The pair of the case, as one of a campaign.
    pub fn subject(&self) -> Subject {
        let set = NamedSet::same("case", &self.tolerances);
        Subject {
            index: 0,
            family: "case".into(),
            form: "case".into(),
            a: self.a.clone(),
            b: self.b.clone(),
            sets: vec![set],
        }
    }

    /// The findings of the same cause, change, kind, predicate and engine that the pair shows now.
    pub fn findings(&self, panel: &EnginePanel) -> Vec<Finding> {
        let about = &self.about;
        // What is nearest to a tie says nothing about an engine from outside.
        let predicate = (about.cause != Cause::Engine.name()).then_some(about.predicate.as_str());
        let wanted = WantedFindings {
            cause: &about.cause,
            change: &about.change,
            kind: &about.kind,
            predicate,
            check: about.check.as_deref(),
        };
        let alike = |f: &Finding| {
            f.cause.name() == about.cause
                && f.difference.change.name() == about.change
                && f.check.map(AnswerChange::name) == about.check.as_deref()
                && (about.kind.is_empty() || f.difference.kinds() == about.kind)
                && predicate.is_none_or(|name| f.predicate().map_or("", Predicate::name) == name)
                // With one engine left, what a tolerance set for one precision does is the doing of all there are.
                && (f.cause == Cause::Tolerance || f.scope.to_string() == about.engine)
        };
        findings_wanted(&self.subject(), panel, wanted).into_iter().filter(alike).collect()
    }

    /// Takes what decided it, and both answers, from a finding about this pair.
    pub fn describe(&mut self, finding: &Finding, panel: &EnginePanel) {
        self.about.predicate = finding.predicate().map_or(String::new(), |p| p.to_string());
        self.about.features = finding.deciding.map_or(String::new(), |d| d.features());
        self.about.margin = finding.margin();
        self.about.margin_ulps = finding.margin_ulps();
        self.about.note = finding.note.clone();
        self.about.check = finding.check.map(|check| check.to_string());
        self.about.states = finding.comparison.map(|m| m.to_string());
        let (answers, state) = self.answers(finding, panel);
        [self.about.expected, self.about.found] = answers.map(|contacts| contact_rows(&contacts));
        self.about.found_state = state.filter(|_| self.about.can_have_found_state()).map(|said| said.to_string());
        let is_outside = finding.cause == Cause::Engine && finding.check.is_none();
        let engine =
            panel.engines.iter().find(|e| is_outside && finding.scope == FindingScope::Engine(e.name().into()));
        let changed =
            engine.and_then(|engine| self.changed_answers(&**engine, &*panel.oracle, finding.comparison.is_some()));
        self.about.changed = match changed.as_ref().map(|changed| &changed.answers[..]) {
            Some([ChangedAnswer { said: Ok(Answer::Contacts(said)), .. }]) => Some(contact_rows(said)),
            _ => None,
        };
    }

    /// The contacts before the link that is the cause and after it, and what an engine says there that says only how blocks lie.
    fn answers(&self, finding: &Finding, panel: &EnginePanel) -> ([Vec<Contact>; 2], Option<ReportedState>) {
        let exact = |a: &Block, b: &Block, t: &ToleranceSet| panel.oracle.prepare(a, b).pair().classify(t).contacts;
        let given = || exact(&self.a, &self.b, &self.tolerances);
        let precision = precision_of(&finding.scope, panel);
        let rounded = self
            .a
            .rounded(precision)
            .and_then(|a| Some((a, self.b.rounded(precision)?, self.tolerances.rounded(precision).ok()?)));
        let contacts = match (finding.cause, rounded) {
            (Cause::Tolerance, _) => [exact(&self.a, &self.b, &self.tolerances.ideal()), given()],
            (_, None) => [given(), Vec::new()],
            (Cause::Representation, Some((a, b, t))) => [given(), exact(&a, &b, &t)],
            (Cause::Arithmetic | Cause::Defect | Cause::Engine, Some((a, b, t))) => {
                let engine = panel.engines.iter().find(|e| finding.scope == FindingScope::Engine(e.name().into()));
                let answer = engine.and_then(|e| catch_panic(|| e.prepare(&a, &b)?.answer(&t)).ok());
                let right = exact(&a, &b, &t);
                let (said, state) = match answer {
                    Some(Answer::Contacts(contacts)) => (contacts, None),
                    Some(Answer::State(state)) => (Vec::new(), Some(state)),
                    None => (Vec::new(), None),
                };
                let said = completed(said, &right);
                return ([right, said], state);
            }
        };
        (contacts, None)
    }
}

/// The precision whose input and tolerance set a finding is about; f64's where it is about all, if there is one.
pub fn precision_of(scope: &FindingScope, panel: &EnginePanel) -> Precision {
    match scope {
        FindingScope::Rounded(precision) => *precision,
        FindingScope::Any => panel.precisions().pop().unwrap_or(Precision::F64),
        FindingScope::Engine(name) => {
            panel.engines.iter().find(|e| e.name() == &**name).map_or(Precision::F64, |e| e.precision())
        }
    }
}
