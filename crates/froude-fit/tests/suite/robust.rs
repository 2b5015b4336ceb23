//! Huber's loss.

use froude_fit::{Bound, CovarianceKind, End, Loss, Options, fit};

use crate::{assert_close, normal, rng, single};

fn huber(k: f64) -> Options {
    Options { loss: Loss::Huber { k }, ..Options::default() }
}

#[test]
fn one_wild_point_does_not_move_a_huber_line() {
    let mut rng = rng(6);
    let rows: Vec<Vec<f64>> = (0..25).map(|i| vec![1.0, f64::from(i)]).collect();
    let clean: Vec<f64> = rows.iter().map(|r| 2.0 + 0.5 * r[1] + 0.1 * normal(&mut rng)).collect();
    let mut wild = clean;
    wild[20] += 50.0;
    let after = fit(&single(&rows, &wild), &huber(1.345)).unwrap();
    let squares = fit(&single(&rows, &wild), &Options::default()).unwrap();
    assert_eq!(after.report.end, End::Converged);
    let move_of = |f: &froude_fit::Fit| (f.coefficients[1].value.unwrap() - 0.5).abs();
    assert!(move_of(&after) < 0.01, "{}", move_of(&after));
    assert!(move_of(&squares) > 0.1);
    assert!(after.components[0].sigma.unwrap() < 0.2);
    for kind in [CovarianceKind::Classical, CovarianceKind::Hc3] {
        let options = Options { covariance: kind, ..huber(1.345) };
        let fit = fit(&single(&rows, &wild), &options).unwrap();
        let standard = fit.coefficients[1].standard.unwrap();
        // σ/√Sxx = 0.1/36 = 0.0028 for clean data.
        assert!((0.0015..0.008).contains(&standard), "{kind:?} {standard}");
    }
}

/// With k beyond every residual the estimate, and Huber's covariance with the
/// variance in place of the scale, are those of least squares.
#[test]
fn a_wide_huber_is_least_squares() {
    let mut rng = rng(7);
    let rows: Vec<Vec<f64>> = (0..12).map(|i| vec![1.0, f64::from(i)]).collect();
    let y: Vec<f64> = rows.iter().map(|r| r[1] + normal(&mut rng)).collect();
    let wide = fit(&single(&rows, &y), &huber(100.0)).unwrap();
    let squares = fit(&single(&rows, &y), &Options::default()).unwrap();
    for (a, b) in wide.coefficients.iter().zip(&squares.coefficients) {
        assert_close(a.value.unwrap(), b.value.unwrap(), 1e-10);
        assert_close(a.standard.unwrap(), b.standard.unwrap(), 1e-10);
    }
}

/// The estimating equation `Σ ψ(r/σ) x = 0`.
#[test]
fn huber_solves_its_estimating_equation() {
    let mut rng = rng(9);
    let rows: Vec<Vec<f64>> = (0..40).map(|i| vec![1.0, f64::from(i % 7)]).collect();
    let y: Vec<f64> = rows.iter().map(|r| r[1] + normal(&mut rng) / (0.1 + normal(&mut rng).abs())).collect();
    let fit = fit(&single(&rows, &y), &huber(1.345)).unwrap();
    let sigma = fit.components[0].sigma.unwrap();
    for j in 0..2 {
        let sum: f64 = rows.iter().zip(&fit.residuals).map(|(x, r)| (r / sigma).clamp(-1.345, 1.345) * x[j]).sum();
        assert!(sum.abs() < 1e-6, "{sum}");
    }
    assert!(fit.components[0].aicc.is_none());
}

#[test]
fn huber_with_bounds_holds_them() {
    let x: Vec<f64> = (1..=12).map(f64::from).collect();
    let mut y: Vec<f64> = x.iter().map(|x| 0.1 + x + 0.05 * (7.0 * x).sin()).collect();
    y[5] = 50.0;
    let rows: Vec<Vec<f64>> = x.iter().map(|&x| vec![1.0, x]).collect();
    let options = Options { bounds: vec![Bound { lower: 0.5, upper: 1.0 }, Bound::FREE], ..huber(1.345) };
    let fit = fit(&single(&rows, &y), &options).unwrap();
    assert_eq!(fit.coefficients[0].value, Some(0.5));
    assert!((fit.coefficients[1].value.unwrap() - 0.95).abs() < 0.02);
    // On the other coefficient the estimating equation still holds.
    let sigma = fit.components[0].sigma.unwrap();
    let sum: f64 = x.iter().zip(&fit.residuals).map(|(x, r)| (r / sigma).clamp(-1.345, 1.345) * x).sum();
    assert!(sum.abs() < 1e-6, "{sum}");
}
