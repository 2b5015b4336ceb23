//! Several components in one problem.

use faer::Mat;
use froude_fit::{End, Options, Problem, fit};

use crate::{assert_close, names, normal, rng, single};

/// Two components of three columns each, noise 0.1 and 2.
fn stacked(is_shared: bool) -> Problem {
    let mut rng = rng(21);
    let n = 30;
    let p = if is_shared { 2 } else { 4 };
    let mut design = Mat::zeros(2 * n, p);
    let mut response = Vec::new();
    for i in 0..2 * n {
        let (a, b) = (normal(&mut rng), normal(&mut rng));
        let c = i % 2;
        let start = if is_shared { 0 } else { 2 * c };
        design[(i, start)] = a;
        design[(i, start + 1)] = b;
        response.push(a + 2.0 * b + [0.1, 2.0][c] * normal(&mut rng));
    }
    Problem {
        design,
        response,
        weight: None,
        component: (0..2 * n).map(|i| i % 2).collect(),
        components: vec!["f_x".into(), "f_y".into()],
        cluster: None,
        names: names(p),
    }
}

#[test]
fn components_without_a_common_coefficient_are_fitted_apart() {
    let problem = stacked(false);
    let both = fit(&problem, &Options::default()).unwrap();
    for c in 0..2 {
        let rows: Vec<usize> = (0..problem.n_rows()).filter(|i| i % 2 == c).collect();
        let part: Vec<Vec<f64>> =
            rows.iter().map(|&i| (0..2).map(|j| problem.design[(i, 2 * c + j)]).collect()).collect();
        let y: Vec<f64> = rows.iter().map(|&i| problem.response[i]).collect();
        let alone = fit(&single(&part, &y), &Options::default()).unwrap();
        for j in 0..2 {
            // To the last bit: the same arithmetic on the same numbers.
            assert_eq!(both.coefficients[2 * c + j].value, alone.coefficients[j].value);
            assert_eq!(both.coefficients[2 * c + j].standard, alone.coefficients[j].standard);
        }
        assert_eq!(both.components[c].sigma, alone.components[0].sigma);
        assert_eq!(both.components[c].dof, 28.0);
    }
    assert_eq!(both.covariance[(0, 2)], 0.0);
}

/// A shared coefficient is weighed by each component's σ (feasible GLS).
#[test]
fn a_shared_coefficient_is_weighed_by_the_components_sigma() {
    let problem = stacked(true);
    let found = fit(&problem, &Options::default()).unwrap();
    assert_eq!(found.report.end, End::Converged);
    let sigma: Vec<f64> = found.components.iter().map(|c| c.sigma.unwrap()).collect();
    assert!((0.06..0.14).contains(&sigma[0]) && (1.4..2.8).contains(&sigma[1]));
    // The fixed point: a fit with these weights gives the same coefficients.
    let weighted = Problem {
        weight: Some(problem.component.iter().map(|&c| (sigma[0] / sigma[c]).powi(2)).collect()),
        component: vec![0; problem.n_rows()],
        components: vec!["both".into()],
        ..problem.clone()
    };
    let direct = fit(&weighted, &Options::default()).unwrap();
    for (a, b) in found.coefficients.iter().zip(&direct.coefficients) {
        assert_close(a.value.unwrap(), b.value.unwrap(), 1e-10);
    }
    // REML: Σ r² = σ² (n − tr H) in each, and the traces add up to the rank.
    let dof: f64 = found.components.iter().map(|c| c.dof).sum();
    assert_close(dof, 58.0, 1e-9);
    for c in &found.components {
        assert_close(c.rss, c.sigma.unwrap().powi(2) * c.dof, 1e-9);
    }
    // Nearly all information comes from the quiet component, and so do the dof.
    let quiet = found.components[0].dof;
    let dof = found.coefficients[0].dof.unwrap();
    assert!(dof >= quiet - 0.5 && dof < quiet + 3.0, "{dof} {quiet}");
}

#[test]
fn neighbours_in_a_drift_are_alike_and_in_noise_are_not() {
    let mut rng = rng(2);
    let rows: Vec<Vec<f64>> = (0..40).map(|i| vec![1.0, f64::from(i)]).collect();
    let quiet: Vec<f64> = (0..40).map(|_| normal(&mut rng)).collect();
    let mut level = 0.0;
    let drift: Vec<f64> = (0..40)
        .map(|_| {
            level = 0.9 * level + normal(&mut rng);
            level
        })
        .collect();
    let a = fit(&single(&rows, &quiet), &Options::default()).unwrap();
    let b = fit(&single(&rows, &drift), &Options::default()).unwrap();
    assert!(a.components[0].durbin_watson.unwrap() > 1.2);
    assert!(b.components[0].durbin_watson.unwrap() < 1.2);
}
