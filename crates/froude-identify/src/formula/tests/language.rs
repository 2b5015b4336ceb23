//! What a formula computes.

use super::*;

#[test]
fn sway_of_a_ship_is_read_with_units_and_aliases() {
    let f = Formula::parse("Y", "Y_0 + Y_v * v + Y_vav * v*abs(v) + Y_vvr * v^2*r", &columns, NEWTON, &[]).unwrap();
    assert_eq!(f.load, "f_y");
    assert_eq!(f.channels, ["v_y", "w_z"]);
    assert!(f.offset);
    let expected: [(&str, Dim); 4] =
        [("Y_0", NEWTON), ("Y_v", [0, 1, -1, 0, 0]), ("Y_vav", [-1, 1, 0, 0, 0]), ("Y_vvr", [-1, 1, 1, 0, 0])];
    for ((name, dim), (wanted, wanted_dim)) in f.coefficients.iter().zip(expected) {
        assert_eq!((name.as_str(), *dim), (wanted, wanted_dim));
    }
    assert_eq!(row(&f, &AT), [1.0, -0.5, -0.25, 0.0625]);
    assert!(!parse("Y_v*v").unwrap().offset);
}

#[test]
fn a_coefficient_may_stand_in_several_terms() {
    let f = parse("a*v_x - a*v_y + 2*b*v_x*v_y/L^2*L").unwrap();
    assert_eq!(f.coefficients.len(), 2);
    assert_eq!(row(&f, &AT), [2.0, -0.75]);
}

#[test]
fn a_bracket_of_coefficients_is_multiplied_out() {
    let f = parse("0.5*rho*L^2*(C_1*v*abs(v) + C_2*r*L*u)").unwrap();
    assert_eq!(f.coefficients, [("C_1".to_owned(), ONE), ("C_2".to_owned(), ONE)]);
    assert_eq!(row(&f, &AT), [-500.0, 1500.0]);
}

#[test]
fn signs_and_powers_bind_as_on_paper() {
    assert_eq!(value("-c*v_x^2"), -2.25);
    assert_eq!(value("c*-v_x^2"), -2.25);
    assert_eq!(value("-v_x^2*c"), -2.25);
    assert_eq!(value("c*(-v_x)^2"), 2.25);
    assert_eq!(value("c*v_x^-2"), 1.0 / 2.25);
    assert_eq!(value("c*v_x^+2"), 2.25);
    assert_eq!(value("c/-v_x^2"), -1.0 / 2.25);
    assert_eq!(value("c/v_x/v_x*v_y"), -0.5 / 2.25);
    assert_eq!(value("c*v_x - -c*v_y"), 1.0);
    assert_eq!(value("c*v_x - c*v_y - c*v_x"), 0.5);
    assert_eq!(value("c*(v_x - v_y - v_x)"), 0.5);
    assert_eq!(value("-(c*(v_x - (v_y - v_x)))"), -3.5);
    assert_eq!(value("+c*1e-3*v_x"), 1.5e-3);
    assert_eq!(value("c*.5*v_x^n"), 1.125);
    assert_eq!(value("c*2^(3^2)/512."), 1.0);
    assert_eq!(value("c*(2^3)^2"), 64.0);
    assert_eq!(value("\tc *\nv_x "), 1.5);
}

/// A text, what it means, and what it could be mistaken for.
const PRECEDENCE: [[&str; 3]; 18] = [
    ["x - y - z", "(x - y) - z", "x - (y - z)"],
    ["x - y + z", "(x - y) + z", "x - (y + z)"],
    ["x + y - z", "(x + y) - z", "x + (y - z)"],
    ["x/y/z", "(x/y)/z", "x/(y/z)"],
    ["x/y*z", "(x/y)*z", "x/(y*z)"],
    ["x*y/z", "(x*y)/z", "x*(y/z)"],
    ["x + y*z", "x + (y*z)", "(x + y)*z"],
    ["x/y - z", "(x/y) - z", "x/(y - z)"],
    ["x*y^z", "x*(y^z)", "(x*y)^z"],
    ["x^y*z", "(x^y)*z", "x^(y*z)"],
    ["x^2/y", "(x^2)/y", "x^(2/y)"],
    ["-x^2", "-(x^2)", "(-x)^2"],
    ["-x*y", "(-x)*y", "x*(-y)"],
    ["-x + y", "(-x) + y", "-(x + y)"],
    ["x*-y^z", "x*(-1)*(y^z)", "x*((-y)^z)"],
    ["x/-y*z", "x/(-1)/y*z", "x/(-1)/(y*z)"],
    ["x^-2*y", "(x^(-2))*y", "x^(-2*y)"],
    ["sin(x)^2", "(sin(x))^2", "sin(x^2)"],
];

#[test]
fn operators_bind_in_the_order_of_the_table() {
    let pure = |name: &str| matches!(name, "x" | "y" | "z").then_some(ONE);
    let programs = |text: &str| Formula::parse("f_x", &format!("c*({text})"), &pure, NEWTON, &[]).unwrap().programs;
    for [text, meant, mistaken] in PRECEDENCE {
        assert_eq!(programs(text), programs(meant), "{text}");
        assert_ne!(programs(text), programs(mistaken), "{text}");
    }
}

#[test]
fn functions_are_the_usual_ones() {
    assert_eq!(value("c*abs(v_y)"), 0.5);
    assert_eq!(value("c*sign(v_y)"), -1.0);
    assert_eq!(value("c*sign(v_y - v_y)"), 0.0);
    assert_eq!(value("c*sqrt(v_x^2)"), 1.5);
    assert_eq!(value("c*sin(angle)"), 0.3f64.sin());
    assert_eq!(value("c*cos(2*angle)*tan(angle)"), 0.6f64.cos() * 0.3f64.tan());
    assert_eq!(value("c*exp(-angle)"), (-0.3f64).exp());
    assert_eq!(value("c*ln(v_x/speed)"), (1.5f64 / 1.6).ln());
    assert_eq!(value("c*sin(pi/2)*v_x"), 1.5);
    assert_eq!(value("c*sin(angle)^2*v_x"), 1.5 * 0.3f64.sin().powi(2));
    assert!(value("c*sqrt(v_y)*sqrt(v_y)").is_nan());
}

#[test]
fn half_powers_are_followed_and_whole_ones_recorded() {
    let f = parse("c*sqrt(abs(v))*abs(u)^1.5").unwrap();
    assert_eq!(f.coefficients[0].1, [-1, 1, 0, 0, 0]);
    assert_eq!(
        message("c*abs(v)^1.5"),
        "the coefficient c would have the unit kg/(m^(1/2) s^(1/2)); only whole powers up to \
         127 can be recorded"
    );
    assert_eq!(message("c*abs(v)^1.87"), "the exponent 1.87 of abs(v) gives m/s a power that cannot be recorded");
    // With a reference speed the power law is a pure number times newtons.
    let f = Formula::parse("f_x", "k*abs(u/U_0)^1.87", &columns, NEWTON, &[("U_0".to_owned(), 1.0, SPEED)]).unwrap();
    assert_eq!(f.coefficients[0].1, NEWTON);
    assert!((row(&f, &AT)[0] - 1.5f64.powf(1.87)).abs() < 1e-15);
}

#[test]
fn a_column_named_like_an_alias_and_a_constant_come_first() {
    let own = |name: &str| (name == "r").then_some(ONE);
    assert_eq!(Formula::parse("f_x", "c*r", &own, NEWTON, &[]).unwrap().channels, ["r"]);
    // A column called like an alias is that column, also where the table has the other one.
    let both = |name: &str| matches!(name, "v" | "v_y").then_some(SPEED);
    assert_eq!(Formula::parse("f_x", "c*v + d*v_y", &both, NEWTON, &[]).unwrap().channels, ["v", "v_y"]);
    for letter in ["u", "v", "w", "p", "q", "r", "X", "Y", "Z", "K", "M", "N"] {
        let own = |name: &str| (name == letter || name.len() == 3).then_some(SPEED);
        let f = Formula::parse("f_x", &format!("c*{letter}"), &own, NEWTON, &[]).unwrap();
        assert_eq!(f.channels, [letter]);
    }
    let f = Formula::parse("f_x", "c*v", &both, NEWTON, &[("v".to_owned(), 3.0, ONE)]).unwrap();
    assert!(f.offset && f.channels.is_empty());
    assert_eq!(f.coefficients[0].1, NEWTON);
    let bad = [("L".to_owned(), f64::NAN, ONE)];
    let refused = Formula::parse("f_x", "c*L", &both, NEWTON, &bad).unwrap_err();
    assert_eq!(refused.to_string(), "L is not a finite number");
}

#[test]
fn short_rows_do_not_harm() {
    let f = parse("a*v + b*r + c").unwrap();
    let mut out = [7.0; 2];
    f.regressor(&[1.0], &mut out);
    assert!(out[0] == 1.0 && out[1].is_nan());
    f.regressor(&[1.0, 2.0, 3.0], &mut []);
}
