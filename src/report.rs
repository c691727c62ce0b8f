//! `report`: what runs found, as a page to read, tables to calculate with, and a text for a pull request.

use crate::exit::{ExitStatus, Outcome, print, print_note};
use rockproof_model::text::escaped;
use rockproof_report::markdown::markdown;
use rockproof_report::page::page;
use rockproof_report::{PAGE, Report as Made, TEXT};
use rockproof_results::Start;
use std::path::PathBuf;

/// Turn the results of runs into a page that needs no network, with its tables as CSV and LaTeX and its charts as SVG
///
/// Takes the directories of campaigns, of lockstep runs, of stress sets and of benches, in any mixture.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof report reports/campaign-1                  writes report.html, tables/, latex/ and charts/
                                                       into reports/campaign-1/report
  rockproof report reports/f32 reports/f64 --out reports/both --overwrite
  rockproof report reports/campaign-1 --format markdown >> $GITHUB_STEP_SUMMARY

Exit status: 0 done, 2 a directory is no run, is damaged, or holds a report already.")]
pub(crate) struct Report {
    /// Directories of runs
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,
    /// Directory of the report [default: RUN/report for html; markdown goes to stdout]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// What to write
    #[arg(long, value_enum, default_value_t = OutputFormat::Html)]
    format: OutputFormat,
    /// What the report is called [default: the names of the runs]
    #[arg(long)]
    title: Option<String>,
    /// Discard the report in the directory; other files there stay
    #[arg(long)]
    overwrite: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum OutputFormat {
    /// One page with charts and views; the tables as CSV and LaTeX, the charts as SVG and CSV
    Html,
    /// A short text for a pull request
    Markdown,
}

impl Report {
    pub(crate) fn run(&self) -> Outcome {
        let mut report = Made::of(&self.runs)?;
        if let Some(title) = &self.title {
            report.title = escaped(title);
        }
        for text in report.unreadable() {
            print_note(text);
        }
        let (name, contents) = match self.format {
            OutputFormat::Html => (PAGE, page(&report)?),
            OutputFormat::Markdown => (TEXT, markdown(&report)),
        };
        let out = match (&self.out, self.format, self.runs.first()) {
            (Some(out), _, _) => out.clone(),
            (None, OutputFormat::Html, Some(run)) => run.join("report"),
            (None, _, _) => {
                print(&contents)?;
                return Ok(ExitStatus::Passed);
            }
        };
        let path = report.write(&out, name, &contents, Start::of(false, self.overwrite))?;
        for line in &report.verdict {
            print(&format!("{}\n", line.text))?;
        }
        let charts = report.sections.iter().any(|section| section.charts().next().is_some());
        let beside = if charts { "tables, latex and charts" } else { "tables and latex" };
        print_note(&format!("written to {}, beside it {beside}", path.display()));
        Ok(ExitStatus::Passed)
    }
}
