//! Frequency response of the drive, measured while the loop is closed.
//!
//! A sine `d` of exponentially rising frequency is added to the drive command while the carriage moves at constant speed, so
//! that friction keeps its sign. Over the whole record, which begins and ends at rest beside the constant speed, the spectra of
//! the injected sine, the command and the speed are taken, and θ/v_c = Σ Y D* / Σ U D* over neighbouring frequencies (joint
//! input–output): the direct ratio would be biased, since in the closed loop noise of the angle comes back in the command.
//!
//! No window tapers the record: the sweep itself begins and ends at rest, and a window would cut a lightly damped mode's
//! ringing off its excitation (windows about the moment of passing moved a mode of 3 % damping by 4 % of its frequency).
//!
//! The standard uncertainty of a point is that of an instrumental variable (Söderström & Stoica 1983, *Instrumental Variable Methods for System
//! Identification*): σ_N² Σ|D|²/|Σ U D*|², σ_N² from the residuals Y − P̂ U of the neighbours, with twice their number less two degrees of
//! freedom.
//!
//! **Range.** Frequencies at least ten resolutions (1/T) above zero and below a quarter of the sampling rate.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::{ResponsePoint, TuningError};

/// The sweep and what was recorded of it; the columns begin with the sweep, have one row per tick, and go on until the carriage
/// has come to rest beside its constant speed.
#[derive(Debug, Clone, Copy)]
pub struct Sweep<'a> {
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// First frequency, Hz.
    pub from_hz: f64,
    /// Last frequency, Hz.
    pub to_hz: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Amplitude, V.
    pub volts: f64,
    /// Drive command, the injected sine included, V.
    pub command_v: &'a [f64],
    /// Motor angle, rad.
    pub angle_rad: &'a [f64],
}

/// Neighbouring frequencies that are averaged, one resolution apart.
const NEIGHBOURS: usize = 7;

/// Degrees of freedom of the standard uncertainty of a point: real and imaginary parts of the neighbours, less those of the estimate.
pub const POINT_DOF: f64 = 2.0 * (NEIGHBOURS - 1) as f64;

impl Sweep<'_> {
    /// The injected sine at `t_s` after the start, V (nothing after its end): phase 2π f₀ T/ln r · (rᵗ/ᵀ − 1), r = f₁/f₀ (Farina 2000).
    #[must_use]
    pub fn injected_v(&self, t_s: f64) -> f64 {
        if t_s >= self.duration_s {
            return 0.0;
        }
        let ratio = (self.to_hz / self.from_hz).ln();
        let turns = self.from_hz * self.duration_s / ratio * ((ratio * t_s / self.duration_s).exp() - 1.0);
        self.volts * (TAU * turns).sin()
    }

    fn check(&self) -> Result<(), TuningError> {
        for (name, value) in [
            ("sampling rate", self.rate_hz),
            ("first frequency", self.from_hz),
            ("last frequency less the first", self.to_hz - self.from_hz),
            ("duration", self.duration_s),
            ("amplitude", self.volts),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(TuningError::number(name, value));
            }
        }
        TuningError::unless_paired(self.command_v, self.angle_rad)
    }
}

/// θ/v_c at `n` frequencies, evenly spaced in the logarithm from the first to the last of the sweep, its outer twentieths left out.
///
/// # Errors
///
/// [`TuningError`] for unequal columns, for numbers that are no sweep, and when fewer than ten frequencies are in range.
pub fn plant_response(sweep: &Sweep, n: usize) -> Result<Vec<ResponsePoint>, TuningError> {
    sweep.check()?;
    let speed = increments(sweep.angle_rad);
    let mean_v = sweep.command_v.iter().sum::<f64>() / sweep.command_v.len().max(1) as f64;
    let command: Vec<f64> = sweep.command_v.iter().map(|u| u - mean_v).collect();
    let injected: Vec<f64> = (0..command.len()).map(|i| sweep.injected_v(i as f64 / sweep.rate_hz)).collect();
    let resolution = 1.0 / command.len() as f64;
    let ratio = (sweep.to_hz / sweep.from_hz).ln();
    let points: Vec<ResponsePoint> = (0..n)
        .map(|i| sweep.from_hz * (ratio * (0.05 + 0.9 * i as f64 / (n.max(2) - 1) as f64)).exp())
        .filter(|f| (10.0 * resolution..0.25).contains(&(f / sweep.rate_hz)))
        .filter_map(|f| at(&speed, &command, &injected, f, sweep.rate_hz, resolution))
        .collect();
    if points.len() < 10 {
        let what = "frequencies that the record resolves";
        return Err(TuningError::too_few(what, points.len(), 10, "sweep longer or over fewer octaves"));
    }
    Ok(points)
}

/// Increments per sample less their mean: the motion beside the constant speed.
fn increments(angle_rad: &[f64]) -> Vec<f64> {
    let n = angle_rad.len();
    let mean = if n > 1 { (angle_rad[n - 1] - angle_rad[0]) / (n - 1) as f64 } else { 0.0 };
    let mut out = vec![0.0; n];
    for i in 1..n {
        out[i] = angle_rad[i] - angle_rad[i - 1] - mean;
    }
    out
}

fn at(
    speed: &[f64],
    command: &[f64],
    injected: &[f64],
    frequency_hz: f64,
    rate_hz: f64,
    resolution: f64,
) -> Option<ResponsePoint> {
    let (mut yd, mut ud, mut yy, mut dd) = (Complex64::ZERO, Complex64::ZERO, 0.0, 0.0);
    let mut lines = [(Complex64::ZERO, Complex64::ZERO); NEIGHBOURS];
    for (k, kept) in lines.iter_mut().enumerate() {
        let turns = frequency_hz / rate_hz + (k as f64 - (NEIGHBOURS / 2) as f64) * resolution;
        let d = line(injected, turns);
        // The sum of increments is the angle: Y = V/(1 − e^(−iωT)).
        let y = line(speed, turns) / (1.0 - Complex64::cis(-TAU * turns));
        let u = line(command, turns);
        *kept = (y, u);
        yd += y * d.conj();
        ud += u * d.conj();
        yy += y.norm_sqr();
        dd += d.norm_sqr();
    }
    if ud == Complex64::ZERO || yd == Complex64::ZERO || yy == 0.0 {
        return None;
    }
    let coherence = (yd.norm_sqr() / (yy * dd)).min(1.0);
    let plant = yd / ud;
    // The estimate is one by an instrument, d: of the plant's own noise N = Y − P U its error is Σ N D*/Σ U D*, half of whose power each is
    // in the modulus and in the phase. The coherence of d and y would not do: in a closed loop Y holds N/(1 + L), not N.
    let noise: f64 = lines.iter().map(|(y, u)| (y - plant * u).norm_sqr()).sum::<f64>() / (NEIGHBOURS - 1) as f64;
    let relative_std = (0.5 * noise * dd).sqrt() / yd.norm();
    Some(ResponsePoint { frequency_hz, plant_rad_v: plant, coherence, relative_std })
}

/// One spectral line; `turns` is the frequency in cycles per sample.
fn line(values: &[f64], turns: f64) -> Complex64 {
    let step = Complex64::cis(-TAU * turns);
    let mut turn = Complex64::ONE;
    let mut sum = Complex64::ZERO;
    for (i, v) in values.iter().enumerate() {
        sum += turn * *v;
        // The running product is set anew now and then, so that its rounding does not grow.
        turn = if i % 1024 == 1023 { Complex64::cis(-TAU * turns * (i + 1) as f64) } else { turn * step };
    }
    sum
}
