//! The tables and charts of the measurements.

use crate::grid::{Row, tolerance_series};
use crate::steps::{ANGLES, Approach, ClassicCrossing, Crossing};
use rockproof_bench::plot::{Legend, Marks, Plot, PlotAxis, Series};
use rockproof_campaign::proportion::wilson;
use rockproof_model::Criteria;
use std::fmt::Write;

/// The charts by the names of their files.
pub(crate) fn charts(rows: &[Row], approaches: &[Approach], crossings: &[Crossing]) -> Vec<(String, Plot)> {
    let mut all = Vec::new();
    for tolerance in tolerance_series() {
        let of = |criteria: &str, count: &dyn Fn(&Row) -> u64, name: &str| {
            let mine = rows.iter().filter(|row| row.tolerance == tolerance.name && row.criteria == criteria);
            let percent = |row: &Row| 100.0 * count(row) as f64 / row.pairs.max(1) as f64;
            let interval = |row: &Row| wilson(count(row), row.pairs).map(|end| 100.0 * end);
            let (points, intervals) = mine.map(|row| ([row.value, percent(row)], interval(row))).unzip();
            Series { name: format!("{name}, {criteria}"), points, intervals, titles: Vec::new(), marks: Marks::Joined }
        };
        let both =
            |count: &dyn Fn(&Row) -> u64, name: &str| ["revised", "classic"].map(|criteria| of(criteria, count, name));
        let mut series: Vec<Series> = both(&|row| row.changed, "types changed").into();
        series.extend(both(&|row| row.differ[0], "f32 differs"));
        series.extend(both(&|row| row.differ[1], "f64 differs"));
        let title = format!("What {} does to contact types", tolerance.name);
        all.push((
            tolerance.name.to_owned(),
            Plot {
                title,
                x: PlotAxis::linear(tolerance.label),
                y: PlotAxis::linear("pairs (%)"),
                series,
                legend: Legend::Beside,
            },
        ));
    }
    let limits = [1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0];
    let series = limits.map(|limit| {
        let mine = approaches
            .iter()
            .filter(|a| a.step_limit == limit && a.penetration == 1.0 && a.run.engine == "stepper-f64");
        let points = mine.map(|a| [a.search, a.run.depth / limit]).collect();
        Series {
            name: format!("u = {limit} of the edge"),
            points,
            intervals: Vec::new(),
            titles: Vec::new(),
            marks: Marks::Joined,
        }
    });
    let (x, y) =
        (PlotAxis::linear("search / max_displacement"), PlotAxis::linear("deepest overlap / max_displacement"));
    all.push((
        "approach".to_owned(),
        Plot {
            title: "Two blocks approach one another, g = u".to_owned(),
            x,
            y,
            series: series.into(),
            legend: Legend::Inside,
        },
    ));
    let kinds = [
        (Criteria::Revised, 0.0),
        (Criteria::Revised, 3.0),
        (Criteria::Revised, 8.0),
        (Criteria::Classic, 0.0),
        (Criteria::Classic, 3.0),
        (Criteria::Classic, 8.0),
    ];
    let series = kinds.map(|(criteria, parallel)| {
        let mine = crossings
            .iter()
            .filter(|c| c.criteria == criteria && c.parallel == parallel && c.run.engine == "stepper-f64");
        let points = mine.map(|c| [c.angle, c.run.depth]).collect();
        Series {
            name: format!("{}, parallel below {parallel}°", criteria.name()),
            points,
            intervals: Vec::new(),
            titles: Vec::new(),
            marks: Marks::Joined,
        }
    });
    let (x, y) = (PlotAxis::log("angle between the edges (degrees)"), PlotAxis::log("deepest overlap (m)"));
    all.push((
        "crossing".to_owned(),
        Plot {
            title: "A keel across a ridge of 2 m, after 0.1 s".to_owned(),
            x,
            y,
            series: series.into(),
            legend: Legend::Beside,
        },
    ));
    all
}

/// The tables as Markdown.
pub(crate) fn tables(
    rows: &[Row],
    approaches: &[Approach],
    crossings: &[Crossing],
    classic: &[ClassicCrossing],
) -> String {
    let mut text = String::from(
        "# Rules of thumb: the figures\n\nWritten by `cargo run --release --example rules_of_thumb`; [rules_of_thumb.md](rules_of_thumb.md) says what they mean.\n\n## Pairs\n\n\
         One tolerance at a time around `auto`; shares in % of the pairs. Changed: the exact contacts are not those of nearest features alone. Missed: \
         blocks that overlap by no more than `penetration` and have no contact.\n\n\
         | tolerance | value | criteria | pairs | changed | contacts | f32 differs | f64 differs | missed | deepest missed (m) | missed in |\n\
         | --- | --: | --- | --: | --: | --: | --: | --: | --: | --: | --- |\n",
    );
    // Writing to a String cannot fail.
    for row in rows {
        let share = |count: u64| 100.0 * count as f64 / row.pairs.max(1) as f64;
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {:.1} | {} | {:.1} | {:.1} | {} | {:.1e} | {} |",
            row.tolerance,
            row.value,
            row.criteria,
            row.pairs,
            share(row.changed),
            row.contacts,
            share(row.differ[0]),
            share(row.differ[1]),
            row.missed,
            row.deepest,
            row.missed_in.iter().map(String::as_str).collect::<Vec<_>>().join(", ")
        );
    }
    text.push_str(
        "\n## Two blocks approach one another\n\n4 m/s each, a full step would carry each by 0.4 of its edge. Blind: steps after which they overlap without a contact.\n\n\
         | u / edge | s / u | g / u | engine | deepest / u | blind |\n| --: | --: | --: | --- | --: | --: |\n",
    );
    for a in approaches {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {:.3} | {}{} |",
            a.step_limit,
            a.search,
            a.penetration,
            a.run.engine,
            a.run.depth / a.step_limit,
            a.run.blind,
            note(&a.run.stopped)
        );
    }
    text.push_str(
        "\n## A keel across a ridge\n\nEdges of 2 m that cross in the middle, under the upper block's weight for 0.1 s; free fall would be 0.05 m. Rule: sp·(longest edge) ≤ r.\n\n\
         | criteria | parallel below | rule kept | angle | engine | deepest (m) | blind |\n| --- | --: | --- | --: | --- | --: | --: |\n",
    );
    for c in crossings {
        let rule = if c.keeps_rule { "yes" } else { "no" };
        let _ = writeln!(
            text,
            "| {} | {}° | {rule} | {}° | {} | {:.1e} | {}{} |",
            c.criteria.name(),
            c.parallel,
            c.angle,
            c.run.engine,
            c.run.depth,
            c.run.blind,
            note(&c.run.stopped)
        );
    }
    text.push_str(
        "\n## A keel across a ridge under `classic`, by overlap angle\n\nThe same with no parallel angle, in f64: how far the keel has risen after 0.1 s (mm), by the angle between the edges. Rule: so·(longest edge) ≤ g.\n\n\
         | overlap angle | rule kept |",
    );
    text.extend(ANGLES.map(|angle| format!(" {angle}° |")));
    text.push_str(&format!("\n| --: | --- |{}\n", " --: |".repeat(ANGLES.len())));
    for c in classic {
        let risen: String = c.risen.iter().map(|risen| format!(" {} |", (1e5 * risen).round() / 1e2 + 0.0)).collect();
        let _ = writeln!(text, "| {}° | {} |{risen}", c.overlap, if c.keeps_rule { "yes" } else { "no" });
    }
    text
}

fn note(stopped: &Option<String>) -> String {
    stopped.as_ref().map_or(String::new(), |why| format!(", stopped: {why}"))
}
