//! Modes on the page and on the terminal, and what to put into the campaign.

use std::f64::consts::TAU;

use froude_records::block::{Block, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark, Scale, Series};
use froude_records::run::Declared;

use super::{CarriageModes, StateModes};
use crate::tuning::resonance::{Mode, TwoMassModes};
use crate::tuning::turned::turned;

/// Free mode without the gear's loss, Hz, and its standard uncertainty; `None` where no efficiency is declared.
#[must_use]
pub fn free_without_loss(modes: &TwoMassModes, efficiency: Option<Declared>) -> Option<(f64, f64)> {
    efficiency.map(|e| modes.free_through_gear(e.value, e.standard_uncertainty))
}

/// Modes by state of the body.
#[must_use]
pub fn modes_table(outcome: &CarriageModes) -> [Block; 2] {
    let caption = "Modes seen from the motor: that of the load with the motor held (the dip of the response, to shape for), and that of both masses free (its peak).";
    let t = TableBuilder::new("modes", caption, &outcome.states);
    let of = |s: &StateModes| s.modes.as_ref().ok().copied();
    let uncertain = |keys, head, value: &dyn Fn(TwoMassModes) -> Option<(f64, f64)>| {
        t.uncertain(keys, head, |s| Some(value(of(s)?)?.0), |s| Some(value(of(s)?)?.1))
    };
    let frequency = |mode: Mode| Some((mode.frequency_hz, mode.frequency_std_hz));
    let damping = |mode: Mode| Some((mode.damping, mode.damping_std));
    let body = |s: &StateModes| if s.body == "none" { "bare".to_owned() } else { s.body.clone() };
    turned(
        "mode",
        t.build(vec![
            t.text("body", "body", body),
            uncertain(["load_hz", "load_standard_hz"], "load mode f_l (anti-resonance) [Hz]", &|m| frequency(m.load)),
            uncertain(["load_damping", "load_damping_standard"], "its damping ratio [1]", &|m| damping(m.load)),
            uncertain(["free_hz", "free_standard_hz"], "free mode f_r (resonance), apparent [Hz]", &|m| {
                frequency(m.free)
            }),
            uncertain(["free_damping", "free_damping_standard"], "its damping ratio [1]", &|m| damping(m.free)),
            uncertain(
                ["free_corrected_hz", "free_corrected_standard_hz"],
                "free mode, corrected for the gear's loss [Hz]",
                &|m| free_without_loss(&m, outcome.efficiency),
            ),
            t.number("inertia_ratio", "load over motor inertia r, apparent [1]", |s| Some(of(s)?.inertia_ratio))
                .plain(3),
            t.number("inertia_ratio_corrected", "r, corrected for the gear's loss [1]", |s| {
                Some(outcome.efficiency?.value * of(s)?.inertia_ratio)
            })
            .plain(3),
            t.number("rms_residual", "unexplained part of the response, RMS", |s| Some(of(s)?.relative_residual))
                .percent(),
            t.number("median_residual", "unexplained part of the response, median", |s| Some(of(s)?.median_residual))
                .percent(),
        ]),
    )
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
pub fn section(outcome: &CarriageModes) -> Section {
    let series = |s: &StateModes| Series {
        name: s.body.clone(),
        mark: Mark::Line,
        x: s.plant.iter().map(|p| p.frequency_hz).collect(),
        y: s.plant.iter().map(|p| p.plant_rad_v.norm() * (TAU * p.frequency_hz).powi(2)).collect(),
        ..Series::default()
    };
    let chart = Chart {
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
    };
    let [shown, table] = modes_table(outcome);
    Section::new("Modes", [shown, table, Block::words(sentences(outcome)), chart.into()])
}
