//! What changed between two runs of a campaign, as a report: shares of right answers, and sorts of findings.

use super::Report;
use super::detail_change::{DetailChange, details};
use super::error::ReportError;
use super::load::{CampaignRun, RunFile, agreeing_share, last_name};
use super::pair_numbers::{self, PairNumbers};
use super::sections::{Section, SectionPart};
use super::table::{Table, TableCell, grouped};
use super::verdict::{Severity, VerdictLine};
use rockproof_campaign::proportion::Proportion;
use rockproof_differential::agreement::EngineAnswers;
use rockproof_gate::comparison::{ClassChange, Comparable, FindingComparison, Trend};
use rockproof_gate::tally::CampaignTally;
use rockproof_model::text::escaped;
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A setting in which two runs differ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SettingChange {
    /// Its name in `run.json`.
    pub setting: String,
    /// Its value in the run before; nothing where it is not set.
    pub before: Option<Value>,
    /// The same in the run after.
    pub after: Option<Value>,
}

/// How often an engine is right under a tolerance setting, in both runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShareChange {
    /// The tolerance setting.
    pub setting: String,
    /// The engine.
    pub engine: String,
    /// The share of pairs with the exact answer before, with its 95 % interval.
    pub before: [f64; 3],
    /// The same after.
    pub after: [f64; 3],
}

/// What changed between two runs of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunComparison {
    /// The directories' names, before and after.
    pub runs: [String; 2],
    /// Pairs examined, before and after.
    pub pairs: [u64; 2],
    /// How many pairs are the same in both: all of the shorter run; nothing where the runs are over different pairs.
    pub same_pairs: Option<u64>,
    /// The settings in which they differ.
    pub settings: Vec<SettingChange>,
    /// Engines that take part in one of them alone, before and after: left out.
    pub engines_left_out: [Vec<String>; 2],
    /// External engines that answered less than half of the pairs of the run after, but not of the run before: of them little was compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub engines_silent: Vec<String>,
    /// The sorts of findings.
    pub findings: FindingComparison,
    /// The shares of right answers, of pairs as each run has them.
    pub agreement: Vec<ShareChange>,
    /// External engines that say more or less of their contacts or of how blocks lie.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub details: Vec<DetailChange>,
}

impl RunComparison {
    /// Compares the campaigns in two directories.
    ///
    /// # Errors
    /// When one is no campaign, is damaged, or was made by another version, or when they share a part of their pairs alone.
    pub fn of(before: &Path, after: &Path) -> Result<RunComparison, ReportError> {
        let dirs = [before, after];
        let [first, second] = [CampaignRun::open(before)?, CampaignRun::open(after)?];
        let settings = differences(&first.run.configuration, &second.run.configuration);
        let runs = [&first, &second];
        let pairs = runs.map(|run| run.run.pairs);
        let shared = shared_pairs(runs)?;
        let same_pairs = shared.as_ref().map(PairNumbers::count);
        let engines = runs.map(|run| run.run.scopes());
        let in_both: BTreeSet<String> = engines[0].intersection(&engines[1]).cloned().collect();
        let engines_left_out: [Vec<String>; 2] = engines.map(|engines| engines.difference(&in_both).cloned().collect());
        let tallies = [CampaignTally::read(before)?, CampaignTally::read(after)?];
        let tolerance = !precisions_differ(&engines_left_out);
        let comparable = Comparable { same_pairs: shared.map(PairNumbers::into_ranges), engines: in_both, tolerance };
        let findings = FindingComparison::of(&tallies[0], &tallies[1], &comparable);
        let agreement = shares(runs);
        let details = details(runs, same_pairs.is_some())?;
        let names =
            if first.name == second.name { dirs.map(|dir| dir.display().to_string()) } else { dirs.map(last_name) };
        let engines_silent = silent_engines(runs);
        Ok(RunComparison {
            runs: names,
            pairs,
            same_pairs,
            settings,
            engines_left_out,
            engines_silent,
            findings,
            agreement,
            details,
        })
    }

    /// How many sorts of findings fared so.
    pub fn count(&self, trend: Trend) -> usize {
        self.findings.count(trend)
    }

    /// Engines and precisions of the run before that take no part in the run after: nothing is known of their findings.
    pub fn gone_engines(&self) -> &[String] {
        &self.engines_left_out[0]
    }

    /// Whether an external engine says less of its contacts, or of how blocks lie, than before, so that less is compared.
    pub fn says_less(&self) -> bool {
        self.details.iter().any(|change| change.less)
    }

    /// The verdict, what is compared and what it came to.
    pub fn verdict(&self) -> Vec<VerdictLine> {
        let line = |severity, text| VerdictLine { severity, text };
        let mut lines = vec![match self.same_pairs {
            Some(pairs) => line(
                Severity::Fair,
                match pairs {
                    1 => "Both runs examined the same pair: every difference below is real.".to_owned(),
                    _ => format!("Both runs examined the same {} pairs: every difference below is real.", grouped(pairs)),
                },
            ),
            None => line(
                Severity::Fair,
                "The runs are over different pairs: a difference counts where chance does not explain it (99.9 %, over all sorts).".to_owned(),
            ),
        }];
        let [new, more, other, fewer, gone, same] = Trend::ALL.map(|trend| self.count(trend));
        let mut worse = vec![format!("{new} new"), format!("{more} more frequent")];
        if other > 0 {
            worse.push(format!("{other} in other pairs"));
        }
        let severity = match (new + more, other) {
            (0, 0) => Severity::Good,
            (0, _) => Severity::Fair,
            _ => Severity::Bad,
        };
        let of = self.findings.classes.len();
        let text = match (of, self.examined()) {
            (_, 0) => "Nothing was examined by both runs, so nothing is known.".to_owned(),
            (0, _) => "No finding in either run.".to_owned(),
            _ => format!(
                "Of {of} sorts of findings {}; {fewer} less frequent, {gone} gone, {same} unchanged.",
                worse.join(", ")
            ),
        };
        lines.push(line(if self.examined() == 0 { Severity::Bad } else { severity }, text));
        if !self.engines_silent.is_empty() {
            let engines = self.engines_silent.join(", ");
            lines.push(line(
                Severity::Bad,
                format!(
                    "{engines} answered less than half of the pairs of the run after, and not so before: little was compared."
                ),
            ));
        }
        lines.extend(self.details.iter().flat_map(DetailChange::verdict));
        if let Some(text) = self.left_out() {
            lines.push(line(Severity::Fair, text));
        }
        lines
    }

    /// The largest number of pairs in which a sort of findings could have been; 0 where the runs have nothing in common.
    pub fn examined(&self) -> u64 {
        let [before, after] = self.findings.examined;
        before.min(after)
    }

    /// What only one of them has, in a sentence.
    fn left_out(&self) -> Option<String> {
        let [before, after] = &self.engines_left_out;
        let groups = self.findings.left_out.iter().map(Vec::len).sum::<usize>();
        let mut parts: Vec<String> = before.iter().chain(after).map(|engine| format!("engine {engine}")).collect();
        if groups > 0 {
            parts.push(format!("{groups} combinations of family and tolerance set"));
        }
        let tolerance = match precisions_differ(&self.engines_left_out) {
            true => {
                " So are findings of the cause tolerance, since whom they are about depends on the precisions that take part."
            }
            false => "",
        };
        (!parts.is_empty()).then(|| format!("Left out, as only one run has them: {}.{tolerance}", parts.join(", ")))
    }

    /// The comparison as a report: a page, tables, or a text for a pull request.
    pub fn report(&self) -> Report {
        let [before, after] = &self.runs.each_ref().map(|name| escaped(name));
        let mut changed = Section::new(
            "changed",
            "Which findings changed?",
            "A sort of findings is of one engine, cause, change and predicate. Pairs count once for each tolerance set.",
        );
        let caption = "Sorts of findings that changed, before and after; chance: how likely a difference so large is where pairs differ";
        let differing = |class: &&ClassChange| class.trend != Trend::Same;
        let classes = self.findings.classes.iter();
        changed.parts.push(SectionPart::Table(class_table("changed", caption, classes.clone().filter(differing)), 40));
        changed.parts.push(SectionPart::Quiet(class_table("classes", "The same of all sorts", classes)));
        let mut shares = Section::new(
            "shares",
            "How often is the answer right?",
            "The share of pairs whose contacts are exactly those of the oracle, in each run over all its pairs.",
        );
        shares.parts.push(SectionPart::Table(self.share_table(), 40));
        let mut settings = Section::new("settings", "In which settings do the runs differ?", "As in run.json.");
        settings.parts.push(SectionPart::Table(self.setting_table(), 40));
        let sections = vec![changed, shares, settings];
        Report { title: format!("{before} → {after}"), verdict: self.verdict(), sections }
    }

    fn share_table(&self) -> Table {
        let mut table = Table::new(
            "shares",
            "Agreement with the oracle, before and after. Intervals are Wilson's, 95 %.",
            &["setting", "engine", "before", "before_low", "before_high", "after", "after_low", "after_high"],
        );
        for share in &self.agreement {
            let words = [&share.setting, &share.engine].map(|text| TableCell::from(text.as_str()));
            let numbers = share.before.into_iter().chain(share.after).map(TableCell::Share);
            table.push(words.into_iter().chain(numbers).collect());
        }
        table
    }

    fn setting_table(&self) -> Table {
        let mut table = Table::new("settings", "Settings that differ", &["setting", "before", "after"]);
        let shown = |value: &Option<Value>| value.as_ref().map_or(TableCell::Empty, |value| value.to_string().into());
        for change in &self.settings {
            table.push(vec![change.setting.as_str().into(), shown(&change.before), shown(&change.after)]);
        }
        table
    }
}

/// Sorts of findings as a table.
fn class_table<'c>(name: &'static str, caption: &str, classes: impl Iterator<Item = &'c ClassChange>) -> Table {
    let mut table = Table::new(
        name,
        caption,
        &[
            "trend",
            "engine",
            "cause",
            "change",
            "predicate",
            "findings_before",
            "findings_after",
            "pairs_before",
            "pairs_after",
            "only_before",
            "only_after",
            "examined_before",
            "examined_after",
            "chance",
            "pair",
        ],
    );
    for class in classes {
        let only = class.only.map_or([TableCell::Empty, TableCell::Empty], |only| only.map(TableCell::Count));
        let name = &class.class;
        let words = [name.cause.as_str(), &name.change, &name.predicate].map(TableCell::from);
        let first = [class.trend.name().into(), TableCell::Scope(name.engine.clone())];
        let counts = [class.findings, class.pairs].into_iter().flatten().map(TableCell::Count);
        let examined = class.examined.map(TableCell::Count);
        let last = [TableCell::number(class.chance), class.pair.map_or(TableCell::Empty, TableCell::Count)];
        table.push(first.into_iter().chain(words).chain(counts).chain(only).chain(examined).chain(last).collect());
    }
    table
}

impl CampaignRun {
    /// The campaign in a directory.
    fn open(dir: &Path) -> Result<CampaignRun, ReportError> {
        let results = super::load::Results::read(&[dir.to_owned()])?;
        let found = "no findings.csv: a campaign has one".to_owned();
        let run =
            results.campaigns.into_iter().next().ok_or_else(|| ReportError::NoRun { dir: dir.to_owned(), found })?;
        if run.run.finished {
            Ok(run)
        } else {
            Err(ReportError::Unfinished { dir: dir.to_owned(), pairs: run.run.pairs })
        }
    }
}

impl RunFile {
    /// Whom findings of this run may be about: `any`, the precisions of its engines, and its engines.
    fn scopes(&self) -> BTreeSet<String> {
        let list = |name: &str| self.configuration.get(name).and_then(Value::as_array).cloned().unwrap_or_default();
        let built_in = list("engines").into_iter().filter_map(|name| name.as_str().map(str::to_owned));
        let mut scopes: BTreeSet<String> = built_in.collect();
        let precisions = |name: &String| ["f32", "f64"].into_iter().find(|precision| name.ends_with(precision));
        scopes.extend(scopes.clone().iter().filter_map(precisions).map(str::to_owned));
        for spec in list("external") {
            let text = |name: &str| spec.get(name).and_then(Value::as_str).map(str::to_owned);
            scopes.extend(text("name"));
            scopes.insert(text("precision").unwrap_or_else(|| "f64".to_owned()));
        }
        scopes.insert("any".to_owned());
        scopes
    }
}

/// Whether a precision takes part in one of two runs alone, whose scopes these are without those of the other.
fn precisions_differ(left_out: &[Vec<String>; 2]) -> bool {
    left_out.iter().flatten().any(|scope| ["f32", "f64"].contains(&scope.as_str()))
}

/// The pairs that both runs examined, all of those of the shorter one; `None` where the same number is another pair, or they have none in common.
fn shared_pairs(runs: [&CampaignRun; 2]) -> Result<Option<PairNumbers>, ReportError> {
    let [one, two] = runs.map(|run| PairNumbers::of(&run.run));
    let shared = one.shared(&two);
    if !pair_numbers::are_of_one_campaign(&runs[0].run.configuration, &runs[1].run.configuration) || shared.count() == 0
    {
        return Ok(None);
    }
    if shared.count() < one.count().min(two.count()) {
        return Err(ReportError::Overlap {
            dirs: runs.map(|run| run.dir.clone()),
            shared: shared.ends().unwrap_or_default(),
        });
    }
    Ok(Some(shared))
}

/// The settings in which two runs differ.
fn differences(before: &Map<String, Value>, after: &Map<String, Value>) -> Vec<SettingChange> {
    let names: BTreeSet<&String> = before.keys().chain(after.keys()).collect();
    let change = |name: &String| SettingChange {
        setting: name.clone(),
        before: before.get(name).cloned(),
        after: after.get(name).cloned(),
    };
    names.into_iter().filter(|name| before.get(*name) != after.get(*name)).map(change).collect()
}

/// As [`RunComparison::engines_silent`].
fn silent_engines([before, after]: [&CampaignRun; 2]) -> Vec<String> {
    let in_both = after.run.external_engines.keys().filter(|engine| before.run.external_engines.contains_key(*engine));
    let is_silent = |run: &CampaignRun, engine: &str| {
        let counts = run.of_engine(engine);
        EngineAnswers { asked: counts.pairs, answered: counts.pairs - counts.silent, ..EngineAnswers::default() }
            .are_too_few()
    };
    in_both.filter(|engine| is_silent(after, engine) && !is_silent(before, engine)).cloned().collect()
}

/// What users of each engine see, under each setting that both runs have.
fn shares(runs: [&CampaignRun; 2]) -> Vec<ShareChange> {
    let sums = runs.map(|run| {
        let whole = run.by_setting().into_iter().filter(|(key, _)| run.is_of_users(key) && run.shows(&key.tolerances));
        let share = |Proportion { value, low, high }: Proportion| [value, low, high];
        whole
            .filter_map(|(key, sums)| Some(((key.tolerances, key.engine), share(agreeing_share(&sums)?))))
            .collect::<BTreeMap<_, _>>()
    });
    let both = sums[0].iter().filter_map(|(key, before)| Some((key, before, sums[1].get(key)?)));
    both.map(|((setting, engine), before, after)| ShareChange {
        setting: setting.clone(),
        engine: engine.clone(),
        before: *before,
        after: *after,
    })
    .collect()
}
