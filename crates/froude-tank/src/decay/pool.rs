//! Normal equations of the half cycles, run by run: a run is left out by not adding its sums.
//!
//! Two regressions, each with what belongs to one run alone projected out (Lovell 1963). With γ = D_I ω_n/2C and ε = D_II ω_n²/C, a the mean
//! amplitude of a half cycle (of its two turning points):
//!
//! - force amplitudes F_k = (2/π) C (a_k − a_{k+1}) = D_I u + (8/3π) D_II u² + (2/π) C (c₃₀ γ³ a + c₂₁ γ² ε a² + c₁₂ γ ε² a³ + c₀₃ ε³ a⁴) + (−1)^k g,
//!   u = ω_n a; g is what the rest position was guessed wrong by;
//! - passages t_k = t₀ + (π/ω_n) θ_k + (−1)^k δ/a, weighted by a²: a sensor's noise moves a passage by σ/(ω a), a wrong rest position to alternate
//!   sides. θ_k is the sum of half periods 1/√(1 − γ²) + (16/9π) γ ε a + ε² a²/6, and of ε a/3π, by which the passage comes after the middle of its half cycle.
//!
//! **Source.** Equivalent linearisation is the first line without the terms in c. Those, and θ, are our second-order expansion (Lindstedt) of the half
//! cycle, in which q̇|q̇| is smooth: decrements have odd orders only and periods even ones, since time reversed is damping reversed.
//! c₃₀ is that of 2 tanh(δ/2), c₀₃ that of Froude's closed form (1 + 2εa) e^(−2εa); c₂₁, c₁₂ were read off numerical half cycles, where the
//! closed forms given agree to 1e-5.

use std::f64::consts::{FRAC_1_PI, PI};

use froude_fit::faer::Mat;

use super::run::DecaySetup;
use super::swings::Swings;
use crate::inverted::inverted;

/// 8/3π of the equivalent linearisation.
pub const EIGHT_OVER_3_PI: f64 = 8.0 / (3.0 * PI);
/// Third order of the decrement: γ³ a, γ² ε a², γ ε² a³, ε³ a⁴.
const THIRD: [f64; 4] = [0.5 * PI - PI * PI * PI / 12.0, 32.0 / 27.0 - PI * PI / 3.0, -17.0 * PI / 36.0, -16.0 / 45.0];
/// Determinants below this part of the product of their diagonal: the columns are one.
const SAME: f64 = 1e-10;
/// Rounds of putting the coefficients into their own corrections; each gains two orders of the damping.
const ROUNDS: usize = 12;

/// Where the time stands among the columns of the passages: number, Σ a, Σ a², a, and the time.
const TIME: usize = 4;
/// Columns of the half cycles: a, a², 1, a³, a⁴, and F.
const ROW: usize = 6;

/// Sums of products of one run, or of several.
#[derive(Debug, Clone)]
pub struct Sums {
    passages: Mat<f64>,
    /// Passages less the run's own parameters.
    passages_dof: f64,
    rows: Mat<f64>,
    /// Half cycles less the run's own parameter.
    rows_dof: f64,
}

impl Sums {
    /// The sums of a run.
    pub fn of(swings: &Swings, stiffness: f64) -> Self {
        let n = swings.half_cycles();
        let amplitudes: Vec<f64> = (0..n).map(|k| swings.amplitude(k)).collect();
        // The half cycle about passage k lies between turns k − 1 and k. The one before the first turn is continued as quadratic
        // damping has it, 1/a in even steps: the columns that it goes into count with quadratic damping only.
        let before = 2.0 / amplitudes[0] - 1.0 / amplitudes[1];
        let first = if before > 0.0 { 1.0 / before } else { amplitudes[0] };
        let about = |k: usize| if k == 0 { first } else { amplitudes[k - 1] };
        let count = swings.passages.len();
        let summed = |power: i32| {
            let mut sum = 0.0;
            let between = |k: usize| 0.5 * (about(k - 1).powi(power) + about(k).powi(power));
            (0..count)
                .map(|k| {
                    sum += if k == 0 { 0.0 } else { between(k) };
                    sum
                })
                .collect::<Vec<f64>>()
        };
        let passage_times = (0..count).map(|k| swings.passages[k].time_s - swings.passages[0].time_s).collect();
        let of_passages = [summed(0), summed(1), summed(2), (0..count).map(about).collect(), passage_times];
        let own = [vec![1.0; count], (0..count).map(|k| alternate(k) / about(k)).collect()];
        let weights: Vec<f64> = (0..count).map(about).collect();

        let power = |k: i32| amplitudes.iter().map(|a| a.powi(k)).collect::<Vec<f64>>();
        let forces = (0..n).map(|k| force_amplitude(swings, k, swings.rest, stiffness)).collect();
        let of_rows = [power(1), power(2), power(0), power(3), power(4), forces];
        Self {
            passages: products(&of_passages, &own, &weights),
            passages_dof: count as f64 - 2.0,
            rows: products(&of_rows, &[(0..n).map(alternate).collect()], &vec![1.0; n]),
            rows_dof: n as f64 - 1.0,
        }
    }

    /// Both together.
    pub fn and(mut self, other: &Self) -> Self {
        self.passages += &other.passages;
        self.rows += &other.rows;
        self.passages_dof += other.passages_dof;
        self.rows_dof += other.rows_dof;
        self
    }

    /// F less its third order, as a combination of the columns.
    fn force(third: [f64; 4]) -> [f64; ROW] {
        let [one, two, three, four] = third;
        [-one, -two, 0.0, -three, -four, 1.0]
    }

    /// Sum of products of two combinations of the columns.
    fn product<const N: usize>(of: &Mat<f64>, x: [f64; N], y: [f64; N]) -> f64 {
        (0..N).map(|i| x[i] * (0..N).map(|j| of[(i, j)] * y[j]).sum::<f64>()).sum()
    }

    /// Inverse of the products of the first `n` columns of the half cycles; `None` if the columns are linearly dependent.
    fn inverse(&self, n: usize) -> Option<Mat<f64>> {
        let products = self.rows.submatrix(0, 0, n, n).to_owned();
        let sizes: f64 = (0..n).map(|i| products[(i, i)]).product();
        (products.determinant() > SAME * sizes).then(|| inverted(&products)).flatten()
    }

    /// The coefficients from these sums; `None` where they do not determine them.
    pub fn estimate(&self, setup: &DecaySetup) -> Option<Estimate> {
        let (m, c) = (setup.inertia.value, setup.restoring.stiffness());
        let g = &self.rows;
        let inverse = self.inverse(2)?;
        let fitted = |third| {
            let force = Self::force(third);
            let right: [f64; 2] = std::array::from_fn(|i| Self::product(g, unit(i), force));
            let pq: [f64; 2] = std::array::from_fn(|i| inverse[(i, 0)] * right[0] + inverse[(i, 1)] * right[1]);
            (pq, (Self::product(g, force, force) - pq[0] * right[0] - pq[1] * right[1]).max(0.0))
        };
        let mut damping = Damping::default();
        for _ in 0..ROUNDS {
            damping = Damping::of(fitted(damping.third(c)).0, c);
        }
        let third = damping.third(c);
        let ([p, q], residual) = fitted(third);
        if damping.gamma.is_nan() || damping.gamma.abs() >= 1.0 {
            return None;
        }
        let phase = damping.phase();
        let xx = Self::product(&self.passages, phase, phase);
        let xt = Self::product(&self.passages, phase, unit(TIME));
        let half_period_s = xt / xx;
        let omega_n = PI / half_period_s;
        let to_linear = 1.0 / omega_n;
        let to_quadratic = 1.0 / (EIGHT_OVER_3_PI * omega_n * omega_n);
        let moving = c / (omega_n * omega_n);
        let (rows_dof, passages_dof) = (self.rows_dof - 2.0, self.passages_dof - 1.0);
        let late = (self.passages[(TIME, TIME)] - half_period_s * xt).max(0.0);
        let variance = |sum: f64, dof: f64| if dof > 0.0 { sum / dof } else { f64::NAN };
        let s2 = variance(residual, rows_dof);
        Some(Estimate {
            values: [moving - m, p * to_linear, q * to_quadratic],
            omega_n,
            third,
            variances: [
                variance(late, passages_dof) / xx * (2.0 * moving / half_period_s).powi(2),
                s2 * inverse[(0, 0)] * to_linear.powi(2),
                s2 * inverse[(1, 1)] * to_quadratic.powi(2),
            ],
            damping_covariance: s2 * inverse[(0, 1)] * to_linear * to_quadratic,
            dof: [passages_dof, rows_dof, rows_dof],
        })
        .filter(|e| e.values.iter().all(|v| v.is_finite()))
    }

    /// Coulomb friction beside both dampings, N or N m: F has 4/π of it in each half cycle. With its classical standard
    /// uncertainty and degrees of freedom.
    pub fn coulomb(&self, with: &Estimate) -> Option<[f64; 3]> {
        let inverse = self.inverse(3)?;
        let force = Self::force(with.third);
        let right: [f64; 3] = std::array::from_fn(|i| Self::product(&self.rows, unit(i), force));
        let x: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| inverse[(i, j)] * right[j]).sum());
        let dof = self.rows_dof - 3.0;
        let square = Self::product(&self.rows, force, force);
        let rest = (square - (0..3).map(|i| x[i] * right[i]).sum::<f64>()).max(0.0);
        let standard = if dof > 0.0 { (rest / dof * inverse[(2, 2)]).sqrt() } else { f64::NAN };
        Some([0.25 * PI * x[2], 0.25 * PI * standard, dof])
    }
}

/// γ and ε.
#[derive(Debug, Clone, Copy, Default)]
struct Damping {
    gamma: f64,
    epsilon: f64,
}

impl Damping {
    /// From P a + Q a² of the force amplitude.
    fn of([p, q]: [f64; 2], stiffness: f64) -> Self {
        Self { gamma: 0.5 * p / stiffness, epsilon: q / (EIGHT_OVER_3_PI * stiffness) }
    }

    /// Third order of the force amplitude, by powers of the amplitude.
    fn third(self, stiffness: f64) -> [f64; 4] {
        let Self { gamma, epsilon } = self;
        let orders = [gamma.powi(3), gamma * gamma * epsilon, gamma * epsilon * epsilon, epsilon.powi(3)];
        std::array::from_fn(|k| 2.0 * FRAC_1_PI * stiffness * THIRD[k] * orders[k])
    }

    /// θ as a combination of the passages' columns.
    fn phase(self) -> [f64; TIME + 1] {
        let Self { gamma, epsilon } = self;
        [
            (1.0 - gamma * gamma).powf(-0.5),
            16.0 / 9.0 * FRAC_1_PI * gamma * epsilon,
            epsilon * epsilon / 6.0,
            epsilon / 3.0 * FRAC_1_PI,
            0.0,
        ]
    }
}

/// The coefficients with their classical variances.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    /// A, D_I, D_II.
    pub values: [f64; 3],
    /// Undamped angular frequency, rad/s.
    pub omega_n: f64,
    /// Third order of the force amplitude, by powers of the amplitude.
    third: [f64; 4],
    /// Classical variances: noise of half cycles taken as independent. Neighbours share a turning point with opposite signs, so
    /// that these are rather too large.
    pub variances: [f64; 3],
    /// Covariance of D_I and D_II, likewise.
    pub damping_covariance: f64,
    /// Degrees of freedom of the three.
    pub dof: [f64; 3],
}

impl Estimate {
    /// F of the law at an amplitude.
    pub fn force_amplitude(&self, amplitude: f64) -> f64 {
        let u = self.omega_n * amplitude;
        self.values[1] * u + EIGHT_OVER_3_PI * self.values[2] * u * u
    }

    /// F of a half cycle, less what damping adds to its own third order; about the rest position given.
    pub fn reduced_force(&self, swings: &Swings, k: usize, rest: f64, stiffness: f64) -> f64 {
        let a = swings.amplitude(k);
        let third = self.third.iter().rev().fold(0.0, |sum, c| (sum + c) * a);
        force_amplitude(swings, k, rest, stiffness) - third
    }

    /// Rest position of a run: its guess, moved by the alternating part of what the law leaves.
    pub fn rest(&self, swings: &Swings, stiffness: f64) -> f64 {
        let n = swings.half_cycles();
        let left = |k: usize| {
            self.reduced_force(swings, k, swings.rest, stiffness) - self.force_amplitude(swings.amplitude(k))
        };
        let g = (0..n).map(|k| swings.side_of(k) * left(k)).sum::<f64>() / n as f64;
        swings.rest + g * PI / (4.0 * stiffness)
    }
}

/// (2/π) C (a_k − a_{k+1}), amplitudes about `rest`.
fn force_amplitude(swings: &Swings, k: usize, rest: f64, stiffness: f64) -> f64 {
    let lost = swings.turns[k].position + swings.turns[k + 1].position - 2.0 * rest;
    2.0 * FRAC_1_PI * stiffness * swings.side_of(k) * lost
}

/// Sums of products of weighted columns, less what a run's own columns explain.
fn products(columns: &[Vec<f64>], own: &[Vec<f64>], weights: &[f64]) -> Mat<f64> {
    let weighted = |of: &[Vec<f64>]| Mat::from_fn(weights.len(), of.len(), |i, j| weights[i] * of[j][i]);
    let (columns, own) = (weighted(columns), weighted(own).qr().compute_thin_Q());
    let left = &columns - &own * (own.transpose() * &columns);
    left.transpose() * &left
}

fn unit<const N: usize>(k: usize) -> [f64; N] {
    std::array::from_fn(|i| f64::from(u8::from(i == k)))
}

fn alternate(k: usize) -> f64 {
    if k.is_multiple_of(2) { 1.0 } else { -1.0 }
}
