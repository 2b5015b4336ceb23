//! Force per volt from a known weight over a pulley, encoder scale from a known distance, polarity from a jog.
//!
//! **Setting.** The carriage creeps at one speed both ways; a weight W pulls towards −y through a cord over a pulley. With
//! s = ±1 the direction of motion, f the carriage's friction and λW the pulley's, the chain must give, along the motion,
//! f + sW + λW. As long as that is positive the motor drives the gear and its command is s·v_c = c + (f + sW + λW)/k, with c the
//! friction of the motor itself, before the gear.
//!
//! - Both directions with W below f: the half-difference of s·v_c over s = ±1 is W/k; carriage, motor and pulley cancel.
//! - A weight that goes down with W above f drives the gear, which then loses the other way: such a run does not tell k. Its command
//!   need not be negative, since the motor's own friction has still to be overcome. How much of the friction is the motor's no run
//!   without weight shows; therefore only weights up to half of c k + f are believed on their way down.
//! - Lifting runs tell k against runs with less weight, once the pulley's loss λ is known: from light weights both ways, or declared.
//!
//! Fitted by least squares over all driving runs: s·v_c = a₀ + a₁ sW + a₂ W + a₃ s with a₁ = 1/k, a₂ = λ/k, the declared loss as
//! a prior of a₂. Friction has a value for each direction, a₀ ± a₃: otherwise a tilted rail or wheels that run in would bias k (10 % of friction, 3 % of k).
//! Runs without weight both ways tell a₃. If those ran in one direction and the weights in the other, a₃ is taken as zero, and a finding says so.
//! Position-dependent friction cancels only if all runs cover the same positions.

use froude_fit::budget::Uncertain;
use froude_fit::distribution::coverage_factor;
use froude_fit::faer::Mat;
use froude_fit::series::mean;
use froude_fit::{CovarianceKind, Fit, Options, Prior, Problem, fit};
use froude_records::text::counted;

pub mod record;
pub mod source;

use super::error::DragError;
use super::run::{DragRun, RunKind};
use super::steady::reach;
use super::steady::{SteadySettings, window};

/// The pulley's loss where both directions with light weights do not measure it, and nobody declared it: a ball bearing
/// with a thin cord loses 0 to 2 %, taken as uniform.
pub const PULLEY_LOSS: Uncertain = Uncertain::new(0.01, 0.00577);

/// A weight that goes down counts as driven by the motor up to this part of the friction that the motor sees: up to half of that
/// may be the motor's own.
const SURELY_DRIVEN: f64 = 0.5;
/// The pulley's loss is doubted this many standard uncertainties away from what is declared.
const DOUBTED: f64 = 2.0;

/// What is declared about a calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibrationSetup {
    /// (n/R)·K_T·K_amp, N/V: the efficiency is stated relative to it.
    pub ideal_force_per_volt_n: f64,
    /// Its standard uncertainty, as a part: that of K_T, of the amplifier and of the sprocket's radius.
    pub ideal_relative: f64,
    /// Standard uncertainty of the weights, as a part (mass, gravity, buoyancy in air).
    pub weight_relative: f64,
    /// Friction of the pulley as a part of the weight, where the runs do not measure it.
    pub pulley_loss: Uncertain,
    /// How windows are chosen.
    pub steady: SteadySettings,
}

/// Result of the calibration runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Newtons at the chain for a volt of the drive command, driving forward, N/V.
    pub force_per_volt: Uncertain,
    /// Its 95 % interval, N/V.
    pub interval_95: [f64; 2],
    /// Efficiency that it stands for: over the ideal force per volt, whose own uncertainty is in it.
    pub efficiency: Uncertain,
    /// Part of the standard uncertainty from the scatter of the runs, N/V; with that of the pulley where the runs measure it.
    pub type_a: f64,
    /// Part from the declared loss of a pulley that the runs do not measure, N/V; 0 where they do.
    pub from_pulley: f64,
    /// Degrees of freedom of that part.
    pub type_a_dof: f64,
    /// Pulley's loss: as declared, sharpened by light weights both ways.
    pub pulley_loss: Uncertain,
    /// Whether any run lowered a weight under power.
    pub is_pulley_measured: bool,
    /// Friction of the carriage at the creeping speed, N: the mean of both directions.
    pub friction_n: f64,
    /// By how much friction is larger along +y and smaller along −y, N; `None` if the runs went in one direction only or do not determine it.
    pub one_way_n: Option<Uncertain>,
    /// Whether there are runs in both directions that cannot separate friction by direction from the force per volt.
    pub is_one_way_missed: bool,
    /// Driving runs used.
    pub used: usize,
    /// Runs in which the weight drove the gear, or may have; left out.
    pub overhauled: usize,
    /// Sentences for the reader.
    pub notes: Vec<String>,
}

/// Command over a steady window, with the weight's pull.
#[derive(Debug, Clone, Copy)]
struct Reading {
    direction: f64,
    weight_n: f64,
    along_v: f64,
}

/// Calibrates the force per volt from runs with known weights (and the same carriage without any).
///
/// Runs of [`RunKind::Calibration`]; a missing weight counts as none hung.
///
/// # Errors
///
/// [`DragError`] with what is missing: weights, directions, repeats.
pub fn calibrate(runs: &[DragRun<'_>], setup: &CalibrationSetup) -> Result<Calibration, DragError> {
    Readings::of(runs, setup.steady).calibrate(setup)
}

/// What calibration runs showed, one after the other: no log has to stay in memory for it.
#[derive(Debug, Clone, Default)]
pub struct Readings {
    taken: Vec<Reading>,
    /// Why the last run without a steady window has none.
    refused: Option<String>,
}

impl Readings {
    /// The readings of runs.
    #[must_use]
    pub fn of(runs: &[DragRun<'_>], steady: SteadySettings) -> Self {
        let mut out = Self::default();
        for run in runs {
            out.push(run, steady);
        }
        out
    }

    /// Takes the reading of a run; one of another kind has none.
    pub fn push(&mut self, run: &DragRun<'_>, steady: SteadySettings) {
        if run.kind != RunKind::Calibration {
            return;
        }
        match window(run, steady) {
            Ok(w) => self.taken.push(Reading {
                direction: run.direction,
                weight_n: run.hung_weight_n.unwrap_or(0.0),
                along_v: run.direction * mean(w.of(run.command_v), run.step_s()).value,
            }),
            Err(why) => self.refused = Some(why.to_string()),
        }
    }

    /// Takes what a drawn run shows: the direction of its motion, its weight, N, and its command along the motion, V.
    pub(crate) fn push_drawn(&mut self, direction: f64, weight_n: f64, along_v: f64) {
        self.taken.push(Reading { direction, weight_n, along_v });
    }

    /// No calibration run was seen, with or without a reading.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.taken.is_empty() && self.refused.is_none()
    }

    /// As [`calibrate`], from the runs seen so far.
    ///
    /// # Errors
    ///
    /// As [`calibrate`].
    pub fn calibrate(&self, setup: &CalibrationSetup) -> Result<Calibration, DragError> {
        if self.taken.is_empty() {
            let why = self.refused.clone().unwrap_or_else(|| "no calibration run".to_owned());
            return Err(DragError::calibration(why));
        }
        calibrated(&self.taken, setup)
    }
}

fn calibrated(readings: &[Reading], setup: &CalibrationSetup) -> Result<Calibration, DragError> {
    let total = readings.len();
    // First with what goes up or has no weight: its friction says which weights the motor surely drives down.
    let is_lifting = |r: &Reading| r.along_v > 0.0 && (r.weight_n == 0.0 || r.direction > 0.0);
    let lifting: Vec<Reading> = readings.iter().copied().filter(is_lifting).collect();
    let heaviest = |of: &[Reading]| of.iter().map(|r| r.weight_n).fold(0.0, f64::max);
    let is_told = lifting.iter().any(|r| r.weight_n < 0.9 * heaviest(&lifting));
    let friction_n = match fitted(&lifting, setup.pulley_loss, setup.ideal_force_per_volt_n) {
        Ok((f, _)) if is_told => take(&f, 0)?.value / take(&f, 1)?.value,
        _ => 0.0,
    };
    let is_driven = |r: &Reading| is_lifting(r) || (r.along_v > 0.0 && r.weight_n <= SURELY_DRIVEN * friction_n);
    let driving: Vec<Reading> = readings.iter().copied().filter(is_driven).collect();
    let overhauled = total - driving.len();
    let weights = reach(&driving.iter().map(|r| r.weight_n).collect::<Vec<_>>());
    if driving.is_empty() || weights[1] <= 0.0 {
        return Err(DragError::calibration(
            "no run has the motor lift a known weight; hang one over the pulley and log a run that lifts it",
        ));
    }
    let is_pulley_measured = driving.iter().any(|r| r.weight_n > 0.0 && r.direction < 0.0);
    if !is_pulley_measured && weights[0] > 0.9 * weights[1] {
        return Err(DragError::calibration(format!(
            "{}, all lifting {:.2} N: friction and weight cannot be distinguished; add runs without weight, or lower \
             a weight that is lighter than the friction",
            counted(total, "run", "runs"),
            weights[1]
        )));
    }
    let loss = setup.pulley_loss;
    // The declared loss is of the weight, the coefficient is in volts: it takes k from a first fit.
    let (first, _) = fitted(&driving, loss, setup.ideal_force_per_volt_n)?;
    let first_k = 1.0 / take(&first, 1)?.value;
    if first_k <= 0.0 {
        return Err(DragError::calibration(format!(
            "lifting up to {:.1} N needs no more command than lifting nothing: check that the weights hung free over the whole travel (floor), \
             and check counts_per_revolution, which gives the distance travelled",
            weights[1]
        )));
    }
    let (fitted, is_one_way_missed) = fitted(&driving, loss, first_k)?;
    let inverse = take(&fitted, 1)?;
    let k = 1.0 / inverse.value;
    let of_fit = k * k * inverse.standard;
    // Lifting tells 1/k + λ/k alone: an error of λ is one of k, ∂k/∂λ = k²/k, and no scatter of the runs.
    let from_pulley = if is_pulley_measured { 0.0 } else { k * k / first_k * loss.standard };
    let type_a = (of_fit * of_fit - from_pulley * from_pulley).max(0.0).sqrt();
    let from_weight = k * setup.weight_relative;
    let known = |standard: f64| (standard * standard, f64::INFINITY);
    // The prior takes none of the rows: what is left of the scatter has the residuals' degrees of freedom, n − tr H.
    let of_residuals = fitted.components.first().map_or(inverse.dof, |component| component.dof);
    let type_a_dof = if is_pulley_measured { inverse.dof } else { of_residuals };
    let entries = [(type_a * type_a, type_a_dof), known(from_pulley), known(from_weight)];
    let combined = froude_fit::propagate::expanded(&entries, 0.95);
    let slope = take(&fitted, 2)?;
    let pulley_loss = Uncertain { value: slope.value * k, standard: slope.standard * k, dof: slope.dof };
    let force = Uncertain { value: k, standard: combined.standard, dof: combined.dof };
    let ideal = setup.ideal_force_per_volt_n;
    let of_ideal = [entries.as_slice(), &[known(k * setup.ideal_relative)]].concat();
    let of_efficiency = froude_fit::propagate::expanded(&of_ideal, 0.95);
    let friction_v = take(&fitted, 0)?.value;
    let one_way_n = (fitted.coefficients.len() > ONE_WAY).then(|| take(&fitted, ONE_WAY)).transpose()?;
    let one_way_n = one_way_n.map(|d| Uncertain { value: d.value * k, standard: d.standard * k, dof: d.dof });
    Ok(Calibration {
        force_per_volt: force,
        interval_95: [k - combined.expanded, k + combined.expanded],
        efficiency: Uncertain { value: k / ideal, standard: of_efficiency.standard / ideal, dof: of_efficiency.dof },
        type_a,
        from_pulley,
        type_a_dof,
        pulley_loss,
        is_pulley_measured,
        friction_n: friction_v * k,
        one_way_n,
        is_one_way_missed,
        used: driving.len(),
        overhauled,
        notes: notes(force, ideal, overhauled, is_pulley_measured, [loss, pulley_loss], friction_v * k),
    })
}

/// Place of the part of friction that changes its sign with the direction.
const ONE_WAY: usize = 3;

/// Least squares of friction, 1/k, λ/k and friction by direction, the declared loss as a prior that light weights both ways sharpen; also returns whether runs in both directions fail to
/// determine friction by direction.
fn fitted(driving: &[Reading], loss: Uncertain, force_per_volt_n: f64) -> Result<(Fit, bool), DragError> {
    let is_both_ways = [1.0, -1.0].iter().all(|s| driving.iter().any(|r| r.direction == *s));
    let by_direction = |is: bool| fitted_with(driving, loss, force_per_volt_n, is);
    if !is_both_ways {
        return Ok((by_direction(false)?, false));
    }
    // With too few runs, fall back to the mean friction of both directions.
    let is_told = |fit: &Fit| fit.coefficients.iter().all(|c| c.value.is_some() && c.standard.is_some());
    match by_direction(true) {
        Ok(fit) if is_told(&fit) => Ok((fit, false)),
        _ => Ok((by_direction(false)?, true)),
    }
}

fn fitted_with(
    driving: &[Reading],
    loss: Uncertain,
    force_per_volt_n: f64,
    is_by_direction: bool,
) -> Result<Fit, DragError> {
    let columns = ONE_WAY + usize::from(is_by_direction);
    let design = Mat::from_fn(driving.len(), columns, |i, j| match j {
        0 => 1.0,
        1 => driving[i].direction * driving[i].weight_n,
        2 => driving[i].weight_n,
        _ => driving[i].direction,
    });
    let response = driving.iter().map(|r| r.along_v).collect();
    let names = ["friction", "1/k", "loss/k", "friction by direction"].map(str::to_owned)[..columns].to_vec();
    let prior = Prior::new(2, loss.value / force_per_volt_n, loss.standard / force_per_volt_n);
    // Heavy weights scatter more: K_T drifts in proportion to the force.
    let options = Options { priors: vec![prior], covariance: CovarianceKind::Hc3, ..Options::default() };
    fit(&Problem::single(design, response, names), &options).map_err(DragError::calibration)
}

fn take(fitted: &Fit, j: usize) -> Result<Uncertain, DragError> {
    let c = &fitted.coefficients[j];
    match (c.value, c.standard, c.dof) {
        (Some(value), Some(standard), Some(dof)) => Ok(Uncertain { value, standard, dof }),
        _ => Err(DragError::calibration(format!(
            "{} not determine {} with degrees of freedom to spare; repeat every weight at least twice",
            counted(fitted.residuals.len(), "driving run does", "driving runs do"),
            c.name
        ))),
    }
}

fn notes(
    force: Uncertain,
    ideal: f64,
    overhauled: usize,
    is_pulley_measured: bool,
    [loss, found]: [Uncertain; 2],
    friction_n: f64,
) -> Vec<String> {
    let efficiency = force.value / ideal;
    let half = coverage_factor(0.95, force.dof) * force.relative();
    let mut out = vec![format!(
        "{:.4} N/V ± {:.2} % (95 %): the gear gives {:.1} % of the ideal {ideal:.3} N/V",
        force.value,
        100.0 * half,
        100.0 * efficiency
    )];
    if efficiency > 1.0 {
        out.push(format!(
            "that is an efficiency of {efficiency:.3}: check K_T, the amplifier's gain, the sprocket's radius and the weight"
        ));
    }
    if overhauled > 0 {
        out.push(format!(
            "{} left out: the weight may have back-driven the gear, whose losses then differ; weights \
             up to {:.2} N (half the friction, for safety) can be lowered under power",
            counted(overhauled, "run was", "runs were"),
            // Rounded down: the most that is advised is not refused.
            (1e2 * SURELY_DRIVEN * friction_n).floor() / 1e2
        ));
    }
    if (found.value - loss.value).abs() > DOUBTED * loss.standard {
        out.push(format!(
            "the pulley's loss is estimated as {:.1} %, declared is {:.1} ± {:.1} %: the light weight may have driven the gear while it was \
             lowered; hang a lighter one, or check the pulley",
            100.0 * found.value,
            100.0 * loss.value,
            100.0 * loss.standard
        ));
    }
    if !is_pulley_measured {
        out.push(format!(
            "lifting runs only: the declared loss of the pulley is used, {:.1} ± {:.1} % of the weight",
            100.0 * loss.value,
            100.0 * loss.standard
        ));
    }
    out
}

/// Metres for a unit of encoder position, from a known distance: measured marks against logged positions.
///
/// `logged_m` are end positions less start positions by the declared scale, one per traverse; `known_m` the distance
/// between the marks with its uncertainty. The result multiplies every position and speed.
///
/// # Errors
///
/// [`DragError`] below two traverses, or for a distance that is not positive.
pub fn encoder_scale(logged_m: &[f64], known_m: Uncertain) -> Result<Uncertain, DragError> {
    if logged_m.len() < 2 {
        return Err(DragError::calibration(format!(
            "{} traverse between the marks; two are needed to see how well they repeat",
            logged_m.len()
        )));
    }
    if known_m.value.is_nan() || known_m.value <= 0.0 {
        return Err(DragError::calibration(format!("the distance between the marks is {} m", known_m.value)));
    }
    let n = logged_m.len() as f64;
    let average = logged_m.iter().map(|x| x.abs()).sum::<f64>() / n;
    let variance = logged_m.iter().map(|x| (x.abs() - average).powi(2)).sum::<f64>() / (n - 1.0) / n;
    let scale = known_m.value / average;
    let entries = [(variance / (average * average), n - 1.0), (known_m.relative() * known_m.relative(), known_m.dof)];
    let relative = entries.iter().map(|e| e.0).sum::<f64>().sqrt();
    Ok(Uncertain { value: scale, standard: scale * relative, dof: froude_fit::propagate::effective_dof(&entries) })
}

/// What a jog says about polarity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Jog {
    /// A positive command moved the encoder up.
    Right,
    /// A positive command moved the encoder down: motor or encoder is connected the wrong way round, and the position
    /// loop would run away.
    Reversed {
        /// How far the carriage had gone when it was plain, m.
        after_m: f64,
    },
    /// The command never overcame the friction.
    NoMotion {
        /// Largest command, V.
        largest_v: f64,
    },
}

/// Way after which a jog is decided, m: 400 counts of the paper's encoder.
pub const JOG_DECIDED_M: f64 = 1e-3;

/// Evaluates a jog: does the encoder follow the command's sign? Decided within [`JOG_DECIDED_M`].
#[must_use]
pub fn jog(position_m: &[f64], command_v: &[f64]) -> Jog {
    let start = position_m.first().copied().unwrap_or(0.0);
    let mut pushed = 0.0;
    for (x, v) in position_m.iter().zip(command_v) {
        let way = x - start;
        if way.abs() >= JOG_DECIDED_M {
            return if way * pushed > 0.0 { Jog::Right } else { Jog::Reversed { after_m: way.abs() } };
        }
        pushed += v;
    }
    Jog::NoMotion { largest_v: command_v.iter().fold(0.0, |m: f64, v| m.max(v.abs())) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Logged, Scenario};
    use froude_records::estimate::EstimateFile;

    fn quiet() -> Scenario {
        let mut s = Scenario::pinned(20.0);
        (s.run_to_run, s.torque_drift, s.noise_n) = (1e-4, 1e-4, 1e-4);
        s
    }

    fn setup(scenario: &Scenario) -> CalibrationSetup {
        CalibrationSetup {
            ideal_force_per_volt_n: scenario.ideal_force_per_volt_n,
            ideal_relative: 0.02,
            weight_relative: 0.0,
            pulley_loss: PULLEY_LOSS,
            steady: SteadySettings::default(),
        }
    }

    fn calibrated(
        scenario: &Scenario,
        weights: &[f64],
        keep: impl Fn(&DragRun<'_>) -> bool,
    ) -> Result<Calibration, DragError> {
        let logged = scenario.calibration_runs(weights, 4, 1);
        let runs: Vec<_> = logged.iter().map(Logged::view).filter(keep).collect();
        let setup = setup(scenario);
        calibrate(&runs, &setup)
    }

    /// Lifting alone tells (1 + λ)/k: the scatter of quiet runs is nothing, and what is left is the declared loss of the pulley. The efficiency
    /// has the 2 % of K_T in it as well.
    #[test]
    fn what_is_declared_of_pulley_and_constants_is_no_scatter() {
        let lifting = calibrated(&quiet(), &[0.0, 20.0], |_| true).unwrap();
        let k = lifting.force_per_volt;
        assert!(!lifting.is_pulley_measured && lifting.type_a < 0.1 * lifting.from_pulley, "{lifting:?}");
        // ∂k/∂λ = k/(1 + λ); the weight of the prior is that of a first fit, whose k is within 1 %.
        assert!((lifting.from_pulley / (k.value * PULLEY_LOSS.standard) - 1.0).abs() < 0.02, "{lifting:?}");
        assert!((lifting.type_a.hypot(lifting.from_pulley) / k.standard - 1.0).abs() < 1e-12, "{lifting:?}");
        let of_constants = (lifting.efficiency.relative().powi(2) - k.relative().powi(2)).sqrt();
        assert!((of_constants - 0.02).abs() < 1e-12, "{of_constants}");
        let both = calibrated(&quiet(), &[0.0, 1.5, 20.0], |_| true).unwrap();
        assert!(both.is_pulley_measured && both.from_pulley == 0.0, "{both:?}");
    }

    /// One set of weights over one pulley on two days, the second with another gear: their common errors are common, whatever the force per volt.
    #[test]
    fn two_calibrations_have_weights_and_pulley_in_common() {
        let of = |efficiency: f64| {
            let known = record::Known {
                weight_relative: 0.001,
                weights: Some("weights/a".to_owned()),
                pulley_standard: PULLEY_LOSS.standard,
                pulley: Some("rig/a/pulley".to_owned()),
            };
            let day = calibrated(&Scenario { efficiency, ..quiet() }, &[0.0, 20.0], |_| true).unwrap();
            EstimateFile::of(vec![record::calibrated(&format!("day {efficiency}"), &day, &known)])
        };
        let days = [("a.json".to_owned(), of(0.8)), ("b.json".to_owned(), of(0.82))];
        let compared = froude_identify::compare::compare(&froude_identify::compare::named(&days));
        let codes: Vec<&str> = compared.findings.iter().map(|finding| finding.code.as_str()).collect();
        assert!(codes.contains(&"errors-in-common") && !codes.contains(&"errors-contradict"), "{codes:?}");
        // What is common is taken out: k differs by 2.5 %, and the scatter is far below the pulley's 0.58 %.
        assert!(compared.coefficients[0].e_n.unwrap().abs() > 5.0, "{:?}", compared.coefficients);
    }

    /// Without noise to speak of, only the pulley's declared loss (0.3 % of the weight) is left, and light weights lowered
    /// under power measure it.
    #[test]
    fn a_known_weight_finds_the_gears_efficiency() {
        let mut scenario = quiet();
        scenario.pulley_loss = 0.013; // one standard uncertainty beside the declared one
        let heavy = calibrated(&scenario, &[0.0, 20.0], |_| true).unwrap();
        let both = calibrated(&scenario, &[0.0, 1.5, 20.0], |_| true).unwrap();
        let off = |c: &Calibration| c.force_per_volt.value / scenario.force_per_volt_n() - 1.0;
        assert!((off(&heavy) + 0.003).abs() < 4e-4, "{}", off(&heavy));
        assert!(off(&both).abs() < 4e-4, "{}", off(&both));
        assert!((both.pulley_loss.value - 0.013).abs() < 5e-4);
        assert!((both.efficiency.value - 0.8).abs() < 1e-3);
        // Lowering 20 N drives the motor: four runs that do not count.
        assert_eq!((heavy.overhauled, heavy.used), (4, 12));
    }

    /// Friction a tenth larger one way: runs without weight in both directions determine it, and the force per volt is unbiased.
    #[test]
    fn direction_dependent_friction_does_not_bias_the_force_per_volt() {
        let scenario = Scenario { one_way: 0.1, ..Scenario::pinned(20.0) };
        let truth = scenario.force_per_volt_n();
        let setup = setup(&scenario);
        let covered = (1..=100).filter(|seed| {
            let logged = scenario.calibration_runs(&[0.0, 1.0, 10.0], 4, *seed);
            let runs: Vec<_> = logged.iter().map(Logged::view).collect();
            let found = calibrate(&runs, &setup).unwrap();
            let one_way = found.one_way_n.unwrap();
            // 10 % of the friction at 0.1 m/s mid-tank, 3.2 N.
            assert!((one_way.value / 0.32 - 1.0).abs() < 0.5, "{one_way:?}");
            let [low, high] = found.interval_95;
            low <= truth && truth <= high
        });
        // 95 % less three standard deviations.
        assert!(covered.count() >= 89);
        // Without weight one way, with weight the other way.
        let one = quiet().calibration_runs(&[0.0, 10.0], 4, 1);
        let runs = one.iter().map(Logged::view);
        let is_meant = |run: &DragRun<'_>| (run.hung_weight_n == Some(0.0)) == (run.direction < 0.0);
        let runs: Vec<_> = runs.filter(is_meant).collect();
        assert!(calibrate(&runs, &setup).unwrap().is_one_way_missed);
    }

    /// 3 N of weight against 2.9 N of friction behind the gear, 0.9 N before it: on its way down the weight drives the gear and the
    /// motor still has to push. Believed, these runs would raise the force per volt by over 2 %.
    #[test]
    fn a_weight_that_drives_the_gear_while_the_motor_pushes_is_left_out() {
        let scenario = Scenario { motor_coulomb_n: 0.9, ..quiet() };
        let found = calibrated(&scenario, &[0.0, 3.5, 10.0], |_| true).unwrap();
        assert_eq!((found.overhauled, found.used), (8, 16));
        let off = found.force_per_volt.value / scenario.force_per_volt_n() - 1.0;
        assert!(off.abs() < 4e-4, "{off}");
        let pushed = scenario.calibration_runs(&[3.5], 1, 1);
        let down = pushed[1].view();
        let w = window(&down, SteadySettings::default()).unwrap();
        assert!(down.direction < 0.0 && mean(w.of(down.command_v), down.step_s()).value < 0.0);
    }

    #[test]
    fn lifting_one_weight_only_is_refused_with_what_to_add() {
        let why = calibrated(&quiet(), &[20.0], |r| r.direction > 0.0).unwrap_err();
        assert_eq!(
            why.to_string(),
            "calibration: 4 runs, all lifting 20.00 N: friction and weight cannot be distinguished; add runs without weight, or \
             lower a weight that is lighter than the friction"
        );
    }

    #[test]
    fn a_jog_with_motor_or_encoder_reversed_is_caught_within_a_millimetre_or_two() {
        let command = vec![0.3; 200];
        let there: Vec<f64> = (0..200).map(|i| 5e-5 * f64::from(i)).collect();
        let back: Vec<f64> = there.iter().map(|x| -x).collect();
        assert_eq!(jog(&there, &command), Jog::Right);
        assert!(matches!(jog(&back, &command), Jog::Reversed { after_m } if after_m < 2e-3));
        assert_eq!(jog(&[0.0; 200], &command), Jog::NoMotion { largest_v: 0.3 });
    }

    #[test]
    fn a_known_distance_scales_the_encoder() {
        let scale = encoder_scale(&[2.002, -2.001, 2.003, -2.002], Uncertain::new(2.0, 0.0005)).unwrap();
        assert!((scale.value - 2.0 / 2.002).abs() < 1e-12);
        // 0.5 mm of 2 m, and a scatter of 0.8 mm over four: 0.25e-3 and 0.2e-3.
        assert!((scale.standard / scale.value - 3.2e-4).abs() < 2e-5, "{}", scale.standard / scale.value);
    }
}
