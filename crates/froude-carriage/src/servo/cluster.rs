//! Covariance of a least-squares fit whose rows belong together in clusters: runs of a campaign, stretches of a record.
//!
//! Rows of a cluster may be correlated in any way, clusters are independent. Fitted residuals are smaller than errors, the more so the
//! more a cluster has to say. Each cluster's are enlarged by `(I − H_gg)^{−1/2}`, which makes the variance right on average where
//! errors are white within a cluster (CR2), or by `(I − H_gg)^{−1}`, which is what leaving the cluster out does to the coefficients: the
//! jackknife, right or a little wide where the rows of a cluster err alike (CR3). The degrees of freedom are those of the quadratic form that the variance is, coefficient by
//! coefficient: one that two clusters decide has hardly more than one, however many clusters there are.
//!
//! With `A = (XᵀX + P)⁻¹ = LLᵀ` (`P` the information of a prior) and the cluster's Gram matrix `X_gᵀX_g`, everything is p × p: the
//! cluster moves the coefficients by `L (I − S_g)^{−1/2} Lᵀ X_gᵀ e_g` (or `−1`), `S_g = Lᵀ X_gᵀX_g L`.
//!
//! # Source
//!
//! Bell & McCaffrey (2002), Survey Methodology 28, 169: the estimate and the degrees of freedom; Pustejovsky & Tipton (2018),
//! J. Bus. Econ. Stat. 36, 672. The p × p form is ours.

use froude_fit::faer::{Mat, Side};

use crate::servo::error::ServoError;

/// Part of a direction that a cluster may know alone, less than 1; beyond, its residuals say nothing about its errors.
const ALONE: f64 = 1.0 - 1e-9;

/// How residuals are enlarged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Enlarged {
    /// CR2: errors are nearly white within a cluster.
    Average,
    /// CR3: the rows of a cluster err alike.
    Jackknife,
}

/// Covariance over clusters, and what its degrees of freedom follow from.
#[derive(Debug, Clone)]
pub(crate) struct Clustered {
    /// Covariance of the coefficients.
    pub covariance: Mat<f64>,
    root: Mat<f64>,
    parts: Vec<Part>,
    how: Enlarged,
}

/// One cluster in the coordinates of `Lᵀ`.
#[derive(Debug, Clone)]
struct Part {
    gram: Mat<f64>,
    enlarged: Mat<f64>,
    /// Sum of its rows.
    sum: Mat<f64>,
}

impl Clustered {
    /// From columns and residuals whose rows `from..to` of each range are a cluster; `prior` is the information besides.
    ///
    /// # Errors
    ///
    /// [`ServoError::Alone`] when one cluster alone decides something; [`ServoError::Fit`] for dependent columns.
    pub fn new(
        columns: &[Vec<f64>],
        residuals: &[f64],
        clusters: &[std::ops::Range<usize>],
        prior: Option<&Mat<f64>>,
        how: Enlarged,
    ) -> Result<Self, ServoError> {
        let p = columns.len();
        let size: Vec<f64> = columns.iter().map(|c| c.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
        let size: Vec<f64> = size.iter().map(|s| if *s > 0.0 { *s } else { 1.0 }).collect();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let grams: Vec<Mat<f64>> = clusters
            .iter()
            .map(|r| {
                let of = |i: usize| &columns[i][r.clone()];
                Mat::from_fn(p, p, |i, j| product(of(i), of(j)) / (size[i] * size[j]))
            })
            .collect();
        let total = Mat::from_fn(p, p, |i, j| {
            let more = prior.map_or(0.0, |m| m[(i, j)] / (size[i] * size[j]));
            grams.iter().map(|g| g[(i, j)]).sum::<f64>() + more
        });
        let root = inverse_root(&total)?;
        let mut moved = Vec::new();
        let mut parts = Vec::new();
        for (g, range) in clusters.iter().enumerate() {
            let gram = root.transpose() * &grams[g] * &root;
            let enlarged = enlarged(&gram, how).ok_or(ServoError::Alone { cluster: g })?;
            let score =
                Mat::from_fn(p, 1, |i, _| product(&columns[i][range.clone()], &residuals[range.clone()]) / size[i]);
            moved.push(&root * (&enlarged * (root.transpose() * score)));
            let sum = Mat::from_fn(p, 1, |i, _| columns[i][range.clone()].iter().sum::<f64>() / size[i]);
            parts.push(Part { gram, enlarged, sum: root.transpose() * sum });
        }
        let covariance =
            Mat::from_fn(p, p, |i, j| moved.iter().map(|m| m[(i, 0)] * m[(j, 0)]).sum::<f64>() / (size[i] * size[j]));
        let root = Mat::from_fn(p, p, |i, j| root[(i, j)] / size[i]);
        Ok(Self { covariance, root, parts, how })
    }

    /// Degrees of freedom of the variance of `Σ gradient · coefficient`, for errors as [`Enlarged`] takes them.
    pub fn dof(&self, gradient: &[f64]) -> f64 {
        let p = gradient.len();
        let along = self.root.transpose() * Mat::from_fn(p, 1, |i, _| gradient[i]);
        let a: Vec<Mat<f64>> = self.parts.iter().map(|q| &q.enlarged * &along).collect();
        let seen: Vec<Mat<f64>> = self.parts.iter().zip(&a).map(|(q, a)| &q.gram * a).collect();
        let dot = |x: &Mat<f64>, y: &Mat<f64>| (0..p).map(|i| x[(i, 0)] * y[(i, 0)]).sum::<f64>();
        let n = a.len();
        let entry: Box<dyn Fn(usize, usize) -> f64> = match self.how {
            Enlarged::Average => Box::new(|i, j| {
                let own = if i == j { dot(&a[i], &seen[i]) } else { 0.0 };
                own - dot(&seen[i], &seen[j])
            }),
            Enlarged::Jackknife => {
                // What an error common to the rows of cluster k does to the term of cluster i.
                let felt = Mat::from_fn(n, n, |k, i| {
                    let own = if i == k { dot(&self.parts[i].sum, &a[i]) } else { 0.0 };
                    own - dot(&self.parts[k].sum, &seen[i])
                });
                Box::new(move |i, j| (0..n).map(|k| felt[(k, i)] * felt[(k, j)]).sum())
            }
        };
        let trace: f64 = (0..n).map(|i| entry(i, i)).sum();
        let squares: f64 = (0..n).map(|i| (0..n).map(|j| entry(i, j).powi(2)).sum::<f64>()).sum();
        trace * trace / squares
    }
}

/// Stretches of `rows`, as many of `length` or longer as fit side by side.
pub(crate) fn stretches(rows: usize, length: usize) -> Vec<std::ops::Range<usize>> {
    let count = (rows / length.max(1)).max(1);
    (0..count).map(|i| i * rows / count..(i + 1) * rows / count).collect()
}

/// `L` of `LLᵀ = total⁻¹`.
fn inverse_root(total: &Mat<f64>) -> Result<Mat<f64>, ServoError> {
    let p = total.nrows();
    let eigen = total.self_adjoint_eigen(Side::Lower).map_err(|_| ServoError::Dependent)?;
    let (u, s) = (eigen.U(), eigen.S());
    let least = 1e-14 * (0..p).map(|k| s[k]).fold(0.0, f64::max);
    if (0..p).any(|k| s[k] <= least) {
        return Err(ServoError::Dependent);
    }
    Ok(Mat::from_fn(p, p, |i, k| u[(i, k)] / s[k].sqrt()))
}

/// `(I − S)^{−1/2}` or `(I − S)^{−1}`; `None` where an eigenvalue of S reaches 1.
fn enlarged(gram: &Mat<f64>, how: Enlarged) -> Option<Mat<f64>> {
    let p = gram.nrows();
    let eigen = gram.self_adjoint_eigen(Side::Lower).ok()?;
    let (u, s) = (eigen.U(), eigen.S());
    if (0..p).any(|k| s[k] > ALONE) {
        return None;
    }
    let divisor = |s: f64| match how {
        Enlarged::Average => (1.0 - s).sqrt(),
        Enlarged::Jackknife => 1.0 - s,
    };
    Some(Mat::from_fn(p, p, |i, j| (0..p).map(|k| u[(i, k)] * u[(j, k)] / divisor(s[k])).sum::<f64>()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    /// A mean of n rows, each a cluster: CR2 is s²/n, with n − 1 degrees of freedom.
    #[test]
    fn the_mean_of_single_rows_has_the_textbook_variance_and_degrees_of_freedom() {
        let values: [f64; 5] = [1.0, 3.0, 2.0, 7.0, 4.0];
        let mean = values.iter().sum::<f64>() / 5.0;
        let residuals: Vec<f64> = values.iter().map(|v| v - mean).collect();
        let variance = residuals.iter().map(|r| r * r).sum::<f64>() / 4.0;
        let clusters: Vec<_> = (0..5).map(|i| i..i + 1).collect();
        let c = Clustered::new(&[vec![1.0; 5]], &residuals, &clusters, None, Enlarged::Average).unwrap();
        // A few roundings.
        assert!((c.covariance[(0, 0)] - variance / 5.0).abs() < 1e-14);
        assert!((c.dof(&[1.0]) - 4.0).abs() < 1e-12);
    }

    /// White errors, clusters of very different leverage: the mean of the variances is the variance.
    #[test]
    fn the_variance_is_right_on_average_whatever_the_leverage() {
        let n = 60;
        let x: Vec<f64> = (0..n).map(|i| if i < 5 { 10.0 } else { f64::from(i % 7) - 3.0 }).collect();
        let columns = vec![vec![1.0; 60], x];
        let clusters: Vec<_> = (0..12).map(|g| 5 * g..5 * g + 5).collect();
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let draws = 4000;
        let (mut stated, mut truth) = (0.0, 0.0);
        for _ in 0..draws {
            let y: Vec<f64> = (0..n).map(|_| StandardNormal.sample(&mut rng)).collect();
            let s = crate::servo::regression::solve(&columns, &y).unwrap();
            let residuals: Vec<f64> =
                (0..60).map(|i| y[i] - s.coefficients[0] - s.coefficients[1] * columns[1][i]).collect();
            stated +=
                Clustered::new(&columns, &residuals, &clusters, None, Enlarged::Average).unwrap().covariance[(1, 1)];
            truth += s.coefficients[1].powi(2);
        }
        // A mean square of 4000 normal draws scatters by √(2/4000) = 2.2 %; a variance of some two degrees of freedom by no more. Four.
        assert!((stated / truth - 1.0).abs() < 0.12, "{}", stated / truth);
    }

    #[test]
    fn a_cluster_that_alone_decides_a_coefficient_is_refused_by_number() {
        let columns = vec![vec![1.0; 6], vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0]];
        let clusters = [0..2, 2..4, 4..6];
        let error = Clustered::new(&columns, &[0.1; 6], &clusters, None, Enlarged::Average).unwrap_err();
        assert_eq!(error, ServoError::Alone { cluster: 2 });
    }

    #[test]
    fn stretches_lie_side_by_side_and_leave_nothing() {
        assert_eq!(stretches(10, 3), vec![0..3, 3..6, 6..10]);
        assert_eq!(stretches(2, 3), vec![0..2]);
    }
}
