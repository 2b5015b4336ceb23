//! The flexible axis: a motor and a load joined by a chain, identified from the motor's side alone.
//!
//! In chain coordinates, `p = Rθ/n` and `m = J_m (n/R)²`, MCD eq. 2a and 2b read
//!
//! `m p̈ + b_m ṗ + c_m sgn ṗ − K(y − p) − B(ẏ − ṗ) = g u`,
//! `M ÿ + b ẏ + c sgn ẏ + K(y − p) + B(ẏ − ṗ) = 0`.
//!
//! Only `p` and `u` are measured. **Identified** by output error: the recorded command drives the model, parameters are moved
//! until the model's motor speed is the measured one. Speed, because an error of position grows without end in an open chain.
//! Measured and simulated position pass the same differences and the same decimation.
//!
//! A force that nobody records leaves an error of speed that lasts seconds, longer than any affordable block. What is left by a
//! first search is therefore described by an autoregression, and a second search minimises what that does not predict
//! (generalised least squares): smaller scatter, and intervals whose blocks hold the correlation that remains.
//!
//! **What the motor cannot tell.** How viscous and Coulomb friction are split between motor and load shows only in the vibration
//! and in the moments of sticking. The sums are coefficients; the splits are fractions in 0…1 with a prior that knows
//! nothing (mean ½, standard deviation of a uniform one), and count as identified only when their interval lies inside 0…1 and is
//! shorter than half of it.
//!
//! # Source
//!
//! MCD eq. 2a, 2b (drag left out: a dry axis), 3b for the sums.

use froude_fit::distribution::coverage_factor;
use froude_fit::faer::Mat;
use froude_fit::{End, Report};
use froude_signal::autocorrelation::{whitened, whitening_filter};
use froude_signal::{decimate, differences};

use crate::servo::chain::{Chain, norm};
use crate::servo::error::ServoError;
use crate::servo::flexible::{Stepper, TwoMass};
use crate::servo::friction::Friction;
use crate::servo::gauss_newton::{Fitted, minimise};
use crate::servo::interval::{IntervalOptions, Whiteness, hac_covariance, over_blocks, whiteness};
use crate::servo::log::ServoLog;
use crate::servo::motor::MotorSide;
use crate::servo::regression::{inverse_gram, least_squares, solve};
use crate::servo::report::ServoCoefficient;

/// Mean and standard deviation of a fraction of which nothing is known.
const KNOWS_NOTHING: [f64; 2] = [0.5, 0.288_675_134_594_812_9];

/// Past of a residual that may predict it, s.
const WHITENING_S: f64 = 0.2;

/// Parameters of the iteration: logarithms of four, sums of two, fractions of two.
const PARAMETERS: usize = 8;

/// How a flexible axis is identified.
#[derive(Debug, Clone, PartialEq)]
pub struct FlexibleOptions {
    /// The drive.
    pub motor: MotorSide,
    /// Decimation of the residuals.
    pub decimation: usize,
    /// Dropped at each end, s.
    pub trim_s: f64,
    /// Longest step of the simulation, s.
    pub step_s: f64,
    /// Antiresonances tried as a start, Hz.
    pub start_hz: Vec<f64>,
    /// How intervals are made.
    pub intervals: IntervalOptions,
}

impl FlexibleOptions {
    /// For a record at 1 kHz and a mode between some 5 and 40 Hz.
    #[must_use]
    pub fn new(motor: MotorSide) -> Self {
        Self {
            motor,
            decimation: 10,
            trim_s: 0.2,
            step_s: 2e-4,
            start_hz: vec![5.0, 6.5, 8.0, 10.0, 13.0, 17.0, 22.0, 30.0],
            intervals: IntervalOptions { resamples: 500, ..IntervalOptions::default() },
        }
    }
}

/// How much of a friction sits at the motor.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// `B_m/B` or `C_m/C`.
    pub name: &'static str,
    /// Share of the motor; it means nothing unless identified.
    pub share_of_motor: f64,
    /// Its interval.
    pub interval: [f64; 2],
    /// Whether the interval lies inside 0…1 and is shorter than half of it.
    pub is_identified: bool,
}

/// What a record says about a flexible axis.
#[derive(Debug, Clone, PartialEq)]
pub struct FlexibleReport {
    /// At the chain: `m`, `M`, `K_e`, `B_e`, `B_sum`, `C_sum`; at the motor: `J_m`, `J_eff`, `B_eff`, `C_eff`; `f_antiresonance`, `f_resonance`.
    pub coefficients: Vec<ServoCoefficient>,
    /// Splits of friction between motor and load.
    pub splits: Vec<Split>,
    /// The axis with these parameters.
    pub axis: TwoMass,
    /// `‖speed − model‖/‖speed‖` of the motor.
    pub relative_speed_error: f64,
    /// Whether the residuals are white after their autoregression.
    pub whiteness: Option<Whiteness>,
    /// Rows compared.
    pub n_rows: usize,
    /// How the iteration ended.
    pub end: Report,
    /// What a reader must know before using the numbers.
    pub findings: Vec<String>,
}

impl FlexibleReport {
    /// The coefficient of that name.
    #[must_use]
    pub fn coefficient(&self, name: &str) -> Option<&ServoCoefficient> {
        self.coefficients.iter().find(|c| c.name == name)
    }
}

/// Identifies a flexible axis from command and motor position, at rest in the beginning.
///
/// A rigid axis fitted below the lowest mode starts the search, on a grid of modes and shares of mass.
///
/// # Errors
///
/// [`ServoError`].
pub fn identify_flexible(log: &ServoLog, options: &FlexibleOptions) -> Result<FlexibleReport, ServoError> {
    let mut record = Record::new(log, options)?;
    let start = record.start(record.rigid()?)?;
    // Natural steps: a tenth of each; a fraction's is a tenth of its range.
    let scale: Vec<f64> = (0..PARAMETERS)
        .map(|j| {
            if j < 4 {
                0.1
            } else if j < 6 {
                0.1 * start[j]
            } else {
                0.1
            }
        })
        .collect();
    let sigma = record.noise(&start)?;
    let fitted = minimise(&start, &scale, |theta| record.residuals_with_prior(theta, sigma))?;
    // Once more, against what the residuals' past does not predict.
    let order = (WHITENING_S * record.row_rate_hz()).round() as usize;
    let left = record.residuals(&record.axis(&fitted.parameters))?;
    record.whitening = whitening_filter(&left, order).unwrap_or_else(|| vec![1.0]);
    let sigma = record.noise(&fitted.parameters)?;
    let fitted = minimise(&fitted.parameters, &scale, |theta| record.residuals_with_prior(theta, sigma))?;
    record.report(&fitted)
}

/// Physical parameters of an iterate; beyond 0…1 a share of Coulomb friction stays at its end, the prior pulls it back.
fn axis_of(theta: &[f64], force_per_volt_n_v: f64) -> TwoMass {
    TwoMass {
        motor_mass_kg: theta[0].exp(),
        load_mass_kg: theta[1].exp(),
        stiffness_n_m: theta[2].exp(),
        damping_n_s_m: theta[3].exp(),
        motor_viscous_n_s_m: theta[4] * theta[6],
        load_viscous_n_s_m: theta[4] * (1.0 - theta[6]),
        motor_coulomb_n: theta[5] * theta[7].clamp(0.0, 1.0),
        load_coulomb_n: theta[5] * (1.0 - theta[7].clamp(0.0, 1.0)),
        force_per_volt_n_v,
    }
}

/// A record made ready for comparison.
struct Record<'a> {
    log: &'a ServoLog,
    options: &'a FlexibleOptions,
    rate_hz: f64,
    /// Autoregression of the residuals; `[1]` before they are known.
    whitening: Vec<f64>,
}

impl<'a> Record<'a> {
    fn new(log: &'a ServoLog, options: &'a FlexibleOptions) -> Result<Self, ServoError> {
        Ok(Self { log, options, rate_hz: log.rate_hz()?, whitening: vec![1.0] })
    }

    /// Measured less simulated speed of the motor, decimated and trimmed, m/s.
    fn residuals(&self, axis: &TwoMass) -> Result<Vec<f64>, ServoError> {
        let start_m = self.log.position_m[0];
        let simulated =
            Stepper::new(axis, self.rate_hz.recip(), self.options.step_s)?.run(&self.log.command_v, start_m)?;
        let apart: Vec<f64> = self.log.position_m.iter().zip(&simulated).map(|(m, s)| m - s).collect();
        self.speed(&apart)
    }

    /// Speed of a position, decimated and trimmed.
    fn speed(&self, position_m: &[f64]) -> Result<Vec<f64>, ServoError> {
        let speed = differences::central(position_m, self.rate_hz.recip())?;
        let speed = decimate::decimate(&speed, self.options.decimation)?;
        let trim = (self.options.trim_s * self.row_rate_hz()).round() as usize;
        let needed = 2 * PARAMETERS;
        if speed.len() < 2 * trim + needed {
            return Err(ServoError::TooFewRows { rows: speed.len().saturating_sub(2 * trim), needed });
        }
        Ok(speed[trim..speed.len() - trim].to_vec())
    }

    fn row_rate_hz(&self) -> f64 {
        self.rate_hz / self.options.decimation as f64
    }

    fn axis(&self, theta: &[f64]) -> TwoMass {
        axis_of(theta, self.options.motor.force_per_volt_n_v())
    }

    /// Residuals that their own past does not predict.
    fn unpredicted(&self, axis: &TwoMass) -> Result<Vec<f64>, ServoError> {
        Ok(whitened(&self.residuals(axis)?, &self.whitening))
    }

    /// Residuals, and two rows of prior in the unit of the residuals.
    fn residuals_with_prior(&self, theta: &[f64], sigma: f64) -> Result<Vec<f64>, ServoError> {
        let mut out = self.unpredicted(&self.axis(theta))?;
        let [mean, std] = KNOWS_NOTHING;
        out.extend(theta[6..].iter().map(|fraction| sigma * (mean - fraction) / std));
        Ok(out)
    }

    /// Scatter of the residuals, as if one row in a correlation time counted.
    fn noise(&self, theta: &[f64]) -> Result<f64, ServoError> {
        let residuals = self.unpredicted(&self.axis(theta))?;
        let time = whiteness(&residuals, 1.0).and_then(|w| w.correlation_time_s).unwrap_or(1.0).max(1.0);
        Ok(norm(&residuals) * (time / residuals.len() as f64).sqrt())
    }

    /// Mass, viscous and Coulomb friction of the rigid axis that the record shows below its lowest mode.
    fn rigid(&self) -> Result<[f64; 3], ServoError> {
        // Rows at 10 Hz: motion below 5 Hz.
        let decimation = (self.rate_hz / 10.0).round().max(1.0) as usize;
        let force_per_volt_n_v = self.options.motor.force_per_volt_n_v();
        let chain =
            Chain { decimation, corner_hz: 10.0, trim_s: 1.0, ..Chain::new(force_per_volt_n_v, Friction::symmetric()) };
        let solution = least_squares(&chain.rows(self.log)?)?;
        Ok([solution.coefficients[0], solution.coefficients[1], solution.coefficients[2]])
    }

    /// The best of a grid of antiresonances and shares of mass.
    fn start(&self, [mass_kg, viscous_n_s_m, coulomb_n]: [f64; 3]) -> Result<Vec<f64>, ServoError> {
        let mut best: Option<(f64, Vec<f64>)> = None;
        for hz in &self.options.start_hz {
            for share in [0.2_f64, 0.35, 0.5, 0.7] {
                let load_kg = mass_kg * (1.0 - share);
                let omega = 2.0 * std::f64::consts::PI * hz;
                // A twentieth of critical damping.
                let damping = 0.1 * load_kg * omega;
                let logs = [mass_kg * share, load_kg, load_kg * omega * omega, damping].map(f64::ln);
                let mut theta = logs.to_vec();
                theta.extend([viscous_n_s_m.max(0.1 * mass_kg), coulomb_n.max(1e-3), 0.5, 0.5]);
                let Ok(residuals) = self.residuals(&self.axis(&theta)) else { continue };
                let size = norm(&residuals);
                if best.as_ref().is_none_or(|(least, _)| size < *least) {
                    best = Some((size, theta));
                }
            }
        }
        let must = "no start of the search could be simulated; check mass and friction of the rigid fit";
        best.map(|(_, theta)| theta).ok_or(ServoError::Setting {
            what: "mass of the rigid axis (kg)",
            found: mass_kg,
            must,
        })
    }

    fn report(&self, fitted: &Fitted) -> Result<FlexibleReport, ServoError> {
        let theta = &fitted.parameters;
        let axis = self.axis(theta);
        let n = fitted.residuals.len() - 2;
        let covariance = self.covariance(fitted, n)?;
        let whiteness = whiteness(&fitted.residuals[..n], self.row_rate_hz());
        let speed = self.speed(&self.log.position_m)?;
        let coefficients = self.coefficients(theta, &covariance);
        let splits = [(6, "B_m/B"), (7, "C_m/C")].map(|(j, name)| {
            let half = covariance.factor * covariance.blocks[(j, j)].sqrt();
            let interval = [theta[j] - half, theta[j] + half];
            Split { name, share_of_motor: theta[j], interval, is_identified: is_told(interval) }
        });
        let mut findings = Vec::new();
        for s in splits.iter().filter(|s| !s.is_identified) {
            findings.push(format!(
                "{} is not identifiable from the motor's side: its interval [{:.2}, {:.2}] does not lie inside 0 to 1 or covers half of it",
                s.name, s.interval[0], s.interval[1]
            ));
        }
        if fitted.report.end != End::Converged {
            findings.push(format!("the search ended unconverged after {} steps", fitted.report.iterations));
        }
        Ok(FlexibleReport {
            coefficients,
            splits: splits.to_vec(),
            axis,
            relative_speed_error: norm(&self.residuals(&axis)?) / norm(&speed),
            whiteness,
            n_rows: n,
            end: fitted.report,
            findings,
        })
    }

    /// Covariances of the parameters of the iteration, three ways.
    fn covariance(&self, fitted: &Fitted, n: usize) -> Result<Covariance, ServoError> {
        let solution = solve(&fitted.columns, &fitted.residuals)?;
        let gram = inverse_gram(&solution);
        let data: Vec<Vec<f64>> = fitted.columns.iter().map(|c| c[..n].to_vec()).collect();
        let options = &self.options.intervals;
        let (hac, _) = hac_covariance(&data, &fitted.residuals[..n], &gram, self.row_rate_hz(), options.hac_lag_s);
        // Resamples of the data; the prior stays, its mean drawn by nobody: its variance is added below.
        let over = over_blocks(n, self.row_rate_hz(), PARAMETERS, options, |chosen| {
            let pick = |c: &Vec<f64>| chosen.iter().map(|&i| c[i]).chain(c[n..].iter().copied()).collect::<Vec<f64>>();
            let columns: Vec<Vec<f64>> = fitted.columns.iter().map(pick).collect();
            solve(&columns, &pick(&fitted.residuals)).ok().map(|s| s.coefficients)
        })?;
        let prior = Self::of_prior(fitted, n, &gram);
        let sum = |a: &Mat<f64>| Mat::from_fn(PARAMETERS, PARAMETERS, |i, j| a[(i, j)] + prior[(i, j)]);
        let scatter = norm(&fitted.residuals[..n]) / ((n - PARAMETERS) as f64).sqrt();
        Ok(Covariance {
            classical: Mat::from_fn(PARAMETERS, PARAMETERS, |i, j| scatter * scatter * gram[(i, j)]),
            hac: sum(&hac),
            blocks: sum(&over.covariance),
            factor: coverage_factor(options.confidence, over.dof),
        })
    }

    /// What the prior's own uncertainty brings: `G x_k x_kᵀ G` for its two rows, of variance `σ²` each.
    fn of_prior(fitted: &Fitted, n: usize, gram: &Mat<f64>) -> Mat<f64> {
        let [_, std] = KNOWS_NOTHING;
        let mut out = Mat::zeros(PARAMETERS, PARAMETERS);
        for (k, j) in [(n, 6), (n + 1, 7)] {
            let row = Mat::from_fn(PARAMETERS, 1, |l, _| fitted.columns[l][k]);
            let moved = gram * &row;
            let sigma = fitted.columns[j][k].abs() * std;
            for a in 0..PARAMETERS {
                for b in 0..PARAMETERS {
                    out[(a, b)] += sigma * sigma * moved[(a, 0)] * moved[(b, 0)];
                }
            }
        }
        out
    }

    /// Physical coefficients; their spread by the chain rule, positive ones on a logarithmic scale.
    fn coefficients(&self, theta: &[f64], covariance: &Covariance) -> Vec<ServoCoefficient> {
        let motor = self.options.motor;
        let axis = self.axis(theta);
        let (m, load) = (axis.motor_mass_kg, axis.load_mass_kg);
        let total = m + load;
        // Value and gradient of its logarithm over the parameters of the iteration.
        let log_of = |j: usize| unit_vector(j, 1.0);
        let sum_of = |j: usize| unit_vector(j, 1.0 / theta[j]);
        let mut shares = [0.0; PARAMETERS];
        (shares[0], shares[1]) = (m / total, load / total);
        let mut antiresonance = [0.0; PARAMETERS];
        (antiresonance[1], antiresonance[2]) = (-0.5, 0.5);
        let mut resonance = [0.0; PARAMETERS];
        (resonance[0], resonance[1], resonance[2]) = (-0.5 * load / total, -0.5 * m / total, 0.5);
        let viscous = theta[4];
        [
            ("m", "kg", m, log_of(0)),
            ("M", "kg", load, log_of(1)),
            ("K_e", "N/m", axis.stiffness_n_m, log_of(2)),
            ("B_e", "N s/m", axis.damping_n_s_m, log_of(3)),
            ("B_sum", "N s/m", viscous, sum_of(4)),
            ("C_sum", "N", theta[5], sum_of(5)),
            ("J_m", "kg m^2", motor.inertia_kg_m2(m), log_of(0)),
            ("J_eff", "kg m^2", motor.inertia_kg_m2(total), shares),
            ("B_eff", "N m s/rad", motor.viscous_n_m_s_rad(viscous), sum_of(4)),
            ("C_eff", "N m", motor.torque_n_m(theta[5]), sum_of(5)),
            ("f_antiresonance", "Hz", axis.antiresonance_hz(), antiresonance),
            ("f_resonance", "Hz", axis.resonance_hz(), resonance),
        ]
        .into_iter()
        .map(|(name, unit, value, gradient)| {
            let std = |c: &Mat<f64>| quadratic(&gradient, c).max(0.0).sqrt();
            let half = covariance.factor * std(&covariance.blocks);
            ServoCoefficient {
                name: name.to_owned(),
                unit,
                value,
                classical_std: value.abs() * std(&covariance.classical),
                hac_std: value.abs() * std(&covariance.hac),
                block_std: value.abs() * std(&covariance.blocks),
                interval: [value * (-half).exp(), value * half.exp()],
            }
        })
        .collect()
    }
}

/// Whether an interval of a share says something: inside 0…1, and shorter than half of it.
fn is_told([low, high]: [f64; 2]) -> bool {
    low > 0.0 && high < 1.0 && high - low < 0.5
}

struct Covariance {
    classical: Mat<f64>,
    hac: Mat<f64>,
    blocks: Mat<f64>,
    factor: f64,
}

fn unit_vector(j: usize, value: f64) -> [f64; PARAMETERS] {
    let mut out = [0.0; PARAMETERS];
    out[j] = value;
    out
}

/// `gᵀ C g`.
fn quadratic(g: &[f64; PARAMETERS], c: &Mat<f64>) -> f64 {
    (0..PARAMETERS).map(|i| (0..PARAMETERS).map(|j| g[i] * c[(i, j)] * g[j]).sum::<f64>()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::synthetic::{Noise, carriage, record};

    /// Two seeds; the validation has a hundred. Four standard deviations with some ten degrees of freedom: one in 400.
    #[test]
    fn the_axis_is_found_from_the_motor_side_within_its_uncertainty() {
        let axis = carriage();
        let noise = Noise { force_std_n: 0.05, ..Noise::encoder_only() };
        for seed in 0..2 {
            let log = record(&axis, 1000.0, 10.0, &noise, seed).unwrap();
            let report = identify_flexible(&log, &FlexibleOptions::new(MotorSide::MCD)).unwrap();
            assert_eq!(report.end.end, End::Converged);
            for (name, truth) in [
                ("m", axis.motor_mass_kg),
                ("M", axis.load_mass_kg),
                ("K_e", axis.stiffness_n_m),
                ("B_e", axis.damping_n_s_m),
                ("J_eff", 1.502e-5),
                ("B_eff", 4.657e-6),
                ("C_eff", 3.9e-3),
                ("f_antiresonance", 13.0),
            ] {
                let c = report.coefficient(name).unwrap();
                assert!(
                    (c.value - truth).abs() < 4.0 * c.block_std,
                    "{name}: {} ± {}, truth {truth}",
                    c.value,
                    c.block_std
                );
            }
        }
    }

    /// Under a disturbing force a third of friction the share of viscous friction drowns (at 0.05 N it is known to 0.05): that is said.
    #[test]
    fn a_split_that_the_record_does_not_show_is_not_reported_as_identified() {
        let noise = Noise { force_std_n: 0.8, ..Noise::encoder_only() };
        let log = record(&carriage(), 1000.0, 10.0, &noise, 1).unwrap();
        let report = identify_flexible(&log, &FlexibleOptions::new(MotorSide::MCD)).unwrap();
        let split = &report.splits[0];
        assert!(!split.is_identified, "{split:?}");
        assert!(report.findings.iter().any(|f| f.starts_with("B_m/B is not identifiable from the motor's side")));
    }
}
