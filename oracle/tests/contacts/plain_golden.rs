//! The plain path against the golden pairs, contact for contact, entrances and squared gaps included, on each backend.

use num_rational::BigRational;
use rockproof_oracle::plain;
use rockproof_oracle::rational::Rational;

/// Of all pairs each so many-th, from the first one on.
fn reproduces_each<Q: Rational>(step: usize) {
    let pairs = crate::support::golden::pairs();
    assert_eq!(pairs.len(), 180);
    let mut wrong = Vec::new();
    for pair in pairs.iter().step_by(step) {
        let found: Vec<_> = plain::classify::<Q>(&pair.a, &pair.b, &pair.tolerances)
            .iter()
            .map(|f| (f.contact, f.gap_squared.to_big_rational()))
            .collect();
        if found != pair.expected {
            wrong.push(format!("{}\n  found    {found:?}\n  expected {:?}", pair.name, pair.expected));
        }
    }
    assert!(wrong.is_empty(), "{} pairs differ:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn the_default_backend_reproduces_every_second_pair() {
    reproduces_each::<BigRational>(2);
}

#[test]
#[ignore = "five seconds; .ci/run runs it"]
fn the_default_backend_reproduces_every_pair_at_full_size() {
    reproduces_each::<BigRational>(1);
}

#[cfg(feature = "gmp")]
#[test]
fn the_gmp_backend_reproduces_every_pair() {
    reproduces_each::<rug::Rational>(1);
}
