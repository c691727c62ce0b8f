//! The numbers of a chart as CSV.

use super::{Chart, ChartAxis, ChartContent};
use rockproof_model::text::csv_cell;

/// The numbers that a chart shows, as they are and not as they are drawn: `series`, `x` and `y`, `low` and `high` where it has intervals, and what is said of a point under the pointer as `note`;
/// of a heat map `x`, `y` and `percent`. Names stand for themselves; what has no value is left blank.
///
/// # Errors
/// Those of the CSV writer.
pub fn csv(chart: &Chart) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    match &chart.content {
        ChartContent::Curves(curves, _) => {
            let points = || curves.iter().flat_map(|curve| &curve.points);
            let intervals = points().any(|point| point.interval.is_some());
            let notes = points().any(|point| !point.note.is_empty());
            let wanted = |row: [String; 6]| {
                let kept = [true, true, true, intervals, intervals, notes];
                row.into_iter().zip(kept).filter_map(|(cell, kept)| kept.then_some(cell)).collect::<Vec<_>>()
            };
            writer.write_record(wanted(["series", "x", "y", "low", "high", "note"].map(str::to_owned)))?;
            for curve in curves {
                for point in &curve.points {
                    let [low, high] = point.interval.map_or([String::new(), String::new()], |ends| ends.map(number));
                    let [x, y] = [cell(&chart.x, point.x), cell(&chart.y, point.y)];
                    writer.write_record(wanted([csv_cell(&curve.name), x, y, low, high, csv_cell(&point.note)]))?;
                }
            }
        }
        ChartContent::Bars(series) => {
            writer.write_record(["series", "x", "y"])?;
            for series in series {
                for (at, count) in series.counts.iter().enumerate() {
                    let count = count.to_string();
                    let name = |axis| cell(axis, at as f64);
                    let [x, y] = match chart.x.as_names() {
                        Some(_) => [name(&chart.x), count],
                        None => [count, name(&chart.y)],
                    };
                    writer.write_record([csv_cell(&series.name), x, y])?;
                }
            }
        }
        ChartContent::Map(map) => {
            writer.write_record(["x", "y", "percent"])?;
            for (row, shares) in map.percent.iter().enumerate() {
                for (column, share) in shares.iter().enumerate() {
                    let share = share.map_or(String::new(), number);
                    writer.write_record([cell(&chart.x, column as f64), cell(&chart.y, row as f64), share])?;
                }
            }
        }
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

/// The shortest text that gives the value back; nothing where there is none.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { String::new() }
}

/// A value as it stands on its axis.
fn cell(axis: &ChartAxis, value: f64) -> String {
    match axis.as_names() {
        Some(names) => names.get(value as usize).map_or(String::new(), |name| csv_cell(name)),
        None => number(value),
    }
}
