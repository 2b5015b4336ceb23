//! Each thing wrong with the input, in the words a user meets.

use faer::Mat;
use froude_fit::{Bound, Constraint, CovarianceKind, FitError, Options, Prior, Problem, fit};

use crate::single;

fn good() -> Problem {
    single(&[vec![1.0, 0.0], vec![1.0, 1.0], vec![1.0, 2.0], vec![1.0, 4.0]], &[1.0, 2.0, 3.5, 5.0])
}

#[track_caller]
fn refused(problem: &Problem, options: &Options, words: &str) -> FitError {
    let error = fit(problem, options).unwrap_err();
    assert_eq!(error.to_string(), words);
    error
}

#[test]
fn an_empty_problem() {
    let none = Problem::single(Mat::zeros(0, 2), vec![], crate::names(2));
    refused(&none, &Options::default(), "the problem has no rows; give at least one observation");
    let none = Problem::single(Mat::zeros(3, 0), vec![1.0; 3], vec![]);
    refused(&none, &Options::default(), "the design has no columns; name at least one coefficient");
}

#[test]
fn sizes_that_do_not_match() {
    let mut problem = good();
    problem.response.pop();
    refused(&problem, &Options::default(), "response has 3 entries where 4 are needed (one per row of the design)");
    let mut problem = good();
    problem.names.pop();
    refused(&problem, &Options::default(), "names has 1 entries where 2 are needed (one per column of the design)");
    let problem = Problem { cluster: Some(vec![1, 2]), ..good() };
    refused(&problem, &Options::default(), "cluster has 2 entries where 4 are needed (one per row of the design)");
    let options = Options { bounds: vec![Bound::FREE], ..Options::default() };
    refused(&good(), &options, "bounds has 1 entries where 2 are needed (one per column of the design)");
    let options = Options { inequalities: vec![Constraint { row: vec![1.0], value: 0.0 }], ..Options::default() };
    refused(&good(), &options, "inequality row has 1 entries where 2 are needed (one per column of the design)");
}

#[test]
fn numbers_that_are_none() {
    let mut problem = good();
    problem.design[(2, 1)] = f64::NAN;
    refused(&problem, &Options::default(), "design row 2, column \"b1\" is NaN; every entry must be finite");
    let mut problem = good();
    problem.response[3] = f64::INFINITY;
    refused(&problem, &Options::default(), "response of row 3 is inf; every entry must be finite");
    let problem = Problem { weight: Some(vec![1.0, -1.0, 1.0, 1.0]), ..good() };
    refused(
        &problem,
        &Options::default(),
        "weight of row 1 is -1; a weight is a relative 1/variance, finite and not negative (0 ignores the row)",
    );
}

#[test]
fn names_and_components() {
    let mut problem = good();
    problem.names = vec!["C_f".into(), "C_f".into()];
    refused(&problem, &Options::default(), "coefficient \"C_f\" is named twice (columns 0 and 1); rename one");
    let mut problem = good();
    problem.component[1] = 1;
    refused(&problem, &Options::default(), "row 1 belongs to component 1, but only 1 are named");
    let mut problem = good();
    problem.components.push("f_y".into());
    refused(&problem, &Options::default(), "component \"f_y\" has no rows; leave it out or add its observations");
}

#[test]
fn options_that_cannot_be() {
    let with = |options: Options, words: &str| {
        refused(&good(), &options, words);
    };
    with(Options { fixed: vec![(7, 1.0)], ..Options::default() }, "fixed names coefficient 7, but the design has 2");
    with(
        Options { fixed: vec![(1, 1.0)], excluded: vec![1], ..Options::default() },
        "coefficient \"b1\" is fixed and excluded at once; choose one",
    );
    with(
        Options { bounds: vec![Bound { lower: 1.0, upper: 0.0 }, Bound::FREE], ..Options::default() },
        "bounds of \"b0\" are [1, 0]; the lower must not exceed the upper",
    );
    with(
        Options { bounds: vec![Bound::NON_NEGATIVE; 2], fixed: vec![(0, -1.0)], ..Options::default() },
        "coefficient \"b0\" is fixed at -1, outside its bounds [0, inf]",
    );
    with(
        Options { priors: vec![Prior::new(0, 1.0, 0.0)], ..Options::default() },
        "the standard uncertainty of a prior is 0; it must be positive and finite (fix the \
         coefficient to take a value as exact)",
    );
    with(Options { confidence: 95.0, ..Options::default() }, "confidence is 95; it must be between 0 and 1");
    with(
        Options { covariance: CovarianceKind::Cr3, ..Options::default() },
        "cluster-robust covariance needs a cluster for every row, and none are given: name the column that has them, group = \"run\" say",
    );
    with(
        Options { inequalities: vec![Constraint { row: vec![f64::NAN, 0.0], value: 0.0 }], ..Options::default() },
        "a number of a constraint is NaN; it must be finite",
    );
}

#[test]
fn constraints_on_held_coefficients_hold_or_are_refused() {
    let row = vec![1.0, 0.0];
    let held = |value: f64| Options {
        fixed: vec![(0, 1.0)],
        inequalities: vec![Constraint { row: row.clone(), value }],
        ..Options::default()
    };
    assert!(fit(&good(), &held(1.0)).is_ok());
    refused(&good(), &held(0.5), "no coefficients satisfy all constraints at once; drop or widen one");
}
