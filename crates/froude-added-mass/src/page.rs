//! The report of an added mass: matrix, convergence, configurations.

use froude_panel::refine::{Refined, Step};
use froude_records::block::{Block, ResultTable, Section, TableBuilder, facts};
use froude_records::estimate::words;
use froude_records::estimate::{Coefficient, Estimate};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark, Scale, Series};

use super::facet_correction::Facets;
use super::limits;
use super::links::{Configuration, LinksOutcome, no_fits};
use super::record::{MOTIONS, diagonal_head, diagonal_key, diagonal_name, entry_name};
use super::several::SeveralOutcome;
use crate::outcome::BodyOutcome;
use crate::uncertain::{expanded, told, with_uncertainty};

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
pub fn matrix_table(refined: &Refined, density_kg_m3: f64) -> ResultTable {
    let caption = "Added mass A: the load on the body is F = −A·v̇, force in the first three rows and moment in the last three. kg, kg m, \
                   kg m²; ± is the uncertainty of panels and facets, 95 %.";
    let t = TableBuilder::new("matrix", caption, &[0, 1, 2, 3, 4, 5]);
    let mut columns = vec![t.text("load", "load", |i: &usize| MOTIONS[*i].to_owned())];
    for j in 0..6 {
        let of = |i: &usize| [refined.value[*i][j], refined.uncertainty[*i][j]].map(|a| density_kg_m3 * a);
        let cell = |i: &usize| {
            let [value, u] = of(i);
            // Below its uncertainty, and zero by symmetry to rounding.
            let nothing = NOTHING * density_kg_m3 * (kind(refined, *i) * kind(refined, j)).sqrt();
            if value.abs() <= u && value.abs() < nothing { "0".to_owned() } else { with_uncertainty([value, u]) }
        };
        let [value, u, _] = expanded(&t, MOTIONS[j], "", of);
        columns.extend([value, u, t.text("", MOTIONS[j], cell)]);
    }
    let units = |i: &usize| (0..6).map(|j| ["kg", "kg m", "kg m²"][*i / 3 + j / 3].to_owned()).collect();
    columns.push(t.texts("units", "", units));
    t.build(columns)
}

/// Diagonal without dimension: over ρV (ρVL² for rotations), and over ρLⁿ as WAMIT prints it.
#[must_use]
pub fn dimensionless_table(refined: &Refined, length_m: f64) -> ResultTable {
    let v = refined.volume_m3;
    let caption =
        format!("Diagonal without dimension; V = {} m³, L = {} m.", number::plain(v, 6), number::plain(length_m, 6));
    let t = TableBuilder::new("dimensionless", caption, &[0, 1, 2, 3, 4, 5]);
    let over = |size: [f64; 2]| {
        move |i: &usize| [refined.value[*i][*i], refined.uncertainty[*i][*i]].map(|a| a / size[*i / 3])
    };
    let of_volume = over([v, v * length_m.powi(2)]);
    let of_length = over([length_m.powi(3), length_m.powi(5)]);
    let mut columns = vec![t.text("entry", "entry", |i| diagonal_name(*i))];
    columns.extend(expanded(&t, "of_volume", "A/(ρV), A/(ρVL²) [1]", of_volume));
    columns.extend(expanded(&t, "of_length", "A/(ρL³), A/(ρL⁵) [1], as WAMIT with ULEN = L", of_length));
    t.build(columns)
}

/// Meshes, work and what they gave.
#[must_use]
pub fn steps_table(refined: &Refined, density_kg_m3: f64) -> ResultTable {
    let caption = "Meshes, the coarsest first. The last column is the largest raw asymmetry |A_ij − A_ji|/√(A_ii A_jj): an indicator, not an estimate \
                   of the error.";
    let t = TableBuilder::new("meshes", caption, &refined.steps);
    let mut columns = vec![
        t.count("panels", "panels", |s| s.panels),
        t.count("unknowns", "unknowns", |s| s.unknowns),
        t.count("iterations", "iterations", |s| s.iterations),
    ];
    columns.extend((0..6).map(|i| {
        let of = |s: &Step| Some(s.added_mass.matrix[i][i]).filter(|a| a.abs() >= 1e-12 * kind(refined, i));
        t.number(&diagonal_key(i), &diagonal_head(i), |s| density_kg_m3 * of(s).unwrap_or(0.0)).plain(6)
    }));
    let words = |asymmetry: f64| format!("{asymmetry:.1e}");
    columns.extend(told(&t, "asymmetry", "asymmetry [1]", |s| s.added_mass.asymmetry, words));
    t.build(columns)
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
pub fn links_table(configurations: &[Configuration], density_kg_m3: f64) -> ResultTable {
    let caption = "Added mass of the configurations (HnLT: head, n links, tail), deeply submerged; C_A = μ/(ρV) (USR eq. 22), and the sway mass over ρL³ as WAMIT prints \
                   it. ± is the numerical uncertainty, 95 %.";
    let t = TableBuilder::new("configurations", caption, configurations);
    let mut columns = vec![t.text("configuration", "body", |c| c.name.clone())];
    let litres = |m3: f64| number::plain(1e3 * m3, 5);
    columns.extend(told(&t, "volume_m3", "V [10⁻³ m³]", |c| c.refined.volume_m3, litres));
    let of = |c: &Configuration, i: usize| [c.refined.value[i][i], c.refined.uncertainty[i][i]];
    for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let mass = |c: &Configuration| of(c, i).map(|a| density_kg_m3 * a);
        columns.extend(expanded(&t, &diagonal_key(i), &format!("μ_{axis} [kg]"), mass));
    }
    for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let part = |c: &Configuration| of(c, i).map(|a| a / c.refined.volume_m3);
        columns.extend(expanded(&t, &format!("c_a{axis}"), &format!("C_A{axis} [1]"), part));
    }
    let slender = |c: &Configuration| of(c, 1)[0] / c.length_m.powi(3);
    columns.push(t.number("sway_over_length", "μ_y/(ρL³) [1]", slender).plain(4));
    t.build(columns)
}

/// Least squares over the configurations.
#[must_use]
pub fn fits_table(fits: &[Estimate]) -> ResultTable {
    let rows: Vec<(&Estimate, &String, &Coefficient)> =
        fits.iter().flat_map(|e| e.coefficients.iter().map(move |(name, c)| (e, name, c))).collect();
    let caption = "Least squares over the configurations (Table 7: displaced_volume). The standard uncertainty is that of the scatter about \
                   the law; the masses themselves are known far better.";
    let t = TableBuilder::new("fits", caption, &rows);
    t.build(vec![
        t.text("model", "model", |(e, _, _)| e.law.name.clone()),
        t.text("coefficient", "coefficient", |(_, name, _)| (*name).clone()),
        t.text("unit", "unit", |(_, _, c)| c.unit.clone()),
        t.uncertain(["value", "standard_uncertainty"], "", |(_, _, c)| c.value, |(_, _, c)| c.standard_uncertainty),
        t.text("", "value", |(_, _, c)| words::coefficient(c)),
        t.text("", "choice", |(e, _, _)| if e.recommended { "recommended" } else { "" }.to_owned()),
        t.flag("recommended", "", |(e, _, _)| e.recommended),
    ])
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
pub fn links(outcome: &LinksOutcome) -> (Section, Vec<Section>) {
    let LinksOutcome { name, density_kg_m3, place, configurations, fits, .. } = outcome;
    let rho = *density_kg_m3;
    let said = std::iter::once(format!("{name}, density {rho} kg/m³. {place}")).chain(no_fits(configurations.len()));
    let mut head: Vec<Block> = vec![links_table(configurations, rho).into()];
    head.extend(fits.iter().map(|fits| fits_table(&fits.estimates).into()));
    head.extend([Block::words(said), links_chart(configurations, rho).into()]);
    let of = |c: &Configuration| {
        let f = facts("", "", &c.name);
        let blocks = vec![
            f.build(vec![f.text("configuration", "", String::clone)]).into(),
            Block::words(convergence_words(&c.refined)),
            matrix_table(&c.refined, rho).into(),
            steps_table(&c.refined, rho).into(),
        ];
        Section { key: "details[]".to_owned(), ..Section::new(c.name.clone(), blocks) }
    };
    let mut details: Vec<Section> = configurations.iter().map(of).collect();
    if let (Some(section), Some(last)) = (details.last_mut(), configurations.last()) {
        section.blocks.push(convergence_chart(&last.refined, None).into());
    }
    (Section::new("Configurations", head), details)
}

/// What is said of one body.
#[must_use]
pub fn body(outcome: &BodyOutcome) -> Section {
    let rho = outcome.density_kg_m3;
    let mut said = vec![format!("{}, density {rho} kg/m³.", outcome.name), outcome.place.clone()];
    let mut tables: Vec<Block> = limits::table(&outcome.cases, rho).map(Block::from).into_iter().collect();
    let mut charts: Vec<Block> = Vec::new();
    let is_one = outcome.cases.len() == 1;
    for (i, case) in outcome.cases.iter().enumerate() {
        let head = format!("{} ({}). ", case.title, case.surroundings);
        let of_case = |table: ResultTable| {
            let (key, caption) = (format!("{}/{}", case.key(), table.key), format!("{head}{}", table.caption));
            Block::from(if is_one { table } else { ResultTable { key, caption, ..table } })
        };
        let own = [
            matrix_table(&case.refined, rho),
            dimensionless_table(&case.refined, outcome.length_m),
            steps_table(&case.refined, rho),
        ];
        tables.extend(own.map(of_case));
        said.push(format!("{head}{}", convergence_words(&case.refined).join(" ")));
        let chart = convergence_chart(&case.refined, case.facets.as_ref());
        let name = if is_one { chart.name } else { format!("{}-{}", chart.name, i + 1) };
        charts.push(Chart { name, title: format!("{}: {}", case.title, chart.title), ..chart }.into());
    }
    tables.extend(outcome.tables.iter().cloned());
    said.extend(outcome.notes.iter().cloned());
    tables.push(Block::words(said));
    Section::new("Added mass", tables.into_iter().chain(charts))
}

/// What is said of several parts.
#[must_use]
pub fn several(outcome: &SeveralOutcome) -> Section {
    let head = [format!("{}, density {} kg/m³.", outcome.name, outcome.density_kg_m3), outcome.place.clone()];
    let said = Block::words(head.into_iter().chain(outcome.notes.iter().cloned()));
    Section::new("Added mass, part by part", outcome.tables.iter().cloned().chain([said]))
}
