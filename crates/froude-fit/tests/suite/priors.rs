//! Published values as observations.

use froude_fit::faer::Mat;
use froude_fit::{End, Options, Prior, Status, fit};

use crate::{assert_close, normal, rng, single};

/// A mean with a prior: the fixed point by hand.
#[test]
fn a_prior_on_a_mean_is_the_inverse_variance_average() {
    let y = [4.0, 6.0, 5.0, 7.0, 3.0];
    let options = Options { priors: vec![Prior::new(0, 2.0, 0.5)], ..Options::default() };
    let found = fit(&single(&vec![vec![1.0]; 5], &y), &options).unwrap();
    let c = &found.coefficients[0];
    assert_eq!(c.status, Status::Prior);
    assert_eq!(found.report.end, End::Converged);
    // Independent iteration of the same two equations.
    let mut s2 = 2.5_f64;
    let mut mean = 5.0;
    for _ in 0..10_000 {
        let (data, prior) = (5.0 / s2, 4.0);
        mean = (data * 5.0 + prior * 2.0) / (data + prior);
        let rss: f64 = y.iter().map(|y| (y - mean) * (y - mean)).sum();
        s2 = rss / (5.0 - data / (data + prior));
    }
    assert_close(c.value.unwrap(), mean, 1e-9);
    assert_close(found.components[0].sigma.unwrap(), s2.sqrt(), 1e-9);
    assert_close(c.standard.unwrap().powi(2), 1.0 / (5.0 / s2 + 4.0), 1e-9);
    assert!(c.dof.unwrap() > found.components[0].dof);
}

#[test]
fn a_vague_prior_changes_nothing_and_a_sharp_one_decides() {
    let mut rng = rng(4);
    let rows: Vec<Vec<f64>> = (0..15).map(|i| vec![1.0, f64::from(i)]).collect();
    let y: Vec<f64> = rows.iter().map(|r| 1.0 + 0.5 * r[1] + 0.2 * normal(&mut rng)).collect();
    let with = |standard: f64| Options { priors: vec![Prior::new(1, 3.0, standard)], ..Options::default() };
    let problem = single(&rows, &y);
    let free = fit(&problem, &Options::default()).unwrap();
    let vague = fit(&problem, &with(1e6)).unwrap();
    for (a, b) in vague.coefficients.iter().zip(&free.coefficients) {
        assert_close(a.value.unwrap(), b.value.unwrap(), 1e-9);
        assert_close(a.standard.unwrap(), b.standard.unwrap(), 1e-9);
        assert_close(a.dof.unwrap(), 13.0, 1e-6);
    }
    let sharp = fit(&problem, &with(1e-9)).unwrap();
    assert_close(sharp.coefficients[1].value.unwrap(), 3.0, 1e-12);
    assert_close(sharp.coefficients[1].standard.unwrap(), 1e-9, 1e-12);
    assert!(sharp.coefficients[1].dof.unwrap() > 1e6);
}

#[test]
fn a_prior_determines_what_the_data_do_not() {
    let x = [1.0, 2.0, 3.0, 4.0, 5.0];
    let problem = single(&x.map(|x| vec![x, 2.0 * x]), &[5.1, 9.9, 15.1, 20.0, 24.9]);
    let options = Options { priors: vec![Prior::new(0, 1.0, 0.1)], ..Options::default() };
    let found = fit(&problem, &options).unwrap();
    let slope = fit(&single(&x.map(|x| vec![x]), &[5.1, 9.9, 15.1, 20.0, 24.9]), &Options::default()).unwrap();
    let slope = &slope.coefficients[0];
    let b1 = &found.coefficients[1];
    assert_close(found.coefficients[0].value.unwrap(), 1.0, 1e-10);
    assert_close(b1.value.unwrap(), (slope.value.unwrap() - 1.0) / 2.0, 1e-10);
    let variance = (slope.standard.unwrap().powi(2) + 0.01) / 4.0;
    assert_close(b1.standard.unwrap().powi(2), variance, 1e-9);
    assert!(found.undetermined.is_empty());
}

/// Beside data that say next to nothing the posterior is the prior, correlation included; with one coefficient fixed it is the prior given that one.
#[test]
fn correlated_priors_keep_their_covariance() {
    let covariance = Mat::from_fn(3, 3, |i, j| [[4.0, 1.8, -0.5], [1.8, 1.0, 0.2], [-0.5, 0.2, 2.0]][i][j]);
    let priors = Prior::correlated(&[0, 1, 2], &[3.0, -1.0, 2.0], &covariance).unwrap();
    let mut rng = rng(9);
    let rows: Vec<Vec<f64>> = (0..12).map(|i| vec![1e-7, 1e-7 * f64::from(i), 1e-7 * f64::from(i * i)]).collect();
    let y: Vec<f64> = (0..12).map(|_| normal(&mut rng)).collect();
    let options = Options { priors, ..Options::default() };
    let found = fit(&single(&rows, &y), &options).unwrap();
    for i in 0..3 {
        assert_close(found.coefficients[i].value.unwrap(), [3.0, -1.0, 2.0][i], 1e-4);
        for j in 0..3 {
            assert!((found.covariance[(i, j)] - covariance[(i, j)]).abs() < 1e-4, "{:?}", found.covariance);
        }
    }
    let held =
        fit(&single(&rows, &y), &Options { fixed: vec![(0, 5.0)], priors: options.priors[1..].to_vec(), ..options })
            .unwrap();
    // β₁ given β₀ = 5: −1 + 1.8/4·2, with a variance of 1 − 1.8²/4.
    assert_close(held.coefficients[1].value.unwrap(), -0.1, 1e-4);
    assert!((held.covariance[(1, 1)] - 0.19).abs() < 1e-4);
}
