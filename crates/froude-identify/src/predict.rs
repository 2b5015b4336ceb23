//! What a record's law gives on rows that it was not fitted to, beside what was measured there.
//!
//! In a row the law gives F = F(x; β) with Cov(F) = X·Cov(β)·Xᵀ, X = ∂F/∂β: scatter and every declared error of the record. A single measurement scatters about it by s: its own standard uncertainty where the table states one (`std_f_x`), and else the residual standard deviation of the record, which holds what the law itself misses. The band of one law is F ± k u_law; a measurement errs by e = measured − F with u² = u_law² + s². k is Student's at the degrees of freedom of Welch and Satterthwaite.
//!
//! The band of a record is the envelope of the bands of all laws that its data do not contradict, the chosen one among them. E_n = e/U, U being the distance from F to the end of the envelope of F ± k u on the side of the measured load: |E_n| exceeds 1 by chance in at most 5.5 % of rows, whichever compared law is true.
//!
//! Rows of one record err together: a coefficient that is too large is so in all of them. So one number judges all rows, χ² = eᵀ(X Cov(β) Xᵀ + diag s²)⁻¹e, which has a mean of as many as there are rows. Where s was estimated, χ²/n is compared with F(n, ν) and not with χ². A record whose scatter is that of clusters has no such p. Of several laws with the same loads χ² is that of the one that agrees best.
//!
//! An error that the table has too (the same balance, the same tank) is counted as if it had none: the record cannot know it.
//!
//! Sources: GUM (JCGM 100:2008) 5.2.2 and G.4; ISO 13528:2022, 9.7 (E_n).

use faer::Mat;
use faer::linalg::solvers::Solve as _;
use froude_fit::distribution::{coverage_factor, f_upper};
use froude_records::estimate::Estimate;
use froude_records::units::Dimension;
use indexmap::IndexMap;

use crate::dataset::{Dataset, unit_text};
use crate::error::IdentifyError;
use crate::law::{ForceLaw, is_torque};

/// Of the water, and not of the motion: no law is extrapolated in it.
const OF_WATER: &str = "temperature";
/// Beyond the end of a range by rounding.
const ROUNDING: f64 = 1e-9;

/// A law on the rows of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// Id of the estimate.
    pub id: String,
    /// Name of its law.
    pub law: String,
    /// Ids of the laws whose envelope the bands are, the estimate first.
    pub laws: Vec<String>,
    /// Ids of laws that belong to the envelope and read what the rows lack.
    pub left_out: Vec<String>,
    /// Loads, row by row.
    pub rows: Vec<Row>,
    /// All rows with a measurement inside of what the record covers; `None` where there is none, or no scatter is known.
    pub joint: Option<Joint>,
}

/// A load in a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Of the data set.
    pub row: usize,
    /// Name of the load.
    pub load: String,
    /// Its unit, and that of all numbers here.
    pub unit: String,
    /// F.
    pub predicted: f64,
    /// Standard uncertainty of F if its law is true; `None` where the record states no covariance.
    pub u_law: Option<f64>,
    /// 95 % band of F over all laws; `None` also where a coefficient that it goes with has no interval, as one cluster decides it.
    pub band_95: Option<[f64; 2]>,
    /// The same of a single measurement.
    spread_95: Option<[f64; 2]>,
    /// What was measured.
    pub measured: Option<f64>,
    /// Standard deviation of a single measurement; `None` where neither table nor record states one.
    pub scatter: Option<f64>,
    /// E_n of the error \[-\].
    pub e_n: Option<f64>,
    /// What the record does not cover: the names of its ranges that the row lies outside of.
    pub outside: Vec<String>,
}

impl Row {
    /// Measured less predicted.
    #[must_use]
    pub fn error(&self) -> Option<f64> {
        Some(self.measured? - self.predicted)
    }
}

/// One number over all rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// χ² \[-\].
    pub chi_squared: f64,
    /// Loads in rows, n.
    pub n: usize,
    /// Degrees of freedom of the scatter, least of the loads; infinite where the table states it.
    pub dof: f64,
    /// How often chance alone gives as much; `None` of a record whose scatter is that of clusters: rows of one err alike, and are not so many errors.
    pub p: Option<f64>,
}

/// A record's law on the rows of a data set; `others` are the laws beside it that its data do not contradict.
///
/// # Errors
///
/// The law gives no forces, reads a channel that the data lack, or has a coefficient without a value. Other laws with such a fault are listed in `left_out`.
pub fn predict(estimate: &Estimate, others: &[&Estimate], data: &Dataset) -> Result<Predicted, IdentifyError> {
    let mut out = by_law(estimate, data)?;
    for other in others {
        let beside = match by_law(other, data) {
            Ok(beside) => beside,
            Err(_) => {
                out.left_out.push(other.id.clone());
                continue;
            }
        };
        let mut first: IndexMap<&String, usize> = IndexMap::new();
        for (place, row) in beside.rows.iter().enumerate() {
            first.entry(&row.load).or_insert(place);
        }
        for row in &mut out.rows {
            // A law without this load says nothing of its band.
            let Some(of_other) = first.get(&row.load).and_then(|first| beside.rows.get(first + row.row)) else {
                continue;
            };
            let around = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.min(c), b.max(d)];
            row.band_95 = row.band_95.zip(of_other.band_95).map(|(own, other)| around(own, other));
            row.spread_95 = row.spread_95.zip(of_other.spread_95).map(|(own, other)| around(own, other));
        }
        let p = |joint: &Option<Joint>| joint.and_then(|joint| joint.p);
        // χ² of fewer loads is another question.
        let gives_all = out.rows.iter().all(|row| first.contains_key(&row.load));
        if gives_all && p(&beside.joint).zip(p(&out.joint)).is_some_and(|(other, own)| other > own) {
            out.joint = beside.joint;
        }
        out.laws.extend(beside.laws);
    }
    for row in &mut out.rows {
        row.e_n = row.error().zip(row.spread_95).and_then(|(error, [low, high])| {
            let reach = if error < 0.0 { row.predicted - low } else { high - row.predicted };
            (reach > 0.0).then_some(error / reach)
        });
    }
    Ok(out)
}

/// The same of one law.
fn by_law(estimate: &Estimate, data: &Dataset) -> Result<Predicted, IdentifyError> {
    let data = &with_loads(estimate, data);
    let law = ForceLaw::of_estimate(estimate, data)?;
    let unknown = |name: &str| {
        IdentifyError::Refused(format!(
            "estimate {}: {name} has no value, as its data do not determine it; forces follow from a law whose coefficients all have one",
            estimate.id
        ))
    };
    let values = law.values_of(estimate).map_err(unknown)?;
    let forces = law.predict(data, &values)?;
    let slopes = Slopes::of(estimate, &law, &law.regressors(data, &values)?);
    let refused = estimate.without_interval();
    let mut rows = Vec::with_capacity(forces.len());
    let mut inside = Vec::new();
    let mut dof = f64::INFINITY;
    for (response, load) in law.responses.iter().enumerate() {
        let measured = data.values(load).unwrap_or_default();
        let stated = data.values(&format!("std_{load}"));
        // That of a fit in logarithms is a part of the load.
        let sigma = |force: f64| match estimate.run_scatter.get(load) {
            Some(runs) => Some(runs.constant.value.hypot(runs.part * force)),
            None => estimate.sigma.get(load).map(|s| if law.in_logarithms() { s.value * force.abs() } else { s.value }),
        };
        let of_runs = estimate.run_scatter.get(load).map(|runs| runs.dof);
        let of_sigma = of_runs.or_else(|| estimate.dof.get(load).copied()).flatten().unwrap_or(f64::INFINITY);
        for row in 0..data.rows {
            let place = response * data.rows + row;
            let scatter = stated.map(|stated| stated[row]).or_else(|| sigma(forces[place])).filter(|s| *s > 0.0);
            let line = slopes.as_ref().map(|slopes| slopes.line(place)).unwrap_or_default();
            let parts = slopes.as_ref().map(|slopes| slopes.parts(&line));
            let u_law = parts.as_ref().map(|parts| combined(parts).0);
            // One cluster decides: as for a coefficient, there is no quantile.
            let has_quantile = slopes.as_ref().is_none_or(|slopes| !slopes.moves_with(&line, &refused));
            let measured = measured.get(row).copied().filter(|v| v.is_finite());
            let outside = outside(estimate, data, row);
            let own = (scatter.unwrap_or(0.0), if stated.is_some() { f64::INFINITY } else { of_sigma });
            let (u, all_dof) = combined(&[parts.clone().unwrap_or_default(), vec![own]].concat());
            let about = |half: f64| [forces[place] - half, forces[place] + half];
            if measured.is_some() && scatter.is_some() && outside.is_empty() {
                inside.push((place, measured.unwrap_or_default() - forces[place], own.0));
                dof = dof.min(own.1);
            }
            rows.push(Row {
                row,
                load: load.clone(),
                unit: unit_text(data, load),
                predicted: forces[place],
                u_law,
                band_95: parts
                    .filter(|_| has_quantile)
                    .map(|parts| combined(&parts))
                    .map(|(u, dof)| about(coverage_factor(0.95, dof) * u)),
                spread_95: has_quantile.then(|| about(coverage_factor(0.95, all_dof) * u)),
                measured,
                scatter,
                e_n: None,
                outside,
            });
        }
    }
    let joint = chi_squared(slopes.as_ref(), &inside).map(|chi_squared| {
        let n = inside.len();
        let p = estimate.clusters.is_none().then(|| f_upper(chi_squared / n as f64, n as f64, dof));
        Joint { chi_squared, n, dof, p }
    });
    let id = estimate.id.clone();
    Ok(Predicted { laws: vec![id.clone()], left_out: Vec::new(), id, law: estimate.law.name.clone(), rows, joint })
}

/// A load of a record's law in the first row of a data set, and in each row less that in the first, with standard uncertainty and degrees of freedom where the record states a covariance. A law that has no value
/// in the first row, as a power law at rest, is zero there.
///
/// # Errors
///
/// As [`predict`]; a load that the law does not give.
pub(crate) fn above_first(
    estimate: &Estimate,
    data: &Dataset,
    load: &str,
) -> Result<(f64, Vec<(f64, Option<(f64, f64)>)>), IdentifyError> {
    let data = &with_loads(estimate, data);
    let law = ForceLaw::of_estimate(estimate, data)?;
    let no_value = |name: &str| IdentifyError::Refused(format!("estimate {}: {name} has no value", estimate.id));
    let values = law.values_of(estimate).map_err(no_value)?;
    let response = law.responses.iter().position(|own| own == load).ok_or_else(|| no_value(load))?;
    let forces = law.predict(data, &values)?;
    let slopes = Slopes::of(estimate, &law, &law.regressors(data, &values)?);
    let refused = estimate.without_interval();
    let known = |x: f64| if x.is_finite() { x } else { 0.0 };
    let first = response * data.rows;
    let rest = known(forces[first]);
    let of = |place: usize| {
        let uncertainty = slopes.as_ref().and_then(|slopes| {
            let at_rest = slopes.line(first).into_iter().map(known);
            let x: Vec<f64> = slopes.line(place).iter().zip(at_rest).map(|(x, rest)| x - rest).collect();
            (!slopes.moves_with(&x, &refused)).then(|| combined(&slopes.parts(&x)))
        });
        (forces[place] - rest, uncertainty)
    };
    Ok((rest, (first..first + data.rows).map(of).collect()))
}

/// The data with a channel for each load of the law: formulas need its unit, and what was not measured is no number.
fn with_loads(estimate: &Estimate, data: &Dataset) -> Dataset {
    let mut data = data.clone();
    let mut loads: Vec<String> = estimate.law.outputs.keys().cloned().collect();
    loads.extend(["f_x", "f_y"].map(str::to_owned));
    for load in loads {
        if data.values(&load).is_none() {
            let dimension = if is_torque(&load) { Dimension::MOMENT } else { Dimension::FORCE };
            data.put(&load, vec![f64::NAN; data.rows], dimension);
        }
    }
    data
}

/// The ranges of a record that a row lies outside of.
fn outside(estimate: &Estimate, data: &Dataset, row: usize) -> Vec<String> {
    let is_out = |name: &str| match (estimate.validity.get(name), data.values(name)) {
        (Some(range), Some(values)) => {
            let margin = ROUNDING * range.low.abs().max(range.high.abs());
            !(range.low - margin..=range.high + margin).contains(&values[row])
        }
        _ => false,
    };
    estimate.validity.keys().filter(|name| *name != OF_WATER && is_out(name)).cloned().collect()
}

/// Standard uncertainty of a sum of independent parts, and its degrees of freedom by Welch and Satterthwaite.
pub(crate) fn combined(parts: &[(f64, f64)]) -> (f64, f64) {
    let square: f64 = parts.iter().map(|(u, _)| u * u).sum();
    let fourth: f64 = parts.iter().map(|(u, dof)| u.powi(4) / dof).sum();
    (square.sqrt(), if fourth > 0.0 { square * square / fourth } else { f64::INFINITY })
}

/// The covariance of a record as rows of forces see it.
struct Slopes<'a> {
    estimate: &'a Estimate,
    /// A column per name of the covariance.
    x: Mat<f64>,
    covariance: Mat<f64>,
    names: Vec<String>,
}

impl<'a> Slopes<'a> {
    fn of(estimate: &'a Estimate, law: &ForceLaw, regressors: &Mat<f64>) -> Option<Self> {
        let stated = estimate.covariance()?;
        let places: Vec<Option<usize>> = stated.names.iter().map(|name| law.position(name)).collect();
        let p = places.len();
        let x = Mat::from_fn(regressors.nrows(), p, |i, j| places[j].map_or(0.0, |place| regressors[(i, place)]));
        let covariance = Mat::from_fn(p, p, |i, j| stated.matrix[i][j]);
        Some(Self { estimate, x, covariance, names: stated.names.clone() })
    }

    /// The derivatives of a force.
    fn line(&self, row: usize) -> Vec<f64> {
        (0..self.x.ncols()).map(|j| self.x[(row, j)]).collect()
    }

    /// Whether a force goes with one of some coefficients.
    fn moves_with(&self, x: &[f64], some: &[&str]) -> bool {
        self.names.iter().zip(x).any(|(name, x)| *x != 0.0 && some.contains(&name.as_str()))
    }

    /// Standard uncertainty of a force by its scatter and by each declared error, with their degrees of freedom.
    fn parts(&self, x: &[f64]) -> Vec<(f64, f64)> {
        let own = self.estimate.type_a.as_ref().map(|own| {
            let along = |line: &Vec<f64>| line.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
            let square: f64 = own.matrix.iter().zip(x).map(|(line, x)| x * along(line)).sum();
            let moves = own.dof.iter().zip(x).filter(|(_, x)| **x != 0.0);
            // The least certain of the coefficients that the force goes with.
            let dof = moves.filter_map(|(dof, _)| *dof).fold(f64::INFINITY, f64::min);
            (square.max(0.0).sqrt(), dof)
        });
        let declared = self.estimate.errors.values().map(|error| {
            let q = error.covariance.len();
            let moved: Vec<f64> = (0..q)
                .map(|k| error.sensitivity.iter().zip(x).map(|(s, x)| s.get(k).copied().unwrap_or(0.0) * x).sum())
                .collect();
            (error.between(&moved, &moved).max(0.0).sqrt(), error.dof.unwrap_or(f64::INFINITY))
        });
        own.into_iter().chain(declared).collect()
    }
}

/// eᵀ(X C Xᵀ + D)⁻¹e of rows (place, e, s), D = diag s²: by the matrix of p × p, `eᵀD⁻¹e − gᵀ(1 + C G)⁻¹C g` with `G = XᵀD⁻¹X` and `g = XᵀD⁻¹e` (Woodbury).
fn chi_squared(slopes: Option<&Slopes<'_>>, rows: &[(usize, f64, f64)]) -> Option<f64> {
    if rows.is_empty() {
        return None;
    }
    let alone: f64 = rows.iter().map(|(_, e, s)| (e / s).powi(2)).sum();
    let Some(Slopes { x, covariance, .. }) = slopes else { return Some(alone) };
    let p = x.ncols();
    let sum = |of: &dyn Fn(&(usize, f64, f64)) -> f64| rows.iter().map(of).sum::<f64>();
    let g = Mat::from_fn(p, 1, |j, _| sum(&|(row, e, s)| x[(*row, j)] * e / (s * s)));
    let gram = Mat::from_fn(p, p, |i, j| sum(&|(row, _, s)| x[(*row, i)] * x[(*row, j)] / (s * s)));
    let one = Mat::<f64>::identity(p, p);
    let moved = covariance * &g;
    let solved = (one + covariance * gram).partial_piv_lu().solve(&moved);
    let taken: f64 = (0..p).map(|j| g[(j, 0)] * solved[(j, 0)]).sum();
    Some((alone - taken).max(0.0)).filter(|found| found.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_fit::distribution::chi_squared_upper;

    /// (X C Xᵀ + D)⁻¹ written out.
    #[test]
    fn the_joint_number_is_that_of_the_whole_matrix() {
        let x = Mat::from_fn(5, 2, |i, j| ((1 + i + 3 * j) as f64).sin() + j as f64);
        let covariance = Mat::from_fn(2, 2, |i, j| [[0.3, 0.1], [0.1, 0.2]][i][j]);
        let rows: Vec<(usize, f64, f64)> = (0..5).map(|i| (i, (i as f64).cos(), 0.2 + 0.1 * i as f64)).collect();
        let estimate = Estimate::default();
        let slopes = Slopes { estimate: &estimate, x: x.clone(), covariance: covariance.clone(), names: Vec::new() };
        let whole = Mat::from_fn(5, 5, |i, j| {
            let d = if i == j { rows[i].2 * rows[i].2 } else { 0.0 };
            d + (0..2).map(|a| (0..2).map(|b| x[(i, a)] * covariance[(a, b)] * x[(j, b)]).sum::<f64>()).sum::<f64>()
        });
        let e = Mat::from_fn(5, 1, |i, _| rows[i].1);
        let solved = whole.partial_piv_lu().solve(&e);
        let expected: f64 = (0..5).map(|i| e[(i, 0)] * solved[(i, 0)]).sum();
        let found = chi_squared(Some(&slopes), &rows).unwrap();
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        assert_eq!(chi_squared(Some(&slopes), &[]), None);
        assert!((f_upper(1.2, 5.0, f64::INFINITY) - chi_squared_upper(6.0, 5.0)).abs() < 1e-15);
    }

    #[test]
    fn parts_combine_by_welch_and_satterthwaite() {
        assert_eq!(combined(&[(3.0, f64::INFINITY), (4.0, f64::INFINITY)]), (5.0, f64::INFINITY));
        let (u, dof) = combined(&[(1.0, 4.0), (1.0, 4.0)]);
        assert!((u - 2.0_f64.sqrt()).abs() < 1e-15 && (dof - 8.0).abs() < 1e-12);
        assert_eq!(combined(&[]), (0.0, f64::INFINITY));
    }
}
