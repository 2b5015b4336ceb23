//! Gains side by side on the page and on the terminal, what speaks against each, and the open loop.

use std::f64::consts::TAU;

use froude_records::block::{Block, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark, Scale, Series};

use super::Tuned;

use crate::tuning::candidate::Candidate;
use crate::tuning::gains::Demand;
use crate::tuning::margins::open_loop;
use crate::tuning::turned::turned;

/// Scatter of the relay's period, as a part of it, below which it counts as none: the tick hides it.
const LEAST_SCATTER: f64 = 1e-4;

/// Gains, margins, what a count of the encoder does to the command, and the ramps; a column for each candidate.
#[must_use]
pub fn candidates_table(outcome: &Tuned) -> [Block; 2] {
    let demand = Demand::default();
    let caption = format!(
        "Gains of the controller (eq. 6 of the MCD paper) in SI units, then K_p and K_d per encoder count and K_i per count and tick. Margins are those of the bare carriage, on the response measured \
         from {:.1} to {:.0} Hz; one without a value has no crossing within that band. Following error and motor speed are those of the campaign's hardest ramps, bare and with the heaviest body, run through \
         the two masses that the response shows. Required: bare, a phase margin of {:.0}°, gain margins of {} and 1/{}, a maximum sensitivity of {} at most; with the heaviest body, stability.",
        outcome.band_hz[0],
        outcome.band_hz[1],
        demand.phase_rad.to_degrees(),
        demand.gain,
        demand.gain,
        demand.sensitivity
    );
    let t = TableBuilder::new("candidates", caption, &outcome.candidates);
    let number = |key, head, of: fn(&Candidate) -> Option<f64>| t.number(key, head, of).significant(3);
    turned(
        "quantity",
        t.build(vec![
            t.text("candidate", "candidate", |c| c.name.clone()),
            number("proportional_v_rad", "K_p [V/rad]", |c| Some(c.gains.proportional_v_rad)),
            number("derivative_v_s_rad", "K_d [V s/rad]", |c| Some(c.gains.derivative_v_s_rad)),
            number("integral_v_rad_s", "K_i [V/(rad s)]", |c| Some(c.gains.integral_v_rad_s)),
            number("derivative_filter_hz", "derivative filter [Hz]", |c| Some(c.gains.derivative_filter_hz)),
            number("proportional_v_count", "K_p [V/count]", |c| Some(c.counts.proportional)),
            number("derivative_v_s_count", "K_d [V s/count]", |c| Some(c.counts.derivative)),
            number("integral_v_count_tick", "K_i [V/(count tick)]", |c| Some(c.counts.integral)),
            number("step_of_count_v", "command step of one count [V]", |c| Some(c.volts_per_count)),
            number("crossover_hz", "crossover [Hz]", |c| c.margins.crossover_hz),
            number("phase_margin_rad", "phase margin [°]", |c| c.margins.phase_rad),
            number("gain_margin", "gain margin [1]", |c| c.margins.gain),
            number("gain_margin_downwards", "gain margin downwards [1]", |c| c.margins.gain_reduction),
            number("delay_margin_s", "delay margin [ms]", |c| c.margins.delay_s),
            number("largest_sensitivity", "maximum sensitivity [1]", |c| Some(c.margins.largest_sensitivity)),
            number("phase_margin_heaviest_rad", "phase margin with the heaviest body [°]", |c| c.heaviest?.phase_rad),
            number("feeding_below_hz", "integral drives oscillation below [Hz]", |c| Some(c.gains.feeding_hz())),
            number("following_error_m", "following error in ramps [mm]", |c| c.following_error_m),
            number("homing_m_s", "peak motor speed in homing [mm/s]", |c| c.homing_m_s),
            t.count("objections", "requirements not met", |c| c.objections.len()),
        ]),
    )
}

/// Objections to each candidate, where its margins come from, and what to write into the campaign.
#[must_use]
pub fn sentences(outcome: &Tuned) -> Vec<String> {
    let mut out = Vec::new();
    for c in &outcome.candidates {
        if c.is_extended {
            out.push(format!(
                "{}: its loop is not whole within the measured {:.1} to {:.0} Hz; its margins beyond are the fitted two-mass model's.",
                c.name, outcome.band_hz[0], outcome.band_hz[1]
            ));
        }
        if let Some(load_hz) = drives_load(c) {
            out.push(format!(
                "{}: below {:.1} Hz the integral's lag exceeds the derivative's lead, and the load with the heaviest body oscillates at \
                 {load_hz:.1} Hz: the loop drives that oscillation, and only friction damps it. With K_i below {} V/(rad s) the loop would not drive it.",
                c.name,
                c.gains.feeding_hz(),
                number::significant(c.gains.derivative_v_s_rad * (TAU * load_hz).powi(2), 2)
            ));
        }
        if !c.objections.is_empty() {
            out.push(format!("{}: {}.", c.name, c.objections.join("; ")));
        }
    }
    out.extend(outcome.unshaped.as_ref().map(|e| format!("No gains could be tuned on the response: {e}.")));
    match outcome.recommended.map(|i| &outcome.candidates[i]) {
        Some(c) if c.name == outcome.candidates[0].name => {
            out.push("Recommended: the gains as configured.".to_owned());
        }
        Some(c) => {
            let d = |x: f64| number::significant(x, 3);
            out.push(format!(
                "Recommended ({}): [rig.y.controller] proportional = \"{} V/rad\", derivative = \"{} V s/rad\", integral = \"{} V/(rad s)\", \
                 derivative_filter = \"{} Hz\".",
                c.name,
                d(c.gains.proportional_v_rad),
                d(c.gains.derivative_v_s_rad),
                d(c.gains.integral_v_rad_s),
                d(c.gains.derivative_filter_hz)
            ));
            if outcome.candidates[0].objections.is_empty() {
                let is_driven = drives_load(&outcome.candidates[0]).is_some();
                out.push(if is_driven {
                    "The gains as configured meet every requirement, but drive the oscillation of the heaviest body: reduce K_i.".to_owned()
                } else {
                    "The gains as configured also meet every requirement: there is no need to change them.".to_owned()
                });
            }
        }
        None => out.push("None of these gains is recommended.".to_owned()),
    }
    out
}

/// The mode of the heaviest body, Hz, where the integral drives it.
fn drives_load(c: &Candidate) -> Option<f64> {
    c.lowest_load_hz.filter(|hz| *hz < c.gains.feeding_hz())
}

/// The section of the page: table, sentences and the open loop.
#[must_use]
pub fn section(outcome: &Tuned) -> Section {
    let mut panels = [
        ChartPanel { y_label: "|L| [1]".to_owned(), y_scale: Scale::Logarithmic, ..ChartPanel::default() },
        ChartPanel { y_label: "phase of L [°]".to_owned(), ..ChartPanel::default() },
    ];
    for c in &outcome.candidates {
        let points = open_loop(&outcome.plant, &c.gains);
        let x: Vec<f64> = points.iter().map(|p| p.frequency_hz).collect();
        let series =
            |y: Vec<f64>| Series { name: c.name.clone(), mark: Mark::Line, x: x.clone(), y, ..Series::default() };
        panels[0].series.push(series(points.iter().map(|p| p.modulus).collect()));
        panels[1].series.push(series(points.iter().map(|p| p.phase_rad.to_degrees()).collect()));
    }
    let cycle = match &outcome.cycle {
        Ok(c) => {
            let scatter = if c.period_std_s < LEAST_SCATTER * c.period_s {
                "the same in every one".to_owned()
            } else {
                format!("standard deviation {} s", number::significant(c.period_std_s, 1))
            };
            format!(
                "The relay's limit cycle: {} periods of {} s ({}), amplitude {} rad; ultimate gain K_u = {} V/rad at {} Hz.",
                c.cycles,
                number::plain(c.period_s, 4),
                scatter,
                number::plain(c.amplitude_rad, 3),
                number::plain(c.ultimate_gain_v_rad, 3),
                number::plain(1.0 / c.period_s, 3)
            )
        }
        Err(error) => format!("The relay gave no limit cycle: {error}."),
    };
    let chart = Chart {
        name: "bode".to_owned(),
        title: "Open loop".to_owned(),
        caption: "Open loop L = C·P: the controller's own response times the measured one of the drive.".to_owned(),
        x_label: "frequency [Hz]".to_owned(),
        x_scale: Scale::Logarithmic,
        panels: panels.to_vec(),
    };
    let said = Block::words(std::iter::once(cycle).chain(sentences(outcome)));
    let [shown, table] = candidates_table(outcome);
    Section::new("Gains", [shown, table, said, chart.into()])
}
