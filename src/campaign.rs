//! `campaign`: generated and real pairs through every engine, differences explained, findings kept.

use crate::campaign_end::print_end;
use crate::exit::{Outcome, Verdict, note};
use crate::input::{EngineArgs, ReadArgs, threads};
use crate::stop::on_ctrl_c;
use crate::stress;
use crate::table::grouped;
use anyhow::Context;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::engines::{Engines, EnginesError};
use rockproof_campaign::journal::{Journal, Seen};
use rockproof_campaign::run::{self, Ending};
use rockproof_campaign::source;
use rockproof_campaign::steps::{self, StepChange};
use rockproof_campaign::stress::StressSource;
use rockproof_differential::compare::Change;
use rockproof_differential::finding::{Cause, Finding};
use rockproof_differential::lockstep::StepCause;
use rockproof_differential::subject::Source;
use rockproof_gate::config::RECOVERED;
use rockproof_model::files::read_text;
use rockproof_results::Start;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
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
  rockproof campaign --tolerances mine.toml           your own tolerances, in a file as `check` takes it
  rockproof campaign --out reports/night --pairs 100000000 --resume      more pairs for a run that is there
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
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    pairs: Option<u64>,
    /// Seed of all pairs
    #[arg(long)]
    seed: Option<u64>,
    /// Directory of the results [default: reports/campaign-SEED]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Engine to examine, built-in or named by --engine-command; may be repeated [default: all]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    engine: Vec<String>,
    #[command(flatten)]
    external: EngineArgs,
    /// Tolerance preset (auto, shi, zero) or TOML file of tolerances; may be repeated [default: the presets, and sets made for ties]
    #[arg(long, value_name = "PRESET|FILE", value_delimiter = ',')]
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
    /// Go on with the run in the directory, with more pairs if --pairs says so, or begin if there is none
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Discard the campaign in the directory; other files there stay
    #[arg(long)]
    overwrite: bool,
    /// Exit with 1 if there is a finding of this cause or change, or `any`; `recovered` for failures of engines that did not repeat; may be repeated
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    deny: Vec<String>,
    /// One pair in this many makes steps as well; 0 for none
    #[arg(long, value_name = "N")]
    steps_every: Option<u64>,
    /// How many steps such a pair makes
    #[arg(long, value_name = "COUNT")]
    steps: Option<u32>,
    /// Worker threads [default: one a core]; the results do not depend on it
    #[arg(long, default_value_t = 0, hide_default_value = true, value_parser = threads)]
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
        let name = if config.stress { "stress" } else { "campaign" };
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from(format!("reports/{name}-{}", config.seed)));
        let start = Start::of(self.resume, self.overwrite);
        let stop = on_ctrl_c()?;
        match engines.probe() {
            Err(_) if stop.load(Ordering::SeqCst) => return Ok(Verdict::Interrupted),
            probed => probed?,
        }
        let mut journal = Journal::open(&out, source::identity(&config)?, start)?;
        let ending = work(&config, &engines, &*source, self.threads, &mut journal, &stop)?;
        if config.stress && ending == Ending::Finished {
            stress::finish(&mut journal, &engines)?;
        }
        print_end(&journal, &config.external, ending)?;
        if ending == Ending::Stopped {
            return Ok(Verdict::Interrupted);
        }
        let (summary, steps) = (&journal.progress().summary, &journal.progress().steps);
        let denied = |kind: &&String| match kind.as_str() {
            "any" => summary.total() + steps.total() > 0,
            RECOVERED => journal.progress().engines.values().any(|counts| counts.recovered > 0),
            kind => summary.count_of(kind) + steps.count_of(kind) > 0,
        };
        let denied: Vec<&String> = self.deny.iter().filter(denied).collect();
        for kind in &denied {
            let what = if *kind == RECOVERED { "failures that were" } else { "findings of kind" };
            note(&format!("denied: there are {what} {kind}"));
        }
        Ok(if denied.is_empty() { Verdict::Fine } else { Verdict::Objection })
    }

    fn configuration(&self) -> anyhow::Result<CampaignConfig> {
        let mut config = match &self.config {
            None => CampaignConfig::default(),
            Some(path) => {
                let here = || path.display().to_string();
                let config = CampaignConfig::from_toml(&read_text(path).with_context(here)?).with_context(here)?;
                check_names(&config).with_context(here)?;
                config
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
        anyhow::ensure!(
            config.pairs > 0,
            "pairs is 0; allowed are 1 and more: where nothing is asked nothing is found"
        );
        config.seed = self.seed.unwrap_or(config.seed);
        config.steps_every = self.steps_every.unwrap_or(config.steps_every);
        config.steps = self.steps.unwrap_or(config.steps);
        self.external.add_to(&mut config)?;
        if !self.engine.is_empty() {
            config.engines.clone_from(&self.engine);
            config.external.retain(|spec| self.engine.contains(&spec.name));
        }
        config.settle_engines();
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

/// Checks the names in a file of settings, before options override any: whatever comes after is about the options.
fn check_names(config: &CampaignConfig) -> anyhow::Result<()> {
    match Engines::of(config) {
        // An option may name one.
        Ok(_) | Err(EnginesError::None { .. }) => {}
        Err(error) => return Err(error.into()),
    }
    let names = CampaignConfig { real: Vec::new(), ..config.clone() };
    source::of(&names).map(drop).map_err(anyhow::Error::new)
}

fn check_deny(kinds: &[String]) -> anyhow::Result<()> {
    let known = |kind: &str| {
        ["any", RECOVERED].contains(&kind) || StepCause::from_name(kind).is_some() || StepChange::is_known(kind)
    };
    if let Some(kind) = kinds.iter().find(|kind| !known(kind)) {
        let causes = Cause::ALL.map(Cause::name).into_iter().chain(StepCause::NAMES);
        let names = causes.chain(Change::ALL.map(Change::name)).chain(StepChange::NAMES);
        let allowed = ["any", RECOVERED].into_iter().chain(names).collect::<Vec<_>>().join(", ");
        anyhow::bail!("--deny {kind}: no such kind; known are {allowed}");
    }
    Ok(())
}

fn work(
    config: &CampaignConfig,
    engines: &Engines,
    source: &dyn Source,
    threads: usize,
    journal: &mut Journal,
    stop: &AtomicBool,
) -> anyhow::Result<Ending> {
    let narrow = |finding: &Finding| engines.panel_for(finding);
    let panel = engines.panel();
    let names = engines.names();
    let steppers = steps::engines(names.iter().map(String::as_str));
    let campaign = run::Campaign { config, source, panel: &panel, narrow: &narrow, steppers: &steppers, threads };
    let display = Display::new(config.pairs, journal.seen());
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| display.show_until(&ended));
        let _ends = Ends(&ended);
        Ok(campaign.run(journal, stop, &mut |_| {})?)
    })
}

/// Ends the display when work ends, however it ends.
struct Ends<'e>(&'e AtomicBool);

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A bar on a terminal, a line now and then otherwise; from the first pair on.
struct Display {
    bar: Option<ProgressBar>,
    pairs: u64,
    seen: Arc<Seen>,
}

/// How often a bar moves.
const MOVES: Duration = Duration::from_millis(200);
/// How often there is a line.
const LINES: Duration = Duration::from_secs(10);

impl Display {
    fn new(pairs: u64, seen: Arc<Seen>) -> Display {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(pairs);
            let template = "{bar:40} {human_pos}/{human_len} pairs, {msg}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.set_position(seen.pairs.load(Ordering::Relaxed));
            bar.reset_eta();
            bar
        });
        Display { bar, pairs, seen }
    }

    fn show_until(&self, ended: &AtomicBool) {
        let mut last = Instant::now();
        while !ended.load(Ordering::Relaxed) {
            let (pairs, told) = (self.seen.pairs.load(Ordering::Relaxed), self.told());
            match &self.bar {
                Some(bar) => {
                    bar.set_position(pairs);
                    // There is no telling before anything is done.
                    let left = bar.eta();
                    let left = if left.is_zero() { String::new() } else { format!(", {} left", HumanDuration(left)) };
                    bar.set_message(format!("{told}{left}"));
                }
                None if last.elapsed() > LINES => {
                    last = Instant::now();
                    note(&format!("{} of {} pairs, {told}", grouped(pairs), grouped(self.pairs)));
                }
                None => {}
            }
            std::thread::park_timeout(MOVES);
        }
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn told(&self) -> String {
        let shrinking = if self.seen.shrinking.load(Ordering::Relaxed) { ", shrinking some" } else { "" };
        format!("{} findings{shrinking}", grouped(self.seen.findings.load(Ordering::Relaxed)))
    }
}
