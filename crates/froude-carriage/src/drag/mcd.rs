//! Motor current difference, eq. 8: the command of the wet run less that of the dry run *at the same positions*.
//!
//! Friction that depends on position is in both and cancels; what differs from run to run stays and is the scatter of
//! the pairs. The difference is taken where both runs are steady, and from where it has settled: the wake of a body that starts
//! needs several of its lengths, as for the force sensor; and only where the motor drives the gear all the time.

use froude_fit::series::mean;

use super::run::{DragRun, Window};
use super::steady::reach;
use super::steady::{Rejected, SteadySettings, driving_part, settled_part, window};
use crate::drag::point::Point;

/// Shortest stretch of positions in common, as part of the wet window.
const SHARED: f64 = 0.5;
/// A change over the window by less than this part of the difference is no settling that matters.
const NO_MATTER: f64 = 1e-3;

/// The steady point of a wet and a dry run, in newtons by `force_per_volt_n`.
///
/// # Errors
///
/// [`Rejected`] when one of them has no steady window, they share too little of the tank, or their difference does not settle.
pub fn point(
    wet: &DragRun<'_>,
    dry: &DragRun<'_>,
    force_per_volt_n: f64,
    settings: SteadySettings,
) -> Result<Point, Rejected> {
    let in_dry = window(dry, settings)?;
    let friction_v = mean(in_dry.of(dry.command_v), dry.step_s()).value;
    let in_dry = driving_part(dry, in_dry, friction_v, settings)?;
    let in_wet = driving_part(wet, window(wet, settings)?, friction_v, settings)?;
    let [wet_low, wet_high] = reach(in_wet.of(wet.position_m));
    let [dry_low, dry_high] = reach(in_dry.of(dry.position_m));
    let shared_m = wet_high.min(dry_high) - wet_low.max(dry_low);
    let needed_m = SHARED * (wet_high - wet_low);
    if shared_m < needed_m {
        return Err(Rejected::Unusable(format!(
            "runs {:?} and {:?}: the steady windows share {:.2} m, {needed_m:.2} m are needed",
            wet.id,
            dry.id,
            shared_m.max(0.0)
        )));
    }
    let (difference_v, used) = difference(wet, in_wet, dry, in_dry);
    let slack = NO_MATTER * (difference_v.iter().sum::<f64>() / difference_v.len().max(1) as f64).abs();
    let settled = settled_part(wet, &difference_v, slack, settings)?;
    let m = mean(settled.of(&difference_v), wet.step_s());
    let used = Window { first: used.first + settled.first, end: used.end.min(used.first + settled.end) };
    Ok(Point::of(wet, used, &m, force_per_volt_n))
}

/// Wet less dry command, V, at the samples of the wet window whose positions the dry window reaches.
///
/// The dry command is interpolated on position. Samples in which the dry carriage did not get further (encoder steps,
/// a reversal by vibration) are passed over.
#[must_use]
pub fn difference(wet: &DragRun<'_>, in_wet: Window, dry: &DragRun<'_>, in_dry: Window) -> (Vec<f64>, Window) {
    let s = wet.direction;
    let (position, command) = (in_dry.of(dry.position_m), in_dry.of(dry.command_v));
    let mut out = Vec::with_capacity(in_wet.len());
    let (mut first, mut end) = (in_wet.first, in_wet.first);
    let mut last = 0; // the furthest dry sample at or behind the wet position
    let mut next = 0; // the first one beyond it
    for i in in_wet.first..in_wet.end {
        let here = s * wet.position_m[i];
        while next < position.len() && s * position[next] <= here {
            if s * position[next] >= s * position[last] {
                last = next;
            }
            next += 1;
        }
        if next == position.len() {
            break;
        }
        if next == 0 {
            continue;
        }
        let (low, high) = (s * position[last], s * position[next]);
        if high <= low || here < low {
            continue;
        }
        let part = (here - low) / (high - low);
        if out.is_empty() {
            first = i;
        }
        out.push(wet.command_v[i] - (command[last] + part * (command[next] - command[last])));
        end = i + 1;
    }
    (out, Window { first, end })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drag::run::BodyState;
    use crate::scenario::{Logged, Scenario};

    /// A bump of the whole friction, and a dry run that started 0.2 m earlier: paired by time, half the bump would stay.
    ///
    /// Interpolation between samples 2.5 mm apart leaves less than 2.5 N·(2.5 mm/0.27 m)²/8, three parts in 10⁵ of a newton.
    #[test]
    fn friction_over_position_cancels_also_when_the_runs_start_elsewhere() {
        let mut scenario = Scenario::pinned(20.0);
        (scenario.run_to_run, scenario.torque_drift, scenario.noise_n, scenario.bump) = (0.0, 0.0, 0.0, 1.0);
        scenario.pairs = 1;
        scenario.speeds_m_s = vec![0.5];
        let wet = scenario.runs(1);
        scenario.tow_m = [1.2, 3.7];
        let dry = scenario.runs(1);
        let pick = |all: &'_ [Logged], body: BodyState, direction: f64| {
            all.iter().position(|r| r.body == body && r.direction == direction).unwrap()
        };
        for direction in [1.0, -1.0] {
            let wet = wet[pick(&wet, BodyState::Wet, direction)].view();
            let dry = dry[pick(&dry, BodyState::Dry, direction)].view();
            let p = point(&wet, &dry, scenario.force_per_volt_n(), SteadySettings::default()).unwrap();
            assert!((p.force_n - direction * 20.0 * 0.25).abs() < 1e-4, "{direction}: {}", p.force_n);
            assert!((p.speed_m_s - direction * 0.5).abs() < 1e-9);
        }
    }

    #[test]
    fn windows_in_different_parts_of_the_tank_are_refused_with_what_they_share() {
        let mut scenario = Scenario::pinned(20.0);
        (scenario.pairs, scenario.speeds_m_s, scenario.out_and_back) = (1, vec![0.5], false);
        let wet = scenario.runs(1);
        scenario.tow_m = [2.6, 4.8];
        let dry = scenario.runs(1);
        let why = point(&wet[1].view(), &dry[0].view(), 5.0, SteadySettings::default()).unwrap_err().to_string();
        // 3.45 m where the wet window ends, less 2.98 m where the dry one begins.
        assert_eq!(
            why,
            "runs \"wet 1 +0.50 m/s\" and \"dry 1 +0.50 m/s\": the steady windows share 0.47 m, 0.83 m are needed"
        );
    }
}
