//! A mesh with the unambiguous faults corrected, as a new file; the given one stays as it is.

use std::io::Write as _;
use std::path::Path;

use froude_mesh::check::{check, extent};
use froude_mesh::crossing::crossings;
use froude_mesh::files::{MeshFile, write_obj, write_stl_binary};
use froude_mesh::parts::part_troubles;
use froude_mesh::repair::{WELD, repaired};
use froude_mesh::union::united;
use froude_records::write::Prepared;

use super::load::{is_body_file, read_unmerged};
use crate::error::AddedMassError;
use crate::options::Asked;

/// What was done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Repaired {
    /// What the file's reader had to say.
    pub notes: Vec<String>,
    /// What was changed, or could not be decided, a sentence each.
    pub repairs: Vec<String>,
    /// What is still wrong.
    pub left: Vec<String>,
    /// Panels of the new mesh.
    pub panels: usize,
}

/// Reads, repairs, writes: `.obj`, which keeps quadrilaterals, or binary `.stl`.
///
/// # Errors
///
/// A mesh that cannot be read, a target of another format or one that is there already, a disk that is full.
pub fn repair(job: &Asked, weld_m: Option<f64>, target: &Path) -> Result<Repaired, AddedMassError> {
    let input = job.input.as_path();
    let extension = target.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !matches!(extension.as_str(), "obj" | "stl") {
        return Err(AddedMassError::input(target, "a repaired mesh is written as .obj or .stl"));
    }
    if is_body_file(input) {
        return Err(AddedMassError::input(input, "--repair is for a mesh; a body file has none"));
    }
    if input == target || (target.exists() && input.canonicalize().ok() == target.canonicalize().ok()) {
        return Err(AddedMassError::input(target, "name another file than the input; it stays as it is"));
    }
    if target.symlink_metadata().is_ok() {
        let why = format!(
            "{} already exists and is not overwritten; name another file, or delete that one",
            target.display()
        );
        return Err(AddedMassError::Refused(why));
    }
    let MeshFile { mesh, notes, .. } = read_unmerged(job)?;
    let (mut mesh, mut repairs) = repaired(&mesh, weld_m.unwrap_or_else(|| WELD * extent(&mesh)));
    let mut left = Vec::new();
    match united(&mesh) {
        Ok(None) => {}
        Ok(Some(whole)) => {
            mesh = whole.mesh;
            repairs.extend(whole.notes);
        }
        Err(trouble) => left.push(trouble.to_string()),
    }
    left.extend(check(&mesh).iter().map(ToString::to_string));
    left.extend(part_troubles(&mesh).iter().chain(&crossings(&mesh)).map(ToString::to_string));
    let content = if extension == "obj" { write_obj(&mesh).into_bytes() } else { write_stl_binary(&mesh) };
    Prepared::new(target, |file| file.write_all(&content))?.take_free_place()?;
    Ok(Repaired { notes, repairs, left, panels: mesh.panels.len() })
}
