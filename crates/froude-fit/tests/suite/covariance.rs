//! HC3 and CR3 against fits with rows and clusters really left out.

use froude_fit::distribution::coverage_factor;
use froude_fit::{CovarianceKind, FitError, Options, Problem, fit};

use crate::{assert_close, normal, rng, single};

fn clustered() -> Problem {
    let mut rng = rng(5);
    let mut cluster = Vec::new();
    let mut rows = Vec::new();
    let mut y = Vec::new();
    for g in 0..7_usize {
        let common = normal(&mut rng);
        for k in 0..2 + g {
            let x = k as f64 + 0.3 * normal(&mut rng);
            rows.push(vec![1.0, x, x * x]);
            y.push(1.0 + 0.5 * x + common + 0.3 * normal(&mut rng));
            cluster.push(10 + g);
        }
    }
    let n = y.len();
    Problem {
        cluster: Some(cluster),
        weight: Some((0..n).map(|i| 1.0 + (i % 3) as f64).collect()),
        ..single(&rows, &y)
    }
}

fn values(problem: &Problem) -> Vec<f64> {
    fit(problem, &Options::default()).unwrap().coefficients.iter().map(|c| c.value.unwrap()).collect()
}

fn with(kind: CovarianceKind) -> Options {
    Options { covariance: kind, ..Options::default() }
}

#[test]
fn hc3_is_the_sum_of_moves_when_each_row_is_left_out() {
    let problem = clustered();
    let all = values(&problem);
    let n = problem.n_rows();
    let mut sum = [[0.0; 3]; 3];
    for out in 0..n {
        let rows: Vec<usize> = (0..n).filter(|&i| i != out).collect();
        let rest = values(&problem.rows(&rows));
        for i in 0..3 {
            for j in 0..3 {
                sum[i][j] += (rest[i] - all[i]) * (rest[j] - all[j]);
            }
        }
    }
    let found = fit(&problem, &with(CovarianceKind::Hc3)).unwrap();
    for i in 0..3 {
        for j in 0..3 {
            assert_close(found.covariance[(i, j)], sum[i][j], 1e-11);
        }
    }
    // Bell and McCaffrey's: fewer than those of equal errors, as some rows weigh more than others.
    assert!(found.coefficients.iter().all(|c| c.dof.is_some_and(|d| d > 2.0 && d < n as f64 - 3.0)));
}

#[test]
fn cr3_is_the_cluster_jackknife_with_degrees_of_freedom_of_its_own() {
    let problem = clustered();
    let all = values(&problem);
    let cluster = problem.cluster.clone().unwrap();
    let mut sum = [[0.0; 3]; 3];
    for out in 10..17 {
        let rows: Vec<usize> = (0..cluster.len()).filter(|&i| cluster[i] != out).collect();
        let rest = values(&problem.rows(&rows));
        for i in 0..3 {
            for j in 0..3 {
                sum[i][j] += 6.0 / 7.0 * (rest[i] - all[i]) * (rest[j] - all[j]);
            }
        }
    }
    let found = fit(&problem, &with(CovarianceKind::Cr3)).unwrap();
    for i in 0..3 {
        for j in 0..3 {
            assert_close(found.covariance[(i, j)], sum[i][j], 1e-11);
        }
        let c = &found.coefficients[i];
        let dof = c.dof.unwrap();
        assert!(dof > 1.0 && dof < 6.0, "{dof}");
        let half = coverage_factor(0.95, dof) * sum[i][i].sqrt();
        assert_close(c.interval.unwrap()[1], c.value.unwrap() + half, 1e-11);
    }
}

/// The mean of n: HC3 is Σ r²/(n−1)², by hand.
#[test]
fn hc3_of_a_mean_by_hand() {
    let problem = single(&vec![vec![1.0]; 4], &[1.0, 2.0, 4.0, 5.0]);
    let found = fit(&problem, &with(CovarianceKind::Hc3)).unwrap();
    assert_close(found.covariance[(0, 0)], 10.0 / 9.0, 1e-14);
}

#[test]
fn clusters_of_one_row_make_cr3_of_hc3() {
    let mut problem = clustered();
    let n = problem.n_rows();
    problem.cluster = Some((0..n).collect());
    let hc3 = fit(&problem, &with(CovarianceKind::Hc3)).unwrap();
    let cr3 = fit(&problem, &with(CovarianceKind::Cr3)).unwrap();
    let factor = (n as f64 - 1.0) / n as f64;
    for j in 0..3 {
        assert_close(cr3.covariance[(j, j)], factor * hc3.covariance[(j, j)], 1e-12);
    }
}

#[test]
fn two_clusters_are_refused_in_words() {
    let problem = clustered();
    let cluster = problem.cluster.clone().unwrap();
    let rows: Vec<usize> = (0..cluster.len()).filter(|&i| cluster[i] < 12).collect();
    let error = fit(&problem.rows(&rows), &with(CovarianceKind::Cr3)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "component \"y\" has 2 clusters; cluster-robust covariance (CR3) is refused below 3, \
         where its interval is unreliable"
    );
    let none = Problem { cluster: None, ..problem };
    assert_eq!(fit(&none, &with(CovarianceKind::Cr3)).unwrap_err(), FitError::NoClusters);
}

#[test]
fn what_decides_a_coefficient_alone_is_named() {
    let mut rows: Vec<Vec<f64>> = (0..8).map(|i| vec![1.0, f64::from(u8::from(i == 5))]).collect();
    let y = [1.0, 1.2, 0.9, 1.1, 0.8, 3.0, 1.0, 1.1];
    let mut problem = single(&rows, &y);
    let error = fit(&problem, &with(CovarianceKind::Hc3)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "row 5 alone determines a coefficient (leverage 1); HC3 needs every one determined by \
         the other rows"
    );
    rows[6][1] = 2.0;
    problem = single(&rows, &y);
    problem.cluster = Some(vec![0, 1, 2, 3, 4, 9, 9, 7]);
    let error = fit(&problem, &with(CovarianceKind::Cr3)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "without its 10. cluster in order of appearance component \"y\" no longer determines its coefficients; the cluster \
         jackknife (CR3) needs every one determined by the others (offsets of the clusters are determined by none)"
    );
}
