//! Printed table of cylinders against potential flow, as `tabulated_reference.py` computes it.

use std::f64::consts::PI;

use froude_hydro::tabulated::circular_cylinder_added_mass_m3;

/// Rows but the endless one: length over diameter, coefficient as printed, and as potential flow has it, good to the last digit or two.
const ROWS: [(f64, f64, f64); 4] = [(1.2, 0.62, 0.623), (2.5, 0.78, 0.777), (5.0, 0.90, 0.877), (9.0, 0.96, 0.929)];

fn coefficient(ratio: f64) -> f64 {
    circular_cylinder_added_mass_m3(0.5, ratio).unwrap() / (PI * 0.25 * ratio)
}

#[test]
fn the_table_answers_its_own_rows_and_runs_between_them() {
    for (ratio, printed, _) in ROWS {
        assert!((coefficient(ratio) - printed).abs() < 1e-15, "{ratio}");
    }
    for pair in ROWS.windows(2) {
        let between = coefficient(pair[0].0.midpoint(pair[1].0));
        assert!(pair[0].1 < between && between < pair[1].1, "{}", pair[0].0);
    }
    // Halfway to the infinite cylinder, in the inverse: 18.
    assert!((coefficient(18.0) - 0.98).abs() < 1e-12);
    assert!((circular_cylinder_added_mass_m3(0.1, 0.5).unwrap() - 0.78 * PI * 0.005).abs() < 1e-12);
}

/// A finding: long cylinders are printed 3 % too high, by more than half a unit of print.
#[test]
fn long_cylinders_are_printed_too_high() {
    let off = ROWS.map(|(_, printed, computed)| ((printed - computed) * 1000.0).round() / 10.0);
    assert_eq!(off, [-0.3, 0.3, 2.3, 3.1]);
}

#[test]
fn nothing_is_extrapolated() {
    assert_eq!(circular_cylinder_added_mass_m3(1.0, 1.0), None);
    assert_eq!(circular_cylinder_added_mass_m3(0.0, 0.0), None);
    assert_eq!(circular_cylinder_added_mass_m3(f64::NAN, 1.0), None);
}
