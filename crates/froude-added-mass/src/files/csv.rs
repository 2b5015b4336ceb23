//! Added mass as a table: a row for each limit and pair of bodies, a column an element.

use std::fmt::Write as _;

use froude_records::guard::guarded;

use super::{AddedMassFile, FileError};

impl AddedMassFile<'_> {
    /// A CSV table with the columns `frequency` (`zero` or `infinite`), `force_on`, `motion_of` (bodies) and `A11 [kg]` …
    /// `A66 [kg m^2]`, rows of the matrix first.
    ///
    /// Numbers read back to the bits that were written.
    ///
    /// # Errors
    ///
    /// See [`FileError`].
    pub fn csv(&self) -> Result<String, FileError> {
        self.check()?;
        let mut text = "frequency,force_on,motion_of".to_owned();
        for i in 0..6 {
            for j in 0..6 {
                let unit = ["kg", "kg m", "kg m^2"][usize::from(i > 2) + usize::from(j > 2)];
                // Writing to a string does not fail.
                let _ = write!(text, ",A{}{} [{unit}]", i + 1, j + 1);
            }
        }
        text.push('\n');
        for (limit, matrix) in self.limits() {
            for (rows, force_on) in matrix.chunks(6).zip(self.bodies) {
                for (body, motion_of) in self.bodies.iter().enumerate() {
                    let _ = write!(text, "{limit},{},{}", guarded(force_on.clone()), guarded(motion_of.clone()));
                    for element in rows.iter().flat_map(|row| &row[6 * body..6 * body + 6]) {
                        let _ = write!(text, ",{element:?}");
                    }
                    text.push('\n');
                }
            }
        }
        Ok(text)
    }
}
