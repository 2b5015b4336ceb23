//! Bodies of revolution to nine digits.

use core::f64::consts::PI;

use froude_hydro::ellipsoid::ellipsoid_added_mass;
use froude_panel::revolution::{Stretch, capsule, solve, spheroid};

#[test]
fn spheroids_are_lambs_to_ten_digits() {
    for (slenderness, panels) in [(1.0, 4), (6.0, 8), (20.0, 16)] {
        let volume = 4.0 / 3.0 * PI * slenderness;
        let a = solve(&spheroid(slenderness, 1.0, panels));
        println!("{slenderness}: {a:?}");
        let [axial, transverse, _, _, rotary, _] = ellipsoid_added_mass([slenderness, 1.0, 1.0]).unwrap();
        assert!((a.axial_m3 / axial - 1.0).abs() < 1e-10, "{slenderness}: {a:?} {axial}");
        assert!((a.transverse_m3 / transverse - 1.0).abs() < 1e-10, "{slenderness}: {a:?} {transverse}");
        assert!((a.rotary_m5 - rotary).abs() < 1e-10 * volume * slenderness.powi(2), "{slenderness}: {a:?} {rotary}");
        assert!(a.coupling_m4.abs() < 1e-10 * volume * slenderness, "{a:?}");
    }
}

/// Radius 1, length 20: an independent program (source formulation, 1,184 unknowns) has these, to about 1e-10.
#[test]
fn the_capsule_is_that_of_another_program_to_eight_digits() {
    let a = solve(&capsule(9.0, 1.0, 16, 8));
    println!("{a:?}");
    for (found, other) in
        [(a.axial_m3, 2.7234746245424364), (a.transverse_m3, 56.688423015078776), (a.rotary_m5, 1541.604823314973)]
    {
        assert!((found / other - 1.0).abs() < 1e-8, "{found} {other}");
    }
}

/// What a comparison of times asks for, with the least unknowns that give it.
const FEW: f64 = 1e-8;

#[test]
fn few_unknowns_give_eight_digits() {
    let errors = |few: &[Stretch], many: &[Stretch]| {
        let (a, b) = (solve(few), solve(many));
        let entries = [(a.axial_m3, b.axial_m3), (a.transverse_m3, b.transverse_m3), (a.rotary_m5, b.rotary_m5)];
        let largest = entries.iter().map(|(x, y)| (x / y - 1.0).abs()).fold(0.0, f64::max);
        println!("{} unknowns: {largest:.1e}", a.unknowns);
        largest
    };
    assert!(errors(&spheroid(6.0, 1.0, 2), &spheroid(6.0, 1.0, 12)) < FEW);
    assert!(errors(&capsule(9.0, 1.0, 2, 4), &capsule(9.0, 1.0, 12, 6)) < FEW);
}
