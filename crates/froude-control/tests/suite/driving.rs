//! Enable, home, move and hold, on a rigid plant.

use crate::rig::{Rig, homed, homed_at};
use froude_control::config::Config;
use froude_control::fault::StopCategory;
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

/// The switch opens before the homing speed is reached: the axis goes back and comes again.
#[test]
fn homing_from_close_above_the_switch_is_as_good() {
    let rig = homed_at(0.0003);
    let tolerance_m = 0.05 * 250e-6 * 2.0 + 2.5e-6;
    let status = rig.output.status.axes[0];
    assert!((status.position_m - rig.plants[0].position_m).abs() <= tolerance_m, "{status:?}");
}

/// Beyond its open switch the drive can push the axis up and not hold it down: nothing is asked of it there, and a swing that lifts the
/// axis while it waits is let go.
#[test]
fn a_load_that_swings_back_over_the_switch_is_let_go() {
    for (push_n, ticks) in [(4.0, 400), (-6.0, 400), (4.0, 1_200), (6.0, 200)] {
        let mut rig = Rig::new(&Config::PUBLISHED, 0.05);
        rig.until(Some(Request::Enable { axis: 0 }), 0.1, |o| o.status.axes[0].phase == Phase::Holding);
        rig.until(Some(Request::Home { axis: 0 }), 10.0, |o| o.status.axes[0].reference_m.abs() < 0.02);
        rig.until(None, 10.0, |o| o.status.axes[0].reference_m_s == 0.0);
        rig.plants[0].load_n = push_n;
        let mut is_lifted = false;
        for tick in 0..40_000 {
            if tick == ticks {
                rig.plants[0].load_n = 0.0;
            }
            let output = rig.step(None);
            if rig.plants[0].input().is_low_end {
                assert!(output.command.axes[0].volts >= 0.0, "{push_n} N: {:?}", output.command);
            }
            is_lifted |= tick < ticks && rig.plants[0].speed_m_s > 1e-3;
            if output.status.axes[0].phase == Phase::Holding {
                break;
            }
        }
        let status = rig.output.status;
        assert_eq!(is_lifted, push_n > 0.0, "{push_n} N");
        assert!(status.axes[0].is_homed && status.fault.is_none(), "{push_n} N: {status:?}");
        assert!((status.axes[0].position_m - rig.plants[0].position_m).abs() < 3e-5, "{push_n} N: {status:?}");
    }
}

/// Counter and latch time start just before their wraps: nothing changes.
#[test]
fn a_run_over_all_wraps_is_the_same_run() {
    let run = |count_at_zero: u32, latched_us: u32| {
        let mut rig = Rig::new(&Config::PUBLISHED, 0.1);
        rig.tick.latched_us = latched_us;
        for plant in &mut rig.plants {
            plant.count_at_zero = count_at_zero;
        }
        let mut volts = Vec::new();
        for i in 0..40_000_u32 {
            let profile =
                Move { target_m: 1.0, speed_m_s: 0.4, acceleration_m_s2: 0.8, jerk_m_s3: 8.0, is_shaped: false };
            let request = match i {
                10 => Some(Request::Enable { axis: 0 }),
                20 => Some(Request::Home { axis: 0 }),
                24_000 => Some(Request::Move { axis: 0, profile }),
                _ => None,
            };
            let output = rig.step(request);
            assert_eq!((output.status.refusal, output.status.fault), (None, None), "tick {i}");
            assert_eq!(output.status.tick, u64::from(i));
            volts.push(output.command.axes[0].volts.to_bits());
        }
        assert!((rig.plants[0].position_m - 1.0).abs() < 1e-3);
        volts
    };
    assert_eq!(run(0, 0), run(u32::MAX - 50_000, u32::MAX - 1_000_000));
}

/// With the encoder mounted the other way round and declared so, the axis does the same.
#[test]
fn a_declared_encoder_sign_changes_nothing() {
    let mut config = Config::PUBLISHED;
    for axis in &mut config.axes {
        axis.drive.encoder_sign = -1.0;
    }
    let rig = homed(&config, 0.1);
    assert!((rig.output.status.axes[0].position_m - rig.plants[0].position_m).abs() < 30e-6);
}

/// Both axes at once; they do not know of each other.
#[test]
fn two_axes_move_together_as_each_alone() {
    let run = |axes: &[usize]| {
        let mut rig = Rig::new(&Config::PUBLISHED, 0.1);
        for axis in axes {
            rig.step(Some(Request::Enable { axis: *axis }));
        }
        while rig.output.status.tick < 9 {
            rig.step(None);
        }
        rig.step(axes.contains(&0).then_some(Request::Home { axis: 0 }));
        rig.step(axes.contains(&1).then_some(Request::Home { axis: 1 }));
        for _ in 0..30_000 {
            rig.step(None);
        }
        (rig.plants[0].position_m.to_bits(), rig.plants[1].position_m.to_bits())
    };
    let both = run(&[0, 1]);
    assert_eq!(run(&[0]).0, both.0);
    assert!(f64::from_bits(both.1) > 0.0 && f64::from_bits(both.1) < 0.02);
}

/// Steady tracking with feed-forward and integral: the mean error over the cruise is less than a count, 2.5 µm; the paper's Table III
/// has millimetres.
#[test]
fn the_mean_error_at_constant_speed_is_below_a_count() {
    let mut rig = homed_at(0.02);
    let profile = Move { target_m: 2.2, speed_m_s: 0.55, acceleration_m_s2: 0.8, jerk_m_s3: 0.0, is_shaped: false };
    rig.step(Some(Request::Move { axis: 0, profile }));
    let (mut sum_m, mut count) = (0.0, 0.0);
    for i in 0..12_000 {
        let status = rig.step(None).status.axes[0];
        if i > 5_000 {
            sum_m += status.reference_m - status.position_m;
            count += 1.0;
        }
    }
    let mean_m: f64 = sum_m / count;
    assert!(mean_m.abs() < 2.5e-6, "{mean_m}");
}

/// The axis stands within a count or two for ten seconds and the loop does not hunt.
#[test]
fn a_held_axis_does_not_hunt() {
    let mut rig = homed_at(0.02);
    for _ in 0..4000 {
        rig.step(None);
    }
    let from = rig.output.status.axes[0].count;
    for _ in 0..40_000 {
        let status = rig.step(None).status.axes[0];
        assert!((status.count - from).abs() <= 2, "{status:?}");
    }
}

/// A stop in the first tenth of a gentle move: the reference makes 70 µm and the axis may stay where friction holds it.
#[test]
fn an_axis_that_friction_holds_is_not_called_stuck() {
    let mut config = Config::PUBLISHED;
    (config.axes[0].mode_hz, config.axes[0].mode_damping) = (3.0, 0.05);
    for ticks in [50, 223, 400] {
        let mut rig = homed(&config, 0.02);
        let profile = Move { target_m: 2.0, speed_m_s: 0.05, acceleration_m_s2: 0.1, jerk_m_s3: 2.0, is_shaped: true };
        rig.step(Some(Request::Move { axis: 0, profile }));
        for i in 0..8000 {
            let request = (i == ticks).then_some(Request::Stop(StopCategory::Two));
            assert_eq!(rig.step(request).status.fault, None, "stop at {ticks}, tick {i}");
        }
    }
}
