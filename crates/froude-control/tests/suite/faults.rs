//! Every fault: what raises it, how soon, how the axis is stopped, how it is cleared.

use froude_control::config::Config;
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_control::tick::Tick;

use crate::rig::{Rig, homed, homed_at};

/// At 0.3 m/s in the middle of a long move.
fn cruising() -> Rig {
    cruising_with(&Config::PUBLISHED)
}

fn cruising_with(config: &Config) -> Rig {
    let mut rig = homed(config, 0.02);
    let profile = Move { target_m: 2.5, speed_m_s: 0.3, acceleration_m_s2: 0.8, jerk_m_s3: 0.0, is_shaped: false };
    assert_eq!(rig.step(Some(Request::Move { axis: 0, profile })).status.refusal, None);
    for _ in 0..6000 {
        rig.step(None);
    }
    assert!((rig.plants[0].speed_m_s - 0.3).abs() < 0.01 && rig.output.status.fault.is_none(), "{:?}", rig.output);
    rig
}

/// Spoils every tick until the fault comes, at most `ticks` of them; then lets the stop run its course and clears the fault.
fn expect(mut rig: Rig, fault: Fault, ticks: u32, spoil: impl Fn(&mut Tick)) -> Rig {
    let mut output = rig.output;
    let speed_m_s = rig.plants[0].speed_m_s;
    for _ in 0..ticks {
        output = rig.step_with(None, &spoil);
        if output.status.fault.is_some() {
            break;
        }
    }
    assert_eq!(output.status.fault.map(|(f, _)| f), Some(fault));
    let phase = output.status.axes[0].phase;
    if fault.category() == StopCategory::Zero {
        assert_eq!(phase, Phase::Coasting);
        assert!(!output.command.axes[0].is_enabled && output.command.axes[0].volts == 0.0);
    } else {
        assert_eq!(phase, Phase::Stopping);
    }
    // The first fault stays although others follow.
    let from_m = rig.plants[0].position_m;
    for i in 0..16_000 {
        output = rig.step_with(None, |t| t.axes[0].current_a = if i < 15_999 { t.axes[0].current_a } else { f64::NAN });
        assert_eq!(output.status.fault.map(|(f, _)| f), Some(fault));
    }
    assert_eq!(output.status.axes[0].phase, Phase::Disabled);
    assert!(rig.plants[0].speed_m_s == 0.0);
    if fault.category() == StopCategory::One {
        // v²/2a at 1 m/s², and what the loop lags.
        let way_m = (rig.plants[0].position_m - from_m).abs();
        assert!(way_m < 0.5 * speed_m_s * speed_m_s + 0.02, "{way_m}");
    }
    rig.step(None);
    assert_eq!(rig.step(Some(Request::Enable { axis: 0 })).status.refusal, Some(Refusal::Faulted));
    let other = if fault == Fault::NotFinite { Fault::TickLate } else { Fault::NotFinite };
    assert_eq!(rig.step(Some(Request::Clear(other))).status.refusal, Some(Refusal::NotCleared));
    assert_eq!(rig.step(Some(Request::Clear(fault))).status.refusal, None);
    assert_eq!(rig.output.status.fault, None);
    assert_eq!(rig.output.status.axes[0].phase, Phase::Disabled);
    rig
}

#[test]
fn emergency_stop_end_switch_and_amplifier_cut_the_torque_in_the_same_tick() {
    expect(cruising(), Fault::EmergencyStop, 1, |t| t.is_estop_open = true);
    expect(cruising(), Fault::EndSwitch, 1, |t| t.axes[0].is_low_end = true);
    expect(cruising(), Fault::EndSwitch, 1, |t| t.axes[0].is_high_end = true);
    expect(cruising(), Fault::AmplifierNotReady, 1, |t| t.axes[0].is_amplifier_ready = false);
}

#[test]
fn an_open_emergency_stop_cannot_be_cleared() {
    let mut rig = Rig::new(&Config::PUBLISHED, 0.3);
    rig.step_with(None, |t| t.is_estop_open = true);
    let still = rig.step_with(Some(Request::Clear(Fault::EmergencyStop)), |t| t.is_estop_open = true);
    assert_eq!(still.status.refusal, Some(Refusal::NotCleared));
    assert_eq!(rig.step(Some(Request::Clear(Fault::EmergencyStop))).status.refusal, None);
}

#[test]
fn a_current_that_is_not_finite_too_high_or_off_the_command_cuts_the_torque() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        expect(cruising(), Fault::NotFinite, 1, |t| t.axes[0].current_a = bad);
    }
    // 1 ms above the peak; 10 ms off the command.
    expect(cruising(), Fault::OverCurrent, 4, |t| t.axes[0].current_a = -5.1);
    expect(cruising(), Fault::OverCurrent, 40, |t| t.axes[0].current_a = 2.5);
}

/// Above the continuous current I_c the time to fill is τ ln(r²/(r² − 1)), r = I/I_c.
#[test]
fn the_thermal_model_fills_in_its_closed_form_time() {
    let mut config = Config::PUBLISHED;
    config.axes[0].limits.continuous_current_a = 1.0;
    config.axes[0].limits.thermal_time_s = 2.0;
    let mut rig = Rig::new(&config, 0.3);
    let ticks = (2.0 * (4.0_f64 / 3.0).ln() * 4000.0).round() as u32;
    for _ in 0..ticks - 2 {
        assert_eq!(rig.step_with(None, |t| t.axes[0].current_a = 2.0).status.fault, None);
    }
    let mut after = 0;
    while rig.step_with(None, |t| t.axes[0].current_a = 2.0).status.fault.is_none() {
        after += 1;
        assert!(after < 4);
    }
    assert_eq!(rig.output.status.fault, Some((Fault::Overload, 0)));
    assert_eq!(rig.step(Some(Request::Clear(Fault::Overload))).status.refusal, Some(Refusal::NotCleared));
    // It cools to 0.9 after τ ln(1/0.9) and is then cleared.
    for _ in 0..900 {
        rig.step(None);
    }
    assert_eq!(rig.step(Some(Request::Clear(Fault::Overload))).status.refusal, None);
    assert_eq!(Fault::Overload.category(), StopCategory::One);
}

#[test]
fn an_encoder_that_stands_still_at_speed_is_stuck_at_once_and_costs_the_coordinate() {
    let rig = cruising();
    let frozen = rig.tick.axes[0].encoder_count;
    let mut rig = expect(rig, Fault::EncoderStuck, 2, |t| t.axes[0].encoder_count = frozen);
    assert!(!rig.output.status.axes[0].is_homed);
    rig.step(Some(Request::Enable { axis: 0 }));
    let profile = Move { target_m: 1.0, speed_m_s: 0.3, acceleration_m_s2: 0.8, jerk_m_s3: 0.0, is_shaped: false };
    assert_eq!(rig.step(Some(Request::Move { axis: 0, profile })).status.refusal, Some(Refusal::NotHomed));
}

/// At 0.01 m/s one count a tick comes and none is no evidence; the loop then pushes above breakaway.
#[test]
fn an_encoder_that_stands_still_when_slow_is_found_by_torque_or_by_following_error() {
    let mut rig = homed_at(0.02);
    let profile = Move { target_m: 1.0, speed_m_s: 0.01, acceleration_m_s2: 0.8, jerk_m_s3: 0.0, is_shaped: false };
    rig.step(Some(Request::Move { axis: 0, profile }));
    for _ in 0..2000 {
        rig.step(None);
    }
    rig.plants[0].frozen_count = Some(rig.plants[0].input().encoder_count);
    let (mut ticks, from_m) = (0, rig.plants[0].position_m);
    while rig.step(None).status.fault.is_none() {
        ticks += 1;
        assert!(ticks < 4000);
    }
    assert!(
        matches!(rig.output.status.fault, Some((Fault::EncoderStuck | Fault::FollowingError, 0))),
        "{:?}",
        rig.output.status.fault
    );
    assert!(rig.plants[0].position_m - from_m < 0.05, "{}", rig.plants[0].position_m - from_m);
}

#[test]
fn a_count_that_jumps_and_transitions_that_are_illegal_cut_the_torque() {
    for jump in [20_u32, 4000, 1 << 31, u32::MAX - 100] {
        let count = cruising().tick.axes[0].encoder_count;
        let mut rig = expect(cruising(), Fault::EncoderJump, 1, |t| t.axes[0].encoder_count = count.wrapping_add(jump));
        assert!(!rig.step(None).status.axes[0].is_homed);
    }
    // Eleven where ten are allowed in a second.
    expect(cruising(), Fault::EncoderIllegal, 1, |t| t.axes[0].encoder_errors = 11);
    let mut rig = cruising();
    for _ in 0..4000 {
        assert_eq!(rig.step_with(None, |t| t.axes[0].encoder_errors = 10).status.fault, None);
    }
}

#[test]
fn reversed_polarity_is_caught_within_five_millimetres() {
    let holding = |rig: &mut Rig| {
        rig.step(Some(Request::Enable { axis: 0 }));
        // A push of half a millimetre: the loop runs away from it.
        rig.plants[0].load_n = 5.0;
    };
    let jogging = |rig: &mut Rig| {
        rig.step(Some(Request::Enable { axis: 0 }));
        let excitation = Excitation::Jog { volts: 1.0, distance_m: 0.05, duration_s: 2.0 };
        assert_eq!(rig.step(Some(Request::Excite { axis: 0, excitation })).status.refusal, None);
    };
    let homing = |rig: &mut Rig| {
        rig.step(Some(Request::Enable { axis: 0 }));
        rig.step(Some(Request::Home { axis: 0 }));
    };
    let short_jog = |rig: &mut Rig| {
        rig.step(Some(Request::Enable { axis: 0 }));
        let excitation = Excitation::Jog { volts: 1.0, distance_m: 0.002, duration_s: 2.0 };
        assert_eq!(rig.step(Some(Request::Excite { axis: 0, excitation })).status.refusal, None);
    };
    let starts: [fn(&mut Rig); 4] = [holding, jogging, homing, short_jog];
    for (number, start) in starts.iter().enumerate() {
        let mut rig = Rig::new(&Config::PUBLISHED, 0.5);
        rig.plants[0].encoder_polarity = -1.0;
        start(&mut rig);
        let mut ticks = 0;
        while rig.step(None).status.fault.is_none() {
            if (rig.plants[0].position_m - 0.5).abs() > 0.5e-3 {
                rig.plants[0].load_n = 0.0;
            }
            ticks += 1;
            assert!(ticks < 20_000, "start {number}: never found");
        }
        // The runaway may pass the speed cap first; the polarity then cuts the stop short.
        let fault = rig.output.status.fault;
        assert!(matches!(fault, Some((Fault::Polarity | Fault::OverSpeed, 0))), "start {number}: {fault:?}");
        while rig.output.command.axes[0].is_enabled {
            rig.step(None);
        }
        let way_m = (rig.plants[0].position_m - 0.5).abs();
        assert!(way_m < 0.005, "start {number}: {way_m}");
    }
}

/// The weight of a calibration pulls harder than friction holds: the motor takes work in, and that is no reversed polarity.
#[test]
fn lowering_a_weight_is_no_polarity_fault() {
    let mut rig = homed_at(0.02);
    let go = |rig: &mut Rig, target_m: f64| {
        let profile = Move { target_m, speed_m_s: 0.2, acceleration_m_s2: 0.5, jerk_m_s3: 0.0, is_shaped: false };
        rig.until(Some(Request::Move { axis: 0, profile }), 20.0, |o| o.status.axes[0].phase == Phase::Holding);
        for _ in 0..2000 {
            rig.step(None);
        }
        assert_eq!(rig.output.status.fault, None);
    };
    go(&mut rig, 1.0);
    for load_n in [-10.0, 10.0] {
        rig.plants[0].load_n = load_n;
        go(&mut rig, 0.5);
        go(&mut rig, 1.0);
    }
}

#[test]
fn late_and_stale_ticks_and_a_silent_host_stop_the_carriage() {
    // The published configuration allows 1 ms.
    let mut rig = cruising();
    for _ in 0..4 {
        let command = rig.output.command.axes[0];
        rig.plants[0].step(command, 250e-6);
        rig.tick.latched_us = rig.tick.latched_us.wrapping_add(250);
    }
    expect(rig, Fault::TickLate, 1, |_| {});
    let last = cruising().tick.latched_us;
    expect(cruising(), Fault::TickLate, 5, |t| t.latched_us = last.wrapping_sub(250));
    expect(cruising(), Fault::HostSilent, 801, |t| t.is_host_heard = false);
    let mut rig = cruising();
    for _ in 0..799 {
        assert_eq!(rig.step_with(None, |t| t.is_host_heard = false).status.fault, None);
    }
}

#[test]
fn a_recorder_that_failed_stops_the_carriage() {
    let mut rig = cruising();
    assert_eq!(rig.step(Some(Request::RecorderFailed)).status.fault, Some((Fault::RecorderFailed, 2)));
    assert_eq!(rig.output.status.axes[0].phase, Phase::Stopping);
}

/// The load takes more than the range can give: the axis falls behind but still goes on.
#[test]
fn an_axis_that_cannot_follow_is_stopped() {
    let mut config = Config::PUBLISHED;
    (config.axes[0].limits.command_v, config.axes[0].limits.saturation_s) = (1.5, 60.0);
    let mut rig = cruising_with(&config);
    rig.plants[0].load_n = -12.0;
    while rig.step(None).status.fault.is_none() {}
    assert_eq!(rig.output.status.fault, Some((Fault::FollowingError, 0)));
    assert_eq!(rig.output.status.axes[0].phase, Phase::Stopping);
    assert!(rig.plants[0].speed_m_s > 0.0);
}

/// An encoder that turns round under way, or a load that drives the axis against full torque: no closed loop can brake that.
#[test]
fn an_axis_that_runs_from_its_reference_against_the_torque_loses_it() {
    let mut config = Config::PUBLISHED;
    config.axes[0].limits.command_v = 1.5;
    let mut rig = cruising_with(&config);
    rig.plants[0].load_n = -70.0;
    while rig.step(None).status.fault.is_none() {}
    assert!(
        matches!(rig.output.status.fault, Some((Fault::Polarity | Fault::FollowingError, 0))),
        "{:?}",
        rig.output.status
    );
}

/// From 0.005 m/s upwards: found before the loop has run away by more than a centimetre.
#[test]
fn an_encoder_that_dies_under_way_is_found_before_the_loop_runs_away() {
    for speed_m_s in [0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.08] {
        let mut rig = homed_at(0.02);
        let profile = Move { target_m: 1.0, speed_m_s, acceleration_m_s2: 0.8, jerk_m_s3: 0.0, is_shaped: false };
        rig.step(Some(Request::Move { axis: 0, profile }));
        for _ in 0..4000 {
            rig.step(None);
        }
        rig.plants[0].frozen_count = Some(rig.plants[0].input().encoder_count);
        let from_m = rig.plants[0].position_m;
        while rig.step(None).status.fault.is_none() {}
        assert_eq!(rig.output.status.fault, Some((Fault::EncoderStuck, 0)));
        while rig.plants[0].speed_m_s > 0.0 {
            rig.step(None);
        }
        let way_m = rig.plants[0].position_m - from_m;
        assert!(way_m < 0.015, "{speed_m_s} m/s: {way_m}");
    }
}

#[test]
fn saturation_beyond_its_time_stops() {
    let mut config = Config::PUBLISHED;
    // Enough for the ramps; the load then takes a little more than is left, and the error grows slowly.
    config.axes[0].limits.command_v = 1.5;
    config.axes[0].limits.following_error_m = 0.04;
    config.axes[0].limits.saturation_s = 0.05;
    let mut rig = cruising_with(&config);
    rig.plants[0].load_n = -8.0;
    let mut ticks = 0;
    while rig.step(None).status.fault.is_none() {
        ticks += 1;
        assert!(ticks < 8000);
    }
    assert_eq!(rig.output.status.fault, Some((Fault::Saturated, 0)));
}

#[test]
fn too_fast_is_over_speed_and_the_cap_before_homing_is_lower() {
    let mut config = Config::PUBLISHED;
    config.axes[0].gains.proportional_v_rad = 0.0;
    config.axes[0].gains.derivative_v_s_rad = 0.0;
    config.axes[0].gains.integral_v_rad_s = 0.0;
    config.axes[0].limits.following_error_m = 0.02;
    let mut rig = Rig::new(&config, 0.5);
    rig.step(Some(Request::Enable { axis: 0 }));
    // Pushed by hand, no gains to resist: 0.05 m/s is the cap, 1.5 times that and 5 mm/s the fault.
    rig.plants[0].load_n = 10.0;
    while rig.step(None).status.fault.is_none() {}
    assert_eq!(rig.output.status.fault, Some((Fault::OverSpeed, 0)));
    assert!((rig.plants[0].speed_m_s - 0.08).abs() < 0.01, "{}", rig.plants[0].speed_m_s);
}

/// A load pulls the held axis towards the end, and its loop is too soft to resist or to notice.
#[test]
fn where_it_could_no_longer_be_stopped_is_the_soft_limit() {
    let mut config = Config::PUBLISHED;
    let limits = &mut config.axes[0].limits;
    limits.following_error_m = 0.2;
    (limits.hard_low_m, limits.high_switch_m) = (-0.3, 4.6);
    let gains = &mut config.axes[0].gains;
    (gains.proportional_v_rad, gains.derivative_v_s_rad, gains.integral_v_rad_s) = (0.002, 0.0002, 0.0);
    let mut rig = homed(&config, 0.02);
    rig.plants[0].load_n = -15.0;
    while rig.step(None).status.fault.is_none() {}
    assert_eq!(rig.output.status.fault, Some((Fault::SoftLimit, 0)));
    // There it could still have coasted to rest with a quarter of the allowed following error to spare.
    let drive = config.axes[0].drive;
    let way_m = froude_control::coast::Coast::of(&drive).distance_m(rig.plants[0].speed_m_s);
    assert!(rig.plants[0].position_m - way_m > -0.3 + 0.04, "{} {way_m}", rig.plants[0].position_m);
}

#[test]
fn homing_without_a_switch_fails() {
    let mut config = Config::PUBLISHED;
    config.axes[0].limits.hard_high_m = 0.25;
    config.axes[0].limits.high_switch_m = 0.2;
    let mut rig = Rig::new(&config, 0.1);
    let unplug = |t: &mut Tick| (t.axes[0].is_low_end, t.axes[0].is_high_end) = (false, false);
    rig.step(Some(Request::Enable { axis: 0 }));
    rig.step_with(Some(Request::Home { axis: 0 }), unplug);
    // The whole travel and 20 mm at 0.05 m/s.
    for _ in 0..30_000 {
        rig.step_with(None, unplug);
    }
    assert_eq!(rig.output.status.fault, Some((Fault::HomingFailed, 0)));
    // A broken wire: the switch never closes.
    let mut rig = Rig::new(&config, 0.1);
    let cut = |t: &mut Tick| t.axes[0].is_low_end = true;
    rig.step_with(Some(Request::Enable { axis: 0 }), cut);
    rig.step_with(Some(Request::Home { axis: 0 }), cut);
    for _ in 0..10_000 {
        rig.step_with(None, cut);
    }
    assert_eq!(rig.output.status.fault, Some((Fault::HomingFailed, 0)));
}

#[test]
fn power_up_is_disabled_and_without_torque_until_asked() {
    let mut rig = Rig::new(&Config::PUBLISHED, 0.5);
    for _ in 0..1000 {
        let output = rig.step(None);
        assert_eq!(output.status.axes[0].phase, Phase::Disabled);
        assert_eq!(output.command, froude_control::tick::Command::default());
    }
}
