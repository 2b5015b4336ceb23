//! The schema that Arrow's writers (pyarrow, pandas, polars) leave in the footer of a Parquet file, for what Parquet has no type for.
//!
//! Parquet has no durations: Arrow stores them as plain integers of 64 bits, and the unit stands in this schema alone. It is
//! an IPC message (a flatbuffer) in base64; only the names of the columns and the units of durations are read from it.
//!
//! Source: `Schema.fbs` and `Message.fbs` of the Arrow format, version 1.5.

use crate::parquet_types::TimeUnit;

/// Key in the footer's metadata.
pub(crate) const KEY: &str = "ARROW:schema";

/// `Type.Duration` in `Schema.fbs`.
const DURATION: u8 = 18;

/// `MessageHeader.Schema` in `Message.fbs`.
const SCHEMA: u8 = 1;

/// The unit of every column that holds durations, by its name; `None` where the schema cannot be read.
pub(crate) fn durations(base64: &str) -> Option<Vec<(String, TimeUnit)>> {
    let bytes = decoded(base64)?;
    // Encapsulated: a mark and the length, or the length alone in versions before 0.15.
    let message = bytes.strip_prefix(&[0xff; 4]).unwrap_or(&bytes).get(4..)?;
    let buffer = Buffer(message);
    let message = buffer.table(0)?;
    let kind = message.slot(1).and_then(|at| buffer.0.get(at).copied());
    if kind != Some(SCHEMA) {
        return None;
    }
    let fields = buffer.table(message.slot(2)?)?.slot(1)?;
    let fields = buffer.follow(fields)?;
    let count = buffer.u32(fields)? as usize;
    if count > buffer.0.len() / 4 {
        return None;
    }
    let mut found = Vec::new();
    for i in 0..count {
        let field = buffer.table(fields + 4 + 4 * i)?;
        let kind = field.slot(2).and_then(|at| buffer.0.get(at).copied());
        if kind != Some(DURATION) {
            continue;
        }
        // A value that is the default, milliseconds, is not stored.
        let unit = match buffer.table(field.slot(3)?)?.slot(0) {
            Some(at) => buffer.u16(at)?,
            None => 1,
        };
        let unit = *TimeUnit::ALL.get(usize::from(unit))?;
        found.push((buffer.text(field.slot(0)?)?, unit));
    }
    Some(found)
}

/// A flatbuffer; every place is checked against its end.
#[derive(Clone, Copy)]
struct Buffer<'a>(&'a [u8]);

/// A table in it: where it stands and where its list of fields stands.
struct Fields<'a> {
    buffer: Buffer<'a>,
    table: usize,
    list: usize,
}

impl<'a> Buffer<'a> {
    fn u16(self, at: usize) -> Option<u16> {
        Some(u16::from_le_bytes(*self.0.get(at..)?.first_chunk()?))
    }

    fn u32(self, at: usize) -> Option<u32> {
        Some(u32::from_le_bytes(*self.0.get(at..)?.first_chunk()?))
    }

    /// What the offset at a place points to.
    fn follow(self, at: usize) -> Option<usize> {
        at.checked_add(self.u32(at)? as usize)
    }

    /// The table that the offset at a place points to.
    fn table(self, at: usize) -> Option<Fields<'a>> {
        let table = self.follow(at)?;
        let back = i64::from(self.u32(table)?.cast_signed());
        let list = usize::try_from(i64::try_from(table).ok()?.checked_sub(back)?).ok()?;
        Some(Fields { buffer: self, table, list })
    }

    /// The text that the offset at a place points to.
    fn text(self, at: usize) -> Option<String> {
        let start = self.follow(at)?;
        let end = start.checked_add(4)?.checked_add(self.u32(start)? as usize)?;
        String::from_utf8(self.0.get(start + 4..end)?.to_vec()).ok()
    }
}

impl Fields<'_> {
    /// Where a field of a table stands; `None` where it has its default.
    fn slot(&self, number: usize) -> Option<usize> {
        let entry = 4 + 2 * number;
        if entry + 2 > usize::from(self.buffer.u16(self.list)?) {
            return None;
        }
        let offset = usize::from(self.buffer.u16(self.list + entry)?);
        (offset > 0).then_some(self.table + offset)
    }
}

/// Bytes of base64 (RFC 4648); `None` where another character stands.
fn decoded(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut n) = (0_u32, 0);
    for letter in text.trim_end_matches('=').bytes() {
        let six = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(six);
        n += 6;
        if n >= 8 {
            n -= 8;
            bytes.push((bits >> n) as u8);
            bits &= (1 << n) - 1;
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_decoded() {
        for (text, bytes) in [("", &b""[..]), ("Zg==", b"f"), ("Zm8=", b"fo"), ("Zm9v", b"foo"), ("/+8=", b"\xff\xef")]
        {
            assert_eq!(decoded(text).unwrap(), bytes);
        }
        assert_eq!(decoded("Zm 9v"), None);
    }

    /// `pyarrow.schema([("a", pa.float64()), ("t", pa.duration("us")), ("ms", pa.duration("ms"))])`, as pyarrow 26.0.1 writes it.
    const SCHEMA: &str = "/////8gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAABsAAAAMAAAAAQAAACw////AAABEhAAAAAYAAAABAAAAAAAAAACAAAAbXMAAAQABAAEAAAA2P///wAAARIQAAAAFAAAAAQAAAAAAAAAAQAAAHQAAADK////AAACABAAFAAIAAYABwAMAAAAEAAQAAAAAAABAxAAAAAYAAAABAAAAAAAAAABAAAAYQAGAAgABgAGAAAAAAACAA==";

    #[test]
    fn units_of_durations_are_found() {
        let expected = [("t".to_owned(), TimeUnit::Microseconds), ("ms".to_owned(), TimeUnit::Milliseconds)];
        assert_eq!(durations(SCHEMA).unwrap(), expected);
    }

    #[test]
    fn no_damage_panics() {
        let bytes = decoded(SCHEMA).unwrap();
        let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for at in 0..SCHEMA.len() {
            for letter in letters {
                let mut text = SCHEMA.as_bytes().to_vec();
                text[at] = *letter;
                let _ = durations(std::str::from_utf8(&text).unwrap());
            }
            let _ = durations(&SCHEMA[..at]);
        }
        assert!(bytes.len() > 100);
    }
}
