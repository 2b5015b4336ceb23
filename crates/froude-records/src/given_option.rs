//! An option of a method as it was given: a flag of its verb, or a key of its section in a campaign.

use std::fmt;

use crate::error::Place;
use crate::units::{Dimension, parse_quantity};

/// An option as it was given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GivenOption {
    /// Its key in a campaign; the flag has `-` for `_`.
    pub name: String,
    /// Its value as written; `true` for a switch.
    pub text: String,
    /// Where it stands in a campaign; `None` for a flag.
    pub place: Option<Place>,
}

impl fmt::Display for GivenOption {
    /// `--most-panels "none"`, or `campaign.toml:9:15: most_panels = "none"`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {} = {:?}", self.name, self.text),
            None => write!(f, "--{} {:?}", self.name.replace('_', "-"), self.text),
        }
    }
}

/// A length that was typed as the value of an option, m.
///
/// # Errors
///
/// It is not a length; the message has the option, what was typed, and what to write.
pub fn length_m(option: &str, text: &str) -> Result<f64, String> {
    parse_quantity(text)
        .and_then(|quantity| quantity.expect(Dimension::LENGTH))
        .map_err(|error| format!("{option} {text:?}: {error}; write a length, \"2.000 m\""))
}
