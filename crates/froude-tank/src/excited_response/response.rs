//! One signal per motion of the wavemaker: the transfer H = S/R at the wave's frequency, over whole cycles of a window.
//!
//! S is fitted by harmonics of the wavemaker's frequency. Its scatter is the power of what the fit leaves at the four frequencies beside the wave's own, ω(1 ± 1/N) and
//! ω(1 ± 2/N) of a window of N cycles: where noise is correlated, or the amplitude still changes, its power near ω counts and no other, and over whole cycles these lines
//! are orthogonal to the fit. Each has two degrees of freedom; both components of H have the same variance, and are independent.
//!
//! **Source.** Priestley (1981), *Spectral Analysis and Time Series*, 6.1 (independent lines of a periodogram); the choice of lines is ours.

use std::ops::Range;

use faer::c64;
use froude_signal::harmonic::Harmonics;

use super::setup::{WaveRun, not_fitted};
use super::wave::{Wave, turn};
use crate::error::TankError;

/// Fewest whole cycles of a window.
pub const FEWEST_CYCLES: usize = 5;
/// Lines beside the wave's frequency, in cycles of the window.
const BESIDE: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];
/// Degrees of freedom of the scatter: two of each line.
pub const DOF: f64 = 2.0 * BESIDE.len() as f64;
/// A part of a sample by which a window may miss a whole cycle.
const ROUNDING: f64 = 1e-9;

/// A signal against the wavemaker.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// H: signal per motion of the wavemaker.
    pub transfer: c64,
    /// Amplitude of the signal at the wave's frequency.
    pub amplitude: f64,
    /// Variance of each component of H.
    pub variance: f64,
    /// H of the first and of the last half of the cycles.
    pub halves: [c64; 2],
    /// Whole cycles.
    pub cycles: usize,
    /// Samples used.
    pub rows: Range<usize>,
    /// The fit there.
    pub fitted: Vec<f64>,
}

/// Fits the signal of a run over a window, s after the wavemaker's start.
///
/// # Errors
///
/// A window outside of the log or of too few cycles, a fit that fails, nothing at the frequency of the wave.
pub fn response(
    run: &WaveRun<'_>,
    wave: &Wave,
    [from_s, to_s]: [f64; 2],
    harmonics: usize,
) -> Result<Response, TankError> {
    let last_s = run.time_s.last().copied().unwrap_or(0.0) - wave.start_s;
    let period_s = wave.period_s();
    let cycles = cycles_within(run.id, [from_s, to_s], [wave.start_s, last_s], period_s, ROUNDING)?;
    let begin_s = wave.start_s + from_s;
    let rows_of = |from: f64, to: f64| {
        let at = |cycles: f64| run.time_s.partition_point(|t| *t < begin_s + cycles * period_s);
        at(from)..at(to)
    };
    let fit_of = |rows: Range<usize>, signal: &[f64], order: usize, omega: f64| {
        Harmonics::held(&run.time_s[rows], signal, order, omega).map_err(|e| not_fitted(run, run.shows.name(), &e))
    };
    let n = cycles as f64;
    let rows = rows_of(0.0, n);
    let fit = fit_of(rows.clone(), &run.signal[rows.clone()], harmonics, wave.omega_rad_s)?;
    let amplitude = fit.amplitude(1);
    if amplitude <= 0.0 {
        let what = format!("the {} has no part at the wave's frequency; check which column it is", run.shows.name());
        return Err(TankError::of_run(run.id, what));
    }
    let fitted: Vec<f64> = run.time_s[rows.clone()].iter().map(|t| fit.at(*t)[0]).collect();
    let left: Vec<f64> = run.signal[rows.clone()].iter().zip(&fitted).map(|(x, f)| x - f).collect();
    let mut power = 0.0;
    for beside in BESIDE {
        let line = fit_of(rows.clone(), &left, 1, wave.omega_rad_s * (1.0 + beside / n))?;
        power += 0.5 * line.amplitude(1).powi(2) / BESIDE.len() as f64;
    }
    let half = (cycles / 2) as f64;
    let half_of = |from: f64, to: f64| {
        let rows = rows_of(from, to);
        fit_of(rows.clone(), &run.signal[rows], harmonics, wave.omega_rad_s).map(|fit| transfer(&fit, wave))
    };
    let transfer = transfer(&fit, wave);
    let relative = power / (amplitude * amplitude) + wave.relative_variance(fit.origin_s);
    Ok(Response {
        transfer,
        amplitude,
        variance: relative * transfer.norm_sqr(),
        halves: [half_of(0.0, half)?, half_of(n - half, n)?],
        cycles,
        rows,
        fitted,
    })
}

/// The whole cycles of a window, in turns counted to within `rounding`; `start_s` and `last_s` are the wavemaker's start, and the log's end after it.
pub(super) fn cycles_within(
    run: &str,
    [from_s, to_s]: [f64; 2],
    [start_s, last_s]: [f64; 2],
    period_s: f64,
    rounding: f64,
) -> Result<usize, TankError> {
    if to_s > last_s {
        let what = format!(
            "the window from {from_s} s to {to_s} s after the wavemaker's start (at {start_s:.2} s of the log) does not lie within the log, which ends {last_s:.2} s after that start; record \
             longer, or correct window in [source.excited_response]"
        );
        return Err(TankError::of_run(run, what));
    }
    let cycles = ((to_s - from_s) / period_s + rounding).floor() as usize;
    if cycles < FEWEST_CYCLES {
        let what = format!(
            "the window of {:.2} s holds {cycles} whole cycles of {period_s:.3} s, and {FEWEST_CYCLES} are needed: widen it as far as the reflections allow, or use a longer tank",
            to_s - from_s
        );
        return Err(TankError::of_run(run, what));
    }
    Ok(cycles)
}

/// S/R.
fn transfer(fit: &Harmonics, wave: &Wave) -> c64 {
    let [c, s] = fit.terms[0];
    c64::new(c, -s) * turn(-wave.omega_rad_s * fit.origin_s) / wave.phasor()
}
