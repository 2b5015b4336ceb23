//! Inequalities against what they mean.

use froude_fit::{Bound, Constraint, FitError, Options, Problem, fit};

use crate::{assert_close, normal, rng, single};

fn problem() -> Problem {
    let mut rng = rng(11);
    let rows: Vec<Vec<f64>> = (0..20).map(|_| (0..4).map(|_| normal(&mut rng)).collect()).collect();
    let y: Vec<f64> =
        rows.iter().map(|r| 1.0 * r[0] + 2.0 * r[1] - 0.5 * r[2] + 0.3 * r[3] + 0.1 * normal(&mut rng)).collect();
    single(&rows, &y)
}

#[test]
fn an_inequality_that_binds_is_the_equality_substituted_and_one_that_does_not_is_nothing() {
    let problem = problem();
    let row = vec![1.0, 1.0, 0.0, 0.0];
    let at = |value: f64| Constraint { row: row.clone(), value };
    let free = fit(&problem, &Options::default()).unwrap();
    let loose = Options { inequalities: vec![at(10.0)], ..Options::default() };
    let loose = fit(&problem, &loose).unwrap();
    for (a, b) in loose.coefficients.iter().zip(&free.coefficients) {
        assert_close(a.value.unwrap(), b.value.unwrap(), 1e-14);
    }
    assert!(loose.optimality.unwrap().active_inequalities.is_empty());
    let tight = Options { inequalities: vec![at(10.0), at(2.0)], ..Options::default() };
    let tight = fit(&problem, &tight).unwrap();
    // b1 = 2 − b0: substitute, and fit b0, b2, b3.
    let x = |i: usize, j: usize| problem.design[(i, j)];
    let rows: Vec<Vec<f64>> = (0..20).map(|i| vec![x(i, 0) - x(i, 1), x(i, 2), x(i, 3)]).collect();
    let y: Vec<f64> = (0..20).map(|i| problem.response[i] - 2.0 * x(i, 1)).collect();
    let equal = fit(&single(&rows, &y), &Options::default()).unwrap();
    let value = |j: usize| tight.coefficients[j].value.unwrap();
    for (j, k) in [(0, 0), (2, 1), (3, 2)] {
        assert_close(value(j), equal.coefficients[k].value.unwrap(), 1e-12);
    }
    assert_close(value(0) + value(1), 2.0, 1e-12);
    let optimality = tight.optimality.unwrap();
    assert_eq!(optimality.active_inequalities, [1]);
    assert!(optimality.kkt < 1e-12);
    // Uncertainty is that of the unconstrained estimate.
    assert_eq!(tight.coefficients[0].interval, free.coefficients[0].interval);
}

/// The point of the unit square nearest to (2, 0.5), then to (2, 3), under x + y ≤ 1.5.
#[test]
fn the_nearest_point_of_a_polygon_is_exact() {
    for (target, nearest) in [([2.0, 0.3], [1.0, 0.3]), ([2.0, 3.0], [0.5, 1.0])] {
        let options = Options {
            bounds: vec![Bound { lower: 0.0, upper: 1.0 }; 2],
            inequalities: vec![Constraint { row: vec![1.0, 1.0], value: 1.5 }],
            ..Options::default()
        };
        let problem = single(&[vec![1.0, 0.0], vec![0.0, 1.0]], &target);
        let fit = fit(&problem, &options).unwrap();
        for j in 0..2 {
            assert!((fit.coefficients[j].value.unwrap() - nearest[j]).abs() < 1e-14);
        }
    }
}

#[test]
fn constraints_that_leave_nothing_are_refused() {
    let options = Options {
        bounds: vec![Bound::NON_NEGATIVE; 4],
        inequalities: vec![Constraint { row: vec![1.0, 1.0, 1.0, 1.0], value: -1.0 }],
        ..Options::default()
    };
    let error = fit(&problem(), &options).unwrap_err();
    assert_eq!(error, FitError::Infeasible);
    assert_eq!(error.to_string(), "no coefficients satisfy all constraints at once; drop or widen one");
}
