//! Least squares under linear inequalities.
//!
//! `clarabel`'s interior-point method finds which constraints hold; the
//! minimiser on them is then found again by QR in their null space, so that the
//! accuracy is that of the factorisation and not of an interior-point
//! tolerance. If the set was wrong, constraints with a negative multiplier are
//! dropped and violated ones added until the optimality conditions hold.
//!
//! The quadratic is given to the solver as `½‖t‖²` with `R γ − t = Qᵀb`, which
//! keeps the condition number of the design; `AᵀA` would square it.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use faer::{Mat, MatRef};

use crate::dense::{dot, mul, mul_vec, norm, tr_mul_vec};
use crate::error::FitError;
use crate::rank::PivotedQr;
use crate::report::{End, Report};

/// Constraints of unit length may be broken by this part of `‖x‖ + |h|`.
const FEASIBILITY: f64 = 1e-11;
/// Multipliers may be negative by this part of `‖b‖`.
const MULTIPLIER: f64 = 1e-11;
/// What the dual's solution may break a constraint by, relative to the coefficients.
const FEASIBLE_DUAL: f64 = 1e-9;
/// Active constraints of unit length contradict each other beyond this, relative.
const CONTRADICTION: f64 = 1e-9;
/// Keeps the interior-point solver bounded in directions no data determine.
const RIDGE: f64 = 1e-9;

/// A constraint `row · x ≤ value`.
pub(crate) type Inequality = (Vec<f64>, f64);

/// The result of a constrained fit.
#[derive(Debug, Clone)]
pub(crate) struct Constrained {
    pub x: Vec<f64>,
    /// Constraints that hold with equality.
    pub active: Vec<usize>,
    /// Largest violation of the optimality conditions, relative.
    pub kkt: f64,
    pub report: Report,
}

/// `min ‖A x − b‖` with `row · x ≤ value` for each constraint.
pub(crate) fn constrained(a: MatRef<'_, f64>, b: &[f64], constraints: &[Inequality]) -> Result<Constrained, FitError> {
    let qr = PivotedQr::new(a);
    let free = qr.solve(b);
    if constraints.iter().all(|c| excess(c, &free) <= 0.0) {
        return Ok(Constrained {
            x: free,
            active: Vec::new(),
            kkt: 0.0,
            report: Report { end: End::Converged, iterations: 0 },
        });
    }
    // Rows of zeros hold or they do not.
    if constraints.iter().any(|(row, value)| row.iter().all(|&r| r == 0.0) && *value < 0.0) {
        return Err(FitError::Infeasible);
    }
    let (start, guess, iterations) = interior(&qr, b, constraints)?;
    match polish(a, b, constraints, start.clone(), guess) {
        Some((x, active, kkt)) => {
            Ok(Constrained { x, active, kkt, report: Report { end: End::Converged, iterations } })
        }
        // Nearly parallel constraints can leave the interior-point solver short of digits and make the exchange
        // of active constraints go in circles; the dual by non-negative least squares does not.
        None => least_distance(&qr, &free, constraints).map_or_else(
            || {
                Ok(Constrained {
                    active: (0..constraints.len()).filter(|&k| excess(&constraints[k], &start) > -1e-7).collect(),
                    x: start,
                    kkt: 1e-7,
                    report: Report { end: End::Stalled, iterations },
                })
            },
            Ok,
        ),
    }
}

fn excess((row, value): &Inequality, x: &[f64]) -> f64 {
    dot(row, x) - value
}

/// Interior-point solution, the constraints that seem to hold, and the steps.
fn interior(qr: &PivotedQr, b: &[f64], constraints: &[Inequality]) -> Result<(Vec<f64>, Vec<usize>, usize), FitError> {
    let n = qr.n_columns();
    let r = qr.rank;
    let m = constraints.len();
    let target = tr_mul_vec(qr.q.as_ref(), b);
    let size = constraints.iter().map(|c| c.1.abs()).fold(norm(&target), f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    let ridge = if r < n { RIDGE } else { 0.0 };
    let quadratic: Vec<Vec<f64>> = (0..n + r)
        .map(|i| {
            let mut row = vec![0.0; n + r];
            row[i] = if i < n { ridge } else { 1.0 };
            row
        })
        .collect();
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(r + m);
    for i in 0..r {
        let mut row = vec![0.0; n + r];
        for (k, &j) in qr.order.iter().enumerate() {
            row[j] = qr.r[(i, k)];
        }
        row[n + i] = -1.0;
        rows.push(row);
    }
    for (row, _) in constraints {
        let mut full = row.clone();
        full.resize(n + r, 0.0);
        rows.push(full);
    }
    let right: Vec<f64> = target.iter().chain(constraints.iter().map(|c| &c.1)).map(|value| value / size).collect();
    let failed = |reason: String| {
        FitError::Refused(format!("the constrained fit did not end: {reason}; rescale or drop a constraint"))
    };
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .max_threads(1)
        .tol_gap_abs(1e-10)
        .tol_gap_rel(1e-10)
        .tol_feas(1e-10)
        .build()
        .map_err(|e| failed(e.to_string()))?;
    let mut solver = DefaultSolver::new(
        &sparse(n + r, &quadratic),
        &vec![0.0; n + r],
        &sparse(n + r, &rows),
        &right,
        &[ZeroConeT(r), NonnegativeConeT(m)],
        settings,
    )
    .map_err(|e| failed(e.to_string()))?;
    solver.solve();
    let solution = &solver.solution;
    match solution.status {
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
            return Err(FitError::Infeasible);
        }
        SolverStatus::Solved
        | SolverStatus::AlmostSolved
        | SolverStatus::MaxIterations
        | SolverStatus::InsufficientProgress => {}
        other => return Err(failed(format!("{other:?}"))),
    }
    let x = solution.x[..n].iter().map(|v| v * size).collect();
    let guess = (0..m).filter(|&k| solution.z[r + k] > solution.s[r + k]).collect();
    Ok((x, guess, solution.iterations as usize))
}

fn sparse(n_columns: usize, rows: &[Vec<f64>]) -> CscMatrix<f64> {
    let mut starts = vec![0];
    let mut index = Vec::new();
    let mut value = Vec::new();
    for j in 0..n_columns {
        for (i, row) in rows.iter().enumerate() {
            if row[j] != 0.0 {
                index.push(i);
                value.push(row[j]);
            }
        }
        starts.push(index.len());
    }
    CscMatrix::new(rows.len(), n_columns, starts, index, value)
}

/// The exact minimiser near `start`, with the constraints that hold.
fn polish(
    a: MatRef<'_, f64>,
    b: &[f64],
    constraints: &[Inequality],
    start: Vec<f64>,
    mut active: Vec<usize>,
) -> Option<(Vec<f64>, Vec<usize>, f64)> {
    let size = norm(b);
    let mut x = start;
    for _ in 0..50 + 4 * constraints.len() {
        x = on_active(a, b, constraints, &active, &x)?;
        let residual: Vec<f64> = mul_vec(a, &x).iter().zip(b).map(|(f, y)| f - y).collect();
        let gradient = tr_mul_vec(a, &residual);
        // Multipliers: gradient + Σ λ_k row_k = 0.
        let rows = Mat::from_fn(x.len(), active.len(), |i, k| constraints[active[k]].0[i]);
        let minus: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let multiplier = PivotedQr::new(rows.as_ref()).solve(&minus);
        let lowest = multiplier.iter().enumerate().min_by(|x, y| x.1.total_cmp(y.1)).map(|(k, &value)| (k, value));
        if let Some((k, value)) = lowest
            && value < -MULTIPLIER * size
        {
            active.remove(k);
            continue;
        }
        let allowance = |value: f64| FEASIBILITY * (norm(&x) + value.abs());
        let worst = (0..constraints.len())
            .filter(|k| !active.contains(k))
            .map(|k| (k, excess(&constraints[k], &x) - allowance(constraints[k].1)))
            .max_by(|x, y| x.1.total_cmp(&y.1));
        if let Some((k, value)) = worst
            && value > 0.0
        {
            active.push(k);
            active.sort_unstable();
            continue;
        }
        let balance = mul_vec(rows.as_ref(), &multiplier);
        let rest = gradient.iter().zip(balance).map(|(g, s)| (g + s).abs()).fold(0.0, f64::max);
        let kkt = if size > 0.0 { rest / size } else { rest };
        return Some((x, active, kkt));
    }
    None
}

/// The same minimiser as the point of a polyhedron nearest to the origin, through non-negative least squares.
///
/// With `z = R (x − x₀)`, `x₀` unconstrained, the problem is `min ‖z‖` under `G z ≥ h`. Its dual is
/// `min ‖E u − f‖, u ≥ 0` with `E = [Gᵀ; hᵀ]`, `f = (0, …, 0, 1)`; from the residual `ρ`, `z_j = −ρ_j/ρ_last`.
/// `None` when the design does not determine `x`, or the result breaks a constraint.
///
/// # Source
///
/// Lawson & Hanson (1974), *Solving Least Squares Problems*, 23.4 (LDP).
fn least_distance(qr: &PivotedQr, free: &[f64], constraints: &[Inequality]) -> Option<Constrained> {
    let (n, m) = (qr.n_columns(), constraints.len());
    if qr.rank < n {
        return None;
    }
    let broken = constraints.iter().map(|c| excess(c, free).abs()).fold(0.0, f64::max);
    if broken == 0.0 {
        return None;
    }
    // Row k of G is −(row · R⁻¹), by forward substitution on Rᵀ in pivoted order.
    let mut e = Mat::<f64>::zeros(n + 1, m);
    for (k, constraint) in constraints.iter().enumerate() {
        for i in 0..n {
            let mut value = constraint.0[qr.order[i]];
            for l in 0..i {
                value += e[(l, k)] * qr.r[(l, i)];
            }
            e[(i, k)] = -value / qr.r[(i, i)];
        }
        e[(n, k)] = excess(constraint, free) / broken;
    }
    // G and h are brought to the same size, whatever the unit of the design.
    let steep = (0..m).map(|k| (0..n).map(|i| e[(i, k)].powi(2)).sum::<f64>().sqrt()).fold(0.0, f64::max);
    if steep == 0.0 || !steep.is_finite() {
        return None;
    }
    for k in 0..m {
        for i in 0..n {
            e[(i, k)] /= steep;
        }
    }
    let mut target = vec![0.0; n + 1];
    target[n] = 1.0;
    let dual = crate::bounded::bounded_least_squares(e.as_ref(), &target, &vec![0.0; m], &vec![f64::INFINITY; m]);
    let rest: Vec<f64> = mul_vec(e.as_ref(), &dual.x).iter().zip(&target).map(|(x, y)| x - y).collect();
    if rest[n] == 0.0 {
        return None;
    }
    let z: Vec<f64> = rest[..n].iter().map(|r| -broken / steep * r / rest[n]).collect();
    let mut x = free.to_vec();
    let mut step = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|l| qr.r[(i, l)] * step[l]).sum();
        step[i] = (z[i] - known) / qr.r[(i, i)];
        x[qr.order[i]] += step[i];
    }
    let size = norm(&x);
    let worst = constraints.iter().map(|c| excess(c, &x) - FEASIBLE_DUAL * (size + c.1.abs())).fold(f64::MIN, f64::max);
    (worst <= 0.0 && dual.report.end == End::Converged).then(|| Constrained {
        active: (0..m).filter(|&k| dual.x[k] > 0.0).collect(),
        kkt: dual.kkt,
        x,
        report: dual.report,
    })
}

/// `min ‖A x − b‖` with the active constraints as equalities, near `x`.
fn on_active(
    a: MatRef<'_, f64>,
    b: &[f64],
    constraints: &[Inequality],
    active: &[usize],
    x: &[f64],
) -> Option<Vec<f64>> {
    // `{step : C step = d} = {offset + Z γ}`.
    let of = |k: usize| &constraints[active[k]];
    let transposed = Mat::from_fn(x.len(), active.len(), |j, k| of(k).0[j]);
    let qr = PivotedQr::with_full_q(transposed.as_ref());
    let mut u: Vec<f64> = qr.order[..qr.rank].iter().map(|&k| -excess(of(k), x)).collect();
    qr.forward_substitute(&mut u);
    let offset = mul_vec(qr.q.get(.., ..qr.rank), &u);
    let is_met = |k: usize| {
        let rest = -excess(of(k), x);
        (dot(&of(k).0, &offset) - rest).abs() <= CONTRADICTION * (rest.abs() + norm(&offset))
    };
    if !(0..active.len()).all(is_met) {
        return None;
    }
    let basis = qr.q.get(.., qr.rank..);
    let reduced = mul(a, basis);
    let base: Vec<f64> = x.iter().zip(&offset).map(|(x, o)| x + o).collect();
    let residual: Vec<f64> = mul_vec(a, &base).iter().zip(b).map(|(f, y)| y - f).collect();
    let step = mul_vec(basis, &PivotedQr::new(reduced.as_ref()).solve(&residual));
    Some(base.iter().zip(step).map(|(x, s)| x + s).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dual_finds_the_corner_that_can_be_drawn() {
        // min (2 x₁ − 2)² + (x₂ − 1)² under x₁ + x₂ ≤ 1, x₁ − x₂ ≤ 0.2: by hand 2·2(2x₁−2) = 2(x₂−1) on the first
        // line alone gives x₁ = 4/5 + …; the corner x₁ = 0.6, x₂ = 0.4 is where both hold.
        let a = Mat::from_fn(2, 2, |i, j| if i == j { 2.0 - i as f64 } else { 0.0 });
        let b = [2.0, 1.0];
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let constraints = [(vec![half, half], half), (vec![half, -half], 0.2 * half)];
        let qr = PivotedQr::new(a.as_ref());
        let free = qr.solve(&b);
        let one = least_distance(&qr, &free, &constraints[..1]).unwrap();
        // Lagrange: 8(x₁ − 1) = 2(x₂ − 1), x₁ + x₂ = 1 → x₁ = 0.8, x₂ = 0.2.
        assert!((one.x[0] - 0.8).abs() < 1e-12 && (one.x[1] - 0.2).abs() < 1e-12, "{:?}", one.x);
        let two = least_distance(&qr, &free, &constraints).unwrap();
        assert!((two.x[0] - 0.6).abs() < 1e-12 && (two.x[1] - 0.4).abs() < 1e-12, "{:?}", two.x);
        assert_eq!(two.active, [0, 1]);
    }
}
