//! What formulas mean, and what is refused.

mod language;
mod named_numbers;
mod refusals;
mod round_trip;
mod trees;

use super::*;

const SPEED: Dim = [1, 0, -1, 0, 0];
const RATE: Dim = [0, 0, -1, 0, 0];
const NEWTON: Dim = [1, 1, -2, 0, 0];
const ONE: Dim = [0; 5];

/// A table of planar motion.
fn columns(name: &str) -> Option<Dim> {
    Some(match name {
        "v_x" | "v_y" | "speed" => SPEED,
        "w_z" => RATE,
        "v_y_dot" => [1, 0, -2, 0, 0],
        "angle" => ONE,
        _ => return None,
    })
}

fn constants() -> Vec<(String, f64, Dim)> {
    vec![
        ("L".to_owned(), 2.0, [1, 0, 0, 0, 0]),
        ("rho".to_owned(), 1000.0, [-3, 1, 0, 0, 0]),
        ("n".to_owned(), 2.0, ONE),
    ]
}

fn parse(text: &str) -> Result<Formula, FormulaError> {
    Formula::parse("f_y", text, &columns, NEWTON, &constants())
}

fn message(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

/// The regressors at named channel values.
fn row(formula: &Formula, at: &[(&str, f64)]) -> Vec<f64> {
    let values: Vec<f64> = formula.channels.iter().map(|c| at.iter().find(|(name, _)| name == c).unwrap().1).collect();
    let mut out = vec![0.0; formula.coefficients.len()];
    formula.regressor(&values, &mut out);
    out
}

const AT: [(&str, f64); 6] =
    [("v_x", 1.5), ("v_y", -0.5), ("speed", 1.6), ("w_z", 0.25), ("v_y_dot", 0.1), ("angle", 0.3)];

fn value(text: &str) -> f64 {
    row(&parse(text).unwrap(), &AT)[0]
}
