//! Mistakes planted in the oracle, one at a time: each is found by a test of the oracle.
//!
//! `planted/*.toml` lists them: a text of a source file that occurs once, and the mistaken text. The library holds none of it: the large
//! test copies the sources, puts a choice between right and mistaken at every place, builds the copy once, and runs for each mistake
//! the test that is said to find it. The quick tests hold that every text still occurs, that every test is there, and that docs/validation.md lists
//! the mistakes.

#[path = "planted/copy.rs"]
mod copy;
#[path = "planted/list.rs"]
mod list;

use copy::{Copy, Outcome};
use list::{Mistake, mistakes};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Fewer would be too few.
const MIN_MISTAKES: usize = 60;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/validation.md");
const BEGIN: &str = "<!-- oracle mistakes: begin -->\n";
const END: &str = "<!-- oracle mistakes: end -->\n";

#[test]
fn every_mistake_has_its_place_in_the_sources() {
    let mistakes = mistakes();
    let names: BTreeSet<&str> = mistakes.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names.len(), mistakes.len(), "two mistakes have one name");
    assert!(mistakes.len() >= MIN_MISTAKES, "{} mistakes", mistakes.len());
    // Panics where a text does not occur, occurs twice, or two overlap.
    let changed = copy::changed_sources(&mistakes);
    assert!(changed.values().all(|text| text.contains("crate::planted::number()")));
}

/// The text of a Rust file and of all in the folder of its name.
fn module(stem: &Path) -> String {
    let mut text = std::fs::read_to_string(stem.with_extension("rs")).unwrap_or_default();
    for entry in std::fs::read_dir(stem).into_iter().flatten() {
        text += &module(&entry.unwrap().path().with_extension(""));
    }
    text
}

#[test]
fn the_test_that_finds_a_mistake_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for Mistake { name, found_by, .. } in mistakes() {
        let (program, test) = found_by.split_once(' ').expect("a program and a test");
        let (modules, function) = test.rsplit_once("::").unwrap_or(("", test));
        let stem = match program {
            "lib" => root.join("src").join(modules.split("::").next().unwrap_or_default()),
            _ => root.join("tests").join(program),
        };
        assert!(module(&stem).contains(&format!("fn {function}(")), "{name}: no test \"{found_by}\"");
    }
}

#[test]
fn the_page_lists_the_mistakes() {
    let mut table = String::from("| mistake | in `oracle/src` | found by |\n| --- | --- | --- |\n");
    for Mistake { name, file, found_by, .. } in mistakes() {
        let file = file.trim_start_matches("src/");
        table += &format!("| {name} | `{file}` | `{found_by}` |\n");
    }
    let page = std::fs::read_to_string(PAGE).unwrap();
    let (before, rest) = page.split_once(BEGIN).expect("the page has the mark of the table's begin");
    let (listed, after) = rest.split_once(END).expect("the page has the mark of the table's end");
    if std::env::var_os("ROCKPROOF_RENEW").is_some() {
        std::fs::write(PAGE, format!("{before}{BEGIN}{table}{END}{after}")).unwrap();
        return;
    }
    assert!(listed == table, "docs/validation.md lists other mistakes: renew it with ROCKPROOF_RENEW=1");
}

/// With `ROCKPROOF_MISTAKES` only those whose name holds that text are planted.
#[test]
#[ignore = "builds the oracle anew and takes minutes: --release -- --ignored --nocapture"]
fn every_mistake_is_found() {
    let all = mistakes();
    let wanted = std::env::var("ROCKPROOF_MISTAKES").unwrap_or_default();
    let planted: Vec<&Mistake> = all.iter().filter(|mistake| mistake.name.contains(&wanted)).collect();
    let finders: BTreeSet<&str> = planted.iter().map(|m| m.found_by.as_str()).collect();
    let copy = Copy::build(&all, &finders);
    for finder in &finders {
        assert_eq!(copy.run(0, finder), Outcome::Passed, "{finder}, with no mistake planted");
    }
    let (next, missed) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(mistake) = planted.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let outcome = copy.run(mistake.number, &mistake.found_by);
                    println!("{:3} {:70} {} {outcome:?}", mistake.number, mistake.name, mistake.found_by);
                    if outcome == Outcome::Passed {
                        missed.lock().unwrap().push(&mistake.name);
                    }
                }
            });
        }
    });
    let missed = missed.into_inner().unwrap();
    println!("{} mistakes, {} not found", planted.len(), missed.len());
    assert!(missed.is_empty(), "not found: {missed:#?}");
}
