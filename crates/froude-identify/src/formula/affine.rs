//! Values that are affine in the coefficients: to compute one proves that the formula is linear.

use super::error::FormulaError;
use super::grammar::Expression;
use super::part::{Binding, Part, shortened};
use super::program::{Binary, Function, Op};
use super::unit::Unit;

/// Affine in the coefficients: a fixed part and a regressor per coefficient.
#[derive(Debug, Clone)]
pub(super) struct Affine {
    pub fixed: Option<Part>,
    pub parts: Vec<(String, Part)>,
}

impl Expression {
    /// The value of the expression; `names` has the value of each name.
    ///
    /// # Errors
    ///
    /// The first that stands in the text: not linear, unlike units, not finite.
    pub(super) fn value(&self, names: &[Affine]) -> Result<Affine, FormulaError> {
        match self {
            Self::Number { value, text } => Ok(Affine::known_as(text, Op::Number(*value), Unit::ONE)),
            Self::Name(place) => Ok(names[*place].clone()),
            Self::Call(function, argument) => argument.value(names)?.function(*function),
            Self::Chain(first, rest) => {
                let mut value = first.value(names)?;
                for (op, right) in rest {
                    value = value.joined(*op, right.value(names)?)?;
                }
                Ok(value)
            }
        }
    }
}

impl Affine {
    /// What a name or a number gives; out of line as the others below, so that a nested formula takes little of the stack.
    #[inline(never)]
    pub(super) fn known_as(text: &str, op: Op, unit: Unit) -> Self {
        Self::fixed(Part { program: vec![op], unit, text: text.to_owned(), binding: Binding::Atom })
    }

    pub(super) fn coefficient(name: &str) -> Self {
        Self { fixed: None, parts: vec![(name.to_owned(), Part::one())] }
    }

    pub(super) fn fixed(part: Part) -> Self {
        Self { fixed: Some(part), parts: Vec::new() }
    }

    /// The value where it has no coefficient.
    fn known(&self) -> Option<&Part> {
        if self.parts.is_empty() { self.fixed.as_ref() } else { None }
    }

    fn text(&self) -> String {
        let terms = self.parts.iter().map(|(name, part)| {
            if part.is(1.0) { name.clone() } else { format!("{name}*{}", part.inside(Binding::Power)) }
        });
        let fixed = self.fixed.iter().map(|part| part.text.clone());
        shortened(terms.chain(fixed).collect::<Vec<_>>().join(" + "))
    }

    /// As a factor.
    fn factor_text(&self) -> String {
        let is_sum = self.parts.len() + usize::from(self.fixed.is_some()) > 1
            || self.known().is_some_and(|part| part.binding == Binding::Sum);
        if is_sum { format!("({})", self.text()) } else { self.text() }
    }

    #[inline(never)]
    fn joined(self, op: Binary, other: Self) -> Result<Self, FormulaError> {
        match op {
            Binary::Add | Binary::Subtract => self.sum(other, op),
            Binary::Multiply => self.product(other),
            Binary::Divide => self.quotient(&other),
            Binary::Power => self.power(&other),
        }
    }

    fn sum(mut self, other: Self, op: Binary) -> Result<Self, FormulaError> {
        let signed = |part: Part| if op == Binary::Add { part } else { part.negated() };
        for (name, part) in other.parts {
            let Some(place) = self.parts.iter().position(|(known, _)| *known == name) else {
                self.parts.push((name, signed(part)));
                continue;
            };
            let (name, here) = self.parts.swap_remove(place);
            if here.unit != part.unit {
                return Err(FormulaError(format!(
                    "the coefficient {name} stands beside {} in one term and beside {} in another; give the two terms different names",
                    here.unit, part.unit
                )));
            }
            self.parts.push((name, here.sum(&part, op)?));
        }
        self.fixed = match (self.fixed, other.fixed) {
            (Some(a), Some(b)) => Some(a.sum(&b, op)?),
            (Some(a), None) => Some(a),
            (None, b) => b.map(signed),
        };
        Ok(self)
    }

    fn product(self, other: Self) -> Result<Self, FormulaError> {
        match (self.known(), other.known()) {
            (_, Some(factor)) => self.each(|part| part.product(factor, false)),
            (Some(factor), None) => other.each(|part| part.product(factor, true)),
            (None, None) => {
                let term = format!("{}*{}", self.factor_text(), other.factor_text());
                Err(FormulaError::not_linear(&format!("{term} multiplies coefficients with each other")))
            }
        }
    }

    fn quotient(self, other: &Self) -> Result<Self, FormulaError> {
        if let Some(divisor) = other.known() {
            return self.each(|part| part.quotient(divisor));
        }
        let term = format!("{}/{}", self.factor_text(), other.factor_text());
        Err(FormulaError::not_linear(&format!("{term} divides by a coefficient")))
    }

    fn power(self, other: &Self) -> Result<Self, FormulaError> {
        let what = match (self.known(), other.known()) {
            (Some(base), Some(exponent)) => return base.clone().power(exponent).map(Self::fixed),
            (None, _) => "raises a coefficient to a power",
            (_, None) => "has a coefficient in its exponent",
        };
        let term = format!("{}^{}", self.factor_text(), other.factor_text());
        Err(FormulaError::not_linear(&format!("{term} {what}")))
    }

    #[inline(never)]
    fn function(self, function: Function) -> Result<Self, FormulaError> {
        match self.known() {
            Some(argument) => argument.clone().function(function).map(Self::fixed),
            None => {
                let term = format!("{}({}) has a coefficient in it", function.name(), self.text());
                Err(FormulaError::not_linear(&term))
            }
        }
    }

    /// Applies `f` to the fixed part and to every regressor.
    fn each(self, f: impl Fn(Part) -> Result<Part, FormulaError>) -> Result<Self, FormulaError> {
        Ok(Self {
            fixed: self.fixed.map(&f).transpose()?,
            parts: self
                .parts
                .into_iter()
                .map(|(name, part)| Ok((name, f(part)?)))
                .collect::<Result<_, FormulaError>>()?,
        })
    }
}
