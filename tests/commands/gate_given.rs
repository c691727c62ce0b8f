//! How much an external engine must give before a limit on it says anything, and what is said where it is not known how much it gave before.
#![cfg(unix)]

use crate::engines::{client, cpp_client};
use crate::gates::{Ran, around, gate};
use crate::place::rockproof_in;
use std::fs;
use std::path::Path;

const LIMIT: &str = "[[limit]]\nengine = \"mine\"\nchange = \"gap\"\ncount = 0\n";
const STATE: &str = "[[limit]]\nengine = \"mine\"\nchange = \"state\"\ncount = 9999\n";
const BASELINE: &str = "[baseline]\nfile = \"known.toml\"\n";

/// The C++ client, which says how blocks lie, with an edit of what it says; `None` without a compiler.
fn edited(edit: &str) -> Option<String> {
    Some(format!("'{}' | sed -u '{edit}'", cpp_client()?))
}

/// A gate around an engine, on few pairs and one thread.
fn ran(dir: &Path, engine: &str, rest: &str, more: &[&str]) -> Ran {
    let text = around(&["sh", "-c", engine], rest).replace("pairs = 256", "pairs = 64");
    gate(dir, &text, &[&["--threads", "1"], more].concat(), false)
}

fn row<'r>(ran: &'r Ran, name: &str) -> &'r str {
    ran.out.lines().find(|line| line.contains(name)).unwrap_or_else(|| panic!("{name}: {}{}", ran.out, ran.err))
}

/// Gaps of few states show nothing: the limit is no pass, and says of how many they were.
#[test]
fn a_limit_on_gaps_of_few_states_is_no_pass() {
    // No gap but of one answer in ten.
    let Some(few) = edited(r#"0~10!s/"gap_m":[^,]*,//"#) else { return };
    let dir = crate::place::folder();
    let limited = ran(dir.path(), &few, &format!("{LIMIT}{STATE}"), &[]);
    let found = row(&limited, "engine mine, change gap");
    assert!(limited.code == 0 && found.starts_with(" skip") && found.contains("mine: gaps given for "), "{found}");
    assert!(found.contains("a limit needs half of those apart, or overlapping, and a tenth of all"), "{found}");
    // Alone it says nothing of what the engine answers.
    let alone = ran(dir.path(), &few, LIMIT, &[]);
    let answers = row(&alone, "engine mine answers");
    assert!(
        alone.code == 1 && answers.contains("FAIL") && answers.contains("whatever it answers would pass"),
        "{answers}"
    );
    // All overlaps and no distance: a pass, which says of how many, in the report for machines too.
    let whole = edited("").expect("built before");
    let passed = ran(dir.path(), &whole, &format!("{LIMIT}{STATE}"), &[]);
    let found = row(&passed, "engine mine, change gap");
    assert!(
        passed.code == 0 && found.starts_with(" pass") && found.contains("0 findings, at most 0; gaps given for "),
        "{found}"
    );
    let junit = fs::read_to_string(dir.path().join("junit.xml")).expect("JUnit");
    assert!(junit.contains("<system-out>0 findings, at most 0; gaps given for "), "{junit}");
    // Of one family the counts are not known.
    let narrowed = ran(dir.path(), &whole, &LIMIT.replace("count", "family = \"edge_cross\"\ncount"), &[]);
    assert!(row(&narrowed, "family edge_cross").contains(" states, of all pairs"), "{}", narrowed.out);
    // A finding fails whatever is left unsaid.
    let wrong = edited(r#"0~10!s/"gap_m":[^,]*,//; s/"gap_m":[^,]*/"gap_m":7/"#).expect("built before");
    let failed = ran(dir.path(), &wrong, LIMIT, &[]);
    assert!(failed.code == 1 && row(&failed, "engine mine, change gap").starts_with(" FAIL"), "{}", failed.out);
}

/// An engine that says only how blocks lie where it named contacts is compared less; and a limit on what an engine seldom says is no pass.
#[test]
fn states_in_place_of_contacts_are_no_pass() {
    let dir = crate::place::folder();
    let contacts = format!("'{}'", client());
    let written = ran(dir.path(), &contacts, BASELINE, &["--update-baseline"]);
    assert_eq!(written.code, 0, "{}{}", written.out, written.err);
    // The states are right, so that no finding is new.
    let Some(states) = cpp_client() else { return };
    let missing = "[[limit]]\nengine = \"mine\"\nchange = \"missing\"\ncount = 9999\n";
    let some = format!("'{contacts}' | sed -u 's/\"contacts\":\\[{{.*}},{{.*\\]/\"state\":\"overlapping\"/'")
        .replace("''", "'");
    let fewer = ran(dir.path(), &some, &format!("{BASELINE}{missing}"), &[]);
    let found = row(&fewer, "fixed: engine mine says less of its contacts");
    assert!(fewer.code == 1 && found.contains("FAIL"), "{found}");
    for (engine, limit, wanted) in [
        (&format!("'{states}'"), missing, "mine named contacts for 0 of "),
        (&contacts, STATE, "mine said how blocks lie for 0 of "),
    ] {
        let skipped = ran(dir.path(), engine, limit, &[]);
        let found = row(&skipped, "fixed: engine mine, change");
        assert!(skipped.code == 1 && found.starts_with(" skip") && found.contains(wanted), "{found}");
        assert!(found.contains(" pairs, and a limit on that needs a tenth"), "{found}");
    }
}

/// A baseline of before this was counted tells nothing of an engine that is silent now, and that is said.
#[test]
fn an_old_baseline_says_that_it_does_not_know_how_much_was_given() {
    let Some(whole) = edited("") else { return };
    let dir = crate::place::folder();
    let silent = edited(r#"s/,"gap_m".*/}/"#).expect("built before");
    let written = ran(dir.path(), &whole, BASELINE, &["--update-baseline"]);
    assert_eq!(written.code, 0, "{}{}", written.out, written.err);
    let file = dir.path().join("known.toml");
    let text = fs::read_to_string(&file).expect("a baseline");
    let said = text.lines().find(|line| line.starts_with("\"mine\" = { contacts = 0")).expect("what it said");
    let contacts_alone = text.replace(said, "\"mine\" = { contacts = 0, entrances = 0, gap_m = 0 }");
    let nothing = text.replace(&format!("\n[said]\n{said}\n"), "");
    for old in [contacts_alone, nothing] {
        assert_ne!(old, text);
        fs::write(&file, old).expect("write");
        let now = ran(dir.path(), &silent, BASELINE, &[]);
        let found = row(&now, "fixed: engine mine says no less");
        assert!(
            now.code == 0 && found.starts_with(" skip") && found.contains("gaps and normals given for 0 of "),
            "{found}"
        );
        assert!(
            found.contains("whether it says less than it did is not known: --update-baseline adds that"),
            "{found}"
        );
    }
    fs::write(&file, &text).expect("write");
    let now = ran(dir.path(), &whole, BASELINE, &[]);
    assert!(now.code == 0 && !now.out.contains("says no less") && !now.out.contains("settings of"), "{}", now.out);
    // With a larger accuracy fewer gaps are wrong.
    let now = ran(dir.path(), &whole, &format!("accuracy = 8192\n{BASELINE}{LIMIT}"), &[]);
    let told = "external is [\"mine (f64, accuracy 8192)\"], in the baseline [\"mine (f64)\"]";
    assert!(row(&now, "fixed: settings of the baseline").contains(told), "{}", now.out);
    assert!(row(&now, "engine mine, change gap").contains(", accuracy of mine 8192"), "{}", now.out);
    // An earlier version wrote the name alone.
    fs::write(&file, text.replace("mine (f64)", "mine")).expect("write");
    let now = ran(dir.path(), &whole, &format!("precision = \"f32\"\n{BASELINE}"), &[]);
    assert!(!now.out.contains("settings of the baseline"), "{}", now.out);
}

/// A run of an earlier version does not tell how much an engine said: nothing is told to be less or more, in whichever order the runs are given.
#[test]
fn compare_says_what_an_older_run_does_not_tell() {
    let Some(whole) = edited("") else { return };
    let dir = crate::place::folder();
    let dir = dir.path();
    let campaign = |out: &str, engine: &str| {
        let command = toml::Value::from(engine).to_string();
        let text = format!(
            "pairs = 64\nengines = []\nfamilies = [\"edge_cross\"]\ntolerances = [\"auto\"]\nsteps_every = 0\n\
             [[external]]\nname = \"mine\"\ncommand = [\"sh\", \"-c\", {command}]\n"
        );
        fs::write(dir.join("settings.toml"), text).expect("write");
        let (code, said, err) = rockproof_in(dir, &["campaign", "settings.toml", "--out", out]);
        assert_eq!(code, 0, "{said}{err}");
    };
    campaign("new", &whole);
    campaign("silent", &edited(r#"s/,"gap_m".*/}/"#).expect("built before"));
    campaign("old", &whole);
    let file = dir.join("old/run.json");
    let run: serde_json::Value = serde_json::from_str(&fs::read_to_string(&file).expect("run.json")).expect("JSON");
    for kept in [&["contacts", "entrances", "gap_m"][..], &[]] {
        let mut run = run.clone();
        let counts = run["external_engines"]["mine"].as_object_mut().expect("counts");
        let detail = counts["detail"].as_object_mut().expect("what it said");
        detail.retain(|name, _| kept.contains(&name.as_str()));
        if kept.is_empty() {
            counts.remove("detail");
        }
        fs::write(&file, run.to_string()).expect("write");
        for runs in [["new", "old"], ["old", "new"], ["old", "silent"], ["silent", "old"]] {
            let (code, said, err) = rockproof_in(dir, &["compare", runs[0], runs[1], "--deny", "new,more,other"]);
            let told = said
                .lines()
                .find(|line| line.starts_with("Whether mine says less in its answers than before is not known"));
            assert!(code == 0 && told.is_some() && !said.contains("0 of 0"), "{runs:?}: {said}{err}");
        }
    }
    let (code, said, _) = rockproof_in(dir, &["compare", "new", "silent", "--deny", "new"]);
    assert!(code == 1 && said.contains("for 0 of ") && !said.contains("not known"), "{said}");
    let (code, said, _) = rockproof_in(dir, &["compare", "old", "old", "--deny", "new"]);
    assert!(code == 0 && !said.contains("not known"), "{said}");
}

/// A case about a gap, replayed or in a corpus, is not held to be mended by an engine that gives none.
#[test]
fn a_case_about_a_gap_is_not_mended_by_silence() {
    let Some(wrong) = edited(r#"s/"gap_m":[^,]*/"gap_m":7/"#) else { return };
    let dir = crate::place::folder();
    let dir = dir.path();
    let failed = ran(dir, &wrong, LIMIT, &[]);
    assert_eq!(failed.code, 1, "{}{}", failed.out, failed.err);
    let cases = dir.join("reports/gate/fixed/cases");
    let case = fs::read_dir(cases).expect("cases").next().expect("a case").expect("a file").path();
    fs::create_dir(dir.join("corpus")).expect("a folder");
    fs::copy(&case, dir.join("corpus/gap.toml")).expect("copied");
    let judged = |edit: &str| {
        let engine = edited(edit).expect("built before");
        let command = format!("mine=sh -c \"{}\"", engine.replace('\\', "\\\\").replace('"', "\\\""));
        let replayed = rockproof_in(dir, &["replay", "corpus/gap.toml", "--engine-command", &command]);
        let text = around(&["sh", "-c", &engine], STATE).replace("pairs = 256", "pairs = 32");
        (replayed, gate(dir, &text.replace("corpus = []", "corpus = [\"corpus\"]"), &["--out", "again"], false))
    };
    let ((code, said, err), gated) = judged(r#"s/"gap_m":[^,]*/"gap_m":7/"#);
    assert!(code == 0 && said.contains("the finding recurs") && gated.code == 0, "{said}{err}{}", gated.out);
    // Wrong in another way: the finding recurs, and the case does not record that.
    let ((code, said, err), gated) = judged(r#"s/"gap_m":[^,]*/"gap_m":1000/"#);
    assert!(code == 0 && said.contains("the finding recurs"), "{said}{err}");
    let found = row(&gated, "corpus/gap.toml");
    assert!(
        gated.code == 1 && found.starts_with(" FAIL") && found.contains("which the case does not record"),
        "{found}"
    );
    let ((code, said, err), gated) = judged("");
    assert!(code == 1 && said.contains("the finding does not recur: nothing differs there now"), "{said}{err}");
    assert_eq!(gated.code, 0, "{}{}", gated.out, gated.err);
    let ((code, said, err), gated) = judged(r#"s/"gap_m":[^,]*,//"#);
    let told = "whether the finding recurs is not known: mine gives no gap now, and what is not given is not compared";
    assert!(code == 1 && said.contains(told) && !said.contains("does not recur"), "{said}{err}");
    let found = row(&gated, "corpus/gap.toml");
    assert!(
        gated.code == 1 && found.starts_with(" FAIL") && found.contains("mine gives no gap, which the case is about"),
        "{found}"
    );
}

/// That blocks which touch have the gap 0 says nothing of gaps, nor do gaps of blocks that are not convex, which nothing is held beside.
#[test]
fn gaps_that_say_nothing_are_not_counted() {
    let dir = crate::place::folder();
    let answered = |by: &str| format!(r#"s/^{{"id":\([0-9]*\),.*/{{"id":\1,{by}}}/"#);
    let touching = answered(r#""state":"touching","gap_m":0"#);
    let ran_with = |edit: &str, families: &str| {
        let text = around(&["sed", "-u", edit], &format!("{LIMIT}{STATE}"));
        let text = text.replace("pairs = 256", "pairs = 64").replace("\"face_stack\", \"edge_cross\"", families);
        gate(dir.path(), &text, &["--threads", "1"], false)
    };
    let limited = ran_with(&touching, "\"face_stack\"");
    let found = row(&limited, "engine mine, change gap");
    assert!(found.starts_with(" skip") && found.contains("of blocks that touch a gap says nothing"), "{found}");
    let deep = answered(r#""state":"overlapping","gap_m":-7"#);
    let concave = format!(r#"/"reflex":\[\[/{{{deep};b}};{}"#, answered(r#""state":"apart""#));
    let limited = ran_with(&concave.replace(";b}", "\nb\n}"), "\"concave_notch\", \"edge_cross\"");
    let found = row(&limited, "engine mine, change gap");
    assert!(found.starts_with(" skip") && found.contains("mine gave no gap for any of "), "{found}");
    let limited = ran_with(&deep, "\"concave_notch\"");
    let found = row(&limited, "engine mine, change gap");
    assert!(found.starts_with(" skip") && found.contains("mine said of no two convex blocks how they lie"), "{found}");
}

/// An engine that names contacts, and says how blocks lie where there is none, says no less than it did in an older baseline or run.
#[test]
fn an_engine_that_says_both_says_no_less_than_before() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let both = format!("'{}' | sed -u 's/\"contacts\":\\[\\]/\"state\":\"apart\"/'", client());
    let written = ran(dir, &both, BASELINE, &["--update-baseline"]);
    assert_eq!(written.code, 0, "{}{}", written.out, written.err);
    let file = dir.join("known.toml");
    let text = fs::read_to_string(&file).expect("a baseline");
    let said = text.lines().find(|line| line.starts_with("\"mine\" = { contacts = ")).expect("what it said");
    assert!(said.contains(", contact_answers = ") && said.contains(", apart = { answers = "), "{said}");
    let now = ran(dir, &both, BASELINE, &[]);
    assert!(now.code == 0 && !now.out.contains("says "), "{}", now.out);
    // States in place of contacts.
    let more = format!(
        "'{}' | sed -u 's/\"contacts\":\\[{{.*}},{{.*\\]/\"state\":\"overlapping\"/; s/\"contacts\":\\[\\]/\"state\":\"apart\"/'",
        client()
    );
    let fewer = ran(dir, &more, BASELINE, &[]);
    let found = row(&fewer, "fixed: engine mine says less of its contacts");
    assert!(found.contains("FAIL") && found.contains("contacts given for ") && found.contains(" answers"), "{found}");
    let old = said.split(", contact_answers").next().expect("a part");
    fs::write(&file, text.replace(said, &format!("{old} }}"))).expect("write");
    let now = ran(dir, &both, BASELINE, &[]);
    let found = row(&now, "fixed: engine mine says no less");
    assert!(now.code == 0 && found.starts_with(" skip"), "{}", now.out);

    let command = toml::Value::from(both.as_str()).to_string();
    let settings = format!(
        "pairs = 64\nengines = []\nfamilies = [\"face_stack\", \"edge_cross\"]\nsteps_every = 0\nshrink_evaluations = 0\n\
         [[external]]\nname = \"mine\"\ncommand = [\"sh\", \"-c\", {command}]\n"
    );
    fs::write(dir.join("settings.toml"), settings).expect("write");
    for out in ["old", "new"] {
        let (code, said, err) = rockproof_in(dir, &["campaign", "settings.toml", "--out", out]);
        assert_eq!(code, 0, "{said}{err}");
    }
    let file = dir.join("old/run.json");
    let mut run: serde_json::Value = serde_json::from_str(&fs::read_to_string(&file).expect("run.json")).expect("JSON");
    let detail = run["external_engines"]["mine"]["detail"].as_object_mut().expect("what it said");
    detail.retain(|name, _| ["contacts", "entrances", "gap_m"].contains(&name.as_str()));
    fs::write(&file, run.to_string()).expect("write");
    let (code, said, err) = rockproof_in(dir, &["compare", "old", "new", "--deny", "new"]);
    assert!(code == 0 && said.contains("is not known"), "{said}{err}");
}

/// Of other pairs, as with another seed, a share may be another by chance.
#[test]
fn another_seed_is_not_held_for_the_same_pairs() {
    let dir = crate::place::folder();
    let edit = r#"s/"entrance":"[^"]*","entrance_a":0,"entrance_b":[0-9]*,\("feature_a":[0-9]*,"feature_b":[0-9]*,\)"gap_sign":[-0-9]*,/\1/g"#;
    let engine = format!("'{}' | sed -u '{edit}'", client());
    let with = |seed: u64, more: &[&str]| {
        let text =
            around(&["sh", "-c", &engine], BASELINE).replace("pairs = 256", &format!("pairs = 64\nseed = {seed}"));
        gate(dir.path(), &text, more, false)
    };
    let mut told = Vec::new();
    for (before, after) in [(1, 2), (2, 1)] {
        let written = with(before, &["--update-baseline"]);
        assert_eq!(written.code, 0, "{}{}", written.out, written.err);
        let now = with(after, &[]);
        assert!(now.out.contains("seed is ") && !now.out.contains("says less"), "{}", now.out);
        told.push(now.out.lines().last().expect("the end").to_owned());
    }
    assert!(
        told.iter().all(|end| end.contains("entrances and signs of gaps given for ")) && told[0] != told[1],
        "{told:?}"
    );
}

/// Cases that an engine makes pass as recorded, and where it is mended, though it gives some other contact of the kind no entrance as it always did;
/// so does one about a crash where the engine says how blocks lie.
#[test]
fn cases_pass_as_recorded_and_mended() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let last = r#"s/\(.*\)"entrance":[^,]*,"entrance_a":[^,]*,"entrance_b":[^,]*,\(.*\)"gap_sign":[-0-9]*,/\1\2/"#;
    let wrong = r#"s/"gap_sign":0/"gap_sign":1/;t;s/"gap_sign":1/"gap_sign":-1/;t;s/"gap_sign":-1/"gap_sign":1/"#;
    let edited = |edit: &str| format!("'{}' | sed -u '{edit}'", client());
    let cases_of = |engine: &str, change: &str, corpus: &str| {
        let failed = ran(dir, engine, &LIMIT.replace("gap", change), &["--out", &format!("{corpus}-made")]);
        assert_eq!(failed.code, 1, "{}{}", failed.out, failed.err);
        let cases = dir.join(format!("{corpus}-made/fixed/cases"));
        fs::rename(cases, dir.join(corpus)).expect("cases");
    };
    let judged = |engine: &str, corpus: &str| {
        let text = around(&["sh", "-c", engine], "").replace("pairs = 256", "pairs = 0");
        gate(dir, &text.replace("corpus = []", &format!("corpus = [\"{corpus}\"]")), &["--out", "again"], false)
    };
    let same = edited(&format!("{last}\nt x\n:x\n{wrong}"));
    cases_of(&same, "gap-sign", "signs");
    let recorded = judged(&same, "signs");
    assert!(recorded.code == 0 && !recorded.out.contains(": 0 passed"), "{}", recorded.out);
    let mended = judged(&edited(last), "signs");
    assert!(mended.code == 0 && !mended.out.contains(": 0 passed"), "{}{}", mended.out, mended.err);
    let silent = judged(&edited(r#"s/"entrance[_ab]*":[^,]*,//g; s/"gap_sign":[-0-9]*,//g"#), "signs");
    let told = "mine gives no entrance of a contact, which the case is about";
    assert!(silent.code == 1 && silent.out.contains(told), "{}", silent.out);

    let Some(states) = cpp_client() else { return };
    let crashing = format!(
        "while read -r question; do answer=$(printf '%s\\n' \"$question\" | '{states}'); \
         case $answer in *overlapping*) exit 3;; esac; printf '%s\\n' \"$answer\"; done"
    );
    cases_of(&crashing, "crash", "crashes");
    let mended = judged(&format!("'{states}'"), "crashes");
    assert!(mended.code == 0 && !mended.out.contains(": 0 passed"), "{}{}", mended.out, mended.err);
}
