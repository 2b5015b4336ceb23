//! `estimate.json`: read with checks, written whole.
//!
//! JSON has no NaN, and `null` means "undetermined" here: a number that is not finite
//! is therefore an error when writing, never a silent null. Numbers read back to the
//! bits that were written. Every record that is written carries a checksum of what it says.

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

use indexmap::IndexMap;
use serde::de::{Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde::ser::{Error as _, Serializer};
use serde::{Deserialize, Serialize};

use crate::checksum;
use crate::comparison::Comparison;
use crate::error::{Place, RecordError};
use crate::estimate::{
    BadUnit, Coefficient, DataFile, Derived, Diagnostics, ESTIMATE_SCHEMA, Estimate, EstimateFile, Interval, Law,
    NamedCorrelation, RunScatter, SharedError, Status, TypeA, to_si, v1,
};
use crate::finding::Finding;
use crate::hash::sha256_of_file;
use crate::read;
use crate::write::write_atomically;

/// The largest record that is read; a thousand estimates with covariances have a few megabytes.
const LARGEST_BYTES: u64 = 64 << 20;

/// Longest name and unit, in bytes: they are printed in tables.
const LONGEST_NAME: usize = 1000;

/// Newest major version that is read.
const NEWEST: u64 = 2;

/// Reads `estimate.json`.
///
/// # Errors
///
/// Not JSON, another or a newer schema, a key or an id twice, a covariance that is not
/// square, a negative uncertainty, a value where the status says undetermined; [`RecordError::Checksum`] where the content is not
/// the one that its checksum was written for; a unit that cannot be read or does not fit. All numbers are in SI when they are returned. A record without a checksum is read as it is.
pub fn read_estimates(path: &Path) -> Result<EstimateFile, RecordError> {
    parse_estimates(path, &read::text(path, LARGEST_BYTES, "an estimate record")?)
}

/// The same from text; `path` is for messages.
///
/// # Errors
///
/// As [`read_estimates`].
pub fn parse_estimates(path: &Path, text: &str) -> Result<EstimateFile, RecordError> {
    // Keys first: to the typed reader a key that appears twice is simply overwritten.
    serde_json::from_str::<UniqueKeys>(text).map_err(|e| syntax(path, text, &e))?;
    let head: Head = serde_json::from_str(text).map_err(|e| syntax(path, text, &e))?;
    check_schema(path, text, head.schema.as_ref())?;
    if let Some(sum) = &head.checksum {
        check_sum(path, text, sum)?;
    }
    let mut file = if head.schema.as_ref().and_then(|s| s.as_str()) == Some(v1::SCHEMA) {
        EstimateFile::from(serde_json::from_str::<v1::FileV1>(text).map_err(|e| syntax(path, text, &e))?)
    } else {
        serde_json::from_str(text).map_err(|e| syntax(path, text, &e))?
    };
    check(path, text, &file)?;
    to_si(&mut file).map_err(|bad| bad_unit(path, text, &bad))?;
    Ok(file)
}

/// A line of the record, or the whole of it where the line is not known.
fn place_of(path: &Path, line: Option<usize>) -> Place {
    line.map_or_else(|| Place::whole(path), |line| Place::line(path, line))
}

/// A unit that is rejected, with its line where the text shows it.
fn bad_unit(path: &Path, text: &str, bad: &BadUnit) -> RecordError {
    let BadUnit { estimate, path: keys, unit, problem } = bad;
    // A law's inputs hold the unit itself, all others an object with a unit.
    let key = keys.last().map_or("unit", String::as_str);
    let from = line_of(text, key, None, 0).unwrap_or(1);
    let written = serde_json::Value::from(unit.as_str()).to_string();
    let line = text.lines().enumerate().skip(from - 1).find(|(_, line)| line.contains(&written)).map(|(at, _)| at + 1);
    let whose = estimate.as_ref().map_or_else(String::new, |id| format!("estimate {id}: "));
    let problem = format!("{whose}the unit of {} is rejected: {problem}", keys.join("."));
    RecordError::syntax(place_of(path, line), problem)
}

impl DataFile {
    /// A file with its fingerprint, named as `named`.
    ///
    /// # Errors
    ///
    /// [`RecordError::Read`] when the file cannot be read.
    pub fn of(path: &Path, named: &str) -> Result<Self, RecordError> {
        Ok(Self { path: named.to_owned(), sha256: sha256_of_file(path)?, ..Self::default() })
    }
}

#[derive(Deserialize)]
struct Head {
    schema: Option<serde_json::Value>,
    checksum: Option<serde_json::Value>,
}

/// The record as it is written: with the checksum of all else that it says. It stands in the second line, so that deleting it
/// leaves JSON.
#[derive(Serialize)]
struct Summed<'a> {
    schema: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    checksum: Option<String>,
    data: &'a IndexMap<String, DataFile>,
    versions: &'a IndexMap<String, String>,
    estimates: &'a [Estimate],
    #[serde(skip_serializing_if = "Option::is_none")]
    comparison: Option<&'a Comparison>,
    findings: &'a [Finding],
}

impl Serialize for EstimateFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { schema, data, versions, estimates, comparison, findings } = self;
        let comparison = comparison.as_ref();
        let mut record = Summed { schema, checksum: None, data, versions, estimates, comparison, findings };
        let content = serde_json::to_value(&record).map_err(S::Error::custom)?;
        record.checksum = Some(checksum::of_json(&content));
        record.serialize(serializer)
    }
}

/// Holds the record against its own checksum.
fn check_sum(path: &Path, text: &str, said: &serde_json::Value) -> Result<(), RecordError> {
    let content: serde_json::Value = serde_json::from_str(text).map_err(|e| syntax(path, text, &e))?;
    if said.as_str() == Some(checksum::of_json(&content).as_str()) {
        return Ok(());
    }
    Err(RecordError::Checksum { place: place_of(path, line_of(text, checksum::KEY, None, 0)) })
}

/// Any JSON value whose objects have no key twice.
struct UniqueKeys;

impl<'de> Deserialize<'de> for UniqueKeys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Walk)
    }
}

struct Walk;

impl<'de> Visitor<'de> for Walk {
    type Value = UniqueKeys;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, _: bool) -> Result<UniqueKeys, E> {
        Ok(UniqueKeys)
    }

    fn visit_i64<E>(self, _: i64) -> Result<UniqueKeys, E> {
        Ok(UniqueKeys)
    }

    fn visit_u64<E>(self, _: u64) -> Result<UniqueKeys, E> {
        Ok(UniqueKeys)
    }

    fn visit_f64<E>(self, _: f64) -> Result<UniqueKeys, E> {
        Ok(UniqueKeys)
    }

    fn visit_str<E>(self, _: &str) -> Result<UniqueKeys, E> {
        Ok(UniqueKeys)
    }

    fn visit_unit<E>(self) -> Result<UniqueKeys, E> {
        Ok(UniqueKeys)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<UniqueKeys, A::Error> {
        while list.next_element::<UniqueKeys>()?.is_some() {}
        Ok(UniqueKeys)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<UniqueKeys, A::Error> {
        let mut keys = BTreeSet::new();
        while let Some(key) = map.next_key::<String>()? {
            if keys.contains(&key) {
                return Err(A::Error::custom(format!("the key `{key}` appears twice")));
            }
            map.next_value::<UniqueKeys>()?;
            keys.insert(key);
        }
        Ok(UniqueKeys)
    }
}

/// serde's error with its place, and with a hint where people write NaN.
fn syntax(path: &Path, text: &str, error: &serde_json::Error) -> RecordError {
    let line = error.line();
    let full = error.to_string();
    let words = full.rfind(" at line ").map_or(full.as_str(), |at| &full[..at]);
    let written = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
    let has_nan = error.is_syntax() && ["NaN", "nan", "Infinity", "inf"].iter().any(|w| written.contains(w));
    let hint = if has_nan { "; JSON has no NaN and no Infinity: an undetermined number is null" } else { "" };
    let place = place_of(path, Some(line).filter(|line| *line > 0));
    RecordError::syntax(place, format!("not an estimate record: {words}{hint}"))
}

fn check_schema(path: &Path, text: &str, found: Option<&serde_json::Value>) -> Result<(), RecordError> {
    let place = place_of(path, line_of(text, "schema", None, 0));
    let known = ESTIMATE_SCHEMA.to_owned();
    let Some(found) = found else {
        return Err(RecordError::value(Place::whole(path), "schema", format!("is missing; expected {known}")));
    };
    if [ESTIMATE_SCHEMA, v1::SCHEMA].map(Some).contains(&found.as_str()) {
        return Ok(());
    }
    let version = found.as_str().and_then(|s| s.strip_prefix("froude/estimate/")).and_then(|v| v.parse::<u64>().ok());
    match (version, found.as_str()) {
        (Some(version), Some(found)) if version > NEWEST => {
            Err(RecordError::NewerSchema { place, found: found.to_owned(), known })
        }
        _ => {
            let found: String = found.to_string().chars().take(80).collect();
            Err(RecordError::value(place, "schema", format!("is {found}; expected {known}")))
        }
    }
}

/// Line of the nth (from 0) `"key": "value"` in a JSON text; any value where `value` is `None`.
fn line_of(text: &str, key: &str, value: Option<&str>, nth: usize) -> Option<usize> {
    let key = format!("\"{key}\"");
    let value = value.map(|v| serde_json::Value::from(v).to_string());
    text.match_indices(&key)
        .filter(|(at, _)| {
            let after = text[at + key.len()..].trim_start().strip_prefix(':').map(str::trim_start);
            after.is_some_and(|after| value.as_ref().is_none_or(|v| after.starts_with(v.as_str())))
        })
        .nth(nth)
        .map(|(at, _)| 1 + memchr::memchr_iter(b'\n', &text.as_bytes()[..at]).count())
}

fn id_twice(place: Place, id: &str) -> RecordError {
    RecordError::syntax(place, format!("the id `{id}` appears twice; every estimate needs its own"))
}

/// What the types cannot say.
fn check(path: &Path, text: &str, file: &EstimateFile) -> Result<(), RecordError> {
    let mut ids = BTreeSet::new();
    let mut recommended = BTreeSet::new();
    for estimate in &file.estimates {
        let place = |nth| place_of(path, line_of(text, "id", Some(&estimate.id), nth));
        if !ids.insert(estimate.id.as_str()) {
            return Err(id_twice(place(1), &estimate.id));
        }
        let refuse =
            |problem: String| Err(RecordError::syntax(place(0), format!("estimate {}: {problem}", estimate.id)));
        let names = [("id", &estimate.id), ("source", &estimate.source), ("law", &estimate.law.name)].into_iter();
        let texts = estimate.coefficients.iter().flat_map(|(name, c)| [("name", name), ("unit", &c.unit)]);
        if let Some((what, long)) = names.chain(texts).find(|(_, text)| text.len() > LONGEST_NAME) {
            let problem = format!("a {what} has {} bytes; at most {LONGEST_NAME} are read", long.len());
            return Err(RecordError::syntax(Place::whole(path), problem));
        }
        if estimate.recommended && !recommended.insert(estimate.source.as_str()) {
            return refuse(format!("it is the second of source {:?} to be recommended; one is", estimate.source));
        }
        for (name, coefficient) in &estimate.coefficients {
            if let Some(problem) = contradiction(coefficient) {
                return refuse(format!("coefficient {name} {problem}"));
            }
        }
        if let Some(problem) = shape(file, estimate) {
            return refuse(problem);
        }
    }
    Ok(())
}

/// What does not fit together in the covariance, the other errors and the data of an estimate.
fn shape(file: &EstimateFile, estimate: &Estimate) -> Option<String> {
    let is = |rows: &[Vec<f64>], n: usize, q: usize| rows.len() == n && rows.iter().all(|row| row.len() == q);
    if let Some(key) = estimate.data.iter().find(|key| !file.data.contains_key(*key)) {
        return Some(format!("its data names {key}, which is not a file of the record"));
    }
    let Some(TypeA { names, matrix, dof, kind: _ }) = &estimate.type_a else {
        let first = estimate.errors.keys().next()?;
        return Some(format!("the error {first} has a sensitivity, and no covariance names its rows"));
    };
    let n = names.len();
    if !is(matrix, n, n) {
        return Some(format!("the covariance names {n} coefficients, its matrix is not {n} by {n}"));
    }
    if let Some(name) = names.iter().find(|name| !estimate.coefficients.contains_key(*name)) {
        return Some(format!("the covariance names {name}, which is not one of its coefficients"));
    }
    if dof.len() != n {
        return Some(format!("the covariance names {n} coefficients, {} have degrees of freedom", dof.len()));
    }
    estimate.errors.iter().find_map(|(key, error)| {
        let q = error.covariance.len();
        if !is(&error.covariance, q, q) {
            return Some(format!("the covariance of the error {key} is not {q} by {q}"));
        }
        let fits = is(&error.sensitivity, n, q);
        (!fits).then(|| {
            format!("the sensitivity to the error {key} is not {n} by {q}: a row per coefficient of the covariance")
        })
    })
}

fn contradiction(c: &Coefficient) -> Option<String> {
    if c.status == Status::Undetermined && c.value.is_some() {
        return Some("is undetermined and has a value; write null".to_owned());
    }
    let uncertainties = [("standard_uncertainty", c.standard_uncertainty), ("type_a", c.type_a), ("type_b", c.type_b)];
    for (key, value) in uncertainties {
        if let Some(value) = value.filter(|v| *v < 0.0) {
            return Some(format!("has {key} {value}; an uncertainty is not negative"));
        }
    }
    match c.interval_95 {
        Some([low, high]) if low > high => Some(format!("has the interval [{low}, {high}]; its ends are exchanged")),
        _ => None,
    }
}

/// Writes `estimate.json`, pretty, whole or not at all.
///
/// # Errors
///
/// A number that JSON cannot hold, an id twice, or a file that cannot be written.
pub fn write_estimates(path: &Path, file: &EstimateFile) -> Result<(), RecordError> {
    let mut ids = BTreeSet::new();
    for estimate in &file.estimates {
        if !ids.insert(estimate.id.as_str()) {
            return Err(id_twice(Place::whole(path), &estimate.id));
        }
        let bad = numbers(estimate).into_iter().find(|(_, value)| !value.is_finite());
        if let Some((item, value)) = bad {
            return Err(RecordError::NonFinite {
                path: path.to_owned(),
                item: format!("{}, {item}", estimate.id),
                value: value.to_string(),
            });
        }
    }
    let mut text = serde_json::to_string_pretty(file)
        .map_err(|e| RecordError::Write { path: path.to_owned(), reason: e.to_string() })?;
    text.push('\n');
    write_atomically(path, text.as_bytes())
}

/// Every number of an estimate with its path. The patterns name all fields, so that a new
/// one cannot be forgotten here.
fn numbers(estimate: &Estimate) -> Vec<(String, f64)> {
    let mut out = Vec::new();
    let Estimate {
        id: _,
        source: _,
        kind: _,
        method: _,
        frame: _,
        point: _,
        signs: _,
        attitude: _,
        law: Law { name: _, version: _, inputs: _, outputs: _, constants },
        refers_to,
        data: _,
        n_observations: _,
        clusters: _,
        dof,
        sigma,
        run_scatter,
        coefficients,
        derived,
        type_a,
        errors,
        interval: Interval { level, looks: _, of: _ },
        undetermined: _,
        validity,
        diagnostics,
        recommended: _,
        reason: _,
        not_contradicted: _,
    } = estimate;
    let mut put = |path: String, number: Option<f64>| out.extend(number.map(|number| (path, number)));
    for (section, measured) in [("law.constants", constants), ("refers_to", refers_to), ("sigma", sigma)] {
        for (name, m) in measured {
            put(format!("{section}.{name}"), Some(m.value));
        }
    }
    for (name, RunScatter { constant, part, dof }) in run_scatter {
        put(format!("run_scatter.{name}.dof"), *dof);
        put(format!("run_scatter.{name}.constant"), Some(constant.value));
        put(format!("run_scatter.{name}.part"), Some(*part));
    }
    put("interval.level".to_owned(), Some(*level));
    for (name, dof) in dof {
        put(format!("dof.{name}"), *dof);
    }
    for (name, coefficient) in coefficients {
        numbers_of_coefficient(coefficient, &mut |key, number| put(format!("coefficients.{name}.{key}"), number));
    }
    for (name, Derived { formula: _, value, unit: _, standard_uncertainty, interval_95 }) in derived {
        for number in value.iter().chain(standard_uncertainty).chain(interval_95.iter().flatten()) {
            put(format!("derived.{name}"), Some(*number));
        }
    }
    if let Some(TypeA { names: _, matrix, dof, kind: _ }) = type_a {
        matrix.iter().flatten().for_each(|number| put("type_a.matrix".to_owned(), Some(*number)));
        for number in dof {
            put("type_a.dof".to_owned(), *number);
        }
    }
    for (key, error) in errors {
        let SharedError { name: _, quantity: _, kind: _, covariance, dof, limits, sensitivity } = error;
        let matrices = covariance.iter().chain(sensitivity).flatten();
        for number in matrices.chain(dof).chain(limits.iter().flatten()) {
            put(format!("errors.{key}"), Some(*number));
        }
    }
    for (name, range) in validity {
        put(format!("validity.{name}"), Some(range.low));
        put(format!("validity.{name}"), Some(range.high));
    }
    numbers_of_diagnostics(diagnostics, &mut |key, number| put(format!("diagnostics.{key}"), number));
    out
}

/// Every number of a coefficient with its key.
fn numbers_of_coefficient(coefficient: &Coefficient, put: &mut dyn FnMut(&str, Option<f64>)) {
    let Coefficient {
        label: _,
        value,
        unconstrained,
        unit: _,
        status: _,
        nuisance: _,
        standard_uncertainty,
        type_a,
        type_b,
        interval_95,
        range_95,
        effective_dof,
    } = coefficient;
    let named = [
        ("value", value),
        ("unconstrained", unconstrained),
        ("standard_uncertainty", standard_uncertainty),
        ("type_a", type_a),
        ("type_b", type_b),
        ("effective_dof", effective_dof),
    ];
    for (key, number) in named {
        put(key, *number);
    }
    for (key, ends) in [("interval_95", interval_95), ("range_95", range_95)] {
        ends.iter().flatten().for_each(|end| put(key, Some(*end)));
    }
}

/// Every number of the diagnostics with its key.
fn numbers_of_diagnostics(diagnostics: &Diagnostics, put: &mut dyn FnMut(&str, Option<f64>)) {
    let Diagnostics {
        condition_number,
        largest_correlation,
        largest_leverage,
        relative_residual,
        durbin_watson,
        aicc,
        cross_validation_rmse,
        cross_validation_note: _,
        lack_of_fit_p,
        largest_power_w,
        notes: _,
    } = diagnostics;
    let single = [
        ("condition_number", condition_number),
        ("largest_leverage", largest_leverage),
        ("aicc", aicc),
        ("largest_power_w", largest_power_w),
    ];
    for (key, number) in single {
        put(key, *number);
    }
    put(
        "largest_correlation",
        largest_correlation.as_ref().map(|NamedCorrelation { first: _, second: _, value }| *value),
    );
    let many = [
        ("relative_residual", relative_residual),
        ("durbin_watson", durbin_watson),
        ("cross_validation_rmse", cross_validation_rmse),
        ("lack_of_fit_p", lack_of_fit_p),
    ];
    for (key, by_name) in many {
        for (name, number) in by_name {
            put(&format!("{key}.{name}"), Some(*number));
        }
    }
}
