//! WAMIT's numeric output of added mass, `.1`.
//!
//! A row an element, `PER I J ABAR`. PER is the wave's period; below 0 it stands for frequency zero, 0 for frequency infinity
//! (WAMIT manual, forms of the numeric output files; Capytaine 3.0 writes the same). I is the force, J the motion, from 1 to
//! 6N. `ABAR = A/(ρ Lᵏ)`, k = 3 for force by translation, 4 where one of the two turns, 5 where both do.

use std::fmt::Write as _;
use std::path::Path;

use froude_records::{Place, RecordError, read};

use super::AddedMassFile;
use super::error::{FileError, MOST_BODIES};

/// The largest file that is read: a few hundred bodies.
const LARGEST_BYTES: u64 = 512 << 20;

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

/// The two limits that a `.1` file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct AddedMassLimits {
    /// Added mass at frequency zero, kg, kg m, kg m²; `6N` rows of `6N`.
    pub zero_frequency: Option<Vec<Vec<f64>>>,
    /// The same at infinite frequency.
    pub infinite_frequency: Option<Vec<Vec<f64>>>,
    /// Rows at other periods, which were passed over.
    pub n_other_rows: usize,
}

/// Reads the limits of a WAMIT `.1` file; those that it does not have are `None`.
///
/// `density_kg_m3` and `length_m` are the ones that the file's numbers are over. Elements that are not in the file are 0, as
/// WAMIT leaves out those that vanish by symmetry; N is the number of bodies that the largest index belongs to. A first line
/// of words is taken as a header.
///
/// # Errors
///
/// [`RecordError::Read`], [`RecordError::TooLarge`]; [`RecordError::Syntax`] with the line that is no row, or that gives an
/// element twice.
pub fn read_wamit(path: &Path, density_kg_m3: f64, length_m: f64) -> Result<AddedMassLimits, RecordError> {
    for (what, value) in [("density", density_kg_m3), ("reference length", length_m)] {
        if !(value > 0.0 && value.is_finite()) {
            let reason = FileError::scale(what, value).to_string();
            return Err(RecordError::Read { path: path.to_owned(), reason });
        }
    }
    let text = read::text(path, LARGEST_BYTES, "an added mass")?;
    let mut elements: [Vec<(usize, usize, f64, usize)>; 2] = [Vec::new(), Vec::new()];
    let (mut largest, mut n_other_rows) = (0, 0);
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let refuse = |problem: String| RecordError::syntax(Place::line(path, number), problem);
        let cells: Vec<&str> = line.split_whitespace().collect();
        let is_header = number == 1 && cells.first().is_some_and(|c| c.parse::<f64>().is_err());
        if cells.is_empty() || is_header {
            continue;
        }
        let &[period, i, j, bar, ..] = cells.as_slice() else {
            return Err(refuse(format!("the row has {} numbers; PER, I, J and ABAR are needed", cells.len())));
        };
        let real = |cell: &str| {
            // Fortran writes D for E.
            let value = cell.replace(['D', 'd'], "E").parse::<f64>().ok().filter(|v| v.is_finite());
            value.ok_or_else(|| refuse(format!("`{cell}` is not a finite number")))
        };
        let counted = |cell: &str| {
            let value = cell.parse::<usize>().ok().filter(|v| (1..=6 * MOST_BODIES).contains(v));
            value.ok_or_else(|| refuse(format!("`{cell}` is not an index; they go from 1 to {}", 6 * MOST_BODIES)))
        };
        let (period, i, j, bar) = (real(period)?, counted(i)?, counted(j)?, real(bar)?);
        if period > 0.0 {
            n_other_rows += 1;
            continue;
        }
        largest = largest.max(i).max(j);
        elements[usize::from(period == 0.0)].push((i - 1, j - 1, bar, number));
    }
    let size = largest.div_ceil(6) * 6;
    let [zero_frequency, infinite_frequency] = elements.map(|elements| {
        if elements.is_empty() {
            return Ok(None);
        }
        let mut matrix = vec![vec![0.0; size]; size];
        let mut lines = vec![0; size * size];
        for (i, j, bar, line) in elements {
            let before = std::mem::replace(&mut lines[i * size + j], line);
            if before > 0 {
                let problem = format!("element {}, {} stands in line {before} already; delete one", i + 1, j + 1);
                return Err(RecordError::syntax(Place::line(path, line), problem));
            }
            matrix[i][j] = bar * scale(density_kg_m3, length_m, i, j);
        }
        Ok(Some(matrix))
    });
    Ok(AddedMassLimits { zero_frequency: zero_frequency?, infinite_frequency: infinite_frequency?, n_other_rows })
}
