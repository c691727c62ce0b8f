//! Passages and unseen overlaps in the steps of campaigns: the family made for them reaches them and what just avoids them, their causes
//! are right, and mistakes that let blocks through one another are found by them.

use crate::step_mistakes::{Mistake, Mistaken, PLANTING, plant};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::source::{self, FamilySource};
use rockproof_campaign::steps::{StepChange, StepEngine, StepFinding, StepperStepEngine, case, examine_all};
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::intrusion::CausedIntrusion;
use rockproof_differential::lockstep::run::KEPT_PRECISION;
use rockproof_differential::lockstep::{ComparedLinks, ExactScene, Intrusion, Lockstep, StepCause};
use rockproof_differential::motion::PairMotion;
use rockproof_differential::subject::{NamedSet, PairSource, Subject};
use rockproof_model::scene::SceneBlock;
use rockproof_model::{Block, Motion, Number, Precision, Scene, ToleranceSet, Vec3};
use rockproof_oracle::passage::{PassageAnswer, StraightMotion, passage};
use rockproof_pairs::passing::{self, PASSAGE};
use rockproof_stepper::contact::SpecRules;
use std::collections::BTreeMap;

fn source_of(steps_every: u64) -> FamilySource {
    let families = vec![PASSAGE.to_owned()];
    source::of(&CampaignConfig { families, steps_every, ..CampaignConfig::default() }).expect("the family exists")
}

/// The pairs of the first batches.
fn pairs(batches: u64) -> Vec<(Subject, PairMotion)> {
    let source = source_of(1);
    (0..batches).flat_map(|number| source.step_pairs(number)).collect()
}

/// What the exact step of a pair does.
#[derive(Clone, Copy, Debug, Default)]
struct Reached {
    steps: u32,
    passages: u32,
    /// Never deeper than g, but deeper than a millionth less.
    just_avoided: u32,
    undecided: u32,
    unseen: u32,
}

fn exactly(subject: &Subject, motion: &PairMotion, set: &NamedSet, reached: &mut Reached) {
    let set = set.of(Precision::F64);
    let scene = ExactScene::new(&motion.scene(&subject.a, &subject.b, set), set);
    let before = scene.begin();
    let Ok(made) = scene.step(&before, KEPT_PRECISION) else { return };
    reached.steps += 1;
    let (before, after) = (scene.blocks_at(&before), scene.blocks_at(&made.state));
    let [a, b] = [0, 1].map(|k| StraightMotion::new(&before[k], &after[k]));
    let answer = passage(&a, &b, &set.penetration).answer;
    let less = set.penetration.times(&Number::parse("999999/1000000").unwrap());
    match answer {
        PassageAnswer::Passage { .. } => reached.passages += 1,
        PassageAnswer::Undecided => reached.undecided += 1,
        PassageAnswer::NoPassage => {
            let more = passage(&a, &b, &less).answer;
            reached.just_avoided += u32::from(!matches!(more, PassageAnswer::NoPassage));
        }
        PassageAnswer::DeepAtEnd => {}
    }
}

#[test]
fn the_family_reaches_passages_and_what_just_avoids_them() {
    let engine = StepperStepEngine::<f64, SpecRules>::f64("stepper-f64");
    let mut by_set: BTreeMap<&str, Reached> = BTreeMap::new();
    let mut by_form: BTreeMap<&str, u32> = BTreeMap::new();
    let mut causes: BTreeMap<(&str, &str), u32> = BTreeMap::new();
    let pairs = pairs(3);
    for (subject, motion) in &pairs {
        for set in &subject.sets {
            let reached = by_set.entry(&set.name).or_default();
            exactly(subject, motion, set, reached);
            for made in engine.steps(subject, set, motion).unwrap_or_default() {
                let Some(watched) = made.compared.watched else { continue };
                reached.unseen += watched.oracle.count(Intrusion::Unseen) as u32;
                *by_form.entry(&subject.form).or_default() += watched.oracle.count(Intrusion::Passage) as u32;
                for attributed in &watched.attributed {
                    assert_ne!(attributed.cause, Cause::Defect.into(), "pair {} under {}", subject.index, set.name);
                    *causes.entry((attributed.kind.name(), attributed.cause.name())).or_default() += 1;
                }
            }
        }
    }
    for (set, reached) in &by_set {
        println!("{set:60} {reached:?}");
    }
    println!("{by_form:?} {causes:?}");
    // Δt is cut until nothing goes further than u, of which s is more than twice; u of many edges with s as large, and without.
    let [small, held, free] = [0, 1, 2].map(|set| by_set[passing::SETS[set]]);
    assert_eq!((small.passages, small.unseen), (0, 0), "{small:?}");
    assert!(free.passages >= 6 && free.unseen >= 2 && free.just_avoided >= 1, "{free:?}");
    assert!(held.passages + held.unseen < free.passages + free.unseen, "{held:?} {free:?}");
    assert!(by_set.values().all(|reached| reached.undecided * 10 <= reached.steps), "{by_set:?}");
    assert!(by_form.len() == 4 && by_form.values().filter(|passages| **passages > 0).count() >= 3, "{by_form:?}");
    for reached in [("passage", "step-length"), ("passage", "not-held"), ("unseen", "step-length")] {
        assert!(causes.contains_key(&reached), "{reached:?}: {causes:?}");
    }
}

/// A blade, standing on its edge above a plate, that falls through it in one step; s is a fraction of the way, or more than all of it.
fn blade(search: &str) -> (Scene, ToleranceSet) {
    let cuboid = |min: [&str; 3], max: [&str; 3]| SceneBlock::new("block", Block::cuboid(&v(min), &v(max)).unwrap());
    let mut plate = cuboid(["-2", "-2", "0"], ["2", "2", "1/8"]);
    plate.body.motion = Motion::Fixed;
    let mut blade = cuboid(["-1/16", "-1", "1/4"], ["1/16", "1", "3/4"]);
    blade.body.motion = Motion::Rigid;
    blade.body.velocity = v(["0", "0", "-64"]);
    let mut scene = Scene { blocks: vec![plate, blade], ..Scene::default() };
    let simulation = &mut scene.simulation;
    simulation.gravity = v(["0", "0", "0"]);
    simulation.control.time_step = n("1/64");
    simulation.joints.other.normal_stiffness = Some(n("1e12"));
    simulation.joints.other.shear_ratio = n("1/2");
    let set = ToleranceSet {
        search: n(search),
        territory: n("1/128"),
        penetration: n("1/128"),
        max_displacement: n("1"),
        max_rotation: n("1/8"),
        ..ToleranceSet::ZERO
    };
    (scene, set)
}

fn n(text: &str) -> Number {
    Number::parse(text).unwrap()
}

fn v([x, y, z]: [&str; 3]) -> Vec3<Number> {
    Vec3::new(n(x), n(y), n(z))
}

/// Passages of the stepper and of the oracle in the blade's step, and their causes.
fn watched(search: &str) -> ([usize; 2], Vec<&'static str>) {
    let (scene, set) = blade(search);
    let mut lockstep =
        Lockstep::<f64, SpecRules>::new(&scene, &set, Precision::F64, ComparedLinks::All).unwrap().watching();
    let step = lockstep.step().1.watched.unwrap();
    let passages = [&step.stepper, &step.oracle].map(|side| side.count(Intrusion::Passage));
    (passages, step.attributed.iter().map(|attributed| attributed.cause.name()).collect())
}

#[test]
fn a_blade_goes_through_where_no_contact_is_sought() {
    // 64 m/s for 1/64 s: the blade comes out below. Steps of a sixteenth of that would have found the plate.
    assert_eq!(watched("1/16"), ([1, 1], vec!["step-length"]));
    // Found at once, it is stopped.
    assert_eq!(watched("2"), ([0, 0], vec![]));
}

fn mistaken() -> Vec<Box<dyn StepEngine>> {
    vec![Box::new(StepperStepEngine::<f64, Mistaken>::f64("stepper-f64"))]
}

/// What shows a mistake in passages or unseen overlaps of a few pairs: the number of the first such pair, and the finding. The mistake
/// stays.
fn shown(mistake: Mistake, pairs: &[(Subject, PairMotion)]) -> Option<(usize, StepFinding)> {
    plant(mistake);
    pairs.iter().enumerate().find_map(|(number, (subject, motion))| {
        let found = examine_all(&[(subject, motion.clone())], &mistaken()).findings;
        let of_code =
            |f: &StepFinding| matches!(f.change, StepChange::Intrusion(_)) && f.cause == StepCause::Link(Cause::Defect);
        Some((number, found.into_iter().find(of_code)?))
    })
}

#[test]
fn mistakes_that_let_blocks_through_are_found_by_passages() {
    let _alone = PLANTING.lock();
    let pairs = pairs(3);
    for mistake in [Mistake::NoDisplacementLimit, Mistake::StepEnlarged, Mistake::ContactsDropped] {
        let shown = shown(mistake, &pairs);
        plant(Mistake::Nothing);
        let told =
            shown.map(|(number, f)| format!("{number}: {} → {} under {} in {}", f.before, f.after, f.set, f.form));
        println!("{mistake:?}: {told:?}");
        assert!(told.is_some(), "{mistake:?}");
    }
}

#[test]
fn the_blocks_of_a_mistakes_passage_are_made_smaller_while_it_is_still_that() {
    let _alone = PLANTING.lock();
    let pairs = pairs(1);
    let (number, finding) = shown(Mistake::StepEnlarged, &pairs).expect("a finding");
    let (subject, motion) = &pairs[number];
    let [as_it_is, small] = [0, 300].map(|evaluations| {
        let case = case::of(&finding, subject, motion, &mistaken(), evaluations).expect("a case");
        let (scene, set) = case.scene().expect("a scene");
        let mut lockstep =
            Lockstep::<f64, Mistaken>::new(&scene, &set, Precision::F64, ComparedLinks::All).unwrap().watching();
        let watched = lockstep.step().1.watched.expect("both make the step");
        let same = |c: &CausedIntrusion| (StepChange::Intrusion(c.kind), c.cause) == (finding.change, finding.cause);
        assert!(watched.attributed.iter().any(same), "{:?}", watched.attributed);
        let shapes = scene.shapes();
        let features = shapes.iter().map(|b| b.vertices().len() + b.topology().faces().len()).sum::<usize>();
        let digits = shapes.iter().flat_map(|b| b.coordinates()).map(|c| format!("{:?}", c.to_rational()).len());
        (features, digits.sum::<usize>())
    });
    plant(Mistake::Nothing);
    println!("features and digits: {as_it_is:?} to {small:?}");
    assert!(small.0 < as_it_is.0 && small.1 < as_it_is.1, "{as_it_is:?} to {small:?}");
}
