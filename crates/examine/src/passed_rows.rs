//! Rows of the tables of loads that steps pass by.

use rockproof_model::simulation::PointLoad;
use rockproof_model::{Number, Scene};

/// The most rows named.
const MAX_NAMED: usize = 3;

/// The rows of load tables that no step need see, since those before and after them are no longer apart than a step; `None` where there is none.
///
/// A step takes the force at its end. A row bears on it only where a step ends between the row before and the row after; where these are no more than one step apart,
/// none need end there, and one at most does. The first row holds from the beginning: it is passed by where the next comes within the first step, but for settling, which takes the
/// force of time 0. **A row is not meant where the force is as it would be without it**, nor the first where no component of it is larger than that of the next: a load that begins with time.
pub fn passed_rows(scene: &Scene) -> Option<String> {
    let control = &scene.simulation.control;
    let step = &control.time_step;
    let of_load = |load: &PointLoad| -> Vec<String> {
        let time = |row: usize| &load.table[row].0;
        let is_within = |from: &Number, to: &Number| to.plus(&from.negated()) <= *step;
        let is_passed = |row: usize| match row {
            _ if *time(row + 1) <= Number::ZERO => false,
            0 => {
                control.settle == 0
                    && is_within(&Number::ZERO, time(1))
                    && (0..3).any(|k| force(load, 0)[k].abs() > force(load, 1)[k].abs())
            }
            _ => is_within(time(row - 1), time(row + 1)) && bends(load, row),
        };
        let said = |row: usize| {
            let place = match row {
                0 => format!("before {} s", time(1).approximate()),
                _ => format!("between {} and {} s", time(row - 1).approximate(), time(row + 1).approximate()),
            };
            format!("row {} of block {}, {} s, {place}", row + 1, load.block, time(row).approximate())
        };
        (0..load.table.len() - 1).filter(|&row| is_passed(row)).map(said).collect()
    };
    let rows: Vec<String> = scene.simulation.loads.iter().flat_map(of_load).collect();
    let more = rows.len().saturating_sub(MAX_NAMED);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    let named = rows.iter().take(MAX_NAMED).map(String::as_str).collect::<Vec<_>>().join("; ");
    (!rows.is_empty()).then(|| {
        format!(
            "steps of {} s may pass by rows of load tables, since each takes the force at its end ({named}{more}): use a shorter time_step",
            step.approximate()
        )
    })
}

fn force(load: &PointLoad, row: usize) -> [f64; 3] {
    load.table[row].1.components().map(Number::approximate)
}

/// Whether the force at a row is another than a straight line from the row before to the row after has there.
fn bends(load: &PointLoad, row: usize) -> bool {
    let [before, now, after] = [row - 1, row, row + 1].map(|row| (load.table[row].0.approximate(), force(load, row)));
    let share = (now.0 - before.0) / (after.0 - before.0);
    (0..3).any(|k| {
        let straight = before.1[k] + share * (after.1[k] - before.1[k]);
        (now.1[k] - straight).abs() > 1e-9 * now.1[k].abs().max(straight.abs())
    })
}
