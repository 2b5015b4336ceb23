//! What runs of a carriage, or any log of a servo, show about an axis: rigid models and two masses.
//!
//! A carriage's friction sweep and dry runs give inertia and friction (rigid, over position); its pulses give the two masses. A log of another
//! program (CSV with a sidecar) gives the rigid model, symmetric and asymmetric.

use std::path::{Path, PathBuf};

use froude_fit::distribution::coverage_factor;
use froude_fit::series::mean;
use froude_identify::method::MethodError;
use froude_identify::source::ReadFile;
use froude_identify::wild;
use froude_records::estimate::{Estimate, OWN};
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::run::{BodyState, Declared, ImportedRun, Role, RunLog, import_run};
use froude_records::sidecar_file::{joined_files, sidecar_of, sidecar_path};
use froude_records::units::Dimension;
use froude_rig::carriage::LogsRig;

use crate::drag::setup::DriveUnit;
use crate::drag::steady::{SteadySettings, window};
use crate::reduction::rig_key;
use crate::runs::{Runs, column, for_drag, mounts};
use crate::servo::motor::{Drive, MotorSide};
use crate::servo::report::{effective, of_runs as of_several};
use crate::servo::rows::Rows;
use crate::servo::scale::{COUNT, Errs, ForcePerVolt, SPROCKET_RADIUS, Scale};
use crate::servo::two_mass::FlexibleReport;
use crate::servo::{
    Chain, Friction, RigidFit, ServoCoefficient, ServoError, ServoLog, ServoReport, identify_servo, record,
};
use crate::source::file_of;
use crate::two_masses::{motor_of, pulses, relative_errors, servo_log, two_masses};

pub mod any;
mod cross;
pub mod declared;
mod long;
pub mod page;
pub mod source;

/// A model of an axis that can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisModel {
    /// Rigid, one Coulomb friction.
    Symmetric,
    /// Rigid, friction of its own each way.
    Asymmetric,
    /// Rigid, Coulomb friction mapped over the travel.
    OverPosition,
    /// Motor and load with a chain between them.
    TwoMass,
}

impl AxisModel {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Symmetric, Self::Asymmetric, Self::OverPosition, Self::TwoMass];
    /// Names of the models that can be fitted to a log without a known rig.
    const OF_LOGS: [&'static str; 2] = [Self::Symmetric.name(), Self::Asymmetric.name()];

    /// Its name in files, which is that of its law.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Symmetric => "servo_symmetric",
            Self::Asymmetric => "servo_asymmetric",
            Self::OverPosition => "servo_over_position",
            Self::TwoMass => record::TWO_MASS,
        }
    }

    /// What it is, in words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Symmetric => "rigid axis, one Coulomb friction",
            Self::Asymmetric => "rigid axis, friction of its own each way",
            Self::OverPosition => "rigid axis, friction mapped over the travel",
            Self::TwoMass => "motor and load with a chain between them",
        }
    }

    /// How its friction is called; `None` of the two masses.
    const fn friction(self) -> Option<&'static str> {
        match self {
            Self::Symmetric => Some(CONSTANT),
            Self::Asymmetric => Some(ASYMMETRIC),
            Self::OverPosition => Some(OVER_POSITION),
            Self::TwoMass => None,
        }
    }
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
#[derive(Debug, Clone, Default)]
pub struct AxisModels {
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
    /// An estimate for each model, with the files that it is fitted to.
    pub estimates: Vec<(Estimate, Vec<ReadFile>)>,
    /// What is doubtful.
    pub findings: Vec<Finding>,
}

/// Rigid models of a log of another program, called `name`; its sidecar says what force a volt of the command is, `gain` what is declared of
/// its error.
///
/// # Errors
///
/// A log that cannot be read, without the force per volt, or that no model can be fitted to.
pub fn of_table(
    path: &Path,
    sidecar: Option<&Path>,
    name: &str,
    asked: &[AxisModel],
    gain: &ForcePerVolt<'_>,
) -> Result<AxisModels, MethodError> {
    let (imported, servo) = read_log(path, sidecar)?;
    let refused = |error: ServoError| MethodError::input(path, error.to_string());
    let even = servo.evenly().map_err(refused)?;
    let fit = |friction| identify_servo(&servo, &Chain::of_log(gain.n_v, even.rate_hz, friction)).map_err(refused);
    let rigid = asked.iter().filter_map(|model| Some((model.friction()?, fit(friction_of(*model)))));
    let (models, not_fitted) = each(rigid);
    let not_fitted = some_or_error(!models.is_empty(), not_fitted)?;
    let mut findings = reported(&models, imported.findings);
    findings.extend(by_direction(&models));
    findings.extend(not_fitted);
    findings.extend(even.done.map(|done| Finding::new(Severity::Warning, "uneven-time-steps", done)));
    findings.extend(
        wild::times(&servo.time_s, SLOWEST_HZ)
            .map(|what| Finding::new(Severity::Warning, "implausible-times", format!("{}: {what}", path.display()))),
    );
    findings.push(one_excitation(ANOTHER_LOG));
    let files = files_of_table(path, sidecar);
    let rigid = |m: &Model| (record::rigid(name, &m.name, &m.report.fit, gain), files.clone());
    Ok(AxisModels { estimates: models.iter().map(rigid).collect(), models, findings, ..AxisModels::default() })
}

/// Slowest rate of a log that shows a servo, Hz.
const SLOWEST_HZ: f64 = 5.0;

/// Reads a log from another program; rejects it if a sample is far from all others.
fn read_log(path: &Path, sidecar: Option<&Path>) -> Result<(ImportedRun, ServoLog), MethodError> {
    let imported = import_run(path, sidecar)?;
    if let Some(what) = wild::sample(&imported.log, &imported.declared.marks) {
        return Err(MethodError::input(path, format!("{what}; correct the sample, or cut the log there")));
    }
    let servo = servo_log(&imported.log)?;
    Ok((imported, servo))
}

/// One log is one excitation: what another would show is in none of its residuals.
fn one_excitation(remedy: &str) -> Finding {
    let text = format!(
        "the intervals hold for this excitation alone: friction that the model leaves out moves the coefficients from one motion to the next by more than any block \
         of one log shows; {remedy}"
    );
    Finding::new(Severity::Note, "one-excitation", text)
}

/// What to do about it where another log can be held against the fit.
const ANOTHER_LOG: &str =
    "check the fit on a log of another motion (--validate OTHER), or give a campaign several logs";

/// The friction of a rigid model of a log: an offset of the current is not excluded.
fn friction_of(model: AxisModel) -> Friction {
    match model {
        AxisModel::Asymmetric => Friction::asymmetric(),
        _ => Friction::symmetric(),
    }
}

/// What a sidecar says that a volt of the command is, N/V.
///
/// # Errors
///
/// A sidecar that cannot be read, or says nothing of it.
pub fn force_per_volt_n_v(log: &Path, sidecar: Option<&Path>) -> Result<f64, MethodError> {
    let gain = sidecar_of(log, sidecar)?.and_then(|sidecar| Some(sidecar.constants.get("drive_gain")?.value_si));
    gain.ok_or_else(|| {
        let what = "the sidecar must state the force per volt of the command: [constants] drive_gain = \"35.15 N/V\"";
        MethodError::input(log, what)
    })
}

/// A log and its sidecar.
fn files_of_table(path: &Path, sidecar: Option<&Path>) -> Vec<ReadFile> {
    let mut files = vec![ReadFile::new(path.to_owned(), "table")];
    let sidecar = sidecar.map_or_else(|| sidecar_path(path).ok().flatten(), |given| Some(given.to_owned()));
    files.extend(joined_files(path, sidecar.as_deref()).into_iter().map(|file| ReadFile::new(file, "joined")));
    files.extend(sidecar.map(|sidecar| ReadFile::new(sidecar, "sidecar")));
    files
}

fn reported(models: &[Model], mut findings: Vec<Finding>) -> Vec<Finding> {
    findings.extend(models.iter().flat_map(|m| doubts(&m.name, &m.report.fit)));
    findings
}

/// What is doubtful of a model, and what the motion does not determine of it.
fn doubts(name: &str, fit: &RigidFit) -> Vec<Finding> {
    let of = |(code, text): (&str, &String)| Finding::new(Severity::Warning, code, format!("{name}: {text}"));
    let said = fit.findings.iter().map(|text| ("servo", text));
    said.chain(fit.excitation.iter().map(|text| ("weak-excitation", text))).map(of).collect()
}

/// The models that came out, and a finding and error for each that did not: it costs its own row and no other.
fn each<'a>(
    asked: impl Iterator<Item = (&'a str, Result<ServoReport, MethodError>)>,
) -> (Vec<Model>, Vec<(Finding, MethodError)>) {
    let (mut models, mut not_fitted) = (Vec::new(), Vec::new());
    for (name, report) in asked {
        match report {
            Ok(report) => models.push(Model { name: name.to_owned(), report }),
            Err(error) => not_fitted.push((left_out(name, &error), error)),
        }
    }
    (models, not_fitted)
}

fn left_out(model: &str, why: &MethodError) -> Finding {
    Finding::new(Severity::Warning, "not-fitted", format!("{model} could not be fitted and is left out: {why}"))
}

/// The findings where something came out, else the first error.
fn some_or_error(is_some: bool, not_fitted: Vec<(Finding, MethodError)>) -> Result<Vec<Finding>, MethodError> {
    let (findings, errors): (Vec<Finding>, Vec<MethodError>) = not_fitted.into_iter().unzip();
    match errors.into_iter().next() {
        Some(first) if !is_some => Err(first),
        _ => Ok(findings),
    }
}

/// Kinds of run that tell the servo.
pub const KINDS: [Role; 3] = [Role::Friction, Role::Dry, Role::Excitation];
/// Rate at which rows of slow runs are compared, Hz: below the load mode, so that the rigid model is what moves.
const ROW_RATE_HZ: f64 = 20.0;
/// Corner of the position's filter for the rigid model, Hz: the chain's modes lie above it.
const RIGID_CORNER_HZ: f64 = 3.0;
/// The model of one Coulomb friction everywhere, and that of a map.
pub(crate) const CONSTANT: &str = "symmetric";
const ASYMMETRIC: &str = "asymmetric";
const OVER_POSITION: &str = "over position";
/// Distance of the friction map's knots, m, where that takes no more than [`MOST_STRETCHES`].
const KNOT_M: f64 = 0.25;
/// Most stretches between knots: on ways longer than 250 m they are longer.
const MOST_STRETCHES: usize = 1000;

/// These models of what runs of a carriage say of their axis, called `name`.
///
/// # Errors
///
/// Runs that do not say what rig they come from, or that no model can be fitted to.
pub fn of_runs(runs: &Runs, asked: &[AxisModel], name: &str) -> Result<AxisModels, MethodError> {
    let constants = runs.logs.iter().find_map(|log| log.meta.moving_axis());
    let rig = rig_key(runs, constants).unwrap_or_else(|| format!("{OWN}rig"));
    let drive = constants.map(|constants| {
        let [torque_relative, radius_relative] = relative_errors(constants);
        Drive { motor: motor_of(constants), torque_relative, radius_relative, rig: rig.clone() }
    });
    let logs = runs.campaign.as_ref().and_then(|c| c.logs);
    let gain = match (&drive, logs) {
        (Some(drive), _) => ForcePerVolt::of_drive(drive),
        (None, Some(logs)) => of_logs(&logs, &rig),
        (None, None) => {
            let what = "the runs do not state which rig they come from (their .toml has no [rig])";
            return Err(MethodError::input(&runs.folder, what));
        }
    };
    let motor = drive.as_ref().map(|drive| drive.motor);
    let slow: Vec<&RunLog> = runs.logs.iter().filter(|l| l.meta.role == Role::Friction).collect();
    let slow = if slow.is_empty() { runs.logs.iter().filter(|l| l.meta.role == Role::Dry).collect() } else { slow };
    let (mut models, mut not_fitted) = (Vec::new(), Vec::new());
    if !slow.is_empty() {
        let friction = |model: AxisModel| match model {
            AxisModel::Asymmetric => Ok(Friction::asymmetric()),
            AxisModel::OverPosition => knots(&slow).map(|knots_m| Friction { knots_m, ..Friction::default() }),
            _ => Ok(Friction::default()),
        };
        let rigid = asked.iter().filter_map(|model| Some((model.friction()?, friction(*model))));
        (models, not_fitted) =
            each(rigid.map(|(name, friction)| (name, friction.and_then(|f| of_slow(&slow, gain.n_v, f)))));
    }
    let mut findings = reported(&models, runs.findings.clone());
    findings.extend(by_direction(&models));
    findings.extend(varies(&models));
    let declared = runs.campaign.as_ref().and_then(|c| c.carriage.as_ref()).and_then(|c| c.rig.y.coulomb_n_m);
    findings.extend(declared.zip(motor).and_then(|(d, motor)| contradicted(&models, &motor, d)));
    if !models.is_empty() {
        findings.push(Finding::new(
            Severity::Note,
            "servo",
            "M and J_eff of runs at constant speed depend on their ramps, whose positions are filtered at 3 Hz and whose forces are not: they \
             may be off by one per cent, which their intervals do not include; take the masses from the pulses"
                .to_owned(),
        ));
    }
    let (flexible, why_not) = if asked.contains(&AxisModel::TwoMass) { two_masses(&runs.logs) } else { (None, None) };
    findings.extend(some_or_error(!models.is_empty() || flexible.is_some(), not_fitted)?);
    findings.extend(why_not);
    if let Some(report) = &flexible {
        findings.extend(report.findings.iter().map(|t| Finding::new(Severity::Note, "two-mass", t.clone())));
    }
    let repeatability = repeatability(&slow, gain.n_v)?;
    let files = |logs: &[&RunLog]| -> Vec<ReadFile> { logs.iter().copied().map(file_of).collect() };
    let rigid = |m: &Model| (record::rigid(name, &m.name, &m.report.fit, &gain), files(&slow));
    let excited: Vec<&RunLog> = pulses(&runs.logs).into_iter().collect();
    let two_mass =
        |(report, drive): (&FlexibleReport, &Drive)| (record::two_mass(name, report, drive), files(&excited));
    let estimates = models.iter().map(rigid).chain(flexible.as_ref().zip(drive.as_ref()).map(two_mass)).collect();
    Ok(AxisModels {
        estimates,
        models,
        rigid_mounts: mounts(slow.iter().copied()),
        flexible,
        two_mass_mounts: mounts(pulses(&runs.logs)),
        repeatability,
        motor,
        findings,
    })
}

/// The force per volt or ampere that a campaign declares for logs of other programs.
fn of_logs(logs: &LogsRig, rig: &str) -> ForcePerVolt<'static> {
    let drive = if logs.is_current { DriveUnit::CURRENT } else { DriveUnit::DECLARED };
    let Declared { value, standard_uncertainty } = logs.force_per_unit;
    let scale = |key: &str, name: &str, quantity: &str, relative, errs| Scale {
        key: format!("{rig}/{key}"),
        name: name.to_owned(),
        quantity: quantity.to_owned(),
        relative,
        dof: None,
        errs,
    };
    let force = scale("force", drive.error, drive.name, standard_uncertainty / value, Errs::Factor);
    let length = scale(SPROCKET_RADIUS, COUNT, SPROCKET_RADIUS, logs.position_relative, Errs::Length);
    ForcePerVolt {
        name: drive.name,
        unit: drive.unit.to_owned(),
        scales: vec![force, length],
        ..ForcePerVolt::of_log(value, None)
    }
}

/// Knots over the travel that the runs cover.
fn knots(logs: &[&RunLog]) -> Result<Vec<f64>, MethodError> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for log in logs {
        for &y in column(log, &format!("{}/position", log.meta.carriage.axis.name()), Dimension::LENGTH)? {
            (low, high) = (low.min(y), high.max(y));
        }
    }
    if !(high - low).is_finite() {
        let what = format!("the runs go from {low} m to {high} m; friction cannot be mapped there");
        return Err(MethodError::input(logs.first().map_or_else(PathBuf::new, |log| log.path.clone()), what));
    }
    Ok(knots_between(low, high))
}

/// Knots in whole millimetres, so that their names are short; the outer ones just inside, where rows are.
fn knots_between(low_m: f64, high_m: f64) -> Vec<f64> {
    let (low, high) = ((1e3 * low_m).ceil() / 1e3, (1e3 * high_m).floor() / 1e3);
    let n = (((high - low) / KNOT_M).round().max(1.0) as usize).min(MOST_STRETCHES);
    (0..=n).map(|i| (1e3 * (low + (high - low) * i as f64 / n as f64)).round() / 1e3).collect()
}

/// The part of a run in which the reference moves; at rest friction is anything below breakaway and shows nothing.
fn moving(log: &RunLog) -> Result<Option<RunLog>, MethodError> {
    let speed = column(log, &format!("{}/reference_velocity", log.meta.carriage.axis.name()), Dimension::SPEED)?;
    let first = speed.iter().position(|v| *v != 0.0);
    let last = speed.iter().rposition(|v| *v != 0.0);
    Ok(first.zip(last).map(|(first, last)| log.between(log.time_s[first], log.time_s[last])))
}

/// All slow runs as rows of one regression; the run is the piece of evidence.
fn of_slow(logs: &[&RunLog], force_per_volt_n: f64, friction: Friction) -> Result<ServoReport, MethodError> {
    let mut chain = Chain::new(force_per_volt_n, friction);
    let mut runs: Vec<Rows> = Vec::new();
    for log in logs {
        let rate_hz = log.sample_rate_hz().unwrap_or(0.0);
        chain = Chain {
            corner_hz: RIGID_CORNER_HZ,
            decimation: (rate_hz / ROW_RATE_HZ).round().max(1.0) as usize,
            ..chain
        };
        let Some(moving) = moving(log)? else { continue };
        runs.push(chain.rows(&servo_log(&moving)?).map_err(MethodError::refused)?);
    }
    if runs.is_empty() {
        return Err(MethodError::input(
            logs.first().map_or_else(PathBuf::new, |log| log.path.clone()),
            "no run with steady motion",
        ));
    }
    of_several(runs, &chain).map_err(MethodError::refused)
}

/// Whether friction differs with the direction: the symmetric model then has a mean of both, and of neither. Two differences are looked at, each at
/// half of 5 %.
fn by_direction(models: &[Model]) -> Option<Finding> {
    let fit = &models.iter().find(|m| m.name == ASYMMETRIC)?.report.fit;
    let place = |name: String| fit.coefficients.iter().position(|c| c.name == name);
    let differences = ["F_v", "F_c"].into_iter().filter_map(|name| {
        let (i, j) = (place(format!("{name}+"))?, place(format!("{name}-"))?);
        let (a, b) = (&fit.coefficients[i], &fit.coefficients[j]);
        let c = &fit.covariance;
        let variance = c[(i, i)] + c[(j, j)] - 2.0 * c[(i, j)];
        let half = coverage_factor(0.975, fit.dof[i].min(fit.dof[j])) * variance.max(0.0).sqrt();
        let difference = a.value - b.value;
        (difference.abs() > half).then(|| {
            format!(
                "{name}+ minus {name}- is {} ± {} {}",
                number::fixed(difference, 1),
                number::significant(half, 2),
                a.unit
            )
        })
    });
    let found: Vec<String> = differences.collect();
    (!found.is_empty()).then(|| {
        let text = format!(
            "friction differs with the direction of motion: {} (97.5 % each, so that both hold at 95 %; without declared errors); the symmetric model has a mean of both, which holds in \
             neither direction: use servo_asymmetric",
            found.join(", ")
        );
        Finding::new(Severity::Warning, "friction-by-direction", text)
    })
}

/// Whether a constant friction stands for one that changes along the travel: its interval is then that of a mean, and of no place.
/// `None` without both models.
fn varies(models: &[Model]) -> Option<Finding> {
    let of = |name: &str| models.iter().find(|m| m.name == name).map(|m| &m.report.fit);
    let constant = of(CONSTANT)?.coefficient("F_c")?;
    let map: Vec<&ServoCoefficient> =
        of(OVER_POSITION)?.coefficients.iter().filter(|c| c.name.starts_with("F_c(")).collect();
    if map.iter().all(|c| c.interval[0] <= constant.value && constant.value <= c.interval[1]) {
        return Some(Finding::new(
            Severity::Note,
            "servo",
            format!(
                "no change of friction along the travel is detected: the interval at every knot of the map contains F_c = {:.2} N",
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
            "friction changes along the travel, from {} = {:.2} N to {} = {:.2} N: F_c = {:.2} N (and C_eff) is its mean over the distance \
             travelled, and its interval states how well the mean repeats, not the friction at one position; use the map",
            least.name, least.value, most.name, most.value, constant.value
        ),
    ))
}

/// Identified friction that is not the declared one, by more than bodies and bearings explain.
fn contradicted(models: &[Model], motor: &MotorSide, declared: Declared) -> Option<Finding> {
    let fit = &models.iter().find(|m| m.name == CONSTANT)?.report.fit;
    let found = effective(fit, motor).into_iter().find(|c| c.name == "C_eff")?;
    let ratio = found.value / declared.value;
    (!(0.5..=2.0).contains(&ratio)).then(|| {
        Finding::new(
            Severity::Warning,
            "declared-contradicted",
            format!(
                "C_eff is {:.2e} N m here and coulomb_friction is declared as {:.2e} N m: the coast distance and the check for a stuck encoder \
                 depend on the declared value. Declare the identified value, or check K_T, the amplifier's gain, gear ratio and counts_per_revolution",
                found.value, declared.value
            ),
        )
    })
}

/// Mean force of the steady windows by speed and direction, with the standard deviation over runs.
fn repeatability(logs: &[&RunLog], force_per_volt_n: f64) -> Result<Vec<Repeatability>, MethodError> {
    let mut cells: Vec<(f64, f64, Vec<f64>)> = Vec::new();
    for log in logs {
        let Some(run) = for_drag(log)? else { continue };
        let Ok(w) = window(&run, SteadySettings::default()) else { continue };
        let force_n = run.direction * force_per_volt_n * mean(w.of(run.command_v), run.step_s()).value;
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

#[cfg(test)]
mod tests {
    use super::*;

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
