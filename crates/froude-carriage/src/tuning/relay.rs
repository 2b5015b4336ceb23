//! Ultimate gain and period from the limit cycle that a relay makes.
//!
//! A relay of height d with hysteresis ε has the describing function N(a) with −1/N(a) = −(π/4d)(√(a² − ε²) + iε)
//! (Åström & Hägglund 2006, §8.2): the limit cycle shows one point of the drive's response. Without hysteresis it is the
//! ultimate point, K_u = 4d/(πa); with it K_u = 4d/(π√(a² − ε²)) and the point lies asin(ε/a) short of −180°, which is reported.

use super::TuningError;

/// A measured limit cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitCycle {
    /// Whole cycles used; the first third of the record is left out.
    pub cycles: usize,
    /// Mean period, s.
    pub period_s: f64,
    /// Standard deviation of one period, s.
    pub period_std_s: f64,
    /// Mean amplitude of the angle, rad.
    pub amplitude_rad: f64,
    /// Standard deviation of one amplitude, rad.
    pub amplitude_std_rad: f64,
    /// K_u, V/rad.
    pub ultimate_gain_v_rad: f64,
    /// Phase of the point found, rad; −π without hysteresis.
    pub phase_rad: f64,
}

/// The limit cycle in a record of a relay experiment.
///
/// `hysteresis_rad` is the relay's half width over the motor angle.
///
/// # Errors
///
/// [`TuningError`] for unequal columns, fewer than four whole cycles, or an amplitude within the hysteresis.
pub fn limit_cycle(
    rate_hz: f64,
    relay_v: f64,
    hysteresis_rad: f64,
    command_v: &[f64],
    angle_rad: &[f64],
) -> Result<LimitCycle, TuningError> {
    TuningError::unless_paired(command_v, angle_rad)?;
    for (name, value) in [("sampling rate", rate_hz), ("relay height", relay_v)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(TuningError::number(name, value));
        }
    }
    let first = command_v.len() / 3;
    let rises: Vec<usize> =
        (first.max(1)..command_v.len()).filter(|&i| command_v[i] > 0.0 && command_v[i - 1] <= 0.0).collect();
    if rises.len() < 5 {
        let what = "switches of the relay in the later two thirds of the record";
        return Err(TuningError::too_few(
            what,
            rises.len(),
            5,
            "run the relay longer, or raise its height above friction",
        ));
    }
    let periods: Vec<f64> = rises.windows(2).map(|w| (w[1] - w[0]) as f64 / rate_hz).collect();
    let amplitudes: Vec<f64> = rises
        .windows(2)
        .map(|w| {
            let cycle = &angle_rad[w[0]..w[1]];
            let high = cycle.iter().fold(f64::NEG_INFINITY, |m, &x| m.max(x));
            let low = cycle.iter().fold(f64::INFINITY, |m, &x| m.min(x));
            0.5 * (high - low)
        })
        .collect();
    let (period_s, period_std_s) = mean_and_std(&periods);
    let (amplitude_rad, amplitude_std_rad) = mean_and_std(&amplitudes);
    let beyond = amplitude_rad * amplitude_rad - hysteresis_rad * hysteresis_rad;
    if beyond.is_nan() || beyond <= 0.0 {
        return Err(TuningError::number("amplitude beyond the relay's hysteresis, rad²", beyond));
    }
    Ok(LimitCycle {
        cycles: periods.len(),
        period_s,
        period_std_s,
        amplitude_rad,
        amplitude_std_rad,
        ultimate_gain_v_rad: 4.0 * relay_v / (std::f64::consts::PI * beyond.sqrt()),
        phase_rad: (hysteresis_rad / amplitude_rad).asin() - std::f64::consts::PI,
    })
}

fn mean_and_std(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (square / (n - 1.0)).sqrt())
}
