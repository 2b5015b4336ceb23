//! A checksum inside a file, of what the file says.
//!
//! The key `checksum` of a run's sidecar and of an estimate record is the SHA-256 of all other keys with their values: not of
//! the file's bytes. Order of keys, white space, comments and line ends may change, no value may. A file without the key is
//! read as it is: records that a person writes need none, and who edits a file knowingly deletes the line.
//!
//! **What is summed.** A value is a letter for its kind, a length (64 bits, little endian) and its content: a text its UTF-8
//! bytes; a number of JSON its 64 bits as a double (an integer that no double holds, its digits); a number of TOML as it is
//! written, without `_`; a list its values in order; a table its keys, sorted by their bytes, each before its value.

use serde_json::Value;
use sha2::{Digest as _, Sha256};
use toml::de::{DeTable, DeValue};

use crate::hash::hexadecimal;

/// The key; the sum of the file is over all others.
pub(crate) const KEY: &str = "checksum";

/// Sum of a JSON document but for its own `checksum`.
pub(crate) fn of_json(document: &Value) -> String {
    let mut sum = Sha256::new();
    match document {
        Value::Object(table) => {
            keys(&mut sum, table.iter().filter(|(key, _)| *key != KEY).map(|(k, v)| (k.as_str(), v)).collect(), json);
        }
        other => json(&mut sum, other),
    }
    hexadecimal(&sum.finalize())
}

/// Sum of a TOML document but for its own `checksum`.
pub(crate) fn of_toml(document: &DeTable<'_>) -> String {
    let mut sum = Sha256::new();
    let all = document.iter().map(|(key, value)| (key.get_ref().as_ref(), value.get_ref()));
    keys(&mut sum, all.filter(|(key, _)| *key != KEY).collect(), toml);
    hexadecimal(&sum.finalize())
}

fn part(sum: &mut Sha256, kind: u8, length: usize, content: &[u8]) {
    sum.update([kind]);
    sum.update((length as u64).to_le_bytes());
    sum.update(content);
}

fn text(sum: &mut Sha256, kind: u8, text: &str) {
    part(sum, kind, text.len(), text.as_bytes());
}

fn keys<V>(sum: &mut Sha256, mut entries: Vec<(&str, V)>, value: fn(&mut Sha256, V)) {
    entries.sort_by_key(|(key, _)| *key);
    part(sum, b'o', entries.len(), &[]);
    for (key, own) in entries {
        text(sum, b's', key);
        value(sum, own);
    }
}

fn json(sum: &mut Sha256, value: &Value) {
    match value {
        Value::Null => part(sum, b'z', 0, &[]),
        Value::Bool(flag) => part(sum, b'b', 1, &[u8::from(*flag)]),
        Value::Number(number) => {
            let digits = number.to_string();
            match number.as_f64() {
                Some(double) if number.is_f64() || format!("{double:.0}") == digits => {
                    part(sum, b'n', 8, &double.to_le_bytes());
                }
                _ => text(sum, b'i', &digits),
            }
        }
        Value::String(own) => text(sum, b's', own),
        Value::Array(list) => {
            part(sum, b'a', list.len(), &[]);
            for value in list {
                json(sum, value);
            }
        }
        Value::Object(table) => keys(sum, table.iter().map(|(key, value)| (key.as_str(), value)).collect(), json),
    }
}

fn toml(sum: &mut Sha256, value: &DeValue<'_>) {
    match value {
        DeValue::String(own) => text(sum, b's', own),
        DeValue::Integer(number) => text(sum, b'n', &number.to_string().replace('_', "")),
        DeValue::Float(number) => text(sum, b'n', &number.to_string().replace('_', "")),
        DeValue::Boolean(flag) => part(sum, b'b', 1, &[u8::from(*flag)]),
        DeValue::Datetime(time) => text(sum, b't', &time.to_string()),
        DeValue::Array(list) => {
            part(sum, b'a', list.len(), &[]);
            for value in list {
                toml(sum, value.get_ref());
            }
        }
        DeValue::Table(table) => {
            keys(sum, table.iter().map(|(key, value)| (key.get_ref().as_ref(), value.get_ref())).collect(), toml);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn json_sum(text: &str) -> String {
        of_json(&serde_json::from_str(text).unwrap())
    }

    fn toml_sum(text: &str) -> String {
        of_toml(DeTable::parse(text).unwrap().get_ref())
    }

    #[test]
    fn the_sum_is_of_what_is_said_and_not_of_how_it_is_laid_out() {
        let one = json_sum(r#"{"a": [1, 0.1, null, true], "b": {"x": "1", "y": -0.0}}"#);
        assert_eq!(one, json_sum("{ \"b\":{\"y\":-0.0,\"x\":\"1\"},\n\"a\":[1.0,1e-1,null,true], \"checksum\": 7}"));
        let one = toml_sum("a = 1_000\nb.c = \"x\" # said\n[d]\ne = [true, 2.5]\n");
        assert_eq!(one, toml_sum("checksum = \"x\"\r\n d = { e=[true,2.5] }\r\na=1000\r\n[b]\r\nc='x'\r\n"));
    }

    #[test]
    fn another_value_another_key_and_another_nesting_are_another_sum() {
        let texts = [
            r#"{"a": ["1", "2"]}"#,
            r#"{"a": ["12"]}"#,
            r#"{"a": [["1"], "2"]}"#,
            r#"{"a": ["1", 2]}"#,
            r#"{"b": ["1", "2"]}"#,
            r#"{"a": {"1": "2"}}"#,
            r#"{"a": 9007199254740993}"#,
            r#"{"a": 9007199254740992}"#,
            r#"{"a": 0.1}"#,
            r#"{"a": 0.10000000000000002}"#,
        ];
        let mut sums: Vec<String> = texts.iter().map(|text| json_sum(text)).collect();
        sums.extend(["a = 1", "a = \"1\"", "a.a = 1", "a = [1]", "a = 0x1", "a = 1.0"].map(toml_sum));
        sums.sort();
        sums.dedup();
        assert_eq!(sums.len(), texts.len() + 6);
    }
}
