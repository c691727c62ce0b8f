//! The sections of a report, each made of tables, charts and views.

mod agreement;
mod causes;
mod confusion;
mod diagnosis;
mod lockstep;
mod margins;
mod passing;
mod runs;
mod steps;
mod stress;
mod sweep;
mod timing;
mod worst;

pub use confusion::{Matrix, MatrixCell, MatrixRow};
pub use worst::{FindingContact, FindingView, ShownCase};

use super::chart::Chart;
use super::error::ReportError;
use super::latex::MAX_ROWS;
use super::load::Results;
use super::table::Table;
use super::verdict::makes_steps_alone;

/// A part of a section.
#[derive(Clone, Debug)]
pub enum SectionPart {
    /// A paragraph.
    Text(String),
    /// A paragraph about something that could not be shown, and why.
    Unreadable(String),
    /// A table, of which the page shows so many rows.
    Table(Table, usize),
    /// A table that goes into a CSV file only.
    Quiet(Table),
    /// A chart.
    Chart(Chart),
    /// Confusion matrices.
    Matrices(Vec<Matrix>),
    /// Findings to look at.
    Findings(Vec<FindingView>),
}

/// A section.
#[derive(Clone, Debug)]
pub struct Section {
    /// Its place in the page.
    pub id: &'static str,
    /// Its title.
    pub title: &'static str,
    /// What it answers, in a sentence or two.
    pub lead: String,
    /// What it holds.
    pub parts: Vec<SectionPart>,
}

impl Section {
    pub(crate) fn new(id: &'static str, title: &'static str, lead: impl Into<String>) -> Section {
        Section { id, title, lead: lead.into(), parts: Vec::new() }
    }

    /// Its tables.
    pub fn tables(&self) -> impl Iterator<Item = &Table> {
        self.printed_tables().map(|(table, _)| table)
    }

    /// Its charts.
    pub fn charts(&self) -> impl Iterator<Item = &Chart> {
        self.parts.iter().filter_map(|part| match part {
            SectionPart::Chart(chart) => Some(chart),
            _ => None,
        })
    }

    /// Its tables, and how many rows of each are printed at most.
    pub(crate) fn printed_tables(&self) -> impl Iterator<Item = (&Table, usize)> {
        self.parts.iter().filter_map(|part| match part {
            SectionPart::Table(table, most) => Some((table, *most)),
            SectionPart::Quiet(table) => Some((table, MAX_ROWS)),
            _ => None,
        })
    }
}

/// All sections that the results have something for.
///
/// # Errors
/// When a case file of a run cannot be read.
pub fn all(results: &Results) -> Result<Vec<Section>, ReportError> {
    let mut sections = Vec::new();
    // Of pairs that made steps and nothing else there is nothing to show but these.
    let has_pairs = results.campaigns.iter().any(|campaign| campaign.run.findings.total > 0)
        || !makes_steps_alone(&results.campaigns);
    if !results.campaigns.is_empty() && has_pairs {
        sections.push(agreement::section(&results.campaigns));
        sections.push(confusion::section(&results.campaigns));
        sections.push(causes::section(&results.campaigns));
        sections.extend(diagnosis::section(&results.campaigns));
        sections.push(margins::section(&results.campaigns));
        sections.push(worst::section(&results.campaigns)?);
        sections.extend(sweep::section(&results.campaigns));
    }
    sections.extend(steps::section(&results.campaigns));
    if !results.locksteps.is_empty() {
        sections.push(lockstep::section(&results.locksteps));
    }
    sections.extend(passing::section(results));
    if !results.stresses.is_empty() {
        sections.push(stress::section(&results.stresses));
    }
    if !results.timings.is_empty() {
        sections.push(timing::section(&results.timings));
    }
    sections.push(runs::section(results));
    keep_runs(&mut sections);
    Ok(sections)
}

/// Has every table name the run of its rows where the tables are of several runs: one of which only one run has rows would not say which.
fn keep_runs(sections: &mut [Section]) {
    let mut tables: Vec<&mut Table> = sections
        .iter_mut()
        .flat_map(|section| &mut section.parts)
        .filter_map(|part| match part {
            SectionPart::Table(table, _) | SectionPart::Quiet(table) => Some(table),
            _ => None,
        })
        .collect();
    let has_several = {
        let mut runs = tables.iter().flat_map(|table| table.runs());
        let first = runs.next();
        runs.any(|run| Some(run) != first)
    };
    if has_several {
        tables.iter_mut().for_each(|table| table.keeps_run = true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section(runs: &[&str]) -> Section {
        let mut table = Table::new("audit_causes", "", &["run", "step"]);
        runs.iter().for_each(|run| table.push(vec![(*run).into(), 1_u64.into()]));
        Section { parts: vec![SectionPart::Table(table, 9)], ..Section::new("audit", "", "") }
    }

    /// The first column that readers see.
    fn first(section: &Section) -> usize {
        let [SectionPart::Table(table, _)] = &section.parts[..] else { panic!("a table") };
        table.needed().start
    }

    #[test]
    fn a_table_of_one_run_names_it_where_others_are_of_another() {
        let of = |tables: &[&[&str]]| {
            let mut sections: Vec<Section> = tables.iter().map(|runs| section(runs)).collect();
            keep_runs(&mut sections);
            sections.iter().map(first).collect::<Vec<_>>()
        };
        assert_eq!(of(&[&["a", "a"], &["a"]]), [1, 1]);
        assert_eq!(of(&[&["a", "b"], &["b"]]), [0, 0]);
        assert_eq!(of(&[&["a"], &["b"], &[]]), [0, 0, 0]);
    }
}
