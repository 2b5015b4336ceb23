//! The observations as they were fitted, row by row, for a spreadsheet or another program.
//!
//! After zeros, tare and `keep`: motion, loads and water; Reynolds, Froude and the other numbers of similarity of that row;
//! what the recommended model gives, the residual, and the leverage of the row in each load.

use std::path::Path;

use froude_records::campaign::Campaign;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::text::in_a_file_name;
use froude_records::units::{Dimension, Unit, parse_unit, question};

use crate::answer::Answer;
use crate::error::IdentifyError;
use crate::result::SourceResult;
use crate::validity;

/// One table per fitted source, each with a file name of its own.
///
/// # Errors
///
/// A channel that the model needs and the data lack: not after a fit.
pub fn tables(sources: &[Answer], campaign: &Campaign) -> Result<Vec<Table>, IdentifyError> {
    let mut out: Vec<Table> = Vec::new();
    for source in sources.iter().filter_map(Answer::fitted) {
        let mut table = table(source, campaign)?;
        // "day 1" and "day-1" are two sources and one file name, and "Day 1" is the same one to some disks.
        let same = |name: &Path| name.to_string_lossy().to_lowercase();
        let stem = table.path.with_extension("");
        for k in 2.. {
            if out.iter().all(|t| same(&t.path) != same(&table.path)) {
                break;
            }
            table.path = format!("{}-{k}.csv", stem.display()).into();
        }
        out.push(table);
    }
    Ok(out)
}

/// The table of one source.
fn table(source: &SourceResult, campaign: &Campaign) -> Result<Table, IdentifyError> {
    let data = &source.data;
    let mut columns = vec![number("line", &data.line.iter().map(|&l| l as f64).collect::<Vec<_>>(), Unit::one())];
    columns.extend(data.named_columns());
    for (name, channel) in &data.channels {
        let unit = match name.as_str() {
            "angle" => parse_unit("deg").unwrap_or_else(|_| Unit::si(channel.dimension)),
            _ => unit_of(name, channel.dimension),
        };
        // Zeros are subtracted: beside the corrected loads they would be subtracted again.
        if !name.starts_with("zero_") && !columns.iter().any(|c| &c.name == name) {
            columns.push(number(name, &channel.values, unit));
        }
    }
    for (name, values) in validity::per_observation(data, campaign) {
        columns.retain(|c| c.name != name);
        columns.push(number(name, &values, Unit::one()));
    }
    if let Some(values) = validity::drag_coefficient(data, campaign) {
        columns.push(number("C_D", &values, Unit::one()));
    }
    if let Some(model) = source.recommendation.as_ref().and_then(|r| source.models.get(r.index)) {
        let fitted = model.law.predict(data, model.law_coefficients())?;
        for (r, load) in model.law.responses.iter().enumerate() {
            let rows = r * data.rows..(r + 1) * data.rows;
            let unit = || Unit::si(data.dimension(load).unwrap_or(Dimension::FORCE));
            let measured = data.values(load).unwrap_or_default();
            // With an angle offset the fit compares loads that are turned into the body's axes.
            let is_turned = model.specs.len() > model.law.coefficients.len();
            let residual: Vec<f64> = if is_turned {
                model.fit.residuals[rows.clone()].to_vec()
            } else {
                measured.iter().zip(&fitted[rows.clone()]).map(|(m, f)| m - f).collect()
            };
            columns.push(number(&format!("{load}_{}", model.law.name), &fitted[rows.clone()], unit()));
            columns.push(number(&format!("{load}_residual"), &residual, unit()));
            columns.push(number(&format!("{load}_leverage"), &model.fit.leverage[rows], Unit::one()));
        }
    }
    let not_measured = data.observed.iter().flat_map(|(load, is)| {
        // A reading at rest that is left out of σ was measured.
        let rows = (0..data.rows).filter(|&i| !is[i] && data.values(load).is_some_and(|f| f[i] == 0.0));
        rows.flat_map(move |i| [(load.clone(), i), (format!("{load}_residual"), i)])
    });
    let blank = not_measured.collect();
    // What does not exist in a row (the power law at rest has no logarithm) leaves its column out.
    columns.retain(|c| match &c.data {
        ColumnData::Number { si, .. } => si.iter().all(|x| x.is_finite()),
        ColumnData::Text(_) => true,
    });
    Ok(Table { blank, n_rows: data.rows, ..Table::of(file_name(&source.name).into(), columns, data.line.clone()) })
}

/// `observations-` and the source's name.
fn file_name(source: &str) -> String {
    // The source of a bare table is named after its file.
    let stem = source.trim_end_matches(".csv").trim_end_matches(".parquet");
    format!("observations-{}.csv", in_a_file_name(stem))
}

/// The SI unit of a column, in words that its own name does not make ambiguous.
fn unit_of(name: &str, dimension: Dimension) -> Unit {
    let si = Unit::si(dimension);
    match question(name, &si) {
        Some(_) => parse_unit("rad/s").unwrap_or(si),
        None => si,
    }
}

fn number(name: &str, si: &[f64], unit: Unit) -> Column {
    Column { name: name.to_owned(), data: ColumnData::Number { dimension: unit.dimension, unit, si: si.to_vec() } }
}
