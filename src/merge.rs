//! `merge`: the parts of a campaign put together.

use crate::campaign::{diagnosed, pair_source, probed};
use crate::campaign_end::print_end;
use crate::deny::{check_deny, denied, engine_names};
use crate::exit::{ExitStatus, Outcome, print_note};
use crate::input::FormatArgs;
use crate::progress::shown_while;
use crate::stop::on_ctrl_c;
use crate::stress;
use crate::terminal::threads;
use rockproof_campaign::engines::Engines;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::merge::Parts;
use rockproof_campaign::part::Machine;
use rockproof_campaign::run::{self, Ending};
use rockproof_campaign::{source, steps};
use rockproof_differential::finding::Finding;
use rockproof_report::table::counted;
use rockproof_results::Start;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Merge the parts of a campaign into the directory that one machine would have made
///
/// Tables and case files are the same byte for byte; run.json and progress.json hold times, and engines.csv counts what depends on threads and
/// on luck. The case files are made here, so an external engine that the campaign asks must be here as well.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof merge reports/campaign-1-part-* --out reports/campaign-1
  rockproof merge parts/* --out reports/night --resume         goes on with a merge that was interrupted
  rockproof merge parts/* --out reports/so_far --partial       of the parts that are there, and the pairs they have done

Exit status: 0 done, 1 findings that --deny names, 2 parts missing, twice or of different campaigns, 130 interrupted.")]
pub(crate) struct Merge {
    /// Directories that `rockproof campaign --part` made, in any order
    #[arg(required = true, value_name = "DIR")]
    parts: Vec<PathBuf>,
    /// Directory of the whole campaign
    #[arg(long)]
    out: PathBuf,
    /// Take the parts that are there, finished or not; the result says which, and is not taken for the whole
    #[arg(long, conflicts_with = "resume")]
    partial: bool,
    /// Go on with the merge in the directory, or begin if there is none
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Discard the campaign in the directory; other files there stay
    #[arg(long)]
    overwrite: bool,
    /// Exit with 1 if there is a finding of this cause or change, or `any`; `recovered` for failures of engines that did not repeat; may be repeated
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    deny: Vec<String>,
    /// Worker threads; 0, the default, is one per core; the results do not depend on it
    #[arg(long, default_value_t = 0, hide_default_value = true, value_parser = threads)]
    threads: usize,
    #[command(flatten)]
    format: FormatArgs,
}

impl Merge {
    pub(crate) fn run(&self) -> Outcome {
        check_deny(&self.deny)?;
        let parts = Parts::open(&self.parts, self.partial)?;
        anyhow::ensure!(!parts.hold(&self.out), "--out {} is one of the parts", self.out.display());
        let config = parts.config();
        let engines = Engines::of(config)?;
        let source = pair_source(config)?;
        let batch_len = source.batch_len();
        parts.check(&source::identity(config)?, &Machine::current(&*source)?, batch_len)?;
        let stop = on_ctrl_c()?;
        if !probed(&engines, &stop)? {
            return Ok(ExitStatus::Interrupted);
        }
        let mut told = Instant::now();
        for place in 0..parts.len() {
            if stop.load(Ordering::SeqCst) {
                return Ok(ExitStatus::Interrupted);
            }
            if told.elapsed() > Duration::from_secs(10) {
                told = Instant::now();
                print_note(&format!("{place} of {} parts read and found whole", parts.len()));
            }
            parts.check_tables(place)?;
        }
        let start = Start::of(self.resume, self.overwrite);
        let mut journal = Journal::open(&self.out, parts.identity(batch_len), start)?;
        let narrow = |finding: &Finding| engines.panel_for(finding);
        let (panel, names) = (engines.panel(), engines.names());
        let steppers = steps::engines(names.iter().map(String::as_str));
        let threads = self.threads;
        let campaign =
            run::Campaign { config, source: &*source, panel: &panel, narrow: &narrow, steppers: &steppers, threads };
        let merged =
            shown_while(config.pairs, journal.seen(), || campaign.merge(&parts, &mut journal, &stop, &mut |_| {}))?;
        let ending = match merged.ending {
            Ending::Finished => diagnosed(&campaign, &mut journal, &stop)?,
            Ending::Stopped => Ending::Stopped,
        };
        if ending == Ending::Stopped {
            print_note("interrupted; --resume goes on");
            return Ok(ExitStatus::Interrupted);
        }
        if merged.unseen > 0 {
            print_note(&format!(
                "{} no case file, because an engine does not answer as it did in the part",
                counted(merged.unseen, "finding has", "findings have")
            ));
        }
        let stress = config.stress.then(|| stress::finish(&mut journal, &engines)).transpose()?;
        print_end(&journal, &config.external, merged.ending, stress.as_ref(), &self.format)?;
        let compared: Vec<&str> = engine_names(config).collect();
        Ok(denied(&self.deny, &compared, journal.progress()))
    }
}
