//! Forces that the estimates predict over the range that they share.

use froude_records::comparison::{Comparison, LoadComparison, coverage_note};
use froude_records::estimate::{Estimate, Range};
use froude_records::finding::{Finding, Severity};
use froude_records::units::Dimension;

use super::coefficients::{e_n, noted};
use super::contradiction::{axes_not_tied, density_differs};
use super::independence::{origins, same_data};
use crate::common::{self, Common, Number};
use crate::compare::named::Named;
use crate::compare::stated::Stated;
use crate::dataset::Dataset;
use crate::law::ForceLaw;

/// Speeds and angles at which forces are predicted, per axis of the common range.
const FORCE_POINTS: usize = 5;

/// Whether an estimate's law gives forces along the body or across it from the motion that is set side by side; others have no part in its range.
pub(super) fn gives_forces(estimate: &Estimate) -> bool {
    let one = Range { low: 1.0, high: 1.0, unit: String::new() };
    let data = operating_points(&one, &one, &[1.0], 1000.0);
    ForceLaw::of_estimate(estimate, &data).is_ok_and(|law| {
        law.responses.iter().any(|r| r == "f_x" || r == "f_y")
            && law.channels().iter().all(|c| data.values(c).is_some())
    })
}

/// Forces by the recommended estimates over the common range of speed and angle.
pub(super) fn predict_forces(all: &[Named<'_>], labels: &[String], out: &mut Comparison) {
    let all: Vec<(&Named<'_>, &String)> = all.iter().zip(labels).filter(|(n, _)| gives_forces(n.estimate)).collect();
    let recommended: Vec<_> = all.iter().copied().filter(|(n, _)| n.estimate.recommended).collect();
    let chosen = if recommended.len() >= 2 { recommended } else { all };
    let range = |name: &str| -> Option<Range> {
        let stated: Vec<&Range> = chosen.iter().filter_map(|(n, _)| n.estimate.validity.get(name)).collect();
        let first = stated.first()?;
        Some(Range {
            low: stated.iter().map(|r| r.low).fold(f64::NEG_INFINITY, f64::max),
            high: stated.iter().map(|r| r.high).fold(f64::INFINITY, f64::min),
            unit: first.unit.clone(),
        })
    };
    let Some(speed) = range("speed") else { return };
    let angle = range("angle").unwrap_or(Range { low: 0.0, high: 0.0, unit: "rad".to_owned() });
    if speed.low > speed.high || angle.low > angle.high {
        out.findings.push(Finding::new(
            Severity::Warning,
            "no-common-range",
            "the fitted ranges of speed or angle do not overlap: no force can be compared without extrapolation"
                .to_owned(),
        ));
        return;
    }
    let links = range("n_links");
    if links.as_ref().is_some_and(|r| r.low > r.high) {
        out.findings.push(Finding::new(
            Severity::Warning,
            "no-common-range",
            "the numbers of links that were tested do not overlap: no force can be compared without extrapolation"
                .to_owned(),
        ));
        return;
    }
    let has_links = links.is_some()
        || chosen.iter().any(|(n, _)| froude_hydro::DragModel::from_name(&n.estimate.law.name).is_some());
    let links: Vec<f64> =
        links.map_or_else(|| vec![1.0], |r| if r.low == r.high { vec![r.low] } else { vec![r.low, r.high] });
    let data = operating_points(
        &speed,
        &angle,
        &links,
        chosen.first().and_then(|(n, _)| n.estimate.density()).map_or(1000.0, |d| d.value),
    );
    let (mut predictions, mut ids) = (Vec::new(), Vec::new());
    for &(n, label) in &chosen {
        let Ok(law) = ForceLaw::of_estimate(n.estimate, &data) else { continue };
        let values: Option<Vec<f64>> =
            law.coefficients.iter().map(|c| n.estimate.coefficients.get(&c.name)?.value).collect();
        let Some(values) = values else { continue };
        let (Ok(force), Ok(slopes)) = (law.predict(&data, &values), law.regressors(&data, &values)) else { continue };
        ids.push(label.clone());
        predictions.push((law, force, slopes, n));
    }
    if predictions.len() < 2 {
        return;
    }
    for (.., n) in &predictions {
        if !n.estimate.validity.contains_key("speed") {
            out.findings.push(
                Finding::new(
                    Severity::Note,
                    "range-not-stated",
                    format!(
                        "{} states no range of speed and angle: whether its forces are extrapolated is not known",
                        n.estimate.id
                    ),
                )
                .of_source(&n.estimate.source),
            );
        }
    }
    let first = predictions[0].3.estimate;
    for (.., other) in &predictions[1..] {
        // Of one model it is said already.
        if first.law.name != other.estimate.law.name {
            out.findings.extend(axes_not_tied(first, other.estimate));
            out.findings.extend(density_differs(first, other.estimate));
            out.findings.extend(common::findings(&[Common::of(first, other.estimate)]));
        }
    }
    let predicted_by: Vec<Named<'_>> = predictions.iter().map(|(.., n)| **n).collect();
    let origins = origins(&predicted_by);
    let is_same_data: Vec<bool> = (0..predicted_by.len())
        .map(|j| same_data([&predicted_by[0], &predicted_by[j]], [&origins[0], &origins[j]]))
        .collect();
    let commons: Vec<Common<'_>> = predicted_by.iter().map(|n| Common::of(first, n.estimate)).collect();
    for component in ["f_x", "f_y"] {
        for i in 0..data.rows {
            let sides: Vec<Number<'_>> = predictions
                .iter()
                .map(|(law, force, slopes, n)| {
                    let Some(r) = law.responses.iter().position(|name| name == component) else {
                        return Number::of_nothing(n.estimate);
                    };
                    let row = r * data.rows + i;
                    let slope = |name: &str| law.position(name).map_or(0.0, |j| slopes[(row, j)]);
                    Number::of_number(n.estimate, Some(force[row]).filter(|f| f.is_finite()), slope)
                })
                .collect();
            let forces: Vec<Stated> = sides.iter().map(|side| side.stated).collect();
            if forces.iter().all(|f| f.value.is_none()) {
                continue;
            }
            for j in 1..forces.len() {
                let missing = [0, j].into_iter().find(|k| forces[*k].value.is_none());
                let (e_n, note) = noted(match missing {
                    Some(k) => Err(format!("{} gives no {component}", ids[k])),
                    None => e_n([&sides[0], &sides[j]], &commons[j], [&ids[0], &ids[j]], is_same_data[j]),
                });
                out.loads.push(LoadComparison {
                    component: component.to_owned(),
                    unit: "N".to_owned(),
                    n_links: data.values("n_links").map(|v| v[i]).filter(|_| has_links),
                    speed_m_s: data.values("speed").map_or(0.0, |v| v[i]),
                    angle_rad: data.values("angle").map_or(0.0, |v| v[i]),
                    first: forces[0].of(&ids[0]),
                    second: forces[j].of(&ids[j]),
                    e_n,
                    note,
                });
            }
        }
    }
    let of = |id: &String| {
        let sides = out.loads.iter().flat_map(|row| [&row.first, &row.second]);
        coverage_note(id, sides.filter(|side| &side.source == id))
    };
    out.coverage = if out.loads.is_empty() { Vec::new() } else { ids.iter().map(of).collect() };
}

fn operating_points(speed: &Range, angle: &Range, links: &[f64], density: f64) -> Dataset {
    let grid = |r: &Range| -> Vec<f64> {
        if r.high - r.low <= 1e-12 {
            vec![r.high]
        } else {
            (0..FORCE_POINTS).map(|k| r.low + (r.high - r.low) * k as f64 / (FORCE_POINTS - 1) as f64).collect()
        }
    };
    let (mut u, mut a, mut k) = (Vec::new(), Vec::new(), Vec::new());
    for &n in links {
        for &s in &grid(speed) {
            for &t in &grid(angle) {
                u.push(s);
                a.push(t);
                k.push(n);
            }
        }
    }
    let rows = u.len();
    let mut data = Dataset { rows, ..Dataset::default() };
    data.put("speed", u, Dimension::SPEED);
    data.put("angle", a, Dimension::ONE);
    data.put("n_links", k, Dimension::ONE);
    data.put("density", vec![density; rows], Dimension::DENSITY);
    data.put("f_x", vec![0.0; rows], Dimension::FORCE);
    data.put("f_y", vec![0.0; rows], Dimension::FORCE);
    data.velocity_from_speed_and_angle();
    data
}
