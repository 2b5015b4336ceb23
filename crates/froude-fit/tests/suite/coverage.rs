//! The 95 % interval holds the truth 95 times in 100.

use froude_fit::coverage::{Count, z_limit};
use froude_fit::{Bound, CovarianceKind, Options, Problem, fit};
use rand_distr::{Distribution, StandardNormal};

use crate::{names, rng};

const REPETITIONS: usize = 2000;

/// Linear and quadratic in both components, σ 0.1 and 2.
fn design() -> Problem {
    let n = 30;
    Problem {
        design: faer::Mat::from_fn(n, 4, |i, j| {
            let v = 0.1 * (1 + i / 2) as f64;
            match (i % 2, j) {
                (0, 0) | (1, 2) => v,
                (0, 1) | (1, 3) => v * v,
                _ => 0.0,
            }
        }),
        response: vec![0.0; n],
        weight: None,
        component: (0..n).map(|i| i % 2).collect(),
        components: vec!["f_x".into(), "f_y".into()],
        cluster: None,
        names: names(4),
    }
}

#[test]
fn t_intervals_cover_with_and_without_bounds() {
    let problem = design();
    let truth = [0.3, 1.0, 0.0, 5.0];
    let sigma = [0.1, 2.0];
    let mut free = [Count::default(); 4];
    let mut bounded = [Count::default(); 4];
    let mut rng = rng(2024);
    let exact: Vec<f64> =
        (0..problem.n_rows()).map(|i| (0..4).map(|j| problem.design[(i, j)] * truth[j]).sum()).collect();
    for _ in 0..REPETITIONS {
        let response: Vec<f64> = exact
            .iter()
            .zip(&problem.component)
            .map(|(y, &c)| {
                let e: f64 = StandardNormal.sample(&mut rng);
                y + sigma[c] * e
            })
            .collect();
        let problem = Problem { response, ..problem.clone() };
        for (counts, bound) in [(&mut free, Bound::FREE), (&mut bounded, Bound::NON_NEGATIVE)] {
            let fitted = fit(&problem, &Options { bounds: vec![bound; 4], ..Options::default() }).unwrap();
            for (j, c) in fitted.coefficients.iter().enumerate() {
                counts[j].add(c.interval.is_some_and(|[low, high]| low <= truth[j] && truth[j] <= high));
            }
        }
    }
    let limit = z_limit(0.01, 8);
    for count in free.iter().chain(&bounded) {
        let z = count.z_score(0.95);
        assert!(z.abs() < limit, "{} ({z})", count.rate());
    }
}

/// Under clustered errors the classical interval fails and CR3's does not.
#[test]
fn under_clustered_errors_only_the_cluster_interval_covers() {
    let (clusters, size) = (12, 8);
    let n = clusters * size;
    let problem = Problem {
        cluster: Some((0..n).map(|i| i / size).collect()),
        ..Problem::single(
            faer::Mat::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { (i / size) as f64 }),
            vec![0.0; n],
            names(2),
        )
    };
    let mut rng = rng(77);
    let mut rates = [Count::default(); 2];
    let kinds = [CovarianceKind::Classical, CovarianceKind::Cr3];
    for _ in 0..REPETITIONS {
        let common: Vec<f64> = (0..clusters).map(|_| StandardNormal.sample(&mut rng)).collect();
        let response: Vec<f64> = (0..n)
            .map(|i| {
                let own: f64 = StandardNormal.sample(&mut rng);
                common[i / size] + 0.5 * own
            })
            .collect();
        let problem = Problem { response, ..problem.clone() };
        for (count, covariance) in rates.iter_mut().zip(kinds) {
            let fitted = fit(&problem, &Options { covariance, ..Options::default() }).unwrap();
            count.add(fitted.coefficients[1].interval.is_some_and(|[low, high]| low <= 0.0 && high >= 0.0));
        }
    }
    assert!(rates[0].rate() < 0.7, "classical {}", rates[0].rate());
    assert!(rates[1].rate() > 0.93, "CR3 {}", rates[1].rate());
}
