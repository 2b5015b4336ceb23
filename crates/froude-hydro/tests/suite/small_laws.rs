//! Power law, link parameters, similarity.

use std::f64::consts::PI;

use crate::common::mamba;
use froude_hydro::link_parameters::{LinkCoefficients, LinkParameters, YawDrag, YawInertia};
use froude_hydro::power_law::PowerLaw;
use froude_hydro::similarity::{blockage, friction_ittc57, friction_laminar, froude, keulegan_carpenter, reynolds};
use proptest::prelude::*;

proptest! {
    #[test]
    fn power_law_derivatives_are_derivatives(
        k in 0.1..100.0f64, n in 0.5..3.0f64, speed in prop_oneof![0.05..3.0f64, -3.0..-0.05f64],
    ) {
        let h = 1e-6;
        let f = |k_n: f64, exponent: f64| k_n * speed.abs().powf(exponent).copysign(speed);
        let [by_k, by_n] = PowerLaw { k_n: k, exponent: n }.sensitivity(speed);
        prop_assert!(((f(k + h, n) - f(k - h, n)) / (2.0 * h) - by_k).abs() < 1e-6 * (1.0 + by_k.abs()));
        prop_assert!(((f(k, n + h) - f(k, n - h)) / (2.0 * h) - by_n).abs() < 1e-6 * (1.0 + by_n.abs()));
    }
}

fn link(inertia: YawInertia, drag: YawDrag, c: &LinkCoefficients) -> LinkParameters {
    LinkParameters::of(&mamba().link, 1025.0, c, inertia, drag)
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
    let c = LinkCoefficients { c_f: 0.3, c_d: 1.75, c_a: 1.5, c_m: 1.0 };
    let printed = link(YawInertia::AsPrinted, YawDrag::default(), &c).lambda_1_kg_m2;
    let (a, b, l) = (0.0588f64, 0.0394f64, 0.09f64);
    assert!((printed - 1025.0 * PI * (a * a - b * b).powi(2) * l.powi(3) / 12.0).abs() < 1e-18);
    let strip = link(YawInertia::default(), YawDrag::default(), &c).lambda_1_kg_m2;
    assert!(strip / printed > 1000.0, "{strip} {printed}");
    // A round link would have none at all as printed.
    let mut round = mamba().link;
    round.minor_semi_axis_m = round.major_semi_axis_m;
    let none = LinkParameters::of(&round, 1025.0, &c, YawInertia::AsPrinted, YawDrag::default());
    assert_eq!(none.lambda_1_kg_m2, 0.0);
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
fn a_power_law_rests_at_zero_and_has_odd_derivatives() {
    let law = PowerLaw { k_n: 47.83, exponent: 1.89 };
    assert_eq!(law.sensitivity(-1.2), law.sensitivity(1.2).map(|d| -d));
    assert_eq!(PowerLaw { k_n: 1.0, exponent: -1.0 }.sensitivity(0.0), [0.0, 0.0]);
}
