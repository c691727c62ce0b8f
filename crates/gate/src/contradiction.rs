//! Cases that are about how an engine contradicts itself, or gives no usable answer once the pair is changed: it is asked about the changed pair too.

use super::CheckStatus;
use rockproof_differential::attribution::{EnginePanel, WantedFindings, findings_wanted};
use rockproof_differential::case_file::{Case, ChangedAnswer, ChangedAnswers, ContactRow, contact_rows};
use rockproof_differential::engine::{Answer, Engine, EngineFailure};
use rockproof_differential::finding::{Cause, Finding};

/// What the answer to the pair of a case as it stands comes to.
pub(crate) struct PairVerdict {
    pub(crate) status: CheckStatus,
    pub(crate) message: String,
    /// Whether the case records such an answer, as far as it tells.
    pub(crate) is_recorded: bool,
}

/// What an engine says of the pair of a case that is about a changed pair, changed as the case says.
pub(crate) struct Contradiction {
    /// What was changed; `None` where the pair cannot be changed so.
    words: Option<String>,
    /// Why it gave no answer to the changed pair that can be held beside the one to the pair as it stands.
    failure: Option<EngineFailure>,
    /// Its contacts there, where there is one changed pair and it names some.
    said: Option<Vec<ContactRow>>,
    /// How it contradicts itself.
    found: Vec<Finding>,
}

impl Contradiction {
    /// Of the engine of a case, and what it says of the pair as it stands; `None` of a case that is about no changed pair.
    pub(crate) fn of(case: &Case, panel: &EnginePanel, engine: &dyn Engine, answer: &Answer) -> Option<Contradiction> {
        let about = &case.about;
        about.checked_change()?;
        let says_state = matches!(answer, Answer::State(_));
        let Some(ChangedAnswers { words, answers }) = case.changed_answers(engine, &*panel.oracle, says_state) else {
            return Some(Contradiction { words: None, failure: None, said: None, found: Vec::new() });
        };
        let failures = || answers.iter().filter_map(|answer| failure(&answer.said, says_state));
        let failure = failures().find(is_mistake).or_else(|| failures().next());
        let said = match &answers[..] {
            [ChangedAnswer { said: Ok(Answer::Contacts(contacts)), .. }] => Some(contact_rows(contacts)),
            _ => None,
        };
        let wanted =
            WantedFindings { cause: &about.cause, change: &about.change, kind: "", predicate: None, check: None };
        let is_such = |finding: &Finding| {
            finding.difference.change.name() == about.change && finding.scope.to_string() == about.engine
        };
        let found = if about.check.is_some() {
            Vec::new()
        } else {
            findings_wanted(&case.subject(), panel, wanted).into_iter().filter(is_such).collect()
        };
        Some(Contradiction { words: Some(words), failure, said, found })
    }

    /// What that comes to, beside what the answer to the pair as it stands does.
    pub(crate) fn judge(self, case: &Case, pair: PairVerdict) -> (CheckStatus, String) {
        let about = &case.about;
        let engine = &about.engine;
        let of_pair = (pair.status, pair.message);
        let Some(words) = &self.words else {
            return match of_pair.0 {
                CheckStatus::Fail => of_pair,
                _ => (CheckStatus::Skip, format!("the pair cannot be changed as the case says ({})", about.change)),
            };
        };
        if let Some(failure) = self.failure.as_ref().filter(|failure| is_mistake(failure)) {
            if about.check.is_some() && failure.change().name() == about.change {
                return match of_pair.0 {
                    CheckStatus::Pass => (CheckStatus::Pass, "as recorded".to_owned()),
                    CheckStatus::Fail | CheckStatus::Skip => of_pair,
                };
            }
            return (CheckStatus::Fail, format!("{engine} gives no answer to the pair with {words}: {failure}"));
        }
        let doubted = match about.check {
            Some(_) => format!("the {} of {engine} is mended", about.change),
            None => format!("{engine} contradicts itself"),
        };
        let Some(first) = self.found.first() else {
            return match self.failure {
                Some(failure) if of_pair.0 != CheckStatus::Fail => (
                    CheckStatus::Skip,
                    format!("whether {doubted} is not known: it gives no answer to the pair with {words}: {failure}"),
                ),
                _ => of_pair,
            };
        };
        if first.cause == Cause::Engine && first.difference.change.is_never_rounding() {
            let message = format!(
                "{engine} contradicts itself, and rounding is no reason: its answer is another one for the pair with {words}"
            );
            return (CheckStatus::Fail, message);
        }
        if self.found.iter().any(|finding| finding.cause == Cause::Defect) {
            return (CheckStatus::Fail, "a defect is back".to_owned());
        }
        if of_pair.0 == CheckStatus::Fail {
            return of_pair;
        }
        let is_recorded = match (first.comparison, &about.changed) {
            (Some(comparison), _) => about.said_state() == Some(&comparison.reported.to_string()),
            (None, Some(changed)) => self.said.as_ref() == Some(changed),
            // A case of an earlier version, or of a built-in engine, says of what kind the contact is.
            (None, None) => self.found.iter().any(|f| about.kind.is_empty() || f.difference.kinds() == about.kind),
        };
        match (is_recorded && pair.is_recorded, of_pair.0) {
            (true, CheckStatus::Pass) => (CheckStatus::Pass, "as recorded".to_owned()),
            (true, _) => of_pair,
            (false, _) => (
                CheckStatus::Fail,
                format!(
                    "{engine} contradicts itself otherwise than the case records: its answer is another one for the pair with {words}"
                ),
            ),
        }
    }
}

/// Why an answer to the changed pair cannot be held beside the one to the pair as it stands, which says only how blocks lie or names contacts.
fn failure(said: &Result<Answer, EngineFailure>, says_state: bool) -> Option<EngineFailure> {
    match said {
        Err(failure) => Some(failure.clone()),
        Ok(Answer::Contacts(_)) if says_state => {
            Some(EngineFailure::Unsupported("it names contacts, not how the blocks lie".to_owned()))
        }
        Ok(Answer::State(_)) if !says_state => said.clone().and_then(Answer::into_contacts).err(),
        Ok(_) => None,
    }
}

/// Whether giving no answer to the changed pair is a mistake. A campaign has no finding where an engine says that it cannot do that pair.
fn is_mistake(failure: &EngineFailure) -> bool {
    failure.change().is_unusable()
}
