//! One pair, one batch of pairs: what every path says, and who says otherwise than the fast one.

use super::disagreement::Disagreement;
use super::paths::{PathName, Paths, Question};
use super::tally::Tally;
use rockproof_differential::engine::{Levels, catch_panic};
use rockproof_model::{Contact, Precision};
use rockproof_pairs::batch::{PairCase, PairConfig, batch};

/// Which paths are asked beside the fast one and the stepper in 512 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OtherPaths {
    /// The stepper in 512 bits once more, where it says whether every comparison is settled without counting them.
    pub settled: bool,
    /// The plain path in pure Rust rationals: some tens of milliseconds a pair.
    pub plain: bool,
    /// The plain path in GMP's rationals, where there is one: some milliseconds a pair.
    pub gmp: bool,
}

/// A path that says otherwise than the fast one, or nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// Which.
    pub path: PathName,
    /// What it should say: the contacts of the fast path.
    pub expected: Vec<Contact>,
    /// What it says; none where it gives no contacts.
    pub found: Option<Vec<Contact>>,
    /// What else there is to say of its answer.
    pub note: Option<String>,
}

/// What came of one pair, or of several.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairResult {
    /// Counts.
    pub tally: Tally,
    /// Signs by level of the fast path.
    pub levels: [u64; Levels::NAMES.len()],
    /// Paths that deviate; none where all is well.
    pub deviations: Vec<Deviation>,
}

/// Asks a path; a panic in it is its answer, as text.
fn asked<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_panic(|| Ok(work())).map_err(|failure| failure.to_string())
}

/// Asks every path about one pair as it stands. A pair that the stepper calls collapsed is counted as such and not compared: it is no pair of blocks.
pub fn compare(paths: &dyn Paths, question: Question<'_>, others: OtherPaths) -> PairResult {
    let mut result = PairResult::default();
    let wide = match asked(|| paths.wide(question)) {
        Ok(Err(_)) => {
            result.tally.collapsed = 1;
            return result;
        }
        Ok(Ok(answer)) => Ok(answer),
        Err(panic) => Err(panic),
    };
    let (fast, no_answer) = match asked(|| paths.fast(question)) {
        Ok((contacts, levels)) => {
            result.levels = levels_of(levels.by_name());
            (contacts, None)
        }
        Err(panic) => (Vec::new(), Some(panic)),
    };
    result.tally.exact = 1;
    result.tally.with_contacts = u64::from(!fast.is_empty());
    let mut deviates = |path: PathName, found: Option<Vec<Contact>>, note: Option<String>| {
        result.deviations.push(Deviation { path, expected: fast.clone(), found, note });
    };
    let fast_answers = no_answer.is_none();
    if no_answer.is_some() {
        deviates(PathName::Fast, None, no_answer);
    }
    match &wide {
        Ok((contacts, unsettled)) => {
            result.tally.at_ties = u64::from(*unsettled > 0);
            if fast_answers && *contacts != fast {
                let ties = format!("{unsettled} comparisons at a tie");
                deviates(PathName::Wide, Some(contacts.clone()), Some(ties).filter(|_| *unsettled > 0));
            }
            let right = if fast_answers { &fast } else { contacts };
            if others.settled {
                match asked(|| paths.settled(question)) {
                    Ok(Ok(settled)) if settled.is_some() != (*unsettled == 0) => {
                        let says = if settled.is_some() { "all comparisons are" } else { "a comparison is not" };
                        let note = format!("says that {says} settled; by counting {unsettled} are not");
                        deviates(PathName::Settled, settled, Some(note));
                    }
                    Ok(Ok(Some(settled))) if settled != *right => deviates(PathName::Settled, Some(settled), None),
                    Ok(Ok(_)) => {}
                    Ok(Err(error)) => deviates(PathName::Settled, None, Some(error.to_string())),
                    Err(panic) => deviates(PathName::Settled, None, Some(panic)),
                }
            }
        }
        Err(panic) => deviates(PathName::Wide, None, Some(panic.clone())),
    }
    let mut held_against = |path: PathName, answer: Result<Vec<Contact>, String>| match answer {
        Ok(contacts) if !fast_answers || contacts == fast => {}
        Ok(contacts) => deviates(path, Some(contacts), None),
        Err(panic) => deviates(path, None, Some(panic)),
    };
    if others.plain {
        result.tally.plain = 1;
        held_against(PathName::Plain, asked(|| paths.plain(question)));
    }
    if others.gmp
        && let Some(answer) = asked(|| paths.gmp(question)).transpose()
    {
        result.tally.gmp = 1;
        held_against(PathName::Gmp, answer);
    }
    result.tally.disagreements = result.deviations.len() as u64;
    result
}

fn levels_of(by_name: [(&'static str, u64); Levels::NAMES.len()]) -> [u64; Levels::NAMES.len()] {
    Levels::NAMES.map(|name| by_name.iter().find(|(level, _)| *level == name).map_or(0, |(_, count)| *count))
}

/// What came of a batch of pairs, which are all of one family.
#[derive(Clone, Debug)]
pub struct BatchResult {
    /// The family.
    pub family: &'static str,
    /// Counts.
    pub tally: Tally,
    /// Signs by level of the fast path.
    pub levels: [u64; Levels::NAMES.len()],
    /// Paths that deviate, in the order of the pairs.
    pub disagreements: Vec<Disagreement>,
}

/// One pair in so many is compared as an engine in f32 sees it as well, where coordinates collide and faces bend.
const IN_F32_EVERY: u64 = 8;
/// The one of them, from 0.
const IN_F32: u64 = 3;

/// Compares the pairs of a batch, some of them also as an engine in f32 sees them.
pub fn compare_batch(
    paths: &dyn Paths,
    (seed, number): (u64, u64),
    config: &PairConfig,
    others: OtherPaths,
) -> BatchResult {
    let mut result =
        BatchResult { family: "", tally: Tally::default(), levels: Default::default(), disagreements: Vec::new() };
    for case in batch(seed, number, config) {
        result.family = case.family;
        let set = &case.sets[case.index as usize % case.sets.len()];
        let question = Question { a: &case.a, b: &case.b, tolerances: &set.f64 };
        let found = compare(paths, question, others);
        result.add(found, |deviation| Disagreement::of((seed, &case, &set.name), question, deviation));
        if case.index % IN_F32_EVERY == IN_F32 {
            result.in_f32(paths, (seed, &case), others);
        }
    }
    result
}

impl BatchResult {
    fn add(&mut self, found: PairResult, told: impl Fn(Deviation) -> Disagreement) {
        self.tally += found.tally;
        for (sum, count) in self.levels.iter_mut().zip(found.levels) {
            *sum += count;
        }
        self.disagreements.extend(found.deviations.into_iter().map(told));
    }

    fn in_f32(&mut self, paths: &dyn Paths, (seed, case): (u64, &PairCase), others: OtherPaths) {
        let near = Precision::F32;
        let set = &case.sets[case.index as usize % case.sets.len()];
        let (Some(a), Some(b), Ok(tolerances)) = (case.a.rounded(near), case.b.rounded(near), set.f32.rounded(near))
        else {
            self.tally.collapsed += 1;
            return;
        };
        let question = Question { a: &a, b: &b, tolerances: &tolerances };
        let mut found = compare(paths, question, others);
        (found.tally.exact, found.tally.in_f32) = (0, found.tally.exact);
        self.add(found, |deviation| Disagreement::of((seed, case, &set.name), question, deviation).in_f32());
    }
}
