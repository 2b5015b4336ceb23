//! NetCDF-3 classic files, as far as an added mass needs them: fixed dimensions, text and doubles.
//!
//! Source: NetCDF Classic Format Specification (Unidata, NetCDF User's Guide, appendix B), `CDF-1`. Everything is big-endian
//! and padded to 4 bytes; the header is followed by the variables in their order.

use super::error::FileError;

const DIMENSIONS: u32 = 0x0a;
const VARIABLES: u32 = 0x0b;
const ATTRIBUTES: u32 = 0x0c;
const CHAR: u32 = 2;
const DOUBLE: u32 = 6;

/// What a variable holds, the last dimension running fastest.
pub enum Values {
    /// Characters, padded with zeros by whoever makes them.
    Text(Vec<u8>),
    /// Numbers.
    Doubles(Vec<f64>),
}

/// A variable; no dimensions make a scalar.
pub struct Variable {
    /// Its name.
    pub name: &'static str,
    /// Numbers of its dimensions.
    pub dimensions: Vec<u32>,
    /// Attributes of text.
    pub attributes: Vec<(&'static str, String)>,
    /// As many as the dimensions ask for.
    pub values: Values,
}

/// A file; its parts refer to dimensions by their number.
pub struct Classic {
    /// Names and lengths.
    pub dimensions: Vec<(String, usize)>,
    /// Attributes of the whole.
    pub attributes: Vec<(&'static str, String)>,
    /// In the order of the file.
    pub variables: Vec<Variable>,
}

impl Classic {
    /// The file's bytes; an error of the count cannot come where the bodies have been counted before.
    pub fn bytes(&self, n_bodies: usize) -> Result<Vec<u8>, FileError> {
        let size = |bytes: usize| {
            let offset = i32::try_from(bytes).ok().and_then(|b| u32::try_from(b).ok());
            offset.ok_or_else(|| FileError::body_count(n_bodies))
        };
        // Offsets have a fixed width, so the header is as long with the right ones as without.
        let mut begins = vec![0; self.variables.len()];
        let header_bytes = self.header(&begins, &size)?.len();
        let mut at = header_bytes;
        for (begin, variable) in begins.iter_mut().zip(&self.variables) {
            *begin = size(at)?;
            at += variable.padded_bytes();
        }
        size(at)?;
        let mut bytes = self.header(&begins, &size)?;
        bytes.reserve_exact(at - header_bytes);
        for variable in &self.variables {
            match &variable.values {
                Values::Text(text) => padded(&mut bytes, text),
                Values::Doubles(numbers) => numbers.iter().for_each(|x| bytes.extend(x.to_be_bytes())),
            }
        }
        Ok(bytes)
    }

    fn header(&self, begins: &[u32], size: &impl Fn(usize) -> Result<u32, FileError>) -> Result<Vec<u8>, FileError> {
        let mut bytes = b"CDF\x01".to_vec();
        word(&mut bytes, 0); // no records
        list(&mut bytes, DIMENSIONS, size(self.dimensions.len())?);
        for (name, length) in &self.dimensions {
            text(&mut bytes, name, size)?;
            word(&mut bytes, size(*length)?);
        }
        attributes(&mut bytes, &self.attributes, size)?;
        list(&mut bytes, VARIABLES, size(self.variables.len())?);
        for (variable, begin) in self.variables.iter().zip(begins) {
            text(&mut bytes, variable.name, size)?;
            word(&mut bytes, size(variable.dimensions.len())?);
            variable.dimensions.iter().for_each(|d| word(&mut bytes, *d));
            attributes(&mut bytes, &variable.attributes, size)?;
            word(&mut bytes, if matches!(variable.values, Values::Text(_)) { CHAR } else { DOUBLE });
            word(&mut bytes, size(variable.padded_bytes())?);
            word(&mut bytes, *begin);
        }
        Ok(bytes)
    }
}

impl Variable {
    fn padded_bytes(&self) -> usize {
        match &self.values {
            Values::Text(text) => text.len().next_multiple_of(4),
            Values::Doubles(numbers) => 8 * numbers.len(),
        }
    }
}

fn word(bytes: &mut Vec<u8>, value: u32) {
    bytes.extend(value.to_be_bytes());
}

/// Kind and length of a list; an empty one has neither.
fn list(bytes: &mut Vec<u8>, kind: u32, length: u32) {
    word(bytes, if length == 0 { 0 } else { kind });
    word(bytes, length);
}

fn padded(bytes: &mut Vec<u8>, content: &[u8]) {
    bytes.extend(content);
    bytes.resize(bytes.len() + content.len().next_multiple_of(4) - content.len(), 0);
}

fn text(bytes: &mut Vec<u8>, content: &str, size: &impl Fn(usize) -> Result<u32, FileError>) -> Result<(), FileError> {
    word(bytes, size(content.len())?);
    padded(bytes, content.as_bytes());
    Ok(())
}

fn attributes(
    bytes: &mut Vec<u8>,
    attributes: &[(&'static str, String)],
    size: &impl Fn(usize) -> Result<u32, FileError>,
) -> Result<(), FileError> {
    list(bytes, ATTRIBUTES, size(attributes.len())?);
    for (name, content) in attributes {
        text(bytes, name, size)?;
        word(bytes, CHAR);
        text(bytes, content, size)?;
    }
    Ok(())
}
