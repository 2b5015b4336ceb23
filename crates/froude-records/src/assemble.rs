//! From headers and raw cells to a checked table, the same for every format.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::error::{Place, RecordError, decimal_comma};
use crate::file_words::{FileWords, refuse_sentinel, sidecar_name};
use crate::heading::split_header;
use crate::known_columns::{is_text_column, known_dimension, usual_unit};
use crate::memory;
use crate::nearest::suggestion;
use crate::raw_column::{
    FILL_OR_DELETE, Raw, TEXT_FOR_NUMBERS, TWICE, check_dimension, check_numbers, check_texts, looks_numeric, unit_for,
    unit_of_column,
};
use crate::sidecar::{Mapping, Sidecar};
use crate::table::{Column, ColumnData, Table};
use crate::units::{Unit, parse_unit};

/// What a column of a file becomes, decided by its header alone.
pub(crate) enum Want<'s> {
    /// Numbers in a unit.
    Number {
        /// Name without unit.
        name: String,
        /// Unit as written.
        unit: Unit,
    },
    /// Text.
    Text {
        /// The whole header.
        name: String,
    },
    /// What the sidecar says.
    Mapped(&'s Mapping),
    /// A column that the sidecar does not name.
    LeftOut,
}

impl Want<'_> {
    /// Whether its cells must be numbers.
    pub fn is_number(&self) -> bool {
        match self {
            Self::Number { .. } => true,
            Self::Mapped(mapping) => mapping.unit.is_some() || mapping.scale.is_some(),
            Self::Text { .. } | Self::LeftOut => false,
        }
    }
}

/// Longest header and longest cell of text, in bytes: both are printed in tables and sentences, and none is near it.
const LONGEST_TEXT: usize = 1000;

/// The beginning of a text that is too long to be shown.
fn beginning(text: &str) -> String {
    text.chars().take(40).chain("…".chars()).collect()
}

/// Decides what each column becomes; `header_place` is where the headers stand.
pub(crate) fn plan<'s>(
    path: &Path,
    header: &[String],
    sidecar: Option<&'s Sidecar>,
    header_place: &Place,
) -> Result<Vec<Want<'s>>, RecordError> {
    if let Some((j, long)) = header.iter().enumerate().find(|(_, h)| h.len() > LONGEST_TEXT) {
        return Err(RecordError::syntax(
            header_place.clone(),
            format!(
                "the header of column {} ({:?}) has {} bytes; at most {LONGEST_TEXT} are read",
                j + 1,
                beginning(long),
                long.len()
            ),
        ));
    }
    if sidecar.is_none() && !header.is_empty() && header.iter().all(|h| fast_float2::parse::<f64, _>(h.trim()).is_ok())
    {
        return Err(RecordError::syntax(
            header_place.clone(),
            "there are numbers where the columns should be named; write a line of headers above them, as `speed [m/s],f_x [N]`",
        ));
    }
    if let Some(twice) = first_twice(header.iter().map(String::as_str)) {
        return Err(RecordError::column(header_place.clone(), twice, TWICE));
    }
    let wants = match sidecar {
        Some(sidecar) => {
            let known: BTreeSet<&str> = header.iter().map(String::as_str).collect();
            for (written, mapping) in &sidecar.columns {
                if !known.contains(written.as_str()) {
                    let near = suggestion(written, header.iter().map(String::as_str));
                    let advice = format!("in {}: {near}", path.display());
                    return Err(RecordError::unknown_column(mapping.place.clone(), written, advice));
                }
            }
            header.iter().map(|h| sidecar.columns.get(h).map_or(Want::LeftOut, Want::Mapped)).collect()
        }
        None => header.iter().map(|h| want(path, h, header_place)).collect::<Result<Vec<_>, _>>()?,
    };
    if let Some(twice) = first_twice(wants.iter().filter_map(name_of)) {
        return Err(RecordError::column(header_place.clone(), twice, TWICE));
    }
    Ok(wants)
}

/// The first name that was there before.
fn first_twice<'a>(mut names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let mut seen = BTreeSet::new();
    names.find(|name| !seen.insert(*name))
}

/// Bytes of memory that the cells of one table may take.
pub(crate) struct Room<'a> {
    path: &'a Path,
    taken: u64,
    most: u64,
}

impl<'a> Room<'a> {
    /// Most bytes of cells: 268 million numbers. A fit needs some six times as much.
    pub const MOST_BYTES: u64 = 2 << 30;

    pub fn new(path: &'a Path) -> Self {
        Self::of(path, Self::MOST_BYTES)
    }

    /// Of so many bytes.
    pub fn of(path: &'a Path, most: u64) -> Self {
        Self { path, taken: 0, most }
    }

    /// Takes a part of it.
    ///
    /// # Errors
    ///
    /// [`RecordError::TooLarge`] where no more is left.
    #[inline]
    pub fn take(&mut self, bytes: u64) -> Result<(), RecordError> {
        self.taken = self.taken.saturating_add(bytes);
        if self.taken > self.most { Err(self.refusal(self.taken)) } else { Ok(()) }
    }

    #[cold]
    fn refusal(&self, bytes: u64) -> RecordError {
        RecordError::too_large(self.path, bytes, self.most, "the cells of a table, unpacked")
    }

    /// A number more.
    ///
    /// # Errors
    ///
    /// No room, or no memory.
    #[inline]
    pub fn number(&mut self, numbers: &mut Vec<f64>, value: f64) -> Result<(), RecordError> {
        self.take(size_of::<f64>() as u64)?;
        memory::push(numbers, value).map_err(|e| RecordError::memory(self.path, e))
    }

    /// A text more; `place` is where it stands.
    ///
    /// # Errors
    ///
    /// A text that is too long, no room, or no memory.
    pub fn text(&mut self, texts: &mut Vec<String>, text: &str, place: &dyn Fn() -> Place) -> Result<(), RecordError> {
        if text.len() > LONGEST_TEXT {
            return Err(RecordError::syntax(
                place(),
                format!(
                    "a cell ({:?}) has {} bytes of text; at most {LONGEST_TEXT} are read",
                    beginning(text),
                    text.len()
                ),
            ));
        }
        self.take((size_of::<String>() + text.len()) as u64)?;
        memory::push(texts, text.to_owned()).map_err(|e| RecordError::memory(self.path, e))
    }
}

fn name_of<'a>(want: &'a Want<'_>) -> Option<&'a str> {
    match want {
        Want::Number { name, .. } | Want::Text { name } => Some(name),
        Want::Mapped(mapping) => Some(&mapping.name),
        Want::LeftOut => None,
    }
}

/// A header read as `name [unit]`.
fn want(path: &Path, header: &str, place: &Place) -> Result<Want<'static>, RecordError> {
    let (name, unit) = split_header(header)
        .map_err(|problem| RecordError::syntax(place.clone(), format!("header `{header}`: {problem}")))?;
    let Some(unit) = unit else {
        if known_dimension(name).is_some() && !may_be_text(name) {
            return Err(missing_unit(path, name, place));
        }
        return Ok(Want::Text { name: name.to_owned() });
    };
    let bad = |problem: String| RecordError::column(place.clone(), header, format!(": {problem}"));
    if is_text_column(name) {
        return Err(bad(format!("{name} is text and has no unit; write `{name}`")));
    }
    let (unit, _) = unit_for(name, unit).map_err(|e| bad(e.to_string()))?;
    check_dimension(place, header, name, &unit)?;
    Ok(Want::Number { name: name.to_owned(), unit: unit_of_column(name, unit) })
}

/// `repeat` counts (`repeat [1]`) or labels (`repeat`).
fn may_be_text(name: &str) -> bool {
    is_text_column(name) || name == "repeat"
}

/// A column of numbers without a unit.
fn missing_unit(path: &Path, name: &str, place: &Place) -> RecordError {
    let unit = usual_unit(name).unwrap_or_else(|| "unit".to_owned());
    let sidecar = sidecar_name(path);
    let problem = format!(" has no unit; write `{name} [{unit}]`, or map it with a sidecar {sidecar}");
    RecordError::column(place.clone(), name, problem)
}

impl Want<'_> {
    /// The name of a column whose cells may be empty where tables of several axes are read: a load, or the motion along or about an axis.
    pub fn name_if_blank(&self) -> Option<&str> {
        name_of(self).filter(|name| self.is_number() && is_of_axis(name))
    }

    /// How the unit of a column was read, where that is not what it says.
    fn note(&self, header: &str) -> Option<String> {
        let note = match self {
            Self::Number { name, .. } => unit_for(name, split_header(header).ok()?.1?).ok()?.1?,
            Self::Mapped(mapping) => mapping.note.clone()?,
            Self::Text { .. } | Self::LeftOut => return None,
        };
        Some(format!("{}: {note}", name_of(self)?))
    }

    /// What to do about an empty cell: a column that a table can do without may also be left out.
    pub fn advice(&self, path: &Path, sidecar: Option<&Sidecar>) -> String {
        let Some(name) = name_of(self) else { return FILL_OR_DELETE.to_owned() };
        let base = name.strip_suffix("_dot").unwrap_or(name);
        if is_of_axis(base) || matches!(base, "speed" | "angle") || is_text_column(name) || name == "n_links" {
            return FILL_OR_DELETE.to_owned();
        }
        let leave_out = match sidecar {
            Some(sidecar) => format!("take its line out of {}", sidecar.path.display()),
            None => format!("name only the other columns in a sidecar {}", sidecar_name(path)),
        };
        let instead = match name {
            "temperature" => "; the campaign can give one temperature for all rows in [fluid]",
            "density" | "kinematic_viscosity" => "; the campaign can give one value for all rows in [fluid]",
            _ if name.starts_with("std_") => "; all rows then have the same weight",
            _ if name.starts_with("zero_") => "; then that reading is not subtracted from any row",
            _ => "",
        };
        format!("fill it in, delete the row, or do without the column: {leave_out}{instead}")
    }
}

/// Whether a column is a load, or the motion along or about an axis.
fn is_of_axis(name: &str) -> bool {
    matches!(name, "v_x" | "v_y" | "v_z" | "w_x" | "w_y" | "w_z" | "f_x" | "f_y" | "f_z" | "m_x" | "m_y" | "m_z")
}

/// A finite number in a cell.
pub(crate) fn number(cell: &str, header: &str, place: &dyn Fn() -> Place) -> Result<f64, RecordError> {
    let clip = || cell.chars().take(40).collect::<String>();
    match fast_float2::parse::<f64, _>(cell) {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(RecordError::not_finite(place(), header, &clip())),
        Err(_) => Err(not_a_number(cell, header, place())),
    }
}

/// The error for a cell that is no number.
pub(crate) fn not_a_number(cell: &str, header: &str, place: Place) -> RecordError {
    let found: String = cell.chars().take(40).collect();
    let behind = found.split_once(' ').filter(|(number, _)| number.parse::<f64>().is_ok()).map(|(_, behind)| behind);
    let advice = match behind {
        Some("shown in thousands") => {
            "; the sheet displays its numbers in thousands: give the cells a plain number format, and state the unit of the full numbers in the header"
                .to_owned()
        }
        Some("%") => "; the sheet displays fractions as percentages: give the cells a plain number format, and the header the unit 1".to_owned(),
        Some(unit) if parse_unit(unit).is_ok() => {
            format!("; the unit `{unit}` belongs in the header, once for the whole column")
        }
        Some(word) if word.starts_with(char::is_alphabetic) => {
            format!("; if `{word}` does not change the number, take it out of the cells or of their number format")
        }
        _ => decimal_comma(&found).to_owned(),
    };
    RecordError::column(place, header, format!(": `{found}` is not a number{advice}"))
}

/// Makes the table of what was read, and checks what concerns more than one cell; the sidecar is one that maps columns.
pub(crate) fn assemble(
    path: &Path,
    header: &[String],
    wants: &[Want<'_>],
    raws: Vec<Raw>,
    (sidecar, file): (Option<&Sidecar>, &FileWords),
    header_place: &Place,
    line_of_row: Vec<usize>,
) -> Result<Table, RecordError> {
    let n_rows = line_of_row.len();
    if n_rows == 0 {
        return Err(RecordError::NoRows { path: path.to_owned() });
    }
    let mut table = Table {
        path: path.to_owned(),
        columns: Vec::new(),
        n_rows,
        line_of_row,
        sidecar: sidecar.map(|s| s.path.clone()),
        left_out: header
            .iter()
            .zip(wants)
            .filter(|(_, want)| matches!(want, Want::LeftOut))
            .map(|(header, _)| header.clone())
            .collect(),
        blank: Vec::new(),
        understood: None,
        joined: Vec::new(),
    };
    let notes: Vec<String> = header.iter().zip(wants).filter_map(|(header, want)| want.note(header)).collect();
    table.understood = (!notes.is_empty()).then(|| notes.join(", "));
    for (name, raw) in header.iter().zip(&raws) {
        if let Raw::Numbers(values) = raw {
            refuse_sentinel(values, name, file, &|row| table.place_of_row(row))?;
        }
    }
    match sidecar {
        Some(sidecar) => {
            let mut named: BTreeMap<&str, Raw> = header.iter().map(String::as_str).zip(raws).collect();
            let mut take = |written: &str| named.remove(written);
            table.columns = sidecar.columns(&mut take, &|row| table.place_of_row(row))?;
        }
        None => {
            for (want, raw) in wants.iter().zip(raws) {
                table.columns.extend(column(&table, want, raw, header_place)?);
            }
        }
    }
    table.check()?;
    Ok(table)
}

pub(crate) fn column(
    table: &Table,
    want: &Want<'_>,
    raw: Raw,
    header_place: &Place,
) -> Result<Option<Column>, RecordError> {
    let place = |row: usize| table.place_of_row(row);
    Ok(Some(match (want, raw) {
        (Want::Number { name, unit }, Raw::Numbers(values)) => {
            let si: Vec<f64> = values.iter().map(|v| unit.to_si(*v)).collect();
            check_numbers(&si, &format!("{name} [{unit}]"), &place)?;
            Column {
                name: name.clone(),
                data: ColumnData::Number { dimension: unit.dimension, unit: unit.clone(), si },
            }
        }
        (Want::Number { name, unit }, Raw::Texts(_)) => {
            return Err(RecordError::column(header_place.clone(), &format!("{name} [{unit}]"), TEXT_FOR_NUMBERS));
        }
        (Want::Text { name }, raw) => {
            let cells = match raw {
                Raw::Texts(cells) => cells,
                Raw::Numbers(_) if !may_be_text(name) => {
                    return Err(missing_unit(&table.path, name, header_place));
                }
                Raw::Numbers(values) => values.iter().map(f64::to_string).collect(),
            };
            if may_be_text(name) {
                check_texts(&cells, name, &place)?;
            } else if looks_numeric(cells.iter()) {
                return Err(missing_unit(&table.path, name, header_place));
            }
            Column { name: name.clone(), data: ColumnData::Text(cells.into()) }
        }
        (Want::Mapped(_) | Want::LeftOut, _) => return Ok(None),
    }))
}

/// Rows of a chunk of Parquet.
pub(crate) const CHUNK_ROWS: usize = 1 << 14;
