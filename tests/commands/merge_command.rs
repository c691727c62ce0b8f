//! Pins `campaign --part` and `merge`: parts put together are the campaign that one machine would have made, byte for byte; what does not
//! belong together is refused by name, and nothing is written then.

use crate::campaigns::{Campaigns, SETTINGS, files};
use crate::engines::client;
use crate::processes::{begin, until};
use std::fs;
use std::path::Path;

fn lines(file: &Path) -> usize {
    fs::read_to_string(file).expect("a table").lines().count()
}

#[test]
fn parts_put_together_are_the_campaign_of_one_machine() {
    put_together(&[3]);
}

#[test]
#[ignore = "half a minute; .ci/run runs it"]
fn any_number_of_parts_put_together_is_the_campaign_of_one_machine_at_full_size() {
    put_together(&[3, 1, 7]);
}

fn put_together(numbers: &[u64]) {
    let place = Campaigns::new(SETTINGS);
    place.campaign("whole", &["--threads", "1"]);
    let cases = fs::read_dir(place.at("whole/cases")).expect("cases").count();
    assert!(cases > 12, "{cases} cases");
    let mut without_case = 0;
    for &of in numbers {
        let parts = place.parts(of, &[]);
        for part in &parts {
            assert_eq!(fs::read_dir(place.at(part).join("cases")).expect("a folder").count(), 0, "made by the merge");
            without_case += lines(&place.at(part).join("no_case.csv")) - 1;
        }
        let out = format!("merged{of}");
        place.merge(&parts, &out, &["--threads", &(of % 2 + 1).to_string()]);
        place.same("whole", &out);
        let run = fs::read(place.at(&out).join("run.json")).expect("run.json");
        let run: serde_json::Value = serde_json::from_slice(&run).expect("JSON");
        assert_eq!((&run["finished"], &run["pairs"]), (&true.into(), &250.into()));
    }
    assert!(without_case > 0, "findings that cannot have a case are kept from being tried again");
    // It is a campaign as any other: finished, and readable.
    place.campaign("merged3", &["--resume"]);
    place.works(&["report", "merged3", "--format", "markdown"]);
    let merge = ["merge", "part1of3", "part2of3", "part3of3", "--out", "merged3"];
    assert_eq!(place.run(&[&merge[..], &["--overwrite", "--deny", "tolerance"]].concat()).0, 1);
    place.works(&[&merge[..], &["--resume"]].concat());
    place.same("whole", "merged3");
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn a_part_that_was_killed_goes_on_to_the_same_bytes() {
    // Here cases run out of places as well.
    let settings = SETTINGS.replace("chunk = 48", "chunk = 16").replace("per_cause = 60", "per_cause = 8");
    let place = Campaigns::new(&settings);
    place.campaign("whole", &[]);
    let arguments = ["campaign", "campaign.toml", "--part", "2/2", "--out", "part2", "--threads", "1"];
    let mut killed = begin(&place.at(""), &arguments);
    let committed = || {
        let text = fs::read_to_string(place.at("part2/progress.json")).unwrap_or_default();
        !text.is_empty() && !text.contains("\"pairs_done\":0,")
    };
    until("a chunk is written", committed);
    killed.kill().expect("killed");
    killed.wait().expect("ended");
    let torn = place.at("part2/findings.csv");
    fs::write(&torn, [fs::read(&torn).expect("rows"), b"249,sliver,ba".to_vec()].concat()).expect("write");
    place.works(&[&arguments[..], &["--resume"]].concat());
    place.campaign("part1", &["--part", "1/2"]);
    place.merge(&["part1".to_owned(), "part2".to_owned()], "merged", &[]);
    place.same("whole", "merged");
}

#[test]
fn an_external_engine_and_a_grid_are_put_together_too() {
    let grid = "pairs = 224\nchunk = 64\nfamilies = [\"edge_cross\", \"sliver\"]\nshrink_evaluations = 10\n\
                [grid]\nbase = \"auto\"\nterritory = [0, 2]\n";
    let place = Campaigns::new(grid);
    place.campaign("whole", &[]);
    place.merge(&place.parts(3, &[]), "merged", &[]);
    place.same("whole", "merged");

    // What it says is so, or is not: fingerprints hold states.
    let place = Campaigns::new(
        "pairs = 192\nchunk = 64\nshrink_evaluations = 10\ncases_per_cause = 1\nfamilies = [\"face_stack\", \"edge_cross\"]\n",
    );
    let engine = format!("mine={} state", client());
    let asked = ["--engine-command", &engine];
    place.campaign("whole", &asked);
    let cases: Vec<String> = place.files("whole").into_keys().filter(|name| name.contains("mine")).collect();
    assert!(cases.iter().any(|name| name.contains("overlapping-apart")), "{cases:?}");
    // There is room for one; the others were further from any tie than all before.
    assert!(cases.iter().filter(|name| name.contains("-engine-")).count() > 1, "{cases:?}");
    let parts = place.parts(2, &asked);
    place.merge(&parts, "merged", &[]);
    place.same("whole", "merged");
}

/// The counts of an engine: questions asked, processes started, failures that did not repeat, answers not compared.
fn counts(dir: &Path) -> Vec<u64> {
    let table = fs::read_to_string(dir.join("engines.csv")).expect("engines.csv");
    let row = table.lines().nth(1).expect("a row");
    row.split(',').skip(1).take(4).map(|count| count.parse().expect("a count")).collect()
}

#[test]
fn what_engines_were_put_through_adds_up() {
    let place = Campaigns::new("pairs = 64\nchunk = 32\nfamilies = [\"face_stack\"]\nshrink_evaluations = 10\n");
    // It crashes on every second question.
    let engine = format!("mine={} second", client());
    let asked = ["--engine", "mine", "--engine-command", &engine];
    let parts = place.parts(2, &asked);
    let (code, out, err) = place.run(&["merge", &parts[0], &parts[1], "--out", "merged", "--deny", "recovered"]);
    assert!(code == 1 && err.contains("there are failures that were recovered"), "{out}{err}");
    assert!(out.contains("were answered by a fresh process"), "{out}");
    let [one, two, merged] = [parts[0].as_str(), &parts[1], "merged"].map(|dir| counts(&place.at(dir)));
    // The merge asks again about the findings that it makes cases of.
    let sums = one.iter().zip(&two).map(|(one, two)| one + two);
    assert!(sums.zip(&merged).take(3).all(|(sum, merged)| sum > 0 && *merged > sum), "{one:?}, {two:?}: {merged:?}");
    let run: serde_json::Value =
        serde_json::from_slice(&fs::read(place.at("merged/run.json")).expect("run.json")).expect("JSON");
    assert_eq!(run["external_engines"]["mine"]["recovered"], merged[2]);
    // What came to its end is not added to by asking for it again.
    place.works(&["merge", &parts[0], &parts[1], "--out", "merged", "--resume"]);
    assert_eq!(counts(&place.at("merged")), merged);
}

#[test]
fn a_stress_set_is_put_together_with_its_tables() {
    let place = Campaigns::new("");
    let (whole, _) = crate::stress_command::whole();
    let whole = whole.to_str().expect("UTF-8");
    for (out, part) in [("one", "1/2"), ("two", "2/2")] {
        place.works(&["campaign", "--stress", "--pairs", crate::stress_command::PAIRS, "--out", out, "--part", part]);
    }
    assert!(!place.at("one/stress.csv").exists());
    place.merge(&["one".to_owned(), "two".to_owned()], "merged", &[]);
    assert!(place.at("merged/limits.csv").exists());
    place.same(whole, "merged");
}

/// Changes what a part's `progress.json` says, and seals it again.
fn forge(file: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(file).expect("progress");
    let (body, _) = text.rsplit_once(",\"sha256\":").expect("a seal");
    assert!(body.contains(from), "{from}");
    let body = body.replacen(from, to, 1);
    let seal = rockproof_results::digest(body.as_bytes());
    fs::write(file, format!("{body},\"sha256\":\"{seal}\"}}\n")).expect("write");
}

fn merge<'p>(parts: &[&'p str]) -> Vec<&'p str> {
    [&["merge", "--out", "out"], parts].concat()
}

fn copy(from: &Path, to: &Path) {
    for (name, bytes) in files(from, "") {
        let file = to.join(name);
        fs::create_dir_all(file.parent().expect("a folder")).expect("made");
        fs::write(file, bytes).expect("write");
    }
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let small = "pairs = 96\nchunk = 16\nfamilies = [\"sliver\"]\ntolerances = [\"auto\"]\nsteps_every = 0\nshrink_evaluations = 3\n";
    let place = Campaigns::new(small);
    let [one, two, three] = <[String; 3]>::try_from(place.parts(3, &[])).expect("three");
    let forged = |name: &str, from: &str, to: &str| {
        copy(&place.at(&two), &place.at(name));
        forge(&place.at(name).join("progress.json"), from, to);
    };
    place.refuses(&merge(&[&one, &three]), &["of 3 parts 2 is missing", "--partial"]);
    place.refuses(&merge(&[&three]), &["1, 2 are missing"]);
    place.refuses(&merge(&[&one, &two, &three, &two]), &["part 2/3 is there twice"]);
    copy(&place.at(&two), &place.at("again"));
    place.refuses(&merge(&[&one, &two, &three, "again"]), &["part 2/3 is there twice", "again", &two]);
    place.campaign("other_seed", &["--part", "2/3", "--seed", "9"]);
    place.refuses(&merge(&[&one, "other_seed", &three]), &["other_seed", &one, "seed: 9 there, 1 here"]);
    place.campaign("other_pairs", &["--part", "2/3", "--pairs", "112"]);
    place.refuses(&merge(&[&one, "other_pairs", &three]), &["other_pairs", "pairs: 112 there, 96 here"]);
    place.campaign("other_split", &["--part", "2/4"]);
    place.refuses(&merge(&[&one, "other_split", &three]), &["other_split", "2/4", "1/3"]);
    place.campaign("whole", &[]);
    place.refuses(&merge(&[&one, "whole", &three]), &["whole", "no part"]);
    let version = env!("CARGO_PKG_VERSION");
    forged("other_version", &format!("\"version\":\"{version}\""), "\"version\":\"0.0.9\"");
    place.refuses(&merge(&[&one, "other_version", &three]), &["other_version", "0.0.9", version]);
    forged("other_machine", "\"answers\":\"", "\"answers\":\"0");
    place.refuses(&merge(&[&one, "other_machine", &three]), &["other_machine", "part 2/3", "answer the first pairs"]);
    forged("other_machine_alone", "\"part\":\"2/3\"", "\"part\":\"1/1\"");
    forge(&place.at("other_machine_alone/progress.json"), "\"answers\":\"", "\"answers\":\"0");
    place.refuses(&merge(&["other_machine_alone"]), &["other_machine_alone", "this program"]);
    forged("damaged", "\"seconds\":", "\"seconds\":");
    let findings = place.at("damaged/findings.csv");
    let text = fs::read_to_string(&findings).expect("rows").replacen("sliver", "Sliver", 1);
    fs::write(&findings, text).expect("write");
    place.refuses(&merge(&[&one, "damaged", &three]), &["damaged/findings.csv", "not as they were written"]);
    fs::create_dir(place.at("empty")).expect("made");
    place.refuses(&merge(&[&one, "empty", &three]), &["empty", "rockproof.manifest.json"]);
    place.refuses(&merge(&[&one, "nowhere", &three]), &["nowhere", "no such directory"]);
    place.refuses(&["campaign", "campaign.toml", "--part", "4/3", "--out", "out"], &["4/3", "K from 1 to N"]);
    // Neither is a part another one, nor the whole.
    let again = ["campaign", "campaign.toml", "--out", &two, "--resume"];
    place.refuses(&again, &["part: the run has \"2/3\""]);
    place.refuses(&[&again[..], &["--part", "1/3"]].concat(), &["part: the run has \"2/3\", asked for is \"1/3\""]);
    // Of more pairs it would be other pairs.
    let more = [&again[..], &["--part", "2/3", "--pairs", "192"]].concat();
    place.refuses(&more, &["pairs: the run has 96, asked for is 192"]);
    let said = place.works(&[&again[..], &["--part", "2/3"]].concat());
    assert!(said.contains("when all parts are done (this is 2/3): rockproof merge"), "{said}");
    let (code, _, err) = place.run(&["merge", &one, &two, &three, "--out", &two, "--overwrite"]);
    assert!(code == 2 && err.contains("one of the parts"), "{err}");
    let (code, _, err) = place.run(&["merge", &one, &two, &three, "--out", "whole"]);
    assert!(code == 2 && err.contains("holds a campaign already"), "{err}");
    place.merge(&[one, two, three], "merged", &[]);
    place.same("whole", "merged");
    // What was put together goes on to more pairs as a campaign does.
    for run in ["whole", "merged"] {
        place.campaign(run, &["--resume", "--pairs", "128"]);
    }
    place.same("whole", "merged");
}

#[test]
fn input_files_that_changed_are_refused() {
    let place = Campaigns::new("");
    let cube = "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n[[block]]\nbox = { min = [0, 0, 1], max = [1, 1, 2] }\n";
    fs::write(place.at("mine.toml"), cube).expect("write");
    fs::write(
        place.at("campaign.toml"),
        "pairs = 32\nfamilies = [\"real\"]\nreal = [\"mine.toml\"]\ntolerances = [\"auto\"]\nsteps_every = 0\nshrink_evaluations = 3\n",
    )
    .expect("write");
    let parts = place.parts(2, &[]);
    fs::write(place.at("mine.toml"), cube.replace('2', "3")).expect("write");
    place.refuses(&["merge", &parts[0], &parts[1], "--out", "out"], &["content of mine.toml", "in the parts", "here"]);
    fs::write(place.at("mine.toml"), cube).expect("write");
    place.merge(&parts, "merged", &[]);
    place.campaign("whole", &[]);
    place.same("whole", "merged");
}

#[test]
fn a_partial_merge_says_what_it_is() {
    let place = Campaigns::new(&SETTINGS.replace("steps_every = 3", "steps_every = 0"));
    let parts = place.parts(3, &[]);
    let text = place.works(&["merge", &parts[2], &parts[0], "--partial", "--out", "some"]);
    assert!(text.starts_with("Exactly right on hard pairs: "), "{text}");
    assert!(text.contains("not the whole campaign: parts 1, 3 of 3, 170 of 250 pairs"), "{text}");
    let run = fs::read(place.at("some/run.json")).expect("run.json");
    let run: serde_json::Value = serde_json::from_slice(&run).expect("JSON");
    assert_eq!((&run["finished"], &run["parts"]["there"]), (&false.into(), &"1, 3 of 3".into()));
    let rows = |dir: &str| lines(&place.at(dir).join("findings.csv")) - 1;
    assert_eq!(rows("some"), rows(&parts[0]) + rows(&parts[2]));
    assert!(fs::read_dir(place.at("some/cases")).expect("cases").count() > 2);
    let report = place.works(&["report", "some", "--format", "markdown"]);
    assert!(!report.is_empty());
    place.works(&["report", "some"]);
    let table = fs::read_to_string(place.at("some/report/tables/runs.csv")).expect("a table");
    assert!(table.contains("no, parts 1, 3 of 3"), "{table}");
    let (code, _, err) = place.run(&["campaign", "campaign.toml", "--out", "some", "--resume"]);
    assert!(code == 2 && err.contains("parts: the run has \"1, 3 of 3\""), "{err}");
    // With all parts it is the whole.
    place.merge(&parts, "all", &["--partial"]);
    place.campaign("whole", &[]);
    place.same("whole", "all");
}
