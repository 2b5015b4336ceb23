//! WAMIT's numeric output of added mass, `.1`.
//!
//! A row an element, `PER I J ABAR`. PER is the wave's period; below 0 it stands for frequency zero, 0 for frequency infinity
//! (WAMIT manual, forms of the numeric output files; Capytaine 3.0 writes the same). I is the force, J the motion, from 1 to
//! 6N. `ABAR = A/(ρ Lᵏ)`, k = 3 for force by translation, 4 where one of the two turns, 5 where both do.

use std::fmt::Write as _;

use super::AddedMassFile;
use super::error::FileError;

/// `ρ Lᵏ` of an element, indices from 0.
fn scale(density_kg_m3: f64, length_m: f64, row: usize, column: usize) -> f64 {
    let turning = usize::from(row % 6 > 2) + usize::from(column % 6 > 2);
    density_kg_m3 * length_m.powi(3) * [1.0, length_m, length_m * length_m][turning]
}

/// `-1.2500000000000000E+01`: what Fortran's readers take, to 17 digits.
fn fortran(value: f64) -> String {
    let text = format!("{value:.16e}");
    match text.split_once('e') {
        Some((digits, exponent)) => {
            let (sign, exponent) = exponent.strip_prefix('-').map_or(('+', exponent), |e| ('-', e));
            format!("{digits}E{sign}{exponent:0>2}")
        }
        None => text,
    }
}

impl AddedMassFile<'_> {
    /// WAMIT's `.1`: all elements, frequency zero (PER = −1) before infinity (PER = 0), no header.
    ///
    /// Numbers have 17 digits, WAMIT's own 7; programs that read by blanks take either. The length that they are over is not
    /// in the file: say it (ULEN) where the file is read.
    ///
    /// # Errors
    ///
    /// See [`FileError`].
    pub fn wamit(&self) -> Result<String, FileError> {
        self.check()?;
        let mut text = String::new();
        for (limit, matrix) in self.limits() {
            let period = fortran(if limit == "zero" { -1.0 } else { 0.0 });
            for (i, row) in matrix.iter().enumerate() {
                for (j, a) in row.iter().enumerate() {
                    let bar = fortran(a / scale(self.density_kg_m3, self.length_m, i, j));
                    // Writing to a string does not fail.
                    let _ = writeln!(text, " {period:>23} {:>5} {:>5} {bar:>24}", i + 1, j + 1);
                }
            }
        }
        Ok(text)
    }
}
