//! Filters over 10⁷ samples, the fast ones beside their definitions; scipy's side is in `bench/peers`.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use froude_signal::savitzky_golay::Window;
use froude_signal::{butterworth, decimate, gaussian, savitzky_golay, zero_phase};

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
fn gaussian_161_taps(bencher: Bencher<'_, '_>) {
    run(bencher, |x| gaussian::smooth(x, 20.0).unwrap());
}

#[divan::bench(sample_count = 1)]
fn gaussian_161_taps_by_its_definition(bencher: Bencher<'_, '_>) {
    run(bencher, |x| gaussian::smooth_reference(x, 20.0).unwrap());
}

const DERIVATIVE: Window = Window { samples: 41, order: 3, derivative: 1 };

#[divan::bench(sample_count = 5)]
fn savitzky_golay_derivative_41(bencher: Bencher<'_, '_>) {
    run(bencher, |x| savitzky_golay::filter(x, DERIVATIVE, 1e-3).unwrap());
}

#[divan::bench(sample_count = 1)]
fn savitzky_golay_derivative_41_by_its_definition(bencher: Bencher<'_, '_>) {
    run(bencher, |x| savitzky_golay::filter_reference(x, DERIVATIVE, 1e-3).unwrap());
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
