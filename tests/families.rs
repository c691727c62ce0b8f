//! Pins what the pair generators promise.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof::campaign::families;
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
