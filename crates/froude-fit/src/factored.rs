//! One design, many responses.
//!
//! A coverage study fits the same design thousands of times. Here it is
//! factored once; each response then costs two products with `Q`.

use crate::block::blocks;
use crate::covariance::clusters;
use crate::dense::{Cholesky, mul, row};
use crate::determined::Indeterminacy;
use crate::distribution::coverage_factor;
use crate::error::FitError;
use crate::estimate::estimate;
use crate::freedom::Form;
use crate::options::{Bound, CovarianceKind, Options};
use crate::problem::Problem;

/// A leave-one-out pivot below this means that the rest determines too little.
const ALONE: f64 = 1e-10;

/// A factored design of components that share no coefficient.
#[derive(Debug, Clone)]
pub struct Factored {
    n: usize,
    parts: Vec<FactoredPart>,
    kind: CovarianceKind,
    determined: Vec<bool>,
    dof: Vec<f64>,
}

/// One component.
#[derive(Debug, Clone)]
struct FactoredPart {
    component: usize,
    rows: Vec<usize>,
    columns: Vec<usize>,
    root_weight: Vec<f64>,
    rank: usize,
    /// `Q`, row by row.
    q: Vec<f64>,
    /// From `Qᵀ y` to coefficients, row by row.
    lift: Vec<f64>,
    /// Standard uncertainty per unit σ.
    unit: Vec<f64>,
    dof: f64,
    /// Move of each coefficient per unit residual when the row's group is left
    /// out, and the group of each row.
    leave_out: Option<(Vec<f64>, Vec<usize>, usize)>,
}

/// A buffer for [`Factored::solve`]; lengths `p`, `p`, and one per component.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Coefficients; NaN where not determined.
    pub value: Vec<f64>,
    /// Standard uncertainties; NaN where there is none.
    pub standard: Vec<f64>,
    /// σ of each component; NaN without degrees of freedom.
    pub sigma: Vec<f64>,
    residual: Vec<f64>,
}

impl Factored {
    /// Factors the design of a problem; its response is not used.
    ///
    /// # Errors
    ///
    /// As [`crate::fit`], and [`FitError::Unsupported`] when a coefficient is
    /// shared by two components, whose σ would have to be iterated each time.
    pub fn new(problem: &Problem, kind: CovarianceKind) -> Result<Self, FitError> {
        problem.check()?;
        let options = Options { covariance: kind, ..Options::default() };
        options.check(problem)?;
        let p = problem.n_coefficients();
        let mut determined = vec![false; p];
        let mut dof = vec![f64::NAN; p];
        let mut parts = Vec::new();
        for block in blocks(problem, &options)? {
            if block.components.len() > 1 {
                return Err(FitError::Unsupported {
                    method: "a factored design",
                    what: "coefficients shared by two components",
                });
            }
            let estimate = estimate(&block);
            let qr = &estimate.qr;
            let rank = qr.rank;
            let null = Indeterminacy::new(qr.null_space().as_ref());
            let scaled_lift = qr.lift();
            let n = block.rows.len();
            let mut lift = Vec::with_capacity(block.columns.len() * rank);
            let mut unit = Vec::new();
            for l in 0..block.columns.len() {
                let of_row: Vec<f64> = row(scaled_lift.as_ref(), l).iter().map(|x| x / block.scale[l]).collect();
                unit.push(crate::dense::norm(&of_row));
                lift.extend(of_row);
            }
            let q: Vec<f64> = (0..n).flat_map(|i| row(qr.q.as_ref(), i)).collect();
            let leave_out = match kind {
                CovarianceKind::Classical => None,
                CovarianceKind::Hc3 => {
                    let groups: Vec<usize> = (0..n).collect();
                    Some((groups, n))
                }
                CovarianceKind::Cr3 => {
                    let clusters = clusters(problem, &block)?;
                    let mut groups = vec![0; n];
                    for (g, members) in clusters.values().enumerate() {
                        for &i in members {
                            groups[i] = g;
                        }
                    }
                    Some((groups, clusters.len()))
                }
            };
            let leave_out = leave_out
                .map(|(groups, count)| {
                    leave_out_moves(&q, rank, &lift, &groups, count)
                        .map(|moves| (moves, groups, count))
                        .map_err(|g| decides(problem, &block, kind, g))
                })
                .transpose()?;
            for (l, &j) in block.columns.iter().enumerate() {
                determined[j] = null.determined[l];
                let of_part = match &leave_out {
                    Some(_) if rank == 0 => f64::NAN,
                    Some((moves, groups, count)) => freedom(&q, rank, &moves[l * n..(l + 1) * n], groups, *count),
                    None => (n - rank) as f64,
                };
                if null.determined[l] && of_part > 0.0 {
                    dof[j] = of_part;
                }
            }
            parts.push(FactoredPart {
                component: block.components[0],
                root_weight: block.rows.iter().map(|&i| problem.weight_of(i).sqrt()).collect(),
                rows: block.rows,
                columns: block.columns,
                rank,
                q,
                lift,
                unit,
                dof: (n - rank) as f64,
                leave_out,
            });
        }
        Ok(Self { n: problem.n_rows(), parts, kind, determined, dof })
    }

    /// Which coefficients the design determines.
    #[must_use]
    pub fn determined(&self) -> &[bool] {
        &self.determined
    }

    /// Degrees of freedom of each coefficient's interval; NaN where there is none.
    #[must_use]
    pub fn dof(&self) -> &[f64] {
        &self.dof
    }

    /// Coverage factor of each coefficient's interval.
    #[must_use]
    pub fn coverage_factors(&self, confidence: f64) -> Vec<f64> {
        self.dof.iter().map(|&dof| coverage_factor(confidence, dof)).collect()
    }

    /// An empty buffer of the right size.
    #[must_use]
    pub fn buffer(&self) -> Solution {
        Solution {
            value: vec![f64::NAN; self.determined.len()],
            standard: vec![f64::NAN; self.determined.len()],
            sigma: vec![f64::NAN; self.parts.len()],
            residual: vec![0.0; self.n],
        }
    }

    /// Fits one response into a buffer; allocates nothing beyond a few numbers.
    ///
    /// # Panics
    ///
    /// When the response does not have a value per row of the design.
    pub fn solve(&self, response: &[f64], out: &mut Solution) {
        assert_eq!(response.len(), self.n, "a response per row of the design");
        for part in &self.parts {
            part.solve(response, self.kind, &self.determined, out);
        }
    }

    /// The interval of coefficient `j`, cut by bounds; `None` when nothing is
    /// left or there is no standard uncertainty.
    #[must_use]
    pub fn interval(solution: &Solution, j: usize, coverage_factor: f64, bound: Bound) -> Option<[f64; 2]> {
        let half = coverage_factor * solution.standard[j];
        let low = (solution.value[j] - half).max(bound.lower);
        let high = (solution.value[j] + half).min(bound.upper);
        (half.is_finite() && low <= high).then_some([low, high])
    }
}

impl FactoredPart {
    fn solve(&self, response: &[f64], kind: CovarianceKind, known: &[bool], out: &mut Solution) {
        let rank = self.rank;
        let mut z = vec![0.0; rank];
        for (k, &i) in self.rows.iter().enumerate() {
            let y = self.root_weight[k] * response[i];
            out.residual[k] = y;
            for (z, q) in z.iter_mut().zip(&self.q[k * rank..(k + 1) * rank]) {
                *z += q * y;
            }
        }
        let mut rss = 0.0;
        for k in 0..self.rows.len() {
            let q = &self.q[k * rank..(k + 1) * rank];
            let r = out.residual[k] - crate::dense::dot(q, &z);
            out.residual[k] = r;
            rss += r * r;
        }
        let sigma = if self.dof > 0.0 { (rss / self.dof).sqrt() } else { f64::NAN };
        out.sigma[self.component] = sigma;
        for (l, &j) in self.columns.iter().enumerate() {
            if !known[j] {
                continue;
            }
            out.value[j] = crate::dense::dot(&self.lift[l * rank..(l + 1) * rank], &z);
            out.standard[j] = match &self.leave_out {
                None => sigma * self.unit[l],
                Some((moves, groups, count)) => {
                    let n = self.rows.len();
                    let mut sums = vec![0.0; *count];
                    for (i, &g) in groups.iter().enumerate() {
                        sums[g] += moves[l * n + i] * out.residual[i];
                    }
                    let sum: f64 = sums.iter().map(|s| s * s).sum();
                    match kind {
                        CovarianceKind::Cr3 => (sum * (*count as f64 - 1.0) / *count as f64).sqrt(),
                        _ => sum.sqrt(),
                    }
                }
            };
        }
    }
}

/// Degrees of freedom of the sum of squared moves of a coefficient: see [`crate::freedom`].
fn freedom(q: &[f64], rank: usize, moves: &[f64], groups: &[usize], count: usize) -> f64 {
    let one = faer::Mat::identity(rank, rank);
    let mut parts = vec![(0.0, vec![0.0; rank]); count];
    for (i, (&g, m)) in groups.iter().zip(moves).enumerate() {
        let (d, u) = &mut parts[g];
        *d += m * m;
        for (u, q) in u.iter_mut().zip(&q[i * rank..(i + 1) * rank]) {
            *u += m * q;
        }
    }
    let mut form = Form::new(rank);
    for (d, u) in &parts {
        form.add(*d, u, &one);
    }
    form.dof(&one)
}

fn decides(problem: &Problem, block: &crate::block::Block, kind: CovarianceKind, group: usize) -> FitError {
    if kind == CovarianceKind::Hc3 {
        return FitError::RowDecides { row: block.rows[group] };
    }
    let cluster = clusters(problem, block).ok().and_then(|c| c.keys().nth(group).copied()).unwrap_or(group);
    FitError::ClusterDecides { cluster, component: crate::covariance::component_names(problem, block) }
}

/// `T` with `Σ_{i∈g} T_li r_i` the move of coefficient `l` when group `g` is
/// left out; the error is the first group that cannot be left out.
fn leave_out_moves(q: &[f64], rank: usize, lift: &[f64], groups: &[usize], count: usize) -> Result<Vec<f64>, usize> {
    let n = groups.len();
    let p = lift.len().checked_div(rank).unwrap_or(0);
    let mut out = vec![0.0; p * n];
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (i, &g) in groups.iter().enumerate() {
        members[g].push(i);
    }
    for (g, members) in members.iter().enumerate() {
        let part = faer::Mat::from_fn(rank, members.len(), |k, m| q[members[m] * rank + k]);
        let gram = mul(part.as_ref(), part.transpose());
        let rest = faer::Mat::from_fn(rank, rank, |i, j| f64::from(u8::from(i == j)) - gram[(i, j)]);
        let factor = Cholesky::new(rest.as_ref(), ALONE).ok_or(g)?;
        for &i in members {
            let mut moved = q[i * rank..(i + 1) * rank].to_vec();
            factor.solve(&mut moved);
            for l in 0..p {
                out[l * n + i] = crate::dense::dot(&lift[l * rank..(l + 1) * rank], &moved);
            }
        }
    }
    Ok(out)
}
