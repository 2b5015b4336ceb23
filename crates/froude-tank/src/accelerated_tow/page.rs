//! Accelerated tows on the page: each run as it was weighted, fitted beside measured, and what the residuals still hold.

use std::f64::consts::TAU;

use froude_identify::regression::ModelFit;
use froude_records::block::{Block, ResultTable, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark};

use super::law::names;
use super::reduce::Reduced;
use super::rows::Rows;
use super::setup::Setup;
use crate::drawn::{self, over_time, series};
use crate::log::TankLog;

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 4;

/// What was done to the runs, and what the law `model` leaves of them.
#[must_use]
pub fn section(logs: &[TankLog], reduced: &Reduced, setup: &Setup, model: Option<&ModelFit>) -> Section {
    let paragraph = format!(
        "Motion and force are weighted by windows of {} s, a third of that apart; the acceleration is that of the windows' derivatives, so that it is as late and as smooth as the force. \
         The zero of each run is the straight line between the means of its parts at rest. The load of the water is the mass below the cell times the acceleration, less the force.",
        number::plain(setup.window_s, 4)
    );
    let tables = [runs(reduced, setup), masses(reduced, setup)].map(Block::from);
    let of_law = model.map(|model| [fitted(reduced, model, setup), spectrum(reduced, model, setup)]);
    let charts = std::iter::once(signals(logs, reduced)).chain(of_law.into_iter().flatten()).map(Block::from);
    Section::new("Runs and windows", std::iter::once(Block::words([paragraph])).chain(tables).chain(charts))
}

fn runs(reduced: &Reduced, setup: &Setup) -> ResultTable {
    let largest = |of: &[f64]| of.iter().fold(0.0_f64, |m, x| if x.abs() > m.abs() { *x } else { m });
    let ends = |rows: &Rows| [rows.middle_s[0], rows.middle_s[rows.middle_s.len() - 1]];
    let windows = |[from, to]: [f64; 2]| format!("{from:.2} to {to:.2}");
    let t = TableBuilder::new("runs", "Each run as it was weighted.", &reduced.runs);
    t.build(vec![
        t.text("run", "run", |(id, ..)| id.clone()),
        t.text("configuration", "configuration", |(_, body, _)| setup.bodies[*body].name.clone()),
        t.text("", "windows [s]", |(.., rows)| windows(ends(rows))),
        t.interval("windows_s", "", |(.., rows)| ends(rows)),
        t.count("rows", "rows", |(.., rows)| rows.middle_s.len()),
        t.number("speed_m_s", "largest speed [m/s]", |(.., rows)| largest(&rows.speed_m_s)).significant(3),
        t.number("acceleration_m_s2", "largest acceleration [m/s²]", |(.., rows)| largest(&rows.acceleration_m_s2))
            .significant(3),
        t.number("noise_m_s2", "noise of the acceleration [m/s²]", |(.., rows)| rows.noise_m_s2).significant(2),
        t.uncertain(
            ["zero_n", "zero_standard_n"],
            "zero [N]",
            |(.., rows)| rows.zero_n[0],
            |(.., rows)| rows.zero_standard_n,
        ),
        t.number("drift_n", "drift of the zero [N]", |(.., rows)| rows.zero_n[1] - rows.zero_n[0]).significant(2),
    ])
}

fn masses(reduced: &Reduced, setup: &Setup) -> ResultTable {
    let rows: Vec<_> = setup.bodies.iter().zip(&reduced.masses).collect();
    let caption = "Masses below the load cell, and the volumes that C_A refers to.";
    let t = TableBuilder::new("masses", caption, &rows);
    t.build(vec![
        t.text("configuration", "configuration", |(body, _)| body.name.clone()),
        t.uncertain(["mass_kg", "mass_standard_kg"], "mass [kg]", |(_, m)| m.value_kg, |(_, m)| m.standard_kg),
        t.text("from", "source", |(_, m)| if m.is_weighed { "by runs in air" } else { "declared" }.to_owned()),
        t.number("reference_volume_m3", "reference volume [m³]", |(body, _)| body.volume_m3).plain(5),
    ])
}

fn signals(logs: &[TankLog], reduced: &Reduced) -> Chart {
    let panel = |(id, _, rows): &(String, usize, Rows)| {
        let log = &logs.iter().find(|log| log.log.meta.id == *id)?.log;
        let force = &log.channels.get("force")?.values;
        let (first, last) = (rows.middle_s[0], rows.middle_s[rows.middle_s.len() - 1]);
        let mut drawn = vec![
            series("as read", Mark::Points, &log.time_s[..], &force[..]),
            series("zero over the windows used", Mark::Line, [first, last], rows.zero_n),
        ];
        for (k, rest) in rows.rest_s.iter().enumerate() {
            drawn.extend(rest.map(|ends| series("at rest", Mark::Line, ends, [rows.zero_n[k]; 2])));
        }
        Some(drawn::panel(format!("force of {id} [N]"), drawn))
    };
    let panels: Vec<ChartPanel> = reduced.runs.iter().take(DRAWN).filter_map(panel).collect();
    let caption = format!(
        "Force of the rig on the body as it was read in {} of {} runs, its parts at rest, and the zero over the windows that are used.",
        panels.len(),
        reduced.runs.len()
    );
    over_time(["signals", "Force and windows"], caption, panels)
}

/// Fitted load of every row, N.
fn predicted(reduced: &Reduced, model: &ModelFit) -> Vec<f64> {
    model.law.predict(&reduced.data, model.law_coefficients()).unwrap_or_else(|_| vec![f64::NAN; reduced.data.rows])
}

fn fitted(reduced: &Reduced, model: &ModelFit, setup: &Setup) -> Chart {
    let load = &names(&setup.axis)[0];
    let (measured, law) = (reduced.data.values(load).unwrap_or_default(), predicted(reduced, model));
    let mut from = 0;
    let mut panels = Vec::new();
    for (id, _, rows) in reduced.runs.iter().take(DRAWN) {
        let own = from..from + rows.middle_s.len();
        from = own.end;
        let drawn = [("measured", Mark::Points, measured), (&model.law.name, Mark::Line, &law)];
        let drawn = drawn.map(|(name, mark, of)| series(name, mark, &rows.middle_s[..], &of[own.clone()]));
        panels.push(drawn::panel(format!("{load} of {id} [N]"), drawn.to_vec()));
    }
    let (n, all) = (panels.len(), reduced.runs.len());
    let caption = format!("Load of the water in the windows of {n} of {all} runs, and that of the law.");
    over_time(["fitted", "Fitted beside measured"], caption, panels)
}

/// Mean periodogram of the residuals of the runs, as amplitude over the frequencies that the rows resolve.
fn spectrum(reduced: &Reduced, model: &ModelFit, setup: &Setup) -> Chart {
    let load = &names(&setup.axis)[0];
    let (measured, law) = (reduced.data.values(load).unwrap_or_default(), predicted(reduced, model));
    let step_s = setup.window_s / 3.0;
    let shortest = reduced.runs.iter().map(|(_, _, rows)| rows.middle_s.len()).min().unwrap_or(0);
    let frequencies: Vec<f64> = (1..=shortest / 2).map(|k| k as f64 / (shortest as f64 * step_s)).collect();
    let mut power = vec![0.0; frequencies.len()];
    let mut from = 0;
    for (_, _, rows) in &reduced.runs {
        let n = rows.middle_s.len();
        let left: Vec<f64> = (from..from + n).map(|i| measured[i] - law[i]).collect();
        from += n;
        for (f, sum) in frequencies.iter().zip(&mut power) {
            let (c, s) = left.iter().zip(&rows.middle_s).fold((0.0, 0.0), |(c, s), (r, t)| {
                let (sin, cos) = (TAU * f * t).sin_cos();
                (c + r * cos, s + r * sin)
            });
            *sum += (c * c + s * s) * 4.0 / (n as f64).powi(2) / reduced.runs.len() as f64;
        }
    }
    let amplitudes: Vec<f64> = power.into_iter().map(f64::sqrt).collect();
    let drawn = vec![series("residuals", Mark::Line, frequencies, amplitudes)];
    Chart {
        name: "residual-spectrum".to_owned(),
        title: "Spectrum of the residuals".to_owned(),
        caption: format!(
            "Amplitude of what the law leaves, in the mean square of the runs. A line is a vibration of the rig; a rise towards low frequencies is noise that is correlated, or a law \
             that lacks a term. Rows stand {} s apart: what swings faster than {} Hz stands folded below that.",
            number::plain(step_s, 3),
            number::plain(0.5 / step_s, 3)
        ),
        x_label: "frequency [Hz]".to_owned(),
        panels: vec![drawn::panel(format!("{load} [N]"), drawn)],
        ..Chart::default()
    }
}
