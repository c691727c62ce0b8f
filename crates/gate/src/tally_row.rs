//! One finding of a campaign as a gate counts it: what it is like, and which limits are about it.

use super::config::{Baseline, FindingLimit};
use super::known_findings::{SEPARATOR, STEP};
use rockproof_campaign::steps::StepFindingRow;
use rockproof_differential::builtin;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::finding::{Cause, FindingScope};
use rockproof_differential::lockstep::{Intrusion, StepCause};
use rockproof_differential::row::FindingRow;

/// One row of `findings.csv` or of `step_findings.csv`.
#[derive(Clone, Debug, PartialEq)]
pub enum TallyRow {
    /// About a pair.
    Pair(FindingRow),
    /// About a step.
    Step(StepFindingRow),
}

/// What both sorts of rows tell.
pub(super) struct CommonColumns<'r> {
    pub(super) index: u64,
    pub(super) family: &'r str,
    pub(super) form: &'r str,
    pub(super) tolerances: &'r str,
    pub(super) scope: &'r FindingScope,
    pub(super) cause: StepCause,
    pub(super) change: &'r str,
    /// Before the change and after it; of a step both are its contact's.
    pub(super) kinds: [&'r str; 2],
    pub(super) predicate: &'r str,
    pub(super) margin_ulps: Option<f64>,
}

impl TallyRow {
    pub(super) fn common(&self) -> CommonColumns<'_> {
        match self {
            TallyRow::Pair(row) => CommonColumns {
                index: row.index,
                family: &row.family,
                form: &row.form,
                tolerances: &row.tolerances,
                scope: &row.engine,
                cause: row.cause.into(),
                change: row.change.name(),
                kinds: [&row.kind_before, &row.kind_after],
                predicate: &row.predicate,
                margin_ulps: row.margin_ulps,
            },
            TallyRow::Step(row) => CommonColumns {
                index: row.index,
                family: &row.family,
                form: &row.form,
                tolerances: &row.tolerances,
                scope: &row.engine,
                cause: row.cause,
                change: &row.change,
                kinds: [&row.kind, &row.kind],
                predicate: &row.predicate,
                margin_ulps: row.margin_ulps,
            },
        }
    }

    /// Whether it is about a step.
    pub fn is_of_step(&self) -> bool {
        matches!(self, TallyRow::Step(_))
    }

    /// The number of the pair.
    pub fn index(&self) -> u64 {
        self.common().index
    }

    /// The family and the tolerance set.
    pub(crate) fn group(&self) -> (&str, &str) {
        let row = self.common();
        (row.family, row.tolerances)
    }

    /// Engine, cause, change, and the predicate: of an external engine no more than the tie nearest to the difference is known, so none.
    pub(crate) fn sort(&self) -> [String; 4] {
        let row = self.common();
        let predicate = if row.cause == StepCause::Link(Cause::Engine) { "" } else { row.predicate };
        [row.scope.to_string(), row.cause.to_string(), row.change.to_owned(), predicate.to_owned()]
    }

    /// What makes it like others, for a baseline; that of a step begins with [`STEP`].
    pub fn fingerprint(&self, baseline: &Baseline) -> String {
        let row = self.common();
        let value = |field: &String| match field.as_str() {
            "family" => row.family.to_owned(),
            "form" => row.form.to_owned(),
            "tolerances" => row.tolerances.to_owned(),
            "engine" => row.scope.to_string(),
            "cause" => row.cause.to_string(),
            "change" => row.change.to_owned(),
            "kind_before" => row.kinds[0].to_owned(),
            "kind_after" => row.kinds[1].to_owned(),
            // Of an engine from outside it is no more than the tie nearest to the difference.
            "predicate" if row.cause == StepCause::Link(Cause::Engine) => String::new(),
            "predicate" => row.predicate.to_owned(),
            _ => String::new(),
        };
        let step = self.is_of_step().then(|| STEP.to_owned());
        step.into_iter().chain(baseline.fields.iter().map(value)).collect::<Vec<_>>().join(SEPARATOR)
    }

    /// Whether rounding cannot be the reason, whatever the margin: an engine gave no usable answer, found a block to touch that is far away, or is an external one
    /// that answers otherwise in another unit of length. Of a built-in engine, which may come to numbers too small for f32 then, that has a margin that tells.
    fn is_never_rounding(&self) -> bool {
        let TallyRow::Pair(row) = self else { return false };
        let of_engine = matches!(row.engine, FindingScope::Engine(_));
        let has_margin = row.change == AnswerChange::Scale && row.cause != Cause::Engine;
        of_engine && row.change.is_never_rounding() && !has_margin
    }

    /// Whether it is a passage or an unseen overlap that a limit on these is about: one in the steps of the limit's engine, though others have it too.
    fn is_in_steps_of(&self, limit: &FindingLimit) -> bool {
        let precision = limit.engine.as_deref().and_then(builtin::engine).map(|engine| engine.precision());
        let shared = |precision| match self.common().scope {
            FindingScope::Any => true,
            FindingScope::Rounded(of) => *of == precision,
            FindingScope::Engine(_) => false,
        };
        let TallyRow::Step(row) = self else { return false };
        limit.is_of_intrusions()
            && Intrusion::ALL.iter().any(|kind| kind.name() == row.change)
            && precision.is_some_and(shared)
    }

    /// Whether a limit is about it.
    pub fn is_of(&self, limit: &FindingLimit) -> bool {
        let row = self.common();
        let same = |wanted: &Option<String>, found: &str| wanted.as_ref().is_none_or(|wanted| wanted == found);
        let beyond = |least: f64| row.margin_ulps.is_some_and(|ulps| ulps.abs() > least) || self.is_never_rounding();
        (same(&limit.engine, &row.scope.to_string()) || self.is_in_steps_of(limit))
            && limit.tolerances.as_ref().is_none_or(|set| of_set(row.tolerances, set))
            && same(&limit.family, row.family)
            && same(&limit.cause, row.cause.name())
            && same(&limit.change, row.change)
            && limit.kind.as_ref().is_none_or(|kind| row.kinds.contains(&kind.as_str()))
            && limit.beyond_ulps.is_none_or(beyond)
    }
}

/// Whether a set is the wanted one, or that one changed by a ladder.
pub(super) fn of_set(found: &str, wanted: &str) -> bool {
    found == wanted || found.split_once(':').is_some_and(|(base, _)| base == wanted)
}
