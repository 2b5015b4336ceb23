//! One body or mesh: checks, matrix, pressure, files.

use std::path::{Path, PathBuf};

use froude_mesh::check::{Trouble, check, extent};
use froude_mesh::crossing::crossings;
use froude_mesh::files::{self, vtk::vtp};
use froude_mesh::measure::Measure;
use froude_mesh::panel::Facet;
use froude_mesh::parts::part_troubles;
use froude_mesh::plausible::{crosses, too_large};
use froude_mesh::refine::{rounded, without_warp};
use froude_mesh::vector::{norm, sub};
use froude_mesh::{Mesh, Vec3};
use froude_panel::mirror::{Kind, Mirror, signs};
use froude_panel::tank::{Surface, Tank};
use froude_records::added_mass_files::AddedMassFile;
use froude_records::body::{Shape, read_body};
use froude_records::estimate::{DataFile, ESTIMATE_SCHEMA, EstimateFile};
use froude_records::finding::{Finding, Severity};
use froude_records::hash::sha256_of_file;
use froude_records::write::write_atomically;
use froude_report::document::TextTable;
use froude_report::number;
use indexmap::IndexMap;

use super::cross_checks;
use super::family::Family;
use super::limits;
use super::links::{default_out, file_name, no_density, not_links, not_within};
use super::page;
use super::record::{About, MOTIONS, estimate};
use super::refine::{Finest, Forecast, Placed, Refined, Wanted, forecast, memory_bytes, plan, refine};
use super::spectral;
use crate::Error;

/// Where moments are taken about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Origin {
    /// A point of the mesh frame, m.
    At(Vec3),
    /// The centre of buoyancy.
    Buoyancy,
}

/// What to compute.
#[derive(Debug, Clone)]
pub struct BodyJob {
    /// A body file (.toml) or a mesh.
    pub input: PathBuf,
    /// Links of a robot.
    pub links: Option<usize>,
    /// Density instead of the file's, kg/m³.
    pub density_kg_m3: Option<f64>,
    /// Where moments are taken about.
    pub origin: Origin,
    /// Metres for a unit of the mesh; `None` where nobody said.
    pub unit_m: Option<f64>,
    /// Whether the mesh's z axis points up.
    pub is_z_up: bool,
    /// Height of the water's surface over the origin of the mesh, m; `None`: deeply submerged.
    pub surface_m: Option<f64>,
    /// Length, breadth and depth of water of a tank with the origin in the middle of its plan, m.
    pub tank_m: Option<[f64; 3]>,
    /// Tolerance and limits.
    pub wanted: Wanted,
    /// Files to write beside the record: `1`, `nc`, `csv`.
    pub export: Vec<&'static str>,
    /// Folder of the results; beside the input, unless said.
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
    /// From end to end along x, m.
    pub length_m: f64,
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
}

/// A body that was read, with everything that was found.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// Name.
    pub name: String,
    /// Its meshes.
    pub family: Family,
    /// Its dimensions, where a body file gives them.
    pub shape: Option<Shape>,
    /// Density that the file gives, kg/m³.
    pub density_kg_m3: Option<f64>,
    /// What was found, a sentence each.
    pub notes: Vec<String>,
    /// Doubts.
    pub findings: Vec<Finding>,
}

/// Warp of a quadrilateral, as part of its radius, from which it is divided into triangles.
const WARP: f64 = 1e-6;
/// Angle between facets from which an edge is an edge of the body, rad: seven segments to a circle still count as round.
const CREASE_RAD: f64 = 50.0 * core::f64::consts::PI / 180.0;
/// Distance from the water's surface that is none, as part of the body's extent.
const ROUNDING: f64 = 1e-9;
/// What is said of exports of a mesh with z down.
pub(super) const TURNED: &str = "The files for WAMIT and Capytaine have z up, as wave programs ask for: turned about x by 180°; record and CSV have the axes of the mesh.";
/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 1 << 30;
/// Standard acceleration of gravity, m/s².
const G_M_S2: f64 = 9.80665;

/// Whether a path is a body file and not a mesh.
#[must_use]
pub fn is_body_file(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// Reads a mesh as it is, in metres.
///
/// # Errors
///
/// A file that cannot be read.
pub fn read_mesh(path: &Path, unit_m: Option<f64>) -> Result<(Mesh, Vec<String>), Error> {
    let bytes = froude_records::read::whole(path, LARGEST_FILE, "a mesh")?;
    let file = files::read(&path.display().to_string(), &bytes)?;
    let unit_m = unit_m.unwrap_or(1.0);
    let mesh = if unit_m == 1.0 { file.mesh } else { file.mesh.mapped(|v| v.map(|x| unit_m * x)) };
    Ok((mesh, file.notes))
}

/// Reads and checks.
///
/// # Errors
///
/// A file that cannot be read, and a mesh that potential flow cannot be computed on, with everything that is wrong with it.
pub fn load(job: &BodyJob) -> Result<Loaded, Error> {
    if is_body_file(&job.input) {
        if job.unit_m.is_some() {
            return Err(Error::Nothing(format!(
                "{}: --unit is for a mesh; a body file has a unit at each length",
                job.input.display()
            )));
        }
        let body = read_body(&job.input)?;
        let links = match (&body.shape, job.links) {
            (Shape::Robot { .. }, Some(links)) => links,
            (Shape::Robot { .. }, None) => {
                return Err(Error::Nothing(format!(
                    "{}: a robot has links; say how many: --links 3, or --links 1..9 for a table",
                    job.input.display()
                )));
            }
            (_, Some(_)) => return Err(not_links(&job.input)),
            (_, None) => 0,
        };
        let name = if job.links.is_some() { format!("{}, H{links}LT", body.name) } else { body.name };
        let family = Family::of(&body.shape, links);
        let notes = vec!["Meshes from the dimensions; every mesh is similar to the others.".to_owned()];
        let density_kg_m3 = body.density_kg_m3;
        return Ok(Loaded { name, family, shape: Some(body.shape), density_kg_m3, notes, findings: Vec::new() });
    }
    if job.links.is_some() {
        return Err(not_links(&job.input));
    }
    let (mesh, mut notes) = read_mesh(&job.input, job.unit_m)?;
    let mut findings = Vec::new();
    let mut wrong = Vec::new();
    let mut troubles = check(&mesh);
    if !troubles.iter().any(Trouble::is_fatal) {
        troubles.extend(part_troubles(&mesh));
        troubles.extend(crossings(&mesh));
    }
    let is_unreadable =
        |t: &Trouble| matches!(t, Trouble::Empty | Trouble::NotFinite { .. } | Trouble::NoSuchVertex { .. });
    // A repair merges, turns and takes out; bodies that cross must be united where they were drawn.
    let is_crossing = |t: &Trouble| matches!(t, Trouble::Crossing { .. });
    let is_nested = |t: &Trouble| matches!(t, Trouble::Nested { .. });
    let is_repairable = !troubles.iter().any(is_unreadable)
        && !troubles.iter().all(|t| is_crossing(t) || is_nested(t) || !t.is_fatal());
    let is_open = troubles.iter().any(|t| matches!(t, Trouble::Open { .. }));
    for trouble in troubles {
        if trouble.is_fatal() {
            wrong.push(format!("  {trouble}"));
        } else {
            findings.push(Finding::new(Severity::Warning, "mesh", trouble.to_string()));
        }
    }
    if !wrong.is_empty() {
        let rest = wrong.len().saturating_sub(MOST_TOLD);
        wrong.truncate(MOST_TOLD);
        if rest > 0 {
            wrong.push(format!("  and {rest} more"));
        }
        if is_open {
            wrong.push(
                "  where it looks closed and is not, corners lie within edges of neighbours (T-junctions): let the drawing program mesh it anew"
                    .to_owned(),
            );
        }
        if is_repairable {
            wrong.push(format!(
                "  froude added-mass {}{} --repair repaired.obj writes a mesh with what can be decided put right",
                job.input.display(),
                job.unit_m.map_or_else(String::new, |m| format!(" --unit \"{m} m\""))
            ));
        }
        return Err(Error::Nothing(format!(
            "{}: potential flow cannot be computed on this mesh:\n{}",
            job.input.display(),
            wrong.join("\n")
        )));
    }
    if let Some(doubt) = too_large(&mesh).filter(|_| job.unit_m.is_none()) {
        return Err(Error::Nothing(format!("{}: {doubt}", job.input.display())));
    }
    findings.extend(thin_panels(&mesh));
    let flat = without_warp(&mesh, WARP);
    if flat.panels.len() > mesh.panels.len() {
        notes.push(format!(
            "{} quadrilaterals whose corners do not lie in one plane were divided into triangles.",
            flat.panels.len() - mesh.panels.len()
        ));
    }
    notes.push(format!("z points {} in the mesh; the matrix is in its axes.", if job.is_z_up { "up" } else { "down" }));
    let name = file_name(&job.input);
    Ok(Loaded { name, family: Family::Mesh(flat), shape: None, density_kg_m3: None, notes, findings })
}

/// Area over the square of the longest edge, and longest edge over the extent, from which a panel is long and thin.
const THIN: f64 = 0.05;
const LONG: f64 = 0.1;

/// Long thin panels, as drawing programs leave on flat sides: dividing them keeps their shape, and convergence slow.
fn thin_panels(mesh: &Mesh) -> Option<Finding> {
    let extent_m = extent(mesh);
    let longest = |p: &froude_mesh::Panel| {
        let corners: Vec<Vec3> = mesh.corners(*p).collect();
        (0..corners.len()).map(|i| norm(sub(corners[(i + 1) % corners.len()], corners[i]))).fold(0.0, f64::max)
    };
    let lengths = mesh.panels.iter().map(|p| (longest(p), Facet::of(mesh, *p)));
    let thin: Vec<(f64, Facet)> = lengths.filter(|(l, f)| *l > LONG * extent_m && f.area < THIN * l * l).collect();
    let (length, facet) = thin.first()?;
    let message = format!(
        "{} of {} panels are long and thin, the first at {:.4?} m is {length:.4} m long; finer meshes keep their shape, and converge slowly \
         where they meet an edge: let the drawing program mesh the surface with edges of {:.3} m or less",
        thin.len(),
        mesh.panels.len(),
        facet.centroid,
        extent_m / 30.0
    );
    Some(Finding::new(Severity::Note, "thin-panels", message))
}

/// Troubles of a mesh that are told one by one.
const MOST_TOLD: usize = 12;

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
pub fn body(job: &BodyJob, told: &dyn Fn(&str)) -> Result<BodyOutcome, Error> {
    let loaded = load(job)?;
    let density_kg_m3 = job.density_kg_m3.or(loaded.density_kg_m3).ok_or_else(|| no_density(&job.input))?;
    let out = job.out.clone().unwrap_or_else(|| default_out(&job.input));
    crate::results::can_be_written(&out)?;
    let coarse = loaded.family.member(0)?.mesh.mesh;
    let measure = Measure::of(&coarse);
    let origin_m = match job.origin {
        Origin::At(at) => at,
        Origin::Buoyancy => measure.centroid_m,
    };
    let reference = match job.origin {
        Origin::At(_) => page::point(origin_m, "the origin of the mesh"),
        Origin::Buoyancy => format!("{} (the centre of buoyancy)", page::point(origin_m, "the origin of the mesh")),
    };
    let mut findings = loaded.findings.clone();
    let mut cases = Vec::new();
    for s in surroundings(job, &coarse)? {
        let wanted = Wanted { origin_m, mirrors: s.mirrors, tank: s.tank, ..job.wanted.clone() };
        let refined = refine(&loaded.family, &wanted, &|step| told(&format!("{}: {step}", s.title)))?;
        findings.extend(not_within(&s.title, &refined));
        cases.push(Case { title: s.title, surroundings: s.words, is_lid: s.is_lid, refined });
    }
    let length_m = extent_along_x(&coarse);
    let mut notes = vec![format!(
        "Density {density_kg_m3} kg/m³; tolerance {} %; froude {}.",
        number::plain(100.0 * job.wanted.tolerance, 3),
        env!("CARGO_PKG_VERSION")
    )];
    notes.extend(loaded.notes);
    if let Some(exact) = loaded.shape.as_ref().and_then(spectral::solve) {
        notes.push(spectral::replace(&mut cases[0].refined, &exact, origin_m));
    }
    let mut tables = vec![hydrostatics(&cases[0].refined, density_kg_m3, origin_m)];
    let (shape, refined) = (loaded.shape.as_ref(), &cases[0].refined);
    tables.push(cross_checks::table(shape, &coarse, refined, density_kg_m3, origin_m));
    if let Family::Mesh(mesh) = &loaded.family {
        told("the same with facets rounded");
        match geometry(mesh, &cases[0], &job.wanted, origin_m, density_kg_m3) {
            Ok(table) => tables.push(table),
            Err(why) => {
                notes
                    .push(format!("How far a smooth body with these corners lies from the facets is not told: {why}."));
            }
        }
    }
    if let (Some(tank), Some(surface_m)) = (job.tank_m, job.surface_m) {
        findings.push(limits::clearance(&coarse, tank, surface_m));
    }
    if !job.export.is_empty() && origin_m != [0.0; 3] {
        findings.push(Finding::new(
            Severity::Warning,
            "export-origin",
            format!(
                "the exported files are about {reference} and cannot say so; wave programs take the origin of their mesh: leave --origin out for \
                 them"
            ),
        ));
    }
    let estimates = cases.iter().map(|case| {
        let source =
            if cases.len() == 1 { loaded.name.clone() } else { format!("{}, {}", loaded.name, case.surroundings) };
        let about = About {
            source,
            density_kg_m3,
            frame: format!("axes of the mesh, z {}", if job.is_z_up { "up" } else { "down" }),
            reference_point: reference.clone(),
            length_m,
            surroundings: case.surroundings.clone(),
        };
        estimate(&case.refined, &about)
    });
    let file = EstimateFile {
        schema: ESTIMATE_SCHEMA.to_owned(),
        data: vec![DataFile { path: file_name(&job.input), sha256: sha256_of_file(&job.input)? }],
        versions: IndexMap::from([("froude".to_owned(), env!("CARGO_PKG_VERSION").to_owned())]),
        estimates: estimates.collect(),
        findings,
    };
    let up = if job.is_z_up { 1.0 } else { -1.0 };
    let depth_m = job.surface_m.map(|surface_m| surface_m - up * measure.centroid_m[2]);
    notes.extend(limits::words(depth_m, job.tank_m));
    if !job.is_z_up && !job.export.is_empty() {
        notes.push(TURNED.to_owned());
    }
    notes.push(format!("Moments are about {reference}. Nothing here depends on frequency: no waves are computed."));
    let mut outcome = BodyOutcome {
        name: loaded.name,
        density_kg_m3,
        length_m,
        cases,
        notes,
        tables,
        file,
        estimate: PathBuf::new(),
        page: PathBuf::new(),
        others: Vec::new(),
    };
    let html = page::body(&outcome, job.date.clone()).html()?;
    let also = |folder: &Path| extras(&outcome, job, folder, origin_m);
    let written = crate::results::write_also(&out, &outcome.file, &[], &[], &html, &also)?;
    outcome.estimate = written.estimate;
    outcome.page = written.report;
    outcome.others = written.others;
    Ok(outcome)
}

/// What is around the body in one case.
struct Surrounding {
    title: String,
    words: String,
    is_lid: Option<bool>,
    mirrors: Vec<Mirror>,
    tank: Option<Placed>,
}

fn surroundings(job: &BodyJob, mesh: &Mesh) -> Result<Vec<Surrounding>, Error> {
    let deep = Surrounding {
        title: "Deeply submerged".to_owned(),
        words: "unbounded water".to_owned(),
        is_lid: None,
        mirrors: Vec::new(),
        tank: None,
    };
    let Some(surface_m) = job.surface_m else { return Ok(vec![deep]) };
    let at_m = if job.is_z_up { surface_m } else { -surface_m };
    if let Some(crossing) = crosses(mesh, 2, at_m) {
        return Err(Error::Nothing(format!(
            "{}: {crossing}: the body pierces the water's surface; bodies that float are not computed here, submerge it",
            job.input.display()
        )));
    }
    let is_above = mesh.vertices.iter().any(|v| if job.is_z_up { v[2] > at_m } else { v[2] < at_m });
    if is_above {
        return Err(Error::Nothing(format!(
            "{}: the body lies above the water's surface at z = {at_m} m; give --surface the height of the surface over the origin of the mesh, \
             and --z up or down as the mesh has it",
            job.input.display()
        )));
    }
    let slack_m = ROUNDING * extent(mesh);
    let touching = mesh.panels.iter().position(|p| mesh.corners(*p).all(|c| (c[2] - at_m).abs() <= slack_m));
    if let Some(panel) = touching {
        return Err(Error::Nothing(format!(
            "{}: panel {panel} lies in the water's surface at z = {at_m} m: bodies that float are not computed here, submerge it",
            job.input.display()
        )));
    }
    if job.tank_m.is_some() && !job.is_z_up {
        return Err(Error::Nothing(format!(
            "{}: in a tank z must point up; turn the mesh over, or leave --z out for a body file",
            job.input.display()
        )));
    }
    let place = match job.tank_m {
        Some([l, b, d]) => {
            format!("tank {l} × {b} × {d} m (length, breadth, depth of water), surface {surface_m} m over the origin")
        }
        None => format!("water's surface {surface_m} m over the origin"),
    };
    let case = |title: &str, limit: &str, is_lid: bool, kind, surface| {
        let tank = job.tank_m.map(|[length_m, width_m, depth_m]| Placed {
            tank: Tank { length_m, width_m, depth_m },
            surface,
            over_origin_m: surface_m,
        });
        let mirrors = if tank.is_some() { Vec::new() } else { vec![Mirror { axis: 2, at_m, kind }] };
        Surrounding { title: title.to_owned(), words: format!("{place}, {limit}"), is_lid: Some(is_lid), mirrors, tank }
    };
    Ok(vec![
        deep,
        case("Slow motion: rigid lid", "rigid: ω²d/g → 0", true, Kind::Wall, Surface::Lid),
        case("Fast motion: φ = 0", "φ = 0 there: ω²d/g → ∞", false, Kind::FreeSurface, Surface::Free),
    ])
}

fn extent_along_x(mesh: &Mesh) -> f64 {
    let x = mesh.vertices.iter().map(|v| v[0]);
    let (low, high) = x.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    high - low
}

/// Volume, centre of buoyancy, displaced mass and its inertia.
fn hydrostatics(refined: &Refined, density_kg_m3: f64, origin_m: Vec3) -> TextTable {
    let finest = refined.steps.last().map(|s| s.measure);
    let mut rows = vec![
        vec!["volume".to_owned(), format!("{} m³", number::plain(refined.volume_m3, 6))],
        vec!["displaced mass".to_owned(), format!("{} kg", number::plain(density_kg_m3 * refined.volume_m3, 6))],
    ];
    if let Some(m) = finest {
        let list = |v: Vec3, digits| v.map(|x| number::plain(if x.abs() < 1e-12 { 0.0 } else { x }, digits)).join(", ");
        rows.push(vec!["wetted area".to_owned(), format!("{} m²", number::plain(m.area_m2, 6))]);
        rows.push(vec!["centre of buoyancy".to_owned(), format!("({}) m", list(m.centroid_m, 5))]);
        let shift = |i: usize| {
            // About another point: Huygens–Steiner, with the distances of the centre from both.
            let (c, o) = (m.centroid_m, origin_m);
            let square = |p: Vec3| (0..3).filter(|k| *k != i).map(|k| p[k] * p[k]).sum::<f64>();
            let d: Vec3 = core::array::from_fn(|k| c[k] - o[k]);
            m.inertia_m5()[i][i] + m.volume_m3 * (square(d) - square(c))
        };
        let inertia: Vec3 = core::array::from_fn(|i| density_kg_m3 * shift(i));
        rows.push(vec![
            "inertia of the displaced water about the origin asked for, xx, yy, zz".to_owned(),
            format!("({}) kg m²", list(inertia, 5)),
        ]);
    }
    TextTable { caption: "Hydrostatics.".to_owned(), head: vec![String::new(), "value".to_owned()], rows }
}

/// What the facets of a mesh may hide: its difference from the smooth body that they stand for; otherwise why it is not told.
fn geometry(
    mesh: &Mesh,
    case: &Case,
    wanted: &Wanted,
    origin_m: Vec3,
    density_kg_m3: f64,
) -> Result<TextTable, &'static str> {
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
    let problem = froude_panel::problem::Problem::rigid(&round, mirrors);
    if problem.facets.len() > wanted.most_panels || forecast(&problem).memory_bytes > memory_bytes(wanted) {
        return Err("panels or memory do not allow the rounded mesh");
    }
    let round = froude_panel::solve(&problem).added_mass(0).about(origin_m).matrix;
    let rows = (0..6)
        .map(|i| {
            // Rounding once takes three quarters of the distance to the smooth body away.
            let value = case.refined.value[i][i];
            // Less than nothing is not left of an entry.
            let apart = (4.0 / 3.0 * (round[i][i] - flat[i][i])).max(-value);
            vec![
                MOTIONS[i].to_owned(),
                number::plain(density_kg_m3 * value, 6),
                percent_of(case.refined.uncertainty[i][i], value).replace('+', ""),
                percent_of(apart, value),
            ]
        })
        .collect();
    Ok(TextTable {
        caption: format!(
            "Two uncertainties, never one: that of the panels (the matrix of the polyhedron that was given), and how far a smooth body with \
             these corners lies from it, should the facets stand for one. Edges of more than {:.0}° count as edges of the body.",
            CREASE_RAD.to_degrees()
        ),
        head: ["", "value [kg, kg m²]", "numerical uncertainty", "smooth body minus polyhedron"]
            .map(str::to_owned)
            .to_vec(),
        rows,
    })
}

fn percent_of(part: f64, whole: f64) -> String {
    if whole.abs() > 0.0 && part.is_finite() {
        format!("{:+.2} %", 100.0 * part / whole.abs())
    } else {
        "–".to_owned()
    }
}

/// The pressure on the body, and the files that were asked for; their names in the folder.
fn extras(outcome: &BodyOutcome, job: &BodyJob, folder: &Path, origin_m: Vec3) -> Result<Vec<PathBuf>, Error> {
    let mut names = vec![PathBuf::from("pressure.vtp")];
    let pressure = pressure(&outcome.cases[0].refined.finest, outcome.density_kg_m3, origin_m);
    write_atomically(&folder.join(&names[0]), pressure.as_bytes())?;
    let rows = |case: &Case| -> Vec<Vec<f64>> {
        case.refined.value.iter().map(|row| row.iter().map(|a| outcome.density_kg_m3 * a).collect()).collect()
    };
    // Deeply submerged both limits are the same.
    let limit = |is_lid: bool| outcome.cases.iter().rfind(|c| c.is_lid.is_none_or(|l| l == is_lid)).map(rows);
    let (zero, infinite) = (limit(true), limit(false));
    let body =
        outcome.name.chars().map(|c| if c.is_ascii_alphanumeric() || " -.".contains(c) { c } else { '-' }).collect();
    let bodies = [body];
    for extension in &job.export {
        let axes = |m: &Option<Vec<Vec<f64>>>| m.as_ref().map(|m| for_program(m, extension, job.is_z_up));
        let (zero, infinite) = (axes(&zero), axes(&infinite));
        let file = AddedMassFile {
            density_kg_m3: outcome.density_kg_m3,
            gravity_m_s2: G_M_S2,
            length_m: 1.0,
            bodies: &bodies,
            zero_frequency: zero.as_deref(),
            infinite_frequency: infinite.as_deref(),
        };
        let name = PathBuf::from(format!("added-mass.{extension}"));
        file.write(&folder.join(&name))?;
        names.push(name);
    }
    Ok(names)
}

/// A matrix in the axes that a format has. Wave programs have z up: a mesh with z down is turned about x by half a turn, and y and z change
/// their signs. A CSV keeps the axes of the record.
pub(super) fn for_program(matrix: &[Vec<f64>], extension: &str, is_z_up: bool) -> Vec<Vec<f64>> {
    let is_turned = !is_z_up && extension != "csv";
    let sign = |i: usize| if is_turned && !i.is_multiple_of(3) { -1.0 } else { 1.0 };
    let row = |(i, row): (usize, &Vec<f64>)| row.iter().enumerate().map(|(j, a)| sign(i) * sign(j) * a).collect();
    matrix.iter().enumerate().map(row).collect()
}

/// Pressure over unit acceleration on the whole body, −ρ φ, for each motion about the origin asked for.
fn pressure(finest: &Finest, density_kg_m3: f64, origin_m: Vec3) -> String {
    let own: Vec<Mirror> = finest.mirrors.iter().copied().filter(|m| m.kind == Kind::Body).collect();
    let mut whole = Mesh::default();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); 6];
    for set in 0..1_usize << own.len() {
        let mirrored = own.iter().enumerate().filter(|(bit, _)| set >> bit & 1 == 1);
        let part = mirrored.fold(finest.mesh.clone(), |mesh, (_, m)| mesh.mirrored(m.axis));
        whole = whole.with(&part);
        for phi in &finest.solution.potentials {
            let phi: [f64; 6] = core::array::from_fn(|mode| signs(&own, mode)[set] * phi[mode]);
            for (mode, values) in values.iter_mut().enumerate() {
                // Turning about the origin asked for is turning about that of the mesh, and moving: −(e × o).
                let o = origin_m;
                let carried = match mode {
                    3 => -o[2] * phi[1] + o[1] * phi[2],
                    4 => o[2] * phi[0] - o[0] * phi[2],
                    5 => -o[1] * phi[0] + o[0] * phi[1],
                    _ => 0.0,
                };
                values.push(-density_kg_m3 * (phi[mode] - carried));
            }
        }
    }
    let names: Vec<String> = MOTIONS
        .iter()
        .enumerate()
        .map(|(i, m)| format!("pressure {m} [Pa/({}/s^2)]", if i < 3 { "m" } else { "rad" }))
        .collect();
    let scalars: Vec<(&str, &[f64])> = names.iter().map(String::as_str).zip(values.iter().map(Vec::as_slice)).collect();
    vtp(&whole, &scalars)
}
