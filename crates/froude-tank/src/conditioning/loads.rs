//! Loads along the body's axes: by the matrix of a load cell, and by the rotation and the place of the sensor.
//!
//! f_body = R f, m_body = R m + r × (R f): a moment about the sensor's origin is one about the body's reference point, r from that point to the sensor. A
//! component that needs another which the log lacks is left out, and said: half a rotation would be a wrong load.
//!
//! **Source.** Any textbook of statics; SNAME (1952) for the axes.

use froude_identify::method::MethodError;
use froude_records::nearest::suggestion;
use froude_records::number::plain;
use froude_records::run::cell::{LOADS, dimension_of_load};
use froude_records::run::clocks::is_own;
use froude_records::run::frames::{Pose, Rotation};
use froude_records::run::step::Step;
use froude_records::run::{Channel, Frame, LOG, Meaning, Told};

use crate::error::undeclared;
use crate::findings::warning;
use crate::log::TankLog;

/// A part of a rotation or of an arm, as part of 1 or of 1 m, that carries nothing: the cosine of 90° is 6e-17.
const NOTHING: f64 = 1e-9;

/// Makes loads of what the bridges of a load cell read.
///
/// # Errors
///
/// A bridge that the log lacks, or that is not declared in full.
pub fn of_cell(run: &mut TankLog) -> Result<(), MethodError> {
    let Some(cell) = run.declared.cell.clone() else { return Ok(()) };
    let mut bridges = Vec::new();
    let (mut time_standard_s, mut place) = (0.0_f64, None);
    for name in &cell.columns {
        let (Some(channel), Some(told)) = (run.log.channels.get(name), run.told.get(name)) else {
            let advice = suggestion(name, run.log.channels.keys().map(String::as_str).collect::<Vec<_>>());
            return Err(MethodError::input(
                &run.log.path,
                format!("[cell] needs the bridge {name:?}, and the log has none; {advice}"),
            ));
        };
        let missing: Vec<&str> = told.undeclared.iter().copied().filter(|key| *key != "frame").collect();
        if !missing.is_empty() || !is_own(&channel.meaning.clock) {
            let what = if missing.is_empty() {
                format!("an aligned clock ({:?} is not in [clocks])", channel.meaning.clock)
            } else {
                missing.join(", no ")
            };
            let what = format!(
                "the bridge {name} states no {what}; write {{ name = \"{name}\", unit = \"mV\", sign = 1, frame = \"sensor\", clock = \"log\" }}"
            );
            return Err(undeclared(&told.place, what));
        }
        time_standard_s = time_standard_s.max(told.time_standard_s);
        place.get_or_insert_with(|| told.place.clone());
        bridges.push((&channel.values, told.factor));
    }
    let Some(place) = place else { return Ok(()) };
    let frame = (cell.frame != Frame::Body.name()).then(|| cell.frame.clone());
    let mut made = Vec::new();
    for ((load, unit), row) in cell.loads.iter().zip(&cell.units).zip(&cell.matrix) {
        let mut values = vec![0.0; run.log.time_s.len()];
        for ((bridge, factor), entry) in bridges.iter().zip(row) {
            // In the load's unit per unit of the bridge as it is written.
            let si = unit.factor * entry / factor;
            values.iter_mut().zip(bridge.iter()).for_each(|(sum, x)| *sum += si * x);
        }
        let dimension = dimension_of_load(load);
        let mut meaning = Meaning::of(load, &dimension.to_string(), LOG);
        meaning.frame = if frame.is_some() { Frame::Sensor } else { Frame::Body };
        let told = Told {
            sensor: froude_records::run::sensor::Sensor::default(),
            frame: frame.clone(),
            undeclared: Vec::new(),
            column: format!("[cell] {load}"),
            factor: unit.factor,
            sign: 1.0,
            time_standard_s,
            scale_errors: Vec::new(),
            place: place.clone(),
        };
        let entries: Vec<String> = row.iter().map(|x| plain(*x, 8)).collect();
        let words = format!("[{}] times the bridges {}, in {unit}", entries.join(", "), cell.columns.join(", "));
        let step = Step::new("cell", load, words);
        let step = cell.columns.iter().zip(row).fold(step, |step, (name, x)| step.with(name, *x, "1"));
        made.push((load.clone(), Channel { meaning, values }, told, step));
    }
    for (name, channel, told, step) in made {
        run.log.channels.insert(name.clone(), channel);
        run.told.insert(name, told);
        run.done.push(step);
    }
    Ok(())
}

/// Turns the loads that are along a declared frame into the body's, about its reference point.
///
/// # Errors
///
/// A channel along a declared frame that is no load; loads of two frames that give one component; loads of which none can be turned.
pub fn in_body(run: &mut TankLog) -> Result<(), MethodError> {
    let mut frames: Vec<String> = Vec::new();
    for (name, told) in &run.told {
        let Some(frame) = &told.frame else { continue };
        if !LOADS.contains(&name.as_str()) {
            let what = format!(
                "{name} is along the frame {frame:?}, and only loads ({}) are turned; write frame = \"sensor\" or \"body\"",
                LOADS.join(", ")
            );
            return Err(undeclared(&told.place, what));
        }
        if !frames.contains(frame) {
            frames.push(frame.clone());
        }
    }
    for frame in frames {
        let Some(pose) = run.declared.frames.get(&frame).map(|spec| spec.in_body) else { continue };
        let is_along = |told: &Told| told.frame.as_deref() == Some(frame.as_str());
        let own: Vec<(String, Told)> = run
            .told
            .iter()
            .filter(|(_, told)| is_along(told))
            .map(|(name, told)| (name.clone(), told.clone()))
            .collect();
        let old: Vec<Option<Channel>> = LOADS
            .iter()
            .map(|name| {
                let is_own = own.iter().any(|(own, _)| own == name);
                is_own.then(|| run.log.channels.shift_remove(*name)).flatten()
            })
            .collect();
        for (name, _) in &own {
            run.told.shift_remove(name);
        }
        let columns: Vec<Option<&[f64]>> = old.iter().map(|c| c.as_ref().map(|c| c.values.as_slice())).collect();
        let turned = turned(&columns, &pose, run.log.time_s.len());
        let names = own.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
        let has_moments = columns[3..].iter().any(Option::is_some);
        let wanted = if has_moments { &LOADS[..] } else { &LOADS[..3] };
        let absent: Vec<&str> =
            wanted.iter().zip(&turned).filter(|(_, values)| values.is_none()).map(|(name, _)| *name).collect();
        if turned.iter().all(Option::is_none) {
            let what = format!(
                "none of {names} can be turned from the frame {frame:?} into the body's: each component of the body needs one that the log lacks; log all three"
            );
            return Err(MethodError::input(&run.log.path, what));
        }
        // A component that nothing of the frame moves is none that anybody measured.
        let lost: Vec<&str> = absent.into_iter().filter(|name| is_moved(&pose, name, &columns)).collect();
        if !lost.is_empty() {
            let text = format!(
                "{}: {} along the body cannot be made of {names} along {frame:?}: a component that the rotation, or the arm, needs is not in the log; left out",
                run.log.path.display(),
                lost.join(", ")
            );
            run.findings.push(warning("load-not-turned", text));
        }
        let words = format!(
            "turned from the frame {frame} into the body's axes, R = {}, its origin at ({}) m from the reference point{}",
            in_words(&pose.rotation),
            pose.origin_m.map(|x| plain(x, 6)).join(", "),
            if has_moments { ", to which moments are moved: m = R m + r × (R f)" } else { "" }
        );
        let mut step = Step::new("frame", &names, words);
        for (i, row) in pose.rotation.iter().enumerate() {
            for (j, x) in row.iter().enumerate() {
                step = step.with(&format!("r{}{}", i + 1, j + 1), *x, "1");
            }
        }
        for (axis, x) in ["x", "y", "z"].iter().zip(pose.origin_m) {
            step = step.with(&format!("origin_{axis}"), x, "m");
        }
        run.done.push(step);
        let Some((_, first)) = own.first() else { continue };
        for (name, values) in LOADS.iter().zip(turned) {
            let Some(values) = values else { continue };
            if run.log.channels.contains_key(*name) {
                let what = format!(
                    "{name} along the body comes from the frame {frame:?} and from another channel; give each cell a log of its own, or leave one out"
                );
                return Err(MethodError::input(&run.log.path, what));
            }
            // A clock that is not aligned stays one.
            let mut clocks = old.iter().flatten().map(|channel| channel.meaning.clock.as_str());
            let clock = clocks.find(|clock| !is_own(clock)).unwrap_or(LOG);
            let mut meaning = Meaning::of(name, &dimension_of_load(name).to_string(), clock);
            meaning.frame = Frame::Body;
            let mut undeclared: Vec<&'static str> =
                own.iter().flat_map(|(_, told)| told.undeclared.iter().copied()).collect();
            undeclared.sort_unstable();
            undeclared.dedup();
            let time_standard_s = own.iter().map(|(_, told)| told.time_standard_s).fold(0.0, f64::max);
            let told = Told { frame: None, undeclared, time_standard_s, ..first.clone() };
            run.log.channels.insert((*name).to_owned(), Channel { meaning, values });
            run.told.insert((*name).to_owned(), told);
        }
    }
    Ok(())
}

fn in_words(rotation: &Rotation) -> String {
    let row = |row: &[f64; 3]| format!("[{}]", row.map(|x| plain(x, 6)).join(", "));
    format!("[{}]", rotation.each_ref().map(row).join(", "))
}

/// Whether a load along the body has a part in what the frame's sensor measures.
fn is_moved(pose: &Pose, name: &str, columns: &[Option<&[f64]>]) -> bool {
    let Some(at) = LOADS.iter().position(|load| *load == name) else { return false };
    let (i, of) = (at % 3, at / 3 * 3);
    (0..3).any(|j| pose.rotation[i][j].abs() > NOTHING && columns[of + j].is_some())
}

/// The six loads along the body, as far as those along the frame determine them.
fn turned(columns: &[Option<&[f64]>], pose: &Pose, n: usize) -> Vec<Option<Vec<f64>>> {
    let along = |i: usize, of: usize| -> Option<Vec<f64>> {
        let mut sum = vec![0.0; n];
        for (j, part) in pose.rotation[i].iter().enumerate().filter(|(_, part)| part.abs() > NOTHING) {
            columns.get(of + j).copied().flatten()?.iter().zip(&mut sum).for_each(|(x, sum)| *sum += part * x);
        }
        Some(sum)
    };
    let forces: Vec<Option<Vec<f64>>> = (0..3).map(|i| along(i, 0)).collect();
    let moment = |i: usize| -> Option<Vec<f64>> {
        let mut sum = along(i, 3)?;
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for (arm, of, sign) in [(pose.origin_m[j], k, 1.0), (pose.origin_m[k], j, -1.0)] {
            if arm.abs() > NOTHING {
                forces[of].as_ref()?.iter().zip(&mut sum).for_each(|(f, sum)| *sum += sign * arm * f);
            }
        }
        Some(sum)
    };
    let moments: Vec<Option<Vec<f64>>> = (0..3).map(moment).collect();
    forces.into_iter().chain(moments).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cell turned by 90° about z, 0.5 m ahead: its y is the body's −x, and a force across it has a moment about the body.
    #[test]
    fn forces_are_turned_and_moments_moved() {
        let pose = Pose { rotation: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], origin_m: [0.5, 0.0, 0.0] };
        let (f_x, f_y, f_z, m) = ([2.0], [3.0], [5.0], [0.0]);
        let columns: Vec<Option<&[f64]>> = [&f_x[..], &f_y, &f_z, &m, &m, &m].map(Some).to_vec();
        let found: Vec<f64> = turned(&columns, &pose, 1).into_iter().map(|x| x.unwrap()[0]).collect();
        // r × F with r = (0.5, 0, 0), F = (−3, 2, 5): (0, −2.5, 1).
        assert_eq!(found, [-3.0, 2.0, 5.0, 0.0, -2.5, 1.0]);
    }

    /// A turn about z needs nothing of z; a moment about z with an arm along x needs f_y.
    #[test]
    fn what_a_component_needs_and_the_log_lacks_is_left_out() {
        let (sin, cos) = 0.3_f64.sin_cos();
        let pose = Pose { rotation: [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]], origin_m: [0.5, 0.0, 0.0] };
        let (f, m) = ([1.0], [4.0]);
        let plane: Vec<Option<&[f64]>> = vec![Some(&f), Some(&f), None, None, None, Some(&m)];
        let found = turned(&plane, &pose, 1);
        let is_there: Vec<bool> = found.iter().map(Option::is_some).collect();
        assert_eq!(is_there, [true, true, false, false, false, true]);
        assert!((found[5].as_ref().unwrap()[0] - (4.0 + 0.5 * (sin + cos))).abs() < 1e-12);
        let alone: Vec<Option<&[f64]>> = vec![Some(&f), None, None, None, None, None];
        assert!(turned(&alone, &pose, 1).iter().all(Option::is_none));
    }
}
