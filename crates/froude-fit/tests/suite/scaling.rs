//! The unit of a coefficient decides nothing.

use faer::Mat;
use froude_fit::{Bound, Constraint, CovarianceKind, Fit, Options, Prior, Problem, fit};
use proptest::prelude::*;

use crate::{normal, rng, single};

fn problem(seed: u64) -> Problem {
    let mut rng = rng(seed);
    let rows: Vec<Vec<f64>> = (0..24)
        .map(|_| {
            let (a, b) = (normal(&mut rng), normal(&mut rng));
            vec![a, b, normal(&mut rng), a - 2.0 * b]
        })
        .collect();
    let y: Vec<f64> = rows.iter().map(|r| r[0] - 0.2 * r[1] + r[2] + 0.2 * normal(&mut rng)).collect();
    Problem { cluster: Some((0..24).map(|i| i % 6).collect()), ..single(&rows, &y) }
}

/// The same problem in units in which coefficient `j` is `factor[j]` times smaller.
fn rescaled(problem: &Problem, options: &Options, factor: &[f64]) -> Fit {
    let design = Mat::from_fn(problem.n_rows(), problem.n_coefficients(), |i, j| problem.design[(i, j)] * factor[j]);
    let row =
        |c: &Constraint| Constraint { row: c.row.iter().zip(factor).map(|(r, f)| r * f).collect(), value: c.value };
    let options = Options {
        bounds: options
            .bounds
            .iter()
            .zip(factor)
            .map(|(b, f)| Bound { lower: b.lower / f, upper: b.upper / f })
            .collect(),
        inequalities: options.inequalities.iter().map(row).collect(),
        priors: options
            .priors
            .iter()
            .map(|p| Prior::new(p.index, p.value / factor[p.index], p.standard / factor[p.index]))
            .collect(),
        ..options.clone()
    };
    fit(&Problem { design, ..problem.clone() }, &options).unwrap()
}

fn same(a: &Fit, b: &Fit, factor: &[f64]) -> Result<(), TestCaseError> {
    for (j, (a, b)) in a.coefficients.iter().zip(&b.coefficients).enumerate() {
        prop_assert_eq!(a.status, b.status, "{}", j);
        for (a, b) in [(a.value, b.value), (a.standard, b.standard)] {
            prop_assert_eq!(a.is_some(), b.is_some());
            if let (Some(a), Some(b)) = (a, b) {
                prop_assert!((b * factor[j] - a).abs() <= 1e-9 * (1e-3 + a.abs()), "{} {}", a, b);
            }
        }
    }
    prop_assert_eq!(a.undetermined.len(), b.undetermined.len());
    for (a, b) in a.undetermined.iter().zip(&b.undetermined) {
        let first = factor[a.weights[0].0];
        prop_assert!((b.value * first - a.value).abs() <= 1e-9 * (1e-3 + a.value.abs()));
        for (x, y) in a.weights.iter().zip(&b.weights) {
            prop_assert_eq!(x.0, y.0);
            prop_assert!((y.1 * first / factor[x.0] - x.1).abs() <= 1e-9 * x.1.abs());
        }
    }
    for (x, y) in a.fitted.iter().zip(&b.fitted) {
        prop_assert!((x - y).abs() < 1e-10);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn columns_scaled_by_a_million_give_the_same_fit(
        seed in 0_u64..1000,
        exponent in prop::collection::vec(-6_i32..=6, 4),
    ) {
        let factor: Vec<f64> = exponent.iter().map(|&e| 10.0_f64.powi(e)).collect();
        let problem = problem(seed);
        let with_bounds = Options {
            bounds: vec![Bound::NON_NEGATIVE; 4],
            ..Options::default()
        };
        let with_constraint = Options {
            inequalities: vec![Constraint { row: vec![1.0, 0.0, 1.0, 0.0], value: 1.0 }],
            excluded: vec![3],
            covariance: CovarianceKind::Cr3,
            ..Options::default()
        };
        let with_prior = Options {
            priors: vec![Prior::new(3, 0.1, 0.05)],
            ..Options::default()
        };
        for options in [Options::default(), with_bounds, with_constraint, with_prior] {
            let plain = fit(&problem, &options).unwrap();
            let other = rescaled(&problem, &options, &factor);
            same(&plain, &other, &factor)?;
        }
    }
}
