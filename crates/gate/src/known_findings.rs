//! The baseline: findings that are known, by what makes them alike, and how often they occurred.

mod evidence;
mod said;

use super::config::Baseline;
use super::tally::{CampaignTally, ClassCount};
use super::{CONFIDENCE, Check, CheckStatus};
use rockproof_differential::answer_detail::{AnswerDetail, CountedPairs, StateDetail};
use rockproof_model::text::noun;
use serde::Deserialize;
use statrs::function::beta::checked_beta_reg;
use std::collections::{BTreeMap, BTreeSet};

/// The file of known findings.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownFindings {
    /// The columns of `findings.csv` a line is made of.
    pub fields: Vec<String>,
    /// Pairs examined of each family when the file was written; a pair counts once for each tolerance set.
    #[serde(default)]
    pub examined: BTreeMap<String, u64>,
    /// The same of pairs that make steps; none in a file of a gate that made none.
    pub moved: Option<BTreeMap<String, u64>>,
    /// The settings of the campaign that it was written from, each with its value as JSON; none in a file of an earlier version.
    #[serde(default)]
    pub settings: BTreeMap<String, String>,
    /// How often each sort of finding occurred then, by its fingerprint.
    #[serde(default)]
    pub known: BTreeMap<String, ClassCount>,
    /// How much each external engine said in its answers then; none in files of earlier versions and of gates without such engines.
    #[serde(default)]
    pub said: BTreeMap<String, AnswerDetail>,
}

impl KnownFindings {
    /// The fingerprints in what a campaign found.
    pub fn of(tally: &CampaignTally, baseline: &Baseline, settings: BTreeMap<String, String>) -> KnownFindings {
        KnownFindings {
            fields: baseline.fields.clone(),
            examined: tally.examined_by_family(),
            moved: Some(tally.moved_by_family()).filter(|moved| !moved.is_empty()),
            settings,
            known: tally.by_class(baseline),
            said: tally.engines.iter().map(|row| (row.engine.clone(), row.detail())).collect(),
        }
    }

    /// In which settings a campaign differs from the one that the file was written from; nothing of those that the file does not have. A rotating campaign has a seed and a number of pairs of its own.
    pub fn other_settings(&self, run: &str, settings: &BTreeMap<String, String>) -> Vec<String> {
        let is_compared = |name: &str| run == "fixed" || !["seed", "pairs"].contains(&name);
        let none = "none".to_owned();
        let names: BTreeSet<&String> = self.settings.keys().chain(settings.keys()).collect();
        let differences = names.into_iter().filter(|name| is_compared(name)).filter_map(|name| {
            let [now, was] = [settings, &self.settings].map(|of| of.get(name).unwrap_or(&none));
            let is_same = now == was || (name == "external" && !was.contains(" (") && engine_names(now) == *was);
            (!is_same).then(|| format!("{name} is {now}, in the baseline {was}"))
        });
        if self.settings.is_empty() { Vec::new() } else { differences.collect() }
    }

    /// The file's text, a line for each sort of finding.
    pub fn to_toml(&self) -> String {
        let text = |text: &str| toml::Value::from(text).to_string();
        let fields: Vec<String> = self.fields.iter().map(|field| text(field)).collect();
        let mut file = format!(
            "# Known findings, written by `rockproof gate --update-baseline`.\nfields = [{}]\n\n[examined]\n",
            fields.join(", ")
        );
        for (family, pairs) in &self.examined {
            file += &format!("{} = {pairs}\n", key(family));
        }
        if let Some(moved) = &self.moved {
            file += "\n[moved]\n";
            for (family, pairs) in moved {
                file += &format!("{} = {pairs}\n", key(family));
            }
        }
        if !self.settings.is_empty() {
            file += "\n[settings]\n";
            for (name, value) in &self.settings {
                file += &format!("{} = {}\n", key(name), key(value));
            }
        }
        if !self.said.is_empty() {
            file += "\n[said]\n";
            for (engine, detail) in &self.said {
                let AnswerDetail { contacts, entrances, gap_m, contact_answers, .. } = detail;
                let mut counts = format!("contacts = {contacts}, entrances = {entrances}, gap_m = {gap_m}");
                if *contact_answers > 0 {
                    counts += &format!(", contact_answers = {contact_answers}");
                }
                for (state, StateDetail { answers, gaps, normals }) in detail.by_state() {
                    if answers > 0 {
                        counts += &format!(", {state} = {{ answers = {answers}, gaps = {gaps}, normals = {normals} }}");
                    }
                }
                file += &format!("{} = {{ {counts} }}\n", key(engine));
            }
        }
        file += "\n[known]\n";
        for (fingerprint, ClassCount { findings, pairs, squares }) in &self.known {
            let counts = format!("{{ findings = {findings}, pairs = {pairs}, squares = {squares} }}");
            file += &format!("{} = {counts}\n", key(fingerprint));
        }
        file
    }

    /// The checks of what a campaign found against what is known. In the fixed campaign each fingerprint that is new fails. In
    /// every campaign one fails whose rate is greater than the baseline's by more than chance explains. Where none does, there
    /// is one check that passes. Findings about steps are left out, and a skipped check says so, where the file was written by a gate that made none; another one says in which `settings`, or else in which numbers of pairs, the campaign differs from that of the file.
    pub fn check(
        &self,
        run: &str,
        tally: &CampaignTally,
        baseline: &Baseline,
        settings: &BTreeMap<String, String>,
    ) -> Vec<Check> {
        let mut now = KnownFindings::of(tally, baseline, BTreeMap::new());
        let sorts = now.known.len();
        if self.moved.is_none() {
            now.known.retain(|fingerprint, _| !is_of_step(fingerprint));
        }
        let left_out = sorts - now.known.len();
        // Many sorts are looked at: that any of them exceeds by chance shall be no likelier than one alone (Bonferroni).
        let sorts = now.known.len().max(1) as f64;
        let allowed = (1.0 - baseline.confidence.unwrap_or(CONFIDENCE)) / sorts;
        let mut checks = Vec::new();
        for (fingerprint, count) in &now.known {
            let was = self.known.get(fingerprint);
            if run == "fixed" && was.is_none() {
                let findings = noun(count.findings, "finding", "findings");
                let message = format!("{} {findings} that the baseline does not know", count.findings);
                checks.push(failed(format!("new: {fingerprint}"), message, tally, baseline, fingerprint));
                continue;
            }
            let examined = [self.examined_of(fingerprint), now.examined_of(fingerprint)];
            let growth = ClassGrowth { was: was.copied().unwrap_or_default(), now: *count, examined };
            if growth.chance() < allowed {
                let name = format!("{run}: more often: {fingerprint}");
                checks.push(failed(name, growth.describe(), tally, baseline, fingerprint));
            }
        }
        let mut others = self.other_settings(run, settings);
        if run == "fixed" && others.is_empty() {
            others.extend(self.other_pairs(&now));
        }
        let pairs = if run == "fixed" && others.is_empty() { CountedPairs::Same } else { CountedPairs::Other };
        checks.extend(self.unsaid(&now, (run, pairs), baseline));
        let has_failed = !checks.is_empty();
        if left_out > 0 {
            let message = format!("{left_out} sorts of finding about steps: the baseline was written without steps");
            checks.push(rowless(format!("{run}: baseline of steps"), message, CheckStatus::Skip, baseline));
        }
        checks.extend(self.not_known(&now, run, baseline));
        if !others.is_empty() {
            let message = format!(
                "{}; what is new or gone may come from that: --update-baseline writes the baseline anew",
                others.join("; ")
            );
            checks.push(rowless(format!("{run}: settings of the baseline"), message, CheckStatus::Skip, baseline));
        }
        if !has_failed {
            let gone = self.known.keys().filter(|fingerprint| !now.known.contains_key(*fingerprint)).count();
            let known = self.known.len();
            let message = match run {
                "fixed" => {
                    let advice = if gone > 0 {
                        "; --update-baseline takes those out, so that none comes back unseen"
                    } else {
                        ""
                    };
                    format!("{known} known sorts of finding, {gone} of them gone, none new, none more often{advice}")
                }
                _ => format!("{} sorts of finding, none more often than known", now.known.len()),
            };
            checks.push(rowless(format!("{run}: baseline"), message, CheckStatus::Pass, baseline));
        }
        checks
    }

    /// The pairs a fingerprint could have occurred in, of a step those that make some: those of its family where it names one, else all.
    fn examined_of(&self, fingerprint: &str) -> u64 {
        let of_step = is_of_step(fingerprint);
        let none = BTreeMap::new();
        let examined = if of_step { self.moved.as_ref().unwrap_or(&none) } else { &self.examined };
        let parts = self.fields.iter().zip(fingerprint.split(SEPARATOR).skip(usize::from(of_step)));
        match parts.into_iter().find(|(field, _)| *field == "family") {
            Some((_, family)) => examined.get(family).copied().unwrap_or(0),
            None => examined.values().sum(),
        }
    }
}

/// What stands between the parts of a fingerprint.
pub const SEPARATOR: &str = " | ";

/// What the fingerprint of a finding about a step begins with. No engine, family, cause or change has this name.
pub const STEP: &str = "step";

fn is_of_step(fingerprint: &str) -> bool {
    fingerprint.split(SEPARATOR).next() == Some(STEP)
}

/// The engines of a setting by their names alone, as earlier versions wrote them.
fn engine_names(engines: &str) -> String {
    let mut parts = engines.split(" (");
    let first = parts.next().unwrap_or_default().to_owned();
    first + &parts.filter_map(|part| Some(part.split_once(')')?.1)).collect::<String>()
}

/// A check that is about no rows.
fn rowless(name: String, message: String, status: CheckStatus, baseline: &Baseline) -> Check {
    let place = (baseline.file.display().to_string(), 1);
    Check { group: "baseline", name, message, status, place, rows: Vec::new(), seconds: 0.0, replay: None }
}

fn failed(name: String, message: String, tally: &CampaignTally, baseline: &Baseline, fingerprint: &str) -> Check {
    let of = |at: &usize| tally.rows[*at].fingerprint(baseline) == *fingerprint;
    let place = (baseline.file.display().to_string(), 1);
    let rows = (0..tally.rows.len()).filter(of).collect();
    Check { group: "baseline", name, message, status: CheckStatus::Fail, place, rows, seconds: 0.0, replay: None }
}

/// A sort of finding then and now.
#[derive(Clone, Copy, Debug)]
pub struct ClassGrowth {
    /// In the baseline.
    pub was: ClassCount,
    /// In this campaign.
    pub now: ClassCount,
    /// Pairs examined then and now.
    pub examined: [u64; 2],
}

impl ClassGrowth {
    /// How likely so many or more pairs of now are by chance where the share is what it was: of all pairs with such a finding, then
    /// and now, each falls to now with the probability now's share of the pairs examined, so their number is binomial (the
    /// conditional test of Przyborowski and Wilenski 1940 for two rates; for shares that are not small it errs to the
    /// side of chance, compared with Fisher's). The pairs of a batch share a base, so all counts are first
    /// divided by the design effect of both campaigns. **1 where nothing can be said**: nothing found, or none examined then.
    pub fn chance(&self) -> f64 {
        let [before, after] = self.examined.map(|n| n as f64);
        let pairs = self.was.pairs + self.now.pairs;
        if self.now.pairs == 0 || before == 0.0 || after == 0.0 {
            return 1.0;
        }
        let effect = (self.was.squares + self.now.squares) as f64 / pairs as f64;
        let [was, now] = [self.was.pairs, self.now.pairs].map(|n| n as f64 / effect.max(1.0));
        checked_beta_reg(now, was + 1.0, after / (before + after)).unwrap_or(1.0)
    }

    fn describe(&self) -> String {
        let share = |pairs: u64, of: u64| format!("{pairs} of {of} pairs ({:.3e})", pairs as f64 / of.max(1) as f64);
        let [before, after] = self.examined;
        format!(
            "{}, in the baseline {}; by chance with probability {:.2e}",
            share(self.now.pairs, after),
            share(self.was.pairs, before),
            self.chance()
        )
    }
}

/// A text as a key. What TOML would write as a value of several lines, or in three quotes, must not be one.
fn key(text: &str) -> String {
    let value = toml::Value::from(text).to_string();
    if !["\"\"\"", "'''"].iter().any(|quotes| value.starts_with(quotes)) {
        return value;
    }
    let table = toml::Table::from_iter([(text.to_owned(), toml::Value::Integer(0))]).to_string();
    table.trim_end().strip_suffix("= 0").map_or(value, |key| key.trim_end().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(pairs: u64, squares: u64) -> ClassCount {
        ClassCount { findings: pairs, pairs, squares }
    }

    fn chance(was: u64, now: u64, examined: [u64; 2]) -> f64 {
        ClassGrowth { was: count(was, was), now: count(now, now), examined }.chance()
    }

    #[test]
    fn chance_is_the_conditional_binomial_tail() {
        // Ten pairs in all, half of the pairs examined are now's: P(X ≥ 9) = 11/1024.
        assert!((chance(1, 9, [1000, 1000]) - 11.0 / 1024.0).abs() < 1e-12);
        // P(X ≥ 3), X binomial of 3 and 1/4.
        assert!((chance(0, 3, [3000, 1000]) - 1.0 / 64.0).abs() < 1e-12);
        assert!((chance(0, 1, [1000, 1000]) - 0.5).abs() < 1e-12, "one finding tells nothing");
        assert_eq!(chance(5, 0, [1000, 1000]), 1.0);
        assert_eq!(chance(0, 5, [0, 1000]), 1.0, "a family the baseline did not examine");
    }

    #[test]
    fn equal_rates_are_chance_and_clustered_pairs_tell_less() {
        assert!(chance(100, 50, [2000, 1000]) > 0.4);
        let growth =
            |squares| ClassGrowth { was: count(10, squares), now: count(40, 4 * squares), examined: [1000, 1000] };
        assert!(growth(10).chance() < 1e-4);
        assert!(growth(160).chance() > growth(10).chance() && growth(160).chance() > 0.1);
    }

    #[test]
    fn any_text_reads_back_as_a_key() {
        for text in [
            "",
            "plain",
            "a b",
            "a \"b\"",
            "it's \"b\"",
            "two\nlines",
            "\"\"\"",
            "'''\n\"\"\"",
            "\t\r\u{0}\u{7f}\u{1b}é\\",
        ] {
            let known = KnownFindings { known: [(text.to_owned(), count(1, 1))].into(), ..KnownFindings::default() };
            assert_eq!(toml::from_str::<KnownFindings>(&known.to_toml()).ok(), Some(known), "{text:?}");
        }
    }

    #[test]
    fn settings_that_differ_are_told() {
        let of = |all: &[[&str; 2]]| all.iter().map(|pair| (pair[0].to_owned(), pair[1].to_owned())).collect();
        let known = KnownFindings { settings: of(&[["seed", "1"], ["real", "[]"]]), ..KnownFindings::default() };
        let now = of(&[["seed", "2"], ["real", "[]"], ["grid", "{}"]]);
        let told = ["grid is {}, in the baseline none", "seed is 2, in the baseline 1"];
        assert_eq!(known.other_settings("fixed", &now), told);
        assert_eq!(known.other_settings("rotating", &now), told[..1]);
        assert_eq!(known.other_settings("fixed", &known.settings), [""; 0]);
        // One of an earlier version has names alone.
        let engines = |text: &str| of(&[["external", text]]);
        let known = KnownFindings { settings: engines("[\"a\",\"b\"]"), ..KnownFindings::default() };
        let told = |now: &str| known.other_settings("fixed", &engines(now)).len();
        assert_eq!(told("[\"a (f32)\",\"b (f64, accuracy 3)\"]"), 0);
        assert_eq!(told("[\"a (f32)\",\"c (f64)\"]"), 1);
        let known = KnownFindings { settings: engines("[\"a (f64)\"]"), ..KnownFindings::default() };
        assert_eq!(known.other_settings("fixed", &engines("[\"a (f32)\"]")).len(), 1);
        // A file of an earlier version does not say.
        assert_eq!(KnownFindings::default().other_settings("fixed", &now), [""; 0]);
    }

    #[test]
    fn the_file_reads_back() {
        let fields = vec!["engine".to_owned(), "family".to_owned()];
        let overlapping = StateDetail { answers: 5, gaps: 4, normals: 3 };
        let said =
            AnswerDetail { contacts: 9, entrances: 7, contact_answers: 2, overlapping, ..AnswerDetail::default() };
        let known = KnownFindings {
            fields,
            examined: [("sliver".to_owned(), 12), ("real".to_owned(), 3)].into(),
            moved: Some([("sliver".to_owned(), 2)].into()),
            settings: [("engines".to_owned(), "[\"stepper-f64\"]".to_owned()), ("seed".to_owned(), "1".to_owned())]
                .into(),
            known: [("a \"b\" | sliver".to_owned(), count(4, 10)), ("c | real".to_owned(), count(1, 1))].into(),
            said: [("mine".to_owned(), said)].into(),
        };
        assert_eq!(toml::from_str::<KnownFindings>(&known.to_toml()).expect("TOML"), known);
        assert_eq!((known.examined_of("c | real"), known.examined_of("c | sliver")), (3, 12));
        assert_eq!((known.examined_of("step | c | real"), known.examined_of("step | c | sliver")), (0, 2));
    }
}
