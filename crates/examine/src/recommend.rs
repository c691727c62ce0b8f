//! Which set is recommended: of those that a search prefers the first under which the whole examination finds the model to be better.

use crate::assess::Assessment;
use crate::error::ExamineError;
use rockproof_model::{Precision, ToleranceSet};
use rockproof_report::table::grouped;
use rockproof_tune::{EvaluatedCandidate, Measurement, Search};

/// Sets of a search that are examined, the best first, until one does better: each takes as long as the set given.
const MOST_EXAMINED: usize = 3;

/// What the search for another set came to.
#[derive(Clone, Debug)]
pub enum Recommendation {
    /// There was none, and why.
    Skipped(String),
    /// No other set is better than the one given.
    Given {
        /// Sets that were tried.
        candidates: usize,
        /// Sets that the search prefers, and under which the examination found the model to be no better.
        refused: usize,
    },
    /// Another set.
    Other(Box<OtherSet>),
}

/// A set that the search prefers.
#[derive(Clone, Debug)]
pub struct OtherSet {
    /// Sets that were tried.
    pub candidates: usize,
    /// Sets that the search prefers to this one, and under which the examination found the model to be no better than under the set given.
    pub refused: usize,
    /// How it came about.
    pub origin: &'static str,
    /// How the model does with it.
    pub assessed: Assessment,
    /// What the search measured of it, and of the set given.
    pub measured: [Measurement; 2],
    /// What the search says.
    pub text: String,
}

/// The first of the sets that a search prefers to the one given, its best first, under which `assess` finds the model to be better; `None` where that was
/// stopped. `text` is what the search says.
pub(crate) fn better(
    search: &Search<'_>,
    given: &Assessment,
    precision: Precision,
    text: impl FnOnce() -> String,
    mut assess: impl FnMut(&ToleranceSet) -> Result<Option<Assessment>, ExamineError>,
) -> Result<Option<Recommendation>, ExamineError> {
    let tried = search.tried();
    let (candidates, author) = (tried.len(), &tried[0]);
    let mut order: Vec<usize> = search.best().into_iter().collect();
    order.extend(search.front().into_iter().filter(|&k| search.best() != Some(k)));
    let preferred: Vec<&EvaluatedCandidate> = order
        .into_iter()
        .map(|k| &tried[k])
        // A search that prefers the set given prefers none of those behind it.
        .take_while(|one| one.set != given.set)
        .filter(|one| one.measurement.is_better_than(&author.measurement))
        .take(MOST_EXAMINED)
        .collect();
    for (refused, one) in preferred.iter().enumerate() {
        let Some(assessed) = assess(&one.set)? else { return Ok(None) };
        let measured = [one.measurement.clone(), author.measurement.clone()];
        let (origin, said) = (one.origin.name(), String::new());
        let mut other = OtherSet { candidates, refused, origin, assessed, measured, text: said };
        if other.is_better_than(given, precision) {
            let remark = "tolerances.toml is not the set that the search calls the best: with that one the model itself does no better.";
            other.text = if refused == 0 { text() } else { format!("{remark}\n\n{}", text()) };
            return Ok(Some(Recommendation::Other(Box::new(other))));
        }
    }
    Ok(Some(Recommendation::Given { candidates, refused: preferred.len() }))
}

impl OtherSet {
    /// Whether the model does better with it: it is safe where it was not, or less is wrong. That the nearest rule is met by more, or that blocks sink less,
    /// is no reason to leave a set.
    fn is_better_than(&self, given: &Assessment, precision: Precision) -> bool {
        let [ours, theirs] = [&self.assessed, given].map(|assessed| assessed.harm(precision));
        match (self.assessed.is_safe(precision), given.is_safe(precision)) {
            (true, true) => self.counts(given, precision).into_iter().any(|(_, ours, theirs)| ours < theirs),
            (true, false) => true,
            (false, _) => ours != theirs && ours.iter().zip(&theirs).all(|(ours, theirs)| ours <= theirs),
        }
    }

    /// What goes wrong with it and with the set given, by its name in the plural.
    fn counts(&self, given: &Assessment, precision: Precision) -> [(&'static str, u64, u64); 6] {
        let [ours, theirs] = &self.measured;
        let [harm, their_harm] = [&self.assessed, given].map(|assessed| assessed.harm(precision));
        let [_, _, broken, passing, not_made] = harm;
        let [_, _, their_broken, their_passing, their_not_made] = their_harm;
        [
            ("rules violated", ours.violated.len() as u64, theirs.violated.len() as u64),
            ("overlaps not held", ours.lost_pairs, theirs.lost_pairs),
            ("pairs broken", broken, their_broken),
            ("pairs through one another", passing, their_passing),
            ("steps that cannot be made", not_made, their_not_made),
            ("pairs that differ, moved ones among them,", ours.differences.avoidable(), theirs.differences.avoidable()),
        ]
    }

    /// In what it differs from the set given, each in a few words.
    pub(crate) fn figures(&self, given: &Assessment, precision: Precision) -> Vec<String> {
        let [ours, theirs] = &self.measured;
        let counts = self.counts(given, precision).into_iter().filter(|(_, ours, theirs)| ours != theirs);
        let mut figures: Vec<String> = counts
            .map(|(what, ours, theirs)| format!("{} {what} instead of {}", grouped(ours), grouped(theirs)))
            .collect();
        // As they are shown: nobody learns from a number that it is instead of the same number.
        let [sunk, theirs_sunk] =
            [ours, theirs].map(|measured| format!("{:.2e} m", measured.steps_measured.overlaps.sunk));
        if sunk != theirs_sunk {
            figures.push(format!("blocks sink {sunk} instead of {theirs_sunk}"));
        }
        let [slack, theirs_slack] = [ours, theirs].map(|measured| format!("{:.2}", measured.tightest.factor));
        if slack != theirs_slack {
            figures.push(format!("the nearest rule met {slack} times instead of {theirs_slack}"));
        }
        figures
    }
}
