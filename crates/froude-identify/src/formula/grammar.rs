//! The grammar: tokens to an expression, by recursive descent.
//!
//! ```text
//! sum      = product { ("+" | "-") product }
//! product  = signed { ("*" | "/") signed }
//! signed   = [ "+" | "-" ] power
//! power    = operand [ "^" exponent ]
//! exponent = operand | [ "+" | "-" ] number
//! operand  = number | name | function "(" sum ")" | "(" sum ")"
//! ```
//!
//! Only parentheses nest, and at most [`DEPTH_LIMIT`] of them; operators of one rank are a list.
//! So neither reading nor computing an expression goes deep, however long the text is.

use super::error::FormulaError;
use super::program::{Binary, Function};
use super::token::{Kind, Token};
use crate::formula::limits::DEPTH_LIMIT;

const OPERAND: &str = "a name, a number or \"(\"";
const OPERATOR: &str = "an operator or the end";

/// A formula as it was read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Expression {
    Number {
        value: f64,
        /// As written, with the sign that an exponent may have.
        text: String,
    },
    /// The place among the names of the formula.
    Name(usize),
    Call(Function, Box<Expression>),
    /// Operators of one rank, applied from left to right.
    ///
    /// A minus before a factor is a factor of its own: `a/-b*c` is `a/(-1)/b*c`.
    Chain(Box<Expression>, Vec<(Binary, Expression)>),
}

impl Expression {
    fn minus_one() -> Self {
        Self::Number { value: -1.0, text: "-1".to_owned() }
    }

    fn chain(first: Self, rest: Vec<(Binary, Self)>) -> Self {
        if rest.is_empty() { first } else { Self::Chain(Box::new(first), rest) }
    }
}

/// The expression of a text, and its names in order of first appearance.
///
/// # Errors
///
/// The first token that cannot stand where it does, with what could.
pub(super) fn expression<'a>(tokens: &[Token<'a>]) -> Result<(Expression, Vec<&'a str>), FormulaError> {
    let mut reader = Reader { tokens, at: 0, open: 0, names: Vec::new() };
    let sum = reader.sum()?;
    match reader.token() {
        Token { kind: Kind::End, .. } => Ok((sum, reader.names)),
        token @ Token { kind: Kind::Close, .. } => {
            Err(FormulaError(format!("unmatched \")\" at character {}", token.position)))
        }
        token => Err(token.instead_of(OPERATOR)),
    }
}

fn of_sum(kind: Kind) -> Option<Binary> {
    match kind {
        Kind::Plus => Some(Binary::Add),
        Kind::Minus => Some(Binary::Subtract),
        _ => None,
    }
}

fn of_product(kind: Kind) -> Option<Binary> {
    match kind {
        Kind::Times => Some(Binary::Multiply),
        Kind::Over => Some(Binary::Divide),
        _ => None,
    }
}

/// Where the reading is.
struct Reader<'t, 'a> {
    /// At least one; the last is the end.
    tokens: &'t [Token<'a>],
    at: usize,
    /// Parentheses that are open.
    open: usize,
    names: Vec<&'a str>,
}

impl<'a> Reader<'_, 'a> {
    /// The token that is next.
    fn token(&self) -> Token<'a> {
        self.ahead(0)
    }

    fn ahead(&self, by: usize) -> Token<'a> {
        self.tokens[(self.at + by).min(self.tokens.len() - 1)]
    }

    /// Takes an operator if `find` knows the next token as one.
    fn operator(&mut self, find: fn(Kind) -> Option<Binary>) -> Option<Binary> {
        let found = find(self.token().kind);
        self.at += usize::from(found.is_some());
        found
    }

    /// Takes a sign if one is next; whether it is a minus.
    fn minus(&mut self) -> bool {
        let kind = self.token().kind;
        self.at += usize::from(matches!(kind, Kind::Plus | Kind::Minus));
        kind == Kind::Minus
    }

    fn sum(&mut self) -> Result<Expression, FormulaError> {
        let first = self.product()?;
        let mut rest = Vec::new();
        while let Some(op) = self.operator(of_sum) {
            rest.push((op, self.product()?));
        }
        Ok(Expression::chain(first, rest))
    }

    fn product(&mut self) -> Result<Expression, FormulaError> {
        let mut rest = Vec::new();
        let first = if self.minus() {
            rest.push((Binary::Multiply, self.power()?));
            Expression::minus_one()
        } else {
            self.power()?
        };
        while let Some(op) = self.operator(of_product) {
            if self.minus() {
                rest.push((op, Expression::minus_one()));
            }
            rest.push((op, self.power()?));
        }
        Ok(Expression::chain(first, rest))
    }

    fn power(&mut self) -> Result<Expression, FormulaError> {
        let base = self.operand()?;
        if self.token().kind != Kind::Power {
            return Ok(base);
        }
        self.at += 1;
        let exponent = self.exponent()?;
        match self.token() {
            Token { kind: Kind::Power, position, .. } => Err(FormulaError(format!(
                "at character {position} a power is raised to a power; write (a^b)^c or a^(b^c) to say which is meant"
            ))),
            _ => Ok(Expression::chain(base, vec![(Binary::Power, exponent)])),
        }
    }

    fn exponent(&mut self) -> Result<Expression, FormulaError> {
        let sign = self.token();
        let is_minus = match (sign.kind, self.ahead(1).kind) {
            (Kind::Plus | Kind::Minus, Kind::Number(_)) => self.minus(),
            (Kind::Plus | Kind::Minus, _) => return Err(sign.instead_of("a number or \"(\" as the exponent")),
            _ => false,
        };
        Ok(match self.operand()? {
            Expression::Number { value, text } if is_minus => {
                Expression::Number { value: -value, text: format!("-{text}") }
            }
            exponent => exponent,
        })
    }

    fn operand(&mut self) -> Result<Expression, FormulaError> {
        let token = self.token();
        match token.kind {
            Kind::Number(value) => {
                self.at += 1;
                Ok(Expression::Number { value, text: token.text.to_owned() })
            }
            Kind::Name => self.name(token),
            Kind::Open => self.bracket(),
            _ => Err(token.instead_of(OPERAND)),
        }
    }

    /// A name, or a function with its argument.
    fn name(&mut self, token: Token<'a>) -> Result<Expression, FormulaError> {
        self.at += 1;
        let next = self.token();
        match (Function::named(token.text), next.kind) {
            (Some(function), Kind::Open) => Ok(Expression::Call(function, Box::new(self.bracket()?))),
            (Some(_), _) => Err(next.instead_of("\"(\" after a function's name")),
            (None, Kind::Open) => {
                let Token { text, position, .. } = token;
                Err(FormulaError(format!(
                    "{text} at character {position} is not a function; known are abs, sqrt, sin, cos, tan, exp, ln, sign and CF_ITTC57; a product is \
                     written {text}*(…)"
                )))
            }
            (None, _) => Ok(Expression::Name(self.place_of(token.text))),
        }
    }

    fn place_of(&mut self, name: &'a str) -> usize {
        self.names.iter().position(|known| *known == name).unwrap_or_else(|| {
            self.names.push(name);
            self.names.len() - 1
        })
    }

    /// What stands in parentheses, of which the first is next.
    fn bracket(&mut self) -> Result<Expression, FormulaError> {
        self.open += 1;
        if self.open > DEPTH_LIMIT {
            let position = self.token().position;
            let problem = format!("at character {position} more than {DEPTH_LIMIT} parentheses are open at once");
            return Err(FormulaError(problem));
        }
        self.at += 1;
        let inside = self.sum()?;
        let token = self.token();
        match token.kind {
            Kind::Close => {
                self.open -= 1;
                self.at += 1;
                Ok(inside)
            }
            Kind::End => Err(token.instead_of("\")\"")),
            _ => Err(token.instead_of(OPERATOR)),
        }
    }
}
