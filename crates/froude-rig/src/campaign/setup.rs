//! From the `[rig]` section to a configured controller and, for a twin, to the plant behind it.
//!
//! The controller receives what the campaign declares; the twin has its own truth ([`crate::parameters`]), of which `[rig.twin]`
//! overrides what it names. The two differ as they do in a laboratory: the gear's efficiency, for instance, is in the truth and in
//! no declared friction.

use crate::carriage::{AxisSpec, CarriageCampaign, RigKind, TwinTruth};
use froude_control::config::{AxisConfig, Config, ConfigError, Drive, Gains, Limits};
use froude_records::RecordError;
use froude_records::nearest::suggestion;
use froude_records::run::{AxisConstants, Declared};
use froude_records::units::parse_unit;

use crate::defaults::control_config;
use crate::force_sensor::Drift;
use crate::load::{Load, Strut};
use crate::parameters::AxisParameters;
use crate::twin::{TICK_US, TwinConfig};

/// End switches open this far before the hard stops, m.
const SWITCH_MARGIN_M: f64 = 0.05;
/// The part of declared friction that a coast distance may count on, where no standard uncertainty is declared.
const SURE_FRICTION: f64 = 0.85;

/// How long the sensor's zero remembers, s.
const SENSOR_DRIFT_S: f64 = 300.0;

/// Why a rig cannot be set up.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// Something of the file is wrong.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A constant is missing without which nothing may move.
    #[error("{place}: `{key}` is missing: {why}")]
    Missing {
        /// The axis's section.
        place: String,
        /// The key.
        key: &'static str,
        /// What it is needed for.
        why: &'static str,
    },
}

/// The controller's configuration from the campaign's declarations. `towed_kg` is the most that a body, its water and its added
/// mass may weigh: it lengthens the coast. No drag is fed forward, since the body is dry or wet from run to run.
///
/// # Errors
///
/// [`SetupError::Missing`]: inertia and Coulomb friction must be declared, the coast distance depends on them.
pub fn control(campaign: &CarriageCampaign, towed_kg: f64) -> Result<Config, SetupError> {
    let standard = control_config(&[Load::default(); 2]);
    let [_, short] = standard.axes;
    let y = axis(&campaign.rig.y, towed_kg)?;
    let x = campaign.rig.x.as_ref().map_or(Ok(short), |x| axis(x, towed_kg))?;
    Ok(Config { axes: [y, x], tick_us: TICK_US, ..standard })
}

fn axis(spec: &AxisSpec, towed_kg: f64) -> Result<AxisConfig, SetupError> {
    let missing = |key, why| SetupError::Missing { place: spec.place.to_string(), key, why };
    let coast = "the coast distance, and with it the permitted motion, depends on it; take it from `froude carriage identify`, or declare a \
                 lower bound with a large `standard`";
    let inertia = spec.inertia_kg_m2.ok_or_else(|| missing("inertia", coast))?;
    let coulomb = spec.coulomb_n_m.ok_or_else(|| missing("coulomb_friction", coast))?;
    let (constants, limits, gains) = (&spec.constants, &spec.limits, &spec.gains);
    let chain_m = constants.sprocket_radius_m.value / constants.gear_ratio.value;
    let efficiency = constants.efficiency_forward.map_or(1.0, |e| e.value);
    Ok(AxisConfig {
        gains: Gains {
            proportional_v_rad: gains.proportional_v_rad,
            derivative_v_s_rad: gains.derivative_v_s_rad,
            integral_v_rad_s: gains.integral_v_rad_s,
            derivative_filter_hz: gains.derivative_filter_hz.unwrap_or(300.0),
        },
        drive: Drive {
            inertia_kg_m2: inertia.value,
            coast_inertia_kg_m2: inertia.value
                + 1.96 * inertia.standard_uncertainty
                + towed_kg * chain_m * chain_m / efficiency,
            viscous_n_m_s_rad: spec.viscous_n_m_s_rad.map_or(0.0, |b| b.value),
            viscous_lower_n_m_s_rad: spec.viscous_n_m_s_rad.map_or(0.0, sure),
            coulomb_n_m: coulomb.value,
            coulomb_lower_n_m: sure(coulomb),
            held_band: held_band(constants),
            drag_n_s2_m2: 0.0,
            torque_constant_n_m_a: constants.torque_constant_n_m_a.value,
            amplifier_a_v: constants.amplifier_a_v.value,
            gear_ratio: constants.gear_ratio.value,
            sprocket_radius_m: constants.sprocket_radius_m.value,
            counts_per_revolution: constants.counts_per_revolution.abs(),
            encoder_sign: constants.counts_per_revolution.signum(),
        },
        limits: Limits {
            hard_low_m: spec.travel_m[0],
            hard_high_m: spec.travel_m[1],
            low_switch_m: spec.travel_m[0] + SWITCH_MARGIN_M,
            high_switch_m: spec.travel_m[1] - SWITCH_MARGIN_M,
            speed_m_s: limits.speed_m_s,
            unhomed_speed_m_s: limits.unhomed_speed_m_s.unwrap_or(0.018),
            acceleration_m_s2: limits.acceleration_m_s2,
            command_v: limits.command_v,
            current_a: limits.current_a,
            continuous_current_a: limits.continuous_current_a.unwrap_or(0.5 * limits.current_a),
            thermal_time_s: limits.thermal_time_s.unwrap_or(20.0),
            following_error_m: limits.following_error_m.unwrap_or(0.01),
            saturation_s: 0.03,
            encoder_errors_per_s: 10,
            polarity_m: 0.005,
            stuck_s: 0.05,
        },
        mode_hz: gains.shaped_mode_hz.unwrap_or(0.0),
        mode_damping: gains.shaped_damping.unwrap_or(0.0),
        is_robust_shaper: gains.is_robust_shaper,
    })
}

/// Keys of `[rig.y]` behind the controller's names, with the unit of the numbers.
const KEYS: [(&str, &str, &str); 33] = [
    ("gains.proportional_v_rad", "controller.proportional", " V/rad"),
    ("gains.derivative_v_s_rad", "controller.derivative", " V s/rad"),
    ("gains.integral_v_rad_s", "controller.integral", " V/(rad s)"),
    ("gains.derivative_filter_hz", "controller.derivative_filter", " Hz"),
    ("drive.inertia_kg_m2", "inertia", " kg m^2"),
    ("drive.coast_inertia_kg_m2", "inertia with the body's", " kg m^2"),
    ("drive.viscous_n_m_s_rad", "viscous_friction", " N m s"),
    ("drive.viscous_lower_n_m_s_rad", "viscous_friction, its lower end,", " N m s"),
    ("drive.coulomb_n_m", "coulomb_friction", " N m"),
    ("drive.coulomb_lower_n_m", "coulomb_friction, its lower end,", " N m"),
    ("drive.held_band", "efficiency", ""),
    ("drive.torque_constant_n_m_a", "torque_constant", " N m/A"),
    ("drive.amplifier_a_v", "amplifier", " A/V"),
    ("drive.gear_ratio", "gear_ratio", ""),
    ("drive.sprocket_radius_m", "sprocket_radius", " m"),
    ("drive.counts_per_revolution", "counts_per_revolution", ""),
    ("limits.hard_low_m", "travel", " m"),
    ("limits.hard_high_m", "travel", " m"),
    ("limits.low_switch_m", "travel, the low end switch 50 mm inside it,", " m"),
    ("limits.high_switch_m", "travel, the high end switch 50 mm inside it,", " m"),
    ("limits.speed_m_s", "speed_limit", " m/s"),
    ("limits.unhomed_speed_m_s", "unhomed_speed_limit", " m/s"),
    ("limits.acceleration_m_s2", "acceleration_limit", " m/s^2"),
    ("limits.command_v", "command_limit", " V"),
    ("limits.current_a", "current_limit", " A"),
    ("limits.continuous_current_a", "continuous_current_limit", " A"),
    ("limits.thermal_time_s", "thermal_time", " s"),
    ("limits.following_error_m", "following_error_limit", " m"),
    ("mode_hz", "controller.shaped_mode", " Hz"),
    ("mode_damping", "controller.shaped_damping", ""),
    ("tick_us", "the tick", " µs"),
    ("late_us", "the late tick", " µs"),
    ("host_silence_us", "the host's silence", " µs"),
];

/// Why the controller does not take a configuration, in the campaign's words: the section, and the sentence with the key to change.
#[must_use]
pub fn in_words(error: &ConfigError, control: &Config) -> (String, String) {
    let section = |axis: usize| ["[rig.y]", "[rig.x]"].get(axis).map_or("[rig]", |s| s).to_owned();
    match *error {
        ConfigError::OutOfRange { axis, quantity, found, low, high } => {
            let (key, unit) = KEYS.iter().find(|k| k.0 == quantity).map_or((quantity, ""), |k| (k.1, k.2));
            (section(axis), format!("{key} is {found}{unit}; the controller accepts {low}{unit} to {high}{unit}"))
        }
        ConfigError::NoFriction { axis } => (
            section(axis),
            "coulomb_friction may be zero within its `standard`: without friction no coast distance is known. Measure it, or declare a \
             smaller `standard`"
                .to_owned(),
        ),
        ConfigError::SwitchTooClose { axis, end, room_m, needed_m } => {
            let asked_m_s = control.axes.get(axis).map_or(f64::NAN, |a| a.limits.unhomed_speed_m_s);
            (
                section(axis),
                format!(
                    "unhomed_speed_limit is {asked_m_s} m/s; from a fault at that speed the axis coasts up to {needed_m:.3} m, and the {end} end \
                     switch opens {room_m:.3} m before its hard stop. Write unhomed_speed_limit = \"{} m/s\" or less",
                    unhomed_that_fits(axis, control)
                ),
            )
        }
        ConfigError::TooWeak { axis, needed_v, available_v } => (
            section(axis),
            format!(
                "acceleration_limit takes {needed_v:.2} V, and command_limit and current_limit allow {available_v:.2} V: lower \
                 acceleration_limit"
            ),
        ),
        ConfigError::NoTravel { axis, low_m, high_m } => (
            section(axis),
            format!(
                "travel leaves nothing between its soft limits at {low_m:.3} and {high_m:.3} m, which lie 50 mm and following_error_limit \
                 inside its ends: check travel, or lower following_error_limit"
            ),
        ),
        _ => ("[rig]".to_owned(), error.to_string()),
    }
}

/// The largest speed before homing, in millimetres a second, from which the axis coasts to rest between switch and hard stop.
fn unhomed_that_fits(axis: usize, control: &Config) -> f64 {
    let fits = |mm_s: u32| {
        let mut slower = *control;
        if let Some(config) = slower.axes.get_mut(axis) {
            config.limits.unhomed_speed_m_s = 1e-3 * f64::from(mm_s);
        }
        !matches!(slower.check(), Err(ConfigError::SwitchTooClose { axis: other, .. }) if other == axis)
    };
    let asked_m_s = control.axes.get(axis).map_or(0.0, |a| a.limits.unhomed_speed_m_s);
    let fastest = (1..=(1e3 * asked_m_s) as u32).take_while(|&mm_s| fits(mm_s)).last();
    f64::from(fastest.unwrap_or(1)) / 1e3
}

/// What of a declared friction a coast distance may count on: the lower end of its 95 % interval, at least a tenth.
fn sure(friction: Declared) -> f64 {
    if friction.standard_uncertainty > 0.0 {
        (friction.value - 1.96 * friction.standard_uncertainty).max(0.1 * friction.value)
    } else {
        SURE_FRICTION * friction.value
    }
}

/// 1 − η η_b with both efficiencies at the lower end of what is declared: a stuck encoder is found later, a held weight never taken for
/// one. 0 where the gear's losses are not declared.
fn held_band(constants: &AxisConstants) -> f64 {
    let lowest = |e: Declared| (e.value - 1.96 * e.standard_uncertainty).max(0.0);
    match (constants.efficiency_forward, constants.efficiency_backward) {
        (Some(forward), Some(backward)) => 1.0 - (lowest(forward) * lowest(backward)).min(1.0),
        _ => 0.0,
    }
}

/// The twin behind the campaign: the paper's rig with the campaign's travel, body and overriding truths.
///
/// `body` is the load's base (its mounting changes from run to run).
///
/// # Errors
///
/// An unknown truth (with the nearest name), or one of another dimension, at its place.
pub fn twin(campaign: &CarriageCampaign, mut body: Load) -> Result<(TwinConfig, Load), SetupError> {
    let mut config = TwinConfig::loaded(body);
    if let Some(sensor) = &campaign.rig.force_sensor {
        let f = &mut config.force_sensor;
        f.range_n = sensor.range_n.unwrap_or(f.range_n);
        f.step_n = sensor.resolution_n.unwrap_or(f.step_n);
        f.noise_n = sensor.noise_n.unwrap_or(f.noise_n);
        if let Some(drift_n) = sensor.drift_n {
            // As wide as the uniform one, and slow: it moves within a run too.
            f.drift = Drift::Walk(drift_n / 3.0_f64.sqrt(), SENSOR_DRIFT_S);
        }
    }
    for (i, spec) in [Some(&campaign.rig.y), campaign.rig.x.as_ref()].into_iter().enumerate() {
        if let Some(spec) = spec {
            let p = &mut config.axes[i].parameters;
            [p.hard_low_m, p.hard_high_m] = spec.travel_m;
            p.switch_margin_m = SWITCH_MARGIN_M;
            config.axes[i].start_m = spec.travel_m[0] + 0.1 * (spec.travel_m[1] - spec.travel_m[0]);
        }
    }
    if let RigKind::Twin { truths, .. } = &campaign.rig.kind {
        for truth in truths {
            apply(truth, &mut config, &mut body)?;
        }
    }
    for axis in &mut config.axes {
        axis.load = body;
    }
    Ok((config, body))
}

/// One truth: its name, its unit, and where it goes.
type Entry = (&'static str, &'static str, fn(&mut TwinConfig, &mut Load, f64));

fn both(config: &mut TwinConfig, change: impl Fn(&mut AxisParameters)) {
    config.axes.iter_mut().for_each(|a| change(&mut a.parameters));
}

/// Everything that `[rig.twin]` may say.
const TRUTHS: [Entry; 17] = [
    ("drag", "N s^2/m^2", |_, l, v| l.body.drag_n_s2_m2 = v),
    ("added_mass", "kg", |_, l, v| l.body.added_mass_kg = v),
    ("body_mass", "kg", |_, l, v| l.body.mass_kg = v),
    ("body_water", "kg", |_, l, v| l.body.body_water_kg = v),
    ("displaced_volume", "m^3", |_, l, v| l.body.displaced_m3 = v),
    ("water_density", "kg/m^3", |_, l, v| l.density_kg_m3 = v),
    ("pulley_friction", "1", |_, l, v| l.hung.pulley_friction = v),
    // Written, it is in the water with the body and hangs below the sensor: every method measures it along.
    ("strut_drag", "N s^2/m^2", |c, l, v| {
        (l.strut, l.is_strut_below_sensor) = (Strut::WithBody, true);
        both(c, |p| p.strut_drag_n_s2_m2 = v);
    }),
    ("friction_bump", "1", |c, _, v| both(c, |p| p.bump = v)),
    ("friction_asymmetry", "1", |c, _, v| both(c, |p| p.asymmetry = v)),
    ("rolling_coefficient", "1", |c, _, v| both(c, |p| p.rolling_coefficient = v)),
    ("efficiency", "1", |c, _, v| both(c, |p| p.efficiency_forward = v)),
    ("efficiency_backward", "1", |c, _, v| both(c, |p| p.efficiency_backward = v)),
    ("friction_run_to_run", "1", |c, _, v| c.spread.friction_run = v),
    ("friction_noise", "N", |c, _, v| c.spread.friction_noise_n = v),
    ("friction_noise_time", "s", |c, _, v| c.spread.friction_noise_s = v),
    ("torque_constant_run_to_run", "1", |c, _, v| c.spread.torque_constant_run = v),
];

fn apply(truth: &TwinTruth, config: &mut TwinConfig, body: &mut Load) -> Result<(), SetupError> {
    let bad = |problem: String| RecordError::Syntax { place: truth.place.clone(), problem };
    let Some((_, unit, set)) = TRUTHS.iter().find(|(name, _, _)| *name == truth.name) else {
        let known = TRUTHS.iter().map(|t| t.0);
        let names: Vec<&str> = known.collect();
        let advice = suggestion(&truth.name, names.iter().copied());
        return Err(bad(format!("the twin has no truth `{}`; {advice}", truth.name)).into());
    };
    let dimension = parse_unit(unit).map_err(|e| bad(e.to_string()))?.dimension;
    let value = truth.quantity.expect(dimension).map_err(|e| bad(format!("`{}`: {e}", truth.name)))?;
    set(config, body, value);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::carriage::declared;

    /// The load of the example's twin with a truth more.
    fn of_the_example(truth: &str) -> Load {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/towing-carriage/campaign.toml");
        let text =
            std::fs::read_to_string(path).unwrap().replace("pulley_friction", &format!("{truth}\npulley_friction"));
        let campaign = froude_records::campaign_file::parse_campaign(std::path::Path::new("c.toml"), &text).unwrap();
        twin(&declared(&campaign).unwrap().unwrap(), Load::default()).unwrap().1
    }

    #[test]
    fn a_strut_that_is_written_is_in_the_water_and_one_that_is_not_is_out() {
        assert_eq!(of_the_example("").strut, Strut::Out);
        assert_eq!(of_the_example("strut_drag = \"2 N s^2/m^2\"").strut, Strut::WithBody);
    }
}
