//! The stepper on the golden pairs, whose contacts an independent exact implementation of SPEC section 4 worked out.
//! In the wide scalar every pair must agree whose comparisons were all settled.

use crate::golden_contacts::{self, GoldenPair};
use crate::pairs::show;
use num_rational::BigRational;
use num_traits::ToPrimitive;
use rockproof_model::lattice::Lattice;
use rockproof_model::{Block, Contact, Number};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::{Classifier, ComputedContact, PreparedBlock, Real, Stepper, Tolerances, Wide, classify, wide};

fn expected(pair: &GoldenPair) -> Vec<String> {
    pair.expected.iter().map(|(contact, _)| show(contact)).collect()
}

fn shown(contacts: &[Contact]) -> Vec<String> {
    contacts.iter().map(show).collect()
}

/// Pairs whose run was settled throughout, and the names of those that differ, all of them at ties.
fn run_wide(pairs: &[GoldenPair], check_gaps: bool) -> (usize, Vec<&str>) {
    let mut settled = 0;
    let mut differing = Vec::new();
    for pair in pairs {
        let (found, unsettled) = wide::count_unsettled(|| {
            let (a, b) = (PreparedBlock::<Wide>::new(&pair.a).unwrap(), PreparedBlock::new(&pair.b).unwrap());
            classify::<Wide, SpecRules>(&a, &b, &Tolerances::new(&pair.tolerances).unwrap())
        });
        settled += usize::from(unsettled == 0);
        let contacts: Vec<_> = found.iter().map(|f| f.contact).collect();
        if shown(&contacts) != expected(pair) {
            assert!(
                unsettled > 0,
                "{}: every comparison was settled, and yet\n found    {:?}\n expected {:?}",
                pair.name,
                shown(&contacts),
                expected(pair)
            );
            differing.push(pair.name.as_str());
        } else if check_gaps {
            check_squared_gaps(pair, &found);
        }
    }
    (settled, differing)
}

fn check_squared_gaps(pair: &GoldenPair, found: &[ComputedContact<Wide>]) {
    for (contact, expected) in &pair.expected {
        let expected = expected.to_f64().unwrap();
        let gap = found.iter().find(|f| f.contact == *contact).unwrap().gap.to_f64();
        // The unit normal of touching edges rounds, so that a gap of 0 may come out as one of some 1e-150.
        let near = (gap * gap - expected).abs() <= 1e-14 * expected + 1e-280;
        assert!(near, "{}: gap² {} for {expected}", pair.name, gap * gap);
    }
}

#[test]
fn wide_agrees_wherever_all_comparisons_were_settled() {
    let pairs = golden_contacts::pairs();
    assert_eq!(pairs.len(), 180);
    let (settled, differing) = run_wide(&pairs, true);
    eprintln!("settled {settled} of 180");
    assert!(differing.is_empty(), "{differing:?}");
    assert!(settled >= 119, "only {settled} of 180 pairs settled");
}

#[test]
fn on_a_lattice_more_is_settled_and_nothing_else_changes() {
    // Every decision is homogeneous in length, so whole coordinates must give the same answer; sums and products of
    // them are exact in 512 bits, and so are more of the ties.
    let pairs: Vec<_> = golden_contacts::pairs().into_iter().map(on_lattice).collect();
    let (settled, differing) = run_wide(&pairs, false);
    eprintln!("settled {settled} of 180 on a lattice");
    assert!(differing.is_empty(), "{differing:?}");
    assert!(settled >= 168, "only {settled} of 180 pairs settled");
}

fn on_lattice(mut pair: GoldenPair) -> GoldenPair {
    let t = &mut pair.tolerances;
    let lengths = [&t.search, &t.territory, &t.penetration];
    let lattice = Lattice::covering(pair.a.coordinates().chain(pair.b.coordinates()).chain(lengths));
    let whole = |number: &Number| Number::from_rational(BigRational::from_integer(lattice.units(number)));
    let scaled = |block: &Block| block.with_vertices(block.vertices().iter().map(|v| v.map(whole)).collect());
    (pair.a, pair.b) = (scaled(&pair.a), scaled(&pair.b));
    for length in [&mut t.search, &mut t.territory, &mut t.penetration] {
        *length = whole(length);
    }
    pair
}

#[test]
fn f64_and_f32_agree_with_most() {
    let stepper = Stepper::<SpecRules>::new();
    let mut agree = [0, 0];
    for pair in golden_contacts::pairs() {
        let expected = expected(&pair);
        agree[0] += usize::from(shown(&stepper.f64(&pair.a, &pair.b, &pair.tolerances).unwrap()) == expected);
        agree[1] += usize::from(shown(&stepper.f32(&pair.a, &pair.b, &pair.tolerances).unwrap()) == expected);
    }
    eprintln!("f64 agrees on {}, f32 on {} of 180", agree[0], agree[1]);
    // IEEE arithmetic gives the same answers everywhere; what is missing are ties and coordinates that round.
    assert!(agree[0] >= 172 && agree[1] >= 152, "{agree:?}");
}

#[test]
fn a_swapped_pair_gives_the_swapped_contacts() {
    // Where no entrance ties, and where the sign of a gap does not hang on a tie.
    let stepper = Stepper::<SpecRules>::new();
    let mut same = 0;
    for pair in golden_contacts::pairs() {
        let there = stepper.wide(&pair.a, &pair.b, &pair.tolerances).unwrap();
        let back = stepper.wide(&pair.b, &pair.a, &pair.tolerances).unwrap();
        let key = |c: &Contact| c.key;
        let mut swapped: Vec<_> = back.0.iter().map(|c| c.swapped()).collect();
        swapped.sort_by_key(key);
        if there.1 + back.1 == 0 {
            let keys = |all: &[Contact]| all.iter().map(|c| (key(c), c.gap)).collect::<Vec<_>>();
            assert_eq!(keys(&there.0), keys(&swapped), "{}", pair.name);
            same += 1;
        }
    }
    assert!(same > 100, "{same}");
}
