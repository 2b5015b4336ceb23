//! Bytes of a file with a place in them, as text or as binary numbers.

use std::fmt::Display;

use crate::files::soup::{Place, ReadError};

/// What to do about a line that is wrong.
pub(super) const CORRECT: &str = "correct the line, or export the file again";
/// What to do about bytes that are wrong.
pub(super) const EXPORT: &str = "export the file again";

/// Longest piece of a file in an error, bytes.
const SHOWN: usize = 32;

/// A word of the text and where it begins.
#[derive(Clone, Copy)]
pub(super) struct Word<'a> {
    pub at: usize,
    pub text: &'a [u8],
}

impl Word<'_> {
    /// Case does not matter.
    pub fn is(&self, other: &str) -> bool {
        self.text.eq_ignore_ascii_case(other.as_bytes())
    }

    /// A number as C and Fortran write it (`1.5`, `1e3`, `1.5D+3`, `nan`).
    pub fn number(&self) -> Option<f64> {
        let text = std::str::from_utf8(self.text).ok()?;
        text.parse().ok().or_else(|| {
            let has_d = text.contains(['d', 'D']) && text.len() <= SHOWN;
            has_d.then(|| text.replace(['d', 'D'], "e").parse().ok()).flatten()
        })
    }

    pub fn whole(&self) -> Option<i64> {
        std::str::from_utf8(self.text).ok()?.parse().ok()
    }

    /// For an error: in quotes, cut when long.
    pub fn shown(&self) -> String {
        let cut = if self.text.len() > SHOWN { "…" } else { "" };
        let text = String::from_utf8_lossy(&self.text[..self.text.len().min(SHOWN)]);
        format!("{:?}", format!("{text}{cut}"))
    }
}

/// A place in the bytes of a file.
#[derive(Clone)]
pub(super) struct Cursor<'a> {
    name: &'a str,
    bytes: &'a [u8],
    at: usize,
    /// A comma is a space, as in Fortran.
    pub has_commas: bool,
    /// Binary numbers have their high byte first.
    pub is_big_endian: bool,
}

impl<'a> Cursor<'a> {
    pub const fn new(name: &'a str, bytes: &'a [u8]) -> Self {
        Self { name, bytes, at: 0, has_commas: false, is_big_endian: false }
    }

    pub const fn name(&self) -> &'a str {
        self.name
    }

    pub const fn at(&self) -> usize {
        self.at
    }

    pub fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    pub fn go_to(&mut self, at: usize) {
        self.at = at.min(self.bytes.len());
    }

    const fn is_space(&self, byte: u8) -> bool {
        byte.is_ascii_whitespace() || byte == 0x0b || (self.has_commas && byte == b',')
    }

    /// The next word, over the ends of lines.
    pub fn word(&mut self) -> Option<Word<'a>> {
        let spaces = self.rest().iter().take_while(|b| self.is_space(**b)).count();
        self.at += spaces;
        self.here()
    }

    /// The next word of this line.
    pub fn word_of_line(&mut self) -> Option<Word<'a>> {
        let spaces = self.rest().iter().take_while(|b| **b != b'\n' && self.is_space(**b)).count();
        self.at += spaces;
        self.here()
    }

    fn here(&mut self) -> Option<Word<'a>> {
        let rest = self.rest();
        let length = rest.iter().take_while(|b| !self.is_space(**b)).count();
        let word = Word { at: self.at, text: &rest[..length] };
        self.at += length;
        (length > 0).then_some(word)
    }

    /// What is left of this line, without its end; none at the end of the file.
    pub fn line(&mut self) -> Option<Word<'a>> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        let line = Word { at: self.at, text: rest[..length].trim_ascii_end() };
        self.at += (length + 1).min(rest.len());
        Some(line)
    }

    /// The next word must be a number.
    pub fn number(&mut self, expected: &str) -> Result<f64, ReadError> {
        let word = self.word();
        self.as_number(word, expected)
    }

    /// The next word of this line must be a number.
    pub fn number_of_line(&mut self, expected: &str) -> Result<f64, ReadError> {
        let word = self.word_of_line();
        if word.is_none() && !self.rest().is_empty() {
            return Err(self.unexpected(self.at, "the end of the line", &format!("a number, {expected},")));
        }
        self.as_number(word, expected)
    }

    fn as_number(&self, word: Option<Word<'a>>, expected: &str) -> Result<f64, ReadError> {
        let expected = || format!("a number, {expected},");
        let word = word.ok_or_else(|| self.ends(&expected()))?;
        word.number().ok_or_else(|| self.unexpected(word.at, &word.shown(), &expected()))
    }

    /// The next word must be a whole number of a range.
    pub fn whole(&mut self, low: i64, high: i64, expected: &str) -> Result<i64, ReadError> {
        let word = self.word().ok_or_else(|| self.ends(expected))?;
        self.as_whole(word, low, high, expected)
    }

    /// A word that must be a whole number of a range.
    pub fn as_whole(&self, word: Word<'a>, low: i64, high: i64, expected: &str) -> Result<i64, ReadError> {
        let value = word.whole().filter(|n| (low..=high).contains(n));
        value.ok_or_else(|| self.unexpected(word.at, &word.shown(), expected))
    }

    /// The next bytes.
    pub fn take<const N: usize>(&mut self, expected: &str) -> Result<[u8; N], ReadError> {
        let Some(bytes) = self.rest().first_chunk() else {
            return Err(self.cut(expected));
        };
        self.at += N;
        Ok(*bytes)
    }

    /// Skips bytes.
    pub fn skip(&mut self, count: u64, expected: &str) -> Result<(), ReadError> {
        if count > self.rest().len() as u64 {
            return Err(self.cut(expected));
        }
        self.at += count as usize;
        Ok(())
    }

    /// Bytes of a number, low byte first.
    pub fn little<const N: usize>(&mut self, expected: &str) -> Result<[u8; N], ReadError> {
        let mut bytes = self.take::<N>(expected)?;
        if self.is_big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub fn u32(&mut self, expected: &str) -> Result<u32, ReadError> {
        self.little(expected).map(u32::from_le_bytes)
    }

    pub fn i32(&mut self, expected: &str) -> Result<i32, ReadError> {
        self.little(expected).map(i32::from_le_bytes)
    }

    pub fn u64(&mut self, expected: &str) -> Result<u64, ReadError> {
        self.little(expected).map(u64::from_le_bytes)
    }

    pub fn f32(&mut self, expected: &str) -> Result<f64, ReadError> {
        self.little(expected).map(|b| f64::from(f32::from_le_bytes(b)))
    }

    pub fn f64(&mut self, expected: &str) -> Result<f64, ReadError> {
        self.little(expected).map(f64::from_le_bytes)
    }

    /// Line and column of a byte.
    pub fn place(&self, at: usize) -> Place {
        let before = &self.bytes[..at.min(self.bytes.len())];
        let line = before.split(|b| *b == b'\n').count();
        let column = 1 + before.iter().rev().take_while(|b| **b != b'\n').count();
        Place::Line { line, column }
    }

    /// In text: something else than expected.
    pub fn unexpected(&self, at: usize, found: &str, expected: &str) -> ReadError {
        self.wrong(self.place(at), found, expected, CORRECT)
    }

    /// In binary data: something else than expected.
    pub fn unexpected_byte(&self, at: usize, found: &str, expected: &str) -> ReadError {
        self.wrong(Place::Byte(at), found, expected, EXPORT)
    }

    fn wrong(&self, place: Place, found: &str, expected: &str, advice: &str) -> ReadError {
        ReadError(format!("{}, {place}: {found} where {expected} should be; {advice}", self.name))
    }

    /// Text ends.
    pub fn ends(&self, expected: &str) -> ReadError {
        self.ends_at(self.place(self.bytes.len()), expected)
    }

    /// Binary data end.
    pub fn cut(&self, expected: &str) -> ReadError {
        self.ends_at(Place::Byte(self.bytes.len()), expected)
    }

    fn ends_at(&self, place: Place, expected: &str) -> ReadError {
        ReadError(format!("{}, {place}: the file ends where {expected} should be; copy or export it again", self.name))
    }

    /// Sound, and not read here.
    pub fn not_read(&self, place: Place, what: impl Display, advice: &str) -> ReadError {
        ReadError(format!("{}, {place}: {what} is not read; {advice}", self.name))
    }
}
