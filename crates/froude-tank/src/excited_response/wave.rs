//! The wavemaker of a run: when it starts and stops, and its frequency, amplitude and phase while its stroke is even.
//!
//! It runs from the first to the last sample that is further from its rest than a stated part of its largest. Two cycles after the start and one before the stop are left
//! out; over what remains frequency, amplitude and phase are fitted together, so that the phase can be carried on to a window after the wavemaker has stopped: the wave
//! that is at the body then left it before.
//!
//! **Source.** IEEE Std 1057-2017, 4.7.3 (four-parameter sine fit).

use faer::c64;
use froude_signal::harmonic::Harmonics;

use super::setup::{WaveRun, not_fitted};
use crate::error::TankError;

/// It runs where it is further from its rest than this part of its largest.
const RUNS: f64 = 0.3;
/// Cycles left out after the start and before the stop.
pub const LEFT_OUT: [f64; 2] = [2.0, 1.0];
/// Fewest cycles of even stroke.
pub const FEWEST_CYCLES: usize = 5;
/// Declared and found period may differ by this part.
pub const ALIKE: f64 = 0.01;

/// A wavemaker's motion, Re R e^{iωt} with t the time of the log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Its start on the log, s.
    pub start_s: f64,
    /// How long it runs, s.
    pub runs_s: f64,
    /// ω, rad/s.
    pub omega_rad_s: f64,
    /// |R|.
    pub amplitude: f64,
    /// What one harmonic leaves, over |R|.
    pub residual: f64,
    phasor: c64,
    /// Where phase and frequency are least correlated, s.
    origin_s: f64,
    /// Standard uncertainty of |R| over |R|, of the phase (rad) there, and of ω (rad/s).
    standard: [f64; 3],
}

impl Wave {
    /// The wavemaker of a run.
    ///
    /// # Errors
    ///
    /// Too few cycles of an even stroke, a fit that fails, another period than the declared one.
    pub fn of(run: &WaveRun<'_>) -> Result<Self, TankError> {
        let channel = |why| not_fitted(run, "reference (wavemaker)", &why);
        let mut sorted = run.reference.to_vec();
        sorted.sort_by(f64::total_cmp);
        let rest = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        let away = |x: &f64| (x - rest).abs();
        let largest = run.reference.iter().map(away).fold(0.0, f64::max);
        let is_on = |x: &f64| away(x) > RUNS * largest;
        let no_wave = |cycles: f64| {
            let what = format!(
                "the wavemaker runs for {:.1} cycles with an even stroke (start-up of {} left out), and {FEWEST_CYCLES} are needed: check which column is the reference, or record longer",
                cycles.max(0.0),
                LEFT_OUT[0]
            );
            TankError::of_run(run.id, what)
        };
        let (Some(first), Some(last)) = (run.reference.iter().position(is_on), run.reference.iter().rposition(is_on))
        else {
            return Err(no_wave(0.0));
        };
        let (start_s, stop_s) = (run.time_s[first], run.time_s[last]);
        let fitted = |from: usize, to: usize| {
            Harmonics::fit(&run.time_s[from..=to], &run.reference[from..=to], 1, None).map_err(channel)
        };
        let period_s = fitted(first, last)?.period_s();
        if let Some(declared_s) = run.period_s.filter(|declared| (period_s / declared - 1.0).abs() > ALIKE) {
            let what = format!(
                "its wavemaker has a period of {period_s:.4} s, and [conditions] period says {declared_s} s; check the sidecar, or which log it belongs to"
            );
            return Err(TankError::of_run(run.id, what));
        }
        let from = run.time_s.partition_point(|t| *t < start_s + LEFT_OUT[0] * period_s);
        let to = run.time_s.partition_point(|t| *t < stop_s - LEFT_OUT[1] * period_s);
        let cycles = (stop_s - start_s) / period_s - LEFT_OUT[0] - LEFT_OUT[1];
        if cycles < FEWEST_CYCLES as f64 || to <= from {
            return Err(no_wave(cycles));
        }
        let fit = fitted(from, to - 1)?;
        let [c, s] = fit.terms[0];
        let amplitude = fit.amplitude(1);
        let [of_amplitude, of_phase] = fit.standard_of(1);
        Ok(Self {
            start_s,
            runs_s: stop_s - start_s,
            omega_rad_s: fit.omega_rad_s,
            amplitude,
            residual: fit.residual_std / amplitude,
            phasor: c64::new(c, -s) * turn(-fit.omega_rad_s * fit.origin_s),
            origin_s: fit.origin_s,
            standard: [of_amplitude / amplitude, of_phase, fit.standard_of_frequency_rad_s()],
        })
    }

    /// R.
    #[must_use]
    pub fn phasor(&self) -> c64 {
        self.phasor
    }

    /// Period, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        std::f64::consts::TAU / self.omega_rad_s
    }

    /// Variance of R at a time over |R|², mean of its two components.
    #[must_use]
    pub fn relative_variance(&self, time_s: f64) -> f64 {
        let [amplitude, phase, omega] = self.standard;
        0.5 * (amplitude * amplitude + phase * phase + (omega * (time_s - self.origin_s)).powi(2))
    }
}

/// e^{iφ}.
#[must_use]
pub fn turn(phase_rad: f64) -> c64 {
    let (sin, cos) = phase_rad.sin_cos();
    c64::new(cos, sin)
}
