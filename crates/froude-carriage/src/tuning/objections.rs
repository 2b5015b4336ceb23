//! What speaks against gains: margins, the encoder's counts, and the ramps of the campaign.

use froude_control::config::Limits;
use froude_records::number;

use super::candidate::Candidate;
use super::gains::{Demand, Encoder};
use super::margins::Margins;

/// Part of the way to a fault that a foreseen ramp may take: what the two masses do not know (stiction, the gear) is the rest.
const TRACKING_PART: f64 = 0.7;

/// What the margins, the encoder and the campaign's ramps say against gains.
pub(super) fn objections(c: &Candidate, limits: &Limits, encoder: &Encoder) -> Vec<String> {
    let digits = |x: f64| number::significant(x, 3);
    let mut out = against_margins(&c.margins);
    if let Some(heaviest) = &c.heaviest {
        // Stable, no more: a light damping brings a stiff loop close to −1 at the load mode, where it moves the motor by nothing.
        if heaviest.phase_rad.is_none_or(|x| x <= 0.0) {
            out.push("unstable with the heaviest body".to_owned());
        }
    }
    if c.volts_per_count > encoder.most_v {
        out.push(format!(
            "an encoder count moves the command by {} V, more than friction's {} V",
            digits(c.volts_per_count),
            digits(encoder.most_v)
        ));
    }
    match (c.following_error_m, c.homing_m_s) {
        (Some(error_m), Some(homing_m_s)) => {
            if error_m > TRACKING_PART * limits.following_error_m {
                out.push(format!(
                    "following error up to {} mm in the ramps, where the fault trips at {} mm",
                    digits(1e3 * error_m),
                    digits(1e3 * limits.following_error_m)
                ));
            }
            let over_m_s = limits.over_speed_m_s(false);
            if homing_m_s > limits.unhomed_speed_m_s + TRACKING_PART * (over_m_s - limits.unhomed_speed_m_s) {
                out.push(format!(
                    "peak motor speed, as speed of the chain, {} mm/s when homing at {} mm/s; over-speed trips at {} mm/s",
                    digits(1e3 * homing_m_s),
                    digits(1e3 * limits.unhomed_speed_m_s),
                    digits(1e3 * over_m_s)
                ));
            }
        }
        _ => out.push("the response shows no two masses, so the ramps could not be predicted".to_owned()),
    }
    out
}

/// What margins lack of what is asked for.
fn against_margins(m: &Margins) -> Vec<String> {
    let demand = Demand::default();
    let digits = |x: f64| number::significant(x, 3);
    let mut out = Vec::new();
    if !m.is_whole() {
        out.push(format!(
            "|L| is {} at the lowest and {} at the highest frequency known: what decides lies outside the band",
            digits(m.end_moduli[0]),
            digits(m.end_moduli[1])
        ));
    }
    match m.phase_rad {
        Some(phase) if phase < demand.phase_rad => out.push(format!(
            "phase margin {:.0}°, at least {:.0}° required",
            phase.to_degrees(),
            demand.phase_rad.to_degrees()
        )),
        None => out.push("no crossover: the loop gain stays below 1".to_owned()),
        Some(_) => {}
    }
    if let Some(gain) = m.gain.filter(|&g| g < demand.gain) {
        out.push(format!("gain margin {}, at least {} required", digits(gain), digits(demand.gain)));
    }
    if let Some(gain) = m.gain_reduction.filter(|g| g * demand.gain > 1.0) {
        out.push(format!("becomes unstable when its gain falls to {}", number::percent(gain)));
    }
    if m.largest_sensitivity > demand.sensitivity {
        let (is, may) = (digits(m.largest_sensitivity), digits(demand.sensitivity));
        out.push(format!("maximum sensitivity {is}, at most {may} allowed"));
    }
    out
}
