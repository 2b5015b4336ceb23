//! A column as it is read, before its unit is known.

use froude_foreign::layout::is_missing;
use froude_foreign::marks::shape;

use crate::error::{Place, RecordError, briefly};
use crate::known_columns::{expected, known_dimension, usual_unit};
use crate::units::{Dimension, Unit, UnitError, foreign_part, is_plausible, parse_unit, parse_unit_for, question};

/// The cells of one column as the format gives them.
pub(crate) enum Raw {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

/// What is wrong with the unit of a column, with suggestions of the kind that a known name has.
pub(crate) fn in_light_of(name: &str, text: &str, error: UnitError) -> UnitError {
    match (known_dimension(name), usual_unit(name)) {
        (Some(dimension), Some(usual)) => error.expecting(text, dimension, &usual),
        _ => error,
    }
}

/// The unit of a column, in light of what a known name measures, with what is to be said of how it was read.
pub(crate) fn unit_for(name: &str, text: &str) -> Result<(Unit, Option<String>), UnitError> {
    match known_dimension(name) {
        // Other dimensions are refused with the column.
        Some(dimension) if dimension != Dimension::ONE => match parse_unit_for(text, dimension) {
            Ok((unit, note)) => Ok((unit, note)),
            Err(UnitError::Other(_)) if parse_unit(text).is_ok() && !is_asked(text, dimension) => {
                parse_unit(text).map(|unit| (unit, None))
            }
            Err(error) => Err(in_light_of(name, text, error)),
        },
        _ => parse_unit(text).map(|unit| (unit, None)).map_err(|error| in_light_of(name, text, error)),
    }
}

/// Whether a unit of another dimension may be a slip for one of this, so that the message lists what to write.
fn is_asked(text: &str, dimension: Dimension) -> bool {
    parse_unit_for(text, dimension).is_err_and(|error| error.to_string().contains("; write "))
}

/// A standard uncertainty in `degC` is one in K: differences have no offset.
pub(crate) fn unit_of_column(name: &str, unit: Unit) -> Unit {
    if name.starts_with("std_") { Unit { offset: 0.0, ..unit } } else { unit }
}

/// A known name with another dimension is an error, and so is a unit that is read in two ways under this name.
pub(crate) fn check_dimension(place: &Place, header: &str, name: &str, unit: &Unit) -> Result<(), RecordError> {
    // Other lengths of time have names of their own; this one is read as the clock wherever there is one.
    if name == "time" && unit.dimension != Dimension::TIME {
        let [expected, found] = [Dimension::TIME, unit.dimension].map(Dimension::describe);
        return Err(RecordError::wrong_dimension(place.clone(), header, &expected, &found));
    }
    match expected(name) {
        Some((dimension, words)) if dimension != unit.dimension => {
            Err(RecordError::wrong_dimension(place.clone(), header, &words, &unit.dimension.describe()))
        }
        Some((dimension, words)) if foreign_part(&unit.text, dimension).is_some() => {
            let part = foreign_part(&unit.text, dimension).unwrap_or_default();
            let problem =
                format!(": `{}` has {part} in it, as a slope or a calibration has; expected {words}", unit.text);
            Err(RecordError::column(place.clone(), header, problem))
        }
        _ => match question(name, unit) {
            Some(question) => Err(RecordError::column(place.clone(), header, format!(": {question}"))),
            None => Ok(()),
        },
    }
}

/// Refuses numbers that no test has; `place` is that of a row.
pub(crate) fn check_numbers(si: &[f64], header: &str, place: &dyn Fn(usize) -> Place) -> Result<(), RecordError> {
    match si.iter().position(|v| !is_plausible(*v)) {
        Some(row) => Err(RecordError::not_finite(place(row), header, &briefly(si[row]))),
        None => Ok(()),
    }
}

/// Whether most cells that say something are numbers, however they are written.
pub(crate) fn looks_numeric<'c>(cells: impl Iterator<Item = &'c String>) -> bool {
    let filled = cells.filter(|cell| !is_missing(cell.trim()));
    let (all, numbers) =
        filled.fold((0_usize, 0_usize), |(all, numbers), cell| (all + 1, numbers + usize::from(shape(cell).is_some())));
    numbers > 0 && 2 * numbers >= all
}

/// Refuses empty cells; `place` is that of a row.
pub(crate) fn check_texts(cells: &[String], header: &str, place: &dyn Fn(usize) -> Place) -> Result<(), RecordError> {
    match cells.iter().position(String::is_empty) {
        Some(row) => Err(RecordError::empty_cell(place(row), header, FILL_OR_DELETE)),
        None => Ok(()),
    }
}

/// What to do about an empty cell of a column that is needed.
pub(crate) const FILL_OR_DELETE: &str = "fill it in or delete the row";

/// What is wrong with the second column of a name.
pub(crate) const TWICE: &str = " appears twice; rename or delete one";

/// What is wrong with a column of text where numbers are needed.
pub(crate) const TEXT_FOR_NUMBERS: &str = " holds text; expected numbers";
