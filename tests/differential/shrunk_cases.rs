//! A case of a pair made smaller: it shows the same finding, within the examinations that are allowed, and these are counted.

use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::engines::Engines;
use rockproof_campaign::shrink::Shrinker;
use rockproof_differential::case_file::Case;
use std::sync::atomic::AtomicU64;

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
