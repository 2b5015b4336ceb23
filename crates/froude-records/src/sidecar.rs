//! Sidecars: what the columns of a CSV with other headers are.

use std::path::{Path, PathBuf};

use indexmap::IndexMap;

use crate::error::{Place, RecordError};
use crate::file_words::FileWords;
use crate::heading::Heading;
use crate::join_keys::{Join, joins};
use crate::known_columns::{is_text_column, known_dimension};
use crate::measured::Measured;
use crate::nearest::suggestion;
use crate::raw_column::{
    Raw, TEXT_FOR_NUMBERS, check_dimension, check_numbers, check_texts, looks_numeric, unit_for, unit_of_column,
};
use crate::read;
use crate::run::cell::Cell;
use crate::run::channel::Words;
use crate::run::clock_jumps;
use crate::run::declarations::{self, Declarations};
use crate::run::meta::Role;
use crate::run::sensor::{self, Sensor};
use crate::run::sidecar::{configuration, quantities};
use crate::scale::{Scale, Value};
use crate::section::{Section, Source, parse};
use crate::section_values::one_of;
use crate::table::{Column, ColumnData, Table};
use crate::texts::Texts;
use crate::units::{Dimension, Quantity, Unit, parse_unit};

const LARGEST_BYTES: u64 = 1 << 20;

/// What is wrong with a column that the sidecar names as text.
const NUMBERS_WITHOUT_UNIT: &str = " holds numbers and has no unit; write unit = \"…\" beside its name";

/// A sidecar as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Sidecar {
    /// The file.
    pub path: PathBuf,
    /// The tables that it serves, by their names as `run_*.csv`; none where it serves the one of its own name.
    pub files: Option<String>,
    /// A table with a row for each of them: `file`, and what differs from file to file.
    pub list: Option<PathBuf>,
    /// How the file is written.
    pub file: FileWords,
    /// Where the table is the log of a run: what that is.
    pub run: RunFacts,
    /// `[constants]`.
    pub constants: IndexMap<String, Quantity>,
    /// Standard uncertainties of those that state one, as parts.
    pub standards: IndexMap<String, f64>,
    /// `[columns]` in the order written: header in the table → what it is.
    pub columns: IndexMap<String, Mapping>,
    /// Logs with clocks of their own that belong to this one, each with its columns where these are written here.
    pub joins: Vec<(Join, Option<Self>)>,
}

/// What a log states of its run, in the words of a run that Froude recorded.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunFacts {
    /// The method that it belongs to.
    pub method: Option<String>,
    /// What it is for there.
    pub role: Option<Role>,
    /// Which configuration is mounted; empty where nobody said.
    pub configuration: String,
    /// Which way it went, as its list calls it; empty where nobody said.
    pub direction: String,
    /// Which repeat of its setting it is, as its list calls it; empty where nobody said.
    pub repeat: String,
    /// What it was done in.
    pub conditions: IndexMap<String, Measured>,
    /// What is declared of its data beside the channels.
    pub declared: Declarations,
}

/// What one column of the table is.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapping {
    /// Name in Froude.
    pub name: String,
    /// Unit of the numbers in the table; none for text and for scaled columns.
    pub unit: Option<Unit>,
    /// How the unit was read, where that is not what it says.
    pub note: Option<String>,
    /// Factor of sign or direction: the number in the table times it is what the name means.
    pub sign: f64,
    /// What of unit, sign, frame and clock is not written, for methods that take none of them for granted.
    pub undeclared: Vec<&'static str>,
    /// Factor that gives a dimensionless column its dimension.
    pub scale: Option<Scale>,
    /// The number in the table where the quantity is zero, in the unit of the table; it is subtracted first.
    pub offset: f64,
    /// What is stated about its sensor.
    pub sensor: Sensor,
    /// The message about it as a channel of a log.
    pub(crate) words: Words,
    /// Where it stands in the sidecar.
    pub place: Place,
}

/// Whether a `.toml` beside a table is its sidecar, and not a campaign or what is known of a recorded run. One that lacks `[columns]` is one too, so that it is
/// not passed over.
pub(crate) fn is_sidecar(path: &Path) -> bool {
    let Ok(bytes) = read::whole(path, LARGEST_BYTES, "a sidecar") else { return false };
    let text = String::from_utf8_lossy(&bytes);
    let has = |heads: &[&str]| {
        let mut squeezed = text.lines().map(|line| line.split_whitespace().collect::<String>());
        squeezed.any(|line| heads.iter().any(|head| line.starts_with(head)))
    };
    // A campaign may state constants too.
    let is_campaign = has(&CAMPAIGN);
    // Without its last letter, so that [column] is reported as misspelt.
    let has_columns = has(&["[column", "[constant", "[file"]);
    !is_campaign && (has_columns || (has(&["[mounted", "[condition", "role="]) && !has(&["[[", "checksum"])))
}

/// Heads of sections that a campaign has and a sidecar has not.
const CAMPAIGN: [&str; 5] = ["[[source", "[source", "[[identify", "[identify", "[fluid"];

/// Whether a `.toml` is a campaign, or what Froude writes beside a run that it records.
pub(crate) fn is_of_another_kind(path: &Path) -> bool {
    let Ok(bytes) = read::whole(path, LARGEST_BYTES, "a sidecar") else { return true };
    let text = String::from_utf8_lossy(&bytes);
    let mut squeezed = text.lines().map(|line| line.split_whitespace().collect::<String>());
    squeezed.any(|line| CAMPAIGN.iter().chain(&["checksum", "[log"]).any(|head| line.starts_with(head)))
}

/// Reads a sidecar.
///
/// # Errors
///
/// See [`RecordError`].
pub fn read_sidecar(path: &Path) -> Result<Sidecar, RecordError> {
    parse_sidecar(path, &read::text(path, LARGEST_BYTES, "a sidecar")?)
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
    root.only(
        &[
            &[
                "schema",
                "files",
                "list",
                "file",
                "method",
                "role",
                "mounted",
                "conditions",
                "constants",
                "columns",
                "log",
            ],
            &declarations::KEYS[..],
            &clock_jumps::KEYS[..],
        ]
        .concat(),
    )?;
    if let Some(mounted) = root.section("mounted")? {
        mounted.only(&["configuration"])?;
    }
    let run = RunFacts {
        method: root.text("method")?.map(str::to_owned),
        role: one_of(&root, "role", &Role::NAMES, &Role::ALL)?,
        configuration: configuration(&root)?,
        conditions: quantities(&root, "conditions")?,
        declared: Declarations::read(&root)?,
        ..RunFacts::default()
    };
    let (mut constants, mut standards) = (IndexMap::new(), IndexMap::new());
    if let Some(section) = root.section("constants")? {
        for (name, _, value) in section.entries() {
            let (quantity, standard) = constant(&section, name, value)?;
            constants.insert(name.to_owned(), quantity);
            standards.extend(standard.map(|standard| (name.to_owned(), standard)));
        }
    }
    if !standards.is_empty() && run.method.as_deref() != Some(COUNTS_STANDARDS) {
        let problem = "states a standard uncertainty, which logs of method = \"steady\" alone count; write the value, and its error as [[source.uncertainty]] of the column";
        root.refuse("constants", true, problem)?;
    }
    let mut columns = IndexMap::new();
    let advice = "write [columns] with lines like speed_col = { name = \"speed\", unit = \"m/s\" }";
    let file = FileWords::read(&root)?;
    // Where only the file is described, its headers are what they say.
    if file == FileWords::default() || root.get("columns").is_some() {
        columns = mappings(&root.as_section("columns", root.need("columns", advice)?)?, &run.declared.frame_names())?;
    }
    of_a_run(&root, &run, &columns)?;
    if let Some(cell) = &run.declared.cell {
        bridges(&root, cell, &columns)?;
    }
    let files = root.text("files")?.map(str::to_owned);
    let list = root.text("list")?.map(|list| source.relative(list));
    root.refuse(
        "list",
        list.is_some() && files.is_none(),
        "lists tables; name them with files = \"run_*.csv\", for example",
    )?;
    let joined = |(join, section): (Join, Section<'_>)| Ok((join, inline(path, &section)?));
    let joins = joins(&root)?.into_iter().map(joined).collect::<Result<_, RecordError>>()?;
    Ok(Sidecar { path: path.to_owned(), files, list, file, run, constants, standards, columns, joins })
}

/// The method whose budget takes the standard uncertainty of a constant.
const COUNTS_STANDARDS: &str = "steady";

/// A constant, `"4.77 N/V"` or `{ value = "4.77 N/V", standard = "1 %" }`, with its standard uncertainty as a part.
fn constant<'a>(
    s: &Section<'a>,
    name: &str,
    value: &'a crate::section::Value<'a>,
) -> Result<(Quantity, Option<f64>), RecordError> {
    if value.get_ref().as_table().is_none() {
        return Ok((s.as_quantity(name, value)?, None));
    }
    let table = s.as_section(name, value)?;
    table.only(&["value", "standard"])?;
    let advice = "a constant is a quantity, or { value = \"…\", standard = \"…\" }";
    let quantity = table.as_quantity("value", table.need("value", advice)?)?;
    let written = table.need("standard", advice)?;
    let standard = table.as_quantity("standard", written)?;
    let part = if standard.unit.text == "%" { standard.value_si } else { standard.value_si / quantity.value_si.abs() };
    let is_alike = standard.unit.text == "%" || standard.unit.dimension == quantity.unit.dimension;
    let problem = "is not a standard uncertainty: write it in per cent or in the unit of the value, larger than zero";
    table.refuse("standard", !is_alike || !(part > 0.0 && part.is_finite()), problem)?;
    Ok((quantity, Some(part)))
}

/// What is done to the data of a run is done by the methods of runs: a table's is read as it stands.
fn of_a_run(root: &Section<'_>, run: &RunFacts, columns: &IndexMap<String, Mapping>) -> Result<(), RecordError> {
    if run.method.is_some() {
        return Ok(());
    }
    let needs = "is of the log of a run: state what that is with method = \"steady\", role = \"test\", for example; observations of a table are read as they stand";
    for key in declarations::KEYS {
        root.refuse(key, true, needs)?;
    }
    match columns.values().find(|column| !column.sensor.is_silent()) {
        Some(column) => Err(RecordError::value(column.place.clone(), "range, resolution, filter or delay", needs)),
        None => Ok(()),
    }
}

/// Every bridge of a cell is a column, and no load of it is.
fn bridges(root: &Section<'_>, cell: &Cell, columns: &IndexMap<String, Mapping>) -> Result<(), RecordError> {
    let names = || columns.values().map(|column| column.name.as_str());
    if let Some(missing) = cell.columns.iter().find(|bridge| !names().any(|name| name == bridge.as_str())) {
        let near = suggestion(missing, names().collect::<Vec<_>>());
        root.refuse("cell", true, format!("names the bridge {missing:?}, which no column is; {near}"))?;
    }
    match cell.loads.iter().find(|load| names().any(|name| name == load.as_str())) {
        Some(doubled) => {
            let problem = format!("makes the load {doubled}, which is a column too; leave one of them out");
            root.refuse("cell", true, problem)
        }
        None => Ok(()),
    }
}

/// The columns of a log that is joined, where they are written beside it.
fn inline(path: &Path, join: &Section<'_>) -> Result<Option<Sidecar>, RecordError> {
    let Some(columns) = join.section("columns")? else { return Ok(None) };
    Ok(Some(Sidecar {
        path: path.to_owned(),
        files: None,
        list: None,
        file: FileWords::default(),
        run: RunFacts::default(),
        constants: IndexMap::new(),
        standards: IndexMap::new(),
        columns: mappings(&columns, &[])?,
        joins: Vec::new(),
    }))
}

fn mappings(columns: &Section<'_>, frames: &[&str]) -> Result<IndexMap<String, Mapping>, RecordError> {
    let of = |(header, _, value)| Ok((String::from(header), mapping(&columns.as_section(header, value)?, frames)?));
    columns.entries().map(of).collect()
}

fn mapping(section: &Section<'_>, frames: &[&str]) -> Result<Mapping, RecordError> {
    section.only(
        &[&["name", "unit", "sign", "scale", "offset", "quantity", "frame", "clock"], &sensor::KEYS[..]].concat(),
    )?;
    let name = section.need_text("name", "write name = \"f_x\", for example")?.to_owned();
    let place = section.place();
    let (unit, note) = match section.text("unit")? {
        Some(text) => {
            let (unit, note) = unit_for(&name, text)
                .map_err(|e| RecordError::value(place.clone(), "unit", format!("cannot be read: {e}")))?;
            if section.get("scale").is_none() {
                check_dimension(&place, &format!("{name} [{text}]"), &name, &unit)?;
            }
            (Some(unit_of_column(&name, unit)), note)
        }
        None => (None, None),
    };
    let sign = section.number("sign")?.unwrap_or(1.0);
    if sign.abs() != 1.0 {
        let problem = format!("is {sign}; it is 1 or -1, and a factor goes into scale");
        return Err(RecordError::value(place, "sign", problem));
    }
    let scale = section
        .text("scale")?
        .map(|text| {
            Scale::parse(text).map_err(|problem| {
                RecordError::value(place.clone(), "scale", format!("{text:?} cannot be read: {problem}"))
            })
        })
        .transpose()?;
    let offset = match (section.get("offset"), &unit) {
        (None, _) => 0.0,
        (Some(_), Some(unit)) if unit.offset != 0.0 => {
            let problem = format!("is ambiguous for a column in {}; write an absolute unit such as K", unit.text);
            return Err(RecordError::value(place, "offset", problem));
        }
        (Some(_), Some(unit)) => section.quantity("offset", unit.dimension)?.map_or(0.0, |si| si / unit.factor),
        // Without a unit it is in the numbers of the file.
        (Some(_), None) => section.number("offset")?.unwrap_or(0.0),
    };
    for key in ["range", "resolution"] {
        let problem = "is not used of a scaled column; leave it out, or write unit = \"…\" in the place of scale";
        section.refuse(key, scale.is_some(), problem)?;
    }
    let dimension = unit.as_ref().map(|unit| unit.dimension);
    let words = Words::read(section, dimension, frames)?;
    let mut sensor = Sensor::read(section, dimension.filter(|_| scale.is_none()))?;
    // The range is that of the numbers in the file, from which the offset is subtracted.
    let offset_si = offset * unit.as_ref().map_or(1.0, |unit| unit.factor);
    sensor.range = sensor.range.map(|range| range.map(|end| end - offset_si));
    // A scale gives the unit.
    let is_stated = |key: &'static str| section.get(key).is_some() || (key == "unit" && scale.is_some());
    let undeclared = ["unit", "sign", "frame", "clock"].into_iter().filter(|key| !is_stated(key)).collect();
    Ok(Mapping { name, unit, note, sign, undeclared, scale, offset, sensor, words, place })
}

/// Part by which a constant is moved for its effect.
const MOVED: f64 = 1e-6;

impl Mapping {
    /// The same with the unit that the table states, where the sidecar leaves it out.
    fn with_unit_of(&self, heading: Option<&Heading>) -> Result<Self, RecordError> {
        let mut mapping = self.clone();
        if let (Some(own), Some(stated)) = (&self.unit, heading.and_then(|heading| heading.unit.as_deref()))
            && parse_unit(stated).is_ok_and(|stated| (stated.factor, stated.offset) != (own.factor, own.offset))
            && unit_for(&self.name, stated).is_ok_and(|(stated, _)| stated.factor != own.factor)
        {
            let problem =
                format!("is {:?}, and the table states {stated}; leave `unit` out, or correct one of them", own.text);
            return Err(RecordError::value(self.place.clone(), "unit", problem));
        }
        if let (Some(_), None, Some(stated)) =
            (&self.scale, &self.unit, heading.and_then(|heading| heading.unit.as_deref()))
            && parse_unit(stated).is_ok_and(|unit| unit.factor != 1.0)
        {
            let problem = format!(
                "would multiply the numbers as written, but the table states {stated}; add unit = \"{stated}\", so that it multiplies values in that unit"
            );
            return Err(RecordError::value(self.place.clone(), "scale", problem));
        }
        if self.unit.is_some() || self.scale.is_some() || is_text_column(&self.name) {
            return Ok(mapping);
        }
        match heading.and_then(|heading| heading.unit.as_deref()) {
            Some(text) => {
                let column = format!("{} [{text}]", self.name);
                let (unit, note) = unit_for(&self.name, text)
                    .map_err(|e| RecordError::column(self.place.clone(), &column, format!(": {e}")))?;
                check_dimension(&self.place, &column, &self.name, &unit)?;
                (mapping.unit, mapping.note) = (Some(unit_of_column(&self.name, unit)), note);
                mapping.undeclared.retain(|key| *key != "unit");
                Ok(mapping)
            }
            None if known_dimension(&self.name).is_some() => {
                let problem =
                    " has no unit; write unit = \"…\" beside its name, or scale = \"…\" for a dimensionless column";
                Err(RecordError::column(self.place.clone(), &self.name, problem))
            }
            None => Ok(mapping),
        }
    }
}

impl Sidecar {
    /// The sidecar of a table with these headings: columns may be named with or without their units, and take the units that the table states.
    pub(crate) fn fitted(&self, headings: &[Heading]) -> Result<Self, RecordError> {
        let of = |(written, mapping): (&String, &Mapping)| {
            let is = |heading: &&Heading| [&heading.written, &heading.name].contains(&written);
            let exact = headings.iter().find(|heading| heading.header() == *written);
            let mut named = headings.iter().filter(is);
            let heading = exact.or_else(|| named.next());
            if let (None, Some(other)) = (exact, named.next()) {
                let first = heading.map_or_else(String::new, Heading::header);
                let problem =
                    format!(": both `{first}` and `{}` are called so; write the whole header", other.header());
                return Err(RecordError::column(mapping.place.clone(), written, problem));
            }
            let header = heading.map_or_else(|| written.clone(), Heading::header);
            Ok((header, mapping.with_unit_of(heading)?))
        };
        Ok(Self { columns: self.columns.iter().map(of).collect::<Result<_, _>>()?, ..self.clone() })
    }

    /// The mapped columns of a table, in the order of the sidecar; columns that it does not name are left out.
    ///
    /// Columns with a unit come first, then those with a scale in the order written, so that a
    /// scale may name every column with a unit and every scaled one above it.
    pub(crate) fn columns(
        &self,
        take: &mut dyn FnMut(&str) -> Option<Raw>,
        place: &dyn Fn(usize) -> Place,
    ) -> Result<Vec<Column>, RecordError> {
        let mut done: Vec<(usize, Column)> = Vec::new();
        let is_scaled = |mapping: &Mapping| mapping.scale.is_some();
        let plain = self.columns.iter().enumerate().filter(|(_, (_, m))| !is_scaled(m));
        let scaled = self.columns.iter().enumerate().filter(|(_, (_, m))| is_scaled(m));
        for (order, (written, mapping)) in plain.chain(scaled) {
            let Some(raw) = take(written) else { continue };
            let data = self.data(written, mapping, raw, &done, place)?;
            done.push((order, Column { name: mapping.name.clone(), data }));
        }
        done.sort_by_key(|(order, _)| *order);
        Ok(done.into_iter().map(|(_, column)| column).collect())
    }

    fn data(
        &self,
        written: &str,
        mapping: &Mapping,
        raw: Raw,
        done: &[(usize, Column)],
        place: &dyn Fn(usize) -> Place,
    ) -> Result<ColumnData, RecordError> {
        let values = match (raw, mapping.unit.is_some() || mapping.scale.is_some()) {
            (Raw::Numbers(values), true) => values,
            (Raw::Numbers(_), false) if !is_text_column(&mapping.name) && mapping.name != "repeat" => {
                return Err(RecordError::column(mapping.place.clone(), written, NUMBERS_WITHOUT_UNIT));
            }
            (Raw::Numbers(values), false) => {
                return Ok(ColumnData::Text(values.iter().map(f64::to_string).collect()));
            }
            (Raw::Texts(cells), false) => {
                if is_text_column(&mapping.name) {
                    check_texts(&cells, written, place)?;
                } else if mapping.name != "repeat" && looks_numeric(cells.iter()) {
                    return Err(RecordError::column(mapping.place.clone(), written, NUMBERS_WITHOUT_UNIT));
                }
                return Ok(ColumnData::Text(cells.into()));
            }
            (Raw::Texts(_), true) => {
                return Err(RecordError::column(mapping.place.clone(), written, TEXT_FOR_NUMBERS));
            }
        };
        let values: Vec<f64> = values.iter().map(|v| v - mapping.offset).collect();
        let data = match (&mapping.scale, &mapping.unit) {
            (None, Some(unit)) => ColumnData::Number {
                dimension: unit.dimension,
                si: values.iter().map(|v| mapping.sign * unit.to_si(*v)).collect(),
                unit: unit.clone(),
            },
            (Some(scale), unit) => {
                let number = unit.as_ref().map_or(Value { si: 1.0, dimension: Dimension::ONE }, |unit| Value {
                    si: unit.factor,
                    dimension: unit.dimension,
                });
                self.scaled(mapping, scale, number, &values, done)?
            }
            (None, None) => ColumnData::Text(Texts::default()),
        };
        if let ColumnData::Number { si, .. } = &data {
            check_numbers(si, written, place)?;
        }
        Ok(data)
    }

    /// What the uncertain constants make of a scaled column of a table: each with its standard error as a part of the column, the largest of its first,
    /// middle and last row.
    pub(crate) fn scale_errors(&self, mapping: &Mapping, table: &Table) -> Vec<(String, f64)> {
        let Some(scale) = &mapping.scale else { return Vec::new() };
        let at = |row: usize, moved: Option<&str>| {
            let name = |name: &str| {
                let constant = self.constants.get(name).map(|q| {
                    let by = if moved == Some(name) { 1.0 + MOVED } else { 1.0 };
                    Value { si: by * q.value_si, dimension: q.unit.dimension }
                });
                let column = || match &table.columns.iter().find(|column| column.name == name)?.data {
                    ColumnData::Number { si, dimension, .. } => {
                        Some(Value { si: *si.get(row)?, dimension: *dimension })
                    }
                    ColumnData::Text(_) => None,
                };
                constant.or_else(column)
            };
            scale.evaluate(&name).map_or(f64::NAN, |value| value.si)
        };
        let rows = [0, table.n_rows / 2, table.n_rows.saturating_sub(1)];
        let part = |name: &str| {
            let of = |row: &usize| (at(*row, Some(name)) / at(*row, None) - 1.0).abs() / MOVED;
            rows.iter().map(of).fold(0.0, f64::max)
        };
        let errors = self.standards.iter().map(|(name, standard)| (name.clone(), standard * part(name)));
        errors.filter(|(_, part)| *part > 0.0).collect()
    }

    /// value · scale, over the constants and the columns that are done.
    fn scaled(
        &self,
        mapping: &Mapping,
        scale: &Scale,
        number: Value,
        values: &[f64],
        done: &[(usize, Column)],
    ) -> Result<ColumnData, RecordError> {
        let refuse = |problem: String| {
            RecordError::value(mapping.place.clone(), "scale", format!("{:?}: {problem}", scale.text()))
        };
        let mut si = Vec::with_capacity(values.len());
        let mut dimension = None;
        for (row, value) in values.iter().enumerate() {
            let name = |name: &str| {
                if let Some(q) = self.constants.get(name) {
                    return Some(Value { si: q.value_si, dimension: q.unit.dimension });
                }
                done.iter().find(|(_, c)| c.name == name).and_then(|(_, c)| match &c.data {
                    ColumnData::Number { si, dimension, .. } => {
                        Some(Value { si: *si.get(row)?, dimension: *dimension })
                    }
                    ColumnData::Text(_) => None,
                })
            };
            let scale = scale.evaluate(&name).map_err(refuse)?;
            if !scale.si.is_finite() {
                return Err(refuse(format!("is not finite in row {}", row + 1)));
            }
            dimension = scale.dimension.checked_mul(number.dimension);
            si.push(mapping.sign * value * number.si * scale.si);
        }
        let unit = Unit::si(dimension.unwrap_or(Dimension::ONE));
        let header = format!("{} [{unit}]", mapping.name);
        check_dimension(&mapping.place, &header, &mapping.name, &unit)?;
        Ok(ColumnData::Number { dimension: unit.dimension, unit, si })
    }
}
