//! Filters between sensor and log: what they do to a signal of a frequency, and how much noise they let through.
//!
//! | filter, one pass | gain at x = f/f_c | delay at rest | noise bandwidth |
//! |---|---|---|---|
//! | Butterworth of order n | 1/√(1 + x²ⁿ) | 1/(2π f_c sin(π/2n)) | f_c (π/2n)/sin(π/2n) |
//! | mean over a time L | \|sin(πfL)/(πfL)\| | L/2 | 1/(2L) |
//!
//! The noise bandwidth is that of an ideal low-pass that lets as much white noise through: ∫₀^∞ |H|² df.
//!
//! **Units.** Frequencies in Hz, delays in s; a delay is that of the phase, −arg H/(2πf).
//! **Range.** Analogue filters, and digital ones far below half their rate: at a tenth of it the delays of the two differ by 3 %.
//!
//! # Source
//!
//! Oppenheim & Schafer (2010), *Discrete-Time Signal Processing*, 3rd ed., app. B (poles of the Butterworth filter); Harris (1978), Proc. IEEE 66, 51 (noise bandwidth). The
//! bandwidth of two passes is f_c (π/2n)/sin(π/2n) (1 − 1/2n), by ∫ (1 + x²ⁿ)⁻² dx in parts.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A low-pass filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Analogue {
    /// Butterworth.
    Butterworth {
        /// Its order, 1 or more.
        order: usize,
        /// Frequency at which one pass halves the power, Hz.
        corner_hz: f64,
    },
    /// The mean over a time.
    MovingAverage {
        /// That time, s.
        length_s: f64,
    },
}

impl Analogue {
    /// |H| of one pass \[-\].
    #[must_use]
    pub fn gain(self, frequency_hz: f64) -> f64 {
        match self {
            Self::Butterworth { order, corner_hz } => {
                (1.0 + (frequency_hz / corner_hz).powi(2 * order as i32)).sqrt().recip()
            }
            Self::MovingAverage { length_s } => {
                let x = PI * frequency_hz * length_s;
                if x == 0.0 { 1.0 } else { (x.sin() / x).abs() }
            }
        }
    }

    /// By how much one pass delays a signal of a frequency, s.
    #[must_use]
    pub fn delay_s(self, frequency_hz: f64) -> f64 {
        match self {
            Self::Butterworth { order, corner_hz } => {
                let n = order as f64;
                let x = frequency_hz / corner_hz;
                if x.abs() < 1e-6 {
                    // The phase is a line there, to parts in 1e12.
                    return 1.0 / (TAU * corner_hz * (FRAC_PI_2 / n).sin());
                }
                // Of a pole at angle θ behind the imaginary axis the phase is atan((x − cos θ)/sin θ); those at rest cancel.
                let of_pole = |k: usize| {
                    let (sin, cos) = (FRAC_PI_2 * (2 * k + 1) as f64 / n).sin_cos();
                    ((x - cos) / sin).atan()
                };
                (0..order).map(of_pole).sum::<f64>() / (TAU * frequency_hz)
            }
            Self::MovingAverage { length_s } => 0.5 * length_s,
        }
    }

    /// Noise bandwidth of one pass, or of one forward and one backward, Hz.
    #[must_use]
    pub fn noise_bandwidth_hz(self, passes: usize) -> f64 {
        match self {
            Self::Butterworth { order, corner_hz } => {
                let step = FRAC_PI_2 / order as f64;
                let one = corner_hz * step / step.sin();
                if passes < 2 { one } else { one * (1.0 - 0.5 / order as f64) }
            }
            // ∫ sinc⁴ is two thirds of ∫ sinc².
            Self::MovingAverage { length_s } => {
                if passes < 2 {
                    0.5 / length_s
                } else {
                    1.0 / (3.0 * length_s)
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::butterworth::low_pass;

    /// A digital filter 500 times below its rate: the bilinear transform warps by (π/500)²/12 of the frequency, 3e-6.
    #[test]
    fn gain_and_delay_are_those_of_a_digital_filter_far_below_its_rate() {
        for order in 1..=8 {
            let (corner, rate) = (20.0, 10_000.0);
            let digital = low_pass(order, corner, rate).unwrap();
            let analogue = Analogue::Butterworth { order, corner_hz: corner };
            for f in [0.5, 2.0, 10.0, 20.0, 30.0] {
                let (s, c) = (TAU * f / rate).sin_cos();
                // Phase of b₀ + b₁ z⁻¹ + b₂ z⁻² over 1 + a₁ z⁻¹ + a₂ z⁻², z⁻¹ = c − j s.
                let (s2, c2) = (2.0 * s * c, 2.0 * c * c - 1.0);
                let phase: f64 = digital
                    .sections
                    .iter()
                    .map(|q| {
                        let above = (-q.b[1] * s - q.b[2] * s2).atan2(q.b[0] + q.b[1] * c + q.b[2] * c2);
                        let below = (-q.a[0] * s - q.a[1] * s2).atan2(1.0 + q.a[0] * c + q.a[1] * c2);
                        above - below
                    })
                    .sum();
                let delay_s = -phase / (TAU * f);
                assert!((analogue.gain(f) - digital.gain(f)).abs() < 1e-4, "{order} {f}");
                assert!(
                    (analogue.delay_s(f) / delay_s - 1.0).abs() < 1e-4,
                    "{order} {f}: {} {delay_s}",
                    analogue.delay_s(f)
                );
            }
            let (near, rest) = (analogue.delay_s(1e-3), analogue.delay_s(0.0));
            assert!((near / rest - 1.0).abs() < 1e-6, "{order}: {near} {rest}");
        }
    }

    /// ∫ |H|² by the trapezoidal rule to 200 corners; what is left out is below x^(1−2n)/(2n−1), 5e-3 of order 1 and 3e-8 of order 2.
    #[test]
    fn noise_bandwidths_are_the_integrals_of_the_squared_gain() {
        let integral = |filter: Analogue, passes: i32, to: f64| {
            let n = 400_000;
            let h = to / f64::from(n);
            (0..=n)
                .map(|i| filter.gain(h * f64::from(i)).powi(2 * passes) * if i == 0 || i == n { 0.5 * h } else { h })
                .sum::<f64>()
        };
        for order in 2..=6 {
            let filter = Analogue::Butterworth { order, corner_hz: 3.0 };
            for passes in [1, 2] {
                let found = integral(filter, passes, 600.0);
                let bandwidth = filter.noise_bandwidth_hz(passes as usize);
                assert!((found / bandwidth - 1.0).abs() < 1e-6, "{order} {passes}: {found} {bandwidth}");
            }
        }
        // The tail of sinc² beyond 400 lobes is 1/(π² 400) of a half: 5e-4.
        let filter = Analogue::MovingAverage { length_s: 0.5 };
        assert!((integral(filter, 1, 800.0) / filter.noise_bandwidth_hz(1) - 1.0).abs() < 1e-3);
        assert!((integral(filter, 2, 800.0) / filter.noise_bandwidth_hz(2) - 1.0).abs() < 1e-6);
    }
}
