//! `keep = "angle <= 39 deg and configuration != H1LT"`: which observations are used.

use std::f64::consts::TAU;

use crate::known_columns::{expected, is_text_column, usual_unit_for};
use crate::plausible;
use crate::units::{Quantity, parse_quantity};

/// Clauses that must all hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Keep {
    /// In the order written.
    pub clauses: Vec<KeepClause>,
}

/// `column comparison value`.
#[derive(Debug, Clone, PartialEq)]
pub struct KeepClause {
    /// Name of the column.
    pub column: String,
    /// How it is compared.
    pub comparison: Comparison,
    /// With what.
    pub value: KeepValue,
}

/// A comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Lt,
    /// `<=`
    Le,
    /// `>`
    Gt,
    /// `>=`
    Ge,
    /// `==`
    Eq,
    /// `!=`
    Ne,
}

/// What a column is compared with.
#[derive(Debug, Clone, PartialEq)]
pub enum KeepValue {
    /// A number with its unit; a bare number is a pure number.
    Quantity(Quantity),
    /// A text, for `configuration`, `setup` and `run`.
    Text(String),
}

/// Why a `keep` cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{clause:?} is not a condition: {problem}; write for example \"angle <= 39 deg and configuration != H1LT\"")]
pub struct KeepError {
    /// The clause as written.
    pub clause: String,
    /// What is wrong.
    pub problem: String,
}

/// Reads the conditions.
///
/// # Errors
///
/// [`KeepError`] names the clause and what is wrong with it.
pub fn parse_keep(text: &str) -> Result<Keep, KeepError> {
    text.split(" and ").map(clause).collect::<Result<_, _>>().map(|clauses| Keep { clauses })
}

fn clause(text: &str) -> Result<KeepClause, KeepError> {
    const COMPARISONS: [(&str, Comparison); 6] = [
        ("<=", Comparison::Le),
        (">=", Comparison::Ge),
        ("==", Comparison::Eq),
        ("!=", Comparison::Ne),
        ("<", Comparison::Lt),
        (">", Comparison::Gt),
    ];
    let refuse = |problem: String| KeepError { clause: text.trim().chars().take(80).collect(), problem };
    let at =
        text.find(['<', '>', '=', '!']).ok_or_else(|| refuse("it has no comparison (< <= > >= == !=)".to_owned()))?;
    let (sign, comparison) = COMPARISONS
        .into_iter()
        .find(|(sign, _)| text[at..].starts_with(sign))
        .ok_or_else(|| refuse("a single = or ! is not a comparison; write == or !=".to_owned()))?;
    let column = text[..at].trim();
    let value = text[at + sign.len()..].trim();
    let is_name = !column.is_empty() && column.chars().all(|c| c.is_alphanumeric() || c == '_');
    if !is_name {
        return Err(refuse(format!("{column:?} is not the name of a column")));
    }
    if value.is_empty() {
        return Err(refuse("there is nothing to compare with".to_owned()));
    }
    if is_text_column(column) {
        if !matches!(comparison, Comparison::Eq | Comparison::Ne) {
            return Err(refuse(format!("{column} is text and can only be compared by == or !=")));
        }
        let value = value.trim_matches(['"', '\'']).to_owned();
        return Ok(KeepClause { column: column.to_owned(), comparison, value: KeepValue::Text(value) });
    }
    let quantity = match value.parse::<f64>() {
        Ok(_) => parse_quantity(&format!("{value} 1")),
        Err(_) => parse_quantity(value),
    };
    let quantity = quantity.map_err(|e| {
        match expected(column) {
            Some((dimension, _)) => {
                refuse(e.expecting(value, dimension, &usual_unit_for(column, dimension)).to_string())
            }
            None if !value.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.')) => refuse(
                "only configuration, setup and run can be compared with a text; to leave out other rows, list their first cells in a sidecar, leave_out = [\"131\"]"
                    .to_owned(),
            ),
            None => refuse(e.to_string()),
        }
    })?;
    // Degrees and radians are both pure numbers: 39 would be 39 rad, which keeps every row.
    if matches!(column, "angle" | "std_angle") && quantity.value != 0.0 && value.parse::<f64>().is_ok() {
        let radians = if quantity.value.abs() <= TAU { format!(" or {value} rad") } else { String::new() };
        return Err(refuse(format!("{value} has no unit; write {value} deg{radians}")));
    }
    if let Some((dimension, words)) = expected(column)
        && dimension != quantity.unit.dimension
    {
        return Err(refuse(format!("{column} is {words}, {value} is {}", quantity.unit.dimension.describe())));
    }
    if let Some(problem) = plausible::problem(column, quantity.value_si, &quantity.unit) {
        return Err(refuse(format!("{value} {problem}")));
    }
    Ok(KeepClause { column: column.to_owned(), comparison, value: KeepValue::Quantity(quantity) })
}
