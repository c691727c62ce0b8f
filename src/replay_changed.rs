//! What an engine and the oracle say of the pair of a case when it is changed as a metamorphic check changes it: such a finding is about two
//! answers of one engine.

use crate::replay::EngineDecisions;
use rockproof_differential::builtin::BuiltinOracle;
use rockproof_differential::case_file::Case;
use rockproof_differential::collision::separation::Separation;
use rockproof_differential::engine::{Answer, Engine, Oracle, catch_panic};
use rockproof_differential::external::protocol::completed;
use rockproof_differential::metamorphic::ChangedPairs;
use rockproof_differential::transform::ExactBlocks;
use rockproof_model::{Block, ToleranceSet};

/// The answers to the changed pair, in the numbering of the pair itself.
pub(crate) struct ChangedAnswers {
    /// What was changed.
    pub(crate) words: String,
    /// Those of the oracle and of the engine.
    pub(crate) answers: Vec<EngineDecisions>,
}

/// The question to the engine, as it gets it.
pub(crate) struct RoundedQuestion<'q> {
    pub(crate) engine: &'q dyn Engine,
    pub(crate) blocks: &'q [Block; 2],
    pub(crate) tolerances: &'q ToleranceSet,
    /// Whether the engine says only how blocks lie.
    pub(crate) says_state: bool,
}

/// Asks about the changed pair; `None` where the finding of the case is about another engine, or about the pair as it is.
pub(crate) fn changed_answers(case: &Case, asked: &RoundedQuestion<'_>) -> Option<ChangedAnswers> {
    let RoundedQuestion { engine, blocks, tolerances, says_state } = *asked;
    if case.about.engine != engine.name() {
        return None;
    }
    let (exact, precision) = (ExactBlocks::new([&case.a, &case.b]), engine.precision());
    let ChangedPairs { words, pairs } =
        ChangedPairs::of(&case.about.change, &exact, blocks, tolerances, precision, says_state)?;
    let mut answers = Vec::new();
    for (number, pair) in pairs.iter().enumerate() {
        let [a, b] = &pair.blocks;
        let tolerances = pair.tolerances(tolerances);
        let name = |who: &str| {
            let again = if number == 0 { "" } else { " (exchanged)" };
            format!("{who}, {}{again}", case.about.change)
        };
        let prepared = BuiltinOracle.prepare(a, b);
        let right = prepared.pair().classify(&tolerances).contacts;
        let (contacts, state) = match catch_panic(|| engine.prepare(a, b)?.answer(&tolerances)) {
            Ok(Answer::Contacts(contacts)) => (Ok(pair.to_original(&completed(contacts, &right))), None),
            Ok(Answer::State(said)) => (Ok(Vec::new()), Some(said.to_string())),
            Err(failure) => (Err(failure), None),
        };
        let lies = Separation::of(a, b).filter(|_| says_state);
        answers.push(EngineDecisions {
            name: name(&format!("exact {precision}")),
            contacts: Ok(pair.to_original(&right)),
            trace: Some(prepared.pair().trace(&tolerances)),
            state: lies.map(|exact| format!("{} {:?} m", exact.state, exact.gap_m())),
        });
        answers.push(EngineDecisions { name: name(engine.name()), contacts, trace: None, state });
    }
    Some(ChangedAnswers { words, answers })
}
