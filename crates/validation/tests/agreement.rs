//! Every path to an answer against every other on the campaign's pairs, boundary-directed ones included: the fast oracle,
//! the plain one in each backend, and the stepper with a scalar of several hundred bits.
//!
//! Caught so far: nothing in the oracle; it is here so that it stays that way. The same comparison runs for as long as one likes with
//! `examples/self_comparison`; that it finds a mistaken path is held by `crates/validation/tests/self_comparison.rs`.

use rayon::prelude::*;
use rockproof_differential::engine::Levels;
use rockproof_pairs::batch::PairConfig;
use rockproof_validation::self_comparison::compare::{OtherPaths, compare_batch};
use rockproof_validation::self_comparison::paths::{self, Paths};
use rockproof_validation::self_comparison::tally::{Tally, Totals};

#[cfg(feature = "gmp")]
const PATHS: &dyn Paths = &paths::WithGmp::<rug::Rational>::new();
#[cfg(not(feature = "gmp"))]
const PATHS: &dyn Paths = &paths::BuiltIn;

#[test]
fn all_paths_agree() {
    agree(if cfg!(debug_assertions) { 2 } else { 4 });
}

#[test]
#[ignore = "half a minute; .ci/run runs it"]
fn all_paths_agree_at_full_size() {
    agree(24);
}

/// A pair of the comparison of ten million: the foot of a vertex lies exactly on an edge of a concave face, at whose level the vertex is.
#[test]
fn a_foot_on_a_reentrant_edge_is_not_inside() {
    let batch = compare_batch(
        PATHS,
        (77, 2_405_691 / 16),
        &PairConfig::default(),
        OtherPaths { settled: true, plain: true, gmp: true },
    );
    assert_eq!(batch.family, "concave_notch");
    assert!(batch.disagreements.is_empty(), "{:?}", batch.disagreements);
}

fn agree(batches: u64) {
    let (config, mut totals) = (PairConfig::default(), Totals::default());
    let slow = OtherPaths { settled: true, plain: true, gmp: true };
    let compared = |number| compare_batch(PATHS, (5, number * 7), &config, slow);
    for batch in (0..batches).into_par_iter().map(compared).collect::<Vec<_>>() {
        assert!(batch.disagreements.is_empty(), "{:?}", batch.disagreements);
        totals.add(batch.family, batch.tally);
        totals.add_levels(batch.levels);
    }
    let Tally { with_contacts, at_ties, plain, gmp, .. } = totals.all();
    let compared = totals.all().compared();
    println!("{totals:?}");
    assert_eq!((plain, gmp), (compared, if cfg!(feature = "gmp") { compared } else { 0 }));
    assert!(with_contacts * 3 > compared, "most pairs of the campaign touch");
    let of_level = |name: &str| Levels::NAMES.iter().position(|level| *level == name).map(|at| totals.levels[at]);
    assert!(at_ties > 0 && of_level("i128") > Some(0), "ties are reached");
}
