//! Degrees of freedom of the robust variances HC3 and CR3.
//!
//! Either variance of a combination `aᵀγ` of the coordinates is a quadratic form of the rows' errors, `V = eᵀ B e`. Where these are equal and
//! independent its mean is `tr B` and its variance `2 tr B²`, and it is nearest to a multiple of χ² of
//!
//! `ν = (tr B)²/tr B²`
//!
//! degrees of freedom. With `M = Σ q qᵀ` over all rows, priors included:
//!
//! `tr B = Σ_g d_g − u_gᵀM⁻¹u_g`, `tr B² = Σ_g d_g² − 2 d_g u_gᵀM⁻¹u_g + tr (T M⁻¹)²`, `T = Σ_g u_g u_gᵀ`
//!
//! | kind | part g | `u_g` | `d_g` |
//! |------|--------|-------|-------|
//! | HC3  | a row | `m_i q_i`, `m_i = aᵀM⁻¹q_i/(1 − h_i)` | `m_i²` |
//! | CR3  | a cluster, `K_g = Σ q qᵀ` | `K_g w_g`, `w_g = (M − K_g)⁻¹a` | `w_gᵀu_g` |
//!
//! One row of high leverage, or one large cluster among small ones, tells `V` nearly alone, and `ν` falls to 1. Stated variances of priors count as known.
//!
//! # Source
//!
//! Bell & McCaffrey (2002), Survey Methodology 28, 169; Imbens & Kolesár (2016), Rev. Econ. Stat. 98, 701 (the same for HC); equal and independent errors as the working
//! covariance in both.

use faer::Mat;

use crate::dense::{dot, mul, mul_vec};

/// A row as HC3 sees it.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    /// Its number in the problem.
    pub name: usize,
    /// Its vector.
    pub q: Vec<f64>,
    /// `M⁻¹q`.
    pub moved: Vec<f64>,
    /// `1 − h`.
    pub rest: f64,
    /// Its residual.
    pub score: f64,
}

/// A cluster as CR3 sees it.
#[derive(Debug, Clone)]
pub(crate) struct Cluster {
    /// Its number in the problem.
    pub name: usize,
    /// `K_g`.
    pub gram: Mat<f64>,
    /// `(M − K_g)⁻¹`.
    pub without: Mat<f64>,
    /// `Δ_g`.
    pub change: Vec<f64>,
}

/// Where the degrees of freedom of a combination come from.
#[derive(Debug, Clone)]
pub(crate) enum Freedom {
    /// From σ of each component.
    Components,
    /// From squares of residuals.
    Rows { rows: Vec<Row>, bread: Mat<f64> },
    /// From changes of the estimate.
    Clusters { clusters: Vec<Cluster>, bread: Mat<f64> },
}

/// Degrees of freedom of a robust variance, and what tells most of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Robust {
    /// ν.
    pub dof: f64,
    /// The part of the total variance that the scatter makes; the rest is that of priors.
    pub scatter: f64,
    /// The row or cluster that tells most of it, and how much \[-\].
    pub most: Option<(usize, f64)>,
}

impl Freedom {
    /// Of the combination `a`; `None` where the components tell it.
    pub(crate) fn of(&self, a: &[f64]) -> Option<Robust> {
        match self {
            Self::Components => None,
            Self::Rows { rows, bread } => {
                let part = |row: &Row| {
                    let m = dot(a, &row.moved) / row.rest;
                    let u = row.q.iter().map(|q| m * q).collect();
                    Part { name: row.name, d: m * m, u, square: (m * row.score).powi(2) }
                };
                Some(robust(rows.iter().map(part), bread))
            }
            Self::Clusters { clusters, bread } => {
                let count = clusters.len() as f64;
                let part = |cluster: &Cluster| {
                    let w = mul_vec(cluster.without.as_ref(), a);
                    let u = mul_vec(cluster.gram.as_ref(), &w);
                    let square = (count - 1.0) / count * dot(a, &cluster.change).powi(2);
                    Part { name: cluster.name, d: dot(&w, &u), u, square }
                };
                Some(robust(clusters.iter().map(part), bread))
            }
        }
    }
}

/// What a row or a cluster gives to the variance of a combination.
struct Part {
    name: usize,
    /// `m_gᵀm_g`.
    d: f64,
    /// `Q_gᵀm_g`.
    u: Vec<f64>,
    /// Its term of the variance, `(m_gᵀr_g)²`.
    square: f64,
}

/// The form `Σ_g (m_gᵀr_g)²` of residuals `r = (1 − Q M⁻¹Qᵀ) e`, summed up: `tr B`, `tr B²` and T.
fn robust(parts: impl Iterator<Item = Part>, bread: &Mat<f64>) -> Robust {
    let (mut trace, mut square, mut scatter) = (0.0, 0.0, 0.0);
    let mut shared = Mat::<f64>::zeros(bread.nrows(), bread.ncols());
    let mut most: Option<(usize, f64)> = None;
    for part in parts {
        let Part { d, u, .. } = &part;
        let taken = dot(u, &mul_vec(bread.as_ref(), u));
        let own = d - taken;
        trace += own;
        square += d * d - 2.0 * d * taken;
        for j in 0..u.len() {
            for i in 0..u.len() {
                shared[(i, j)] += u[j] * u[i];
            }
        }
        scatter += part.square;
        if most.is_none_or(|(_, largest)| own > largest) {
            most = Some((part.name, own));
        }
    }
    let p = mul(shared.as_ref(), bread.as_ref());
    let of_shared: f64 = (0..p.nrows()).map(|i| (0..p.ncols()).map(|j| p[(i, j)] * p[(j, i)]).sum::<f64>()).sum();
    let dof = trace * trace / (square + of_shared);
    Robust { dof, scatter, most: most.map(|(name, own)| (name, own / trace)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CovarianceKind, Options, Problem, fit};

    fn problem(x: &[f64], cluster: Option<Vec<usize>>) -> Problem {
        let n = x.len();
        let design = Mat::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { x[i] });
        let response = (0..n).map(|i| 1.0 + 0.3 * x[i] + 0.1 * ((i * i) as f64).sin()).collect();
        Problem { cluster, ..Problem::single(design, response, vec!["a".into(), "b".into()]) }
    }

    fn dof(problem: &Problem, covariance: CovarianceKind) -> Vec<f64> {
        let fit = fit(problem, &Options { covariance, ..Options::default() }).unwrap();
        fit.coefficients.iter().map(|c| c.dof.unwrap()).collect()
    }

    /// (tr B)²/tr B² of the form written out over all rows.
    fn written_out(x: &[f64], cluster: &[usize], j: usize) -> f64 {
        let n = x.len();
        let row = |i: usize| [1.0, x[i]];
        let inverse = |keep: &dyn Fn(usize) -> bool| {
            let m: [f64; 3] =
                (0..n).filter(|i| keep(*i)).fold([0.0; 3], |m, i| [m[0] + 1.0, m[1] + x[i], m[2] + x[i] * x[i]]);
            let d = m[0] * m[2] - m[1] * m[1];
            [[m[2] / d, -m[1] / d], [-m[1] / d, m[0] / d]]
        };
        let apply = |a: [[f64; 2]; 2], i: usize| [0, 1].map(|k| a[k][0] * row(i)[0] + a[k][1] * row(i)[1]);
        let all = inverse(&|_| true);
        let rest = Mat::from_fn(n, n, |i, k| {
            let a = apply(all, k);
            f64::from(u8::from(i == k)) - row(i)[0] * a[0] - row(i)[1] * a[1]
        });
        let groups = cluster.iter().max().unwrap() + 1;
        let mut b = Mat::<f64>::zeros(n, n);
        for g in 0..groups {
            let without = inverse(&|i| cluster[i] != g);
            let m: Vec<f64> = (0..n).map(|i| if cluster[i] == g { apply(without, i)[j] } else { 0.0 }).collect();
            let v = mul_vec(rest.as_ref(), &m);
            for i in 0..n {
                for k in 0..n {
                    b[(i, k)] += v[i] * v[k];
                }
            }
        }
        let trace: f64 = (0..n).map(|i| b[(i, i)]).sum();
        let square: f64 = (0..n).map(|i| (0..n).map(|k| b[(i, k)] * b[(k, i)]).sum::<f64>()).sum();
        trace * trace / square
    }

    #[test]
    fn the_sums_are_those_of_the_form_written_out() {
        let x = [0.1, 0.4, 0.5, 0.9, 1.0, 1.1, 1.2, 1.9, 2.0, 6.0];
        let rows: Vec<usize> = (0..10).collect();
        let clusters = vec![0, 0, 0, 0, 0, 1, 1, 2, 3, 3];
        let (hc3, cr3) = (
            dof(&problem(&x, None), CovarianceKind::Hc3),
            dof(&problem(&x, Some(clusters.clone())), CovarianceKind::Cr3),
        );
        for j in 0..2 {
            assert!((hc3[j] / written_out(&x, &rows, j) - 1.0).abs() < 1e-9, "{hc3:?}");
            assert!((cr3[j] / written_out(&x, &clusters, j) - 1.0).abs() < 1e-9, "{cr3:?}");
        }
    }

    /// Imbens & Kolesár (2016), section 3: of a mean over equal clusters CR3 has one less than there are.
    #[test]
    fn equal_clusters_have_one_less_than_there_are() {
        let design = Mat::from_fn(24, 1, |_, _| 1.0);
        let response = (0..24).map(|i| f64::from(i * i).sin()).collect();
        let of = |count: usize| Problem {
            cluster: Some((0..24).map(|i| i % count).collect()),
            ..Problem::single(design.clone(), Clone::clone(&response), vec!["a".into()])
        };
        for count in [3, 4, 8] {
            assert!((dof(&of(count), CovarianceKind::Cr3)[0] - (count as f64 - 1.0)).abs() < 1e-9);
        }
        let by_row = Problem::single(design.clone(), Clone::clone(&response), vec!["a".into()]);
        assert!((dof(&by_row, CovarianceKind::Hc3)[0] - 23.0).abs() < 1e-9);
    }

    #[test]
    fn one_large_cluster_is_named() {
        let x: Vec<f64> = (0..60).map(|i| 0.1 * f64::from(i % 12)).collect();
        let cluster: Vec<usize> = (0..60).map(|i| if i < 40 { 0 } else { 1 + (i - 40) / 4 }).collect();
        let fit = fit(&problem(&x, Some(cluster)), &Options { covariance: CovarianceKind::Cr3, ..Options::default() })
            .unwrap();
        let (name, part) = fit.coefficients[1].most.unwrap();
        assert_eq!(name, 0);
        assert!(part > 0.5 && fit.coefficients[1].dof.unwrap() < 4.0, "{part}");
    }
}
