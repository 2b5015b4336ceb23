//! One body or mesh: what is computed of it, in which frame, and what results.

use std::path::{Path, PathBuf};

use froude_mesh::measure::Measure;
use froude_mesh::{Mesh, Vec3};
use froude_panel::problem::Frame;
use froude_records::estimate::{EstimateFile, keyed};
use froude_records::number;
use froude_records::page::TextTable;

use super::cross_checks;
use super::exports::{self, extras};
use super::facets::geometry;
use super::family::Family;
use super::frame::{Axes, Orientation, Point, inertia_m5, sentence};
use super::limits;
use super::links::{default_out, no_density, not_within};
use super::load::{Loaded, load};
use super::page;
use super::record::{About, estimate, mesh_file, of_the_mesh, replaces_another_frame};
use super::refine::{Forecast, Refined, Wanted, plan, refine};
use super::spectral;
use super::surroundings::surroundings;
use crate::Error;

/// What to compute.
#[derive(Debug, Clone)]
pub struct BodyJob {
    /// A body file (.toml) or a mesh.
    pub input: PathBuf,
    /// Links of a robot.
    pub links: Option<usize>,
    /// Density instead of the file's, kg/m³.
    pub density_kg_m3: Option<f64>,
    /// Axes of the result.
    pub axes: Axes,
    /// Where moments are taken about.
    pub at: Point,
    /// Metres for a unit of the mesh; `None` where it is not stated.
    pub unit_m: Option<f64>,
    /// How the mesh lies; `None` where nobody said: x forward, z up.
    pub orientation: Option<Orientation>,
    /// Height of the water's surface over the origin of the mesh, m; `None`: deeply submerged.
    pub surface_m: Option<f64>,
    /// Length, breadth and depth of water of a tank with the origin in the middle of its plan, m.
    pub tank_m: Option<[f64; 3]>,
    /// Tolerance and limits.
    pub wanted: Wanted,
    /// Files to write beside the record: `1`, `nc`, `csv`.
    pub export: Vec<&'static str>,
    /// Folder of the results; beside the input, unless stated.
    pub out: Option<PathBuf>,
    /// Date for the report.
    pub date: Option<String>,
}

/// A matrix in one surrounding.
#[derive(Debug, Clone)]
pub struct Case {
    /// `Deeply submerged`.
    pub title: String,
    /// In a sentence.
    pub surroundings: String,
    /// Limit of frequency that it stands for: `1` in the name of a file.
    pub is_lid: Option<bool>,
    /// The matrix.
    pub refined: Refined,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct BodyOutcome {
    /// Name.
    pub name: String,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// From end to end along the body, m.
    pub length_m: f64,
    /// Axes of the matrices and the point that they are about, as the mesh has them.
    pub frame: Frame,
    /// The same in words.
    pub place: String,
    /// Matrices.
    pub cases: Vec<Case>,
    /// What is known about body and mesh, a sentence each.
    pub notes: Vec<String>,
    /// Cross-checks and hydrostatics.
    pub tables: Vec<TextTable>,
    /// The record.
    pub file: EstimateFile,
    /// Where it lies.
    pub estimate: PathBuf,
    /// Where the page lies.
    pub page: PathBuf,
    /// The pressure on the body, and exports.
    pub others: Vec<PathBuf>,
    /// The message about a record in another frame that this one has replaced.
    pub replaced: Option<String>,
}

/// What each mesh would take, with nothing computed.
///
/// # Errors
///
/// As [`body`].
pub fn forecasts(job: &BodyJob) -> Result<(Loaded, Vec<(usize, Forecast)>), Error> {
    let loaded = load(job)?;
    let mut around = surroundings(job, &loaded.family.member(0)?.mesh.mesh)?;
    // The last takes most: it has mirrors, or the walls of a tank.
    let wanted = match around.pop() {
        Some(s) => Wanted { mirrors: s.mirrors, tank: s.tank, ..job.wanted.clone() },
        None => job.wanted.clone(),
    };
    let steps = plan(&loaded.family, &wanted)?;
    Ok((loaded, steps))
}

/// Computes, and writes `estimate.json`, `report.html`, `pressure.vtp` and what else is asked for.
///
/// # Errors
///
/// See [`Error`].
pub fn body(job: &BodyJob, progress: &dyn Fn(&str)) -> Result<BodyOutcome, Error> {
    let loaded = load(job)?;
    let density_kg_m3 = job.density_kg_m3.or(loaded.density_kg_m3).ok_or_else(|| no_density(&job.input))?;
    let out = job.out.clone().unwrap_or_else(|| default_out(&job.input));
    crate::results::can_be_written(&out)?;
    let coarse = loaded.family.member(0)?.mesh.mesh;
    let measure = Measure::of(&coarse);
    let mesh = job.orientation.unwrap_or_default();
    let origin_m = match job.at {
        Point::At(at) => at,
        Point::Buoyancy => measure.centroid_m,
        Point::Gravity => loaded.centre_of_gravity_m.ok_or_else(|| no_gravity(&job.input, loaded.shape.is_some()))?,
    };
    let frame = Frame { origin_m, axes: job.axes.vectors(mesh) };
    let (axes, point) = (axes_words(job, mesh, &loaded), job.at.words(origin_m, job.axes));
    let mut findings = loaded.findings.clone();
    let mut cases = Vec::new();
    for s in surroundings(job, &coarse)? {
        let wanted = Wanted { frame, mirrors: s.mirrors, tank: s.tank, ..job.wanted.clone() };
        let refined = refine(&loaded.family, &wanted, &|step| progress(&format!("{}: {step}", s.title)))?;
        findings.extend(not_within(&s.title, &refined));
        cases.push(Case { title: s.title, surroundings: s.words, is_lid: s.is_lid, refined });
    }
    let length_m = extent_along(&coarse, mesh.forward().axis);
    let mut notes = vec![format!(
        "Density {density_kg_m3} kg/m³; tolerance {} %; froude {}.",
        number::plain(100.0 * job.wanted.tolerance, 3),
        env!("CARGO_PKG_VERSION")
    )];
    notes.extend(loaded.notes);
    if let Some(exact) = loaded.shape.as_ref().and_then(spectral::solve) {
        notes.push(spectral::replace(&mut cases[0].refined, &exact, &frame));
    }
    let mut tables = vec![hydrostatics(&cases[0].refined, loaded.shape.is_none(), density_kg_m3, &frame)];
    let (shape, refined) = (loaded.shape.as_ref(), &cases[0].refined);
    tables.push(cross_checks::table(shape, &coarse, refined, density_kg_m3, &frame));
    if let Family::Mesh(mesh) = &loaded.family {
        progress("the same with facets rounded");
        match geometry(mesh, &cases[0], &job.wanted, &frame, density_kg_m3) {
            Ok(table) => tables.push(table),
            Err(why) => {
                notes.push(format!("The faceting error, smooth body minus polyhedron, is not stated: {why}."));
            }
        }
    }
    if let (Some(tank), Some(surface_m)) = (job.tank_m, job.surface_m) {
        findings.push(limits::clearance(&coarse, tank, surface_m));
    }
    let estimates = cases.iter().map(|case| {
        let source =
            if cases.len() == 1 { loaded.name.clone() } else { format!("{}, {}", loaded.name, case.surroundings) };
        let about = About {
            source,
            density_kg_m3,
            frame: axes.clone(),
            reference_point: point.clone(),
            length_m,
            surroundings: case.surroundings.clone(),
        };
        estimate(&case.refined, &about)
    });
    let file = EstimateFile {
        data: keyed(vec![mesh_file(&job.input)?]),
        versions: crate::results::versions(),
        findings,
        ..EstimateFile::of(estimates.map(of_the_mesh).collect())
    };
    let depth_m = job.surface_m.map(|surface_m| surface_m - mesh.up().coordinate(measure.centroid_m));
    notes.extend(limits::words(depth_m, job.tank_m));
    notes.extend(exports::words(job));
    notes.push("Nothing here depends on frequency: no waves are computed.".to_owned());
    let mut outcome = BodyOutcome {
        name: loaded.name,
        density_kg_m3,
        length_m,
        frame,
        place: sentence(&axes, &point),
        cases,
        notes,
        tables,
        replaced: replaces_another_frame(&out, &file),
        file,
        estimate: PathBuf::new(),
        page: PathBuf::new(),
        others: Vec::new(),
    };
    let html = page::body(&outcome, job.date.clone()).html()?;
    let also = |folder: &Path| extras(&outcome, job, folder);
    let written = crate::results::write_also(&out, &outcome.file, &[], &[], &html, &also)?;
    outcome.estimate = written.estimate;
    outcome.page = written.report;
    outcome.others = written.others;
    Ok(outcome)
}

/// Axes in words: of a body file they are known, of a mesh they were said.
fn axes_words(job: &BodyJob, mesh: Orientation, loaded: &Loaded) -> String {
    match (&loaded.shape, job.axes) {
        (None, _) | (_, Axes::Mesh) => job.axes.words(mesh),
        (Some(_), axes) => axes.own_words().to_owned(),
    }
}

/// Why nothing can be said about the centre of gravity.
fn no_gravity(input: &Path, is_body_file: bool) -> Error {
    let point = "\"0 mm, 0 mm, -12 mm\"";
    Error::Nothing(if is_body_file {
        format!(
            "{}: --at cg: no centre of gravity is known; write centre_of_gravity = [\"0 mm\", \"0 mm\", \"-12 mm\"] in [body], or the point: \
             --at {point}",
            input.display()
        )
    } else {
        format!(
            "{}: --at cg: a mesh says nothing of masses; write the point in the axes of the mesh: --at {point}",
            input.display()
        )
    })
}

fn extent_along(mesh: &Mesh, axis: usize) -> f64 {
    let x = mesh.vertices.iter().map(|v| v[axis]);
    let (low, high) = x.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    high - low
}

/// Volume, centre of buoyancy, displaced mass and its inertia.
fn hydrostatics(refined: &Refined, is_mesh: bool, density_kg_m3: f64, frame: &Frame) -> TextTable {
    let finest = refined.steps.last().map(|s| s.measure);
    let of = if is_mesh { "exactly that of the facets" } else { "exactly that of the dimensions" };
    let mut rows = vec![
        vec!["volume".to_owned(), format!("{} m³, {of}", number::plain(refined.volume_m3, 6))],
        vec!["displaced mass".to_owned(), format!("{} kg", number::plain(density_kg_m3 * refined.volume_m3, 6))],
    ];
    if let Some(m) = finest {
        let list = |v: Vec3, digits| v.map(|x| number::plain(if x.abs() < 1e-12 { 0.0 } else { x }, digits)).join(", ");
        rows.push(vec!["wetted area".to_owned(), format!("{} m²", number::plain(m.area_m2, 6))]);
        rows.push(vec![
            "centre of buoyancy, in the axes of the mesh".to_owned(),
            format!("({}) m", list(m.centroid_m, 5)),
        ]);
        let inertia = inertia_m5(m.inertia_m5(), m.volume_m3, m.centroid_m, frame).map(|j| density_kg_m3 * j);
        rows.push(vec![
            "inertia of the displaced water about the point stated, xx, yy, zz".to_owned(),
            format!("({}) kg m²", list(inertia, 5)),
        ]);
    }
    TextTable {
        caption: "Hydrostatics; area, centre and inertia are those of the finest mesh.".to_owned(),
        head: vec![String::new(), "value".to_owned()],
        rows,
    }
}
