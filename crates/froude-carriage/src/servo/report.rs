//! One record, one report.

use std::borrow::Cow;
use std::ops::Range;

use froude_fit::diagnostics::condition_number;
use froude_fit::distribution::coverage_factor;
use froude_fit::faer::Mat;
use froude_fit::stream::Solution;
use froude_records::text::counted;

use crate::servo::chain::Chain;
use crate::servo::coordinate::is_inertia;
use crate::servo::error::ServoError;
use crate::servo::excitation::{Column, excitation};
use crate::servo::interval::{CONFIDENCE, Spread, Whiteness, diagonal_roots, over_runs, spread, whiteness};
use crate::servo::load::Shape;
use crate::servo::motor::MotorSide;
use crate::servo::regression::{inverse_gram, least_squares};
use crate::servo::rows::Rows;

/// Fewest runs whose scatter is stated.
const FEWEST_RUNS: usize = 5;

/// One identified coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoCoefficient {
    /// `M`, `F_v`, `F_c+`, `offset`…
    pub name: String,
    /// Its unit.
    pub unit: Cow<'static, str>,
    /// Value.
    pub value: f64,
    /// Standard deviation if residuals were white. They are not: see [`ServoReport::whiteness`].
    pub classical_std: f64,
    /// Standard deviation by HAC; of a log, with the bias that a disturbance can cause.
    pub hac_std: f64,
    /// Standard deviation over moving blocks, or over clusters: whole runs, stretches of a second; of a log, with the same bias.
    pub block_std: f64,
    /// Interval from the blocks at the chain's confidence.
    pub interval: [f64; 2],
}

impl ServoCoefficient {
    /// With its standard deviations, white, HAC and of the blocks, and the half-width of its interval.
    pub(crate) fn new(name: &str, unit: impl Into<Cow<'static, str>>, value: f64, std: [f64; 3], half: f64) -> Self {
        let ([classical_std, hac_std, block_std], interval) = (std, [value - half, value + half]);
        Self { name: name.to_owned(), unit: unit.into(), value, classical_std, hac_std, block_std, interval }
    }
}

/// Coefficients with this scatter: standard deviations by HAC and of the blocks, and degrees of freedom. What the motion does not determine has
/// no interval.
pub(crate) fn coefficients(
    names: &[(String, Cow<'static, str>)],
    solution: &Solution,
    [hac, blocks, dof]: [&[f64]; 3],
    is_told: &[bool],
) -> Vec<ServoCoefficient> {
    let of = |(j, (name, unit)): (usize, &(String, Cow<'static, str>))| {
        let [hac_std, block_std] = [hac[j], blocks[j]].map(|s| if is_told[j] { s } else { f64::NAN });
        let std = [solution.standard[j], hac_std, block_std];
        ServoCoefficient::new(
            name,
            unit.clone(),
            solution.coefficients[j],
            std,
            coverage_factor(CONFIDENCE, dof[j]) * block_std,
        )
    };
    names.iter().enumerate().map(of).collect()
}

/// The fit of a rigid model.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidFit {
    /// Coefficients in the order of the regression.
    pub coefficients: Vec<ServoCoefficient>,
    /// What the law says beside friction.
    pub shape: Shape,
    /// Their covariance, of what their intervals are made of.
    pub covariance: Mat<f64>,
    /// Degrees of freedom of each.
    pub dof: Vec<f64>,
    /// What was taken as one piece of evidence, in words.
    pub pieces: String,
    /// Runs that are these pieces; `None` of a single record.
    pub runs: Option<usize>,
    /// Least and largest value of each regressor.
    pub ranges: Vec<[f64; 2]>,
    /// How the rows of the regression were made, in words.
    pub preparation: String,
    /// Rows of the regression.
    pub n_rows: usize,
    /// Their rate, Hz.
    pub rate_hz: f64,
    /// `‖force − model‖/‖force‖`.
    pub relative_force_error: f64,
    /// Standard deviation of the residuals, N.
    pub sigma_n: f64,
    /// Condition number of the regressors in SI units; `None` when they are dependent, or were not kept.
    pub condition_number: Option<f64>,
    /// What a reader must know before using the numbers.
    pub findings: Vec<String>,
    /// Coefficients that the motion does not determine, which have no interval, and a motion that would determine them.
    pub excitation: Vec<String>,
}

impl RigidFit {
    /// The coefficient of that name.
    #[must_use]
    pub fn coefficient(&self, name: &str) -> Option<&ServoCoefficient> {
        self.coefficients.iter().find(|c| c.name == name)
    }
}

/// What a record says about an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoReport {
    /// The fit.
    pub fit: RigidFit,
    /// Lag of HAC, s.
    pub hac_lag_s: f64,
    /// Length of a block, s.
    pub block_s: f64,
    /// Whether the residuals are white; `None` without residuals.
    pub whiteness: Option<Whiteness>,
    /// Residuals, N, row by row.
    pub residuals_n: Vec<f64>,
    /// The rows themselves, run after run.
    pub rows: Rows,
    /// Which of them are of one run, each in its own time.
    pub runs: Vec<Range<usize>>,
}

/// From rows that are already there, of one record.
///
/// # Errors
///
/// [`ServoError`].
pub fn of_rows(rows: Rows, chain: &Chain) -> Result<ServoReport, ServoError> {
    let solution = least_squares(&rows)?;
    let spread = spread(&rows, &solution, chain).map_err(|error| match error {
        ServoError::TooFewRows { rows, needed } if chain.is_moving => ServoError::AtRest { rows, needed },
        other => other,
    })?;
    let whole = 0..rows.force_n.len();
    Ok(reported(rows, vec![whole], &solution, spread, chain))
}

/// From several runs of the same axis: the run is the piece of evidence.
///
/// Friction and force per volt change from run to run and stay within one, so that no block within a run shows it. The intervals are
/// those of whole runs as clusters, with Student's t of each coefficient's own degrees of freedom. With fewer than
/// five runs, or where one alone decides a coefficient, they are those of blocks, and a finding says so.
///
/// # Errors
///
/// [`ServoError`].
pub fn of_runs(runs: Vec<Rows>, chain: &Chain) -> Result<ServoReport, ServoError> {
    let (rows, ranges) = joined(runs)?;
    if ranges.len() == 1 {
        return of_rows(rows, chain);
    }
    let by_blocks = |rows: Rows, why: &str| -> Result<ServoReport, ServoError> {
        let mut report = ServoReport { runs: ranges.clone(), ..of_rows(rows, chain)? };
        report.fit.findings.push(format!(
            "the intervals do not include what changes from run to run: {why}; they are those of blocks within the runs"
        ));
        Ok(report)
    };
    if ranges.len() < FEWEST_RUNS {
        return by_blocks(
            rows,
            &format!("{} too few, {FEWEST_RUNS} are needed", counted(ranges.len(), "run is", "runs are")),
        );
    }
    let solution = least_squares(&rows)?;
    match over_runs(&rows, &solution, &ranges, chain.hac_lag_s) {
        Ok(spread) => Ok(reported(rows, ranges.clone(), &solution, spread, chain)),
        Err(error @ ServoError::Alone { .. }) => by_blocks(rows, &error.to_string()),
        Err(error) => Err(error),
    }
}

/// As [`of_runs`], from logs each of which should determine all coefficients. With two to four, or where one log alone decides a coefficient, the intervals are
/// those of the scatter between fits of single logs, Σ W_k S W_kᵀ with Student's t of n − 1 degrees of freedom, and of blocks within the logs: S is the covariance of
/// those fits without the mean of what the noise within a log makes of it, W_k = (Σ X_lᵀX_l)⁻¹ X_kᵀX_k the weight of log k in the common fit, so that a log which
/// dominates it is not averaged down by n. Logs that cannot be fitted alone are named and not in S.
///
/// # Errors
///
/// [`ServoError`].
pub(crate) fn of_logs(logs: Vec<Rows>, chain: &Chain) -> Result<ServoReport, ServoError> {
    let alone: Vec<Option<Solution>> = logs.iter().map(|log| least_squares(log).ok()).collect();
    let grams: Vec<Mat<f64>> = logs.iter().map(gram).collect();
    let (all, ranges) = joined(logs)?;
    if ranges.len() == 1 {
        return of_rows(all, chain);
    }
    let solution = least_squares(&all)?;
    if ranges.len() >= FEWEST_RUNS {
        match over_runs(&all, &solution, &ranges, chain.hac_lag_s) {
            Ok(spread) => return Ok(reported(all, ranges, &solution, spread, chain)),
            Err(ServoError::Alone { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    let each: Vec<&Solution> = alone.iter().flatten().collect();
    let mut spread = spread(&all, &solution, chain)?;
    let n = each.len();
    if n >= 2 {
        let p = solution.coefficients.len();
        let mean = |j: usize| each.iter().map(|fit| fit.coefficients[j]).sum::<f64>() / n as f64;
        let between = |i: usize, j: usize| {
            let products = each.iter().map(|fit| (fit.coefficients[i] - mean(i)) * (fit.coefficients[j] - mean(j)));
            products.sum::<f64>() / (n - 1) as f64
        };
        let within = |j: usize| {
            // Residuals are correlated within a log as they are within all.
            let correlated = spread.covariance[(j, j)] / solution.standard[j].powi(2);
            correlated * each.iter().map(|fit| fit.standard[j].powi(2)).sum::<f64>() / n as f64
        };
        let left: Vec<f64> = (0..p).map(|j| (1.0 - within(j) / between(j, j)).max(0.0).sqrt()).collect();
        let between = Mat::from_fn(p, p, |i, j| left[i] * left[j] * between(i, j));
        let inverse = inverse_gram(&solution);
        for gram in &grams {
            let part = &inverse * gram;
            spread.covariance += &part * &between * part.transpose();
        }
        (spread.runs, spread.dof) = (Some(n), vec![(n - 1) as f64; p]);
        spread.pieces = format!("fits of {n} single logs");
    }
    let mut report = reported(all, ranges, &solution, spread, chain);
    let unfit: Vec<String> = (1..).zip(&alone).filter(|(_, fit)| fit.is_none()).map(|(k, _)| k.to_string()).collect();
    if !unfit.is_empty() {
        report.fit.findings.push(format!(
            "{} {} of {}, fitted alone, {} not determine all coefficients: {}; record logs each of which does",
            if unfit.len() == 1 { "log" } else { "logs" },
            unfit.join(", "),
            alone.len(),
            if unfit.len() == 1 { "does" } else { "do" },
            if n >= 2 {
                "the scatter between logs is that of the others"
            } else {
                "the intervals do not include what changes from log to log"
            }
        ));
    }
    Ok(report)
}

/// XᵀX of the regressors of a log.
fn gram(rows: &Rows) -> Mat<f64> {
    let product = |i: usize, j: usize| rows.columns[i].iter().zip(&rows.columns[j]).map(|(a, b)| a * b).sum();
    Mat::from_fn(rows.columns.len(), rows.columns.len(), product)
}

/// Part of the largest speed that the other direction has at least.
const BOTH_WAYS: f64 = 0.05;

/// What motion in one direction leaves open: the sign of the speed is then a constant.
fn one_way(rows: &Rows) -> Option<String> {
    let column = |of: &str| rows.names.iter().position(|(name, _)| name == of);
    let (speed, _) = column("F_v").zip(column("F_c"))?;
    let [low, high] = widened(NO_RANGE, &rows.columns[speed]);
    (low.abs().min(high.abs()) < BOTH_WAYS * low.abs().max(high.abs()) || low > 0.0 || high < 0.0).then(|| {
        "all motion is in one direction, so F_c includes any zero error of the command (a current sensor's, for example): log both directions, or check that the zero is \
         declared as `offset` of the column"
            .to_owned()
    })
}

/// Rows of runs behind each other, and which are of which.
pub(crate) fn joined(runs: Vec<Rows>) -> Result<(Rows, Vec<Range<usize>>), ServoError> {
    let mut ranges = Vec::new();
    let mut joined: Option<Rows> = None;
    for rows in runs {
        let first = joined.as_ref().map_or(0, |r| r.force_n.len());
        ranges.push(first..first + rows.force_n.len());
        match &mut joined {
            None => joined = Some(rows),
            Some(all) => all.append(rows),
        }
    }
    Ok((joined.ok_or(ServoError::TooFewRows { rows: 0, needed: FEWEST_RUNS })?, ranges))
}

/// Sums at the motor's shaft (MCD Table II) of a rigid model: J_eff, B_eff, C_eff.
#[must_use]
pub fn effective(fit: &RigidFit, motor: &MotorSide) -> Vec<ServoCoefficient> {
    let scale = motor.m_rad();
    let moved = |from: &str, to: &str, unit: &'static str, factor: f64| {
        fit.coefficient(from).map(|c| ServoCoefficient {
            name: to.to_owned(),
            unit: unit.into(),
            value: factor * c.value,
            classical_std: factor * c.classical_std,
            hac_std: factor * c.hac_std,
            block_std: factor * c.block_std,
            interval: c.interval.map(|x| factor * x),
        })
    };
    [
        moved("M", "J_eff", "kg m^2", scale * scale),
        moved("F_v", "B_eff", "N m s/rad", scale * scale),
        moved("F_c", "C_eff", "N m", scale),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn reported(
    rows: Rows,
    runs: Vec<Range<usize>>,
    solution: &Solution,
    mut spread: Spread,
    chain: &Chain,
) -> ServoReport {
    let residuals_n = rows.residuals_n(&solution.coefficients);
    let whiteness = whiteness(&residuals_n, rows.rate_hz);
    let design = Mat::from_fn(rows.force_n.len(), rows.columns.len(), |i, j| rows.columns[j][i]);
    let n = rows.force_n.len();
    let pieces = spread.pieces.clone();
    let columns: Vec<Column<'_>> = (rows.names.iter().enumerate())
        .map(|(j, (name, _))| Column {
            name,
            hac: spread.hac[j],
            rms: (rows.columns[j].iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt(),
        })
        .collect();
    let mut weak = Vec::new();
    let mut is_told = vec![true; rows.names.len()];
    for changes in &chain.delay.changes {
        for (j, change) in changes.iter().enumerate() {
            for (k, other) in changes.iter().enumerate() {
                spread.covariance[(j, k)] += change * other;
            }
            spread.hac[j] = spread.hac[j].hypot(*change);
        }
    }
    let not_white = whiteness.as_ref().and_then(|w| not_white(w, &spread.covariance, &solution.standard, &pieces));
    if chain.is_moving {
        let found = excitation(&columns, solution, n, rows.rate_hz, chain.corner_hz);
        spread.covariance += &found.moved;
        for (j, hac) in spread.hac.iter_mut().enumerate() {
            *hac = hac.hypot(found.moved[(j, j)].sqrt());
        }
        (weak, is_told) = (found.findings, found.is_told);
    }
    let blocks = diagonal_roots(&spread.covariance);
    let coefficients = coefficients(&rows.names, solution, [&spread.hac, &blocks, &spread.dof], &is_told);
    let fit = RigidFit {
        findings: not_white.into_iter().chain(one_way(&rows)).chain(negative(&coefficients)).collect(),
        excitation: weak,
        coefficients,
        shape: chain.shape(),
        covariance: spread.covariance,
        dof: spread.dof,
        pieces,
        runs: spread.runs,
        ranges: rows.columns.iter().map(|column| widened(NO_RANGE, column)).collect(),
        preparation: chain.words(rows.rate_hz * chain.decimation as f64),
        n_rows: n,
        rate_hz: rows.rate_hz,
        relative_force_error: rows.relative_error(&solution.coefficients),
        sigma_n: solution.sigma,
        condition_number: condition_number(design.as_ref()).map(|(high, low)| high / low),
    };
    ServoReport { fit, hac_lag_s: spread.hac_lag_s, block_s: spread.block_s, whiteness, residuals_n, rows, runs }
}

/// The range of no values, and one with the values of a column.
pub(crate) const NO_RANGE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

pub(crate) fn widened(range: [f64; 2], column: &[f64]) -> [f64; 2] {
    column.iter().fold(range, |[low, high], x| [low.min(*x), high.max(*x)])
}

/// That classical standard deviations do not hold, and by how much.
fn not_white(w: &Whiteness, covariance: &Mat<f64>, classical: &[f64], pieces: &str) -> Option<String> {
    (!w.is_white()).then(|| {
        let worst = diagonal_roots(covariance).iter().zip(classical).map(|(blocks, white)| blocks / white).fold(0.0, f64::max);
        let by = if worst > 1.0 { format!("are up to {worst:.1} times too small") } else { "do not hold".to_owned() };
        format!(
            "residuals are not white (r1 = {:.2}, Ljung-Box({}) = {:.0}): classical standard deviations {by}; the intervals are those of {}",
            w.r1,
            w.lags,
            w.ljung_box,
            pieces
        )
    })
}

/// What resists must not drive: a sentence for each coefficient that does beyond its interval.
pub(crate) fn negative(coefficients: &[ServoCoefficient]) -> impl Iterator<Item = String> {
    let must_resist = |c: &&ServoCoefficient| is_inertia(&c.name) || c.name.starts_with("F_") && c.name != "F_s";
    coefficients
        .iter()
        .filter(must_resist)
        .filter(|c| c.interval[1] < 0.0)
        .map(|c| format!("{} = {:.4} {} is negative: check the sign of position or command", c.name, c.value, c.unit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drag::RunKind;
    use crate::scenario::Scenario;
    use crate::servo::{Friction, ServoLog};

    /// Friction 2 % and force per volt 0.5 % from run to run, 0.05 N rms that wanders with 0.3 s within one.
    fn runs(seed: u64, pairs: u32) -> (Vec<Rows>, Chain, Scenario) {
        let scenario =
            Scenario { bump: 0.0, efficiency: 1.0, friction_m: Some([2.0, 3.0]), pairs, ..Scenario::pinned(0.0) };
        let chain = Chain {
            corner_hz: 3.0,
            decimation: 10,
            ..Chain::new(scenario.ideal_force_per_volt_n, Friction::default())
        };
        let rows = scenario
            .runs(seed)
            .into_iter()
            .filter(|r| r.kind == RunKind::Friction)
            .map(|r| {
                let first = r.reference_speed_m_s.iter().position(|v| *v != 0.0).unwrap();
                let last = r.reference_speed_m_s.iter().rposition(|v| *v != 0.0).unwrap();
                let log = ServoLog {
                    time_s: r.time_s[first..=last].to_vec(),
                    position_m: r.position_m[first..=last].to_vec(),
                    command_v: r.command_v[first..=last].to_vec(),
                };
                chain.rows(&log).unwrap()
            })
            .collect();
        (rows, chain, scenario)
    }

    /// Twelve runs each; 20 campaigns contain the truth 19 times, less three standard deviations of 1.0.
    #[test]
    fn intervals_over_runs_hold_the_friction_that_changes_from_run_to_run() {
        let mut inside = 0;
        let mut variance = 0.0;
        for seed in 0..20 {
            let (rows, chain, scenario) = runs(seed, 1);
            let report = of_runs(rows, &chain).unwrap();
            let c = report.fit.coefficient("F_c").unwrap();
            inside += u32::from((c.interval[0]..=c.interval[1]).contains(&scenario.coulomb_n));
            assert_eq!(report.fit.runs, Some(12));
            variance += c.block_std.powi(2) / 20.0;
        }
        // Twelve runs cannot know it better than 2 % over √12; a mean of 20 variances of five degrees of freedom scatters by 14 %: three.
        let floor = 0.02 * runs(0, 1).2.coulomb_n / 12.0_f64.sqrt();
        assert!(variance > (1.0 - 3.0 * 0.14) * floor * floor, "{} below {floor}", variance.sqrt());
        assert!(inside >= 16, "{inside} of 20");
    }

    #[test]
    fn a_handful_of_runs_says_that_its_intervals_do_not_hold_what_changes_between_them() {
        let (mut rows, chain, _) = runs(1, 1);
        rows.truncate(4);
        let report = of_runs(rows, &chain).unwrap();
        assert_eq!(report.fit.runs, None);
        assert_eq!(
            report.fit.findings.last().unwrap(),
            "the intervals do not include what changes from run to run: 4 runs are too few, 5 are needed; they are those of blocks \
             within the runs"
        );
    }
}
