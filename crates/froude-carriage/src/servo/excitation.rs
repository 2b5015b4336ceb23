//! Which coefficients of an axis a log determines, which motion would determine the others, and how much a disturbance can bias them all.
//!
//! A log is not a designed test. A disturbance n also moves the axis, so that acceleration and speed follow it and least squares attribute it to inertia and friction. Without a loop E(a n) = −σ²/M and
//! E(v n) = −σ² τ/M, τ its correlation time; a loop makes both smaller if the correlation decays exponentially. (A periodic disturbance, such as cogging, can do more in a lightly damped loop.) With N rows and C, the covariance of the coefficients for white residuals, the coefficients are then biased by up to
//!
//! b_a = N C_M/M,  b_v = N C_v τ/M
//!
//! (C_M, C_v: columns of C). A loop also makes the command answer the disturbance; where the delay of the command is fitted, its column, the slope g u̇ of the force, then
//! follows n. Stationary n and a loop no faster than n itself give |E(g u̇ n)| ≤ σ²/τ, and
//!
//! b_d = N C_d/τ
//!
//! (encoder steps that a loop differentiates are such a disturbance). The disturbance in a log is unknown, so each b is treated as a rectangular error within ± b, and its covariance b bᵀ/3 is added to that of the scatter. It does not become smaller
//! in longer logs, and neither does b_p, which is 0.2 % of M, F_v, F_c and of a load, each for itself, at a corner of 50 Hz and grows with 1/corner²: filters smear a sudden acceleration across the samples near rest that are left out. The M component of b_a is M/R², where R is the ratio of two forces: that of the coefficient, without what the other columns explain, to the residual.
//!
//! | coefficient | needed for an interval | at least |
//! |-------------|--------|-------|
//! | M, F_v, F_c | R = \|M\| rms(a⊥)/σ of M | 2 |
//! | F_v, F_c    | rms(x⊥)/rms(x) of their own column (the speed must vary within a direction) | 0.07 |
//!
//! x⊥ is what the other columns leave of a column: rms(x⊥) = σ/(s √N), s the standard deviation of its coefficient with white residuals. 2 τ is the time between rows times the largest ratio of a coefficient's variances by HAC and
//! with white residuals.
//!
//! **Source.** Ljung (1999), System Identification, 13.4 (the bias of a direct method in a loop); Belsley, Kuh & Welsch (1980), 3.2. The limits are ours: twelve motions of a simulated axis
//! (tests/suite/servo_logs.rs).

use froude_fit::faer::Mat;
use froude_fit::stream::Solution;
use froude_records::number::significant;

use crate::servo::chain::CORNER_HZ;
use crate::servo::coordinate::{DELAY, is_inertia, is_place};

/// Least force of the inertia over what the model leaves: below, the motion is that of the disturbance.
const LEAST_FORCE: f64 = 2.0;
/// Part of a coefficient by which the preparation of the rows may move it, with the corner of the position's filter at 50 Hz.
const BY_PREPARATION: f64 = 0.002;
/// Least part of a column of friction that the other columns do not have.
const LEAST_PART: f64 = 0.07;

/// A column of the regression.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column<'a> {
    pub name: &'a str,
    /// Standard deviation of its coefficient by HAC.
    pub hac: f64,
    /// Root mean square.
    pub rms: f64,
}

/// What is wrong with the motion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Excitation {
    /// A sentence for each kind of coefficient.
    pub findings: Vec<String>,
    /// Whether the motion determines each coefficient.
    pub is_told: Vec<bool>,
    /// Covariance of the bias that a disturbance can cause.
    pub moved: Mat<f64>,
}

/// Judges the `columns` that `solution` was fitted to: `n` rows at `rate_hz`.
pub(crate) fn excitation(
    columns: &[Column<'_>],
    solution: &Solution,
    n: usize,
    rate_hz: f64,
    corner_hz: f64,
) -> Excitation {
    let p = columns.len();
    let root = (n as f64).sqrt();
    let left = |j: usize| solution.sigma / (solution.standard[j] * root);
    let part = |j: usize| left(j) / columns[j].rms;
    let inertia = columns.iter().position(|c| is_inertia(c.name));
    let force = inertia.map_or(f64::INFINITY, |j| solution.coefficients[j].abs() * left(j) / solution.sigma);
    let is_driven = force >= LEAST_FORCE;
    let is_told = |j: usize| match columns[j].name {
        name if is_inertia(name) => is_driven,
        name if name.starts_with("F_") => is_driven && part(j) >= LEAST_PART,
        _ => true,
    };
    let is_told: Vec<bool> = (0..p).map(is_told).collect();
    let mut findings = Vec::new();
    if !is_driven {
        findings.push(format!(
            "{} and friction: no interval is given, because the load of the inertia is {} times the residual (at least {LEAST_FORCE} times is needed); move with larger accelerations (pulses, \
             steps, a sine of 1 Hz or more)",
            inertia.map_or("M", |j| columns[j].name),
            significant(force, 2)
        ));
    }
    let friction: Vec<usize> = (0..p).filter(|j| is_driven && !is_told[*j]).collect();
    if let Some(least) = friction.iter().map(|j| part(*j)).reduce(f64::min) {
        let names: Vec<&str> = friction.iter().map(|j| columns[*j].name).collect();
        findings.push(format!(
            "{}: no interval is given, because the speed hardly varies within a direction, so that viscous and Coulomb friction cannot be distinguished (independent part of the column {}, \
             at least {LEAST_PART} is needed); move at two or more speeds, or through a range of speeds (pulses, a sine)",
            names.join(", "),
            significant(least, 2)
        ));
    }
    let by = inertia.map_or_else(Vec::new, |j| by_disturbance(columns, solution, (j, n as f64), rate_hz));
    let preparation = BY_PREPARATION * (CORNER_HZ / corner_hz).powi(2);
    let is_of_motion = |j: usize| columns[j].name != "offset" && !is_place(columns[j].name);
    let variance = |i: usize, j: usize| {
        let own = if i == j && is_of_motion(j) { (preparation * solution.coefficients[j]).powi(2) } else { 0.0 };
        (own + by.iter().map(|b| b[i] * b[j]).sum::<f64>()) / 3.0
    };
    Excitation { findings, is_told, moved: Mat::from_fn(p, p, variance) }
}

/// b_a and b_v, and b_d where there is a delay. If F_v has one column per direction, the columns share b_v in proportion to their mean squares.
fn by_disturbance(
    columns: &[Column<'_>],
    solution: &Solution,
    (inertia, n): (usize, f64),
    rate_hz: f64,
) -> Vec<Vec<f64>> {
    let p = columns.len();
    let of_mass = n / solution.coefficients[inertia].abs();
    let speeds: Vec<usize> = (0..p).filter(|j| columns[*j].name.starts_with("F_v")).collect();
    let squares: f64 = speeds.iter().map(|j| columns[*j].rms.powi(2)).sum();
    let longest = (0..p).map(|j| (columns[j].hac / solution.standard[j]).powi(2)).fold(0.0, f64::max);
    let time_s = 0.5 * longest / rate_hz;
    let by_speed = |i: usize, j: usize| time_s * columns[j].rms.powi(2) / squares * solution.covariance[(i, j)];
    let by_delay = columns
        .iter()
        .position(|c| c.name == DELAY)
        .map(|d| (0..p).map(|i| n / time_s * solution.covariance[(i, d)]).collect::<Vec<f64>>());
    [
        (0..p).map(|i| of_mass * solution.covariance[(i, inertia)]).collect(),
        (0..p).map(|i| of_mass * speeds.iter().map(|j| by_speed(i, *j)).sum::<f64>()).collect(),
    ]
    .into_iter()
    .chain(by_delay)
    .collect()
}
