//! Identification results as the report wants them: points, curves with bands, budget, selection.

use std::collections::BTreeSet;

use froude_fit::faer::Mat;
use froude_identify::IdentifyError;
use froude_identify::dataset::{Dataset, unit_text};
use froude_identify::diagnosis::{FEWEST_FOR_SCATTER, unevenness};
use froude_identify::regression::ModelFit;
use froude_identify::selection::aicc_of;
use froude_identify::source::SourceResult;
use froude_identify::uncertainty::{SCATTER, coverage_factor};
use froude_records::campaign::Campaign;
use froude_records::estimate::Estimate;
use froude_records::number;
use froude_records::page::DocumentSection;
use froude_records::text::counted;
use froude_records::units::Dimension;
use froude_report::{Abscissa, Against, BudgetRow, Curve, InputFile, Point, Report, SelectionRow, SourceSection};

use crate::pipeline::Outcome;

/// Places along a curve.
const CURVE_POINTS: usize = 60;
/// Curves against speed drawn per configuration at most, one an angle; more would hide the points.
const MOST_ANGLES: usize = 5;
/// Curves against angle, one a speed: they lie apart, and a drift test has few; more shades are not told apart.
const MOST_SPEEDS: usize = 12;
/// Speeds of one setting differ by less than this part, angles by less than this: a measured speed is never twice the same number.
const SAME_SPEED: f64 = 0.03;
/// 0.5°.
const SAME_ANGLE_RAD: f64 = 0.0088;

/// The whole report of a campaign.
pub fn report(
    campaign: &Campaign,
    outcome: &Outcome,
    published: Vec<Estimate>,
    blocks: Vec<DocumentSection>,
    date: Option<String>,
) -> Result<Report, IdentifyError> {
    let Outcome { file, sources, summaries, .. } = outcome;
    // A line per file and source that reads it; a file that several name is one file.
    let mut data: Vec<InputFile> = Vec::new();
    for d in file.data.values() {
        if data.iter().any(|seen| seen.path == d.path) {
            continue;
        }
        let line = InputFile { path: d.path.clone(), sha256: d.sha256.clone(), ..InputFile::default() };
        let readers = sources.iter().filter(|s| s.files.first().is_some_and(|f| f.path.ends_with(&d.path)));
        let lines: Vec<InputFile> = readers
            .filter(|s| s.is_fitted())
            .map(|s| InputFile {
                n_rows: Some(s.n_read),
                n_used: Some(s.data.observations()),
                source: Some(s.name.clone()),
                ..line.clone()
            })
            .collect();
        data.extend(if lines.is_empty() { vec![line] } else { lines });
    }
    Ok(Report {
        title: campaign.name.clone(),
        subtitle: subtitle(sources, &published),
        blocks: summaries.iter().map(|summary| summary.section.clone()).chain(blocks).collect(),
        date,
        method: method(campaign, sources),
        sources: sources.iter().map(section).collect::<Result<_, _>>()?,
        published,
        findings: file.findings.clone(),
        data,
        versions: file.versions.clone(),
        citations: campaign.cite.clone(),
        comparison: file.comparison.clone().filter(|c| !c.coefficients.is_empty() || !c.loads.is_empty()),
    })
}

fn subtitle(sources: &[SourceResult], published: &[Estimate]) -> String {
    let observations: usize = sources.iter().map(|s| s.data.observations()).sum();
    if sources.is_empty() {
        return format!("{} side by side", counted(published.len(), "estimate", "estimates"));
    }
    let name = |s: &SourceResult| s.estimates.first().map_or_else(|| s.name.clone(), |e| e.source.clone());
    let names: BTreeSet<String> = sources.iter().map(name).collect();
    let estimates = sources.iter().map(|s| s.estimates.len()).sum();
    let what = if sources.iter().any(SourceResult::is_fitted) {
        counted(observations, "observation", "observations")
    } else {
        counted(estimates, "estimate", "estimates")
    };
    let mut out = format!("{what} from {}", counted(names.len(), "source", "sources"));
    if !published.is_empty() {
        out += &format!(", beside {}", counted(published.len(), "published estimate", "published estimates"));
    }
    out
}

fn method(campaign: &Campaign, sources: &[SourceResult]) -> Vec<String> {
    let computed = sources.iter().filter(|s| !s.is_fitted()).flat_map(|s| &s.estimates);
    let computed: Vec<String> = computed.map(|e| format!("{}: {}.", e.source, e.method.words)).collect();
    // Nothing was measured or fitted: of loads and least squares there is nothing to say.
    if !computed.is_empty() && computed.len() == sources.len() {
        return computed;
    }
    let mut out = vec![
        "Loads are those that the fluid exerts on the body, in body axes: x forward, y to starboard, z down. \
         A body towed at speed U under the angle θ has the velocity v = (U cos θ, −U sin θ) through the water."
            .to_owned(),
    ];
    if sources.is_empty() {
        return out;
    }
    out.push(
        "Coefficients are estimated by least squares with orthogonal factorisation. Each load component has its own \
         residual standard deviation and degrees of freedom. Type A uncertainty comes from the scatter about the law; \
         type B from the declared budget, whose shared errors do not average down (GUM, JCGM 100:2008). Intervals are \
         95 %, from Student's t with effective degrees of freedom (Welch–Satterthwaite)."
            .to_owned(),
    );
    let bounded = sources.iter().flat_map(|s| &s.models).any(|m| m.options.bounds.iter().any(|b| b.lower == 0.0));
    if bounded {
        out.push(
            "Coefficients are bounded below by zero, as the campaign asks. A value at its bound is the \
             constrained fit; its interval is that of the unconstrained fit, cut at the bound."
                .to_owned(),
        );
    }
    if sources.iter().any(|s| s.models.len() > 1) {
        out.push(
            "Among several force models the one with the fewest coefficients is recommended whose AICc lies within 2 of the \
             smallest (smaller differences are no evidence), unless an F test rejects it inside the best model at 1 % in some load."
                .to_owned(),
        );
    }
    out.extend(sources.iter().flat_map(error_models));
    out.extend(computed);
    if let Some(rho) = campaign.fluid.density_kg_m3 {
        out.push(format!("Water density {rho} kg/m³ is stated by the campaign."));
    }
    out
}

/// AICc differences below this are no evidence (Burnham and Anderson 2002, § 2.6).
const NO_EVIDENCE_BELOW: f64 = 2.0;

/// What the fit of logarithms assumes, what the fit in the load's unit assumes, and which the residuals support:
/// a sentence for every load that was fitted both ways.
fn error_models(source: &SourceResult) -> Vec<String> {
    let position = |wanted: &dyn Fn(&ModelFit) -> bool| source.models.iter().position(wanted);
    let mut out = Vec::new();
    for (i, logarithmic) in source.models.iter().enumerate().filter(|(_, m)| m.law.in_logarithms()) {
        let Some(load) = logarithmic.law.responses.first() else { continue };
        let is_plain = |m: &ModelFit| !m.law.in_logarithms() && m.law.responses.contains(load);
        // The same law in the load's unit tells the two error models apart best; any other law will do.
        let plain = position(&|m| is_plain(m) && m.law.is_nonlinear()).or_else(|| position(&is_plain));
        let has_std = source.data.channels.contains_key(&format!("std_{load}"));
        let assumes = format!(
            "{}, {load}: {} is fitted to logarithms and takes every point to have {}",
            source.name,
            logarithmic.law.name,
            if has_std { "the relative error of its std column" } else { "the same relative error" }
        );
        let Some(j) = plain else {
            out.push(format!("{assumes}; no law was fitted in {} to compare it with.", unit_text(&source.data, load)));
            continue;
        };
        let newton = &source.models[j];
        let unit = unit_text(&source.data, load);
        let support = supported(source, (i, logarithmic), (j, newton), load);
        out.push(format!(
            "{assumes}, {} is fitted in {unit} and takes every point to have {}; {support}.",
            newton.law.name,
            if has_std { "the absolute error of that column" } else { "the same absolute error" }
        ));
    }
    out
}

/// Which of the two error models the residuals support, with the numbers.
fn supported(
    source: &SourceResult,
    (i, logarithmic): (usize, &ModelFit),
    (j, newton): (usize, &ModelFit),
    load: &str,
) -> String {
    let (Some(of_log), Some(of_newton)) =
        (unevenness(logarithmic, &source.data, load), unevenness(newton, &source.data, load))
    else {
        return format!(
            "whether the residuals support one of them is not judged from fewer than {FEWEST_FOR_SCATTER} observations"
        );
    };
    // AICc compares the two only where they explain the same loads; that of the logarithms is carried over.
    let gain = source.estimates[j]
        .diagnostics
        .aicc
        .zip(source.estimates[i].diagnostics.aicc)
        .map(|(n, l)| n - l)
        .filter(|_| newton.law.responses == logarithmic.law.responses);
    let numbers = format!(
        "rank correlation of |residual| with speed {} ({:.1} standard errors) relative, {} ({:.1}) absolute{}",
        number::fixed(of_log.rho, 2),
        of_log.z.abs(),
        number::fixed(of_newton.rho, 2),
        of_newton.z.abs(),
        gain.map_or_else(String::new, |g| format!(
            "; AICc is {:.1} {} for the relative error",
            g.abs(),
            if g > 0.0 { "smaller" } else { "larger" }
        ))
    );
    let favoured = gain.filter(|g| g.abs() > NO_EVIDENCE_BELOW).map(|g| g > 0.0);
    // AICc weighs the whole likelihood; where it does not decide, the scatter alone may.
    let verdict = match (favoured, of_log.contradicts(), of_newton.contradicts()) {
        (Some(true), false, _) | (None, false, true) => "the residuals support the same relative error",
        (Some(false), _, false) | (None, true, false) => "the residuals support the same absolute error",
        (Some(_), ..) => "AICc favours one whose own residuals are uneven: they support neither",
        (None, true, true) => "the residuals support neither",
        (None, false, false) => "the residuals do not tell the two apart",
    };
    format!("{verdict} ({numbers})")
}

fn section(source: &SourceResult) -> Result<SourceSection, IdentifyError> {
    let chosen = source.recommendation.as_ref().map(|r| r.index);
    let mut out = SourceSection {
        name: source.name.clone(),
        kind: source.kind.name().to_owned(),
        facts: facts(source),
        estimates: source.estimates.clone(),
        selection: selection(source),
        not_fitted: source.not_fitted.iter().map(|n| (n.model.clone(), n.why.clone())).collect(),
        tests: source.tests.clone(),
        recommendation: source.recommendation.as_ref().map_or_else(String::new, |r| r.reason.clone()),
        sample_of: source.data.sample.as_ref().map(|all| all.rows),
        ..SourceSection::default()
    };
    if let Some(model) = chosen.and_then(|i| source.models.get(i)) {
        out.points = points(model, &source.data)?;
        // Where the fit was made elsewhere, the estimate knows what goes into it.
        let is_fitted = model.combined.iter().any(Option::is_some);
        out.budget =
            if is_fitted { budget(model) } else { source.estimates.first().map(budget_of).unwrap_or_default() };
        out.curves = curves(model, &source.data)?;
    }
    Ok(out)
}

fn facts(source: &SourceResult) -> Vec<(String, String)> {
    if !source.is_fitted() {
        let notes = source.estimates.iter().flat_map(|e| &e.diagnostics.notes);
        return notes.map(|note| ("Computation".to_owned(), note.clone())).collect();
    }
    let mut out = vec![
        ("Observations".to_owned(), format!("{} used of {} read", source.data.observations(), source.n_read)),
        ("Configurations".to_owned(), {
            let of_rows = || source.data.configurations();
            let names = source.data.sample.as_ref().map_or_else(of_rows, |all| all.configurations.clone());
            if names.iter().all(String::is_empty) { "one, not named".to_owned() } else { names.join(", ") }
        }),
    ];
    if let Some(estimate) = source.estimates.first() {
        out.push(("Covariance".to_owned(), estimate.covariance_kind().to_owned()));
    }
    for estimate in source.estimates.iter().filter(|e| e.recommended) {
        for note in &estimate.diagnostics.notes {
            out.push(("Propagation".to_owned(), note.clone()));
        }
    }
    for block in &source.blocks {
        let rmse: Vec<String> =
            block.rmse.iter().map(|(c, e, r)| format!("{c} {e:.3e} ({:.0} %)", 100.0 * r)).collect();
        let worst: Vec<String> = block.worst_ratio.iter().map(|(c, w)| format!("{c} {:+.0} %", 100.0 * w)).collect();
        let moved: Vec<String> = block.moved.iter().map(|(n, a, b)| format!("{n} {a:.4e} → {b:.4e}")).collect();
        out.push((
            format!("Range block, {}", block.model),
            format!(
                "{}: prediction error outside {}; worst {}; coefficients {}",
                block.block,
                rmse.join(", "),
                worst.join(", "),
                moved.join(", ")
            ),
        ));
    }
    out
}

/// The channel that a response is drawn against: speed where there is motion, else the first channel of its law.
fn abscissa(model: &ModelFit, data: &Dataset) -> Option<String> {
    if data.values("speed").is_some_and(|u| u.iter().any(|x| *x != 0.0))
        && (0..model.law.responses.len()).any(|r| model.law.moves(r))
    {
        return None;
    }
    let used: Vec<String> = match &model.law.kind {
        froude_identify::law::Kind::Formulas(f) => {
            f.iter().flat_map(|f| f.channels.iter().map(|c| froude_identify::law::aliased(c).to_owned())).collect()
        }
        _ => Vec::new(),
    };
    used.into_iter().find(|c| c != "density")
}

fn points(model: &ModelFit, data: &Dataset) -> Result<Vec<Point>, IdentifyError> {
    let fitted = model.law.predict(data, model.law_coefficients())?;
    let other = abscissa(model, data);
    let n = data.rows;
    let mut out = Vec::new();
    for (r, response) in model.law.responses.iter().enumerate() {
        let Some(measured) = data.values(response) else { continue };
        let standard = data.values(&format!("std_{response}"));
        for i in 0..n {
            out.push(Point {
                configuration: data.configuration[i].clone(),
                component: response.clone(),
                unit: unit_text(data, response),
                speed_m_s: data.values("speed").map_or(0.0, |v| v[i]),
                angle_rad: data.values("angle").map_or(0.0, |v| v[i]),
                other: other.as_ref().and_then(|q| {
                    data.values(q).map(|v| Abscissa {
                        quantity: q.clone(),
                        unit: data.dimension(q).unwrap_or(Dimension::ONE).to_string(),
                        value: v[i],
                    })
                }),
                measured: measured[i],
                standard: standard.map(|s| s[i]),
                fitted: fitted[r * n + i],
            });
        }
    }
    Ok(out)
}

fn budget(model: &ModelFit) -> Vec<BudgetRow> {
    let mut out = Vec::new();
    for (j, spec) in model.specs.iter().enumerate() {
        let Some(combined) = model.combined[j] else { continue };
        for part in &model.budget {
            // Listed, so that nobody looks for it in vain; the scatter holds it already.
            let (input, contribution) = if part.in_scatter {
                (format!("{}, in the scatter", part.name), 0.0)
            } else {
                (part.name.clone(), part.standard(j))
            };
            out.push(BudgetRow {
                model: model.law.name.clone(),
                coefficient: spec.name.clone(),
                shared: if input == SCATTER { String::new() } else { part.shared.to_owned() },
                input,
                contribution,
                unit: spec.unit.clone(),
                share: if combined.standard > 0.0 { (contribution / combined.standard).powi(2) } else { 0.0 },
            });
        }
    }
    out
}

/// The same from an estimate: its scatter and every error that it names.
fn budget_of(estimate: &Estimate) -> Vec<BudgetRow> {
    let Some(scatter) = &estimate.type_a else { return Vec::new() };
    let mut out = Vec::new();
    for (j, name) in scatter.names.iter().enumerate() {
        let errors =
            estimate.errors.values().map(|e| (e.name.clone(), e.between(&e.sensitivity[j], &e.sensitivity[j])));
        let parts: Vec<(String, f64)> =
            std::iter::once((scatter.kind.clone(), scatter.matrix[j][j])).chain(errors).collect();
        let total: f64 = parts.iter().map(|part| part.1).sum();
        let unit = estimate.coefficients.get(name).map_or_else(String::new, |c| c.unit.clone());
        out.extend(parts.into_iter().map(|(input, variance)| BudgetRow {
            model: estimate.law.name.clone(),
            coefficient: name.clone(),
            shared: String::new(),
            input,
            contribution: variance.max(0.0).sqrt(),
            unit: unit.clone(),
            share: if total > 0.0 { variance / total } else { 0.0 },
        }));
    }
    out
}

fn selection(source: &SourceResult) -> Vec<SelectionRow> {
    // One fit has nothing to be chosen from.
    if source.models.iter().all(|model| model.combined.iter().all(Option::is_none)) {
        return Vec::new();
    }
    let behind = |model: &ModelFit, load: &str| {
        let best = source.models.iter().filter_map(|m| aicc_of(m, &source.data, load)).fold(f64::INFINITY, f64::min);
        aicc_of(model, &source.data, load)
            .map(|a| a - best)
            .ok_or_else(|| "no AICc: an exact fit, a robust loss, or too few observations".to_owned())
    };
    let mut out = Vec::new();
    for (i, model) in source.models.iter().enumerate() {
        let diagnostics = &source.estimates[i].diagnostics;
        for component in &model.fit.components {
            let rmse = diagnostics.cross_validation_rmse.get(&component.name).copied();
            out.push(SelectionRow {
                model: model.law.name.clone(),
                component: component.name.clone(),
                n_coefficients: component.rank,
                sigma: component.sigma.unwrap_or(f64::NAN),
                unit: if model.law.in_logarithms() { "1".to_owned() } else { unit_text(&source.data, &component.name) },
                relative_residual: component.relative_residual,
                delta_aicc: behind(model, &component.name),
                cross_validation: rmse
                    .ok_or_else(|| source.scores[i].note.clone().unwrap_or_else(|| "not scorable".to_owned())),
                range_blocks: source
                    .blocks
                    .iter()
                    .filter(|b| b.model == model.law.name)
                    .flat_map(|b| {
                        b.rmse
                            .iter()
                            .filter(|(c, ..)| *c == component.name)
                            .map(|(_, error, _)| (b.block.clone(), *error))
                    })
                    .collect(),
                lack_of_fit_p: diagnostics.lack_of_fit_p.get(&component.name).copied(),
            });
        }
    }
    out
}

/// Lines of the recommended model: against speed at the most frequent angles, against angle at the most frequent speeds.
fn curves(model: &ModelFit, data: &Dataset) -> Result<Vec<Curve>, IdentifyError> {
    if let Some(channel) = abscissa(model, data) {
        return other_curves(model, data, &channel);
    }
    let mut out = Vec::new();
    for configuration in data.configurations() {
        let rows: Vec<usize> = (0..data.rows).filter(|&i| data.configuration[i] == configuration).collect();
        let of = |name: &str| -> Vec<f64> {
            data.values(name).map_or_else(|| vec![0.0; rows.len()], |v| rows.iter().map(|&i| v[i]).collect())
        };
        let (by_angle, by_speed) = (settings(&of("angle"), same_angle), settings(&of("speed"), same_speed));
        let angles = frequent(&by_angle, &by_speed, MOST_ANGLES);
        let speeds = frequent(&by_speed, &by_angle, MOST_SPEEDS);
        let range = |name: &str| {
            let v = data.values(name).unwrap_or_default();
            rows.iter()
                .map(|&i| v.get(i).copied().unwrap_or(0.0))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
        };
        let (slowest, fastest) = range("speed");
        let (least, most) = range("angle");
        for angle in angles {
            let x = line(slowest.min(0.0), fastest.max(0.0));
            let places = place(data, rows[0], &x, |d, x| {
                d.put("speed", x.to_vec(), Dimension::SPEED);
                d.put("angle", vec![angle; x.len()], Dimension::ONE);
                d.velocity_from_speed_and_angle();
            });
            out.extend(bands(model, &places, &configuration, &x, &Against::Speed { angle_rad: angle })?);
        }
        if most > least {
            for speed in speeds {
                let x = line(least, most);
                let places = place(data, rows[0], &x, |d, x| {
                    d.put("speed", vec![speed; x.len()], Dimension::SPEED);
                    d.put("angle", x.to_vec(), Dimension::ONE);
                    d.velocity_from_speed_and_angle();
                });
                out.extend(bands(model, &places, &configuration, &x, &Against::Angle { speed_m_s: speed })?);
            }
        }
    }
    Ok(out)
}

fn other_curves(model: &ModelFit, data: &Dataset, channel: &str) -> Result<Vec<Curve>, IdentifyError> {
    let Some(values) = data.values(channel) else { return Ok(Vec::new()) };
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let dimension = data.dimension(channel).unwrap_or(Dimension::ONE);
    let x = line(low, high);
    let against = Against::Other { quantity: channel.to_owned(), unit: dimension.to_string() };
    let mut out = Vec::new();
    for configuration in data.configurations() {
        let row = data.configuration.iter().position(|c| *c == configuration).unwrap_or(0);
        let places = place(data, row, &x, |d, x| d.put(channel, x.to_vec(), dimension));
        out.extend(bands(model, &places, &configuration, &x, &against)?);
    }
    Ok(out)
}

fn line(low: f64, high: f64) -> Vec<f64> {
    (0..CURVE_POINTS).map(|k| low + (high - low) * k as f64 / (CURVE_POINTS - 1) as f64).collect()
}

/// Copies of one observation, moved along a line.
fn place(data: &Dataset, row: usize, x: &[f64], set: impl Fn(&mut Dataset, &[f64])) -> Dataset {
    let mut out = data.subset(&vec![row; x.len()]);
    set(&mut out, x);
    out
}

fn bands(
    model: &ModelFit,
    places: &Dataset,
    configuration: &str,
    x: &[f64],
    against: &Against,
) -> Result<Vec<Curve>, IdentifyError> {
    let coefficients = model.law_coefficients();
    let y = model.law.predict(places, coefficients)?;
    let slopes = model.law.regressors(places, coefficients)?;
    let n = places.rows;
    let mut out = Vec::new();
    for (r, response) in model.law.responses.iter().enumerate() {
        // Of the scatter: the fewest among the coefficients of this load, those of the clusters, say.
        let touches = |j: usize| (0..n).any(|i| slopes[(r * n + i, j)] != 0.0);
        let scatter_dof =
            (0..slopes.ncols()).filter(|&j| touches(j)).map(|j| model.budget[0].dof[j]).fold(f64::INFINITY, f64::min);
        let arms: Vec<[f64; 2]> = (0..n)
            .map(|i| {
                let row: Vec<f64> = (0..slopes.ncols()).map(|j| slopes[(r * n + i, j)]).collect();
                // A law of one coefficient has the interval of that, with looks and errors to one side.
                if let ([slope], Some(Some(combined))) = (row.as_slice(), model.combined.first()) {
                    let [below, above] = combined.arms.map(|arm| arm * slope.abs());
                    return if *slope < 0.0 { [above, below] } else { [below, above] };
                }
                let standard = model.prediction_std(&row);
                // Welch–Satterthwaite (GUM G.4.1) with a budget of infinitely many degrees of freedom.
                let scatter = spread(&model.budget[0].covariance, &row);
                let share = if scatter > 0.0 { (standard / scatter).powi(4) } else { f64::INFINITY };
                let half = coverage_factor(scatter_dof * share) * standard;
                [half, half]
            })
            .collect();
        let y = &y[r * n..(r + 1) * n];
        out.push(Curve {
            configuration: configuration.to_owned(),
            component: response.clone(),
            unit: unit_text(places, response),
            model: model.law.name.clone(),
            against: against.clone(),
            x: x.to_vec(),
            y: y.to_vec(),
            low: y.iter().zip(&arms).map(|(y, [below, _])| y - below).collect(),
            high: y.iter().zip(&arms).map(|(y, [_, above])| y + above).collect(),
        });
    }
    Ok(out)
}

/// √(xᵀCx) of the coefficients that x belongs to.
fn spread(covariance: &Mat<f64>, x: &[f64]) -> f64 {
    let variance: f64 = x
        .iter()
        .enumerate()
        .map(|(a, p)| x.iter().enumerate().map(|(b, q)| p * q * covariance[(a, b)]).sum::<f64>())
        .sum();
    variance.max(0.0).sqrt()
}

/// Values of one channel as settings: the setting of each row, and the mean value of each.
struct Settings {
    of_row: Vec<usize>,
    means: Vec<f64>,
}

fn same_angle(first: f64, other: f64) -> bool {
    other - first <= SAME_ANGLE_RAD
}

fn same_speed(first: f64, other: f64) -> bool {
    other - first <= SAME_SPEED * first.abs()
}

/// Values that belong together, counted from the smallest of them so that a fine sweep does not run together.
fn settings(values: &[f64], is_same: fn(f64, f64) -> bool) -> Settings {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut out = Settings { of_row: vec![0; values.len()], means: Vec::new() };
    let mut group: Vec<usize> = Vec::new();
    let mut close = |group: &mut Vec<usize>| {
        if group.is_empty() {
            return;
        }
        for &i in group.iter() {
            out.of_row[i] = out.means.len();
        }
        out.means.push(group.iter().map(|&i| values[i]).sum::<f64>() / group.len() as f64);
        group.clear();
    };
    for i in order {
        if group.first().is_some_and(|&first| !is_same(values[first], values[i])) {
            close(&mut group);
        }
        group.push(i);
    }
    close(&mut group);
    out
}

/// Settings of `held` at which at least three settings of `moving` were run, `most` at most and the most frequent first.
fn frequent(held: &Settings, moving: &Settings, most: usize) -> Vec<f64> {
    let mut seen = vec![std::collections::BTreeSet::new(); held.means.len()];
    for (h, m) in held.of_row.iter().zip(&moving.of_row) {
        seen[*h].insert(*m);
    }
    let mut out: Vec<(usize, f64)> =
        seen.iter().zip(&held.means).filter(|(m, _)| m.len() >= 3).map(|(m, mean)| (m.len(), *mean)).collect();
    out.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let mut values: Vec<f64> = out.into_iter().take(most).map(|(_, mean)| mean).collect();
    values.sort_by(f64::total_cmp);
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_identify::source::identify_source;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    /// Every model of a bare table.
    fn identified(name: &str, table: &str, models: &[&str]) -> (Campaign, SourceResult) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("{name}.csv"));
        std::fs::write(&path, table).unwrap();
        let mut campaign = Campaign::of_table(&path, None);
        campaign.identify.models = models.iter().map(|m| (*m).to_owned()).collect();
        let source = identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap();
        (campaign, source)
    }

    /// Unit noise from a seed of its own.
    fn noise(seed: u128) -> impl FnMut() -> f64 {
        let mut rng = Pcg64::new(seed, 0);
        move || StandardNormal.sample(&mut rng)
    }

    /// F = 20 U^1.8 at 40 speeds, with errors of the size that `size` gives for a force.
    fn power_law_table(seed: u128, size: impl Fn(f64) -> f64) -> String {
        let mut noise = noise(seed);
        let mut out = "speed [m/s],f_x [N]\n".to_owned();
        for i in 1..=40 {
            let speed = 0.05 * f64::from(i);
            let force = 20.0 * speed.powf(1.8);
            out += &format!("{speed},{}\n", -force + size(force) * noise());
        }
        out
    }

    const SEED: u128 = 7;

    #[test]
    fn the_error_model_that_made_the_data_is_the_one_that_the_method_names() {
        let models = ["power_law", "power_law_log"];
        let relative = identified("relative", &power_law_table(SEED, |f| 0.05 * f), &models).1;
        let absolute = identified("absolute", &power_law_table(SEED, |_| 0.02), &models).1;
        let said = |source: &SourceResult| error_models(source).concat();
        assert!(
            said(&relative).starts_with(
                "relative.csv, f_x: power_law_log is fitted to logarithms and takes every point to have the same relative error, \
                 power_law is fitted in N and takes every point to have the same absolute error; \
                 the residuals support the same relative error ("
            ),
            "{}",
            said(&relative)
        );
        assert!(said(&absolute).contains("the residuals support the same absolute error ("), "{}", said(&absolute));
        let alone = identified("alone", &power_law_table(SEED, |f| 0.05 * f), &["power_law_log"]).1;
        assert!(said(&alone).ends_with("no law was fitted in N to compare it with."), "{}", said(&alone));
        let none = identified("none", &power_law_table(SEED, |f| 0.05 * f), &["power_law"]).1;
        assert_eq!(said(&none), "");
    }

    /// A power law of f_x alone has an AICc far below that of a law of two loads: it sums over fewer observations.
    #[test]
    fn aicc_is_compared_load_by_load() {
        let mut noise = noise(SEED);
        let mut table = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
        for i in 1..=30 {
            let (speed, angle) = (0.1 * f64::from(i), 5.0 * f64::from(i % 6 + 1));
            let (u, w) = (speed * angle.to_radians().cos(), speed * angle.to_radians().sin());
            table += &format!("{speed},{angle},{},{}\n", -5.0 * u * u + 0.01 * noise(), 90.0 * w * w + 5.0 * noise());
        }
        let (_, source) = identified("two loads", &table, &["quadratic", "linear_quadratic", "power_law"]);
        let names: Vec<&str> = source.models.iter().map(|m| m.law.name.as_str()).collect();
        assert_eq!(names, ["quadratic", "linear_quadratic", "power_law_x", "power_law_y"]);
        let aicc = |i: usize| source.estimates[i].diagnostics.aicc.unwrap();
        assert!(aicc(2) < aicc(0).min(aicc(1)), "the trap is not there: {} {} {}", aicc(0), aicc(1), aicc(2));
        assert_eq!(source.recommendation.as_ref().unwrap().index, 0, "the law of both loads, which made them");
        let reason = &source.recommendation.as_ref().unwrap().reason;
        assert!(reason.contains("; load by load the smallest AICc has: f_x "), "{reason}");
        let rows = selection(&source);
        for load in ["f_x", "f_y"] {
            let behind: Vec<f64> =
                rows.iter().filter(|r| r.component == load).map(|r| *r.delta_aicc.as_ref().unwrap()).collect();
            assert_eq!(behind.len(), 3, "the power law of the other axis is not asked about {load}");
            assert_eq!(behind.iter().copied().fold(f64::INFINITY, f64::min), 0.0, "{behind:?}");
            // All three can follow the data: none lies far behind in its own load.
            assert!(behind.iter().all(|d| *d < 6.0), "{behind:?}");
        }
    }

    /// Six speeds at nine angles, each run twice; no speed is measured twice as the same number.
    #[test]
    fn a_drift_test_has_a_line_for_every_speed() {
        let mut noise = noise(SEED);
        let mut table = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
        for speed in [0.3, 0.5, 0.7, 0.9, 1.1, 1.3] {
            for i in -4..=4 {
                for _ in 0..2 {
                    let (u, angle) = (speed * (1.0 + 0.003 * noise()), 5.0 * f64::from(i) + 0.05 * noise());
                    let (x, y) = (u * angle.to_radians().cos(), -u * angle.to_radians().sin());
                    table += &format!(
                        "{u},{angle},{},{}\n",
                        -5.0 * x * x + 0.01 * noise(),
                        -90.0 * y * y.abs() + 0.01 * noise()
                    );
                }
            }
        }
        // A speed that was run straight ahead only: no line against angle, but its points.
        table += "1.7,0,-14.45,0.0\n1.7,0,-14.46,0.01\n";
        let (_, source) = identified("drift", &table, &["quadratic"]);
        let section = section(&source).unwrap();
        let speeds: Vec<f64> = section
            .curves
            .iter()
            .filter(|c| c.component == "f_y")
            .filter_map(|c| match c.against {
                Against::Angle { speed_m_s } => Some(speed_m_s),
                _ => None,
            })
            .collect();
        assert_eq!(speeds.len(), 6, "{speeds:?}");
        for (found, run) in speeds.iter().zip([0.3, 0.5, 0.7, 0.9, 1.1, 1.3]) {
            assert!((found / run - 1.0).abs() < 0.005, "{found} for {run}");
        }
        let report = Report { sources: vec![section], ..Report::default() };
        let figures = froude_report::figures(&report).unwrap();
        let drift = figures.iter().find(|f| f.title.ends_with("f_y against angle")).unwrap();
        assert!(!drift.caption.contains("not drawn"), "{}", drift.caption);
        assert!(drift.svg.contains("other speeds"), "the points at 1.7 m/s");
    }
}
