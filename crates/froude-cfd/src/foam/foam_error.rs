//! What is wrong with a file of a case.

use std::fmt::Display;
use std::path::Path;

/// A file or a folder of a case that cannot be written or read, or has the wrong format.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FoamError(String);

impl FoamError {
    pub(crate) fn at(path: &Path, problem: impl Display) -> Self {
        Self(format!("{}: {problem}", path.display()))
    }

    /// In a line, counted from 1.
    pub(crate) fn in_line(path: &Path, line: usize, problem: impl Display) -> Self {
        Self(format!("{}, line {line}: {problem}", path.display()))
    }

    /// Of a mesh's folder.
    pub(crate) fn of_mesh(path: &Path, problem: impl Display) -> Self {
        let files = "a mesh has the files points, faces, owner, neighbour and boundary of OpenFOAM";
        Self::at(path, format!("{problem}: {files}"))
    }
}
