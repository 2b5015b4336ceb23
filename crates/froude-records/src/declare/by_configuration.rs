//! One constant for all configurations, or one for each.

use crate::error::RecordError;
use crate::run::{Declared, declared_value};
use crate::section::{Section, Value};
use crate::units::Dimension;
use indexmap::IndexMap;

/// One constant for all configurations, or one for each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ByConfiguration {
    /// That of configurations not listed in `named`.
    pub all: Option<Declared>,
    /// By configuration.
    pub named: IndexMap<String, Declared>,
}

impl ByConfiguration {
    /// One number for all, or a table with one for each configuration.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is something else.
    pub fn read<'a>(
        s: &Section<'a>,
        key: &str,
        value: &'a Value<'a>,
        dimension: Dimension,
    ) -> Result<Self, RecordError> {
        let mut out = Self::default();
        let table = value.get_ref().as_table().map(|_| s.as_section(key, value)).transpose()?;
        let Some(table) = table.filter(|table| table.get("value").is_none()) else {
            return Ok(Self { all: Some(declared_value(s, key, value, dimension)?), ..out });
        };
        for (configuration, _, value) in table.entries() {
            let number = declared_value(&table, configuration, value, dimension)?;
            out.named.insert(configuration.to_owned(), number);
        }
        Ok(out)
    }

    /// That of a configuration.
    #[must_use]
    pub fn of(&self, configuration: &str) -> Option<Declared> {
        self.named.get(configuration).copied().or(self.all)
    }
}
