//! Formulas of user-written models: any text gives a formula or an error, and a formula gives numbers.
#![no_main]

use froude_identify::formula::Formula;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let channel = |name: &str| match name {
        "v_x" | "v_y" | "speed" => Some([1, 0, -1, 0, 0]),
        "w_z" => Some([0, 0, -1, 0, 0]),
        "angle" | "n_links" => Some([0; 5]),
        _ => None,
    };
    if let Ok(formula) = Formula::parse("f_y", text, &channel, [1, 1, -2, 0, 0], &[("L".to_owned(), 2.0, [1, 0, 0, 0, 0])]) {
        let values = vec![0.5; formula.channels.len()];
        let mut row = vec![0.0; formula.coefficients.len()];
        formula.regressor(&values, &mut row);
    }
});
