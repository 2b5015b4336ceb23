//! Tests of what the intervals assume of the scatter: independent from row to row, of one size, and of no offset by group.
//!
//! Each is exact for independent normal errors of one size and has a stated level over all loads of the law, so that of clean tables few carry a warning. They are asked of
//! the residuals of the fit without bounds, whitened by weights and by declared errors of runs and setups, and cleared of every other declared error that rows share: each is one more coefficient.
//!
//! | code | statistic | against |
//! | --- | --- | --- |
//! | `serial-correlation` | Durbin–Watson in the order of the rows | residuals alike from one row to the next |
//! | `uneven-scatter` | Σ z r²/Σ r², z the logarithm of the fitted load's size, or the size of a channel of the law | errors that grow, or fall, with z |
//! | `setup-offset` | F of one offset per group between and within groups | a calibration, a zero or a mounting of each group |
//!
//! # Source
//!
//! Durbin & Watson (1951), Biometrika 38, 159; King & Hillier (1985), J. Royal Stat. Soc. B 47, 98 (the ratio is the locally best invariant test of a variance that goes with z);
//! probabilities by Imhof (1961), see [`froude_fit::ratio`].

use froude_fit as fit;
use froude_fit::FEWEST_CLUSTERS;
use froude_fit::distribution::{f_upper, normal_upper};
use froude_fit::faer::Mat;
use froude_fit::ratio::{Form, above};
use froude_fit::residuals::Residuals;
use froude_records::finding::{Finding, Severity};
use froude_records::number::p_equation;
use froude_records::texts::Texts;

use crate::dataset::{Dataset, distinct, labels};
use crate::motions;
use crate::regression::{ModelFit, Scatter};

/// Chance that a code warns of a sound table, over all loads of the law.
pub const ALARM: f64 = 0.004;
/// The same of the two whose power few rows limit: runs alike, and offsets of setups.
const ALARM_OF_FEW: f64 = 0.006;
/// The part of it that `uneven-scatter` spends on channels other than the load itself.
const ON_CHANNELS: f64 = 0.25;
/// Loads below this part of the largest count as that: the logarithm of none is none.
const LEAST_LOAD: f64 = 0.02;
/// Fewest rows that a scatter is judged from.
const FEWEST_ROWS: usize = 8;
/// Rows times groups squared up to which offsets of groups are looked for: a tenth of a second.
const MOST_WORK: usize = 100_000_000;
/// A fit without error has no scatter.
const ROUNDING: f64 = 1e-9;

/// What contradicts the scatter that the intervals assume.
pub(crate) fn findings(model: &ModelFit, data: &Dataset, outlying: &[(String, usize)]) -> Vec<(String, Finding)> {
    if data.rows < FEWEST_ROWS || model.in_variables {
        return Vec::new();
    }
    let residuals = match &model.whitened {
        _ if data.sample.is_some() => of_sample(model, data),
        Some(whitened) => {
            let problem = &whitened.problem;
            Residuals::with(problem, &model.options, &vec![1.0; problem.components.len()])
        }
        None => {
            let sigma = model.fit.components.iter().map(|c| c.sigma.filter(|s| *s > 0.0).unwrap_or(1.0));
            let (problem, options) = model.clear_of_declared();
            Residuals::with(&problem, &options, &sigma.collect::<Vec<_>>())
        }
    };
    let Ok(predicted) = model.law.predict(data, model.law_coefficients()) else { return Vec::new() };
    let loads = residuals.len().max(1) as f64;
    let n = data.rows;
    let mut out = Vec::new();
    for (r, residuals) in residuals.iter().enumerate() {
        let (component, predicted) = (&model.fit.components[r], &predicted[r * n..(r + 1) * n]);
        let size = (predicted.iter().map(|f| f * f).sum::<f64>() / n as f64).sqrt();
        // A load without scatter has none to judge.
        if component.sigma.is_none_or(|sigma| sigma <= ROUNDING * size) {
            continue;
        }
        let load = &model.law.responses[r];
        let mut found = Vec::new();
        // One row that lies apart is that, and no scatter that grows: the others are asked.
        let apart = outlying.iter().find(|(of, _)| of == load).map(|(_, row)| *row);
        let grows = uneven(model, data, load, (&without(residuals, apart, n), predicted), loads);
        let alike = serial(model, data, load, (residuals, grows.is_some()), loads);
        let is_series = alike.is_some() && motions::is_in_time(data);
        found.extend(alike);
        // The others take rows for independent, and mean nothing where these follow each other in time. Elsewhere an offset of a setup may be what makes rows alike.
        if is_series {
            out.extend(found.into_iter().map(|finding| (load.clone(), finding)));
            continue;
        }
        found.extend(grows);
        found.extend(offset(model, data, load, residuals, loads));
        out.extend(found.into_iter().map(|finding| (load.clone(), finding)));
    }
    out
}

/// The residuals of the other rows; what was fitted to all takes the same of them.
fn without(residuals: &Residuals, row: Option<usize>, n: usize) -> Residuals {
    let kept: Vec<usize> =
        (0..residuals.rows.len()).filter(|i| row.is_none_or(|row| residuals.rows[*i] % n != row)).collect();
    Residuals {
        rows: kept.iter().map(|&i| residuals.rows[i]).collect(),
        residual: kept.iter().map(|&i| residuals.residual[i]).collect(),
        q: Mat::from_fn(kept.len(), residuals.q.ncols(), |i, k| residuals.q[(kept[i], k)]),
    }
}

/// The residuals of rows drawn from many: what was fitted takes next to nothing of them.
fn of_sample(model: &ModelFit, data: &Dataset) -> Vec<Residuals> {
    let n = data.rows;
    let of = |r: usize| {
        let rows: Vec<usize> = (r * n..(r + 1) * n).collect();
        let weight = |i: usize| model.problem.weight.as_ref().map_or(1.0, |w| w[i]);
        Residuals {
            residual: rows.iter().map(|&i| model.fit.residuals[i] * weight(i).sqrt()).collect(),
            q: Mat::zeros(n, 0),
            rows,
        }
    };
    (0..model.law.responses.len()).map(of).collect()
}

/// Whether errors of runs or setups are declared that the fit does not hold.
fn has_declared_groups(model: &ModelFit) -> bool {
    model.whitened.is_none() && model.declares_groups() && model.declared.ncols() == 0
}

/// Residuals that are alike from one row to the next.
fn serial(
    model: &ModelFit,
    data: &Dataset,
    load: &str,
    (residuals, is_uneven): (&Residuals, bool),
    loads: f64,
) -> Option<Finding> {
    // Clusters and rows in time already include it; HC3 and runs do not. The test assumes errors of equal size, so only clear cases are reported where they are not.
    let is_asked = matches!(model.scatter, Scatter::Classical | Scatter::Runs | Scatter::Hc3);
    if !is_asked || model.is_in_time(data) || has_declared_groups(model) {
        return None;
    }
    let (statistic, p) = if data.sample.is_some() {
        // Of very many rows it is normal about 2 with a variance of 4/n.
        let component = model.fit.components.iter().find(|c| c.name == load)?;
        let statistic = component.durbin_watson?;
        (statistic, normal_upper(0.5 * (2.0 - statistic) * (component.n as f64).sqrt()))
    } else {
        let statistic = Form::Steps.statistic(&residuals.residual)?;
        (statistic, 1.0 - above(Form::Steps, residuals.q.as_ref(), statistic)?)
    };
    let is_unequal = matches!(model.scatter, Scatter::Hc3) || matches!(model.scatter, Scatter::Runs) && is_uneven;
    let level = if is_unequal { 0.1 * ALARM_OF_FEW } else { ALARM_OF_FEW };
    (p < level / loads).then(|| {
        let text = format!(
            "{}, {load}: residuals of successive rows are alike (Durbin–Watson {statistic:.2}, 2 where independent, {}): intervals assume \
             independent rows and are too narrow. {}; a law that follows the drift removes it",
            model.law.name,
            p_equation(p),
            if data.group.is_some() && data.clusters() >= FEWEST_CLUSTERS {
                "covariance = \"cluster\" assumes only that the groups are independent"
            } else {
                "covariance = \"serial\" models the correlation of successive rows"
            }
        );
        Finding::new(Severity::Warning, "serial-correlation", text)
    })
}

/// What errors may go with.
struct With {
    words: String,
    z: Vec<f64>,
    level: f64,
}

/// Errors that grow or fall with the load, or with a channel of the law.
fn uneven(
    model: &ModelFit,
    data: &Dataset,
    load: &str,
    (residuals, predicted): (&Residuals, &[f64]),
    loads: f64,
) -> Option<Finding> {
    // HC3 and clusters do not assume even scatter. Runs do not either, but they are tested because the search for misfit shapes assumes it.
    if !matches!(model.scatter, Scatter::Classical | Scatter::Runs) {
        return None;
    }
    let n = data.rows;
    let is_one = |z: &[f64]| z.iter().all(|x| (x - z[0]).abs() <= 1e-6 * z[0].abs().max(f64::MIN_POSITIVE));
    let channels: Vec<&str> =
        model.law.channels().into_iter().filter(|c| !matches!(*c, "density" | "n_links")).collect();
    let of_channel = |name: &&str| {
        let values = data.values(name)?;
        let z: Vec<f64> = residuals.rows.iter().map(|row| values[row % n].abs()).collect();
        (!is_one(&z)).then(|| With { words: format!("|{name}|"), z, level: 0.0 })
    };
    let mut tried: Vec<With> = channels.iter().filter_map(of_channel).collect();
    let count = tried.len().max(1) as f64;
    for with in &mut tried {
        with.level = ON_CHANNELS * ALARM / (loads * count);
    }
    // Of errors that go with the load the logarithm tells twice as many as the load itself: few large loads tell the latter.
    let largest = predicted.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    let z: Vec<f64> =
        residuals.rows.iter().map(|row| predicted[row % n].abs().max(LEAST_LOAD * largest).ln()).collect();
    let on_load = if tried.is_empty() { 1.0 } else { 1.0 - ON_CHANNELS };
    if largest > 0.0 && !is_one(&z) {
        tried.insert(0, With { words: format!("the fitted |{load}|"), z, level: on_load * ALARM / loads });
    }
    let found = tried.into_iter().find_map(|with| {
        let form = Form::Weighted(&with.z);
        let above = above(form, residuals.q.as_ref(), form.statistic(&residuals.residual)?)?;
        let p = 2.0 * above.min(1.0 - above);
        (p < with.level).then_some((with.words, above < 0.5, p))
    });
    let (words, grows, p) = found?;
    let is_weighted = model.is_weighted();
    let has_std = data.values(&format!("std_{load}")).is_some();
    let (assumed, advice) = match (model.law.in_logarithms(), is_weighted) {
        (true, false) => ("equal relative errors", "compare with the fit in newtons"),
        (true, true) => ("relative errors as in the std columns", "compare with the fit in newtons"),
        (false, false) => ("equal absolute errors", "weights = \"fitted\", std columns, or covariance = \"HC3\""),
        (false, true) if has_std => {
            ("errors as in the std columns", "check these columns, or use covariance = \"HC3\"")
        }
        (false, true) => ("errors as in the fitted weights", "covariance = \"HC3\""),
    };
    let text = format!(
        "{}, {load}: errors{} {} with {words} ({}{}): {assumed} are not what the data show, and intervals assume them; use {advice}",
        model.law.name,
        if is_weighted { " over their weights" } else { "" },
        if grows { "grow" } else { "fall" },
        p_equation(p),
        if data.sample.is_some() { format!(", in a sample of {}", data.rows) } else { String::new() },
    );
    Some(Finding::new(
        Severity::Warning,
        "uneven-scatter",
        text.replace("use compare", "compare").replace("use check", "check"),
    ))
}

/// An offset of each setup, or each group, that nobody declared.
fn offset(model: &ModelFit, data: &Dataset, load: &str, residuals: &Residuals, loads: f64) -> Option<Finding> {
    let is_of_rows = matches!(model.scatter, Scatter::Classical | Scatter::Runs);
    if !is_of_rows || data.sample.is_some() || has_declared_groups(model) || model.whitened.is_some() {
        return None;
    }
    let n = data.rows;
    let groupings = groupings(data);
    // Columns that name the same rows are one.
    let distinct_ones: std::collections::BTreeSet<Vec<usize>> =
        groupings.iter().map(|(_, texts)| labels(*texts)).collect();
    let level = ALARM_OF_FEW / (loads * distinct_ones.len().max(1) as f64);
    for (by, texts) in groupings {
        let group = labels(texts);
        let count = distinct(texts).len();
        let of_row: Vec<usize> = residuals.rows.iter().map(|row| group[row % n]).collect();
        let mut size = vec![0; count];
        for g in &of_row {
            size[*g] += 1;
        }
        // Single rows have no scatter within.
        if count < 2 || size.iter().filter(|s| **s >= 2).count() < 2 || of_row.len() * count * count > MOST_WORK {
            continue;
        }
        let Some((f, dof)) = between(residuals, &of_row, count) else { continue };
        let p = f_upper(f, dof[0], dof[1]);
        if p < level {
            let shared = if by == "group" { "setup" } else { by };
            let text = format!(
                "{}, {load}: offsets from {by} to {by} are larger than the scatter within (F({}, {}) = {f:.1}, {}), and no error of a {by} is \
                 declared: intervals take its rows for independent and are too narrow. Declare it ([[source.uncertainty]], shared = \"{shared}\"), estimate it \
                 (group = \"{by}\", group_offset = \"estimate\"), or {}",
                model.law.name,
                dof[0],
                dof[1].round(),
                p_equation(p),
                if count >= FEWEST_CLUSTERS {
                    format!("take each {by} for one observation (group = \"{by}\", covariance = \"cluster\")")
                } else {
                    format!("record more of them: {count} are too few for covariance = \"cluster\"")
                }
            );
            return Some(Finding::new(Severity::Warning, "setup-offset", text));
        }
    }
    None
}

/// Columns that may hold what rows share.
fn groupings(data: &Dataset) -> Vec<(&'static str, &Texts)> {
    let named = |texts: &&Texts| texts.iter().any(|t| !t.is_empty());
    let group = data.group.iter().map(|group| ("group", group));
    [("setup", &data.setup), ("run", &data.run)].into_iter().chain(group).filter(|(_, texts)| named(texts)).collect()
}

/// F of one offset per group, and its degrees of freedom; `None` where the law and the offsets cannot be distinguished.
///
/// The offsets' columns, cleared of what was fitted, take a part of the sum of squares of rank m off it: F = (part/m)/(rest/ν).
fn between(residuals: &Residuals, of_row: &[usize], groups: usize) -> Option<(f64, [f64; 2])> {
    let n = residuals.q.nrows();
    let mut columns = Mat::zeros(n, groups);
    for (i, &g) in of_row.iter().enumerate() {
        columns[(i, g)] = 1.0;
    }
    let onto = residuals.q.transpose() * &columns;
    let cleared = &columns - &residuals.q * &onto;
    let problem =
        fit::Problem::single(cleared, residuals.residual.clone(), (0..groups).map(|g| format!("offset {g}")).collect());
    let fitted = fit::fit(&problem, &fit::Options::default()).ok()?;
    let (of_offsets, left) = (fitted.components[0].rank as f64, fitted.components[0].rss);
    let all: f64 = residuals.residual.iter().map(|r| r * r).sum();
    let dof = n as f64 - residuals.leverage().iter().sum::<f64>() - of_offsets;
    // A setup per speed leaves one offset or none beside the law.
    (of_offsets >= 1.0 && dof >= 1.0 && left > 0.0)
        .then(|| ((all - left) / of_offsets / (left / dof), [of_offsets, dof]))
}
