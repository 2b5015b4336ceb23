//! Equalities and inequalities against what they mean.

use froude_fit::{Bound, Constraint, FitError, Options, Problem, Status, fit};

use crate::{assert_close, normal, rng, single};

fn problem() -> Problem {
    let mut rng = rng(11);
    let rows: Vec<Vec<f64>> = (0..20).map(|_| (0..4).map(|_| normal(&mut rng)).collect()).collect();
    let y: Vec<f64> =
        rows.iter().map(|r| 1.0 * r[0] + 2.0 * r[1] - 0.5 * r[2] + 0.3 * r[3] + 0.1 * normal(&mut rng)).collect();
    single(&rows, &y)
}

#[test]
fn an_equality_is_the_same_as_substituting_it() {
    let problem = problem();
    // b1 = 2 b0 + 0.3: substitute, and fit b0, b2, b3.
    let options =
        Options { equalities: vec![Constraint { row: vec![-2.0, 1.0, 0.0, 0.0], value: 0.3 }], ..Options::default() };
    let found = fit(&problem, &options).unwrap();
    let rows: Vec<Vec<f64>> = (0..20)
        .map(|i| {
            let x = |j: usize| problem.design[(i, j)];
            vec![x(0) + 2.0 * x(1), x(2), x(3)]
        })
        .collect();
    let y: Vec<f64> = (0..20).map(|i| problem.response[i] - 0.3 * problem.design[(i, 1)]).collect();
    let direct = fit(&single(&rows, &y), &Options::default()).unwrap();
    for (j, k) in [(0, 0), (2, 1), (3, 2)] {
        let (a, b) = (&found.coefficients[j], &direct.coefficients[k]);
        assert_close(a.value.unwrap(), b.value.unwrap(), 1e-13);
        assert_close(a.standard.unwrap(), b.standard.unwrap(), 1e-13);
    }
    let b0 = found.coefficients[0].value.unwrap();
    assert_close(found.coefficients[1].value.unwrap(), 2.0 * b0 + 0.3, 1e-13);
    assert_close(found.coefficients[1].standard.unwrap(), 2.0 * found.coefficients[0].standard.unwrap(), 1e-13);
    assert_eq!(found.components[0].dof, 17.0);
    // Both are one parameter: their correlation is 1.
    assert_close(found.correlation[(0, 1)], 1.0, 1e-13);
}

#[test]
fn repeating_an_equality_changes_nothing_and_contradicting_it_is_refused() {
    let problem = problem();
    let first = Constraint { row: vec![1.0, 1.0, 0.0, 0.0], value: 3.0 };
    let twice = Constraint { row: vec![2.0, 2.0, 0.0, 0.0], value: 6.0 };
    let other = Constraint { row: vec![2.0, 2.0, 0.0, 0.0], value: 6.1 };
    let with = |equalities: Vec<Constraint>| Options { equalities, ..Options::default() };
    let one = fit(&problem, &with(vec![first.clone()])).unwrap();
    let two = fit(&problem, &with(vec![first.clone(), twice])).unwrap();
    assert_close(two.components[0].rss, one.components[0].rss, 1e-12);
    assert_eq!(two.components[0].dof, one.components[0].dof);
    let error = fit(&problem, &with(vec![first, other])).unwrap_err();
    assert!(matches!(error, FitError::Inconsistent { .. }), "{error}");
}

#[test]
fn an_inequality_that_binds_is_the_equality_and_one_that_does_not_is_nothing() {
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
    let equal = Options { equalities: vec![at(2.0)], ..Options::default() };
    let equal = fit(&problem, &equal).unwrap();
    for (a, b) in tight.coefficients.iter().zip(&equal.coefficients) {
        assert_close(a.value.unwrap(), b.value.unwrap(), 1e-12);
    }
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

#[test]
fn equalities_with_bounds_hold_together() {
    let options = Options {
        bounds: vec![Bound::FREE, Bound::FREE, Bound::NON_NEGATIVE, Bound::FREE],
        equalities: vec![Constraint { row: vec![1.0, 0.0, 0.0, -1.0], value: 0.0 }],
        ..Options::default()
    };
    let fit = fit(&problem(), &options).unwrap();
    assert_eq!(fit.coefficients[2].value, Some(0.0));
    assert_close(fit.coefficients[0].value.unwrap(), fit.coefficients[3].value.unwrap(), 1e-13);
    assert!(matches!(fit.coefficients[2].status, Status::AtBound | Status::BoundContradicted));
    assert!(fit.optimality.unwrap().kkt < 1e-12);
}

#[test]
fn an_equality_determines_what_the_data_do_not() {
    let x = [1.0, 2.0, 3.0, 4.0];
    let problem = single(&x.map(|x| vec![x, 2.0 * x]), &[3.1, 5.9, 9.0, 12.1]);
    let options = Options { equalities: vec![Constraint { row: vec![1.0, -1.0], value: 0.0 }], ..Options::default() };
    let fit = fit(&problem, &options).unwrap();
    let slope = (3.1 + 2.0 * 5.9 + 3.0 * 9.0 + 4.0 * 12.1) / 30.0;
    assert_close(fit.coefficients[0].value.unwrap(), slope / 3.0, 1e-13);
    assert!(fit.undetermined.is_empty());
}
