//! What is said of the results of a CFD campaign: by `froude cfd collect` to a person, and by `froude identify` in the record.

use crate::collect::Collected as Row;
use crate::outcome::{Outcome, Status};
use crate::section::CfdSpec;
use crate::wall::{MeshQuality, SUBLAYER, std_of_wall};
use froude_records::campaign::Source;
use froude_records::estimate::ErrorKind;
use froude_records::finding::{Finding, Severity};
use froude_records::number::{count, percent, significant};
use froude_records::text::counted;

use super::asked::OUTDATED;
use super::collect::Collected;
use super::numerical;

/// Difference of repeats, of ½ρU²A, from which it is a warning: as the largest drift that a case may end with.
const APART: f64 = 0.01;

/// Cases without a result that counts: which, and why.
pub(super) fn of_missing(collected: &Collected) -> Option<Finding> {
    let (id, why) = collected.without.first()?;
    let more = collected.without.len() - 1;
    let others = if more > 0 { format!("; and {more} more, which froude cfd status lists") } else { String::new() };
    let text = format!(
        "{} no result that counts and {} not fitted: {id}: {why}{others}",
        counted(collected.without.len(), "case has", "cases have"),
        if more == 0 { "is" } else { "are" }
    );
    Some(Finding::new(Severity::Warning, "cfd-cases-missing", text))
}

/// What the results themselves show.
pub(super) fn of_collected(collected: &Collected) -> Vec<Finding> {
    let rows = &collected.rows;
    let outdated = || Finding::new(Severity::Warning, "cfd-plan-outdated", OUTDATED.to_owned());
    let mut out: Vec<Finding> = collected.is_outdated.then(outdated).into_iter().collect();
    out.extend(of_meshes(rows));
    out.extend(of_wall(rows));
    for (code, what, words) in [
        (
            "cfd-start",
            "from the inflow",
            "repeated from the inflow, which shows the remaining effect of the initial fields",
        ),
        (
            "cfd-two-models",
            "laminar",
            "computed with both models; the table has the turbulent result, and no interval includes the difference",
        ),
    ] {
        if let Some(([x, y], n)) = collected.apart(what) {
            let text = format!(
                "{} {words}; f_x differs by at most {} of ½ρU²A, f_y by {}",
                counted(n, "case is", "cases are"),
                percent(x),
                percent(y)
            );
            let severity = if x.max(y) > APART { Severity::Warning } else { Severity::Note };
            out.push(Finding::new(severity, code, text));
        }
    }
    out.extend(collected.of_one_side().map(|text| Finding::new(Severity::Note, "cfd-one-sided", text)));
    let is_known = rows.first().is_some_and(|row| collected.numerical.std_of_mesh(&row.case).is_some());
    let sentences = numerical::sentences(&collected.numerical, rows).into_iter();
    out.extend(sentences.enumerate().map(|(i, text)| {
        let severity = if i == 0 && !is_known { Severity::Warning } else { Severity::Note };
        Finding::new(severity, "cfd-mesh-error", text)
    }));
    out
}

/// What the flow is computed as, which the plan says before it runs.
pub(super) fn of_flows(collected: &Collected, spec: &CfdSpec, source: &Source) -> Vec<Finding> {
    let rows = &collected.rows;
    let mut out = Vec::new();
    let early = rows.iter().filter(|row| row.case.is_tripped_too_early()).count();
    if early > 0 {
        let text = format!(
            "{} with a turbulence model at a Reynolds number (based on width) below {}, where the boundary layer is laminar; use laminar_below or both_below in [source.cfd] to compute without the model",
            counted(early, "case is computed", "cases are computed"),
            count(crate::case::LAMINAR_REYNOLDS as usize)
        );
        out.push(Finding::new(Severity::Warning, "cfd-laminar-layer", text));
    }
    if spec.tank.is_some() {
        let text = "the walls, the bottom and the surface of the tank are slip planes; the surface stays flat, so the loads contain no waves";
        out.push(Finding::new(Severity::Note, "cfd-tank", text.to_owned()));
    }
    let swinging = rows.iter().filter(|row| row.outcome.status == Status::Oscillating).count();
    if swinging > 0 {
        let text = format!(
            "{} about a steady mean, or drifted by at most 1 % of ½ρU²A when all iterations were done; the remaining change is part of the iterative error",
            counted(swinging, "case oscillated", "cases oscillated")
        );
        out.push(Finding::new(Severity::Note, "cfd-oscillating", text));
    }
    if !source.uncertainty.iter().any(|entry| entry.kind == ErrorKind::ModelForm) {
        let text = "no error of the model form is declared: add [[source.uncertainty]] with quantity = \"f_x\", standard = \"20 %\", shared = \"campaign\" and kind = \"model_form\", and with \"10 %\" for f_y, until tank data give better values";
        out.push(Finding::new(Severity::Note, "cfd-model-form", text.to_owned()));
    }
    out
}

/// Quality of the meshes where it is worst, and y+.
fn of_meshes(rows: &[Row]) -> Option<Finding> {
    let known: Vec<MeshQuality> = rows.iter().filter_map(|row| row.outcome.mesh).collect();
    let largest = |of: fn(&MeshQuality) -> f64| known.iter().map(of).fold(0.0, f64::max);
    let mut text = if known.is_empty() {
        format!("the quality of the mesh is not recorded for {}", counted(rows.len(), "case", "cases"))
    } else {
        let worst = known.iter().min_by(|a, b| a.area_coverage().total_cmp(&b.area_coverage()))?;
        let layers = match worst.layers {
            Some(layers) => format!(
                "layers cover at least {} of the body's area ({} of {} layers on average)",
                percent(layers.area_coverage),
                significant(layers.achieved, 3),
                layers.requested
            ),
            None => "O-grids, whose layers cover the whole body".to_owned(),
        };
        format!(
            "meshes of {}: {layers}; non-orthogonality up to {:.0}°, skewness up to {}",
            counted(known.len(), "case", "cases"),
            largest(|m| m.max_non_orthogonality_rad).to_degrees(),
            significant(largest(|m| m.max_skewness), 2)
        )
    };
    let y_plus: Vec<[f64; 3]> = rows.iter().filter_map(|row| row.outcome.y_plus).collect();
    if !y_plus.is_empty() {
        let mean = |f: fn(f64, f64) -> f64, from: f64| y_plus.iter().map(|y| y[1]).fold(from, f);
        text += &format!(
            "; y+ {} to {} on average, {} at most",
            significant(mean(f64::min, f64::INFINITY), 2),
            significant(mean(f64::max, 0.0), 2),
            significant(y_plus.iter().map(|y| y[2]).fold(0.0, f64::max), 2)
        );
    }
    Some(Finding::new(Severity::Note, "cfd-mesh", text))
}

/// Cases whose loads are uncertain by what the mesh at the wall does not resolve.
fn of_wall(rows: &[Row]) -> Option<Finding> {
    let part = |row: &Row| {
        let (std, loads) = (std_of_wall(&row.case, &row.outcome), row.outcome.loads.unwrap_or_default());
        let largest = |all: &[f64; 6]| all[..3].iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        2.0 * largest(&std) / largest(&loads).max(f64::MIN_POSITIVE)
    };
    let own: Vec<&Row> = rows.iter().filter(|row| part(row) > SEEN).collect();
    let most = own.iter().map(|row| part(row)).fold(0.0, f64::max);
    let has = |of: &dyn Fn(&Outcome) -> bool| own.iter().any(|row| of(&row.outcome));
    let mut advice = Vec::new();
    if has(&|o| o.mesh.is_some_and(|m| 1.0 - m.area_coverage() > SEEN)) {
        advice.push("layers are missing on a part of the body: make surface_cell of mesh in [source.cfd] smaller");
    }
    if has(&|o| o.y_plus.is_some_and(|y| y[1] > SUBLAYER)) {
        advice.push("the mean y+ is above 5, where the wall conditions interpolate: make first_layer of mesh in [source.cfd] thinner");
    }
    (!own.is_empty()).then(|| {
        let text = format!(
            "the mesh does not resolve the wall in {}, which adds an uncertainty of at most ±{} of the load (95 %): {}",
            counted(own.len(), "case", "cases"),
            percent(most),
            advice.join("; ")
        );
        Finding::new(Severity::Warning, "cfd-wall", text)
    })
}

/// Part of a load, or of the wall, that is worth a sentence.
const SEEN: f64 = 0.02;
