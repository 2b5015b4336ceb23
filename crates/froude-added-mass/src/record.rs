//! A matrix as an estimate.

use std::path::Path;

use froude_panel::refine::Refined;
use froude_records::estimate::{
    Coefficient, Derived, Diagnostics, ErrorKind, Estimate, EstimateFile, Frame, Interval, Law, Measured, MethodUsed,
    OWN, ReferencePoint, SharedError, Signs, TypeA,
};
use froude_records::json::read_estimates;
use indexmap::IndexMap;

use crate::facet_correction::Facets;

/// Coverage factor of a numerical uncertainty: it is stated as an interval of 95 %.
const COVERAGE: f64 = 2.0;

/// What the covariance says, and what it takes for granted.
const COVARIANCE: &str = "discretisation error, 95 % taken as k = 2: the part common to all entries fully correlated, the rest of each entry independent";

/// Motions in the order of the matrix.
pub const MOTIONS: [&str; 6] = ["surge", "sway", "heave", "roll", "pitch", "yaw"];

/// Unit of an entry in kg.
#[must_use]
pub const fn unit(i: usize, j: usize) -> &'static str {
    match i / 3 + j / 3 {
        0 => "kg",
        1 => "kg*m",
        _ => "kg*m^2",
    }
}

/// What the record says beside the numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct About {
    /// Source: the configuration, or the name of the body.
    pub source: String,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Axes in words.
    pub frame: String,
    /// ReferencePoint in words.
    pub reference_point: String,
    /// From end to end along x, m.
    pub length_m: f64,
    /// What surrounds the body, in words.
    pub surroundings: String,
}

/// The frame of a record, in words.
fn place_of(file: &EstimateFile) -> Option<String> {
    file.estimates.last().map(|e| format!("{}; moments about {}", e.frame.words, e.point.words))
}

/// The frame of the record that lies in a folder, in words; to be asked before another takes its place.
#[must_use]
pub fn place_in(out: &Path) -> Option<String> {
    place_of(&read_estimates(&out.join("estimate.json")).ok()?)
}

/// A sentence where a record in another frame has taken the place of one in a folder: the two look alike, and the entries of one are not those
/// of the other.
#[must_use]
pub fn replaces_another_frame(out: &Path, before: &str, new: &EstimateFile) -> Option<String> {
    (place_of(new)? != before).then(|| {
        format!(
            "The earlier record in {} is replaced. It had another frame: {before}. To keep both, give each its folder with --out.",
            out.display()
        )
    })
}

/// Entries on and above the diagonal, in the order of the record.
fn entries() -> impl Iterator<Item = (usize, usize)> + Clone {
    (0..6).flat_map(|i| (i..6).map(move |j| (i, j)))
}

/// `A11` … `A66`.
#[must_use]
pub fn entry_name((i, j): (usize, usize)) -> String {
    format!("A{}{}", i + 1, j + 1)
}

/// The same of several parts, six rows and columns each: `A22_1_3`, the sway force on the first part from the sway of the third.
#[must_use]
pub fn entry_name_of_parts((i, j): (usize, usize)) -> String {
    format!("{}_{}_{}", entry_name((i % 6, j % 6)), i / 6 + 1, j / 6 + 1)
}

/// An entry of the diagonal with its motion and its unit, as the head of a column: `A22 sway [kg]`.
#[must_use]
pub fn diagonal_head(i: usize) -> String {
    format!("{} {} [{}]", entry_name((i, i)), MOTIONS[i], if i < 3 { "kg" } else { "kg m²" })
}

/// The same as a key: `sway_kg`.
#[must_use]
pub fn diagonal_key(i: usize) -> String {
    format!("{}_{}", MOTIONS[i], if i < 3 { "kg" } else { "kg_m2" })
}

/// The same without its unit, as the name of a row: `A22 sway`.
#[must_use]
pub fn diagonal_name(i: usize) -> String {
    format!("{} {}", entry_name((i, i)), MOTIONS[i])
}

/// Covariance of the entries: on its diagonal the squares of their standard uncertainties, beside it what they have in common. `None` where
/// there is one mesh only.
fn covariance(refined: &Refined, facets: Option<&Facets>, rho: f64) -> Option<TypeA> {
    let common = |(i, j): (usize, usize), (k, l): (usize, usize)| -> f64 {
        refined.shared.iter().map(|s| rho * s[i][j] * rho * s[k][l]).sum()
    };
    let element = |a: (usize, usize), b: (usize, usize)| {
        let of_facets = facets.map_or(0.0, |facets| facets.uncertainty[a.0][a.1]);
        let square = refined.uncertainty[a.0][a.1].powi(2) - of_facets.powi(2);
        let alone = (rho / COVERAGE).powi(2) * square.max(0.0);
        if a == b { alone.max(common(a, a)) } else { common(a, b) }
    };
    let matrix: Vec<Vec<f64>> = entries().map(|a| entries().map(|b| element(a, b)).collect()).collect();
    let is_known = matrix.iter().flatten().all(|c| c.is_finite());
    is_known.then(|| TypeA {
        names: entries().map(entry_name).collect(),
        dof: vec![None; matrix.len()],
        matrix,
        kind: COVARIANCE.to_owned(),
    })
}

/// The error of the facets. Whether the body is smooth is one unknown, which moves all entries together by their corrections; what an entry has beyond
/// that is its own.
fn of_facets(facets: &Facets, rho: f64) -> (String, SharedError) {
    let components = 1 + entries().count();
    let along = |row: usize, (i, j): (usize, usize)| {
        let [common, size] =
            [facets.part * facets.correction[i][j], facets.uncertainty[i][j]].map(|expanded| rho * expanded / COVERAGE);
        let own = (size * size - common * common).max(0.0).sqrt();
        let mut out = vec![0.0; components];
        (out[0], out[1 + row]) = (common, own);
        out
    };
    let error = SharedError {
        name: "facets of the mesh: smooth body or polyhedron".to_owned(),
        quantity: "facets".to_owned(),
        kind: ErrorKind::B,
        covariance: (0..components).map(|a| (0..components).map(|b| f64::from(u8::from(a == b))).collect()).collect(),
        dof: None,
        limits: None,
        sensitivity: entries().enumerate().map(|(row, entry)| along(row, entry)).collect(),
    };
    (format!("{OWN}facets"), error)
}

/// Volume and mass of the displaced water with the uncertainty of the facets; without facets the volume is exact.
fn displacement(volume_m3: f64, facets: &Facets, rho: f64) -> IndexMap<String, Derived> {
    let derived = |formula: &str, scale: f64, unit: &str| {
        let (value, expanded) = (scale * volume_m3, scale * facets.volume_uncertainty_m3);
        Derived {
            formula: formula.to_owned(),
            value: Some(value),
            unit: unit.to_owned(),
            standard_uncertainty: Some(expanded / COVERAGE),
            interval_95: Some([value - expanded, value + expanded]),
        }
    };
    IndexMap::from([
        ("volume".to_owned(), derived("volume", 1.0, "m^3")),
        ("displaced_mass".to_owned(), derived("density*volume", rho, "kg")),
    ])
}

/// The estimate of model `added_mass_6x6`: entries A11 to A66 on and above the diagonal; the matrix is symmetric.
#[must_use]
pub fn estimate(refined: &Refined, facets: Option<&Facets>, about: &About) -> Estimate {
    let rho = about.density_kg_m3;
    let mut coefficients = IndexMap::new();
    for (i, j) in entries() {
        let (value, expanded) = (rho * refined.value[i][j], rho * refined.uncertainty[i][j]);
        coefficients.insert(entry_name((i, j)), entry(value, expanded, unit(i, j)));
    }
    let measured = |value: f64, unit: &str| Measured { value, unit: unit.to_owned() };
    let refers_to = IndexMap::from([
        ("density".to_owned(), measured(rho, "kg/m^3")),
        ("volume".to_owned(), measured(refined.volume_m3, "m^3")),
        ("length".to_owned(), measured(about.length_m, "m")),
    ]);
    let steps = refined.steps.iter().map(|s| s.panels.to_string()).collect::<Vec<_>>().join(", ");
    let covariance = covariance(refined, facets, rho);
    let errors = facets.filter(|_| covariance.is_some()).map(|facets| of_facets(facets, rho));
    let words = format!(
        "potential flow, constant-strength panels, direct formulation, {}; meshes of {steps} panels{}",
        about.surroundings,
        match (refined.steps.len() > 1, facets) {
            (_, Some(_)) => ", extrapolated and corrected to the smooth body with the corners of the mesh",
            (true, None) => ", extrapolated",
            (false, None) => "",
        }
    );
    let point = about.reference_point.clone();
    Estimate {
        refers_to,
        coefficients,
        derived: facets.map(|facets| displacement(refined.volume_m3, facets, rho)).unwrap_or_default(),
        type_a: covariance,
        errors: errors.into_iter().collect(),
        diagnostics: Diagnostics {
            notes: vec![format!(
                "raw asymmetry of the finest mesh {:.1e}; the symmetric part is given",
                refined.steps.last().map_or(0.0, |s| s.added_mass.asymmetry)
            )],
            ..Diagnostics::default()
        },
        ..of_panels(&about.source, ("added_mass_6x6", 1), &about.frame, point, words)
    }
}

/// An entry in kg with its expanded uncertainty; none is stated where that is not known.
pub(super) fn entry(value: f64, expanded: f64, unit: &str) -> Coefficient {
    let known = expanded.is_finite();
    let standard = known.then_some(expanded / COVERAGE);
    Coefficient {
        value: Some(value),
        unit: unit.to_owned(),
        standard_uncertainty: standard,
        type_b: standard,
        interval_95: known.then_some([value - expanded, value + expanded]),
        ..Coefficient::default()
    }
}

/// What every matrix states of itself: source, law with its version, axes and point, and how it was made.
pub(super) fn of_panels(
    source: &str,
    (law, version): (&str, u32),
    frame: &str,
    point: String,
    words: String,
) -> Estimate {
    Estimate {
        id: format!("{source}/{law}"),
        source: source.to_owned(),
        kind: "potential".to_owned(),
        law: Law { name: law.to_owned(), version, ..Law::default() },
        frame: Frame { words: frame.to_owned(), ..Frame::default() },
        point: ReferencePoint { words: point, stated: true },
        signs: Signs(
            "loads of the fluid on the body are F = −A·v̇, with A the matrix and v̇ the accelerations".to_owned(),
        ),
        interval: Interval { of: "mesh".to_owned(), ..Interval::default() },
        method: MethodUsed { name: "panels".to_owned(), version: 1, words },
        recommended: true,
        reason: Some("the only model of its source".to_owned()),
        ..Estimate::default()
    }
}
