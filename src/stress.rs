//! The end of `campaign --stress`: pairs counted by cell, the limits that follow, and steps against closed forms, for people and for programs.

use crate::exit::print_note;
use crate::table::{grouped, prose, table};
use anyhow::Context;
use rockproof_campaign::engines::Engines;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::proportion::wilson;
use rockproof_campaign::stress::steps::{self, ClosedFormCheck, REST};
use rockproof_campaign::stress::table::{AgreementLimit, CellRow, Proof, cells_csv, limits, limits_csv, rows};
use rockproof_campaign::stress::{StressLevel, StressSource};
use rockproof_model::files::open_table;
use serde_json::{Value, json};

/// What the stress set came to.
pub(crate) struct StressEnd {
    /// What an engineer needs.
    pub(crate) text: String,
    /// The tables for programs: `cells`, `limits` and `steps`.
    pub(crate) document: Value,
}

/// Writes stress.csv, limits.csv and steps.csv into the directory of a finished campaign, and gives what is to be printed.
pub(crate) fn finish(journal: &mut Journal, engines: &Engines) -> anyhow::Result<StressEnd> {
    let path = journal.dir().join("findings.csv");
    let findings = open_table(&path).with_context(|| path.display().to_string())?;
    let rows = rows(&journal.progress().summary, findings, &engines.precisions())?;
    let limits = limits(&rows);
    journal.write("stress.csv", &cells_csv(&rows)?)?;
    journal.write("limits.csv", &limits_csv(&limits)?)?;
    print_note(&format!("{} steps at rest, and stiff contacts above soft ones", grouped(REST[REST.len() - 1])));
    let measured = steps::measure(REST[REST.len() - 1])?;
    journal.write("steps.csv", &steps::to_csv(&measured)?)?;
    let dir = journal.dir().display();
    let text = format!(
        "\n{}\n{}\n{}\nwritten to {dir}: stress.csv, limits.csv, steps.csv (docs/stress.md says what they hold)\n",
        limits_table(&limits),
        too_few(&limits),
        steps_table(&measured)
    );
    let document = json!({
        "cells": rows.iter().map(cell_json).collect::<Vec<_>>(),
        "limits": limits.iter().map(limit_json).collect::<Vec<_>>(),
        "steps": measured.iter().map(step_json).collect::<Vec<_>>(),
    });
    Ok(StressEnd { text, document })
}

fn cell_json(row: &CellRow) -> Value {
    json!({
        "axis": row.cell.axis.name(), "level": row.cell.level.to_string(), "form": row.cell.form.name(), "tolerances": row.tolerances,
        "engine": row.engine, "pairs": row.pairs, "representation": row.representation, "arithmetic": row.arithmetic, "lost": row.lost,
        "differ": row.differ, "interval": wilson(row.differ, row.pairs),
    })
}

fn limit_json(limit: &AgreementLimit) -> Value {
    let (pairs, differ, high) = limit.up_to_safe;
    let level = |level: Option<StressLevel>| level.map(|level| level.to_string());
    let (proof, needed) = match limit.proof {
        Proof::Safe => ("safe", None),
        Proof::Unsafe => ("not safe", None),
        Proof::TooFew { needed } => ("too few pairs", needed),
    };
    json!({
        "axis": limit.axis.name(), "form": limit.form.name(), "tolerances": limit.tolerances, "engine": limit.engine,
        "clean_to": level(limit.clean), "safe_to": level(limit.safe), "pairs_to_safe": pairs, "differ_to_safe": differ,
        "high_to_safe": (pairs > 0).then_some(high), "beyond": level(limit.beyond.map(|(level, _)| level)),
        "share_beyond": limit.beyond.map(|(_, share)| share), "beyond_is": limit.beyond.map(|_| proof), "pairs_needed": needed,
    })
}

fn step_json(m: &ClosedFormCheck) -> Value {
    // What was not reached is no number, which JSON has as null.
    json!({
        "case": m.case, "motion": m.motion.name(), "engine": m.engine, "level": m.level, "overlap_m": m.overlap, "expected_m": m.expected,
        "relative_error": m.error(), "drift_m": m.drift, "unconverged": m.unconverged, "stopped": m.stopped,
    })
}

/// Where there are too few pairs to tell, and how many would be needed; empty where there is no such place.
fn too_few(limits: &[AgreementLimit]) -> String {
    let needed = limits.iter().filter_map(|limit| match limit.proof {
        Proof::TooFew { needed } => Some(needed),
        Proof::Safe | Proof::Unsafe => None,
    });
    let needed: Vec<Option<u64>> = needed.collect();
    // What is at the limit itself has no figure; what is near it would cost more than it is worth.
    let Some(least) = needed.iter().flatten().min() else { return String::new() };
    prose(&format!(
        "too few pairs to tell at {} of {} limits; {least} pairs a level are enough for the first: --pairs {}\n",
        needed.len(),
        limits.len(),
        StressSource::pairs_for(*least)
    ))
}

fn limits_table(limits: &[AgreementLimit]) -> String {
    let rows = limits.iter().map(|limit| {
        let (pairs, differ, high) = limit.up_to_safe;
        let level = |level: Option<StressLevel>| level.map_or("nowhere".to_owned(), |l| l.to_string());
        let beyond = match (limit.beyond, limit.proof) {
            (None, _) => "not tried".to_owned(),
            (Some((at, _)), Proof::TooFew { needed: None }) => format!("near 1 % at {at}"),
            (Some((at, _)), Proof::TooFew { needed: Some(needed) }) => {
                format!("too few pairs at {at}, {} would do", grouped(needed))
            }
            (Some((at, share)), _) => format!("{:.1} % at {at}", 100.0 * share),
        };
        let safe = match (limit.safe, limit.proof) {
            (None, Proof::TooFew { .. }) => "not known".to_owned(),
            (safe, _) => level(safe),
        };
        let below = if pairs == 0 { String::new() } else { format!("{:.2} %", 100.0 * high) };
        let start = [limit.axis.name(), limit.form.name(), &limit.tolerances, &limit.engine].map(str::to_owned);
        let counts = [level(limit.clean), safe, grouped(differ), grouped(pairs), below, beyond];
        start.into_iter().chain(counts).collect()
    });
    let header = [
        "axis",
        "pairs are",
        "tolerances",
        "engine",
        "none differs to",
        "safe to",
        "differ",
        "of",
        "so below",
        "beyond",
    ];
    table(&header, &[4, 5, 6, 7, 8, 9], rows)
}

fn steps_table(measured: &[ClosedFormCheck]) -> String {
    let shown = |value: f64| if value.is_finite() { format!("{value:.1e}") } else { String::new() };
    let rows = measured.iter().map(|m| {
        let start = [m.case, m.motion.name(), m.engine].map(str::to_owned);
        let figures = [
            grouped(m.level),
            if m.overlap.is_finite() { format!("{:.3e}", m.overlap) } else { String::new() },
            format!("{:.3e}", m.expected),
            shown(m.error()),
            shown(m.drift),
            m.stopped.clone().unwrap_or_else(|| format!("{} unconverged", m.unconverged)),
        ];
        start.into_iter().chain(figures).collect()
    });
    let header = ["case", "motion", "engine", "level", "overlap (m)", "expected (m)", "error", "drift (m)", "steps"];
    table(&header, &[3, 4, 5, 6, 7], rows)
}
