//! First modes of tanks.

use froude_hydro::sloshing::rectangular_tank_modes_rad_s;

/// Deep: `ω² = πg/L`; shallow: a wave of `√(gd)` runs the length twice in a period.
#[test]
fn tank_modes_have_their_deep_and_shallow_limits() {
    let g = 9.80665;
    let [along, across] = rectangular_tank_modes_rad_s(4.0, 1.0, 40.0, g).unwrap();
    assert!((along / (std::f64::consts::PI * g / 4.0).sqrt() - 1.0).abs() < 1e-15);
    assert!((across / along - 2.0).abs() < 1e-15);
    let [along, _] = rectangular_tank_modes_rad_s(4.0, 1.0, 0.004, g).unwrap();
    let twice_the_length_s = 8.0 / (g * 0.004_f64).sqrt();
    // tanh x = x (1 − x²/3): half of that in ω.
    let left = (std::f64::consts::PI * 0.001).powi(2) / 6.0;
    assert!((std::f64::consts::TAU / along / twice_the_length_s - 1.0 - left).abs() < 1e-9);
}

#[test]
fn a_tank_without_water_is_refused() {
    let error = rectangular_tank_modes_rad_s(4.0, 1.0, 0.0, 9.81).unwrap_err();
    assert_eq!(error.to_string(), "depth of water is 0; it must be finite and above 0");
}
