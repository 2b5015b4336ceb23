//! Filters over 10⁷ samples; scipy's side is in `bench/peers`.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use froude_signal::{butterworth, decimate, zero_phase};

const SAMPLES: usize = 10_000_000;

fn main() {
    divan::main();
}

/// A slow sine under a deterministic ripple.
fn record() -> Vec<f64> {
    (0..SAMPLES).map(|i| (0.0126 * i as f64).sin() + 0.05 * (1.7 * i as f64).sin()).collect()
}

fn run(bencher: Bencher<'_, '_>, filter: impl Fn(&[f64]) -> Vec<f64> + Sync) {
    let record = record();
    bencher.counter(ItemsCount::new(SAMPLES)).bench(|| filter(black_box(&record)));
}

#[divan::bench(sample_count = 5)]
fn forward_backward_butterworth_4(bencher: Bencher<'_, '_>) {
    let low_pass = butterworth::low_pass(4, 10.0, 1000.0).unwrap();
    run(bencher, |x| zero_phase::filter(&low_pass, x).unwrap());
}

#[divan::bench(sample_count = 5)]
fn decimation_by_10(bencher: Bencher<'_, '_>) {
    run(bencher, |x| decimate::decimate(x, 10).unwrap());
}
