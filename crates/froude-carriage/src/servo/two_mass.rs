//! The flexible axis: a motor and a load joined by a chain, identified from the motor's side alone.
//!
//! In chain coordinates, `p = Rθ/n` and `m = J_m (n/R)²`, MCD eq. 2a and 2b read, with the drag and the gear that the paper leaves out,
//!
//! `m p̈ + b_m ṗ + c_m sgn ṗ + r F = g u`, `F = K(p − y) + B(ṗ − ẏ)`, `r = 1/η` while `F ṗ > 0`, else `η_b`,
//! `M ÿ + b ẏ + c sgn ẏ + D ẏ|ẏ| = F`.
//!
//! Only `p` and `u` are measured. **Identified** by prediction error: an observer that runs the model and is corrected at every sample by
//! the encoder ([`Stepper::innovations`]) predicts the next position, and parameters are moved until the squares of what it fails to
//! predict are least. A free simulation would carry an unrecorded force for seconds, and would see it as
//! a slow error of speed that no block holds; here it acts once, and what is left is nearly white. How much the observer trusts the encoder, the
//! ratio of unrecorded force to noise of position, is the one that predicts best.
//!
//! **Intervals** are those of stretches of a second as clusters (CR2, Student's t with the degrees of freedom of each coefficient), so that
//! correlation which the observer leaves is in them. Declared inputs (η, η_b, D, delay, force per volt) move
//! the estimate by one linearised step, and the sprocket's radius scales it; their standard uncertainties are added.
//!
//! **What the motor cannot tell.** How viscous and Coulomb friction are split between motor and load shows only in the vibration
//! and in the moments of sticking. The sums are coefficients; the splits are fractions in 0…1 with a prior that knows
//! nothing (mean ½, standard deviation of a uniform one), and count as identified only when their interval lies inside 0…1 and is
//! shorter than half of it. The force per volt cannot be distinguished from the masses, nor η from the load's mass.
//!
//! # Source
//!
//! MCD eq. 2a, 2b, 3b for the sums; Ljung (1999), *System Identification*, 2nd ed., 7.2 and 4.3 (prediction errors of a state-space model
//! in innovations form).

mod covariance;
mod report;

use froude_fit::faer::Mat;
use froude_fit::{End, Report};
use froude_signal::two_mass::TwoMasses;
use froude_signal::{decimate, differences};

use crate::servo::chain::Chain;
use crate::servo::cluster::{Clustered, Enlarged, stretches};
use crate::servo::error::ServoError;
use crate::servo::flexible::{Stepper, TwoMass};
use crate::servo::friction::Friction;
use crate::servo::gauss_newton::{DIFFERENCE, Fitted, minimise};
use crate::servo::interval::{BLOCK_S, hac_covariance, whiteness};
use crate::servo::log::ServoLog;
use crate::servo::regression::{inverse_gram, least_squares, solve};
use crate::servo::report::ServoCoefficient;
use crate::servo::rows::norm;
use crate::servo::two_mass::covariance::{Covariance, PARAMETERS, add_outer, quadratic, times, unit_vector};

pub use crate::servo::two_mass::covariance::radius_power;
pub use crate::servo::two_mass::report::{FlexibleOptions, FlexibleReport, Gear, Split};

/// Mean and standard deviation of a fraction of which nothing is known.
const KNOWS_NOTHING: [f64; 2] = [0.5, 0.288_675_134_594_812_9];

/// Parameters at the chain: two masses, stiffness, damping, sums of viscous and of Coulomb friction.
pub const CHAIN_PARAMETERS: usize = 6;

/// Most rough searches, the ratio of force to noise chosen anew before each.
const SEARCHES: usize = 2;
/// Ratios tried: decades of N/m, and the part of a decade between them.
const RATIO_DECADES: [f64; 2] = [3.0, 8.0];
const RATIO_STEP: f64 = 0.5;
/// A change of the ratio that no longer matters, decades.
const RATIO_TOLERANCE: f64 = 0.1;

/// Rate at which free simulation and record are compared, Hz, and what is dropped at each end, s.
const SPEED_RATE_HZ: f64 = 100.0;
const TRIM_S: f64 = 0.2;

/// Identifies a flexible axis from command and motor position, at rest in the beginning.
///
/// A rigid axis fitted below the lowest mode starts the search, on a grid of modes and shares of mass.
///
/// # Errors
///
/// [`ServoError`].
pub fn identify_flexible(log: &ServoLog, options: &FlexibleOptions) -> Result<FlexibleReport, ServoError> {
    let mut record = Record::new(log, options)?;
    // Found with one step a sample, then once more with the steps asked for.
    record.step_s = record.step_s.max(record.rate_hz.recip());
    let start = record.start(record.rigid()?)?;
    // Natural steps: a tenth of each; a fraction's is a tenth of its range.
    let scale: Vec<f64> = (0..PARAMETERS).map(|j| if (4..6).contains(&j) { 0.1 * start[j] } else { 0.1 }).collect();
    let mut ratio = record.best_ratio(&start)?;
    let mut fitted = record.search(&start, &scale, ratio)?;
    for _ in 1..SEARCHES {
        let better = record.best_ratio(&fitted.parameters)?;
        if (better - ratio).abs() < RATIO_TOLERANCE {
            break;
        }
        ratio = better;
        fitted = record.search(&fitted.parameters, &scale, ratio)?;
    }
    // Differences over ± half a standard deviation: kinks within it are no slope.
    let scale = spreads(&fitted)?.map(|std| 0.5 * std / DIFFERENCE);
    record.step_s = options.step_s;
    let ratio = record.best_ratio(&fitted.parameters)?;
    let fitted = record.search(&fitted.parameters, &scale, ratio)?;
    record.report(&fitted)
}

/// Standard deviations of the parameters, were the innovations white.
fn spreads(fitted: &Fitted) -> Result<[f64; PARAMETERS], ServoError> {
    let solution = solve(&fitted.columns, &fitted.residuals)?;
    Ok(std::array::from_fn(|j| solution.standard[j]))
}

/// A record made ready for comparison.
struct Record<'a> {
    log: &'a ServoLog,
    options: &'a FlexibleOptions,
    rate_hz: f64,
    /// Longest step of the simulation, s.
    step_s: f64,
    /// Values of the declared inputs.
    declared: [f64; 4],
    gain: [f64; 4],
}

impl<'a> Record<'a> {
    fn new(log: &'a ServoLog, options: &'a FlexibleOptions) -> Result<Self, ServoError> {
        let rate_hz = log.rate_hz()?;
        let needed = (PARAMETERS + 2) * (BLOCK_S * rate_hz).ceil() as usize;
        if log.position_m.len() < needed {
            return Err(ServoError::TooFewRows { rows: log.position_m.len(), needed });
        }
        Ok(Self {
            log,
            options,
            rate_hz,
            step_s: options.step_s,
            declared: options.declared().map(|d| d.value),
            gain: [0.0; 4],
        })
    }

    /// Physical parameters of an iterate; beyond 0…1 a share of Coulomb friction stays at its end, the prior pulls it back.
    fn axis(&self, theta: &[f64]) -> TwoMass {
        let [efficiency_forward, efficiency_backward, load_drag_n_s2_m2, delay_s] = self.declared;
        let masses = TwoMasses {
            motor_mass_kg: theta[0].exp(),
            load_mass_kg: theta[1].exp(),
            stiffness_n_m: theta[2].exp(),
            damping_n_s_m: theta[3].exp(),
            motor_viscous_n_s_m: theta[4] * theta[6],
            load_viscous_n_s_m: theta[4] * (1.0 - theta[6]),
        };
        TwoMass {
            masses,
            motor_coulomb_n: theta[5] * theta[7].clamp(0.0, 1.0),
            load_coulomb_n: theta[5] * (1.0 - theta[7].clamp(0.0, 1.0)),
            force_per_volt_n_v: self.options.motor.force_per_volt_n_v(),
            efficiency_forward,
            efficiency_backward,
            load_drag_n_s2_m2,
            delay_s,
        }
    }

    fn stepper(&self, theta: &[f64]) -> Result<Stepper, ServoError> {
        Stepper::new(&self.axis(theta), self.rate_hz.recip(), self.step_s)
    }

    /// What the observer does not predict, m.
    fn unpredicted(&self, theta: &[f64]) -> Result<Vec<f64>, ServoError> {
        self.stepper(theta)?.innovations(&self.log.command_v, &self.log.position_m, &self.gain)
    }

    /// The ratio of unrecorded force to noise of position that predicts best, as decades of N/m.
    fn best_ratio(&self, theta: &[f64]) -> Result<f64, ServoError> {
        let stepper = self.stepper(theta)?;
        let squares = |decades: f64| -> Result<f64, ServoError> {
            let gain = stepper.gain(10_f64.powf(decades));
            let left = stepper.innovations(&self.log.command_v, &self.log.position_m, &gain)?;
            Ok(norm(&left).ln())
        };
        let [first, last] = RATIO_DECADES;
        let count = ((last - first) / RATIO_STEP).round() as usize;
        let tried: Vec<f64> =
            (0..=count).map(|i| squares(first + RATIO_STEP * i as f64)).collect::<Result<_, ServoError>>()?;
        let least = (0..=count).min_by(|&i, &j| tried[i].total_cmp(&tried[j])).unwrap_or(0);
        let at = first + RATIO_STEP * least as f64;
        if least == 0 || least == count {
            return Ok(at);
        }
        // The lowest point of the parabola through it and its neighbours.
        let (below, here, above) = (tried[least - 1], tried[least], tried[least + 1]);
        Ok(at + 0.5 * RATIO_STEP * (below - above) / (below - 2.0 * here + above).max(f64::MIN_POSITIVE))
    }

    /// Least squares of what an observer with this ratio does not predict.
    fn search(&mut self, start: &[f64], scale: &[f64], ratio: f64) -> Result<Fitted, ServoError> {
        self.gain = self.stepper(start)?.gain(10_f64.powf(ratio));
        let sigma = self.noise(start)?;
        minimise(start, scale, |theta| self.residuals_with_prior(theta, sigma))
    }

    /// Innovations, and two rows of prior in their unit.
    fn residuals_with_prior(&self, theta: &[f64], sigma: f64) -> Result<Vec<f64>, ServoError> {
        let mut out = self.unpredicted(theta)?;
        let [mean, std] = KNOWS_NOTHING;
        out.extend(theta[6..].iter().map(|fraction| sigma * (mean - fraction) / std));
        Ok(out)
    }

    /// Scatter of the innovations, as if one row in a correlation time counted.
    fn noise(&self, theta: &[f64]) -> Result<f64, ServoError> {
        let residuals = self.unpredicted(theta)?;
        let time = whiteness(&residuals, 1.0).and_then(|w| w.correlation_time_s).unwrap_or(1.0).max(1.0);
        Ok(norm(&residuals) * (time / residuals.len() as f64).sqrt())
    }

    /// Speed of a position, decimated and trimmed, m/s.
    fn speed(&self, position_m: &[f64]) -> Result<Vec<f64>, ServoError> {
        let decimation = (self.rate_hz / SPEED_RATE_HZ).round().max(1.0) as usize;
        let speed = differences::central(position_m, self.rate_hz.recip())?;
        let speed = decimate::decimate(&speed, decimation)?;
        let trim = (TRIM_S * self.rate_hz / decimation as f64).round() as usize;
        Ok(speed[trim..speed.len() - trim].to_vec())
    }

    /// Measured less freely simulated speed of the motor, m/s.
    fn speed_error(&self, theta: &[f64]) -> Result<Vec<f64>, ServoError> {
        let simulated = self.stepper(theta)?.run(&self.log.command_v, self.log.position_m[0])?;
        let apart: Vec<f64> = self.log.position_m.iter().zip(&simulated).map(|(m, s)| m - s).collect();
        self.speed(&apart)
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
            for share in [0.1_f64, 0.2, 0.35, 0.5, 0.7] {
                // What the motor feels of the load it feels through the gear.
                let load_kg = mass_kg * (1.0 - share) * self.declared[0];
                let omega = 2.0 * std::f64::consts::PI * hz;
                // A twentieth of critical damping.
                let damping = 0.1 * load_kg * omega;
                let logs = [mass_kg * share, load_kg, load_kg * omega * omega, damping].map(f64::ln);
                let mut theta = logs.to_vec();
                theta.extend([viscous_n_s_m.max(0.1 * mass_kg), coulomb_n.max(1e-3), 0.5, 0.5]);
                let Ok(residuals) = self.speed_error(&theta) else { continue };
                let size = norm(&residuals);
                if best.as_ref().is_none_or(|(least, _)| size < *least) {
                    best = Some((size, theta));
                }
            }
        }
        let must = "no starting point of the search could be simulated; check mass and friction of the rigid fit";
        best.map(|(_, theta)| theta).ok_or(ServoError::Setting {
            what: "mass of the rigid axis (kg)",
            found: mass_kg,
            must,
        })
    }

    fn report(&self, fitted: &Fitted) -> Result<FlexibleReport, ServoError> {
        let theta = &fitted.parameters;
        let n = fitted.residuals.len() - 2;
        let covariance = self.covariance(fitted, n)?;
        let innovations = &fitted.residuals[..n];
        let splits = [(6, "B_m/B"), (7, "C_m/C")].map(|(j, name)| {
            let half = covariance.half_width(&unit_vector(j, 1.0), 0.0);
            let interval = [theta[j] - half, theta[j] + half];
            Split { name, share_of_motor: theta[j], interval, is_identified: is_told(interval) }
        });
        Ok(FlexibleReport {
            scatter: at_the_chain(&covariance.clustered.covariance, theta),
            declared: at_the_chain(&covariance.declared, theta),
            dof: (0..CHAIN_PARAMETERS).map(|j| covariance.clustered.dof(&unit_vector(j, 1.0))).collect(),
            coefficients: self.coefficients(theta, &covariance),
            axis: self.axis(theta),
            is_apparent: self.options.gear == Gear::Undeclared,
            whiteness: whiteness(innovations, self.rate_hz),
            n_rows: n,
            end: fitted.report,
            findings: self.findings(&splits, &fitted.report),
            splits: splits.to_vec(),
        })
    }

    fn findings(&self, splits: &[Split], end: &Report) -> Vec<String> {
        let mut findings = Vec::new();
        for s in splits.iter().filter(|s| !s.is_identified) {
            findings.push(format!(
                "{} is not identifiable from the motor's side: its interval [{:.2}, {:.2}] leaves the range 0 to 1, or covers half of it or more",
                s.name, s.interval[0], s.interval[1]
            ));
        }
        if self.options.gear == Gear::Undeclared {
            findings.push(
                "no efficiency of the gear is declared: mass, stiffness, damping and friction behind it are apparent, through the gear, 1/eta times the true ones while the motor drives and eta_b times while it is driven (1.25 and 0.75 for a gear of 0.8 and 0.75), and their intervals do not include that factor"
                    .to_owned(),
            );
        }
        if end.end != End::Converged {
            findings.push(format!("the search ended unconverged after {} steps", end.iterations));
        }
        findings
    }

    /// Covariances of the parameters of the iteration, three ways.
    fn covariance(&self, fitted: &Fitted, n: usize) -> Result<Covariance, ServoError> {
        let gram = inverse_gram(&solve(&fitted.columns, &fitted.residuals)?);
        let data: Vec<Vec<f64>> = fitted.columns.iter().map(|c| c[..n].to_vec()).collect();
        let innovations = &fitted.residuals[..n];
        let (hac, _) = hac_covariance(&data, innovations, &gram, self.rate_hz, None);
        let information = Mat::from_fn(PARAMETERS, PARAMETERS, |i, j| {
            (n..n + 2).map(|k| fitted.columns[i][k] * fitted.columns[j][k]).sum()
        });
        let length = (BLOCK_S * self.rate_hz).round() as usize;
        let clustered =
            Clustered::new(&data, innovations, &stretches(n, length), Some(&information), Enlarged::Average)?;
        let prior = Self::of_prior(fitted, n, &gram);
        let declared = &prior + &self.of_declared(fitted, &gram)?;
        let mut known = declared.clone();
        // The force per volt scales masses, stiffness and friction alike.
        let theta = &fitted.parameters;
        add_outer(&mut known, &[1.0, 1.0, 1.0, 1.0, theta[4], theta[5], 0.0, 0.0], self.options.force_relative);
        let scatter = norm(innovations) / ((n - PARAMETERS) as f64).sqrt();
        Ok(Covariance {
            classical: Mat::from_fn(PARAMETERS, PARAMETERS, |i, j| scatter * scatter * gram[(i, j)]),
            hac: &hac + &prior,
            declared,
            known,
            radius_relative: self.options.radius_relative,
            clustered,
        })
    }

    /// What the prior's own uncertainty brings: `G x_k x_kᵀ G` for its two rows, of variance `σ²` each.
    fn of_prior(fitted: &Fitted, n: usize, gram: &Mat<f64>) -> Mat<f64> {
        let [_, std] = KNOWS_NOTHING;
        let mut out = Mat::zeros(PARAMETERS, PARAMETERS);
        for (k, j) in [(n, 6), (n + 1, 7)] {
            let row: Vec<f64> = fitted.columns.iter().map(|c| c[k]).collect();
            add_outer(&mut out, &times(gram, &row), fitted.columns[j][k].abs() * std);
        }
        out
    }

    /// What the declared inputs' uncertainties bring: each moves the estimate by one linearised step.
    fn of_declared(&self, fitted: &Fitted, gram: &Mat<f64>) -> Result<Mat<f64>, ServoError> {
        let theta = &fitted.parameters;
        let mut out = Mat::zeros(PARAMETERS, PARAMETERS);
        for (k, input) in self.options.declared().iter().enumerate().filter(|(_, d)| d.standard > 0.0) {
            // Half a standard uncertainty to either side, unless that is not possible (a delay below zero).
            let moved = |by: f64| {
                let mut record = Record { declared: self.declared, ..*self };
                record.declared[k] += by * input.standard;
                record.unpredicted(theta)
            };
            let (up, down, width) = match moved(-0.5) {
                Ok(down) => (moved(0.5)?, down, 1.0),
                Err(_) => (moved(0.5)?, moved(0.0)?, 0.5),
            };
            let score: Vec<f64> = fitted
                .columns
                .iter()
                .map(|c| up.iter().zip(&down).zip(c).map(|((u, d), x)| (u - d) / width * x).sum::<f64>())
                .collect();
            add_outer(&mut out, &times(gram, &score), 1.0);
        }
        Ok(out)
    }

    /// Physical coefficients; their spread by the chain rule: masses, stiffness and damping on a logarithmic scale, friction on its own.
    fn coefficients(&self, theta: &[f64], covariance: &Covariance) -> Vec<ServoCoefficient> {
        let motor = self.options.motor;
        let axis = self.axis(theta).masses;
        let (m, load) = (axis.motor_mass_kg, axis.load_mass_kg);
        let total = m + load;
        // Gradient, over the parameters of the iteration, of the logarithm or of the value.
        let log_of = |j: usize| (true, unit_vector(j, 1.0));
        let sum_of = |j: usize, factor: f64| (false, unit_vector(j, factor));
        let logs = |gradient: [f64; 3]| {
            let mut out = [0.0; PARAMETERS];
            out[..3].copy_from_slice(&gradient);
            (true, out)
        };
        let (viscous, coulomb) = (motor.viscous_n_m_s_rad(1.0), motor.torque_n_m(1.0));
        [
            ("m", "kg", m, log_of(0)),
            ("M", "kg", load, log_of(1)),
            ("K_e", "N/m", axis.stiffness_n_m, log_of(2)),
            ("B_e", "N s/m", axis.damping_n_s_m, log_of(3)),
            ("B_sum", "N s/m", theta[4], sum_of(4, 1.0)),
            ("C_sum", "N", theta[5], sum_of(5, 1.0)),
            ("J_m", "kg m^2", motor.inertia_kg_m2(m), log_of(0)),
            ("J_eff", "kg m^2", motor.inertia_kg_m2(total), logs([m / total, load / total, 0.0])),
            ("B_eff", "N m s/rad", viscous * theta[4], sum_of(4, viscous)),
            ("C_eff", "N m", coulomb * theta[5], sum_of(5, coulomb)),
            ("f_antiresonance", "Hz", axis.antiresonance_hz(), logs([0.0, -0.5, 0.5])),
            ("f_resonance", "Hz", axis.resonance_hz(), logs([-0.5 * load / total, -0.5 * m / total, 0.5])),
        ]
        .into_iter()
        .map(|(name, unit, value, (is_log, gradient))| {
            let radius = radius_power(name) * if is_log { 1.0 } else { value };
            let half = covariance.half_width(&gradient, radius);
            let scale = if is_log { value } else { 1.0 };
            let interval =
                if is_log { [value * (-half).exp(), value * half.exp()] } else { [value - half, value + half] };
            ServoCoefficient {
                name: name.to_owned(),
                unit: unit.into(),
                value,
                classical_std: scale * quadratic(&gradient, &covariance.classical).sqrt(),
                hac_std: scale * quadratic(&gradient, &covariance.hac).sqrt(),
                block_std: scale * covariance.variance(&gradient, radius).sqrt(),
                interval,
            }
        })
        .collect()
    }
}

/// Covariance of the parameters at the chain: the iteration's first four are logarithms of them.
fn at_the_chain(covariance: &Mat<f64>, theta: &[f64]) -> Mat<f64> {
    let scale = |j: usize| if j < 4 { theta[j].exp() } else { 1.0 };
    Mat::from_fn(CHAIN_PARAMETERS, CHAIN_PARAMETERS, |i, j| scale(i) * scale(j) * covariance[(i, j)])
}

/// Whether an interval of a share says something: inside 0…1, and shorter than half of it.
fn is_told([low, high]: [f64; 2]) -> bool {
    low > 0.0 && high < 1.0 && high - low < 0.5
}

#[cfg(test)]
mod tests {
    use froude_fit::budget::Uncertain;

    use super::*;
    use crate::flexible_axis::{Noise, carriage, record};
    use crate::servo::motor::MotorSide;

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
                ("m", axis.masses.motor_mass_kg),
                ("M", axis.masses.load_mass_kg),
                ("K_e", axis.masses.stiffness_n_m),
                ("B_e", axis.masses.damping_n_s_m),
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

    /// A sprocket that is 1 % larger than declared: positions are 1 % larger and forces 1 % smaller than recorded. Each coefficient follows the
    /// power that its uncertainty of the radius has.
    #[test]
    fn coefficients_follow_the_radius_by_their_power() {
        let noise = Noise { force_std_n: 0.05, ..Noise::encoder_only() };
        let log = record(&carriage(), 1000.0, 10.0, &noise, 4).unwrap();
        let larger = 1.01;
        let scaled = ServoLog { position_m: log.position_m.iter().map(|y| larger * y).collect(), ..log.clone() };
        let motor = MotorSide::MCD;
        let of = |log: &ServoLog, motor| identify_flexible(log, &FlexibleOptions::new(motor)).unwrap();
        let declared = of(&log, motor);
        let true_one = of(&scaled, MotorSide { sprocket_radius_m: larger * motor.sprocket_radius_m, ..motor });
        for (c, other) in declared.coefficients.iter().zip(&true_one.coefficients) {
            let expected = larger.powf(radius_power(&c.name));
            // The searches end within a thousandth of a standard deviation.
            let step = 0.02 * c.block_std / c.value.abs();
            assert!(
                (other.value / c.value / expected - 1.0).abs() < step,
                "{}: {} of {}",
                c.name,
                other.value,
                c.value
            );
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

    #[test]
    fn a_load_behind_a_gear_is_itself_where_the_gear_is_declared_and_apparent_where_it_is_not() {
        let axis = TwoMass { efficiency_forward: 0.8, efficiency_backward: 0.75, ..carriage() };
        let log = record(&axis, 1000.0, 10.0, &Noise { force_std_n: 0.05, ..Noise::encoder_only() }, 3).unwrap();
        let of =
            |gear| identify_flexible(&log, &FlexibleOptions { gear, ..FlexibleOptions::new(MotorSide::MCD) }).unwrap();
        let eta = |value: f64| Uncertain::new(value, 0.02 * value);
        let report = of(Gear::Declared { forward: eta(0.8), backward: eta(0.75) });
        let c = report.coefficient("M").unwrap();
        assert!((c.interval[0]..=c.interval[1]).contains(&axis.masses.load_mass_kg), "{c:?}");
        // What 2 % of the efficiency is worth is in the interval.
        assert!(c.interval[1] - c.interval[0] > 2.0 * 0.02 * axis.masses.load_mass_kg, "{c:?}");
        let chain = report.flexible();
        assert!((chain.span_s * 3.0 * axis.masses.resonance_hz() - 1.0).abs() < 0.05, "{chain:?}");
        let apparent = of(Gear::Undeclared);
        assert!(
            apparent.is_apparent
                && apparent.findings.iter().any(|f| f.starts_with("no efficiency of the gear is declared"))
        );
        assert!(apparent.coefficient("M").unwrap().value > 1.02 * axis.masses.load_mass_kg);
    }
}
