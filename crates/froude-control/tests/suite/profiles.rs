//! Profiles: bounds kept, no jumps, exact ends.

use froude_control::profile::{Bounds, Profile, State};
use froude_control::ramp::SpeedRamp;
use froude_control::shaper::{ShapedProfile, Shaper};
use proptest::prelude::*;

/// Rounding of a position: a few ulp of the numbers that it is the sum of.
fn rounding(scale: f64) -> f64 {
    16.0 * f64::EPSILON * scale
}

/// From a trapezoid to a jerk that is never reached.
fn any_bounds() -> impl Strategy<Value = Bounds> {
    (0.001..2.0, 0.01..5.0, prop_oneof![Just(0.0), 0.01..1000.0])
        .prop_map(|(speed_m_s, acceleration_m_s2, jerk_m_s3)| Bounds { speed_m_s, acceleration_m_s2, jerk_m_s3 })
}

/// Ways from a tenth of a count to a tank.
fn any_way() -> impl Strategy<Value = (f64, f64)> {
    (-5.0..5.0, -7.0..1.0, any::<bool>()).prop_map(|(start_m, exponent, is_up)| {
        let way_m = 10_f64.powf(exponent);
        (start_m, start_m + if is_up { way_m } else { -way_m })
    })
}

/// No step between samples `dt` apart is larger than the bounds allow.
fn is_continuous(states: &[State], dt: f64, bounds: Bounds, scale: f64) -> Result<(), TestCaseError> {
    for pair in states.windows(2) {
        let [from, to] = pair else { unreachable!() };
        let slack = 1.0 + 1e-9;
        let step_m = (to.position_m - from.position_m).abs();
        prop_assert!(step_m <= bounds.speed_m_s * dt * slack + rounding(scale), "position {from:?} {to:?}");
        let step_m_s = (to.speed_m_s - from.speed_m_s).abs();
        prop_assert!(
            step_m_s <= bounds.acceleration_m_s2 * dt * slack + rounding(bounds.speed_m_s),
            "speed {from:?} {to:?}"
        );
        // The way is the integral of the speed: the trapezoid rule errs by max|a| change · dt² / 8 within a kinked segment.
        let mean_m = 0.5 * (to.speed_m_s + from.speed_m_s) * dt;
        let error_m = (to.position_m - from.position_m - mean_m).abs();
        prop_assert!(
            error_m <= bounds.acceleration_m_s2 * dt * dt / 4.0 * slack + rounding(scale),
            "integral {from:?} {to:?}"
        );
        if bounds.jerk_m_s3 > 0.0 {
            let step = (to.acceleration_m_s2 - from.acceleration_m_s2).abs();
            let limit = bounds.jerk_m_s3 * dt * slack + rounding(bounds.acceleration_m_s2 + bounds.jerk_m_s3);
            prop_assert!(step <= limit, "acceleration {from:?} {to:?}");
        }
    }
    Ok(())
}

fn is_bounded(states: &[State], bounds: Bounds) -> Result<(), TestCaseError> {
    for state in states {
        prop_assert!(state.speed_m_s.abs() <= bounds.speed_m_s * (1.0 + 1e-12), "{state:?}");
        prop_assert!(state.acceleration_m_s2.abs() <= bounds.acceleration_m_s2 * (1.0 + 1e-12), "{state:?}");
    }
    Ok(())
}

const SAMPLES: u32 = 1999;

proptest! {
    #[test]
    fn a_profile_keeps_its_bounds_without_jumps_and_ends_exactly((start_m, target_m) in any_way(), bounds in any_bounds()) {
        let profile = Profile::plan(start_m, target_m, bounds);
        let duration_s = profile.duration_s();
        prop_assert_eq!(profile.sample(0.0).position_m, start_m);
        prop_assert_eq!(profile.sample(0.0).speed_m_s, 0.0);
        prop_assert_eq!(profile.sample(duration_s), State::at_rest(target_m));
        prop_assert_eq!(profile.sample(duration_s * 2.0), State::at_rest(target_m));
        let dt = duration_s / f64::from(SAMPLES);
        let states: Vec<_> = (0..SAMPLES).map(|i| profile.sample(f64::from(i) * dt)).collect();
        is_bounded(&states, bounds)?;
        is_continuous(&states, dt, bounds, start_m.abs() + target_m.abs())?;
    }

    #[test]
    fn a_shaped_profile_keeps_them_too(
        (start_m, target_m) in any_way(), bounds in any_bounds(), mode_hz in 0.5..50.0, damping in 0.0..0.5, is_robust: bool,
    ) {
        let shaper = if is_robust { Shaper::zvd(mode_hz, damping) } else { Shaper::zv(mode_hz, damping) };
        let shaped = ShapedProfile::new(Profile::plan(start_m, target_m, bounds), shaper);
        prop_assert_eq!(shaped.sample(shaped.duration_s()), State::at_rest(target_m));
        let dt = shaped.duration_s() / f64::from(SAMPLES);
        let states: Vec<_> = (0..SAMPLES).map(|i| shaped.sample(f64::from(i) * dt)).collect();
        is_bounded(&states, bounds)?;
        // A copy of a trapezoid may start within a step, which moves the trapezoid rule as much as its own kinks.
        is_continuous(&states, dt, bounds, start_m.abs() + target_m.abs())?;
    }

    #[test]
    fn a_profile_runs_the_same_backwards((start_m, target_m) in any_way(), bounds in any_bounds(), part in 0.0..1.0) {
        let there = Profile::plan(start_m, target_m, bounds);
        let back = Profile::plan(target_m, start_m, bounds);
        let t = part * there.duration_s();
        let (a, b) = (there.sample(t), back.sample(back.duration_s() - t));
        let scale = start_m.abs() + target_m.abs();
        prop_assert!((a.position_m - b.position_m).abs() <= rounding(scale + bounds.speed_m_s * there.duration_s()));
        prop_assert!((a.speed_m_s + b.speed_m_s).abs() <= rounding(bounds.speed_m_s + bounds.acceleration_m_s2 * there.duration_s()));
    }

    /// From any state within the bounds, in any direction; without a jerk bound the first acceleration is free to jump.
    #[test]
    fn a_change_of_speed_keeps_its_bounds_and_meets_the_speed(
        position_m in -5.0..5.0, v0 in -2.0..2.0, v1 in prop_oneof![Just(0.0), -2.0..2.0], bounds in any_bounds(), part in -1.0..1.0,
    ) {
        let a0 = if bounds.jerk_m_s3 > 0.0 { part * bounds.acceleration_m_s2 } else { 0.0 };
        let start = State { position_m, speed_m_s: v0, acceleration_m_s2: a0 };
        let ramp = SpeedRamp::plan(start, v1, bounds.acceleration_m_s2, bounds.jerk_m_s3);
        let duration_s = ramp.duration_s();
        let end = ramp.sample(duration_s);
        prop_assert_eq!(end.speed_m_s, v1);
        prop_assert_eq!(end.acceleration_m_s2, 0.0);
        prop_assert_eq!(end.position_m, ramp.end_m());
        // While an acceleration is taken away the speed may pass its end by a²/2J.
        let over_m_s = if bounds.jerk_m_s3 > 0.0 { a0 * a0 / (2.0 * bounds.jerk_m_s3) } else { 0.0 };
        let top = Bounds { speed_m_s: v0.abs().max(v1.abs()) + over_m_s, ..bounds };
        let dt = duration_s / f64::from(SAMPLES);
        let states: Vec<_> = (0..=SAMPLES).map(|i| ramp.sample(f64::from(i) * dt)).collect();
        is_bounded(&states, Bounds { speed_m_s: top.speed_m_s * (1.0 + 1e-9), ..top })?;
        // Longer ways than the start: the stop from 2 m/s at 0.01 m/s² takes 200 m.
        let scale = position_m.abs() + top.speed_m_s * duration_s;
        is_continuous(&states, dt, Bounds { speed_m_s: top.speed_m_s + 1e-9, ..top }, scale)?;
    }
}

#[test]
fn durations_are_those_of_the_closed_forms() {
    let bounds = Bounds { speed_m_s: 0.5, acceleration_m_s2: 1.0, jerk_m_s3: 0.0 };
    // Trapezoid D/V + V/A; triangle 2 √(D/A).
    assert!((Profile::plan(0.0, 2.0, bounds).duration_s() - 4.5).abs() < 1e-14);
    assert!((Profile::plan(0.0, 0.16, bounds).duration_s() - 0.8).abs() < 1e-15);
    // Seven segments D/V + V/A + A/J; without cruise, without constant acceleration 4 ∛(D/2J).
    let smooth = Bounds { jerk_m_s3: 4.0, ..bounds };
    assert!((Profile::plan(0.0, 2.0, smooth).duration_s() - 4.75).abs() < 1e-14);
    let tiny = Profile::plan(0.0, 0.001, smooth);
    assert!((tiny.duration_s() - 4.0 * (0.001_f64 / 8.0).cbrt()).abs() < 1e-15);
    assert!((tiny.peak_speed_m_s() - 4.0 * (0.001_f64 / 8.0).cbrt().powi(2)).abs() < 1e-15);
}

#[test]
fn cruise_is_at_the_speed_asked_for_to_the_last_bit() {
    for i in 1..=11_u32 {
        let speed_m_s = 0.05 * f64::from(i);
        for jerk_m_s3 in [0.0, 3.0] {
            let bounds = Bounds { speed_m_s, acceleration_m_s2: 0.7, jerk_m_s3 };
            let profile = Profile::plan(0.3, 2.5, bounds);
            let middle = profile.sample(0.5 * profile.duration_s());
            assert!((middle.speed_m_s / speed_m_s - 1.0).abs() <= f64::EPSILON, "{speed_m_s} {middle:?}");
            assert_eq!(middle.acceleration_m_s2, 0.0);
        }
    }
}

#[test]
fn no_way_takes_no_time() {
    let bounds = Bounds { speed_m_s: 0.5, acceleration_m_s2: 1.0, jerk_m_s3: 4.0 };
    let profile = Profile::plan(1.25, 1.25, bounds);
    assert_eq!(profile.duration_s(), 0.0);
    assert_eq!(profile.sample(0.0), State::at_rest(1.25));
}
