//! Covariance of an estimate: classical, HC3, CR3.
//!
//! With whitened rows `A = Q R`, everything is expressed in the coordinates
//! `Qᵀ b`: row `i` has the vector `q_i` and the residual `r_i`. The estimate moves by
//! `M⁻¹ q_i r_i` for a row, `M = Σ q_i q_iᵀ`, which is the identity but for rounding.
//!
//! | kind      | core                                             | source                        |
//! |-----------|--------------------------------------------------|-------------------------------|
//! | classical | `M⁻¹ (Σ φ q qᵀ) M⁻¹`, φ = σ̂²/σ_whitening²        | Gauss                         |
//! | HC3       | `Σ (M⁻¹ q r/(1−h)) (…)ᵀ`                          | MacKinnon & White (1985)      |
//! | CR3       | `(G−1)/G Σ_g Δ_g Δ_gᵀ`, `Δ_g = (M − M_g)⁻¹ Σ_g qr` | Bell & McCaffrey (2002), CV3 of MacKinnon, Nielsen & Webb (2023) |
//!
//! `Δ_g` is the change of the estimate when cluster `g` is left out, exact with σ held. Prior rows are taken at their stated variance.
//! Degrees of freedom of HC3 and CR3 are those of [`freedom`](crate::freedom).

use std::collections::BTreeMap;

use faer::{Mat, MatRef};

use crate::block::Block;
use crate::dense::{Cholesky, dot, row};
use crate::error::FitError;
use crate::estimate::Estimate;
use crate::freedom::{Cluster, Freedom, Row};
use crate::options::CovarianceKind;
use crate::problem::Problem;

/// Fewest clusters for which a variance over clusters is given that takes their number less one for its degrees of freedom.
pub const FEWEST_CLUSTERS: usize = 5;
/// Fewest for CR3 with degrees of freedom of its own: they are two where clusters are equal.
const FEWEST_WITH_FREEDOM: usize = 3;

/// A part left out determines something alone when a pivot falls below this.
const ALONE: f64 = 1e-10;

/// Covariance of one block in the coordinates `Qᵀ b`.
#[derive(Debug, Clone)]
pub(crate) struct Core {
    /// Covariance, rank × rank; NaN where σ is not known.
    pub covariance: Mat<f64>,
    /// Influence of each data row on the coordinates, `n × rank`: `M⁻¹ q`.
    pub influence: Mat<f64>,
    /// Where the degrees of freedom of a combination come from.
    pub freedom: Freedom,
    /// `φ` of each component.
    pub dispersion: Vec<Option<f64>>,
}

pub(crate) fn core(
    problem: &Problem,
    block: &Block,
    estimate: &Estimate,
    kind: CovarianceKind,
) -> Result<Core, FitError> {
    let (rank, n_priors) = (estimate.qr.rank, estimate.n_priors);
    // Q of the whitened design, one row per data row, priors first.
    let (q, residual) = (estimate.qr.q.as_ref(), &estimate.residual);
    let dispersion: Vec<Option<f64>> =
        estimate.sigma.iter().zip(&estimate.whitening).map(|(sigma, w)| sigma.map(|s| (s / w) * (s / w))).collect();
    let m = gram(q, 0..q.nrows());
    let bread = Cholesky::new(m.as_ref(), ALONE).map_or_else(|| Mat::identity(rank, rank), |c| c.inverse());
    let apply = |q: &[f64]| crate::dense::mul_vec(bread.as_ref(), q);
    let mut covariance = Mat::zeros(rank, rank);
    for i in 0..n_priors {
        add_outer(&mut covariance, &apply(&row(q, i)), 1.0);
    }
    let freedom = match kind {
        CovarianceKind::Classical => {
            for (i, &component) in block.row_component.iter().enumerate() {
                let phi = dispersion[component];
                add_outer(&mut covariance, &apply(&row(q, n_priors + i)), phi.unwrap_or(f64::NAN));
            }
            Freedom::Components
        }
        CovarianceKind::Hc3 => {
            let mut kept = Vec::with_capacity(block.rows.len());
            for i in n_priors..q.nrows() {
                let own = row(q, i);
                let moved = apply(&own);
                let rest = 1.0 - dot(&own, &moved);
                if rest < ALONE {
                    let row = block.rows[i - n_priors];
                    return Err(FitError::Refused(format!(
                        "row {row} alone determines a coefficient (leverage 1); HC3 needs every one determined by the other rows"
                    )));
                }
                let factor = residual[i] / rest;
                add_outer(&mut covariance, &moved, factor * factor);
                kept.push(Row { name: block.rows[i - n_priors], q: own, moved, rest, score: residual[i] });
            }
            Freedom::Rows { rows: kept, bread: bread.clone() }
        }
        CovarianceKind::Cr3 => {
            let clusters = clusters(problem, block)?;
            let count = clusters.len() as f64;
            let mut kept = Vec::with_capacity(clusters.len());
            for (cluster, members) in clusters {
                let members: Vec<usize> = members.iter().map(|i| i + n_priors).collect();
                let part = gram(q, members.iter().copied());
                let rest = Mat::from_fn(rank, rank, |i, j| m[(i, j)] - part[(i, j)]);
                let factor = Cholesky::new(rest.as_ref(), ALONE)
                    .ok_or_else(|| FitError::ClusterDecides { cluster, component: component_names(problem, block) })?;
                let mut change = vec![0.0; rank];
                for &i in &members {
                    for (k, change) in change.iter_mut().enumerate() {
                        *change += q[(i, k)] * residual[i];
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
        let moved = apply(&row(q, n_priors + i));
        for k in 0..rank {
            influence[(i, k)] = moved[k];
        }
    }
    Ok(Core { covariance, influence, freedom, dispersion })
}

/// Local rows of each cluster of a block; three clusters at least.
fn clusters(problem: &Problem, block: &Block) -> Result<BTreeMap<usize, Vec<usize>>, FitError> {
    let cluster = problem.cluster.as_ref().ok_or(FitError::NoClusters)?;
    let mut out: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, &i) in block.rows.iter().enumerate() {
        out.entry(cluster[i]).or_default().push(k);
    }
    if out.len() < FEWEST_WITH_FREEDOM {
        return Err(FitError::Refused(format!(
            "component {:?} has {} {}; cluster-robust covariance (CR3) is refused below {FEWEST_WITH_FREEDOM}, where its interval is unreliable",
            component_names(problem, block),
            out.len(),
            if out.len() == 1 { "cluster" } else { "clusters" }
        )));
    }
    Ok(out)
}

fn component_names(problem: &Problem, block: &Block) -> String {
    let names: Vec<&str> = block.components.iter().map(|&c| problem.components[c].as_str()).collect();
    names.join(", ")
}

fn gram(q: MatRef<'_, f64>, members: impl IntoIterator<Item = usize>) -> Mat<f64> {
    let mut out = Mat::zeros(q.ncols(), q.ncols());
    for i in members {
        add_outer(&mut out, &row(q, i), 1.0);
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
