//! Shared input errors and effective degrees of freedom.

use faer::Mat;
use froude_fit::propagate::{coverage_factor, effective_dof, expanded, shared_error};
use froude_fit::{FitError, Options, fit};

use crate::{assert_close, single};

fn mean_sensitivity(n: usize) -> Mat<f64> {
    fit(&single(&vec![vec![1.0]; n], &vec![1.0; n]), &Options::default()).unwrap().sensitivity
}

/// A zero offset shared by all samples does not average down; one per run does.
#[test]
fn a_shared_offset_does_not_average_down() {
    let s = mean_sensitivity(12);
    let ones = [1.0; 12];
    let campaign = shared_error(s.as_ref(), &ones, 0.3, None).unwrap();
    assert_close(campaign[(0, 0)], 0.09, 1e-14);
    let runs: Vec<usize> = (0..12).map(|i| i / 3).collect();
    let of_runs = shared_error(s.as_ref(), &ones, 0.3, Some(&runs)).unwrap();
    assert_close(of_runs[(0, 0)], 0.09 / 4.0, 1e-14);
    let samples: Vec<usize> = (0..12).collect();
    let of_samples = shared_error(s.as_ref(), &ones, 0.3, Some(&samples)).unwrap();
    assert_close(of_samples[(0, 0)], 0.09 / 12.0, 1e-14);
}

/// A gain error of the sensor scales every coefficient by as much.
#[test]
fn a_gain_error_is_a_relative_error_of_each_coefficient() {
    let rows: Vec<Vec<f64>> = (1..8).map(|i| vec![f64::from(i), f64::from(i * i)]).collect();
    let y: Vec<f64> = rows.iter().map(|r| 0.4 * r[0] + 1.7 * r[1]).collect();
    let fit = fit(&single(&rows, &y), &Options::default()).unwrap();
    let u = shared_error(fit.sensitivity.as_ref(), &y, 0.01, None).unwrap();
    assert_close(u[(0, 0)].sqrt(), 0.004, 1e-11);
    assert_close(u[(1, 1)].sqrt(), 0.017, 1e-11);
    assert_close(u[(0, 1)], 0.004 * 0.017, 1e-11);
}

#[test]
fn welch_satterthwaite_of_equal_variances_adds_the_degrees() {
    assert_close(effective_dof(&[(1.0, 5.0), (1.0, 5.0)]), 10.0, 1e-15);
    assert_eq!(effective_dof(&[(1.0, f64::INFINITY)]), f64::INFINITY);
    assert_eq!(effective_dof(&[(2.0, 7.0), (0.0, 1.0)]), 7.0);
    let u = expanded(&[(9.0, 5.0), (16.0, f64::INFINITY)], 0.95);
    assert_close(u.standard, 5.0, 1e-15);
    assert_close(u.dof, 625.0 / (81.0 / 5.0), 1e-14);
    assert_close(u.expanded, 5.0 * coverage_factor(0.95, u.dof), 1e-14);
}

#[test]
fn sizes_and_signs_are_checked() {
    let s = mean_sensitivity(3);
    let error = shared_error(s.as_ref(), &[1.0], 0.1, None).unwrap_err();
    assert_eq!(error.to_string(), "derivative has 1 entries where 3 are needed (one per row of the fit)");
    let error = shared_error(s.as_ref(), &[1.0; 3], -0.1, None).unwrap_err();
    assert!(matches!(error, FitError::Option { .. }));
}
