//! Gains for the loop: shaped on the measured response, and Ziegler–Nichols' beside them for comparison.

use std::f64::consts::{PI, TAU};

use super::margins::{Margins, margins};
use super::relay::LimitCycle;
use super::{LoopGains, ResponsePoint, TuningError};

/// What a loop must keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demand {
    /// Smallest phase margin, rad.
    pub phase_rad: f64,
    /// Smallest gain margin, factor.
    pub gain: f64,
    /// Largest sensitivity.
    pub sensitivity: f64,
}

/// The encoder that the loop works with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoder {
    /// One count, rad of the motor.
    pub count_rad: f64,
    /// Most that a count may move the command, V. Above friction's own command the loop at rest would knock through stiction at every count.
    pub most_v: f64,
    /// The controller's tick, s.
    pub tick_s: f64,
}

impl Demand {
    /// Whether the margins keep it, the whole loop lying in the band that they are of.
    #[must_use]
    pub fn is_kept(&self, m: &Margins) -> bool {
        m.is_whole()
            && m.phase_rad.is_some_and(|x| x >= self.phase_rad)
            && m.gain.is_none_or(|x| x >= self.gain)
            && m.gain_reduction.is_none_or(|x| x * self.gain <= 1.0)
            && m.largest_sensitivity <= self.sensitivity
    }
}

impl Default for Demand {
    /// 45°, 2 (6 dB), 2: the usual values (Åström & Hägglund 2006, §4.6).
    fn default() -> Self {
        Self { phase_rad: 0.25 * PI, gain: 2.0, sensitivity: 2.0 }
    }
}

/// The fastest PID that keeps the demand on the measured response.
///
/// The controller's form is fixed by its crossover f_c: derivative zero at f_c/3 (or lower, down to f_c/12, where
/// the dip of a lightly damped load asks for more lead), derivative filter at 10 f_c, integral at f_c/10 or
/// lower: K_i ≤ K_d ω_l²/2 with ω_l = 2π `load_hz`, the lowest mode of any load on a motor that stands. Below √(K_i/K_d) the integral's
/// lag is more than the derivative's lead, and a motor so controlled feeds a load's swing instead of damping it. Crossovers are tried
/// from the highest measured frequency downwards; at each the gain makes |L(f_c)| = 1. A loop is taken only if all of it lies in the
/// measured band, |L| above 1 at its low end and well below 1 at its high end: a chain's resonance alone crosses |L| = 1 too, in a loop
/// that is too soft to hold anything.
///
/// # Errors
///
/// [`TuningError`] when none keeps it.
pub fn shaped_on_response(
    plant: &[ResponsePoint],
    load_hz: f64,
    demand: &Demand,
    encoder: &Encoder,
) -> Result<LoopGains, TuningError> {
    plant
        .iter()
        .rev()
        .flat_map(|point| LEADS.map(|lead| with_crossover(point, lead, load_hz, encoder.tick_s)))
        .filter(|gains| gains.volts_per_count(encoder.count_rad) <= encoder.most_v)
        .find(|gains| demand.is_kept(&margins(plant, gains)))
        .ok_or_else(|| {
            let [low_hz, high_hz] = [plant.first(), plant.last()].map(|p| p.map_or(f64::NAN, |p| p.frequency_hz));
            TuningError(format!(
                "no crossover between {low_hz:.2} and {high_hz:.2} Hz keeps a phase margin of {:.0}° and a maximum \
                 sensitivity of {:.1}, with the whole loop inside; measure over a wider band, or ask for less",
                demand.phase_rad.to_degrees(),
                demand.sensitivity
            ))
        })
}

/// The derivative's zero below the crossover, least lead first.
const LEADS: [f64; 4] = [3.0, 5.0, 8.0, 12.0];

fn with_crossover(point: &ResponsePoint, lead: f64, load_hz: f64, tick_s: f64) -> LoopGains {
    let crossover_rad_s = TAU * point.frequency_hz;
    let derivative_s = lead / crossover_rad_s;
    let unit = LoopGains {
        proportional_v_rad: 1.0,
        derivative_v_s_rad: derivative_s,
        integral_v_rad_s: (crossover_rad_s / 10.0).min(0.5 * derivative_s * (TAU * load_hz).powi(2)),
        derivative_filter_hz: 10.0 * point.frequency_hz,
        tick_s,
    };
    let gain = 1.0 / (unit.response_v_rad(point.frequency_hz) * point.plant_rad_v).norm();
    LoopGains {
        proportional_v_rad: gain,
        derivative_v_s_rad: gain * unit.derivative_v_s_rad,
        integral_v_rad_s: gain * unit.integral_v_rad_s,
        ..unit
    }
}

/// Ziegler and Nichols (1942), ultimate-sensitivity rule: K_p = 0.6 K_u, T_i = T_u/2, T_d = T_u/8.
///
/// For comparison: it was made for a quarter of decay from swing to swing, which leaves small margins.
#[must_use]
pub fn ziegler_nichols(cycle: &LimitCycle, tick_s: f64) -> LoopGains {
    let proportional_v_rad = 0.6 * cycle.ultimate_gain_v_rad;
    LoopGains {
        proportional_v_rad,
        derivative_v_s_rad: proportional_v_rad * cycle.period_s / 8.0,
        integral_v_rad_s: proportional_v_rad * 2.0 / cycle.period_s,
        derivative_filter_hz: 10.0 / cycle.period_s,
        tick_s,
    }
}
