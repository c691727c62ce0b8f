//! `total`: the counts of several directories added up.

use crate::{Verdict, print};
use comfy_table::{CellAlignment, Table, TableComponent, presets};
use rockproof_differential::engine::Levels;
use rockproof_report::table::grouped;
use rockproof_validation::self_comparison::tally::Tally;
use rockproof_validation::self_comparison::total::{LISTED, Total};
use std::fmt::Write;
use std::path::PathBuf;

/// Add up directories of `run`: parts of one comparison or of several, finished, stopped or under way
#[derive(clap::Args)]
pub(crate) struct TotalArgs {
    /// Directories that `run` made; no pair may be in two of them
    #[arg(required = true, value_name = "DIR")]
    dirs: Vec<PathBuf>,
    /// What to print on stdout
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Format {
    /// For people
    Text,
    /// For programs
    Json,
}

impl TotalArgs {
    pub(crate) fn run(&self) -> anyhow::Result<Verdict> {
        let total = Total::of(&self.dirs)?;
        match self.format {
            Format::Text => print(&text(&total))?,
            Format::Json => print(&(serde_json::to_string_pretty(&total)? + "\n"))?,
        }
        verdict(&total)
    }
}

/// What a total comes to.
///
/// # Errors
/// When nothing was compared: that says nothing of anybody.
pub(crate) fn verdict(total: &Total) -> anyhow::Result<Verdict> {
    let all = total.totals.all();
    anyhow::ensure!(all.compared() > 0, "nothing is compared yet: there is no verdict");
    Ok(if all.disagreements == 0 { Verdict::Agreed } else { Verdict::Disagreed })
}

/// The total for people.
pub(crate) fn text(total: &Total) -> String {
    let mut out = String::new();
    let all = total.totals.all();
    let (pairs, done) = total.pairs();
    let verdict = match (all.disagreements, all.compared()) {
        (0, 0) => "no verdict yet".to_owned(),
        (0, _) => "no disagreement".to_owned(),
        (1, _) => "1 DISAGREEMENT".to_owned(),
        (n, _) => format!("{} DISAGREEMENTS", grouped(n)),
    };
    let seeds: std::collections::BTreeSet<u64> = total.directories.iter().map(|count| count.plan.seed).collect();
    let seeds: Vec<String> = seeds.iter().map(u64::to_string).collect();
    let [done, pairs, compared] = [done, pairs, all.compared()].map(grouped);
    // Writing to a string cannot fail.
    let _ =
        writeln!(out, "{verdict} in {compared} comparisons; {done} of {pairs} pairs done, seed {}", seeds.join(", "));
    let _ = writeln!(out, "{}\n", table(total));
    let levels = Levels::NAMES.into_iter().zip(total.totals.levels);
    let levels: Vec<String> = levels.map(|(level, count)| format!("{level} {}", grouped(count))).collect();
    let _ = writeln!(out, "signs decided by the fast path, by level: {}", levels.join(", "));
    for row in &total.first_disagreements {
        let input = if row.input == "exact" { String::new() } else { format!(" as {} sees it", row.input) };
        let _ = writeln!(
            out,
            "{} says {} {} of seed {}, pair {}{input}, {} under {}{}{}",
            row.path,
            row.change,
            row.kind,
            row.seed,
            row.index,
            row.family,
            row.tolerances,
            if row.case.is_empty() { "" } else { ": " },
            row.case
        );
    }
    if all.disagreements > LISTED as u64 {
        let _ = writeln!(out, "and more, in disagreements.csv of the directories");
    }
    out
}

const HEADER: [&str; 9] =
    ["family", "as made", "as f32 sees them", "with contacts", "at ties", "plain", "GMP", "collapsed", "disagreements"];

fn table(total: &Total) -> Table {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_HORIZONTAL_ONLY);
    table.remove_style(TableComponent::HorizontalLines);
    table.remove_style(TableComponent::MiddleIntersections);
    table.set_header(HEADER);
    let row = |name: &str, tally: Tally| {
        let counts = tally.by_name().map(|(_, count)| grouped(count));
        std::iter::once(name.to_owned()).chain(counts).collect::<Vec<String>>()
    };
    for (family, tally) in &total.totals.families {
        table.add_row(row(family, *tally));
    }
    table.add_row(row("all", total.totals.all()));
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}
