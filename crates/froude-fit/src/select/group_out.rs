//! Prediction of each group from all others.

use std::collections::BTreeSet;

use super::{ComponentScore, Score, predicting, training};
use crate::error::FitError;
use crate::linear::fit;
use crate::options::Options;
use crate::problem::{Problem, size};

/// How well left-out groups are predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroupScore {
    /// Root mean square error over all rows, unit of the response.
    pub rmse: f64,
    /// The group predicted worst.
    pub worst_group: usize,
    /// Its root mean square error.
    pub worst_rmse: f64,
    /// Groups left out, one at a time.
    pub n_groups: usize,
}

/// Fewest groups: with two, each would be predicted from a single other one.
const FEWEST_GROUPS: usize = 3;

/// Predicts each group (a configuration, say) from a fit to all others.
///
/// `groups` has an entry per row. A component is not scorable with fewer than
/// three groups, or when the others do not determine what a group needs.
///
/// # Errors
///
/// As [`fit`], and [`FitError::Size`] when `groups` has not an entry per row.
pub fn leave_one_group_out(
    problem: &Problem,
    options: &Options,
    groups: &[usize],
) -> Result<Vec<ComponentScore<GroupScore>>, FitError> {
    problem.check()?;
    options.check(problem)?;
    let n = problem.n_rows();
    size("groups", groups.len(), n, "one per row of the design")?;
    let all: BTreeSet<usize> = groups.iter().copied().collect();
    let options = predicting(options);
    // Error of each row, or the group that leaves it undetermined.
    let mut error: Vec<Result<f64, usize>> = vec![Ok(0.0); n];
    for &group in &all {
        let (test, train): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| groups[i] == group);
        if train.is_empty() {
            continue;
        }
        let fitted = fit(&training(problem, &train), &options)?;
        for i in test {
            let row = crate::dense::row(problem.design.as_ref(), i);
            error[i] = fitted.predict(&row).map(|p| problem.response[i] - p.value).ok_or(group);
        }
    }
    Ok(problem
        .components
        .iter()
        .enumerate()
        .map(|(c, name)| {
            let rows: Vec<usize> = (0..n).filter(|&i| problem.component[i] == c).collect();
            ComponentScore { component: name.clone(), score: score(&rows, groups, &error) }
        })
        .collect())
}

fn score(rows: &[usize], groups: &[usize], error: &[Result<f64, usize>]) -> Score<GroupScore> {
    let present: BTreeSet<usize> = rows.iter().map(|&i| groups[i]).collect();
    if present.len() < FEWEST_GROUPS {
        return Score::NotScorable {
            reason: format!(
                "leaving one group out needs {FEWEST_GROUPS} groups, and there {} {}",
                if present.len() == 1 { "is" } else { "are" },
                present.len()
            ),
        };
    }
    let mut total = 0.0;
    let mut worst = (0, -1.0);
    for &group in &present {
        let mut sum = 0.0;
        let mut count = 0.0;
        for &i in rows.iter().filter(|&&i| groups[i] == group) {
            match error[i] {
                Ok(e) => {
                    sum += e * e;
                    count += 1.0;
                }
                Err(group) => {
                    return Score::NotScorable {
                        reason: format!("without group {group} the others do not determine its prediction"),
                    };
                }
            }
        }
        total += sum;
        let rmse = f64::sqrt(sum / count);
        if rmse > worst.1 {
            worst = (group, rmse);
        }
    }
    Score::Scored(GroupScore {
        rmse: (total / rows.len() as f64).sqrt(),
        worst_group: worst.0,
        worst_rmse: worst.1,
        n_groups: present.len(),
    })
}
