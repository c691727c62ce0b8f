//! What an engine says of the pair of a case when it is changed as a metamorphic check changes it: such a finding is about two answers of one engine.

use super::Case;
use crate::engine::{Answer, Engine, EngineFailure, Oracle, catch_panic};
use crate::external::protocol::completed;
use crate::metamorphic::ChangedPairs;
use crate::transform::{ExactBlocks, Transformed};

/// What an engine says of a changed pair.
pub struct ChangedAnswers {
    /// What was changed.
    pub words: String,
    /// The answers, in the numbering of the pair itself; of a block far away one for each order of the two.
    pub said: Vec<Result<Answer, EngineFailure>>,
}

impl Case {
    /// What an engine says of the pair changed as the finding says, in the numbering of the pair itself; `None` where it is about no such change, or the pair
    /// cannot be changed so.
    pub fn changed_answers(&self, engine: &dyn Engine, oracle: &dyn Oracle) -> Option<ChangedAnswers> {
        let precision = engine.precision();
        let blocks = [self.a.rounded(precision)?, self.b.rounded(precision)?];
        let tolerances = self.tolerances.rounded(precision).ok()?;
        let exact = ExactBlocks::new([&self.a, &self.b]);
        let (change, says_state) = (&self.about.change, self.about.states.is_some());
        let ChangedPairs { words, pairs } =
            ChangedPairs::of(change, &exact, &blocks, &tolerances, precision, says_state)?;
        let ask = |pair: &Transformed| {
            let ([a, b], tolerances) = (&pair.blocks, pair.tolerances(&tolerances));
            let answer = catch_panic(|| engine.prepare(a, b)?.answer(&tolerances))?;
            let Answer::Contacts(contacts) = answer else { return Ok(answer) };
            let right = oracle.prepare(a, b).pair().classify(&tolerances).contacts;
            Ok(Answer::Contacts(pair.to_original(&completed(contacts, &right))))
        };
        Some(ChangedAnswers { words, said: pairs.iter().map(ask).collect() })
    }
}
