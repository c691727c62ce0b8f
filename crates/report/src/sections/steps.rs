//! Steps of campaigns: what differs in them, how deep blocks overlap afterwards, and whether they pass through one another.

use super::sweep::order;
use super::{Section, SectionPart};
use crate::chart::{Chart, ChartAxis, ChartColor, ChartContent, ChartPoint, Curve, LineStyle};
use crate::load::{CampaignRun, setting};
use crate::table::{Table, TableCell, label};
use rockproof_campaign::steps::summary::{StepCounts, Sum};
use rockproof_pairs::tolerance_grid::axes_of;
use std::collections::{BTreeMap, BTreeSet};

/// The form of the pairs that are examined under every set.
const BASE: &str = "base";

/// Rows of each table that the page shows.
const MAX_ROWS: usize = 40;

/// The section, where pairs of a campaign made steps.
pub(super) fn section(campaigns: &[CampaignRun]) -> Option<Section> {
    if campaigns.iter().all(|run| run.steps.is_empty()) {
        return None;
    }
    let mut section = Section::new(
        "steps",
        "And if the pairs move?",
        "A share of the pairs makes a step, in each engine and exactly, from the same state: steps with other decisions than the exact \
         ones, how deep blocks overlap after either, and whether they pass through one another unseen.",
    );
    let mut differences = Table::new(
        "steps",
        "Steps by what differs from the exact step; settings made for ties are in the CSV files alone, here and below",
        &[
            "run",
            "setting",
            "engine",
            "steps",
            "contacts_differ",
            "modes_differ",
            "iterations_differ",
            "convergence_differs",
            "retries_differ",
            "state_differs",
            "not_made",
            "defects",
            "undecided",
        ],
    );
    let mut penetration = Table::new(
        "steps_penetration",
        "Exact penetration after a step of either side; relative to half the longest side of the pair",
        &[
            "run",
            "setting",
            "engine",
            "steps",
            "deeper",
            "shallower",
            "deepest_m",
            "deepest_oracle_m",
            "deepest_relative",
            "deepest_oracle_relative",
            "mean_relative",
            "mean_oracle_relative",
        ],
    );
    let mut intrusions = Table::new(
        "steps_passages",
        "Of the steps looked through (watched) those within which blocks pass through one another, and those after which they overlap where no contact sees it, by engine and exactly",
        &[
            "run",
            "setting",
            "engine",
            "watched",
            "passages",
            "passages_oracle",
            "passages_undecided",
            "unseen",
            "unseen_oracle",
            "by_step_length",
            "not_held",
        ],
    );
    // Settings that nobody would take come last, and in the tables alone.
    let mut shown = 0;
    for first in [true, false] {
        let all = campaigns.iter().flat_map(|run| by_setting(run).into_iter().map(move |row| (run, row)));
        for (run, ((setting, engine), counts)) in all.filter(|(run, ((setting, _), _))| run.shows(setting) == first) {
            shown += usize::from(first);
            let names = || [run.name.as_str(), &setting, engine].map(TableCell::from).into_iter();
            let c = &counts;
            let numbers = [
                c.compared,
                c.contacts_differ,
                c.modes_differ,
                c.iterations_differ,
                c.converged_differ,
                c.retries_differ,
                c.state_differs,
                c.stopped,
                c.defect,
                c.undecided,
            ];
            differences.push(names().chain(numbers.map(TableCell::Count)).collect());
            let [stepper, oracle] = c.depths;
            let sizes = [
                stepper.deepest,
                oracle.deepest,
                stepper.relative,
                oracle.relative,
                mean(stepper.sum, c.compared),
                mean(oracle.sum, c.compared),
            ];
            let steps = [c.compared, c.deeper, c.shallower].map(TableCell::Count);
            penetration.push(names().chain(steps).chain(sizes.map(TableCell::Number)).collect());
            let passages = [c.passages_stepper, c.passages_oracle, c.passages_undecided];
            let unseen = [c.unseen_stepper, c.unseen_oracle, c.step_length, c.not_held];
            let numbers = [c.watched].into_iter().chain(passages).chain(unseen);
            intrusions.push(names().chain(numbers.map(TableCell::Count)).collect());
        }
    }
    for table in [differences, penetration, intrusions] {
        section.parts.push(SectionPart::Table(table, shown.min(MAX_ROWS)));
    }
    for (number, run) in campaigns.iter().enumerate() {
        section.parts.extend(charts(number, run, campaigns.len()).into_iter().map(SectionPart::Chart));
    }
    Some(section)
}

fn mean(sum: Sum, count: u64) -> f64 {
    if count == 0 { 0.0 } else { sum.value() / count as f64 }
}

/// Sums over families and the rungs of ladders.
fn by_setting(run: &CampaignRun) -> BTreeMap<(String, &str), StepCounts> {
    let mut sums: BTreeMap<(String, &str), StepCounts> = BTreeMap::new();
    for (place, counts) in &run.steps {
        sums.entry((setting(&place.tolerances), &place.engine)).or_default().add(counts);
    }
    sums
}

/// Of a grid of tolerance sets, a chart for each tolerance: the mean penetration after a step over its factors. Only base pairs count:
/// they step under every set, so that the same steps are compared.
fn charts(number: usize, run: &CampaignRun, runs: usize) -> Vec<Chart> {
    let mut axes: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let mut sums: BTreeMap<(&str, &str, &str), StepCounts> = BTreeMap::new();
    for (place, counts) in run.steps.iter().filter(|(place, _)| place.form == BASE) {
        for (axis, factor) in axes_of(&place.tolerances).unwrap_or_default() {
            axes.entry(axis).or_default().insert(factor);
            sums.entry((axis, factor, &place.engine)).or_default().add(counts);
        }
    }
    let engines: BTreeSet<&str> = run.steps.iter().map(|(place, _)| place.engine.as_str()).collect();
    let known = run.engines();
    let several = axes.into_iter().filter(|(_, factors)| factors.len() > 1);
    several
        .enumerate()
        .map(|(at, (axis, factors))| {
            let mut factors: Vec<&str> = factors.into_iter().collect();
            factors.sort_by(|one, other| order(one, other));
            let mut curves: Vec<Curve> = Vec::new();
            for engine in &engines {
                for (side, name) in [(0, (*engine).to_owned()), (1, format!("exact ({engine})"))] {
                    let depth = |factor: &str| {
                        let counts = sums.get(&(axis, factor, *engine))?;
                        (counts.compared > 0).then(|| mean(counts.depths[side].sum, counts.compared))
                    };
                    let place =
                        |(at, factor): (usize, &&str)| ChartPoint::new(at as f64, depth(factor).unwrap_or(f64::NAN));
                    curves.push(Curve {
                        name,
                        color: ChartColor::among(engine, &known),
                        line: Some(if side == 0 { LineStyle::Solid } else { LineStyle::Dotted }),
                        marker: Some(curves.len()),
                        points: factors.iter().enumerate().map(place).collect(),
                    });
                }
            }
            let words = if axis == "criteria" { "criteria".to_owned() } else { format!("{axis}, times the preset's") };
            let factors = factors.into_iter().map(str::to_owned).collect();
            let axes = [ChartAxis::names(words, factors), ChartAxis::from_zero("mean penetration over half the side")];
            let caption = label(runs, &run.name, &format!("penetration after the same steps, by {axis}"));
            Chart::new(format!("chart-steps-{number}-{at}"), caption, 340, axes, ChartContent::Curves(curves, None))
        })
        .collect()
}
