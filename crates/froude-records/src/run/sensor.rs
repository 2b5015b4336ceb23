//! What a sensor does to what it measures: where it ends, how fine it reads, what its electronics filter, how late its samples are stamped.
//!
//! ```toml
//! fx = { name = "f_x", unit = "N", sign = 1, frame = "body", clock = "log", range = "±10 N", resolution = "5 mN", delay = "2 ms",
//!        filter = { kind = "butterworth", order = 4, corner = "20 Hz", causal = true } }
//! ```

use toml::Spanned;
use toml::de::DeValue;

use crate::error::RecordError;
use crate::run::declared::{Declared, declared};
use crate::section::{Section, found};
use crate::section_values::one_of;
use crate::units::{Dimension, parse_quantity};

/// Keys of an entry of a channel that are read here.
pub(crate) const KEYS: [&str; 4] = ["range", "resolution", "filter", "delay"];

/// Orders beyond this belong to another kind of filter.
const HIGHEST_ORDER: u64 = 20;

/// What is stated about the sensor of a channel, in SI, of the numbers as they stand in the log: a sign is not undone.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sensor {
    /// Smallest and largest reading.
    pub range: Option<[f64; 2]>,
    /// Smallest step of a reading.
    pub resolution: Option<f64>,
    /// What was filtered before the log.
    pub filter: Option<Filter>,
    /// By how much a sample is stamped too late, s, beside what its filter delays.
    pub delay_s: Option<Declared>,
}

/// A low-pass filter between sensor and log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Filter {
    /// One pass of a Butterworth filter; forward and backward where it is not causal.
    Butterworth {
        /// Its order.
        order: usize,
        /// Frequency at which one pass halves the power, Hz.
        corner_hz: f64,
        /// Whether it delays.
        is_causal: bool,
    },
    /// The mean over a time: over the time before the stamp where it is causal, else about the stamp.
    MovingAverage {
        /// That time, s.
        length_s: f64,
        /// Whether it delays.
        is_causal: bool,
    },
}

#[derive(Clone, Copy)]
enum Kind {
    Butterworth,
    MovingAverage,
}

impl Sensor {
    /// Whether nothing is stated.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        *self == Self::default()
    }

    /// Reads what an entry states; `dimension` is that of its unit.
    pub(crate) fn read(s: &Section<'_>, dimension: Option<Dimension>) -> Result<Self, RecordError> {
        let of_unit = |key: &'static str, value: &Spanned<DeValue<'_>>| {
            dimension.ok_or_else(|| s.wrong(key, value, "needs the unit of the channel: write unit = \"…\" beside it"))
        };
        let range = match s.get("range") {
            Some(value) => Some(range(s, value, of_unit("range", value)?)?),
            None => None,
        };
        let resolution = match s.get("resolution") {
            Some(value) => {
                let dimension = of_unit("resolution", value)?;
                let quantity = s.as_written("resolution", value, "resolution", dimension)?;
                let step = quantity.unit.difference_to_si(quantity.value);
                let problem = format!("is {}; it must be larger than zero", found(value));
                s.refuse("resolution", step <= 0.0, problem)?;
                Some(step)
            }
            None => None,
        };
        let filter = s.section("filter")?.map(|f| filter(&f)).transpose()?;
        Ok(Self { range, resolution, filter, delay_s: declared(s, "delay", Dimension::TIME)? })
    }
}

/// `"±10 N"`, `"10 N"`, or `["-2 N", "10 N"]`.
fn range<'a>(s: &Section<'a>, value: &'a Spanned<DeValue<'a>>, dimension: Dimension) -> Result<[f64; 2], RecordError> {
    if let Some(list) = value.get_ref().as_array() {
        let ends: Vec<f64> =
            list.iter().map(|end| s.as_quantity_of("range", end, dimension)).collect::<Result<_, _>>()?;
        return match ends[..] {
            [low, high] if low < high => Ok([low, high]),
            [low, high] => {
                Err(s.wrong("range", value, format!("goes from {low} to {high} in SI; the smaller end stands first")))
            }
            _ => {
                let problem = format!("has {} ends; write [\"-2 N\", \"10 N\"], or \"±10 N\"", ends.len());
                Err(s.wrong("range", value, problem))
            }
        };
    }
    let text = s.as_text("range", value)?.trim();
    let bare = ["±", "+-", "+/-"].iter().find_map(|sign| text.strip_prefix(sign)).unwrap_or(text);
    let end = parse_quantity(bare).and_then(|quantity| quantity.expect(dimension));
    let end = end.map_err(|e| s.wrong("range", value, format!("is {text:?}, which cannot be read: {e}")))?;
    let problem = format!("is {text:?}; of a range that goes as far either way the half is larger than zero");
    s.refuse("range", end <= 0.0, problem)?;
    Ok([-end, end])
}

fn filter(s: &Section<'_>) -> Result<Filter, RecordError> {
    s.only(&["kind", "order", "corner", "length", "causal"])?;
    let kind = one_of(s, "kind", &["butterworth", "moving_average"], &[Kind::Butterworth, Kind::MovingAverage])?
        .ok_or_else(|| s.missing("kind", "write kind = \"butterworth\" or kind = \"moving_average\""))?;
    let is_causal = s.flag("causal")?.ok_or_else(|| {
        s.missing("causal", "write causal = true for a filter that delays, causal = false for one that was run forward and backward, or is centred")
    })?;
    let unknown =
        |key: &'static str, of: &str| s.refuse(key, true, format!("belongs to another filter; a {of} has none"));
    match kind {
        Kind::Butterworth => {
            unknown("length", "butterworth")?;
            let order = crate::section_values::count(s, "order", HIGHEST_ORDER)?
                .ok_or_else(|| s.missing("order", "write order = 4, for example"))?;
            let corner_hz = s
                .positive("corner", Dimension::ANGULAR_SPEED)?
                .ok_or_else(|| s.missing("corner", "write corner = \"20 Hz\", for example"))?;
            Ok(Filter::Butterworth { order, corner_hz, is_causal })
        }
        Kind::MovingAverage => {
            unknown("order", "moving_average")?;
            unknown("corner", "moving_average")?;
            let length_s = s
                .positive("length", Dimension::TIME)?
                .ok_or_else(|| s.missing("length", "write length = \"50 ms\", for example"))?;
            Ok(Filter::MovingAverage { length_s, is_causal })
        }
    }
}
