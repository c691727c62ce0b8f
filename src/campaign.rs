//! `campaign`: generated and real pairs through every engine, differences explained, findings kept.

use crate::exit::{Outcome, Verdict, note, print};
use crate::input::{EngineArgs, ReadArgs};
use crate::stop::on_ctrl_c;
use crate::stress;
use crate::table::{grouped, table};
use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::engines::Engines;
use rockproof_campaign::journal::{Journal, Progress};
use rockproof_campaign::part::{Machine, Part};
use rockproof_campaign::run::{self, Ending};
use rockproof_campaign::source;
use rockproof_campaign::steps::{self, StepChange, StepSummary};
use rockproof_campaign::stress::StressSource;
use rockproof_differential::compare::Change;
use rockproof_differential::finding::{Cause, Finding};
use rockproof_differential::subject::Source;
use rockproof_results::Start;
use std::collections::BTreeMap;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Compare engines with the oracle on generated and real pairs, and explain every difference
///
/// Writes findings.csv, summary.csv, run.json and the shrunk findings in cases/; of pairs that make steps, step_findings.csv and
/// step_summary.csv.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof campaign                                  every family, f32 and f64, all presets; about a minute
  rockproof campaign --pairs 10000 --family sliver --engine stepper-f32 --tolerances shi
  rockproof campaign --family real --real cases/real/voronoi_120.txt --planarity 1e-4
  rockproof campaign --out reports/night --pairs 100000000 --resume
  rockproof campaign --part 3/8 --pairs 100000000     an eighth of it, for one of eight machines (docs/scale.md)
  rockproof campaign --deny defect --deny collapsed   for CI: exit 1 if there is such a finding
  rockproof campaign --pairs 2000 --steps-every 1 --steps 3   every pair moves for three steps (docs/campaign_steps.md)
  rockproof campaign --stress                         how far from the origin, how thin, how parallel (docs/stress.md)
  rockproof campaign --engine-command mine:f32=./client --ask-twice   your own program (docs/engines.md)

A finding's engine is `any` for a tolerance (it changes the exact answer for everyone), `f32` or `f64` for what rounding
the input does, and an engine's name for its own arithmetic.

Exit status: 0 done, 1 findings that --deny names, 2 usage or input error, 130 interrupted (go on with --resume).")]
pub(crate) struct Campaign {
    /// TOML file of settings; the options below override it
    config: Option<PathBuf>,
    /// How many pairs
    #[arg(long)]
    pairs: Option<u64>,
    /// Seed of all pairs
    #[arg(long)]
    seed: Option<u64>,
    /// Directory of the results [default: reports/campaign-SEED, of a part reports/campaign-SEED-part-K-of-N]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Engine to examine, built-in or named by --engine-command; may be repeated [default: all]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    engine: Vec<String>,
    #[command(flatten)]
    external: EngineArgs,
    /// Tolerance preset; may be repeated [default: all]
    #[arg(long, value_name = "PRESET", value_delimiter = ',')]
    tolerances: Vec<String>,
    /// Family of pairs; may be repeated [default: all]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    family: Vec<String>,
    /// Examine the stress set instead: pairs more and more extreme, and steps at rest; writes stress.csv, limits.csv, steps.csv too
    #[arg(long, conflicts_with_all = ["family", "real"])]
    stress: bool,
    /// Block file for the family `real`; may be repeated [default: those that come with the program]
    #[arg(long, value_name = "FILE")]
    real: Vec<PathBuf>,
    #[command(flatten)]
    read: ReadArgs,
    /// Do only the K-th of N parts of the pairs; `rockproof merge` makes of all parts what one campaign would have made
    #[arg(long, value_name = "K/N")]
    part: Option<Part>,
    /// Go on with the run in the directory, or begin if there is none
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Discard the campaign in the directory; other files there stay
    #[arg(long)]
    overwrite: bool,
    /// Exit with 1 if there is a finding of this cause or change, or `any`; may be repeated
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    deny: Vec<String>,
    /// One pair in this many makes steps as well; 0 for none
    #[arg(long, value_name = "N")]
    steps_every: Option<u64>,
    /// How many steps such a pair makes
    #[arg(long, value_name = "COUNT")]
    steps: Option<u32>,
    /// Worker threads [default: one a core]; the results do not depend on it
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    threads: usize,
}

impl Campaign {
    pub(crate) fn run(&self) -> Outcome {
        check_deny(&self.deny)?;
        let config = self.configuration()?;
        let engines = Engines::of(&config)?;
        let source: Box<dyn Source> = match config.stress {
            true => Box::new(StressSource::new(config.seed, &config.tolerances)?),
            false => Box::new(source::of(&config)?),
        };
        engines.probe()?;
        let name = if config.stress { "stress" } else { "campaign" };
        let suffix = self.part.map_or(String::new(), |part| format!("-part-{}-of-{}", part.number(), part.of()));
        let out = || PathBuf::from(format!("reports/{name}-{}{suffix}", config.seed));
        let out = self.out.clone().unwrap_or_else(out);
        let (start, identity) = (Start::of(self.resume, self.overwrite), source::identity(&config)?);
        let mut journal = match self.part {
            None => Journal::open(&out, identity, start)?,
            Some(part) => Journal::open_part(&out, identity, start, part, Machine::here(&*source)?)?,
        };
        let stop = on_ctrl_c()?;
        let ending = work(&config, &engines, &*source, (self.part, self.threads), &mut journal, &stop)?;
        tell(&journal, ending)?;
        if ending == Ending::Stopped {
            return Ok(Verdict::Interrupted);
        }
        if let Some(part) = self.part {
            print(&format!(
                "part {part}: when all parts are done, put them together with: rockproof merge DIR… --out DIR\n"
            ))?;
        } else if config.stress {
            stress::finish(&mut journal, &engines)?;
        }
        Ok(denied(&self.deny, journal.progress()))
    }

    fn configuration(&self) -> anyhow::Result<CampaignConfig> {
        let mut config = match &self.config {
            None => CampaignConfig::default(),
            Some(path) => {
                let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
                CampaignConfig::from_toml(&text).with_context(|| path.display().to_string())?
            }
        };
        config.stress |= self.stress;
        if config.stress {
            anyhow::ensure!(
                config.families.is_empty() && config.real.is_empty(),
                "the stress set has pairs of its own: no families"
            );
            if self.config.is_none() {
                (config.pairs, config.metamorphic_every, config.cases_per_cause) =
                    (StressSource::default_pairs(), 0, 8);
            }
        }
        config.pairs = self.pairs.unwrap_or(config.pairs);
        config.seed = self.seed.unwrap_or(config.seed);
        config.steps_every = self.steps_every.unwrap_or(config.steps_every);
        config.steps = self.steps.unwrap_or(config.steps);
        self.external.add_to(&mut config)?;
        if !self.engine.is_empty() {
            let (external, builtin): (Vec<String>, Vec<String>) =
                self.engine.iter().cloned().partition(|name| config.external.iter().any(|spec| spec.name == *name));
            config.engines = builtin;
            config.external.retain(|spec| external.contains(&spec.name));
        }
        for (given, setting) in [(&self.tolerances, &mut config.tolerances), (&self.family, &mut config.families)] {
            if !given.is_empty() {
                setting.clone_from(given);
            }
        }
        if !self.real.is_empty() {
            config.real.clone_from(&self.real);
        }
        if let Some(planarity) = self.read.options().planarity {
            anyhow::ensure!(!config.real.is_empty(), "--planarity is about the files of --real, and there are none");
            config.planarity = Some(planarity);
        }
        Ok(config)
    }
}

/// The tables at the end of a campaign.
pub(crate) fn tell(journal: &Journal, ending: Ending) -> anyhow::Result<()> {
    let mut text = Vec::new();
    report(&mut text, journal, ending)?;
    print(&String::from_utf8_lossy(&text))
}

/// Whether there are findings of a kind that `--deny` names.
pub(crate) fn denied(kinds: &[String], progress: &Progress) -> Verdict {
    let (summary, steps) = (&progress.summary, &progress.steps);
    let found = |kind: &&String| match kind.as_str() {
        "any" => summary.total() + steps.total() > 0,
        kind => summary.count_of(kind) + steps.count_of(kind) > 0,
    };
    let found: Vec<&String> = kinds.iter().filter(found).collect();
    for kind in &found {
        note(&format!("denied: there are findings of kind {kind}"));
    }
    if found.is_empty() { Verdict::Fine } else { Verdict::Objection }
}

pub(crate) fn check_deny(kinds: &[String]) -> anyhow::Result<()> {
    let known = |kind: &str| kind == "any" || Cause::from_name(kind).is_some() || StepChange::is_known(kind);
    if let Some(kind) = kinds.iter().find(|kind| !known(kind)) {
        let names =
            Cause::ALL.map(Cause::name).into_iter().chain(Change::ALL.map(Change::name)).chain(StepChange::NAMES);
        let allowed = std::iter::once("any").chain(names).collect::<Vec<_>>().join(", ");
        anyhow::bail!("--deny {kind}: no such kind; known are {allowed}");
    }
    Ok(())
}

fn work(
    config: &CampaignConfig,
    engines: &Engines,
    source: &dyn Source,
    (part, threads): (Option<Part>, usize),
    journal: &mut Journal,
    stop: &AtomicBool,
) -> anyhow::Result<Ending> {
    let narrow = |finding: &Finding| engines.panel_for(finding);
    let panel = engines.panel();
    let names = engines.names();
    let steppers = steps::engines(names.iter().map(String::as_str));
    let campaign = run::Campaign { config, source, panel: &panel, narrow: &narrow, steppers: &steppers, threads };
    let share = part.map_or(0..config.pairs, |part| part.pairs(config.pairs, source.batch_len()));
    let mut display = Display::new(share.end - share.start, journal.progress());
    let mut watch = |progress: &Progress| display.show(progress);
    let ending = match part {
        None => campaign.run(journal, stop, &mut watch),
        Some(part) => campaign.run_part(part, journal, stop, &mut watch),
    }?;
    display.end();
    Ok(ending)
}

/// A bar on a terminal, a line now and then otherwise.
pub(crate) struct Display {
    bar: Option<ProgressBar>,
    pairs: u64,
    last: Instant,
}

impl Display {
    pub(crate) fn new(pairs: u64, progress: &Progress) -> Display {
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

    pub(crate) fn show(&mut self, progress: &Progress) {
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

    pub(crate) fn end(&self) {
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
    if !progress.steps.is_empty() {
        writeln!(out, "{}\n", steps_table(&progress.steps))?;
    }
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
    let tables = if progress.steps.is_empty() { "" } else { "step_findings.csv, step_summary.csv, " };
    writeln!(out, "written to {dir}: findings.csv, summary.csv, {tables}run.json")?;
    let cases: u64 = progress.cases.values().sum();
    if cases > 0 {
        writeln!(
            out,
            "{cases} shrunk findings in {dir}/cases; look at one with: rockproof replay {dir}/cases/NAME.toml"
        )?;
    }
    let cases: u64 = progress.step_cases.values().sum();
    if cases > 0 {
        writeln!(out, "{cases} steps in {dir}/cases; look at one with: rockproof replay {dir}/cases/NAME.json")?;
    }
    Ok(())
}

/// One row for each engine: its steps, and how many of them differ from the exact ones.
fn steps_table(steps: &StepSummary) -> String {
    let rows = steps.by_engine().into_iter().map(|(engine, counts)| {
        let numbers = [
            counts.compared,
            counts.contacts_differ,
            counts.modes_differ,
            counts.iterations_differ,
            counts.retries_differ,
            counts.deeper,
            counts.shallower,
            counts.defect,
        ];
        std::iter::once(engine.to_owned()).chain(numbers.map(grouped)).collect()
    });
    let header =
        ["engine", "steps", "other contacts", "modes", "iterations", "retries", "deeper", "shallower", "defects"];
    table(&header, &[1, 2, 3, 4, 5, 6, 7, 8], rows).to_string()
}

/// A cause with its place in the chain before it, so that rows come in the order of the chain.
fn cause_place(cause: &str) -> &'static str {
    match Cause::from_name(cause) {
        Some(Cause::Tolerance) => "0tolerance",
        Some(Cause::Representation) => "1representation",
        Some(Cause::Arithmetic) => "2arithmetic",
        Some(Cause::Defect) => "3defect",
        Some(Cause::Engine) => "4engine",
        None => "5",
    }
}
