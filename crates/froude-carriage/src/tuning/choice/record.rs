//! A loop as an estimate: its margins with what the measured response leaves uncertain of them, and its gains.

use froude_fit::propagate::effective_dof;
use froude_records::estimate::{Derived, Diagnostics, Estimate, Law, Measured, MethodUsed};
use num_complex::Complex64;

use super::{BY_CYCLE, CONFIGURED, Tuned};
use crate::tuning::candidate::Candidate;
use crate::tuning::margins::{bandwidth_hz, margins};
use crate::tuning::record::{Reading, Spread, of_response};
use crate::tuning::response::POINT_DOF;
use crate::tuning::{LoopGains, ResponsePoint};

/// What is read off the open loop.
const READINGS: usize = 6;

/// An estimate for each candidate, called after where its gains come from, so that those of two days are compared each with its own.
#[must_use]
pub fn estimates(source: &str, tuned: &Tuned) -> Vec<Estimate> {
    let of = |(i, c): (usize, &Candidate)| estimate(source, tuned, c, tuned.recommended == Some(i));
    tuned.candidates.iter().enumerate().map(of).collect()
}

fn estimate(source: &str, tuned: &Tuned, c: &Candidate, recommended: bool) -> Estimate {
    let law = match c.name.as_str() {
        CONFIGURED => "loop_as_configured",
        BY_CYCLE => "loop_ziegler_nichols",
        _ => "loop_shaped",
    };
    // Beyond the measured band the margins are a model's, whose errors the points do not tell.
    let spread = (!c.is_extended).then(|| spread(&tuned.plant, &c.gains));
    let mut readings = readings(&tuned.plant, &c.gains);
    if c.is_extended {
        // What the model extended is what the candidate was judged by; its bandwidth was not measured.
        let m = &c.margins;
        let judged = [m.crossover_hz, None, m.phase_rad, m.gain, m.gain_reduction, m.delay_s];
        readings.iter_mut().zip(judged).for_each(|(reading, value)| reading.2 = value);
    }
    let of_response = of_response(source, (law, ("open_loop", "1")), &readings, spread.as_ref(), tuned.band_hz);
    let measured = |name: &str, value: f64, unit: &str| (name.to_owned(), Measured::of(value, unit));
    let g = &c.gains;
    let constants = [
        measured("proportional", g.proportional_v_rad, "V/rad"),
        measured("derivative", g.derivative_v_s_rad, "V s/rad"),
        measured("integral", g.integral_v_rad_s, "V/(rad s)"),
        measured("derivative_filter", g.derivative_filter_hz, "Hz"),
        measured("tick", g.tick_s, "s"),
    ];
    // No interval is known of these.
    let derived = |name: &str, value: Option<f64>, unit: &str, formula: &str| {
        (name.to_owned(), Derived::of(formula, value, unit))
    };
    let ramps = "the hardest ramps through the two masses that the response shows";
    let heaviest = "phase margin with the heaviest body, on the two masses that the response shows";
    let largest = "largest |1/(1 + L)| over the measured band; noise makes it larger, a peak narrower than the points' spacing smaller";
    let extended = c.is_extended.then(|| {
        "the loop is not whole within the measured band: its margins beyond are the fitted two-mass model's".to_owned()
    });
    Estimate {
        method: MethodUsed::of("tuning", format!("margins on the measured response; gains {}", c.name)),
        law: Law { constants: constants.into(), ..of_response.law },
        n_observations: tuned.plant.len(),
        derived: [
            derived("largest_sensitivity", Some(c.margins.largest_sensitivity), "1", largest),
            derived("following_error", c.following_error_m, "m", ramps),
            derived("homing_speed", c.homing_m_s, "m/s", ramps),
            derived("phase_margin_heaviest", c.heaviest.and_then(|margins| margins.phase_rad), "rad", heaviest),
        ]
        .into(),
        diagnostics: Diagnostics {
            notes: extended.into_iter().chain(c.objections.iter().cloned()).collect(),
            ..Diagnostics::default()
        },
        recommended,
        reason: recommended.then(|| "it keeps all that is asked for".to_owned()),
        ..of_response
    }
}

/// Margins of a loop on a response.
fn readings(plant: &[ResponsePoint], gains: &LoopGains) -> [Reading; READINGS] {
    let m = margins(plant, gains);
    [
        ("crossover", "Hz", m.crossover_hz),
        ("bandwidth", "Hz", bandwidth_hz(plant, gains)),
        ("phase_margin", "rad", m.phase_rad),
        ("gain_margin", "1", m.gain),
        ("gain_reduction", "1", m.gain_reduction),
        ("delay_margin", "s", m.delay_s),
    ]
}

/// Covariance of the margins: each point of the response moved by its standard uncertainty, in modulus and in phase, with the degrees of
/// freedom of each by Welch and Satterthwaite.
fn spread(plant: &[ResponsePoint], gains: &LoopGains) -> Spread {
    let base = readings(plant, gains);
    let mut covariance = vec![vec![0.0; READINGS]; READINGS];
    let mut parts = vec![Vec::new(); READINGS];
    let mut moved = plant.to_vec();
    for i in 0..plant.len() {
        let u = plant[i].relative_std;
        if u.is_nan() || u <= 0.0 {
            continue;
        }
        let mut of_point = [0.0; READINGS];
        for factor in [Complex64::new(1.0 + u, 0.0), Complex64::from_polar(1.0, u)] {
            moved[i].plant_rad_v = plant[i].plant_rad_v * factor;
            let found = readings(&moved, gains);
            // A margin that is lost or found by the step has no slope.
            let step: [f64; READINGS] =
                std::array::from_fn(|j| found[j].2.zip(base[j].2).map_or(0.0, |(moved, base)| moved - base));
            for (row, a) in covariance.iter_mut().zip(step) {
                row.iter_mut().zip(step).for_each(|(entry, b)| *entry += a * b);
            }
            of_point.iter_mut().zip(step).for_each(|(variance, a)| *variance += a * a);
        }
        moved[i] = plant[i];
        parts.iter_mut().zip(of_point).for_each(|(parts, variance)| parts.push((variance, POINT_DOF)));
    }
    Spread { covariance, dof: parts.iter().map(|parts| effective_dof(parts)).collect() }
}
