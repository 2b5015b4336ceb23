//! What is doubtful about the observations, before and after the fit.
//!
//! A lint changes nothing except that identical copies are dropped, and says so.
//! Every limit is a constant with its reason.

pub(crate) mod counts;
pub(crate) mod motion;
pub mod repeats;
mod volumes;

use froude_records::campaign::Campaign;
use froude_records::finding::{Finding, Severity};
use froude_records::plausible::AIR_KG_M3;

use crate::dataset::Dataset;
use crate::law::ForceLaw;
use crate::lint::counts::Counts;
use crate::lint::motion::moving;
use crate::lint::repeats::{AHEAD, repeats};
use crate::lint::volumes::{volume_channel, volumes};
use crate::source::models::Drift;

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

/// The fastest towing carriages run 20 to 30 m/s; a model that is said to go faster was typed in another unit.
const FASTEST_M_S: f64 = 40.0;
/// The same of air: at Mach 0.3 its compressibility moves pressures by 5 % (Prandtl and Glauert, 1/√(1 − M²)), and no law here knows of it.
const FASTEST_IN_AIR_M_S: f64 = 100.0;

/// Every lint that looks at observations alone.
///
/// A finding for each doubt; an empty list says that none of these checks found anything.
#[must_use]
pub fn observations(data: &Dataset, campaign: &Campaign, laws: &[ForceLaw]) -> Vec<Finding> {
    of_counted(&Counts::of(data), data, campaign, laws)
}

/// The same of rows that were counted before; `data` has all of them, or those at the ends of their ranges.
pub(crate) fn of_counted(counts: &Counts, data: &Dataset, campaign: &Campaign, laws: &[ForceLaw]) -> Vec<Finding> {
    let mut findings = counts.findings(data, laws);
    findings.extend(one_drift(data, laws));
    findings.extend(repeats(data));
    findings.extend(implausible_speed(data));
    findings.extend(drag_area(data, campaign.body.as_ref().and_then(|b| b.reference_area_m2)));
    findings.extend(one_sign_of_angle(data).filter(|_| laws.iter().any(has_cross_term)));
    if let Some(body) = &campaign.body {
        findings.extend(volumes(body));
    }
    findings.extend(volume_channel(data, campaign.body.as_ref().and_then(|b| b.link_volume_m3)));
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
            format!("{}: {:.1} m/s is faster {than}; check the unit of the speed", data.row_name(i), speed[i].abs()),
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
        .filter(|load| data.is_of_water(load))
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
                "{}: {load} = {f:.3e} N at {:.3} m/s on {reference:.3e} m^2 is C_D = {:.2e}: no body has such a value (shapes range from \
                 0.04 to 2.3); check the units of `{}` and of the speed, and the reference area",
                data.row_name(i),
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
            "{}: {load} = {f:.3e} N at {} m/s is the drag of {area_m2:.1e} m^2 (|F|/(½ρU²)), {side} {yardstick}: \
             a prefix may be wrong in the unit of `{}`, or in that of the speed",
            data.row_name(i),
            if speed[i].abs() < 0.01 { format!("{:.2e}", speed[i]) } else { format!("{:.3}", speed[i]) },
            data.header(load),
        ),
    ))
}

/// Rows that move askew at one speed, or at one magnitude of the angle: terms of the built-in laws that have nearly one shape there.
fn one_drift(data: &Dataset, laws: &[ForceLaw]) -> Option<Finding> {
    let built_in = laws.iter().find(|law| matches!(law.name.as_str(), "quadratic" | "linear_quadratic"))?;
    let stands = |across: &str, letter: &str| {
        let drift = Drift::of(data, "v_x", across);
        let axis = across.trim_start_matches("v_");
        let v = if axis == "y" { "v" } else { "w" };
        let uv = format!("{letter}_u{v}");
        // Of a force across the body the other terms are those of its drag.
        let is_force = matches!(letter, "Y" | "Z");
        let [linear, square] = if is_force {
            ["I", "II"].map(|of| format!("D_{axis}_{of}"))
        } else {
            [v.to_owned(), format!("{v}{v}")].map(|of| format!("{letter}_{of}"))
        };
        let is_there = drift.is_askew && built_in.position(&uv).is_some();
        let mut also = Vec::new();
        if drift.is_of_one_speed {
            also.push(linear);
        }
        if drift.is_at_one_angle {
            also.push(square);
        }
        (is_there && !also.is_empty()).then(|| format!("{uv} includes {}", also.join(" and ")))
    };
    let all: Vec<String> = [("v_y", "Y"), ("v_y", "N"), ("v_z", "Z"), ("v_z", "M")]
        .into_iter()
        .filter_map(|(across, letter)| stands(across, letter))
        .collect();
    (!all.is_empty()).then(|| {
        let text = format!(
            "all rows with drift have the same speed or the same magnitude of the angle, so some terms cannot be separated: {}; these values hold only there; run other speeds or \
             angles to separate the terms",
            all.join("; ")
        );
        Finding::new(Severity::Note, "one-drift", text)
    })
}

/// Whether a law has the cross term of f1 to f6 that an offset of the angle looks like.
fn has_cross_term(law: &ForceLaw) -> bool {
    law.coefficients.iter().any(|c| c.name.starts_with("C_XY"))
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
