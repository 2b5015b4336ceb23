//! Forecast of a tow: its ramps, what it asks of the drive, what it reaches.

use crate::carriage::CarriagePlan;
use crate::carriage::plan::PlannedRun;
use froude_control::coast::Coast;
use froude_control::config::{AxisConfig, Config};
use froude_control::profile::{Bounds, Profile};
use froude_control::request::Move;
use froude_control::shaper::ShapedProfile;
use froude_control::travel::{Preflight, preflight};
use froude_records::run::{BodyState, Role};

use super::fall::fall;
use crate::campaign::preflight::forecast::{Expected, Forecast, Objection, SHORTEST_STEADY_S};

#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    pub(super) from_m: f64,
    pub(super) to_m: f64,
    pub(super) speed_m_s: f64,
}

/// What a steady speed takes from the motor, and its inertia with what rides along.
pub(super) struct Load {
    drag_n: f64,
    pub(super) steady_n_m: f64,
    pub(super) inertia_kg_m2: f64,
}

impl Load {
    pub(super) fn of(run: &PlannedRun, speed_m_s: f64, axis: &AxisConfig, expected: &Expected) -> Self {
        let drive = &axis.drive;
        let chain_m = drive.sprocket_radius_m / drive.gear_ratio;
        let (drag_n, mass_kg) = match run.body {
            BodyState::Wet => (expected.drag_n_s2_m2 * speed_m_s * speed_m_s, expected.wet_mass_kg),
            BodyState::Dry => (0.0, expected.dry_mass_kg),
            BodyState::None => (0.0, 0.0),
        };
        let friction_n_m = drive.coulomb_n_m + drive.viscous_n_m_s_rad * speed_m_s / chain_m;
        Self {
            drag_n,
            steady_n_m: friction_n_m + chain_m * (drag_n + run.hung_weight_n.abs()) / expected.efficiency,
            inertia_kg_m2: drive.inertia_kg_m2 + mass_kg * chain_m * chain_m / expected.efficiency,
        }
    }
}

pub(super) fn tow(
    run: &PlannedRun,
    way: Way,
    asked: &CarriagePlan,
    control: &Config,
    expected: &Expected,
) -> (Forecast, Vec<Objection>) {
    let axis = &control.axes[run.axis as usize];
    let (drive, limits) = (&axis.drive, &axis.limits);
    let Way { from_m, to_m, speed_m_s } = way;
    let acceleration_m_s2 = asked.acceleration_m_s2;
    let chain_m = drive.sprocket_radius_m / drive.gear_ratio;
    let ramps = Ramps::of(way, asked, axis);
    let load = Load::of(run, speed_m_s, axis, expected);
    let ramp_n_m = load.inertia_kg_m2 * ramps.peak_m_s2 / chain_m;
    let peak_n_m = load.steady_n_m + ramp_n_m;
    let brake_n_m = (ramp_n_m - load.steady_n_m).abs();
    let to_a = 1.0 / drive.torque_constant_n_m_a;
    let current_a = peak_n_m * to_a;
    let command_v = current_a / drive.amplifier_a_v;
    // A jerk bound spreads the same change of speed: ∫a² dt is at most that of the trapezoid.
    let hard_s = (speed_m_s / ramps.peak_m_s2).min(0.5 * ramps.total_s);
    let square = ((peak_n_m.powi(2) + brake_n_m.powi(2)) * hard_s
        + load.steady_n_m.powi(2) * (ramps.total_s - 2.0 * hard_s))
        / ramps.total_s;
    let rms_current_a = square.max(0.0).sqrt() * to_a;
    let coast_m = Coast::of(drive).distance_m(speed_m_s);
    let profile = Move {
        target_m: to_m,
        speed_m_s,
        acceleration_m_s2,
        jerk_m_s3: asked.jerk_m_s3.unwrap_or(0.0),
        is_shaped: axis.mode_hz > 0.0,
    };
    let controller = preflight(control, axis, from_m, &profile);
    let mut out = travel(run, way, &controller, coast_m, expected, axis);
    let mut object = |kind, text: String| out.push(Objection { id: run.id.clone(), kind, text });
    if let Some(text) = fall(run, [from_m.min(to_m), from_m.max(to_m)], speed_m_s, axis, expected) {
        object("weight", text);
    }
    if speed_m_s > limits.speed_m_s {
        object("speed", format!("its speed {speed_m_s:.3} m/s is above the limit of {:.3} m/s", limits.speed_m_s));
    }
    if acceleration_m_s2 > limits.acceleration_m_s2 {
        object(
            "acceleration",
            format!(
                "its acceleration {acceleration_m_s2:.3} m/s² is above the limit of {:.3} m/s²",
                limits.acceleration_m_s2
            ),
        );
    }
    for (kind, text) in
        beyond_the_drive("its ramp", "accelerate more gently", [command_v, current_a, rms_current_a], axis)
    {
        object(kind, text);
    }
    // What only warms up is not averaged.
    if run.role != Role::WarmUp
        && let Some(text) = ramps.too_short(way)
    {
        object("steady", text);
    }
    if out.is_empty()
        && let Some(refusal) = controller.refusal
    {
        let text =
            format!("the controller would refuse the move ({refusal:?}): check its speed, acceleration and jerk");
        out.push(Objection { id: run.id.clone(), kind: "controller", text });
    }
    let forecast = Forecast {
        id: run.id.clone(),
        duration_s: ramps.total_s,
        steady_s: ramps.steady_s,
        command_v,
        current_a,
        rms_current_a,
        coast_m,
        margin_m: controller.free_m - controller.needed_m,
        drag_n: (run.body == BodyState::Wet).then_some(load.drag_n),
    };
    (forecast, out)
}

/// Where it starts and ends, and what is left before the hard stop if the torque fails.
fn travel(
    run: &PlannedRun,
    way: Way,
    controller: &Preflight,
    coast_m: f64,
    expected: &Expected,
    axis: &AxisConfig,
) -> Vec<Objection> {
    let mut out = Vec::new();
    let mut object = |kind, text: String| out.push(Objection { id: run.id.clone(), kind, text });
    for (what, at_m) in [("starts", way.from_m), ("ends", way.to_m)] {
        if at_m < controller.soft_low_m || at_m > controller.soft_high_m {
            object(
                "travel",
                format!(
                    "it {what} at {at_m:.3} m; runs may start and end between {:.3} and {:.3} m, the following error inside the end switches",
                    controller.soft_low_m, controller.soft_high_m
                ),
            );
        }
    }
    let missing_m = controller.needed_m - controller.free_m;
    if missing_m > 0.0 {
        let kept_m = axis.limits.following_error_m;
        object(
            "coast",
            format!(
                "it ends {:.3} m before the hard stop; if the torque fails it coasts {coast_m:.3} m, {:.3} m of them beyond its end, and \
                 {kept_m:.3} m are kept for the following error: {missing_m:.3} m are missing. Shorten the travel or start further back{}",
                controller.free_m,
                controller.needed_m - kept_m,
                expected.guess()
            ),
        );
    }
    out
}

/// How long the parts of a tow take, its jerk bound and its shaper counted.
struct Ramps {
    /// One ramp to the full speed, s.
    ramp_s: f64,
    /// What the shaper adds, s.
    shaper_s: f64,
    /// At constant speed, s; 0 where there is none.
    steady_s: f64,
    /// From the start of the profile to its end, s.
    total_s: f64,
    /// Largest acceleration that the jerk bound lets the ramp reach, m/s².
    peak_m_s2: f64,
}

impl Ramps {
    fn of(way: Way, asked: &CarriagePlan, axis: &AxisConfig) -> Self {
        let Way { from_m, to_m, speed_m_s } = way;
        let bounds =
            Bounds { speed_m_s, acceleration_m_s2: asked.acceleration_m_s2, jerk_m_s3: asked.jerk_m_s3.unwrap_or(0.0) };
        // Ramps that reach the speed take the same time over any way: here over one that is long for sure.
        let jerk_s = asked.jerk_m_s3.map_or(0.0, |j| asked.acceleration_m_s2 / j + 2.0 * (speed_m_s / j).sqrt());
        let long_m = 2.0 * speed_m_s * (speed_m_s / asked.acceleration_m_s2 + jerk_s);
        let long = Profile::plan(0.0, long_m, bounds);
        let ramp_s = long.duration_s() - long_m / speed_m_s;
        let shaper_s = axis.shaper().delay_s();
        let steady_s = (to_m - from_m).abs() / speed_m_s - ramp_s - shaper_s;
        let move_ = ShapedProfile::new(Profile::plan(from_m, to_m, bounds), axis.shaper());
        Self {
            ramp_s,
            shaper_s,
            steady_s: steady_s.max(0.0),
            total_s: move_.duration_s().max(f64::MIN_POSITIVE),
            peak_m_s2: long.peak_acceleration_m_s2(),
        }
    }

    /// Why nothing can be averaged, where that is so.
    fn too_short(&self, Way { from_m, to_m, speed_m_s }: Way) -> Option<String> {
        if self.steady_s >= SHORTEST_STEADY_S {
            return None;
        }
        let way_m = (to_m - from_m).abs();
        // Both ramps together, the shaper's delay with them, take this way at half the speed and at all of it.
        let ramps_m = speed_m_s * (self.ramp_s + self.shaper_s);
        let enough_m = ramps_m + speed_m_s * SHORTEST_STEADY_S;
        let needed = format!(
            "{SHORTEST_STEADY_S} s are needed, {:.2} m of travel in all: go further, accelerate faster or tow slower",
            (1e2 * enough_m).ceil() / 1e2
        );
        let shaper = if self.shaper_s > 0.0 { " (with the shaper)" } else { "" };
        Some(if ramps_m >= way_m {
            format!(
                "its ramps alone{shaper} need {ramps_m:.2} m of travel and it has {way_m:.2} m: no part of it is steady at {speed_m_s:.3} m/s; {needed}"
            )
        } else {
            format!("only {:.2} s of its {:.2} s are steady{shaper}; {needed}", self.steady_s, self.total_s)
        })
    }
}

/// What amplifier and motor do not give: command and peak current, and the root mean square of the current.
pub(super) fn beyond_the_drive(
    what: &str,
    advice: &str,
    [command_v, current_a, rms_current_a]: [f64; 3],
    axis: &AxisConfig,
) -> Vec<(&'static str, String)> {
    let limits = &axis.limits;
    let mut out = Vec::new();
    if command_v > limits.command_v {
        let text =
            format!("{what} asks for {command_v:.2} V, the amplifier accepts {:.2} V: {advice}", limits.command_v);
        out.push(("command", text));
    }
    if current_a > limits.current_a {
        out.push((
            "current",
            format!("{what} asks for {current_a:.2} A, the limit is {:.2} A: {advice}", limits.current_a),
        ));
    }
    if rms_current_a > limits.continuous_current_a {
        let text = format!(
            "it heats the motor with {rms_current_a:.2} A root mean square, {:.2} A are allowed continuously: {advice}",
            limits.continuous_current_a
        );
        out.push(("heating", text));
    }
    out
}
