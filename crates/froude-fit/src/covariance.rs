//! Covariance of an estimate: classical, HC3, CR3.
//!
//! With whitened rows `A = Q R`, everything is expressed in the coordinates
//! `Qᵀ b`: row `i` has the vector `q_i`, a score `ψ_i` (its residual, cut for
//! Huber's loss) and a curvature `d_i` (1 for squares). The estimate moves by
//! `M⁻¹ q_i ψ_i` for a row, `M = Σ d_i q_i q_iᵀ` (the identity for squares).
//!
//! | kind      | core                                             | source                        |
//! |-----------|--------------------------------------------------|-------------------------------|
//! | classical | `M⁻¹ (Σ φ q qᵀ) M⁻¹`, φ = σ̂²/σ_whitening²        | Gauss                         |
//! | HC3       | `Σ (M⁻¹ q ψ/(1−h)) (…)ᵀ`                          | MacKinnon & White (1985)      |
//! | CR3       | `(G−1)/G Σ_g Δ_g Δ_gᵀ`, `Δ_g = (M − M_g)⁻¹ Σ_g qψ` | Bell & McCaffrey (2002), CV3 of MacKinnon, Nielsen & Webb (2023) |
//! | Huber, classical | `d` = mean ψ′, φ = K² Σψ²/(n−p)            | Huber (1981), 7.6 (H1)        |
//!
//! `Δ_g` is the change of the estimate when cluster `g` is left out: exact for
//! squares with σ held, one Newton step for Huber. Prior rows are taken at their stated variance.
//! Degrees of freedom of HC3 and CR3 are those of [`freedom`](crate::freedom).

use std::collections::BTreeMap;

use faer::{Mat, MatRef};

use crate::block::Block;
use crate::dense::{Cholesky, dot, row};
use crate::error::FitError;
use crate::estimate::Estimate;
use crate::freedom::{Cluster, Freedom, Row};
use crate::options::{CovarianceKind, Loss};
use crate::problem::Problem;
use crate::robust::psi;

/// Fewest clusters for which a variance over clusters is given that takes their number less one for its degrees of freedom.
pub const FEWEST_CLUSTERS: usize = 5;
/// Fewest for CR3 with degrees of freedom of its own: they are two where clusters are equal.
pub(crate) const FEWEST_WITH_FREEDOM: usize = 3;

/// A part left out determines something alone when a pivot falls below this.
const ALONE: f64 = 1e-10;

/// Covariance of one block in the coordinates `Qᵀ b`.
#[derive(Debug, Clone)]
pub(crate) struct Core {
    /// Covariance, rank × rank; NaN where σ is not known.
    pub covariance: Mat<f64>,
    /// Influence of each data row on the coordinates, `n × rank`: `M⁻¹ q d`.
    pub influence: Mat<f64>,
    /// Where the degrees of freedom of a combination come from.
    pub freedom: Freedom,
    /// `φ` of each component.
    pub dispersion: Vec<Option<f64>>,
}

/// Scores and curvatures of the whitened rows.
struct Rows<'a> {
    /// Q of the whitened design, one row per data row, priors first.
    q: MatRef<'a, f64>,
    score: Vec<f64>,
    curvature: Vec<f64>,
    dispersion: Vec<Option<f64>>,
}

pub(crate) fn core(
    problem: &Problem,
    block: &Block,
    estimate: &Estimate,
    loss: Loss,
    kind: CovarianceKind,
) -> Result<Core, FitError> {
    let rank = estimate.qr.rank;
    let n_priors = estimate.n_priors;
    let rows = rows(block, estimate, loss, kind);
    let mut m = gram(&rows, 0..rows.q.nrows(), rank);
    let bread = Cholesky::new(m.as_ref(), ALONE).map(|c| c.inverse());
    // Too many outliers to hold the curvature: the weights hold it instead.
    let (bread, rows) = if let Some(bread) = bread {
        (bread, rows)
    } else {
        let rows = Rows { curvature: estimate.loss_weight.clone(), ..rows };
        m = gram(&rows, 0..rows.q.nrows(), rank);
        let bread = Cholesky::new(m.as_ref(), 0.0).map_or_else(|| Mat::identity(rank, rank), |c| c.inverse());
        (bread, rows)
    };
    let apply = |q: &[f64]| crate::dense::mul_vec(bread.as_ref(), q);
    let mut covariance = Mat::zeros(rank, rank);
    for i in 0..n_priors {
        add_outer(&mut covariance, &apply(&row(rows.q, i)), 1.0);
    }
    let freedom = match kind {
        CovarianceKind::Classical => {
            for (i, &component) in block.row_component.iter().enumerate() {
                let phi = rows.dispersion[component];
                add_outer(&mut covariance, &apply(&row(rows.q, n_priors + i)), phi.unwrap_or(f64::NAN));
            }
            Freedom::Components
        }
        CovarianceKind::Hc3 => {
            let mut kept = Vec::with_capacity(block.rows.len());
            for i in n_priors..rows.q.nrows() {
                let q = row(rows.q, i);
                let moved = apply(&q);
                let rest = 1.0 - rows.curvature[i] * dot(&q, &moved);
                if rest < ALONE {
                    return Err(FitError::RowDecides { row: block.rows[i - n_priors] });
                }
                let factor = rows.score[i] / rest;
                add_outer(&mut covariance, &moved, factor * factor);
                kept.push(Row { name: block.rows[i - n_priors], q, moved, rest, score: rows.score[i] });
            }
            Freedom::Rows { rows: kept, bread: bread.clone() }
        }
        CovarianceKind::Cr3 => {
            let clusters = clusters(problem, block, FEWEST_WITH_FREEDOM)?;
            let count = clusters.len() as f64;
            let mut kept = Vec::with_capacity(clusters.len());
            for (cluster, members) in clusters {
                let members: Vec<usize> = members.iter().map(|i| i + n_priors).collect();
                let part = gram(&rows, members.iter().copied(), rank);
                let rest = Mat::from_fn(rank, rank, |i, j| m[(i, j)] - part[(i, j)]);
                let factor = Cholesky::new(rest.as_ref(), ALONE)
                    .ok_or_else(|| FitError::ClusterDecides { cluster, component: component_names(problem, block) })?;
                let mut change = vec![0.0; rank];
                for &i in &members {
                    for (k, change) in change.iter_mut().enumerate() {
                        *change += rows.q[(i, k)] * rows.score[i];
                    }
                }
                factor.solve(&mut change);
                add_outer(&mut covariance, &change, (count - 1.0) / count);
                kept.push(Cluster { name: cluster, gram: part, without: factor.inverse(), change });
            }
            Freedom::Clusters { clusters: kept, bread: bread.clone() }
        }
    };
    let n = block.rows.len();
    let mut influence = Mat::zeros(n, rank);
    for i in 0..n {
        let moved = apply(&row(rows.q, n_priors + i));
        for k in 0..rank {
            influence[(i, k)] = moved[k] * rows.curvature[n_priors + i];
        }
    }
    Ok(Core { covariance, influence, freedom, dispersion: rows.dispersion })
}

/// Local rows of each cluster of a block; so many of them at least.
pub(crate) fn clusters(
    problem: &Problem,
    block: &Block,
    needed: usize,
) -> Result<BTreeMap<usize, Vec<usize>>, FitError> {
    let cluster = problem.cluster.as_ref().ok_or(FitError::NoClusters)?;
    let mut out: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, &i) in block.rows.iter().enumerate() {
        out.entry(cluster[i]).or_default().push(k);
    }
    if out.len() < needed {
        return Err(FitError::TooFewClusters { component: component_names(problem, block), found: out.len(), needed });
    }
    Ok(out)
}

pub(crate) fn component_names(problem: &Problem, block: &Block) -> String {
    let names: Vec<&str> = block.components.iter().map(|&c| problem.components[c].as_str()).collect();
    names.join(", ")
}

fn rows<'a>(block: &Block, estimate: &'a Estimate, loss: Loss, kind: CovarianceKind) -> Rows<'a> {
    let n_priors = estimate.n_priors;
    let q = estimate.qr.q.as_ref();
    let plain: Vec<Option<f64>> =
        estimate.sigma.iter().zip(&estimate.whitening).map(|(sigma, w)| sigma.map(|s| (s / w) * (s / w))).collect();
    let Loss::Huber { k } = loss else {
        return Rows {
            q,
            score: estimate.residual.clone(),
            curvature: vec![1.0; estimate.residual.len()],
            dispersion: plain,
        };
    };
    let score: Vec<f64> =
        estimate.residual.iter().enumerate().map(|(i, &r)| if i < n_priors { r } else { psi(r, k) }).collect();
    let mut curvature: Vec<f64> =
        estimate.residual.iter().enumerate().map(|(i, r)| f64::from(u8::from(i < n_priors || r.abs() <= k))).collect();
    let mut dispersion = plain;
    if kind == CovarianceKind::Classical {
        let n = block.n_rows_of();
        for c in 0..n.len() {
            let members: Vec<usize> =
                (0..block.rows.len()).filter(|&i| block.row_component[i] == c).map(|i| n_priors + i).collect();
            let count = n[c] as f64;
            let mean = members.iter().map(|&i| curvature[i]).sum::<f64>() / count;
            let sum: f64 = members.iter().map(|&i| score[i] * score[i]).sum();
            let rank = count - estimate.dof[c];
            let correction = 1.0 + rank / count * (1.0 - mean) / mean.max(f64::MIN_POSITIVE);
            if dispersion[c].is_some() && mean > 0.0 {
                dispersion[c] = Some(correction * correction * sum / estimate.dof[c]);
                for i in members {
                    curvature[i] = mean;
                }
            }
        }
    }
    Rows { q, score, curvature, dispersion }
}

fn gram(rows: &Rows<'_>, members: impl IntoIterator<Item = usize>, rank: usize) -> Mat<f64> {
    let mut out = Mat::zeros(rank, rank);
    for i in members {
        add_outer(&mut out, &row(rows.q, i), rows.curvature[i]);
    }
    out
}

fn add_outer(to: &mut Mat<f64>, x: &[f64], factor: f64) {
    for j in 0..x.len() {
        let scaled = factor * x[j];
        for i in 0..x.len() {
            to[(i, j)] += x[i] * scaled;
        }
    }
}
