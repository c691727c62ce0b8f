//! Which set is recommended: of those that a search prefers the first under which the whole examination finds the model to be better.

use crate::assess::Assessment;
use crate::error::ExamineError;
use rockproof_model::{Precision, ToleranceSet};
use rockproof_report::table::grouped;
use rockproof_tune::{EvaluatedCandidate, Measurement, Search};

/// Sets of a search that are examined, the best first, until one does better: each takes as long as the set given.
const MAX_EXAMINED: usize = 3;

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
    Other(Box<PreferredSet>),
}

/// A set that the search prefers.
#[derive(Clone, Debug)]
pub struct PreferredSet {
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
        .take(MAX_EXAMINED)
        .collect();
    for (refused, one) in preferred.iter().enumerate() {
        let Some(assessed) = assess(&one.set)? else { return Ok(None) };
        let measured = [one.measurement.clone(), author.measurement.clone()];
        let (origin, said) = (one.origin.name(), String::new());
        let mut other = PreferredSet { candidates, refused, origin, assessed, measured, text: said };
        if other.is_better_than(given, precision) {
            let remark = "tolerances.toml is not the set that the search calls the best: with that one the whole model does no better.";
            other.text = if refused == 0 { text() } else { format!("{remark}\n\n{}", text()) };
            return Ok(Some(Recommendation::Other(Box::new(other))));
        }
    }
    Ok(Some(Recommendation::Given { candidates, refused: preferred.len() }))
}

impl PreferredSet {
    /// Whether the model does better with it: it is safe where it was not, or less of something is wrong and more of nothing. That the nearest rule is met by
    /// more, or that blocks sink less, is no reason to leave a set.
    fn is_better_than(&self, given: &Assessment, precision: Precision) -> bool {
        // Nothing is wrong with contacts that there are none of.
        if given.tries_contacts() && !self.assessed.tries_contacts() {
            return false;
        }
        let [ours, theirs] = [&self.assessed, given].map(|assessed| assessed.fault_counts(precision));
        match (self.assessed.is_safe(precision), given.is_safe(precision)) {
            (true, true) => is_less(self.counts(given, precision).map(|(_, ours, theirs)| [ours, theirs])),
            (true, false) => true,
            (false, _) => is_less(ours.into_iter().zip(theirs).map(<[u64; 2]>::from)),
        }
    }

    /// What goes wrong with it and with the set given, by its name in the plural.
    fn counts(&self, given: &Assessment, precision: Precision) -> [(&'static str, u64, u64); 6] {
        let [ours, theirs] = &self.measured;
        let [[_, _, broken, passing, not_made], [_, _, their_broken, their_passing, their_not_made]] =
            [&self.assessed, given].map(|assessed| assessed.fault_counts(precision));
        [
            ("rules violated", ours.violated.len() as u64, theirs.violated.len() as u64),
            ("overlaps not held", ours.lost_pairs, theirs.lost_pairs),
            ("pairs broken", broken, their_broken),
            ("pairs through one another or not held after steps", passing, their_passing),
            ("steps that cannot be made", not_made, their_not_made),
            ("differing pairs (with moved copies)", ours.differences.avoidable(), theirs.differences.avoidable()),
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
            figures.push(format!("blocks sink {sunk} instead of {theirs_sunk} in the steps of the search"));
        }
        let [slack, theirs_slack] = [ours, theirs].map(|measured| format!("{:.2}", measured.tightest.factor));
        if slack != theirs_slack {
            figures.push(format!("the tightest rule met by a factor of {slack} instead of {theirs_slack}"));
        }
        figures
    }
}

/// Whether of pairs of counts no first one is the greater, and one is the smaller.
fn is_less(counts: impl IntoIterator<Item = [u64; 2]>) -> bool {
    let order: Vec<_> = counts.into_iter().map(|[ours, theirs]| ours.cmp(&theirs)).collect();
    order.iter().all(|order| order.is_le()) && order.iter().any(|order| order.is_lt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CheckedModel, Settings, WorkProgress, examine};
    use rockproof_model::Scene;
    use rockproof_model::scene::SceneFormat;
    use rockproof_model::tolerance_rules::{Rule, RuleSlack, Violation};
    use rockproof_tune::{Differences, StepMeasures};
    use std::path::{Path, PathBuf};
    use std::sync::atomic::AtomicBool;

    /// How a cube does on a fixed floor, with its lowest face at this height.
    fn cube_at(height: &str) -> Assessment {
        let text = format!(
            "[[block]]\nfixed = true\nbox = {{ min = [-1, -1, -1], max = [2, 2, 0] }}\n\
             [[block]]\nbox = {{ min = [0, 0, {height}], max = [1, 1, 1] }}\n"
        );
        let scene = Scene::parse(&text, SceneFormat::Toml, Path::new("model.toml")).expect("a scene");
        let spec = scene.tolerances.clone().unwrap_or_default();
        let set = spec.derive(&scene.shapes(), Precision::F64).expect("a set");
        let model = CheckedModel::new((PathBuf::from("model.toml"), None), scene, (spec, set), Precision::F64)
            .expect("a model");
        let settings = Settings { steps: Some(1), candidates: 0, threads: 1 };
        let examined = examine(model, &settings, &WorkProgress::default(), &AtomicBool::new(false));
        examined.expect("an examination").expect("an end").given
    }

    /// What a search measured where so many rules are violated and so many of 100 moved pairs differ.
    fn measured(violated: usize, moved: u64, tightest: f64) -> Measurement {
        Measurement {
            violated: vec![Rule::Search; violated],
            tightest: RuleSlack { rule: Rule::Search, factor: tightest },
            lost_pairs: 0,
            differences: Differences { moved: [100, moved], ..Differences::default() },
            steps_measured: StepMeasures::default(),
            lockstep: None,
        }
    }

    /// Whether a set is better than another, each with what the examination and the search say of it.
    fn is_better(ours: (&Assessment, Measurement), theirs: (&Assessment, Measurement)) -> bool {
        let measured = [ours.1, theirs.1];
        let (assessed, text) = (ours.0.clone(), String::new());
        let set = PreferredSet { candidates: 2, refused: 0, origin: "auto", assessed, measured, text };
        set.is_better_than(theirs.0, Precision::F64)
    }

    #[test]
    fn a_safe_model_leaves_its_set_only_where_less_is_wrong_and_more_of_nothing() {
        let safe = &cube_at("0");
        assert!(safe.is_safe(Precision::F64));
        let given = || (safe, measured(1, 5, 2.0));
        assert!(is_better((safe, measured(1, 4, 2.0)), given()), "less differs");
        assert!(is_better((safe, measured(0, 4, 2.0)), given()), "less differs, fewer rules are violated");
        assert!(!is_better((safe, measured(1, 5, 8.0)), given()), "only the nearest rule is met by more");
        assert!(!is_better((safe, measured(2, 4, 8.0)), given()), "less differs, another rule is violated");
        assert!(!is_better((safe, measured(0, 6, 8.0)), given()), "fewer rules are violated, more differs");
    }

    #[test]
    fn what_is_not_safe_is_better_only_where_less_of_its_harm_remains() {
        let [safe, sunk] = ["0", "-0.5"].map(cube_at);
        assert!(!sunk.is_safe(Precision::F64));
        let measured = || measured(0, 0, 2.0);
        assert!(is_better((&safe, measured()), (&sunk, measured())), "safe");
        assert!(!is_better((&sunk, measured()), (&safe, measured())), "no longer safe");
        assert!(!is_better((&sunk, measured()), (&sunk, measured())), "the same faults");
        let violation = || {
            let remedy = String::new();
            vec![Violation { rule: Rule::Search, found: 1.0, allowed: 2.0, place: None, remedy }]
        };
        let violating = Assessment { violations: violation(), ..sunk.clone() };
        assert!(is_better((&sunk, measured()), (&violating, measured())), "a rule less");
        assert!(!is_better((&violating, measured()), (&sunk, measured())), "a rule more");
        // Harm of another sort is no less harm.
        let other = Assessment { violations: violation(), ..safe };
        assert!(!is_better((&other, measured()), (&sunk, measured())), "a rule instead of an overlap");
        assert!(!is_better((&sunk, measured()), (&other, measured())), "an overlap instead of a rule");
    }
}
