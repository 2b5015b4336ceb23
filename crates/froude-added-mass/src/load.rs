//! A body file or a mesh, read and checked.

use std::path::Path;

use crate::body_file::{Shape, read_body};
use froude_mesh::check::{Kind, Trouble, check, extent};
use froude_mesh::crossing::crossings;
use froude_mesh::files::{self, Format, MeshFile};
use froude_mesh::panel::Facet;
use froude_mesh::parts::part_troubles;
use froude_mesh::plausible::too_large;
use froude_mesh::refine::without_warp;
use froude_mesh::repair::{WELD, merged, turned_outward};
use froude_mesh::solids::deck_trouble;
use froude_mesh::union::united;
use froude_mesh::vector::{norm, sub};
use froude_mesh::{Mesh, Vec3};
use froude_panel::family::Family;
use froude_records::finding::{Finding, Severity};
use froude_records::text::counted;

use super::frame::Direction;
use super::options::{Asked, unit_of};
use super::shape::family;
use crate::error::AddedMassError;

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
    /// Centre of gravity that the file gives, m.
    pub centre_of_gravity_m: Option<Vec3>,
    /// What was found, a sentence each.
    pub notes: Vec<String>,
    /// Doubts.
    pub findings: Vec<Finding>,
}

/// Warp of a quadrilateral, as part of its radius, from which it is divided into triangles.
pub(super) const WARP: f64 = 1e-6;
/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 1 << 30;

/// The message about `--links` for a body without links.
pub(super) const NO_LINKS: &str =
    "--links counts the links of a body file of shape \"robot\"; leave it out for another shape, or a mesh";

/// Whether a path is a body file and not a mesh.
#[must_use]
pub fn is_body_file(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// Reads a mesh as it is, in metres and in the size of the body: with the unit that is given, or else with that of the file.
///
/// # Errors
///
/// A file that cannot be read, or that states which axis points up beside `--up`.
pub(super) fn read_unmerged(job: &Asked) -> Result<MeshFile, AddedMassError> {
    let bytes = froude_records::read::whole(&job.input, LARGEST_FILE, "a mesh")?;
    let mut file = files::read(&job.input.display().to_string(), &bytes)?;
    if file.format == Format::Dae && job.orientation.is_some_and(|lies| lies.up() != Direction::Z) {
        let why = "a Collada file states which axis points up (<up_axis>), and its mesh is turned to z up when it is read; leave --up out, or \
                   correct <up_axis> in the file";
        return Err(AddedMassError::input(&job.input, why));
    }
    match (job.unit_m, file.unit_m) {
        (Some(given), Some(stated)) if given != stated => {
            file.notes.push(format!("the file states a unit of {stated} m; --unit, {given} m, counts"));
        }
        (None, Some(stated)) => file.notes.push(format!("the unit is {stated} m, as the file states")),
        _ => {}
    }
    let by = job.unit_m.or(file.unit_m).unwrap_or(1.0) * job.model_scale.unwrap_or(1.0);
    if by != 1.0 {
        file.mesh = file.mesh.mapped(|v| v.map(|x| by * x));
    }
    if let Some(scale) = job.model_scale {
        file.notes.push(format!("scaled by {scale}: the body's largest dimension is {:.4} m", extent(&file.mesh)));
    }
    Ok(file)
}

/// Reads a mesh like that, and merges vertices at one place ([`merged`]); the notes state what was left out and merged.
///
/// # Errors
///
/// As before.
pub fn read_mesh(job: &Asked) -> Result<MeshFile, AddedMassError> {
    let mut file = read_unmerged(job)?;
    let (mesh, notes) = merged(file.mesh);
    file.mesh = mesh;
    file.notes.extend(notes);
    Ok(file)
}

/// Refuses for a body file what only a mesh needs.
pub(super) fn of_a_mesh_only(job: &Asked) -> Result<(), AddedMassError> {
    let what = if job.unit_m.is_some() || job.model_scale.is_some() {
        "--unit is for a mesh; a body file has a unit at each length"
    } else if job.orientation.is_some() {
        "--forward and --up are for a mesh; a body file has x forward along the body and z up"
    } else if job.is_polyhedron || job.is_smooth {
        "--polyhedron and --smooth are for a mesh; a body file has no facets"
    } else {
        return Ok(());
    };
    Err(AddedMassError::input(&job.input, what))
}

/// Reads and checks.
///
/// # Errors
///
/// A file that cannot be read, and a mesh that potential flow cannot be computed on, with everything that is wrong with it.
pub fn load(job: &Asked) -> Result<Loaded, AddedMassError> {
    if is_body_file(&job.input) {
        of_a_mesh_only(job)?;
        let body = read_body(&job.input)?;
        let links = match (&body.shape, job.links.first()) {
            (Shape::Robot(_), Some(links)) => *links,
            (Shape::Robot(_), None) => {
                let why = "a robot has links; say how many: --links 3, or --links 1..9 for a table";
                return Err(AddedMassError::input(&job.input, why));
            }
            (_, Some(_)) => return Err(AddedMassError::input(&job.input, NO_LINKS)),
            (_, None) => 0,
        };
        let name = if job.links.is_empty() { body.name } else { format!("{}, H{links}LT", body.name) };
        let family = family(&body.shape, links);
        let notes = vec!["Meshes from the dimensions; all meshes are geometrically similar.".to_owned()];
        return Ok(Loaded {
            name,
            family,
            shape: Some(body.shape),
            density_kg_m3: body.density_kg_m3,
            centre_of_gravity_m: body.centre_of_gravity_m,
            notes,
            findings: Vec::new(),
        });
    }
    if !job.links.is_empty() {
        return Err(AddedMassError::input(&job.input, NO_LINKS));
    }
    let MeshFile { mut mesh, mut notes, format, .. } = read_mesh(job)?;
    if let Some(turned) = turned_outward(&mesh) {
        mesh = turned;
        notes.push(format!("the surface was inside out: all of its {} panels were turned", mesh.panels.len()));
    }
    let mut findings = Vec::new();
    let mut wrong = Vec::new();
    // Parts that move apart stay apart.
    let whole = if job.apart.is_some() { Ok(None) } else { united(&mesh) };
    let mut failed = None;
    match whole {
        Ok(None) => {}
        Ok(Some(whole)) => {
            mesh = whole.mesh;
            findings.extend(whole.notes.into_iter().map(|note| Finding::new(Severity::Note, "united", note)));
        }
        Err(trouble) => failed = Some(trouble),
    }
    let mut troubles = check(&mesh);
    if let Some(deck) = deck_trouble(&mesh) {
        troubles.retain(|trouble| !trouble.is_fatal());
        troubles.push(deck);
    }
    troubles.extend(failed);
    if !troubles.iter().any(Trouble::is_fatal) {
        troubles.extend(part_troubles(&mesh));
        troubles.extend(crossings(&mesh));
    }
    // A repair merges, turns and takes out; bodies that cross must be united where they were drawn.
    let is_left = |t: &Trouble| matches!(t.kind, Kind::Crossing | Kind::Nested | Kind::Slivers);
    let is_repairable = !troubles.iter().any(|t| t.kind == Kind::Unreadable) && !troubles.iter().all(is_left);
    let is_open = troubles.iter().any(|t| t.kind == Kind::Open);
    for trouble in troubles {
        if trouble.is_fatal() {
            wrong.push(format!("  {trouble}"));
        } else {
            findings.push(Finding::new(Severity::Warning, "mesh", trouble.to_string()));
        }
    }
    if !wrong.is_empty() {
        let rest = wrong.len().saturating_sub(MOST_REPORTED);
        wrong.truncate(MOST_REPORTED);
        if rest > 0 {
            wrong.push(format!("  and {rest} more"));
        }
        wrong.extend(notes.iter().map(|note| format!("  as it was read: {note}")));
        if is_open {
            wrong.push(
                "  where it looks closed and is not, corners lie within edges of neighbours (T-junctions): let the CAD program mesh it again"
                    .to_owned(),
            );
        }
        if is_repairable {
            wrong.push(format!(
                "  froude added-mass {}{} --repair repaired.obj writes a mesh with the unambiguous faults corrected",
                job.input.display(),
                job.unit_m.map_or_else(String::new, |m| format!(" --unit {}", unit_of(m)))
            ));
        }
        let why = format!("potential flow cannot be computed on this mesh:\n{}", wrong.join("\n"));
        return Err(AddedMassError::input(&job.input, why));
    }
    if let Some(doubt) = too_large(&mesh).filter(|_| job.unit_m.is_none()) {
        return Err(AddedMassError::input(&job.input, doubt.to_string()));
    }
    if let Some((panels, up)) = lid(&mesh, job).filter(|_| job.surface_m.is_none()) {
        if matches!(format, Format::Gdf | Format::Nemoh) {
            let why = format!(
                "the mesh is closed by {} in the plane z = 0, which is the water's surface in a {format} file: this is a floating hull, and floating \
                 bodies are not computed here. If the body is submerged, state where the surface is: --surface \"5 m\" puts it 5 m above the origin of the mesh",
                counted(panels, "panel", "panels")
            );
            return Err(AddedMassError::input(&job.input, why));
        }
        let message = format!(
            "{panels} panels lie in the plane {up} = 0 and nothing lies above it: if that plane is the water's surface, the hull floats and these \
             values do not apply; if the body is submerged, --surface states how deep"
        );
        findings.push(Finding::new(Severity::Warning, "lid-at-zero", message));
    }
    findings.extend(thin_panels(&mesh));
    let flat = without_warp(&mesh, WARP);
    if flat.panels.len() > mesh.panels.len() {
        notes.push(format!(
            "{} quadrilaterals whose corners do not lie in one plane were divided into triangles.",
            flat.panels.len() - mesh.panels.len()
        ));
    }
    let name = file_name(&job.input);
    let family = Family::Mesh(flat);
    Ok(Loaded { name, family, shape: None, density_kg_m3: None, centre_of_gravity_m: None, notes, findings })
}

/// Panels that close a mesh from above in the plane where its vertical coordinate is 0, and that coordinate.
///
/// Wave programs have the water's surface there: a floating hull with such panels is a lid over its waterplane (IRR = 1 in WAMIT).
fn lid(mesh: &Mesh, job: &Asked) -> Option<(usize, Direction)> {
    let up = job.orientation.unwrap_or_default().up();
    let slack_m = WELD * extent(mesh);
    if mesh.vertices.iter().any(|v| up.coordinate(*v) > slack_m) {
        return None;
    }
    let panels = mesh.panels.iter().filter(|p| mesh.corners(**p).all(|c| up.coordinate(c) >= -slack_m)).count();
    (panels > 0).then_some((panels, up))
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
         where they meet an edge: let the CAD program mesh the surface with edges of {:.3} m or less",
        thin.len(),
        mesh.panels.len(),
        facet.centroid,
        extent_m / 30.0
    );
    Some(Finding::new(Severity::Note, "thin-panels", message))
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
}

/// Faults of a mesh that are reported one by one.
const MOST_REPORTED: usize = 12;
