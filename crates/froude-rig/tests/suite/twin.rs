//! The twin as the controller meets it.

use froude_control::tick::{AxisCommand, Command, Tick};
use froude_rig::load::{BodyState, Load};
use froude_rig::twin::{TICK_S, Twin, TwinConfig};
use froude_rig::{Injection, Scheduled};

fn volts(y: f64, x: f64) -> Command {
    Command { axes: [y, x].map(|volts| AxisCommand { volts, is_enabled: true }) }
}

/// To and fro in open loop, pushed back where the axis has gone too far.
fn wander(twin: &Twin, amplitude_v: f64) -> Command {
    let drive = |axis: usize, mid_m: f64, period_s: f64| {
        let t = twin.truth(axis);
        let push = if ((twin.time_s() / period_s) as u64).is_multiple_of(2) { amplitude_v } else { -amplitude_v };
        if (t.load_position_m - mid_m).abs() > 0.25 { amplitude_v.copysign(mid_m - t.load_position_m) } else { push }
    };
    volts(drive(0, 2.3, 1.7), drive(1, 0.6, 1.1))
}

#[test]
fn a_replay_is_equal_bit_for_bit_and_another_seed_is_not() {
    let config = TwinConfig::loaded(Load::mounted(BodyState::Wet));
    let run = |seed| {
        let mut twin = Twin::new(&config, seed);
        let ticks: Vec<Tick> = (0..40_000).map(|_| twin.tick(wander(&twin, 1.2))).collect();
        (ticks, twin.force_n().to_bits())
    };
    let (a, b, c) = (run(7), run(7), run(8));
    assert!(a == b);
    assert_ne!(a.1, c.1);
}

#[test]
fn over_a_long_drive_the_unwrapped_counter_equals_the_truth_within_one_count() {
    let mut twin = Twin::new(&TwinConfig::default(), 1);
    let metres_per_count = TwinConfig::default().axes[0].parameters.metres_per_count();
    let mut last = twin.tick(volts(0.0, 0.0));
    let mut counts = [twin.truth(0).count, twin.truth(1).count];
    let mut wraps = 0;
    for _ in 0..1_200_000 {
        let tick = twin.tick(wander(&twin, 1.5));
        for i in 0..2 {
            let (new, old) = (tick.axes[i].encoder_count, last.axes[i].encoder_count);
            counts[i] += i64::from(new.wrapping_sub(old).cast_signed());
            wraps += u32::from(new.abs_diff(old) > u32::MAX / 2);
            let exact = twin.truth(i).motor_position_m / metres_per_count;
            assert!((counts[i] as f64 - exact).abs() <= 1.0, "{} {exact}", counts[i]);
        }
        last = tick;
    }
    // Both counters start just before their wrap.
    assert!(wraps >= 2);
}

#[test]
fn the_board_clock_wraps_after_its_first_second() {
    let mut twin = Twin::new(&TwinConfig::default(), 1);
    let mut last = twin.tick(Command::default());
    let mut has_wrapped = false;
    for _ in 0..8_000 {
        let tick = twin.tick(Command::default());
        assert_eq!(tick.latched_us.wrapping_sub(last.latched_us), 250);
        has_wrapped |= tick.latched_us < last.latched_us;
        last = tick;
    }
    assert!(has_wrapped);
}

#[test]
fn a_twin_without_commands_does_not_move() {
    let mut twin = Twin::new(&TwinConfig::loaded(Load::mounted(BodyState::Wet)), 3);
    let before = [0, 1].map(|i| twin.truth(i).load_position_m.to_bits());
    for _ in 0..200_000 {
        twin.tick(Command::default());
    }
    assert_eq!([0, 1].map(|i| twin.truth(i).load_position_m.to_bits()), before);
}

#[test]
fn the_force_sensor_feels_drag_at_constant_speed() {
    let mut twin = Twin::new(&TwinConfig::loaded(Load::mounted(BodyState::Wet)), 5);
    // Open loop at 2 V: about 9.6 N at the chain, 0.4 m/s after a second or two.
    let (mut sensed_n, mut true_n, mut n) = (0.0, 0.0, 0.0);
    while twin.truth(0).load_position_m < 3.5 {
        twin.tick(volts(2.0, 0.0));
        if twin.time_s() > 4.0 {
            sensed_n += twin.force_n();
            true_n += twin.truth(0).drag_n;
            n += 1.0;
        }
    }
    let (sensed_n, true_n) = (sensed_n / n, true_n / n);
    assert!(true_n > 2.0, "{true_n}");
    // White noise averages to 0.05/√n; what is left of the acceleration is 14 kg × Δv/t over the window, bounded by 0.05 N here.
    assert!((sensed_n - twin.force_drift_n() - true_n).abs() < 0.05, "{sensed_n} {true_n}");
}

#[test]
fn an_open_end_switch_stops_current_into_that_end_only() {
    let mut twin = Twin::new(&TwinConfig::default(), 1);
    twin.inject(Scheduled { tick: 0, axis: 0, injection: Injection::LowEndSwitch });
    for _ in 0..100 {
        assert!(twin.tick(volts(-3.0, 0.0)).axes[0].is_low_end);
    }
    assert_eq!(twin.truth(0).current_a, 0.0);
    for _ in 0..100 {
        twin.tick(volts(3.0, 0.0));
    }
    assert!(twin.truth(0).current_a > 1.0);
}

#[test]
fn a_late_tick_brings_its_lateness_in_the_clock_and_in_the_plant() {
    let mut twin = Twin::new(&TwinConfig::default(), 1);
    let mut punctual = twin.clone();
    twin.inject(Scheduled { tick: 100, axis: 0, injection: Injection::TickLate(1_000) });
    let mut gaps = Vec::new();
    let mut last = twin.tick(volts(2.0, 0.0)).latched_us;
    for _ in 1..200 {
        let now = twin.tick(volts(2.0, 0.0)).latched_us;
        gaps.push(now.wrapping_sub(last));
        last = now;
    }
    for _ in 0..204 {
        punctual.tick(volts(2.0, 0.0));
    }
    assert_eq!(gaps.iter().max(), Some(&1_250));
    assert_eq!(gaps.iter().filter(|&&g| g != 250).count(), 1);
    // Only the noise differs: friction wanders by 0.05 N of some 8 N.
    let (a, b) = (twin.truth(0).motor_position_m, punctual.truth(0).motor_position_m);
    assert!((a - b).abs() < 1e-3 && a > 0.5, "{a} {b}");
    assert!((twin.time_s() - 200.0 * TICK_S).abs() < 1e-12);
}

#[test]
fn run_factors_scatter_as_declared() {
    let config = TwinConfig::default();
    let factors: Vec<(f64, f64)> = (0..4_000).map(|seed| Twin::new(&config, seed).run_factors(0)).collect();
    let std = |of: fn(&(f64, f64)) -> f64| {
        (factors.iter().map(|f| (of(f) - 1.0).powi(2)).sum::<f64>() / factors.len() as f64).sqrt()
    };
    // Relative standard error of a standard deviation from 4,000 draws: 1/√8000 = 1.1 %; four of them.
    assert!((std(|f| f.0) / 0.02 - 1.0).abs() < 0.045);
    assert!((std(|f| f.1) / 0.005 - 1.0).abs() < 0.045);
}

#[test]
fn a_new_run_keeps_the_place_and_draws_anew() {
    let mut twin = Twin::new(&TwinConfig::default(), 1);
    while twin.truth(0).motor_position_m < 1.0 {
        twin.tick(volts(2.0, 0.0));
    }
    while twin.truth(0).motor_speed_m_s != 0.0 {
        twin.tick(Command::default());
    }
    let (place_m, factors) = (twin.truth(0).motor_position_m, twin.run_factors(0));
    twin.begin_run([Load::mounted(BodyState::Wet); 2], 99);
    assert_eq!(twin.truth(0).motor_position_m.to_bits(), place_m.to_bits());
    assert_ne!(twin.run_factors(0), factors);
}

#[test]
fn a_record_does_not_hold_how_the_axis_came_to_its_start() {
    let currents = |ticks_before: usize, seed: u64| -> Vec<u64> {
        let mut twin = Twin::new(&TwinConfig::default(), 1);
        for _ in 0..ticks_before {
            twin.tick(Command::default());
        }
        twin.begin_recording(seed);
        (0..2_000).map(|_| twin.tick(volts(2.0, 0.0)).axes[0].current_a.to_bits()).collect()
    };
    assert_eq!(currents(10, 7), currents(5_000, 7));
    assert_ne!(currents(10, 7), currents(10, 8));
}
