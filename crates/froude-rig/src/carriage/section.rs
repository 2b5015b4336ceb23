//! `[rig]` and `[carriage]` of the campaign's TOML.

use froude_records::RecordError;
use froude_records::campaign::Campaign;
use froude_records::run::{AMPLIFIER, Axis, AxisConstants, Declared, TORQUE_CONSTANT, positive_declared};
use froude_records::section::{Section, Value, found};
use froude_records::section_values::{MOST_RUNS, at_most, count, one_of, series};
use froude_records::units::Dimension;

use super::{
    AxisSpec, Calibration, CarriageCampaign, CarriagePlan, Directions, ForceSensorSpec, FrictionSweep, GainsSpec,
    LimitsSpec, Order, PulseTrain, RigKind, RigSpec, TwinTruth, WarmUp,
};

/// V s, of the derivative gain: radians are pure numbers.
const VOLT_SECOND: Dimension = Dimension { m: 2, kg: 1, s: -2, k: 0, a: -1 };
/// V/s, of the integral gain.
const VOLT_PER_SECOND: Dimension = Dimension { m: 2, kg: 1, s: -4, k: 0, a: -1 };
/// kg m².
const INERTIA: Dimension = Dimension::new(2, 1, 0);
/// N m s.
const VISCOUS: Dimension = Dimension::new(2, 1, -1);
/// N s²/m² = kg/m.
const DRAG: Dimension = Dimension::new(-1, 1, 0);
/// m/s³.
const JERK: Dimension = Dimension::new(1, 0, -3);

/// What a campaign drives, by its `[rig]` and `[carriage]`; `None` where it has neither.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn declared(campaign: &Campaign) -> Result<Option<CarriageCampaign>, RecordError> {
    let Some(root) = campaign.root() else { return Ok(None) };
    let plan = root.section("carriage")?.map(|s| plan(&s)).transpose()?;
    let Some(section) = root.section("rig")? else {
        return match plan {
            None => Ok(None),
            Some(_) => Err(root
                .missing("rig", "[carriage] states what to do; [rig] states with what: kind = \"twin\", for example")),
        };
    };
    Ok(Some(CarriageCampaign { rig: rig(&section)?, plan }))
}

fn rig(s: &Section<'_>) -> Result<RigSpec, RecordError> {
    s.only(&["kind", "seed", "port", "baud", "log_rate", "y", "x", "force_sensor", "twin"])?;
    let is_twin = one_of(s, "kind", &["twin", "serial"], &[true, false])?
        .ok_or_else(|| s.missing("kind", "write kind = \"twin\" or kind = \"serial\""))?;
    let (own, foreign): (_, &[&'static str]) =
        if is_twin { ("twin", &["port", "baud"]) } else { ("serial", &["seed", "twin"]) };
    for key in foreign {
        if let Some(value) = s.get(key) {
            return Err(s.wrong(key, value, format!("does not belong to a rig of kind {own:?}; take it out")));
        }
    }
    let kind = if is_twin {
        let seed = s
            .integer("seed")?
            .ok_or_else(|| s.missing("seed", "write seed = 1, for example; the same seed gives the same runs"))?;
        let mut truths = Vec::new();
        if let Some(twin) = s.section("twin")? {
            twin_truths(&twin, "", &mut truths)?;
        }
        RigKind::Twin { seed, truths }
    } else {
        let port =
            s.text("port")?.ok_or_else(|| s.missing("port", "write port = \"/dev/ttyUSB0\", for example"))?.to_owned();
        let baud = count(s, "baud", 100_000_000)?.map_or(3_000_000, |baud| baud as u32);
        RigKind::Serial { port, baud }
    };
    let y = s
        .section("y")?
        .ok_or_else(|| s.missing("y", "describe the long axis in [rig.y]: travel, limits, drive, controller"))?;
    Ok(RigSpec {
        kind,
        log_rate_hz: s.positive("log_rate", Dimension::ANGULAR_SPEED)?.unwrap_or(4000.0),
        y: axis(&y)?,
        x: s.section("x")?.map(|s| axis(&s)).transpose()?,
        force_sensor: s.section("force_sensor")?.map(|s| force_sensor(&s)).transpose()?,
        place: s.place(),
    })
}

/// Quantities by name, tables inside joined by dots.
fn twin_truths(s: &Section<'_>, prefix: &str, out: &mut Vec<TwinTruth>) -> Result<(), RecordError> {
    for (key, offset, value) in s.entries() {
        let name = format!("{prefix}{key}");
        if value.get_ref().is_table() {
            twin_truths(&s.as_section(key, value)?, &format!("{name}."), out)?;
        } else {
            out.push(TwinTruth { name, quantity: s.as_quantity(key, value)?, place: s.source.place(offset) });
        }
    }
    Ok(())
}

fn axis(s: &Section<'_>) -> Result<AxisSpec, RecordError> {
    s.only(&[
        "travel",
        "speed_limit",
        "unhomed_speed_limit",
        "acceleration_limit",
        "command_limit",
        "current_limit",
        "continuous_current_limit",
        "thermal_time",
        "following_error_limit",
        "torque_constant",
        "amplifier",
        "gear_ratio",
        "sprocket_radius",
        "counts_per_revolution",
        "efficiency",
        "efficiency_backward",
        "inertia",
        "viscous_friction",
        "coulomb_friction",
        "controller",
    ])?;
    let limit = |key, dimension, advice: &str| s.positive(key, dimension)?.ok_or_else(|| s.missing(key, advice));
    let limits = LimitsSpec {
        speed_m_s: limit("speed_limit", Dimension::SPEED, "write the largest speed, \"0.7 m/s\", for example")?,
        unhomed_speed_m_s: s.positive("unhomed_speed_limit", Dimension::SPEED)?,
        acceleration_m_s2: limit("acceleration_limit", Dimension::ACCELERATION, "write \"1 m/s^2\", for example")?,
        command_v: limit(
            "command_limit",
            Dimension::VOLTAGE,
            "write the amplifier's input range, \"10 V\", for example",
        )?,
        current_a: limit(
            "current_limit",
            Dimension::CURRENT,
            "write the motor's peak current, \"3.5 A\", for example",
        )?,
        continuous_current_a: s.positive("continuous_current_limit", Dimension::CURRENT)?,
        thermal_time_s: duration(s, "thermal_time")?,
        following_error_m: s.positive("following_error_limit", Dimension::LENGTH)?,
    };
    let constant = |key, dimension, advice: &str| {
        let constant = positive_declared(s, key, dimension)?;
        constant.ok_or_else(|| {
            s.missing(key, &format!("write {key} = {{ value = \"{advice}\", standard = \"1 %\" }}, for example"))
        })
    };
    let constants = AxisConstants {
        torque_constant_n_m_a: constant("torque_constant", TORQUE_CONSTANT, "26.7e-3 N m/A")?,
        amplifier_a_v: constant("amplifier", AMPLIFIER, "0.352 A/V")?,
        gear_ratio: constant("gear_ratio", Dimension::ONE, "34.97 1")?,
        sprocket_radius_m: constant("sprocket_radius", Dimension::LENGTH, "55 mm")?,
        counts_per_revolution: s.number("counts_per_revolution")?.ok_or_else(|| {
            s.missing("counts_per_revolution", "write 4000 for 1000 lines decoded fourfold, per turn of the motor")
        })?,
        efficiency_forward: efficiency(s, "efficiency")?,
        efficiency_backward: efficiency(s, "efficiency_backward")?,
        is_calibrated: false,
    };
    if let (true, Some(value)) = (constants.counts_per_revolution == 0.0, s.get("counts_per_revolution")) {
        return Err(s.wrong(
            "counts_per_revolution",
            value,
            "is zero; write 4000 for 1000 lines decoded fourfold, -4000 where the encoder counts backwards",
        ));
    }
    let controller = s.section("controller")?;
    let controller = controller.ok_or_else(|| {
        s.missing("controller", "write the gains: proportional, derivative and integral, in V and rad")
    })?;
    Ok(AxisSpec {
        travel_m: travel(s)?,
        limits,
        constants,
        inertia_kg_m2: positive_declared(s, "inertia", INERTIA)?,
        viscous_n_m_s_rad: positive_declared(s, "viscous_friction", VISCOUS)?,
        coulomb_n_m: positive_declared(s, "coulomb_friction", Dimension::MOMENT)?,
        gains: gains(&controller)?,
        place: s.place(),
    })
}

fn efficiency(s: &Section<'_>, key: &'static str) -> Result<Option<Declared>, RecordError> {
    match (positive_declared(s, key, Dimension::ONE)?, s.get(key)) {
        (Some(efficiency), Some(value)) if efficiency.value > 1.0 => {
            Err(s.wrong(key, value, format!("is {}; an efficiency is at most 1, or 100 %", efficiency.value)))
        }
        (efficiency, _) => Ok(efficiency),
    }
}

/// `["0 m", "5 m"]`.
fn travel(s: &Section<'_>) -> Result<[f64; 2], RecordError> {
    let value =
        s.get("travel").ok_or_else(|| s.missing("travel", "write the hard stops, travel = [\"0 m\", \"5 m\"]"))?;
    let ends = match value.get_ref().as_array().map(|list| list.iter().collect::<Vec<_>>()).as_deref() {
        Some([low, high]) => [low, high].map(|end| s.as_quantity_of("travel", end, Dimension::LENGTH)),
        _ => {
            return Err(s.wrong(
                "travel",
                value,
                format!("is {}; expected the two hard stops, [\"0 m\", \"5 m\"]", found(value)),
            ));
        }
    };
    let [low, high] = ends;
    let (low, high) = (low?, high?);
    if low >= high {
        return Err(s.wrong(
            "travel",
            value,
            format!("goes from {low} m to {high} m; the first hard stop is the lower one"),
        ));
    }
    Ok([low, high])
}

fn gains(s: &Section<'_>) -> Result<GainsSpec, RecordError> {
    s.only(&[
        "proportional",
        "derivative",
        "integral",
        "derivative_filter",
        "shaped_mode",
        "shaped_damping",
        "robust_shaper",
    ])?;
    let gain = |key, dimension, example: &str| {
        let value = s.get(key).ok_or_else(|| s.missing(key, &format!("write {key} = \"{example}\", for example")))?;
        let gain = s.as_quantity_of(key, value, dimension)?;
        if gain < 0.0 {
            Err(s.wrong(key, value, format!("is {}; it must not be negative", found(value))))
        } else {
            Ok(gain)
        }
    };
    Ok(GainsSpec {
        proportional_v_rad: gain("proportional", Dimension::VOLTAGE, "2 V/rad")?,
        derivative_v_s_rad: gain("derivative", VOLT_SECOND, "0.2 V s/rad")?,
        integral_v_rad_s: gain("integral", VOLT_PER_SECOND, "2 V/(rad s)")?,
        derivative_filter_hz: s.positive("derivative_filter", Dimension::ANGULAR_SPEED)?,
        shaped_mode_hz: s.positive("shaped_mode", Dimension::ANGULAR_SPEED)?,
        shaped_damping: s.quantity("shaped_damping", Dimension::ONE)?,
        is_robust_shaper: s.flag("robust_shaper")?.unwrap_or(false),
    })
}

fn force_sensor(s: &Section<'_>) -> Result<ForceSensorSpec, RecordError> {
    s.only(&["range", "resolution", "noise", "drift", "gain_standard"])?;
    Ok(ForceSensorSpec {
        range_n: s.positive("range", Dimension::FORCE)?,
        resolution_n: s.positive("resolution", Dimension::FORCE)?,
        noise_n: s.positive("noise", Dimension::FORCE)?,
        drift_n: s.positive("drift", Dimension::FORCE)?,
        gain_standard: fraction(s, "gain_standard", "the standard uncertainty of its gain")?,
    })
}

fn plan(s: &Section<'_>) -> Result<CarriagePlan, RecordError> {
    s.only(&[
        "axis",
        "speeds",
        "repeats",
        "order",
        "directions",
        "distance",
        "start",
        "acceleration",
        "jerk",
        "settling",
        "still",
        "warm_up",
        "friction_sweep",
        "calibration",
        "excitation",
        "ballasted",
        "stop_when",
        "expected_drag",
        "strut_drag",
    ])?;
    let need = |key, dimension, advice: &str| s.positive(key, dimension)?.ok_or_else(|| s.missing(key, advice));
    let (settling_dry_s, settling_wet_s) = settling(s)?;
    let speed_m_s = speeds(s, "speeds")?;
    let repeats = count(s, "repeats", 10_000)?.unwrap_or(1);
    at_most(&s.place(), &[("speeds", speed_m_s.len()), ("repeats", repeats)], MOST_RUNS)?;
    Ok(CarriagePlan {
        axis: one_of(s, "axis", &Axis::NAMES, &Axis::ALL)?.unwrap_or_default(),
        speed_m_s,
        repeats,
        order: one_of(s, "order", &Order::NAMES, &Order::ALL)?.unwrap_or_default(),
        directions: one_of(s, "directions", &Directions::NAMES, &Directions::ALL)?.unwrap_or_default(),
        distance_m: need(
            "distance",
            Dimension::LENGTH,
            "write the travel of a run with its ramps, \"2.2 m\", for example",
        )?,
        start_m: s.quantity("start", Dimension::LENGTH)?,
        acceleration_m_s2: need(
            "acceleration",
            Dimension::ACCELERATION,
            "write that of the ramps, \"0.6 m/s^2\", for example",
        )?,
        jerk_m_s3: s.positive("jerk", JERK)?,
        settling_dry_s,
        settling_wet_s,
        // None is the default, and may be written.
        still_s: if s.quantity("still", Dimension::TIME)? == Some(0.0) {
            0.0
        } else {
            duration(s, "still")?.unwrap_or(0.0)
        },
        warm_up: s.section("warm_up")?.map(|s| warm_up(&s)).transpose()?,
        friction: s.section("friction_sweep")?.map(|s| friction_sweep(&s)).transpose()?,
        calibration: s.section("calibration")?.map(|s| calibration(&s)).transpose()?,
        excitation: s.section("excitation")?.map(|s| excitation(&s)).transpose()?,
        is_ballasted: s.flag("ballasted")?.unwrap_or(false),
        stop_at_relative_half_width: fraction(s, "stop_when", "the relative half-width of D_d's 95 % interval")?,
        expected_drag_n_s2_m2: s.positive("expected_drag", DRAG)?,
        strut_drag_n_s2_m2: positive_declared(s, "strut_drag", DRAG)?,
        place: s.place(),
    })
}

/// Longest time that a campaign names for anything: a day.
const LONGEST_S: f64 = 86_400.0;

/// A time larger than zero.
fn duration(s: &Section<'_>, key: &'static str) -> Result<Option<f64>, RecordError> {
    let time_s = s.positive(key, Dimension::TIME)?;
    match (time_s, s.get(key)) {
        (Some(time_s), Some(value)) if time_s > LONGEST_S => {
            Err(s.wrong(key, value, format!("is {time_s:e} s; nothing of a campaign takes longer than {LONGEST_S} s")))
        }
        _ => Ok(time_s),
    }
}

/// Speeds larger than zero, increasing, none twice.
fn speeds(s: &Section<'_>, key: &'static str) -> Result<Vec<f64>, RecordError> {
    let value = s.get(key).ok_or_else(|| {
        s.missing(key, &format!("write {key} = [\"0.05 m/s\", \"0.15 m/s\"], or {{ start, stop, step }}"))
    })?;
    let mut speeds = positive_series(s, key, value, Dimension::SPEED)?;
    speeds.sort_by(f64::total_cmp);
    match speeds.array_windows().find(|[a, b]| a == b) {
        Some([twice, _]) => Err(s.wrong(key, value, format!("names {twice} m/s twice; give the number in repeats"))),
        None => Ok(speeds),
    }
}

fn positive_series<'a>(
    s: &Section<'a>,
    key: &'static str,
    value: &'a Value<'a>,
    dimension: Dimension,
) -> Result<Vec<f64>, RecordError> {
    let values = series(s, key, value, dimension)?;
    match values.iter().find(|v| **v <= 0.0) {
        Some(v) => Err(s.wrong(key, value, format!("has {v} in it; each must be larger than zero"))),
        None => Ok(values),
    }
}

/// A part of something: `"1 %"` or a number between 0 and 1.
fn fraction(s: &Section<'_>, key: &'static str, what: &str) -> Result<Option<f64>, RecordError> {
    let Some(value) = s.get(key) else { return Ok(None) };
    let fraction = s.as_quantity_of(key, value, Dimension::ONE)?;
    if fraction > 0.0 && fraction < 1.0 {
        return Ok(Some(fraction));
    }
    Err(s.wrong(key, value, format!("is {}; {what} lies between 0 and 100 %", found(value))))
}

/// `"60 s"` for both, or `{ dry = "5 s", wet = "120 s" }`; none when not given.
fn settling(s: &Section<'_>) -> Result<(f64, f64), RecordError> {
    let Some(value) = s.get("settling") else { return Ok((0.0, 0.0)) };
    if value.get_ref().as_table().is_none() {
        let both = duration(s, "settling")?.unwrap_or(0.0);
        return Ok((both, both));
    }
    let table = s.as_section("settling", value)?;
    table.only(&["dry", "wet"])?;
    let wait = |key| Ok::<_, RecordError>(duration(&table, key)?.unwrap_or(0.0));
    Ok((wait("dry")?, wait("wet")?))
}

fn warm_up(s: &Section<'_>) -> Result<WarmUp, RecordError> {
    s.only(&["duration", "speed"])?;
    Ok(WarmUp {
        duration_s: duration(s, "duration")?
            .ok_or_else(|| s.missing("duration", "write how long, \"10 min\", for example"))?,
        speed_m_s: s
            .positive("speed", Dimension::SPEED)?
            .ok_or_else(|| s.missing("speed", "write how fast, \"0.3 m/s\", for example"))?,
    })
}

fn friction_sweep(s: &Section<'_>) -> Result<FrictionSweep, RecordError> {
    s.only(&["speeds", "repeats"])?;
    let (speed_m_s, repeats) = (speeds(s, "speeds")?, count(s, "repeats", 10_000)?.unwrap_or(1));
    at_most(&s.place(), &[("speeds", speed_m_s.len()), ("repeats", repeats)], MOST_RUNS)?;
    Ok(FrictionSweep { speed_m_s, repeats })
}

fn calibration(s: &Section<'_>) -> Result<Calibration, RecordError> {
    s.only(&["weights", "standard", "pulley_loss", "speed", "repeats", "start", "distance", "floor"])?;
    let value = s.get("weights");
    let value = value
        .ok_or_else(|| s.missing("weights", "write the weights as forces, [\"9.81 N\", \"19.62 N\"], for example"))?;
    Ok(Calibration {
        weights_n: positive_series(s, "weights", value, Dimension::FORCE)?,
        weight_standard_n: s.positive("standard", Dimension::FORCE)?.unwrap_or(0.0),
        pulley_loss: positive_declared(s, "pulley_loss", Dimension::ONE)?,
        speed_m_s: s
            .positive("speed", Dimension::SPEED)?
            .ok_or_else(|| s.missing("speed", "write how fast they are lifted, \"0.1 m/s\", for example"))?,
        repeats: count(s, "repeats", 10_000)?.unwrap_or(1),
        start_m: s.quantity("start", Dimension::LENGTH)?,
        distance_m: s.positive("distance", Dimension::LENGTH)?,
        floor_m: s.quantity("floor", Dimension::LENGTH)?,
    })
}

fn excitation(s: &Section<'_>) -> Result<PulseTrain, RecordError> {
    s.only(&["amplitude", "period", "duty", "duration"])?;
    let need = |value: Option<f64>, key, example: &str| {
        value.ok_or_else(|| s.missing(key, &format!("write {key} = \"{example}\", for example")))
    };
    Ok(PulseTrain {
        amplitude_v: need(s.positive("amplitude", Dimension::VOLTAGE)?, "amplitude", "2 V")?,
        period_s: need(duration(s, "period")?, "period", "1 s")?,
        duty: fraction(s, "duty", "the part of a period that is on")?
            .ok_or_else(|| s.missing("duty", "write duty = \"60 %\", for example"))?,
        duration_s: need(duration(s, "duration")?, "duration", "20 s")?,
    })
}
