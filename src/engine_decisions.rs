//! What an engine or the oracle says of the pair of a case, as it stands or changed, as `replay` shows it.

use rockproof_differential::builtin::BuiltinOracle;
use rockproof_differential::case_file::{Case, ChangedAnswers};
use rockproof_differential::collision::separation::Separation;
use rockproof_differential::engine::{Answer, Engine, EngineFailure, Trace};
use rockproof_model::{Block, Contact};

/// One answer with the decisions behind it.
pub(crate) struct EngineDecisions {
    pub(crate) name: String,
    pub(crate) contacts: Result<Vec<Contact>, EngineFailure>,
    pub(crate) trace: Option<Trace>,
    /// How the blocks lie, where an engine is asked for that.
    pub(crate) state: Option<String>,
    /// Whether it is the oracle's: that names contacts and says how blocks lie, an engine does one of the two.
    pub(crate) is_exact: bool,
}

impl EngineDecisions {
    /// Those of an engine.
    pub(crate) fn of(name: String, answer: Result<Answer, EngineFailure>, trace: Option<Trace>) -> EngineDecisions {
        let (contacts, state) = match answer {
            Ok(Answer::Contacts(contacts)) => (Ok(contacts), None),
            Ok(Answer::State(said)) => (Ok(Vec::new()), Some(said.to_string())),
            Err(failure) => (Err(failure), None),
        };
        EngineDecisions { name, contacts, trace, state, is_exact: false }
    }
}

/// How two blocks exactly lie; `None` where one is concave.
pub(crate) fn exact_state([a, b]: &[Block; 2]) -> Option<String> {
    Separation::of(a, b).map(|exact| format!("{} {:?} m", exact.state, exact.gap_m()))
}

/// How the pair of a case was changed, in words, and what the oracle and the engine say of it; `None` where the finding is about another engine, or about
/// the pair as it is.
pub(crate) fn changed_answers(
    case: &Case,
    engine: &dyn Engine,
    says_state: bool,
) -> Option<(String, Vec<EngineDecisions>)> {
    if case.about.engine != engine.name() {
        return None;
    }
    let change = case.about.checked_change()?;
    let ChangedAnswers { words, answers } = case.changed_answers(engine, &BuiltinOracle, says_state)?;
    let mut shown = Vec::new();
    for (number, answer) in answers.into_iter().enumerate() {
        let name = |who: &str| {
            let again = if number == 0 { "" } else { " (exchanged)" };
            format!("{who}, {change}{again}")
        };
        shown.push(EngineDecisions {
            name: name(&format!("exact {}", engine.precision())),
            contacts: Ok(answer.exact),
            trace: None,
            state: says_state.then(|| exact_state(&answer.blocks)).flatten(),
            is_exact: true,
        });
        shown.push(EngineDecisions::of(name(engine.name()), answer.said, None));
    }
    Some((words, shown))
}
