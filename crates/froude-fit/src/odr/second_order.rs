//! What the linearised model misses, to the next order in the errors.
//!
//! **Bias.** A quadratic in an uncertain speed does not average to the
//! quadratic of the average. Seen as nonlinear least squares in `θ = (β, δ)`
//! with Jacobian `J`, the minimiser has, to second order in the errors, the bias
//!
//! `−½ (JᵀJ)⁻¹ Jᵀ d`, `d_k = tr((JᵀJ)⁻¹ H_k)`, `H_k` the Hessian of residual row `k`'s model.
//!
//! With `δ` eliminated this is the fit of `−½ d` to the design, in the metric `V`.
//!
//! **Excess of information.** The regressors are taken at the estimated inputs,
//! whose errors `ζ` (covariance `A = S² − S²FᵀV⁻¹FS²`) are independent of the
//! residuals: `H = X̂ᵀV⁻¹X̂` exceeds the true information by
//! `T = Σ A_ab (∂_a X)ᵀV⁻¹(∂_b X)`, while the scores do have variance `H`. Hence the
//! covariance `(H − T)⁻¹ H (H − T)⁻¹ ≈ H⁻¹ + 2 H⁻¹ T H⁻¹`; for a straight line it is
//! Fuller's.
//!
//! **Source.** Box (1971), J. R. Statist. Soc. B 33, equation 2.9 (bias); Fuller (1987),
//! *Measurement Error Models*, 1.3 (straight line), carried over to several inputs and components here.

use faer::Mat;

use super::model::{InputModel, OdrProblem};
use super::solve::State;
use crate::dense::{dot, mul_vec, row, tr_mul_vec};
use crate::odr::whitened::{Linear, Whitened, backward, forward};

/// Step of the second derivatives, as part of the input or its scale.
const STEP: f64 = 3e-4;

/// Bias of the coefficients, and the excess `T` of their information.
pub(super) struct SecondOrder {
    pub bias: Vec<f64>,
    pub excess: Mat<f64>,
}

/// Both, with `covariance` the first-order one of `β`.
pub(super) fn second_order<M: InputModel>(
    model: &M,
    problem: &OdrProblem,
    state: &State,
    linear: &Linear,
    rows: &Whitened,
    covariance: &Mat<f64>,
) -> SecondOrder {
    let (n, c, p, m) = (linear.n, linear.c, linear.p, linear.m);
    let mut shift = vec![0.0; n * c];
    let mut excess = Mat::zeros(p, p);
    let mut slope = vec![0.0; m * c * p];
    for i in 0..n {
        let spread: Vec<f64> = (0..m).map(|a| problem.input_standard[(i, a)]).collect();
        if spread.iter().all(|&s| s == 0.0) {
            continue;
        }
        let inputs: Vec<f64> =
            row(problem.inputs.as_ref(), i).iter().zip(row(state.delta.as_ref(), i)).map(|(z, d)| z + d).collect();
        model.derivatives(i, &inputs, &mut slope);
        let l = &rows.factor[i * c * c..(i + 1) * c * c];
        // G = S² Fᵀ V⁻¹, m × c, by columns of V⁻¹ F S².
        let mut gain = vec![0.0; m * c];
        for a in 0..m {
            let mut column: Vec<f64> = (0..c).map(|k| linear.slope[(i * c + k) * m + a] * spread[a].powi(2)).collect();
            forward(l, c, &mut column);
            backward(l, c, &mut column);
            gain[a * c..(a + 1) * c].copy_from_slice(&column);
        }
        // G X, m × p; Cov(β, δ) = −C (G X)ᵀ.
        let through: Vec<Vec<f64>> = (0..m)
            .map(|a| {
                (0..p).map(|j| (0..c).map(|k| gain[a * c + k] * linear.design[(i * c + k) * p + j]).sum()).collect()
            })
            .collect();
        let joint: Vec<Vec<f64>> = through.iter().map(|g| mul_vec(covariance.as_ref(), g)).collect();
        for k in 0..c {
            let mut d = 0.0;
            for a in 0..m {
                let start = (a * c + k) * p;
                d -= 2.0 * dot(&joint[a], &slope[start..start + p]);
            }
            shift[i * c + k] = d;
        }
        // Whitened ∂_a X, `m × p` vectors of length `c`.
        let mut whitened = vec![0.0; m * p * c];
        for a in 0..m {
            for j in 0..p {
                let column = &mut whitened[(a * p + j) * c..(a * p + j + 1) * c];
                for (k, column) in column.iter_mut().enumerate() {
                    *column = slope[(a * c + k) * p + j];
                }
                forward(l, c, column);
            }
        }
        for b in (0..m).filter(|&b| spread[b] > 0.0) {
            let curvature = curvature(model, i, &inputs, b, &state.beta, [c, p, m]);
            for a in 0..m {
                // A = S² − G F S²; Cov(δ) = A + G X C Xᵀ Gᵀ.
                let mut own = if a == b { spread[a].powi(2) } else { 0.0 };
                for k in 0..c {
                    own -= gain[a * c + k] * linear.slope[(i * c + k) * m + b] * spread[b].powi(2);
                }
                for j in 0..p {
                    let x = &whitened[(a * p + j) * c..(a * p + j + 1) * c];
                    for q in 0..p {
                        let y = &whitened[(b * p + q) * c..(b * p + q + 1) * c];
                        excess[(j, q)] += own * dot(x, y);
                    }
                }
                let covariance = own + dot(&joint[a], &through[b]);
                for k in 0..c {
                    shift[i * c + k] += covariance * curvature[a * c + k];
                }
            }
        }
        forward(l, c, &mut shift[i * c..(i + 1) * c]);
    }
    let projected = tr_mul_vec(rows.design.as_ref(), &shift);
    SecondOrder { bias: mul_vec(covariance.as_ref(), &projected).iter().map(|b| -0.5 * b).collect(), excess }
}

/// `∂²(x_k β)/∂z_a∂z_b` for all `a`, `k`: `m × c`.
fn curvature<M: InputModel>(
    model: &M,
    i: usize,
    inputs: &[f64],
    b: usize,
    beta: &[f64],
    [c, p, m]: [usize; 3],
) -> Vec<f64> {
    let step = STEP * inputs[b].abs().max(model.input_scale(b));
    let mut moved = inputs.to_vec();
    let mut upper = vec![0.0; m * c * p];
    let mut lower = vec![0.0; m * c * p];
    moved[b] = inputs[b] + step;
    let high = moved[b];
    model.derivatives(i, &moved, &mut upper);
    moved[b] = inputs[b] - step;
    let low = moved[b];
    model.derivatives(i, &moved, &mut lower);
    (0..m * c)
        .map(|block| {
            let range = block * p..(block + 1) * p;
            (dot(&upper[range.clone()], beta) - dot(&lower[range], beta)) / (high - low)
        })
        .collect()
}
