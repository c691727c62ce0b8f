//! The end of a campaign, of a part of one, or of a merge: what it means in a few lines, what differs by cause, and what to do next.

use crate::input::FormatArgs;
use crate::stress::StressEnd;
use crate::table::{counted, grouped, prose, table};
use rockproof_campaign::journal::{CampaignProgress, Journal};
use rockproof_campaign::merge::Parts;
use rockproof_campaign::part::Part;
use rockproof_campaign::run::Ending;
use rockproof_campaign::steps::StepSummary;
use rockproof_campaign::steps::summary::StepCounts;
use rockproof_differential::case_file::Case;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::diagnosis::diagnosis_lines;
use rockproof_differential::external::spec::{quoted, replay_command};
use rockproof_differential::external::{EngineSpec, is_of_earlier_answers};
use rockproof_differential::finding::Cause;
use rockproof_report::load::{CampaignRun, Results};
use rockproof_report::step_tally::WorstStep;
use rockproof_report::tally::{FindingTally, WorstFinding};
use rockproof_report::verdict::verdict;
use rockproof_results::MANIFEST;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Prints the end of a campaign, from what it left on disk, and what its stress set came to where it has one.
pub(crate) fn print_end(
    journal: &Journal,
    external: &[EngineSpec],
    ending: Ending,
    stress: Option<&StressEnd>,
    format: &FormatArgs,
) -> anyhow::Result<()> {
    let dir = journal.dir().to_owned();
    let results = Results::read(std::slice::from_ref(&dir))?;
    let progress = journal.progress();
    let text = || {
        let mut out = stress.map_or(String::new(), |stress| stress.text.clone());
        for line in verdict(&results) {
            out += &prose(&format!("{}\n", line.text));
        }
        for campaign in &results.campaigns {
            out += &by_cause(&campaign.tally);
            let lines = diagnosis_lines(&campaign.diagnosis);
            if !lines.is_empty() {
                out += &format!("\n{}\n", lines.join("\n"));
            }
        }
        if !progress.steps.is_empty() {
            out += &format!("\n{}\n", steps_table(&progress.steps));
        }
        out += &format!("\n{}", what_is_there(progress, &dir, ending));
        let campaign = results.campaigns.first();
        out + &match setting(progress, Part::KEY) {
            _ if ending == Ending::Stopped => String::new(),
            Some(part) => {
                format!("next: when all parts are done (this is {part}): rockproof merge DIR… --out DIR\n")
            }
            None => next(&dir, campaign, external),
        }
    };
    format.print(text, || {
        let mut document = document(&results, progress, &dir, ending);
        if let Some(stress) = stress {
            document["stress"] = stress.document.clone();
        }
        document
    })
}

/// The end for programs.
fn document(results: &Results, progress: &CampaignProgress, dir: &Path, ending: Ending) -> Value {
    let causes: Vec<Value> = results
        .campaigns
        .iter()
        .flat_map(|campaign| groups(&campaign.tally))
        .map(|group| {
            json!({
                "cause": group.cause.name(), "engine": group.engine, "findings": group.findings,
                "most_frequent_change": group.most.map(|(change, _)| change), "of_that_change": group.most.map(|(_, count)| count),
                "furthest_roundoffs": group.furthest,
            })
        })
        .collect();
    let steps: Vec<Value> = progress
        .steps
        .by_engine()
        .into_iter()
        .map(|(engine, counts)| {
            let mut row: Map<String, Value> = STEP_COLUMNS
                .into_iter()
                .zip(step_counts(&counts))
                .map(|(name, n)| (name.replace(' ', "_"), n.into()))
                .collect();
            row.insert("engine".to_owned(), engine.into());
            row.into()
        })
        .collect();
    let cases = |cases: &BTreeMap<String, u64>| cases.values().sum::<u64>();
    let mut document = json!({
        "finished": ending == Ending::Finished,
        "part": setting(progress, Part::KEY),
        "merged_parts": setting(progress, Parts::KEY),
        "verdict": verdict(results),
        "pairs": progress.pairs_done,
        "seconds": progress.seconds,
        "findings": progress.summary.total(),
        "step_findings": progress.steps.total(),
        "causes": causes,
        "steps": steps,
        "worst_step_case": results.campaigns.first().and_then(worst_step).map(|worst| &worst.case),
        "external_engines": progress.engines,
        "case_files": cases(&progress.cases),
        "step_case_files": cases(&progress.step_cases),
        "directory": dir.display().to_string(),
    });
    if !progress.engines.is_empty() {
        document["diagnosis"] =
            results.campaigns.iter().flat_map(|campaign| &campaign.diagnosis).map(|row| json!(row)).collect();
    }
    document
}

/// A text of the configuration.
fn setting<'p>(progress: &'p CampaignProgress, key: &str) -> Option<&'p str> {
    progress.configuration.get(key).and_then(Value::as_str)
}

/// The findings of one cause that concern one engine, or all of a precision.
struct FindingGroup<'t> {
    cause: Cause,
    engine: &'t str,
    findings: u64,
    /// The change that most of them are, and how many.
    most: Option<(&'t str, u64)>,
    /// How far from a tie the clearest is, in roundoffs.
    furthest: Option<f64>,
}

fn groups(tally: &FindingTally) -> Vec<FindingGroup<'_>> {
    let mut groups: BTreeMap<(Cause, &str), BTreeMap<&str, u64>> = BTreeMap::new();
    for (sort, count) in &tally.sorts {
        let changes = groups.entry((sort.cause, &sort.engine)).or_default();
        *changes.entry(sort.change.name()).or_default() += count;
    }
    groups
        .into_iter()
        .map(|((cause, engine), changes)| FindingGroup {
            cause,
            engine,
            findings: changes.values().sum(),
            // Of equally frequent ones the first by name.
            most: changes.into_iter().max_by(|a, b| a.1.cmp(&b.1).then(b.0.cmp(a.0))),
            furthest: tally.furthest.get(&(engine.to_owned(), cause)).copied(),
        })
        .collect()
}

/// A row for each cause and whom it concerns: how many findings, the change that most of them are, and how far from a tie the clearest is.
fn by_cause(tally: &FindingTally) -> String {
    let groups = groups(tally);
    if groups.is_empty() {
        return String::new();
    }
    let rows = groups.into_iter().map(|group| {
        let all = group.findings;
        let most = group.most.map_or(String::new(), |(change, n)| format!("{change} ({} %)", 100 * n / all));
        let far = group.furthest.map_or(String::new(), |ulps| format!("{ulps:.1e}"));
        vec![group.cause.to_string(), scope_words(group.engine), grouped(all), most, far]
    });
    format!(
        "\n{}\n",
        table(&["cause", "concerns", "findings", "mostly", "roundoffs from a tie, at most"], &[2, 4], rows)
    )
}

/// Whom a finding is about, in words.
fn scope_words(engine: &str) -> String {
    match engine {
        "any" => "every engine".to_owned(),
        "f32" | "f64" => format!("whatever is given in {engine}"),
        engine => engine.to_owned(),
    }
}

fn what_is_there(progress: &CampaignProgress, dir: &Path, ending: Ending) -> String {
    let speed = progress.pairs_done as f64 / progress.seconds.max(1e-9);
    let (done, seconds) = (counted(progress.pairs_done, "pair", "pairs"), progress.seconds);
    let found = counted(progress.summary.total(), "finding", "findings");
    let in_steps = match progress.steps.total() {
        0 => String::new(),
        found => format!(", and {} about steps", grouped(found)),
    };
    let mut out = format!("{done} in {seconds:.1} s ({speed:.0} a second), {found}{in_steps}\n");
    for (name, counts) in &progress.engines {
        if !counts.first_repeated.is_empty() {
            out += &format!("{name}: instead of answers it gave, among others:\n");
            for failure in &counts.first_repeated {
                out += &format!("  {failure}\n");
            }
        }
        if let Some(note) = counts.recovered_note() {
            out += &format!("{name}: {note}; engines.csv counts them\n");
            for failure in &counts.first_failures {
                out += &format!("  {failure}\n");
            }
        }
    }
    if ending == Ending::Stopped {
        let are = if progress.pairs_done == 1 { "is" } else { "are" };
        let on = match progress.pairs_done {
            0 => "that was the first chunk, so --resume begins with the first pair",
            _ => "--resume goes on from there",
        };
        out += &format!("interrupted: {done} {are} kept, those of the chunk under way are not; {on}\n");
    }
    if let Some(there) = setting(progress, Parts::KEY) {
        let asked = progress.configuration.get("pairs").and_then(Value::as_u64).unwrap_or_default();
        out += &format!(
            "not the whole campaign: parts {there}, {} of {} pairs\n",
            grouped(progress.pairs_done),
            grouped(asked)
        );
    }
    let dir = dir.display();
    let tables = if progress.steps.is_empty() { "" } else { "step_findings.csv, step_summary.csv, " };
    out += &format!("written to {dir}: findings.csv, summary.csv, {tables}run.json");
    let count = |cases: &BTreeMap<String, u64>| cases.values().sum::<u64>();
    let (pairs, steps) = (count(&progress.cases), count(&progress.step_cases));
    if pairs > 0 {
        out += &format!(", {} in cases", counted(pairs, "shrunk finding", "shrunk findings"));
    }
    if steps > 0 {
        out += &format!(", {} in cases", counted(steps, "step", "steps"));
    }
    out + "\n"
}

/// The commands that go on from here.
fn next(dir: &Path, campaign: Option<&CampaignRun>, external: &[EngineSpec]) -> String {
    // A report on results that were there before is discarded by what makes it anew, not by the campaign, which has no part in it.
    let is_there = dir.join("report").join(MANIFEST).exists();
    let again = if is_there { " --overwrite" } else { "" };
    let mut out = format!("next: rockproof report {}{again}\n", quoted(&dir.display().to_string()));
    let mut replay = |case: &str, engine: Option<&EngineSpec>| {
        out += &format!("      {}\n", replay_command(&dir.join(case), engine));
    };
    // A case that asking a fresh process may not show is none to begin with. One that cannot be read says so when it is replayed.
    let recurs = |case: &Path| {
        let note = Case::load(case).ok().and_then(|case| case.about.note);
        note.is_none_or(|note| !is_of_earlier_answers(&note))
    };
    let pair = campaign.and_then(|campaign| {
        let is_shown = |worst: &WorstFinding| worst.change != AnswerChange::Malformed || recurs(&dir.join(&worst.case));
        campaign.tally.worst_of_all(is_shown)
    });
    if let Some(worst) = pair {
        replay(&worst.case, external.iter().find(|spec| spec.name == worst.engine));
    }
    // Differences of steps that are neither passages nor mistakes come with those of contacts.
    let step = campaign.and_then(worst_step);
    if let Some(worst) = step.filter(|worst| pair.is_none() || worst.is_serious()) {
        replay(&worst.case, None);
    }
    out
}

/// The step with a case to look at first.
fn worst_step(campaign: &CampaignRun) -> Option<&WorstStep> {
    campaign.step_tally.worst_of_all()
}

/// The counts of steps in tables.
pub(crate) const STEP_COLUMNS: [&str; 11] = [
    "steps",
    "other contacts",
    "modes",
    "iterations",
    "retries",
    "deeper",
    "shallower",
    "watched",
    "passages",
    "unseen",
    "defects",
];

/// The counts in the order of [`STEP_COLUMNS`].
fn step_counts(counts: &StepCounts) -> [u64; 11] {
    [
        counts.compared,
        counts.contacts_differ,
        counts.modes_differ,
        counts.iterations_differ,
        counts.retries_differ,
        counts.deeper,
        counts.shallower,
        counts.watched,
        counts.passages_stepper,
        counts.unseen_stepper,
        counts.defect,
    ]
}

/// One row for each engine: its steps, and how many of them differ from the exact ones.
fn steps_table(steps: &StepSummary) -> String {
    let rows = steps
        .by_engine()
        .into_iter()
        .map(|(engine, counts)| std::iter::once(engine.to_owned()).chain(step_counts(&counts).map(grouped)).collect());
    let header: Vec<&str> = std::iter::once("engine").chain(STEP_COLUMNS).collect();
    table(&header, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11], rows)
}
