//! Pins `tune --mpi`: any number of ranks writes the bytes of one process, whoever is killed meanwhile.

use super::{Campaigns, Random, SETTINGS, ended, job_of, killed_again_and_again, program};
use assert_cmd::Command;
use std::fs;
use std::path::Path;

/// The best changes several times, and nothing differs under it.
const MODEL: &str = "cases/real/smallEdge.dda";

fn model() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(MODEL).to_string_lossy().into_owned()
}

/// A folder of its own.
fn place() -> Campaigns {
    Campaigns::new(SETTINGS)
}

/// A search in one process.
fn alone(place: &Campaigns, out: &str, more: &[&str]) {
    let mut command = Command::cargo_bin("rockproof").expect("the program");
    let output = command.current_dir(place.at("")).args(["tune", &model(), "--out", out]).args(more).output();
    let output = output.expect("runs");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

fn shared(place: &Campaigns, ranks: usize, out: &str, more: &[&str]) {
    let model = model();
    let arguments = [&[&model, "--out", out, "--threads", "1"], more].concat();
    let (code, said) = ended(job_of("tune", place, ranks, &arguments));
    assert_eq!(code, 0, "{ranks} ranks: {said}");
}

fn same(place: &Campaigns, names: &[&str], one: &str, other: &str) {
    for name in names {
        let read = |dir: &str| fs::read(place.at(dir).join(name)).expect("a file");
        assert!(read(one) == read(other), "{name} of {one} and {other}");
    }
}

const RESULTS: [&str; 3] = ["candidates.csv", "tune.md", "tolerances.toml"];
const ALL: [&str; 4] = ["candidates.csv", "tune.md", "tolerances.toml", "tune.json"];

#[test]
fn any_number_of_ranks_writes_what_one_process_writes() {
    let (place, count) = (place(), ["--candidates", "70", "--steps", "4"]);
    alone(&place, "whole", &count);
    for ranks in [1, 2, 3] {
        let out = format!("ranks{ranks}");
        shared(&place, ranks, &out, &count);
        same(&place, &ALL, &out, "whole");
    }
    // More candidates, with other ranks and without MPI.
    shared(&place, 3, "grown", &["--candidates", "5", "--steps", "4"]);
    alone(&place, "grown", &["--candidates", "9", "--resume"]);
    shared(&place, 2, "grown", &["--candidates", "70", "--resume"]);
    same(&place, &ALL, "grown", "whole");
}

#[test]
fn ranks_that_do_not_belong_together_are_refused_and_nothing_is_written() {
    let place = place();
    let other = model().replace("smallEdge", "smallAngle");
    let two = |arguments: &[&str]| {
        let mut job = job_of("tune", &place, 1, &[&model(), "--candidates", "3", "--out", "out"]);
        job.args([":", "-n", "1", &program(), "tune", "--mpi", "--candidates", "3", "--out", "out"]).args(arguments);
        ended(job)
    };
    let model = model();
    for (arguments, wanted) in [
        (&[&model, "--seed", "2"][..], "seed: rank 0 has 1, this rank has 2"),
        (&[&other], "model: rank 0 has"),
        (&["none.toml"], "none.toml: "),
    ] {
        let (code, said) = two(arguments);
        assert!(code == 2 && said.contains("error: rank 1 (") && said.contains(wanted), "{wanted}: {code}: {said}");
        assert!(!place.at("out").exists(), "{wanted}");
    }
    // What is wrong everywhere is said once.
    let (code, said) = ended(job_of("tune", &place, 3, &["none.toml", "--out", "out"]));
    assert!(code == 2 && said.matches("none.toml").count() == 1, "{code}: {said}");
}

fn bears(kills: u32, seed: u64) {
    let (place, count) = (place(), ["--candidates", "300", "--steps", "12"]);
    alone(&place, "whole", &count);
    let (mut random, model) = (Random(seed), model());
    let arguments = [&[&model, "--out", "killed", "--resume", "--threads", "1"], &count[..]].concat();
    let job = |ranks| job_of("tune", &place, ranks, &arguments);
    let done = killed_again_and_again(&place.at("killed"), &job, kills, &mut random);
    shared(&place, 3, "killed", &[&["--resume"], &count[..]].concat());
    same(&place, &RESULTS, "killed", "whole");
    println!("workers killed {}, rank 0 {}, whole jobs {}, jobs asked to end {}", done[0], done[1], done[2], done[3]);
}

#[test]
fn a_job_that_is_killed_goes_on_to_the_same_bytes() {
    bears(4, 55);
}

#[test]
#[ignore = "minutes: 40 kills; by hand after changes of who does what when"]
fn a_job_killed_forty_times_goes_on_to_the_same_bytes() {
    (0..10).for_each(|seed| bears(4, 100 + seed));
}
