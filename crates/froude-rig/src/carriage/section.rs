//! `[rig]` and `[carriage]` of the campaign's TOML.

use froude_records::RecordError;
use froude_records::campaign::Campaign;
use froude_records::declare::Values;
use froude_records::run::{Axis, AxisConstants, Declared};
use froude_records::section::{Section, found};
use froude_records::section_values::MOST_RUNS;
use froude_records::units::Dimension;

use super::keys::{AXIS, CARRIAGE, RIG, SETTLING};
use super::logs::{LogsRig, OF_LOGS};
use super::{
    AxisSpec, Calibration, CarriageCampaign, CarriagePlan, Directions, ForceSensorSpec, FrictionSweep, GainsSpec,
    LimitsSpec, Order, PulseTrain, RigKind, RigSpec, TwinTruth, WarmUp,
};

/// What a campaign drives, by its `[rig]` and `[carriage]`; `None` where it has neither, or a rig of which there are only logs.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn declared(campaign: &Campaign) -> Result<Option<CarriageCampaign>, RecordError> {
    let Some(root) = campaign.root() else { return Ok(None) };
    if LogsRig::declared(campaign)?.is_some() {
        return Ok(None);
    }
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

/// What to write where the long axis is missing.
const DESCRIBE_Y: &str = "describe the long axis in [rig.y]: travel, limits, drive, controller";

fn rig(s: &Section<'_>) -> Result<RigSpec, RecordError> {
    let values = Values::read(s, RIG)?;
    let is_twin = values.need("kind", values.word("kind", &[true, false, false]))?;
    let (own, foreign): (_, &[&'static str]) =
        if is_twin { ("twin", &["port", "baud"]) } else { ("serial", &["seed", "twin"]) };
    for key in foreign.iter().chain(&OF_LOGS) {
        if let Some(value) = s.get(key) {
            return Err(s.wrong(key, value, format!("does not belong to a rig of kind {own:?}; take it out")));
        }
    }
    let kind = if is_twin {
        let seed = values
            .count("seed")
            .ok_or_else(|| values.missing("seed", "write seed = 1, for example; the same seed gives the same runs"))?;
        let mut truths = Vec::new();
        if let Some(twin) = s.section("twin")? {
            twin_truths(&twin, "", &mut truths)?;
        }
        RigKind::Twin { seed: seed as u64, truths }
    } else {
        let port = values.text("port");
        let port = port.ok_or_else(|| values.missing("port", "write port = \"/dev/ttyUSB0\", for example"))?.to_owned();
        let baud = values.count("baud").map_or(3_000_000, |baud| baud as u32);
        RigKind::Serial { port, baud }
    };
    Ok(RigSpec {
        kind,
        log_rate_hz: values.need("log_rate", values.number("log_rate"))?,
        y: axis(&s.section("y")?.ok_or_else(|| values.missing("y", DESCRIBE_Y))?)?,
        x: s.section("x")?.map(|s| axis(&s)).transpose()?,
        force_sensor: values.table("force_sensor").map(|sensor| ForceSensorSpec {
            range_n: sensor.number("range"),
            resolution_n: sensor.number("resolution"),
            noise_n: sensor.number("noise"),
            drift_n: sensor.number("drift"),
            gain_standard: sensor.number("gain_standard"),
        }),
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
    let values = Values::read(s, AXIS)?;
    let number = |key: &str| values.need(key, values.number(key));
    let constant = |key: &str| values.need(key, values.constant(key));
    Ok(AxisSpec {
        travel_m: travel(s)?,
        limits: LimitsSpec {
            speed_m_s: number("speed_limit")?,
            unhomed_speed_m_s: values.number("unhomed_speed_limit"),
            acceleration_m_s2: number("acceleration_limit")?,
            command_v: number("command_limit")?,
            current_a: number("current_limit")?,
            continuous_current_a: values.number("continuous_current_limit"),
            thermal_time_s: duration(&values, "thermal_time")?,
            following_error_m: values.number("following_error_limit"),
        },
        constants: AxisConstants {
            torque_constant_n_m_a: constant("torque_constant")?,
            amplifier_a_v: constant("amplifier")?,
            gear_ratio: constant("gear_ratio")?,
            sprocket_radius_m: constant("sprocket_radius")?,
            counts_per_revolution: number("counts_per_revolution")?,
            efficiency_forward: efficiency(&values, "efficiency")?,
            efficiency_backward: efficiency(&values, "efficiency_backward")?,
            is_calibrated: false,
        },
        inertia_kg_m2: values.constant("inertia"),
        viscous_n_m_s_rad: values.constant("viscous_friction"),
        coulomb_n_m: values.constant("coulomb_friction"),
        gains: gains(values.need("controller", values.table("controller"))?)?,
        place: s.place(),
    })
}

fn efficiency(values: &Values, key: &str) -> Result<Option<Declared>, RecordError> {
    match values.constant(key) {
        Some(efficiency) if efficiency.value > 1.0 => {
            Err(values.wrong(key, format!("is {}; an efficiency is at most 1, or 100 %", efficiency.value)))
        }
        efficiency => Ok(efficiency),
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

fn gains(values: &Values) -> Result<GainsSpec, RecordError> {
    let gain = |key: &str| values.need(key, values.number(key));
    Ok(GainsSpec {
        proportional_v_rad: gain("proportional")?,
        derivative_v_s_rad: gain("derivative")?,
        integral_v_rad_s: gain("integral")?,
        derivative_filter_hz: values.number("derivative_filter"),
        shaped_mode_hz: values.number("shaped_mode"),
        shaped_damping: values.number("shaped_damping"),
        is_robust_shaper: values.flag("robust_shaper"),
    })
}

fn plan(s: &Section<'_>) -> Result<CarriagePlan, RecordError> {
    let values = Values::read(s, CARRIAGE)?;
    let number = |key: &str| values.need(key, values.number(key));
    let (settling_dry_s, settling_wet_s) = settling(s)?;
    let FrictionSweep { speed_m_s, repeats } = sweep(&values)?;
    let [scatter_n, scatter_dof] =
        [values.number("expected_scatter"), values.count("expected_scatter_dof").map(|dof| dof as f64)];
    if scatter_n.is_none() && scatter_dof.is_some() {
        return Err(values.wrong("expected_scatter_dof", "belongs to expected_scatter, which is not declared"));
    }
    Ok(CarriagePlan {
        axis: values.word("axis", &Axis::ALL).unwrap_or_default(),
        speed_m_s,
        repeats,
        order: values.word("order", &Order::ALL).unwrap_or_default(),
        directions: values.word("directions", &Directions::ALL).unwrap_or_default(),
        distance_m: number("distance")?,
        start_m: values.number("start"),
        acceleration_m_s2: number("acceleration")?,
        jerk_m_s3: values.number("jerk"),
        settling_dry_s,
        settling_wet_s,
        still_s: duration(&values, "still")?.unwrap_or(0.0),
        warm_up: values.table("warm_up").map(warm_up).transpose()?,
        friction: values.table("friction_sweep").map(sweep).transpose()?,
        calibration: values.table("calibration").map(calibration).transpose()?,
        excitation: values.table("excitation").map(excitation).transpose()?,
        is_ballasted: values.flag("ballasted"),
        stop_at_relative_half_width: values.number("stop_when"),
        expected_drag_n_s2_m2: values.number("expected_drag"),
        expected_scatter_n: scatter_n.map(|n| (n, scatter_dof.unwrap_or(f64::INFINITY))),
        strut_drag_n_s2_m2: values.constant("strut_drag"),
        place: s.place(),
    })
}

/// Longest time that a campaign names for anything: a day.
const LONGEST_S: f64 = 86_400.0;

/// A time that no campaign exceeds.
fn duration(values: &Values, key: &str) -> Result<Option<f64>, RecordError> {
    match values.number(key) {
        Some(time_s) if time_s > LONGEST_S => Err(values.wrong(key, too_long(time_s))),
        time_s => Ok(time_s),
    }
}

fn too_long(time_s: f64) -> String {
    format!("is {time_s:e} s; nothing of a campaign takes longer than {LONGEST_S} s")
}

/// Speeds in their order, none twice, and how often each is run.
fn sweep(values: &Values) -> Result<FrictionSweep, RecordError> {
    let mut speed_m_s = values.numbers("speeds");
    speed_m_s.sort_by(f64::total_cmp);
    if let Some([twice, _]) = speed_m_s.array_windows().find(|[a, b]| a == b) {
        return Err(values.wrong("speeds", format!("names {twice} m/s twice; give the number in repeats")));
    }
    values.at_most(MOST_RUNS)?;
    Ok(FrictionSweep { speed_m_s, repeats: values.need("repeats", values.count("repeats"))? })
}

/// `"60 s"` for both, or `{ dry = "5 s", wet = "120 s" }`; none when not given.
fn settling(s: &Section<'_>) -> Result<(f64, f64), RecordError> {
    let Some(value) = s.get("settling") else { return Ok((0.0, 0.0)) };
    if value.get_ref().as_table().is_none() {
        let both = s.positive("settling", Dimension::TIME)?.unwrap_or(0.0);
        s.refuse("settling", both > LONGEST_S, too_long(both))?;
        return Ok((both, both));
    }
    let waits = Values::read(&s.as_section("settling", value)?, SETTLING)?;
    let wait = |key| Ok::<_, RecordError>(duration(&waits, key)?.unwrap_or(0.0));
    Ok((wait("dry")?, wait("wet")?))
}

fn warm_up(values: &Values) -> Result<WarmUp, RecordError> {
    Ok(WarmUp {
        duration_s: values.need("duration", duration(values, "duration")?)?,
        speed_m_s: values.need("speed", values.number("speed"))?,
    })
}

fn calibration(values: &Values) -> Result<Calibration, RecordError> {
    Ok(Calibration {
        weights_n: values.numbers("weights"),
        weight_standard_n: values.number("standard").unwrap_or(0.0),
        pulley_loss: values.constant("pulley_loss"),
        speed_m_s: values.need("speed", values.number("speed"))?,
        repeats: values.need("repeats", values.count("repeats"))?,
        start_m: values.number("start"),
        distance_m: values.number("distance"),
        floor_m: values.number("floor"),
    })
}

fn excitation(values: &Values) -> Result<PulseTrain, RecordError> {
    Ok(PulseTrain {
        amplitude_v: values.need("amplitude", values.number("amplitude"))?,
        period_s: values.need("period", duration(values, "period")?)?,
        duty: values.need("duty", values.number("duty"))?,
        duration_s: values.need("duration", duration(values, "duration")?)?,
    })
}
