//! Sidecars: what the columns of a CSV with other headers are.

use std::path::{Path, PathBuf};

use indexmap::IndexMap;

use crate::csv_table::{check_dimension, number};
use crate::error::{Place, RecordError, read_bytes, utf8};
use crate::nearest::suggestion;
use crate::scale::{Scale, Value};
use crate::section::{Section, Source, parse};
use crate::table::{Column, ColumnData, is_text_column, known_dimension};
use crate::units::{Quantity, Unit, parse_unit};

const LARGEST_BYTES: u64 = 1 << 20;

/// A sidecar as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Sidecar {
    /// The file.
    pub path: PathBuf,
    /// `[constants]`.
    pub constants: IndexMap<String, Quantity>,
    /// `[columns]` in the order written: header in the table → what it is.
    pub columns: IndexMap<String, Mapping>,
}

/// What one column of the table is.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapping {
    /// Name in Froude.
    pub name: String,
    /// Unit of the numbers in the table; none for text and for scaled columns.
    pub unit: Option<Unit>,
    /// Factor of sign or direction.
    pub sign: f64,
    /// Factor that gives a dimensionless column its dimension.
    pub scale: Option<Scale>,
    /// Line in the sidecar.
    pub line: usize,
}

/// Whether a `.toml` beside a table is a sidecar (it has `[columns]`) and not a campaign.
pub(crate) fn is_sidecar(path: &Path) -> bool {
    std::fs::read_to_string(path).is_ok_and(|text| text.lines().any(|l| l.trim_start().starts_with("[columns")))
}

/// Reads a sidecar.
///
/// # Errors
///
/// See [`RecordError`].
pub fn read_sidecar(path: &Path) -> Result<Sidecar, RecordError> {
    let bytes = read_bytes(path, LARGEST_BYTES, "a sidecar")?;
    parse_sidecar(path, utf8(path, &bytes)?)
}

/// The same from text; `path` is for messages.
///
/// # Errors
///
/// See [`RecordError`].
pub fn parse_sidecar(path: &Path, text: &str) -> Result<Sidecar, RecordError> {
    let source = Source { path, text };
    let document = parse(source)?;
    let root = Section::new(source, "", document.get_ref(), 0);
    root.schema("sidecar")?;
    let mut constants = IndexMap::new();
    if let Some(section) = root.section("constants")? {
        for (name, _, value) in section.entries() {
            constants.insert(name.to_owned(), section.as_quantity(name, value)?);
        }
    }
    let mut columns = IndexMap::new();
    let section = root.section("columns")?.ok_or_else(|| {
        root.missing("columns", "write [columns] with lines like speed_col = { name = \"speed\", unit = \"m/s\" }")
    })?;
    for (header, _, value) in section.entries() {
        columns.insert(header.to_owned(), mapping(&section.as_section(header, value)?)?);
    }
    root.finish()?;
    Ok(Sidecar { path: path.to_owned(), constants, columns })
}

fn mapping(section: &Section<'_>) -> Result<Mapping, RecordError> {
    let name = section.text("name")?.ok_or_else(|| section.missing("name", "write name = \"f_x\", say"))?.to_owned();
    let place = section.place();
    let unit = match section.text("unit")? {
        Some(text) => {
            let unit = parse_unit(text).map_err(|e| RecordError::Value {
                place: place.clone(),
                key: "unit".to_owned(),
                problem: format!("cannot be read: {e}"),
            })?;
            check_dimension(&place, &format!("{name} [{text}]"), &name, &unit)?;
            Some(unit)
        }
        None => None,
    };
    let sign = section.number("sign")?.unwrap_or(1.0);
    if sign.abs() != 1.0 {
        return Err(RecordError::Value {
            place,
            key: "sign".to_owned(),
            problem: format!("is {sign}; it is 1 or -1, and a factor goes into scale"),
        });
    }
    let scale = section
        .text("scale")?
        .map(|text| {
            Scale::parse(text).map_err(|problem| RecordError::Value {
                place: place.clone(),
                key: "scale".to_owned(),
                problem: format!("{text:?} cannot be read: {problem}"),
            })
        })
        .transpose()?;
    section.finish()?;
    if scale.is_some() && unit.as_ref().is_some_and(|u| u.dimension != crate::units::Dimension::ONE) {
        return Err(RecordError::Value {
            place,
            key: "scale".to_owned(),
            problem: "belongs to a dimensionless column: leave `unit` out, the scale gives it".to_owned(),
        });
    }
    if unit.is_none() && scale.is_none() && !is_text_column(&name) && known_dimension(&name).is_some() {
        return Err(RecordError::MissingUnit {
            place,
            column: name.clone(),
            advice: "write unit = \"…\" beside its name, or scale = \"…\" for a dimensionless column".to_owned(),
        });
    }
    Ok(Mapping { name, unit, sign, scale, line: line_of(section) })
}

fn line_of(section: &Section<'_>) -> usize {
    match section.place().position {
        crate::error::Position::Line(line) => line,
        _ => 0,
    }
}

impl Sidecar {
    /// The mapped columns of a table, in the order of the sidecar; columns that it does not name are left out.
    pub(crate) fn columns(
        &self,
        table: &Path,
        header: &[String],
        raw: &dyn Fn(&str) -> Option<Vec<String>>,
        place: &dyn Fn(usize) -> Place,
    ) -> Result<Vec<Column>, RecordError> {
        let mut out: Vec<Column> = Vec::new();
        for (written, mapping) in &self.columns {
            let cells = raw(written).ok_or_else(|| RecordError::UnknownColumn {
                place: Place::line(&self.path, mapping.line),
                column: written.clone(),
                advice: format!("{} has: {}", table.display(), suggestion(written, header.iter().map(String::as_str))),
            })?;
            if mapping.unit.is_none() && mapping.scale.is_none() {
                out.push(Column { name: mapping.name.clone(), data: ColumnData::Text(cells) });
                continue;
            }
            let values = cells
                .iter()
                .enumerate()
                .map(|(row, cell)| number(cell, written, &|| place(row)))
                .collect::<Result<Vec<f64>, _>>()?;
            let data = match (&mapping.scale, &mapping.unit) {
                (Some(scale), _) => self.scaled(mapping, scale, &values, &out)?,
                (None, Some(unit)) => ColumnData::Number {
                    unit: unit.clone(),
                    dimension: unit.dimension,
                    si: values.iter().map(|v| mapping.sign * unit.to_si(*v)).collect(),
                },
                (None, None) => ColumnData::Text(cells),
            };
            out.push(Column { name: mapping.name.clone(), data });
        }
        Ok(out)
    }

    /// value · scale, over the constants and the columns mapped before this one.
    fn scaled(
        &self,
        mapping: &Mapping,
        scale: &Scale,
        values: &[f64],
        before: &[Column],
    ) -> Result<ColumnData, RecordError> {
        let refuse = |problem: String| RecordError::Value {
            place: Place::line(&self.path, mapping.line),
            key: "scale".to_owned(),
            problem: format!("{:?}: {problem}", scale.text()),
        };
        let mut si = Vec::with_capacity(values.len());
        let mut dimension = None;
        for (row, value) in values.iter().enumerate() {
            let name = |name: &str| {
                if let Some(q) = self.constants.get(name) {
                    return Some(Value { si: q.value_si, dimension: q.unit.dimension });
                }
                before.iter().find(|c| c.name == name).and_then(|c| match &c.data {
                    ColumnData::Number { si, dimension, .. } => Some(Value { si: si[row], dimension: *dimension }),
                    ColumnData::Text(_) => None,
                })
            };
            let factor = scale.evaluate(&name).map_err(refuse)?;
            if !factor.si.is_finite() {
                return Err(refuse(format!("is not finite in row {}", row + 1)));
            }
            dimension = Some(factor.dimension);
            si.push(mapping.sign * value * factor.si);
        }
        let dimension = dimension.unwrap_or(crate::units::Dimension::ONE);
        let unit = Unit::si(dimension);
        check_dimension(&Place::line(&self.path, mapping.line), &mapping.name, &mapping.name, &unit)?;
        Ok(ColumnData::Number { unit, dimension, si })
    }
}
