//! Where floats stop agreeing with the exact answer: the stress set.

use super::{Section, SectionPart};
use crate::chart::{
    Chart, ChartAxis, ChartColor, ChartContent, ChartPoint, Curve as ChartCurve, LineStyle, LogScale, PointLook,
};
use crate::safe_levels::{SafeLevels, alignment_words, noun, power, safe_levels};
use crate::stress::{Curve, StressCell, StressLimit, StressRun, StressStep};
use crate::table::{Table, TableCell, label, percent};
use rockproof_campaign::stress::table::{Proof, SAFE_SHARE};
use rockproof_campaign::stress::{PairAlignment, StressAxis};
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn section(runs: &[StressRun]) -> Section {
    let mut section = Section::new(
        "stress",
        "Where do the floats stop agreeing?",
        "Pairs of blocks made more extreme in one way at a time, level by level, until the engine's contacts for the rounded input are no \
         longer the exact contacts of the exact input. Safe to a level: up to there the share of pairs that differ is at most 1 %, with \
         95 % confidence. Blocks \"with ties\" are drawn on a grid, faces flush and corners on edges; those \"without\" are turned or shifted at random.",
    );
    for run in runs {
        for words in limits_in_words(run) {
            section.parts.push(SectionPart::Text(label(runs.len(), &run.name, &words)));
        }
    }
    for (number, run) in runs.iter().enumerate() {
        for axis in StressAxis::ALL {
            section.parts.extend(chart(number, run, axis, runs.len()).map(|chart| SectionPart::Chart(chart.half())));
        }
    }
    section.parts.push(SectionPart::Table(limits(runs), 60));
    for (number, run) in runs.iter().enumerate() {
        let asked = [
            ("rest", "steps made", "A block at rest: relative error of its overlap after so many steps"),
            (
                "contrast",
                "ratio of the stiffnesses",
                "Stiff contacts above soft ones: relative error of the small overlap",
            ),
        ];
        for (case, axis, what) in asked {
            let id = format!("chart-stress-{number}-{case}");
            let of: Vec<&StressStep> = run.steps.iter().filter(|step| step.case == case).collect();
            if of.iter().any(|step| step.error.is_some()) {
                section
                    .parts
                    .push(SectionPart::Chart(steps_chart(id, label(runs.len(), &run.name, what), axis, &of).half()));
            }
        }
    }
    section.parts.push(SectionPart::Quiet(cells(runs)));
    section.parts.push(SectionPart::Quiet(steps(runs)));
    section
}

/// What the levels of an axis are, short enough for a phone.
fn levels_are(axis: StressAxis) -> &'static str {
    match axis {
        StressAxis::Offset => "distance over size of the pair",
        StressAxis::ScaleDown | StressAxis::ScaleUp => "factor on every coordinate",
        StressAxis::Ratio => "size over size",
        StressAxis::Sliver => "thickness over length",
        StressAxis::Angle => "angle, rad",
    }
}

/// A paragraph for each engine, setting and form.
fn limits_in_words(run: &StressRun) -> Vec<String> {
    let mut groups: BTreeMap<(&str, &str, PairAlignment), Vec<&StressLimit>> = BTreeMap::new();
    for limit in &run.limits {
        let Curve { form, setting, engine, .. } = &limit.curve;
        groups.entry((engine, setting, *form)).or_default().push(limit);
    }
    groups
        .into_iter()
        .rev()
        .map(|((engine, setting, form), limits)| {
            let SafeLevels { safe, never, untold } = safe_levels(limits.into_iter());
            let list = |all: &[String]| all.join("; ");
            let mut words = format!("{engine}, {} ({setting}): ", alignment_words(form));
            words += &match (safe.is_empty(), untold.is_empty()) {
                (false, _) => format!("safe {}", list(&safe)),
                (true, true) => "safe nowhere".to_owned(),
                (true, false) => "safe nowhere that is known".to_owned(),
            };
            if !untold.is_empty() {
                words += &format!(". Too few pairs to tell: {}", list(&untold));
            }
            if !never.is_empty() {
                words += &format!(". Not even at the mildest level: {}", list(&never));
            }
            words + "."
        })
        .collect()
}

fn text_of(level: Option<&String>) -> TableCell {
    level.map_or(TableCell::Empty, |level| TableCell::Text(power(level)))
}

fn limits(runs: &[StressRun]) -> Table {
    let mut table = Table::new(
        "stress_limits",
        "How far each engine agrees. safe to, none differs to: the last level before the first that is not safe, or at which any pair differs; \
         beyond: the first level that is not proven safe, and the share of pairs that differ there; pairs needed: so many at that level would tell, if the \
         share stays what it is",
        &[
            "run",
            "axis",
            "engine",
            "pairs_are",
            "safe_to",
            "beyond",
            "differ_beyond",
            "beyond_is",
            "pairs_needed",
            "none_differs_to",
            "pairs_to_safe",
            "setting",
        ],
    );
    for run in runs {
        for limit in &run.limits {
            let Curve { axis, form, setting, engine } = &limit.curve;
            table.push(vec![
                run.name.as_str().into(),
                axis.name().into(),
                engine.as_str().into(),
                alignment_words(*form).into(),
                text_of(limit.safe_to.as_ref()),
                text_of(limit.beyond.as_ref().map(|(level, _)| level)),
                limit.beyond.as_ref().map_or(TableCell::Empty, |(_, share)| TableCell::Share(*share)),
                match limit.proof {
                    Proof::Safe => TableCell::Empty,
                    Proof::Unsafe => "not safe".into(),
                    Proof::TooFew { .. } => "too few pairs to tell".into(),
                },
                match limit.proof {
                    Proof::TooFew { needed: Some(needed) } => TableCell::Count(needed),
                    _ => TableCell::Empty,
                },
                text_of(limit.clean_to.as_ref()),
                limit.pairs.into(),
                setting.as_str().into(),
            ]);
        }
    }
    table
}

fn cells(runs: &[StressRun]) -> Table {
    let mut table = Table::new(
        "stress",
        "Pairs that differ, level by level",
        &[
            "run",
            "axis",
            "level",
            "form",
            "setting",
            "engine",
            "pairs",
            "representation",
            "arithmetic",
            "lost",
            "differ",
            "share",
            "low",
            "high",
        ],
    );
    for run in runs {
        for cell in &run.cells {
            let Curve { axis, form, setting, engine } = &cell.curve;
            let names =
                [run.name.as_str(), axis.name(), &cell.level, form.name(), setting, engine].map(TableCell::from);
            let [representation, arithmetic, lost] = cell.sorts;
            let counts = [cell.pairs, representation, arithmetic, lost, cell.differ].map(TableCell::Count);
            let shares = [share_of(cell), cell.interval[0], cell.interval[1]].map(TableCell::Share);
            table.push(names.into_iter().chain(counts).chain(shares).collect());
        }
    }
    table
}

fn steps(runs: &[StressRun]) -> Table {
    let mut table = Table::new(
        "stress_steps",
        "Steps against closed forms",
        &["run", "case", "motion", "engine", "level", "relative_error", "stopped"],
    );
    for run in runs {
        for step in &run.steps {
            let names = [run.name.as_str(), &step.case, &step.motion, &step.engine].map(TableCell::from);
            let stopped =
                if step.stopped.is_empty() { TableCell::Empty } else { TableCell::Text(step.stopped.clone()) };
            table.push(
                names
                    .into_iter()
                    .chain([TableCell::Number(step.level), TableCell::number(step.error), stopped])
                    .collect(),
            );
        }
    }
    table
}

fn share_of(cell: &StressCell) -> f64 {
    cell.differ as f64 / cell.pairs.max(1) as f64
}

/// The colour of an engine in a run.
fn color_of(run: &StressRun, engine: &str) -> ChartColor {
    let engines: BTreeSet<&str> = run.cells.iter().map(|cell| &*cell.curve.engine).collect();
    ChartColor::of_engine(engine, engines.iter().position(|known| *known == engine).unwrap_or(0))
}

/// The share that differs over the levels of an axis. Nothing lies at 0 on a logarithmic scale: it is drawn at the lower end, marked so.
fn chart(number: usize, run: &StressRun, axis: StressAxis, runs: usize) -> Option<Chart> {
    let of: Vec<&StressCell> = run.cells.iter().filter(|cell| cell.curve.axis == axis && cell.pairs > 0).collect();
    let mut levels: Vec<String> = Vec::new();
    for cell in &of {
        let level = power(&cell.level);
        if !levels.contains(&level) {
            levels.push(level);
        }
    }
    if levels.is_empty() {
        return None;
    }
    let least = of.iter().map(|cell| share_of(cell)).filter(|share| *share > 0.0).fold(0.01, f64::min) * 100.0;
    let decade = (least.log10() - 1e-9).floor() as i32;
    let floor = 10f64.powi(decade);
    let settings: BTreeSet<&str> = of.iter().map(|cell| &*cell.curve.setting).collect();
    let mut curves: BTreeMap<&Curve, Vec<&StressCell>> = BTreeMap::new();
    for cell in &of {
        curves.entry(&cell.curve).or_default().push(cell);
    }
    let data = curves.into_iter().enumerate().map(|(number, (curve, cells))| {
        let point = |cell: &&StressCell| {
            let [low, high] = cell.interval.map(percent);
            let level = power(&cell.level);
            ChartPoint {
                x: levels.iter().position(|known| *known == level).unwrap_or(0) as f64,
                y: share_of(cell) * 100.0,
                interval: Some(cell.interval.map(|end| end * 100.0)),
                look: if cell.differ == 0 { PointLook::Open } else { PointLook::Plain },
                note: format!(
                    "{level}: {} of {} differ: {} ({low} to {high})",
                    cell.differ,
                    cell.pairs,
                    percent(share_of(cell))
                ),
            }
        };
        let set = if settings.len() > 1 { format!(", {}", curve.setting) } else { String::new() };
        let generic = curve.form == PairAlignment::Generic;
        ChartCurve {
            name: format!("{}, {}{set}", curve.engine, alignment_words(curve.form)),
            color: color_of(run, &curve.engine),
            line: Some(if generic { LineStyle::Solid } else { LineStyle::Dotted }),
            marker: Some(number),
            points: cells.iter().map(point).collect(),
        }
    });
    let content = ChartContent::Curves(data.collect(), Some(100.0 * SAFE_SHARE));
    let zero = std::iter::once((floor, "0".to_owned()));
    let named = (decade + 1..=2).map(|k| (10f64.powi(k), 10f64.powi(k).to_string()));
    let scale = LogScale {
        decades: Some([f64::from(decade) - 0.1, 2.1]),
        zero: Some(floor),
        ticks: zero.chain(named).collect(),
    };
    let axes = [ChartAxis::names(levels_are(axis), levels.clone()), ChartAxis::log("pairs that differ, %", scale)];
    let what = format!("{}: pairs that differ; safe where the interval ends below the dashed line", noun(axis));
    let caption = label(runs, &run.name, &what);
    Some(Chart::new(format!("chart-stress-{number}-{}", axis.name()), caption, 380, axes, content))
}

fn steps_chart(id: String, caption: String, axis: &str, of: &[&StressStep]) -> Chart {
    let mut curves: BTreeMap<(&str, &str), Vec<[f64; 2]>> = BTreeMap::new();
    for step in of {
        if let Some(error) = step.error {
            curves.entry((&step.engine, &step.motion)).or_default().push([step.level, error]);
        }
    }
    let curves = curves.into_iter().enumerate().map(|(number, ((engine, motion), points))| ChartCurve {
        name: format!("{engine}, {motion}"),
        color: ChartColor::of_engine(engine, 0),
        line: Some(if motion == "rigid" { LineStyle::Solid } else { LineStyle::Dotted }),
        marker: Some(number),
        points: points.into_iter().map(|[x, y]| ChartPoint::new(x, y)).collect(),
    });
    let axes = [ChartAxis::log(axis, LogScale::default()), ChartAxis::log("relative error", LogScale::default())];
    Chart::new(id, caption, 340, axes, ChartContent::Curves(curves.collect(), None))
}
