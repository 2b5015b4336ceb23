//! Whatever is accepted stays inside the hard stops, also when the torque is lost at any moment.

use froude_control::config::{AxisConfig, Config};
use froude_control::fault::StopCategory;
use froude_control::request::{Move, Request};
use froude_control::status::{Phase, Refusal};
use proptest::prelude::*;

use crate::rig::{Rig, homed};

/// A short tank, so that a case is quick; friction as low as its declared bound allows.
fn short_tank() -> Config {
    let mut config = Config::PUBLISHED;
    for axis in &mut config.axes {
        axis.limits.hard_high_m = 1.45;
        axis.limits.high_switch_m = 1.4;
    }
    config
}

fn slippery(config: &Config) -> Rig {
    let mut rig = homed(config, 0.02);
    for plant in &mut rig.plants {
        plant.coulomb_n_m = plant.drive.coulomb_lower_n_m;
    }
    rig
}

fn ask(rig: &mut Rig, target_m: f64, speed_m_s: f64, acceleration_m_s2: f64, jerk_m_s3: f64) -> Option<Refusal> {
    let profile = Move { target_m, speed_m_s, acceleration_m_s2, jerk_m_s3, is_shaped: false };
    rig.step(Some(Request::Move { axis: 0, profile })).status.refusal
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn torque_lost_at_any_moment_of_a_move_ends_before_the_hard_stop(
        target_m in 0.2..1.4, speed_m_s in 0.05..0.6, acceleration_m_s2 in 0.1..1.0, jerk_m_s3 in prop_oneof![Just(0.0), 1.0..50.0],
        part in 0.0..1.2, category in prop_oneof![Just(StopCategory::Zero), Just(StopCategory::One), Just(StopCategory::Two)],
    ) {
        let mut rig = slippery(&short_tank());
        if let Some(refusal) = ask(&mut rig, target_m, speed_m_s, acceleration_m_s2, jerk_m_s3) {
            prop_assert_eq!(refusal, Refusal::BeyondTravel);
            return Ok(());
        }
        let from_m = rig.plants[0].position_m;
        let ticks = (part * ((target_m - from_m) / speed_m_s + speed_m_s / acceleration_m_s2) * 4000.0) as u32;
        for _ in 0..ticks {
            rig.step(None);
        }
        let output = rig.until(Some(Request::Stop(category)), 10.0, |o| {
            matches!(o.status.axes[0].phase, Phase::Disabled | Phase::Holding)
        });
        let plant = rig.plants[0];
        prop_assert!(plant.position_m < rig.config.axes[0].limits.hard_high_m, "{}", plant.position_m);
        prop_assert!(plant.speed_m_s.abs() < 1e-3);
        prop_assert_eq!(output.status.fault, None);
        let expected = if category == StopCategory::Two { Phase::Holding } else { Phase::Disabled };
        prop_assert_eq!(output.status.axes[0].phase, expected);
        // A stop with torque ends where the move was going, or before.
        if category != StopCategory::Zero {
            prop_assert!(plant.position_m < target_m + 1e-3);
        }
    }
}

#[test]
fn a_move_that_could_coast_into_the_stop_is_refused_and_a_slower_one_is_not() {
    let mut rig = slippery(&short_tank());
    // Braking at 1 m/s² from 0.6 m/s takes 0.18 m, coasting 0.39 m: 0.21 m more than are left behind the target.
    assert_eq!(ask(&mut rig, 1.38, 0.6, 1.0, 0.0), Some(Refusal::BeyondTravel));
    assert_eq!(ask(&mut rig, 1.38, 0.2, 0.3, 0.0), None);
}

#[test]
fn targets_outside_the_soft_limits_and_numbers_out_of_range_are_refused() {
    let mut rig = slippery(&short_tank());
    let limits = AxisConfig::PUBLISHED.limits;
    assert_eq!(ask(&mut rig, 1.395, 0.1, 1.0, 0.0), Some(Refusal::BeyondTravel));
    assert_eq!(ask(&mut rig, 0.0, 0.1, 1.0, 0.0), Some(Refusal::BeyondTravel));
    assert_eq!(ask(&mut rig, 0.5, 1.01 * limits.speed_m_s, 1.0, 0.0), Some(Refusal::OutOfRange));
    assert_eq!(ask(&mut rig, 0.5, 0.1, 1.01 * limits.acceleration_m_s2, 0.0), Some(Refusal::OutOfRange));
    assert_eq!(ask(&mut rig, 0.5, 0.0, 1.0, 0.0), Some(Refusal::OutOfRange));
    assert_eq!(ask(&mut rig, f64::NAN, 0.1, 1.0, 0.0), Some(Refusal::OutOfRange));
    assert_eq!(ask(&mut rig, 0.5, 0.1, 1.0, -1.0), Some(Refusal::OutOfRange));
    assert_eq!(ask(&mut rig, 0.5, 0.1, 1.0, f64::INFINITY), Some(Refusal::OutOfRange));
    assert_eq!(ask(&mut rig, 0.5, 0.1, 1.0, 0.0), None);
    assert_eq!(ask(&mut rig, 0.5, 0.1, 1.0, 0.0), Some(Refusal::Busy));
}

#[test]
fn a_move_is_refused_before_homing_and_without_torque() {
    let mut rig = Rig::new(&short_tank(), 0.3);
    assert_eq!(ask(&mut rig, 0.5, 0.1, 1.0, 0.0), Some(Refusal::Disabled));
    rig.step(Some(Request::Enable { axis: 0 }));
    assert_eq!(ask(&mut rig, 0.5, 0.1, 1.0, 0.0), Some(Refusal::NotHomed));
    assert_eq!(rig.step(Some(Request::Enable { axis: 2 })).status.refusal, Some(Refusal::NoSuchAxis));
    let not_ready = rig.step_with(Some(Request::Enable { axis: 1 }), |t| t.axes[1].is_amplifier_ready = false);
    assert_eq!(not_ready.status.refusal, Some(Refusal::NotReady));
}
