//! Run time against error.

use super::{Section, SectionPart};
use crate::chart::{Chart, ChartAxis, ChartColor, ChartContent, ChartPoint, Curve, LineStyle, LogScale, PointLook};
use crate::safe_levels::power;
use crate::table::{Table, TableCell, short};
use crate::timing::{Measurement, TimingRun};
use std::collections::BTreeSet;

pub(super) fn section(runs: &[TimingRun]) -> Section {
    let mut section = Section::new(
        "timing",
        "What does accuracy cost?",
        "Run time against error. Ringed, and joined by the line, is what is efficient: nothing else measured there is both faster and less \
         wrong. What is exact lies at the lower edge. Times are those of one machine; compare them with one another only.",
    );
    let mut table = Table::new(
        "timing",
        "Run time against error",
        &["run", "case", "engine", "tolerances", "time_step_s", "seconds_per_unit", "error", "error_of", "efficient"],
    );
    for (number, run) in runs.iter().enumerate() {
        for (n, case) in run.cases().into_iter().enumerate() {
            section.parts.push(SectionPart::Chart(chart(format!("chart-timing-{number}-{n}"), run, case).half()));
        }
        for m in &run.measurements {
            table.push(vec![
                run.name.as_str().into(),
                m.case.as_str().into(),
                m.engine.as_str().into(),
                m.tolerances.as_str().into(),
                TableCell::number(m.time_step_s),
                TableCell::Number(m.seconds),
                TableCell::Number(m.error),
                m.error_of.as_str().into(),
                if m.efficient { "yes".into() } else { TableCell::Empty },
            ]);
        }
    }
    section.parts.push(SectionPart::Table(table, 60));
    let blank: u64 = runs.iter().map(|run| run.blank).sum();
    if blank > 0 {
        section.parts.push(SectionPart::Text(format!(
            "{blank} measurements have no figure, for the run stopped; bench.csv says why."
        )));
    }
    section
}

fn chart(id: String, run: &TimingRun, case: &str) -> Chart {
    let of: Vec<&Measurement> = run.measurements.iter().filter(|m| m.case == case).collect();
    // A logarithmic axis has no zero: what is exact lies below the least error.
    let least = of.iter().map(|m| m.error).filter(|e| *e > 0.0).fold(f64::INFINITY, f64::min);
    let exact = of.iter().any(|m| m.error == 0.0);
    let most = of.iter().map(|m| m.error).fold(least, f64::max);
    let [low, high] = if least.is_finite() { [least.log10().floor(), most.log10().ceil()] } else { [0.0, 0.0] };
    let bottom = if exact { low - 1.0 } else { low };
    let floor = 10f64.powf(bottom);
    let text = |m: &&Measurement| {
        let error = if m.error == 0.0 { "exact".to_owned() } else { format!("error {:.3e}", m.error) };
        format!("{}: {} µs, {error}", set_up(m), short(m.seconds * 1e6))
    };
    let point = |m: &&Measurement| ChartPoint {
        x: m.seconds * 1e6,
        y: m.error,
        interval: None,
        look: if m.efficient { PointLook::Ringed(text(m)) } else { PointLook::Plain },
        note: text(m),
    };
    // Of the whole run, so that an engine looks the same in every chart.
    let engines: BTreeSet<&str> = run.measurements.iter().map(|m| &*m.engine).collect();
    let mut curves: Vec<Curve> = Vec::new();
    for (at, engine) in engines.into_iter().enumerate() {
        let mut of: Vec<&Measurement> = of.iter().filter(|m| m.engine == engine).copied().collect();
        of.sort_by(|m, n| m.seconds.total_cmp(&n.seconds));
        if !of.is_empty() {
            curves.push(Curve {
                name: engine.to_owned(),
                color: ChartColor::of_engine(engine, at),
                line: None,
                marker: Some(at),
                points: of.iter().map(point).collect(),
            });
        }
    }
    let mut front: Vec<&Measurement> = of.iter().filter(|m| m.efficient).copied().collect();
    front.sort_by(|m, n| m.seconds.total_cmp(&n.seconds));
    curves.push(Curve {
        name: "efficient".to_owned(),
        color: ChartColor::Muted,
        line: Some(LineStyle::DashedSteps),
        marker: None,
        points: front.iter().map(|m| ChartPoint::new(m.seconds * 1e6, m.error)).collect(),
    });
    let error_of = of.first().map_or("", |m| m.error_of.as_str());
    // At most eight decades are named; what is exact lies one below the least.
    let every = (((high - low) / 8.0).ceil() as usize).max(1);
    let named = (low as i32..=high as i32).rev().step_by(every);
    let mut ticks: Vec<(f64, String)> = named.map(|k| (10f64.powi(k), power(&format!("1e{k}")))).collect();
    if exact {
        ticks.push((floor, "0".to_owned()));
    }
    let errors = LogScale { decades: Some([bottom - 0.3, high.max(bottom + 1.0) + 0.3]), zero: Some(floor), ticks };
    let title = if error_of.is_empty() { "error".to_owned() } else { format!("error: {error_of}") };
    let axes = [ChartAxis::log("time for a step or a pair, µs", LogScale::default()), ChartAxis::log(title, errors)];
    let content = ChartContent::Curves(curves, None);
    Chart::new(id, format!("{case}: run time against error"), 380, axes, content)
}

/// What was measured: the engine, its tolerances, and its Δt where it has one.
fn set_up(m: &Measurement) -> String {
    let step = m.time_step_s.map_or(String::new(), |dt| format!(", Δt {dt:?} s"));
    format!("{}, {}{step}", m.engine, m.tolerances)
}
