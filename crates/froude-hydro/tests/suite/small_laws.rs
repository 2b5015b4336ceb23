//! Axes, power law, link parameters, added mass, similarity, prime scaling.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::{mamba, setting};
use froude_hydro::DragModel;
use froude_hydro::added_mass::{
    ForcedOscillation, buoyancy_across_n, chain_mass_kg, coefficient, inertia_force_n, mass_kg,
};
use froude_hydro::axes::{
    acceleration_through_water_body_m_s2, angle_rad, body_from_world, speed_m_s, velocity_sensitivity,
    velocity_through_water_body_m_s, velocity_when_towed_m_s, world_from_body,
};
use froude_hydro::link_parameters::{LinkCoefficients, LinkParameters, YawDrag, YawInertia};
use froude_hydro::plausibility::{Verdict, drag_coefficient, frontal_drag_coefficient};
use froude_hydro::power_law::PowerLaw;
use froude_hydro::prime::{Load, MotionPowers, PrimeScale};
use froude_hydro::similarity::{blockage, friction_ittc57, friction_laminar, froude, keulegan_carpenter, reynolds};
use proptest::prelude::*;

proptest! {
    #[test]
    fn angle_and_speed_come_back(speed in 0.01..3.0f64, angle in -3.1..3.1f64) {
        let v = velocity_when_towed_m_s(speed, angle);
        prop_assert!((angle_rad(v) - angle).abs() < 1e-14);
        prop_assert!((speed_m_s(v) - speed).abs() < 1e-14);
    }

    #[test]
    fn towing_is_equation_five(speed in 0.01..3.0f64, angle in -3.1..3.1f64) {
        let v = velocity_when_towed_m_s(speed, angle);
        let w = velocity_through_water_body_m_s(angle, [speed, 0.0], [0.0, 0.0]);
        // Held in a stream along −x it is the same.
        let held = velocity_through_water_body_m_s(angle, [0.0, 0.0], [-speed, 0.0]);
        for i in 0..2 {
            prop_assert!((v[i] - w[i]).abs() < 1e-15 && (v[i] - held[i]).abs() < 1e-15);
        }
        let back = world_from_body(angle, body_from_world(angle, [0.3, -0.7]));
        prop_assert!((back[0] - 0.3).abs() < 1e-15 && (back[1] + 0.7).abs() < 1e-15);
    }

    #[test]
    fn sensitivities_are_derivatives(speed in 0.1..3.0f64, angle in -3.1..3.1f64) {
        let h = 1e-6;
        let [by_speed, by_angle] = velocity_sensitivity(speed, angle);
        let (fast, slow) =
            (velocity_when_towed_m_s(speed + h, angle), velocity_when_towed_m_s(speed - h, angle));
        let (left, right) =
            (velocity_when_towed_m_s(speed, angle + h), velocity_when_towed_m_s(speed, angle - h));
        for i in 0..2 {
            prop_assert!(((fast[i] - slow[i]) / (2.0 * h) - by_speed[i]).abs() < 1e-8);
            prop_assert!(((left[i] - right[i]) / (2.0 * h) - by_angle[i]).abs() < 1e-8);
        }
    }

    /// v̇ is the time derivative of v along any turning path (USR eq. 6).
    #[test]
    fn acceleration_is_the_derivative_of_velocity(
        heading in -3.0..3.0f64, rate in -2.0..2.0f64,
        u in [-1.0..1.0f64, -1.0..1.0f64], a in [-1.0..1.0f64, -1.0..1.0f64],
        current in [-1.0..1.0f64, -1.0..1.0f64],
    ) {
        let h = 1e-5;
        let v = |t: f64| velocity_through_water_body_m_s(
            heading + rate * t, [u[0] + a[0] * t, u[1] + a[1] * t], current);
        let exact = acceleration_through_water_body_m_s2(heading, rate, u, current, a);
        let (after, before) = (v(h), v(-h));
        for i in 0..2 {
            prop_assert!(((after[i] - before[i]) / (2.0 * h) - exact[i]).abs() < 1e-7);
        }
    }

    #[test]
    fn prime_and_si_round_trip(
        rho in 900.0..1100.0f64, u in 0.1..10.0f64, l in 0.1..300.0f64, t in 0.05..20.0f64,
        value in -5.0..5.0f64, powers in [0..4i32, 0..4i32, 0..2i32, 0..2i32],
    ) {
        let scale = PrimeScale::with_length_draught(rho, u, l, t);
        let powers = MotionPowers {
            velocity: powers[0], rate: powers[1], acceleration: powers[2],
            angular_acceleration: powers[3],
        };
        let (v, r, a, w) = (0.3f64, -0.2f64, 0.7f64, 1.1f64); // dimensionless motion
        for (load, unit) in [(Load::Force, scale.force_n()), (Load::Moment, scale.moment_n_m())] {
            let si = value * scale.si_per_prime(load, powers);
            prop_assert!((si / scale.si_per_prime(load, powers) - value).abs() < 1e-12);
            // The load is the same, written in either system.
            let product = v.powi(powers.velocity) * r.powi(powers.rate)
                * a.powi(powers.acceleration) * w.powi(powers.angular_acceleration);
            let by_prime = value * product * unit;
            let by_si = si * (v * u).powi(powers.velocity) * (r * u / l).powi(powers.rate)
                * (a * u * u / l).powi(powers.acceleration)
                * (w * u * u / (l * l)).powi(powers.angular_acceleration);
            prop_assert!((by_prime - by_si).abs() <= 1e-10 * by_prime.abs());
        }
    }

    #[test]
    fn power_law_derivatives_are_derivatives(
        k in 0.1..100.0f64, n in 0.5..3.0f64, speed in prop_oneof![0.05..3.0f64, -3.0..-0.05f64],
    ) {
        let h = 1e-6;
        let f = |k_n: f64, exponent: f64| PowerLaw { k_n, exponent }.resistance_n(speed);
        let [by_k, by_n] = PowerLaw { k_n: k, exponent: n }.sensitivity(speed);
        prop_assert!(((f(k + h, n) - f(k - h, n)) / (2.0 * h) - by_k).abs() < 1e-6 * (1.0 + by_k.abs()));
        prop_assert!(((f(k, n + h) - f(k, n - h)) / (2.0 * h) - by_n).abs() < 1e-6 * (1.0 + by_n.abs()));
    }
}

#[test]
fn straight_astern_is_a_half_turn_whatever_the_sign_of_zero() {
    assert_eq!(angle_rad([-1.0, 0.0]), PI);
    assert_eq!(angle_rad([-1.0, -0.0]), PI);
    assert_eq!(angle_rad([0.0, -0.0]), 0.0);
    assert!((angle_rad([0.0, -2.0]) - FRAC_PI_2).abs() < 1e-15);
}

#[test]
fn accelerating_mass_has_the_scale_of_a_mass() {
    let scale = PrimeScale::with_length_squared(1000.0, 1.7, 3.0);
    let udot = MotionPowers { acceleration: 1, ..MotionPowers::default() };
    assert!((scale.si_per_prime(Load::Force, udot) - scale.mass_kg()).abs() < 1e-9);
    let rdot = MotionPowers { angular_acceleration: 1, ..MotionPowers::default() };
    assert!((scale.si_per_prime(Load::Moment, rdot) - scale.inertia_kg_m2()).abs() < 1e-9);
    assert!((scale.mass_kg() - 0.5 * 1000.0 * 27.0).abs() < 1e-9);
}

fn link(inertia: YawInertia, drag: YawDrag, c: &LinkCoefficients) -> LinkParameters {
    LinkParameters::of(&mamba().link, 1025.0, c, inertia, drag).unwrap()
}

/// Each parameter against a strip integral over 2000 strips, midpoint rule: its
/// relative error is below 1e-6 for these integrands.
#[test]
fn link_parameters_are_the_integrals_of_their_strips() {
    let c = LinkCoefficients { c_f: 0.02, c_d: 1.3, c_a: 1.27, c_m: 1.0 };
    let (a, b, l) = (0.0588, 0.0394, 0.09);
    let n = 2000;
    let strip = 2.0 * l / f64::from(n);
    let integral =
        |f: &dyn Fn(f64) -> f64| -> f64 { (0..n).map(|i| f(-l + (f64::from(i) + 0.5) * strip) * strip).sum() };
    let friction = 0.5 * 1025.0 * PI * c.c_f * 0.5 * (a + b);
    let cross = 0.5 * 1025.0 * c.c_d * 2.0 * a;
    let added = 1025.0 * PI * c.c_a * a * a;
    let near = |x: f64, y: f64| assert!((x / y - 1.0).abs() < 1e-6, "{x} {y}");
    let f = link(YawInertia::StripTheory, YawDrag::FrictionStrip, &c);
    near(f.c_t_kg_m, integral(&|_| friction));
    near(f.c_n_kg_m, integral(&|_| cross));
    near(f.added_mass_kg, integral(&|_| added));
    near(f.lambda_1_kg_m2, integral(&|x| added * x * x));
    near(f.lambda_2_kg_m, integral(&|x| friction * x * x));
    near(f.lambda_3_kg_m2, integral(&|x| friction * x * x * x.abs()));
    let g = link(YawInertia::StripTheory, YawDrag::CrossFlow, &c);
    near(g.lambda_2_kg_m, integral(&|x| cross * x * x));
    near(g.lambda_3_kg_m2, integral(&|x| cross * x * x * x.abs()));
    near(g.lambda_3_kg_m2, 0.5 * 1025.0 * c.c_d * a * l.powi(4));
}

#[test]
fn printed_yaw_inertia_is_offered_and_is_another_number() {
    let c = LinkCoefficients::MAMBA_ESTIMATED;
    let printed = link(YawInertia::AsPrinted, YawDrag::default(), &c).lambda_1_kg_m2;
    let (a, b, l) = (0.0588f64, 0.0394f64, 0.09f64);
    assert!((printed - 1025.0 * PI * (a * a - b * b).powi(2) * l.powi(3) / 12.0).abs() < 1e-18);
    let strip = link(YawInertia::default(), YawDrag::default(), &c).lambda_1_kg_m2;
    assert!(strip / printed > 1000.0, "{strip} {printed}");
    // A round link would have none at all as printed.
    let mut round = mamba().link;
    round.minor_semi_axis_m = round.major_semi_axis_m;
    let none = LinkParameters::of(&round, 1025.0, &c, YawInertia::AsPrinted, YawDrag::default()).unwrap();
    assert_eq!(none.lambda_1_kg_m2, 0.0);
}

/// One plain link's law is what f1 counts n times.
#[test]
fn link_drag_summed_over_the_modules_is_f1() {
    let c = LinkCoefficients { c_f: 0.02, c_d: 1.3, c_a: 1.0, c_m: 1.0 };
    let one = link(YawInertia::default(), YawDrag::default(), &c).drag_n(1.0, [0.3, -0.2]);
    let all = DragModel::F1.force_n(&setting(2.0), [0.3, -0.2], &[0.02, 1.3]);
    assert!((4.0 * one[0] - all[0]).abs() < 1e-14 && (4.0 * one[1] - all[1]).abs() < 1e-13);
}

#[test]
fn fluid_torque_resists_turning_and_turning_faster() {
    let c = LinkCoefficients::MAMBA_ESTIMATED;
    let p = link(YawInertia::default(), YawDrag::CrossFlow, &c);
    assert!(p.torque_n_m(1.0, 2.0, 0.0) < 0.0 && p.torque_n_m(1.0, -2.0, 0.0) > 0.0);
    assert_eq!(p.torque_n_m(1.0, 0.0, 3.0), -3.0 * p.lambda_1_kg_m2);
    assert!(LinkParameters::of(&mamba().link, 0.0, &c, YawInertia::default(), YawDrag::default()).is_err());
}

/// USR Table 6: `(k, μ_x [kg], μ_y [kg], V [1e-3 m³])`, H1LT to H9LT.
#[rustfmt::skip]
const TABLE_6: [(f64, f64, f64, f64); 9] = [
    (1.0, 0.2318, 1.8600, 1.893), (2.0, 0.5153, 3.6840, 2.670), (3.0, 0.6486, 5.1539, 3.830),
    (4.0, 0.6967, 6.7942, 4.929), (5.0, 0.9147, 8.3451, 6.029), (6.0, 0.8570, 9.9436, 7.130),
    (7.0, 0.9210, 11.527, 8.230), (8.0, 1.0449, 13.112, 9.330), (9.0, 1.1822, 14.689, 10.430),
];

/// Least squares through the origin, eq. 23: Table 7 prints 0.1194 and 1.3601.
#[test]
fn table_seven_follows_from_table_six() {
    let slope = |points: &[(f64, f64)]| {
        let xy: f64 = points.iter().map(|(x, y)| x * y).sum();
        let xx: f64 = points.iter().map(|(x, _)| x * x).sum();
        xy / xx
    };
    let against_volume = |mass: fn(&(f64, f64, f64, f64)) -> f64| {
        let points: Vec<(f64, f64)> =
            TABLE_6.iter().map(|row| (mass_kg(1.0, 1025.0, row.3 * 1e-3), mass(row))).collect();
        slope(&points)
    };
    let c_ax = against_volume(|row| row.1);
    let c_ay = against_volume(|row| row.2);
    assert!((c_ax - 0.1194).abs() < 0.5e-4, "{c_ax}");
    // 1.36002: printed 1.3601, within the rounding of inputs and density.
    assert!((c_ay - 1.36002).abs() < 1e-5, "{c_ay}");
    // Eq. 24 with C_A = 1.2674 fixes the volume per link that the record must carry.
    let per_link_kg = slope(&TABLE_6.map(|row| (row.0, row.2)));
    assert!((per_link_kg - 1.65277).abs() < 1e-5, "{per_link_kg}");
    let mu_n_m3 = per_link_kg / (1025.0 * 1.2674);
    assert!((mu_n_m3 - 1.2723e-3).abs() < 1e-7, "{mu_n_m3}");
    assert!((chain_mass_kg(1.2674, 1025.0, mu_n_m3, 1.0) - per_link_kg).abs() < 1e-12);
}

#[test]
fn coefficients_of_table_six_come_from_its_masses_and_volumes() {
    // H3LT..H9LT agree to the print; printed C_Ay with half a unit and V's rounding.
    for (row, printed) in TABLE_6[2..].iter().zip([1.3132, 1.3448, 1.3504, 1.3606, 1.3664, 1.3711, 1.3740]) {
        assert!((coefficient(row.2, 1025.0, row.3 * 1e-3) - printed).abs() < 4e-4);
    }
}

/// A swing made of known parts: the signed balance gives the added-mass force back.
#[test]
fn signed_balance_returns_the_inertia_force() {
    let swing = ForcedOscillation { radius_m: 0.476, amplitude_rad: 0.3, frequency_rad_s: 1.2, phase_rad: 0.4 };
    let (body_kg, added_kg, buoyancy_n) = (1.9, 1.86, -0.8);
    for i in 0..50 {
        let t = 0.1 * f64::from(i);
        let [phi, v, a] = swing.at(t);
        let drag = -3.0 * v * v.abs();
        let lift = buoyancy_across_n(buoyancy_n, phi);
        let rig = (body_kg + added_kg) * a - drag - lift; // Newton
        let f_a = inertia_force_n(body_kg, a, rig, drag, lift);
        assert!((f_a + added_kg * a).abs() < 1e-12);
        // v and a are derivatives of the motion.
        let h = 1e-5;
        let (after, before) = (swing.at(t + h), swing.at(t - h));
        assert!((0.476 * (after[0] - before[0]) / (2.0 * h) - v).abs() < 1e-9);
        assert!(((after[1] - before[1]) / (2.0 * h) - a).abs() < 1e-9);
    }
}

#[test]
fn ittc_line_has_its_printed_values() {
    // ITTC-57 at 10⁶, 10⁷, 10⁸, 10⁹: 0.004688, 0.003000, 0.002083, 0.001531.
    for (re, printed) in [(1e6, 4.688e-3), (1e7, 3.000e-3), (1e8, 2.083e-3), (1e9, 1.531e-3)] {
        assert!((friction_ittc57(re).unwrap() - printed).abs() < 0.501e-6);
    }
    assert_eq!(
        friction_ittc57(500.0).unwrap_err().to_string(),
        "Reynolds number 500 is below 1000, where the ITTC-57 line has no meaning"
    );
    assert!(friction_ittc57(f64::NAN).is_err() && friction_ittc57(f64::INFINITY).is_err());
    assert!((friction_laminar(1e6) - 1.328e-3).abs() < 1e-15);
}

#[test]
fn similarity_numbers_are_what_they_say() {
    assert!((reynolds(-2.0, 0.5, 1e-6) - 1e6).abs() < 1e-6);
    assert!((froude(1.0, 1.0 / 9.80665) - 1.0).abs() < 1e-15);
    // Harmonic motion of amplitude A: 2πA/D.
    let (amplitude, omega, width) = (0.05, 3.0, 0.1);
    let kc = keulegan_carpenter(amplitude * omega, 2.0 * PI / omega, width);
    assert!((kc - 2.0 * PI * amplitude / width).abs() < 1e-14);
    assert!((blockage(0.04, 2.0 * 1.0) - 0.02).abs() < 1e-17);
}

#[test]
fn power_law_is_odd_and_rests_at_zero() {
    let law = PowerLaw { k_n: 47.83, exponent: 1.89 };
    assert_eq!(law.resistance_n(0.0), 0.0);
    assert_eq!(law.resistance_n(-1.2), -law.resistance_n(1.2));
    assert!((law.resistance_n(1.0) - 47.83).abs() < 1e-12);
    assert_eq!(PowerLaw { k_n: 1.0, exponent: -1.0 }.resistance_n(0.0), 0.0);
    let c_d = PowerLaw::quadratic(20.0).drag_coefficient(1000.0, 0.04, 0.55);
    assert!((c_d - 1.0).abs() < 1e-12);
}

#[test]
fn a_drag_coefficient_that_no_body_has_is_reported() {
    // MCD's cylinder: 6 N at 0.55 m/s would be C_D ≈ 1.
    let real = drag_coefficient(6.05, 1000.0, 0.04, 0.55);
    assert_eq!(frontal_drag_coefficient(real), Verdict::Plausible);
    assert_eq!(frontal_drag_coefficient(0.0044), Verdict::TooSmall);
    assert_eq!(frontal_drag_coefficient(4.0), Verdict::TooLarge);
    assert_eq!(frontal_drag_coefficient(-0.1), Verdict::NotResisting);
    assert_eq!(frontal_drag_coefficient(f64::NAN), Verdict::NotResisting);
}
