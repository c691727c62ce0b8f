//! How much external engines say in their answers, beside what they said when the baseline was written.

use super::{KnownFindings, rowless};
use crate::config::Baseline;
use crate::{Check, CheckStatus};
use rockproof_differential::answer_detail::{AnswerDetail, CountedPairs, DetailShift};

impl KnownFindings {
    /// A failed check for each external engine that says less of its contacts, or of how blocks lie, than it did: what it does not say is not compared, so
    /// findings are missing that nobody mended. Of the same pairs a smaller share is less; of others, that something is given for none.
    pub(super) fn unsaid(
        &self,
        now: &KnownFindings,
        (run, pairs): (&str, CountedPairs),
        baseline: &Baseline,
    ) -> Vec<Check> {
        if !baseline.is_about_external_engines() {
            return Vec::new();
        }
        let both = self.said.iter().filter_map(|(engine, was)| Some((engine, *was, *now.said.get(engine)?)));
        let mut checks = Vec::new();
        for (engine, was, now) in both {
            let shifts = now.shifts(was, pairs);
            let subjects = [("of its contacts", true), ("of how blocks lie", false)];
            for (subject, is_of_contacts) in subjects {
                let less = shifts.iter().filter(|shift| shift.less && shift.is_of_contacts == is_of_contacts);
                let told = |DetailShift { what, before, after, .. }: &DetailShift| {
                    format!("{what} given for {after}, in the baseline for {before}")
                };
                let told: Vec<String> = less.map(told).collect();
                if !told.is_empty() {
                    let name = format!("{run}: engine {engine} says less {subject}");
                    checks.push(rowless(name, told.join("; "), CheckStatus::Fail, baseline));
                }
            }
        }
        checks
    }

    /// A skipped check for each external engine that leaves something unsaid where the file does not say how much it said: it may say less than it did.
    pub(super) fn not_known(&self, now: &KnownFindings, run: &str, baseline: &Baseline) -> Vec<Check> {
        if !baseline.is_about_external_engines() {
            return Vec::new();
        }
        let is_known = |engine: &String| self.said.get(engine).is_some_and(|was| was.counts_answers());
        let unknown = now.said.iter().filter(|(engine, _)| !is_known(engine));
        let told = |(engine, detail): (&String, &AnswerDetail)| {
            // An engine that named contacts may say in their place how blocks lie, and all of that.
            let named = self.said.get(engine).is_some_and(|was| was.contacts > 0);
            let states = detail.states().answers;
            let instead = || (named && states > 0).then(|| format!("how blocks lie said in {states} answers"));
            let message = format!(
                "{}; the baseline does not say for how many they were given, so whether it says less than it did is not known: \
                 --update-baseline adds that",
                detail.incomplete_note().or_else(instead)?
            );
            Some(rowless(format!("{run}: engine {engine} says no less"), message, CheckStatus::Skip, baseline))
        };
        unknown.filter_map(told).collect()
    }
}
