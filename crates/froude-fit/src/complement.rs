//! What further columns would add to a problem.

use faer::Mat;

use crate::dense::{dot, norm};
use crate::options::Options;
use crate::problem::Problem;

/// A unit column whose remainder after projection is shorter than this is dependent.
const DEPENDENT: f64 = 1e-6;

/// Independent directions that `columns` have beside the free columns of a problem, in the metric of its weights.
///
/// Rows × directions, each of length 1 times √w and orthogonal to the others and to the design; added to the design they span what `columns` would. `None` where nothing is new.
///
/// # Source
///
/// Golub & Van Loan (2013), *Matrix Computations*, 4th ed., 5.2.8 (modified Gram–Schmidt), twice (Kahan: Parlett, 1980, *The Symmetric Eigenvalue Problem*, 6.9).
#[must_use]
pub fn complement(problem: &Problem, options: &Options, columns: &Mat<f64>) -> Option<Mat<f64>> {
    let n = problem.n_rows();
    let is_held = |j: &usize| options.excluded.contains(j) || options.fixed.iter().any(|(k, _)| k == j);
    let root: Vec<f64> = (0..n).map(|i| problem.weight_of(i).sqrt()).collect();
    let weighted = |from: &Mat<f64>, j: usize| -> Vec<f64> { (0..n).map(|i| from[(i, j)] * root[i]).collect() };
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for j in (0..problem.n_coefficients()).filter(|j| !is_held(j)) {
        basis.extend(cleared(weighted(&problem.design, j), &basis));
    }
    let own = basis.len();
    for j in 0..columns.ncols() {
        basis.extend(cleared(weighted(columns, j), &basis));
    }
    let new = basis.split_off(own);
    (!new.is_empty()).then(|| Mat::from_fn(n, new.len(), |i, k| if root[i] > 0.0 { new[k][i] / root[i] } else { 0.0 }))
}

/// What a column has beside an orthonormal basis, of length 1; `None` where that is rounding.
fn cleared(mut column: Vec<f64>, basis: &[Vec<f64>]) -> Option<Vec<f64>> {
    let length = norm(&column);
    if length == 0.0 {
        return None;
    }
    column = column.iter().map(|x| x / length).collect();
    for q in basis.iter().chain(basis) {
        let along = dot(q, &column);
        column.iter_mut().zip(q).for_each(|(x, q)| *x -= along * q);
    }
    let left = norm(&column);
    (left > DEPENDENT).then(|| column.iter().map(|x| x / left).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beside 1 and x, the columns x, x² and x² + x bring one direction: the quadratic that is orthogonal to both by the weights.
    #[test]
    fn only_what_is_new_comes_back_orthogonal_by_the_weights() {
        let x = [-1.0, 0.0, 1.0, 2.0, 4.0];
        let design = Mat::from_fn(5, 2, |i, j| if j == 0 { 1.0 } else { x[i] });
        let names = vec!["a".to_owned(), "b".to_owned()];
        let weight = vec![1.0, 2.0, 1.0, 0.5, 3.0];
        let problem = Problem { weight: Some(weight.clone()), ..Problem::single(design.clone(), vec![0.0; 5], names) };
        let columns = Mat::from_fn(5, 3, |i, j| [x[i], x[i] * x[i], x[i] * x[i] + x[i]][j]);
        let options = Options::default();
        let found = complement(&problem, &options, &columns).unwrap();
        assert_eq!(found.ncols(), 1);
        for j in 0..2 {
            let product: f64 = (0..5).map(|i| weight[i] * found[(i, 0)] * design[(i, j)]).sum();
            assert!(product.abs() < 1e-14, "{product}");
        }
        let length: f64 = (0..5).map(|i| weight[i] * found[(i, 0)].powi(2)).sum();
        assert!((length - 1.0).abs() < 1e-14);
        // A column that is held is no part of what is fitted: it is new.
        let held = Options { fixed: vec![(1, 3.0)], ..Options::default() };
        assert_eq!(complement(&problem, &held, &columns).unwrap().ncols(), 2);
        assert!(complement(&problem, &options, &design).is_none());
    }
}
