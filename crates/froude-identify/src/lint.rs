//! What is doubtful about the observations, before and after the fit.
//!
//! A lint changes nothing except that identical copies are dropped, and says so.
//! Every limit is a constant with its reason.

use std::f64::consts::{PI, TAU};

use froude_records::campaign::{BodySpec, Campaign};
use froude_records::finding::{Finding, Severity};
use froude_records::plausible::AIR_KG_M3;
use froude_records::table::{ColumnData, Table};
use indexmap::IndexMap;

use crate::dataset::{Dataset, LOADS, distinct};

/// An angle that differs from that of the velocity by more says something else, 1°.
const ANGLE_CONTRADICTS_RAD: f64 = std::f64::consts::PI / 180.0;
/// A load below this share of the largest is too small for its sign to say anything.
pub(crate) const SIGN_MATTERS_ABOVE: f64 = 0.05;
/// Rows slower than this part of the fastest are at rest: the angle of their velocity is that of noise.
pub(crate) const AT_REST: f64 = 0.05;
/// Share of rows at one extreme value that looks like a saturated sensor.
const SATURATED_SHARE: f64 = 0.02;
/// A linear and a quadratic term need at least this many distinct speeds.
const DISTINCT_SPEEDS_NEEDED: usize = 3;
/// Steps of volume per link that differ by more than this from the median do not add up.
const VOLUME_STEP_TOLERANCE: f64 = 0.02;
/// Angles all below this, over at least eight rows, were probably typed in radians (π/2 read as degrees).
const RADIAN_SUSPICION_RAD: f64 = 1.6 * std::f64::consts::PI / 180.0;
/// Drag coefficients on frontal area that bodies have (Hoerner 1965: 0.04 streamlined to 2.3 hollow section; margin 2 both ways).
const BODY_DRAG_COEFFICIENT: std::ops::RangeInclusive<f64> = 0.02..=4.6;

/// Areas that a drag may stand for, |F|/(½ρU²) in m².
///
/// Upper: a fully loaded tanker of 300 000 t drags like some 50 m² (30 000 m² of wetted surface at a C_T of 0.0017); no
/// towed or propelled body is twenty times that. Lower: a sphere of 0.1 mm, which no tank tests, has some 1e-8 m²; a wire
/// 1 mm thick and 10 cm long across the stream has 1e-4 m². MN written for mN is a factor of 1e9: every body between
/// a streamlined model of 1 cm (1e-5 m²) and a ship then lies outside. A factor of a thousand is mostly not seen.
const DRAG_AREA_M2: std::ops::RangeInclusive<f64> = 1e-7..=1e3;
/// Rows at this share of the largest speed or more are near it: there the zero and the bearings matter least.
pub(crate) const NEAR_LARGEST_SPEED: f64 = 0.9;
/// Density where neither campaign nor table says one: fresh water. Sea water differs by 3 %, which no bound notices.
const DENSITY_UNSTATED_KG_M3: f64 = 1000.0;

/// How well rigs repeat a setting, as part of the largest: 2 mm/s in 1 m/s moves a drag by 0.4 % there.
const REPEATS_WITHIN: f64 = 2e-3;
/// Share of the speed along x from which a body shows its frontal area: within 8°.
const AHEAD: f64 = 0.99;
/// The fastest towing carriages run 20 to 30 m/s; a model that is said to go faster was typed in another unit.
const FASTEST_M_S: f64 = 40.0;
/// The same of air: at Mach 0.3 its compressibility moves pressures by 5 % (Prandtl and Glauert, 1/√(1 − M²)), and no law here knows of it.
const FASTEST_IN_AIR_M_S: f64 = 100.0;

/// Every lint that looks at observations alone.
///
/// A finding for each doubt; an empty list says that none of these checks found anything.
#[must_use]
pub fn observations(data: &Dataset, campaign: &Campaign) -> Vec<Finding> {
    let mut findings = Vec::new();
    findings.extend(force_along_motion(data));
    findings.extend(saturation(data));
    findings.extend(angle_in_radians(data));
    findings.extend(distinct_speeds(data));
    findings.extend(repeats(data));
    findings.extend(of_ends(data, campaign));
    findings
}

/// Those that the rows at the ends of the ranges decide.
pub(crate) fn of_ends(data: &Dataset, campaign: &Campaign) -> Vec<Finding> {
    let mut findings = Vec::new();
    findings.extend(implausible_speed(data));
    findings.extend(drag_area(data, campaign.body.as_ref().and_then(|b| b.reference_area_m2)));
    findings.extend(one_sign_of_angle(data));
    if let Some(body) = &campaign.body {
        findings.extend(volumes(body));
    }
    findings.extend(volume_channel(data, campaign.body.as_ref().and_then(|b| b.link_volume_m3)));
    findings
}

/// Rows equal to an earlier one in every column and text: (rows to keep, finding).
///
/// Repeats differ in their measured loads; a copy does not, and would count twice.
#[must_use]
pub fn identical_copies(data: &Dataset) -> (Vec<usize>, Option<Finding>) {
    let mut seen: IndexMap<Vec<u64>, usize> = IndexMap::new();
    let mut keep = Vec::new();
    let mut copies = Vec::new();
    let configurations = crate::dataset::labels(&data.configuration);
    let setups = crate::dataset::labels(&data.setup);
    let runs = crate::dataset::labels(&data.run);
    for i in 0..data.rows {
        let mut key: Vec<u64> = data.channels.values().map(|c| c.values[i].to_bits()).collect();
        key.extend([configurations[i], setups[i], runs[i]].map(|x| x as u64));
        if let Some(&first) = seen.get(&key) {
            copies.push((first, i));
        } else {
            seen.insert(key, i);
            keep.push(i);
        }
    }
    if copies.is_empty() {
        return (keep, None);
    }
    let line = |i: usize| data.line.get(i).copied().unwrap_or(i + 1);
    let shown: Vec<String> = copies.iter().take(4).map(|&(a, b)| format!("{} = {}", line(b), line(a))).collect();
    let more = if copies.len() > 4 { ", …" } else { "" };
    let finding = Finding::new(
        Severity::Warning,
        "identical-copies",
        format!(
            "{} of {} rows {} dropped (lines {}{more}); real repeats differ in their loads",
            copies.len(),
            data.rows,
            if copies.len() == 1 {
                "is an identical copy of an earlier one and is"
            } else {
                "are identical copies of earlier ones and are"
            },
            shown.join(", ")
        ),
    );
    (keep, Some(finding))
}

/// Speed and angle beside v_x and v_y that say something else: the velocity is used.
///
/// `rows` of the table are those of `data`, in its order.
#[must_use]
pub fn motion_contradictions(table: &Table, rows: &[usize], data: &Dataset) -> Vec<Finding> {
    let read = |name: &str| -> Option<Vec<f64>> {
        table.columns.iter().find(|c| c.name == name).and_then(|c| match &c.data {
            ColumnData::Number { si, .. } => Some(rows.iter().map(|&i| si[i]).collect()),
            ColumnData::Text(_) => None,
        })
    };
    let line = |i: usize| data.line.get(i).copied().unwrap_or(i + 1);
    let mut findings = Vec::new();
    let has_velocity = read("v_x").is_some() || read("v_y").is_some();
    if has_velocity && let (Some(stated), Some(derived)) = (read("angle"), data.values("angle")) {
        // At rest there is no angle; a turn more is the same one.
        let speed = data.values("speed").unwrap_or_default();
        let moving = moving(speed, AT_REST);
        let stated_speed = read("speed");
        let apart = |i: usize| angles_apart(stated[i], stated_speed.as_ref().map(|u| u[i]), derived[i]);
        let worst = moving.into_iter().rev().map(|i| (apart(i), i)).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((worst, row)) = worst.filter(|(worst, _)| *worst > ANGLE_CONTRADICTS_RAD) {
            findings.push(Finding::new(
                Severity::Warning,
                "angle-contradicts-velocity",
                format!(
                    "the angle column differs from atan2(-v_y, v_x) by up to {:.2} deg (line {}); v_x and v_y are used{}",
                    worst.to_degrees(),
                    line(row),
                    match (read("v_x"), read("v_y")) {
                        (Some(_), None) =>
                            " (v_y is missing and read as 0): if v_x is the speed of the carriage, name it speed",
                        (None, Some(_)) => " (v_x is missing and read as 0): give speed and angle, or both velocities",
                        _ => ": check the sign of v_y, or leave one of the two out",
                    }
                ),
            ));
        }
    }
    if has_velocity && let (Some(stated), Some(derived)) = (read("speed"), data.values("speed")) {
        let apart = |i: usize| speeds_apart(stated[i], derived[i]);
        let worst = (0..data.rows).rev().map(|i| (apart(i), i)).max_by(|a, b| a.0.total_cmp(&b.0));
        let scale = derived.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if let Some((worst, row)) = worst.filter(|(worst, _)| *worst > 0.01 * scale) {
            findings.push(Finding::new(
                Severity::Warning,
                "speed-contradicts-velocity",
                format!(
                    "the speed column differs from |v| by up to {worst:.3e} m/s (line {}); v_x and v_y are used",
                    line(row)
                ),
            ));
        }
    }
    findings
}

/// How far a stated angle lies from that of the velocity, rad.
pub(crate) fn angles_apart(stated: f64, stated_speed: Option<f64>, derived: f64) -> f64 {
    // With a speed below zero the body moves the other way than its angle says.
    let astern = if stated_speed.is_some_and(|u| u < 0.0) { PI } else { 0.0 };
    let by = stated + astern - derived;
    (by - TAU * (by / TAU).round()).abs()
}

/// How far a stated speed lies from that of the velocity, m/s.
pub(crate) fn speeds_apart(stated: f64, derived: f64) -> f64 {
    (stated.abs() - derived.abs()).abs()
}

/// Rows that move faster than a part of the fastest; a speed below zero goes astern.
pub(crate) fn moving(speed: &[f64], part: f64) -> Vec<usize> {
    let fastest = speed.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    (0..speed.len()).filter(|&i| speed[i].abs() > part * fastest).collect()
}

/// Forces with the velocity along the same axis.
pub(crate) const ALONG: [(&str, &str); 3] = [("f_x", "v_x"), ("f_y", "v_y"), ("f_z", "v_z")];

/// Rows in which a load points along the motion.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pushed {
    /// Rows large enough to tell.
    large: usize,
    along: usize,
    /// Line of the first of them.
    line: usize,
}

impl Pushed {
    /// Counts the rows of a load and a motion, of which the largest are known.
    pub(crate) fn count(&mut self, data: &Dataset, (f, v): (&[f64], &[f64]), [largest_f, largest_v]: [f64; 2]) {
        for (i, (f, v)) in f.iter().zip(v).enumerate() {
            if f.abs() > SIGN_MATTERS_ABOVE * largest_f && v.abs() > SIGN_MATTERS_ABOVE * largest_v {
                self.large += 1;
                if f * v > 0.0 {
                    if self.along == 0 {
                        self.line = data.line.get(i).copied().unwrap_or(0);
                    }
                    self.along += 1;
                }
            }
        }
    }
}

/// The largest size of some numbers.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0_f64, |m, x| m.max(x.abs()))
}

/// Loads along the motion: a drag that pushes.
fn force_along_motion(data: &Dataset) -> Vec<Finding> {
    let counted = |(load, motion): (&'static str, &'static str)| {
        let (f, v) = (data.values(load)?, data.values(motion)?);
        let mut pushed = Pushed::default();
        pushed.count(data, (f, v), [largest(f), largest(v)]);
        Some((load, motion, pushed))
    };
    along_motion(&ALONG.into_iter().filter_map(counted).collect::<Vec<_>>(), data.rows, data)
}

/// The message about loads along the motion, of so many rows; `data` says which channels there are.
pub(crate) fn along_motion(
    counted: &[(&'static str, &'static str, Pushed)],
    n_rows: usize,
    data: &Dataset,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (load, motion, Pushed { large, along, line }) in counted {
        if *along == 0 {
            continue;
        }
        let all = along * 2 > *large;
        let of = if *large == n_rows {
            format!("in {along} of {large} rows")
        } else {
            format!("in {along} of the {large} rows large enough to tell ({n_rows} in all)")
        };
        findings.push(Finding::new(
            if all { Severity::Error } else { Severity::Warning },
            "force-along-motion",
            if all {
                format!(
                    "{load} points along {motion} {of}: a drag must oppose the motion; if the sensor is mounted the other \
                     way round, write sign = -1 for its column{}",
                    if *motion == "v_y" && data.channels.contains_key("angle") {
                        "; if the angle is counted in the opposite sense (as beta of a ship's drift test is), write it for the angle's"
                    } else {
                        ""
                    }
                )
            } else {
                format!(
                    "{load} points along {motion} {of}, first on line {line}; check zero and mounting of these runs"
                )
            },
        ));
    }
    findings
}

/// A speed that no tank and no model has.
fn implausible_speed(data: &Dataset) -> Option<Finding> {
    let speed = data.values("speed")?;
    let i = (0..data.rows).max_by(|&i, &j| speed[i].abs().total_cmp(&speed[j].abs()))?;
    let is_air = data.values("density").is_some_and(|d| AIR_KG_M3.contains(&d[i]));
    let (most, than) = if is_air {
        (FASTEST_IN_AIR_M_S, "than these laws allow, which neglect compressibility (Mach 0.3 is 100 m/s)")
    } else {
        (FASTEST_M_S, "than any towing carriage (20 to 30 m/s)")
    };
    (speed[i].abs() > most).then(|| {
        Finding::new(
            Severity::Warning,
            "implausible-speed",
            format!(
                "line {}: {:.1} m/s is faster {than}; check the unit of the speed",
                data.line.get(i).copied().unwrap_or(i + 1),
                speed[i].abs()
            ),
        )
    })
}

/// A force that no body at that speed has: a prefix of a unit is probably wrong.
///
/// Only the largest of the loads is asked: a side force at no angle, a drag at broadside may be as small as they like.
///
/// With a stated reference area it is asked for the drag coefficient that bodies have.
fn drag_area(data: &Dataset, reference_area_m2: Option<f64>) -> Option<Finding> {
    let speed = data.values("speed")?;
    let near = moving(speed, NEAR_LARGEST_SPEED);
    let (load, i, f) = ["f_x", "f_y", "f_z"]
        .into_iter()
        .filter_map(|load| Some((load, data.values(load)?)))
        .flat_map(|(load, f)| near.iter().map(move |&i| (load, i, f[i])))
        .max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()))?;
    let density_kg_m3 = data.values("density").map_or(DENSITY_UNSTATED_KG_M3, |d| d[i]);
    let area_m2 = f.abs() / (0.5 * density_kg_m3 * speed[i] * speed[i]);
    if f == 0.0 {
        return None;
    }
    // The reference is a frontal area: a side force on it says nothing (a torpedo at broadside has 15).
    let goes_ahead = load == "f_x" && data.velocity_m_s(i)[0].abs() >= AHEAD * speed[i].abs();
    if let Some(reference) = reference_area_m2.filter(|_| goes_ahead)
        && !BODY_DRAG_COEFFICIENT.contains(&(area_m2 / reference))
    {
        return Some(Finding::new(
            Severity::Warning,
            "unphysical-drag-coefficient",
            format!(
                "line {}: {load} = {f:.3e} N at {:.3} m/s on {reference:.3e} m^2 is C_D = {:.2e}: no body has such a value (shapes range from \
                 0.04 to 2.3); check the units of `{}` and of the speed, and the reference area",
                data.line.get(i).copied().unwrap_or(i + 1),
                speed[i],
                area_m2 / reference,
                data.header(load),
            ),
        ));
    }
    if DRAG_AREA_M2.contains(&area_m2) {
        return None;
    }
    let (side, yardstick) = if area_m2 > *DRAG_AREA_M2.end() {
        ("more than", "1e3 m^2; a loaded tanker has some 50 m^2")
    } else {
        ("less than", "1e-7 m^2; a wire 1 mm thick and 10 cm long has 1e-4 m^2")
    };
    Some(Finding::new(
        Severity::Warning,
        "implausible-drag-area",
        format!(
            "line {}: {load} = {f:.3e} N at {} m/s is the drag of {area_m2:.1e} m^2 (|F|/(½ρU²)), {side} {yardstick}: \
             a prefix may be wrong in the unit of `{}`, or in that of the speed",
            data.line.get(i).copied().unwrap_or(i + 1),
            if speed[i].abs() < 0.01 { format!("{:.2e}", speed[i]) } else { format!("{:.3}", speed[i]) },
            data.header(load),
        ),
    ))
}

/// Many rows at exactly the largest or smallest value of a load.
fn saturation(data: &Dataset) -> Vec<Finding> {
    let mut findings = Vec::new();
    for load in LOADS {
        let Some(f) = data.values(load) else { continue };
        for (end, extreme) in [
            ("largest", f.iter().copied().fold(f64::MIN, f64::max)),
            ("smallest", f.iter().copied().fold(f64::MAX, f64::min)),
        ] {
            let there = f.iter().filter(|&&x| x == extreme).count();
            findings.extend(saturated(load, end, extreme, there, f.len()));
        }
    }
    findings
}

/// Whether so many rows at the end of a load's range look like a saturated sensor.
pub(crate) fn saturated(load: &str, end: &str, extreme: f64, there: usize, n_rows: usize) -> Option<Finding> {
    (extreme != 0.0 && there >= 3 && there as f64 > SATURATED_SHARE * n_rows as f64).then(|| {
        let text =
            format!("{load}: {there} rows lie exactly at the {end} value {extreme}; the sensor may be saturated");
        Finding::new(Severity::Warning, "saturation", text)
    })
}

/// Angles so small that they look like radians in a column of degrees.
fn angle_in_radians(data: &Dataset) -> Option<Finding> {
    let angle = data.values("angle")?;
    in_radians(distinct_count(angle), largest(angle))
}

/// Whether so many angles up to a largest one look like radians.
pub(crate) fn in_radians(distinct: usize, largest: f64) -> Option<Finding> {
    (distinct >= 5 && largest > 0.0 && largest <= RADIAN_SUSPICION_RAD).then(|| {
        Finding::new(
            Severity::Warning,
            "angle-in-radians",
            format!(
                "all {distinct} angles lie within ±{:.3} deg: they look like radians in a column of degrees; \
                 head the column `angle [rad]` if so",
                largest.to_degrees()
            ),
        )
    })
}

/// Too few distinct speeds to distinguish a linear from a quadratic term.
fn distinct_speeds(data: &Dataset) -> Option<Finding> {
    let speed = data.values("speed")?;
    // The laws are odd in the speed: ahead and astern are one.
    few_speeds(distinct_count(&speed.iter().map(|u| u.abs()).collect::<Vec<_>>()))
}

/// Whether so many speeds are too few.
pub(crate) fn few_speeds(n: usize) -> Option<Finding> {
    (n < DISTINCT_SPEEDS_NEEDED).then(|| {
        Finding::new(
            Severity::Warning,
            "few-speeds",
            format!("{n} distinct speeds: a linear and a quadratic term cannot be distinguished with fewer than {DISTINCT_SPEEDS_NEEDED}"),
        )
    })
}

/// Only one sign of the angle: an angle offset looks exactly like C_XY_II.
fn one_sign_of_angle(data: &Dataset) -> Option<Finding> {
    let v_y = data.values("v_y")?;
    data.values("f_x")?;
    let has = |sign: f64| v_y.iter().any(|v| v * sign > 1e-9);
    (has(1.0) != has(-1.0)).then(|| {
        Finding::new(
            Severity::Warning,
            "one-sign-of-angle",
            "only one sign of the angle was run: an offset between sensor and body is indistinguishable from C_XY_II \
             (1 deg moves it by some 0.1 for two links and 0.3 for nine); run ±θ pairs and set angle_offset = \"estimate\""
                .to_owned(),
        )
    })
}

/// How many settings were repeated, which is what pure error comes from.
fn repeats(data: &Dataset) -> Option<Finding> {
    data.values("speed")?;
    let groups = repeat_groups(data);
    let repeated = distinct_usize(&groups);
    let spare = data.rows - repeated;
    (spare == 0 && data.rows >= 4).then(|| {
        Finding::new(
            Severity::Note,
            "no-repeats",
            "no setting was repeated: lack of fit cannot be distinguished from scatter".to_owned(),
        )
    })
}

/// Settings as labels: rows with the same configuration and setup, and the same motion as far as a rig repeats it.
///
/// A measured speed is never twice the same number. Values of a channel within 0.2 % of its largest belong
/// together, counted from the smallest of them, so that a fine sweep does not run together.
#[must_use]
pub fn repeat_groups(data: &Dataset) -> Vec<usize> {
    let mut keys = vec![crate::dataset::labels(&data.configuration), crate::dataset::labels(&data.setup)];
    for (name, channel) in &data.channels {
        if !is_outcome(name) {
            keys.push(within(&channel.values, REPEATS_WITHIN));
        }
    }
    let mut seen: IndexMap<Vec<usize>, usize> = IndexMap::new();
    (0..data.rows)
        .map(|i| {
            let next = seen.len();
            *seen.entry(keys.iter().map(|k| k[i]).collect()).or_insert(next)
        })
        .collect()
}

/// Channels that differ between repeats of a setting: what is measured, what counts the rows, and what follows from speed and angle.
pub(crate) fn is_outcome(name: &str) -> bool {
    LOADS.contains(&name)
        || name.starts_with("std_")
        || name.starts_with("zero_")
        || matches!(name, "repeat" | "run" | "time" | "temperature" | "density" | "kinematic_viscosity" | "v_x" | "v_y")
}

/// Labels of values that lie within a part of the largest from the smallest of their group.
pub(crate) fn within(values: &[f64], part: f64) -> Vec<usize> {
    let width = part * values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut out = vec![0; values.len()];
    let (mut label, mut first) = (0, order.first().map_or(0.0, |&i| values[i]));
    for i in order {
        if values[i] > first + width {
            label += 1;
            first = values[i];
        }
        out[i] = label;
    }
    out
}

/// Volumes of the configurations that do not grow by one link's volume a link.
fn volumes(body: &BodySpec) -> Vec<Finding> {
    let mut points: Vec<(f64, f64)> = body
        .volumes
        .iter()
        .filter_map(|(name, v)| froude_records::table::links_of_configuration(name).map(|k| (f64::from(k), *v)))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    volume_steps(&points, body.link_volume_m3)
}

/// The same for a `volume` channel of the table.
fn volume_channel(data: &Dataset, link_m3: Option<f64>) -> Vec<Finding> {
    let (Some(k), Some(v)) = (data.values("n_links"), data.values("volume")) else { return Vec::new() };
    let mut points: Vec<(f64, f64)> = k.iter().copied().zip(v.iter().copied()).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup();
    volume_steps(&points, link_m3)
}

/// Steps of volume between configurations against their median and the stated link.
fn volume_steps(points: &[(f64, f64)], link_m3: Option<f64>) -> Vec<Finding> {
    let steps: Vec<(f64, f64)> = points
        .windows(2)
        .filter(|w| w[1].0 > w[0].0)
        .map(|w| (w[1].0, (w[1].1 - w[0].1) / (w[1].0 - w[0].0)))
        .collect();
    if steps.len() < 3 {
        return Vec::new();
    }
    let mut sorted: Vec<f64> = steps.iter().map(|s| s.1).collect();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let mut findings = Vec::new();
    let odd: Vec<String> = steps
        .iter()
        .filter(|(_, step)| (step - median).abs() > VOLUME_STEP_TOLERANCE * median.abs())
        .map(|(k, step)| format!("{step:.4e} m^3 to k = {k}"))
        .collect();
    if !odd.is_empty() {
        findings.push(Finding::new(
            Severity::Warning,
            "volumes-do-not-add-up",
            format!(
                "the volume grows by {median:.4e} m^3 a link (median), but by {}: these configurations are not the same body with one more link",
                odd.join(", ")
            ),
        ));
    }
    if let Some(link) = link_m3
        && (link - median).abs() > VOLUME_STEP_TOLERANCE * median
    {
        findings.push(Finding::new(
            Severity::Warning,
            "link-volume",
            format!(
                "a link displaces {link:.4e} m^3 on its own, but the body grows by {median:.4e} m^3 a link: joints overlap, \
                 or the coefficient's reference volume is not the link's"
            ),
        ));
    }
    findings
}

/// A drag coefficient on a stated frontal area that no body has.
///
/// `d_n_s2_m2` is the quadratic coefficient D of F = D·v|v|; C_D = D/(½ρA).
///
/// Density in kg/m³, area in m². Range of known shapes 0.04 to 2.3, here with a factor of two.
///
/// # Source
///
/// Hoerner (1965), Fluid-dynamic drag, ch. 3.
#[must_use]
pub fn drag_coefficient(name: &str, d_n_s2_m2: f64, density_kg_m3: f64, area_m2: f64) -> Option<Finding> {
    let c_d = d_n_s2_m2 / (0.5 * density_kg_m3 * area_m2);
    (!BODY_DRAG_COEFFICIENT.contains(&c_d)).then(|| {
        Finding::new(
            Severity::Warning,
            "unphysical-drag-coefficient",
            format!(
                "{name} = {d_n_s2_m2:.4} N s^2/m^2 on {area_m2:.4} m^2 is C_D = {c_d:.4}: no body has such \
                 a value (shapes range from 0.04 to 2.3); check the unit of {name} and the reference area"
            ),
        )
    })
}

/// Step of a value, a thousandth of the largest of its channel.
pub(crate) fn step_of(value: f64, largest: f64) -> i64 {
    (value / largest.max(f64::MIN_POSITIVE) * 1e3).round() as i64
}

fn distinct_count(values: &[f64]) -> usize {
    // Settings are typed with few digits; a part in 10⁶ of the largest separates them.
    let scale = values.iter().fold(0.0_f64, |m, v| m.max(v.abs())).max(f64::MIN_POSITIVE);
    let mut sorted: Vec<i64> = values.iter().map(|v| step_of(*v, scale)).collect();
    sorted.sort_unstable();
    sorted.dedup();
    sorted.len()
}

fn distinct_usize(labels: &[usize]) -> usize {
    let texts: Vec<String> = labels.iter().map(usize::to_string).collect();
    distinct(&texts).len()
}
