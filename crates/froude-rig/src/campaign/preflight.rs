//! Every run is checked before anything moves: travel with coast, speed, command, current, heating, and what the controller would refuse.
//!
//! For a profile at speed v and acceleration a, with friction C, B and declared drag D (MCD eq. 3, 7):
//! peak torque J_eff θ̈ + B_eff θ̇ + C_eff + (R/n) D v² at the end of the ramp, over the gear's efficiency where it is declared;
//! command v_c = τ/(K_T K_amp), current i = K_amp v_c; heating as the mean of i² over the profile against the continuous current.
//! A jerk bound lengthens each ramp, a shaper the whole move; both shorten the part at constant speed.

mod excitation;
mod fall;
#[cfg(test)]
mod tests;
mod tow;

use froude_control::config::Config;
use froude_records::carriage::plan::{Drive, PlannedRun};
use froude_records::carriage::{CarriagePlan, RigSpec};

use super::setup;
use excitation::excitation;
use tow::{Way, tow};

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

/// Two decimals of a number that advice may quote as the most: never rounded up.
fn at_most(value: f64) -> f64 {
    (1e2 * value * (1.0 - 1e-9)).floor() / 1e2
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
