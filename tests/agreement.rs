//! Every path to an answer against every other on generated pairs: the fast oracle, the plain one, and the stepper with
//! a scalar of several hundred bits.
//!
//! `ROCKPROOF_AGREEMENT_PAIRS` sets how many pairs the large (ignored) run takes.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof::campaign::families;
use rockproof::model::{Block, Criteria, Number, Precision, ToleranceSet};
use rockproof::oracle::{Pair, Solid, plain};
use rockproof::stepper::contact::Spec;
use rockproof::stepper::wide;

fn tolerances(k: u32) -> ToleranceSet {
    let f = |x: f64| Number::from_f64(x).unwrap();
    let base = ToleranceSet {
        search: f(0.125),
        territory: f(0.015625),
        penetration: f(0.0625),
        overlap_sine: f(0.046875),
        parallel_sine: f(0.046875),
        equal: f(9.5e-7),
        open: f(0.0),
        close: f(0.0),
        max_displacement: f(0.05),
        max_rotation: f(0.05),
        criteria: Criteria::Revised,
    };
    match k % 4 {
        0 => base,
        1 => ToleranceSet { criteria: Criteria::Classic, ..base },
        2 => base.ideal(),
        _ => ToleranceSet { territory: f(0.1), equal: f(0.0), search: f(0.1), ..base },
    }
}

struct Tally {
    pairs: usize,
    with_contacts: usize,
    unsettled: usize,
}

fn compare(count: usize) -> Tally {
    let mut tally = Tally { pairs: 0, with_contacts: 0, unsettled: 0 };
    let all = families::all();
    for k in 0..count {
        let family = &all[k % all.len()];
        let mut rng = ChaCha8Rng::seed_from_u64(k as u64);
        let (a, b) = family.generate(&mut rng);
        let t = tolerances((k / all.len()) as u32);
        one(&a, &b, &t, &format!("{} {k}", family.name()), &mut tally);
        if let (Some(a), Some(b), Ok(t)) =
            (a.rounded(Precision::F32), b.rounded(Precision::F32), t.rounded(Precision::F32))
            && k % 3 == 0
        {
            one(&a, &b, &t, &format!("{} {k} in f32", family.name()), &mut tally);
        }
    }
    tally
}

fn one(a: &Block, b: &Block, t: &ToleranceSet, name: &str, tally: &mut Tally) {
    let Ok((wide, unsettled)) = wide::classify::<Spec>(a, b, t) else { return };
    let (sa, sb) = (Solid::new(a), Solid::new(b));
    let fast = Pair::new(&sa, &sb).classify(t).contacts;
    let plain: Vec<_> =
        plain::classify::<num_rational::BigRational>(a, b, t).into_iter().map(|found| found.contact).collect();
    assert_eq!(fast, plain, "{name}: fast (left) and plain oracle (right)");
    tally.pairs += 1;
    tally.with_contacts += usize::from(!fast.is_empty());
    tally.unsettled += usize::from(unsettled > 0);
    assert_eq!(wide, fast, "{name}: wide stepper (left) and oracle (right), {unsettled} unsettled");
}

#[test]
fn all_paths_agree() {
    let tally = compare(420);
    println!(
        "{} pairs, {} with contacts, {} at a tie of square roots",
        tally.pairs, tally.with_contacts, tally.unsettled
    );
    assert!(tally.with_contacts * 2 > tally.pairs);
}

#[test]
#[ignore = "the large run; release only"]
fn all_paths_agree_on_many_pairs() {
    let count = std::env::var("ROCKPROOF_AGREEMENT_PAIRS").ok().and_then(|n| n.parse().ok()).unwrap_or(100_000);
    let tally = compare(count);
    println!(
        "{} pairs, {} with contacts, {} at a tie of square roots",
        tally.pairs, tally.with_contacts, tally.unsettled
    );
}
