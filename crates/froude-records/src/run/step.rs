//! What was done to the data of a run, step by step, with the numbers that it was done with.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::measured::Measured;

/// One step.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Step {
    /// What sort of thing: `read`, `clock`, `filter`, `delay`, `cell`, `frame`, `mark`, `segment`, `window`, …
    pub step: String,
    /// The channel; empty where it was done to all of them.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub channel: String,
    /// In words.
    pub words: String,
    /// Its numbers by name.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub parameters: IndexMap<String, Measured>,
}

impl Step {
    /// A step in words.
    #[must_use]
    pub fn new(step: &str, channel: &str, words: impl Into<String>) -> Self {
        Self { step: step.to_owned(), channel: channel.to_owned(), words: words.into(), parameters: IndexMap::new() }
    }

    /// With a number of it; what is not finite is left out.
    #[must_use]
    pub fn with(mut self, name: &str, value: f64, unit: &str) -> Self {
        if value.is_finite() {
            self.parameters.insert(name.to_owned(), Measured::of(value, unit));
        }
        self
    }
}
