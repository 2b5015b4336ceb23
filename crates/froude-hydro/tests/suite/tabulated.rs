//! Printed tables against potential flow, as `tabulated_reference.py` computes it.

use std::f64::consts::PI;

use froude_hydro::ellipsoid::ellipsoid_added_mass;
use froude_hydro::tabulated::{
    CIRCULAR_CYLINDER, RECTANGULAR_PLATE, SQUARE_PRISM, Table, circular_cylinder_added_mass_m3,
    circular_disc_added_mass_m3, rectangular_plate_added_mass_m3, square_prism_added_mass_m3,
};

/// Potential flow, `(ratio, coefficient)`: good to the last digit or two.
#[rustfmt::skip]
const PLATES: &[(f64, f64)] = &[
    (1.00, 0.5790), (1.25, 0.6419), (1.50, 0.6898), (1.59, 0.7043), (2.00, 0.7569), (2.50, 0.8009), (3.00, 0.8318),
    (3.17, 0.8403), (4.00, 0.8719), (5.00, 0.8967), (6.25, 0.9168), (8.00, 0.9347), (10.00, 0.9476),
];
const PRISMS: &[(f64, f64)] = &[(1.0, 0.637), (2.0, 0.334), (5.0, 0.1395), (10.0, 0.0709)];
const CYLINDERS: &[(f64, f64)] = &[(1.2, 0.623), (2.5, 0.777), (5.0, 0.877), (9.0, 0.929)];

/// Rows whose print is not the rounded computation, with printed less computed in units of `digit`.
fn outside(table: &Table, computed: &[(f64, f64)], digit: f64) -> Vec<(f64, f64)> {
    let of_row = |&(ratio, value): &(f64, f64)| {
        let printed = table.coefficient(ratio).unwrap();
        let off = (printed - value) / digit;
        (off.abs() > 0.5).then(|| (ratio, (10.0 * off).round() / 10.0))
    };
    computed.iter().filter_map(of_row).collect()
}

/// A finding: three rows of the plate are not what potential flow rounds to, the last two of them cut off.
#[test]
fn plates_are_potential_flow_but_for_three_rows() {
    assert_eq!(outside(&RECTANGULAR_PLATE, PLATES, 0.001), [(3.0, -1.8), (8.0, -0.7), (10.0, -0.6)]);
}

/// A finding: the prisms' print is 7 to 13 % high, that of long cylinders 3 %.
#[test]
fn prisms_and_long_cylinders_are_printed_too_high() {
    for &(ratio, value) in PRISMS {
        let excess = SQUARE_PRISM.coefficient(ratio).unwrap() / value - 1.0;
        assert!((0.06..0.135).contains(&excess), "{ratio}: {excess}");
    }
    assert_eq!(outside(&CIRCULAR_CYLINDER, CYLINDERS, 0.01), [(5.0, 2.3), (9.0, 3.1)]);
}

#[test]
fn tables_answer_their_own_rows_and_run_between_them() {
    for table in [RECTANGULAR_PLATE, SQUARE_PRISM, CIRCULAR_CYLINDER] {
        for &(ratio, printed) in table.rows {
            assert!((table.coefficient(ratio).unwrap() - printed).abs() < 1e-15, "{} {ratio}", table.body);
        }
        for pair in table.rows.windows(2) {
            let between = table.coefficient(pair[1].0.min(2.0 * pair[0].0).midpoint(pair[0].0)).unwrap();
            assert!((between - pair[0].1) * (between - pair[1].1) < 0.0, "{} {}", table.body, pair[0].0);
        }
    }
    // Halfway to the endless plate, in the inverse: 20.
    assert!((RECTANGULAR_PLATE.coefficient(20.0).unwrap() - 0.9735).abs() < 1e-12);
}

#[test]
fn a_disc_is_the_flat_spheroid() {
    let exact = ellipsoid_added_mass([0.3, 0.3, 1e-12]).unwrap()[2];
    assert!((circular_disc_added_mass_m3(0.3) / exact - 1.0).abs() < 1e-11);
}

#[test]
fn volumes_are_those_of_the_table() {
    assert!((rectangular_plate_added_mass_m3(2.0, 1.0).unwrap() - 0.757 * PI / 2.0).abs() < 1e-12);
    assert!((square_prism_added_mass_m3(0.5, 1.0).unwrap() - 0.36 * 0.25).abs() < 1e-12);
    assert!((circular_cylinder_added_mass_m3(0.1, 0.5).unwrap() - 0.78 * PI * 0.005).abs() < 1e-12);
}

#[test]
fn nothing_is_extrapolated() {
    assert_eq!(
        square_prism_added_mass_m3(1.0, 12.0).unwrap_err().to_string(),
        "square prism: length over side is 12; the table goes from 1 to 10"
    );
    assert!(circular_cylinder_added_mass_m3(1.0, 1.0).is_err());
    assert!(rectangular_plate_added_mass_m3(0.0, 0.0).is_err());
    assert!(rectangular_plate_added_mass_m3(f64::NAN, 1.0).is_err());
}
