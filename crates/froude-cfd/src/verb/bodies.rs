//! The bodies that a campaign computes: a body file's, or a closed surface mesh as `froude added-mass` reads it.

use crate::body::{Shaped, shaped};
use crate::surface::asymmetry;
use froude_added_mass::body_file::read_body;
use froude_added_mass::frame::Axes;
use froude_added_mass::load::{is_body_file, read_mesh};
use froude_added_mass::options::{Asked as Lies, unit_of};
use froude_mesh::check::{Trouble, check};
use froude_mesh::crossing::crossings;
use froude_mesh::files::MeshFile;
use froude_mesh::mesh::Mesh;
use froude_mesh::parts::part_troubles;
use froude_mesh::plausible::{LARGEST_M, too_large};
use froude_mesh::vector::dot;
use froude_records::table::links_of_configuration;

use super::asked::Asked;
use super::error::VerbError;

/// Most links of a body: as many modules as a robot file has.
const MOST_LINKS: u32 = 1_000;
/// Faults of a mesh that are told one by one.
const MOST_TOLD: usize = 6;

/// Hands over the bodies of configurations, in the order in which they are named first, one at a time: a plan may have hundreds.
pub(super) fn each<'a>(
    asked: &Asked,
    named: impl IntoIterator<Item = &'a String>,
    take: &mut dyn FnMut(Shaped) -> Result<(), VerbError>,
) -> Result<(), VerbError> {
    let mut names: Vec<&String> = Vec::new();
    for name in named {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let refused = |problem: String| VerbError::input(&asked.body, problem);
    let checked = |body: Shaped| match asymmetry(&body.surface).filter(|_| asked.spec.is_half) {
        Some(asymmetry) => Err(refused(format!("{asymmetry}; write domain = \"full\" in [source.cfd]"))),
        None => Ok(body),
    };
    if !is_body_file(&asked.body) {
        let [name] = names[..] else {
            let problem =
                "is a mesh, which is one body, and the plan names several configurations; write a source for each";
            return Err(refused(problem.to_owned()));
        };
        return take(checked(surface(asked, name)?)?);
    }
    if let Some(given) = asked.spec.lies.first() {
        return Err(refused(format!("is a body file, which has its units and axes; take {given} out")));
    }
    let file = read_body(&asked.body)?;
    let body = |name: &&String| match links_of_configuration(name) {
        Some(links) if links > MOST_LINKS => {
            Err(refused(format!("is planned as {name:?}, and at most {MOST_LINKS} links are meshed")))
        }
        _ => shaped(&file, name).map_err(refused).and_then(checked),
    };
    names.iter().try_for_each(|name| take(body(name)?))
}

/// A closed surface, turned into x forward, y to starboard, z down.
fn surface(asked: &Asked, name: &str) -> Result<Shaped, VerbError> {
    let refused = |problem: String| VerbError::input(&asked.body, problem);
    let lies = Lies::read(&asked.body, &asked.spec.lies)?;
    let MeshFile { mesh, notes, .. } = read_mesh(&lies)?;
    let troubles = troubles(&mesh);
    if !troubles.is_empty() {
        let unit = lies.unit_m.map_or_else(String::new, |m| format!(" --unit {}", unit_of(m)));
        let repair = format!(
            "froude added-mass {}{unit} --repair repaired.obj writes a mesh with the unambiguous faults corrected",
            asked.body.display()
        );
        let problem = format!("encloses no body that water flows around:\n{}\n  {repair}", troubles.join("\n"));
        return Err(refused(problem));
    }
    if let Some(doubt) = too_large(&mesh).filter(|_| lies.unit_m.is_none()) {
        let problem = format!(
            "is {:.4} m long, which is doubtful above {LARGEST_M} m; write unit = \"mm\" in [source.cfd], or \"m\" if it is that large",
            doubt.extent_m
        );
        return Err(refused(problem));
    }
    let axes = Axes::Ned.vectors(lies.orientation.unwrap_or_default());
    let mut body = Shaped::of_surface(name, mesh.mapped(|v| axes.map(|axis| dot(axis, v))));
    body.notes = notes;
    let [length_m, area_m2] = asked.reference;
    body.reference.length_m = length_m.unwrap_or(body.reference.length_m);
    body.reference.area_m2 = area_m2.unwrap_or(body.reference.area_m2);
    Ok(body)
}

/// What makes a mesh none of a body, a line each.
fn troubles(mesh: &Mesh) -> Vec<String> {
    let mut all = check(mesh);
    if !all.iter().any(Trouble::is_fatal) {
        all.extend(part_troubles(mesh));
        all.extend(crossings(mesh));
    }
    let mut told: Vec<String> = all.iter().filter(|t| t.is_fatal()).map(|t| format!("  {t}")).collect();
    let rest = told.len().saturating_sub(MOST_TOLD);
    told.truncate(MOST_TOLD);
    if rest > 0 {
        told.push(format!("  and {rest} more"));
    }
    told
}
