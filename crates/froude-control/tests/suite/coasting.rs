//! Coast distance against integration, and the way that must stay free.

use froude_control::coast::{Coast, StoppingWay};
use proptest::prelude::*;

/// x = ∫ v/(c + bv) dv by Simpson's rule, 20,000 intervals; the integrand's kink-free curvature makes its error below 1e-9 of x
/// for bv/c up to 100.
fn integrated_m(c: f64, b: f64, v: f64) -> f64 {
    let n = 20_000;
    let h = v / f64::from(n);
    let f = |u: f64| u / (c + b * u);
    let inner: f64 = (1..n).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * f(f64::from(i) * h)).sum();
    h / 3.0 * (f(0.0) + inner + f(v))
}

proptest! {
    #[test]
    fn the_closed_form_is_the_integral(c in 0.01..5.0, b in prop_oneof![Just(0.0), 1e-9..1e-3, 1e-3..3.0], v in 0.001..2.0) {
        prop_assume!(b * v / c < 100.0);
        let coast = Coast { coulomb_m_s2: c, viscous_1_s: b };
        let expected = integrated_m(c, b, v);
        prop_assert!((coast.distance_m(v) / expected - 1.0).abs() < 1e-8);
        prop_assert_eq!(coast.distance_m(-v), coast.distance_m(v));
    }

    #[test]
    fn the_bound_lies_above_it_by_a_ninetieth_of_u_cubed_at_most(c in 0.01..5.0, b in 0.0..3.0, v in 0.001..2.0) {
        let coast = Coast { coulomb_m_s2: c, viscous_1_s: b };
        let u = b * v / c;
        let excess = coast.bound_m(v) / coast.distance_m(v) - 1.0;
        prop_assert!(excess >= -1e-11 && excess <= u * u * u / 90.0 + 1e-11, "u = {u}: {excess}");
    }

    /// Along a controlled stop from any speed the axis may lose its torque at any moment.
    #[test]
    fn torque_lost_in_a_controlled_stop_ends_within_the_stopping_way(
        c in 0.05..3.0, b in 0.0..2.0, a in 0.05..3.0, v in 0.01..1.0, part in 0.0..1.0,
    ) {
        let coast = Coast { coulomb_m_s2: c, viscous_1_s: b };
        let way_m = StoppingWay::new(coast, a).way_m(v);
        let lost_m_s = part * v;
        let stopped_m = (v * v - lost_m_s * lost_m_s) / (2.0 * a) + coast.distance_m(lost_m_s);
        prop_assert!(stopped_m <= way_m * (1.0 + 1e-11), "{stopped_m} {way_m}");
    }

    /// Braking at `a` from the peak: at speed u the move has u²/2a to go, and needs its stopping way.
    #[test]
    fn a_move_needs_no_more_than_the_way_beyond_its_target(
        c in 0.05..3.0, b in prop_oneof![Just(0.0), 0.0..2.0], a in 0.05..3.0, gentle in 0.05..1.0, v in 0.01..1.0, part in 0.0..1.0,
    ) {
        let stopping = StoppingWay::new(Coast { coulomb_m_s2: c, viscous_1_s: b }, a);
        let slow = a * gentle;
        let beyond_m = stopping.beyond_target_m(v, slow);
        let u = part * v;
        let needed_m = stopping.way_m(u) - u * u / (2.0 * slow);
        prop_assert!(needed_m <= beyond_m + 1e-11, "{needed_m} {beyond_m}");
        // And it is not more than the bound's excess too much.
        let most_m = (0..=1000).map(|i| v * f64::from(i) / 1000.0).map(|u| stopping.way_m(u) - u * u / (2.0 * slow)).fold(0.0, f64::max);
        prop_assert!(beyond_m <= most_m * (1.0 + 1e-3) + stopping.way_m(v) * (b * v / c).powi(3) / 90.0 + 1e-9, "{beyond_m} {most_m}");
    }
}

#[test]
fn the_papers_carriage_coasts_thirty_centimetres() {
    // J ω²/2C = 0.37 m without viscous friction, and the closed form with it.
    let drive = froude_control::config::AxisConfig::PUBLISHED.drive;
    let fitted = froude_control::config::Drive {
        coulomb_lower_n_m: drive.coulomb_n_m,
        viscous_lower_n_m_s_rad: drive.viscous_n_m_s_rad,
        ..drive
    };
    let coast = Coast::of(&fitted);
    let frictional = Coast { viscous_1_s: 0.0, ..coast };
    assert!((frictional.distance_m(0.55) - 0.3704).abs() < 1e-4, "{}", frictional.distance_m(0.55));
    assert!((coast.distance_m(0.55) - 0.2915).abs() < 1e-4, "{}", coast.distance_m(0.55));
}
