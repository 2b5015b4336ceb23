//! The facets of a mesh: the difference between the smooth body with the same corners and the polyhedron, and its uncertainty.
//!
//! Subdivision converges to the polyhedron. With A_r on the rounded mesh and A_f on the flat one, each divided once, the smooth body has C = 4/3 (A_r − A_f) more, since
//! one rounding takes three quarters of a second-order distance away. The value is that of the smooth body, and its expanded uncertainty is
//!
//! U_ij = max(|C_ij|, |A_ij| |ΔV|/V) + U_ij of the panels
//!
//! with ΔV the same difference of the volumes: the interval contains the smooth body and the polyhedron, because a mesh alone does not tell which of them is meant. Where the
//! body is said to be smooth, the first term counts by [`OF_SMOOTH`].
//!
//! Source: our derivation; coverage by count (`validate facets`). Range: see [`froude_mesh::refine::rounded`] for the edges that are rounded.

use froude_mesh::crossing::crossings;
use froude_mesh::measure::Measure;
use froude_mesh::refine::{rounded, without_warp};
use froude_mesh::{Mesh, Vec3};
use froude_panel::mirror::{Kind, Mirror};
use froude_panel::problem::{Frame, Problem, Solution};
use froude_panel::refine::{Refined, RefinedParts, Wanted, forecast, memory_bytes};
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::finding::{Finding, Severity};
use froude_records::number;

use super::facet_correction::{Facets, Matrix, uncertain};
use super::frame::inertia_m5;
use super::load::WARP;
use super::record::{diagonal_name, unit};
use crate::outcome::Case;
use crate::uncertain::{signed_percent, told};

/// Angle between facets from which an edge is an edge of the body, rad: seven segments to a circle still count as round.
const CREASE_RAD: f64 = 52.0 * core::f64::consts::PI / 180.0;
/// Expanded uncertainty of a correction of a body that is said to be smooth, as part of the correction.
const OF_SMOOTH: f64 = 0.7;
/// A correction below this part is rounding: the edges of the mesh are edges of the body.
const NONE: f64 = 1e-9;

/// Solutions with a larger residual are rejected.
const LOOSE: f64 = 1e-6;

/// The facets of the body in one surrounding; `None` where all edges are edges of the body, otherwise why the correction is not known.
pub(super) fn of_mesh(
    mesh: &Mesh,
    case: &Case,
    wanted: &Wanted,
    frame: &Frame,
    is_smooth: bool,
) -> Result<Option<Facets>, &'static str> {
    // The mesh divided once is the second of the family.
    let flat = case.refined.steps.get(1).ok_or(NO_SECOND)?.added_mass.matrix;
    let round = without_warp(&rounded(mesh, CREASE_RAD), WARP);
    let mirrors: &[Mirror] = &case.refined.finest.mirrors;
    let is_through = |m: &Mirror| {
        let side = |v: &Vec3| v[m.axis] > m.at_m;
        m.kind != Kind::Body && round.vertices.iter().any(|v| side(v) != side(&mesh.vertices[0]))
    };
    if mirrors.iter().any(is_through) {
        return Err("rounded, the body would pierce the water's surface");
    }
    let of_rounded_m3 = Measure::of(&round).volume_m3;
    let round = solved(&Problem::rigid(&round, mirrors), wanted)?.added_mass(0).seen_from(frame).matrix;
    let value = &case.refined.value;
    let correction: Matrix = core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let apart = LEFT * (round[i][j] - flat[i][j]);
            // The added mass itself does not become negative.
            if i == j { apart.max(-value[i][i]) } else { apart }
        })
    });
    let size = sizes(&case.refined, frame);
    let squares: f64 = (0..6).map(|i| (correction[i][i] / size[i]).powi(2)).sum();
    let mean = (squares / 6.0).sqrt();
    let volume_m3 = LEFT * (of_rounded_m3 - case.refined.volume_m3);
    let parts = (0..3).map(|i| (correction[i][i] / value[i][i]).abs()).filter(|part| part.is_finite());
    let largest = parts.fold((volume_m3 / case.refined.volume_m3).abs(), f64::max);
    let part = counted(is_smooth);
    let volume_uncertainty_m3 = part * volume_m3.abs();
    let mut out = Facets { correction, uncertainty: [[0.0; 6]; 6], volume_m3, volume_uncertainty_m3, largest, part };
    out.uncertainty = out.uncertainty_of(&case.refined);
    Ok((mean > NONE).then_some(out))
}

/// Why there is no correction where the body was solved on one mesh only.
const NO_SECOND: &str = "panels or memory do not allow a second mesh";
/// Whole difference over that of one rounding, which leaves a quarter.
const LEFT: f64 = 4.0 / 3.0;

/// Part of the correction that is uncertain.
const fn counted(is_smooth: bool) -> f64 {
    if is_smooth { OF_SMOOTH } else { 1.0 }
}

/// The rounded mesh solved on, where that is allowed.
fn solved(problem: &Problem, wanted: &Wanted) -> Result<Solution, &'static str> {
    if problem.facets.len() > wanted.most_panels || forecast(problem).memory_bytes > memory_bytes(wanted) {
        return Err("panels or memory do not allow the rounded mesh");
    }
    let solution = froude_panel::solve(problem);
    if solution.report.residual > LOOSE || solution.matrix.iter().flatten().any(|a| !a.is_finite()) {
        return Err("the rounded mesh could not be solved");
    }
    Ok(solution)
}

/// Displaced water and added mass of each motion, over ρ.
fn sizes(refined: &Refined, frame: &Frame) -> [f64; 6] {
    let turned = refined.steps.last().map_or([0.0; 3], |step| {
        let m = step.measure;
        inertia_m5(m.inertia_m5(), m.volume_m3, m.centroid_m, frame)
    });
    core::array::from_fn(|i| refined.value[i][i] + if i < 3 { refined.volume_m3 } else { turned[i - 3] })
}

/// Corrects all surroundings by the facets of the first.
pub(super) fn correct(cases: &mut [Case], facets: &Facets) {
    let Some(first) = cases.first().map(|case| case.refined.clone()) else { return };
    for case in cases {
        let own = facets.beside(&first, &case.refined);
        for i in 0..6 {
            for j in 0..6 {
                case.refined.value[i][j] += own.correction[i][j];
                case.refined.uncertainty[i][j] = case.refined.uncertainty[i][j].hypot(own.uncertainty[i][j]);
            }
        }
        case.refined.volume_m3 += own.volume_m3;
        case.facets = Some(own);
    }
}

/// Corrects the matrix of several parts by their facets as that of one body; the largest correction of displaced water and of added mass along the axes, as part of each, `None`
/// where all edges are edges of the bodies.
pub(super) fn correct_parts(
    refined: &mut RefinedParts,
    mesh: &Mesh,
    of_mesh: &dyn Fn(&Mesh) -> (Problem, Vec<f64>),
    wanted: &Wanted,
    is_smooth: bool,
) -> Result<Option<f64>, &'static str> {
    let flat = refined.once_divided.as_ref().ok_or(NO_SECOND)?;
    let smooth = without_warp(&rounded(mesh, CREASE_RAD), WARP);
    let (problem, round_m3) = of_mesh(&smooth);
    let (_, flat_m3) = of_mesh(mesh);
    if !crossings(&smooth).is_empty() {
        return Err("rounded, the parts would cross");
    }
    let round = solved(&problem, wanted)?.matrix;
    let changed: Vec<f64> = flat_m3.iter().zip(round_m3).map(|(flat, round)| LEFT * (round - flat) / flat).collect();
    let part = counted(is_smooth);
    let mut squares = 0.0;
    let mut largest = changed.iter().fold(0.0_f64, |largest, part| largest.max(part.abs()));
    for i in 0..flat.len() {
        for j in 0..flat.len() {
            let symmetric = |of: &[Vec<f64>]| 0.5 * (of[i][j] + of[j][i]);
            let value = refined.value[i][j];
            let apart = LEFT * (symmetric(&round) - symmetric(flat));
            let correction = if i == j { apart.max(-value) } else { apart };
            let volume = |k: usize| part * changed[k / 6].abs() / (1.0 + changed[k / 6]);
            let panels = refined.uncertainty[i][j];
            refined.value[i][j] += correction;
            refined.uncertainty[i][j] =
                panels.hypot(uncertain([value, correction], volume(i).max(volume(j)), part, panels));
            if i == j && i % 6 < 3 {
                squares += (correction / (value + flat_m3[i / 6])).powi(2);
                largest = if value > 0.0 { largest.max((correction / value).abs()) } else { largest };
            }
        }
    }
    let mean = (squares / (0.5 * flat.len() as f64)).sqrt();
    Ok((mean > NONE).then_some(largest))
}

/// Adds a note or a finding: whether the facets were taken as a smooth body, how large the largest correction is, or why there is none.
pub(super) fn report(
    largest: Result<Option<f64>, &'static str>,
    is_smooth: bool,
    notes: &mut Vec<String>,
    findings: &mut Vec<Finding>,
) {
    match largest {
        Ok(Some(_)) if is_smooth => notes.push(IS_SMOOTH.to_owned()),
        Ok(Some(largest)) => findings.push(finding(largest)),
        // Nothing could be rounded.
        Ok(None) if is_smooth => findings.push(not_rounded(
            "--smooth was given, and no edge belongs to a curve of three turns or more, each of 52° at most; export the body in finer facets",
        )),
        Ok(None) => notes.push(IS_SHARP.to_owned()),
        Err(why) => findings.push(not_rounded(why)),
    }
}

/// The mesh does not decide which body is meant.
fn finding(largest: f64) -> Finding {
    let text = format!(
        "the mesh may be a smooth body or the polyhedron itself, which differ by up to {} in displaced water and in added mass along the axes: the values are those of the smooth body and the intervals \
         contain both; to decide, write --smooth (smooth body, narrower intervals) or --polyhedron",
        number::percent(largest)
    );
    Finding::new(Severity::Note, "facets-rounded", text)
}

/// The facets could not be rounded.
fn not_rounded(why: &str) -> Finding {
    let text = format!(
        "the matrix is that of the polyhedron; the faceting error is unknown and not included in the uncertainty: {why}"
    );
    Finding::new(Severity::Warning, "facets-not-rounded", text)
}

/// Notes that state which body the facets were taken as.
pub(super) const IS_POLYHEDRON: &str = "The facets were taken as the body itself.";
const IS_SMOOTH: &str = "The facets were taken as those of a smooth body.";
const IS_SHARP: &str =
    "No edge was taken for one of a curve of three turns or more, each of 52° at most: the facets are the body itself.";

/// What the facets change, entry by entry.
pub(super) fn table(case: &Case, density_kg_m3: f64, is_smooth: bool) -> Option<ResultTable> {
    let facets = case.facets.as_ref()?;
    let polyhedron = |i: usize| case.refined.value[i][i] - facets.correction[i][i];
    let of_panels = |i: usize| {
        let (all, facets) = (case.refined.uncertainty[i][i], facets.uncertainty[i][i]);
        (all * all - facets * facets).max(0.0).sqrt()
    };
    let part = |i: usize, x: f64| {
        let whole = polyhedron(i).abs();
        (whole > 0.0 && x.is_finite()).then(|| x / whole)
    };
    let unsigned = |part: f64| signed_percent(part).replace('+', "");
    let caption = format!(
        "The matrix is that of the smooth body with the corners of the mesh: polyhedron plus difference. Edges of more than {:.0}°, and those that belong to no curve of three turns or more, count as edges of \
         the body. The two uncertainties add up. {}",
        CREASE_RAD.to_degrees(),
        if is_smooth { IS_SMOOTH } else { "--smooth and --polyhedron state which body is meant." }
    );
    let t = TableBuilder::new("facets", caption, &[0, 1, 2, 3, 4, 5]);
    let mut columns = vec![
        t.text("entry", "entry", |i| diagonal_name(*i)),
        t.text("unit", "", |i| unit(*i, *i).to_owned()),
        t.number("polyhedron", "polyhedron [kg, kg m²]", |i| density_kg_m3 * polyhedron(*i)).plain(6),
    ];
    columns.extend(told(&t, "panels", "uncertainty of the panels", |i| part(*i, of_panels(*i)), unsigned));
    let head = "smooth body minus polyhedron";
    columns.extend(told(&t, "difference", head, |i| part(*i, facets.correction[*i][*i]), signed_percent));
    let of_facets = |i: &usize| part(*i, case.refined.uncertainty[*i][*i] - of_panels(*i));
    columns.extend(told(&t, "facets", "its uncertainty", of_facets, unsigned));
    Some(t.build(columns))
}
