//! How often engines are right: by tolerance setting, and by family of pairs.

use super::{Section, SectionPart};
use crate::chart::{Chart, ChartAxis, ChartColor, ChartContent, ChartPoint, Curve, HeatMap, height_of_rows};
use crate::load::{CampaignRun, agreeing_share};
use crate::table::{Table, TableCell, label};
use rockproof_campaign::proportion::Proportion;
use rockproof_differential::agreement::{AgreementCounts, ChainSpan, ComparisonKey};
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn section(campaigns: &[CampaignRun]) -> Section {
    let mut section = Section::new(
        "agreement",
        "How often is the answer right?",
        "The share of pairs whose contacts are exactly those of the oracle: number, kinds, features, entrances and signs of gaps. \
         Most pairs of a campaign are put on the very edge of a decision, so these are shares of hard questions.",
    );
    section.parts.push(SectionPart::Chart(by_setting(campaigns)));
    section.parts.extend(not_shown(campaigns));
    let (table, whole) = table(campaigns);
    section.parts.push(SectionPart::Table(table, whole.min(MAX_ROWS)));
    let families = families(campaigns);
    section.parts.push(SectionPart::Chart(family_map(campaigns)));
    section.parts.push(SectionPart::Quiet(families));
    section
}

/// What the settings are that only CSV files have, where there are any.
fn not_shown(campaigns: &[CampaignRun]) -> Option<SectionPart> {
    let count: usize = campaigns.iter().map(CampaignRun::not_shown).sum();
    (count > 0).then(|| {
        SectionPart::Text(format!(
            "{count} more settings are counted in the shares above all settings and in the CSV files, and not shown one by one: dyadic and fractional sets are made of numbers \
             with which ties are exact, ladders put one tolerance on the edge of a decision. They are hard questions for engines; nobody would use them."
        ))
    })
}

/// The row's share, or blank cells.
fn share_cells(sums: &AgreementCounts) -> [TableCell; 3] {
    agreeing_share(sums)
        .map_or([TableCell::Empty, TableCell::Empty, TableCell::Empty], |Proportion { value, low, high }| {
            [value, low, high].map(TableCell::Share)
        })
}

/// How many rows of agreement the page shows.
const MAX_ROWS: usize = 48;

/// All rows, those about what users see first, and how many these are.
fn table(campaigns: &[CampaignRun]) -> (Table, usize) {
    let mut table = Table::new(
        "agreement",
        "Agreement by tolerance setting. whole: what a user of the engine sees; tolerance, representation, arithmetic: \
         what one link of the chain leaves as it was, which is all there is for engines that say only how blocks lie. Intervals are Wilson's, 95 %.",
        &[
            "run",
            "setting",
            "engine",
            "compared",
            "pairs",
            "agreement",
            "low",
            "high",
            "no_answer",
            "contacts",
            "entrance_differs",
            "gap_sign_differs",
        ],
    );
    let mut whole = 0;
    for first in [true, false] {
        let all =
            campaigns.iter().flat_map(|campaign| campaign.by_setting().into_iter().map(move |row| (campaign, row)));
        let seen = |campaign: &CampaignRun, compared: &ComparisonKey| {
            campaign.is_of_users(compared) && campaign.shows(&compared.tolerances)
        };
        for (campaign, (compared, sums)) in all.filter(|(campaign, (compared, _))| seen(campaign, compared) == first) {
            whole += usize::from(first);
            let [value, low, high] = share_cells(&sums);
            let detail = campaign.run.external_engines.get(&compared.engine).map(|counts| counts.detail);
            // Where the engine gave none, that none differs says nothing.
            let is_unsaid = detail.is_some_and(|detail| detail.entrances == 0 && detail.contacts > 0);
            let cell = |count: u64| if is_unsaid { TableCell::Empty } else { count.into() };
            table.push(vec![
                campaign.name.as_str().into(),
                compared.tolerances.into(),
                TableCell::Scope(compared.engine),
                compared.span.name().into(),
                sums.pairs.into(),
                value,
                low,
                high,
                sums.silent.into(),
                sums.contacts.into(),
                cell(sums.entrance),
                cell(sums.gap_sign),
            ]);
        }
    }
    (table, whole)
}

/// Of so many settings and more a chart shows those at both ends.
const MANY: usize = 24;
/// So many of each.
const ENDS: usize = 10;

/// The settings that a chart shows: all, or where there are many those under which the worse engine is right most seldom and most often, beyond
/// chance: by the upper and by the lower end of its interval.
fn chosen(shares: &BTreeMap<String, Proportion>) -> Vec<String> {
    let mut order: Vec<(&String, &Proportion)> = shares.iter().collect();
    if order.len() >= MANY {
        order.sort_by(|(_, x), (_, y)| x.high.total_cmp(&y.high));
        let mut rest = order.split_off(ENDS);
        rest.sort_by(|(_, x), (_, y)| x.low.total_cmp(&y.low));
        order.extend(rest.split_off(rest.len() - ENDS));
    }
    order.into_iter().map(|(setting, _)| setting.clone()).collect()
}

fn by_setting(campaigns: &[CampaignRun]) -> Chart {
    let mut least: BTreeMap<String, Proportion> = BTreeMap::new();
    let mut curves = Vec::new();
    for campaign in campaigns {
        let sums = campaign.by_setting();
        let engines = campaign.engines();
        for engine in &engines {
            let span = campaign.span_of(engine);
            let of: Vec<(&str, Proportion)> = sums
                .iter()
                .filter(|(c, _)| c.span == span && c.engine == *engine && campaign.shows(&c.tolerances))
                .filter_map(|(c, s)| Some((c.tolerances.as_str(), agreeing_share(s)?)))
                .collect();
            for (setting, share) in &of {
                let known = least.entry((*setting).to_owned()).or_insert(*share);
                if share.value < known.value {
                    *known = *share;
                }
            }
            let of: Vec<(String, Proportion)> =
                of.into_iter().map(|(setting, share)| (setting.to_owned(), share)).collect();
            // Of several runs each curve has a colour of its own.
            let color = match campaigns {
                [_] => ChartColor::among(engine, &engines),
                _ => ChartColor::Series(curves.len()),
            };
            curves.push((label(campaigns.len(), &campaign.name, engine), color, of));
        }
    }
    let settings = chosen(&least);
    let data = curves.into_iter().enumerate().map(|(number, (name, color, of))| {
        let row = |setting: &String| settings.iter().position(|shown| shown == setting);
        let point = |(setting, share): &(String, Proportion)| {
            Some(ChartPoint::new(share.value * 100.0, row(setting)? as f64).with_share(share))
        };
        let points = of.iter().filter_map(point).collect();
        Curve { name, color, line: None, marker: Some(number), points }
    });
    let content = ChartContent::Curves(data.collect(), None);
    let caption = match least.len() - settings.len() {
        0 => "Agreement of each engine under each tolerance setting, with 95 % intervals".to_owned(),
        left => format!(
            "Agreement of each engine with 95 % intervals, under the {ENDS} settings where the worse engine's is least beyond chance and the {ENDS} where it is most; the {left} others are in agreement.csv"
        ),
    };
    let height = 110 + height_of_rows(&settings, 2);
    let axes = [ChartAxis::linear("pairs answered exactly right, %", [0.0, 101.0]), ChartAxis::names("", settings)];
    Chart::new("chart-agreement", caption, height, axes, content)
}

fn families(campaigns: &[CampaignRun]) -> Table {
    let mut table = Table::new(
        "families",
        "Agreement by family of pairs, over all tolerance settings.",
        &["run", "family", "engine", "compared", "pairs", "agreement", "low", "high", "no_answer"],
    );
    for campaign in campaigns {
        for ((family, span, engine), sums) in campaign.by_family() {
            let [value, low, high] = share_cells(&sums);
            let engine = TableCell::Scope(engine.to_owned());
            let names = [campaign.name.as_str().into(), family.into(), engine, span.name().into()];
            table.push(names.into_iter().chain([sums.pairs.into(), value, low, high, sums.silent.into()]).collect());
        }
    }
    table
}

fn family_map(campaigns: &[CampaignRun]) -> Chart {
    let mut columns = Vec::new();
    let mut families = BTreeSet::new();
    for campaign in campaigns {
        let sums = campaign.by_family();
        families.extend(sums.keys().map(|(family, ..)| (*family).to_owned()));
        let lines = sums.keys().map(|(_, span, engine)| (*span, (*engine).to_owned())).collect::<BTreeSet<_>>();
        for (span, engine) in lines {
            let what = if span == ChainSpan::Whole { engine.clone() } else { format!("{engine}, {span}") };
            columns.push((campaign, span, engine, label(campaigns.len(), &campaign.name, &what)));
        }
    }
    // What an engine's user sees first, then its links.
    columns.sort_by_key(|(_, span, ..)| *span != ChainSpan::Whole);
    let families: Vec<String> = families.into_iter().collect();
    let sums: Vec<_> = columns.iter().map(|(campaign, ..)| campaign.by_family()).collect();
    let shares: Vec<Vec<Option<f64>>> = families
        .iter()
        .map(|family| {
            let column = |(sums, (_, span, engine, _)): (&BTreeMap<_, AgreementCounts>, &(_, ChainSpan, String, _))| {
                agreeing_share(sums.get(&(family.as_str(), *span, engine.as_str()))?).map(|share| share.value)
            };
            sums.iter().zip(&columns).map(column).collect()
        })
        .collect();
    let names: Vec<String> = columns.into_iter().map(|(.., name)| name).collect();
    let height = 150 + 24 * families.len();
    let axes = [ChartAxis::names("", names), ChartAxis::names("", families)];
    let content =
        ChartContent::Map(HeatMap { percent: in_percent(&shares), colors_from_to: [0.0, 100.0], names_above: true });
    Chart::new(
        "chart-families",
        "Agreement by family of pairs, in percent, coloured from 0 to 100: engines first, then what each link leaves as it was",
        height,
        axes,
        content,
    )
}

/// Shares in percent.
pub(super) fn in_percent(shares: &[Vec<Option<f64>>]) -> Vec<Vec<Option<f64>>> {
    shares.iter().map(|row| row.iter().map(|share| share.map(|share| share * 100.0)).collect()).collect()
}
