//! The grammar of a unit: products, whole exponents, one division.

use super::foreign::advice;
use super::symbols::{TEMPERATURES, WITH_DIGITS, look_up};
use super::{Dimension, UnitError, shorten};

/// A factor kept as a quotient, so that km/h is 1000/3600 and no rounding is added.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    pub(super) above: f64,
    pub(super) below: f64,
    pub(super) dimension: Dimension,
}

pub(super) struct Parser<'a> {
    pub(super) text: &'a str,
    pub(super) rest: &'a str,
    pub(super) depth: usize,
    /// Whether the last symbol carries a negative exponent.
    pub(super) is_inverse: bool,
}

impl Parser<'_> {
    pub(super) fn syntax(&self, problem: String) -> UnitError {
        UnitError::syntax(self.text, &problem)
    }

    /// A product after a division.
    fn ambiguous(&self) -> UnitError {
        let problem = "can be read in two ways; put the divisor in parentheses, as in `kg/(m s)`";
        UnitError::Other(format!("`{}` {problem}", self.text))
    }

    fn skip_spaces(&mut self) {
        self.rest = self.rest.trim_start();
    }

    /// A sign of a product that touches both of its factors: `N-m`, `m.s-1`, `kgf.cm`.
    fn touches(&self, sign: char) -> bool {
        let is_between =
            self.rest.strip_prefix(sign).is_some_and(|rest| rest.starts_with(|c: char| is_letter(c) || c == '('));
        is_between && !self.text[..self.text.len() - self.rest.len()].ends_with(char::is_whitespace)
    }

    /// quotient = power { (" " | "*" | "·" | "." | "-") power } { "/" power }
    pub(super) fn quotient(&mut self) -> Result<Scale, UnitError> {
        let mut total = self.power()?;
        let mut was_divided = false;
        loop {
            self.skip_spaces();
            let Some(c) = self.rest.chars().next() else { return Ok(total) };
            let divide = match c {
                ')' => return Ok(total),
                '/' => true,
                '*' | '·' | '⋅' | '×' | '∙' | '•' => false,
                '.' | '-' if self.touches(c) => false,
                '.' | '-' => return Err(self.syntax(format!("unexpected `{c}`"))),
                _ => {
                    // A space stood here. Parentheses without a mark before them hold a remark: `bar (g)`, `l(h)`.
                    if c == '(' {
                        let problem = "parentheses follow on a unit; write `*` before them where they multiply";
                        return Err(self.syntax(problem.to_owned()));
                    }
                    if was_divided {
                        return Err(self.ambiguous());
                    }
                    let factor = self.power()?;
                    total = self.combine(total, factor, false)?;
                    continue;
                }
            };
            if was_divided && !divide {
                return Err(self.ambiguous());
            }
            self.rest = &self.rest[c.len_utf8()..];
            let factor = self.power()?;
            if divide && self.is_inverse {
                let problem =
                    "can be read in two ways; divide, as in `m/s`, or write a negative exponent, as in `m s^-1`";
                return Err(UnitError::Other(format!("`{}` {problem}", self.text)));
            }
            total = self.combine(total, factor, divide)?;
            was_divided |= divide;
        }
    }

    fn combine(&self, a: Scale, b: Scale, divide: bool) -> Result<Scale, UnitError> {
        let dimension =
            if divide { a.dimension.checked_div(b.dimension) } else { a.dimension.checked_mul(b.dimension) };
        let dimension = dimension.ok_or_else(|| UnitError::range(self.text))?;
        let (above, below) = if divide { (b.below, b.above) } else { (b.above, b.below) };
        Ok(Scale { above: a.above * above, below: a.below * below, dimension })
    }

    /// power = ("(" quotient ")" | symbol) [ exponent ]
    fn power(&mut self) -> Result<Scale, UnitError> {
        self.skip_spaces();
        let is_product = self.rest.starts_with('(');
        let base = if let Some(inner) = self.rest.strip_prefix('(') {
            self.depth += 1;
            if self.depth > 8 {
                return Err(self.syntax("too many parentheses".to_owned()));
            }
            self.rest = inner;
            let scale = self.quotient()?;
            self.rest =
                self.rest.strip_prefix(')').ok_or_else(|| self.syntax("a parenthesis is not closed".to_owned()))?;
            self.depth -= 1;
            scale
        } else {
            self.symbol()?
        };
        let exponent = self.exponent()?;
        self.is_inverse = exponent < 0 && !is_product;
        let dimension = base.dimension.checked_powi(exponent).ok_or_else(|| UnitError::range(self.text))?;
        let power = i32::from(exponent.unsigned_abs());
        let (above, below) = (base.above.powi(power), base.below.powi(power));
        Ok(if exponent < 0 {
            Scale { above: below, below: above, dimension }
        } else {
            Scale { above, below, dimension }
        })
    }

    fn symbol(&mut self) -> Result<Scale, UnitError> {
        let with_digits = WITH_DIGITS.iter().find(|name| {
            let rest = self.rest.strip_prefix(**name);
            rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_digit() || is_letter(c)))
        });
        let letters = self.rest.char_indices().find(|(_, c)| !is_letter(*c)).map_or(self.rest.len(), |(i, _)| i);
        let (symbol, rest) = self.rest.split_at(with_digits.map_or(letters, |name| name.len()));
        if symbol.is_empty() {
            // The only number that is a unit is 1, and no digit may follow it.
            if let Some(rest) = self.rest.strip_prefix('1')
                && !rest.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '−') || is_letter(c))
            {
                self.rest = rest;
                return Ok(Scale { above: 1.0, below: 1.0, dimension: Dimension::ONE });
            }
            return Err(match self.rest.chars().next() {
                None => self.syntax("it ends where a unit should follow".to_owned()),
                Some(c) => self.syntax(format!("unexpected `{c}`")),
            });
        }
        self.rest = rest;
        if TEMPERATURES.iter().any(|(spellings, ..)| spellings.contains(&symbol)) {
            let problem = "has an offset and can only stand alone; write K for differences";
            return Err(UnitError::Other(format!("`{}`: {symbol} {problem}", self.text)));
        }
        let (above, below, dimension) = look_up(symbol)
            .ok_or_else(|| UnitError::Unknown { symbol: symbol.to_owned(), advice: advice(symbol, None) })?;
        Ok(Scale { above, below, dimension })
    }

    /// `^-2`, `^(-2)`, `2`, `⁻²`, or nothing.
    fn exponent(&mut self) -> Result<i8, UnitError> {
        let bad = |found: &str| self.syntax(format!("`{}` is not a whole exponent", shorten(found)));
        let plain: String = self.rest.chars().map_while(superscript).collect();
        if !plain.is_empty() {
            let length: usize = self.rest.chars().take(plain.chars().count()).map(char::len_utf8).sum();
            let value = plain.parse().map_err(|_| bad(&self.rest[..length]))?;
            self.rest = &self.rest[length..];
            return Ok(value);
        }
        let trimmed = self.rest.trim_start();
        let (after, is_marked) = match trimmed.strip_prefix('^').or_else(|| trimmed.strip_prefix("**")) {
            Some(after) => (after.trim_start(), true),
            None => (self.rest, false),
        };
        let (body, is_closed) = match after.strip_prefix('(') {
            Some(inner) if is_marked => (inner.trim_start(), true),
            _ => (after, false),
        };
        // The minus of `s-1` and `s−1`; a plus is marked.
        let minus = ['-', '−'].into_iter().find(|sign| body.starts_with(*sign)).map_or(0, char::len_utf8);
        let sign = minus.max(usize::from(is_marked && body.starts_with('+')));
        let digits = body[sign..].bytes().take_while(u8::is_ascii_digit).count();
        if digits == 0 {
            return if is_marked { Err(bad(after)) } else { Ok(1) };
        }
        let end = sign + digits;
        let size = &body[sign..end];
        // A name that ends in a zero is no power: `g0`, `x0`.
        if !is_marked && size.starts_with('0') {
            return Err(bad(&body[..end]));
        }
        let size: i8 = size.parse().map_err(|_| bad(&body[..end]))?;
        let value = if minus > 0 { -size } else { size };
        let mut rest = &body[end..];
        if rest.strip_prefix('.').is_some_and(|rest| !rest.starts_with(is_letter)) {
            return Err(bad(body));
        }
        if is_closed {
            rest = rest.trim_start().strip_prefix(')').ok_or_else(|| bad(after))?;
        }
        self.rest = rest;
        Ok(value)
    }
}

/// What the name of a unit is made of.
fn is_letter(c: char) -> bool {
    c.is_alphabetic() || matches!(c, '°' | '%' | '‰' | '_' | '\'' | '"')
}

/// The raised digits, from 0 on.
pub(crate) const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

fn superscript(c: char) -> Option<char> {
    if c == '⁻' {
        return Some('-');
    }
    let digit = SUPERSCRIPTS.iter().position(|s| *s == c)?;
    char::from_digit(u32::try_from(digit).ok()?, 10)
}
