//! Pins that a search on many processes is the search of one, whoever is slow, stopped or refused. Threads stand for the processes.

use crate::thread_ranks::Threads;
use rockproof_campaign::distribute::ranks::end_workers;
use rockproof_campaign::distribute::{DistributeError, Introduction, Transport};
use rockproof_campaign::part::Machine;
use rockproof_model::{Precision, Scene, ToleranceSpec};
use rockproof_results::{Start, digest};
use rockproof_tune::distribute::{Crew, SearchTask, StopCriterion, serve};
use rockproof_tune::report::{as_toml, markdown};
use rockproof_tune::{Evaluator, Search, SearchRecord, TuneError, UnauditedEvaluator};
use serde_json::{Map, Value};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// A model, and how many candidates are tried on it. `auto` is what its author uses.
#[derive(Clone, Copy)]
struct Model {
    file: &'static str,
    candidates: usize,
}

/// The best changes four times, once beside a candidate that differs from what was expected.
const CHANGING: Model = Model { file: "smallAngle.dda", candidates: 15 };

/// 19 of its pairs overlap.
const OVERLAPPING: Model = Model { file: "slope_joints.dda", candidates: 2 };

const SEED: u64 = 1;

impl Model {
    fn scene(self) -> Scene {
        Scene::load(Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/real").join(self.file)).expect("a scene")
    }

    fn unaudited(self) -> UnauditedEvaluator {
        UnauditedEvaluator::new(&self.scene(), Precision::F64, SEED, Some(1), 0).expect("an evaluator")
    }

    fn identity(self) -> Map<String, Value> {
        Map::from_iter([("model".to_owned(), digest(self.file.as_bytes()).into())])
    }

    fn introduction(self, answers: &str) -> Introduction {
        let [os, architecture] = ["toy", "toy"].map(str::to_owned);
        let machine = Machine { os, architecture, answers: answers.to_owned() };
        Introduction { host: format!("host-{answers}"), threads: 1, work: Ok((self.identity(), machine)) }
    }

    /// What one process writes.
    fn whole(self) -> Written {
        let dir = crate::place::folder();
        let evaluator = self.unaudited().audited();
        let mut search = Search::new(&evaluator, &ToleranceSpec::default(), SEED).expect("a search");
        let mut record = SearchRecord::open(dir.path(), &self.identity(), Start::Fresh, &mut search).expect("a record");
        while search.tried().len() < self.candidates {
            search.step().expect("measures");
            record.commit(&search).expect("writes");
        }
        written(dir.path(), &evaluator, &search)
    }
}

/// What a search leaves: `candidates.csv` and `tune.json`, the report and the set.
type Written = [String; 4];

fn written(dir: &Path, evaluator: &Evaluator, search: &Search<'_>) -> Written {
    let [table, about] = ["candidates.csv", "tune.json"].map(|name| fs::read_to_string(dir.join(name)).expect(name));
    let best = &search.tried()[search.best().expect("a best")];
    [table, about, markdown("model", evaluator, search), as_toml(&best.set)]
}

/// What may go wrong.
#[derive(Clone, Copy, Default)]
struct Trouble {
    /// After so many candidates rank 0 is to stop; 0 for never.
    stop_after: usize,
    /// The last worker is told to stop at once.
    stopped_worker: bool,
    /// Every so-many-th message of the last worker is cut in half, unless it is one of few bytes; 0 for none.
    damage: u64,
    /// The last worker answers otherwise.
    other_answers: bool,
    /// The last worker reads this model.
    other_model: Option<Model>,
}

/// Searches or goes on with so many ranks. `None` where it is stopped before anything can be tried.
fn run(model: Model, dir: &Path, ranks: usize, trouble: Trouble) -> Result<Option<Written>, TuneError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let author = ToleranceSpec::default();
    let mut all = Threads::all(ranks);
    let mut first = all.remove(0);
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let last = all.len();
        for mut transport in all {
            let is_last = transport.own == last;
            let trouble = if is_last { trouble } else { Trouble::default() };
            transport.damage = trouble.damage;
            let model = trouble.other_model.unwrap_or(model);
            let introduction = model.introduction(if trouble.other_answers { "other" } else { "toy" });
            // Only one rank is told to stop; the others must hear of it.
            let own_stop = AtomicBool::new(trouble.stopped_worker);
            let (author, pool) = (&author, &pool);
            scope.spawn(move || {
                let task = SearchTask { evaluator: model.unaudited(), author, seed: SEED, pool };
                serve(Some(task), &mut transport, &introduction, &own_stop)
            });
        }
        let led = (|| {
            let own = model.introduction("toy");
            let Some(mut crew) = Crew::gather(&mut first, &own, &pool, &stop)? else { return Ok(None) };
            let Some(evaluator) = crew.audited(model.unaudited(), &stop)? else { return Ok(None) };
            let mut search = Search::new(&evaluator, &author, SEED)?;
            let mut record = SearchRecord::open(dir, &model.identity(), Start::Resume, &mut search)?;
            let reached = |tried: usize| tried >= model.candidates;
            let enough = StopCriterion { reached: &reached, most: Some(model.candidates) };
            crew.search(&mut search, &enough, &stop, &mut |search| {
                stop.store(search.tried().len() == trouble.stop_after, Ordering::SeqCst);
                record.commit(search).map_err(TuneError::from)
            })?;
            Ok(search.best().map(|_| written(dir, &evaluator, &search)))
        })();
        end_workers(&mut first).expect("a message");
        led
    })
}

#[test]
fn any_number_of_ranks_writes_what_one_process_writes() {
    for (model, counts) in [(CHANGING, &[1, 2, 3, 5][..]), (OVERLAPPING, &[3])] {
        let whole = model.whole();
        for &ranks in counts {
            let dir = crate::place::folder();
            let found = run(model, dir.path(), ranks, Trouble::default()).expect("searches");
            assert!(found.as_ref() == Some(&whole), "{}, {ranks} ranks: {found:?} is not {whole:?}", model.file);
        }
    }
}

#[test]
fn what_is_stopped_goes_on_with_other_ranks_to_the_same_bytes() {
    let whole = CHANGING.whole();
    let dir = crate::place::folder();
    for (stop_after, ranks) in [(1, 3), (6, 2), (7, 4), (0, 2)] {
        let found = run(CHANGING, dir.path(), ranks, Trouble { stop_after, ..Trouble::default() }).expect("searches");
        let [table, ..] = found.as_ref().expect("something was tried");
        let tried = if stop_after == 0 { CHANGING.candidates } else { stop_after };
        assert_eq!(table.lines().count(), tried + 1, "{table}");
        assert_eq!(found.as_ref() == Some(&whole), stop_after == 0, "stopped after {stop_after}");
    }
    // Whom a worker tells that it was told to stop.
    let dir = crate::place::folder();
    let found = run(CHANGING, dir.path(), 3, Trouble { stopped_worker: true, ..Trouble::default() }).expect("stops");
    assert!(found.is_none_or(|[table, ..]| table.lines().count() < whole[0].lines().count()));
}

#[test]
fn a_rank_that_does_not_belong_is_named_and_nothing_is_written() {
    let dir = crate::place::folder();
    let out = dir.path().join("out");
    let other_answers = Trouble { other_answers: true, ..Trouble::default() };
    let error = run(CHANGING, &out, 3, other_answers).expect_err("refused");
    let text = error.to_string();
    assert!(matches!(error, TuneError::Distribute(DistributeError::Answers { rank: 2, .. })), "{text}");
    let other_model = Trouble { other_model: Some(OVERLAPPING), ..Trouble::default() };
    let error = run(CHANGING, &out, 3, other_model).expect_err("refused");
    let text = error.to_string();
    assert!(matches!(error, TuneError::Distribute(DistributeError::Configuration { rank: 2, .. })), "{text}");
    assert!(text.contains("rank 2 (host-toy)") && text.contains("model: rank 0 has") && !out.exists(), "{text}");
}

#[test]
fn a_damaged_message_ends_the_search_and_what_is_there_goes_on() {
    let whole = CHANGING.whole();
    for damage in [3, 4] {
        let dir = crate::place::folder();
        let error = run(CHANGING, dir.path(), 3, Trouble { damage, ..Trouble::default() }).expect_err("damaged");
        let text = error.to_string();
        assert!(text.starts_with("rank 2 sent a message that cannot be read"), "{text}");
        assert!(run(CHANGING, dir.path(), 2, Trouble::default()).expect("searches") == Some(whole.clone()));
    }
}

/// Sends what no worker sends.
#[test]
fn what_nobody_asked_for_is_refused_by_name() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("threads");
    let overlaps = [&[2, 0, 1, 9, 9, 1, 49, 0][..], &[2, 0, 1, 0, 1, 1, 120, 0]];
    let done = [2, 1, 5, 1, 1, 0];
    for message in [overlaps[0], overlaps[1], &done, &[0], &[9, 9, 9], &[]] {
        let mut all = Threads::all(2);
        let mut worker = all.remove(1);
        let introduction = CHANGING.introduction("toy");
        worker.send(0, &serde_json::to_vec(&introduction).expect("JSON"));
        worker.send(0, message);
        let stop = AtomicBool::new(false);
        let crew = Crew::gather(&mut all[0], &introduction, &pool, &stop).expect("gathers");
        let told = crew.expect("a crew").audited(CHANGING.unaudited(), &stop).err().expect("refused").to_string();
        assert!(told.starts_with("rank 1 sent a message that cannot be read: "), "{message:?}: {told}");
    }
}
