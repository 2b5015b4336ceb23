//! `froude carriage tune` and `froude carriage resonance`: experiments on the loop, driven, recorded and read.
//!
//! Tune: a relay's limit cycle and a sweep on the bare carriage; the drive's response, the margins of the loop as it is, gains that keep
//! the usual margins, and Ziegler–Nichols' for comparison. Resonance: the same sweep bare, dry and wet; the load's mode on a held
//! motor, and the shaper that it asks for.

use std::f64::consts::TAU;
use std::path::PathBuf;

use froude_carriage::tuning::gains::{Demand, Encoder, shaped_on_response, ziegler_nichols};
use froude_carriage::tuning::margins::{Margins, margins, open_loop};
use froude_carriage::tuning::relay::{LimitCycle, limit_cycle};
use froude_carriage::tuning::resonance::{Shaper, TwoMassModes, shaper, two_mass_modes};
use froude_carriage::tuning::response::{Sweep, plant_response};
use froude_carriage::tuning::tracking::{Forward, Ramp, Tracking, follow};
use froude_carriage::tuning::{LoopGains, ResponsePoint, TuningError};
use froude_control::config::{AxisConfig, CountGains, Gains};
use froude_records::carriage::plan::{Experiments, resonance, tuning};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Scale, Series, TextTable};
use froude_records::run::{Declared, Role, RunLog};
use froude_records::units::Dimension;
use froude_report::document::Document;
use froude_rig::campaign::runner::{Operator, Progress};
use froude_rig::campaign::stop::StopSwitch;

use super::drive::{DriveJob, Prepared, drive, prepare_with};
use crate::Error;
use froude_carriage::runs::read;

/// Points of a measured response.
const POINTS: usize = 70;
/// The sweep below the margins, Hz: from well below the chain to well above the crossover of a loop that is stiff against it.
const TUNING_HZ: [f64; 2] = [2.0, 150.0];
/// Part of the way to a fault that a foreseen ramp may take: what the two masses do not know (stiction, the gear) is the rest.
const TRACKING_PART: f64 = 0.7;
/// Time at the speed of a ramp that is foreseen, s: several swings of the heaviest load.
const HOLD_S: f64 = 1.0;
/// As in `froude_control`: reference speed at which the friction feed-forward is whole, m/s; corner of the limits' speed estimate, Hz.
const FULL_FRICTION_M_S: f64 = 2e-3;
const SPEED_FILTER_HZ: f64 = 80.0;
/// State code of an exciting axis in a log (`froude_control::status::Phase`).
const EXCITING: f64 = 4.0;

/// Gains with the margins that they have on the measured response, and what they do to the campaign's ramps.
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
    /// Margins with the heaviest body, on the fitted two-mass model; `None` where there is none.
    pub heaviest: Option<Margins>,
    /// Lowest mode of a load on a held motor, Hz: that of the heaviest body.
    pub lowest_load_hz: Option<f64>,
    /// The measured band did not hold the whole loop: beyond it the margins are the fitted two-mass model's.
    pub is_extended: bool,
    /// One encoder count moves the command by this much through the derivative, V.
    pub volts_per_count: f64,
    /// Largest following error in homing and towing, m, on the fitted two-mass model; `None` where there is none.
    pub following_error_m: Option<f64>,
    /// Largest speed of the motor in homing, m/s, likewise.
    pub homing_m_s: Option<f64>,
    /// Objections to them; none if they are fit for the campaign.
    pub objections: Vec<String>,
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
    /// Which of them to use.
    pub recommended: Option<usize>,
    /// Measured band, Hz.
    pub band_hz: [f64; 2],
    /// Why no gains could be shaped on the response.
    pub unshaped: Option<TuningError>,
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
    /// Declared efficiency of the gear when the motor drives.
    pub efficiency: Option<Declared>,
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
    let experiments = Experiments { sweep_hz: TUNING_HZ, ..Experiments::default() };
    let prepared = prepare_with(&with_folder(job, "tune"), &|asked, start_m, _| tuning(asked, start_m, &experiments))?
        .logging_every_tick();
    crate::results::can_be_written(&report_of(&prepared))?;
    drive(&prepared, switch, operator, progress)?.whole()?;
    let runs = read(std::slice::from_ref(&prepared.folder), &[Role::Relay, Role::Sweep], None)?;
    let axis = prepared.axis();
    let sweep = runs.logs.iter().find(|l| l.meta.role == Role::Sweep);
    let plant =
        response_of(sweep.ok_or_else(|| Error::Nothing("the sweep was not recorded".to_owned()))?, axis, &experiments)?;
    let cycle = runs
        .logs
        .iter()
        .find(|l| l.meta.role == Role::Relay)
        .map_or(Err(TuningError::TooFew { what: "relay runs", found: 0, least: 1, advice: "drive one" }), |log| {
            cycle_of(log, axis, &experiments)
        });
    let bench = Bench::new(&prepared, &plant);
    let load_hz = bench.heaviest().map_or(f64::INFINITY, |m| m.load.frequency_hz);
    let configured = axis.gains;
    let mut candidates = vec![bench.candidate(
        "as configured",
        LoopGains {
            proportional_v_rad: configured.proportional_v_rad,
            derivative_v_s_rad: configured.derivative_v_s_rad,
            integral_v_rad_s: configured.integral_v_rad_s,
            derivative_filter_hz: configured.derivative_filter_hz,
            tick_s: bench.encoder.tick_s,
        },
    )];
    let mut unshaped = None;
    match shaped_on_response(&plant, load_hz, &Demand::default(), &bench.encoder) {
        Ok(gains) => candidates.push(bench.candidate("shaped on the response", gains)),
        Err(error) => unshaped = Some(error),
    }
    if let Ok(cycle) = &cycle {
        candidates.push(bench.candidate("Ziegler–Nichols (1942)", ziegler_nichols(cycle, bench.encoder.tick_s)));
    }
    // What was shaped, then what is there already; Ziegler–Nichols' is for comparison.
    let recommended = [1, 0]
        .into_iter()
        .find(|&i| candidates.get(i).is_some_and(|c| c.objections.is_empty()) && (i == 0 || unshaped.is_none()));
    let band_hz = [plant[0].frequency_hz, plant[plant.len() - 1].frequency_hz];
    let mut outcome = TuneOutcome { plant, cycle, candidates, recommended, band_hz, unshaped, page: PathBuf::new() };
    let html = tune_document(&outcome, &prepared, &job.date).html()?;
    outcome.page = crate::results::write_page(&report_of(&prepared), &html)?;
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
    crate::results::can_be_written(&report_of(&prepared))?;
    drive(&prepared, switch, operator, progress)?.whole()?;
    let runs = read(std::slice::from_ref(&prepared.folder), &[Role::Sweep], None)?;
    let states = runs
        .logs
        .iter()
        .map(|log| {
            let plant = response_of(log, prepared.axis(), &experiments)?;
            let modes = two_mass_modes(&plant);
            Ok(StateModes { body: log.meta.mounted.body.name().to_owned(), plant, modes })
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
        Some(shaper(&froude_carriage::tuning::resonance::Mode { frequency_hz, damping, ..middle }, true))
    });
    let mut outcome =
        ResonanceOutcome { states, efficiency: prepared.efficiency(), proposed, shaper, page: PathBuf::new() };
    let html = resonance_document(&outcome, &prepared, &job.date).html()?;
    outcome.page = crate::results::write_page(&report_of(&prepared), &html)?;
    Ok(outcome)
}

fn with_folder(job: &DriveJob, what: &str) -> DriveJob {
    let stem = job.campaign.file_stem().map_or_else(|| "campaign".to_owned(), |s| s.to_string_lossy().into_owned());
    let out = job.out.clone().unwrap_or_else(|| job.campaign.with_file_name(format!("{stem}-{what}")));
    DriveJob { out: Some(out), ..job.clone() }
}

/// Beside the runs, in a folder of its own: it is replaced as a whole, and runs never are.
fn report_of(prepared: &Prepared) -> PathBuf {
    prepared.folder.join("report")
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
    let name = log.meta.carriage.axis.name();
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

/// The requirements on candidates.
struct Bench<'a> {
    plant: &'a [ResponsePoint],
    modes: Option<TwoMassModes>,
    axis: &'a AxisConfig,
    encoder: Encoder,
    forward: Forward,
    /// The heaviest load over the bare one.
    load_factor: f64,
    ramps: Vec<(bool, f64, Ramp)>,
}

impl<'a> Bench<'a> {
    fn new(prepared: &'a Prepared, plant: &'a [ResponsePoint]) -> Self {
        let axis = prepared.axis();
        let (drive, limits) = (&axis.drive, &axis.limits);
        let rad_m = drive.gear_ratio / drive.sprocket_radius_m;
        let per_v = 1.0 / (drive.torque_constant_n_m_a * drive.amplifier_a_v);
        let count_rad = TAU / drive.counts_per_revolution;
        let coulomb_v = drive.coulomb_n_m * per_v;
        let modes = two_mass_modes(plant).ok();
        // The heaviest body against the bare load.
        let motor_kg_m2 = modes.map_or(0.0, |m| drive.inertia_kg_m2 / (1.0 + m.inertia_ratio));
        let heaviest = ((drive.coast_inertia_kg_m2 - motor_kg_m2) / (drive.inertia_kg_m2 - motor_kg_m2)).max(1.0);
        let (fastest_m_s, acceleration_m_s2) = prepared.hardest_ramp();
        let mut ramps = Vec::new();
        for load_factor in [1.0, heaviest] {
            for friction_v in [drive.coulomb_lower_n_m * per_v, coulomb_v] {
                for (is_homing, speed_m_s, acceleration_m_s2) in [
                    (true, limits.unhomed_speed_m_s, limits.acceleration_m_s2),
                    (false, fastest_m_s, acceleration_m_s2),
                ] {
                    let (speed_rad_s, acceleration_rad_s2) = (speed_m_s * rad_m, acceleration_m_s2 * rad_m);
                    let ramp = Ramp { speed_rad_s, acceleration_rad_s2, hold_s: HOLD_S, friction_v };
                    ramps.push((is_homing, load_factor, ramp));
                }
            }
        }
        Self {
            plant,
            modes,
            axis,
            encoder: Encoder { count_rad, most_v: coulomb_v, tick_s: 1e-6 * f64::from(prepared.tick_us()) },
            forward: Forward {
                inertia_v_s2_rad: drive.inertia_kg_m2 * per_v,
                viscous_v_s_rad: drive.viscous_n_m_s_rad * per_v,
                coulomb_v,
                full_friction_rad_s: FULL_FRICTION_M_S * rad_m,
                limit_v: limits.command_v.min(limits.current_a / drive.amplifier_a_v),
                count_rad,
                speed_filter_hz: SPEED_FILTER_HZ,
            },
            load_factor: heaviest,
            ramps,
        }
    }

    /// The model with the heaviest body.
    fn heaviest(&self) -> Option<TwoMassModes> {
        self.modes.as_ref().map(|m| m.with_load(self.load_factor))
    }

    /// From a decade below what was measured to half the sampling rate.
    fn model_band_hz(&self) -> [f64; 2] {
        [0.1 * self.plant[0].frequency_hz, 0.5 / self.encoder.tick_s]
    }

    fn candidate(&self, name: &str, gains: LoopGains) -> Candidate {
        let si = Gains {
            proportional_v_rad: gains.proportional_v_rad,
            derivative_v_s_rad: gains.derivative_v_s_rad,
            integral_v_rad_s: gains.integral_v_rad_s,
            derivative_filter_hz: gains.derivative_filter_hz,
        };
        let mut found = margins(self.plant, &gains);
        let mut is_extended = false;
        if let Some(modes) = self.modes.as_ref().filter(|_| !found.is_whole()) {
            let extended = modes.extended(self.plant, self.model_band_hz());
            (found, is_extended) = (margins(&extended, &gains), true);
        }
        let chain_m = self.axis.drive.sprocket_radius_m / self.axis.drive.gear_ratio;
        let worst = |is_asked: &dyn Fn(bool) -> bool| {
            let modes = self.modes.as_ref()?;
            let ramps = self.ramps.iter().filter(|r| is_asked(r.0));
            Some(
                ramps
                    .map(|r| follow(&modes.with_load(r.1), &gains, &self.forward, &r.2))
                    .fold(Tracking::default(), Tracking::or),
            )
        };
        let counts_per_revolution = self.axis.drive.counts_per_revolution;
        let tick_us = (1e6 * self.encoder.tick_s).round() as u32;
        let mut out = Candidate {
            name: name.to_owned(),
            gains,
            counts: CountGains::from_si(&si, counts_per_revolution, tick_us, 1.0),
            margins: found,
            lowest_load_hz: self.heaviest().map(|m| m.load.frequency_hz),
            heaviest: self.heaviest().map(|m| margins(&m.extended(&[], self.model_band_hz()), &gains)),
            is_extended,
            volts_per_count: gains.volts_per_count(self.encoder.count_rad),
            following_error_m: worst(&|_| true).map(|t| t.error_rad * chain_m),
            homing_m_s: worst(&|is_homing| is_homing).map(|t| t.speed_rad_s * chain_m),
            objections: Vec::new(),
        };
        out.objections = self.objections(&out);
        out
    }

    /// What the margins, the encoder and the campaign's ramps say against gains.
    fn objections(&self, c: &Candidate) -> Vec<String> {
        let limits = &self.axis.limits;
        let digits = |x: f64| number::significant(x, 3);
        let mut out = against_margins(&c.margins);
        if let Some(heaviest) = &c.heaviest {
            // Stable, no more: a light damping brings a stiff loop close to −1 at the load's mode, where it moves the motor by nothing.
            if heaviest.phase_rad.is_none_or(|x| x <= 0.0) {
                out.push("unstable with the heaviest body".to_owned());
            }
        }
        if c.volts_per_count > self.encoder.most_v {
            out.push(format!(
                "an encoder count moves the command by {} V, more than friction's {} V",
                digits(c.volts_per_count),
                digits(self.encoder.most_v)
            ));
        }
        match (c.following_error_m, c.homing_m_s) {
            (Some(error_m), Some(homing_m_s)) => {
                if error_m > TRACKING_PART * limits.following_error_m {
                    out.push(format!(
                        "following error up to {} mm in the ramps, the fault comes at {} mm",
                        digits(1e3 * error_m),
                        digits(1e3 * limits.following_error_m)
                    ));
                }
                let over_m_s = limits.over_speed_m_s(false);
                if homing_m_s > limits.unhomed_speed_m_s + TRACKING_PART * (over_m_s - limits.unhomed_speed_m_s) {
                    out.push(format!(
                        "the motor swings on its chain up to {} mm/s in homing at {} mm/s, over-speed comes at {} mm/s",
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
            "phase margin {:.0}°, {:.0}° are asked for",
            phase.to_degrees(),
            demand.phase_rad.to_degrees()
        )),
        None => out.push("no crossover: the loop gain stays below 1".to_owned()),
        Some(_) => {}
    }
    if let Some(gain) = m.gain.filter(|&g| g < demand.gain) {
        out.push(format!("gain margin {}, {} is asked for", digits(gain), digits(demand.gain)));
    }
    if let Some(gain) = m.gain_reduction.filter(|g| g * demand.gain > 1.0) {
        out.push(format!("unstable already at {} of its gain", number::percent(gain)));
    }
    if m.largest_sensitivity > demand.sensitivity {
        let (is, may) = (digits(m.largest_sensitivity), digits(demand.sensitivity));
        out.push(format!("maximum sensitivity {is}, {may} is allowed"));
    }
    out
}

/// Gains, margins, what a count of the encoder does to the command, and the ramps; a column for each candidate.
#[must_use]
pub fn candidates_table(outcome: &TuneOutcome) -> TextTable {
    type Of = fn(&Candidate) -> Option<f64>;
    let quantities: [(&str, Of); 19] = [
        ("K_p [V/rad]", |c| Some(c.gains.proportional_v_rad)),
        ("K_d [V s/rad]", |c| Some(c.gains.derivative_v_s_rad)),
        ("K_i [V/(rad s)]", |c| Some(c.gains.integral_v_rad_s)),
        ("derivative filter [Hz]", |c| Some(c.gains.derivative_filter_hz)),
        ("K_p [V/count]", |c| Some(c.counts.proportional)),
        ("K_d [V s/count]", |c| Some(c.counts.derivative)),
        ("K_i [V/(count tick)]", |c| Some(c.counts.integral)),
        ("command per count [V]", |c| Some(c.volts_per_count)),
        ("crossover [Hz]", |c| c.margins.crossover_hz),
        ("phase margin [°]", |c| c.margins.phase_rad.map(f64::to_degrees)),
        ("gain margin [1]", |c| c.margins.gain),
        ("gain may fall to [1]", |c| c.margins.gain_reduction),
        ("delay margin [ms]", |c| c.margins.delay_s.map(|s| 1e3 * s)),
        ("maximum sensitivity [1]", |c| Some(c.margins.largest_sensitivity)),
        ("phase margin, heaviest body [°]", |c| c.heaviest?.phase_rad.map(f64::to_degrees)),
        ("integral feeds swings below [Hz]", |c| Some(c.gains.feeding_hz())),
        ("following error in ramps [mm]", |c| c.following_error_m.map(|m| 1e3 * m)),
        ("motor's speed in homing [mm/s]", |c| c.homing_m_s.map(|v| 1e3 * v)),
        ("objections", |c| Some(c.objections.len() as f64)),
    ];
    let cell = |x: Option<f64>| x.map_or_else(|| number::MISSING.to_owned(), |x| number::significant(x, 3));
    let names = outcome.candidates.iter().map(|c| c.name.clone());
    TextTable {
        caption: format!(
            "Gains of MCD eq. 6 in SI and per count and tick (V); margins on the response measured from {:.1} to {:.0} Hz; following error and speed of the motor from the campaign's hardest ramps, bare and with the heaviest body, run through the two masses that the response shows. A margin without a value: the loop does not cross there.",
            outcome.band_hz[0], outcome.band_hz[1]
        ),
        head: std::iter::once("quantity".to_owned()).chain(names).collect(),
        rows: quantities
            .iter()
            .map(|(name, of)| match *name {
                "objections" => std::iter::once((*name).to_owned())
                    .chain(outcome.candidates.iter().map(|c| c.objections.len().to_string()))
                    .collect(),
                _ => {
                    std::iter::once((*name).to_owned()).chain(outcome.candidates.iter().map(|c| cell(of(c)))).collect()
                }
            })
            .collect(),
    }
}

/// Objections to each candidate, where its margins come from, and what to write into the campaign.
#[must_use]
pub fn tune_sentences(outcome: &TuneOutcome) -> Vec<String> {
    let mut out = Vec::new();
    for c in &outcome.candidates {
        if c.is_extended {
            out.push(format!(
                "{}: its loop is not whole within the measured {:.1} to {:.0} Hz; its margins beyond are the fitted two-mass model's.",
                c.name, outcome.band_hz[0], outcome.band_hz[1]
            ));
        }
        if let Some(load_hz) = c.lowest_load_hz.filter(|hz| *hz < c.gains.feeding_hz()) {
            out.push(format!(
                "{}: below {:.1} Hz the integral's lag is more than the derivative's lead, and the load with the heaviest body swings at \
                 {load_hz:.1} Hz: the loop feeds that swing, friction alone damps it. K_i below {} V/(rad s) would not.",
                c.name,
                c.gains.feeding_hz(),
                number::significant(c.gains.derivative_v_s_rad * (TAU * load_hz).powi(2), 2)
            ));
        }
        if !c.objections.is_empty() {
            out.push(format!("{}: {}.", c.name, c.objections.join("; ")));
        }
    }
    out.extend(outcome.unshaped.as_ref().map(|e| format!("Nothing was shaped on the response: {e}.")));
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
                out.push(
                    "The gains as configured also meet every requirement: there is no need to change them.".to_owned(),
                );
            }
        }
        None => out.push("None of these gains is recommended.".to_owned()),
    }
    out
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
            paragraphs: std::iter::once(cycle).chain(tune_sentences(outcome)).collect(),
            tables: vec![candidates_table(outcome)],
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

/// Free mode without the gear's loss, Hz, and its standard uncertainty; `None` where no efficiency is declared.
#[must_use]
pub fn free_without_loss(modes: &TwoMassModes, efficiency: Option<Declared>) -> Option<(f64, f64)> {
    efficiency.map(|e| modes.free_through_gear(e.value, e.standard_uncertainty))
}

/// Modes by state of the body.
#[must_use]
pub fn modes_table(outcome: &ResonanceOutcome) -> TextTable {
    let missing = || number::MISSING.to_owned();
    let mut rows: Vec<Vec<String>> = [
        "load's mode [Hz]",
        "its damping [1]",
        "free mode, seen through the driving gear [Hz]",
        "its damping [1]",
        "free mode, corrected for the gear's loss [Hz]",
        "load over motor inertia, seen [1]",
        "the same, corrected for the gear's loss [1]",
        "unexplained part of the response",
        "the same, median of the points",
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
        caption: "Modes from the motor's side: the load on a held motor (to shape for) and both masses free."
            .to_owned(),
        head: std::iter::once("mode".to_owned()).chain(outcome.states.iter().map(body)).collect(),
        rows,
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
    if outcome.states.iter().any(|s| s.modes.is_ok()) {
        out.push(match outcome.efficiency {
            Some(e) => format!(
                "The free mode is seen through a gear that drives: the sweep rides on a steady motion, so that the motor feels the chain's force \
                 over η, and f_a² = f_l² (1 + R/η). With the declared η = {} the loss is taken out, f² = f_l² (1 + η R_a); the uncertainty of η \
                 is in its figure. The load's mode does not depend on η.",
                number::short_form(e.value, e.standard_uncertainty)
            ),
            None => "The free mode is only apparent: the sweep rides on a steady motion, so that the motor feels the chain's force over the gear's \
                     efficiency η, and f_a² = f_l² (1 + R/η). Declare `efficiency` in [rig.y] and the loss is taken out. The load's mode does \
                     not depend on η."
                .to_owned(),
        });
        out.push(
            "The unexplained part is the root mean square of |model/measured − 1| over the points with a coherence above 0.8. Much of it lies in \
             the dip, which friction fills, beside the peak, at the lower end of the band, and with a body at multiples of the load's mode, \
             which the gear makes of its swing; most points are far better, as the median says. It makes the dampings and the depth \
             of the dip uncertain, hardly the place of the dip, which is all that a shaper needs: it takes 10 % of frequency either way."
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
        }],
        ..Document::default()
    }
}
