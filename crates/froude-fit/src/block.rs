//! Parts of a problem that share no coefficient, in scaled units.
//!
//! Components that no coefficient and no constraint couples are separate
//! problems, each with its own σ; solving them apart keeps σ of one out of
//! the other, to the last bit. A block holds one such part: its columns scaled
//! to unit length, fixed coefficients moved to the right-hand side.

use faer::Mat;

use crate::dense::{column_norm, norm};
use crate::error::FitError;
use crate::options::Options;
use crate::problem::Problem;

/// A constraint of unit length is contradicted beyond this, relative to its terms.
const CONTRADICTION: f64 = 1e-9;

/// One separate part of a problem; all numbers in scaled units.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Columns of the problem that are free here.
    pub columns: Vec<usize>,
    /// Rows of the problem.
    pub rows: Vec<usize>,
    /// Components of the problem.
    pub components: Vec<usize>,
    /// Length of each weighted column; scaled coefficient = scale × coefficient.
    pub scale: Vec<f64>,
    /// `√w X / scale`, rows × columns.
    pub design: Mat<f64>,
    /// `√w (y − fixed part)`.
    pub response: Vec<f64>,
    /// Component of each row, an index into `components`.
    pub row_component: Vec<usize>,
    /// Observations behind the rows of each component, where these were condensed.
    pub observations: Option<Vec<usize>>,
    /// Each prior as its row entries and right-hand side, both divided by its standard uncertainty.
    pub priors: Vec<(Vec<(usize, f64)>, f64)>,
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
    /// Rows of unit length and right-hand sides of the inequalities.
    pub inequalities: Vec<(Vec<f64>, f64)>,
    /// Their index in the options.
    pub inequality_index: Vec<usize>,
}

impl Block {
    /// Observations of each component of the block.
    pub(crate) fn n_rows_of(&self) -> Vec<usize> {
        if let Some(observations) = &self.observations {
            return observations.clone();
        }
        let mut count = vec![0; self.components.len()];
        for &c in &self.row_component {
            count[c] += 1;
        }
        count
    }

    /// Whether bounds or inequalities are there at all.
    pub(crate) fn is_constrained(&self) -> bool {
        !self.inequalities.is_empty()
            || self.lower.iter().any(|l| l.is_finite())
            || self.upper.iter().any(|u| u.is_finite())
    }
}

/// Splits a checked problem into its blocks.
pub(crate) fn blocks(problem: &Problem, options: &Options) -> Result<Vec<Block>, FitError> {
    let held = held_values(problem, options);
    let group = groups(problem, options, &held);
    check_constant_rows(options, &held)?;
    let n_components = problem.components.len();
    let mut roots: Vec<usize> = Vec::new();
    for &root in &group[..n_components] {
        if !roots.contains(&root) {
            roots.push(root);
        }
    }
    Ok(roots.iter().map(|&root| block(problem, options, &held, &group, root)).collect())
}

/// Value of each coefficient that is not estimated.
fn held_values(problem: &Problem, options: &Options) -> Vec<Option<f64>> {
    let mut held = vec![None; problem.n_coefficients()];
    for &(index, value) in &options.fixed {
        held[index] = Some(value);
    }
    for &index in &options.excluded {
        held[index] = Some(0.0);
    }
    held
}

/// The group of each component, then of each column.
fn groups(problem: &Problem, options: &Options, held: &[Option<f64>]) -> Vec<usize> {
    let n_components = problem.components.len();
    let p = problem.n_coefficients();
    let mut sets = Sets::new(n_components + p);
    for j in (0..p).filter(|&j| held[j].is_none()) {
        for (i, &component) in problem.component.iter().enumerate() {
            if problem.design[(i, j)] != 0.0 && problem.weight_of(i) > 0.0 {
                sets.join(component, n_components + j);
            }
        }
    }
    for constraint in &options.inequalities {
        let mut first = None;
        for j in free_columns_of(&constraint.row, held) {
            let first = *first.get_or_insert(j);
            sets.join(n_components + first, n_components + j);
        }
    }
    for prior in options.priors.iter().filter(|prior| held[prior.index].is_none()) {
        for (j, _) in prior.with.iter().filter(|(j, _)| held[*j].is_none()) {
            sets.join(n_components + prior.index, n_components + j);
        }
    }
    // Columns that meet no component join the first one.
    let roots: Vec<usize> = (0..n_components).map(|c| sets.find(c)).collect();
    for j in 0..p {
        if !roots.contains(&sets.find(n_components + j)) {
            sets.join(0, n_components + j);
        }
    }
    (0..n_components + p).map(|node| sets.find(node)).collect()
}

fn free_columns_of<'a>(row: &'a [f64], held: &'a [Option<f64>]) -> impl Iterator<Item = usize> + 'a {
    (0..row.len()).filter(|&j| row[j] != 0.0 && held[j].is_none())
}

/// Constraints without a free coefficient hold or they do not.
fn check_constant_rows(options: &Options, held: &[Option<f64>]) -> Result<(), FitError> {
    for c in &options.inequalities {
        let (rest, size) = remainder(&c.row, c.value, held);
        if free_columns_of(&c.row, held).next().is_none() && rest < -CONTRADICTION * size {
            return Err(FitError::Infeasible);
        }
    }
    Ok(())
}

/// Right-hand side less the held part, and the size of its terms.
fn remainder(row: &[f64], value: f64, held: &[Option<f64>]) -> (f64, f64) {
    let mut rest = value;
    let mut size = value.abs();
    for (factor, held) in row.iter().zip(held) {
        if let Some(held) = held {
            rest -= factor * held;
            size += (factor * held).abs();
        }
    }
    (rest, size)
}

fn block(problem: &Problem, options: &Options, held: &[Option<f64>], group: &[usize], root: usize) -> Block {
    let n_components = problem.components.len();
    let components: Vec<usize> = (0..n_components).filter(|&c| group[c] == root).collect();
    let columns: Vec<usize> =
        (0..problem.n_coefficients()).filter(|&j| held[j].is_none() && group[n_components + j] == root).collect();
    let rows: Vec<usize> =
        (0..problem.n_rows()).filter(|&i| group[problem.component[i]] == root && problem.weight_of(i) > 0.0).collect();
    let row_component: Vec<usize> =
        rows.iter().filter_map(|&i| components.iter().position(|&c| c == problem.component[i])).collect();
    let root_weight: Vec<f64> = rows.iter().map(|&i| problem.weight_of(i).sqrt()).collect();
    let response = rows
        .iter()
        .zip(&root_weight)
        .map(|(&i, w)| {
            let known: f64 =
                held.iter().enumerate().filter_map(|(j, held)| held.map(|held| problem.design[(i, j)] * held)).sum();
            w * (problem.response[i] - known)
        })
        .collect();
    let mut design =
        Mat::from_fn(rows.len(), columns.len(), |k, l| root_weight[k] * problem.design[(rows[k], columns[l])]);
    let scale: Vec<f64> = (0..columns.len())
        .map(|l| {
            let length = column_norm(design.as_ref(), l);
            let prior = options.priors.iter().find(|p| p.index == columns[l]);
            match (length > 0.0, prior) {
                (true, _) => length,
                (false, Some(prior)) => 1.0 / prior.standard,
                (false, None) => 1.0,
            }
        })
        .collect();
    for l in 0..columns.len() {
        for k in 0..rows.len() {
            design[(k, l)] /= scale[l];
        }
    }
    let local = |j: usize| columns.iter().position(|&c| c == j);
    let priors = options
        .priors
        .iter()
        .filter(|prior| local(prior.index).is_some())
        .map(|prior| {
            let entries = std::iter::once((prior.index, 1.0)).chain(prior.with.iter().map(|(j, slope)| (*j, -slope)));
            let known: f64 = prior.with.iter().filter_map(|(j, slope)| held[*j].map(|value| slope * value)).sum();
            let row = entries.filter_map(|(j, x)| local(j).map(|l| (l, x / (prior.standard * scale[l])))).collect();
            (row, (prior.value + known) / prior.standard)
        })
        .collect();
    let here = |row: &[f64]| free_columns_of(row, held).any(|j| local(j).is_some());
    let scaled = |row: &[f64], value: f64| {
        let rest = remainder(row, value, held).0;
        let row: Vec<f64> = columns.iter().zip(&scale).map(|(&j, s)| row[j] / s).collect();
        let length = norm(&row);
        let unit: Vec<f64> = row.iter().map(|r| r / length).collect();
        (unit, rest / length)
    };
    let mut inequalities = Vec::new();
    let mut inequality_index = Vec::new();
    for (index, c) in options.inequalities.iter().enumerate() {
        if here(&c.row) {
            inequalities.push(scaled(&c.row, c.value));
            inequality_index.push(index);
        }
    }
    let bounds: Vec<_> = columns.iter().map(|&j| options.bound(j)).collect();
    Block {
        lower: bounds.iter().zip(&scale).map(|(b, s)| b.lower * s).collect(),
        upper: bounds.iter().zip(&scale).map(|(b, s)| b.upper * s).collect(),
        columns,
        rows,
        observations: (!options.observations.is_empty())
            .then(|| components.iter().map(|&c| options.observations[c]).collect()),
        components,
        scale,
        design,
        response,
        row_component,
        priors,
        inequalities,
        inequality_index,
    }
}

/// Disjoint sets, joined towards the smaller index.
struct Sets(Vec<usize>);

impl Sets {
    fn new(n: usize) -> Self {
        Self((0..n).collect())
    }

    fn find(&mut self, mut x: usize) -> usize {
        while self.0[x] != x {
            self.0[x] = self.0[self.0[x]];
            x = self.0[x];
        }
        x
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        let (low, high) = (a.min(b), a.max(b));
        self.0[high] = low;
    }
}
