//! Columns of a table that nothing uses, each with what it probably is.
//!
//! A table may hold more than a law needs. What is passed over in silence may be
//! the angle of the test under another name: every row is then read as straight
//! ahead, and no number of the fit shows it. So every column that entered nothing
//! is named, with a proposal.
//!
//! A column is used when a law gives it or has it, when `keep`, `group`, a range
//! block or the budget names it, when it describes the run or the water, or when
//! it is a zero or a standard deviation of a load that is used.

use froude_records::campaign::{Campaign, KeepValue, Source};
use froude_records::finding::{Finding, Severity};
use froude_records::nearest::nearest;
use froude_records::table::known_dimension;
use froude_records::units::Dimension;
use indexmap::IndexSet;

use crate::dataset::{Dataset, LOADS};
use crate::law::{ForceLaw, Kind, aliased};

/// Columns that say which run a row is, or in which water; and the motion, which is velocity at once or compared with it.
const DESCRIBES: [&str; 10] =
    ["configuration", "n_links", "run", "setup", "repeat", "time", "temperature", "density", "speed", "angle"];
/// Names under which the angle of a test is found in tables.
const ANGLE_NAMES: [&str; 16] = [
    "beta",
    "β",
    "drift",
    "drift_angle",
    "alpha",
    "α",
    "aoa",
    "attack",
    "angle_of_attack",
    "incidence",
    "heading",
    "yaw",
    "yaw_angle",
    "psi",
    "ψ",
    "leeway",
];
/// Names that people write for columns that are known under another.
const OTHER_NAMES: [(&str, &str); 14] = [
    ("u", "v_x"),
    ("v", "v_y"),
    ("w", "v_z"),
    ("p", "w_x"),
    ("q", "w_y"),
    ("r", "w_z"),
    ("x", "f_x"),
    ("y", "f_y"),
    ("z", "f_z"),
    ("k", "m_x"),
    ("m", "m_y"),
    ("n", "m_z"),
    ("rho", "density"),
    ("velocity", "speed"),
];
/// An angle below this says nothing about its sign, 0.5°.
const STRAIGHT_RAD: f64 = 0.0088;
/// A side force below this share of the largest is too small for its sign to say anything.
const SIGN_MATTERS_ABOVE: f64 = 0.05;
/// Share of the rows that must agree about a sign.
const AGREED: f64 = 0.9;
/// Columns named in one note.
const MOST_NAMED: usize = 12;

/// What no law and nothing else of the campaign uses.
#[must_use]
pub fn unused(data: &Dataset, campaign: &Campaign, source: &Source, laws: &[ForceLaw]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut others: Vec<String> = Vec::new();
    for header in &data.headers {
        let name = name_of(header);
        if is_used(name, data, campaign, source, laws) {
            continue;
        }
        match (data.values(name), data.dimension(name)) {
            (Some(values), Some(dimension)) => match doubt(header, name, values, dimension, data, laws) {
                Some(message) => findings.push(Finding::new(Severity::Warning, "column-not-used", message)),
                None => others.push(format!("`{header}`{}", proposal(name, dimension))),
            },
            _ => others.push(format!("`{header}` (text)")),
        }
    }
    if !others.is_empty() {
        findings.push(Finding::new(
            Severity::Note,
            "column-not-used",
            format!("in no law and in nothing else that was asked for: {}", listed(&others)),
        ));
    }
    findings.extend(left_out(data));
    findings
}

/// Columns that the sidecar passes over.
fn left_out(data: &Dataset) -> Vec<Finding> {
    if data.left_out.is_empty() {
        return Vec::new();
    }
    let mut findings = Vec::new();
    let (angles, others): (Vec<&String>, Vec<&String>) =
        data.left_out.iter().partition(|header| is_straight(data) && is_angle_name(name_of(header)));
    for header in angles {
        findings.push(Finding::new(
            Severity::Warning,
            "column-not-used",
            format!(
                "the sidecar does not name the column `{header}`, and every row is read as straight ahead; if it is the angle, write \
                 \"{header}\" = {{ name = \"angle\", unit = \"deg\" }} into it, with sign = -1 where the file counts the other way \
                 ({CONVENTION})"
            ),
        ));
    }
    if !others.is_empty() {
        let others: Vec<String> = others.into_iter().map(|header| format!("`{header}`")).collect();
        findings.push(Finding::new(
            Severity::Note,
            "column-not-used",
            format!("the sidecar does not name, so these are not read: {}", listed(&others)),
        ));
    }
    findings
}

/// What Froude's angle is, for whoever has to choose a sign.
const CONVENTION: &str = "angle = atan2(-v_y, v_x): a positive one moves the body to port through the water, and the side force on it is \
                          positive, to starboard";

fn listed(names: &[String]) -> String {
    let more = names.len().saturating_sub(MOST_NAMED);
    let shown = names[..names.len() - more].join(", ");
    if more == 0 { shown } else { format!("{shown} and {more} more") }
}

/// A header without its unit.
fn name_of(header: &str) -> &str {
    header.split('[').next().unwrap_or(header).trim()
}

fn is_used(name: &str, data: &Dataset, campaign: &Campaign, source: &Source, laws: &[ForceLaw]) -> bool {
    if DESCRIBES.contains(&name) || source.group.as_deref() == Some(name) {
        return true;
    }
    let has_length = campaign.body.as_ref().is_some_and(|b| b.reference_length_m.is_some());
    if matches!(name, "amplitude" | "period" | "kinematic_viscosity") && has_length {
        return true;
    }
    if name == "volume" && data.channels.contains_key("n_links") {
        return true;
    }
    if let Some(load) = ["zero_before_", "zero_after_", "std_"].iter().find_map(|prefix| name.strip_prefix(prefix)) {
        return is_in(load, laws);
    }
    let is_asked_for = |asked: &str| aliased(asked) == name;
    let kept = source.keep.iter().flat_map(|keep| &keep.clauses);
    is_in(name, laws)
        || kept.filter(|clause| matches!(clause.value, KeepValue::Quantity(_))).any(|c| is_asked_for(&c.column))
        || campaign.identify.cross_validation.iter().any(|block| is_asked_for(&block.column))
        || source.uncertainty.iter().any(|entry| is_asked_for(&entry.quantity))
}

/// Whether a law gives or has a channel.
fn is_in(name: &str, laws: &[ForceLaw]) -> bool {
    laws.iter().any(|law| {
        law.responses.iter().any(|r| r == name)
            || match &law.kind {
                Kind::Drag { .. } => matches!(name, "v_x" | "v_y"),
                Kind::Formulas(formulas) => formulas.iter().flat_map(|f| &f.channels).any(|c| aliased(c) == name),
                Kind::PowerLaw { channel, .. } => channel == name,
            }
    })
}

/// A column whose being passed over may make every coefficient wrong, as a sentence; `None` where it does no harm.
fn doubt(
    header: &str,
    name: &str,
    values: &[f64],
    dimension: Dimension,
    data: &Dataset,
    laws: &[ForceLaw],
) -> Option<String> {
    let (low, high) = range(values);
    if low == 0.0 && high == 0.0 {
        return None;
    }
    if is_straight(data) && dimension == Dimension::ANGLE && is_angle_name(name) {
        return Some(angle_under_another_name(header, name, values, data));
    }
    if let Some(known) = meant(name, dimension).filter(|known| !data.headers.iter().any(|h| name_of(h) == *known)) {
        return Some(format!(
            "`{header}` ({low:.4} to {high:.4}, SI) is read and used by nothing; if it is {known}, name it so"
        ));
    }
    let base = name.strip_suffix("_dot").unwrap_or(name);
    let is_motion = matches!(base, "v_x" | "v_y" | "v_z" | "w_x" | "w_y" | "w_z");
    is_motion.then(|| {
        let loads: IndexSet<&str> = laws.iter().flat_map(|law| &law.responses).map(String::as_str).collect();
        let of = loads.into_iter().collect::<Vec<_>>().join(", ");
        format!(
            "{name} goes from {low:.4} to {high:.4} {dimension} and no law has it: the fit of {of} takes it for zero; write a law with \
             it ([[identify.model]]), or keep the rows where it is zero"
        )
    })
}

/// The angle of the test, as it seems, under a name of its own.
fn angle_under_another_name(header: &str, name: &str, values: &[f64], data: &Dataset) -> String {
    let (low, high) = range(values);
    let unit = header.split_once('[').map_or("deg", |(_, unit)| unit.trim_end_matches(']').trim());
    let told = |sign: f64, because: &str| {
        let how = if sign > 0.0 {
            format!("head it `angle [{unit}]`")
        } else {
            format!("map it in a sidecar, \"{header}\" = {{ name = \"angle\", unit = \"{unit}\", sign = -1 }}")
        };
        format!("if it is the angle of the test, {how}: {because}")
    };
    let what = match side_force_says(values, data) {
        Some((sign, agreeing, all)) => told(
            sign,
            &format!(
                "with that sign the side force f_y opposes the motion sideways in {agreeing} of {all} rows ({CONVENTION})"
            ),
        ),
        None => format!(
            "if it is the angle of the test, head it `angle [{unit}]`, or map it with sign = -1 where it counts the other way ({CONVENTION})"
        ),
    };
    format!(
        "`{header}` goes from {:.2} to {:.2} deg and is not used: every row is read as straight ahead; {what}. If {name} is something \
         else, leave the column out",
        low.to_degrees(),
        high.to_degrees()
    )
}

/// The sign with which a column is the angle, by the side force, and how many rows say so.
fn side_force_says(angle_rad: &[f64], data: &Dataset) -> Option<(f64, usize, usize)> {
    let side = data.values("f_y")?;
    let largest = side.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    let told: Vec<bool> = angle_rad
        .iter()
        .zip(side)
        .filter(|(a, f)| a.sin().abs() > STRAIGHT_RAD && f.abs() > SIGN_MATTERS_ABOVE * largest)
        .map(|(a, f)| a.sin() * f > 0.0)
        .collect();
    let positive = told.iter().filter(|same| **same).count();
    let agreed = |n: usize| n as f64 >= AGREED * told.len() as f64;
    match told.len() {
        0 => None,
        all if agreed(positive) => Some((1.0, positive, all)),
        all if agreed(all - positive) => Some((-1.0, all - positive, all)),
        _ => None,
    }
}

/// True where no row of the table states a motion sideways.
fn is_straight(data: &Dataset) -> bool {
    !data.headers.iter().any(|header| matches!(name_of(header), "angle" | "v_y"))
}

fn is_angle_name(name: &str) -> bool {
    let name = name.to_lowercase().replace([' ', '-'], "_");
    ANGLE_NAMES.contains(&name.as_str())
}

/// The known column of this kind that a name was probably meant to be.
fn meant(name: &str, dimension: Dimension) -> Option<&'static str> {
    if known_dimension(name).is_some() {
        return None;
    }
    let known = DESCRIBES.iter().chain(&LOADS).chain(&["v_x", "v_y", "v_z", "w_x", "w_y", "w_z"]).copied();
    let fits = |known: &str| known_dimension(known) == Some(dimension) && dimension != Dimension::ONE;
    let other = OTHER_NAMES.iter().find(|(other, _)| name.eq_ignore_ascii_case(other)).map(|(_, known)| *known);
    let plain = |text: &str| text.to_lowercase().replace('_', "");
    let same = known.clone().find(|known| plain(known) == plain(name));
    other
        .or(same)
        .filter(|known| fits(known))
        .or_else(|| nearest(name, known.filter(|known| known.len() > 3)).filter(|known| fits(known)))
}

/// What a column of this kind can be made of, in brackets; nothing where nothing is likely.
fn proposal(name: &str, dimension: Dimension) -> String {
    let text = match dimension {
        _ if LOADS.contains(&name) => " (measured, and no law gives it: write one in [[identify.model]])",
        _ if name.starts_with("std_") => {
            " (weights are standard deviations of fitted loads; of another channel, declare it in [[source.uncertainty]])"
        }
        _ if name.starts_with("zero_") => " (the zero of a load that is not there)",
        _ if matches!(name, "kinematic_viscosity" | "amplitude" | "period") => {
            " (for Reynolds and Keulegan–Carpenter numbers, with body.reference_length)"
        }
        Dimension::FORCE => " (if a load of the fluid on the body: f_x, f_y or f_z)",
        Dimension::MOMENT => " (if a load of the fluid on the body: m_x, m_y or m_z)",
        Dimension::SPEED => " (if the motion: speed, v_x, v_y or v_z)",
        Dimension::ANGULAR_SPEED => " (if the motion: w_x, w_y or w_z)",
        Dimension::TEMPERATURE => " (if the water's: temperature)",
        Dimension::DENSITY => " (if the water's: density)",
        _ => "",
    };
    text.to_owned()
}

fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
}
