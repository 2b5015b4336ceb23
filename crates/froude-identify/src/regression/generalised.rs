//! Generalised least squares: errors that rows of a run or a setup share are declared, and rows that share them count together.
//!
//! With Ω = diag(σ_c²/w) + Σ D Dᵀ, D the declared errors of one entry by group, the coefficients are β = S y with S = (XᵀΩ⁻¹X)⁻¹XᵀΩ⁻¹: rows are whitened by the Cholesky
//! factor of Ω and fitted as independent ones. σ_c of each load is that of the rows alone, by restricted maximum likelihood,
//!
//! yᵀP D_c P y = tr P D_c,  P = Ω⁻¹ − Ω⁻¹X(XᵀΩ⁻¹X)⁻¹XᵀΩ⁻¹,  D_c = diag 1/w on the rows of c,
//!
//! with ν_c = σ_c⁴ tr P D_c P D_c degrees of freedom. Least squares alone take the declared errors for scatter and add them a second time: their intervals hold 97.5 % and are twice
//! as wide. An error of the whole campaign changes no weight: it is added as before. Relative errors are those of the fitted loads: those of the measured ones would weigh the
//! small more (Peelle).
//!
//! # Source
//!
//! Aitken (1935), Proc. R. Soc. Edinb. 55, 42; Patterson & Thompson (1971), Biometrika 58, 545; Giesbrecht & Burns (1985), Biometrics 41, 477 (degrees of freedom).

use froude_fit as fit;
use froude_fit::faer::linalg::solvers::DenseSolveCore;
use froude_fit::faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use froude_fit::faer::{Mat, MatRef};
use froude_fit::faer::{Par, Side};
use froude_records::campaign::{BudgetEntry, Shared, SourceKind};

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::regression::settings::{Scatter, Settings};
use crate::uncertainty::{Linearised, direction, groups};

/// Rows of all loads together up to which it is done: matrices over all of them are kept.
const MOST_ROWS: usize = 600;
/// Steps for σ, and the change at which they end.
const STEPS: usize = 60;
const CONVERGED: f64 = 1e-5;
/// σ² falls to this part of what least squares give at most: the declared errors explain all scatter then.
const LEAST: f64 = 1e-6;

/// Fits again with the declared errors of runs and setups as a covariance; the whitened problem, where there are such.
///
/// # Errors
///
/// A quantity that is no channel of the observations; what the fit refuses.
pub(crate) fn generalised(
    law: &ForceLaw,
    data: &Dataset,
    settings: Settings<'_>,
    (problem, options): (&fit::Problem, &fit::Options),
    fitted: &mut fit::Fit,
) -> Result<Option<Whitened>, IdentifyError> {
    let is_meant = settings.kind != SourceKind::Cfd
        && matches!(settings.scatter, Scatter::Classical | Scatter::Runs)
        && settings.condensed.is_none()
        && !law.is_nonlinear()
        && options.priors.is_empty()
        && options.fixed.is_empty()
        && options.excluded.is_empty()
        && problem.n_rows() <= MOST_ROWS
        && problem.n_coefficients() == law.coefficients.len();
    let sigma: Option<Vec<f64>> = fitted.components.iter().map(|c| c.sigma.filter(|s| *s > 0.0)).collect();
    let (true, Some(mut sigma)) = (is_meant, sigma) else { return Ok(None) };
    let shared = declared(law, data, settings.budget, fitted)?;
    if shared.is_empty() {
        return Ok(None);
    }
    let floor: Vec<f64> = sigma.iter().map(|s| LEAST.sqrt() * s).collect();
    let mut solved = Solved::at(problem, &shared, &sigma);
    for _ in 0..STEPS {
        let Some(now) = &solved else { return Ok(None) };
        let next: Vec<f64> =
            (0..sigma.len()).map(|c| (sigma[c] * now.ratio(problem, c).sqrt()).max(floor[c])).collect();
        let change = next.iter().zip(&sigma).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        sigma = next;
        solved = Solved::at(problem, &shared, &sigma);
        if change < CONVERGED {
            break;
        }
    }
    let Some(solved) = solved else { return Ok(None) };
    let whitened = solved.whitened(problem);
    let Ok(found) = fit::fit(&whitened, options) else { return Ok(None) };
    solved.replace(fitted, found, problem, &sigma);
    Ok(Some(Whitened { problem: whitened, root: solved.root }))
}

/// Whether errors of runs or setups are declared, and all rows share each of them.
pub(crate) fn has_one_group(data: &Dataset, budget: &[BudgetEntry]) -> bool {
    let of_groups = || budget.iter().filter(|entry| matches!(entry.shared, Shared::Run | Shared::Setup));
    of_groups().next().is_some() && of_groups().all(|entry| groups(data, entry.shared).iter().all(|g| *g == 0))
}

/// The error of each row by each group of each entry that runs or setups share: columns over all rows.
fn declared(
    law: &ForceLaw,
    data: &Dataset,
    budget: &[BudgetEntry],
    fitted: &fit::Fit,
) -> Result<Vec<Vec<f64>>, IdentifyError> {
    let coefficients: Vec<f64> = fitted.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect();
    let at = Linearised { law, data, coefficients: &coefficients, sensitivity: fitted.sensitivity() };
    let n = data.rows;
    let mut out = Vec::new();
    for entry in budget.iter().filter(|entry| matches!(entry.shared, Shared::Run | Shared::Setup)) {
        let group = groups(data, entry.shared);
        let count = group.iter().max().map_or(0, |g| g + 1);
        if count == n {
            continue;
        }
        let mut errors = direction(at, entry)?;
        if let (true, Some(r)) = (entry.relative, law.responses.iter().position(|l| *l == entry.quantity)) {
            for i in r * n..(r + 1) * n {
                errors[i] = entry.standard * fitted.fitted[i];
            }
        }
        for g in 0..count {
            let column: Vec<f64> =
                errors.iter().enumerate().map(|(row, e)| if group[row % n] == g { *e } else { 0.0 }).collect();
            if column.iter().any(|e| *e != 0.0) {
                out.push(column);
            }
        }
    }
    Ok(out)
}

/// A problem whose rows are independent and of one size: L⁻¹X and L⁻¹y, with L the Cholesky factor of Ω.
#[derive(Debug, Clone)]
pub struct Whitened {
    /// The problem.
    pub problem: fit::Problem,
    root: Mat<f64>,
}

impl Whitened {
    /// Further columns of the same rows, L⁻¹Z.
    pub(crate) fn whiten(&self, columns: &mut Mat<f64>) {
        solve_lower_triangular_in_place(self.root.as_ref(), columns.as_mut(), Par::Seq);
    }

    /// (∂β/∂y)ᵀ for the original rows, from ∂β/∂y for the whitened rows.
    pub(crate) fn of_rows(&self, sensitivity: MatRef<'_, f64>) -> Mat<f64> {
        of_rows(&self.root, sensitivity)
    }
}

/// Sᵀ for S = S_w L⁻¹, by solving Lᵀ Sᵀ = S_wᵀ.
fn of_rows(root: &Mat<f64>, sensitivity: MatRef<'_, f64>) -> Mat<f64> {
    let mut transposed = sensitivity.transpose().to_owned();
    solve_upper_triangular_in_place(root.transpose(), transposed.as_mut(), Par::Seq);
    transposed
}

fn is_observed(problem: &fit::Problem, i: usize) -> bool {
    problem.weight.as_ref().is_none_or(|w| w[i] > 0.0)
}

/// Weight of a row; 1 where it is no observation, whose line of the design is zero.
fn weight(problem: &fit::Problem, i: usize) -> f64 {
    problem.weight.as_ref().map_or(1.0, |w| if w[i] > 0.0 { w[i] } else { 1.0 })
}

/// Ω factored, and what follows from it.
struct Solved {
    /// Cholesky factor of Ω.
    root: Mat<f64>,
    /// P.
    p: Mat<f64>,
    /// P y.
    py: Vec<f64>,
}

impl Solved {
    fn at(problem: &fit::Problem, shared: &[Vec<f64>], sigma: &[f64]) -> Option<Self> {
        let n = problem.n_rows();
        let mut omega = Mat::<f64>::zeros(n, n);
        for i in 0..n {
            omega[(i, i)] = sigma[problem.component[i]].powi(2) / weight(problem, i);
        }
        for column in shared {
            let there: Vec<usize> = (0..n).filter(|&i| column[i] != 0.0 && is_observed(problem, i)).collect();
            for &i in &there {
                for &j in &there {
                    omega[(i, j)] += column[i] * column[j];
                }
            }
        }
        let factor = omega.llt(Side::Lower).ok()?;
        let inverse = factor.inverse();
        let x = &problem.design;
        let weighted = &inverse * x;
        let gram = x.transpose() * &weighted;
        let inner = gram.llt(Side::Lower).ok()?.inverse();
        let p = &inverse - &weighted * inner * weighted.transpose();
        let py = (0..n).map(|i| (0..n).map(|j| p[(i, j)] * problem.response[j]).sum()).collect();
        Some(Self { root: factor.L().to_owned(), p, py })
    }

    /// yᵀP D_c P y over tr P D_c.
    fn ratio(&self, problem: &fit::Problem, c: usize) -> f64 {
        let rows = problem.rows_of(c);
        let found: f64 = rows.iter().map(|&i| self.py[i].powi(2) / weight(problem, i)).sum();
        let expected: f64 = rows.iter().map(|&i| self.p[(i, i)] / weight(problem, i)).sum();
        if expected > 0.0 { found / expected } else { 1.0 }
    }

    /// σ⁴ tr P D P D of a load.
    fn dof(&self, problem: &fit::Problem, c: usize, sigma: f64) -> f64 {
        let rows = problem.rows_of(c);
        let weight = |i: usize| weight(problem, i);
        let of = |i: usize| rows.iter().map(|&j| self.p[(i, j)].powi(2) / (weight(i) * weight(j))).sum::<f64>();
        sigma.powi(4) * rows.iter().map(|&i| of(i)).sum::<f64>()
    }

    /// L⁻¹X and L⁻¹y.
    fn whitened(&self, problem: &fit::Problem) -> fit::Problem {
        let n = problem.n_rows();
        let mut response = Mat::from_fn(n, 1, |i, _| problem.response[i]);
        let mut design = problem.design.clone();
        let lower = self.root.as_ref();
        solve_lower_triangular_in_place(lower, design.as_mut(), Par::Seq);
        solve_lower_triangular_in_place(lower, response.as_mut(), Par::Seq);
        let observed = (0..n).map(|i| f64::from(u8::from(is_observed(problem, i))));
        let weight = problem.weight.as_ref().filter(|w| w.contains(&0.0)).map(|_| observed.collect());
        fit::Problem { design, response: (0..n).map(|i| response[(i, 0)]).collect(), weight, ..problem.clone() }
    }

    /// The fit of the whitened rows in place of that by least squares, with σ of the rows alone.
    fn replace(&self, fitted: &mut fit::Fit, found: fit::Fit, problem: &fit::Problem, sigma: &[f64]) {
        let (n, p) = (problem.n_rows(), problem.n_coefficients());
        let by_row = of_rows(&self.root, found.sensitivity());
        let s = by_row.transpose();
        let variance: Vec<f64> = (0..n).map(|i| sigma[problem.component[i]].powi(2) / weight(problem, i)).collect();
        let covariance = Mat::from_fn(p, p, |a, b| (0..n).map(|i| s[(a, i)] * s[(b, i)] * variance[i]).sum::<f64>());
        let of_load: Vec<f64> = (0..sigma.len()).map(|c| self.dof(problem, c, sigma[c])).collect();
        let value: Vec<f64> = found.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect();
        for (j, (own, of)) in fitted.coefficients.iter_mut().zip(&found.coefficients).enumerate() {
            own.clone_from(of);
            let mut share = vec![0.0; sigma.len()];
            for i in 0..n {
                share[problem.component[i]] += s[(j, i)].powi(2) * variance[i];
            }
            let sum: f64 = share.iter().zip(&of_load).filter(|(x, _)| **x > 0.0).map(|(x, dof)| x * x / dof).sum();
            let total: f64 = share.iter().sum();
            own.standard = of.standard.map(|_| total.sqrt());
            own.dof = of.dof.map(|_| if sum > 0.0 { total * total / sum } else { f64::INFINITY });
        }
        fitted.fitted = (0..n).map(|i| (0..p).map(|j| problem.design[(i, j)] * value[j]).sum()).collect();
        fitted.residuals = problem.response.iter().zip(&fitted.fitted).map(|(y, f)| y - f).collect();
        for (c, component) in fitted.components.iter_mut().enumerate() {
            component.sigma = Some(sigma[c]);
            component.dof = of_load[c];
        }
        fitted.covariance = covariance;
        fitted.sensitivity_by_row = by_row;
        fitted.optimality = found.optimality;
    }
}
