//! The facets of a mesh: what a smooth body with the same corners has more than the polyhedron, and how well that is known.
//!
//! Subdivision converges to the polyhedron. With A_r on the rounded mesh and A_f on the flat one, each divided once, the smooth body has C = 4/3 (A_r − A_f) more, since
//! one rounding takes three quarters of a second-order distance away. The matrix is corrected by C, and what is left of it has the expanded uncertainty
//!
//! U_ij = 0.7 m √((S_i + A_ii)(S_j + A_jj)), m² = mean of (C_ii/(S_i + A_ii))²
//!
//! with S the mass of the displaced water and its inertia about the point, over ρ: a surge that hardly changes errs by a part of what the others change by. What the errors of entries have in common is not known: the record takes them as independent.
//!
//! Source: our derivation; 0.7 by count over 64 tessellations, judged on 200 others (`validate facets`). Range: facets that turn by less than 52° from one to the next.

use froude_mesh::measure::Measure;
use froude_mesh::refine::{rounded, without_warp};
use froude_mesh::{Mesh, Vec3};
use froude_panel::mirror::{Kind, Mirror};
use froude_panel::problem::{Frame, Problem};
use froude_panel::refine::{Refined, Wanted, forecast, memory_bytes};
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::page::TextTable;

use super::frame::inertia_m5;
use super::load::WARP;
use super::record::diagonal_name;
use crate::outcome::Case;

/// Angle between facets from which an edge is an edge of the body, rad: seven segments to a circle still count as round.
const CREASE_RAD: f64 = 52.0 * core::f64::consts::PI / 180.0;
/// Expanded uncertainty of a correction, as part of the mean one.
const UNCERTAIN: f64 = 0.7;
/// A correction below this part is rounding: the edges of the mesh are edges of the body.
const NONE: f64 = 1e-9;

/// Residual above which a solution is none.
const LOOSE: f64 = 1e-6;

type Matrix = [[f64; 6]; 6];

/// What facets change, over ρ.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets {
    /// Smooth body minus polyhedron: it is in the value of the case.
    pub correction: Matrix,
    /// Its expanded uncertainty: it is in that of the case.
    pub uncertainty: Matrix,
    /// The same difference of the volumes, m³: it is in that of the case.
    pub volume_m3: f64,
    /// The mean correction m, as part of displaced water and added mass.
    pub mean: f64,
}

/// The facets of the body in one surrounding; `None` where all edges are edges of the body, otherwise why the correction is not known.
pub(super) fn of_mesh(
    mesh: &Mesh,
    case: &Case,
    wanted: &Wanted,
    frame: &Frame,
) -> Result<Option<Facets>, &'static str> {
    // The mesh divided once is the second of the family.
    let flat = case.refined.steps.get(1).ok_or("panels or memory do not allow a second mesh")?.added_mass.matrix;
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
    let problem = Problem::rigid(&round, mirrors);
    if problem.facets.len() > wanted.most_panels || forecast(&problem).memory_bytes > memory_bytes(wanted) {
        return Err("panels or memory do not allow the rounded mesh");
    }
    let solution = froude_panel::solve(&problem);
    let round = solution.added_mass(0).seen_from(frame).matrix;
    if solution.report.residual > LOOSE || round.iter().flatten().any(|a| !a.is_finite()) {
        return Err("the rounded mesh could not be solved on");
    }
    let value = &case.refined.value;
    let correction: Matrix = core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let apart = 4.0 / 3.0 * (round[i][j] - flat[i][j]);
            // Less than nothing is not left of an entry.
            if i == j { apart.max(-value[i][i]) } else { apart }
        })
    });
    let size = sizes(&case.refined, frame);
    let squares: f64 = (0..6).map(|i| (correction[i][i] / size[i]).powi(2)).sum();
    let mean = (squares / 6.0).sqrt();
    let uncertainty = uncertain(mean, size);
    let volume_m3 = 4.0 / 3.0 * (of_rounded_m3 - case.refined.volume_m3);
    Ok((mean > NONE).then_some(Facets { correction, uncertainty, volume_m3, mean }))
}

fn uncertain(mean: f64, size: [f64; 6]) -> Matrix {
    core::array::from_fn(|i| core::array::from_fn(|j| UNCERTAIN * mean * (size[i] * size[j]).max(0.0).sqrt()))
}

/// Displaced water and added mass of each motion, over ρ.
fn sizes(refined: &Refined, frame: &Frame) -> [f64; 6] {
    let turned = refined.steps.last().map_or([0.0; 3], |step| {
        let m = step.measure;
        inertia_m5(m.inertia_m5(), m.volume_m3, m.centroid_m, frame)
    });
    core::array::from_fn(|i| refined.value[i][i] + if i < 3 { refined.volume_m3 } else { turned[i - 3] })
}

impl Facets {
    /// The same in another surrounding, where the body has more or less added mass.
    fn beside(&self, here: &Refined, there: &Refined, frame: &Frame) -> Self {
        let root = |i: usize| (there.value[i][i] / here.value[i][i]).max(0.0).sqrt();
        let part = |i: usize| if here.value[i][i] > 0.0 { root(i) } else { 1.0 };
        let scaled = |of: &Matrix| core::array::from_fn(|i| core::array::from_fn(|j| of[i][j] * part(i) * part(j)));
        Self {
            correction: scaled(&self.correction),
            uncertainty: uncertain(self.mean, sizes(there, frame)),
            mean: self.mean,
            volume_m3: self.volume_m3,
        }
    }
}

/// Corrects all surroundings by the facets of the first.
pub(super) fn correct(cases: &mut [Case], facets: &Facets, frame: &Frame) {
    let Some(first) = cases.first().map(|case| case.refined.clone()) else { return };
    for case in cases {
        let own = facets.beside(&first, &case.refined, frame);
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

/// What was taken for granted: a body with facets of its own looks alike.
pub(super) fn finding(facets: &Facets) -> Finding {
    let text = format!(
        "the facets were taken for those of a smooth body, which changes displaced water and added mass by {} in the mean; if the facets are the body itself, ask for --polyhedron",
        number::percent(facets.mean)
    );
    Finding::new(Severity::Note, "facets-rounded", text)
}

/// What the facets change, entry by entry.
pub(super) fn table(case: &Case, density_kg_m3: f64) -> Option<TextTable> {
    let facets = case.facets.as_ref()?;
    let rows = (0..6).map(|i| {
        let (value, of_all) = (case.refined.value[i][i], case.refined.uncertainty[i][i]);
        let [apart, of_facets] = [facets.correction[i][i], facets.uncertainty[i][i]];
        let polyhedron = value - apart;
        let of_panels = (of_all * of_all - of_facets * of_facets).max(0.0).sqrt();
        vec![
            diagonal_name(i),
            number::plain(density_kg_m3 * polyhedron, 6),
            percent_of(of_panels, polyhedron).replace('+', ""),
            percent_of(apart, polyhedron),
            percent_of(of_facets, polyhedron).replace('+', ""),
        ]
    });
    Some(TextTable {
        caption: format!(
            "The matrix is that of the smooth body whose corners the mesh has: the polyhedron's, with the difference of the two on it. Edges of more than {:.0}° count as edges of the body. If the facets are the body, ask \
             for --polyhedron.",
            CREASE_RAD.to_degrees()
        ),
        head: [
            "",
            "polyhedron [kg, kg m²]",
            "uncertainty of the panels",
            "smooth body minus polyhedron",
            "its uncertainty",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
    })
}

fn percent_of(part: f64, whole: f64) -> String {
    if whole.abs() > 0.0 && part.is_finite() {
        format!("{:+.2} %", 100.0 * part / whole.abs())
    } else {
        "–".to_owned()
    }
}
