//! Parts of a formula that have no coefficient: a program, its unit, and the text for messages.

use super::error::FormulaError;
use super::program::{Binary, Function, Op, run};
use super::unit::Unit;

/// How tightly the outermost operator of a text binds.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub(super) enum Binding {
    Sum,
    Product,
    Power,
    Atom,
}

/// A quantity without coefficients.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub program: Vec<Op>,
    pub unit: Unit,
    /// As a reader would write it, for messages.
    pub text: String,
    pub binding: Binding,
}

impl Part {
    pub(super) fn one() -> Self {
        Self { program: vec![Op::Number(1.0)], unit: Unit::ONE, text: "1".to_owned(), binding: Binding::Atom }
    }

    /// A pure number that is computed from what is known, under the name that stands for it.
    pub(super) fn named(name: &str, program: Vec<Op>) -> Self {
        Self { program, unit: Unit::ONE, text: name.to_owned(), binding: Binding::Atom }
    }

    fn number(&self) -> Option<f64> {
        match self.program[..] {
            [Op::Number(x)] => Some(x),
            _ => None,
        }
    }

    pub(super) fn is_zero(&self) -> bool {
        self.number() == Some(0.0)
    }

    pub(super) fn is(&self, value: f64) -> bool {
        self.number() == Some(value) && self.unit == Unit::ONE && self.text.starts_with(['1', '-'])
    }

    /// The text, in parentheses where it binds less tightly than its place asks.
    pub(super) fn inside(&self, binding: Binding) -> String {
        if self.binding < binding { format!("({})", self.text) } else { self.text.clone() }
    }

    /// Appends `other` and `op`; folds the program where both are numbers.
    fn join(&mut self, op: Binary, other: &Self) {
        let folds = self.number().is_some() && other.number().is_some();
        self.program.extend_from_slice(&other.program);
        self.program.push(Op::Binary(op));
        if folds {
            self.program = vec![Op::Number(run(&self.program, &[], &mut Vec::new()))];
        }
    }

    /// As it is, if a program that is one number has a finite one.
    fn finite(self) -> Result<Self, FormulaError> {
        if self.number().is_some_and(|x| !x.is_finite()) {
            return Err(FormulaError::not_finite(&self.text));
        }
        Ok(self)
    }

    fn labelled(mut self, text: String, binding: Binding) -> Result<Self, FormulaError> {
        self.text = shortened(text);
        self.binding = binding;
        self.finite()
    }

    pub(super) fn sum(mut self, other: &Self, op: Binary) -> Result<Self, FormulaError> {
        let sign = if op == Binary::Add { "+" } else { "-" };
        if self.unit != other.unit {
            return Err(FormulaError(format!(
                "{} is {} and {} is {}: they cannot be added",
                self.text, self.unit, other.text, other.unit
            )));
        }
        let right = other.inside(if op == Binary::Add { Binding::Sum } else { Binding::Product });
        let text = format!("{} {sign} {right}", self.text);
        self.join(op, other);
        self.labelled(text, Binding::Sum)
    }

    /// `other` is the factor that has no coefficient; `is_first` says on which side it
    /// was written.
    pub(super) fn product(mut self, other: &Self, is_first: bool) -> Result<Self, FormulaError> {
        if other.is(1.0) {
            return Ok(self);
        }
        if self.is(1.0) {
            return Ok(other.clone());
        }
        if other.is(-1.0) && is_first {
            return Ok(self.negated());
        }
        if self.is(-1.0) && !is_first {
            return Ok(other.clone().negated());
        }
        let (left, right) = if is_first { (other, &self) } else { (&self, other) };
        let text = format!("{}*{}", left.inside(Binding::Product), right.inside(Binding::Power));
        self.unit = self.unit.times(other.unit);
        self.join(Binary::Multiply, other);
        self.labelled(text, Binding::Product)
    }

    pub(super) fn quotient(mut self, other: &Self) -> Result<Self, FormulaError> {
        if other.is(1.0) {
            return Ok(self);
        }
        if other.is(-1.0) {
            return Ok(self.negated());
        }
        let text = format!("{}/{}", self.inside(Binding::Product), other.inside(Binding::Power));
        if other.is_zero() {
            return Err(FormulaError::not_finite(&shortened(text)));
        }
        self.unit = self.unit.over(other.unit);
        self.join(Binary::Divide, other);
        self.labelled(text, Binding::Product)
    }

    pub(super) fn negated(mut self) -> Self {
        self.text = shortened(format!("-{}", self.inside(Binding::Product)));
        self.binding = Binding::Product;
        match self.number() {
            Some(x) => self.program = vec![Op::Number(-x)],
            None => self.program.push(Op::Negate),
        }
        self
    }

    pub(super) fn power(mut self, exponent: &Self) -> Result<Self, FormulaError> {
        let wrong = |reason: String| FormulaError(format!("the exponent {} of {} {reason}", exponent.text, self.text));
        if exponent.unit != Unit::ONE {
            return Err(wrong(format!("is {}, but must be a pure number", exponent.unit)));
        }
        if self.unit != Unit::ONE {
            let Some(n) = exponent.number() else {
                return Err(wrong(format!("varies, but the base is {}; its unit would vary too", self.unit)));
            };
            self.unit = self
                .unit
                .power(n)
                .ok_or_else(|| wrong(format!("gives {} a power that cannot be recorded", self.unit)))?;
        }
        let text = format!("{}^{}", self.inside(Binding::Atom), exponent.inside(Binding::Atom));
        let whole = exponent.number().filter(|n| n.fract() == 0.0 && n.abs() <= 64.0);
        match (whole, self.number()) {
            (Some(n), None) => self.program.push(Op::WholePower(n as i32)),
            _ => self.join(Binary::Power, exponent),
        }
        self.labelled(text, Binding::Power)
    }

    pub(super) fn function(mut self, function: Function) -> Result<Self, FormulaError> {
        self.unit = match function {
            Function::Abs => self.unit,
            Function::Sign => Unit::ONE,
            Function::Sqrt => self.unit.power(0.5).ok_or_else(|| {
                FormulaError(format!(
                    "the exponent 1/2 of {} gives {} a power that cannot be recorded",
                    self.text, self.unit
                ))
            })?,
            _ if self.unit == Unit::ONE => Unit::ONE,
            _ => {
                let (name, Self { text, unit, .. }) = (function.name(), &self);
                return Err(FormulaError(format!("{name}({text}) needs a pure number, but {text} is {unit}")));
            }
        };
        match self.number() {
            Some(x) => self.program = vec![Op::Number(function.of(x))],
            None => self.program.push(Op::Function(function)),
        }
        let text = format!("{}({})", function.name(), self.text);
        self.labelled(text, Binding::Atom)
    }
}

/// A long text without its middle: messages are read by people.
pub(super) fn shortened(text: String) -> String {
    const LONGEST: usize = 120;
    let length = text.chars().count();
    if length <= LONGEST {
        return text;
    }
    let head: String = text.chars().take(LONGEST / 2).collect();
    let tail: String = text.chars().skip(length - LONGEST / 2 + 1).collect();
    format!("{head}…{tail}")
}
