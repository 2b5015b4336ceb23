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
use froude_records::known_columns::known_dimension;
use froude_records::nearest::nearest;
use froude_records::number::plain;
use froude_records::units::Dimension;
use indexmap::IndexSet;

use crate::dataset::{Dataset, LOADS};
use crate::formula::aliased;
use crate::law::{ForceLaw, Kind};
use crate::lint::repeats::REPEATS_WITHIN;
use crate::named;
use crate::validation::{STD_ITERATIVE, STD_NUMERICAL};

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
/// Those of them that are measured in the vertical plane where the loads are.
const VERTICAL_NAMES: [&str; 6] = ["alpha", "α", "aoa", "attack", "angle_of_attack", "incidence"];
/// An angle below this says nothing about its sign, 0.5°; a column of such angles is a straight tow's.
const STRAIGHT_RAD: f64 = 0.0088;
/// A side force below this share of the largest is too small for its sign to say anything.
const SIGN_MATTERS_ABOVE: f64 = 0.05;
/// Angular speed below which a column is noise, 0.1°/s: turning tests go from some 1°/s up, gyros drift by less.
const TURNS_RAD_S: f64 = 2e-3;
/// Acceleration below which a column is noise, 2 mg: the zero of usual accelerometers.
const SPEEDS_UP_M_S2: f64 = 0.02;
/// The same of angular acceleration.
const SPINS_UP_RAD_S2: f64 = 0.01;
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
                None => others.push(format!("`{header}`{}", proposal(name, dimension, data))),
            },
            _ => others.push(format!("`{header}` (text)")),
        }
    }
    if !others.is_empty() {
        findings.push(Finding::new(
            Severity::Note,
            "column-not-used",
            format!("columns that no law uses, nor anything else that was asked for: {}", listed(&others)),
        ));
    }
    findings.extend(left_out(data));
    findings.extend(letters(data, campaign, source, laws));
    findings
}

/// Names that the campaign uses and that are columns of the table as well as letters of other columns.
fn letters(data: &Dataset, campaign: &Campaign, source: &Source, laws: &[ForceLaw]) -> Vec<Finding> {
    let used = laws.iter().flat_map(ForceLaw::channels);
    let kept = source.keep.iter().flat_map(|keep| &keep.clauses).map(|clause| clause.column.as_str());
    let blocks = campaign.identify.cross_validation.iter().map(|block| block.column.as_str());
    let budget = source.uncertainty.iter().map(|entry| entry.quantity.as_str());
    let names: IndexSet<&str> = used.chain(kept).chain(blocks).chain(budget).collect();
    let own = names.into_iter().filter(|name| data.channels.contains_key(*name) && aliased(name) != *name);
    own.map(|name| {
        let column = aliased(name);
        let text = format!(
            "{name} is read as the table's column `{}`, not as the alias of {column}; write {column} if you mean that, or rename the column",
            data.header(name)
        );
        Finding::new(Severity::Note, "column-like-alias", text)
    })
    .collect()
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
        if is_vertical(name_of(header), data) {
            if !has(data, "v_z") {
                let message = format!("the sidecar does not name the column `{header}`; {IN_THE_VERTICAL_PLANE}");
                findings.push(Finding::new(Severity::Warning, "column-not-used", message));
            }
            continue;
        }
        findings.push(Finding::new(
            Severity::Warning,
            "column-not-used",
            format!(
                "the sidecar does not name the column `{header}`, and every row is read as straight ahead; if it is the angle, write \
                 \"{header}\" = {{ name = \"angle\", unit = \"deg\" }} into it, with sign = -1 where the file counts the other way \
                 ({CONVENTION}){}",
                beside_v_x(data)
            ),
        ));
    }
    if !others.is_empty() {
        let others: Vec<String> = others.into_iter().map(|header| format!("`{header}`")).collect();
        findings.push(Finding::new(
            Severity::Note,
            "column-not-used",
            format!("columns that the sidecar does not name, and that are not read: {}", listed(&others)),
        ));
    }
    findings
}

/// What to do with the angle of a vertical test.
const IN_THE_VERTICAL_PLANE: &str = "if it is the angle of attack in the vertical plane, give v_x and v_z instead of the speed \
                                     (z points down: v_z is positive with the bow up)";
/// What Froude's angle is, for a user who has to choose a sign.
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
    if let Some(load) = ["zero_before_", "zero_after_", STD_NUMERICAL, STD_ITERATIVE, "std_"]
        .iter()
        .find_map(|prefix| name.strip_prefix(prefix))
    {
        return is_in(load, laws);
    }
    let is_asked_for = |asked: &str| data.meant(asked) == name;
    let kept = source.keep.iter().flat_map(|keep| &keep.clauses);
    is_in(name, laws)
        || kept.filter(|clause| matches!(clause.value, KeepValue::Quantity(_))).any(|c| is_asked_for(&c.column))
        || campaign.identify.cross_validation.iter().any(|block| is_asked_for(&block.column))
        || source.uncertainty.iter().any(|entry| is_asked_for(&entry.quantity))
}

/// Whether a law gives or has a channel.
pub(crate) fn is_in(name: &str, laws: &[ForceLaw]) -> bool {
    laws.iter().any(|law| {
        law.responses.iter().any(|r| r == name)
            || match &law.kind {
                Kind::Drag { .. } => matches!(name, "v_x" | "v_y"),
                Kind::Formulas(formulas) => formulas.iter().flat_map(|f| &f.channels).any(|c| c == name),
                Kind::PowerLaw { .. } | Kind::Thruster { .. } => law.channels().contains(&name),
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
        let is_turned = values.iter().any(|angle| angle.abs() > STRAIGHT_RAD);
        if !is_vertical(name, data) {
            return is_turned.then(|| angle_under_another_name(header, name, values, data));
        }
        return (is_turned && !has(data, "v_z")).then(|| {
            let [low, high] = [low, high].map(f64::to_degrees);
            format!("`{header}` goes from {low:.2} to {high:.2} deg and is not used; {IN_THE_VERTICAL_PLANE}")
        });
    }
    if let Some(known) = meant(name, dimension).filter(|known| !has(data, known) && !contradicts(known, data)) {
        return Some(format!(
            "`{header}` ({low:.4} to {high:.4}, SI) is read and used by nothing; if it is {known}, name it so"
        ));
    }
    let is_noise = low.abs().max(high.abs()) < noise_of(dimension);
    (is_motion(name) && !is_noise && !is_carried_along(name, [low, high], laws)).then(|| {
        let loads: IndexSet<&str> = laws.iter().flat_map(|law| &law.responses).map(String::as_str).collect();
        let of = loads.into_iter().collect::<Vec<_>>().join(", ");
        let by_name = named::having(name, data);
        let by_name =
            if by_name.is_empty() { String::new() } else { format!(", name one that has it ({})", by_name.join(", ")) };
        format!(
            "{name} goes from {low:.4} to {high:.4} {dimension} and appears in no law: the fit of {of} treats it as zero; write a law with \
             it ([[identify.model]]){by_name}, or keep the rows where it is zero"
        )
    })
}

/// Whether a speed across the fitted loads is the same in all rows, as well as rigs hold it: the carriage's in a test of sway, of which the coefficients are functions.
fn is_carried_along(name: &str, [low, high]: [f64; 2], laws: &[ForceLaw]) -> bool {
    let along = name.replacen("v_", "f_", 1);
    let is_across = name.starts_with("v_") && !name.ends_with("_dot") && !is_in(&along, laws);
    is_across && high - low <= REPEATS_WITHIN * low.abs().max(high.abs())
}

/// A velocity of the body, or its derivative.
fn is_motion(name: &str) -> bool {
    let base = name.strip_suffix("_dot").unwrap_or(name);
    matches!(base, "v_x" | "v_y" | "v_z" | "w_x" | "w_y" | "w_z")
}

/// What a motion of this kind must reach to be more than noise, in SI.
fn noise_of(dimension: Dimension) -> f64 {
    match dimension {
        Dimension::ANGULAR_SPEED => TURNS_RAD_S,
        Dimension::ACCELERATION => SPEEDS_UP_M_S2,
        Dimension::ANGULAR_ACCELERATION => SPINS_UP_RAD_S2,
        _ => 0.0,
    }
}

fn has(data: &Dataset, name: &str) -> bool {
    data.headers.iter().any(|header| name_of(header) == name)
}

/// Whether a column of this name would state the motion twice: v_x and v_y overrule speed and angle.
fn contradicts(known: &str, data: &Dataset) -> bool {
    match known {
        "v_x" | "v_y" => has(data, "speed"),
        "speed" | "angle" => has(data, "v_x") || has(data, "v_y"),
        _ => false,
    }
}

/// Whether an angle of this name lies in the vertical plane: the loads of the table do, and none is lateral.
fn is_vertical(name: &str, data: &Dataset) -> bool {
    VERTICAL_NAMES.contains(&plain_angle(name).as_str()) && (has(data, "f_z") || has(data, "m_y")) && !has(data, "f_y")
}

/// The angle of the test, as it seems, under a name of its own.
fn angle_under_another_name(header: &str, name: &str, values: &[f64], data: &Dataset) -> String {
    let (low, high) = range(values);
    let unit = header.split_once('[').map_or("deg", |(_, unit)| unit.trim_end_matches(']').trim());
    let beside = beside_v_x(data);
    let advised = |sign: f64, because: &str| {
        let how = if sign > 0.0 {
            format!("head it `angle [{unit}]`{beside}")
        } else {
            format!("map it in a sidecar, \"{header}\" = {{ name = \"angle\", unit = \"{unit}\", sign = -1 }}{beside}")
        };
        format!("if it is the angle of the test, {how}: {because}")
    };
    let what = match side_force_says(values, data) {
        Some((sign, agreeing, all)) => advised(
            sign,
            &format!(
                "with that sign the side force f_y opposes the motion sideways in {agreeing} of {all} rows{} ({CONVENTION})",
                if data.sample.is_some() { " of a sample" } else { "" }
            ),
        ),
        None => format!(
            "if it is the angle of the test, head it `angle [{unit}]`{beside}, or map it with sign = -1 where it counts the other way \
             ({CONVENTION})"
        ),
    };
    format!(
        "`{header}` goes from {:.2} to {:.2} deg and is not used: every row is read as straight ahead; {what}. If {name} is something \
         else, leave the column out",
        low.to_degrees(),
        high.to_degrees()
    )
}

/// What an angle needs beside a v_x without v_y, which goes before it: with the two alone the angle would still not be used.
fn beside_v_x(data: &Dataset) -> &'static str {
    match (has(data, "v_x"), has(data, "speed")) {
        (false, _) => "",
        (true, true) => ", and leave v_x out, which takes precedence over speed and angle",
        (true, false) => {
            ", and v_x `speed` if that is the carriage's (a velocity takes precedence over an angle; beside one along the body give v_y)"
        }
    }
}

/// The sign with which a column is the angle, by the side force, and how many rows say so.
fn side_force_says(angle_rad: &[f64], data: &Dataset) -> Option<(f64, usize, usize)> {
    let side = data.values("f_y")?;
    let largest = side.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    // Astern, with a speed below zero, the flow comes from the other side.
    let is_astern = |i: usize| data.values("speed").is_some_and(|u| u[i] < 0.0);
    let is_same: Vec<bool> = angle_rad
        .iter()
        .zip(side)
        .enumerate()
        .filter(|(_, (a, f))| a.sin().abs() > STRAIGHT_RAD && f.abs() > SIGN_MATTERS_ABOVE * largest)
        .map(|(i, (a, f))| (a.sin() * f > 0.0) != is_astern(i))
        .collect();
    let positive = is_same.iter().filter(|same| **same).count();
    let agreed = |n: usize| n as f64 >= AGREED * is_same.len() as f64;
    match is_same.len() {
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
    ANGLE_NAMES.contains(&plain_angle(name).as_str())
}

fn plain_angle(name: &str) -> String {
    name.to_lowercase().replace([' ', '-'], "_")
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
fn proposal(name: &str, dimension: Dimension, data: &Dataset) -> String {
    let text = match dimension {
        _ if LOADS.contains(&name) => " (measured, and no law gives it: write one in [[identify.model]])",
        _ if name.starts_with("std_") => {
            " (weights are standard deviations of fitted loads; of another channel, declare it in [[source.uncertainty]])"
        }
        _ if name.starts_with("zero_") => " (the zero of a load that is not there)",
        _ if matches!(name, "kinematic_viscosity" | "amplitude" | "period") => {
            " (for Reynolds and Keulegan–Carpenter numbers, with body.reference_length)"
        }
        _ if is_motion(name) => match data.values(name).map(range) {
            Some((low, high)) if low.abs().max(high.abs()) > noise_of(dimension) => {
                return format!(
                    " (no law has it; coefficients hold at the {} {dimension} of all rows)",
                    plain(high, 4)
                );
            }
            _ => " (no law has it, and it is zero or as small as noise)",
        },
        Dimension::FORCE => " (if a load of the fluid on the body: f_x, f_y or f_z)",
        Dimension::MOMENT => " (if a load of the fluid on the body: m_x, m_y or m_z)",
        Dimension::SPEED if has(data, "speed") => " (if the motion: v_z)",
        Dimension::SPEED if contradicts("speed", data) => " (if the motion: v_x, v_y or v_z)",
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

#[cfg(test)]
mod tests {
    use super::*;

    fn table(columns: &[(&str, Dimension, [f64; 3])]) -> Dataset {
        let mut data = Dataset { rows: 3, ..Dataset::default() };
        for (name, dimension, values) in columns {
            data.headers.push((*name).to_owned());
            data.put(name, values.to_vec(), *dimension);
        }
        data
    }

    fn said(name: &str, data: &Dataset) -> Option<String> {
        doubt(name, name, data.values(name).unwrap(), data.dimension(name).unwrap(), data, &[])
    }

    const TURNED: [f64; 3] = [-0.2, 0.0, 0.2];
    const SPEEDS: [f64; 3] = [0.5, 1.0, 1.5];

    #[test]
    fn an_angle_of_attack_is_no_drift() {
        for load in [("f_z", Dimension::FORCE), ("m_y", Dimension::MOMENT)] {
            let mut columns = vec![
                ("speed", Dimension::SPEED, SPEEDS),
                ("alpha", Dimension::ANGLE, TURNED),
                (load.0, load.1, TURNED),
            ];
            let vertical = said("alpha", &table(&columns)).unwrap();
            assert!(vertical.contains("give v_x and v_z") && !vertical.contains("`angle"), "{vertical}");
            columns.push(("f_y", Dimension::FORCE, TURNED));
            assert!(said("alpha", &table(&columns)).unwrap().contains("head it `angle"));
            columns.pop();
            columns.push(("v_z", Dimension::SPEED, TURNED));
            assert_eq!(said("alpha", &table(&columns)), None);
        }
    }

    #[test]
    fn noise_is_no_motion() {
        for (name, dimension, noise) in [
            ("yaw", Dimension::ANGLE, 8.7e-4),
            ("w_z", Dimension::ANGULAR_SPEED, 1e-4),
            ("v_x_dot", Dimension::ACCELERATION, 5e-3),
            ("w_z_dot", Dimension::ANGULAR_ACCELERATION, 1e-3),
        ] {
            let of = |size: f64| said(name, &table(&[(name, dimension, [-size, 0.1 * size, size])]));
            assert_eq!(of(noise), None, "{name}");
            assert!(of(100.0 * noise).is_some(), "{name}");
        }
    }

    #[test]
    fn no_proposal_states_the_motion_twice() {
        let both = [("speed", Dimension::SPEED, SPEEDS), ("angle", Dimension::ANGLE, TURNED)];
        for name in ["u", "v", "vx", "Vy"] {
            let alone = table(&[(name, Dimension::SPEED, SPEEDS)]);
            assert!(said(name, &alone).is_some(), "{name}");
            let beside = table(&[both[0], both[1], (name, Dimension::SPEED, SPEEDS)]);
            assert_eq!(said(name, &beside), None, "{name}");
            assert_eq!(proposal(name, Dimension::SPEED, &beside), " (if the motion: v_z)");
        }
        for given in ["v_x", "v_y"] {
            let data = table(&[(given, Dimension::SPEED, SPEEDS), ("velocity", Dimension::SPEED, SPEEDS)]);
            assert_eq!(said("velocity", &data), None);
        }
    }
}
