//! A case's folder as OpenFOAM wants it: `0`, `constant`, `system`, and the mesh by a relative link.

use std::path::{Component, Path, PathBuf};

use crate::case::Case;
use crate::dictionary::Dictionary;
use crate::foam_error::FoamError;
use crate::foam_fields::{Field, fields};
use crate::foam_mesh::FoamMesh;
use crate::foam_system::{self, Pace};

/// Writes a case that starts from its inflow into an empty folder.
///
/// `mesh` is the folder of its points, faces and boundary. It is linked to by its way from `folder`, so that a campaign can be moved as a whole.
///
/// # Errors
///
/// [`FoamError`].
pub fn write(case: &Case, mesh: &Path, folder: &Path, pace: Pace) -> Result<FoamMesh, FoamError> {
    let found = FoamMesh::read(mesh)?;
    for part in ["0", "constant", "system"] {
        let part = folder.join(part);
        std::fs::create_dir_all(&part).map_err(|e| FoamError::at(&part, e))?;
    }
    let link = folder.join("constant/polyMesh");
    let way = way_from(&folder.join("constant"), mesh)?;
    std::os::unix::fs::symlink(way, &link).map_err(|e| FoamError::at(&link, e))?;
    write_fields(&fields(case), &found, folder)?;
    write_dictionary(folder, "constant/transportProperties", &foam_system::transport(case))?;
    write_dictionary(folder, "constant/turbulenceProperties", &foam_system::turbulence(case))?;
    write_dictionary(folder, "system/fvSchemes", &foam_system::schemes(case, pace))?;
    write_dictionary(folder, "system/fvSolution", &foam_system::solution(pace))?;
    Ok(found)
}

/// Writes fields into the start of a case's folder.
///
/// # Errors
///
/// [`FoamError`].
pub fn write_fields(fields: &[Field], mesh: &FoamMesh, folder: &Path) -> Result<(), FoamError> {
    fields.iter().try_for_each(|field| write_text(&folder.join("0").join(field.name), &field.file(mesh)))
}

/// Writes a dictionary's file, `part` of a case's folder.
///
/// # Errors
///
/// [`FoamError`].
pub fn write_dictionary(folder: &Path, part: &str, content: &Dictionary) -> Result<(), FoamError> {
    let name = part.rsplit('/').next().unwrap_or(part);
    write_text(&folder.join(part), &content.file("dictionary", name))
}

fn write_text(path: &Path, text: &str) -> Result<(), FoamError> {
    std::fs::write(path, text).map_err(|e| FoamError::at(path, e))
}

/// Folders of times that a case holds, by time; `0` is one.
///
/// # Errors
///
/// [`FoamError`] of a folder that cannot be read.
pub fn times(folder: &Path) -> Result<Vec<(f64, PathBuf)>, FoamError> {
    let failed = |e| FoamError::at(folder, e);
    let mut times = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
        if let Some(time) = name.parse::<f64>().ok().filter(|t| t.is_finite() && path.is_dir()) {
            times.push((time, path));
        }
    }
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(times)
}

/// The way from one folder to another, by their common ancestor.
fn way_from(folder: &Path, target: &Path) -> Result<PathBuf, FoamError> {
    let whole = |path: &Path| path.canonicalize().map_err(|e| FoamError::at(path, e));
    let (from, to) = (whole(folder)?, whole(target)?);
    let (from, to): (Vec<Component>, Vec<Component>) = (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n(Component::ParentDir, from.len() - common);
    Ok(up.chain(to.into_iter().skip(common)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_to_a_mesh_goes_by_the_common_ancestor() {
        let root = tempfile::tempdir().unwrap();
        let (case, mesh) = (root.path().join("cases/a/attempt-001"), root.path().join("meshes/5f"));
        std::fs::create_dir_all(&case).unwrap();
        std::fs::create_dir_all(&mesh).unwrap();
        assert_eq!(way_from(&case, &mesh).unwrap(), Path::new("../../../meshes/5f"));
        let absent = way_from(&case, &root.path().join("meshes/6f")).unwrap_err();
        assert!(absent.to_string().contains("meshes/6f: No such file"), "{absent}");
    }

    #[test]
    fn times_come_in_the_order_of_their_numbers() {
        let root = tempfile::tempdir().unwrap();
        for name in ["100", "0", "20", "1.5", "system", "nan"] {
            std::fs::create_dir(root.path().join(name)).unwrap();
        }
        std::fs::write(root.path().join("7"), "a file").unwrap();
        let times: Vec<f64> = times(root.path()).unwrap().into_iter().map(|(time, _)| time).collect();
        assert_eq!(times, [0.0, 1.5, 20.0, 100.0]);
    }
}
