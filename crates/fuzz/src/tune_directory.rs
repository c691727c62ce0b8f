//! The directory of `tune` with one file damaged: a search that is taken up has the candidates that were written, or an error names a file.

use crate::Target;
use crate::dice::Dice;
use crate::reach::Reach;
use crate::run_directory::{Damage, files, input, resealed, write};
use crate::scratch::{new_folder, scratch};
use rockproof_model::scene::SceneFormat;
use rockproof_model::{Precision, Scene, ToleranceSpec};
use rockproof_results::{MANIFEST, Start, digest};
use rockproof_tune::{Evaluator, RecordError, Search, SearchRecord, UnauditedEvaluator};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

/// A block on another one.
const SCENE: &str = r#"
[[block]]
fixed = true
box = { min = [-2, -2, -1], max = [2, 2, 0] }

[[block]]
box = { min = [0, 0, 0], max = [1, 1, 1] }
"#;

const ABOUT: &str = "tune.json";
const TABLE: &str = "candidates.csv";
/// What a search goes on from.
const GONE_ON_FROM: [&str; 3] = [MANIFEST, ABOUT, TABLE];
const SEED: u64 = 1;
/// Candidates that are drawn, beside those that are given.
const DRAWN: usize = 3;

fn evaluator() -> &'static Evaluator {
    static EVALUATOR: OnceLock<Evaluator> = OnceLock::new();
    EVALUATOR.get_or_init(|| {
        let scene = Scene::parse(SCENE, SceneFormat::Toml, Path::new("scene.toml")).expect("a scene");
        UnauditedEvaluator::new(&scene, Precision::F64, SEED, Some(1), 0).expect("an evaluator").audited()
    })
}

fn new_search() -> Search<'static> {
    Search::new(evaluator(), &ToleranceSpec::default(), SEED).expect("a search")
}

fn identity() -> Map<String, Value> {
    Map::from_iter([("model".to_owned(), "two blocks".into()), ("steps".to_owned(), 1.into())])
}

/// The files of a search. The first candidate is measured, the others are as good.
fn searched() -> &'static BTreeMap<String, Vec<u8>> {
    static FILES: OnceLock<BTreeMap<String, Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| {
        let folder = new_folder();
        let dir = folder.path().join("search");
        let mut search = new_search();
        let mut record = SearchRecord::open(&dir, &identity(), Start::Fresh, &mut search).expect("a directory");
        let measurement = search.step().expect("a measurement").measurement.clone();
        record.commit(&search).expect("a table");
        for _ in 1..search.initial_count() + DRAWN {
            let next = search.candidate();
            search.add(next, measurement.clone());
        }
        record.commit(&search).expect("a table");
        drop(record);
        files(&dir, "")
    })
}

/// Makes `tune.json` say that the table is the one that is there, as somebody would who means harm.
fn vouch_for_table(dir: &Path, table: &[u8]) {
    let about = searched().get(ABOUT).expect("tune.json");
    let mut about: Map<String, Value> = serde_json::from_slice(about).expect("tune.json is JSON");
    about.remove("sha256");
    about.insert("candidates_sha256".to_owned(), vec![digest(table); 2].into());
    let text = serde_json::to_string(&about).expect("JSON");
    fs::write(dir.join(ABOUT), resealed(text.trim_end_matches('}').as_bytes())).expect("a file");
}

/// A search that goes on: it takes up what is there and writes it again.
pub(crate) fn tune_directory(bytes: &[u8], reach: &mut Reach) {
    let Some(mut damage) = Damage::of(bytes, &GONE_ON_FROM) else { return reach.count("too-short") };
    let dir = scratch().join("searched");
    write(&dir, searched());
    if damage.resealed && damage.name == TABLE {
        let table = Damage::of(&[&[bytes[0], 0], &bytes[2..]].concat(), &GONE_ON_FROM).and_then(|plain| plain.bytes);
        vouch_for_table(&dir, table.as_deref().unwrap_or_default());
        damage.bytes = table;
    }
    damage.apply(&dir);
    let mut search = new_search();
    let taken_up =
        SearchRecord::open(&dir, &identity(), Start::Resume, &mut search).and_then(|mut record| record.commit(&search));
    match taken_up {
        Ok(()) if damage.resealed => {
            search.candidate();
            reach.count("resealed-read");
        }
        Ok(()) => {
            let table = fs::read(dir.join(TABLE)).ok();
            assert!(table.as_ref() == searched().get(TABLE), "{} was believed: the table is another one", damage.name);
            reach.count("whole");
        }
        Err(error) => {
            let message = error.to_string();
            let named = message.contains(&*dir.to_string_lossy()) || message.starts_with(TABLE);
            assert!(named, "no file is named: {message}");
            assert!(message.len() < 8_000, "a message of {} bytes: {message}", message.len());
            reach.count(match &error {
                RecordError::Results(error) => Reach::variant(error),
                RecordError::Csv(_) => "Csv".to_owned(),
            });
        }
    }
}

/// An input of [`tune_directory`].
pub(crate) fn tune_directory_input(_: &Target, dice: &mut Dice) -> Vec<u8> {
    input(&GONE_ON_FROM, searched(), dice)
}
