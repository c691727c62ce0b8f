//! What is said of the pair of a case when it is changed as a metamorphic check changes it: such a finding is about two answers of one engine.

use super::Case;
use crate::engine::{Answer, Engine, EngineFailure, Oracle, catch_panic};
use crate::external::protocol::completed;
use crate::metamorphic::ChangedPairs;
use crate::transform::{ExactBlocks, Transformed};
use rockproof_model::{Block, Contact};

/// What an engine and the oracle say of the pair of a case, changed.
pub struct ChangedAnswers {
    /// What was changed.
    pub words: String,
    /// The answers; where a block is put far away of an engine that names contacts, one for each order of the two.
    pub answers: Vec<ChangedAnswer>,
}

/// What is said of one changed pair. Contacts are in the numbering of the pair itself.
pub struct ChangedAnswer {
    /// The changed blocks, as the engine gets them.
    pub blocks: [Block; 2],
    /// The exact contacts.
    pub exact: Vec<Contact>,
    /// What the engine says.
    pub said: Result<Answer, EngineFailure>,
}

impl Case {
    /// Asks about the pair changed as the finding says, `says_state` where the engine says only how blocks lie; `None` where the finding is about no such
    /// change, or the pair cannot be changed so.
    pub fn changed_answers(
        &self,
        engine: &dyn Engine,
        oracle: &dyn Oracle,
        says_state: bool,
    ) -> Option<ChangedAnswers> {
        let precision = engine.precision();
        let blocks = [self.a.rounded(precision)?, self.b.rounded(precision)?];
        let tolerances = self.tolerances.rounded(precision).ok()?;
        let exact = ExactBlocks::new([&self.a, &self.b]);
        let check = self.about.checked_change()?;
        let changed = ChangedPairs::of(check.name(), &exact, &blocks, &tolerances, precision, says_state)?;
        let ask = |pair: Transformed| {
            let ([a, b], tolerances) = (&pair.blocks, pair.tolerances(&tolerances));
            let right = oracle.prepare(a, b).pair().classify(&tolerances).contacts;
            let answer = catch_panic(|| engine.prepare(a, b)?.answer(&tolerances));
            let to_original = |contacts| pair.to_original(&completed(contacts, &right));
            let said = answer.map(|answer| answer.map_contacts(to_original));
            ChangedAnswer { exact: pair.to_original(&right), said, blocks: pair.blocks }
        };
        Some(ChangedAnswers { words: changed.words, answers: changed.pairs.into_iter().map(ask).collect() })
    }
}
