//! Steps in campaigns: motions reach what steps can do, results are the same bytes however a run goes, what is classified does
//! not depend on them, cases can be replayed, and deliberate mistakes in the iteration are found.

use crate::step_mistakes::{ALL, Mistake, Mistaken, plant};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::run::Campaign;
use rockproof_campaign::source::{self, FamilySource};
use rockproof_campaign::steps::summary::StepCounts;
use rockproof_campaign::steps::{self, StepEngine, StepExamination, StepperStepEngine, examine, examine_all};
use rockproof_differential::builtin;
use rockproof_differential::finding::{Cause, Finding};
use rockproof_differential::lockstep::case_file::{Expected, StepCase};
use rockproof_differential::lockstep::{ComparedLinks, Lockstep};
use rockproof_differential::motion::PairMotion;
use rockproof_differential::subject::{PairSource, Subject};
use rockproof_model::Precision;
use rockproof_results::Start;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Dynamics, RetryReason, State, StepRules};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

fn source_of(config: &CampaignConfig) -> FamilySource {
    source::of(config).expect("the configuration names what exists")
}

/// The pairs of some batches that move.
fn moving(source: &FamilySource, batches: std::ops::Range<u64>) -> Vec<(Subject, PairMotion)> {
    let subjects = batches.flat_map(|number| source.batch(number));
    subjects.filter_map(|subject| source.motion(&subject).map(|motion| (subject, motion))).collect()
}

fn both() -> Vec<Box<dyn StepEngine>> {
    steps::engines(["stepper-f32", "stepper-f64"])
}

#[test]
fn motions_reach_what_steps_can_do() {
    let source = source_of(&CampaignConfig { steps_every: 4, ..CampaignConfig::default() });
    let mut pairs = moving(&source, 0..56);
    assert!(pairs.len() > 150 && pairs.len() < 300, "{} of 896 pairs move", pairs.len());
    // Only blocks much smaller than their neighbour reach the limit of rotation before that of displacement.
    let unequal =
        CampaignConfig { families: vec!["size_ratio".to_owned()], steps_every: 4, ..CampaignConfig::default() };
    pairs.extend(moving(&source_of(&unequal), 0..12));
    let engine = StepperStepEngine::<f64, SpecRules>::f64("stepper-f64");
    let (mut reasons, mut most) = (BTreeMap::new(), 0);
    for (subject, motion) in &pairs {
        for made in engine.steps(subject, &subject.sets[0], motion).unwrap_or_default() {
            assert_eq!(made.compared.count(Cause::Defect), 0, "pair {}", subject.index);
            let Some(oracle) = made.compared.oracle else { continue };
            most = most.max(oracle.iterations());
            for reason in [RetryReason::NotConverged, RetryReason::Displacement, RetryReason::Rotation] {
                *reasons.entry(reason.name()).or_insert(0) += u32::from(oracle.retries.contains(&reason));
            }
        }
    }
    let mut all = StepExamination::default();
    let engines: Vec<Box<dyn StepEngine>> = vec![Box::new(engine)];
    pairs.iter().for_each(|(subject, motion)| examine(subject, motion, &engines, &mut all));
    let counts = all.summary.by_engine()["stepper-f64"];
    println!("{counts:?}\nat most {most} solves; attempts given up: {reasons:?}");
    let StepCounts { open, sliding, locked, turning, iterated, retried, .. } = counts;
    for (what, count) in [
        ("open", open),
        ("sliding", sliding),
        ("locked", locked),
        ("opening and closing within the iteration", turning),
        ("more than one solve", iterated),
        ("attempts given up", retried),
    ] {
        assert!(count > 3, "{what}: {count}");
    }
    assert!(most > 3, "solves: {most}");
    assert!(reasons.values().all(|count| *count > 0), "{reasons:?}");
    assert_eq!(counts.defect, 0);
    assert!(counts.undecided * 100 < counts.steps, "{} undecided", counts.undecided);
}

#[test]
fn a_motion_is_a_function_of_seed_and_index() {
    let config = CampaignConfig { steps_every: 2, ..CampaignConfig::default() };
    let of = |config: &CampaignConfig| moving(&source_of(config), 3..5);
    let (one, same) = (of(&config), of(&config));
    assert_eq!(
        one.iter().map(|(_, motion)| motion).collect::<Vec<_>>(),
        same.iter().map(|(_, m)| m).collect::<Vec<_>>()
    );
    let other = of(&CampaignConfig { seed: 2, ..config.clone() });
    assert!(one.iter().zip(&other).any(|((_, one), (_, other))| one != other));
    // A smaller share, and other tolerance sets, leave the motions as they are.
    let narrow = of(&CampaignConfig { tolerances: vec!["auto".to_owned()], ..config.clone() });
    for (subject, motion) in &narrow {
        let known =
            one.iter().find(|(known, _)| (known.index, &known.a, &known.b) == (subject.index, &subject.a, &subject.b));
        assert!(known.is_none_or(|(_, known)| known == motion));
    }
    let families: BTreeSet<_> = moving(&source_of(&config), 0..14).iter().map(|(s, _)| s.family.clone()).collect();
    assert_eq!(families.len(), 14);
}

fn config(steps_every: u64) -> CampaignConfig {
    CampaignConfig { pairs: 224, chunk: 32, steps_every, steps: 2, shrink_evaluations: 4, ..CampaignConfig::default() }
}

/// Runs a campaign for at most `chunks` chunks.
fn run(dir: &Path, config: &CampaignConfig, start: Start, threads: usize, chunks: usize) {
    let source = source_of(config);
    let panel = builtin::panel(&config.engines, 0).unwrap();
    let narrow = |finding: &Finding| builtin::panel_for(&config.engines, finding);
    let steppers = both();
    let campaign = Campaign { config, source: &source, panel: &panel, narrow: &narrow, steppers: &steppers, threads };
    let mut journal = Journal::open(dir, source::identity(config).unwrap(), start).unwrap();
    let stop = AtomicBool::new(chunks == 0);
    let mut done = 0;
    let mut watch = |_: &_| {
        done += 1;
        stop.store(done >= chunks, Ordering::Relaxed);
    };
    campaign.run(&mut journal, &stop, &mut watch).unwrap();
}

/// Every file that must not depend on how a run went.
fn results(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let tables = ["findings.csv", "summary.csv", "agreement.csv", "step_findings.csv", "step_summary.csv"];
    let tables = tables.iter().map(|name| dir.join(name)).filter(|path| path.exists());
    let cases = fs::read_dir(dir.join("cases")).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    tables.chain(cases).map(|path| (name(&path), fs::read(&path).unwrap())).collect()
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn the_same_bytes_however_it_runs_and_the_same_classification_without() {
    let config = config(6);
    let dirs = [(); 4].map(|()| crate::place::folder());
    let [one, two, resumed, without] = dirs.each_ref().map(|dir| dir.path());
    run(one, &config, Start::Fresh, 1, usize::MAX);
    let expected = results(one);
    assert!(expected["step_findings.csv"].iter().filter(|byte| **byte == b'\n').count() > 5);
    run(two, &config, Start::Fresh, 2, usize::MAX);
    assert!(expected == results(two), "two threads");
    run(resumed, &config, Start::Fresh, 2, 3);
    // What was appended after the last commit is cut off.
    let path = resumed.join("step_findings.csv");
    let torn = [fs::read(&path).unwrap(), b"torn".to_vec()].concat();
    fs::write(&path, torn).unwrap();
    run(resumed, &config, Start::Resume, 1, usize::MAX);
    assert!(expected == results(resumed), "resumed");
    run(without, &CampaignConfig { steps_every: 0, ..config.clone() }, Start::Fresh, 2, usize::MAX);
    let without = results(without);
    assert!(!without.contains_key("step_findings.csv") && !without.contains_key("step_summary.csv"));
    for (name, bytes) in &without {
        assert!(expected[name] == *bytes, "{name} depends on the steps");
    }
    let cases: Vec<_> = expected.keys().filter(|name| name.ends_with(".json")).collect();
    assert!(!cases.is_empty());
    for name in cases {
        let case = StepCase::load(&one.join("cases").join(name)).unwrap();
        let right = match case.precision().unwrap() {
            Precision::F32 => again::<f32>(&case),
            Precision::F64 => again::<f64>(&case),
        };
        assert_eq!(right, case.expected, "{name}");
    }
}

fn again<R: rockproof_stepper::dynamics::Solve>(case: &StepCase) -> Expected {
    let (scene, set) = case.scene().unwrap();
    let mut lockstep =
        Lockstep::<R, SpecRules>::new(&scene, &set, case.precision().unwrap(), ComparedLinks::Arithmetic).unwrap();
    if case.expected.intrusions.is_some() {
        lockstep = lockstep.watching();
    }
    lockstep.restore(case.state.state().unwrap()).unwrap();
    Expected::of_step(&lockstep.step().1).unwrap()
}

/// The states after each step, by the rules M.
fn states<M: StepRules>(subject: &Subject, motion: &PairMotion, set: usize) -> Vec<Option<State<f64>>> {
    let set = &subject.sets[set].f64;
    let scene = motion.scene(&subject.a, &subject.b, set);
    let Ok(mut dynamics) = Dynamics::<f64, M>::with_rules(&scene, set) else { return Vec::new() };
    (0..motion.steps).map(|_| dynamics.step().ok().map(|_| dynamics.state().clone())).collect()
}

/// Looks for every mistake in the moving pairs of a campaign until so many are found: what was found first of each, and the mistakes not found.
fn found(
    config: &CampaignConfig,
    batches: u64,
    enough: usize,
) -> (Vec<(u64, &'static str, String)>, Vec<&'static str>) {
    let _alone = crate::step_mistakes::PLANTING.lock();
    let source = source_of(config);
    let engines: Vec<Box<dyn StepEngine>> = vec![Box::new(StepperStepEngine::<f64, Mistaken>::f64("stepper-f64"))];
    let mut sought: Vec<(Mistake, &'static str)> =
        ALL.iter().copied().filter(|(m, _)| *m != Mistake::Nothing).collect();
    let mut found = Vec::new();
    for number in 0..batches {
        for (subject, motion) in moving(&source, number..number + 1) {
            let right: Vec<_> =
                (0..subject.sets.len()).map(|set| states::<SpecRules>(&subject, &motion, set)).collect();
            sought.retain(|&(mistake, what)| {
                plant(mistake);
                // Only where the mistake changes the stepper's step is it worth an exact one.
                if (0..subject.sets.len()).all(|set| states::<Mistaken>(&subject, &motion, set) == right[set]) {
                    return true;
                }
                let examined = examine_all(&[(&subject, motion.clone())], &engines);
                let defects: u64 = examined.summary.by_engine().values().map(|counts| counts.defect).sum();
                if defects > 0 {
                    let change = examined.findings.iter().find(|finding| finding.cause == Cause::Defect.into());
                    let change = change.map_or("contacts", |finding| finding.change.name());
                    found.push((subject.index, what, format!("{change} in {} {}", subject.family, subject.form)));
                }
                defects == 0
            });
        }
        if sought.is_empty() || found.len() >= enough {
            break;
        }
    }
    plant(Mistake::Nothing);
    (found, sought.into_iter().map(|(_, what)| what).collect())
}

fn told((found, missed): &(Vec<(u64, &'static str, String)>, Vec<&'static str>)) {
    found.iter().for_each(|(index, what, how)| println!("{index:6}  {what:80} {how}"));
    missed.iter().for_each(|what| println!("     -  {what}"));
    println!("{} found, {} not", found.len(), missed.len());
}

/// Every pair moves, for two steps.
#[test]
fn mistakes_in_the_iteration_are_found() {
    let config = CampaignConfig { steps_every: 1, steps: 2, ..CampaignConfig::default() };
    // More batches would ask every pair of them about the same few that are not found.
    let (batches, least) = if cfg!(debug_assertions) { (14, 16) } else { (14 * 2, 43) };
    let outcome = found(&config, batches, least);
    told(&outcome);
    assert!(outcome.0.len() >= least, "{outcome:?}");
}

#[test]
#[ignore = "a minute; cargo test --release --test differential campaign_steps -- --ignored --nocapture"]
fn mistakes_in_the_iteration_are_found_by_the_default_campaign() {
    let config = CampaignConfig::default();
    let outcome = found(&config, config.pairs / 16, usize::MAX);
    told(&outcome);
    // Contacts that forget show from the second step on only.
    assert!(outcome.0.len() >= 21, "{outcome:?}");
}
