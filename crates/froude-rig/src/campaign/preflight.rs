//! Every run is checked before anything moves: travel with coast, speed, command, current, heating.
//!
//! For a profile at speed v and acceleration a, with friction C, B and declared drag D (MCD eq. 3, 7):
//! peak torque J_eff θ̈ + B_eff θ̇ + C_eff + (R/n) D v² at the end of the ramp, over the gear's efficiency where it is declared;
//! command v_c = τ/(K_T K_amp), current i = K_amp v_c; heating as the mean of i² over the profile against the continuous current.

use froude_control::coast::{Coast, StoppingWay};
use froude_control::config::AxisConfig;
use froude_records::run::BodyState;

use super::plan::{Drive, PlannedRun};

/// What a run asks of the rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// The run.
    pub id: String,
    /// Time from the start of the profile to its end, s.
    pub duration_s: f64,
    /// Steady part, s.
    pub steady_s: f64,
    /// Largest command, V.
    pub command_v: f64,
    /// Largest current, A.
    pub current_a: f64,
    /// Root-mean-square current over the profile, A.
    pub rms_current_a: f64,
    /// Coast from the steady speed with the lower bound of friction, m.
    pub coast_m: f64,
    /// Free way ahead of the end of the profile that is left after stopping, m.
    pub margin_m: f64,
    /// Expected drag in the steady part, N; `None` without a body in the water.
    pub drag_n: Option<f64>,
}

/// Why a run is refused.
#[derive(Debug, Clone, PartialEq)]
pub struct Objection {
    /// The run.
    pub id: String,
    /// The sentence, with the numbers.
    pub text: String,
}

/// Declared drag and mass of the body, efficiency of the gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// D_d, N s²/m²; 0 where unknown.
    pub drag_n_s2_m2: f64,
    /// Extra mass of the body, its water and its added mass when wet, kg.
    pub wet_mass_kg: f64,
    /// Mass of the dry body, kg.
    pub dry_mass_kg: f64,
    /// η; 1 where it is part of the declared friction.
    pub efficiency: f64,
}

/// Shortest steady part that can be averaged, s: the window drops half a second and needs as much again.
const SHORTEST_STEADY_S: f64 = 1.5;

/// Forecast of one run, and everything that speaks against it.
#[must_use]
pub fn check(
    run: &PlannedRun,
    acceleration_m_s2: f64,
    axis: &AxisConfig,
    expected: &Expected,
) -> (Forecast, Vec<Objection>) {
    let mut out = Vec::new();
    let mut object = |text: String| out.push(Objection { id: run.id.clone(), text });
    let (drive, limits) = (&axis.drive, &axis.limits);
    let chain_m = drive.sprocket_radius_m / drive.gear_ratio;
    let is_wet = run.body == BodyState::Wet;
    let Drive::Profile { from_m, to_m, speed_m_s } = run.drive else {
        return (pulse_forecast(run, axis), out);
    };
    let way_m = (to_m - from_m).abs();
    let ramp_s = speed_m_s / acceleration_m_s2;
    let steady_s = way_m / speed_m_s - ramp_s;
    let drag_n = if is_wet { expected.drag_n_s2_m2 * speed_m_s * speed_m_s } else { 0.0 };
    let friction_n_m = drive.coulomb_n_m + drive.viscous_n_m_s_rad * speed_m_s / chain_m;
    let steady_n_m = friction_n_m + chain_m * (drag_n + run.hung_weight_n.abs()) / expected.efficiency;
    let mass = match run.body {
        BodyState::Wet => expected.wet_mass_kg,
        BodyState::Dry => expected.dry_mass_kg,
        BodyState::None => 0.0,
    };
    let inertia_kg_m2 = drive.inertia_kg_m2 + mass * chain_m * chain_m / expected.efficiency;
    let ramp_n_m = inertia_kg_m2 * acceleration_m_s2 / chain_m;
    let peak_n_m = steady_n_m + ramp_n_m;
    let to_a = 1.0 / drive.torque_constant_n_m_a;
    let current_a = peak_n_m * to_a;
    let command_v = current_a / drive.amplifier_a_v;
    let brake_n_m = (ramp_n_m - steady_n_m).abs();
    let total_s = (steady_s + 2.0 * ramp_s).max(f64::MIN_POSITIVE);
    let square = (peak_n_m.powi(2) * ramp_s + steady_n_m.powi(2) * steady_s + brake_n_m.powi(2) * ramp_s) / total_s;
    let rms_current_a = square.max(0.0).sqrt() * to_a;
    let coast = Coast::of(drive);
    let coast_m = coast.distance_m(speed_m_s);
    let beyond_m = StoppingWay::new(coast, limits.acceleration_m_s2).beyond_target_m(speed_m_s, acceleration_m_s2);
    let free_m = if to_m > from_m { limits.hard_high_m - to_m } else { to_m - limits.hard_low_m };
    let margin_m = free_m - beyond_m - limits.following_error_m;

    for (what, at_m) in [("starts", from_m), ("ends", to_m)] {
        if at_m < limits.low_switch_m || at_m > limits.high_switch_m {
            object(format!(
                "it {what} at {at_m:.3} m, outside the end switches at {:.3} and {:.3} m",
                limits.low_switch_m, limits.high_switch_m
            ));
        }
    }
    if margin_m < 0.0 {
        object(format!(
            "it ends {free_m:.3} m before the hard stop; if the torque fails it coasts {coast_m:.3} m, {beyond_m:.3} m of them beyond \
             its end, and {:.3} m are kept for the following error: {:.3} m are missing. Shorten the travel or start further back",
            limits.following_error_m, -margin_m
        ));
    }
    if let Some(text) = fall(run, [from_m.min(to_m), from_m.max(to_m)], speed_m_s, axis, expected) {
        object(text);
    }
    if speed_m_s > limits.speed_m_s {
        object(format!("its speed {speed_m_s:.3} m/s is above the limit of {:.3} m/s", limits.speed_m_s));
    }
    if acceleration_m_s2 > limits.acceleration_m_s2 {
        object(format!(
            "its acceleration {acceleration_m_s2:.3} m/s² is above the limit of {:.3} m/s²",
            limits.acceleration_m_s2
        ));
    }
    if command_v > limits.command_v {
        object(format!(
            "its ramp asks for {command_v:.2} V, the amplifier takes {:.2} V: accelerate more gently",
            limits.command_v
        ));
    }
    if current_a > limits.current_a {
        object(format!("its ramp asks for {current_a:.2} A, the limit is {:.2} A", limits.current_a));
    }
    if rms_current_a > limits.continuous_current_a {
        object(format!(
            "it heats the motor with {rms_current_a:.2} A root mean square, {:.2} A are allowed continuously",
            limits.continuous_current_a
        ));
    }
    if steady_s < SHORTEST_STEADY_S {
        object(format!(
            "only {steady_s:.2} s of its {total_s:.2} s are steady, {SHORTEST_STEADY_S} s are needed: go further or accelerate faster"
        ));
    }
    let forecast = Forecast {
        id: run.id.clone(),
        duration_s: total_s,
        steady_s,
        command_v,
        current_a,
        rms_current_a,
        coast_m,
        margin_m,
        drag_n: is_wet.then_some(drag_n),
    };
    (forecast, out)
}

/// What a hung weight does when the torque fails, where that does not end inside the travel.
///
/// It is held for sure by F = η C n/R (all friction behind the gear, its lower bound). A heavier weight W pulls the carriage from the
/// highest place of the run to where the weight rests on its floor, h below, and friction stops it from there: whatever the mass,
/// F s = (W − F) h, and the coast from the run's own speed comes on top.
fn fall(
    run: &PlannedRun,
    [bottom_m, top_m]: [f64; 2],
    speed_m_s: f64,
    axis: &AxisConfig,
    expected: &Expected,
) -> Option<String> {
    let (drive, limits) = (&axis.drive, &axis.limits);
    let weight_n = run.hung_weight_n;
    let held_n = expected.efficiency * drive.coulomb_lower_n_m * drive.gear_ratio / drive.sprocket_radius_m;
    if let Some(floor_m) = run.floor_m.filter(|&floor_m| weight_n != 0.0 && floor_m > bottom_m) {
        return Some(format!(
            "its weight rests on the floor while the carriage is below {floor_m:.3} m, and the run begins or ends at {bottom_m:.3} m: it would \
             not hang all the way. The floor of [carriage.calibration] is a coordinate of the carriage, just below its start"
        ));
    }
    if weight_n <= held_n {
        return None;
    }
    let Some(floor_m) = run.floor_m else {
        return Some(format!(
            "friction surely holds {held_n:.2} N of its {weight_n:.2} N: if the torque fails the weight pulls the carriage into the stop \
             at {:.3} m. Give it a floor to rest on, floor = \"{:.2} m\" in [carriage.calibration], or hang less",
            limits.hard_low_m,
            bottom_m - 0.05
        ));
    };
    let fall_m = (top_m - floor_m).max(0.0);
    let coast_m = (weight_n / held_n - 1.0) * fall_m + Coast::of(drive).distance_m(speed_m_s);
    let room_m = floor_m - limits.hard_low_m;
    let own_m = Coast::of(drive).distance_m(speed_m_s);
    let most_n = held_n * (1.0 + (room_m - own_m).max(0.0) / fall_m.max(1e-3));
    (coast_m > room_m).then(|| {
        format!(
            "if the torque fails its {weight_n:.2} N pull the carriage from {top_m:.3} m to {floor_m:.3} m, where they rest on the floor; \
             it then coasts {coast_m:.3} m and {room_m:.3} m are free. Lift less high, further from the stop, or hang at most {most_n:.1} N"
        )
    })
}

/// Pulses and jogs are held inside the soft limits by the controller itself; only command and current are forecast.
fn pulse_forecast(run: &PlannedRun, axis: &AxisConfig) -> Forecast {
    let (volts, duration_s) = match run.drive {
        Drive::Pulses { volts, duration_s, .. } => (volts.abs(), duration_s),
        Drive::Relay { volts, duration_s, .. } | Drive::Sweep { volts, duration_s, .. } => (volts.abs(), duration_s),
        Drive::Jog { volts, .. } => (volts.abs(), 1.0),
        Drive::Profile { .. } => (0.0, 0.0),
    };
    Forecast {
        id: run.id.clone(),
        duration_s,
        steady_s: 0.0,
        command_v: volts,
        current_a: volts * axis.drive.amplifier_a_v,
        rms_current_a: volts * axis.drive.amplifier_a_v,
        coast_m: 0.0,
        margin_m: f64::INFINITY,
        drag_n: None,
    }
}
