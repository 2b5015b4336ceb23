//! The robot with 1 to k links: the table of the USR paper (Table 6), and its least squares (Table 7).
//!
//! Source: Kelasidi, Elgenes & Kilvær, eq. 22: μ = ρ V C_A, with V the volume of the configuration.

use std::fmt::Write as _;

use crate::body_file::{Shape, read_body};
use froude_identify::IdentifyError;
use froude_identify::dataset::Dataset;
use froude_identify::law::ForceLaw;
use froude_identify::method::Export;
use froude_identify::seam::{Reduced, fit};
use froude_identify::source::SourceResult;
use froude_panel::problem::Frame;
use froude_panel::refine::{Refined, Wanted, refine};
use froude_records::campaign::{Identify, SourceKind};
use froude_records::estimate::{Estimate, Range};
use froude_records::finding::Finding;
use froude_records::texts::Texts;
use froude_records::units::Dimension;
use indexmap::IndexMap;

use super::frame::{Orientation, sentence};
use super::load::{NO_LINKS, is_body_file};
use super::options::Asked;
use super::record::{About, estimate};
use super::shape::family;
use crate::error::AddedMassError;
use crate::outcome::not_within;
use crate::water::Water;

/// One configuration.
#[derive(Debug, Clone)]
pub struct Configuration {
    /// Links.
    pub links: usize,
    /// `H3LT`.
    pub name: String,
    /// From tip to tip, m.
    pub length_m: f64,
    /// The matrix.
    pub refined: Refined,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct LinksOutcome {
    /// Name of the body.
    pub name: String,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Axes and point of the matrices, in words.
    pub place: String,
    /// The configurations.
    pub configurations: Vec<Configuration>,
    /// A record for each.
    pub estimates: Vec<Estimate>,
    /// Least squares over them: `displaced_volume`, `per_link`, `affine`; `None` of so few that they say nothing.
    pub fits: Option<SourceResult>,
    /// Doubts.
    pub findings: Vec<Finding>,
    /// The table of the configurations, and the campaign that fits it.
    pub exports: Vec<Export>,
}

/// Where the moments of every configuration are taken about.
const MIDDLE: &str = "the middle of the body";
/// Fewest configurations that the least squares make sense with.
const FIT: usize = 3;

/// Laws of the least squares, with the formula of each mass.
const LAWS: [(&str, [&str; 3]); 3] = [
    ("displaced_volume", ["C_Ax*volume*density", "C_Ay*volume*density", "C_Az*volume*density"]),
    ("per_link", ["m_link_x*n_links", "m_link*n_links", "m_link_z*n_links"]),
    ("affine", ["m_link_x*n_links + m_ends_x", "m_link*n_links + m_ends", "m_link_z*n_links + m_ends_z"]),
];
/// Masses that are fitted.
const MASSES: [&str; 3] = ["mu_x", "mu_y", "mu_z"];

/// Computes every configuration and fits them; the estimates are called after `source`, or after their configurations where that is empty.
///
/// # Errors
///
/// See [`AddedMassError`].
pub fn links(
    job: &Asked,
    water: &Water,
    source: &str,
    progress: &dyn Fn(&str),
) -> Result<LinksOutcome, AddedMassError> {
    let not_links = || AddedMassError::input(&job.input, NO_LINKS);
    if !is_body_file(&job.input) {
        return Err(not_links());
    }
    let body = read_body(&job.input)?;
    let Shape::Robot(robot) = body.shape else { return Err(not_links()) };
    let density_kg_m3 = water.density_kg_m3(job, body.density_kg_m3)?;
    let wanted = Wanted {
        frame: Frame { axes: job.axes.vectors(Orientation::default()), ..Frame::at([0.0; 3]) },
        ..job.wanted.clone()
    };
    let mut configurations = Vec::new();
    for &links in &job.links {
        let name = format!("H{links}LT");
        let refined = refine(&family(&body.shape, links), &wanted, &|step| progress(&format!("{name}: {step}")))?;
        let length_m = robot.length_m(links);
        configurations.push(Configuration { links, name, length_m, refined });
    }
    let rows: Vec<Row> = configurations.iter().map(|c| Row::of(c, density_kg_m3)).collect();
    let mut fits = None;
    if configurations.len() >= FIT {
        progress("least squares over the configurations");
        let of = if source.is_empty() { "potential flow" } else { source };
        fits = Some(least_squares(of, &rows, density_kg_m3)?);
    }
    let mut findings: Vec<Finding> =
        fits.iter_mut().flat_map(|fits| std::mem::take(&mut fits.findings)).filter(|f| !is_of_tests(f)).collect();
    findings.extend(configurations.iter().filter_map(|c| not_within(&c.name, &c.refined)));
    let estimates = configurations.iter().map(|c| {
        let about = About {
            source: if source.is_empty() { c.name.clone() } else { format!("{source}, {}", c.name) },
            density_kg_m3,
            frame: job.axes.own_words().to_owned(),
            reference_point: MIDDLE.to_owned(),
            length_m: c.length_m,
            surroundings: "unbounded water".to_owned(),
        };
        estimate(&c.refined, None, &about)
    });
    Ok(LinksOutcome {
        place: sentence(job.axes.own_words(), MIDDLE),
        estimates: estimates.collect(),
        fits,
        findings,
        exports: vec![
            Export { name: "links.csv".to_owned(), content: csv(&rows).into_bytes() },
            Export { name: "campaign.toml".to_owned(), content: campaign_text(&body.name, density_kg_m3).into_bytes() },
        ],
        name: body.name,
        density_kg_m3,
        configurations,
    })
}

/// Computed masses have no noise and no instrument: what is said of tests does not hold for them.
fn is_of_tests(finding: &Finding) -> bool {
    finding.code == "no-budget" || finding.code == "serial-correlation"
}

/// A configuration as a row of `links.csv`.
struct Row {
    name: String,
    links: usize,
    /// μ_x, μ_y, μ_z in kg and the volume in m³, as they are written.
    numbers: [String; 4],
}

impl Row {
    fn of(c: &Configuration, density_kg_m3: f64) -> Self {
        let mu = |i: usize| density_kg_m3 * c.refined.value[i][i];
        let numbers = [mu(0), mu(1), mu(2), c.refined.volume_m3].map(|x| format!("{x:.7e}"));
        Self { name: c.name.clone(), links: c.links, numbers }
    }
}

/// The laws fitted to the numbers as they stand in the table, so that whoever fits the table has the same.
fn least_squares(source: &str, rows: &[Row], density_kg_m3: f64) -> Result<SourceResult, IdentifyError> {
    let n = rows.len();
    let mut data = Dataset {
        rows: n,
        configuration: rows.iter().map(|row| row.name.clone()).collect(),
        setup: Texts::repeated("", n),
        run: Texts::repeated("", n),
        line: (2..2 + n).collect(),
        ..Dataset::default()
    };
    data.put("n_links", rows.iter().map(|row| row.links as f64).collect(), Dimension::ONE);
    let written = |k: usize| rows.iter().map(|row| row.numbers[k].parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
    for (k, name) in MASSES.into_iter().enumerate() {
        data.put(name, written(k), Dimension::MASS);
    }
    data.put("volume", written(3), Dimension::VOLUME);
    data.put("density", vec![density_kg_m3; n], Dimension::DENSITY);
    let law = |(name, formulas): (&str, [&str; 3])| {
        let texts: IndexMap<String, String> =
            MASSES.into_iter().zip(formulas).map(|(mass, formula)| (mass.to_owned(), formula.to_owned())).collect();
        ForceLaw::formulas(name, &texts, &data)
    };
    let laws = LAWS.into_iter().map(law).collect::<Result<Vec<_>, _>>()?;
    let numbers = || rows.iter().map(|row| row.links as f64);
    let [low, high] = [numbers().fold(f64::INFINITY, f64::min), numbers().fold(0.0, f64::max)];
    let validity = IndexMap::from([("n_links".to_owned(), Range { low, high, unit: "1".to_owned() })]);
    let reduced = Reduced::new(source, SourceKind::Potential, "table", data, laws);
    fit(Reduced { validity, ..reduced }, &Identify::default(), &|_| {})
}

/// Why there are no least squares over so few configurations; `None` where there are.
#[must_use]
pub fn no_fits(configurations: usize) -> Option<String> {
    (configurations < FIT).then(|| {
        format!(
            "No least squares: they need {FIT} configurations at least, such as --links 1..{FIT}, and there are {configurations}. \
             links.csv and campaign.toml are written all the same, and the record holds the matrices alone."
        )
    })
}

fn csv(rows: &[Row]) -> String {
    let mut out = "configuration,n_links [1],mu_x [kg],mu_y [kg],mu_z [kg],volume [m^3]\n".to_owned();
    for Row { name, links, numbers } in rows {
        let _ = writeln!(out, "{name},{links},{}", numbers.join(","));
    }
    out
}

fn campaign_text(name: &str, density_kg_m3: f64) -> String {
    // A text of TOML, whatever the name holds.
    let name = toml::Value::from(name);
    format!(
        r#"# Least squares over the configurations of links.csv, as Table 7 of the USR paper has them; made by `froude added-mass`.
schema = 1
name = {name}

[fluid]
density = "{density_kg_m3} kg/m^3"

[[source]]
name  = "potential flow"
kind  = "potential"
table = "links.csv"

[identify]

[[identify.model]]
name = "displaced_volume"      # Table 7, eq. 23: mu = V rho C_A
mu_x = "C_Ax*volume*density"
mu_y = "C_Ay*volume*density"
mu_z = "C_Az*volume*density"   # not in the paper

[[identify.model]]
name = "per_link"              # through the origin: eq. 24, its n read as the number of links
mu_x = "m_link_x*n_links"      # mu_x and mu_z are not in the paper
mu_y = "m_link*n_links"
mu_z = "m_link_z*n_links"

[[identify.model]]
name = "affine"
mu_x = "m_link_x*n_links + m_ends_x"
mu_y = "m_link*n_links + m_ends"
mu_z = "m_link_z*n_links + m_ends_z"
"#
    )
}
