//! Every entry of `rockproof bench` in criterion, on the same pairs: `cargo bench -p rockproof-benches --bench classify -- generic/certified`.
//!
//! Criterion times one entry after the other, which suits a quiet machine and one of them over time. For
//! ratios use the command, which lets them take turns.
#![allow(missing_docs)] // criterion's macros make public items

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rockproof_bench::{Sample, SampleKind, bench_entries};
use std::hint::black_box;
use std::time::Duration;

/// Pairs one iteration goes through.
const PAIRS: usize = 256;

/// The same for plain rationals.
const SLOW_PAIRS: usize = 8;

fn classification(criterion: &mut Criterion) {
    for sort in SampleKind::ALL {
        let sample = Sample::new(sort, 1, PAIRS).expect("the default sets exist");
        let mut group = criterion.benchmark_group(sort.name());
        group.sample_size(20).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_secs(1));
        for entry in bench_entries() {
            let pairs = &sample.pairs[..if entry.slow { SLOW_PAIRS } else { PAIRS }];
            group.throughput(Throughput::Elements(pairs.len() as u64));
            group.bench_function(format!("{} {}", entry.engine, entry.mode.name()), |bencher| {
                bencher.iter(|| pairs.iter().map(|pair| (entry.run)(black_box(pair))).sum::<usize>());
            });
        }
        group.finish();
    }
}

criterion_group!(benches, classification);
criterion_main!(benches);
