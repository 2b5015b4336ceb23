//! Observations as the rows of a table: from there on they go the way of every table.

use std::path::Path;

use froude_identify::method::MethodError;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::units::{Dimension, Unit};

use super::point::Point;
use crate::log::TankLog;
use crate::logs::condition;

/// One observation with what it was made at.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The run.
    pub run: String,
    /// What is mounted; empty where there is one configuration.
    pub configuration: String,
    /// Angle of attack, rad.
    pub angle_rad: f64,
    /// Temperature of the water, K, where the run states it.
    pub temperature_k: Option<f64>,
    /// What was observed.
    pub point: Point,
}

impl Row {
    /// What was observed in a log, with what the log says it was made at.
    ///
    /// # Errors
    ///
    /// An angle or a temperature that is none.
    pub(crate) fn of(log: &TankLog, point: Point) -> Result<Self, MethodError> {
        Ok(Self {
            run: log.log.meta.id.clone(),
            configuration: log.log.meta.configuration.clone(),
            angle_rad: angle_rad(log)?,
            temperature_k: condition(log, "temperature", Dimension::TEMPERATURE)?,
            point,
        })
    }
}

/// Angle of attack of a run, rad; none where it states none.
pub(crate) fn angle_rad(log: &TankLog) -> Result<f64, MethodError> {
    Ok(condition(log, "angle", Dimension::ONE)?.unwrap_or(0.0))
}

/// The observations as a table, whose place is the folder of the runs; a load that one row lacks is one that the table does not have.
#[must_use]
pub fn table(folder: &Path, rows: &[Row]) -> Table {
    let text = |name: &str, of: &dyn Fn(&Row) -> String| Column {
        name: name.to_owned(),
        data: ColumnData::Text(rows.iter().map(of).collect()),
    };
    let number = |name: &str, dimension: Dimension, si: Vec<f64>| Column {
        name: name.to_owned(),
        data: ColumnData::Number { dimension, unit: Unit::si(dimension), si },
    };
    let mut columns = vec![text("run", &|row| row.run.clone())];
    if rows.iter().any(|row| !row.configuration.is_empty()) {
        columns.push(text("configuration", &|row| row.configuration.clone()));
    }
    columns.push(number("speed", Dimension::SPEED, rows.iter().map(|row| row.point.speed_m_s).collect()));
    columns.push(number("angle", Dimension::ONE, rows.iter().map(|row| row.angle_rad).collect()));
    if let Some(kelvin) = rows.iter().map(|row| row.temperature_k).collect() {
        columns.push(number("temperature", Dimension::TEMPERATURE, kelvin));
    }
    for load in rows.first().map_or(&[] as &[_], |row| &row.point.loads) {
        let of = |row: &Row| row.point.loads.iter().find(|l| l.name == load.name).map(|l| l.value);
        let dimension = if load.name.starts_with('m') { Dimension::MOMENT } else { Dimension::FORCE };
        if let Some(values) = rows.iter().map(of).collect() {
            columns.push(number(&load.name, dimension, values));
        }
    }
    let n_rows = rows.len();
    Table::of(folder.to_owned(), columns, (1..=n_rows).collect())
}
