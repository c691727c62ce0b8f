//! Pins what the pair generators promise.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof::campaign::families;
use rockproof::campaign::pairs::{PairConfig, batch};
use rockproof::model::{Block, BlockOptions, Number};

#[test]
fn every_family_yields_canonical_blocks() {
    for family in families::all() {
        let mut rng = ChaCha8Rng::from_seed([7; 32]);
        for n in 0..300 {
            let (a, b) = family.generate(&mut rng);
            for block in [&a, &b] {
                let options = BlockOptions {
                    planarity: if family.name() == "real" { Number::from_f64(1e-3).unwrap() } else { Number::ZERO },
                };
                let again = Block::new(block.vertices().to_vec(), block.topology().faces().to_vec(), &options);
                assert_eq!(again.as_ref(), Ok(block), "{} {n}", family.name());
            }
        }
    }
}

#[test]
#[ignore = "a measurement: run it in release"]
fn speed() {
    for family in families::all() {
        let name = family.name();
        let config = PairConfig { families: vec![family], ..PairConfig::default() };
        let start = std::time::Instant::now();
        let mut pairs = 0;
        let mut forms = [0; 4];
        for k in 0..500 {
            for case in batch(1, k, &config) {
                pairs += 1;
                forms[match case.form.name() {
                    "base" => 0,
                    "moved" => 1,
                    "directed" => 2,
                    _ => 3,
                }] += 1;
            }
        }
        println!("{name:22} {:7.2} µs a pair  {forms:?}", start.elapsed().as_secs_f64() * 1e6 / f64::from(pairs));
    }
}
