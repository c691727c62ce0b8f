//! What external engines are found to get wrong, and how much of it rounding may explain.

use super::load::CampaignRun;
use super::table::{counted, grouped};
use super::verdict::{MIN_PAIRS, Severity, VerdictLine, few_pairs};
use rockproof_differential::agreement::AgreementCounts;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::engine::EngineCounts;
use rockproof_differential::finding::{Cause, FAR_FROM_TIE};
use rockproof_differential::row::FindingRow;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// The findings of one external engine, counted by what they say about it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EngineFindings {
    /// All of them.
    pub findings: u64,
    /// Wrong contacts or states more than [`FAR_FROM_TIE`] roundoffs from every tie around them, and contacts with a block far away.
    pub far: u64,
    /// Other answers once all lengths were multiplied by a power of two.
    pub scaled: u64,
    /// Gaps and normals off by more than the accuracy that the engine states.
    pub inaccurate: u64,
    /// No answer, or another one when asked again.
    pub unanswered: u64,
    /// Pairs that the engine says it cannot do.
    pub unsupported: u64,
}

impl EngineFindings {
    pub(super) fn add(&mut self, row: &FindingRow) {
        self.findings += 1;
        match row.change {
            change if change.is_unusable() => self.unanswered += 1,
            AnswerChange::Unsupported => self.unsupported += 1,
            AnswerChange::Gap | AnswerChange::Normal => self.inaccurate += 1,
            AnswerChange::FarBlock => self.far += 1,
            AnswerChange::Scale => self.scaled += 1,
            _ if row.margin_ulps.is_some_and(|ulps| ulps.abs() > FAR_FROM_TIE) => self.far += 1,
            _ => {}
        }
    }

    /// What they come to, in one line for the engine `name`, whose answers were compared so often, on so many pairs.
    fn line(&self, name: &str, compared: u64, pairs: u64) -> VerdictLine {
        if self.findings == 0 {
            let (severity, text) = match compared {
                0 if pairs == 0 => (
                    Severity::Fair,
                    format!("{name}: no pair has been examined to its end, so nothing is known of it."),
                ),
                0 => (Severity::Fair, format!("{name}: none of its answers could be compared.")),
                n if pairs < MIN_PAIRS => {
                    let none = format!("{name}: no finding of its own, {}.", counted(n, "comparison", "comparisons"));
                    (Severity::Fair, format!("{none} {}", few_pairs()))
                }
                n => (Severity::Good, format!("{name}: no finding of its own, {} comparisons.", grouped(n))),
            };
            return VerdictLine { severity, text };
        }
        let wrong = [
            (self.far, format!("beyond {} roundoffs from any tie", grouped(FAR_FROM_TIE as u64))),
            (self.scaled, "where only the unit of length changed".to_owned()),
            (self.inaccurate, "with a gap or normal off by more than the accuracy it states".to_owned()),
            (self.unanswered, "without a usable answer".to_owned()),
        ];
        let wrong: Vec<String> =
            wrong.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{} {what}", grouped(n))).collect();
        let start = match self.findings {
            1 => format!("{name}: 1 finding of its own"),
            n => format!("{name}: {} findings of its own", grouped(n)),
        };
        let unable = match self.unsupported {
            0 => String::new(),
            n => format!("; {} are pairs that it does not support", grouped(n)),
        };
        if wrong.is_empty() {
            let rest =
                if self.unsupported == self.findings { "" } else { ", none where rounding cannot be the reason" };
            return VerdictLine { severity: Severity::Fair, text: format!("{start}{rest}{unable}.") };
        }
        VerdictLine {
            severity: Severity::Bad,
            text: format!("{start}, {}: almost surely mistakes{unable}.", wrong.join(", ")),
        }
    }
}

/// The external engines of a campaign: those it was configured with, and any that has findings as one.
pub(super) fn external(campaign: &CampaignRun) -> BTreeSet<String> {
    let configured = campaign.run.configuration.get("external").and_then(Value::as_array);
    let names = configured.into_iter().flatten().filter_map(|spec| spec.get("name")?.as_str());
    names.map(str::to_owned).chain(campaign.tally.own.keys().cloned()).collect()
}

/// A line for each external engine, the worst first.
pub(super) fn lines(campaigns: &[CampaignRun]) -> Vec<VerdictLine> {
    let mut found: Vec<(EngineFindings, VerdictLine)> = Vec::new();
    let mut changed = Vec::new();
    for campaign in campaigns {
        for engine in external(campaign) {
            let own = campaign.tally.own.get(&engine).copied().unwrap_or_default();
            let sums = campaign.of_engine(&engine);
            let counts = campaign.run.external_engines.get(&engine);
            let name = if campaigns.len() > 1 { format!("{engine} ({})", campaign.name) } else { engine };
            if let Some(note) = counts.and_then(EngineCounts::changed_note) {
                changed.push(VerdictLine { severity: Severity::Bad, text: format!("{name}: {note}.") });
            }
            let mut line = own.line(&name, sums.pairs - sums.silent, campaign.run.pairs);
            line.text += &unmendable_note(&own, &sums);
            let detail = counts.map(|counts| counts.detail).unwrap_or_default();
            if let Some(note) = detail.incomplete_note() {
                line.text += &format!(" Its answers have {note}: what is not given is not compared.");
                if line.severity == Severity::Good {
                    line.severity = Severity::Fair;
                }
            }
            if detail.gap_m > 0 {
                line.text += " Of the gap_m of its contacts the sign alone is compared.";
            }
            found.push((own, line));
        }
    }
    let place = |severity| [Severity::Bad, Severity::Fair, Severity::Good].iter().position(|known| *known == severity);
    found.sort_by_key(|(own, line)| {
        (place(line.severity), std::cmp::Reverse(own.far + own.scaled + own.inaccurate + own.unanswered))
    });
    found.into_iter().map(|(_, line)| line).chain(changed).collect()
}

/// Why an engine without a finding of its own is not always exactly right.
fn unmendable_note(own: &EngineFindings, sums: &AgreementCounts) -> String {
    let differ = sums.pairs - sums.silent - sums.agreeing;
    if own.findings > 0 || differ == 0 {
        return String::new();
    }
    let these = counted(differ, "comparison", "comparisons");
    format!(
        " What it differs from the exact answer in ({these}) is due to the rounding of the input, which no engine can mend."
    )
}

/// Counts of findings by external engine.
pub type AllEngineFindings = BTreeMap<String, EngineFindings>;

/// Adds a row of `findings.csv` to the engine it is about, if that is an external one.
pub(super) fn count(owns: &mut AllEngineFindings, row: &FindingRow) {
    if row.cause == Cause::Engine {
        owns.entry(row.engine.to_string()).or_default().add(row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_differential::finding::FindingScope;

    fn own(changes: &[(AnswerChange, Option<f64>)]) -> EngineFindings {
        let mut own = EngineFindings::default();
        for (change, margin_ulps) in changes {
            own.add(&FindingRow {
                index: 0,
                family: "sliver".into(),
                form: "base".into(),
                tolerances: "auto".into(),
                engine: FindingScope::from_name("mine"),
                cause: Cause::Engine,
                change: *change,
                kind_before: String::new(),
                kind_after: String::new(),
                predicate: String::new(),
                features: String::new(),
                margin: None,
                margin_ulps: *margin_ulps,
                case: String::new(),
            });
        }
        own
    }

    #[test]
    fn what_no_engine_can_mend_is_told_where_nothing_else_is() {
        let sums = |agreeing| AgreementCounts { pairs: 10, silent: 1, agreeing, ..AgreementCounts::default() };
        assert_eq!(unmendable_note(&own(&[]), &sums(9)), "");
        assert_eq!(unmendable_note(&own(&[(AnswerChange::Missing, None)]), &sums(7)), "");
        let note = unmendable_note(&own(&[]), &sums(7));
        assert!(note.contains("(2 comparisons) is due to the rounding of the input"), "{note}");
    }

    #[test]
    fn what_rounding_cannot_explain_is_bad_and_never_good() {
        let near =
            own(&[(AnswerChange::Missing, Some(-3.0)), (AnswerChange::State, Some(0.4)), (AnswerChange::Swap, None)])
                .line("mine", 9, 300);
        assert_eq!(near.severity, Severity::Fair, "{near:?}");
        for (change, ulps) in [
            (AnswerChange::Missing, Some(-1e4)),
            (AnswerChange::State, Some(2e3)),
            (AnswerChange::Gap, Some(0.0)),
            (AnswerChange::Crash, None),
            (AnswerChange::Unstable, None),
            (AnswerChange::FarBlock, None),
            (AnswerChange::Scale, None),
            (AnswerChange::Scale, Some(0.1)),
        ] {
            let line = own(&[(AnswerChange::Missing, Some(0.1)), (change, ulps)]).line("mine", 9, 300);
            assert_eq!(line.severity, Severity::Bad, "{change}: {line:?}");
            assert!(line.text.starts_with("mine: 2 findings of its own, 1 "), "{line:?}");
        }
        assert_eq!(own(&[(AnswerChange::Unsupported, None)]).line("mine", 0, 300).severity, Severity::Fair);
        assert_eq!(own(&[]).line("mine", 0, 300).severity, Severity::Fair);
        let interrupted = own(&[]).line("mine", 0, 0);
        assert!(interrupted.severity == Severity::Fair && !interrupted.text.contains("compared"), "{interrupted:?}");
        assert_eq!(own(&[]).line("mine", 7, 300).severity, Severity::Good);
        let few = own(&[]).line("mine", 7, 299);
        assert!(few.severity == Severity::Fair && few.text.contains("So few pairs tell little"), "{few:?}");
    }
}
