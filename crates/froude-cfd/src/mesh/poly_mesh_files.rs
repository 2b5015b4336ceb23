//! A mesh as the five files of OpenFOAM's `constant/polyMesh`, in a folder that is named by their content.

use std::fmt::{Display, Write as _};
use std::path::{Path, PathBuf};

use froude_records::folder::UnfinishedFolder;
use froude_records::hash::sha256_of_bytes;
use froude_records::write::write_atomically;

use crate::mesh_error::MeshError;
use crate::poly_mesh::{PatchKind, PolyMesh};

impl PatchKind {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Wall, Self::Patch, Self::Symmetry, Self::Mirror, Self::Empty];

    /// OpenFOAM's word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Patch => "patch",
            Self::Wall => "wall",
            Self::Symmetry => "symmetryPlane",
            Self::Mirror => "symmetry",
            Self::Empty => "empty",
        }
    }
}

impl PolyMesh {
    /// Writes the mesh into `meshes/HASH`, unless it stands there, and gives that folder.
    ///
    /// The folder's name is the SHA-256 of the files' names, lengths and bytes; numbers have all their digits, so that equal meshes have equal names. A case links its `constant/polyMesh` to it.
    ///
    /// # Errors
    ///
    /// [`MeshError::Write`]: the folder cannot be written.
    pub fn write(&self, meshes: &Path) -> Result<PathBuf, MeshError> {
        keep(meshes, &self.files())
    }

    fn files(&self) -> [(&'static str, String); 5] {
        let note = format!(
            "nPoints: {} nCells: {} nFaces: {} nInternalFaces: {}",
            self.points_m.len(),
            self.cells,
            self.faces.len(),
            self.neighbour.len()
        );
        let points = self.points_m.iter().map(|[x, y, z]| format!("({x:e} {y:e} {z:e})"));
        let faces = self.faces.iter().map(|corners| {
            let all: Vec<String> = corners.iter().map(u32::to_string).collect();
            format!("{}({})", corners.len(), all.join(" "))
        });
        let patches = self.patches.iter().map(|p| {
            format!(
                "    {}\n    {{\n        type {};\n        nFaces {};\n        startFace {};\n    }}",
                p.name,
                p.kind.word(),
                p.count,
                p.start
            )
        });
        [
            ("points", file("vectorField", "points", None, points)),
            ("faces", file("faceList", "faces", None, faces)),
            ("owner", file("labelList", "owner", Some(&note), self.owner.iter())),
            ("neighbour", file("labelList", "neighbour", Some(&note), self.neighbour.iter())),
            ("boundary", file("polyBoundaryMesh", "boundary", None, patches)),
        ]
    }
}

/// Puts the files of a mesh into the folder that their content names, unless it stands there.
pub(crate) fn keep(meshes: &Path, files: &[(&str, String)]) -> Result<PathBuf, MeshError> {
    let folder = meshes.join(name_of(files));
    if !folder.exists() {
        let unfinished = UnfinishedFolder::beside(&folder)?;
        for (name, text) in files {
            write_atomically(&unfinished.path().join(name), text.as_bytes())?;
        }
        unfinished.take_place()?;
    }
    Ok(folder)
}

fn name_of(files: &[(&str, String)]) -> String {
    let parts: Vec<String> = files
        .iter()
        .map(|(name, text)| format!("{name} {} {}", text.len(), sha256_of_bytes(text.as_bytes())))
        .collect();
    sha256_of_bytes(parts.join("\n").as_bytes())
}

fn file<T: Display>(class: &str, object: &str, note: Option<&str>, items: impl ExactSizeIterator<Item = T>) -> String {
    let note = note.map_or(String::new(), |n| format!("    note        \"{n}\";\n"));
    let mut text = format!(
        "FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {class};\n{note}    location    \"constant/polyMesh\";\n    object      {object};\n}}\n\n{}\n(\n",
        items.len()
    );
    for item in items {
        // Writing into a String cannot fail.
        let _ = writeln!(text, "{item}");
    }
    text.push_str(")\n");
    text
}
