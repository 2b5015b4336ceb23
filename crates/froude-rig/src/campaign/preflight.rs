//! Every run is checked before anything moves: travel with coast, speed, command, current, heating, and what the controller would refuse.
//!
//! For a profile at speed v and acceleration a, with friction C, B and declared drag D (MCD eq. 3, 7):
//! peak torque J_eff θ̈ + B_eff θ̇ + C_eff + (R/n) D v² at the end of the ramp, over the gear's efficiency where it is declared;
//! command v_c = τ/(K_T K_amp), current i = K_amp v_c; heating as the mean of i² over the profile against the continuous current.
//! A jerk bound lengthens each ramp, a shaper the whole move; both shorten the part at constant speed.

mod excitation;
mod fall;
mod forecast;
mod report;
#[cfg(test)]
mod tests;
mod tow;

use crate::carriage::plan::{Drive, PlannedRun};
use crate::carriage::{CarriagePlan, RigSpec};
use excitation::excitation;
use froude_control::config::Config;
use tow::{Way, tow};

use super::setup;

pub use crate::campaign::preflight::forecast::{Expected, Forecast, Objection, SHORTEST_STEADY_S};

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
        Drive::Excitation { excitation: asked, .. } => excitation(run, asked, control, expected),
    }
}
