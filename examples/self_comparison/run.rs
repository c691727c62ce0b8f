//! `run`: compares, and keeps what it counted.

use crate::progress::shown_while;
use crate::total::text;
use crate::{INTERRUPTED, PATHS, Verdict, print};
use anyhow::Context;
use rockproof_campaign::pairs::{BATCH, PairConfig};
use rockproof_campaign::part::Part;
use rockproof_campaign::run::Ending;
use rockproof_results::Start;
use rockproof_validation::self_comparison::record::{ComparisonPlan, ComparisonRecord};
use rockproof_validation::self_comparison::run::{Comparison, Seen};
use rockproof_validation::self_comparison::total::Total;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

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

/// The most worker threads; more of them than cores gain nothing.
const MOST_THREADS: usize = 1024;

fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(threads) if threads <= MOST_THREADS => Ok(threads),
        _ => Err(format!("allowed are 1 to {MOST_THREADS}, and 0 for one a core")),
    }
}

impl Run {
    pub(crate) fn run(&self) -> anyhow::Result<Verdict> {
        anyhow::ensure!(
            self.gmp_every == 0 || cfg!(feature = "gmp"),
            "--gmp-every: this program was built without GMP; `cargo run --release --features gmp --example self_comparison` builds it with"
        );
        let stop = on_ctrl_c()?;
        let plan = ComparisonPlan {
            seed: self.seed,
            pairs: self.pairs,
            plain_every: self.plain_every,
            gmp_every: self.gmp_every,
            part: self.part,
        };
        let config = PairConfig::default();
        let mut record = ComparisonRecord::open(&self.out, plan, &config, Start::of(self.resume, self.overwrite))?;
        let share = plan.share();
        let comparison = Comparison { paths: PATHS, config: &config, threads: self.threads };
        let seen = Seen::default();
        let ending = shown_while(share.end - share.start, &seen, || comparison.run(&mut record, &stop, &seen))?;
        drop(record);
        let total = Total::of(std::slice::from_ref(&self.out))?;
        print(&text(&total))?;
        if ending == Ending::Stopped {
            eprintln!("note: stopped; to go on: {}", again()?);
            return Ok(Verdict::Interrupted);
        }
        Ok(if total.totals.all().disagreements == 0 { Verdict::Agreed } else { Verdict::Disagreed })
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

/// A flag that Ctrl-C sets; a second Ctrl-C ends the program at once, which what is on disk bears.
fn on_ctrl_c() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::SeqCst) {
            eprintln!("note: stopped at once");
            std::process::exit(INTERRUPTED.into());
        }
        eprintln!("note: finishing what has begun; Ctrl-C again to quit at once");
    })
    .context("cannot catch Ctrl-C")?;
    Ok(stop)
}
