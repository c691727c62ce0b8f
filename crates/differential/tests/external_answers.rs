//! What external engines are blamed for, and what they are not.
#![cfg(unix)]

use rockproof_differential::engine::{Answer, Engine, EngineFailure};
use rockproof_differential::external::spec::NumberFormat;
use rockproof_differential::external::{EngineSpec, External};
use rockproof_differential::hull::convex_hull;
use rockproof_model::preset::{self, Preset};
use rockproof_model::{Block, Number, Point, Precision, ToleranceSet};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// One test at a time: a limit holds for all threads of this process.
static ALONE: Mutex<()> = Mutex::new(());

fn cube(x: i32) -> Block {
    let corner = |n: i32| {
        let [x, y, z] = [x + (n & 1), (n >> 1) & 1, (n >> 2) & 1].map(Number::from_integer);
        Point::new(x, y, z)
    };
    convex_hull(&(0..8).map(corner).collect::<Vec<_>>()).expect("a cube")
}

/// A shell script that answers for an engine.
fn engine(script: &str, ask_twice: bool) -> External {
    let command = ["sh", "-c", script].map(str::to_owned).to_vec();
    let (name, precision) = ("mine".to_owned(), NumberFormat::F64);
    External::new(EngineSpec { name, command, precision, timeout_ms: 20_000, accuracy: 1024 }, ask_twice)
}

/// Asks about two cubes.
fn ask(engine: &External) -> Result<Answer, EngineFailure> {
    let (a, b) = (cube(0), cube(2));
    let tolerances: ToleranceSet = preset::derive(Preset::Auto, &[&a, &b], Precision::F64).expect("tolerances");
    engine.prepare(&a, &b)?.answer(&tolerances)
}

#[test]
fn what_this_process_lacks_is_not_the_engines_fault() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let engine =
        engine("n=0; while read line; do echo \"{\\\"id\\\":$n,\\\"contacts\\\":[]}\"; n=$((n+1)); done", false);
    assert_eq!(ask(&engine), Ok(Answer::Contacts(Vec::new())));
    assert_eq!(engine.shortage(), None);
    let missing =
        External::new(EngineSpec { command: vec!["/no/such/program".to_owned()], ..engine.spec().clone() }, false);
    assert!(matches!(ask(&missing), Err(EngineFailure::Crashed(_))));
    assert_eq!(missing.shortage(), None, "a program that is not there is its own fault");
    let fresh = External::new(engine.spec().clone(), true);
    let limit = getrlimit(Resource::Nofile);
    setrlimit(Resource::Nofile, Rlimit { current: Some(4), maximum: limit.maximum }).expect("a limit");
    let answers = [ask(&fresh), ask(&engine)];
    setrlimit(Resource::Nofile, limit).expect("a limit");
    assert!(answers[0].is_err() && answers[1].is_ok(), "{answers:?}");
    let told = fresh.shortage().expect("told").to_string();
    assert!(told.contains("\"mine\"") && told.contains("cannot start sh") && told.contains("--threads"), "{told}");
    assert_eq!(engine.shortage(), None);
}

#[test]
fn a_line_that_nobody_asked_for_is_no_matter_of_a_fresh_process() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let late =
        "n=0; while read line; do echo \"{\\\"id\\\":$n,\\\"contacts\\\":[]}\"; n=$((n+1)); sleep 0.2; echo late; done";
    let stale = "while read line; do echo '{\"id\":0,\"contacts\":[]}'; done";
    // The next question is asked before this line comes, and read after it.
    let while_asked = "n=0; while read line; do [ $n -gt 0 ] && echo late && sleep 0.02; echo \"{\\\"id\\\":$n,\\\"contacts\\\":[]}\"; n=$((n+1)); done";
    let check = |script: &str, what: &str, ask_twice: bool| {
        let engine = engine(script, ask_twice);
        for round in 0..2 {
            assert_eq!(ask(&engine), Ok(Answer::Contacts(Vec::new())), "{script} {ask_twice} {round}");
            std::thread::sleep(Duration::from_millis(500));
            let second = ask(&engine);
            let told = matches!(&second, Err(EngineFailure::Malformed(told)) if told.contains(what));
            assert!(told, "{script} {ask_twice} {round}: {second:?}");
            if ask_twice {
                // The other process is as it was.
                assert!(ask(&engine).is_err());
            }
        }
        assert_eq!(engine.counts().map(|counts| counts.recovered), Some(0), "{script} {ask_twice}");
    };
    // All at once, since most of it is waiting.
    std::thread::scope(|scope| {
        for (script, what) in [(late, "nobody asked for"), (stale, "id is 0"), (while_asked, "")] {
            for ask_twice in [false, true] {
                scope.spawn(move || check(script, what, ask_twice));
            }
        }
    });
}

#[test]
fn what_is_wrong_with_an_answer_is_said() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let contact = |feature: &str| {
        format!("\\\"contacts\\\":[{{\\\"kind\\\":\\\"v-v\\\",\\\"feature_a\\\":{feature},\\\"feature_b\\\":0}}]")
    };
    let state = "\\\"contacts\\\":[],\\\"state\\\":\\\"apart\\\"";
    for (answer, told) in [
        (contact("1.0"), "feature_a is 1.0; allowed are 0 to 7, written without a point or an exponent"),
        (contact("8"), "feature_a is 8; allowed are 0 to 7, the block's vertices"),
        (state.to_owned(), "expected one of contacts, state, unsupported; given are contacts and state"),
        (
            "\\\"state\\\":\\\"apart\\\",\\\"gap_m\\\":-nan".to_owned(),
            "\\\"gap_m\\\":-nan}…; JSON has no NaN and no infinity: where a gap is none, leave its key out",
        ),
        ("\\\"contact\\\":[]".to_owned(), "expected one of contacts, state, unsupported; none is there"),
        (
            "\\\"state\\\":\\\"overlapping\\\",\\\"state\\\":\\\"apart\\\"".to_owned(),
            "the key \"state\" is there twice in one object",
        ),
        ("\\\"contacts\\\":[],\\\"contacts\\\":[]".to_owned(), "the key \"contacts\" is there twice in one object"),
        (contact("0,\\\"feature_a\\\":1"), "the key \"feature_a\" is there twice in one object"),
    ] {
        let said = ask(&engine(&format!("read line; echo \"{{\\\"id\\\":0,{answer}}}\"; read line"), false));
        assert!(matches!(&said, Err(EngineFailure::Malformed(what)) if what.contains(told)), "{answer}: {said:?}");
    }
}

#[test]
fn the_first_failures_that_a_fresh_process_repeats_are_kept() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let broken = engine("read line; printf 'near parallel edges\\n{}\\n'; read line", false);
    assert!(ask(&broken).is_err() && ask(&broken).is_err());
    let counts = broken.counts().expect("counts");
    let told =
        "malformed answer: output that nobody asked for: \"near parallel edges\"; each question has one line in answer";
    assert_eq!((counts.recovered, counts.first_repeated), (0, vec![told.to_owned()]));
}
