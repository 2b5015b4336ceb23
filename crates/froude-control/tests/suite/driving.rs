//! Enable, home, move and hold, on a rigid plant.

use crate::rig::{Rig, homed_at};
use froude_control::config::Config;
use froude_control::request::{Move, Request};
use froude_control::status::Phase;

#[test]
fn homing_sets_the_coordinate_within_the_way_of_one_tick() {
    for start_m in [0.4, -0.004] {
        let rig = homed_at(start_m);
        let status = rig.output.status.axes[0];
        assert!(status.is_homed, "{:?}", rig.output.status);
        // Ways of a tick at the homing speed, a count, and the plant's step within the tick.
        let tolerance_m = 0.05 * 250e-6 * 2.0 + 2.5e-6;
        assert!((status.position_m - rig.plants[0].position_m).abs() <= tolerance_m, "{status:?}");
    }
}

#[test]
fn a_move_arrives_and_holds() {
    let mut rig = homed_at(0.1);
    let profile = Move { target_m: 2.2, speed_m_s: 0.55, acceleration_m_s2: 0.8, jerk_m_s3: 0.0, is_shaped: false };
    let output =
        rig.until(Some(Request::Move { axis: 0, profile }), 10.0, |o| o.status.axes[0].phase == Phase::Holding);
    assert_eq!(output.status.axes[0].reference_m, 2.2);
    for _ in 0..4000 {
        rig.step(None);
    }
    let status = rig.output.status.axes[0];
    assert!((status.position_m - 2.2).abs() < 1e-4, "{status:?}");
    assert_eq!(rig.output.status.fault, None);
}
