//! `froude convert`: any readable table or log, written as CSV, Parquet or MCAP.
//!
//! Numbers keep the units of their columns in CSV and Parquet. In MCAP, which has no place for a unit, they are in SI: a topic `/table` of JSON messages, one a
//! row at its `time`, with a schema whose descriptions state the units.

use std::collections::BTreeMap;
use std::io::BufWriter;
use std::path::Path;

use crate::block::{Block, TableBuilder};
use crate::error::{Place, RecordError};
use crate::outcome::{Exit, Outcome};
use crate::run::{Channel, RunLog, read_run};
use crate::sidecar::is_sidecar;
use crate::sidecar_file::sidecar_path;
use crate::table::{Column, ColumnData, Table};
use crate::table_file::{prepare_table, read_table_with_blanks};
use crate::text::counted;
use crate::units::{Dimension, Unit, parse_unit};
use crate::write::Prepared;

/// Reads a table or a log, and writes it in the format that the other name ends in.
///
/// # Errors
///
/// An input that cannot be read, an output of another ending, one that is there already or that a sidecar lies beside, a file that cannot be written.
pub fn convert(input: &Path, sidecar: Option<&Path>, out: &Path) -> Result<Outcome, RecordError> {
    if out.exists() {
        let why = format!("{} is there already, and is not replaced; name another file", out.display());
        return Ok(Outcome { exit: Exit::Refused(why), ..Outcome::default() });
    }
    let beside = out.with_extension("toml");
    if beside.is_file() && is_sidecar(&beside) {
        let why = format!(
            "{} would be read with the sidecar {}, which belongs to another file; choose another output name",
            out.display(),
            beside.display()
        );
        return Ok(Outcome { exit: Exit::Refused(why), ..Outcome::default() });
    }
    let ending = |path: &Path| path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let table = if ending(input) == "mcap" {
        match read_run(input) {
            Ok(run) => of_run(input, run)?,
            Err(RecordError::ForeignLog { .. }) => read_table_with_blanks(input, sidecar)?,
            // What lies beside it describes a table, and no run of Froude.
            Err(_) if sidecar_path(input)?.is_some() => read_table_with_blanks(input, sidecar)?,
            Err(error) => return Err(error),
        }
    } else {
        read_table_with_blanks(input, sidecar)?
    };
    if ending(out) == "mcap" {
        mcap(&table, out)?.take_place()?;
    } else {
        prepare_table(&table, out)?.take_place()?;
    }
    let rows = [out.display().to_string()];
    let t = TableBuilder::new("files", "", &rows);
    let files = t.build(vec![t.text("path", "", Clone::clone)]);
    let columns = counted(table.columns.len(), "column", "columns");
    let left_out = match table.left_out.len() {
        0 => String::new(),
        n => format!(
            "; {}",
            counted(
                n,
                "column that the sidecar does not name was left out",
                "columns that the sidecar does not name were left out"
            )
        ),
    };
    let said = format!("{}: {columns}, {}{left_out}", rows[0], counted(table.n_rows, "row", "rows"));
    let findings = Some(table.findings());
    Ok(Outcome { blocks: vec![files.into(), Block::text("", vec![said])], findings, ..Outcome::default() })
}

/// A run that Froude recorded as a table of its channels.
fn of_run(path: &Path, run: RunLog) -> Result<Table, RecordError> {
    let n_rows = run.time_s.len();
    let number = |name: &str, unit: Unit, values: Vec<f64>| Column {
        name: name.to_owned(),
        data: ColumnData::Number {
            dimension: unit.dimension,
            si: values.iter().map(|x| unit.to_si(*x)).collect(),
            unit,
        },
    };
    let mut columns = vec![number("time", Unit::si(Dimension::TIME), run.time_s)];
    for (name, Channel { meaning, values }) in run.channels {
        let unit = parse_unit(&meaning.unit)
            .map_err(|e| RecordError::syntax(Place::whole(path), format!("channel {name}: {e}")))?;
        columns.push(number(&name, unit, values));
    }
    Ok(Table::of(path.to_owned(), columns, (1..=n_rows).collect()))
}

/// A table with times as a topic of JSON messages.
fn mcap(table: &Table, out: &Path) -> Result<Prepared, RecordError> {
    let times = table.number("time", Dimension::TIME).map_err(|_| {
        let problem = "has no column `time`, and messages of an MCAP file need one; write it as .csv or .parquet";
        RecordError::Refused(format!("{} {problem}", table.path.display()))
    })?;
    let properties: serde_json::Map<String, serde_json::Value> = table
        .columns
        .iter()
        .map(|column| {
            let of = match &column.data {
                ColumnData::Number { dimension, .. } => {
                    serde_json::json!({"type": "number", "description": format!("[{dimension}]")})
                }
                ColumnData::Text(_) => serde_json::json!({"type": "string"}),
            };
            (column.name.clone(), of)
        })
        .collect();
    let schema = serde_json::json!({"type": "object", "properties": properties}).to_string();
    Prepared::new(out, |file| {
        let mut writer = mcap::WriteOptions::new()
            .compression_threads(0)
            .disable_seeking(true)
            .create(mcap::write::NoSeek::new(BufWriter::new(file)))
            .map_err(std::io::Error::other)?;
        let id = writer.add_schema("froude.table", "jsonschema", schema.as_bytes()).map_err(std::io::Error::other)?;
        let channel = writer.add_channel(id, "/table", "json", &BTreeMap::new()).map_err(std::io::Error::other)?;
        for (row, time_s) in times.iter().enumerate() {
            let message = message(table, row).to_string();
            let stamp = ((time_s - times[0]) * 1e9).round().max(0.0) as u64;
            let header = mcap::records::MessageHeader {
                channel_id: channel,
                sequence: row as u32,
                log_time: stamp,
                publish_time: stamp,
            };
            writer.write_to_known_channel(&header, message.as_bytes()).map_err(std::io::Error::other)?;
        }
        writer.finish().map_err(std::io::Error::other)?;
        Ok(())
    })
}

/// A row as an object; a cell that was not measured is left out.
fn message(table: &Table, row: usize) -> serde_json::Value {
    let is_blank = |name: &str| table.blank.iter().any(|(own, at)| own == name && *at == row);
    let cells = table.columns.iter().filter(|column| !is_blank(&column.name)).filter_map(|column| {
        let value = match &column.data {
            ColumnData::Number { si, .. } => serde_json::json!(si.get(row)?),
            ColumnData::Text(texts) => serde_json::json!(texts.get(row)?),
        };
        Some((column.name.clone(), value))
    });
    serde_json::Value::Object(cells.collect())
}
