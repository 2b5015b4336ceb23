//! `[joint]` of all joints alike, or `[[joint]]` with what some of them have of their own.
//!
//! ```toml
//! [[joint]]                          # without between and index: what all have that say nothing else
//! limit = "90 deg"
//!
//! [[joint]]
//! index = [2, 4, 6, 8]               # from the head, or one number
//! axis = "pitch"                     # yaw
//!
//! [[joint]]
//! between = ["head", "link"]         # wherever a module of the first name stands before one of the second
//! torque = "1 N m"
//! ```
//!
//! TOML has either one table of a name or a list of them: `[joint]` and `[[joint]]` cannot stand in one file.

use froude_records::RecordError;
use froude_records::section::{Section, found};
use froude_records::section_values::one_of;

use super::joint::{JointFile, joint};
use crate::spatial::vector::Axis;

/// What says which joints a table is of.
const WHICH: [&str; 3] = ["between", "index", "axis"];

/// What all joints have, each of them, and what each turns about.
pub(super) type Joints = (JointFile, Vec<JointFile>, Vec<Axis>);

pub(super) fn joints(root: &Section<'_>, modules: &[&str], is_3d: bool) -> Result<Joints, RecordError> {
    let count = modules.len() - 1;
    let is_list = root.get("joint").is_some_and(|value| value.get_ref().is_array());
    let tables = if is_list { root.sections("joint")? } else { root.section("joint")?.into_iter().collect() };
    let is_of_all = |s: &Section<'_>| s.get("between").is_none() && s.get("index").is_none();
    let (of_all, own): (Vec<_>, Vec<_>) = tables.into_iter().partition(is_of_all);
    if let [_, second, ..] = &of_all[..] {
        let problem =
            "is the second table without between and index, which is of all joints: write which joints it is of"
                .to_owned();
        return Err(RecordError::Value { place: second.place(), key: "joint".to_owned(), problem });
    }
    let (all, axis) = match of_all.first() {
        Some(s) => (joint(s, &WHICH, None)?, axis_of(s, is_3d)?.unwrap_or_default()),
        None => (JointFile::default(), Axis::Yaw),
    };
    let (mut each, mut axes) = (vec![all; count], vec![axis; count]);
    let mut told: Vec<Option<usize>> = vec![None; count];
    for (table, s) in own.iter().enumerate() {
        let (own, axis) = (joint(s, &WHICH, Some(&all))?, axis_of(s, is_3d)?);
        for at in which(s, modules)? {
            if let Some(before) = told[at].replace(table) {
                let problem = format!(
                    "tells of joint {} again, of which the {} [[joint]] with between or index tells: write it in one of them",
                    at + 1,
                    ordinal(before + 1)
                );
                return Err(RecordError::Value { place: s.place(), key: "joint".to_owned(), problem });
            }
            each[at] = own;
            axes[at] = axis.unwrap_or(axes[at]);
        }
    }
    let is_servo = |joint: &JointFile| joint.servo.is_some();
    if let Some(other) = each.iter().position(|j| is_servo(j) != is_servo(&each[0])) {
        let (with, without) = if is_servo(&each[0]) { (1, other + 1) } else { (other + 1, 1) };
        let problem = format!(
            "{with} has kp and kd, and joint {without} has none: either all joints follow their gait exactly, or all have servos"
        );
        return Err(RecordError::Value { place: root.place(), key: "joint".to_owned(), problem });
    }
    Ok((all, each, axes))
}

fn axis_of(s: &Section<'_>, is_3d: bool) -> Result<Option<Axis>, RecordError> {
    let axis = one_of(s, "axis", &["yaw", "pitch"], &[Axis::Yaw, Axis::Pitch])?;
    match (axis, s.get("axis")) {
        (Some(Axis::Pitch), Some(value)) if !is_3d => {
            let problem = "is \"pitch\", and joints of a plane yaw: write space = \"3d\" in [model], or axis = \"yaw\"";
            Err(s.wrong("axis", value, problem))
        }
        _ => Ok(axis),
    }
}

/// Joints of a table, from 0.
fn which(s: &Section<'_>, modules: &[&str]) -> Result<Vec<usize>, RecordError> {
    let count = modules.len() - 1;
    match (s.get("index"), s.get("between")) {
        (Some(value), Some(_)) => {
            Err(s.wrong("index", value, "and between both say which joints it is: write one of them"))
        }
        (Some(value), None) => {
            let one = |value| {
                let number = s.as_number("index", value)?;
                if number.fract() == 0.0 && number >= 1.0 && number <= count as f64 {
                    return Ok(number as usize - 1);
                }
                let problem = format!("is {number}; the robot has joints 1 to {count}, from the head");
                Err(s.wrong("index", value, problem))
            };
            match value.get_ref().as_array() {
                Some(list) if list.is_empty() => Err(s.wrong("index", value, "is empty; write which joints it is")),
                Some(list) => list.iter().map(one).collect(),
                None => Ok(vec![one(value)?]),
            }
        }
        (None, Some(value)) => {
            let names = s.texts("between")?;
            let [before, behind] = &names[..] else {
                let problem = format!("is {}; expected the names of two modules: [\"head\", \"link\"]", found(value));
                return Err(s.wrong("between", value, problem));
            };
            let at: Vec<usize> = (0..count).filter(|i| modules[*i] == before && modules[i + 1] == behind).collect();
            if at.is_empty() {
                let problem = format!(
                    "is {}, and no {behind:?} stands behind a {before:?}; the modules from the head are {}",
                    found(value),
                    modules.join(", ")
                );
                return Err(s.wrong("between", value, problem));
            }
            Ok(at)
        }
        (None, None) => Ok((0..count).collect()),
    }
}

fn ordinal(n: usize) -> String {
    match n {
        1 => "first".to_owned(),
        2 => "second".to_owned(),
        3 => "third".to_owned(),
        _ => format!("{n}th"),
    }
}
