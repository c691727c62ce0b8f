//! External engines that say more or less in their answers than in the run before: what they do not say is not compared.

use super::error::ReportError;
use super::load::{CampaignRun, read_json};
use super::verdict::{Severity, VerdictLine};
use rockproof_differential::answer_detail::{AnswerDetail, CountedPairs, DetailShift};
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// An external engine that says more or less: gives entrances for another share of its contacts, or gaps and normals for another share of its states.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DetailChange {
    /// The engine.
    pub engine: String,
    /// What it said before.
    pub before: AnswerDetail,
    /// The same after.
    pub after: AnswerDetail,
    /// Whether it says less.
    pub less: bool,
    /// Whether one of the runs, of an earlier version, does not tell how much it said, so that nobody knows whether it says less.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub unknown: bool,
    /// What it says of another share than before.
    #[serde(skip)]
    pub shifts: Vec<DetailShift>,
}

impl DetailChange {
    /// What is told of it.
    pub(super) fn verdict(&self) -> Vec<VerdictLine> {
        let DetailChange { engine, shifts, unknown, .. } = self;
        let shift = |DetailShift { what, before, after, less, .. }: &DetailShift| VerdictLine {
            severity: if *less { Severity::Bad } else { Severity::Fair },
            text: format!(
                "{engine} gave {what} for {before} before, for {after} after: what is not given is not compared."
            ),
        };
        let not_known = || VerdictLine {
            severity: Severity::Fair,
            text: format!(
                "Whether {engine} says less in its answers than before is not known: one of the runs, of an earlier version, does not tell how much it said."
            ),
        };
        shifts.iter().map(shift).chain(unknown.then(not_known)).collect()
    }
}

/// External engines of both runs that give entrances for another share of their contacts, or gaps or normals for another share of their states, or
/// of which one run does not tell; of other pairs a share may be another by chance.
pub(super) fn details(runs: [&CampaignRun; 2], same_pairs: bool) -> Result<Vec<DetailChange>, ReportError> {
    let pairs = if same_pairs { CountedPairs::Same } else { CountedPairs::Other };
    let counted = runs.map(|run| counted_answers(&run.dir));
    let [counted_before, counted_after] = counted;
    let (counted_before, counted_after) = (counted_before?, counted_after?);
    let mut details = Vec::new();
    for (engine, counts) in &runs[0].run.external_engines {
        let Some(others) = runs[1].run.external_engines.get(engine) else { continue };
        let (before, after) = (counts.detail, others.detail);
        let known = [&counted_before, &counted_after].map(|run| run.get(engine).copied().unwrap_or_default());
        let of_contacts = known.map(|known| known.contacts);
        let of_states = known.map(|known| known.states);
        let mut shifts = after.shifts(before, pairs);
        shifts.retain(|shift| if shift.is_of_contacts { of_contacts } else { of_states } == [true, true]);
        let is_said = |of: [bool; 2], counts: [u64; 2]| of.iter().zip(counts).any(|(known, said)| *known && said > 0);
        let unknown = (of_contacts.contains(&false) && is_said(of_contacts, [before, after].map(|of| of.contacts)))
            || (of_states.contains(&false) && is_said(of_states, [before, after].map(|of| of.states().answers)));
        if unknown || !shifts.is_empty() {
            let less = shifts.iter().any(|shift| shift.less);
            details.push(DetailChange { engine: engine.clone(), before, after, less, unknown, shifts });
        }
    }
    Ok(details)
}

/// What a run counts of how much an engine said.
#[derive(Clone, Copy, Default)]
struct CountedAnswers {
    contacts: bool,
    states: bool,
}

/// What the run in a directory counts of each external engine: those of earlier versions nothing, or contacts alone, which reads as 0.
fn counted_answers(dir: &Path) -> Result<BTreeMap<String, CountedAnswers>, ReportError> {
    let run: Map<String, Value> = read_json(&dir.join("run.json"))?;
    let engines = run.get("external_engines").and_then(Value::as_object).cloned().unwrap_or_default();
    let counted = |counts: &Value| {
        let has = |name: &str| counts.get("detail").is_some_and(|detail| detail.get(name).is_some());
        CountedAnswers { contacts: has("contacts"), states: has("overlapping") }
    };
    Ok(engines.iter().map(|(engine, counts)| (engine.clone(), counted(counts))).collect())
}
