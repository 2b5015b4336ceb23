//! A second reading of the grammar: a random tree is written out, read by `Formula`, and
//! computed here.

use proptest::prelude::*;

use super::*;

#[derive(Debug, Clone)]
pub(super) enum Tree {
    Number(f64),
    Name(usize),
    Negative(Box<Tree>),
    Binary(char, Box<Tree>, Box<Tree>),
    Call(&'static str, Box<Tree>),
}

/// Pure numbers, so that every tree has a unit.
const NAMES: [&str; 3] = ["x", "y", "alpha_1"];

impl Tree {
    fn binding(&self) -> u8 {
        match self {
            Self::Binary('+' | '-', ..) => 0,
            Self::Binary('*' | '/', ..) | Self::Negative(_) => 1,
            Self::Binary(..) => 2,
            _ => 3,
        }
    }

    pub(super) fn text(&self) -> String {
        let inside = |tree: &Self, least: u8| {
            if tree.binding() < least { format!("({})", tree.text()) } else { tree.text() }
        };
        match self {
            Self::Number(x) => format!("{x:?}"),
            Self::Name(i) => NAMES[*i].to_owned(),
            Self::Negative(a) => format!("-{}", inside(a, 2)),
            Self::Binary('^', a, b) => format!("{}^{}", inside(a, 3), inside(b, 3)),
            Self::Binary(op @ ('*' | '/'), a, b) => {
                // A sign may stand behind * and /: that is part of what is tested.
                let right = if matches!(**b, Self::Negative(_)) { b.text() } else { inside(b, 2) };
                format!("{} {op}{right}", inside(a, 1))
            }
            Self::Binary(op, a, b) => format!("{}{op} {}", inside(a, 0), inside(b, 1)),
            Self::Call(name, a) => format!("{name}({})", a.text()),
        }
    }

    /// The value, every operation being wrong by the part `rounding`.
    fn value(&self, at: &[f64], rounding: f64) -> f64 {
        match self {
            Self::Number(x) => *x,
            Self::Name(i) => at[*i],
            Self::Negative(a) => -a.value(at, rounding),
            Self::Binary(op, a, b) => {
                // A whole exponent stays whole: beside it a negative base has no power.
                let is_whole = *op == '^' && b.value(at, 0.0).fract() == 0.0;
                let (a, b) = (a.value(at, rounding), b.value(at, if is_whole { 0.0 } else { rounding }));
                let exact = match op {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => a.powf(b),
                };
                exact * (1.0 + rounding)
            }
            Self::Call(name, a) => {
                let a = a.value(at, rounding);
                match *name {
                    "abs" => a.abs(),
                    "sin" => a.sin(),
                    "cos" => a.cos(),
                    "sign" if a == 0.0 => 0.0,
                    "sign" => a.signum(),
                    _ => a.exp(),
                }
            }
        }
    }
}

pub(super) fn any_tree() -> impl Strategy<Value = Tree> {
    let leaf =
        prop_oneof![(1..40u8).prop_map(|i| Tree::Number(f64::from(i) / 8.0)), (0..NAMES.len()).prop_map(Tree::Name),];
    leaf.prop_recursive(5, 40, 2, |inner| {
        prop_oneof![
            1 => inner.clone().prop_map(|a| Tree::Negative(Box::new(a))),
            6 => (prop::sample::select(vec!['+', '-', '*', '/', '^']), inner.clone(), inner.clone())
                .prop_map(|(op, a, b)| Tree::Binary(op, Box::new(a), Box::new(b))),
            1 => (prop::sample::select(vec!["abs", "sin", "cos", "sign", "exp"]), inner)
                .prop_map(|(name, a)| Tree::Call(name, Box::new(a))),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Read back, a tree has the value it was written with.
    #[test]
    fn a_written_tree_is_read_back(tree in any_tree(), at in [-2.0..2.0f64, -2.0..2.0f64, -2.0..2.0f64]) {
        let pure = |name: &str| NAMES.contains(&name).then_some(ONE);
        let text = format!("c*({})", tree.text());
        let expected = tree.value(&at, 0.0);
        // A tree can be ill-conditioned: the sine of a large power, a small difference.
        let larger = |most: f64, one: f64| if one.is_nan() || one > most { one } else { most };
        let blur = [-1e-13, 1e-13].map(|e| (tree.value(&at, e) - expected).abs()).into_iter().fold(0.0, larger);
        match Formula::parse("f_x", &text, &pure, NEWTON, &[]) {
            Ok(f) => {
                let values: Vec<f64> = f
                    .channels
                    .iter()
                    .map(|name| at[NAMES.iter().position(|n| n == name).unwrap()])
                    .collect();
                let mut out = [0.0];
                f.regressor(&values, &mut out);
                let close = (out[0] - expected).abs() <= 1e-9 * (1.0 + expected.abs()) + blur;
                let same = out[0] == expected || (out[0].is_nan() && expected.is_nan());
                prop_assert!(close || same || !expected.is_finite() || expected.abs() > 1e12 || blur.is_nan(),
                    "{text}: {} {expected}", out[0]);
            }
            Err(FormulaError(why)) => {
                let is_of_its_numbers = why.ends_with(" is not a finite number") || why.ends_with(" is multiplied by zero");
                let is_of_its_numbers = is_of_its_numbers && !why.contains(" at character ");
                prop_assert!(is_of_its_numbers, "{text}: {why}");
            }
        }
    }

    /// Whatever is typed, there is an answer and no panic.
    #[test]
    fn any_text_is_answered(text in "[cvrLn0-9 .*/^()+\\-_eE]{0,60}") {
        let _ = parse(&text);
    }

    #[test]
    fn any_unicode_is_answered(text in "\\PC{0,60}") {
        let _ = parse(&text);
    }
}
