//! Whatever is accepted stays inside the hard stops, also when the torque is lost at any moment.

use froude_control::coast::Coast;
use froude_control::config::{AxisConfig, Config};
use froude_control::fault::StopCategory;
use froude_control::request::{Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_control::tick::Tick;
use froude_control::travel::preflight;
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// An operator's stop keeps the move's acceleration and jerk: no step of the reference's acceleration is larger than one tick of it.
    #[test]
    fn an_operators_stop_is_as_smooth_as_its_move(
        speed_m_s in 0.05..0.6, acceleration_m_s2 in 0.1..1.0, jerk_m_s3 in 0.5..20.0, part in 0.0..1.0, is_shaped: bool,
    ) {
        let mut config = Config::PUBLISHED;
        (config.axes[0].mode_hz, config.axes[0].mode_damping) = (3.0, 0.05);
        let mut rig = homed(&config, 0.02);
        let profile = Move { target_m: 2.0, speed_m_s, acceleration_m_s2, jerk_m_s3, is_shaped };
        prop_assert_eq!(rig.step(Some(Request::Move { axis: 0, profile })).status.refusal, None);
        let ticks = (part * 1.0 * 4000.0) as u32;
        let mut last = rig.output.status.axes[0];
        for i in 0..20_000 {
            let status = rig.step((i == ticks).then_some(Request::Stop(StopCategory::Two))).status.axes[0];
            let step_m_s3 = (status.reference_m_s2 - last.reference_m_s2).abs() / 250e-6;
            prop_assert!(step_m_s3 <= jerk_m_s3 * (1.0 + 1e-6), "tick {}: {} of {}", i, step_m_s3, jerk_m_s3);
            prop_assert!(status.reference_m_s2.abs() <= acceleration_m_s2 * (1.0 + 1e-9));
            last = status;
            if status.phase == Phase::Holding {
                break;
            }
        }
        prop_assert_eq!(last.phase, Phase::Holding);
        prop_assert_eq!(rig.output.status.fault, None);
    }
}

/// What may break in the middle of a move.
#[derive(Debug, Clone, Copy)]
enum Injury {
    FrozenEncoder,
    ReversedEncoder,
    LostCounts(u32),
    EmergencyStop,
    Load(f64),
    SilentHost,
    LostTicks(u32),
    DeadAmplifier,
}

fn any_injury() -> impl Strategy<Value = Injury> {
    prop_oneof![
        Just(Injury::FrozenEncoder),
        Just(Injury::ReversedEncoder),
        (1_u32..1000).prop_map(Injury::LostCounts),
        Just(Injury::EmergencyStop),
        (-20.0..20.0).prop_map(Injury::Load),
        Just(Injury::SilentHost),
        (1_u32..40).prop_map(Injury::LostTicks),
        Just(Injury::DeadAmplifier),
    ]
}

/// Ticks that every injury is watched for, and most that it takes until the axis stands: 6 s and 12 s.
const LEAST_TICKS: u32 = 24_000;
const MOST_TICKS: u32 = 48_000;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// An axis that is hurt anywhere in an accepted move, also near the end of travel, stays inside the hard stops and comes to rest,
    /// or goes on as if nothing had been.
    #[test]
    fn an_injury_at_any_moment_ends_inside_the_hard_stops(
        target_m in 0.2..1.4, speed_m_s in 0.02..0.6, acceleration_m_s2 in 0.1..1.0, part in 0.0..1.1, is_down: bool, injury in any_injury(),
    ) {
        let mut rig = slippery(&short_tank());
        if is_down && ask(&mut rig, 1.3, 0.3, 1.0, 0.0).is_none() {
            rig.until(None, 20.0, |o| o.status.axes[0].phase == Phase::Holding);
        }
        let from_m = rig.plants[0].position_m;
        let target_m = if is_down { 1.41 - target_m } else { target_m };
        prop_assume!(ask(&mut rig, target_m, speed_m_s, acceleration_m_s2, 0.0).is_none());
        let ticks = (part * ((target_m - from_m).abs() / speed_m_s + speed_m_s / acceleration_m_s2) * 4000.0) as u32;
        for _ in 0..ticks {
            rig.step(None);
        }
        let limits = rig.config.axes[0].limits;
        let is_at_rest = |rig: &Rig| {
            matches!(rig.output.status.axes[0].phase, Phase::Disabled | Phase::Holding | Phase::Moving)
        };
        for i in 0..MOST_TICKS {
            // An encoder that freezes within a count of the target is noticed once the integral has moved the axis, which takes seconds.
            if i >= LEAST_TICKS && is_at_rest(&rig) {
                break;
            }
            match injury {
                Injury::FrozenEncoder if i == 0 => rig.plants[0].frozen_count = Some(rig.plants[0].input().encoder_count),
                Injury::ReversedEncoder if i == 0 => {
                    let before = rig.plants[0].input().encoder_count;
                    rig.plants[0].encoder_polarity = -1.0;
                    let after = rig.plants[0].input().encoder_count;
                    rig.plants[0].count_at_zero = rig.plants[0].count_at_zero.wrapping_add(before.wrapping_sub(after));
                }
                Injury::LostCounts(counts) if i == 0 => {
                    rig.plants[0].count_at_zero = rig.plants[0].count_at_zero.wrapping_add(counts);
                }
                Injury::Load(load_n) => rig.plants[0].load_n = if i < 400 { load_n } else { 0.0 },
                Injury::LostTicks(ticks) if i == 0 => {
                    for _ in 0..ticks {
                        let command = rig.output.command.axes[0];
                        rig.plants[0].step(command, 250e-6);
                        rig.tick.latched_us = rig.tick.latched_us.wrapping_add(250);
                    }
                }
                _ => {}
            }
            rig.step_with(None, |t| {
                t.is_estop_open = matches!(injury, Injury::EmergencyStop);
                t.is_host_heard = !matches!(injury, Injury::SilentHost);
                t.axes[0].is_amplifier_ready = !matches!(injury, Injury::DeadAmplifier);
            });
            let position_m = rig.plants[0].position_m;
            prop_assert!(position_m > limits.hard_low_m && position_m < limits.hard_high_m, "{} {:?}", position_m, rig.output.status);
        }
        prop_assert!(is_at_rest(&rig), "{:?}", rig.output.status);
    }
}

#[test]
fn a_move_that_could_coast_into_the_stop_is_refused_and_a_slower_one_is_not() {
    let mut rig = slippery(&short_tank());
    // Braking at 1 m/s² from 0.6 m/s takes 0.18 m, coasting 0.39 m: 0.21 m more than are left behind the target.
    assert_eq!(ask(&mut rig, 1.38, 0.6, 1.0, 0.0), Some(Refusal::BeyondTravel));
    assert_eq!(ask(&mut rig, 1.38, 0.2, 0.3, 0.0), None);
}

/// The numbers behind a refusal, by the rules that refuse.
#[test]
fn preflight_says_what_the_controller_will_say_with_the_numbers() {
    let config = short_tank();
    let foresee = |target_m, speed_m_s| {
        let asked = Move { target_m, speed_m_s, acceleration_m_s2: 1.0, jerk_m_s3: 0.0, is_shaped: false };
        preflight(&config, &config.axes[0], 0.02, &asked)
    };
    let fast = foresee(1.38, 0.6);
    assert_eq!(fast.refusal, Some(Refusal::BeyondTravel));
    // Coast 0.37 m and its margins less 0.18 m of braking; 0.07 m are left.
    let coast_m = Coast::of(&config.axes[0].drive).distance_m(0.6);
    assert!(
        (fast.needed_m - (coast_m - 0.18)).abs() < 0.03 && (fast.free_m - 0.07).abs() < 1e-12,
        "{fast:?} {coast_m}"
    );
    assert!((fast.duration_s - (1.36 / 0.6 + 0.6)).abs() < 1e-12);
    // J a + B ω + C over K_T K_amp.
    let ratio = 34.97 / 0.055;
    let volts = (1.502e-5 * ratio + 4.657e-6 * 0.6 * ratio + 3.9e-3) / (26.7e-3 * 0.352);
    assert!((fast.command_v - volts).abs() < 1e-12 && fast.available_v == 10.0);
    assert_eq!(foresee(1.0, 0.6).refusal, None);
    assert_eq!(foresee(1.0, 0.7).refusal, Some(Refusal::OutOfRange));
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
fn a_switch_that_opened_without_torque_must_be_closed_before_a_move() {
    let mut rig = slippery(&short_tank());
    rig.until(Some(Request::Disable { axis: 0 }), 1.0, |o| o.status.axes[0].phase == Phase::Disabled);
    let broken = |t: &mut Tick| t.axes[0].is_high_end = true;
    rig.step_with(None, broken);
    assert_eq!(rig.step_with(Some(Request::Enable { axis: 0 }), broken).status.refusal, None);
    let profile = Move { target_m: 0.5, speed_m_s: 0.1, acceleration_m_s2: 1.0, jerk_m_s3: 0.0, is_shaped: false };
    let output = rig.step_with(Some(Request::Move { axis: 0, profile }), broken);
    assert_eq!((output.status.refusal, output.status.fault), (Some(Refusal::EndSwitchOpen), None));
    assert_eq!(ask(&mut rig, 0.5, 0.1, 1.0, 0.0), None);
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
