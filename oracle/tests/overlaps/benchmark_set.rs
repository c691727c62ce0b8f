//! The depths of the benchmark set, `cases/benchmark/pairs.jsonl`: what changes one of them makes another benchmark (docs/benchmark_set.md).

use crate::support::project_file;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::{Block, BlockOptions, Number, Vec3};
use rockproof_oracle::penetration::penetration;
use serde::Deserialize;

#[derive(Deserialize)]
struct StoredPair {
    id: u32,
    a: StoredBlock,
    b: StoredBlock,
    penetration: StoredDepth,
}

#[derive(Deserialize)]
struct StoredBlock {
    vertices: Vec<[String; 3]>,
    faces: Vec<Vec<u32>>,
}

#[derive(Deserialize)]
struct StoredDepth {
    depth_squared: String,
}

fn block(stored: StoredBlock) -> Block {
    let number = |text: &String| Number::from_rational(text.parse().unwrap());
    let vertices = stored.vertices.iter().map(|[x, y, z]| Vec3::new(number(x), number(y), number(z))).collect();
    Block::new(vertices, stored.faces, &BlockOptions::default()).unwrap()
}

#[test]
fn all_depths_of_the_benchmark_set_come_out_again() {
    let text = std::fs::read_to_string(project_file("cases/benchmark/pairs.jsonl")).unwrap();
    let mut pairs = 0;
    for line in text.lines() {
        let StoredPair { id, a, b, penetration: stored } = serde_json::from_str(line).unwrap();
        let found = penetration(&block(a), &block(b)).unwrap().gap;
        let squared = if found.sign.is_negative() { found.squared } else { BigRational::zero() };
        assert_eq!(squared.to_string(), stored.depth_squared, "pair {id}");
        pairs += 1;
    }
    assert_eq!(pairs, 2000);
}
