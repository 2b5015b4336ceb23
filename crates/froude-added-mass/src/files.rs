//! Added mass of one body or several, in the files that other hydrodynamics programs read.
//!
//! | file | text or binary | read by | method |
//! |------|----------------|---------|--------|
//! | WAMIT `.1`         | text   | OpenFAST, BEMIO, BEMRosetta, OrcaFlex …    | [`AddedMassFile::wamit`] |
//! | NetCDF-3 classic   | binary | xarray, Capytaine's readers, BEMRosetta    | [`AddedMassFile::netcdf`] |
//! | CSV                | text   | [`csv_table`](froude_records::csv_table), anything | [`AddedMassFile::csv`] |
//!
//! **Limits.** Without waves there are two: frequency zero, where the free surface is a rigid lid, and infinity, where it
//! has φ = 0. Far below the surface both are the same; hand in the same matrix twice, for readers look for either.
//! **Order.** A matrix is `6N × 6N`: body after body, each surge, sway, heave, roll, pitch, yaw; row i is the force or
//! moment on, column j the motion of.
//! **Frame.** That of the mesh, moments about the origin that its maker used: none of these files can say which.
//! Wave programs have `z` up; a matrix in axes with `z` down has to be turned first.
//! **Units.** SI: kg, kg m, kg m².
//!
//! Not here: damping and forces of waves, finite frequencies.

mod classic;
mod csv;
mod error;
mod netcdf;
mod wamit;

use std::path::Path;

use froude_records::write::write_atomically;

use crate::AddedMassError;
pub use error::FileError;
use error::MOST_BODIES;

/// Degrees of freedom of a body, in the order and with the names of wave programs.
pub const DEGREES_OF_FREEDOM: [&str; 6] = ["Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw"];

/// What goes into such a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AddedMassFile<'a> {
    /// Density of the water, kg/m³; WAMIT's numbers are over it.
    pub density_kg_m3: f64,
    /// Gravity, m/s². Nothing here depends on it, but readers ask for it.
    pub gravity_m_s2: f64,
    /// Length that WAMIT's numbers are over (its ULEN), m. The file does not say it: 1 m is what most readers take.
    pub length_m: f64,
    /// Names of the bodies, in the order of the matrices: letters, digits, blanks, `-`, `.` and single `_`.
    pub bodies: &'a [String],
    /// Added mass at frequency zero (rigid lid), kg, kg m, kg m²; `6N` rows of `6N`.
    pub zero_frequency: Option<&'a [Vec<f64>]>,
    /// The same at infinite frequency (φ = 0 on the surface).
    pub infinite_frequency: Option<&'a [Vec<f64>]>,
}

impl<'a> AddedMassFile<'a> {
    /// Writes the format that the file's name ends in (`.1`, `.nc`, `.csv`), whole or not at all.
    ///
    /// # Errors
    ///
    /// [`AddedMassError::Refused`] for content that cannot be written, [`AddedMassError::Record`] for a disk that does not take it.
    pub fn write(&self, path: &Path) -> Result<(), AddedMassError> {
        Ok(write_atomically(path, &self.bytes(path)?)?)
    }

    /// The bytes of the format that a file's name ends in.
    ///
    /// # Errors
    ///
    /// [`AddedMassError::Refused`] for content that cannot be written.
    pub fn bytes(&self, path: &Path) -> Result<Vec<u8>, AddedMassError> {
        let content = match path.extension().and_then(|e| e.to_str()) {
            Some("1") => self.wamit().map(String::into_bytes),
            Some("csv") => self.csv().map(String::into_bytes),
            Some("nc") => self.netcdf(),
            _ => Err(FileError("the file name must end in .1 (WAMIT), .nc (NetCDF) or .csv".to_owned())),
        };
        content.map_err(|reason| {
            AddedMassError::Refused(format!("cannot write {}: {reason}; nothing was changed", path.display()))
        })
    }

    /// The limits that are there, zero first, with their names.
    fn limits(&self) -> Vec<(&'static str, &'a [Vec<f64>])> {
        let zero = self.zero_frequency.map(|matrix| ("zero", matrix));
        let infinite = self.infinite_frequency.map(|matrix| ("infinite", matrix));
        zero.into_iter().chain(infinite).collect()
    }

    /// Everything that no format can hold.
    fn check(&self) -> Result<(), FileError> {
        for (what, value) in
            [("density", self.density_kg_m3), ("gravity", self.gravity_m_s2), ("reference length", self.length_m)]
        {
            if !(value > 0.0 && value.is_finite()) {
                return Err(FileError::scale(what, value));
            }
        }
        if !(1..=MOST_BODIES).contains(&self.bodies.len()) {
            return Err(FileError::body_count(self.bodies.len()));
        }
        let mut seen = std::collections::BTreeSet::new();
        for (index, name) in self.bodies.iter().enumerate() {
            let is_plain = name.chars().all(|c| c.is_alphanumeric() || " -._".contains(c));
            let problem = if name.trim().is_empty() {
                "is empty"
            } else if !is_plain || name.contains("__") {
                "has more than letters, digits, blanks, `-`, `.` and single `_`"
            } else if !seen.insert(name) {
                "appears twice"
            } else {
                continue;
            };
            return Err(FileError(format!("the name {name:?} of body {} {problem}", index + 1)));
        }
        if self.limits().is_empty() {
            let none = "there is neither an added mass at zero nor one at infinite frequency; at least one is needed";
            return Err(FileError(none.to_owned()));
        }
        let expected = 6 * self.bodies.len();
        for (limit, matrix) in self.limits() {
            let wrong = |what: String| FileError(format!("added mass at {limit} frequency: {what}"));
            let shape = |what: &str, found: usize| wrong(format!("{what} {found}; {expected} are needed, 6 a body"));
            if matrix.len() != expected {
                return Err(shape("rows:", matrix.len()));
            }
            for (row, elements) in matrix.iter().enumerate() {
                if elements.len() != expected {
                    return Err(shape(&format!("elements of row {}:", row + 1), elements.len()));
                }
                if let Some((column, &value)) = elements.iter().enumerate().find(|(_, a)| !a.is_finite()) {
                    let (row, column) = (row + 1, column + 1);
                    return Err(wrong(format!("element {row}, {column} is {value}, not a finite number")));
                }
            }
        }
        Ok(())
    }
}
