//! From results on disk to one page that opens without a network, its tables as CSV and LaTeX and its charts as pictures, and a short text for a pull
//! request (docs/report.md).
//!
//! Reading, counting and showing are apart: [`load`] and its neighbours read runs and say where one is damaged; [`sections`] makes
//! tables, charts and views of them; [`page`] and [`markdown`] write these down.

pub mod chart;
pub mod comparison;
pub mod detail_change;
pub mod error;
pub mod external_findings;
pub mod glossary;
pub mod latex;
pub mod load;
pub mod lockstep;
pub mod markdown;
pub mod model_view;
pub mod motion;
mod motion_verdict;
pub mod page;
mod pair_numbers;
mod rows;
mod safe_levels;
pub mod sections;
pub mod step_tally;
pub mod step_verdict;
pub mod stress;
pub mod table;
pub mod tally;
pub mod timing;
pub mod verdict;
pub mod view;

use error::ReportError;
use load::Results;
use rockproof_results::{Claim, Directory, FileKind, Owner, Start};
use sections::{Section, SectionPart};
use std::path::{Path, PathBuf};
use verdict::VerdictLine;

/// A report, ready to be written.
#[derive(Debug)]
pub struct Report {
    /// What it is about, in a few words.
    pub title: String,
    /// The verdict: a few lines, and one more for each external engine.
    pub verdict: Vec<VerdictLine>,
    /// The sections.
    pub sections: Vec<Section>,
}

/// The name of the page in the output directory.
pub const PAGE: &str = "report.html";
/// The name of the text in the output directory.
pub const TEXT: &str = "report.md";
/// The name of the directory of the tables in it.
pub const TABLES: &str = "tables";
/// The name of the directory of the same tables in LaTeX.
pub const LATEX: &str = "latex";
/// The name of the directory of the charts as pictures, and of their numbers as CSV.
pub const CHARTS: &str = "charts";

impl Report {
    /// The report on the runs in these directories.
    ///
    /// # Errors
    /// When one is no run, is damaged, or was made by another version.
    pub fn of(dirs: &[PathBuf]) -> Result<Report, ReportError> {
        let results = Results::read(dirs)?;
        let names = results.campaigns.iter().map(|run| &run.name);
        let names = names.chain(results.locksteps.iter().map(|run| &run.name));
        let names = names.chain(results.without_lockstep().map(|run| &run.name));
        let names = names.chain(results.stresses.iter().map(|run| &run.name));
        let names = names.chain(results.timings.iter().map(|run| &run.name));
        let mut names: Vec<&str> = names.map(String::as_str).collect();
        names.dedup();
        let title = match names.len() {
            0..=3 => names.join(", "),
            n => format!("{} and {} more runs", names[..2].join(", "), n - 2),
        };
        Ok(Report { title, verdict: verdict::verdict(&results), sections: sections::all(&results)? })
    }

    /// What could not be shown, and why: cases that are damaged.
    pub fn unreadable(&self) -> impl Iterator<Item = &str> {
        self.sections.iter().flat_map(|section| &section.parts).filter_map(|part| match part {
            SectionPart::Unreadable(text) => Some(text.as_str()),
            _ => None,
        })
    }

    /// Writes the tables and charts into `dir`, and the page or the text beside them. A report that is there already is replaced where
    /// `start` says so; files that are no part of it stay.
    ///
    /// # Errors
    /// When the directory holds something that may not be touched, or cannot be written.
    pub fn write(&self, dir: &Path, name: &str, contents: &str, start: Start) -> Result<PathBuf, ReportError> {
        let tables: Vec<(&table::Table, usize)> = self.sections.iter().flat_map(Section::printed_tables).collect();
        let path =
            |table: &table::Table| [format!("{TABLES}/{}.csv", table.name), format!("{LATEX}/{}.tex", table.name)];
        let names: Vec<[String; 2]> = tables.iter().map(|(table, _)| path(table)).collect();
        let charts: Vec<&chart::Chart> = self.sections.iter().flat_map(Section::charts).collect();
        let path = |chart: &chart::Chart| ["svg", "csv"].map(|kind| format!("{CHARTS}/{}.{kind}", chart.stem()));
        let pictures: Vec<[String; 2]> = charts.iter().map(|chart| path(chart)).collect();
        let files = names.iter().chain(&pictures).flatten().map(String::as_str);
        let files: Vec<&str> = files.chain([name]).collect();
        let mut directory = Directory::claim(Claim { dir, owner: Owner::Report, start, files: &files })?;
        directory.make_folder(TABLES)?;
        directory.make_folder(LATEX)?;
        for ((table, most), [csv, tex]) in tables.iter().zip(&names) {
            directory.write(csv, FileKind::Table, table.to_csv()?.as_ref())?;
            directory.write(tex, FileKind::Text, latex::latex(table, *most).as_bytes())?;
        }
        if !charts.is_empty() {
            directory.make_folder(CHARTS)?;
        }
        for (chart, [picture, values]) in charts.iter().zip(&pictures) {
            let drawn = chart::svg::svg(chart).map_err(ReportError::Drawing)?;
            directory.write(picture, FileKind::Picture, drawn.as_bytes())?;
            directory.write(values, FileKind::Table, &chart::values::csv(chart)?)?;
        }
        directory.write(name, FileKind::Text, contents.as_bytes())?;
        Ok(dir.join(name))
    }
}
