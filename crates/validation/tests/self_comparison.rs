//! The comparison of the exact side with itself finds a mistake planted in any path, keeps what it counted whatever interrupts it, and adds up parts to the
//! whole; what does not belong together is refused by name.

use rockproof_campaign::part::Part;
use rockproof_campaign::run::Ending;
use rockproof_differential::case_file::Case;
use rockproof_model::{Contact, ContactKey, Sign};
use rockproof_oracle::LevelCounts;
use rockproof_pairs::batch::{BATCH, PairConfig};
use rockproof_results::Start;
use rockproof_stepper::engine::EngineError;
use rockproof_validation::self_comparison::compare::{OtherPaths, compare};
use rockproof_validation::self_comparison::disagreement::DisagreementRow;
use rockproof_validation::self_comparison::paths::{BuiltIn, PathName, Paths, Question};
use rockproof_validation::self_comparison::record::{
    ComparisonPlan, ComparisonRecord, MAX_CASES, PairsMark, RecordError,
};
use rockproof_validation::self_comparison::run::{Comparison, ProgressCounts};
use rockproof_validation::self_comparison::total::Total;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Two batches of every family, more or less.
const PAIRS: u64 = 24 * BATCH;

fn plan() -> ComparisonPlan {
    ComparisonPlan { seed: 3, pairs: PAIRS, plain_every: 0, gmp_every: 0, part: None }
}

/// The built-in paths, one of them with a mistake wherever it finds contacts; the plain path, which is slow, is the fast one here.
struct Mistaken {
    path: PathName,
    how: Mistake,
}

/// No mistake.
const RIGHT: Mistaken = Mistaken { path: PathName::Fast, how: Mistake::Nothing };

#[derive(Clone, Copy, PartialEq)]
enum Mistake {
    Nothing,
    LosesLast,
    /// Names a vertex that no block has.
    NamesNoVertex,
    Panics,
}

impl Mistaken {
    fn said(&self, path: PathName, mut contacts: Vec<Contact>) -> Vec<Contact> {
        if self.path == path && !contacts.is_empty() {
            match self.how {
                Mistake::Nothing => {}
                Mistake::LosesLast => drop(contacts.pop()),
                Mistake::NamesNoVertex => {
                    let key = ContactKey::of_kind(contacts[0].kind(), [7_000, 7_000]);
                    contacts.push(Contact { key, entrance: contacts[0].entrance, gap: Sign::Positive });
                }
                Mistake::Panics => panic!("=planted"),
            }
        }
        contacts
    }
}

impl Paths for Mistaken {
    fn fast(&self, asked: Question<'_>) -> (Vec<Contact>, LevelCounts) {
        let (contacts, levels) = BuiltIn.fast(asked);
        (self.said(PathName::Fast, contacts), levels)
    }

    fn wide(&self, asked: Question<'_>) -> Result<(Vec<Contact>, u64), EngineError> {
        BuiltIn.wide(asked).map(|(contacts, unsettled)| (self.said(PathName::Wide, contacts), unsettled))
    }

    fn settled(&self, asked: Question<'_>) -> Result<Option<Vec<Contact>>, EngineError> {
        Ok(BuiltIn.settled(asked)?.map(|contacts| self.said(PathName::Settled, contacts)))
    }

    fn plain(&self, asked: Question<'_>) -> Vec<Contact> {
        self.said(PathName::Plain, BuiltIn.fast(asked).0)
    }

    fn gmp(&self, asked: Question<'_>) -> Option<Vec<Contact>> {
        Some(self.said(PathName::Gmp, BuiltIn.fast(asked).0))
    }
}

/// The built-in paths, which stop the run after so many pairs.
struct StopsAfter<'s> {
    pairs: AtomicU64,
    stop: &'s AtomicBool,
}

impl Paths for StopsAfter<'_> {
    fn fast(&self, asked: Question<'_>) -> (Vec<Contact>, LevelCounts) {
        if self.pairs.fetch_sub(1, Ordering::SeqCst) == 1 {
            self.stop.store(true, Ordering::SeqCst);
        }
        BuiltIn.fast(asked)
    }
}

fn run(
    dir: &Path,
    plan: ComparisonPlan,
    paths: &dyn Paths,
    (start, threads): (Start, usize),
) -> Result<Ending, RecordError> {
    run_until(dir, plan, paths, (start, threads), &AtomicBool::new(false))
}

fn run_until(
    dir: &Path,
    plan: ComparisonPlan,
    paths: &dyn Paths,
    (start, threads): (Start, usize),
    stop: &AtomicBool,
) -> Result<Ending, RecordError> {
    let config = PairConfig::default();
    static MARK: OnceLock<PairsMark> = OnceLock::new();
    let mut record = ComparisonRecord::open(dir, plan, MARK.get_or_init(|| PairsMark::of(&config)), start)?;
    Comparison { paths, config: &config, threads }.run(&mut record, stop, &ProgressCounts::default())
}

/// The files that must be the same bytes whatever happened: not the state, which holds times, nor the signs by level, which depend a little on what a
/// process decided before.
fn lasting(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for folder in [dir.to_owned(), dir.join("cases")] {
        for entry in fs::read_dir(&folder).into_iter().flatten() {
            let path = entry.expect("an entry").path();
            let name = path.strip_prefix(dir).expect("below").display().to_string();
            if path.is_file() && !["comparison.json", "levels.csv"].contains(&name.as_str()) {
                files.insert(name, fs::read(&path).expect("a file"));
            }
        }
    }
    files
}

fn rows(dir: &Path) -> Vec<DisagreementRow> {
    let reader = csv::Reader::from_path(dir.join("disagreements.csv")).expect("a table");
    reader.into_deserialize().map(|row| row.expect("a row")).collect()
}

fn signs(total: &Total) -> u64 {
    total.totals.levels.iter().sum()
}

/// Signs of the same pairs.
fn about_as_many_signs(one: &Total, other: &Total) {
    let (one, other) = (signs(one), signs(other));
    assert!(one.abs_diff(other) * 20 < one, "{one}, {other}");
}

#[test]
fn all_agree_where_nothing_is_planted() {
    let dir = tempfile::tempdir().expect("a folder");
    let plan = ComparisonPlan { plain_every: 2, ..plan() };
    assert_eq!(run(dir.path(), plan, &RIGHT, (Start::Fresh, 2)).expect("runs"), Ending::Finished);
    let total = Total::of(&[dir.path().to_owned()]).expect("adds up");
    let all = total.totals.all();
    assert_eq!((all.exact, all.disagreements, total.pairs()), (PAIRS, 0, (PAIRS, PAIRS)));
    assert!(all.with_contacts * 3 > all.compared() && all.in_f32 > 0 && all.gmp == 0, "{all:?}");
    let families = PairConfig::default().families.len() as u64;
    let first_round = families.min(PAIRS / BATCH) * BATCH;
    assert!((first_round..first_round + first_round / 8 + 1).contains(&all.plain), "one round in two: {all:?}");
    assert!(signs(&total) > all.compared() && rows(dir.path()).is_empty(), "{total:?}");
}

#[test]
fn a_mistake_in_any_path_is_counted_and_kept_and_the_run_goes_on() {
    let paths = [PathName::Fast, PathName::Wide, PathName::Settled, PathName::Plain, PathName::Gmp];
    for (path, how) in paths
        .into_iter()
        .flat_map(|path| [Mistake::LosesLast, Mistake::NamesNoVertex, Mistake::Panics].map(|how| (path, how)))
    {
        let dir = tempfile::tempdir().expect("a folder");
        let pairs = if cfg!(debug_assertions) { BATCH } else { 2 * BATCH };
        let plan = ComparisonPlan { pairs, plain_every: 1, gmp_every: 1, ..plan() };
        let mistaken = Mistaken { path, how };
        assert_eq!(run(dir.path(), plan, &mistaken, (Start::Fresh, 2)).expect("runs"), Ending::Finished);
        let total = Total::of(&[dir.path().to_owned()]).expect("adds up");
        let (all, rows) = (total.totals.all(), rows(dir.path()));
        assert!(all.disagreements > 5 && all.disagreements == rows.len() as u64, "{all:?}");
        assert_eq!(all.exact, plan.pairs, "it goes on");
        // All others contradict a mistaken fast path; beside that one nobody but the mistaken path is named.
        let named: Vec<&str> = match (path, how) {
            (PathName::Fast, Mistake::Panics) => vec!["fast"],
            (PathName::Fast, _) => vec!["wide", "settled", "plain", "gmp"],
            _ => vec![path.name()],
        };
        for row in &rows {
            assert!(named.contains(&row.path.as_str()), "{} is planted: {row:?}", path.name());
            let note = row.note.as_str();
            assert_eq!(how == Mistake::Panics, note.contains("planted"), "{row:?}");
            if row.case.is_empty() {
                continue;
            }
            let file = dir.path().join(&row.case);
            let case = Case::load(&file).unwrap_or_else(|error| panic!("{row:?}: {error}"));
            // The pair of the case is the pair of the row: with the mistake it shows it, without it does not.
            let question = Question { a: &case.a, b: &case.b, tolerances: &case.tolerances };
            let slow = OtherPaths { settled: true, plain: row.path == "plain", gmp: row.path == "gmp" };
            let again = compare(&mistaken, question, slow).deviations;
            assert!(again.iter().any(|deviation| deviation.path.name() == row.path), "{row:?}: {again:?}");
            assert_eq!(compare(&RIGHT, question, slow).deviations, []);
            if how == Mistake::LosesLast {
                let change = if path == PathName::Fast { "extra" } else { "missing" };
                assert_eq!((row.change.as_str(), row.kind.is_empty()), (change, false), "{row:?}");
                assert_eq!(case.about.expected.len().abs_diff(case.about.found.len()), 1, "{row:?}");
            }
        }
        let with_case = rows.iter().filter(|row| !row.case.is_empty()).count() as u64;
        assert_eq!(with_case, all.disagreements.min(MAX_CASES));
        let inputs: Vec<&str> = rows.iter().map(|row| row.input.as_str()).collect();
        assert!(inputs.contains(&"exact") && inputs.contains(&"f32"), "{inputs:?}");
        assert!(named.iter().all(|name| rows.iter().any(|row| row.path == *name)), "{named:?}: {rows:?}");
    }
}

#[test]
fn a_path_wrong_everywhere_fills_the_table_and_not_the_disk() {
    let dir = tempfile::tempdir().expect("a folder");
    let plan = ComparisonPlan { plain_every: 1, ..plan() };
    let mistaken = Mistaken { path: PathName::Plain, how: Mistake::LosesLast };
    run(dir.path(), plan, &mistaken, (Start::Fresh, 2)).expect("runs");
    let rows = rows(dir.path());
    let with_case = rows.iter().take_while(|row| !row.case.is_empty()).count() as u64;
    assert!(rows.len() as u64 > MAX_CASES && with_case == MAX_CASES, "{} rows, {with_case} cases", rows.len());
    assert!(rows[with_case as usize..].iter().all(|row| row.case.is_empty()));
    assert_eq!(fs::read_dir(dir.path().join("cases")).expect("a folder").count() as u64, MAX_CASES);
}

#[test]
fn stopped_and_gone_on_with_is_the_same_bytes_on_any_number_of_threads() {
    let place = tempfile::tempdir().expect("a folder");
    let at = |name: &str| place.path().join(name);
    run(&at("whole"), plan(), &BuiltIn, (Start::Fresh, 1)).expect("runs");
    let (mut sessions, stopped) = (0, at("stopped"));
    loop {
        let stop = AtomicBool::new(false);
        let paths = StopsAfter { pairs: AtomicU64::new(70), stop: &stop };
        sessions += 1;
        let threads = 1 + sessions % 3;
        if run_until(&stopped, plan(), &paths, (Start::Resume, threads), &stop).expect("runs") == Ending::Finished {
            break;
        }
        let done = Total::of(std::slice::from_ref(&stopped)).expect("adds up").pairs().1;
        assert!(done > 0 && done < PAIRS, "{done}");
    }
    assert!(sessions > 3, "{sessions}");
    assert_eq!(lasting(&at("whole")), lasting(&stopped));
    let total = |name: &str| Total::of(&[at(name)]).expect("adds up");
    about_as_many_signs(&total("whole"), &total("stopped"));
    // A longer one begins with the shorter one.
    run(&at("grows"), ComparisonPlan { pairs: PAIRS / 2, ..plan() }, &BuiltIn, (Start::Fresh, 2)).expect("runs");
    run(&at("grows"), plan(), &BuiltIn, (Start::Resume, 2)).expect("goes on");
    assert_eq!(lasting(&at("whole")), lasting(&at("grows")));
    let error = run(&at("grows"), ComparisonPlan { pairs: PAIRS / 2, ..plan() }, &BuiltIn, (Start::Resume, 2));
    assert!(error.expect_err("shrinks").to_string().contains("pairs: the run has 384, asked for is 192"));
}

#[test]
fn disagreements_survive_a_stop() {
    let place = tempfile::tempdir().expect("a folder");
    let at = |name: &str| place.path().join(name);
    let mistaken = Mistaken { path: PathName::Wide, how: Mistake::LosesLast };
    run(&at("whole"), plan(), &mistaken, (Start::Fresh, 2)).expect("runs");
    for pairs in [PAIRS / 3, 2 * PAIRS / 3, PAIRS] {
        run(&at("pieces"), ComparisonPlan { pairs, ..plan() }, &mistaken, (Start::Resume, 1)).expect("runs");
    }
    let whole = lasting(&at("whole"));
    assert!(whole.keys().any(|name| name.starts_with("cases/")));
    assert_eq!(whole, lasting(&at("pieces")));
    // Rows that were written after the last state are cut off and made again.
    let table = at("pieces").join("disagreements.csv");
    fs::write(&table, [fs::read(&table).expect("a table"), b"3,4,cut o".to_vec()].concat()).expect("written");
    run(&at("pieces"), plan(), &mistaken, (Start::Resume, 1)).expect("goes on");
    assert_eq!(whole, lasting(&at("pieces")));
}

#[test]
fn parts_add_up_to_the_whole() {
    let place = tempfile::tempdir().expect("a folder");
    let at = |name: &str| place.path().join(name);
    let mistaken = Mistaken { path: PathName::Settled, how: Mistake::LosesLast };
    run(&at("whole"), plan(), &mistaken, (Start::Fresh, 2)).expect("runs");
    let parts: Vec<PathBuf> = (1..=5)
        .map(|number| {
            let part: Part = format!("{number}/5").parse().expect("a part");
            let dir = at(&format!("part{number}"));
            run(&dir, ComparisonPlan { part: Some(part), ..plan() }, &mistaken, (Start::Fresh, 1)).expect("runs");
            dir
        })
        .collect();
    let (sum, whole) = (Total::of(&parts).expect("adds up"), Total::of(&[at("whole")]).expect("adds up"));
    assert_eq!((sum.pairs(), &sum.totals.families), (whole.pairs(), &whole.totals.families));
    about_as_many_signs(&sum, &whole);
    // Each directory has room for so many cases.
    let bare = |row: DisagreementRow| DisagreementRow { case: String::new(), ..row };
    let of = |dirs: &[PathBuf]| -> Vec<_> { dirs.iter().flat_map(|dir| rows(dir)).map(bare).collect() };
    assert_eq!(of(&parts), of(&[at("whole")]));
    assert!(whole.totals.all().disagreements > 0 && whole.first_disagreements.len() > 1);

    // Another seed adds up, the same pairs do not, nor the same part twice.
    run(&at("other"), ComparisonPlan { seed: 4, pairs: 2 * BATCH, ..plan() }, &BuiltIn, (Start::Fresh, 1))
        .expect("runs");
    let both = Total::of(&[at("whole"), at("other")]).expect("adds up");
    assert_eq!(both.pairs(), (PAIRS + 2 * BATCH, PAIRS + 2 * BATCH));
    let refused = |dirs: &[PathBuf], wanted: &[&str]| {
        let error = Total::of(dirs).expect_err("refused").to_string();
        assert!(wanted.iter().all(|part| error.contains(part)), "{error}");
    };
    refused(&[at("part2"), at("other"), at("part2")], &["part2", "the same pairs", "64 to 143 of seed 3"]);
    refused(&[at("whole"), at("part5")], &["whole", "part5", "304 to 383 of seed 3"]);
    refused(&[at("part1"), place.path().to_owned()], &["no directory of `cargo run --example self_comparison`"]);
}

#[test]
fn what_is_foreign_damaged_or_another_comparison_is_refused_by_name() {
    let place = tempfile::tempdir().expect("a folder");
    let at = |name: &str| place.path().join(name);
    let short = ComparisonPlan { pairs: 2 * BATCH, ..plan() };
    let refused = |dir: &Path, plan: ComparisonPlan, start: Start, wanted: &[&str]| {
        let before = lasting(dir);
        let error = run(dir, plan, &BuiltIn, (start, 1)).expect_err("refused").to_string();
        assert!(wanted.iter().all(|part| error.contains(part)), "{wanted:?}: {error}");
        assert_eq!(before, lasting(dir), "{error}");
    };
    fs::create_dir(at("theirs")).expect("a folder");
    fs::write(at("theirs").join("totals.csv"), "mine").expect("written");
    for start in [Start::Fresh, Start::Resume, Start::Overwrite] {
        refused(&at("theirs"), short, start, &["totals.csv is in the way"]);
    }
    run(&at("ours"), short, &BuiltIn, (Start::Fresh, 1)).expect("runs");
    refused(&at("ours"), short, Start::Fresh, &["holds a comparison already", "--resume goes on with it"]);
    refused(&at("ours"), ComparisonPlan { seed: 9, ..short }, Start::Resume, &["seed: the run has 3, asked for is 9"]);
    refused(&at("ours"), ComparisonPlan { plain_every: 5, ..short }, Start::Resume, &["plain_every"]);
    let (state, table) = (at("ours").join("comparison.json"), at("ours").join("disagreements.csv"));
    for (file, what) in [(&state, "it is not as it was written"), (&table, "its rows are not as they were written")] {
        let good = fs::read(file).expect("a file");
        let mut bad = good.clone();
        bad[9] ^= 1;
        fs::write(file, &bad).expect("written");
        refused(&at("ours"), short, Start::Resume, &[&file.display().to_string(), what]);
        let error = Total::of(&[at("ours")]).expect_err("damaged").to_string();
        assert!(error.contains(&file.display().to_string()) && error.contains(what), "{error}");
        fs::write(file, &good).expect("written");
    }
    fs::remove_file(&state).expect("removed");
    refused(&at("ours"), short, Start::Resume, &["comparison.json", "missing"]);
    run(&at("ours"), short, &BuiltIn, (Start::Overwrite, 1)).expect("begins anew");
}
