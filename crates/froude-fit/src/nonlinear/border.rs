//! The linear problem inside each step: bordered block-diagonal, solved run by run.
//!
//! A parameter of one run alone moves the residuals of that run only. With `N` its columns there and `S` those of the shared parameters,
//! both sides of the run are projected on what `N` cannot explain, `S − Q Qᵀ S` with `N = Q R`: the shared parameters follow from the projected
//! rows of all runs, then each run's own from what is left. The cost is linear in the number of runs.
//!
//! **Source.** Frisch & Waugh (1933), Econometrica 1, 387; Lovell (1963), J. Am. Stat. Assoc. 58, 993 (the projection); Golub & Van Loan (2013),
//! 5.3.3 (by QR).

use std::ops::Range;

use faer::Mat;

use super::point::{Layout, Point};
use crate::dense::{column_norm, mul_vec, tr_mul_vec};
use crate::rank::{PivotedQr, RANK_TOLERANCE};

/// Levenberg's damping: `λ`, and the length of each parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Damping<'a> {
    pub lambda: f64,
    pub lengths: &'a [f64],
}

/// Columns of unit length, factored.
#[derive(Debug, Clone)]
pub(super) struct Scaled {
    pub qr: PivotedQr,
    pub scale: Vec<f64>,
}

/// The linear problem, own parameters eliminated.
#[derive(Debug, Clone)]
pub(super) struct Eliminated {
    /// Shared parameters that are free.
    pub free: Vec<usize>,
    /// Rows of each run among the projected ones.
    pub rows: Vec<Range<usize>>,
    /// Projected residuals.
    pub response: Vec<f64>,
    /// Projected columns of the free shared parameters.
    pub shared: Scaled,
    /// By run: its own free parameters and their columns.
    own: Vec<(Vec<usize>, Scaled)>,
}

impl Scaled {
    /// `lengths` are those before anything was projected out: what is left of a column is judged against them.
    fn new(mut a: Mat<f64>, lengths: &[f64]) -> Self {
        let scale: Vec<f64> = lengths.iter().map(|&s| if s > 0.0 { s } else { 1.0 }).collect();
        for j in 0..a.ncols() {
            let is_gone = column_norm(a.as_ref(), j) <= RANK_TOLERANCE * scale[j];
            for i in 0..a.nrows() {
                a[(i, j)] = if is_gone { 0.0 } else { a[(i, j)] / scale[j] };
            }
        }
        Self { qr: PivotedQr::new(a.as_ref()), scale }
    }

    fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.qr.solve(b).iter().zip(&self.scale).map(|(x, s)| x / s).collect()
    }

    /// `b − Q Qᵀ b`, twice for the last digit.
    fn project(&self, b: &mut [f64]) {
        for _ in 0..2 {
            let explained = mul_vec(self.qr.q.as_ref(), &tr_mul_vec(self.qr.q.as_ref(), b));
            b.iter_mut().zip(explained).for_each(|(b, e)| *b -= e);
        }
    }
}

/// Eliminates the free own parameters; `target` is what the linearised model should move by.
pub(super) fn eliminate(
    here: &Point,
    layout: &Layout,
    is_free: impl Fn(usize) -> bool,
    target: &[Vec<f64>],
    damping: Option<Damping<'_>>,
) -> Eliminated {
    let free: Vec<usize> = layout.shared.iter().copied().filter(|&j| is_free(j)).collect();
    let positions: Vec<usize> = (0..layout.shared.len()).filter(|&k| is_free(layout.shared[k])).collect();
    // A row per damped parameter holds it where it is.
    let hold = |j: usize| damping.map(|d| d.lambda.sqrt() * d.lengths[j]);
    let (mut own, mut rows, mut response) = (Vec::new(), Vec::new(), Vec::new());
    let mut stacked: Vec<Vec<f64>> = vec![Vec::new(); free.len()];
    for (run, target) in target.iter().enumerate() {
        let (mine, at): (Vec<usize>, Vec<usize>) = (layout.own[run].iter().enumerate())
            .filter(|&(_, &j)| is_free(j))
            .map(|(k, &j)| (j, layout.shared.len() + k))
            .unzip();
        let n = target.len();
        let m = n + if damping.is_some() { mine.len() } else { 0 };
        let columns = &here.columns[run];
        let a = Mat::from_fn(m, mine.len(), |i, k| match i.checked_sub(n) {
            None => columns[at[k]][i],
            Some(l) if l == k => hold(mine[k]).unwrap_or(0.0),
            Some(_) => 0.0,
        });
        let lengths: Vec<f64> = (0..mine.len()).map(|k| column_norm(a.as_ref(), k)).collect();
        let factored = Scaled::new(a, &lengths);
        let projected = |b: &[f64]| {
            let mut b = b.to_vec();
            b.resize(m, 0.0);
            factored.project(&mut b);
            b
        };
        for (stacked, &k) in stacked.iter_mut().zip(&positions) {
            stacked.extend(projected(&columns[k]));
        }
        rows.push(response.len()..response.len() + m);
        response.extend(projected(target));
        own.push((mine, factored));
    }
    let n = response.len();
    let m = n + if damping.is_some() { free.len() } else { 0 };
    let a = Mat::from_fn(m, free.len(), |i, k| match i.checked_sub(n) {
        None => stacked[k][i],
        Some(l) if l == k => hold(free[k]).unwrap_or(0.0),
        Some(_) => 0.0,
    });
    response.resize(m, 0.0);
    let whole = here.lengths(layout);
    let lengths: Vec<f64> = free.iter().map(|&j| whole[j].hypot(hold(j).unwrap_or(0.0))).collect();
    Eliminated { free, rows, response, shared: Scaled::new(a, &lengths), own }
}

impl Eliminated {
    /// The least-squares step, zero where a parameter is not free or not determined.
    pub(super) fn step(&self, here: &Point, layout: &Layout, target: &[Vec<f64>]) -> Vec<f64> {
        let mut step = vec![0.0; here.theta.len()];
        for (&j, x) in self.free.iter().zip(self.shared.solve(&self.response)) {
            step[j] = x;
        }
        let moved = here.moved(layout, &step);
        for (run, (mine, factored)) in self.own.iter().enumerate() {
            let mut left: Vec<f64> = target[run].iter().zip(&moved[run]).map(|(t, m)| t - m).collect();
            left.resize(self.rows[run].len(), 0.0);
            for (&j, x) in mine.iter().zip(factored.solve(&left)) {
                step[j] = x;
            }
        }
        step
    }

    /// Parameters that the rows determine, own ones included.
    pub(super) fn rank(&self) -> usize {
        self.shared.qr.rank + self.own.iter().map(|(_, factored)| factored.qr.rank).sum::<usize>()
    }

    /// `Qᵀ` of one run's rows of the shared problem: how each row moves the rotated parameters.
    pub(super) fn rotated(&self, run: usize) -> Vec<Vec<f64>> {
        self.rows[run].clone().map(|i| crate::dense::row(self.shared.qr.q.as_ref(), i)).collect()
    }

    /// From rotated to free shared parameters.
    pub(super) fn lift(&self) -> Mat<f64> {
        let lift = self.shared.qr.lift();
        Mat::from_fn(lift.nrows(), lift.ncols(), |i, k| lift[(i, k)] / self.shared.scale[i])
    }

    /// Score of each row of a run: its projected residual times its row of `Q`. All of them sum to zero at the minimum.
    pub(super) fn scores(&self, run: usize) -> Vec<Vec<f64>> {
        let residuals = &self.response[self.rows[run].clone()];
        self.rotated(run).into_iter().zip(residuals).map(|(q, r)| q.iter().map(|q| q * r).collect()).collect()
    }
}
