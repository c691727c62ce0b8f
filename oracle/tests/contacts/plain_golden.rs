//! The plain path against the golden pairs, contact for contact, entrances and squared gaps included, on each backend.

use num_rational::BigRational;
use rockproof_oracle::plain;
use rockproof_oracle::rational::Rational;
use std::time::Instant;

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

/// Prints the time per pair; not a check.
#[test]
#[ignore = "prints timings; run with --release -- --ignored --nocapture"]
fn time_per_pair() {
    fn time<Q: Rational>(name: &str) {
        let pairs = crate::support::golden::pairs();
        let start = Instant::now();
        let contacts: usize =
            pairs.iter().map(|pair| plain::classify::<Q>(&pair.a, &pair.b, &pair.tolerances).len()).sum();
        let each = start.elapsed().as_secs_f64() / pairs.len() as f64;
        println!("{name}: {:.3} ms a pair, {contacts} contacts in {} pairs", each * 1e3, pairs.len());
    }
    time::<BigRational>("num-rational");
    #[cfg(feature = "gmp")]
    time::<rug::Rational>("rug");
}
