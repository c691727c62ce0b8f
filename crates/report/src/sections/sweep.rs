//! What each tolerance does: campaigns over a grid of tolerance sets.

use super::agreement::in_percent;
use super::{Section, SectionPart};
use crate::chart::{Chart, ChartAxis, ChartColor, ChartContent, ChartPoint, Curve, HeatMap, LineStyle};
use crate::load::{CampaignRun, agreeing_share};
use crate::table::{Table, TableCell, label};
use rockproof_campaign::proportion::Proportion;
use rockproof_differential::agreement::{AgreementCounts, ChainSpan};
use rockproof_pairs::tolerance_grid::axes_of;
use std::collections::{BTreeMap, BTreeSet};

/// A set of a grid, without the rungs of ladders: axis by axis.
type Point<'r> = Vec<(&'r str, &'r str)>;

/// A grid that a campaign went over: its axes, and the sums at each point for each curve.
struct Sweep<'r> {
    run: &'r CampaignRun,
    /// The factors of each axis, in numerical order.
    axes: Vec<(&'r str, Vec<&'r str>)>,
    curves: BTreeMap<(ChainSpan, &'r str), Vec<(Point<'r>, AgreementCounts)>>,
}

/// The section, where a campaign went over a grid.
pub(super) fn section(campaigns: &[CampaignRun]) -> Option<Section> {
    let sweeps: Vec<Sweep<'_>> = campaigns.iter().filter_map(Sweep::of).collect();
    if sweeps.is_empty() {
        return None;
    }
    let mut section = Section::new(
        "sweep",
        "What does each tolerance do?",
        "A preset with its tolerances multiplied by factors. Each curve is the share of pairs whose contacts stay what they are: \
         \"tolerance\" compares the exact contacts without and with the set, an engine's name the exact contacts with those it gives \
         under the same set. Over all values of the other tolerances of the grid.",
    );
    let mut table = Table::new(
        "sweep",
        "Agreement at every point of the grid",
        &["run", "setting", "engine", "compared", "pairs", "agreement", "low", "high"],
    );
    let least = least_percent(&sweeps);
    for (number, sweep) in sweeps.iter().enumerate() {
        for (at, (axis, factors)) in sweep.axes.iter().enumerate() {
            section
                .parts
                .push(SectionPart::Chart(sweep.lines([number, at], axis, factors, least, campaigns.len()).half()));
        }
        for (one, other) in pairs_of(sweep.axes.len()) {
            section.parts.extend(
                sweep
                    .maps(number, [one, other], least, campaigns.len())
                    .into_iter()
                    .map(|map| SectionPart::Chart(map.half())),
            );
        }
        for ((span, engine), points) in &sweep.curves {
            for (point, sums) in points {
                let Some(Proportion { value, low, high }) = agreeing_share(sums) else { continue };
                let setting: Vec<String> = point.iter().map(|(axis, factor)| format!("{axis}*{factor}")).collect();
                let engine = TableCell::Scope((*engine).to_owned());
                let names = [sweep.run.name.as_str().into(), setting.join(" ").into(), engine, span.name().into()];
                let shares = [value, low, high].map(TableCell::Share);
                table.push(names.into_iter().chain([sums.pairs.into()]).chain(shares).collect());
            }
        }
    }
    section.parts.push(SectionPart::Quiet(table));
    Some(section)
}

/// The first few pairs of axes: more maps than these nobody reads.
fn pairs_of(axes: usize) -> Vec<(usize, usize)> {
    (0..axes).flat_map(|one| (one + 1..axes).map(move |other| (one, other))).take(3).collect()
}

/// Where the axes and colours of all charts of the sweeps begin, in percent: a round number below whatever they show, so that shares are compared from
/// chart to chart.
fn least_percent(sweeps: &[Sweep<'_>]) -> f64 {
    let sums = sweeps.iter().flat_map(|sweep| sweep.curves.values().flatten());
    let shares = sums.filter_map(|(_, sums)| agreeing_share(sums));
    let least = shares.map(|share| share.low * 100.0).fold(100.0, f64::min);
    [99.0, 98.0, 95.0, 90.0, 80.0, 60.0].into_iter().find(|round| *round <= least).unwrap_or(0.0)
}

/// Factors are numbers, criteria are words.
pub(super) fn order(one: &str, other: &str) -> std::cmp::Ordering {
    match (one.parse::<f64>(), other.parse::<f64>()) {
        (Ok(one), Ok(other)) => one.total_cmp(&other),
        _ => one.cmp(other),
    }
}

impl<'r> Sweep<'r> {
    fn of(run: &'r CampaignRun) -> Option<Sweep<'r>> {
        let mut curves: BTreeMap<(ChainSpan, &str), BTreeMap<Point<'_>, AgreementCounts>> = BTreeMap::new();
        let mut factors: Vec<(&str, BTreeSet<&str>)> = Vec::new();
        for (_, compared, sums) in &run.agreement {
            if compared.tolerances.contains(':') {
                continue;
            }
            let Some(point) = axes_of(&compared.tolerances) else { continue };
            for (axis, factor) in &point {
                match factors.iter_mut().find(|(known, _)| known == axis) {
                    Some((_, known)) => known.insert(factor),
                    None => {
                        factors.push((axis, BTreeSet::from([*factor])));
                        true
                    }
                };
            }
            // What users see, and what the tolerances do; the links between are in agreement.csv.
            if matches!(compared.span, ChainSpan::Tolerance | ChainSpan::Whole) {
                curves.entry((compared.span, &compared.engine)).or_default().entry(point).or_default().add(sums);
            }
        }
        let mut axes: Vec<(&str, Vec<&str>)> =
            factors.into_iter().map(|(axis, known)| (axis, known.into_iter().collect())).collect();
        for (_, known) in &mut axes {
            known.sort_by(|one, other| order(one, other));
        }
        axes.retain(|(_, known)| known.len() > 1);
        let curves = curves.into_iter().map(|(key, points)| (key, points.into_iter().collect())).collect();
        (!axes.is_empty()).then_some(Sweep { run, axes, curves })
    }

    fn sums(points: &[(Point<'_>, AgreementCounts)], wanted: &[(&str, &str)]) -> AgreementCounts {
        let mut all = AgreementCounts::default();
        for (_, sums) in points.iter().filter(|(point, _)| wanted.iter().all(|w| point.contains(w))) {
            all.add(sums);
        }
        all
    }

    fn curve_name(span: ChainSpan, engine: &str) -> String {
        if span == ChainSpan::Whole { engine.to_owned() } else { format!("{span} ({engine})") }
    }

    fn lines(&self, ids: [usize; 2], axis: &str, factors: &[&str], least: f64, runs: usize) -> Chart {
        let engines = self.run.engines();
        let links = self.curves.keys().filter(|(span, _)| *span != ChainSpan::Whole);
        let links: Vec<&(ChainSpan, &str)> = links.collect();
        let curves = self.curves.iter().enumerate().map(|(at, (key, points))| {
            let (span, engine) = key;
            let place = |(at, factor): (usize, &&str)| {
                let share = agreeing_share(&Self::sums(points, &[(axis, factor)]))?;
                Some(ChartPoint::new(at as f64, share.value * 100.0).with_share(&share))
            };
            let line = if *span == ChainSpan::Whole { LineStyle::Solid } else { LineStyle::Dotted };
            Curve {
                name: Self::curve_name(*span, engine),
                // An engine has its colour in every chart; what the links leave has those behind.
                color: match links.iter().position(|link| *link == key) {
                    None => ChartColor::among(engine, &engines),
                    Some(place) => ChartColor::Series(2 + place),
                },
                line: Some(line),
                marker: Some(at),
                points: factors.iter().enumerate().filter_map(place).collect(),
            }
        });
        let content = ChartContent::Curves(curves.collect(), None);
        let words = if axis == "criteria" { "criteria".to_owned() } else { format!("{axis}, times the preset's") };
        let factors = factors.iter().map(|factor| (*factor).to_owned()).collect();
        let axes = [ChartAxis::names(words, factors), ChartAxis::linear("pairs, %", [least, 100.5])];
        let [number, at] = ids;
        let caption = label(runs, &self.run.name, &format!("pairs whose contacts stay what they are, by {axis}"));
        Chart::new(format!("chart-sweep-{number}-{at}"), caption, 380, axes, content)
    }

    fn maps(&self, number: usize, [one, other]: [usize; 2], least: f64, runs: usize) -> Vec<Chart> {
        let ((x_axis, x), (y_axis, y)) = (&self.axes[one], &self.axes[other]);
        let mut charts = Vec::new();
        for (at, ((span, engine), points)) in self.curves.iter().enumerate() {
            let shares: Vec<Vec<Option<f64>>> = y
                .iter()
                .map(|fy| {
                    let share = |fx: &&str| agreeing_share(&Self::sums(points, &[(x_axis, fx), (y_axis, fy)]));
                    x.iter().map(|fx| share(fx).map(|share| share.value)).collect()
                })
                .collect();
            let names = |title: &str, factors: &[&str]| {
                ChartAxis::names(title, factors.iter().map(|factor| (*factor).to_owned()).collect())
            };
            let axes = [names(x_axis, x), names(y_axis, y)];
            let what = format!(
                "{}: {x_axis} against {y_axis}, percent of pairs, coloured from {least} to 100",
                Self::curve_name(*span, engine)
            );
            let id = format!("chart-sweep-{number}-{one}-{other}-{at}");
            let content = ChartContent::Map(HeatMap {
                percent: in_percent(&shares),
                colors_from_to: [least, 100.0],
                names_above: false,
            });
            charts.push(Chart::new(id, label(runs, &self.run.name, &what), 130 + 36 * y.len(), axes, content));
        }
        charts
    }
}
