//! Choosing between models.

use froude_fit::select::{lack_of_fit, leave_one_group_out, range_block};
use froude_fit::{Options, fit};

use crate::{assert_close, polynomial, single};

#[test]
fn leaving_groups_out_by_hand() {
    // Means of the other two groups: errors 1 − 3, 2 − 2.5 …
    let problem = single(&vec![vec![1.0]; 6], &[1.0, 1.0, 2.0, 2.0, 6.0, 6.0]);
    let groups = [7, 7, 8, 8, 9, 9];
    let scores = leave_one_group_out(&problem, &Options::default(), &groups).unwrap();
    let rmse = *scores[0].score.as_ref().unwrap();
    // 1 − 4 = −3, 2 − 3.5 = −1.5, 6 − 1.5 = 4.5.
    let expected = ((9.0 + 2.25 + 20.25) / 3.0_f64).sqrt();
    assert_close(rmse, expected, 1e-14);
}

#[test]
fn two_groups_are_not_scorable() {
    let problem = single(&vec![vec![1.0]; 4], &[1.0, 1.0, 2.0, 2.0]);
    let scores = leave_one_group_out(&problem, &Options::default(), &[0, 0, 1, 1]).unwrap();
    assert_eq!(scores[0].score, Err("leaving one group out needs 3 groups, and there are 2".to_owned()));
}

#[test]
fn a_group_that_needs_what_the_others_lack_is_not_scorable() {
    // Group 2 alone has the second column.
    let rows: Vec<Vec<f64>> = (0..9).map(|i| vec![1.0, if i >= 6 { 1.0 + f64::from(i) } else { 0.0 }]).collect();
    let y: Vec<f64> = rows.iter().map(|r| r[0] + 0.5 * r[1]).collect();
    let groups: Vec<usize> = (0..9).map(|i| i / 3).collect();
    let scores = leave_one_group_out(&single(&rows, &y), &Options::default(), &groups).unwrap();
    assert_eq!(scores[0].score, Err("without group 2 the others do not determine its prediction".to_owned()));
}

/// Cubic data, straight line trained on the low end: the error at the far end.
#[test]
fn a_range_block_shows_extrapolation() {
    let x: Vec<f64> = (0..10).map(f64::from).collect();
    let y: Vec<f64> = x.iter().map(|x| x * x).collect();
    let problem = single(&polynomial(&x, 2), &y);
    let train: Vec<bool> = (0..10).map(|i| i < 3).collect();
    let block = range_block(&problem, &Options::default(), &train).unwrap();
    // Line through (0,0), (1,1), (2,4): −1/3 + 2x.
    assert_close(block.refit.coefficients[1].value.unwrap(), 2.0, 1e-13);
    assert_close(block.predicted[9].unwrap(), 18.0 - 1.0 / 3.0, 1e-13);
}

/// A straight line through repeats of a bent curve, by hand.
#[test]
fn lack_of_fit_by_hand() {
    let x = [0.0, 0.0, 1.0, 1.0, 2.0, 2.0];
    let y = [0.1, -0.1, 0.9, 1.1, 4.2, 3.8];
    let problem = single(&polynomial(&x, 2), &y);
    let found = fit(&problem, &Options::default()).unwrap();
    let settings = [0, 0, 1, 1, 2, 2];
    let scores = lack_of_fit(&problem, &found, &settings).unwrap();
    let score = scores[0].score.as_ref().unwrap();
    // Pure: 0.02 + 0.02 + 0.08 = 0.12 on 3; means 0, 1, 4 leave 2 · (1/9 + 4/9 + 1/9).
    assert_eq!(score.dof, [1.0, 3.0]);
    assert_close(score.f, (4.0 / 3.0) / 0.04, 1e-12);
    assert!(score.p < 0.02);
    let single_settings = [0, 1, 2, 3, 4, 5];
    let scores = lack_of_fit(&problem, &found, &single_settings).unwrap();
    assert_eq!(scores[0].score, Err("no setting was repeated".to_owned()));
}

#[test]
fn aicc_of_a_fit_counts_sigma() {
    let problem = single(&vec![vec![1.0]; 6], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let found = fit(&problem, &Options::default()).unwrap();
    let expected = 6.0 * (17.5_f64 / 6.0).ln() + 4.0 + 12.0 / 3.0;
    assert_close(found.components[0].aicc.unwrap(), expected, 1e-13);
}
