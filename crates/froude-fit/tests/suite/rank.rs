//! What a design does not determine, and what it still does.

use faer::Mat;
use froude_fit::{Options, Problem, Status, fit};

use crate::{assert_close, names, normal, rng, single};

/// A body of k links with head and tail, one configuration: the link columns
/// are the head/tail columns times `k G_T / G_HT`.
#[test]
fn parallel_columns_give_their_factors_as_weights() {
    let (link, head_tail) = (5.0 * 3.7, 2.3);
    let mut rng = rng(3);
    let rows: Vec<Vec<f64>> = (1..=12)
        .map(|i| {
            let v = 0.1 * f64::from(i);
            vec![link * v, link * v * v, head_tail * v, head_tail * v * v]
        })
        .collect();
    let y: Vec<f64> =
        rows.iter().map(|r| 0.02 * r[0] + 0.3 * r[1] + 0.1 * r[2] + 0.9 * r[3] + 0.01 * normal(&mut rng)).collect();
    let found = fit(&single(&rows, &y), &Options::default()).unwrap();
    assert!(
        found
            .coefficients
            .iter()
            .all(|c| c.status == Status::Undetermined && c.value.is_none() && c.interval.is_none())
    );
    assert!(found.condition_number.is_infinite());
    assert_eq!(found.components[0].rank, 2);
    assert_eq!(found.undetermined.len(), 2);
    let reduced: Vec<Vec<f64>> = rows.iter().map(|r| vec![r[0], r[1]]).collect();
    let direct = fit(&single(&reduced, &y), &Options::default()).unwrap();
    for (k, members) in [(0, [0, 2]), (1, [1, 3])] {
        let sum = &found.undetermined[k];
        assert_eq!(sum.weights[0], (members[0], 1.0));
        assert_eq!(sum.weights[1].0, members[1]);
        assert_close(sum.weights[1].1, head_tail / link, 1e-12);
        let c = &direct.coefficients[k];
        assert_close(sum.value, c.value.unwrap(), 1e-12);
        assert_close(sum.standard.unwrap(), c.standard.unwrap(), 1e-11);
        assert_eq!(sum.dof, Some(10.0));
    }
    // The force itself is determined; a force of another body is not.
    let at = |k: f64| [k * 3.7, k * 3.7, head_tail, head_tail];
    let force = found.predict(&at(5.0)).unwrap();
    let expected = direct.predict(&[link, link]).unwrap();
    assert_close(force, expected, 1e-12);
    assert!(found.predict(&at(4.0)).is_none());
}

#[test]
fn a_second_configuration_determines_all() {
    let rows: Vec<Vec<f64>> = [1.0, 5.0]
        .iter()
        .flat_map(|k| {
            (1..=6).map(move |i| {
                let v = 0.1 * f64::from(i);
                vec![k * 3.7 * v, 2.3 * v]
            })
        })
        .collect();
    let y: Vec<f64> = rows.iter().map(|r| 0.5 * r[0] + 0.7 * r[1]).collect();
    let fit = fit(&single(&rows, &y), &Options::default()).unwrap();
    assert!(fit.undetermined.is_empty());
    assert_close(fit.coefficients[0].value.unwrap(), 0.5, 1e-13);
    assert_close(fit.coefficients[1].value.unwrap(), 0.7, 1e-13);
}

#[test]
fn determined_coefficients_keep_their_values_beside_undetermined_ones() {
    // b0 alone, b1 and b2 parallel, b3 without data.
    let rows: Vec<Vec<f64>> = (0..6)
        .map(|i| {
            let x = f64::from(i);
            vec![1.0, x, -3.0 * x, 0.0]
        })
        .collect();
    let y = [1.0, 3.1, 4.9, 7.0, 9.1, 10.9];
    let found = fit(&single(&rows, &y), &Options::default()).unwrap();
    let direct: Vec<Vec<f64>> = rows.iter().map(|r| r[..2].to_vec()).collect();
    let direct = fit(&single(&direct, &y), &Options::default()).unwrap();
    assert_eq!(found.coefficients[0].status, Status::Free);
    assert_close(found.coefficients[0].value.unwrap(), direct.coefficients[0].value.unwrap(), 1e-13);
    assert_close(found.coefficients[0].standard.unwrap(), direct.coefficients[0].standard.unwrap(), 1e-13);
    assert_eq!(found.coefficients[3].value, None);
    assert_eq!(found.undetermined.len(), 1);
    assert_eq!(found.undetermined[0].weights.len(), 2);
    assert_close(found.undetermined[0].weights[1].1, -3.0, 1e-12);
    assert_eq!(found.covariance[(3, 3)], 0.0);
    assert_eq!(found.sensitivity()[(1, 0)], 0.0);
}

#[test]
fn three_columns_of_which_one_is_the_sum_give_two_sparse_combinations() {
    let mut rng = rng(8);
    let rows: Vec<Vec<f64>> = (0..10)
        .map(|_| {
            let (a, b) = (normal(&mut rng), normal(&mut rng));
            vec![a, b, a + b]
        })
        .collect();
    let y: Vec<f64> = rows.iter().map(|r| r[0] + 2.0 * r[1] + 3.0 * r[2]).collect();
    let found = fit(&single(&rows, &y), &Options::default()).unwrap();
    // β₀ + β₂ = 4, β₁ + β₂ = 5, β₀ − β₁ = −1: two of the three, each of two terms.
    assert_eq!(found.undetermined.len(), 2);
    for sum in &found.undetermined {
        assert_eq!(sum.weights.len(), 2);
        let truth: f64 = sum.weights.iter().map(|&(j, w)| w * [1.0, 2.0, 3.0][j]).sum();
        assert_close(sum.value, truth, 1e-12);
    }
}

#[test]
fn fewer_rows_than_coefficients_is_no_error() {
    let design = Mat::from_fn(2, 4, |i, j| ((i + 1) * (j + 2)) as f64 + (i * j * j) as f64);
    let fit = fit(&Problem::single(design, vec![1.0, 2.0], names(4)), &Options::default()).unwrap();
    assert_eq!(fit.components[0].rank, 2);
    assert!(fit.residuals.iter().all(|r| r.abs() < 1e-13));
    assert!(fit.components[0].sigma.is_none());
}
