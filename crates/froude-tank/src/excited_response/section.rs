//! `[source.excited_response]`: a body in waves, held in one run and free in the other, and the runs that are planned of it.
//!
//! ```toml
//! [source.excited_response]
//! axis      = "heave"
//! mass      = { value = "46.8 kg", standard = "0.1 kg" }     # all that moves
//! restoring = { value = "2299.5 N/m", standard = "0.5 %" }   # C33: water plane and springs
//! delay     = { value = "0 ms", standard = "1 ms" }          # of the force behind the motion, each as it stands against the wavemaker
//! window    = { from = "14 s", to = "20.5 s" }               # after the wavemaker's start: the wave is there, its reflections are not
//! harmonics = 3
//!
//! [[source.plan]]
//! period = ["1.2 s", "0.8 s"]
//! stroke = "9 mm"                                            # amplitude of the wavemaker
//! force  = "12 N"                                            # amplitude of the exciting force on the held body
//! held   = 1
//! free   = 2
//! ```

use crate::decay::axis::Motion;
use crate::names::EXCITED_RESPONSE;
use froude_identify::method::MethodError;
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::run::{Declared, declared};
use froude_records::section::Section;
use froude_records::section_values::{Asks, MOST_RUNS, at_most, count, one_of, series};
use froude_records::units::Dimension;

use super::setup::{ACCELERATION, FORCE, POSITION, Setup};
use crate::declared::{STIFFNESS, above_zero, gain as gain_of, needed, runs_of, uncertain};
use crate::error::undeclared;
use crate::logs;

/// Most harmonics of a fit.
const MOST_HARMONICS: u64 = 20;

/// One block of planned runs: at every period so many with the body held, and so many with it free.
#[derive(Debug, Clone, PartialEq)]
pub struct ExcitedPlan {
    /// Periods of the wave, s.
    pub period_s: Vec<f64>,
    /// Amplitude of the wavemaker, m.
    pub stroke_m: f64,
    /// Amplitude of the exciting force on the held body, N.
    pub force_n: f64,
    /// Runs with the body held, at each period.
    pub held: usize,
    /// Runs with it free.
    pub free: usize,
    /// At rest on the log before the wavemaker starts, s.
    pub still_s: f64,
    /// The wavemaker comes to its full stroke in this time, s.
    pub ramp_s: f64,
    /// The wave reaches the body so long after the wavemaker's start, s.
    pub travel_s: f64,
    /// The wavemaker runs for so long, and so does the log from there, s.
    pub lasts_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
}

/// Reads `[source.excited_response]`; the errors of the budget are not in it.
pub(super) fn excited(s: &Section<'_>) -> Result<Setup, RecordError> {
    s.only(&["axis", "mass", "restoring", "delay", "window", "harmonics"])?;
    let axis = one_of(s, "axis", &Motion::NAMES, &Motion::ALL)?
        .ok_or_else(|| s.missing("axis", "state what the free body does: axis = \"heave\""))?;
    if let (true, Some(value)) = (axis != Motion::Heave, s.get("axis")) {
        let problem = "is not reduced from waves: only heave of a body that is symmetric fore and aft stands alone, whereas sway and roll (surge and pitch) are coupled by \
                       added masses off the diagonal, which one equation does not hold; write axis = \"heave\"";
        return Err(s.wrong("axis", value, problem));
    }
    let positive = |key: &'static str, dimension, like: &str| {
        above_zero(s, key, dimension)?.map(uncertain).ok_or_else(|| s.missing(key, like))
    };
    let window = s.section("window")?.map(|w| -> Result<[f64; 2], RecordError> {
        w.only(&["from", "to"])?;
        let need = |key: &'static str, like: &str| -> Result<f64, RecordError> {
            w.quantity(key, Dimension::TIME)?.ok_or_else(|| w.missing(key, like))
        };
        let from = need("from", "write from = \"14 s\", counted from the start of the wavemaker")?;
        let to = need("to", "write to = \"20 s\", before the reflected wave is back at the body")?;
        match w.get("to") {
            Some(value) if !(from >= 0.0 && to > from) => Err(w.wrong(
                "to",
                value,
                format!(
                    "makes a window from {from} s to {to} s; it must begin at 0 s or later, and end after its beginning"
                ),
            )),
            _ => Ok([from, to]),
        }
    });
    let mass_kg = positive(
        "mass",
        Dimension::MASS,
        "write mass = { value = \"46.8 kg\", standard = \"0.1 kg\" }, all that moves",
    )?;
    let restoring_n_m = positive(
        "restoring",
        STIFFNESS,
        "write restoring = { value = \"2300 N/m\", standard = \"0.5 %\" }: C33 = rho g times the water plane, and springs",
    )?;
    Ok(Setup {
        delay_s: uncertain(declared(s, "delay", Dimension::TIME)?.unwrap_or(Declared::exact(0.0))),
        window_s: window.transpose()?,
        harmonics: count(s, "harmonics", MOST_HARMONICS)?.unwrap_or(3),
        ..Setup::new(mass_kg, restoring_n_m)
    })
}

/// Everything that the source declares.
///
/// # Errors
///
/// No `[source.excited_response]`, or one that cannot be read; a budget entry of a quantity that this method does not have.
pub fn setup_of(source: &Source) -> Result<Setup, MethodError> {
    let what = "nothing is declared of the body in waves: write [source.excited_response] with axis = \"heave\", mass, restoring, and the window before reflections";
    let mut out = needed(source, EXCITED_RESPONSE, excited, what)?;
    for entry in &source.uncertainty {
        logs::is_of_all_runs(entry)?;
        let gain = match entry.quantity.as_str() {
            "force" | FORCE => &mut out.force_relative,
            ACCELERATION => &mut out.acceleration_relative,
            "position" | POSITION => &mut out.position_relative,
            other => {
                let what = format!(
                    "quantity = {other:?} is none that an excited response has: it has f_z, acceleration and heave; mass, restoring and delay take their standard uncertainties in \
                     [source.excited_response]"
                );
                return Err(undeclared(&entry.place, what));
            }
        };
        *gain = gain_of(entry, "a zero drops out of the harmonics")?;
    }
    Ok(out)
}

/// The runs that a source plans.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan(source: &Source) -> Result<Vec<ExcitedPlan>, RecordError> {
    runs_of(source, EXCITED_RESPONSE, block, |p| {
        let count = p.period_s.len() * (p.held + p.free);
        let lasts_s = p.still_s + p.ramp_s + p.travel_s + p.lasts_s;
        Asks { count, samples: count as f64 * lasts_s * p.rate_hz }
    })
}

/// Reads a `[[source.plan]]` of waves.
fn block(s: &Section<'_>) -> Result<ExcitedPlan, RecordError> {
    s.only(&["period", "stroke", "force", "held", "free", "still", "ramp", "travel", "lasts", "rate"])?;
    let period =
        s.get("period").ok_or_else(|| s.missing("period", "write \"1.2 s\", a list, or { start, stop, step }"))?;
    let need = |key: &'static str, dimension, like: &str| -> Result<f64, RecordError> {
        s.positive(key, dimension)?.ok_or_else(|| s.missing(key, like))
    };
    let runs = |key: &'static str| Ok::<_, RecordError>(count(s, key, MOST_RUNS as u64)?.unwrap_or(1));
    let out = ExcitedPlan {
        period_s: series(s, "period", period, Dimension::TIME)?,
        stroke_m: need("stroke", Dimension::LENGTH, "write stroke = \"9 mm\", the amplitude of the wavemaker")?,
        force_n: need(
            "force",
            Dimension::FORCE,
            "write force = \"12 N\", the amplitude to expect of the exciting force on the held body",
        )?,
        held: runs("held")?,
        free: runs("free")?,
        still_s: s.quantity("still", Dimension::TIME)?.unwrap_or(2.0),
        ramp_s: s.quantity("ramp", Dimension::TIME)?.unwrap_or(2.0),
        travel_s: s.quantity("travel", Dimension::TIME)?.unwrap_or(5.0),
        lasts_s: s.positive("lasts", Dimension::TIME)?.unwrap_or(25.0),
        rate_hz: s.positive("rate", Dimension::ANGULAR_SPEED)?.unwrap_or(200.0),
    };
    if out.period_s.iter().any(|t| *t <= 0.0) {
        return Err(s.wrong("period", period, "must be larger than zero"));
    }
    for (key, time_s) in [("still", out.still_s), ("ramp", out.ramp_s), ("travel", out.travel_s)] {
        if let (true, Some(value)) = (time_s < 0.0, s.get(key)) {
            return Err(s.wrong(key, value, "is negative; a time that passes is not"));
        }
    }
    at_most(&s.place(), &[("period", out.period_s.len()), ("held + free", out.held + out.free)], MOST_RUNS)?;
    Ok(out)
}
