//! Prediction of each group from all others.

use std::collections::BTreeMap;

use faer::Mat;

use super::{ComponentScore, predicting, training};
use crate::block::{Block, blocks};
use crate::error::FitError;
use crate::linear::fit;
use crate::options::Options;
use crate::problem::{Problem, size};

/// Fewest groups: with two, each would be predicted from a single other one.
const FEWEST_GROUPS: usize = 3;

/// Predicts each group (a configuration, for example) from a fit to all others: the root mean square error over all rows, in the unit of
/// the response.
///
/// `groups` has an entry per row. A component is not scorable with fewer than
/// three groups, or when the others do not determine what a group needs.
///
/// # Errors
///
/// As [`fit`], and [`FitError::Refused`] when `groups` has not an entry per row.
pub fn leave_one_group_out(
    problem: &Problem,
    options: &Options,
    groups: &[usize],
) -> Result<Vec<ComponentScore<f64>>, FitError> {
    problem.check()?;
    options.check(problem)?;
    let n = problem.n_rows();
    size("groups", groups.len(), n, "one per row of the design")?;
    let mut rows_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, &group) in groups.iter().enumerate() {
        rows_of.entry(group).or_default().push(i);
    }
    let options = predicting(options);
    let mut others: Box<dyn Others + '_> = if is_weighed_alone(problem, &options)? {
        Box::new(Condensed::new(problem, rows_of.values()))
    } else {
        if rows_of.len().saturating_mul(n) > MOST_REFITTED {
            let reason = format!(
                "{} groups of {n} rows in all would be fitted anew one by one; at most {MOST_REFITTED} rows are",
                rows_of.len()
            );
            return Ok(not_scored(problem, &reason));
        }
        Box::new(Whole { problem, groups })
    };
    // Error of each row, or the group that leaves it undetermined.
    let mut error: Vec<Result<f64, usize>> = vec![Ok(0.0); n];
    for (k, (&group, test)) in rows_of.iter().enumerate() {
        let Some(training) = others.than(k, group) else { continue };
        let fitted = fit(&training, &options)?;
        for &i in test {
            let row = crate::dense::row(problem.design.as_ref(), i);
            error[i] = fitted.predict(&row).map(|value| problem.response[i] - value).ok_or(group);
        }
    }
    Ok(problem
        .components
        .iter()
        .enumerate()
        .map(|(c, name)| ComponentScore { component: name.clone(), score: score(&problem.rows_of(c), groups, &error) })
        .collect())
}

/// Most rows that are fitted again and again, groups times rows, where every fit needs all of them.
const MOST_REFITTED: usize = 5_000_000;

fn not_scored(problem: &Problem, reason: &str) -> Vec<ComponentScore<f64>> {
    let score = |name: &String| ComponentScore { component: name.clone(), score: Err(reason.to_owned()) };
    problem.components.iter().map(score).collect()
}

/// Whether the coefficients are independent of how the components' scatters compare: no two components share one, and nothing is known
/// before.
fn is_weighed_alone(problem: &Problem, options: &Options) -> Result<bool, FitError> {
    let is_alone = |block: &Block| block.components.len() == 1 && block.priors.is_empty();
    Ok(blocks(problem, options)?.iter().all(is_alone))
}

/// The problem without one group.
trait Others {
    /// Without group number `k`, whose name is `group`; `None` where nothing is left.
    fn than(&mut self, k: usize, group: usize) -> Option<Problem>;
}

/// All rows of all other groups.
struct Whole<'a> {
    problem: &'a Problem,
    groups: &'a [usize],
}

impl Others for Whole<'_> {
    fn than(&mut self, _: usize, group: usize) -> Option<Problem> {
        let train: Vec<usize> = (0..self.groups.len()).filter(|&i| self.groups[i] != group).collect();
        (!train.is_empty()).then(|| training(self.problem, &train))
    }
}

/// The triangles of the other groups: least squares on `R` and `Qᵀy` is that on the rows.
///
/// Those before a group and those behind it are kept for every group, each made from its neighbour by one small factorisation: the cost
/// grows with the rows and not with groups times rows, and nothing is ever subtracted.
struct Condensed<'a> {
    problem: &'a Problem,
    /// By component, then by group: what stands before it.
    before: Vec<Vec<Mat<f64>>>,
    /// The same of what stands behind it.
    behind: Vec<Vec<Mat<f64>>>,
}

impl<'a> Condensed<'a> {
    fn new<'g>(problem: &'a Problem, groups: impl Iterator<Item = &'g Vec<usize>>) -> Self {
        let p = problem.n_coefficients();
        let groups: Vec<&Vec<usize>> = groups.collect();
        let entry = |i: usize, j: usize| {
            let root = problem.weight.as_ref().map_or(1.0, |w| w[i].sqrt());
            root * if j < p { problem.design[(i, j)] } else { problem.response[i] }
        };
        // Triangle of what came before, group after group in the order given.
        let sweep = |component: usize, order: &mut dyn Iterator<Item = usize>| -> Vec<Mat<f64>> {
            let mut so_far = Mat::zeros(0, p + 1);
            let mut out = Vec::with_capacity(groups.len());
            for k in order {
                let own: Vec<usize> =
                    groups[k].iter().copied().filter(|&i| problem.component[i] == component).collect();
                let stacked = Mat::from_fn(so_far.nrows() + own.len(), p + 1, |i, j| {
                    if i < so_far.nrows() { so_far[(i, j)] } else { entry(own[i - so_far.nrows()], j) }
                });
                out.push(std::mem::replace(&mut so_far, triangle(stacked)));
            }
            out
        };
        let components = 0..problem.components.len();
        let before = components.clone().map(|c| sweep(c, &mut (0..groups.len()))).collect();
        let behind = components.map(|c| {
            let mut out = sweep(c, &mut (0..groups.len()).rev());
            out.reverse();
            out
        });
        Self { problem, before, behind: behind.collect() }
    }
}

impl Others for Condensed<'_> {
    fn than(&mut self, k: usize, _: usize) -> Option<Problem> {
        let p = self.problem.n_coefficients();
        let (mut rows, mut component, mut components) = (Vec::new(), Vec::new(), Vec::new());
        for (c, name) in self.problem.components.iter().enumerate() {
            let parts = [&self.before[c][k], &self.behind[c][k]];
            if parts.iter().all(|part| part.nrows() == 0) {
                continue;
            }
            for part in parts {
                rows.extend((0..part.nrows()).map(|i| (part, i)));
                component.extend(std::iter::repeat_n(components.len(), part.nrows()));
            }
            components.push(name.clone());
        }
        (!rows.is_empty()).then(|| Problem {
            design: Mat::from_fn(rows.len(), p, |i, j| rows[i].0[(rows[i].1, j)]),
            response: rows.iter().map(|(part, i)| part[(*i, p)]).collect(),
            weight: None,
            component,
            components,
            cluster: None,
            names: self.problem.names.clone(),
        })
    }
}

/// The triangle of a matrix, or the matrix where it is no longer than that.
fn triangle(matrix: Mat<f64>) -> Mat<f64> {
    if matrix.nrows() <= matrix.ncols() {
        return matrix;
    }
    matrix.qr().thin_R().to_owned()
}

fn score(rows: &[usize], groups: &[usize], error: &[Result<f64, usize>]) -> Result<f64, String> {
    let mut squares: BTreeMap<usize, f64> = rows.iter().map(|&i| (groups[i], 0.0)).collect();
    let present = squares.len();
    if present < FEWEST_GROUPS {
        let are = if present == 1 { "is" } else { "are" };
        return Err(format!("leaving one group out needs {FEWEST_GROUPS} groups, and there {are} {present}"));
    }
    for &i in rows {
        let undetermined = |group| format!("without group {group} the others do not determine its prediction");
        *squares.entry(groups[i]).or_default() += error[i].map_err(undetermined)?.powi(2);
    }
    Ok((squares.values().sum::<f64>() / rows.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Bound;

    /// Forces of two components over five settings of three rows; `shared` gives both components one coefficient.
    fn problem(shared: bool) -> (Problem, Vec<usize>) {
        let speed = |i: usize| 0.1 + 0.07 * (i % 15) as f64;
        let p = if shared { 3 } else { 4 };
        let column = |i: usize| {
            if i < 15 {
                0
            } else if shared {
                1
            } else {
                2
            }
        };
        let design = Mat::from_fn(30, p, |i, j| match j.checked_sub(column(i)) {
            Some(0) => speed(i),
            Some(1) => speed(i) * speed(i),
            _ => 0.0,
        });
        let response = (0..30).map(|i| 2.0 * speed(i) + 5.0 * speed(i).powi(2) + 0.01 * ((7 * i % 11) as f64 - 5.0));
        let problem = Problem {
            design,
            response: response.collect(),
            weight: Some((0..30).map(|i| 1.0 + 0.1 * f64::from(i % 4)).collect()),
            component: (0..30).map(|i| i / 15).collect(),
            components: vec!["f_x".into(), "f_y".into()],
            cluster: None,
            names: (0..p).map(|j| format!("c{j}")).collect(),
        };
        (problem, (0..30).map(|i| i % 15 / 3).collect())
    }

    /// Both ways to the same predictions, to rounding of problems of condition 30: 1e-12.
    #[test]
    fn condensed_groups_predict_what_their_rows_do() {
        let (problem, groups) = problem(false);
        let bounds = vec![Bound { lower: 2.05, upper: 9.0 }; 4];
        for options in [Options::default(), Options { bounds, ..Options::default() }] {
            assert!(is_weighed_alone(&problem, &options).unwrap());
            let rows_of: Vec<Vec<usize>> = (0..5).map(|g| (0..30).filter(|&i| groups[i] == g).collect()).collect();
            let mut condensed = Condensed::new(&problem, rows_of.iter());
            let mut whole = Whole { problem: &problem, groups: &groups };
            for g in 0..5 {
                let [short, long] = [condensed.than(g, g), whole.than(g, g)].map(|p| p.unwrap());
                assert!(short.n_rows() <= 20 && long.n_rows() == 24);
                let [short, long] = [short, long].map(|p| fit(&p, &options).unwrap());
                for i in &rows_of[g] {
                    let row = crate::dense::row(problem.design.as_ref(), *i);
                    let [a, b] = [&short, &long].map(|f| f.predict(&row).unwrap());
                    assert!((a - b).abs() < 1e-12 * b.abs(), "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn components_that_share_a_coefficient_are_weighed_by_their_scatter_and_fitted_whole() {
        let (problem, groups) = problem(true);
        assert!(!is_weighed_alone(&problem, &Options::default()).unwrap());
        let scores = leave_one_group_out(&problem, &Options::default(), &groups).unwrap();
        assert!(scores.iter().all(|s| s.score.is_ok()), "{scores:?}");
    }
}
