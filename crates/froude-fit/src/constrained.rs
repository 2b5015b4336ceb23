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

use crate::block::eliminate;
use crate::dense::{dot, mul, mul_vec, norm, tr_mul_vec};
use crate::error::FitError;
use crate::rank::PivotedQr;
use crate::report::{End, Report};

/// Constraints of unit length may be broken by this part of `‖x‖ + |h|`.
const FEASIBILITY: f64 = 1e-11;
/// Multipliers may be negative by this part of `‖b‖`.
const MULTIPLIER: f64 = 1e-11;
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
        None => Ok(Constrained {
            active: (0..constraints.len()).filter(|&k| excess(&constraints[k], &start) > -1e-7).collect(),
            x: start,
            kkt: 1e-7,
            report: Report { end: End::Stalled, iterations },
        }),
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
    let failed = |reason: String| FitError::Solver { reason };
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

/// `min ‖A x − b‖` with the active constraints as equalities, near `x`.
fn on_active(
    a: MatRef<'_, f64>,
    b: &[f64],
    constraints: &[Inequality],
    active: &[usize],
    x: &[f64],
) -> Option<Vec<f64>> {
    let equalities: Vec<Inequality> = active
        .iter()
        .map(|&k| {
            let rest = -excess(&constraints[k], x);
            (constraints[k].0.clone(), rest)
        })
        .collect();
    let (offset, basis) = eliminate(x.len(), &equalities).ok()?;
    let reduced = mul(a, basis.as_ref());
    let base: Vec<f64> = x.iter().zip(&offset).map(|(x, o)| x + o).collect();
    let residual: Vec<f64> = mul_vec(a, &base).iter().zip(b).map(|(f, y)| y - f).collect();
    let step = mul_vec(basis.as_ref(), &PivotedQr::new(reduced.as_ref()).solve(&residual));
    Some(base.iter().zip(step).map(|(x, s)| x + s).collect())
}
