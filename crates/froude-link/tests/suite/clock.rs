//! Clock alignment against clocks whose truth is known.

use froude_link::clock::{Aligner, Exchange, GROUP, Unwrapped};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A board clock: b = board₀ + (1 + drift)(h − host₀), read in whole µs.
#[derive(Clone, Copy, Debug)]
struct Truth {
    host_0: f64,
    board_0: f64,
    drift: f64,
}

impl Truth {
    fn board(self, host: f64) -> u64 {
        (self.board_0 + (1.0 + self.drift) * (host - self.host_0)) as u64
    }
}

/// A USB-serial line: 150 µs each way, asymmetric by up to `skew_us`, and queues with an exponential tail of 400 µs.
fn exchanges(truth: Truth, skew_us: f64, groups: usize, seed: u64) -> Aligner {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut queue = || -400.0 * f64::ln(1.0 - random.random::<f64>());
    let mut aligner = Aligner::default();
    let mut host = truth.host_0;
    for _ in 0..groups * GROUP {
        let arrived = host + 150.0 + skew_us + queue();
        let answered = arrived + 40.0;
        let back = answered + 150.0 - skew_us + queue();
        aligner.add(Exchange {
            host_sent_us: host as u64,
            board_received_us: truth.board(arrived),
            board_sent_us: truth.board(answered),
            host_received_us: back as u64,
        });
        host += 100_000.0 + queue();
    }
    aligner
}

/// Error of the alignment at its own middle, µs.
fn error_us(truth: Truth, aligner: &Aligner) -> (f64, f64, f64) {
    let line = aligner.alignment().unwrap();
    let host = line.host_us as f64 + line.host_after_us(line.board_us);
    let board = truth.board_0 + (1.0 + truth.drift) * (host - truth.host_0);
    (board - line.board_us as f64, line.offset_std_us, line.drift)
}

#[test]
fn offset_and_drift_are_found_within_what_is_stated() {
    let truth = Truth { host_0: 5e9, board_0: 1.234e6, drift: 40e-6 };
    let aligner = exchanges(truth, 0.0, 40, 7);
    let (error, std, drift) = error_us(truth, &aligner);
    assert!(error.abs() < 3.0 * std, "{error} µs, stated {std}");
    let stated = aligner.alignment().unwrap().drift_std;
    assert!((drift - truth.drift).abs() < 4.0 * stated, "drift {drift}, stated {stated}");
}

/// Quantiles of the stated uncertainty: asymmetries are drawn uniformly in what the line allows, so 95 % coverage is the
/// least that a standard uncertainty with k = 2 must reach; the bound holds always.
#[test]
fn twice_the_stated_uncertainty_holds_the_truth_in_at_least_95_of_100() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let mut held = 0;
    for seed in 0..200 {
        let truth = Truth { host_0: 1e9, board_0: 3e5, drift: 1e-4 * (random.random::<f64>() - 0.5) };
        let skew_us = 150.0 * (2.0 * random.random::<f64>() - 1.0);
        let aligner = exchanges(truth, skew_us, 30, seed);
        let (error, std, _) = error_us(truth, &aligner);
        held += u32::from(error.abs() <= 2.0 * std);
        // Half the shortest delay bounds each point it comes from; 2 µs are the steps of both clocks' stamps. The line
        // averages over points whose delays are a few tens of µs longer.
        let bound = aligner.alignment().unwrap().offset_bound_us + 60.0;
        assert!(error.abs() <= bound, "{error} µs, bound {bound}");
    }
    assert!(held >= 190, "{held} of 200");
}

#[test]
fn contradicting_stamps_are_dropped() {
    let mut aligner = Aligner::default();
    for _ in 0..100 {
        // The board says that it kept the request longer than the host waited.
        aligner.add(Exchange { host_sent_us: 0, board_received_us: 0, board_sent_us: 500, host_received_us: 400 });
    }
    assert!(aligner.alignment().is_none());
}

proptest! {
    #[test]
    fn board_time_is_unwrapped_over_any_number_of_wraps(
        start: u32, steps in prop::collection::vec(0..2_000_000_000_u32, 1..50),
    ) {
        let mut unwrapped = Unwrapped::default();
        let mut truth = u64::from(start);
        prop_assert_eq!(unwrapped.unwrap(truth as u32), truth);
        for step in steps {
            truth += u64::from(step);
            prop_assert_eq!(unwrapped.unwrap(truth as u32), truth);
        }
    }
}
