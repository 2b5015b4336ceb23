//! A TOML table being read: every value with its line, every key accounted for.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::{Place, RecordError};
use crate::known_columns::usual_unit_for;
use crate::nearest::{nearest, suggestion};
use crate::plausible::{self, unit_for};
use crate::units::{Dimension, LARGEST_SI, Quantity, is_plausible, parse_quantity};

/// A value with where it stands.
pub type Value<'a> = Spanned<DeValue<'a>>;

/// Longest text of a key, in bytes: a formula has some hundreds, a citation fewer.
const LONGEST_TEXT: usize = 10_000;

/// A file's text and path, for lines in messages.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// The file.
    pub path: &'a Path,
    /// Its text.
    pub text: &'a str,
}

impl Source<'_> {
    /// The line and column of a byte offset.
    #[must_use]
    pub fn place(&self, offset: usize) -> Place {
        let before = self.text.get(..offset).unwrap_or(self.text);
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        let line = 1 + memchr::memchr_iter(b'\n', before.as_bytes()).count();
        Place::character(self.path, line, 1 + before[start..].chars().count())
    }

    /// A path written in the file, seen from the file's folder.
    #[must_use]
    pub fn relative(&self, written: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(written)
    }
}

/// Parses the whole document.
///
/// # Errors
///
/// [`RecordError::Syntax`] with its place.
pub fn parse(source: Source<'_>) -> Result<Spanned<DeTable<'_>>, RecordError> {
    DeTable::parse(source.text).map_err(|e| {
        RecordError::syntax(source.place(e.span().map_or(0, |s| s.start)), format!("not TOML: {}", e.message().trim()))
    })
}

/// One table of the document. Keys that are declared ([`Section::only`]) or asked for are known; all others are refused.
pub struct Section<'a> {
    /// The file that it stands in.
    pub source: Source<'a>,
    /// As it is written in brackets; empty of the whole file.
    pub name: String,
    is_listed: bool,
    table: &'a DeTable<'a>,
    start: usize,
    asked: RefCell<BTreeSet<&'a str>>,
}

impl<'a> Section<'a> {
    /// Of a table that begins at a byte of the file; `name` as it is written in brackets.
    #[must_use]
    pub fn new(source: Source<'a>, name: &str, table: &'a DeTable<'a>, start: usize) -> Self {
        Self { source, name: name.to_owned(), is_listed: false, table, start, asked: RefCell::default() }
    }

    /// As the section is written: `[fluid]`, `[[source]]`.
    #[must_use]
    pub fn label(&self) -> String {
        match (self.name.as_str(), self.is_listed) {
            ("", _) => "the file".to_owned(),
            (name, true) => format!("[[{name}]]"),
            (name, false) => format!("[{name}]"),
        }
    }

    /// Where it begins.
    pub fn place(&self) -> Place {
        self.source.place(self.start)
    }

    /// The value of a key, which is then known.
    pub fn get(&self, key: &'static str) -> Option<&'a Value<'a>> {
        self.asked.borrow_mut().insert(key);
        self.raw(key)
    }

    fn raw(&self, key: &str) -> Option<&'a Value<'a>> {
        self.table.iter().find(|(k, _)| k.get_ref().as_ref() == key).map(|(_, v)| v)
    }

    /// All keys in the order written, with the offset of the key and the value.
    pub fn entries(&self) -> impl Iterator<Item = (&'a str, usize, &'a Value<'a>)> {
        let mut entries: Vec<_> = self.table.iter().map(|(k, v)| (k.get_ref().as_ref(), k.span().start, v)).collect();
        // The table is sorted by key; people mean the order that they wrote.
        entries.sort_by_key(|(_, start, _)| *start);
        entries.into_iter()
    }

    /// Takes the keys of which `is_known` is true as known.
    pub fn asks(&self, is_known: impl Fn(&str) -> bool) {
        self.asked.borrow_mut().extend(self.entries().map(|(key, ..)| key).filter(|key| is_known(key)));
    }

    /// Entries whose keys were not asked for by name.
    pub fn others(&self) -> Vec<(&'a str, usize, &'a Value<'a>)> {
        let asked = self.asked.borrow();
        self.entries().filter(|(k, ..)| !asked.contains(k)).collect()
    }

    /// The message about a value: what was found, and what was expected.
    pub fn wrong(&self, key: &str, value: &Value<'_>, problem: impl Into<String>) -> RecordError {
        RecordError::value(self.source.place(value.span().start), key, problem)
    }

    /// A key that is needed and not there; where an unknown key looks like it, that one is reported.
    pub fn missing(&self, key: &str, advice: &str) -> RecordError {
        let problem = || format!("{} has no `{key}`; {advice}", self.label());
        self.misspelt(key).unwrap_or_else(|| RecordError::syntax(self.place(), problem()))
    }

    /// A value that must be there; `advice` is what to write where it is not.
    ///
    /// # Errors
    ///
    /// [`RecordError::Syntax`] where it is missing.
    pub fn need(&self, key: &'static str, advice: &str) -> Result<&'a Value<'a>, RecordError> {
        self.get(key).ok_or_else(|| self.missing(key, advice))
    }

    /// A text that must be there; `advice` is what to write where it is not.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else, [`RecordError::Syntax`] where it is missing.
    pub fn need_text(&self, key: &'static str, advice: &str) -> Result<&'a str, RecordError> {
        self.as_text(key, self.need(key, advice)?)
    }

    /// Refuses what is written under a key, if it is there and wrong.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place.
    pub fn refuse(&self, key: &'static str, is_wrong: bool, problem: impl Into<String>) -> Result<(), RecordError> {
        match self.get(key) {
            Some(value) if is_wrong => Err(self.wrong(key, value, problem)),
            _ => Ok(()),
        }
    }

    /// The unknown key that was probably meant to be `key`.
    fn misspelt(&self, key: &str) -> Option<RecordError> {
        let (written, offset, _) = self.others().into_iter().find(|(k, ..)| nearest(k, [key]).is_some())?;
        Some(self.unknown(written, offset, &suggestion(written, [key])))
    }

    fn unknown(&self, key: &str, offset: usize, advice: &str) -> RecordError {
        RecordError::syntax(self.source.place(offset), format!("unknown key `{key}` in {}; {advice}", self.label()))
    }

    /// Declares every key of the section, and refuses others before anything is read: a misspelt key that the section
    /// needs is then reported as misspelt and not as missing.
    ///
    /// # Errors
    ///
    /// [`RecordError::Syntax`] with the nearest known key.
    pub fn only(&self, known: &[&'static str]) -> Result<(), RecordError> {
        self.asked.borrow_mut().extend(known);
        self.finish()
    }

    /// A text.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn text(&self, key: &'static str) -> Result<Option<&'a str>, RecordError> {
        self.get(key).map(|v| self.as_text(key, v)).transpose()
    }

    /// A value that is a text.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn as_text(&self, key: &str, value: &'a Value<'a>) -> Result<&'a str, RecordError> {
        match value.get_ref().as_str() {
            Some(text) if text.len() > LONGEST_TEXT => {
                let problem = format!("has {} bytes of text; at most {LONGEST_TEXT} are read", text.len());
                Err(self.wrong(key, value, problem))
            }
            Some(text) => Ok(text),
            None => Err(self.wrong(key, value, format!("is {}; expected a text in quotes", found(value)))),
        }
    }

    /// True or false.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn flag(&self, key: &'static str) -> Result<Option<bool>, RecordError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let wrong = || self.wrong(key, value, format!("is {}; expected true or false", found(value)));
        value.get_ref().as_bool().map(Some).ok_or_else(wrong)
    }

    /// A number without a unit.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn number(&self, key: &'static str) -> Result<Option<f64>, RecordError> {
        self.get(key).map(|v| self.as_number(key, v)).transpose()
    }

    /// A value that is a number without a unit.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn as_number(&self, key: &str, value: &Value<'_>) -> Result<f64, RecordError> {
        let text = match value.get_ref() {
            DeValue::Integer(i) if i.radix() == 10 => i.as_str(),
            DeValue::Float(f) => f.as_str(),
            _ => return Err(self.wrong(key, value, format!("is {}; expected a number", found(value)))),
        };
        match text.replace('_', "").parse::<f64>() {
            Ok(x) if is_plausible(x) => Ok(x),
            Ok(x) if x.is_finite() => {
                let problem = format!("is {text}, which exceeds the limit of {LARGEST_SI:e} (SI): correct it");
                Err(self.wrong(key, value, problem))
            }
            _ => Err(self.wrong(key, value, format!("is {text}; expected a finite number"))),
        }
    }

    /// A whole number, zero or larger.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn integer(&self, key: &'static str) -> Result<Option<u64>, RecordError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let parsed = match value.get_ref() {
            DeValue::Integer(i) if i.radix() == 10 => i.as_str().replace('_', "").parse().ok(),
            _ => None,
        };
        let problem = || format!("is {}; expected a whole number, zero or larger", found(value));
        parsed.map(Some).ok_or_else(|| self.wrong(key, value, problem()))
    }

    /// A quantity of a given dimension, SI.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn quantity(&self, key: &'static str, dimension: Dimension) -> Result<Option<f64>, RecordError> {
        self.get(key).map(|v| self.as_quantity_of(key, v, dimension)).transpose()
    }

    /// Half a unit in the last digit of a quantity as it is written, as a part of it; 0 where it is missing.
    pub fn half_digit(&self, key: &'static str) -> f64 {
        let text = self.get(key).and_then(|value| value.get_ref().as_str());
        text.map_or(0.0, |text| crate::units::half_digit(text.trim_start()))
    }

    /// The same, larger than zero.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn positive(&self, key: &'static str, dimension: Dimension) -> Result<Option<f64>, RecordError> {
        self.get(key).map(|value| self.as_positive(key, value, dimension)).transpose()
    }

    /// A value that is a quantity of a given dimension and larger than zero, SI.
    pub(crate) fn as_positive(
        &self,
        key: &str,
        value: &'a Value<'a>,
        dimension: Dimension,
    ) -> Result<f64, RecordError> {
        let si = self.as_quantity_of(key, value, dimension)?;
        if si > 0.0 {
            Ok(si)
        } else {
            Err(self.wrong(key, value, format!("is {}; it must be larger than zero", found(value))))
        }
    }

    /// A value that is a quantity of any kind.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn as_quantity(&self, key: &str, value: &'a Value<'a>) -> Result<Quantity, RecordError> {
        self.quantity_like(key, value, None)
    }

    /// A quantity of any kind; where one is expected, messages suggest units of that kind.
    ///
    /// `like` is that kind, and the name (of the key or of the column that it belongs to) that its usual unit depends on.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn quantity_like(
        &self,
        key: &str,
        value: &'a Value<'a>,
        like: Option<(&str, Dimension)>,
    ) -> Result<Quantity, RecordError> {
        let usual = like.map(|(name, dimension)| (dimension, usual_unit_for(name, dimension)));
        let Some(text) = value.get_ref().as_str() else {
            let number = self.as_number(key, value).map_or_else(|_| "0.4".to_owned(), |_| found(value));
            let example = usual.map_or_else(
                || "0.4 m/s".to_owned(),
                |(dimension, unit)| {
                    let si = number.parse().unwrap_or(f64::NAN);
                    format!("{number} {}", unit_for(si, dimension, &unit))
                },
            );
            let problem =
                format!("is {}; expected a quantity with its unit in quotes, such as {example:?}", found(value));
            return Err(self.wrong(key, value, problem));
        };
        parse_quantity(text).map_err(|e| {
            let e = match usual {
                Some((dimension, unit)) => e.expecting(text, dimension, &unit),
                None => e,
            };
            self.wrong(key, value, format!("cannot be read: {e}"))
        })
    }

    /// A quantity of a given dimension as it is written; `name` as in [`Section::quantity_like`].
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn as_written(
        &self,
        key: &str,
        value: &'a Value<'a>,
        name: &str,
        dimension: Dimension,
    ) -> Result<Quantity, RecordError> {
        let quantity = self.quantity_like(key, value, Some((name, dimension)))?;
        let wrong = |e| self.wrong(key, value, format!("is {}: {e}", found(value)));
        let si = quantity.expect(dimension).map_err(wrong)?;
        match plausible::problem(name, si, &quantity.unit) {
            Some(problem) => Err(self.wrong(key, value, format!("is {}, which {problem}", found(value)))),
            None => Ok(quantity),
        }
    }

    /// A value that is a quantity of a given dimension, SI.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn as_quantity_of(&self, key: &str, value: &'a Value<'a>, dimension: Dimension) -> Result<f64, RecordError> {
        self.as_written(key, value, key, dimension).map(|quantity| quantity.value_si)
    }

    /// A list of texts; a single text counts as a list of one.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn texts(&self, key: &'static str) -> Result<Vec<String>, RecordError> {
        Ok(self.placed_texts(key)?.into_iter().map(|(text, _)| text).collect())
    }

    /// The same, each with its place.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn placed_texts(&self, key: &'static str) -> Result<Vec<(String, Place)>, RecordError> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        let placed = |v: &'a Value<'a>| Ok((self.as_text(key, v)?.to_owned(), self.source.place(v.span().start)));
        if value.get_ref().is_str() {
            return Ok(vec![placed(value)?]);
        }
        let Some(list) = value.get_ref().as_array() else {
            return Err(self.wrong(key, value, format!("is {}; expected a list of texts", found(value))));
        };
        list.iter().map(placed).collect()
    }

    /// A table inside this one.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn section(&self, key: &'static str) -> Result<Option<Section<'a>>, RecordError> {
        self.get(key).map(|v| self.as_section(key, v)).transpose()
    }

    /// A value that is a table.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn as_section(&self, key: &str, value: &'a Value<'a>) -> Result<Section<'a>, RecordError> {
        let Some(table) = value.get_ref().as_table() else {
            return Err(self.wrong(key, value, format!("is {}; expected a table", found(value))));
        };
        let name = if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) };
        Ok(Section::new(self.source, &name, table, value.span().start))
    }

    /// An array of tables (`[[key]]`).
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn sections(&self, key: &'static str) -> Result<Vec<Section<'a>>, RecordError> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        let Some(list) = value.get_ref().as_array() else {
            return Err(self.wrong(key, value, format!("is {}; expected tables, written [[{key}]]", found(value))));
        };
        list.iter().map(|value| self.as_listed(key, value)).collect()
    }

    pub(crate) fn as_listed(&self, key: &str, value: &'a Value<'a>) -> Result<Section<'a>, RecordError> {
        Ok(Section { is_listed: true, ..self.as_section(key, value)? })
    }

    /// Refuses keys that nobody asked for.
    ///
    /// # Errors
    ///
    /// [`RecordError::Syntax`] with the nearest known key.
    pub fn finish(&self) -> Result<(), RecordError> {
        let Some((key, offset, _)) = self.others().into_iter().next() else { return Ok(()) };
        let asked = self.asked.borrow();
        Err(self.unknown(key, offset, &suggestion(key, asked.iter().copied())))
    }

    /// Checks `schema = 1`.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] and [`RecordError::NewerSchema`].
    pub fn schema(&self, what: &str) -> Result<(), RecordError> {
        self.schema_up_to(what, 1).map(|_| ())
    }

    /// The schema, from 1 to the newest that is known.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] and [`RecordError::NewerSchema`].
    pub fn schema_up_to(&self, what: &str, newest: u64) -> Result<u64, RecordError> {
        let place = || self.raw("schema").map_or_else(|| self.place(), |v| self.source.place(v.span().start));
        match self.integer("schema") {
            Ok(Some(known)) if (1..=newest).contains(&known) => Ok(known),
            Ok(Some(newer)) if newer > newest => Err(RecordError::NewerSchema {
                place: place(),
                found: format!("{what} schema {newer}"),
                known: format!("{what} schema {newest}"),
            }),
            Ok(Some(other)) => Err(RecordError::value(place(), "schema", format!("is {other}; expected {newest}"))),
            Ok(None) => Err(self.misspelt("schema").unwrap_or_else(|| {
                let first = Place::line(self.source.path, 1);
                RecordError::value(first, "schema", format!("is missing; expected schema = {newest}"))
            })),
            Err(e) => Err(e),
        }
    }
}

/// A value in a message: texts in quotes, others by their kind.
#[must_use]
pub fn found(value: &Value<'_>) -> String {
    match value.get_ref() {
        DeValue::String(s) => format!("{:?}", s.chars().take(80).collect::<String>()),
        DeValue::Integer(i) => i.as_str().to_owned(),
        DeValue::Float(f) => f.as_str().to_owned(),
        DeValue::Boolean(b) => b.to_string(),
        DeValue::Array(_) => "a list".to_owned(),
        other => format!("a {}", other.type_str()),
    }
}
