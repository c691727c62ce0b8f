//! Rows of `steps.csv`, `measured.csv` and `contacts.csv`. Every number is the shortest decimal that is this f64.

use crate::audit::{self, StepAudit};
use crate::f64_vector;
use rockproof_model::text::csv_cell;
use rockproof_model::{ContactKind, Scene};
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{Mode, State, StepReport};

/// Columns of `measured.csv`.
pub const MEASURED: [&str; 9] = ["step", "time_s", "point", "x_m", "y_m", "z_m", "dx_m", "dy_m", "dz_m"];

/// Columns of `contacts.csv`.
pub const CONTACTS: [&str; 21] = [
    "step",
    "time_s",
    "block_a",
    "block_b",
    "kind",
    "feature_a",
    "feature_b",
    "entrance",
    "entrance_a",
    "entrance_b",
    "mode",
    "gap_m",
    "x_m",
    "y_m",
    "z_m",
    "normal_x",
    "normal_y",
    "normal_z",
    "force_x_N",
    "force_y_N",
    "force_z_N",
];

/// Columns of `steps.csv`: what is known of a step, its contacts by kind and mode, what the audit found.
pub fn step_columns() -> Vec<String> {
    let first = [
        "step",
        "time_s",
        "time_step_s",
        "iterations",
        "converged",
        "contacts",
        "max_penetration_m",
        "max_displacement_m",
        "kinetic_J",
        "potential_J",
        "gravitational_J",
        "elastic_J",
        "springs_J",
        "retries",
    ];
    let counts = kinds_and_modes().map(|(kind, mode)| format!("{}_{}", kind.name(), mode.name()));
    let first = first.into_iter().map(str::to_owned);
    first.chain(counts).chain(audit::COLUMNS.map(str::to_owned)).collect()
}

fn kinds_and_modes() -> impl Iterator<Item = (ContactKind, Mode)> {
    ContactKind::ALL.into_iter().flat_map(|kind| Mode::ALL.into_iter().map(move |mode| (kind, mode)))
}

/// The row of a step, with what its audit found if it has one. Retries as `reason@Δt`, with a space between.
pub fn step_row(report: &StepReport, audit: Option<&StepAudit>) -> Vec<String> {
    let StepReport { step, time, time_step, iterations, converged, .. } = report;
    let retries: Vec<String> =
        report.retries.iter().map(|retry| format!("{}@{:?}", retry.why.name(), retry.time_step)).collect();
    let contacts: u32 = report.contacts.iter().flatten().sum();
    let mut row = vec![step.to_string(), number(*time), number(*time_step), iterations.to_string()];
    row.extend([converged.to_string(), contacts.to_string()]);
    row.extend([report.max_penetration, report.max_displacement, report.kinetic, report.potential()].map(number));
    row.extend([report.gravitational, report.elastic, report.springs].map(number));
    row.push(retries.join(" "));
    row.extend(kinds_and_modes().map(|(kind, mode)| report.count(kind, mode).to_string()));
    row.extend(audit.map(StepAudit::cells).unwrap_or_default());
    row
}

/// The rows of the measured points after a step: where they are, and how far from where the scene has them.
pub fn measured_rows<R: Real>(
    scene: &Scene,
    begin: &State<R>,
    report: &StepReport,
    state: &State<R>,
) -> Vec<Vec<String>> {
    let points = scene.simulation.measured_points.iter().zip(begin.measured_points.iter().zip(&state.measured_points));
    points
        .map(|(point, (then, now))| {
            let (then, now) = (f64_vector::point(*then), f64_vector::point(*now));
            let moved = std::array::from_fn::<f64, 3, _>(|k| now[k] - then[k]);
            let mut row = vec![report.step.to_string(), number(report.time), csv_cell(&point.name)];
            row.extend(now.into_iter().chain(moved).map(number));
            row
        })
        .collect()
}

/// The rows of all contacts after a step, open ones too.
pub fn contact_rows<R: Real>(report: &StepReport, state: &State<R>) -> Vec<Vec<String>> {
    let row = |c: &rockproof_stepper::dynamics::ContactState<R>| {
        let ([block_a, block_b], contact) = (c.blocks.map(|b| b.to_string()), c.contact);
        let mut row = vec![report.step.to_string(), number(report.time), block_a, block_b];
        row.push(contact.kind().name().to_owned());
        row.extend(contact.key.numbers().map(|number| number.to_string()));
        let entrance = contact.entrance;
        row.push(entrance.kind().name().to_owned());
        row.extend(entrance.numbers().map(|number| number.to_string()));
        row.extend([c.mode.name().to_owned(), number(c.gap.to_f64())]);
        row.extend([c.points[0], c.normal, c.force].into_iter().flat_map(f64_vector::point).map(number));
        row
    };
    state.contacts.iter().map(row).collect()
}

fn number(value: f64) -> String {
    format!("{value:?}")
}

/// Rows as the lines of a CSV file.
///
/// # Errors
/// None that writing to memory has.
pub fn lines<Row, Cell>(rows: impl IntoIterator<Item = Row>) -> Result<Vec<u8>, csv::Error>
where
    Row: IntoIterator<Item = Cell>,
    Cell: AsRef<[u8]>,
{
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    for row in rows {
        writer.write_record(row)?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}
