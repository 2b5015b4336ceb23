//! A load cell of several bridges: the matrix that makes loads of what they read.
//!
//! ```toml
//! [cell]
//! columns = ["g1", "g2", "g3"]             # channels, as [columns] names them
//! loads   = ["f_x", "f_y", "m_z"]
//! units   = ["N", "N", "N m"]
//! frame   = "cell"                         # "body", or a declared one
//! matrix  = [[12.1, 0.2, 0.0],             # a row a load, in its unit per unit of the bridge as [columns] has it
//!            [0.1, 11.8, 0.3],
//!            [0.0, 0.1, 0.9]]
//! ```

use crate::error::RecordError;
use crate::nearest::suggestion;
use crate::section::{Section, found};
use crate::units::{Dimension, Unit, parse_unit};

/// The loads that there are, forces before moments.
pub const LOADS: [&str; 6] = ["f_x", "f_y", "f_z", "m_x", "m_y", "m_z"];
/// Most bridges of one cell.
const MOST: usize = 64;

/// Dimension of a load.
#[must_use]
pub fn dimension_of_load(name: &str) -> Dimension {
    if name.starts_with('m') { Dimension::MOMENT } else { Dimension::FORCE }
}

/// A load cell of several bridges.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Channels that it makes loads of.
    pub columns: Vec<String>,
    /// The loads.
    pub loads: Vec<String>,
    /// Their units.
    pub units: Vec<Unit>,
    /// The frame whose axes they are along.
    pub frame: String,
    /// A row for each load.
    pub matrix: Vec<Vec<f64>>,
}

/// `[cell]`; `frames` are those that are declared.
pub(crate) fn cell(root: &Section<'_>, frames: &[&str]) -> Result<Option<Cell>, RecordError> {
    let Some(s) = root.section("cell")? else { return Ok(None) };
    s.only(&["columns", "loads", "units", "frame", "matrix"])?;
    let list = |key: &'static str, advice: &str| {
        let out = s.placed_texts(key)?;
        if out.is_empty() { Err(s.missing(key, advice)) } else { Ok(out) }
    };
    let columns = list("columns", "name the channels of its bridges: columns = [\"g1\", \"g2\"]")?;
    let columns: Vec<String> = columns.into_iter().map(|(name, _)| name).collect();
    let is_one_a_load = |key: &'static str, found: usize, expected: usize| {
        let problem = format!("has {found} entries; expected {expected}, one for each of the loads");
        s.refuse(key, found != expected, problem)
    };
    let problem = format!("names {} bridges; at most {MOST} are read", columns.len());
    s.refuse("columns", columns.len() > MOST, problem)?;
    let mut loads: Vec<String> = Vec::new();
    for (load, place) in list("loads", "name the loads: loads = [\"f_x\", \"f_y\", \"m_z\"]")? {
        let refuse = |problem: String| Err(RecordError::value(place, "loads", problem));
        if !LOADS.contains(&load.as_str()) {
            return refuse(format!("names {load:?}; {}", suggestion(&load, LOADS)));
        }
        if loads.contains(&load) {
            return refuse(format!("names {load:?} twice"));
        }
        loads.push(load);
    }
    let texts = list("units", "write units = [\"N\", \"N\", \"N m\"], one for each load")?;
    is_one_a_load("units", texts.len(), loads.len())?;
    let mut units = Vec::new();
    for ((text, place), load) in texts.into_iter().zip(&loads) {
        let refuse = |problem: String| RecordError::value(place, "units", problem);
        let expected = dimension_of_load(load);
        match parse_unit(&text) {
            Ok(unit) if unit.dimension == expected => units.push(unit),
            Ok(unit) => {
                let (found, expected) = (unit.dimension.describe(), expected.describe());
                return Err(refuse(format!("has {text:?} for {load}, {found}; expected {expected}")));
            }
            Err(e) => return Err(refuse(format!("has {text:?} for {load}, which cannot be read: {e}"))),
        }
    }
    let advice = "state along which axes its loads are: frame = \"body\", or a declared frame";
    let frame = s.need_text("frame", advice)?;
    let mut known = frames.iter().copied().chain(["body"]);
    let problem = format!("is {frame:?}; {}", suggestion(frame, known.clone()));
    s.refuse("frame", !known.any(|known| known == frame), problem)?;
    let value = s.need("matrix", "write matrix = [[…], […]], a row for each load")?;
    let no_rows = || s.wrong("matrix", value, format!("is {}; expected rows of numbers", found(value)));
    let rows = value.get_ref().as_array().ok_or_else(no_rows)?;
    is_one_a_load("matrix", rows.len(), loads.len())?;
    let mut matrix = Vec::new();
    for row in rows {
        let numbers = row.get_ref().as_array().filter(|numbers| numbers.len() == columns.len()).ok_or_else(|| {
            let problem =
                format!("is {}; expected a row of {} numbers, one for each bridge", found(row), columns.len());
            s.wrong("matrix", row, problem)
        })?;
        matrix.push(numbers.iter().map(|x| s.as_number("matrix", x)).collect::<Result<Vec<f64>, _>>()?);
    }
    Ok(Some(Cell { columns, loads, units, frame: frame.to_owned(), matrix }))
}
