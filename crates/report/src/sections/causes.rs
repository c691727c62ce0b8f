//! Why answers differ: causes, changes, and the predicates that decide most findings.

use super::{Section, SectionPart};
use crate::chart::{BarSeries, Chart, ChartAxis, ChartColor, ChartContent, height_of_rows};
use crate::load::CampaignRun;
use crate::table::{Table, TableCell, label};
use rockproof_differential::finding::Cause;
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn section(campaigns: &[CampaignRun]) -> Section {
    let mut section = Section::new(
        "causes",
        "Why do answers differ?",
        "A finding is counted once, at the link of the chain where the answer changes: by the tolerances, by rounding the input, by \
         the engine's arithmetic, or by a mistake in its code (defect).",
    );
    section.parts.push(SectionPart::Chart(by_setting(campaigns)));
    section.parts.push(SectionPart::Table(changes(campaigns), 16));
    section.parts.push(SectionPart::Text("Which questions decide most findings:".to_owned()));
    section.parts.push(SectionPart::Chart(predicate_chart(campaigns)));
    section.parts.push(SectionPart::Quiet(predicates(campaigns)));
    section
}

/// How many settings the chart shows.
const MAX_SETTINGS: usize = 20;

fn by_setting(campaigns: &[CampaignRun]) -> Chart {
    let mut counts: BTreeMap<Cause, BTreeMap<String, u64>> = BTreeMap::new();
    let mut rows = BTreeSet::new();
    for campaign in campaigns {
        for (sort, count) in campaign.tally.sorts.iter().filter(|(sort, _)| campaign.shows(&sort.setting)) {
            let row = label(campaigns.len(), &campaign.name, &sort.setting);
            rows.insert(row.clone());
            *counts.entry(sort.cause).or_default().entry(row).or_default() += count;
        }
    }
    // Of many settings those with the most findings.
    let sum = |row: &String| -> u64 { counts.values().filter_map(|counts| counts.get(row)).sum() };
    let mut order: Vec<String> = rows.iter().cloned().collect();
    order.sort_by_key(|row| std::cmp::Reverse(sum(row)));
    let left = order.len().saturating_sub(MAX_SETTINGS);
    let rows: Vec<String> = order.into_iter().take(MAX_SETTINGS).collect::<BTreeSet<String>>().into_iter().collect();
    let series = counts.iter().map(|(cause, counts)| BarSeries {
        name: cause.name().to_owned(),
        color: ChartColor::Cause(*cause),
        counts: rows.iter().map(|row| counts.get(row).copied().unwrap_or(0)).collect(),
    });
    let content = ChartContent::Bars(series.collect());
    let height = 130 + height_of_rows(&rows, 1);
    let axes = [ChartAxis::from_zero("findings"), ChartAxis::names("", rows)];
    let caption = match left {
        0 => "Findings by tolerance setting and cause".to_owned(),
        left => format!(
            "Findings by cause, of the {MAX_SETTINGS} tolerance settings with the most; {left} more in causes.csv"
        ),
    };
    Chart::new("chart-causes", caption, height, axes, content)
}

fn changes(campaigns: &[CampaignRun]) -> Table {
    let mut table = Table::new(
        "causes",
        "Findings by setting, engine, cause and change, most frequent first; settings made for ties last",
        &["run", "setting", "engine", "cause", "change", "findings"],
    );
    for campaign in campaigns {
        let mut sorts: Vec<_> = campaign.tally.sorts.iter().collect();
        sorts.sort_by_key(|(sort, count)| (!campaign.shows(&sort.setting), std::cmp::Reverse(**count)));
        for (sort, count) in sorts {
            table.push(vec![
                campaign.name.as_str().into(),
                sort.setting.as_str().into(),
                TableCell::Scope(sort.engine.clone()),
                sort.cause.name().into(),
                sort.change.name().into(),
                (*count).into(),
            ]);
        }
    }
    table
}

fn predicates(campaigns: &[CampaignRun]) -> Table {
    let mut table = Table::new(
        "predicates",
        "The predicates that decide most findings",
        &["run", "predicate", "cause", "engine", "findings"],
    );
    for campaign in campaigns {
        for (predicate, counts) in &campaign.tally.predicates {
            for ((cause, engine), count) in counts {
                let names = [campaign.name.as_str(), predicate, cause.name()].map(TableCell::from);
                table.push(names.into_iter().chain([TableCell::Scope(engine.clone()), (*count).into()]).collect());
            }
        }
    }
    table
}

fn predicate_chart(campaigns: &[CampaignRun]) -> Chart {
    let mut sums: BTreeMap<&str, BTreeMap<Cause, u64>> = BTreeMap::new();
    for (predicate, counts) in campaigns.iter().flat_map(|campaign| &campaign.tally.predicates) {
        for ((cause, _), count) in counts {
            *sums.entry(predicate).or_default().entry(*cause).or_default() += count;
        }
    }
    let mut order: Vec<(&str, u64)> = sums.iter().map(|(name, counts)| (*name, counts.values().sum())).collect();
    order.sort_by_key(|(name, count)| (std::cmp::Reverse(*count), *name));
    order.truncate(15);
    let names: Vec<&str> = order.iter().map(|(name, _)| *name).collect();
    let causes: BTreeSet<Cause> = sums.values().flat_map(BTreeMap::keys).copied().collect();
    let series = causes.into_iter().map(|cause| {
        let count = |name: &&str| sums.get(name).and_then(|counts| counts.get(&cause)).copied().unwrap_or(0);
        let counts = names.iter().map(count).collect();
        BarSeries { name: cause.name().to_owned(), color: ChartColor::Cause(cause), counts }
    });
    let content = ChartContent::Bars(series.collect());
    let height = 130 + 24 * names.len();
    let names = names.iter().map(|name| (*name).to_owned()).collect();
    let axes = [ChartAxis::from_zero("findings"), ChartAxis::names("", names)];
    Chart::new("chart-predicates", "The predicates that decide most findings, by cause", height, axes, content)
}
