//! Excitations: what they put out, and that they stay inside the soft limits.

use froude_control::config::Config;
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Phase, Refusal};
use proptest::prelude::*;

use crate::rig::{Rig, homed_at};

/// Homed and standing at `position_m`.
fn standing_at(position_m: f64) -> Rig {
    let mut rig = homed_at(0.02);
    let profile =
        Move { target_m: position_m, speed_m_s: 0.3, acceleration_m_s2: 1.0, jerk_m_s3: 0.0, is_shaped: false };
    rig.until(Some(Request::Move { axis: 0, profile }), 30.0, |o| o.status.axes[0].phase == Phase::Holding);
    for _ in 0..4000 {
        rig.step(None);
    }
    rig
}

fn excite(rig: &mut Rig, excitation: Excitation) -> Option<Refusal> {
    rig.step(Some(Request::Excite { axis: 0, excitation })).status.refusal
}

#[test]
fn pulses_are_on_for_their_part_of_the_period_and_alternate() {
    let mut rig = standing_at(2.0);
    assert_eq!(excite(&mut rig, Excitation::Pulses { volts: 0.9, period_s: 1.0, duty: 0.6, duration_s: 4.0 }), None);
    for i in 1..16_000 {
        let volts = rig.step(None).command.axes[0].volts;
        let sign = if (i / 4000) % 2 == 0 { 0.9 } else { -0.9 };
        assert_eq!(volts, if i % 4000 < 2400 { sign } else { 0.0 }, "tick {i}");
    }
    let output = rig.until(None, 2.0, |o| o.status.axes[0].phase == Phase::Holding);
    assert_eq!(output.status.fault, None);
}

/// The relay's command changes sign only beyond the hysteresis, and the axis oscillates about where it stood.
#[test]
fn a_relay_oscillates_about_its_position() {
    let mut rig = standing_at(2.0);
    let from_m = rig.output.status.axes[0].position_m;
    assert_eq!(excite(&mut rig, Excitation::Relay { volts: 1.0, hysteresis_m: 0.5e-3, duration_s: 5.0 }), None);
    let (mut last, mut switches, mut reach_m) = (1.0, 0, 0.0_f64);
    for _ in 0..19_000 {
        let output = rig.step(None);
        let volts = output.command.axes[0].volts;
        let error_m = from_m - output.status.axes[0].position_m;
        assert_eq!(volts.abs(), 1.0);
        if volts != last {
            switches += 1;
            assert!(error_m * volts > 0.5e-3, "{error_m} {volts}");
        }
        last = volts;
        reach_m = reach_m.max(error_m.abs());
    }
    assert!(switches > 10 && reach_m < 0.02, "{switches} {reach_m}");
    assert_eq!(rig.until(None, 2.0, |o| o.status.axes[0].phase == Phase::Holding).status.fault, None);
}

/// The sweep's sine against the same phase by library sine: f(t) = f₀ (f₁/f₀)^(t/T).
#[test]
fn a_sweep_adds_its_sine_to_the_loop() {
    let mut with = standing_at(2.0);
    let mut without = with;
    let sweep = |volts| Excitation::Sweep { volts, from_hz: 5.0, to_hz: 50.0, duration_s: 2.0, speed_m_s: 0.0 };
    // Stiff in friction: the axis does not move under 0.2 V, so that the loop puts out the same but for the sine.
    assert_eq!(excite(&mut with, sweep(0.2)), None);
    assert_eq!(excite(&mut without, sweep(0.0)), None);
    let ratio = 10_f64.powf(1.0 / 8000.0);
    let (mut phase, mut step) = (0.0_f64, 2.0 * std::f64::consts::PI * 5.0 / 4000.0);
    for i in 1..7999 {
        phase += step;
        step *= ratio;
        let added = with.step(None).command.axes[0].volts - without.step(None).command.axes[0].volts;
        // Rounding of 8000 turns.
        assert!((added - 0.2 * phase.sin()).abs() < 1e-11, "tick {i}: {added} {}", 0.2 * phase.sin());
    }
}

#[test]
fn a_sweep_under_way_keeps_its_speed_and_ends_at_rest() {
    let mut rig = standing_at(1.0);
    let sweep = Excitation::Sweep { volts: 0.5, from_hz: 1.0, to_hz: 40.0, duration_s: 4.0, speed_m_s: 0.2 };
    assert_eq!(excite(&mut rig, sweep), None);
    for _ in 0..8000 {
        rig.step(None);
    }
    assert_eq!(rig.output.status.axes[0].reference_m_s, 0.2);
    let output = rig.until(None, 5.0, |o| o.status.axes[0].phase == Phase::Holding);
    assert_eq!(output.status.fault, None);
    // Two ramps of 0.2 s, 4 s between them.
    assert!(
        (output.status.axes[0].reference_m - 1.0 - 0.2 * 4.2).abs() < 1e-3,
        "{}",
        output.status.axes[0].reference_m
    );
}

#[test]
fn a_jog_ends_at_its_distance_and_is_allowed_before_homing() {
    let mut rig = Rig::new(&Config::PUBLISHED, 0.5);
    rig.step(Some(Request::Enable { axis: 0 }));
    let pulses = Excitation::Pulses { volts: 1.0, period_s: 1.0, duty: 0.6, duration_s: 4.0 };
    assert_eq!(excite(&mut rig, pulses), Some(Refusal::NotHomed));
    assert_eq!(excite(&mut rig, Excitation::Jog { volts: -1.0, distance_m: 0.01, duration_s: 3.0 }), None);
    let output = rig.until(None, 3.0, |o| o.status.axes[0].phase == Phase::Holding);
    assert_eq!(output.status.fault, None);
    let way_m = 0.5 - rig.plants[0].position_m;
    assert!(way_m > 0.01 && way_m < 0.0125, "{way_m}");
}

#[test]
fn what_cannot_be_put_out_is_refused() {
    let mut rig = standing_at(2.0);
    let refused = Some(Refusal::OutOfRange);
    assert_eq!(excite(&mut rig, Excitation::Jog { volts: 10.1, distance_m: 0.01, duration_s: 1.0 }), refused);
    assert_eq!(excite(&mut rig, Excitation::Jog { volts: f64::NAN, distance_m: 0.01, duration_s: 1.0 }), refused);
    assert_eq!(excite(&mut rig, Excitation::Pulses { volts: 1.0, period_s: 1.0, duty: 1.1, duration_s: 1.0 }), refused);
    assert_eq!(excite(&mut rig, Excitation::Relay { volts: 1.0, hysteresis_m: -0.1, duration_s: 1.0 }), refused);
    let sweep = |to_hz, speed_m_s| Excitation::Sweep { volts: 1.0, from_hz: 1.0, to_hz, duration_s: 10.0, speed_m_s };
    assert_eq!(excite(&mut rig, sweep(1001.0, 0.1)), refused);
    assert_eq!(excite(&mut rig, sweep(0.5, 0.1)), refused);
    // 10 s at 0.4 m/s are 4 m.
    assert_eq!(excite(&mut rig, sweep(100.0, 0.4)), Some(Refusal::BeyondTravel));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// From any place, with any amplitude: the axis ends inside and at rest, without a fault.
    #[test]
    fn open_loop_excitations_end_inside_the_soft_limits(
        start_m in 0.02..4.8, volts in -10.0..10.0, period_s in 0.1..3.0, duty in 0.3..1.0, is_jog: bool,
    ) {
        let mut rig = standing_at(start_m);
        rig.plants[0].coulomb_n_m = rig.plants[0].drive.coulomb_lower_n_m;
        let excitation = if is_jog {
            Excitation::Jog { volts, distance_m: 0.1, duration_s: 3.0 }
        } else {
            Excitation::Pulses { volts, period_s, duty, duration_s: 3.0 }
        };
        prop_assert_eq!(excite(&mut rig, excitation), None);
        for _ in 0..20_000 {
            let status = rig.step(None).status;
            prop_assert_eq!(status.fault, None, "{:?}", status.axes[0]);
            let limits = rig.config.axes[0].limits;
            let position_m = rig.plants[0].position_m;
            prop_assert!(position_m > limits.low_switch_m && position_m < limits.high_switch_m, "{}", position_m);
        }
        prop_assert_eq!(rig.output.status.axes[0].phase, Phase::Holding);
    }
}
