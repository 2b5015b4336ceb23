//! Known numbers by name, the numbers of similarity, and SNAME's letters.

use froude_hydro::similarity::{friction_ittc57, froude, reynolds};

use super::*;

const METRE: Dim = [1, 0, 0, 0, 0];
const VISCOSITY: Dim = [2, 0, -1, 0, 0];
const DENSITY: Dim = [-3, 1, 0, 0, 0];

fn of_tow(name: &str) -> Option<Dim> {
    Some(match name {
        "speed" | "v_x" => SPEED,
        "kinematic_viscosity" => VISCOSITY,
        "density" => DENSITY,
        _ => return None,
    })
}

fn tow(text: &str) -> Result<Formula, FormulaError> {
    Formula::parse(
        "f_x",
        text,
        &of_tow,
        NEWTON,
        &[("L".to_owned(), 4.0, METRE), ("A".to_owned(), 3.0, [2, 0, 0, 0, 0])],
    )
}

const ROW: [(&str, f64); 4] = [("speed", -1.5), ("v_x", -1.5), ("kinematic_viscosity", 1.1e-6), ("density", 999.0)];

#[test]
fn the_numbers_of_similarity_are_those_of_the_library() {
    let value = |text: &str| row(&tow(text).unwrap(), &ROW)[0];
    assert_eq!(value("c*Re"), reynolds(1.5, 4.0, 1.1e-6));
    assert!((value("c*Fr") / froude(1.5, 4.0) - 1.0).abs() < 2.0 * f64::EPSILON);
    assert_eq!(value("c*CF_ITTC57(Re)"), friction_ittc57(1.5 * 4.0 / 1.1e-6).unwrap());
    assert!(value("c*CF_ITTC57(Re/1e5)").is_nan(), "below 1000 the line has no meaning");
}

#[test]
fn a_formula_keeps_the_constants_that_it_reads() {
    let f = tow("0.5*rho*A*u*abs(u)*(C_1*CF_ITTC57(Re) + C_2*Fr^4)").unwrap();
    assert_eq!(f.channels, ["density", "v_x", "speed", "kinematic_viscosity"]);
    assert_eq!(f.constants.iter().map(|(name, ..)| name.as_str()).collect::<Vec<_>>(), ["A", "L"]);
    assert_eq!(f.coefficients, [("C_1".to_owned(), ONE), ("C_2".to_owned(), ONE)]);
    assert_eq!(tow("c*u").unwrap().constants, []);
}

#[test]
fn columns_come_before_the_names_of_the_water_and_of_similarity() {
    let own = |name: &str| if matches!(name, "rho" | "nu" | "Re" | "phi") { Some(ONE) } else { of_tow(name) };
    for name in ["rho", "nu", "Re", "phi"] {
        let f = Formula::parse("f_x", &format!("c*{name}"), &own, NEWTON, &[]).unwrap();
        assert_eq!(f.channels, [name]);
    }
    // The table's own L is a length a row.
    let own = |name: &str| if name == "L" { Some(METRE) } else { of_tow(name) };
    let f = Formula::parse("f_x", "c*Re", &own, NEWTON, &[]).unwrap();
    assert_eq!(f.channels, ["speed", "L", "kinematic_viscosity"]);
}

#[test]
fn what_they_lack_is_said() {
    let refused = |text: &str, columns: &dyn Fn(&str) -> Option<Dim>| {
        Formula::parse("f_x", text, columns, NEWTON, &[]).unwrap_err().to_string()
    };
    let length = "Re needs L: reference_length in [body], or L in [constants]; it is not declared";
    assert_eq!(refused("c*Re", &of_tow), length);
    let with = |l: Dim, nu: Option<Dim>| {
        move |name: &str| match name {
            "L" => Some(l),
            "kinematic_viscosity" => nu,
            "speed" => Some(SPEED),
            _ => None,
        }
    };
    assert_eq!(
        refused("c*Re", &with(METRE, None)),
        "Re needs the water's viscosity: temperature or kinematic_viscosity, in [fluid] or as a column; it is not declared"
    );
    assert_eq!(refused("c*Fr", &with(SPEED, None)), "Fr needs L in m, and it is in m/s");
    assert_eq!(refused("c*rho", &|_| None), "rho stands for the column density, which the table does not have");
    assert_eq!(refused("c*psi", &|_| None), "psi is the name of a column, which the table does not have");
    assert_eq!(refused("c*CF_ITTC57(speed)", &of_tow), "CF_ITTC57(speed) needs a pure number, but speed is m/s");
}
