//! `froude carriage tune` and `froude carriage resonance`: experiments on the loop, driven, recorded and read.
//!
//! Tune: a relay's limit cycle and a sweep on the bare carriage; the drive's response, the margins of the loop as it is, gains that keep
//! the usual margins, and Ziegler–Nichols' for comparison. Resonance: the same sweep bare, dry and wet; the load's mode on a held
//! motor, and the shaper that it asks for.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use froude_control::config::{AxisConfig, CountGains, Gains};
use froude_identify::tuning::gains::{Demand, shaped_on_response, ziegler_nichols};
use froude_identify::tuning::margins::{Margins, margins, open_loop};
use froude_identify::tuning::relay::{LimitCycle, limit_cycle};
use froude_identify::tuning::resonance::{Shaper, TwoMassModes, shaper, two_mass_modes};
use froude_identify::tuning::response::{Sweep, plant_response};
use froude_identify::tuning::{LoopGains, ResponsePoint, TuningError};
use froude_records::run::{RunKind, RunLog};
use froude_records::units::Dimension;
use froude_report::chart::{Chart, ChartPanel, Mark, Scale, Series};
use froude_report::document::{Document, DocumentSection, TextTable};
use froude_report::number;
use froude_rig::campaign::plan::{Experiments, resonance, tuning};
use froude_rig::campaign::runner::{Operator, Progress};
use froude_rig::campaign::stop::StopSwitch;

use super::drive::{DriveJob, Prepared, drive, prepare_with};
use super::runs::read;
use crate::Error;

/// Points of a measured response.
const POINTS: usize = 70;
/// State code of an exciting axis in a log (`froude_control::status::Phase`).
const EXCITING: f64 = 4.0;

/// Gains with the margins that they have on the measured response.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Where they come from.
    pub name: String,
    /// In SI.
    pub gains: LoopGains,
    /// The same in counts and ticks of the controller, V per unit.
    pub counts: CountGains,
    /// Margins on the measured response.
    pub margins: Margins,
    /// One encoder count moves the command by this much through the derivative, V.
    pub volts_per_count: f64,
}

/// What tuning found.
#[derive(Debug, Clone)]
pub struct TuneOutcome {
    /// The drive's response.
    pub plant: Vec<ResponsePoint>,
    /// The relay's limit cycle, where it made one.
    pub cycle: Result<LimitCycle, TuningError>,
    /// As configured, as proposed, Ziegler–Nichols.
    pub candidates: Vec<Candidate>,
    /// Where the page lies.
    pub page: PathBuf,
}

/// The load's mode in one state of the body.
#[derive(Debug, Clone)]
pub struct StateModes {
    /// `none`, `dry`, `wet`.
    pub body: String,
    /// The drive's response.
    pub plant: Vec<ResponsePoint>,
    /// Both modes.
    pub modes: Result<TwoMassModes, TuningError>,
}

/// What the resonance experiment found.
#[derive(Debug, Clone)]
pub struct ResonanceOutcome {
    /// By state of the body.
    pub states: Vec<StateModes>,
    /// Mode to shape for, Hz, and its damping: the middle of dry and wet.
    pub proposed: Option<(f64, f64)>,
    /// The robust shaper for it.
    pub shaper: Option<Shaper>,
    /// Where the page lies.
    pub page: PathBuf,
}

/// Drives relay and sweep, and proposes gains.
///
/// # Errors
///
/// See [`Error`].
pub fn tune(
    job: &DriveJob,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
) -> Result<TuneOutcome, Error> {
    let experiments = Experiments::default();
    let prepared = prepare_with(&with_folder(job, "tune"), &|asked, start_m, _| tuning(asked, start_m, &experiments))?;
    drive(&prepared, switch, operator, progress)?;
    let runs = read(std::slice::from_ref(&prepared.folder), &[RunKind::Relay, RunKind::Sweep], None)?;
    let axis = prepared.axis();
    let sweep = runs.logs.iter().find(|l| l.meta.kind == RunKind::Sweep);
    let plant =
        response_of(sweep.ok_or_else(|| Error::Nothing("the sweep was not recorded".to_owned()))?, axis, &experiments)?;
    let cycle = runs
        .logs
        .iter()
        .find(|l| l.meta.kind == RunKind::Relay)
        .map_or(Err(TuningError::TooFew { what: "relay runs", found: 0, least: 1, advice: "drive one" }), |log| {
            cycle_of(log, axis, &experiments)
        });
    let rated = |name: &str, gains: LoopGains| candidate(name, gains, axis, prepared.tick_us(), &plant);
    let configured = axis.gains;
    let mut candidates = vec![rated(
        "as configured",
        LoopGains {
            proportional_v_rad: configured.proportional_v_rad,
            derivative_v_s_rad: configured.derivative_v_s_rad,
            integral_v_rad_s: configured.integral_v_rad_s,
            derivative_filter_hz: configured.derivative_filter_hz,
        },
    )];
    if let Ok(gains) = shaped_on_response(&plant, &Demand::default()) {
        candidates.push(rated("loop shaping on the measured response", gains));
    }
    if let Ok(cycle) = &cycle {
        candidates.push(rated("Ziegler–Nichols (1942)", ziegler_nichols(cycle)));
    }
    let mut outcome = TuneOutcome { plant, cycle, candidates, page: prepared.folder.join("report.html") };
    outcome.page = write(&prepared.folder, &tune_document(&outcome, &prepared, &job.date))?;
    Ok(outcome)
}

/// Drives a sweep bare, dry and wet, and proposes a shaper.
///
/// # Errors
///
/// See [`Error`].
pub fn find_resonance(
    job: &DriveJob,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
) -> Result<ResonanceOutcome, Error> {
    let experiments = Experiments::default();
    let prepared =
        prepare_with(&with_folder(job, "resonance"), &|asked, start_m, _| resonance(asked, start_m, &experiments))?;
    drive(&prepared, switch, operator, progress)?;
    let runs = read(std::slice::from_ref(&prepared.folder), &[RunKind::Sweep], None)?;
    let states = runs
        .logs
        .iter()
        .map(|log| {
            let plant = response_of(log, prepared.axis(), &experiments)?;
            let modes = two_mass_modes(&plant);
            Ok(StateModes { body: log.meta.body.name().to_owned(), plant, modes })
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let towed: Vec<&TwoMassModes> =
        states.iter().filter(|s| s.body != "none").filter_map(|s| s.modes.as_ref().ok()).collect();
    let proposed = (!towed.is_empty()).then(|| {
        let n = towed.len() as f64;
        // The geometric middle: equally wrong for both, relatively.
        let ln_hz = towed.iter().map(|m| m.load.frequency_hz.ln()).sum::<f64>() / n;
        (ln_hz.exp(), towed.iter().map(|m| m.load.damping).sum::<f64>() / n)
    });
    let shaper = proposed.and_then(|(frequency_hz, damping)| {
        let middle = towed.first()?.load;
        Some(shaper(&froude_identify::tuning::resonance::Mode { frequency_hz, damping, ..middle }, true))
    });
    let mut outcome = ResonanceOutcome { states, proposed, shaper, page: PathBuf::new() };
    outcome.page = write(&prepared.folder, &resonance_document(&outcome, &prepared, &job.date))?;
    Ok(outcome)
}

fn with_folder(job: &DriveJob, what: &str) -> DriveJob {
    let stem = job.campaign.file_stem().map_or_else(|| "campaign".to_owned(), |s| s.to_string_lossy().into_owned());
    let out = job.out.clone().unwrap_or_else(|| job.campaign.with_file_name(format!("{stem}-{what}")));
    DriveJob { out: Some(out), ..job.clone() }
}

fn write(folder: &Path, document: &Document) -> Result<PathBuf, Error> {
    let path = folder.join("report.html");
    froude_records::write::write_atomically(&path, document.html()?.as_bytes())?;
    Ok(path)
}

/// Columns of the moving axis in its own units: command, motor angle, and the rows of the excitation.
struct Excited {
    rate_hz: f64,
    command_v: Vec<f64>,
    angle_rad: Vec<f64>,
    /// First and last row of the excitation.
    rows: std::ops::Range<usize>,
}

/// `speed_m_s`: the reference below a sweep; `None` where the loop is open.
fn excited(log: &RunLog, axis: &AxisConfig, speed_m_s: Option<f64>) -> Result<Excited, Error> {
    let name = log.meta.axis.name();
    let column = |what: &str, dimension| log.channel(&format!("{name}/{what}"), dimension);
    let state = column("state", Dimension::ONE)?;
    let reference = column("reference_velocity", Dimension::SPEED)?;
    let rad_m = axis.drive.gear_ratio / axis.drive.sprocket_radius_m;
    let is_on = |i: usize| state[i] == EXCITING && speed_m_s.is_none_or(|v| (reference[i] - v).abs() <= 1e-6);
    let first = (0..state.len()).find(|&i| is_on(i)).unwrap_or(0);
    let end = (first..state.len()).rfind(|&i| is_on(i)).map_or(first, |i| i + 1);
    Ok(Excited {
        rate_hz: log.sample_rate_hz().unwrap_or(0.0),
        command_v: column("command", Dimension::VOLTAGE)?.to_vec(),
        angle_rad: column("position", Dimension::LENGTH)?.iter().map(|y| y * rad_m).collect(),
        rows: first..end,
    })
}

fn response_of(log: &RunLog, axis: &AxisConfig, e: &Experiments) -> Result<Vec<ResponsePoint>, Error> {
    let columns = excited(log, axis, Some(e.sweep_m_s))?;
    let rows = columns.rows.clone();
    let sweep = Sweep {
        rate_hz: columns.rate_hz,
        from_hz: e.sweep_hz[0],
        to_hz: e.sweep_hz[1],
        duration_s: e.sweep_s,
        volts: e.sweep_v,
        command_v: &columns.command_v[rows.clone()],
        angle_rad: &columns.angle_rad[rows],
    };
    Ok(plant_response(&sweep, POINTS)?)
}

fn cycle_of(log: &RunLog, axis: &AxisConfig, e: &Experiments) -> Result<LimitCycle, TuningError> {
    let failed = |_| TuningError::TooFew { what: "relay columns", found: 0, least: 1, advice: "drive the relay again" };
    let columns = excited(log, axis, None).map_err(failed)?;
    let hysteresis_rad = e.hysteresis_m * axis.drive.gear_ratio / axis.drive.sprocket_radius_m;
    let rows = columns.rows.clone();
    limit_cycle(columns.rate_hz, e.relay_v, hysteresis_rad, &columns.command_v[rows.clone()], &columns.angle_rad[rows])
}

fn candidate(name: &str, gains: LoopGains, axis: &AxisConfig, tick_us: u32, plant: &[ResponsePoint]) -> Candidate {
    let si = Gains {
        proportional_v_rad: gains.proportional_v_rad,
        derivative_v_s_rad: gains.derivative_v_s_rad,
        integral_v_rad_s: gains.integral_v_rad_s,
        derivative_filter_hz: gains.derivative_filter_hz,
    };
    // One count at the input of the filtered derivative: its corner, at most one tick's difference.
    let count_rad = TAU / axis.drive.counts_per_revolution;
    let rate_1_s = (TAU * gains.derivative_filter_hz).min(1e6 / f64::from(tick_us));
    Candidate {
        name: name.to_owned(),
        gains,
        counts: CountGains::from_si(&si, axis.drive.counts_per_revolution, tick_us, 1.0),
        margins: margins(plant, &gains),
        volts_per_count: count_rad * (gains.proportional_v_rad + gains.derivative_v_s_rad * rate_1_s),
    }
}

/// Gains, margins and what a count of the encoder does to the command.
#[must_use]
pub fn candidates_table(candidates: &[Candidate]) -> TextTable {
    let digits = |x: f64| number::significant(x, 3);
    let some = |x: Option<f64>, scale: f64| x.map_or_else(|| number::MISSING.to_owned(), |x| digits(scale * x));
    TextTable {
        caption: "Gains of MCD eq. 6 in SI and per count and tick (V), with their margins on the measured response."
            .to_owned(),
        head: [
            "gains",
            "K_p [V/rad]",
            "K_d [V s/rad]",
            "K_i [V/(rad s)]",
            "K_p [V/count]",
            "K_d [V s/count]",
            "K_i [V/(count tick)]",
            "crossover [Hz]",
            "phase margin [°]",
            "gain margin [1]",
            "delay margin [ms]",
            "largest sensitivity [1]",
            "command per count [V]",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: candidates
            .iter()
            .map(|c| {
                vec![
                    c.name.clone(),
                    digits(c.gains.proportional_v_rad),
                    digits(c.gains.derivative_v_s_rad),
                    digits(c.gains.integral_v_rad_s),
                    digits(c.counts.proportional),
                    digits(c.counts.derivative),
                    digits(c.counts.integral),
                    some(c.margins.crossover_hz, 1.0),
                    some(c.margins.phase_rad, 180.0 / std::f64::consts::PI),
                    some(c.margins.gain, 1.0),
                    some(c.margins.delay_s, 1e3),
                    digits(c.margins.largest_sensitivity),
                    digits(c.volts_per_count),
                ]
            })
            .collect(),
    }
}

fn tune_document(outcome: &TuneOutcome, prepared: &Prepared, date: &str) -> Document {
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
        Ok(c) => format!(
            "The relay's limit cycle: {} periods of {} s (± {} s), amplitude {} rad; K_u = {} V/rad at {} Hz.",
            c.cycles,
            number::plain(c.period_s, 4),
            number::significant(c.period_std_s, 1),
            number::plain(c.amplitude_rad, 3),
            number::plain(c.ultimate_gain_v_rad, 3),
            number::plain(1.0 / c.period_s, 3)
        ),
        Err(error) => format!("The relay gave no limit cycle: {error}."),
    };
    Document {
        sort: "Carriage · tuning".to_owned(),
        title: prepared.name().to_owned(),
        date: Some(date.to_owned()),
        sections: vec![DocumentSection {
            title: "Gains".to_owned(),
            paragraphs: vec![cycle],
            tables: vec![candidates_table(&outcome.candidates)],
            charts: vec![Chart {
                name: "bode".to_owned(),
                title: "Open loop".to_owned(),
                caption: "Open loop L = C·P: the controller's own response times the measured one of the drive."
                    .to_owned(),
                x_label: "frequency [Hz]".to_owned(),
                x_scale: Scale::Logarithmic,
                panels: panels.to_vec(),
            }],
        }],
        ..Document::default()
    }
}

/// Modes by state of the body.
#[must_use]
pub fn modes_table(states: &[StateModes]) -> TextTable {
    let missing = || number::MISSING.to_owned();
    TextTable {
        caption: "Modes from the motor's side: the load on a held motor (to shape for) and both masses free."
            .to_owned(),
        head: [
            "body",
            "load's mode [Hz]",
            "damping [1]",
            "free mode [Hz]",
            "damping [1]",
            "inertia ratio [1]",
            "left unexplained",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: states
            .iter()
            .map(|s| match &s.modes {
                Ok(m) => vec![
                    s.body.clone(),
                    number::short_form(m.load.frequency_hz, m.load.frequency_std_hz),
                    number::short_form(m.load.damping, m.load.damping_std),
                    number::short_form(m.free.frequency_hz, m.free.frequency_std_hz),
                    number::short_form(m.free.damping, m.free.damping_std),
                    number::plain(m.inertia_ratio, 3),
                    number::percent(m.relative_residual),
                ],
                Err(_) => std::iter::once(s.body.clone()).chain((0..6).map(|_| missing())).collect(),
            })
            .collect(),
    }
}

/// What to put into the campaign, and why not 13 Hz.
#[must_use]
pub fn resonance_sentences(outcome: &ResonanceOutcome) -> Vec<String> {
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
            "Proposed: [rig.y.controller] shaped_mode = \"{hz:.2} Hz\", shaped_damping = \"{damping:.3} 1\", robust_shaper = true. It adds {:.0} ms \
             to a move. Of the swing it leaves, at the modes measured: {}; at most {} at a mode 10 % off its own.",
            1e3 * shaper.added_s,
            left.join(", "),
            number::percent(shaper.residual_10_percent_low.max(shaper.residual_10_percent_high))
        ));
        out.push(
            "The free mode, which the motor's current shows, is not the one to shape for: a stiff position loop holds the motor still, \
             and the load swings on the chain at √(K_e/M)/2π. Shaping for the free mode leaves that swing as it was."
                .to_owned(),
        );
    }
    out
}

fn resonance_document(outcome: &ResonanceOutcome, prepared: &Prepared, date: &str) -> Document {
    let series = |s: &StateModes| Series {
        name: s.body.clone(),
        mark: Mark::Line,
        x: s.plant.iter().map(|p| p.frequency_hz).collect(),
        y: s.plant.iter().map(|p| p.plant_rad_v.norm() * (TAU * p.frequency_hz).powi(2)).collect(),
        ..Series::default()
    };
    Document {
        sort: "Carriage · resonance".to_owned(),
        title: prepared.name().to_owned(),
        date: Some(date.to_owned()),
        sections: vec![DocumentSection {
            title: "Modes".to_owned(),
            paragraphs: resonance_sentences(outcome),
            tables: vec![modes_table(&outcome.states)],
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
        }],
        ..Document::default()
    }
}
