//! `campaign`: generated and real pairs through every engine, differences explained, findings kept.

use crate::campaign_end::print_end;
use crate::deny::{check_deny, denied, engine_names};
use crate::doubts::tell_of_share;
use crate::exit::{ExitStatus, Outcome};
use crate::input::{EngineArgs, FormatArgs, at_least_zero};
use crate::progress::{counted_while, shown_while};
use crate::reading::factor;
use crate::stop::on_ctrl_c;
use crate::stress;
use crate::terminal::threads;
use anyhow::Context;
use rockproof_campaign::config::{CampaignConfig, SettingPlace};
use rockproof_campaign::diagnosis;
use rockproof_campaign::engines::{Engines, EnginesError};
use rockproof_campaign::journal::Journal;
use rockproof_campaign::part::{Machine, Part};
use rockproof_campaign::run::{self, Ending};
use rockproof_campaign::source;
use rockproof_campaign::steps;
use rockproof_campaign::stress::StressSource;
use rockproof_differential::builtin::full_name;
use rockproof_differential::finding::{Cause, Finding};
use rockproof_differential::subject::PairSource;
use rockproof_gate::setting_line::place_of;
use rockproof_gate::toml_error::toml_error;
use rockproof_model::Number;
use rockproof_model::files::read_text;
use rockproof_results::Start;
use serde_json::{Map, Value};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// Compare engines with the oracle on generated and real pairs, and explain every difference
///
/// Writes findings.csv, summary.csv, run.json and the shrunk findings in cases/; of pairs that make steps, step_findings.csv and
/// step_summary.csv.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof campaign                                  every family, f32 and f64, all presets; some 20 seconds on two cores
  rockproof campaign --pairs 10000 --family sliver --engine stepper-f32 --tolerances shi
  rockproof campaign --family real --real cases/real/voronoi_120.txt --planarity 1e-4
  rockproof campaign --tolerances mine.toml           your own tolerances, in a file as `check` takes it
  rockproof campaign --out reports/night --pairs 100000000 --resume      more pairs for a run that is there
  rockproof campaign --part 3/8 --pairs 100000000     an eighth of it, for one of eight machines (docs/scale.md)
  rockproof campaign --deny defect --deny collapsed   for CI: exit 1 if there is such a finding
  rockproof campaign --pairs 2000 --steps-every 1 --steps 3   every pair moves for three steps (docs/campaign_steps.md)
  rockproof campaign --stress                         how far from the origin, how thin, how parallel (docs/stress.md)
  rockproof campaign --engine-command mine:f32=./client --ask-twice   your own program (docs/engines.md)

A finding's engine is `any` for a tolerance (it changes the exact answer for everyone; `f32` or `f64` under a set that
depends on the precision), `f32` or `f64` for what rounding the input does, and an engine's name for its own arithmetic.

Exit status: 0 done, 1 findings that --deny names or nothing compared where it is given, 2 usage or input error, 130 interrupted (go on with --resume).")]
pub(crate) struct Campaign {
    /// TOML file of settings; the options below override it
    config: Option<PathBuf>,
    /// How many pairs
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
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
    /// Tolerance preset (auto, shi, zero) or TOML file of tolerances; may be repeated [default: the presets, and sets made for ties]
    #[arg(long, value_name = "PRESET|FILE", value_delimiter = ',')]
    tolerances: Vec<String>,
    /// Family of pairs; may be repeated [default: all]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    family: Vec<String>,
    /// Examine the stress set instead: pairs more and more extreme, and steps at rest; writes stress.csv, limits.csv, steps.csv too
    #[arg(long, conflicts_with_all = ["family", "real"])]
    stress: bool,
    /// Leave blocks where families put them, on coarse grids: many decisions are exact ties there, which a mistake as `<` for `≤` shows at
    #[arg(long, conflicts_with = "stress")]
    exact_ties: bool,
    /// Block file for the family `real`; may be repeated [default: those that come with the program]
    #[arg(long, value_name = "FILE")]
    real: Vec<PathBuf>,
    /// How far a face may be from planar, as a share of its block's size [default: what the file says, or 1e-9]
    #[arg(long, value_name = "SHARE", value_parser = at_least_zero, allow_negative_numbers = true)]
    planarity: Option<Number>,
    /// Join vertices of --real no further apart than this, in the file's unit of length [default: join only identical ones, and these only in STL]
    #[arg(long, value_name = "DISTANCE", value_parser = at_least_zero, allow_negative_numbers = true)]
    weld: Option<Number>,
    /// Multiply every length of --real first: 1/1000 for files in millimetres
    #[arg(long, value_name = "FACTOR", value_parser = factor, allow_negative_numbers = true)]
    scale: Option<Number>,
    /// Do only the K-th of N parts of the pairs; `rockproof merge` makes of all parts what one campaign would have made
    #[arg(long, value_name = "K/N")]
    part: Option<Part>,
    /// Share the work among the ranks of an MPI job: mpirun -n 64 rockproof campaign --mpi (docs/scale.md; a build with the feature mpi)
    #[arg(long, conflicts_with = "part")]
    mpi: bool,
    /// Go on with the run in the directory, with more pairs if --pairs says so (not of a part), or begin if there is none
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
    /// Worker threads, with --mpi of each rank; 0, the default, is one per core; the results do not depend on it
    #[arg(long, default_value_t = 0, hide_default_value = true, value_parser = threads)]
    threads: usize,
    #[command(flatten)]
    format: FormatArgs,
}

impl Campaign {
    pub(crate) fn run(&self) -> Outcome {
        if !self.mpi {
            return self.run_here();
        }
        #[cfg(feature = "mpi")]
        return crate::mpi::on_all_ranks(self);
        #[cfg(not(feature = "mpi"))]
        Err(crate::exit::without_mpi())
    }

    /// Runs in this process alone.
    pub(crate) fn run_here(&self) -> Outcome {
        let prepared = self.prepared()?;
        tell_of_share(prepared.config.planarity.as_ref());
        let stop = on_ctrl_c()?;
        if !self.probed(&prepared.engines, &stop)? {
            return Ok(ExitStatus::Interrupted);
        }
        let mut journal = self.journal(&prepared)?;
        let Prepared { config, source, .. } = &prepared;
        let share = self.part.map_or(0..config.pairs, |part| part.pairs(config.pairs, source.batch_len()));
        let ending = prepared.with_campaign(self.threads, |campaign| {
            let ending = shown_while(share.end - share.start, journal.seen(), || match self.part {
                None => campaign.run(&mut journal, &stop, &mut |_| {}),
                Some(part) => campaign.run_part(part, &mut journal, &stop, &mut |_| {}),
            })?;
            // Of a part there is no diagnosis: the merge makes it.
            if ending == Ending::Finished && self.part.is_none() {
                return diagnosed(campaign, &mut journal, &stop);
            }
            Ok::<_, anyhow::Error>(ending)
        })?;
        self.end(&prepared, &mut journal, ending)
    }

    /// What the command is to do.
    pub(crate) fn prepared(&self) -> anyhow::Result<Prepared> {
        check_deny(&self.deny)?;
        let config = self.configuration()?;
        let engines = match Engines::of(&config) {
            // Options cannot name none.
            Err(error @ EnginesError::None { .. }) => return Err(self.in_file(error.into())),
            engines => engines?,
        };
        let (source, identity) = (pair_source(&config)?, source::identity(&config)?);
        Ok(Prepared { config, engines, source, identity })
    }

    /// Asks the external engines a first question; `false` where they were ended with the program.
    pub(crate) fn probed(&self, engines: &Engines, stop: &AtomicBool) -> anyhow::Result<bool> {
        probed(engines, stop).map_err(|error| {
            let of_engine = matches!(error.downcast_ref(), Some(EnginesError::NoReply { .. }));
            if of_engine && self.external.names_none() { self.in_file(error) } else { error }
        })
    }

    /// An error about something in the file of settings, where there is one.
    fn in_file(&self, error: anyhow::Error) -> anyhow::Error {
        match &self.config {
            Some(path) => error.context(path.display().to_string()),
            None => error,
        }
    }

    /// The directory of the results, as the command is to begin there.
    pub(crate) fn journal(&self, prepared: &Prepared) -> anyhow::Result<Journal> {
        let Prepared { config, source, identity, .. } = prepared;
        let name = if config.stress { "stress" } else { "campaign" };
        let suffix = self.part.map_or(String::new(), |part| format!("-part-{}-of-{}", part.number(), part.of()));
        let out = || PathBuf::from(format!("reports/{name}-{}{suffix}", config.seed));
        let out = self.out.clone().unwrap_or_else(out);
        let (identity, start) = (identity.clone(), Start::of(self.resume, self.overwrite));
        Ok(match self.part {
            None => Journal::open(&out, identity, start)?,
            Some(part) => Journal::open_part(&out, identity, start, part, Machine::current(&**source)?)?,
        })
    }

    /// Writes and prints what is to be told at the end.
    pub(crate) fn end(&self, prepared: &Prepared, journal: &mut Journal, ending: Ending) -> Outcome {
        let Prepared { config, engines, .. } = prepared;
        // Of a part there is no table of the whole: the merge makes it.
        let is_whole = self.part.is_none() && ending == Ending::Finished;
        let stress = (config.stress && is_whole).then(|| stress::finish(journal, engines)).transpose()?;
        print_end(journal, &config.external, ending, stress.as_ref(), &self.format)?;
        if ending == Ending::Stopped {
            return Ok(ExitStatus::Interrupted);
        }
        let names = engine_names(config);
        // A part may be too small to hold a pair that survives rounding; the merge of all parts is no part.
        let compared: Vec<&str> = if self.part.is_some() { Vec::new() } else { names.collect() };
        Ok(denied(&self.deny, &compared, journal.progress()))
    }

    /// Worker threads; 0 for one a core.
    #[cfg(feature = "mpi")]
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    fn configuration(&self) -> anyhow::Result<CampaignConfig> {
        let mut config = match &self.config {
            None => CampaignConfig::default(),
            Some(path) => {
                let here = || path.display().to_string();
                let text = read_text(path).with_context(here)?;
                let told = |error| anyhow::Error::msg(toml_error(&here(), &text, &error));
                let config = CampaignConfig::from_toml(&text).map_err(told)?;
                check_names(&config, |setting| place_of(&here(), &text, None, setting))?;
                config
            }
        };
        config.stress |= self.stress;
        config.exact_ties |= self.exact_ties;
        if config.stress {
            if config.exact_ties {
                return Err(self.in_file(anyhow::anyhow!("the stress set has pairs of its own: no exact_ties")));
            }
            // Options that name some are refused with --stress.
            if !config.families.is_empty() || !config.real.is_empty() {
                return Err(self.in_file(anyhow::anyhow!("the stress set has pairs of its own: no families")));
            }
            if self.config.is_none() {
                (config.pairs, config.metamorphic_every, config.cases_per_cause) =
                    (StressSource::default_pairs(), 0, 8);
            }
        }
        config.pairs = self.pairs.unwrap_or(config.pairs);
        if config.pairs == 0 {
            let none = anyhow::anyhow!("pairs is 0; allowed are 1 and more: where nothing is asked nothing is found");
            return Err(if self.pairs.is_some() { none } else { self.in_file(none) });
        }
        config.seed = self.seed.unwrap_or(config.seed);
        config.steps_every = self.steps_every.unwrap_or(config.steps_every);
        config.steps = self.steps.unwrap_or(config.steps);
        self.external.add_to(&mut config)?;
        if !self.engine.is_empty() {
            config.engines.clone_from(&self.engine);
            let external = |name: &str| config.external.iter().any(|spec| spec.name == name);
            // Who misspells one is told of all that there are.
            if self.engine.iter().all(|name| full_name(name).is_some() || external(name)) {
                config.external.retain(|spec| self.engine.contains(&spec.name));
            }
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
        let of_real = [
            ("planarity", &self.planarity, &mut config.planarity),
            ("weld", &self.weld, &mut config.weld),
            ("scale", &self.scale, &mut config.scale),
        ];
        for (name, given, setting) in of_real {
            if let Some(given) = given {
                anyhow::ensure!(!config.real.is_empty(), "--{name} is about the files of --real, and there are none");
                *setting = Some(given.clone());
            }
        }
        Ok(config)
    }
}

/// What a campaign is to do, read and checked; nothing is written and no program started.
pub(crate) struct Prepared {
    pub(crate) config: CampaignConfig,
    pub(crate) engines: Engines,
    pub(crate) source: Box<dyn PairSource>,
    /// What must be the same for a run to go on, and on all ranks.
    pub(crate) identity: Map<String, Value>,
}

impl Prepared {
    /// Does something with the campaign, on so many threads.
    pub(crate) fn with_campaign<T>(&self, threads: usize, work: impl FnOnce(&run::Campaign<'_>) -> T) -> T {
        let narrow = |finding: &Finding| self.engines.panel_for(finding);
        let (panel, names) = (self.engines.panel(), self.engines.names());
        let steppers = steps::engines(names.iter().map(String::as_str));
        let (config, source) = (&self.config, &*self.source);
        work(&run::Campaign { config, source, panel: &panel, narrow: &narrow, steppers: &steppers, threads })
    }
}

/// The pairs that a configuration asks for: of the stress set, or of families.
pub(crate) fn pair_source(config: &CampaignConfig) -> anyhow::Result<Box<dyn PairSource>> {
    Ok(match config.stress {
        true => Box::new(StressSource::new(config.seed, &config.tolerances)?),
        false => Box::new(source::of(config)?),
    })
}

/// Checks the names in a file of settings, before options override any: whatever comes after is about the options.
/// `place` is where in the file a setting stands.
fn check_names(config: &CampaignConfig, place: impl Fn(Option<SettingPlace<'_>>) -> String) -> anyhow::Result<()> {
    let mut names = CampaignConfig { real: Vec::new(), ..config.clone() };
    names.settle_engines();
    match Engines::of(&names) {
        // An option may name one.
        Ok(_) | Err(EnginesError::None { .. }) => {}
        Err(error) => anyhow::bail!("{}: {error}", place(error.setting())),
    }
    source::of(&names).map(drop).map_err(|error| anyhow::anyhow!("{}: {error}", place(error.setting())))
}

/// Asks the external engines a first question; `false` where they were ended with the program.
pub(crate) fn probed(engines: &Engines, stop: &AtomicBool) -> anyhow::Result<bool> {
    match engines.probe() {
        Err(_) if stop.load(Ordering::SeqCst) => Ok(false),
        probed => Ok(probed.map(|()| true)?),
    }
}

/// Looks for what is wrong with external engines, if there are any.
pub(crate) fn diagnosed(
    campaign: &run::Campaign<'_>,
    journal: &mut Journal,
    stop: &AtomicBool,
) -> anyhow::Result<Ending> {
    let engines = campaign.panel.engines.iter().filter(|engine| engine.cause() == Cause::Engine).count();
    if engines == 0 {
        return Ok(Ending::Finished);
    }
    let doing = "asked again to see what is wrong";
    let most = (engines * diagnosis::DIFFERING) as u64;
    Ok(counted_while((most, "pairs"), doing, |done| campaign.diagnose(journal, stop, done))?)
}
