//! Rows that the scatter of the others does not explain.
//!
//! The residual of row i over its own standard deviation, that one from the other rows (externally studentised):
//! t = r √w / (s₍ᵢ₎ √(1 − h)), s₍ᵢ₎² = ((n − p) s² − w r²/(1 − h))/(n − p − 1). It is of Student's t with n − p − 1 degrees of freedom; of n rows one is named
//! where n P(|T| ≥ |t|) is below 0.4 % over the loads of the law.
//!
//! Nothing is left out: whether a row is a mistake is in its log, not in its residual. A slip at a large speed makes the scatter look uneven, so a row is
//! named only if the scatter is even without it and it still stands out under a growing variance: σ² = a + b z² fitted to the other rows or, with too few rows for that, σ ∝ f. z is the
//! load f, the speed, the sine or cosine of the angle or a channel of the law, whichever gives the other residuals the highest likelihood, if that tells growth from an even variance
//! (−2 ln L falls by 4, and by 12 where it alone names a row). For example, the noise of a load cell mounted across the rail enters f_x in proportion to the sine of the angle.
//! Otherwise, if the scatter grows without a row or weights were fitted, the row is judged by σ² = a + b z² alone. Where the variance is fitted, t has a third of the degrees of freedom,
//! because it rests on the few rows near that z. HC3 without weights declares that the scatter is uneven and not how: the level is then 0.04 %, and the second of these tests is
//! left out. Skipped for rows in time, for a sample of the rows, and where σ is not a least-squares σ: with errors in variables and with constraints
//! that hold.
//!
//! **Source.** Cook & Weisberg (1982), *Residuals and Influence in Regression*, 2.2.2.

use std::collections::BTreeSet;

use froude_fit::distribution::t_two_sided;
use froude_records::finding::{Finding, Severity};
use froude_records::number::{plain, significant};

use crate::dataset::{Dataset, unit_text};
use crate::regression::{ModelFit, Scatter, Variance};
use crate::unevenness::{FEWEST_FOR_SCATTER, Unevenness};

/// Chance of naming a row where all are sound, over all loads of a law.
const FALSE_ALARM: f64 = 0.004;
/// Fewest degrees of freedom of the other rows; with one, only a row almost a thousand standard deviations away is named.
const FEWEST_DOF: f64 = 1.0;
/// Fraction of the degrees of freedom available for the scatter at one load.
const AT_ONE_LOAD: f64 = 1.0 / 3.0;
/// Smallest decrease of −2 ln L at which a growing variance can excuse a row: two standard deviations of one coefficient.
const LEAST_FALL: f64 = 4.0;
/// Smallest decrease at which a growing variance alone can name a row: it occurs by chance in one table in two hundred (three loads, six variates each).
const LEAST_FALL_ALONE: f64 = 12.0;
/// A fit without error has no scatter to compare with.
const ROUNDING: f64 = 1e-9;

/// Fitted loads below this fraction of the largest are raised to it.
const LEAST_LOAD: f64 = 0.02;
/// Nearer to 1 than this a row alone determines a coefficient, and has no residual.
const ALONE: f64 = 1e-8;

/// A row, its residual and that in standard deviations of the others.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Outlying {
    row: usize,
    residual: f64,
    t: f64,
}

/// The most outlying row of each component that has one, beside component and row.
pub(crate) fn outlying_rows(model: &ModelFit, data: &Dataset) -> (Vec<(String, usize)>, Vec<Finding>) {
    if data.sample.is_some() || model.in_variables || model.is_in_time(data) {
        return (Vec::new(), Vec::new());
    }
    let (mut loads, mut out) = (Vec::new(), Vec::new());
    for (r, component) in model.law.responses.iter().enumerate() {
        let is_even = |found: &Outlying| {
            !uneven_without(model, data, r, *found).is_some_and(Unevenness::contradicts)
                && is_beyond_growth(model, data, r, *found)
        };
        let of_all = outlying(model, data.rows, r).filter(is_even).map(|found| (found, "of the other rows".to_owned()));
        let of_like = || {
            let (found, with) = by_growth(model, data, r)?;
            Some((found, format!("of comparable rows{with}")))
        };
        let Some((Outlying { row, residual, t }, by)) = of_all.or_else(of_like) else { continue };
        loads.push((component.clone(), row));
        let unit = if model.law.in_logarithms() { String::new() } else { format!(" {}", unit_text(data, component)) };
        let at = data.values("speed").map_or_else(String::new, |v| format!(" ({} m/s)", plain(v[row].abs(), 4)));
        out.push(Finding::new(
            Severity::Warning,
            "outlying-row",
            format!(
                "{}, {component}: {}{at} lies {}{unit} from the law, {t:.1} standard deviations {by}; it is used. Look at what was \
                 recorded: leave it out (`keep`) for a reason that you can state, or state the result with and without it",
                model.law.name,
                data.row_name(row),
                significant(residual, 3),
            ),
        ));
    }
    (loads, out)
}

fn has_weights(model: &ModelFit, r: usize) -> bool {
    let is_one = |w: &[f64]| model.problem.rows_of(r).iter().all(|i| w[*i] == 1.0);
    !model.problem.weight.as_ref().is_none_or(|w| is_one(w))
}

/// Whether the scatter is declared to be uneven, and not how.
fn is_of_unstated_form(model: &ModelFit, r: usize) -> bool {
    matches!(model.scatter, Scatter::Hc3) && !has_weights(model, r)
}

/// The part of the level that is left where an even scatter is not to be expected.
fn level_of(model: &ModelFit, r: usize) -> f64 {
    if is_of_unstated_form(model, r) { 0.1 } else { 1.0 }
}

/// The row of a component that the others explain least, if by less than chance.
fn outlying(model: &ModelFit, n: usize, r: usize) -> Option<Outlying> {
    let summary = &model.fit.components[r];
    let sigma = summary.sigma.filter(|_| summary.relative_residual > ROUNDING)?;
    let squares = summary.dof * sigma * sigma;
    let dof = summary.dof - 1.0;
    if dof < FEWEST_DOF || (squares / summary.rss - 1.0).abs() > ROUNDING.sqrt() {
        return None;
    }
    let of_row = |row: usize| {
        let i = r * n + row;
        let weight = model.problem.weight.as_ref().map_or(1.0, |w| w[i]);
        let (residual, free) = (model.fit.residuals[i], 1.0 - model.fit.leverage[i]);
        let own = weight * residual * residual / free;
        // Where nothing is left for the others, they fit without it.
        let t = (own * dof / (squares - own).max(ROUNDING * squares)).sqrt();
        (free > ALONE).then_some(Outlying { row, residual, t })
    };
    let most = (0..n).filter_map(of_row).filter(|found| !found.t.is_nan()).max_by(|a, b| a.t.total_cmp(&b.t))?;
    let loads = model.law.responses.len() as f64;
    (t_two_sided(most.t, dof) * n as f64 * loads < FALSE_ALARM * level_of(model, r)).then_some(most)
}

/// The row furthest from the law relative to the scatter of comparable rows, and with which variate that grows, in words; `None` if the scatter is even and no weights were fitted, or if chance
/// explains the row.
fn by_growth(model: &ModelFit, data: &Dataset, r: usize) -> Option<(Outlying, String)> {
    let load = &model.law.responses[r];
    let rows = model.problem.rows_of(r);
    let is_fitted = has_weights(model, r) && data.values(&format!("std_{load}")).is_none();
    let summary = &model.fit.components[r];
    let dof = AT_ONE_LOAD * (summary.dof - 1.0);
    let is_meant = summary.relative_residual > ROUNDING && model.whitened.is_none() && !model.law.in_logarithms();
    if !is_meant || dof < FEWEST_DOF || model.fit.optimality.is_some() || is_of_unstated_form(model, r) {
        return None;
    }
    let free = |i: usize| (1.0 - model.fit.leverage[i]).max(ALONE);
    let square = |i: &usize| model.fit.residuals[*i].powi(2) / free(*i);
    let squares: Vec<f64> = rows.iter().map(square).collect();
    let variates = variates(model, data, r);
    // A variate that an outlier follows explains it, so each variate names a candidate, which its own growth is then fitted without.
    let furthest = |with: &Variate| {
        let growth = Growth::of(&squares, &rows, with)?;
        rows.iter().copied().max_by(|a, b| (square(a) / growth.at(*a)).total_cmp(&(square(b) / growth.at(*b))))
    };
    let candidates: BTreeSet<usize> = variates.iter().filter_map(furthest).collect();
    let of = |row: usize| {
        let others: Vec<usize> = rows.iter().copied().filter(|i| *i != row).collect();
        let growth = likeliest(&others.iter().map(square).collect::<Vec<_>>(), &others, &variates)?;
        let with = format!(" (the scatter grows with the {})", growth.with.name);
        let is_clear = growth.fall > LEAST_FALL_ALONE;
        let with = if is_clear { with } else { String::new() };
        (is_clear || is_fitted).then(|| (row, (square(&row) / growth.at(row)).sqrt(), with))
    };
    let (row, t, with) = candidates.into_iter().filter_map(of).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let looks = (rows.len() * model.law.responses.len()) as f64;
    let found = Outlying { row: row % data.rows, residual: model.fit.residuals[row], t };
    (t_two_sided(t, dof) * looks < FALSE_ALARM).then_some((found, with))
}

/// Residuals of the other rows in the fit without one, times √w: `r_i + x_i S_k r_k/(1 − h_k)`; beside them their rows.
fn without(model: &ModelFit, r: usize, n: usize, found: Outlying) -> (Vec<usize>, Vec<f64>) {
    let k = r * n + found.row;
    let pull = found.residual / (1.0 - model.fit.leverage[k]);
    let moved = |i: usize| {
        (0..model.problem.design.ncols())
            .map(|j| model.problem.design[(i, j)] * model.fit.sensitivity()[(j, k)] * pull)
            .sum::<f64>()
    };
    let weight = |i: usize| model.problem.weight.as_ref().map_or(1.0, |w| w[i]);
    let others: Vec<usize> = model.problem.rows_of(r).into_iter().filter(|i| *i != k).collect();
    let left = others.iter().map(|&i| (model.fit.residuals[i] + moved(i)) * weight(i).sqrt()).collect();
    (others, left)
}

/// How the residuals go with speed in the fit without a row.
fn uneven_without(model: &ModelFit, data: &Dataset, r: usize, found: Outlying) -> Option<Unevenness> {
    let n = data.rows;
    let speed = data.values("speed").filter(|_| n > FEWEST_FOR_SCATTER)?;
    let (others, left) = without(model, r, n, found);
    let speeds: Vec<f64> = others.iter().map(|i| speed[i % n].abs()).collect();
    Some(Unevenness::of(&left.iter().map(|x| x.abs()).collect::<Vec<_>>(), &speeds))
}

/// A quantity with which the error variance may grow: squared values, one per row.
struct Variate {
    name: String,
    squares: Vec<f64>,
}

/// The load by the law, the speed, sine and cosine of the angle, and the channels of the law.
///
/// Absolute errors of a load are errors in proportion to 1/f of its logarithm.
fn variates(model: &ModelFit, data: &Dataset, r: usize) -> Vec<Variate> {
    let of = |name: &str, z: &dyn Fn(usize) -> f64| Variate {
        name: name.to_owned(),
        squares: (0..data.rows).map(|row| z(row).powi(2)).collect(),
    };
    let predicted = model.law.predict(data, model.law_coefficients()).unwrap_or_default();
    let load = |row: usize| {
        let f = predicted.get(r * data.rows + row).copied().unwrap_or_default();
        if model.law.in_logarithms() { 1.0 / f } else { f }
    };
    let mut out = vec![of("load", &load)];
    out.extend(data.values("speed").map(|z| of("speed", &|row| z[row])));
    for (name, of_angle) in [("sine of the angle", f64::sin as fn(f64) -> f64), ("cosine of the angle", f64::cos)] {
        out.extend(data.values("angle").map(|z| of(name, &|row| of_angle(z[row]))));
    }
    let channels = model.law.channels().into_iter().filter(|c| !matches!(*c, "density" | "n_links"));
    out.extend(channels.filter_map(|name| data.values(name).map(|z| of(&format!("size of {name}"), &|row| z[row]))));
    out
}

/// A fitted variance and its variate.
struct Growth<'a> {
    variance: Variance,
    with: &'a Variate,
    /// Decrease of −2 ln L from that of an even variance.
    fall: f64,
}

impl<'a> Growth<'a> {
    /// Of squares of residuals; `rows[k]` is the row of `squares[k]` in the stacked problem.
    fn of(squares: &[f64], rows: &[usize], with: &'a Variate) -> Option<Self> {
        let z: Vec<f64> = rows.iter().map(|i| with.squares[i % with.squares.len()]).collect();
        Some(Self { variance: Variance::of(squares, &z)?, with, fall: 0.0 })
    }

    /// Variance of row `i` of the stacked problem.
    fn at(&self, i: usize) -> f64 {
        self.variance.at(self.with.squares[i % self.with.squares.len()])
    }
}

/// The variate of highest normal likelihood.
fn likeliest<'a>(squares: &[f64], rows: &[usize], variates: &'a [Variate]) -> Option<Growth<'a>> {
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    let even = squares.len() as f64 * (mean.ln() + 1.0);
    let of = |with: &'a Variate| {
        let growth = Growth::of(squares, rows, with)?;
        let deviance = rows.iter().zip(squares).map(|(i, square)| growth.at(*i).ln() + square / growth.at(*i));
        Some((deviance.sum::<f64>(), growth))
    };
    let (deviance, growth) = variates.iter().filter_map(of).min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Growth { fall: even - deviance, ..growth })
}

/// Whether the row still stands out under a growing variance: as fitted to the other rows or, with few rows, in proportion to the load.
fn is_beyond_growth(model: &ModelFit, data: &Dataset, r: usize, found: Outlying) -> bool {
    let n = data.rows;
    let (others, left) = without(model, r, n, found);
    let variates = variates(model, data, r);
    let dof = model.fit.components[r].dof - 1.0;
    let k = r * n + found.row;
    let (variance, dof) = if others.len() >= FEWEST_FOR_SCATTER {
        // Scaled by n/dof, because the fit absorbs part of the scatter.
        let lost = others.len() as f64 / dof;
        let squares: Vec<f64> = left.iter().map(|x| x * x * lost).collect();
        match likeliest(&squares, &others, &variates) {
            Some(growth) if growth.fall > LEAST_FALL => (growth.at(k), (AT_ONE_LOAD * dof).max(FEWEST_DOF)),
            Some(_) => return true,
            None => return false,
        }
    } else {
        let loads = &variates[0].squares;
        let largest = others.iter().fold(0.0_f64, |m, i| m.max(loads[i % n]));
        let load = |i: usize| loads[i % n].max(LEAST_LOAD * LEAST_LOAD * largest);
        (others.iter().zip(&left).map(|(i, x)| x * x / load(*i)).sum::<f64>() / dof * load(k), dof)
    };
    let weight = model.problem.weight.as_ref().map_or(1.0, |w| w[k]);
    let own = found.residual.abs() * (weight / (1.0 - model.fit.leverage[k])).sqrt();
    let looks = ((others.len() + 1) * model.law.responses.len()) as f64;
    t_two_sided(own / variance.sqrt(), dof) * looks < FALSE_ALARM * level_of(model, r)
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use crate::small_tables::{identified_of, said};
    use crate::source::handed::TABLE;

    fn found(rows: &str, keys: &str) -> Vec<String> {
        said(rows, keys, &["outlying-row"])
    }

    /// 12 U² with a scatter of σ N and of a part of the load, and one row by so many times its own σ too large.
    fn table(seed: u128, speeds: usize, repeats: usize, [sigma, part]: [f64; 2], (row, by): (usize, f64)) -> String {
        let mut rng = Pcg64::new(seed, 3);
        let mut out = String::new();
        for i in 0..speeds * repeats {
            let u = 0.4 + 1.2 * (i / repeats) as f64 / (speeds - 1).max(1) as f64;
            let f = 12.0 * u * u;
            let z: f64 = StandardNormal.sample(&mut rng);
            let z = if i == row { by } else { z };
            let _ = writeln!(out, "{u},{}", -f - z * sigma.hypot(part * f));
        }
        out
    }

    const QUADRATIC: &str = "models = [\"quadratic\"]\n";
    const FITTED: &str = "models = [\"quadratic\"]\n[identify]\nweights = \"fitted\"\ncovariance = \"HC3\"\n";
    const NONE: (usize, f64) = (usize::MAX, 0.0);

    #[test]
    fn a_row_is_found_among_few_and_where_the_scatter_grows() {
        // Of five rows, a hundred times apart.
        assert_eq!(found(&table(1, 5, 1, [0.05, 0.0], (2, 100.0)), QUADRATIC).len(), 1);
        for keys in ["", QUADRATIC, FITTED] {
            let named = found(&table(2, 7, 4, [0.0, 0.017], (2, 10.0)), keys);
            assert!(named.len() == 1 && named[0].contains("line 4 (0.4 m/s)"), "{keys}: {named:?}");
        }
    }

    /// Of 200 sound tables each, 0.68 % and three standard deviations are reported at most.
    #[test]
    fn sound_rows_are_passed_over_whatever_their_scatter() {
        for (speeds, repeats) in [(5, 1), (8, 1), (7, 4)] {
            for scatter in [[0.3, 0.0], [0.0, 0.02], [0.05, 0.02]] {
                for keys in [QUADRATIC, FITTED] {
                    let is_named = |seed: &u128| !found(&table(*seed, speeds, repeats, scatter, NONE), keys).is_empty();
                    let alarms = (0..200).filter(is_named).count();
                    assert!(alarms <= 5, "{speeds} speeds {repeats} times, {scatter:?}, {keys}: {alarms} of 200");
                }
            }
        }
    }

    /// Findings about 4 U² cos²θ at three speeds and thirteen angles, with a scatter in newtons of an angle in radians and one row by so many times its own too large.
    fn of_angles(seed: u128, scatter: fn(f64) -> f64, (row, by): (usize, f64), covariance: &str) -> Vec<String> {
        let mut rng = Pcg64::new(seed, 7);
        let mut rows = "speed [m/s],angle [deg],f_x [N]\n".to_owned();
        for i in 0..39 {
            let (u, angle) = ([0.6, 0.8, 1.0][i / 13], 3.0 + 3.0 * (i % 13) as f64);
            let z: f64 = StandardNormal.sample(&mut rng);
            let z = if i == row { by } else { z };
            let v = u * f64::to_radians(angle).cos();
            let _ = writeln!(rows, "{u},{angle},{}", -4.0 * v * v + z * scatter(angle.to_radians()));
        }
        let keys = format!(
            "models = [\"own\"]\n[identify]\ncovariance = \"{covariance}\"\n[[identify.model]]\nname = \"own\"\n\
             f_x = \"-D*v_x*abs(v_x)\"\n"
        );
        let findings = identified_of(&rows, TABLE, &keys).findings.into_iter();
        findings.filter(|f| f.code == "outlying-row").map(|f| f.message).collect()
    }

    /// The noise of a load cell mounted across the rail enters f_x in proportion to the sine of the angle; neither speed nor load shows it.
    #[test]
    fn sound_rows_are_passed_over_where_the_scatter_grows_with_the_angle() {
        for covariance in ["classical", "HC3"] {
            let is_named = |seed: &u128| !of_angles(*seed, |a| 0.02 * a.sin(), NONE, covariance).is_empty();
            let alarms = (0..400).filter(is_named).count();
            assert!(alarms <= 7, "{covariance}: {alarms} of 400");
        }
    }

    /// A row that lies apart explains its own variate: each other one is judged without it.
    #[test]
    fn a_row_that_lies_apart_is_found_at_any_angle() {
        for (row, by) in [(0, 40.0), (7, 12.0), (12, 12.0), (38, 12.0)] {
            for (scatter, enough) in [(|a: f64| 0.02 * a.sin()) as fn(f64) -> f64, |_| 0.01].into_iter().zip([15, 18]) {
                let line = format!("line {}", row + 2);
                let is_found = |seed: &u128| {
                    of_angles(*seed, scatter, (row, by), "classical").iter().any(|said| said.contains(&line))
                };
                let found = (0..20).filter(is_found).count();
                assert!(found >= enough, "row {row}: {found} of 20");
            }
        }
    }
}
