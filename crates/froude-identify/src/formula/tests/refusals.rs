//! What is refused, in which words.

use super::*;

#[test]
fn what_is_not_linear_is_refused() {
    let start = "the formula is not linear in its coefficients: ";
    for (text, reason) in [
        ("a*b*v", "a*b multiplies coefficients with each other"),
        ("(a + b*v)*(c*u)", "(a + b*v)*c*u multiplies coefficients with each other"),
        ("a*v/b", "a*v/b divides by a coefficient"),
        ("1/a", "1/a divides by a coefficient"),
        ("a^2*v", "a^2 raises a coefficient to a power"),
        ("v*2^a", "2^a has a coefficient in its exponent"),
        ("abs(a)*v", "abs(a) has a coefficient in it"),
        ("sin(a*v + 1)", "sin(a*v + 1) has a coefficient in it"),
    ] {
        assert_eq!(message(text), format!("{start}{reason}"), "{text}");
    }
}

#[test]
fn unlike_units_are_refused_with_both() {
    for (text, expected) in [
        ("c*(v + v^2)", "v is m/s and v^2 is m^2/s^2: they cannot be added"),
        ("c*(v + r*L - 1)", "v + r*L is m/s and 1 is 1: they cannot be added"),
        ("c*v*(1 + u)", "1 is 1 and u is m/s: they cannot be added"),
        (
            "c*v + c*v*abs(v)",
            "the coefficient c stands beside m/s in one term and beside m^2/s^2 in another; \
             give the two terms different names",
        ),
        ("c*sin(v)", "sin(v) needs a pure number, but v is m/s"),
        ("c*exp(-v/L)", "exp(-v/L) needs a pure number, but -v/L is 1/s"),
        ("c*u^angle", "the exponent angle of u varies, but the base is m/s; its unit would vary too"),
        ("c*2^v", "the exponent v of 2 is m/s, but must be a pure number"),
        (
            "c*v^-99*v^-99",
            "the coefficient c would have the unit kg m^199/s^200; only whole powers up to 127 \
             can be recorded",
        ),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
}

#[test]
fn parts_without_a_coefficient_are_refused() {
    assert_eq!(
        message("c*v - 0.5*rho*L^2*v*abs(v)"),
        "the part -0.5*rho*L^2*v*abs(v) has no coefficient; give it one, and fix its value in \
         [identify.fixed] if it is known"
    );
    assert!(parse("c*v + 0").is_ok());
    let none = "the formula has no coefficient: every name in it is a channel or a constant";
    assert_eq!(message("v*abs(v)"), none);
    assert_eq!(message("0"), none);
    assert_eq!(message("rho*v"), none);
    assert_eq!(message("c*0*1 + a*v"), "the coefficient c is multiplied by zero");
    assert_eq!(message("c*(1 - 1)"), "the coefficient c is multiplied by zero");
    assert_eq!(message("c*v/(1-1)"), "v/(1 - 1) is not a finite number");
    assert_eq!(message("c*1/0"), "1/0 is not a finite number");
    assert_eq!(message("c*10^400"), "10^400 is not a finite number");
    assert_eq!(message("c*sqrt(-1)"), "sqrt(-1) is not a finite number");
}

#[test]
fn names_that_could_be_meant_otherwise_are_refused() {
    for (text, expected) in [
        ("c*w", "w stands for the column v_z, which the table does not have"),
        ("c*w_y", "w_y is the name of a column, which the table does not have"),
        ("c*v_x_dot", "v_x_dot is the name of a column, which the table does not have"),
        ("Y*v", "Y is the name of a load and cannot stand in a formula; give a coefficient another name"),
        ("c*f_x", "f_x is the name of a load and cannot stand in a formula; give a coefficient another name"),
        (
            "c*sinh(v)",
            "sinh at character 3 is not a function; known are abs, sqrt, sin, cos, tan, exp, ln, \
             sign and CF_ITTC57; a product is written sinh*(…)",
        ),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
}

#[test]
fn text_that_is_no_formula_is_refused_where_it_fails() {
    for (text, expected) in [
        ("", "the formula is empty; write for example \"Y_v*v + Y_vav*v*abs(v)\""),
        (" \n", "the formula is empty; write for example \"Y_v*v + Y_vav*v*abs(v)\""),
        ("c*v² ", "character 4 is '²'; a formula is made of names, numbers, + - * / ^ and parentheses"),
        ("c = v", "character 3 is '='; a formula is made of names, numbers, + - * / ^ and parentheses"),
        ("c*1e999", "\"1e999\" at character 3 is not a finite number"),
        ("c*.", "\".\" at character 3 is not a finite number"),
        ("c*v)", "unmatched \")\" at character 4"),
        ("c*(v", "unexpected end at character 5; expected \")\""),
        ("c*", "unexpected end at character 3; expected a name, a number or \"(\""),
        ("c**v", "unexpected \"*\" at character 3; expected a name, a number or \"(\""),
        ("c*()", "unexpected \")\" at character 4; expected a name, a number or \"(\""),
        ("2 v*c", "unexpected \"v\" at character 3; expected an operator or the end"),
        ("2v*c", "unexpected \"v\" at character 2; expected an operator or the end"),
        ("1.2.3*c", "unexpected \".3\" at character 4; expected an operator or the end"),
        ("(c)(v)", "unexpected \"(\" at character 4; expected an operator or the end"),
        ("--c*v", "unexpected \"-\" at character 2; expected a name, a number or \"(\""),
        ("c - - - v", "unexpected \"-\" at character 7; expected a name, a number or \"(\""),
        ("c*v^-u", "unexpected \"-\" at character 5; expected a number or \"(\" as the exponent"),
        ("c*sin", "unexpected end at character 6; expected \"(\" after a function's name"),
        ("c*abs*v", "unexpected \"*\" at character 6; expected \"(\" after a function's name"),
        (
            "c*v^2^3",
            "at character 6 a power is raised to a power; write (a^b)^c or a^(b^c) to say which \
             is meant",
        ),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
}

#[test]
fn long_deep_and_wide_formulas_are_bounded() {
    let long = format!("c*v{}", " + c*v".repeat(900));
    assert_eq!(message(&long), "the formula has 5403 characters; at most 4096 are read");
    let deep = |n: usize| format!("{}c*v{}", "(".repeat(n), ")".repeat(n));
    assert!(parse(&deep(DEPTH_LIMIT)).is_ok());
    assert_eq!(message(&deep(DEPTH_LIMIT + 1)), "at character 25 more than 24 parentheses are open at once");
    assert_eq!(message(&"(".repeat(4096)), message(&deep(DEPTH_LIMIT + 1)));
    let wide = |n: usize| (0..n).map(|i| format!("c{i}*v")).collect::<Vec<_>>().join("+");
    assert_eq!(parse(&wide(64)).unwrap().coefficients.len(), 64);
    assert_eq!(message(&wide(65)), "the formula has 65 coefficients; at most 64 are read");
    // The longest sum that fits is still a sum.
    let sum = format!("c*v{}", "+c*v".repeat(1000));
    assert_eq!(value(&sum), 1001.0 * -0.5);
    assert!(parse(&format!("c*v{}", "*1".repeat(2000))).is_ok());
}

/// A thread of this stack reads what is longest and deepest; those of programs have a megabyte and more.
const SMALL_STACK_BYTES: usize = 128 * 1024;

#[test]
fn no_formula_needs_a_large_stack() {
    let read = || {
        for opening in ["(", "-(", "2*(", "1 - (", "abs(", "(1 + v/v)^(", "-2/abs(c*v - "] {
            let deep = |n: usize| parse(&format!("c*v*{}1{}", opening.repeat(n), ")".repeat(n)));
            let why = |n: usize| deep(n).map_or_else(|error| error.to_string(), |_| String::new());
            assert!(!why(DEPTH_LIMIT - 1).starts_with("at character "), "{opening}: {}", why(DEPTH_LIMIT - 1));
            assert!(why(200).ends_with(" parentheses are open at once"), "{opening}: {}", why(200));
        }
        for link in ["+c*v", "*1", "/2", "*-1", "--c*v", "*(angle)"] {
            let longest = link.repeat((LENGTH_LIMIT - 3) / link.len());
            assert!(parse(&format!("c*v{longest}")).is_ok(), "{link}");
        }
        for open in ["(", "-(", "sin(", "1^(", "-", "+", "^", ")"] {
            assert!(parse(&open.repeat(LENGTH_LIMIT / open.len())).is_err(), "{open}");
        }
    };
    std::thread::Builder::new().stack_size(SMALL_STACK_BYTES).spawn(read).unwrap().join().unwrap();
}
