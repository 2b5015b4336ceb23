//! Frequencies of a plan.

use std::f64::consts::TAU;

use crate::error::RecordError;
use crate::section::{Section, Value};
use crate::section_values::series;
use crate::units::Dimension;

/// Frequencies as angular ones: a number of Hz counts periods, any other unit of the kind counts radians.
pub(super) fn angular<'a>(s: &Section<'a>, key: &'static str, value: &'a Value<'a>) -> Result<Vec<f64>, RecordError> {
    let is_hertz = |v: &Value<'_>| v.get_ref().as_str().is_some_and(|text| text.trim_end().ends_with("Hz"));
    let bare = |v: &Value<'_>| v.get_ref().as_str().is_some_and(|text| text.contains("1/s") || text.contains("s^-1"));
    let parts: Vec<&Value<'_>> = match (value.get_ref().as_array(), value.get_ref().as_table()) {
        (Some(list), _) => list.iter().collect(),
        (_, Some(table)) => table.values().collect(),
        _ => vec![value],
    };
    if parts.iter().any(|v| bare(v)) {
        return Err(s.wrong(key, value, "is in 1/s, which says neither periods nor radians; write Hz, or rad/s"));
    }
    let hertz = parts.iter().filter(|v| is_hertz(v)).count();
    if hertz > 0 && hertz < parts.len() {
        return Err(s.wrong(key, value, "is partly in Hz and partly an angular frequency; write one of them"));
    }
    let factor = if hertz > 0 { TAU } else { 1.0 };
    Ok(series(s, key, value, Dimension::ANGULAR_SPEED)?.into_iter().map(|x| factor * x).collect())
}
