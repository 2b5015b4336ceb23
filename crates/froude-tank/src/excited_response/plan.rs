//! The plan of runs in waves: run matrix, time, and the intervals to expect.
//!
//! The variance of one component of a signal's amplitude, over n samples of noise of standard deviation σ, is 2σ²/n · g, with g = 1 for white noise and the power of the
//! correlated one at ω over that of white noise of the same σ, g = (1 − a²)/(1 − 2a cos ωh + a²), a = e^{−h/τ}, of samples every h. The rest is the budget of the fit.
//!
//! **Source.** Rife & Boorstyn (1974) (amplitude of a line in white noise); Priestley (1981), 3.5 (spectrum of a first-order process).

use faer::c64;
use froude_fit::budget::{Combined, OUTSIDE_95, Part, combine};
use froude_identify::method::{MethodError, Prospect};
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::campaign::{Campaign, SensorSpec, Source};
use froude_records::text::counted;
use froude_rig::steady::Reading;

use super::coefficients::{NAMES, UNITS, budget, errors, scatter};
use super::response::{DOF, cycles_within};
use super::section::{self, setup_of};
use super::setup::{Setup, Shows};
use super::simulate::senses;
use super::simulate::{Planned, SENSORS, planned, truth};
use super::wave::LEFT_OUT;
use crate::error::{TankError, undeclared};
use crate::plan::{self, Expected};
use crate::sensors::{reading, seed_and_sensors};

/// What a plan gives at one period.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// Period, s.
    pub period_s: f64,
    /// Whole cycles of the window.
    pub cycles: usize,
    /// Held and free runs.
    pub runs: [usize; 2],
    /// Amplitude of the heave to expect, m.
    pub heave_m: f64,
    /// A33 and B33 that are true.
    pub values: [f64; 2],
    /// The budget.
    pub parts: Vec<Part>,
    /// Uncertainties and intervals of the two.
    pub combined: [Combined; 2],
}

/// The intervals to expect of planned runs, wave by wave.
///
/// # Errors
///
/// A window outside of the log, or of too few cycles.
pub fn forecast(
    planned: &[Planned],
    setup: &Setup,
    window_s: [f64; 2],
    sensors: &[SensorSpec],
) -> Result<Vec<Forecast>, TankError> {
    let waves = planned.chunk_by(|a, b| a.rig == b.rig);
    waves.map(|runs| at_wave(runs, setup, window_s, sensors)).collect()
}

fn at_wave(
    runs: &[Planned],
    setup: &Setup,
    [from_s, to_s]: [f64; 2],
    sensors: &[SensorSpec],
) -> Result<Forecast, TankError> {
    let (rig, period_s) = (runs[0].rig, runs[0].period_s);
    // The start is seen when the stroke has come up: at most its ramp later.
    let ends_s = [rig.still_s + rig.ramp_s, rig.lasts_s - rig.ramp_s];
    let cycles = cycles_within(&runs[0].id, [from_s, to_s], ends_s, period_s, 0.0)?;
    let held = runs.iter().filter(|run| run.is_held).count();
    let counts = [held, runs.len() - held];
    let w = rig.omega_rad_s;
    let x = c64::new(rig.restoring_n_m - w * w * (rig.mass_kg + rig.added_kg), w * rig.damping_n_s_m);
    let heave_m = rig.force_n / x.norm_sqr().sqrt();
    let samples = cycles as f64 * period_s * rig.rate_hz;
    let [reference, force, acceleration] = SENSORS.map(|names| reading(sensors, names, 0.0, 1.0));
    let line = |r: Reading, amplitude: f64, samples: f64| {
        2.0 * (r.noise / amplitude).powi(2) / samples * colour(r, w, rig.rate_hz)
    };
    // Phase and frequency of the wavemaker over its even part, carried to the middle of the window: u²(ω) = 12 u²(phase)/T².
    let even_s = rig.lasts_s - (LEFT_OUT[0] + LEFT_OUT[1]) * period_s;
    let middle_s = 0.5 * (rig.lasts_s + (LEFT_OUT[0] - LEFT_OUT[1]) * period_s);
    let away = (0.5 * (from_s + to_s) - middle_s) / even_s;
    let of_wavemaker = line(reference, rig.stroke_m, even_s * rig.rate_hz) * (1.0 + 6.0 * away * away);
    let relative = [line(force, rig.force_n, samples), line(acceleration, w * w * heave_m, samples)];
    let of = |k: usize| {
        let n = counts[k] as f64;
        scatter(k == 0, (relative[k] + of_wavemaker) / n, x, w, DOF * n)
    };
    let errors = errors(x, w, setup, Shows::Acceleration);
    let parts = budget([of(0), of(1)], &errors);
    Ok(Forecast {
        period_s,
        cycles,
        runs: counts,
        heave_m,
        values: [rig.added_kg, rig.damping_n_s_m],
        combined: [0, 1].map(|j| combine(&parts, j, OUTSIDE_95)),
        parts,
    })
}

/// Power of the noise at ω over that of white noise of the same standard deviation.
fn colour(reading: Reading, omega_rad_s: f64, rate_hz: f64) -> f64 {
    let Some(time_s) = reading.correlation_s else { return 1.0 };
    let a = (-1.0 / (rate_hz * time_s)).exp();
    (1.0 - a * a) / (1.0 - 2.0 * a * (omega_rad_s / rate_hz).cos() + a * a)
}

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare: the window before reflections among it.
pub fn prospect(campaign: &Campaign, source: &Source) -> Result<Prospect, MethodError> {
    let setup = setup_of(source)?;
    let planned = planned(&section::plan(source)?, &setup, truth(campaign)?);
    let window_s = setup.window_s.ok_or_else(|| {
        let what = "a plan in waves needs the window that the tank allows: write window = { from = \"14 s\", to = \"20 s\" } in [source.excited_response], from where the wave is at the body until its \
                    reflection is back";
        undeclared(&source.place, what)
    })?;
    let (_, sensors) = seed_and_sensors(campaign, &senses())?;
    let found = forecast(&planned, &setup, window_s, sensors).map_err(MethodError::refused)?;
    let duration_s = planned.iter().map(|run| run.rig.still_s + run.rig.lasts_s).sum();
    let paragraph = format!(
        "{} of {:.1} min in all on the log; the wait for the water to come to rest between them is not counted. The intervals are those at the true coefficients of [simulate], with the noise of \
         [[simulate.sensor]] and everything that is declared.",
        counted(planned.len(), "run", "runs"),
        duration_s / 60.0
    );
    let tables = [matrix(&found, window_s), intervals(&found)];
    Ok(plan::prospect(source, (planned.len(), duration_s), tables, vec![paragraph]))
}

fn matrix(found: &[Forecast], [from_s, to_s]: [f64; 2]) -> ResultTable {
    let caption = format!("Run matrix; the window is from {from_s} s to {to_s} s after the wavemaker's start.");
    let t = TableBuilder::new("matrix", caption, found);
    t.build(vec![
        t.number("period_s", "period [s]", |at| at.period_s).places(3),
        t.count("held_runs", "held runs", |at| at.runs[0]),
        t.count("free_runs", "free runs", |at| at.runs[1]),
        t.count("cycles", "cycles used", |at| at.cycles),
        t.number("heave_m", "heave [mm]", |at| at.heave_m).significant(3),
    ])
}

fn intervals(found: &[Forecast]) -> ResultTable {
    let rows: Vec<(&Forecast, usize)> = found.iter().flat_map(|at| [(at, 0), (at, 1)]).collect();
    let expected = |&(at, j): &(&Forecast, usize)| {
        let law = format!("at {:.3} s", at.period_s);
        Expected::of(&law, (NAMES[j], UNITS[j]), at.values[j], &at.parts, j)
    };
    let mut table = plan::intervals(&rows.iter().map(expected).collect::<Vec<_>>(), "");
    let period = TableBuilder::new("", "", &rows).number("period_s", "period [s]", |(at, _)| at.period_s).places(3);
    table.columns.insert(0, period);
    table
}
