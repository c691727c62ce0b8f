//! What an external engine leaves unsaid of its contacts, or of how blocks lie, is not compared: the gate, campaigns, reports and `compare` tell it.
#![cfg(unix)]

use crate::engines::{client, cpp_client};
use crate::gates::{around, gate};
use crate::place::rockproof_in;

/// A gate around an engine, on few pairs.
fn around_few(command: &[String], rest: &str) -> String {
    around(&command.iter().map(String::as_str).collect::<Vec<_>>(), rest).replace("pairs = 256", "pairs = 32")
}

/// The client in `examples/` with all that it says of entrances and gaps left out.
fn bare() -> Vec<String> {
    let edit = r#"s/"entrance[_ab]*":[^,]*,//g; s/"gap_sign":[-0-9]*,//g"#;
    ["sh", "-c", &format!("'{}' | sed -u '{edit}'", client())].map(str::to_owned).to_vec()
}

/// A limit on what an engine leaves unsaid of its contacts is not looked at, and none on its answers; the others are, and it is said what is missing.
#[test]
fn a_limit_on_entrances_that_an_engine_never_gives_is_skipped() {
    let dir = crate::place::folder();
    let limit = |change: &str| format!("[[limit]]\nengine = \"mine\"\nchange = \"{change}\"\ncount = 9999\n");
    let unsaid = format!("{}{}", limit("gap-sign"), limit("entrance"));
    let ran = gate(dir.path(), &around_few(&bare(), &unsaid), &[], false);
    let rows: Vec<&str> = ran.out.lines().filter(|line| line.contains("mine gave neither entrance nor sign")).collect();
    assert!(ran.code == 1 && rows.len() == 2, "{}{}", ran.out, ran.err);
    assert!(
        rows.iter().all(|row| row.starts_with(" skip") && row.contains("what is not given is not compared")),
        "{rows:?}"
    );
    let row = ran.out.lines().find(|line| line.contains("engine mine answers")).expect("a row");
    assert!(row.contains("FAIL") && row.contains("whatever it answers would pass"), "{row}");
    assert!(row.contains("entrances and signs of gaps given for 0 of "), "{row}");

    let ran = gate(dir.path(), &around_few(&bare(), &format!("{unsaid}{}", limit("missing"))), &[], false);
    let told = "; mine answered 36 of 36 pairs, entrances and signs of gaps given for 0 of ";
    assert!(ran.code == 0 && ran.out.contains("gate passed: 2 passed, 2 skipped"), "{}{}", ran.out, ran.err);
    assert!(ran.out.contains(told), "{}", ran.out);
    let whole = around_few(&[client(), String::new()], &unsaid);
    let ran = gate(dir.path(), &whole, &[], false);
    assert!(ran.code == 0 && !ran.out.contains("signs of gaps given"), "{}{}", ran.out, ran.err);
}

/// An engine that leaves unsaid what it said when the baseline was written has no finding that is new, and fails all the same.
#[test]
fn an_engine_that_says_less_than_in_the_baseline_fails() {
    let dir = crate::place::folder();
    let baseline = "[baseline]\nfile = \"known.toml\"\n";
    let whole = around_few(&[client(), String::new()], baseline);
    let ran = gate(dir.path(), &whole, &["--update-baseline"], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let ran = gate(dir.path(), &whole, &[], false);
    assert!(ran.code == 0 && ran.out.contains("none new"), "{}{}", ran.out, ran.err);
    let less = around_few(&bare(), baseline);
    let ran = gate(dir.path(), &less, &[], false);
    let row = ran.out.lines().find(|line| line.contains("fixed: engine mine says less of its contacts"));
    let row = row.unwrap_or_else(|| panic!("{}{}", ran.out, ran.err));
    assert!(ran.code == 1 && row.contains("FAIL") && row.contains("given for 0 of "), "{row}");
    // A file of an earlier version says nothing of it.
    let file = dir.path().join("known.toml");
    let text = std::fs::read_to_string(&file).expect("a baseline");
    let (start, rest) = text.split_once("\n[said]\n").expect("what engines said");
    let known = rest.split_once("\n[known]\n").expect("the sorts").1;
    std::fs::write(&file, format!("{start}\n[known]\n{known}")).expect("write");
    let ran = gate(dir.path(), &less, &[], false);
    assert!(ran.code == 0 && ran.out.contains("none new"), "{}{}", ran.out, ran.err);
}

/// Campaigns say of how many contacts entrances were given, tables do not show 0 of what was never said, and `compare` tells an engine that says less.
#[test]
fn what_an_engine_leaves_unsaid_is_told_by_campaign_report_and_compare() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let campaign = |out: &str, command: &[String]| {
        let words: Vec<String> = command.iter().map(|word| toml::Value::from(word.as_str()).to_string()).collect();
        let text = format!(
            "pairs = 32\nengines = []\nfamilies = [\"face_stack\", \"edge_cross\"]\nshrink_evaluations = 0\nsteps_every = 0\n\
             [[external]]\nname = \"mine\"\ncommand = [{}]\n",
            words.join(", ")
        );
        std::fs::write(dir.join("few.toml"), text).expect("write");
        let (code, said, err) = rockproof_in(dir, &["campaign", "few.toml", "--out", out]);
        assert_eq!(code, 0, "{said}{err}");
        said
    };
    let whole = campaign("whole", &[client(), String::new()]);
    assert!(!whole.contains("signs of gaps given"), "{whole}");
    let said = campaign("bare", &bare());
    let told = "entrances and signs of gaps given for 0 of ";
    let lines = ["Exactly right on hard pairs: mine ", "mine: "].map(|start| {
        said.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{said}")).contains(told)
    });
    assert_eq!(lines, [true, true], "{said}");
    let (code, page, err) = rockproof_in(dir, &["report", "bare", "--format", "markdown"]);
    assert!(code == 0 && page.contains(told), "{page}{err}");
    for (run, empty) in [("bare", true), ("whole", false)] {
        let (code, _, err) = rockproof_in(dir, &["report", run, "--out", &format!("{run}-page")]);
        assert_eq!(code, 0, "{err}");
        let table = std::fs::read_to_string(dir.join(format!("{run}-page/tables/agreement.csv"))).expect("a table");
        let row = table.lines().find(|row| row.contains(",mine,whole,")).unwrap_or_else(|| panic!("{table}"));
        assert_eq!(row.ends_with(",,"), empty, "{row}");
    }
    let (code, said, err) = rockproof_in(dir, &["compare", "whole", "bare"]);
    let less = said.lines().find(|line| line.starts_with("mine gave entrances and signs of gaps for "));
    let less = less.unwrap_or_else(|| panic!("{said}{err}"));
    assert!(code == 0 && less.contains(" before, for 0 of ") && less.ends_with("is not compared."), "{less}");
    // What is not compared any more must not pass for mended; an engine that says more is no regression.
    for deny in ["new", "more", "other"] {
        let codes = [["whole", "bare"], ["bare", "whole"], ["whole", "whole"], ["bare", "bare"]]
            .map(|[one, other]| rockproof_in(dir, &["compare", one, other, "--deny", deny]).0);
        assert_eq!(codes, [1, 0, 0, 0], "{deny}");
    }
    let (_, said, _) = rockproof_in(dir, &["compare", "whole", "whole"]);
    assert!(!said.contains("entrances and signs"), "{said}");
}

/// The C++ client, which says how blocks lie, with what `sed` takes out; `None` without a compiler.
fn of_states(edit: &str) -> Option<Vec<String>> {
    Some(["sh", "-c", &format!("'{}' | sed -u '{edit}'", cpp_client()?)].map(str::to_owned).to_vec())
}

const NO_GAP: &str = r#"s/"gap_m":[^,]*,//"#;
const NEITHER: &str = r#"s/,"gap_m".*/}/"#;

/// The same of an engine that says how blocks lie, and never how far apart or in which direction.
#[test]
fn a_limit_on_gaps_or_normals_that_an_engine_never_gives_is_skipped() {
    let dir = crate::place::folder();
    let apart = ["sed", "-u", r#"s/^{"id":\([0-9]*\),.*/{"id":\1,"state":"apart"}/"#].map(str::to_owned);
    let limit = |change: &str| format!("[[limit]]\nengine = \"mine\"\nchange = \"{change}\"\ncount = 0\n");
    for changes in [&["gap"][..], &["normal"], &["gap", "normal"]] {
        let limits: String = changes.iter().map(|change| limit(change)).collect();
        let ran = gate(dir.path(), &around_few(&apart, &limits), &[], false);
        for change in changes {
            let told = format!("mine gave no {change} for any of ");
            let row = ran.out.lines().find(|line| line.contains(&told)).unwrap_or_else(|| panic!("{}", ran.out));
            assert!(row.starts_with(" skip") && row.contains("states: what is not given is not compared"), "{row}");
        }
        let row = ran.out.lines().find(|line| line.contains("engine mine answers")).expect("a row");
        assert!(ran.code == 1 && row.contains("FAIL") && row.contains("whatever it answers would pass"), "{row}");
        assert!(row.contains("gaps and normals given for 0 of "), "{row}");
    }
    // Only external engines give gaps, so a limit that names none is about them.
    let ran = gate(dir.path(), &around_few(&apart, &limit("gap").replace("engine = \"mine\"\n", "")), &[], false);
    assert!(ran.code == 1 && ran.out.contains("mine gave no gap for any of "), "{}{}", ran.out, ran.err);
    let state = limit("state").replace("count = 0", "count = 9999");
    let ran = gate(dir.path(), &around_few(&apart, &(limit("gap") + &state)), &[], false);
    assert!(ran.code == 0 && ran.out.contains("gate passed: 2 passed, 1 skipped"), "{}{}", ran.out, ran.err);
    // An engine that names contacts says no state.
    let contacts = [client(), String::new()];
    let ran = gate(dir.path(), &around_few(&contacts, &limit("normal")), &[], false);
    assert!(
        ran.code == 1 && ran.out.contains("mine said of no two convex blocks how they lie, so no normal"),
        "{}{}",
        ran.out,
        ran.err
    );
}

/// Gaps or normals that are no longer given end findings that nobody mended.
#[test]
fn an_engine_that_says_less_of_how_blocks_lie_than_in_the_baseline_fails() {
    let Some(whole) = of_states("") else { return };
    let dir = crate::place::folder();
    let baseline = "[baseline]\nfile = \"known.toml\"\n";
    let ran = gate(dir.path(), &around_few(&whole, baseline), &["--update-baseline"], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let ran = gate(dir.path(), &around_few(&whole, baseline), &[], false);
    assert!(ran.code == 0 && ran.out.contains("none new"), "{}{}", ran.out, ran.err);
    let less = |edit: &str| {
        let engine = of_states(edit).expect("built before");
        let text = format!("rotating_pairs = 32\n{}", around_few(&engine, baseline));
        gate(dir.path(), &text, &["--rotating-seed", "7"], false)
    };
    for (edit, what) in [(NO_GAP, "gaps given for 0 of "), (NEITHER, "gaps and normals given for 0 of ")] {
        let ran = less(edit);
        let row = ran.out.lines().find(|line| line.contains("fixed: engine mine says less of how blocks lie"));
        let row = row.unwrap_or_else(|| panic!("{}{}", ran.out, ran.err));
        assert!(ran.code == 1 && row.contains("FAIL") && row.contains(what), "{row}");
        assert!(row.contains(" states \"overlapping\", in the baseline for "), "{row}");
        // Of so few other pairs none may be by chance.
        assert!(!ran.out.contains("rotating: engine mine says less"), "{}", ran.out);
    }
    // A file of an earlier version counts contacts alone.
    let file = dir.path().join("known.toml");
    let text = std::fs::read_to_string(&file).expect("a baseline");
    let line = text.lines().find(|line| line.starts_with("\"mine\" = { contacts = 0")).expect("what it said");
    assert!(line.contains(", overlapping = { answers = "), "{line}");
    std::fs::write(&file, text.replace(line, "\"mine\" = { contacts = 0, entrances = 0, gap_m = 0 }")).expect("write");
    let ran = less(NEITHER);
    assert!(ran.code == 0 && ran.out.contains("none new"), "{}{}", ran.out, ran.err);
}

/// The end of a campaign and the report do not call well what was not compared, and `compare` tells an engine that says less.
#[test]
fn gaps_and_normals_that_are_not_given_are_told_by_campaign_report_and_compare() {
    let Some(whole) = of_states("") else { return };
    let dir = crate::place::folder();
    let dir = dir.path();
    let campaign = |out: &str, command: &[String], more: &[&str]| {
        let words: Vec<String> = command.iter().map(|word| toml::Value::from(word.as_str()).to_string()).collect();
        let text = format!(
            "pairs = 320\nengines = []\nfamilies = [\"edge_cross\"]\ntolerances = [\"auto\"]\nsteps_every = 0\n\
             [[external]]\nname = \"mine\"\ncommand = [{}]\n",
            words.join(", ")
        );
        std::fs::write(dir.join("settings.toml"), text).expect("write");
        let (code, said, err) = rockproof_in(dir, &[&["campaign", "settings.toml", "--out", out], more].concat());
        assert_eq!(code, 0, "{said}{err}");
        said
    };
    campaign("whole", &whole, &[]);
    let neither = of_states(NEITHER).expect("built before");
    let said = campaign("bare", &neither, &[]);
    let told = "gaps and normals given for 0 of ";
    let line = said.lines().find(|line| line.starts_with("mine: no finding of its own")).expect("its line");
    assert!(line.contains(told) && line.ends_with("what is not given is not compared."), "{line}");
    let (code, page, err) = rockproof_in(dir, &["report", "bare", "--format", "markdown"]);
    let line = page.lines().find(|line| line.contains("mine: no finding of its own")).expect("its line");
    assert!(code == 0 && line.contains('ℹ') && !line.contains('✅') && line.contains(told), "{line}{err}");
    let no_gap = campaign("no-gap", &of_states(NO_GAP).expect("built before"), &[]);
    assert!(no_gap.contains("gaps given for 0 of "), "{no_gap}");
    // What is denied does not matter: what is not compared any more must not pass for mended.
    for (runs, wanted) in [
        (["whole", "bare"], 1),
        (["whole", "no-gap"], 1),
        (["no-gap", "bare"], 1),
        (["bare", "whole"], 0),
        (["bare", "bare"], 0),
        (["whole", "whole"], 0),
    ] {
        let (code, said, err) = rockproof_in(dir, &["compare", runs[0], runs[1], "--deny", "new,more,other"]);
        assert_eq!(code, wanted, "{runs:?}: {said}{err}");
        let told = said.lines().filter(|line| line.starts_with("mine gave ")).count();
        assert_eq!(told > 0, runs[0] != runs[1], "{runs:?}: {said}");
    }
    // The counts of parts, and of sessions, add up to those of one run; what a merge asks to make cases is not counted.
    let counts = |run: &str| {
        let table = std::fs::read_to_string(dir.join(run).join("engines.csv")).expect("a table");
        let row = table.lines().nth(1).expect("a row").split(',').skip(6);
        row.map(|count| count.parse().expect("a count")).collect::<Vec<u64>>()
    };
    let all = counts("whole");
    assert!(all[3] > 0 && all[4..6] == [0, 0] && all[9] > 0 && all[9..12] == [all[9]; 3], "{all:?}");
    campaign("half", &whole, &["--part", "1/2"]);
    campaign("rest", &whole, &["--part", "2/2"]);
    let sum: Vec<u64> = counts("half").iter().zip(counts("rest")).map(|(one, other)| one + other).collect();
    let (code, _, err) = rockproof_in(dir, &["merge", "half", "rest", "--out", "merged"]);
    assert!(code == 0 && sum == all && counts("merged") == all, "{err}{sum:?}");
    campaign("sessions", &whole, &["--pairs", "160"]);
    campaign("sessions", &whole, &["--pairs", "320", "--resume"]);
    assert_eq!(counts("sessions"), all);
    // A run of an earlier version does not have them.
    let file = dir.join("bare/run.json");
    let mut run: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&file).expect("run.json")).expect("JSON");
    let detail = run["external_engines"]["mine"]["detail"].as_object_mut().expect("what it said");
    detail.retain(|name, _| ["contacts", "entrances", "gap_m"].contains(&name.as_str()));
    std::fs::write(&file, run.to_string()).expect("write");
    let file = dir.join("bare/engines.csv");
    let table = std::fs::read_to_string(&file).expect("a table");
    let first = |row: &str| row.split(',').take(9).collect::<Vec<_>>().join(",") + "\n";
    std::fs::write(&file, table.lines().map(first).collect::<String>()).expect("write");
    let (code, page, err) = rockproof_in(dir, &["report", "bare", "--format", "markdown"]);
    assert!(code == 0 && page.contains("mine: no finding of its own") && !page.contains("states"), "{page}{err}");
    let (code, said, err) = rockproof_in(dir, &["compare", "bare", "no-gap", "--deny", "new,more,other"]);
    assert!(code == 0, "{said}{err}");
}
