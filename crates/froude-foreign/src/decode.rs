//! Bytes as text: by byte order mark, as UTF-8, or by the most likely encoding.
//!
//! A wrong guess can change letters of names and units, never a number: digits, signs and marks are the same bytes in every encoding that
//! is guessed.

use std::borrow::Cow;

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Text, and how it was encoded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decoded<'b> {
    /// Without byte order mark.
    pub text: Cow<'b, str>,
    /// The encoding's name.
    pub encoding: &'static str,
    /// Whether no byte order mark says so, and it is not UTF-8.
    pub is_guess: bool,
}

/// The first bytes of files that are no text, and what they are.
const BINARY: [(&[u8], &str); 14] = [
    (b"\x89PNG", "a PNG image"),
    (b"\xff\xd8\xff", "a JPEG image"),
    (b"GIF8", "a GIF image"),
    (b"%PDF", "a PDF document"),
    (b"PK\x03\x04", "a zip archive or an office document"),
    (b"\xd0\xcf\x11\xe0", "an old office document (OLE)"),
    (b"\x1f\x8b", "a gzip archive; unpack it first"),
    (b"BZh", "a bzip2 archive; unpack it first"),
    (b"\xfd7zXZ", "an xz archive; unpack it first"),
    (b"7z\xbc\xaf", "a 7-Zip archive; unpack it first"),
    (b"SQLite format 3", "an SQLite database"),
    (b"\x89HDF", "an HDF5 file"),
    (b"PAR1", "a Parquet file"),
    (b"\x7fELF", "a program"),
];

/// What a file is that is no text, by its first bytes.
#[must_use]
pub fn binary_kind(bytes: &[u8]) -> Option<&'static str> {
    BINARY.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, what)| *what)
}

/// The text of `bytes`; `declared` is the encoding that somebody states.
///
/// # Errors
///
/// What the bytes are instead of text, or what is wrong with the declared encoding, as the rest of a sentence about the file.
pub fn decode<'b>(bytes: &'b [u8], declared: Option<&str>) -> Result<Decoded<'b>, String> {
    if let Some(label) = declared {
        let encoding = Encoding::for_label(label.trim().as_bytes()).ok_or_else(|| {
            format!("has the declared encoding {label:?}, which is unknown; write \"utf-8\", \"utf-16le\" or \"windows-1252\", for example")
        })?;
        return all(encoding, bytes, false);
    }
    if let Some(what) = binary_kind(bytes) {
        return Err(format!("is {what}, not text; name the table itself, saved as CSV"));
    }
    if bytes.starts_with(b"\xff\xfe\x00\x00") || bytes.starts_with(b"\x00\x00\xfe\xff") {
        return Err("is text in UTF-32; save it as UTF-8".to_owned());
    }
    if let Some((encoding, _)) = Encoding::for_bom(bytes) {
        return all(encoding, bytes, false);
    }
    if let Some(encoding) = utf16_without_mark(bytes) {
        return all(encoding, bytes, true);
    }
    if let Some(at) = bytes.iter().position(|b| is_control(*b)) {
        return Err(format!("is binary, not text: byte {at} is {:#04x}", bytes[at]));
    }
    // Old programs end a text by Ctrl-Z.
    let bytes = bytes.strip_suffix(b"\x1a").unwrap_or(bytes);
    if let Ok(text) = std::str::from_utf8(bytes) {
        return Ok(Decoded { text: Cow::Borrowed(text), encoding: UTF_8.name(), is_guess: false });
    }
    // Signs of units alone, ° ± ² ³ µ · × ‰, say nothing of a language: they are those of western Windows.
    if bytes.iter().filter(|b| !b.is_ascii()).all(|b| matches!(b, 0x89 | 0xb0..=0xb3 | 0xb5 | 0xb7 | 0xd7)) {
        return all(WINDOWS_1252, bytes, true);
    }
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(bytes, true);
    all(detector.guess(None, Utf8Detection::Deny), bytes, true)
}

fn all<'b>(encoding: &'static Encoding, bytes: &'b [u8], is_guess: bool) -> Result<Decoded<'b>, String> {
    let (text, used, has_errors) = encoding.decode(bytes);
    if has_errors {
        return Err(format!("is not text in {}: some of its bytes are no letters there", used.name()));
    }
    match text.char_indices().find(|(_, c)| u8::try_from(*c).is_ok_and(is_control)) {
        Some((at, c)) => Err(format!("is not text in {}: character {at} is {c:?}", used.name())),
        None => Ok(Decoded { text, encoding: used.name(), is_guess }),
    }
}

/// A zero byte, which nearly every binary file has and no text; other control characters are reported where they stand.
fn is_control(byte: u8) -> bool {
    byte == 0
}

/// UTF-16 whose every second byte is zero at the beginning, as ASCII in it is.
fn utf16_without_mark(bytes: &[u8]) -> Option<&'static Encoding> {
    let start = &bytes[..bytes.len().min(64) & !1];
    let zeros = |parity: usize| start.chunks_exact(2).filter(|pair| pair[parity] == 0).count() * 2;
    if start.len() < 8 {
        None
    } else if zeros(1) >= start.len() * 3 / 4 && zeros(0) == 0 {
        Some(UTF_16LE)
    } else if zeros(0) >= start.len() * 3 / 4 && zeros(1) == 0 {
        Some(UTF_16BE)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> (String, &'static str, bool) {
        let found = decode(bytes, None).unwrap();
        (found.text.into_owned(), found.encoding, found.is_guess)
    }

    #[test]
    fn marks_utf8_and_old_encodings_are_told_apart() {
        let text = "Lauf;Geschwindigkeit;Résistance\n";
        let utf16 = |big: bool| -> Vec<u8> {
            text.encode_utf16().flat_map(|u| if big { u.to_be_bytes() } else { u.to_le_bytes() }).collect()
        };
        assert_eq!(read(text.as_bytes()), (text.to_owned(), "UTF-8", false));
        assert_eq!(read(format!("\u{feff}{text}").as_bytes()), (text.to_owned(), "UTF-8", false));
        assert_eq!(read(&[b"\xff\xfe".as_slice(), &utf16(false)].concat()), (text.to_owned(), "UTF-16LE", false));
        assert_eq!(read(&[b"\xfe\xff".as_slice(), &utf16(true)].concat()), (text.to_owned(), "UTF-16BE", false));
        assert_eq!(read(&utf16(false)), (text.to_owned(), "UTF-16LE", true));
        assert_eq!(read(&utf16(true)), (text.to_owned(), "UTF-16BE", true));
        let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        assert_eq!(read(&latin), (text.to_owned(), "windows-1252", true));
        let japanese = encoding_rs::SHIFT_JIS.encode("時間;速度;抵抗\n1,0;2,0;3,0\n").0.into_owned();
        assert_eq!(read(&japanese), ("時間;速度;抵抗\n1,0;2,0;3,0\n".to_owned(), "Shift_JIS", true));
        assert_eq!(decode(&latin, Some("latin1")).unwrap().text, text);
        for text in ["f_x [\u{b5}N],h [mm]\n1,2\n", "rho [kg/m\u{b3}],I [kg\u{b7}m\u{b2}]\n1,2\n"] {
            let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
            assert_eq!(read(&latin), (text.to_owned(), "windows-1252", true));
        }
        assert_eq!(read(b"a,b\n1,2\n\x1a").0, "a,b\n1,2\n");
    }

    #[test]
    fn what_is_no_text_is_named() {
        let said = |bytes: &[u8]| decode(bytes, None).unwrap_err();
        assert_eq!(said(b"\x89PNG\r\n\x1a\n"), "is a PNG image, not text; name the table itself, saved as CSV");
        assert_eq!(said(b"1,2\n\x00\x01\x02"), "is binary, not text: byte 4 is 0x00");
        assert_eq!(said(b"\xff\xfe\x00\x001\x00\x00\x00"), "is text in UTF-32; save it as UTF-8");
        assert_eq!(said(b"\xff\xfea"), "is not text in UTF-16LE: some of its bytes are no letters there");
        assert!(decode(b"a", Some("ebcdic")).unwrap_err().contains("which is unknown"));
    }
}
