//! The plain path against the golden pairs, contact for contact, entrances and squared gaps included, on each backend.

use num_rational::BigRational;
use rockproof_oracle::plain;
use rockproof_oracle::rational::Rational;

fn reproduces_every_pair<Q: Rational>() {
    let pairs = crate::support::golden::pairs();
    assert_eq!(pairs.len(), 180);
    let mut wrong = Vec::new();
    for pair in &pairs {
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
fn the_default_backend_reproduces_every_pair() {
    reproduces_every_pair::<BigRational>();
}

#[cfg(feature = "gmp")]
#[test]
fn the_gmp_backend_reproduces_every_pair() {
    reproduces_every_pair::<rug::Rational>();
}
