//! A case of a pair made smaller: it shows the same finding, within the examinations that are allowed, and these are counted.

use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::engines::Engines;
use rockproof_campaign::shrink::Shrinker;
use rockproof_differential::attribution::{EnginePanel, examine_pair};
use rockproof_differential::builtin::BuiltinOracle;
use rockproof_differential::case_file::{Case, contact_rows};
use rockproof_differential::engine::{Engine, EngineFailure, Oracle, Prepared, Trace, WideAnswer};
use rockproof_differential::finding::Cause;
use rockproof_model::preset::{self, Preset};
use rockproof_model::{Block, Contact, Number, Precision, ToleranceSet, Vec3};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::{Classifier, Stepper};
use std::sync::atomic::{AtomicU64, Ordering};

/// An f64 that is a bit too deep for a tolerance.
const CASE: &str = include_str!("../../cases/regressions/f-v-arithmetic-vertex-face-depth.toml");

#[test]
fn examinations_are_counted_and_none_is_made_beyond_those_allowed() {
    let case = || Case::from_toml(CASE, "case".to_owned()).expect("a case");
    let engines = Engines::of(&CampaignConfig::default()).expect("the built-in engines");
    let panel = engines.panel_of(&case()).expect("its engine");
    let shrunk = |evaluations| {
        let examined = AtomicU64::new(0);
        let small = Shrinker::new(&panel, evaluations).counted(&examined).shrink(case());
        assert!(!small.findings(&panel).is_empty(), "{evaluations}: the finding is still there");
        (small.to_toml().expect("TOML"), examined.into_inner())
    };
    let (most, examined) = shrunk(5000);
    assert!((2..5000).contains(&examined), "{examined}");
    for few in [1, 2] {
        assert_eq!(shrunk(few).1, few);
    }
    // Once nothing helps any more, more examinations change nothing.
    assert_eq!(shrunk(10_000), (most, examined));
}

/// A stepper that finds no contacts the first times it is asked, and then all.
struct Fickle {
    wrong: AtomicU64,
}

struct FicklePair<'p>(&'p Fickle, &'p Block, &'p Block);

impl Engine for Fickle {
    fn name(&self) -> &str {
        "fickle"
    }

    fn precision(&self) -> Precision {
        Precision::F64
    }

    fn cause(&self) -> Cause {
        Cause::Engine
    }

    fn prepare<'p>(&'p self, a: &'p Block, b: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure> {
        Ok(Box::new(FicklePair(self, a, b)))
    }
}

impl Prepared for FicklePair<'_> {
    fn classify(&self, tolerances: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure> {
        let left = self.0.wrong.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |left| left.checked_sub(1));
        if left.is_ok() {
            return Ok(Vec::new());
        }
        let stepper = Stepper::<SpecRules>::new();
        stepper.f64(self.1, self.2, tolerances).map_err(|e| EngineFailure::Failed(e.to_string()))
    }

    fn trace(&self, _: &ToleranceSet) -> Option<Trace> {
        None
    }

    fn classify_wide(&self, _: &ToleranceSet) -> Option<WideAnswer> {
        None
    }
}

/// Whenever it stops showing its finding, what is left of a case is one that can be read: its contacts are about its own blocks.
#[test]
fn the_case_of_an_engine_that_answers_otherwise_each_time_can_be_read() {
    // A small box on a large one.
    let block = |[low, high]: [[i32; 3]; 2]| {
        let [low, high] = [low, high].map(|[x, y, z]| Vec3::new(x, y, z).map(|c| Number::from_integer(*c)));
        Block::cuboid(&low, &high).expect("a box")
    };
    let [a, b] = [[[0, 0, 0], [5, 6, 4]], [[1, 2, 4], [3, 5, 7]]].map(block);
    let tolerances = preset::derive(Preset::Auto, &[&a, &b], Precision::F64).expect("tolerances");
    let case = Case::from_toml(CASE, "case".to_owned()).expect("a case");
    let subject = Case { a, b, tolerances, ..case }.subject();
    let mut shrunk = 0;
    for wrong in 2..40 {
        let engine = Fickle { wrong: wrong.into() };
        let panel =
            EnginePanel { oracle: Box::new(BuiltinOracle), engines: vec![Box::new(engine)], metamorphic_every: 0 };
        let findings = examine_pair(&subject, &panel).findings;
        let finding = findings.iter().find(|finding| finding.cause == Cause::Engine).expect("no contacts is wrong");
        let whole = Case::of(finding, &subject, 1, &panel).expect("a case");
        let features = |case: &Case| [&case.a, &case.b].map(|block| block.vertices().len());
        let before = features(&whole);
        let small = Shrinker::new(&panel, 5000).shrink(whole);
        shrunk += usize::from(features(&small) != before);
        let tolerances = small.tolerances.rounded(Precision::F64).expect("tolerances");
        let exact = BuiltinOracle.prepare(&small.a, &small.b).pair().classify(&tolerances).contacts;
        assert_eq!(small.about.expected, contact_rows(&exact), "wrong {wrong} times");
        let text = small.to_toml().expect("TOML");
        if let Err(error) = Case::from_toml(&text, "small".to_owned()) {
            panic!("wrong {wrong} times: {error}");
        }
    }
    assert!(shrunk > 0, "some blocks lost vertices");
}
