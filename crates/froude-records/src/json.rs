//! `estimate.json`: read with checks, written whole.

use std::collections::BTreeSet;
use std::path::Path;

use crate::error::{Place, RecordError, read_bytes, utf8};
use crate::estimate::{ESTIMATE_SCHEMA, EstimateFile};
use crate::write::write_atomically;

/// The largest record that is read; a thousand estimates with covariances have a few megabytes.
const LARGEST_BYTES: u64 = 64 << 20;

/// Reads `estimate.json`.
///
/// # Errors
///
/// Not JSON, another or a newer schema, an id twice, a covariance that is not square.
pub fn read_estimates(path: &Path) -> Result<EstimateFile, RecordError> {
    let bytes = read_bytes(path, LARGEST_BYTES, "an estimate record")?;
    parse_estimates(path, utf8(path, &bytes)?)
}

/// The same from text; `path` is for messages.
///
/// # Errors
///
/// As [`read_estimates`].
pub fn parse_estimates(path: &Path, text: &str) -> Result<EstimateFile, RecordError> {
    let at = |e: &serde_json::Error| RecordError::Syntax {
        place: Place::line(path, e.line()),
        problem: format!("not an estimate record: {e}"),
    };
    let value: serde_json::Value = serde_json::from_str(text).map_err(|e| at(&e))?;
    let schema = value.get("schema").and_then(serde_json::Value::as_str);
    check_schema(path, schema)?;
    let file: EstimateFile = serde_json::from_str(text).map_err(|e| at(&e))?;
    let mut ids = BTreeSet::new();
    for estimate in &file.estimates {
        if !ids.insert(&estimate.id) {
            return Err(RecordError::DuplicateId { place: Place::whole(path), id: estimate.id.clone() });
        }
        if let Some(c) = &estimate.covariance
            && (c.matrix.len() != c.names.len() || c.matrix.iter().any(|row| row.len() != c.names.len()))
        {
            return Err(RecordError::Syntax {
                place: Place::whole(path),
                problem: format!(
                    "estimate {}: the covariance names {} coefficients, its matrix is not {} by {}",
                    estimate.id,
                    c.names.len(),
                    c.names.len(),
                    c.names.len()
                ),
            });
        }
    }
    Ok(file)
}

fn check_schema(path: &Path, found: Option<&str>) -> Result<(), RecordError> {
    let place = Place::whole(path);
    let Some(found) = found else {
        return Err(RecordError::Schema { place, found: "missing".to_owned(), known: ESTIMATE_SCHEMA.to_owned() });
    };
    if found == ESTIMATE_SCHEMA {
        return Ok(());
    }
    let newer = found.strip_prefix("froude/estimate/").and_then(|v| v.parse::<u32>().ok()).is_some_and(|v| v > 1);
    if newer {
        return Err(RecordError::NewerSchema { place, found: found.to_owned(), known: ESTIMATE_SCHEMA.to_owned() });
    }
    Err(RecordError::Schema { place, found: format!("{found:?}"), known: ESTIMATE_SCHEMA.to_owned() })
}

/// Writes `estimate.json`, pretty, whole or not at all.
///
/// # Errors
///
/// A number that JSON cannot hold, or a file that cannot be written.
pub fn write_estimates(path: &Path, file: &EstimateFile) -> Result<(), RecordError> {
    check_numbers(path, file)?;
    let mut text = serde_json::to_string_pretty(file)
        .map_err(|e| RecordError::Write { path: path.to_owned(), reason: e.to_string() })?;
    text.push('\n');
    write_atomically(path, text.as_bytes())
}

/// JSON has no NaN; serde would write null, which means "undetermined".
fn check_numbers(path: &Path, file: &EstimateFile) -> Result<(), RecordError> {
    for e in &file.estimates {
        let check = |item: String, value: f64| {
            if value.is_finite() {
                Ok(())
            } else {
                Err(RecordError::NonFinite { path: path.to_owned(), item, value: value.to_string() })
            }
        };
        for (name, c) in &e.coefficients {
            let numbers = [c.value, c.standard_uncertainty, c.type_a, c.type_b, c.effective_dof];
            let ends = c.interval_95.iter().flatten().copied();
            for x in numbers.into_iter().flatten().chain(ends) {
                check(format!("{}, {name}", e.id), x)?;
            }
        }
        for (name, r) in &e.validity {
            check(format!("{}, validity.{name}", e.id), r.low)?;
            check(format!("{}, validity.{name}", e.id), r.high)?;
        }
        for (name, s) in &e.sigma {
            check(format!("{}, sigma.{name}", e.id), s.value)?;
        }
        for (name, d) in &e.dof {
            check(format!("{}, dof.{name}", e.id), d.unwrap_or(0.0))?;
        }
        for row in e.covariance.iter().flat_map(|c| &c.matrix) {
            for x in row {
                check(format!("{}, covariance", e.id), *x)?;
            }
        }
    }
    Ok(())
}
