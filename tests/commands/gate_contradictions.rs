//! What a gate makes of an external engine that contradicts itself: limits, how far from a tie that is, and cases of it in the corpus.
#![cfg(unix)]

use crate::engines::client;
use crate::gates::{Ran, around, gate};
use crate::place::rockproof_in;
use std::fs;
use std::path::Path;

/// A gate around the client with a trick, which is asked every second pair otherwise; its families have contacts that change with a radius and with numbers.
fn contradicting(dir: &Path, trick: &str, pairs: u32, limit: &str) -> Ran {
    let settings = around(&[&client(), trick], limit).replace("pairs = 256", &format!("pairs = {pairs}"));
    let settings = settings.replace("[campaign]", "[campaign]\nmetamorphic_every = 2\ntolerances = [\"auto\"]");
    let settings = settings.replace("face_stack\", \"edge_cross", "corner_corner\", \"vertex_on_edge");
    gate(dir, &settings, &[], false)
}

/// Vertices numbered otherwise are other corners for an engine that leaves out the first, however far that is from a tie; one that adds up in another order
/// does not care.
#[test]
fn what_an_engine_contradicts_itself_in_is_as_far_from_a_tie_as_the_pair() {
    let limit = "[[limit]]\nengine = \"mine\"\nchange = \"renumber\"\nbeyond_ulps = 1000\ncount = 0\n";
    for (trick, is_far) in [("first", true), ("order", false)] {
        let dir = crate::place::folder();
        let ran = contradicting(dir.path(), trick, 192, limit);
        let row = ran.out.lines().find(|line| line.contains("change renumber, beyond")).expect("a row");
        assert_eq!(ran.code == 1 && row.contains("FAIL"), is_far, "{trick}: {}{}", ran.out, ran.err);
        let findings = fs::read_to_string(dir.path().join("reports/gate/fixed/findings.csv")).expect("findings");
        let is_measured = |row: &str| row.rsplit(',').nth(1).is_some_and(|ulps| !ulps.is_empty());
        let mut renumbered = findings.lines().filter(|row| row.contains(",mine,engine,renumber,")).peekable();
        assert!(renumbered.peek().is_some() == is_far && renumbered.all(is_measured), "{trick}: {findings}");
    }
}

/// Right in metres, and wrong of the same blocks 128 times smaller.
#[test]
fn another_unit_of_length_is_no_rounding() {
    let limit =
        |change: &str| format!("[[limit]]\nengine = \"mine\"\nbeyond_ulps = 1e20\ncount = 0\nchange = \"{change}\"\n");
    let dir = crate::place::folder();
    let wrong = contradicting(dir.path(), "millimetre", 64, &limit("scale"));
    let row = wrong.out.lines().find(|line| line.contains("change scale, beyond ")).expect("a row");
    assert!(wrong.code == 1 && row.contains("FAIL"), "{}{}", wrong.out, wrong.err);
    let right = contradicting(dir.path(), "epsilon", 64, &limit("scale"));
    assert_eq!(right.code, 0, "{}{}", right.out, right.err);
    // Of what has a margin nothing is that far from a tie.
    let refused = contradicting(dir.path(), "epsilon", 64, &limit("missing"));
    let why = "in f64 nothing is 2^55 roundoffs from a tie";
    assert!(refused.code == 2 && refused.err.contains(why), "{}", refused.err);
}

/// The first case of a change that a gate of the client with a trick writes, as `corpus/case.toml` of the folder.
fn kept_case(dir: &Path, trick: &str, change: &str) -> toml::Table {
    let limit = format!("[[limit]]\nengine = \"mine\"\nchange = \"{change}\"\ncount = 0\n");
    let ran = contradicting(dir, trick, 192, &limit);
    assert_eq!(ran.code, 1, "{}{}", ran.out, ran.err);
    let cases = fs::read_dir(dir.join("reports/gate/fixed/cases")).expect("cases");
    let of_change = |name: &str| name.contains(&format!("-engine-{change}-"));
    let paths = cases.map(|entry| entry.expect("an entry").path());
    let path = paths.into_iter().find(|path| of_change(&path.display().to_string())).expect("a case");
    let text = fs::read_to_string(path).expect("a case");
    fs::create_dir_all(dir.join("corpus")).expect("a folder");
    fs::write(dir.join("corpus/case.toml"), &text).expect("write");
    text.parse().expect("TOML")
}

/// What a gate says of the case alone, with the client and this trick.
fn judged(dir: &Path, trick: &str) -> Ran {
    let settings = around(&[&client(), trick], "").replace("pairs = 256", "pairs = 16");
    gate(dir, &settings.replace("corpus = []", "corpus = [\"corpus\"]"), &[], false)
}

#[test]
fn a_case_of_an_engine_that_contradicts_itself_asks_about_the_changed_pair() {
    let dir = crate::place::folder();
    let dir = dir.path();
    kept_case(dir, "millimetre", "scale");
    let wrong = judged(dir, "millimetre");
    let why = "mine contradicts itself, and rounding is no reason";
    assert!(wrong.code == 1 && wrong.out.contains(why) && wrong.out.contains("divided by 128"), "{}", wrong.out);
    let right = judged(dir, "");
    assert_eq!(right.code, 0, "{}{}", right.out, right.err);

    // What rounding may excuse passes as it was recorded, and not otherwise.
    let mut case = kept_case(dir, "first", "renumber");
    for trick in ["first", ""] {
        let ran = judged(dir, trick);
        assert_eq!(ran.code, 0, "{trick}: {}{}", ran.out, ran.err);
    }
    let about = case["case"].as_table_mut().expect("a table");
    about.insert("changed".to_owned(), about["found"].clone());
    fs::write(dir.join("corpus/case.toml"), toml::to_string(&case).expect("TOML")).expect("write");
    let other = judged(dir, "first");
    let why = "mine contradicts itself otherwise than the case records";
    assert!(other.code == 1 && other.out.contains(why), "{}{}", other.out, other.err);
}

/// A code that answers one thing where the first coordinate of A is negative and another elsewhere, so that it contradicts itself once A and B are exchanged. It
/// does not take the boxes that it is asked about first.
fn by_sign(negative: &str, other: &str) -> String {
    let answer = |said: &str| match said {
        ENDS => "Q".to_owned(),
        said => format!(r#"s/^{{"id":\([0-9]*\),.*/{{"id":\1,{said}}}/"#),
    };
    let where_first =
        |begin: &str, said: &str| format!("/^[^v]*\"vertices\":\\[\\[{begin}/{{\n{}\nt\n}}\n", answer(said));
    let boxes = where_first("0.0,0.0,0.0\\]", r#""unsupported":"a box""#);
    format!("{boxes}{}{}", where_first("-", negative), answer(other))
}

/// The code ends in place of an answer.
const ENDS: &str = "";
const APART: &str = r#""state":"apart""#;
const TOUCHING: &str = r#""state":"touching""#;

/// What a gate says of `corpus/case.toml` with such a code: how that came out, and why.
fn judged_state(dir: &Path, negative: &str, other: &str) -> (String, String) {
    let settings = around(&["sed", "-u", &by_sign(negative, other)], "").replace("pairs = 256", "pairs = 0");
    let settings = settings.replace("corpus = []", "corpus = [\"corpus\"]");
    let ran = gate(dir, &settings, &["--format", "json"], false);
    let document: serde_json::Value =
        serde_json::from_str(&ran.out).unwrap_or_else(|_| panic!("{}{}", ran.out, ran.err));
    let checks = document["checks"].as_array().expect("checks");
    let check = checks.iter().find(|check| check["group"] == "corpus").expect("the case");
    let text = |key: &str| check[key].as_str().expect("a text").to_owned();
    (text("verdict"), text("found"))
}

/// Makes a campaign with such a code, each pair asked about exchanged as well.
fn campaign_by_sign(dir: &Path, negative: &str, other: &str) {
    let command = toml::Value::from(by_sign(negative, other)).to_string();
    let settings = format!(
        "pairs = 64\nengines = []\nfamilies = [\"face_stack\", \"edge_cross\"]\ntolerances = [\"auto\"]\nmetamorphic_every = 1\n\
         steps_every = 0\nshrink_evaluations = 0\n[[external]]\nname = \"mine\"\ncommand = [\"sed\", \"-u\", {command}]\n"
    );
    fs::write(dir.join("few.toml"), settings).expect("write");
    let (code, said, err) = rockproof_in(dir, &["campaign", "few.toml", "--out", "run"]);
    assert_eq!(code, 0, "{said}{err}");
    fs::create_dir(dir.join("corpus")).expect("a folder");
}

/// A case of that campaign whose name begins so, as `corpus/case.toml` of the folder.
fn kept_by_sign(dir: &Path, begin: &str) -> String {
    let files = fs::read_dir(dir.join("run/cases")).expect("cases").map(|entry| entry.expect("an entry"));
    let is_such = |file: &fs::DirEntry| file.file_name().to_string_lossy().starts_with(begin);
    let file = files.into_iter().find(is_such).unwrap_or_else(|| panic!("no case {begin}"));
    let text = fs::read_to_string(file.path()).expect("a case");
    fs::write(dir.join("corpus/case.toml"), &text).expect("write");
    text
}

#[test]
fn what_a_collision_code_says_of_the_pair_itself_has_to_be_right_or_recorded() {
    let dir = crate::place::folder();
    let dir = dir.path();
    campaign_by_sign(dir, APART, TOUCHING);
    // How the blocks lie, what is said of them exchanged, and as they stand.
    let keep = |exact: &str, changed: &str, found: &str| {
        let stem = format!("pair-engine-swap-{exact}-{changed}-");
        let text = kept_by_sign(dir, &stem);
        let line = format!("found_state = \"{found}\"\n");
        assert!(text.contains(&line), "{text}");
        (text.replace(&line, ""), text)
    };
    let status = |(negative, other): (&str, &str), wanted: &str, why: &str| {
        let (status, message) = judged_state(dir, negative, other);
        assert!(status == wanted && message.contains(why), "{negative}, {other}: {status}, {message}");
    };
    let unrecorded = "which the case does not record of the pair as it stands";
    let earlier = "of an earlier version, does not record what mine said of the pair as it stands";

    // Right of the pair itself.
    let (without, text) = keep("apart", "touching", "apart");
    let gap = text.split("states = \"apart ").nth(1).and_then(|rest| rest.split(' ').next()).expect("the gap");
    let measured = |gap: &str| format!("{APART},\"gap_m\":{gap}");
    status((APART, TOUCHING), "pass", "as recorded");
    status((&measured(gap), TOUCHING), "pass", "as recorded");
    status((&measured("7"), TOUCHING), "FAIL", unrecorded);
    status((r#""state":"overlapping""#, TOUCHING), "FAIL", unrecorded);
    status((TOUCHING, TOUCHING), "FAIL", unrecorded);
    status((APART, r#""state":"overlapping""#), "FAIL", "contradicts itself otherwise than the case records");
    status((APART, APART), "pass", "the engine agrees");
    fs::write(dir.join("corpus/case.toml"), &without).expect("write");
    status((APART, TOUCHING), "pass", "as recorded");
    status((&measured("7"), TOUCHING), "skip", earlier);
    status((&measured("7"), r#""state":"overlapping""#), "FAIL", "contradicts itself otherwise than the case records");

    // Wrong of the pair itself, and right of it exchanged.
    let (without, _) = keep("apart", "apart", "touching");
    status((APART, TOUCHING), "pass", "as recorded");
    status((APART, r#""state":"touching","gap_m":0"#), "FAIL", unrecorded);
    status((APART, APART), "pass", "the engine agrees");
    // No contacts at all are not what the case records, which is about how blocks lie.
    status((r#""contacts":[]"#, r#""contacts":[]"#), "FAIL", "neither what is right nor what the case records");
    fs::write(dir.join("corpus/case.toml"), &without).expect("write");
    status((APART, TOUCHING), "skip", earlier);
}

/// A campaign makes no finding of an engine that does not take the changed pair, or says of it something else than of the pair itself; nor does the gate hold it
/// for mended. What is no answer at all is a mistake.
#[test]
fn a_changed_pair_that_an_engine_does_not_take_is_no_contradiction() {
    let not_taken = r#""unsupported":"not today""#;
    let told = "whether mine contradicts itself is not known: it gives no answer to the pair with A and B exchanged: unsupported: ";
    let (none, one) = (r#""contacts":[]"#, r#""contacts":[{"kind":"v-v","feature_a":0,"feature_b":0}]"#);
    for (begin, [negative, other], wrong, (other_sort, why)) in [
        (
            "pair-engine-swap-apart-touching-",
            [APART, TOUCHING],
            TOUCHING,
            (none, "it names contacts, not how the blocks lie"),
        ),
        ("v-v-engine-swap-", [none, one], &one.replace('0', "1"), (APART, "it says apart, not which contacts")),
    ] {
        let dir = crate::place::folder();
        let dir = dir.path();
        campaign_by_sign(dir, negative, other);
        let text = kept_by_sign(dir, begin);
        // Which of the two the engine said of the pair as it stands.
        let is_negative = text.contains("found_state = \"apart\"") || text.contains("\nfound = []");
        let slots = |of_pair, changed| if is_negative { [of_pair, changed] } else { [changed, of_pair] };
        let [of_pair, changed] = slots(negative, other);
        for (of_pair, changed, wanted, message) in [
            (of_pair, changed, "pass", "as recorded".to_owned()),
            (of_pair, not_taken, "skip", format!("{told}not today")),
            (of_pair, other_sort, "skip", format!("{told}{why}")),
            (of_pair, ENDS, "FAIL", "gives no answer to the pair with A and B exchanged: crashed".to_owned()),
            (wrong, not_taken, "FAIL", "the case".to_owned()),
        ] {
            let [negative, other] = slots(of_pair, changed);
            let (verdict, found) = judged_state(dir, negative, other);
            assert!(verdict == wanted && found.contains(&message), "{negative}, {other}: {verdict}, {found}");
        }
        // A campaign with such an engine has no finding of a contradiction either.
        let settings = fs::read_to_string(dir.join("few.toml")).expect("settings");
        let [untaken, command] =
            [not_taken, other].map(|other| toml::Value::from(by_sign(negative, other)).to_string());
        fs::write(dir.join("few.toml"), settings.replace(&command, &untaken)).expect("write");
        let (code, said, err) = rockproof_in(dir, &["campaign", "few.toml", "--out", "untaken"]);
        let findings = fs::read_to_string(dir.join("untaken/findings.csv")).expect("findings");
        assert!(code == 0 && findings.contains(",unsupported,") && !findings.contains(",swap,"), "{said}{err}");
    }
}

/// A code that says the same of all pairs, and ends in place of an answer where a corner has a coordinate of two digits or more along x, as that of a block far
/// away.
fn ends_far_away(script: &str, said: &str) -> String {
    format!("/\\[-\\{{0,1\\}}[1-9][0-9]\\{{1,\\}}\\./{{{script}}}\ns/^{{\"id\":\\([0-9]*\\),.*/{{\"id\":\\1,{said}}}/")
}

/// It answers about each pair, and ends only once that is changed: a limit on crashes breaks, and its case is replayed, made small and judged again.
#[test]
fn an_engine_that_ends_on_the_changed_pair_alone_has_a_finding() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let answering = |said: &str, script: &str, limit: &str, corpus: &str, more: &[&str]| {
        let pairs = if corpus == "[]" { "pairs = 32" } else { "pairs = 0" };
        let settings = around(&["sed", "-u", &ends_far_away(script, said)], limit).replace("pairs = 256", pairs);
        let settings = settings.replace("[campaign]", "[campaign]\nmetamorphic_every = 1\ntolerances = [\"auto\"]");
        gate(dir, &settings.replace("corpus = []", &format!("corpus = {corpus}")), more, false)
    };
    let gated = |script: &str, limit: &str, corpus: &str, more: &[&str]| answering(APART, script, limit, corpus, more);
    let limit = "[[limit]]\nengine = \"mine\"\nchange = \"crash\"\ncount = 0\n";
    // What an engine says that it cannot do is none.
    let untaken = r#"s/^{"id":\([0-9]*\),.*/{"id":\1,"unsupported":"so far"}/;t"#;
    let not_taken = gated(untaken, limit, "[]", &[]);
    let row = not_taken.out.lines().find(|line| line.contains("change crash"));
    assert!(row.is_some_and(|row| row.contains("pass")), "{}{}", not_taken.out, not_taken.err);
    for said in [r#""contacts":[]"#, APART] {
        let ran = answering(said, "Q", limit, "[]", &[]);
        let row = ran.out.lines().find(|line| line.contains("change crash"));
        // Of each pair with B far away, and of 15 that are moved so far.
        let is_broken = |row: &str| row.contains("FAIL") && row.contains(" 47 findings, at most 0 ");
        assert!(ran.code == 1 && row.is_some_and(is_broken), "{}{}", ran.out, ran.err);
    }

    let cases =
        fs::read_dir(dir.join("reports/gate/fixed/cases")).expect("cases").map(|entry| entry.expect("an entry"));
    let texts: Vec<String> = cases.map(|file| fs::read_to_string(file.path()).expect("a case")).collect();
    let of_crash = |text: &&String| text.contains("change = \"crash\"");
    let text = texts.iter().find(of_crash).unwrap_or_else(|| panic!("no case: {texts:?}"));
    assert!(text.contains("check = \"far-block\"") && text.contains("note = \"with B moved by "), "{text}");
    fs::create_dir(dir.join("corpus")).expect("a folder");
    fs::write(dir.join("corpus/case.toml"), text).expect("write");

    fs::write(dir.join("ends.sed"), ends_far_away("Q", APART)).expect("write");
    let engine = ["--engine-command", "mine=sed -u -f ends.sed"];
    let (code, out, err) = rockproof_in(dir, &[&["replay", "corpus/case.toml"], &engine[..]].concat());
    let told = [
        "the finding recurs\n  with B moved by ",
        " m along x: crashed: ",
        "\"…, far-block\" are answers to the same pair",
    ];
    assert!(code == 0 && told.iter().all(|part| out.contains(part)), "{out}{err}");
    let shrunk = [&["shrink", "corpus/case.toml", "--evaluations", "20", "--out", "small.toml"], &engine[..]].concat();
    let (code, out, err) = rockproof_in(dir, &shrunk);
    let small = fs::read_to_string(dir.join("small.toml")).unwrap_or_default();
    assert!(code == 0 && small.contains("check = \"far-block\""), "{out}{err}{small}");

    let judged = |script: &str| {
        let ran = gated(script, "", "[\"corpus\"]", &["--format", "json"]);
        let document: serde_json::Value =
            serde_json::from_str(&ran.out).unwrap_or_else(|_| panic!("{}{}", ran.out, ran.err));
        let checks = document["checks"].as_array().expect("checks");
        let check = checks.iter().find(|check| check["group"] == "corpus").expect("the case");
        ["verdict", "found"].map(|key| check[key].as_str().expect("a text").to_owned())
    };
    for (script, verdict, why) in [
        ("Q", "pass", "as recorded"),
        ("", "pass", ""),
        (untaken, "skip", "whether the crash of mine is mended is not known"),
        ("s/.*/what/;t", "FAIL", "gives no answer to the pair with B moved by "),
    ] {
        let [status, message] = judged(script);
        assert!(status == verdict && message.contains(why), "{script}: {status}, {message}");
    }
}
