//! What was read can be written and read again.

use proptest::prelude::*;

use super::super::grammar::{self, Expression};
use super::super::program::Binary;
use super::super::token::tokens;
use super::trees::any_tree;
use super::*;

fn expression(text: &str) -> Result<(Expression, Vec<&str>), FormulaError> {
    grammar::expression(&tokens(text)?)
}

fn rank(op: Binary) -> u8 {
    match op {
        Binary::Add | Binary::Subtract => 0,
        Binary::Multiply | Binary::Divide => 1,
        Binary::Power => 2,
    }
}

fn symbol(op: Binary) -> &'static str {
    match op {
        Binary::Add => " + ",
        Binary::Subtract => " - ",
        Binary::Multiply => "*",
        Binary::Divide => "/",
        Binary::Power => "^",
    }
}

fn written(expression: &Expression, names: &[&str]) -> String {
    match expression {
        Expression::Number { text, .. } => text.clone(),
        Expression::Name(place) => names[*place].to_owned(),
        Expression::Call(function, argument) => format!("{}({})", function.name(), written(argument, names)),
        Expression::Chain(first, rest) => {
            let own = rank(rest[0].0);
            let mut out = String::new();
            let mut signed = false;
            let all = std::iter::once(("", &**first)).chain(rest.iter().map(|(op, operand)| (symbol(*op), operand)));
            for (symbol, operand) in all {
                // A sign stands for two factors, of which the second has no operator of its own.
                out += if signed { "" } else { symbol };
                signed = own == 1 && matches!(operand, Expression::Number { text, .. } if text == "-1");
                out += &match operand {
                    _ if signed => "-".to_owned(),
                    Expression::Chain(_, rest) if rank(rest[0].0) <= own => format!("({})", written(operand, names)),
                    _ => written(operand, names),
                };
            }
            out
        }
    }
}

fn comes_back(text: &str) -> Result<(), TestCaseError> {
    if let Ok((first, names)) = expression(text) {
        let again = written(&first, &names);
        prop_assert_eq!(expression(&again), Ok((first, names)), "{} as {}", text, again);
    }
    Ok(())
}

#[test]
fn a_formula_is_written_with_the_parentheses_that_it_needs() {
    for (text, expected) in [
        ("(a*b) + ((c))", "a*b + c"),
        ("a - (b - c) - -d*e", "a - (b - c) - -d*e"),
        ("-(a)^+2*-b/-(c/d)", "-a^2*-b/-(c/d)"),
        ("+sin((-x))^- 2", "sin(-x)^-2"),
        ("a^(b^c)", "a^(b^c)"),
    ] {
        let (first, names) = expression(text).unwrap();
        assert_eq!(written(&first, &names), expected, "{text}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_tree_comes_back(tree in any_tree()) {
        prop_assert!(expression(&tree.text()).is_ok());
        comes_back(&tree.text())?;
    }

    /// Signs, operators and parentheses in any order that is a formula.
    #[test]
    fn a_row_of_symbols_comes_back(text in "(\\(|-|\\+)?x((\\+|-|\\*|/|\\^)(-|\\+|\\()?(x|2|exp\\(x\\)|1e-3)\\)?){0,7}") {
        comes_back(&text)?;
    }
}
