//! The part of the runs to be used where nobody has declared one: force and motion have come up to their size, and the wavemaker still runs.
//!
//! It says nothing of reflections, so that it is good for A33 and not for B33.

use froude_signal::harmonic::Harmonics;

use super::response::FEWEST_CYCLES;
use super::setup::{WaveRun, not_fitted};
use super::wave::Wave;
use crate::error::TankError;

/// Cycles of one fit.
const CYCLES: f64 = 4.0;
/// Signals have come up where they reach this part of their largest.
const UP: f64 = 0.9;

/// From and to, s after the wavemaker's start, for all runs of one wave.
///
/// # Errors
///
/// No window of enough cycles, a fit that fails.
pub fn window(runs: &[(&WaveRun<'_>, &Wave)], harmonics: usize) -> Result<[f64; 2], TankError> {
    let (mut from_s, mut to_s, mut period_s) = (0.0_f64, f64::INFINITY, 0.0_f64);
    for (run, wave) in runs {
        from_s = from_s.max(up(run, wave, harmonics, UP)?);
        to_s = to_s.min(wave.runs_s);
        period_s = period_s.max(wave.period_s());
    }
    if to_s - from_s < FEWEST_CYCLES as f64 * period_s {
        return Err(TankError::new(format!(
            "waves of {period_s:.3} s: no window is declared, and none is found: force and motion come to nine tenths of their largest {from_s:.1} s after the wavemaker's start, which stops after {to_s:.1} s; \
             declare window = {{ from = \"…\", to = \"…\" }} in [source.excited_response], before reflections"
        )));
    }
    Ok([from_s, to_s])
}

/// When the signal of a run has come to a part of its largest, s after the wavemaker's start; while that runs.
///
/// # Errors
///
/// A fit that fails.
pub fn up(run: &WaveRun<'_>, wave: &Wave, harmonics: usize, part: f64) -> Result<f64, TankError> {
    let period_s = wave.period_s();
    let fits = (wave.runs_s / period_s - CYCLES).floor().max(0.0) as usize;
    let amplitude = |k: usize| {
        let at = |cycles: f64| run.time_s.partition_point(|t| *t < wave.start_s + (k as f64 + cycles) * period_s);
        let rows = at(0.0)..at(CYCLES);
        Harmonics::held(&run.time_s[rows.clone()], &run.signal[rows], harmonics, wave.omega_rad_s)
            .map(|fit| fit.amplitude(1))
            .map_err(|why| not_fitted(run, run.shows.name(), &why))
    };
    let amplitudes = (0..fits).map(amplitude).collect::<Result<Vec<_>, _>>()?;
    let largest = amplitudes.iter().copied().fold(0.0, f64::max);
    let first = amplitudes.iter().position(|a| *a >= part * largest).unwrap_or(0);
    Ok(first as f64 * period_s)
}
