//! Rows that were condensed to triangles give what all rows give.

use faer::Mat;
use froude_fit::{Bound, CovarianceKind, Fit, Options, Prior, Problem, fit};

use crate::{assert_close, names, normal, rng};

/// Two components over six clusters of 40 rows; `is_shared` gives both one coefficient.
fn problem(is_shared: bool) -> Problem {
    let mut rng = rng(11);
    let p = if is_shared { 3 } else { 4 };
    let (mut rows, mut response, mut component, mut cluster) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for c in 0..2 {
        for g in 0..6 {
            let common = 0.2 * normal(&mut rng);
            for _ in 0..40 {
                let x = 1.0 + normal(&mut rng);
                let mut row = vec![0.0; p];
                row[c] = x;
                row[if is_shared { 2 } else { 2 + c }] = x * x.abs();
                rows.push(row);
                response.push(0.5 * x + 2.0 * x * x.abs() + common + 0.1 * (1 + c) as f64 * normal(&mut rng));
                component.push(c);
                cluster.push(g);
            }
        }
    }
    Problem {
        design: Mat::from_fn(rows.len(), p, |i, j| rows[i][j]),
        response,
        weight: None,
        component,
        components: vec!["x".into(), "y".into()],
        cluster: Some(cluster),
        names: names(p),
    }
}

/// A triangle of each component and cluster; the observations of each component.
fn condensed(problem: &Problem) -> (Problem, Vec<usize>) {
    let p = problem.n_coefficients();
    let cluster = problem.cluster.clone().unwrap();
    let (mut rows, mut component, mut clusters) = (Vec::new(), Vec::new(), Vec::new());
    for c in 0..2 {
        for g in 0..6 {
            let own: Vec<usize> =
                (0..problem.n_rows()).filter(|&i| problem.component[i] == c && cluster[i] == g).collect();
            let columns: Vec<usize> = (0..p).filter(|&j| own.iter().any(|&i| problem.design[(i, j)] != 0.0)).collect();
            let width = columns.len() + 1;
            let entry =
                |i: usize, k: usize| columns.get(k).map_or(problem.response[own[i]], |&j| problem.design[(own[i], j)]);
            let r = Mat::from_fn(own.len(), width, entry).qr().thin_R().to_owned();
            for i in 0..width {
                let mut row = vec![0.0; p + 1];
                for (k, &j) in columns.iter().chain([&p]).enumerate() {
                    row[j] = r[(i, k)];
                }
                rows.push(row);
                component.push(c);
                clusters.push(g);
            }
        }
    }
    let few = Problem {
        design: Mat::from_fn(rows.len(), p, |i, j| rows[i][j]),
        response: rows.iter().map(|row| row[p]).collect(),
        component,
        cluster: Some(clusters),
        ..problem.clone()
    };
    (few, vec![240, 240])
}

/// Condition numbers are below 10, and σ is iterated to 1e-11.
fn same(a: &Fit, b: &Fit) {
    for (a, b) in a.coefficients.iter().zip(&b.coefficients) {
        assert_eq!(a.status, b.status);
        assert_close(a.value.unwrap(), b.value.unwrap(), 1e-10);
        assert_close(a.standard.unwrap(), b.standard.unwrap(), 1e-10);
        assert_close(a.dof.unwrap(), b.dof.unwrap(), 1e-8);
    }
    for (a, b) in a.components.iter().zip(&b.components) {
        assert_eq!(a.n, b.n);
        assert_close(a.sigma.unwrap(), b.sigma.unwrap(), 1e-10);
        assert_close(a.relative_residual, b.relative_residual, 1e-10);
        assert_close(a.aicc.unwrap(), b.aicc.unwrap(), 1e-9);
        assert_close(a.dof, b.dof, 1e-10);
    }
}

#[test]
fn triangles_give_what_their_rows_give() {
    let bound = Bound { lower: 0.55, upper: f64::INFINITY };
    let prior = Prior::new(0, 0.45, 0.01);
    for is_shared in [false, true] {
        let problem = problem(is_shared);
        let (few, observations) = condensed(&problem);
        let p = problem.n_coefficients();
        assert!(few.n_rows() <= 36);
        for options in [
            Options::default(),
            Options { bounds: vec![bound; p], ..Options::default() },
            Options { priors: vec![prior.clone()], ..Options::default() },
            Options { covariance: CovarianceKind::Cr3, ..Options::default() },
        ] {
            let rows = fit(&problem, &options).unwrap();
            let triangles = fit(&few, &Options { observations: observations.clone(), ..options }).unwrap();
            same(&rows, &triangles);
            assert!(triangles.components.iter().all(|c| c.durbin_watson.is_none()));
        }
    }
}

#[test]
fn what_needs_the_rows_themselves_is_refused() {
    let (few, observations) = condensed(&problem(false));
    let hc3 = fit(&few, &Options { covariance: CovarianceKind::Hc3, observations, ..Options::default() });
    assert_eq!(hc3.unwrap_err().to_string(), "a fit of condensed rows does not accept HC3");
    let one = fit(&few, &Options { observations: vec![240], ..Options::default() });
    let one = one.unwrap_err().to_string();
    assert!(one.starts_with("observations has 1 entries where "), "{one}");
}
