//! Tokens: names, numbers, operators and parentheses, each with its place in the text.

use std::str::FromStr;

use super::error::FormulaError;
use crate::formula::limits::LENGTH_LIMIT;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Name,
    /// Its value, which is finite.
    Number(f64),
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Open,
    Close,
    End,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Token<'a> {
    pub kind: Kind,
    /// As written; empty at the end.
    pub text: &'a str,
    /// In characters, counted from 1.
    pub position: usize,
}

impl Token<'_> {
    /// That something else is expected where this token stands.
    pub(super) fn instead_of(&self, expected: &str) -> FormulaError {
        let found = if self.kind == Kind::End { "end".to_owned() } else { format!("{:?}", self.text) };
        FormulaError(format!("unexpected {found} at character {}; expected {expected}", self.position))
    }
}

/// The tokens of a text; the last one is its end.
///
/// # Errors
///
/// A text that is empty or too long, a character that no formula has, a number that is not finite.
pub(super) fn tokens(text: &str) -> Result<Vec<Token<'_>>, FormulaError> {
    if text.trim().is_empty() {
        let problem = "the formula is empty; write for example \"Y_v*v + Y_vav*v*abs(v)\"";
        return Err(FormulaError(problem.to_owned()));
    }
    let length = text.chars().count();
    if length > LENGTH_LIMIT {
        let problem = format!("the formula has {length} characters; at most {LENGTH_LIMIT} are read");
        return Err(FormulaError(problem));
    }
    // Every character that passes is one byte: byte place = character place.
    let mut out = Vec::new();
    let mut at = 0;
    let mut end = 1;
    while let Some(&first) = text.as_bytes().get(at) {
        if matches!(first, b' ' | b'\t' | b'\n' | b'\r') {
            at += 1;
            continue;
        }
        let token = token(text, at)?;
        at += token.text.len();
        end = at + 1;
        out.push(token);
    }
    out.push(Token { kind: Kind::End, text: "", position: end });
    Ok(out)
}

/// The token that begins at byte `at`, where a character does.
fn token(text: &str, at: usize) -> Result<Token<'_>, FormulaError> {
    let position = at + 1;
    let rest = &text[at..];
    let character = rest.chars().next().unwrap_or(char::REPLACEMENT_CHARACTER);
    let length = match character {
        'a'..='z' | 'A'..='Z' | '_' => name_length(rest.as_bytes()),
        '0'..='9' | '.' => number_length(rest.as_bytes()),
        _ => 1,
    };
    let kind = match character {
        'a'..='z' | 'A'..='Z' | '_' => Kind::Name,
        '0'..='9' | '.' => {
            let text = &rest[..length];
            let value = f64::from_str(text).ok().filter(|value| value.is_finite());
            let problem = || format!("{text:?} at character {position} is not a finite number");
            Kind::Number(value.ok_or_else(|| FormulaError(problem()))?)
        }
        '+' => Kind::Plus,
        '-' => Kind::Minus,
        '*' => Kind::Times,
        '/' => Kind::Over,
        '^' => Kind::Power,
        '(' => Kind::Open,
        ')' => Kind::Close,
        _ => {
            return Err(FormulaError(format!(
                "character {position} is {character:?}; a formula is made of names, numbers, + - * / ^ and parentheses"
            )));
        }
    };
    Ok(Token { kind, text: &rest[..length], position })
}

/// Length of `v_x`, `C_2` at the start of the bytes.
fn name_length(bytes: &[u8]) -> usize {
    bytes.iter().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count()
}

/// Length of `12`, `1.5`, `.5`, `2e-3` at the start of the bytes; at least 1.
fn number_length(bytes: &[u8]) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut n = digits(0);
    if bytes.get(n) == Some(&b'.') {
        n += 1;
        n += digits(n);
    }
    if matches!(bytes.get(n), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(n + 1), Some(b'+' | b'-')));
        let exponent = bytes.get(n + 1 + sign).map_or(0, |_| digits(n + 1 + sign));
        if exponent > 0 {
            n += 1 + sign + exponent;
        }
    }
    n
}
