//! Text of others, shown as what it is.

use std::borrow::Cow;

/// A count with its noun.
///
/// ```
/// # use froude_records::text::counted;
/// assert_eq!(counted(1, "run", "runs"), "1 run");
/// assert_eq!(counted(0, "pair", "pairs"), "0 pairs");
/// ```
#[must_use]
pub fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// The text with every character that steers a terminal or hides from the eye written out, as `\u{202e}`.
///
/// A name in a file may hold a terminal's commands, or marks that turn the order of what follows: printed as they stand they clear the
/// screen, colour a refusal green, or make `fdp.exe` read `exe.pdf`. Line feeds stay: they are the lines of a message.
///
/// ```
/// assert_eq!(froude_records::text::visible("tank\u{1b}[2J"), "tank\\u{1b}[2J");
/// assert_eq!(froude_records::text::visible("Strömungskanal, θ = 5°"), "Strömungskanal, θ = 5°");
/// ```
#[must_use]
pub fn visible(text: &str) -> Cow<'_, str> {
    written_out(text, |c, out| out.extend(c.escape_unicode()))
}

/// A JSON document with the same characters as JSON's own escapes: another text, and the same content.
///
/// They can only stand inside the texts of a document: all that JSON itself is made of is ASCII.
#[must_use]
pub fn visible_json(json: &str) -> Cow<'_, str> {
    written_out(json, |c, out| {
        for unit in c.encode_utf16(&mut [0; 2]) {
            out.push_str(&format!("\\u{unit:04x}"));
        }
    })
}

fn written_out(text: &str, write: impl Fn(char, &mut String)) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 32);
    for c in text.chars() {
        if is_hidden(c) {
            write(c, &mut out);
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// True for what steers a terminal (C0, C1, delete), the order of text (bidirectional marks), or shows nothing at all.
///
/// The joiner and non-joiner (U+200C, U+200D) are not among them: words of Persian and Indic languages are misspelt without, and they
/// neither move the cursor nor turn an order.
fn is_hidden(c: char) -> bool {
    (c.is_control() && c != '\n')
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// Characters of a name in that of a file: disks take 255, and a number may follow.
const LONGEST_NAME: usize = 100;

/// A name, as far as every file system takes it.
#[must_use]
pub fn in_a_file_name(name: &str) -> String {
    name.chars()
        .take(LONGEST_NAME)
        .map(|c| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '-' })
        .collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_steers_a_terminal_is_written_out_and_letters_are_not() {
        assert_eq!(visible("a\u{1b}[31m\r\u{9b}2J\u{202e}b\u{feff}"), r"a\u{1b}[31m\u{d}\u{9b}2J\u{202e}b\u{feff}");
        for text in ["Zähigkeit, ν = 1.19·10⁻⁶ m²/s", "می‌خواهم", "水槽", "two\nlines", "x̂"] {
            assert_eq!(visible(text), text);
        }
    }

    proptest! {
        #[test]
        fn json_says_the_same_when_it_is_visible(text: String) {
            let json = serde_json::to_string(&text).unwrap();
            let shown = visible_json(&json).into_owned();
            prop_assert!(!shown.contains(is_hidden));
            prop_assert_eq!(serde_json::from_str::<String>(&shown).unwrap(), text);
        }

        #[test]
        fn nothing_hidden_is_left(text: String) {
            prop_assert!(!visible(&text).contains(is_hidden));
        }
    }
}
