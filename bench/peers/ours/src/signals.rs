//! Filters of a record of 10⁷ samples.

use std::path::Path;

use froude_signal::harmonic::Harmonics;
use froude_signal::resample::Spline;
use froude_signal::{butterworth, zero_phase};

use crate::meter::{Row, measure};
use crate::{Outcome, make};

/// Every so many samples of a result are compared, and its ends.
const SHOWN: usize = 1009;

pub fn filter(dir: &Path) -> Outcome<Row> {
    let record = make::read(&dir.join(make::RAW[0]))?;
    let low_pass = butterworth::low_pass(4, 10.0, 1000.0)?;
    measure(5, || {
        let out = zero_phase::filter(&low_pass, &record)?;
        let ends = out.iter().take(50).chain(out.iter().rev().take(50));
        Ok(ends.chain(out.iter().step_by(SHOWN)).copied().collect())
    })
}

/// Samples of the cases below, at 1 kHz.
const SHORTER: usize = 1_000_000;
const RATE_HZ: f64 = 1000.0;

fn shorter(dir: &Path) -> Outcome<(Vec<f64>, Vec<f64>)> {
    let mut record = make::read(&dir.join(make::RAW[0]))?;
    record.truncate(SHORTER);
    let time_s = (0..record.len()).map(|i| i as f64 / RATE_HZ).collect();
    Ok((time_s, record))
}

/// Mean and three harmonics of a known frequency.
pub fn harmonics(dir: &Path) -> Outcome<Row> {
    let (time_s, record) = shorter(dir)?;
    measure(5, || {
        let fit = Harmonics::held(&time_s, &record, 3, std::f64::consts::TAU * 0.2)?;
        Ok(std::iter::once(fit.mean).chain(fit.terms.concat()).collect())
    })
}

/// The record at the times of a clock that runs fast by 7 ms/s and is late by a third of a sample.
pub fn resample(dir: &Path) -> Outcome<Row> {
    let (time_s, record) = shorter(dir)?;
    let at: Vec<f64> = (0..record.len() * 99 / 100).map(|i| (i as f64 / RATE_HZ) * 1.007 + 0.3e-3).filter(|t| *t < time_s[time_s.len() - 1]).collect();
    measure(5, || {
        let spline = Spline::through(&time_s, &record)?;
        let out: Vec<f64> = at.iter().map(|t| spline.at(*t)).collect::<Option<_>>().ok_or("a time outside the record")?;
        let ends = out.iter().take(50).chain(out.iter().rev().take(50));
        Ok(ends.chain(out.iter().step_by(SHOWN)).copied().collect())
    })
}
