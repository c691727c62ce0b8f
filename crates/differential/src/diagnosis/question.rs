//! One question to an engine, what it said, and what is so.

use crate::answer_detail::AnswerDetail;
use crate::collision::CollisionQuery;
use crate::collision::separation::Separation;
use crate::compare::{AnswerChange, Features, differences};
use crate::engine::{Answer, Engine, ExactPair, catch_panic};
use crate::explain::{ChainLink, nearest_decisions};
use crate::external::protocol::{UNNAMED, completed};
use crate::separation_state::{ReportedState, StateComparison};
use rockproof_model::{Block, Contact, Precision, ToleranceSet};
use rockproof_oracle::{Pair, PreparedBlock};
use std::cell::{OnceCell, RefCell};
use std::rc::Rc;

/// What an engine said.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// Its contacts, sorted.
    Contacts(Vec<Contact>),
    /// How the blocks lie.
    State(ReportedState),
    /// No answer, or one that made no sense.
    Nothing(AnswerChange),
}

/// A question as the engine got it, with its answer.
#[derive(Clone, Debug)]
pub struct Question {
    /// The blocks, rounded to the engine's precision.
    pub blocks: [Block; 2],
    /// The tolerances, rounded likewise.
    pub tolerances: ToleranceSet,
    /// The engine's precision.
    pub precision: Precision,
    /// How far a gap it states may be off ([`Engine::accuracy`]).
    pub accuracy: u64,
    /// What it said.
    pub reply: Reply,
    /// What people call the question: its case file, or its pair and set.
    pub label: String,
}

impl Question {
    /// Whether the engine is right; `None` where nothing exact stands against its answer.
    pub fn is_right(&self) -> Option<bool> {
        let prepared = PreparedBlocks::of(&self.blocks);
        PreparedQuestion::new(self, &prepared).is_right()
    }

    /// How much the engine says, but for the `gap_m` of contacts.
    pub(super) fn detail(&self) -> AnswerDetail {
        match &self.reply {
            Reply::Contacts(said) => {
                let entrances = said.iter().filter(|contact| contact.entrance != UNNAMED).count() as u64;
                AnswerDetail { contacts: said.len() as u64, entrances, contact_answers: 1, ..AnswerDetail::default() }
            }
            Reply::State(said) => AnswerDetail::of_state(said),
            Reply::Nothing(_) => AnswerDetail::default(),
        }
    }

    /// Whether the blocks have contacts.
    pub fn has_contacts(&self) -> bool {
        let prepared = PreparedBlocks::of(&self.blocks);
        !PreparedQuestion::new(self, &prepared).exact().is_empty()
    }
}

/// Asks an engine.
pub fn ask(engine: &dyn Engine, [a, b]: &[Block; 2], tolerances: &ToleranceSet) -> Reply {
    match catch_panic(|| engine.prepare(a, b)?.answer(tolerances)) {
        Ok(Answer::Contacts(contacts)) => Reply::Contacts(contacts),
        Ok(Answer::State(state)) => Reply::State(state),
        Err(failure) => Reply::Nothing(failure.change()),
    }
}

/// The blocks of a question inside the oracle.
pub(super) struct PreparedBlocks([PreparedBlock; 2]);

impl PreparedBlocks {
    pub(super) fn of(blocks: &[Block; 2]) -> PreparedBlocks {
        PreparedBlocks([PreparedBlock::new(&blocks[0]), PreparedBlock::new(&blocks[1])])
    }

    pub(super) fn pair(&self) -> Pair<'_> {
        Pair::new(&self.0[0], &self.0[1])
    }
}

/// A question with the pair inside the oracle, which keeps what it answered.
pub(super) struct PreparedQuestion<'q> {
    pub(super) question: &'q Question,
    pub(super) pair: Pair<'q>,
    known: RefCell<Vec<(ToleranceSet, Rc<Vec<Contact>>)>>,
    separation: OnceCell<Option<Separation>>,
}

impl<'q> PreparedQuestion<'q> {
    pub(super) fn new(question: &'q Question, prepared: &'q PreparedBlocks) -> PreparedQuestion<'q> {
        PreparedQuestion { question, pair: prepared.pair(), known: RefCell::default(), separation: OnceCell::new() }
    }

    /// The exact contacts under a tolerance set.
    pub(super) fn contacts(&self, tolerances: &ToleranceSet) -> Rc<Vec<Contact>> {
        if let Some((_, contacts)) = self.known.borrow().iter().find(|(known, _)| known == tolerances) {
            return Rc::clone(contacts);
        }
        let contacts = Rc::new(self.pair.classify(tolerances).contacts);
        self.known.borrow_mut().push((tolerances.clone(), Rc::clone(&contacts)));
        contacts
    }

    /// The exact contacts.
    pub(super) fn exact(&self) -> Rc<Vec<Contact>> {
        self.contacts(&self.question.tolerances)
    }

    /// What is wrong with a state, said of the blocks of the question by an engine of some accuracy ([`CollisionQuery::compare`]).
    pub(super) fn compare_state(
        &self,
        said: ReportedState,
        accuracy: u64,
    ) -> Option<(Option<AnswerChange>, StateComparison)> {
        let Question { ref blocks, precision, .. } = *self.question;
        let [a, b] = blocks;
        let exact = self.separation.get_or_init(|| Separation::of(a, b)).as_ref()?;
        Some(CollisionQuery { blocks, precision, accuracy }.compare_with(exact, said))
    }

    /// The gap of a state as the engine said it and as it is.
    pub(super) fn gap(&self) -> Option<[f64; 2]> {
        let Reply::State(said) = self.question.reply else { return None };
        let (_, comparison) = self.compare_state(said, self.question.accuracy)?;
        Some([said.gap_m?, comparison.exact_gap_m])
    }

    /// Whether a state is right for the blocks of the question; `None` where nothing exact stands against it.
    pub(super) fn state_is_right(&self, said: ReportedState) -> Option<bool> {
        let (wrong, _) = self.compare_state(said, self.question.accuracy)?;
        Some(wrong.is_none())
    }

    /// The same for other blocks.
    pub(super) fn state_is_right_for(&self, blocks: &[Block; 2], said: ReportedState) -> Option<bool> {
        let (wrong, _) = self.compare_state_of(blocks, self.question.precision, said)?;
        Some(wrong.is_none())
    }

    /// What is wrong with a state, said of other blocks by an engine of another precision.
    pub(super) fn compare_state_of(
        &self,
        blocks: &[Block; 2],
        precision: Precision,
        said: ReportedState,
    ) -> Option<(Option<AnswerChange>, StateComparison)> {
        CollisionQuery { blocks, precision, accuracy: self.question.accuracy }.compare(said)
    }

    /// Whether the engine is right; `None` where nothing exact stands against its answer.
    pub(super) fn is_right(&self) -> Option<bool> {
        match &self.question.reply {
            Reply::Contacts(_) => Some(self.has_contacts(&self.exact())),
            Reply::State(said) => self.state_is_right(*said),
            Reply::Nothing(_) => Some(false),
        }
    }

    /// Whether the engine said just these contacts.
    pub(super) fn has_contacts(&self, contacts: &[Contact]) -> bool {
        match &self.question.reply {
            Reply::Contacts(said) => completed(said.clone(), contacts) == contacts,
            Reply::State(_) | Reply::Nothing(_) => false,
        }
    }

    pub(super) fn features(&self) -> Features<'_> {
        let [a, b] = &self.question.blocks;
        Features { a: a.topology(), b: b.topology() }
    }

    /// How far from a tie the engine's answer differs from the exact one, in its roundoffs: of all differences the furthest, each by the decision
    /// nearest to a tie around it. Infinite where no decision is known, 0 where nothing differs.
    pub(super) fn roundoffs_from_tie(&self) -> f64 {
        match &self.question.reply {
            Reply::Contacts(said) => self.roundoffs_between(&self.exact(), said, &self.question.tolerances),
            Reply::State(said) => {
                let compared = self.compare_state(*said, self.question.accuracy);
                compared.map_or(f64::INFINITY, |(_, comparison)| comparison.margin_ulps.abs())
            }
            Reply::Nothing(_) => f64::INFINITY,
        }
    }

    /// The same for contacts that are exact under some tolerances.
    pub(super) fn roundoffs_between(&self, exact: &[Contact], said: &[Contact], tolerances: &ToleranceSet) -> f64 {
        let features = self.features();
        let changed = differences(exact, &completed(said.to_vec(), exact), features);
        let link = ChainLink {
            before: &|| Some(std::rc::Rc::new(ExactPair::indexed_trace(&self.pair, tolerances))),
            after: &|| None,
            margins: &|decisions| ExactPair::margins(&self.pair, tolerances, decisions),
            roundoff: Some(self.question.precision.epsilon() / 2.0),
        };
        let from = |deciding: Option<crate::finding::DecidingDecision>| {
            deciding.and_then(|deciding| deciding.margin_ulps).map_or(f64::INFINITY, f64::abs)
        };
        nearest_decisions(&changed, &link, features).into_iter().map(from).fold(0.0, f64::max)
    }
}
