//! How near to a tie findings are.

use super::{Section, SectionPart};
use crate::chart::{BarSeries, Chart, ChartAxis, ChartColor, ChartContent};
use crate::load::CampaignRun;
use crate::table::{Table, TableCell, concerned, label};
use crate::tally::Decade;
use rockproof_differential::finding::Cause;
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn section(campaigns: &[CampaignRun]) -> Section {
    let mut section = Section::new(
        "margins",
        "How close were the decisions?",
        "The margin of the predicate behind each finding, in roundoffs of the engine. Below about one, no calculation in that \
         precision could know better; thousands of roundoffs mean a formula that cancels, or a mistake.",
    );
    let measured = |cause| matches!(cause, Cause::Representation | Cause::Arithmetic | Cause::Defect | Cause::Engine);
    section.parts.push(SectionPart::Chart(chart("chart-margins", "margin in roundoffs", campaigns, measured)));
    section.parts.push(SectionPart::Text(
        "Under the cause tolerance nothing is rounded. There the margin says by which share of its terms a predicate misses the tie."
            .to_owned(),
    ));
    section.parts.push(SectionPart::Chart(chart("chart-margins-tolerance", "relative margin", campaigns, |c| {
        c == Cause::Tolerance
    })));
    section.parts.push(SectionPart::Quiet(table(campaigns)));
    section
}

fn name_of(decade: Decade) -> String {
    decade.map_or("tie".to_owned(), |n| format!("1e{n}"))
}

fn table(campaigns: &[CampaignRun]) -> Table {
    let mut table = Table::new(
        "margins",
        "Findings by decade of the margin: in roundoffs, under the cause tolerance relative",
        &["run", "engine", "cause", "from", "findings"],
    );
    for campaign in campaigns {
        for ((engine, cause), decades) in &campaign.tally.margins {
            let start = || [campaign.name.as_str().into(), TableCell::Scope(engine.clone()), cause.name().into()];
            for (decade, count) in decades {
                table.push(start().into_iter().chain([name_of(*decade).into(), (*count).into()]).collect());
            }
            if let Some(count) = campaign.tally.unmeasured.get(&(engine.clone(), *cause)) {
                table.push(start().into_iter().chain(["no margin".into(), (*count).into()]).collect());
            }
        }
    }
    table
}

fn chart(id: &str, title: &str, campaigns: &[CampaignRun], wanted: impl Fn(Cause) -> bool) -> Chart {
    let mut series: Vec<(String, &BTreeMap<Decade, u64>)> = Vec::new();
    let mut decades: BTreeSet<Decade> = BTreeSet::new();
    for campaign in campaigns {
        for ((engine, cause), counts) in campaign.tally.margins.iter().filter(|((_, cause), _)| wanted(*cause)) {
            decades.extend(counts.keys());
            series.push((label(campaigns.len(), &campaign.name, &format!("{}, {cause}", concerned(engine))), counts));
        }
    }
    let bars = series.into_iter().enumerate().map(|(number, (name, counts))| BarSeries {
        name,
        color: ChartColor::Series(number),
        counts: decades.iter().map(|decade| counts.get(decade).copied().unwrap_or(0)).collect(),
    });
    let content = ChartContent::Bars(bars.collect());
    let order: Vec<String> = decades.into_iter().map(name_of).collect();
    let axes = [ChartAxis::names(format!("{title}, from"), order), ChartAxis::from_zero("findings")];
    Chart::new(id, format!("Distribution of margins: {title}, by decade"), 380, axes, content)
}
