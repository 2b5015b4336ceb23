//! `froude carriage identify`: servo parameters with intervals, from runs of a carriage or from anyone's servo log.
//!
//! A carriage's friction sweep and dry runs tell inertia and friction (rigid, over position); its pulses tell the two masses. A log
//! of another program (CSV with a sidecar) tells the rigid model, symmetric and asymmetric.

use std::ops::Range;
use std::path::{Path, PathBuf};

use froude_carriage::drag::steady::{SteadySettings, window};
use froude_carriage::runs::{Runs, column, for_drag, mounted, mounts, read};
use froude_carriage::servo::chain::Rows;
use froude_carriage::servo::motor::MotorSide;
use froude_carriage::servo::record::{self, TWO_MASS};
use froude_carriage::servo::report::{effective, of_runs as of_several};
use froude_carriage::servo::two_mass::FlexibleReport;
use froude_carriage::servo::{Chain, Friction, ServoCoefficient, ServoReport, identify_servo};
use froude_carriage::two_masses::{motor_of, pulses, servo_log, two_masses};
use froude_fit::series::mean;
use froude_identify::source::ReadFile;
use froude_records::estimate::{Estimate, EstimateFile};
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Series, TextTable};
use froude_records::run::{BodyState, Declared, Role, RunLog, import_run};
use froude_records::units::Dimension;
use froude_report::document::Document;

use froude_carriage::source::files_of;

use crate::Error;
use crate::data_files::DataFiles;
use crate::results::{self, Written};

/// What to identify.
#[derive(Debug, Clone)]
pub struct ServoJob {
    /// Folders of runs, runs, or one CSV log.
    pub input: Vec<PathBuf>,
    /// Sidecar of a CSV log that is not beside it.
    pub sidecar: Option<PathBuf>,
    /// Folder of the results; beside the input, unless said.
    pub out: Option<PathBuf>,
    /// Date for the report.
    pub date: Option<String>,
}

/// One fitted model with its title.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// `symmetric`, `asymmetric`, `over position`.
    pub name: String,
    /// Its fit.
    pub report: ServoReport,
}

/// Repeats at one speed and direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeatability {
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// +1 or −1.
    pub direction: f64,
    /// Mean drive force against the motion, ideal gear, N.
    pub force_n: f64,
    /// Its standard deviation from run to run, N; `None` for a single run.
    pub std_n: Option<f64>,
    /// Runs.
    pub runs: usize,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct ServoOutcome {
    /// Rigid models.
    pub models: Vec<Model>,
    /// What rode on the carriage in the runs that they are fitted to; none of a table.
    pub rigid_mounts: Vec<BodyState>,
    /// Two masses, where there are pulses.
    pub flexible: Option<FlexibleReport>,
    /// What rode on the carriage in the pulses.
    pub two_mass_mounts: Vec<BodyState>,
    /// How well runs repeat.
    pub repeatability: Vec<Repeatability>,
    /// The drive, where it is declared.
    pub motor: Option<MotorSide>,
    /// What is doubtful.
    pub findings: Vec<Finding>,
    /// The record: an estimate for each model.
    pub file: EstimateFile,
    /// Where record and page lie; `None` before they are written.
    pub written: Option<Written>,
}

/// Identifies whatever the input allows and writes `estimate.json` and `report.html`.
///
/// # Errors
///
/// See [`Error`].
pub fn identify(job: &ServoJob) -> Result<ServoOutcome, Error> {
    let first = job.input.first().cloned().unwrap_or_default();
    let is_table = first.extension().is_some_and(|e| e == "csv" || e == "parquet");
    let runs = if is_table { None } else { Some(read(&job.input, &KINDS, None)?) };
    let beside = || match &runs {
        Some(runs) => runs.results("servo"),
        None => first.with_file_name(format!("{}-servo", first.file_stem().unwrap_or_default().to_string_lossy())),
    };
    let out = job.out.clone().unwrap_or_else(beside);
    results::can_be_written(&out)?;
    let mut outcome = match &runs {
        Some(runs) => of_runs(runs)?,
        None => of_table(&first, job.sidecar.as_deref())?,
    };
    outcome.file.findings.clone_from(&outcome.findings);
    outcome.file.versions = results::versions();
    let html = document(&outcome, &first, job.date.clone()).html()?;
    outcome.written = Some(results::write(&out, &outcome.file, &[], &[], &html)?);
    Ok(outcome)
}

fn of_table(path: &Path, sidecar: Option<&Path>) -> Result<ServoOutcome, Error> {
    let imported = import_run(path, sidecar)?;
    let log = &imported.log;
    let gain = log.meta.constants.get("drive_gain").ok_or_else(|| {
        Error::Nothing(format!(
            "{}: the sidecar must say what force a volt of the command is: [constants] drive_gain = \"35.15 N/V\"",
            path.display()
        ))
    })?;
    let gain_n_v = gain.value;
    let servo = servo_log(log)?;
    let rate_hz = log.sample_rate_hz().unwrap_or(0.0);
    let chain = |friction| Chain {
        // The pinned chain of a record at 1 kHz, scaled with the record's rate.
        corner_hz: 0.1 * rate_hz,
        ..Chain::new(gain_n_v, friction)
    };
    let asked = [(CONSTANT, Friction::symmetric()), (ASYMMETRIC, Friction::asymmetric())];
    let fit = |friction| identify_servo(&servo, &chain(friction)).map_err(Error::from);
    let (models, not_fitted) = each(asked.into_iter().map(|(name, friction)| (name, fit(friction))));
    let not_fitted = some_or_error(!models.is_empty(), not_fitted)?;
    let mut findings = told(&models, imported.findings);
    findings.extend(not_fitted);
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let estimates = models.iter().map(|m| record::rigid(&name, &m.name, &m.report, gain_n_v, None)).collect();
    let mut files = vec![ReadFile::new(path.to_owned(), "table")];
    let sidecar = sidecar.map_or_else(|| path.with_extension("toml"), Path::to_owned);
    files.extend(sidecar.exists().then(|| ReadFile::new(sidecar, "sidecar")));
    Ok(ServoOutcome {
        file: recorded(estimates, &files, &|_, role| role == "table")?,
        models,
        rigid_mounts: Vec::new(),
        flexible: None,
        two_mass_mounts: Vec::new(),
        repeatability: Vec::new(),
        motor: None,
        findings,
        written: None,
    })
}

/// A record of these estimates with the files that were read; `observes` says which of them an estimate comes from, by their roles.
fn recorded(
    mut estimates: Vec<Estimate>,
    read: &[ReadFile],
    observes: &dyn Fn(&Estimate, &str) -> bool,
) -> Result<EstimateFile, Error> {
    let named = |path: &Path| path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let mut files = DataFiles::new(&named);
    for estimate in &mut estimates {
        estimate.data = files.keys_of(read, |role| observes(estimate, role))?;
    }
    Ok(EstimateFile { data: files.into_map(), ..EstimateFile::of(estimates) })
}

fn told(models: &[Model], mut findings: Vec<Finding>) -> Vec<Finding> {
    for model in models {
        for text in &model.report.findings {
            findings.push(Finding::new(Severity::Warning, "servo", format!("{}: {text}", model.name)));
        }
    }
    findings
}

/// The models that came out, and a finding and error for each that did not: it costs its own row and no other.
fn each<'a>(asked: impl Iterator<Item = (&'a str, Result<ServoReport, Error>)>) -> (Vec<Model>, Vec<(Finding, Error)>) {
    let (mut models, mut not_fitted) = (Vec::new(), Vec::new());
    for (name, report) in asked {
        match report {
            Ok(report) => models.push(Model { name: name.to_owned(), report }),
            Err(error) => not_fitted.push((left_out(name, &error), error)),
        }
    }
    (models, not_fitted)
}

fn left_out(model: &str, why: &Error) -> Finding {
    Finding::new(Severity::Warning, "not-fitted", format!("{model} could not be fitted and is left out: {why}"))
}

/// The findings where something came out, else the first error.
fn some_or_error(is_some: bool, not_fitted: Vec<(Finding, Error)>) -> Result<Vec<Finding>, Error> {
    let (findings, errors): (Vec<Finding>, Vec<Error>) = not_fitted.into_iter().unzip();
    match errors.into_iter().next() {
        Some(first) if !is_some => Err(first),
        _ => Ok(findings),
    }
}

/// Kinds of run that tell the servo.
const KINDS: [Role; 3] = [Role::Friction, Role::Dry, Role::Excitation];
/// Rate at which rows of slow runs are compared, Hz: below the load's mode, so that the rigid model is what moves.
const ROW_RATE_HZ: f64 = 20.0;
/// Corner of the position's filter for the rigid model, Hz: the chain's modes lie above it.
const RIGID_CORNER_HZ: f64 = 3.0;
/// The model of one Coulomb friction everywhere, and that of a map.
const CONSTANT: &str = "symmetric";
const ASYMMETRIC: &str = "asymmetric";
const OVER_POSITION: &str = "over position";
/// Distance of the friction map's knots, m, where that takes no more than [`MOST_STRETCHES`].
const KNOT_M: f64 = 0.25;
/// Most stretches between knots: on ways longer than 250 m they are longer.
const MOST_STRETCHES: usize = 1000;

fn of_runs(runs: &Runs) -> Result<ServoOutcome, Error> {
    let constants = runs.logs.iter().find_map(|log| log.meta.moving_axis()).ok_or_else(|| {
        Error::Nothing("the runs do not say what rig they come from (their .toml has no [rig])".to_owned())
    })?;
    let motor = motor_of(constants);
    let slow: Vec<&RunLog> = runs.logs.iter().filter(|l| l.meta.role == Role::Friction).collect();
    let slow = if slow.is_empty() { runs.logs.iter().filter(|l| l.meta.role == Role::Dry).collect() } else { slow };
    let (mut models, mut not_fitted) = (Vec::new(), Vec::new());
    if !slow.is_empty() {
        let map = knots(&slow).map(|knots_m| Friction { knots_m, ..Friction::default() });
        let asked =
            [(CONSTANT, Ok(Friction::default())), (ASYMMETRIC, Ok(Friction::asymmetric())), (OVER_POSITION, map)];
        (models, not_fitted) =
            each(asked.into_iter().map(|(name, friction)| (name, friction.and_then(|f| of_slow(&slow, &motor, f)))));
    }
    let mut findings = told(&models, runs.findings.clone());
    findings.extend(varies(&models));
    let declared = runs.campaign.as_ref().and_then(|c| c.carriage.as_ref()).and_then(|c| c.rig.y.coulomb_n_m);
    findings.extend(declared.and_then(|d| contradicted(&models, &motor, d)));
    if !models.is_empty() {
        findings.push(Finding::new(
            Severity::Note,
            "servo",
            "M and J_eff of runs at constant speed rest on their ramps, whose positions are filtered at 3 Hz and whose forces are not: they \
             may be off by a per cent, which their intervals do not hold; take the masses from the pulses"
                .to_owned(),
        ));
    }
    let (flexible, why_not) = two_masses(&runs.logs);
    findings.extend(some_or_error(!models.is_empty() || flexible.is_some(), not_fitted)?);
    findings.extend(why_not);
    if let Some(report) = &flexible {
        findings.extend(report.findings.iter().map(|t| Finding::new(Severity::Note, "two-mass", t.clone())));
    }
    let repeatability = repeatability(&slow, &motor)?;
    let name = runs.campaign.as_ref().map_or_else(|| runs.results("servo"), |c| PathBuf::from(&c.name));
    let name = name.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let gain_n_v = motor.force_per_volt_n_v();
    let rigid = models.iter().map(|m| record::rigid(&name, &m.name, &m.report, gain_n_v, Some(&motor)));
    let estimates = rigid.chain(flexible.as_ref().map(|report| record::two_mass(&name, report))).collect();
    let of_slow = slow.first().map(|log| log.meta.role.name());
    let of_model = |estimate: &Estimate, role: &str| {
        if estimate.law.name == TWO_MASS { role == Role::Excitation.name() } else { Some(role) == of_slow }
    };
    Ok(ServoOutcome {
        file: recorded(estimates, &files_of(runs), &of_model)?,
        models,
        rigid_mounts: mounts(slow.iter().copied()),
        flexible,
        two_mass_mounts: mounts(pulses(&runs.logs)),
        repeatability,
        motor: Some(motor),
        findings,
        written: None,
    })
}

/// Knots over the travel that the runs cover.
fn knots(logs: &[&RunLog]) -> Result<Vec<f64>, Error> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for log in logs {
        for &y in column(log, &format!("{}/position", log.meta.carriage.axis.name()), Dimension::LENGTH)? {
            (low, high) = (low.min(y), high.max(y));
        }
    }
    if !(high - low).is_finite() {
        return Err(Error::Nothing(format!("the runs go from {low} m to {high} m; friction cannot be mapped there")));
    }
    Ok(knots_between(low, high))
}

/// Knots in whole millimetres, so that their names are short; the outer ones just inside, where rows are.
fn knots_between(low_m: f64, high_m: f64) -> Vec<f64> {
    let (low, high) = ((1e3 * low_m).ceil() / 1e3, (1e3 * high_m).floor() / 1e3);
    let n = (((high - low) / KNOT_M).round().max(1.0) as usize).min(MOST_STRETCHES);
    (0..=n).map(|i| (1e3 * (low + (high - low) * i as f64 / n as f64)).round() / 1e3).collect()
}

/// The part of a run in which the reference moves; at rest friction is anything below breakaway and tells nothing.
fn moving(log: &RunLog) -> Result<Option<RunLog>, Error> {
    let speed = column(log, &format!("{}/reference_velocity", log.meta.carriage.axis.name()), Dimension::SPEED)?;
    let first = speed.iter().position(|v| *v != 0.0);
    let last = speed.iter().rposition(|v| *v != 0.0);
    Ok(first.zip(last).map(|(first, last)| log.between(log.time_s[first], log.time_s[last])))
}

/// All slow runs as rows of one regression; the run is the piece of evidence.
fn of_slow(logs: &[&RunLog], motor: &MotorSide, friction: Friction) -> Result<ServoReport, Error> {
    let mut chain = Chain::new(motor.force_per_volt_n_v(), friction);
    let mut record_rate_hz = 0.0;
    let mut runs: Vec<Rows> = Vec::new();
    for log in logs {
        let rate_hz = log.sample_rate_hz().unwrap_or(0.0);
        record_rate_hz = rate_hz;
        chain = Chain {
            corner_hz: RIGID_CORNER_HZ,
            decimation: (rate_hz / ROW_RATE_HZ).round().max(1.0) as usize,
            ..chain
        };
        let Some(moving) = moving(log)? else { continue };
        runs.push(chain.rows(&servo_log(&moving)?)?);
    }
    if runs.is_empty() {
        return Err(Error::Nothing("no run with steady motion".to_owned()));
    }
    let mut report = of_several(runs, &chain)?;
    report.record_rate_hz = record_rate_hz;
    Ok(report)
}

/// Whether a constant friction stands for one that changes along the travel: its interval is then that of a mean, and of no place.
/// `None` without both models.
fn varies(models: &[Model]) -> Option<Finding> {
    let of = |name: &str| models.iter().find(|m| m.name == name).map(|m| &m.report);
    let constant = of(CONSTANT)?.coefficient("F_c")?;
    let map: Vec<&ServoCoefficient> =
        of(OVER_POSITION)?.coefficients.iter().filter(|c| c.name.starts_with("F_c(")).collect();
    if map.iter().all(|c| c.interval[0] <= constant.value && constant.value <= c.interval[1]) {
        return Some(Finding::new(
            Severity::Note,
            "servo",
            format!(
                "friction is not shown to change along the travel: every knot of the map holds F_c = {:.2} N in its interval",
                constant.value
            ),
        ));
    }
    let least = map.iter().min_by(|a, b| a.value.total_cmp(&b.value))?;
    let most = map.iter().max_by(|a, b| a.value.total_cmp(&b.value))?;
    Some(Finding::new(
        Severity::Warning,
        "servo",
        format!(
            "friction changes along the travel, from {} = {:.2} N to {} = {:.2} N: F_c = {:.2} N (and C_eff) is its mean over what was \
             travelled, and its interval says how well the mean repeats, not what friction is at a place; take the map",
            least.name, least.value, most.name, most.value, constant.value
        ),
    ))
}

/// Identified friction that is not the declared one, by more than bodies and bearings explain.
fn contradicted(models: &[Model], motor: &MotorSide, declared: Declared) -> Option<Finding> {
    let report = &models.iter().find(|m| m.name == CONSTANT)?.report;
    let found = effective(report, motor).into_iter().find(|c| c.name == "C_eff")?;
    let ratio = found.value / declared.value;
    (!(0.5..=2.0).contains(&ratio)).then(|| {
        Finding::new(
            Severity::Warning,
            "declared-contradicted",
            format!(
                "C_eff is {:.2e} N m here and coulomb_friction is declared as {:.2e} N m: the coast distance and the watch for a stuck encoder \
                 hang on the declared one. Write the identified one, or look at K_T, the amplifier's gain, gear ratio and counts_per_revolution",
                found.value, declared.value
            ),
        )
    })
}

/// Mean force of the steady windows by speed and direction, with the standard deviation over runs.
fn repeatability(logs: &[&RunLog], motor: &MotorSide) -> Result<Vec<Repeatability>, Error> {
    let mut cells: Vec<(f64, f64, Vec<f64>)> = Vec::new();
    for log in logs {
        let Some(run) = for_drag(log)? else { continue };
        let Ok(w) = window(&run, SteadySettings::default()) else { continue };
        let force_n = run.direction * motor.force_per_volt_n_v() * mean(w.of(run.command_v), run.step_s()).value;
        match cells.iter_mut().find(|c| (c.0 - run.target_speed_m_s).abs() < 1e-9 && c.1 == run.direction) {
            Some(cell) => cell.2.push(force_n),
            None => cells.push((run.target_speed_m_s, run.direction, vec![force_n])),
        }
    }
    cells.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    Ok(cells
        .into_iter()
        .map(|(speed_m_s, direction, forces)| {
            let n = forces.len() as f64;
            let force_n = forces.iter().sum::<f64>() / n;
            let square: f64 = forces.iter().map(|f| (f - force_n).powi(2)).sum();
            let std_n = (forces.len() > 1).then(|| (square / (n - 1.0)).sqrt());
            Repeatability { speed_m_s, direction, force_n, std_n, runs: forces.len() }
        })
        .collect())
}

/// Coefficients with the published-style standard deviation beside the honest interval.
#[must_use]
pub fn coefficient_table(caption: String, coefficients: &[ServoCoefficient]) -> TextTable {
    TextTable {
        caption,
        head: [
            "coefficient",
            "unit",
            "value",
            "95 % interval (clusters)",
            "std (white noise)",
            "std (HAC)",
            "std (clusters)",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: coefficients
            .iter()
            .map(|c| {
                let digits = |x: f64| number::significant(x, 2);
                vec![
                    c.name.clone(),
                    c.unit.to_owned(),
                    number::short_form(c.value, c.block_std),
                    number::interval(c.interval),
                    digits(c.classical_std),
                    digits(c.hac_std),
                    digits(c.block_std),
                ]
            })
            .collect(),
    }
}

/// Two masses; behind a gear of which nobody declared the efficiency every row says that it is apparent.
#[must_use]
pub fn flexible_table(report: &FlexibleReport) -> TextTable {
    let mut table =
        coefficient_table("Motor, chain and load from motor-side signals.".to_owned(), &report.coefficients);
    if report.is_apparent {
        for (row, c) in table.rows.iter_mut().zip(&report.coefficients) {
            // The rotor lies before the gear, and frequencies do not care.
            if !matches!(c.name.as_str(), "m" | "J_m" | "f_antiresonance" | "f_resonance") {
                row[0].push_str(" (apparent, through the gear)");
            }
        }
    }
    table
}

fn document(outcome: &ServoOutcome, input: &Path, date: Option<String>) -> Document {
    let mut sections = Vec::new();
    for model in &outcome.models {
        let r = &model.report;
        let mut paragraphs = vec![format!(
            "{} rows at {} Hz; relative force error {}.",
            number::count(r.n_rows),
            number::plain(r.rate_hz, 4),
            number::percent(r.relative_force_error)
        )];
        if let Some(w) = &r.whiteness {
            paragraphs.push(format!(
                "Residuals: r₁ = {:.2}, Ljung–Box({}) = {:.0}, p = {}. Standard deviations of white-noise least squares are no honest \
                 intervals unless that p is large; the intervals are those of {}.",
                w.r1,
                w.lags,
                w.ljung_box,
                number::p_value(w.p),
                r.spread.pieces()
            ));
        }
        let mut tables = vec![coefficient_table(format!("Rigid model, friction {}.", model.name), &r.coefficients)];
        if let Some(motor) = outcome.motor.as_ref().filter(|_| model.name == CONSTANT) {
            tables.push(coefficient_table(
                "The same at the motor's shaft (MCD Table II). A gear that loses part of the torque is in these numbers.".to_owned(),
                &effective(r, motor),
            ));
        }
        sections.push(DocumentSection {
            title: format!("Rigid, friction {}{}", model.name, mounted(&outcome.rigid_mounts)),
            paragraphs,
            tables,
            charts: vec![force_chart(model)],
        });
    }
    if let Some(f) = &outcome.flexible {
        let splits = f.splits.iter().map(|s| {
            format!(
                "Split {}: {}.",
                s.name,
                if s.is_identified {
                    format!("{:.2}, interval {}", s.share_of_motor, number::interval(s.interval))
                } else {
                    "not identifiable from the motor's side".to_owned()
                }
            )
        });
        sections.push(DocumentSection {
            title: format!("Two masses{}", mounted(&outcome.two_mass_mounts)),
            paragraphs: splits.collect(),
            tables: vec![flexible_table(f)],
            charts: Vec::new(),
        });
    }
    if !outcome.repeatability.is_empty() {
        sections.push(DocumentSection {
            title: "Repeatability".to_owned(),
            tables: vec![repeatability_table(&outcome.repeatability)],
            ..DocumentSection::default()
        });
    }
    Document {
        sort: "Carriage · servo parameters".to_owned(),
        title: format!("Servo identification of {}", input.display()),
        date,
        sections,
        findings: outcome.findings.clone(),
        ..Document::default()
    }
}

/// Repeats by speed and direction.
#[must_use]
pub fn repeatability_table(cells: &[Repeatability]) -> TextTable {
    TextTable {
        caption: "Mean drive force of the steady windows, ideal gear, and its standard deviation from run to run."
            .to_owned(),
        head: ["speed [m/s]", "way", "force [N]", "std [N]", "std of it", "runs"].map(str::to_owned).to_vec(),
        rows: cells
            .iter()
            .map(|c| {
                let missing = || number::MISSING.to_owned();
                vec![
                    number::plain(c.speed_m_s, 3),
                    if c.direction > 0.0 { "forward" } else { "backward" }.to_owned(),
                    number::plain(c.force_n, 4),
                    c.std_n.map_or_else(missing, |s| number::significant(s, 2)),
                    c.std_n.map_or_else(missing, |s| number::percent(s / c.force_n.abs())),
                    c.runs.to_string(),
                ]
            })
            .collect(),
    }
}

fn force_chart(model: &Model) -> Chart {
    let r = &model.report;
    let predicted: Vec<f64> = r.rows.force_n.iter().zip(&r.residuals_n).map(|(f, e)| f - e).collect();
    // A line through all runs would run back from the end of each to the start of the next.
    let series = |name: &str, y: &[f64], mark| -> Vec<Series> {
        let of_run = |run: &Range<usize>| Series {
            name: name.to_owned(),
            mark,
            x: r.rows.time_s[run.clone()].to_vec(),
            y: y[run.clone()].to_vec(),
            ..Series::default()
        };
        r.runs.iter().map(of_run).collect()
    };
    Chart {
        name: format!("force-{}", model.name),
        title: format!("Drive force and model, friction {}", model.name),
        caption: "Drive force of the command and of the model, and what is left: one line a run, each in its own time."
            .to_owned(),
        x_label: "time [s]".to_owned(),
        panels: vec![
            ChartPanel {
                y_label: "force [N]".to_owned(),
                series: [series("command", &r.rows.force_n, Mark::Line), series("model", &predicted, Mark::Dashed)]
                    .concat(),
                ..ChartPanel::default()
            },
            ChartPanel {
                y_label: "residual [N]".to_owned(),
                series: series("residual", &r.residuals_n, Mark::Line),
                ..ChartPanel::default()
            },
        ],
        ..Chart::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_carriage::servo::chain::Rows;

    /// Six runs, each in its own time from zero: a line that went through all would run back five times.
    #[test]
    fn the_figure_has_one_line_a_run() {
        let run = |k: u32| {
            let time_s: Vec<f64> = (0..60).map(|i| 0.1 * f64::from(i)).collect();
            let speed: Vec<f64> = time_s.iter().map(|t| (t + 0.3 * f64::from(k)).sin()).collect();
            Rows {
                rate_hz: 10.0,
                force_n: speed
                    .iter()
                    .zip(&time_s)
                    .map(|(v, t)| 3.0 * v + v.signum() + 0.01 * (7.0 * t).cos())
                    .collect(),
                names: vec![("F_v".to_owned(), "N s/m"), ("F_c".to_owned(), "N")],
                columns: vec![speed.clone(), speed.iter().map(|v| v.signum()).collect()],
                time_s,
            }
        };
        let runs: Vec<Rows> = (0..6).map(run).collect();
        let report = of_several(runs, &Chain::new(35.0, Friction::default())).unwrap();
        let chart = force_chart(&Model { name: CONSTANT.to_owned(), report });
        let [force, residual] = chart.panels.as_slice() else { panic!("two panels") };
        assert_eq!(
            (force.series.len(), residual.series.len()),
            (12, 6),
            "command and model of six runs, and what is left"
        );
        for series in force.series.iter().chain(&residual.series) {
            assert_eq!(series.x.len(), 60, "a run whole");
            assert!(series.x.windows(2).all(|t| t[0] < t[1]), "time runs forward along each line");
        }
        let names: std::collections::BTreeSet<&str> = force.series.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names.len(), 2, "one entry of the legend for all commands, one for all models");
    }

    /// A map costs the third power of its knots: beyond 250 m there are no more of them.
    #[test]
    fn a_friction_map_of_a_long_way_has_no_more_knots() {
        for (way_m, stretches, longest_m) in
            [(40.0, 160, 0.25), (250.0, 1000, 0.25), (600.0, 1000, 0.6), (5000.0, 1000, 5.0)]
        {
            let knots = knots_between(0.0123, 0.0123 + way_m);
            assert_eq!(knots.len(), stretches + 1, "{way_m} m");
            let steps: Vec<f64> = knots.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(steps.iter().all(|step| (0.9 * longest_m..=1.001 * longest_m + 1e-3).contains(step)), "{way_m} m");
            assert!(knots[0] >= 0.0123 && knots[stretches] <= 0.0123 + way_m, "inside, where rows are");
            assert!(knots.iter().all(|knot| (1e3 * knot - (1e3 * knot).round()).abs() < 1e-6), "whole millimetres");
        }
    }
}
