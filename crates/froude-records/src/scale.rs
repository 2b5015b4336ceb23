//! The factor of a dimensionless column: `0.5*rho*L^2*speed^2`, with units checked.

use crate::units::Dimension;

/// Most characters and most parentheses open at once.
const LONGEST: usize = 500;
const DEEPEST: usize = 32;

/// A product of powers of numbers, constants and columns, sums included.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    text: String,
    root: Node,
}

/// A number with its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// In SI.
    pub si: f64,
    /// What it measures.
    pub dimension: Dimension,
}

#[derive(Debug, Clone, PartialEq)]
enum Node {
    Number(f64),
    Name(String),
    Negative(Box<Node>),
    /// Two joined by `+`, `-`, `*` or `/`.
    Joined(char, Box<Node>, Box<Node>),
    Power(Box<Node>, i8),
}

impl Scale {
    /// Reads `+ - * / ^`, parentheses, numbers and names; exponents are whole numbers.
    ///
    /// # Errors
    ///
    /// What stands where something else was expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        if text.len() > LONGEST {
            return Err(format!("it has {} characters; at most {LONGEST} are read", text.len()));
        }
        let mut parser = Parser { rest: text, depth: 0 };
        let root = parser.sum()?;
        parser.blank();
        if parser.rest.is_empty() {
            Ok(Self { text: text.to_owned(), root })
        } else {
            Err(format!("expected an operator, found {:?}", parser.rest.chars().take(20).collect::<String>()))
        }
    }

    /// As written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its value over named values.
    ///
    /// # Errors
    ///
    /// An unknown name, a sum of unlike units, an exponent out of range.
    pub fn evaluate(&self, names: &dyn Fn(&str) -> Option<Value>) -> Result<Value, String> {
        evaluate(&self.root, names)
    }
}

fn evaluate(node: &Node, names: &dyn Fn(&str) -> Option<Value>) -> Result<Value, String> {
    let out_of_range = || "an exponent is out of range".to_owned();
    Ok(match node {
        Node::Number(si) => Value { si: *si, dimension: Dimension::ONE },
        Node::Name(name) => names(name).ok_or_else(|| {
            format!("{name} is neither one of [constants] nor a column of numbers mapped above this one")
        })?,
        Node::Negative(a) => {
            let a = evaluate(a, names)?;
            Value { si: -a.si, ..a }
        }
        Node::Joined(operator, a, b) => {
            let (x, y) = (evaluate(a, names)?, evaluate(b, names)?);
            let (si, dimension) = match operator {
                '*' => (x.si * y.si, x.dimension.checked_mul(y.dimension)),
                '/' => (x.si / y.si, x.dimension.checked_div(y.dimension)),
                _ if x.dimension != y.dimension => {
                    return Err(format!("a sum of {} and {}", x.dimension, y.dimension));
                }
                '-' => (x.si - y.si, Some(x.dimension)),
                _ => (x.si + y.si, Some(x.dimension)),
            };
            Value { si, dimension: dimension.ok_or_else(out_of_range)? }
        }
        Node::Power(a, n) => {
            let x = evaluate(a, names)?;
            Value { si: x.si.powi(i32::from(*n)), dimension: x.dimension.checked_powi(*n).ok_or_else(out_of_range)? }
        }
    })
}

struct Parser<'a> {
    rest: &'a str,
    depth: usize,
}

impl Parser<'_> {
    fn blank(&mut self) {
        self.rest = self.rest.trim_start();
    }

    fn eat(&mut self, c: char) -> bool {
        self.blank();
        if let Some(rest) = self.rest.strip_prefix(c) {
            self.rest = rest;
            true
        } else {
            false
        }
    }

    fn sum(&mut self) -> Result<Node, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(format!("more than {DEEPEST} parentheses are open"));
        }
        let sum = self.joined(['+', '-'], Self::product)?;
        self.depth -= 1;
        Ok(sum)
    }

    fn product(&mut self) -> Result<Node, String> {
        self.joined(['*', '/'], Self::signed)
    }

    /// Parts joined by one of two operators, from left to right.
    fn joined(&mut self, operators: [char; 2], part: fn(&mut Self) -> Result<Node, String>) -> Result<Node, String> {
        let mut left = part(self)?;
        while let Some(operator) = operators.into_iter().find(|operator| self.eat(*operator)) {
            left = Node::Joined(operator, Box::new(left), Box::new(part(self)?));
        }
        Ok(left)
    }

    /// A sign binds weaker than a power: `-a^2` is `-(a^2)`.
    fn signed(&mut self) -> Result<Node, String> {
        let negative = self.eat('-');
        let node = self.power()?;
        Ok(if negative { Node::Negative(Box::new(node)) } else { node })
    }

    fn power(&mut self) -> Result<Node, String> {
        let base = self.atom()?;
        if !self.eat('^') {
            return Ok(base);
        }
        self.blank();
        let end = self.rest.find(|c: char| !c.is_ascii_digit() && c != '-').unwrap_or(self.rest.len());
        let (digits, rest) = self.rest.split_at(end);
        let exponent = digits.parse::<i8>().map_err(|_| "an exponent must be a whole number".to_owned())?;
        self.rest = rest;
        Ok(Node::Power(Box::new(base), exponent))
    }

    fn atom(&mut self) -> Result<Node, String> {
        if self.eat('(') {
            let inner = self.sum()?;
            return if self.eat(')') { Ok(inner) } else { Err("a parenthesis is not closed".to_owned()) };
        }
        self.blank();
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let Some(first) = self.rest.chars().next() else {
            return Err("it ends where a number or a name is expected".to_owned());
        };
        if first.is_ascii_digit() || first == '.' {
            let bytes = self.rest.as_bytes();
            let mut end = 0;
            while end < bytes.len() {
                let c = bytes[end];
                let exponent_sign = matches!(c, b'+' | b'-') && end > 0 && matches!(bytes[end - 1], b'e' | b'E');
                if c.is_ascii_digit() || matches!(c, b'.' | b'e' | b'E') || exponent_sign {
                    end += 1;
                } else {
                    break;
                }
            }
            let (digits, rest) = self.rest.split_at(end);
            let value: f64 = digits.parse().map_err(|_| format!("{digits:?} is not a number"))?;
            if !value.is_finite() {
                return Err(format!("{digits} is not a finite number"));
            }
            self.rest = rest;
            return Ok(Node::Number(value));
        }
        if first.is_alphabetic() || first == '_' {
            let end = self.rest.find(|c| !is_name(c)).unwrap_or(self.rest.len());
            let (name, rest) = self.rest.split_at(end);
            self.rest = rest;
            return Ok(Node::Name(name.to_owned()));
        }
        Err(format!("expected a number or a name, found {first:?}"))
    }
}
