//! Every run is checked before anything moves: travel with coast, speed, command, current, heating, and what the controller would refuse.
//!
//! For a profile at speed v and acceleration a, with friction C, B and declared drag D (MCD eq. 3, 7):
//! peak torque J_eff θ̈ + B_eff θ̇ + C_eff + (R/n) D v² at the end of the ramp, over the gear's efficiency where it is declared;
//! command v_c = τ/(K_T K_amp), current i = K_amp v_c; heating as the mean of i² over the profile against the continuous current.
//! A jerk bound lengthens each ramp, a shaper the whole move; both shorten the part at constant speed.

use froude_control::coast::Coast;
use froude_control::config::{AxisConfig, Config};
use froude_control::profile::{Bounds, Profile};
use froude_control::request::{Excitation, Move};
use froude_control::shaper::ShapedProfile;
use froude_control::travel::{Rigid, foresee_excitation, preflight, preflight_excitation};
use froude_records::carriage::{CarriagePlan, RigSpec};
use froude_records::run::{BodyState, Role};

use super::setup;
use froude_records::carriage::plan::{Drive, JOG_S, PlannedRun};

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

/// Why a campaign is refused.
#[derive(Debug, Clone, PartialEq)]
pub struct Objection {
    /// The run, or the section of the campaign that it stands in.
    pub id: String,
    /// What kind it is: `travel`, `coast`, `weight`, `speed`, `acceleration`, `command`, `current`, `heating`, `steady`, `still`,
    /// `controller`.
    pub kind: &'static str,
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
    /// Volume that was taken for the body because none is declared, m³.
    pub assumed_volume_m3: Option<f64>,
}

impl Expected {
    /// What a sentence about a coast must add where the mass behind it is a guess.
    fn guess(&self) -> String {
        self.assumed_volume_m3.map_or_else(String::new, |v| {
            format!(". There is no volume in [body]: that of a {:.1} litre body is assumed", 1e3 * v)
        })
    }
}

/// Shortest part at constant speed that can be averaged, s: the reduction drops 0.5 s at its start and 0.05 s at its end and needs 1 s
/// between. A test of the `froude` crate compares this with the reduction's own settings.
pub const SHORTEST_STEADY_S: f64 = 0.5 + 0.05 + 1.0;
/// Shortest stand-still that gives a zero after a tow, s: 0.5 s until the wake has passed, and 1 s to average. Held as above.
pub const SHORTEST_STILL_S: f64 = 0.5 + 1.0;

/// What speaks against the campaign as a whole: a configuration that the controller does not take, a stand-still too short for a zero, a
/// floor outside the travel.
#[must_use]
pub fn check_campaign(asked: &CarriagePlan, rig: &RigSpec, control: &Config) -> Vec<Objection> {
    let mut out = Vec::new();
    let mut object = |id: &str, kind, text| out.push(Objection { id: id.to_owned(), kind, text });
    if let Err(error) = control.check() {
        let (section, text) = setup::in_words(&error, control);
        object(&section, "controller", text);
    }
    if rig.force_sensor.is_some() && asked.still_s > 0.0 && asked.still_s < SHORTEST_STILL_S {
        let text = format!(
            "still is {} s; the force sensor's zero after a tow takes 0.5 s for the wake to pass and 1 s to average, {SHORTEST_STILL_S} s in \
             all. Write still = \"2 s\" or more, or leave it out",
            asked.still_s
        );
        object("[carriage]", "still", text);
    }
    let [low_m, high_m] = [control.axes[asked.axis as usize].limits].map(|l| [l.hard_low_m, l.hard_high_m])[0];
    let floor_m = asked.calibration.as_ref().and_then(|c| c.floor_m);
    if let Some(floor_m) = floor_m.filter(|floor_m| !(low_m..=high_m).contains(floor_m)) {
        let text = format!(
            "its floor is at {floor_m:.3} m, outside the travel from {low_m:.3} to {high_m:.3} m: the weight would never rest on it. Write the \
             carriage's coordinate, just below the start of the run, at which the weight touches the ground"
        );
        object("[carriage.calibration]", "weight", text);
    }
    out
}

/// Forecast of one run, and everything that speaks against it.
#[must_use]
pub fn check(
    run: &PlannedRun,
    asked: &CarriagePlan,
    control: &Config,
    expected: &Expected,
) -> (Forecast, Vec<Objection>) {
    match run.drive {
        Drive::Profile { from_m, to_m, speed_m_s } => {
            tow(run, Way { from_m, to_m, speed_m_s }, asked, control, expected)
        }
        _ => excitation(run, control, expected),
    }
}

#[derive(Debug, Clone, Copy)]
struct Way {
    from_m: f64,
    to_m: f64,
    speed_m_s: f64,
}

/// What a steady speed takes from the motor, and its inertia with what rides along.
struct Load {
    drag_n: f64,
    steady_n_m: f64,
    inertia_kg_m2: f64,
}

impl Load {
    fn of(run: &PlannedRun, speed_m_s: f64, axis: &AxisConfig, expected: &Expected) -> Self {
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

fn tow(
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
    let margin_m = controller.free_m - controller.needed_m;

    let mut out = Vec::new();
    let mut object = |kind, text: String| out.push(Objection { id: run.id.clone(), kind, text });
    for (what, at_m) in [("starts", from_m), ("ends", to_m)] {
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
    if margin_m < 0.0 {
        let kept_m = limits.following_error_m;
        object(
            "coast",
            format!(
                "it ends {:.3} m before the hard stop; if the torque fails it coasts {coast_m:.3} m, {:.3} m of them beyond its end, and \
                 {kept_m:.3} m are kept for the following error: {:.3} m are missing. Shorten the travel or start further back{}",
                controller.free_m,
                controller.needed_m - kept_m,
                -margin_m,
                expected.guess()
            ),
        );
    }
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
        margin_m,
        drag_n: (run.body == BodyState::Wet).then_some(load.drag_n),
    };
    (forecast, out)
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
fn beyond_the_drive(
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

/// Pulses, relay, sweep and jog. The controller holds them inside the soft limits by ending them: what would be ended is refused here.
fn excitation(run: &PlannedRun, control: &Config, expected: &Expected) -> (Forecast, Vec<Objection>) {
    let axis = &control.axes[run.axis as usize];
    let (drive, limits) = (&axis.drive, &axis.limits);
    let n_m_v = drive.torque_constant_n_m_a * drive.amplifier_a_v;
    // Largest command, its root mean square, what the controller is asked, from where, and what to do about too much.
    let (command_v, rms_v, duration_s, asked, from_m, advice) = match run.drive {
        Drive::Profile { .. } => unreachable!("a tow is not an excitation"),
        Drive::Pulses { from_m, volts, period_s, duty, duration_s } => (
            volts.abs(),
            volts.abs() * duty.sqrt(),
            duration_s,
            Excitation::Pulses { volts, period_s, duty, duration_s },
            from_m,
            "lower the amplitude of [carriage.excitation]",
        ),
        Drive::Relay { from_m, volts, hysteresis_m, duration_s } => (
            volts.abs(),
            volts.abs(),
            duration_s,
            Excitation::Relay { volts, hysteresis_m, duration_s },
            from_m,
            "the relay's height is fixed, this drive is too weak for it",
        ),
        Drive::Sweep { from_m, speed_m_s, volts, from_hz, to_hz, duration_s } => {
            // The sine comes on top of what the tow below it takes.
            let steady_v = Load::of(run, speed_m_s, axis, expected).steady_n_m / n_m_v;
            (
                steady_v + volts.abs(),
                steady_v.hypot(volts / std::f64::consts::SQRT_2),
                duration_s,
                Excitation::Sweep { volts, from_hz, to_hz, duration_s, speed_m_s },
                from_m,
                "the sweep's amplitude is fixed, this drive is too weak for it",
            )
        }
        Drive::Jog { from_m, volts, distance_m } => (
            volts.abs(),
            volts.abs(),
            JOG_S,
            Excitation::Jog { volts, distance_m, duration_s: JOG_S },
            from_m,
            "the jog's command is fixed, this drive is too weak for it",
        ),
    };
    let (current_a, rms_current_a) = (command_v * drive.amplifier_a_v, rms_v * drive.amplifier_a_v);
    let mut out = beyond_the_drive("it", advice, [command_v, current_a, rms_current_a], axis);
    if out.is_empty()
        && let Some(refusal) = preflight_excitation(control, axis, from_m, &asked)
    {
        let text = match refusal {
            froude_control::status::Refusal::BeyondTravel => format!(
                "it starts at {from_m:.3} m and its travel does not fit between the end switches at {:.3} and {:.3} m: start elsewhere",
                limits.low_switch_m, limits.high_switch_m
            ),
            _ => format!("the controller would refuse it: {asked:?} has a number out of its range"),
        };
        out.push(("controller", text));
    }
    if out.is_empty()
        && let Some(text) = excursion(run, &asked, from_m, duration_s, control, expected)
    {
        out.push(("travel", text));
    }
    let forecast = Forecast {
        id: run.id.clone(),
        duration_s,
        steady_s: 0.0,
        command_v,
        current_a,
        rms_current_a,
        coast_m: 0.0,
        margin_m: f64::INFINITY,
        drag_n: None,
    };
    (forecast, out.into_iter().map(|(kind, text)| Objection { id: run.id.clone(), kind, text }).collect())
}

/// Where the controller would end an excitation before its time, with the declared friction or with its lower end.
fn excursion(
    run: &PlannedRun,
    asked: &Excitation,
    from_m: f64,
    duration_s: f64,
    control: &Config,
    expected: &Expected,
) -> Option<String> {
    let (what, are, advice) = match asked {
        Excitation::Pulses { .. } => {
            ("pulses", "are", "Write a lower amplitude or a shorter period in [carriage.excitation], or move the start")
        }
        Excitation::Relay { .. } => ("relay", "is", "Start further from the ends"),
        Excitation::Jog { .. } => ("jog", "is", "Start further from the ends"),
        Excitation::Sweep { .. } => return None,
    };
    let axis = &control.axes[run.axis as usize];
    let drive = &axis.drive;
    let inertia_kg_m2 = Load::of(run, 0.0, axis, expected).inertia_kg_m2;
    let frictions =
        [[drive.viscous_n_m_s_rad, drive.coulomb_n_m], [drive.viscous_lower_n_m_s_rad, drive.coulomb_lower_n_m]];
    let cuts = frictions.map(|[viscous_n_m_s_rad, coulomb_n_m]| {
        let on = Rigid { inertia_kg_m2, viscous_n_m_s_rad, coulomb_n_m };
        let excursion = foresee_excitation(control, axis, from_m, asked, on);
        excursion.cut_s.map(|cut_s| (cut_s, excursion.end_m))
    });
    let (cut_s, end_m) = cuts.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "its {what} {are} predicted to reach {end_m:.3} m after {cut_s:.1} s of {duration_s} s, where the controller ends what could not be \
         stopped inside the soft limits any more. {advice}"
    ))
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
    // A floor outside the travel is reported once, of the campaign.
    if run.floor_m.is_some_and(|floor_m| !(limits.hard_low_m..=limits.hard_high_m).contains(&floor_m)) {
        return None;
    }
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
            "friction reliably holds {:.2} N of its {weight_n:.2} N: if the torque fails the weight pulls the carriage into the stop \
             at {:.3} m. Give it a floor to rest on, floor = \"{:.2} m\" in [carriage.calibration], or hang less",
            at_most(held_n),
            limits.hard_low_m,
            bottom_m - 0.05
        ));
    };
    let fall_m = (top_m - floor_m).max(0.0);
    let own_m = Coast::of(drive).distance_m(speed_m_s);
    let coast_m = (weight_n / held_n - 1.0) * fall_m + own_m;
    let room_m = floor_m - limits.hard_low_m;
    let most_n = held_n * (1.0 + (room_m - own_m).max(0.0) / fall_m.max(1e-3));
    (coast_m > room_m).then(|| {
        format!(
            "if the torque fails its {weight_n:.2} N pull the carriage from {top_m:.3} m to {floor_m:.3} m, where they rest on the floor; \
             it then coasts {coast_m:.3} m and {room_m:.3} m are free. Lift less high, further from the stop, or hang at most {:.2} N{}",
            at_most(most_n),
            expected.guess()
        )
    })
}

/// Two decimals of a number that advice may quote as the most: never rounded up.
fn at_most(value: f64) -> f64 {
    (1e2 * value * (1.0 - 1e-9)).floor() / 1e2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::TowedBody;
    use froude_records::carriage::CarriageCampaign;
    use froude_records::carriage::plan::{Experiments, Step, plan, tuning};

    /// The example's campaign with some texts replaced.
    fn campaign(changes: &[(&str, &str)]) -> CarriageCampaign {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/towing-carriage/campaign.toml");
        let mut text = std::fs::read_to_string(path).unwrap();
        for (from, to) in changes {
            assert!(text.contains(from), "the example has no {from}");
            text = text.replace(from, to);
        }
        froude_records::campaign::parse_campaign(std::path::Path::new("c.toml"), &text).unwrap().carriage.unwrap()
    }

    fn told(changes: &[(&str, &str)], assumed_volume_m3: Option<f64>) -> (Vec<Forecast>, Vec<Objection>) {
        let campaign = campaign(changes);
        let asked = campaign.plan.clone().unwrap();
        let start_m = asked.start_m.unwrap_or(0.5 * (4.95 - 0.05 - asked.distance_m));
        let steps = plan(&asked, start_m, 1);
        let tests = tuning(&asked, start_m, &Experiments::default());
        judged(&campaign, &[steps, tests].concat(), assumed_volume_m3)
    }

    fn judged(
        campaign: &CarriageCampaign,
        steps: &[Step],
        assumed_volume_m3: Option<f64>,
    ) -> (Vec<Forecast>, Vec<Objection>) {
        let asked = campaign.plan.clone().unwrap();
        let displaced_kg = 998.2 * TowedBody::CYLINDER.displaced_m3;
        let control = setup::control(campaign, 3.0 * displaced_kg).unwrap();
        let expected = Expected {
            drag_n_s2_m2: 20.0,
            wet_mass_kg: 3.0 * displaced_kg,
            dry_mass_kg: displaced_kg,
            efficiency: 0.8,
            assumed_volume_m3,
        };
        let (mut forecasts, mut objections) = (Vec::new(), check_campaign(&asked, &campaign.rig, &control));
        for step in steps {
            if let Step::Run(run) = step {
                let (forecast, against) = check(run, &asked, &control, &expected);
                forecasts.push(forecast);
                objections.extend(against);
            }
        }
        (forecasts, objections)
    }

    fn objections(changes: &[(&str, &str)]) -> Vec<Objection> {
        told(changes, None).1
    }

    fn kinds<'a>(objections: &'a [Objection], run: &str) -> Vec<&'a str> {
        objections.iter().filter(|o| o.id.contains(run)).map(|o| o.kind).collect()
    }

    /// What stands between two texts of a sentence, as a number.
    fn between(text: &str, before: &str, after: &str) -> f64 {
        text.split(before).nth(1).unwrap().split(after).next().unwrap().parse().unwrap()
    }

    #[test]
    fn the_example_passes_with_its_experiments() {
        assert_eq!(objections(&[]), []);
    }

    #[test]
    fn excitations_are_held_against_command_peak_and_continuous_current() {
        let amplitude = |to| objections(&[(r#"amplitude = "2 V""#, to)]);
        assert_eq!(kinds(&amplitude(r#"amplitude = "20 V""#), "pulses"), ["command", "current", "heating"]);
        // 9 V are 3.17 A of 3.5 A; 60 % of the time that is 2.45 A root mean square, and 2 A are allowed.
        let warm = amplitude(r#"amplitude = "9 V""#);
        assert_eq!(kinds(&warm, "pulses"), ["heating"]);
        assert_eq!(
            warm[0].text,
            "it heats the motor with 2.45 A root mean square, 2.00 A are allowed continuously: lower the amplitude of \
             [carriage.excitation]"
        );
        let weak = objections(&[(r#"command_limit = "9.5 V""#, r#"command_limit = "0.9 V""#)]);
        for run in ["jog-forward", "jog-backward", "pulses", "relay", "sweep"] {
            assert!(kinds(&weak, run).contains(&"command"), "{run}: {weak:?}");
        }
        // The sine comes on top of the friction below it: 9.4 V alone would be within the range of 9.5 V.
        let example = campaign(&[]);
        let loud = Experiments { sweep_v: 9.4, ..Experiments::default() };
        let steps = tuning(example.plan.as_ref().unwrap(), 1.35, &loud);
        assert_eq!(kinds(&judged(&example, &steps, None).1, "sweep"), ["command", "current", "heating"]);
    }

    #[test]
    fn pulses_that_a_soft_limit_would_end_are_refused_with_where_and_when() {
        let period = |to: &str| objections(&[(r#"period = "1 s""#, to)]);
        assert_eq!(period(r#"period = "2 s""#), []);
        let found = period(r#"period = "6 s""#);
        assert_eq!(kinds(&found, "pulses"), ["travel"]);
        // From 2.45 m at up to 0.6 m/s; without torque the axis with the heaviest body goes on for 1.5 m, to the soft limit at 4.89 m.
        let text = &found[0].text;
        let (end_m, cut_s) = (between(text, "come to ", " m after"), between(text, " m after ", " s of"));
        assert!((3.2..3.4).contains(&end_m) && (1.4..1.8).contains(&cut_s), "{text}");
        assert!(
            text.contains("of 20 s, where the controller ends") && text.contains("[carriage.excitation]"),
            "{text}"
        );
        // Near an end they are cut sooner.
        let near = objections(&[(r#"distance = "2.2 m""#, "start = \"2.3 m\"\ndistance = \"2.2 m\"")]);
        assert!(kinds(&near, "pulses").contains(&"travel"), "{near:?}");
    }

    #[test]
    fn what_the_controller_itself_would_refuse_of_an_excitation_is_refused_here() {
        let long = objections(&[(r#"duration = "20 s""#, r#"duration = "3 h""#)]);
        assert_eq!(kinds(&long, "pulses"), ["controller"]);
    }

    #[test]
    fn a_configuration_that_the_controller_does_not_take_is_reported_with_its_key_and_advice_that_can_be_followed() {
        let key = r#"unhomed_speed_limit = "0.018 m/s""#;
        let found = objections(&[(key, r#"unhomed_speed_limit = "0.3 m/s""#)]);
        assert_eq!((found[0].id.as_str(), found[0].kind), ("[rig.y]", "controller"));
        let text = &found[0].text;
        assert!(
            text.starts_with("unhomed_speed_limit is 0.3 m/s; from a fault at that speed the axis coasts up to"),
            "{text}"
        );
        assert!(text.contains("the low end switch opens 0.050 m before its hard stop"), "{text}");
        let advised = between(text, "Write unhomed_speed_limit = \"", " m/s\" or less");
        let with = |speed: f64| objections(&[(key, &format!("unhomed_speed_limit = \"{speed} m/s\""))]);
        assert_eq!(with(advised), []);
        assert_eq!(with(advised + 0.001).len(), 1);
        let found = objections(&[(r#"shaped_damping = "0.017 1""#, r#"shaped_damping = "0.95 1""#)]);
        assert_eq!(found[0].text, "controller.shaped_damping is 0.95; the controller accepts 0 to 0.9");
    }

    #[test]
    fn a_shaper_and_a_jerk_bound_take_their_time_from_the_steady_part() {
        let fastest = |changes: &[(&str, &str)]| {
            let (forecasts, _) = told(changes, None);
            let f = forecasts.into_iter().find(|f| f.id.contains("wet") && f.id.contains("550mm_s")).unwrap();
            (f.steady_s, f.duration_s)
        };
        // 2.2 m at 0.55 m/s take 4 s; a ramp 0.55/0.6 s; ZVD a damped period of 3.6 Hz.
        let (ramp_s, zvd_s) = (0.55 / 0.6, 1.0 / (3.6 * (1.0 - 0.017_f64.powi(2)).sqrt()));
        let is_near = |(steady, total): (f64, f64), delay: f64, jerk_s: f64| {
            (steady - (4.0 - ramp_s - jerk_s - delay)).abs() < 1e-9
                && (total - (4.0 + ramp_s + jerk_s + delay)).abs() < 1e-9
        };
        assert!(is_near(fastest(&[]), zvd_s, 0.0), "{:?}", fastest(&[]));
        let jerk = ("acceleration = \"0.6 m/s^2\"", "jerk = \"1.2 m/s^3\"\nacceleration = \"0.6 m/s^2\"");
        assert!(is_near(fastest(&[jerk]), zvd_s, 0.5), "{:?}", fastest(&[jerk]));
        let zv = ("robust_shaper = true", "robust_shaper = false");
        assert!(is_near(fastest(&[zv]), 0.5 * zvd_s, 0.0), "{:?}", fastest(&[zv]));
    }

    #[test]
    fn a_way_that_the_ramps_use_up_is_reported_with_a_way_that_is_enough() {
        let way = |to: f64| objections(&[(r#"distance = "2.2 m""#, &format!("distance = \"{to} m\""))]);
        let short = way(0.6);
        let text = &short.iter().find(|o| o.id.contains("550mm_s")).unwrap().text;
        // 0.55 (0.917 + 0.278) m.
        assert!(
            text.starts_with(
                "its ramps alone (with the shaper) need 0.66 m of travel and it has 0.60 m: no part of it is steady at 0.550 m/s"
            ),
            "{text}"
        );
        let enough_m = between(text, "1.55 s are needed, ", " m of travel in all");
        assert!(kinds(&way(enough_m), "550mm_s").is_empty());
        let less = way(enough_m - 0.02);
        assert!(less.iter().any(|o| o.text.starts_with("only 1.5")), "{less:?}");
        assert!(short.iter().chain(&less).all(|o| !o.text.contains("-0.")));
    }

    #[test]
    fn a_stand_still_that_gives_no_zero_after_the_tow_is_refused_where_there_is_a_sensor() {
        let still = |to: &str| objections(&[(r#"still = "5 s""#, to)]);
        let short = still(r#"still = "1 s""#);
        assert_eq!((short.len(), short[0].id.as_str(), short[0].kind), (1, "[carriage]", "still"));
        assert!(
            short[0].text.starts_with("still is 1 s; the force sensor's zero after a tow takes 0.5 s"),
            "{short:?}"
        );
        assert_eq!(still(r#"still = "1.5 s""#), []);
        assert_eq!(still("").len(), 0);
        let sensor = "[rig.force_sensor]\nrange = \"125 N\"\nresolution = \"0.0208333 N\"        # 1/48 N\nnoise = \"0.05 N\"                  \
                      # not in the paper\ndrift = \"0.2 N\"\ngain_standard = \"0.2 %\"           # of its certificate; not in the paper";
        assert_eq!(objections(&[(r#"still = "5 s""#, r#"still = "1 s""#), (sensor, "")]), []);
    }

    #[test]
    fn the_weight_that_is_advised_may_be_hung() {
        let weights = |heavy: f64| {
            objections(&[(r#"weights = ["1.5 N", "10 N"]"#, &format!("weights = [\"1.5 N\", \"{heavy} N\"]"))])
        };
        let found = weights(100.0);
        let text = &found.iter().find(|o| o.kind == "weight").unwrap().text;
        let advised = between(text, "hang at most ", " N");
        assert!(kinds(&weights(advised), "calibration").iter().all(|k| *k != "weight"), "{advised}");
        assert!(kinds(&weights(advised + 0.02), "calibration").contains(&"weight"), "{advised}");
    }

    #[test]
    fn a_floor_outside_the_travel_is_refused_by_itself() {
        let found = objections(&[(r#"floor = "4.05 m""#, r#"floor = "-1 m""#)]);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!((found[0].id.as_str(), found[0].kind), ("[carriage.calibration]", "weight"));
        assert!(found[0].text.contains("at -1.000 m, outside the travel from -0.050 to 4.950 m"), "{found:?}");
    }

    #[test]
    fn an_assumed_volume_is_reported_where_the_coast_hangs_on_it() {
        let far = [(r#"distance = "2.2 m""#, r#"distance = "4.7 m""#)];
        let guessed = told(&far, Some(6.283e-3)).1;
        let coasts: Vec<_> = guessed.iter().filter(|o| o.kind == "coast").collect();
        assert!(!coasts.is_empty());
        for o in coasts {
            assert!(
                o.text.ends_with("There is no volume in [body]: that of a 6.3 litre body is assumed"),
                "{}",
                o.text
            );
        }
        assert!(told(&far, None).1.iter().all(|o| !o.text.contains("litre")));
    }
}
