//! The plant against what is known in closed form.

use froude_hydro::similarity::GRAVITY_M_S2;
use froude_rig::load::{BodyState, HungWeight, Load, TowedBody};
use froude_rig::parameters::AxisParameters;
use froude_rig::plant::{Disturbance, Plant};
use std::f64::consts::PI;

/// The twin's step, s.
const STEP_S: f64 = 50e-6;

fn bare(axis: &AxisParameters) -> Plant {
    Plant::new(axis, &Load::default(), STEP_S, 1.0, 1.0)
}

/// A perfect gear and one constant friction: what eq. 3 of the paper assumes.
fn eq3() -> AxisParameters {
    AxisParameters {
        efficiency_forward: 1.0,
        efficiency_backward: 1.0,
        stribeck_excess: 0.0,
        bump: 0.0,
        ..AxisParameters::long()
    }
}

/// Places and speeds, to the bit.
fn bits(plant: &Plant) -> [u64; 4] {
    [plant.motor_position_m(), plant.motor_speed_m_s(), plant.load_position_m(), plant.load_speed_m_s()]
        .map(f64::to_bits)
}

/// Runs under a constant force until `seconds` have passed.
fn run(plant: &mut Plant, motor_n: f64, seconds: f64) {
    for _ in 0..(seconds / STEP_S).round() as u64 {
        plant.step(motor_n);
    }
}

#[test]
fn without_losses_energy_stays_to_rounding() {
    for axis in [AxisParameters::long().lossless(), AxisParameters::short().lossless()] {
        let mut plant = bare(&AxisParameters { hard_high_m: 10.0, ..axis });
        plant.stretch(2e-3);
        plant.launch(0.05);
        let before_j = plant.energy_j();
        run(&mut plant, 0.0, 5.0);
        // A position near 1.25 m is rounded by ε·1.25 m, against an extension of 2 mm 1.4e-13, twice that in its square; at worst
        // all 1e5 steps to the same side.
        let drift = (plant.energy_j() / before_j - 1.0).abs();
        assert!(drift < 2.0 * 1.4e-13 * 1e5, "{drift:e}");
    }
}

#[test]
fn work_of_the_motor_is_found_again_as_energy_and_drag() {
    // Lossless but for drag: energy gained + ∫ D v³ dt = ∫ F v_q dt, to the second order of the step.
    let axis = AxisParameters::long().lossless();
    let wet = Load::mounted(BodyState::Wet);
    let defect_j = |step_s: f64| {
        let mut plant = Plant::new(&axis, &wet, step_s, 1.0, 1.0);
        plant.launch(0.1);
        let before_j = plant.energy_j();
        let (mut work_j, mut drag_j) = (0.0, 0.0);
        for i in 0..(2.0 / step_s).round() as u64 {
            // Held within a step as the amplifier's mean is; the work of a held force is exact from the motor's displacement.
            let motor_n = 8.0 + 3.0 * (2.0 * PI * 0.7 * (i as f64 + 0.5) * step_s).sin();
            let (q, v) = (plant.motor_position_m(), plant.load_speed_m_s());
            plant.step(motor_n);
            work_j += motor_n * (plant.motor_position_m() - q);
            let mid_m_s = 0.5 * (v + plant.load_speed_m_s());
            drag_j += wet.drag_n_s2_m2() * mid_m_s.powi(3) * step_s;
        }
        (plant.energy_j() - before_j + drag_j - work_j).abs() / work_j
    };
    let (coarse, fine) = (defect_j(4e-3), defect_j(1e-3));
    assert!(coarse / fine > 10.0, "{coarse:e} {fine:e}");
    assert!(defect_j(STEP_S) < 1e-7, "{:e}", defect_j(STEP_S));
}

#[test]
fn smooth_motion_converges_with_the_second_order() {
    // Everything that acts while sliding: drag, bump, Stribeck, gear loss, under a force that changes smoothly.
    let axis = AxisParameters::long();
    let wet = Load::mounted(BodyState::Wet);
    let end = |step_s: f64| {
        let mut plant = Plant::new(&axis, &wet, step_s, 0.5, 1.0);
        plant.launch(0.2);
        let mut t = 0.0;
        for _ in 0..(1.0 / step_s).round() as u64 {
            plant.step(9.0 + 4.0 * (PI * (t + 0.5 * step_s)).sin());
            t += step_s;
        }
        plant.load_position_m()
    };
    let ends: Vec<f64> = [8e-4, 4e-4, 2e-4, 1e-4].into_iter().map(end).collect();
    let changes: Vec<f64> = ends.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    for pair in changes.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.7..2.4).contains(&order), "order {order}, {changes:?}");
    }
}

/// Frequency of the free oscillation of the extension, from its zero crossings in time.
fn measured_mode_hz(mut plant: Plant, swings: usize, signal: impl Fn(&Plant) -> f64) -> f64 {
    let (mut crossings, mut last, mut t) = (Vec::new(), signal(&plant), 0.0);
    while crossings.len() <= swings {
        plant.step(0.0);
        let now = signal(&plant);
        if last < 0.0 && now >= 0.0 {
            crossings.push(t + STEP_S * last / (last - now));
        }
        last = now;
        t += STEP_S;
        assert!(t < 60.0, "no oscillation");
    }
    swings as f64 / (crossings[swings] - crossings[0])
}

#[test]
fn the_bare_carriage_swings_at_13_and_45_hertz() {
    for (axis, hz) in [(AxisParameters::long(), 13.0), (AxisParameters::short(), 45.0)] {
        let mut plant = bare(&axis.lossless());
        plant.stretch(1e-3);
        let measured = measured_mode_hz(plant, 20, Plant::spring_n);
        // Interpolating a sine linearly between samples displaces a crossing by less than (ωh)²/8 of a step.
        assert!((measured / hz - 1.0).abs() < 1e-6, "{measured}");
    }
}

#[test]
fn with_the_motor_held_a_wet_load_swings_slower_than_a_dry_one() {
    // The motor sticks: its own friction is made large, everything else is lossless.
    let axis = AxisParameters { motor_coulomb_n_m: 10.0, ..AxisParameters::long().lossless() };
    let measured = [BodyState::None, BodyState::Dry, BodyState::Wet].map(|mounting| {
        let body = TowedBody { drag_n_s2_m2: 0.0, ..TowedBody::CYLINDER };
        let load = Load { body, ..Load::mounted(mounting) };
        let mut plant = Plant::new(&axis, &load, STEP_S, 1.0, 1.0);
        plant.stretch(1e-3);
        let hz = measured_mode_hz(plant, 10, Plant::spring_n);
        assert!((hz / axis.load_mode_hz(load.mass_kg(&axis)) - 1.0).abs() < 1e-6, "{hz}");
        hz
    });
    assert!(measured[0] > measured[1] && measured[1] > measured[2], "{measured:?}");
}

#[test]
fn below_breakaway_nothing_moves_at_all() {
    let axis = AxisParameters::long();
    let mut plant = bare(&axis);
    plant.disturb(Disturbance { noise_n: 0.01, jam_n: 0.0 });
    let before = bits(&plant);
    let breakaway_n = axis.motor_coulomb_n_m / axis.chain_m_rad();
    for _ in 0..1_000_000 {
        plant.step(0.999 * breakaway_n);
    }
    assert_eq!(bits(&plant), before);
    plant.step(1.001 * breakaway_n);
    assert!(plant.motor_speed_m_s() > 0.0);
}

#[test]
fn a_motor_that_winds_the_chain_up_sticks_again_before_the_load_breaks_away() {
    let axis = AxisParameters::long();
    let mut plant = bare(&axis);
    // Above the motor's own friction, below that and the load's breakaway together.
    let motor_n =
        axis.motor_coulomb_n_m / axis.chain_m_rad() + 0.5 * axis.load_friction_n(axis.load_mass_kg * GRAVITY_M_S2);
    run(&mut plant, motor_n, 1.0);
    let wound = bits(&plant);
    assert!(plant.motor_position_m() > 1.0);
    assert_eq!(plant.load_position_m(), 1.0);
    for _ in 0..1_000_000 {
        plant.step(motor_n);
    }
    assert_eq!(bits(&plant), wound);
}

#[test]
fn it_coasts_as_far_as_the_closed_form_says() {
    // m v' = −F − b v from v₀: x = (m/b)(v₀ − (F/b) ln(1 + b v₀/F)). A stiff chain moves both masses as one.
    let axis = AxisParameters { stiffness_n_m: 4e6, chain_damping_n_s_m: 2_000.0, ..eq3() };
    let e = axis.effective();
    let r = axis.chain_m_rad();
    let (m, b, f) = (e.inertia_kg_m2 / (r * r), e.viscous_n_m_s_rad / (r * r), e.coulomb_n_m / r);
    for v in [0.1, 0.3, 0.55] {
        let mut plant = bare(&axis);
        plant.launch(v);
        while plant.load_speed_m_s() != 0.0 || plant.motor_speed_m_s() != 0.0 {
            plant.step(0.0);
        }
        let closed_m = m / b * (v - f / b * (b * v / f).ln_1p());
        let error_m = (plant.load_position_m() - 1.0 - closed_m).abs();
        // The chain carries the load's share of the braking: C − M a stretches it by under 1 N / K; it stops within a step.
        assert!(error_m < 1.0 / axis.stiffness_n_m + v * STEP_S * 1e-2, "{v}: {error_m:e}");
    }
}

#[test]
fn at_constant_speed_the_torque_balances_as_in_equation_7() {
    let axis = eq3();
    let wet = Load::mounted(BodyState::Wet);
    let e = axis.apparent(wet.mass_kg(&axis), wet.wheel_load_n(&axis));
    let r = axis.chain_m_rad();
    for motor_n in [5.0, 7.0, 9.0] {
        let endless = AxisParameters { hard_high_m: 1e3, ..axis };
        let mut plant = Plant::new(&endless, &wet, STEP_S, 1.0, 1.0);
        run(&mut plant, motor_n, 60.0);
        let v = plant.load_speed_m_s();
        let drag_n = wet.drag_n_s2_m2() * v * v;
        let torque = r * motor_n;
        let balance = e.viscous_n_m_s_rad * v / r + e.coulomb_n_m + r * drag_n;
        assert!((balance / torque - 1.0).abs() < 1e-6, "{v}: {balance} against {torque}");
    }
}

#[test]
fn the_gear_takes_its_part_when_driving_and_when_driven() {
    // A hung weight and no other friction. Driving up at constant speed the motor gives W/η, driven down it holds η_b W.
    let axis = AxisParameters {
        efficiency_forward: 0.8,
        efficiency_backward: 0.7,
        chain_damping_n_s_m: 40.0,
        ..AxisParameters::long().lossless()
    };
    let w = 10.0;
    let load = Load { hung: HungWeight { weight_n: w, ..HungWeight::default() }, ..Load::default() };
    let acceleration = |v: f64, motor_n: f64| {
        let mut plant = Plant::new(&axis, &load, STEP_S, 1.0, 1.0);
        plant.launch(v);
        plant.stretch(w / axis.stiffness_n_m);
        run(&mut plant, motor_n, 0.5);
        (plant.load_speed_m_s() - v) / 0.5
    };
    for (v, balanced_n) in [(0.3, w / 0.8), (-0.3, 0.7 * w)] {
        assert!(acceleration(v, balanced_n).abs() < 1e-9, "{v}: {}", acceleration(v, balanced_n));
        assert!(acceleration(v, balanced_n + 0.1) > 1e-3);
        assert!(acceleration(v, balanced_n - 0.1) < -1e-3);
    }
    // At rest anything between holds it: the gear locks.
    for motor_n in [0.71 * w, w, 1.24 * w] {
        let mut plant = Plant::new(&axis, &load, STEP_S, 1.0, 1.0);
        plant.stretch(w / axis.stiffness_n_m);
        let before = plant.motor_position_m();
        run(&mut plant, motor_n, 0.5);
        assert_eq!(plant.motor_position_m(), before, "{motor_n}");
    }
}

#[test]
fn friction_is_a_fifth_higher_at_mid_travel() {
    let axis = AxisParameters { stribeck_excess: 0.0, ..AxisParameters::long() };
    let friction_at = |m: f64| {
        let mut plant = Plant::new(&axis, &Load::default(), STEP_S, m, 1.0);
        plant.launch(0.1);
        plant.step(0.0);
        plant.friction_n()
    };
    let end_n = axis.load_friction_n(axis.load_mass_kg * GRAVITY_M_S2);
    let mid_m = 0.5 * (axis.hard_low_m + axis.hard_high_m);
    assert!((friction_at(mid_m) / end_n - 1.2).abs() < 1e-12);
    assert!((friction_at(axis.hard_low_m) / end_n - 1.0).abs() < 1e-12);
    assert!((friction_at(0.5 * (axis.hard_low_m + mid_m)) / end_n - 1.15).abs() < 1e-12);
}

#[test]
fn a_pulley_takes_from_the_weight_in_one_direction_and_adds_in_the_other() {
    let axis = AxisParameters { chain_damping_n_s_m: 40.0, ..AxisParameters::long().lossless() };
    let load =
        Load { hung: HungWeight { weight_n: 10.0, pulley_friction: 0.02, ..HungWeight::default() }, ..Load::default() };
    for (v, balanced_n) in [(0.3, 10.2), (-0.3, 9.8)] {
        let mut plant = Plant::new(&axis, &load, STEP_S, 1.0, 1.0);
        plant.launch(v);
        plant.stretch(balanced_n / axis.stiffness_n_m);
        run(&mut plant, balanced_n, 0.5);
        assert!((plant.load_speed_m_s() - v).abs() < 1e-9);
    }
}

/// The torque fails while 10 N are lifted: whatever rides on the carriage, it goes at least to the floor's coordinate and not further
/// beyond it than (W/F − 1) h, F what friction holds at least.
#[test]
fn a_weight_pulls_the_carriage_to_its_floor_and_friction_stops_it_from_there() {
    let axis = AxisParameters::long();
    let (top_m, floor_m, w) = (4.6, 4.05, 10.0);
    for mounting in [BodyState::None, BodyState::Dry] {
        let hung = HungWeight { weight_n: w, floor_m, ..HungWeight::default() };
        let load = Load { hung, ..Load::mounted(mounting) };
        let mut plant = Plant::new(&axis, &load, STEP_S, top_m, 1.0);
        plant.launch(0.1);
        let mut last_m = top_m;
        for _ in 0..600_000 {
            plant.step(0.0);
            last_m = plant.load_position_m();
        }
        assert_eq!(plant.load_speed_m_s(), 0.0);
        let held_n = axis.load_friction_n(load.wheel_load_n(&axis)) + axis.motor_coulomb_n_m / axis.chain_m_rad();
        let beyond_m = (w / held_n - 1.0) * (top_m - floor_m + 0.05);
        assert!(
            last_m < floor_m && last_m > floor_m - beyond_m,
            "{mounting:?}: {last_m}, {beyond_m} m beyond {floor_m}"
        );
    }
}

#[test]
fn a_hard_stop_holds_the_motor_at_full_current() {
    let axis = AxisParameters::long();
    let mut plant = bare(&axis);
    // 5 A, all of it through.
    let motor_n = axis.torque_constant_n_m_a * 5.0 / axis.chain_m_rad();
    let mut furthest_m: f64 = 0.0;
    for _ in 0..200_000 {
        plant.step(motor_n);
        furthest_m = furthest_m.max(plant.load_position_m());
    }
    assert!(!plant.is_inside_travel());
    assert!(furthest_m < axis.hard_high_m + 0.05, "{furthest_m}");
    assert_eq!(plant.load_speed_m_s(), 0.0);
}

#[test]
fn several_steps_at_once_are_the_single_steps_bit_for_bit() {
    let load = Load::mounted(BodyState::Wet);
    let mut single = Plant::new(&AxisParameters::long(), &load, STEP_S, 4.0, 1.0);
    let mut several = single;
    // To and fro, through rest, onto the far hard stop and off it again.
    for i in 0..200_000_u32 {
        let motor_n = if i < 120_000 { 18.0 } else { -12.0 } * f64::from(i % 30_000 / 10_000);
        let forces = [motor_n, motor_n + 0.1, motor_n - 0.1, motor_n];
        for force_n in forces {
            single.step(force_n);
        }
        several.steps(forces);
        assert_eq!(bits(&single), bits(&several), "{i}");
    }
    assert!(single.load_position_m() < 4.9);
}
