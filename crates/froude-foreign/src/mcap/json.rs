//! JSON messages: numbers and truth values by their path, `imu.gyro.x` or `position_0`.
//!
//! Messages of a topic may differ: a number that some lack is NaN there, and an array whose length changes is passed over and named.

use std::collections::BTreeMap;

use serde_json::Value;

use super::ros2::{MAX_ARRAY, MAX_COLUMNS};

/// The columns of a topic, as its messages make them known.
#[derive(Debug, Default)]
pub(super) struct Topic {
    /// Names of the columns.
    pub columns: Vec<String>,
    place: BTreeMap<String, usize>,
    /// What is passed over, with the reason.
    pub skipped: BTreeMap<String, &'static str>,
    /// Lengths of the arrays.
    lengths: BTreeMap<String, usize>,
}

impl Topic {
    /// Reads a message into a row, which grows with the columns; NaN where it has no number.
    ///
    /// # Errors
    ///
    /// What is no object of JSON, or has too many numbers.
    pub fn decode(&mut self, data: &[u8], row: &mut Vec<f64>) -> Result<(), String> {
        let value: Value = serde_json::from_slice(data).map_err(|e| format!("it is not JSON: {e}"))?;
        if !value.is_object() {
            return Err("it is not an object of JSON; expected {\"name\": number, …}".to_owned());
        }
        row.clear();
        row.resize(self.columns.len(), f64::NAN);
        self.value(&value, String::new(), row)
    }

    fn value(&mut self, value: &Value, path: String, row: &mut Vec<f64>) -> Result<(), String> {
        match value {
            Value::Number(number) => self.number(path, number.as_f64().unwrap_or(f64::NAN), row),
            Value::Bool(is_true) => self.number(path, f64::from(u8::from(*is_true)), row),
            Value::Null => Ok(()),
            Value::String(_) => {
                self.skipped.insert(path, "text");
                Ok(())
            }
            Value::Object(object) => {
                for (name, value) in object {
                    let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                    self.value(value, path, row)?;
                }
                Ok(())
            }
            Value::Array(array) => {
                let length = *self.lengths.entry(path.clone()).or_insert(array.len());
                if array.len() != length {
                    self.skipped.insert(path, "an array of varying length");
                } else if length > MAX_ARRAY {
                    self.skipped.insert(path, "a long array");
                } else {
                    for (i, value) in array.iter().enumerate() {
                        self.value(value, format!("{path}_{i}"), row)?;
                    }
                }
                Ok(())
            }
        }
    }

    fn number(&mut self, path: String, value: f64, row: &mut Vec<f64>) -> Result<(), String> {
        let column = match self.place.get(&path) {
            Some(column) => *column,
            None if self.columns.len() == MAX_COLUMNS => {
                return Err(format!("the topic has more than {MAX_COLUMNS} numbers"));
            }
            None => {
                self.columns.push(path.clone());
                self.place.insert(path, self.columns.len() - 1);
                row.push(f64::NAN);
                self.columns.len() - 1
            }
        };
        if let Some(cell) = row.get_mut(column) {
            *cell = value;
        }
        Ok(())
    }

    /// Whether a column is kept: not if it is text in some message, or an element of an array whose length changes.
    pub fn is_kept(&self, column: &str) -> bool {
        !self.skipped.keys().any(|skipped| {
            column.strip_prefix(skipped.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with(['_', '.']))
                && (column == skipped || self.lengths.contains_key(skipped))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_are_columns_by_their_path() {
        let mut topic = Topic::default();
        let mut row = Vec::new();
        topic.decode(br#"{"a": 1, "b": {"x": 2.5, "s": "no"}, "c": [true, false], "d": [1]}"#, &mut row).unwrap();
        assert_eq!(topic.columns, ["a", "b.x", "c_0", "c_1", "d_0"]);
        assert_eq!(row, [1.0, 2.5, 1.0, 0.0, 1.0]);
        topic.decode(br#"{"a": null, "b": {"x": 3}, "d": [1, 2], "e": 7}"#, &mut row).unwrap();
        assert!(row[0].is_nan() && row[2].is_nan());
        assert_eq!((row[1], row[5]), (3.0, 7.0));
        assert_eq!(
            topic.skipped.into_iter().collect::<Vec<_>>(),
            [("b.s".to_owned(), "text"), ("d".to_owned(), "an array of varying length")]
        );
    }

    #[test]
    fn what_is_no_object_is_refused() {
        let mut topic = Topic::default();
        assert!(topic.decode(b"[1, 2]", &mut Vec::new()).unwrap_err().starts_with("it is not an object of JSON"));
        assert!(topic.decode(b"{", &mut Vec::new()).unwrap_err().starts_with("it is not JSON: EOF"));
        let deep = "[".repeat(100_000);
        assert!(topic.decode(deep.as_bytes(), &mut Vec::new()).is_err());
    }
}
