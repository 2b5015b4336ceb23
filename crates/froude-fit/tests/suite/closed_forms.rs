//! Fits with a formula of one line.

use froude_fit::{Options, Problem, Status, distribution::coverage_factor, fit};

use crate::{assert_close, single};

const Y: [f64; 5] = [2.0, 3.0, 5.0, 4.0, 6.0];

#[test]
fn the_mean_has_standard_error_s_over_root_n() {
    let problem = single(&vec![vec![1.0]; 5], &Y);
    let fit = fit(&problem, &Options::default()).unwrap();
    let c = &fit.coefficients[0];
    // Σ(y − 4)² = 10, s² = 2.5.
    assert_close(c.value.unwrap(), 4.0, 1e-15);
    assert_close(fit.components[0].sigma.unwrap(), 2.5_f64.sqrt(), 1e-15);
    assert_close(c.standard.unwrap(), 0.5_f64.sqrt(), 1e-15);
    let half = coverage_factor(0.95, 4.0) * 0.5_f64.sqrt();
    assert_close(c.interval.unwrap()[0], 4.0 - half, 1e-14);
    assert_eq!((c.dof, c.status), (Some(4.0), Status::Free));
    assert!(fit.leverage.iter().all(|h| (h - 0.2).abs() < 1e-15));
    assert_eq!(fit.condition_number, 1.0);
}

#[test]
fn a_line_through_the_origin_is_sum_xy_over_sum_xx() {
    let x = [1.0, 2.0, 3.0, 4.0, 5.0];
    let problem = single(&x.map(|x| vec![x]), &Y);
    let fit = fit(&problem, &Options::default()).unwrap();
    let sxy: f64 = x.iter().zip(&Y).map(|(x, y)| x * y).sum();
    let slope = sxy / 55.0;
    let rss: f64 = x.iter().zip(&Y).map(|(x, y)| (y - slope * x).powi(2)).sum();
    let c = &fit.coefficients[0];
    assert_close(c.value.unwrap(), slope, 1e-15);
    assert_close(c.standard.unwrap(), (rss / 4.0 / 55.0).sqrt(), 1e-14);
    assert_close(fit.components[0].rss, rss, 1e-14);
    let size: f64 = Y.iter().map(|y| y * y).sum();
    assert_close(fit.components[0].relative_residual, (rss / size).sqrt(), 1e-14);
}

#[test]
fn a_straight_line_matches_the_textbook() {
    let x = [0.0, 1.0, 2.0, 3.0, 4.0];
    let problem = single(&x.map(|x| vec![1.0, x]), &Y);
    let fit = fit(&problem, &Options::default()).unwrap();
    // x̄ = 2, Sxx = 10, Sxy = 9; residual sum 10 − 8.1.
    let (slope, rss) = (0.9, 1.9);
    assert_close(fit.coefficients[1].value.unwrap(), slope, 1e-14);
    assert_close(fit.coefficients[0].value.unwrap(), 4.0 - 1.8, 1e-14);
    let s2 = rss / 3.0;
    assert_close(fit.coefficients[1].standard.unwrap().powi(2), s2 / 10.0, 1e-14);
    assert_close(fit.coefficients[0].standard.unwrap().powi(2), s2 * (0.2 + 0.4), 1e-14);
    assert_close(fit.covariance[(0, 1)], -s2 * 0.2, 1e-14);
    let (_, _, r) = fit.largest_correlation.unwrap();
    assert_close(r, -0.2 / (0.6_f64 * 0.1).sqrt(), 1e-13);
    // Sensitivity: ∂slope/∂y_i = (x_i − x̄)/Sxx.
    for i in 0..5 {
        assert_close(fit.sensitivity()[(1, i)], (x[i] - 2.0) / 10.0, 1e-14);
    }
    assert_close(fit.predict(&[1.0, 6.0]).unwrap(), 2.2 + 5.4, 1e-14);
}

#[test]
fn weights_are_relative_inverse_variances() {
    let weight = vec![1.0, 4.0, 0.25, 2.0, 9.0];
    let problem = Problem { weight: Some(weight.clone()), ..single(&vec![vec![1.0]; 5], &Y) };
    let fit1 = fit(&problem, &Options::default()).unwrap();
    let total: f64 = weight.iter().sum();
    let mean = weight.iter().zip(&Y).map(|(w, y)| w * y).sum::<f64>() / total;
    let rss: f64 = weight.iter().zip(&Y).map(|(w, y)| w * (y - mean).powi(2)).sum();
    assert_close(fit1.coefficients[0].value.unwrap(), mean, 1e-14);
    assert_close(fit1.coefficients[0].standard.unwrap().powi(2), rss / 4.0 / total, 1e-14);
    let scaled = Problem { weight: Some(weight.iter().map(|w| 7.0 * w).collect()), ..problem };
    let fit2 = fit(&scaled, &Options::default()).unwrap();
    assert_close(fit2.coefficients[0].standard.unwrap(), fit1.coefficients[0].standard.unwrap(), 1e-14);
}

#[test]
fn held_coefficients_are_moved_to_the_other_side() {
    let x = [0.0, 1.0, 2.0, 3.0, 4.0];
    let problem = single(&x.map(|x| vec![1.0, x, x * x]), &Y);
    let options = Options { fixed: vec![(0, 2.0)], excluded: vec![2], ..Options::default() };
    let fit = fit(&problem, &options).unwrap();
    let sxy: f64 = x.iter().zip(&Y).map(|(x, y)| x * (y - 2.0)).sum();
    assert_close(fit.coefficients[1].value.unwrap(), sxy / 30.0, 1e-14);
    assert_eq!(fit.coefficients[0].status, Status::Fixed);
    assert_eq!(fit.coefficients[0].value, Some(2.0));
    assert_eq!(fit.coefficients[0].standard, None);
    assert_eq!(fit.coefficients[2].status, Status::Excluded);
    assert_eq!(fit.coefficients[2].value, Some(0.0));
    assert_eq!(fit.components[0].dof, 4.0);
}

#[test]
fn everything_held_still_gives_residuals_and_sigma() {
    let problem = single(&vec![vec![1.0]; 5], &Y);
    let options = Options { fixed: vec![(0, 4.0)], ..Options::default() };
    let fit = fit(&problem, &options).unwrap();
    assert_close(fit.components[0].rss, 10.0, 1e-15);
    assert_eq!(fit.components[0].dof, 5.0);
    assert_close(fit.components[0].sigma.unwrap(), 2.0_f64.sqrt(), 1e-15);
}

#[test]
fn as_many_rows_as_coefficients_leave_no_uncertainty_to_state() {
    let problem = single(&[vec![1.0, 0.0], vec![1.0, 1.0]], &[3.0, 5.0]);
    let fit = fit(&problem, &Options::default()).unwrap();
    assert_close(fit.coefficients[1].value.unwrap(), 2.0, 1e-15);
    assert_eq!(fit.coefficients[1].standard, None);
    assert_eq!(fit.coefficients[1].interval, None);
    assert_eq!(fit.components[0].sigma, None);
    assert_eq!(fit.components[0].aicc, None);
    assert_eq!(fit.covariance[(0, 0)], 0.0);
}
