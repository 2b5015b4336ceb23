//! What a hung weight does when the torque fails.

use crate::carriage::plan::PlannedRun;
use froude_control::coast::Coast;
use froude_control::config::AxisConfig;

use crate::campaign::preflight::forecast::{Expected, at_most};

/// What a hung weight does when the torque fails, where that does not end inside the travel.
///
/// It is held for sure by F = η C n/R (all friction behind the gear, its lower bound). A heavier weight W pulls the carriage from the
/// highest place of the run to where the weight rests on its floor, h below, and friction stops it from there: whatever the mass,
/// F s = (W − F) h, and the coast from the run's own speed comes on top.
pub(super) fn fall(
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
