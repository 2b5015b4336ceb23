//! Mesh files of other programs, read and written.
//!
//! **Units.** None is applied: coordinates come as the file has them, with its unit where it states one. The caller scales them, and [`crate::plausible`] says when a
//! body is so large that it must have been drawn in millimetres.
//!
//! | format | extension | what is read | source |
//! | --- | --- | --- | --- |
//! | STL | `.stl` | ASCII and binary | 3D Systems, StereoLithography interface specification |
//! | Wavefront OBJ | `.obj` | vertices and faces | Wavefront, Advanced Visualizer manual, appendix B |
//! | PLY | `.ply` | ASCII, binary of both byte orders | Turk, The PLY polygon file format, 1994 |
//! | WAMIT | `.gdf` | low order, with ISX and ISY | WAMIT manual 7, chapter 6 |
//! | Nemoh | `.dat` | with its symmetry | Nemoh manual, mesh file |
//! | Gmsh | `.msh` | 2.2 and 4.1, ASCII and binary; first and second order | Gmsh manual, file formats |
//! | Collada | `.dae` | 1.4 and 1.5, with its unit and its axes | Khronos, COLLADA 1.4.1 |
//!
//! What a file has and a mesh has not (normals, colours, lines, volumes) is left out, and a note says so. What is wrong with the
//! surface itself, with NaN and infinite coordinates, [`mod@crate::check`] tells; nothing is repaired here.
//!
//! **Why our own readers.** Those that the ecosystem has either lose the place of an error (tobj, stl\_io), read text as `f32` (stl\_io),
//! refuse NaN (stl\_io), allocate by what a header claims or panic on an odd file (mshio, tobj's materials). Where they read a file,
//! the tests compare ours with them.
//!
//! Memory is at most some twenty times the size of the file: a panel of twelve short numbers, mirrored twice.

mod cursor;
mod dae;
mod gdf;
mod msh;
mod nemoh;
mod obj;
mod ply;
mod stl;
pub mod vtk;
mod write;

use std::fmt;

use cursor::Cursor;

use crate::mesh::Mesh;

pub use crate::files::soup::ReadError;
pub use write::{write_obj, write_stl_binary};

/// Largest file, bytes: the number of a vertex has 32 bits.
const LARGEST: usize = u32::MAX as usize;

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// STL, ASCII or binary.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// PLY, ASCII or binary.
    Ply,
    /// WAMIT, low order.
    Gdf,
    /// Nemoh.
    Nemoh,
    /// Gmsh 2.2 or 4.1, ASCII or binary.
    Msh,
    /// Collada.
    Dae,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stl => "STL",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Gdf => "WAMIT GDF",
            Self::Nemoh => "Nemoh",
            Self::Msh => "Gmsh",
            Self::Dae => "Collada",
        })
    }
}

impl Format {
    fn of_extension(name: &str) -> Option<Self> {
        let (_, extension) = name.rsplit_once('.')?;
        Some(match extension.to_ascii_lowercase().as_str() {
            "stl" => Self::Stl,
            "obj" => Self::Obj,
            "ply" => Self::Ply,
            "gdf" => Self::Gdf,
            "dat" => Self::Nemoh,
            "msh" => Self::Msh,
            "dae" => Self::Dae,
            _ => return None,
        })
    }

    fn of_content(bytes: &[u8]) -> Option<Self> {
        let looks: [(Self, fn(&[u8]) -> bool); 7] = [
            (Self::Ply, |b| b.starts_with(b"ply\n") || b.starts_with(b"ply\r")),
            (Self::Dae, dae::looks_like),
            (Self::Msh, |b| b.trim_ascii_start().starts_with(b"$MeshFormat")),
            (Self::Stl, stl::looks_like),
            (Self::Nemoh, nemoh::looks_like),
            (Self::Gdf, gdf::looks_like),
            (Self::Obj, obj::looks_like),
        ];
        looks.into_iter().find(|(_, is_such)| is_such(bytes)).map(|(format, _)| format)
    }
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The surface, in the file's own unit.
    pub mesh: Mesh,
    /// What it was read as.
    pub format: Format,
    /// What was left out, mirrored or divided, a sentence each.
    pub notes: Vec<String>,
    /// Metres of that unit, where the file states it.
    pub unit_m: Option<f64>,
}

/// Reads a mesh file; the extension of `name` says its format, else the content.
///
/// # Errors
///
/// [`ReadError`] with the place, what is there, what should be and what to do about it.
///
/// # Example
///
/// ```
/// let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
/// let file = froude_mesh::files::read("hull.obj", text.as_bytes())?;
/// assert_eq!((file.mesh.vertices.len(), file.mesh.panels.len()), (3, 1));
///
/// let error = froude_mesh::files::read("hull.obj", b"v 0 0\n").unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "hull.obj, line 1, column 6: the end of the line where a number, z of a vertex, should be; correct the line, or export the file again"
/// );
/// # Ok::<(), froude_mesh::files::ReadError>(())
/// ```
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshFile, ReadError> {
    if bytes.len() > LARGEST {
        let bytes = bytes.len();
        return Err(ReadError(format!(
            "{name} has {bytes} bytes, the limit is {LARGEST}; divide it, or make a coarser mesh"
        )));
    }
    let format = Format::of_extension(name).or_else(|| Format::of_content(bytes));
    let Some(format) = format else {
        return Err(ReadError(format!(
            "{name}: neither extension nor content is that of STL, OBJ, PLY, WAMIT GDF, Nemoh, Gmsh or Collada; give it the extension of its \
             format (.stl .obj .ply .gdf .dat .msh .dae)"
        )));
    };
    // Some editors begin a text with the mark of its encoding.
    let text = if format == Format::Stl { None } else { bytes.strip_prefix(b"\xEF\xBB\xBF") };
    let cursor = Cursor::new(name, text.unwrap_or(bytes));
    let mut unit_m = None;
    let (mesh, notes) = match format {
        Format::Stl => stl::read(cursor),
        Format::Obj => obj::read(cursor),
        Format::Ply => ply::read(cursor),
        Format::Gdf => gdf::read(cursor),
        Format::Nemoh => nemoh::read(cursor),
        Format::Msh => msh::read(cursor),
        Format::Dae => dae::read(&cursor).map(|(mesh, notes, unit)| {
            unit_m = Some(unit);
            (mesh, notes)
        }),
    }?;
    Ok(MeshFile { mesh, format, notes, unit_m })
}

pub(crate) mod soup;
#[cfg(test)]
mod tests;
