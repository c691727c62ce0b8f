//! `run`: compares, and keeps what it counted.

use crate::terminal::{Progress, stop_flag, threads, unprotected};
use crate::total::{text, verdict};
use crate::{PATHS, Verdict, print};
use anyhow::Context;
use rockproof_campaign::part::Part;
use rockproof_campaign::run::Ending;
use rockproof_pairs::batch::{BATCH, PairConfig};
use rockproof_report::table::grouped;
use rockproof_results::{Start, on_unprotected};
use rockproof_validation::self_comparison::record::{ComparisonPlan, ComparisonRecord, PairsMark};
use rockproof_validation::self_comparison::run::{Comparison, ProgressCounts};
use rockproof_validation::self_comparison::total::Total;
use std::io::{IsTerminal, stderr};
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Compare the paths on pairs of a seed, and write counts, disagreements and their cases to a directory
#[derive(clap::Args)]
pub(crate) struct Run {
    /// How many pairs: a multiple of 16
    #[arg(long, value_parser = whole_batches)]
    pairs: u64,
    /// Chooses the pairs, as in `rockproof campaign`
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The plain path in pure Rust rationals joins in one round of all families in so many; 0 for never
    #[arg(long, value_name = "K", default_value_t = 100)]
    plain_every: u64,
    /// The plain path in GMP's rationals joins in one round in so many; 0 for never; needs a build with the feature gmp
    #[arg(long, value_name = "K", default_value_t = 0)]
    gmp_every: u64,
    /// Do only the K-th of N parts of the pairs; `total` adds parts up
    #[arg(long, value_name = "K/N")]
    part: Option<Part>,
    /// Worker threads [default: one a core]; no count depends on it
    #[arg(long, default_value_t = 0, hide_default_value = true, value_parser = threads)]
    threads: usize,
    /// Directory of the results
    #[arg(long)]
    out: PathBuf,
    /// Go on with the comparison in the directory, with more pairs if --pairs says so (not of a part), or begin if there is none
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Discard the comparison in the directory; other files there stay
    #[arg(long)]
    overwrite: bool,
}

fn whole_batches(text: &str) -> Result<u64, String> {
    match text.parse::<u64>() {
        Ok(pairs) if pairs > 0 && pairs.is_multiple_of(BATCH) => Ok(pairs),
        _ => Err(format!("allowed are multiples of {BATCH}, from {BATCH}: pairs are made in batches of so many")),
    }
}

impl Run {
    pub(crate) fn run(&self) -> anyhow::Result<Verdict> {
        anyhow::ensure!(
            self.gmp_every == 0 || cfg!(feature = "gmp"),
            "--gmp-every: this program was built without GMP; `cargo run --release --features gmp --example self_comparison` builds it with"
        );
        let stop = stop_flag(|| {}, note).context("cannot catch Ctrl-C")?;
        on_unprotected(|dir| note(&unprotected(dir)));
        let plan = ComparisonPlan {
            seed: self.seed,
            pairs: self.pairs,
            plain_every: self.plain_every,
            gmp_every: self.gmp_every,
            part: self.part,
        };
        let config = PairConfig::default();
        let mut record =
            ComparisonRecord::open(&self.out, plan, &PairsMark::of(&config), Start::of(self.resume, self.overwrite))?;
        let share = plan.share();
        let comparison = Comparison { paths: PATHS, config: &config, threads: self.threads };
        let seen = ProgressCounts::default();
        let now = || {
            let disagreements = grouped(seen.disagreements.load(Ordering::Relaxed));
            (seen.pairs.load(Ordering::Relaxed), format!("{disagreements} disagreements"))
        };
        let progress = Progress {
            all: (share.end - share.start, "pairs"),
            now: &now,
            has_bar: stderr().is_terminal(),
            line: note,
            lines_every: Duration::from_secs(60),
        };
        let ending = progress.shown_while(|| comparison.run(&mut record, &stop, &seen))?;
        drop(record);
        let total = Total::of(std::slice::from_ref(&self.out))?;
        print(&text(&total))?;
        if ending == Ending::Stopped {
            note(&format!("stopped; to go on: {}", again()?));
            return Ok(Verdict::Interrupted);
        }
        verdict(&total)
    }
}

/// The command that goes on with this one.
fn again() -> anyhow::Result<String> {
    let given: Vec<String> = std::env::args_os().skip(1).map(|part| part.to_string_lossy().into_owned()).collect();
    let kept = given.iter().map(String::as_str).filter(|part| !["--resume", "--overwrite"].contains(part));
    let arguments = shlex::try_join(kept.chain(["--resume"])).context("the arguments")?;
    let features = if cfg!(feature = "gmp") { " --features gmp" } else { "" };
    Ok(format!("cargo run --release{features} --example self_comparison -- {arguments}"))
}

/// Tells something worth knowing on stderr.
fn note(text: &str) {
    eprintln!("note: {text}");
}
