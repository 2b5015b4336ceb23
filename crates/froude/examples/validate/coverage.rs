//! Coverage: does the 95 % interval contain the truth 95 times in 100?
//!
//! Every case repeats a seeded synthetic test and counts, per coefficient, how often the interval contains the truth.
//! The count is compared with the binomial distribution at 1 % family-wise (Bonferroni over all coefficients of all
//! cases that must hold), and every z-score is published. Cluster and heteroscedastic cases are reported as measured.

use std::error::Error;
use std::path::Path;

use froude::fit::{self, CovarianceKind, Options, Problem};
use froude::hydro::DragModel;
use froude::identify::dataset::{Dataset, labels};
use froude::identify::law::ForceLaw;
use froude::identify::source::laws;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::claims::{Claims, Verdict};
use crate::snake::{TABLE_2, TABLE_3, TOWING, configurations, planned, published};

pub const SECTION: &str = "Coverage of the stated 95 % intervals";
const ROBUST: &str = "Robust covariance kinds under the noise they are for, as measured";

/// Noise of the two components, N: different, as the two axes of a sensor are.
const SIGMA_N: [f64; 2] = [0.02, 0.05];

/// A standard normal number.
pub fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

/// Hits per coefficient of one case.
pub struct Case {
    pub name: String,
    pub coefficients: Vec<String>,
    pub hits: Vec<u64>,
    pub repetitions: u64,
}

pub fn all(claims: &mut Claims, root: &Path, repetitions: usize) -> Result<(), Box<dyn Error>> {
    let plans = [
        ("Table 2 (H1LT..H9LT)", TABLE_2, configurations(1..=9)),
        ("Table 3 (H1LT, H2LT)", TABLE_3, configurations(1..=2)),
        ("39 towing points", TOWING, Vec::new()),
    ];
    let mut cases = Vec::new();
    for (name, plan, names) in &plans {
        let (campaign, data) = planned(plan, names, "models = [\"f1\", \"f2\", \"f3\", \"f4\", \"f5\", \"f6\"]")?;
        for law in laws(&campaign, &campaign.sources[0], &data)? {
            let values = truth(root, &law, &data)?;
            cases.push(independent(
                &format!("{name}, {}", law.name),
                &law,
                &data,
                (&values, fit::Bound::FREE),
                repetitions,
                cases.len() as u128,
            )?);
        }
        // Several published coefficients are exactly zero.
        let (law, values) = published(root, "circulation_tank_restricted", "f4", &data)?;
        let case = format!("{name}, f4, bounded below by zero");
        cases.push(independent(&case, &law, &data, (&values, fit::Bound::NON_NEGATIVE), repetitions, 777)?);
    }
    let mut within = crate::eiv::cases(claims, root, if repetitions >= 20_000 { repetitions } else { 200 })?;
    cases.append(&mut within);
    judge(claims, &cases)?;
    robust(claims, root, repetitions)
}

/// The published circulation-tank coefficients of a law.
fn truth(root: &Path, law: &ForceLaw, data: &Dataset) -> Result<Vec<f64>, Box<dyn Error>> {
    let model = DragModel::from_name(&law.name).ok_or("no drag model")?;
    Ok(published(root, "circulation_tank_restricted", model.name(), data)?.1)
}

pub fn problem_of(law: &ForceLaw, data: &Dataset) -> Result<Problem, Box<dyn Error>> {
    let design = law.regressors(data, &[])?;
    let n = data.rows;
    Ok(Problem {
        component: (0..design.nrows()).map(|row| row / n).collect(),
        response: vec![0.0; design.nrows()],
        weight: None,
        components: law.responses.clone(),
        cluster: None,
        names: law.coefficients.iter().map(|c| c.name.clone()).collect(),
        design,
    })
}

/// Independent noise, different in x and y, over seeded repetitions of one fit.
fn independent(
    name: &str,
    law: &ForceLaw,
    data: &Dataset,
    (values, bound): (&[f64], fit::Bound),
    repetitions: usize,
    stream: u128,
) -> Result<Case, Box<dyn Error>> {
    let problem = problem_of(law, data)?;
    let force = law.predict(data, values)?;
    let options = Options { bounds: vec![bound; values.len()], ..Options::default() };
    let hits = hits(&problem, &options, values, repetitions, |k| {
        let mut rng = Pcg64::new(k as u128, stream);
        force.iter().enumerate().map(|(row, f)| f + SIGMA_N[row / data.rows] * normal(&mut rng)).collect()
    })?;
    Ok(Case { name: name.to_owned(), coefficients: problem.names, hits, repetitions: repetitions as u64 })
}

/// How often the interval of each coefficient contains the truth; `response` makes that of a repetition.
fn hits(
    problem: &Problem,
    options: &Options,
    values: &[f64],
    repetitions: usize,
    response: impl Fn(usize) -> Vec<f64> + Sync,
) -> Result<Vec<u64>, fit::FitError> {
    let of = |k: usize| {
        let fitted = fit::fit(&Problem { response: response(k), ..problem.clone() }, options)?;
        let intervals: Vec<_> = fitted.coefficients.iter().map(|c| c.interval).collect();
        Ok(count(&intervals, values))
    };
    (0..repetitions).into_par_iter().map(of).try_reduce(|| vec![0; values.len()], |a, b| Ok(add(a, b)))
}

/// Which intervals contain the truth.
pub fn count(intervals: &[Option<[f64; 2]>], values: &[f64]) -> Vec<u64> {
    intervals
        .iter()
        .zip(values)
        .map(|(interval, value)| u64::from(interval.is_some_and(|[low, high]| low <= *value && *value <= high)))
        .collect()
}

pub fn add(mut a: Vec<u64>, b: Vec<u64>) -> Vec<u64> {
    for (x, y) in a.iter_mut().zip(b) {
        *x += y;
    }
    a
}

/// All z-scores, and the simultaneous test at 1 % family-wise.
fn judge(claims: &mut Claims, cases: &[Case]) -> Result<(), Box<dyn Error>> {
    let total: usize = cases.iter().map(|c| c.hits.len()).sum();
    let limit = Normal::new(0.0, 1.0)?.inverse_cdf(1.0 - 0.005 / total as f64);
    let mut worst: (f64, String) = (0.0, String::new());
    for case in cases {
        let n = case.repetitions as f64;
        let z: Vec<f64> = case.hits.iter().map(|&h| (h as f64 - 0.95 * n) / (n * 0.95 * 0.05).sqrt()).collect();
        let text: Vec<String> = case
            .coefficients
            .iter()
            .zip(&case.hits)
            .zip(&z)
            .map(|((name, h), z)| format!("{name} {:.2} % (z {z:+.2})", 100.0 * *h as f64 / n))
            .collect();
        for (name, z) in case.coefficients.iter().zip(&z) {
            if z.abs() > worst.0 {
                worst = (z.abs(), format!("{}, {name}", case.name));
            }
        }
        let holds = z.iter().all(|z| z.abs() <= limit);
        claims.holds(
            SECTION,
            &format!("{} ({} repetitions)", case.name, case.repetitions),
            &format!("95 %, |z| ≤ {limit:.2}"),
            text.join(", "),
            holds,
        );
    }
    claims.add(
        SECTION,
        &format!("largest |z| of {total} intervals"),
        &format!("≤ {limit:.2} (1 % family-wise)"),
        format!("{:.2} at {}", worst.0, worst.1),
        if worst.0 <= limit { Verdict::Pass } else { Verdict::Miss },
    );
    Ok(())
}

/// Noise with a part that a configuration shares (a gain error of 5 %), and noise that grows with the load.
fn robust(claims: &mut Claims, root: &Path, repetitions: usize) -> Result<(), Box<dyn Error>> {
    let (_, data) = planned(TABLE_2, &configurations(1..=9), "")?;
    let (law, values) = published(root, "circulation_tank_restricted", "f2", &data)?;
    let force = law.predict(&data, &values)?;
    let mut problem = problem_of(&law, &data)?;
    let n = data.rows;
    let clusters = labels(&data.configuration);
    problem.cluster = Some((0..problem.response.len()).map(|row| clusters[row % n]).collect());
    let n_clusters = clusters.iter().max().map_or(0, |m| m + 1);
    for noise in ["clustered by configuration", "growing with the load"] {
        for kind in [CovarianceKind::Classical, CovarianceKind::Hc3, CovarianceKind::Cr3] {
            let options = Options { covariance: kind, ..Options::default() };
            let hits = hits(&problem, &options, &values, repetitions, |k| {
                let mut rng = Pcg64::new(k as u128, 4_242);
                let shared: Vec<f64> = (0..2 * n_clusters).map(|_| normal(&mut rng)).collect();
                let noisy = |(row, f): (usize, &f64)| {
                    let own = normal(&mut rng);
                    if noise.starts_with("clustered") {
                        // A calibration error of the configuration: it scales with the load, as a regressor does.
                        let common = shared[clusters[row % n] + n_clusters * (row / n)];
                        f + SIGMA_N[row / n] * own + 0.05 * f * common
                    } else {
                        f + (0.2 * SIGMA_N[row / n] + 0.1 * f.abs()) * own
                    }
                };
                force.iter().enumerate().map(noisy).collect()
            })?;
            let text: Vec<String> = problem
                .names
                .iter()
                .zip(&hits)
                .map(|(name, h)| format!("{name} {:.1} %", 100.0 * *h as f64 / repetitions as f64))
                .collect();
            let claim = format!("noise {noise}, {kind:?}, f2 over Table 2 ({repetitions} repetitions)");
            if kind == CovarianceKind::Classical {
                let worst = hits.iter().copied().min().unwrap_or(0) as f64 / repetitions as f64;
                claims.holds(ROBUST, &claim, "fails: some coefficient below 90 %", text.join(", "), worst < 0.90);
            } else {
                claims.add(ROBUST, &claim, "95 %", text.join(", "), Verdict::Measured);
            }
        }
    }
    Ok(())
}
