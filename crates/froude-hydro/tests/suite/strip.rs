//! Strip theory against closed integrals and against Lamb's ellipsoids.

use std::f64::consts::PI;

use froude_hydro::ellipsoid::ellipsoid_added_mass;
use froude_hydro::strip::{Station, strip_added_mass};

/// Stations of an ellipsoid with semi-axes `a`, `b`, `c`, at equal angles of `x = −a cos θ`.
fn ellipsoid(a: f64, b: f64, c: f64, stations: u32) -> Vec<Station> {
    (0..stations)
        .map(|i| {
            let angle = PI * f64::from(i) / f64::from(stations - 1);
            let (half_width_m, half_height_m) = (b * angle.sin().abs(), c * angle.sin().abs());
            Station { x_m: -a * angle.cos(), half_width_m, half_height_m }
        })
        .collect()
}

/// Strip integrals of an ellipsoid: with `1 − x²/a²` for the squared sections, 4/3 a, 16/15 a and, with x², 4/15 a³.
fn closed(a: f64, b: f64, c: f64) -> [f64; 5] {
    let difference = b * b - c * c;
    let (sway, heave) = (PI * c * c, PI * b * b);
    let cube = 4.0 / 15.0 * a * a * a;
    [
        4.0 / 3.0 * a * sway,
        4.0 / 3.0 * a * heave,
        2.0 / 15.0 * PI * a * difference * difference,
        cube * heave,
        cube * sway,
    ]
}

fn diagonal(stations: &[Station]) -> [f64; 5] {
    let a = strip_added_mass(stations).unwrap();
    [1, 2, 3, 4, 5].map(|i| a[i][i])
}

/// Linear pieces inside a convex body: low, by a part that falls as the square of the spacing.
#[test]
fn an_ellipsoid_converges_to_its_closed_integrals_at_second_order() {
    let errors = [21, 41, 81].map(|n| {
        let (found, exact) = (diagonal(&ellipsoid(3.0, 0.3, 0.5, n)), closed(3.0, 0.3, 0.5));
        [0, 1, 2, 3, 4].map(|i| 1.0 - found[i] / exact[i])
    });
    println!("21 stations: {:?}", errors[0]);
    for i in 0..5 {
        assert!(errors[0][i] > 0.0 && errors[0][i] < 0.03, "{i}: {}", errors[0][i]);
        for pair in errors.windows(2) {
            let order = (pair[0][i] / pair[1][i]).log2();
            assert!((order - 2.0).abs() < 0.02, "{i}: {order}");
        }
    }
    assert!((errors[0][0] - 0.0062).abs() < 1e-4, "as documented: {}", errors[0][0]);
}

/// Pieces of cones are exact: `h²` integrates as a cone's volume, `x² h²` as its moment.
#[test]
fn cones_and_cylinders_are_exact() {
    let cone = [
        Station { x_m: 0.0, half_width_m: 0.0, half_height_m: 0.0 },
        Station { x_m: 2.0, half_width_m: 0.3, half_height_m: 0.5 },
    ];
    let a = strip_added_mass(&cone).unwrap();
    let close = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-14, "{found} {exact}");
    close(a[1][1], PI * 0.25 * 2.0 / 3.0);
    close(a[2][2], PI * 0.09 * 2.0 / 3.0);
    close(a[3][3], PI * 0.16 * 0.16 / 8.0 * 2.0 / 5.0);
    close(a[4][4], PI * 0.09 * 8.0 / 5.0);
    close(a[5][5], PI * 0.25 * 8.0 / 5.0);
    close(a[1][5], PI * 0.25 * 4.0 / 4.0);
    close(a[2][4], -PI * 0.09 * 4.0 / 4.0);
    let cylinder = [-0.5, 0.1, 1.0].map(|x_m| Station { x_m, half_width_m: 0.2, half_height_m: 0.1 });
    close(strip_added_mass(&cylinder).unwrap()[1][1], PI * 0.01 * 1.5);
}

/// Lamb's ellipsoid: strips give too much, less and less so; the documented excesses of spheroids.
#[test]
fn slender_spheroids_tend_to_lamb() {
    let excess = |ratio: f64| {
        let (strips, exact) = (closed(ratio, 1.0, 1.0), ellipsoid_added_mass([ratio, 1.0, 1.0]).unwrap());
        [1.0 - exact[1] / strips[0], 1.0 - exact[5] / strips[4]]
    };
    let (six, twenty, hundred) = (excess(6.0), excess(20.0), excess(100.0));
    println!("6:1 {six:?}, 20:1 {twenty:?}, 100:1 {hundred:?}");
    assert!((six[0] - 0.08).abs() < 0.005 && (six[1] - 0.22).abs() < 0.005, "{six:?}");
    assert!((twenty[0] - 0.01).abs() < 0.005 && (twenty[1] - 0.04).abs() < 0.005, "{twenty:?}");
    assert!(hundred[0] < 1e-3 && hundred[1] < 3e-3, "{hundred:?}");
}

/// Roll, and an elliptic section that is not round: 100:1, within what is left of the ends.
#[test]
fn a_flat_slender_ellipsoid_tends_to_lamb_in_every_element() {
    let exact = ellipsoid_added_mass([100.0, 1.0, 2.0]).unwrap();
    for (strips, exact) in closed(100.0, 1.0, 2.0).iter().zip(&exact[1..]) {
        assert!(*strips > *exact && strips / exact - 1.0 < 0.01, "{strips} {exact}");
    }
}

/// The same body with its stations moved along: what the parallel-axis law says.
#[test]
fn a_shifted_body_obeys_the_parallel_axis_law() {
    let stations = ellipsoid(1.0, 0.1, 0.2, 41);
    let at_centre = strip_added_mass(&stations).unwrap();
    let shifted: Vec<_> = stations.iter().map(|s| Station { x_m: s.x_m + 0.7, ..*s }).collect();
    let found = strip_added_mass(&shifted).unwrap();
    assert!((found[5][5] - at_centre[5][5] - 0.49 * at_centre[1][1]).abs() < 1e-14);
    assert!((found[1][5] - 0.7 * at_centre[1][1]).abs() < 1e-15);
    assert!((found[2][4] + 0.7 * at_centre[2][2]).abs() < 1e-15);
}

#[test]
fn stations_that_are_no_body_are_refused() {
    let station = |x_m, half_width_m| Station { x_m, half_width_m, half_height_m: 0.1 };
    let told = |stations: &[Station]| strip_added_mass(stations).unwrap_err().to_string();
    assert_eq!(told(&[station(0.0, 0.1)]), "1 stations describe no body; at least 2 are needed");
    assert_eq!(
        told(&[station(0.0, 0.1), station(0.0, 0.1)]),
        "station 1 at x = 0 m does not lie in front of the one before it; sort them by x, each once"
    );
    assert_eq!(
        told(&[station(0.0, 0.1), station(1.0, -0.1)]),
        "station 1: half-axes -0.1 m and 0.1 m must be finite and not below 0"
    );
}
