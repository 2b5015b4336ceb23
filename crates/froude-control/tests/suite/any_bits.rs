//! Ticks of any bits: nothing panics, the command stays within the range, and a replay is the same run.

use froude_control::Controller;
use froude_control::config::Config;
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::Phase;
use froude_control::tick::{AXES, AxisInput, Tick};
use proptest::prelude::*;

use crate::rig::Rig;

/// Any 64 bits, and often a plausible number.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        -10.0..10.0,
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(0.0),
        Just(5e-324)
    ]
}

fn any_fault() -> impl Strategy<Value = Fault> {
    prop::sample::select(vec![
        Fault::EmergencyStop,
        Fault::EndSwitch,
        Fault::AmplifierNotReady,
        Fault::EncoderStuck,
        Fault::EncoderJump,
        Fault::EncoderIllegal,
        Fault::Polarity,
        Fault::TickLate,
        Fault::OverCurrent,
        Fault::Overload,
        Fault::Saturated,
        Fault::FollowingError,
        Fault::SoftLimit,
        Fault::OverSpeed,
        Fault::HostSilent,
        Fault::RecorderFailed,
        Fault::NotFinite,
        Fault::HomingFailed,
    ])
}

fn any_excitation() -> impl Strategy<Value = Excitation> {
    let n = any_number;
    prop_oneof![
        (n(), n(), n(), n()).prop_map(|(volts, period_s, duty, duration_s)| Excitation::Pulses {
            volts,
            period_s,
            duty,
            duration_s
        }),
        (n(), n(), n()).prop_map(|(volts, hysteresis_m, duration_s)| Excitation::Relay {
            volts,
            hysteresis_m,
            duration_s
        }),
        (n(), n(), n(), n(), n()).prop_map(|(volts, from_hz, to_hz, duration_s, speed_m_s)| Excitation::Sweep {
            volts,
            from_hz,
            to_hz,
            duration_s,
            speed_m_s
        }),
        (n(), n(), n()).prop_map(|(volts, distance_m, duration_s)| Excitation::Jog { volts, distance_m, duration_s }),
    ]
}

fn any_request() -> impl Strategy<Value = Request> {
    let axis = prop_oneof![Just(0_usize), Just(1), any::<usize>()].boxed();
    let n = any_number;
    let profile = (n(), n(), n(), n(), any::<bool>()).prop_map(
        |(target_m, speed_m_s, acceleration_m_s2, jerk_m_s3, is_shaped)| Move {
            target_m,
            speed_m_s,
            acceleration_m_s2,
            jerk_m_s3,
            is_shaped,
        },
    );
    prop_oneof![
        axis.clone().prop_map(|axis| Request::Enable { axis }),
        axis.clone().prop_map(|axis| Request::Disable { axis }),
        axis.clone().prop_map(|axis| Request::Home { axis }),
        (axis.clone(), profile).prop_map(|(axis, profile)| Request::Move { axis, profile }),
        (axis, any_excitation()).prop_map(|(axis, excitation)| Request::Excite { axis, excitation }),
        prop::sample::select(vec![StopCategory::Zero, StopCategory::One, StopCategory::Two]).prop_map(Request::Stop),
        Just(Request::RecorderFailed),
        any_fault().prop_map(Request::Clear),
    ]
}

fn any_input() -> impl Strategy<Value = AxisInput> {
    (any::<u32>(), any::<u32>(), any_number(), any::<[bool; 3]>()).prop_map(
        |(encoder_count, encoder_errors, current_a, [low, high, ready])| AxisInput {
            encoder_count,
            encoder_errors,
            current_a,
            is_low_end: low,
            is_high_end: high,
            is_amplifier_ready: ready,
        },
    )
}

fn any_tick() -> impl Strategy<Value = Tick> {
    (any::<u32>(), any_input(), any_input(), any::<[bool; 2]>(), prop::option::of(any_request())).prop_map(
        |(latched_us, y, x, [is_estop_open, is_host_heard], request)| Tick {
            latched_us,
            axes: [y, x],
            is_estop_open,
            is_host_heard,
            request,
        },
    )
}

/// Steps two controllers and checks the promises of `step`.
fn step_both(pair: &mut [Controller; 2], tick: &Tick) -> Result<(), TestCaseError> {
    let [a, b] = pair;
    let (output, replay) = (a.step(tick), b.step(tick));
    for (axis, status) in output.command.axes.iter().zip(&output.status.axes) {
        prop_assert!(axis.volts.is_finite() && axis.volts.abs() <= 10.0, "{axis:?}");
        prop_assert!(axis.is_enabled || axis.volts == 0.0);
        prop_assert_eq!(axis.is_enabled, !matches!(status.phase, Phase::Disabled | Phase::Coasting));
        for number in [status.position_m, status.reference_m, status.reference_m_s, status.reference_m_s2] {
            prop_assert!(number.is_finite() && !number.is_subnormal(), "{status:?}");
        }
    }
    for i in 0..AXES {
        prop_assert_eq!(output.command.axes[i].volts.to_bits(), replay.command.axes[i].volts.to_bits());
    }
    prop_assert_eq!(output, replay);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn random_ticks_never_give_a_command_out_of_range(ticks in prop::collection::vec(any_tick(), 1..100)) {
        let mut pair = [Controller::new(Config::PUBLISHED).unwrap(); 2];
        for tick in &ticks {
            step_both(&mut pair, tick)?;
        }
    }

    /// A sane rig that is enabled and homed, asked for anything at any time, with one spoiled tick now and then.
    #[test]
    fn random_requests_on_a_sane_rig_keep_the_promises(
        requests in prop::collection::vec((any_request(), 1_u32..3000, prop::option::weighted(0.1, any_tick())), 1..12),
    ) {
        let mut rig = crate::rig::homed_at(0.02);
        let mut replay = rig.controller;
        for (request, ticks, spoiled) in requests {
            for i in 0..ticks {
                let mut seen = None;
                let output = rig.step_with((i == 0).then_some(request), |t| {
                    if let (Some(spoiled), 1) = (spoiled, i) {
                        *t = spoiled;
                    }
                    seen = Some(*t);
                });
                prop_assert_eq!(replay.step(&seen.unwrap()), output);
                for (axis, plant) in output.command.axes.iter().zip(&rig.plants) {
                    prop_assert!(axis.volts.is_finite() && axis.volts.abs() <= 10.0);
                    prop_assert!(axis.is_enabled || axis.volts == 0.0);
                    prop_assert!(plant.position_m > -0.05 && plant.position_m < 4.95);
                }
            }
        }
    }
}

#[test]
fn a_first_tick_of_any_kind_is_taken() {
    let mut rig = Rig::new(&Config::PUBLISHED, 0.3);
    let output = rig.step_with(Some(Request::Clear(Fault::TickLate)), |t| {
        t.latched_us = u32::MAX;
        t.axes[0].encoder_count = u32::MAX;
        t.axes[0].encoder_errors = u32::MAX;
    });
    assert_eq!(output.status.fault, None);
}
