//! The same record through scipy and through this crate; `golden/make_golden.py` wrote scipy's side.
//!
//! Tolerances follow from rounding: ε = 2.2e-16 times the number of operations a value passes, times how much the
//! filter amplifies them. They are relative to the largest number of a line.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::BTreeMap;

use froude_signal::harmonic::Harmonics;
use froude_signal::resample::Spline;
use froude_signal::{butterworth, clock, decimate, differences, spectrum, zero_phase};

fn golden() -> BTreeMap<&'static str, Vec<f64>> {
    include_str!("golden/scipy.txt")
        .lines()
        .filter(|l| !l.starts_with('#'))
        .map(|l| {
            let mut words = l.split(' ');
            (words.next().unwrap(), words.map(|w| w.parse().unwrap()).collect())
        })
        .collect()
}

#[track_caller]
fn same(ours: &[f64], theirs: &[f64], tolerance: f64) {
    assert_eq!(ours.len(), theirs.len());
    let size = theirs.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let worst = ours.iter().zip(theirs).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(worst <= tolerance * size, "differ by {:.2e} of the largest, tolerance {tolerance:.1e}", worst / size);
}

/// A rounded denominator moves the poles by ε and the response by ε/|1 − z|², |1 − z| ≈ 2π·30/1000: 30 ε, two
/// passes of up to three sections of five operations.
const RECURSIVE: f64 = 30.0 * 30.0 * f64::EPSILON;

#[test]
fn zero_phase_filters_of_orders_one_to_five() {
    let g = golden();
    for (order, corner_hz) in [(1, 100.0), (2, 30.0), (4, 100.0), (5, 60.0)] {
        let f = butterworth::low_pass(order, corner_hz, 1000.0).unwrap();
        let name = format!("sosfiltfilt_{order}");
        same(&zero_phase::filter(&f, &g["record"]).unwrap(), &g[name.as_str()], RECURSIVE);
    }
}

/// The bar of every filter: this part of the largest number, ends included. At 5 Hz the responses of rounded poles are off by
/// ε/|1 − z|² ≈ 1000 ε, and three passes of arithmetic leave some 1e-12 of headroom.
const OF_LARGEST: f64 = 1e-12;

#[test]
fn ends_low_corners_and_high_orders() {
    let g = golden();
    for (name, order, corner_hz, record) in
        [("short", 8, 200.0, "short"), ("low", 4, 5.0, "record"), ("high", 8, 60.0, "record")]
    {
        let f = butterworth::low_pass(order, corner_hz, 1000.0).unwrap();
        let name = format!("sosfiltfilt_{name}");
        same(&zero_phase::filter(&f, &g[record]).unwrap(), &g[name.as_str()], OF_LARGEST);
    }
}

/// One polynomial of order four: its roots move by ε/Π|p − p'| ≈ 100 ε, a hundred times as far as the sections'.
#[test]
fn sections_agree_with_the_polynomial_form_to_what_that_form_can_hold() {
    let g = golden();
    let f = butterworth::low_pass(4, 100.0, 1000.0).unwrap();
    same(&zero_phase::filter(&f, &g["record"]).unwrap(), &g["filtfilt_4"], 100.0 * RECURSIVE);
}

/// The tridiagonal system has a condition below 6; values below 2.
#[test]
fn values_between_samples_also_at_uneven_times_and_on_another_clock() {
    let g = golden();
    let times: Vec<f64> = (0..700).map(|i| f64::from(i) / 1000.0).collect();
    let read = |time: &[f64], at: &[f64]| -> Vec<f64> {
        let spline = Spline::through(time, &g["record"]).unwrap();
        at.iter().map(|t| spline.at(*t).unwrap()).collect()
    };
    same(&read(&times, &g["late"]), &g["cubic_spline"], 1e-12);
    same(&read(&g["uneven"], &times[3..697]), &g["cubic_spline_uneven"], 1e-12);
}

/// scipy's search stops where its steps are below 1e-15 of the parameters; the curvature leaves the square root of rounding times ten.
#[test]
fn harmonics_and_their_frequency() {
    let g = golden();
    let times: Vec<f64> = (0..700).map(|i| f64::from(i) / 1000.0).collect();
    let fit = Harmonics::fit(&times, &g["record"], 2, None).unwrap();
    let [[c1, s1], [c2, s2]] = [fit.terms[0], fit.terms[1]];
    let ours = [fit.omega_rad_s / std::f64::consts::TAU, fit.mean, c1, s1, c2, s2];
    same(&ours, &g["harmonics_2"], 1e-7);
}

/// Normal equations of harmonics over two periods and a tenth: a condition below 10.
#[test]
fn harmonics_of_a_frequency_that_is_known() {
    let g = golden();
    let times: Vec<f64> = (0..700).map(|i| f64::from(i) / 1000.0).collect();
    let fit = Harmonics::held(&times, &g["record"], 3, 3.0 * std::f64::consts::TAU).unwrap();
    let ours: Vec<f64> = std::iter::once(fit.mean).chain(fit.terms.concat()).collect();
    same(&ours, &g["held"], 1e-12);
    same(&fit.covariance.concat(), &g["held_covariance"], 1e-12);
}

/// Leads are differences of phases of some radians over 10.7 rad/s, each good to 1e-13; the line through seven of them keeps that.
#[test]
fn offset_skew_and_gain_of_a_channel_against_another() {
    let g = golden();
    let times: Vec<f64> = (0..1200).map(|i| f64::from(i) / 200.0).collect();
    let omega = 1.7 * std::f64::consts::TAU;
    let found = clock::align(&times, &g["skew_first"], &g["skew_second"], omega, 4).unwrap();
    let ours = [found.origin_s, found.offset_s, found.skew, found.gain];
    for (ours, theirs) in ours.iter().zip(&g["skew_found"]) {
        assert!((ours - theirs).abs() < 1e-12, "{ours} {theirs}");
    }
}

#[test]
fn central_differences() {
    let g = golden();
    same(&differences::central(&g["record"], 1e-3).unwrap(), &g["gradient"], 4.0 * f64::EPSILON);
}

/// Sums of 201 products; taps are sines of up to 10π.
#[test]
fn decimation_with_its_ends() {
    let g = golden();
    for q in [7, 10] {
        let name = format!("decimate_{q}");
        same(&decimate::decimate(&g["record"], q).unwrap(), &g[name.as_str()], 201.0 * f64::EPSILON);
    }
}

/// A transform of 128 points, squares, ten segments.
#[test]
fn spectra() {
    let g = golden();
    for (record, theirs) in [("record", "welch_x"), ("output", "welch_y")] {
        let (_, ours) = spectrum::density(&g[record], 1000.0, 128).unwrap();
        same(&ours, &g[theirs], 128.0 * f64::EPSILON);
    }
}
