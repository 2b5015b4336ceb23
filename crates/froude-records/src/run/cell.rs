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
    let columns: Vec<String> = list("columns", "name the channels of its bridges: columns = [\"g1\", \"g2\"]")?
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    let count = |key: &'static str, found: usize, expected: usize, of: &str| match s.get(key) {
        Some(value) if found != expected => {
            Err(s.wrong(key, value, format!("has {found} entries; expected {expected}, one for each of the {of}")))
        }
        _ => Ok(()),
    };
    if let (true, Some(value)) = (columns.len() > MOST, s.get("columns")) {
        return Err(s.wrong("columns", value, format!("names {} bridges; at most {MOST} are read", columns.len())));
    }
    let mut loads: Vec<String> = Vec::new();
    for (load, place) in list("loads", "name the loads: loads = [\"f_x\", \"f_y\", \"m_z\"]")? {
        let refuse = |problem: String| Err(RecordError::Value { place, key: "loads".to_owned(), problem });
        if !LOADS.contains(&load.as_str()) {
            return refuse(format!("names {load:?}; {}", suggestion(&load, LOADS)));
        }
        if loads.contains(&load) {
            return refuse(format!("names {load:?} twice"));
        }
        loads.push(load);
    }
    let texts = list("units", "write units = [\"N\", \"N\", \"N m\"], one for each load")?;
    count("units", texts.len(), loads.len(), "loads")?;
    let mut units = Vec::new();
    for ((text, place), load) in texts.into_iter().zip(&loads) {
        let refuse = |problem: String| RecordError::Value { place, key: "units".to_owned(), problem };
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
    let frame = s.text("frame")?.ok_or_else(|| {
        s.missing("frame", "state along which axes its loads are: frame = \"body\", or a declared frame")
    })?;
    if let (false, Some(value)) = (frame == "body" || frames.contains(&frame), s.get("frame")) {
        return Err(s.wrong(
            "frame",
            value,
            format!("is {frame:?}; {}", suggestion(frame, frames.iter().copied().chain(["body"]))),
        ));
    }
    let value = s.get("matrix").ok_or_else(|| s.missing("matrix", "write matrix = [[…], […]], a row for each load"))?;
    let rows = value.get_ref().as_array();
    let rows =
        rows.ok_or_else(|| s.wrong("matrix", value, format!("is {}; expected rows of numbers", found(value))))?;
    count("matrix", rows.len(), loads.len(), "loads")?;
    let mut matrix = Vec::new();
    for row in rows {
        let numbers = row.get_ref().as_array().filter(|numbers| numbers.len() == columns.len()).ok_or_else(|| {
            s.wrong(
                "matrix",
                row,
                format!("is {}; expected a row of {} numbers, one for each bridge", found(row), columns.len()),
            )
        })?;
        matrix.push(numbers.iter().map(|x| s.as_number("matrix", x)).collect::<Result<Vec<f64>, _>>()?);
    }
    Ok(Some(Cell { columns, loads, units, frame: frame.to_owned(), matrix }))
}
