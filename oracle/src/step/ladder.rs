//! Asks each decision of the cheapest number type that proves it.

use super::attempt::Attempt;
use super::chain::Chain;
use super::state::Mode;
use crate::field::WideBall;
use crate::number::Ball;
use crate::solve::{Factor, Solvable};
use num_rational::BigRational;

/// Bits of the wide levels; fractions stand between the second and the third.
const WIDE_BITS: [u32; 4] = [128, 256, 512, 1024];
/// The largest system that is solved in fractions.
pub(crate) const EXACT_UNKNOWNS: usize = 48;

/// How many decisions of a step each level settled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepLevels {
    /// Balls of f64.
    pub float: u64,
    /// Balls of 128, 256, 512 and 1,024 bits.
    pub wide: [u64; 4],
    /// Fractions.
    pub exact: u64,
    /// None: the mode stayed, the limit counted as kept.
    pub undecided: u64,
}

/// One number type of the ladder, made when first asked.
enum Level<'a, S> {
    Unused,
    Ready(Box<Chain<'a, S>>),
    /// It failed, and will again.
    Failed,
}

impl<'a, S: Solvable> Level<'a, S> {
    /// The chain with all solves up to now, if this type can make them.
    fn caught_up(
        &mut self,
        attempt: &'a Attempt<'a>,
        bits: u32,
        history: &[Vec<Mode>],
        factors: &mut [Option<Option<Factor>>],
    ) -> Option<&mut Chain<'a, S>> {
        if matches!(self, Level::Unused) {
            *self = Chain::new(attempt, bits).map_or(Level::Failed, |chain| Level::Ready(Box::new(chain)));
        }
        let mut failed = false;
        if let Level::Ready(chain) = self {
            while chain.iterates.len() < history.len() && !failed {
                let next = chain.iterates.len();
                failed = chain.advance(&history[next], &mut factors[next]).is_none();
            }
        }
        if failed {
            *self = Level::Failed;
        }
        match self {
            Level::Ready(chain) => Some(chain),
            _ => None,
        }
    }
}

/// A question that any level can be asked.
pub(crate) trait Question {
    type Answer;
    fn ask<S: Solvable>(&self, chain: &Chain<'_, S>) -> Option<Self::Answer>;
}

/// The mode of a contact after the last solve.
pub(crate) struct NextMode {
    pub(crate) contact: usize,
    pub(crate) mode: Mode,
}

impl Question for NextMode {
    type Answer = Mode;
    fn ask<S: Solvable>(&self, chain: &Chain<'_, S>) -> Option<Mode> {
        chain.next_mode(self.contact, self.mode)
    }
}

/// Which block moves a vertex beyond u.
pub(crate) struct TooFar;

impl Question for TooFar {
    type Answer = Option<usize>;
    fn ask<S: Solvable>(&self, chain: &Chain<'_, S>) -> Option<Option<usize>> {
        chain.too_far()
    }
}

/// Which block turns beyond ω.
pub(crate) struct TooTurned;

impl Question for TooTurned {
    type Answer = Option<usize>;
    fn ask<S: Solvable>(&self, chain: &Chain<'_, S>) -> Option<Option<usize>> {
        chain.too_turned()
    }
}

/// All number types over one attempt.
pub(crate) struct Ladder<'a> {
    attempt: &'a Attempt<'a>,
    /// The modes of each solve so far.
    pub(crate) history: Vec<Vec<Mode>>,
    factors: Vec<Option<Option<Factor>>>,
    float: Level<'a, Ball>,
    wide: [Level<'a, WideBall>; 4],
    exact: Level<'a, BigRational>,
    pub(crate) levels: StepLevels,
}

impl<'a> Ladder<'a> {
    pub(crate) fn new(attempt: &'a Attempt<'a>, levels: StepLevels) -> Ladder<'a> {
        Ladder {
            attempt,
            history: Vec::new(),
            factors: Vec::new(),
            float: Level::Unused,
            wide: std::array::from_fn(|_| Level::Unused),
            exact: Level::Unused,
            levels,
        }
    }

    /// Adds a solve with these modes; each level makes it when it is asked.
    pub(crate) fn solve(&mut self, modes: Vec<Mode>) {
        self.history.push(modes);
        self.factors.push(None);
    }

    /// The answer of the cheapest level that has one; `None` is undecided, and counted.
    pub(crate) fn ask<Q: Question>(&mut self, question: &Q) -> Option<Q::Answer> {
        let chain = self.float.caught_up(self.attempt, 53, &self.history, &mut self.factors);
        if let Some(answer) = chain.and_then(|chain| question.ask(chain)) {
            self.levels.float += 1;
            return Some(answer);
        }
        for (k, bits) in WIDE_BITS.into_iter().enumerate() {
            if k == 2
                && let Some(answer) = self.exact().and_then(|chain| question.ask(chain))
            {
                self.levels.exact += 1;
                return Some(answer);
            }
            let chain = self.wide[k].caught_up(self.attempt, bits, &self.history, &mut self.factors);
            if let Some(answer) = chain.and_then(|chain| question.ask(chain)) {
                self.levels.wide[k] += 1;
                return Some(answer);
            }
        }
        self.levels.undecided += 1;
        None
    }

    /// The chain in fractions, where the forces are rational and the system is not too large.
    pub(crate) fn exact(&mut self) -> Option<&Chain<'a, BigRational>> {
        if self.attempt.sizes.iter().sum::<usize>() > EXACT_UNKNOWNS {
            return None;
        }
        self.exact.caught_up(self.attempt, 0, &self.history, &mut self.factors).map(|chain| &*chain)
    }

    /// A chain of its own with so many bits.
    pub(crate) fn with_bits(&mut self, bits: u32) -> Option<Chain<'a, WideBall>> {
        let mut level = Level::Unused;
        level.caught_up(self.attempt, bits, &self.history, &mut self.factors)?;
        match level {
            Level::Ready(chain) => Some(*chain),
            _ => None,
        }
    }
}
