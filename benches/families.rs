//! The time of making pairs, family by family, in criterion: `cargo bench -p rockproof-benches --bench families -- sliver`.
#![allow(missing_docs)] // criterion's macros make public items

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rockproof_pairs::batch::{BATCH, PairConfig, batch};
use rockproof_pairs::families;
use std::hint::black_box;
use std::time::Duration;

/// Batches one iteration makes.
const BATCHES: u64 = 16;

fn pairs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pairs");
    group.sample_size(10).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    group.throughput(Throughput::Elements(BATCHES * BATCH));
    for family in families::all() {
        let name = family.name();
        let config = PairConfig { families: vec![family], ..PairConfig::default() };
        group.bench_function(name, |bencher| {
            bencher.iter(|| (0..BATCHES).map(|number| batch(1, number, black_box(&config)).len()).sum::<usize>());
        });
    }
    group.finish();
}

criterion_group!(benches, pairs);
criterion_main!(benches);
