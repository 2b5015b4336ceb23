//! Identification results as the report wants them: points, curves with bands, budget, selection.

use froude_identify::IdentifyError;
use froude_identify::compare::Comparison;
use froude_identify::dataset::Dataset;
use froude_identify::regression::ModelFit;
use froude_identify::source::{SourceResult, response_unit};
use froude_identify::uncertainty::{coverage_factor, shares};
use froude_records::campaign::Campaign;
use froude_records::estimate::{Estimate, EstimateFile};
use froude_records::units::Dimension;
use froude_report::{
    Abscissa, Against, BudgetRow, CoefficientComparison, ComparisonSection, Curve, ForceComparison, InputFile,
    JointComparison, NestedTest, Point, Report, SelectionRow, Side, SourceSection,
};

/// Places along a curve.
const CURVE_POINTS: usize = 60;
/// Curves against angle and against speed drawn per configuration at most; more would hide the points.
const MOST_CURVES: usize = 5;

/// The whole report of a campaign.
pub fn report(
    campaign: &Campaign,
    sources: &[SourceResult],
    published: &[Estimate],
    comparison: &Comparison,
    file: &EstimateFile,
    date: Option<String>,
) -> Result<Report, IdentifyError> {
    let data = file
        .data
        .iter()
        .map(|d| {
            let source = sources.iter().find(|s| s.files.first().is_some_and(|f| f.ends_with(&d.path)));
            InputFile {
                path: d.path.clone(),
                sha256: d.sha256.clone(),
                n_rows: source.map(|s| s.n_read),
                n_used: source.map(|s| s.data.rows),
                source: source.map(|s| s.name.clone()),
            }
        })
        .collect();
    Ok(Report {
        title: campaign.name.clone(),
        subtitle: subtitle(sources, published),
        date,
        method: method(campaign, sources),
        sources: sources.iter().map(section).collect::<Result<_, _>>()?,
        published: published.to_vec(),
        findings: file.findings.clone(),
        data,
        versions: file.versions.clone(),
        citations: campaign.cite.clone(),
        comparison: comparison_section(comparison),
    })
}

fn subtitle(sources: &[SourceResult], published: &[Estimate]) -> String {
    let observations: usize = sources.iter().map(|s| s.data.rows).sum();
    let mut out = format!(
        "{} observations from {} source{}",
        observations,
        sources.len(),
        if sources.len() == 1 { "" } else { "s" }
    );
    if !published.is_empty() {
        out += &format!(", beside {} published estimates", published.len());
    }
    out
}

fn method(campaign: &Campaign, sources: &[SourceResult]) -> Vec<String> {
    let mut out = vec![
        "Loads are those that the fluid exerts on the body, in body axes: x forward, y to starboard, z down. \
         A body towed at speed U under the angle θ has the velocity v = (U cos θ, −U sin θ) through the water."
            .to_owned(),
        "Coefficients are estimated by least squares with orthogonal factorisation. Each load component has its own \
         residual standard deviation and degrees of freedom. Type A uncertainty comes from the scatter about the law; \
         type B from the declared budget, whose shared errors do not average down (GUM, JCGM 100:2008). Intervals are \
         95 %, from Student's t with effective degrees of freedom (Welch–Satterthwaite)."
            .to_owned(),
    ];
    let bounded = sources.iter().flat_map(|s| &s.models).any(|m| m.options.bounds.iter().any(|b| b.lower == 0.0));
    if bounded {
        out.push(
            "Coefficients are bounded below by zero, as the zeros of published tables imply. A value at its bound is the \
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
    if let Some(rho) = campaign.fluid.density_kg_m3 {
        out.push(format!("Water density {rho} kg/m³ is stated by the campaign."));
    }
    out
}

fn section(source: &SourceResult) -> Result<SourceSection, IdentifyError> {
    let chosen = source.recommendation.as_ref().map(|r| r.index);
    let mut out = SourceSection {
        name: source.name.clone(),
        kind: source.kind.name().to_owned(),
        facts: facts(source),
        estimates: source.estimates.clone(),
        selection: selection(source),
        tests: source
            .tests
            .iter()
            .map(|t| NestedTest {
                simple: t.simple.clone(),
                general: t.general.clone(),
                component: t.component.clone(),
                f: t.f,
                dof: t.dof,
                p: t.p,
            })
            .collect(),
        recommendation: source.recommendation.as_ref().map_or_else(String::new, |r| r.reason.clone()),
        ..SourceSection::default()
    };
    if let Some(model) = chosen.and_then(|i| source.models.get(i)) {
        out.points = points(model, &source.data)?;
        out.budget = budget(model);
        out.curves = curves(model, &source.data)?;
    }
    Ok(out)
}

fn facts(source: &SourceResult) -> Vec<(String, String)> {
    let mut out = vec![
        ("Observations".to_owned(), format!("{} used of {} read", source.data.rows, source.n_read)),
        ("Configurations".to_owned(), {
            let names = source.data.configurations();
            if names.iter().all(String::is_empty) { "one, not named".to_owned() } else { names.join(", ") }
        }),
    ];
    if let Some(model) = source.models.first() {
        out.push(("Covariance".to_owned(), model.covariance_kind.clone()));
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
    if data.values("speed").is_some_and(|u| u.iter().any(|x| *x > 0.0)) && law_moves(model) {
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

fn law_moves(model: &ModelFit) -> bool {
    match &model.law.kind {
        froude_identify::law::Kind::Formulas(f) => f
            .iter()
            .flat_map(|f| &f.channels)
            .any(|c| matches!(froude_identify::law::aliased(c), "v_x" | "v_y" | "speed" | "angle")),
        _ => true,
    }
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
                unit: response_unit(data, response),
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
        for (input, (contribution, shared)) in shares(combined.type_a, j, &model.contributions) {
            out.push(BudgetRow {
                model: model.law.name.clone(),
                coefficient: spec.name.clone(),
                input,
                shared: shared.to_owned(),
                contribution,
                unit: spec.unit.clone(),
                share: if combined.standard > 0.0 { (contribution / combined.standard).powi(2) } else { 0.0 },
            });
        }
    }
    out
}

fn selection(source: &SourceResult) -> Vec<SelectionRow> {
    let best = source.estimates.iter().filter_map(|e| e.diagnostics.aicc).fold(f64::INFINITY, f64::min);
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
                unit: if model.law.in_logarithms() {
                    "1".to_owned()
                } else {
                    response_unit(&source.data, &component.name)
                },
                relative_residual: component.relative_residual,
                delta_aicc: diagnostics.aicc.map(|a| a - best),
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
        let angles = frequent(data, "angle", "speed", &rows);
        let speeds = frequent(data, "speed", "angle", &rows);
        let range = |name: &str| {
            let v = data.values(name).unwrap_or_default();
            rows.iter()
                .map(|&i| v.get(i).copied().unwrap_or(0.0))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
        };
        let (_, fastest) = range("speed");
        let (least, most) = range("angle");
        for angle in angles {
            let x = line(0.0, fastest);
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
        // The fewest degrees of freedom among the coefficients of this load: those of the clusters, say.
        let touches = |j: usize| (0..n).any(|i| slopes[(r * n + i, j)] != 0.0);
        let dof = (0..slopes.ncols())
            .filter(|&j| touches(j))
            .filter_map(|j| model.combined[j].map(|c| c.dof))
            .fold(f64::INFINITY, f64::min);
        let t = coverage_factor(dof);
        let half: Vec<f64> = (0..n)
            .map(|i| {
                let row: Vec<f64> = (0..slopes.ncols()).map(|j| slopes[(r * n + i, j)]).collect();
                t * model.prediction_std(&row)
            })
            .collect();
        let y = &y[r * n..(r + 1) * n];
        out.push(Curve {
            configuration: configuration.to_owned(),
            component: response.clone(),
            unit: response_unit(places, response),
            model: model.law.name.clone(),
            against: against.clone(),
            x: x.to_vec(),
            y: y.to_vec(),
            low: y.iter().zip(&half).map(|(y, h)| y - h).collect(),
            high: y.iter().zip(&half).map(|(y, h)| y + h).collect(),
        });
    }
    Ok(out)
}

/// Values of `held` at which at least three distinct values of `moving` were run, the most frequent first.
fn frequent(data: &Dataset, held: &str, moving: &str, rows: &[usize]) -> Vec<f64> {
    let (Some(held), Some(moving)) = (data.values(held), data.values(moving)) else { return Vec::new() };
    let key = |x: f64| (x * 1e4).round() as i64;
    let mut groups: std::collections::BTreeMap<i64, (f64, std::collections::BTreeSet<i64>)> =
        std::collections::BTreeMap::new();
    for &i in rows {
        groups
            .entry(key(held[i]))
            .or_insert_with(|| (held[i], std::collections::BTreeSet::new()))
            .1
            .insert(key(moving[i]));
    }
    let mut out: Vec<(usize, f64)> =
        groups.values().filter(|(_, m)| m.len() >= 3).map(|(value, m)| (m.len(), *value)).collect();
    out.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let mut values: Vec<f64> = out.into_iter().take(MOST_CURVES).map(|(_, v)| v).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn comparison_section(c: &Comparison) -> Option<ComparisonSection> {
    if c.coefficients.is_empty() && c.forces.is_empty() {
        return None;
    }
    let side =
        |source: &str, value: Option<f64>, standard: Option<f64>| Side { source: source.to_owned(), value, standard };
    let coefficients = c
        .coefficients
        .iter()
        .map(|r| CoefficientComparison {
            model: r.model.clone(),
            coefficient: r.coefficient.clone(),
            unit: r.unit.clone(),
            first: side(&r.first, r.value_first, None),
            second: side(&r.second, r.value_second, None),
            e_n: r.e_n.as_ref().ok().copied(),
            note: r.e_n.as_ref().err().cloned().unwrap_or_default(),
        })
        .collect();
    let joint = c
        .joint
        .iter()
        .map(|r| {
            let result = r.result.as_ref().ok();
            JointComparison {
                model: r.model.clone(),
                first: r.first.clone(),
                second: r.second.clone(),
                chi_squared: result.map(|x| x.0),
                dof: result.map_or(0.0, |x| x.1 as f64),
                p: result.map(|x| x.2),
                note: r.result.as_ref().err().cloned().unwrap_or_default(),
            }
        })
        .collect();
    let mut forces = Vec::new();
    for row in &c.forces {
        for other in 1..row.forces.len() {
            let (a, b) = (row.forces[0], row.forces[other]);
            let e_n = a.1.zip(b.1).map(|(x, y)| (a.0 - b.0) / (1.96 * x.hypot(y))).filter(|x| x.is_finite());
            forces.push(ForceComparison {
                configuration: format!("k = {}", row.n_links),
                component: row.component.clone(),
                unit: "N".to_owned(),
                speed_m_s: row.speed_m_s,
                angle_rad: row.angle_rad,
                first: side(&c.force_ids[0], Some(a.0), a.1),
                second: side(&c.force_ids[other], Some(b.0), b.1),
                e_n,
            });
        }
    }
    Some(ComparisonSection {
        intro: vec![
            "Coefficients of the same model are set side by side; their normalised difference E_n is stated only where both \
             sides state an uncertainty. Coefficients of one fit are collinear: the predicted forces over the common range \
             are what a user of the coefficients needs."
                .to_owned(),
        ],
        coefficients,
        joint,
        forces,
        notes: c.findings.iter().map(|f| f.message.clone()).collect(),
    })
}
