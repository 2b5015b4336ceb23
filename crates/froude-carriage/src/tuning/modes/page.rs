//! Modes on the page and on the terminal, and what to put into the campaign.

use std::f64::consts::TAU;

use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Scale, Series, TextTable};
use froude_records::run::Declared;

use super::{CarriageModes, StateModes};
use crate::tuning::resonance::TwoMassModes;

/// Free mode without the gear's loss, Hz, and its standard uncertainty; `None` where no efficiency is declared.
#[must_use]
pub fn free_without_loss(modes: &TwoMassModes, efficiency: Option<Declared>) -> Option<(f64, f64)> {
    efficiency.map(|e| modes.free_through_gear(e.value, e.standard_uncertainty))
}

/// Modes by state of the body.
#[must_use]
pub fn modes_table(outcome: &CarriageModes) -> TextTable {
    let missing = || number::MISSING.to_owned();
    let mut rows: Vec<Vec<String>> = [
        "load mode f_l (anti-resonance) [Hz]",
        "its damping ratio [1]",
        "free mode f_r (resonance), apparent [Hz]",
        "its damping ratio [1]",
        "free mode, corrected for the gear's loss [Hz]",
        "load over motor inertia r, apparent [1]",
        "r, corrected for the gear's loss [1]",
        "unexplained part of the response, RMS",
        "unexplained part of the response, median",
    ]
    .map(|name| vec![name.to_owned()])
    .to_vec();
    for s in &outcome.states {
        let cells = s.modes.as_ref().map_or_else(
            |_| vec![missing(); rows.len()],
            |m| {
                let without = free_without_loss(m, outcome.efficiency);
                vec![
                    number::short_form(m.load.frequency_hz, m.load.frequency_std_hz),
                    number::short_form(m.load.damping, m.load.damping_std),
                    number::short_form(m.free.frequency_hz, m.free.frequency_std_hz),
                    number::short_form(m.free.damping, m.free.damping_std),
                    without.map_or_else(missing, |(hz, std)| number::short_form(hz, std)),
                    number::plain(m.inertia_ratio, 3),
                    outcome.efficiency.map_or_else(missing, |e| number::plain(e.value * m.inertia_ratio, 3)),
                    number::percent(m.relative_residual),
                    number::percent(m.median_residual),
                ]
            },
        );
        rows.iter_mut().zip(cells).for_each(|(row, cell)| row.push(cell));
    }
    let body = |s: &StateModes| if s.body == "none" { "bare".to_owned() } else { s.body.clone() };
    TextTable {
        caption: "Modes seen from the motor: that of the load with the motor held (the dip of the response, to shape for), and that of both masses free (its peak)."
            .to_owned(),
        head: std::iter::once("mode".to_owned()).chain(outcome.states.iter().map(body)).collect(),
        rows,
    }
}

/// What to put into the campaign, and why not 13 Hz.
#[must_use]
pub fn sentences(outcome: &CarriageModes) -> Vec<String> {
    let mut out: Vec<String> =
        outcome.states.iter().filter_map(|s| s.modes.as_ref().err().map(|e| format!("{}: {e}.", s.body))).collect();
    if let (Some((hz, damping)), Some(shaper)) = (outcome.proposed, outcome.shaper.as_ref()) {
        let left: Vec<String> = outcome
            .states
            .iter()
            .filter(|s| s.body != "none")
            .filter_map(|s| s.modes.as_ref().ok().map(|m| (&s.body, m.load)))
            .map(|(body, load)| format!("{body} {}", number::percent(shaper.residual(load.frequency_hz, load.damping))))
            .collect();
        out.push(format!(
            "Proposed: [rig.y.controller] shaped_mode = \"{hz:.2} Hz\", shaped_damping = \"{:.1} %\", robust_shaper = true. It is one shaper for all bodies, between their \
             modes; the bare carriage is not covered. It adds {:.0} ms to a move. Residual swing at the measured modes: {}; at most {} for a mode within 10 % of the shaper's.",
            1e2 * damping,
            1e3 * shaper.added_s,
            left.join(", "),
            number::percent(shaper.residual_10_percent_low.max(shaper.residual_10_percent_high))
        ));
        out.push(
            "The free mode, which the motor's current shows, is not the one to shape for: a stiff position loop holds the motor still, \
             and the load swings on the chain at f_l = √(K_e/M)/2π, with the stiffness K_e of the chain and the mass M of the load. Shaping for the free mode leaves that swing as it was."
                .to_owned(),
        );
    }
    if outcome.states.iter().any(|s| s.modes.is_ok()) {
        out.push(match outcome.efficiency {
            Some(e) => format!(
                "The free mode as measured (apparent) includes the loss of the gear: the sweep rides on a steady motion, so that the motor feels the chain's force \
                 divided by the efficiency η, and f_r² = f_l² (1 + r/η), where r is the inertia of the load over that of the motor. With the declared \
                 η = {} the loss is taken out; the uncertainty of η is in the corrected mode. The load mode does not depend on η.",
                number::short_form(e.value, e.standard_uncertainty)
            ),
            None => "The free mode is only apparent: the sweep rides on a steady motion, so that the motor feels the chain's force over the gear's \
                     efficiency η, and f_r² = f_l² (1 + r/η). Declare `efficiency` in [rig.y] and the loss is taken out. The load mode does \
                     not depend on η."
                .to_owned(),
        });
        out.push(
            "The unexplained part is the root mean square of |model/measured − 1| over the points with a coherence above 0.8. Much of it lies in \
             the dip, which friction fills, beside the peak, and at the lower end of the band; with a body also at harmonics of the load mode, \
             which the gear generates. Most points are far better, as the median says. It affects the damping ratios and the depth \
             of the dip, but hardly its frequency, which is what a shaper needs."
                .to_owned(),
        );
    }
    out
}

/// The section of the page: table, sentences and the responses.
#[must_use]
pub fn section(outcome: &CarriageModes) -> DocumentSection {
    let series = |s: &StateModes| Series {
        name: s.body.clone(),
        mark: Mark::Line,
        x: s.plant.iter().map(|p| p.frequency_hz).collect(),
        y: s.plant.iter().map(|p| p.plant_rad_v.norm() * (TAU * p.frequency_hz).powi(2)).collect(),
        ..Series::default()
    };
    DocumentSection {
        title: "Modes".to_owned(),
        paragraphs: sentences(outcome),
        tables: vec![modes_table(outcome)],
        charts: vec![Chart {
            name: "resonance".to_owned(),
            title: "Acceleration response of the motor".to_owned(),
            caption: "Acceleration of the motor per volt: the dip is the load swinging on a still motor, the peak both masses free."
                .to_owned(),
            x_label: "frequency [Hz]".to_owned(),
            x_scale: Scale::Logarithmic,
            panels: vec![ChartPanel {
                y_label: "|θ̈/v_c| [rad/(s² V)]".to_owned(),
                y_scale: Scale::Logarithmic,
                series: outcome.states.iter().map(series).collect(),
            }],
        }],
    }
}
