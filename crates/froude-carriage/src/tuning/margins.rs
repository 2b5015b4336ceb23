//! Margins of a loop from its measured frequency response.
//!
//! L = C·P with the controller's own response and the drive's measured one. Between measured points modulus (in the logarithm)
//! and unwrapped phase are interpolated in the logarithm of the frequency.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::{LoopGains, ResponsePoint};

/// How far a loop is from instability.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Margins {
    /// Highest frequency at which |L| falls through 1, Hz.
    pub crossover_hz: Option<f64>,
    /// Smallest phase margin over all crossings of |L| = 1, rad.
    pub phase_rad: Option<f64>,
    /// Smallest factor > 1 by which the gain may rise (crossings of −180° with |L| < 1).
    pub gain: Option<f64>,
    /// Smallest factor < 1 to which the gain may fall (crossings of −180° with |L| > 1): loops with an integrator can lose
    /// stability by too little gain.
    pub gain_reduction: Option<f64>,
    /// Smallest phase margin over its own frequency, s.
    pub delay_s: Option<f64>,
    /// Largest |1/(1 + L)| over the measured frequencies and between them.
    ///
    /// Noise makes the largest of many points larger, a peak narrower than their spacing makes it smaller, and no interval of single points
    /// allows for either: it has none.
    pub largest_sensitivity: f64,
    /// |L| at the first and the last frequency.
    pub end_moduli: [f64; 2],
}

impl Margins {
    /// Whether the band holds the whole loop: |L| above 1 at its low end, below 1/2 at its high end. Else what decides may lie outside.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.end_moduli[0] > 1.0 && self.end_moduli[1] < 0.5
    }
}

/// Steps between two measured points in which the largest sensitivity is looked for.
const BETWEEN: u32 = 8;

/// A point of the open loop, ready for a Bode plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopPoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// |L|.
    pub modulus: f64,
    /// Unwrapped phase, rad.
    pub phase_rad: f64,
}

/// The open loop L = C·P, phase unwrapped from its first point on, which is taken between −270° and +90°.
#[must_use]
pub fn open_loop(plant: &[ResponsePoint], gains: &LoopGains) -> Vec<LoopPoint> {
    let mut before: Option<f64> = None;
    plant
        .iter()
        .map(|p| {
            let l = p.plant_rad_v * gains.response_v_rad(p.frequency_hz);
            let mut phase = l.arg();
            let near = before.unwrap_or(-0.5 * PI);
            phase += 2.0 * PI * ((near - phase) / (2.0 * PI)).round();
            before = Some(phase);
            LoopPoint { frequency_hz: p.frequency_hz, modulus: l.norm(), phase_rad: phase }
        })
        .collect()
}

/// Margins of the loop over the measured frequencies; a margin without a crossing there is `None`.
#[must_use]
pub fn margins(plant: &[ResponsePoint], gains: &LoopGains) -> Margins {
    let points = open_loop(plant, gains);
    let end = |p: Option<&LoopPoint>| p.map_or(f64::NAN, |p| p.modulus);
    let mut out = Margins { end_moduli: [end(points.first()), end(points.last())], ..Margins::default() };
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        for k in 0..=BETWEEN {
            let t = f64::from(k) / f64::from(BETWEEN);
            let modulus = between(a.modulus.ln(), b.modulus.ln(), t).exp();
            let distance = (1.0 + Complex64::from_polar(modulus, between(a.phase_rad, b.phase_rad, t))).norm();
            out.largest_sensitivity = out.largest_sensitivity.max(1.0 / distance);
        }
        if let Some(t) = crossing(a.modulus.ln(), b.modulus.ln()) {
            let frequency_hz = between(a.frequency_hz.ln(), b.frequency_hz.ln(), t).exp();
            // Not folded into one turn: a delay of a whole turn more is no margin.
            let margin = between(a.phase_rad, b.phase_rad, t) + PI;
            if a.modulus > b.modulus {
                out.crossover_hz = Some(frequency_hz);
            }
            out.phase_rad = Some(out.phase_rad.map_or(margin, |m| m.min(margin)));
            if margin > 0.0 {
                let delay = margin / (2.0 * PI * frequency_hz);
                out.delay_s = Some(out.delay_s.map_or(delay, |d| d.min(delay)));
            }
        }
        // Crossings of −180° (and of −540°, …): where the phase less π is a whole number of turns.
        let turns = |phase: f64| (phase + PI) / (2.0 * PI);
        let (low, high) = (turns(a.phase_rad).min(turns(b.phase_rad)), turns(a.phase_rad).max(turns(b.phase_rad)));
        let whole = low.ceil();
        if whole <= high && high > low {
            let t = (whole - turns(a.phase_rad)) / (turns(b.phase_rad) - turns(a.phase_rad));
            let factor = 1.0 / between(a.modulus.ln(), b.modulus.ln(), t).exp();
            if factor > 1.0 {
                out.gain = Some(out.gain.map_or(factor, |g| g.min(factor)));
            } else {
                out.gain_reduction = Some(out.gain_reduction.map_or(factor, |g| g.max(factor)));
            }
        }
    }
    out
}

/// Bandwidth of the closed loop, Hz: the highest frequency at which |L/(1 + L)| falls through 1/√2; `None` where it does not in the measured band.
#[must_use]
pub fn bandwidth_hz(plant: &[ResponsePoint], gains: &LoopGains) -> Option<f64> {
    let level = |p: &ResponsePoint| {
        let l = p.plant_rad_v * gains.response_v_rad(p.frequency_hz);
        (l / (1.0 + l)).norm().ln() + 0.5 * std::f64::consts::LN_2
    };
    let falls = plant.windows(2).rev().find_map(|pair| {
        let (a, b) = (level(&pair[0]), level(&pair[1]));
        crossing(a, b).filter(|_| a > b).map(|t| (pair, t))
    });
    falls.map(|(pair, t)| between(pair[0].frequency_hz.ln(), pair[1].frequency_hz.ln(), t).exp())
}

/// Where a line from `a` to `b` crosses zero, as a part of the way.
fn crossing(a: f64, b: f64) -> Option<f64> {
    (a != b && (a > 0.0) != (b > 0.0)).then(|| a / (a - b))
}

fn between(a: f64, b: f64, part: f64) -> f64 {
    a + (b - a) * part
}

#[cfg(test)]
mod tests {
    use super::*;

    /// P = 1/s with K_p = 2π·5 Hz: the loop is 5 Hz over i f, its closed loop a first-order lag with its corner there.
    #[test]
    fn an_integrator_has_its_crossover_for_a_bandwidth() {
        let point = |i: i32| {
            let frequency_hz = 1.02_f64.powi(i);
            let plant_rad_v = 1.0 / Complex64::new(0.0, 2.0 * PI * frequency_hz);
            ResponsePoint { frequency_hz, plant_rad_v, coherence: 1.0, relative_std: 0.01 }
        };
        let plant: Vec<ResponsePoint> = (0..200).map(point).collect();
        let gains = LoopGains {
            proportional_v_rad: 2.0 * PI * 5.0,
            derivative_v_s_rad: 0.0,
            integral_v_rad_s: 0.0,
            derivative_filter_hz: 100.0,
            tick_s: 0.0,
        };
        // Between points 2 % apart the logarithm of the modulus is taken as straight.
        assert!((bandwidth_hz(&plant, &gains).unwrap() / 5.0 - 1.0).abs() < 1e-4);
        assert!((margins(&plant, &gains).crossover_hz.unwrap() / 5.0 - 1.0).abs() < 1e-12);
        assert_eq!(bandwidth_hz(&plant[..50], &gains), None);
    }
}
