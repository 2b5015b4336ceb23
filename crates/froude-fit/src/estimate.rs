//! The unconstrained estimate of one block, with σ of its components.
//!
//! Rows are whitened by σ of their component and the columns are
//! factored once more each time σ changes. Where one component stands alone
//! without a prior, σ does not matter and one factorisation does. Else σ is
//! iterated to the fixed point
//!
//! `σ_c² = Σ w r² / (n_c − tr H_c)`,
//!
//! with `H` the hat matrix of the whitened rows, priors included: the
//! restricted maximum likelihood equation of Patterson & Thompson (1971) for a
//! diagonal covariance.

use faer::Mat;

use crate::block::Block;
use crate::dense::{mul_vec, norm, row};
use crate::rank::PivotedQr;
use crate::report::{End, Report};

/// σ has converged when it changes by less than this part.
const SIGMA_TOLERANCE: f64 = 1e-11;
/// Most iterations of σ.
const SIGMA_ITERATIONS: usize = 500;
/// σ used as a weight never falls below this part of the rms response: a
/// component without noise would otherwise weigh infinitely.
const SIGMA_FLOOR: f64 = 1e-8;
/// Degrees of freedom below this are none.
const NO_DOF: f64 = 1e-6;

/// An unconstrained estimate, in whitened coordinates.
///
/// Prior rows come first, then the rows of the block.
#[derive(Debug, Clone)]
pub(crate) struct Estimate {
    /// Whitened design.
    pub design: Mat<f64>,
    /// Whitened right-hand side.
    pub response: Vec<f64>,
    /// Number of prior rows.
    pub n_priors: usize,
    /// Its factorisation.
    pub qr: PivotedQr,
    /// Scaled coefficients.
    pub gamma: Vec<f64>,
    /// Whitened residuals.
    pub residual: Vec<f64>,
    /// σ that each component was whitened with.
    pub whitening: Vec<f64>,
    /// Estimated σ of each component; `None` without degrees of freedom.
    pub sigma: Vec<Option<f64>>,
    /// Degrees of freedom of each component.
    pub dof: Vec<f64>,
    /// How the iteration ended.
    pub report: Report,
}

/// Whitens the block and factors it.
struct Whitened {
    design: Mat<f64>,
    response: Vec<f64>,
}

fn whiten(block: &Block, sigma: &[f64]) -> Whitened {
    let q = block.columns.len();
    let n_priors = block.priors.len();
    let n = block.rows.len();
    let mut design = Mat::zeros(n_priors + n, q);
    let mut response = Vec::with_capacity(n_priors + n);
    for (k, (entries, value)) in block.priors.iter().enumerate() {
        for (column, x) in entries {
            design[(k, *column)] += x;
        }
        response.push(*value);
    }
    for i in 0..n {
        let s = sigma[block.row_component[i]];
        for l in 0..q {
            design[(n_priors + i, l)] = block.design[(i, l)] / s;
        }
        response.push(block.response[i] / s);
    }
    Whitened { design, response }
}

fn residual(whitened: &Whitened, gamma: &[f64]) -> Vec<f64> {
    mul_vec(whitened.design.as_ref(), gamma).iter().zip(&whitened.response).map(|(fitted, y)| y - fitted).collect()
}

/// `n_c − tr H_c` of each component.
fn degrees_of_freedom(block: &Block, qr: &PivotedQr) -> Vec<f64> {
    let n_priors = block.priors.len();
    if block.components.len() == 1 && n_priors == 0 {
        return vec![block.n_rows_of()[0].saturating_sub(qr.rank) as f64];
    }
    let mut dof: Vec<f64> = block.n_rows_of().iter().map(|&n| n as f64).collect();
    for (i, &c) in block.row_component.iter().enumerate() {
        let q = row(qr.q.as_ref(), n_priors + i);
        dof[c] -= q.iter().map(|x| x * x).sum::<f64>();
    }
    dof.iter().map(|&d| if d < NO_DOF { 0.0 } else { d }).collect()
}

/// Sum of squared residuals of each component, in units of the response.
fn squares_of(block: &Block, residual: &[f64], whitening: &[f64]) -> Vec<f64> {
    let mut rss = vec![0.0; block.components.len()];
    for (&c, r) in block.row_component.iter().zip(&residual[block.priors.len()..]) {
        let r = r * whitening[c];
        rss[c] += r * r;
    }
    rss
}

/// Smallest σ to weigh each component with.
fn floors(block: &Block) -> Vec<f64> {
    let n = block.n_rows_of();
    let mut sum = vec![0.0; n.len()];
    for (&c, y) in block.row_component.iter().zip(&block.response) {
        sum[c] += y * y;
    }
    sum.iter()
        .zip(n)
        .map(|(s, n)| match SIGMA_FLOOR * (s / n as f64).sqrt() {
            0.0 => 1.0,
            floor => floor,
        })
        .collect()
}

/// σ of each component fitted by itself.
fn separate_sigmas(block: &Block, floor: &[f64]) -> Vec<f64> {
    let n_rows = block.n_rows_of();
    (0..block.components.len())
        .map(|c| {
            let rows: Vec<usize> = (0..block.rows.len()).filter(|&i| block.row_component[i] == c).collect();
            let part = Mat::from_fn(rows.len(), block.design.ncols(), |i, j| block.design[(rows[i], j)]);
            let y: Vec<f64> = rows.iter().map(|&i| block.response[i]).collect();
            let qr = PivotedQr::new(part.as_ref());
            let fitted = mul_vec(part.as_ref(), &qr.solve(&y));
            let rss: f64 = y.iter().zip(fitted).map(|(y, f)| (y - f) * (y - f)).sum();
            let n = n_rows[c];
            let sigma = if n > qr.rank { (rss / (n - qr.rank) as f64).sqrt() } else { norm(&y) / (n as f64).sqrt() };
            sigma.max(floor[c])
        })
        .collect()
}

pub(crate) fn estimate(block: &Block) -> Estimate {
    let needs_sigma = block.components.len() > 1 || !block.priors.is_empty();
    let floor = floors(block);
    let mut whitening = if needs_sigma { separate_sigmas(block, &floor) } else { vec![1.0] };
    let mut iterations = 0;
    loop {
        iterations += 1;
        let whitened = whiten(block, &whitening);
        let qr = PivotedQr::new(whitened.design.as_ref());
        let gamma = qr.solve(&whitened.response);
        let residual = residual(&whitened, &gamma);
        let dof = degrees_of_freedom(block, &qr);
        let sigma: Vec<Option<f64>> = squares_of(block, &residual, &whitening)
            .iter()
            .zip(&dof)
            .map(|(rss, &dof)| (dof > 0.0).then(|| (rss / dof).sqrt()))
            .collect();
        let next: Vec<f64> = sigma
            .iter()
            .zip(&whitening)
            .zip(&floor)
            .map(|((sigma, &old), floor)| sigma.map_or(old, |s| s.max(*floor)))
            .collect();
        let change = next.iter().zip(&whitening).map(|(new, old)| (new / old - 1.0).abs()).fold(0.0, f64::max);
        let is_done = !needs_sigma || change < SIGMA_TOLERANCE;
        if is_done || iterations == SIGMA_ITERATIONS {
            return Estimate {
                design: whitened.design,
                response: whitened.response,
                n_priors: block.priors.len(),
                qr,
                gamma,
                residual,
                whitening,
                sigma,
                dof,
                report: Report { end: if is_done { End::Converged } else { End::IterationLimit }, iterations },
            };
        }
        whitening = next;
    }
}
