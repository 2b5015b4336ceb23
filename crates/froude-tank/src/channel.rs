//! A channel of a log, as a method states it.

use froude_records::block::Digits;
use froude_records::campaign::SensorSpec;
use froude_records::units::Dimension;

/// A channel of a log.
#[derive(Debug, Clone, Copy)]
pub struct Channel {
    /// Name in the log.
    pub name: &'static str,
    /// Another name of its quantity in `[[simulate.sensor]]` and `[[source.uncertainty]]`; that of the load in a record.
    pub load: &'static str,
    /// Of its values.
    pub dimension: Dimension,
    /// SI.
    pub unit: &'static str,
    /// Unit of the page.
    pub shown: &'static str,
    /// Of its zero on the page.
    pub digits: Digits,
    /// What is positive; ends a message about a sign that is not stated.
    pub along: &'static str,
    /// Of the twin's log: name of the column, frame, comment, decimal places.
    pub column: (&'static str, &'static str, &'static str, usize),
    /// Standard deviation of the zero that the twin draws for each run.
    pub zero: f64,
}

impl Channel {
    /// A channel that is shown in the unit of its log; the rest has to be stated.
    pub const GENERAL: Self = Self {
        name: "",
        load: "",
        dimension: Dimension::ONE,
        unit: "1",
        shown: "1",
        digits: Digits::Significant(3),
        along: "",
        column: ("", "body", "", 6),
        zero: 0.0,
    };

    /// Its name at the start of a sentence.
    #[must_use]
    pub fn title(&self) -> String {
        let mut letters = self.name.chars();
        letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
    }

    /// Its unit at the end of a key: `n_m`.
    #[must_use]
    pub fn key(&self) -> String {
        self.unit.to_lowercase().replace(' ', "_")
    }

    /// Names of its quantity.
    #[must_use]
    pub fn names(&self) -> Vec<&'static str> {
        if self.name == self.load { vec![self.name] } else { vec![self.name, self.load] }
    }

    /// Its sensor, by its name rather than by that of the load.
    pub(crate) fn sensor<'s>(&self, sensors: &'s [SensorSpec]) -> Option<&'s SensorSpec> {
        self.names().into_iter().find_map(|name| sensors.iter().find(|sensor| sensor.quantity == name))
    }
}
