//! `campaign`: generated and real pairs through every engine, differences explained, findings kept.

use crate::cli::table::{grouped, table};
use rockproof::campaign::attribution::Panel;
use rockproof::campaign::builtin;
use rockproof::campaign::compare::Change;
use rockproof::campaign::config::CampaignConfig;
use rockproof::campaign::finding::{Cause, Finding};
use rockproof::campaign::journal::{Journal, Progress, Start};
use rockproof::campaign::run::{Campaign, Ending};
use rockproof::campaign::source::{self, FamilySource};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use std::collections::BTreeMap;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Arguments of `campaign`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  rockproof campaign                                  every family, f32 and f64, all presets; about a minute
  rockproof campaign --pairs 10000 --family sliver --engine stepper-f32 --tolerances shi
  rockproof campaign --out reports/night --pairs 100000000 --resume
  rockproof campaign --deny defect --deny collapsed   for CI: exit 1 if there is such a finding

A finding's engine is `any` for a tolerance (it changes the exact answer for everyone), `f32` or `f64` for what rounding
the input does, and an engine's name for its own arithmetic.

Exit status: 0 done, 1 findings that --deny names, 2 usage or input error, 130 interrupted (go on with --resume).")]
pub(crate) struct CampaignArgs {
    /// TOML file of settings; the options below override it
    config: Option<PathBuf>,
    /// How many pairs
    #[arg(long)]
    pairs: Option<u64>,
    /// Seed of all pairs
    #[arg(long)]
    seed: Option<u64>,
    /// Directory of the results [default: reports/campaign-SEED]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Engine to examine; may be repeated [default: all]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    engine: Vec<String>,
    /// Tolerance preset; may be repeated [default: all]
    #[arg(long, value_name = "PRESET", value_delimiter = ',')]
    tolerances: Vec<String>,
    /// Family of pairs; may be repeated [default: all]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    family: Vec<String>,
    /// Block file for the family `real`; may be repeated [default: those that come with the program]
    #[arg(long, value_name = "FILE")]
    real: Vec<PathBuf>,
    /// Go on with the run in the directory, or begin if there is none
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Discard the run in the directory
    #[arg(long)]
    force: bool,
    /// Exit with 1 if there is a finding of this cause or change, or `any`; may be repeated
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    deny: Vec<String>,
    /// Worker threads [default: one a core]; the results do not depend on it
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    threads: usize,
}

/// Runs the command.
pub(crate) fn run(args: CampaignArgs) -> Result<ExitCode, CliError> {
    check_deny(&args.deny)?;
    let config = configuration(&args)?;
    let unknown = |name: String| CliError::NotOne { what: "engine", found: name, allowed: builtin::ENGINES.join(", ") };
    let panel = builtin::panel(&config.engines, config.metamorphic_every).map_err(unknown)?;
    let source = source::of(&config).map_err(|e| CliError::Other(e.to_string()))?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("reports/campaign-{}", config.seed)));
    let start = match (args.resume, args.force) {
        (true, _) => Start::Resume,
        (_, true) => Start::Force,
        _ => Start::Fresh,
    };
    let identity = source::identity(&config).map_err(|e| CliError::Other(e.to_string()))?;
    let mut journal = Journal::open(&out, identity, start)?;
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    // A second Ctrl-C ends the program at once; the journal bears it.
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .map_err(|e| CliError::Other(format!("cannot catch Ctrl-C: {e}")))?;
    let ending = work(&config, &panel, &source, args.threads, &mut journal, &stop)?;
    report(&mut std::io::stdout().lock(), &journal, ending).map_err(CliError::Print)?;
    if ending == Ending::Stopped {
        return Ok(ExitCode::from(130));
    }
    let summary = &journal.progress().summary;
    let denied = |kind: &String| if kind == "any" { summary.total() > 0 } else { summary.count_of(kind) > 0 };
    let denied: Vec<&String> = args.deny.iter().filter(|kind| denied(kind)).collect();
    for kind in &denied {
        eprintln!("denied: there are findings of kind {kind}");
    }
    Ok(if denied.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn check_deny(kinds: &[String]) -> Result<(), CliError> {
    let known = |kind: &str| kind == "any" || Cause::from_name(kind).is_some() || Change::from_name(kind).is_some();
    match kinds.iter().find(|kind| !known(kind)) {
        None => Ok(()),
        Some(kind) => {
            let names = Cause::ALL.map(Cause::name).into_iter().chain(Change::ALL.map(Change::name));
            let allowed = std::iter::once("any").chain(names).collect::<Vec<_>>().join(", ");
            Err(CliError::NotOne { what: "--deny", found: kind.clone(), allowed })
        }
    }
}

fn configuration(args: &CampaignArgs) -> Result<CampaignConfig, CliError> {
    let mut config = match &args.config {
        None => CampaignConfig::default(),
        Some(path) => {
            let file = path.display().to_string();
            let text = std::fs::read_to_string(path).map_err(|source| CliError::Read { file: file.clone(), source })?;
            CampaignConfig::from_toml(&text).map_err(|e| CliError::Toml { file, source: Box::new(e) })?
        }
    };
    config.pairs = args.pairs.unwrap_or(config.pairs);
    config.seed = args.seed.unwrap_or(config.seed);
    for (given, setting) in [
        (&args.engine, &mut config.engines),
        (&args.tolerances, &mut config.tolerances),
        (&args.family, &mut config.families),
    ] {
        if !given.is_empty() {
            setting.clone_from(given);
        }
    }
    if !args.real.is_empty() {
        config.real.clone_from(&args.real);
    }
    Ok(config)
}

fn work(
    config: &CampaignConfig,
    panel: &Panel,
    source: &FamilySource,
    threads: usize,
    journal: &mut Journal,
    stop: &AtomicBool,
) -> Result<Ending, CliError> {
    let narrow = |finding: &Finding| builtin::panel_for(&config.engines, finding);
    let campaign = Campaign { config, source, panel, narrow: &narrow, threads };
    let mut display = Display::new(config.pairs, journal.progress());
    let ending = campaign.run(journal, stop, &mut |progress| display.show(progress))?;
    display.end();
    Ok(ending)
}

/// A bar on a terminal, a line now and then otherwise.
struct Display {
    bar: Option<ProgressBar>,
    pairs: u64,
    last: Instant,
}

impl Display {
    fn new(pairs: u64, progress: &Progress) -> Display {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(pairs);
            let template = "{bar:40} {human_pos}/{human_len} pairs, {msg}, {eta} left";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.set_position(progress.pairs_done);
            bar.reset_eta();
            bar.set_message("0 findings");
            bar
        });
        Display { bar, pairs, last: Instant::now() }
    }

    fn show(&mut self, progress: &Progress) {
        let found = grouped(progress.summary.total());
        match &self.bar {
            Some(bar) => {
                bar.set_position(progress.pairs_done);
                bar.set_message(format!("{found} findings"));
            }
            None if self.last.elapsed() > Duration::from_secs(10) => {
                self.last = Instant::now();
                eprintln!("{} of {} pairs, {found} findings", grouped(progress.pairs_done), grouped(self.pairs));
            }
            None => {}
        }
    }

    fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn report(out: &mut impl Write, journal: &Journal, ending: Ending) -> std::io::Result<()> {
    let progress = journal.progress();
    let families = progress.summary.by_family();
    let rows = families
        .iter()
        .map(|(family, [examined, findings])| vec![(*family).to_owned(), grouped(*examined), grouped(*findings)]);
    writeln!(out, "{}\n", table(&["family", "examined", "findings"], &[1, 2], rows))?;
    // One row for each engine, cause and change, the kinds side by side.
    let mut sorts: BTreeMap<(&str, &str, &str), BTreeMap<&str, u64>> = BTreeMap::new();
    for (sort, count) in progress.summary.by_sort() {
        let row = sorts.entry((&sort.engine, cause_place(&sort.cause), &sort.change)).or_default();
        *row.entry(&sort.kind).or_default() += count;
    }
    let kinds = ["v-v", "v-e", "e-v", "v-f", "f-v", "e-e", ""];
    let rows = sorts.iter().map(|((engine, cause, change), counts)| {
        let mut row = vec![(*engine).to_owned(), cause[1..].to_owned(), (*change).to_owned()];
        row.extend(kinds.iter().map(|kind| counts.get(kind).map_or(String::new(), |c| grouped(*c))));
        row.push(grouped(counts.values().sum()));
        row
    });
    let header = ["engine", "cause", "change", "v-v", "v-e", "e-v", "v-f", "f-v", "e-e", "pair", "all"];
    writeln!(out, "{}\n", table(&header, &[3, 4, 5, 6, 7, 8, 9, 10], rows))?;
    let speed = progress.pairs_done as f64 / progress.seconds.max(1e-9);
    let (pairs, seconds) = (grouped(progress.pairs_done), progress.seconds);
    writeln!(
        out,
        "{pairs} pairs in {seconds:.1} s ({speed:.0} a second), {} findings",
        grouped(progress.summary.total())
    )?;
    if ending == Ending::Stopped {
        writeln!(out, "interrupted; --resume goes on")?;
    }
    let dir = journal.dir().display();
    writeln!(out, "written to {dir}: findings.csv, summary.csv, run.json")?;
    let cases: u64 = progress.cases.values().sum();
    if cases > 0 {
        writeln!(
            out,
            "{cases} shrunk findings in {dir}/cases; look at one with: rockproof replay {dir}/cases/NAME.toml"
        )?;
    }
    Ok(())
}

/// A cause with its place in the chain before it, so that rows come in the order of the chain.
fn cause_place(cause: &str) -> &'static str {
    match Cause::from_name(cause) {
        Some(Cause::Tolerance) => "0tolerance",
        Some(Cause::Representation) => "1representation",
        Some(Cause::Arithmetic) => "2arithmetic",
        Some(Cause::Defect) => "3defect",
        None => "4",
    }
}
