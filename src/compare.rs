//! `compare`: what changed between two runs of a campaign.

use crate::exit::{ExitStatus, Outcome, print, print_json, print_note};
use crate::table::table;
use rockproof_gate::comparison::{ClassChange, Trend};
use rockproof_model::text::noun;
use rockproof_report::PAGE;
use rockproof_report::comparison::RunComparison;
use rockproof_report::markdown::markdown;
use rockproof_report::page::page;
use rockproof_report::table::{percent, short};
use rockproof_results::{Start, setting_text};
use std::path::PathBuf;

/// Say what changed between two runs of a campaign: findings that are new, gone, more or less frequent
///
/// Two runs with the same settings examine the same pairs, so every difference comes from the program, the engines or the processor. Where
/// settings or seeds differ, a difference counts that chance does not explain, as in `gate`.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof compare reports/before reports/after
  rockproof compare reports/before reports/after --deny new,more          exits 1 where there are such
  rockproof compare reports/before reports/after --format markdown >> $GITHUB_STEP_SUMMARY
  rockproof compare reports/before reports/after --out reports/change     a page, and the tables as CSV

Exit status: 0 done, 1 a trend that --deny names, with --deny also an external engine that says less of
its contacts, an engine that takes no part any more or runs with nothing in common, 2 a directory is no finished campaign, or is damaged.")]
pub(crate) struct Compare {
    /// Directory of the run before
    before: PathBuf,
    /// Directory of the run after
    after: PathBuf,
    /// What to print
    #[arg(long, value_enum, default_value_t = OutputFormat::Text)]
    format: OutputFormat,
    /// Write a page and its tables as CSV into a directory as well
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Discard the report in that directory; other files there stay
    #[arg(long, requires = "out")]
    overwrite: bool,
    /// Exit with 1 if a sort of findings has changed so, an external engine says less of its contacts, or an engine takes no part any more; may be repeated
    #[arg(long, value_enum, value_name = "TREND", value_delimiter = ',')]
    deny: Vec<DeniedTrend>,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum OutputFormat {
    /// For people
    Text,
    /// For programs: one document (docs/formats.md)
    Json,
    /// For a pull request
    Markdown,
}

/// What `--deny` may name.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum DeniedTrend {
    /// There was none before
    New,
    /// More pairs have one
    More,
    /// As many pairs have one, but other pairs
    Other,
}

impl DeniedTrend {
    fn trend(self) -> Trend {
        match self {
            DeniedTrend::New => Trend::New,
            DeniedTrend::More => Trend::More,
            DeniedTrend::Other => Trend::Other,
        }
    }
}

/// How many sorts of findings a terminal shows.
const EXCERPT_LENGTH: usize = 24;

impl Compare {
    pub(crate) fn run(&self) -> Outcome {
        let comparison = RunComparison::of(&self.before, &self.after)?;
        match self.format {
            OutputFormat::Text => print(&text(&comparison))?,
            OutputFormat::Json => print_json(&comparison)?,
            OutputFormat::Markdown => print(&markdown(&comparison.report()))?,
        }
        if let Some(out) = &self.out {
            let report = comparison.report();
            let path = report.write(out, PAGE, &page(&report)?, Start::of(false, self.overwrite))?;
            print_note(&format!("written to {}, tables beside it in {}/tables", path.display(), out.display()));
        }
        let denied = self.deny.iter().any(|denied| comparison.count(denied.trend()) > 0);
        // Where nothing was examined by both, nothing is known; that must not pass a check.
        let unknown = !self.deny.is_empty() && comparison.examined() == 0;
        // Nor must findings that ended because an engine says less of its contacts.
        let unsaid = !self.deny.is_empty() && comparison.says_less();
        // Nor findings of an engine that takes no part any more.
        let gone: &[String] = if self.deny.is_empty() { &[] } else { comparison.gone_engines() };
        if !gone.is_empty() {
            print_note(&format!(
                "denied: {} {} part in the run before alone, so nothing is known of what is denied there",
                gone.join(", "),
                noun(gone.len(), "takes", "take")
            ));
        }
        // Nor those of one that answers far less.
        let silent: &[String] = if self.deny.is_empty() { &[] } else { &comparison.engines_silent };
        if !silent.is_empty() {
            print_note(&format!(
                "denied: {} answered less than half of the pairs of the run after, and not so before, so little was compared",
                silent.join(", ")
            ));
        }
        Ok(if denied || unknown || unsaid || !gone.is_empty() || !silent.is_empty() {
            ExitStatus::CheckFailed
        } else {
            ExitStatus::Passed
        })
    }
}

/// The verdict, the shares of right answers, and the sorts of findings that changed.
fn text(comparison: &RunComparison) -> String {
    let mut text: String = comparison.verdict().iter().map(|line| format!("{}\n", line.text)).collect();
    for change in &comparison.settings {
        let [before, after] = [&change.before, &change.after].map(|value| setting_text(value.as_ref()));
        text += &format!("{}: {before} → {after}\n", change.setting);
    }
    let changed = comparison.agreement.iter().filter(|share| share.before != share.after);
    let shares: Vec<Vec<String>> = changed
        .map(|share| {
            let [before, after] = [share.before, share.after]
                .map(|[value, low, high]| format!("{} ({} to {})", percent(value), percent(low), percent(high)));
            vec![share.setting.clone(), share.engine.clone(), before, after]
        })
        .collect();
    if !shares.is_empty() {
        text += &format!("{}\n", table(&["tolerances", "engine", "right before", "right after"], &[2, 3], shares));
    }
    let rows: Vec<&ClassChange> =
        comparison.findings.classes.iter().filter(|class| class.trend != Trend::Same).collect();
    if !rows.is_empty() {
        let header = ["", "engine", "cause", "change", "predicate", "before", "after", "chance", "pair"];
        let cells = rows.iter().take(EXCERPT_LENGTH).map(|class| {
            let name = &class.class;
            let words = [class.trend.name(), &name.engine, &name.cause, &name.change, &name.predicate];
            let counts = class.pairs.map(|pairs| pairs.to_string());
            let last =
                [class.chance.map_or(String::new(), short), class.pair.map_or(String::new(), |pair| pair.to_string())];
            words.map(str::to_owned).into_iter().chain(counts).chain(last).collect()
        });
        text += &format!("{}\n", table(&header, &[5, 6, 7, 8], cells));
        text += "before and after: pairs with such a finding; pair: one to look at\n";
    }
    if rows.len() > EXCERPT_LENGTH {
        text += &format!("{} more sorts changed; --format json or --out DIR has all\n", rows.len() - EXCERPT_LENGTH);
    }
    text
}
