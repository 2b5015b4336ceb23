//! The report of an added mass: matrix, convergence, configurations.

use froude_panel::refine::Refined;
use froude_records::estimate::Estimate;
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Scale, Series, TextTable};

use super::facets::Facets;
use super::limits;
use super::links::{Configuration, LinksOutcome, no_fits};
use super::record::{MOTIONS, diagonal_head, diagonal_name, entry_name};
use super::several::SeveralOutcome;
use crate::outcome::BodyOutcome;
use crate::uncertain::with_uncertainty;

/// Part of the largest of its kind below which an entry is that of a symmetry, and of rounding.
const NOTHING: f64 = 1e-6;

/// The largest diagonal entry of a kind: of the translations, of the rotations.
fn kind(refined: &Refined, i: usize) -> f64 {
    (0..3).map(|k| refined.value[3 * (i / 3) + k][3 * (i / 3) + k].abs()).fold(0.0, f64::max)
}

/// Motions that have added mass: not the roll of a body of revolution.
fn motions(refined: &Refined) -> impl Iterator<Item = usize> + '_ {
    (0..6).filter(|&i| refined.value[i][i].abs() > NOTHING * kind(refined, i))
}

/// The matrix in kg, kg m, kg m², row by row.
#[must_use]
pub fn matrix_table(refined: &Refined, density_kg_m3: f64) -> TextTable {
    let rows = (0..6)
        .map(|i| {
            let cells = (0..6).map(|j| {
                let (value, u) = (density_kg_m3 * refined.value[i][j], density_kg_m3 * refined.uncertainty[i][j]);
                // Below its uncertainty, and zero by symmetry to rounding.
                if value.abs() <= u
                    && value.abs() < NOTHING * density_kg_m3 * (kind(refined, i) * kind(refined, j)).sqrt()
                {
                    "0".to_owned()
                } else {
                    with_uncertainty(value, u)
                }
            });
            std::iter::once(MOTIONS[i].to_owned()).chain(cells).collect()
        })
        .collect();
    TextTable {
        caption: "Added mass A: the load on the body is F = −A·v̇, force in the first three rows and moment in the last three. kg, kg m, \
                  kg m²; ± is the uncertainty of panels and facets, 95 %."
            .to_owned(),
        head: std::iter::once("").chain(MOTIONS).map(str::to_owned).collect(),
        rows,
    }
}

/// Diagonal without dimension: over ρV (ρVL² for rotations), and over ρLⁿ as WAMIT prints it.
#[must_use]
pub fn dimensionless_table(refined: &Refined, length_m: f64) -> TextTable {
    let v = refined.volume_m3;
    let rows = (0..6)
        .map(|i| {
            let [of_volume, of_length] =
                if i < 3 { [v, length_m.powi(3)] } else { [v * length_m.powi(2), length_m.powi(5)] };
            let of = |size: f64| with_uncertainty(refined.value[i][i] / size, refined.uncertainty[i][i] / size);
            vec![diagonal_name(i), of(of_volume), of(of_length)]
        })
        .collect();
    TextTable {
        caption: format!(
            "Diagonal without dimension; V = {} m³, L = {} m.",
            number::plain(v, 6),
            number::plain(length_m, 6)
        ),
        head: ["", "A/(ρV), A/(ρVL²) [1]", "A/(ρL³), A/(ρL⁵) [1], as WAMIT with ULEN = L"].map(str::to_owned).to_vec(),
        rows,
    }
}

/// Meshes, work and what they gave.
#[must_use]
pub fn steps_table(refined: &Refined, density_kg_m3: f64) -> TextTable {
    let rows = refined
        .steps
        .iter()
        .map(|s| {
            let a = &s.added_mass.matrix;
            let mut row = vec![s.panels.to_string(), s.unknowns.to_string(), s.iterations.to_string()];
            let is_zero = |i: usize| a[i][i].abs() < 1e-12 * kind(refined, i);
            row.extend((0..6).map(|i| number::plain(if is_zero(i) { 0.0 } else { density_kg_m3 * a[i][i] }, 6)));
            row.push(format!("{:.1e}", s.added_mass.asymmetry));
            row
        })
        .collect();
    let head = ["panels", "unknowns", "iterations"].map(str::to_owned).into_iter();
    let masses = (0..6).map(diagonal_head);
    TextTable {
        caption: "Meshes, the coarsest first. The last column is the largest raw asymmetry |A_ij − A_ji|/√(A_ii A_jj): an indicator, not an estimate \
                  of the error."
            .to_owned(),
        head: head.chain(masses).chain(["asymmetry [1]".to_owned()]).collect(),
        rows,
    }
}

/// Distance of each mesh's diagonal from the value given, over panels.
#[must_use]
pub fn convergence_chart(refined: &Refined, facets: Option<&Facets>) -> Chart {
    // Meshes converge to the facets that were given.
    let of_polyhedron = |i: usize| refined.value[i][i] - facets.map_or(0.0, |facets| facets.correction[i][i]);
    let panels: Vec<f64> = refined.steps.iter().map(|s| s.panels as f64).collect();
    let mut series: Vec<Series> = motions(refined)
        .map(|i| Series {
            name: diagonal_name(i),
            x: panels.clone(),
            y: refined.steps.iter().map(|s| (s.added_mass.matrix[i][i] / of_polyhedron(i) - 1.0).abs()).collect(),
            ..Series::default()
        })
        .collect();
    if let (Some(first), Some(last), Some(top)) =
        (panels.first(), panels.last(), series.iter().filter_map(|s| s.y.first()).copied().reduce(f64::max))
    {
        series.push(Series {
            name: "second order: 1/panels".to_owned(),
            mark: Mark::Dashed,
            x: vec![*first, *last],
            y: vec![top, top * first / last],
            ..Series::default()
        });
    }
    Chart {
        name: "convergence".to_owned(),
        title: "Convergence with the number of panels".to_owned(),
        caption: "Relative difference of each mesh's diagonal from the reported value.".to_owned(),
        x_label: "panels [1]".to_owned(),
        x_scale: Scale::Logarithmic,
        panels: vec![ChartPanel { y_label: "|A/A∞ − 1| [1]".to_owned(), y_scale: Scale::Logarithmic, series }],
    }
}

/// How the value came about.
#[must_use]
pub fn convergence_words(refined: &Refined) -> Vec<String> {
    let orders: Vec<String> =
        motions(refined).filter_map(|i| Some(format!("{} {:.2}", entry_name((i, i)), refined.order[i][i]?))).collect();
    let mut out = vec![if refined.steps.len() == 1 {
        "One mesh only: there is no numerical uncertainty; three meshes give one.".to_owned()
    } else if orders.is_empty() {
        "No order of convergence can be seen on these meshes: values are extrapolated with the second order all the same; check the meshes."
            .to_owned()
    } else {
        format!(
            "Observed order of convergence: {}. Flat panels of constant potential on a smooth body converge with order 2; edges lower it.",
            orders.join(", ")
        )
    }];
    out.push(match &refined.stopped {
        None if refined.worst < 1e-4 => {
            "The largest numerical uncertainty is less than 0.01 %.".to_owned()
        }
        None => format!(
            "The largest numerical uncertainty is {:.2} % (a diagonal entry relative to itself, another one to √(A_ii A_jj); an entry of rotation that is smaller than 1 % of the largest one, or of \
             ρV(L/2)², relative to that).",
            100.0 * refined.worst
        ),
        Some(why) if !refined.worst.is_finite() => format!("There is no finer one: {why}."),
        Some(why) => format!(
            "The largest numerical uncertainty is {:.2} %, more than was asked for: {why}.",
            100.0 * refined.worst
        ),
    });
    out
}

/// The configurations as Table 6 has them.
#[must_use]
pub fn links_table(configurations: &[Configuration], density_kg_m3: f64) -> TextTable {
    let rows = configurations
        .iter()
        .map(|c| {
            let r = &c.refined;
            let mass = |i: usize| with_uncertainty(density_kg_m3 * r.value[i][i], density_kg_m3 * r.uncertainty[i][i]);
            let part = |i: usize| with_uncertainty(r.value[i][i] / r.volume_m3, r.uncertainty[i][i] / r.volume_m3);
            let slender = number::plain(r.value[1][1] / c.length_m.powi(3), 4);
            vec![
                c.name.clone(),
                number::plain(1e3 * r.volume_m3, 5),
                mass(0),
                mass(1),
                mass(2),
                part(0),
                part(1),
                part(2),
                slender,
            ]
        })
        .collect();
    TextTable {
        caption: "Added mass of the configurations (HnLT: head, n links, tail), deeply submerged; C_A = μ/(ρV) (USR eq. 22), and the sway mass over ρL³ as WAMIT prints \
                  it. ± is the numerical uncertainty, 95 %."
            .to_owned(),
        head: ["", "V [10⁻³ m³]", "μ_x [kg]", "μ_y [kg]", "μ_z [kg]", "C_Ax [1]", "C_Ay [1]", "C_Az [1]", "μ_y/(ρL³) [1]"]
            .map(str::to_owned)
            .to_vec(),
        rows,
    }
}

/// Least squares over the configurations.
#[must_use]
pub fn fits_table(fits: &[Estimate]) -> TextTable {
    let rows = fits
        .iter()
        .flat_map(|e| {
            e.coefficients.iter().map(|(name, c)| {
                vec![
                    e.law.name.clone(),
                    name.clone(),
                    c.unit.clone(),
                    number::coefficient(c),
                    if e.recommended { "recommended".to_owned() } else { String::new() },
                ]
            })
        })
        .collect();
    TextTable {
        caption: "Least squares over the configurations (Table 7: displaced_volume). The standard uncertainty is that of the scatter about \
                  the law; the masses themselves are known far better."
            .to_owned(),
        head: ["model", "coefficient", "unit", "value", ""].map(str::to_owned).to_vec(),
        rows,
    }
}

fn links_chart(configurations: &[Configuration], density_kg_m3: f64) -> Chart {
    let x: Vec<f64> = configurations.iter().map(|c| c.links as f64).collect();
    let masses = |i: usize, name: &str| {
        let y: Vec<f64> = configurations.iter().map(|c| density_kg_m3 * c.refined.value[i][i]).collect();
        Series { name: name.to_owned(), mark: Mark::Points, x: x.clone(), y, ..Series::default() }
    };
    let panel = |y_label: &str, series| ChartPanel { y_label: y_label.to_owned(), y_scale: Scale::Linear, series };
    Chart {
        name: "links".to_owned(),
        title: "Added mass against the number of links".to_owned(),
        caption: "Lateral, vertical and axial added mass of the configurations.".to_owned(),
        x_label: "links [1]".to_owned(),
        x_scale: Scale::Linear,
        panels: vec![
            panel("μ_y, μ_z [kg]", vec![masses(1, "μ_y"), masses(2, "μ_z")]),
            panel("μ_x [kg]", vec![masses(0, "μ_x")]),
        ],
    }
}

/// What is said of a table of configurations: at the head, and of each.
#[must_use]
pub fn links(outcome: &LinksOutcome) -> (DocumentSection, Vec<DocumentSection>) {
    let LinksOutcome { name, density_kg_m3, place, configurations, fits, .. } = outcome;
    let rho = *density_kg_m3;
    let mut head = DocumentSection {
        title: "Configurations".to_owned(),
        paragraphs: vec![format!("{name}, density {rho} kg/m³. {place}")],
        tables: vec![links_table(configurations, rho)],
        charts: vec![links_chart(configurations, rho)],
    };
    head.paragraphs.extend(no_fits(configurations.len()));
    head.tables.extend(fits.iter().map(|fits| fits_table(&fits.estimates)));
    let mut blocks: Vec<DocumentSection> = configurations
        .iter()
        .map(|c| DocumentSection {
            title: c.name.clone(),
            paragraphs: convergence_words(&c.refined),
            tables: vec![matrix_table(&c.refined, rho), steps_table(&c.refined, rho)],
            charts: Vec::new(),
        })
        .collect();
    if let (Some(block), Some(last)) = (blocks.last_mut(), configurations.last()) {
        block.charts.push(convergence_chart(&last.refined, None));
    }
    (head, blocks)
}

/// What is said of one body.
#[must_use]
pub fn body(outcome: &BodyOutcome) -> DocumentSection {
    let rho = outcome.density_kg_m3;
    let mut out = DocumentSection {
        title: "Added mass".to_owned(),
        paragraphs: vec![format!("{}, density {rho} kg/m³.", outcome.name), outcome.place.clone()],
        tables: limits::table(&outcome.cases, rho).into_iter().collect(),
        charts: Vec::new(),
    };
    let is_one = outcome.cases.len() == 1;
    for (i, case) in outcome.cases.iter().enumerate() {
        let of_case = |table: TextTable| {
            let caption = if is_one {
                table.caption
            } else {
                format!("{} ({}). {}", case.title, case.surroundings, table.caption)
            };
            TextTable { caption, ..table }
        };
        let tables = [
            matrix_table(&case.refined, rho),
            dimensionless_table(&case.refined, outcome.length_m),
            steps_table(&case.refined, rho),
        ];
        out.tables.extend(tables.map(of_case));
        let words = convergence_words(&case.refined);
        out.paragraphs.push(format!("{} ({}). {}", case.title, case.surroundings, words.join(" ")));
        let chart = convergence_chart(&case.refined, case.facets.as_ref());
        let name = if is_one { chart.name } else { format!("{}-{}", chart.name, i + 1) };
        out.charts.push(Chart { name, title: format!("{}: {}", case.title, chart.title), ..chart });
    }
    out.tables.extend(outcome.tables.iter().cloned());
    out.paragraphs.extend(outcome.notes.iter().cloned());
    out
}

/// What is said of several parts.
#[must_use]
pub fn several(outcome: &SeveralOutcome) -> DocumentSection {
    let head = [format!("{}, density {} kg/m³.", outcome.name, outcome.density_kg_m3), outcome.place.clone()];
    DocumentSection {
        title: "Added mass, part by part".to_owned(),
        paragraphs: head.into_iter().chain(outcome.notes.iter().cloned()).collect(),
        tables: outcome.tables.clone(),
        charts: Vec::new(),
    }
}
