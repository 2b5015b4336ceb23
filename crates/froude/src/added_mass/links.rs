//! The robot with 1 to k links: the table of the USR paper (Table 6), and its least squares (Table 7).
//!
//! Source: Kelasidi, Elgenes & Kilvær, eq. 22: μ = ρ V C_A, with V the volume of the configuration.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use froude_panel::problem::Frame;
use froude_records::body::{Shape, read_body};
use froude_records::estimate::{Estimate, EstimateFile, keyed};
use froude_records::finding::{Finding, Severity};
use froude_records::json::write_estimates;
use froude_records::write::write_atomically;

use super::family::{Family, robot};
use super::frame::{Axes, Orientation, sentence};
use super::load::is_body_file;
use super::page;
use super::record::{About, estimate, mesh_file, of_the_mesh, replaces_another_frame};
use super::refine::{Refined, Wanted, refine};
use crate::Error;
use crate::pipeline::{Job, identify};

/// What to compute.
#[derive(Debug, Clone)]
pub struct LinksJob {
    /// A body file of shape `robot`.
    pub body: PathBuf,
    /// Numbers of links.
    pub links: Vec<usize>,
    /// Density instead of the file's, kg/m³.
    pub density_kg_m3: Option<f64>,
    /// Axes of the matrices.
    pub axes: Axes,
    /// Tolerance, limits.
    pub wanted: Wanted,
    /// Folder of the results; beside the body file, unless stated.
    pub out: Option<PathBuf>,
    /// Date for the report.
    pub date: Option<String>,
}

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
    /// Least squares over them: `displaced_volume`, `per_link`, `affine`.
    pub fits: Vec<Estimate>,
    /// The record.
    pub file: EstimateFile,
    /// Where it lies.
    pub estimate: PathBuf,
    /// Where the page lies.
    pub page: PathBuf,
    /// The table of the configurations.
    pub table: PathBuf,
    /// The message about a record in another frame that this one has replaced.
    pub replaced: Option<String>,
}

/// Where the moments of every configuration are taken about.
const MIDDLE: &str = "the middle of the body";
/// Fewest configurations that the least squares make sense with.
const FIT: usize = 3;

/// Computes every configuration, fits them, writes `links.csv`, `campaign.toml`, `estimate.json` and `report.html`.
///
/// # Errors
///
/// See [`Error`].
pub fn links(job: &LinksJob, progress: &dyn Fn(&str)) -> Result<LinksOutcome, Error> {
    if !is_body_file(&job.body) {
        return Err(not_links(&job.body));
    }
    let body = read_body(&job.body)?;
    let Shape::Robot { .. } = body.shape else { return Err(not_links(&job.body)) };
    let density_kg_m3 = job.density_kg_m3.or(body.density_kg_m3).ok_or_else(|| no_density(&job.body))?;
    let out = job.out.clone().unwrap_or_else(|| default_out(&job.body));
    crate::results::can_be_written(&out)?;
    let wanted = Wanted {
        frame: Frame { axes: job.axes.vectors(Orientation::default()), ..Frame::at([0.0; 3]) },
        ..job.wanted.clone()
    };
    let mut configurations = Vec::new();
    for &links in &job.links {
        let name = format!("H{links}LT");
        let family = Family::of(&body.shape, links);
        let refined = refine(&family, &wanted, &|step| progress(&format!("{name}: {step}")))?;
        let length_m = robot(&body.shape).length_m(links);
        configurations.push(Configuration { links, name, length_m, refined });
    }
    let mut outcome = None;
    crate::results::replace(&out, |folder| {
        let done = written(job, &body.name, density_kg_m3, configurations, folder, progress)?;
        outcome = Some(LinksOutcome { replaced: replaces_another_frame(&out, &done.file), ..done });
        Ok(())
    })?;
    // It is there: the folder was filled.
    let outcome = outcome.ok_or_else(|| Error::Nothing("no configuration was computed".to_owned()))?;
    Ok(LinksOutcome {
        estimate: out.join("estimate.json"),
        page: out.join("report.html"),
        table: out.join("links.csv"),
        ..outcome
    })
}

/// Everything in `folder`, and what it says.
fn written(
    job: &LinksJob,
    name: &str,
    density_kg_m3: f64,
    configurations: Vec<Configuration>,
    folder: &Path,
    progress: &dyn Fn(&str),
) -> Result<LinksOutcome, Error> {
    let table = folder.join("links.csv");
    write_atomically(&table, csv(&configurations, density_kg_m3).as_bytes())?;
    let campaign = folder.join("campaign.toml");
    write_atomically(&campaign, campaign_text(name, density_kg_m3).as_bytes())?;
    let mut findings = Vec::new();
    let mut fits = Vec::new();
    if configurations.len() >= FIT {
        progress("least squares over the configurations");
        let done = identify(&Job { date: job.date.clone(), ..Job::new(&campaign) }, &|_| {})?;
        fits.clone_from(&done.file.estimates);
        // Computed masses have no noise and no instrument: what these two state about tests does not hold for them.
        let is_of_tests = |f: &Finding| f.code == "no-budget" || f.code == "serial-correlation";
        findings.extend(done.file.findings.into_iter().filter(|f| !is_of_tests(f)));
    }
    findings.extend(configurations.iter().filter_map(|c| not_within(&c.name, &c.refined)));
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let matrices = configurations.iter().map(|c| {
        let about = About {
            source: c.name.clone(),
            density_kg_m3,
            frame: job.axes.own_words().to_owned(),
            reference_point: MIDDLE.to_owned(),
            length_m: c.length_m,
            surroundings: "unbounded water".to_owned(),
        };
        estimate(&c.refined, &about)
    });
    let file = EstimateFile {
        data: keyed(vec![mesh_file(&job.body)?]),
        versions: crate::results::versions(),
        findings,
        ..EstimateFile::of(fits.iter().cloned().chain(matrices).map(of_the_mesh).collect())
    };
    let place = sentence(job.axes.own_words(), MIDDLE);
    let html = page::links(name, density_kg_m3, &place, &configurations, &fits, &file, job.date.clone()).html()?;
    let (estimate, page) = (folder.join("estimate.json"), folder.join("report.html"));
    write_estimates(&estimate, &file)?;
    write_atomically(&page, html.as_bytes())?;
    let (name, replaced) = (name.to_owned(), None);
    Ok(LinksOutcome { name, density_kg_m3, place, configurations, fits, file, estimate, page, table, replaced })
}

/// Why there are no least squares over so few configurations; `None` where there are.
#[must_use]
pub fn no_fits(configurations: usize) -> Option<String> {
    (configurations < FIT).then(|| {
        format!(
            "No least squares: they need {FIT} configurations at least, such as --links 1..{FIT}, and these are {configurations}. \
             links.csv and campaign.toml are written all the same; there is no campaign-results, and the record holds the matrices alone."
        )
    })
}

/// Why nothing in kilograms can be said.
pub(super) fn no_density(path: &Path) -> Error {
    Error::Nothing(format!(
        "{}: no density of the water; write --density \"1025 kg/m^3\", or [fluid] density in the body file",
        path.display()
    ))
}

/// Why a number of links says nothing here.
pub(super) fn not_links(path: &Path) -> Error {
    Error::Nothing(format!(
        "{}: --links counts the links of a body file of shape \"robot\"; leave it out for another shape, or a mesh",
        path.display()
    ))
}

/// A finding where the tolerance was not reached.
pub(super) fn not_within(name: &str, refined: &Refined) -> Option<Finding> {
    let why = refined.stopped.as_ref()?;
    let message = if refined.worst.is_finite() {
        format!("{name}: the numerical uncertainty is {:.2} % where less was asked for: {why}", 100.0 * refined.worst)
    } else {
        format!("{name}: the numerical uncertainty is not known: {why}")
    };
    Some(Finding::new(Severity::Warning, "not-converged", message))
}

/// `mamba/body.toml` → `mamba/body-added-mass`.
pub(super) fn default_out(input: &Path) -> PathBuf {
    let stem = input.file_stem().map_or_else(|| "body".to_owned(), |s| s.to_string_lossy().into_owned());
    input.with_file_name(format!("{stem}-added-mass"))
}

pub(super) fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
}

fn csv(configurations: &[Configuration], density_kg_m3: f64) -> String {
    let mut out = "configuration,n_links [1],mu_x [kg],mu_y [kg],mu_z [kg],volume [m^3]\n".to_owned();
    for c in configurations {
        let mu = |i: usize| density_kg_m3 * c.refined.value[i][i];
        let _ = writeln!(
            out,
            "{},{},{:.7e},{:.7e},{:.7e},{:.7e}",
            c.name,
            c.links,
            mu(0),
            mu(1),
            mu(2),
            c.refined.volume_m3
        );
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
