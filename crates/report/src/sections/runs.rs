//! What the report is made of.

use super::{Section, SectionPart};
use crate::load::{CampaignRun, Results};
use crate::table::{Table, TableCell};

pub(super) fn section(results: &Results) -> Section {
    let mut section =
        Section::new("runs", "What this is made of", "The runs whose results were read, and how to make them again.");
    if !results.campaigns.is_empty() {
        let mut table = Table::new(
            "runs",
            "Campaigns. The same seed, configuration and version make the same pairs and findings on any machine.",
            &["run", "version", "seed", "pairs", "finished", "contacts", "findings", "metamorphic_checks", "engines"],
        );
        let mut machines = Vec::new();
        for campaign in &results.campaigns {
            let run = &campaign.run;
            table.push(vec![
                campaign.name.as_str().into(),
                run.version.as_str().into(),
                run.seed.into(),
                run.pairs.into(),
                finished(campaign).into(),
                run.contacts.into(),
                run.findings.total.into(),
                run.metamorphic_checks.into(),
                campaign.engines().join(", ").into(),
            ]);
            let m = &run.machine;
            machines.push(format!(
                "{}: {:.0} s on {} cores, {} {}.",
                campaign.name, run.seconds, m.cores, m.os, m.architecture
            ));
        }
        section.parts.push(SectionPart::Table(table, 100));
        section.parts.push(SectionPart::Text(machines.join(" ")));
    }
    let others = results.locksteps.iter().map(|r| ("lockstep", &r.name, r.steps, &r.dir));
    let others = others
        .chain(results.without_lockstep().map(|r| ("simulate", &r.name, r.totals.steps + r.totals.settling, &r.dir)));
    let others = others.chain(results.stresses.iter().map(|r| ("stress", &r.name, r.cells.len() as u64, &r.dir)));
    let others = others.chain(results.timings.iter().map(|r| ("bench", &r.name, r.measurements.len() as u64, &r.dir)));
    let mut table = Table::new("other_runs", "Other runs", &["run", "what", "rows", "directory"]);
    for (what, name, rows, dir) in others {
        table.push(vec![name.as_str().into(), what.into(), TableCell::Count(rows), dir.display().to_string().into()]);
    }
    if !table.rows.is_empty() {
        section.parts.push(SectionPart::Table(table, 100));
    }
    section
}

/// Whether all pairs were done, or which part it is, or which parts a merge had.
fn finished(campaign: &CampaignRun) -> String {
    let run = &campaign.run;
    let part = campaign.part().map_or(String::new(), |part| format!(", {part}"));
    match run.configuration.get("parts").and_then(|parts| parts.as_str()) {
        Some(parts) => format!("no, parts {parts}"),
        None if run.finished => format!("yes{part}"),
        None => format!("no, interrupted{part}"),
    }
}
