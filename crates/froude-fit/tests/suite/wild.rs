//! The wild cluster bootstrap.

use froude_fit::wild::{WildOptions, WildWeights, wild_cluster};
use froude_fit::{CovarianceKind, FitError, Options, Problem, fit};
use rand::RngExt;

use crate::{assert_close, normal, rng, single};

fn clustered(seed: u64, slope: f64) -> Problem {
    let mut rng = rng(seed);
    let (mut rows, mut y, mut cluster) = (Vec::new(), Vec::new(), Vec::new());
    for g in 0..10 {
        let common = normal(&mut rng);
        let level = normal(&mut rng);
        for _ in 0..6 {
            let x = level + 0.5 * normal(&mut rng);
            rows.push(vec![1.0, x]);
            y.push(slope * x + common + 0.5 * normal(&mut rng));
            cluster.push(g);
        }
    }
    Problem { cluster: Some(cluster), ..single(&rows, &y) }
}

fn on_threads<T: Send>(n: usize, f: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(f)
}

#[test]
fn the_result_is_the_same_on_any_number_of_threads() {
    let problem = clustered(1, 0.4);
    let wild = WildOptions { resamples: 1999, seed: 42, ..WildOptions::default() };
    let run = || wild_cluster(&problem, &Options::default(), 1, &wild).unwrap();
    let one = on_threads(1, run);
    for n in [2, 5] {
        assert_eq!(on_threads(n, run), one);
    }
    let other = wild_cluster(&problem, &Options::default(), 1, &WildOptions { seed: 43, ..wild });
    assert_ne!(other.unwrap().p, one.p);
}

#[test]
fn standard_and_estimate_are_those_of_cr3() {
    let problem = clustered(2, 0.4);
    let options = Options { covariance: CovarianceKind::Cr3, ..Options::default() };
    let cr3 = fit(&problem, &options).unwrap();
    let wild = wild_cluster(&problem, &options, 1, &WildOptions::default()).unwrap();
    let c = &cr3.coefficients[1];
    assert_close(wild.estimate, c.value.unwrap(), 1e-13);
    assert_close(wild.standard, c.standard.unwrap(), 1e-12);
    assert_eq!((wild.weights, wild.n_clusters), (WildWeights::Webb, 10));
}

/// The sums per cluster against refits of explicitly resampled responses:
/// all 2⁵ sign patterns give the same distribution of t.
#[test]
fn resampling_by_sums_is_resampling_by_refits() {
    let mut problem = clustered(3, 0.5);
    let cluster: Vec<usize> = problem.cluster.clone().unwrap().iter().map(|g| g / 2).collect();
    problem.cluster = Some(cluster.clone());
    let options = Options { covariance: CovarianceKind::Cr3, ..Options::default() };
    let null = 0.1;
    let full = fit(&problem, &options).unwrap();
    let t_of = |f: &froude_fit::Fit| (f.coefficients[1].value.unwrap() - null) / f.coefficients[1].standard.unwrap();
    let t = t_of(&full);
    let held = Options { fixed: vec![(1, null)], ..Options::default() };
    let held = fit(&problem, &held).unwrap();
    let mut beyond = 0;
    for pattern in 0..32_u32 {
        let response = (0..problem.n_rows())
            .map(|i| {
                let sign = if pattern >> cluster[i] & 1 == 1 { 1.0 } else { -1.0 };
                held.fitted[i] + sign * held.residuals[i]
            })
            .collect();
        let resampled = Problem { response, ..problem.clone() };
        let t_star = t_of(&fit(&resampled, &options).unwrap());
        beyond += u32::from(t_star.abs() >= t.abs() * (1.0 - 1e-9));
    }
    let exact = f64::from(beyond) / 32.0;
    let wild = WildOptions { resamples: 40_000, weights: WildWeights::Rademacher, null, ..WildOptions::default() };
    let found = wild_cluster(&problem, &Options::default(), 1, &wild).unwrap();
    assert_close(found.t, t, 1e-11);
    // Five binomial standard deviations of 40 000 draws.
    assert!((found.p - exact).abs() < 5.0 * (0.25_f64 / 40_000.0).sqrt(), "{} {exact}", found.p);
}

/// Under the null the p value is below 5 % about one time in twenty.
#[test]
fn the_test_has_its_size() {
    let wild = WildOptions { resamples: 199, ..WildOptions::default() };
    let trials = 400;
    let hits = (0..trials)
        .filter(|&seed| {
            let problem = clustered(1000 + seed, 0.0);
            let wild = WildOptions { seed, ..wild };
            wild_cluster(&problem, &Options::default(), 1, &wild).unwrap().p <= 0.05
        })
        .count();
    // 20 ± 4.4; the band is four standard deviations wide on each side.
    assert!((3..=38).contains(&hits), "{hits}");
}

#[test]
fn what_it_does_not_take_is_said() {
    let mut problem = clustered(1, 0.0);
    let wild = WildOptions::default();
    let fixed = Options { fixed: vec![(1, 0.0)], ..Options::default() };
    let error = wild_cluster(&problem, &fixed, 1, &wild).unwrap_err();
    assert_eq!(error.to_string(), "an interval does not accept a coefficient that is fixed or excluded");
    let mut rng = rng(1);
    problem.cluster = Some((0..60).map(|_| rng.random_range(0..4)).collect());
    let error = wild_cluster(&problem, &Options::default(), 1, &wild).unwrap_err();
    assert!(matches!(error, FitError::TooFewClusters { found: 4, .. }));
}
