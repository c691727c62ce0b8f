//! The gate lets nothing pass that was planted: mistakes in the stepper, every fault an external engine can have, a known sort of
//! finding that became more frequent, with a fixed seed and with others; and it passes without them.

use crate::engines::{client, cpp_client};
use crate::gates::{around, gate};
use crate::mistaken_engine::OneEngine;
use crate::place::rockproof_in;
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::run::Campaign;
use rockproof_campaign::source;
use rockproof_differential::attribution::EnginePanel;
use rockproof_differential::builtin;
use rockproof_differential::engine::Engine;
use rockproof_differential::finding::Finding;
use rockproof_gate::config::GateConfig;
use rockproof_gate::known_findings::KnownFindings;
use rockproof_gate::tally::CampaignTally;
use rockproof_gate::{self, CheckStatus};
use rockproof_results::Start;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{SystemTime, UNIX_EPOCH};

/// Mistakes that the first pairs show; the campaign's own test looks for all of them.
const MISTAKES: [&str; 6] = [
    "no e-v test",
    "f-v: normal not negated",
    "the sign of gaps flipped",
    "sigma: sign flipped",
    "cone: overlap angle ignored",
    "entrances and exits: the smallest gap wins",
];
const GATE: &str = "[campaign]\npairs = 512\nengines = [\"stepper-f64\"]\ncases_per_cause = 0\nmetamorphic_every = 0\n\
                    [baseline]\nfile = \"known.toml\"\n[[limit]]\ncause = \"defect\"\ncount = 0\n";

/// What a campaign with this engine in place of the stepper finds.
fn tally(dir: &Path, config: &CampaignConfig, engine: Option<OneEngine>) -> CampaignTally {
    let source = source::of(config).expect("what exists");
    let panel = || builtin::panel(&config.engines, 0).expect("the stepper");
    let mut mistaken = panel();
    if let Some(engine) = engine {
        mistaken.engines = vec![Box::new(engine) as Box<dyn Engine>];
    }
    let narrow = |_: &Finding| -> EnginePanel { panel() };
    let campaign = Campaign { config, source: &source, panel: &mistaken, narrow: &narrow, steppers: &[], threads: 0 };
    let identity = source::identity(config).expect("a map");
    let mut journal = Journal::open(dir, identity, Start::Overwrite).expect("a folder");
    campaign.run(&mut journal, &AtomicBool::new(false), &mut |_| {}).expect("runs");
    CampaignTally::read(dir).expect("tables")
}

#[test]
fn mistakes_in_the_stepper_fail_and_the_stepper_passes() {
    let few = GATE.replace("pairs = 512", "pairs = 256");
    mistakes_fail(&few);
}

#[test]
#[ignore = "three seconds; .ci/run runs it"]
fn mistakes_in_the_stepper_fail_and_the_stepper_passes_at_full_size() {
    mistakes_fail(GATE);
}

fn mistakes_fail(gate: &str) {
    let dir = crate::place::folder();
    let config = GateConfig::from_toml(gate, "gate.toml").expect("good");
    let baseline = config.baseline.as_ref().expect("there is one");
    let clean = tally(dir.path(), &config.campaign, None);
    let known = KnownFindings::of(&clean, baseline, BTreeMap::new());
    let failed = |tally: &CampaignTally| {
        let limits = rockproof_gate::limits(&config, ("gate.toml", gate), "fixed", tally);
        let checks = [limits, known.check("fixed", tally, baseline, &BTreeMap::new())];
        checks.map(|checks| checks.iter().filter(|check| check.status == CheckStatus::Fail).count())
    };
    assert_eq!(failed(&clean), [0, 0]);
    for name in MISTAKES {
        let (_, mistake) = crate::mistakes::all().into_iter().find(|(other, _)| *other == name).expect("its name");
        // Under the stepper's name: the baseline shall not fail for that.
        let tally = tally(dir.path(), &config.campaign, Some(OneEngine("stepper-f64", mistake)));
        let [limits, unknown] = failed(&tally);
        assert!(limits == 1 && unknown > 0, "{name}: {limits} limits, {unknown} of the baseline");
    }
}

/// The engine with its answers changed on their way, as `sed` is told.
fn filtered(engine: &str, edit: &str) -> Vec<String> {
    vec!["sh".into(), "-c".into(), format!("'{engine}' | sed -u '{edit}'")]
}

/// Runs a gate around a command with a limit of none on each change, and gives the changes that fail.
fn fails(dir: &Path, command: &[String], changes: &[&str], more: &[&str]) -> Vec<String> {
    let limits =
        changes.iter().map(|change| format!("[[limit]]\nengine = \"mine\"\nchange = \"{change}\"\ncount = 0\n"));
    let words: Vec<&str> = command.iter().map(String::as_str).collect();
    let ran = gate(dir, &around(&words, &limits.collect::<String>()), more, false);
    assert!(ran.code < 2, "{}", ran.err);
    let xml = fs::read_to_string(dir.join("junit.xml")).expect("JUnit");
    let xml = roxmltree::Document::parse(&xml).expect("XML");
    let failed = xml.descendants().filter(|node| node.has_tag_name("failure")).filter_map(|node| node.parent());
    let failed: Vec<_> = failed.map(|case| case.attribute("name").unwrap_or_default().to_owned()).collect();
    assert_eq!(ran.code == 1, !failed.is_empty());
    changes
        .iter()
        .filter(|change| failed.iter().any(|name| name.ends_with(&format!("change {change}"))))
        .map(|change| (*change).to_owned())
        .collect()
}

#[test]
#[ignore = "six seconds; .ci/run runs it"]
fn wrong_contacts_fail() {
    let dir = crate::place::folder();
    let changes = ["missing", "extra", "kind", "entrance", "gap-sign", "crash", "timeout", "malformed", "unsupported"];
    let corner =
        r#"{"kind":"v-v","feature_a":0,"feature_b":0,"entrance":"v-f","entrance_a":0,"entrance_b":0,"gap_sign":1}"#;
    assert_eq!(fails(dir.path(), &filtered(&client(), ""), &changes, &[]), [""; 0], "the clean engine");
    for (edit, wanted) in [
        (r#"s/"gap_sign":1/"gap_sign":-1/g"#.to_owned(), "gap-sign"),
        (format!(r#"s/"contacts":\[\]/"contacts":[{corner}]/"#), "extra"),
        (r#"s/"contacts":\[{[^}]*},/"contacts":[/"#.to_owned(), "missing"),
        (r#"s/"entrance_b":[0-9]*/"entrance_b":0/g"#.to_owned(), "entrance"),
        (r#"s/"kind":"v-v"/"kind":"v-e"/g"#.to_owned(), "kind"),
        (r#"s/"kind"/"sort"/"#.to_owned(), "malformed"),
        (r#"s/"contacts":.*,"id"/"unsupported":"no","id"/"#.to_owned(), "unsupported"),
    ] {
        let failed = fails(dir.path(), &filtered(&client(), &edit), &changes, &[]);
        assert!(failed.iter().any(|change| change == wanted), "{wanted}: {failed:?}");
    }
}

#[test]
#[ignore = "six seconds; .ci/run runs it"]
fn wrong_states_gaps_and_normals_fail() {
    let dir = crate::place::folder();
    let Some(engine) = cpp_client() else { return };
    let changes = ["state", "gap", "normal"];
    assert_eq!(fails(dir.path(), &filtered(&engine, ""), &changes, &[]), [""; 0], "the clean engine");
    for (edit, wanted) in [
        (r#"s/"overlapping"/"touching"/"#, "state"),
        (r#"s/"apart"/"overlapping"/"#, "state"),
        (r#"s/"gap_m":-/"gap_m":-1/"#, "gap"),
        (r#"s/"normal":\[.*\]/"normal":[0.6,0.48,0.64]/"#, "normal"),
        (r#"s/"normal":\[.*\]/"normal":[0,0,0]/"#, "normal"),
    ] {
        assert_eq!(fails(dir.path(), &filtered(&engine, edit), &changes, &[]), [wanted], "{edit}");
    }
}

#[test]
fn who_changes_their_mind_fails() {
    let dir = crate::place::folder();
    let (place, client) = (dir.path().join("started").display().to_string(), client());
    // The first process is honest, the second one keeps contacts back.
    let moody = format!("if mkdir '{place}' 2>/dev/null; then exec '{client}'; else exec '{client}' none; fi");
    let moody = ["sh".to_owned(), "-c".to_owned(), moody];
    let twice = |command: &[String]| {
        let words: Vec<&str> = command.iter().map(String::as_str).collect();
        let limit = "[[limit]]\nchange = \"unstable\"\ncount = 0\n[[limit]]\nengine = \"mine\"\ncount = 9999\n";
        let text = around(&words, limit).replace("[campaign]", "[campaign]\nask_twice = true");
        gate(dir.path(), &text, &["--threads", "1"], false)
    };
    let ran = twice(std::slice::from_ref(&client));
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let ran = twice(&moody);
    assert!(ran.code == 1 && ran.out.contains("change unstable"), "{}{}", ran.out, ran.err);
    let case = fs::read_dir(dir.path().join("reports/gate/fixed/cases")).expect("cases").next();
    let case = fs::read_to_string(case.expect("a case").expect("a case").path()).expect("a case");
    assert!(case.contains("change = \"unstable\""), "{case}");
}

/// Of an engine that says only how blocks lie, and is asked twice whatever the gate says: it agrees, or is wrong, or changes its mind as when the case was made.
#[test]
fn cases_of_unstable_states_are_judged() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let known = include_str!("../../cases/regressions/v-v-arithmetic-swap.toml");
    let (_, tolerances) = known.split_once("[tolerances]").expect("tolerances");
    let (tolerances, _) = tolerances.split_once("[[block]]").expect("blocks");
    let cube = |x: i32| {
        let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let corners = corners.map(|[along, y, z]| [x + along, y, z]);
        let faces = "[[3,2,1,0],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]]";
        format!("[[block]]\nvertices = {corners:?}\nfaces = {faces}\n")
    };
    let about = "[case]\nengine = \"mine\"\ncause = \"engine\"\nchange = \"unstable\"\nexpected = []\nfound = []\n";
    let case = format!("{about}[tolerances]{tolerances}{}{}", cube(0), cube(9));
    fs::write(dir.join("case.toml"), case).expect("written");
    let says = |state: &str| format!("'{}' apart | sed -u s/apart/{state}/", client());
    // Every other process says something else.
    let count = dir.join("started").display().to_string();
    let (right, wrong) = (says("apart"), says("touching"));
    let moody = format!("echo >> '{count}'; if [ $(($(wc -l < '{count}') % 2)) = 0 ]; then {right}; else {wrong}; fi");
    for (script, code, wanted) in
        [(&right, 0, "the engine agrees"), (&wrong, 1, "which the case does not record"), (&moody, 0, "as recorded")]
    {
        let text = around(&["sh", "-c", script], "").replace("corpus = []", "corpus = [\"case.toml\"]");
        let ran = gate(
            dir,
            &text.replace("pairs = 256", "pairs = 16").replace("= 500", "= 60000"),
            &["--format", "json"],
            false,
        );
        assert!(ran.code == code && ran.out.contains(wanted), "{script}: {}{}", ran.out, ran.err);
    }
    fs::write(dir.join("moody.sh"), &moody).expect("written");
    let (code, out, err) = rockproof_in(dir, &["replay", "case.toml", "--engine-command", "mine=sh moody.sh"]);
    assert!(code == 0 && out.contains("the finding recurs"), "{out}{err}");
}

const COARSE_BASELINE: &str =
    "[baseline]\nfile = \"known.toml\"\nfields = [\"engine\", \"cause\", \"change\"]\nconfidence = 0.99\n";

#[test]
fn what_is_known_may_not_become_more_frequent() {
    let dir = crate::place::folder();
    let (dir, client) = (dir.path(), client());
    // Keeps all contacts back in one pair of three; the rates of this are the known ones.
    let text = |command: &[&str]| {
        let text = around(command, COARSE_BASELINE).replace("pairs = 256", "pairs = 512\ntolerances = [\"auto\"]");
        format!("rotating_pairs = 512\n{text}")
    };
    let ran = gate(dir, &text(&[&client, "none"]), &["--update-baseline"], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let known = fs::read_to_string(dir.join("known.toml")).expect("a baseline");
    assert!(known.contains("\"mine | engine | missing\" = { findings = "), "{known}");
    // Of an engine that is mended it is said what to do with what is gone.
    let ran = gate(dir, &text(&[&client]), &["--rotating-seed", "7"], false);
    let advice = "gone, none new, none more often; --update-baseline takes those out, so that none comes back unseen";
    let junit = fs::read_to_string(dir.join("junit.xml")).expect("a report");
    assert!(ran.code == 0 && ran.out.contains(advice), "{}{}", ran.out, ran.err);
    assert!(junit.contains(advice), "{junit}");
    for seed in ["7", "8", "9"] {
        let ran = gate(dir, &text(&[&client, "none"]), &["--rotating-seed", seed], false);
        assert!(ran.code == 0 && ran.out.contains("none more often"), "seed {seed}: {}{}", ran.out, ran.err);
    }
    // Keeps them back in every pair: nothing new, but more of it.
    let worse = filtered(&client, r#"s/"contacts":.*,"id"/"contacts":[],"id"/"#);
    let words: Vec<&str> = worse.iter().map(String::as_str).collect();
    let ran = gate(dir, &text(&words), &["--rotating-seed", "7"], false);
    for run in ["fixed", "rotating"] {
        let message = format!("{run}: more often: mine | engine | missing");
        assert!(ran.code == 1 && ran.out.contains(&message), "{run}: {}{}", ran.out, ran.err);
    }
    assert!(!ran.out.contains("new: "), "{}", ran.out);
    // What the baseline has never seen fails a rotating campaign only where it is no chance.
    fs::write(dir.join("known.toml"), known.replace("missing", "extra")).expect("written");
    let ran = gate(dir, &text(&[&client, "none"]), &["--rotating-seed", "7"], false);
    assert!(ran.out.contains("new: mine | engine | missing"), "{}", ran.out);
    assert!(ran.out.contains("rotating: baseline") && !ran.out.contains("more often: mine"), "{}", ran.out);
}

#[test]
fn the_rotating_seed_is_the_one_given_or_the_day() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let rotating = "rotating_pairs = 64\n";
    let limit = "[[limit]]\ncause = \"defect\"\ncount = 0\n";
    let text = format!("{rotating}corpus = []\n[campaign]\npairs = 64\nfamilies = [\"sliver\"]\n{limit}");
    let findings = |run: &str| fs::read_to_string(dir.join("reports/gate").join(run).join("findings.csv")).expect(run);
    let seed = || {
        let run = fs::read_to_string(dir.join("reports/gate/rotating/run.json")).expect("run.json");
        let run: serde_json::Value = serde_json::from_str(&run).expect("JSON");
        run["configuration"]["seed"].as_u64().expect("a seed")
    };
    let mut made = Vec::new();
    for given in ["11", "12", "11"] {
        assert_eq!(gate(dir, &text, &["--rotating-seed", given], false).code, 0);
        assert_eq!(seed().to_string(), given);
        made.push((findings("fixed"), findings("rotating")));
    }
    assert!(made[0] == made[2] && made[0].1 != made[1].1 && made[0].0 == made[1].0 && made[0].0 != made[0].1);
    let today = || SystemTime::now().duration_since(UNIX_EPOCH).expect("after 1970").as_secs() / 86_400;
    let before = today();
    assert_eq!(gate(dir, &text, &[], false).code, 0);
    assert!((before..=today()).contains(&seed()), "{}", seed());
    // None is asked for.
    fs::remove_dir_all(dir.join("reports")).expect("removed");
    assert_eq!(gate(dir, &text.replace(rotating, ""), &["--rotating-seed", "11"], false).code, 0);
    assert!(!dir.join("reports/gate/rotating").exists());
}
