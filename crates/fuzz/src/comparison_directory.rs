//! The directory of a comparison of the exact side with itself, one file damaged: what is counted and gone on with is what was written, or an
//! error names a file.

use crate::Target;
use crate::dice::Dice;
use crate::reach::Reach;
use crate::run_directory::{Damage, files, input, write};
use crate::scratch::{new_folder, scratch};
use rockproof_campaign::run::Ending;
use rockproof_pairs::batch::{BATCH, PairConfig};
use rockproof_results::{MANIFEST, Start};
use rockproof_validation::self_comparison::paths::BuiltIn;
use rockproof_validation::self_comparison::record::{ComparisonPlan, ComparisonRecord, PairsMark, RecordError};
use rockproof_validation::self_comparison::run::{Comparison, ProgressCounts};
use rockproof_validation::self_comparison::total::Total;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

const TOTALS: &str = "totals.csv";
/// What a comparison goes on from.
const GONE_ON_FROM: [&str; 4] = [MANIFEST, "comparison.json", "disagreements.csv", TOTALS];
/// Pairs of the comparison that is damaged.
const PAIRS: u64 = 2 * BATCH;
/// Pairs to which it goes on.
const MORE: u64 = 3 * BATCH;

/// Compares so many pairs in all.
fn run_into(dir: &Path, pairs: u64, start: Start) -> Result<Ending, RecordError> {
    let plan = ComparisonPlan { seed: 3, pairs, plain_every: 0, gmp_every: 0, part: None };
    let config = PairConfig::default();
    static MARK: OnceLock<PairsMark> = OnceLock::new();
    let mut record = ComparisonRecord::open(dir, plan, MARK.get_or_init(|| PairsMark::of(&config)), start)?;
    let comparison = Comparison { paths: &BuiltIn, config: &config, threads: 1 };
    comparison.run(&mut record, &AtomicBool::new(false), &ProgressCounts::default())
}

fn made(pairs: u64) -> BTreeMap<String, Vec<u8>> {
    let folder = new_folder();
    let dir = folder.path().join("comparison");
    assert_eq!(run_into(&dir, pairs, Start::Fresh).expect("a comparison of a few pairs"), Ending::Finished);
    files(&dir, "")
}

/// The files of the comparison that is damaged.
fn begun() -> &'static BTreeMap<String, Vec<u8>> {
    static FILES: OnceLock<BTreeMap<String, Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| made(PAIRS))
}

/// The counts of a comparison of all pairs at once.
fn whole() -> Option<&'static Vec<u8>> {
    static FILES: OnceLock<BTreeMap<String, Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| made(MORE)).get(TOTALS)
}

/// The directory is added up, then gone on with.
pub(crate) fn comparison_directory(bytes: &[u8], reach: &mut Reach) {
    let Some(damage) = Damage::of(bytes, &GONE_ON_FROM) else { return reach.count("too-short") };
    let dir = scratch().join("compared");
    write(&dir, begun());
    damage.apply(&dir);
    let refused = |kind: String, message: String, reach: &mut Reach| {
        assert!(message.contains(&*dir.to_string_lossy()), "no file is named: {message}");
        assert!(message.len() < 8_000, "a message of {} bytes: {message}", message.len());
        reach.count(kind);
    };
    match Total::of(std::slice::from_ref(&dir)) {
        Ok(total) => {
            let same = total.pairs() == (PAIRS, PAIRS) && total.totals.all().disagreements == 0;
            assert!(same || damage.resealed, "{} was believed: {total:?}", damage.name);
            reach.count("added-up");
        }
        Err(error) => refused(format!("total-{}", Reach::variant(&error)), error.to_string(), reach),
    }
    match run_into(&dir, MORE, Start::Resume) {
        Ok(_) if damage.resealed => reach.count("resealed-read"),
        Ok(ending) => {
            assert_eq!(ending, Ending::Finished, "{} was believed", damage.name);
            let found = files(&dir, "");
            assert!(found.get(TOTALS) == whole(), "{} was believed: other counts", damage.name);
            reach.count("whole");
        }
        Err(error) => refused(Reach::variant(&error), error.to_string(), reach),
    }
}

/// An input of [`comparison_directory`].
pub(crate) fn comparison_directory_input(_: &Target, dice: &mut Dice) -> Vec<u8> {
    input(&GONE_ON_FROM, begun(), dice)
}
